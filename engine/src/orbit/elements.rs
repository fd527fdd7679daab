//! Osculating elements: an orbit as numbers for people, from a state and back, for every conic.
//!
//! The shape is kept as periapsis radius and eccentricity, which stay finite on a parabola; the rest is derived. Angles that
//! do not exist are zero by convention: on a circle periapsis is the ascending node, in the reference plane the node is +X.
//! Not here: propagation (`kepler`).
//! - [Battin 1999] "An Introduction to the Mathematics and Methods of Astrodynamics", §3.3–3.5, §4.5.
//! - [Vallado 2013] "Fundamentals of Astrodynamics and Applications", algorithms 9 and 10.

use super::State;
use super::kepler::{Conic, Universal};
use crate::space::{Frame, Position, Velocity};
use core::f64::consts::{PI, TAU};
use glam::DVec3;

/// A conic about a centre, and where on it. Angles refer to the axes of the state that it came from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Elements {
    /// Gravitational parameter, m³/s².
    pub gm_m3_s2: f64,
    /// Periapsis radius q, m; 0 on a radial path.
    pub periapsis_m: f64,
    /// Eccentricity e ≥ 0.
    pub eccentricity: f64,
    /// 1/a = 2/r − v²/μ, 1/m: positive on an ellipse, negative on a hyperbola.
    pub inverse_semi_major_per_m: f64,
    /// Inclination i to the xy plane, rad, 0 … π.
    pub inclination_rad: f64,
    /// Longitude of the ascending node Ω, rad, 0 … 2π.
    pub node_rad: f64,
    /// Argument of periapsis ω, rad, 0 … 2π.
    pub argument_rad: f64,
    /// True anomaly ν, rad, −π … π.
    pub true_anomaly_rad: f64,
}

/// An angle brought into 0 … 2π.
fn positive(angle: f64) -> f64 {
    let a = libm::fmod(angle, TAU);
    if a < 0.0 { a + TAU } else { a }
}

/// Eccentricity, and sine of inclination, below which the direction of periapsis, and of the node, is only rounding.
const TINY: f64 = 1e-11;

impl Elements {
    /// From a state about a centre of gravitational parameter `gm` (m³/s²). All zero where there is no orbit (r = 0, gm ≤ 0).
    pub fn from_state<F: Frame>(gm: f64, state: &State<F>) -> Self {
        let (r, v) = (state.position.0, state.velocity.0);
        let distance = r.length();
        if !(gm > 0.0 && distance > 0.0) {
            return Self::default();
        }
        let h = r.cross(v);
        let h2 = h.length_squared();
        let inverse_a = 2.0 / distance - v.length_squared() / gm;
        // Lenz's vector towards periapsis; on a radial path away from the centre, which puts ν at ±π.
        let lenz = v.cross(h) / gm - r / distance;
        let e = lenz.length();
        let axis = h.normalize_or(r.any_orthogonal_vector().normalize_or(DVec3::Z));
        let node_line = DVec3::new(-axis.y, axis.x, 0.0);
        let flat = node_line.length() < TINY;
        let node = if flat { DVec3::X } else { node_line / node_line.length() };
        let across = axis.cross(node);
        let in_plane = |p: DVec3| libm::atan2(p.dot(across), p.dot(node));
        let argument = if e < TINY { 0.0 } else { in_plane(lenz) };
        let anomaly = libm::remainder(in_plane(r) - argument, TAU);
        Self {
            gm_m3_s2: gm,
            periapsis_m: h2 / gm / (1.0 + e),
            eccentricity: e,
            inverse_semi_major_per_m: inverse_a,
            inclination_rad: libm::atan2(libm::hypot(axis.x, axis.y), axis.z),
            node_rad: if flat { 0.0 } else { positive(libm::atan2(node.y, node.x)) },
            argument_rad: positive(argument),
            true_anomaly_rad: anomaly,
        }
    }

