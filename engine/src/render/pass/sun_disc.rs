//! The sun's disc: limb-darkened, at its true angular size and distance, hidden by whatever stands before it.

use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pass::smooth_body::POINT_BELOW_PX;
use crate::render::pipeline::PipelineKind;
use crate::render::shared::{FrameContext, Shared};
use crate::scene::Snapshot;
use glam::Vec3;

/// The pass.
pub struct SunDisc {
    pipeline: wgpu::RenderPipeline,
}

impl SunDisc {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/sun_disc.wgsl")?;
        let groups = [&shared.frame_layout];
        Ok(Self { pipeline: PipelineKind::opaque("sun_disc", &module, &groups).make(gpu) })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        let centre = scene.star.centre_m;
        let distance = centre.length();
        let angle = scene.star.radius_m / distance.max(scene.star.radius_m);
        if angle / scene.camera.pixel_rad() < POINT_BELOW_PX {
            return Some("the star is smaller than a pixel: it is drawn as a point".to_owned());
        }
        let camera = &scene.camera;
        let tan = (0.5 * camera.fov_y_rad).tan();
        let half_diagonal = (tan * (1.0 + camera.aspect() * camera.aspect()).sqrt()).atan();
        let forward = camera.view_from_icrf.conjugate() * Vec3::NEG_Z;
        let off_axis = (centre.dot(forward) / distance.max(1.0)).clamp(-1.0, 1.0).acos();
        (off_axis > half_diagonal + 1.2 * angle + 0.01).then(|| "the star is out of view".to_owned())
    }

    /// Draws it over HDR and depth.
    pub fn record(&self, f: &mut FrameContext<'_>) {
        let mut pass = f.draw_opaque("sun_disc");
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..6, 0..1);
    }
}
