//! The snapshot of a World: what a frame is drawn from. f64 becomes f32 here, once, through `engine::space::relative`.
//!
//! Positions are taken from the host's centre first, so that the ground under the ship is exact to f64 at 6,000 km
//! (1 nm) and not to f64 at one astronomical unit (30 µm).

use super::rig::{Eye, Mount, Rig};
use crate::world::World;
use crate::world::eclipse::{self, Sky};
use crate::world::system::System;
use engine::orbit::BodyId;
use engine::scene::{Body, Camera, Force, Occluder, Ship, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3, rotation};
use engine::space::{Centred, Position};
use engine::terrain::quadtree;
use engine::time::TICK_S;
use glam::DVec3;

/// Nearest thing that can be seen, m.
const NEAR_M: f32 = 0.1;
/// Bodies whose disc has a radius of fewer pixels than this are drawn smooth, without tiles.
const TILES_FROM_PX: f64 = 6.0;
/// Height above ground beyond which nothing asks how high the ground is under the ship, m.
const SHADOW_HEIGHT_M: f64 = 2_000.0;

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

/// A ship and where it is drawn.
#[derive(Clone, Copy, Debug)]
struct Pose {
    host: BodyId,
    position: Position<Centred>,
    mount_attitude: engine::space::Rotation<engine::space::Icrf, engine::space::Hull>,
}

/// What a frame of this World is drawn from, and the eye it was taken with.
pub fn snapshot(world: &World, rig: &Rig, picture: &Picture) -> (Snapshot, Eye) {
    // Between ticks everything moves on along its velocity; at high warp a tick is too long for that, and is shown as it is.
    let beyond_s = if world.warp <= crate::command::WARP_ONE { picture.alpha.clamp(0.0, 1.0) * TICK_S * world.rate() } else { 0.0 };
    let sky = Sky::between(&world.system, world.time, beyond_s);
    let pose = pose(world, beyond_s);
    let mount = Mount { system: &world.system, sky: &sky, host: pose.host, ship: pose.position, icrf_from_hull: pose.mount_attitude };
    let eye = rig.eye(&mount);
    let camera = Camera {
        view_from_icrf: rotation(eye.view_from_icrf),
        fov_y_rad: narrow(rig.fov_y_rad),
        near_m: NEAR_M,
        size_px: [picture.size_px[0].max(1), picture.size_px[1].max(1)],
    };
    let stage = Stage { system: &world.system, sky: &sky, eye: &eye, camera: &camera };
    let mut bodies: Vec<Body> = (1..world.system.bodies.len()).map(|i| stage.body(id(i))).collect();
    bodies.sort_by(|a, b| a.centre_m.length().total_cmp(&b.centre_m.length()));
    let ship = ship(world, rig, &stage, &pose, &bodies);
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

fn pose(world: &World, beyond_s: f64) -> Pose {
    let state = world.ship.state(world.time);
    let attitude = world.ship.attitude(world.time);
    Pose { host: world.ship.host, position: state.position + state.velocity.over(beyond_s), mount_attitude: attitude }
}

struct Stage<'a> {
    system: &'a System,
    sky: &'a Sky,
    eye: &'a Eye,
    camera: &'a Camera,
}

impl Stage<'_> {
    /// A point given from a body's centre, from the camera.
    fn from_camera(&self, body: BodyId, offset: DVec3) -> DVec3 {
        let centre = if body == self.eye.host { DVec3::ZERO } else { (self.sky.position(body) - self.sky.position(self.eye.host)).0 };
        (centre - self.eye.position.0) + offset
    }

    fn star(&self) -> Star {
        let star = &self.system.bodies[0];
        Star {
            id: 0,
            centre_m: narrow3(self.from_camera(BodyId(0), DVec3::ZERO)),
            radius_m: narrow(star.radius_m),
            intensity_cd: star.intensity_cd,
        }
    }

    fn body(&self, id: BodyId) -> Body {
        let body = self.system.body(id);
        let centre = self.from_camera(id, DVec3::ZERO);
        let distance = centre.length();
        let up = (-centre).normalize_or(DVec3::Z);
        let star = &self.system.bodies[0];
        let to_star = (self.sky.position(BodyId(0)) - self.sky.position(id)).0;
        let star_distance = to_star.length().max(star.radius_m);
        let radius_px = body.radius_m / distance.max(body.radius_m) / f64::from(self.camera.pixel_rad());
        let icrf_from_fixed = self.sky.axes(self.system, id);
        let surface = match &body.relief {
            Some(relief) if radius_px >= TILES_FROM_PX => {
                let view = quadtree::View {
                    camera: Position::new(icrf_from_fixed.inverse().raw(-centre)),
                    fixed_from_icrf: icrf_from_fixed.inverse(),
                    lens: *self.camera,
                    relief_max: body.relief_max,
                };
                Surface::Tiles(quadtree::select(relief, &view))
            }
            _ => Surface::Smooth,
        };
        let shell = body.radius_m + body.air.as_ref().map_or(0.0, |a| a.medium.top_altitude_m);
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
            occluders: eclipse::casters(self.system, self.sky, self.sky.position(id), shell, Some(id))
                .into_iter()
                .map(|caster| Occluder {
                    id: caster.0,
                    centre_m: narrow3(self.from_camera(caster, DVec3::ZERO)),
                    radius_m: narrow(self.system.body(caster).radius_m),
                })
                .collect(),
            albedo: body.albedo,
            surface,
            air: body.air.as_ref().map(|a| a.medium.clone()),
        }
    }
}

fn ship(world: &World, rig: &Rig, stage: &Stage<'_>, pose: &Pose, bodies: &[Body]) -> Ship {
    let body = world.system.body(pose.host);
    let altitude = pose.position.length() - body.radius_m;
    let height = match &body.relief {
        Some(relief) if altitude < SHADOW_HEIGHT_M + 9_000.0 => {
            let down = stage.sky.axes(stage.system, pose.host).inverse().raw(pose.position.0.normalize_or(DVec3::Z));
            altitude - relief.surface_m(down)
        }
        _ => altitude,
    };
    Ship {
        centre_m: narrow3(stage.from_camera(pose.host, pose.position.0)),
        icrf_from_hull: rotation(pose.mount_attitude),
        throttle: narrow(world.ship.throttle_in_force()),
        gear: narrow(world.ship.gear_extension),
        heat: narrow(world.ship.heat_glow()),
        host: bodies.iter().position(|b| b.id == pose.host.0),
        height_above_ground_m: narrow(height),
        hidden: rig.mode == super::CameraMode::Cockpit,
    }
}

