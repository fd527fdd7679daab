//! The model `view_table` [Elek 2008, "Rendering Planetary Atmospheres in Real-Time"]: its settings, and its formulas in f64.
//!
//! Single scattering along a ray from height h, at angle φ to the zenith, under a sun at angle δ to it, in one plane, without its phase
//! function: a 3-D table whose RGB holds the air of Rayleigh's kind and whose alpha holds the aerosol; the phase functions are asked for
//! every pixel [§3.4]. Beside it a 2-D table of optical depth to the top by height and angle, of which the air between two points is
//! the difference of two entries [eq. 3.9], and a 1-D table of the sky's light on the ground [eq. 3.7]. From outside, the table is asked
//! where the ray enters. Azimuth is in the phase function only: the twilight is the same all around. Further orders are left out
//! (his phase function for air, `elek_rayleigh`, makes up for some).
//!
//! Which layer goes where: those that share a phase function stand together; of these groups the one whose vertical optical depth
//! differs most between channels is in RGB, all others in alpha ([`Split`]). Alpha holds the mean of the channels, dimmed as green is;
//! it gets its colour back from the RGB beside it [Bruneton & Neyret 2008, "Precomputed Atmospheric Scattering", §4], or stays grey as in
//! the thesis ([`AlphaColour`]).
//!
//! Not here: the bakes and the drawing (`shaders/lib/view_table.wgsl`, `render/pass/sky/view_table.rs`); [`Spacing`] is `view_space.rs`.

use super::super::medium::{Layer, Medium, Phase};
use super::super::{RangeError, reference};
use super::view_space::{Spacing, Trapezoid};
use crate::light::occlusion::visible_between;
use core::f64::consts::PI;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Settings of the model `view_table`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ViewTable {
    /// Heights of the 3-D table, 2 … 256.
    pub height_size: u32,
    /// View angles of the 3-D table, even, 4 … 256.
    pub view_size: u32,
    /// Sun angles of the 3-D table, 2 … 256.
    pub sun_size: u32,
    /// Heights of the table of optical depth, 2 … 1024.
    pub depth_height_size: u32,
    /// Angles of the table of optical depth, 2 … 1024.
    pub depth_angle_size: u32,
    /// Sun angles of the table of ambient light, 2 … 1024.
    pub ambient_size: u32,
    /// Trapezoids along a ray of sight, 2 … 500. The thesis: 15 will do, beyond 50 little is gained.
    pub samples: u32,
    /// Trapezoids of an optical depth, 2 … 500.
    pub depth_samples: u32,
    /// Directions of the ambient integral, each way, 2 … 128.
    pub ambient_samples: u32,
    /// How table entries and samples lie: `graded` (default) or `uniform`, the thesis's.
    pub spacing: Spacing,
    /// How alpha gets its colour: `proportional` (default) or `grey`, the thesis's.
    pub alpha_colour: AlphaColour,
}

/// How the light in alpha gets its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AlphaColour {
    /// As the light in RGB beside it is reddened.
    #[default]
    Proportional,
    /// The colour of the particles alone.
    Grey,
}

impl Default for ViewTable {
    fn default() -> Self {
        Self {
            height_size: 32,
            view_size: 128,
            sun_size: 64,
            depth_height_size: 64,
            depth_angle_size: 256,
            ambient_size: 64,
            samples: 50,
            depth_samples: 50,
            ambient_samples: 32,
            spacing: Spacing::Graded,
            alpha_colour: AlphaColour::Proportional,
        }
    }
}

/// Which of a medium's layers are in RGB, and what is in alpha.
#[derive(Clone, Debug, PartialEq)]
pub struct Split {
    /// For each layer, whether it is in RGB; its phase functions are all the same.
    pub in_rgb: Vec<bool>,
    /// Vertical scattering optical depth of RGB per channel.
    pub rgb_depth: DVec3,
    /// Vertical scattering optical depth of alpha per channel.
    pub alpha_depth: DVec3,
    /// Weight of each layer's phase function in alpha, by vertical optical depth; their sum is 1 or, with nothing in alpha, 0.
    pub alpha_weights: Vec<f64>,
}

