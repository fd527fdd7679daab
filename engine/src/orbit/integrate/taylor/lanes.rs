//! Lanes: four numbers at a time, one word or two, in the vector registers of machines that have them.
//!
//! The same bits come out on every machine: each lane is plain IEEE arithmetic, with no fused multiply-add and no reciprocal estimates.
//!
//! A two-word number is an unevaluated sum of a value and a much smaller one: about 32 digits, for the few operations whose rounding
//! would otherwise be the largest error of a step.
//!
//! Not here: what the numbers mean ([`super::pairs`], [`super::centre`]).
//! - [Dekker 1971] "A floating-point technique for extending the available precision", Numerische Mathematik 18.
//! - [Knuth 1997] "The Art of Computer Programming", vol. 2, §4.2.2, theorem B (the error of a sum).

use glam::DVec3;
use pulp::{Simd, f64x4, u64x4};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A kind of machine that has, or plays, vectors of four.
pub(super) trait Four: Simd<f64s = f64x4, u64s = u64x4> {}
impl<T: Simd<f64s = f64x4, u64s = u64x4>> Four for T {}

/// Work that is compiled for each kind of machine.
pub(super) trait OnFour {
    type Output;
    fn go<S: Four>(self, s: S) -> Self::Output;
}

/// Do the work with this machine's vectors; the same bits on every machine.
#[inline]
pub(super) fn dispatch<T: OnFour>(work: T) -> T::Output {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        struct On<T>(pulp::x86::V3, T);
        impl<T: OnFour> pulp::NullaryFnOnce for On<T> {
            type Output = T::Output;

            #[inline(always)]
            fn call(self) -> T::Output {
                self.1.go(self.0)
            }
        }
        if let Some(v3) = pulp::x86::V3::try_new() {
            return v3.vectorize(On(v3, work));
        }
    }
    plainly(work)
}

/// Do the work without vectors.
pub(super) fn plainly<T: OnFour>(work: T) -> T::Output {
    work.go(pulp::Scalar256b)
}

/// Four lanes.
#[derive(Clone, Copy)]
pub(super) struct Lanes<S> {
    s: S,
    v: f64x4,
}

/// Four lanes at rest, in memory.
pub(super) const EMPTY: f64x4 = f64x4(0.0, 0.0, 0.0, 0.0);

macro_rules! operator {
    ($name:ident $method:ident $simd:ident) => {
        impl<S: Four> $name for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { s: self.s, v: self.s.$simd(self.v, other.v) }
            }
        }
    };
}
operator!(Add add add_f64s);
operator!(Sub sub sub_f64s);
operator!(Mul mul mul_f64s);
operator!(Div div div_f64s);

impl<S: Four> Mul<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, by: f64) -> Self {
        self * self.all(by)
    }
}

impl<S: Four> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { s: self.s, v: self.s.neg_f64s(self.v) }
    }
}

impl<S: Four> Lanes<S> {
    #[inline(always)]
    pub(super) fn new(s: S, v: f64x4) -> Self {
        Self { s, v }
    }

    #[inline(always)]
    pub(super) fn splat(s: S, x: f64) -> Self {
        Self { s, v: s.splat_f64s(x) }
    }

    /// The same number in all lanes.
    #[inline(always)]
    pub(super) fn all(self, x: f64) -> Self {
        Self::splat(self.s, x)
    }

    #[inline(always)]
    pub(super) fn zero(s: S) -> Self {
        Self::splat(s, 0.0)
    }

    #[inline(always)]
    pub(super) fn load(s: S, from: &[f64], at: usize) -> Self {
        match from.get(at..at + 4) {
            Some(&[a, b, c, d]) => Self { s, v: f64x4(a, b, c, d) },
            _ => Self::zero(s),
        }
    }

    #[inline(always)]
    pub(super) fn store(self, to: &mut [f64], at: usize) {
        if let Some([a, b, c, d]) = to.get_mut(at..at + 4) {
            (*a, *b, *c, *d) = (self.v.0, self.v.1, self.v.2, self.v.3);
        }
    }

    #[inline(always)]
    pub(super) fn rest(self) -> f64x4 {
        self.v
    }

    #[inline(always)]
    pub(super) fn array(self) -> [f64; 4] {
        [self.v.0, self.v.1, self.v.2, self.v.3]
    }

    /// The first three lanes.
    #[inline(always)]
    pub(super) fn vector(self) -> DVec3 {
        DVec3::new(self.v.0, self.v.1, self.v.2)
    }

    /// Lane 3 replaced. By masks, so that it is written to memory with the others: a load that spans two writes has to wait for them.
    #[inline(always)]
    pub(super) fn with_last(self, x: f64) -> Self {
        const LAST: u64x4 = u64x4(0, 0, 0, u64::MAX);
        const REST: u64x4 = u64x4(u64::MAX, u64::MAX, u64::MAX, 0);
        let s = self.s;
        let (kept, new) = (s.transmute_u64s_f64s(self.v), s.transmute_u64s_f64s(s.splat_f64s(x)));
        Self { s, v: s.transmute_f64s_u64s(s.or_u64s(s.and_u64s(kept, REST), s.and_u64s(new, LAST))) }
    }

    /// Lanes 1, 2, 0: of three bodies in a ring, the next.
    #[inline(always)]
    pub(super) fn next_of_three(self) -> Self {
        Self { s: self.s, v: f64x4(self.v.1, self.v.2, self.v.0, self.v.3) }
    }

