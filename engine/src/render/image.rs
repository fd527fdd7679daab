//! Images in memory: a target that is not a window, and the linear picture that is read back.

use super::RenderError;
use crate::gpu::{Gpu, readback, texture::Texture};

/// A target in memory.
#[derive(Clone, Debug)]
pub struct OffscreenImage {
    /// Its texture.
    pub colour: Texture,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

impl OffscreenImage {
    /// sRGB-encoded by the tone-mapping pass itself.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// An image of this size (each side at least 1, at most what the device can hold).
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let most = gpu.device.limits().max_texture_dimension_2d;
        let size = size.map(|n| n.clamp(1, most));
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
        Self { colour: Texture::new(&gpu.device, "offscreen image", size, Self::FORMAT, usage), size }
    }

    /// sRGB-encoded RGBA, 4 bytes a pixel, rows from the top.
    pub fn read_rgba8(&self, gpu: &Gpu) -> Result<Vec<u8>, RenderError> {
        Ok(readback::texture(gpu, &self.colour.texture, 0)?)
    }
}

/// A scene-linear picture: luminance in cd/m² per linear sRGB channel, before exposure.
#[derive(Clone, Debug, PartialEq)]
pub struct HdrImage {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// RGBA, rows from the top; A is 1.
    pub rgba: Vec<f32>,
}
