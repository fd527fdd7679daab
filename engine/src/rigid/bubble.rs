//! The contact bubble: a ship near the ground, tick by tick, in the frame in which the ground rests.
//!
//! A substep: midpoint acceleration of gravity, loads and the turning frame's fictitious forces in f64; the legs' forces; what
//! rapier says of the hull; then pose and velocity move. In free flight this is the explicit midpoint rule (second order: a fall
//! of 10 s agrees with Kepler's to micrometres); in contact it is symplectic Euler, which springs need.
//!
//! What persists is [`Contact`]: plain, serialisable, all of it. [`Bubble`] only holds the mesh that [`Contact::key`] implies.
//! Not here: when to enter the bubble and what a crash means (the game's `ship::contact`).

use super::body::{BodyState, Loads, MassProps, RotatingFrame, turn};
use super::gear::{self, Chassis, LegForces, LegState};
use super::ground::{Patch, PatchKey, Surface};
use super::hull;
use super::{RigidError, sweep};
use crate::space::{Fixed, Position, Rotation, Vector, Velocity};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Substeps of a tick while something can touch.
const SUBSTEPS: u8 = 8;
/// Substeps of a tick with the gear up.
const SUBSTEPS_BELLY: u8 = 2;
/// Above this speed no contact is gentle: the ship is swept against the height function, and a touch is an impact.
pub const FAST_M_S: f64 = 60.0;
/// At rest: slower than this, m/s …
const QUIET_M_S: f64 = 0.02;
/// … and turning slower than this, rad/s …
const QUIET_RAD_S: f64 = 0.005;
/// … for this many ticks.
const QUIET_TICKS: u16 = 60;

/// All that contact remembers from tick to tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// The ground patch in use.
    pub key: Option<PatchKey>,
    /// The legs, in the order of the chassis.
    pub legs: Vec<LegState>,
    /// Ticks for which the ship has been quiet on the ground.
    pub quiet_ticks: u16,
    /// Did something touch at the end of the last tick?
    pub touching: bool,
}

/// What a tick in the bubble did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// True when something touches.
    pub touching: bool,
    /// Speed along the ground's normal of a new touch in this tick, m/s.
    pub touchdown_m_s: Option<f64>,
    /// Speed along the ground's normal of a touch beyond what gear or hull bear, m/s; the state is that of the impact.
    pub crash_m_s: Option<f64>,
    /// True when the ship has come to rest and may be frozen.
    pub at_rest: bool,
    /// Mean acceleration by the ground over the tick, m/s², Fixed axes.
    pub ground_accel_m_s2: DVec3,
}

/// The mesh near the ship: derived from [`Contact::key`] and the surface, never saved.
#[derive(Clone, Debug, Default)]
pub struct Bubble {
    patch: Option<Arc<Patch>>,
}

/// What a tick needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nearness {
    /// Nothing can touch: free motion, no mesh needed.
    Clear,
    /// Near the ground at a speed at which any touch is an impact: free motion, then [`swept`].
    Fast,
    /// Near and gentle: [`Bubble::tick`].
    Touchable,
}

/// What the ship is, for one tick.
#[derive(Clone, Copy)]
pub struct Ship<'a> {
    /// What touches.
    pub chassis: &'a Chassis,
    /// Mass and inertia.
    pub mass: MassProps,
    /// Thrust and air.
    pub loads: Loads,
    /// Legs out?
    pub gear_down: bool,
    /// Is anybody at the controls? A ship that is flown never comes to rest.
    pub flown: bool,
}

/// Where the ship is, for one tick.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    /// The ground.
    pub surface: &'a dyn Surface,
    /// How the ground turns.
    pub frame: RotatingFrame,
    /// Acceleration of gravity at a point, m/s², Fixed axes.
    pub gravity: &'a dyn Fn(Position<Fixed>) -> DVec3,
}

impl Bubble {
    /// True while a mesh is held, that is, while something could touch.
    pub fn has_ground(&self) -> bool {
        self.patch.is_some()
    }

    /// Says what a tick of `dt_s` needs, and holds the mesh while something can touch. What `contact` remembers is dropped
    /// where nothing can.
    pub fn prepare(
        &mut self,
        contact: &mut Contact,
        state: &BodyState,
        chassis: &Chassis,
        surface: &dyn Surface,
        dt_s: f64,
    ) -> Result<Nearness, RigidError> {
        let reach = chassis.reach_m();
        let speed = state.velocity.length();
        // 20 m/s² more than gravity would be needed to gain on this in one tick.
        let span = reach + (speed + 20.0 * dt_s) * dt_s;
        let radius = state.position.length();
        if surface.clearance_m(state.position.0) > span * (1.0 + sweep::SLOPE_MAX) {
            *contact = Contact::default();
            self.patch = None;
            return Ok(Nearness::Clear);
        }
        if speed > FAST_M_S {
            *contact = Contact::default();
            self.patch = None;
            return Ok(Nearness::Fast);
        }
        let direction = state.position.0.normalize_or(DVec3::Z);
        let key = PatchKey::for_ship(contact.key, surface.radius_m(), direction);
        let patch = match self.patch.take() {
            Some(p) if p.key == key => p,
            old => Arc::new(Patch::build(surface, key, reach, old.as_deref())?),
        };
        let above = radius - span > patch.top_radius_m;
        self.patch = Some(patch);
        if above {
            *contact = Contact::default();
        }
        contact.key = Some(key);
        contact.legs.resize(chassis.legs.len(), LegState::default());
        Ok(if above { Nearness::Clear } else { Nearness::Touchable })
    }

