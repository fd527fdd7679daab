//! The ground under the ship as a collider: a small mesh over the cells of a fixed lattice on the cube sphere.
//!
//! Vertices are points of the *same* surface function that is drawn, computed in f64 and stored as `f32` metres from an anchor
//! at the patch's middle. The lattice does not move with the ship: two patches share their vertices where they overlap, so the
//! ground under a foot is the same before and after re-anchoring (a lattice changes only across an edge of the cube).
//! Water counts as ground at its surface. Not here: level of detail ([`crate::terrain`]), contact forces ([`super::gear`]).

use super::RigidError;
use crate::space::{Anchor, Fixed, Position, Rotation, relative, sphere};
use crate::terrain::Relief;
use glam::{DMat3, DVec3};
use rapier3d::geometry::{Ray, SharedShape};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Cells are at most this wide, m, as those of the finest tiles drawn are …
const CELL_M: f64 = 1.0;
/// … unless a face would need more cells along its edge than this.
const CELLS_MOST: f64 = 67_108_864.0;
/// The ship may be this many cells off a patch's middle.
const STRIDE: f64 = 8.0;

/// The surface of a body: what one stands or splashes on.
pub trait Surface: Sync {
    /// Radius of the datum sphere, m.
    fn radius_m(&self) -> f64;
    /// Height of the surface above the datum, m, in a unit direction of [`Fixed`] axes.
    fn surface_m(&self, direction: DVec3) -> f64;
    /// Distance of a point from the surface along the vertical, m; negative below.
    fn clearance_m(&self, p: DVec3) -> f64 {
        let r = p.length();
        if r <= 0.0 { -self.radius_m() } else { r - self.radius_m() - self.surface_m(p / r) }
    }
}

impl Surface for Relief {
    fn radius_m(&self) -> f64 {
        self.radius_m
    }
    fn surface_m(&self, direction: DVec3) -> f64 {
        Relief::surface_m(self, direction)
    }
}

/// Which cells of the lattice a patch covers: it decides the patch wholly, so a save keeps only this.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PatchKey {
    /// Cube face.
    pub face: u8,
    /// Lattice vertex at the middle, in cells from the face's centre, along u and v.
    pub middle: [i32; 2],
}

/// The lattice of a body: `32 · 2^level` cells along a face's edge, so that a cell is 0.5 … 1 m wide at the face's middle; its
/// vertices are those of the finest tiles drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lattice {
    half_cells: f64,
    cell_m: f64,
}

impl Lattice {
    fn of(radius_m: f64) -> Self {
        let edge_m = core::f64::consts::FRAC_PI_2 * radius_m;
        let mut cells = 32.0;
        while edge_m / cells > CELL_M && cells < CELLS_MOST {
            cells *= 2.0;
        }
        Self { half_cells: 0.5 * cells, cell_m: edge_m / cells }
    }
    fn locate(self, direction: DVec3) -> (u8, f64, f64) {
        let (face, u, v) = sphere::face_of(direction);
        (face, u * self.half_cells, v * self.half_cells)
    }
}

impl PatchKey {
    /// Keeps `held` while the ship is near its middle, else gives the patch centred nearest to it.
    #[allow(clippy::cast_possible_truncation)]
    pub fn for_ship(held: Option<Self>, radius_m: f64, direction: DVec3) -> Self {
        let (face, i, j) = Lattice::of(radius_m).locate(direction);
        if let Some(k) = held
            && k.face == face
            && (i - f64::from(k.middle[0])).abs() <= STRIDE
            && (j - f64::from(k.middle[1])).abs() <= STRIDE
        {
            return k;
        }
        let snap = |x: f64| ((x / STRIDE).round() * STRIDE) as i32;
        Self { face, middle: [snap(i), snap(j)] }
    }
}

/// Where a ray met the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundHit {
    /// Distance along the ray, m.
    pub distance_m: f64,
    /// Upward unit normal of the ground there, [`Fixed`] axes.
    pub normal: DVec3,
}

/// A piece of ground.
#[derive(Clone)]
pub struct Patch {
    /// Which.
    pub key: PatchKey,
    /// Where the mesh's origin rests.
    pub origin: Position<Fixed>,
    /// The mesh's axes: east, up, south.
    pub fixed_from_anchor: Rotation<Fixed, Anchor>,
    /// Highest vertex, as a distance from the body's centre, m.
    pub top_radius_m: f64,
    lattice: Lattice,
    radius_m: f64,
    half: i32,
    heights_m: Vec<f64>,
    shape: SharedShape,
    /// Every second vertex: what the hull feels, which is large and would meet a thousand triangles.
    pub(super) coarse: SharedShape,
}

