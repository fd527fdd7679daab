//! The almanac: which eclipses come, for any two bodies of a system. Choosing who takes part is ours, the geometry the engine's
//! ([`engine::orbit::eclipse`]).
//!
//! What is asked for every frame (the event in force or coming at the ship's body) is kept in windows of a few days; what is kept
//! never changes an answer. Not here: beginning a flight at one ([`super::visit`]), how it is shown (`crate::hud`).

use crate::world::system::System;
use core::f64::consts::TAU;
use engine::orbit::eclipse::{self, Cast, Eclipse, Pace, Role};
use engine::orbit::field::Reach;
use engine::orbit::{BodyId, State};
use engine::space::Icrf;
use engine::time::{Moment, SimTime, TICKS_PER_SECOND};
use engine::units::DAY;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Longest window, days: how far ahead the HUD looks at least.
const WINDOW_D: f64 = 10.0;
/// Windows kept; then all are forgotten (they are found again in a millisecond).
const KEPT: usize = 64;

/// Whose shadow falls on whom, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Receives the shadow.
    pub on: BodyId,
    /// Throws it.
    pub by: BodyId,
    /// What happens.
    pub eclipse: Eclipse,
}

/// `(receiver, caster, number of the window)`.
type Key = (u16, u16, i64);

/// Eclipses found so far.
#[derive(Debug, Default)]
pub struct Almanac {
    windows: Mutex<BTreeMap<Key, Arc<[Eclipse]>>>,
}

impl Clone for Almanac {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Barycentric state of a body between ticks.
fn state(system: &System, body: BodyId, t: Moment) -> State<Icrf> {
    let at_tick = system.ephemeris.state(body, t.tick);
    // Along the velocity for a fraction of a tick: off by ½ a s², under 1 µm.
    State { position: at_tick.position + at_tick.velocity.over(t.beyond_s), ..at_tick }
}

/// Who takes part; `None` where the three are not three bodies.
pub fn cast(system: &System, on: BodyId, by: BodyId) -> Option<Cast<'_>> {
    let role = |id: BodyId| {
        let body = system.bodies.get(id.index())?;
        Some(Role { id, spin: &body.spin, shape: body.shape })
    };
    let star = BodyId(0);
    (on != by && on != star && by != star).then_some(())?;
    Some(Cast { star: role(star)?, caster: role(by)?, receiver: role(on)? })
}

/// The bodies that a body goes round, from itself to the star.
fn line(system: &System, mut body: BodyId) -> Vec<BodyId> {
    let mut line = vec![body];
    while let Some(parent) = system.bodies.get(body.index()).and_then(|b| b.parent) {
        line.push(parent);
        body = parent;
    }
    line
}

/// How far and how fast one body can be from another, from where each can be about what it goes round.
fn apart(system: &System, a: BodyId, b: BodyId) -> Reach {
    let (up_a, up_b) = (line(system, a), line(system, b));
    let shell = |line: &[BodyId], other: &[BodyId]| {
        let own = line.iter().take_while(|body| !other.contains(body));
        own.fold((0.0, 0.0, 0.0), |(near, far, fast): (f64, f64, f64), body| {
            let r = system.ephemeris.reach(*body);
            ((r.nearest_m - far).max(near - r.farthest_m).max(0.0), far + r.farthest_m, fast + r.fastest_m_s)
        })
    };
    let (one, two) = (shell(&up_a, &up_b), shell(&up_b, &up_a));
    let touching = system.body(a).radius_m + system.body(b).radius_m;
    Reach { nearest_m: (one.0 - two.1).max(two.0 - one.1).max(touching), farthest_m: one.1 + two.1, fastest_m_s: one.2 + two.2 }
}

fn pace(system: &System, cast: &Cast<'_>) -> Pace {
    Pace::of(&apart(system, cast.caster.id, cast.receiver.id), &apart(system, cast.star.id, cast.receiver.id))
}

/// Every eclipse on `on` by `by` whose greatest moment lies in `from ..= to`, in order, until `each` answers false.
pub fn find(system: &System, on: BodyId, by: BodyId, from: Moment, to: Moment, each: &mut dyn FnMut(Eclipse) -> bool) {
    let Some(cast) = cast(system, on, by) else { return };
    eclipse::find(&cast, &|body, t| state(system, body, t), pace(system, &cast), from, to, each);
}

/// Asks the engine about one of a system's eclipses.
pub fn with_paths<T>(system: &System, event: &Event, ask: impl FnOnce(&Cast<'_>, &eclipse::Paths<'_>) -> T) -> Option<T> {
    Some(ask(&cast(system, event.on, event.by)?, &|body, t| state(system, body, t)))
}

