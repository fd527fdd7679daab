//! Sky probe: any model of air along given rays instead of pixels, by the tables, the painter and the shader function that draw it.
//! For `probe sky`, `bench air` and tests.

use super::air_tables::AirBaker;
use super::eclipse_rings::{self, EclipseRings};
use super::sky::{Painter, Parts, STEPS, painter, picture_layout};
use crate::air::Air;
use crate::air::model::spread::Spread;
use crate::gpu::{Gpu, ShaderLibrary, readback};
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, storage_entry, written_entry};
use crate::render::shared::{AirTables, Mirror, ShadowMap, Shared};
use crate::scene::gpu_data::{BodiesUniform, BodyUniform, FrameUniform, Layers, MAX_OCCLUDERS, SKY_SINGLE, SkyUniform, vec4};
use crate::scene::{Body, Occluder, SecondLight, Star, Surface};
use crate::space::relative::narrow;
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};
use wgpu::util::DeviceExt as _;
use wgpu::{BindGroupEntry, BufferUsages};

/// A ray to probe; `ProbeRay` of `shaders/lib/sky_pixel.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ProbeRay {
    /// Unit zenith of the eye, and its altitude, m.
    pub up: [f32; 4],
    /// Unit direction of sight, and the distance to a surface that ends the ray, m (0: none, the datum ends it).
    pub ray: [f32; 4],
    /// Unit direction to the sun, and its angular radius, rad.
    pub sun: [f32; 4],
}

/// What a ray brings; `ProbeLight` of the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ProbeLight {
    /// Radiance per unit of the sun's illuminance, sr⁻¹ per channel, and 0.
    pub radiance: [f32; 4],
    /// Transmittance of the ray per channel, and 1.
    pub transmittance: [f32; 4],
}

/// How to probe.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeOptions {
    /// Steps of a march through a whole sky, for models that march.
    pub steps: u32,
    /// Whether orders beyond the first are added, for models that tell them apart.
    pub multiple: bool,
    /// What may hide the star: `centre_m` from the body's centre.
    pub occluders: Vec<Occluder>,
    /// Centre (from the body's, m) and radius of the star, for occluders; `None`: at infinity, where each ray has its sun.
    pub star: Option<(Vec3, f32)>,
    /// A second light, its illuminance in units of the sun's.
    pub second: Option<SecondLight>,
}

impl Default for ProbeOptions {
    fn default() -> Self {
        Self { steps: STEPS, multiple: true, occluders: Vec::new(), star: None, second: None }
    }
}

/// What each ray through `air` brings, to the ground or out of the air.
pub fn probe(
    gpu: &Gpu,
    shaders: &ShaderLibrary,
    air: &Air,
    rays: &[ProbeRay],
    options: &ProbeOptions,
) -> Result<Vec<ProbeLight>, RenderError> {
    Prober::new(gpu, shaders, air)?.ask(gpu, rays, options)
}

/// An air with its tables made, to be asked again and again.
pub struct Prober {
    shared: Shared,
    air: Air,
    painter: Box<dyn Painter>,
    tables: AirTables,
    spread: Spread,
    eclipse_rings: EclipseRings,
    /// Groups 1 and 3 are those of the picture; group 2 has the rays.
    light: wgpu::BindGroup,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Prober {
    /// Makes the tables of an air and compiles its model.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, air: &Air) -> Result<Self, RenderError> {
        let shared = Shared::new(gpu);
        let tables = AirBaker::new(gpu, shaders)?.bake_alone(gpu, air);
        let picture = picture_layout(gpu);
        let mut painter = painter(&Parts { gpu, shaders, shared: &shared, picture: &picture }, &air.model)?;
        painter.plan(gpu, &[(ALONE, air)], true);
        let mut encoder = gpu.encoder("sky tables");
        painter.bake(gpu, &mut encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default()));
        gpu.submit(encoder);

