//! The reference against closed forms and published rays. The whole of the published sample is in `tests/tests/sky_truth.rs`.

use super::*;
use crate::air::medium::tests::earth;
use crate::air::{Layer, MediumSpec, Phase, Profile};
use crate::units::{DEG, KM};
use glam::Vec3;

/// Solar irradiance at 680, 550 and 440 nm, W m⁻² nm⁻¹.
const IRRADIANCE: DVec3 = DVec3::new(1.474, 1.8504, 1.91198);

fn ray(from_m: DVec3, direction: DVec3, sun: DVec3) -> Ray {
    Ray { from_m, direction, sun, sun_rad: 0.2678 * DEG, occluders: Vec::new() }
}

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
        let ray = ray(DVec3::Z * (6360.0 + height_km) * KM, view.into(), sun.into());
        let out = &radiance(&earth(), &[ray], &Options { max_walks: 0, ..Options::default() })[0];
        let single = out.single * IRRADIANCE;
        for channel in 0..3 {
            let (dt, dl) = (out.transmittance[channel] - t[channel], single[channel] / l1[channel] - 1.0);
            assert!(dt.abs() < 2e-5, "row {i}, channel {channel}: T off by {dt}");
            assert!(dl.abs() < 1e-4, "row {i}, channel {channel}: L1 off by {dl}");
        }
    }
}

#[test]
fn the_sky_overhead_has_its_closed_form() {
    // Straight up, optical depth is Σ β H (1 − e^(−top/H)) + ½ tent · width.
    let t = transmittance_to_top(&earth(), 6.36e6, 1.0);
    let blue = 33.1e-6 * 8000.0 * (1.0 - libm::exp(-7.5)) + 4.44e-6 * 1200.0 + 0.085e-6 * 15_000.0;
    assert!((t.z - libm::exp(-blue)).abs() < 1e-7);
}

#[test]
fn rays_that_miss_bring_nothing() {
    let out = radiance(&earth(), &[ray(DVec3::Z * 7.0e6, DVec3::Z, DVec3::Z)], &Options::default())[0];
    assert_eq!((out.total, out.transmittance), (DVec3::ZERO, DVec3::ONE));
    assert!(span(&earth(), DVec3::Z * 7.0e6, DVec3::NEG_Z).unwrap().hits_ground);
}

/// A slab: a planet so large that its air is flat, of constant density, conservative where `absorption` is 0.
fn slab(depth: f32, albedo_of_scattering: f32, ground: f32, phase: Phase) -> Medium {
    let thickness_m = 1.0e4;
    let extinction = depth / thickness_m;
    MediumSpec {
        top_altitude_m: f64::from(thickness_m),
        ground_albedo: Vec3::splat(ground),
        layers: vec![Layer {
            scattering_per_m: Vec3::splat(extinction * albedo_of_scattering),
            absorption_per_m: Vec3::splat(extinction * (1.0 - albedo_of_scattering)),
            profile: Profile::Constant { bottom_m: 0.0, top_m: 1.0e6 },
            phase,
        }],
    }
    .build(1.0e9)
    .unwrap()
}

/// Radiance that leaves the top of a slab straight up or slantwise, in units where a white surface that faces the sun has 1.
fn reflected(medium: &Medium, mu: f64, mu_sun: f64, rel_error: f64) -> (f64, f64) {
    let slant = |mu: f64| DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
    let top = DVec3::Z * (medium.bottom_radius_m + medium.top_altitude_m);
    let from = top + slant(mu) * 10.0;
    let ray = Ray { sun_rad: 1e-4, ..ray(from, -slant(mu), slant(mu_sun)) };
    let out = radiance(medium, &[ray], &Options { rel_error, ..Options::default() })[0];
    let x = core::f64::consts::PI * out.total.x / mu_sun;
    (x, x * out.std_error.x / out.total.x)
}

#[test]
fn a_thick_isotropic_slab_reflects_as_chandrasekhar_says() {
    // Semi-infinite: I = F ω/4 μ₀/(μ+μ₀) H(μ) H(μ₀), πF the flux [Chandrasekhar 1950, §34].
    for (albedo, depth) in [(0.8_f32, 40.0), (0.95, 60.0)] {
        let medium = slab(depth, albedo, 0.0, Phase::Isotropic);
        for (mu, mu_sun) in [(1.0, 0.5), (0.4, 0.8)] {
            let (found, error) = reflected(&medium, mu, mu_sun, 4e-3);
            let truth = f64::from(albedo) / 4.0 / (mu + mu_sun) * h_function(albedo.into(), mu) * h_function(albedo.into(), mu_sun);
            assert!(
                (found / truth - 1.0).abs() < 3.0 * error / truth + 2e-3,
                "ω {albedo}, μ {mu}, μ₀ {mu_sun}: {found} ± {error}, not {truth}"
            );
        }
    }
}

