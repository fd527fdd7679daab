//! Light in air so deep that it is scattered hundreds of times: discrete ordinates, which take the place of the orders.
//!
//! A sum of orders needs about as many as light is scattered; where the air is deep they are too many, and rows and steps lie many free paths
//! apart. There the equation of transfer itself is solved, in level layers as fine as light changes in them: 16 streams [Chandrasekhar 1950, "Radiative
//! Transfer", chapter II; Stamnes et al. 1988, Applied Optics 27], each Fourier mode of the azimuth by itself, elimination from the ground up
//! ([`solve`]), for all suns of the table at once. The planet's roundness is in the way of the beam alone. Peaks are cut off as in [`super::forward`].
//!
//! [`rows`] are the table of further orders and the sky's illuminance themselves. Which channels have them, and to which share, [`share`] tells.

pub mod basis;
pub mod column;
pub mod solve;

use super::orders::{ALTITUDES, MODES, SUNS, SunMap, VIEWS, row3, view_cosine};
use super::sun_map::dip;
use crate::air::{Class, Classes, Medium};
use crate::space::relative::narrow;
use basis::{Basis, TERMS, harmonics};
use column::Column;
use core::f64::consts::PI;
use glam::DVec3;
use rayon::prelude::*;
use solve::{Scatterer, light};

/// Rows of the solution in a plan: the channels' shares, then by altitude, view and sun the modes of red, of green, of blue, then by altitude and sun the illuminance of
/// level ground by the sky.
pub const ROWS: usize = 1 + ALTITUDES * VIEWS * SUNS * 3 + ALTITUDES * SUNS;
/// Transport depths of scattering between which the solution takes the place of the orders.
const DEEP: [f64; 2] = [1.5, 3.0];
/// Transport depths from above between which the skin lies, and angles by which the horizon dips over its height, rad, between which an air becomes too round.
const SKIN: [f64; 2] = [0.3, 1.0];
/// See [`SKIN`].
const ROUND: [f64; 2] = [0.1, 0.18];

/// What scatters at an altitude, by how far it turns light, m⁻¹; and the same with what absorbs.
pub fn transport(medium: &Medium, classes: &[Class], altitude_m: f64) -> [DVec3; 2] {
    let mut found = [DVec3::ZERO, medium.extinction(altitude_m)];
    for class in classes {
        let chi = class.legendre(1);
        let scattered = class.scattering(medium, altitude_m);
        found[0] += scattered * (chi[0] - chi[1]);
        found[1] -= scattered * chi[1].max(0.0);
    }
    found.map(|x| x.max(DVec3::ZERO))
}

/// Share of the solution in each channel, the orders having the rest. None where an air's skin is so high that its roundness tells: there light comes
/// from beyond the horizon, by day to dusk.
pub fn share(medium: &Medium, classes: &[Class]) -> DVec3 {
    const PARTS: i32 = 64;
    let mut depth = DVec3::ZERO;
    let mut skin_m = 0.0;
    for i in (0..PARTS).rev() {
        let x = (f64::from(i) + 0.5) / f64::from(PARTS);
        let height = medium.top_altitude_m * 2.0 * x / f64::from(PARTS);
        depth += transport(medium, classes, x * x * medium.top_altitude_m)[0] * height;
        if (SKIN[0]..SKIN[1]).contains(&depth.max_element()) {
            skin_m += height;
        }
    }
    let smooth = |x: DVec3| {
        let x = x.clamp(DVec3::ZERO, DVec3::ONE);
        x * x * (3.0 - 2.0 * x)
    };
    let dip = (2.0 * skin_m / medium.bottom_radius_m).sqrt();
    let round = smooth(DVec3::splat((dip - ROUND[0]) / (ROUND[1] - ROUND[0])));
    smooth((depth - DEEP[0]) / (DEEP[1] - DEEP[0])) * (1.0 - round)
}

/// What one mode of one channel says: the mode of the source function by altitude, view and sun; and the sky's illuminance by altitude and sun.
struct Found {
    source: Vec<f64>,
    lit: Vec<f64>,
}

