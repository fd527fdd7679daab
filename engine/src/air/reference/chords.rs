//! Optical depths along all straight lines through the air: the walk's own table in f64.
//!
//! A line has an impact parameter b, its least distance from the centre. From there (or from the ground, where b is less than the
//! ground's radius) out to radius r it runs `x = √(r²−b²) − √(max(g²−b², 0))` metres; the table holds the mean extinction
//! `M(b, r)` of that stretch, which is smooth where the depth itself has a root. So `F = M x` is the depth from the lowest point, and
//! the depth between any two points of a line is a difference or a sum of two F.
//!
//! Rows are impact parameters, columns radii; both lie denser where the layers change faster, and no cubic reaches across an
//! altitude where a layer bends or jumps.

use super::space::{Space, exp3};
use crate::air::medium::Profile;
use glam::DVec3;

/// Columns asked for; each stretch between breaks has four or more.
const COLUMNS: f64 = 192.0;
/// Rows of lines that meet the ground.
const INNER: usize = 96;
/// Breaks beyond this number (long tables) are not treated as such.
const MAX_BREAKS: usize = 24;

/// The table.
#[derive(Clone, Debug, Default)]
pub struct Chords {
    ground: f64,
    top: f64,
    /// Radii of the columns, rising from the ground to the top; also the impact parameters of the rows that miss the ground.
    radius: Vec<f64>,
    /// First column of the four that serve the cell above each column.
    first: Vec<usize>,
    /// Radius of the next edge above each column.
    edge: Vec<f64>,
    /// Rows: [`INNER`] by the cosine at the ground, √b rising from 0 (b = ground); then one per radius.
    mean: Vec<DVec3>,
}

/// A line: four rows and their weights.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    rows: [usize; 4],
    weight: [f64; 4],
    b2: f64,
    base: f64,
}

/// A way through the air.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    row: Row,
    /// Signed distance along the line from its lowest point to the start.
    at: f64,
    /// F at the start.
    start: DVec3,
    /// Optical depth to its end.
    pub depth: DVec3,
    /// Whether the ground ends it.
    pub hits_ground: bool,
    /// Its length, m.
    pub length_m: f64,
}

/// A place on a way.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// Distance from the start, m.
    pub distance_m: f64,
    /// Optical depth from the start.
    pub depth: DVec3,
    /// Depth per metre of this cell.
    pub slope: DVec3,
}

fn lagrange(nodes: [f64; 4], x: f64) -> [f64; 4] {
    let [a, b, c, d] = nodes;
    let (xa, xb, xc, xd) = (x - a, x - b, x - c, x - d);
    [
        xb * xc * xd / ((a - b) * (a - c) * (a - d)),
        xa * xc * xd / ((b - a) * (b - c) * (b - d)),
        xa * xb * xd / ((c - a) * (c - b) * (c - d)),
        xa * xb * xc / ((d - a) * (d - b) * (d - c)),
    ]
}

/// Cosine at the ground of an inner row.
fn inner_cosine(i: usize) -> f64 {
    let x = i as f64 / (INNER - 1) as f64;
    x * x
}

/// Where columns lie between two altitudes: quantiles of a density that follows each layer's scale.
fn quantiles(space: &Space, from: f64, to: f64, whole: f64) -> Vec<f64> {
    let rate = |h: f64| {
        let scales = space.optics.iter().filter_map(|o| match o.profile {
            Profile::Exponential { scale_height_m } => Some(2.5 * f64::from(scale_height_m)),
            _ => None,
        });
        let wanted: f64 = scales.map(|s| libm::exp(-(h - space.ground_m + space.datum_m).max(0.0) / s) / s.min(whole)).sum();
        // Lines that pass just under an edge change quickly with their height: ever closer rows towards it.
        let near: f64 = [from, to].iter().map(|edge| 0.5 / ((h - edge).abs().max(1e-7 * whole) * whole).sqrt()).sum();
        1.0 / whole + wanted + near
    };
    let n = 2000;
    let step = (to - from) / f64::from(n);
    let mut sum = vec![0.0];
    for i in 0..n {
        sum.push(sum.last().copied().unwrap_or(0.0) + rate(from + (f64::from(i) + 0.5) * step) * step);
    }
    sum.into_iter().collect()
}

