//! Tile heights: the height function is run once for every new tile of the terrain, and kept in a slot of a buffer on the GPU.
//! Only new tiles run. What stands in which slot is decided by [`crate::terrain::stream`]; the function is `shaders/lib/height.wgsl`.
//!
//! Not here: how tiles are drawn (`terrain.rs`).

use crate::gpu::buffer::{List, Uniform};
use crate::gpu::texture::Texture;
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::pipeline::{compute_pipeline, uniform_entry};
use crate::scene::gpu_terrain::{JobUniform, LatticeUniform, ReliefParamsUniform};
use crate::terrain::tile::{STORED, lattices};
use crate::terrain::{CubeMap, Relief, TileKey};
use wgpu::{BufferUsages, ShaderStages};

/// Samples of a slot.
pub const SLOT: u64 = (STORED * STORED) as u64;

/// The compute pipeline, and a map for bodies without one.
pub struct TileHeights {
    pipeline: wgpu::ComputePipeline,
    layout: wgpu::BindGroupLayout,
    no_map: wgpu::TextureView,
}

/// What one body's heights are computed from, and the slots they are kept in.
pub struct HeightStore {
    /// `array<vec2<f32>>`: height at the tile's level and at its parent's; [`SLOT`] entries a slot.
    pub heights: wgpu::Buffer,
    params: Uniform<ReliefParamsUniform>,
    height_map: wgpu::TextureView,
    coast_map: wgpu::TextureView,
    jobs: List<JobUniform>,
    lattices: List<LatticeUniform>,
}

const fn storage_entry(binding: u32, read_only: bool) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    }
}

const fn map_entry(binding: u32) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Sint,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        },
        count: None,
    }
}

/// A cube map as a texture of six layers: the finest level at the left, the others beside it, one above the other.
fn upload(gpu: &Gpu, map: Option<&CubeMap>) -> wgpu::TextureView {
    let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
    let side = |m: &crate::terrain::map::Mip| u32::try_from(m.stride()).unwrap_or(0);
    let mips = map.map_or(&[][..], |m| &m.mips[..]);
    let width = mips.iter().take(2).map(side).sum::<u32>().max(1);
    let height = mips.first().map_or(1, side).max(mips.iter().skip(1).map(side).sum::<u32>());
    let texture = Texture::with(&gpu.device, "cube map", [width, height, 6], 1, wgpu::TextureFormat::R16Sint, usage);
    let mut origin = [0, 0];
    for (k, mip) in mips.iter().enumerate() {
        let s = side(mip);
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture.texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x: origin[0], y: origin[1], z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            bytemuck::cast_slice(&mip.nodes),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(2 * s), rows_per_image: Some(s) },
            wgpu::Extent3d { width: s, height: s, depth_or_array_layers: 6 },
        );
        origin = if k == 0 { [s, 0] } else { [origin[0], origin[1] + s] };
    }
    texture.array_view()
}

impl TileHeights {
    /// Compiles it.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/tile_heights.wgsl")?;
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("tile heights"),
            entries: &[
                uniform_entry(0),
                storage_entry(1, true),
                storage_entry(2, true),
                map_entry(3),
                map_entry(4),
                storage_entry(5, false),
            ],
        });
        let pipeline = compute_pipeline(gpu, "tile_heights", &module, &[&layout], "main");
        Ok(Self { pipeline, layout, no_map: upload(gpu, None) })
    }

    /// Room for `slots` tiles of a body.
    pub fn store(&self, gpu: &Gpu, relief: &Relief, slots: u32) -> HeightStore {
        let map = |m: &Option<std::sync::Arc<CubeMap>>| m.as_ref().map_or_else(|| self.no_map.clone(), |m| upload(gpu, Some(m)));
        let params = Uniform::new(&gpu.device, "ReliefParams", BufferUsages::empty());
        params.write(&gpu.queue, &ReliefParamsUniform::new(relief));
        HeightStore {
            heights: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("tile heights"),
                size: SLOT * 8 * u64::from(slots),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            params,
            height_map: map(&relief.maps().height),
            coast_map: map(&relief.maps().coast),
            jobs: List::new(&gpu.device, "tile jobs", BufferUsages::STORAGE, 16),
            lattices: List::new(&gpu.device, "tile lattices", BufferUsages::STORAGE, 512),
        }
    }

    /// Computes the heights of tiles into their slots.
    pub fn record(&self, gpu: &Gpu, pass: &mut wgpu::ComputePass<'_>, store: &mut HeightStore, relief: &Relief, make: &[(TileKey, u32)]) {
        let mut jobs = Vec::with_capacity(make.len());
        let mut all = Vec::new();
        for (key, slot) in make {
            jobs.push(JobUniform::new(relief, *key, *slot, u32::try_from(all.len()).unwrap_or(0)));
            all.extend(lattices(relief, *key).iter().map(LatticeUniform::new));
        }
        if jobs.is_empty() {
            return;
        }
        if all.is_empty() {
            all.push(LatticeUniform::default());
        }
        store.jobs.write(&gpu.device, &gpu.queue, &jobs);
        store.lattices.write(&gpu.device, &gpu.queue, &all);
        let view = wgpu::BindingResource::TextureView;
        let resources = [
            store.params.buffer.as_entire_binding(),
            store.jobs.buffer.as_entire_binding(),
            store.lattices.buffer.as_entire_binding(),
            view(&store.height_map),
            view(&store.coast_map),
            store.heights.as_entire_binding(),
        ];
        let entries: Vec<_> = (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tile heights"),
            layout: &self.layout,
            entries: &entries,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(u32::try_from(SLOT.div_ceil(64)).unwrap_or(0), u32::try_from(jobs.len()).unwrap_or(0), 1);
    }
}
