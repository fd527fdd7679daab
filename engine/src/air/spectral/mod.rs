//! Air by wavelength, and how it is drawn in three channels or six bands.
//!
//! A [`SpectralMedium`] knows its coefficients at every wavelength: from molecules and dust ([`super::optics`]), from a table, or, where a
//! file gives three numbers, by a power law through them. A frame cannot integrate 216 wavelengths; it draws
//! - `spectrum = "rgb"`: three wavelengths, the best for this air under this star, and a matrix from those to linear sRGB, fitted
//!   once to the integral over all wavelengths ([`Fitting::three`]); or three numbers as a file gives them, for red, green and blue;
//! - `spectrum = "spectral"`: six wavelengths, in two media of three channels each ([`Fitting::six`]).
//!
//! [`rays`] gives the integral itself; [`study`] tells how far each way is from it, in ΔE2000. Not here: light in several scatterings,
//! which is linear in the bands like the first one; what the GPU makes of the bands.

pub mod bands;
mod ozone;
pub mod rays;
pub mod study;

pub use bands::{Bands, Fitting};

use super::RangeError;
use super::medium::{Layer, Medium, Phase, Profile};
use super::optics::{Aerosol, Gas};
use super::refraction::{Refractive, refractivity_of_scattering};
use crate::light::spectrum::{Starlight, linear_at};
use crate::space::relative::narrow3;
use crate::units::NM;
use glam::DVec3;

/// Molecules per m² of one Dobson unit.
const DOBSON_PER_M2: f64 = 2.6868e20;
/// Wavelength whose refraction stands for all, m.
const REFRACTED_M: f64 = 550.0 * NM;
/// Steps of the integral over a layer's height.
const HEIGHT_STEPS: u32 = 512;

/// What a layer is made of.
#[derive(Clone, Debug, PartialEq)]
pub enum Optics {
    /// Three numbers each, red, green, blue, at the medium's [`SpectralMedium::wavelengths_m`]: scattering and absorption, m⁻¹.
    Channels([f64; 3], [f64; 3]),
    /// Rayleigh scattering of a gas.
    Gas(Gas),
    /// Ångström's law.
    Aerosol(Aerosol),
    /// Ozone: column straight up, Dobson units.
    Ozone(f64),
    /// Wavelength (m, rising), scattering and absorption, m⁻¹: linear between, held beyond the ends.
    Table(Vec<[f64; 3]>),
}

/// One layer.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralLayer {
    /// What it is made of.
    pub optics: Optics,
    /// Density against altitude.
    pub profile: Profile,
    /// Where scattered light goes.
    pub phase: Phase,
}

/// An atmosphere by wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralMedium {
    /// Radius of the datum sphere, m.
    pub bottom_radius_m: f64,
    /// Altitude of the top, m.
    pub top_altitude_m: f64,
    /// Lambert albedo of the ground at [`Self::wavelengths_m`].
    pub ground_albedo: [f64; 3],
    /// Wavelengths, m, at which numbers in threes hold: red, green, blue, falling.
    pub wavelengths_m: [f64; 3],
    /// The layers.
    pub layers: Vec<SpectralLayer>,
}

impl SpectralMedium {
    /// Where numbers in threes hold unless a file says otherwise, m.
    pub const WAVELENGTHS_M: [f64; 3] = [680.0 * NM, 550.0 * NM, 440.0 * NM];

    /// How it is drawn under a star: the medium of three channels, and its bands: six where `spectral`, else three, or none where a file gives
    /// the channels themselves; or everything that is out of range.
    pub fn draw(&self, spectral: bool, star: &Starlight) -> Result<(Medium, Option<Box<Bands>>), Vec<RangeError>> {
        let mut errors = self.validate();
        errors.extend(self.medium_at(self.wavelengths_m).validate());
        if !errors.is_empty() {
            return Err(errors);
        }
        let mut sound = self.clone();
        sound.layers.iter_mut().for_each(|l| l.phase = l.phase.normalised());
        let star = star.spectrum();
        if sound.is_channels() && !spectral {
            return Ok((sound.medium_at(sound.wavelengths_m), None));
        }
        let fitting = Fitting::new(&sound, &star);
        let own = if sound.is_channels() { sound.wavelengths_m } else { fitting.best_wavelengths_m() };
        let bands = if spectral { fitting.six() } else { fitting.three() };
        Ok((sound.medium_at(own), Some(Box::new(bands))))
    }

