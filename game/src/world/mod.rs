//! The World: the simulated truth, f64 and SI, advanced by whole ticks and by nothing but [`Commands`].
//!
//! Read [`World::tick`] for the order of a tick, [`system`] for what exists, [`ship`] for how a ship answers, and
//! [`readout`] for what the World tells. [`start`] makes a World, [`fields`] lists its bits for replays. Not here:
//! anything drawn, heard or saved.

pub mod clock;
pub mod eclipse;
pub mod fields;
pub mod observe;
pub mod readout;
pub mod ship;
pub mod start;
pub mod system;
#[cfg(test)]
mod tests;

use crate::command::{Action, Axes, Commands, Guidance, Hold, Target, WARP_ONE, WARP_QUARTERS};
use engine::orbit::arc::Arc as OrbitArc;
use engine::orbit::{BodyId, State};
use engine::space::{Position, Rotation, Vector, Velocity};
use engine::time::SimTime;
use glam::DVec3;
use ship::attitude::{self, offset_of_body};
use ship::contact;
use ship::local::Local;
use ship::warp::{self, Reason, Wake};
use ship::{Coast, CoastAttitude, Motion, Resting, Rigid, Ship, flight};
use std::sync::Arc;
use system::System;

/// The simulated truth.
#[derive(Clone)]
pub struct World {
    /// What exists; shared, never changed by a tick.
    pub system: Arc<System>,
    /// Now.
    pub time: SimTime,
    /// Quarter ticks owed to the clock (for warp below 1×), 0 … 3.
    pub quarters: u8,
    /// Warp level in force (index into [`crate::command::WARP_QUARTERS`]).
    pub warp: u8,
    /// Warp level that the pilot asked for.
    pub warp_asked: u8,
    /// The ship.
    pub ship: Ship,
    /// What the pilot points at.
    pub target: Option<Target>,
    /// The clock runs as fast as it may until shortly before this moment.
    pub warp_to: Option<SimTime>,
}

/// How many ticks apart a flying ship asks whether another body dominates by now.
const SPHERE_CHECK_TICKS: i64 = 64;

impl World {
    /// One tick of the session (1/60 s of the player's clock): commands, then warp, then as much simulated time as the
    /// warp in force says. A path that coasts is sampled; everything else is stepped tick by tick.
    pub fn tick(&mut self, commands: &Commands) {
        for action in &commands.actions {
            self.act(*action);
        }
        self.wake_ship(commands.axes);
        let hurried = self.hurry();
        self.warp = self.warp_asked.min(self.warp_limit());
        let quarters = u32::from(self.quarters) + WARP_QUARTERS[usize::from(self.warp)];
        self.quarters = u8::try_from(quarters % 4).unwrap_or(0);
        self.advance(i64::from(quarters / 4), commands.axes);
        if self.warp_asked < hurried {
            // Something came up that the pilot should see.
            self.warp_to = None;
        }
    }

    /// Goes on in a system whose files were changed, if it has the same bodies; false, and nothing is changed, if not. The ship
    /// keeps its place beside its body; one that stands is lifted or lowered with the ground below it.
    pub fn adopt(&mut self, system: &Arc<System>) -> bool {
        let same = |(a, b): (&system::Body, &system::Body)| a.key == b.key && a.parent == b.parent;
        if self.system.bodies.len() != system.bodies.len() || !self.system.bodies.iter().zip(&system.bodies).all(same) {
            return false;
        }
        self.leave_arc();
        if let Motion::Landed(rest) | Motion::Crashed(rest) = &mut self.ship.motion {
            let up = rest.position.0.normalize_or(DVec3::Z);
            let ground = |s: &System| {
                let body = s.body(rest.body);
                body.radius_m + body.relief.as_ref().map_or(0.0, |r| r.surface_m(up))
            };
            rest.position += Vector::new(up * (ground(system) - ground(&self.system)));
        }
        self.system = system.clone();
        true
    }

    /// The rigid body now, however it moves.
    pub fn rigid(&self) -> Rigid {
        match &self.ship.motion {
            Motion::Coast(coast) => self.coasting(coast, self.time),
            Motion::Fly(rigid) | Motion::Contact(rigid) => *rigid,
            Motion::Landed(rest) | Motion::Crashed(rest) => self.resting(rest),
        }
    }

