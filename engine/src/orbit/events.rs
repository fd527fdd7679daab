//! Events on an arc: the first tick at which a coasting ship is inside or outside a radius, or inside a moon's sphere of
//! influence. Found on the path itself, so an answer depends on the arc and the ticks asked for, never on warp or frame rate,
//! and no event is stepped over:
//! - a radius: distance is monotonic between apsides, whose times are known; integer bisection does the rest;
//! - a moon: steps are no longer than the gap divided by the greatest closing speed (conservative advancement), and only
//!   while the ship is in the shell of radii that the moon's sphere can touch.
//!
//! Not here: what to do about an event (`game::world`).

use super::arc::Arc;
use super::elements::Elements;
use crate::space::{Centred, Position};
use crate::time::{SimTime, TICKS_PER_SECOND};

/// Where a child body can be, seen from its parent: the shell that its path stays in, and its greatest speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// Least distance from the parent, m.
    pub nearest_m: f64,
    /// Greatest distance from the parent, m.
    pub farthest_m: f64,
    /// Greatest speed relative to the parent, m/s.
    pub fastest_m_s: f64,
}

/// Ticks in `s` seconds, rounded down, kept within what a search may span.
#[allow(clippy::cast_possible_truncation)]
fn ticks(s: f64) -> i64 {
    // ±3 million years.
    (s * TICKS_PER_SECOND as f64).floor().clamp(-6e15, 6e15) as i64
}

impl Arc {
    /// First tick in `from ..= until` at which the distance from the centre is below `radius_m` (the top of an atmosphere,
    /// the ground). A dip that begins and ends between two ticks (1/60 s) is no event.
    pub fn first_below(&self, radius_m: f64, from: SimTime, until: SimTime) -> Option<SimTime> {
        self.crossing(radius_m, from, until, true)
    }

    /// First tick in `from ..= until` at which the distance from the centre is above `radius_m` (the edge of the sphere of influence).
    pub fn first_above(&self, radius_m: f64, from: SimTime, until: SimTime) -> Option<SimTime> {
        self.crossing(radius_m, from, until, false)
    }

    fn crossing(&self, radius_m: f64, from: SimTime, until: SimTime, inwards: bool) -> Option<SimTime> {
        let hit = |t: SimTime| {
            let r = self.radius_m(t);
            if inwards { r < radius_m } else { r > radius_m }
        };
        if until < from {
            return None;
        }
        if hit(from) {
            return Some(from);
        }
        let orbit = Elements::from_state(self.gm_m3_s2, &self.sample(from));
        let extreme = if inwards { orbit.periapsis_m } else { orbit.apoapsis_m() };
        let out_of_reach = if inwards { extreme >= radius_m } else { extreme <= radius_m };
        if out_of_reach {
            return None;
        }
        // The next apsis of the wanted kind; the ticks around it are the most extreme of all.
        let wait_s = match (inwards, orbit.is_bound()) {
            (true, _) => orbit.to_periapsis_s(),
            (false, true) => orbit.to_apoapsis_s(),
            (false, false) => f64::INFINITY,
        };
        let mut high = if wait_s.is_finite() {
            let apsis = from.plus(ticks(wait_s));
            // The apsis itself may round to either side, and to a tick before `from`.
            *[apsis, apsis.plus(1), apsis.plus(2)].iter().find(|t| **t > from && hit(**t))?
        } else {
            // An open path only moves away, once past periapsis: double until it is out.
            let mut span = TICKS_PER_SECOND;
            loop {
                let t = from.plus(span);
                if hit(t) {
                    break t;
                }
                if t >= until {
                    return None;
                }
                span = span.saturating_mul(2);
            }
        };
        // Going in from beyond an apoapsis, or out from before a periapsis, the distance first moves away from the wanted
        // radius without reaching it; from there on it is monotonic, so plain bisection finds the first tick.
        let mut low = from;
        while high.ticks - low.ticks > 1 {
            let middle = SimTime::from_ticks(low.ticks + (high.ticks - low.ticks) / 2);
            if hit(middle) { high = middle } else { low = middle }
        }
        (high <= until).then_some(high)
    }

