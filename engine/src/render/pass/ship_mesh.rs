//! The hull, built in code: a torch ship of 15 m by 9 m that stands on three legs. Lofts, turned shapes and plates.
//!
//! Hull axes: +X right, +Y roof, −Z nose; origin at the centre of mass. The feet are those of `assets/ships/torch.toml`.
//! Not here: how it is lit (`ships.rs`, `shaders/pass/ships.wgsl`).

use bytemuck::{Pod, Zeroable};
use core::f32::consts::{PI, TAU};
use glam::{Mat3, Vec3};

/// A vertex of the hull.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct HullVertex {
    /// Position with the gear down, m.
    pub position: [f32; 3],
    /// Index into `MATERIALS` of `shaders/lib/hull.wgsl`.
    pub material: f32,
    /// Outward unit normal.
    pub normal: [f32; 3],
    /// Zero.
    pub pad: f32,
    /// How far the vertex moves when the gear is up, m.
    pub retract: [f32; 3],
    /// Zero.
    pub pad2: f32,
}

/// Materials, in the order of the shader's table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub enum Material {
    Ceramic = 0,
    HeatShield = 1,
    Glass = 2,
    Tank = 3,
    Metal = 4,
    Bell = 5,
    Accent = 6,
    LampRed = 7,
    LampGreen = 8,
    LampWhite = 9,
}

/// Where a flame leaves: the centre of a bell's mouth and its radius, m. Flames point aft (+Z).
pub const BELLS: [(Vec3, f32); 3] =
    [(Vec3::new(0.0, 0.15, 7.5), 0.92), (Vec3::new(-2.15, -0.15, 7.1), 0.62), (Vec3::new(2.15, -0.15, 7.1), 0.62)];
/// Radius of a sphere about the origin that holds the hull, m.
pub const REACH_M: f32 = 9.0;

/// Triangles.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<HullVertex>,
    /// Three to a triangle, counter-clockwise from outside.
    pub indices: Vec<u32>,
}

impl Mesh {
    fn vertex(&mut self, p: Vec3, n: Vec3, m: Material) -> u32 {
        let index = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        self.vertices.push(HullVertex {
            position: p.to_array(),
            material: f32::from(m as u8),
            normal: n.normalize_or(Vec3::Y).to_array(),
            pad: 0.0,
            retract: [0.0; 3],
            pad2: 0.0,
        });
        index
    }

    /// A smooth surface over a grid of points, `rows × columns`, closed along the columns.
    fn grid(&mut self, rows: usize, columns: usize, m: Material, at: impl Fn(usize, usize) -> Vec3) {
        let base = u32::try_from(self.vertices.len()).unwrap_or(u32::MAX);
        for r in 0..rows {
            for c in 0..=columns {
                let around = at(r, (c + 1) % columns) - at(r, (c + columns - 1) % columns);
                let along = at((r + 1).min(rows - 1), c % columns) - at(r.saturating_sub(1), c % columns);
                self.vertex(at(r, c % columns), around.cross(along), m);
            }
        }
        let (rows, stride) = (u32::try_from(rows).unwrap_or(1), u32::try_from(columns + 1).unwrap_or(1));
        for r in 0..rows - 1 {
            for c in 0..stride - 1 {
                let i = base + r * stride + c;
                self.indices.extend([i, i + 1, i + stride, i + 1, i + stride + 1, i + stride]);
            }
        }
    }

    /// A loft along Z: each station is `(z, half width, half height, y of the centre, squareness)`.
    fn loft(&mut self, m: Material, stations: &[[f32; 5]], columns: usize) {
        self.grid(stations.len(), columns, m, |r, c| {
            let [z, w, h, y, square] = stations[r];
            let a = c as f32 / columns as f32 * TAU;
            // Superellipse |x/w|^n + |y/h|^n = 1.
            let e = 2.0 / square;
            let (s, k) = a.sin_cos();
            Vec3::new(w * k.abs().powf(e) * k.signum(), y + h * s.abs().powf(e) * s.signum(), z)
        });
    }

