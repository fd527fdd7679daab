//! From how far scattered light comes: what an eclipse of part of an air does to the light that is scattered more than once.
//!
//! Light that has been scattered before reaches a point from all around. Of what is scattered there, the share `B(d)` has at some hop come
//! further than the distance d along the ground; where the sun's disc is free by V at a place, further orders are dimmed to the mean of
//! V with the weight −dB. In totality nearly all of them come from beyond the umbra: from d of a hundred kilometres and more, where
//! B is a few hundredths.
//!
//! For one hop, from a point at altitude h, `B₁` is the integral over all directions of the light scattered once (and sent back by the ground)
//! from beyond d; λ, the gain, is what of an even source comes back after a hop. A chain of hops goes on with probability λ, each but the first
//! from wherever light is scattered (⟨⟩: the mean over those altitudes), and it has come far as soon as one hop was far:
//! `1 − B(d) = (1 − B₁(d, h)) (1 − λ) / (1 − λ (1 − ⟨B₁(d)⟩))`. The mean over V is taken in a few rings.
//!
//! Left out: directions (light from beyond the umbra is scattered by its own phase function) and that a hop's end is not where the chain's
//! began. Against walks of the reference for Earth's air, `B` is right to a third from 3 to 800 km.

use super::orders::{directions, step_at};
use crate::air::Medium;
use core::f64::consts::PI;
use glam::DVec3;

/// Rings about a point.
pub const RINGS: usize = 4;
/// Values of B, in the mean over channels at h₁, at which rings begin: what is nearer than the first counts as the point itself.
const BEGIN: [f64; RINGS] = [0.5, 0.2, 0.06, 0.015];
/// Steps along a direction.
const STEPS: usize = 32;
/// Of an air's scattering this lies above the altitude h₁.
const ABOVE: f64 = 0.12;
/// Later hops begin at altitudes above which these shares lie.
const LATER: [f64; 3] = [5.0 / 6.0, 0.5, 1.0 / 6.0];
/// Zenith cosines of the sun for which weights are found; in between they go evenly.
pub const SUNS: [f64; 2] = [0.15, 0.75];

/// Rings about a point, the nearest first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Distance of each along the ground, m.
    pub radius_m: [f64; RINGS],
    /// Weight of each at the datum, per channel, for the two suns of [`SUNS`]; the point itself has the rest to 1.
    pub low: [[DVec3; RINGS]; 2],
    /// The same at [`Spread::altitude_m`] and above; x of the way there the share x (1 + x) / 2 of the rise is reached.
    pub high: [[DVec3; RINGS]; 2],
    /// h₁, m.
    pub altitude_m: f64,
}

/// A piece of the surroundings of a point.
struct Piece {
    distance_m: f64,
    /// What of an even source there arrives, of all around.
    arrives: DVec3,
    ground: bool,
    /// Optical depth straight up from there.
    depth: DVec3,
}

/// One hop to a point.
struct Hop {
    /// Distances along the ground, rising, and all that comes from there and beyond.
    light: Vec<(f64, DVec3)>,
    gain: DVec3,
}

impl Hop {
    /// From pieces that lie the farther the later, under a sun of this zenith cosine.
    fn new(pieces: &[Piece], mu: f64) -> Self {
        let mut light = Vec::with_capacity(pieces.len());
        let mut sum = DVec3::ZERO;
        for piece in pieces.iter().rev() {
            let sent = exp(piece.depth / mu) * if piece.ground { mu / PI } else { 0.25 / PI };
            sum += piece.arrives * sent;
            light.push((piece.distance_m, sum));
        }
        light.reverse();
        Self { light, gain: pieces.iter().map(|p| p.arrives).sum() }
    }

    /// Share of the light from beyond a distance.
    fn beyond(&self, distance_m: f64) -> DVec3 {
        let at = self.light.partition_point(|l| l.0 < distance_m);
        let all = self.light.first().map_or(DVec3::ONE, |l| l.1);
        self.light.get(at).map_or(DVec3::ZERO, |l| l.1 / all.max(DVec3::splat(f64::MIN_POSITIVE)))
    }

    /// Where a condition that holds near and not afar ceases to.
    fn where_beyond(&self, holds: impl Fn(f64) -> bool) -> f64 {
        let (mut near, mut far) = (1e-3_f64, self.light.last().map_or(0.0, |l| l.0).max(2e-3));
        for _ in 0..30 {
            let d = (near * far).sqrt();
            if holds(d) { near = d } else { far = d }
        }
        near
    }