    /// Lanes 2, 0, 1: of three bodies in a ring, the one before.
    #[inline(always)]
    pub(super) fn last_of_three(self) -> Self {
        Self { s: self.s, v: f64x4(self.v.2, self.v.0, self.v.1, self.v.3) }
    }

    #[inline(always)]
    pub(super) fn larger(self, other: Self) -> Self {
        Self { s: self.s, v: self.s.max_f64s(self.v, other.v) }
    }

    #[inline(always)]
    pub(super) fn smaller(self, other: Self) -> Self {
        Self { s: self.s, v: self.s.min_f64s(self.v, other.v) }
    }

    #[inline(always)]
    pub(super) fn largest(self) -> f64 {
        self.v.0.max(self.v.2).max(self.v.1.max(self.v.3))
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self { s: self.s, v: self.s.sqrt_f64s(self.v) }
    }

    /// The upper 26 bits of the significand: what is left out fits 27, so that products of the parts are exact [Dekker 1971].
    #[inline(always)]
    fn upper(self) -> Self {
        let mask = self.s.splat_u64s(0xffff_ffff_f800_0000);
        Self { s: self.s, v: self.s.transmute_f64s_u64s(self.s.and_u64s(self.s.transmute_u64s_f64s(self.v), mask)) }
    }

    /// Sum and its exact rounding error [Knuth 1997].
    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Two<S> {
        let s = self + other;
        let t = s - self;
        Two { high: s, low: (self - (s - t)) + (other - t) }
    }

    /// The same where |self| ≥ |other| in every lane.
    #[inline(always)]
    pub(super) fn plus_smaller(self, other: Self) -> Two<S> {
        let s = self + other;
        Two { high: s, low: other - (s - self) }
    }

    /// Product and its rounding error [Dekker 1971].
    #[inline(always)]
    pub(super) fn product(self, other: Self) -> Two<S> {
        let p = self * other;
        let (ah, bh) = (self.upper(), other.upper());
        let (al, bl) = (self - ah, other - bh);
        Two { high: p, low: ((ah * bh - p) + (ah * bl + al * bh)) + al * bl }
    }

    /// Sum of lanes 0, 1 and 2.
    #[inline(always)]
    pub(super) fn sum_of_three(self) -> f64 {
        self.v.0 + self.v.1 + self.v.2
    }

    /// a^(−3/2).
    #[inline(always)]
    pub(super) fn inverse_three_halves(self) -> Self {
        self.all(1.0) / (self * self.sqrt())
    }
}

/// Four lanes of two words each.
#[derive(Clone, Copy)]
pub(super) struct Two<S> {
    pub(super) high: Lanes<S>,
    pub(super) low: Lanes<S>,
}

impl<S: Four> Add for Two<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let sum = self.high.plus(other.high);
        sum.high.plus_smaller(sum.low + (self.low + other.low))
    }
}

impl<S: Four> Sub for Two<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl<S: Four> Mul for Two<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let p = self.high.product(other.high);
        p.high.plus_smaller(p.low + (self.high * other.low + self.low * other.high))
    }
}

impl<S: Four> Mul<Lanes<S>> for Two<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Lanes<S>) -> Self {
        let p = self.high.product(other);
        p.high.plus_smaller(p.low + self.low * other)
    }
}

impl<S: Four> Two<S> {
    #[inline(always)]
    pub(super) fn new(s: S, high: f64x4, low: f64x4) -> Self {
        Self { high: Lanes::new(s, high), low: Lanes::new(s, low) }
    }

    #[inline(always)]
    pub(super) fn from_vectors(s: S, high: DVec3, low: DVec3) -> Self {
        let wide = |v: DVec3| Lanes::new(s, f64x4(v.x, v.y, v.z, v.z)).with_last(0.0);
        Self { high: wide(high), low: wide(low) }
    }

    #[inline(always)]
    pub(super) fn load(s: S, high: &[f64], low: &[f64], at: usize) -> Self {
        Self { high: Lanes::load(s, high, at), low: Lanes::load(s, low, at) }
    }

    #[inline(always)]
    pub(super) fn rest(self) -> [f64x4; 2] {
        [self.high.v, self.low.v]
    }

    /// Times a power of two, which is exact.
    #[inline(always)]
    pub(super) fn scaled(self, power: f64) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }

    /// One lane in all.
    #[inline(always)]
    pub(super) fn lane(self, l: usize) -> Self {
        Self { high: self.high.all(self.high.array()[l]), low: self.low.all(self.low.array()[l]) }
    }

    /// Sum of lanes 0, 1 and 2, in all lanes.
    #[inline(always)]
    pub(super) fn sum_of_three(self) -> Self {
        self.lane(0) + self.lane(1) + self.lane(2)
    }

    /// self − other, where both may be large and near each other.
    #[inline(always)]
    pub(super) fn minus(self, other: Self) -> Self {
        let d = self.high.plus(-other.high);
        d.high.plus(d.low + (self.low - other.low))
    }

    /// a^(−3/2) from its rounded value `y`, by one Newton step on y²a³ = 1 with the residual in two words.
    #[inline(always)]
    pub(super) fn inverse_three_halves(self, y: Lanes<S>) -> Self {
        // (y a)² a: no product leaves the range of f64 where y² or a³ would.
        let ya = self * y;
        let one = (ya * ya) * self;
        let residual = (y.all(1.0) - one.high) - one.low;
        y.plus_smaller(y * residual * 0.5)
    }

    /// The quotient, from a rounded one and the remainder.
    #[inline(always)]
    pub(super) fn over(self, other: Self) -> Self {
        let q = self.high / other.high;
        let rest = self - other * q;
        q.plus_smaller((rest.high + rest.low) / other.high)
    }
}
