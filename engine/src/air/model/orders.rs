//! Further orders of scattering: what their precomputation needs to know of a medium that does not depend on the sun.
//!
//! The light that reaches a point of an air after one or more scatterings, scattered there once more towards `v`, is the source function
//! `S(v) = ∫ p(v·ω) L(ω) dω` (p the mean phase function of the layers there, by their share of the scattering). It depends on altitude,
//! on the sun's height, on the zenith angle of `v` and on its azimuth φ from the sun; in φ it is even and smooth and is carried by its
//! first four Fourier modes: `S = S₀ + S₁ cos φ + S₂ cos 2φ + S₃ cos 3φ`, each a table over altitude × sun × view.
//!
//! One order follows from the one before in two steps, which `shaders/pass/air_orders.wgsl` takes for all texels at once:
//! - *gather*: along fixed directions from each altitude (Gauss–Legendre nodes in the zenith angle, dense at the horizon; azimuths dense
//!   towards the sun, in steps that [`super::paths`] lays) the
//!   source of the order before is added up step by step, ground included: the radiance `L`, by its Fourier modes in the azimuth;
//! - *turn*: `S_m(v) = Σ K_m(v, ω) L_m(ω)`, K the phase function's own modes in the azimuth between v and ω.
//!
//! Forward peaks are cut off first ([`super::forward`]): to the orders the light that they turn is sunlight still, or goes on along its
//! direction. For what is drawn a second set of kernels puts it back; forward lobes are integrated about the view ([`super::peaks`]).
//!
//! In deep air a solution of another kind takes the place of the orders ([`super::streams`]), over a range of depths by shares.
//!
//! Where the steps lie, how much light each lets through and the kernels K depend on the medium alone: [`Plan`] computes them here,
//! in f64, for any layers, profiles and phase functions, once for a medium.

use super::forward::Truncated;
use super::levels::Levels;
use super::paths::{self, Matter};
use super::peaks::{Around, Lobe};
use super::streams::{self, column::Column};
use super::sun_map::dip;
use crate::air::{Class, Classes, Medium};
use crate::space::relative::narrow;
use core::f64::consts::PI;
use glam::DVec3;

pub use super::sun_map::SunMap;

/// Heights of the sun in a table.
pub const SUNS: usize = 32;
/// Altitudes in a table: [`Levels`].
pub const ALTITUDES: usize = 16;
/// Zenith cosines of the view in a table: densest at the level, about which horizons lie and a peak's light changes most.
pub const VIEWS: usize = 20;
/// How far the first views lie from the level: tan(e/2) of the angle e by the coordinate there.
const NEAR: f64 = 0.6;
/// Directions from an altitude that leave the air, and that meet the ground.
pub const UP: usize = 12;
/// See [`UP`].
pub const DOWN: usize = 8;
/// All of them.
pub const DIRECTIONS: usize = UP + DOWN;
/// Steps along a direction.
pub const STEPS: usize = 16;
/// See [`peaked`].
const PEAKED: f64 = 0.01;
/// Degree to which the sum over the directions from an altitude is exact.
const EXACT: usize = 8;
/// Fourier modes in the azimuth.
pub const MODES: usize = 4;
/// Rows of four numbers that open a direction.
pub const HEAD_ROWS: usize = 2;
/// Rows of a step.
pub const STEP_ROWS: usize = 3 + Classes::MAX;
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

/// What the precomputation of a medium's further orders needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Rows of four numbers, [`ROWS`] of them. A direction, by altitude and from the horizon's side: (zenith cosine; radius and distance of where it ends, by
    /// the datum's radius; weight in the irradiance), (transmittance to the ground × albedo/π, rgb; 0), then its steps:
    /// (radius at the eye, distance, both by the radius at the step; zenith cosine; altitude, m), (table's row; sine and cosine of the horizon's
    /// dip; 0), (share of the light of a unit source that arrives, rgb; 0), (the same of each class of layers).
    /// A kernel, by altitude, view and direction: the modes of red, of green, of blue. In deep air [`streams::ROWS`] more, or these alone.
    pub rows: Vec<[f32; 4]>,
    /// Orders to compute before they are combined; 0: none, and nothing of what they need is in the rows.
    pub orders: u32,
    /// Whether forward peaks turn so much light that azimuths must lie close.
    pub peaked: bool,
    /// Row at which the solution of deep air begins.
    pub deep: Option<u32>,
}

/// One direction from an altitude.
pub(super) struct Direction {
    pub(super) cosine: f64,
    /// Its solid angle, all azimuths together.
    pub(super) weight: f64,
    /// Root of the part of the way from the horizon to the zenith or the nadir.
    pub(super) part: f64,
}

