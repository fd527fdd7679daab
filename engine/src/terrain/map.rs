//! Cube maps of a number (heights, distance to the coast): six faces of 16-bit nodes in the parametrisation of
//! [`crate::space::sphere`], so that the node coordinate of a tile's vertex is an exact rational number.
//!
//! Nodes sit on the cells' corners, edges included: a face of `n` cells has `(n + 1)²` nodes, and neighbours share theirs. In
//! memory every level of a mip chain carries [`BORDER`] more nodes around, resampled from the neighbours. Filtering is Catmull–Rom
//! (C¹, through the nodes): on an edge it reads only the edge, so there is no step between faces.
//!
//! # The `.cube` file (little endian)
//! `"SYZCUBE1"`, `u32 n` (a power of two), `f64 scale`, `f64 offset` (value = offset + scale · node), `u64` length of the
//! payload, 32 bytes blake3 of the payload, then the payload: zstd of all low bytes, then all high bytes, of the residuals
//! `node − (left + below − below-left)`, `u16` wrapping, face by face, row by row (v upwards), missing neighbours being 0.
//! `assets/bake/earth.py` writes it. Not here: who decides which map a body has ([`super::spec`]).

use super::relief::ReliefError;
use crate::space::sphere::{FACE_AXES, Face, direction_of, face_of};
use glam::DVec3;

/// Nodes beyond each edge that a level keeps.
pub const BORDER: usize = 2;
const MAGIC: &[u8; 8] = b"SYZCUBE1";
const HEADER: usize = 8 + 4 + 8 + 8 + 8 + 32;

/// One level of the mip chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Mip {
    /// Cells along an edge.
    pub cells: usize,
    /// Nodes, `6 × (cells + 1 + 2 BORDER)²`, face by face, row by row.
    pub nodes: Vec<i16>,
}

/// A number on the whole sphere.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap {
    /// value = offset + scale · node.
    pub scale: f64,
    /// value = offset + scale · node.
    pub offset: f64,
    /// Finest first; each has half the cells of the one before, down to 16.
    pub mips: Vec<Mip>,
    /// blake3 of the payload: the map's identity.
    pub hash: [u8; 32],
}

/// Equirectangular colour, 8-bit sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct ColourMap {
    /// Width, texels; longitude −180° is the left edge.
    pub width: u32,
    /// Height, texels; the north pole is the top edge.
    pub height: u32,
    /// `3 × width × height` bytes.
    pub rgb: Vec<u8>,
}

impl Mip {
    /// Nodes along a row, border included.
    pub fn stride(&self) -> usize {
        self.cells + 1 + 2 * BORDER
    }
    /// Position in `nodes` of node `(x, y)`, each −BORDER … cells + BORDER.
    fn at(&self, face: usize, x: isize, y: isize) -> usize {
        let s = self.stride();
        (face * s + y.saturating_add_unsigned(BORDER).unsigned_abs()) * s + x.saturating_add_unsigned(BORDER).unsigned_abs()
    }
    fn node(&self, face: usize, x: isize, y: isize) -> f64 {
        self.nodes.get(self.at(face, x, y)).map_or(0.0, |v| f64::from(*v))
    }
}

/// Catmull–Rom weights at `t` of nodes −1, 0, 1, 2, and their derivatives.
fn weights(t: f64) -> ([f64; 4], [f64; 4]) {
    let (t2, t3) = (t * t, t * t * t);
    (
        [0.5 * (2.0 * t2 - t - t3), 0.5 * (3.0 * t3 - 5.0 * t2 + 2.0), 0.5 * (4.0 * t2 - 3.0 * t3 + t), 0.5 * (t3 - t2)],
        [0.5 * (4.0 * t - 1.0 - 3.0 * t2), 0.5 * (9.0 * t2 - 10.0 * t), 0.5 * (8.0 * t - 9.0 * t2 + 1.0), 0.5 * (3.0 * t2 - 2.0 * t)],
    )
}

