//! How the model `view_table` draws: `shaders/lib/view_table.wgsl`, with two tables for every body, baked when its settings or its medium
//! change: optical depth in full floats, then the 3-D table of scattering, which asks it.
//!
//! Not here: what the tables hold ([`crate::air::model::view_table`]).

use super::{Painter, PainterKind, Parts, no_settings};
use crate::air::model::ViewTable as Settings;
use crate::air::model::view_table::Split;
use crate::air::{Air, Classes, Medium, Model};
use crate::gpu::Gpu;
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::Texture;
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, loaded_entry, texture_entry, uniform_entry};
use crate::render::targets::HDR;
use crate::scene::Body;
use crate::scene::gpu_data::{AirUniform, MEDIA_COLUMNS, MEDIA_ROWS, SkySettings, ViewTableUniform, media_rows};
use std::collections::BTreeMap;
use wgpu::{BindGroupEntry, BindGroupLayoutEntry, BindingResource, ShaderStages, TextureFormat, TextureUsages, TextureViewDimension};

/// Bodies whose tables are kept while others are drawn: a full table has 128 MiB.
const KEPT: usize = 4;

const fn storage(binding: u32, format: TextureFormat, view_dimension: TextureViewDimension) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: wgpu::BindingType::StorageTexture { access: wgpu::StorageTextureAccess::WriteOnly, format, view_dimension },
        count: None,
    }
}

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    let Parts { gpu, shaders, .. } = parts;
    let own = [uniform_entry(0), texture_entry(1, TextureViewDimension::D3), loaded_entry(2, TextureViewDimension::D2)];
    let kind = PainterKind::new(parts, "pass/sky_view_table.wgsl", &own)?;
    let (flat, array) = (TextureViewDimension::D2, TextureViewDimension::D2Array);
    // The table of depths reads none.
    let depth = [uniform_entry(0), uniform_entry(1), storage(2, TextureFormat::Rgba32Float, flat), loaded_entry(4, array)];
    let scatter =
        [uniform_entry(0), uniform_entry(1), storage(2, HDR, TextureViewDimension::D3), loaded_entry(3, flat), loaded_entry(4, array)];
    let layouts = [&depth[..], &scatter[..]]
        .map(|entries| gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("view bake"), entries }));
    let bake = |layout: &wgpu::BindGroupLayout, file: &str| -> Result<_, RenderError> {
        Ok(compute_pipeline(gpu, file, &shaders.load(&gpu.device, file)?, &[layout], "bake"))
    };
    let pipelines = [bake(&layouts[0], "pass/view_depth.wgsl")?, bake(&layouts[1], "pass/view_scatter.wgsl")?];
    let small = Settings { height_size: 1, view_size: 1, sun_size: 1, depth_height_size: 1, depth_angle_size: 1, ..Settings::default() };
    let vacuum = Medium { bottom_radius_m: 1.0, top_altitude_m: 1.0, ground_albedo: glam::Vec3::ZERO, layers: Vec::new() };
    let none = Tables::empty(gpu, &kind, &small, &vacuum);
    Ok(Box::new(ViewTable { kind, layouts, pipelines, none, tables: BTreeMap::new(), clock: 0 }))
}

/// The painter.
struct ViewTable {
    kind: PainterKind,
    layouts: [wgpu::BindGroupLayout; 2],
    pipelines: [wgpu::ComputePipeline; 2],
    none: Tables,
    tables: BTreeMap<u16, Tables>,
    clock: u64,
}

/// The tables of one body.
struct Tables {
    settings: Settings,
    medium: Medium,
    uniform: Uniform<ViewTableUniform>,
    depth: Texture,
    scatter: wgpu::TextureView,
    group: wgpu::BindGroup,
    baked: bool,
    used: u64,
}

