//! The medium: the optical layers of one atmosphere. Coefficients in m⁻¹ per linear sRGB channel.
//!
//! Each layer scatters and absorbs in proportion to its density profile. [`MediumSpec`] is what a file holds; a body's radius makes
//! a [`Medium`] of it. Here too are the two functions that light needs, in f64: density and phase. Their GPU twins are in
//! `shaders/lib/medium.wgsl` and `shaders/lib/phase.wgsl`.

use super::RangeError;
use core::f64::consts::PI;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Density of a layer relative to its coefficient, against altitude above the datum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Profile {
    /// `exp(−h / scale_height)`.
    Exponential {
        /// Scale height, m.
        scale_height_m: f32,
    },
    /// A triangle: 0 at `bottom`, 1 at `peak`, 0 at `top`.
    Tent {
        /// Altitude where it begins, m.
        bottom_m: f32,
        /// Altitude of full density, m.
        peak_m: f32,
        /// Altitude where it ends, m.
        top_m: f32,
    },
}

impl Profile {
    /// Relative density at an altitude above the datum, m. Below `−FLOOR_M` it no longer grows.
    pub fn density(&self, altitude_m: f64) -> f64 {
        let h = altitude_m.max(-Medium::FLOOR_M);
        match *self {
            Self::Exponential { scale_height_m } => libm::exp(-h / f64::from(scale_height_m)),
            Self::Tent { bottom_m, peak_m, top_m } => {
                let rise = (h - f64::from(bottom_m)) / f64::from(peak_m - bottom_m);
                let fall = (f64::from(top_m) - h) / f64::from(top_m - peak_m);
                rise.min(fall).max(0.0)
            }
        }
    }
}

/// Phase function of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Phase {
    /// 3/(16π)(1 + cos²θ).
    Rayleigh,
    /// Cornette–Shanks with asymmetry g.
    CornetteShanks {
        /// Asymmetry, −1 < g < 1.
        g: f32,
    },
}

impl Phase {
    /// Value at the cosine of the scattering angle, sr⁻¹; its integral over the sphere is 1.
    pub fn value(&self, cos_theta: f64) -> f64 {
        let c2 = cos_theta * cos_theta;
        match *self {
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + c2),
            // [Cornette & Shanks 1992, eq. 8]
            Self::CornetteShanks { g } => {
                let g = f64::from(g);
                let d = (1.0 + g * g - 2.0 * g * cos_theta).max(1e-9);
                3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + c2) / ((2.0 + g * g) * d * d.sqrt())
            }
        }
    }
}

/// One layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Scattering coefficient at density 1, m⁻¹.
    pub scattering_per_m: Vec3,
    /// Absorption coefficient at density 1, m⁻¹.
    pub absorption_per_m: Vec3,
    /// Density against altitude.
    pub profile: Profile,
    /// Where scattered light goes.
    pub phase: Phase,
}

/// An atmosphere as light sees it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Medium {
    /// Radius of the datum sphere, m.
    pub bottom_radius_m: f64,
    /// Altitude of the top above the datum, m.
    pub top_altitude_m: f64,
    /// Lambert albedo of the ground that the tables assume.
    pub ground_albedo: Vec3,
    /// The layers, at most [`Medium::MAX_LAYERS`].
    pub layers: Vec<Layer>,
}

/// An atmosphere as a file describes it: all of [`Medium`] but the radius, which is the body's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MediumSpec {
    /// Altitude of the top above the datum, m: the air ends here.
    pub top_altitude_m: f64,
    /// Lambert albedo of the ground that lights the air from below, 0 … 1 per channel.
    pub ground_albedo: Vec3,
    /// One to four layers.
    pub layers: Vec<Layer>,
}

impl MediumSpec {
    /// The medium around a datum sphere of this radius, or everything that is out of range.
    pub fn build(&self, bottom_radius_m: f64) -> Result<Medium, Vec<RangeError>> {
        let medium =
            Medium { bottom_radius_m, top_altitude_m: self.top_altitude_m, ground_albedo: self.ground_albedo, layers: self.layers.clone() };
        let errors = medium.validate();
        if errors.is_empty() { Ok(medium) } else { Err(errors) }
    }
}

impl Medium {
    /// Layers a medium may have.
    pub const MAX_LAYERS: usize = 4;
    /// Depth below the datum to which density goes on growing, m: dry basins lie lower than any sea, but not by more.
    pub const FLOOR_M: f64 = 10_000.0;

