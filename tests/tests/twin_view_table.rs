//! Twin: the model `view_table` as it is drawn against its formulas in f64: entries of its tables, the difference of optical depths
//! [Elek 2008, eq. 3.9], and what is seen before a surface.

use engine::air::model::ViewTable;
use engine::air::model::view_space::Spacing;
use engine::air::model::view_table::Split;
use engine::air::{Air, Layer, Medium, Model, Phase, Profile, reference};
use engine::gpu::{Gpu, ShaderLibrary};
use engine::render::pass::sky_probe::{ProbeLight, ProbeOptions, ProbeRay, probe};
use engine::render::{OffscreenImage, Renderer, RendererOptions, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Snapshot, Star, Surface};
use engine::space::relative::narrow;
use glam::{DVec3, Quat, Vec3};

/// An Earth of air and aerosol.
fn medium() -> Medium {
    let layer = |scattering, absorption, height, phase| Layer {
        scattering_per_m: scattering,
        absorption_per_m: Vec3::splat(absorption),
        profile: Profile::Exponential { scale_height_m: height },
        phase,
    };
    Medium {
        bottom_radius_m: 6.36e6,
        top_altitude_m: 1.0e5,
        ground_albedo: Vec3::splat(0.1),
        layers: vec![
            layer(Vec3::new(5.8e-6, 13.6e-6, 33.1e-6), 0.0, 8000.0, Phase::Rayleigh),
            layer(Vec3::splat(4e-6), 4e-7, 1200.0, Phase::CornetteShanks { g: 0.8 }),
        ],
    }
}

fn vec4(v: DVec3, w: f64) -> [f32; 4] {
    [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)]
}

fn ask(gpu: &Gpu, medium: &Medium, model: &ViewTable, rays: &[ProbeRay]) -> Vec<ProbeLight> {
    let air = Air { model: Model::ViewTable(model.clone()), ..Air::from(medium.clone()) };
    let found = probe(gpu, &ShaderLibrary::checkout(), &air, rays, &ProbeOptions::default()).expect("it is probed");
    assert_eq!(gpu.take_error(), None);
    found
}

/// Rays from heights, at angles to the zenith and to the sun, and azimuths.
fn views() -> Vec<(f64, f64, f64, f64)> {
    let mut all = Vec::new();
    for h in [2.0, 900.0, 7.0e3, 3.1e4, 9.9e4] {
        for phi in [3.0, 40.0, 75.0, 88.0, 91.5, 100.0, 125.0, 170.0_f64] {
            for delta in [10.0, 55.0, 80.0, 89.0, 94.0_f64] {
                all.push((h, phi.to_radians(), delta.to_radians(), (37.0 * phi + 11.0 * delta) % 180.0));
            }
        }
    }
    all
}

fn probe_ray(h: f64, phi: f64, delta: f64, azimuth_deg: f64, surface_m: f64) -> ProbeRay {
    let (s, c) = azimuth_deg.to_radians().sin_cos();
    ProbeRay {
        up: vec4(DVec3::Z, h),
        ray: vec4(DVec3::new(phi.sin() * c, phi.sin() * s, phi.cos()), surface_m),
        sun: vec4(DVec3::new(delta.sin(), 0.0, delta.cos()), 0.0047),
    }
}

fn errors(model: &ViewTable) -> (f64, f64) {
    let medium = medium();
    let split = Split::new(&medium);
    let views = views();
    let rays: Vec<ProbeRay> = views.iter().map(|v| probe_ray(v.0, v.1, v.2, v.3, 0.0)).collect();
    let (mut sum, mut worst, mut n) = (0.0, 0.0_f64, 0.0);
    for (light, (view, ray)) in ask(&tests::gpu(), &medium, model, &rays).iter().zip(views.iter().zip(&rays)) {
        let (h, phi, delta, _) = *view;
        let entry = model.entry(&medium, &split, h, phi, delta);
        let nu = (0..3).map(|i| f64::from(ray.ray[i]) * f64::from(ray.sun[i])).sum::<f64>();
        let truth = model.radiance(&split, entry, nu);
        if truth.y > 1e-5 {
            let error = (f64::from(light.radiance[1]) / truth.y - 1.0).abs();
            if error > 0.1 {
                println!("{view:?}: {:?}, not {truth}", light.radiance);
            }
            (sum, worst, n) = (sum + error, worst.max(error), n + 1.0);
        }
    }
    println!("{:?}: mean {:.4}, worst {worst:.4} of {n}", model.spacing, sum / n);
    (sum / n, worst)
}

