//! The World's bits, field by field: from them the state hash of a replay, and what differs when two runs part.
//!
//! Every number that a tick depends on is listed here under its subsystem. Not here: the save format.

use super::World;
use super::ship::guidance::Phase;
use super::ship::{CoastAttitude, Motion, Rigid};
use crate::command::{Guidance, Hold};
use engine::orbit::State;
use engine::space::{Frame, Position, Rotation, Velocity};
use glam::{DQuat, DVec3};

/// The subsystems that a hash names, in order.
pub const SUBSYSTEMS: [&str; 6] = ["time", "orbit", "attitude", "ship", "contact", "guidance"];

/// `(subsystem, field, bits)`.
pub type Field = (&'static str, &'static str, u64);

/// Collects fields.
struct Fields(Vec<Field>);

impl Fields {
    fn bits(&mut self, subsystem: &'static str, field: &'static str, bits: u64) {
        self.0.push((subsystem, field, bits));
    }
    fn int(&mut self, subsystem: &'static str, field: &'static str, x: i64) {
        self.bits(subsystem, field, u64::from_ne_bytes(x.to_ne_bytes()));
    }
    fn real(&mut self, subsystem: &'static str, field: &'static str, x: f64) {
        self.bits(subsystem, field, x.to_bits());
    }
    fn vector(&mut self, subsystem: &'static str, names: [&'static str; 3], v: DVec3) {
        for (name, x) in names.into_iter().zip(v.to_array()) {
            self.real(subsystem, name, x);
        }
    }
    fn quaternion(&mut self, q: DQuat) {
        for (name, x) in ["attitude.x", "attitude.y", "attitude.z", "attitude.w"].into_iter().zip(q.to_array()) {
            self.real("attitude", name, x);
        }
    }
    fn place<F: Frame>(&mut self, position: Position<F>) {
        self.vector("orbit", ["position.x", "position.y", "position.z"], position.0);
    }
    fn rigid(&mut self, r: &Rigid) {
        self.int("orbit", "body", i64::from(r.body.0));
        self.place(r.state.position);
        self.vector("orbit", ["velocity.x", "velocity.y", "velocity.z"], r.state.velocity.0);
        self.quaternion(r.icrf_from_hull.0);
        self.vector("attitude", ["rate.x", "rate.y", "rate.z"], r.rate.0);
    }
    fn motion(&mut self, motion: &Motion) {
        let kind = match motion {
            Motion::Coast(_) => 0,
            Motion::Fly(_) => 1,
            Motion::Contact(_) => 2,
            Motion::Landed(_) => 3,
            Motion::Crashed(_) => 4,
        };
        self.int("contact", "motion", kind);
        match motion {
            Motion::Fly(rigid) | Motion::Contact(rigid) => self.rigid(rigid),
            Motion::Landed(rest) | Motion::Crashed(rest) => {
                self.int("orbit", "body", i64::from(rest.body.0));
                self.place(rest.position);
                self.quaternion(rest.fixed_from_hull.0);
            }
            Motion::Coast(coast) => {
                self.int("time", "since", coast.since.ticks);
                let (icrf_from_hull, rate) = match coast.attitude {
                    CoastAttitude::Inertial { icrf_from_hull, rate } => (icrf_from_hull, rate),
                    CoastAttitude::Held { offset, .. } => (offset, DVec3::ZERO),
                };
                // The path is what its present step begins with.
                let knot = coast.path.knot();
                self.int("time", "knot.tick", knot.at.tick.ticks);
                self.real("time", "knot.beyond_s", knot.at.beyond_s);
                self.rigid(&Rigid {
                    body: knot.host,
                    state: State { position: Position::new(knot.position.high), velocity: Velocity::new(knot.velocity.high) },
                    icrf_from_hull: Rotation::new(icrf_from_hull),
                    rate: engine::space::Vector::new(rate),
                });
                self.vector("orbit", ["position.low.x", "position.low.y", "position.low.z"], knot.position.low);
                self.vector("orbit", ["velocity.low.x", "velocity.low.y", "velocity.low.z"], knot.velocity.low);
            }
        }
    }
}

/// A number for a hold, for hashes only.
fn hold_code(hold: Hold) -> i64 {
    hold as i64
}

