//! Zonal harmonics J₂ … J₄ of a flattened body, and the second-degree figure of a triaxial one.
//!
//! With V = (μ/r)[1 − Σ Jₙ (R/r)ⁿ Pₙ(s)], s = r̂·p for the pole p, the gradient of one term is
//! `μ Jₙ Rⁿ/rⁿ⁺² [P′ₙ₊₁(s) r̂ − P′ₙ(s) p]`: (n+1)Pₙ + sP′ₙ = P′ₙ₊₁ makes it that short, and nothing is singular at the poles.
//! - [Montenbruck & Gill 2000] "Satellite Orbits", §3.2.
//! - [Kaula 1966] "Theory of Satellite Geodesy", §1.1 (C₂₂).

use crate::space::{Frame, Position, Vector};
use glam::DVec3;

/// Acceleration by J₂, J₃, J₄ (unnormalised, of reference radius `radius_m`), without the central term, m/s². `pole` is the unit
/// vector of the body's pole, in the axes of `at` (from the body's centre). Zero at the centre.
pub fn zonal<F: Frame>(gm: f64, j: [f64; 3], radius_m: f64, pole: DVec3, at: Position<F>) -> Vector<F> {
    let r2 = at.0.length_squared();
    if r2 <= 0.0 {
        return Vector::ZERO;
    }
    let inverse = 1.0 / r2.sqrt();
    let s = at.0.dot(pole) * inverse;
    let s2 = s * s;
    let ratio = radius_m * inverse;
    let ratio2 = ratio * ratio;
    // P′₂ … P′₅.
    let (p2, p3) = (3.0 * s, 0.5 * (15.0 * s2 - 3.0));
    let (p4, p5) = (0.5 * s * (35.0 * s2 - 15.0), 0.125 * ((315.0 * s2 - 210.0) * s2 + 15.0));
    let (k2, k3, k4) = (j[0] * ratio2, j[1] * ratio2 * ratio, j[2] * ratio2 * ratio2);
    let radial = k2 * p3 + k3 * p4 + k4 * p5;
    let polar = k2 * p2 + k3 * p3 + k4 * p4;
    Vector::new((at.0 * (radial * inverse) - pole * polar) * (gm * inverse * inverse))
}

