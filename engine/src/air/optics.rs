//! Optics from physics: what a gas and its aerosol scatter, from the numbers that a handbook gives of them.
//!
//! A [`Gas`] (which molecules, how many of them, how warm) has a Rayleigh scattering coefficient at any wavelength and a scale height;
//! an [`Aerosol`] has an extinction that falls with the wavelength by Ångström's law. A modder writes these where he does not want to
//! write coefficients. Not here: how three numbers are made of a spectrum ([`super::spectral`]), nor what drags ([`super::density`]).
//!
//! # Keys
//! In `atmosphere.toml` each `[[layers]]` has *one* of `gas`, `aerosol`, `absorber` and `table` in place of its coefficients. Numbers in
//! threes hold at `wavelengths_nm` (top of the file; red, green, blue; 680, 550, 440 by default). `profile` and `phase` are as ever, but
//! that a `gas` needs neither: exponential by its scale height, and Rayleigh.
//!
//! | key of `gas` | unit, range | meaning |
//! |---|---|---|
//! | `molecules` | table, name → share by number, > 0 | `air`, `n2`, `o2`, `ar`, `co2`, `h2`, `he`, `ch4`; shares are scaled to sum 1 |
//! | `refractive_index` | 1 or 3 numbers, 1 … 1.1 | in place of `molecules`; three: at the wavelengths red, green, blue. Of the gas at its density at the datum |
//! | `depolarisation` | 0 … 0.5 | with `refractive_index`; 0 by default |
//! | `molecular_density_per_m3` | m⁻³, 1e15 … 1e29 | molecules at the datum; or: |
//! | `pressure_pa` | Pa, 1e-6 … 1e9 | at the datum, an ideal gas at `temperature_k` |
//! | `temperature_k` | K, 1 … 1e4 | needed by `pressure_pa`, and by the scale height where it is not given |
//! | `molar_mass_kg_mol` | kg/mol, 1e-4 … 1 | that of `molecules` by default |
//! | `scale_height_m` | m, 10 … 1e6 | by default `R T / (M g)` with the body's own gravity |
//!
//! | key of `aerosol` | unit, range | meaning |
//! |---|---|---|
//! | `optical_depth` | 0 … 1e3 | of the whole layer, straight up, at 550 nm; or: |
//! | `particle_density_per_m3`, `particle_radius_m`, `efficiency` | m⁻³, m, 0 … 4 | extinction `efficiency · π r² · density` at the datum; 2 by default: spheres far larger than the wavelength |
//! | `angstrom_exponent` | −4 … 4 | extinction ∝ λ^−exponent; 0, grey, by default |
//! | `single_scattering_albedo` | 1 or 3 numbers, 0 … 1 | share that is scattered; three: red, green, blue |
//!
//! `absorber = { species = "ozone", column_du = 300.0 }`: its column straight up in Dobson units (2.687e20 molecules per m²), 0 … 1e5.
//! `table = { wavelengths_nm = […], scattering_per_m = […], absorption_per_m = […] }`: coefficients at density 1, at least two rising wavelengths.
//!
//! # Citations
//! [Bodhaine 1999] Bodhaine, Wood, Dutton & Slusser, "On Rayleigh Optical Depth Calculations", J. Atmos. Oceanic Technol. 16.
//! [Peck & Reeder 1972] "Dispersion of Air", J. Opt. Soc. Am. 62. [Bates 1984] "Rayleigh Scattering by Air", Planet. Space Sci. 32.
//! [Sneep & Ubachs 2005] "Direct Measurement of the Rayleigh Scattering Cross Section in Various Gases", JQSRT 92. [Allen 1973]
//! "Astrophysical Quantities", refraction of gases. [Penndorf 1957] J. Opt. Soc. Am. 47. [Elek 2008] "Rendering Planetary Atmospheres
//! in Real-Time", thesis, Charles University in Prague. [Ångström 1929] Geografiska Annaler 11.

