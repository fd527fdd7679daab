//! How the model `thickness` draws: `shaders/lib/thickness.wgsl`, from its settings alone. It has no tables.
//!
//! A bank of fog within another's air was preceded by the whole of that air; what of it lies before the bank is laid over it
//! (`held` of the shader).

use super::{Draw, FRONT_RATE, Painter, PainterKind, Parts, no_settings};
use crate::air::model::Thickness as Settings;
use crate::air::model::thickness::ShadowShape;
use crate::air::{Air, Model};
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, texture_entry};
use crate::render::shared::FrameContext;
use crate::render::targets::HDR;
use crate::scene::gpu_data::{SkySettings, vec4};
use crate::scene::{Body, Surface};
use crate::space::relative::narrow;
use wgpu::{BindGroupEntry, BindingResource};

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    let kind = PainterKind::new(parts, "pass/sky_thickness.wgsl", &[0, 1].map(|i| texture_entry(i, wgpu::TextureViewDimension::D2)))?;
    let groups = [&parts.shared.frame_layout, &parts.shared.light_layout, parts.picture, &kind.own_layout];
    let held = PipelineKind { entry: "held", ..PipelineKind::full_screen("sky", &kind.module, &groups, HDR) }.make(parts.gpu);
    let dark = Texture::new(&parts.gpu.device, "no air", [1, 1], HDR, wgpu::TextureUsages::TEXTURE_BINDING);
    let none = group(parts.gpu, &kind.own_layout, [&dark.view; 2]);
    Ok(Box::new(Thickness { kind, held, none, front: None }))
}

fn group(gpu: &Gpu, layout: &wgpu::BindGroupLayout, views: [&wgpu::TextureView; 2]) -> wgpu::BindGroup {
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("group 3: thickness"),
        layout,
        entries: &[0, 1].map(|i| BindGroupEntry { binding: [0, 1][i], resource: BindingResource::TextureView(views[i]) }),
    })
}

/// The painter.
struct Thickness {
    kind: PainterKind,
    /// Draws a bank within another's air.
    held: wgpu::RenderPipeline,
    /// Group 3 where nothing is read from it.
    none: wgpu::BindGroup,
    /// Group 3 for the bank that is being drawn.
    front: Option<wgpu::BindGroup>,
}

impl Painter for Thickness {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, body: &Body, air: &Air) -> SkySettings {
        let Model::Thickness(model) = &air.model else { return no_settings() };
        settings(model, air, matches!(body.surface, Surface::Nothing))
    }
    fn before(&mut self, f: &mut FrameContext<'_>, draw: &Draw<'_>) {
        let views = f.targets.sky_at(FRONT_RATE).light.each_ref().map(|t| &t.view);
        self.front = draw.held.then(|| group(f.gpu, &self.kind.own_layout, views));
    }
    fn pipeline(&self) -> &wgpu::RenderPipeline {
        if self.front.is_some() { &self.held } else { &self.kind.pipeline }
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        self.front.as_ref().unwrap_or(&self.none)
    }
}

/// As the head of the shader says; `bare` where there is no ground to end a ray.
fn settings(model: &Settings, air: &Air, bare: bool) -> SkySettings {
    let mut rows = no_settings();
    let flag = |on: bool| if on { 1.0 } else { 0.0 };
    rows[0] = vec4(model.colour * (model.brightness * core::f32::consts::FRAC_1_PI), model.shadow_share);
    rows[1] = [narrow(1.0 / model.unit_m(&air.medium)), model.opacity, flag(model.shadow == ShadowShape::Cone), flag(bare)];
    rows
}
