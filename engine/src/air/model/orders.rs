//! Further orders of scattering: what their precomputation needs to know of a medium that does not depend on the sun.
//!
//! The light that reaches a point of an air after one or more scatterings, scattered there once more towards `v`, is the source function
//! `S(v) = ∫ p(v·ω) L(ω) dω` (p the mean phase function of the layers there, by their share of the scattering). It depends on altitude,
//! on the sun's height, on the zenith angle of `v` and on its azimuth φ from the sun; in φ it is even and smooth and is carried by its
//! first four Fourier modes: `S = S₀ + S₁ cos φ + S₂ cos 2φ + S₃ cos 3φ`, each a table over altitude × sun × view.
//!
//! One order follows from the one before in two steps, which `shaders/pass/air_orders.wgsl` takes for all texels at once:
//! - *gather*: along fixed directions from each altitude (Gauss–Legendre nodes in the zenith angle, dense at the horizon; even azimuths) the
//!   source of the order before is added up step by step, ground included: the radiance `L`, by its Fourier modes in the azimuth;
//! - *turn*: `S_m(v) = Σ K_m(v, ω) L_m(ω)`, the phase function's own modes `K_m = Σ_l χ_l Y_lm(v) Y_lm(ω)` by the addition theorem
//!   [Chandrasekhar 1960, "Radiative Transfer", §48].
//!
//! Where the steps lie, how much light each lets through and the kernels K depend on the medium alone: [`Plan`] computes them here,
//! in f64, for any layers, profiles and phase functions, once for a medium.

use crate::air::{Classes, Medium};
use crate::space::relative::narrow;
use core::f64::consts::PI;
use glam::DVec3;

/// Heights of the sun in a table.
pub const SUNS: usize = 32;
/// Altitudes in a table.
pub const ALTITUDES: usize = 16;
/// Zenith cosines of the view in a table.
pub const VIEWS: usize = 16;
/// Directions from an altitude that leave the air, and that meet the ground.
pub const UP: usize = 12;
/// See [`UP`].
pub const DOWN: usize = 8;
/// All of them.
pub const DIRECTIONS: usize = UP + DOWN;
/// Steps along a direction.
pub const STEPS: usize = 16;
/// Degree at which the Legendre series of a phase function ends.
pub const DEGREE: usize = 8;
/// Degree at which it ends in what is drawn.
pub const DRAWN_DEGREE: usize = 16;
/// Fourier modes in the azimuth.
pub const MODES: usize = 4;
/// Rows of four numbers that open a direction.
pub const HEAD_ROWS: usize = 2;
/// Rows of a step.
pub const STEP_ROWS: usize = 4 + DEGREE;
/// Rows of a direction with its steps.
pub const PATH_ROWS: usize = HEAD_ROWS + STEPS * STEP_ROWS;
/// Rows of all directions; the kernels follow.
pub const KERNELS_AT: usize = ALTITUDES * DIRECTIONS * PATH_ROWS;
/// Those of the kernels for the next order; those for the table follow.
pub const DRAWN_AT: usize = KERNELS_AT + ALTITUDES * VIEWS * DIRECTIONS * 3;
/// Rows of the whole plan.
pub const ROWS: usize = 2 * DRAWN_AT - KERNELS_AT;
/// Most orders that are computed one by one.
pub const MAX_ORDERS: u32 = 8;

/// How the table's coordinate for the sun runs: `x = (asinh(t · scale) + low) · inverse`, `t = 2 sin(e/2)`, e the sun's angle above the
/// horizon of the altitude; from the knee upwards evenly in t, one unit of asinh by each knee. Dense at the terminator, within an angle in
/// which the air's own curvature lets day and night mix; it ends where no air in sight is lit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunMap {
    /// 1 / that angle, rad⁻¹.
    pub scale: f64,
    /// asinh at the deepest night, negated.
    pub low: f64,
    /// 1 / the range.
    pub inverse: f64,
    /// t of the knee.
    pub knee: f64,
}

impl SunMap {
    /// For the air of a medium.
    pub fn new(medium: &Medium) -> Self {
        let (sine, cosine) = dip(medium.bottom_radius_m, medium.top_altitude_m);
        let dip = libm::atan2(sine, cosine);
        let scale = 1.0 / (0.35 * dip).max(0.01);
        let knee = 0.35;
        // Twice the dip: where the farthest air in sight of the ground sees the sun on its horizon.
        let night = (2.5 * dip + 0.05).min(0.5 * PI);
        let low = libm::asinh(2.0 * libm::sin(0.5 * night) * scale);
        let high = libm::asinh(knee * scale) + (2.0 * (1.0 + sine)).sqrt() / knee - 1.0;
        Self { scale, low, inverse: 1.0 / (low + high), knee }
    }
}

