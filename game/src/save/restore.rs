//! The way back: from what a save of format 1 says to a World, distrusting each number.
//!
//! All problems are found at once, each named by its field. Nothing is silently replaced by a default.

use super::v1::{
    BurnV1, CoastAttitudeV1, GroundV1, KnotV1, LandingV1, MotionV1, NodeV1, PhaseV1, RestingV1, RigidV1, SaveV1, ShipV1, StageV1, StateV1,
};
use crate::command::{MOST_NODES, Node, Spot, Target, WARP_QUARTERS};
use crate::world::World;
use crate::world::ship::contact::Ground;
use crate::world::ship::guidance::burn::Stage;
use crate::world::ship::guidance::{Burn, Landing, Phase};
use crate::world::ship::spec::ShipSpec;
use crate::world::ship::{Coast, CoastAttitude, Effort, Motion, Resting, Rigid, Ship};
use crate::world::system::System;
use engine::orbit::path::twofold::Twofold;
use engine::orbit::path::{End, Knot, Path, Setting};
use engine::orbit::{BodyId, State, kepler};
use engine::rigid::{Contact, LegState, PatchKey};
use engine::space::{Position, Rotation, Vector, Velocity};
use engine::time::{Moment, SimTime, TICK_S};
use engine::units::{AU, SPEED_OF_LIGHT};
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// Farthest that a ship may be from its body: a light year or so.
const FARTHEST_M: f64 = 63_241.0 * AU;
/// Fastest turn that is believed, rad/s.
const FASTEST_TURN_RAD_S: f64 = 1.0e3;
/// Times that are believed, ticks: ±100,000 years.
const FARTHEST_TICKS: i64 = 60 * 86_400 * 36_525_000;

/// Steps from a knot to now that are believed.
const MOST_STEPS: u32 = 10_000;
/// Legs that are believed.
const MOST_LEGS: usize = 64;

/// Collects what is wrong while it converts.
struct Checker<'a> {
    system: &'a System,
    /// Of the ship that is restored (see [`Setting`]).
    light_m3_s2: f64,
    problems: Vec<String>,
}

impl SaveV1 {
    /// The World that was saved.
    ///
    /// # Errors
    /// Every field that cannot be right, with what was expected.
    pub fn restore(&self, system: &Arc<System>, spec: &Arc<ShipSpec>) -> Result<World, Vec<String>> {
        let light_m3_s2 = spec.light_m3_s2(spec.mass.dry_kg + self.ship.propellant_kg, system);
        let mut c = Checker { system, light_m3_s2, problems: Vec::new() };
        if self.system != system.key {
            c.problems.push(format!("system: it was saved in `{}`, loaded is `{}`", self.system, system.key));
        }
        if self.ship_key != spec.key {
            c.problems.push(format!("ship_key: it was saved with `{}`, loaded is `{}`", self.ship_key, spec.key));
        }
        let time = c.ticks("time_ticks", self.time_ticks);
        let levels = WARP_QUARTERS.len();
        for (field, value, below) in [("quarters", self.quarters, 4), ("warp", self.warp, levels), ("warp_asked", self.warp_asked, levels)]
        {
            if usize::from(value) >= below {
                c.problems.push(format!("{field}: {value}, expected 0 to {}", below - 1));
            }
        }
        let target = self.target.as_ref().map(|t| {
            let spot = t.spot_udeg.map(|(lat_udeg, lon_udeg)| {
                c.within("target.spot_udeg.0", f64::from(lat_udeg), -90e6, 90e6);
                c.within("target.spot_udeg.1", f64::from(lon_udeg), -360e6, 360e6);
                Spot { lat_udeg, lon_udeg }
            });
            Target { body: c.body("target.body", &t.body), spot }
        });
        let warp_to = self.warp_to_ticks.map(|t| c.ticks("warp_to_ticks", t));
        let ship = c.ship(self, spec);
        if c.problems.is_empty() {
            let Self { quarters, warp, warp_asked, .. } = *self;
            Ok(World { system: Arc::clone(system), time, quarters, warp, warp_asked, ship, target, warp_to })
        } else {
            Err(c.problems)
        }
    }
}

