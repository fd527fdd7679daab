//! Stars, and bodies too far to show a disc: points of light of their true illuminance, spread over a small Gaussian so that
//! they neither flicker nor grow. Hidden by depth; by day they drown in exposure, under air in the sky's own light.
//!
//! The catalogue's format is described in `assets/stars/bake.py`. Not here: the sun's disc (`sun_disc.rs`).

use crate::gpu::buffer::List;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pass::smooth_body::{POINT_BELOW_PX, radius_px};
use crate::render::pass::sun_disc;
use crate::render::pipeline::PipelineKind;
use crate::render::shared::{FrameContext, Shared};
use crate::scene::{Body, Snapshot, Surface};
use bytemuck::{Pod, Zeroable};
use core::f32::consts::PI;
use glam::Vec3;
use wgpu::{BufferUsages, VertexFormat};

/// Illuminance of a star of magnitude V = 0 above the air, lx [Allen's Astrophysical Quantities, 4th ed., §2.6: 2.54e-6 lx].
pub const LX_AT_MAGNITUDE_0: f32 = 2.54e-6;

/// Far enough for a star: its depth is under any body's, and still above the cleared 0.
const STAR_DISTANCE_M: f32 = 1.0e18;

/// A point of light.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Point {
    /// Camera-relative, m.
    pub position_m: [f32; 3],
    /// Illuminance at the camera, lx per channel.
    pub illuminance_lx: [f32; 3],
}

/// A catalogue that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("star catalogue: {0}; expected `SYZSTAR1`, a count and 8 bytes a star, as assets/stars/bake.py writes them")]
pub struct CatalogueError(String);

/// Stars as points, brightest first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StarCatalogue {
    /// The stars.
    pub points: Vec<Point>,
}

impl StarCatalogue {
    /// Reads the baked format.
    pub fn parse(bytes: &[u8]) -> Result<Self, CatalogueError> {
        let rest = bytes.strip_prefix(b"SYZSTAR1").ok_or_else(|| CatalogueError("the first 8 bytes are others".to_owned()))?;
        let (count, records) =
            rest.split_first_chunk::<4>().ok_or_else(|| CatalogueError("it ends before the count of stars".to_owned()))?;
        let count = u32::from_le_bytes(*count) as usize;
        if count.checked_mul(8) != Some(records.len()) {
            return Err(CatalogueError(format!("{count} stars are announced, {} bytes follow", records.len())));
        }
        let points = records.chunks_exact(8).map(|r| {
            let axis = |i: usize| f32::from(i16::from_le_bytes([r[i], r[i + 1]]));
            let direction = Vec3::new(axis(0), axis(2), axis(4)).normalize_or(Vec3::Z);
            star(direction, f32::from(r[6]) / 20.0 - 2.0, f32::from(r[7]) / 80.0 - 0.5)
        });
        Ok(Self { points: points.collect() })
    }
}

/// A star by its J2000 direction, V magnitude and B−V colour.
pub fn star(direction: Vec3, v: f32, b_v: f32) -> Point {
    let lx = LX_AT_MAGNITUDE_0 * (-0.4 * v * core::f32::consts::LN_10).exp();
    Point { position_m: (direction * STAR_DISTANCE_M).to_array(), illuminance_lx: (colour_of_b_v(b_v) * lx).to_array() }
}

/// Linear sRGB colour of luminance 1 of a star: temperature by [Ballesteros 2012, eq. 14], chromaticity of the Planckian locus by
/// [Kim et al. 2002, US patent 7024034].
pub fn colour_of_b_v(b_v: f32) -> Vec3 {
    let b = 0.92 * b_v.clamp(-0.4, 2.2);
    let t = (4600.0 * (1.0 / (b + 1.7) + 1.0 / (b + 0.62))).clamp(1667.0, 25_000.0);
    let u = 1000.0 / t;
    let x = if t < 4000.0 {
        ((-0.266_123_9 * u - 0.234_358) * u + 0.877_695_6) * u + 0.179_91
    } else {
        ((-3.025_847 * u + 2.107_038) * u + 0.222_634_7) * u + 0.240_39
    };
    let y = if t < 2222.0 {
        ((-1.106_381_4 * x - 1.348_110_2) * x + 2.185_558_3) * x - 0.202_196_8
    } else if t < 4000.0 {
        ((-0.954_947_6 * x - 1.374_185_9) * x + 2.091_37) * x - 0.167_488_7
    } else {
        ((3.081_758 * x - 5.873_387) * x + 3.751_13) * x - 0.370_014_8
    };
    let (cx, cz) = (x / y, (1.0 - x - y) / y);
    Vec3::new(3.2406 * cx - 1.5372 - 0.4986 * cz, -0.9689 * cx + 1.8758 + 0.0415 * cz, 0.0557 * cx - 0.2040 + 1.0570 * cz).max(Vec3::ZERO)
}

/// A body as a point: a Lambert sphere's light at its phase angle α, `E = ⅔·A·(R/d)²·E☉·((π − α) cos α + sin α)/π`.
pub fn body_point(body: &Body) -> Point {
    let d = (body.radius_m + body.camera_altitude_m).max(1.0);
    let cos_phase = body.sun_direction.dot(body.camera_up).clamp(-1.0, 1.0);
    let phase = cos_phase.acos();
    let share = ((PI - phase) * cos_phase + phase.sin()) / PI;
    let ratio = body.radius_m / d;
    let lx = body.albedo * body.sun_illuminance_lx * (2.0 / 3.0 * ratio * ratio * share.max(0.0));
    Point { position_m: body.centre_m.to_array(), illuminance_lx: lx.to_array() }
}