use super::RangeError;
use crate::light::spectrum::linear_at;
use crate::units::NM;
use core::f64::consts::PI;

/// Boltzmann's constant, J/K (SI 2019, exact).
pub const BOLTZMANN_J_K: f64 = 1.380_649e-23;
/// Molar gas constant, J/(mol K) (SI 2019, exact).
pub const GAS_J_MOL_K: f64 = 8.314_462_618_153_24;
/// Molecules per m³ of an ideal gas at 0 °C and 101,325 Pa (Loschmidt).
pub const LOSCHMIDT_PER_M3: f64 = 2.686_780_111e25;
/// Molecules per m³ of an ideal gas at 15 °C and 101,325 Pa.
const STANDARD_15_C_PER_M3: f64 = LOSCHMIDT_PER_M3 * 273.15 / 288.15;

/// A molecule whose refraction is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Molecule {
    /// Dry air with 360 ppm of carbon dioxide.
    Air,
    /// Nitrogen.
    N2,
    /// Oxygen.
    O2,
    /// Argon.
    Ar,
    /// Carbon dioxide.
    Co2,
    /// Hydrogen.
    H2,
    /// Helium.
    He,
    /// Methane.
    Ch4,
}

impl Molecule {
    /// All of them, by the name that a file gives them.
    pub const NAMES: [(&'static str, Self); 8] = [
        ("air", Self::Air),
        ("n2", Self::N2),
        ("o2", Self::O2),
        ("ar", Self::Ar),
        ("co2", Self::Co2),
        ("h2", Self::H2),
        ("he", Self::He),
        ("ch4", Self::Ch4),
    ];

    /// The molecule of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(n, _)| *n == name).map(|(_, m)| *m)
    }

    /// Molar mass, kg/mol.
    pub const fn molar_mass_kg_mol(self) -> f64 {
        match self {
            Self::Air => 0.028_964_7,
            Self::N2 => 0.028_013_4,
            Self::O2 => 0.031_998_8,
            Self::Ar => 0.039_948,
            Self::Co2 => 0.044_009_5,
            Self::H2 => 0.002_015_88,
            Self::He => 0.004_002_602,
            Self::Ch4 => 0.016_042_5,
        }
    }

    /// Refractivity n − 1 at a wavelength, and the density (m⁻³) at which the gas has it.
    fn refractivity(self, wavelength_m: f64) -> (f64, f64) {
        let um = wavelength_m * 1e6;
        let s2 = 1.0 / (um * um);
        // Two terms of Cauchy's series, at 0 °C and one atmosphere [Allen 1973].
        let cauchy = |a: f64, b: f64| (a * (1.0 + b * s2), LOSCHMIDT_PER_M3);
        match self {
            // [Peck & Reeder 1972, as Bodhaine 1999, eq. 4], 15 °C.
            Self::Air => (1e-8 * (8060.51 + 2_480_990.0 / (132.274 - s2) + 17_455.7 / (39.329_57 - s2)), STANDARD_15_C_PER_M3),
            Self::N2 => cauchy(29.06e-5, 7.7e-3),
            Self::O2 => cauchy(26.63e-5, 5.07e-3),
            Self::Ar => cauchy(27.92e-5, 5.6e-3),
            Self::Co2 => cauchy(43.9e-5, 6.4e-3),
            Self::H2 => cauchy(13.58e-5, 7.52e-3),
            Self::He => cauchy(3.48e-5, 2.3e-3),
            // Through the static polarisability 2.593 Å³ and n = 1.000444 at 589 nm.
            Self::Ch4 => cauchy(43.77e-5, 5.0e-3),
        }
    }

