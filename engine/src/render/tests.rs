//! The frame against closed forms, on whatever device there is: light that arrives is light that was
//! sent, forced passes change nothing, odd targets are no accident.

use super::pass::stars::{LX_AT_MAGNITUDE_0, StarCatalogue, star};
use super::*;
use crate::gpu::BackendChoice;
use crate::scene::{AutoOr, Body, Camera, Force, Ship, Star, Surface};
use core::f32::consts::PI;
use glam::{Quat, Vec3};

const AU_M: f32 = 1.495_978_7e11;

/// A camera that looks along −Z with the sun behind it, a little to the right and above; nothing else.
pub fn empty_scene(size_px: [u32; 2]) -> Snapshot {
    Snapshot {
        camera: Camera { view_from_icrf: Quat::IDENTITY, fov_y_rad: 0.8, near_m: 0.1, size_px },
        star: Star {
            id: 0,
            centre_m: Vec3::new(0.3, 0.2, 0.93).normalize_or(Vec3::Z) * AU_M,
            radius_m: 6.957e8,
            intensity_cd: Vec3::splat(1.28e5 * AU_M * AU_M),
        },
        bodies: Vec::new(),
        ships: Vec::new(),
        exposure: AutoOr::Ev100(14.0),
        adapt_s: None,
        force: Force::default(),
    }
}

/// A ship.
pub fn ship_at(centre_m: Vec3, height_above_ground_m: f32) -> Ship {
    Ship { centre_m, icrf_from_hull: Quat::IDENTITY, throttle: 0.0, gear: 1.0, heat: 0.0, host: None, height_above_ground_m, hidden: false }
}

fn sphere(centre_m: Vec3, radius_m: f32, sun: Vec3) -> Body {
    let d = centre_m.length();
    Body {
        id: 7,
        centre_m,
        radius_m,
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: d - radius_m,
        camera_up: -centre_m / d,
        sun_direction: sun.normalize_or(Vec3::Z),
        sun_angular_radius_rad: 0.00465,
        sun_illuminance_lx: Vec3::splat(1.28e5),
        occluders: Vec::new(),
        albedo: Vec3::splat(0.3),
        surface: Surface::Smooth,
        air: None,
    }
}

fn gpu() -> Gpu {
    Gpu::headless(BackendChoice::Auto).unwrap_or_else(|e| panic!("these tests draw: {e}"))
}

#[test]
fn light_that_arrives_is_light_that_was_sent() {
    let gpu = gpu();
    let mut renderer = Renderer::new(&gpu, RendererOptions::default()).unwrap();
    let image = OffscreenImage::new(&gpu, [96, 96]);

    // A Lambert sphere under a sun behind the camera: A/π · E in the middle.
    let mut scene = empty_scene(image.size);
    scene.star.centre_m = Vec3::Z * AU_M;
    scene.bodies.push(sphere(Vec3::NEG_Z * 5.0e7, 6.4e6, Vec3::Z));
    renderer.render(&gpu, &scene, Target::Image(&image), None).unwrap();
    let hdr = renderer.read_hdr(&gpu).unwrap();
    assert!(hdr.rgba.iter().all(|v| v.is_finite()));
    let middle = hdr.rgba[4 * (48 * 96 + 48)];
    let expected = 0.3 / PI * 1.28e5;
    assert!((middle / expected - 1.0).abs() < 0.003, "{middle} cd/m², expected {expected}");

    // A star's illuminance is the sum over its sprite, wherever it falls between pixels.
    let mut scene = empty_scene(image.size);
    scene.exposure = AutoOr::Ev100(-2.0);
    for (x, y) in [(0.0, 0.0), (0.0031, 0.0017), (0.2, -0.15)] {
        let direction = Vec3::new(x, y, -1.0).normalize_or(Vec3::NEG_Z);
        renderer.set_stars(&gpu, StarCatalogue { points: vec![star(direction, 0.0, 0.65)] });
        renderer.render(&gpu, &scene, Target::Image(&image), None).unwrap();
        let hdr = renderer.read_hdr(&gpu).unwrap();
        let pixel = scene.camera.pixel_rad();
        let cosine = -direction.z;
        let luma = |t: &[f32]| 0.2126 * t[0] + 0.7152 * t[1] + 0.0722 * t[2];
        let lx: f32 = hdr.rgba.chunks_exact(4).map(luma).sum::<f32>() * pixel * pixel * cosine.powi(3);
        assert!((lx / LX_AT_MAGNITUDE_0 - 1.0).abs() < 0.03, "at ({x}, {y}): {lx} lx");
    }
}

