//! `#[repr(C)]` mirrors of the structs of air in `shaders/`; the rules are those of [`super::gpu_data`].

use super::gpu_data::vec4;
use crate::air::model::forward::Truncated;
use crate::air::model::levels::Levels;
use crate::air::model::orders::SunMap;
use crate::air::model::spread::{PARTS, RINGS, SUNS, Spread};
use crate::air::model::view_space::Spacing;
use crate::air::model::view_table::{AlphaColour, Split, ViewTable};
use crate::air::{Classes, Layer, Medium, Phase, Profile};
use crate::space::relative::{narrow, narrow3};
use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec3, Vec3};

/// Atmospheres that the tables hold at once.
pub const MAX_AIRS: usize = 32;
/// Columns of the tables of media that are not formulas: `MEDIA_COLUMNS` of `shaders/lib/medium.wgsl`.
pub const MEDIA_COLUMNS: usize = 1024;
/// Their rows: scattering of each class, extinction, phase functions.
pub const MEDIA_ROWS: usize = Classes::MAX + 3;
/// Altitudes of jumps that an air may have.
const MAX_JUMPS: usize = 8;
/// Slope of a tent that is a step, m⁻¹.
const STEP: f32 = 1e20;

/// `Phases` of `shaders/lib/phase.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct PhasesUniform {
    pub g: [f32; 4],
    pub x: [f32; 4],
    pub y: [f32; 4],
    pub z: [f32; 4],
}

/// `Air` of `shaders/lib/medium.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct AirUniform {
    pub shape: [f32; 4],
    pub albedo: [f32; 4],
    pub scattering: [[f32; 4]; 4],
    pub extinction: [[f32; 4]; 4],
    pub inverse_height: [f32; 4],
    pub tent_bottom: [f32; 4],
    pub tent_rise: [f32; 4],
    pub tent_top: [f32; 4],
    pub tent_fall: [f32; 4],
    pub phases: PhasesUniform,
    pub jumps_low: [f32; 4],
    pub jumps_high: [f32; 4],
    pub orders: [f32; 4],
    pub bands: [[f32; 4]; 6],
    pub rings: [[f32; 4]; 4 * RINGS],
    pub forward: [f32; 4],
    pub cap: [f32; 4],
    pub aureole: PhasesUniform,
    pub levels: [[f32; 4]; 4],
    pub level_steps: [[f32; 4]; 4],
    pub tilt: [[f32; 4]; 4],
    pub ring_parts: [[f32; 4]; PARTS],
    pub pad: [[f32; 4]; 15],
}

// A graphics card binds one air of the list only where its place is a multiple of this.
const _: () = assert!(size_of::<AirUniform>().is_multiple_of(256));

/// `Airs` of `shaders/lib/medium.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct AirsUniform {
    pub list: [AirUniform; MAX_AIRS],
}

impl AirUniform {
    /// From a medium and its classes. Where they are not direct, formulas stay empty and [`media_rows`] has what the shader asks for.
    pub fn new(medium: &Medium, classes: &Classes) -> Self {
        let mut air = Self::zeroed();
        let jumps = medium.cuts_m(MAX_JUMPS);
        air.shape = [
            narrow(medium.bottom_radius_m),
            narrow(medium.top_altitude_m),
            if classes.direct { 0.0 } else { 1.0 },
            if jumps.is_empty() { 0.0 } else { 1.0 },
        ];
        air.albedo = vec4(medium.ground_albedo, narrow(root_of_floor(medium)));
        [air.jumps_low, air.jumps_high] = [[-1e9; 4]; 2];
        for (slot, jump) in air.jumps_low.iter_mut().chain(&mut air.jumps_high).zip(jumps) {
            *slot = narrow(jump);
        }
        let map = SunMap::new(medium);
        air.orders = [map.scale, map.low, map.inverse, map.knee].map(narrow);
        [air.levels, air.level_steps] = Levels::new(medium).vectors();
        for (i, class) in classes.list.iter().take(Classes::MAX).enumerate() {
            let cut = Truncated::new(class);
            (air.forward[i], air.cap[i]) = (narrow(cut.share), narrow(cut.cap));
            if let Some(layer) = medium.layers.get(i).filter(|_| classes.direct) {
                air.aureole.set(i, &cut.aureole(&layer.phase));
            }
        }
        air.bands = [vec4(Vec3::X, 0.0), vec4(Vec3::Y, 1.0), vec4(Vec3::Z, 0.0), [0.0; 4], [0.0; 4], [0.0; 4]];
        if classes.direct {
            medium.layers.iter().take(Classes::MAX).enumerate().for_each(|(i, layer)| air.set(i, layer));
        }
        air
    }

