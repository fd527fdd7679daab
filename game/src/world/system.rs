//! The system: which bodies exist, how big they are, how they turn, what covers them. Built from validated assets.

use engine::air::Medium;
use engine::air::density::Column;
use engine::orbit::ephemeris::Ephemeris;
use engine::orbit::rotation::Spin;
use engine::orbit::{BodyId, State, kepler};
use engine::space::Centred;
use engine::terrain::Relief;
use engine::time::SimTime;
use glam::Vec3;
use std::sync::Arc;

/// The air of a body: what drags (`column`) and what one sees (`medium`), described apart.
#[derive(Clone, Debug)]
pub struct Air {
    /// Temperature, pressure and density against altitude.
    pub column: Column,
    /// Optical layers.
    pub medium: Medium,
}

/// A body of the system.
#[derive(Clone, Debug)]
pub struct Body {
    /// Folder name: `earth`.
    pub key: String,
    /// Display name: `Earth`.
    pub name: String,
    /// What it orbits; `None` for the star.
    pub parent: Option<BodyId>,
    /// Gravitational parameter, m³/s².
    pub gm_m3_s2: f64,
    /// Radius of the datum sphere, m.
    pub radius_m: f64,
    /// Radius of the sphere of influence, m (Laplace: a(m/M)^(2/5)); infinite for the star.
    pub soi_radius_m: f64,
    /// Pole and prime meridian.
    pub spin: Spin,
    /// Mean surface albedo, linear sRGB.
    pub albedo: Vec3,
    /// Luminous intensity, cd per linear sRGB channel; zero for all but stars.
    pub intensity_cd: Vec3,
    /// Its air, if any.
    pub air: Option<Air>,
    /// Its ground; `None` for the star and the giants (a ship sinks and is crushed: see `ship::contact`).
    pub relief: Option<Arc<Relief>>,
    /// Largest factor by which relief is exaggerated from afar (1 = never).
    pub relief_max: f64,
}

/// A planetary system.
#[derive(Clone, Debug)]
pub struct System {
    /// Folder name: `sol`.
    pub key: String,
    /// Display name.
    pub name: String,
    /// Bodies; the star is first, and a parent always stands before its moons.
    pub bodies: Vec<Body>,
    /// Where they are.
    pub ephemeris: Ephemeris,
    /// blake3 of the asset files that the World depends on, hex; a replay refuses others.
    pub hash: String,
}

impl System {
    /// The body behind a handle.
    pub fn body(&self, id: BodyId) -> &Body {
        &self.bodies[id.index()]
    }
    /// Where a ship that coasts from a state about `host` at `from` will be: the body that dominates there, and the state about it.
    pub fn ahead(&self, host: BodyId, state: &State<Centred>, from: SimTime, to: SimTime) -> (BodyId, State<Centred>) {
        (host, kepler::propagate(self.body(host).gm_m3_s2, state, to.since(from)))
    }

    /// The handle of a key.
    #[allow(clippy::cast_possible_truncation)]
    pub fn find(&self, key: &str) -> Option<BodyId> {
        self.bodies.iter().position(|b| b.key == key).map(|i| BodyId(i as u16))
    }
}
