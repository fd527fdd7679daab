//! Pipelines and bind group layouts in the frame's conventions: shorthand, no policy.

use super::targets::{DEPTH, HDR};
use crate::gpu::Gpu;
use wgpu::ShaderStages;

/// A uniform buffer entry, visible to all stages.
pub const fn uniform_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::all(),
        ty: wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Uniform, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

/// An entry for a texture that compute shaders write.
pub const fn stored_texture_entry(
    binding: u32,
    format: wgpu::TextureFormat,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: wgpu::BindingType::StorageTexture { access: wgpu::StorageTextureAccess::WriteOnly, format, view_dimension },
        count: None,
    }
}

/// An entry for a storage buffer that fragments and compute shaders read.
pub const fn storage_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::FRAGMENT.union(ShaderStages::COMPUTE),
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

/// A storage buffer that compute shaders write.
pub const fn written_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

/// A filterable float texture entry.
pub const fn texture_entry(binding: u32, dimension: wgpu::TextureViewDimension) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::all(),
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: dimension,
            multisampled: false,
        },
        count: None,
    }
}

/// A float texture entry that is loaded, not filtered.
pub const fn loaded_entry(binding: u32, dimension: wgpu::TextureViewDimension) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::all(),
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: dimension,
            multisampled: false,
        },
        count: None,
    }
}

/// A depth texture entry.
pub const fn depth_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::all(),
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    }
}

/// A sampler entry.
pub const fn sampler_entry(binding: u32, kind: wgpu::SamplerBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding, visibility: ShaderStages::all(), ty: wgpu::BindingType::Sampler(kind), count: None }
}

/// A render pipeline in the frame's conventions.
pub struct PipelineKind<'a> {
    /// Name, of shader file and pass.
    pub label: &'a str,
    /// The module; entry points `vertex` and, unless told otherwise, `fragment`.
    pub module: &'a wgpu::ShaderModule,
    /// Bind group layouts from group 0 on.
    pub groups: &'a [&'a wgpu::BindGroupLayout],
    /// Vertex buffers.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Format of the one colour target; `None` for depth only.
    pub colour: Option<wgpu::TextureFormat>,
    /// How it is blended; `None` replaces.
    pub blend: Option<wgpu::BlendState>,
    /// `None`: no depth; `Some(write)`: tested with Greater against the frame's depth and written or not.
    pub depth: Option<bool>,
    /// Faces left out.
    pub cull: Option<wgpu::Face>,
    /// Entry point of the fragment shader.
    pub entry: &'a str,
    /// Entry point of the vertex shader.
    pub vertex: &'a str,
    /// Colour targets, all of one format.
    pub colours: usize,
    /// Values of `override` constants.
    pub constants: &'a [(&'a str, f64)],
    /// What is asked of the stencil, where there is one: see [`Stencil`].
    pub stencil: Option<Stencil>,
}

/// How a draw stands to the stencil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stencil {
    /// Marks what it draws.
    Marks,
    /// Draws what is not marked.
    Unmarked,
}

impl Stencil {
    /// Format of a stencil target, cleared to 0.
    pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Stencil8;

    /// The state; the reference that is set must be 1.
    fn state(self) -> wgpu::DepthStencilState {
        let (compare, pass_op) = match self {
            Self::Marks => (wgpu::CompareFunction::Always, wgpu::StencilOperation::Replace),
            Self::Unmarked => (wgpu::CompareFunction::NotEqual, wgpu::StencilOperation::Keep),
        };
        let face = wgpu::StencilFaceState { compare, pass_op, ..wgpu::StencilFaceState::IGNORE };
        wgpu::DepthStencilState {
            format: Self::FORMAT,
            depth_write_enabled: None,
            depth_compare: None,
            stencil: wgpu::StencilState { front: face, back: face, read_mask: 0xff, write_mask: 0xff },
            bias: wgpu::DepthBiasState::default(),
        }
    }
}

impl<'a> PipelineKind<'a> {
    /// Draws opaque geometry into HDR and depth.
    pub const fn opaque(label: &'a str, module: &'a wgpu::ShaderModule, groups: &'a [&'a wgpu::BindGroupLayout]) -> Self {
        Self {
            label,
            module,
            groups,
            buffers: &[],
            colour: Some(HDR),
            blend: None,
            depth: Some(true),
            cull: None,
            entry: "fragment",
            vertex: "vertex",
            colours: 1,
            constants: &[],
            stencil: None,
        }
    }
    /// Draws one full-screen triangle into a colour target.
    pub const fn full_screen(
        label: &'a str,
        module: &'a wgpu::ShaderModule,
        groups: &'a [&'a wgpu::BindGroupLayout],
        colour: wgpu::TextureFormat,
    ) -> Self {
        Self {
            label,
            module,
            groups,
            buffers: &[],
            colour: Some(colour),
            blend: None,
            depth: None,
            cull: None,
            entry: "fragment",
            vertex: "vertex",
            colours: 1,
            constants: &[],
            stencil: None,
        }
    }
    /// Makes it.
    pub fn make(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let groups: Vec<_> = self.groups.iter().map(|g| Some(*g)).collect();
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let compilation_options = wgpu::PipelineCompilationOptions { constants: self.constants, ..Default::default() };
        let target = self.colour.map(|format| wgpu::ColorTargetState { format, blend: self.blend, write_mask: wgpu::ColorWrites::ALL });
        let targets = vec![target; self.colours];
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(self.vertex),
                compilation_options: compilation_options.clone(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState { cull_mode: self.cull, ..Default::default() },
            depth_stencil: self.stencil.map(Stencil::state).or_else(|| {
                self.depth.map(|write| wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(write),
                    depth_compare: Some(wgpu::CompareFunction::Greater),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                })
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: self.colour.map(|_| wgpu::FragmentState {
                module: self.module,
                entry_point: Some(self.entry),
                compilation_options,
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// A compute pipeline with entry point `entry`.
///
/// Of the uniforms in its layouts only the first three may be asked at fixed places by a condition of a branch or a loop: Mesa 22.3's
/// software driver notes such places in a table that it indexes with the wrong stride (`lvp_inline_uniforms.c`: 32 in place of 4 to a uniform), for later ones
/// beyond the end of the pipeline's memory. What hangs on more is in storage buffers, or found by an index. Held by `tests/tests/shaders.rs`.
pub fn compute_pipeline(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    groups: &[&wgpu::BindGroupLayout],
    entry: &str,
) -> wgpu::ComputePipeline {
    compute_pipeline_with(gpu, label, module, groups, entry, &[])
}

/// The same with values of `override` constants.
pub fn compute_pipeline_with(
    gpu: &Gpu,
    label: &str,
    module: &wgpu::ShaderModule,
    groups: &[&wgpu::BindGroupLayout],
    entry: &str,
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    let groups: Vec<_> = groups.iter().map(|g| Some(*g)).collect();
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    });
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}
