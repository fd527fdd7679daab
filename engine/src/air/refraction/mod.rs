//! Refraction: the light that a planet's air bends into the planet's shadow, which makes an eclipsed moon red.
//!
//! A ray that grazes the limb is bent towards the planet, most where it passes lowest, and so fills the umbra; on the way it loses its
//! blue to the molecules, its orange to ozone. [`Limb`] follows such rays through one air, [`Limb::light`] adds them up for a place in the
//! shadow, [`shade`] keeps the sums in a table for the picture. Judged by [`super::reference::umbra`], which traces rays by their
//! differential equation and counts those that come from the sun.
//!
//! # The sum
//! Seen from the shadow at the distance D from the planet's centre, a ray of impact parameter p arrives from the angle β, `sin β = p/D`, off
//! the centre, and has set out from the angle `η = β − κ α(p)`, where α is its bending [Fjeldbo, Kliore & Eshleman 1971, "The Neutral
//! Atmosphere of Venus as Studied with the Mariner V Radio Occultation Experiments", eq. B6] and κ = S/(S + D) counts for a star at a
//! distance S. Radiance along a ray is kept but for what the air takes, so that the light is the sum over rings of the sky: transmittance × solid
//! angle of the ring × the share of its circle of sources that lies on the sun's disc. What other authors write as dilution by dispersion and as
//! the focus on the axis [Link 1969, "Eclipse Phenomena in Astronomy", §2; Vokrouhlický 1993; Mallama 1993] is the ratio of the solid angles.
//!
//! Left out: dispersion (n − 1 is taken at 550 nm: 1 % from red to blue), clouds and mountains at the limb, light scattered by the limb's air
//! (under 1e-6 of sunlight at the Moon), the flattening of the planet, limb darkening of the sun.

pub mod shade;

use super::model::Air;
use super::spectral::SpectralMedium;
use super::spectral::bands::channel_weights;
use super::{Layer, Medium, Phase, Profile};
use crate::light::occlusion::visible_behind_disc;
use crate::light::spectrum::{Spectrum, wavelength_nm};
use crate::units::NM;
use core::f64::consts::PI;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A gas that bends light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Refractive {
    /// Refractivity n − 1 at density 1.
    pub refractivity: f64,
    /// Density against altitude.
    pub profile: Profile,
}

/// Refractivity of a gas that scatters β per metre in the middle of the spectrum, as if it were Earth's air: both are proportional to
/// the density, 1.149e-5 m⁻¹ [Bucholtz 1995, table 3] and 2.778e-4 [Peck & Reeder 1972] at 550 nm, 15 °C, one atmosphere.
pub fn refractivity_of_scattering(beta_per_m: f64) -> f64 {
    2.778e-4 / 1.149e-5 * beta_per_m
}

impl Refractive {
    /// The gases of a medium of which no more is known than what it scatters: its Rayleigh layers.
    pub fn of_medium(medium: &Medium) -> Vec<Self> {
        let gases = medium.layers.iter().filter(|l| l.phase == Phase::Rayleigh && l.scattering_per_m.y > 0.0);
        gases
            .map(|l| Self { refractivity: refractivity_of_scattering(f64::from(l.scattering_per_m.y)), profile: l.profile.clone() })
            .collect()
    }
}

/// The star's light by wavelength, and what each layer of an air takes of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ByWavelength {
    /// Share of each wavelength in the channels of linear sRGB, and the extinction of each layer at density 1, m⁻¹.
    list: Vec<(DVec3, Vec<f64>)>,
}

impl ByWavelength {
    /// Of an air under a star.
    pub fn new(medium: &SpectralMedium, star: &Spectrum) -> Self {
        let shares = channel_weights(star);
        let wavelengths: Vec<f64> = (0..shares.len()).map(|i| wavelength_nm(i) * NM).collect();
        Self { list: shares.into_iter().zip(medium.at(&wavelengths)).map(|(share, at)| (share, at.extinction)).collect() }
    }

    /// Transmittance of columns of the layers, m at density 1.
    fn through(&self, columns: &[f64]) -> DVec3 {
        let one =
            |(share, extinction): &(DVec3, Vec<f64>)| *share * libm::exp(-columns.iter().zip(extinction).map(|(c, e)| c * e).sum::<f64>());
        self.list.iter().map(one).sum()
    }
}

