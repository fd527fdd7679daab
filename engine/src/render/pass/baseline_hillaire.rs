//! A baseline for `bench air`, not used by any picture: Hillaire's table of isotropic multiple scattering, as he describes it.
//!
//! Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", §5.5; the shader of the same name has the
//! formulas. What the model `physical` does instead: [`super::air_orders`].

use crate::gpu::texture::{Texture, linear_sampler};
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, loaded_entry, sampler_entry, stored_texture_entry, texture_entry, uniform_entry};
use crate::render::shared::AirTables;
use crate::render::targets::HDR;
use crate::scene::gpu_data::AirUniform;
use wgpu::{BindGroupEntry, BindingResource, TextureUsages, TextureViewDimension};

/// Texels of the table: the sun's cosine by its signed root, altitude by its root. They hold square roots.
pub const SIZE: [u32; 2] = [64, 32];

/// The pass.
pub struct HillaireBaker {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    linear: wgpu::Sampler,
}

impl HillaireBaker {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary) -> Result<Self, RenderError> {
        let array = TextureViewDimension::D2Array;
        let written = stored_texture_entry(1, HDR, TextureViewDimension::D2);
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("baseline hillaire"),
            entries: &[
                uniform_entry(0),
                written,
                loaded_entry(2, array),
                texture_entry(3, array),
                sampler_entry(4, wgpu::SamplerBindingType::Filtering),
            ],
        });
        let module = shaders.load(&gpu.device, "pass/baseline_hillaire.wgsl")?;
        let pipeline = compute_pipeline(gpu, "baseline_hillaire", &module, &[&layout], "bake");
        Ok(Self { layout, pipeline, linear: linear_sampler(&gpu.device, "baseline hillaire", false) })
    }

    /// The table of the air in slot 0 of `tables`.
    pub fn bake(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, tables: &AirTables) -> Texture {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC;
        let table = Texture::new(&gpu.device, "baseline hillaire", SIZE, HDR, usage);
        let air = wgpu::BufferBinding { buffer: &tables.airs, offset: 0, size: wgpu::BufferSize::new(size_of::<AirUniform>() as u64) };
        let resources = [
            BindingResource::Buffer(air),
            BindingResource::TextureView(&table.view),
            BindingResource::TextureView(&tables.media),
            BindingResource::TextureView(&tables.transmittance),
            BindingResource::Sampler(&self.linear),
        ];
        let entries: Vec<_> = (0..).zip(resources).map(|(binding, resource)| BindGroupEntry { binding, resource }).collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("baseline hillaire"),
            layout: &self.layout,
            entries: &entries,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(SIZE[0], SIZE[1], 1);
        table
    }
}
