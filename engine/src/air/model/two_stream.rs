//! Light in air so deep that it is scattered hundreds of times: a two-stream solution, which takes the place of all but the first orders.
//!
//! Eddington's approximation [Shettle & Weinman 1970, J. Atmos. Sci. 27] in a column of level layers: with J the mean of the radiance over
//! all directions and F the net flux upwards, `dF/dz = σₛ B − 4π κ J` and `dJ/dz = −3/4π (σₜ F + g σₛ μ B)`, where B is the beam of the
//! sun, μ the cosine of its zenith angle, κ absorption and `σₜ = κ + (1 − g) σₛ`. The planet's roundness is in the beam's way alone.
//! Peaks are cut off as in [`super::forward`].
//!
//! With M₁ the first order, A what makes the next of one and x the sum of all, `x = M₁ + A M₁ + … + Aⁿ⁻¹ M₁ + Aⁿ x`. The solution stands for
//! the last x: every term is positive, however deep the air. A least-squares share of it, as thinner air's orders have, fails: between
//! rows and steps that lie many free paths apart A's own error outweighs what the solution lacks, and its share tends to nothing.

use super::forward::Truncated;
use super::levels::Levels;
use super::orders::{ALTITUDES, SUNS, SunMap, row3, step_at};
use super::sun_map::dip;
use crate::air::{Class, Medium};
use core::f64::consts::PI;
use glam::DVec3;

/// Rows of the solution in a plan: mean source by altitude and sun, then what the view adds, then the ground's illuminance by sun.
pub const SEED_ROWS: usize = (2 * ALTITUDES + 1) * SUNS;
/// Transport depth of scattering from which the solution is better than orders in least squares.
const DEEP: f64 = 4.5;
/// Layers of a column, by squares of even parts of its height.
const LAYERS: usize = 128;
/// Steps of the way to the sun.
const SUN_STEPS: usize = 24;

/// A layer of a column, per channel.
struct Layer {
    middle_m: f64,
    height_m: f64,
    /// Scattering without peaks, m⁻¹; the same times the mean cosine; absorption.
    scattering: DVec3,
    forward: DVec3,
    absorption: DVec3,
    /// Share of the scattering that peaks leave; the same times the mean cosine.
    left: [DVec3; 2],
}

/// A medium's column.
pub struct Column<'a> {
    medium: &'a Medium,
    layers: Vec<Layer>,
}

/// Light in a column under one sun, per unit of the sun's illuminance above the air.
pub struct Solution {
    /// Source function of light that air or ground has scattered before, by layer: its mean, and what the zenith cosine of the view adds.
    sources: Vec<[DVec3; 2]>,
    /// Illuminance on level ground but for the sun's.
    pub ground: DVec3,
}

fn exp(x: DVec3) -> DVec3 {
    DVec3::from_array(x.to_array().map(libm::exp))
}

/// Mean cosine of what a peak leaves of a class.
fn mean_cosine(class: &Class, truncated: &Truncated) -> f64 {
    let n = 256;
    let sum = (0..n).fold([0.0; 2], |[all, cosine], i| {
        let (sin, mu) = libm::sincos((f64::from(i) + 0.5) / f64::from(n) * PI);
        let value = class.value(mu).min(truncated.cap) * sin;
        [all + value, cosine + value * mu]
    });
    (sum[1] / sum[0].max(1e-9)).clamp(-0.99, 0.99)
}

impl<'a> Column<'a> {
    /// Of a medium with its classes.
    pub fn new(medium: &'a Medium, classes: &[(Class, Truncated)]) -> Self {
        let cosines: Vec<f64> = classes.iter().map(|(class, truncated)| mean_cosine(class, truncated)).collect();
        let square = |i: f64| medium.top_altitude_m * (i / LAYERS as f64) * (i / LAYERS as f64);
        let layers = (0..LAYERS)
            .map(|i| {
                let (low, high) = (square(i as f64), square(i as f64 + 1.0));
                let middle_m = 0.5 * (low + high);
                let (mut whole, mut scattering, mut forward) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
                for ((class, truncated), cosine) in classes.iter().zip(&cosines) {
                    let scattered = class.scattering(medium, middle_m);
                    whole += scattered;
                    scattering += scattered * (1.0 - truncated.share);
                    forward += scattered * ((1.0 - truncated.share) * cosine);
                }
                let absorption = (medium.extinction(middle_m) - whole).max(DVec3::ZERO);
                let left = [scattering, forward].map(|x| x / whole.max(DVec3::splat(1e-300)));
                Layer { middle_m, height_m: high - low, scattering, forward, absorption, left }
            })
            .collect();
        Self { medium, layers }
    }

