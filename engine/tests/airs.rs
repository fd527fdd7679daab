//! Several airs in one picture, and what is skipped of them: order and composition against closed forms, pictures of what was skipped by
//! pictures of what was forced, and how much an air adds where its body becomes a point.

use engine::air::model::{Gradient, Thickness};
use engine::air::{Air, Layer, Medium, Model, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::{FrameReport, OffscreenImage, Renderer, RendererOptions, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3};
use glam::{DVec3, Quat, Vec3};

const SIZE: [u32; 2] = [96, 64];
const FOV_RAD: f32 = 0.9;
const LUX: f32 = 1.0e5;
const FAR_M: f32 = 1.5e11;

struct Stage {
    gpu: Gpu,
    renderer: Renderer,
    image: OffscreenImage,
}

struct Taken {
    hdr: Vec<f32>,
    bytes: Vec<u8>,
    report: FrameReport,
}

impl Stage {
    fn new() -> Self {
        let gpu = Gpu::headless(BackendChoice::Auto).expect("these tests draw");
        let options = RendererOptions { shaders: ShaderLibrary::checkout(), measure: true };
        let renderer = Renderer::new(&gpu, options).expect("it compiles");
        let image = OffscreenImage::new(&gpu, SIZE);
        Self { gpu, renderer, image }
    }

    fn take(&mut self, scene: &Snapshot) -> Taken {
        let report = self.renderer.render(&self.gpu, scene, Target::Image(&self.image), None).expect("it is drawn");
        let hdr = self.renderer.read_hdr(&self.gpu).expect("it is read").rgba;
        Taken { hdr, bytes: self.image.read_rgba8(&self.gpu).expect("it is read"), report }
    }
}

/// The camera looks along −Z; the sun stands behind it, above.
fn scene(bodies: Vec<Body>) -> Snapshot {
    let sun = Vec3::new(0.0, 0.6, 0.8);
    Snapshot {
        camera: Camera { view_from_icrf: Quat::IDENTITY, fov_y_rad: FOV_RAD, near_m: 0.1, size_px: SIZE },
        star: Star { id: 0, centre_m: sun * FAR_M, radius_m: 7.0e8, intensity_cd: Vec3::splat(LUX * FAR_M * FAR_M) },
        bodies,
        ships: Vec::new(),
        exposure: AutoOr::Ev100(14.0),
        adapt_s: None,
        force: Force::default(),
    }
}

fn body(id: u16, centre_m: DVec3, radius_m: f64, surface: Surface, air: Air) -> Body {
    let distance = centre_m.length();
    Body {
        id,
        centre_m: narrow3(centre_m),
        radius_m: narrow(radius_m),
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: narrow(distance - radius_m),
        camera_up: narrow3((-centre_m).normalize_or(DVec3::Z)),
        sun_direction: Vec3::new(0.0, 0.6, 0.8),
        sun_angular_radius_rad: 0.00465,
        sun_illuminance_lx: Vec3::splat(LUX),
        occluders: Vec::new(),
        albedo: Vec3::splat(0.2),
        surface,
        air: Some(air),
    }
}

/// A bank of fog: `opacity` over its diameter.
fn bank(id: u16, centre_m: DVec3, radius_m: f64, colour: Vec3, opacity: f32) -> Body {
    let fog = Thickness { colour, brightness: 1.0, scale_m: Some(2.0 * radius_m), opacity, ..Thickness::default() }.ball(radius_m);
    body(id, centre_m, fog.medium.bottom_radius_m, Surface::Nothing, fog)
}

fn earthly(radius_m: f64) -> Air {
    let layer = |scattering_per_m, height, phase| Layer {
        scattering_per_m,
        absorption_per_m: Vec3::ZERO,
        profile: Profile::Exponential { scale_height_m: height },
        phase,
    };
    let layers = vec![
        layer(Vec3::new(5.8e-6, 13.6e-6, 33.1e-6), 8000.0, Phase::Rayleigh),
        layer(Vec3::splat(4e-6), 1200.0, Phase::CornetteShanks { g: 0.8 }),
    ];
    Medium { bottom_radius_m: radius_m, top_altitude_m: 6.0e4, ground_albedo: Vec3::splat(0.2), layers }.into()
}

/// Unit direction through a pixel's middle.
fn direction(x: usize, y: usize) -> DVec3 {
    let [w, h] = SIZE.map(f64::from);
    let tan_y = (0.5 * f64::from(FOV_RAD)).tan();
    DVec3::new((2.0 * (x as f64 + 0.5) / w - 1.0) * tan_y * w / h, (1.0 - 2.0 * (y as f64 + 0.5) / h) * tan_y, -1.0).normalize()
}

/// Width of a ball along a ray from the eye, m.
fn width(body: &Body, ray: DVec3) -> f64 {
    let radius = body.air.as_ref().map_or(0.0, |air| air.medium.top_altitude_m);
    let centre = body.centre_m.as_dvec3();
    let along = ray.dot(centre);
    let half = (radius * radius - (centre - ray * along).length_squared()).max(0.0).sqrt();
    (along + half).max(0.0) - (along - half).max(0.0)
}

/// What a ball makes of the light behind it.
fn over(body: &Body, ray: DVec3, behind: DVec3) -> DVec3 {
    let Some(Air { model: Model::Thickness(fog), .. }) = &body.air else { panic!("a bank of fog") };
    let share = width(body, ray) / fog.scale_m.expect("it was given");
    let light = fog.colour.as_dvec3() * share * f64::from(LUX) / core::f64::consts::PI;
    light + behind * (-f64::from(fog.opacity) * share).exp()
}

/// The worst relative error over all pixels against balls laid far to near.
fn worst(taken: &Taken, far_to_near: &[&Body]) -> f64 {
    let mut worst = 0.0_f64;
    for y in 0..SIZE[1] as usize {
        for x in 0..SIZE[0] as usize {
            let ray = direction(x, y);
            let truth = far_to_near.iter().fold(DVec3::ZERO, |behind, body| over(body, ray, behind));
            let at = 4 * (y * SIZE[0] as usize + x);
            for c in 0..3 {
                worst = worst.max((f64::from(taken.hdr[at + c]) - truth[c]).abs() / (truth[c] + 100.0));
            }
        }
    }
    worst
}

#[test]
fn two_airs_are_each_other_s_background() {
    let mut stage = Stage::new();
    let near = bank(1, DVec3::new(300.0, 100.0, -2.0e3), 700.0, Vec3::new(0.9, 0.4, 0.1), 2.0);
    let far = bank(2, DVec3::new(-600.0, -300.0, -6.0e3), 2.0e3, Vec3::new(0.1, 0.5, 0.9), 1.0);
    for bodies in [vec![near.clone(), far.clone()], vec![far.clone(), near.clone()]] {
        let error = worst(&stage.take(&scene(bodies)), &[&far, &near]);
        println!("two banks: {error:.2e}");
        assert!(error < 3e-3, "{error}");
    }
    // The eye in the nearer one.
    let around = bank(1, DVec3::new(100.0, 50.0, -300.0), 700.0, Vec3::new(0.9, 0.4, 0.1), 2.0);
    let error = worst(&stage.take(&scene(vec![around.clone(), far.clone()])), &[&far, &around]);
    println!("from within one: {error:.2e}");
    assert!(error < 3e-3, "{error}");
    // A moon beside the limb of a giant, behind the edge of its air, though its centre is nearer.
    let giant = bank(3, DVec3::new(-7.0e4, 0.0, -2.0e5), 7.0e4, Vec3::new(0.8, 0.7, 0.5), 3.0);
    let moon = bank(4, DVec3::new(-2.0e3, 0.0, -1.95e5), 5.0e3, Vec3::new(0.2, 0.9, 0.3), 3.0);
    assert!(moon.centre_m.length() < giant.centre_m.length());
    let error = worst(&stage.take(&scene(vec![moon.clone(), giant.clone()])), &[&moon, &giant]);
    println!("behind a limb: {error:.2e}");
    assert!(error < 3e-3, "{error}");
}

#[test]
fn airs_that_are_not_seen_are_not_made_and_change_nothing() {
    let mut stage = Stage::new();
    let gradient = Air { model: Model::Gradient(Gradient::default()), ..earthly(6.4e6) };
    let seen = body(1, DVec3::NEG_Z * 2.0e7, 6.4e6, Surface::Smooth, gradient);
    let behind = body(2, DVec3::Z * 1.4e7, 6.4e6, Surface::Smooth, earthly(6.4e6));
    let point = body(3, DVec3::new(-4.0e8, 1.0e8, -9.0e8), 2.0e6, Surface::Smooth, earthly(2.0e6));
    let mut scene = scene(vec![seen, behind, point]);
    let plain = stage.take(&scene);
    let tables = |taken: &Taken| {
        let mut all: Vec<_> = taken.report.airs.iter().map(|a| (a.body, a.ran, a.tables.clone())).collect();
        all.sort();
        all
    };
    let told = tables(&plain);
    assert_eq!(told[0], (1, true, "made: new or changed".to_owned()), "{told:?}");
    assert_eq!(told[1], (2, false, "none: out of view".to_owned()), "{told:?}");
    assert!(!told[2].1 && told[2].2.starts_with("none: its disc has a radius of 0."), "{told:?}");
    assert_eq!(tables(&stage.take(&scene))[0].2, "as they were made");

    scene.force.all = true;
    let forced = stage.take(&scene);
    assert!(tables(&forced).iter().all(|t| t.2.contains("made")), "{:?}", tables(&forced));
    assert!(tables(&forced)[1].1, "what is out of view was to be drawn");
    assert!(plain.hdr == forced.hdr && plain.bytes == forced.bytes, "what was skipped changes the picture");
}

#[test]
fn an_air_that_comes_into_view_is_as_if_it_had_always_been() {
    let mut stage = Stage::new();
    let planet = body(2, DVec3::Z * 1.4e7, 6.4e6, Surface::Smooth, earthly(6.4e6));
    let mut scene = scene(vec![planet]);
    let away = stage.take(&scene);
    assert!(!away.report.pass("air_tables").expect("it is told").ran, "{:?}", away.report.pass("air_tables"));
    scene.camera.view_from_icrf = Quat::from_rotation_y(core::f32::consts::PI);
    let turned = stage.take(&scene);
    assert!(turned.report.pass("air_tables").expect("it is told").ran);
    let fresh = Stage::new().take(&scene);
    assert!(turned.hdr == fresh.hdr && turned.bytes == fresh.bytes);
    // Away and back: nothing is made anew.
    scene.camera.view_from_icrf = Quat::IDENTITY;
    stage.take(&scene);
    scene.camera.view_from_icrf = Quat::from_rotation_y(core::f32::consts::PI);
    let back = stage.take(&scene);
    assert!(!back.report.pass("air_tables").expect("it is told").ran);
    assert!(back.hdr == turned.hdr);
}

#[test]
fn a_second_air_costs_by_what_it_covers() {
    let mut stage = Stage::new();
    let ground = |air| body(1, DVec3::NEG_Y * 6.4002e6, 6.4e6, Surface::Smooth, air);
    let second = |share: f64| {
        // A disc of this share of the picture, air included.
        let area = 4.0 * (0.5 * f64::from(FOV_RAD)).tan().powi(2) * f64::from(SIZE[0]) / f64::from(SIZE[1]);
        let distance = 6.46e6 / (area * share / core::f64::consts::PI).sqrt();
        body(2, DVec3::new(0.1, 0.2, -1.0).normalize() * distance, 6.4e6, Surface::Smooth, earthly(6.4e6))
    };
    let alone = scene(vec![ground(earthly(6.4e6))]);
    let with = scene(vec![ground(earthly(6.4e6)), second(0.01)]);
    let half = scene(vec![ground(earthly(6.4e6)), second(0.25)]);
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    for _ in 0..9 {
        for (times, scene) in times.iter_mut().zip([&alone, &with, &half]) {
            let report = stage.take(scene).report;
            times.push(report.pass("sky").and_then(|p| p.gpu_ms).unwrap_or_default());
        }
    }
    let report = stage.take(&with).report;
    let covers: Vec<f32> = report.airs.iter().map(|a| a.covers).collect();
    let [one, two, more] = times.map(|mut t| {
        t.sort_by(f64::total_cmp);
        t[0]
    });
    println!("sky: {one:.2} ms alone, {two:.2} ms with a second air on 1 % ({covers:?}), {more:.2} ms on 25 %");
    // The rectangle around it, with two pixels at every edge.
    assert!(covers[0] < 0.035 && covers[1] > 0.99, "{covers:?}");
}