impl Tables {
    fn empty(gpu: &Gpu, kind: &PainterKind, settings: &Settings, medium: &Medium) -> Self {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
        let size = [settings.depth_angle_size, settings.depth_height_size];
        let depth = Texture::new(&gpu.device, "view table: depth", size, TextureFormat::Rgba32Float, usage);
        let scatter = gpu
            .device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some("view table: scattering"),
                size: wgpu::Extent3d { width: settings.view_size, height: settings.sun_size, depth_or_array_layers: settings.height_size },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D3,
                format: HDR,
                usage,
                view_formats: &[],
            })
            .create_view(&wgpu::TextureViewDescriptor::default());
        let uniform = Uniform::new(&gpu.device, "ViewTable", wgpu::BufferUsages::empty());
        uniform.write(&gpu.queue, &ViewTableUniform::new(settings, &Split::new(medium)));
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("group 3: view_table"),
            layout: &kind.own_layout,
            entries: &[
                BindGroupEntry { binding: 0, resource: uniform.buffer.as_entire_binding() },
                BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&scatter) },
                BindGroupEntry { binding: 2, resource: BindingResource::TextureView(&depth.view) },
            ],
        });
        Self { settings: settings.clone(), medium: medium.clone(), uniform, depth, scatter, group, baked: false, used: 0 }
    }
}

impl Painter for ViewTable {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, _air: &Air) -> SkySettings {
        no_settings()
    }
    fn group(&self, id: u16) -> &wgpu::BindGroup {
        &self.tables.get(&id).unwrap_or(&self.none).group
    }
    fn plan(&mut self, gpu: &Gpu, airs: &[(u16, &Air)], forced: bool) -> usize {
        self.clock += 1;
        for (id, air) in airs {
            let Model::ViewTable(model) = &air.model else { continue };
            match self.tables.get_mut(id).filter(|t| t.settings == *model && t.medium == air.medium) {
                Some(tables) => {
                    tables.used = self.clock;
                    tables.baked &= !forced;
                }
                None => {
                    // The old ones go before the new ones are made: both may not fit.
                    self.tables.remove(id);
                    let fresh = Tables { used: self.clock, ..Tables::empty(gpu, &self.kind, model, &air.medium) };
                    self.tables.insert(*id, fresh);
                }
            }
        }
        let clock = self.clock;
        while self.tables.len() > KEPT {
            let idle = self.tables.iter().filter(|(_, t)| t.used < clock).min_by_key(|(_, t)| t.used).map(|(id, _)| *id);
            let Some(id) = idle else { break };
            self.tables.remove(&id);
        }
        self.tables.values().filter(|t| !t.baked).count()
    }
    fn bake(&mut self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>) {
        for tables in self.tables.values_mut().filter(|t| !t.baked) {
            tables.baked = true;
            let classes = Classes::of(&tables.medium);
            let air = Uniform::new(&gpu.device, "view bake: Air", wgpu::BufferUsages::empty());
            air.write(&gpu.queue, &AirUniform::new(&tables.medium, &classes));
            let media = media(gpu, &tables.medium, &classes).array_view();
            let s = &tables.settings;
            let sizes = [[s.depth_angle_size, s.depth_height_size, 1], [s.view_size, s.sun_size, s.height_size]];
            for (i, output) in [&tables.depth.view, &tables.scatter].into_iter().enumerate() {
                let entry = |binding, resource| BindGroupEntry { binding, resource };
                let mut entries = vec![
                    entry(0, air.buffer.as_entire_binding()),
                    entry(1, tables.uniform.buffer.as_entire_binding()),
                    entry(2, BindingResource::TextureView(output)),
                    entry(4, BindingResource::TextureView(&media)),
                ];
                if i > 0 {
                    entries.push(entry(3, BindingResource::TextureView(&tables.depth.view)));
                }
                let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("view bake"),
                    layout: &self.layouts[i],
                    entries: &entries,
                });
                pass.set_pipeline(&self.pipelines[i]);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(sizes[i][0].div_ceil(8), sizes[i][1].div_ceil(8), sizes[i][2]);
            }
        }
    }
}

/// The medium as a table, where it is one: one layer of `media` of `shaders/lib/medium.wgsl`.
#[allow(clippy::cast_possible_truncation)]
fn media(gpu: &Gpu, medium: &Medium, classes: &Classes) -> Texture {
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
    let size = [MEDIA_COLUMNS as u32, MEDIA_ROWS as u32];
    let texture = Texture::new(&gpu.device, "view bake: medium", size, TextureFormat::Rgba32Float, usage);
    if !classes.direct {
        texture.write(&gpu.queue, 0, 0, bytemuck::cast_slice(&media_rows(medium, classes)));
    }
    texture
}
