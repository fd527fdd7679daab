//! `#[repr(C)]` mirrors of the structs with which terrain is computed and drawn; explained in their WGSL twins. See [`super::gpu_data`].

use super::gpu_data::vec4;
use crate::space::relative::{narrow, narrow3};
use crate::terrain::tile::{Lattice, QUADS, SAMPLES, TileFrame, paint_lattice};
use crate::terrain::{CubeMap, Ground, Relief, TileKey, TileSet};
use bytemuck::{Pod, Zeroable};
use std::sync::Arc;

/// Octaves of all kinds that a body may have.
pub const OCTAVES: usize = 61;
/// Cells of the two lattices of paint, m.
pub const PAINT_M: [f64; 2] = [16.0, 4096.0];

/// `Octave` of `shaders/lib/height.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct OctaveUniform {
    pub cell_m: f32,
    pub weight: f32,
    pub flat_floor: f32,
    pub density: f32,
    pub seed: u32,
    pub pad0: u32,
    pub pad1: u32,
    pub pad2: u32,
}

/// `MapShape` of `shaders/lib/height.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct MapShapeUniform {
    pub bits: u32,
    pub scale: f32,
    pub offset: f32,
    pub pad: u32,
}

/// `ReliefParams` of `shaders/pass/tile_heights.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct ReliefParamsUniform {
    pub counts: [u32; 4],
    pub noise: [f32; 4],
    pub province: [f32; 4],
    pub height_map: MapShapeUniform,
    pub coast_map: MapShapeUniform,
    pub octaves: [OctaveUniform; OCTAVES],
}

/// `TileFrame` of `shaders/lib/tile.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct TileFrameUniform {
    pub centre: [f32; 4],
    pub tangent: [f32; 4],
}

/// `Job` of `shaders/pass/tile_heights.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct JobUniform {
    pub key: [u32; 4],
    pub place: [u32; 4],
    pub frame: TileFrameUniform,
}

/// `Lattice` of `shaders/pass/tile_heights.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct LatticeUniform {
    pub cell: [i32; 3],
    pub fade: f32,
    pub fraction: [f32; 3],
    pub fade_coarse: f32,
}

/// `Tile` of `shaders/pass/terrain.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct TileUniform {
    pub frame: TileFrameUniform,
    pub centre: [f32; 4],
    pub key: [u32; 4],
    pub morph: [f32; 4],
    pub near_cell: [i32; 4],
    pub near_fraction: [f32; 4],
    pub far_cell: [i32; 4],
    pub far_fraction: [f32; 4],
}

/// `Paint` of `shaders/lib/ground.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[allow(missing_docs)]
pub struct PaintUniform {
    pub kind: [u32; 4],
    pub province: [f32; 4],
    pub shifts: [[f32; 4]; 8],
    pub seeds: [[u32; 4]; 2],
}

fn shape(map: &Option<Arc<CubeMap>>) -> MapShapeUniform {
    map.as_ref().map_or_else(MapShapeUniform::default, |m| MapShapeUniform {
        bits: m.cells().trailing_zeros(),
        scale: narrow(m.scale),
        offset: narrow(m.offset),
        pad: 0,
    })
}

fn count<T>(list: &[T]) -> u32 {
    u32::try_from(list.len()).unwrap_or(0)
}

/// Bias of the province noise from the share of low ground, as in [`Relief::terms`].
fn province_bias(relief: &Relief) -> f32 {
    relief.spec().provinces.as_ref().map_or(0.0, |p| narrow((0.5 - p.share) * 0.8))
}

