//! How the model `view_table` draws: `shaders/lib/view_table.wgsl`, with three tables for every body, baked when its settings or its medium
//! change: optical depth in full floats, the 3-D table of scattering, which asks it, and the ambient light, which asks that. It also says what
//! lights the ground, and what its water mirrors.
//!
//! Not here: what the tables hold ([`crate::air::model::view_table`]).

use super::{Painter, PainterKind, Parts, no_settings};
use crate::air::model::ViewTable as Settings;
use crate::air::model::view_table::Split;
use crate::air::{Air, Classes, Medium, Model};
use crate::gpu::Gpu;
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::{Texture, linear_sampler};
use crate::render::RenderError;
use crate::render::pass::air_tables::TRANSMITTANCE_SIZE;
use crate::render::pipeline::{
    compute_pipeline, loaded_entry, sampler_entry, storage_entry, stored_texture_entry, texture_entry, uniform_entry,
};
use crate::render::shared::Mirror;
use crate::render::targets::HDR;
use crate::scene::Body;
use crate::scene::gpu_data::{AirUniform, MEDIA_COLUMNS, MEDIA_ROWS, SkySettings, ViewTableUniform, media_rows};
use std::collections::BTreeMap;
use wgpu::{BindGroupEntry, BindGroupLayoutEntry, BindingResource, TextureFormat, TextureUsages, TextureViewDimension};

/// Bodies whose tables are kept while others are drawn: a full table has 128 MiB.
const KEPT: usize = 4;

/// A bake: its pipeline and the layout of its one group.
struct Bake {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Bake {
    fn new(parts: &Parts<'_>, file: &str, entries: &[BindGroupLayoutEntry]) -> Result<Self, RenderError> {
        let Parts { gpu, shaders, .. } = parts;
        let entries = [&[uniform_entry(0), uniform_entry(1)], entries].concat();
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("view bake"), entries: &entries });
        let pipeline = compute_pipeline(gpu, file, &shaders.load(&gpu.device, file)?, &[&layout], "bake");
        Ok(Self { layout, pipeline })
    }

    fn run(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, tables: &Tables, own: &[(u32, BindingResource<'_>)], groups: [u32; 3]) {
        let mut entries = vec![
            BindGroupEntry { binding: 0, resource: tables.air.buffer.as_entire_binding() },
            BindGroupEntry { binding: 1, resource: tables.mirror.uniform.as_entire_binding() },
        ];
        entries.extend(own.iter().map(|(binding, resource)| BindGroupEntry { binding: *binding, resource: resource.clone() }));
        let group =
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("view bake"), layout: &self.layout, entries: &entries });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
    }
}

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    let (flat, array, solid) = (TextureViewDimension::D2, TextureViewDimension::D2Array, TextureViewDimension::D3);
    let own = [storage_entry(0), texture_entry(1, solid), loaded_entry(2, flat)];
    let kind = PainterKind::new(parts, "pass/sky_view_table.wgsl", &own)?;
    let filtering = wgpu::SamplerBindingType::Filtering;
    let depth = [stored_texture_entry(2, TextureFormat::Rgba32Float, flat), loaded_entry(4, array)];
    let scatter = [stored_texture_entry(2, HDR, solid), loaded_entry(3, flat), loaded_entry(4, array)];
    let ambient = [stored_texture_entry(2, HDR, flat), texture_entry(3, solid), loaded_entry(4, array), sampler_entry(5, filtering)];
    let daylight = [
        stored_texture_entry(2, HDR, flat),
        stored_texture_entry(3, HDR, flat),
        loaded_entry(4, flat),
        texture_entry(5, flat),
        sampler_entry(6, filtering),
    ];
    let small = Settings {
        height_size: 1,
        view_size: 1,
        sun_size: 1,
        depth_height_size: 1,
        depth_angle_size: 1,
        ambient_size: 1,
        ..Settings::default()
    };
    let vacuum = Medium { bottom_radius_m: 1.0, top_altitude_m: 1.0, ground_albedo: glam::Vec3::ZERO, layers: Vec::new() };
    Ok(Box::new(ViewTable {
        none: Tables::empty(parts.gpu, &kind, 0, &small, &vacuum),
        kind,
        depth: Bake::new(parts, "pass/view_depth.wgsl", &depth)?,
        scatter: Bake::new(parts, "pass/view_scatter.wgsl", &scatter)?,
        ambient: Bake::new(parts, "pass/view_ambient.wgsl", &ambient)?,
        daylight: Bake::new(parts, "pass/view_daylight.wgsl", &daylight)?,
        linear: linear_sampler(&parts.gpu.device, "view tables", false),
        tables: BTreeMap::new(),
        clock: 0,
    }))
}

