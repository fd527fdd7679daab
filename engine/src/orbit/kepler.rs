//! Kepler's problem: the state of a two-body orbit after a time, for every conic, in universal variables.
//!
//! One equation serves circle, ellipse, parabola, hyperbola and radial fall. With β = 2μ/r₀ − v₀², η₀ = r₀·v₀ and the
//! universal anomaly s (ds = dt/r), Kepler's equation reads `r₀G₁ + η₀G₂ + μG₃ = Δt` [Wisdom & Hernandez 2015, eq. 12].
//! The result is the exact orbit's, rounded once, for every eccentricity and time: what cancels is carried to 79 bits.
//!
//! Read `conic` (scaling by powers of two, the state after a time), `orbit` (the constants of an orbit), `guess` (where the
//! root is sought), `solve` (the root and the state there), `universal` (G₀…G₃), `pair` (numbers of 79 bits), `real` (one
//! number or a register of them), [`batch`] (many orbits at once, the same bits).
//! Not here: perturbations (see `integrate`), orbits as numbers for people (see `elements`).
//!
//! - [Wisdom & Hernandez 2015] "Fast and accurate solution of Kepler's problem for planetary motion", MNRAS 453, 3015.

pub mod batch;
mod conic;
mod guess;
mod orbit;
mod pair;
mod real;
mod solve;
mod universal;

pub use conic::Conic;
pub(crate) use universal::Universal;

use super::State;
use crate::space::{Frame, Position, Velocity};
use conic::Scaled;
use glam::DVec3;

/// State after `dt_s` seconds of two-body motion about a point of gravitational parameter `gm` (m³/s²).
///
/// Any finite `dt_s`; whole revolutions are taken off first (beyond 2e15 of them no digit of the phase is left, and the state
/// is any on the orbit). Where there is no centre to fall to (`gm ≤ 0`, or a position at the origin) the motion is a straight
/// line, as it is beyond 1e140 times r/v on an open orbit. A radial fall goes through the centre and comes back where it came
/// from. No finite input makes NaN; one that is not finite gives the straight line's sum, whatever that is.
pub fn propagate<F: Frame>(gm: f64, state: &State<F>, dt_s: f64) -> State<F> {
    let (r, v) = propagate_raw(gm, state.position.0, state.velocity.0, dt_s);
    State { position: Position::new(r), velocity: Velocity::new(v) }
}

/// As [`propagate`], for callers that keep their own frame.
pub fn propagate_raw(gm: f64, r0: DVec3, v0: DVec3, dt_s: f64) -> (DVec3, DVec3) {
    let scaled = Scaled::new(gm, r0, v0);
    scaled.after(dt_s, || scaled.orbit.turn(), || scaled.orbit.pericentre())
}

#[cfg(test)]
mod tests;
