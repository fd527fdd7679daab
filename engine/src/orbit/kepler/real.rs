//! One number, or several side by side: what the solver is written in, so that one orbit and a batch run the same code.
//!
//! Every operation rounds as IEEE 754 says, on each lane alone, and none is fused: the bits do not depend on the width.

use core::ops::{Add, Div, Mul, Neg, Sub};
use pulp::Simd;

/// An f64, or a register of them.
pub(crate) trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
{
    /// True or false for each lane.
    type Mask: Copy;

    /// `x` in every lane of a number like this one.
    fn all(self, x: f64) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// The larger; `other` where this is not a number.
    fn max(self, other: Self) -> Self;
    /// The smaller; `other` where this is not a number.
    fn min(self, other: Self) -> Self;
    /// Whether self < other.
    fn below(self, other: Self) -> Self::Mask;
    /// Whether self ≤ other.
    fn at_most(self, other: Self) -> Self::Mask;
    fn pick(mask: Self::Mask, a: Self, b: Self) -> Self;
    fn both(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn either(self, a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether the mask holds in any lane, and in all.
    fn any(self, mask: Self::Mask) -> bool;
    fn every(self, mask: Self::Mask) -> bool;
    /// A function of one number (one that reads bits), on each lane.
    fn map(self, f: impl Fn(f64) -> f64) -> Self;

    /// Magnitude of self with the sign of `other`, which is not zero where it matters.
    #[inline(always)]
    fn signed(self, other: Self) -> Self {
        Self::pick(other.below(other.all(0.0)), -self.abs(), self.abs())
    }
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn all(self, x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn below(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn pick(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    #[inline(always)]
    fn both(self, a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn either(self, a: bool, b: bool) -> bool {
        a | b
    }
    #[inline(always)]
    fn any(self, mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn every(self, mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        f(self)
    }
}

/// A register of the machine.
#[derive(Clone, Copy)]
pub(super) struct Lanes<S: Simd>(pub(super) S, pub(super) S::f64s);

macro_rules! operator {
    ($($trait:ident $method:ident $simd:ident;)*) => {$(
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0, self.0.$simd(self.1, other.1))
            }
        }
        impl<S: Simd> $trait<f64> for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                Self(self.0, self.0.$simd(self.1, self.0.splat_f64s(other)))
            }
        }
    )*};
}

operator! { Add add add_f64s; Sub sub sub_f64s; Mul mul mul_f64s; Div div div_f64s; }

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0, self.0.neg_f64s(self.1))
    }
}

impl<S: Simd> Real for Lanes<S> {
    type Mask = S::m64s;

    #[inline(always)]
    fn all(self, x: f64) -> Self {
        Self(self.0, self.0.splat_f64s(x))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt_f64s(self.1))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0, self.0.abs_f64s(self.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::pick(self.0.greater_than_f64s(self.1, other.1), self, other)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::pick(self.0.less_than_f64s(self.1, other.1), self, other)
    }
    #[inline(always)]
    fn below(self, other: Self) -> S::m64s {
        self.0.less_than_f64s(self.1, other.1)
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> S::m64s {
        self.0.less_than_or_equal_f64s(self.1, other.1)
    }
    #[inline(always)]
    fn pick(mask: S::m64s, a: Self, b: Self) -> Self {
        Self(a.0, a.0.select_f64s(mask, a.1, b.1))
    }
    #[inline(always)]
    fn both(self, a: S::m64s, b: S::m64s) -> S::m64s {
        self.0.and_m64s(a, b)
    }
    #[inline(always)]
    fn either(self, a: S::m64s, b: S::m64s) -> S::m64s {
        self.0.or_m64s(a, b)
    }
    #[inline(always)]
    fn any(self, mask: S::m64s) -> bool {
        self.0.first_true_m64s(mask) < S::F64_LANES
    }
    #[inline(always)]
    fn every(self, mask: S::m64s) -> bool {
        self.0.first_true_m64s(self.0.not_m64s(mask)) >= S::F64_LANES
    }
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let mut lanes = self.1;
        for x in pulp::bytemuck::cast_slice_mut::<S::f64s, f64>(core::slice::from_mut(&mut lanes)) {
            *x = f(*x);
        }
        Self(self.0, lanes)
    }
}
