//! Where the rows of the table of further orders ([`super::orders`]) lie in an air: its levels.
//!
//! The source function changes with altitude as the sight of the ground does (by the root of the altitude), as scattering matter lies above and below, and as
//! matter of one phase function takes the place of another. Levels lie evenly in a sum of the three, up to where matter counts no longer; where
//! density jumps one lies close on either side. In deep air light falls to the ground within few free paths of it, and the sun's dies away in as many below the
//! top: there more of them lie. Below those it comes from all sides, and what turns it matters less.

use super::orders::ALTITUDES;
use super::streams::share;
use crate::air::{Classes, Medium};
use crate::space::relative::narrow;
use core::f64::consts::PI;

/// Greatest optical depth, along a level line, of air that no row is spent on.
const NOTHING: f64 = 3e-4;
/// Jumps that get levels of their own.
const JUMPS: usize = 4;
/// How far from a jump its levels lie, by the top.
const CLOSE: f64 = 1e-4;
/// Parts of a stretch without jumps in which its matter is summed.
const PARTS: usize = 96;
/// What a change of the mean cosine of scattering by one weighs; what all of a deep air's matter weighs. The root of the altitude weighs 1.
const TURNING: f64 = 0.8;
/// See [`TURNING`].
const MATTER: f64 = 2.0;
/// What the logarithm of transport depth from the ground up weighs in deep air, and from which depth on.
const GROUND: f64 = 0.8;
/// What that from the sky down weighs in the deepest air, and the transport depth from which on it tells.
const SKY: f64 = 0.8;
/// See [`SKY`].
const FAR: f64 = 8.0;
/// See [`GROUND`].
const SKIN: f64 = 0.3;

/// Altitudes of the rows of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    top_m: f64,
    /// Roots of the altitudes by the top's, rising.
    roots: [f64; ALTITUDES],
}

/// Scattering, mean of the channels, and that of the most scattered channel, m⁻¹; mean cosine.
fn matter(medium: &Medium, classes: &[(crate::air::Class, f64)], altitude_m: f64) -> [f64; 3] {
    let (mut sum, mut turned) = (glam::DVec3::ZERO, 0.0);
    for (class, cosine) in classes {
        let scattering = class.scattering(medium, altitude_m);
        sum += scattering;
        turned += scattering.element_sum() * cosine;
    }
    let all = sum.element_sum();
    [all / 3.0, sum.max_element(), if all > 0.0 { turned / all } else { f64::NAN }]
}

impl Levels {
    /// Of a medium.
    pub fn new(medium: &Medium) -> Self {
        let top_m = medium.top_altitude_m;
        let classes: Vec<_> =
            Classes::of(medium).list.into_iter().map(|class| (class.legendre(1)[1], class)).map(|(g, c)| (c, g)).collect();
        let at = |root: f64| matter(medium, &classes, root * root * top_m);
        let end = end(medium, &at);
        let close = |root: f64| (root * root + CLOSE).sqrt() - root;
        let mut jumps: Vec<f64> = medium
            .jumps_m(JUMPS)
            .into_iter()
            .map(|h| (h / top_m).sqrt())
            .filter(|x| x * x > 2.0 * CLOSE && *x < end - 2.0 * close(*x))
            .collect();
        jumps.dedup_by(|b, a| *b - *a < 4.0 * close(*a));
        // Stretches between jumps, each with the running sum of what its rows share.
        let edges = core::iter::once(0.0).chain(jumps.iter().flat_map(|x| [x - close(*x), x + close(*x)])).chain([end]);
        let edges: Vec<f64> = edges.collect();
        let depth: f64 = edges.chunks_exact(2).map(|e| parts(e[0], e[1]).map(|(x, w)| at(x)[0] * 2.0 * x * top_m * w).sum::<f64>()).sum();
        let turned = |x: f64, w: f64| {
            let [mean, _, cosine] = at(x);
            if cosine.is_finite() { mean * (1.0 - cosine) * 2.0 * x * top_m * w } else { 0.0 }
        };
        let deep: f64 = edges.chunks_exact(2).map(|e| parts(e[0], e[1]).map(|(x, w)| turned(x, w)).sum::<f64>()).sum();
        // Below many free paths light is even, whatever matter lies there.
        let by_matter = MATTER / ((1.0 + depth) * (1.0 + deep));
        let by_ground = GROUND * share(medium, &Classes::of(medium).list).max_element() / libm::log1p(deep / SKIN).max(1e-9);
        let by_sky = SKY * deep / (FAR + deep) / libm::log1p(deep / SKIN).max(1e-9);
        let mut below = 0.0;
        let stretches: Vec<Vec<f64>> = edges
            .chunks_exact(2)
            .map(|e| {
                let (mut sum, mut last) = (0.0, f64::NAN);
                let one = |(x, w): (f64, f64)| {
                    let [mean, _, cosine] = at(x);
                    let change = if (cosine - last).is_finite() { (cosine - last).abs() } else { 0.0 };
                    last = if cosine.is_finite() { cosine } else { last };
                    let here = turned(x, w);
                    let above = (deep - below - here).max(0.0);
                    let nearer = by_ground * libm::log1p(here / (SKIN + below)) + by_sky * libm::log1p(here / (SKIN + above));
                    below += here;
                    sum += w / end + by_matter * mean * 2.0 * x * top_m * w + TURNING * change / (1.0 + above) + nearer;
                    sum
                };
                core::iter::once(0.0).chain(parts(e[0], e[1]).map(one).collect::<Vec<_>>()).collect()
            })
            .collect();
        let mut roots = [end; ALTITUDES];
        let mut next = roots.iter_mut();
        for ((edge, sums), rows) in edges.chunks_exact(2).zip(&stretches).zip(shares(&stretches, ALTITUDES - 1 - jumps.len())) {
            for i in 0..=rows {
                let wanted = i as f64 / rows as f64 * sums[PARTS];
                let part = sums.partition_point(|s| *s < wanted).clamp(1, PARTS);
                let f = (wanted - sums[part - 1]) / (sums[part] - sums[part - 1]).max(1e-300);
                if let Some(root) = next.next() {
                    *root = edge[0] + (edge[1] - edge[0]) * ((part - 1) as f64 + f.clamp(0.0, 1.0)) / PARTS as f64;
                }
            }
        }
        // No row on another, whatever the medium.
        for i in 1..ALTITUDES {
            roots[i] = roots[i].max(roots[i - 1] + 1e-5);
        }
        Self { top_m, roots }
    }

