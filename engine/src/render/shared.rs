//! Shared: what all passes bind, and the context that a pass records into.
//!
//! | group | holds | who makes it |
//! |---|---|---|
//! | 0 | 0 `Frame`, 1 `Bodies`, 2 `Exposure` (all uniform; `shaders/lib/frame.wgsl`) | [`Shared`], each frame |
//! | 1 | 0 airs (uniform), 1 transmittance, 2 further orders (3-D), 3 irradiance (1, 3: 2-D arrays, a layer per air slot), 4 linear sampler, 5 shadow map, 6 comparison sampler, 7 shadow (uniform), 8 media (2-D array, loaded), 9 refracted light (2-D array, loaded, a layer per planet), 10 sheets of eclipses (2-D array, three layers each), 12 scattering (3-D) and 13 `ViewTable` (uniform) of the world whose water mirrors them | [`Shared::light_group`], from the values of the air-table, refracted, sky and shadow passes |
//! | 2, 3 | the pass's own | the pass |

use super::maps::MapStore;
use super::pipeline::{depth_entry, loaded_entry, sampler_entry, texture_entry, uniform_entry};
use super::report::{AirReport, FrameReport, PassReport};
use super::targets::{DEPTH, HDR, Targets};
use crate::gpu::Gpu;
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::{Texture, linear_sampler};
use crate::gpu::timer::Timer;
use crate::scene::Snapshot;
use crate::scene::gpu_data::{BodiesUniform, ExposureUniform, FrameUniform, ShadowUniform, ViewTableUniform};
use wgpu::BufferUsages;

/// Tables of air, as the later passes see them: a layer per slot.
#[derive(Clone, Debug)]
pub struct AirTables {
    /// `array<Air, …>` of `shaders/lib/air.wgsl`, as a uniform.
    pub airs: wgpu::Buffer,
    /// Transmittance to the star, 2-D array.
    pub transmittance: wgpu::TextureView,
    /// Further orders of scattering, 3-D: `shaders/lib/air_orders.wgsl`.
    pub orders: wgpu::TextureView,
    /// Illuminance of the sky on horizontal ground, 2-D array.
    pub irradiance: wgpu::TextureView,
    /// Media that are not formulas (`shaders/lib/medium.wgsl`), 2-D array, not filterable.
    pub media: wgpu::TextureView,
}

/// The sky that water mirrors: tables of a body whose model is `view_table`.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Its 3-D table.
    pub scatter: wgpu::TextureView,
    /// `ViewTable` of `shaders/lib/view_table.wgsl`, as a uniform; it names the body.
    pub uniform: wgpu::Buffer,
}

/// The ship's shadow map, as the later passes see it.
#[derive(Clone, Debug)]
pub struct ShadowMap {
    /// Depth along the light, 2-D.
    pub depth: wgpu::TextureView,
    /// `Shadow` of `shaders/lib/shadow.wgsl`, as a uniform.
    pub uniform: wgpu::Buffer,
}

/// Buffers, layouts and samplers that every pass uses.
#[derive(Debug)]
pub struct Shared {
    /// Group 0.
    pub frame_layout: wgpu::BindGroupLayout,
    /// Group 0, bound.
    pub frame_group: wgpu::BindGroup,
    /// Group 1.
    pub light_layout: wgpu::BindGroupLayout,
    /// `Frame`.
    pub frame: Uniform<FrameUniform>,
    /// `Bodies`.
    pub bodies: Uniform<BodiesUniform>,
    /// `Exposure` in force while this frame is drawn.
    pub exposure: Uniform<ExposureUniform>,
    /// The `Exposure` found by this frame's histogram, for the next.
    pub exposure_next: Uniform<ExposureUniform>,
    /// The `Exposure` with which the last finished frame was stored.
    pub exposure_used: Uniform<ExposureUniform>,
    /// Bilinear, clamped.
    pub linear: wgpu::Sampler,
    /// Compares with GreaterEqual (reversed depth), bilinear.
    pub compare: wgpu::Sampler,
}

impl Mirror {
    /// No such body.
    pub fn none(gpu: &Gpu) -> Self {
        let uniform = Uniform::<ViewTableUniform>::new(&gpu.device, "ViewTable", BufferUsages::empty());
        uniform.write(&gpu.queue, &ViewTableUniform::none());
        let usage = wgpu::TextureUsages::TEXTURE_BINDING;
        Self { scatter: Texture::volume(&gpu.device, "no mirror", [1; 3], HDR, usage).view, uniform: uniform.buffer }
    }
}

