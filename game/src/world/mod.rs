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
use engine::orbit::path::model::LEAVE;
use engine::orbit::path::{End, Event, Knot, Path, Setting};
use engine::orbit::{BodyId, State};
use engine::space::{Position, Rotation, Vector, Velocity};
use engine::time::SimTime;
use glam::DVec3;
use ship::attitude::{self, offset_of_body};
use ship::contact;
use ship::local::Local;
use ship::warp;
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
        // Only what is seen has changed: the flight goes on to the bit.
        if self.system.hash == system.hash {
            self.system = system.clone();
            return true;
        }
        self.leave_path();
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
                    self.leave_path();
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
                    self.leave_path();
                }
            }
            Action::Refuel => ship.propellant_kg = ship.spec.mass.propellant_kg,
            // The session keeps and restores whole worlds; within one there is nothing to do.
            Action::Quicksave | Action::Quickload => {}
            Action::AddNode(_) | Action::ChangeNode(..) | Action::DeleteNode(_) => {
                ship.edit_nodes(action, self.time);
                if ship.hold == Hold::Node || ship.guidance == Guidance::Node {
                    self.leave_path();
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
                    self.leave_path();
                }
            }
            Motion::Landed(rest) if stirred => self.ship.motion = Motion::Contact(self.resting(rest)),
            _ => {}
        }
    }

    /// From sampling to integration, at this tick.
    fn leave_path(&mut self) {
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
    fn warp_limit(&mut self) -> u8 {
        let planned = self.planned();
        match &mut self.ship.motion {
            Motion::Coast(coast) => {
                let met = coast.ahead.first(&self.system, &coast.path, self.time, self.warp_asked);
                let ahead = |at: SimTime| at.ticks - self.time.ticks;
                // A burn that the pilot planned surprises nobody.
                let hurried = planned.filter(|_| self.ship.guidance == Guidance::Node);
                let first = met.into_iter().chain(planned.filter(|_| hurried.is_none())).min();
                let limit = first.map_or(u8::MAX, |at| warp::level_before(ahead(at)));
                hurried.map_or(limit, |at| limit.min(warp::hurried_level(ahead(at))))
            }
            Motion::Fly(_) | Motion::Contact(_) => warp::FLY_LEVEL,
            _ => u8::MAX,
        }
    }

    /// When the autopilot wants to fly, if it waits for that.
    fn planned(&self) -> Option<SimTime> {
        self.ship.planned_wake().map(|at| at.max(self.time))
    }

    /// Lets simulated time pass. What remains of a tick's share is dropped when the clock must slow down.
    fn advance(&mut self, ticks: i64, axes: Axes) {
        let end = self.time.plus(ticks);
        let mut stepped = 0;
        while self.time < end {
            let planned = self.planned();
            match &mut self.ship.motion {
                Motion::Landed(_) | Motion::Crashed(_) => self.time = end,
                Motion::Coast(coast) => {
                    let to = planned.map_or(end, |at| at.min(end));
                    match coast.path.advance(&self.system.gravity, &self.system.ephemeris, to) {
                        Some(event) => self.meet(event),
                        None => {
                            self.time = to;
                            if planned == Some(to) {
                                self.leave_path();
                            }
                        }
                    }
                }
                Motion::Fly(rigid) | Motion::Contact(rigid) => {
                    if stepped >= i64::from(WARP_QUARTERS[usize::from(warp::FLY_LEVEL)] / 4) {
                        return;
                    }
                    stepped += 1;
                    let rigid = *rigid;
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
            self.enter_path();
        }
    }

    /// From integration to sampling, where nothing acts but gravity.
    fn enter_path(&mut self) {
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
        let knot = Knot::new(rigid.body, self.time, &rigid.state);
        self.ship.effort = ship::Effort::default();
        self.start_path(knot, attitude, self.time);
    }

    /// Begins a sampled path.
    fn start_path(&mut self, knot: Knot, attitude: CoastAttitude, since: SimTime) {
        let setting = Setting { light_m3_s2: self.ship.light_m3_s2(&self.system), ..Setting::default() };
        let path = Path::with(&self.system.gravity, &self.system.ephemeris, knot, setting);
        self.ship.motion = Motion::Coast(Coast::new(path, attitude, since));
    }

    /// What a path came to: it is dealt with at the first tick that is not before it.
    fn meet(&mut self, event: Event) {
        self.time = event.at.next_tick().max(self.time);
        if event.end == End::Low {
            self.leave_path();
            // The autopilot planned to come here; a pilot may not have.
            if self.ship.guidance == Guidance::Land {
                return;
            }
        } else if let Motion::Coast(Coast { attitude: CoastAttitude::Held { .. }, .. }) = self.ship.motion {
            // The path goes on about another body; a hold about it turns the ship first.
            self.leave_path();
        }
        self.warp_asked = self.warp_asked.min(WARP_ONE);
    }

    /// Hands a flying ship to the body that dominates it.
    fn change_sphere(&mut self) {
        let rigid = self.rigid();
        let host = self.system.body(rigid.body);
        let r = rigid.state.position.0;
        let mut to = (r.length() > LEAVE * host.soi_radius_m).then_some(host.parent).flatten();
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

    /// A coasting ship at `t`, a tick of its path's present step.
    fn coasting(&self, coast: &Coast, t: SimTime) -> Rigid {
        let state = coast.path.sample(t);
        let body = coast.path.host();
        let (q, rate) = match coast.attitude {
            CoastAttitude::Inertial { icrf_from_hull, rate } => (attitude::advance(icrf_from_hull, rate, t.since(coast.since)), rate),
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