        let eclipse_rings = EclipseRings::new(gpu, shaders, &shared)?;
        let light = shared.light_group(gpu, &tables, &tables.media, &eclipse_rings.sheets(), &Mirror::none(gpu), &ShadowMap::none(gpu));
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("group 2: rays"),
            entries: &[storage_entry(2), storage_entry(3), written_entry(4)],
        });
        let kind = painter.kind();
        let module = shaders.load(&gpu.device, kind.file)?;
        let groups = [&shared.frame_layout, &shared.light_layout, &layout, &kind.own_layout];
        let pipeline = compute_pipeline(gpu, "sky_probe", &module, &groups, "probe");
        let spread = Spread::new(&air.medium);
        Ok(Self { shared, air: air.clone(), painter, tables, spread, eclipse_rings, light, layout, pipeline })
    }

    /// What each ray brings. Rays that follow each other under the same sun are asked together where there are occluders.
    pub fn ask(&self, gpu: &Gpu, rays: &[ProbeRay], options: &ProbeOptions) -> Result<Vec<ProbeLight>, RenderError> {
        let apart = !options.occluders.is_empty() && options.star.is_none();
        let runs = rays.chunk_by(|a, b| !apart || a.sun == b.sun);
        let found: Result<Vec<_>, _> = runs.map(|run| self.ask_together(gpu, run, options)).collect();
        Ok(found?.concat())
    }

    /// Makes the surroundings of eclipsed places, and says where they are.
    fn eclipsed(&self, gpu: &Gpu, body: &Body, first: &ProbeRay, options: &ProbeOptions) -> Layers {
        let mut layers = Layers { air: Some(0), ..Layers::default() };
        let [x, y, z, sun_rad] = first.sun;
        let (centre_m, radius_m) = options.star.unwrap_or((Vec3::new(x, y, z) * STAR_FAR_M, sun_rad.sin() * STAR_FAR_M));
        let star = Star { id: 0, centre_m, radius_m, intensity_cd: Vec3::ONE };
        let mut asked = Vec::new();
        eclipse_rings::ask(&mut asked, (0, body), &star, (0, &self.spread), &mut layers);
        if !asked.is_empty() {
            let mut bodies = BodiesUniform::zeroed();
            bodies.list[0] = BodyUniform::new(body, &layers, options.second);
            let mut frame = FrameUniform::zeroed();
            frame.star = vec4(centre_m, radius_m);
            self.shared.bodies.write(&gpu.queue, &bodies);
            self.shared.frame.write(&gpu.queue, &frame);
            let mut encoder = gpu.encoder("eclipse rings");
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            self.eclipse_rings.bake(gpu, &self.shared, &mut pass, &self.tables, &asked);
            drop(pass);
            gpu.submit(encoder);
        }
        layers
    }

    #[allow(clippy::cast_possible_truncation)]
    fn ask_together(&self, gpu: &Gpu, rays: &[ProbeRay], options: &ProbeOptions) -> Result<Vec<ProbeLight>, RenderError> {
        let Some(first) = rays.first() else { return Ok(Vec::new()) };
        let body = alone(&self.air, options);
        let layers = self.eclipsed(gpu, &body, first, options);
        let mut bodies = BodiesUniform::zeroed();
        bodies.list[0] = BodyUniform::new(&body, &layers, options.second);
        self.shared.bodies.write(&gpu.queue, &bodies);
        let mut frame = FrameUniform::zeroed();
        let (centre_m, radius_m) = options.star.unwrap_or((Vec3::Z, 0.0));
        frame.star = vec4(centre_m, radius_m);
        self.shared.frame.write(&gpu.queue, &frame);
        let buffer = |contents: &[u8], usage| {
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("sky probe"), contents, usage })
        };
        let flags = if options.multiple { 0 } else { SKY_SINGLE };
        let sky = SkyUniform { ids: [0, options.steps, flags, 0], settings: self.painter.settings(&body, &self.air) };
        let sky = buffer(bytemuck::bytes_of(&sky), BufferUsages::STORAGE);
        let given = buffer(bytemuck::cast_slice(rays), BufferUsages::STORAGE);
        let empty = vec![ProbeLight::zeroed(); rays.len()];
        let found = buffer(bytemuck::cast_slice(&empty), BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("sky probe"),
            layout: &self.layout,
            entries: &[
                BindGroupEntry { binding: 2, resource: sky.as_entire_binding() },
                BindGroupEntry { binding: 3, resource: given.as_entire_binding() },
                BindGroupEntry { binding: 4, resource: found.as_entire_binding() },
            ],
        });
        let mut encoder = gpu.encoder("sky probe");
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&self.pipeline);
        for (i, group) in (0..).zip([&self.shared.frame_group, &self.light, &group, self.painter.group(body.id)]) {
            pass.set_bind_group(i, group, &[]);
        }
        pass.dispatch_workgroups((rays.len() as u32).div_ceil(64), 1, 1);
        drop(pass);
        gpu.submit(encoder);
        Ok(bytemuck::pod_collect_to_vec(&readback::buffer(gpu, &found)?))
    }
}

/// Where a star is that stands at infinity: so far that the square of the distance is a number yet. As in `sky_probe_star`.
const STAR_FAR_M: f32 = 1e17;
/// Id of the body whose air is probed.
const ALONE: u16 = 0;

/// The body whose air is probed: eye and sun come with each ray.
fn alone(air: &Air, options: &ProbeOptions) -> Body {
    Body {
        id: ALONE,
        centre_m: Vec3::ZERO,
        radius_m: narrow(air.medium.bottom_radius_m),
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: 0.0,
        camera_up: Vec3::Z,
        sun_direction: Vec3::Z,
        sun_angular_radius_rad: 0.0,
        sun_illuminance_lx: Vec3::ONE,
        occluders: options.occluders.iter().take(MAX_OCCLUDERS).copied().collect(),
        albedo: Vec3::ZERO,
        surface: Surface::Smooth,
        air: Some(air.clone()),
    }
}
