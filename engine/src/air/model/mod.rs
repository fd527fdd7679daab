//! Models: how the light of an air is found for the picture. One file per model: its settings, and its formulas in f64.
//!
//! What a model draws is judged by [`super::reference`]; its shader is `shaders/pass/sky_<model>.wgsl`.

pub mod gradient;
pub mod maps;
pub mod shell;
pub mod thickness;

pub use gradient::Gradient;
pub use thickness::Thickness;
