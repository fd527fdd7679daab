//! Spectra and what the eye makes of them: 216 wavelengths from 350 to 780 nm, the CIE 1931 observer, linear sRGB.
//!
//! [`Spectrum`] holds a value per wavelength; [`Starlight`] is where a star's comes from: the Sun's table, a black body, or a table of one's own. [`difference`] tells how far two
//! colours are apart. White is that of sRGB, D65, everywhere: nothing is adapted to the star, so that sunlight is a little warm and a red
//! dwarf's is red. Not here: spectra of air ([`crate::air::spectral`]), brightness on the screen ([`super::exposure`]).
//!
//! # Citations
//! [CIE 15:2004] "Colorimetry", 3rd edition: the 2° observer, 5 nm. [IEC 61966-2-1] sRGB. [ASTM G173-03] the Sun above the air.
//! [Lindbloom] "RGB/XYZ Matrices": the matrix from the primaries' chromaticities. [Planck 1901].

pub mod difference;
pub mod star;
mod table;

pub use star::Starlight;

use crate::units::{NM, SPEED_OF_LIGHT};
use glam::{DMat3, DVec3};

/// Wavelengths of a [`Spectrum`].
pub const COUNT: usize = 216;
/// Shortest wavelength, nm.
pub const FIRST_NM: f64 = 350.0;
/// Distance of two wavelengths, nm.
pub const STEP_NM: f64 = 2.0;
/// Luminous efficacy of monochromatic light of 540 THz, lm/W (SI, exact).
pub const LUMENS_PER_WATT: f64 = 683.0;
/// Chromaticity x, y of D65, the white of sRGB.
pub const D65: [f64; 2] = [0.3127, 0.3290];

/// Wavelength number `i`, nm.
pub fn wavelength_nm(i: usize) -> f64 {
    FIRST_NM + STEP_NM * i as f64
}

/// A quantity at each wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum(pub [f64; COUNT]);

impl Spectrum {
    /// From a function of the wavelength in nm.
    pub fn of(value: impl Fn(f64) -> f64) -> Self {
        Self(core::array::from_fn(|i| value(wavelength_nm(i))))
    }

    /// The Sun above the air at 1 au, W m⁻² nm⁻¹. [ASTM G173-03]
    pub fn sun() -> Self {
        Self::of(|nm| between_rows(nm, |row| DVec3::splat(table::SUN[row])).x)
    }

    /// A black body's spectral radiance, W m⁻² sr⁻¹ nm⁻¹; 0 where the temperature is not positive. [Planck 1901]
    pub fn black_body(temperature_k: f64) -> Self {
        const PLANCK_J_S: f64 = 6.626_070_15e-34;
        const BOLTZMANN_J_K: f64 = 1.380_649e-23;
        Self::of(|nm| {
            let wavelength_m = nm * NM;
            let x = PLANCK_J_S * SPEED_OF_LIGHT / (wavelength_m * BOLTZMANN_J_K * temperature_k);
            let fifth = wavelength_m * wavelength_m * wavelength_m * wavelength_m * wavelength_m;
            if temperature_k > 0.0 { 2.0 * PLANCK_J_S * SPEED_OF_LIGHT * SPEED_OF_LIGHT / fifth / libm::expm1(x) * NM } else { 0.0 }
        })
    }

    /// This spectrum times a function of the index.
    pub fn times(&self, factor: impl Fn(usize) -> f64) -> Self {
        Self(core::array::from_fn(|i| self.0[i] * factor(i)))
    }

    /// CIE 1931 X, Y, Z in photometric units: lx of W m⁻² nm⁻¹, cd/m² of W m⁻² sr⁻¹ nm⁻¹.
    pub fn xyz(&self) -> DVec3 {
        let sum: DVec3 = self.0.iter().enumerate().map(|(i, value)| observer(wavelength_nm(i)) * *value).sum();
        sum * (LUMENS_PER_WATT * STEP_NM)
    }

    /// Linear sRGB in the same units; negative where the colour lies outside of sRGB.
    pub fn rgb(&self) -> DVec3 {
        rgb_from_xyz() * self.xyz()
    }

    /// Linear sRGB of luminance 1, held to sRGB: the colour of a star. White where the spectrum is dark.
    pub fn colour(&self) -> DVec3 {
        let held = self.rgb().max(DVec3::ZERO);
        let luminance = (xyz_from_rgb() * held).y;
        if luminance > 0.0 && luminance.is_finite() { held / luminance } else { DVec3::ONE }
    }
}

/// Value at `x` of a table whose first column rises: linear between, held beyond the ends; 0 where it is empty.
pub fn linear_at(table: &[(f64, f64)], x: f64) -> f64 {
    match table.iter().position(|p| p.0 >= x) {
        None => table.last().map_or(0.0, |p| p.1),
        Some(0) => table.first().map_or(0.0, |p| p.1),
        Some(i) => {
            let (a, b) = (table[i - 1], table[i]);
            a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)
        }
    }
}

