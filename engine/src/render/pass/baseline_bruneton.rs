//! A baseline for `bench air`, not used by any picture of the game: the 4-D table of Bruneton & Neyret 2008, baked order by order, and a painter
//! that asks it.
//!
//! What the table holds and how it is laid out is told by `shaders/lib/baseline_bruneton.wgsl`; the bake is `shaders/pass/baseline_bruneton.wgsl`, the
//! drawing `shaders/pass/baseline_bruneton_sky.wgsl`. Transmittance is that of the air tables, which has his size and mapping. Light scattered once by
//! aerosol has a texture of its own, as in his newer implementation; in the paper's it is one channel beside the others.

use super::sky::{Painter, PainterKind, Parts, no_settings};
use crate::air::Air;
use crate::gpu::Gpu;
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::{Texture, linear_sampler};
use crate::render::RenderError;
use crate::render::pipeline::{
    compute_pipeline, loaded_entry, sampler_entry, storage_entry, stored_texture_entry, texture_entry, uniform_entry,
};
use crate::render::shared::AirTables;
use crate::render::targets::HDR;
use crate::scene::Body;
use crate::scene::gpu_data::{AirUniform, SkySettings};
use bytemuck::{Pod, Zeroable};
use wgpu::{BindGroupEntry, BindingResource, TextureUsages, TextureViewDimension};

/// Sizes and sample counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Texels: altitude, view, sun, angle between the two; multiples of four, but for the last.
    pub texels: [u32; 4],
    /// Trapezoids along a ray.
    pub samples: u32,
    /// Directions over a half turn; a whole turn has twice as many.
    pub directions: u32,
    /// Orders of scattering, 2 or more.
    pub orders: u32,
}

impl Default for Sizes {
    /// The paper's.
    fn default() -> Self {
        Self { texels: [32, 128, 32, 8], samples: 50, directions: 16, orders: 4 }
    }
}

/// Sun heights of the ground's irradiance.
const GROUND: u32 = 64;

/// `Job` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Job {
    sizes: [u32; 4],
    counts: [u32; 4],
    sun: [f32; 4],
}

/// The steps of the bake.
#[derive(Clone, Copy)]
enum Step {
    Single,
    Ground,
    Turn,
    Gather,
    Sum,
}

/// The painter.
struct Bruneton {
    kind: PainterKind,
    layout: wgpu::BindGroupLayout,
    steps: [wgpu::ComputePipeline; 5],
    linear: wgpu::Sampler,
    tables: AirTables,
    sizes: Sizes,
    sun_rad: f32,
    /// Light scattered once by molecules; by all others; all orders over the phase function of molecules, twice, to be added to in turn.
    single: Texture,
    others: Texture,
    totals: [Texture; 2],
    order: Texture,
    turned: Texture,
    ground: Texture,
    /// Stand where a step does not write, or reads nothing.
    spare: [Texture; 3],
    group: wgpu::BindGroup,
}

/// Compiles it; `tables` are the air tables of the one air that it will draw, in slot 0; `sun_rad` is the angular radius of its sun.
pub fn make(parts: &Parts<'_>, tables: &AirTables, sizes: Sizes, sun_rad: f32) -> Result<Box<dyn Painter>, RenderError> {
    let Parts { gpu, shaders, .. } = parts;
    let (flat, array, solid) = (TextureViewDimension::D2, TextureViewDimension::D2Array, TextureViewDimension::D3);
    let kind = PainterKind::new(parts, "pass/baseline_bruneton_sky.wgsl", &[texture_entry(0, solid), texture_entry(1, solid)])?;
    let written = |binding, view_dimension| stored_texture_entry(binding, HDR, view_dimension);
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("baseline bruneton"),
        entries: &[
            uniform_entry(0),
            loaded_entry(1, array),
            texture_entry(2, array),
            sampler_entry(3, wgpu::SamplerBindingType::Filtering),
            storage_entry(4),
            texture_entry(5, solid),
            texture_entry(6, solid),
            texture_entry(7, solid),
            texture_entry(8, solid),
            texture_entry(9, flat),
            written(10, solid),
            written(11, solid),
            written(12, flat),
        ],
    });
    let module = shaders.load(&gpu.device, "pass/baseline_bruneton.wgsl")?;
    let steps =
        ["single", "ground", "turn", "gather", "sum"].map(|entry| compute_pipeline(gpu, "baseline_bruneton", &module, &[&layout], entry));
    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
    let [altitudes, views, suns, turns] = sizes.texels;
    let table = |label| Texture::volume(&gpu.device, label, [suns * turns, views, altitudes], HDR, usage);
    let (single, others, totals) = (table("single"), table("others"), ["all orders", "all orders, too"].map(table));
    let group = bind_picture(gpu, &kind, &single, &others);
    Ok(Box::new(Bruneton {
        layout,
        steps,
        linear: linear_sampler(&gpu.device, "baseline bruneton", false),
        tables: tables.clone(),
        sizes,
        sun_rad,
        single,
        others,
        totals,
        order: table("one order"),
        turned: table("turned"),
        ground: Texture::new(&gpu.device, "ground", [GROUND, 1], HDR, usage),
        spare: [
            Texture::volume(&gpu.device, "spare", [1; 3], HDR, usage),
            Texture::volume(&gpu.device, "spare", [1; 3], HDR, usage),
            Texture::new(&gpu.device, "spare", [1, 1], HDR, usage),
        ],
        group,
        kind,
    }))
}

