//! Warp: how far a coasting ship may be taken at once, and how fast the clock may run.
//!
//! A coasting ship's path finds what it meets by itself, at the root of its own polynomials, while it goes on
//! ([`engine::orbit::path`]): what happens, happens at the same moment at every warp (compare peers' periapsis that moves
//! with warp). Here the path is also followed *ahead*, only to slow the clock down in time: [`Ahead`] remembers how far, and
//! what it remembers follows from the path alone, so it is neither saved nor hashed.
//!
//! The level in force is `min(asked, limit)`. A limit by thrust, air or a planned burn ends by itself, and the clock goes
//! back to what the pilot asked; an event that is reached (air, ground, a sphere of influence) lowers the *asked* level
//! to 1×, so that the clock never runs away on the other side (not so where the automatic landing planned to come there).

use super::local::air_top_m;
use crate::command::{WARP_ONE, WARP_QUARTERS};
use crate::world::system::{Body, System};
use engine::orbit::State;
use engine::orbit::path::{Event, Path};
use engine::space::Centred;
use engine::time::{SimTime, TICKS_PER_SECOND};
use engine::units::KM;

/// The highest level of all: 1,000,000×.
pub const TOP_LEVEL: u8 = 11;
const _: () = assert!(WARP_QUARTERS.len() == TOP_LEVEL as usize + 1);
/// Highest level while the ship is integrated: 4×.
pub const FLY_LEVEL: u8 = 4;
/// An event is approached so that at least this many session ticks remain at any level.
const APPROACH_TICKS: i64 = 3 * TICKS_PER_SECOND;
/// The same where the pilot hurries to a moment.
const HURRY_TICKS: i64 = TICKS_PER_SECOND / 3;

/// Altitude under which a ship is integrated and not sampled, m: the top of the air, or what mountains reach at most.
pub fn floor_m(body: &Body) -> f64 {
    let mountains = body.relief.as_ref().map_or(0.0, |r| r.bound_m());
    air_top_m(body).max((mountains + 2.0 * KM).max(15.0 * KM).min(0.25 * body.radius_m))
}

/// How far a path has been looked ahead, and what it comes to first. Holds no state of the World: two are always equal.
#[derive(Clone, Debug, Default)]
pub struct Ahead {
    front: Option<Path>,
    event: Option<Event>,
}

impl PartialEq for Ahead {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Ahead {
    /// The tick of the first event on `path` that matters to a clock at `level`: within as many ticks as it takes to slow down from
    /// there. One that is known from beyond does no harm, since it does not slow down `level`.
    pub fn first(&mut self, system: &System, path: &Path, now: SimTime, level: u8) -> Option<SimTime> {
        let until = now.plus(ticks_at(level).saturating_mul(APPROACH_TICKS));
        let passed = |e: &Event| e.at.since(path.knot().at) <= 0.0;
        let behind = |front: &Path| path.knot().at.since(front.knot().at) > 0.0;
        if self.event.as_ref().is_some_and(passed) || self.front.as_ref().is_some_and(behind) {
            *self = Self::default();
        }
        if self.event.is_none() {
            let front = self.front.get_or_insert_with(|| path.clone());
            self.event = front.advance(&system.gravity, &system.ephemeris, until);
        }
        self.event.map(|e| e.at.next_tick())
    }
}

/// Distances of periapsis and apoapsis from the centre, m; the latter infinite on an escape path.
pub fn apsides(gm: f64, state: &State<Centred>) -> (f64, f64) {
    let (r, v) = (state.position.0, state.velocity.0);
    let distance = r.length().max(1.0);
    let h2 = r.cross(v).length_squared();
    let p = h2 / gm;
    let e = (v.cross(r.cross(v)) / gm - r / distance).length();
    (p / (1.0 + e), if e < 1.0 { p / (1.0 - e) } else { f64::INFINITY })
}

/// Simulated ticks in a tick of the session at a level.
fn ticks_at(level: u8) -> i64 {
    WARP_QUARTERS.get(usize::from(level)).map_or(0, |q| i64::from(*q) / 4)
}

/// The highest level at which `ahead` ticks leave time to see what comes; at least 1×.
pub fn level_before(ahead: i64) -> u8 {
    level_with(ahead, APPROACH_TICKS)
}

/// The highest level at which `ahead` ticks are not jumped over when someone hurries there; at least 1×.
pub fn hurried_level(ahead: i64) -> u8 {
    level_with(ahead, HURRY_TICKS)
}

/// The highest level at which `ahead` ticks last for so many of the session; at least 1×.
fn level_with(ahead: i64, session: i64) -> u8 {
    let mut level = WARP_ONE;
    while level < TOP_LEVEL && ticks_at(level + 1) * session <= ahead {
        level += 1;
    }
    level
}