fn points_of(scene: &Snapshot) -> Vec<Point> {
    let tiny = |b: &&Body| matches!(b.surface, Surface::Smooth) && radius_px(scene, b) < POINT_BELOW_PX;
    let mut points: Vec<Point> = scene.bodies.iter().filter(tiny).map(body_point).collect();
    let star = &scene.star;
    let d2 = star.centre_m.length_squared();
    if star.radius_m / d2.max(1.0).sqrt() / scene.camera.pixel_rad() < POINT_BELOW_PX && d2 > 0.0 {
        // A disc that is no bigger than a pixel is hidden by share, not by depth.
        let lx = star.intensity_cd * (sun_disc::free_fraction(scene) / d2);
        points.push(Point { position_m: star.centre_m.to_array(), illuminance_lx: lx.to_array() });
    }
    points
}

/// The pass.
pub struct Stars {
    pipeline: wgpu::RenderPipeline,
    catalogue: List<Point>,
    bodies: List<Point>,
}

impl Stars {
    /// Compiles it; without a catalogue until [`Stars::set_catalogue`].
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/stars.wgsl")?;
        let groups = [&shared.frame_layout];
        let attribute = |offset, shader_location| wgpu::VertexAttribute { format: VertexFormat::Float32x3, offset, shader_location };
        let attributes = [attribute(0, 0), attribute(12, 1)];
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Point>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &attributes,
        })];
        let add = wgpu::BlendComponent { src_factor: wgpu::BlendFactor::One, dst_factor: wgpu::BlendFactor::One, ..Default::default() };
        let pipeline = PipelineKind {
            buffers: &buffers,
            blend: Some(wgpu::BlendState { color: add, alpha: wgpu::BlendComponent::OVER }),
            depth: Some(false),
            ..PipelineKind::opaque("stars", &module, &groups)
        }
        .make(gpu);
        let list = |label, n| List::new(&gpu.device, label, BufferUsages::VERTEX, n);
        Ok(Self { pipeline, catalogue: list("star catalogue", 1), bodies: list("distant bodies", 32) })
    }

    /// Replaces the catalogue.
    pub fn set_catalogue(&mut self, gpu: &Gpu, catalogue: &StarCatalogue) {
        self.catalogue.write(&gpu.device, &gpu.queue, &catalogue.points);
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        (self.catalogue.is_empty() && points_of(scene).is_empty())
            .then(|| "no star catalogue is loaded and no body is a mere point".to_owned())
    }

    /// Adds them to HDR.
    pub fn record(&mut self, f: &mut FrameContext<'_>) {
        self.bodies.write(&f.gpu.device, &f.gpu.queue, &points_of(f.scene));
        let count = |list: &List<Point>| u32::try_from(list.len()).unwrap_or(u32::MAX);
        let mut pass = f.draw_opaque("stars");
        pass.set_pipeline(&self.pipeline);
        for list in [&self.catalogue, &self.bodies] {
            if !list.is_empty() {
                pass.set_vertex_buffer(0, list.buffer.slice(..));
                pass.draw(0..6, 0..count(list));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::exposure::LUMINANCE;

    #[test]
    fn the_catalogue_is_checked() {
        let mut bytes = b"SYZSTAR1".to_vec();
        bytes.extend(1u32.to_le_bytes());
        bytes.extend([0xff, 0x7f, 0, 0, 0, 0, 40, 40]);
        let p = StarCatalogue::parse(&bytes).unwrap().points[0];
        let lx = Vec3::from(p.illuminance_lx).dot(LUMINANCE);
        assert!((lx / LX_AT_MAGNITUDE_0 - 1.0).abs() < 0.01, "V = 0: {lx}");
        assert!(p.position_m[0] > 0.99e18);
        assert!(StarCatalogue::parse(&bytes[..15]).is_err());
        assert!(StarCatalogue::parse(b"SYZ").unwrap_err().to_string().contains("bake.py"));
    }

    #[test]
    fn colours_run_from_blue_to_red() {
        let (rigel, sun, betelgeuse) = (colour_of_b_v(-0.03), colour_of_b_v(0.65), colour_of_b_v(1.85));
        assert!(rigel.z > rigel.x && betelgeuse.x > 3.0 * betelgeuse.z);
        assert!((sun.x / sun.z - 1.0).abs() < 0.45, "{sun}");
    }

    #[test]
    fn venus_is_as_bright_as_in_the_almanac() {
        // Venus at 0.72 AU from the sun, 0.98 AU from the Earth, half phase: V ≈ −4.1 in the almanac;
        // a Lambert sphere is 0.35 fainter at half phase than its clouds are.
        let au = 1.496e11_f32;
        let body = Body {
            id: 2,
            centre_m: Vec3::X * 0.98 * au,
            radius_m: 6.0518e6,
            icrf_from_fixed: glam::Quat::IDENTITY,
            camera_altitude_m: 0.98 * au,
            camera_up: Vec3::NEG_X,
            sun_direction: Vec3::Y,
            sun_angular_radius_rad: 0.006,
            sun_illuminance_lx: Vec3::splat(1.28e5 / 0.72 / 0.72),
            occluders: vec![],
            albedo: Vec3::splat(0.9),
            surface: Surface::Smooth,
            air: None,
        };
        let lx = body_point(&body).illuminance_lx[1];
        let magnitude = -2.5 * (lx / LX_AT_MAGNITUDE_0).log10();
        assert!((-4.1..-3.5).contains(&magnitude), "{magnitude}");
    }
}
