//! Series: products and powers of power series, one order at a time, as a Taylor method needs them.
//!
//! A function writes the k-th coefficient of its result from coefficients 0 … k of its arguments; sums run in a fixed order,
//! so the bits are the same everywhere. Not here: which force is put together from them ([`super::recurrence`]).
//! - [Jorba & Zou 2005] "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
//!   Experimental Mathematics 14, 99, §2 (recurrences).

use glam::DVec3;

/// Order of the polynomials in time.
pub const ORDER: usize = 22;
/// Coefficients of one polynomial.
pub const LEN: usize = ORDER + 1;
/// A polynomial in time.
pub type Scalar = [f64; LEN];
/// A vector of them.
pub type Vector = [DVec3; LEN];

/// 0, 1, 2, … as f64.
const INDEX: [f64; LEN] = {
    let mut list = [0.0; LEN];
    let mut i = 1;
    while i < LEN {
        list[i] = list[i - 1] + 1.0;
        i += 1;
    }
    list
};

/// k as f64.
pub fn index(k: usize) -> f64 {
    INDEX[k.min(ORDER)]
}

/// k-th coefficient of `a b`.
pub fn product(a: &Scalar, b: &Scalar, k: usize) -> f64 {
    let mut sums = [0.0; 2];
    for (i, (x, y)) in a[..=k].iter().zip(b[..=k].iter().rev()).enumerate() {
        sums[i & 1] += x * y;
    }
    sums[0] + sums[1]
}

/// k-th coefficient of `a x`.
pub fn scaled(a: &Scalar, x: &Vector, k: usize) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (a, x) in a[..=k].iter().rev().zip(&x[..=k]) {
        sum += *x * *a;
    }
    sum
}

/// k-th coefficient of `x·x`.
pub fn square(x: &Vector, k: usize) -> f64 {
    let half = k.div_ceil(2);
    let mut sum = DVec3::ZERO;
    for (p, q) in x[..half].iter().zip(x[..=k].iter().rev()) {
        sum += *p * *q;
    }
    let twice = 2.0 * (sum.x + sum.y + sum.z);
    if k.is_multiple_of(2) { twice + x[k / 2].length_squared() } else { twice }
}

/// k-th coefficient of `s^α`, k ≥ 1, from those before it: `(1/k s₀) Σ (i(α+1) − k) sᵢ u₍ₖ₋ᵢ₎` [Jorba & Zou 2005, prop. 2.1].
pub fn power(s: &Scalar, u: &Scalar, alpha: f64, k: usize) -> f64 {
    let n = INDEX[k];
    let mut sums = [0.0; 2];
    for (i, (s, u)) in s[1..=k].iter().zip(u[..k].iter().rev()).enumerate() {
        sums[i & 1] += (INDEX[i + 1] * (alpha + 1.0) - n) * (s * u);
    }
    (sums[0] + sums[1]) / (n * s[0])
}

/// The value at `t`, by Horner's rule from the order given downwards.
pub fn value(x: &Vector, from: usize, t: f64) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for c in x[from..].iter().rev() {
        sum = sum * t + *c;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_and_powers_are_those_of_functions() {
        // s = 1 + t: s^α is the binomial series; x = (e^t, 1, 0): x·x = e^{2t} + 1.
        let mut s = [0.0; LEN];
        (s[0], s[1]) = (1.0, 1.0);
        let mut u = [0.0; LEN];
        u[0] = 1.0;
        let mut x = [DVec3::ZERO; LEN];
        let mut factorial = 1.0;
        for k in 0..LEN {
            if k > 0 {
                u[k] = power(&s, &u, -1.5, k);
                factorial *= index(k);
            }
            x[k] = DVec3::new(1.0 / factorial, if k == 0 { 1.0 } else { 0.0 }, 0.0);
        }
        let mut binomial = 1.0;
        for k in 1..LEN {
            binomial *= (-1.5 - index(k - 1)) / index(k);
            assert!((u[k] / binomial - 1.0).abs() < 1e-14, "{k}");
            let expected = libm::pow(2.0, index(k)) * x[k].x;
            assert!((square(&x, k) / expected - 1.0).abs() < 1e-14, "{k}");
            // (1+t)^{-3/2} (1+t)^{-3/2} = (1+t)^{-3}.
            let cube = if k % 2 == 0 { 1.0 } else { -1.0 } * index(k + 1).max(1.0) * (index(k) + 2.0) / 2.0;
            if k < ORDER {
                assert!((product(&u, &u, k) / cube - 1.0).abs() < 1e-13, "{k}");
                assert!((scaled(&u, &[DVec3::X; LEN], k).x - u[..=k].iter().sum::<f64>()).abs() < 1e-13);
            }
        }
        assert!((value(&x, 0, 0.5).x - libm::exp(0.5)).abs() < 1e-15);
    }
}