impl ShadowMap {
    /// Nothing throws a shadow.
    pub fn none(gpu: &Gpu) -> Self {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT;
        let uniform = Uniform::<ShadowUniform>::new(&gpu.device, "Shadow", BufferUsages::empty());
        Self { depth: Texture::new(&gpu.device, "no shadow", [1, 1], DEPTH, usage).view, uniform: uniform.buffer }
    }
}

impl Shared {
    /// Makes them.
    pub fn new(gpu: &Gpu) -> Self {
        let d = &gpu.device;
        let frame_layout = d.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("group 0: frame"),
            entries: &[uniform_entry(0), uniform_entry(1), uniform_entry(2)],
        });
        let array = wgpu::TextureViewDimension::D2Array;
        let light_layout = d.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("group 1: light"),
            entries: &[
                uniform_entry(0),
                texture_entry(1, array),
                texture_entry(2, wgpu::TextureViewDimension::D3),
                texture_entry(3, array),
                sampler_entry(4, wgpu::SamplerBindingType::Filtering),
                depth_entry(5),
                sampler_entry(6, wgpu::SamplerBindingType::Comparison),
                uniform_entry(7),
                loaded_entry(8, array),
                loaded_entry(9, array),
                texture_entry(10, array),
                texture_entry(12, wgpu::TextureViewDimension::D3),
                uniform_entry(13),
            ],
        });
        let frame = Uniform::new(d, "Frame", BufferUsages::empty());
        let bodies = Uniform::new(d, "Bodies", BufferUsages::empty());
        let exposure = Uniform::new(d, "Exposure", BufferUsages::COPY_SRC);
        let exposure_next = Uniform::new(d, "Exposure next", BufferUsages::COPY_SRC | BufferUsages::STORAGE);
        let exposure_used = Uniform::new(d, "Exposure used", BufferUsages::COPY_SRC);
        let frame_group = d.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("group 0: frame"),
            layout: &frame_layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: frame.buffer.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: bodies.buffer.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 2, resource: exposure.buffer.as_entire_binding() },
            ],
        });
        let linear = linear_sampler(d, "linear", false);
        let compare = d.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("compare"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        Self { frame_layout, frame_group, light_layout, frame, bodies, exposure, exposure_next, exposure_used, linear, compare }
    }

    /// Sets the exposure of the frame to come (and of the one after, unless a histogram says otherwise).
    pub fn write_exposure(&self, gpu: &Gpu, value: &ExposureUniform) {
        self.exposure.write(&gpu.queue, value);
        self.exposure_next.write(&gpu.queue, value);
    }

    /// Group 1 from the values of the air-table, refracted, sky and shadow passes.
    pub fn light_group(
        &self,
        gpu: &Gpu,
        air: &AirTables,
        refracted: &wgpu::TextureView,
        sheets: &wgpu::TextureView,
        mirror: &Mirror,
        shadow: &ShadowMap,
    ) -> wgpu::BindGroup {
        use wgpu::BindingResource::{Sampler, TextureView};
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("group 1: light"),
            layout: &self.light_layout,
            entries: &[
                entry(0, air.airs.as_entire_binding()),
                entry(1, TextureView(&air.transmittance)),
                entry(2, TextureView(&air.orders)),
                entry(3, TextureView(&air.irradiance)),
                entry(4, Sampler(&self.linear)),
                entry(5, TextureView(&shadow.depth)),
                entry(6, Sampler(&self.compare)),
                entry(7, shadow.uniform.as_entire_binding()),
                entry(8, TextureView(&air.media)),
                entry(9, TextureView(refracted)),
                entry(10, TextureView(sheets)),
                entry(12, TextureView(&mirror.scatter)),
                entry(13, mirror.uniform.as_entire_binding()),
            ],
        })
    }
}

/// What a pass records into: one frame, one encoder, top to bottom.
pub struct FrameContext<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The frame's encoder.
    pub encoder: wgpu::CommandEncoder,
    /// What is drawn.
    pub scene: &'a Snapshot,
    /// Groups and samplers.
    pub shared: &'a Shared,
    /// Textures sized by the picture.
    pub targets: &'a Targets,
    /// Maps by body.
    pub maps: &'a MapStore,
    /// Slot of the air tables of each body in `scene.bodies`.
    pub air_slots: Vec<Option<u32>>,
    pub(super) timer: Option<&'a mut Timer>,
    pub(super) report: FrameReport,
}

