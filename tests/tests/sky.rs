//! The sky that is drawn, against published radiances, and its tables against the f64 integrator.
//!
//! `reference/sky_radiance_sample.csv`: spectral radiances by a double-precision quadrature (single scattering) and Monte Carlo
//! (all orders); its planets are written down in [`planet`].

use engine::air::{Layer, Medium, Phase, Profile, reference};
use engine::gpu::{Gpu, ShaderLibrary, readback};
use engine::render::pass::air_tables::AirBaker;
use engine::render::pass::sky::STEPS;
use engine::render::pass::sky_probe::{ProbeLight, ProbeOptions, ProbeRay, probe};
use engine::space::relative::{narrow, narrow3};
use glam::{DVec3, Vec3};

const SUN_RAD: f64 = 0.2678 * engine::units::DEG;
/// Solar irradiance at 680, 550, 440 nm, W m⁻² nm⁻¹.
const IRRADIANCE: [f64; 3] = [1.474, 1.8504, 1.911_98];

fn planet(name: &str) -> Medium {
    let (rayleigh, mie, ozone, top) = match name {
        "thin" => (0.05, 0.05, 0.0, 6.0e4),
        "thick" => (8.0, 1.0, 1.0, 8.0e4),
        _ => (1.0, 1.0, 1.0, 6.0e4),
    };
    let layer = |scattering_per_m, absorption_per_m, profile, phase| Layer { scattering_per_m, absorption_per_m, profile, phase };
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    Medium {
        bottom_radius_m: 6.36e6,
        top_altitude_m: top,
        ground_albedo: Vec3::splat(0.1),
        layers: vec![
            layer(Vec3::new(5.802e-6, 13.558e-6, 33.1e-6) * rayleigh, Vec3::ZERO, exponential(8000.0), Phase::Rayleigh),
            layer(Vec3::splat(3.996e-6 * mie), Vec3::splat(0.444e-6 * mie), exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
            layer(
                Vec3::ZERO,
                Vec3::new(0.6497e-6, 1.881e-6, 0.085e-6) * ozone,
                Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 },
                Phase::Rayleigh,
            ),
        ],
    }
}

/// A ray with its three wavelengths: T, L1, L_total.
struct Row {
    id: String,
    ray: ProbeRay,
    truth: [[f64; 3]; 3],
}

fn rows(of: &str) -> Vec<Row> {
    let text = include_str!("../reference/sky_radiance_sample.csv");
    let mut rows: Vec<Row> = Vec::new();
    for line in text.lines().skip(1).filter(|l| l.split(',').next() == Some(of)) {
        let f: Vec<&str> = line.split(',').collect();
        let v = |i: usize| -> f64 { f[i].parse().expect("a number") };
        let eye = DVec3::new(v(2), v(3), v(4)) * 1e3;
        let altitude = eye.length() - 6.36e6;
        if rows.last().is_none_or(|r| r.id != f[1]) {
            let vec4 = |d: DVec3, w: f64| [narrow(d.x), narrow(d.y), narrow(d.z), narrow(w)];
            let ray = ProbeRay {
                up: vec4(eye.normalize(), altitude),
                ray: vec4(DVec3::new(v(5), v(6), v(7)), 0.0),
                sun: vec4(DVec3::new(v(8), v(9), v(10)), SUN_RAD),
            };
            rows.push(Row { id: f[1].to_owned(), ray, truth: [[0.0; 3]; 3] });
        }
        let channel = match f[12] {
            "680" => 0,
            "550" => 1,
            _ => 2,
        };
        let row = rows.last_mut().expect("one was pushed");
        (0..3).for_each(|k| row.truth[k][channel] = v(13 + k));
    }
    assert!(!rows.is_empty());
    rows
}

fn march(gpu: &Gpu, medium: &Medium, rays: &[ProbeRay], options: ProbeOptions) -> Vec<ProbeLight> {
    let found = probe(gpu, &ShaderLibrary::checkout(), &medium.clone().into(), rays, &options).expect("it marches");
    assert_eq!(gpu.take_error(), None);
    found
}

/// Worst and mean relative error of radiance where it is not next to nothing, and worst absolute error of transmittance.
fn errors(of: &str, multiple: bool, steps: u32) -> (f64, f64, f64) {
    let rows = rows(of);
    let rays: Vec<ProbeRay> = rows.iter().map(|r| r.ray).collect();
    let gpu = tests::gpu();
    let found = march(&gpu, &planet(of), &rays, ProbeOptions { steps, multiple, ..Default::default() });
    let (mut worst, mut sum, mut n, mut worst_t) = (0.0_f64, 0.0, 0.0, 0.0_f64);
    for (row, light) in rows.iter().zip(&found) {
        for channel in 0..3 {
            let radiance = f64::from(light.radiance[channel]) * IRRADIANCE[channel];
            let truth = row.truth[if multiple { 2 } else { 1 }][channel];
            let relative = (radiance / truth - 1.0).abs();
            let dt = (f64::from(light.transmittance[channel]) - row.truth[0][channel]).abs();
            println!(
                "{of} {:24} {channel}: {radiance:.4e} of {truth:.4e} ({:+.2} %), T off by {dt:.1e}",
                row.id,
                100.0 * (radiance / truth - 1.0)
            );
            if truth > 1e-5 {
                worst = worst.max(relative);
                sum += relative;
                n += 1.0;
            }
            worst_t = worst_t.max(dt);
        }
    }
    println!("{of}: worst {worst:.4}, mean {:.4}, T {worst_t:.1e}", sum / n);
    (worst, sum / n, worst_t)
}