    /// From semi-major axis (m, negative on a hyperbola), eccentricity, and the angles i, Ω, ω, M (rad).
    pub fn from_mean(gm: f64, semi_major_m: f64, eccentricity: f64, angles_rad: [f64; 4]) -> Self {
        let [inclination, node, argument, mean] = angles_rad;
        let inverse_a = 1.0 / semi_major_m;
        let mut elements = Self {
            gm_m3_s2: gm,
            periapsis_m: semi_major_m * (1.0 - eccentricity),
            eccentricity,
            inverse_semi_major_per_m: inverse_a,
            inclination_rad: inclination,
            node_rad: node,
            argument_rad: argument,
            true_anomaly_rad: 0.0,
        };
        let rate = (gm * inverse_a.abs()).sqrt() * inverse_a.abs();
        let mean = if inverse_a > 0.0 { libm::remainder(mean, TAU) } else { mean };
        let at = elements.to_state::<crate::space::Centred>();
        let (r, v) = Conic::new(gm, at.position.0, at.velocity.0).after_raw(mean / rate);
        let here = State::<crate::space::Centred> { position: Position::new(r), velocity: Velocity::new(v) };
        elements.true_anomaly_rad = elements.anomaly_of(&here);
        elements
    }

    fn anomaly_of<F: Frame>(&self, state: &State<F>) -> f64 {
        let (p, q) = self.perifocal();
        libm::atan2(state.position.0.dot(q), state.position.0.dot(p))
    }

    /// Unit vectors towards periapsis and, in the plane, 90° ahead of it.
    fn perifocal(&self) -> (DVec3, DVec3) {
        let (so, co) = libm::sincos(self.node_rad);
        let (si, ci) = libm::sincos(self.inclination_rad);
        let (sw, cw) = libm::sincos(self.argument_rad);
        let node = DVec3::new(co, so, 0.0);
        let across = DVec3::new(-so * ci, co * ci, si);
        (node * cw + across * sw, across * cw - node * sw)
    }

    /// The state. Radial paths have no state in elements (q = 0): the centre is returned.
    pub fn to_state<F: Frame>(&self) -> State<F> {
        let (p, q) = self.perifocal();
        let (sin, cos) = libm::sincos(self.true_anomaly_rad);
        let semi_latus = self.periapsis_m * (1.0 + self.eccentricity);
        let r = if semi_latus > 0.0 { semi_latus / (1.0 + self.eccentricity * cos) } else { 0.0 };
        let speed = if semi_latus > 0.0 { (self.gm_m3_s2 / semi_latus).sqrt() } else { 0.0 };
        State {
            position: Position::new((p * cos + q * sin) * r),
            velocity: Velocity::new((q * (self.eccentricity + cos) - p * sin) * speed),
        }
    }

    /// True where the path comes back.
    pub fn is_bound(&self) -> bool {
        self.inverse_semi_major_per_m > 0.0
    }
    /// Semi-major axis, m: negative on a hyperbola, infinite on a parabola.
    pub fn semi_major_m(&self) -> f64 {
        1.0 / self.inverse_semi_major_per_m
    }
    /// Apoapsis radius, m; infinite on open paths.
    pub fn apoapsis_m(&self) -> f64 {
        if self.is_bound() { (1.0 + self.eccentricity) / self.inverse_semi_major_per_m } else { f64::INFINITY }
    }
    /// Period, s; infinite on open paths.
    pub fn period_s(&self) -> f64 {
        if self.is_bound() { TAU / self.mean_motion_rad_s() } else { f64::INFINITY }
    }
    /// Mean motion √(μ/|a|³), rad/s; 0 on a parabola.
    pub fn mean_motion_rad_s(&self) -> f64 {
        let k = self.inverse_semi_major_per_m.abs();
        (self.gm_m3_s2 * k).sqrt() * k
    }
    /// Speed at periapsis, m/s: the greatest on the path; infinite on a radial one.
    pub fn fastest_m_s(&self) -> f64 {
        ((1.0 + self.eccentricity) * self.gm_m3_s2 / self.periapsis_m).sqrt()
    }
    /// Mean anomaly, rad (on open paths: mean motion × time since periapsis).
    pub fn mean_anomaly_rad(&self) -> f64 {
        self.mean_motion_rad_s() * self.since_periapsis_s()
    }