/// The classes of a medium, whole and without their peaks.
fn classes(medium: &Medium) -> Vec<(Class, Truncated)> {
    let with = |class: Class| (Truncated::new(&class), class);
    Classes::of(medium).list.into_iter().map(with).map(|(truncated, class)| (class, truncated)).collect()
}

impl Plan {
    /// For a medium.
    pub fn new(medium: &Medium) -> Self {
        let classes = classes(medium);
        let share = streams::share(medium, &Classes::of(medium).list);
        let levels = Levels::new(medium);
        let mut plan = Self { rows: Vec::new(), orders: 0, peaked: peaked(medium, &classes), deep: None };
        if share.min_element() < 1.0 {
            plan.orders = orders(medium, share);
            plan.rows = rows(medium, &classes, &levels);
        }
        if share.max_element() > 0.0 {
            plan.deep = u32::try_from(plan.rows.len()).ok();
            let (altitudes, shares): (Vec<_>, Vec<_>) =
                (0..ALTITUDES).map(|row| (levels.altitude_m(row), shares(medium, &classes, &levels, row))).unzip();
            plan.rows.append(&mut streams::rows(&Column::new(medium, &classes), share, &altitudes, &shares));
        }
        plan
    }
}

/// All that the orders need.
fn rows(medium: &Medium, classes: &[(Class, Truncated)], levels: &Levels) -> Vec<[f32; 4]> {
    let mut rows = Vec::with_capacity(ROWS);
    let [mut kernels, mut drawn] = [(); 2].map(|()| Vec::with_capacity(DRAWN_AT - KERNELS_AT));
    let matter = Matter::new(medium, classes);
    let around: Vec<_> = (0..VIEWS).map(view_cosine).map(Around::new).collect();
    for row in 0..ALTITUDES {
        let altitude_m = levels.altitude_m(row);
        let directions = directions(medium, altitude_m);
        for (i, direction) in directions.iter().enumerate() {
            paths::rows(&matter, levels, altitude_m, direction, i >= UP, &mut rows);
        }
        let shares = shares(medium, classes, levels, row);
        kernel_rows(classes, shares, (&directions, horizon(medium, altitude_m)), &around, [&mut kernels, &mut drawn]);
    }
    rows.append(&mut kernels);
    rows.append(&mut drawn);
    rows
}

/// How many orders tell the sum of all: more where light is scattered more often before it leaves. Channels that the solution of deep air has to
/// the full do not ask for any.
fn orders(medium: &Medium, deep: DVec3) -> u32 {
    let mut depth = DVec3::ZERO;
    let n = 64;
    for layer in &medium.layers {
        for i in 0..n {
            let x = (f64::from(i) + 0.5) / f64::from(n);
            let width = 2.0 * x / f64::from(n) * medium.top_altitude_m;
            depth += layer.scattering_per_m.as_dvec3() * (layer.profile.density(x * x * medium.top_altitude_m) * width);
        }
    }
    let depth = (0..3).filter(|c| deep[*c] < 1.0).map(|c| depth[c]).fold(0.0, f64::max);
    [(0.5, 4), (3.0, 5), (8.0, 6)].into_iter().find(|(limit, _)| depth < *limit).map_or(MAX_ORDERS, |(_, n)| n)
}

/// Whether forward peaks scatter more than [`PEAKED`] of the light that crosses the air straight down.
fn peaked(medium: &Medium, classes: &[(Class, Truncated)]) -> bool {
    const PARTS: i32 = 64;
    let of_part = |i: i32| {
        let x = (f64::from(i) + 0.5) / f64::from(PARTS);
        let width = 2.0 * x / f64::from(PARTS) * medium.top_altitude_m;
        let scattered = |class: &Class| class.scattering(medium, x * x * medium.top_altitude_m).max_element();
        classes.iter().map(|(class, cut)| scattered(class) * cut.share * width).sum::<f64>()
    };
    (0..PARTS).map(of_part).sum::<f64>() > PEAKED
}

/// Nodes and weights of Gauss–Legendre quadrature on [0, 1].
pub(super) fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
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

/// Zenith angle of the horizon.
fn horizon(medium: &Medium, altitude_m: f64) -> f64 {
    let (sine, cosine) = dip(medium.bottom_radius_m, altitude_m);
    0.5 * PI + libm::atan2(sine, cosine)
}

