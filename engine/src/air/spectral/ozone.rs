//! Ozone in visible light: the Chappuis band and the foot of the Huggins bands.
//!
//! Absorption cross-sections at 233 K averaged over 10 nm, from the University of Bremen's spectra of 2011 [Gorshelev et al. 2014, "High
//! spectral resolution ozone absorption cross-sections", Atmos. Meas. Tech. 7; Serdyuchenko et al. 2014, same volume].

use crate::units::NM;

/// Middle of the first average, nm; the others follow each 10 nm.
const FIRST_NM: f64 = 365.0;
/// 1e-27 m².
#[rustfmt::skip]
const CROSS_SECTION: [f64; 43] = [
    1.18, 0.2182, 0.2818, 0.6636, 1.527, 2.763, 5.52, 8.451, 15.82, 23.16, 36.69, 49.24, 77.52, 90.16, 148.0, 160.2, 213.9, 275.5,
    309.1, 350.0, 426.6, 467.2, 439.8, 470.1, 501.9, 430.5, 374.0, 321.5, 266.2, 223.8, 185.2, 147.3, 120.9, 94.23, 74.55, 65.66, 51.05,
    41.5, 42.28, 32.37, 24.51, 28.01, 25.34,
];

/// Absorption cross-section of a molecule, m², at a wavelength in m: linear between the averages, held beyond.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn cross_section_m2(wavelength_m: f64) -> f64 {
    let x = ((wavelength_m / NM - FIRST_NM) / 10.0).clamp(0.0, (CROSS_SECTION.len() - 1) as f64);
    let i = (x as usize).min(CROSS_SECTION.len() - 2);
    let (a, b) = (CROSS_SECTION[i], CROSS_SECTION[i + 1]);
    1e-27 * (a + (b - a) * (x - i as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chappuis_band_has_its_peak() {
        // Near 602 nm: 5.1e-25 m² ± 3 %, a hundred times what is left at 420 nm [Gorshelev et al. 2014, fig. 9].
        let peak = cross_section_m2(603e-9);
        assert!((peak / 5.1e-25 - 1.0).abs() < 0.05, "{peak}");
        assert!(cross_section_m2(420e-9) < 0.01 * peak);
        // 300 DU straight up at 600 nm: an optical depth of 0.04.
        assert!((300.0 * 2.6868e20 * cross_section_m2(600e-9) - 0.039).abs() < 0.003);
    }
}
