//! THE crossing from f64 to f32: world positions become offsets from the camera (or from a bubble's anchor) here.
//!
//! A difference is taken in f64 first, so that what is near stays exact: an offset of `d` metres has an error of at most
//! `d · 2⁻²⁴`. The only other file that may narrow is `scene/gpu_data.rs`; clippy refuses the cast elsewhere.

use super::frame::{Frame, Position, Rotation, Vector};
use glam::{DVec3, Quat, Vec3};

/// Narrows a scalar, rounding to nearest; values beyond `f32` become infinite, as in IEEE 754.
#[allow(clippy::cast_possible_truncation)]
pub const fn narrow(x: f64) -> f32 {
    x as f32
}

/// Narrows a small vector: an offset, a direction, a velocity difference.
#[allow(clippy::disallowed_methods)]
pub fn narrow3(v: DVec3) -> Vec3 {
    v.as_vec3()
}

/// `point − origin` in f32 metres: the offset of a point from the camera or from an anchor.
pub fn offset<F: Frame>(point: Position<F>, origin: Position<F>) -> Vec3 {
    narrow3((point - origin).0)
}

/// Narrows a free vector.
pub fn vector<F: Frame>(v: Vector<F>) -> Vec3 {
    narrow3(v.0)
}

/// Narrows a rotation and renormalises it; the identity where it cannot be normalised.
pub fn rotation<A: Frame, B: Frame>(r: Rotation<A, B>) -> Quat {
    let q = Quat::from_xyzw(narrow(r.0.x), narrow(r.0.y), narrow(r.0.z), narrow(r.0.w));
    let n = q.length();
    if n > 0.5 { q / n } else { Quat::IDENTITY }
}
