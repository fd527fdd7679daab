//! `syzygy bench air --spectral`: how far the colours of each air are from those of all wavelengths, drawn as `rgb` and as `spectral`.
//!
//! ΔE2000 against 216 wavelengths, in single scattering and in the transmittance of the sun's disc, over rays that nothing was fitted to
//! ([`engine::air::spectral::study`]). `plain` takes 680, 550 and 440 nm for red, green and blue, as is often done.

use crate::assets::{AssetErrors, Assets};
use engine::air::spectral::study::{Error, study};
use engine::light::spectrum::Starlight;
use serde::Serialize;

/// One kind of ray through one air.
#[derive(Clone, Debug, Serialize)]
pub struct ColourRow {
    /// The body whose air it is.
    pub body: String,
    /// The kind of ray; `all` for all of them.
    pub rays: &'static str,
    /// How many of them were bright enough to be judged.
    pub count: usize,
    /// 680, 550, 440 nm.
    pub plain: ColourError,
    /// The best wavelength for each channel, as the older models draw it.
    pub best: ColourError,
    /// `spectrum = "rgb"`.
    pub rgb: ColourError,
    /// `spectrum = "spectral"`.
    pub spectral: ColourError,
}

/// ΔE2000.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ColourError {
    /// Mean over the rays.
    pub mean: f64,
    /// Of the worst of them.
    pub worst: f64,
}

impl From<Error> for ColourError {
    fn from(e: Error) -> Self {
        Self { mean: e.mean, worst: e.worst }
    }
}

/// Judges the airs of these bodies, or of all that have one with layers, under the Sun.
pub fn rows(assets: &Assets, bodies: &[String]) -> Result<Vec<ColourRow>, AssetErrors> {
    let all: Vec<String> = if bodies.is_empty() { assets.overlay.names("bodies", None).into_iter().collect() } else { bodies.to_vec() };
    let star = Starlight::default();
    let mut rows = Vec::new();
    for body in all {
        let Some(medium) = assets.air(&body, &star)?.by_wavelength.filter(|m| !m.layers.is_empty()) else { continue };
        rows.extend(study(&medium, &star.spectrum()).into_iter().map(|row| {
            let [plain, best, rgb, spectral] = row.errors;
            ColourRow {
                body: body.clone(),
                rays: row.kind,
                count: plain.rays,
                plain: plain.into(),
                best: best.into(),
                rgb: rgb.into(),
                spectral: spectral.into(),
            }
        }));
    }
    Ok(rows)
}
