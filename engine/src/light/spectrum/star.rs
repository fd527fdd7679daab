//! A star's light: which spectrum, and its colour.
//!
//! Brightness is the file's ([`super::super::sun`]). White is D65: the Sun comes out a little warm, 1.10, 0.98, 0.94.

use super::Spectrum;
use crate::space::relative::narrow3;
use glam::Vec3;

/// Where a star's spectrum comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Starlight {
    /// The Sun's, tabulated.
    #[default]
    Sun,
    /// A black body of this temperature, K.
    BlackBody(f64),
    /// Wavelength (nm, rising) and irradiance on any scale: linear between, held beyond the ends.
    Table(Vec<(f64, f64)>),
}

impl Starlight {
    /// The spectrum, on any scale.
    pub fn spectrum(&self) -> Spectrum {
        match self {
            Self::Sun => Spectrum::sun(),
            Self::BlackBody(temperature_k) => Spectrum::black_body(*temperature_k),
            Self::Table(rows) => Spectrum::of(|nm| super::linear_at(rows, nm)),
        }
    }

    /// Linear sRGB of luminance 1.
    pub fn colour(&self) -> Vec3 {
        narrow3(self.spectrum().colour())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_are_as_warm_as_they_are() {
        let [m, sun, a] = [Starlight::BlackBody(3000.0), Starlight::Sun, Starlight::BlackBody(9900.0)].map(|s| s.colour());
        assert!(m.x > 1.5 && m.z < 0.5 && a.x < 0.95 && a.z > 1.2, "{m} {a}");
        assert!((sun - Vec3::new(1.097, 0.977, 0.943)).abs().max_element() < 2e-3, "{sun}");
        // A table of the Sun's values is the Sun.
        let rows = (0..super::super::COUNT).map(|i| (super::super::wavelength_nm(i), Spectrum::sun().0[i])).collect();
        assert!((Starlight::Table(rows).colour() - sun).abs().max_element() < 1e-6);
        assert_eq!(Starlight::Table(Vec::new()).colour(), Vec3::ONE);
    }
}