/// Sine and cosine of the angle by which the horizon lies below the level at an altitude.
fn dip(radius_m: f64, altitude_m: f64) -> (f64, f64) {
    let r = radius_m + altitude_m;
    ((altitude_m * (2.0 * radius_m + altitude_m)).max(0.0).sqrt() / r, radius_m / r)
}

/// Altitude of a table's row, m: evenly in its root; the last a hair below the top.
fn altitude_m(medium: &Medium, row: usize) -> f64 {
    let x = row as f64 / (ALTITUDES - 1) as f64;
    medium.top_altitude_m * (x * x).min(1.0 - 1e-6)
}

/// Of what a phase function of these Legendre coefficients (to degree [`DEGREE`] + 1) scatters, the share that is taken to go straight on:
/// the series of the rest ends smoothly at [`DEGREE`] [Wiscombe 1977, "The Delta-M Method"].
pub fn forward_share(chi: &[f64]) -> f64 {
    chi.get(DEGREE + 1).map_or(0.0, |x| x.clamp(0.0, 1.0))
}

/// How a class scatters light that its like has turned before, but by so little that it still counts as sunlight: with the coefficients χ_l
/// to [`DEGREE`], as the further orders reckon with, and beyond with χ_l²/f, as two scatterings make them: there χ_l ∝ gˡ is taken, and
/// Henyey and Greenstein's lobe of g² has just these [as the second-order term of Nakajima & Tanaka 1988, JQSRT 40].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aureole {
    /// g².
    pub g: f64,
    /// Factor of the lobe.
    pub scale: f64,
    /// Factors of the Legendre polynomials that are added.
    pub series: [f64; DEGREE + 1],
}

impl Aureole {
    /// From Legendre coefficients to degree [`DEGREE`] + 2.
    pub fn new(chi: &[f64]) -> Self {
        let forward = forward_share(chi);
        let ratio = chi.get(DEGREE + 2).map_or(0.0, |x| x / forward.max(1e-9)).clamp(0.5, 0.985);
        let g = ratio * ratio;
        let scale = if forward < 1e-3 { 0.0 } else { forward / (0..=DEGREE).fold(1.0, |x, _| x * g) };
        let mut series = [0.0; DEGREE + 1];
        let mut lobe = scale;
        for (l, (slot, chi)) in series.iter_mut().zip(chi).enumerate() {
            *slot = (2 * l + 1) as f64 / (4.0 * PI) * (chi - lobe);
            lobe *= g;
        }
        Self { g, scale, series }
    }
}

/// A layer's coefficients: χ₀ … χ_[`DEGREE`] without the share that goes straight on, that share, and χ₀ … χ_[`DRAWN_DEGREE`] as they are.
struct Series {
    chi: [f64; DEGREE + 1],
    forward: f64,
    full: [f64; DRAWN_DEGREE + 1],
}

/// Those of all layers; a layer that scatters nothing has none.
fn series(medium: &Medium) -> Vec<Series> {
    let mut out: Vec<Series> =
        medium.layers.iter().map(|_| Series { chi: [0.0; DEGREE + 1], forward: 0.0, full: [0.0; DRAWN_DEGREE + 1] }).collect();
    for class in Classes::of(medium).list {
        let all = class.legendre(DRAWN_DEGREE);
        let forward = forward_share(&all);
        for i in class.layers {
            if let Some(series) = out.get_mut(i) {
                series.forward = forward;
                series.chi.iter_mut().zip(&all).for_each(|(x, chi)| *x = chi - forward);
                series.full.iter_mut().zip(&all).for_each(|(x, chi)| *x = *chi);
            }
        }
    }
    out
}

/// What the precomputation of a medium's further orders needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Rows of four numbers, [`ROWS`] of them. A direction, by altitude and from the horizon's side: (zenith cosine; radius and distance of where it ends, by
    /// the datum's radius; weight in the irradiance), (transmittance to the ground × albedo/π, rgb; 0), then its steps:
    /// (radius at the eye, distance, both by the radius at the step; zenith cosine; altitude, m), (table's row; sine and cosine of the horizon's
    /// dip; 0), (share of the light of a unit source that arrives, rgb; 0), (the same by the Legendre coefficient of the scattering layers, degree 0 to [`DEGREE`]).
    /// A kernel, by altitude, view and direction: the modes of red, of green, of blue.
    pub rows: Vec<[f32; 4]>,
    /// Orders to compute one by one before they are combined.
    pub orders: u32,
}

