//! Paths of light to the rows of the table of further orders ([`super::orders`]): how much of what is scattered at each step of a direction arrives.
//!
//! A path is cut into fine cells, by squares of even parts on both sides of its lowest point and wherever density jumps; cells are gathered into
//! steps, so that each has its share of the way (in that measure) and of the light that arrives. A step asks for its source once, at the middle of
//! its light.

use super::forward::Truncated;
use super::levels::Levels;
use super::orders::{Direction, HEAD_ROWS, STEPS, row3};
use super::sun_map::dip;
use crate::air::{Class, Classes, Medium};
use core::f64::consts::PI;
use glam::DVec3;

/// Cells of a path without jumps.
const CELLS: usize = 48;
/// Jumps at which it is cut.
const JUMPS: usize = 8;
/// What the light that arrives has to say in how long steps are; the way has the rest.
const BY_LIGHT: f64 = 0.2;

/// Where a step begins: squares of even parts on both sides of the lowest point, where air is densest.
pub(super) fn step_at(low: f64, end: f64, part: f64) -> f64 {
    let before = low.sqrt();
    let y = part * (before + (end - low).sqrt()) - before;
    low + y * y.abs()
}

/// The inverse: the part of a place.
fn part_at(low: f64, end: f64, s: f64) -> f64 {
    let before = low.sqrt();
    let y = (s - low).abs().sqrt() * (s - low).signum();
    (y + before) / (before + (end - low).sqrt()).max(1e-300)
}

/// Layers of a medium as paths ask for them.
pub(super) struct Matter<'a> {
    medium: &'a Medium,
    /// By layer: scattering per class, and extinction but for what peaks leave, at density 1, m⁻¹.
    layers: Vec<(usize, DVec3, DVec3)>,
    jumps_m: Vec<f64>,
}

impl<'a> Matter<'a> {
    pub(super) fn new(medium: &'a Medium, classes: &[(Class, Truncated)]) -> Self {
        let of = |(i, layer): (usize, &crate::air::Layer)| {
            let class = classes.iter().position(|(class, _)| class.layers.contains(&i)).unwrap_or(0);
            let scattering = layer.scattering_per_m.as_dvec3();
            let share = classes.get(class).map_or(0.0, |(_, truncated)| truncated.share);
            (class, scattering, layer.absorption_per_m.as_dvec3() + scattering * (1.0 - share))
        };
        Self { medium, layers: medium.layers.iter().enumerate().map(of).collect(), jumps_m: medium.jumps_m(JUMPS) }
    }

    /// Scattering of each class and extinction at an altitude, m⁻¹.
    fn at(&self, altitude_m: f64) -> ([DVec3; Classes::MAX], DVec3) {
        let (mut scattered, mut extinction) = ([DVec3::ZERO; Classes::MAX], DVec3::ZERO);
        for (layer, (class, scattering, lost)) in self.medium.layers.iter().zip(&self.layers) {
            let density = layer.profile.density(altitude_m);
            scattered[*class] += *scattering * density;
            extinction += *lost * density;
        }
        (scattered, extinction)
    }
}

/// What arrives of a cell, or of a step.
#[derive(Clone, Copy, Default)]
struct Light {
    /// Of a unit source, by class.
    of: [DVec3; Classes::MAX],
    /// Its sum over classes and channels, and that times its distance.
    all: f64,
    moment: f64,
}

