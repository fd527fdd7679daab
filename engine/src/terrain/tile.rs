//! Tiles: squares of the cube-sphere quadtree, and the numbers, worked out in f64, with which f32 on the GPU stays exact.
//!
//! # Why f32 is enough
//! A tile is described from its centre `dir₀` (unit, f64 → f32 once). With `a = tan(πu/4)`, `a₀` at the centre and `y = π(u − u₀)/4`,
//! ```text
//! a − a₀ = (1 + a₀²) tan y / (1 − a₀ tan y)                             tangent addition: no cancellation
//! p = right a + up b + out,  d = p − p₀ = right (a − a₀) + up (b − b₀)
//! dir − dir₀ = d/|p| − p₀ (d·(p + p₀)) / (|p| |p₀| (|p| + |p₀|))         from 1/|p| − 1/|p₀|
//! ```
//! so the offset of a vertex from its tile's centre keeps f32's *relative* error (10 µm on a tile of 20 m). Lattice coordinates
//! of the noise get the same treatment: [`Lattice`] holds cell and fraction of the centre, the vertex adds `offset / wavelength`.
//! Positions relative to the camera are `centre − camera` (f64, then f32) plus that offset.
//! Twin: `shaders/lib/tile.wgsl`. Not here: which tiles a camera needs ([`super::quadtree`]).

use super::noise::split;
use super::relief::{CRATER_WAVE, Relief, fade};
use crate::space::relative::{narrow, narrow3};
use crate::space::sphere::{FACE_AXES, Face, direction_of};
use glam::{DVec3, IVec3, Vec3};
use std::sync::Arc;

/// Quads along a tile's edge.
pub const QUADS: u32 = 32;
/// Height samples along a tile's edge, less one.
pub const SAMPLES: u32 = 64;
/// Height samples along a stored row: one more on each side, for normals.
pub const STORED: u32 = SAMPLES + 3;

/// A square of the quadtree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TileKey {
    /// 0: a whole face; each level halves the edge.
    pub level: u8,
    /// Cube face.
    pub face: Face,
    /// Column, 0 … 2^level − 1, along u.
    pub x: u32,
    /// Row, along v.
    pub y: u32,
}

impl TileKey {
    /// The six whole faces.
    pub fn roots() -> [Self; 6] {
        [0, 1, 2, 3, 4, 5].map(|face| Self { face, ..Self::default() })
    }
    /// The four halves of the edge, none beyond level 21.
    pub fn children(self) -> [Self; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| Self { level: self.level + 1, x: 2 * self.x + i, y: 2 * self.y + j, ..self })
    }
    /// The tile that holds this one; a root is its own.
    pub fn parent(self) -> Self {
        if self.level == 0 { self } else { Self { level: self.level - 1, x: self.x / 2, y: self.y / 2, ..self } }
    }
    /// Face coordinates of the centre.
    pub fn centre_uv(self) -> (f64, f64) {
        let size = self.size_uv();
        ((f64::from(self.x) + 0.5) * size - 1.0, (f64::from(self.y) + 0.5) * size - 1.0)
    }
    /// Edge in face coordinates.
    pub fn size_uv(self) -> f64 {
        2.0 / f64::from(1_u32 << self.level.min(31))
    }
    /// Unit direction of the centre, body-fixed.
    pub fn centre(self) -> DVec3 {
        let (u, v) = self.centre_uv();
        direction_of(self.face, u, v)
    }
    /// Unit direction of the sample `(i, j)`, 0 … [`SAMPLES`] (one beyond on each side for the border).
    pub fn sample_direction(self, i: i32, j: i32) -> DVec3 {
        let step = self.size_uv() / f64::from(SAMPLES);
        let at = |first: u32, k: i32| f64::from(first) * self.size_uv() - 1.0 + f64::from(k) * step;
        direction_of(self.face, at(self.x, i), at(self.y, j))
    }
}

/// Cell and fraction of a tile's centre in one octave's lattice, with how much the octave counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    /// Cell of the centre.
    pub cell: IVec3,
    /// Fraction in it.
    pub fraction: Vec3,
    /// Fade at the tile's level.
    pub fade: f32,
    /// Fade at its parent's level.
    pub fade_coarse: f32,
}

