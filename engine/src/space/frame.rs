//! Typed frames: a vector carries the frame that it is written in, so that adding two frames does not compile.
//!
//! | frame | origin | axes |
//! |---|---|---|
//! | [`Icrf`] | solar-system barycentre | ICRF, inertial |
//! | [`Centred`] | the body that dominates (the context says which) | ICRF, inertial |
//! | [`Fixed`] | the body's centre | turn with the body: +Z its pole, +X its prime meridian |
//! | [`Hull`] | the ship's centre of mass | +X right, +Y up (out of the cockpit roof), −Z forward |
//! | [`Anchor`] | a point of a body's surface | +X east, +Y up, −Z north, at rest in [`Fixed`] |
//! | [`View`] | the camera | +X right, +Y up, −Z forward |
//!
//! Transforms read from right to left: `icrf_from_fixed * fixed_vector`.
//! Not here: conversion to `f32` ([`super::relative`]).

use core::fmt;
use core::marker::PhantomData;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};
use glam::{DMat3, DQuat, DVec3};

/// A reference frame: a type without values.
pub trait Frame: Copy + fmt::Debug + PartialEq + 'static {
    /// The name used in messages.
    const NAME: &'static str;
}

macro_rules! frames {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {}
        impl Frame for $name { const NAME: &'static str = stringify!($name); }
    )*};
}
frames! {
    /// Inertial: origin at the solar-system barycentre, ICRF axes.
    Icrf
    /// Inertial axes (ICRF), origin at the centre of the dominating body.
    Centred
    /// Body-fixed: turns with the body; +Z north pole, +X prime meridian at the equator.
    Fixed
    /// The ship's: +X right, +Y up, −Z forward; origin at the centre of mass.
    Hull
    /// A tangent frame at a point of a body's surface: +X east, +Y up, −Z north.
    Anchor
    /// The camera's: +X right, +Y up, −Z forward.
    View
}

macro_rules! vectors {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        pub struct $name<F: Frame>(pub DVec3, PhantomData<F>);
        impl<F: Frame> $name<F> {
            /// All components zero.
            pub const ZERO: Self = Self(DVec3::ZERO, PhantomData);
            /// Wraps a raw vector that the caller knows to be written in frame `F`.
            pub const fn new(v: DVec3) -> Self { Self(v, PhantomData) }
            /// Components `(x, y, z)` in frame `F`.
            pub const fn xyz(x: f64, y: f64, z: f64) -> Self { Self(DVec3::new(x, y, z), PhantomData) }
            /// Euclidean length, in the unit of the components.
            pub fn length(self) -> f64 { self.0.length() }
            /// True when every component is finite.
            pub fn is_finite(self) -> bool { self.0.is_finite() }
        }
        impl<F: Frame> Clone for $name<F> { fn clone(&self) -> Self { *self } }
        impl<F: Frame> Copy for $name<F> {}
        impl<F: Frame> PartialEq for $name<F> { fn eq(&self, o: &Self) -> bool { self.0 == o.0 } }
        impl<F: Frame> Default for $name<F> { fn default() -> Self { Self::ZERO } }
        impl<F: Frame> fmt::Debug for $name<F> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}<{}>({}, {}, {})", stringify!($name), F::NAME, self.0.x, self.0.y, self.0.z)
            }
        }
    )*};
}
vectors! {
    /// A point, in metres from the origin of `F`.
    Position
    /// A difference of points, a force, a direction …: a free vector in the axes of `F`.
    Vector
    /// A velocity, in m/s, as seen in `F`.
    Velocity
}

impl<F: Frame> Sub for Position<F> {
    type Output = Vector<F>;
    fn sub(self, o: Self) -> Vector<F> {
        Vector::new(self.0 - o.0)
    }
}
impl<F: Frame> Add<Vector<F>> for Position<F> {
    type Output = Self;
    fn add(self, v: Vector<F>) -> Self {
        Self::new(self.0 + v.0)
    }
}
impl<F: Frame> Sub<Vector<F>> for Position<F> {
    type Output = Self;
    fn sub(self, v: Vector<F>) -> Self {
        Self::new(self.0 - v.0)
    }
}
impl<F: Frame> AddAssign<Vector<F>> for Position<F> {
    fn add_assign(&mut self, v: Vector<F>) {
        self.0 += v.0;
    }
}