/// The solution of a column: [`ROWS`]. `altitudes` are those of the table, m, `shares` is what each class scatters about each altitude of the table, as a share of all.
pub(super) fn rows(column: &Column<'_>, share: DVec3, altitudes: &[f64], shares: &[[DVec3; Classes::MAX]]) -> Vec<[f32; 4]> {
    let medium = column.medium;
    let map = SunMap::new(medium);
    let suns: Vec<f64> = (0..SUNS).map(|k| map.mu(dip(medium.bottom_radius_m, 0.0), k)).collect();
    let beams: Vec<_> = suns.iter().map(|mu| column.beams(*mu)).collect();
    // By altitude and sun of the table: which of the suns above lie around it.
    let between: Vec<Vec<(usize, f64)>> =
        altitudes.iter().map(|h| (0..SUNS).map(|k| place(&suns, map.mu(dip(medium.bottom_radius_m, *h), k))).collect()).collect();
    let jobs: Vec<(usize, usize)> = (0..3).filter(|c| share[*c] > 0.0).flat_map(|c| (0..MODES).map(move |m| (c, m))).collect();
    let solved: Vec<((usize, usize), Found)> = jobs
        .into_par_iter()
        .map(|(c, m)| {
            let beam: Vec<Vec<f64>> = beams.iter().map(|b| b.0[c].clone()).collect();
            let on_ground: Vec<f64> = beams.iter().map(|b| b.1[c]).collect();
            let shares: Vec<[f64; Classes::MAX]> = shares.iter().map(|s| s.map(|s| s[c])).collect();
            ((c, m), of_mode(column, (c, m), &suns, (&beam, &on_ground), (altitudes, &between, &shares)))
        })
        .collect();
    let mut source = vec![[0.0_f32; 4]; ALTITUDES * VIEWS * SUNS * 3];
    let mut lit = vec![DVec3::ZERO; ALTITUDES * SUNS];
    for ((c, m), found) in solved {
        for (i, value) in found.source.iter().enumerate() {
            source[i * 3 + c][m] = if value.is_finite() { narrow(*value) } else { 0.0 };
        }
        lit.iter_mut().zip(&found.lit).for_each(|(sum, x)| sum[c] += x);
    }
    // Sunlight that peaks have turned is of the sky, but in no mode.
    for (row, h) in altitudes.iter().enumerate() {
        for k in 0..SUNS {
            let mu = map.mu(dip(medium.bottom_radius_m, *h), k);
            let [beam, whole] = column.sunlight(*h, mu);
            lit[row * SUNS + k] += (beam - whole) * mu.max(0.0);
        }
    }
    let mut rows = Vec::with_capacity(ROWS);
    rows.push(row3(share, 0.0));
    rows.append(&mut source);
    rows.extend(lit.into_iter().map(|x| row3(x.max(DVec3::ZERO), 0.0)));
    rows
}

/// Where a value lies between rising ones: the lower's number, and the part of the way to the next, both within.
fn place(all: &[f64], x: f64) -> (usize, f64) {
    let low = all.partition_point(|a| *a <= x).clamp(1, all.len() - 1) - 1;
    (low, ((x - all[low]) / (all[low + 1] - all[low]).max(1e-300)).clamp(0.0, 1.0))
}

/// Shares of two values around a place between them, where in the dusk light falls by a factor from one to the next: such that their fourth roots are even.
fn falling(values: [f64; 2], part: f64) -> [f64; 2] {
    let even = [1.0 - part, part];
    let linear = values[0] * even[0] + values[1] * even[1];
    let root = |x: f64| x.max(0.0).sqrt().sqrt();
    let mean = root(values[0]) * even[0] + root(values[1]) * even[1];
    let by = if linear > 1e-300 { mean * mean * mean * mean / linear } else { 1.0 };
    even.map(|x| x * by)
}

type Sunlit<'a> = (&'a [Vec<f64>], &'a [f64]);
type Table<'a> = (&'a [f64], &'a [Vec<(usize, f64)>], &'a [[f64; Classes::MAX]]);

fn of_mode(
    column: &Column<'_>,
    (channel, mode): (usize, usize),
    suns: &[f64],
    (beam, on_ground): Sunlit<'_>,
    (altitudes, between, shares): Table<'_>,
) -> Found {
    let basis = Basis::new(mode);
    let classes: Vec<Scatterer> = column
        .classes
        .iter()
        .map(|class| Scatterer {
            kernels: [false, true].map(|odd| basis.kernel(&class.chi, odd)),
            of_beam: suns.iter().map(|mu| [false, true].map(|odd| basis.of_beam(&class.chi, *mu, odd))).collect(),
        })
        .collect();
    let albedo = f64::from(column.medium.ground_albedo[channel]);
    let found = light(&basis, &column.slabs(channel), &classes, albedo, beam, on_ground);
    let views: Vec<[f64; TERMS]> = (0..VIEWS).map(|view| harmonics(mode, view_cosine(view))).collect();
    let mut out = Found { source: Vec::with_capacity(ALTITUDES * VIEWS * SUNS), lit: Vec::new() };
    for ((h, between), shares) in altitudes.iter().zip(between).zip(shares) {
        let (i, f) = column.place(*h);
        let at: Vec<_> = found
            .iter()
            .map(|light| {
                let [sum, difference] = [0, 1].map(|kind| basis::plus(&light[i][kind].map(|x| x * (1.0 - f)), &light[i + 1][kind], f));
                let lit: f64 = (0..basis::STREAMS).map(|s| 2.0 * PI * basis.weight[s] * basis.mu[s] * (sum[s] + difference[s])).sum();
                (basis.moments(&sum, &difference), lit)
            })
            .collect();
        let factors: [f64; TERMS] = core::array::from_fn(|l| {
            let chi: f64 = column.classes.iter().zip(shares).map(|(class, share)| class.drawn[l] * share).sum();
            0.5 * (2 * l + 1) as f64 * chi
        });
        let of_suns: Vec<[f64; TERMS]> = between
            .iter()
            .map(|(k, f)| {
                let [a, b] = falling([*k, k + 1].map(|k| at[k].0.iter().map(|x| x.abs()).sum()), *f);
                core::array::from_fn(|l| factors[l] * (a * at[*k].0[l] + b * at[k + 1].0[l]))
            })
            .collect();
        for view in &views {
            out.source.extend(of_suns.iter().map(|s| s.iter().zip(view).map(|(s, y)| s * y).sum::<f64>()));
        }
        if mode == 0 {
            out.lit.extend(between.iter().map(|(k, f)| {
                let [a, b] = falling([at[*k].1, at[k + 1].1], *f);
                a * at[*k].1 + b * at[k + 1].1
            }));
        }
    }
    out
}
