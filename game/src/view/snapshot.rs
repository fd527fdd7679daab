//! The snapshot of a World: what a frame is drawn from. f64 becomes f32 here, once, through `engine::space::relative`.
//!
//! Positions are taken from the host's centre first, so that the ground under the ship is exact to f64 at 6,000 km
//! (1 nm) and not to f64 at one astronomical unit (30 µm).

use super::fog;
use super::rig::{CameraMode, Eye, Mount, Rig};
use crate::command::{WARP_ONE, WARP_QUARTERS};
use crate::world::World;
use crate::world::eclipse::{self, Sky};
use crate::world::ship::Rigid;
use crate::world::system::{self, System};
use engine::orbit::{BodyId, State};
use engine::render::pass::smooth_body::POINT_BELOW_PX;
use engine::scene::{Body, Camera, Force, Occluder, Ship, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3, rotation};
use engine::space::{Fixed, Icrf, Position, Rotation};
use engine::terrain::{Relief, TileSet, View, select};
use engine::time::TICK_S;
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// Nearest thing that can be seen, m.
const NEAR_M: f32 = 0.1;
/// Bodies whose disc has a radius of fewer pixels than this are drawn smooth, without tiles.
const TILES_FROM_PX: f64 = 6.0;

/// How far the drawn ground may depart from the true one, pixels.
const TILE_ERROR_PX: f64 = 1.0;

/// What the picture asks for, beyond the World and the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picture {
    /// Size, pixels.
    pub size_px: [u32; 2],
    /// Fraction of a tick since the World's last one, 0 … 1.
    pub alpha: f64,
    /// Seconds since the last picture by the viewer's clock; none for a still.
    pub adapt_s: Option<f32>,
    /// Passes to force.
    pub force: Force,
}

/// What a frame of this World is drawn from, and the eye it was taken with.
pub fn snapshot(world: &World, rig: &Rig, picture: &Picture) -> (Snapshot, Eye) {
    // Between ticks everything moves on along its velocity; at high warp a tick is too long for that, and is shown as it is.
    let rate = f64::from(WARP_QUARTERS[usize::from(world.warp)]) / 4.0;
    let beyond_s = if world.warp <= WARP_ONE { picture.alpha.clamp(0.0, 1.0) * TICK_S * rate } else { 0.0 };
    let sky = Sky::between(&world.system, world.time, beyond_s);
    let rigid = moved_on(world, beyond_s);
    let mount =
        Mount { system: &world.system, sky: &sky, host: rigid.body, ship: rigid.state.position, icrf_from_hull: rigid.icrf_from_hull };
    let eye = rig.eye(&mount);
    let camera = Camera {
        view_from_icrf: rotation(eye.view_from_icrf),
        fov_y_rad: narrow(rig.fov_y_rad),
        near_m: NEAR_M,
        size_px: [picture.size_px[0].max(1), picture.size_px[1].max(1)],
    };
    let stage = Stage { system: &world.system, sky: &sky, eye: &eye, camera: &camera };
    let mut bodies: Vec<Body> = (1..world.system.bodies.len()).map(|i| stage.body(id(i))).collect();
    bodies.extend(fog::banks(&stage));
    // A frame holds so many and no more; points of light are drawn without it.
    let point =
        |body: &Body| body.radius_m < POINT_BELOW_PX * camera.pixel_rad() * body.centre_m.length() && body.surface == Surface::Smooth;
    bodies.sort_by(|a, b| point(a).cmp(&point(b)).then(a.centre_m.length().total_cmp(&b.centre_m.length())));
    let ship = ship(world, rig, &stage, &rigid, &bodies);
    let snapshot = Snapshot {
        camera,
        star: stage.star(),
        bodies,
        ships: vec![ship],
        exposure: rig.exposure,
        adapt_s: picture.adapt_s,
        force: picture.force,
    };
    (snapshot, eye)
}

#[allow(clippy::cast_possible_truncation)]
fn id(index: usize) -> BodyId {
    BodyId(index as u16)
}

/// The ship's rigid body `beyond_s` seconds after the last tick.
fn moved_on(world: &World, beyond_s: f64) -> Rigid {
    let now = world.rigid();
    let turn = DQuat::from_scaled_axis(now.rate.0 * beyond_s);
    let state = State { position: now.state.position + now.state.velocity.over(beyond_s), ..now.state };
    Rigid { state, icrf_from_hull: Rotation::new(now.icrf_from_hull.0 * turn), ..now }
}

/// Where everything stands for one picture.
pub(super) struct Stage<'a> {
    pub(super) system: &'a System,
    pub(super) sky: &'a Sky,
    pub(super) eye: &'a Eye,
    pub(super) camera: &'a Camera,
}

