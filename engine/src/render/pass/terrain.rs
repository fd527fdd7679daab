//! Terrain: the tiles of every body that has them, one instance a tile, displaced in the vertex shader (`shaders/pass/terrain.wgsl`).
//!
//! Which tiles a camera needs was decided by [`crate::terrain::select`]; here they are seated in slots ([`crate::terrain::stream`]),
//! new ones are computed (`tile_heights.rs`), and what is resident is drawn. A live frame makes at most [`LIVE_BUDGET`] new tiles,
//! a still all of them.

use super::tile_heights::{HeightStore, SLOT, TileHeights};
use crate::gpu::buffer::{List, Uniform};
use crate::gpu::{Gpu, ShaderLibrary};
use crate::render::RenderError;
use crate::render::maps::{ColourMap, MapSet, MapStore};
use crate::render::pipeline::{PipelineKind, uniform_entry};
use crate::render::shared::{FrameContext, Shared};
use crate::scene::gpu_data::MAX_BODIES;
use crate::scene::gpu_terrain::{PaintUniform, TileUniform};
use crate::scene::{Snapshot, Surface};
use crate::terrain::stream::{Plan, Residency};
use crate::terrain::tile::QUADS;
use crate::terrain::{Relief, TileSet};
use std::collections::BTreeMap;
use std::sync::Arc;
use wgpu::{BufferUsages, ShaderStages};

/// New tiles in a live frame.
pub const LIVE_BUDGET: usize = 32;
/// Slots of the largest store.
const SLOTS_MAX: u32 = 2048;
/// Frames after which the slots of a body out of sight are given up.
const FORGET_AFTER: u64 = 600;

/// The tiles of one body on the GPU.
struct Ground {
    relief: Arc<Relief>,
    residency: Residency,
    store: HeightStore,
    paint: Uniform<PaintUniform>,
    /// The relief's own maps; without them those registered for the body.
    maps: Option<MapSet>,
    tiles: List<TileUniform>,
    plan: Plan,
    used: u64,
}

/// The pass.
pub struct Terrain {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    indices: List<u32>,
    heights: TileHeights,
    grounds: BTreeMap<u16, Ground>,
    clock: u64,
}

impl Terrain {
    /// Compiles both pipelines.
    pub fn new(gpu: &Gpu, shaders: &ShaderLibrary, shared: &Shared, maps: &MapStore) -> Result<Self, RenderError> {
        let module = shaders.load(&gpu.device, "pass/terrain.wgsl")?;
        let storage = |binding, visibility| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: true },
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let both = ShaderStages::VERTEX_FRAGMENT;
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("terrain"),
            entries: &[uniform_entry(0), storage(1, both), storage(2, both)],
        });
        let groups = [&shared.frame_layout, &shared.light_layout, &maps.layout, &layout];
        let pipeline = PipelineKind::opaque("terrain", &module, &groups).make(gpu);
        let grid = grid();
        let mut indices = List::new(&gpu.device, "tile indices", BufferUsages::INDEX, grid.len());
        indices.write(&gpu.device, &gpu.queue, &grid);
        Ok(Self { pipeline, layout, indices, heights: TileHeights::new(gpu, shaders)?, grounds: BTreeMap::new(), clock: 0 })
    }

    /// Why the scene does not need it.
    pub fn skip(&self, scene: &Snapshot) -> Option<String> {
        sets(scene).next().is_none().then(|| "no body in the scene is near enough to show relief".to_owned())
    }

    /// Seats the scene's tiles; why nothing has to be computed for them.
    pub fn plan(&mut self, gpu: &Gpu, scene: &Snapshot, maps: &MapStore) -> Option<String> {
        self.clock += 1;
        let clock = self.clock;
        let budget = if scene.adapt_s.is_some() { LIVE_BUDGET } else { usize::MAX };
        let most = gpu.device.limits().max_storage_buffer_binding_size / (SLOT * 8);
        let most = u32::try_from(most).unwrap_or(SLOTS_MAX).min(SLOTS_MAX);
        let (mut shown, mut new) = (0, 0);
        for (_, id, set) in sets(scene) {
            let want = u32::try_from(set.tiles.len() + set.tiles.len() / 4 + 32).unwrap_or(SLOTS_MAX).next_power_of_two().min(most);
            let fits = |g: &Ground| g.residency.slots() >= want && (Arc::ptr_eq(&g.relief, &set.relief) || g.relief == set.relief);
            if !self.grounds.get(&id).is_some_and(fits) {
                let ground = Ground {
                    relief: Arc::clone(&set.relief),
                    residency: Residency::new(want),
                    store: self.heights.store(gpu, &set.relief, want),
                    maps: own_maps(gpu, maps, &set.relief),
                    paint: Uniform::new(&gpu.device, "Paint", BufferUsages::empty()),
                    tiles: List::new(&gpu.device, "tiles", BufferUsages::STORAGE, 256),
                    plan: Plan::default(),
                    used: clock,
                };
                self.grounds.insert(id, ground);
            }
            if let Some(ground) = self.grounds.get_mut(&id) {
                ground.used = clock;
                ground.plan = ground.residency.plan(&set.tiles, budget);
                shown += ground.plan.draw.len();
                new += ground.plan.make.len();
            }
        }
        self.grounds.retain(|_, g| g.used + FORGET_AFTER >= clock);
        match (shown, new) {
            (0, _) => Some("no tile is in view".to_owned()),
            (n, 0) => Some(format!("all {n} tiles in view are resident")),
            _ => None,
        }
    }

    /// Computes the heights of new tiles.
    pub fn record_heights(&mut self, f: &mut FrameContext<'_>) {
        let gpu = f.gpu;
        let mut pass = f.compute("tile_heights");
        for ground in self.grounds.values_mut().filter(|g| g.used == self.clock) {
            self.heights.record(gpu, &mut pass, &mut ground.store, &ground.relief, &ground.plan.make);
        }
    }

    /// Draws the tiles over HDR and depth; `light` is group 1.
    pub fn record(&mut self, f: &mut FrameContext<'_>, light: &wgpu::BindGroup) {
        let (gpu, scene, maps) = (f.gpu, f.scene, f.maps);
        let mut draws = Vec::new();
        for (place, id, set) in sets(scene) {
            let Some(ground) = self.grounds.get_mut(&id).filter(|g| !g.plan.draw.is_empty()) else { continue };
            let tiles: Vec<_> = ground.plan.draw.iter().map(|(key, slot)| TileUniform::new(set, *key, *slot)).collect();
            ground.tiles.write(&gpu.device, &gpu.queue, &tiles);
            ground
                .paint
                .write(&gpu.queue, &PaintUniform::new(&set.relief, place, ground.maps.as_ref().unwrap_or_else(|| maps.of(id)).has_albedo));
            let resources = [
                ground.paint.buffer.as_entire_binding(),
                ground.tiles.buffer.as_entire_binding(),
                ground.store.heights.as_entire_binding(),
            ];
            let entries: Vec<_> = (0..).zip(resources).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
            let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("terrain"),
                layout: &self.layout,
                entries: &entries,
            });
            draws.push((id, group, u32::try_from(tiles.len()).unwrap_or(0)));
        }
        let mut pass = f.draw_opaque("terrain");
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(1, light, &[]);
        pass.set_index_buffer(self.indices.buffer.slice(..), wgpu::IndexFormat::Uint32);
        for (id, group, count) in &draws {
            let own = self.grounds.get(id).and_then(|g| g.maps.as_ref());
            pass.set_bind_group(2, &own.unwrap_or_else(|| maps.of(*id)).group, &[]);
            pass.set_bind_group(3, group, &[]);
            pass.draw_indexed(0..u32::try_from(self.indices.len()).unwrap_or(0), 0, 0..*count);
        }
    }
}

