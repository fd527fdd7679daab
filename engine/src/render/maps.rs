//! Maps of bodies: textures around a whole sphere, registered once and kept by body.

use super::RenderError;
use super::pipeline::{sampler_entry, texture_entry};
use crate::gpu::Gpu;
use crate::gpu::texture::{Texture, linear_sampler};
use std::collections::BTreeMap;

/// An equirectangular colour map: longitude −180° … +180° from left to right, latitude +90° at the top; sRGB-encoded RGBA8.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourMap {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// `4 · width · height` bytes.
    pub rgba: Vec<u8>,
}

/// What is known of a body's looks beside its mean albedo.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyMaps {
    /// Albedo.
    pub albedo: Option<ColourMap>,
    /// Light of its own at night (cities), 1.0 = [`BodyMaps::NIGHT_CD_M2`].
    pub night: Option<ColourMap>,
}

impl BodyMaps {
    /// Luminance of the brightest texel of a night map, cd/m²: a city, 100 nW/(cm² sr) averaged over kilometres at 300 lm/W.
    pub const NIGHT_CD_M2: f32 = 0.3;
}

/// The maps of one body on the GPU; a 1 × 1 white (albedo) or black (night) texel where there is none.
#[derive(Debug)]
pub struct MapSet {
    /// Albedo, relative to the body's mean where there is no map.
    pub albedo: Texture,
    /// Night lights.
    pub night: Texture,
    /// Group 2 of the passes that draw surfaces: 0 albedo, 1 night, 2 sampler.
    pub group: wgpu::BindGroup,
    /// True where `albedo` is a real map (it then replaces the mean albedo).
    pub has_albedo: bool,
}

/// All maps by body.
#[derive(Debug)]
pub struct MapStore {
    /// Layout of [`MapSet::group`].
    pub layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    none: MapSet,
    sets: BTreeMap<u16, MapSet>,
}

impl MapStore {
    /// No maps yet.
    pub fn new(gpu: &Gpu) -> Self {
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("maps"),
            entries: &[
                texture_entry(0, wgpu::TextureViewDimension::D2),
                texture_entry(1, wgpu::TextureViewDimension::D2),
                sampler_entry(2, wgpu::SamplerBindingType::Filtering),
            ],
        });
        let sampler = linear_sampler(&gpu.device, "maps", true);
        let none = Self::set(gpu, &layout, &sampler, None, None);
        Self { layout, sampler, none, sets: BTreeMap::new() }
    }

    fn set(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        sampler: &wgpu::Sampler,
        albedo: Option<&ColourMap>,
        night: Option<&ColourMap>,
    ) -> MapSet {
        let single = |v: u8| ColourMap { size: [1, 1], rgba: vec![v, v, v, 255] };
        let a = upload(gpu, "albedo map", albedo.unwrap_or(&single(255)));
        let n = upload(gpu, "night map", night.unwrap_or(&single(0)));
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("maps"),
            layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&a.view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&n.view) },
                wgpu::BindGroupEntry { binding: 2, resource: wgpu::BindingResource::Sampler(sampler) },
            ],
        });
        MapSet { albedo: a, night: n, group, has_albedo: albedo.is_some() }
    }

    /// Uploads maps that the caller keeps.
    pub fn make(&self, gpu: &Gpu, albedo: Option<&ColourMap>, night: Option<&ColourMap>) -> MapSet {
        Self::set(gpu, &self.layout, &self.sampler, albedo, night)
    }

    /// Uploads the maps of a body, replacing what it had.
    pub fn register(&mut self, gpu: &Gpu, id: u16, maps: &BodyMaps) -> Result<(), RenderError> {
        for (name, map) in [("albedo", &maps.albedo), ("night", &maps.night)] {
            if let Some(m) = map {
                check(gpu, id, name, m)?;
            }
        }
        self.sets.insert(id, Self::set(gpu, &self.layout, &self.sampler, maps.albedo.as_ref(), maps.night.as_ref()));
        Ok(())
    }

    /// The maps of a body, or the empty ones.
    pub fn of(&self, id: u16) -> &MapSet {
        self.sets.get(&id).unwrap_or(&self.none)
    }
}

fn check(gpu: &Gpu, id: u16, name: &'static str, map: &ColourMap) -> Result<(), RenderError> {
    let [w, h] = map.size;
    let most = gpu.device.limits().max_texture_dimension_2d;
    let wrong = |reason| Err(RenderError::Map { id, name, reason });
    if w == 0 || h == 0 || w > most || h > most {
        return wrong(format!("{w}×{h} texels; expected 1 to {most} on each side"));
    }
    let expected = 4 * w as usize * h as usize;
    if map.rgba.len() != expected {
        return wrong(format!("{} bytes for {w}×{h} RGBA texels; expected {expected}", map.rgba.len()));
    }
    Ok(())
}

fn upload(gpu: &Gpu, label: &str, map: &ColourMap) -> Texture {
    let [w, h] = map.size;
    let levels = w.max(h).ilog2() + 1;
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let texture = Texture::with(&gpu.device, label, [w, h, 1], levels, wgpu::TextureFormat::Rgba8UnormSrgb, usage);
    let mut level = map.rgba.clone();
    let (mut w, mut h) = (w as usize, h as usize);
    for i in 0..levels {
        texture.write(&gpu.queue, i, 0, &level);
        (level, w, h) = halved(&level, w, h);
    }
    texture
}

/// The next mip level by a box filter (in encoded values: the error is far below what a distant disc shows).
#[allow(clippy::cast_possible_truncation)]
fn halved(from: &[u8], w: usize, h: usize) -> (Vec<u8>, usize, usize) {
    let (nw, nh) = ((w / 2).max(1), (h / 2).max(1));
    let mut to = Vec::with_capacity(4 * nw * nh);
    for y in 0..nh {
        for x in 0..nw {
            for c in 0..4 {
                let at = |dx: usize, dy: usize| u32::from(from[4 * ((2 * y + dy).min(h - 1) * w + (2 * x + dx).min(w - 1)) + c]);
                to.push(((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8);
            }
        }
    }
    (to, nw, nh)
}
