//! Models: how the light of an air is found for the picture. One file per model: its settings, and its formulas in f64.
//!
//! [`physical`] is the default. What a model draws is judged by [`super::reference`]; its shader is `shaders/pass/sky_<model>.wgsl`.

pub mod orders;
pub mod physical;

use super::Medium;
use serde::{Deserialize, Serialize};

pub use physical::Physical;

/// How the light of an air is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum Model {
    /// Single scattering exact along the ray, higher orders from tables.
    Physical(Physical),
}

impl Default for Model {
    fn default() -> Self {
        Self::Physical(Physical::default())
    }
}

/// An air as it is drawn: what light meets in it, and how its light is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Air {
    /// The optical layers. A stylised model may have none: then nothing reddens the sun and no sky lights the ground.
    pub medium: Medium,
    /// The model and its settings.
    pub model: Model,
}

impl From<Medium> for Air {
    /// The default model.
    fn from(medium: Medium) -> Self {
        Self { medium, model: Model::default() }
    }
}
