//! Textures: shorthand for the few kinds that the frame uses.

/// A 2-D texture with its default view.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The texture.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
}

impl Texture {
    /// A 2-D texture of one level.
    pub fn new(device: &wgpu::Device, label: &str, size: [u32; 2], format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> Self {
        Self::with(device, label, [size[0], size[1], 1], 1, format, usage)
    }

    /// A 2-D texture (array when `size[2] > 1`) with mip levels. The view of an array is an array.
    pub fn with(
        device: &wgpu::Device,
        label: &str,
        size: [u32; 3],
        levels: u32,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0].max(1), height: size[1].max(1), depth_or_array_layers: size[2].max(1) },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// A 3-D texture of one level.
    pub fn volume(device: &wgpu::Device, label: &str, size: [u32; 3], format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0].max(1), height: size[1].max(1), depth_or_array_layers: size[2].max(1) },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format,
            usage,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// A view as a 2-D array, also where there is one layer only.
    pub fn array_view(&self) -> wgpu::TextureView {
        self.texture
            .create_view(&wgpu::TextureViewDescriptor { dimension: Some(wgpu::TextureViewDimension::D2Array), ..Default::default() })
    }

    /// A view of one layer of an array, as a plain texture.
    pub fn layer_view(&self, layer: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    }

    /// A view of one mip level.
    pub fn level_view(&self, level: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor { base_mip_level: level, mip_level_count: Some(1), ..Default::default() })
    }

    /// Writes rows of one level of one layer; `texels` is tightly packed.
    pub fn write(&self, queue: &wgpu::Queue, level: u32, layer: u32, texels: &[u8]) {
        let size = self.texture.size();
        let (w, h) = ((size.width >> level).max(1), (size.height >> level).max(1));
        let bytes = self.texture.format().block_copy_size(None).unwrap_or(4);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &self.texture,
                mip_level: level,
                origin: wgpu::Origin3d { x: 0, y: 0, z: layer },
                aspect: wgpu::TextureAspect::All,
            },
            texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(w * bytes), rows_per_image: Some(h) },
            wgpu::Extent3d { width: w, height: h, depth_or_array_layers: 1 },
        );
    }
}

/// A sampler that interpolates (also between levels); `wrap_u` repeats in u, for maps around a sphere.
pub fn linear_sampler(device: &wgpu::Device, label: &str, wrap_u: bool) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some(label),
        address_mode_u: if wrap_u { wgpu::AddressMode::Repeat } else { wgpu::AddressMode::ClampToEdge },
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        anisotropy_clamp: if wrap_u { 4 } else { 1 },
        ..Default::default()
    })
}
