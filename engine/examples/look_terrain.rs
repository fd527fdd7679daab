//! Draws terrain by hand-made scenes into PNG files: `cargo run -p engine --example look_terrain -- DIR WxH [NAME] [COLOUR.rgb]`.
//! COLOUR.rgb: 2048 × 1024 texels of 8-bit RGB. Not here: real orbits and assets (`syzygy shot` has them).

use engine::air::{Layer, Medium, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::{BodyMaps, ColourMap, OffscreenImage, Renderer, RendererOptions, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3};
use engine::space::sphere::{direction_of_lat_lon, east_up_north};
use engine::terrain::spec::{CraterSpec, NoiseSpec, ProvinceSpec};
use engine::terrain::{CubeMap, Ground, Maps, Relief, ReliefSpec, View, select};
use engine::units::{AU, DEG, KM};
use glam::{Mat3, Quat, Vec3};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

type Failure = Box<dyn Error>;
const SUN_CD: Vec3 = Vec3::new(2.90e27, 2.86e27, 2.80e27);

fn earth(maps: &Path) -> Result<Arc<Relief>, Failure> {
    let read = |name: &str| -> Result<_, Failure> { Ok(Some(Arc::new(CubeMap::read(&std::fs::read(maps.join(name))?)?))) };
    let spec = ReliefSpec {
        ground: Ground::Living,
        water: true,
        map: Some("height.cube".to_owned()),
        coast: Some("coast.cube".to_owned()),
        noise: Some(NoiseSpec { wavelength_m: 2.4e4, amplitude_m: 3200.0, plain_amplitude_m: 40.0, gain: 0.47, ridged: 0.65, seed: 1 }),
        ..ReliefSpec::default()
    };
    Ok(Arc::new(Relief::new(6371.0 * KM, spec, Maps { height: read("height.cube")?, coast: read("coast.cube")?, ..Maps::default() })?))
}

fn moon() -> Result<Arc<Relief>, Failure> {
    let spec = ReliefSpec {
        ground: Ground::Regolith,
        noise: Some(NoiseSpec { wavelength_m: 2e5, amplitude_m: 900.0, plain_amplitude_m: 60.0, gain: 0.46, ridged: 0.1, seed: 5 }),
        craters: Some(CraterSpec {
            largest_radius_m: 1.2e5,
            smallest_radius_m: 1.0,
            density: 0.75,
            depth_ratio: 0.2,
            complex_radius_m: 7500.0,
            seed: 9,
        }),
        provinces: Some(ProvinceSpec { wavelength_m: 2.2e6, depth_m: 1500.0, share: 0.3, albedo_ratio: 0.55, seed: 2 }),
        ..ReliefSpec::default()
    };
    Ok(Arc::new(Relief::new(1737.4 * KM, spec, Maps::default())?))
}

fn air() -> Medium {
    let layer = |scattering_per_m, absorption_per_m, profile, phase| Layer { scattering_per_m, absorption_per_m, profile, phase };
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    Medium {
        bottom_radius_m: 6371.0 * KM,
        top_altitude_m: 100.0 * KM,
        ground_albedo: Vec3::splat(0.15),
        layers: vec![
            layer(Vec3::new(6.5e-6, 13.6e-6, 32.5e-6), Vec3::ZERO, exponential(8000.0), Phase::Rayleigh),
            layer(Vec3::splat(3.996e-6), Vec3::splat(0.444e-6), exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
        ],
    }
}

/// Where the camera is and looks: latitude, longitude, height above ground, azimuth, pitch, field of view; sun's elevation, azimuth.
struct Shot(&'static str, f64, f64, f64, f64, f64, f64, f64, f64);

const SHOTS: [Shot; 14] = [
    Shot("e60000", 30.0, 0.0, 6.0e7, 0.0, -90.0, 16.0, 45.0, 100.0),
    Shot("e5000", 40.0, 10.0, 5.0e6, 0.0, -75.0, 70.0, 50.0, 120.0),
    Shot("e400", 42.0, 9.0, 4.0e5, 20.0, -40.0, 60.0, 40.0, 120.0),
    Shot("e100", 45.0, 6.0, 1.0e5, 60.0, -25.0, 60.0, 25.0, 150.0),
    Shot("e10", 45.6, 6.5, 1.0e4, 60.0, -12.0, 60.0, 25.0, 150.0),
    Shot("e1", 45.8, 6.9, 1.0e3, 90.0, -8.0, 60.0, 20.0, 150.0),
    Shot("e200m", 45.83, 6.86, 200.0, 200.0, -8.0, 60.0, 30.0, 120.0),
    Shot("e2m", 45.83, 6.86, 2.0, 200.0, -4.0, 60.0, 30.0, 120.0),
    Shot("coast10", 43.6, 7.2, 1.0e4, 70.0, -20.0, 60.0, 25.0, 100.0),
    Shot("coast200", 43.75, 7.35, 200.0, 240.0, -8.0, 60.0, 15.0, 235.0),
    Shot("m3000", 10.0, 20.0, 4.0e6, 0.0, -90.0, 40.0, 50.0, 100.0),
    Shot("m100", -20.0, 20.0, 1.0e5, 30.0, -25.0, 60.0, 20.0, 100.0),
    Shot("m1", -20.0, 20.0, 1.0e3, 30.0, -10.0, 60.0, 20.0, 80.0),
    Shot("m2m", -20.0, 20.0, 2.0, 30.0, -5.0, 60.0, 15.0, 80.0),
];

fn scene(shot: &Shot, relief: &Arc<Relief>, size: [u32; 2], moon: bool) -> (Snapshot, usize) {
    let Shot(_, lat, lon, above, azimuth, pitch, fov, sun_elevation, sun_azimuth) = shot;
    let up = direction_of_lat_lon(lat * DEG, lon * DEG);
    let (east, _, north) = east_up_north(up);
    let aim = |elevation: f64, azimuth: f64| {
        let (e, a) = (elevation * DEG, azimuth * DEG);
        (north * libm::cos(a) + east * libm::sin(a)) * libm::cos(e) + up * libm::sin(e)
    };
    let altitude = relief.surface_m(up) + above;
    let eye = up * (relief.radius_m + altitude);
    let f = aim(*pitch, *azimuth);
    let right = narrow3(aim(0.0, azimuth + 90.0));
    let f32_forward = narrow3(f);
    let sun = aim(*sun_elevation, *sun_azimuth) * AU;
    let camera = Camera {
        view_from_icrf: Quat::from_mat3(&Mat3::from_cols(right, right.cross(f32_forward), -f32_forward)).conjugate(),
        fov_y_rad: narrow(fov * DEG),
        near_m: 0.1,
        size_px: size,
    };
    let tan = libm::tan(0.5 * fov * DEG);
    let view = View {
        camera_m: eye,
        forward: f,
        cone_rad: libm::atan(tan * libm::hypot(1.0, f64::from(camera.aspect()))),
        pixel_rad: f64::from(camera.pixel_rad()),
        max_error_px: 1.0,
        relief_max: if moon { 1.0 } else { 6.0 },
    };
    let started = Instant::now();
    let set = select(relief, &view);
    let count = set.tiles.len();
    println!("{}: {count} tiles chosen in {:.1} ms, relief × {:.2}", shot.0, started.elapsed().as_secs_f64() * 1e3, set.relief_scale);
    let to_sun = sun - eye * -1.0;
    let d = to_sun.length();
    let body = Body {
        id: 3,
        centre_m: narrow3(-eye),
        radius_m: narrow(relief.radius_m),
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: narrow(altitude),
        camera_up: narrow3(up),
        sun_direction: narrow3(to_sun / d),
        sun_angular_radius_rad: narrow(6.957e8 / d),
        sun_illuminance_lx: SUN_CD * narrow(1.0 / (d * d)),
        occluders: Vec::new(),
        albedo: if moon { Vec3::new(0.135, 0.125, 0.11) } else { Vec3::new(0.1, 0.12, 0.06) },
        surface: Surface::Tiles(set),
        air: (!moon).then(|| air().into()),
    };
    let snapshot = Snapshot {
        camera,
        star: Star { id: 0, centre_m: narrow3(sun), radius_m: 6.957e8, intensity_cd: SUN_CD },
        bodies: vec![body],
        ships: Vec::new(),
        exposure: AutoOr::Auto { compensation_ev: 0.0 },
        adapt_s: None,
        force: Force::default(),
    };
    (snapshot, count)
}

fn main() -> Result<(), Failure> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let dir = PathBuf::from(args.first().map_or("look", String::as_str));
    std::fs::create_dir_all(&dir)?;
    let (w, h) = args.get(1).and_then(|s| s.split_once('x')).ok_or("give the size as WxH")?;
    let size = [w.parse()?, h.parse()?];
    let (earth, moon) = (earth(Path::new("assets/bodies/earth"))?, moon()?);
    let gpu = Gpu::headless(BackendChoice::Auto)?;
    let mut renderer = Renderer::new(&gpu, RendererOptions { shaders: ShaderLibrary::checkout(), measure: true })?;
    if let Some(file) = args.get(3) {
        let rgb = std::fs::read(file)?;
        let rgba = rgb.chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect();
        renderer.register_body(&gpu, 3, &BodyMaps { albedo: Some(ColourMap { size: [2048, 1024], rgba }), night: None })?;
    }
    let image = OffscreenImage::new(&gpu, size);
    for shot in SHOTS.iter().filter(|s| args.get(2).is_none_or(|o| s.0.starts_with(o.as_str()))) {
        let of_moon = shot.0.starts_with('m');
        if of_moon {
            renderer.register_body(&gpu, 3, &BodyMaps::default())?;
        }
        let (scene, _) = scene(shot, if of_moon { &moon } else { &earth }, size, of_moon);
        let started = Instant::now();
        let report = renderer.render(&gpu, &scene, Target::Image(&image), None)?;
        let pixels = image.read_rgba8(&gpu)?;
        let bad = renderer.read_hdr(&gpu)?.rgba.iter().filter(|v| !v.is_finite()).count();
        let ms = |name| report.pass(name).and_then(|p| p.gpu_ms).unwrap_or_default();
        println!("  {:.1} s, terrain {:.0} ms, {bad} not finite", started.elapsed().as_secs_f64(), ms("terrain"));
        let mut encoder =
            png::Encoder::new(std::io::BufWriter::new(std::fs::File::create(dir.join(format!("{}.png", shot.0)))?), size[0], size[1]);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header()?.write_image_data(&pixels)?;
    }
    Ok(())
}