    /// A turned shape: `(distance along the axis, radius)` about the axis from `from` along `axis`.
    fn turned(&mut self, m: Material, from: Vec3, axis: Vec3, profile: &[[f32; 2]], columns: usize) {
        let side = axis.any_orthonormal_vector();
        let other = axis.cross(side);
        self.grid(profile.len(), columns, m, |r, c| {
            let (s, k) = (c as f32 / columns as f32 * TAU).sin_cos();
            from + axis * profile[r][0] + (side * k + other * s) * profile[r][1]
        });
    }

    /// A rod with flat ends.
    fn rod(&mut self, m: Material, a: Vec3, b: Vec3, radius: f32) {
        let l = (b - a).length();
        self.turned(m, a, (b - a).normalize_or(Vec3::Y), &[[0.0, 0.001], [0.0, radius], [l, radius], [l, 0.001]], 12);
    }

    /// A flat convex polygon seen from its normal's side.
    fn polygon(&mut self, m: Material, points: &[Vec3]) {
        let n = (points[1] - points[0]).cross(points[2] - points[0]);
        let base: Vec<u32> = points.iter().map(|p| self.vertex(*p, n, m)).collect();
        for i in 1..base.len() - 1 {
            self.indices.extend([base[0], base[i], base[i + 1]]);
        }
    }

    /// A plate: a convex outline (counter-clockwise from the side of `out`) thickened to both sides, thinner at its rim.
    fn plate(&mut self, top: Material, bottom: Material, outline: &[Vec3], out: Vec3, thickness: f32) {
        let centre = outline.iter().sum::<Vec3>() / outline.len() as f32;
        let lift = out * (0.5 * thickness);
        let inner = |p: Vec3| centre + (p - centre) * 0.86;
        let upper: Vec<Vec3> = outline.iter().map(|p| inner(*p) + lift).collect();
        let lower: Vec<Vec3> = outline.iter().rev().map(|p| inner(*p) - lift).collect();
        self.polygon(top, &upper);
        self.polygon(bottom, &lower);
        for i in 0..outline.len() {
            let j = (i + 1) % outline.len();
            self.polygon(top, &[inner(outline[i]) + lift, outline[i], outline[j], inner(outline[j]) + lift]);
            self.polygon(bottom, &[outline[i], inner(outline[i]) - lift, inner(outline[j]) - lift, outline[j]]);
        }
    }

