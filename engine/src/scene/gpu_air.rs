//! `#[repr(C)]` mirrors of the structs of air in `shaders/`; the rules are those of [`super::gpu_data`].

use super::gpu_data::vec4;
use crate::air::model::orders::SunMap;
use crate::air::{Medium, Phase, Profile};
use crate::space::relative::narrow;
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
    pub orders: [f32; 4],
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
        let map = SunMap::new(medium);
        air.orders = [narrow(map.scale), narrow(map.low), narrow(map.inverse), 0.0];
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
