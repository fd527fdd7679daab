//! The path ahead as a conic about the dominating body: its shape for drawing, apsides, and where it meets the ground.
//!
//! `r(ν) = p / (1 + e cos ν)` [Bate, Mueller & White 1971, eq. 1.5-4]. Not here: propagation (`engine::orbit::kepler`).

use engine::orbit::State;
use engine::space::Centred;
use glam::DVec3;

/// A conic in its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    gm: f64,
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
        Some(Self { gm, p: hh / gm, e, to_periapsis, ahead, anomaly })
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

    /// Periapsis and apoapsis distances; the latter infinite on an escape path.
    pub fn apsides(&self) -> (f64, f64) {
        (self.p / (1.0 + self.e), if self.e < 1.0 { self.p / (1.0 - self.e) } else { f64::INFINITY })
    }

    /// True anomaly at which the path, going on from now, comes down to `radius_m`; `None` if it never does.
    pub fn meets(&self, radius_m: f64) -> Option<f64> {
        let c = (self.p / radius_m - 1.0) / self.e;
        if !(-1.0..=1.0).contains(&c) || self.radius(self.anomaly) < radius_m {
            return None;
        }
        // Coming down is before the periapsis.
        let down = -libm::acos(c);
        let ahead = if down >= self.anomaly { down } else { down + core::f64::consts::TAU };
        (self.e < 1.0 || down >= self.anomaly).then_some(ahead)
    }

    /// Seconds from now to a true anomaly that lies ahead.
    pub fn time_to(&self, anomaly: f64) -> f64 {
        let turns = if self.e < 1.0 { ((anomaly + core::f64::consts::PI) / core::f64::consts::TAU).floor() } else { 0.0 };
        let within = anomaly - turns * core::f64::consts::TAU;
        let period = if self.e < 1.0 {
            let a = self.p / (1.0 - self.e * self.e);
            core::f64::consts::TAU * (a * a * a / self.gm).sqrt()
        } else {
            0.0
        };
        self.since_periapsis(within) - self.since_periapsis(self.anomaly) + turns * period
    }

    /// Seconds since the periapsis at a true anomaly in (−π, π) [Bate, Mueller & White 1971, §4.2].
    fn since_periapsis(&self, anomaly: f64) -> f64 {
        let e = self.e;
        let t = libm::tan(0.5 * anomaly);
        if (e - 1.0).abs() < 1e-8 {
            return 0.5 * (self.p * self.p * self.p / self.gm).sqrt() * (t + t * t * t / 3.0);
        }
        if e < 1.0 {
            let a = self.p / (1.0 - e * e);
            let big_e = 2.0 * libm::atan(((1.0 - e) / (1.0 + e)).sqrt() * t);
            (a * a * a / self.gm).sqrt() * (big_e - e * libm::sin(big_e))
        } else {
            let a = self.p / (e * e - 1.0);
            let h = 2.0 * libm::atanh((((e - 1.0) / (e + 1.0)).sqrt() * t).clamp(-1.0 + 1e-15, 1.0 - 1e-15));
            (a * a * a / self.gm).sqrt() * (e * libm::sinh(h) - h)
        }
    }

    /// True anomalies for drawing, from now on: once round, or out to `far_m` on an escape path.
    pub fn ahead_of_now(&self, steps: u32, far_m: f64) -> Vec<f64> {
        let last = if self.e < 1.0 {
            self.anomaly + core::f64::consts::TAU
        } else {
            let c = ((self.p / far_m - 1.0) / self.e).clamp(-1.0, 1.0);
            (libm::acos(c) - 1e-6).max(self.anomaly)
        };
        (0..=steps).map(|i| self.anomaly + (last - self.anomaly) * f64::from(i) / f64::from(steps)).collect()
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
    fn a_transfer_ellipse_has_its_textbook_apsides_and_times() {
        // 6,778 km × 42,164 km about the Earth: half the period is 5.27 h.
        let (rp, ra) = (6.778e6, 42.164e6);
        let a: f64 = 0.5 * (rp + ra);
        let v = (GM * (2.0 / rp - 1.0 / a)).sqrt();
        let conic = Conic::new(GM, &state(DVec3::X * rp, DVec3::new(0.0, v * 0.8, v * 0.6))).unwrap();
        let (p, q) = conic.apsides();
        assert!((p - rp).abs() < 1.0 && (q - ra).abs() < 1.0);
        let half = core::f64::consts::PI * (a * a * a / GM).sqrt();
        assert!((conic.time_to(core::f64::consts::PI - 1e-9) / half - 1.0).abs() < 1e-6);
        assert!((conic.time_to(core::f64::consts::TAU) / (2.0 * half) - 1.0).abs() < 1e-9);
        assert!((conic.point(conic.anomaly) - DVec3::X * rp).length() < 1e-3);
        assert_eq!(conic.meets(6.4e6), None);
    }

    #[test]
    fn a_path_down_meets_the_ground_where_it_is_as_far_as_the_ground() {
        let r = DVec3::new(6.8e6, 0.0, 0.0);
        let conic = Conic::new(GM, &state(r, DVec3::new(500.0, 6_800.0, 0.0))).unwrap();
        let at = conic.meets(6.371e6).unwrap();
        assert!((conic.point(at).length() - 6.371e6).abs() < 1e-2);
        // Climbing still: it goes over the top first, and the same by stepping the fall.
        let seconds = conic.time_to(at);
        let (mut x, mut v, dt) = (r, DVec3::new(500.0, 6_800.0, 0.0), 0.01);
        let mut t = 0.0;
        while x.length() > 6.371e6 {
            v -= x * (GM / (x.length_squared() * x.length())) * dt;
            x += v * dt;
            t += dt;
        }
        assert!((seconds - t).abs() < 0.5, "{seconds} {t}");
    }

    #[test]
    fn an_escape_ends_at_the_far_side_and_a_straight_fall_is_none() {
        let conic = Conic::new(GM, &state(DVec3::X * 7.0e6, DVec3::Y * 12_000.0)).unwrap();
        assert!(conic.e > 1.0 && conic.apsides().1.is_infinite());
        let last = *conic.ahead_of_now(64, 9.0e8).last().unwrap();
        assert!((conic.radius(last) / 9.0e8 - 1.0).abs() < 0.01);
        assert_eq!(Conic::new(GM, &state(DVec3::X, DVec3::X)), None);
        assert_eq!(Conic::new(GM, &state(DVec3::NAN, DVec3::X)), None);
    }
}
