//! Draws scenes made by hand into PNG files, to look at the passes without a game: `cargo run -p engine --example look -- DIR [WxH]`.
//!
//! Not here: real orbits, maps or terrain (`syzygy shot` has them).

use engine::air::{Layer, Medium, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::{OffscreenImage, Renderer, RendererOptions, StarCatalogue, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Occluder, Ship, Snapshot, Star, Surface};
use engine::units::AU;
use glam::{DVec3, Quat, Vec3};
use std::error::Error;
use std::fs::File;
use std::path::PathBuf;

const SUN_CD: Vec3 = Vec3::new(2.90e27, 2.86e27, 2.80e27);

fn look_along(forward: Vec3, up: Vec3) -> Quat {
    let f = forward.normalize_or(Vec3::NEG_Z);
    let right = f.cross(up).normalize_or(Vec3::X);
    let m = glam::Mat3::from_cols(right, right.cross(f), -f);
    Quat::from_mat3(&m).conjugate()
}

/// A sphere at `centre_m` from the camera, lit from `sun_m`.
fn body(id: u16, centre_m: DVec3, radius_m: f64, albedo: Vec3, sun_m: DVec3) -> Body {
    let n = engine::space::relative::narrow;
    let n3 = engine::space::relative::narrow3;
    let to_sun = sun_m - centre_m;
    let d = to_sun.length();
    Body {
        id,
        centre_m: n3(centre_m),
        radius_m: n(radius_m),
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: n(centre_m.length() - radius_m),
        camera_up: n3(-centre_m / centre_m.length()),
        sun_direction: n3(to_sun / d),
        sun_angular_radius_rad: n(6.957e8 / d),
        sun_illuminance_lx: SUN_CD * n(1.0 / (d * d)),
        occluders: Vec::new(),
        albedo,
        surface: Surface::Smooth,
        air: (id == 3).then(|| earth_air().into()),
    }
}

/// Air like the Earth's: Rayleigh, haze and ozone, coefficients after Hillaire 2020.
fn earth_air() -> Medium {
    let layer = |scattering_per_m, absorption_per_m, profile, phase| Layer { scattering_per_m, absorption_per_m, profile, phase };
    Medium {
        bottom_radius_m: 6.371e6,
        top_altitude_m: 1.0e5,
        ground_albedo: Vec3::splat(0.2),
        layers: vec![
            layer(Vec3::new(5.8e-6, 13.6e-6, 33.1e-6), Vec3::ZERO, Profile::Exponential { scale_height_m: 8000.0 }, Phase::Rayleigh),
            layer(
                Vec3::splat(4.0e-6),
                Vec3::splat(4.4e-7),
                Profile::Exponential { scale_height_m: 1200.0 },
                Phase::CornetteShanks { g: 0.8 },
            ),
            layer(
                Vec3::ZERO,
                Vec3::new(6.5e-7, 1.88e-6, 8.5e-8),
                Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 },
                Phase::Rayleigh,
            ),
        ],
    }
}

fn ship(centre_m: Vec3, attitude: Quat, throttle: f32, gear: f32) -> Ship {
    Ship { centre_m, icrf_from_hull: attitude, throttle, gear, heat: 0.0, host: Some(0), height_above_ground_m: 4.0e5, hidden: false }
}

fn scene(size: [u32; 2], forward: Vec3, up: Vec3, bodies: Vec<Body>, sun_m: DVec3) -> Snapshot {
    Snapshot {
        camera: Camera { view_from_icrf: look_along(forward, up), fov_y_rad: 0.9, near_m: 0.2, size_px: size },
        star: Star { id: 0, centre_m: engine::space::relative::narrow3(sun_m), radius_m: 6.957e8, intensity_cd: SUN_CD },
        bodies,
        ships: Vec::new(),
        exposure: AutoOr::Auto { compensation_ev: 0.0 },
        adapt_s: None,
        force: Force::default(),
    }
}

