//! Tests: what crosses crates. Here is what they share: a device, and a way to ask WGSL functions for numbers.

pub mod continuity;
pub mod flights;
pub mod sky_eclipse;
pub mod sky_shots;
pub mod sky_truth;

use engine::gpu::{BackendChoice, Gpu, ShaderLibrary, readback};
use std::borrow::Cow;
use wgpu::util::DeviceExt as _;

/// A device without a window (a software one will do).
///
/// # Panics
/// Where there is none: tests of shaders need one.
pub fn gpu() -> Gpu {
    Gpu::headless(BackendChoice::Auto).expect("tests of shaders need a graphics device; mesa-vulkan-drivers brings a software one")
}

/// Asks functions of a shader library for numbers: `main` is WGSL with a compute entry `entry` (64 threads a group) that reads
/// `@group(0) @binding(0) var<storage, read>` (an array of `vec4<f32>`) and writes `@binding(1) var<storage, read_write>` of the
/// same length. `library` is put before it, its includes replaced.
///
/// # Panics
/// Where the shader is not valid or the device fails.
pub fn ask_shader(library: &str, main: &str, entry: &str, questions: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let gpu = gpu();
    let text = ShaderLibrary::checkout().flatten(library).expect("the library is there").text + main;
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(library), source: wgpu::ShaderSource::Wgsl(Cow::Owned(text)) });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: None,
        module: &module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    });
    let contents: &[u8] = bytemuck::cast_slice(questions);
    let buffer = |usage| gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("questions"), contents, usage });
    let given = buffer(wgpu::BufferUsages::STORAGE);
    let found = buffer(wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(entry),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: given.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: found.as_entire_binding() },
        ],
    });
    let mut encoder = gpu.encoder(entry);
    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(u32::try_from(questions.len().div_ceil(64)).expect("a test asks less"), 1, 1);
    drop(pass);
    gpu.submit(encoder);
    assert_eq!(gpu.take_error(), None);
    bytemuck::pod_collect_to_vec(&readback::buffer(&gpu, &found).expect("answers come back"))
}
