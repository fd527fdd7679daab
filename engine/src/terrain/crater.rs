//! Impact craters: one octave is a lattice whose cells near the sphere may hold one crater each.
//!
//! A cell's jittered point `q` is projected on the sphere; it is used only where it lies within [`SLAB`] cells of it, fading out
//! towards that bound, so that nothing toggles by rounding. A crater reaches [`REACH`] cells at most, and
//! `REACH² + SLAB² ≤ 0.5²`: the 2 × 2 × 2 cells around a point therefore hold every crater that touches it.
//! Written relative to a centre on the sphere so that f32 keeps it exact on the GPU (twin: `crater_octave` in
//! `shaders/lib/height.wgsl`). Profile: a paraboloid for simple craters, a flat floor for complex ones, a raised rim and a falling
//! blanket to 1.6 radii [Pike 1977, "Size-dependence in the shape of fresh impact craters on the moon"].
//! Not here: how octaves are chosen ([`super::relief`]).

use super::noise::{hash, mix32, unit16};
use glam::{DVec3, IVec3};

/// Half-thickness of the shell of cells that count, cells.
pub const SLAB: f64 = 0.3;
/// Where the fading towards [`SLAB`] begins, cells.
pub const SLAB_FADE: f64 = 0.2;
/// Largest crater radius, cells.
pub const RADIUS_MAX: f64 = 0.25;
/// Smallest crater radius, cells.
pub const RADIUS_MIN: f64 = 0.11;
/// Reach of a crater's blanket, in its radii.
pub const BLANKET: f64 = 1.6;
/// Reach of a crater, cells.
pub const REACH: f64 = BLANKET * RADIUS_MAX;

/// One octave of craters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CraterOctave {
    /// Edge of a cell, m.
    pub cell_m: f64,
    /// Depth over diameter.
    pub depth_ratio: f64,
    /// 0: bowl, 1: flat floor.
    pub flat: f64,
    /// Share of cells that hold a crater.
    pub density: f64,
    /// Seed of the hash.
    pub seed: u32,
    /// Shift of the lattice, cells.
    pub offset: DVec3,
}

fn smooth(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Height of a crater's profile in units of its depth, at `t` radii from its centre.
pub fn profile(t: f64, flat: f64) -> f64 {
    if t >= BLANKET {
        return 0.0;
    }
    if t >= 1.0 {
        let s = (BLANKET - t) / (BLANKET - 1.0);
        return 0.22 * s * s * s;
    }
    let t2 = t * t;
    let bowl = t2 - 1.0;
    let floor = smooth(0.45, 1.0, t) - 1.0;
    bowl + flat * (floor - bowl) + 0.22 * t2 * t2
}

/// Height, m, that an octave adds at `at`, given as lattice cell and fraction; `up` is the unit direction there.
pub fn crater_octave(o: &CraterOctave, radius_m: f64, cell: IVec3, fraction: DVec3, up: DVec3) -> f64 {
    let inverse_radius = o.cell_m / radius_m;
    let half = |f: f64| if f < 0.5 { -1 } else { 0 };
    let first = IVec3::new(half(fraction.x), half(fraction.y), half(fraction.z));
    let mut height = 0.0;
    for k in 0..8 {
        let step = first + IVec3::new(k & 1, (k >> 1) & 1, k >> 2);
        let c = cell + step;
        let h = hash(c.x, c.y, c.z, o.seed);
        if unit16(h) >= o.density {
            continue;
        }
        let (h2, h3) = (mix32(h ^ 0x9e37_79b9), mix32(h ^ 0x7f4a_7c15));
        let jitter = DVec3::new(unit16(h >> 16), unit16(h2), unit16(h2 >> 16));
        // r: from the sample to the cell's point, in cells. e: the point's height above the sphere.
        let r = step.as_dvec3() + jitter - fraction;
        let along = r.dot(up);
        let lift = (along + 0.5 * r.length_squared() * inverse_radius) * inverse_radius;
        let root = (1.0 + 2.0 * lift).max(0.0).sqrt();
        let e = 2.0 * lift / (inverse_radius * (1.0 + root));
        if e.abs() >= SLAB {
            continue;
        }
        let to_centre = r - (up + r * inverse_radius) * (e / root.max(1e-6));
        let size = unit16(h3);
        let radius = RADIUS_MIN + (RADIUS_MAX - RADIUS_MIN) * size * size;
        let t = to_centre.length() / radius;
        if t >= BLANKET {
            continue;
        }
        let wear = unit16(h3 >> 16);
        let depth = 2.0 * radius * o.cell_m * o.depth_ratio * (0.3 + 0.7 * wear * wear) * (1.0 - smooth(SLAB_FADE, SLAB, e.abs()));
        height += depth * profile(t, o.flat);
    }
    height
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::noise::split;

    #[test]
    fn the_neighbourhood_holds_every_crater() {
        assert!(REACH * REACH + SLAB * SLAB <= 0.25 + 1e-12);
    }

    #[test]
    fn craters_are_continuous_and_mostly_holes() {
        let o = CraterOctave { cell_m: 8000.0, depth_ratio: 0.2, flat: 0.3, density: 1.0, seed: 3, offset: DVec3::splat(0.3) };
        let radius_m = 1.7374e6;
        let at = |d: DVec3| {
            let (c, f) = split(d * (radius_m / o.cell_m) + o.offset);
            crater_octave(&o, radius_m, c, f, d)
        };
        let (mut sum, mut deep, mut worst) = (0.0, 0.0_f64, 0.0_f64);
        for i in 0..20_000 {
            let t = f64::from(i);
            let d = crate::space::sphere::direction_of_lat_lon(0.3 + t * 1e-5, 0.7 + 0.3 * t * 1e-5);
            let e = crate::space::sphere::direction_of_lat_lon(0.3 + t * 1e-5 + 1e-9, 0.7 + 0.3 * t * 1e-5);
            let h = at(d);
            sum += h;
            deep = deep.min(h);
            worst = worst.max((at(e) - h).abs());
        }
        assert!(sum < 0.0 && (-800.0..-200.0).contains(&deep), "mean {} deepest {deep}", sum / 2e4);
        assert!(worst < 0.01, "1.7 mm of ground changed the height by {worst} m");
    }
}
