//! `#[repr(C)]` mirrors of the structs in `shaders/`, and the second of the two places that may narrow f64 to f32.
//!
//! glam's `scalar-math` (asked for by rapier's determinism) makes `align_of::<Vec4>()` 4, so GPU structs use plain arrays
//! and explicit padding; `tests/tests/shaders.rs` compares every one, field by field, with naga's reflection of the WGSL.
//! A struct here has the name and the field names of its WGSL twin plus `Uniform`. Fields are explained there. Those of ground and
//! air are in `gpu_terrain.rs` and `gpu_air.rs`.

pub use super::gpu_air::{
    AirUniform, AirsUniform, MAX_AIRS, MEDIA_COLUMNS, MEDIA_ROWS, PhasesUniform, SKY_SETTINGS, SKY_SINGLE, SkySettings, SkyUniform,
    ViewTableUniform, media_rows,
};
use super::second_light::{self, SecondLight};
use super::{Body, Camera, Ship, Snapshot, Surface};
use crate::light::shadow::Sheet;
use crate::space::relative::narrow3;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

/// Bodies that a frame may hold (the first ones; further ones are left out, unless they are points of light).
pub const MAX_BODIES: usize = 32;
/// Occluders of one body.
pub const MAX_OCCLUDERS: usize = 8;

/// `Frame` of `shaders/lib/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct FrameUniform {
    pub clip_from_icrf: [[f32; 4]; 4],
    pub right: [f32; 4],
    pub up: [f32; 4],
    pub forward: [f32; 4],
    pub size: [f32; 4],
    pub star: [f32; 4],
    pub intensity: [f32; 4],
    pub counts: [u32; 4],
}

/// `Body` of `shaders/lib/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct BodyUniform {
    pub centre: [f32; 4],
    pub fixed_x: [f32; 4],
    pub fixed_y: [f32; 4],
    pub fixed_z: [f32; 4],
    pub up: [f32; 4],
    pub sun: [f32; 4],
    pub illuminance: [f32; 4],
    pub albedo: [f32; 4],
    pub ids: [i32; 4],
    pub lights: [i32; 4],
    pub second: [f32; 4],
    pub second_illuminance: [f32; 4],
    pub sheets: [[f32; 4]; 2 * MAX_OCCLUDERS],
    pub casters: [[i32; 4]; 2],
    pub occluders: [[f32; 4]; MAX_OCCLUDERS],
}

/// `Bodies` of `shaders/lib/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct BodiesUniform {
    pub list: [BodyUniform; MAX_BODIES],
}

/// `Exposure` of `shaders/lib/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct ExposureUniform {
    pub pre: f32,
    pub final_: f32,
    pub average: f32,
    pub settled: f32,
}

/// A vector and a scalar in one `vec4`.
pub const fn vec4(v: Vec3, w: f32) -> [f32; 4] {
    [v.x, v.y, v.z, w]
}

impl FrameUniform {
    /// From the snapshot; `number` seeds what noise there is (0 for stills).
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(scene: &Snapshot, number: u32) -> Self {
        let camera: &Camera = &scene.camera;
        let icrf_from_view = camera.view_from_icrf.conjugate();
        let tan_y = (0.5 * camera.fov_y_rad).tan();
        let [w, h] = camera.size_px.map(|n| n.max(1) as f32);
        Self {
            clip_from_icrf: camera.clip_from_icrf().to_cols_array_2d(),
            right: vec4(icrf_from_view * Vec3::X * (tan_y * camera.aspect()), camera.near_m),
            up: vec4(icrf_from_view * Vec3::Y * tan_y, camera.pixel_rad()),
            forward: vec4(icrf_from_view * Vec3::NEG_Z, scene.adapt_s.unwrap_or(-1.0)),
            size: [w, h, 1.0 / w, 1.0 / h],
            star: vec4(scene.star.centre_m, scene.star.radius_m),
            intensity: vec4(scene.star.intensity_cd, 0.0),
            counts: [scene.bodies.len().min(MAX_BODIES) as u32, number, 0, 0],
        }
    }
}

/// Where the tables lie that a body is lit by.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Slot of its air's.
    pub air: Option<u32>,
    /// Layer of the light that its own air bends into its shadow.
    pub own: Option<u32>,
    /// The same of each of its occluders.
    pub casters: [Option<u32>; MAX_OCCLUDERS],
    /// First layer of the sheet of each occluder's shadow on its air.
    pub sheets: [Option<(u32, Sheet)>; MAX_OCCLUDERS],
}

