//! How the model `physical` draws: `shaders/lib/physical.wgsl`, with the air tables of group 1.
//!
//! The march is made at every eighth pixel of every eighth row first. Cells between four of those that are even enough are drawn from them by
//! cubic interpolation, two triangles each; in the others the march is made at every second pixel, with cells again; what no cell draws is marched
//! pixel by pixel. Where another world's shadow is so small in the picture that it might lie between rays, and where density jumps, there are
//! only the rays of every second pixel; a small disc has a ray at every one. A forced frame marches at every pixel: the two differ by the bound that is stated at [`AGREE`].

use super::choose::Rect;
use super::{Draw, Painter, PainterKind, Parts, no_settings};
use crate::air::{Air, Classes, Medium};
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use crate::light::shadow::Shadow;
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, Stencil, loaded_entry};
use crate::render::shared::FrameContext;
use crate::render::targets::{HDR, SKY_LEVEL, SKY_PLAN, SkyLevel};
use crate::scene::gpu_data::{SkySettings, vec4};
use crate::scene::{Body, Snapshot};
use crate::space::relative::narrow3;
use glam::{DVec3, Vec3};
use wgpu::{BindGroupEntry, BindingResource};

/// Of its light, how much a pixel may err by interpolation, as it is found from differences of fourth order: a fifth of it where light is smooth,
/// three times it at a kink on a line one pixel wide.
pub const AGREE: f32 = 0.003;

/// Pre-exposed light of which nobody sees an error: a thousandth of white.
pub const UNSEEN: f32 = 1e-3;

/// What most airs do without: media that are tables, and shadows of other worlds.
const PLAIN: [(&str, f64); 2] = [("MEDIA_TABLES", 0.0), ("AIR_ECLIPSES", 0.0)];
/// The umbra's radius, in pixels, from which on rays of the first level stand in it.
const WIDE_PX: f64 = 8.0;

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    Ok(Box::new(Physical::new(parts)?))
}

/// The narrower side of a rectangle from which on it is drawn in cells: a disc smaller than that might lie between rays.
const SMALL_PX: u32 = 48;

/// The pipelines for one kind of air.
struct Rates {
    /// A march at every pixel.
    full: wgpu::RenderPipeline,
    /// Pixels between the rays of the first level; where it is not the second itself, how it is drawn.
    first: u32,
    coarse: Option<Coarse>,
    /// The second level: marches, tells what becomes of its cells, and draws the even ones.
    march: wgpu::RenderPipeline,
    plan: wgpu::RenderPipeline,
    take: wgpu::RenderPipeline,
    /// Marches at the pixels that no cell has drawn.
    rest: wgpu::RenderPipeline,
}

/// The pipelines of a first level: marches, tells what becomes of its cells, and draws the even ones.
struct Coarse {
    march: wgpu::RenderPipeline,
    plan: wgpu::RenderPipeline,
    cells: wgpu::RenderPipeline,
}

/// Pixels between the rays of the second level.
const FINE: u32 = 2;

/// How the body that is being drawn is drawn.
enum Chosen {
    /// A march at every pixel.
    Full(wgpu::RenderPipeline),
    /// Draws, one after the other: pipeline, its group 3, count of vertices.
    Levels(Vec<(wgpu::RenderPipeline, wgpu::BindGroup, u32)>),
}

/// The painter.
struct Physical {
    kind: PainterKind,
    /// For any air, for one of formulas under a shadow that is wide in the picture, and for airs that do without [`PLAIN`]'s.
    rates: [Rates; 3],
    /// Group 3 where nothing is read from it.
    none: wgpu::BindGroup,
    dark: Texture,
    chosen: Option<Chosen>,
}

