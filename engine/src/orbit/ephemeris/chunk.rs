//! A chunk: the tracks of a level over one stretch of time, as Chebyshev polynomials. Fitting and evaluation.
//!
//! Each track has 2ᵏ equal segments, k by its own motion, all with the same number of terms. A segment holds coefficients of
//! T₀ … T₁₃ at most; trailing ones that do not count are left out.
//! - [Clenshaw 1955] "A note on the summation of Chebyshev series", MTAC 9, 118.
//! - [Newhall 1989] "Numerical representation of planetary ephemerides", Celest. Mech. 45, 305.

use core::f64::consts::PI;
use glam::DVec3;

/// Coefficients of a segment, at most.
pub const TERMS: usize = 14;
/// A chunk is halved so many times at most.
pub const DEEPEST: u32 = 14;

/// The place of one track's coefficients.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Piece {
    /// First coefficient of the first segment.
    pub first: u32,
    /// Terms of each segment.
    pub terms: u8,
    /// Binary logarithm of the number of segments.
    pub halvings: u8,
}

/// All tracks of a level over a stretch of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chunk {
    /// One for each track.
    pub pieces: Vec<Piece>,
    /// Coefficients, m.
    pub coefficients: Vec<DVec3>,
}

/// A segment under a moment: coefficients, the place in it (−1 … 1), and its half length as a part of the chunk.
struct Segment<'a> {
    terms: &'a [DVec3],
    u: f64,
    half: f64,
}

impl Chunk {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn segment(&self, track: usize, x: f64) -> Option<Segment<'_>> {
        let piece = self.pieces.get(track)?;
        let count = f64::from(1_u32 << piece.halvings);
        let at = x * count;
        let index = at.floor().clamp(0.0, count - 1.0);
        let first = piece.first as usize + index as usize * usize::from(piece.terms);
        let terms = self.coefficients.get(first..first + usize::from(piece.terms))?;
        Some(Segment { terms, u: 2.0 * (at - index) - 1.0, half: 0.5 / count })
    }

    /// Position and its rate for x, at `x` = 0 … 1 of the chunk. The origin where there is no such track.
    ///
    /// Even and odd terms are two series in w = 2u² − 1, T₂ₖ(u) = Tₖ(w) and T₂ₖ₊₃ = 2w T₂ₖ₊₁ − T₂ₖ₋₁, so that two recurrences of
    /// half the length [Clenshaw 1955] run side by side.
    pub fn at(&self, track: usize, x: f64) -> (DVec3, DVec3) {
        let Some(s) = self.segment(track, x) else { return (DVec3::ZERO, DVec3::ZERO) };
        let w = 2.0 * s.u * s.u - 1.0;
        let two_w = 2.0 * w;
        // Values (b) and their slopes in w (d) of both series; the even one stops before T₀.
        let (mut even, mut odd) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        let (mut even_d, mut odd_d) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        let Some((c0, rest)) = s.terms.split_first() else { return (DVec3::ZERO, DVec3::ZERO) };
        let pairs = rest.chunks_exact(2);
        // A last odd term without an even one after it.
        odd[0] = pairs.remainder().first().copied().unwrap_or(DVec3::ZERO);
        for pair in pairs.rev() {
            even_d = [even[0] * 2.0 + even_d[0] * two_w - even_d[1], even_d[0]];
            even = [pair[1] + even[0] * two_w - even[1], even[0]];
            odd_d = [odd[0] * 2.0 + odd_d[0] * two_w - odd_d[1], odd_d[0]];
            odd = [pair[0] + odd[0] * two_w - odd[1], odd[0]];
        }
        let (line, line_d) = (odd[0] - odd[1], odd_d[0] - odd_d[1]);
        let position = *c0 + even[0] * w - even[1] + line * s.u;
        let slope_w = even[0] + even_d[0] * w - even_d[1] + line_d * s.u;
        (position, (slope_w * (4.0 * s.u) + line) * (1.0 / s.half))
    }

    /// Position alone.
    pub fn position(&self, track: usize, x: f64) -> DVec3 {
        let Some(s) = self.segment(track, x) else { return DVec3::ZERO };
        let w = 2.0 * s.u * s.u - 1.0;
        let two_w = 2.0 * w;
        let (mut even, mut odd) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        let Some((c0, rest)) = s.terms.split_first() else { return DVec3::ZERO };
        let pairs = rest.chunks_exact(2);
        odd[0] = pairs.remainder().first().copied().unwrap_or(DVec3::ZERO);
        for pair in pairs.rev() {
            even = [pair[1] + even[0] * two_w - even[1], even[0]];
            odd = [pair[0] + odd[0] * two_w - odd[1], odd[0]];
        }
        *c0 + even[0] * w - even[1] + (odd[0] - odd[1]) * s.u
    }

    /// Adds `weight` × the Taylor coefficients in x of the track about `x` to `out`; returns how far in x the same segment goes on
    /// (not 0: at the end of one the next is taken).
    pub fn series(&self, track: usize, x: f64, weight: f64, out: &mut [DVec3]) -> f64 {
        let Some(s) = self.segment(track, x) else { return f64::INFINITY };
        let scale = 1.0 / s.half;
        // Tₖ(u + δ) as polynomials in δ: Tₖ₊₁ = 2(u + δ)Tₖ − Tₖ₋₁.
        let (mut before, mut this) = ([0.0; TERMS], [0.0; TERMS]);
        before[0] = 1.0;
        (this[0], this[1]) = (s.u, 1.0);
        let last = s.terms.len().min(out.len());
        for (k, c) in s.terms.iter().enumerate() {
            let mut power = weight;
            for (m, slot) in out.iter_mut().enumerate().take((k + 1).min(last)) {
                *slot += *c * (before[m] * power);
                power *= scale;
            }
            let mut next = [0.0; TERMS];
            for m in 0..TERMS {
                let lower = if m > 0 { this[m - 1] } else { 0.0 };
                next[m] = 2.0 * (s.u * this[m] + lower) - before[m];
            }
            (before, this) = (this, next);
        }
        (1.0 - s.u) * s.half
    }
}

