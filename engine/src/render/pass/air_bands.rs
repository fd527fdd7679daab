//! Mixes the tables of an air's two band media into its own, in linear sRGB, for all who ask how light reaches a surface.
//!
//! What bands are: [`crate::air::spectral::bands`]. The shader is `shaders/pass/air_bands.wgsl`; the ray of sight is mixed where it is drawn
//! (`shaders/pass/sky_physical.wgsl`).

use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, loaded_entry, stored_texture_entry, uniform_entry};
use crate::render::targets::HDR;
use wgpu::{BindGroupEntry, BindingResource, TextureView, TextureViewDimension};

/// The pass.
pub struct BandMixer {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

/// Views of one layer each: those written as 2-D textures, those read as arrays.
pub struct Tables {
    /// Transmittance and irradiance of the air itself.
    pub own: [TextureView; 2],
    /// Transmittance of the one band medium and of the other, then their irradiance.
    pub bands: [TextureView; 4],
}

impl BandMixer {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary) -> Result<Self, RenderError> {
        let written = |binding| stored_texture_entry(binding, HDR, TextureViewDimension::D2);
        let read = |binding| loaded_entry(binding, TextureViewDimension::D2Array);
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("air bands"),
            entries: &[uniform_entry(0), written(1), written(2), read(3), read(4), read(5), read(6)],
        });
        let module = shaders.load(&gpu.device, "pass/air_bands.wgsl")?;
        let pipeline = compute_pipeline(gpu, "air_bands", &module, &[&layout], "bake");
        Ok(Self { layout, pipeline })
    }

    /// Records it for the air of this uniform; `size` is that of the larger table.
    pub fn mix(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, air: wgpu::BufferBinding<'_>, tables: &Tables, size: [u32; 2]) {
        let views = tables.own.iter().chain(&tables.bands).zip(1..);
        let mut entries = vec![BindGroupEntry { binding: 0, resource: BindingResource::Buffer(air) }];
        entries.extend(views.map(|(view, binding)| BindGroupEntry { binding, resource: BindingResource::TextureView(view) }));
        let group =
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("air bands"), layout: &self.layout, entries: &entries });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(size[0].div_ceil(8), size[1].div_ceil(8), 1);
    }
}