/// The frame of a tile in f32.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TileFrame {
    /// tan(πu₀/4), tan(πv₀/4) of the centre.
    pub tangent: [f32; 2],
    /// π/4 times the edge in face coordinates.
    pub angle: f32,
    /// Unit direction of the centre, body-fixed.
    pub centre: Vec3,
    /// |p₀|.
    pub length: f32,
}

impl TileFrame {
    /// The frame of a tile.
    pub fn of(key: TileKey) -> Self {
        let (u, v) = key.centre_uv();
        let quarter = core::f64::consts::FRAC_PI_4;
        let (a, b) = (libm::tan(u * quarter), libm::tan(v * quarter));
        let length = (1.0 + a * a + b * b).sqrt();
        Self {
            tangent: [narrow(a), narrow(b)],
            angle: narrow(quarter * key.size_uv()),
            centre: narrow3(key.centre()),
            length: narrow(length),
        }
    }
}

/// Axes of a face in f32: right, up, out.
pub fn face_axes(face: Face) -> [Vec3; 3] {
    FACE_AXES.get(usize::from(face)).copied().unwrap_or(FACE_AXES[0]).map(narrow3)
}

/// Lattices of a tile: provinces, noise, craters, in this order, each padded by nothing.
pub fn lattices(relief: &Relief, key: TileKey) -> Vec<Lattice> {
    let at = key.centre() * relief.radius_m;
    let (fine, coarse) = (relief.spacing_m(key.level), relief.spacing_m(key.parent().level));
    let lattice = |cell_m: f64, offset: DVec3, wave: f64| {
        let (cell, fraction) = split(at / cell_m + offset);
        Lattice {
            cell,
            fraction: narrow3(fraction),
            fade: narrow(fade(cell_m * wave, fine)),
            fade_coarse: narrow(fade(cell_m * wave, coarse)),
        }
    };
    let noise = relief.provinces().iter().chain(relief.noise()).map(|o| lattice(o.cell_m, o.offset, 1.0));
    noise.chain(relief.craters().iter().map(|o| lattice(o.cell_m, o.offset, CRATER_WAVE))).collect()
}

/// Cell and fraction of a tile's centre in a plain lattice of `cell_m`, for what is only painted on.
pub fn paint_lattice(relief: &Relief, key: TileKey, cell_m: f64) -> (IVec3, Vec3) {
    let (cell, fraction) = split(key.centre() * (relief.radius_m / cell_m));
    (cell, narrow3(fraction))
}

/// The tiles of one body chosen for one camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileSet {
    /// The ground.
    pub relief: Arc<Relief>,
    /// Camera from the body's centre, body-fixed axes, m.
    pub camera_m: DVec3,
    /// Factor on displacement in this frame ([`super::relief_scale`]).
    pub relief_scale: f64,
    /// A tile of level `l` is split nearer than `split_tiles` times its edge.
    pub split_tiles: f64,
    /// Tiles to draw, coarse to fine; none holds another, together they cover what is in view.
    pub tiles: Vec<TileKey>,
}

impl TileSet {
    /// Edge of a tile of `level`, m (at the datum, through a face's middle).
    pub fn edge_m(&self, level: u8) -> f64 {
        self.relief.spacing_m(level) * f64::from(SAMPLES)
    }
    /// Camera-relative centre of a tile on the datum sphere, body-fixed axes, m.
    pub fn centre_m(&self, key: TileKey) -> Vec3 {
        narrow3(key.centre() * self.relief.radius_m - self.camera_m)
    }
    /// Distances between which a tile of `level` turns into its parent, m.
    pub fn morph_m(&self, level: u8) -> [f32; 2] {
        let split = self.split_tiles * self.edge_m(level);
        if level == 0 { [f32::MAX, f32::MAX] } else { [narrow(1.55 * split), narrow(1.95 * split)] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::sphere::face_of;

    #[test]
    fn children_tile_their_parent_and_samples_agree_along_shared_edges() {
        let key = TileKey { level: 7, face: 3, x: 100, y: 17 };
        for child in key.children() {
            assert_eq!(child.parent(), key);
            let (face, u, v) = face_of(child.centre());
            let (cu, cv) = key.centre_uv();
            assert!(face == 3 && (u - cu).abs() < key.size_uv() * 0.3 && (v - cv).abs() < key.size_uv() * 0.3);
        }
        let right = TileKey { x: 101, ..key };
        assert_eq!(key.sample_direction(64, 9), right.sample_direction(0, 9));
        assert_eq!(key.sample_direction(65, 9), right.sample_direction(1, 9));
    }
}
