//! A course: where a ship would be if it coasted from now on, sampled at rising times. For whoever plans.

use crate::world::system::System;
use engine::orbit::path::{Knot, Path, Setting};
use engine::orbit::{BodyId, State};
use engine::space::Centred;
use engine::time::SimTime;

/// A path that is followed ahead, down to the datum.
pub struct Course<'a> {
    system: &'a System,
    path: Path,
    body: BodyId,
}

impl<'a> Course<'a> {
    /// From a state about `body` at `time`, for hours at most: the push of light is left out.
    pub fn new(system: &'a System, time: SimTime, body: BodyId, state: &State<Centred>) -> Self {
        Self::of(system, Knot::new(body, time, state), 0.0)
    }

    /// From a knot of a path, with what light takes off the star's pull, m³/s² ([`Setting`]).
    pub fn of(system: &'a System, knot: Knot, light_m3_s2: f64) -> Self {
        let setting = Setting { to_ground: true, light_m3_s2, ..Setting::default() };
        Self { system, path: Path::with(&system.gravity, &system.ephemeris, knot, setting), body: knot.host }
    }

    /// The state about the same body at `t`, not before the last that was asked for; none once the ground is met or another body
    /// dominates.
    pub fn at(&mut self, t: SimTime) -> Option<State<Centred>> {
        if self.path.advance(&self.system.gravity, &self.system.ephemeris, t).is_some() {
            return None;
        }
        (self.path.host() == self.body).then(|| self.path.sample(t))
    }
}
