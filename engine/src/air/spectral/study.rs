//! How far three channels, three bands and six are from all wavelengths, in ΔE2000.
//!
//! Judged on rays that were not fitted to ([`kinds`]), in single scattering and in transmittance, each at the brightness to which an eye
//! would be used ([`shown`]). The truth has 216 wavelengths and twice the samples of the fit.

use super::bands::{Bands, Fitting, channel_weights};
use super::rays::{Met, Ray, limb};
use super::{Coefficients, SpectralMedium};
use crate::light::spectrum::difference::shown;
use crate::light::spectrum::{COUNT, Spectrum, wavelength_nm, xyz_from_rgb};
use crate::units::NM;
use glam::DVec3;

/// Samples along a ray that is judged.
const SAMPLES: u32 = 96;
/// Darker light (luminance per unit of the star's) is not judged.
const DARK: f64 = 1e-9;

/// Number of [`Way`]s.
pub const WAYS: usize = 4;

/// Ways to draw an air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// 680, 550 and 440 nm taken as red, green and blue.
    Plain,
    /// The best wavelength for each channel, as the older models draw it.
    Best,
    /// `spectrum = "rgb"`: three bands.
    Rgb,
    /// `spectrum = "spectral"`: six bands.
    Spectral,
}

impl Way {
    /// All of them.
    pub const ALL: [Self; WAYS] = [Self::Plain, Self::Best, Self::Rgb, Self::Spectral];
}

/// ΔE2000 over some rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Error {
    /// Rays that were bright enough to judge.
    pub rays: usize,
    /// Mean.
    pub mean: f64,
    /// Greatest.
    pub worst: f64,
}

impl Error {
    fn of(all: &[f64]) -> Self {
        let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
        Self { rays: all.len(), mean, worst: all.iter().copied().fold(0.0, f64::max) }
    }
}

/// One kind of ray.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its name.
    pub kind: &'static str,
    /// Errors, in the order of [`Way::ALL`].
    pub errors: [Error; WAYS],
}

/// Judges a medium under a star: a row for each kind of ray, and `all`.
pub fn study(medium: &SpectralMedium, star: &Spectrum) -> Vec<Row> {
    let drawn = Drawn::new(medium, star);
    let mut everything: [Vec<f64>; WAYS] = Default::default();
    let mut rows = Vec::new();
    for (kind, rays) in kinds(medium) {
        let mut errors: [Vec<f64>; WAYS] = Default::default();
        for met in rays.into_iter().filter_map(|ray| Met::trace(medium, ray, SAMPLES)) {
            let light: &dyn Fn(&Coefficients) -> f64 = if kind == SUN { &|at| met.transmittance(at) } else { &|at| met.radiance(at) };
            let truth = drawn.truth(light);
            if xyz_from_rgb().row(1).dot(truth) > DARK * xyz_from_rgb().row(1).dot(drawn.star) {
                for (way, list) in Way::ALL.into_iter().zip(&mut errors) {
                    list.push(shown(truth, drawn.by(way, light)));
                }
            }
        }
        rows.push(Row { kind, errors: errors.each_ref().map(|list| Error::of(list)) });
        everything.iter_mut().zip(errors).for_each(|(all, mut new)| all.append(&mut new));
    }
    rows.push(Row { kind: "all", errors: everything.each_ref().map(|list| Error::of(list)) });
    rows
}

/// Name of the kind that is judged by transmittance.
const SUN: &str = "sun's disc";

