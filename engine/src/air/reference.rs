//! Truth in f64: transmittance and single scattering along a ray, by quadrature fine enough to judge tables and shaders.
//!
//! Definitions are those of the reference data: the sun is a uniform disc at infinity; direct light at a sample is scaled by the
//! fraction of the disc above the straight local horizon; transmittance is taken towards the disc's centre, held at the
//! horizon; ground that is seen directly adds nothing. Not fast, and not used while playing.

use super::medium::Medium;
use crate::light::occlusion::visible_above_limb;
use glam::DVec3;

/// Distances along a ray: where the air begins and ends, and whether the ground ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Metres to where the ray enters the air (0 inside).
    pub near_m: f64,
    /// Metres to where it leaves the air or meets the datum.
    pub far_m: f64,
    /// True when it ends on the datum.
    pub hits_ground: bool,
}

/// The stretch of a ray inside the air; `None` when it misses. `from_m` is relative to the body's centre, `direction` a unit vector.
pub fn span(medium: &Medium, from_m: DVec3, direction: DVec3) -> Option<Span> {
    let (r2, b) = (from_m.length_squared(), from_m.dot(direction));
    let sphere = |radius: f64| {
        let d = b * b - (r2 - radius * radius);
        (d > 0.0).then(|| (-b - d.sqrt(), -b + d.sqrt()))
    };
    let (near, far) = sphere(medium.bottom_radius_m + medium.top_altitude_m)?;
    if far <= 0.0 {
        return None;
    }
    let near_m = near.max(0.0);
    match sphere(medium.bottom_radius_m) {
        Some((ground, _)) if ground > near_m => Some(Span { near_m, far_m: ground, hits_ground: true }),
        _ => Some(Span { near_m, far_m: far, hits_ground: false }),
    }
}

fn extinction(medium: &Medium, altitude_m: f64) -> DVec3 {
    medium.layers.iter().map(|l| (l.scattering_per_m + l.absorption_per_m).as_dvec3() * l.profile.density(altitude_m)).sum()
}

/// Optical depth between two distances along a ray, per channel, by `steps` midpoints. No ground stands in the way.
pub fn optical_depth(medium: &Medium, from_m: DVec3, direction: DVec3, stretch_m: (f64, f64), steps: u32) -> DVec3 {
    let dt = (stretch_m.1 - stretch_m.0) / f64::from(steps);
    let at = |i: u32| {
        let p = from_m + direction * (stretch_m.0 + (f64::from(i) + 0.5) * dt);
        extinction(medium, p.length() - medium.bottom_radius_m)
    };
    (0..steps).map(at).sum::<DVec3>() * dt
}

/// Transmittance from radius `r_m` to the top of the air along a ray at cosine `mu` to the zenith, ground ignored.
pub fn transmittance_to_top(medium: &Medium, r_m: f64, mu: f64, steps: u32) -> DVec3 {
    let top = medium.bottom_radius_m + medium.top_altitude_m;
    let (from, direction) = (DVec3::Z * r_m, DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu));
    let far = -r_m * mu + (top * top - r_m * r_m * (1.0 - mu * mu)).max(0.0).sqrt();
    exp3(-optical_depth(medium, from, direction, (0.0, far), steps))
}

fn exp3(v: DVec3) -> DVec3 {
    DVec3::new(libm::exp(v.x), libm::exp(v.y), libm::exp(v.z))
}

/// What a ray brings, per channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radiance {
    /// Singly scattered radiance per unit of solar irradiance above the air, sr⁻¹.
    pub single: DVec3,
    /// Transmittance along the ray.
    pub transmittance: DVec3,
}