impl Split {
    /// Of layers in an air up to `top_m`.
    pub fn new(layers: &[Layer], top_m: f64) -> Self {
        let depths: Vec<DVec3> = layers.iter().map(|l| l.scattering_per_m.as_dvec3() * vertical_column_m(l, top_m)).collect();
        let group = |phase: &Phase| layers.iter().zip(&depths).filter(|(l, _)| l.phase == *phase).map(|(_, d)| *d).sum::<DVec3>();
        // Difference between channels decides, then depth, then order in the file.
        let mut chosen: Option<(&Phase, DVec3)> = None;
        for layer in layers {
            let d = group(&layer.phase);
            let key = |d: DVec3| (d.max_element() - d.min_element(), d.max_element());
            if d.max_element() > 0.0 && chosen.is_none_or(|(_, best)| key(d) > key(best)) {
                chosen = Some((&layer.phase, d));
            }
        }
        let in_rgb: Vec<bool> = layers.iter().map(|l| chosen.is_some_and(|(phase, _)| l.phase == *phase)).collect();
        let rgb_depth = chosen.map_or(DVec3::ZERO, |(_, d)| d);
        let in_alpha = |i: usize| !in_rgb.get(i).copied().unwrap_or(false);
        let alpha_depth = depths.iter().enumerate().filter(|(i, _)| in_alpha(*i)).map(|(_, d)| *d).sum::<DVec3>();
        let all = mean(alpha_depth);
        let weight = |(i, d): (usize, &DVec3)| if in_alpha(i) && all > 0.0 { mean(*d) / all } else { 0.0 };
        let alpha_weights = depths.iter().enumerate().map(weight).collect();
        Self { in_rgb, rgb_depth, alpha_depth, alpha_weights }
    }

    /// Colour of what is in alpha: its scattering over the mean of its channels; 1 where there is none.
    pub fn alpha_tint(&self) -> DVec3 {
        let all = mean(self.alpha_depth);
        if all > 0.0 { self.alpha_depth / all } else { DVec3::ONE }
    }

    /// Phase functions of RGB and of alpha, sr⁻¹.
    pub fn phases(&self, layers: &[Layer], cos_theta: f64) -> (f64, f64) {
        let rgb = layers.iter().zip(&self.in_rgb).find(|(_, r)| **r).map_or(0.0, |(l, _)| l.phase.value(cos_theta));
        (rgb, layers.iter().zip(&self.alpha_weights).map(|(l, w)| l.phase.value(cos_theta) * w).sum())
    }
}

/// Integral of a layer's density from the datum to the top, m.
fn vertical_column_m(layer: &Layer, top_m: f64) -> f64 {
    let n = 2000;
    let dh = top_m / f64::from(n);
    (0..n).map(|i| layer.profile.density((f64::from(i) + 0.5) * dh)).sum::<f64>() * dh
}

fn mean(v: DVec3) -> f64 {
    (v.x + v.y + v.z) / 3.0
}

/// Light without its phase functions, per unit of the sun's illuminance: what an entry of the 3-D table holds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Entry {
    /// Of the layers in RGB.
    pub rgb: DVec3,
    /// Of the layers in alpha.
    pub alpha: f64,
}

impl ViewTable {
    /// The thesis's full tables: 256³.
    pub fn full() -> Self {
        Self {
            height_size: 256,
            view_size: 256,
            sun_size: 256,
            spacing: Spacing::Uniform,
            alpha_colour: AlphaColour::Grey,
            ..Self::default()
        }
    }

    /// The thesis's reduced tables: 128³.
    pub fn halved() -> Self {
        Self { height_size: 128, view_size: 128, sun_size: 128, ..Self::full() }
    }

    /// Angular radius of the sun for which the table is made, rad: only the edge of the planet's shadow knows it.
    pub const SUN_RAD: f64 = 0.0047;

    /// Everything that is out of range, all together; empty when all is well.
    pub fn validate(&self) -> Vec<RangeError> {
        let mut e = Vec::new();
        let ranges = [
            ("height_size", self.height_size, 2.0, 256.0),
            ("view_size", self.view_size, 4.0, 256.0),
            ("sun_size", self.sun_size, 2.0, 256.0),
            ("depth_height_size", self.depth_height_size, 2.0, 1024.0),
            ("depth_angle_size", self.depth_angle_size, 2.0, 1024.0),
            ("ambient_size", self.ambient_size, 2.0, 1024.0),
            ("samples", self.samples, 2.0, 500.0),
            ("depth_samples", self.depth_samples, 2.0, 500.0),
            ("ambient_samples", self.ambient_samples, 2.0, 128.0),
        ];
        for (key, found, min, max) in ranges {
            RangeError::check(&mut e, &key, f64::from(found), min, max);
        }
        if self.view_size % 2 != 0 {
            let (found, expected) = (f64::from(self.view_size), "an even number".into());
            e.push(RangeError { field: "view_size".into(), found, expected });
        }
        e
    }

