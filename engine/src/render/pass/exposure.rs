//! Exposure: a histogram of luminance, its trimmed mean, and how the eye goes there in time. All on the GPU: nothing waits.

use crate::gpu::buffer::Uniform;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::light::exposure::LUMINANCE;
use crate::render::RenderError;
use crate::render::pass::sun_disc;
use crate::render::pipeline::{compute_pipeline, texture_entry, uniform_entry, written_entry};
use crate::render::shared::{FrameContext, Shared};
use crate::scene::gpu_data::MeterUniform;
use crate::scene::{AutoOr, Snapshot};
use wgpu::{BindGroupEntry, BufferUsages};

/// Bins of the histogram.
const BINS: u64 = 256;

/// Illuminance of the star at the camera, where it is in view and not hidden by a body, lx.
fn glare_lx(scene: &Snapshot) -> f32 {
    if sun_disc::out_of_view(scene) {
        return 0.0;
    }
    let star = &scene.star;
    let free = sun_disc::free_fraction(scene);
    free * star.intensity_cd.dot(LUMINANCE) / star.centre_m.length_squared().max(1.0)
}

/// The pass.
pub struct Exposure {
    layout: wgpu::BindGroupLayout,
    count: wgpu::ComputePipeline,
    settle: wgpu::ComputePipeline,
    histogram: wgpu::Buffer,
    meter: Uniform<MeterUniform>,
}

impl Exposure {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/exposure.wgsl")?;
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("exposure"),
            entries: &[texture_entry(0, wgpu::TextureViewDimension::D2), written_entry(1), written_entry(2), uniform_entry(3)],
        });
        let groups = [&shared.frame_layout, &layout];
        Ok(Self {
            count: compute_pipeline(gpu, "exposure count", &module, &groups, "count_pixels"),
            settle: compute_pipeline(gpu, "exposure settle", &module, &groups, "settle"),
            histogram: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("exposure histogram"),
                size: BINS * 4,
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            meter: Uniform::new(&gpu.device, "Meter", BufferUsages::empty()),
            layout,
        })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot, metered: bool) -> Option<String> {
        match scene.exposure {
            AutoOr::Ev100(ev) => Some(format!("exposure is fixed at EV {ev:.1}")),
            AutoOr::Auto { .. } if metered => None,
            AutoOr::Auto { .. } => None,
        }
    }

    /// Measures `lit` and writes the exposure of the next frame.
    pub fn record(&self, f: &mut FrameContext<'_>, lit: &wgpu::TextureView) {
        let AutoOr::Auto { compensation_ev } = f.scene.exposure else { return };
        self.meter.write(&f.gpu.queue, &MeterUniform::new(compensation_ev, glare_lx(f.scene)));
        let group = f.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("exposure"),
            layout: &self.layout,
            entries: &[
                BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(lit) },
                BindGroupEntry { binding: 1, resource: self.histogram.as_entire_binding() },
                BindGroupEntry { binding: 2, resource: f.shared.exposure_next.buffer.as_entire_binding() },
                BindGroupEntry { binding: 3, resource: self.meter.buffer.as_entire_binding() },
            ],
        });
        f.encoder.clear_buffer(&self.histogram, 0, None);
        // Every second pixel each way is enough; a workgroup covers 32 × 32 pixels.
        let [w, h] = f.targets.size.map(|n| n.div_ceil(32));
        let mut pass = f.compute("exposure");
        pass.set_bind_group(1, &group, &[]);
        pass.set_pipeline(&self.count);
        pass.dispatch_workgroups(w, h, 1);
        pass.set_pipeline(&self.settle);
        pass.dispatch_workgroups(1, 1, 1);
    }
}
