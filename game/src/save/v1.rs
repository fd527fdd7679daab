//! Format 1: what is kept of a World, in structs of its own, so that the World may change without breaking old saves.
//!
//! Bodies are kept by key, not by index: a mod may add a moon. Everything a tick depends on is here; what follows from it
//! (the contact bubble's colliders, the sky) is rebuilt. Floats keep every bit. The way back is in [`super::restore`],
//! which distrusts each number.

use crate::command::{Guidance, Hold};
use crate::world::World;
use crate::world::ship::contact::Ground;
use crate::world::ship::guidance::burn::Stage;
use crate::world::ship::guidance::{Burn, Landing, Phase};
use crate::world::ship::{Coast, CoastAttitude, Effort, Motion, Resting, Rigid, Ship};
use crate::world::system::System;
use engine::orbit::path::Knot;
use engine::orbit::{BodyId, State};
use engine::rigid::Contact;
use engine::space::{Centred, Position, Velocity};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// A World, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SaveV1 {
    /// Version of the program that wrote it.
    pub game_version: String,
    /// Folder of the system.
    pub system: String,
    /// Hash of the system's assets when it was written.
    pub system_hash: String,
    /// Key of the ship.
    pub ship_key: String,
    /// Ticks since J2000 TDB.
    pub time_ticks: i64,
    /// See [`World::quarters`].
    pub quarters: u8,
    /// See [`World::warp`].
    pub warp: u8,
    /// See [`World::warp_asked`].
    pub warp_asked: u8,
    /// What the pilot points at.
    pub target: Option<TargetV1>,
    /// Until when the clock hurries, ticks since J2000 TDB.
    #[serde(default)]
    pub warp_to_ticks: Option<i64>,
    /// The ship.
    pub ship: ShipV1,
}

/// A target, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TargetV1 {
    /// Key of the body.
    pub body: String,
    /// Latitude and east longitude of a spot, 1e-6 degrees.
    pub spot_udeg: Option<(i32, i32)>,
}

/// A ship, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShipV1 {
    /// How it moves.
    pub motion: MotionV1,
    /// kg.
    pub propellant_kg: f64,
    /// 0 … 65535.
    pub throttle: u16,
    /// 0 … 1.
    pub nozzle: f64,
    /// Gear down?
    pub gear_down: bool,
    /// Attitude hold.
    pub hold: Hold,
    /// The attitude kept at rest, x y z w.
    pub held: Option<[f64; 4]>,
    /// Who flies the throttle.
    pub guidance: Guidance,
    /// The landing programme.
    pub landing: Option<LandingV1>,
    /// Throttle and RCS in force, felt acceleration in m/s².
    pub effort: [f64; 3],
    /// Speed (m/s) and tick of the last contact.
    pub last_contact: Option<(f64, i64)>,
    /// What it keeps about the ground.
    #[serde(default)]
    pub ground: GroundV1,
    /// Planned burns.
    #[serde(default)]
    pub nodes: Vec<NodeV1>,
    /// The first of them as it is flown.
    #[serde(default)]
    pub burn: Option<BurnV1>,
}

/// A planned burn, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NodeV1 {
    /// Ticks since J2000 TDB.
    pub at_ticks: i64,
    /// Along (velocity, normal, outward), mm/s.
    pub dv_mm_s: [i32; 3],
}

/// A burn as it is flown, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BurnV1 {
    /// ICRF axes, m/s.
    pub to_gain_m_s: [f64; 3],
    /// Unit vector, ICRF axes.
    pub aim: [f64; 3],
    /// Begun?
    pub spent: bool,
    /// Where it stands.
    pub stage: StageV1,
}

/// A stage of a burn, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum StageV1 {
    /// Until this tick.
    Wait(i64),
    /// Turning.
    Turn,
    /// Main engine.
    Burn,
    /// RCS.
    Trim,
}

/// Memory of contact, as kept.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundV1 {
    /// Cube face and middle of the ground patch, cells.
    pub patch: Option<(u8, [i32; 2])>,
    /// For each leg: the point of the ground that it holds to (m, body-fixed axes), and its compression, m.
    pub legs: Vec<(Option<[f64; 3]>, f64)>,
    /// Ticks at rest.
    pub quiet_ticks: u16,
    /// Did something touch?
    pub touching: bool,
}

