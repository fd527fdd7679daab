//! Forward peaks ([`super::forward`]) put back into what is drawn of the further orders ([`super::orders`]).
//!
//! The directions from an altitude lie wider apart than a peak is: a sum over them would see it or not, as they fall. The integral over the peak is
//! taken instead, point by point about the view, of light that runs evenly from direction to direction and never across the horizon.

use super::forward::{EDGE, Truncated};
use super::orders::{DOWN, Direction, MODES, UP};
use crate::air::Class;
use core::f64::consts::PI;

/// Rings about a view, and points of half a ring.
const RINGS: usize = 10;
/// See [`RINGS`].
const POINTS: usize = 10;

/// Angle of a ring from the view, rad: by squares, dense where a peak is.
fn ring(i: usize) -> (f64, f64) {
    let x = (i as f64 + 0.5) / RINGS as f64;
    (EDGE * x * x, x)
}

/// Points about a view: zenith angle, and the modes of the azimuth from the view.
pub(super) struct Around(Vec<(f64, [f64; MODES])>);

impl Around {
    /// Of a view's zenith cosine.
    pub(super) fn new(view: f64) -> Self {
        let across = (1.0 - view * view).max(0.0).sqrt();
        let points = (0..RINGS).flat_map(|i| (0..POINTS).map(move |j| (i, j)));
        Self(
            points
                .map(|(i, j)| {
                    let (sin, cos) = libm::sincos(ring(i).0);
                    let (up, aside) = {
                        let (s, c) = libm::sincos(PI * (j as f64 + 0.5) / POINTS as f64);
                        (c, s)
                    };
                    let cosine = (view * cos + across * sin * up).clamp(-1.0, 1.0);
                    // From the view's meridian: aside, and along.
                    let turn = libm::atan2(sin * aside, across * cos - view * sin * up);
                    (libm::acos(cosine), core::array::from_fn(|m| libm::cos(m as f64 * turn) * if m > 0 { 2.0 } else { 1.0 }))
                })
                .collect(),
        )
    }
}

/// Weights of the rings of a class's peak; their sum over all points is its share.
pub(super) fn weights(class: &Class, truncated: &Truncated) -> [f64; RINGS] {
    if truncated.share == 0.0 {
        return [0.0; RINGS];
    }
    let one = |i: usize| {
        let (angle, x) = ring(i);
        let (sin, mu) = libm::sincos(angle);
        (class.value(mu) - truncated.cap).max(0.0) * sin * x
    };
    let all: [f64; RINGS] = core::array::from_fn(one);
    let sum: f64 = all.iter().sum();
    all.map(|x| x * truncated.share / (sum * POINTS as f64).max(1e-300))
}

/// How much of the light of each direction, by its modes in the azimuth, a peak turns towards a view; `horizon`: its zenith angle.
pub(super) fn kernel(around: &Around, weights: &[f64; RINGS], directions: &[Direction], horizon: f64) -> Vec<[f64; MODES]> {
    let mut out = vec![[0.0; MODES]; directions.len()];
    for ((zenith, modes), weight) in around.0.iter().zip(weights.iter().flat_map(|w| [*w; POINTS])) {
        let (from, count, width) = if *zenith < horizon { (0, UP, horizon) } else { (UP, DOWN, PI - horizon) };
        let x = ((zenith - horizon).abs() / width).sqrt();
        let side = &directions[from..from + count];
        let above = side.partition_point(|d| d.part < x);
        let (low, f) = match (above.checked_sub(1), side.get(above)) {
            (Some(low), Some(high)) => (low, (x - side[low].part) / (high.part - side[low].part)),
            (None, _) => (0, 0.0),
            (Some(low), None) => (low, 0.0),
        };
        for (to, share) in [(low, 1.0 - f), (low + 1, f)] {
            if share > 0.0 {
                out[from + to].iter_mut().zip(modes).for_each(|(sum, m)| *sum += weight * share * m);
            }
        }
    }
    out
}