/// One direction from an altitude.
pub(super) struct Direction {
    pub(super) cosine: f64,
    /// Its solid angle, all azimuths together.
    pub(super) weight: f64,
}

impl Plan {
    /// For a medium.
    pub fn new(medium: &Medium) -> Self {
        let series = series(medium);
        let mut rows = Vec::with_capacity(ROWS);
        let [mut kernels, mut drawn] = [(); 2].map(|()| Vec::with_capacity(DRAWN_AT - KERNELS_AT));
        for row in 0..ALTITUDES {
            let altitude_m = altitude_m(medium, row);
            let directions = directions(medium, altitude_m);
            for (i, direction) in directions.iter().enumerate() {
                path_rows(medium, &series, altitude_m, direction, i >= UP, &mut rows);
            }
            kernel_rows(medium, &series, row, &directions, [&mut kernels, &mut drawn]);
        }
        rows.append(&mut kernels);
        rows.append(&mut drawn);
        Self { rows, orders: orders(medium) }
    }
}

/// How many orders tell the sum of all: more where light is scattered more often before it leaves.
fn orders(medium: &Medium) -> u32 {
    let mut depth = DVec3::ZERO;
    let n = 64;
    for layer in &medium.layers {
        for i in 0..n {
            let x = (f64::from(i) + 0.5) / f64::from(n);
            let width = 2.0 * x / f64::from(n) * medium.top_altitude_m;
            depth += layer.scattering_per_m.as_dvec3() * (layer.profile.density(x * x * medium.top_altitude_m) * width);
        }
    }
    let depth = depth.max_element();
    [(0.5, 4), (3.0, 5), (8.0, 6)].into_iter().find(|(limit, _)| depth < *limit).map_or(MAX_ORDERS, |(_, n)| n)
}

/// Nodes and weights of Gauss–Legendre quadrature on [0, 1].
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let count = n as f64;
    (0..n)
        .map(|i| {
            let mut x = libm::cos(PI * (i as f64 + 0.75) / (count + 0.5));
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut last, mut p) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (last, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * last) / k);
                }
                slope = count * (x * p - last) / (x * x - 1.0);
                x -= p / slope;
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The directions from an altitude: zenith angles as squares from the horizon, where the sky changes most.
pub(super) fn directions(medium: &Medium, altitude_m: f64) -> Vec<Direction> {
    let (sine, cosine) = dip(medium.bottom_radius_m, altitude_m);
    let horizon = 0.5 * PI + libm::atan2(sine, cosine);
    let side = |n: usize, width: f64, sign: f64| {
        gauss_legendre(n).into_iter().map(move |(x, w)| {
            let (sin, cosine) = libm::sincos(horizon + sign * width * x * x);
            Direction { cosine, weight: 2.0 * PI * sin * w * 2.0 * x * width }
        })
    };
    let mut out: Vec<Direction> = side(UP, horizon, -1.0).chain(side(DOWN, PI - horizon, 1.0)).collect();
    corrected(&mut out);
    out
}

/// Changes weights by as little as makes them exact for polynomials of the cosine to [`DEGREE`], and for the light on level ground.
fn corrected(directions: &mut [Direction]) {
    const N: usize = DEGREE + 2;
    let functions = |cosine: f64| -> [f64; N] {
        let y = legendre(cosine)[0];
        core::array::from_fn(|j| if j < N - 1 { y[j] } else { cosine.max(0.0) })
    };
    // Normal equations of the least change, relative to the weight, under these conditions.
    let mut a = [[0.0; N + 1]; N];
    for direction in directions.iter() {
        let f = functions(direction.cosine);
        for (row, x) in a.iter_mut().zip(f) {
            row.iter_mut().zip(f).for_each(|(sum, y)| *sum += direction.weight * x * y);
            row[N] -= direction.weight * x;
        }
    }
    a[0][N] += (4.0 * PI).sqrt();
    a[N - 1][N] += PI;
    for i in 0..N {
        let pivot = a[i];
        for row in a.iter_mut().skip(i + 1) {
            let factor = row[i] / pivot[i];
            row.iter_mut().zip(pivot).for_each(|(x, y)| *x -= factor * y);
        }
    }
    let mut change = [0.0; N];
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|j| a[i][j] * change[j]).sum();
        change[i] = (a[i][N] - known) / a[i][i];
    }
    for direction in directions {
        let by: f64 = functions(direction.cosine).iter().zip(change).map(|(f, x)| f * x).sum();
        if by.abs() < 0.5 {
            direction.weight *= 1.0 + by;
        }
    }
}

