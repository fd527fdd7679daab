//! How the model `physical` draws: `shaders/lib/physical.wgsl`, with the air tables of group 1.
//!
//! The march is made at every eighth pixel of every eighth row first, then at every fourth, second and one, where a pixel between four that agree
//! takes their mean and any other marches by itself. Where another world's shadow may fall, which may be small, and where density jumps, the
//! first is every second. A forced frame marches at every pixel: the two differ by the bound that is stated at [`AGREE`].

use super::{Draw, Painter, PainterKind, Parts, no_settings};
use crate::air::{Air, Classes, Medium};
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, Stencil, texture_entry};
use crate::render::shared::FrameContext;
use crate::render::targets::HDR;
use crate::scene::Body;
use crate::scene::gpu_data::{SkySettings, vec4};
use crate::space::relative::narrow3;
use glam::{DVec3, Vec3};
use wgpu::{BindGroupEntry, BindingResource};

/// Of its colour, how much a pixel may differ from those around it and still take their mean. What varies evenly by this much is then right to an
/// eighth of its square, 3e-3; the bend of an edge to a quarter, 4 %, on a line one pixel wide.
pub const AGREE: f32 = 0.16;

/// What most airs do without: media that are tables, and shadows of other worlds.
const PLAIN: [(&str, f64); 2] = [("MEDIA_TABLES", 0.0), ("AIR_ECLIPSES", 0.0)];

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    Ok(Box::new(Physical::new(parts)?))
}

/// The pipelines for one kind of air.
struct Rates {
    /// A march at every pixel.
    full: wgpu::RenderPipeline,
    /// The levels, from the coarsest to every pixel.
    levels: Vec<Level>,
    /// The picture from the last of those.
    lay: wgpu::RenderPipeline,
}

/// One level: of every so-manieth pixel of every so-manieth row.
struct Level {
    rate: u32,
    /// Takes what it can from the level before; not on the first.
    take: Option<wgpu::RenderPipeline>,
    /// Marches at what is left.
    march: wgpu::RenderPipeline,
}

/// The painter.
struct Physical {
    kind: PainterKind,
    /// For any air, and for airs that do without [`PLAIN`]'s.
    rates: [Rates; 2],
    /// Group 3 where nothing is read from it.
    none: wgpu::BindGroup,
    /// Group 3 for the body that is being drawn, and its pipeline.
    chosen: Option<(wgpu::BindGroup, wgpu::RenderPipeline)>,
}

impl Physical {
    fn new(parts: &Parts<'_>) -> Result<Self, RenderError> {
        let own = [0, 1].map(|i| texture_entry(i, wgpu::TextureViewDimension::D2));
        let kind = PainterKind::new(parts, "pass/sky_physical.wgsl", &own)?;
        let groups = [&parts.shared.frame_layout, &parts.shared.light_layout, parts.picture, &kind.own_layout];
        let rates = [(&[][..], &[2, 1][..]), (&PLAIN[..], &[8, 4, 2, 1][..])].map(|(constants, levels)| {
            let plain = PipelineKind { constants, ..PipelineKind::full_screen("sky", &kind.module, &groups, HDR) };
            let at = |rate: u32, entry, stencil| {
                let constants = &[constants, &[("RATE", f64::from(rate))]].concat();
                let kind = PipelineKind::full_screen("sky", &kind.module, &groups, HDR);
                PipelineKind { entry, colours: 2, constants, stencil, ..kind }.make(parts.gpu)
            };
            let level = |(i, rate): (usize, &u32)| Level {
                rate: *rate,
                take: (i > 0).then(|| at(*rate, "take_level", Some(Stencil::Marks))),
                march: at(*rate, "march_level", (i > 0).then_some(Stencil::Unmarked)),
            };
            Rates {
                full: plain.make(parts.gpu),
                levels: levels.iter().enumerate().map(level).collect(),
                lay: PipelineKind { entry: "lay", ..plain }.make(parts.gpu),
            }
        });
        let dark = Texture::new(&parts.gpu.device, "no air", [1, 1], HDR, wgpu::TextureUsages::TEXTURE_BINDING);
        let none = group(parts.gpu, &kind.own_layout, [&dark.view; 2]);
        Ok(Self { kind, rates, none, chosen: None })
    }
}

impl Painter for Physical {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, air: &Air) -> SkySettings {
        let mut all = no_settings();
        all[0] = vec4(greatest_extinction(&air.medium), AGREE);
        all
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        self.chosen.as_ref().map_or(&self.none, |c| &c.0)
    }
    fn pipeline(&self) -> &wgpu::RenderPipeline {
        self.chosen.as_ref().map_or(&self.kind.pipeline, |c| &c.1)
    }
    fn before(&mut self, f: &mut FrameContext<'_>, draw: &Draw<'_>) {
        let medium = &draw.air.medium;
        let plain = draw.body.occluders.is_empty() && Classes::of(medium).direct && medium.cuts_m(1).is_empty();
        let rates = &self.rates[usize::from(plain)];
        if f.scene.force.all {
            self.chosen = Some((self.none.clone(), rates.full.clone()));
            return;
        }
        let mut from = self.none.clone();
        for level in &rates.levels {
            let target = f.targets.sky_at(level.rate);
            let views = target.light.each_ref().map(|t| &t.view);
            let rect = draw.rect.every(level.rate, f.targets.size);
            let mut pass = f.draw_pair("sky", views, level.take.as_ref().map(|_| &target.stencil.view));
            pass.set_bind_group(1, draw.light, &[]);
            pass.set_bind_group(2, draw.picture, &[]);
            pass.set_bind_group(3, &from, &[]);
            pass.set_scissor_rect(rect.left, rect.top, rect.width, rect.height);
            for pipeline in level.take.iter().chain([&level.march]) {
                pass.set_pipeline(pipeline);
                pass.draw(0..3, 0..1);
            }
            drop(pass);
            from = group(f.gpu, &self.kind.own_layout, views);
        }
        self.chosen = Some((from, rates.lay.clone()));
    }
}

fn group(gpu: &Gpu, layout: &wgpu::BindGroupLayout, views: [&wgpu::TextureView; 2]) -> wgpu::BindGroup {
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("group 3: physical"),
        layout,
        entries: &[
            BindGroupEntry { binding: 0, resource: BindingResource::TextureView(views[0]) },
            BindGroupEntry { binding: 1, resource: BindingResource::TextureView(views[1]) },
        ],
    })
}

/// The greatest extinction between datum and top, m⁻¹.
fn greatest_extinction(medium: &Medium) -> Vec3 {
    let altitudes = (0..64).map(|i| f64::from(i * i) / 3969.0 * medium.top_altitude_m);
    narrow3(altitudes.map(|h| medium.extinction(h)).fold(DVec3::ZERO, DVec3::max))
}