/// Place in the frame's list, id and tiles of the bodies that have any.
fn sets(scene: &Snapshot) -> impl Iterator<Item = (u32, u16, &TileSet)> {
    (0u32..).zip(scene.bodies.iter().take(MAX_BODIES)).filter_map(|(i, b)| match &b.surface {
        Surface::Tiles(set) if !set.tiles.is_empty() => Some((i, b.id, set)),
        _ => None,
    })
}

/// The colour and the lights of a relief on the GPU, if it has any.
fn own_maps(gpu: &Gpu, maps: &MapStore, relief: &Relief) -> Option<MapSet> {
    let opaque = |m: &Arc<crate::terrain::ColourMap>| ColourMap {
        size: [m.width, m.height],
        rgba: m.rgb.chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect(),
    };
    let most = gpu.device.limits().max_texture_dimension_2d;
    let fits = |m: &&Arc<crate::terrain::ColourMap>| m.width <= most && m.height <= most;
    let colour = relief.maps().colour.as_ref().filter(fits).map(opaque)?;
    let night = relief.maps().night.as_ref().filter(fits).map(opaque);
    Some(maps.make(gpu, Some(&colour), night.as_ref()))
}

/// Triangles of a tile: the grid, its quads cut from lower left to upper right, then the four skirts.
fn grid() -> Vec<u32> {
    let side = QUADS + 1;
    let mut list = Vec::new();
    for y in 0..QUADS {
        for x in 0..QUADS {
            let a = y * side + x;
            list.extend([a, a + 1, a + side + 1, a, a + side + 1, a + side]);
        }
    }
    let on_edge = |edge: u32, k: u32| match edge {
        0 => k,
        1 => k * side + QUADS,
        2 => QUADS * side + k,
        _ => k * side,
    };
    for edge in 0..4 {
        for k in 0..QUADS {
            let (a, b) = (on_edge(edge, k), on_edge(edge, k + 1));
            let (c, d) = (side * side + edge * side + k, side * side + edge * side + k + 1);
            list.extend([a, c, d, a, d, b]);
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_uses_every_vertex() {
        let mut list = grid();
        assert_eq!(list.len() as u32, 6 * (QUADS * QUADS + 4 * QUADS));
        list.sort_unstable();
        list.dedup();
        assert_eq!(list, (0..(QUADS + 1) * (QUADS + 5)).collect::<Vec<_>>());
    }
}
