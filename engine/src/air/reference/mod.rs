//! Truth in f64: what a ray through an air brings, to a stated error, by no table that anything else uses.
//!
//! [`single`] is adaptive quadrature; the orders beyond are walks traced backwards from the ray ([`walk`], begun in [`first`]), as many as
//! the wanted error needs, each reproducible from a seed whatever the number of threads. [`space`] is what they walk through,
//! [`chords`] the optical depths of the walks' flights (not used by single scattering). Not fast, and not used while playing: it judges the
//! models and their tables.
//!
//! Definitions are those of the reference data: the sun is a uniform disc at infinity; direct light at a point is scaled by the
//! fraction of the disc above the straight local horizon and outside of every occluder; transmittance is taken towards the disc's centre, held
//! at the horizon; scattering angles count from the disc's centre. The ground is a Lambert sphere; ground that is seen directly, and the
//! sun itself, add nothing to the radiance. No refraction (but in [`umbra`], the light in a planet's shadow), no polarisation. An eye at or below the datum stands on the ground.

mod chords;
mod first;
mod quadrature;
mod random;
mod scatter;
pub mod single;
mod space;
pub mod umbra;
mod walk;

use super::medium::Medium;
use first::{STRATA, Starts};
use glam::DVec3;
use random::{Draw, Random, Sequence};
use rayon::prelude::*;
use space::{Light, Space, exp3, ground_under};
use walk::{Glow, Walk, upward};

pub use single::{optical_depth, transmittance_to_top};
pub use space::{Span, Sphere, span};

/// Walks of one batch, and batches that are made before the error is looked at again, unless fewer are allowed.
const BATCH: u32 = 512;
const ROUND: u64 = 16;

/// A ray of sight.
#[derive(Clone, Debug, PartialEq)]
pub struct Ray {
    /// The eye, m from the body's centre.
    pub from_m: DVec3,
    /// Unit vector of sight.
    pub direction: DVec3,
    /// Unit vector to the sun.
    pub sun: DVec3,
    /// Angular radius of the sun, rad.
    pub sun_rad: f64,
    /// What may hide the sun from any part of the air.
    pub occluders: Vec<Sphere>,
}

impl Ray {
    fn light(&self) -> Light<'_> {
        Light { sun: self.sun, sun_rad: self.sun_rad.max(1e-9), occluders: &self.occluders }
    }
}

/// How good the answer must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Standard error wanted, relative to the radiance of all orders, in every channel.
    pub rel_error: f64,
    /// Standard error that is good enough whatever the radiance is, sr⁻¹.
    pub abs_error: f64,
    /// Walks after which a ray is left as it is; 0 leaves further orders out.
    pub max_walks: u64,
    /// Seed of all draws.
    pub seed: u64,
    /// Relative error of single scattering.
    pub single_error: f64,
}

impl Options {
    /// Batches of a round: two at least, for an error.
    fn round(&self) -> u64 {
        (self.max_walks / u64::from(BATCH)).clamp(2, ROUND)
    }
}

impl Default for Options {
    /// 0.1 % of the radiance, or 4 million walks.
    fn default() -> Self {
        Self { rel_error: 1e-3, abs_error: 1e-9, max_walks: 4 << 20, seed: 0, single_error: 1e-6 }
    }
}

/// What a ray brings, per channel; radiances per unit of solar irradiance above the air, sr⁻¹.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Radiance of all orders.
    pub total: DVec3,
    /// Radiance scattered once.
    pub single: DVec3,
    /// Standard error of `total`.
    pub std_error: DVec3,
    /// Transmittance along the ray.
    pub transmittance: DVec3,
}

/// Radiance along every ray through a medium. Ray `i` draws from its own stream, so that the answer depends on the list and the seed alone.
pub fn radiance(medium: &Medium, rays: &[Ray], options: &Options) -> Vec<Estimate> {
    radiance_noting(medium, rays, options, &|| ())
}

