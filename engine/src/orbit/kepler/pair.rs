//! Numbers of about 79 bits in two f64: for the few numbers of an orbit whose rounding would be multiplied.
//!
//! The upper word keeps to 26 bits, so that the product of two upper words is exact and multiplication needs no splitting.
//! Not a number type for general use: only what the solver needs, and none of it fused, so that the bits are the same on
//! every machine. Values stay below 2⁹⁰⁰, or the splitting would overflow.
//!
//! - [Dekker 1971] "A floating-point technique for extending the available precision", Numer. Math. 18, 224.
//! - [Knuth 1997] "The Art of Computer Programming" vol. 2, §4.2.2, theorem B (the exact sum).

use glam::DVec3;

/// The unevaluated sum `hi + lo`: `hi` has 26 bits at most, |lo| ≤ 2⁻²⁶ |hi|.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair {
    pub(super) hi: f64,
    pub(super) lo: f64,
}

/// a + b, and what rounding took from it [Knuth 1997].
#[inline(always)]
pub(super) fn sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let b_seen = s - a;
    (s, (a - (s - b_seen)) + (b - b_seen))
}

/// As [`sum`], where |a| ≥ |b| [Dekker 1971].
#[inline(always)]
pub(super) fn ordered_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    (s, b - (s - a))
}

/// The upper 26 bits of a [Dekker 1971, Veltkamp's splitting].
#[inline(always)]
pub(super) fn shortened(a: f64) -> f64 {
    let c = 134_217_729.0 * a;
    c - (c - a)
}

impl Pair {
    #[inline(always)]
    pub(super) fn of(a: f64) -> Self {
        let hi = shortened(a);
        Self { hi, lo: a - hi }
    }

    /// a + b where |b| is at most some last digits of a.
    #[inline(always)]
    pub(super) fn new(a: f64, b: f64) -> Self {
        let hi = shortened(a);
        Self { hi, lo: (a - hi) + b }
    }

    /// a + b where b may be as large as a, what came before having cancelled.
    #[inline(always)]
    pub(super) fn settled(a: f64, b: f64) -> Self {
        let hi = shortened(a + b);
        Self { hi, lo: (a - hi) + b }
    }

    /// Rounded.
    #[inline(always)]
    pub(super) fn value(self) -> f64 {
        self.hi + self.lo
    }

    /// The product as an exact upper part and the rest, not yet made a pair.
    #[inline(always)]
    pub(super) fn product(self, b: Self) -> (f64, f64) {
        (self.hi * b.hi, self.hi * b.lo + self.lo * (b.hi + b.lo))
    }

    #[inline(always)]
    pub(super) fn times(self, b: Self) -> Self {
        let (p, e) = self.product(b);
        Self::new(p, e)
    }

    #[inline(always)]
    pub(super) fn plus(self, b: Self) -> Self {
        let (s, e) = sum(self.hi, b.hi);
        Self::new(s, e + (self.lo + b.lo))
    }

    /// Times a power of two.
    #[inline(always)]
    pub(super) fn scaled(self, k: f64) -> Self {
        Self { hi: k * self.hi, lo: k * self.lo }
    }

    /// Self / b, given 1/b.
    #[inline(always)]
    pub(super) fn over(self, b: Self, inverse: f64) -> Self {
        let hi = shortened(self.value() * inverse);
        Self { hi, lo: ((self.hi - hi * b.hi) + (self.lo - hi * b.lo)) * inverse }
    }

    /// √self and its inverse rounded, for self > 0.
    #[inline(always)]
    pub(super) fn root(self) -> (Self, f64) {
        let whole = self.value().sqrt();
        let inverse = 1.0 / whole;
        let hi = shortened(whole);
        // (a − hi²)/(√a + hi), the divisor as 2√a less a little.
        let half = 0.5 * inverse;
        let left = ((self.hi - hi * hi) + self.lo) * half;
        (Self { hi, lo: left + left * ((whole - hi) * half) }, inverse)
    }
}

/// A vector, each component a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector(pub(super) [Pair; 3]);

impl Vector {
    #[inline(always)]
    pub(super) fn of(a: DVec3) -> Self {
        Self([Pair::of(a.x), Pair::of(a.y), Pair::of(a.z)])
    }

    /// Rounded: the vector that the pairs were made of.
    #[inline(always)]
    pub(super) fn value(&self) -> DVec3 {
        DVec3::new(self.0[0].value(), self.0[1].value(), self.0[2].value())
    }

    #[inline(always)]
    pub(super) fn dot(&self, b: &Self) -> Pair {
        // Written out: `map` would not be inlined.
        let (x, y, z) = (self.0[0].product(b.0[0]), self.0[1].product(b.0[1]), self.0[2].product(b.0[2]));
        let (s, e) = sum(x.0, y.0);
        let (t, f) = sum(s, z.0);
        Pair::settled(t, (e + f) + ((x.1 + y.1) + z.1))
    }
}

/// a x + b y as a rounded sum and the rest.
#[inline(always)]
pub(super) fn combined(a: Pair, x: Pair, b: Pair, y: Pair) -> (f64, f64) {
    let (p, q) = (a.product(x), b.product(y));
    let (s, e) = sum(p.0, q.0);
    (s, e + (p.1 + q.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_quotients_and_roots_keep_75_bits() {
        // (1 + 2⁻³⁰)² = 1 + 2⁻²⁹ + 2⁻⁶⁰: the last term is beyond an f64.
        let tiny = 9.313_225_746_154_785e-10;
        let a = Pair::of(1.0 + tiny);
        let square = a.times(a);
        assert_eq!((square.hi - 1.0) + (square.lo - 2.0 * tiny), tiny * tiny);
        let (root, inverse) = square.root();
        assert!(((root.hi - a.hi) + (root.lo - a.lo)).abs() < 1e-22);
        let back = square.over(root, inverse);
        assert!(((back.hi - a.hi) + (back.lo - a.lo)).abs() < 1e-22);
    }

    #[test]
    fn a_dot_product_that_cancels_keeps_its_digits() {
        let big = 1e9 + 1.0;
        let a = Vector::of(DVec3::new(big, 1.0, -big));
        let b = Vector::of(DVec3::new(big, 1e-9, big));
        assert_eq!(a.dot(&b).value(), 1e-9);
    }
}