macro_rules! linear {
    ($($name:ident)*) => {$(
        impl<F: Frame> Add for $name<F> { type Output = Self; fn add(self, o: Self) -> Self { Self::new(self.0 + o.0) } }
        impl<F: Frame> Sub for $name<F> { type Output = Self; fn sub(self, o: Self) -> Self { Self::new(self.0 - o.0) } }
        impl<F: Frame> Neg for $name<F> { type Output = Self; fn neg(self) -> Self { Self::new(-self.0) } }
        impl<F: Frame> Mul<f64> for $name<F> { type Output = Self; fn mul(self, s: f64) -> Self { Self::new(self.0 * s) } }
        impl<F: Frame> AddAssign for $name<F> { fn add_assign(&mut self, o: Self) { self.0 += o.0; } }
    )*};
}
linear! { Vector Velocity }

impl<F: Frame> Position<F> {
    /// The free vector from the origin to this point.
    pub const fn from_origin(self) -> Vector<F> {
        Vector::new(self.0)
    }
}
impl<F: Frame> Velocity<F> {
    /// The displacement over `dt_s` seconds at this velocity.
    pub fn over(self, dt_s: f64) -> Vector<F> {
        Vector::new(self.0 * dt_s)
    }
}

/// A rotation that takes vectors written in the axes of `From` to the axes of `To`. Name it `to_from_from`.
pub struct Rotation<To: Frame, From: Frame>(pub DQuat, PhantomData<(To, From)>);

impl<To: Frame, From: Frame> Rotation<To, From> {
    /// The axes of both frames coincide.
    pub const IDENTITY: Self = Self(DQuat::IDENTITY, PhantomData);
    /// Wraps a unit quaternion that the caller knows to rotate `From` axes into `To` axes.
    pub const fn new(q: DQuat) -> Self {
        Self(q, PhantomData)
    }
    /// From a matrix whose columns are the axes of `From` written in `To`.
    pub fn from_columns(m: DMat3) -> Self {
        Self::new(DQuat::from_mat3(&m))
    }
    /// The rotation the other way.
    pub fn inverse(self) -> Rotation<From, To> {
        Rotation::new(self.0.conjugate())
    }
    /// Rotates a free vector.
    pub fn vector(self, v: Vector<From>) -> Vector<To> {
        Vector::new(self.0 * v.0)
    }
    /// Rotates a raw vector (the caller vouches for its frame).
    pub fn raw(self, v: DVec3) -> DVec3 {
        self.0 * v
    }
    /// Rotates a position; right only where both frames share their origin.
    pub fn position(self, p: Position<From>) -> Position<To> {
        Position::new(self.0 * p.0)
    }
}
impl<A: Frame, B: Frame> Clone for Rotation<A, B> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<A: Frame, B: Frame> Copy for Rotation<A, B> {}
impl<A: Frame, B: Frame> PartialEq for Rotation<A, B> {
    fn eq(&self, o: &Self) -> bool {
        self.0 == o.0
    }
}
impl<A: Frame, B: Frame> fmt::Debug for Rotation<A, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Rotation<{} from {}>({:?})", A::NAME, B::NAME, self.0)
    }
}
impl<A: Frame, B: Frame, C: Frame> Mul<Rotation<B, C>> for Rotation<A, B> {
    type Output = Rotation<A, C>;
    fn mul(self, o: Rotation<B, C>) -> Rotation<A, C> {
        Rotation::new(self.0 * o.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_chain_and_invert() {
        let icrf_from_fixed = Rotation::<Icrf, Fixed>::new(DQuat::from_rotation_z(0.3));
        let fixed_from_hull = Rotation::<Fixed, Hull>::new(DQuat::from_rotation_x(-1.1));
        let v = Vector::<Hull>::xyz(1.0, 2.0, 3.0);
        let there = (icrf_from_fixed * fixed_from_hull).vector(v);
        let back = (icrf_from_fixed * fixed_from_hull).inverse().vector(there);
        assert!((back.0 - v.0).length() < 1e-15 * 8.0);
        assert!((there.0 - icrf_from_fixed.vector(fixed_from_hull.vector(v)).0).length() < 1e-15 * 8.0);
    }
}
