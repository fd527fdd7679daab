//! throw-away
use engine::air::{Air, Layer, Medium, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, probe};
use glam::{DVec3, Vec3};
pub fn planet(name: &str) -> Medium {
    let (rayleigh, mie, ozone, top) = match name {
        "thin" => (0.05, 0.05, 0.0, 6.0e4),
        "thick" => (8.0, 1.0, 1.0, 8.0e4),
        "hazy" => (1.0, 10.0, 1.0, 6.0e4),
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
fn main() {
    let gpu = Gpu::headless(BackendChoice::Auto).unwrap();
    let text = std::fs::read_to_string("tests/reference/sky_radiance_sample.csv").unwrap();
    for of in ["earth", "thin", "thick"] {
        let mut rays = vec![]; let mut truth = vec![]; let mut ids = vec![];
        for line in text.lines().skip(1).filter(|l| l.split(',').next() == Some(of)) {
            let f: Vec<&str> = line.split(',').collect();
            let v = |i: usize| -> f64 { f[i].parse().unwrap() };
            let eye = DVec3::new(v(2), v(3), v(4)) * 1e3;
            let a = |d: DVec3, w: f64| [d.x as f32, d.y as f32, d.z as f32, w as f32];
            rays.push(ProbeRay { up: a(eye.normalize(), eye.length() - 6.36e6), ray: a(DVec3::new(v(5), v(6), v(7)), 0.0), sun: a(DVec3::new(v(8), v(9), v(10)), 0.2678_f64.to_radians()) });
            truth.push([v(13), v(14), v(15)]); ids.push((f[1].to_owned(), f[12].to_owned()));
        }
        for steps in [4u32, 8, 12, 16, 24, 48] {
            let air: Air = planet(of).into();
            let out = probe(&gpu, &ShaderLibrary::checkout(), &air, &rays, &ProbeOptions { steps, multiple: false, ..Default::default() }).unwrap();
            let (mut s, mut m, mut t) = (0.0_f64, 0.0_f64, 0.0_f64); let mut who = String::new(); let mut n = 0.0;
            for ((o, tr), id) in out.iter().zip(&truth).zip(&ids) {
                let (c, e) = match id.1.as_str() { "680" => (0, 1.474), "550" => (1, 1.8504), _ => (2, 1.91198) };
                t = t.max((f64::from(o.transmittance[c]) - tr[0]).abs());
                if tr[2] < 1e-7 { continue; }
                let r = f64::from(o.radiance[c]) * e / tr[1] - 1.0;
                if steps == 12 && std::env::args().nth(1).is_some() { println!("{of} {id:?} {:+.3} %  of {:.2e}", r * 100.0, tr[1]); }
                s += r * r; n += 1.0;
                if r.abs() > m { m = r.abs(); who = format!("{id:?}"); }
            }
            println!("{of} {steps}: rms {:.3} % worst {:.2} % {who} T {t:.1e}", (s / n).sqrt() * 100.0, m * 100.0);
        }
    }
}
