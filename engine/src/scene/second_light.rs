//! The second light of a body: the brightest of the other worlds in its sky, as a light. Moonlight, and planetshine on moons.
//!
//! Air in the star's daylight has no need of it: it is faded in as the star sinks below the horizon of the camera, from [`DUSK_RAD`] to
//! [`NIGHT_RAD`], where twilight is still thirty times as bright as a full moon. Worlds without air have it at all times. Not here: what it does
//! (`shaders/lib/second_light.wgsl`).

use super::{Body, Snapshot};
use crate::light::exposure::LUMINANCE;
use crate::light::occlusion::{Disc, visible};
use crate::light::reflected::lambert_sphere;
use crate::space::relative::{narrow, narrow3};
use glam::Vec3;

/// Illuminance under which a second light is none, lx: a fifth of that of a starry sky.
pub const LEAST_LX: f32 = 2e-4;
/// A body whose radius is fewer pixels is a point: nothing of it is lit twice.
const SEEN_PX: f32 = 0.5;
/// How deep the star stands below the camera's horizon where the second light begins to count in air, rad: at 3° twilight brings 50 lx.
pub const DUSK_RAD: f32 = 0.052;
/// Where it counts in full, rad.
pub const NIGHT_RAD: f32 = 0.087;
/// Where the star itself no longer lights any air that can be seen from within it, rad: at 20° it brings 1e-4 of a full moon.
pub const DARK_RAD: f32 = 0.35;

/// A body's second light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondLight {
    /// Place in the snapshot's list of the world that throws it.
    pub from: usize,
    /// Unit vector to it.
    pub direction: Vec3,
    /// Its angular radius, rad.
    pub angular_radius_rad: f32,
    /// Illuminance, lx per linear sRGB channel, above the air; without the fading.
    pub illuminance_lx: Vec3,
    /// By how much it counts, 0 … 1.
    pub share: f32,
}

impl SecondLight {
    /// The brightest light that another body of the scene throws on body `place`; `None` under [`LEAST_LX`].
    pub fn of(scene: &Snapshot, place: usize) -> Option<Self> {
        let body = scene.bodies.get(place)?;
        let seen = body.radius_m / (body.radius_m + body.camera_altitude_m).max(1.0) >= SEEN_PX * scene.camera.pixel_rad();
        if !seen && scene.ships.iter().all(|s| s.host != Some(place)) {
            return None;
        }
        let lights = scene.bodies.iter().enumerate().filter(|(i, b)| *i != place && b.albedo != Vec3::ZERO);
        let brightest = lights.filter_map(|(i, by)| thrown(body, i, by)).max_by(|a, b| a.lux().total_cmp(&b.lux()))?;
        (brightest.lux() >= LEAST_LX).then_some(Self { share: share(body), ..brightest })
    }

    /// Illuminance, lx.
    pub fn lux(&self) -> f32 {
        self.illuminance_lx.dot(LUMINANCE)
    }
}

/// How deep the star stands below the horizon of the camera, rad; negative where it is above.
pub fn depression_rad(body: &Body) -> f32 {
    let r = body.radius_m + body.camera_altitude_m.max(0.0);
    let dip = (body.radius_m / r).min(1.0).acos();
    let zenith = body.camera_up.dot(body.sun_direction).clamp(-1.0, 1.0).acos();
    zenith - core::f32::consts::FRAC_PI_2 - dip
}

/// True where the camera is in the air of a body that the star no longer lights.
pub fn star_is_gone(body: &Body) -> bool {
    let within = body.air.as_ref().is_some_and(|a| body.camera_altitude_m < narrow(a.medium.top_altitude_m));
    within && depression_rad(body) > DARK_RAD
}

/// By how much the second light of a body counts in the picture.
fn share(body: &Body) -> f32 {
    if body.air.is_none() {
        return 1.0;
    }
    ((depression_rad(body) - DUSK_RAD) / (NIGHT_RAD - DUSK_RAD)).clamp(0.0, 1.0)
}

/// The light that `by` throws on a body: a Lambert sphere's, less where others shade it.
fn thrown(body: &Body, from: usize, by: &Body) -> Option<SecondLight> {
    let offset = by.centre_m.as_dvec3() - body.centre_m.as_dvec3();
    let distance = offset.length();
    let radius = f64::from(by.radius_m);
    let most = by.sun_illuminance_lx * by.albedo * narrow(radius * radius / (distance * distance));
    if distance <= radius || most.max_element() < LEAST_LX {
        return None;
    }
    let direction = offset / distance;
    let phase = libm::acos(by.sun_direction.as_dvec3().dot(-direction).clamp(-1.0, 1.0));
    let sun = Disc { direction: by.sun_direction.as_dvec3(), radius_rad: f64::from(by.sun_angular_radius_rad) };
    let at = by.centre_m.as_dvec3();
    let discs: Vec<Disc> = by.occluders.iter().map(|o| Disc::of_sphere(o.centre_m.as_dvec3() - at, f64::from(o.radius_m))).collect();
    let share = lambert_sphere(1.0, radius, distance, phase) * visible(sun, &discs);
    let illuminance_lx = by.sun_illuminance_lx * by.albedo * narrow(share);
    let angular_radius_rad = narrow(libm::asin(radius / distance));
    Some(SecondLight { from, direction: narrow3(direction), angular_radius_rad, illuminance_lx, share: 1.0 })
}

/// Why no body of the scene is drawn in a second light.
pub fn skip(scene: &Snapshot) -> Option<String> {
    let all: Vec<SecondLight> = (0..scene.bodies.len()).filter_map(|i| SecondLight::of(scene, i)).collect();
    if all.is_empty() {
        return Some(format!("no world throws as much as {LEAST_LX} lx on what is drawn of another"));
    }
    all.iter().all(|l| l.share <= 0.0).then(|| "the camera is by day, or in early dusk, on every world that another lights".to_owned())
}