impl core::fmt::Debug for Patch {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Patch").field("key", &self.key).field("origin", &self.origin).finish_non_exhaustive()
    }
}

impl Patch {
    /// Builds the patch of `key`, wide enough that a ship of bounding radius `reach_m` stays over it while the key is held.
    /// Heights that `old` has are taken from it; they are the same bits.
    pub fn build(surface: &dyn Surface, key: PatchKey, reach_m: f64, old: Option<&Self>) -> Result<Self, RigidError> {
        let radius_m = surface.radius_m();
        let lattice = Lattice::of(radius_m);
        let half = half_cells(reach_m, lattice.cell_m);
        let old = old.filter(|o| o.key.face == key.face);
        let side = 2 * half + 1;
        let direction = |di: i32, dj: i32| {
            let at = |m: i32, d: i32| f64::from(m.saturating_add(d)) / lattice.half_cells;
            sphere::direction_of(key.face.min(5), at(key.middle[0], di), at(key.middle[1], dj))
        };
        let sample = |k: i32| {
            let (di, dj) = (k % side - half, k / side - half);
            let known = old.and_then(|o| o.height_at(key.middle[0].saturating_add(di), key.middle[1].saturating_add(dj)));
            known.unwrap_or_else(|| surface.surface_m(direction(di, dj)))
        };
        // In parallel, but each height is a function of its place alone.
        let heights_m: Vec<f64> = (0..side * side).into_par_iter().map(sample).collect();
        let origin = direction(0, 0) * (radius_m + surface.surface_m(direction(0, 0)));
        let (east, up, north) = sphere::east_up_north(origin.normalize_or(DVec3::Z));
        let fixed_from_anchor = Rotation::from_columns(DMat3::from_cols(east, up, -north));
        let anchor_from_fixed = fixed_from_anchor.inverse();
        let vertex = |(k, height): (i32, &f64)| {
            let p = direction(k % side - half, k / side - half) * (radius_m + height);
            relative::narrow3(anchor_from_fixed.raw(p - origin))
        };
        let vertices: Vec<_> = (0..).zip(&heights_m).map(vertex).collect();
        if !vertices.iter().all(|v| v.is_finite()) {
            return Err(RigidError::Ground { key, why: "a height is not finite".into() });
        }
        let top_radius_m = radius_m + heights_m.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let mesh = |every: i32| {
            SharedShape::trimesh(vertices.clone(), triangles(side, every)).map_err(|e| RigidError::Ground { key, why: e.to_string() })
        };
        let (shape, coarse) = (mesh(1)?, mesh(2)?);
        Ok(Self { key, origin: Position::new(origin), fixed_from_anchor, top_radius_m, lattice, radius_m, half, heights_m, shape, coarse })
    }

    /// Height of a vertex of the lattice, m, if it lies on this patch.
    fn height_at(&self, i: i32, j: i32) -> Option<f64> {
        let (di, dj) = (i.checked_sub(self.key.middle[0])?, j.checked_sub(self.key.middle[1])?);
        if di.abs() > self.half || dj.abs() > self.half {
            return None;
        }
        let index = (dj + self.half) * (2 * self.half + 1) + di + self.half;
        self.heights_m.get(usize::try_from(index).ok()?).copied()
    }

    /// Distance of a point (Fixed axes, m) from the mesh along the vertical, to a hand's breadth (bilinear in the cell); none
    /// off the patch.
    #[allow(clippy::cast_possible_truncation)]
    pub fn clearance_m(&self, p: DVec3) -> Option<f64> {
        let (face, u, v) = self.lattice.locate(p);
        if face != self.key.face {
            return None;
        }
        let (i, j) = (u.floor() as i32, v.floor() as i32);
        let (fu, fv) = (u - u.floor(), v - v.floor());
        let row = |j: i32| Some(self.height_at(i, j)? * (1.0 - fu) + self.height_at(i.checked_add(1)?, j)? * fu);
        let height = row(j)? * (1.0 - fv) + row(j.checked_add(1)?)? * fv;
        Some(p.length() - self.radius_m - height)
    }

