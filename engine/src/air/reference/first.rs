//! Where the walks of one ray begin: points along it, drawn where scattered light is likely to come from.
//!
//! The ray is cut into pieces of nearly constant source; a piece is drawn by its share of `σ_s T` (the mean over channels of each
//! channel's share) times what a pilot run found its stratum to matter.

use super::single::{breaks, optical_depth};
use super::space::{Light, Space, Span, exp3};
use crate::air::Medium;
use glam::DVec3;

/// Strata of equal share.
pub const STRATA: usize = 32;

struct Piece {
    from: f64,
    to: f64,
    /// Optical depth before it.
    depth: DVec3,
    /// Scattering times transmittance at its middle, times its length.
    share: DVec3,
}

/// The pieces of one ray.
pub struct Starts {
    from_m: DVec3,
    direction: DVec3,
    pieces: Vec<Piece>,
    /// Share of each piece, and the stratum where it lies.
    share: Vec<(f64, usize)>,
    /// Sum of the probabilities up to the end of each piece.
    ends: Vec<f64>,
}

/// A drawn beginning.
pub struct Start {
    /// Where, m from the centre.
    pub at: DVec3,
    /// Transmittance from the eye, over the density of having drawn this place, m.
    pub weight: DVec3,
    /// Which stratum.
    pub stratum: usize,
}

impl Starts {
    /// Cuts a ray; `None` where nothing on it scatters.
    pub fn new(medium: &Medium, space: &Space, light: &Light<'_>, from_m: DVec3, direction: DVec3, span: Span) -> Option<Self> {
        let scattering = |s: f64| space.scattering((from_m + direction * s).length());
        let edges = breaks(space, light, from_m, direction, span);
        let mut cuts: Vec<(f64, f64)> = Vec::new();
        for pair in edges.windows(2).filter(|p| p[1] > p[0]) {
            let step = (pair[1] - pair[0]) / 16.0;
            cuts.extend((0..16).map(|i| (pair[0] + step * f64::from(i), pair[0] + step * f64::from(i + 1))));
        }
        let strongest = cuts.iter().map(|c| scattering(0.5 * (c.0 + c.1))).fold(DVec3::ZERO, DVec3::max);
        let mut pieces = Vec::new();
        let mut depth = DVec3::ZERO;
        cuts.reverse();
        while let Some((from, to)) = cuts.pop() {
            let middle = 0.5 * (from + to);
            let (a, b) = (scattering(from), scattering(to));
            let uneven = (a - b).abs().cmpgt((a + b) * 0.12).any() && a.max(b).cmpgt(strongest * 1e-4).any();
            let thick =
                (space.extinction((from_m + direction * middle).length()) * (to - from)).min_element() > 0.15 && depth.min_element() < 20.0;
            if (uneven || thick) && to - from > 1e-4 * (span.far_m - span.near_m) {
                cuts.extend([(middle, to), (from, middle)]);
                continue;
            }
            let half = optical_depth(medium, from_m, direction, (from, middle), 1e-6);
            pieces.push(Piece { from, to, depth, share: scattering(middle) * exp3(-(depth + half)) * (to - from) });
            depth += half + optical_depth(medium, from_m, direction, (middle, to), 1e-6);
        }
        let total: DVec3 = pieces.iter().map(|p| p.share).sum();
        let channels = total.to_array().into_iter().filter(|x| *x > 0.0).count();
        if channels == 0 {
            return None;
        }
        let total = total.max(DVec3::splat(f64::MIN_POSITIVE));
        let mut sum = 0.0;
        let mut share = Vec::with_capacity(pieces.len());
        for piece in &pieces {
            let x = (piece.share / total).element_sum() / channels as f64;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let stratum = (((sum + 0.5 * x) * STRATA as f64) as usize).min(STRATA - 1);
            share.push((x, stratum));
            sum += x;
        }
        let mut starts = Self { from_m, direction, pieces, share, ends: Vec::new() };
        starts.weigh(&[1.0; STRATA]);
        Some(starts)
    }

    /// Draws by share times a factor for each stratum from now on.
    pub fn weigh(&mut self, factors: &[f64; STRATA]) {
        let total: f64 = self.share.iter().map(|(x, k)| x * factors[*k]).sum();
        let mut sum = 0.0;
        let end = |(x, k): &(f64, usize)| {
            sum += x * factors[*k] / total;
            sum
        };
        self.ends = self.share.iter().map(end).collect();
    }

    /// A typical place where walks begin, m from the centre.
    pub fn middle(&self) -> DVec3 {
        let at = self.ends.partition_point(|end| *end < 0.5);
        self.pieces.get(at).map_or(self.from_m, |p| self.from_m + self.direction * (0.5 * (p.from + p.to)))
    }

    /// Draws a beginning from a uniform number.
    pub fn draw(&self, space: &Space, u: f64) -> Start {
        let i = self.ends.partition_point(|end| *end <= u).min(self.pieces.len().saturating_sub(1));
        let before = i.checked_sub(1).and_then(|k| self.ends.get(k)).copied().unwrap_or(0.0);
        let probability = self.ends.get(i).map_or(1.0, |end| end - before);
        let (Some(piece), Some((_, stratum))) = (self.pieces.get(i), self.share.get(i)) else {
            return Start { at: self.from_m, weight: DVec3::ZERO, stratum: 0 };
        };
        let length = piece.to - piece.from;
        let inside = ((u - before) / probability.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0) * length;
        // A piece is short: three Gauss points are exact to far below the walk's own noise.
        let at = |s: f64| (self.from_m + self.direction * (piece.from + s)).length();
        let node = 0.774_596_669_241_483_4 * 0.5 * inside;
        let (low, mid, high) =
            (space.extinction(at(0.5 * inside - node)), space.extinction(at(0.5 * inside)), space.extinction(at(0.5 * inside + node)));
        let depth = piece.depth + (low * 5.0 + mid * 8.0 + high * 5.0) * (inside / 18.0);
        Start {
            at: self.from_m + self.direction * (piece.from + inside),
            weight: exp3(-depth) * (length / probability.max(f64::MIN_POSITIVE)),
            stratum: *stratum,
        }
    }
}