    /// Everything out of range that is not [`Medium::validate`]'s.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        let [red, green, blue] = self.wavelengths_m.map(|w| w / NM);
        RangeError::check(&mut e, "wavelengths_nm[0]", red, green + 1.0, 2000.0);
        RangeError::check(&mut e, "wavelengths_nm[1]", green, blue + 1.0, 2000.0);
        RangeError::check(&mut e, "wavelengths_nm[2]", blue, 100.0, 2000.0);
        for (i, layer) in self.layers.iter().enumerate() {
            let own = match &layer.optics {
                Optics::Channels(scattering, absorption) => validate_channels(scattering, absorption),
                Optics::Gas(gas) => within("gas", gas.validate()),
                Optics::Aerosol(aerosol) => within("aerosol", aerosol.validate()),
                Optics::Ozone(column_du) => {
                    let mut own = Vec::new();
                    RangeError::check(&mut own, "column_du", *column_du, 0.0, 1e5);
                    within("absorber", own)
                }
                Optics::Table(rows) => within("table", validate_table(rows)),
            };
            e.append(&mut within(&format!("layers[{i}]"), own));
        }
        e
    }

    /// Height of air that holds a layer's column at density 1, m.
    fn depth_m(&self, layer: &SpectralLayer) -> f64 {
        let step = self.top_altitude_m / f64::from(HEIGHT_STEPS);
        // Midpoints in √altitude: most air is low.
        (0..HEIGHT_STEPS)
            .map(|i| {
                let u = (f64::from(i) + 0.5) / f64::from(HEIGHT_STEPS);
                layer.profile.density(u * u * self.top_altitude_m) * 2.0 * u * step
            })
            .sum()
    }

    /// Scattering and absorption of one layer at density 1, m⁻¹, at a wavelength in m; what is not a number or negative counts as 0.
    fn layer_at(&self, layer: &SpectralLayer, depth_m: f64, wavelength_m: f64) -> (f64, f64) {
        let (scattering, absorption) = match &layer.optics {
            Optics::Channels(s, a) => (self.through(*s, wavelength_m), self.through(*a, wavelength_m)),
            Optics::Gas(gas) => (gas.scattering_per_m(wavelength_m), 0.0),
            Optics::Aerosol(aerosol) => aerosol.coefficients_per_m(wavelength_m, depth_m),
            Optics::Ozone(column_du) => (0.0, column_du * DOBSON_PER_M2 / depth_m * ozone::cross_section_m2(wavelength_m)),
            Optics::Table(rows) => {
                let column = |k: usize| linear_at(&rows.iter().map(|r| (r[0], r[k])).collect::<Vec<_>>(), wavelength_m);
                (column(1), column(2))
            }
        };
        let sane = |x: f64| if x.is_finite() { x.max(0.0) } else { 0.0 };
        (sane(scattering), sane(absorption))
    }

    /// A curve through three numbers at the medium's wavelengths: a power law on each side where all are positive, else straight and held.
    fn through(&self, rgb: [f64; 3], wavelength_m: f64) -> f64 {
        let [r, g, b] = self.wavelengths_m;
        if let Some(i) = self.wavelengths_m.iter().position(|w| *w == wavelength_m) {
            return rgb[i];
        }
        if rgb.iter().any(|x| *x <= 0.0) {
            return linear_at(&[(b, rgb[2]), (g, rgb[1]), (r, rgb[0])], wavelength_m);
        }
        let side = if wavelength_m < g { (b, rgb[2]) } else { (r, rgb[0]) };
        let exponent = libm::log(side.1 / rgb[1]) / libm::log(side.0 / g);
        rgb[1] * libm::pow(wavelength_m / g, exponent)
    }

    /// Coefficients of all layers at each of some wavelengths.
    pub fn at(&self, wavelengths_m: &[f64]) -> Vec<Coefficients> {
        let depths: Vec<f64> = self.layers.iter().map(|l| self.depth_m(l)).collect();
        let one = |w: &f64| {
            let pairs = self.layers.iter().zip(&depths).map(|(l, depth)| self.layer_at(l, *depth, *w));
            let (scattering, absorption): (Vec<f64>, Vec<f64>) = pairs.unzip();
            let extinction = scattering.iter().zip(&absorption).map(|(s, a)| s + a).collect();
            Coefficients { scattering, extinction }
        };
        wavelengths_m.iter().map(one).collect()
    }

    /// The medium whose three channels are these wavelengths (m).
    pub fn medium_at(&self, wavelengths_m: [f64; 3]) -> Medium {
        let at = self.at(&wavelengths_m);
        let [r, g, b] = self.wavelengths_m;
        let albedo = |w| linear_at(&[(b, self.ground_albedo[2]), (g, self.ground_albedo[1]), (r, self.ground_albedo[0])], w);
        let layers = self.layers.iter().enumerate().map(|(i, layer)| {
            let three = |value: &dyn Fn(&Coefficients) -> f64| narrow3(DVec3::from_array([0, 1, 2].map(|c| value(&at[c]))));
            Layer {
                scattering_per_m: three(&|c| c.scattering[i]),
                absorption_per_m: three(&|c| c.extinction[i] - c.scattering[i]),
                profile: layer.profile.clone(),
                phase: layer.phase.clone(),
            }
        });
        Medium {
            bottom_radius_m: self.bottom_radius_m,
            top_altitude_m: self.top_altitude_m,
            ground_albedo: narrow3(DVec3::from_array(wavelengths_m.map(albedo))),
            layers: layers.collect(),
        }
    }

    /// The sphere and its top alone, without layers.
    pub(crate) fn shape(&self) -> Medium {
        let (bottom_radius_m, top_altitude_m) = (self.bottom_radius_m, self.top_altitude_m);
        Medium { bottom_radius_m, top_altitude_m, ground_albedo: glam::Vec3::ZERO, layers: Vec::new() }
    }

    /// What of it bends light: its gases; of layers by three numbers those that scatter like one.
    pub fn refractive(&self) -> Vec<Refractive> {
        let refractivity = |layer: &SpectralLayer| match &layer.optics {
            Optics::Gas(gas) => Some(gas.refractivity(REFRACTED_M)),
            Optics::Channels(scattering, _) if layer.phase == Phase::Rayleigh => {
                Some(refractivity_of_scattering(self.through(*scattering, REFRACTED_M)))
            }
            _ => None,
        };
        let sound = |l: &SpectralLayer| refractivity(l).filter(|x| x.is_finite() && *x > 0.0).map(|x| (x, l.profile.clone()));
        self.layers.iter().filter_map(sound).map(|(refractivity, profile)| Refractive { refractivity, profile }).collect()
    }

    /// True when every layer is given by three numbers: then they are the channels as they stand.
    pub fn is_channels(&self) -> bool {
        self.layers.iter().all(|l| matches!(l.optics, Optics::Channels(..)))
    }
}

