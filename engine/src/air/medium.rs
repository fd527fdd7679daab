//! The medium: the optical layers of one atmosphere. Coefficients in m⁻¹ per linear sRGB channel.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Density of a layer relative to its coefficient, against altitude above the datum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// `exp(−h / scale_height)`.
    Exponential {
        /// Scale height, m.
        scale_height_m: f32,
    },
    /// A triangle: 0 at `bottom`, 1 at `peak`, 0 at `top`.
    Tent {
        /// Altitude where it begins, m.
        bottom_m: f32,
        /// Altitude of full density, m.
        peak_m: f32,
        /// Altitude where it ends, m.
        top_m: f32,
    },
}

/// Phase function of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// 3/(16π)(1 + cos²θ).
    Rayleigh,
    /// Cornette–Shanks with asymmetry g.
    CornetteShanks {
        /// Asymmetry, −1 < g < 1.
        g: f32,
    },
}

/// One layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Scattering coefficient at density 1, m⁻¹.
    pub scattering_per_m: Vec3,
    /// Absorption coefficient at density 1, m⁻¹.
    pub absorption_per_m: Vec3,
    /// Density against altitude.
    pub profile: Profile,
    /// Where scattered light goes.
    pub phase: Phase,
}

/// An atmosphere as light sees it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Medium {
    /// Radius of the datum sphere, m.
    pub bottom_radius_m: f64,
    /// Altitude of the top above the datum, m.
    pub top_altitude_m: f64,
    /// Lambert albedo of the ground that the tables assume.
    pub ground_albedo: Vec3,
    /// The layers, at most [`Medium::MAX_LAYERS`].
    pub layers: Vec<Layer>,
}

impl Medium {
    /// Layers a medium may have.
    pub const MAX_LAYERS: usize = 4;
}
