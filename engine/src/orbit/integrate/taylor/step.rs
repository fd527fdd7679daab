//! Step: how long a Taylor step is, and its sum in two words.
//!
//! Not here: where the coefficients come from ([`super::pairs`]).
//! - [Jorba & Zou 2005] Experimental Mathematics 14, §3.2 (order and step from the last two coefficients).

use super::lanes::{Four, Lanes, Two};

/// A power of two near 1/√x, the time unit of a system whose fastest (m + m′)/r³ is `x`.
#[inline(always)]
pub(super) fn time_scale(x: f64) -> f64 {
    if x.is_normal() { power_of_two(-exponent(x).div_euclid(2)) } else { 1.0 }
}

#[allow(clippy::cast_possible_wrap)] // eleven bits
#[inline(always)]
fn exponent(x: f64) -> i64 {
    (x.to_bits() >> 52 & 0x7ff) as i64 - 1023
}

#[allow(clippy::cast_sign_loss)] // 1 … 2046 after the clamp
#[inline(always)]
fn power_of_two(e: i64) -> f64 {
    f64::from_bits(((e + 1023).clamp(1, 2046) as u64) << 52)
}

/// Orders that there is room for, and one more.
pub(super) const ROOM: usize = 34;

/// Orders whose divisions are carried out. Above, a factor 1/k may carry its own rounding: the same in each step, it would add up, but
/// there it is far below the rest.
pub(super) const EXACT: usize = 7;

/// −k/2.
pub(super) const HALF: [f64; 4 * ROOM] = table(false);

/// 1/k.
pub(super) const INVERSE: [f64; 4 * ROOM] = table(true);

#[allow(clippy::cast_precision_loss)] // small
const fn table(inverse: bool) -> [f64; 4 * ROOM] {
    let mut table = [0.0; 4 * ROOM];
    let mut k = 1;
    while k < table.len() {
        table[k] = if inverse { 1.0 / k as f64 } else { k as f64 * -0.5 };
        k += 1;
    }
    table
}

/// How long a step may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    log_tolerance: f64,
    /// 1/k of the last order but one and the last.
    inverse: [f64; 2],
}

impl Bound {
    pub(super) fn new(order: usize, tolerance: f64) -> Self {
        Self { log_tolerance: libm::log2(tolerance), inverse: [INVERSE[order - 1], INVERSE[order]] }
    }

    /// The longest step for which the last terms stay below the tolerance of the separations, in the series' time unit: the least of
    /// `(tolerance |d₀|/|d_k|)^(1/k)` over the last two orders k, from `ratio` = |d_k|²/|d₀|² [Jorba & Zou 2005, eq. 3-7 with the error
    /// per step as the aim]. Infinite where nothing bends.
    #[inline(always)]
    pub(super) fn length(&self, ratio: [f64; 2]) -> f64 {
        exp2(self.log_length(ratio[0], 0).min(self.log_length(ratio[1], 1)))
    }

    #[inline(always)]
    fn log_length(&self, ratio: f64, l: usize) -> f64 {
        if ratio > 0.0 { (self.log_tolerance - 0.5 * log2(ratio)) * self.inverse[l] } else { f64::INFINITY }
    }
}

/// Binary logarithm to 0.01: step lengths need no more, and all machines must agree.
#[allow(clippy::cast_precision_loss)] // eleven bits
#[inline(always)]
fn log2(x: f64) -> f64 {
    let m = f64::from_bits(x.to_bits() & 0x000f_ffff_ffff_ffff | 0x3ff0_0000_0000_0000);
    // Least-maximum fit of log2(m) on [1, 2], exact at both ends.
    exponent(x) as f64 + (m - 1.0) * (1.0 + (2.0 - m) * (0.4345 - 0.1555 * (m - 1.0)))
}

/// Power of two, to 0.3 %.
#[allow(clippy::cast_possible_truncation)] // clamped
#[inline(always)]
fn exp2(x: f64) -> f64 {
    if x >= 1000.0 {
        return f64::INFINITY;
    }
    let x = x.max(-1000.0);
    let whole = x.floor();
    let f = x - whole;
    power_of_two(whole as i64) * (1.0 + f * (0.6565 + f * 0.3435))
}

/// Position and rate after `h` of the series of odd `order` whose orders 0 … 3 are `start` in two words and whose order k ≥ 4 is
/// `more(k)`. What is below order 4 is summed in two words: the rest is so small that its rounding does not count.
#[inline(always)]
pub(super) fn advance<S: Four>(start: [Two<S>; 4], order: usize, h: f64, more: impl Fn(usize) -> Lanes<S>) -> (Two<S>, Two<S>) {
    let [x, v, c2, c3] = start;
    // Even and odd orders apart: four short chains in place of two long ones.
    let h = x.high.all(h);
    let y = h * h;
    let (mut even, mut odd) = (more(order - 1), more(order));
    let (mut even_rate, mut odd_rate) = (h.all(0.0), h.all(0.0));
    for k in (4..order - 2).rev().step_by(2) {
        even_rate = even_rate * y + even;
        odd_rate = odd_rate * y + odd;
        even = even * y + more(k);
        odd = odd * y + more(k + 1);
    }
    let rest = even + odd * h;
    let rate = odd + odd_rate * (y * 2.0) + even_rate * (h * 2.0);
    let h2 = h.product(h);
    let h3 = h2 * h;
    let moved = sum(x, [v * h, c2 * h2, c3 * h3], rest * (y * y));
    let bent =
        sum(v, [c2.scaled(2.0) * h, c3 * h.all(3.0) * h2, Two { high: h.all(0.0), low: h.all(0.0) }], (rest * 4.0 + rate * h) * (h * y));
    (moved, bent)
}

/// x and its increments, the largest first; `rest` is small.
#[inline(always)]
fn sum<S: Four>(x: Two<S>, more: [Two<S>; 3], rest: Lanes<S>) -> Two<S> {
    let a = x.high.plus(more[0].high);
    let b = a.high.plus(more[1].high);
    let c = b.high.plus(more[2].high);
    let d = c.high.plus(rest);
    let low = (x.low + more[0].low) + (more[1].low + more[2].low);
    d.high.plus(low + ((a.low + b.low) + (c.low + d.low)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rough_logarithms_and_powers_are_as_good_as_they_say() {
        for i in 1..2000 {
            let x = libm::pow(10.0, f64::from(i - 1000) * 0.2);
            assert!((log2(x) - libm::log2(x)).abs() < 0.01, "{x}: {}", log2(x) - libm::log2(x));
            let y = f64::from(i - 1000) * 0.37;
            assert!((exp2(y) / libm::exp2(y) - 1.0).abs() < 0.005, "{y}: {}", exp2(y) / libm::exp2(y));
            assert!((time_scale(x) * x.sqrt()).abs() < 2.01 && (time_scale(x) * x.sqrt()).abs() > 0.49);
        }
    }
}
