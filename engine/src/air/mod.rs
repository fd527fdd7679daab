//! Air: the layers of one atmosphere, how thick it is at an altitude, and how light crosses it.

pub mod density;
pub mod medium;

pub use medium::{Layer, Medium, Phase, Profile};
