//! From how far scattered light comes: what an eclipse of part of an air does to the light that is scattered more than once.
//!
//! Light that has been scattered before reaches a point from all around. Where the sun's disc is free by V at a place, further orders are dimmed to
//! the mean of V with the weight −dB, where `B(d)` is the share of them that at some hop came further than the distance d along the ground. In
//! totality nearly all of them come from beyond the umbra: from d of a hundred kilometres and more, where B is a few hundredths.
//!
//! For every d the orders are solved twice: with all hops, and with those alone that are no longer than d. With `T_d(h, h′)` the light of an even source
//! about the altitude h′ that arrives at h from within d, all directions together, and s that of the sun scattered once (or sent back by
//! the ground), `U_d = T_d (s + U_d)`, and `1 − B(d) = U_d / U_∞`. The last hop is weighed by the phase functions at its end, for an eye that looks
//! level, up and down: in totality the sky above is lit from all around the horizon, at right angles. B is kept at a few distances, the mean
//! over V in as many rings, each of [`PARTS`] distances.
//!
//! Left out: phase functions at all hops but the last, and that a hop begins where the one before it ended. What comes of it is judged in the radiance of
//! eclipsed air, by `tests/tests/sky_continuity.rs`.

use super::forward::Truncated;
use super::orders::directions;
use super::paths::step_at;
use crate::air::{Class, Classes, Medium};
use core::f64::consts::PI;
use glam::DVec3;

/// Rings about a point.
pub const RINGS: usize = 4;
/// Distances in each.
pub const PARTS: usize = 3;
/// Values of B, in the mean over channels at h₁, at which rings begin: what is nearer than the first counts as the point itself.
const BEGIN: [f64; RINGS] = [0.5, 0.2, 0.06, 0.015];
/// Steps along a direction.
const STEPS: usize = 24;
/// Altitudes at which light is found, evenly in the root over the top's.
const LEVELS: usize = 10;
/// Of an air's scattering this lies above the altitude h₁.
const ABOVE: f64 = 0.12;
/// Zenith cosines of the sun for which weights are found; in between they go evenly.
pub const SUNS: [f64; 2] = [0.15, 0.75];
/// Of a chain of hops the longest, over the distance to which it leads: at the datum, and at h₁, from where light goes far by several hops. Found by
/// walks of the reference in Earth's air.
const LONGEST: [f64; 2] = [1.1, 0.75];
/// Zenith cosines of the view for which they are: level, up, down.
const VIEWS: [f64; 3] = [0.0, 1.0, -1.0];

/// Rings about a point, the nearest first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Distances in each along the ground, m, that have even shares of its light.
    pub radius_m: [[f64; PARTS]; RINGS],
    /// Where each begins, m.
    pub begin_m: [f64; RINGS],
    /// Weight of each at the datum for a level view, per channel, for the two suns of [`SUNS`]; the point itself has the rest to 1.
    pub low: [[DVec3; RINGS]; 2],
    /// The same at [`Spread::altitude_m`] and above; x of the way there the share x (1 + x) / 2 of the rise is reached.
    pub high: [[DVec3; RINGS]; 2],
    /// By what weights grow for a view straight up and straight down, at both altitudes; for others with the square of the view's zenith cosine.
    pub tilt: [[[f64; RINGS]; 2]; 2],
    /// h₁, m.
    pub altitude_m: f64,
}

/// A piece of the surroundings of a point.
struct Piece {
    distance_m: f64,
    /// What of an even source there arrives, of all around.
    arrives: DVec3,
    /// Where it is in the list of levels; the ground comes after them.
    level: f64,
    /// Zenith cosine in which it is seen.
    cosine: f64,
    /// Optical depth straight up from there.
    depth: DVec3,
}

/// A medium as its orders are solved.
struct Solver {
    sunlight: Sunlight,
    classes: Vec<(Class, Truncated)>,
    levels: Vec<Vec<Piece>>,
}

/// What every level sends on, and the ground, beyond the sunlight that it scatters itself.
type Sources = [DVec3; LEVELS + 1];

