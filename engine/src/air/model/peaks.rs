//! Forward lobes in the kernels of the further orders ([`super::orders`]).
//!
//! The directions from an altitude lie wider apart than a lobe's middle is: a sum over them would see it or not, as they fall. The integral over the lobe
//! is taken instead, point by point about the view, of light that runs evenly from direction to direction and never across the horizon. So the
//! peaks of [`super::forward`] are put back into what is drawn, too.

use super::forward::Truncated;
use super::orders::{DOWN, Direction, MODES, UP};
use crate::air::Class;
use core::f64::consts::PI;

/// Half width of a lobe, rad: what a phase function has above its value there.
const WIDE: f64 = 0.7;
/// By how much more than there it must have in the middle.
const SHARP: f64 = 4.0;
/// Rings about a view, and points of half a ring.
const RINGS: usize = 14;
/// See [`RINGS`].
const POINTS: usize = 12;

/// Angle of a ring from the view, rad: by squares, dense in a lobe's middle.
fn ring(i: usize) -> (f64, f64) {
    let x = (i as f64 + 0.5) / RINGS as f64;
    (WIDE * x * x, x)
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

/// The lobe of a class: the value above which it begins, sr⁻¹, its integral with the peak, and the weights of the rings without it and with it.
pub(super) struct Lobe {
    pub(super) foot: f64,
    pub(super) light: f64,
    weights: [[f64; RINGS]; 2],
}

impl Lobe {
    /// Of a class; none of one that is even enough for a sum over directions.
    pub(super) fn new(class: &Class, truncated: &Truncated) -> Option<Self> {
        let foot = class.value(libm::cos(WIDE)).min(truncated.cap);
        if class.value(1.0) < SHARP * foot {
            return None;
        }
        // Per dx, of an angle WIDE · x³, and of a ring's.
        let above = |angle: f64, k: usize| {
            let (sin, mu) = libm::sincos(angle);
            let value = class.value(mu);
            (if k == 0 { value.min(truncated.cap) } else { value } - foot).max(0.0) * sin
        };
        let fine = 256;
        let light = [0, 1].map(|k| {
            let part = |i: i32| {
                let x = (f64::from(i) + 0.5) / f64::from(fine);
                above(WIDE * x * x * x, k) * 6.0 * PI * WIDE * x * x / f64::from(fine)
            };
            (0..fine).map(part).sum::<f64>()
        });
        let weights = [0, 1].map(|k| {
            let all: [f64; RINGS] = core::array::from_fn(|i| above(ring(i).0, k) * ring(i).1);
            let sum = all.iter().sum::<f64>() * POINTS as f64;
            all.map(|x| x * light[k] / sum.max(1e-300))
        });
        Some(Self { foot, light: light[1], weights })
    }

    /// How much of the light of each direction, by its modes in the azimuth, a lobe turns towards a view, without and with its peak; `horizon`:
    /// its zenith angle.
    pub(super) fn kernel(&self, around: &Around, directions: &[Direction], horizon: f64) -> Vec<[[f64; MODES]; 2]> {
        let mut out = vec![[[0.0; MODES]; 2]; directions.len()];
        for (i, (zenith, modes)) in around.0.iter().enumerate() {
            let weights = self.weights.map(|w| w[i / POINTS]);
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
                    for (sums, weight) in out[from + to].iter_mut().zip(weights) {
                        sums.iter_mut().zip(modes).for_each(|(sum, m)| *sum += weight * share * m);
                    }
                }
            }
        }
        out
    }
}