    /// King's factor at a wavelength: how much more a molecule scatters than a sphere of the same refraction.
    fn king_factor(self, wavelength_m: f64) -> f64 {
        let um = wavelength_m * 1e6;
        let s2 = 1.0 / (um * um);
        let n2 = 1.034 + 3.17e-4 * s2;
        let o2 = 1.096 + 1.385e-3 * s2 + 1.448e-4 * s2 * s2;
        match self {
            // [Bodhaine 1999, eq. 5, 6, 23 after Bates 1984]
            Self::Air => (78.084 * n2 + 20.946 * o2 + 0.934 + 0.036 * 1.15) / (78.084 + 20.946 + 0.934 + 0.036),
            Self::N2 => n2,
            Self::O2 => o2,
            Self::Ar | Self::He | Self::Ch4 => 1.0,
            // [Sneep & Ubachs 2005, eq. 16]
            Self::Co2 => 1.1364 + 2.53e-3 * s2,
            // [Penndorf 1957, table II]
            Self::H2 => king_factor(0.0221),
        }
    }
}

/// King's factor of a depolarisation ratio for natural light. [King 1923; Bodhaine 1999, eq. 2]
pub fn king_factor(depolarisation: f64) -> f64 {
    (6.0 + 3.0 * depolarisation) / (6.0 - 7.0 * depolarisation)
}

/// Scattering cross-section of a molecule, m²: `24π³ (n²−1)² F / (λ⁴ N² (n²+2)²)` [Bodhaine 1999, eq. 2], where a gas of `density_per_m3`
/// molecules has the refractivity n − 1. Lorentz and Lorenz's (n²+2)² makes it independent of the density at which n is given.
pub fn rayleigh_cross_section_m2(wavelength_m: f64, refractivity: f64, density_per_m3: f64, king: f64) -> f64 {
    let n2_less_1 = refractivity * (2.0 + refractivity);
    let lorentz = n2_less_1 / ((n2_less_1 + 3.0) * density_per_m3);
    let lambda2 = wavelength_m * wavelength_m;
    24.0 * PI * PI * PI * lorentz * lorentz * king / (lambda2 * lambda2)
}

/// Scale height of an isothermal ideal gas, m: `R T / (M g)`.
pub fn scale_height_m(temperature_k: f64, molar_mass_kg_mol: f64, gravity_m_s2: f64) -> f64 {
    GAS_J_MOL_K * temperature_k / (molar_mass_kg_mol * gravity_m_s2)
}

/// What bends light in a gas.
#[derive(Clone, Debug, PartialEq)]
pub enum Refraction {
    /// A mixture: molecules and their shares by number.
    Molecules(Vec<(Molecule, f64)>),
    /// Refractive index of the gas at its own density at the datum.
    Index {
        /// Wavelength (m, rising) and index; one entry: without dispersion.
        index: Vec<(f64, f64)>,
        /// Depolarisation ratio for natural light.
        depolarisation: f64,
    },
}

/// How much gas there is at the datum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// Molecules per m³.
    MolecularDensity(f64),
    /// Pressure, Pa, of an ideal gas.
    Pressure(f64),
}

/// A gas as a handbook describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Gas {
    /// What bends light in it.
    pub refraction: Refraction,
    /// How much of it.
    pub amount: Amount,
    /// Temperature, K; read only where [`Amount::Pressure`] or a missing scale height asks for it.
    pub temperature_k: f64,
    /// kg/mol; `None`: that of the molecules.
    pub molar_mass_kg_mol: Option<f64>,
    /// m; `None`: hydrostatic.
    pub scale_height_m: Option<f64>,
}