    /// Seconds since the nearest periapsis passage at true anomaly ν: negative before it, within ± half a period on an ellipse;
    /// infinite where an open path does not reach.
    pub fn since_periapsis_at(&self, true_anomaly_rad: f64) -> f64 {
        let nu = libm::remainder(true_anomaly_rad, TAU);
        let (e, q, gm) = (self.eccentricity, self.periapsis_m, self.gm_m3_s2);
        if q <= 0.0 || gm <= 0.0 {
            return 0.0;
        }
        if self.is_bound() && e < 0.9 {
            let (sin, cos) = libm::sincos(nu);
            let root = (1.0 - e * e).sqrt();
            let anomaly = libm::atan2(root * sin, e + cos);
            return (anomaly - e * libm::sin(anomaly)) / self.mean_motion_rad_s();
        }
        // Near e = 1 through the universal anomaly from periapsis, where r = q and r·v = 0: t = qG₁ + μG₃.
        if nu.abs() >= PI {
            return (0.5 * self.period_s()).copysign(nu);
        }
        let w = libm::tan(0.5 * nu);
        let k = (1.0 - e) / (1.0 + e) * w * w;
        let arc = if k.abs() < 1e-2 {
            // atan(√k)/√k, and its continuation atanh for k < 0.
            1.0 - k * (1.0 / 3.0 - k * (1.0 / 5.0 - k * (1.0 / 7.0 - k * (1.0 / 9.0 - k / 11.0))))
        } else if k > 0.0 {
            libm::atan(k.sqrt()) / k.sqrt()
        } else if k > -1.0 {
            libm::atanh((-k).sqrt()) / (-k).sqrt()
        } else {
            return f64::INFINITY.copysign(nu);
        };
        let s = 2.0 * w * arc * (q / (gm * (1.0 + e))).sqrt();
        let g = Universal::at(gm * (1.0 - e) / q, s);
        q * g.g1 + gm * g.g3
    }

    /// Seconds since the nearest periapsis passage (negative: it lies ahead).
    pub fn since_periapsis_s(&self) -> f64 {
        self.since_periapsis_at(self.true_anomaly_rad)
    }

    /// Seconds to the next periapsis; negative when it has been passed on an open path.
    pub fn to_periapsis_s(&self) -> f64 {
        let since = self.since_periapsis_s();
        if self.is_bound() && since > 0.0 { self.period_s() - since } else { -since }
    }

    /// Seconds to the next apoapsis; infinite on open paths.
    pub fn to_apoapsis_s(&self) -> f64 {
        if self.is_bound() { 0.5 * self.period_s() - self.since_periapsis_s() } else { f64::INFINITY }
    }

