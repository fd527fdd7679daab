//! Several airs in one picture, and what is skipped of them: order and composition against closed forms, pictures of what was skipped by
//! pictures of what was forced, and how an air goes where its body becomes a point. What cells and single pixels hold: `airs/cells.rs`.

use engine::air::model::{Gradient, LimbTable, Thickness};
use engine::air::{Air, Layer, Medium, Model, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::light::reflected::lambert_sphere;
use engine::render::pass::sky::choose::AIR_BELOW_PX;
use engine::render::{FrameReport, OffscreenImage, Renderer, RendererOptions, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Occluder, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3};
use glam::{DVec3, Quat, Vec3};

#[path = "airs/cells.rs"]
mod cells;

const SIZE: [u32; 2] = [96, 64];
const FOV_RAD: f32 = 0.9;
const LUX: f32 = 1.0e5;
const FAR_M: f32 = 1.5e11;

/// Tangent of half the field of view.
fn tan_half() -> f64 {
    libm::tan(0.5 * f64::from(FOV_RAD))
}

struct Stage {
    gpu: Gpu,
    renderer: Renderer,
    image: OffscreenImage,
    size: [u32; 2],
}

struct Taken {
    hdr: Vec<f32>,
    bytes: Vec<u8>,
    report: FrameReport,
}

impl Stage {
    fn new() -> Self {
        Self::of(SIZE)
    }

    fn of(size: [u32; 2]) -> Self {
        let gpu = Gpu::headless(BackendChoice::Auto).expect("these tests draw");
        let options = RendererOptions { shaders: ShaderLibrary::checkout(), measure: true };
        let renderer = Renderer::new(&gpu, options).expect("it compiles");
        let image = OffscreenImage::new(&gpu, size);
        Self { gpu, renderer, image, size }
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
    let tan_y = tan_half();
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
    light + behind * libm::exp(-f64::from(fog.opacity) * share)
}

/// True where no edge of a ball lies within two pixels.
fn is_even(body: &Body, ray: DVec3) -> bool {
    let centre = body.centre_m.as_dvec3();
    let miss = (centre - ray * ray.dot(centre)).length();
    let radius = body.air.as_ref().map_or(0.0, |air| air.medium.top_altitude_m);
    let pixel = 2.0 * tan_half() / f64::from(SIZE[1]);
    (miss - radius).abs() > 2.0 * pixel * centre.length()
}

/// The worst relative error over pixels away from edges against balls laid far to near.
fn worst(taken: &Taken, far_to_near: &[&Body]) -> f64 {
    let mut worst = 0.0_f64;
    for y in 0..SIZE[1] as usize {
        for x in 0..SIZE[0] as usize {
            let ray = direction(x, y);
            if !far_to_near.iter().all(|body| is_even(body, ray)) {
                continue;
            }
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
        assert!(error < 0.01, "{error}");
    }
    let turned = worst(&stage.take(&scene(vec![near.clone(), far.clone()])), &[&near, &far]);
    assert!(turned > 0.3, "the order is not seen: {turned}");
    // The eye in the nearer one.
    let around = bank(1, DVec3::new(100.0, 50.0, -300.0), 700.0, Vec3::new(0.9, 0.4, 0.1), 2.0);
    let error = worst(&stage.take(&scene(vec![around.clone(), far.clone()])), &[&far, &around]);
    println!("from within one: {error:.2e}");
    assert!(error < 0.01, "{error}");
    // A moon beside the limb of a giant, behind the edge of its air, though its centre is nearer.
    let giant = bank(3, DVec3::new(-7.0e4, 0.0, -3.87e4), 7.0e4, Vec3::new(0.8, 0.7, 0.5), 3.0);
    let moon = bank(4, DVec3::new(7.4e3, 0.0, -7.5e4), 1.5e4, Vec3::new(0.2, 0.9, 0.3), 3.0);
    assert!(moon.centre_m.length() < giant.centre_m.length());
    let error = worst(&stage.take(&scene(vec![moon.clone(), giant.clone()])), &[&moon, &giant]);
    let turned = worst(&stage.take(&scene(vec![giant.clone(), moon.clone()])), &[&giant, &moon]);
    println!("behind a limb: {error:.2e}; the other way round it would be {turned:.2e}");
    assert!(error < 0.05 && turned > 0.15, "{error}, {turned}");
}

/// What a ray brings through balls that fill the same space: of each, its light as the other lets it through.
fn together(bodies: [&Body; 2], ray: DVec3) -> DVec3 {
    let steps = 20_000_u32;
    let ds = 2.0e4 / f64::from(steps);
    let (mut light, mut depths) = (DVec3::ZERO, [0.0; 2]);
    for i in 0..steps {
        let at = ray * ((f64::from(i) + 0.5) * ds);
        for (i, body) in bodies.iter().enumerate() {
            let Some(Air { model: Model::Thickness(fog), medium, .. }) = &body.air else { panic!("a bank of fog") };
            if at.distance(body.centre_m.as_dvec3()) < medium.top_altitude_m {
                let share = ds / fog.scale_m.expect("it was given");
                light += fog.colour.as_dvec3() * (libm::exp(-depths[1 - i]) * share * f64::from(LUX) / core::f64::consts::PI);
                depths[i] += f64::from(fog.opacity) * share;
            }
        }
    }
    light
}

#[test]
fn a_bank_within_an_air_is_behind_the_air_before_it() {
    let mut stage = Stage::new();
    for (air, eye) in [(DVec3::new(500.0, 200.0, -4.0e3), "within"), (DVec3::new(500.0, 200.0, -8.0e3), "outside")] {
        let air = bank(1, air, 5.0e3, Vec3::new(0.2, 0.4, 0.8), 1.5);
        let fog = bank(2, DVec3::new(300.0, 100.0, air.centre_m.as_dvec3().z + 500.0), 600.0, Vec3::new(0.9, 0.8, 0.7), 2.0);
        let taken = stage.take(&scene(vec![fog.clone(), air.clone()]));
        let (mut worst, mut naive, mut count) = (0.0_f64, 0.0_f64, 0);
        for (x, y) in (24..32).flat_map(|y| (46..56).map(move |x| (x, y))) {
            let ray = direction(x, y);
            if width(&fog, ray) < 600.0 || !is_even(&fog, ray) {
                continue;
            }
            count += 1;
            let truth = together([&air, &fog], ray);
            let laid = over(&fog, ray, over(&air, ray, DVec3::ZERO));
            for c in 0..3 {
                let pixel = f64::from(taken.hdr[4 * (y * SIZE[0] as usize + x) + c]);
                worst = worst.max((pixel / truth[c] - 1.0).abs());
                naive = naive.max((laid[c] / truth[c] - 1.0).abs());
            }
        }
        assert!(count > 5, "{count} pixels");
        println!("a bank in an air, the eye {eye}: {worst:.3}; laid over the whole of it: {naive:.3}");
        assert!(worst < 0.05 && naive > 0.15, "{worst}, {naive}");
    }
}

#[test]
fn black_fog_far_off_is_as_blue_as_a_black_ball_there() {
    // On the ground of an earth; what is seen of either is the air before it alone.
    let mut stage = Stage::new();
    let at = DVec3::new(2.0e3, 3.0e3, -2.0e4);
    let ground = body(1, DVec3::NEG_Y * 6.4002e6, 6.4e6, Surface::Smooth, earthly(6.4e6));
    let ball = Body { air: None, albedo: Vec3::ZERO, ..body(2, at, 1.5e3, Surface::Smooth, earthly(1.5e3)) };
    let fog = Thickness { brightness: 0.0, scale_m: Some(100.0), opacity: 10.0, ..Thickness::default() }.ball(1.5e3);
    let fog = body(2, at, fog.medium.bottom_radius_m, Surface::Nothing, fog);
    let [ball, fog, clear] = [vec![ball, ground.clone()], vec![fog, ground.clone()], vec![ground]].map(|bodies| stage.take(&scene(bodies)));
    let along = at.normalize();
    let mut count = 0;
    for (x, y) in (0..64).flat_map(|y| (0..96).map(move |x| (x, y))).filter(|(x, y)| direction(*x, *y).dot(along) > libm::cos(0.04)) {
        count += 1;
        let pixel = |taken: &Taken, c: usize| f64::from(taken.hdr[4 * (y * SIZE[0] as usize + x) + c]);
        for c in 0..3 {
            // The ball's near side is nearer than the middle of the fog by a tenth of the way.
            let ratio = pixel(&fog, c) / pixel(&ball, c);
            assert!((1.0..1.15).contains(&ratio), "{x}, {y}: {ratio}");
            assert!(pixel(&fog, c) < 0.8 * pixel(&clear, c), "{x}, {y}: fog {}, clear {}", pixel(&fog, c), pixel(&clear, c));
        }
    }
    assert!(count > 10, "{count}");
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
        let area = 4.0 * tan_half() * tan_half() * f64::from(SIZE[0]) / f64::from(SIZE[1]);
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

/// Green light of all pixels.
fn sum(taken: &Taken) -> f64 {
    taken.hdr.chunks_exact(4).map(|p| f64::from(p[1])).sum()
}

#[test]
fn an_eclipse_dims_the_painted_air() {
    let mut stage = Stage::new();
    let air = Air { model: Model::Gradient(Gradient::default()), ..earthly(6.4e6) };
    let planet = Body { albedo: Vec3::ZERO, ..body(1, DVec3::NEG_Z * 2.0e7, 6.4e6, Surface::Smooth, air) };
    let bare = stage.take(&scene(vec![planet.clone()]));
    // So far off that all of the planet sees the same: a disc of half the sun's radius before its middle, and one that hides it.
    let mut eclipsed = |share: f32| {
        let occluder =
            Occluder { id: 9, centre_m: planet.centre_m + planet.sun_direction * 1.0e10, radius_m: share * 1.0e10 * 7.0e8 / FAR_M };
        stage.take(&scene(vec![Body { occluders: vec![occluder], ..planet.clone() }]))
    };
    let half = eclipsed(0.5);
    assert!(sum(&bare) > 1e4);
    for (a, b) in bare.hdr.iter().zip(&half.hdr).filter(|(a, _)| **a > 10.0) {
        assert!((b / a - 0.75).abs() < 0.003, "{b} of {a}");
    }
    assert!(sum(&eclipsed(2.0)) == 0.0);
}

#[test]
fn a_second_sun_adds_a_second_limb() {
    let mut stage = Stage::new();
    let air = Air { model: Model::LimbTable(LimbTable::default()), ..earthly(6.4e6) };
    let planet = Body { albedo: Vec3::ZERO, ..body(1, DVec3::NEG_Z * 2.0e7, 6.4e6, Surface::Smooth, air) };
    let second = Body {
        air: None,
        albedo: Vec3::new(1.0, 0.5, 0.25),
        sun_direction: Vec3::NEG_Z,
        ..body(2, DVec3::Z * 1.0e8, 4.0e7, Surface::Smooth, earthly(4.0e7))
    };
    let share = lambert_sphere(1.0, 4.0e7, 1.2e8, 0.0);
    let one = stage.take(&scene(vec![planet.clone()]));
    let both = stage.take(&scene(vec![planet.clone(), second.clone()]));
    // The sun where the other world stands.
    let other = stage.take(&scene(vec![Body { sun_direction: Vec3::Z, ..planet }]));
    let mut lit = 0;
    for (i, ((a, b), c)) in one.hdr.iter().zip(&both.hdr).zip(&other.hdr).enumerate().filter(|(i, _)| i % 4 < 3) {
        let truth = f64::from(*a) + share * f64::from(second.albedo[i % 4] * c);
        assert!((f64::from(*b) - truth).abs() < 2e-3 * truth + 0.01, "{i}: {b}, not {truth}");
        lit += usize::from(truth > 1.02 * f64::from(*a) + 1.0);
    }
    println!("{lit} values are of the second sun");
    assert!(lit > 500, "{lit}");
}

#[test]
fn a_body_that_becomes_a_point_does_not_jump() {
    let mut stage = Stage::new();
    let pixel = 2.0 * tan_half() / f64::from(SIZE[1]);
    // Light over the disc's size in pixels, across what has its air drawn.
    let mut light = |px: f64, aired: bool| {
        let mut planet = body(1, DVec3::new(0.01, 0.007, -1.0) * (6.4e6 / (px * pixel)), 6.4e6, Surface::Smooth, earthly(6.4e6));
        planet.air = planet.air.filter(|_| aired);
        let taken = stage.take(&scene(vec![planet]));
        (taken.report.airs.first().is_some_and(|air| air.ran), sum(&taken) / (px * px))
    };
    let [small, large] = [f64::from(AIR_BELOW_PX) - 0.01, f64::from(AIR_BELOW_PX) + 0.01].map(|px| light(px, true));
    let bare = light(f64::from(AIR_BELOW_PX) + 0.01, false);
    println!("{small:?}, {large:?}, {bare:?}; of discs: {:?}", [1.2, 2.0, 4.0, 8.0].map(|px| light(px, true)));
    assert!(!small.0 && large.0);
    // Air before the disc comes in by degrees.
    assert!((large.1 / bare.1 - 1.0).abs() < 0.05, "{bare:?}, {large:?}");
    assert!((large.1 / small.1 - 1.0).abs() < 0.05, "{small:?}, {large:?}");
}