/// Fits chunks: the nodes and the matrix from values at them to coefficients.
#[derive(Clone, Debug)]
pub struct Fitter {
    /// Nodes in a segment, rising, −1 … 1.
    nodes: [f64; TERMS],
    /// Row k: weights of the values in cₖ.
    matrix: [[f64; TERMS]; TERMS],
}

impl Default for Fitter {
    fn default() -> Self {
        let count = TERMS as f64;
        let angle = |j: usize| PI * ((TERMS - 1 - j) as f64 + 0.5) / count;
        let nodes = core::array::from_fn(|j| libm::cos(angle(j)));
        let matrix = core::array::from_fn(|k| {
            let scale = if k == 0 { 1.0 } else { 2.0 } / count;
            core::array::from_fn(|j| scale * libm::cos(k as f64 * angle(j)))
        });
        Self { nodes, matrix }
    }
}

impl Fitter {
    /// Chebyshev coefficients from values at the nodes.
    fn coefficients(&self, values: &[DVec3; TERMS]) -> [DVec3; TERMS] {
        core::array::from_fn(|k| {
            let mut sum = DVec3::ZERO;
            for (w, v) in self.matrix[k].iter().zip(values) {
                sum += *v * *w;
            }
            sum
        })
    }

    /// Fits all tracks. `sample(x, out)` gives their places at x = 0 … 1 of the chunk and is asked in rising order of x, from 0 again
    /// for each try; `within_m` is the error allowed for each; `halvings` the first try. Where even the deepest halving does not meet
    /// a bound the deepest is kept.
    pub fn fit(&self, within_m: &[f64], halvings: u32, mut sample: impl FnMut(f64, &mut [DVec3])) -> Chunk {
        let tracks = within_m.len();
        let mut place = vec![DVec3::ZERO; tracks];
        let mut depth = halvings.min(DEEPEST);
        let (mut fine, mut worst) = self.level(tracks, depth, &mut place, &mut sample, within_m);
        while worst > 1.0 && depth < DEEPEST {
            let (finer, new) = self.level(tracks, depth + 1, &mut place, &mut sample, within_m);
            // Samples that are no smoother than this: halving on does not help.
            let noise = new > 0.25 * worst;
            (fine, worst, depth) = (finer, new, depth + 1);
            if noise {
                break;
            }
        }
        let mut chunk = Chunk::default();
        for (track, &within) in within_m.iter().enumerate() {
            let (list, halvings) = self.coarsest(&fine[track], depth, within);
            append(&mut chunk, &list, halvings, within);
        }
        chunk
    }

    /// All tracks at one depth, and the worst tail in units of what is allowed.
    fn level(
        &self,
        tracks: usize,
        depth: u32,
        place: &mut [DVec3],
        sample: &mut impl FnMut(f64, &mut [DVec3]),
        within_m: &[f64],
    ) -> (Vec<Vec<[DVec3; TERMS]>>, f64) {
        let count = 1_u32 << depth;
        let mut all = vec![Vec::with_capacity(count as usize); tracks];
        let mut values = vec![[DVec3::ZERO; TERMS]; tracks];
        let mut worst = 0.0_f64;
        for segment in 0..count {
            for (j, u) in self.nodes.iter().enumerate() {
                sample((f64::from(segment) + 0.5 * (u + 1.0)) / f64::from(count), place);
                for (values, p) in values.iter_mut().zip(&*place) {
                    values[j] = *p;
                }
            }
            for ((list, values), within) in all.iter_mut().zip(&values).zip(within_m) {
                let c = self.coefficients(values);
                worst = worst.max(tail(&c) / within);
                list.push(c);
            }
        }
        (all, worst)
    }

