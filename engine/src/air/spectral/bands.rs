//! Three or six bands in place of all wavelengths.
//!
//! [`Bands`] draws the air at three wavelengths, as one medium of three channels, or at six, as two, and adds them up by a matrix each, in linear
//! sRGB per unit of the star's own channel: `L = Σ_k M_k L_k`, and likewise for transmittance. The weights are a quadrature over the star's
//! light times the observer. Start: each wavelength of the spectrum shared by the two bands beside it. From there least squares over the
//! fitting rays, each weighed by its own luminance, with a pull ([`PULL`]) towards the start that keeps the weights small, and with the
//! sums of the weights held at 1: no air, no change. As scattering is linear in the light, further orders take the same weights.
//!
//! The wavelengths too are the air's own: from some that serve most airs ([`THREE_NM`], [`SIX_NM`]) each moves, a step at a time, as long as what
//! is left of the least squares falls. An absorber of narrow bands, such as methane, needs that. [`super::study`] has the figures.
//!
//! Who cannot take a matrix (the older models) draws by [`Fitting::best_wavelengths_m`]: for each channel of linear sRGB the one wavelength whose light comes closest
//! to the channel's, over [`fitting`] rays.

use super::rays::{Met, fitting};
use super::{Coefficients, SpectralMedium};
use crate::air::medium::Medium;
use crate::light::spectrum::difference::shown;
use crate::light::spectrum::{COUNT, Spectrum, observer, rgb_from_xyz, wavelength_nm, xyz_from_rgb};
use crate::units::NM;
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// The wavelengths from which the search sets out, nm.
const THREE_NM: [f64; 3] = [458.0, 542.0, 614.0];
const SIX_NM: [f64; 6] = [434.0, 470.0, 524.0, 566.0, 614.0, 674.0];
/// Strides by which the search moves a band, first the long ones.
const MOVES: [usize; 3] = [4, 2, 1];
/// Times that all bands are tried by one length of move.
const ROUNDS: usize = 6;
/// Weights of the start in the least squares, where a ray weighs 1: each is tried.
const PULLS: [f64; 3] = [1e-4, 1e-2, 1e-1];
/// Weights beyond this would make noise and half floats visible.
const WEIGHT_MOST: f64 = 6.0;
/// Samples along a ray that is fitted.
const SAMPLES: u32 = 48;
/// Every so many wavelengths are enough for the fit: 6 nm.
const STRIDE: usize = 3;
/// Rays darker than this share of the star's illuminance (per sr) say nothing.
const DARK: f64 = 1e-9;

/// A medium in three or six bands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bands {
    /// One medium or two.
    pub list: Vec<Band>,
}

/// Three of the bands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Wavelengths of its channels, nm, falling; where there are two, they take turns.
    pub wavelengths_nm: [f64; 3],
    /// The medium.
    pub medium: Medium,
    /// From its channels to linear sRGB, per unit of the star's channel; two add up. Rows of all together sum to 1.
    pub to_rgb: DMat3,
}

