//! Contact with the ground: what a tick that [`super::flight::step`] flew freely comes to when something is in the way.
//!
//! High up nothing here costs more than one comparison. Near the ground the tick is done again in [`engine::rigid`], in the
//! body's turning frame; then the ship flies on, touches, comes to rest or breaks. Stated model: water carries like hard ground
//! at its surface; a body without ground (a giant, the star) crushes what sinks below its datum.
//! Not here: thrust, air and attitude control ([`super::flight`]), the mechanics of touching (`engine::rigid`).

use super::flight::{self, Stepped};
use super::local::{Local, pull};
use super::recorder::{Pose, Recorder};
use super::spec::ShipSpec;
use super::{Effort, Motion, Resting, Rigid, Ship};
use crate::command::{Axes, Guidance};
use engine::orbit::State;
use engine::rigid::bubble::{Place, Ship as Hull, swept};
use engine::rigid::{BodyState, Bubble, Chassis, Contact, Leg, Loads, MassProps, Nearness, Report, RotatingFrame};
use engine::space::{Fixed, Icrf, Position, Rotation, Vector};
use engine::terrain::Relief;
use engine::time::{SimTime, TICK_S};
use glam::DVec3;

/// Fastest slide along the ground at touchdown that the gear bears, as a multiple of its limit straight down.
const SLIDE_FACTOR: f64 = 2.5;
/// Under this speed a guided descent that stands on its feet is over, m/s.
const STANDING_M_S: f64 = 0.5;

/// What the ship keeps about the ground.
#[derive(Clone, Debug, Default)]
pub struct Ground {
    /// All that contact remembers from tick to tick; saved.
    pub contact: Contact,
    /// The mesh under the ship; follows from `contact`, not saved.
    pub bubble: Bubble,
    /// The last seconds; not part of the state.
    pub recorder: Recorder,
}

impl Ground {
    /// The numbers that a tick depends on, named, for state hashes.
    pub fn fields(&self) -> Vec<(&'static str, u64)> {
        let signed = |x: i32| u64::from(x.cast_unsigned());
        let mut out =
            vec![("ground.quiet_ticks", u64::from(self.contact.quiet_ticks)), ("ground.touching", u64::from(self.contact.touching))];
        if let Some(k) = self.contact.key {
            out.extend([("patch.face", u64::from(k.face)), ("patch.u", signed(k.middle[0])), ("patch.v", signed(k.middle[1]))]);
        }
        for leg in &self.contact.legs {
            let hold = leg.hold_m.unwrap_or(DVec3::ZERO);
            out.extend([("leg.x", hold.x.to_bits()), ("leg.y", hold.y.to_bits()), ("leg.z", hold.z.to_bits())]);
            out.push(("leg.compression_m", leg.compression_m.to_bits()));
        }
        out
    }
}

/// Whether rapier has anything to do, and why (not).
pub fn subsystem(ship: &Ship) -> (bool, &'static str) {
    match ship.motion {
        Motion::Coast(_) => (false, "coasting, far above the ground"),
        Motion::Fly(_) if ship.ground.bubble.has_ground() => (false, "flying above all ground within reach"),
        Motion::Fly(_) => (false, "flying, far above the ground or too fast to touch it gently"),
        Motion::Contact(_) => (true, "ground within reach of hull or gear"),
        Motion::Landed(_) => (false, "at rest on the ground, frozen in its axes"),
        Motion::Crashed(_) => (false, "broken, at rest"),
    }
}

/// True while the ship's weight is on something, so that its gear cannot move.
pub fn stands(ship: &Ship) -> bool {
    match ship.motion {
        Motion::Landed(_) | Motion::Crashed(_) => true,
        Motion::Contact(_) => ship.ground.contact.touching,
        Motion::Coast(_) | Motion::Fly(_) => false,
    }
}

