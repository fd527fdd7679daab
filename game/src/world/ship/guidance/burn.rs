//! Flying a planned burn: the ship coasts, turns in time, begins half a burn before the node, and cuts off exactly.
//!
//! What is still to be gained is kept as a vector in inertial axes, from which each tick's push is taken off, whoever gives it:
//! a pilot who flies a burn by hand sees the same vector shrink. The last tick of the main engine is throttled so that it gives
//! what is left along the nose; RCS gives the rest. A burn is an impulse in the plan; what gravity does to a long one meanwhile
//! is the pilot's to mend (stated simplification).

use super::super::attitude::{self, Demand};
use super::super::flight::Controls;
use super::super::local::Local;
use super::super::nodes::axes;
use super::super::{Rigid, Ship};
use super::plan::{lead_s, ticks};
use crate::command::{Guidance, Hold, Node};
use engine::orbit::State;
use engine::space::{Centred, Position, Velocity};
use engine::time::{SimTime, TICK_S};
use engine::units::MINUTE;
use glam::DVec3;

/// Before its start and after its end by so much, a push still counts as part of the burn, s.
const WINDOW_S: f64 = MINUTE;
/// Cosine of the angle between nose and burn from which on the engine runs.
const READY: f64 = 0.999_5;
/// Below this the direction of what is left is noise: the nose stays where it is, m/s.
const STEADY_M_S: f64 = 1.0;
/// What is left when a burn is done, m/s.
const DONE_M_S: f64 = 1.0e-4;
/// What a pilot may leave, m/s.
const DONE_BY_HAND_M_S: f64 = 0.2;

/// Where a burn stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Coasting.
    Wait {
        /// When the ship turns for it.
        turn: SimTime,
    },
    /// Turning, and waiting for the start.
    Turn,
    /// The main engine.
    Burn,
    /// The rest, by RCS.
    Trim,
}

impl Stage {
    /// One line for the pilot.
    pub const fn describe(self) -> &'static str {
        match self {
            Self::Wait { .. } => "Coasting to the planned burn",
            Self::Turn => "Turning for the planned burn",
            Self::Burn => "Planned burn",
            Self::Trim => "Trimming the planned burn",
        }
    }
    /// As numbers, for hashes: which, and when.
    pub const fn code(self) -> (i64, i64) {
        match self {
            Self::Wait { turn } => (0, turn.ticks),
            Self::Turn => (1, 0),
            Self::Burn => (2, 0),
            Self::Trim => (3, 0),
        }
    }
}

/// The next planned burn as it is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Burn {
    /// What is still to be gained, ICRF axes, m/s.
    pub to_gain: DVec3,
    /// Where the nose points for it: a unit vector.
    pub aim: DVec3,
    /// A part of it has been flown: it is not planned anew.
    pub spent: bool,
    /// Where the autopilot stands with it.
    pub phase: Stage,
}

impl Burn {
    /// The tick that the autopilot waits for, if it waits.
    pub fn wake(&self) -> Option<SimTime> {
        match self.phase {
            Stage::Wait { turn } => Some(turn),
            _ => None,
        }
    }

    /// Points the nose along the burn, by the smallest turn.
    pub fn point(&self, rigid: &Rigid) -> Demand {
        let q = rigid.icrf_from_hull.0;
        let reference = (attitude::arc(q * DVec3::NEG_Z, self.aim, q * DVec3::X) * q).normalize();
        Demand::Point { reference, rate: DVec3::ZERO }
    }

    /// The first planned burn of a ship in `local`; none where there is none, or where its time has passed.
    fn plan(ship: &Ship, local: &Local) -> Option<Self> {
        let node = ship.nodes.first()?;
        if node.size_m_s() <= 0.0 || local.time > window(ship, node).1 {
            return None;
        }
        let state = State::<Centred> { position: Position::new(local.r), velocity: Velocity::new(local.v) };
        let (_, there) = local.system.ahead(local.id, &state, local.time, node.at, ship.light_m3_s2(local.system));
        let to_gain = node.dv(&there);
        let turn = ship.burn_start(node).plus(-ticks(lead_s(ship))).max(local.time.plus(1));
        Some(Self { to_gain, aim: to_gain.normalize_or(axes(&there)[0]), spent: false, phase: Stage::Wait { turn } })
    }
}

/// From when to when a push counts as part of a burn.
fn window(ship: &Ship, node: &Node) -> (SimTime, SimTime) {
    let size = node.size_m_s();
    (ship.burn_start(node).plus(-ticks(WINDOW_S)), node.at.plus(ticks(ship.burn_s(size) + WINDOW_S)))
}

/// Plans the next burn where something asks for its direction.
pub fn ensure(ship: &mut Ship, local: &Local) {
    if ship.burn.is_none() && (ship.hold == Hold::Node || ship.guidance == Guidance::Node) {
        ship.burn = Burn::plan(ship, local);
    }
}

