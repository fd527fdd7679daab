//! Three channels or six bands in place of all wavelengths.
//!
//! [`rgb`] takes for each channel of linear sRGB the one wavelength whose light comes closest to the channel's, over [`fitting`] rays.
//!
//! [`Bands`] draws the air at six wavelengths, as two media of three channels, and adds them up by two matrices, in linear sRGB per
//! unit of the star's own channel: `L = Σ_k M_k L_k`, and likewise for transmittance. The weights are a quadrature over the star's
//! light times the observer. Start: each wavelength of the spectrum shared by the two bands beside it. From there least squares over the
//! fitting rays, each weighed by its own luminance, with a pull ([`PULL`]) towards the start that keeps the weights small, and with the
//! sums of the weights held at 1: no air, no change. As scattering is linear in the light, further orders take the same weights.
//!
//! The six wavelengths too are the air's own: from six that serve most airs ([`START_NM`]) each moves, a step at a time, as long as what
//! is left of the least squares falls. An absorber of narrow bands, such as methane, needs that. [`super::study`] has the figures.

use super::rays::{Met, fitting};
use super::{Coefficients, SpectralMedium};
use crate::air::medium::Medium;
use crate::light::spectrum::{COUNT, Spectrum, observer, rgb_from_xyz, wavelength_nm, xyz_from_rgb};
use crate::units::NM;
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// The six wavelengths from which the search sets out, nm.
const START_NM: [f64; N] = [434.0, 470.0, 524.0, 566.0, 614.0, 674.0];
/// Strides by which the search moves a band, first the long ones.
const MOVES: [usize; 3] = [4, 2, 1];
/// Times that all bands are tried by one length of move.
const ROUNDS: usize = 6;
/// Weight of the start in the least squares, where a ray weighs 1.
const PULL: f64 = 1e-4;
/// Samples along a ray that is fitted.
const SAMPLES: u32 = 48;
/// Every so many wavelengths are enough for the fit: 6 nm.
const STRIDE: usize = 3;
/// Rays darker than this share of the star's illuminance (per sr) say nothing.
const DARK: f64 = 1e-9;
/// Number of bands.
const N: usize = 6;

/// A medium in six bands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bands {
    /// Wavelengths of the channels of the two media, nm, falling; they take turns.
    pub wavelengths_nm: [[f64; 3]; 2],
    /// The two media.
    pub media: [Medium; 2],
    /// From the channels of each to linear sRGB, per unit of the star's channel; the two add up. Rows of both together sum to 1.
    pub to_rgb: [DMat3; 2],
}

/// Share of each wavelength in each linear sRGB channel of a star's light: sums over the wavelengths are 1. Where a star has next to no
/// light in a channel (a very cool one's blue), that channel is taken of an even spectrum.
pub fn channel_weights(star: &Spectrum) -> Vec<DVec3> {
    let to_rgb = rgb_from_xyz();
    let raw = |spectrum: &Spectrum| -> Vec<DVec3> { (0..COUNT).map(|i| to_rgb * observer(wavelength_nm(i)) * spectrum.0[i]).collect() };
    let (lit, even) = (raw(star), raw(&Spectrum::of(|_| 1.0)));
    let total = |w: &[DVec3]| w.iter().copied().sum::<DVec3>();
    let (sum, even_sum) = (total(&lit), total(&even));
    let least = 1e-3 * sum.max_element();
    let channel = |i: usize, c: usize| if sum[c] > least { lit[i][c] / sum[c] } else { even[i][c] / even_sum[c] };
    (0..COUNT).map(|i| DVec3::new(channel(i, 0), channel(i, 1), channel(i, 2))).collect()
}

/// What the rays bring (radiance of each, then transmittance of each): at single wavelengths, and in linear sRGB by all of them.
struct Truth {
    /// Wavelengths, nm.
    nm: Vec<f64>,
    /// Share of each in each channel.
    shares: Vec<DVec3>,
    /// By wavelength and ray.
    light: Vec<Vec<f64>>,
    /// By ray.
    rgb: Vec<DVec3>,
    /// One over the luminance of each; 0 for dark ones.
    weights: Vec<f64>,
}