/// Bands (indices of [`Truth::nm`], rising), their weights, and by how much the rays' colours are then off: ΔE2000, mean.
struct Fit {
    bands: Vec<usize>,
    weights: Vec<DVec3>,
    error: f64,
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
    /// The star's own colour.
    star: DVec3,
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
        Self { nm, shares, light, rgb, weights, star: star.colour() }
    }

    /// The wavelength next to one.
    fn nearest(&self, nm: f64) -> usize {
        (0..self.nm.len()).min_by(|a, b| (self.nm[*a] - nm).abs().total_cmp(&(self.nm[*b] - nm).abs())).unwrap_or(0)
    }

    /// For each channel the wavelength whose light comes closest, nm.
    fn best_nm(&self) -> [f64; 3] {
        let mut best = [(f64::INFINITY, SpectralMedium::WAVELENGTHS_M[0] / NM); 3];
        for (nm, light) in self.nm.iter().zip(&self.light).filter(|(nm, _)| (400.0..=700.0).contains(*nm)) {
            for (c, best) in best.iter_mut().enumerate() {
                let error: f64 = (0..light.len()).map(|i| (light[i] - self.rgb[i][c]) * self.weights[i]).map(|x| x * x).sum();
                if error < best.0 {
                    *best = (error, *nm);
                }
            }
        }
        best.map(|b| b.1)
    }

    /// Each wavelength of the star's light shared by the two bands beside it: the weights before the fit.
    fn start(&self, bands: &[usize]) -> Vec<DVec3> {
        let n = bands.len();
        let mut out = vec![DVec3::ZERO; n];
        for (i, share) in self.shares.iter().enumerate() {
            let above = bands.iter().position(|b| *b > i).unwrap_or(n);
            let t = if above == 0 || above == n { 0.0 } else { (i - bands[above - 1]) as f64 / (bands[above] - bands[above - 1]) as f64 };
            out[above.saturating_sub(1)] += *share * (1.0 - t);
            out[above.min(n - 1)] += *share * t;
        }
        out
    }

    /// The best of [`PULLS`]; `None` where there is nothing to fit to.
    fn fit(&self, bands: &[usize]) -> Option<Fit> {
        let small = |fit: &Fit| fit.weights.iter().all(|w| w.abs().max_element() < WEIGHT_MOST);
        PULLS.iter().filter_map(|pull| self.fit_pulled(bands, *pull)).filter(small).min_by(|a, b| a.error.total_cmp(&b.error))
    }

    /// Least squares for all bands but the last, whose weight is what is left of 1.
    fn fit_pulled(&self, bands: &[usize], pull: f64) -> Option<Fit> {
        let free = bands.len() - 1;
        let start = self.start(bands);
        let used = self.weights.iter().filter(|w| **w > 0.0).count() as f64;
        let (mut a, mut b) = (vec![vec![pull; free]; free], vec![DVec3::ZERO; free]);
        for j in 0..free {
            a[j][j] += pull;
            b[j] = (start[j] - (start[free] - DVec3::ONE)) * pull;
        }
        for (i, weight) in self.weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            let last = self.light[bands[free]][i];
            let d: Vec<f64> = bands[..free].iter().map(|band| (self.light[*band][i] - last) * weight).collect();
            let rest = (self.rgb[i] - last) * *weight;
            for j in 0..free {
                (0..free).for_each(|k| a[j][k] += d[j] * d[k] / used);
                b[j] += rest * (d[j] / used);
            }
        }
        let mut weights = solve(a, b)?;
        weights.push(DVec3::ONE - weights.iter().sum::<DVec3>());
        let error = |i: usize| {
            let found: DVec3 = bands.iter().zip(&weights).map(|(b, w)| *w * self.light[*b][i]).sum();
            shown(self.rgb[i] * self.star, found * self.star)
        };
        let error = (0..self.rgb.len()).filter(|i| self.weights[*i] > 0.0).map(error).sum::<f64>() / used;
        error.is_finite().then(|| Fit { bands: bands.to_vec(), weights, error })
    }

    /// Bands and weights that leave the least.
    fn search(&self, from_nm: &[f64]) -> Fit {
        let first: Vec<usize> = from_nm.iter().map(|nm| self.nearest(*nm)).collect();
        let Some(mut best) = self.fit(&first) else { return Fit { weights: self.start(&first), bands: first, error: f64::INFINITY } };
        for step in MOVES {
            for _ in 0..ROUNDS {
                let before = best.error;
                for (band, up) in (0..first.len()).flat_map(|band| [(band, false), (band, true)]) {
                    let mut tried = best.bands.clone();
                    tried[band] = if up { tried[band] + step } else { tried[band].saturating_sub(step) };
                    let apart = tried.is_sorted_by(|a, b| a < b) && tried.last().is_some_and(|b| *b < self.nm.len());
                    if let Some(better) = apart.then(|| self.fit(&tried)).flatten().filter(|fit| fit.error < best.error) {
                        best = better;
                    }
                }
                if best.error >= before {
                    break;
                }
            }
        }
        best
    }
}

/// How an air may be drawn under a star's light above it.
pub struct Fitting<'a> {
    medium: &'a SpectralMedium,
    truth: Truth,
}

impl<'a> Fitting<'a> {
    /// Finds what its fitting rays bring.
    pub fn new(medium: &'a SpectralMedium, star: &Spectrum) -> Self {
        Self { medium, truth: Truth::new(medium, star) }
    }

    /// For each channel the wavelength whose light comes closest, m.
    pub fn best_wavelengths_m(&self) -> [f64; 3] {
        self.truth.best_nm().map(|nm| nm * NM)
    }

    /// By three bands.
    pub fn three(&self) -> Bands {
        let [red, green, blue] = self.truth.best_nm();
        // An absorber of narrow bands is not left by single steps: the channels' own wavelengths are a second place to set out from.
        let own = [blue, green, red];
        let found = self.truth.search(&THREE_NM);
        let other = (blue < green && green < red).then(|| self.truth.search(&own)).filter(|fit| fit.error < found.error);
        self.bands(&other.unwrap_or(found), &[[2, 1, 0]])
    }

    /// By six.
    pub fn six(&self) -> Bands {
        self.bands(&self.truth.search(&SIX_NM), &[[5, 3, 1], [4, 2, 0]])
    }

    /// `triples` are the places of each medium's channels among the wavelengths, which rise.
    fn bands(&self, fit: &Fit, triples: &[[usize; 3]]) -> Bands {
        let band = |triple: &[usize; 3]| {
            let wavelengths_nm = triple.map(|i| self.truth.nm[fit.bands[i]]);
            let [r, g, b] = triple.map(|i| fit.weights[i]);
            let medium = self.medium.medium_at(wavelengths_nm.map(|nm| nm * NM));
            Band { wavelengths_nm, medium, to_rgb: DMat3::from_cols(r, g, b) }
        };
        Bands { list: triples.iter().map(band).collect() }
    }
}

