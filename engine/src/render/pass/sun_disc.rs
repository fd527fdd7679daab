//! The sun's disc, limb-darkened, and its corona, at true angular size and distance; hidden by whatever stands before them, so
//! that the corona shows when a moon covers the disc, and drowns in exposure and sky at all other times.

use crate::gpu::{Gpu, ShaderLibrary};
use crate::light::occlusion::{Disc, visible};
use crate::render::RenderError;
use crate::render::pass::smooth_body::POINT_BELOW_PX;
use crate::render::pipeline::PipelineKind;
use crate::render::shared::{FrameContext, Shared};
use crate::scene::{Body, Snapshot};
use crate::space::relative::narrow;
use glam::Vec3;

/// How far the corona is drawn, in radii of the star; `REACH` of the shader.
pub const CORONA_REACH: f32 = 8.0;

/// The pass.
pub struct SunDisc {
    pipeline: wgpu::RenderPipeline,
}

impl SunDisc {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/sun_disc.wgsl")?;
        let groups = [&shared.frame_layout];
        let add = wgpu::BlendComponent { src_factor: wgpu::BlendFactor::One, dst_factor: wgpu::BlendFactor::One, ..Default::default() };
        let kind = PipelineKind {
            depth: Some(false),
            blend: Some(wgpu::BlendState { color: add, alpha: wgpu::BlendComponent::OVER }),
            ..PipelineKind::opaque("sun_disc", &module, &groups)
        };
        Ok(Self { pipeline: kind.make(gpu) })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        let angle = scene.star.radius_m / scene.star.centre_m.length().max(scene.star.radius_m);
        if angle / scene.camera.pixel_rad() < POINT_BELOW_PX {
            return Some("the star is smaller than a pixel: it is drawn as a point".to_owned());
        }
        out_of_view(scene).then(|| "the star and its corona are out of view".to_owned())
    }

    /// Adds it to HDR where depth leaves it free.
    pub fn record(&self, f: &mut FrameContext<'_>) {
        let mut pass = f.draw_opaque("sun_disc");
        pass.set_pipeline(&self.pipeline);
        pass.draw(0..6, 0..1);
    }
}

/// True when neither the star nor its corona reaches into the picture.
pub fn out_of_view(scene: &Snapshot) -> bool {
    let centre = scene.star.centre_m;
    let distance = centre.length();
    let angle = scene.star.radius_m / distance.max(scene.star.radius_m);
    let camera = &scene.camera;
    let tan = (0.5 * camera.fov_y_rad).tan();
    let half_diagonal = (tan * (1.0 + camera.aspect() * camera.aspect()).sqrt()).atan();
    let forward = camera.view_from_icrf.conjugate() * Vec3::NEG_Z;
    let off_axis = (centre.dot(forward) / distance.max(1.0)).clamp(-1.0, 1.0).acos();
    off_axis > half_diagonal + CORONA_REACH * angle + 0.01
}

/// Share of the star's disc that no body hides from the camera, 0 … 1.
pub fn free_fraction(scene: &Snapshot) -> f32 {
    let star = &scene.star;
    let sun = Disc::of_sphere(star.centre_m.as_dvec3(), f64::from(star.radius_m));
    let before = |b: &&Body| b.centre_m.length_squared() < star.centre_m.length_squared();
    let disc = |b: &Body| Disc::of_sphere(b.centre_m.as_dvec3(), f64::from(b.radius_m));
    let discs: Vec<Disc> = scene.bodies.iter().filter(before).map(disc).collect();
    narrow(visible(sun, &discs))
}
