//! Targets: every texture sized by the picture, in one table.

use super::pipeline::Stencil;
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use wgpu::TextureUsages as Use;

/// Format of the HDR targets.
pub const HDR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of the depth target: infinite reversed-Z, cleared to 0, compared with Greater.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Format of [`SkyLevel::light`]: depths are compared with those of pixels to the last bits.
pub const SKY_LEVEL: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// Format of [`SkyLevel::plan`].
pub const SKY_PLAN: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;
/// Levels of the bloom chain at most.
pub const BLOOM_LEVELS: u32 = 7;

/// Light of an air at every so-manieth pixel of every so-manieth row, and at one beyond the last.
#[derive(Debug)]
pub struct SkyLevel {
    /// Radiance, pre-exposed, and depth; transmittance. What the channels hold: `shaders/pass/sky_physical.wgsl`.
    pub light: [Texture; 2],
    /// What becomes of the cell between a texel and the next ones.
    pub plan: Texture,
}

/// The table.
#[derive(Debug)]
pub struct Targets {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Opaque things, stars and the sun's disc; pre-exposed. Airs that cover only a part of the picture are laid over it here.
    pub opaque: Texture,
    /// The same behind an air that covers the whole picture; written by the sky pass.
    pub aerial: Texture,
    /// Light of an air at every second and every eighth pixel; the sky pass's own.
    pub sky: [SkyLevel; 2],
    /// Marks what has been drawn of an air.
    pub sky_stencil: Texture,
    /// Depth of opaque things.
    pub depth: Texture,
    /// Bloom chain: level 0 is half the picture.
    pub bloom: Texture,
    /// Views of each bloom level.
    pub bloom_levels: Vec<wgpu::TextureView>,
}

impl Targets {
    /// All textures for a picture of this size.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Self {
        let d = &gpu.device;
        let hdr = Use::RENDER_ATTACHMENT | Use::TEXTURE_BINDING | Use::COPY_SRC | Use::COPY_DST;
        let half = size.map(|n| n.div_ceil(2).max(1));
        let levels = (half[0].min(half[1]).ilog2() + 1).min(BLOOM_LEVELS);
        let bloom = Texture::with(d, "bloom", [half[0], half[1], 1], levels, HDR, hdr);
        Self {
            size,
            opaque: Texture::new(d, "hdr opaque", size, HDR, hdr),
            sky: [2, 8].map(|rate| {
                let part = size.map(|n: u32| n.div_ceil(rate).max(1) + 1);
                SkyLevel {
                    light: ["sky radiance", "sky transmittance"].map(|name| Texture::new(d, name, part, SKY_LEVEL, hdr)),
                    plan: Texture::new(d, "sky plan", part, SKY_PLAN, hdr),
                }
            }),
            sky_stencil: Texture::new(d, "sky stencil", size, Stencil::FORMAT, Use::RENDER_ATTACHMENT),
            aerial: Texture::new(d, "hdr aerial", size, HDR, hdr),
            depth: Texture::new(d, "depth", size, DEPTH, hdr),
            bloom_levels: (0..levels).map(|i| bloom.level_view(i)).collect(),
            bloom,
        }
    }

    /// That of [`Targets::sky`] of every `rate`-th pixel: 2 or 8.
    pub const fn sky_at(&self, rate: u32) -> &SkyLevel {
        if rate == 8 { &self.sky[1] } else { &self.sky[0] }
    }
}
