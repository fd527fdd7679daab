//! The ephemeris: position and velocity of body B at time t. This interface is deliberately narrow: what stands behind it
//! (Kepler orbits now) may be replaced without any caller noticing.

use super::{BodyId, State};
use crate::space::Icrf;
use crate::time::SimTime;

/// Where every body of a system is, at any time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ephemeris {}

impl Ephemeris {
    /// Barycentric state of `body` at `t`, ICRF axes, m and m/s.
    pub fn state(&self, body: BodyId, t: SimTime) -> State<Icrf> {
        let _ = (body, t);
        State::default()
    }
}
