//! The planetary level's forces: Einstein–Infeld–Hoffmann between all bodies, Newton's with masses that are none (asteroids),
//! figures with their reaction, and tidal bulges.
//!
//! A figure acts on another member, and is pushed back, where its greatest relative size at their least distance is above a bound.
//! - [Park et al. 2021] "The JPL Planetary and Lunar Ephemerides DE440 and DE441", AJ 161, 105, §3 (the terms of the model).

use super::orbit::Details;
use super::tree::Tree;
use crate::orbit::gravity::figure::{Axes, Figure};
use crate::orbit::gravity::relativity::{Pairs, einstein_infeld_hoffmann};
use crate::orbit::gravity::response::own_bulge;
use crate::orbit::integrate::Force;
use crate::time::{SimTime, TICKS_PER_SECOND};
use core::cell::RefCell;
use glam::DVec3;

/// A figure counts for another body where it is more than this part of a point's pull: the Sun's J₂ at Neptune is 1e-12 … of it.
const FIGURE_COUNTS: f64 = 1e-14;

/// A figured member and who feels it.
#[derive(Clone, Debug)]
struct Shaped {
    member: usize,
    figure: Figure,
    felt_by: Vec<usize>,
}

/// The planetary level.
#[derive(Clone, Debug)]
pub struct Planets {
    epoch: SimTime,
    /// GM of each member with its light moons, then of the masses that are no bodies.
    gm: Vec<f64>,
    members: usize,
    shaped: Vec<Shaped>,
}

/// The planetary level with the buffers of one integration.
#[derive(Debug)]
pub struct Run<'a> {
    planets: &'a Planets,
    pairs: RefCell<Pairs>,
}

/// The instant `t` seconds after `epoch`, to the nearest tick.
#[allow(clippy::cast_possible_truncation)]
pub fn instant(epoch: SimTime, t: f64) -> SimTime {
    epoch.plus((t * TICKS_PER_SECOND as f64).round() as i64)
}

impl Planets {
    /// The forces on `members` (indices of bodies), which start at `places`.
    pub fn new(tree: &Tree, details: &Details, members: &[usize], places: &[DVec3]) -> Self {
        let gm = members.iter().map(|i| tree.point_gm[*i]).chain(details.masses.iter().map(|m| m.gm_m3_s2)).collect();
        let shaped = members.iter().enumerate().filter_map(|(member, &body)| {
            let figure = details.figures.get(body)?.as_ref().filter(|f| !f.is_point())?.clone();
            let greatest = figure.zonal.iter().fold(figure.c22.abs(), |a, j| a.max(j.abs()));
            let felt_by = (0..members.len()).filter(|&other| {
                // Half the distance at the start stands for the least.
                let ratio = 2.0 * figure.radius_m / (places[other] - places[member]).length();
                other != member && 3.0 * greatest * ratio * ratio > FIGURE_COUNTS
            });
            let felt_by = felt_by.collect();
            Some(Shaped { member, figure, felt_by })
        });
        let shaped = shaped.collect();
        Self { epoch: tree.epoch, gm, members: members.len(), shaped }
    }

    /// To integrate with.
    pub fn run(&self) -> Run<'_> {
        Run { planets: self, pairs: RefCell::default() }
    }

    fn figures(&self, t: f64, q: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        let at = instant(self.epoch, t);
        for s in &self.shaped {
            if s.felt_by.is_empty() {
                continue;
            }
            let axes = s.figure.axes(at);
            for &other in &s.felt_by {
                let from = q[other] - q[s.member];
                let mut pull = s.figure.acceleration(self.gm[s.member], &axes, from);
                pull += self.bulge(s, &axes, from, v[other] - v[s.member], other);
                a[other] += pull;
                a[s.member] -= pull * (self.gm[other] / self.gm[s.member]);
            }
        }
    }

    fn bulge(&self, s: &Shaped, axes: &Axes, from: DVec3, velocity: DVec3, raiser: usize) -> DVec3 {
        let [k2, lag_s] = s.figure.tide;
        if k2 == 0.0 {
            return DVec3::ZERO;
        }
        let spin = axes.z * s.figure.turn_rad_s();
        own_bulge(self.gm[raiser], k2, lag_s, s.figure.radius_m, spin, from, velocity)
    }
}

impl Force for Run<'_> {
    const USES_VELOCITY: bool = true;

    fn accelerations(&self, t: f64, q: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        einstein_infeld_hoffmann(&self.planets.gm, self.planets.members, q, v, a, &mut self.pairs.borrow_mut());
        self.planets.figures(t, q, v, a);
    }
}