    /// Altitude of a row, m; a hair below the top at most.
    pub fn altitude_m(&self, row: usize) -> f64 {
        let root = self.roots[row];
        self.top_m * (root * root).min(1.0 - 1e-6)
    }

    /// Row at an altitude, between whole ones by the root of the altitude; the inverse of the above.
    pub fn row(&self, altitude_m: f64) -> f64 {
        let root = (altitude_m / self.top_m).clamp(0.0, 1.0).sqrt();
        self.roots.windows(2).map(|w| ((root - w[0]) / (w[1] - w[0])).clamp(0.0, 1.0)).sum()
    }

    /// Altitude at a row that need not be whole, within the table, m.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn between_m(&self, row: f64) -> f64 {
        let low = (row.max(0.0) as usize).min(ALTITUDES - 2);
        let root = self.roots[low] + (self.roots[low + 1] - self.roots[low]) * (row - low as f64).clamp(0.0, 1.0);
        self.top_m * (root * root).min(1.0 - 1e-6)
    }

    /// As the shaders have them, four to a vector: the roots, and one over the way from each to the next (0 after the last).
    pub fn vectors(&self) -> [[[f32; 4]; ALTITUDES / 4]; 2] {
        let roots = |i: usize| narrow(self.roots[i]);
        // By the rounded roots: then whole rows are whole.
        let inverse = |i: usize| if i + 1 < ALTITUDES { 1.0 / (roots(i + 1) - roots(i)) } else { 0.0 };
        let four = |f: &dyn Fn(usize) -> f32| core::array::from_fn(|k| core::array::from_fn(|j| f(4 * k + j)));
        [four(&roots), four(&inverse)]
    }
}

/// Middles and widths of the parts of a stretch.
fn parts(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let width = (to - from) / PARTS as f64;
    (0..PARTS).map(move |i| (from + (i as f64 + 0.5) * width, width))
}

/// Root of the altitude up to which rows are worth it: where what is above no longer counts even along a level line, about √(2π R τ β) deep.
fn end(medium: &Medium, at: &dyn Fn(f64) -> [f64; 3]) -> f64 {
    const FINE: i32 = 512;
    let mut above = 0.0;
    for i in (0..FINE).rev() {
        let x = (f64::from(i) + 0.5) / f64::from(FINE);
        let most = at(x)[1];
        above += most * 2.0 * x * medium.top_altitude_m / f64::from(FINE);
        if (2.0 * PI * medium.bottom_radius_m * above * most).sqrt() > NOTHING {
            let end = f64::from(i + 1) / f64::from(FINE);
            // Of matter that ends in a jump: just inside it.
            let beside = |h: f64, side: f64| (h / medium.top_altitude_m + side * CLOSE).max(0.0).sqrt();
            let ends =
                |h: &f64| (beside(*h, 0.0) - end).abs() < 1.0 / f64::from(FINE) && at(beside(*h, 1.0))[1] < 1e-4 * at(beside(*h, -1.0))[1];
            return medium.jumps_m(2 * JUMPS).into_iter().find(ends).map_or(end, |h| beside(h, -1.0)).max(0.02);
        }
    }
    1.0
}

