//! Tone mapping: exposed HDR to display values, edges of solid things smoothed, dithered so that no gradient bands.

use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pass::bloom;
use crate::render::pipeline::{PipelineKind, depth_entry, sampler_entry, texture_entry, uniform_entry};
use crate::render::shared::{FrameContext, Shared};
use std::collections::BTreeMap;
use wgpu::BindGroupEntry;

/// The pass.
pub struct Tonemap {
    module: wgpu::ShaderModule,
    layout: wgpu::BindGroupLayout,
    frame_layout: wgpu::BindGroupLayout,
    /// By format of the target (its name: formats have no order).
    pipelines: BTreeMap<String, wgpu::RenderPipeline>,
}

impl Tonemap {
    /// Compiles the shader; pipelines follow with the first target of a format.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/tonemap.wgsl")?;
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("tonemap"),
            entries: &[
                texture_entry(0, wgpu::TextureViewDimension::D2),
                uniform_entry(1),
                texture_entry(2, wgpu::TextureViewDimension::D2),
                sampler_entry(3, wgpu::SamplerBindingType::Filtering),
                depth_entry(4),
            ],
        });
        Ok(Self { module, layout, frame_layout: shared.frame_layout.clone(), pipelines: BTreeMap::new() })
    }

    /// Writes the picture from the light and its glare.
    pub fn record(
        &mut self,
        f: &mut FrameContext<'_>,
        lit: &wgpu::TextureView,
        glare: &wgpu::TextureView,
        view: &wgpu::TextureView,
        format: wgpu::TextureFormat,
    ) {
        let pipeline = self.pipelines.entry(format!("{format:?}")).or_insert_with(|| {
            let constants = [("encode", f64::from(u8::from(!format.is_srgb()))), ("glare_share", f64::from(bloom::SHARE))];
            let groups = [&self.frame_layout, &self.layout];
            PipelineKind { constants: &constants, ..PipelineKind::full_screen("tonemap", &self.module, &groups, format) }.make(f.gpu)
        });
        let group = f.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tonemap"),
            layout: &self.layout,
            entries: &[
                BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(lit) },
                BindGroupEntry { binding: 1, resource: f.shared.exposure_next.buffer.as_entire_binding() },
                BindGroupEntry { binding: 2, resource: wgpu::BindingResource::TextureView(glare) },
                BindGroupEntry { binding: 3, resource: wgpu::BindingResource::Sampler(&f.shared.linear) },
                BindGroupEntry { binding: 4, resource: wgpu::BindingResource::TextureView(&f.targets.depth.view) },
            ],
        });
        let mut pass = f.draw_full_screen("tonemap", view, false);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}
