//! How the model `thickness` draws: `shaders/lib/thickness.wgsl`, from its settings alone. It has no tables.

use super::{Painter, PainterKind, Parts, no_settings};
use crate::air::model::Thickness as Settings;
use crate::air::model::thickness::ShadowShape;
use crate::air::{Air, Model};
use crate::render::RenderError;
use crate::scene::gpu_data::{SkySettings, vec4};
use crate::scene::{Body, Surface};
use crate::space::relative::narrow;

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    let kind = PainterKind::new(parts, "pass/sky_thickness.wgsl", &[])?;
    let none = parts.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("group 3: thickness"),
        layout: &kind.own_layout,
        entries: &[],
    });
    Ok(Box::new(Thickness { kind, none }))
}

/// The painter.
struct Thickness {
    kind: PainterKind,
    none: wgpu::BindGroup,
}

impl Painter for Thickness {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, body: &Body, air: &Air) -> SkySettings {
        let Model::Thickness(model) = &air.model else { return no_settings() };
        settings(model, air, matches!(body.surface, Surface::Nothing))
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        &self.none
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