#[test]
fn forced_passes_change_nothing() {
    let gpu = gpu();
    let mut renderer = Renderer::new(&gpu, RendererOptions::default()).unwrap();
    let image = OffscreenImage::new(&gpu, [80, 45]);
    let mut scene = empty_scene(image.size);
    scene.exposure = AutoOr::Auto { compensation_ev: 0.0 };
    scene.bodies.push(sphere(Vec3::NEG_Z * 5.0e7, 6.4e6, Vec3::new(0.5, 0.1, 0.8)));
    scene.ships.push(ship_at(Vec3::new(3.0, -4.0, -45.0), 4.0e5));
    let report = renderer.render(&gpu, &scene, Target::Image(&image), None).unwrap();
    let plain = image.read_rgba8(&gpu).unwrap();
    let shadow = report.pass("shadow").unwrap();
    assert!(!shadow.ran && shadow.reason.contains("400 km"), "{shadow:?}");
    scene.force.all = true;
    let report = renderer.render(&gpu, &scene, Target::Image(&image), None).unwrap();
    assert!(report.passes.iter().filter(|p| p.name != "overlay").all(|p| p.ran), "{report:?}");
    assert!(image.read_rgba8(&gpu).unwrap() == plain);
    // The picture is exposed: not black, not white.
    let mean = plain.iter().map(|b| u64::from(*b)).sum::<u64>() / plain.len() as u64;
    assert!((66..200).contains(&mean), "{mean}");
}

#[test]
fn odd_targets_are_no_accident() {
    struct Counting(u32);
    impl Overlay for Counting {
        fn record(&mut self, _: &Gpu, _: &mut wgpu::CommandEncoder, _: &wgpu::TextureView, _: wgpu::TextureFormat, _: [u32; 2]) {
            self.0 += 1;
        }
    }
    let gpu = gpu();
    let mut renderer = Renderer::new(&gpu, RendererOptions::default()).unwrap();
    assert!(matches!(renderer.read_hdr(&gpu), Err(RenderError::NothingDrawn)));
    let image = OffscreenImage::new(&gpu, [0, 3]);
    let mut scene = empty_scene([0, 0]);
    scene.adapt_s = Some(0.016);
    let mut overlay = Counting(0);
    let none = Target::Surface { view: &image.colour.view, format: OffscreenImage::FORMAT, size: [0, 3] };
    assert!(renderer.render(&gpu, &scene, none, Some(&mut overlay)).unwrap().passes.is_empty());
    for size in [[1, 1], [1, 7], [33, 2]] {
        let image = OffscreenImage::new(&gpu, size);
        scene.camera.size_px = size;
        renderer.render(&gpu, &scene, Target::Image(&image), Some(&mut overlay)).unwrap();
    }
    assert_eq!(overlay.0, 3);
    let map = ColourMap { size: [2, 2], rgba: vec![0; 12] };
    let error = renderer.register_body(&gpu, 3, &BodyMaps { albedo: Some(map), night: None }).unwrap_err().to_string();
    assert!(error.contains("body 3") && error.contains("expected 16"), "{error}");
}

#[test]
fn a_lost_device_is_an_error_and_not_a_panic() {
    let gpu = gpu();
    let mut renderer = Renderer::new(&gpu, RendererOptions::default()).unwrap();
    let image = OffscreenImage::new(&gpu, [16, 16]);
    let scene = empty_scene(image.size);
    gpu.device.destroy();
    let _ = gpu.device.poll(wgpu::PollType::Poll);
    let error = renderer.render(&gpu, &scene, Target::Image(&image), None).unwrap_err();
    assert!(matches!(error, RenderError::DeviceLost(_)), "{error}");
}
