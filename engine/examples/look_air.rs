//! Draws the Earth's air by hand-made scenes into PNG files: `cargo run -p engine --example look_air -- DIR [WxH] [NAME] [STEPS]`; with
//! STEPS, tells by how much the sky marched in so many steps differs from one of 256.
//!
//! Not here: terrain and real orbits (`syzygy shot` has them).

use engine::air::{Layer, Medium, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::pass::sky::physical::AGREE;
use engine::render::{OffscreenImage, Renderer, RendererOptions, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Occluder, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3};
use engine::units::{AU, DEG, KM};
use glam::{DVec3, Mat3, Quat, Vec3};
use std::error::Error;
use std::fs::File;
use std::path::PathBuf;

const SUN_CD: Vec3 = Vec3::new(2.90e27, 2.86e27, 2.80e27);
const RADIUS: f64 = 6371.0 * KM;

/// As `assets/bodies/earth/atmosphere.toml` describes it.
fn earth_air() -> Medium {
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    Medium {
        bottom_radius_m: RADIUS,
        top_altitude_m: 100.0 * KM,
        ground_albedo: Vec3::splat(0.15),
        layers: vec![
            Layer {
                scattering_per_m: Vec3::new(6.5e-6, 13.6e-6, 32.5e-6),
                absorption_per_m: Vec3::ZERO,
                profile: exponential(8000.0),
                phase: Phase::Rayleigh,
            },
            Layer {
                scattering_per_m: Vec3::splat(3.996e-6),
                absorption_per_m: Vec3::splat(0.444e-6),
                profile: exponential(1200.0),
                phase: Phase::CornetteShanks { g: 0.8 },
            },
            Layer {
                scattering_per_m: Vec3::ZERO,
                absorption_per_m: Vec3::new(1.6e-6, 1.8e-6, 0.12e-6),
                profile: Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 },
                phase: Phase::Rayleigh,
            },
        ],
    }
}

/// Up is +Z. The sun stands `sun_deg` above the horizontal, `azimuth_deg` to the left of the view, which is along +X and `pitch_deg` up.
fn scene(size: [u32; 2], altitude_m: f64, sun_deg: f64, azimuth_deg: f64, pitch_deg: f64, fov_deg: f64) -> Snapshot {
    let spherical = |elevation: f64, azimuth: f64| {
        let (e, a) = (elevation * DEG, azimuth * DEG);
        DVec3::new(libm::cos(e) * libm::cos(a), libm::cos(e) * libm::sin(a), libm::sin(e))
    };
    let sun = spherical(sun_deg, azimuth_deg) * AU;
    let f = narrow3(spherical(pitch_deg, 0.0));
    let right = f.cross(Vec3::Z).normalize_or(Vec3::NEG_Y);
    let centre = DVec3::new(0.0, 0.0, -(RADIUS + altitude_m));
    let to_sun = sun - centre;
    let d = to_sun.length();
    let earth = Body {
        id: 3,
        centre_m: narrow3(centre),
        radius_m: narrow(RADIUS),
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: narrow(altitude_m),
        camera_up: Vec3::Z,
        sun_direction: narrow3(to_sun / d),
        sun_angular_radius_rad: narrow(6.957e8 / d),
        sun_illuminance_lx: SUN_CD * narrow(1.0 / (d * d)),
        occluders: Vec::new(),
        albedo: Vec3::new(0.08, 0.11, 0.12),
        surface: Surface::Smooth,
        air: Some(earth_air().into()),
    };
    Snapshot {
        camera: Camera {
            view_from_icrf: Quat::from_mat3(&Mat3::from_cols(right, right.cross(f), -f)).conjugate(),
            fov_y_rad: narrow(fov_deg * DEG),
            near_m: 0.2,
            size_px: size,
        },
        star: Star { id: 0, centre_m: narrow3(sun), radius_m: 6.957e8, intensity_cd: SUN_CD },
        bodies: vec![earth],
        ships: Vec::new(),
        exposure: AutoOr::Auto { compensation_ev: 0.0 },
        adapt_s: None,
        force: Force::default(),
    }
}

/// Puts a moon of the size of ours before the sun, its shadow's axis through the camera moved by `aside_m` along +Y.
fn eclipsed(mut scene: Snapshot, aside_m: f64) -> Snapshot {
    let to_sun = scene.star.centre_m.normalize_or(Vec3::X);
    let centre_m = to_sun * 3.6e8 + Vec3::Y * narrow(aside_m);
    scene.bodies[0].occluders = vec![Occluder { id: 4, centre_m, radius_m: 1.7374e6 }];
    scene
}

