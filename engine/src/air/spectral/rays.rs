//! What a ray meets, without a wavelength: columns of each layer and what scatters there.
//!
//! In single scattering only the coefficients depend on the wavelength, not the geometry [Elek 2008, §4.2]: a ray is traced once, and its
//! radiance at any wavelength is then a sum of exponentials. Sun, horizon and ground as in [`crate::air::reference`].

use super::{Coefficients, SpectralMedium};
use crate::light::occlusion::visible_above_limb;
use crate::units::DEG;
use core::f64::consts::PI;
use glam::DVec3;

/// Angular radius of the sun, rad.
const SUN_RAD: f64 = 0.2666 * DEG;

/// A ray of sight and a sun. Angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Altitude of the eye, m.
    pub altitude_m: f64,
    /// From the zenith to the ray.
    pub view_deg: f64,
    /// From the zenith to the sun.
    pub sun_deg: f64,
    /// From the ray's azimuth to the sun's.
    pub azimuth_deg: f64,
}

/// What a ray meets in a medium of some layers.
#[derive(Clone, Debug)]
pub struct Met {
    /// Per sample and layer: metres at density 1 from the eye to the sample and on to the sun.
    columns: Vec<f64>,
    /// Per sample and layer: phase × density × step × visible sun.
    weights: Vec<f64>,
    /// Per layer: metres at density 1 along the whole ray.
    through: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Met {
    /// Traces a ray with this many samples; `None` where it meets no air.
    pub fn trace(medium: &SpectralMedium, ray: Ray, samples: u32) -> Option<Self> {
        let direction = |zenith_deg: f64, azimuth_deg: f64| {
            let ((s, c), (sa, ca)) = (libm::sincos(zenith_deg * DEG), libm::sincos(azimuth_deg * DEG));
            DVec3::new(s * ca, s * sa, c)
        };
        let (view, sun) = (direction(ray.view_deg, 0.0), direction(ray.sun_deg, ray.azimuth_deg));
        let eye = DVec3::Z * (medium.bottom_radius_m + ray.altitude_m);
        let air = medium.shape();
        let span = crate::air::reference::span(&air, eye, view)?;
        let phases: Vec<f64> = medium.layers.iter().map(|l| l.phase.value(view.dot(sun))).collect();
        let count = medium.layers.len();
        let mut met = Self { columns: Vec::new(), weights: Vec::new(), through: vec![0.0; count] };
        for (t, step) in samples_along(eye, view, span.near_m, span.far_m, samples) {
            let p = eye + view * t;
            let r = p.length();
            let densities: Vec<f64> = medium.layers.iter().map(|l| l.profile.density(r - medium.bottom_radius_m)).collect();
            let ratio = (medium.bottom_radius_m / r).min(1.0);
            let horizon = -(1.0 - ratio * ratio).sqrt();
            let mu = p.dot(sun) / r;
            let visible = visible_above_limb(SUN_RAD, libm::asin(mu.clamp(-1.0, 1.0)) - libm::asin(horizon));
            if visible > 0.0 {
                let up = sun_column(medium, r, mu.max(horizon), samples);
                met.columns.extend((0..count).map(|i| met.through[i] + 0.5 * densities[i] * step + up[i]));
                met.weights.extend((0..count).map(|i| phases[i] * densities[i] * step * visible));
            }
            (0..count).for_each(|i| met.through[i] += densities[i] * step);
        }
        Some(met)
    }

    /// Singly scattered radiance per unit of the sun's irradiance above the air, sr⁻¹.
    pub fn radiance(&self, at: &Coefficients) -> f64 {
        let count = self.through.len().max(1);
        let samples = self.columns.chunks_exact(count).zip(self.weights.chunks_exact(count));
        samples.map(|(columns, weights)| dot(weights, &at.scattering) * libm::exp(-dot(columns, &at.extinction))).sum()
    }

    /// Transmittance along the whole ray.
    pub fn transmittance(&self, at: &Coefficients) -> f64 {
        libm::exp(-dot(&self.through, &at.extinction))
    }
}

/// Middles and lengths of steps from `near` to `far`, shortest about the lowest point, where air is densest.
fn samples_along(eye: DVec3, view: DVec3, near: f64, far: f64, count: u32) -> Vec<(f64, f64)> {
    let lowest = (-eye.dot(view)).clamp(near, far);
    let share = (lowest - near) / (far - near).max(1e-9);
    let before = if share <= 0.0 { 0.0 } else { (share * f64::from(count)).round().clamp(2.0, f64::from(count)) };
    let after = (f64::from(count) - before).max(if share >= 1.0 { 0.0 } else { 2.0 });
    // Squares of even steps away from the lowest point.
    let part = |n: f64, length: f64, i: f64| length * (i / n) * (i / n);
    let mut out = Vec::new();
    let mut push = |from: f64, to: f64| out.push((0.5 * (from + to), to - from));
    let mut i = before;
    while i > 0.0 {
        push(lowest - part(before, lowest - near, i), lowest - part(before, lowest - near, i - 1.0));
        i -= 1.0;
    }
    while i < after {
        push(lowest + part(after, far - lowest, i), lowest + part(after, far - lowest, i + 1.0));
        i += 1.0;
    }
    out
}

/// Metres at density 1 of each layer from radius `r_m` to the top, at a zenith cosine `mu`.
fn sun_column(medium: &SpectralMedium, r_m: f64, mu: f64, samples: u32) -> Vec<f64> {
    let top = medium.bottom_radius_m + medium.top_altitude_m;
    let (from, up) = (DVec3::Z * r_m, DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu));
    let far = -r_m * mu + (top * top - r_m * r_m * (1.0 - mu * mu)).max(0.0).sqrt();
    let steps = samples_along(from, up, 0.0, far, samples);
    let altitude = |t: f64| (from + up * t).length() - medium.bottom_radius_m;
    medium.layers.iter().map(|l| steps.iter().map(|(t, step)| l.profile.density(altitude(*t)) * step).sum()).collect()
}