impl FrameContext<'_> {
    /// Notes what becomes of a pass; true when it has to run. `skip` is why it may be left out, `None` that it is needed.
    pub fn runs(&mut self, name: &'static str, skip: Option<String>) -> bool {
        let forced = self.scene.force.all;
        let (ran, reason) = match skip {
            None => (true, "needed by the scene".to_owned()),
            Some(why) if forced => (true, format!("forced; else skipped: {why}")),
            Some(why) => (false, why),
        };
        self.report.passes.push(PassReport { name: name.to_owned(), ran, reason, gpu_ms: None });
        ran
    }

    /// Notes what becomes of a body's air.
    pub fn report_air(&mut self, air: AirReport) {
        self.report.airs.push(air);
    }

    /// Begins a render pass that draws over what is in the opaque HDR target and depth; group 0 is bound.
    pub fn draw_opaque(&mut self, name: &'static str) -> wgpu::RenderPass<'_> {
        self.opaque_pass(name, wgpu::LoadOp::Load, wgpu::LoadOp::Load)
    }

    /// Empties the opaque HDR target and depth.
    pub fn clear_opaque(&mut self) {
        drop(self.opaque_pass("clear", wgpu::LoadOp::Clear(wgpu::Color::BLACK), wgpu::LoadOp::Clear(0.0)));
    }

    fn opaque_pass(&mut self, name: &'static str, colour: wgpu::LoadOp<wgpu::Color>, depth: wgpu::LoadOp<f32>) -> wgpu::RenderPass<'_> {
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.targets.opaque.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: colour, store: wgpu::StoreOp::Store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth.view,
                depth_ops: Some(wgpu::Operations { load: depth, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: self.timer.as_mut().and_then(|t| t.render(name)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.shared.frame_group, &[]);
        pass
    }

    /// Begins a full-screen pass into one colour view, without depth; group 0 is bound. `load: false` leaves the old contents undefined.
    pub fn draw_full_screen<'e>(&'e mut self, name: &'static str, view: &wgpu::TextureView, load: bool) -> wgpu::RenderPass<'e> {
        let ops = if load { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
        self.draw_views(name, &[view], ops, None)
    }

    /// Begins a pass into two colour views of one size, without depth and with their old contents or cleared; group 0 is bound.
    pub fn draw_pair<'e>(&'e mut self, name: &'static str, views: [&wgpu::TextureView; 2], load: bool) -> wgpu::RenderPass<'e> {
        let ops = if load { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) };
        self.draw_views(name, &views, ops, None)
    }

    /// Begins a pass into one colour view that marks what it has drawn in a stencil of the same size, emptied, with 1 for reference; group 0 is bound.
    pub fn draw_marked<'e>(
        &'e mut self,
        name: &'static str,
        view: &wgpu::TextureView,
        load: bool,
        stencil: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        let ops = if load { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
        self.draw_views(name, &[view], ops, Some(stencil))
    }

    fn draw_views<'e>(
        &'e mut self,
        name: &'static str,
        views: &[&wgpu::TextureView],
        load: wgpu::LoadOp<wgpu::Color>,
        stencil: Option<&wgpu::TextureView>,
    ) -> wgpu::RenderPass<'e> {
        let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
        let attach = |view| Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops });
        let attachments: Vec<_> = views.iter().copied().map(attach).collect();
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &attachments,
            depth_stencil_attachment: stencil.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: None,
                stencil_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0), store: wgpu::StoreOp::Discard }),
            }),
            timestamp_writes: self.timer.as_mut().and_then(|t| t.render(name)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.shared.frame_group, &[]);
        pass.set_stencil_reference(1);
        pass
    }

    /// Begins a compute pass; group 0 is bound.
    pub fn compute(&mut self, name: &'static str) -> wgpu::ComputePass<'_> {
        let mut pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(name),
            timestamp_writes: self.timer.as_mut().and_then(|t| t.compute(name)),
        });
        pass.set_bind_group(0, &self.shared.frame_group, &[]);
        pass
    }

    /// Begins a depth-only pass into `view` (cleared to 0), for shadow maps; group 0 is bound.
    pub fn draw_depth<'e>(&'e mut self, name: &'static str, view: &wgpu::TextureView) -> wgpu::RenderPass<'e> {
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: self.timer.as_mut().and_then(|t| t.render(name)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.shared.frame_group, &[]);
        pass
    }

    /// Hands this frame's exposure on: what it was stored with is kept for readback, what its histogram wants goes to the next.
    pub(super) fn keep_exposure(&mut self) {
        let size = size_of::<ExposureUniform>() as u64;
        let s = self.shared;
        self.encoder.copy_buffer_to_buffer(&s.exposure.buffer, 0, &s.exposure_used.buffer, 0, size);
        self.encoder.copy_buffer_to_buffer(&s.exposure_next.buffer, 0, &s.exposure.buffer, 0, size);
    }

    /// Submits what was recorded.
    pub(super) fn submit(mut self) -> FrameReport {
        if let Some(timer) = &mut self.timer {
            timer.end_frame(&mut self.encoder);
        }
        self.gpu.submit(self.encoder);
        if let Some(timer) = self.timer {
            timer.after_submit();
        }
        self.report
    }
}