/// What of a ship can touch: its legs stand along the hull's −Y, held at the height of the centre of mass.
pub fn chassis(spec: &ShipSpec) -> Chassis {
    let gear = &spec.gear;
    let leg = |foot: &DVec3| Leg {
        hip_m: DVec3::new(foot.x, 0.0, foot.z),
        foot_m: *foot,
        stroke_m: gear.stroke_m,
        stiffness_n_m: gear.stiffness_n_m,
        damping_n_s_m: gear.damping_n_s_m,
        friction: gear.friction,
    };
    Chassis {
        half_size_m: spec.hull.size_m * 0.5,
        middle_m: DVec3::ZERO,
        friction: gear.friction,
        legs: gear.feet_m.iter().map(leg).collect(),
        gear_limit_m_s: spec.limits.gear_impact_m_s,
        slide_limit_m_s: spec.limits.gear_impact_m_s * SLIDE_FACTOR,
        hull_limit_m_s: spec.limits.hull_impact_m_s,
    }
}

/// The turning frame of a body at two ends of a tick.
struct Frames<'a> {
    local: &'a Local<'a>,
    turning: RotatingFrame,
    after: Rotation<Icrf, Fixed>,
}

impl<'a> Frames<'a> {
    fn new(local: &'a Local<'a>, end: SimTime) -> Self {
        let turning = RotatingFrame { omega_rad_s: local.icrf_from_fixed.inverse().raw(local.spin) };
        Self { local, turning, after: local.body.spin.icrf_from_fixed(end) }
    }
    fn fixed(&self, axes: Rotation<Icrf, Fixed>, r: &Rigid) -> BodyState {
        let angular = r.icrf_from_hull.0 * r.rate.0;
        self.turning.from_centred(axes.0, r.state.position, r.state.velocity, r.icrf_from_hull.0, angular)
    }
    fn rigid(&self, s: &BodyState) -> Rigid {
        let (position, velocity, q, angular) = self.turning.to_centred(self.after.0, s);
        Rigid {
            body: self.local.id,
            state: State { position, velocity },
            icrf_from_hull: Rotation::new(q),
            rate: Vector::new(q.conjugate() * angular),
        }
    }
}

/// How the ship moves after the tick that ends at `end`: freely as `stepped` says, or as the ground lets it.
pub fn settle(ship: &mut Ship, local: &Local, before: &Rigid, stepped: &Stepped, axes: Axes, end: SimTime) -> Motion {
    let frames = Frames::new(local, end);
    let motion = match &local.body.relief {
        None if stepped.free.state.position.length() < local.body.radius_m => {
            let speed = local.v_surface.length();
            broken(ship, &frames, &frames.fixed(frames.after, &stepped.free), speed, end)
        }
        None => Motion::Fly(stepped.free),
        Some(relief) => over_ground(ship, &frames, relief, before, stepped, axes, end),
    };
    record(ship, &frames, &motion, end);
    motion
}

fn over_ground(ship: &mut Ship, frames: &Frames, relief: &Relief, before: &Rigid, stepped: &Stepped, axes: Axes, end: SimTime) -> Motion {
    // Higher than any ground within reach of a tick: nothing to look at. No relief of a world is higher than this.
    let speed = frames.local.v_surface.length();
    if frames.local.altitude_m > highest_m(frames.local) + 10.0 * speed * TICK_S + 1_000.0 {
        ship.ground.contact = Contact::default();
        ship.ground.bubble = Bubble::default();
        return Motion::Fly(stepped.free);
    }
    let chassis = chassis(&ship.spec);
    let start = frames.fixed(frames.local.icrf_from_fixed, before);
    let ground = &mut ship.ground;
    match ground.bubble.prepare(&mut ground.contact, &start, &chassis, relief, TICK_S) {
        Ok(Nearness::Clear) => Motion::Fly(stepped.free),
        Ok(Nearness::Touchable) => touchable(ship, frames, relief, &chassis, start, stepped, axes, end),
        // Ground that cannot be made into a mesh is met like ground at speed: what touches it, breaks.
        Ok(Nearness::Fast) | Err(_) => {
            let free = frames.fixed(frames.after, &stepped.free);
            match swept(&start, &free, &chassis, ship.gear_down, relief) {
                Some((at, report)) => broken(ship, frames, &at, report.crash_m_s.unwrap_or(speed), end),
                None => Motion::Fly(stepped.free),
            }
        }
    }
}

/// No mountain stands higher above the datum than this: relief held up by rock grows as gravity falls (Olympus Mons 22 km
/// at 3.7 m/s², Rheasilvia's peak 22 km at 0.25 m/s²).
fn highest_m(local: &Local) -> f64 {
    (0.02 * local.body.radius_m).clamp(30_000.0, 100_000.0)
}

