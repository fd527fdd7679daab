//! How the model `physical` draws: `shaders/lib/physical.wgsl`, with the air tables of group 1. It has no tables of its own.

use super::{Painter, PainterKind, Parts, Variant, no_settings};
use crate::air::{Air, Classes};
use crate::render::RenderError;
use crate::scene::Body;
use crate::scene::gpu_data::SkySettings;

/// What most airs do without: media that are tables, and shadows of other worlds.
const PLAIN: [(&str, f64); 2] = [("MEDIA_TABLES", 0.0), ("AIR_ECLIPSES", 0.0)];

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
        let kind = PainterKind::with_plain(parts, "pass/sky_physical.wgsl", &[], &PLAIN)?;
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
    fn variant(&self, body: &Body, air: &Air) -> Variant {
        let simple = body.occluders.is_empty() && Classes::of(&air.medium).direct && air.medium.jumps_m(1).is_empty();
        if simple { Variant::Plain } else { Variant::Full }
    }
    fn settings(&self, _body: &Body, _air: &Air) -> SkySettings {
        no_settings()
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        &self.none
    }
}