impl Solver {
    fn new(medium: &Medium) -> Self {
        let classes: Vec<_> =
            Classes::of(medium).list.into_iter().map(|class| (Truncated::new(&class), class)).map(|(t, c)| (c, t)).collect();
        let sunlight = Sunlight::new(medium, &classes);
        let altitude = |level: usize| {
            let x = level as f64 / (LEVELS - 1) as f64;
            medium.top_altitude_m * (x * x).min(1.0 - 1e-6)
        };
        let levels = (0..LEVELS).map(|i| paths(medium, &classes, &sunlight, altitude(i))).collect();
        Self { sunlight, classes, levels }
    }

    /// The sources where hops are no longer than `most_m`, under a sun of this zenith cosine.
    fn sources(&self, mu: f64, most_m: f64) -> Sources {
        const N: usize = LEVELS + 1;
        let mut rows = [[DVec3::ZERO; N + 1]; N];
        let mut put = |row: usize, piece: &Piece, share: f64| {
            let arrives = piece.arrives * share;
            for (level, part) in piece.between() {
                rows[row][level] -= arrives * part;
            }
            rows[row][N] += arrives * piece.sent(mu);
        };
        for (i, pieces) in self.levels.iter().enumerate() {
            pieces.iter().take_while(|p| p.distance_m <= most_m).for_each(|piece| put(i, piece, 1.0));
        }
        let upward = self.levels[0].iter().take_while(|p| p.distance_m <= most_m).filter(|p| p.cosine > 0.0);
        upward.for_each(|piece| put(LEVELS, piece, 4.0 * piece.cosine));
        (0..N).for_each(|i| rows[i][i] += DVec3::ONE);
        // What is lost on the way keeps the diagonal ahead of the rest: no row need be chosen.
        for i in 0..N {
            let pivot = rows[i];
            let inverse = DVec3::ONE / pivot[i].max(DVec3::splat(1e-3));
            for row in rows.iter_mut().skip(i + 1) {
                let factor = row[i] * inverse;
                row.iter_mut().zip(pivot).for_each(|(x, y)| *x -= factor * y);
            }
        }
        let mut out = [DVec3::ZERO; N];
        for i in (0..N).rev() {
            let known: DVec3 = (i + 1..N).map(|j| rows[i][j] * out[j]).sum();
            out[i] = (rows[i][N] - known) / rows[i][i].max(DVec3::splat(1e-3));
        }
        out
    }

    /// Mean over azimuths of the phase functions at an altitude, per channel, over that of isotropic scattering.
    fn phase(&self, medium: &Medium, altitude_m: f64, view: f64, cosine: f64) -> DVec3 {
        const AZIMUTHS: u32 = 8;
        let across = ((1.0 - view * view) * (1.0 - cosine * cosine)).max(0.0).sqrt();
        let (mut sum, mut all) = (DVec3::ZERO, DVec3::splat(f64::MIN_POSITIVE));
        for (class, cut) in &self.classes {
            let here = class.scattering(medium, altitude_m);
            let value: f64 = (0..AZIMUTHS)
                .map(|i| class.value(view * cosine + across * libm::cos((f64::from(i) + 0.5) * PI / f64::from(AZIMUTHS))).min(cut.cap))
                .sum();
            sum += here * (4.0 * PI * value / f64::from(AZIMUTHS));
            all += here * (1.0 - cut.share);
        }
        sum / all
    }
}

impl Piece {
    /// Sunlight that it scatters, or sends back, under a sun of this zenith cosine.
    fn sent(&self, mu: f64) -> DVec3 {
        exp(self.depth / mu) * if self.level >= LEVELS as f64 { mu / PI } else { 0.25 / PI }
    }

    /// The levels between which it lies, with their parts.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn between(&self) -> [(usize, f64); 2] {
        if self.level >= LEVELS as f64 {
            return [(LEVELS, 1.0), (LEVELS, 0.0)];
        }
        let low = (self.level as usize).min(LEVELS - 2);
        let part = self.level - low as f64;
        [(low, 1.0 - part), (low + 1, part)]
    }
}

/// Light scattered at a point for an eye: of sunlight scattered once within the first of two distances, and of more within the second, where the
/// sources are those of hops as long. `seen` weighs each piece.
fn gathered(pieces: &[Piece], seen: &[DVec3], mu: f64, most_m: [f64; 2], sources: &Sources) -> DVec3 {
    let light = |(p, seen): (&Piece, &DVec3)| {
        let further = p.between().into_iter().map(|(level, part)| sources[level] * part).sum::<DVec3>();
        *seen * p.arrives * (p.sent(mu) + if p.distance_m <= most_m[1] { further } else { DVec3::ZERO })
    };
    let farthest = most_m[0].max(most_m[1]);
    let within = pieces.iter().zip(seen).take_while(|(p, _)| p.distance_m <= farthest).filter(|(p, _)| p.distance_m <= most_m[0]);
    within.map(light).sum::<DVec3>().max(DVec3::splat(f64::MIN_POSITIVE))
}