/// Transmittance of columns of an air's layers, m at density 1: by all wavelengths, by its bands, or by its channels, whichever is known best.
fn through(air: &Air, columns: &[f64]) -> DVec3 {
    let of = |medium: &Medium| {
        let extinction = |l: &Layer| (l.scattering_per_m + l.absorption_per_m).as_dvec3();
        let depth: DVec3 = medium.layers.iter().zip(columns).map(|(l, c)| extinction(l) * *c).sum();
        DVec3::new(libm::exp(-depth.x), libm::exp(-depth.y), libm::exp(-depth.z))
    };
    match (&air.by_wavelength, &air.bands) {
        (Some(all), _) => all.through(columns),
        (None, Some(bands)) => bands.mix(|_, band| of(&band.medium)),
        (None, None) => of(&air.medium),
    }
}

/// n − 1 at an altitude.
pub fn refractivity(gases: &[Refractive], altitude_m: f64) -> f64 {
    gases.iter().map(|g| g.refractivity * g.profile.density(altitude_m)).sum()
}

/// Star and receiver of a shadow, as the planet stands to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behind {
    /// From the planet's centre to the star's, m.
    pub star_distance_m: f64,
    /// Radius of the star, m.
    pub star_radius_m: f64,
    /// From the planet's centre to the receiver, m; above the air.
    pub distance_m: f64,
}

impl Behind {
    /// Angular radius of the star at the receiver, were it right behind the planet, rad.
    pub fn sun_rad(&self) -> f64 {
        libm::asin((self.star_radius_m / (self.star_distance_m + self.distance_m)).min(1.0))
    }

    /// κ.
    fn lever(&self) -> f64 {
        self.star_distance_m / (self.star_distance_m + self.distance_m)
    }
}

/// A ray through the limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Graze {
    /// Altitude where it is lowest, m.
    pub altitude_m: f64,
    /// Impact parameter, m: n r where it is lowest.
    pub impact_m: f64,
    /// Angle by which it is bent towards the planet, rad.
    pub bend_rad: f64,
    /// Transmittance all the way through, linear sRGB under the star's own light.
    pub transmittance: DVec3,
}

/// The limb of a planet with air, as light passes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Limb {
    /// Radius of the datum, m.
    pub radius_m: f64,
    /// Rays by rising altitude, from the lowest that comes through to the top of the air.
    pub grazes: Vec<Graze>,
}

/// Rays that are followed: closer below, where air is dense.
const GRAZES: u32 = 192;
/// Points on each, from its lowest outwards.
const POINTS: u32 = 96;
/// A ray that brings less than this is taken for stopped.
const OPAQUE: f64 = 1e-9;
/// Least d(nr)/dr: lower, a ray runs around the planet and comes out anywhere.
const DUCT: f64 = 0.02;

impl Limb {
    /// That of an air; `None` where it has no layers.
    pub fn new(air: &Air) -> Option<Self> {
        let medium = &air.medium;
        if medium.layers.is_empty() {
            return None;
        }
        let mut grazes = Vec::new();
        // From the top down, as far as anything comes through.
        for i in (0..=GRAZES).rev() {
            let u = f64::from(i) / f64::from(GRAZES);
            let altitude_m = u * u * medium.top_altitude_m;
            let Some(graze) = graze(air, altitude_m).filter(|g| g.transmittance.max_element() > OPAQUE) else { break };
            grazes.push(graze);
        }
        grazes.reverse();
        (grazes.len() > 1).then_some(Self { radius_m: medium.bottom_radius_m, grazes })
    }

    /// Light of the star at `separation_rad` from the planet's centre, over that of the free disc, linear sRGB.
    pub fn light(&self, behind: &Behind, separation_rad: f64) -> DVec3 {
        sum(&self.rings(behind), behind.sun_rad(), separation_rad)
    }

    /// The rays as a receiver sees them.
    pub(super) fn rings(&self, behind: &Behind) -> Vec<Ring> {
        let lever = behind.lever();
        let ring = |g: &Graze| {
            let seen_rad = libm::asin((g.impact_m / behind.distance_m).min(1.0));
            Ring { seen_rad, source_rad: seen_rad - lever * g.bend_rad, transmittance: g.transmittance }
        };
        self.grazes.iter().map(ring).collect()
    }
}

/// A ray as a receiver sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// β.
    pub(super) seen_rad: f64,
    /// η; negative beyond the axis.
    pub(super) source_rad: f64,
    transmittance: DVec3,
}