impl Truth {
    fn new(medium: &SpectralMedium, star: &Spectrum) -> Self {
        let all = channel_weights(star);
        let chosen: Vec<usize> = (0..COUNT).step_by(STRIDE).collect();
        let total: DVec3 = chosen.iter().map(|i| all[*i]).sum();
        let shares: Vec<DVec3> = chosen.iter().map(|i| all[*i] / total).collect();
        let nm: Vec<f64> = chosen.into_iter().map(wavelength_nm).collect();
        let met: Vec<Met> = fitting(medium).into_iter().filter_map(|ray| Met::trace(medium, ray, SAMPLES)).collect();
        let at_one =
            |at: &Coefficients| met.iter().map(|m| m.radiance(at)).chain(met.iter().map(|m| m.transmittance(at))).collect::<Vec<f64>>();
        let light: Vec<Vec<f64>> = medium.at(&nm.iter().map(|nm| nm * NM).collect::<Vec<_>>()).iter().map(at_one).collect();
        let sum = |ray: usize| light.iter().zip(&shares).map(|(light, share)| *share * light[ray]).sum::<DVec3>();
        let rgb: Vec<DVec3> = (0..2 * met.len()).map(sum).collect();
        let luminance = xyz_from_rgb().row(1);
        let weights = rgb.iter().map(|rgb| luminance.dot(*rgb)).map(|y| if y > DARK { 1.0 / y } else { 0.0 }).collect();
        Self { nm, shares, light, rgb, weights }
    }

    /// The wavelength next to one.
    fn nearest(&self, nm: f64) -> usize {
        (0..self.nm.len()).min_by(|a, b| (self.nm[*a] - nm).abs().total_cmp(&(self.nm[*b] - nm).abs())).unwrap_or(0)
    }

    /// Each wavelength of the star's light shared by the two bands beside it: the weights before the fit.
    fn start(&self, bands: &[usize; N]) -> [DVec3; N] {
        let mut out = [DVec3::ZERO; N];
        for (i, share) in self.shares.iter().enumerate() {
            let above = bands.iter().position(|b| *b > i).unwrap_or(N);
            let t = if above == 0 || above == N { 0.0 } else { (i - bands[above - 1]) as f64 / (bands[above] - bands[above - 1]) as f64 };
            out[above.saturating_sub(1)] += *share * (1.0 - t);
            out[above.min(N - 1)] += *share * t;
        }
        out
    }

    /// Least squares for all bands but the last, whose weight is what is left of 1, and what is left of the squares; `None` where there is nothing to
    /// fit to.
    fn fit(&self, bands: &[usize; N]) -> Option<([DVec3; N], f64)> {
        const FREE: usize = N - 1;
        let start = self.start(bands);
        let used = self.weights.iter().filter(|w| **w > 0.0).count() as f64;
        let (mut a, mut b) = ([[PULL; FREE]; FREE], [DVec3::ZERO; FREE]);
        for j in 0..FREE {
            a[j][j] += PULL;
            b[j] = (start[j] - (start[FREE] - DVec3::ONE)) * PULL;
        }
        for (i, weight) in self.weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            let last = self.light[bands[FREE]][i];
            let d: [f64; FREE] = core::array::from_fn(|j| (self.light[bands[j]][i] - last) * weight);
            let rest = (self.rgb[i] - last) * *weight;
            for j in 0..FREE {
                (0..FREE).for_each(|k| a[j][k] += d[j] * d[k] / used);
                b[j] += rest * (d[j] / used);
            }
        }
        let free = solve(a, b)?;
        let mut out = [DVec3::ONE; N];
        for (j, w) in free.into_iter().enumerate() {
            out[j] = w;
            out[FREE] -= w;
        }
        let pulled: f64 = out.iter().zip(&start).map(|(w, s)| (*w - *s).length_squared()).sum();
        let left = |(i, weight): (usize, &f64)| {
            let found: DVec3 = bands.iter().zip(&out).map(|(b, w)| *w * self.light[*b][i]).sum();
            ((found - self.rgb[i]) * *weight).length_squared()
        };
        let left = self.weights.iter().enumerate().filter(|(_, w)| **w > 0.0).map(left).sum::<f64>() / used + PULL * pulled;
        left.is_finite().then_some((out, left))
    }

    /// Bands and weights that leave the least.
    fn search(&self) -> ([usize; N], [DVec3; N]) {
        let mut bands = START_NM.map(|nm| self.nearest(nm));
        let Some((mut weights, mut least)) = self.fit(&bands) else { return (bands, self.start(&bands)) };
        for step in MOVES {
            for _ in 0..ROUNDS {
                let before = least;
                for (band, up) in (0..N).flat_map(|band| [(band, false), (band, true)]) {
                    let mut tried = bands;
                    tried[band] = if up { bands[band] + step } else { bands[band].saturating_sub(step) };
                    let apart = tried.is_sorted_by(|a, b| a < b) && tried[N - 1] < self.nm.len();
                    if let Some((w, left)) = apart.then(|| self.fit(&tried)).flatten().filter(|(_, left)| *left < least) {
                        (bands, weights, least) = (tried, w, left);
                    }
                }
                if least >= before {
                    break;
                }
            }
        }
        (bands, weights)
    }
}

