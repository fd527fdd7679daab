//! A body's path as a conic about its parent, as it is now: its shape for drawing.
//!
//! `r(ν) = p / (1 + e cos ν)` [Bate, Mueller & White 1971, eq. 1.5-4]. Not here: propagation (`engine::orbit::kepler`), the ship's
//! path ([`super::map::course`]).

use engine::orbit::State;
use engine::space::Centred;
use glam::DVec3;

/// A conic in its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    /// Semi-latus rectum, m.
    pub p: f64,
    /// Eccentricity.
    pub e: f64,
    /// Unit vector to the periapsis.
    pub to_periapsis: DVec3,
    /// Unit vector 90° ahead of it in the direction of motion.
    pub ahead: DVec3,
    /// True anomaly now, rad.
    pub anomaly: f64,
}

impl Conic {
    /// The conic of a state; `None` for a straight fall or a state that is not finite.
    pub fn new(gm: f64, state: &State<Centred>) -> Option<Self> {
        let (r, v) = (state.position.0, state.velocity.0);
        let h = r.cross(v);
        let (distance, hh) = (r.length(), h.length_squared());
        if !(hh.is_finite() && distance > 0.0 && gm > 0.0) || hh <= 1e-12 * r.length_squared() * v.length_squared() {
            return None;
        }
        let ev = v.cross(h) / gm - r / distance;
        let e = ev.length();
        let to_periapsis = if e > 1e-9 { ev / e } else { r / distance };
        let ahead = h.cross(to_periapsis) / hh.sqrt();
        let anomaly = libm::atan2(r.dot(ahead), r.dot(to_periapsis));
        Some(Self { p: hh / gm, e, to_periapsis, ahead, anomaly })
    }

    /// Distance at a true anomaly, m; infinite beyond the asymptotes.
    pub fn radius(&self, anomaly: f64) -> f64 {
        let d = 1.0 + self.e * libm::cos(anomaly);
        if d > 1e-9 { self.p / d } else { f64::INFINITY }
    }

    /// The point at a true anomaly.
    pub fn point(&self, anomaly: f64) -> DVec3 {
        let (s, c) = libm::sincos(anomaly);
        (self.to_periapsis * c + self.ahead * s) * self.radius(anomaly)
    }

    /// True anomalies for drawing, from now on once round; none on an open path.
    pub fn around(&self, steps: u32) -> Vec<f64> {
        if self.e >= 1.0 {
            return Vec::new();
        }
        (0..=steps).map(|i| self.anomaly + core::f64::consts::TAU * f64::from(i) / f64::from(steps)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::space::{Position, Velocity};

    const GM: f64 = 3.986_004_418e14;

    fn state(r: DVec3, v: DVec3) -> State<Centred> {
        State { position: Position::new(r), velocity: Velocity::new(v) }
    }

    #[test]
    fn a_transfer_ellipse_has_its_textbook_apsides() {
        // 6,778 km × 42,164 km about the Earth.
        let (rp, ra) = (6.778e6, 42.164e6);
        let a: f64 = 0.5 * (rp + ra);
        let v = (GM * (2.0 / rp - 1.0 / a)).sqrt();
        let conic = Conic::new(GM, &state(DVec3::X * rp, DVec3::new(0.0, v * 0.8, v * 0.6))).unwrap();
        let radii: Vec<f64> = conic.around(360).into_iter().map(|n| conic.point(n).length()).collect();
        let (low, high) = (radii.iter().copied().fold(f64::INFINITY, f64::min), radii.iter().copied().fold(0.0, f64::max));
        assert!((low - rp).abs() < 1.0 && (high - ra).abs() < 1.0, "{low} {high}");
        assert!((conic.point(conic.anomaly) - DVec3::X * rp).length() < 1e-3);
        assert!((conic.point(conic.around(90)[90]) - DVec3::X * rp).length() < 1e-3, "it closes");
    }

    #[test]
    fn an_escape_does_not_close_and_a_straight_fall_is_none() {
        let conic = Conic::new(GM, &state(DVec3::X * 7.0e6, DVec3::Y * 12_000.0)).unwrap();
        assert!(conic.e > 1.0 && conic.around(64).is_empty());
        assert_eq!(Conic::new(GM, &state(DVec3::X, DVec3::X)), None);
        assert_eq!(Conic::new(GM, &state(DVec3::NAN, DVec3::X)), None);
    }
}
