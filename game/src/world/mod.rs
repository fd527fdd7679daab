//! The World: the simulated truth, f64 and SI, advanced by whole ticks and by nothing but [`Commands`].
//!
//! Read [`World::tick`] for the order of a tick, [`system`] for what exists, [`ship`] for how a ship answers, and
//! [`readout`] for what the World tells. Not here: anything drawn, heard or saved.

pub mod eclipse;
pub mod readout;
pub mod ship;
pub mod system;

use crate::command::Target;
use engine::time::SimTime;
use ship::Ship;
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
}