impl Spread {
    /// Of a medium.
    pub fn new(medium: &Medium) -> Self {
        let solver = Solver::new(medium);
        let Some(altitude_m) = solver.sunlight.above(ABOVE) else { return Self::default() };
        let high = paths(medium, &solver.classes, &solver.sunlight, altitude_m);
        let (mu, longest) = (SUNS[1], LONGEST[1]);
        let even = vec![DVec3::ONE; high.len()];
        let whole = gathered(&high, &even, mu, [f64::INFINITY; 2], &solver.sources(mu, f64::INFINITY));
        let near = |d: f64| gathered(&high, &even, mu, [d, d * longest], &solver.sources(mu, d * longest)) / whole;
        let farthest = high.last().map_or(1.0, |p| p.distance_m).max(2e-3);
        let where_beyond = |share: f64| {
            let (mut low, mut far) = (1e-3_f64, farthest);
            for _ in 0..20 {
                let d = (low * far).sqrt();
                if 1.0 - near(d).element_sum() / 3.0 > share { low = d } else { far = d }
            }
            low
        };
        let mut rings = Self { begin_m: BEGIN.map(where_beyond), ..Self::default() };
        for (k, radii) in rings.radius_m.iter_mut().enumerate() {
            let end = BEGIN.get(k + 1).copied().unwrap_or(0.0);
            *radii = core::array::from_fn(|i| where_beyond(BEGIN[k] + (end - BEGIN[k]) * (i as f64 + 0.5) / PARTS as f64));
        }
        rings.weighed(medium, &solver, altitude_m)
    }

    /// Of a medium, in the rings of another.
    pub fn in_rings(medium: &Medium, rings: &Self) -> Self {
        let solver = Solver::new(medium);
        match solver.sunlight.above(ABOVE) {
            Some(altitude_m) => rings.weighed(medium, &solver, altitude_m),
            None => Self { begin_m: rings.begin_m, radius_m: rings.radius_m, ..Self::default() },
        }
    }

    /// The farthest distance of all, m.
    pub const fn reach_m(&self) -> f64 {
        self.radius_m[RINGS - 1][PARTS - 1]
    }