#[test]
fn single_scattering_is_the_published_one() {
    for (of, worst_allowed, mean_allowed) in [("earth", 0.01, 0.0015), ("thin", 0.004, 0.002), ("thick", 0.04, 0.006)] {
        let (worst, mean, t) = errors(of, false, STEPS);
        assert!(worst < worst_allowed && mean < mean_allowed, "{of}: worst {worst}, mean {mean}");
        assert!(t < 0.025, "{of}: transmittance off by {t}");
    }
}

#[test]
fn the_transmittance_table_is_the_integral() {
    let gpu = tests::gpu();
    let medium = planet("earth");
    let mut baker = AirBaker::new(&gpu, &ShaderLibrary::checkout()).expect("it compiles");
    baker.bake_alone(&gpu, &medium.clone().into());
    let table = readback::texture_f32(&gpu, &baker.textures()[0].texture, 0).expect("it can be read");
    let texel = |x: usize, y: usize, c: usize| 1.0 - f64::from(table[(y * 128 + x) * 4 + c]);
    let (bottom, top) = (medium.bottom_radius_m, medium.bottom_radius_m + medium.top_altitude_m);
    let whole = (top * top - bottom * bottom).sqrt();
    let mut worst = 0.0_f64;
    // Between texels, as the sky asks it: the shader's map, and bilinear interpolation of fourth roots.
    for altitude in [2.0, 150.0, 3.0e3, 1.1e4, 3.3e4, 5.5e4] {
        let r = bottom + altitude;
        let rho = (altitude * (2.0 * bottom + altitude)).sqrt();
        let horizon = -rho / r;
        for k in 0..60 {
            let x = f64::from(k) / 59.0;
            let mu = horizon + (1.0 - horizon) * x * x * x;
            let reach = -r * mu + (r * r * (mu * mu - 1.0) + top * top).sqrt();
            let (least, most) = (top - r, rho + whole);
            let (u, v) = ((reach - least) / (most - least) * 127.0, rho / whole * 127.0);
            let truth = reference::transmittance_to_top(&medium, r, mu);
            let (i, j) = ((u.floor() as usize).min(126), (v.floor() as usize).min(126));
            let (a, b) = (u - i as f64, v - j as f64);
            for c in 0..3 {
                let low = texel(i, j, c) * (1.0 - a) + texel(i + 1, j, c) * a;
                let high = texel(i, j + 1, c) * (1.0 - a) + texel(i + 1, j + 1, c) * a;
                let error = ((low * (1.0 - b) + high * b).powi(4) - truth[c]).abs();
                if error > 1e-3 {
                    println!("h {altitude} m, mu {mu}: channel {c} off by {error:.2e}");
                }
                worst = worst.max(error);
            }
        }
    }
    println!("worst: {worst:.2e}");
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn nothing_is_nan_wherever_one_stands() {
    let gpu = tests::gpu();
    let medium = planet("earth");
    let mut rays = Vec::new();
    for altitude in [-400.0, 0.0, 2.0, 1.0e3, 5.99e4, 6.0e4, 6.001e4, 4.0e5, 6.0e7] {
        for i in 0..64 {
            let a = f64::from(i) / 63.0 * std::f64::consts::PI;
            for s in [-1.0, -0.1, 0.0, 0.3, 1.0_f64] {
                let (d, sun) = (narrow3(DVec3::new(a.sin(), 0.0, a.cos())), narrow3(DVec3::new((1.0 - s * s).sqrt(), 0.0, s)));
                rays.push(ProbeRay { up: [0.0, 0.0, 1.0, altitude as f32], ray: [d.x, d.y, d.z, 0.0], sun: [sun.x, sun.y, sun.z, 0.0047] });
            }
        }
    }
    let found = march(&gpu, &medium, &rays, ProbeOptions::default());
    for (ray, light) in rays.iter().zip(found) {
        let fine = light.radiance.iter().all(|x| x.is_finite() && *x >= 0.0) && light.transmittance.iter().all(|x| (0.0..=1.0).contains(x));
        assert!(fine, "{ray:?}: {light:?}");
    }
}