    /// Columns of each layer from height `h_m` along a ray at cosine `mu` to the top of the air, m of density 1: [eq. 3.3] without its
    /// coefficients. A ray that would meet the ground goes on through air of the ground's density, so that entries beside the
    /// horizon are continuous.
    pub fn columns_m(&self, medium: &Medium, h_m: f64, mu: f64) -> Vec<f64> {
        let (r, top) = (medium.bottom_radius_m + h_m, medium.bottom_radius_m + medium.top_altitude_m);
        let end = (-r * mu + (r * r * (mu * mu - 1.0) + top * top).max(0.0).sqrt()).max(0.0);
        let nodes = Trapezoid::new(self.spacing, self.depth_samples, -r * mu, end);
        let densities = |s: f64| -> Vec<f64> {
            let h = along(medium, h_m, mu, s).max(0.0);
            medium.layers.iter().map(|l| l.profile.density(h)).collect()
        };
        let mut sums = vec![0.0; medium.layers.len()];
        let mut from = densities(0.0);
        for (a, b) in nodes.steps() {
            let to = densities(b);
            sums.iter_mut().zip(from.iter().zip(&to)).for_each(|(sum, (x, y))| *sum += 0.5 * (x + y) * (b - a));
            from = to;
        }
        sums
    }

    /// Optical depth of columns, per channel.
    pub fn optical_depth(medium: &Medium, columns_m: &[f64]) -> DVec3 {
        medium.layers.iter().zip(columns_m).map(|(l, c)| (l.scattering_per_m + l.absorption_per_m).as_dvec3() * *c).sum()
    }

    /// Optical depth between two points of a ray, [eq. 3.9]: the difference of two depths to the top along the ray that goes up (backwards
    /// where the ray goes down).
    pub fn depth_between(&self, medium: &Medium, h_m: f64, mu: f64, distance_m: f64) -> DVec3 {
        let there = along(medium, h_m, mu, distance_m);
        let mu_there = ((medium.bottom_radius_m + h_m) * mu + distance_m) / (medium.bottom_radius_m + there);
        let depth = |h, mu| Self::optical_depth(medium, &self.columns_m(medium, h, mu));
        if mu + mu_there < 0.0 { depth(there, -mu_there) - depth(h_m, -mu) } else { depth(h_m, mu) - depth(there, mu_there) }
    }

    /// [Eq. 3.4] without its phase function, in the plane of zenith, sun and ray, by the trapezoid rule.
    pub fn entry(&self, medium: &Medium, split: &Split, h_m: f64, phi: f64, delta: f64) -> Entry {
        let radius = medium.bottom_radius_m;
        let ((sin_phi, mu), (sin_delta, mu_s)) = (libm::sincos(phi), libm::sincos(delta));
        let (r, nu) = (radius + h_m, mu * mu_s + sin_phi * sin_delta);
        let from = DVec3::Z * r;
        let ray = DVec3::new(sin_phi, 0.0, mu);
        let Some(span) = reference::span(medium, from, ray) else { return Entry::default() };
        let end = if h_m <= 0.0 && mu < 0.0 { 0.0 } else { span.far_m };
        let point = |s: f64| {
            let h = along(medium, h_m, mu, s).max(0.0);
            let mu_s = (r * mu_s + s * nu) / (radius + h);
            let horizon = -(h * (2.0 * radius + h)).sqrt() / (radius + h);
            let elevation = libm::asin(mu_s.clamp(-1.0, 1.0)) - libm::asin(horizon);
            let to_sun = Self::optical_depth(medium, &self.columns_m(medium, h, mu_s.max(horizon)));
            let densities: Vec<f64> = medium.layers.iter().map(|l| l.profile.density(h)).collect();
            (densities, exp3(-to_sun), elevation)
        };
        let mut out = Entry::default();
        let mut through = DVec3::ZERO;
        let mut last = point(0.0);
        let mut last_light = self.source(medium, split, &last, through);
        for (a, b) in Trapezoid::new(self.spacing, self.samples, -r * mu, end).steps() {
            let next = point(b);
            let columns: Vec<f64> = last.0.iter().zip(&next.0).map(|(x, y)| 0.5 * (x + y) * (b - a)).collect();
            through += Self::optical_depth(medium, &columns);
            let light = self.source(medium, split, &next, through);
            let lit = 0.5 * (b - a) * visible_between(Self::SUN_RAD, last.2, next.2);
            out.rgb += (last_light.rgb + light.rgb) * lit;
            out.alpha += (last_light.alpha + light.alpha) * lit;
            (last, last_light) = (next, light);
        }
        out
    }