/// Directions, suns and eyes that an air is fitted to: ground, a tenth of the way up and above the top; day, sunset, twilight; limb.
pub fn fitting(medium: &SpectralMedium) -> Vec<Ray> {
    let top = medium.top_altitude_m;
    let mut out = Vec::new();
    for altitude_m in [2.0, 0.1 * top] {
        for view_deg in [0.0, 55.0, 80.0, 89.0] {
            for sun_deg in [25.0, 70.0, 86.0, 90.0, 94.0] {
                for azimuth_deg in if view_deg > 0.0 { &[15.0, 150.0][..] } else { &[0.0] } {
                    out.push(Ray { altitude_m, view_deg, sun_deg, azimuth_deg: *azimuth_deg });
                }
            }
        }
    }
    for fraction in [0.02, 0.1, 0.25, 0.5] {
        let ray = limb(medium, fraction);
        out.extend([40.0, 85.0, 105.0].map(|sun_deg| Ray { sun_deg, ..ray }));
    }
    for view_deg in [180.0, 150.0, 125.0] {
        out.extend([25.0, 75.0].map(|sun_deg| Ray { altitude_m: top + 3e5, view_deg, sun_deg, azimuth_deg: 40.0 }));
    }
    out
}

/// A ray from 300 km above the top whose lowest point is this fraction of the air's height above the ground.
pub fn limb(medium: &SpectralMedium, fraction: f64) -> Ray {
    let altitude_m = medium.top_altitude_m + 3e5;
    let ratio = (medium.bottom_radius_m + fraction * medium.top_altitude_m) / (medium.bottom_radius_m + altitude_m);
    Ray { altitude_m, view_deg: (PI - libm::asin(ratio)) / DEG, sun_deg: 60.0, azimuth_deg: 20.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::reference::{self, Options, Ray as Sight};
    use crate::air::spectral::tests::earth;

    #[test]
    fn a_traced_ray_is_the_reference_s() {
        let medium = earth();
        let wavelengths_m = [640e-9, 540e-9, 450e-9];
        let (channels, at) = (medium.medium_at(wavelengths_m), medium.at(&wavelengths_m));
        for ray in fitting(&medium).into_iter().step_by(5) {
            let dir = |zenith: f64, azimuth: f64| {
                let ((s, c), (sa, ca)) = (libm::sincos(zenith * DEG), libm::sincos(azimuth * DEG));
                DVec3::new(s * ca, s * sa, c)
            };
            let (eye, view) = (DVec3::Z * (medium.bottom_radius_m + ray.altitude_m), dir(ray.view_deg, 0.0));
            let sun = dir(ray.sun_deg, ray.azimuth_deg);
            let sight = Sight { from_m: eye, direction: view, sun, sun_rad: SUN_RAD, occluders: Vec::new() };
            let only_once = Options { max_walks: 0, single_error: 1e-4, ..Options::default() };
            let truth = reference::radiance(&channels, &[sight], &only_once)[0];
            let met = Met::trace(&medium, ray, 96).unwrap();
            for (c, at) in at.iter().enumerate() {
                let (l, t) = (met.radiance(at), met.transmittance(at));
                assert!((l - truth.single[c]).abs() < 0.01 * truth.single[c] + 1e-9, "{ray:?}: {l} {}", truth.single[c]);
                assert!((t - truth.transmittance[c]).abs() < 2e-3, "{ray:?}: {t} {}", truth.transmittance[c]);
            }
        }
    }

    #[test]
    fn samples_cover_the_ray_once() {
        let eye = DVec3::Z * 6.4e6;
        for (view, near, far) in [(DVec3::Z, 0.0, 5e4), (DVec3::NEG_Z, 1e3, 2.9e4), (DVec3::new(0.998, 0.0, -0.06), 10.0, 9e5)] {
            let steps = samples_along(eye, view, near, far, 24);
            let mut at = near;
            for (middle, step) in &steps {
                assert!((middle - 0.5 * step - at).abs() < 1e-6 * far && *step > 0.0);
                at += step;
            }
            assert!((at - far).abs() < 1e-6 * far && steps.len() <= 26, "{}", steps.len());
        }
    }
}