#[allow(clippy::too_many_arguments)]
fn touchable(
    ship: &mut Ship,
    frames: &Frames,
    relief: &Relief,
    chassis: &Chassis,
    start: BodyState,
    stepped: &Stepped,
    axes: Axes,
    end: SimTime,
) -> Motion {
    let flown = flight::stirred(ship, axes);
    // Weight on the gear: a ship that stands lets go of its attitude, or the hold would fight the ground.
    let standing = ship.ground.contact.touching && !flown;
    let loads = Loads {
        force_n: Vector::new(stepped.loads.force),
        torque_n_m: Vector::new(if standing { DVec3::ZERO } else { stepped.loads.torque }),
    };
    let mass = MassProps { mass_kg: stepped.loads.mass_kg, inertia_kg_m2: stepped.loads.inertia_kg_m2 };
    let hull = Hull { chassis, mass, loads, gear_down: ship.gear_down, flown };
    let body = frames.local.body;
    let weight = move |p: Position<Fixed>| pull(body, DVec3::Z, p.0);
    let place = Place { surface: relief, frame: frames.turning, gravity: &weight };
    let mut state = start;
    let ground = &mut ship.ground;
    let Ok(report) = ground.bubble.tick(&mut ground.contact, &mut state, &hull, &place, TICK_S) else {
        return Motion::Fly(stepped.free);
    };
    if let Some(speed) = report.touchdown_m_s.filter(|s| *s > 0.05) {
        ship.last_contact = Some((speed, end));
    }
    let felt = state.fixed_from_hull.0 * loads.force_n.0 / mass.mass_kg + report.ground_accel_m_s2;
    ship.effort.felt_m_s2 = felt.length();
    if let Some(speed) = report.crash_m_s {
        return broken(ship, frames, &state, speed, end);
    }
    finish_landing(ship, &report, &state);
    if report.at_rest {
        ship.effort = Effort::default();
        return Motion::Landed(resting(frames, &state));
    }
    Motion::Contact(frames.rigid(&state))
}

/// A guided descent ends when the ship stands: engine off, the pilot has it.
fn finish_landing(ship: &mut Ship, report: &Report, state: &BodyState) {
    let down = match ship.guidance {
        Guidance::Land => true,
        Guidance::VerticalSpeed { cm_s } => cm_s < 0,
        Guidance::Manual | Guidance::Hover | Guidance::Node => false,
    };
    // One foot is enough: on a slope the hold would keep the ship level on it for ever, its engine at idle.
    let stands = ship.ground.contact.legs.iter().any(|l| l.hold_m.is_some()) || !ship.gear_down;
    if down && report.touching && stands && state.velocity.length() < STANDING_M_S {
        ship.guidance = Guidance::Manual;
        ship.landing = None;
        ship.throttle = 0;
    }
}

fn resting(frames: &Frames, s: &BodyState) -> Resting {
    Resting { body: frames.local.id, position: s.position, fixed_from_hull: s.fixed_from_hull }
}

fn broken(ship: &mut Ship, frames: &Frames, s: &BodyState, speed_m_s: f64, end: SimTime) -> Motion {
    ship.last_contact = Some((speed_m_s, end));
    ship.guidance = Guidance::Manual;
    ship.landing = None;
    ship.throttle = 0;
    ship.effort = Effort::default();
    ship.ground.contact = Contact::default();
    ship.ground.bubble = Bubble::default();
    Motion::Crashed(resting(frames, s))
}

/// Within this altitude flights are recorded, m.
const RECORD_BELOW_M: f64 = 200_000.0;

fn record(ship: &mut Ship, frames: &Frames, motion: &Motion, end: SimTime) {
    if frames.local.altitude_m > RECORD_BELOW_M {
        return;
    }
    let (position, fixed_from_hull, last) = match motion {
        Motion::Landed(r) | Motion::Crashed(r) => (r.position, r.fixed_from_hull, true),
        Motion::Fly(r) | Motion::Contact(r) => {
            let s = frames.fixed(frames.after, r);
            (s.position, s.fixed_from_hull, false)
        }
        Motion::Coast(_) => return,
    };
    ship.ground.recorder.take(Pose { time: end, body: frames.local.id, position, fixed_from_hull }, last);
}

#[cfg(test)]
mod tests;
