//! Relief: the ground of one body as a function of direction: map + fractal noise + craters + coast. `shaders/lib/height.wgsl`
//! is its twin, term for term; `tests/tests/height_twin.rs` holds the two together.
//!
//! # The function
//! With `p ∈ [0, 1]` (1 on high ground, 0 in maria), `b` the map's height less `depth (1 − p)`, `r` roughness (the map's slope and
//! height; `p` without a map) and `T = Σ gᵒ fₒ wₒ sₒ` the noise, where `sₒ` mixes gradient noise with its ridge, `wₒ` follows the sum so
//! far (heights are rougher than valleys, after the hybrid multifractal of [Musgrave 1994, ch. 16 of "Texturing and Modeling"]):
//! ```text
//! z = b + (plain + (amplitude − plain) r) T + (0.35 + 0.65 p) craters         the factor of T at most plain + 1.6 b where there is a coast
//! h = z                                                     without a coast
//! h = ±½ (√(z² + k²) ± z) ramp(±s)                          with a coast at signed distance s = map + wobble T (+ on land)
//! ```
//! so that land stays above the sea and sea below it whatever the noise does, and the shore is as sharp as `s`.
//!
//! # Level of detail
//! `fₒ` fades an octave out where a tile samples it too coarsely: 1 from 6 samples a wave, 0 at 3. Every octave has `f = 1` at
//! [`Relief::max_level`], where [`Relief::height_at_level`] is [`Relief::height_m`].

use super::crater::{CraterOctave, RADIUS_MAX, crater_octave};
use super::map::{ColourMap, CubeMap};
use super::noise::{gradient_noise, lattice_offset, split};
use super::spec::{Ground, NoiseSpec, ReliefSpec};
use crate::space::sphere::{direction_of_lat_lon, east_up_north, face_of};
use glam::DVec3;
use std::sync::Arc;

/// Most octaves of noise.
pub const NOISE_MAX: usize = 20;
/// Most octaves of craters.
pub const CRATER_MAX: usize = 34;
/// Octaves of the province noise.
pub const PROVINCES: usize = 7;
/// Samples along a tile's edge, as a power of two.
pub const SAMPLE_BITS: u32 = 6;
/// Width of the beach and shelf over which heights grow from the coast, m.
pub const RAMP_M: f64 = 8000.0;
/// Softness of the split into land and sea, m.
pub const SOFT_M: f64 = 20.0;
/// Noise on land is at most this many times the map's height, so that valleys end above the sea instead of in plates of it.
pub const VALLEY: f64 = 1.6;
/// How far the noise moves the coast, m.
pub const WOBBLE_M: f64 = 1500.0;
/// Slope of the map at which the ground is fully rough.
pub const ROUGH_SLOPE: f64 = 0.045;
/// Height of the map, m, at which it is.
pub const ROUGH_HEIGHT_M: f64 = 6000.0;

/// Why a relief cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReliefError {
    /// Keys out of range, one a line.
    #[error("{0}")]
    Ranges(String),
    /// A map that the spec names was not handed over.
    #[error("relief.{key} = \"{file}\": the file was not loaded")]
    Missing {
        /// Key in the spec.
        key: &'static str,
        /// File name.
        file: String,
    },
    /// A map file is damaged.
    #[error("cube map: {0}")]
    Map(String),
    /// The body's radius is unusable.
    #[error("radius_m = {0}: expected 1e3 … 1e9")]
    Radius(f64),
}

/// The files that a [`ReliefSpec`] names, read.
#[derive(Clone, Debug, Default)]
pub struct Maps {
    /// Heights above the datum, m.
    pub height: Option<Arc<CubeMap>>,
    /// Distance to the coast, m, positive on land.
    pub coast: Option<Arc<CubeMap>>,
    /// Colour.
    pub colour: Option<Arc<ColourMap>>,
    /// Lights at night.
    pub night: Option<Arc<ColourMap>>,
}

/// One octave of noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseOctave {
    /// Edge of a lattice cell, m.
    pub cell_m: f64,
    /// Weight in the sum, gᵒ.
    pub weight: f64,
    /// Seed of the hash.
    pub seed: u32,
    /// Shift of the lattice, cells.
    pub offset: DVec3,
}

