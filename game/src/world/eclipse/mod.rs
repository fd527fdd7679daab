//! Eclipses: who can hide the star from whom, now. The geometry of a disc behind a disc is `engine::light`; choosing the
//! casters, and naming the event, is ours.
//!
//! Read [`almanac`] for eclipses ahead of time and [`visit`] for beginning a flight at one.

pub mod almanac;
#[cfg(test)]
mod tests;
pub mod visit;

use super::system::System;
use engine::orbit::{BodyId, State};
use engine::space::{Fixed, Icrf, Position, Rotation};
use engine::time::SimTime;
use glam::DQuat;

/// Where every body is at one instant: one sweep of the ephemeris, shared by all who ask.
#[derive(Clone, Debug)]
pub struct Sky {
    /// When: the last whole tick.
    pub time: SimTime,
    /// Seconds beyond that tick, for pictures between ticks.
    pub beyond_s: f64,
    /// Barycentric states, in the system's order.
    pub states: Vec<State<Icrf>>,
}

impl Sky {
    /// All bodies at `time`.
    pub fn at(system: &System, time: SimTime) -> Self {
        Self::between(system, time, 0.0)
    }

    /// All bodies `beyond_s` seconds after `time`, along their velocity; for a fraction of a tick (error ½ a s²: under 1 µm).
    #[allow(clippy::cast_possible_truncation)]
    pub fn between(system: &System, time: SimTime, beyond_s: f64) -> Self {
        let states = (0..system.bodies.len())
            .map(|i| {
                let state = system.ephemeris.state(BodyId(i as u16), time);
                State { position: state.position + state.velocity.over(beyond_s), ..state }
            })
            .collect();
        Self { time, beyond_s, states }
    }

    /// A body's axes.
    pub fn axes(&self, system: &System, body: BodyId) -> Rotation<Icrf, Fixed> {
        let spin = &system.body(body).spin;
        let at_tick = spin.icrf_from_fixed(self.time);
        let turn = spin.angular_velocity(self.time).0 * self.beyond_s;
        Rotation::new(DQuat::from_scaled_axis(turn) * at_tick.0)
    }

    /// Barycentric position of a body.
    pub fn position(&self, body: BodyId) -> Position<Icrf> {
        self.states[body.index()].position
    }
}

/// Bodies whose penumbra touches a sphere of `radius_m` about `centre`; `but` (the sphere's own body) is left out.
///
/// With the star of radius `s` at distance `D` from the caster of radius `c`, the penumbra at a distance `d` behind the
/// caster has the radius `c + d (s + c)/D` [Meeus, Astronomical Algorithms, ch. 54].
#[allow(clippy::cast_possible_truncation)]
pub fn casters(system: &System, sky: &Sky, centre: Position<Icrf>, radius_m: f64, but: Option<BodyId>) -> Vec<BodyId> {
    let star = &system.bodies[0];
    let star_centre = sky.position(BodyId(0));
    let mut found = Vec::new();
    for (index, body) in system.bodies.iter().enumerate().skip(1) {
        let id = BodyId(index as u16);
        if Some(id) == but {
            continue;
        }
        let from_star = sky.position(id) - star_centre;
        let caster_distance = from_star.length();
        if caster_distance <= body.radius_m {
            continue;
        }
        let axis = from_star.0 / caster_distance;
        let to_receiver = (centre - sky.position(id)).0;
        let behind = to_receiver.dot(axis);
        if behind < -radius_m - body.radius_m {
            continue;
        }
        let aside = (to_receiver - axis * behind).length();
        let penumbra = body.radius_m + behind.max(0.0) * (star.radius_m + body.radius_m) / caster_distance;
        if aside < penumbra + radius_m {
            found.push(id);
        }
    }
    found
}
