//! Time of a Kepler solve by regime: one at a time, from a kept conic, and in batches. Their errors are in
//! `tests/peers/kepler.py`, which measures them against 50-digit solutions.

use engine::orbit::kepler::batch::{Starts, propagate_many};
use engine::orbit::kepler::{Conic, propagate_raw};
use glam::DVec3;
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::Instant;

/// Nanoseconds for a solve in one regime, the least of several rounds, on one core.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KeplerRow {
    /// The kind of orbit and step.
    pub regime: &'static str,
    /// [`propagate_raw`]: from a state that was not seen before.
    pub one_ns: f64,
    /// [`Conic::after_raw`]: a further time on a known orbit.
    pub kept_ns: f64,
    /// [`propagate_many`].
    pub batch_ns: f64,
}

/// A start about a centre of μ = 1, and a time.
type Case = (DVec3, DVec3, f64);

/// Solves that are timed together.
const CASES: usize = 4096;
const ROUNDS: usize = 20;

/// Times every regime.
pub fn rows() -> Vec<KeplerRow> {
    let ellipse = |e: [f64; 2], turns: [f64; 2]| move |u: &mut Uniform| conic(u, e, -PI..PI, turns.map(|t| t * TAU), false);
    let open = |e: [f64; 2], dt: [f64; 2], log| move |u: &mut Uniform| conic(u, e, -1.2..1.2, dt, log);
    vec![
        row("e < 0.1, dt < 0.05 P", ellipse([0.0, 0.1], [0.0, 0.05])),
        row("e < 0.1, dt < P", ellipse([0.0, 0.1], [0.0, 1.0])),
        row("e 0.1 to 0.9, dt < P", ellipse([0.1, 0.9], [0.0, 1.0])),
        row("e 0.9 to 0.999, dt < P", ellipse([0.9, 0.999], [0.0, 1.0])),
        row("e < 0.9, 100 to 1e6 P", ellipse([0.0, 0.9], [1e2, 1e6])),
        row("e 0.999 to 1.001", open([0.999, 1.001], [1e-2, 1e2], true)),
        row("e 1.01 to 10, dt < 10", open([1.01, 10.0], [0.0, 10.0], false)),
        row("e 1.01 to 10, dt 1e3 to 1e8", open([1.01, 10.0], [1e3, 1e8], true)),
    ]
}

fn row(regime: &'static str, make: impl Fn(&mut Uniform) -> Case) -> KeplerRow {
    let mut uniform = Uniform(1);
    let cases: Vec<Case> = (0..CASES).map(|_| make(&mut uniform)).collect();
    let conics: Vec<Conic> = cases.iter().map(|c| Conic::new(1.0, c.0, c.1)).collect();
    let column = |f: fn(&Case) -> f64| cases.iter().map(f).collect::<Vec<f64>>();
    let gm = vec![1.0; CASES];
    let (x, y, z) = (column(|c| c.0.x), column(|c| c.0.y), column(|c| c.0.z));
    let (u, v, w) = (column(|c| c.1.x), column(|c| c.1.y), column(|c| c.1.z));
    let dt_s = column(|c| c.2);
    let starts = Starts { gm: &gm, r: [&x, &y, &z], v: [&u, &v, &w], dt_s: &dt_s };
    let mut out = vec![(DVec3::ZERO, DVec3::ZERO); CASES];
    KeplerRow {
        regime,
        one_ns: least_ns(|| cases.iter().map(|c| propagate_raw(black_box(1.0), c.0, c.1, c.2)).for_each(keep)),
        kept_ns: least_ns(|| conics.iter().zip(&cases).map(|(conic, c)| conic.after_raw(c.2)).for_each(keep)),
        batch_ns: least_ns(|| {
            propagate_many(black_box(&starts), &mut out);
            black_box(&mut out);
        }),
    }
}

/// Looked at, so that it is computed.
fn keep(state: (DVec3, DVec3)) {
    black_box(state);
}

/// Least time of a round of [`CASES`], for one, ns.
fn least_ns(mut round: impl FnMut()) -> f64 {
    let timed = (0..ROUNDS).map(|_| {
        let start = Instant::now();
        round();
        start.elapsed().as_secs_f64()
    });
    timed.fold(f64::INFINITY, f64::min) * 1e9 / CASES as f64
}

/// An orbit of a = ±1 (of q = 1 about e = 1), turned at random, from a true anomaly within `nu`.
fn conic(u: &mut Uniform, e: [f64; 2], nu: std::ops::Range<f64>, dt: [f64; 2], log: bool) -> Case {
    let e = u.between(e);
    let p = if (e - 1.0).abs() < 0.005 { 1.0 + e } else { (1.0 - e * e).abs() };
    let (sin, cos) = libm::sincos(u.between([nu.start, nu.end]));
    let radius = p / (1.0 + e * cos);
    let (along, across) = (u.direction(), u.direction());
    let across = (across - along * across.dot(along)).normalize_or(along.any_orthonormal_vector());
    let dt = if log { libm::exp(u.between(dt.map(libm::log))) } else { u.between(dt) };
    ((along * cos + across * sin) * radius, (across * (e + cos) - along * sin) / p.sqrt(), dt)
}

/// Uniform numbers of 0 … 1, the same in every run [Steele et al. 2014, SplitMix].
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * f64::EPSILON * 0.5
    }

    fn between(&mut self, [a, b]: [f64; 2]) -> f64 {
        a + (b - a) * self.next()
    }

    fn direction(&mut self) -> DVec3 {
        let (sin, cos) = libm::sincos(TAU * self.next());
        let z = self.between([-1.0, 1.0]);
        let flat = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(flat * cos, flat * sin, z)
    }
}
