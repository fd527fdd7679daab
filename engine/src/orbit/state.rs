//! A state: position and velocity in one frame; and the handle of a body.

use crate::space::{Frame, Position, Velocity};
use serde::{Deserialize, Serialize};

/// Index of a body in its system, in the order in which the system lists them; 0 is the star.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BodyId(pub u16);

impl BodyId {
    /// As an index into the system's list.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Position (m) and velocity (m/s) in frame `F`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<F: Frame> {
    /// Metres from the origin of `F`.
    pub position: Position<F>,
    /// Metres per second.
    pub velocity: Velocity<F>,
}

impl<F: Frame> Default for State<F> {
    fn default() -> Self {
        Self { position: Position::ZERO, velocity: Velocity::ZERO }
    }
}