    /// Whether light is scattered so often that a few orders do not tell the sum of all.
    pub fn is_deep(&self) -> bool {
        let depth: DVec3 = self.layers.iter().map(|l| (l.scattering - l.forward) * l.height_m).sum();
        depth.max_element() > DEEP
    }

    /// Optical depth between an altitude and the sun; `None` where the planet is in between.
    fn to_sun(&self, altitude_m: f64, mu: f64) -> Option<DVec3> {
        let (bottom, top) = (self.medium.bottom_radius_m, self.medium.top_altitude_m);
        let (slope, q0) = ((bottom + altitude_m) * mu, altitude_m * (2.0 * bottom + altitude_m));
        if slope < 0.0 && slope * slope > q0 {
            return None;
        }
        let rest = (top * (2.0 * bottom + top) - q0).max(0.0);
        let end = (slope * slope + rest).sqrt() - slope;
        let low = (-slope).clamp(0.0, end);
        let at = |i: usize| step_at(low, end, i as f64 / SUN_STEPS as f64);
        let depth = (0..SUN_STEPS).map(|i| {
            let (from, to) = (at(i), at(i + 1));
            let s = 0.5 * (from + to);
            let q = q0 + s * (2.0 * slope + s);
            let altitude_m = q / (bottom + (bottom * bottom + q).max(0.0).sqrt());
            self.extinction(altitude_m) * (to - from)
        });
        Some(depth.sum())
    }

    /// Extinction without peaks between the layers' middles.
    fn extinction(&self, altitude_m: f64) -> DVec3 {
        let (i, f) = between(self.layers.len(), |i| self.layers[i].middle_m, altitude_m);
        let at = |i: usize| self.layers[i].scattering + self.layers[i].absorption;
        at(i).lerp(at(i + 1), f)
    }

    /// Under a sun of zenith cosine `mu`.
    pub fn under(&self, mu: f64) -> Solution {
        const THIRD: f64 = 4.0 * PI / 3.0;
        let beam = |h: f64| self.to_sun(h, mu).map_or(DVec3::ZERO, |depth| exp(-depth));
        let albedo = self.medium.ground_albedo.as_dvec3();
        let mut low = beam(0.0);
        let on_ground = low * mu.max(0.0);
        let parts = self.layers.iter().map(|l| {
            let high = beam(l.middle_m + 0.5 * l.height_m);
            let light = mean_in_log(low, high) * l.height_m;
            low = high;
            let depth = (l.scattering - l.forward + l.absorption) * l.height_m;
            Part {
                source: l.scattering * light,
                absorbed: l.absorption * (4.0 * PI * l.height_m),
                half: 0.5 * depth.max(DVec3::splat(1e-9)),
                push: 0.5 * mu * l.forward * light,
            }
        });
        let parts: Vec<Part> = parts.collect();
        // From the ground up [Thomas]: the flux into a layer is `flux.0 + flux.1 J`. The ground sends up what its albedo makes of all that comes down.
        let (leak, bounced) = (2.0 * PI * (1.0 - albedo) / (1.0 + albedo), 2.0 * albedo * on_ground / (1.0 + albedo));
        let first = &parts[0];
        let divisor = 1.0 + leak * first.half / THIRD;
        let ground = ((bounced - leak * first.push / THIRD) / divisor, -leak / divisor);
        let mut flux = ground;
        let mut chain = Vec::with_capacity(LAYERS);
        for (i, part) in parts.iter().enumerate() {
            let (a, b) = (flux.0 + part.source, flux.1 - part.absorbed);
            // J = p + q J of the next layer. No light comes down into the last: its flux upwards is 2π J at the top.
            let (p, q) = if let Some(above) = parts.get(i + 1) {
                let depth = part.half + above.half;
                let divisor = THIRD - depth * b;
                ((depth * a + part.push + above.push) / divisor, THIRD / divisor)
            } else {
                let k = 1.0 / (THIRD / (2.0 * PI) + part.half);
                ((a + k * part.push) / (THIRD * k - b), DVec3::ZERO)
            };
            // The flux through the middle, as that into the layer is given.
            chain.push((p, q, (flux.0 + 0.5 * part.source, flux.1 - 0.5 * part.absorbed)));
            flux = (a + b * p, b * q);
        }
        let mut mean = DVec3::ZERO;
        let mut sources = vec![[DVec3::ZERO; 2]; LAYERS];
        for ((source, layer), (p, q, flux)) in sources.iter_mut().zip(&self.layers).zip(chain).rev() {
            mean = (p + q * mean).max(DVec3::ZERO);
            // What goes up is seen by who looks down.
            *source = [mean * layer.left[0], (flux.0 + flux.1 * mean) * layer.left[1] / -THIRD];
        }
        let net = ground.0 + ground.1 * mean;
        let at_ground = mean + (first.half * net + first.push) / THIRD;
        Solution { sources, ground: (PI * at_ground - 0.5 * net).max(DVec3::ZERO) }
    }