    /// Mean distance of the light between two distances.
    fn mean_distance(&self, from_m: f64, to_m: Option<f64>) -> f64 {
        let (mut sum, mut moment) = (0.0, 0.0);
        for pair in self.light.windows(2).filter(|p| p[0].0 >= from_m && to_m.is_none_or(|to| p[0].0 < to)) {
            let here = (pair[0].1 - pair[1].1).element_sum();
            sum += here;
            moment += here * pair[0].0;
        }
        if sum > 0.0 { moment / sum } else { from_m }
    }
}

impl Spread {
    /// Of a medium.
    pub fn new(medium: &Medium) -> Self {
        let sunlight = Sunlight::new(medium);
        let Some(altitude_m) = sunlight.above(ABOVE) else { return Self::default() };
        let mut out = Self { altitude_m, ..Self::default() };
        let paths = [0.0, altitude_m].map(|h| paths(medium, &sunlight, h));
        let later = LATER.map(|share| self::paths(medium, &sunlight, sunlight.above(share).unwrap_or(0.0)));
        let mut begin = [0.0; RINGS];
        for (sun, mu) in SUNS.into_iter().enumerate().rev() {
            let [low, high] = [0, 1].map(|k| Hop::new(&paths[k], mu));
            let later: Vec<Hop> = later.iter().map(|p| Hop::new(p, mu)).collect();
            let mean_of = |of: &dyn Fn(&Hop) -> DVec3| later.iter().map(of).sum::<DVec3>() / LATER.len() as f64;
            let gain = mean_of(&|hop| hop.gain).min(DVec3::splat(0.99));
            let beyond = |first: &Hop, d: f64| {
                let near = (DVec3::ONE - first.beyond(d)) * (DVec3::ONE - gain);
                DVec3::ONE - near / (DVec3::ONE - gain * (DVec3::ONE - mean_of(&|hop| hop.beyond(d))))
            };
            if sun + 1 == SUNS.len() {
                begin = BEGIN.map(|share| high.where_beyond(|d| beyond(&high, d).element_sum() / 3.0 > share));
                out.radius_m = core::array::from_fn(|k| high.mean_distance(begin[k], begin.get(k + 1).copied()));
            }
            for k in 0..RINGS {
                let next = |first: &Hop| begin.get(k + 1).map_or(DVec3::ZERO, |end| beyond(first, *end));
                let inside = |first: &Hop| (beyond(first, begin[k]) - next(first)).max(DVec3::ZERO);
                (out.low[sun][k], out.high[sun][k]) = (inside(&low), inside(&high));
            }
        }
        out
    }
}

/// What of the sun's light comes down to an altitude, and where most of it is scattered.
struct Sunlight {
    /// Optical depth above even steps of the root of altitude over the top.
    depth: Vec<DVec3>,
    top_m: f64,
    /// Scattering above the same, the sum over channels.
    scattered: Vec<f64>,
}

fn coefficients(medium: &Medium, altitude_m: f64) -> (DVec3, DVec3) {
    let mut out = (DVec3::ZERO, DVec3::ZERO);
    for layer in &medium.layers {
        let density = layer.profile.density(altitude_m);
        out.0 += layer.scattering_per_m.as_dvec3() * density;
        out.1 += (layer.scattering_per_m + layer.absorption_per_m).as_dvec3() * density;
    }
    out
}

impl Sunlight {
    const CELLS: usize = 96;

    /// Root of a cell's altitude over the top's.
    fn root(cell: usize) -> f64 {
        cell as f64 / Self::CELLS as f64
    }

    fn new(medium: &Medium) -> Self {
        let top_m = medium.top_altitude_m;
        let altitude = |i: usize| top_m * Self::root(i) * Self::root(i);
        let mut depth = vec![DVec3::ZERO; Self::CELLS + 1];
        let mut scattered = vec![0.0; Self::CELLS + 1];
        for i in (0..Self::CELLS).rev() {
            let (a, b) = (altitude(i), altitude(i + 1));
            let (scattering, extinction) = coefficients(medium, 0.5 * (a + b));
            depth[i] = depth[i + 1] + extinction * (b - a);
            scattered[i] = scattered[i + 1] + scattering.element_sum() * (b - a);
        }
        Self { depth, scattered, top_m }
    }

    /// The altitude above which a share of the scattering lies; `None` where nothing scatters.
    fn above(&self, share: f64) -> Option<f64> {
        let whole = self.scattered[0];
        let at = self.scattered.partition_point(|s| *s > share * whole);
        (whole > 0.0 && whole.is_finite()).then(|| self.top_m * Self::root(at) * Self::root(at))
    }

    /// Optical depth straight up from an altitude.
    fn depth_above(&self, altitude_m: f64) -> DVec3 {
        let x = (altitude_m / self.top_m).clamp(0.0, 1.0).sqrt() * Self::CELLS as f64;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let i = (x as usize).min(Self::CELLS - 1);
        self.depth[i].lerp(self.depth[i + 1], x - i as f64)
    }
}

