//! The model `view_table` [Elek 2008, "Rendering Planetary Atmospheres in Real-Time"]: its settings, and its formulas in f64.
//!
//! Single scattering along a ray from height h, at angle φ to the zenith, under a sun at angle δ to it, in one plane, without its phase
//! function: a 3-D table whose RGB holds the air of Rayleigh's kind and whose alpha holds the aerosol; the phase functions are asked for
//! every pixel [§3.4]. Beside it a 2-D table of optical depth to the top by height and angle, of which the air between two points is
//! the difference of two entries [eq. 3.9], and a 1-D table of the sky's light on the ground [eq. 3.7]. From outside, the table is asked
//! where the ray enters. Azimuth is in the phase function only: the twilight is the same all around. Further orders are left out
//! (his phase function for air, `elek_rayleigh`, makes up for some).
//!
//! Which class of the medium goes where: those that share a phase function stand together; of these groups the one whose vertical optical
//! depth differs most between channels is in RGB, all others in alpha ([`Split`]). Alpha holds the mean of the channels, dimmed as green is;
//! it gets its colour back from the RGB beside it [Bruneton & Neyret 2008, "Precomputed Atmospheric Scattering", §4], or stays grey as in
//! the thesis ([`AlphaColour`]).
//!
//! Not here: the bakes and the drawing (`shaders/lib/view_table.wgsl`, `render/pass/sky/view_table.rs`); [`Spacing`] is `view_space.rs`.

use super::super::medium::Medium;
use super::super::medium::classes::{Class, Classes};
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

/// Which of a medium's classes are in RGB, and what is in alpha.
#[derive(Clone, Debug, PartialEq)]
pub struct Split {
    /// The classes; those of the GPU.
    pub classes: Vec<Class>,
    /// For each class, whether it is in RGB; all that are scatter into the same directions.
    pub in_rgb: Vec<bool>,
    /// Vertical scattering optical depth of RGB per channel.
    pub rgb_depth: DVec3,
    /// Vertical scattering optical depth of alpha per channel.
    pub alpha_depth: DVec3,
    /// Weight of each class's phase function in alpha, by vertical optical depth; their sum is 1 or, with nothing in alpha, 0.
    pub alpha_weights: Vec<f64>,
}

impl Split {
    /// Of a medium.
    pub fn new(medium: &Medium) -> Self {
        let classes = Classes::of(medium).list;
        let depths: Vec<DVec3> = classes.iter().map(|c| vertical_depth(medium, c)).collect();
        let alike = |of: &Class| classes.iter().zip(&depths).filter(|(c, _)| c.phases == of.phases).map(|(_, d)| *d).sum::<DVec3>();
        // Difference between channels decides, then depth, then order.
        let mut chosen: Option<(&Class, DVec3)> = None;
        for class in &classes {
            let d = alike(class);
            let key = |d: DVec3| (d.max_element() - d.min_element(), d.max_element());
            if d.max_element() > 0.0 && chosen.is_none_or(|(_, best)| key(d) > key(best)) {
                chosen = Some((class, d));
            }
        }
        let in_rgb: Vec<bool> = classes.iter().map(|c| chosen.is_some_and(|(best, _)| c.phases == best.phases)).collect();
        let rgb_depth = chosen.map_or(DVec3::ZERO, |(_, d)| d);
        let in_alpha = |i: usize| !in_rgb.get(i).copied().unwrap_or(false);
        let alpha_depth = depths.iter().enumerate().filter(|(i, _)| in_alpha(*i)).map(|(_, d)| *d).sum::<DVec3>();
        let all = mean(alpha_depth);
        let weight = |(i, d): (usize, &DVec3)| if in_alpha(i) && all > 0.0 { mean(*d) / all } else { 0.0 };
        let alpha_weights = depths.iter().enumerate().map(weight).collect();
        Self { classes, in_rgb, rgb_depth, alpha_depth, alpha_weights }
    }

    /// Colour of what is in alpha: its scattering over the mean of its channels; 1 where there is none.
    pub fn alpha_tint(&self) -> DVec3 {
        let all = mean(self.alpha_depth);
        if all > 0.0 { self.alpha_depth / all } else { DVec3::ONE }
    }

    /// Phase functions of RGB and of alpha, sr⁻¹.
    pub fn phases(&self, cos_theta: f64) -> (f64, f64) {
        let rgb = self.classes.iter().zip(&self.in_rgb).find(|(_, r)| **r).map_or(0.0, |(c, _)| c.value(cos_theta));
        (rgb, self.classes.iter().zip(&self.alpha_weights).map(|(c, w)| c.value(cos_theta) * w).sum())
    }
}