impl ReliefParamsUniform {
    /// The parameters of a body's height function.
    pub fn new(relief: &Relief) -> Self {
        let spec = relief.spec();
        let noise = relief.provinces().iter().chain(relief.noise()).map(|o| OctaveUniform {
            cell_m: narrow(o.cell_m),
            weight: narrow(o.weight),
            seed: o.seed,
            ..OctaveUniform::default()
        });
        let craters = relief.craters().iter().map(|o| OctaveUniform {
            cell_m: narrow(o.cell_m),
            weight: narrow(o.depth_ratio),
            flat_floor: narrow(o.flat),
            density: narrow(o.density),
            seed: o.seed,
            ..OctaveUniform::default()
        });
        let mut octaves = [OctaveUniform::default(); OCTAVES];
        octaves.iter_mut().zip(noise.chain(craters)).for_each(|(to, from)| *to = from);
        let n = spec.noise.as_ref();
        let p = spec.provinces.as_ref();
        Self {
            counts: [
                count(relief.provinces()),
                count(relief.noise()),
                count(relief.craters()),
                u32::from(relief.maps().coast.is_some() && relief.maps().height.is_some()),
            ],
            noise: [
                n.map_or(0.0, |n| narrow(n.amplitude_m)),
                n.map_or(0.0, |n| narrow(n.plain_amplitude_m)),
                n.map_or(0.0, |n| narrow(n.ridged)),
                narrow(relief.spacing_m(0) * f64::from(SAMPLES)),
            ],
            province: [
                p.map_or(0.0, |p| narrow(p.depth_m)),
                province_bias(relief),
                if p.is_some() { 1.0 } else { 0.0 },
                narrow(relief.radius_m),
            ],
            height_map: shape(&relief.maps().height),
            coast_map: shape(&relief.maps().coast),
            octaves,
        }
    }
}

impl TileFrameUniform {
    /// The frame of a tile on a datum of `radius_m`.
    pub fn new(key: TileKey, radius_m: f64) -> Self {
        let f = TileFrame::of(key);
        Self { centre: vec4(f.centre, f.length), tangent: [f.tangent[0], f.tangent[1], f.angle, narrow(radius_m)] }
    }
}

impl JobUniform {
    /// A tile to compute into `slot`; its lattices begin at `first`.
    pub fn new(relief: &Relief, key: TileKey, slot: u32, first: u32) -> Self {
        Self {
            key: [u32::from(key.face), u32::from(key.level), key.x, key.y],
            place: [slot, first, 0, 0],
            frame: TileFrameUniform::new(key, relief.radius_m),
        }
    }
}

impl LatticeUniform {
    /// From its f64 origin.
    pub fn new(l: &Lattice) -> Self {
        Self { cell: l.cell.to_array(), fade: l.fade, fraction: l.fraction.to_array(), fade_coarse: l.fade_coarse }
    }
}

impl TileUniform {
    /// A tile to draw from `slot`.
    pub fn new(set: &TileSet, key: TileKey, slot: u32) -> Self {
        let relief = &set.relief;
        let quad_m = set.edge_m(key.level) / f64::from(QUADS);
        let [start, end] = set.morph_m(key.level);
        let (near, near_f) = paint_lattice(relief, key, PAINT_M[0]);
        let (far, far_f) = paint_lattice(relief, key, PAINT_M[1]);
        Self {
            frame: TileFrameUniform::new(key, relief.radius_m),
            centre: vec4(set.centre_m(key), narrow(quad_m * if key.level < 3 { 0.1 } else { 0.6 })),
            key: [u32::from(key.face), u32::from(key.level), slot, 0],
            morph: [start, end, narrow(set.relief_scale), narrow(relief.spacing_m(key.level))],
            near_cell: near.extend(0).to_array(),
            near_fraction: vec4(near_f, narrow(PAINT_M[0])),
            far_cell: far.extend(0).to_array(),
            far_fraction: vec4(far_f, narrow(PAINT_M[1])),
        }
    }
}

impl PaintUniform {
    /// How a body's ground looks; `mapped` where it has a colour map, `body` its place in the frame's list.
    pub fn new(relief: &Relief, body: u32, mapped: bool) -> Self {
        let kind = match relief.ground() {
            Ground::Rock => 0,
            Ground::Regolith => 1,
            Ground::Living => 2,
            Ground::Ice => 3,
        };
        let p = relief.spec().provinces.as_ref();
        let (mut shifts, mut seeds) = ([[0.0; 4]; 8], [[0; 4]; 2]);
        for (k, o) in relief.provinces().iter().take(8).enumerate() {
            shifts[k] = vec4(narrow3(o.offset), 0.0);
            seeds[k / 4][k % 4] = o.seed;
        }
        let first = relief.provinces().first();
        Self {
            kind: [kind, u32::from(relief.has_water), body, u32::from(mapped)],
            province: [
                first.map_or(0.0, |o| narrow(relief.radius_m / o.cell_m)),
                province_bias(relief),
                p.map_or(1.0, |p| narrow(p.albedo_ratio)),
                relief.provinces().len() as f32,
            ],
            shifts,
            seeds,
        }
    }
}
