//! The ship's shadow: an orthographic depth map fitted around the nearest ship, seen from the sun. Terrain and hull sample it
//! through `ship_shadow` of `shaders/lib/shadow.wgsl`.
//!
//! Not here: shadows of worlds on worlds (`lib/sunlight.wgsl`), nor of mountains.

use super::ship_mesh::REACH_M;
use super::ships::ShipGeometry;
use crate::gpu::buffer::Uniform;
use crate::gpu::texture::Texture;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{PipelineKind, uniform_entry};
use crate::render::shared::{FrameContext, ShadowMap, Shared};
use crate::render::targets::DEPTH;
use crate::scene::gpu_data::ShadowUniform;
use crate::scene::{Ship, Snapshot};
use glam::{Mat4, Vec3};
use wgpu::{BufferUsages, TextureUsages};

/// Width and height of the map, texels: 2 cm each.
const SIZE: u32 = 1024;
/// Height above ground from which the shadow is no longer drawn, m: its penumbra is then wider than the hull.
pub const HIGHEST_M: f32 = 3000.0;

/// The pass.
pub struct ShipShadow {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    depth: Texture,
    uniform: Uniform<ShadowUniform>,
}

impl ShipShadow {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/shadow.wgsl")?;
        let layout =
            gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("shadow"), entries: &[uniform_entry(0)] });
        let uniform = Uniform::new(&gpu.device, "Shadow", BufferUsages::empty());
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shadow"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.buffer.as_entire_binding() }],
        });
        let buffers = ShipGeometry::buffers();
        let groups = [&shared.frame_layout, &layout];
        let pipeline = PipelineKind { buffers: &buffers, colour: None, ..PipelineKind::opaque("shadow", &module, &groups) }.make(gpu);
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let depth = Texture::new(&gpu.device, "ship shadow", [SIZE, SIZE], DEPTH, usage);
        Ok(Self { pipeline, group, depth, uniform })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        match scene.ships.first() {
            None => Some("the scene has no ship".to_owned()),
            Some(ship) if strength(ship) <= 0.0 => Some(format!(
                "the ship is {:.0} km above the ground; its shadow ends at {:.0} km",
                ship.height_above_ground_m / 1000.0,
                HIGHEST_M / 1000.0
            )),
            Some(_) => None,
        }
    }

    /// Draws the map of the nearest ship.
    pub fn record(&self, f: &mut FrameContext<'_>, geometry: &mut ShipGeometry) -> ShadowMap {
        let Some(ship) = f.scene.ships.first() else { return ShadowMap::none(f.gpu) };
        self.uniform.write(&f.gpu.queue, &uniform_of(f.scene, ship));
        geometry.place_caster(f.gpu, ship);
        let mut pass = f.draw_depth("shadow", &self.depth.view);
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, &self.group, &[]);
        geometry.draw_caster(&mut pass);
        drop(pass);
        ShadowMap { depth: self.depth.view.clone(), uniform: self.uniform.buffer.clone() }
    }
}

/// 1 near the ground, smoothly 0 at [`HIGHEST_M`] and above.
fn strength(ship: &Ship) -> f32 {
    let x = ((HIGHEST_M - ship.height_above_ground_m) / (0.4 * HIGHEST_M)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

fn uniform_of(scene: &Snapshot, ship: &Ship) -> ShadowUniform {
    let light = (scene.star.centre_m - ship.centre_m).normalize_or(Vec3::Z);
    let right = light.any_orthonormal_vector();
    let up = light.cross(right);
    let row = |v: Vec3, offset: f32, scale: f32| (v * scale).extend(offset - v.dot(ship.centre_m) * scale);
    // z runs from 0, far from the light, over 0.5 at the ship to 1.
    let scale = 1.0 / REACH_M;
    let rows = [row(right, 0.0, scale), row(up, 0.0, scale), row(light, 0.5, 0.5 * scale), glam::Vec4::W];
    let map_from_icrf = Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    ShadowUniform {
        map_from_icrf: map_from_icrf.to_cols_array_2d(),
        shape: [strength(ship), 1.0 / SIZE as f32, 2.0 * REACH_M, 2.0 * REACH_M],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::{empty_scene, ship_at};

    #[test]
    fn the_map_holds_the_ship_and_depth_grows_towards_the_light() {
        let scene = empty_scene([64, 64]);
        let ship = ship_at(Vec3::new(30.0, -12.0, 5.0), 100.0);
        let u = uniform_of(&scene, &ship);
        let map = Mat4::from_cols_array_2d(&u.map_from_icrf);
        let light = scene.star.centre_m.normalize_or(Vec3::Z);
        let z = |p: Vec3| map.project_point3(p);
        assert!((z(ship.centre_m) - Vec3::new(0.0, 0.0, 0.5)).length() < 1e-5);
        assert!((z(ship.centre_m + light * REACH_M).z - 1.0).abs() < 1e-4);
        assert!(z(ship.centre_m - light * 500.0).z < 0.0, "the ground lies beyond the far side and is clamped there");
        assert!(strength(&ship_at(Vec3::ZERO, HIGHEST_M)) == 0.0 && strength(&ship_at(Vec3::ZERO, 3.0)) == 1.0);
    }
}