/// Who may darken a body at times that a calendar lists: its moons, the planet that it goes round and that planet's other moons.
pub fn casters_of(system: &System, on: BodyId) -> Vec<BodyId> {
    let Some(body) = system.bodies.get(on.index()) else { return Vec::new() };
    let Some(parent) = body.parent else { return Vec::new() };
    let planet = (parent != BodyId(0)).then_some(parent);
    let ids = (1..system.bodies.len()).filter_map(|i| u16::try_from(i).ok().map(BodyId));
    let near = |id: &BodyId| *id != on && (Some(*id) == planet || system.body(*id).parent.is_some_and(|p| p == on || Some(p) == planet));
    ids.filter(near).collect()
}

/// Bodies on which a shadow of another can fall.
pub fn receivers(system: &System) -> Vec<BodyId> {
    let ids = (1..system.bodies.len()).filter_map(|i| u16::try_from(i).ok().map(BodyId));
    ids.filter(|id| !casters_of(system, *id).is_empty()).collect()
}

/// The eclipses on a body in the `days` after `from`, by all that can darken it, earliest first, at most `count`; `progress` hears how
/// much is done, 0 … 1. The caster that brings events oftenest sets where the list ends.
pub fn coming(system: &System, on: BodyId, from: SimTime, days: f64, count: usize, progress: &dyn Fn(f32)) -> Vec<Event> {
    let mut found: Vec<Event> = Vec::new();
    let casters = casters_of(system, on);
    let mut end = Moment::from(from).plus_s(days * DAY);
    for (k, by) in casters.iter().enumerate() {
        progress(engine::space::relative::narrow(k as f64 / casters.len() as f64));
        let mut own = 0;
        find(system, on, *by, from.into(), end, &mut |eclipse| {
            found.push(Event { on, by: *by, eclipse });
            own += 1;
            if own == count {
                end = eclipse.greatest;
            }
            own < count
        });
    }
    found.retain(|e| end.since(e.eclipse.greatest) >= 0.0);
    found.sort_by(|a, b| a.eclipse.greatest.since(b.eclipse.greatest).total_cmp(&0.0));
    found.truncate(count);
    found
}

impl System {
    /// The eclipse on `on` by `by` that is in force at `t` or comes next within some days.
    pub fn next_eclipse(&self, on: BodyId, by: BodyId, t: SimTime) -> Option<Eclipse> {
        let length = window_ticks(self, on, by)?;
        let here = t.ticks.div_euclid(length);
        // An eclipse that is in force may have been greatest in the window before.
        let windows = [here - 1, here, here + 1].map(|n| self.window(on, by, n, length));
        windows.iter().flat_map(|w| w.iter()).find(|e| e.penumbra[1].since(t.into()) >= 0.0).copied()
    }

    /// The event in force or next to come on a body, by whichever caster.
    pub fn next_event(&self, on: BodyId, t: SimTime) -> Option<Event> {
        let each = casters_of(self, on).into_iter();
        let events = each.filter_map(|by| self.next_eclipse(on, by, t).map(|eclipse| Event { on, by, eclipse }));
        events.min_by(|a, b| a.eclipse.penumbra[0].since(b.eclipse.penumbra[0]).total_cmp(&0.0))
    }

    fn window(&self, on: BodyId, by: BodyId, n: i64, length: i64) -> Arc<[Eclipse]> {
        let key = (on.0, by.0, n);
        let windows = || self.eclipses.windows.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = windows().get(&key) {
            return known.clone();
        }
        // Found without the lock: an ephemeris that is still being integrated must hold up nobody else.
        let from = SimTime::from_ticks(n.saturating_mul(length));
        let mut found = Vec::new();
        find(self, on, by, from.into(), from.plus(length - 1).into(), &mut |eclipse| {
            found.push(eclipse);
            true
        });
        let found: Arc<[Eclipse]> = found.into();
        let mut windows = windows();
        if windows.len() >= KEPT {
            windows.clear();
        }
        windows.insert(key, found.clone());
        found
    }
}

/// A few revolutions of the nearer of the two, at most [`WINDOW_D`]; `None` where no eclipse can be.
#[allow(clippy::cast_possible_truncation)]
fn window_ticks(system: &System, on: BodyId, by: BodyId) -> Option<i64> {
    cast(system, on, by)?;
    let reach = apart(system, on, by);
    let turn_s = TAU * reach.nearest_m / reach.fastest_m_s.max(1.0);
    Some(((3.0 * turn_s).clamp(3600.0, WINDOW_D * DAY) * TICKS_PER_SECOND as f64) as i64)
}

/// What an event is called: `Total eclipse: Moon before Sun`, `Partial eclipse: Moon in the shadow of Earth`.
pub fn title(system: &System, event: &Event) -> String {
    let name = |id: BodyId| system.bodies.get(id.index()).map_or("?", |b| b.name.as_str());
    let mut kind = event.eclipse.kind.word().to_owned();
    if let Some(first) = kind.get_mut(0..1) {
        first.make_ascii_uppercase();
    }
    match cast(system, event.on, event.by) {
        Some(cast) if !cast.is_solar() => format!("{kind} eclipse: {} in the shadow of {}", name(event.on), name(event.by)),
        _ => format!("{kind} eclipse: {} before {}", name(event.by), name(BodyId(0))),
    }
}
