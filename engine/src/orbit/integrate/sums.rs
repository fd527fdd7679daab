//! Sums: additions and products of f64 that keep what rounding drops, for long sums of small steps.
//!
//! A path is the sum of its steps: with n plain additions its rounding error grows as √n ulp of the *position*; with the dropped
//! part carried along it grows as that of the *steps*, which are far smaller. Not here: any use of them (`gauss_radau`, `composition`).
//! - [Dekker 1971] "A floating-point technique for extending the available precision", Numer. Math. 18, 224 (product).
//! - [Knuth 1969] "The Art of Computer Programming" 2, §4.2.2 (sum).

use super::Points;
use serde::{Deserialize, Serialize};

/// `a + b` rounded, and what the rounding dropped: their sum is exact [Knuth 1969, theorem B].
#[inline]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// `a × b` rounded, and what the rounding dropped: their sum is exact below 1e300 [Dekker 1971, eq. 5.12]. Without a fused
/// multiply-add, so that the bits are the same on every machine.
#[inline]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (ah, al) = split(a);
    let (bh, bl) = split(b);
    (product, ((ah * bh - product) + ah * bl + al * bh) + al * bl)
}

/// Adds `by` to `sum`, carrying in `low` what rounding drops.
#[inline]
pub fn carry(sum: &mut f64, low: &mut f64, by: f64) {
    (*sum, *low) = two_sum(*sum, by + *low);
}

/// What rounding has dropped of the time, positions and velocities of points so far: to be saved with them for a restart with
/// the same bits. Flat lists (x, y, z of each point).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Carry {
    /// Of the time.
    pub t: f64,
    /// Of positions.
    pub q: Vec<f64>,
    /// Of velocities.
    pub v: Vec<f64>,
}

impl Carry {
    /// Makes room for `n` points; what is new there is zero.
    pub fn fit(&mut self, n: usize) {
        self.q.resize(3 * n, 0.0);
        self.v.resize(3 * n, 0.0);
    }

    /// What is left to `t_end`.
    pub fn left(&self, points: &Points, t_end: f64) -> f64 {
        (t_end - points.t) - self.t
    }

    /// Moves the time on by `dt`.
    pub fn pass(&mut self, points: &mut Points, dt: f64) {
        let (t, low) = two_sum(points.t, dt);
        (points.t, self.t) = two_sum(t, low + self.t);
    }
}

/// The upper and lower 26 bits of `a` [Dekker 1971, eq. 5.6].
#[inline]
fn split(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a;
    let high = c - (c - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_drops_is_kept() {
        // 1 + 2⁻⁸⁰ and (1 + 2⁻³⁰)² = 1 + 2⁻²⁹ + 2⁻⁶⁰: both have bits below the last of an f64.
        let tiny = libm::ldexp(1.0, -80);
        assert_eq!(two_sum(1.0, tiny), (1.0, tiny));
        assert_eq!(two_sum(tiny, -1.0), (-1.0, tiny));
        let x = 1.0 + libm::ldexp(1.0, -30);
        assert_eq!(two_product(x, x), (1.0 + libm::ldexp(1.0, -29), libm::ldexp(1.0, -60)));
    }
}
