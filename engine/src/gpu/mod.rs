//! GPU helpers: device, shaders, textures, buffers, readback, timers. Knows no scene.
//!
//! Start with [`device`] (which backend and why not the others), then [`shader`] (WGSL with `#include` and readable errors).

pub mod buffer;
pub mod device;
pub mod readback;
pub mod shader;
pub mod texture;
pub mod timer;

pub use device::{BackendChoice, Gpu, GpuError};
pub use shader::{ShaderError, ShaderLibrary};
