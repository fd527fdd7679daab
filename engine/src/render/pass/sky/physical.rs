//! How the model `physical` draws: `shaders/lib/physical.wgsl`, with the air tables of group 1. It has no tables of its own.

use super::{Painter, PainterKind, Parts, no_settings};
use crate::air::Air;
use crate::render::RenderError;
use crate::scene::Body;
use crate::scene::gpu_data::SkySettings;

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    Ok(Box::new(Physical::new(parts)?))
}

/// The painter.
struct Physical {
    kind: PainterKind,
    none: wgpu::BindGroup,
}

impl Physical {
    fn new(parts: &Parts<'_>) -> Result<Self, RenderError> {
        let kind = PainterKind::new(parts, "pass/sky_physical.wgsl", &[])?;
        let none = parts.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("group 3: physical"),
            layout: &kind.own_layout,
            entries: &[],
        });
        Ok(Self { kind, none })
    }
}

impl Painter for Physical {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, _air: &Air) -> SkySettings {
        no_settings()
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        &self.none
    }
}