impl Chords {
    /// Fills the table.
    pub fn new(space: &Space) -> Self {
        let (ground, top) = (space.ground_m, space.top_m);
        let (radius, first, edge) = columns(space);
        let mut chords = Self { ground, top, radius, first, edge, mean: Vec::new() };
        let mut rows: Vec<f64> = (0..INNER)
            .map(|i| {
                let mu = inner_cosine(i);
                ground * ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt()
            })
            .collect();
        rows.extend(chords.radius.iter().copied());
        for b in rows {
            let row = chords.fill(space, b);
            chords.mean.extend(row);
        }
        chords
    }

    /// Mean extinctions of one line, by five Gauss points from radius to radius.
    fn fill(&self, space: &Space, b: f64) -> Vec<DVec3> {
        const NODE: [f64; 5] = [-0.906_179_845_938_664, -0.538_469_310_105_683_1, 0.0, 0.538_469_310_105_683_1, 0.906_179_845_938_664];
        const WEIGHT: [f64; 5] = [
            0.236_926_885_056_189_08,
            0.478_628_670_499_366_47,
            0.568_888_888_888_888_9,
            0.478_628_670_499_366_47,
            0.236_926_885_056_189_08,
        ];
        let along = |r: f64| ((r - b) * (r + b)).max(0.0).sqrt();
        let base = along(self.ground);
        let (mut sum, mut last) = (DVec3::ZERO, base);
        let mut out = Vec::with_capacity(self.radius.len());
        for r in &self.radius {
            let s = along(*r);
            let half = 0.5 * (s - last);
            for (node, weight) in NODE.iter().zip(WEIGHT) {
                let t = last + half * (1.0 + node);
                sum += space.extinction((b * b + t * t).sqrt()) * (weight * half);
            }
            last = s;
            // On a short stretch r' − b grows with the square of the way, so that its mean is a third of the end's; carried on below b,
            // where no line runs, it keeps the rows smooth.
            let short = s - base <= 0.0;
            out.push(if short { space.extinction((b + (*r - b) / 3.0).max(self.ground)) } else { sum / (s - base) });
        }
        out
    }

    fn cell(&self, r: f64) -> usize {
        self.radius.partition_point(|x| *x <= r).clamp(1, self.radius.len().max(2) - 1) - 1
    }

    /// The row of an impact parameter.
    fn row(&self, b: f64) -> Row {
        let base = ((self.ground - b) * (self.ground + b)).max(0.0).sqrt();
        if b < self.ground {
            let mu = base / self.ground;
            let at = (mu.sqrt() * (INNER - 1) as f64).floor().min((INNER - 2) as f64);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let first = (at as usize).saturating_sub(1).min(INNER - 4);
            let rows = [first, first + 1, first + 2, first + 3];
            return Row { rows, weight: lagrange(rows.map(inner_cosine), mu), b2: b * b, base };
        }
        let cell = self.cell(b);
        let first = self.first.get(cell).copied().unwrap_or(0);
        let edge = self.edge.get(cell).copied().unwrap_or(self.top);
        // Just below an edge, depths grow with the root of the distance to it.
        let root = |r: f64| (edge - r).max(0.0).sqrt();
        let rows = [0, 1, 2, 3].map(|k| INNER + first + k);
        let node = |k: usize| root(self.radius.get(first + k).copied().unwrap_or(self.top));
        Row { rows, weight: lagrange([node(0), node(1), node(2), node(3)], root(b)), b2: b * b, base: 0.0 }
    }

    fn stencil(&self, r: f64) -> (usize, [f64; 4]) {
        let first = self.first.get(self.cell(r)).copied().unwrap_or(0);
        let node = |k: usize| self.radius.get(first + k).copied().unwrap_or(self.top + k as f64);
        (first, lagrange([node(0), node(1), node(2), node(3)], r))
    }

    fn mean_at(&self, row: &Row, column: usize) -> DVec3 {
        let n = self.radius.len();
        let tap = |k: usize| self.mean.get(row.rows[k] * n + column).copied().unwrap_or(DVec3::ZERO) * row.weight[k];
        tap(0) + tap(1) + tap(2) + tap(3)
    }