    /// With the rings from which scattered light comes to a point in an eclipse.
    #[must_use]
    pub fn with_rings(mut self, spread: &Spread) -> Self {
        let w = [narrow(1.0 / spread.altitude_m.max(1e-3)), narrow(SUNS[0]), narrow(1.0 / (SUNS[1] - SUNS[0])), 0.0];
        for (k, w) in w.into_iter().enumerate() {
            let rise = [0, 1].map(|sun| spread.high[sun][k] - spread.low[sun][k]);
            self.rings[k] = vec4(narrow3(spread.low[0][k]), narrow(spread.radius_m[k][PARTS - 1]));
            self.rings[RINGS + k] = vec4(narrow3(rise[0]), w);
            self.rings[2 * RINGS + k] = vec4(narrow3(spread.low[1][k] - spread.low[0][k]), 0.0);
            self.rings[3 * RINGS + k] = vec4(narrow3(rise[1] - rise[0]), 0.0);
            (0..PARTS).for_each(|part| self.ring_parts[part][k] = narrow(spread.radius_m[k][part]));
            let [low, high] = spread.tilt;
            for side in 0..2 {
                self.tilt[side][k] = narrow(low[side][k]);
                self.tilt[2 + side][k] = narrow(high[side][k] - low[side][k]);
            }
        }
        self
    }

    /// Drawn by the medium in this slot, its own.
    #[must_use]
    pub fn in_slot(mut self, slot: u32) -> Self {
        self.bands[0][3] = slot as f32;
        self
    }

    /// Drawn by the one or two media in these slots, each with its matrix to linear sRGB.
    #[must_use]
    pub fn in_bands(mut self, bands: &[(u32, DMat3)]) -> Self {
        for (k, (slot, to_rgb)) in bands.iter().take(2).enumerate() {
            (0..3).for_each(|c| self.bands[3 * k + c] = vec4(narrow3(to_rgb.col(c)), 0.0));
            self.bands[3 * k][3] = *slot as f32;
        }
        self.bands[1][3] = bands.len() as f32;
        self
    }

    fn set(&mut self, i: usize, layer: &Layer) {
        self.scattering[i] = vec4(layer.scattering_per_m, 0.0);
        self.extinction[i] = vec4(layer.scattering_per_m + layer.absorption_per_m, 0.0);
        match layer.profile {
            Profile::Exponential { scale_height_m } => self.inverse_height[i] = 1.0 / scale_height_m,
            Profile::Tent { bottom_m, peak_m, top_m } => {
                self.tent_bottom[i] = bottom_m;
                self.tent_rise[i] = 1.0 / (peak_m - bottom_m);
                self.tent_top[i] = top_m;
                self.tent_fall[i] = 1.0 / (top_m - peak_m);
            }
            Profile::Constant { bottom_m, top_m } => {
                self.tent_bottom[i] = if bottom_m > 0.0 { bottom_m } else { -1e9 };
                self.tent_rise[i] = STEP;
                self.tent_top[i] = top_m;
                self.tent_fall[i] = STEP;
            }
            Profile::Table { .. } => {}
        }
        self.phases.set(i, &layer.phase);
    }
}

impl PhasesUniform {
    fn set(&mut self, i: usize, phase: &Phase) {
        let (g, polynomial) = match *phase {
            Phase::Rayleigh => (0.0, [0.75, 0.0, 0.75]),
            Phase::HenyeyGreenstein { g } => (g, [1.0, 0.0, 0.0]),
            Phase::CornetteShanks { g } => (g, [1.5 / (2.0 + g * g), 0.0, 1.5 / (2.0 + g * g)]),
            Phase::ElekRayleigh => (0.0, [0.98, 0.35, 0.0]),
            Phase::Isotropic => (0.0, [1.0, 0.0, 0.0]),
            Phase::Table { .. } => (0.0, [0.0; 3]),
        };
        self.g[i] = g;
        [self.x[i], self.y[i], self.z[i]] = polynomial;
    }
}

/// Root of the depth below the datum that tables reach, over the top; at most 1.
fn root_of_floor(medium: &Medium) -> f64 {
    (Medium::FLOOR_M / medium.top_altitude_m).sqrt().min(1.0)
}

