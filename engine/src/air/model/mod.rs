//! Models: how the light of an air is found for the picture. One file per model: its settings, and its formulas in f64.
//!
//! [`physical`] is the default. What a model draws is judged by [`super::reference`]; its shader is `shaders/pass/sky_<model>.wgsl`.

pub mod forward;
pub mod gradient;
pub mod levels;
pub mod limb_table;
pub mod maps;
pub mod orders;
mod paths;
mod peaks;
pub mod physical;
pub mod shell;
pub mod spread;
pub mod streams;
mod sun_map;
pub mod thickness;
pub mod view_space;
pub mod view_table;

use super::Medium;
use super::refraction::{ByWavelength, Refractive};
use super::spectral::Bands;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

pub use gradient::Gradient;
pub use limb_table::LimbTable;
pub use maps::ColourMap;
pub use physical::Physical;
pub use thickness::Thickness;
pub use view_table::ViewTable;

/// How the light of an air is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum Model {
    /// Single scattering exact along the ray, higher orders from tables.
    Physical(Physical),
    /// As bright as the air is thick along the ray; the planet's shadow as a cone in it.
    Thickness(Thickness),
    /// A 2-D table by two cosines at the shell's top, laid over additively.
    LimbTable(LimbTable),
    /// A 3-D table of single scattering by height, view and sun.
    ViewTable(ViewTable),
    /// Colours of two small painted maps.
    Gradient(Gradient),
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
    /// The same in three or six bands, by which [`Model::Physical`] is to draw it; everything else draws by `medium`.
    pub bands: Option<Box<Bands>>,
    /// What of it bends light into the planet's shadow.
    pub gases: Vec<Refractive>,
    /// The star's light by wavelength on its way through the layers, where that is known: a shadow's colour is found from all of it.
    #[serde(skip)]
    pub by_wavelength: Option<Arc<ByWavelength>>,
    /// The model and its settings.
    pub model: Model,
}

impl From<Medium> for Air {
    /// The default model.
    fn from(medium: Medium) -> Self {
        Self { bands: None, gases: Refractive::of_medium(&medium), by_wavelength: None, model: Model::default(), medium }
    }
}
