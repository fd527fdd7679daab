//! Eclipsed surroundings: for every body in air that another world's shadow reaches, the free fraction of the sun's disc on rings about each place, from
//! which light comes that is scattered more than once ([`crate::air::model::spread`]).
//!
//! A sheet across the shadow per body and occluder, made anew in every frame in which such air is drawn: as many samples as a few thousand pixels of
//! march. Shader: `shaders/pass/eclipse_rings.wgsl`; asked by `shaders/lib/eclipse_rings.wgsl`. Not here: the shadow at a point itself.

use super::air_tables::AirBaker;
use crate::air::model::spread::Spread;
use crate::gpu::texture::Texture;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::light::shadow::Shadow;
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, storage_entry, stored_texture_entry, uniform_entry};
use crate::render::shared::{AirTables, FrameContext, Shared};
use crate::render::targets::HDR;
use crate::scene::gpu_data::{Layers, MAX_BODIES, MAX_OCCLUDERS};
use crate::scene::{Body, Snapshot, Star};
use wgpu::util::DeviceExt as _;
use wgpu::{BindGroupEntry, BindingResource, BufferUsages, TextureUsages, TextureViewDimension};

/// Texels of a sheet each way: `SHEET` of `shaders/lib/eclipse_rings.wgsl`.
const SHEET: u32 = 80;
/// Sheets that are kept.
const KEPT: u32 = 8;
/// Layers of one.
const MOMENTS: u32 = 3;
/// The finest cell of a sheet over the nearest distance from which light comes.
const FINEST: f64 = 0.35;

/// A sheet that is needed: which body and occluder, slot of the air.
pub type Asked = [u32; 4];

/// The pass.
pub struct EclipseRings {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
    texture: Texture,
    asked: Vec<Asked>,
}

impl EclipseRings {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let written = stored_texture_entry(2, HDR, TextureViewDimension::D2Array);
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("eclipse rings"),
            entries: &[uniform_entry(0), storage_entry(1), written],
        });
        let module = shaders.load(&gpu.device, "pass/eclipse_rings.wgsl")?;
        let pipeline = compute_pipeline(gpu, "eclipse_rings", &module, &[&shared.frame_layout, &layout], "bake");
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
        let texture = Texture::with(&gpu.device, "eclipse rings", [SHEET, SHEET, KEPT * MOMENTS], 1, HDR, usage);
        Ok(Self { layout, pipeline, texture, asked: Vec::new() })
    }

    /// Gives every body's occluders whose shadows reach its air their sheets, as far as there are any left.
    #[allow(clippy::cast_possible_truncation)]
    pub fn assign(&mut self, scene: &Snapshot, airs: &AirBaker, all: &mut [Layers]) {
        self.asked.clear();
        for (i, (layers, body)) in all.iter_mut().zip(&scene.bodies).take(MAX_BODIES).enumerate() {
            let Some((slot, spread)) = layers.air.and_then(|slot| Some((slot, airs.spread(slot)?))) else { continue };
            ask(&mut self.asked, (i as u32, body), &scene.star, (slot, spread), layers);
        }
    }

    /// Why the scene does not need it.
    pub fn skip(&self) -> Option<String> {
        self.asked.is_empty().then(|| "no shadow of another world reaches air that is drawn".to_owned())
    }

    /// Makes them, and gives the texture.
    pub fn record(&self, f: &mut FrameContext<'_>, airs: &AirTables) -> wgpu::TextureView {
        let (gpu, shared) = (f.gpu, f.shared);
        self.bake(gpu, shared, &mut f.compute("eclipse_rings"), airs, &self.asked);
        self.sheets()
    }

    /// Records the making of all that is asked.
    pub fn bake(&self, gpu: &Gpu, shared: &Shared, pass: &mut wgpu::ComputePass<'_>, airs: &AirTables, all: &[Asked]) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &shared.frame_group, &[]);
        for (asked, i) in all.iter().zip(0..) {
            let uniform = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("eclipse rings"),
                contents: bytemuck::bytes_of(asked),
                usage: BufferUsages::STORAGE,
            });
            let view = self.texture.texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(TextureViewDimension::D2Array),
                base_array_layer: i * MOMENTS,
                array_layer_count: Some(MOMENTS),
                ..Default::default()
            });
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("eclipse rings"),
                layout: &self.layout,
                entries: &[
                    BindGroupEntry { binding: 0, resource: airs.airs.as_entire_binding() },
                    BindGroupEntry { binding: 1, resource: uniform.as_entire_binding() },
                    BindGroupEntry { binding: 2, resource: BindingResource::TextureView(&view) },
                ],
            });
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups(SHEET / 8, SHEET / 8, 1);
        }
    }

    /// The texture, three layers a sheet.
    pub fn sheets(&self) -> wgpu::TextureView {
        self.texture.array_view()
    }

    /// Where nothing is eclipsed.
    pub fn none(gpu: &Gpu) -> wgpu::TextureView {
        Texture::new(&gpu.device, "no eclipse", [1, 1], HDR, TextureUsages::TEXTURE_BINDING).array_view()
    }
}

/// What is asked for the occluders of one body, in the light of a star and with the air in a slot.
#[allow(clippy::cast_possible_truncation)]
pub fn ask(asked: &mut Vec<Asked>, (place, body): (u32, &Body), star: &Star, (slot, spread): (u32, &Spread), layers: &mut Layers) {
    let top_m = body.air.as_ref().map_or(0.0, |a| a.medium.top_altitude_m);
    let (centre_m, radius_m) = (body.centre_m.as_dvec3(), f64::from(body.radius_m) + top_m);
    for (k, occluder) in body.occluders.iter().take(MAX_OCCLUDERS).enumerate() {
        let first = asked.len() as u32;
        let shadow =
            Shadow::new((occluder.centre_m.as_dvec3(), f64::from(occluder.radius_m)), (star.centre_m.as_dvec3(), f64::from(star.radius_m)));
        let sheet = shadow.sheet(centre_m, radius_m, spread.reach_m(), FINEST * spread.radius_m[0][0], f64::from(SHEET));
        if let Some(sheet) = sheet.filter(|_| first < KEPT && spread.reach_m() > 0.0) {
            layers.sheets[k] = Some((first * MOMENTS, sheet));
            asked.push([place, k as u32, slot, 0]);
        }
    }
}