    /// Casts a ray from a point (Fixed, m) along a unit direction, up to `reach_m`.
    pub fn cast(&self, from: Position<Fixed>, direction: DVec3, reach_m: f64) -> Option<GroundHit> {
        let to = self.fixed_from_anchor.inverse();
        let ray = Ray::new(relative::narrow3(to.raw((from - self.origin).0)), relative::narrow3(to.raw(direction)));
        let hit = self.shape.cast_local_ray_and_get_normal(&ray, relative::narrow(reach_m), false)?;
        let n = self.fixed_from_anchor.raw(hit.normal.as_dvec3()).normalize_or(-direction);
        let normal = if n.dot(direction) > 0.0 { -n } else { n };
        Some(GroundHit { distance_m: f64::from(hit.time_of_impact), normal })
    }
}

/// Triangles over a square of `side × side` vertices, using every `every`th, wound upwards (u × v points out of the body).
fn triangles(side: i32, every: i32) -> Vec<[u32; 3]> {
    let at = |i: i32, j: i32| u32::try_from(j * side + i).unwrap_or(0);
    let steps = (side - 1) / every;
    let mut out = Vec::new();
    for j in (0..steps).map(|j| j * every) {
        for i in (0..steps).map(|i| i * every) {
            let (k, l) = (i + every, j + every);
            out.push([at(i, j), at(k, j), at(k, l)]);
            out.push([at(i, j), at(k, l), at(i, l)]);
        }
    }
    out
}

/// Cells from the middle to the edge: the ship may be a stride off the middle, and cells shrink to 0.7 towards a cube's edge.
#[allow(clippy::cast_possible_truncation)]
fn half_cells(reach_m: f64, cell_m: f64) -> i32 {
    let cells = STRIDE as i32 + ((reach_m.clamp(1.0, 60.0) + 2.0) / (0.66 * cell_m)).ceil() as i32;
    // Even, so that every second vertex is the same one on every patch.
    cells + cells % 2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::sweep::tests::Hills;

    #[test]
    fn a_ray_meets_the_surface_function_within_the_cell() {
        let hills = Hills::earth();
        for (lat, lon) in [(0.1, 0.2), (1.2, -2.0), (-0.6, 3.0), (1.57, 0.3)] {
            let d = sphere::direction_of_lat_lon(lat, lon);
            let patch = Patch::build(&hills, PatchKey::for_ship(None, hills.radius_m(), d), 12.0, None).unwrap();
            let ground = hills.radius_m() + hills.surface_m(d);
            let hit = patch.cast(Position::new(d * (ground + 20.0)), -d, 100.0).unwrap();
            assert!((hit.distance_m - 20.0).abs() < 5e-3, "{}", hit.distance_m);
            let clearance = patch.clearance_m(d * (ground + 20.0)).unwrap();
            assert!((clearance - 20.0).abs() < 5e-3, "{clearance}");
            assert!(patch.clearance_m((d + DVec3::new(1e-4, -2e-4, 1e-4)) * ground).is_none());
            assert!(hit.normal.dot(d) > 0.8);
        }
    }

    #[test]
    fn neighbouring_patches_are_the_same_ground() {
        let hills = Hills::earth();
        let d = sphere::direction_of_lat_lon(0.7, 0.4);
        let a = PatchKey::for_ship(None, hills.radius_m(), d);
        let b = PatchKey { face: a.face, middle: [a.middle[0] + 8, a.middle[1] - 8] };
        let a = Patch::build(&hills, a, 12.0, None).unwrap();
        let fresh = Patch::build(&hills, b, 12.0, None).unwrap();
        let b = Patch::build(&hills, b, 12.0, Some(&a)).unwrap();
        assert_eq!(fresh.heights_m, b.heights_m, "heights taken over are those that would have been computed");
        let top = hills.radius_m() + hills.surface_m(d) + 5.0;
        for k in 0..20 {
            let at = (d + DVec3::new(0.0, 1e-8, -1.3e-8) * f64::from(k)).normalize();
            let from = Position::new(at * top);
            let (x, y) = (a.cast(from, -at, 50.0).unwrap(), b.cast(from, -at, 50.0).unwrap());
            assert!((x.distance_m - y.distance_m).abs() < 1.5e-5, "{k}: {} {}", x.distance_m, y.distance_m);
        }
    }

    #[test]
    fn a_body_of_any_size_has_metre_cells() {
        for radius in [50.0, 5e3, 6.371e6, 7.1e7] {
            let l = Lattice::of(radius);
            assert!(l.cell_m < 2.0 && (l.cell_m > 0.5 || radius < 100.0), "{radius}: {}", l.cell_m);
        }
    }
}