    fn weighed(&self, medium: &Medium, solver: &Solver, altitude_m: f64) -> Self {
        let mut out = Self { altitude_m, ..*self };
        for (place, h) in [0.0, altitude_m].into_iter().enumerate() {
            let pieces = paths(medium, &solver.classes, &solver.sunlight, h);
            let seen = VIEWS.map(|v| pieces.iter().map(|p| solver.phase(medium, h, v, p.cosine)).collect::<Vec<_>>());
            let mut sums = [[0.0; RINGS]; VIEWS.len()];
            for (sun, mu) in SUNS.into_iter().enumerate() {
                let all = solver.sources(mu, f64::INFINITY);
                let near = self.begin_m.map(|d| ([d, d * LONGEST[place]], solver.sources(mu, d * LONGEST[place])));
                for (view, (seen, sum)) in seen.iter().zip(&mut sums).enumerate() {
                    let whole = gathered(&pieces, seen, mu, [f64::INFINITY; 2], &all);
                    let beyond = near.map(|(d, sources)| DVec3::ONE - gathered(&pieces, seen, mu, d, &sources) / whole);
                    let next = |k: usize| beyond.get(k + 1).copied().unwrap_or(DVec3::ZERO);
                    let weights: [DVec3; RINGS] = core::array::from_fn(|k| (beyond[k] - next(k)).clamp(DVec3::ZERO, DVec3::ONE));
                    sum.iter_mut().zip(weights).for_each(|(sum, w)| *sum += w.element_sum());
                    if view == 0 {
                        let level = if place == 0 { &mut out.low } else { &mut out.high };
                        level[sun] = weights;
                    }
                }
            }
            for (tilt, sum) in out.tilt[place].iter_mut().zip(&sums[1..]) {
                *tilt = core::array::from_fn(|k| (sum[k] / sums[0][k].max(1e-12)).clamp(0.0, 4.0) - 1.0);
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

/// Scattering and extinction, without what goes straight on.
fn coefficients(medium: &Medium, classes: &[(Class, Truncated)], altitude_m: f64) -> (DVec3, DVec3) {
    let mut out = (DVec3::ZERO, medium.extinction(altitude_m));
    for (class, cut) in classes {
        let scattering = class.scattering(medium, altitude_m);
        out.0 += scattering * (1.0 - cut.share);
        out.1 -= scattering * cut.share;
    }
    (out.0, out.1.max(DVec3::ZERO))
}

impl Sunlight {
    const CELLS: usize = 96;

    /// Root of a cell's altitude over the top's.
    fn root(cell: usize) -> f64 {
        cell as f64 / Self::CELLS as f64
    }

    fn new(medium: &Medium, classes: &[(Class, Truncated)]) -> Self {
        let top_m = medium.top_altitude_m;
        let altitude = |i: usize| top_m * Self::root(i) * Self::root(i);
        let mut depth = vec![DVec3::ZERO; Self::CELLS + 1];
        let mut scattered = vec![0.0; Self::CELLS + 1];
        for i in (0..Self::CELLS).rev() {
            let (a, b) = (altitude(i), altitude(i + 1));
            let (scattering, extinction) = coefficients(medium, classes, 0.5 * (a + b));
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
fn paths(medium: &Medium, classes: &[(Class, Truncated)], sunlight: &Sunlight, from_m: f64) -> Vec<Piece> {
    let (bottom, top) = (medium.bottom_radius_m, medium.top_altitude_m);
    let (r, q0) = (bottom + from_m, from_m * (2.0 * bottom + from_m));
    let albedo = medium.ground_albedo.as_dvec3();
    let mut out = Vec::new();
    let mut put = |distance_m: f64, arrives: DVec3, altitude_m: f64, ground: bool, cosine: f64| {
        let root = (altitude_m / top).clamp(0.0, 1.0).sqrt() * (LEVELS - 1) as f64;
        let level = if ground { LEVELS as f64 } else { root };
        out.push(Piece { distance_m, arrives, level, cosine, depth: sunlight.depth_above(altitude_m) });
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
            let (scattering, extinction) = coefficients(medium, classes, h);
            let kept = exp(extinction * (to - from));
            put(
                s * sine,
                scattering / extinction.max(DVec3::splat(f64::MIN_POSITIVE)) * (DVec3::ONE - kept) * through,
                h,
                false,
                direction.cosine,
            );
            through *= kept;
        }
        if hits {
            put(end * sine, albedo * through, 0.0, true, direction.cosine);
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
    fn earth_s_rings_lie_in_order_and_light_what_stands_above_less() {
        let medium = earth();
        let spread = Spread::new(&medium);
        assert!(spread.begin_m.is_sorted() && spread.radius_m.as_flattened().is_sorted(), "{spread:?}");
        // The sky above is lit from the horizon, at right angles.
        assert!(spread.tilt.as_flattened().as_flattened().iter().all(|t| (-0.5..-0.1).contains(t)), "{spread:?}");
    }

    #[test]
    fn without_bounds_all_light_is_found() {
        // Conservative air over white ground: light that comes down goes up again, and the sources do not run away.
        let mut medium = earth();
        medium.layers.truncate(1);
        medium.ground_albedo = glam::Vec3::ONE;
        let solver = Solver::new(&medium);
        let (near, all) = (solver.sources(0.75, 1e4), solver.sources(0.75, f64::INFINITY));
        for (near, all) in near.iter().zip(all) {
            assert!(near.cmple(all).all() && near.min_element() >= 0.0 && all.max_element() < 1.0, "{near} {all}");
        }
    }

    #[test]
    fn bands_share_the_rings_of_their_air() {
        let medium = earth();
        let own = Spread::new(&medium);
        assert_eq!(own, Spread::in_rings(&medium, &own));
        let mut thin = medium;
        thin.layers.iter_mut().for_each(|l| l.scattering_per_m *= 0.5);
        let other = Spread::in_rings(&thin, &own);
        assert!(other.radius_m == own.radius_m && other.high != own.high);
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
            assert!(spread.radius_m.iter().flatten().all(|r| r.is_finite()));
            medium.layers.iter_mut().for_each(|l| l.scattering_per_m /= scale.max(1e-9));
        }
    }
}