/// The directions from an altitude: zenith angles as squares from the horizon, where the sky changes most.
pub(super) fn directions(medium: &Medium, altitude_m: f64) -> Vec<Direction> {
    let horizon = horizon(medium, altitude_m);
    let side = |n: usize, width: f64, sign: f64| {
        gauss_legendre(n).into_iter().map(move |(x, w)| {
            let (sin, cosine) = libm::sincos(horizon + sign * width * x * x);
            Direction { cosine, weight: 2.0 * PI * sin * w * 2.0 * x * width, part: x }
        })
    };
    let mut out: Vec<Direction> = side(UP, horizon, -1.0).chain(side(DOWN, PI - horizon, 1.0)).collect();
    corrected(&mut out);
    out
}

/// Changes weights by as little as makes them exact for polynomials of the cosine to degree [`EXACT`], and for the light on level ground.
fn corrected(directions: &mut [Direction]) {
    const N: usize = EXACT + 2;
    let functions = |cosine: f64| -> [f64; N] {
        let y = legendre(cosine);
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

pub(super) fn row3(v: DVec3, w: f64) -> [f32; 4] {
    // A medium that no file could hold must not put a NaN into the tables.
    [v.x, v.y, v.z, w].map(|x| if x.is_finite() { narrow(x) } else { 0.0 })
}

/// Zenith cosine of a table's view.
pub fn view_cosine(view: usize) -> f64 {
    let x = 2.0 * view as f64 / (VIEWS - 1) as f64 - 1.0;
    // tan(e/2) of the angle e from the level.
    let t = x * (NEAR + (1.0 - NEAR) * x.abs());
    2.0 * t / (1.0 + t * t)
}

/// Normalised Legendre functions of order 0 at a cosine, degree 0 to [`EXACT`].
fn legendre(cosine: f64) -> [f64; EXACT + 1] {
    let (mut last, mut p, mut l) = (0.0, 1.0, 0.0);
    [(); EXACT + 1].map(|()| {
        let found = p * ((2.0 * l + 1.0) / (4.0 * PI)).sqrt();
        (last, p) = (p, ((2.0 * l + 1.0) * cosine * p - l * last) / (l + 1.0));
        l += 1.0;
        found
    })
}

/// What each class scatters around a row of altitude, as much as interpolation between rows gives this one, as a share of all.
fn shares(medium: &Medium, classes: &[(Class, Truncated)], levels: &Levels, row: usize) -> [DVec3; Classes::MAX] {
    const PARTS: i32 = 8;
    let mut shares = [DVec3::ZERO; Classes::MAX];
    let place = |k: i32| levels.between_m(row as f64 + f64::from(k) / f64::from(2 * PARTS));
    for k in 1 - PARTS..PARTS {
        // The hat function, by the width in altitude; the row itself always has its say.
        let width = place(2 * k + 1) - place(2 * k - 1);
        let weight = f64::from(PARTS - k.abs()) * width + if k == 0 { 1e-9 } else { 0.0 };
        let at = |class: &Class| class.scattering(medium, place(2 * k)) * weight;
        shares.iter_mut().zip(classes).for_each(|(sum, (class, _))| *sum += at(class));
    }
    let total = shares.iter().sum::<DVec3>().max(DVec3::splat(1e-300));
    shares.map(|x| x / total)
}

/// Kernels of an altitude, for the next order and for what is drawn: how much of the light of a direction, by its modes in the azimuth, is
/// scattered towards a view. For what is drawn with the light that peaks turn.
fn kernel_rows(
    classes: &[(Class, Truncated)],
    shares: [DVec3; Classes::MAX],
    (directions, horizon): (&[Direction], f64),
    around: &[Around],
    [next, drawn]: [&mut Vec<[f32; 4]>; 2],
) {
    const AZIMUTHS: usize = 24;
    let used: Vec<_> = classes.iter().zip(shares).filter(|(_, share)| share.max_element() > 1e-6).collect();
    let lobes: Vec<_> = used.iter().map(|((class, truncated), _)| Lobe::new(class, truncated)).collect();
    let modes: Vec<(f64, [f64; MODES])> = (0..AZIMUTHS)
        .map(|i| {
            let turn = PI * (i as f64 + 0.5) / AZIMUTHS as f64;
            (libm::cos(turn), core::array::from_fn(|m| libm::cos(m as f64 * turn) / AZIMUTHS as f64 * if m > 0 { 2.0 } else { 1.0 }))
        })
        .collect();
    for (view, around) in around.iter().enumerate() {
        let cosine = view_cosine(view);
        let mut kernels = vec![[[DVec3::ZERO; MODES]; 2]; directions.len()];
        for (((class, truncated), share), lobe) in used.iter().zip(&lobes) {
            let (foot, with_peak) = lobe.as_ref().map_or((truncated.cap, 0.0), |lobe| (lobe.foot, lobe.light));
            let mut found = vec![[0.0; MODES]; directions.len()];
            for (direction, found) in directions.iter().zip(&mut found) {
                let across = ((1.0 - cosine * cosine) * (1.0 - direction.cosine * direction.cosine)).max(0.0).sqrt();
                for (turn, modes) in &modes {
                    let mu = (cosine * direction.cosine + across * turn).clamp(-1.0, 1.0);
                    let value = direction.weight * class.value(mu).min(foot);
                    found.iter_mut().zip(modes).for_each(|(sum, m)| *sum += value * m);
                }
            }
            // The sums over directions are not exact: all the light is kept by a factor.
            let rest = (truncated.left + truncated.share - with_peak).max(0.0) / found.iter().map(|f| f[0]).sum::<f64>().max(1e-9);
            let lobes = lobe.as_ref().map(|lobe| lobe.kernel(around, directions, horizon));
            for (i, (kernels, found)) in kernels.iter_mut().zip(&found).enumerate() {
                for (k, kernel) in kernels.iter_mut().enumerate() {
                    for (m, sum) in kernel.iter_mut().enumerate() {
                        *sum += *share * (rest * found[m] + lobes.as_ref().map_or(0.0, |lobes| lobes[i][k][m]));
                    }
                }
            }
        }
        let channels = |modes: [DVec3; MODES]| [0, 1, 2].map(|c| modes.map(|x| if x[c].is_finite() { narrow(x[c]) } else { 0.0 }));
        for [without, with] in kernels {
            next.extend(channels(without));
            drawn.extend(channels(with));
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

    /// Sums over the directions of the kernels that begin at a row, in the mean over azimuths.
    fn kept(plan: &Plan, from: usize, altitude: usize, view: usize, c: usize) -> f32 {
        let at = from + (altitude * VIEWS + view) * DIRECTIONS * 3;
        (0..DIRECTIONS).map(|d| plan.rows[at + d * 3 + c][0]).sum()
    }

    #[test]
    fn turning_keeps_all_the_light_but_what_goes_straight_on() {
        // A uniform field of 1 comes out as 1 where it is drawn, and for the next order without what peaks leave as it is.
        let plan = Plan::new(&earth());
        assert_eq!(plan.rows.len(), ROWS);
        let aerosol = Truncated::new(&Classes::of(&earth()).list[1]).share;
        for altitude in [0, 7, 15] {
            let of_aerosol = shares(&earth(), &classes(&earth()), &Levels::new(&earth()), altitude)[1];
            for view in 0..VIEWS {
                for c in 0..3 {
                    let (next, drawn) = (kept(&plan, KERNELS_AT, altitude, view, c), kept(&plan, DRAWN_AT, altitude, view, c));
                    let left = 1.0 - aerosol * of_aerosol[c];
                    assert!((f64::from(next) - left).abs() < 1e-4, "row {altitude}, view {view}: {next} not {left}");
                    assert!((drawn - 1.0).abs() < 1e-4, "row {altitude}, view {view}: {drawn}");
                }
            }
        }
    }

    #[test]
    fn light_is_turned_by_the_phase_function() {
        // Rayleigh's: of a field cos² of the zenith angle, 7 + cos² of its 20th parts come out: χ₂ is a tenth.
        let mut medium = earth();
        medium.layers.truncate(1);
        let plan = Plan::new(&medium);
        for altitude in [0, 9] {
            let directions = directions(&medium, Levels::new(&medium).altitude_m(altitude));
            for view in 0..VIEWS {
                let at = DRAWN_AT + (altitude * VIEWS + view) * DIRECTIONS * 3;
                let found: f64 =
                    directions.iter().enumerate().map(|(d, x)| f64::from(plan.rows[at + d * 3][0]) * x.cosine * x.cosine).sum();
                let c = view_cosine(view);
                let truth = 1.0 / 3.0 + 0.1 * (c * c - 1.0 / 3.0);
                assert!((found / truth - 1.0).abs() < 2e-3, "row {altitude}, view {view}: {found} {truth}");
            }
        }
    }

    #[test]
    fn light_along_a_direction_is_what_transmittance_leaves() {
        // A source of 1 per unit of extinction everywhere sends 1 − T: without absorption and with the ground black the steps must add up to it.
        let mut medium = earth();
        medium.layers.iter_mut().for_each(|l| (l.absorption_per_m, l.phase) = (Vec3::ZERO, Phase::Rayleigh));
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
            found.push(orders(&medium, DVec3::ZERO));
        }
        assert_eq!(found, [4, 4, 5, 6, MAX_ORDERS]);
    }
}