/// The painter.
struct ViewTable {
    kind: PainterKind,
    depth: Bake,
    scatter: Bake,
    ambient: Bake,
    daylight: Bake,
    linear: wgpu::Sampler,
    none: Tables,
    tables: BTreeMap<u16, Tables>,
    clock: u64,
}

/// The tables of one body.
struct Tables {
    settings: Settings,
    medium: Medium,
    air: Uniform<AirUniform>,
    /// The medium as a table, where it is one: a layer of `media` of `shaders/lib/medium.wgsl`.
    media: wgpu::TextureView,
    depth: Texture,
    ambient: Texture,
    /// The 3-D table and the uniform.
    mirror: Mirror,
    group: wgpu::BindGroup,
    baked: bool,
    used: u64,
}

impl Tables {
    #[allow(clippy::cast_possible_truncation)]
    fn empty(gpu: &Gpu, kind: &PainterKind, id: u16, settings: &Settings, medium: &Medium) -> Self {
        let d = &gpu.device;
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
        let size = [settings.depth_angle_size, settings.depth_height_size];
        let depth = Texture::new(d, "view table: depth", size, TextureFormat::Rgba32Float, usage);
        let size = [settings.view_size, settings.sun_size, settings.height_size];
        let scatter = Texture::volume(d, "view table: scattering", size, HDR, usage).view;
        let ambient = Texture::new(d, "view table: ambient", [settings.ambient_size, 1], HDR, usage);
        let classes = Classes::of(medium);
        let air = Uniform::new(d, "view table: Air", wgpu::BufferUsages::empty());
        air.write(&gpu.queue, &AirUniform::new(medium, &classes));
        let size = [MEDIA_COLUMNS as u32, MEDIA_ROWS as u32];
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let media = Texture::new(d, "view table: medium", size, TextureFormat::Rgba32Float, usage);
        if !classes.direct {
            media.write(&gpu.queue, 0, 0, bytemuck::cast_slice(&media_rows(medium, &classes)));
        }
        let uniform = Uniform::new(d, "ViewTable", wgpu::BufferUsages::STORAGE);
        uniform.write(&gpu.queue, &ViewTableUniform::new(id, settings, &Split::new(medium)));
        let group = d.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("group 3: view_table"),
            layout: &kind.own_layout,
            entries: &[
                BindGroupEntry { binding: 0, resource: uniform.buffer.as_entire_binding() },
                BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&scatter) },
                BindGroupEntry { binding: 2, resource: BindingResource::TextureView(&depth.view) },
            ],
        });
        Self {
            settings: settings.clone(),
            medium: medium.clone(),
            air,
            media: media.array_view(),
            depth,
            ambient,
            mirror: Mirror { scatter, uniform: uniform.buffer },
            group,
            baked: false,
            used: 0,
        }
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
                    let fresh = Tables { used: self.clock, ..Tables::empty(gpu, &self.kind, *id, model, &air.medium) };
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
        use BindingResource::{Sampler, TextureView};
        for tables in self.tables.values_mut().filter(|t| !t.baked) {
            tables.baked = true;
            let (s, media) = (tables.settings.clone(), TextureView(&tables.media));
            let depth = [(2, TextureView(&tables.depth.view)), (4, media.clone())];
            self.depth.run(gpu, pass, tables, &depth, [s.depth_angle_size.div_ceil(8), s.depth_height_size.div_ceil(8), 1]);
            let scatter = [(2, TextureView(&tables.mirror.scatter)), (3, TextureView(&tables.depth.view)), (4, media.clone())];
            self.scatter.run(gpu, pass, tables, &scatter, [s.view_size.div_ceil(8), s.sun_size.div_ceil(8), s.height_size]);
            let ambient =
                [(2, TextureView(&tables.ambient.view)), (3, TextureView(&tables.mirror.scatter)), (4, media), (5, Sampler(&self.linear))];
            self.ambient.run(gpu, pass, tables, &ambient, [s.ambient_size.div_ceil(8), 1, 1]);
        }
    }
    fn lights_ground(&self) -> bool {
        true
    }
    fn light_ground(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, id: u16, into: [&wgpu::TextureView; 2]) {
        use BindingResource::{Sampler, TextureView};
        let Some(tables) = self.tables.get(&id) else { return };
        let own = [
            (2, TextureView(into[0])),
            (3, TextureView(into[1])),
            (4, TextureView(&tables.depth.view)),
            (5, TextureView(&tables.ambient.view)),
            (6, Sampler(&self.linear)),
        ];
        self.daylight.run(gpu, pass, tables, &own, [TRANSMITTANCE_SIZE[0].div_ceil(8), TRANSMITTANCE_SIZE[1].div_ceil(8), 1]);
    }
    fn mirror(&self, id: u16) -> Option<&Mirror> {
        self.tables.get(&id).map(|t| &t.mirror)
    }
}
