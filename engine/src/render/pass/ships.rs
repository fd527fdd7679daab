//! Ships: the hull with its gear, lit by the sun, the host body and its own lamps; flames over it.
//!
//! The shape is in [`super::ship_mesh`]. The same geometry is drawn by the shadow pass.

use super::ship_mesh::{BELLS, HullVertex, REACH_M, hull};
use crate::gpu::buffer::List;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::PipelineKind;
use crate::render::shared::{FrameContext, Shared};
use crate::scene::gpu_data::ShipInstance;
use crate::scene::{Ship, Snapshot};
use glam::Vec3;
use wgpu::BufferUsages;

/// The geometry of all ships of a frame.
pub struct ShipGeometry {
    vertices: List<HullVertex>,
    indices: List<u32>,
    instances: List<ShipInstance>,
    caster: List<ShipInstance>,
}

impl ShipGeometry {
    /// Uploads the hull.
    pub fn new(gpu: &Gpu) -> Self {
        let mesh = hull();
        let mut vertices = List::new(&gpu.device, "hull vertices", BufferUsages::VERTEX, mesh.vertices.len());
        let mut indices = List::new(&gpu.device, "hull indices", BufferUsages::INDEX, mesh.indices.len());
        vertices.write(&gpu.device, &gpu.queue, &mesh.vertices);
        indices.write(&gpu.device, &gpu.queue, &mesh.indices);
        let list = |label, n| List::new(&gpu.device, label, BufferUsages::VERTEX, n);
        Self { vertices, indices, instances: list("ships", 4), caster: list("shadow caster", 1) }
    }

    /// Places this frame's ships; how many there are.
    pub fn place(&mut self, gpu: &Gpu, scene: &Snapshot) -> u32 {
        let all: Vec<ShipInstance> = visible(scene).map(ShipInstance::new).collect();
        self.instances.write(&gpu.device, &gpu.queue, &all);
        u32::try_from(all.len()).unwrap_or(0)
    }

    /// Draws the first `count` ships.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, count: u32) {
        self.draw_from(pass, &self.instances, count);
    }

    /// Places the ship that throws a shadow (it need not be visible: the camera may sit in it).
    pub fn place_caster(&mut self, gpu: &Gpu, ship: &Ship) {
        self.caster.write(&gpu.device, &gpu.queue, &[ShipInstance::new(ship)]);
    }

    /// Draws the ship that throws a shadow.
    pub fn draw_caster(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.draw_from(pass, &self.caster, 1);
    }

    fn draw_from(&self, pass: &mut wgpu::RenderPass<'_>, instances: &List<ShipInstance>, count: u32) {
        pass.set_vertex_buffer(0, self.vertices.buffer.slice(..));
        pass.set_vertex_buffer(1, instances.buffer.slice(..));
        pass.set_index_buffer(self.indices.buffer.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..u32::try_from(self.indices.len()).unwrap_or(0), 0, 0..count);
    }

    /// Attributes of vertices (locations 0 … 2) and of instances (3 … 8).
    pub const ATTRIBUTES: [&'static [wgpu::VertexAttribute]; 2] = [
        &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4],
        &wgpu::vertex_attr_array![3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4],
    ];

    /// Layouts of both vertex buffers.
    pub const fn buffers() -> [Option<wgpu::VertexBufferLayout<'static>>; 2] {
        [
            Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<HullVertex>() as u64,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: Self::ATTRIBUTES[0],
            }),
            Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<ShipInstance>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: Self::ATTRIBUTES[1],
            }),
        ]
    }
}

/// Ships that are drawn: not hidden, more than half a pixel, not wholly behind the camera.
pub fn visible(scene: &Snapshot) -> impl Iterator<Item = &Ship> {
    let forward = scene.camera.view_from_icrf.conjugate() * Vec3::NEG_Z;
    let pixel = scene.camera.pixel_rad();
    scene.ships.iter().filter(move |s| {
        let d = s.centre_m.length();
        !s.hidden && REACH_M > 0.5 * pixel * d && s.centre_m.dot(forward) > -20.0 * REACH_M
    })
}

/// The pass.
pub struct Ships {
    hull: wgpu::RenderPipeline,
    flame: wgpu::RenderPipeline,
}

impl Ships {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared) -> Result<Self, RenderError> {
        let groups = [&shared.frame_layout, &shared.light_layout];
        let module = shaders.load(&gpu.device, "pass/ships.wgsl")?;
        let buffers = ShipGeometry::buffers();
        let hull = PipelineKind { buffers: &buffers, cull: Some(wgpu::Face::Back), ..PipelineKind::opaque("ships", &module, &groups) };
        let module = shaders.load(&gpu.device, "pass/ships_flame.wgsl")?;
        let add = wgpu::BlendComponent { src_factor: wgpu::BlendFactor::One, dst_factor: wgpu::BlendFactor::One, ..Default::default() };
        let instance = wgpu::vertex_attr_array![3 => Float32x4, 4 => Float32x4, 5 => Float32x4, 6 => Float32x4, 7 => Float32x4];
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<ShipInstance>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &instance,
        })];
        let flame = PipelineKind {
            buffers: &buffers,
            blend: Some(wgpu::BlendState { color: add, alpha: wgpu::BlendComponent::OVER }),
            depth: Some(false),
            ..PipelineKind::opaque("flame", &module, &groups)
        };
        Ok(Self { hull: hull.make(gpu), flame: flame.make(gpu) })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        if scene.ships.is_empty() {
            return Some("the scene has no ship".to_owned());
        }
        if scene.ships.iter().all(|s| s.hidden) {
            return Some("the camera sits in the ship: its hull is not drawn".to_owned());
        }
        visible(scene).next().is_none().then(|| "every ship is behind the camera or far under a pixel".to_owned())
    }

    /// Draws hulls, then flames, over HDR and depth; `light` is group 1.
    pub fn record(&self, f: &mut FrameContext<'_>, geometry: &mut ShipGeometry, light: &wgpu::BindGroup) {
        let count = geometry.place(f.gpu, f.scene);
        let burning = visible(f.scene).any(|s| s.throttle > 0.0);
        let mut pass = f.draw_opaque("ships");
        pass.set_bind_group(1, light, &[]);
        pass.set_pipeline(&self.hull);
        geometry.draw(&mut pass, count);
        if burning {
            pass.set_pipeline(&self.flame);
            pass.set_vertex_buffer(0, geometry.instances.buffer.slice(..));
            pass.draw(0..6 * u32::try_from(BELLS.len()).unwrap_or(0), 0..count);
        }
    }
}