/// The same errors, their fields inside a table.
fn within(table: &str, mut errors: Vec<RangeError>) -> Vec<RangeError> {
    errors.iter_mut().for_each(|e| e.field = format!("{table}.{}", e.field));
    errors
}

fn validate_channels(scattering: &[f64; 3], absorption: &[f64; 3]) -> Vec<RangeError> {
    let mut e = Vec::new();
    for (key, values) in [("scattering_per_m", scattering), ("absorption_per_m", absorption)] {
        for (channel, x) in values.iter().enumerate() {
            RangeError::check(&mut e, &format!("{key}[{channel}]"), *x, 0.0, 1.0);
        }
    }
    e
}

fn validate_table(rows: &[[f64; 3]]) -> Vec<RangeError> {
    let mut e = Vec::new();
    RangeError::check(&mut e, "wavelengths_nm", rows.len() as f64, 2.0, 10_000.0);
    for pair in rows.windows(2) {
        RangeError::check(&mut e, "wavelengths_nm", pair[1][0] / NM, pair[0][0] / NM, 1e5);
    }
    for row in rows {
        RangeError::check(&mut e, "scattering_per_m", row[1], 0.0, 1.0);
        RangeError::check(&mut e, "absorption_per_m", row[2], 0.0, 1.0);
    }
    e
}

