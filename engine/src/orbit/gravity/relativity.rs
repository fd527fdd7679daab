//! Relativity at the first post-Newtonian order: n bodies that move each other [Einstein, Infeld & Hoffmann 1938], and the field
//! of one mass alone (Schwarzschild), where that suffices.
//!
//! Harmonic coordinates, β = γ = 1: the form in which JPL integrates its ephemerides.
//! - [Moyer 2003] "Formulation for Observed and Computed Values of Deep Space Network Data Types", eq. 4–26 (n bodies).
//! - [Park et al. 2021] "The JPL Planetary and Lunar Ephemerides DE440 and DE441", AJ 161, 105, eq. 2.
//! - [Montenbruck & Gill 2000] "Satellite Orbits", eq. 3.146 (one mass).
//! - [Damour & Deruelle 1985] "General relativistic celestial mechanics of binary systems I", Ann. IHP 43, 107 (test).

use crate::space::{Frame, Position, Vector, Velocity};
use crate::units::SPEED_OF_LIGHT;
use glam::DVec3;

/// 1/c², s²/m².
pub const INVERSE_C2: f64 = 1.0 / (SPEED_OF_LIGHT * SPEED_OF_LIGHT);

/// The 1PN acceleration by one mass at rest, in addition to Newton's, m/s² [Montenbruck & Gill 2000, eq. 3.146]:
/// `GM/(c²r³) [(4GM/r − v²) r + 4(r·v) v]`. Zero at the mass itself.
pub fn schwarzschild<F: Frame>(gm: f64, at: Position<F>, velocity: Velocity<F>) -> Vector<F> {
    let (r, v) = (at.0, velocity.0);
    let r2 = r.length_squared();
    if r2 <= 0.0 {
        return Vector::ZERO;
    }
    let inverse = 1.0 / r2.sqrt();
    let radial = 4.0 * gm * inverse - v.length_squared();
    Vector::new((r * radial + v * (4.0 * r.dot(v))) * (gm * INVERSE_C2 * inverse * inverse * inverse))
}

/// Buffers of [`newton`] and [`einstein_infeld_hoffmann`].
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    /// 1/r of each pair i < j, row by row.
    inverse: Vec<f64>,
    /// Σ GM/r at each body.
    potential: Vec<f64>,
    /// Newton's accelerations.
    newton: Vec<DVec3>,
}

/// Newton's accelerations of point masses at `q`, into `a` (what was there is lost), m/s². The first `heavy` attract all others and
/// are attracted by all; the rest do not attract each other. Two at one place do not either.
pub fn newton(gm: &[f64], heavy: usize, q: &[DVec3], a: &mut [DVec3], pairs: &mut Pairs) {
    let n = gm.len().min(q.len()).min(a.len());
    let heavy = heavy.min(n);
    a[..n].fill(DVec3::ZERO);
    pairs.inverse.clear();
    pairs.potential.clear();
    pairs.potential.resize(n, 0.0);
    for i in 0..heavy {
        let (mut own, mut sum) = (a[i], pairs.potential[i]);
        for j in i + 1..n {
            let d = q[j] - q[i];
            let r2 = d.length_squared();
            let inverse = if r2 > 0.0 { 1.0 / r2.sqrt() } else { 0.0 };
            let cube = inverse * inverse * inverse;
            own += d * (gm[j] * cube);
            a[j] -= d * (gm[i] * cube);
            sum += gm[j] * inverse;
            pairs.potential[j] += gm[i] * inverse;
            pairs.inverse.push(inverse);
        }
        a[i] = own;
        pairs.potential[i] = sum;
    }
}