/// The ground of one body. Cheap to clone; equal when spec, radius and maps are.
#[derive(Clone, Debug, Default)]
pub struct Relief {
    /// Radius of the datum sphere, m.
    pub radius_m: f64,
    /// True when everything below the datum is under water.
    pub has_water: bool,
    spec: ReliefSpec,
    maps: Maps,
    noise: Vec<NoiseOctave>,
    craters: Vec<CraterOctave>,
    provinces: Vec<NoiseOctave>,
    max_level: u8,
}

impl PartialEq for Relief {
    fn eq(&self, o: &Self) -> bool {
        let hash = |m: &Option<Arc<CubeMap>>| m.as_ref().map(|m| m.hash);
        self.radius_m == o.radius_m
            && self.spec == o.spec
            && hash(&self.maps.height) == hash(&o.maps.height)
            && hash(&self.maps.coast) == hash(&o.maps.coast)
    }
}

fn smooth(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Length of a face's edge through its middle, m.
fn edge_m(radius_m: f64) -> f64 {
    core::f64::consts::FRAC_PI_2 * radius_m
}

/// Weight of a feature of `wave_m` where samples lie `spacing_m` apart: 0 at three samples a wave, 1 from six.
pub fn fade(wave_m: f64, spacing_m: f64) -> f64 {
    if wave_m >= 6.0 * spacing_m {
        return 1.0;
    }
    (libm::log2(wave_m / spacing_m) - libm::log2(3.0)).clamp(0.0, 1.0)
}

/// Length of crater features in cells, for [`fade`]: a little under the mean diameter.
pub const CRATER_WAVE: f64 = 0.32;

/// What the terms of the height function come to at a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// Height above the datum, m.
    pub height_m: f64,
    /// 1 on high ground, 0 in low provinces.
    pub high: f64,
}

impl Relief {
    /// Builds the ground of a body of `radius_m` from what a modder wrote and the maps that it names.
    ///
    /// # Errors
    /// [`ReliefError`]: keys out of range, or a named map that `maps` does not hold.
    pub fn new(radius_m: f64, spec: ReliefSpec, maps: Maps) -> Result<Self, ReliefError> {
        if !(1e3..=1e9).contains(&radius_m) {
            return Err(ReliefError::Radius(radius_m));
        }
        spec.check()?;
        let named = [
            ("map", &spec.map, maps.height.is_some()),
            ("coast", &spec.coast, maps.coast.is_some()),
            ("colour", &spec.colour, maps.colour.is_some()),
        ];
        for (key, file, there) in named {
            if let (Some(file), false) = (file, there) {
                return Err(ReliefError::Missing { key, file: file.clone() });
            }
        }
        let mut max_level = 0_u8;
        while max_level < 21 && edge_m(radius_m) / (f64::from(1_u32 << max_level) * 32.0) > 1.0 {
            max_level += 1;
        }
        let finest_wave = 6.0 * edge_m(radius_m) / f64::from(1_u32 << max_level) / f64::from(1_u32 << SAMPLE_BITS);
        let mut relief = Self { radius_m, has_water: spec.water, max_level, ..Self::default() };
        if let Some(n) = &spec.noise {
            relief.noise = octaves(n.wavelength_m, n.gain, n.seed, finest_wave, NOISE_MAX);
        }
        if let Some(p) = &spec.provinces {
            relief.provinces = octaves(p.wavelength_m, 0.5, p.seed, finest_wave, PROVINCES);
        }
        if let Some(c) = &spec.craters {
            let mut cell_m = c.largest_radius_m / RADIUS_MAX;
            while relief.craters.len() < CRATER_MAX && cell_m * RADIUS_MAX >= c.smallest_radius_m && cell_m * CRATER_WAVE >= finest_wave {
                let index = u32::try_from(relief.craters.len()).unwrap_or(0);
                let typical_m = 0.18 * cell_m;
                relief.craters.push(CraterOctave {
                    cell_m,
                    depth_ratio: c.depth_ratio * libm::pow((c.complex_radius_m / typical_m).min(1.0), 0.7),
                    flat: smooth(0.5, 2.0, typical_m / c.complex_radius_m),
                    density: c.density,
                    seed: c.seed.wrapping_add(index.wrapping_mul(977)).wrapping_add(500_009),
                    offset: lattice_offset(index + 64, c.seed),
                });
                cell_m *= core::f64::consts::FRAC_1_SQRT_2;
            }
        }
        relief.spec = spec;
        relief.maps = maps;
        Ok(relief)
    }