    /// Advances `state` by `dt_s` (a tick), whatever is near. An error leaves `state` as it was.
    pub fn tick(
        &mut self,
        contact: &mut Contact,
        state: &mut BodyState,
        ship: &Ship,
        place: &Place,
        dt_s: f64,
    ) -> Result<Report, RigidError> {
        let before = *state;
        match (self.prepare(contact, state, ship.chassis, place.surface, dt_s)?, self.patch.clone()) {
            (Nearness::Touchable, Some(patch)) => Ok(touchable(contact, state, ship, place, &patch, dt_s)),
            (Nearness::Fast, _) => {
                drift(state, ship, place, DVec3::ZERO, DVec3::ZERO, false, dt_s);
                let Some((at, report)) = swept(&before, state, ship.chassis, ship.gear_down, place.surface) else {
                    return Ok(Report::default());
                };
                *state = at;
                Ok(report)
            }
            _ => {
                drift(state, ship, place, DVec3::ZERO, DVec3::ZERO, false, dt_s);
                Ok(Report::default())
            }
        }
    }
}

/// The first touch of hull or feet on the way from `before` to `after`, too fast to be gentle: the state at the impact, and how hard.
pub fn swept(
    before: &BodyState,
    after: &BodyState,
    chassis: &Chassis,
    gear_down: bool,
    surface: &dyn Surface,
) -> Option<(BodyState, Report)> {
    let mut first: Option<(f64, DVec3)> = None;
    for m in chassis.extremes(gear_down) {
        let a = before.position.0 + before.fixed_from_hull.raw(m);
        let b = after.position.0 + after.fixed_from_hull.raw(m);
        if let Some(f) = sweep::first_hit(surface, a, b)
            && first.is_none_or(|(best, _)| f < best)
        {
            first = Some((f, a + (b - a) * f));
        }
    }
    let (fraction, at) = first?;
    // Along the chord, which over a tick differs from the path by under ½ g dt² ≈ 1 mm.
    let position = before.position + (after.position - before.position) * fraction;
    let q = before.fixed_from_hull.0.lerp(after.fixed_from_hull.0, fraction).normalize();
    let speed = after.velocity.length();
    let closing = -after.velocity.0.dot(normal(surface, at));
    let report = Report {
        touching: true,
        touchdown_m_s: Some(closing.max(0.0)),
        // A graze at this speed tears as much as it presses.
        crash_m_s: Some(closing.max(0.1 * speed)),
        ..Report::default()
    };
    Some((BodyState { position, fixed_from_hull: Rotation::new(q), ..*after }, report))
}

/// The surface's upward normal at a point, by central differences over a metre.
fn normal(surface: &dyn Surface, at: DVec3) -> DVec3 {
    let up = at.normalize_or(DVec3::Z);
    let (e, _, n) = crate::space::sphere::east_up_north(up);
    let slope = |t: DVec3| 0.5 * (surface.clearance_m(at + t) - surface.clearance_m(at - t));
    (up + e * slope(e) + n * slope(n)).normalize_or(up)
}

/// A tick near the ground at a gentle speed.
fn touchable(contact: &mut Contact, state: &mut BodyState, ship: &Ship, place: &Place, patch: &Patch, dt_s: f64) -> Report {
    // Legs are stiff; without them rapier's own iterations are fine enough.
    let substeps = if ship.gear_down { SUBSTEPS } else { SUBSTEPS_BELLY };
    let h = dt_s / f64::from(substeps);
    let hull_near = hull_near(state, ship.chassis, patch, dt_s);
    let mut report = Report::default();
    let mut impulse = DVec3::ZERO;
    let mut feet = 0;
    for _ in 0..substeps {
        let legs = if ship.gear_down {
            gear::act(&ship.chassis.legs, &mut contact.legs, state, patch, ship.mass.mass_kg, h)
        } else {
            contact.legs.fill(LegState::default());
            LegForces::default()
        };
        feet = legs.feet;
        if let Some((normal, slide)) = legs.touch_m_s {
            report.touchdown_m_s = Some(report.touchdown_m_s.unwrap_or(0.0).max(normal));
            if normal > ship.chassis.gear_limit_m_s || slide > ship.chassis.slide_limit_m_s {
                report.crash_m_s = Some(normal);
            }
        }
        let dv = drift_or_knock(state, ship, place, hull_near.then_some(patch), &legs, h, &mut report);
        impulse += dv;
        report.touching |= feet > 0;
        if report.crash_m_s.is_some() {
            break;
        }
    }
    report.ground_accel_m_s2 = impulse / dt_s;
    contact.touching = report.touching;
    let quiet = report.touching
        && (feet >= 3 || feet == 0)
        && !ship.flown
        && state.velocity.length() < QUIET_M_S
        && state.angular.length() < QUIET_RAD_S;
    contact.quiet_ticks = if quiet { contact.quiet_ticks.saturating_add(1) } else { 0 };
    report.at_rest = contact.quiet_ticks >= QUIET_TICKS;
    report
}

