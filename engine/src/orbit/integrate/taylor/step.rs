//! Step: how long a Taylor step is, and its sum in two words.
//!
//! Not here: where the coefficients come from ([`super::pairs`]).
//! - [Jorba & Zou 2005] Experimental Mathematics 14, §3.2 (order and step from the last two coefficients).

use super::lanes::{V, W, ZERO, add, add2, mul, mul_then_add, mul21, quick_two_sum, scale, two_sum};

/// A power of two near 1/√x, the time unit of a system whose fastest (m + m′)/r³ is `x`.
pub(super) fn time_scale(x: f64) -> f64 {
    if x.is_normal() { power_of_two(-exponent(x).div_euclid(2)) } else { 1.0 }
}

#[allow(clippy::cast_possible_wrap)] // eleven bits
fn exponent(x: f64) -> i64 {
    (x.to_bits() >> 52 & 0x7ff) as i64 - 1023
}

#[allow(clippy::cast_sign_loss)] // 1 … 2046 after the clamp
fn power_of_two(e: i64) -> f64 {
    f64::from_bits(((e + 1023).clamp(1, 2046) as u64) << 52)
}

/// The longest step for which the last terms stay below `tolerance` of the separations, in the series' time unit: the least of
/// `(tolerance |d₀|/|d_k|)^(1/k)` over the last two orders k, from `ratio` = |d_k|²/|d₀|² [Jorba & Zou 2005, eq. 3-7 with the error
/// per step as the aim]. Infinite where nothing bends.
#[allow(clippy::cast_precision_loss)] // orders are small
pub(super) fn length(ratio: [f64; 2], order: usize, log_tolerance: f64) -> f64 {
    let of = |ratio: f64, k: usize| {
        if ratio > 0.0 { (log_tolerance - 0.5 * log2(ratio)) / k as f64 } else { f64::INFINITY }
    };
    exp2(of(ratio[0], order - 1).min(of(ratio[1], order)))
}

/// Binary logarithm to 0.01: step lengths need no more, and all machines must agree.
#[allow(clippy::cast_precision_loss)] // eleven bits
fn log2(x: f64) -> f64 {
    let m = f64::from_bits(x.to_bits() & 0x000f_ffff_ffff_ffff | 0x3ff0_0000_0000_0000);
    // Least-maximum fit of log2(m) on [1, 2], exact at both ends.
    exponent(x) as f64 + (m - 1.0) * (1.0 + (2.0 - m) * (0.4345 - 0.1555 * (m - 1.0)))
}

/// Power of two, to 0.3 %.
#[allow(clippy::cast_possible_truncation)] // clamped
fn exp2(x: f64) -> f64 {
    if x >= 1000.0 {
        return f64::INFINITY;
    }
    let x = x.max(-1000.0);
    let whole = x.floor();
    let f = x - whole;
    power_of_two(whole as i64) * (1.0 + f * (0.6565 + f * 0.3435))
}

/// Position and rate after `h` of the series whose orders 0 … 2 are `x`, `v`, `c` in two words and whose order k ≥ 3 is `more(k)`.
/// What is below order 3 is summed in two words: the rest is so small that its rounding does not count.
#[inline(always)]
pub(super) fn advance(x: W, v: W, c: W, order: usize, h: f64, more: impl Fn(usize) -> V) -> (W, W) {
    let (mut r, mut rate) = (ZERO, ZERO);
    for k in (3..=order).rev() {
        rate = add(scale(rate, h), r);
        r = add(scale(r, h), more(k));
    }
    let h = [h; 4];
    let with = |c: W, small: V| {
        let (s, e) = two_sum(c.0, small);
        quick_two_sum(s, add(e, c.1))
    };
    let bent = with(c, mul(h, r));
    let moved = add2(x, mul21(add2(v, mul21(bent, h)), h));
    let twice = (scale(c.0, 2.0), scale(c.1, 2.0));
    let bent = with(twice, mul(h, mul_then_add(h, rate, scale(r, 3.0))));
    (moved, add2(v, mul21(bent, h)))
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
