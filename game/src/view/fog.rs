//! Banks of fog and nebulae in the snapshot: bodies that have nothing but air. Their own host is among what shades them.
//!
//! Not here: where they are written down (`assets::atmosphere::fog`), how they are lit (`engine::air::model::thickness`).

use super::snapshot::Stage;
use crate::world::system::Fog;
use engine::orbit::BodyId;
use engine::scene::{Body, Surface};
use engine::space::Vector;
use engine::space::relative::{narrow, narrow3, rotation};
use glam::{DVec3, Vec3};

/// A ball whose radius is fewer pixels is left out.
const FROM_PX: f64 = 0.5;

/// All that are large enough to be seen. Their ids count down from the last one: systems hold no such many bodies.
pub(super) fn banks(stage: &Stage<'_>) -> Vec<Body> {
    let hosts = (0_u16..).map(BodyId).zip(&stage.system.bodies);
    let all = hosts.flat_map(|(host, body)| body.fog.iter().map(move |fog| (host, fog)));
    (0_u16..=u16::MAX).rev().zip(all).filter_map(|(id, (host, fog))| bank(stage, id, host, fog)).collect()
}

fn bank(stage: &Stage<'_>, id: u16, host: BodyId, fog: &Fog) -> Option<Body> {
    let icrf_from_fixed = stage.sky.axes(stage.system, host);
    let offset = icrf_from_fixed.raw(fog.centre_m);
    let centre = stage.seen_from_camera(host, offset);
    let distance = centre.length();
    let (core_m, radius_m) = (fog.air.medium.bottom_radius_m, fog.air.medium.top_altitude_m);
    if radius_m / distance.max(radius_m) < FROM_PX * f64::from(stage.camera.pixel_rad()) {
        return None;
    }
    let star = &stage.system.bodies[0];
    let place = stage.sky.position(host) + Vector::new(offset);
    let to_star = (stage.sky.position(BodyId(0)) - place).0;
    let star_distance = to_star.length().max(star.radius_m);
    Some(Body {
        id,
        centre_m: narrow3(centre),
        radius_m: narrow(core_m),
        icrf_from_fixed: rotation(icrf_from_fixed),
        camera_altitude_m: narrow(distance - core_m),
        camera_up: narrow3((-centre).normalize_or(DVec3::Z)),
        sun_direction: narrow3(to_star / star_distance),
        sun_angular_radius_rad: narrow(libm::asin((star.radius_m / star_distance).min(1.0))),
        sun_illuminance_lx: star.intensity_cd * narrow(1.0 / (star_distance * star_distance)),
        occluders: stage.occluders(place, radius_m, None),
        albedo: Vec3::ZERO,
        surface: Surface::Nothing,
        air: Some(fog.air.clone()),
    })
}