/// The same; `done` is called as each ray is finished, on whatever thread.
pub fn radiance_noting(medium: &Medium, rays: &[Ray], options: &Options, done: &(dyn Fn() + Sync)) -> Vec<Estimate> {
    // All eyes above the datum share one space.
    let shared = rays.iter().find(|r| ground_under(medium, r.from_m) >= medium.bottom_radius_m).map(|r| Space::new(medium, r.from_m));
    let answer = |(i, ray): (usize, &Ray)| {
        let own;
        let space = match &shared {
            Some(space) if ground_under(medium, ray.from_m) >= medium.bottom_radius_m => space,
            _ => {
                own = Space::new(medium, ray.from_m);
                &own
            }
        };
        let estimate = one(medium, space, ray, options, i as u64);
        done();
        estimate
    };
    rays.par_iter().enumerate().map(answer).collect()
}

fn one(medium: &Medium, space: &Space, ray: &Ray, options: &Options, index: u64) -> Estimate {
    let nothing = Estimate { total: DVec3::ZERO, single: DVec3::ZERO, std_error: DVec3::ZERO, transmittance: DVec3::ONE };
    let Some(span) = span(medium, ray.from_m, ray.direction) else { return nothing };
    let light = ray.light();
    let way = (ray.from_m, ray.direction);
    let single = single::single_scattering(medium, space, &light, way, span, options.single_error);
    let transmittance = exp3(-optical_depth(medium, ray.from_m, ray.direction, (span.near_m, span.far_m), 1e-9));
    let (more, std_error) = match Starts::new(medium, space, &light, ray.from_m, ray.direction, span) {
        Some(starts) if options.max_walks > 0 => further(space, &light, ray, starts, single, options, index),
        _ => (DVec3::ZERO, DVec3::ZERO),
    };
    Estimate { total: single + more, single, std_error, transmittance }
}

/// Illuminance by the sky on level ground under a point, per unit of solar irradiance above the air; the direct sun is left out. `ray.from_m`
/// says where (its height does not matter), `ray.sun`, `sun_rad` and `occluders` what lights the sky. With its standard error.
pub fn sky_irradiance(medium: &Medium, ray: &Ray, options: &Options) -> (DVec3, DVec3) {
    let up = ray.from_m.normalize_or(DVec3::Z);
    let space = Space::new(medium, up * medium.bottom_radius_m);
    let (light, at) = (ray.light(), up * space.ground_m);
    let batch = |number: u64| {
        let key = [options.seed, u64::MAX, number];
        let glow = Glow::of(&light, at);
        let sequence = Sequence::new(&mut Random::new(&key));
        let mut sum = DVec3::ZERO;
        for i in 0..BATCH {
            let mut draw = Draw::new(sequence.point(i), Random::new(&[key[0], key[1], key[2], u64::from(i)]));
            let hero = [0, 1, 2][i as usize % 3];
            let walk =
                Walk { at, direction: upward(up, &mut draw), weight: DVec3::splat(core::f64::consts::PI), density: DVec3::ONE, hero };
            walk.run(&space, &light, glow.as_ref(), &mut draw, &mut |_, radiance| sum += radiance);
        }
        sum / f64::from(BATCH)
    };
    settle(options, DVec3::ZERO, |number| (0..options.round()).into_par_iter().map(|b| batch(number * ROUND + b)).collect())
}

/// Radiance of each order by itself, the first to the `orders`-th, with its standard error: walks for all orders but the first.
/// Order n is light that has met air or ground n times.
pub fn radiance_by_order(medium: &Medium, ray: &Ray, orders: usize, walks: u64, seed: u64) -> Vec<(DVec3, DVec3)> {
    let mut out = vec![(DVec3::ZERO, DVec3::ZERO); orders];
    let Some(span) = span(medium, ray.from_m, ray.direction) else { return out };
    let space = Space::new(medium, ray.from_m);
    let light = ray.light();
    if let Some(first) = out.first_mut() {
        first.0 = single::single_scattering(medium, &space, &light, (ray.from_m, ray.direction), span, 1e-6);
    }
    let Some(starts) = Starts::new(medium, &space, &light, ray.from_m, ray.direction, span) else { return out };
    let batches = walks.div_ceil(u64::from(BATCH)).max(2);
    let all: Vec<Vec<DVec3>> =
        (0..batches).into_par_iter().map(|b| batch(&space, &light, ray.direction, &starts, [seed, 0, 0, b], orders).by_order).collect();
    let n = batches as f64;
    for (order, slot) in out.iter_mut().enumerate().skip(1) {
        let of = |b: &Vec<DVec3>| b.get(order).copied().unwrap_or_default();
        let mean = all.iter().map(of).sum::<DVec3>() / n;
        let squares = all.iter().map(|b| (of(b) - mean) * (of(b) - mean)).sum::<DVec3>();
        *slot = (mean, root(squares / (n * (n - 1.0))));
    }
    out
}

