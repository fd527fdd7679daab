//! `#[repr(C)]` mirrors of the structs of air in `shaders/`; the rules are those of [`super::gpu_data`].

use super::gpu_data::vec4;
use crate::air::model::view_space::Spacing;
use crate::air::model::view_table::{AlphaColour, Split, ViewTable};
use crate::air::{Medium, Phase, Profile};
use crate::space::relative::{narrow, narrow3};
use bytemuck::{Pod, Zeroable};

/// Atmospheres that the tables hold at once.
pub const MAX_AIRS: usize = 16;
/// Stands for an asymmetry where the phase function is Rayleigh's: `PHASE_RAYLEIGH` of `shaders/lib/phase.wgsl`.
const PHASE_RAYLEIGH: f32 = 2.0;

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
    pub asymmetry: [f32; 4],
}

/// `Airs` of `shaders/lib/medium.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct AirsUniform {
    pub list: [AirUniform; MAX_AIRS],
}

impl AirUniform {
    /// Layers that it holds.
    pub const LAYERS: usize = 4;

    /// From a medium: its first [`Self::LAYERS`] exponential and tent layers. Henyey–Greenstein is taken for Cornette–Shanks, any other phase for Rayleigh's.
    pub fn new(medium: &Medium) -> Self {
        let mut air = Self::zeroed();
        air.shape = [narrow(medium.bottom_radius_m), narrow(medium.top_altitude_m), 0.0, 0.0];
        air.albedo = vec4(medium.ground_albedo, 0.0);
        air.asymmetry = [PHASE_RAYLEIGH; 4];
        for (i, layer) in medium
            .layers
            .iter()
            .filter(|l| matches!(l.profile, Profile::Exponential { .. } | Profile::Tent { .. }))
            .take(Self::LAYERS)
            .enumerate()
        {
            air.scattering[i] = vec4(layer.scattering_per_m, 0.0);
            air.extinction[i] = vec4(layer.scattering_per_m + layer.absorption_per_m, 0.0);
            match layer.profile {
                Profile::Exponential { scale_height_m } => air.inverse_height[i] = 1.0 / scale_height_m,
                Profile::Tent { bottom_m, peak_m, top_m } => {
                    air.tent_bottom[i] = bottom_m;
                    air.tent_rise[i] = 1.0 / (peak_m - bottom_m);
                    air.tent_top[i] = top_m;
                    air.tent_fall[i] = 1.0 / (top_m - peak_m);
                }
                Profile::Constant { .. } | Profile::Table { .. } => {}
            }
            if let Phase::CornetteShanks { g } | Phase::HenyeyGreenstein { g } = layer.phase {
                air.asymmetry[i] = g;
            }
        }
        air
    }
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
}

impl ViewTableUniform {
    /// From the settings and what of the medium goes where.
    pub fn new(settings: &ViewTable, split: &Split) -> Self {
        let flag = |on: bool| if on { 1.0 } else { 0.0 };
        let mut all = Self::zeroed();
        let first = split.in_rgb.iter().position(|r| *r);
        for (i, in_rgb) in split.in_rgb.iter().enumerate().take(AirUniform::LAYERS) {
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