#[test]
fn the_table_is_the_formula() {
    let (mean, worst) = errors(&ViewTable { samples: 30, ..ViewTable::default() });
    assert!(mean < 0.01 && worst < 0.1, "mean {mean}, worst {worst}");
}

#[test]
fn even_entries_are_the_formula_less_closely() {
    let even = ViewTable { spacing: Spacing::Uniform, samples: 50, ..ViewTable::default() };
    let (mean, _) = errors(&even);
    assert!((0.02..0.5).contains(&mean), "mean {mean}");
}

#[test]
fn the_difference_of_two_depths_keeps_its_digits() {
    // From a hand's breadth to the horizon: [eq. 3.9] in f32 against the integral.
    let medium = medium();
    let mut rays = Vec::new();
    let mut truths = Vec::new();
    for h in [0.3, 2.0, 50.0, 1.0e3, 1.0e4, 8.0e4] {
        for mu in [-1.0, -0.5, -0.1, -0.02, -0.003, 0.0, 0.2] {
            for distance in [0.1, 3.0, 100.0, 900.0, 2.0e3, 5.0e3, 2.0e4, 1.0e5] {
                let r = medium.bottom_radius_m + h;
                let there = (r * r + 2.0 * r * mu * distance + distance * distance).sqrt() - medium.bottom_radius_m;
                // Only what lies above the ground on the way, too.
                if there < 0.0
                    || there > medium.top_altitude_m
                    || (mu < 0.0 && distance > -r * mu && r * (1.0 - mu * mu).sqrt() < medium.bottom_radius_m)
                {
                    continue;
                }
                rays.push(probe_ray(h, f64::acos(mu), 0.6, 20.0, distance));
                let ray = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                truths.push((h, mu, distance, reference::optical_depth(&medium, DVec3::Z * r, ray, (0.0, distance), 1e-9)));
            }
        }
    }
    let mut worst = 0.0_f64;
    for (light, (h, mu, distance, truth)) in ask(&tests::gpu(), &medium, &ViewTable::default(), &rays).iter().zip(&truths) {
        let found = -f64::from(light.transmittance[2]).ln();
        // What f32 knows of a transmittance near 1.
        let error = (found - truth.z).abs() / (truth.z + 1e-5);
        if error > 0.02 {
            println!("{h} m, {mu}, {distance} m: {found:.3e}, not {:.3e}", truth.z);
        }
        worst = worst.max(error);
    }
    println!("worst: {worst:.4} of {}", truths.len());
    assert!(worst < 0.05, "{worst}");
}

#[test]
fn before_a_surface_there_is_its_share_of_the_air() {
    // Radiance up to a surface, by difference and by the near march, against the integral of single scattering: ray by ray in the sun's plane.
    let medium = Medium { layers: medium().layers[..1].to_vec(), ..medium() };
    let (mut rays, mut truths) = (Vec::new(), Vec::new());
    let sun = DVec3::new(f64::sin(0.6), 0.0, f64::cos(0.6));
    for (h, phi) in [(2.0, 60.0), (2.0, 89.0), (1.0e3, 95.0), (1.0e4, 110.0), (1.0e4, 70.0_f64)] {
        for distance in [10.0, 300.0, 1.0e3, 2.0e3, 4.0e3, 6.0e3] {
            let phi = phi.to_radians();
            rays.push(probe_ray(h, phi, 0.6, 0.0, distance));
            let (from, ray) = (DVec3::Z * (medium.bottom_radius_m + h), DVec3::new(phi.sin(), 0.0, phi.cos()));
            // What is seen to the end of the air, less what is seen from the surface on.
            let seen = |from_m: DVec3| {
                let ray = reference::Ray { from_m, direction: ray, sun, sun_rad: ViewTable::SUN_RAD, occluders: Vec::new() };
                let options = reference::Options { max_walks: 0, single_error: 1e-6, ..reference::Options::default() };
                reference::radiance(&medium, &[ray], &options)[0].single
            };
            let through = (-reference::optical_depth(&medium, from, ray, (0.0, distance), 1e-8)).exp();
            truths.push(seen(from) - through * seen(from + ray * distance));
        }
    }
    for ((light, truth), ray) in ask(&tests::gpu(), &medium, &ViewTable::default(), &rays).iter().zip(&truths).zip(&rays) {
        let error = f64::from(light.radiance[1]) / truth.y - 1.0;
        println!("{:?} {:?}: {error:+.3}", ray.up[3], ray.ray);
        assert!(error.abs() < 0.06, "{ray:?}: {:?}, not {truth}", light.radiance);
    }
}

