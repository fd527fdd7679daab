//! A baseline for `bench air`, not used by any picture of the game: the sky after Hillaire 2020, by the tables that he describes.
//!
//! Transmittance is that of the air tables, which has his size and mapping [§5.1]; multiple scattering is [`super::baseline_hillaire`] [§5.5]. Those two
//! hang on the medium. Two more hang on the eye and are made for every picture: the sky view [§5.3], and cells of the view's pyramid for
//! what stands near [§5.4]. From space he marches [§5.2], and so does a forced frame.

use super::baseline_hillaire::HillaireBaker;
use super::sky::{Draw, Painter, PainterKind, Parts, no_settings};
use crate::air::Air;
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, compute_pipeline, stored_texture_entry, texture_entry};
use crate::render::shared::{AirTables, FrameContext};
use crate::render::targets::HDR;
use crate::scene::Body;
use crate::scene::gpu_data::SkySettings;
use crate::space::relative::narrow;
use wgpu::{BindGroupEntry, BindingResource, TextureUsages, TextureViewDimension};

/// `HILLAIRE_SKY` of the shader.
const SKY: [u32; 2] = [192, 108];
/// `HILLAIRE_FROXELS` of the shader.
const FROXELS: u32 = 32;
const FILE: &str = "pass/baseline_hillaire_sky.wgsl";

/// The painter.
struct Hillaire {
    kind: PainterKind,
    by_tables: wgpu::RenderPipeline,
    see: wgpu::ComputePipeline,
    froxels: wgpu::ComputePipeline,
    baker: HillaireBaker,
    tables: AirTables,
    fill_layout: wgpu::BindGroupLayout,
    multiple: Texture,
    seen: Texture,
    near: Texture,
    /// Group 3 of the picture, and of what fills the tables.
    groups: [wgpu::BindGroup; 2],
    marches: bool,
}

/// Compiles it; `tables` are the air tables of the one air that it will draw, in slot 0.
pub fn make(parts: &Parts<'_>, tables: &AirTables) -> Result<Box<dyn Painter>, RenderError> {
    let Parts { gpu, shaders, shared, picture } = parts;
    let (flat, solid) = (TextureViewDimension::D2, TextureViewDimension::D3);
    let own = [texture_entry(0, flat), texture_entry(1, flat), texture_entry(2, solid)];
    let kind = PainterKind::new(parts, FILE, &own)?;
    let groups = [&shared.frame_layout, &shared.light_layout, picture, &kind.own_layout];
    let by_tables = PipelineKind { entry: "by_tables", ..PipelineKind::full_screen("sky", &kind.module, &groups, HDR) }.make(gpu);
    let fill_layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("baseline hillaire: tables of the eye"),
        entries: &[texture_entry(0, flat), stored_texture_entry(3, HDR, flat), stored_texture_entry(4, HDR, solid)],
    });
    let groups = [&shared.frame_layout, &shared.light_layout, picture, &fill_layout];
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
    let multiple = Texture::new(&gpu.device, "no multiple scattering", [1, 1], HDR, usage);
    let seen = Texture::new(&gpu.device, "sky view", SKY, HDR, usage);
    let near = Texture::volume(&gpu.device, "froxels", [FROXELS; 3], HDR, usage);
    let bound = bind(gpu, &kind, &fill_layout, [&multiple, &seen, &near]);
    Ok(Box::new(Hillaire {
        by_tables,
        see: compute_pipeline(gpu, "baseline_hillaire_sky", &kind.module, &groups, "see"),
        froxels: compute_pipeline(gpu, "baseline_hillaire_sky", &kind.module, &groups, "froxels"),
        baker: HillaireBaker::new(gpu, shaders)?,
        tables: tables.clone(),
        kind,
        fill_layout,
        multiple,
        seen,
        near,
        groups: bound,
        marches: false,
    }))
}

fn bind(gpu: &Gpu, kind: &PainterKind, fill: &wgpu::BindGroupLayout, tables: [&Texture; 3]) -> [wgpu::BindGroup; 2] {
    let entry = |binding, table: usize| BindGroupEntry { binding, resource: BindingResource::TextureView(&tables[table].view) };
    let group = |layout, entries: &[BindGroupEntry<'_>]| {
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("group 3: baseline hillaire"), layout, entries })
    };
    [group(&kind.own_layout, &[entry(0, 0), entry(1, 1), entry(2, 2)]), group(fill, &[entry(0, 0), entry(3, 1), entry(4, 2)])]
}

impl Painter for Hillaire {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, _air: &Air) -> SkySettings {
        no_settings()
    }
    fn plan(&mut self, _gpu: &Gpu, _airs: &[(u16, &Air)], _forced: bool) -> usize {
        1
    }
    fn bake(&mut self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>) {
        self.multiple = self.baker.bake(gpu, pass, &self.tables);
        self.groups = bind(gpu, &self.kind, &self.fill_layout, [&self.multiple, &self.seen, &self.near]);
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        &self.groups[0]
    }
    fn pipeline(&self) -> &wgpu::RenderPipeline {
        if self.marches { &self.kind.pipeline } else { &self.by_tables }
    }
    fn before(&mut self, f: &mut FrameContext<'_>, draw: &Draw<'_>) {
        self.marches = f.scene.force.all || draw.body.camera_altitude_m > narrow(draw.air.medium.top_altitude_m);
        if self.marches {
            return;
        }
        let mut pass = f.compute("sky");
        pass.set_bind_group(1, draw.light, &[]);
        pass.set_bind_group(2, draw.picture, &[]);
        pass.set_bind_group(3, &self.groups[1], &[]);
        pass.set_pipeline(&self.see);
        pass.dispatch_workgroups(SKY[0].div_ceil(8), SKY[1].div_ceil(4), 1);
        pass.set_pipeline(&self.froxels);
        pass.dispatch_workgroups(FROXELS / 8, FROXELS / 4, 1);
    }
}
