//! The scene: everything that a frame is drawn from, as plain f32 data relative to the camera. No wgpu here.
//!
//! [`snapshot`] is the list; [`camera`] holds the projection; [`gpu_data`] the `#[repr(C)]` mirrors of WGSL structs;
//! [`second_light`] finds which world shines on which.

pub mod camera;
pub mod gpu_air;
pub mod gpu_data;
pub mod gpu_terrain;
pub mod second_light;
pub mod snapshot;

pub use camera::Camera;
pub use second_light::SecondLight;
pub use snapshot::{AutoOr, Body, Force, Occluder, Ship, Snapshot, Star, Surface};