impl Checker<'_> {
    fn within(&mut self, field: &str, x: f64, low: f64, high: f64) -> f64 {
        if !x.is_finite() || x < low || x > high {
            self.problems.push(format!("{field}: {x}, expected {low} to {high}"));
        }
        x
    }
    fn ticks(&mut self, field: &str, ticks: i64) -> SimTime {
        if !(-FARTHEST_TICKS..=FARTHEST_TICKS).contains(&ticks) {
            self.problems.push(format!("{field}: {ticks}, expected a tick within 100,000 years of J2000"));
        }
        SimTime::from_ticks(ticks)
    }
    fn body(&mut self, field: &str, key: &str) -> BodyId {
        self.system.find(key).unwrap_or_else(|| {
            let nearest = crate::save::nearest(key, self.system.bodies.iter().map(|b| b.key.as_str()));
            self.problems.push(format!("{field}: the system `{}` has no body `{key}`{nearest}", self.system.key));
            BodyId(0)
        })
    }
    fn vector(&mut self, field: &str, v: [f64; 3], longest: f64) -> DVec3 {
        for (axis, x) in ["x", "y", "z"].into_iter().zip(v) {
            self.within(&format!("{field}.{axis}"), x, -longest, longest);
        }
        DVec3::from_array(v)
    }
    fn rotation(&mut self, field: &str, q: [f64; 4]) -> DQuat {
        let q = DQuat::from_array(q);
        let length = q.length();
        if !length.is_finite() || (length - 1.0).abs() > 1e-6 {
            self.problems.push(format!("{field}: length {length}, expected a unit quaternion"));
        }
        q
    }
    fn state(&mut self, field: &str, s: &StateV1) -> (BodyId, State<engine::space::Centred>) {
        let body = self.body(&format!("{field}.body"), &s.body);
        let position = self.vector(&format!("{field}.position_m"), s.position_m, FARTHEST_M);
        if position.length() < 1.0 {
            self.problems.push(format!("{field}.position_m: at the body's centre, expected to be outside it"));
        }
        let velocity = self.vector(&format!("{field}.velocity_m_s"), s.velocity_m_s, SPEED_OF_LIGHT);
        (body, State { position: Position::new(position), velocity: Velocity::new(velocity) })
    }
    fn rigid(&mut self, field: &str, r: &RigidV1) -> Rigid {
        let (body, state) = self.state(&format!("{field}.state"), &r.state);
        Rigid {
            body,
            state,
            icrf_from_hull: Rotation::new(self.rotation(&format!("{field}.attitude"), r.attitude)),
            rate: Vector::new(self.vector(&format!("{field}.rate_rad_s"), r.rate_rad_s, FASTEST_TURN_RAD_S)),
        }
    }
    fn resting(&mut self, field: &str, r: &RestingV1) -> Resting {
        let body = self.body(&format!("{field}.body"), &r.body);
        let radius = self.system.body(body).radius_m;
        let position = self.vector(&format!("{field}.position_m"), r.position_m, 2.0 * radius);
        let height = position.length();
        if !(0.5 * radius..=2.0 * radius).contains(&height) {
            self.problems.push(format!("{field}.position_m: {height} m from the centre, expected to stand on the ground"));
        }
        let attitude = self.rotation(&format!("{field}.attitude"), r.attitude);
        Resting { body, position: Position::new(position), fixed_from_hull: Rotation::new(attitude) }
    }
    fn motion(&mut self, now: i64, m: &MotionV1) -> Motion {
        match m {
            MotionV1::Fly(r) => Motion::Fly(self.rigid("ship.motion.Fly", r)),
            MotionV1::Contact(r) => Motion::Contact(self.rigid("ship.motion.Contact", r)),
            MotionV1::Landed(r) => Motion::Landed(self.resting("ship.motion.Landed", r)),
            MotionV1::Crashed(r) => Motion::Crashed(self.resting("ship.motion.Crashed", r)),
            MotionV1::Coast { epoch_ticks, state, attitude, knot, wake_ticks: _, wake_reason: _ } => {
                let (body, state) = self.state("ship.motion.Coast.state", state);
                let epoch = self.ticks("ship.motion.Coast.epoch_ticks", *epoch_ticks);
                let attitude = match attitude {
                    CoastAttitudeV1::Inertial { attitude, rate_rad_s } => CoastAttitude::Inertial {
                        icrf_from_hull: self.rotation("ship.motion.Coast.attitude.Inertial.attitude", *attitude),
                        rate: self.vector("ship.motion.Coast.attitude.Inertial.rate_rad_s", *rate_rad_s, FASTEST_TURN_RAD_S),
                    },
                    CoastAttitudeV1::Held { hold, offset } => {
                        CoastAttitude::Held { hold: *hold, offset: self.rotation("ship.motion.Coast.attitude.Held.offset", *offset) }
                    }
                };
                let now = SimTime::from_ticks(now);
                let knot = match knot {
                    Some(k) => self.knot(body, &state, k),
                    // A conic then; from where it has led to now the ship goes on under all forces.
                    None => Knot::new(body, now, &kepler::propagate(self.system.body(body).gm_m3_s2, &state, now.since(epoch))),
                };
                Motion::Coast(Coast::new(self.path(knot, now), attitude, epoch))
            }
        }
    }
    fn knot(&mut self, host: BodyId, state: &State<engine::space::Centred>, k: &KnotV1) -> Knot {
        let tick = self.ticks("ship.motion.Coast.knot.tick", k.tick);
        let beyond_s = self.within("ship.motion.Coast.knot.beyond_s", k.beyond_s, 0.0, 2.0 * TICK_S);
        let position = self.vector("ship.motion.Coast.knot.position_low_m", k.position_low_m, 1.0);
        let velocity = self.vector("ship.motion.Coast.knot.velocity_low_m_s", k.velocity_low_m_s, 1.0);
        Knot {
            host,
            at: Moment { tick, beyond_s },
            position: Twofold { high: state.position.0, low: position },
            velocity: Twofold { high: state.velocity.0, low: velocity },
        }
    }
    /// The path from a knot, at the step that says where the ship is now. A save's own knot begins it; with other files of the
    /// system it may take some steps.
    fn path(&mut self, knot: Knot, now: SimTime) -> Path {
        let (gravity, places) = (&self.system.gravity, &self.system.ephemeris);
        let setting = Setting { light_m3_s2: self.light_m3_s2, ..Setting::default() };
        let mut path = Path::with(gravity, places, knot, setting);
        if !self.problems.is_empty() {
            return path;
        }
        let mut left = MOST_STEPS;
        while left > 0 && Moment::from(now).since(path.step().until) >= 0.0 && path.step().end != End::Low {
            path.next(gravity, places);
            left -= 1;
        }
        if left == 0 || Moment::from(now).since(path.knot().at) < 0.0 {
            self.problems.push(format!("ship.motion.Coast.knot: its path does not lead to time_ticks ({})", now.ticks));
        }
        path
    }
    fn landing(&mut self, l: &LandingV1) -> Landing {
        let body = self.body("ship.landing.body", &l.body);
        let spot = self.vector("ship.landing.spot", l.spot, 1.0 + 1e-9);
        if (spot.length() - 1.0).abs() > 1e-6 {
            self.problems.push(format!("ship.landing.spot: length {}, expected a unit vector", spot.length()));
        }
        let phase = match l.phase {
            PhaseV1::Wait(at) => Phase::Wait { burn: self.ticks("ship.landing.phase.Wait", at) },
            PhaseV1::Burn => Phase::Burn,
            PhaseV1::Approach(at) => Phase::Approach { brake: self.ticks("ship.landing.phase.Approach", at) },
            PhaseV1::Brake => Phase::Brake,
            PhaseV1::Descend => Phase::Descend,
            PhaseV1::Touchdown => Phase::Touchdown,
            PhaseV1::OutOfReach => Phase::OutOfReach,
        };
        let ground_m = self.within("ship.landing.ground_m", l.ground_m, -1e6, 1e6);
        let gate_m = self.within("ship.landing.gate_m", l.gate_m, -1e6, 1e7);
        let arrival_rad = self.within("ship.landing.arrival_rad", l.arrival_rad, 0.0, 1.5);
        Landing { body, spot, ground_m, gate_m, arrival_rad, phase }
    }
    fn ground(&mut self, g: &GroundV1) -> Ground {
        if g.legs.len() > MOST_LEGS {
            self.problems.push(format!("ship.ground.legs: {}, expected at most {MOST_LEGS}", g.legs.len()));
        }
        let key = g.patch.map(|(face, middle)| {
            self.within("ship.ground.patch.0", f64::from(face), 0.0, 5.0);
            PatchKey { face, middle }
        });
        let leg = |c: &mut Self, (hold, compression_m): &(Option<[f64; 3]>, f64)| LegState {
            hold_m: hold.map(|h| c.vector("ship.ground.legs.hold", h, FARTHEST_M)),
            compression_m: c.within("ship.ground.legs.compression", *compression_m, -1e3, 1e3),
        };
        let legs = g.legs.iter().take(MOST_LEGS).map(|l| leg(self, l)).collect();
        Ground { contact: Contact { key, legs, quiet_ticks: g.quiet_ticks, touching: g.touching }, ..Ground::default() }
    }
    fn nodes(&mut self, s: &ShipV1) -> Vec<Node> {
        if s.nodes.len() > MOST_NODES || !s.nodes.is_sorted_by_key(|n| n.at_ticks) {
            self.problems.push(format!("ship.nodes: {}, expected at most {MOST_NODES}, in order of time", s.nodes.len()));
        }
        let node = |c: &mut Self, n: &NodeV1| Node { at: c.ticks("ship.nodes.at_ticks", n.at_ticks), dv_mm_s: n.dv_mm_s };
        s.nodes.iter().take(MOST_NODES).map(|n| node(self, n)).collect()
    }
    fn burn(&mut self, b: &BurnV1) -> Burn {
        let aim = self.vector("ship.burn.aim", b.aim, 1.0 + 1e-9);
        if (aim.length() - 1.0).abs() > 1e-6 {
            self.problems.push(format!("ship.burn.aim: length {}, expected a unit vector", aim.length()));
        }
        let phase = match b.stage {
            StageV1::Wait(turn) => Stage::Wait { turn: self.ticks("ship.burn.stage.Wait", turn) },
            StageV1::Turn => Stage::Turn,
            StageV1::Burn => Stage::Burn,
            StageV1::Trim => Stage::Trim,
        };
        Burn { to_gain: self.vector("ship.burn.to_gain_m_s", b.to_gain_m_s, SPEED_OF_LIGHT), aim, spent: b.spent, phase }
    }
    fn ship(&mut self, save: &SaveV1, spec: &Arc<ShipSpec>) -> Ship {
        let s = &save.ship;
        let [throttle, rcs, felt_m_s2] = s.effort;
        Ship {
            spec: Arc::clone(spec),
            motion: self.motion(save.time_ticks, &s.motion),
            propellant_kg: self.within("ship.propellant_kg", s.propellant_kg, 0.0, spec.mass.propellant_kg),
            throttle: s.throttle,
            nozzle: self.within("ship.nozzle", s.nozzle, 0.0, 1.0),
            gear_down: s.gear_down,
            hold: s.hold,
            held: s.held.map(|q| self.rotation("ship.held", q)),
            guidance: s.guidance,
            landing: s.landing.as_ref().map(|l| self.landing(l)),
            effort: Effort {
                throttle: self.within("ship.effort.0", throttle, 0.0, 1.0),
                rcs: self.within("ship.effort.1", rcs, 0.0, 1.0e3),
                felt_m_s2: self.within("ship.effort.2", felt_m_s2, 0.0, 1.0e9),
            },
            last_contact: s
                .last_contact
                .map(|(speed, at)| (self.within("ship.last_contact.0", speed, 0.0, SPEED_OF_LIGHT), self.ticks("ship.last_contact.1", at))),
            ground: self.ground(&s.ground),
            nodes: self.nodes(s),
            burn: s.burn.as_ref().map(|b| self.burn(b)),
        }
    }
}
