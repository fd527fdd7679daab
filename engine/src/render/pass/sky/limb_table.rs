//! How the model `limb_table` draws: `shaders/lib/limb_table.wgsl`, with a table for every body, baked when its settings or its shell change.
//!
//! Lights: the star, and the worlds that throw most of its light on the body. Not here: what the table holds
//! ([`crate::air::model::limb_table`]).

use super::{Painter, PainterKind, Parts, no_settings};
use crate::air::model::LimbTable as Settings;
use crate::air::{Air, Classes, Medium, Model};
use crate::gpu::Gpu;
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::Texture;
use crate::light::reflected::lambert_sphere;
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, stored_texture_entry, texture_entry, uniform_entry};
use crate::render::targets::HDR;
use crate::scene::gpu_data::{AirUniform, MAX_AIRS, SkySettings, SkyUniform, vec4};
use crate::scene::{Body, Snapshot};
use crate::space::relative::narrow;
use bytemuck::Zeroable;
use glam::Vec3;
use std::collections::BTreeMap;
use wgpu::{BindGroupEntry, BindingResource, TextureUsages, TextureViewDimension};

/// Lights beside the star: `LIMB_LIGHTS` of the shader.
const FURTHER_LIGHTS: usize = 3;
/// What sends less than this share of the star's light is no light.
const LEAST_SHARE: f32 = 1e-9;

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    let Parts { gpu, shaders, .. } = parts;
    let kind = PainterKind::new(parts, "pass/sky_limb_table.wgsl", &[texture_entry(0, TextureViewDimension::D2)])?;
    let storage = stored_texture_entry(2, HDR, TextureViewDimension::D2);
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("limb_bake"),
        entries: &[uniform_entry(0), uniform_entry(1), storage],
    });
    let module = shaders.load(&gpu.device, "pass/limb_bake.wgsl")?;
    let bake = compute_pipeline(gpu, "limb_bake", &module, &[&layout], "bake");
    let none = Table::empty(gpu, &kind, &Settings { size: 1, ..Settings::default() });
    Ok(Box::new(LimbTable { kind, layout, bake, none, tables: BTreeMap::new(), clock: 0 }))
}

/// The painter.
struct LimbTable {
    kind: PainterKind,
    layout: wgpu::BindGroupLayout,
    bake: wgpu::ComputePipeline,
    none: Table,
    tables: BTreeMap<u16, Table>,
    clock: u64,
}

/// The table of one body.
struct Table {
    settings: Settings,
    shell_m: [f64; 2],
    texture: Texture,
    group: wgpu::BindGroup,
    baked: bool,
    used: u64,
}

impl Table {
    fn empty(gpu: &Gpu, kind: &PainterKind, settings: &Settings) -> Self {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING | TextureUsages::COPY_SRC;
        let texture = Texture::new(&gpu.device, "limb table", [settings.size; 2], HDR, usage);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("group 3: limb_table"),
            layout: &kind.own_layout,
            entries: &[BindGroupEntry { binding: 0, resource: BindingResource::TextureView(&texture.view) }],
        });
        Self { settings: settings.clone(), shell_m: [0.0; 2], texture, group, baked: false, used: 0 }
    }
}