fn scenes(size: [u32; 2]) -> Vec<(&'static str, Snapshot)> {
    let sun = DVec3::new(0.8, -0.5, 0.33).normalize_or(DVec3::X) * AU;
    let blue = Vec3::new(0.20, 0.27, 0.36);
    let earth = DVec3::new(-6.6e7, 0.0, 0.0);
    let moon = DVec3::new(-3.0e8, 1.0e8, 2.0e7);
    let grey = Vec3::splat(0.12);
    let far = scene(
        size,
        Vec3::NEG_X,
        Vec3::Z,
        vec![
            body(3, earth, 6.371e6, blue, sun),
            body(4, moon, 1.7374e6, grey, sun),
            body(6, DVec3::new(-7e11, 2e11, 1e10), 6.99e7, Vec3::new(0.5, 0.42, 0.33), sun),
        ],
        sun,
    );
    let jupiter =
        scene(size, Vec3::NEG_X, Vec3::Z, vec![body(6, DVec3::new(-3.5e8, 0.0, 0.0), 6.99e7, Vec3::new(0.5, 0.42, 0.33), sun)], sun);
    let below = DVec3::new(0.0, 0.0, -6.771e6);
    let to_sun = engine::space::relative::narrow3(sun / AU);
    let mut close = scene(size, Vec3::new(-0.4, 0.9, -0.35), Vec3::Z, vec![body(3, below, 6.371e6, blue, sun)], sun);
    let attitude = Quat::from_rotation_z(0.9) * Quat::from_rotation_x(1.35);
    close.ships = vec![ship(Vec3::new(-16.0, 52.0, -19.0), attitude, 0.0, 1.0)];
    let mut burn = close.clone();
    burn.ships = vec![ship(Vec3::new(-16.0, 38.0, -14.0), Quat::from_rotation_z(0.6) * Quat::from_rotation_x(1.35), 1.0, 0.0)];
    let mut portrait = close.clone();
    portrait.camera.fov_y_rad = 0.42;
    let nose_on = Quat::from_rotation_z(2.5) * Quat::from_rotation_x(1.35);
    let mut front = portrait.clone();
    front.ships = vec![ship(Vec3::new(-18.0, 40.0, -22.0), nose_on, 0.0, 1.0)];
    portrait.camera.view_from_icrf = look_along(Vec3::new(-16.0, 38.0, -14.0), Vec3::Z);
    front.camera.view_from_icrf = look_along(Vec3::new(-18.0, 40.0, -22.0), Vec3::Z);
    portrait.ships = vec![ship(Vec3::new(-16.0, 38.0, -14.0), Quat::from_rotation_z(0.9) * Quat::from_rotation_x(1.35), 0.0, 1.0)];
    let night_sun = DVec3::new(0.0, 0.3, -0.95) * AU;
    let mut night = scene(size, Vec3::new(-0.4, 0.9, 0.2), Vec3::Z, vec![body(3, below, 6.371e6, blue, night_sun)], night_sun);
    night.ships = vec![ship(Vec3::new(-16.0, 52.0, 5.0), attitude, 0.0, 0.0)];
    let mut eclipse = scene(size, to_sun, Vec3::Z, vec![body(3, below * 3.0, 6.371e6, blue, sun)], sun);
    eclipse.bodies.push(body(4, sun / AU * 3.6e8, 1.7374e6, grey, sun));
    eclipse.bodies[0].occluders = vec![Occluder { id: 4, centre_m: eclipse.bodies[1].centre_m, radius_m: 1.7374e6 }];
    // On the ground at mid-morning, the ship standing 30 m ahead.
    let mut landed =
        scene(size, Vec3::new(0.35, 0.93, -0.06), Vec3::Z, vec![body(3, DVec3::new(0.0, 0.0, -6.371_004e6), 6.371e6, blue, sun)], sun);
    landed.ships = vec![Ship {
        height_above_ground_m: 3.4,
        ..ship(Vec3::new(10.0, 28.0, -0.6), Quat::from_rotation_z(2.3) * Quat::from_rotation_x(core::f32::consts::FRAC_PI_2), 0.0, 1.0)
    }];
    let sunlit = scene(size, to_sun, Vec3::Z, vec![body(3, below, 6.371e6, blue, sun)], sun);
    vec![
        ("far", far),
        ("jupiter", jupiter),
        ("ship", close),
        ("portrait", portrait),
        ("front", front),
        ("burn", burn),
        ("night", night),
        ("eclipse", eclipse),
        ("sun", sunlit),
        ("landed", landed),
    ]
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let dir = PathBuf::from(args.first().map_or("look", String::as_str));
    std::fs::create_dir_all(&dir)?;
    let size = match args.get(1).and_then(|s| s.split_once('x')) {
        Some((w, h)) => [w.parse()?, h.parse()?],
        None => [640, 360],
    };
    let only = args.get(2);
    let gpu = Gpu::headless(BackendChoice::Auto)?;
    let started = std::time::Instant::now();
    let mut renderer = Renderer::new(&gpu, RendererOptions { shaders: ShaderLibrary::checkout(), measure: true })?;
    let stars = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/stars/stars.bin");
    renderer.set_stars(&gpu, StarCatalogue::parse(&std::fs::read(stars)?)?);
    println!("{} · passes compiled in {:.2} s", gpu.info.name, started.elapsed().as_secs_f64());
    let mut pictures = Vec::new();
    let image = OffscreenImage::new(&gpu, size);
    for (name, scene) in scenes(size).into_iter().filter(|(n, _)| only.is_none_or(|o| o == n)) {
        let started = std::time::Instant::now();
        let report = renderer.render(&gpu, &scene, Target::Image(&image), None)?;
        let pixels = image.read_rgba8(&gpu)?;
        let hdr = renderer.read_hdr(&gpu)?.rgba;
        let bad = hdr.iter().filter(|v| !v.is_finite()).count();
        let most = hdr.chunks_exact(4).map(|t| t[1]).fold(0.0, f32::max);
        println!("{name}: {:.0} ms, {bad} not finite, at most {most:.3e} cd/m²", started.elapsed().as_secs_f64() * 1e3);
        for p in &report.passes {
            println!("    {:12} {:5} {:>8} {}", p.name, p.ran, p.gpu_ms.map_or(String::new(), |ms| format!("{ms:.2} ms")), p.reason);
        }
        write_png(&dir.join(format!("{name}.png")), size, &pixels)?;
        pictures.push(pixels);
    }
    // All of them on one sheet, two to a row.
    let [w, h] = size.map(|n| n as usize);
    let sheet: Vec<u8> = pictures
        .chunks(2)
        .flat_map(|pair| {
            (0..h).flat_map(move |y| (0..2).flat_map(move |i| pair[i.min(pair.len() - 1)][4 * w * y..][..4 * w].iter().copied()))
        })
        .collect();
    let rows = u32::try_from(pictures.len().div_ceil(2))?;
    write_png(&dir.join("sheet.png"), [size[0] * 2, size[1] * rows], &sheet)
}

fn write_png(path: &std::path::Path, size: [u32; 2], rgba: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(File::create(path)?), size[0], size[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(rgba)?;
    Ok(())
}