/// Chandrasekhar's H for isotropic scattering: `1/H(μ) = √(1−ω) + (ω/2) ∫ μ' H(μ') / (μ+μ') dμ'` [1950, §37, eq. 12].
fn h_function(albedo: f64, mu: f64) -> f64 {
    let n = 200;
    let node = |i: usize| (i as f64 + 0.5) / n as f64;
    let mut h = vec![1.0; n];
    let at = |h: &[f64], mu: f64| {
        let sum: f64 = h.iter().enumerate().map(|(i, h)| node(i) * h / (mu + node(i))).sum();
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * sum / n as f64)
    };
    for _ in 0..200 {
        h = (0..n).map(|i| at(&h, node(i))).collect();
    }
    at(&h, mu)
}

#[test]
fn the_h_function_has_its_known_moment() {
    // ∫ H dμ = (2/ω)(1 − √(1−ω)) [Chandrasekhar 1950, §37, eq. 13].
    for albedo in [0.5, 0.8, 0.95] {
        let mean = (0..50).map(|i| h_function(albedo, (f64::from(i) + 0.5) / 50.0)).sum::<f64>() / 50.0;
        let truth = 2.0 / albedo * (1.0 - (1.0 - albedo).sqrt());
        assert!((mean / truth - 1.0).abs() < 1e-3, "ω {albedo}: {mean}, not {truth}");
    }
}

#[test]
fn what_comes_in_goes_out() {
    // A conservative slab over white ground: whatever the phase function, flux up at the top is the sun's, so that the mean of
    // the radiance over directions by cosine is the white surface's.
    for (phase, depth) in [(Phase::Isotropic, 1.0), (Phase::HenyeyGreenstein { g: 0.6 }, 3.0)] {
        let medium = slab(depth, 1.0, 1.0, phase.clone());
        let (mu_sun, n) = (0.6_f64, 12);
        let (mut sum, mut square) = (0.0, 0.0);
        let top = DVec3::Z * (medium.bottom_radius_m + medium.top_altitude_m);
        let sun = DVec3::new((1.0 - mu_sun * mu_sun).sqrt(), 0.0, mu_sun);
        let mut rays = Vec::new();
        for i in 0..n {
            for j in 0..8 {
                // Equal parts of μ dμ, and azimuths.
                let mu = ((f64::from(i) + 0.5) / f64::from(n)).sqrt();
                let (sin, cos) = ((f64::from(j) + 0.5) / 8.0 * core::f64::consts::PI).sin_cos();
                let s = (1.0 - mu * mu).sqrt();
                let out = DVec3::new(s * cos, s * sin, mu);
                rays.push(Ray { sun_rad: 1e-4, ..ray(top + out * 10.0, -out, sun) });
            }
        }
        let (sky, sky_error) = sky_irradiance(&medium, &rays[0], &Options { rel_error: 2e-3, ..Options::default() });
        let (ground, ground_error) = (sky.x + mu_sun * libm::exp(-f64::from(depth) / mu_sun), sky_error.x);
        for found in radiance(&medium, &rays, &Options { rel_error: 1e-2, max_walks: 1024, ..Options::default() }) {
            // The radiance leaves out ground that is seen directly: white, and lit by sun and sky alike wherever one looks.
            let weight = core::f64::consts::PI / mu_sun / rays.len() as f64;
            sum += (found.total.x + found.transmittance.x * ground / core::f64::consts::PI) * weight;
            square += found.std_error.x * found.std_error.x * weight * weight;
        }
        let error = square.sqrt() + ground_error;
        assert!((sum - 1.0).abs() < 3.0 * error + 4e-3, "{phase:?}: {sum} ± {error}");
    }
}

#[test]
fn light_takes_the_same_way_back() {
    // Helmholtz: a flat slab reflects from μ₀ to μ as from μ to μ₀, in units of a white surface.
    let medium = slab(2.0, 0.9, 0.0, Phase::CornetteShanks { g: 0.5 });
    let (there, e1) = reflected(&medium, 0.9, 0.35, 4e-3);
    let (back, e2) = reflected(&medium, 0.35, 0.9, 4e-3);
    assert!((there - back).abs() < 3.0 * e1.hypot(e2) + 1e-3 * there, "{there} ± {e1} and {back} ± {e2}");
}