impl Painter for LimbTable {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, air: &Air) -> SkySettings {
        match &air.model {
            Model::LimbTable(model) => settings(model, &air.medium, &[]),
            _ => no_settings(),
        }
    }
    fn settings_in(&self, scene: &Snapshot, body: &Body, air: &Air) -> SkySettings {
        match &air.model {
            Model::LimbTable(model) => settings(model, &air.medium, &further_lights(scene, body)),
            _ => no_settings(),
        }
    }
    fn group(&self, id: u16) -> &wgpu::BindGroup {
        &self.tables.get(&id).unwrap_or(&self.none).group
    }
    fn plan(&mut self, gpu: &Gpu, airs: &[(u16, &Air)], forced: bool) -> usize {
        self.clock += 1;
        for (id, air) in airs {
            let Model::LimbTable(model) = &air.model else { continue };
            let shell_m = [air.medium.bottom_radius_m, air.medium.top_altitude_m];
            let known = self.tables.get_mut(id).filter(|t| t.settings == *model && t.shell_m == shell_m);
            match known {
                Some(table) => {
                    table.used = self.clock;
                    table.baked &= !forced;
                }
                None => {
                    let fresh = Table { shell_m, used: self.clock, ..Table::empty(gpu, &self.kind, model) };
                    self.tables.insert(*id, fresh);
                }
            }
        }
        while self.tables.len() > MAX_AIRS {
            let oldest = self.tables.iter().min_by_key(|(_, t)| t.used).map(|(id, _)| *id);
            oldest.map(|id| self.tables.remove(&id));
        }
        self.tables.values().filter(|t| !t.baked).count()
    }
    fn bake(&mut self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>) {
        for table in self.tables.values_mut().filter(|t| !t.baked) {
            table.baked = true;
            let [bottom_radius_m, top_altitude_m] = table.shell_m;
            let shell = Medium { bottom_radius_m, top_altitude_m, ground_albedo: Vec3::ZERO, layers: Vec::new() };
            let air = Uniform::new(&gpu.device, "limb_bake: Air", wgpu::BufferUsages::empty());
            air.write(&gpu.queue, &AirUniform::new(&shell, &Classes::of(&shell)));
            let sky = Uniform::new(&gpu.device, "limb_bake: Sky", wgpu::BufferUsages::empty());
            sky.write(&gpu.queue, &SkyUniform { settings: settings(&table.settings, &shell, &[]), ..SkyUniform::zeroed() });
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("limb_bake"),
                layout: &self.layout,
                entries: &[
                    BindGroupEntry { binding: 0, resource: air.buffer.as_entire_binding() },
                    BindGroupEntry { binding: 1, resource: sky.buffer.as_entire_binding() },
                    BindGroupEntry { binding: 2, resource: BindingResource::TextureView(&table.texture.view) },
                ],
            });
            pass.set_pipeline(&self.bake);
            pass.set_bind_group(0, &group, &[]);
            let groups = table.settings.size.div_ceil(8);
            pass.dispatch_workgroups(groups, groups, 1);
        }
    }
}

/// As the head of the shader says. `lights`: directions, and illuminances over the star's.
fn settings(model: &Settings, medium: &Medium, lights: &[(Vec3, Vec3)]) -> SkySettings {
    let mut rows = no_settings();
    rows[0] = vec4(model.light_scale_per_sr, model.density_exponent);
    let step_m = f64::from(model.march_step_radii) * medium.bottom_radius_m;
    rows[1] = [narrow(step_m), narrow(lights.len().min(FURTHER_LIGHTS) as f64), 0.0, 0.0];
    for (slots, (direction, share)) in rows[2..].chunks_exact_mut(2).zip(lights) {
        slots[0] = vec4(*direction, 0.0);
        slots[1] = vec4(*share, 0.0);
    }
    rows
}

/// The worlds of the scene that throw most of the star's light on a body: unit directions from it, and illuminances over the star's,
/// brightest first.
fn further_lights(scene: &Snapshot, body: &Body) -> Vec<(Vec3, Vec3)> {
    let star = body.sun_illuminance_lx.max(Vec3::splat(1e-12));
    let mut lights: Vec<(Vec3, Vec3)> = scene
        .bodies
        .iter()
        .filter(|other| other.id != body.id)
        .map(|other| {
            let offset = other.centre_m - body.centre_m;
            let distance = offset.length().max(1.0);
            let phase = libm::acos(f64::from(other.sun_direction.dot(-offset / distance).clamp(-1.0, 1.0)));
            let share = narrow(lambert_sphere(1.0, f64::from(other.radius_m), f64::from(distance), phase));
            (offset / distance, other.albedo * (other.sun_illuminance_lx / star) * share)
        })
        .filter(|(_, share)| share.max_element() > LEAST_SHARE)
        .collect();
    lights.sort_by(|a, b| b.1.max_element().total_cmp(&a.1.max_element()));
    lights.truncate(FURTHER_LIGHTS);
    lights
}