/// The tables of a medium whose classes are not formulas: [`MEDIA_ROWS`] rows of [`MEDIA_COLUMNS`] texels, as `shaders/lib/medium.wgsl` reads them.
pub fn media_rows(medium: &Medium, classes: &Classes) -> Vec<[f32; 4]> {
    let columns = || (0..MEDIA_COLUMNS).map(|i| i as f64 / (MEDIA_COLUMNS - 1) as f64);
    let floor = root_of_floor(medium);
    let altitude = |x: f64| {
        let root = x * (1.0 + floor) - floor;
        root * root.abs() * medium.top_altitude_m
    };
    // Far below the datum a thin layer would be denser than an f32 can be.
    let held = |v: DVec3| vec4(narrow3(v.min(DVec3::splat(1e20))), 0.0);
    let mut rows: Vec<[f32; 4]> = Vec::with_capacity(MEDIA_ROWS * MEDIA_COLUMNS);
    for k in 0..Classes::MAX {
        let of = |x: f64| classes.list.get(k).map_or(DVec3::ZERO, |c| c.scattering(medium, altitude(x)));
        rows.extend(columns().map(|x| held(of(x))));
    }
    rows.extend(columns().map(|x| held(medium.extinction(altitude(x)))));
    let value = |k: usize, x: f64| classes.list.get(k).map_or(0.0, |c| c.value(libm::cos(x * x * core::f64::consts::PI)));
    rows.extend(columns().map(|x| [0, 1, 2, 3].map(|k| narrow(value(k, x)))));
    let angles: Vec<f64> = columns().map(|x| x * x * core::f64::consts::PI).collect();
    let blurred: Vec<Vec<f64>> = classes.list.iter().map(|c| Truncated::new(c).blurred(c, &angles)).collect();
    rows.extend((0..MEDIA_COLUMNS).map(|i| [0, 1, 2, 3].map(|k| narrow(blurred.get(k).map_or(0.0, |b| b[i])))));
    rows
}

/// Rows of four numbers that a model of air may hand to its shader: `SKY_SETTINGS` of `shaders/lib/sky_pixel.wgsl`.
pub const SKY_SETTINGS: usize = 8;
/// Flag of [`SkyUniform`]: orders of scattering beyond the first are left out. `SKY_SINGLE` of the shader.
pub const SKY_SINGLE: u32 = 1;

/// What a model tells its shader of one body, in the model's own order.
pub type SkySettings = [[f32; 4]; SKY_SETTINGS];

/// `Sky` of `shaders/lib/sky_pixel.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct SkyUniform {
    pub ids: [u32; 4],
    pub settings: SkySettings,
}

/// `ViewTable` of `shaders/lib/view_table.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct ViewTableUniform {
    pub rgb: [f32; 4],
    pub alpha: [f32; 4],
    pub rgb_phase: [f32; 4],
    pub alpha_phase: [f32; 4],
    pub tint: [f32; 4],
    pub inverse: [f32; 4],
    pub counts: [u32; 4],
    pub ids: [i32; 4],
}

impl ViewTableUniform {
    /// Of no body.
    pub fn none() -> Self {
        Self { ids: [-1; 4], ..Self::zeroed() }
    }

    /// From the settings and what of the medium of body `id` goes where.
    pub fn new(id: u16, settings: &ViewTable, split: &Split) -> Self {
        let flag = |on: bool| if on { 1.0 } else { 0.0 };
        let mut all = Self { ids: [i32::from(id), 0, 0, 0], ..Self::zeroed() };
        let first = split.in_rgb.iter().position(|r| *r);
        for (i, in_rgb) in split.in_rgb.iter().enumerate().take(Classes::MAX) {
            all.rgb[i] = flag(*in_rgb);
            all.alpha[i] = flag(!in_rgb);
            all.rgb_phase[i] = flag(first == Some(i));
            all.alpha_phase[i] = narrow(split.alpha_weights.get(i).copied().unwrap_or(0.0));
        }
        all.tint = vec4(narrow3(split.alpha_tint()), flag(settings.alpha_colour == AlphaColour::Proportional));
        let [r, g, b] = split.rgb_depth.to_array().map(|d| if d > 0.0 { narrow(1.0 / d) } else { 0.0 });
        all.inverse = [r, g, b, 0.0];
        all.counts = [settings.samples, settings.depth_samples, settings.ambient_samples, u32::from(settings.spacing == Spacing::Graded)];
        all
    }
}