/// A motion, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum MotionV1 {
    /// Sampled.
    Coast {
        /// Since when it coasts, ticks since J2000 TDB.
        epoch_ticks: i64,
        /// Position and velocity at the knot; in saves without one at the epoch, from where the path was a conic.
        state: StateV1,
        /// Attitude.
        attitude: CoastAttitudeV1,
        /// Where the present step of the path begins.
        #[serde(default)]
        knot: Option<KnotV1>,
        /// Of saves without a knot: when the path was to be looked at again. No longer written.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        wake_ticks: Option<i64>,
        /// Of saves without a knot: why. No longer written.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        wake_reason: Option<ReasonV1>,
    },
    /// Integrated.
    Fly(RigidV1),
    /// Integrated near the ground.
    Contact(RigidV1),
    /// At rest.
    Landed(RestingV1),
    /// Broken.
    Crashed(RestingV1),
}

/// A state, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateV1 {
    /// Key of the body.
    pub body: String,
    /// m from the body's centre, ICRF axes.
    pub position_m: [f64; 3],
    /// m/s.
    pub velocity_m_s: [f64; 3],
}

/// What makes a state a knot of a path, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnotV1 {
    /// When: ticks since J2000 TDB.
    pub tick: i64,
    /// And seconds beyond, less than a tick.
    pub beyond_s: f64,
    /// The second word of the position, m.
    pub position_low_m: [f64; 3],
    /// The second word of the velocity, m/s.
    pub velocity_low_m_s: [f64; 3],
}

/// A rigid body, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigidV1 {
    /// Position and velocity.
    pub state: StateV1,
    /// ICRF from hull, x y z w.
    pub attitude: [f64; 4],
    /// Hull axes, rad/s.
    pub rate_rad_s: [f64; 3],
}

/// A ship at rest, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RestingV1 {
    /// Key of the body.
    pub body: String,
    /// m, body-fixed axes.
    pub position_m: [f64; 3],
    /// Body-fixed from hull, x y z w.
    pub attitude: [f64; 4],
}

/// Attitude of a coasting ship, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum CoastAttitudeV1 {
    /// Turning at a constant rate.
    Inertial {
        /// ICRF from hull at the epoch, x y z w.
        attitude: [f64; 4],
        /// rad/s.
        rate_rad_s: [f64; 3],
    },
    /// Held to a direction.
    Held {
        /// Which.
        hold: Hold,
        /// x y z w.
        offset: [f64; 4],
    },
}

/// Why a path was to be looked at again, in saves without a knot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ReasonV1 {
    /// Search on.
    Horizon,
    /// Air or ground.
    Low,
    /// Leaving the sphere of influence.
    Leave,
    /// Entering that of a body.
    Enter(String),
    /// The autopilot's.
    Guidance,
}

/// A landing programme, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LandingV1 {
    /// Key of the body.
    pub body: String,
    /// Unit vector, body-fixed axes.
    pub spot: [f64; 3],
    /// m.
    pub ground_m: f64,
    /// m.
    pub gate_m: f64,
    /// Flight-path angle of arrival, rad below the horizon.
    pub arrival_rad: f64,
    /// Where it stands.
    pub phase: PhaseV1,
}

/// A phase of landing, as kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum PhaseV1 {
    /// Until this tick.
    Wait(i64),
    /// Deorbit burn.
    Burn,
    /// Until this tick.
    Approach(i64),
    /// Braking burn.
    Brake,
    /// Descent.
    Descend,
    /// Coming to rest.
    Touchdown,
    /// Nothing is flown.
    OutOfReach,
}

/// Turns parts of a World into their kept form; knows the bodies' keys.
struct Keeper<'a>(&'a System);