impl Gas {
    /// Everything out of range; the keys are those of the file.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        match &self.refraction {
            Refraction::Molecules(parts) => {
                RangeError::check(&mut e, "molecules", parts.iter().map(|p| p.1).sum(), 1e-9, 1e9);
                parts.iter().for_each(|p| RangeError::check(&mut e, "molecules", p.1, 0.0, 1e9));
            }
            Refraction::Index { index, depolarisation } => {
                RangeError::check(&mut e, "refractive_index", index.len() as f64, 1.0, 1000.0);
                index.iter().for_each(|p| RangeError::check(&mut e, "refractive_index", p.1, 1.0, 1.1));
                RangeError::check(&mut e, "depolarisation", *depolarisation, 0.0, 0.5);
            }
        }
        match self.amount {
            Amount::MolecularDensity(n) => RangeError::check(&mut e, "molecular_density_per_m3", n, 1e15, 1e29),
            Amount::Pressure(p) => RangeError::check(&mut e, "pressure_pa", p, 1e-6, 1e9),
        }
        if self.scale_height_m.is_none() || matches!(self.amount, Amount::Pressure(_)) {
            RangeError::check(&mut e, "temperature_k", self.temperature_k, 1.0, 1e4);
        }
        if self.scale_height_m.is_none() {
            RangeError::check(&mut e, "molar_mass_kg_mol", self.molar_mass(), 1e-4, 1.0);
        }
        if let Some(h) = self.scale_height_m {
            RangeError::check(&mut e, "scale_height_m", h, 10.0, 1e6);
        }
        e
    }

    /// Molecules per m³ at the datum.
    pub fn molecular_density_per_m3(&self) -> f64 {
        match self.amount {
            Amount::MolecularDensity(n) => n,
            Amount::Pressure(p) => p / (BOLTZMANN_J_K * self.temperature_k),
        }
    }

    /// kg/mol; NaN where neither the file nor the molecules tell.
    fn molar_mass(&self) -> f64 {
        self.molar_mass_kg_mol.unwrap_or_else(|| match &self.refraction {
            Refraction::Molecules(parts) => {
                let all: f64 = parts.iter().map(|p| p.1).sum();
                parts.iter().map(|(m, share)| m.molar_mass_kg_mol() * share).sum::<f64>() / all
            }
            Refraction::Index { .. } => f64::NAN,
        })
    }

    /// Scale height, m: as given, or hydrostatic under this gravity.
    pub fn scale_height_m(&self, gravity_m_s2: f64) -> f64 {
        self.scale_height_m.unwrap_or_else(|| scale_height_m(self.temperature_k, self.molar_mass(), gravity_m_s2))
    }

    /// Refractivity n − 1 at the datum, at a wavelength in m: each molecule's, by its density [Gladstone & Dale 1863].
    pub fn refractivity(&self, wavelength_m: f64) -> f64 {
        match &self.refraction {
            Refraction::Molecules(parts) => {
                let all: f64 = parts.iter().map(|p| p.1).sum();
                let part = |(m, share): &(Molecule, f64)| share * m.refractivity(wavelength_m).0 / m.refractivity(wavelength_m).1;
                self.molecular_density_per_m3() / all * parts.iter().map(part).sum::<f64>()
            }
            Refraction::Index { index, .. } => index_at(index, wavelength_m) - 1.0,
        }
    }

    /// Rayleigh scattering coefficient at the datum, m⁻¹, at a wavelength in m.
    pub fn scattering_per_m(&self, wavelength_m: f64) -> f64 {
        let density = self.molecular_density_per_m3();
        match &self.refraction {
            Refraction::Molecules(parts) => {
                let all: f64 = parts.iter().map(|p| p.1).sum();
                let part = |(molecule, share): &(Molecule, f64)| {
                    let (refractivity, at_density) = molecule.refractivity(wavelength_m);
                    share * rayleigh_cross_section_m2(wavelength_m, refractivity, at_density, molecule.king_factor(wavelength_m))
                };
                density / all * parts.iter().map(part).sum::<f64>()
            }
            Refraction::Index { index, depolarisation } => {
                density
                    * rayleigh_cross_section_m2(wavelength_m, index_at(index, wavelength_m) - 1.0, density, king_factor(*depolarisation))
            }
        }
    }
}

/// Index at a wavelength: linear in λ⁻², as Cauchy's series is, and held beyond the ends.
fn index_at(index: &[(f64, f64)], wavelength_m: f64) -> f64 {
    let x = |w: f64| -1.0 / (w * w);
    let held = |p: Option<&(f64, f64)>| p.map_or(1.0, |p| p.1);
    match index.iter().position(|p| p.0 >= wavelength_m) {
        Some(0) => held(index.first()),
        Some(i) => {
            let (a, b) = (index[i - 1], index[i]);
            a.1 + (b.1 - a.1) * (x(wavelength_m) - x(a.0)) / (x(b.0) - x(a.0))
        }
        None => held(index.last()),
    }
}