impl BodyUniform {
    /// From the snapshot; `second`: the body's other light.
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(body: &Body, layers: &Layers, second: Option<SecondLight>) -> Self {
        let axis = |v: Vec3| vec4(body.icrf_from_fixed * v, 0.0);
        let layer = |l: Option<u32>| l.map_or(-1, |l| l as i32);
        let mut occluders = [[0.0; 4]; MAX_OCCLUDERS];
        for (slot, o) in occluders.iter_mut().zip(&body.occluders) {
            *slot = vec4(o.centre_m, o.radius_m);
        }
        let mut sheets = [[0.0, 0.0, 0.0, -1.0]; 2 * MAX_OCCLUDERS];
        for (rows, (first, sheet)) in sheets.chunks_exact_mut(2).zip(&layers.sheets).filter_map(|(rows, s)| Some((rows, (*s)?))) {
            let shape = DVec3::new(sheet.half_m, sheet.bend, (1.0 + sheet.bend * sheet.bend).sqrt() - sheet.bend);
            rows.copy_from_slice(&[vec4(narrow3(sheet.across), first as f32), vec4(narrow3(shape), 0.0)]);
        }
        Self {
            centre: vec4(body.centre_m, body.radius_m),
            fixed_x: axis(Vec3::X),
            fixed_y: axis(Vec3::Y),
            fixed_z: axis(Vec3::Z),
            up: vec4(body.camera_up, body.camera_altitude_m),
            sun: vec4(body.sun_direction, body.sun_angular_radius_rad),
            illuminance: vec4(body.sun_illuminance_lx, 0.0),
            albedo: vec4(body.albedo, 0.0),
            ids: [
                i32::from(body.id),
                body.occluders.len().min(MAX_OCCLUDERS) as i32,
                layer(layers.air),
                i32::from(matches!(body.surface, Surface::Tiles(_))),
            ],
            lights: [
                i32::from(layers.casters.iter().any(Option::is_some)),
                layer(layers.own),
                i32::from(second.is_some()),
                i32::from(second.is_some_and(|l| l.share > 0.0) && second_light::star_is_gone(body)),
            ],
            second: second.map_or([0.0; 4], |l| vec4(l.direction, l.angular_radius_rad)),
            second_illuminance: second.map_or([0.0; 4], |l| vec4(l.illuminance_lx * l.share, 0.0)),
            sheets,
            casters: [0, 4].map(|i| [0, 1, 2, 3].map(|k| layer(layers.casters[i + k]))),
            occluders,
        }
    }
}

impl ExposureUniform {
    /// Fixed exposure value at ISO 100: luminance `1.2 · 2^EV` becomes 1 [Lagarde & de Rousiers 2014, "Moving Frostbite to PBR", §5.1].
    pub fn fixed(ev100: f32) -> Self {
        let e = 1.0 / (1.2 * ev100.clamp(-20.0, 40.0).exp2());
        Self { pre: e, final_: e, average: 0.0, settled: 1.0 }
    }
    /// Before a histogram was taken.
    pub const fn starting(pre: f32) -> Self {
        Self { pre, final_: pre, average: 0.0, settled: 0.0 }
    }
}

impl BodiesUniform {
    /// From the snapshot; `layers(i)` is where body `i`'s tables lie. A second light that does not count is there in a forced frame alone.
    pub fn new(scene: &Snapshot, layers: impl Fn(usize) -> Layers) -> Self {
        let mut all = Self::zeroed();
        for (i, (slot, body)) in all.list.iter_mut().zip(&scene.bodies).enumerate() {
            let second = SecondLight::of(scene, i).filter(|l| l.share > 0.0 || scene.force.all);
            *slot = BodyUniform::new(body, &layers(i), second);
        }
        all
    }
}

/// `Shadow` of `shaders/lib/shadow.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct ShadowUniform {
    pub map_from_icrf: [[f32; 4]; 4],
    pub shape: [f32; 4],
}

/// `Meter` of `shaders/pass/exposure.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct MeterUniform {
    pub range: [f32; 4],
    pub trim: [f32; 4],
    pub limit: [f32; 4],
}

impl MeterUniform {
    /// The light meter of [`crate::light::exposure`], between EV −6 (a starry night) and EV 20. A star in
    /// view that sends `glare_lx` to the eye lets it see no less than a veil of 5e-4 of that per steradian.
    pub fn new(compensation_ev: f32, glare_lx: f32) -> Self {
        use crate::light::exposure::{ADAPT_PER_S, BINS, EV100_DARK, HIGHLIGHT, LOG2_MAX, LOG2_MIN, METER_RANGE};
        let per_stop = (BINS - 1) as f32 / (LOG2_MAX - LOG2_MIN);
        Self {
            range: [LOG2_MIN, per_stop, compensation_ev, HIGHLIGHT[1]],
            trim: [METER_RANGE[0], METER_RANGE[1], ADAPT_PER_S[0], ADAPT_PER_S[1]],
            limit: [EV100_DARK, 20.0, (8.0 * 5e-4 * glare_lx).max(1e-6).log2().max(EV100_DARK), HIGHLIGHT[0]],
        }
    }
}

/// A ship as a vertex-buffer instance (`Ship` of `shaders/lib/ship.wgsl`, locations 3 … 7).
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct ShipInstance {
    pub centre: [f32; 4],
    pub hull_x: [f32; 4],
    pub hull_y: [f32; 4],
    pub hull_z: [f32; 4],
    pub state: [f32; 4],
}

impl ShipInstance {
    /// From the snapshot.
    pub fn new(ship: &Ship) -> Self {
        let axis = |v: Vec3, w: f32| vec4(ship.icrf_from_hull * v, w);
        let host = ship.host.filter(|h| *h < MAX_BODIES).map_or(-1.0, |h| h as f32);
        Self {
            centre: vec4(ship.centre_m, host),
            hull_x: axis(Vec3::X, 0.0),
            hull_y: axis(Vec3::Y, 0.0),
            hull_z: axis(Vec3::Z, 0.0),
            state: [ship.throttle.clamp(0.0, 1.0), ship.gear.clamp(0.0, 1.0), ship.heat.clamp(0.0, 1.0), ship.height_above_ground_m],
        }
    }
}