/// The rows of a direction from an altitude, and of its steps: [`super::orders::Plan::rows`].
pub(super) fn rows(matter: &Matter<'_>, levels: &Levels, from_m: f64, direction: &Direction, hits: bool, rows: &mut Vec<[f32; 4]>) {
    let (bottom, top) = (matter.medium.bottom_radius_m, matter.medium.top_altitude_m);
    let (r, q0) = (bottom + from_m, from_m * (2.0 * bottom + from_m));
    let slope = r * direction.cosine;
    let to_ground = (slope * slope - q0).max(0.0).sqrt();
    let end = if hits {
        if slope < 0.0 { q0 / (to_ground - slope) } else { 0.0 }
    } else {
        let rest = (top * (2.0 * bottom + top) - q0).max(0.0);
        let root = (slope * slope + rest).sqrt();
        if slope > 0.0 { rest / (root + slope) } else { root - slope }
    };
    let low = (-slope).clamp(0.0, end);
    let altitude = |s: f64| {
        let q = q0 + s * (2.0 * slope + s);
        q / (bottom + (bottom * bottom + q).max(0.0).sqrt())
    };
    let mut edges: Vec<f64> = (0..=CELLS).map(|i| i as f64 / CELLS as f64).collect();
    for jump in &matter.jumps_m {
        let root = (slope * slope - q0 + jump * (2.0 * bottom + jump)).max(0.0).sqrt();
        edges.extend([-slope - root, root - slope].into_iter().filter(|s| *s > 0.0 && *s < end).map(|s| part_at(low, end, s)));
    }
    edges.retain(|x| (0.0..=1.0).contains(x));
    edges.sort_by(f64::total_cmp);
    let mut through = DVec3::ONE;
    let cells: Vec<Light> = edges
        .windows(2)
        .map(|edge| {
            let [from, s, to] = [edge[0], 0.5 * (edge[0] + edge[1]), edge[1]].map(|x| step_at(low, end, x));
            let (scattered, extinction) = matter.at(altitude(s));
            let length = to - from;
            let depth = extinction * length;
            let kept = depth.to_array().map(|x| libm::exp(-x));
            // ∫ e^(−σs) ds over the cell, in front of it the way to the eye.
            let even = [0, 1, 2].map(|c| if depth[c] > 1e-4 { (1.0 - kept[c]) / extinction[c] } else { length * (1.0 - 0.5 * depth[c]) });
            let arrives = DVec3::from_array(even) * through;
            through *= DVec3::from_array(kept);
            let of = scattered.map(|x| x * arrives);
            let all = of.iter().sum::<DVec3>().element_sum();
            Light { of, all, moment: all * s }
        })
        .collect();
    let at = rows.len();
    rows.resize(at + HEAD_ROWS, [0.0; 4]);
    let mut from = 0;
    for to in bounds(&edges, &cells) {
        let step = cells[from..to].iter().fold(Light::default(), |mut sum, cell| {
            sum.of.iter_mut().zip(cell.of).for_each(|(x, y)| *x += y);
            (sum.all, sum.moment) = (sum.all + cell.all, sum.moment + cell.moment);
            sum
        });
        let middle = step_at(low, end, 0.5 * (edges[from] + edges[to]));
        let s = if step.all > 0.0 { step.moment / step.all } else { middle };
        let h = altitude(s);
        let (sine, cosine) = dip(bottom, h.max(0.0));
        let radius = bottom + h;
        rows.push(row3(DVec3::new(r, s, slope + s) / radius, h));
        rows.push(row3(DVec3::new(levels.row(h), sine, cosine), 0.0));
        rows.push(row3(step.of.iter().sum(), 0.0));
        rows.extend(step.of.iter().map(|x| row3(*x, 0.0)));
        from = to;
    }
    let weight = direction.weight * direction.cosine.max(0.0);
    let ground = if hits { through * matter.medium.ground_albedo.as_dvec3() / PI } else { DVec3::ZERO };
    if let [first, second, ..] = &mut rows[at..] {
        *first = row3(DVec3::new(direction.cosine, r / bottom, end / bottom), weight);
        *second = row3(ground, 0.0);
    }
}

/// The edge at which each step ends.
fn bounds(edges: &[f64], cells: &[Light]) -> [usize; STEPS] {
    let all: f64 = cells.iter().map(|c| c.all).sum();
    let by_light = if all > 0.0 { BY_LIGHT / all } else { 0.0 };
    let (mut sum, mut at, mut held) = (0.0, 0, 0.0);
    core::array::from_fn(|i| {
        let wanted = (i + 1) as f64 / STEPS as f64 * if all > 0.0 { 1.0 } else { 1.0 - BY_LIGHT };
        let first = at;
        // As near as edges are, one cell at least, and one left for every step to come.
        while at < cells.len() + i + 1 - STEPS {
            let next = sum + cells[at].all * by_light;
            let after = (1.0 - BY_LIGHT) * edges[at + 1] + next;
            if at > first && after - wanted > wanted - held {
                break;
            }
            (at, sum, held) = (at + 1, next, after);
        }
        if i + 1 == STEPS { cells.len() } else { at }
    })
}