/// Where a step begins: squares of even parts on both sides of the lowest point, where air is densest.
pub(super) fn step_at(low: f64, end: f64, part: f64) -> f64 {
    let before = low.sqrt();
    let y = part * (before + (end - low).sqrt()) - before;
    low + y * y.abs()
}

fn row3(v: DVec3, w: f64) -> [f32; 4] {
    // A medium that no file could hold must not put a NaN into the tables.
    [v.x, v.y, v.z, w].map(|x| if x.is_finite() { narrow(x) } else { 0.0 })
}

fn path_rows(medium: &Medium, series: &[Series], from_m: f64, direction: &Direction, hits: bool, rows: &mut Vec<[f32; 4]>) {
    let (bottom, top) = (medium.bottom_radius_m, medium.top_altitude_m);
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
    let at = rows.len();
    rows.resize(at + HEAD_ROWS, [0.0; 4]);
    let mut through = DVec3::ONE;
    for i in 0..STEPS {
        let (from, to) = (step_at(low, end, i as f64 / STEPS as f64), step_at(low, end, (i + 1) as f64 / STEPS as f64));
        let (length, s) = (to - from, 0.5 * (from + to));
        let mut extinction = DVec3::ZERO;
        let mut scattered = [DVec3::ZERO; DEGREE + 1];
        let mut total = DVec3::ZERO;
        for (layer, series) in medium.layers.iter().zip(series) {
            // Two Gauss points.
            let density = 0.5
                * [0.211_324_865_405, 0.788_675_134_595].map(|x| layer.profile.density(altitude(from + x * length))).iter().sum::<f64>();
            let scattering = layer.scattering_per_m.as_dvec3() * density;
            extinction += scattering * (1.0 - series.forward) + layer.absorption_per_m.as_dvec3() * density;
            total += scattering;
            scattered.iter_mut().zip(&series.chi).for_each(|(sum, x)| *sum += scattering * *x);
        }
        let depth = extinction * length;
        let kept = depth.to_array().map(|x| libm::exp(-x));
        // ∫ e^(−σs) ds over the step, in front of it the way to the eye.
        let arrives = DVec3::from_array(
            [0, 1, 2].map(|c| if depth[c] > 1e-4 { (1.0 - kept[c]) / extinction[c] } else { length * (1.0 - 0.5 * depth[c]) }),
        ) * through;
        let h = altitude(s);
        let (sine, cosine) = dip(bottom, h.max(0.0));
        let place = (h / top).clamp(0.0, 1.0).sqrt() * (ALTITUDES - 1) as f64;
        let radius = bottom + h;
        rows.push(row3(DVec3::new(r, s, slope + s) / radius, h));
        rows.push(row3(DVec3::new(place, sine, cosine), 0.0));
        rows.push(row3(total * arrives, 0.0));
        rows.extend(scattered.iter().map(|x| row3(*x * arrives, 0.0)));
        through *= DVec3::from_array(kept);
    }
    let weight = direction.weight * direction.cosine.max(0.0);
    let ground = if hits { through * medium.ground_albedo.as_dvec3() / PI } else { DVec3::ZERO };
    if let [first, second, ..] = &mut rows[at..] {
        *first = row3(DVec3::new(direction.cosine, r / bottom, end / bottom), weight);
        *second = row3(ground, 0.0);
    }
}

/// Normalised associated Legendre functions at a cosine, by order m and degree l: Σ_m over their products is (2l+1)/4π P_l.
fn legendre(cosine: f64) -> [[f64; DRAWN_DEGREE + 1]; MODES] {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let mut out = [[0.0; DRAWN_DEGREE + 1]; MODES];
    let mut diagonal = 1.0 / (4.0 * PI).sqrt();
    for (m, of_mode) in out.iter_mut().enumerate() {
        let order = m as f64;
        if m > 0 {
            diagonal *= sine * ((2.0 * order + 1.0) / (2.0 * order)).sqrt();
        }
        let (mut last, mut p) = (0.0, diagonal);
        for (l, slot) in of_mode.iter_mut().enumerate().skip(m) {
            *slot = p;
            let next = l as f64 + 1.0;
            let a = ((4.0 * next * next - 1.0) / (next * next - order * order)).sqrt();
            let b = (((next - 1.0) * (next - 1.0) - order * order) / (4.0 * (next - 1.0) * (next - 1.0) - 1.0)).max(0.0).sqrt();
            (last, p) = (p, a * (cosine * p - b * last));
        }
    }
    out
}