impl Physical {
    fn new(parts: &Parts<'_>) -> Result<Self, RenderError> {
        let own = [0, 1, 2, 3].map(|i| loaded_entry(i, wgpu::TextureViewDimension::D2));
        let kind = PainterKind::new(parts, "pass/sky_physical.wgsl", &own)?;
        let groups = [&parts.shared.frame_layout, &parts.shared.light_layout, parts.picture, &kind.own_layout];
        let rates = [(&[][..], FINE), (&PLAIN[..1], 8), (&PLAIN[..], 8)].map(|(air, first)| {
            let of = |vertex, entry, colour, numbers: [u32; 3], stencil| {
                let [rate, into, margin] = numbers.map(f64::from);
                let own = [("FIRST_RATE", f64::from(first)), ("RATE", rate), ("INTO", into), ("MARGIN", margin)];
                let constants = &[air, &own].concat();
                let colours = if entry == "march_level" { 2 } else { 1 };
                let plain = PipelineKind::full_screen("sky", &kind.module, &groups, colour);
                PipelineKind { vertex, entry, colours, constants, stencil, ..plain }.make(parts.gpu)
            };
            let coarse = (first != FINE).then(|| Coarse {
                march: of("vertex", "march_level", SKY_LEVEL, [first, first, 0], None),
                plan: of("vertex", "plan_level", SKY_PLAN, [first, first, 0], None),
                cells: of("cell_vertex", "cell", HDR, [first, 1, 0], Some(Stencil::Marks)),
            });
            let open = if coarse.is_some() { "open_vertex" } else { "vertex" };
            Rates {
                full: of("vertex", "fragment", HDR, [1, 1, 0], None),
                first,
                coarse,
                march: of(open, "march_level", SKY_LEVEL, [FINE, FINE, 1], None),
                plan: of(open, "plan_level", SKY_PLAN, [FINE, FINE, 0], None),
                take: of(open, "take", HDR, [FINE, 1, 0], Some(Stencil::Marks)),
                rest: of("vertex", "fragment", HDR, [1, 1, 0], Some(Stencil::Unmarked)),
            }
        });
        let dark = Texture::new(&parts.gpu.device, "no air", [1, 1], HDR, wgpu::TextureUsages::TEXTURE_BINDING);
        let none = group(parts.gpu, &kind.own_layout, [&dark.view; 4]);
        Ok(Self { kind, rates, none, dark, chosen: None })
    }
}

impl Painter for Physical {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, air: &Air) -> SkySettings {
        let mut all = no_settings();
        all[0] = vec4(greatest_extinction(&air.medium), 0.0);
        all[2][0] = UNSEEN;
        all
    }
    fn agree(&self, settings: &mut SkySettings, agree: f32) {
        settings[0][3] = agree;
    }
    fn place(&self, settings: &mut SkySettings, rect: Rect) {
        settings[1] = [rect.left, rect.top, rect.left + rect.width, rect.top + rect.height].map(|n| n as f32);
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        &self.none
    }
    fn marks(&self) -> bool {
        matches!(self.chosen, Some(Chosen::Levels(_)))
    }
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, _id: u16) {
        match &self.chosen {
            Some(Chosen::Levels(draws)) => {
                for (pipeline, group, count) in draws {
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(3, group, &[]);
                    pass.draw(0..*count, 0..1);
                }
            }
            Some(Chosen::Full(pipeline)) => {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(3, &self.none, &[]);
                pass.draw(0..3, 0..1);
            }
            None => {}
        }
    }
    fn before(&mut self, f: &mut FrameContext<'_>, draw: &Draw<'_>) {
        let medium = &draw.air.medium;
        let smooth = Classes::of(medium).direct && medium.cuts_m(1).is_empty();
        let rates = &self.rates[match umbra_px(f.scene, draw.body, medium) {
            _ if !smooth => 0,
            None => 2,
            Some(px) => usize::from(px >= WIDE_PX),
        }];
        if f.scene.force.all || draw.rect.width.min(draw.rect.height) < SMALL_PX {
            self.chosen = Some(Chosen::Full(rates.full.clone()));
            return;
        }
        let dark = &self.dark.view;
        let layout = &self.kind.own_layout;
        let mut draws = Vec::new();
        // Of a level: radiance, transmittance, plan.
        let views = |level: &SkyLevel| [&level.light[0].view, &level.light[1].view, &level.plan.view].map(Clone::clone);
        let mut first_plan = dark.clone();
        let mut vertices = 3;
        if let Some(coarse) = &rates.coarse {
            let [radiance, transmittance, plan] = views(f.targets.sky_at(rates.first));
            let rays = texels(draw.rect, rates.first);
            let cells = Rect { width: rays.width - 1, height: rays.height - 1, ..rays };
            one(&mut f.draw_pair("sky", [&radiance, &transmittance], true), &coarse.march, draw, &self.none, rays, 3);
            let from = group(f.gpu, layout, [&radiance, &transmittance, dark, dark]);
            one(&mut f.draw_full_screen("sky", &plan, true), &coarse.plan, draw, &from, cells, 3);
            vertices = 6 * cells.width * cells.height;
            draws.push((coarse.cells.clone(), group(f.gpu, layout, [&radiance, &transmittance, dark, &plan]), vertices));
            first_plan = plan;
        }
        let [radiance, transmittance, plan] = views(f.targets.sky_at(FINE));
        let rays = texels(draw.rect, FINE);
        let cells = Rect { width: rays.width - 1, height: rays.height - 1, ..rays };
        let from = group(f.gpu, layout, [dark, dark, dark, &first_plan]);
        one(&mut f.draw_pair("sky", [&radiance, &transmittance], false), &rates.march, draw, &from, rays, vertices);
        let from = group(f.gpu, layout, [&radiance, &transmittance, dark, &first_plan]);
        one(&mut f.draw_full_screen("sky", &plan, false), &rates.plan, draw, &from, cells, vertices);
        draws.push((rates.take.clone(), group(f.gpu, layout, [&radiance, &transmittance, &plan, &first_plan]), vertices));
        draws.push((rates.rest.clone(), self.none.clone(), 3));
        self.chosen = Some(Chosen::Levels(draws));
    }
}

