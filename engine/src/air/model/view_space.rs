//! Where the entries of the tables of `view_table` lie, and the samples of their integrals. Twin of `shaders/lib/view_space.wgsl`.
//!
//! `uniform` is the thesis's: height, angles and samples evenly spaced. `graded` puts entries where light changes: heights by the distance
//! to the horizon, view angles in two halves above and below the horizon with the root of the angle from it, sun angles by the root of
//! the cosine, angles of the optical depth by the distance to the top [Bruneton 2017, "Precomputed Atmospheric Scattering: a New
//! Implementation"], and samples by the root of the distance from a ray's lowest point.
//!
//! Coordinates x run from 0 at the first entry of an axis to 1 at the last. The view axis counts texels instead: its halves are apart,
//! and nothing is interpolated across the horizon.

use core::f64::consts::PI;
use serde::{Deserialize, Serialize};

/// How entries and samples lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    /// Dense at the horizon, the ground and the terminator.
    #[default]
    Graded,
    /// Even in height and angles.
    Uniform,
}

/// The air's two spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shell {
    /// Radius of the datum, m.
    pub radius_m: f64,
    /// Altitude of the top, m.
    pub top_m: f64,
}

impl Shell {
    /// Distance to the horizon from a height, m.
    pub fn horizon_m(&self, h_m: f64) -> f64 {
        let h = h_m.clamp(0.0, self.top_m);
        (h * (2.0 * self.radius_m + h)).sqrt()
    }

    /// Angle of the horizon from the zenith, rad.
    pub fn horizon_rad(&self, h_m: f64) -> f64 {
        0.5 * PI + libm::atan2(self.horizon_m(h_m), self.radius_m)
    }

    /// Least and most distance to the top from a height: straight up, and along the horizon, m.
    fn reaches_m(&self, h_m: f64) -> (f64, f64) {
        let h = h_m.clamp(0.0, self.top_m);
        (self.top_m - h, self.horizon_m(h) + self.horizon_m(self.top_m))
    }
}

impl Spacing {
    /// Height of a coordinate, m.
    pub fn height_m(self, shell: &Shell, x: f64) -> f64 {
        let x = x.clamp(0.0, 1.0);
        if self == Self::Uniform {
            return x * shell.top_m;
        }
        let rho = x * shell.horizon_m(shell.top_m);
        (rho * rho / (shell.radius_m + (shell.radius_m * shell.radius_m + rho * rho).sqrt())).min(shell.top_m)
    }

    /// Coordinate of a height.
    pub fn height_x(self, shell: &Shell, h_m: f64) -> f64 {
        match self {
            Self::Uniform => (h_m / shell.top_m).clamp(0.0, 1.0),
            Self::Graded => shell.horizon_m(h_m) / shell.horizon_m(shell.top_m),
        }
    }

    /// View angle φ of a texel of `size`, rad, and whether the ray meets the ground.
    pub fn view_rad(self, shell: &Shell, h_m: f64, texel: f64, size: u32) -> (f64, bool) {
        let horizon = shell.horizon_rad(h_m);
        if self == Self::Uniform {
            let phi = PI * texel / f64::from(size - 1);
            return (phi, phi > horizon);
        }
        let half = f64::from(size / 2);
        if texel < half {
            let y = 1.0 - texel / (half - 1.0);
            (horizon * (1.0 - y * y), false)
        } else {
            let y = (texel - half) / (half - 1.0);
            (horizon + (PI - horizon) * y * y, true)
        }
    }

    /// Texel of a view angle.
    pub fn view_texel(self, shell: &Shell, h_m: f64, phi: f64, ground: bool, size: u32) -> f64 {
        if self == Self::Uniform {
            return (phi / PI).clamp(0.0, 1.0) * f64::from(size - 1);
        }
        let horizon = shell.horizon_rad(h_m);
        let half = f64::from(size / 2);
        if ground {
            half + ((phi - horizon) / (PI - horizon)).clamp(0.0, 1.0).sqrt() * (half - 1.0)
        } else {
            (1.0 - ((horizon - phi) / horizon).clamp(0.0, 1.0).sqrt()) * (half - 1.0)
        }
    }

    /// Sun angle δ of a coordinate, rad.
    pub fn sun_rad(self, x: f64) -> f64 {
        let x = x.clamp(0.0, 1.0);
        if self == Self::Uniform {
            return PI * x;
        }
        let root = 1.0 - 2.0 * x;
        libm::acos(root * root.abs())
    }

    /// Coordinate of a sun angle.
    pub fn sun_x(self, delta: f64) -> f64 {
        if self == Self::Uniform {
            return (delta / PI).clamp(0.0, 1.0);
        }
        let c = libm::cos(delta);
        0.5 - 0.5 * c.signum() * c.abs().sqrt()
    }