#[test]
fn nothing_is_nan_wherever_one_stands() {
    let dust = Layer {
        scattering_per_m: Vec3::splat(0.1),
        absorption_per_m: Vec3::splat(0.1),
        profile: Profile::Exponential { scale_height_m: 5000.0 },
        phase: Phase::CornetteShanks { g: 0.97 },
    };
    let media = [
        medium(),
        Medium { layers: Vec::new(), ..medium() },
        Medium { layers: vec![dust], ..medium() },
        Medium { bottom_radius_m: 1.0e3, top_altitude_m: 1.0e3, ..medium() },
        Medium { bottom_radius_m: 1.0e8, top_altitude_m: 100.0, ..medium() },
    ];
    let gpu = tests::gpu();
    let quick = ViewTable { samples: 12, ..ViewTable::default() };
    for medium in media {
        let top = medium.top_altitude_m;
        let mut rays = Vec::new();
        for altitude in [-medium.bottom_radius_m, -400.0, 0.0, 2.0, 0.5 * top, top, top + 0.5, 4.0e5, 6.0e7] {
            for i in 0..40 {
                for s in [-1.0, -0.1, 0.0, 0.3, 1.0_f64] {
                    for surface in [0.0, 5.0, 3.0e4] {
                        rays.push(probe_ray(altitude, std::f64::consts::PI * f64::from(i) / 39.0, s.acos(), 40.0, surface));
                    }
                }
            }
        }
        for (ray, light) in rays.iter().zip(ask(&gpu, &medium, &quick, &rays)) {
            let fine =
                light.radiance.iter().all(|x| x.is_finite() && *x >= 0.0) && light.transmittance.iter().all(|x| (0.0..=1.0).contains(x));
            assert!(fine, "{ray:?}: {light:?}");
        }
    }
}

#[test]
fn the_ground_is_lit_by_its_own_tables() {
    // A Lambert ball seen from two metres straight down: [eq. 3.6] and [eq. 3.7] on it, and next to no air before it.
    let medium = medium();
    let model = ViewTable::default();
    let split = Split::new(&medium);
    let gpu = tests::gpu();
    let mut renderer =
        Renderer::new(&gpu, RendererOptions { shaders: ShaderLibrary::checkout(), ..RendererOptions::default() }).expect("it compiles");
    let image = OffscreenImage::new(&gpu, [16, 16]);
    for delta_deg in [20.0, 60.0, 85.0_f64] {
        let delta = delta_deg.to_radians();
        let sun = DVec3::new(delta.sin(), 0.0, delta.cos());
        let air = Air { model: Model::ViewTable(model.clone()), ..Air::from(medium.clone()) };
        let scene = looking_down(&medium, air, sun);
        renderer.render(&gpu, &scene, Target::Image(&image), None).expect("it is drawn");
        let found = renderer.read_hdr(&gpu).expect("it is read").rgba;
        let direct = (-model.depth(&medium, 0.0, delta.cos())).exp() * delta.cos();
        let ambient = model.ambient(&medium, &split, delta);
        let truth = (direct + ambient) * f64::from(ALBEDO * LUX) / std::f64::consts::PI;
        for channel in 0..3 {
            let pixel = f64::from(found[(8 * 16 + 8) * 4 + channel]);
            let error = pixel / truth[channel] - 1.0;
            assert!(error.abs() < 0.03, "sun {delta_deg}° from the zenith, channel {channel}: {pixel}, not {}", truth[channel]);
        }
    }
}

const ALBEDO: f32 = 0.3;
const LUX: f32 = 1.0e5;

fn looking_down(medium: &Medium, air: Air, sun: DVec3) -> Snapshot {
    let altitude = 2.0;
    let sun_direction = Vec3::new(narrow(sun.x), narrow(sun.y), narrow(sun.z));
    let body = Body {
        id: 7,
        centre_m: Vec3::NEG_Z * narrow(medium.bottom_radius_m + altitude),
        radius_m: narrow(medium.bottom_radius_m),
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: narrow(altitude),
        camera_up: Vec3::Z,
        sun_direction,
        sun_angular_radius_rad: 0.0047,
        sun_illuminance_lx: Vec3::splat(LUX),
        occluders: Vec::new(),
        albedo: Vec3::splat(ALBEDO),
        surface: Surface::Smooth,
        air: Some(air),
    };
    Snapshot {
        camera: Camera { view_from_icrf: Quat::IDENTITY, fov_y_rad: 0.2, near_m: 0.1, size_px: [16, 16] },
        star: Star { id: 0, centre_m: sun_direction * 1.5e11, radius_m: 7.0e8, intensity_cd: Vec3::splat(LUX * 2.25e22) },
        bodies: vec![body],
        ships: Vec::new(),
        exposure: AutoOr::Ev100(13.0),
        adapt_s: None,
        force: Force::default(),
    }
}