/// Light that comes through all rings, and past them.
pub(super) fn sum(rings: &[Ring], sun_rad: f64, separation_rad: f64) -> DVec3 {
    // Share of the sun's disc within a circle about the planet's centre.
    let within = |radius_rad: f64| 1.0 - visible_behind_disc(sun_rad, radius_rad.abs(), separation_rad);
    // Solid angle between two circles, over 2π.
    let between = |a: f64, b: f64| 2.0 * libm::sin(0.5 * (a + b)) * libm::sin(0.5 * (b - a));
    // Share of the disc that a ring of sources brings, where its image has the solid angle `image`.
    let through = |from: f64, to: f64, image: f64| {
        let middle = 0.5 * (from + to).abs();
        let half = (0.5 * (to - from).abs()).max(1e-4 * sun_rad);
        let (inner, outer) = ((middle - half).max(0.0), middle + half);
        image * (within(outer) - within(inner)) / between(inner, outer)
    };
    let mut total = DVec3::ZERO;
    for pair in rings.windows(2) {
        let (a, b) = (&pair[0], &pair[1]);
        let (from, to) = (a.source_rad, b.source_rad);
        let nearest = if from * to < 0.0 { 0.0 } else { from.abs().min(to.abs()) };
        if nearest >= separation_rad + sun_rad || from.abs().max(to.abs()) <= separation_rad - sun_rad {
            continue;
        }
        let image = between(a.seen_rad, b.seen_rad);
        let share = if from * to < 0.0 {
            // The ring lies about the axis: its two parts are cut there.
            let part = from.abs() / (from.abs() + to.abs());
            through(0.0, from.abs(), image * part) + through(0.0, to.abs(), image * (1.0 - part))
        } else {
            through(from, to, image)
        };
        total += 0.5 * (a.transmittance + b.transmittance) * share;
    }
    let free = rings.last().map_or(1.0, |top| 1.0 - within(top.seen_rad));
    (total + DVec3::splat(free)).max(DVec3::ZERO)
}

/// Follows the ray whose lowest point lies at an altitude; `None` where there is no such ray.
///
/// With `t² = r − r₀` both integrals are smooth at the lowest point: `α = −2p ∫ n′/n dr/√(n²r² − p²)`, `τ = 2 ∫ β n r dr/√(n²r² − p²)`.
fn graze(air: &Air, altitude_m: f64) -> Option<Graze> {
    let medium = &air.medium;
    let nu = |h: f64| refractivity(&air.gases, h);
    let step_m = 1e-4 * medium.top_altitude_m;
    let slope = |h: f64| (nu(h + step_m) - nu(h - step_m)) / (2.0 * step_m);
    let r0 = medium.bottom_radius_m + altitude_m;
    let nu0 = nu(altitude_m);
    let impact_m = r0 * (1.0 + nu0);
    if 1.0 + nu0 + r0 * slope(altitude_m) < DUCT {
        return None;
    }
    let reach = (medium.top_altitude_m - altitude_m).max(0.0).sqrt();
    if reach <= 0.0 {
        return Some(Graze { altitude_m, impact_m, bend_rad: 0.0, transmittance: DVec3::ONE });
    }
    let mut bend_rad = 0.0;
    let mut columns = vec![0.0; medium.layers.len()];
    for i in 0..POINTS {
        let t = (f64::from(i) + 0.5) / f64::from(POINTS) * reach;
        let h = altitude_m + t * t;
        let (r, n) = (r0 + t * t, 1.0 + nu(h));
        // n r − p, without the difference of large numbers.
        let less = t * t + (nu(h) * r - nu0 * r0);
        if less <= 0.0 {
            return None;
        }
        let weight = 2.0 * t * reach / f64::from(POINTS) / (less * (n * r + impact_m)).sqrt();
        bend_rad -= 2.0 * impact_m * slope(h) / n * weight;
        for (column, layer) in columns.iter_mut().zip(&medium.layers) {
            *column += 2.0 * n * r * weight * layer.profile.density(h);
        }
    }
    Some(Graze { altitude_m, impact_m, bend_rad, transmittance: through(air, &columns) })
}

/// Bending by an isothermal gas of refractivity ν and scale height H at the lowest point, radius r: `ν √(2πr/H)`, for ν r ≪ H.
/// [Baum & Code 1953, "A Photometric Observation of the Occultation of σ Arietis by Jupiter", eq. 7]
pub fn bend_of_exponential_rad(refractivity: f64, radius_m: f64, scale_height_m: f64) -> f64 {
    refractivity * (2.0 * PI * radius_m / scale_height_m).sqrt()
}