/// Accelerations of point masses with their 1PN terms, into `a`, m/s² [Moyer 2003, eq. 4–26]. `q` and `v` count from the barycentre
/// of an isolated system. The first `heavy` have all terms among themselves; the rest (asteroids) only Newton's with these. What is
/// of order c⁻² on the right-hand side (the accelerations of the others) is Newton's.
pub fn einstein_infeld_hoffmann(gm: &[f64], heavy: usize, q: &[DVec3], v: &[DVec3], a: &mut [DVec3], pairs: &mut Pairs) {
    newton(gm, heavy, q, a, pairs);
    let n = gm.len().min(q.len()).min(a.len());
    let heavy = heavy.min(n).min(v.len());
    pairs.newton.clear();
    pairs.newton.extend_from_slice(&a[..n]);
    let (phi, by_newton) = (&pairs.potential, &pairs.newton);
    let mut row = pairs.inverse.as_slice();
    for i in 0..heavy {
        let v2_i = v[i].length_squared();
        let mut own = DVec3::ZERO;
        for (j, &inverse) in (i + 1..heavy).zip(row) {
            let d = q[j] - q[i];
            let cube = inverse * inverse * inverse;
            let (v2_j, cross) = (v[j].length_squared(), 4.0 * v[i].dot(v[j]));
            let (along_i, along_j) = (d.dot(v[i]), d.dot(v[j]));
            let (ratio_i, ratio_j) = (along_i * inverse, along_j * inverse);
            let on_i = v2_i + 2.0 * v2_j - cross - 1.5 * ratio_j * ratio_j + 0.5 * d.dot(by_newton[j]) - 4.0 * phi[i] - phi[j];
            let on_j = v2_j + 2.0 * v2_i - cross - 1.5 * ratio_i * ratio_i - 0.5 * d.dot(by_newton[i]) - 4.0 * phi[j] - phi[i];
            let relative = v[i] - v[j];
            let (push_i, push_j) = (3.0 * along_j - 4.0 * along_i, 4.0 * along_j - 3.0 * along_i);
            own += ((d * on_i + relative * push_i) * cube + by_newton[j] * (3.5 * inverse)) * gm[j];
            let other = ((d * on_j + relative * push_j) * -cube + by_newton[i] * (3.5 * inverse)) * gm[i];
            a[j] += other * INVERSE_C2;
        }
        a[i] += own * INVERSE_C2;
        row = row.get(n - 1 - i..).unwrap_or_default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::integrate::gauss_radau::GaussRadau;
    use crate::orbit::integrate::{Force, Points};
    use crate::space::Centred;
    use crate::units::{ARCSEC, DAY, JULIAN_CENTURY};
    use std::cell::RefCell;

    const SUN: f64 = 1.327_124_400_4e20;

    #[test]
    fn a_light_body_about_one_at_rest_feels_schwarzschild_s_term() {
        let (q, v) = ([DVec3::ZERO, DVec3::new(4.6e10, 1.0e10, -3.0e9)], [DVec3::ZERO, DVec3::new(-9.0e3, 5.6e4, 7.0e3)]);
        let (mut with, mut without) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        einstein_infeld_hoffmann(&[SUN, 1.0], 2, &q, &v, &mut with, &mut Pairs::default());
        newton(&[SUN, 1.0], 2, &q, &mut without, &mut Pairs::default());
        let closed = schwarzschild::<Centred>(SUN, Position::new(q[1]), Velocity::new(v[1])).0;
        assert!(((with[1] - without[1]) - closed).length() < 1e-8 * closed.length());
        // As one of the light ones it has Newton's alone.
        einstein_infeld_hoffmann(&[SUN, 1.0], 1, &q, &v, &mut with, &mut Pairs::default());
        assert_eq!(with[1], without[1]);
    }

    #[test]
    fn two_bodies_of_like_mass_follow_the_closed_form() {
        // Relative acceleration in the frame of the centre of mass [Damour & Deruelle 1985, eq. 2.5]: η = m₁m₂/M².
        let (m1, m2) = (3.0e20, 1.0e20);
        let (total, eta) = (m1 + m2, m1 * m2 / ((m1 + m2) * (m1 + m2)));
        let (r, v) = (DVec3::new(3.0e9, -1.0e9, 5.0e8), DVec3::new(1.1e5, 2.9e5, -4.0e4));
        let q = [r * (m2 / total), r * (-m1 / total)];
        let w = [v * (m2 / total), v * (-m1 / total)];
        let (mut with, mut without) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        einstein_infeld_hoffmann(&[m1, m2], 2, &q, &w, &mut with, &mut Pairs::default());
        newton(&[m1, m2], 2, &q, &mut without, &mut Pairs::default());
        let ours = (with[0] - with[1]) - (without[0] - without[1]);
        let (d, n) = (r.length(), r.normalize());
        let rate = n.dot(v);
        let radial = -2.0 * (2.0 + eta) * total / d + (1.0 + 3.0 * eta) * v.length_squared() - 1.5 * eta * rate * rate;
        let closed = (n * radial - v * (2.0 * (2.0 - eta) * rate)) * (-total * INVERSE_C2 / (d * d));
        assert!((ours - closed).length() < 1e-9 * closed.length(), "{ours} {closed}");
    }

    struct Two(RefCell<Pairs>);
    impl Force for Two {
        const USES_VELOCITY: bool = true;
        fn accelerations(&self, _: f64, q: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
            einstein_infeld_hoffmann(&[SUN, 2.203_186_9e13], 2, q, v, a, &mut self.0.borrow_mut());
        }
    }

    #[test]
    fn mercury_s_perihelion_advances_42_98_arcseconds_a_century() {
        let (a, e) = (5.790_905e10, 0.205_630);
        let gm = SUN + 2.203_186_9e13;
        let speed = (gm / a * (1.0 + e) / (1.0 - e)).sqrt();
        let mut points = Points { t: 0.0, q: vec![DVec3::ZERO, DVec3::X * (a * (1.0 - e))], v: vec![DVec3::ZERO, DVec3::Y * speed] };
        let mut method = GaussRadau::new(2, GaussRadau::TOLERANCE);
        let force = Two(RefCell::default());
        // The direction of the eccentricity vector, averaged over a revolution.
        let mut mean = |from_s: f64| {
            let mut sum = DVec3::ZERO;
            for k in 0..200 {
                method.run(&force, &mut points, from_s + f64::from(k) * (87.969_26 * DAY / 200.0));
                let (r, v) = (points.q[1] - points.q[0], points.v[1] - points.v[0]);
                sum += v.cross(r.cross(v)) / gm - r / r.length();
            }
            libm::atan2(sum.y, sum.x)
        };
        let (first, last) = (mean(0.0), mean(100.0 * 87.969_26 * DAY));
        let advance = (last - first) / ARCSEC * (JULIAN_CENTURY / (100.0 * 87.969_26 * DAY));
        assert!((advance - 42.98).abs() < 0.03, "{advance}″");
    }
}
