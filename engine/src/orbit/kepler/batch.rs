//! Many solves at once, several orbits to an instruction, with the bits of one at a time.
//!
//! The code is that of the single solve, on registers of the widest kind that the machine has. Orbits that need more than the
//! usual one step, or whose numbers are wild, are done singly afterwards.

use super::conic::{LEAST, LONGEST, MOST_TURNS, Scale};
use super::orbit::Orbit;
use super::propagate_raw;
use super::real::{Lanes, Real};
use glam::DVec3;
use pulp::{Arch, Simd, WithSimd};

/// Columns of starts: gravitational parameter, position, velocity, and the time to go.
#[derive(Clone, Copy, Debug)]
pub struct Starts<'a> {
    /// Gravitational parameters, m³/s².
    pub gm: &'a [f64],
    /// Positions x, y, z, m.
    pub r: [&'a [f64]; 3],
    /// Velocities x, y, z, m/s.
    pub v: [&'a [f64]; 3],
    /// Times, s.
    pub dt_s: &'a [f64],
}

/// As [`super::propagate`] for every row of `starts`, into `out`: position (m) and velocity (m/s).
///
/// The bits are those of one at a time. Rows beyond the shortest column, or beyond `out`, are left alone.
pub fn propagate_many(starts: &Starts, out: &mut [(DVec3, DVec3)]) {
    let (r, v) = (starts.r, starts.v);
    let columns = [starts.gm, r[0], r[1], r[2], v[0], v[1], v[2], starts.dt_s];
    let n = columns.iter().map(|c| c.len()).min().unwrap_or(0).min(out.len());
    let arch = Arch::new();
    for (block, out) in out[..n].chunks_mut(LANES).enumerate() {
        arch.dispatch(Pass { columns: columns.map(|c| &c[block * LANES..][..out.len()]), out });
    }
}

/// Orbits in a block: a multiple of the lanes of any register.
const LANES: usize = 32;

/// A column of a block.
type Column = [f64; LANES];

struct Pass<'a> {
    columns: [&'a [f64]; 8],
    out: &'a mut [(DVec3, DVec3)],
}

impl WithSimd for Pass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { columns, out } = self;
        let c = &columns;
        let row = |k: usize| [c[0][k], c[1][k], c[2][k], c[3][k], c[4][k], c[5][k], c[6][k], c[7][k]];
        // Lanes past the end circle quietly.
        let mut given: [Column; 8] =
            [[1.0; LANES], [1.0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES], [1.0; LANES], [0.0; LANES], [0.0; LANES]];
        let mut scales = [None; LANES];
        for k in 0..out.len() {
            let [gm, x, y, z, u, v, w, dt] = row(k);
            let scale = Scale::of(gm, DVec3::new(x, y, z), DVec3::new(u, v, w));
            if scale.tame & scale.bends & dt.is_finite() & (dt != 0.0) {
                let f = scale.factors();
                let (l, s) = (f.length, f.speed);
                let scaled = [gm * f.gm, x * l, y * l, z * l, u * s, v * s, w * s, dt * f.time];
                for (column, x) in given.iter_mut().zip(scaled) {
                    column[k] = x;
                }
                scales[k] = Some(scale);
            }
        }
        let mut found: [Column; 7] = [[0.0; LANES]; 7];
        for k in (0..LANES).step_by(S::F64_LANES) {
            if k < out.len() {
                solve(simd, &given, &mut found, k);
            }
        }
        for (k, out) in out.iter_mut().enumerate() {
            let f = |c: usize| found[c][k];
            *out = match scales[k] {
                Some(scale) if f(6) > 0.0 => scale.undo(DVec3::new(f(0), f(1), f(2)), DVec3::new(f(3), f(4), f(5))),
                _ => {
                    let [gm, x, y, z, u, v, w, dt] = row(k);
                    propagate_raw(gm, DVec3::new(x, y, z), DVec3::new(u, v, w), dt)
                }
            };
        }
    }
}

#[inline(always)]
fn load<S: Simd>(simd: S, column: &Column, k: usize) -> Lanes<S> {
    Lanes(simd, S::as_simd_f64s(column).0[k / S::F64_LANES])
}

/// The lanes from `k` on: position, velocity, and 1 where one step was enough.
#[inline(always)]
fn solve<S: Simd>(simd: S, given: &[Column; 8], found: &mut [Column; 7], k: usize) {
    let (r, v) = (
        [load(simd, &given[1], k), load(simd, &given[2], k), load(simd, &given[3], k)],
        [load(simd, &given[4], k), load(simd, &given[5], k), load(simd, &given[6], k)],
    );
    let orbit = Orbit::new(load(simd, &given[0], k), r, v);
    let dt = load(simd, &given[7], k);
    // What the single solve sets apart before it begins.
    let sure = dt.both(dt.abs().at_most((orbit.period * MOST_TURNS).min(dt.all(LONGEST))), dt.all(LEAST).below(orbit.mu.hi));
    let dt = orbit.reduced(
        dt,
        #[inline(always)]
        || orbit.turn(),
    );
    let s = orbit.guess(
        dt.0,
        #[inline(always)]
        || orbit.pericentre(),
    );
    let (step, [x, y, z], [u, v, w]) = orbit.finish(s, dt);
    let done = Lanes::pick(x.both(sure, step.is_close()), x.all(1.0), x.all(0.0));
    for (column, value) in found.iter_mut().zip([x, y, z, u, v, w, done]) {
        S::as_mut_simd_f64s(column).0[k / S::F64_LANES] = value.1;
    }
}