    /// The ship's surroundings now.
    pub fn local<'a>(&'a self, rigid: &Rigid) -> Local<'a> {
        Local::new(&self.system, self.time, rigid.body, &rigid.state)
    }

    fn act(&mut self, action: Action) {
        let ship = &mut self.ship;
        match action {
            Action::Throttle(throttle) => ship.throttle = throttle,
            Action::Hold(hold) => {
                (ship.hold, ship.held) = (hold, None);
                if hold == Hold::Node {
                    self.leave_arc();
                }
            }
            Action::Guidance(guidance) => {
                ship.guidance = guidance;
                ship.landing = None;
                ship.held = None;
                ship.burn = ship.burn.filter(|b| b.spent);
                if guidance == Guidance::Manual {
                    ship.throttle = 0;
                }
            }
            // Weight on the gear (or on the belly) locks it.
            Action::Gear(_) if contact::stands(ship) => {}
            Action::Gear(down) => ship.gear_down = down,
            Action::Warp(level) => (self.warp_asked, self.warp_to) = (level.min(warp::TOP_LEVEL), None),
            Action::Target(target) => {
                self.target = target.filter(|t| t.body.index() < self.system.bodies.len());
                if ship.guidance == Guidance::Land {
                    ship.landing = None;
                }
                if ship.hold == Hold::Target {
                    self.leave_arc();
                }
            }
            Action::Refuel => ship.propellant_kg = ship.spec.mass.propellant_kg,
            // The session keeps and restores whole worlds; within one there is nothing to do.
            Action::Quicksave | Action::Quickload => {}
            Action::AddNode(_) | Action::ChangeNode(..) | Action::DeleteNode(_) => {
                ship.edit_nodes(action, self.time);
                if ship.hold == Hold::Node || ship.guidance == Guidance::Node {
                    self.leave_arc();
                }
            }
            Action::WarpTo(to) => {
                self.warp_to = to;
                if to.is_none() {
                    self.warp_asked = self.warp_asked.min(WARP_ONE);
                }
            }
        }
    }

    /// Ends sampling when something pushes or turns the ship, or when the hold in force is not the one it coasts with.
    fn wake_ship(&mut self, axes: Axes) {
        let stirred = flight::stirred(&self.ship, axes);
        match &self.ship.motion {
            Motion::Coast(coast) => {
                let held = match coast.attitude {
                    CoastAttitude::Inertial { rate, .. } => match self.ship.hold {
                        Hold::Free => true,
                        Hold::Rate | Hold::Node => rate == DVec3::ZERO,
                        _ => matches!(self.ship.guidance, Guidance::Land | Guidance::Node) && rate == DVec3::ZERO,
                    },
                    CoastAttitude::Held { hold, .. } => hold == self.ship.hold && self.ship.guidance == Guidance::Manual,
                };
                if stirred || !held {
                    self.leave_arc();
                }
            }
            Motion::Landed(rest) if stirred => self.ship.motion = Motion::Contact(self.resting(rest)),
            _ => {}
        }
    }

    /// From sampling to integration, at this tick.
    fn leave_arc(&mut self) {
        if let Motion::Coast(coast) = &self.ship.motion {
            self.ship.motion = Motion::Fly(self.coasting(coast, self.time));
        }
    }

    /// Sets the warp that a hurry to [`World::warp_to`] asks for now, and tells it; 0 without one.
    fn hurry(&mut self) -> u8 {
        let Some(to) = self.warp_to else { return 0 };
        self.warp_asked = warp::hurried_level(to.ticks - self.time.ticks);
        if self.warp_asked <= WARP_ONE {
            self.warp_to = None;
        }
        self.warp_asked
    }

    /// The highest warp level that the ship's motion allows now.
    fn warp_limit(&self) -> u8 {
        match &self.ship.motion {
            Motion::Coast(coast) if coast.wake.reason != Reason::Horizon => warp::level_before(coast.wake.at.ticks - self.time.ticks),
            Motion::Fly(_) | Motion::Contact(_) => warp::FLY_LEVEL,
            _ => u8::MAX,
        }
    }

    /// Lets simulated time pass. What remains of a tick's share is dropped when the clock must slow down.
    fn advance(&mut self, ticks: i64, axes: Axes) {
        let end = self.time.plus(ticks);
        let mut stepped = 0;
        while self.time < end {
            match self.ship.motion {
                Motion::Landed(_) | Motion::Crashed(_) => self.time = end,
                Motion::Coast(coast) if coast.wake.at > end => self.time = end,
                Motion::Coast(coast) => {
                    self.time = coast.wake.at;
                    self.wake(coast);
                }
                Motion::Fly(rigid) | Motion::Contact(rigid) => {
                    if stepped >= i64::from(WARP_QUARTERS[usize::from(warp::FLY_LEVEL)] / 4) {
                        return;
                    }
                    stepped += 1;
                    self.fly(rigid, axes);
                }
            }
        }
    }

    /// One physical tick.
    fn fly(&mut self, rigid: Rigid, axes: Axes) {
        let local = Local::new(&self.system, self.time, rigid.body, &rigid.state);
        let stepped = flight::step(&mut self.ship, &local, &rigid, axes, self.target);
        self.time = self.time.plus(1);
        self.ship.motion = contact::settle(&mut self.ship, &local, &rigid, &stepped, axes, self.time);
        match self.ship.motion {
            Motion::Fly(_) => {}
            // What rests costs nothing at any warp; but the clock does not run away under a pilot who has just landed.
            Motion::Landed(_) | Motion::Crashed(_) => {
                self.warp_asked = self.warp_asked.min(WARP_ONE);
                return;
            }
            _ => return,
        }
        if self.time.ticks % SPHERE_CHECK_TICKS == 0 {
            self.change_sphere();
        }
        if stepped.quiet {
            self.enter_arc();
        }
    }

    /// From integration to sampling, where nothing acts but gravity.
    fn enter_arc(&mut self) {
        let rigid = self.rigid();
        let local = self.local(&rigid);
        let follows_stick = matches!(self.ship.hold, Hold::Rate | Hold::KillRotation);
        if local.altitude_m < warp::floor_m(local.body) || (follows_stick && rigid.rate.0 != DVec3::ZERO) {
            return;
        }
        let q = rigid.icrf_from_hull.0;
        let hold = self.ship.hold;
        let manual = self.ship.guidance == Guidance::Manual;
        let attitude = match attitude::hold_frame(hold, &local, self.target) {
            Some(frame) if manual => CoastAttitude::Held { hold, offset: (frame.conjugate() * q).normalize() },
            _ => CoastAttitude::Inertial { icrf_from_hull: q, rate: if hold == Hold::Free { rigid.rate.0 } else { DVec3::ZERO } },
        };
        let arc = OrbitArc { body: rigid.body, gm_m3_s2: local.body.gm_m3_s2, epoch: self.time, state: rigid.state };
        self.ship.effort = ship::Effort::default();
        self.start_arc(arc, attitude);
    }

    /// Begins (or goes on with) a sampled path, looking ahead from now.
    fn start_arc(&mut self, arc: OrbitArc, attitude: CoastAttitude) {
        let wake = warp::search(&self.system, &arc, self.time);
        self.ship.motion = Motion::Coast(Coast { arc, attitude, wake: self.planned(wake) });
    }

    /// The earlier of what the path brings and what the autopilot planned.
    fn planned(&self, wake: Wake) -> Wake {
        match self.ship.planned_wake() {
            Some(at) if at <= wake.at => Wake { at: at.max(self.time), reason: Reason::Guidance },
            _ => wake,
        }
    }

    /// What a sampled path was to be looked at for, has come.
    fn wake(&mut self, coast: Coast) {
        match coast.wake.reason {
            Reason::Horizon => self.start_arc(coast.arc, coast.attitude),
            Reason::Guidance => self.leave_arc(),
            Reason::Low => {
                self.leave_arc();
                // The autopilot planned to come here; a pilot may not have.
                if self.ship.guidance != Guidance::Land {
                    self.warp_asked = self.warp_asked.min(WARP_ONE);
                }
            }
            Reason::Leave | Reason::Enter(_) => {
                let to = match coast.wake.reason {
                    Reason::Enter(body) => Some(body),
                    _ => self.system.body(coast.arc.body).parent,
                };
                self.leave_arc();
                if let (Some(to), Motion::Fly(rigid)) = (to, self.ship.motion) {
                    self.ship.motion = Motion::Fly(self.about(rigid, to));
                }
                self.enter_sphere(coast.attitude);
                self.warp_asked = self.warp_asked.min(WARP_ONE);
            }
        }
    }

    /// Goes on coasting about the body that dominates now, when the attitude allows it (a hold about the new body turns the
    /// ship first).
    fn enter_sphere(&mut self, attitude: CoastAttitude) {
        let (CoastAttitude::Inertial { rate, .. }, Motion::Fly(rigid)) = (attitude, self.ship.motion) else {
            return;
        };
        let gm = self.system.body(rigid.body).gm_m3_s2;
        let arc = OrbitArc { body: rigid.body, gm_m3_s2: gm, epoch: self.time, state: rigid.state };
        // From the next tick on: rounding must not send the ship to and fro across the boundary at one tick.
        let wake = warp::search(&self.system, &arc, self.time.plus(1));
        let attitude = CoastAttitude::Inertial { icrf_from_hull: rigid.icrf_from_hull.0, rate };
        self.ship.motion = Motion::Coast(Coast { arc, attitude, wake: self.planned(wake) });
    }

    /// Hands a flying ship to the body that dominates it.
    fn change_sphere(&mut self) {
        let rigid = self.rigid();
        let host = self.system.body(rigid.body);
        let r = rigid.state.position.0;
        let mut to = (r.length() > host.soi_radius_m).then_some(host.parent).flatten();
        for (i, body) in self.system.bodies.iter().enumerate() {
            let id = BodyId(u16::try_from(i).unwrap_or(0));
            if body.parent == Some(rigid.body) && (r - offset_of_body(&self.system, rigid.body, id, self.time)).length() < body.soi_radius_m
            {
                to = Some(id);
            }
        }
        if let Some(to) = to {
            self.ship.motion = Motion::Fly(self.about(rigid, to));
            self.ship.landing = None;
        }
    }

    /// The same rigid body, written about another body.
    fn about(&self, rigid: Rigid, to: BodyId) -> Rigid {
        let old = self.system.ephemeris.relative(rigid.body, to, self.time);
        let state = State {
            position: Position::new(rigid.state.position.0 + old.position.0),
            velocity: Velocity::new(rigid.state.velocity.0 + old.velocity.0),
        };
        Rigid { body: to, state, ..rigid }
    }

    /// A coasting ship at `t`.
    fn coasting(&self, coast: &Coast, t: SimTime) -> Rigid {
        let state = coast.arc.sample(t);
        let body = coast.arc.body;
        let (q, rate) = match coast.attitude {
            CoastAttitude::Inertial { icrf_from_hull, rate } => (attitude::advance(icrf_from_hull, rate, t.since(coast.arc.epoch)), rate),
            CoastAttitude::Held { hold, offset } => {
                let local = Local::new(&self.system, t, body, &state);
                let frame = attitude::hold_frame(hold, &local, self.target).unwrap_or_default();
                ((frame * offset).normalize(), DVec3::ZERO)
            }
        };
        Rigid { body, state, icrf_from_hull: Rotation::new(q), rate: Vector::new(rate) }
    }

    /// A resting ship now.
    fn resting(&self, rest: &Resting) -> Rigid {
        let spin = &self.system.body(rest.body).spin;
        let icrf_from_fixed = spin.icrf_from_fixed(self.time);
        let omega = spin.angular_velocity(self.time).0;
        let r = icrf_from_fixed.raw(rest.position.0);
        let attitude = (icrf_from_fixed * rest.fixed_from_hull).0;
        Rigid {
            body: rest.body,
            state: State { position: Position::new(r), velocity: Velocity::new(omega.cross(r)) },
            icrf_from_hull: Rotation::new(attitude.normalize()),
            rate: Vector::new(attitude.conjugate() * omega),
        }
    }
}