    /// A smooth ball, dry or all water.
    pub fn smooth(radius_m: f64, has_water: bool) -> Self {
        Self { radius_m, has_water, spec: ReliefSpec { water: has_water, ..ReliefSpec::default() }, ..Self::default() }
    }

    /// What the modder wrote.
    pub fn spec(&self) -> &ReliefSpec {
        &self.spec
    }
    /// The maps.
    pub fn maps(&self) -> &Maps {
        &self.maps
    }
    /// How the ground looks.
    pub fn ground(&self) -> Ground {
        self.spec.ground
    }
    /// Octaves of noise, longest first.
    pub fn noise(&self) -> &[NoiseOctave] {
        &self.noise
    }
    /// Octaves of craters, largest first.
    pub fn craters(&self) -> &[CraterOctave] {
        &self.craters
    }
    /// Octaves of the province noise.
    pub fn provinces(&self) -> &[NoiseOctave] {
        &self.provinces
    }
    /// The finest level of tiles: quads of at most 1 m (up to a radius of about 43,000 km).
    pub fn max_level(&self) -> u8 {
        self.max_level
    }
    /// Distance between height samples of a tile of `level`, m.
    pub fn spacing_m(&self, level: u8) -> f64 {
        edge_m(self.radius_m) / (f64::from(1_u32 << level.min(31)) * f64::from(1_u32 << SAMPLE_BITS))
    }
    /// A bound on |height|, m, for culling.
    pub fn bound_m(&self) -> f64 {
        let s = &self.spec;
        let map = self.maps.height.as_ref().and_then(|m| m.mips.last().map(|c| (m, c))).map_or(0.0, |(m, coarse)| {
            let most = coarse.nodes.iter().map(|v| (m.offset + m.scale * f64::from(*v)).abs()).fold(0.0, f64::max);
            most + 4000.0
        });
        let noise = s.noise.as_ref().map_or(0.0, |n| 1.5 * n.amplitude_m.max(n.plain_amplitude_m));
        let craters = self.craters.iter().map(|c| 0.12 * c.cell_m * c.depth_ratio).sum::<f64>();
        map + noise + craters + s.provinces.as_ref().map_or(0.0, |p| p.depth_m)
    }

    /// Height of the ground above the datum, m, in full detail; `direction` is a unit vector in body-fixed axes. Sea floor is negative.
    pub fn height_m(&self, direction: DVec3) -> f64 {
        self.terms(direction, self.max_level).height_m
    }
    /// Height as a tile of `level` samples it: finer octaves are left out.
    pub fn height_at_level(&self, direction: DVec3, level: u8) -> f64 {
        self.terms(direction, level).height_m
    }
    /// Height of what one stands or splashes on: the ground, or the water's surface (0) above it.
    pub fn surface_m(&self, direction: DVec3) -> f64 {
        let h = self.height_m(direction);
        if self.has_water { h.max(0.0) } else { h }
    }
    /// Surface heights of many directions, m.
    pub fn surface_of(&self, directions: &[DVec3]) -> Vec<f64> {
        directions.iter().map(|d| self.surface_m(*d)).collect()
    }
    /// Surface heights, m, on a grid of `count × count` points `spacing_m` apart around `up`: row by row northwards, each eastwards.
    pub fn height_grid(&self, up: DVec3, spacing_m: f64, count: usize) -> Vec<f64> {
        let (east, up, north) = east_up_north(up);
        let middle = 0.5 * count.saturating_sub(1) as f64;
        let step = spacing_m / self.radius_m;
        let at = |i: usize, j: usize| (up + east * ((i as f64 - middle) * step) + north * ((j as f64 - middle) * step)).normalize_or(up);
        (0..count * count).map(|k| self.surface_m(at(k % count, k / count))).collect()
    }
    /// Unit normal of the surface, body-fixed axes, from differences over 2 m.
    pub fn normal(&self, direction: DVec3) -> DVec3 {
        let (east, up, north) = east_up_north(direction);
        let step = 1.0 / self.radius_m;
        let at = |axis: DVec3| self.surface_m((up + axis * step).normalize_or(up)) - self.surface_m((up - axis * step).normalize_or(up));
        (up - east * (0.5 * at(east)) - north * (0.5 * at(north))).normalize_or(up)
    }
    /// Height at a latitude and east longitude, rad.
    pub fn height_at_lat_lon(&self, lat: f64, lon: f64) -> f64 {
        self.height_m(direction_of_lat_lon(lat, lon))
    }

