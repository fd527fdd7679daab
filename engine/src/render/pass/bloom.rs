//! Bloom: the glare of a lens and an eye. Without a threshold and conserving energy: a small share of the light is spread
//! over a chain of ever smaller pictures, and taken from where it came [Jimenez 2014, "Next Generation Post Processing in Call of Duty"].

use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, sampler_entry, texture_entry};
use crate::render::shared::{FrameContext, Shared};
use crate::render::targets::HDR;
use wgpu::{BindGroupEntry, BindingResource};

/// Share of the light that is spread; the tone-mapping pass mixes it in.
pub const SHARE: f32 = 0.02;

/// The pass.
pub struct Bloom {
    layout: wgpu::BindGroupLayout,
    down: wgpu::RenderPipeline,
    up: wgpu::RenderPipeline,
}

impl Bloom {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("bloom"),
            entries: &[texture_entry(0, wgpu::TextureViewDimension::D2), sampler_entry(1, wgpu::SamplerBindingType::Filtering)],
        });
        let module = shaders.load(&gpu.device, "pass/bloom.wgsl")?;
        let groups = [&shared.frame_layout, &layout];
        // Up: half of what is there, half of the wider level.
        let mix = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::OneMinusConstant,
            operation: wgpu::BlendOperation::Add,
        };
        let kind = |up: f64| [("up", up)];
        let down = PipelineKind { constants: &kind(0.0), ..PipelineKind::full_screen("bloom down", &module, &groups, HDR) }.make(gpu);
        let up = PipelineKind {
            constants: &kind(1.0),
            blend: Some(wgpu::BlendState { color: mix, alpha: mix }),
            ..PipelineKind::full_screen("bloom up", &module, &groups, HDR)
        }
        .make(gpu);
        Ok(Self { layout, down, up })
    }

    /// Spreads `lit` over the chain; the picture to mix in.
    pub fn record(&self, f: &mut FrameContext<'_>, lit: &wgpu::TextureView) -> wgpu::TextureView {
        let levels = &f.targets.bloom_levels;
        for (i, level) in levels.iter().enumerate() {
            let from = if i == 0 { lit } else { &levels[i - 1] };
            self.draw(f, from, level, &self.down, None);
        }
        for i in (1..levels.len()).rev() {
            // Half to the wider level each time: level k keeps 2^−(k+1) of the spread light.
            self.draw(f, &levels[i], &levels[i - 1], &self.up, Some(0.5));
        }
        levels[0].clone()
    }

    fn draw(
        &self,
        f: &mut FrameContext<'_>,
        from: &wgpu::TextureView,
        to: &wgpu::TextureView,
        pipeline: &wgpu::RenderPipeline,
        mix: Option<f64>,
    ) {
        let group = f.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("bloom"),
            layout: &self.layout,
            entries: &[
                BindGroupEntry { binding: 0, resource: BindingResource::TextureView(from) },
                BindGroupEntry { binding: 1, resource: BindingResource::Sampler(&f.shared.linear) },
            ],
        });
        let mut pass = f.draw_full_screen("bloom", to, mix.is_some());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(1, &group, &[]);
        if let Some(m) = mix {
            pass.set_blend_constant(wgpu::Color { r: m, g: m, b: m, a: m });
        }
        pass.draw(0..3, 0..1);
    }
}
