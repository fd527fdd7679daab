//! What paths ask of the conic ephemeris: its motion over short pieces as polynomials, fitted through Chebyshev's nodes.
//!
//! Pieces begin at fixed multiples of a power of two of ticks, so an answer depends on the moment alone.

use super::model::Places;
use crate::orbit::ephemeris::Ephemeris;
use crate::orbit::{BodyId, State};
use crate::space::{Icrf, Position, Velocity};
use crate::time::{Moment, SimTime};
use core::f64::consts::PI;
use glam::DVec3;

/// Nodes of a fit.
const NODES: usize = 18;

impl Ephemeris {
    /// Ticks of the pieces for a pair of bodies: the fastest between them turns by less than two radians in one.
    fn piece_ticks(&self, a: BodyId, b: BodyId) -> i64 {
        let mut ticks: i64 = 1 << 22;
        for id in [a, b] {
            let reach = self.reach(id);
            let rate = reach.fastest_m_s / reach.nearest_m;
            while rate.is_finite() && rate * SimTime::from_ticks(ticks).seconds() > 2.0 && ticks > 256 {
                ticks /= 2;
            }
        }
        ticks
    }
}

impl Places for Ephemeris {
    fn relative_at(&self, body: BodyId, center: BodyId, at: Moment) -> State<Icrf> {
        let mut c = [DVec3::ZERO; NODES];
        self.series(body, center, at, &mut c);
        State { position: Position::new(c[0]), velocity: Velocity::new(c[1]) }
    }

    #[allow(clippy::cast_possible_truncation)]
    fn series(&self, body: BodyId, center: BodyId, at: Moment, out: &mut [DVec3]) -> f64 {
        out.fill(DVec3::ZERO);
        let ticks = self.piece_ticks(body, center);
        let begin = at.tick.ticks.div_euclid(ticks) * ticks;
        let end = SimTime::from_ticks(begin + ticks);
        let mut nodes = [0.0; NODES];
        let mut divided = [DVec3::ZERO; NODES];
        for (i, (t, d)) in nodes.iter_mut().zip(&mut divided).enumerate() {
            let x = libm::cos(PI * (i as f64 + 0.5) / NODES as f64);
            let tick = SimTime::from_ticks(begin + ((0.5 - 0.5 * x) * ticks as f64) as i64);
            *t = Moment::from(tick).since(at);
            *d = self.relative(body, center, tick).position.0;
        }
        // Newton's divided differences, then to powers of the time since `at` (which is the origin of the nodes).
        for order in 1..NODES {
            for i in (order..NODES).rev() {
                divided[i] = (divided[i] - divided[i - 1]) / (nodes[i] - nodes[i - order]);
            }
        }
        let mut c = [DVec3::ZERO; NODES];
        for i in (0..NODES).rev() {
            for k in (0..NODES).rev() {
                c[k] = if k > 0 { c[k - 1] } else { DVec3::ZERO } - c[k] * nodes[i];
            }
            c[0] += divided[i];
        }
        for (o, c) in out.iter_mut().zip(c) {
            *o = c;
        }
        Moment::from(end).since(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::ephemeris::{Orbit, Path};

    #[test]
    fn the_polynomial_is_the_ephemeris() {
        let epoch = SimTime::from_ticks(1_000_000);
        let body = |parent, gm, path| Orbit { parent, gm_m3_s2: gm, path };
        let state = State { position: Position::xyz(3.8e8, 0.0, 1e6), velocity: Velocity::xyz(0.0, 1.03e3, 50.0) };
        let rest = Path::Barycentric { epoch, state: State::default(), of_system: false };
        let orbits = vec![body(None, 3.986e14, rest), body(Some(BodyId(0)), 4.9e12, Path::FromParent { epoch, state })];
        let e = Ephemeris::new(orbits).unwrap();
        let at = Moment { tick: SimTime::from_ticks(77_000_123), beyond_s: 0.01 };
        let mut c = [DVec3::ZERO; 23];
        let valid = e.series(BodyId(1), BodyId(0), at, &mut c);
        assert!(valid > 0.0);
        for part in [0.0, 0.3, 0.99] {
            let t = at.plus_s(part * valid);
            let tick = SimTime::from_ticks(t.tick.ticks);
            let dt = Moment::from(tick).since(at);
            let p = c.iter().rev().fold(DVec3::ZERO, |s, c| s * dt + *c);
            assert!((p - e.relative(BodyId(1), BodyId(0), tick).position.0).length() < 1e-5, "{part}");
        }
    }
}