/// x̄, ȳ, z̄ of the CIE 1931 2° observer at a wavelength in nm: cubic between 5 nm, within 0.0024 of the table of 1 nm. [CIE 15:2004]
pub fn observer(wavelength_nm: f64) -> DVec3 {
    between_rows(wavelength_nm, |row| DVec3::from_array(table::OBSERVER[row])).max(DVec3::ZERO)
}

/// Catmull–Rom between the rows of the tables, held at their ends.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn between_rows(nm: f64, row: impl Fn(usize) -> DVec3) -> DVec3 {
    let last = table::ROWS - 1;
    let x = ((nm - table::FIRST_NM) / table::STEP_NM).clamp(0.0, last as f64);
    let i = (x as usize).min(last - 1);
    let t = x - i as f64;
    let [a, b, c, d] = [i.saturating_sub(1), i, i + 1, (i + 2).min(last)].map(row);
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}

/// X, Y, Z of linear sRGB, white having Y = 1. [Lindbloom; IEC 61966-2-1]
pub fn xyz_from_rgb() -> DMat3 {
    let xyz = |[x, y]: [f64; 2]| DVec3::new(x / y, 1.0, (1.0 - x - y) / y);
    let primaries = DMat3::from_cols(xyz([0.64, 0.33]), xyz([0.3, 0.6]), xyz([0.15, 0.06]));
    primaries * DMat3::from_diagonal(primaries.inverse() * xyz(D65))
}

/// Linear sRGB of X, Y, Z.
pub fn rgb_from_xyz() -> DMat3 {
    xyz_from_rgb().inverse()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chromaticity(spectrum: &Spectrum) -> [f64; 2] {
        let xyz = spectrum.xyz();
        [xyz.x / xyz.element_sum(), xyz.y / xyz.element_sum()]
    }

    fn close(found: [f64; 2], expected: [f64; 2], tolerance: f64) {
        assert!((0..2).all(|i| (found[i] - expected[i]).abs() < tolerance), "{found:?}, expected {expected:?}");
    }

    #[test]
    fn the_grid_is_as_asked() {
        assert!(COUNT >= 191);
        assert_eq!((wavelength_nm(0), wavelength_nm(190), wavelength_nm(COUNT - 1)), (350.0, 730.0, 780.0));
    }

    #[test]
    fn black_bodies_lie_on_the_planckian_locus() {
        // CIE illuminant A (2848 K by the constant of 1931, 2855.5 K by today's): x = 0.44757, y = 0.40745. 10,000 K: 0.2807, 0.2884.
        close(chromaticity(&Spectrum::black_body(2855.5)), [0.447_57, 0.407_45], 2e-4);
        close(chromaticity(&Spectrum::black_body(10_000.0)), [0.2807, 0.2884], 4e-4);
        // Equal energy is the observer's own white.
        close(chromaticity(&Spectrum::of(|_| 1.0)), [1.0 / 3.0; 2], 3e-4);
        // Wien: 5772 K peaks at 502 nm.
        let sun = Spectrum::black_body(5772.0).0;
        let peak = (0..COUNT).max_by(|a, b| sun[*a].total_cmp(&sun[*b])).unwrap();
        assert!((wavelength_nm(peak) - 502.04).abs() <= 1.1);
    }

    #[test]
    fn the_sun_is_as_bright_as_measured() {
        // Solar illuminance constant 133.3 klx by the reference spectra [Darula, Kittler & Gueymard 2005: 133.8 klx]; warm of D65.
        let sun = Spectrum::sun();
        let lux = sun.xyz().y;
        assert!((lux / 133.5e3 - 1.0).abs() < 0.01, "{lux}");
        let rgb = sun.colour();
        assert!(rgb.x > 1.0 && rgb.z < 1.0 && (rgb.x - rgb.z) < 0.35, "{rgb}");
        // Its shape is close to that of a black body of its effective temperature.
        let black = Spectrum::black_body(5772.0).colour();
        assert!((rgb - black).abs().max_element() < 0.1, "{rgb} {black}");
    }

    #[test]
    fn matrices_are_those_of_the_standard() {
        // IEC 61966-2-1 to its four digits.
        let published = DMat3::from_cols(
            DVec3::new(3.2406, -0.9689, 0.0557),
            DVec3::new(-1.5372, 1.8758, -0.2040),
            DVec3::new(-0.4986, 0.0415, 1.0570),
        );
        let m = rgb_from_xyz();
        for i in 0..3 {
            assert!((m.col(i) - published.col(i)).abs().max_element() < 5e-4, "{m:?}");
        }
        assert!((xyz_from_rgb() * DVec3::ONE - DVec3::new(0.950_46, 1.0, 1.089_06)).abs().max_element() < 1e-4);
    }

    #[test]
    fn no_spectrum_is_an_error() {
        assert_eq!(Spectrum::black_body(-1.0).colour(), DVec3::ONE);
        assert_eq!(Spectrum::black_body(f64::NAN).colour(), DVec3::ONE);
        assert!(Spectrum::black_body(1.0).colour().is_finite());
        assert!(Spectrum::black_body(1000.0).colour().min_element() >= 0.0);
    }
}