/// One draw over a part of a level.
fn one(
    pass: &mut wgpu::RenderPass<'_>,
    pipeline: &wgpu::RenderPipeline,
    draw: &Draw<'_>,
    own: &wgpu::BindGroup,
    part: Rect,
    vertices: u32,
) {
    pass.set_pipeline(pipeline);
    pass.set_bind_group(1, draw.light, &[]);
    pass.set_bind_group(2, draw.picture, &[]);
    pass.set_bind_group(3, own, &[]);
    pass.set_scissor_rect(part.left, part.top, part.width, part.height);
    pass.draw(0..vertices, 0..1);
}

/// The texels of a level that pixels of `rect` lie between.
fn texels(rect: Rect, rate: u32) -> Rect {
    let part = |from: u32, len: u32| (from / rate, (from + len).saturating_sub(1) / rate + 2 - from / rate);
    let ((left, width), (top, height)) = (part(rect.left, rect.width), part(rect.top, rect.height));
    Rect { left, top, width, height }
}

fn group(gpu: &Gpu, layout: &wgpu::BindGroupLayout, views: [&wgpu::TextureView; 4]) -> wgpu::BindGroup {
    let entry = |(binding, view)| BindGroupEntry { binding, resource: BindingResource::TextureView(view) };
    let entries: Vec<_> = (0..).zip(views).map(entry).collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("group 3: physical"), layout, entries: &entries })
}

/// Radius of the smallest umbra on an air, in pixels: that of the disc where the sun is hidden most. `None` where no shadow reaches it.
fn umbra_px(scene: &Snapshot, body: &Body, medium: &Medium) -> Option<f64> {
    let star = (scene.star.centre_m.as_dvec3(), f64::from(scene.star.radius_m));
    let shell = (body.centre_m.as_dvec3(), f64::from(body.radius_m) + medium.top_altitude_m);
    // From as far as light counts that the air scatters on.
    let near_m = shell.1;
    let shadows = body.occluders.iter().map(|o| Shadow::new((o.centre_m.as_dvec3(), f64::from(o.radius_m)), star));
    // The farthest air that is not behind the planet.
    let to_horizon = |h: f64| (h.max(0.0) * (2.0 * f64::from(body.radius_m) + h.max(0.0))).sqrt();
    let seen_m = to_horizon(f64::from(body.camera_altitude_m)) + to_horizon(medium.top_altitude_m);
    let px = |s: Shadow| {
        let at = s.meets_m(shell.0, shell.1);
        let (away_m, umbra_m) = (at.length().max(1.0), s.radii_m(s.place(at).0)[0].abs());
        if away_m > seen_m + umbra_m { f64::INFINITY } else { umbra_m / (away_m * f64::from(scene.camera.pixel_rad())) }
    };
    shadows.filter(|s| s.reaches(shell.0, shell.1, near_m)).map(px).reduce(f64::min)
}

/// The greatest extinction between datum and top, m⁻¹.
fn greatest_extinction(medium: &Medium) -> Vec3 {
    let altitudes = (0..64).map(|i| f64::from(i * i) / 3969.0 * medium.top_altitude_m);
    narrow3(altitudes.map(|h| medium.extinction(h)).fold(DVec3::ZERO, DVec3::max))
}
