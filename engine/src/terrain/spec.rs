//! What a modder writes about a body's ground: the `[relief]` table of a body's file. Every key carries its unit.
//!
//! Not here: how the keys become a height ([`super::relief`]), nor where map files are looked up (the game's assets).

use super::relief::ReliefError;
use serde::{Deserialize, Serialize};

/// How the ground looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ground {
    /// Rock of the body's albedo, Lambert's law.
    #[default]
    Rock,
    /// Airless dust: as bright at the limb as at the centre (Lommel–Seeliger).
    Regolith,
    /// Grass, rock, sand and snow by latitude, height and slope.
    Living,
    /// Ice of the body's albedo.
    Ice,
}

/// Fractal noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseSpec {
    /// Longest wavelength, m.
    pub wavelength_m: f64,
    /// Amplitude at the longest wavelength where the ground is rough, m.
    pub amplitude_m: f64,
    /// Amplitude where it is smooth (plains, sea floor, maria), m.
    pub plain_amplitude_m: f64,
    /// Amplitude of an octave over that of the one before, 0 … 0.7.
    pub gain: f64,
    /// 0: rounded hills, 1: sharp ridges.
    pub ridged: f64,
    /// Another number, another landscape.
    pub seed: u32,
}

/// Impact craters; each octave has 0.71 times the size and twice the number of the one before (cumulative slope −2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CraterSpec {
    /// Radius of the largest, m.
    pub largest_radius_m: f64,
    /// Radius of the smallest, m; at least 1.
    pub smallest_radius_m: f64,
    /// Share of places for a crater that have one, 0 … 1.
    pub density: f64,
    /// Depth over diameter of a fresh simple crater (Moon: 0.2).
    pub depth_ratio: f64,
    /// Radius above which craters have flat floors and grow no deeper in proportion, m (Moon: 7,500).
    pub complex_radius_m: f64,
    /// Another number, other craters.
    pub seed: u32,
}

/// Large dark, low, smooth provinces (maria) among bright, rough ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProvinceSpec {
    /// Size, m.
    pub wavelength_m: f64,
    /// How far the low ones lie below the others, m.
    pub depth_m: f64,
    /// Share of the surface that is low, about, 0 … 1.
    pub share: f64,
    /// Albedo of the low ones over that of the others.
    pub albedo_ratio: f64,
    /// Another number, other provinces.
    pub seed: u32,
}

/// The ground of one body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReliefSpec {
    /// How it looks.
    #[serde(default)]
    pub ground: Ground,
    /// True when everything below the datum is under water.
    #[serde(default)]
    pub water: bool,
    /// File of a cube map of heights above the datum (`.cube`), beside the body's file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<String>,
    /// File of a cube map of the distance to the coast, m, positive on land (`.cube`); needs `water`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coast: Option<String>,
    /// File of a picture of the body's colour, equirectangular, longitude −180° at the left, north up (drawn by the renderer).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
    /// The same of its lights at night.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub night: Option<String>,
    /// Fractal detail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseSpec>,
    /// Craters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub craters: Option<CraterSpec>,
    /// Maria and the like.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provinces: Option<ProvinceSpec>,
}

impl ReliefSpec {
    /// Checks every range and tells all that is wrong at once.
    ///
    /// # Errors
    /// [`ReliefError::Ranges`] with one line for every key out of range.
    pub fn check(&self) -> Result<(), ReliefError> {
        let mut wrong = Vec::new();
        let mut range = |key: &str, value: f64, low: f64, high: f64| {
            if !(low..=high).contains(&value) {
                wrong.push(format!("relief.{key} = {value}: expected {low} … {high}"));
            }
        };
        if let Some(n) = &self.noise {
            range("noise.wavelength_m", n.wavelength_m, 4.0, 1e7);
            range("noise.amplitude_m", n.amplitude_m, 0.0, 20_000.0);
            range("noise.plain_amplitude_m", n.plain_amplitude_m, 0.0, 20_000.0);
            range("noise.gain", n.gain, 0.0, 0.7);
            range("noise.ridged", n.ridged, 0.0, 1.0);
        }
        if let Some(c) = &self.craters {
            range("craters.largest_radius_m", c.largest_radius_m, 1.0, 1e6);
            range("craters.smallest_radius_m", c.smallest_radius_m, 1.0, c.largest_radius_m.max(1.0));
            range("craters.density", c.density, 0.0, 1.0);
            range("craters.depth_ratio", c.depth_ratio, 0.0, 0.5);
            range("craters.complex_radius_m", c.complex_radius_m, 1.0, 1e7);
        }
        if let Some(p) = &self.provinces {
            range("provinces.wavelength_m", p.wavelength_m, 1000.0, 1e8);
            range("provinces.depth_m", p.depth_m, 0.0, 20_000.0);
            range("provinces.share", p.share, 0.0, 1.0);
            range("provinces.albedo_ratio", p.albedo_ratio, 0.05, 20.0);
        }
        if self.coast.is_some() && !(self.water && self.map.is_some()) {
            wrong.push("relief.coast: needs `water = true` and a `map`".to_owned());
        }
        if wrong.is_empty() { Ok(()) } else { Err(ReliefError::Ranges(wrong.join("\n"))) }
    }
}