/// Rays that no fit has seen.
pub fn kinds(medium: &SpectralMedium) -> Vec<(&'static str, Vec<Ray>)> {
    let ground = |views: &[f64], suns: &[f64]| {
        let mut out = Vec::new();
        for view_deg in views {
            for sun_deg in suns {
                out.extend([5.0, 60.0, 175.0].map(|azimuth_deg| Ray {
                    altitude_m: 50.0,
                    view_deg: *view_deg,
                    sun_deg: *sun_deg,
                    azimuth_deg,
                }));
            }
        }
        out
    };
    let space = |rays: &[Ray], suns: &[f64]| rays.iter().flat_map(|r| suns.iter().map(|s| Ray { sun_deg: *s, ..*r })).collect::<Vec<_>>();
    let limbs = [0.04, 0.15, 0.35].map(|f| limb(medium, f));
    let down = [170.0, 135.0].map(|view_deg| Ray { view_deg, ..limbs[0] });
    vec![
        ("zenith", ground(&[3.0, 20.0], &[10.0, 45.0, 75.0])),
        ("horizon", ground(&[84.0, 88.3], &[35.0, 65.0, 80.0])),
        ("sunset", ground(&[15.0, 65.0, 87.0], &[87.0, 89.2, 90.3])),
        ("twilight", ground(&[35.0, 78.0, 86.0], &[92.0, 93.5, 95.5])),
        ("limb", space(&limbs, &[50.0, 80.0, 100.0])),
        ("disc", space(&down, &[30.0, 65.0, 85.0])),
        (
            SUN,
            [20.0, 70.0, 83.0, 87.0, 89.0, 90.0]
                .map(|view_deg| Ray { altitude_m: 50.0, view_deg, sun_deg: 0.0, azimuth_deg: 0.0 })
                .to_vec(),
        ),
    ]
}

/// A medium at all wavelengths and in each way.
struct Drawn {
    star: DVec3,
    weights: Vec<DVec3>,
    all: Vec<Coefficients>,
    plain: Vec<Coefficients>,
    best: Vec<Coefficients>,
    rgb: InBands,
    spectral: InBands,
}

/// Bands, and the coefficients of each of their media.
struct InBands(Bands, Vec<Vec<Coefficients>>);

impl InBands {
    fn new(medium: &SpectralMedium, bands: Bands) -> Self {
        let at = bands.list.iter().map(|b| medium.at(&b.wavelengths_nm.map(|nm| nm * NM))).collect();
        Self(bands, at)
    }
}

impl Drawn {
    fn new(medium: &SpectralMedium, star: &Spectrum) -> Self {
        let fitting = Fitting::new(medium, star);
        Self {
            star: star.colour(),
            weights: channel_weights(star),
            all: medium.at(&(0..COUNT).map(|i| wavelength_nm(i) * NM).collect::<Vec<_>>()),
            plain: medium.at(&SpectralMedium::WAVELENGTHS_M),
            best: medium.at(&fitting.best_wavelengths_m()),
            rgb: InBands::new(medium, fitting.three()),
            spectral: InBands::new(medium, fitting.six()),
        }
    }

    /// Linear sRGB by all wavelengths.
    fn truth(&self, light: &dyn Fn(&Coefficients) -> f64) -> DVec3 {
        self.all.iter().zip(&self.weights).map(|(at, weight)| *weight * light(at)).sum::<DVec3>() * self.star
    }

    fn by(&self, way: Way, light: &dyn Fn(&Coefficients) -> f64) -> DVec3 {
        let three = |at: &[Coefficients]| DVec3::new(light(&at[0]), light(&at[1]), light(&at[2]));
        let mixed = |InBands(bands, at): &InBands| bands.mix(|k, _| three(&at[k]));
        self.star
            * match way {
                Way::Plain => three(&self.plain),
                Way::Best => three(&self.best),
                Way::Rgb => mixed(&self.rgb),
                Way::Spectral => mixed(&self.spectral),
            }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::spectral::tests::earth;

    #[test]
    fn earth_s_colours_are_off_by_as_much_as_stated() {
        let rows = study(&earth(), &Spectrum::sun());
        let all = rows.last().unwrap();
        let [plain, best, rgb, spectral] = all.errors;
        assert!(all.kind == "all" && plain.rays > 100);
        // Two-sided: these figures stand in the README.
        assert!((plain.mean - 8.7).abs() < 0.5, "{plain:?}");
        assert!((best.mean - 3.6).abs() < 0.3, "{best:?}");
        assert!((rgb.mean - 1.1).abs() < 0.2 && rgb.worst < 4.5, "{rgb:?}");
        assert!((spectral.mean - 0.05).abs() < 0.03 && spectral.worst < 0.5, "{spectral:?}");
    }
}