/// The medium that `spectrum = "rgb"` draws: three wavelengths, each the best for its channel. Three numbers in a file stay as they are.
pub fn rgb(medium: &SpectralMedium, star: &Spectrum) -> Medium {
    medium.medium_at(if medium.is_channels() { medium.wavelengths_m } else { best_wavelengths_m(medium, star) })
}

/// For each channel the wavelength whose light comes closest, m.
pub fn best_wavelengths_m(medium: &SpectralMedium, star: &Spectrum) -> [f64; 3] {
    let truth = Truth::new(medium, star);
    let mut best = [(f64::INFINITY, SpectralMedium::WAVELENGTHS_M[0]); 3];
    for (nm, light) in truth.nm.iter().zip(&truth.light).filter(|(nm, _)| (400.0..=700.0).contains(*nm)) {
        for (c, best) in best.iter_mut().enumerate() {
            let error: f64 = (0..light.len()).map(|i| (light[i] - truth.rgb[i][c]) * truth.weights[i]).map(|x| x * x).sum();
            if error < best.0 {
                *best = (error, nm * NM);
            }
        }
    }
    best.map(|b| b.1)
}

impl Bands {
    /// Fits the six bands of a medium under a star's light above the air.
    pub fn new(medium: &SpectralMedium, star: &Spectrum) -> Self {
        let truth = Truth::new(medium, star);
        let (bands, weights) = truth.search();
        // Rising; the two triples take turns.
        let triples = [[5, 3, 1], [4, 2, 0]];
        let wavelengths_nm = triples.map(|t| t.map(|i: usize| truth.nm[bands[i]]));
        Self {
            wavelengths_nm,
            media: wavelengths_nm.map(|t| medium.medium_at(t.map(|nm| nm * NM))),
            to_rgb: triples.map(|[r, g, b]| DMat3::from_cols(weights[r], weights[g], weights[b])),
        }
    }

    /// Linear sRGB, per unit of the star's channel, of what the channels of both media bring.
    pub fn mix(&self, channels: [DVec3; 2]) -> DVec3 {
        self.to_rgb[0] * channels[0] + self.to_rgb[1] * channels[1]
    }
}