    fn source(&self, medium: &Medium, split: &Split, point: &(Vec<f64>, DVec3, f64), through: DVec3) -> Entry {
        let mut out = Entry::default();
        let kept = point.1 * exp3(-through);
        for ((layer, density), in_rgb) in medium.layers.iter().zip(&point.0).zip(&split.in_rgb) {
            let scattered = layer.scattering_per_m.as_dvec3() * *density;
            if *in_rgb { out.rgb += scattered * kept } else { out.alpha += mean(scattered) * kept.y }
        }
        out
    }

    /// Radiance of an entry under a scattering angle, per unit of the sun's illuminance, sr⁻¹.
    pub fn radiance(&self, medium: &Medium, split: &Split, entry: Entry, cos_theta: f64) -> DVec3 {
        let (rgb, alpha) = split.phases(&medium.layers, cos_theta);
        let mut colour = split.alpha_tint();
        if self.alpha_colour == AlphaColour::Proportional {
            colour *= reddening(entry.rgb, split.rgb_depth);
        }
        entry.rgb * rgb + colour * (entry.alpha * alpha)
    }

    /// [Eq. 3.7], the sky's illuminance on level ground under a sun at angle δ, per unit of the sun's above the air. Here a cosine-weighted
    /// integral over the half sphere (sin φ of the solid angle, which the printed equation leaves out, is in it).
    pub fn ambient(&self, medium: &Medium, split: &Split, delta: f64) -> DVec3 {
        let n = self.ambient_samples;
        let (sin_delta, mu_s) = {
            let (s, c) = libm::sincos(delta);
            (s, c)
        };
        let mut sum = DVec3::ZERO;
        for i in 0..n {
            let phi = (f64::from(i) + 0.5) / f64::from(n) * 0.5 * PI;
            let (sin_phi, mu) = libm::sincos(phi);
            let entry = self.entry(medium, split, 0.0, phi, delta);
            for k in 0..n {
                let omega = (f64::from(k) + 0.5) / f64::from(n) * PI;
                let nu = mu * mu_s + sin_phi * sin_delta * libm::cos(omega);
                sum += self.radiance(medium, split, entry, nu) * (mu * sin_phi);
            }
        }
        sum * (2.0 * PI * 0.5 * PI / (f64::from(n) * f64::from(n)))
    }
}

/// How a ray's light was reddened, over green: light over scattering depth; 1 for channels that say nothing.
fn reddening(light: DVec3, depth: DVec3) -> DVec3 {
    let per = |l: f64, d: f64| if d > 0.0 { l / d } else { 0.0 };
    let green = per(light.y, depth.y);
    let one = |l, d| if green > 1e-12 && d > 0.0 { (per(l, d) / green).min(1e3) } else { 1.0 };
    DVec3::new(one(light.x, depth.x), one(light.y, depth.y), one(light.z, depth.z))
}

/// [Eq. 3.8], what an observer sees of water: the colour of the surface for one who looks down on it, the reflected sky for one who
/// looks along it. `cosine` is that of the view against the normal.
pub fn water(surface: DVec3, reflected: DVec3, cosine: f64) -> DVec3 {
    let alpha = cosine.clamp(0.0, 1.0);
    surface * alpha + reflected * (1.0 - alpha)
}

/// Altitude at a distance along a ray, m.
fn along(medium: &Medium, h_m: f64, mu: f64, s: f64) -> f64 {
    let radius = medium.bottom_radius_m;
    let q = h_m * (2.0 * radius + h_m) + s * (2.0 * (radius + h_m) * mu + s);
    q / (radius + (radius * radius + q).max(0.0).sqrt())
}

fn exp3(v: DVec3) -> DVec3 {
    DVec3::new(libm::exp(v.x), libm::exp(v.y), libm::exp(v.z))
}

#[cfg(test)]
mod tests;