/// Could the hull touch within the tick? Looks at 30 points of the hull's box, with a margin for bumps between them.
fn hull_near(state: &BodyState, chassis: &Chassis, patch: &Patch, dt_s: f64) -> bool {
    let margin = 0.3 + 1.5 * dt_s * (state.velocity.length() + state.angular.length() * chassis.reach_m());
    for y in [-1.0, 1.0] {
        for x in [-1.0, 0.0, 1.0] {
            for z in [-1.0, -0.5, 0.0, 0.5, 1.0] {
                let corner = chassis.middle_m + chassis.half_size_m * DVec3::new(x, y, z);
                let clearance = patch.clearance_m(state.position.0 + state.fixed_from_hull.raw(corner));
                if clearance.is_none_or(|c| c < margin) {
                    return true;
                }
            }
        }
    }
    false
}

/// One substep with the legs' forces and the hull's contact; gives the velocity that the ground added, m/s.
fn drift_or_knock(
    state: &mut BodyState,
    ship: &Ship,
    place: &Place,
    near: Option<&Patch>,
    legs: &LegForces,
    h: f64,
    report: &mut Report,
) -> DVec3 {
    let before = *state;
    drift(state, ship, place, legs.force_n, legs.torque_n_m, legs.feet > 0, h);
    let added = legs.force_n * (h / ship.mass.mass_kg);
    let Some(patch) = near else { return added };
    // rapier starts from the old pose with the new velocity, as its own step would.
    let trial = BodyState { velocity: state.velocity, angular: state.angular, ..before };
    let Some(k) = hull::knock(patch, ship.chassis, &ship.mass, &trial, h) else { return added };
    report.touching = true;
    if k.speed_m_s > 0.05 {
        report.touchdown_m_s = Some(report.touchdown_m_s.unwrap_or(0.0).max(k.speed_m_s));
    }
    if k.speed_m_s > ship.chassis.hull_limit_m_s {
        report.crash_m_s = Some(report.crash_m_s.unwrap_or(0.0).max(k.speed_m_s));
    }
    state.velocity += Velocity::new(k.dv);
    state.angular += Vector::new(k.dw);
    state.position = Position::new(before.position.0 + state.velocity.0 * h + k.push);
    state.fixed_from_hull = Rotation::new((k.turned * before.fixed_from_hull.0).normalize());
    added + k.dv
}

/// Free motion over `h` with a ground force (N) and torque (N m, about the centre of mass) in Fixed axes.
fn drift(state: &mut BodyState, ship: &Ship, place: &Place, force_n: DVec3, torque_n_m: DVec3, held: bool, h: f64) {
    let m = ship.mass.mass_kg;
    let q = state.fixed_from_hull.0;
    let push = q * ship.loads.force_n.0 / m;
    let accel = |r: DVec3, v: DVec3| (place.gravity)(Position::new(r)) + place.frame.fictitious(r, v) + push;
    let (r, v) = (state.position.0, state.velocity.0);
    let first = accel(r, v);
    let smooth = accel(r + v * (0.5 * h), v + first * (0.5 * h));
    let after = v + (smooth + force_n / m) * h;
    let mean = if held { after } else { 0.5 * (v + after) };
    state.velocity = Velocity::new(after);
    state.position = Position::new(r + mean * h);

    // Euler's equations in hull axes, where the tensor is diagonal: I ẇ = τ − w × I w, by the midpoint rule.
    let i = ship.mass.inertia_kg_m2.max(DVec3::splat(1.0));
    let torque = ship.loads.torque_n_m.0 + q.conjugate() * torque_n_m;
    let spin = q.conjugate() * place.frame.omega_rad_s;
    let w0 = q.conjugate() * state.angular.0 + spin;
    let rate = |w: DVec3| (torque - w.cross(i * w)) / i;
    let w1 = w0 + rate(w0 + rate(w0) * (0.5 * h)) * h;
    let mean = 0.5 * (w0 + w1) - spin;
    let q1 = (q * turn(mean * h)).normalize();
    state.fixed_from_hull = Rotation::new(q1);
    state.angular = Vector::new(q1 * w1 - place.frame.omega_rad_s);
}

#[cfg(test)]
mod tests;