/// Solves a symmetric positive system by elimination; `None` where it is not.
fn solve<const F: usize>(mut a: [[f64; F]; F], mut b: [DVec3; F]) -> Option<[DVec3; F]> {
    for i in 0..F {
        if a[i][i].is_nan() || a[i][i] <= 0.0 {
            return None;
        }
        for j in i + 1..F {
            let (factor, above) = (a[j][i] / a[i][i], a[i]);
            a[j].iter_mut().zip(above).for_each(|(x, above)| *x -= factor * above);
            let above = b[i];
            b[j] -= above * factor;
        }
    }
    for i in (0..F).rev() {
        for k in i + 1..F {
            let known = b[k];
            b[i] -= known * a[i][k];
        }
        b[i] /= a[i][i];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::medium::{Phase, Profile};
    use crate::air::optics::{Aerosol, Load};
    use crate::air::spectral::tests::{earth, exponential};
    use crate::air::spectral::{Optics, SpectralLayer};

    fn sum_of_rows(bands: &Bands) -> DVec3 {
        bands.mix([DVec3::ONE; 2])
    }

    #[test]
    fn a_grey_air_stays_grey() {
        let haze = Aerosol { load: Load::OpticalDepth(0.5), angstrom_exponent: 0.0, single_scattering_albedo: vec![(550e-9, 0.9)] };
        let layer = SpectralLayer { optics: Optics::Aerosol(haze), profile: exponential(1200.0), phase: Phase::CornetteShanks { g: 0.7 } };
        let grey = SpectralMedium { layers: vec![layer], ..earth() };
        let bands = Bands::new(&grey, &Spectrum::sun());
        let at = grey.at(&[550e-9]);
        for met in fitting(&grey).into_iter().filter_map(|r| Met::trace(&grey, r, 16)) {
            let (light, all) = (met.transmittance(&at[0]), DVec3::ONE);
            assert!((bands.mix([all * light; 2]) - all * light).abs().max_element() < 1e-12);
        }
    }

    #[test]
    fn without_air_nothing_changes() {
        let empty = SpectralMedium { layers: Vec::new(), ..earth() };
        for medium in [earth(), empty] {
            let bands = Bands::new(&medium, &Spectrum::sun());
            assert!((sum_of_rows(&bands) - DVec3::ONE).abs().max_element() < 1e-12);
        }
    }

    #[test]
    fn weights_stay_small_and_finite_for_any_star_and_air() {
        let mut thick = earth();
        thick.layers.iter_mut().for_each(|l| l.profile = Profile::Exponential { scale_height_m: 9e5 });
        for star in [Spectrum::sun(), Spectrum::black_body(1000.0), Spectrum::black_body(40_000.0), Spectrum::of(|_| 0.0)] {
            for medium in [&earth(), &thick] {
                let bands = Bands::new(medium, &star);
                let largest = bands.to_rgb.iter().flat_map(|m| m.to_cols_array()).fold(0.0, |a: f64, b| a.max(b.abs()));
                assert!(largest.is_finite() && largest < 8.0, "{largest}");
                assert!((sum_of_rows(&bands) - DVec3::ONE).abs().max_element() < 1e-9);
                assert!(best_wavelengths_m(medium, &star).iter().all(|w| (4e-7..=7e-7).contains(w)));
            }
        }
    }

    #[test]
    fn three_numbers_stay_the_channels() {
        let mut medium = earth();
        medium.layers.iter_mut().for_each(|l| l.optics = Optics::Channels([1e-6, 2e-6, 4e-6], [0.0, 1e-7, 3e-7]));
        let drawn = rgb(&medium, &Spectrum::sun());
        assert!((drawn.layers[0].scattering_per_m - glam::Vec3::new(1e-6, 2e-6, 4e-6)).abs().max_element() < 1e-12);
        assert!((drawn.layers[2].absorption_per_m - glam::Vec3::new(0.0, 1e-7, 3e-7)).abs().max_element() < 1e-12);
    }

    #[test]
    fn solves_what_it_can() {
        let a = [[4.0, 1.0], [1.0, 3.0]];
        let x = solve(a, [DVec3::splat(6.0), DVec3::splat(7.0)]).unwrap();
        assert!((x[0] - DVec3::splat(1.0)).length() < 1e-12 && (x[1] - DVec3::splat(2.0)).length() < 1e-12);
        assert!(solve([[0.0]], [DVec3::ONE]).is_none() && solve([[f64::NAN]], [DVec3::ONE]).is_none());
    }
}
