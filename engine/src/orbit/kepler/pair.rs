//! Pairs of f64 that carry a sum beyond its last digit: for the few numbers of an orbit whose rounding would be multiplied.
//!
//! Not a number type for general use: only what the solver needs, and none of it fused, so that the bits are the same on
//! every machine. Inputs stay below 2⁹⁰⁰, or the splitting would overflow.
//!
//! - [Dekker 1971] "A floating-point technique for extending the available precision", Numer. Math. 18, 224.
//! - [Ogita, Rump & Oishi 2005] "Accurate sum and dot product", SIAM J. Sci. Comput. 26, 1955.

use glam::DVec3;

/// The unevaluated sum `hi + lo`, |lo| ≤ ulp(hi)/2 but for rounding of `lo` itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair {
    pub(super) hi: f64,
    pub(super) lo: f64,
}

/// 2π to 33 digits.
pub(super) const TWO_PI: Pair = Pair { hi: core::f64::consts::TAU, lo: 2.449_293_598_294_706_4e-16 };

/// a + b exactly [Knuth's two-sum].
#[inline(always)]
pub(super) fn sum(a: f64, b: f64) -> Pair {
    let hi = a + b;
    let b_seen = hi - a;
    Pair { hi, lo: (a - (hi - b_seen)) + (b - b_seen) }
}

/// a + b exactly where |a| ≥ |b|.
#[inline(always)]
fn ordered_sum(a: f64, b: f64) -> Pair {
    let hi = a + b;
    Pair { hi, lo: b - (hi - a) }
}

#[inline(always)]
fn halves(a: f64) -> (f64, f64) {
    let c = 134_217_729.0 * a;
    let hi = c - (c - a);
    (hi, a - hi)
}

/// a b exactly [Dekker 1971].
#[inline(always)]
pub(super) fn product(a: f64, b: f64) -> Pair {
    let hi = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    Pair { hi, lo: ((ah * bh - hi) + ah * bl + al * bh) + al * bl }
}

/// a·b to twice the digits [Ogita, Rump & Oishi 2005, algorithm 5.3].
#[inline(always)]
pub(super) fn dot(a: DVec3, b: DVec3) -> Pair {
    let (x, y, z) = (product(a.x, b.x), product(a.y, b.y), product(a.z, b.z));
    let s = sum(x.hi, y.hi);
    let t = sum(s.hi, z.hi);
    ordered_sum(t.hi, (s.lo + t.lo) + ((x.lo + y.lo) + z.lo))
}

impl Pair {
    #[inline(always)]
    pub(super) fn minus(self, b: Self) -> Self {
        let s = sum(self.hi, -b.hi);
        ordered_sum(s.hi, s.lo + (self.lo - b.lo))
    }

    #[inline(always)]
    pub(super) fn times(self, b: Self) -> Self {
        let p = product(self.hi, b.hi);
        ordered_sum(p.hi, p.lo + (self.hi * b.lo + self.lo * b.hi))
    }

    #[inline(always)]
    pub(super) fn scaled(self, b: f64) -> Self {
        let p = product(self.hi, b);
        ordered_sum(p.hi, p.lo + self.lo * b)
    }

    /// Self / b, given 1/b.hi.
    #[inline(always)]
    pub(super) fn over(self, b: Self, inverse: f64) -> Self {
        let q = self.hi * inverse;
        let back = product(q, b.hi);
        ordered_sum(q, (((self.hi - back.hi) - back.lo) + (self.lo - q * b.lo)) * inverse)
    }

    /// √self and 1/√self.hi, for self > 0.
    #[inline(always)]
    pub(super) fn root(self) -> (Self, f64) {
        let h = self.hi.sqrt();
        let inverse = 1.0 / h;
        let back = product(h, h);
        (ordered_sum(h, 0.5 * (((self.hi - back.hi) - back.lo) + self.lo) * inverse), inverse)
    }
}
