//! An arc: the path of a coasting ship, from an epoch on. It is sampled, never stepped, so the bits of a sample depend on
//! the epoch and the tick alone, not on warp, frame rate or how often it was looked at.


use super::{BodyId, State, kepler};
use crate::space::Centred;
use crate::time::SimTime;

/// A two-body path about one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// The body at the focus.
    pub body: BodyId,
    /// Its gravitational parameter, m³/s².
    pub gm_m3_s2: f64,
    /// When the arc begins.
    pub epoch: SimTime,
    /// State at the epoch, from the body's centre, inertial axes.
    pub state: State<Centred>,
}

impl Arc {
    /// The state at `t` (which may lie before the epoch).
    pub fn sample(&self, t: SimTime) -> State<Centred> {
        kepler::propagate(self.gm_m3_s2, &self.state, t.since(self.epoch))
    }

    /// Distance from the body's centre at `t`, m.
    pub fn radius_m(&self, t: SimTime) -> f64 {
        self.sample(t).position.length()
    }
}
