//! Level layers of an air, as fine as light changes in them.

use super::super::forward::Truncated;
use super::basis::{TERMS, harmonics};
use super::solve::Slab;
use crate::air::{Class, Classes, Medium};
use core::f64::consts::PI;
use glam::DVec3;

/// Layers of a column.
pub const LAYERS: usize = 96;
/// Stretches by whose sums the layers are laid.
const FINE: usize = 1024;
/// Optical depth from either side within which light changes most.
const SKIN: f64 = 0.05;

/// A class of layers, as the streams see it.
pub struct Scattering {
    /// Legendre coefficients of what its forward peak leaves.
    pub chi: [f64; TERMS],
    /// The same of what is drawn: with the peak, blurred as far as the streams tell directions apart.
    pub drawn: [f64; TERMS],
    /// Share that the peak is.
    pub share: f64,
}

impl Scattering {
    /// Of a class.
    pub fn new((class, truncated): &(Class, Truncated)) -> Self {
        /// Midpoints in the angle, dense at both ends.
        const PARTS: i32 = 512;
        let mut chi = [0.0; TERMS];
        for i in 0..PARTS {
            let x = (f64::from(i) + 0.5) / f64::from(PARTS) * PI;
            let (sin, mu) = libm::sincos(0.5 * PI * (1.0 - libm::cos(x)));
            let light = class.value(mu).min(truncated.cap) * sin * libm::sin(x);
            chi.iter_mut().zip(harmonics(0, mu)).for_each(|(sum, p)| *sum += light * p);
        }
        let by = truncated.left / chi[0].max(1e-300);
        let chi = chi.map(|x| x * by);
        // A lobe exp((cos θ − 1) 40), as the orders have it.
        let lobe = |l: usize| libm::exp(-((l * (l + 1)) as f64) / 80.0);
        Self { chi, drawn: core::array::from_fn(|l| chi[l] + truncated.share * lobe(l)), share: truncated.share }
    }
}

/// A layer: coefficients by its height.
#[derive(Clone, Debug)]
struct Part {
    low_m: f64,
    high_m: f64,
    /// Optical depth; the same without the light that goes straight on.
    whole: DVec3,
    depth: DVec3,
    /// What each class scatters but for its peak's: by the Legendre coefficients.
    scattered: [DVec3; Classes::MAX],
}

/// A medium's column.
pub struct Column<'a> {
    /// The medium.
    pub medium: &'a Medium,
    /// Its classes.
    pub classes: Vec<Scattering>,
    parts: Vec<Part>,
}

impl<'a> Column<'a> {
    /// Of a medium with its classes.
    pub fn new(medium: &'a Medium, classes: &[(Class, Truncated)]) -> Self {
        let found: Vec<Scattering> = classes.iter().map(Scattering::new).collect();
        let part = |low_m: f64, high_m: f64| {
            let height = high_m - low_m;
            let mut part = Part { low_m, high_m, whole: DVec3::ZERO, depth: DVec3::ZERO, scattered: [DVec3::ZERO; Classes::MAX] };
            // Two Gauss points.
            for x in [0.211_324_865_405, 0.788_675_134_595] {
                let h = low_m + x * height;
                let extinction = medium.extinction(h) * (0.5 * height);
                part.whole += extinction;
                part.depth += extinction;
                for (((class, _), found), sum) in classes.iter().zip(&found).zip(&mut part.scattered) {
                    let scattered = class.scattering(medium, h) * (0.5 * height);
                    *sum += scattered;
                    part.depth -= scattered * found.share;
                }
            }
            part.depth = part.depth.max(DVec3::ZERO);
            part
        };
        let edges = edges(medium.top_altitude_m, |low, high| part(low, high).depth);
        let parts = edges.windows(2).map(|e| part(e[0], e[1])).collect();
        Self { medium, classes: found, parts }
    }

    /// One channel of its layers, from the ground up.
    pub fn slabs(&self, channel: usize) -> Vec<Slab<{ Classes::MAX }>> {
        let slab = |p: &Part| Slab { depth: p.depth[channel], scattered: p.scattered.map(|s| s[channel]) };
        self.parts.iter().map(slab).collect()
    }

