//! Random numbers that depend on what they are for, not on when they are drawn: a counter under a key, hashed. And points that fill a
//! cube evenly.
//!
//! Steele, Lea & Flood 2014, "Fast Splittable Pseudorandom Number Generators" (the mixing function). Roberts 2018, "The Unreasonable
//! Effectiveness of Quasirandom Sequences" (the generalised golden ratio).

/// Coordinates of a point of [`Sequence`].
pub const DIMENSIONS: usize = 10;

/// One stream: the same key gives the same numbers, on any thread.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// [Steele et al. 2014, fig. 16]
const fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

impl Random {
    /// The stream of a key of several parts.
    pub fn new(key: &[u64]) -> Self {
        Self { state: key.iter().fold(STEP, |state, part| mix(state.wrapping_add(STEP) ^ mix(part.wrapping_add(STEP)))) }
    }

    /// The next number, 0 ≤ x < 1.
    pub fn next(&mut self) -> f64 {
        self.state = self.state.wrapping_add(STEP);
        (mix(self.state) >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }
}

/// Points of the unit cube, even in every number of them, moved by one random offset: means over them are unbiased.
#[derive(Clone, Debug)]
pub struct Sequence {
    offset: [f64; DIMENSIONS],
    step: [f64; DIMENSIONS],
}

impl Sequence {
    /// A sequence with an offset of its own.
    pub fn new(random: &mut Random) -> Self {
        // The root of φ^(d+1) = φ + 1 by fixed point.
        let mut phi = 2.0;
        for _ in 0..40 {
            phi = libm::pow(1.0 + phi, 1.0 / (DIMENSIONS as f64 + 1.0));
        }
        let mut alpha = 1.0;
        let step = [(); DIMENSIONS].map(|()| {
            alpha /= phi;
            alpha
        });
        Self { offset: [(); DIMENSIONS].map(|()| random.next()), step }
    }

    /// Point `i`.
    pub fn point(&self, i: u32) -> [f64; DIMENSIONS] {
        let mut out = self.offset;
        for (x, step) in out.iter_mut().zip(self.step) {
            *x = (*x + step * f64::from(i)).fract();
        }
        out
    }
}

/// What a path draws from: first the coordinates of a point, then the stream.
#[derive(Clone, Debug)]
pub struct Draw {
    point: [f64; DIMENSIONS],
    used: usize,
    stream: Random,
}

impl Draw {
    /// A path's numbers.
    pub fn new(point: [f64; DIMENSIONS], stream: Random) -> Self {
        Self { point, used: 0, stream }
    }

    /// The next number, 0 ≤ x < 1.
    pub fn next(&mut self) -> f64 {
        let x = self.point.get(self.used).copied();
        self.used += 1;
        x.unwrap_or_else(|| self.stream.next())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_even_and_their_own() {
        let mut a = Random::new(&[1, 2]);
        let n = 100_000;
        let mean = (0..n).map(|_| a.next()).sum::<f64>() / f64::from(n);
        assert!((mean - 0.5).abs() < 0.004, "{mean}");
        assert_ne!(Random::new(&[1, 2]).next(), Random::new(&[2, 1]).next());
        assert_eq!(Random::new(&[7]).next(), Random::new(&[7]).next());
    }

    #[test]
    fn a_sequence_fills_each_axis() {
        let sequence = Sequence::new(&mut Random::new(&[3]));
        for axis in 0..DIMENSIONS {
            let mut cells = [0; 16];
            (0..1024).for_each(|i| cells[(sequence.point(i)[axis] * 16.0) as usize] += 1);
            assert!(cells.iter().all(|n| (57..=71).contains(n)), "{cells:?}");
        }
    }
}