/// Takes off the burn what a tick's `force` (ICRF axes, N) at a flow of propellant (kg/s) gives. Outside of its time a push
/// changes the path, and the burn is planned anew.
pub fn spend(ship: &mut Ship, local: &Local, force: DVec3, flow_kg_s: f64) {
    let Some(node) = ship.nodes.first().filter(|_| flow_kg_s > 0.0) else { return };
    let (from, to) = window(ship, node);
    if local.time < from || local.time > to {
        ship.burn = ship.burn.filter(|b| b.spent);
        return;
    }
    let Some(mut burn) = ship.burn.or_else(|| Burn::plan(ship, local)) else { return };
    let before = burn.to_gain.length();
    burn.to_gain -= force * (-libm::log1p(-flow_kg_s * TICK_S / ship.mass_kg()) / flow_kg_s);
    burn.spent = true;
    let left = burn.to_gain.length();
    if left > STEADY_M_S {
        burn.aim = burn.to_gain / left;
    }
    ship.burn = Some(burn);
    let passed_by = left > before && left < STEADY_M_S.max(0.02 * node.size_m_s());
    if ship.guidance != Guidance::Node && (left < DONE_BY_HAND_M_S || passed_by) {
        done(ship);
    }
}

/// The first planned burn has been flown.
fn done(ship: &mut Ship) {
    if !ship.nodes.is_empty() {
        ship.nodes.remove(0);
    }
    ship.burn = None;
    if ship.hold == Hold::Node {
        (ship.hold, ship.held) = (Hold::Rate, None);
    }
}

/// The controls of a tick under [`Guidance::Node`].
pub fn controls(ship: &mut Ship, local: &Local, rigid: &Rigid) -> Controls {
    let nothing = Controls { demand: Demand::Rate(DVec3::ZERO), throttle: 0.0, nozzle: 0.0, translation: DVec3::ZERO };
    let (Some(mut burn), Some(node)) = (ship.burn, ship.nodes.first().copied()) else {
        return give_back(ship, nothing);
    };
    let q = rigid.icrf_from_hull.0;
    let mass = ship.mass_kg();
    let engine = &ship.spec.main_engine;
    let left = burn.to_gain.dot(q * DVec3::NEG_Z);
    // The throttle that gives what is left along the nose in one tick.
    let last = -libm::expm1(-left / engine.exhaust_velocity_m_s) * mass * engine.exhaust_velocity_m_s / (engine.thrust_n * TICK_S);
    let little = STEADY_M_S.max(2.0 * engine.thrust_n * TICK_S / mass);
    burn.phase = match burn.phase {
        Stage::Wait { turn } if local.time < turn => {
            ship.burn = Some(burn);
            return nothing;
        }
        Stage::Wait { .. } | Stage::Turn if !burn.spent && local.time < ship.burn_start(&node) => Stage::Turn,
        Stage::Wait { .. } | Stage::Turn | Stage::Burn if burn.spent && last < 1.0e-3 && burn.to_gain.length() < little => Stage::Trim,
        Stage::Wait { .. } | Stage::Turn | Stage::Burn => Stage::Burn,
        Stage::Trim => Stage::Trim,
    };
    ship.burn = Some(burn);
    let demand = burn.point(rigid);
    match burn.phase {
        Stage::Burn if ship.propellant_kg <= 0.0 => give_back(ship, nothing),
        Stage::Burn => {
            let ready = (q * DVec3::NEG_Z).dot(burn.aim) > READY && ship.nozzle <= 0.0;
            Controls { demand, throttle: if ready { last.clamp(0.0, 1.0) } else { 0.0 }, ..nothing }
        }
        Stage::Trim => {
            let rest = q.conjugate() * burn.to_gain;
            let full = ship.spec.rcs.thrust_n * TICK_S / mass;
            // What RCS cannot give within seconds is left to the pilot.
            if burn.to_gain.length() < DONE_M_S || full * 600.0 < burn.to_gain.length() || ship.propellant_kg <= 0.0 {
                done(ship);
                return give_back(ship, nothing);
            }
            Controls { demand, translation: (rest / full).clamp(DVec3::NEG_ONE, DVec3::ONE), ..nothing }
        }
        Stage::Wait { .. } | Stage::Turn => Controls { demand, ..nothing },
    }
}

/// The pilot has it again.
fn give_back(ship: &mut Ship, nothing: Controls) -> Controls {
    ship.guidance = Guidance::Manual;
    (ship.hold, ship.held) = (if ship.hold == Hold::Node { Hold::Rate } else { ship.hold }, None);
    ship.throttle = 0;
    nothing
}

#[cfg(test)]
mod tests;