    /// Source function at an altitude.
    fn source(&self, solution: &Solution, altitude_m: f64) -> [DVec3; 2] {
        let (i, f) = between(self.layers.len(), |i| self.layers[i].middle_m, altitude_m);
        [0, 1].map(|m| solution.sources[i][m].lerp(solution.sources[i + 1][m], f))
    }
}

/// What a layer does to light.
struct Part {
    /// Scattered out of the beam.
    source: DVec3,
    /// Absorbed, per J.
    absorbed: DVec3,
    /// Half of its transport depth.
    half: DVec3,
    /// Half of what the beam pushes on.
    push: DVec3,
}

/// Mean of what falls exponentially from one value to another.
fn mean_in_log(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|c| {
        let (a, b) = (a[c].max(1e-300), b[c].max(1e-300));
        let ratio = libm::log(a / b);
        if ratio.abs() < 1e-3 { 0.5 * (a + b) } else { (a - b) / ratio }
    }))
}

/// Where a value lies between `n` ≥ 2 rising ones: the lower's number, and the part of the way to the next, both within.
fn between(n: usize, at: impl Fn(usize) -> f64, x: f64) -> (usize, f64) {
    let (mut low, mut high) = (0, n - 1);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if at(middle) <= x { low = middle } else { high = middle }
    }
    (low, ((x - at(low)) / (at(low + 1) - at(low)).max(1e-300)).clamp(0.0, 1.0))
}