    /// First tick in `from ..= until` at which the ship is less than `soi_radius_m` from a child of the arc's body.
    /// `child` gives the child's position from the same centre; `reach` bounds it.
    pub fn first_within(
        &self,
        soi_radius_m: f64,
        reach: &Reach,
        child: impl Fn(SimTime) -> Position<Centred>,
        from: SimTime,
        until: SimTime,
    ) -> Option<SimTime> {
        let (inner, outer) = (reach.nearest_m - soi_radius_m, reach.farthest_m + soi_radius_m);
        let orbit = Elements::from_state(self.gm_m3_s2, &self.sample(from));
        if orbit.apoapsis_m() < inner || orbit.periapsis_m > outer {
            return None;
        }
        // Vis-viva at the inner edge of the shell bounds the ship's speed anywhere in it.
        let edge = inner.max(orbit.periapsis_m).max(1.0);
        let ship_speed = (self.gm_m3_s2 * (2.0 / edge - orbit.inverse_semi_major_per_m)).max(0.0).sqrt();
        let closing = (ship_speed + reach.fastest_m_s).max(1e-3);
        let mut t = from;
        while t <= until {
            let ship = self.sample(t).position;
            let r = ship.length();
            if r < inner {
                t = self.first_above(inner, t, until)?;
            } else if r > outer {
                t = self.first_below(outer, t, until)?;
            } else {
                let gap = (ship - child(t)).length() - soi_radius_m;
                if gap < 0.0 {
                    return Some(t);
                }
                t = t.plus(ticks(gap / closing).max(1));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::orbit::{BodyId, State};
    use crate::space::Velocity;

    const GM: f64 = 3.986_004_355_07e14;

    fn arc(position: [f64; 3], velocity: [f64; 3]) -> Arc {
        Arc {
            body: BodyId(3),
            gm_m3_s2: GM,
            epoch: SimTime::from_ticks(0),
            state: State { position: Position::new(position.into()), velocity: Velocity::new(velocity.into()) },
        }
    }

    /// The definition, tick by tick.
    fn by_hand(a: &Arc, span: i64, hit: impl Fn(f64) -> bool) -> Option<SimTime> {
        (0..=span).map(SimTime::from_ticks).find(|t| hit(a.radius_m(*t)))
    }

    #[test]
    fn the_first_tick_is_the_first_tick() {
        let falling = arc([6.8e6, 0.0, 0.0], [300.0, 7.3e3, 0.0]);
        let rising = arc([6.5e6, 1.0e5, 0.0], [-500.0, 8.9e3, 100.0]);
        let open = arc([7.0e6, 0.0, 0.0], [-2.0e3, 1.2e4, 0.0]);
        let until = SimTime::from_ticks(400_000);
        for a in [falling, rising, open] {
            for radius in [6.471e6, 6.45e6, 6.9e6, 8.0e6] {
                let below = by_hand(&a, 400_000, |r| r < radius);
                assert_eq!(a.first_below(radius, a.epoch, until), below, "below {radius} on {a:?}");
                let above = by_hand(&a, 400_000, |r| r > radius);
                assert_eq!(a.first_above(radius, a.epoch, until), above, "above {radius} on {a:?}");
            }
        }
    }

    #[test]
    fn an_event_beyond_the_horizon_is_none_and_one_at_the_horizon_is_found() {
        let a = arc([6.8e6, 0.0, 0.0], [300.0, 7.3e3, 0.0]);
        let t = a.first_below(6.471e6, a.epoch, SimTime::from_ticks(400_000)).unwrap();
        assert_eq!(a.first_below(6.471e6, a.epoch, t), Some(t));
        assert_eq!(a.first_below(6.471e6, a.epoch, t.plus(-1)), None);
        assert_eq!(a.first_below(6.471e6, t.plus(-7), t.plus(9)), Some(t), "asked from elsewhere: the same tick");
    }

    #[test]
    fn a_moon_is_met_at_the_same_tick_as_by_hand() {
        // Hohmann-like transfer to a moon on a circle, met far out.
        let moon = arc([-1.52e8, 3.48e8, 0.0], [-939.0, -408.6, 0.0]);
        let reach = Reach { nearest_m: 3.6e8, farthest_m: 4.1e8, fastest_m_s: 1.1e3 };
        let ship = arc([6.77e6, 0.0, 0.0], [0.0, 10.765e3, 0.0]);
        let (from, until) = (SimTime::from_ticks(0), SimTime::from_ticks(60 * 86_400 * 12));
        let found = ship.first_within(6.6e7, &reach, |t| moon.sample(t).position, from, until).expect("met");
        let gap = |t: SimTime| (ship.sample(t).position - moon.sample(t).position).length();
        assert!(gap(found) < 6.6e7 && gap(found.plus(-1)) >= 6.6e7);
        // No earlier dip: a coarse scan stays outside until then.
        assert!((0..found.ticks - 1).step_by(6_000).all(|k| gap(SimTime::from_ticks(k)) >= 6.6e7));
        let low = arc([6.77e6, 0.0, 0.0], [0.0, 7.67e3, 0.0]);
        assert_eq!(low.first_within(6.6e7, &reach, |t| moon.sample(t).position, from, until), None);
    }
}
