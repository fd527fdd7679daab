//! Twin: the model `limb_table` as it is drawn against its formula in f64, from outside by the table, from inside by the march.

use engine::air::model::LimbTable;
use engine::air::model::limb_table::ShellRay;
use engine::air::{Air, Medium, Model};
use engine::gpu::ShaderLibrary;
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, probe};
use engine::space::relative::narrow;
use glam::{DVec3, Vec3};

const R: f64 = 3.4e6;
const TOP: f64 = 8.0e4;

fn air(model: LimbTable, top_altitude_m: f64) -> Air {
    let medium = Medium { bottom_radius_m: R, top_altitude_m, ground_albedo: Vec3::ZERO, layers: Vec::new() };
    Air { model: Model::LimbTable(model), ..Air::from(medium) }
}

fn vec4(v: DVec3, w: f64) -> [f32; 4] {
    [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)]
}

/// Even on the sphere, the same every time.
fn direction(i: u32) -> DVec3 {
    let z = 1.0 - 2.0 * (f64::from(i) * 0.618_033_988_75).fract();
    let a = f64::from(i) * 2.399_963_23;
    DVec3::new((1.0 - z * z).sqrt() * a.cos(), (1.0 - z * z).sqrt() * a.sin(), z)
}

struct Asked {
    ray: ProbeRay,
    truth: DVec3,
}

fn asked(eye: DVec3, ray: DVec3, sun: DVec3, truth: DVec3) -> Asked {
    let altitude = eye.length() - R;
    Asked { ray: ProbeRay { up: vec4(eye.normalize(), altitude), ray: vec4(ray, 0.0), sun: vec4(sun, 0.0047) }, truth }
}

/// Mean and worst error over the brightest there is.
fn errors(model: &LimbTable, asked: &[Asked]) -> (f64, f64) {
    let rays: Vec<ProbeRay> = asked.iter().map(|a| a.ray).collect();
    let gpu = tests::gpu();
    let found = probe(&gpu, &ShaderLibrary::checkout(), &air(model.clone(), TOP), &rays, &ProbeOptions::default()).expect("it is probed");
    assert_eq!(gpu.take_error(), None);
    let brightest = asked.iter().map(|a| a.truth.z).fold(0.0, f64::max);
    let (mut sum, mut worst) = (0.0, 0.0_f64);
    for (a, light) in asked.iter().zip(&found) {
        assert_eq!(light.transmittance, [1.0; 4], "it adds, and takes nothing away");
        let error = (f64::from(light.radiance[2]) - a.truth.z).abs() / brightest;
        assert!(error < 0.05, "{:?}: {:?}, not {}", a.ray, light.radiance, a.truth);
        (sum, worst) = (sum + error, worst.max(error));
    }
    (sum / found.len() as f64, worst)
}

#[test]
fn from_outside_by_the_table() {
    let fine = LimbTable { march_step_radii: 2e-4, ..LimbTable::default() };
    let mut all = Vec::new();
    for i in 0..1500 {
        let eye = direction(i) * R * (1.03 + 6.0 * (f64::from(i) * 0.37).fract());
        let miss = direction(i + 7000) * (R + TOP) * (0.5 + 0.5 * (f64::from(i) * 0.73).fract());
        let ray = (miss - eye).normalize();
        let sun = direction(i + 90_000);
        all.push(asked(eye, ray, sun, fine.from_outside(R, TOP, eye, ray, sun)));
    }
    let (mean, worst) = errors(&fine, &all);
    println!("outside: mean {mean:.2e}, worst {worst:.2e}");
    assert!(mean < 1e-3 && worst < 0.02, "mean {mean}, worst {worst}");
}

#[test]
fn from_inside_by_the_march() {
    let model = LimbTable::default();
    let mut all = Vec::new();
    for i in 0..1500 {
        let altitude = TOP * (f64::from(i) * 0.37).fract();
        let (up, ray, sun) = (direction(i), direction(i + 7000), direction(i + 90_000));
        let inner = ShellRay { radius_m: R, top_m: TOP, altitude_m: altitude, mu: ray.dot(up), mu_s: sun.dot(up), nu: ray.dot(sun) };
        let truth = model.light_scale_per_sr.as_dvec3() * model.lit_column(&inner, inner.end_m().0, 2000);
        all.push(asked(up * (R + altitude), ray, sun, truth));
    }
    let (mean, worst) = errors(&model, &all);
    println!("inside: mean {mean:.2e}, worst {worst:.2e}");
    assert!(mean < 1e-3 && worst < 0.01, "mean {mean}, worst {worst}");
}

#[test]
fn nothing_pops_at_the_top() {
    let model = LimbTable { march_step_radii: 2e-4, ..LimbTable::default() };
    let rays: Vec<ProbeRay> = (0..2000)
        .flat_map(|i| {
            let (up, ray, sun) = (direction(i), direction(i + 7000), direction(i + 90_000));
            [-1.0, 1.0].map(|step| asked(up * (R + TOP + step), ray, sun, DVec3::ZERO).ray)
        })
        .collect();
    let gpu = tests::gpu();
    let found = probe(&gpu, &ShaderLibrary::checkout(), &air(model, TOP), &rays, &ProbeOptions::default()).expect("it is probed");
    let brightest = found.iter().map(|l| l.radiance[2]).fold(0.0, f32::max);
    let worst = found.chunks_exact(2).map(|p| (p[0].radiance[2] - p[1].radiance[2]).abs() / brightest).fold(0.0, f32::max);
    println!("at the top: {worst:.2e} of the brightest");
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn nothing_is_nan_wherever_one_stands() {
    let gpu = tests::gpu();
    for (top, exponent) in [(TOP, 3.0), (100.0, 0.0), (R, 32.0)] {
        let mut rays = Vec::new();
        for altitude in [-R, -400.0, 0.0, 2.0, 0.5 * top, top, top + 0.5, 4.0e5, 6.0e7] {
            for i in 0..40 {
                let mu = (std::f64::consts::PI * f64::from(i) / 39.0).cos();
                for s in [-1.0, -0.1, 0.0, 0.3, 1.0_f64] {
                    rays.push(ProbeRay {
                        up: vec4(DVec3::Z, altitude),
                        ray: vec4(DVec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu), 0.0),
                        sun: vec4(DVec3::new((1.0 - s * s).sqrt(), 0.0, s), 0.0047),
                    });
                }
            }
        }
        let model = LimbTable { density_exponent: exponent, ..LimbTable::default() };
        let found = probe(&gpu, &ShaderLibrary::checkout(), &air(model, top), &rays, &ProbeOptions::default()).expect("it is probed");
        for (ray, light) in rays.iter().zip(found) {
            assert!(light.radiance.iter().all(|x| x.is_finite() && *x >= 0.0), "{ray:?}: {light:?}");
        }
    }
}