    /// F of a line at a radius: F is smooth in the way along the line, or, where a column lies below the line, M in the radius.
    fn depth_at(&self, row: &Row, r: f64) -> DVec3 {
        let s = (r * r - row.b2).max(0.0).sqrt().max(row.base);
        let (first, weight) = self.stencil(r);
        let lowest = self.radius.get(first).copied().unwrap_or(0.0);
        if lowest * lowest > row.b2 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.node(row, first + k));
            let weight = lagrange([a.1, b.1, c.1, d.1], s);
            return (a.0 * weight[0] + b.0 * weight[1] + c.0 * weight[2] + d.0 * weight[3]).max(DVec3::ZERO);
        }
        let mean: DVec3 = (0..4).map(|k| self.mean_at(row, first + k) * weight[k]).sum();
        mean.max(DVec3::ZERO) * (s - row.base)
    }

    /// F of a line at a column, and the way along the line to there.
    fn node(&self, row: &Row, column: usize) -> (DVec3, f64) {
        let r = self.radius.get(column).copied().unwrap_or(self.top);
        let s = (r * r - row.b2).max(0.0).sqrt().max(row.base);
        (self.mean_at(row, column).max(DVec3::ZERO) * (s - row.base), s)
    }

    /// Transmittance from a radius to the top at a cosine to the zenith, ground ignored.
    pub fn transmittance(&self, r: f64, mu: f64) -> DVec3 {
        let r = r.clamp(self.ground, self.top);
        let mut b = r * ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
        if mu < 0.0 {
            b = b.max(self.ground);
        }
        let row = self.row(b);
        let (here, all) = (self.depth_at(&row, r), self.node(&row, self.radius.len() - 1).0);
        exp3(if mu < 0.0 { -(here + all) } else { (here - all).min(DVec3::ZERO) })
    }

    /// The way from a point inside the air along a unit vector.
    pub fn way(&self, from: DVec3, direction: DVec3) -> Way {
        let at = from.dot(direction);
        let r = from.length().clamp(self.ground, self.top);
        let b = from.cross(direction).length().min(r);
        let hits_ground = at < 0.0 && b < self.ground;
        let row = self.row(b);
        let start = self.depth_at(&row, r);
        if hits_ground {
            return Way { row, at, start, depth: start, hits_ground, length_m: (-at - row.base).max(0.0) };
        }
        let (all, end) = self.node(&row, self.radius.len() - 1);
        let depth = if at < 0.0 { start + all } else { (all - start).max(DVec3::ZERO) };
        Way { row, at, start, depth, hits_ground, length_m: (end - at).max(0.0) }
    }

    /// Where a way has gone through `depth` in one channel; its end where that is more than it has.
    pub fn stop(&self, way: &Way, channel: usize, depth: f64) -> Stop {
        let start = way.start[channel];
        let inward = way.at < 0.0 && depth <= start;
        let wanted = if inward {
            start - depth
        } else if way.at < 0.0 {
            depth - start
        } else {
            start + depth
        };
        let (mut low, mut high) = (0, self.radius.len() - 1);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if self.node(&way.row, middle).0[channel] <= wanted { low = middle } else { high = middle }
        }
        let ((f0, s0), (f1, s1)) = (self.node(&way.row, low), self.node(&way.row, high));
        let part = ((wanted - f0[channel]) / (f1[channel] - f0[channel]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        Self::within(way, ((f0, s0), (f1, s1)), part, inward)
    }

    /// Where a way has gone through a distance.
    pub fn stop_at(&self, way: &Way, distance_m: f64) -> Stop {
        let s = way.at + distance_m;
        let low = self.cell((way.row.b2 + s * s).sqrt());
        let ((f0, s0), (f1, s1)) = (self.node(&way.row, low), self.node(&way.row, low + 1));
        let part = ((s.abs() - s0) / (s1 - s0).max(1e-9)).clamp(0.0, 1.0);
        Self::within(way, ((f0, s0), (f1, s1)), part, s < 0.0)
    }

    fn within(way: &Way, ((f0, s0), (f1, s1)): ((DVec3, f64), (DVec3, f64)), part: f64, inward: bool) -> Stop {
        let slope = ((f1 - f0) / (s1 - s0).max(1e-9)).max(DVec3::ZERO);
        let (f, s) = (f0 + (f1 - f0) * part, s0 + (s1 - s0) * part);
        let gone = if inward {
            way.start - f
        } else if way.at < 0.0 {
            way.start + f
        } else {
            f - way.start
        };
        let distance_m = (if inward { -s } else { s } - way.at).clamp(0.0, way.length_m);
        Stop { distance_m, depth: gone.max(DVec3::ZERO), slope }
    }
}