    /// Where an altitude lies between the places at which light is found: the ground, the middles of layers, the top.
    pub fn place(&self, altitude_m: f64) -> (usize, f64) {
        let at = |i: usize| match i {
            0 => self.parts[0].low_m,
            i if i > LAYERS => self.parts[LAYERS - 1].high_m,
            i => 0.5 * (self.parts[i - 1].low_m + self.parts[i - 1].high_m),
        };
        let (mut low, mut high) = (0, LAYERS + 1);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if at(middle) <= altitude_m { low = middle } else { high = middle }
        }
        (low, ((altitude_m - at(low)) / (at(low + 1) - at(low)).max(1e-300)).clamp(0.0, 1.0))
    }

    /// Sunlight at an altitude under a sun of zenith cosine `mu`, across its beams, of 1 above the air: with the light that scattering left going straight on,
    /// and without. The planet's roundness is in its way.
    pub fn sunlight(&self, altitude_m: f64, mu: f64) -> [DVec3; 2] {
        let bottom = self.medium.bottom_radius_m;
        let (slope, q0) = ((bottom + altitude_m) * mu, altitude_m * (2.0 * bottom + altitude_m));
        // Altitude squared of the lowest point, less that of the datum.
        let lowest = q0 - slope * slope;
        if slope < 0.0 && lowest < 0.0 {
            return [DVec3::ZERO; 2];
        }
        // Distance from the lowest point to where the ray leaves a shell.
        let reach = |h: f64| (h * (2.0 * bottom + h) - lowest).max(0.0).sqrt();
        let mut depth = [DVec3::ZERO; 2];
        let from = slope.abs();
        for part in &self.parts {
            if h_above(part, slope, altitude_m) {
                continue;
            }
            let (low, high) = (reach(part.low_m), reach(part.high_m));
            let mut length = (high - low.max(if slope > 0.0 { from } else { 0.0 })).max(0.0);
            if slope < 0.0 {
                // Once more on the way down to the lowest point.
                length += (high.min(from) - low).max(0.0);
            }
            let share = length / (part.high_m - part.low_m);
            depth[0] += part.depth * share;
            depth[1] += part.whole * share;
        }
        depth.map(|d| DVec3::from_array(d.to_array().map(|x| libm::exp(-x))))
    }

    /// The same in each layer, without what has gone on: mean over its height, by channel; and on level ground.
    pub fn beams(&self, mu: f64) -> ([Vec<f64>; 3], DVec3) {
        let ground = self.sunlight(0.0, mu)[0];
        let mut out = [(); 3].map(|()| Vec::with_capacity(LAYERS));
        let mut low = ground;
        for part in &self.parts {
            let high = self.sunlight(part.high_m, mu)[0];
            for (c, out) in out.iter_mut().enumerate() {
                out.push(mean_in_log(low[c], high[c]));
            }
            low = high;
        }
        (out, ground * mu.max(0.0))
    }
}

/// Whether a layer is below all of a ray that rises.
fn h_above(part: &Part, slope: f64, altitude_m: f64) -> bool {
    slope >= 0.0 && part.high_m <= altitude_m
}

/// Altitudes between layers: evenly in the root of altitude, in what light has to cross, and in the logarithm of that from either side.
fn edges(top_m: f64, depth: impl Fn(f64, f64) -> DVec3) -> Vec<f64> {
    let square = |i: usize| top_m * (i as f64 / FINE as f64) * (i as f64 / FINE as f64);
    let depths: Vec<DVec3> = (0..FINE).map(|i| depth(square(i), square(i + 1))).collect();
    let all: DVec3 = depths.iter().sum();
    let weight = all / (0.3 + all);
    let whole = DVec3::from_array(all.to_array().map(|x| 2.0 * libm::log1p(x / SKIN) + 0.5 * x)).max(DVec3::splat(1e-30));
    let mut below = DVec3::ZERO;
    let mut sums = Vec::with_capacity(FINE + 1);
    let mut sum = 0.0;
    sums.push(0.0);
    for d in depths {
        let middle = below + 0.5 * d;
        let skin = d / (SKIN + middle) + d / (SKIN + (all - middle).max(DVec3::ZERO)) + 0.5 * d;
        sum += 0.3 / FINE as f64 + (weight * skin / whole).element_sum() / 3.0;
        sums.push(sum);
        below += d;
    }
    let mut i = 0;
    (0..=LAYERS)
        .map(|k| {
            let at = sum * k as f64 / LAYERS as f64;
            while i + 1 < FINE && sums[i + 1] < at {
                i += 1;
            }
            let part = ((at - sums[i]) / (sums[i + 1] - sums[i]).max(1e-300)).clamp(0.0, 1.0);
            match k {
                0 => 0.0,
                LAYERS => top_m,
                _ => square(i) + (square(i + 1) - square(i)) * part,
            }
        })
        .collect()
}

/// Mean of what falls exponentially from one value to another.
fn mean_in_log(a: f64, b: f64) -> f64 {
    let (a, b) = (a.max(1e-300), b.max(1e-300));
    let ratio = libm::log(a / b);
    if ratio.abs() < 1e-3 { 0.5 * (a + b) } else { (a - b) / ratio }
}