/// How much aerosol there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Optical depth of the whole layer, straight up, at [`Aerosol::REFERENCE_M`].
    OpticalDepth(f64),
    /// Particles at the datum.
    Particles {
        /// m⁻³.
        density_per_m3: f64,
        /// m.
        radius_m: f64,
        /// Extinction cross-section over the geometric one.
        efficiency: f64,
    },
}

/// Dust, droplets or smoke.
#[derive(Clone, Debug, PartialEq)]
pub struct Aerosol {
    /// How much.
    pub load: Load,
    /// Extinction ∝ λ^−exponent; 0 is grey.
    pub angstrom_exponent: f64,
    /// Wavelength (m, rising) and single-scattering albedo; one entry: grey.
    pub single_scattering_albedo: Vec<(f64, f64)>,
}

impl Aerosol {
    /// Wavelength at which the load is given, m.
    pub const REFERENCE_M: f64 = 550.0 * NM;

    /// Everything out of range; the keys are those of the file.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        match self.load {
            Load::OpticalDepth(depth) => RangeError::check(&mut e, "optical_depth", depth, 0.0, 1e3),
            Load::Particles { density_per_m3, radius_m, efficiency } => {
                RangeError::check(&mut e, "particle_density_per_m3", density_per_m3, 0.0, 1e20);
                RangeError::check(&mut e, "particle_radius_m", radius_m, 1e-10, 1e-2);
                RangeError::check(&mut e, "efficiency", efficiency, 0.0, 4.0);
            }
        }
        RangeError::check(&mut e, "angstrom_exponent", self.angstrom_exponent, -4.0, 4.0);
        RangeError::check(&mut e, "single_scattering_albedo", self.single_scattering_albedo.len() as f64, 1.0, 1000.0);
        self.single_scattering_albedo.iter().for_each(|p| RangeError::check(&mut e, "single_scattering_albedo", p.1, 0.0, 1.0));
        e
    }

    /// Scattering and absorption coefficients at density 1, m⁻¹, at a wavelength in m. `depth_m` is the height of air that holds the layer
    /// at density 1 (the scale height of an exponential one): optical depth over it is extinction.
    pub fn coefficients_per_m(&self, wavelength_m: f64, depth_m: f64) -> (f64, f64) {
        let reference = match self.load {
            Load::OpticalDepth(depth) => depth / depth_m,
            Load::Particles { density_per_m3, radius_m, efficiency } => efficiency * PI * radius_m * radius_m * density_per_m3,
        };
        let extinction = reference * libm::pow(wavelength_m / Self::REFERENCE_M, -self.angstrom_exponent);
        let albedo = linear_at(&self.single_scattering_albedo, wavelength_m);
        (extinction * albedo, extinction * (1.0 - albedo))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn air(amount: Amount) -> Gas {
        let refraction = Refraction::Molecules(vec![(Molecule::Air, 1.0)]);
        Gas { refraction, amount, temperature_k: 288.15, molar_mass_kg_mol: None, scale_height_m: None }
    }

    #[test]
    fn air_scatters_as_published() {
        // Cross-sections of dry air with 360 ppm CO2, 1e-28 cm²: the fit that stands for the table within 0.01 % [Bodhaine 1999, eq. 29].
        for um in [0.4_f64, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7] {
            let (s2, l2) = (1.0 / (um * um), um * um);
            let published = 1e-32 * (1.045_599_6 - 341.290_61 * s2 - 0.902_308_50 * l2) / (1.0 + 0.002_705_988_9 * s2 - 85.968_563 * l2);
            let one = air(Amount::MolecularDensity(1.0)).scattering_per_m(um * 1e-6);
            assert!((one / published - 1.0).abs() < 1.5e-4, "{um}: {one} {published}");
        }
        // 15 °C at one atmosphere, 550 nm: 1.149e-2 km⁻¹ [Bucholtz 1995, table 3].
        let beta = air(Amount::Pressure(101_325.0)).scattering_per_m(550e-9);
        assert!((beta / 1.149e-5 - 1.0).abs() < 1e-3, "{beta}");
    }

    #[test]
    fn refractivities_agree_with_other_determinations() {
        // At 0 °C, one atmosphere and a wavelength of 550 nm, from the formulas of others: N2 Peck & Khanna 1966, O2, Ar and CO2 as in
        // [Sneep & Ubachs 2005], H2 Peck & Huang 1977, He Mansfield & Peck 1969; those at 15 °C are scaled by 288.15/273.15.
        let (s2, nu2) = (1.0 / (0.55 * 0.55), 1e8 / (0.55 * 0.55));
        let warm = 288.15 / 273.15;
        let n2 = warm * 1e-8 * (6498.2 + 307.433_5e12 / (1.44e10 - nu2));
        let o2 = 1e-8 * (20_564.8 + 24.808_99e12 / (4.09e9 - nu2));
        let ar = warm * 1e-8 * (6432.135 + 286.060_21e12 / (1.44e10 - nu2));
        let pole = |strength: f64, at: f64| strength / (at * at - nu2);
        let co2 = warm * 1142.7 * (pole(5799.25, 128_908.9) + pole(120.05, 89_223.8) + pole(5.3334, 75_037.5) + pole(4.3244, 67_837.7));
        let h2 = 1e-6 * (14_895.6 / (180.7 - s2) + 4903.7 / (92.0 - s2));
        let he = 0.014_700_91 / (423.98 - s2);
        let all =
            [(Molecule::N2, n2), (Molecule::O2, o2), (Molecule::Ar, ar), (Molecule::Co2, co2), (Molecule::H2, h2), (Molecule::He, he)];
        for (molecule, published) in all {
            let ratio = molecule.refractivity(550e-9).0 / published;
            assert!((ratio - 1.0).abs() < 0.01, "{molecule:?}: {ratio}");
        }
    }

    #[test]
    fn a_mixture_lies_between_its_parts() {
        let mix = |n2, he| {
            let parts = vec![(Molecule::N2, n2), (Molecule::He, he)];
            Gas { refraction: Refraction::Molecules(parts), ..air(Amount::MolecularDensity(1.0)) }.scattering_per_m(550e-9)
        };
        assert!((mix(1.0, 3.0) - (0.25 * mix(1.0, 0.0) + 0.75 * mix(0.0, 1.0))).abs() < 1e-9 * mix(1.0, 0.0));
    }

    /// The constants of [Elek 2008, appendix C].
    const ELEK: [(f64, f64); 3] = [(440e-9, 1.000_275_319), (530e-9, 1.000_274_307), (705e-9, 1.000_271_287)];

    #[test]
    fn elek_s_constants_make_his_planet() {
        let gas = Gas {
            refraction: Refraction::Index { index: ELEK.to_vec(), depolarisation: 0.0 },
            amount: Amount::MolecularDensity(2.653e25),
            temperature_k: f64::NAN,
            molar_mass_kg_mol: None,
            scale_height_m: Some(7994.0),
        };
        assert!(gas.validate().is_empty());
        for (wavelength_m, n) in ELEK {
            // β = 4πK/λ⁴ with K = 2π²(n²−1)²/(3N) [Elek 2008, §3.1]; (n²+2)/3 differs from 1 by 1.8e-4, squared.
            let k = 2.0 * PI * PI * (n * n - 1.0) * (n * n - 1.0) / (3.0 * 2.653e25);
            let beta = 4.0 * PI * k / libm::pow(wavelength_m, 4.0);
            let ratio = gas.scattering_per_m(wavelength_m) / beta;
            assert!((ratio - (1.0 - 3.65e-4)).abs() < 1e-5, "{wavelength_m}: {ratio}");
        }
        // Straight up from his ground: optical depths 0.0297, 0.0951, 0.2015 in red, green, blue.
        let up = [2, 1, 0].map(|i| gas.scattering_per_m(ELEK[i].0) * gas.scale_height_m(9.8));
        for (depth, expected) in up.into_iter().zip([0.029_69, 0.095_04, 0.201_5]) {
            assert!((depth / expected - 1.0).abs() < 1e-3, "{depth} {expected}");
        }
    }

    #[test]
    fn dispersion_lies_between_its_points() {
        assert_eq!(index_at(&ELEK, 300e-9), ELEK[0].1);
        assert_eq!(index_at(&ELEK, 800e-9), ELEK[2].1);
        assert!((index_at(&ELEK, 530e-9) - ELEK[1].1).abs() < 1e-15);
        // Cauchy's own law is met between the points.
        let law = |w: f64| 1.0 + 2.7e-4 * (1.0 + 5e-15 / (w * w));
        let table = [400e-9, 700e-9].map(|w| (w, law(w)));
        assert!((index_at(&table, 550e-9) - law(550e-9)).abs() < 1e-15);
    }

    #[test]
    fn scale_heights_of_three_worlds() {
        // Handbook (NSSDC fact sheets): Earth 8.5 km, Mars 11.1 km, Venus 15.9 km.
        let of = |molecule, temperature_k, gravity| {
            let refraction = Refraction::Molecules(vec![(molecule, 1.0)]);
            Gas { refraction, temperature_k, ..air(Amount::Pressure(1.0)) }.scale_height_m(gravity)
        };
        for (h, km) in
            [(of(Molecule::Air, 288.0, 9.8), 8.5), (of(Molecule::Co2, 215.0, 3.71), 11.1), (of(Molecule::Co2, 737.0, 8.87), 15.9)]
        {
            assert!((h / 1000.0 - km).abs() < 0.25, "{h} {km}");
        }
    }

    #[test]
    fn aerosols_keep_their_depth_and_law() {
        let dust = Aerosol {
            load: Load::OpticalDepth(0.3),
            angstrom_exponent: 1.3,
            single_scattering_albedo: vec![(440e-9, 0.8), (680e-9, 0.98)],
        };
        let total = |w| {
            let (s, a) = dust.coefficients_per_m(w, 1200.0);
            s + a
        };
        assert!((total(550e-9) * 1200.0 - 0.3).abs() < 1e-12);
        assert!((total(440e-9) / total(880e-9) - libm::pow(2.0, 1.3)).abs() < 1e-9);
        let (s, a) = dust.coefficients_per_m(560e-9, 1200.0);
        assert!((s / (s + a) - 0.89).abs() < 1e-12);
        let spheres = Load::Particles { density_per_m3: 1e8, radius_m: 1e-6, efficiency: 2.0 };
        let fog = Aerosol { load: spheres, angstrom_exponent: 0.0, single_scattering_albedo: vec![(550e-9, 1.0)] };
        assert!((fog.coefficients_per_m(400e-9, 1.0).0 - 2.0 * PI * 1e-4).abs() < 1e-12);
        assert_eq!(fog.coefficients_per_m(400e-9, 1.0).1, 0.0);
    }

    #[test]
    fn reports_what_is_out_of_range() {
        let refraction = Refraction::Index { index: vec![(550e-9, 0.9)], depolarisation: 0.7 };
        let bad = Gas { refraction, amount: Amount::Pressure(-1.0), temperature_k: 0.0, molar_mass_kg_mol: None, scale_height_m: None };
        let fields: Vec<_> = bad.validate().into_iter().map(|e| e.field).collect();
        assert_eq!(fields, ["refractive_index", "depolarisation", "pressure_pa", "temperature_k", "molar_mass_kg_mol"]);
    }
}