/// Coefficients at one wavelength, a number per layer, m⁻¹ at density 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    /// Scattering.
    pub scattering: Vec<f64>,
    /// Scattering and absorption.
    pub extinction: Vec<f64>,
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::optics::{Amount, Load, Molecule, Refraction};
    use super::*;

    pub(crate) fn exponential(scale_height_m: f32) -> Profile {
        Profile::Exponential { scale_height_m }
    }

    /// Clean air at 15 °C, a little haze, 300 DU of ozone.
    pub(crate) fn earth() -> SpectralMedium {
        let gas = Gas {
            refraction: Refraction::Molecules(vec![(Molecule::Air, 1.0)]),
            amount: Amount::Pressure(101_325.0),
            temperature_k: 288.15,
            molar_mass_kg_mol: None,
            scale_height_m: Some(8000.0),
        };
        let haze = Aerosol { load: Load::OpticalDepth(0.0053), angstrom_exponent: 1.3, single_scattering_albedo: vec![(550e-9, 0.9)] };
        let tent = Profile::Tent { bottom_m: 1e4, peak_m: 2.5e4, top_m: 4e4 };
        SpectralMedium {
            bottom_radius_m: 6.371e6,
            top_altitude_m: 1e5,
            ground_albedo: [0.1; 3],
            wavelengths_m: SpectralMedium::WAVELENGTHS_M,
            layers: vec![
                SpectralLayer { optics: Optics::Gas(gas), profile: exponential(8000.0), phase: Phase::Rayleigh },
                SpectralLayer { optics: Optics::Aerosol(haze), profile: exponential(1200.0), phase: Phase::CornetteShanks { g: 0.8 } },
                SpectralLayer { optics: Optics::Ozone(300.0), profile: tent, phase: Phase::Rayleigh },
            ],
        }
    }

    #[test]
    fn columns_are_as_stated() {
        let medium = earth();
        assert!(medium.validate().is_empty());
        // Straight up: the aerosol's own depth, and 300 DU of ozone at its peak.
        let at = &medium.at(&[550e-9, 603e-9]);
        assert!((at[0].extinction[1] * medium.depth_m(&medium.layers[1]) / 0.0053 - 1.0).abs() < 1e-9);
        let ozone = at[1].extinction[2] * 15_000.0;
        assert!((ozone / (300.0 * DOBSON_PER_M2 * ozone::cross_section_m2(603e-9)) - 1.0).abs() < 1e-3, "{ozone}");
        assert!((medium.depth_m(&medium.layers[0]) / (8000.0 * (1.0 - libm::exp(-12.5))) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn three_numbers_make_a_curve_through_them() {
        let medium = earth();
        let lambda4 = [680.0_f64, 550.0, 440.0].map(|nm| 1e6 / (nm * nm * nm * nm));
        for nm in [380.0_f64, 440.0, 500.0, 550.0, 620.0, 680.0, 750.0] {
            let found = medium.through(lambda4, nm * NM);
            assert!((found * nm * nm * nm * nm / 1e6 - 1.0).abs() < 1e-9, "{nm}");
        }
        // With a zero among them it is straight, and held at the ends.
        assert_eq!(medium.through([0.0, 2.0, 1.0], 400e-9), 1.0);
        assert!((medium.through([0.0, 2.0, 1.0], 615e-9) - 1.0).abs() < 1e-9);
        assert_eq!(medium.through([0.0, 2.0, 1.0], 750e-9), 0.0);
    }

    #[test]
    fn reports_faults_by_layer() {
        let mut bad = earth();
        bad.wavelengths_m = [500e-9, 550e-9, 440e-9];
        bad.layers[2].optics = Optics::Ozone(-1.0);
        bad.layers[0].optics = Optics::Table(vec![[500e-9, 1e-5, 0.0], [400e-9, 1e-5, 2.0]]);
        let fields: Vec<_> = bad.validate().into_iter().map(|e| e.field).collect();
        let expected =
            ["wavelengths_nm[0]", "layers[0].table.wavelengths_nm", "layers[0].table.absorption_per_m", "layers[2].absorber.column_du"];
        assert_eq!(fields, expected);
    }
}
