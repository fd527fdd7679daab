//! The system: which bodies exist, how big they are, how they turn, what covers them. Built from validated assets.

use super::eclipse::almanac::Almanac;
use super::ship::local::air_top_m;
use super::ship::warp::floor_m;
use engine::air::{Air, Column};
use engine::light::exposure::LUMINANCE;
use engine::light::spectrum::Starlight;
use engine::orbit::eclipse::Shape;
use engine::orbit::ephemeris::Ephemeris;
use engine::orbit::field::{Bound, Source};
use engine::orbit::gravity::figure::Figure;
use engine::orbit::path::{self, End, Knot, Model, Path, Setting};
use engine::orbit::rotation::Spin;
use engine::orbit::{BodyId, State, kepler};
use engine::space::Centred;
use engine::terrain::Relief;
use engine::time::SimTime;
use engine::units::SPEED_OF_LIGHT;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Luminous efficacy of the Sun's light above the air, lm/W: 1.28e5 lx of 1361 W/m².
const SUN_LM_W: f64 = 94.04;

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
    /// Its shape where shadows are counted (the ground and the picture use the datum sphere).
    pub shape: Shape,
    /// How its gravity differs from a point's; ships feel its zonal terms.
    pub figure: Option<Figure>,
    /// Mean surface albedo, linear sRGB.
    pub albedo: Vec3,
    /// Luminous intensity, cd per linear sRGB channel; zero for all but stars.
    pub intensity_cd: Vec3,
    /// Its air as it drags, if any: temperature, pressure and density against altitude.
    pub air: Option<Column>,
    /// Its air as it looks, if any. Nothing in the World reads it, so that its colours are no part of a flight.
    pub look: Option<Air>,
    /// Banks of fog and nebulae that turn with it; looks too.
    pub fog: Vec<Fog>,
    /// Its ground; `None` for the star and the giants (a ship sinks and is crushed: see `ship::contact`).
    pub relief: Option<Arc<Relief>>,
    /// Largest factor by which relief is exaggerated from afar (1 = never).
    pub relief_max: f64,
}

/// A ball of fog, or a nebula.
#[derive(Clone, Debug, PartialEq)]
pub struct Fog {
    /// Centre, m from the body's, in its turning frame.
    pub centre_m: DVec3,
    /// What it is: its top altitude is its radius.
    pub air: Air,
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
    /// Force of the star's light on a black square metre times the square of its distance, N: as much per candela as the Sun's.
    pub light_n: f64,
    /// Spectrum of the star's light, by which airs are read anew.
    pub starlight: Starlight,
    /// How they attract a ship, and where one changes from one to the other.
    pub gravity: Model,
    /// blake3 of the asset files that the World depends on, hex; a replay refuses others.
    pub hash: String,
    /// The same without the air: what stays when only airs are read anew.
    pub solid_hash: String,
    /// What its files hold that can be used and is hardly meant, for people to read.
    pub warnings: Vec<String>,
    /// What is known of its eclipses so far.
    pub eclipses: Almanac,
}

impl System {
    /// A system of these bodies (in the order of the ephemeris).
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(key: String, name: String, bodies: Vec<Body>, ephemeris: Ephemeris, hash: String) -> Self {
        let as_met = |(i, b): (usize, &Body)| {
            let (reference_radius_m, zonal) = b.figure.as_ref().map_or((0.0, [0.0; 3]), |f| (f.radius_m, f.zonal));
            let reach = ephemeris.reach(BodyId(i as u16));
            path::Body {
                source: Source { parent: b.parent, reach, gm_m3_s2: b.gm_m3_s2, reference_radius_m, zonal },
                spin: b.spin.clone(),
                soi_m: b.soi_radius_m,
                low_m: b.radius_m + floor_m(b),
                radius_m: b.radius_m,
                air_top_m: if b.air.is_some() { b.radius_m + air_top_m(b) } else { 0.0 },
            }
        };
        let gravity = Model::new(bodies.iter().enumerate().map(as_met).collect(), Bound::COAST);
        let light_n = bodies.first().map_or(0.0, |star| f64::from(star.intensity_cd.dot(LUMINANCE)) / SUN_LM_W / SPEED_OF_LIGHT);
        Self {
            key,
            name,
            bodies,
            ephemeris,
            light_n,
            starlight: Starlight::default(),
            gravity,
            hash,
            solid_hash: String::new(),
            warnings: Vec::new(),
            eclipses: Almanac::default(),
        }
    }

    /// The same with another look of a body's air, and other banks of fog.
    #[must_use]
    pub fn with_look(&self, body: BodyId, look: Option<Air>, fog: Vec<Fog>) -> Self {
        let mut new = self.clone();
        if let Some(body) = new.bodies.get_mut(body.index()) {
            (body.look, body.fog) = (look, fog);
        }
        new
    }

    /// The body behind a handle.
    pub fn body(&self, id: BodyId) -> &Body {
        &self.bodies[id.index()]
    }
    /// Where a ship that coasts from a state about `host` at `from` will be: the body that dominates there, and the state about it.
    /// Before `from`, and beyond the ground, the state from which there is no further. `light_m3_s2`: see [`Setting`].
    pub fn ahead(&self, host: BodyId, state: &State<Centred>, from: SimTime, to: SimTime, light_m3_s2: f64) -> (BodyId, State<Centred>) {
        if to <= from {
            return (host, kepler::propagate(self.body(host).gm_m3_s2, state, to.since(from)));
        }
        let knot = Knot::new(host, from, state);
        let setting = Setting { to_ground: true, light_m3_s2, ..Setting::default() };
        let mut path = Path::with(&self.gravity, &self.ephemeris, knot, setting);
        while let Some(event) = path.advance(&self.gravity, &self.ephemeris, to) {
            if event.end == End::Low {
                return (path.host(), path.step().sample(event.at));
            }
        }
        (path.host(), path.sample(to))
    }

    /// The handle of a key.
    #[allow(clippy::cast_possible_truncation)]
    pub fn find(&self, key: &str) -> Option<BodyId> {
        self.bodies.iter().position(|b| b.key == key).map(|i| BodyId(i as u16))
    }
}
