//! The automatic landing.
use super::super::flight::Controls;
use super::super::local::Local;
use super::super::{Rigid, Ship};
use crate::command::Target;
use engine::orbit::BodyId;
use engine::time::SimTime;
use glam::DVec3;

/// Where a landing stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Coasting to the deorbit burn.
    Wait {
        /// When it begins.
        burn: SimTime,
    },
    /// The deorbit burn (with change of plane).
    Burn,
    /// Coasting down to the braking burn.
    Approach {
        /// When the ship turns for it.
        brake: SimTime,
    },
    /// Braking towards the gate above the spot.
    Brake,
    /// Down from the gate.
    Descend,
}

impl Phase {
    /// One line for the pilot.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Wait { .. } => "Coasting to the deorbit burn",
            Self::Burn => "Deorbit burn",
            Self::Approach { .. } => "Coasting down to the braking burn",
            Self::Brake => "Braking towards the spot",
            Self::Descend => "Descending to the spot",
        }
    }
}

/// A landing programme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// The body.
    pub body: BodyId,
    /// Unit direction of the spot in the body's turning axes.
    pub spot: DVec3,
    /// Height of the ground there above the datum, m.
    pub ground_m: f64,
    /// Altitude of the gate above the datum, m: over the spot, above mountains and thick air.
    pub gate_m: f64,
    /// Where it stands.
    pub phase: Phase,
}

impl Landing {
    /// True while the programme has nothing to do before a planned tick.
    pub fn coasts(&self) -> bool {
        matches!(self.phase, Phase::Wait { .. } | Phase::Approach { .. })
    }
    /// The tick that it waits for, if it waits.
    pub fn wake(&self) -> Option<SimTime> {
        match self.phase {
            Phase::Wait { burn } => Some(burn),
            Phase::Approach { brake } => Some(brake),
            _ => None,
        }
    }
}

/// The controls of a tick.
pub fn controls(ship: &mut Ship, local: &Local, rigid: &Rigid, _target: Option<Target>) -> Controls {
    super::fly_along(ship, local, rigid, -super::weight(local), 0.5, 0.0)
}
