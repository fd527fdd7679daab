//! Numbers of about 79 bits in two f64: for the few numbers of an orbit whose rounding would be multiplied.
//!
//! The upper word keeps to 26 bits, so that the product of two upper words is exact and multiplication needs no splitting.
//! Not a number type for general use: only what the solver needs, and none of it fused, so that the bits are the same on
//! every machine. Values stay below 2⁹⁰⁰, or the splitting would overflow.
//!
//! - [Dekker 1971] "A floating-point technique for extending the available precision", Numer. Math. 18, 224.
//! - [Knuth 1997] "The Art of Computer Programming" vol. 2, §4.2.2, theorem B (the exact sum).

use super::real::Real;

/// The unevaluated sum `hi + lo`: `hi` has 26 bits at most, |lo| ≤ 2⁻²⁶ |hi|.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair<T = f64> {
    pub(super) hi: T,
    pub(super) lo: T,
}

/// a + b, and what rounding took from it [Knuth 1997].
#[inline(always)]
pub(super) fn sum<T: Real>(a: T, b: T) -> (T, T) {
    let s = a + b;
    let b_seen = s - a;
    (s, (a - (s - b_seen)) + (b - b_seen))
}

/// As [`sum`], where |a| ≥ |b| [Dekker 1971].
#[inline(always)]
pub(super) fn ordered_sum<T: Real>(a: T, b: T) -> (T, T) {
    let s = a + b;
    (s, b - (s - a))
}

/// The upper 26 bits of a [Dekker 1971, Veltkamp's splitting].
#[inline(always)]
pub(super) fn shortened<T: Real>(a: T) -> T {
    let c = a * 134_217_729.0;
    c - (c - a)
}

impl<T: Real> Pair<T> {
    #[inline(always)]
    pub(super) fn of(a: T) -> Self {
        let hi = shortened(a);
        Self { hi, lo: a - hi }
    }

    /// a + b where |b| is at most some last digits of a.
    #[inline(always)]
    pub(super) fn new(a: T, b: T) -> Self {
        let hi = shortened(a);
        Self { hi, lo: (a - hi) + b }
    }

    /// a + b where b may be as large as a, what came before having cancelled.
    #[inline(always)]
    pub(super) fn settled(a: T, b: T) -> Self {
        let hi = shortened(a + b);
        Self { hi, lo: (a - hi) + b }
    }

    /// Rounded.
    #[inline(always)]
    pub(super) fn value(self) -> T {
        self.hi + self.lo
    }

    /// The same in every lane of a number like `a`.
    #[inline(always)]
    pub(super) fn all(a: T, x: Pair<f64>) -> Self {
        Self { hi: a.all(x.hi), lo: a.all(x.lo) }
    }

    #[inline(always)]
    pub(super) fn pick(mask: T::Mask, a: Self, b: Self) -> Self {
        Self { hi: T::pick(mask, a.hi, b.hi), lo: T::pick(mask, a.lo, b.lo) }
    }

    /// The product as an exact upper part and the rest, not yet made a pair.
    #[inline(always)]
    pub(super) fn product(self, b: Self) -> (T, T) {
        (self.hi * b.hi, self.hi * b.lo + self.lo * (b.hi + b.lo))
    }

    /// a − self b, as a rounded number and the rest; |a| is the larger.
    #[inline(always)]
    pub(super) fn product_from(self, a: T, b: Self) -> (T, T) {
        let (p, e) = self.product(b);
        let (t, f) = ordered_sum(a, -p);
        (t, f - e)
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
        Self { hi: self.hi * k, lo: self.lo * k }
    }

    /// Self / b, given 1/b.
    #[inline(always)]
    pub(super) fn over(self, b: Self, inverse: T) -> Self {
        let hi = shortened(self.value() * inverse);
        Self { hi, lo: ((self.hi - hi * b.hi) + (self.lo - hi * b.lo)) * inverse }
    }

    /// √self and its inverse rounded, for self > 0.
    #[inline(always)]
    pub(super) fn root(self) -> (Self, T) {
        let whole = self.value().sqrt();
        let inverse = whole.all(1.0) / whole;
        let hi = shortened(whole);
        // (a − hi²)/(√a + hi), the divisor as 2√a less a little.
        let half = inverse * 0.5;
        let left = ((self.hi - hi * hi) + self.lo) * half;
        (Self { hi, lo: left + left * ((whole - hi) * half) }, inverse)
    }
}

/// A vector, each component a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector<T = f64>(pub(super) [Pair<T>; 3]);

impl<T: Real> Vector<T> {
    #[inline(always)]
    pub(super) fn of([x, y, z]: [T; 3]) -> Self {
        Self([Pair::of(x), Pair::of(y), Pair::of(z)])
    }

    /// Rounded: the vector that the pairs were made of.
    #[inline(always)]
    pub(super) fn value(&self) -> [T; 3] {
        [self.0[0].value(), self.0[1].value(), self.0[2].value()]
    }

    #[inline(always)]
    pub(super) fn dot(&self, b: &Self) -> Pair<T> {
        // Written out: `map` would not be inlined.
        let (x, y, z) = (self.0[0].product(b.0[0]), self.0[1].product(b.0[1]), self.0[2].product(b.0[2]));
        let (s, e) = sum(x.0, y.0);
        let (t, f) = sum(s, z.0);
        Pair::settled(t, (e + f) + ((x.1 + y.1) + z.1))
    }
}

/// a x + b y as a rounded sum and the rest.
#[inline(always)]
pub(super) fn combined<T: Real>(a: Pair<T>, x: Pair<T>, b: Pair<T>, y: Pair<T>) -> (T, T) {
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
        let a = Vector::of([big, 1.0, -big]);
        let b = Vector::of([big, 1e-3, big]);
        // Of 1e18, 2⁻⁷⁹ is lost.
        assert!((a.dot(&b).value() - 1e-3).abs() < 2e-6);
    }
}