/// The layers' coefficients, mixed by what each scatters around a row of altitude: as much as interpolation between rows gives this one.
/// For the next order, and for what is drawn.
fn mixed(medium: &Medium, series: &[Series], row: usize) -> ([DVec3; DEGREE + 1], [DVec3; DRAWN_DEGREE + 1]) {
    const PARTS: i32 = 8;
    let (mut mix, mut full) = ([DVec3::ZERO; DEGREE + 1], [DVec3::ZERO; DRAWN_DEGREE + 1]);
    let mut total = DVec3::splat(1e-300);
    for k in -PARTS..=PARTS {
        let x = (row as f64 + f64::from(k) / f64::from(PARTS)) / (ALTITUDES - 1) as f64;
        if !(0.0..=1.0).contains(&x) {
            continue;
        }
        // The hat function, by the width in altitude; the row itself always has its say.
        let weight = f64::from(PARTS - k.abs()) * x + if k == 0 { 1e-9 } else { 0.0 };
        for (layer, series) in medium.layers.iter().zip(series) {
            let scattering = layer.scattering_per_m.as_dvec3() * (layer.profile.density(x * x * medium.top_altitude_m) * weight);
            total += scattering;
            mix.iter_mut().zip(&series.chi).for_each(|(sum, x)| *sum += scattering * *x);
            full.iter_mut().zip(&series.full).for_each(|(sum, x)| *sum += scattering * *x);
        }
    }
    (mix.map(|sum| sum / total), full.map(|sum| sum / total))
}

