//! GPU helpers: device, shaders, textures, buffers, readback, timers. Knows no scene.
