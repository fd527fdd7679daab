//! Smooth bodies: spheres ray-traced inside a quad that bounds them, with exact depth. For worlds too far for relief, and for
//! those that have none. Colour from maps where there are any; fluid worlds (radius over 20,000 km) get latitudinal bands.
//!
//! Not here: terrain (`terrain.rs`), bodies far under a pixel (`stars.rs` draws them as points).

use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::maps::MapStore;
use crate::render::pipeline::PipelineKind;
use crate::render::shared::{FrameContext, Shared};
use crate::scene::gpu_data::MAX_BODIES;
use crate::scene::{Body, Snapshot, Surface};

/// Angular radius, in pixels, under which a body is a point of light.
pub const POINT_BELOW_PX: f32 = 0.75;

/// The pass.
pub struct SmoothBody {
    pipeline: wgpu::RenderPipeline,
}

impl SmoothBody {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared, maps: &MapStore) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/smooth_body.wgsl")?;
        let groups = [&shared.frame_layout, &shared.light_layout, &maps.layout];
        Ok(Self { pipeline: PipelineKind::opaque("smooth_body", &module, &groups).make(gpu) })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        drawn(scene).next().is_none().then(|| "no body in the scene is a smooth sphere of more than a pixel".to_owned())
    }

    /// Draws them over HDR and depth; `light` is group 1.
    pub fn record(&self, f: &mut FrameContext<'_>, light: &wgpu::BindGroup) {
        let (scene, maps) = (f.scene, f.maps);
        let mut pass = f.draw_opaque("smooth_body");
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, light, &[]);
        for (i, body) in drawn(scene) {
            pass.set_bind_group(2, &maps.of(body.id).group, &[]);
            pass.draw(0..6, i..i + 1);
        }
    }
}

/// Angular radius of a body in pixels.
pub fn radius_px(scene: &Snapshot, body: &Body) -> f32 {
    let distance = (body.radius_m + body.camera_altitude_m).max(1.0);
    body.radius_m / distance / scene.camera.pixel_rad()
}

fn drawn(scene: &Snapshot) -> impl Iterator<Item = (u32, &Body)> {
    (0u32..)
        .zip(scene.bodies.iter().take(MAX_BODIES))
        .filter(|(_, b)| matches!(b.surface, Surface::Smooth) && radius_px(scene, b) >= POINT_BELOW_PX)
}