    /// The height function at `level`.
    pub fn terms(&self, direction: DVec3, level: u8) -> Terms {
        let spacing = self.spacing_m(level);
        let at = direction * self.radius_m;
        let mut high = 1.0;
        if let Some(p) = &self.spec.provinces {
            let mut sum = (0.5 - p.share) * 0.8_f64;
            for o in &self.provinces {
                let (c, f) = split(at / o.cell_m + o.offset);
                sum += o.weight * fade(o.cell_m, spacing) * gradient_noise(c, f, o.seed);
            }
            high = smooth(-0.1, 0.1, sum);
        }
        let depth = self.spec.provinces.as_ref().map_or(0.0, |p| p.depth_m);
        let (mut base, mut rough, mut coast) = (-depth * (1.0 - high), high, None);
        if let Some(map) = &self.maps.height {
            let (face, u, v) = face_of(direction);
            let bits = u32::from(level) + SAMPLE_BITS;
            let mip = map.mip_for(bits);
            let (value, steep) = map.sample(mip, face, u, v);
            let cell = edge_m(self.radius_m) / (map.cells() >> mip) as f64;
            let slope = steep / cell;
            base += value;
            rough = smooth(0.0, 1.0, slope / ROUGH_SLOPE + value.max(0.0) / ROUGH_HEIGHT_M);
            coast = self.maps.coast.as_ref().map(|c| c.sample(c.mip_for(bits), face, u, v).0);
        }
        let mut sum = 0.0_f64;
        let mut z = base;
        if let Some(n) = &self.spec.noise {
            for o in &self.noise {
                let f = fade(o.cell_m, spacing);
                if f <= 0.0 {
                    break;
                }
                let (c, frac) = split(at / o.cell_m + o.offset);
                sum += o.weight * f * shaped(gradient_noise(c, frac, o.seed), n) * (0.5 + sum).clamp(0.2, 1.2);
            }
            let mut amplitude = n.plain_amplitude_m + (n.amplitude_m - n.plain_amplitude_m) * rough;
            if coast.is_some() {
                amplitude = amplitude.min(n.plain_amplitude_m + VALLEY * base.max(0.0));
            }
            z += amplitude * sum;
        }
        let mut pits = 0.0;
        for o in &self.craters {
            let f = fade(o.cell_m * CRATER_WAVE, spacing);
            if f <= 0.0 {
                break;
            }
            let (c, frac) = split(at / o.cell_m + o.offset);
            pits += f * crater_octave(o, self.radius_m, c, frac, direction);
        }
        z += (0.35 + 0.65 * high) * pits;
        let height_m = coast.map_or(z, |s| shore(z, s + WOBBLE_M * sum));
        Terms { height_m, high }
    }
}

/// Gradient noise, or its ridge, or between.
fn shaped(n: f64, spec: &NoiseSpec) -> f64 {
    n + spec.ridged * (0.5 - 2.0 * n.abs() - n)
}

/// Height on either side of the coast at signed distance `s_m`.
pub fn shore(z: f64, s_m: f64) -> f64 {
    let root = (z * z + SOFT_M * SOFT_M).sqrt();
    let t = (s_m.abs() / RAMP_M).min(1.0);
    let ramp = t * (2.0 - t);
    // ½ (root − |z|) without cancellation.
    let small = 0.5 * SOFT_M * SOFT_M / (root + z.abs());
    let large = 0.5 * (root + z.abs());
    if s_m > 0.0 { ramp * if z > 0.0 { large } else { small } } else { -ramp * if z > 0.0 { small } else { large } }
}