    fn boxed(&mut self, m: Material, centre: Vec3, half: Vec3) {
        for (axis, sign) in [(0, 1.0_f32), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
            let basis = Mat3::IDENTITY;
            let (n, u) = (basis.col(axis) * sign, basis.col((axis + 1) % 3));
            let v = n.cross(u);
            let corner = |a: f32, b: f32| centre + (n + u * a + v * b) * half;
            self.polygon(m, &[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
        }
    }

    /// Everything added by `add` folds into `hip` when the gear is up.
    fn folding(&mut self, hip: Vec3, add: impl FnOnce(&mut Self)) {
        let first = self.vertices.len();
        add(self);
        for v in &mut self.vertices[first..] {
            v.retract = ((hip - Vec3::from(v.position)) * 0.97).to_array();
        }
    }
}

/// The hull.
pub fn hull() -> Mesh {
    use Material::{Accent, Bell, Ceramic, Glass, HeatShield, LampGreen, LampRed, LampWhite, Metal, Tank};
    let mut m = Mesh::default();
    // Nose cap, then the lifting body.
    let nose: Vec<[f32; 5]> = (0..=6_u8)
        .map(|i| {
            let a = f32::from(i) / 6.0 * 0.5 * PI;
            [-7.5 + 0.75 * (1.0 - a.cos()), 0.02 + 0.72 * a.sin(), 0.02 + 0.52 * a.sin(), -0.42, 2.0]
        })
        .collect();
    m.loft(HeatShield, &nose, 40);
    m.loft(
        Ceramic,
        &[
            [-6.75, 0.74, 0.54, -0.42, 2.0],
            [-6.0, 1.02, 0.74, -0.36, 2.1],
            [-5.0, 1.28, 0.95, -0.26, 2.3],
            [-3.8, 1.48, 1.16, -0.14, 2.5],
            [-2.2, 1.62, 1.33, -0.02, 2.7],
            [0.0, 1.70, 1.42, 0.05, 2.8],
            [2.5, 1.68, 1.40, 0.08, 2.8],
            [4.6, 1.55, 1.30, 0.12, 2.6],
            [5.6, 1.30, 1.12, 0.15, 2.3],
            [5.9, 1.05, 0.98, 0.15, 2.1],
        ],
        48,
    );
    m.turned(Metal, Vec3::new(0.0, 0.15, 5.9), Vec3::NEG_Z, &[[0.0, 1.02], [0.05, 0.6], [0.1, 0.01]], 32);
    // Cockpit.
    m.loft(
        Glass,
        &[
            [-5.75, 0.02, 0.02, 0.28, 2.0],
            [-5.45, 0.46, 0.26, 0.34, 2.0],
            [-4.9, 0.72, 0.46, 0.46, 2.1],
            [-4.1, 0.86, 0.62, 0.58, 2.2],
            [-3.3, 0.86, 0.66, 0.68, 2.3],
            [-2.7, 0.74, 0.60, 0.74, 2.3],
        ],
        32,
    );
    m.loft(
        Ceramic,
        &[
            [-3.3, 0.885, 0.685, 0.68, 2.3],
            [-2.7, 0.80, 0.66, 0.74, 2.4],
            [-1.2, 0.62, 0.56, 0.86, 2.5],
            [1.4, 0.30, 0.34, 1.12, 2.4],
            [3.2, 0.04, 0.05, 1.42, 2.0],
        ],
        32,
    );
    for y in [-0.05_f32, 0.05] {
        m.rod(Ceramic, Vec3::new(y * 9.0, 0.98, -5.05), Vec3::new(y * 15.0, 1.34, -3.2), 0.035);
    }
    for side in [-1.0_f32, 1.0] {
        let x = |v: f32| v * side;
        // Tank with its saddle and straps.
        let tank: Vec<[f32; 2]> =
            vec![[0.0, 0.02], [0.12, 0.36], [0.4, 0.62], [0.8, 0.78], [1.2, 0.82], [5.6, 0.82], [6.0, 0.78], [6.4, 0.62], [6.6, 0.45]];
        m.turned(Tank, Vec3::new(x(2.15), -0.15, -1.2), Vec3::Z, &tank, 32);
        for z in [0.4, 2.2, 4.0] {
            m.turned(Metal, Vec3::new(x(2.15), -0.15, z), Vec3::Z, &[[0.0, 0.82], [0.0, 0.86], [0.16, 0.86], [0.16, 0.82]], 32);
        }
        // Wing, with a heat-resistant underside, and a canted fin.
        let mut wing = vec![
            Vec3::new(x(1.3), -0.62, -1.6),
            Vec3::new(x(4.5), -0.72, 4.3),
            Vec3::new(x(4.5), -0.72, 5.6),
            Vec3::new(x(1.3), -0.62, 5.4),
        ];
        let mut fin =
            vec![Vec3::new(x(2.35), 0.5, 2.6), Vec3::new(x(3.15), 2.55, 5.4), Vec3::new(x(3.15), 2.55, 6.5), Vec3::new(x(2.35), 0.5, 6.1)];
        let mut stripe = vec![
            Vec3::new(x(2.95), 2.03, 4.72),
            Vec3::new(x(3.16), 2.56, 5.38),
            Vec3::new(x(3.16), 2.56, 6.52),
            Vec3::new(x(2.95), 2.03, 6.43),
        ];
        if side > 0.0 {
            // Mirrored outlines run the other way round.
            wing.reverse();
            fin.reverse();
            stripe.reverse();
        }
        let out = Vec3::new(x(0.93), -0.36, 0.0);
        m.plate(Ceramic, HeatShield, &wing, Vec3::Y, 0.24);
        m.plate(Ceramic, Ceramic, &fin, out, 0.2);
        m.plate(Accent, Accent, &stripe, out, 0.23);
        // RCS quads fore and aft, lamps at the wing tips.
        for z in [-5.1, 4.9] {
            let c = Vec3::new(x(if z < 0.0 { 1.26 } else { 1.9 }), if z < 0.0 { -0.05 } else { 0.75 }, z);
            m.boxed(Metal, c, Vec3::new(0.12, 0.16, 0.2));
            m.rod(Bell, c, c + Vec3::new(x(0.24), 0.0, 0.0), 0.08);
            m.rod(Bell, c, c + Vec3::new(0.0, 0.28, 0.0), 0.08);
        }
        m.boxed(if side < 0.0 { LampRed } else { LampGreen }, Vec3::new(x(4.5), -0.72, 4.95), Vec3::new(0.07, 0.07, 0.22));
    }
    m.boxed(LampWhite, Vec3::new(0.0, 1.52, 3.6), Vec3::new(0.06, 0.06, 0.1));
    // A spine of conduits and a dorsal antenna.
    for x in [-0.5_f32, 0.5] {
        m.rod(Metal, Vec3::new(x, 1.44, -0.6), Vec3::new(x, 1.38, 5.0), 0.07);
    }
    m.rod(Metal, Vec3::new(0.0, 1.3, 1.9), Vec3::new(0.0, 2.3, 2.3), 0.03);
    // Bells: throat to mouth outside, and back inside.
    for (mouth, radius) in BELLS {
        let l = 1.75 * radius;
        let bell = |t: f32| [l * t, radius * (0.34 + 0.66 * t.powf(0.62))];
        let mut profile: Vec<[f32; 2]> = (0..=12_u8).map(|i| bell(f32::from(i) / 12.0)).collect();
        profile.extend((0..=12_u8).rev().map(|i| {
            let [z, r] = bell(f32::from(i) / 12.0);
            [z.max(0.02), r - 0.04]
        }));
        profile.push([0.02, 0.01]);
        m.turned(Bell, mouth - Vec3::Z * l, Vec3::Z, &profile, 40);
        m.turned(Metal, mouth - Vec3::Z * (l + 0.3), Vec3::Z, &[[0.0, 0.3 * radius], [0.1, 0.52 * radius], [0.3, 0.42 * radius]], 24);
    }
    // Legs: strut, brace, foot.
    for foot in [Vec3::new(0.0, -3.4, -5.2), Vec3::new(-3.6, -3.4, 3.6), Vec3::new(3.6, -3.4, 3.6)] {
        let hip = Vec3::new(foot.x * 0.55, -0.75, foot.z * 0.86);
        m.folding(hip, |m| {
            let knee = hip.lerp(foot, 0.5);
            m.rod(Metal, hip, knee, 0.17);
            m.rod(Tank, knee, foot, 0.11);
            let inward = Vec3::new(foot.x * 0.3, -0.8, foot.z * 0.62);
            m.rod(Metal, inward, hip.lerp(foot, 0.62), 0.07);
            m.turned(Metal, foot, Vec3::Y, &[[0.0, 0.01], [0.0, 0.52], [0.07, 0.5], [0.2, 0.16], [0.3, 0.02]], 20);
        });
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_point_out_and_everything_is_within_reach() {
        let mesh = hull();
        let mut wrong = 0;
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| mesh.vertices[i as usize]);
            let p = |v: HullVertex| Vec3::from(v.position);
            let face = (p(b) - p(a)).cross(p(c) - p(a));
            let shade = Vec3::from(a.normal) + Vec3::from(b.normal) + Vec3::from(c.normal);
            wrong += usize::from(face.dot(shade) < -1e-4);
        }
        assert!(wrong * 200 < mesh.indices.len() / 3, "{wrong} of {} triangles face away from their normals", mesh.indices.len() / 3);
        assert!(mesh.vertices.iter().all(|v| Vec3::from(v.position).length() < REACH_M && Vec3::from(v.normal).is_normalized()));
        // The middle of the body faces outward: a vertex well to the right has a normal to the right.
        let right = mesh.vertices.iter().filter(|v| v.material < 0.5 && v.position[0] > 1.6 && v.position[2].abs() < 1.0);
        assert!(right.clone().count() > 0 && right.clone().all(|v| v.normal[0] > 0.0));
    }

    #[test]
    fn the_feet_fold_into_the_hull() {
        let mesh = hull();
        let lowest = |gear: f32| mesh.vertices.iter().map(|v| v.position[1] + v.retract[1] * (1.0 - gear)).fold(f32::INFINITY, f32::min);
        assert!((lowest(1.0) + 3.4).abs() < 0.1 && lowest(0.0) > -1.4);
    }
}
