//! Profiles: density of a layer, relative to its coefficients, against altitude above the datum.
//!
//! Not here: densities in kg/m³ ([`super::super::density`]). The GPU twin is in `shaders/lib/medium.wgsl`.

use super::super::RangeError;
use super::Medium;
use serde::{Deserialize, Serialize};

/// Density of a layer relative to its coefficient, against altitude above the datum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// 1 from `bottom` to `top`, 0 elsewhere. One that begins at the datum or below goes on downwards.
    Constant {
        /// Altitude where it begins, m.
        bottom_m: f32,
        /// Altitude where it ends, m.
        top_m: f32,
    },
    /// Linear between points, 0 outside of them. One that begins at the datum or below keeps its first value downwards.
    Table {
        /// Altitudes, m, rising; two or more.
        altitude_m: Vec<f32>,
        /// Relative density at each.
        density: Vec<f32>,
    },
}

impl Profile {
    /// Points that a table may have.
    pub const MAX_POINTS: usize = 4096;

    /// Relative density at an altitude above the datum, m. Below `−FLOOR_M` it no longer grows.
    pub fn density(&self, altitude_m: f64) -> f64 {
        let h = altitude_m.max(-Medium::FLOOR_M);
        match self {
            Self::Exponential { scale_height_m } => libm::exp(-h / f64::from(*scale_height_m)),
            Self::Tent { bottom_m, peak_m, top_m } => {
                let rise = (h - f64::from(*bottom_m)) / f64::from(peak_m - bottom_m);
                let fall = (f64::from(*top_m) - h) / f64::from(top_m - peak_m);
                rise.min(fall).max(0.0)
            }
            Self::Constant { bottom_m, top_m } => {
                let above = *bottom_m <= 0.0 || h >= f64::from(*bottom_m);
                if above && h < f64::from(*top_m) { 1.0 } else { 0.0 }
            }
            Self::Table { altitude_m, density } => table(altitude_m, density, h),
        }
    }

    /// Altitudes where the profile bends or jumps, m, rising: an integral over it must not step across them.
    pub fn breaks_m(&self) -> Vec<f64> {
        match self {
            Self::Exponential { .. } => Vec::new(),
            Self::Tent { bottom_m, peak_m, top_m } => [*bottom_m, *peak_m, *top_m].map(f64::from).to_vec(),
            Self::Constant { bottom_m, top_m } => {
                if *bottom_m <= 0.0 {
                    vec![f64::from(*top_m)]
                } else {
                    vec![f64::from(*bottom_m), f64::from(*top_m)]
                }
            }
            Self::Table { altitude_m, .. } => altitude_m.iter().map(|h| f64::from(*h)).collect(),
        }
    }

    /// Adds what is out of range; `key` is the name of this profile in the file.
    pub(super) fn check(&self, e: &mut Vec<RangeError>, key: &str) {
        let name = |field: &str| format!("{key}.{field}");
        let floor = -Medium::FLOOR_M;
        match self {
            Self::Exponential { scale_height_m } => {
                RangeError::check(e, &name("scale_height_m"), f64::from(*scale_height_m), 10.0, 1.0e6);
            }
            Self::Tent { bottom_m, peak_m, top_m } => {
                let (bottom, peak) = (f64::from(*bottom_m), f64::from(*peak_m));
                RangeError::check(e, &name("bottom_m"), bottom, floor, 1.0e7);
                RangeError::check(e, &name("peak_m"), peak, bottom + 1.0, 1.0e7);
                RangeError::check(e, &name("top_m"), f64::from(*top_m), peak + 1.0, 1.0e7);
            }
            Self::Constant { bottom_m, top_m } => {
                RangeError::check(e, &name("bottom_m"), f64::from(*bottom_m), floor, 1.0e7);
                RangeError::check(e, &name("top_m"), f64::from(*top_m), f64::from(*bottom_m) + 1.0, 1.0e7);
            }
            Self::Table { altitude_m, density } => {
                points(e, [(&name("altitude_m"), altitude_m), (&name("density"), density)], 2);
                let mut least = floor;
                for (i, h) in altitude_m.iter().enumerate() {
                    RangeError::check(e, &format!("{key}.altitude_m[{i}]"), f64::from(*h), least, 1.0e7);
                    least = f64::from(*h) + 0.01;
                }
                for (i, x) in density.iter().enumerate() {
                    RangeError::check(e, &format!("{key}.density[{i}]"), f64::from(*x), 0.0, 1.0e6);
                }
            }
        }
    }
}