impl Stage<'_> {
    /// A point given from a body's centre, from the camera.
    pub(super) fn seen_from_camera(&self, body: BodyId, offset: DVec3) -> DVec3 {
        let centre = if body == self.eye.host { DVec3::ZERO } else { (self.sky.position(body) - self.sky.position(self.eye.host)).0 };
        (centre - self.eye.position.0) + offset
    }

    fn star(&self) -> Star {
        let star = &self.system.bodies[0];
        Star {
            id: 0,
            centre_m: narrow3(self.seen_from_camera(BodyId(0), DVec3::ZERO)),
            radius_m: narrow(star.radius_m),
            intensity_cd: star.intensity_cd,
        }
    }

    /// What may hide the star from a sphere about `centre`; its own body left out.
    pub(super) fn occluders(&self, centre: Position<Icrf>, radius_m: f64, but: Option<BodyId>) -> Vec<Occluder> {
        let occluder = |caster: BodyId| Occluder {
            id: caster.0,
            centre_m: narrow3(self.seen_from_camera(caster, DVec3::ZERO)),
            radius_m: narrow(self.system.body(caster).radius_m),
        };
        eclipse::casters(self.system, self.sky, centre, radius_m, but).into_iter().map(occluder).collect()
    }

    fn body(&self, id: BodyId) -> Body {
        let body = self.system.body(id);
        let centre = self.seen_from_camera(id, DVec3::ZERO);
        let distance = centre.length();
        let up = (-centre).normalize_or(DVec3::Z);
        let star = &self.system.bodies[0];
        let to_star = (self.sky.position(BodyId(0)) - self.sky.position(id)).0;
        let star_distance = to_star.length().max(star.radius_m);
        let radius_px = body.radius_m / distance.max(body.radius_m) / f64::from(self.camera.pixel_rad());
        let icrf_from_fixed = self.sky.axes(self.system, id);
        let surface = match &body.relief {
            Some(relief) if radius_px >= TILES_FROM_PX => {
                Surface::Tiles(tiles(body, relief, -centre, icrf_from_fixed, self.eye, self.camera))
            }
            _ => Surface::Smooth,
        };
        let shell = body.radius_m + body.look.as_ref().map_or(0.0, |a| a.medium.top_altitude_m);
        Body {
            id: id.0,
            centre_m: narrow3(centre),
            radius_m: narrow(body.radius_m),
            icrf_from_fixed: rotation(icrf_from_fixed),
            camera_altitude_m: narrow(distance - body.radius_m),
            camera_up: narrow3(up),
            sun_direction: narrow3(to_star / star_distance),
            sun_angular_radius_rad: narrow(libm::asin((star.radius_m / star_distance).min(1.0))),
            sun_illuminance_lx: star.intensity_cd * narrow(1.0 / (star_distance * star_distance)),
            occluders: self.occluders(self.sky.position(id), shell, Some(id)),
            albedo: body.albedo,
            surface,
            air: body.look.clone(),
        }
    }
}

/// The tiles of one body for this camera, `camera` metres from its centre.
fn tiles(
    body: &system::Body,
    relief: &Arc<Relief>,
    camera: DVec3,
    icrf_from_fixed: Rotation<Icrf, Fixed>,
    eye: &Eye,
    lens: &Camera,
) -> TileSet {
    let fixed_from_icrf = icrf_from_fixed.inverse();
    let tan_y = libm::tan(0.5 * f64::from(lens.fov_y_rad));
    let view = View {
        camera_m: fixed_from_icrf.raw(camera),
        forward: fixed_from_icrf.raw(eye.view_from_icrf.inverse().raw(DVec3::NEG_Z)),
        cone_rad: libm::atan(tan_y * libm::hypot(1.0, f64::from(lens.aspect()))),
        pixel_rad: f64::from(lens.pixel_rad()),
        max_error_px: TILE_ERROR_PX,
        relief_max: body.relief_max,
    };
    select(relief, &view)
}

fn ship(world: &World, rig: &Rig, stage: &Stage<'_>, rigid: &Rigid, bodies: &[Body]) -> Ship {
    let readout = world.readout();
    Ship {
        centre_m: narrow3(stage.seen_from_camera(rigid.body, rigid.state.position.0)),
        icrf_from_hull: rotation(rigid.icrf_from_hull),
        throttle: narrow(readout.throttle),
        gear: if readout.gear_down { 1.0 } else { 0.0 },
        heat: narrow((readout.heat_flux_w_m2 / world.ship.spec.limits.heat_flux_w_m2).min(1.0)),
        host: bodies.iter().position(|b| b.id == rigid.body.0),
        height_above_ground_m: narrow(readout.altitude_m - readout.ground_m),
        hidden: rig.mode == CameraMode::Cockpit,
    }
}