/// A batch: the mean over its walks, and what each stratum brought squared.
struct Batch {
    mean: DVec3,
    /// The means of the orders that were asked for.
    by_order: Vec<DVec3>,
    squares: [DVec3; STRATA],
}

fn batch(space: &Space, light: &Light<'_>, direction: DVec3, starts: &Starts, key: [u64; 4], orders: usize) -> Batch {
    let mut out = Batch { mean: DVec3::ZERO, by_order: vec![DVec3::ZERO; orders], squares: [DVec3::ZERO; STRATA] };
    let sequence = Sequence::new(&mut Random::new(&key));
    let glow = Glow::of(light, starts.middle());
    for i in 0..BATCH {
        let mut draw = Draw::new(sequence.point(i), Random::new(&[key[0], key[1], key[2], key[3], u64::from(i)]));
        let start = starts.draw(space, draw.next());
        let mut sum = DVec3::ZERO;
        let hero = [0, 1, 2][i as usize % 3];
        let mut walk = Walk { at: start.at, direction, weight: start.weight, density: DVec3::ONE, hero };
        walk.scatter(space, glow.as_ref(), &mut draw);
        let by_order = &mut out.by_order;
        // The start is the first meeting, and the walk counts from its next.
        walk.run(space, light, glow.as_ref(), &mut draw, &mut |n, radiance| {
            sum += radiance;
            if let Some(slot) = by_order.get_mut(n) {
                *slot += radiance / f64::from(BATCH);
            }
        });
        out.mean += sum / f64::from(BATCH);
        out.squares[start.stratum] += sum * sum;
    }
    out
}

/// Orders beyond the first: mean and standard error.
fn further(
    space: &Space,
    light: &Light<'_>,
    ray: &Ray,
    mut starts: Starts,
    single: DVec3,
    options: &Options,
    index: u64,
) -> (DVec3, DVec3) {
    let round = |starts: &Starts, number: u64| -> Vec<Batch> {
        let key = |b: u64| [options.seed, index, number, b];
        (0..options.round()).into_par_iter().map(|b| batch(space, light, ray.direction, starts, key(b), 0)).collect()
    };
    // The pilot only says where light comes from; it is not part of the answer.
    let pilot = round(&starts, 0);
    let mean: DVec3 = pilot.iter().map(|b| b.mean).sum::<DVec3>() / options.round() as f64;
    let scale = (mean + single).max(DVec3::splat(f64::MIN_POSITIVE));
    let mut factors = [0.0; STRATA];
    for (k, factor) in factors.iter_mut().enumerate() {
        let square: DVec3 = pilot.iter().map(|b| b.squares[k]).sum();
        *factor = (square / (scale * scale)).element_sum().sqrt();
    }
    let typical = factors.iter().sum::<f64>() / STRATA as f64;
    if typical > 0.0 && typical.is_finite() {
        factors.iter_mut().for_each(|f| *f += 0.2 * typical);
        starts.weigh(&factors);
    }
    settle(options, single, |number| round(&starts, number).into_iter().map(|b| b.mean).collect())
}

/// Makes rounds of batches, from number 1, until the error of their mean is as wanted; `known` is what the radiance has besides.
fn settle(options: &Options, known: DVec3, round: impl Fn(u64) -> Vec<DVec3>) -> (DVec3, DVec3) {
    let (mut sum, mut squares, mut batches) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for number in 1.. {
        for mean in round(number) {
            sum += mean;
            squares += mean * mean;
            batches += 1.0;
        }
        let mean = sum / batches;
        let std_error = root((squares / batches - mean * mean).max(DVec3::ZERO) / (batches - 1.0));
        let wanted = ((mean + known) * options.rel_error).max(DVec3::splat(options.abs_error));
        if std_error.cmple(wanted).all() || number * options.round() * u64::from(BATCH) >= options.max_walks {
            return (mean, std_error);
        }
    }
    (DVec3::ZERO, DVec3::ZERO)
}

fn root(v: DVec3) -> DVec3 {
    DVec3::new(v.x.sqrt(), v.y.sqrt(), v.z.sqrt())
}

#[cfg(test)]
mod tests;