fn bind_picture(gpu: &Gpu, kind: &PainterKind, molecules: &Texture, others: &Texture) -> wgpu::BindGroup {
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("group 3: baseline bruneton"),
        layout: &kind.own_layout,
        entries: &[
            BindGroupEntry { binding: 0, resource: BindingResource::TextureView(&molecules.view) },
            BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&others.view) },
        ],
    })
}

impl Bruneton {
    /// One step of an order. `read`: molecules, others, the order before, turned, ground; `write`: two volumes, the ground.
    fn run(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, step: Step, order: u32, read: [&Texture; 5], write: [&Texture; 3]) {
        let Sizes { texels, samples, directions, .. } = self.sizes;
        let job = Uniform::new(&gpu.device, "Job", wgpu::BufferUsages::STORAGE);
        job.write(&gpu.queue, &Job { sizes: texels, counts: [order, samples, directions, 0], sun: [self.sun_rad, 0.0, 0.0, 0.0] });
        let air = wgpu::BufferBinding { buffer: &self.tables.airs, offset: 0, size: wgpu::BufferSize::new(size_of::<AirUniform>() as u64) };
        let mut resources = vec![
            BindingResource::Buffer(air),
            BindingResource::TextureView(&self.tables.media),
            BindingResource::TextureView(&self.tables.transmittance),
            BindingResource::Sampler(&self.linear),
            job.buffer.as_entire_binding(),
        ];
        resources.extend(read.into_iter().chain(write).map(|t| BindingResource::TextureView(&t.view)));
        let entries: Vec<_> = (0..).zip(resources).map(|(binding, resource)| BindGroupEntry { binding, resource }).collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("baseline bruneton"),
            layout: &self.layout,
            entries: &entries,
        });
        pass.set_pipeline(&self.steps[step as usize]);
        pass.set_bind_group(0, &group, &[]);
        if matches!(step, Step::Ground) {
            pass.dispatch_workgroups(GROUND.div_ceil(64), 1, 1);
        } else {
            pass.dispatch_workgroups(texels[2] * texels[3] / 4, texels[1] / 4, texels[0] / 4);
        }
    }
}

impl Painter for Bruneton {
    fn kind(&self) -> &PainterKind {
        &self.kind
    }
    fn settings(&self, _body: &Body, _air: &Air) -> SkySettings {
        let mut all = no_settings();
        all[0] = self.sizes.texels.map(|n| n as f32);
        all
    }
    fn plan(&mut self, _gpu: &Gpu, _airs: &[(u16, &Air)], _forced: bool) -> usize {
        1
    }
    fn bake(&mut self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>) {
        let [none, other, flat] = &self.spare;
        let nothing = [none, none, none, none, flat];
        self.run(gpu, pass, Step::Single, 1, nothing, [&self.single, &self.others, &self.ground]);
        let once = |order, ground| [&self.single, &self.others, order, none, ground];
        self.run(gpu, pass, Step::Ground, 2, once(none, flat), [other, &self.turned, &self.ground]);
        let mut all = &self.single;
        for order in 2..=self.sizes.orders {
            let before = if order == 2 { none } else { &self.order };
            self.run(gpu, pass, Step::Turn, order, once(before, &self.ground), [&self.turned, other, flat]);
            // What of the order before falls on the ground counts with the order that is now gathered.
            self.run(gpu, pass, Step::Ground, order + 1, once(before, flat), [other, &self.turned, &self.ground]);
            self.run(gpu, pass, Step::Gather, order, [none, none, none, &self.turned, flat], [&self.order, other, &self.ground]);
            let into = &self.totals[order as usize % 2];
            self.run(gpu, pass, Step::Sum, order, [all, none, &self.order, none, flat], [into, other, &self.ground]);
            all = into;
        }
        self.group = bind_picture(gpu, &self.kind, all, &self.others);
    }
    fn group(&self, _id: u16) -> &wgpu::BindGroup {
        &self.group
    }
}