impl Keeper<'_> {
    fn key(&self, body: BodyId) -> String {
        self.0.body(body).key.clone()
    }
    fn state(&self, body: BodyId, s: &State<Centred>) -> StateV1 {
        StateV1 { body: self.key(body), position_m: s.position.0.to_array(), velocity_m_s: s.velocity.0.to_array() }
    }
    fn rigid(&self, r: &Rigid) -> RigidV1 {
        RigidV1 { state: self.state(r.body, &r.state), attitude: quat(r.icrf_from_hull.0), rate_rad_s: r.rate.0.to_array() }
    }
    fn resting(&self, r: &Resting) -> RestingV1 {
        RestingV1 { body: self.key(r.body), position_m: r.position.0.to_array(), attitude: quat(r.fixed_from_hull.0) }
    }
    fn coast(&self, c: &Coast) -> MotionV1 {
        let Coast { path, attitude, since, ahead: _ } = c;
        let Knot { host, at, position, velocity } = *path.knot();
        let state = State { position: Position::new(position.high), velocity: Velocity::new(velocity.high) };
        MotionV1::Coast {
            epoch_ticks: since.ticks,
            state: self.state(host, &state),
            attitude: match *attitude {
                CoastAttitude::Inertial { icrf_from_hull, rate } => {
                    CoastAttitudeV1::Inertial { attitude: quat(icrf_from_hull), rate_rad_s: vec(rate) }
                }
                CoastAttitude::Held { hold, offset } => CoastAttitudeV1::Held { hold, offset: quat(offset) },
            },
            knot: Some(KnotV1 {
                tick: at.tick.ticks,
                beyond_s: at.beyond_s,
                position_low_m: vec(position.low),
                velocity_low_m_s: vec(velocity.low),
            }),
            wake_ticks: None,
            wake_reason: None,
        }
    }
    fn motion(&self, motion: &Motion) -> MotionV1 {
        match motion {
            Motion::Coast(c) => self.coast(c),
            Motion::Fly(r) => MotionV1::Fly(self.rigid(r)),
            Motion::Contact(r) => MotionV1::Contact(self.rigid(r)),
            Motion::Landed(r) => MotionV1::Landed(self.resting(r)),
            Motion::Crashed(r) => MotionV1::Crashed(self.resting(r)),
        }
    }
    fn landing(&self, l: &Landing) -> LandingV1 {
        let Landing { body, spot, ground_m, gate_m, arrival_rad, phase } = *l;
        let phase = match phase {
            Phase::Wait { burn } => PhaseV1::Wait(burn.ticks),
            Phase::Burn => PhaseV1::Burn,
            Phase::Approach { brake } => PhaseV1::Approach(brake.ticks),
            Phase::Brake => PhaseV1::Brake,
            Phase::Descend => PhaseV1::Descend,
            Phase::Touchdown => PhaseV1::Touchdown,
            Phase::OutOfReach => PhaseV1::OutOfReach,
        };
        LandingV1 { body: self.key(body), spot: vec(spot), ground_m, gate_m, arrival_rad, phase }
    }
    fn ship(&self, ship: &Ship) -> ShipV1 {
        // Taken apart by name, so that a field that the World gains cannot be forgotten here.
        let Ship {
            spec: _,
            motion,
            propellant_kg,
            throttle,
            nozzle,
            gear_down,
            hold,
            held,
            guidance,
            landing,
            nodes,
            burn,
            effort: Effort { throttle: effort_throttle, rcs, felt_m_s2 },
            last_contact,
            // Of the ground only its memory is state: the mesh follows from it, the recorder looks back.
            ground: Ground { contact, bubble: _, recorder: _ },
        } = ship;
        let Contact { key, legs, quiet_ticks, touching } = contact;
        ShipV1 {
            motion: self.motion(motion),
            propellant_kg: *propellant_kg,
            throttle: *throttle,
            nozzle: *nozzle,
            gear_down: *gear_down,
            hold: *hold,
            held: held.map(quat),
            guidance: *guidance,
            landing: landing.as_ref().map(|l| self.landing(l)),
            effort: [*effort_throttle, *rcs, *felt_m_s2],
            last_contact: last_contact.map(|(speed, at)| (speed, at.ticks)),
            ground: GroundV1 {
                patch: key.map(|k| (k.face, k.middle)),
                legs: legs.iter().map(|l| (l.hold_m.map(vec), l.compression_m)).collect(),
                quiet_ticks: *quiet_ticks,
                touching: *touching,
            },
            nodes: nodes.iter().map(|n| NodeV1 { at_ticks: n.at.ticks, dv_mm_s: n.dv_mm_s }).collect(),
            burn: burn.as_ref().map(burn_of),
        }
    }
}

impl From<&World> for SaveV1 {
    fn from(world: &World) -> Self {
        let World { system, time, quarters, warp, warp_asked, ship, target, warp_to } = world;
        let keeper = Keeper(system);
        Self {
            game_version: env!("CARGO_PKG_VERSION").to_owned(),
            system: system.key.clone(),
            system_hash: system.hash.clone(),
            ship_key: ship.spec.key.clone(),
            time_ticks: time.ticks,
            quarters: *quarters,
            warp: *warp,
            warp_asked: *warp_asked,
            target: target.map(|t| TargetV1 { body: keeper.key(t.body), spot_udeg: t.spot.map(|s| (s.lat_udeg, s.lon_udeg)) }),
            warp_to_ticks: warp_to.map(|t| t.ticks),
            ship: keeper.ship(ship),
        }
    }
}

fn burn_of(b: &Burn) -> BurnV1 {
    let Burn { to_gain, aim, spent, phase } = *b;
    let stage = match phase {
        Stage::Wait { turn } => StageV1::Wait(turn.ticks),
        Stage::Turn => StageV1::Turn,
        Stage::Burn => StageV1::Burn,
        Stage::Trim => StageV1::Trim,
    };
    BurnV1 { to_gain_m_s: vec(to_gain), aim: vec(aim), spent, stage }
}
fn quat(q: DQuat) -> [f64; 4] {
    q.to_array()
}
fn vec(v: DVec3) -> [f64; 3] {
    v.to_array()
}
