//! The light in a planet's shadow as a table: rows by distance behind the planet, columns by angle from the axis. The picture's own
//! form of [`Limb::light`]; `shaders/lib/refracted.wgsl` reads it, [`read`] is its twin.
//!
//! Rows lie evenly in the logarithm of the distance to the limb. Their columns go from the deepest shadow that any light reaches to where the
//! whole disc stands above the air: the first half through the umbra, closer in the dark, by the square; the other half evenly across its edge and
//! the penumbra. A row is made when a receiver needs it: a moon needs three or four.

use super::{Behind, Limb, Ring, sum};
use crate::space::relative::narrow;
use glam::DVec3;

/// Columns of a row; behind them stands one texel more: the row's span.
pub const COLUMNS: usize = 2 * HALF + 1;
/// Columns of each half.
const HALF: usize = 96;
/// Rows.
pub const ROWS: usize = 288;
/// Rows for each doubling of the distance.
const PER_OCTAVE: f64 = 20.0;
/// Steps of the star's distance for each doubling: what is kept is good for 0.1 % of it.
const STAR_PER_OCTAVE: f64 = 512.0;

/// A row's texels: fourth roots of the light; then the angles from the geometric limb (rad, outwards) at which it begins, its halves meet
/// and it ends, and the first row's distance to the limb, m.
pub type Row = [[f32; 4]; COLUMNS + 1];

/// A planet's limb, and the star that it is seen before.
#[derive(Clone, Debug, PartialEq)]
pub struct Shade {
    limb: Limb,
    star_radius_m: f64,
    star_distance_m: f64,
    nearest_m: f64,
}

impl Shade {
    /// Of a limb before a star at about this distance: the shade is the same for all distances that [`Shade::fits`].
    pub fn new(limb: Limb, star_radius_m: f64, star_distance_m: f64) -> Self {
        let top_m = limb.grazes.last().map_or(0.0, |g| g.altitude_m);
        let nearest_m = (top_m * (2.0 * limb.radius_m + top_m)).sqrt();
        Self { limb, star_radius_m, star_distance_m: star_step_m(star_distance_m), nearest_m }
    }

    /// Whether it stands for a star like this one.
    pub fn fits(&self, star_radius_m: f64, star_distance_m: f64) -> bool {
        self.star_radius_m == star_radius_m && self.star_distance_m == star_step_m(star_distance_m)
    }

    /// The limb.
    pub const fn limb(&self) -> &Limb {
        &self.limb
    }

    /// Place of a distance (m, to the planet's centre) among the rows.
    pub fn row_of(&self, distance_m: f64) -> f64 {
        let to_limb = ((distance_m - self.limb.radius_m).max(0.0) * (distance_m + self.limb.radius_m)).sqrt();
        let octaves = libm::log2((to_limb / self.nearest_m).max(1.0));
        (octaves * PER_OCTAVE).min(ROWS as f64 - 1.001)
    }

    /// The rows between which the distances from `from_m` to `to_m` lie.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn rows(&self, from_m: f64, to_m: f64) -> core::ops::RangeInclusive<usize> {
        self.row_of(from_m) as usize..=self.row_of(to_m) as usize + 1
    }

    /// What a receiver is behind in a row.
    pub fn behind(&self, row: usize) -> Behind {
        let to_limb = self.nearest_m * libm::exp2(row as f64 / PER_OCTAVE);
        let distance_m = libm::hypot(to_limb, self.limb.radius_m);
        Behind { star_distance_m: self.star_distance_m, star_radius_m: self.star_radius_m, distance_m }
    }

    /// Makes a row.
    pub fn row(&self, row: usize) -> Row {
        let behind = self.behind(row);
        let (sun_rad, rings) = (behind.sun_rad(), self.limb.rings(&behind));
        let limb_rad = libm::asin(self.limb.radius_m / behind.distance_m);
        let lowest = rings.iter().map(|r: &Ring| r.source_rad).fold(f64::INFINITY, f64::min);
        let begin = (lowest - sun_rad).max(0.0) - limb_rad;
        let end = rings.last().map_or(limb_rad, |r| r.seen_rad) + sun_rad - limb_rad;
        // Held as the shader will have them.
        let span = [begin, begin.max(-1.15 * sun_rad), end].map(narrow);
        let mut texels = [[0.0; 4]; COLUMNS + 1];
        for (i, texel) in texels.iter_mut().take(COLUMNS).enumerate() {
            let light = sum(&rings, sun_rad, (limb_rad + gap_of(span, i)).max(0.0));
            let root = |x: f64| narrow(x.sqrt().sqrt());
            *texel = [root(light.x), root(light.y), root(light.z), 0.0];
        }
        texels[COLUMNS] = [span[0], span[1], span[2], narrow(self.nearest_m)];
        texels
    }

    /// Light from rows, as the shader reads them: at `distance_m`, where the star's centre stands `gap_rad` outside of the planet's limb.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn read(&self, rows: &dyn Fn(usize) -> Row, distance_m: f64, gap_rad: f64) -> DVec3 {
        let v = self.row_of(distance_m);
        let (low, part) = (v as usize, v.fract());
        let root = root_in(&rows(low), gap_rad) * (1.0 - part) + root_in(&rows(low + 1), gap_rad) * part;
        root * root * root * root
    }
}

/// Angle from the limb of a column.
fn gap_of(span: [f32; 3], column: usize) -> f64 {
    let [begin, middle, end] = span.map(f64::from);
    let x = column as f64 / HALF as f64;
    if x < 1.0 { begin + (middle - begin) * x * x } else { middle + (end - middle) * (x - 1.0) }
}

/// Fourth root of the light in a row.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn root_in(row: &Row, gap_rad: f64) -> DVec3 {
    let [begin, middle, end, _] = row[COLUMNS].map(f64::from);
    let inner = ((gap_rad - begin) / (middle - begin).max(1e-9)).clamp(0.0, 1.0).sqrt();
    let x = (inner + ((gap_rad - middle) / (end - middle).max(1e-9)).clamp(0.0, 1.0)) * HALF as f64;
    let i = (x as usize).min(COLUMNS - 2);
    let t = x - i as f64;
    let root = |c: usize| f64::from(row[i][c]) * (1.0 - t) + f64::from(row[i + 1][c]) * t;
    DVec3::new(root(0), root(1), root(2))
}

/// A star's distance in its steps.
fn star_step_m(distance_m: f64) -> f64 {
    let octaves = libm::log2(distance_m.max(1.0));
    libm::exp2((octaves * STAR_PER_OCTAVE).round() / STAR_PER_OCTAVE)
}