/// Single scattering along a ray from `from_m` (body-centred, m) along a unit `direction`, lit from the unit vector `sun` by a disc
/// of angular radius `sun_rad`; by `steps` midpoints, and as many towards the sun from each.
pub fn single_scattering(medium: &Medium, from_m: DVec3, direction: DVec3, sun: DVec3, sun_rad: f64, steps: u32) -> Radiance {
    let Some(span) = span(medium, from_m, direction) else { return Radiance { single: DVec3::ZERO, transmittance: DVec3::ONE } };
    let dt = (span.far_m - span.near_m) / f64::from(steps);
    let phase: Vec<f64> = medium.layers.iter().map(|l| l.phase.value(direction.dot(sun))).collect();
    let (mut depth, mut single) = (DVec3::ZERO, DVec3::ZERO);
    for i in 0..steps {
        let p = from_m + direction * (span.near_m + (f64::from(i) + 0.5) * dt);
        let r = p.length();
        let altitude_m = r - medium.bottom_radius_m;
        let step = extinction(medium, altitude_m) * dt;
        let horizon = -(1.0 - (medium.bottom_radius_m / r).min(1.0) * (medium.bottom_radius_m / r).min(1.0)).sqrt();
        let mu_s = p.dot(sun) / r;
        let visible = visible_above_limb(sun_rad, libm::asin(mu_s.clamp(-1.0, 1.0)) - libm::asin(horizon));
        if visible > 0.0 {
            let lit = transmittance_to_top(medium, r, mu_s.max(horizon), steps) * visible;
            let scattered: DVec3 = medium
                .layers
                .iter()
                .zip(&phase)
                .map(|(l, phase)| l.scattering_per_m.as_dvec3() * (l.profile.density(altitude_m) * phase))
                .sum();
            single += exp3(-(depth + step * 0.5)) * lit * scattered * dt;
        }
        depth += step;
    }
    Radiance { single, transmittance: exp3(-depth) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::air::medium::tests::earth;
    use crate::units::{DEG, KM};

    /// Solar irradiance at 680, 550 and 440 nm, W m⁻² nm⁻¹.
    const IRRADIANCE: DVec3 = DVec3::new(1.474, 1.8504, 1.91198);

    /// Height of the camera (km), view, sun, then T and L1 at three wavelengths.
    type Row = (f64, [f64; 3], [f64; 3], [f64; 3], [f64; 3]);

    /// Rows of `sky_radiance_sample.csv`.
    const ROWS: [Row; 3] = [
        (
            0.1,
            [0.866_025_403_784_438_6, 0.0, 0.5],
            [0.5, 0.0, 0.866_025_403_784_438_7],
            [0.886_601_14, 0.756_619_03, 0.586_775_85],
            [0.015_479_477, 0.036_416_87, 0.070_990_082],
        ),
        (
            0.1,
            [0.866_025_403_784_438_6, 0.0, 0.5],
            [0.997_564_050_259_824_2, 0.0, -0.069_756_473_744_125_33],
            [0.886_601_14, 0.756_619_03, 0.586_775_85],
            [0.000_528_036_91, 0.000_389_629_22, 0.000_681_041_91],
        ),
        (
            400.0,
            [0.941_124_260_355_029_6, 0.0, -0.338_060_832_648_797_77],
            [-0.941_124_260_355_029_6, 0.0, 0.338_060_832_648_797_77],
            [0.050_954_8, 0.001_067_551_4, 3.747_163_7e-7],
            [0.068_065_208, 0.062_202_033, 0.111_635_37],
        ),
    ];

    #[test]
    fn agrees_with_the_published_rays() {
        for (i, (height_km, view, sun, t, l1)) in ROWS.into_iter().enumerate() {
            let from = DVec3::Z * (6360.0 + height_km) * KM;
            let out = single_scattering(&earth(), from, view.into(), sun.into(), 0.2678 * DEG, 600);
            let single = out.single * IRRADIANCE;
            for channel in 0..3 {
                let (dt, dl) = (out.transmittance[channel] - t[channel], single[channel] / l1[channel] - 1.0);
                assert!(dt.abs() < 2e-5, "row {i}, channel {channel}: T off by {dt}");
                assert!(dl.abs() < 2e-3, "row {i}, channel {channel}: L1 off by {dl}");
            }
        }
    }

    #[test]
    fn the_sky_overhead_has_its_closed_form() {
        // Straight up, optical depth is Σ β H (1 − e^(−top/H)) + ½ tent · width.
        let t = transmittance_to_top(&earth(), 6.36e6, 1.0, 4000);
        let blue = 33.1e-6 * 8000.0 * (1.0 - libm::exp(-7.5)) + 4.44e-6 * 1200.0 + 0.085e-6 * 15_000.0;
        assert!((t.z - libm::exp(-blue)).abs() < 1e-6);
    }

    #[test]
    fn rays_that_miss_bring_nothing() {
        let out = single_scattering(&earth(), DVec3::Z * 7.0e6, DVec3::Z, DVec3::Z, 0.005, 8);
        assert_eq!((out.single, out.transmittance), (DVec3::ZERO, DVec3::ONE));
        assert!(span(&earth(), DVec3::Z * 7.0e6, DVec3::NEG_Z).unwrap().hits_ground);
    }
}