fn exp(depth: DVec3) -> DVec3 {
    DVec3::from_array(depth.to_array().map(|x| libm::exp(-x)))
}

/// The surroundings of a point, along every direction step by step; by distance.
fn paths(medium: &Medium, sunlight: &Sunlight, from_m: f64) -> Vec<Piece> {
    let (bottom, top) = (medium.bottom_radius_m, medium.top_altitude_m);
    let (r, q0) = (bottom + from_m, from_m * (2.0 * bottom + from_m));
    let albedo = medium.ground_albedo.as_dvec3();
    let mut out = Vec::new();
    let mut put = |distance_m: f64, arrives: DVec3, altitude_m: f64, ground: bool| {
        out.push(Piece { distance_m, arrives, ground, depth: sunlight.depth_above(altitude_m) });
    };
    for direction in directions(medium, from_m) {
        let share = direction.weight / (4.0 * PI);
        let slope = r * direction.cosine;
        let sine = (1.0 - direction.cosine * direction.cosine).max(0.0).sqrt();
        let to_ground = slope * slope - q0;
        let hits = slope < 0.0 && to_ground > 0.0;
        let rest = (top - from_m) * (2.0 * bottom + top + from_m);
        let end = if hits { q0 / (to_ground.sqrt() - slope) } else { rest / ((slope * slope + rest).sqrt() + slope) };
        let low = (-slope).clamp(0.0, end);
        let mut through = DVec3::splat(share);
        for i in 0..STEPS {
            let (from, to) = (step_at(low, end, i as f64 / STEPS as f64), step_at(low, end, (i + 1) as f64 / STEPS as f64));
            let s = 0.5 * (from + to);
            let q = q0 + s * (2.0 * slope + s);
            let h = q / (bottom + (bottom * bottom + q).max(0.0).sqrt());
            let (scattering, extinction) = coefficients(medium, h);
            let kept = exp(extinction * (to - from));
            put(s * sine, scattering / extinction.max(DVec3::splat(f64::MIN_POSITIVE)) * (DVec3::ONE - kept) * through, h, false);
            through *= kept;
        }
        if hits {
            put(end * sine, albedo * through, 0.0, true);
        }
    }
    out.sort_by(|a, b| a.distance_m.total_cmp(&b.distance_m));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::medium::tests::earth;

    #[test]
    fn earth_s_far_light_is_that_of_walks() {
        // Share of the further orders of an eye at 10 km that looks straight up to a sun there, from beyond 12, 50, 100 and 200 km, green: by
        // walks of the reference with a sharp shadow of that radius about the line of sight (to 3 %).
        let medium = earth();
        let sunlight = Sunlight::new(&medium);
        let [first, later] = [15e3, 5e3].map(|h| Hop::new(&paths(&medium, &sunlight, h), 1.0));
        for (d, walked, off) in [(12e3, 0.688, 0.06), (50e3, 0.265, 0.04), (100e3, 0.129, 0.28), (200e3, 0.0500, 0.08)] {
            let gain = later.gain.y;
            let far = 1.0 - (1.0 - first.beyond(d).y) * (1.0 - gain) / (1.0 - gain * (1.0 - later.beyond(d).y));
            assert!((far / walked - 1.0 - off).abs() < 0.05, "{d} m: {far} of {walked}");
        }
        // What a ring is: an average of them all has the share of the first bin's beginning.
        let spread = Spread::new(&medium);
        let all: DVec3 = spread.high[1].iter().copied().sum();
        assert!((all.element_sum() / 3.0 - BEGIN[0]).abs() < 0.02 && spread.radius_m.is_sorted(), "{spread:?}");
    }

    #[test]
    fn odd_media_have_weights() {
        let mut medium = earth();
        for (radius, top, scale) in [(1e3, 1e6, 1.0), (1e8, 100.0, 1e3), (6e6, 1e5, 0.0), (6e6, 1e5, 1e4), (1e3, 100.0, 1e-9)] {
            (medium.bottom_radius_m, medium.top_altitude_m) = (radius, top);
            medium.layers.iter_mut().for_each(|l| l.scattering_per_m *= scale);
            let spread = Spread::new(&medium);
            for weights in [spread.low, spread.high].into_iter().flatten() {
                let sum: DVec3 = weights.iter().copied().sum();
                assert!(weights.iter().all(|w| w.is_finite() && w.min_element() >= 0.0) && sum.max_element() <= 1.0 + 1e-9, "{spread:?}");
            }
            assert!(spread.radius_m.iter().all(|r| r.is_finite()));
            medium.layers.iter_mut().for_each(|l| l.scattering_per_m /= scale.max(1e-9));
        }
    }
}
