//! How the model `gradient` draws: `shaders/lib/gradient.wgsl`, with the two painted maps of a body as small textures of half floats.

use super::{Painter, PainterKind, Parts, no_settings};
use crate::air::model::{ColourMap, Gradient as Settings};
use crate::air::{Air, Model};
use crate::gpu::Gpu;
use crate::gpu::texture::Texture;
use crate::render::RenderError;
use crate::render::pipeline::texture_entry;
use crate::scene::Body;
use crate::scene::gpu_data::{MAX_BODIES, SkySettings};
use crate::space::relative::narrow;
use half::f16;
use std::collections::BTreeMap;
use wgpu::{BindGroupEntry, BindingResource};

/// Compiles it.
pub fn make(parts: &Parts<'_>) -> Result<Box<dyn Painter>, RenderError> {
    let flat = wgpu::TextureViewDimension::D2;
    let kind = PainterKind::new(parts, "pass/sky_gradient.wgsl", &[texture_entry(0, flat), texture_entry(1, flat)])?;
    let none = Maps::new(parts.gpu, &kind, ColourMap::default(), ColourMap::default());
    Ok(Box::new(Gradient { kind, none, maps: BTreeMap::new() }))
}

/// The painter.
struct Gradient {
    kind: PainterKind,
    none: Maps,
    maps: BTreeMap<u16, Maps>,
}

/// What one body's maps hold, and the group that binds them.
struct Maps {
    shell: ColourMap,
    ground: ColourMap,
    group: wgpu::BindGroup,
}

impl Maps {
    fn new(gpu: &Gpu, kind: &PainterKind, shell: ColourMap, ground: ColourMap) -> Self {
        let views = [upload(gpu, &shell), upload(gpu, &ground)].map(|t| t.view);
        let entry = |i: usize| BindGroupEntry { binding: [0, 1][i], resource: BindingResource::TextureView(&views[i]) };
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("group 3: gradient"),
            layout: &kind.own_layout,
            entries: &[entry(0), entry(1)],
        });
        Self { shell, ground, group }
    }
}

impl Painter for Gradient {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, air: &Air) -> SkySettings {
        match &air.model {
            Model::Gradient(model) => settings(model),
            _ => no_settings(),
        }
    }
    fn group(&self, id: u16) -> &wgpu::BindGroup {
        &self.maps.get(&id).unwrap_or(&self.none).group
    }
    /// Uploads maps that are new or changed: a few kilobytes, no pass of their own.
    fn plan(&mut self, gpu: &Gpu, airs: &[(u16, &Air)], _forced: bool) -> usize {
        if self.maps.len() > MAX_BODIES {
            self.maps.clear();
        }
        for (id, air) in airs {
            let Model::Gradient(model) = &air.model else { continue };
            if self.maps.get(id).is_none_or(|m| m.shell != model.shell_map || m.ground != model.ground_map) {
                self.maps.insert(*id, Maps::new(gpu, &self.kind, model.shell_map.clone(), model.ground_map.clone()));
            }
        }
        0
    }
}

/// The model's numbers, as the head of the shader says.
fn settings(model: &Settings) -> SkySettings {
    let mut rows = no_settings();
    rows[0] = [model.stretch, model.stretch + model.fade_stretch, narrow(model.visibility_m), model.transparency];
    rows[1] = [model.brightness * core::f32::consts::FRAC_1_PI, model.opacity, 0.0, 0.0];
    rows
}

/// A map as the shader reads it: linear RGBA. An empty one is one black texel.
fn upload(gpu: &Gpu, map: &ColourMap) -> Texture {
    let size = map.size.map(|n| n.max(1));
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = Texture::new(&gpu.device, "gradient map", size, wgpu::TextureFormat::Rgba16Float, usage);
    let texels: Vec<f16> =
        (0..size[1]).flat_map(|y| (0..size[0]).flat_map(move |x| map.texel(x, y).to_array().map(f16::from_f64))).collect();
    texture.write(&gpu.queue, 0, 0, bytemuck::cast_slice(&texels));
    texture
}