/// Kernels of an altitude, for the next order and for what is drawn.
fn kernel_rows(medium: &Medium, series: &[Series], row: usize, directions: &[Direction], rows: [&mut Vec<[f32; 4]>; 2]) {
    let (mix, full) = mixed(medium, series, row);
    let arriving: Vec<_> = directions.iter().map(|d| legendre(d.cosine)).collect();
    let [next, drawn] = rows;
    for view in 0..VIEWS {
        let leaving = legendre(2.0 * view as f64 / (VIEWS - 1) as f64 - 1.0);
        let kernel = |mix: &[DVec3], direction: &Direction, arriving: &[[f64; DRAWN_DEGREE + 1]; MODES]| {
            let mut modes = [DVec3::ZERO; MODES];
            for (m, sum) in modes.iter_mut().enumerate() {
                // cos mφ stands for both of ±m.
                let weight = direction.weight * if m > 0 { 2.0 } else { 1.0 };
                for (l, mix) in mix.iter().enumerate() {
                    *sum += *mix * (leaving[m][l] * arriving[m][l] * weight);
                }
            }
            modes
        };
        let both = || directions.iter().zip(&arriving);
        // To this degree the directions are no exact quadrature: all the light is kept by a factor.
        let kept: DVec3 = both().map(|(d, a)| kernel(&full, d, a)[0]).sum();
        let scale = full[0] / kept.max(0.5 * full[0]).max(DVec3::splat(1e-300));
        for (direction, arriving) in both() {
            let channels = |modes: [DVec3; MODES]| [0, 1, 2].map(|c| modes.map(|x| if x[c].is_finite() { narrow(x[c]) } else { 0.0 }));
            next.extend(channels(kernel(&mix, direction, arriving)));
            drawn.extend(channels(kernel(&full, direction, arriving).map(|x| x * scale)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::medium::tests::earth;
    use crate::air::{Layer, Phase, Profile};
    use glam::Vec3;

    #[test]
    fn directions_cover_the_sphere() {
        for altitude_m in [0.0, 1e3, 59e3] {
            let all: f64 = directions(&earth(), altitude_m).iter().map(|d| d.weight).sum();
            let up: f64 = directions(&earth(), 0.0).iter().map(|d| d.weight * d.cosine.max(0.0)).sum();
            assert!((all / (4.0 * PI) - 1.0).abs() < 1e-6, "{all}");
            assert!((up / PI - 1.0).abs() < 1e-6, "{up}");
        }
    }

    #[test]
    fn turning_keeps_all_the_light_and_the_phase_function_s_shape() {
        // A uniform field of 1 comes out as 1; a beam comes out as the phase function, as far as the series goes.
        let plan = Plan::new(&earth());
        assert_eq!(plan.rows.len(), ROWS);
        for altitude in [0, 7, 15] {
            for view in 0..VIEWS {
                let at = KERNELS_AT + (altitude * VIEWS + view) * DIRECTIONS * 3;
                for c in 0..3 {
                    let sum: f32 = (0..DIRECTIONS).map(|d| plan.rows[at + d * 3 + c][0]).sum();
                    // The sum over these directions is a quadrature: at the ground it loses 1.2e-3 of the light.
                    assert!((sum - 1.0).abs() < 2e-3, "row {altitude}, view {view}: {sum}");
                }
            }
        }
        for (a, b) in [(0.3, 0.9), (-0.7, 0.2), (1.0, -0.4)] {
            let (x, y) = (legendre(a), legendre(b));
            // By the addition theorem at φ = 0 and up to degree 3, where no mode is missing.
            let turn: f64 = (0..4).map(|l| (0..MODES).map(|m| x[m][l] * y[m][l] * if m > 0 { 2.0 } else { 1.0 }).sum::<f64>()).sum();
            let cos = a * b + ((1.0 - a * a) * (1.0 - b * b)).sqrt();
            let p = [1.0, cos, 0.5 * (3.0 * cos * cos - 1.0), 0.5 * (5.0 * cos * cos * cos - 3.0 * cos)];
            let series: f64 = p.iter().enumerate().map(|(l, p)| (2 * l + 1) as f64 / (4.0 * PI) * p).sum();
            assert!((turn - series).abs() < 1e-12, "{turn} {series}");
        }
    }

    #[test]
    fn light_along_a_direction_is_what_transmittance_leaves() {
        // A source of 1 per unit of extinction everywhere sends 1 − T: without absorption and with the ground black the steps must add up to it.
        let mut medium = earth();
        medium.layers.iter_mut().for_each(|l| l.absorption_per_m = Vec3::ZERO);
        let plan = Plan::new(&medium);
        let down = UP * PATH_ROWS; // from the datum: no way at all
        assert_eq!(plan.rows[down + HEAD_ROWS + 2][0], 0.0);
        let from_top = ((ALTITUDES - 1) * DIRECTIONS + DIRECTIONS - 1) * PATH_ROWS;
        let blue: f32 = (0..STEPS).map(|i| plan.rows[from_top + HEAD_ROWS + i * STEP_ROWS + 2][2]).sum();
        let ground = f64::from(plan.rows[from_top + 1][2]) * PI / 0.1;
        assert!((f64::from(blue) + ground - 1.0).abs() < 1e-5, "{blue} {ground}");
        // Nearly straight down through all of it.
        let cosine = f64::from(plan.rows[from_top][0]);
        let depth = 33.1e-6 * 8000.0 * (1.0 - libm::exp(-7.5)) + 3.996e-6 * 1200.0;
        assert!((ground - libm::exp(-depth / -cosine)).abs() < 3e-3, "{ground} {cosine}");
    }

    #[test]
    fn no_medium_makes_a_nan() {
        let layer = |s: f32, profile, phase| Layer { scattering_per_m: Vec3::splat(s), absorption_per_m: Vec3::ZERO, profile, phase };
        for (radius, top) in [(1e3, 1e6), (1e3, 100.0), (1e8, 100.0), (6.4e6, 1e6)] {
            for layers in [
                Vec::new(),
                vec![layer(0.0, Profile::Exponential { scale_height_m: 10.0 }, Phase::HenyeyGreenstein { g: -0.99 })],
                vec![layer(1.0, Profile::Constant { bottom_m: 0.0, top_m: 50.0 }, Phase::CornetteShanks { g: 0.99 }); 6],
            ] {
                let medium = Medium { bottom_radius_m: radius, top_altitude_m: top, ground_albedo: Vec3::ONE, layers };
                let plan = Plan::new(&medium);
                assert!(plan.rows.iter().flatten().all(|x| x.is_finite()));
                let map = SunMap::new(&medium);
                assert!(map.scale > 0.0 && map.low > 0.0 && map.inverse > 0.0 && map.inverse.is_finite());
            }
        }
    }

    #[test]
    fn thicker_air_takes_more_orders() {
        let mut medium = earth();
        let mut found = Vec::new();
        for scale in [0.05, 1.0, 8.0, 20.0, 400.0] {
            medium.layers[0].scattering_per_m = Vec3::new(5.802e-6, 13.558e-6, 33.1e-6) * scale;
            found.push(orders(&medium));
        }
        assert_eq!(found, [4, 4, 5, 6, MAX_ORDERS]);
    }
}