impl World {
    /// Every number that a tick depends on, in a fixed order for each kind of motion.
    pub fn fields(&self) -> Vec<Field> {
        let mut f = Fields(Vec::with_capacity(64));
        f.int("time", "ticks", self.time.ticks);
        f.int("time", "quarters", i64::from(self.quarters));
        f.int("time", "warp", i64::from(self.warp));
        f.int("time", "warp_asked", i64::from(self.warp_asked));
        let ship = &self.ship;
        f.motion(&ship.motion);
        f.int("attitude", "hold", hold_code(ship.hold));
        for (name, x) in ["held.x", "held.y", "held.z", "held.w"].into_iter().zip(ship.held.map_or([0.0; 4], |q| q.to_array())) {
            f.real("attitude", name, x);
        }
        f.real("ship", "propellant_kg", ship.propellant_kg);
        f.int("ship", "throttle", i64::from(ship.throttle));
        f.real("ship", "nozzle", ship.nozzle);
        f.int("ship", "gear_down", i64::from(ship.gear_down));
        f.real("ship", "effort.throttle", ship.effort.throttle);
        f.real("ship", "effort.rcs", ship.effort.rcs);
        f.real("ship", "effort.felt_m_s2", ship.effort.felt_m_s2);
        f.real("contact", "last_contact.speed", ship.last_contact.map_or(-1.0, |c| c.0));
        f.int("contact", "last_contact.time", ship.last_contact.map_or(0, |c| c.1.ticks));
        for (name, bits) in ship.ground.fields() {
            f.bits("contact", name, bits);
        }
        let (kind, value) = match ship.guidance {
            Guidance::Manual => (0, 0),
            Guidance::Hover => (1, 0),
            Guidance::VerticalSpeed { cm_s } => (2, i64::from(cm_s)),
            Guidance::Land => (3, 0),
            Guidance::Node => (4, 0),
        };
        f.int("guidance", "guidance", kind);
        f.int("guidance", "guidance.value", value);
        if let Some(target) = self.target {
            f.int("guidance", "target.body", i64::from(target.body.0));
            f.int("guidance", "target.lat_udeg", target.spot.map_or(0, |s| i64::from(s.lat_udeg)));
            f.int("guidance", "target.lon_udeg", target.spot.map_or(0, |s| i64::from(s.lon_udeg)));
        }
        if let Some(landing) = &ship.landing {
            let (phase, at) = match landing.phase {
                Phase::Wait { burn } => (0, burn.ticks),
                Phase::Burn => (1, 0),
                Phase::Approach { brake } => (2, brake.ticks),
                Phase::Brake => (3, 0),
                Phase::Descend => (4, 0),
                Phase::Touchdown => (5, 0),
                Phase::OutOfReach => (6, 0),
            };
            f.int("guidance", "landing.phase", phase);
            f.int("guidance", "landing.at", at);
            f.int("guidance", "landing.body", i64::from(landing.body.0));
            f.vector("guidance", ["landing.spot.x", "landing.spot.y", "landing.spot.z"], landing.spot);
            f.real("guidance", "landing.ground_m", landing.ground_m);
            f.real("guidance", "landing.gate_m", landing.gate_m);
            f.real("guidance", "landing.arrival_rad", landing.arrival_rad);
        }
        if let Some(to) = self.warp_to {
            f.int("time", "warp_to", to.ticks);
        }
        for node in &ship.nodes {
            f.int("guidance", "node.at", node.at.ticks);
            for (name, x) in ["node.prograde", "node.normal", "node.radial"].into_iter().zip(node.dv_mm_s) {
                f.int("guidance", name, i64::from(x));
            }
        }
        if let Some(burn) = &ship.burn {
            let (phase, at) = burn.phase.code();
            f.int("guidance", "burn.phase", phase);
            f.int("guidance", "burn.at", at);
            f.int("guidance", "burn.spent", i64::from(burn.spent));
            f.vector("guidance", ["burn.to_gain.x", "burn.to_gain.y", "burn.to_gain.z"], burn.to_gain);
            f.vector("guidance", ["burn.aim.x", "burn.aim.y", "burn.aim.z"], burn.aim);
        }
        f.0
    }

    /// One hash for each of [`SUBSYSTEMS`], of the exact bits of its fields.
    pub fn state_hash(&self) -> [(&'static str, u64); SUBSYSTEMS.len()] {
        let fields = self.fields();
        SUBSYSTEMS.map(|subsystem| {
            let mut hasher = blake3::Hasher::new();
            for (_, name, bits) in fields.iter().filter(|f| f.0 == subsystem) {
                hasher.update(name.as_bytes());
                hasher.update(&bits.to_le_bytes());
            }
            let mut head = [0; 8];
            head.copy_from_slice(&hasher.finalize().as_bytes()[..8]);
            (subsystem, u64::from_le_bytes(head))
        })
    }
}