/// Acceleration by C₂₂ (unnormalised) alone, m/s²: the equator's ellipse, long along `x`. `x` and `y` are the unit vectors of the
/// body's prime meridian and of 90° east of it, in the axes of `at`. The gradient of `3 μ C₂₂ R² (x² − y²)/r⁵`.
pub fn sectorial<F: Frame>(gm: f64, c22: f64, radius_m: f64, x: DVec3, y: DVec3, at: Position<F>) -> Vector<F> {
    let r2 = at.0.length_squared();
    if r2 <= 0.0 {
        return Vector::ZERO;
    }
    let (px, py) = (at.0.dot(x), at.0.dot(y));
    let scale = 3.0 * gm * c22 * radius_m * radius_m / (r2 * r2 * r2.sqrt());
    Vector::new((x * (2.0 * px) - y * (2.0 * py) - at.0 * (5.0 * (px * px - py * py) / r2)) * scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::integrate::gauss_radau::GaussRadau;
    use crate::orbit::integrate::{Force, Points};
    use crate::space::Centred;

    fn gradient(potential: impl Fn(DVec3) -> f64, at: DVec3) -> DVec3 {
        // Fourth-order differences.
        let h = 2.0e3;
        DVec3::from_array([DVec3::X, DVec3::Y, DVec3::Z].map(|e| {
            let one = potential(at + e * h) - potential(at - e * h);
            let two = potential(at + e * (2.0 * h)) - potential(at - e * (2.0 * h));
            (8.0 * one - two) / (12.0 * h)
        }))
    }

    #[test]
    fn each_zonal_term_is_the_gradient_of_its_potential() {
        let (gm, radius, pole) = (3.986e14, 6.378e6, DVec3::new(0.0, 0.6, 0.8));
        for k in 0..3_usize {
            let mut j = [0.0; 3];
            j[k] = 1e-3;
            let potential = |p: DVec3| {
                let (r, s) = (p.length(), p.dot(pole) / p.length());
                let legendre =
                    [0.5 * (3.0 * s * s - 1.0), 0.5 * s * (5.0 * s * s - 3.0), 0.125 * (35.0 * s * s * s * s - 30.0 * s * s + 3.0)][k];
                let ratio = radius / r;
                -gm / r * 1e-3 * [ratio * ratio, ratio * ratio * ratio, ratio * ratio * ratio * ratio][k] * legendre
            };
            for at in [DVec3::new(4.0e6, -5.0e6, 3.0e6), pole * 7.0e6, DVec3::new(9.0e6, 0.0, 1.0e5)] {
                let a = zonal(gm, j, radius, pole, Position::<Centred>::new(at)).0;
                let exact = gradient(potential, at);
                assert!((a - exact).length() < 1e-8 * exact.length(), "J{}: {a} {exact}", k + 2);
            }
        }
        assert_eq!(zonal::<Centred>(gm, [1.0; 3], radius, pole, Position::ZERO), Vector::ZERO);
    }

    #[test]
    fn the_sectorial_term_is_the_gradient_of_its_potential() {
        let (gm, radius, c22) = (4.9e12, 1.738e6, 2.24e-5);
        let (x, y) = (DVec3::new(0.8, 0.6, 0.0), DVec3::new(-0.6, 0.8, 0.0));
        let potential = |p: DVec3| {
            let (r, a, b) = (p.length(), p.dot(x), p.dot(y));
            3.0 * gm * c22 * radius * radius * (a * a - b * b) / (r * r * r * r * r)
        };
        let at = DVec3::new(1.4e7, -2.0e7, 9.0e6);
        let a = sectorial(gm, c22, radius, x, y, Position::<Centred>::new(at)).0;
        assert!((a - gradient(potential, at)).length() < 1e-8 * a.length());
    }
    struct Flat(DVec3);
    impl Force for Flat {
        const USES_VELOCITY: bool = false;
        fn accelerations(&self, _: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
            let at = Position::<Centred>::new(q[0]);
            a[0] = (crate::orbit::gravity::point_mass(3.986e14, at) + zonal(3.986e14, [1e-5, 0.0, 0.0], 6.378e6, self.0, at)).0;
        }
    }

    #[test]
    fn a_node_precesses_by_j2_as_the_secular_formula_says() {
        // Ω̇ = −(3/2) n J₂ (R/p)² cos i [Montenbruck & Gill 2000, eq. 3.44]; a small J₂ keeps second-order terms out.
        let pole = DVec3::new(0.6, 0.0, 0.8);
        let (x, y) = (DVec3::Y, pole.cross(DVec3::Y));
        let (r, gm, tilt) = (8.0e6_f64, 3.986e14_f64, 0.7_f64);
        let speed = (gm / r).sqrt();
        let start = (y * libm::cos(tilt) + pole * libm::sin(tilt)) * speed;
        let mut points = Points { t: 0.0, q: vec![x * r], v: vec![start] };
        let mut method = GaussRadau::new(1, GaussRadau::TOLERANCE);
        let period = core::f64::consts::TAU * r / speed;
        // Averaged over a revolution, 50 later.
        let mut node = |from: f64| {
            let mut sum = 0.0;
            for k in 0..64 {
                method.run(&Flat(pole), &mut points, (from + f64::from(k) / 64.0) * period);
                let normal = points.q[0].cross(points.v[0]);
                sum += libm::atan2(normal.dot(x), -normal.dot(y)) / 64.0;
            }
            sum
        };
        let moved = node(50.0);
        let expected = -1.5 * 1e-5 * (6.378e6 / r) * (6.378e6 / r) * libm::cos(tilt) * core::f64::consts::TAU * 50.5;
        assert!((moved / expected - 1.0).abs() < 0.01, "{moved} {expected}");
    }
}
