//! The sky and aerial perspective: every air in view laid over the opaque picture, far to near, in one full-screen draw.
//!
//! The march itself is `shaders/lib/air_march.wgsl`. Not here: the sun's disc and the stars, which are drawn before and dimmed by the air.

use super::smooth_body::radius_px;
use crate::gpu::buffer::Uniform;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, depth_entry, texture_entry, uniform_entry};
use crate::render::shared::{FrameContext, Shared};
use crate::render::targets::HDR;
use crate::scene::gpu_data::{MAX_AIRS, MAX_BODIES, SkyUniform};
use crate::scene::{Body, Snapshot};
use glam::Vec3;
use wgpu::{BindGroupEntry, BindingResource};

/// Air around a disc of a smaller radius than this, in pixels, is not drawn.
pub const AIR_BELOW_PX: f32 = 0.5;

/// Steps of a march through a whole sky unless told otherwise: the mean error against 256 steps is under 1 % in every light.
pub const STEPS: u32 = 24;

/// The pass.
pub struct Sky {
    /// Steps of a march through a whole sky; short ways take fewer.
    pub steps: u32,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    uniform: Uniform<SkyUniform>,
}

impl Sky {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/sky.wgsl")?;
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("sky"),
            entries: &[texture_entry(0, wgpu::TextureViewDimension::D2), depth_entry(1), uniform_entry(2)],
        });
        let groups = [&shared.frame_layout, &shared.light_layout, &layout];
        let pipeline = PipelineKind::full_screen("sky", &module, &groups, HDR).make(gpu);
        Ok(Self { steps: STEPS, pipeline, uniform: Uniform::new(&gpu.device, "Sky", wgpu::BufferUsages::empty()), layout })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        if scene.bodies.iter().all(|b| b.air.is_none()) {
            return Some("no body in the scene has air".to_owned());
        }
        drawn(scene).is_empty().then(|| "no air in view covers a pixel".to_owned())
    }

    /// Reads the opaque colour and depth, writes the same seen through air into `aerial`, and gives that. `light` is group 1.
    pub fn record(&self, f: &mut FrameContext<'_>, light: &wgpu::BindGroup) -> wgpu::TextureView {
        let order: Vec<u32> = drawn(f.scene).into_iter().filter(|i| f.air_slots.get(*i as usize).copied().flatten().is_some()).collect();
        self.uniform.write(&f.gpu.queue, &SkyUniform::new(&order, self.steps));
        let group = f.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("sky"),
            layout: &self.layout,
            entries: &[
                BindGroupEntry { binding: 0, resource: BindingResource::TextureView(&f.targets.opaque.view) },
                BindGroupEntry { binding: 1, resource: BindingResource::TextureView(&f.targets.depth.view) },
                BindGroupEntry { binding: 2, resource: self.uniform.buffer.as_entire_binding() },
            ],
        });
        let view = f.targets.aerial.view.clone();
        let mut pass = f.draw_full_screen("sky", &view, false);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, light, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        view
    }
}

/// Indices of the bodies whose air is in view, far to near.
fn drawn(scene: &Snapshot) -> Vec<u32> {
    let mut order: Vec<u32> = (0u32..)
        .zip(scene.bodies.iter().take(MAX_BODIES))
        .filter(|(_, b)| b.air.is_some() && radius_px(scene, b) >= AIR_BELOW_PX && in_view(scene, b))
        .map(|(i, _)| i)
        .collect();
    order.truncate(MAX_AIRS);
    order.reverse();
    order
}

/// Whether any of a body's air may lie within the cone around the picture's corners.
fn in_view(scene: &Snapshot, body: &Body) -> bool {
    let Some(air) = &body.air else { return false };
    let outer = body.radius_m + crate::space::relative::narrow(air.medium.top_altitude_m);
    let distance = body.radius_m + body.camera_altitude_m;
    if distance <= outer {
        return true;
    }
    let forward = scene.camera.view_from_icrf.conjugate() * Vec3::NEG_Z;
    let off_axis = forward.dot(-body.camera_up).clamp(-1.0, 1.0).acos();
    let half_height = (0.5 * scene.camera.fov_y_rad).tan();
    let corner = (half_height * (1.0 + scene.camera.aspect() * scene.camera.aspect()).sqrt()).atan();
    off_axis <= corner + (outer / distance).asin() + 0.01
}