/// The solution as the orders begin with it: [`SEED_ROWS`].
pub(super) fn rows(column: &Column<'_>) -> Vec<[f32; 4]> {
    let medium = column.medium;
    let (map, levels) = (SunMap::new(medium), Levels::new(medium));
    let suns: Vec<f64> = (0..SUNS).map(|k| map.mu(dip(medium.bottom_radius_m, 0.0), k)).collect();
    let solutions: Vec<Solution> = suns.iter().map(|mu| column.under(*mu)).collect();
    let mut rows = Vec::with_capacity(SEED_ROWS);
    for part in 0..2 {
        for row in 0..ALTITUDES {
            let altitude_m = levels.altitude_m(row);
            let dip = dip(medium.bottom_radius_m, altitude_m);
            for k in 0..SUNS {
                let (i, f) = between(SUNS, |i| suns[i], map.mu(dip, k));
                let at = |i: usize| column.source(&solutions[i], altitude_m)[part];
                rows.push(row3(at(i).lerp(at(i + 1), f), 0.0));
            }
        }
    }
    rows.extend(solutions.iter().map(|s| row3(s.ground, 0.0)));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::{Classes, Layer as Air, Phase, Profile};
    use glam::Vec3;

    /// Air of a scale height of 8 km over so large a planet that it is level; optical depths by channel.
    fn level(depth: [f32; 3], phase: Phase, albedo: f32) -> Medium {
        let scattering_per_m = Vec3::from(depth) / 8000.0;
        Medium {
            bottom_radius_m: 1e10,
            top_altitude_m: 120e3,
            ground_albedo: Vec3::splat(albedo),
            layers: vec![Air {
                scattering_per_m,
                absorption_per_m: Vec3::ZERO,
                profile: Profile::Exponential { scale_height_m: 8000.0 },
                phase,
            }],
        }
    }

    fn column(medium: &Medium) -> Column<'_> {
        let with = |class: Class| (Truncated::new(&class), class);
        let classes: Vec<_> = Classes::of(medium).list.into_iter().map(with).map(|(truncated, class)| (class, truncated)).collect();
        Column::new(medium, &classes)
    }

    #[test]
    fn without_absorption_it_is_eddington_s_closed_form() {
        // All that comes down at the ground is μ ((2/3 + μ) + (2/3 − μ) e^(−τ/μ)) / (4/3 + (1 − g) τ), on black ground.
        let depths = [1.0, 10.0, 40.0];
        for (phase, g) in [(Phase::Rayleigh, 0.0), (Phase::HenyeyGreenstein { g: 0.2 }, 0.2)] {
            let medium = level(depths, phase, 0.0);
            for mu in [0.2, 0.5, 0.9] {
                let found = column(&medium).under(mu).ground;
                for (c, depth) in depths.map(f64::from).into_iter().enumerate() {
                    let beam = libm::exp(-depth / mu);
                    let truth = mu * ((2.0 / 3.0 + mu) + (2.0 / 3.0 - mu) * beam) / (4.0 / 3.0 + (1.0 - g) * depth);
                    let all = found[c] + mu * beam;
                    assert!((all / truth - 1.0).abs() < 0.01, "depth {depth}, sun {mu}, g {g}: {all} not {truth}");
                }
            }
        }
    }

    #[test]
    fn ground_that_reflects_all_is_as_bright_as_the_sun_on_top() {
        // Without any absorption no net flux goes anywhere: J at the top is that of what comes in and must go out, whatever the depth.
        let solution = column(&level([5.0, 10.0, 40.0], Phase::Rayleigh, 1.0)).under(0.5);
        let top = solution.sources[LAYERS - 1][0];
        assert!((top * (2.0 * PI / 0.5) - 1.0).abs().max_element() < 0.01, "{top}");
    }

    #[test]
    fn only_transport_depth_makes_air_deep() {
        let deep = |depth: f32, phase| {
            let medium = level([0.1, 0.2, depth], phase, 0.1);
            column(&medium).is_deep()
        };
        let forward = || Phase::HenyeyGreenstein { g: 0.8 };
        assert_eq!([deep(4.0, Phase::Rayleigh), deep(5.0, Phase::Rayleigh)], [false, true]);
        assert_eq!([deep(18.0, forward()), deep(30.0, forward())], [false, true]);
    }

    #[test]
    fn night_is_dark_and_nothing_is_ever_below_it() {
        for albedo in [0.0, 0.5, 1.0] {
            for g in [-0.9, 0.0, 0.9] {
                let medium = level([0.0, 1e-3, 200.0], Phase::HenyeyGreenstein { g }, albedo);
                for mu in [-0.5, -1e-3, 0.0, 1e-3, 1.0] {
                    let solution = column(&medium).under(mu);
                    assert!(solution.ground.is_finite() && solution.ground.min_element() >= 0.0, "{mu}: {}", solution.ground);
                    assert!(solution.sources.iter().all(|s| s[0].is_finite() && s[1].is_finite() && s[0].min_element() >= 0.0));
                    assert!(mu > -0.1 || solution.ground.max_element() < 1e-6, "{}", solution.ground);
                }
            }
        }
    }
}
