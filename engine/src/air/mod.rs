//! Air: the layers of one atmosphere, how thick it is at an altitude, and how light crosses it.
//!
//! [`density`] is what drags (temperature, pressure, density); [`medium`] is what one sees (coefficients of scattering and
//! absorption), and [`optics`] what these are for a gas of known molecules; [`model`] is how the picture finds the light of it;
//! [`reference`] integrates light through a medium in f64, slowly, and judges the tables and the shaders; [`refraction`] is the light that
//! air bends into its planet's shadow; [`spectral`] is air by wavelength, and how few wavelengths do for all.

pub mod density;
pub mod medium;
pub mod model;
pub mod optics;
pub mod reference;
pub mod refraction;
pub mod spectral;
mod us76;

pub use density::{Column, ColumnSpec};
pub use medium::{Class, Classes, Layer, Medium, MediumSpec, Phase, Profile};
pub use model::{Air, Model};

/// A value outside of what makes sense. The caller adds the file and the line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{field}` is {found}: expected {expected}")]
pub struct RangeError {
    /// Key of the value, as the file spells it.
    pub field: String,
    /// What was found.
    pub found: f64,
    /// What was expected.
    pub expected: String,
}

impl RangeError {
    /// Adds an error unless `min ≤ found ≤ max`; NaN is always one.
    pub(crate) fn check(errors: &mut Vec<Self>, field: &str, found: f64, min: f64, max: f64) {
        if !(min..=max).contains(&found) {
            errors.push(Self { field: field.to_owned(), found, expected: format!("a number from {min} to {max}") });
        }
    }
}
