//! Sky probe: the same tables and the same march as the drawn sky, along given rays instead of pixels. For `probe sky` and tests.

use super::air_tables::AirBaker;
use crate::air::Medium;
use crate::gpu::{Gpu, ShaderLibrary, readback};
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, sampler_entry, texture_entry, uniform_entry};
use bytemuck::{Pod, Zeroable};
use wgpu::util::DeviceExt as _;
use wgpu::{BindingResource, BufferUsages};

/// A ray to probe; `ProbeRay` of `shaders/pass/sky_probe.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ProbeRay {
    /// Unit zenith of the eye, and its altitude, m.
    pub up: [f32; 4],
    /// Unit direction of sight, and 0.
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

/// How to march.
#[derive(Clone, Copy, Debug)]
pub struct ProbeOptions {
    /// Steps.
    pub steps: u32,
    /// Whether orders beyond the first are added.
    pub multiple: bool,
}

/// Marches every ray through `medium`, to the ground or out of the air.
#[allow(clippy::cast_possible_truncation)]
pub fn march(
    gpu: &Gpu,
    shaders: &ShaderLibrary,
    medium: &Medium,
    rays: &[ProbeRay],
    options: ProbeOptions,
) -> Result<Vec<ProbeLight>, RenderError> {
    if rays.is_empty() {
        return Ok(Vec::new());
    }
    let tables = AirBaker::new(gpu, shaders)?.bake_alone(gpu, medium);
    let storage = |binding, read_only| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let array = wgpu::TextureViewDimension::D2Array;
    let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("sky probe"),
        entries: &[
            uniform_entry(0),
            texture_entry(1, array),
            texture_entry(2, array),
            sampler_entry(3, wgpu::SamplerBindingType::Filtering),
            uniform_entry(4),
            storage(5, true),
            storage(6, false),
        ],
    });
    let module = shaders.load(&gpu.device, "pass/sky_probe.wgsl")?;
    let pipeline = compute_pipeline(gpu, "sky_probe", &module, &[&layout], "probe");
    let buffer = |contents: &[u8], usage| {
        gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("sky probe"), contents, usage })
    };
    let wanted = buffer(bytemuck::bytes_of(&[options.steps, u32::from(options.multiple), 0, 0]), BufferUsages::UNIFORM);
    let given = buffer(bytemuck::cast_slice(rays), BufferUsages::STORAGE);
    let empty = vec![ProbeLight::zeroed(); rays.len()];
    let found = buffer(bytemuck::cast_slice(&empty), BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let linear = crate::gpu::texture::linear_sampler(&gpu.device, "sky probe", false);
    let resources = [
        tables.airs.as_entire_binding(),
        BindingResource::TextureView(&tables.transmittance),
        BindingResource::TextureView(&tables.multiple),
        BindingResource::Sampler(&linear),
        wanted.as_entire_binding(),
        given.as_entire_binding(),
        found.as_entire_binding(),
    ];
    let entries: Vec<_> = (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some("sky probe"), layout: &layout, entries: &entries });
    let mut encoder = gpu.encoder("sky probe");
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups((rays.len() as u32).div_ceil(64), 1, 1);
    drop(pass);
    gpu.submit(encoder);
    Ok(bytemuck::pod_collect_to_vec(&readback::buffer(gpu, &found)?))
}