    /// True anomaly (0 … π) at which the path reaches a radius on its way out; `None` where it never does.
    pub fn anomaly_at_radius(&self, radius_m: f64) -> Option<f64> {
        if self.eccentricity < TINY || radius_m <= 0.0 {
            return None;
        }
        let semi_latus = self.periapsis_m * (1.0 + self.eccentricity);
        let cos = (semi_latus / radius_m - 1.0) / self.eccentricity;
        let open_limit = if self.is_bound() { -1.0 } else { -1.0 / self.eccentricity };
        (cos >= open_limit && cos <= 1.0).then(|| libm::acos(cos))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::kepler::propagate;
    use crate::space::Centred;

    type S = State<Centred>;
    const GM: f64 = 3.986_004_418e14;

    #[test]
    fn vallado_example_2_5() {
        // Vallado 2013, example 2-5 (km, km/s): a published state and its elements.
        let s = S {
            position: Position::xyz(6_524.834e3, 6_862.875e3, 6_448.296e3),
            velocity: Velocity::xyz(4.901_327e3, 5.533_756e3, -1.976_341e3),
        };
        let e = Elements::from_state(GM, &s);
        let deg = 180.0 / PI;
        assert!((e.semi_major_m() - 36_127.343e3).abs() < 20.0, "{}", e.semi_major_m());
        assert!((e.eccentricity - 0.832_853).abs() < 1e-6);
        for (got, published) in
            [(e.inclination_rad, 87.870), (e.node_rad, 227.898), (e.argument_rad, 53.38), (positive(e.true_anomaly_rad), 92.335)]
        {
            assert!((got * deg - published).abs() < 6e-3, "{} for {published}", got * deg);
        }
    }

    #[test]
    fn every_conic_round_trips() {
        for e in [0.0, 1e-5, 0.5, 0.999_999, 1.0, 1.000_001, 3.0] {
            for [i, node, argument] in [[0.0, 0.0, 0.0], [0.7, 2.0, 5.0], [2.9, 4.0, 1.0]] {
                for nu in [-1.4, 0.0, 0.3, 1.5] {
                    let given = Elements {
                        gm_m3_s2: GM,
                        periapsis_m: 7.0e6,
                        eccentricity: e,
                        inverse_semi_major_per_m: (1.0 - e) / 7.0e6,
                        inclination_rad: i,
                        node_rad: node,
                        argument_rad: if e == 0.0 { 0.0 } else { argument },
                        true_anomaly_rad: nu,
                    };
                    let s: S = given.to_state();
                    let found = Elements::from_state(GM, &s);
                    assert!((found.periapsis_m / 7.0e6 - 1.0).abs() < 1e-13 && (found.eccentricity - e).abs() < 1e-13, "{given:?}");
                    let back: S = found.to_state();
                    assert!((back.position - s.position).length() < 1e-5, "{given:?} {found:?}");
                    assert!((back.velocity.0 - s.velocity.0).length() < 1e-8, "{given:?} {found:?}");
                }
            }
        }
    }

    #[test]
    fn times_agree_with_propagation() {
        for e in [0.01, 0.6, 0.95, 0.999_999_9, 1.0, 1.000_000_1, 2.5] {
            let given = Elements {
                gm_m3_s2: GM,
                periapsis_m: 7.0e6,
                eccentricity: e,
                inverse_semi_major_per_m: (1.0 - e) / 7.0e6,
                inclination_rad: 0.4,
                true_anomaly_rad: -1.2,
                ..Elements::default()
            };
            let s: S = given.to_state();
            let at_periapsis = propagate(GM, &s, given.to_periapsis_s());
            assert!((at_periapsis.position.length() / 7.0e6 - 1.0).abs() < 1e-12, "e = {e}");
            assert!(at_periapsis.position.0.dot(at_periapsis.velocity.0).abs() < 1e-4 * 7.0e6, "e = {e}");
            if e < 0.99 {
                let top = propagate(GM, &s, given.to_apoapsis_s());
                assert!((top.position.length() / given.apoapsis_m() - 1.0).abs() < 1e-12, "e = {e}");
            }
            let nu = given.anomaly_at_radius(9.0e6);
            if let Some(nu) = nu {
                let out = propagate(GM, &s, given.since_periapsis_at(nu) - given.since_periapsis_s());
                assert!((out.position.length() / 9.0e6 - 1.0).abs() < 1e-11, "e = {e}: {}", out.position.length());
            } else {
                assert!(e < 0.1, "e = {e} reaches 9,000 km");
            }
        }
    }

    #[test]
    fn a_radial_path_and_nothing_at_all_are_told_without_nan() {
        let up = S { position: Position::xyz(7.0e6, 0.0, 0.0), velocity: Velocity::xyz(100.0, 0.0, 0.0) };
        let e = Elements::from_state(GM, &up);
        assert!(e.periapsis_m == 0.0 && (e.eccentricity - 1.0).abs() < 1e-12 && e.is_bound());
        for x in [e.apoapsis_m(), e.period_s(), e.to_periapsis_s(), e.to_apoapsis_s(), e.inclination_rad, e.argument_rad] {
            assert!(x.is_finite(), "{e:?}");
        }
        assert_eq!(Elements::from_state(0.0, &up), Elements::default());
        assert!(e.to_state::<Centred>().position.is_finite());
    }

    #[test]
    fn mean_anomaly_goes_in_and_comes_out() {
        for mean in [-2.0, 0.1, 3.0] {
            let e = Elements::from_mean(GM, 9.0e6, 0.2, [0.3, 1.0, 2.0, mean]);
            assert!((e.mean_anomaly_rad() - mean).abs() < 1e-13, "{}", e.mean_anomaly_rad());
        }
    }
}