/// Radii of the columns, the stencils of the cells above them and the edges above those.
fn columns(space: &Space) -> (Vec<f64>, Vec<usize>, Vec<f64>) {
    let bottom = space.ground_m - space.datum_m;
    let top = space.top_m - space.datum_m;
    let mut edges = vec![bottom];
    if space.breaks_m.len() <= MAX_BREAKS {
        edges.extend(space.breaks_m.iter().copied().filter(|h| *h > bottom + 1e-3 && *h < top - 1e-3));
    }
    edges.push(top);
    let whole = top - bottom;
    let sums: Vec<Vec<f64>> = edges.windows(2).map(|w| quantiles(space, w[0], w[1], whole)).collect();
    let total: f64 = sums.iter().filter_map(|s| s.last()).sum();
    let (mut radius, mut first, mut edge) = (Vec::new(), Vec::new(), Vec::new());
    for (pair, sum) in edges.windows(2).zip(&sums) {
        let (from, to) = (pair[0], pair[1]);
        let mass = sum.last().copied().unwrap_or(0.0);
        let cells = (COLUMNS * mass / total).ceil().max(4.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = cells as usize;
        let begin = radius.len();
        for i in 0..count {
            let wanted = mass * i as f64 / cells;
            let k = sum.partition_point(|s| *s <= wanted).max(1) - 1;
            let inside = (wanted - sum[k]) / (sum[(k + 1).min(sum.len() - 1)] - sum[k]).max(f64::MIN_POSITIVE);
            radius.push(space.datum_m + from + (to - from) * ((k as f64 + inside.clamp(0.0, 1.0)) / (sum.len() - 1) as f64));
            edge.push(space.datum_m + to);
            first.push((begin + i.saturating_sub(1)).min(begin + count - 3));
        }
    }
    radius.push(space.top_m);
    (radius, first, edge)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::medium::tests::earth;
    use crate::air::reference::single;
    use crate::air::{Layer, Medium, Phase};
    use glam::Vec3;

    fn foggy() -> Medium {
        let mut medium = earth();
        medium.layers.push(Layer {
            scattering_per_m: Vec3::splat(2e-4),
            absorption_per_m: Vec3::ZERO,
            profile: Profile::Constant { bottom_m: 500.0, top_m: 900.0 },
            phase: Phase::Isotropic,
        });
        medium
    }

    #[test]
    fn the_suns_transmittance_is_the_integral() {
        let small = Medium { bottom_radius_m: 5.0e4, top_altitude_m: 2.0e4, ..earth() };
        for (medium, allowed) in [(earth(), 1e-5), (small, 1e-5), (foggy(), 5e-5)] {
            let space = Space::new(&medium, DVec3::Z * medium.bottom_radius_m * 2.0);
            let mut worst = 0.0_f64;
            for part in [0.0, 1e-5, 0.001, 0.012, 0.1, 0.35, 0.7, 0.99, 1.0] {
                let r = medium.bottom_radius_m + part * medium.top_altitude_m;
                let horizon = space.horizon(r);
                for k in 0..80 {
                    let x = f64::from(k) / 79.0;
                    let mu = horizon + (1.0 - horizon) * x * x * x;
                    let truth = single::transmittance_to_top(&medium, r, mu);
                    worst = worst.max((space.chords.transmittance(r, mu) - truth).abs().max_element());
                }
            }
            assert!(worst < allowed, "{worst}");
        }
    }

    #[test]
    fn stops_lie_where_their_depth_is() {
        let medium = earth();
        let space = Space::new(&medium, DVec3::Z * 7e6);
        for (altitude, mu) in [(0.0, 1.0), (0.0, 0.0), (3000.0, -0.01), (3000.0, -0.8), (4.0e4, -0.09), (5.9e4, -0.5), (2.0e4, 0.2)] {
            let from = DVec3::Z * (medium.bottom_radius_m + altitude);
            let direction = DVec3::new((1.0_f64 - mu * mu).sqrt(), 0.0, mu);
            let way = space.chords.way(from, direction);
            let length = |to: f64| single::optical_depth(&medium, from, direction, (0.0, to), 1e-9);
            assert!((way.depth - length(way.length_m)).abs().max_element() < 2e-5, "{altitude} {mu}: {way:?}");
            for part in [0.01, 0.3, 0.7, 0.999] {
                for channel in 0..3 {
                    let stop = space.chords.stop(&way, channel, part * way.depth[channel]);
                    let error = (stop.depth - length(stop.distance_m)).abs() / way.depth;
                    assert!(error.max_element() < 2e-3, "{altitude} {mu} {part}: {error}");
                    assert!((stop.depth[channel] / way.depth[channel] - part).abs() < 1e-3);
                }
            }
        }
    }
}
