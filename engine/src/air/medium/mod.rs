//! The medium: the optical layers of one atmosphere. Coefficients in m⁻¹ per linear sRGB channel.
//!
//! Each layer scatters and absorbs in proportion to its density profile. [`MediumSpec`] is what a file holds; a body's radius makes
//! a [`Medium`] of it. [`profile`] is density against altitude, [`phase`] where scattered light goes; both in f64.
//! [`classes`] is what the GPU sees of it.

pub mod classes;
pub mod phase;
pub mod profile;

use super::RangeError;
use glam::Vec3;
use serde::{Deserialize, Serialize};

pub use classes::{Class, Classes};
pub use phase::Phase;
pub use profile::Profile;

/// One layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// The layers, any number; none is a vacuum.
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
    /// The layers, any number.
    pub layers: Vec<Layer>,
}

impl MediumSpec {
    /// The medium around a datum sphere of this radius, or everything that is out of range.
    pub fn build(&self, bottom_radius_m: f64) -> Result<Medium, Vec<RangeError>> {
        let mut medium =
            Medium { bottom_radius_m, top_altitude_m: self.top_altitude_m, ground_albedo: self.ground_albedo, layers: self.layers.clone() };
        let errors = medium.validate();
        medium.layers.iter_mut().for_each(|l| l.phase = l.phase.normalised());
        if errors.is_empty() { Ok(medium) } else { Err(errors) }
    }
}

impl Medium {
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
        for (i, layer) in self.layers.iter().enumerate() {
            channels(&mut e, &format!("layers[{i}].scattering_per_m"), layer.scattering_per_m, 1.0);
            channels(&mut e, &format!("layers[{i}].absorption_per_m"), layer.absorption_per_m, 1.0);
            layer.profile.check(&mut e, &format!("layers[{i}].profile"));
            layer.phase.check(&mut e, &format!("layers[{i}].phase"));
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
    }

    #[test]
    fn any_number_of_layers_will_do() {
        let none = MediumSpec { top_altitude_m: 1e5, ground_albedo: Vec3::ZERO, layers: Vec::new() };
        assert!(none.build(6.36e6).is_ok());
        let many = MediumSpec { layers: earth().layers.into_iter().cycle().take(40).collect(), ..none };
        assert_eq!(many.build(6.36e6).unwrap().layers.len(), 40);
    }

    #[test]
    fn tables_are_checked_point_by_point_and_scaled() {
        let layer = |altitude_m: &[f32], density: &[f32], angle_deg: &[f32], value: &[f32]| Layer {
            scattering_per_m: Vec3::splat(1e-5),
            absorption_per_m: Vec3::ZERO,
            profile: Profile::Table { altitude_m: altitude_m.to_vec(), density: density.to_vec() },
            phase: Phase::Table { angle_deg: angle_deg.to_vec(), value: value.to_vec() },
        };
        let build = |layer| MediumSpec { top_altitude_m: 1e5, ground_albedo: Vec3::ZERO, layers: vec![layer] }.build(6.36e6);
        let medium = build(layer(&[0.0, 5.0], &[1.0, 0.0], &[0.0, 180.0], &[3.0, 3.0])).unwrap();
        assert!((medium.layers[0].phase.value(0.3) * 4.0 * core::f64::consts::PI - 1.0).abs() < 1e-6);
        let fields = |layer| -> Vec<String> { build(layer).unwrap_err().into_iter().map(|e| e.field).collect() };
        let wrong = fields(layer(&[0.0, 0.0], &[1.0, -1.0], &[0.0, 190.0], &[f32::NAN, 1.0]));
        let expected = ["profile.altitude_m[1]", "profile.density[1]", "phase.angle_deg[1]", "phase.value[0]"];
        assert_eq!(wrong, expected.map(|f| format!("layers[0].{f}")));
        assert_eq!(fields(layer(&[0.0], &[1.0], &[0.0, 90.0], &[1.0])), ["layers[0].profile.altitude_m", "layers[0].phase.value"]);
        assert_eq!(fields(layer(&[0.0, 1.0], &[1.0, 1.0], &[0.0, 90.0], &[0.0, 0.0])), ["layers[0].phase.value"]);
    }
}