/// How many rows each stretch gets of `all`: by what it holds, one at least.
fn shares(stretches: &[Vec<f64>], all: usize) -> Vec<usize> {
    let mut rows = vec![1; stretches.len()];
    for _ in stretches.len()..all {
        // The one whose rows hold most.
        let held = |i: usize| stretches[i][PARTS] / rows[i] as f64;
        if let Some(most) = (0..rows.len()).max_by(|a, b| held(*a).total_cmp(&held(*b))) {
            rows[most] += 1;
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::medium::tests::earth;
    use crate::air::{Layer, Phase, Profile};
    use glam::Vec3;

    fn rises(levels: &Levels) {
        assert!(
            levels.roots.windows(2).all(|w| w[1] > w[0]) && levels.roots[0] >= 0.0 && levels.roots[ALTITUDES - 1] < 1.001,
            "{levels:?}"
        );
        for row in 0..ALTITUDES - 1 {
            assert!((levels.row(levels.altitude_m(row)) - row as f64).abs() < 1e-6, "{row} of {levels:?}");
            assert!((levels.row(levels.between_m(row as f64 + 0.3)) - row as f64 - 0.3).abs() < 1e-6, "{row} of {levels:?}");
        }
    }

    #[test]
    fn rows_are_where_the_air_is() {
        let mut medium = earth();
        let low = Levels::new(&medium);
        rises(&low);
        assert_eq!(low.altitude_m(0), 0.0);
        // Emptiness on top takes none of them.
        medium.top_altitude_m = 3e5;
        let high = Levels::new(&medium);
        rises(&high);
        assert!((6e4..1e5).contains(&high.altitude_m(ALTITUDES - 1)), "{high:?}");
        assert!(high.row(8000.0) > 5.0 && high.row(8000.0) < 9.0, "{}", high.row(8000.0));
    }

    #[test]
    fn a_deck_has_rows_in_it_and_at_its_edges() {
        let mut medium = earth();
        medium.layers[1].scattering_per_m = Vec3::splat(1e-3);
        medium.layers[1].profile = Profile::Constant { bottom_m: 2000.0, top_m: 4000.0 };
        let levels = Levels::new(&medium);
        rises(&levels);
        let all: Vec<f64> = (0..ALTITUDES).map(|row| levels.altitude_m(row)).collect();
        for edge in [2000.0, 4000.0] {
            for side in [-6.0, 6.0] {
                assert!(all.iter().any(|h| (h - edge - side).abs() < 1.0), "{all:?}");
            }
        }
        assert!(all.iter().filter(|h| (2000.0..4000.0).contains(*h)).count() >= 4, "{all:?}");
        // A hard top: the last row is just under it.
        medium.layers.truncate(1);
        medium.layers[0].profile = Profile::Constant { bottom_m: 0.0, top_m: 8000.0 };
        let levels = Levels::new(&medium);
        rises(&levels);
        assert!((levels.altitude_m(ALTITUDES - 1) - 7994.0).abs() < 1.0, "{levels:?}");
    }

    #[test]
    fn a_deep_cloud_has_rows_where_sunlight_dies_away() {
        // As on Venus: 28 deep, from 46 to 74 km, in air of 40 more.
        let mut medium = earth();
        medium.top_altitude_m = 2e5;
        medium.layers.truncate(2);
        medium.layers[0].scattering_per_m = Vec3::new(0.18, 0.41, 1.0) * (40.0 / 15860.0);
        medium.layers[0].profile = Profile::Exponential { scale_height_m: 15860.0 };
        medium.layers[1].scattering_per_m = Vec3::splat(28.0 / 14e3);
        medium.layers[1].phase = Phase::HenyeyGreenstein { g: 0.74 };
        medium.layers[1].profile = Profile::Tent { bottom_m: 46e3, peak_m: 56e3, top_m: 74e3 };
        let levels = Levels::new(&medium);
        rises(&levels);
        // From optical depth 0.3 to 12 as seen from above.
        let held = (0..ALTITUDES).filter(|row| (59.5e3..72.5e3).contains(&levels.altitude_m(*row))).count();
        assert!(held >= 2, "{levels:?}");
    }

    #[test]
    fn any_medium_has_levels() {
        let layer = |s: f32, profile| Layer {
            scattering_per_m: Vec3::splat(s),
            absorption_per_m: Vec3::ZERO,
            profile,
            phase: Phase::HenyeyGreenstein { g: 0.99 },
        };
        for (radius, top) in [(1e3, 1e6), (1e3, 100.0), (1e8, 100.0), (6.4e6, 1e6)] {
            for layers in [
                Vec::new(),
                vec![layer(0.0, Profile::Exponential { scale_height_m: 10.0 })],
                vec![layer(1.0, Profile::Constant { bottom_m: 0.0, top_m: 50.0 }); 6],
                vec![layer(1.0, Profile::Constant { bottom_m: 20.0, top_m: 20.001 })],
                (0..9).map(|i| layer(1e-3, Profile::Constant { bottom_m: i as f32 * 9.0, top_m: i as f32 * 9.0 + 5.0 })).collect(),
            ] {
                rises(&Levels::new(&Medium { bottom_radius_m: radius, top_altitude_m: top, ground_albedo: Vec3::ONE, layers }));
            }
        }
    }
}