/// 0 within one cell of an edge, 1 from three cells on.
fn inside(cells: f64) -> f64 {
    let t = (0.5 * (cells - 1.0)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[allow(clippy::cast_possible_truncation)]
fn rounded(x: f64) -> i16 {
    libm::round(x).clamp(-32_768.0, 32_767.0) as i16
}

#[allow(clippy::cast_possible_truncation)]
fn floor_index(x: f64) -> isize {
    libm::floor(x) as isize
}

impl CubeMap {
    /// Builds a map from `6 × (n + 1)²` nodes; `n` a power of two from 16 to 4096.
    ///
    /// # Errors
    /// [`ReliefError::Map`] where `n` or the number of nodes is wrong.
    pub fn from_nodes(n: usize, scale: f64, offset: f64, nodes: &[i16], hash: [u8; 32]) -> Result<Self, ReliefError> {
        if !n.is_power_of_two() || !(16..=4096).contains(&n) || nodes.len() != 6 * (n + 1) * (n + 1) {
            return Err(ReliefError::Map(format!(
                "{n} cells with {} nodes: expected a power of two from 16 to 4096, and 6 (n + 1)² nodes",
                nodes.len()
            )));
        }
        if !(scale.is_finite() && offset.is_finite()) {
            return Err(ReliefError::Map("scale or offset is not finite".to_owned()));
        }
        let mut first = Mip { cells: n, nodes: vec![0; 6 * (n + 1 + 2 * BORDER) * (n + 1 + 2 * BORDER)] };
        let mut source = nodes.iter();
        for face in 0..6 {
            for y in 0..=n {
                let row = first.at(face, 0, y.cast_signed());
                for (to, from) in first.nodes.iter_mut().skip(row).take(n + 1).zip(&mut source) {
                    *to = *from;
                }
            }
        }
        share_edges(&mut first);
        fill_border(&mut first);
        let mut mips = vec![first];
        while let Some(last) = mips.last().filter(|m| m.cells > 16) {
            let half = halved(last);
            mips.push(half);
        }
        Ok(Self { scale, offset, mips, hash })
    }

    /// Reads a `.cube` file.
    ///
    /// # Errors
    /// [`ReliefError::Map`] telling what is damaged.
    pub fn read(bytes: &[u8]) -> Result<Self, ReliefError> {
        let damaged = |what: &str| ReliefError::Map(what.to_owned());
        if bytes.len() < HEADER || &bytes[..8] != MAGIC {
            return Err(damaged("not a cube map: it does not begin with SYZCUBE1"));
        }
        let word = |at: usize| bytes.get(at..at + 8).and_then(|b| b.try_into().ok()).map_or(0, u64::from_le_bytes);
        let n = (word(8) & 0xffff_ffff) as usize;
        let (scale, offset) = (f64::from_bits(word(12)), f64::from_bits(word(20)));
        let payload = &bytes[HEADER..];
        if word(28) != payload.len() as u64 {
            return Err(damaged("cut off: the payload is not as long as the header says"));
        }
        if !n.is_power_of_two() || !(16..=4096).contains(&n) {
            return Err(damaged("cells along an edge: expected a power of two from 16 to 4096"));
        }
        let hash = *blake3::hash(payload).as_bytes();
        if hash != bytes[36..68] {
            return Err(damaged("the checksum does not match: the file is damaged"));
        }
        let count = 6 * (n + 1) * (n + 1);
        let raw = zstd::bulk::decompress(payload, 2 * count).map_err(|e| ReliefError::Map(format!("zstd: {e}")))?;
        if raw.len() != 2 * count {
            return Err(damaged("wrong number of nodes in the payload"));
        }
        let (low, high) = raw.split_at(count);
        let mut nodes = vec![0_i16; count];
        let w = n + 1;
        for i in 0..count {
            let (x, y) = (i % w, (i / w) % w);
            let left = if x > 0 { nodes[i - 1] } else { 0 };
            let below = if y > 0 { nodes[i - w] } else { 0 };
            let corner = if x > 0 && y > 0 { nodes[i - w - 1] } else { 0 };
            let residual = i16::from_le_bytes([low[i], high[i]]);
            nodes[i] = residual.wrapping_add(left).wrapping_add(below).wrapping_sub(corner);
        }
        Self::from_nodes(n, scale, offset, &nodes, hash)
    }

    /// Cells along an edge of the finest level.
    pub fn cells(&self) -> usize {
        self.mips.first().map_or(0, |m| m.cells)
    }

    /// The mip that a tile grid with `2^bits` samples along a face's edge reads: the finest that has no more cells than samples.
    pub fn mip_for(&self, bits: u32) -> usize {
        let finest = self.cells().trailing_zeros();
        (finest.saturating_sub(bits) as usize).min(self.mips.len().saturating_sub(1))
    }

    /// Value, and its steepness per cell, at face coordinates `u`, `v` ∈ [−1, 1] (or one cell beyond). On an edge of the cube the
    /// derivative across it is not the same seen from both faces: there the one along it stands for both, so that faces meet.
    pub fn sample(&self, mip: usize, face: Face, u: f64, v: f64) -> (f64, f64) {
        let Some(m) = self.mips.get(mip) else { return (self.offset, 0.0) };
        let n = m.cells as f64;
        let (x, y) = ((u + 1.0) * 0.5 * n, (v + 1.0) * 0.5 * n);
        let limit = m.cells.cast_signed();
        let (i, j) = (floor_index(x).clamp(-1, limit), floor_index(y).clamp(-1, limit));
        let (wx, dx) = weights(x - i as f64);
        let (wy, dy) = weights(y - j as f64);
        let (mut value, mut du, mut dv) = (0.0, 0.0, 0.0);
        for (row, (wy, dy)) in (j - 1..).zip(wy.into_iter().zip(dy)) {
            let start = m.at(usize::from(face), i - 1, row);
            let Some([a, b, c, d]) = m.nodes.get(start..start + 4).and_then(|s| <[i16; 4]>::try_from(s).ok()) else { continue };
            let s = [f64::from(a), f64::from(b), f64::from(c), f64::from(d)];
            let along = s[0] * wx[0] + s[1] * wx[1] + s[2] * wx[2] + s[3] * wx[3];
            value += wy * along;
            dv += dy * along;
            du += wy * (s[0] * dx[0] + s[1] * dx[1] + s[2] * dx[2] + s[3] * dx[3]);
        }
        let (eu, ev) = (inside(x.min(n - x)), inside(y.min(n - y)));
        let steep = eu * (2.0 - ev) * du * du + ev * (2.0 - eu) * dv * dv;
        (self.offset + self.scale * value, self.scale.abs() * steep.sqrt())
    }
}

/// Nodes on an edge belong to two faces, at a corner to three: they all take the value of the face with the lowest number.
/// In whole numbers a node is `right (2x − n) + up (2y − n) + out n`, which finds its twins without rounding.
fn share_edges(m: &mut Mip) {
    let n = m.cells.cast_signed();
    let full = m.cells as f64;
    for (face, [right, up, out]) in FACE_AXES.into_iter().enumerate() {
        for k in 0..=n {
            for (x, y) in [(0, k), (n, k), (k, 0), (k, n)] {
                let p = right * (2 * x - n) as f64 + up * (2 * y - n) as f64 + out * full;
                if let Some(owner) = (0..face).find(|g| p.dot(FACE_AXES[*g][2]) == full) {
                    let [r, u, _] = FACE_AXES[owner];
                    let (ox, oy) = ((floor_index(p.dot(r)) + n) / 2, (floor_index(p.dot(u)) + n) / 2);
                    let (to, from) = (m.at(face, x, y), m.at(owner, ox, oy));
                    m.nodes[to] = m.nodes[from];
                }
            }
        }
    }
}

fn fill_border(m: &mut Mip) {
    let (n, b) = (m.cells.cast_signed(), BORDER.cast_signed());
    let full = m.cells as f64;
    let inside = 0..=n;
    let mut filled = Vec::new();
    for face in 0..6_u8 {
        for y in -b..=n + b {
            for x in -b..=n + b {
                if inside.contains(&x) && inside.contains(&y) {
                    continue;
                }
                let d: DVec3 = direction_of(face, 2.0 * x as f64 / full - 1.0, 2.0 * y as f64 / full - 1.0);
                let (f, u, v) = face_of(d);
                let f = usize::from(f);
                let (px, py) = ((u + 1.0) * 0.5 * full, (v + 1.0) * 0.5 * full);
                let (i, j) = (floor_index(px).clamp(0, n - 1), floor_index(py).clamp(0, n - 1));
                let (s, t) = (px - i as f64, py - j as f64);
                let low = m.node(f, i, j) * (1.0 - s) + m.node(f, i + 1, j) * s;
                let high = m.node(f, i, j + 1) * (1.0 - s) + m.node(f, i + 1, j + 1) * s;
                filled.push((m.at(usize::from(face), x, y), rounded(low * (1.0 - t) + high * t)));
            }
        }
    }
    for (at, value) in filled {
        m.nodes[at] = value;
    }
    // An edge goes on beyond its corners by its own nodes alone: both faces then interpolate the same along it.
    for face in 0..6 {
        for side in [0, n] {
            for k in 1..=b {
                let beyond = |end: isize, next: isize| rounded((1 + k) as f64 * end as f64 - k as f64 * next as f64);
                let value = |x: isize, y: isize| isize::from(m.nodes[m.at(face, x, y)]);
                let line = [
                    (m.at(face, side, -k), beyond(value(side, 0), value(side, 1))),
                    (m.at(face, side, n + k), beyond(value(side, n), value(side, n - 1))),
                    (m.at(face, -k, side), beyond(value(0, side), value(1, side))),
                    (m.at(face, n + k, side), beyond(value(n, side), value(n - 1, side))),
                ];
                for (at, value) in line {
                    m.nodes[at] = value;
                }
            }
        }
    }
}

/// Half the cells, by the 1-2-1 filter along both axes.
fn halved(fine: &Mip) -> Mip {
    let cells = fine.cells / 2;
    let side = cells + 1 + 2 * BORDER;
    let mut m = Mip { cells, nodes: vec![0; 6 * side * side] };
    for face in 0..6 {
        for y in 0..=cells.cast_signed() {
            for x in 0..=cells.cast_signed() {
                let row = |dy: isize| {
                    let at = |dx: isize| fine.node(face, 2 * x + dx, 2 * y + dy);
                    0.25 * at(-1) + 0.5 * at(0) + 0.25 * at(1)
                };
                let to = m.at(face, x, y);
                m.nodes[to] = rounded(0.25 * row(-1) + 0.5 * row(0) + 0.25 * row(1));
            }
        }
    }
    share_edges(&mut m);
    fill_border(&mut m);
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map_of(n: usize, f: impl Fn(DVec3) -> f64) -> CubeMap {
        let mut nodes = Vec::new();
        for face in 0..6_u8 {
            for y in 0..=n {
                for x in 0..=n {
                    nodes.push(rounded(f(direction_of(face, 2.0 * x as f64 / n as f64 - 1.0, 2.0 * y as f64 / n as f64 - 1.0))));
                }
            }
        }
        CubeMap::from_nodes(n, 1.0, 0.0, &nodes, [0; 32]).unwrap()
    }

    #[test]
    fn a_smooth_function_is_kept_everywhere_and_faces_meet() {
        let f = |d: DVec3| 9000.0 * d.x * d.y + 4000.0 * d.z;
        let map = map_of(64, f);
        for i in 0..500 {
            let t = f64::from(i);
            let d = crate::space::sphere::direction_of_lat_lon(libm::asin(libm::sin(t * 0.37)), t * 2.4);
            let (face, u, v) = face_of(d);
            let (value, _) = map.sample(0, face, u, v);
            assert!((value - f(d)).abs() < 2.5, "{value} instead of {} at {d}", f(d));
            let (coarse, _) = map.sample(1, face, u, v);
            assert!((coarse - f(d)).abs() < 25.0, "mip 1: {coarse} instead of {}", f(d));
        }
        for k in 0..=100 {
            let v = f64::from(k) / 50.0 - 1.0;
            for mip in 0..map.mips.len() {
                let ((a, slope_a), (b, slope_b)) = (map.sample(mip, 0, 1.0, v), map.sample(mip, 2, -1.0, v));
                assert!((a - b).abs() < 1e-9 && (slope_a - slope_b).abs() < 1e-9, "a step between faces: {a} {b}, {slope_a} {slope_b}");
            }
        }
    }

    #[test]
    fn a_damaged_file_is_refused_with_a_reason() {
        let told = |b: &[u8]| CubeMap::read(b).unwrap_err().to_string();
        assert!(told(b"PNG").contains("SYZCUBE1"));
        let mut file = b"SYZCUBE1".to_vec();
        file.extend([0; HEADER - 8]);
        assert!(told(&file).contains("power of two"));
        file[8] = 16;
        assert!(told(&file).contains("checksum"));
        file.push(1);
        assert!(told(&file).contains("cut off"));
    }
}
