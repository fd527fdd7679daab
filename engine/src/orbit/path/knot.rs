//! Knot: a place on a path from which it goes on with the same bits: body, moment, and the state to two words.
//!
//! A save of a coasting ship is a knot. Not here: how it goes on ([`super::step`]).

use super::twofold::Twofold;
use crate::orbit::{BodyId, State};
use crate::space::{Centred, Position, Velocity};
use crate::time::Moment;
use glam::DVec3;

/// Where a step of a path begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot {
    /// The body that the state is written about.
    pub host: BodyId,
    /// When.
    pub at: Moment,
    /// From the host's centre, ICRF axes, m.
    pub position: Twofold,
    /// m/s.
    pub velocity: Twofold,
}

impl Knot {
    /// From a state to one word.
    pub fn new(host: BodyId, at: impl Into<Moment>, state: &State<Centred>) -> Self {
        Self { host, at: at.into(), position: state.position.0.into(), velocity: state.velocity.0.into() }
    }

    /// The state, to one word.
    pub fn state(&self) -> State<Centred> {
        State { position: Position::new(self.position.value()), velocity: Velocity::new(self.velocity.value()) }
    }

    /// The same with another velocity: an impulse, m/s.
    pub fn kicked(self, dv: DVec3) -> Self {
        Self { velocity: self.velocity.plus(dv.into()), ..self }
    }

    /// Written about another body, which the present host is seen from in state `host_from_new`.
    pub fn about(self, new: BodyId, host_from_new: (DVec3, DVec3)) -> Self {
        Self {
            host: new,
            position: self.position.plus(host_from_new.0.into()),
            velocity: self.velocity.plus(host_from_new.1.into()),
            ..self
        }
    }
}
