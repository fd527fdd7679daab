//! The view: where the eye is, and what a frame is drawn from.
//!
//! [`rig`] places the camera (cockpit, chase, free, map, a place on the ground); [`snapshot`] crosses from the World's f64 to
//! the scene's f32, once, and `fog` adds what is nothing but air. [`place`] reads the `--camera` argument. Not here: pixels.

mod fog;
pub mod place;
pub mod rig;
pub mod snapshot;

pub use rig::{CameraMode, Eye, Rig};
pub use snapshot::{Picture, snapshot};
