//! Gravity: accelerations by a point, by third bodies as tides, by a body's figure, and relativity's part. SI, f64, pure.
//!
//! [`zonal`]: J₂ … J₄ and C₂₂; [`figure`]: a body's coefficients with its axes; [`relativity`]: 1PN of one mass or of n;
//! [`response`]: the bulge that a moon raises; [`radiation`]: the pressure of sunlight.
//!
//! Not here: who attracts whom (`game::world`), nor how a state moves (`kepler`, `integrate`).
//! - [Battin 1999] "An Introduction to the Mathematics and Methods of Astrodynamics", §8.4 (the f(q) form of a tide).
//! - [Montenbruck & Gill 2000] "Satellite Orbits", §3.2 (zonal harmonics).

pub mod figure;
pub mod radiation;
pub mod relativity;
pub mod response;
pub mod zonal;

use crate::space::{Frame, Position, Vector};
use glam::DVec3;

/// Acceleration at `at` (from the attracting point), m/s²: `−μ r/r³`. Zero at the point itself, where it has no value.
pub fn point_mass<F: Frame>(gm: f64, at: Position<F>) -> Vector<F> {
    let r2 = at.0.length_squared();
    if r2 > 0.0 { Vector::new(at.0 * (-gm / (r2 * r2.sqrt()))) } else { Vector::ZERO }
}

/// Acceleration at `at` by a third body at `body`, less the acceleration that the body gives to the origin: the tide that
/// perturbs an orbit about the origin. Battin's f(q) keeps the digits that the plain difference loses. m/s².
pub fn tide<F: Frame>(gm: f64, body: Position<F>, at: Position<F>) -> Vector<F> {
    let d2 = body.0.length_squared();
    let separation = (body - at).0;
    let s2 = separation.length_squared();
    if d2 <= 0.0 || s2 <= 0.0 {
        return Vector::ZERO;
    }
    // |body − at|² = d²(1 + q); a = −μ/s³ · (at + f(q)·body), f = (1+q)^{3/2} − 1 = q(3 + 3q + q²)/(1 + (1+q)^{3/2}).
    let q = at.0.dot(at.0 - 2.0 * body.0) / d2;
    let one = 1.0 + q;
    let f = q * (3.0 + 3.0 * q + q * q) / (1.0 + one * one.max(0.0).sqrt());
    Vector::new((at.0 + body.0 * f) * (-gm / (s2 * s2.sqrt())))
}

/// Acceleration by the flattening J₂ alone, m/s² [Montenbruck & Gill 2000, eq. 3.29]. `pole` is the unit vector of the body's
/// pole, in the axes of `at`; `radius_m` is the reference radius that J₂ belongs to.
pub fn j2<F: Frame>(gm: f64, j2: f64, radius_m: f64, pole: DVec3, at: Position<F>) -> Vector<F> {
    let r2 = at.0.length_squared();
    if r2 <= 0.0 {
        return Vector::ZERO;
    }
    let r = r2.sqrt();
    let sin_lat = at.0.dot(pole) / r;
    let scale = -1.5 * gm * j2 * radius_m * radius_m / (r2 * r2);
    Vector::new((at.0 / r * (1.0 - 5.0 * sin_lat * sin_lat) + pole * (2.0 * sin_lat)) * scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Centred;

    type P = Position<Centred>;

    #[test]
    fn gravity_at_the_ground_is_gm_over_r_squared() {
        let a = point_mass(3.986_004_355_07e14, P::xyz(0.0, 6.371e6, 0.0));
        assert!((a.0.y + 9.820_250_33).abs() < 1e-6 && a.0.x == 0.0, "{a:?}");
        assert_eq!(point_mass(1.0, P::ZERO), Vector::ZERO);
    }

    #[test]
    fn tide_agrees_with_the_difference_where_that_is_exact_and_with_its_limit_where_it_is_not() {
        let (gm, moon) = (4.902_800_118e12, P::xyz(3.844e8, 0.0, 0.0));
        let far = P::xyz(1.0e8, 2.0e8, -3.0e7);
        let plain = point_mass(gm, P::new(far.0 - moon.0)).0 - point_mass(gm, P::new(-moon.0)).0;
        assert!((tide(gm, moon, far).0 - plain).length() < 1e-14 * plain.length() * 10.0);
        // Near the origin the tide is linear: 2μx/d³ along the line to the body, −μy/d³ across it.
        let d3 = 3.844e8_f64 * 3.844e8 * 3.844e8;
        let along = tide(gm, moon, P::xyz(1.0, 0.0, 0.0)).0.x;
        let across = tide(gm, moon, P::xyz(0.0, 1.0, 0.0)).0.y;
        assert!((along / (2.0 * gm / d3) - 1.0).abs() < 1e-8 && (across / (-gm / d3) + 0.0 - 1.0).abs() < 1e-8);
    }

    #[test]
    fn j2_is_the_gradient_of_its_potential() {
        let (gm, j, radius) = (3.986e14, 1.082_63e-3, 6.378e6);
        let pole = DVec3::new(0.0, 0.6, 0.8);
        let potential = |p: DVec3| {
            let (r, s) = (p.length(), p.dot(pole) / p.length());
            -gm * j * radius * radius / (r * r * r) * 0.5 * (3.0 * s * s - 1.0)
        };
        let at = DVec3::new(4.0e6, -5.0e6, 3.0e6);
        let a = j2(gm, j, radius, pole, P::new(at)).0;
        let h = 10.0;
        let gradient =
            DVec3::from_array([DVec3::X, DVec3::Y, DVec3::Z].map(|e| (potential(at + e * h) - potential(at - e * h)) / (2.0 * h)));
        assert!((a - gradient).length() < 1e-7 * a.length(), "{a} {gradient}");
    }
}