    /// Cosine to the zenith of a coordinate of the table of optical depth, at a height.
    pub fn depth_mu(self, shell: &Shell, h_m: f64, x: f64) -> f64 {
        if self == Self::Uniform {
            return libm::cos(PI * x);
        }
        let (least, most) = shell.reaches_m(h_m);
        let reach = least + x * (most - least);
        let (rho, all) = (shell.horizon_m(h_m), shell.horizon_m(shell.top_m));
        if reach <= 1e-9 * shell.radius_m {
            return 1.0;
        }
        ((all * all - rho * rho - reach * reach) / (2.0 * (shell.radius_m + h_m.clamp(0.0, shell.top_m)) * reach)).clamp(-1.0, 1.0)
    }

    /// Coordinate of a cosine to the zenith in the table of optical depth.
    pub fn depth_x(self, shell: &Shell, h_m: f64, mu: f64) -> f64 {
        if self == Self::Uniform {
            return libm::acos(mu.clamp(-1.0, 1.0)) / PI;
        }
        let (least, most) = shell.reaches_m(h_m);
        let (rho, all) = (shell.horizon_m(h_m), shell.horizon_m(shell.top_m));
        let slope = (shell.radius_m + h_m.clamp(0.0, shell.top_m)) * mu;
        let reach = -slope + (slope * slope + all * all - rho * rho).max(0.0).sqrt();
        if most <= least { 0.0 } else { ((reach - least) / (most - least)).clamp(0.0, 1.0) }
    }
}

/// The ends of the trapezoids along a ray from 0 to `end`.
#[derive(Clone, Copy, Debug)]
pub struct Trapezoid {
    spacing: Spacing,
    count: u32,
    low: f64,
    end: f64,
}

impl Trapezoid {
    /// Of a ray whose lowest point lies `low_m` along it, before its start or after its end too.
    pub fn new(spacing: Spacing, count: u32, low_m: f64, end_m: f64) -> Self {
        Self { spacing, count: count.max(1), low: low_m.clamp(0.0, end_m.max(0.0)), end: end_m.max(0.0) }
    }

    /// The i-th end, m.
    pub fn at(&self, i: u32) -> f64 {
        let x = f64::from(i) / f64::from(self.count);
        if self.spacing == Spacing::Uniform {
            return x * self.end;
        }
        let before = self.low.sqrt();
        let both = before + (self.end - self.low).sqrt();
        let y = x * both - before;
        (self.low + y * y.abs()).clamp(0.0, self.end)
    }

    /// From and to of each.
    pub fn steps(self) -> impl Iterator<Item = (f64, f64)> {
        (1..=self.count).map(move |i| (self.at(i - 1), self.at(i)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHELL: Shell = Shell { radius_m: 6.36e6, top_m: 6.0e4 };

    #[test]
    fn coordinates_and_what_they_stand_for_are_inverses() {
        for spacing in [Spacing::Graded, Spacing::Uniform] {
            for i in 0..=40 {
                let x = f64::from(i) / 40.0;
                let h = spacing.height_m(&SHELL, x);
                assert!((spacing.height_x(&SHELL, h) - x).abs() < 1e-12, "{spacing:?}, height {x}");
                assert!((spacing.sun_x(spacing.sun_rad(x)) - x).abs() < 1e-8, "{spacing:?}, sun {x}");
                for h in [0.0, 3.0, 5.0e3, 6.0e4] {
                    let texel = f64::from(i % 32);
                    let (phi, ground) = spacing.view_rad(&SHELL, h, texel, 32);
                    assert!((spacing.view_texel(&SHELL, h, phi, ground, 32) - texel).abs() < 1e-6, "{spacing:?}, view {texel} at {h} m");
                    // At the top, all that looks up has no way to go.
                    if h < SHELL.top_m || spacing == Spacing::Uniform {
                        let mu = spacing.depth_mu(&SHELL, h, x);
                        assert!((spacing.depth_x(&SHELL, h, mu) - x).abs() < 1e-7, "{spacing:?}, depth {x} at {h} m");
                    }
                }
            }
        }
    }

    #[test]
    fn graded_entries_keep_the_horizon_between_two_texels() {
        for h in [0.0, 1.0, 1.0e3, 6.0e4] {
            let horizon = SHELL.horizon_rad(h);
            assert_eq!(Spacing::Graded.view_rad(&SHELL, h, 15.0, 32), (horizon, false));
            assert_eq!(Spacing::Graded.view_rad(&SHELL, h, 16.0, 32), (horizon, true));
            assert!((Spacing::Graded.view_rad(&SHELL, h, 31.0, 32).0 - PI).abs() < 1e-12);
            assert!(Spacing::Graded.view_rad(&SHELL, h, 0.0, 32).0.abs() < 1e-12);
        }
    }

    #[test]
    fn trapezoids_cover_the_ray() {
        for spacing in [Spacing::Graded, Spacing::Uniform] {
            for low in [-5.0, 0.0, 30.0, 100.0, 200.0] {
                let nodes = Trapezoid::new(spacing, 7, low, 100.0);
                assert!(nodes.at(0).abs() < 1e-9 && (nodes.at(7) - 100.0).abs() < 1e-9, "{spacing:?}, {low}");
                assert!(nodes.steps().all(|(a, b)| b > a), "{spacing:?}, {low}");
            }
        }
    }
}