impl Bands {
    /// Linear sRGB, per unit of the star's channel, of what the channels of each band's medium bring.
    pub fn mix(&self, channels: impl Fn(usize, &Band) -> DVec3) -> DVec3 {
        self.list.iter().enumerate().map(|(k, band)| band.to_rgb * channels(k, band)).sum()
    }
}

/// Solves a symmetric positive system by elimination; `None` where it is not.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<DVec3>) -> Option<Vec<DVec3>> {
    let n = b.len();
    for i in 0..n {
        if a[i][i].is_nan() || a[i][i] <= 0.0 {
            return None;
        }
        let (above, pivot) = (a[i].clone(), b[i]);
        for j in i + 1..n {
            let factor = a[j][i] / above[i];
            a[j].iter_mut().zip(&above).for_each(|(x, above)| *x -= factor * above);
            b[j] -= pivot * factor;
        }
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
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
    use crate::light::spectrum::Starlight;

    fn sum_of_rows(bands: &Bands) -> DVec3 {
        bands.mix(|_, _| DVec3::ONE)
    }
    fn both(medium: &SpectralMedium, star: &Spectrum) -> [Bands; 2] {
        let fitting = Fitting::new(medium, star);
        [fitting.three(), fitting.six()]
    }

    #[test]
    fn a_grey_air_stays_grey() {
        let haze = Aerosol { load: Load::OpticalDepth(0.5), angstrom_exponent: 0.0, single_scattering_albedo: vec![(550e-9, 0.9)] };
        let layer = SpectralLayer { optics: Optics::Aerosol(haze), profile: exponential(1200.0), phase: Phase::CornetteShanks { g: 0.7 } };
        let grey = SpectralMedium { layers: vec![layer], ..earth() };
        let at = grey.at(&[550e-9]);
        for bands in both(&grey, &Spectrum::sun()) {
            for met in fitting(&grey).into_iter().filter_map(|r| Met::trace(&grey, r, 16)) {
                let light = DVec3::splat(met.transmittance(&at[0]));
                assert!((bands.mix(|_, _| light) - light).abs().max_element() < 1e-12);
            }
        }
    }

    #[test]
    fn without_air_nothing_changes() {
        let empty = SpectralMedium { layers: Vec::new(), ..earth() };
        for bands in [earth(), empty].iter().flat_map(|medium| both(medium, &Spectrum::sun())) {
            assert!((sum_of_rows(&bands) - DVec3::ONE).abs().max_element() < 1e-12);
        }
    }

    #[test]
    fn weights_stay_small_and_finite_for_any_star_and_air() {
        let mut thick = earth();
        thick.layers.iter_mut().for_each(|l| l.profile = Profile::Exponential { scale_height_m: 9e5 });
        for star in [Spectrum::sun(), Spectrum::black_body(1000.0), Spectrum::black_body(40_000.0), Spectrum::of(|_| 0.0)] {
            for medium in [&earth(), &thick] {
                for bands in both(medium, &star) {
                    let largest = bands.list.iter().flat_map(|b| b.to_rgb.to_cols_array()).fold(0.0, |a: f64, b| a.max(b.abs()));
                    assert!(largest.is_finite() && largest < 6.0, "{largest}");
                    assert!((sum_of_rows(&bands) - DVec3::ONE).abs().max_element() < 1e-9);
                }
                assert!(Fitting::new(medium, &star).best_wavelengths_m().iter().all(|w| (4e-7..=7e-7).contains(w)));
            }
        }
    }

    #[test]
    fn three_numbers_stay_the_channels() {
        let mut medium = earth();
        medium.layers.iter_mut().for_each(|l| l.optics = Optics::Channels([1e-6, 2e-6, 4e-6], [0.0, 1e-7, 3e-7]));
        let (drawn, bands) = medium.draw(false, &Starlight::Sun).unwrap();
        assert!(bands.is_none());
        assert!((drawn.layers[0].scattering_per_m - glam::Vec3::new(1e-6, 2e-6, 4e-6)).abs().max_element() < 1e-12);
        assert!((drawn.layers[2].absorption_per_m - glam::Vec3::new(0.0, 1e-7, 3e-7)).abs().max_element() < 1e-12);
    }

    #[test]
    fn solves_what_it_can() {
        let a = vec![vec![4.0, 1.0], vec![1.0, 3.0]];
        let x = solve(a, vec![DVec3::splat(6.0), DVec3::splat(7.0)]).unwrap();
        assert!((x[0] - DVec3::splat(1.0)).length() < 1e-12 && (x[1] - DVec3::splat(2.0)).length() < 1e-12);
        assert!([0.0, f64::NAN].map(|x| solve(vec![vec![x]], vec![DVec3::ONE]).is_none()) == [true; 2]);
    }
}
