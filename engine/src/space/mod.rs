//! Space: positions that know their frame, the one crossing from f64 to f32, and directions on a sphere.
//!
//! Start with [`frame`], which names the frames; [`relative`] is where a position in the solar system becomes an `f32`
//! offset from the camera, and nowhere else; [`sphere`] maps directions to latitude/longitude and to cube faces.

pub mod frame;
pub mod relative;
pub mod sphere;

pub use frame::{Anchor, Centred, Fixed, Frame, Hull, Icrf, Position, Rotation, Vector, Velocity, View};