/// Adds an error unless both columns of a table have the same number of points, from `least` to [`Profile::MAX_POINTS`].
pub(super) fn points(e: &mut Vec<RangeError>, columns: [(&str, &[f32]); 2], least: usize) {
    let [(first, x), (second, y)] = columns;
    let mut wrong = |field: &str, found: usize, expected: String| e.push(RangeError { field: field.into(), found: found as f64, expected });
    if !(least..=Profile::MAX_POINTS).contains(&x.len()) {
        wrong(first, x.len(), format!("{least} to {} numbers", Profile::MAX_POINTS));
    } else if x.len() != y.len() {
        wrong(second, y.len(), format!("as many numbers as `{first}` has: {}", x.len()));
    }
}

/// Linear interpolation in a table of altitudes.
fn table(altitude_m: &[f32], density: &[f32], h: f64) -> f64 {
    let at = |i: usize| Some((f64::from(*altitude_m.get(i)?), f64::from(*density.get(i)?)));
    let next = altitude_m.partition_point(|a| f64::from(*a) <= h);
    let Some(last) = next.checked_sub(1) else {
        return at(0).filter(|(first, _)| *first <= 0.0).map_or(0.0, |(_, value)| value);
    };
    match (at(last), at(next)) {
        (Some((a, from)), Some((b, to))) => from + (to - from) * ((h - a) / (b - a)),
        (Some((a, value)), None) if h <= a => value,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_meet_their_named_points() {
        let tent = Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 };
        assert_eq!([9.0e3, 1.0e4, 1.75e4, 2.5e4, 4.0e4, 5.0e4].map(|h| tent.density(h)), [0.0, 0.0, 0.5, 1.0, 0.0, 0.0]);
        let exponential = Profile::Exponential { scale_height_m: 8000.0 };
        assert!((exponential.density(8000.0) - libm::exp(-1.0)).abs() < 1e-15);
        assert_eq!(exponential.density(-1.0e4), exponential.density(-1.0e9));
        let fog = Profile::Constant { bottom_m: 100.0, top_m: 300.0 };
        assert_eq!([99.0, 100.0, 200.0, 300.0].map(|h| fog.density(h)), [0.0, 1.0, 1.0, 0.0]);
        let low = Profile::Constant { bottom_m: 0.0, top_m: 300.0 };
        assert_eq!([-5.0e4, 0.0, 300.0].map(|h| low.density(h)), [1.0, 1.0, 0.0]);
        let table = Profile::Table { altitude_m: vec![0.0, 1000.0, 3000.0], density: vec![1.0, 2.0, 0.5] };
        assert_eq!([-50.0, 0.0, 500.0, 2000.0, 3000.0, 3000.1].map(|h| table.density(h)), [1.0, 1.0, 1.5, 1.25, 0.5, 0.0]);
        let raised = Profile::Table { altitude_m: vec![10.0, 20.0], density: vec![1.0, 1.0] };
        assert_eq!([9.9, 10.0, 15.0].map(|h| raised.density(h)), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_table_that_holds_nothing_is_a_vacuum() {
        let empty = Profile::Table { altitude_m: Vec::new(), density: Vec::new() };
        assert_eq!([empty.density(0.0), empty.density(1e9)], [0.0; 2]);
        let short = Profile::Table { altitude_m: vec![0.0, 1.0], density: vec![1.0] };
        assert_eq!([short.density(0.5), short.density(2.0)], [0.0; 2]);
    }
}
