//! The ship's surroundings at one instant: zenith, altitude, air, speed over the ground. Computed once and passed down.

use crate::world::system::{Body, System};
use engine::air::density::Sample;
use engine::orbit::gravity::point_mass;
use engine::orbit::gravity::zonal::zonal;
use engine::orbit::{BodyId, State};
use engine::space::{Centred, Fixed, Icrf, Position, Rotation, Vector};
use engine::time::SimTime;
use glam::DVec3;

/// What is around a point that moves about a body. Vectors are in ICRF axes.
#[derive(Clone, Copy, Debug)]
pub struct Local<'a> {
    /// What exists.
    pub system: &'a System,
    /// Now.
    pub time: SimTime,
    /// The dominating body's handle.
    pub id: BodyId,
    /// The dominating body.
    pub body: &'a Body,
    /// Position from the body's centre, m.
    pub r: DVec3,
    /// Inertial velocity, m/s.
    pub v: DVec3,
    /// Zenith.
    pub up: DVec3,
    /// Altitude above the datum, m.
    pub altitude_m: f64,
    /// Angular velocity of the body, rad/s.
    pub spin: DVec3,
    /// Velocity over the turning ground (and through the air, which turns with it), m/s.
    pub v_surface: DVec3,
    /// The body's axes.
    pub icrf_from_fixed: Rotation<Icrf, Fixed>,
    /// Air here; all zero where there is none.
    pub air: Sample,
}

impl<'a> Local<'a> {
    /// The surroundings of `state` about body `id` at `time`.
    pub fn new(system: &'a System, time: SimTime, id: BodyId, state: &State<Centred>) -> Self {
        let body = system.body(id);
        let (r, v) = (state.position.0, state.velocity.0);
        // The axes once; the turning is about their pole.
        let icrf_from_fixed = body.spin.icrf_from_fixed(time);
        let spin = icrf_from_fixed.vector(Vector::xyz(0.0, 0.0, body.spin.rate_rad_s())).0;
        let altitude_m = r.length() - body.radius_m;
        Self {
            system,
            time,
            id,
            body,
            r,
            v,
            up: r.normalize_or(DVec3::Z),
            altitude_m,
            spin,
            v_surface: v - spin.cross(r),
            icrf_from_fixed,
            air: body.air.as_ref().map(|a| a.at(altitude_m)).unwrap_or_default(),
        }
    }
    /// Unit direction in the body's turning axes.
    pub fn direction_fixed(&self) -> DVec3 {
        self.icrf_from_fixed.inverse().raw(self.up)
    }
    /// Height of the ground (or water) below, above the datum, m.
    pub fn ground_m(&self) -> f64 {
        ground_m(self.body, self.direction_fixed())
    }
    /// Acceleration by the body's gravity, flattened as it is, m/s².
    pub fn gravity(&self) -> DVec3 {
        pull(self.body, self.icrf_from_fixed.raw(DVec3::Z), self.r)
    }
    /// Rate of climb, m/s.
    pub fn vertical_m_s(&self) -> f64 {
        self.v.dot(self.up)
    }
    /// Dynamic pressure, Pa.
    pub fn dynamic_pressure_pa(&self) -> f64 {
        0.5 * self.air.density_kg_m3 * self.v_surface.length_squared()
    }
}

/// Acceleration at `r` from a body's centre by its gravity with its zonal terms, m/s²; zero at the centre itself. `pole` is the
/// unit vector of its pole in the axes of `r`.
pub fn pull(body: &Body, pole: DVec3, r: DVec3) -> DVec3 {
    let (gm, at) = (body.gm_m3_s2, Position::<Centred>::new(r));
    let flat = body.figure.as_ref().map_or(DVec3::ZERO, |f| zonal(gm, f.zonal, f.radius_m, pole, at).0);
    point_mass(gm, at).0 + flat
}

/// Height of what one stands or splashes on, above the datum, m; 0 for a body without ground.
pub fn ground_m(body: &Body, direction_fixed: DVec3) -> f64 {
    body.relief.as_ref().map_or(0.0, |relief| relief.surface_m(direction_fixed))
}

/// Altitude above which air does not act, m; 0 for an airless body.
pub fn air_top_m(body: &Body) -> f64 {
    body.air.as_ref().map_or(0.0, |a| a.top_m)
}
