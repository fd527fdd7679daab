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

/// The value at `t`, by Horner's rule from the order given downwards.
pub fn value(x: &Vector, from: usize, t: f64) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for c in x[from..].iter().rev() {
        sum = sum * t + *c;
    }
    sum
}