fn octaves(wavelength_m: f64, gain: f64, seed: u32, finest_m: f64, most: usize) -> Vec<NoiseOctave> {
    let (mut list, mut cell_m, mut weight) = (Vec::new(), wavelength_m, 1.0);
    while list.len() < most && cell_m >= finest_m {
        let index = u32::try_from(list.len()).unwrap_or(0);
        list.push(NoiseOctave { cell_m, weight, seed: seed.wrapping_add(index.wrapping_mul(131)), offset: lattice_offset(index, seed) });
        cell_m *= 0.5;
        weight *= gain;
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::spec::{CraterSpec, ProvinceSpec};

    fn moon() -> Relief {
        let spec = ReliefSpec {
            ground: Ground::Regolith,
            noise: Some(NoiseSpec { wavelength_m: 2e5, amplitude_m: 900.0, plain_amplitude_m: 90.0, gain: 0.48, ridged: 0.2, seed: 5 }),
            craters: Some(CraterSpec {
                largest_radius_m: 1e5,
                smallest_radius_m: 2.0,
                density: 0.8,
                depth_ratio: 0.2,
                complex_radius_m: 7500.0,
                seed: 9,
            }),
            provinces: Some(ProvinceSpec { wavelength_m: 2.5e6, depth_m: 1500.0, share: 0.3, albedo_ratio: 0.5, seed: 2 }),
            ..ReliefSpec::default()
        };
        Relief::new(1.7374e6, spec, Maps::default()).unwrap()
    }

    #[test]
    fn full_detail_is_the_finest_level_and_coarser_levels_converge_to_it() {
        let m = moon();
        let d = direction_of_lat_lon(0.2, 1.3);
        assert_eq!(m.height_m(d), m.height_at_level(d, m.max_level()));
        assert!(m.spacing_m(m.max_level()) <= 0.5);
        let error = |level: u8| {
            let e = (0..40).map(|i| {
                let d = direction_of_lat_lon(0.02 * f64::from(i) - 0.4, 0.11 * f64::from(i));
                (m.height_at_level(d, level) - m.height_m(d)).abs()
            });
            e.fold(0.0, f64::max)
        };
        let (coarse, middle, fine) = (error(3), error(9), error(15));
        assert!(coarse > 4.0 * middle && middle > 4.0 * fine && fine < 3.0, "{coarse} {middle} {fine}");
    }

    #[test]
    fn land_stays_dry_and_sea_stays_wet() {
        for z in [-9000.0, -5.0, 0.0, 3.0, 8000.0] {
            assert!(shore(z, 500.0) > 0.0 && shore(z, -500.0) < 0.0 && shore(z, 0.0) == 0.0);
        }
        assert!((shore(4810.0, 2e4) - 4810.0).abs() < 0.1 && (shore(-10_900.0, -2e4) + 10_900.0).abs() < 0.1);
    }

    #[test]
    fn all_wrong_keys_are_told_at_once() {
        let mut spec = moon().spec().clone();
        if let Some(n) = &mut spec.noise {
            n.gain = 1.5;
            n.ridged = f64::NAN;
        }
        let told = Relief::new(1e6, spec, Maps::default()).unwrap_err().to_string();
        assert!(told.contains("noise.gain = 1.5") && told.contains("noise.ridged = NaN"), "{told}");
        let named = ReliefSpec { map: Some("h.cube".to_owned()), ..ReliefSpec::default() };
        assert!(Relief::new(1e6, named, Maps::default()).unwrap_err().to_string().contains("h.cube"));
    }

    #[test]
    fn the_normal_leans_away_from_higher_ground() {
        let m = moon();
        let d = direction_of_lat_lon(0.31, 0.5);
        let n = m.normal(d);
        let (east, up, north) = east_up_north(d);
        let slope = DVec3::new(n.dot(east), n.dot(north), 0.0) / n.dot(up);
        let uphill = (up - (east * slope.x + north * slope.y) * (1.0 / m.radius_m / slope.length())).normalize();
        assert!(m.height_m(uphill) > m.height_m(d) && (n.length() - 1.0).abs() < 1e-12);
    }
}
