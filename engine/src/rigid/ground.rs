//! The ground under the ship as a collider: a small mesh over the cells of a fixed lattice on the cube sphere.
//!
//! Vertices are points of the *same* surface function that is drawn, computed in f64 and stored as `f32` metres from an anchor
//! at the patch's middle. The lattice does not move with the ship: two patches share their vertices where they overlap, so the
//! ground under a foot is the same before and after re-anchoring (a lattice changes only across an edge of the cube).
//! Water counts as ground at its surface. Not here: level of detail ([`crate::terrain`]), contact forces ([`super::gear`]).

use super::RigidError;
use crate::space::{Anchor, Fixed, Position, Rotation, relative, sphere};
use crate::terrain::Relief;
use glam::{DMat3, DVec3, Vec3};
use rapier3d::geometry::{Ray, SharedShape, TriMeshFlags};
use serde::{Deserialize, Serialize};

/// The finest cells are at least this wide, m.
const CELL_M: f64 = 0.75;

/// The surface of a body: what one stands or splashes on.
pub trait Surface {
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

/// The lattice of a body: `2^level` cells along a face's edge, so that a cell is 0.75 … 1.5 m wide at the face's middle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Lattice {
    half_cells: f64,
    cell_m: f64,
}

impl Lattice {
    fn of(radius_m: f64) -> Self {
        let edge_m = core::f64::consts::FRAC_PI_2 * radius_m;
        let mut half_cells = 4.0;
        while edge_m / (4.0 * half_cells) >= CELL_M && half_cells < 536_870_912.0 {
            half_cells *= 2.0;
        }
        Self { half_cells, cell_m: edge_m / (2.0 * half_cells) }
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
        const STRIDE: f64 = 8.0;
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
    pub(super) shape: SharedShape,
}

impl core::fmt::Debug for Patch {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Patch").field("key", &self.key).field("origin", &self.origin).finish_non_exhaustive()
    }
}

impl Patch {
    /// Builds the patch of `key`, wide enough that a ship of bounding radius `reach_m` stays over it while the key is held.
    pub fn build(surface: &dyn Surface, key: PatchKey, reach_m: f64) -> Result<Self, RigidError> {
        let lattice = Lattice::of(surface.radius_m());
        let half = half_cells(reach_m, lattice.cell_m);
        let point = |di: i32, dj: i32| {
            let u = f64::from(key.middle[0] + di) / lattice.half_cells;
            let v = f64::from(key.middle[1] + dj) / lattice.half_cells;
            let d = sphere::direction_of(key.face.min(5), u, v);
            d * (surface.radius_m() + surface.surface_m(d))
        };
        let origin = point(0, 0);
        let (east, up, north) = sphere::east_up_north(origin.normalize_or(DVec3::Z));
        let fixed_from_anchor = Rotation::from_columns(DMat3::from_cols(east, up, -north));
        let anchor_from_fixed = fixed_from_anchor.inverse();
        let side = 2 * half + 1;
        let mut vertices = Vec::new();
        let mut top_radius_m: f64 = 0.0;
        for dj in -half..=half {
            for di in -half..=half {
                let p = point(di, dj);
                top_radius_m = top_radius_m.max(p.length());
                vertices.push(relative::narrow3(anchor_from_fixed.raw(p - origin)));
            }
        }
        let mut indices = Vec::new();
        let at = |i: i32, j: i32| u32::try_from(j * side + i).unwrap_or(0);
        for j in 0..side - 1 {
            for i in 0..side - 1 {
                // u × v points out of the body, so these wind upwards.
                indices.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                indices.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        if !vertices.iter().all(|v: &Vec3| v.is_finite()) {
            return Err(RigidError::Ground { key, why: "a height is not finite".into() });
        }
        let shape = SharedShape::trimesh_with_flags(vertices, indices, TriMeshFlags::FIX_INTERNAL_EDGES)
            .map_err(|e| RigidError::Ground { key, why: e.to_string() })?;
        Ok(Self { key, origin: Position::new(origin), fixed_from_anchor, top_radius_m, shape })
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

/// Cells from the middle to the edge: the ship may be 8 cells off the middle, and cells shrink to 0.7 towards a cube's edge.
#[allow(clippy::cast_possible_truncation)]
fn half_cells(reach_m: f64, cell_m: f64) -> i32 {
    8 + ((reach_m.clamp(1.0, 60.0) + 2.0) / (0.66 * cell_m)).ceil() as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::sweep::tests::Hills;

    #[test]
    fn a_ray_meets_the_surface_function_within_the_cell() {
        let hills = Hills::earth();
        for (lat, lon) in [(0.1, 0.2), (1.2, -2.0), (-0.6, 3.0), (1.570_7, 0.3)] {
            let d = sphere::direction_of_lat_lon(lat, lon);
            let patch = Patch::build(&hills, PatchKey::for_ship(None, hills.radius_m(), d), 12.0).unwrap();
            let ground = hills.radius_m() + hills.surface_m(d);
            let hit = patch.cast(Position::new(d * (ground + 20.0)), -d, 100.0).unwrap();
            assert!((hit.distance_m - 20.0).abs() < 5e-3, "{}", hit.distance_m);
            assert!(hit.normal.dot(d) > 0.8);
        }
    }

    #[test]
    fn neighbouring_patches_are_the_same_ground() {
        let hills = Hills::earth();
        let d = sphere::direction_of_lat_lon(0.7, 0.4);
        let a = PatchKey::for_ship(None, hills.radius_m(), d);
        let b = PatchKey { face: a.face, middle: [a.middle[0] + 8, a.middle[1] - 8] };
        let (a, b) = (Patch::build(&hills, a, 12.0).unwrap(), Patch::build(&hills, b, 12.0).unwrap());
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
            assert!(l.cell_m < 10.0 && (l.cell_m >= 0.75 || radius < 100.0), "{radius}: {}", l.cell_m);
        }
    }
}
