//! Warp: how far a coasting ship may be taken at once, and how fast the clock may run.
//!
//! A coasting path is searched *ahead* for the first tick at which it may no longer be sampled (air, ground, another
//! sphere of influence). Steps of the search are `distance to the boundary / largest possible speed`, so that nothing can
//! be jumped over. The search depends on the arc and on ticks alone, never on the warp in force: what happens, happens
//! at the same tick at every warp (compare peers' periapsis that moves with warp).
//!
//! The level in force is `min(asked, limit)`. A limit by thrust, air or a planned burn ends by itself, and the clock goes
//! back to what the pilot asked; an event that is reached (air, ground, a sphere of influence) lowers the *asked* level
//! to 1×, so that the clock never runs away on the other side (not so where the automatic landing planned to come there).

use super::attitude::offset_of_body;
use super::local::air_top_m;
use crate::command::{WARP_ONE, WARP_QUARTERS};
use crate::world::system::{Body, System};
use engine::orbit::arc::Arc;
use engine::orbit::{BodyId, State};
use engine::space::Centred;
use engine::time::{SimTime, TICK_S, TICKS_PER_SECOND};
use engine::units::{DAY, KM};

/// The highest level of all.
pub const TOP_LEVEL: u8 = 10;
const _: () = assert!(WARP_QUARTERS.len() == TOP_LEVEL as usize + 1);
/// Highest level while the ship is integrated: 4×.
pub const FLY_LEVEL: u8 = 4;
/// An event is approached so that at least this many session ticks remain at any level.
const APPROACH_TICKS: i64 = 3 * TICKS_PER_SECOND;
/// The same where the pilot hurries to a moment.
const HURRY_TICKS: i64 = TICKS_PER_SECOND / 3;
/// How far ahead one search looks.
const HORIZON_S: f64 = 30.0 * DAY;
/// Steps after which a search rests at the tick that it has reached.
const MAX_STEPS: usize = 4096;

/// Why a coasting path must be looked at again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// Nothing found so far: search on.
    Horizon,
    /// Air begins to act, or the ground is near.
    Low,
    /// The ship leaves the body's sphere of influence.
    Leave,
    /// The ship enters that of a moon or planet.
    Enter(BodyId),
    /// The autopilot planned something.
    Guidance,
}

/// The first tick at which a coasting path must be looked at again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wake {
    /// When.
    pub at: SimTime,
    /// Why.
    pub reason: Reason,
}

/// Altitude under which a ship is integrated and not sampled, m: the top of the air, or what mountains reach at most.
pub fn floor_m(body: &Body) -> f64 {
    let mountains = body.relief.as_ref().map_or(0.0, |r| r.bound_m());
    air_top_m(body).max((mountains + 2.0 * KM).max(15.0 * KM).min(0.25 * body.radius_m))
}

/// Searches the path ahead of `from`.
pub fn search(system: &System, arc: &Arc, from: SimTime) -> Wake {
    let host = system.body(arc.body);
    let gm = arc.gm_m3_s2;
    let floor = host.radius_m + floor_m(host);
    let start = arc.sample(from);
    let (periapsis, apoapsis) = apsides(gm, &start);
    let lowest = periapsis.max(1.0);
    let children: Vec<Child> = children(system, arc.body, from).filter(|c| c.reach.0 < apoapsis && c.reach.1 > periapsis).collect();
    let may_sink = periapsis < floor;
    let may_leave = apoapsis > host.soi_radius_m;
    let end = from.plus(ticks(HORIZON_S));
    if !may_sink && !may_leave && children.is_empty() {
        return Wake { at: end, reason: Reason::Horizon };
    }
    // Largest speed on this path between here and a radius: at the lower end of the stretch.
    let energy = 0.5 * start.velocity.0.length_squared() - gm / start.position.0.length().max(1.0);
    let speed_at = |radius: f64| (2.0 * (energy + gm / radius.max(lowest))).max(1.0).sqrt();
    let mut now = from;
    for _ in 0..MAX_STEPS {
        let state = arc.sample(now);
        let r = state.position.0.length();
        if may_sink && r < floor && state.position.0.dot(state.velocity.0) < 0.0 {
            return Wake { at: now, reason: Reason::Low };
        }
        if may_leave && r > host.soi_radius_m {
            return Wake { at: now, reason: Reason::Leave };
        }
        let mut step_s = HORIZON_S;
        if may_sink {
            let outward = state.position.0.dot(state.velocity.0) >= 0.0;
            let gap = if outward { (r - floor).max(0.05 * floor) } else { r - floor };
            step_s = step_s.min(gap / speed_at(floor.min(r)));
        }
        if may_leave {
            step_s = step_s.min((host.soi_radius_m - r) / speed_at(r));
        }
        for child in &children {
            let d = (state.position.0 - offset_of_body(system, arc.body, child.id, now)).length();
            if d < child.soi_m {
                return Wake { at: now, reason: Reason::Enter(child.id) };
            }
            // The speed of either may grow within the step: the step is short against the distance from the host.
            step_s = step_s.min((d - child.soi_m) / (2.0 * (speed_at(0.5 * r) + child.speed_m_s))).min(0.1 * r / speed_at(r));
        }
        // From the last tick that is surely outside, one tick at a time.
        now = now.plus(ticks(step_s).max(1));
        if now > end {
            return Wake { at: end, reason: Reason::Horizon };
        }
    }
    Wake { at: now, reason: Reason::Horizon }
}

/// Whole ticks within `seconds`, at least 0.
#[allow(clippy::cast_possible_truncation)]
fn ticks(seconds: f64) -> i64 {
    (seconds.clamp(0.0, 4.0 * HORIZON_S) / TICK_S).floor() as i64
}

/// A body that the path may meet.
struct Child {
    id: BodyId,
    soi_m: f64,
    /// Nearest and farthest distance from the host at which its sphere may be met.
    reach: (f64, f64),
    speed_m_s: f64,
}

/// Bodies that orbit `host`, with the bounds of their paths (osculating apsides widened by a tenth).
#[allow(clippy::cast_possible_truncation)]
fn children(system: &System, host: BodyId, at: SimTime) -> impl Iterator<Item = Child> {
    let gm = system.body(host).gm_m3_s2;
    system.bodies.iter().enumerate().filter(move |(_, b)| b.parent == Some(host)).map(move |(i, b)| {
        let id = BodyId(i as u16);
        let s = system.ephemeris.relative(id, host, at);
        let relative = State { position: engine::space::Position::new(s.position.0), velocity: engine::space::Velocity::new(s.velocity.0) };
        let (peri, apo) = apsides(gm + b.gm_m3_s2, &relative);
        let fastest = (2.0 * gm / (0.9 * peri).max(1.0)).sqrt();
        Child { id, soi_m: b.soi_radius_m, reach: (0.9 * peri - b.soi_radius_m, 1.1 * apo + b.soi_radius_m), speed_m_s: fastest }
    })
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
    while let Some(&quarters) = WARP_QUARTERS.get(usize::from(level) + 1) {
        if i64::from(quarters) / 4 * session > ahead {
            break;
        }
        level += 1;
    }
    level
}