/// Scattering optical depth of a class from the datum to the top, per channel.
fn vertical_depth(medium: &Medium, class: &Class) -> DVec3 {
    let n = 2000;
    let dh = medium.top_altitude_m / f64::from(n);
    (0..n).map(|i| class.scattering(medium, (f64::from(i) + 0.5) * dh)).sum::<DVec3>() * dh
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
            RangeError::check(&mut e, key, f64::from(found), min, max);
        }
        if !self.view_size.is_multiple_of(2) {
            let (found, expected) = (f64::from(self.view_size), "an even number".into());
            e.push(RangeError { field: "view_size".into(), found, expected });
        }
        e
    }

    /// Optical depth from height `h_m` along a ray at cosine `mu` to the top of the air, per channel [eq. 3.3]. A ray that would meet the
    /// ground goes on through air of the ground's density, so that entries beside the horizon are continuous.
    pub fn depth(&self, medium: &Medium, h_m: f64, mu: f64) -> DVec3 {
        let (r, top) = (medium.bottom_radius_m + h_m, medium.bottom_radius_m + medium.top_altitude_m);
        let end = (-r * mu + (r * r * (mu * mu - 1.0) + top * top).max(0.0).sqrt()).max(0.0);
        let extinction = |s: f64| medium.extinction(along(medium, h_m, mu, s).max(0.0));
        let (mut sum, mut from) = (DVec3::ZERO, extinction(0.0));
        for (a, b) in Trapezoid::new(self.spacing, self.depth_samples, -r * mu, end).steps() {
            let to = extinction(b);
            sum += (from + to) * (0.5 * (b - a));
            from = to;
        }
        sum
    }

    /// Optical depth between two points of a ray, [eq. 3.9]: the difference of two depths to the top along the ray that goes up (backwards
    /// where the ray goes down).
    pub fn depth_between(&self, medium: &Medium, h_m: f64, mu: f64, distance_m: f64) -> DVec3 {
        let there = along(medium, h_m, mu, distance_m);
        let mu_there = ((medium.bottom_radius_m + h_m) * mu + distance_m) / (medium.bottom_radius_m + there);
        if mu + mu_there < 0.0 {
            self.depth(medium, there, -mu_there) - self.depth(medium, h_m, -mu)
        } else {
            self.depth(medium, h_m, mu) - self.depth(medium, there, mu_there)
        }
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
            Point { h, sunlight: exp3(-self.depth(medium, h, mu_s.max(horizon))), elevation }
        };
        let (mut out, mut through) = (Entry::default(), DVec3::ZERO);
        let mut last = point(0.0);
        let mut last_light = source(medium, split, &last, through);
        for (a, b) in Trapezoid::new(self.spacing, self.samples, -r * mu, end).steps() {
            let next = point(b);
            through += (medium.extinction(last.h) + medium.extinction(next.h)) * (0.5 * (b - a));
            let light = source(medium, split, &next, through);
            let lit = 0.5 * (b - a) * visible_between(Self::SUN_RAD, last.elevation, next.elevation);
            out.rgb += (last_light.rgb + light.rgb) * lit;
            out.alpha += (last_light.alpha + light.alpha) * lit;
            (last, last_light) = (next, light);
        }
        out
    }

    /// Radiance of an entry under a scattering angle, per unit of the sun's illuminance, sr⁻¹.
    pub fn radiance(&self, split: &Split, entry: Entry, cos_theta: f64) -> DVec3 {
        let (rgb, alpha) = split.phases(cos_theta);
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
        let (sin_delta, mu_s) = libm::sincos(delta);
        let mut sum = DVec3::ZERO;
        for i in 0..n {
            let phi = (f64::from(i) + 0.5) / f64::from(n) * 0.5 * PI;
            let (sin_phi, mu) = libm::sincos(phi);
            let entry = self.entry(medium, split, 0.0, phi, delta);
            for k in 0..n {
                let omega = (f64::from(k) + 0.5) / f64::from(n) * PI;
                let nu = mu * mu_s + sin_phi * sin_delta * libm::cos(omega);
                sum += self.radiance(split, entry, nu) * (mu * sin_phi);
            }
        }
        sum * (2.0 * PI * 0.5 * PI / (f64::from(n) * f64::from(n)))
    }
}

/// A place on a ray: its height, m; transmittance towards the sun; elevation of the sun's centre above the horizon, rad.
struct Point {
    h: f64,
    sunlight: DVec3,
    elevation: f64,
}

/// Light scattered at a place, per m, dimmed on its way to the eye by the optical depth `through`.
fn source(medium: &Medium, split: &Split, at: &Point, through: DVec3) -> Entry {
    let kept = at.sunlight * exp3(-through);
    let mut out = Entry::default();
    for (class, in_rgb) in split.classes.iter().zip(&split.in_rgb) {
        let scattered = class.scattering(medium, at.h);
        if *in_rgb { out.rgb += scattered * kept } else { out.alpha += mean(scattered) * kept.y }
    }
    out
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