    /// The fewest segments that hold a track, from a representation finer than needed. Terms and halvings are below 256.
    #[allow(clippy::cast_possible_truncation)]
    fn coarsest(&self, fine: &[[DVec3; TERMS]], depth: u32, within: f64) -> (Vec<[DVec3; TERMS]>, u32) {
        let own = Chunk {
            pieces: vec![Piece { first: 0, terms: TERMS as u8, halvings: depth as u8 }],
            coefficients: fine.iter().flatten().copied().collect(),
        };
        for halvings in 0..depth {
            let count = 1_u32 << halvings;
            let mut list = Vec::with_capacity(count as usize);
            for segment in 0..count {
                let values =
                    core::array::from_fn(|j| own.position(0, (f64::from(segment) + 0.5 * (self.nodes[j] + 1.0)) / f64::from(count)));
                let c = self.coefficients(&values);
                if tail(&c) > within {
                    break;
                }
                list.push(c);
            }
            if list.len() == count as usize {
                return (list, halvings);
            }
        }
        (fine.to_vec(), depth)
    }
}

/// What is left out after the last coefficient is smaller than the last two are.
fn tail(c: &[DVec3; TERMS]) -> f64 {
    c[TERMS - 1].length() + c[TERMS - 2].length()
}

/// Adds a track with as few terms as its bound allows.
#[allow(clippy::cast_possible_truncation)]
fn append(chunk: &mut Chunk, list: &[[DVec3; TERMS]], halvings: u32, within: f64) {
    let needed = |c: &[DVec3; TERMS]| {
        let mut dropped = 0.0;
        let mut terms = TERMS;
        while terms > 1 {
            dropped += c[terms - 1].length();
            if dropped > 0.5 * within {
                break;
            }
            terms -= 1;
        }
        terms
    };
    let terms = list.iter().map(needed).max().unwrap_or(1);
    chunk.pieces.push(Piece { first: chunk.coefficients.len() as u32, terms: terms as u8, halvings: halvings as u8 });
    for c in list {
        chunk.coefficients.extend_from_slice(&c[..terms]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipse(x: f64, turns: f64, size: f64) -> DVec3 {
        let a = core::f64::consts::TAU * turns * x;
        DVec3::new(size * libm::cos(a), size * 0.9 * libm::sin(a), 0.1 * size * libm::sin(2.0 * a))
    }

    fn chunk() -> Chunk {
        Fitter::default().fit(&[1e-13 * 4e8, 1e-13 * 1e11], 0, |x, out| {
            out[0] = ellipse(x, 1.3, 4e8);
            out[1] = ellipse(x, 0.02, 1e11);
        })
    }

    #[test]
    fn a_fit_is_within_its_bound_everywhere_and_uses_few_segments_for_slow_tracks() {
        let chunk = chunk();
        assert!(chunk.pieces[0].halvings > chunk.pieces[1].halvings && chunk.pieces[1].terms < 10, "{:?}", chunk.pieces);
        for k in 0..=5000 {
            let x = f64::from(k) / 5000.0;
            assert!((chunk.position(0, x) - ellipse(x, 1.3, 4e8)).length() < 1.5e-13 * 4e8);
            assert!((chunk.at(1, x).0 - ellipse(x, 0.02, 1e11)).length() < 1.5e-13 * 1e11);
        }
    }

    #[test]
    fn the_rate_and_the_series_are_those_of_the_polynomial() {
        let chunk = chunk();
        for x in [0.013, 0.5, 0.987] {
            let rate = chunk.at(0, x).1;
            let a = core::f64::consts::TAU * 1.3;
            let exact = DVec3::new(-4e8 * a * libm::sin(a * x), 3.6e8 * a * libm::cos(a * x), 0.8e8 * a * libm::cos(2.0 * a * x));
            assert!((rate - exact).length() < 1e-10 * exact.length());
            let mut series = [DVec3::ZERO; TERMS];
            let ahead = chunk.series(0, x, 1.0, &mut series);
            assert!(ahead > 0.0);
            for part in [0.0, 0.5, 1.0] {
                let h = part * ahead * 0.999_999;
                let sum = series.iter().rev().fold(DVec3::ZERO, |sum, c| sum * h + *c);
                assert!((sum - chunk.position(0, x + h)).length() < 1e-13 * 4e8, "{x} {part}");
            }
        }
        assert_eq!(chunk.at(9, 0.5), (DVec3::ZERO, DVec3::ZERO));
    }
}