    /// Everything that is out of range, all together; empty when all is well.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        RangeError::check(&mut e, "radius_m", self.bottom_radius_m, 1.0e3, 1.0e9);
        RangeError::check(&mut e, "top_altitude_m", self.top_altitude_m, 100.0, self.bottom_radius_m.max(100.0));
        let channels = |e: &mut Vec<RangeError>, key: &str, v: Vec3, max: f64| {
            for (channel, x) in v.to_array().into_iter().enumerate() {
                RangeError::check(e, &format!("{key}[{channel}]"), f64::from(x), 0.0, max);
            }
        };
        channels(&mut e, "ground_albedo", self.ground_albedo, 1.0);
        if self.layers.is_empty() || self.layers.len() > Self::MAX_LAYERS {
            let expected = format!("1 to {} layers", Self::MAX_LAYERS);
            e.push(RangeError { field: "layers".into(), found: self.layers.len() as f64, expected });
        }
        for (i, layer) in self.layers.iter().enumerate() {
            channels(&mut e, &format!("layers[{i}].scattering_per_m"), layer.scattering_per_m, 1.0);
            channels(&mut e, &format!("layers[{i}].absorption_per_m"), layer.absorption_per_m, 1.0);
            match layer.profile {
                Profile::Exponential { scale_height_m } => {
                    let key = format!("layers[{i}].profile.scale_height_m");
                    RangeError::check(&mut e, &key, f64::from(scale_height_m), 10.0, 1.0e6);
                }
                Profile::Tent { bottom_m, peak_m, top_m } => {
                    let (bottom, peak) = (f64::from(bottom_m), f64::from(peak_m));
                    RangeError::check(&mut e, &format!("layers[{i}].profile.bottom_m"), bottom, -Self::FLOOR_M, 1.0e7);
                    RangeError::check(&mut e, &format!("layers[{i}].profile.peak_m"), peak, bottom + 1.0, 1.0e7);
                    RangeError::check(&mut e, &format!("layers[{i}].profile.top_m"), f64::from(top_m), peak + 1.0, 1.0e7);
                }
            }
            if let Phase::CornetteShanks { g } = layer.phase {
                RangeError::check(&mut e, &format!("layers[{i}].phase.g"), f64::from(g), -0.98, 0.98);
            }
        }
        e
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The planet `earth` of `sky_radiance_sample.csv` (680, 550, 440 nm in the three channels).
    pub(crate) fn earth() -> Medium {
        let mie = 3.996e-6;
        Medium {
            bottom_radius_m: 6.36e6,
            top_altitude_m: 6.0e4,
            ground_albedo: Vec3::splat(0.1),
            layers: vec![
                Layer {
                    scattering_per_m: Vec3::new(5.802e-6, 13.558e-6, 33.1e-6),
                    absorption_per_m: Vec3::ZERO,
                    profile: Profile::Exponential { scale_height_m: 8000.0 },
                    phase: Phase::Rayleigh,
                },
                Layer {
                    scattering_per_m: Vec3::splat(mie),
                    absorption_per_m: Vec3::splat(4.44e-6 - mie),
                    profile: Profile::Exponential { scale_height_m: 1200.0 },
                    phase: Phase::CornetteShanks { g: 0.8 },
                },
                Layer {
                    scattering_per_m: Vec3::ZERO,
                    absorption_per_m: Vec3::new(0.6497e-6, 1.881e-6, 0.085e-6),
                    profile: Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 },
                    phase: Phase::Rayleigh,
                },
            ],
        }
    }

    #[test]
    fn phase_functions_hold_all_the_light() {
        for phase in [Phase::Rayleigh, Phase::CornetteShanks { g: 0.8 }, Phase::CornetteShanks { g: -0.4 }] {
            let n = 20_000;
            let sum: f64 = (0..n).map(|i| phase.value((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0)).sum();
            let integral = sum * 2.0 / f64::from(n) * 2.0 * PI;
            assert!((integral - 1.0).abs() < 1e-6, "{phase:?}: {integral}");
        }
    }

    #[test]
    fn profiles_meet_their_named_points() {
        let tent = Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 };
        assert_eq!([9.0e3, 1.0e4, 1.75e4, 2.5e4, 4.0e4, 5.0e4].map(|h| tent.density(h)), [0.0, 0.0, 0.5, 1.0, 0.0, 0.0]);
        let exponential = Profile::Exponential { scale_height_m: 8000.0 };
        assert!((exponential.density(8000.0) - libm::exp(-1.0)).abs() < 1e-15);
        assert_eq!(exponential.density(-1.0e4), exponential.density(-1.0e9));
    }

    #[test]
    fn reports_all_bad_values_at_once() {
        let good = earth();
        assert!(good.validate().is_empty());
        let mut layers = good.layers;
        layers[0].scattering_per_m.y = f32::NAN;
        layers[1].phase = Phase::CornetteShanks { g: 1.5 };
        layers[2].profile = Profile::Tent { bottom_m: 10.0, peak_m: 5.0, top_m: 20.0 };
        let spec = MediumSpec { top_altitude_m: -1.0, ground_albedo: Vec3::splat(0.3), layers };
        let fields: Vec<_> = spec.build(6.36e6).unwrap_err().into_iter().map(|e| e.field).collect();
        let expected = ["top_altitude_m", "layers[0].scattering_per_m[1]", "layers[1].phase.g", "layers[2].profile.peak_m"];
        assert_eq!(fields, expected);
        let empty = MediumSpec { top_altitude_m: 1e5, ground_albedo: Vec3::ZERO, layers: Vec::new() };
        assert_eq!(empty.build(6.36e6).unwrap_err()[0].field, "layers");
    }
}