#[test]
fn orders_add_up_to_the_whole() {
    let ray = ray(DVec3::Z * 6.3601e6, DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.8, 0.6));
    let whole = radiance(&earth(), std::slice::from_ref(&ray), &Options { rel_error: 3e-3, ..Options::default() })[0];
    let orders = radiance_by_order(&earth(), &ray, 12, 40_000, 1);
    let sum: DVec3 = orders.iter().map(|o| o.0).sum();
    for channel in 0..3 {
        let error: f64 = orders.iter().map(|o| o.1[channel]).sum::<f64>() + whole.std_error[channel];
        assert!((sum[channel] - whole.total[channel]).abs() < 3.0 * error, "channel {channel}: {sum} and {}", whole.total);
        assert!(orders.windows(2).all(|w| w[1].0[channel] < w[0].0[channel]), "each order is dimmer than the one before");
    }
    assert_eq!(orders[0].0, whole.single);
}

#[test]
fn the_answer_does_not_depend_on_threads() {
    let rays: Vec<Ray> =
        (0..3).map(|i| ray(DVec3::Z * 6.3601e6, DVec3::new(0.8, 0.0, 0.6), DVec3::new(0.1 * f64::from(i), 0.0, 0.9))).collect();
    let options = Options { rel_error: 0.05, ..Options::default() };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| radiance(&earth(), &rays, &options));
    let many = rayon::ThreadPoolBuilder::new().num_threads(5).build().unwrap().install(|| radiance(&earth(), &rays, &options));
    assert_eq!(one, many);
    assert_ne!(one, radiance(&earth(), &rays, &Options { seed: 1, ..options }));
}

#[test]
fn an_occluder_darkens_what_it_covers() {
    // The Moon over the eye, seen along the axis of its shadow: no direct light near the ground, some from beyond the umbra.
    let sun = DVec3::Z;
    let moon = Sphere { centre_m: sun * 3.7e8, radius_m: 1.7374e6 };
    let free = ray(DVec3::Z * 6.36e6, DVec3::new(0.6, 0.0, 0.8), sun);
    let hidden = Ray { occluders: vec![moon], ..free.clone() };
    let options = Options { rel_error: 0.02, max_walks: 1 << 16, ..Options::default() };
    let found = radiance(&earth(), &[free, hidden], &options);
    let ratio = found[1].total / found[0].total;
    assert!(ratio.max_element() < 0.01 && ratio.min_element() > 0.0, "{ratio}");
    // Along the axis itself the umbra holds every point of the ray: nothing is scattered once.
    let axis = Ray { direction: sun, occluders: vec![moon], ..ray(DVec3::Z * 6.36e6, sun, sun) };
    assert_eq!(radiance(&earth(), &[axis], &Options { max_walks: 0, ..options })[0].single, DVec3::ZERO);
}

#[test]
fn nothing_is_nan_wherever_one_stands() {
    let none = Medium { layers: Vec::new(), ..earth() };
    let sharp = slab(8.0, 0.9, 0.5, Phase::HenyeyGreenstein { g: -0.99 });
    let options = Options { rel_error: 1.0, max_walks: 1, single_error: 1e-2, ..Options::default() };
    for medium in [earth(), none, sharp] {
        let (bottom, top) = (medium.bottom_radius_m, medium.bottom_radius_m + medium.top_altitude_m);
        let mut rays = Vec::new();
        for r in [0.0, 1.0, bottom - 400.0, bottom, bottom + 1e-6, top, top + 1e-3, 3.0 * top] {
            for (direction, sun) in [(DVec3::Z, DVec3::Z), (DVec3::NEG_Z, DVec3::Y), (DVec3::X, DVec3::NEG_Z), (DVec3::X, DVec3::X)] {
                rays.push(ray(DVec3::Z * r, direction, sun));
            }
        }
        for (ray, found) in rays.iter().zip(radiance(&medium, &rays, &options)) {
            let all = [found.total, found.single, found.std_error, found.transmittance];
            assert!(all.iter().all(|v| v.is_finite() && v.min_element() >= 0.0), "{ray:?}: {found:?}");
        }
    }
}