fn scenes(size: [u32; 2]) -> Vec<(&'static str, Snapshot)> {
    vec![
        ("noon_2m", scene(size, 2.0, 55.0, 60.0, 15.0, 60.0)),
        ("sunset_2m", scene(size, 2.0, 1.5, 5.0, 8.0, 60.0)),
        ("twilight_2m", scene(size, 2.0, -5.0, 0.0, 12.0, 60.0)),
        ("belt_of_venus", scene(size, 2.0, -2.5, 180.0, 8.0, 40.0)),
        ("night_2m", scene(size, 2.0, -25.0, 0.0, 12.0, 60.0)),
        ("high_10km", scene(size, 10.0 * KM, 30.0, 50.0, -3.0, 60.0)),
        ("edge_99km", scene(size, 99.9 * KM, 20.0, 50.0, -8.0, 60.0)),
        ("edge_101km", scene(size, 100.1 * KM, 20.0, 50.0, -8.0, 60.0)),
        ("orbit_400km", scene(size, 400.0 * KM, 50.0, 40.0, -18.0, 60.0)),
        ("orbit_sunset", scene(size, 400.0 * KM, -19.0, 3.0, -19.0, 40.0)),
        ("terminator", scene(size, 800.0 * KM, 0.0, 90.0, -40.0, 70.0)),
        ("from_5000km", scene(size, 5.0e6, 30.0, 90.0, -70.0, 80.0)),
        ("from_60000km", scene(size, 6.0e7, 20.0, 100.0, -90.0, 16.0)),
        ("backlit", scene(size, 6.0e7, -82.0, 0.0, -90.0, 16.0)),
        ("umbra_2m", eclipsed(scene(size, 2.0, 26.0, 20.0, 15.0, 75.0), 0.0)),
        ("umbra_limb", eclipsed(scene(size, 2.0, 26.0, 20.0, 15.0, 75.0), 1.2e5)),
        ("umbra_space", eclipsed(scene(size, 2.0e6, 55.0, 180.0, -65.0, 60.0), 0.0)),
    ]
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let dir = PathBuf::from(args.first().map_or("look", String::as_str));
    std::fs::create_dir_all(&dir)?;
    let size = match args.get(1).and_then(|s| s.split_once('x')) {
        Some((w, h)) => [w.parse()?, h.parse()?],
        None => [480, 270],
    };
    let gpu = Gpu::headless(BackendChoice::Auto)?;
    let mut renderer = Renderer::new(&gpu, RendererOptions { shaders: ShaderLibrary::checkout(), measure: true })?;
    let image = OffscreenImage::new(&gpu, size);
    let mut pictures = Vec::new();
    for (name, scene) in scenes(size).into_iter().filter(|(n, _)| args.get(2).is_none_or(|o| o == n || o == "all")) {
        if let Some(steps) = args.get(3) {
            let mut drawn = [steps.parse()?, 256].into_iter().map(|n| {
                renderer.set_sky(n, AGREE);
                let fixed = Snapshot { exposure: AutoOr::Ev100(12.0), ..scene.clone() };
                renderer.render(&gpu, &fixed, Target::Image(&image), None)?;
                Ok::<_, Box<dyn Error>>(renderer.read_hdr(&gpu)?.rgba)
            });
            let (Some(few), Some(many)) = (drawn.next().transpose()?, drawn.next().transpose()?) else { continue };
            let floor = many.iter().step_by(2).fold(0.0_f32, |a, b| if *b < 1e5 { a.max(*b) } else { a }) * 1e-3;
            let errors: Vec<f32> = few.iter().zip(&many).map(|(a, b)| (a - b).abs() / b.max(floor)).collect();
            let worst = errors.iter().copied().enumerate().fold((0, 0.0), |w, e| if e.1 > w.1 { e } else { w });
            let (x, y) = (worst.0 / 4 % size[0] as usize, worst.0 / 4 / size[0] as usize);
            let mean = errors.iter().sum::<f32>() / errors.len() as f32;
            println!("{name}: mean {:.3} %, worst {:.2} % at {x}, {y}", mean * 133.3, worst.1 * 100.0);
            continue;
        }
        let report = renderer.render(&gpu, &scene, Target::Image(&image), None)?;
        let pixels = image.read_rgba8(&gpu)?;
        let hdr = renderer.read_hdr(&gpu)?.rgba;
        let bad = hdr.iter().filter(|v| !v.is_finite()).count();
        let brightest = hdr.chunks_exact(4).map(|p| p[1]).fold(0.0_f32, f32::max);
        let middle = hdr.chunks_exact(4).nth(hdr.len() / 8 + size[0] as usize / 2).map_or([0.0; 3], |p| [p[0], p[1], p[2]]);
        let ms = report.pass("sky").and_then(|p| p.gpu_ms).unwrap_or_default();
        println!("{name}: sky {ms:.0} ms, {bad} not finite, brightest {brightest:.3e}, middle {middle:?} cd/m²");
        write_png(&dir.join(format!("{name}.png")), size, &pixels)?;
        pictures.push(pixels);
    }
    if pictures.is_empty() {
        return Ok(());
    }
    let [w, h] = size.map(|n| n as usize);
    let sheet: Vec<u8> = pictures
        .chunks(3)
        .flat_map(|row| (0..h).flat_map(move |y| (0..3).flat_map(move |i| row[i.min(row.len() - 1)][4 * w * y..][..4 * w].iter().copied())))
        .collect();
    write_png(&dir.join("sheet.png"), [size[0] * 3, size[1] * u32::try_from(pictures.len().div_ceil(3))?], &sheet)
}

fn write_png(path: &std::path::Path, size: [u32; 2], rgba: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(File::create(path)?), size[0], size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(rgba)?;
    Ok(())
}
