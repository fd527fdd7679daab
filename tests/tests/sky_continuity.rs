//! The sky of the model `physical` shot by shot: a climb from the datum to 1,000 km, and eclipses from first to fourth contact, without a
//! pop; and eclipsed air against the reference with occluders.
//!
//! What a pop is, and which pairs of shots are left out: `tests::continuity`. Here as everywhere the bar is 1 %. The whole courses:
//!
//! ```text
//! cargo test --release --workspace --test sky_continuity -- --ignored --skip writes
//! ```

use engine::air::model::Physical;
use engine::air::{Air, Medium, Model};
use engine::gpu::{Gpu, ShaderLibrary};
use engine::render::pass::sky::STEPS;
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, Prober};
use engine::render::sky_bench::{Planet, Setting, SkyBench, Technique};
use engine::render::{OffscreenImage, Renderer, RendererOptions, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Occluder, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3};
use engine::units::{DEG, KM};
use glam::{DQuat, DVec3, Mat3, Quat, Vec3};
use std::collections::BTreeMap;
use tests::continuity::{Course, MOON_M, Pops, Shot, climb, polar, transit};
use tests::sky_eclipse;
use tests::sky_truth::planet;

const TRUTH: &str = include_str!("../reference/sky_eclipse.csv");
const BAR: f64 = 0.01;

fn views(list: &[(f64, f64)]) -> Vec<DVec3> {
    list.iter().map(|v| polar(v.0, v.1)).collect()
}

fn prober(gpu: &Gpu, medium: &Medium) -> Prober {
    Prober::new(gpu, &ShaderLibrary::checkout(), &medium.clone().into()).expect("its tables are made")
}

fn told(name: &str, pops: &Pops) {
    println!("{name}: {} pairs\n  single {:.4}: {}\n  all {:.4}: {}", pops.pairs, pops.single.0, pops.single.1, pops.all.0, pops.all.1);
}

/// Climbs under a high, a setting and a sunken sun.
fn climbs(shots: u32, list: &[(f64, f64)]) -> Pops {
    let gpu = tests::gpu();
    let planet = planet("earth");
    let prober = prober(&gpu, &planet.medium);
    let views = views(list);
    let shots: Vec<Shot> = climb(shots, planet.medium.top_altitude_m).into_iter().map(|h| Shot::at(h, Vec::new())).collect();
    let mut all = Pops::default();
    for sun_zenith in [40.0, 89.5, 95.0] {
        let course = Course { medium: &planet.medium, sun: (polar(sun_zenith, 0.0), planet.sun_rad), views: &views };
        let pops = course.pops(&gpu, &prober, &shots);
        told(&format!("climb, sun at {sun_zenith}°"), &pops);
        all = all.and(pops);
    }
    all
}

#[test]
fn a_climb_is_without_a_pop() {
    let pops = climbs(150, &[(0.0, 0.0), (85.0, 60.0), (90.0, 180.0), (96.0, 0.0), (105.0, 0.0), (180.0, 0.0)]);
    assert!(pops.single.0 < BAR && pops.all.0 < BAR, "{pops:?}");
    // That little is what twelve points on a ray make of it.
    assert!(pops.single.0 > 1e-3 && pops.pairs > 6000, "{pops:?}");
}

#[test]
#[ignore = "minutes: two thousand shots"]
fn a_climb_of_two_thousand_shots_is_without_a_pop() {
    let list = [
        (0.0, 0.0),
        (60.0, 0.0),
        (60.0, 180.0),
        (85.0, 60.0),
        (89.9, 0.0),
        (90.0, 180.0),
        (90.5, 60.0),
        (91.5, 0.0),
        (93.0, 180.0),
        (96.0, 0.0),
        (100.0, 60.0),
        (105.0, 0.0),
        (120.0, 180.0),
        (180.0, 0.0),
    ];
    let pops = climbs(2000, &list);
    assert!(pops.single.0 < BAR && pops.all.0 < BAR, "{pops:?}");
    assert!(pops.all.0 > 3e-3 && pops.pairs > 200_000, "{pops:?}");
}

#[test]
fn a_pop_would_be_found() {
    // A model that thinks itself a fifth higher as soon as it has left the air, and one that lags by 300 m from 20 km on.
    let gpu = tests::gpu();
    let planet = planet("earth");
    let prober = prober(&gpu, &planet.medium);
    let views = views(&[(60.0, 0.0), (105.0, 0.0)]);
    let course = Course { medium: &planet.medium, sun: (polar(40.0, 0.0), planet.sun_rad), views: &views };
    for (from_m, told) in [(60.0 * KM, 1.2), (20.0 * KM, 0.985)] {
        let shot = |i: i32| {
            let mut shot = Shot::at(from_m + 50.0 * f64::from(i), Vec::new());
            shot.told_m *= if i > 0 { told } else { 1.0 };
            shot
        };
        let shots: Vec<Shot> = (-3..4).map(shot).collect();
        let pops = course.pops(&gpu, &prober, &shots);
        assert!(pops.single.0 > BAR, "{told}: {pops:?}");
    }
}

/// Eyes under an eclipse: altitude, the moon's radius over the sun's, by how much the shadow's axis misses.
const EYES: [(f64, f64, f64); 8] = [
    (2.0, sky_eclipse::RATIO, 0.0),
    (2.0, sky_eclipse::RATIO, 50e3),
    (2.0, sky_eclipse::RATIO, 800e3),
    (2.0, 0.95, 0.0),
    (2.0, 1.0, 0.0),
    (10.0 * KM, sky_eclipse::RATIO, 0.0),
    (400.0 * KM, sky_eclipse::RATIO, 0.0),
    (400.0 * KM, 0.95, 0.0),
];

fn transits(shots: u32, eyes: &[(f64, f64, f64)], suns: &[f64]) -> Pops {
    let gpu = tests::gpu();
    let planet = planet("earth");
    let prober = prober(&gpu, &planet.medium);
    let mut all = Pops::default();
    for sun_zenith in suns {
        for (altitude_m, ratio, miss_m) in eyes {
            let sun = (polar(*sun_zenith, 0.0), planet.sun_rad);
            let views = if *altitude_m > 100.0 * KM {
                views(&[(180.0, 0.0), (150.0, 90.0), (120.0, 180.0), (108.0, 0.0), (111.0, 90.0)])
            } else {
                // Two of them at the sun and beside it, along the shadow's axis.
                views(&[(0.0, 0.0), (60.0, 90.0), (85.0, 180.0), (89.0, 90.0), (*sun_zenith, 0.0), (sun_zenith - 0.1, 0.02)])
            };
            let course = Course { medium: &planet.medium, sun, views: &views };
            let pops = course.pops(&gpu, &prober, &transit(&planet.medium, sun, *altitude_m, *ratio, *miss_m, shots));
            told(&format!("eclipse from {altitude_m} m, sun at {sun_zenith}°, ratio {ratio}, missed by {miss_m} m"), &pops);
            all = all.and(pops);
        }
    }
    all
}

#[test]
fn an_eclipse_is_without_a_pop() {
    let pops = transits(45, &[EYES[0], EYES[3], EYES[5], EYES[6]], &[64.0]);
    assert!(pops.single.0 < BAR && pops.all.0 < BAR, "{pops:?}");
    assert!(pops.all.0 > 1e-3 && pops.pairs > 2000, "{pops:?}");
}

#[test]
#[ignore = "minutes: sixteen eclipses of six hundred shots"]
fn eclipses_of_six_hundred_shots_are_without_a_pop() {
    let pops = transits(600, &EYES, &[64.0, 80.0]);
    assert!(pops.single.0 < BAR && pops.all.0 < BAR, "{pops:?}");
    assert!(pops.all.0 > 1e-3 && pops.pairs > 100_000, "{pops:?}");
}

#[test]
#[ignore = "minutes: writes reference/sky_eclipse.csv; run with --release"]
fn writes_the_eclipse() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/reference/sky_eclipse.csv");
    std::fs::write(path, sky_eclipse::write(0.01)).expect("it can be written");
}

/// Errors of a class: of single scattering and of all orders, both by the radiance of all orders, %.
#[test]
fn eclipsed_air_is_that_of_the_reference() {
    let gpu = tests::gpu();
    let planet = planet("earth");
    let prober = prober(&gpu, &planet.medium);
    let row = |v: DVec3, w: f64| [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)];
    let mut classes: BTreeMap<String, Vec<[f64; 2]>> = BTreeMap::new();
    for truth in sky_eclipse::read(TRUTH) {
        let ray = &truth.ray;
        let up = row(ray.from_m.normalize(), ray.from_m.length() - planet.medium.bottom_radius_m);
        let asked = ProbeRay { up, ray: row(ray.direction, 0.0), sun: row(ray.sun, ray.sun_rad) };
        let occluder = |o: &engine::air::reference::Sphere| Occluder { id: 1, centre_m: narrow3(o.centre_m), radius_m: narrow(o.radius_m) };
        let find = |multiple| {
            let occluders = ray.occluders.iter().map(occluder).collect();
            prober.ask(&gpu, &[asked], &ProbeOptions { multiple, occluders, ..ProbeOptions::default() }).expect("it marches")[0].radiance
        };
        let (single, all) = (find(false), find(true));
        let errors = classes.entry(truth.class.clone()).or_default();
        for c in 0..3 {
            let total = truth.total.0[c];
            errors.push([f64::from(single[c]) - truth.single[c], f64::from(all[c]) - total].map(|e| 100.0 * e / total));
        }
    }
    let stated = [
        ("ground centre", 6.1, 14.7),
        ("ground inside", 8.7, 32.4),
        ("ground edge", 8.7, 38.3),
        ("ground out", 3.4, 12.2),
        ("ground half", 0.4, 1.6),
        ("ground first", 0.4, 1.1),
        ("10 km centre", 6.0, 14.7),
        ("10 km inside", 5.6, 12.3),
        ("10 km edge", 6.8, 14.4),
        ("10 km out", 3.8, 6.7),
        ("10 km half", 0.4, 1.3),
        ("10 km first", 0.6, 1.6),
        ("400 km centre", 6.8, 16.8),
        ("400 km inside", 5.2, 14.7),
        ("400 km edge", 7.5, 16.7),
        ("400 km out", 2.0, 5.9),
        ("400 km half", 0.4, 1.4),
        ("400 km first", 0.5, 1.7),
    ];
    let mut wrong = Vec::new();
    for (class, rms, worst) in stated {
        let errors = &classes[class];
        let root = |k: usize| (errors.iter().map(|e| e[k] * e[k]).sum::<f64>() / errors.len() as f64).sqrt();
        let most = |k: usize| errors.iter().map(|e| e[k].abs()).fold(0.0, f64::max);
        let (first, all, most_first, most_all) = (root(0), root(1), most(0), most(1));
        println!("{class:14} single {first:.2} % (worst {most_first:.2}), all orders {all:.1} % (worst {most_all:.1})");
        let near = |x: f64, stated: f64| (x / stated - 1.0).abs() < 0.34;
        if !(near(all, rms) && near(most_all, worst) && first < 0.03 && most_first < 0.1) {
            wrong.push(class);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// The picture of a climb: the Earth of the reference as a smooth body under its air, looked at along a fixed direction.
struct Picture {
    pitch_deg: f64,
}

/// A pixel of 2.5 mrad, as in a picture 400 rows high: up, above and along the level, over the horizon of every height, and down.
const PITCHES_DEG: [f64; 7] = [60.0, 8.0, 0.5, -3.0, -9.0, -18.0, -80.0];
const FOV_DEG: f64 = 3.44;
const SIDE: u32 = 24;
/// Radiance, sr⁻¹ per unit of the sun's illuminance, below which a jump is one of this: a thousandth of what stored is white.
const FLOOR: f64 = 1e-7;

impl Picture {
    /// Columns right, up and forward.
    fn axes(&self) -> Mat3 {
        let forward = narrow3(polar(90.0 - self.pitch_deg, 0.0));
        let right = forward.cross(Vec3::Z).normalize_or(Vec3::NEG_Y);
        Mat3::from_cols(right, right.cross(forward), forward)
    }

    fn scene(&self, air: &Air, altitude_m: f64, sun: (DVec3, f64)) -> Snapshot {
        let bottom = air.medium.bottom_radius_m;
        let axes = self.axes();
        let body = Body {
            id: 3,
            centre_m: narrow3(DVec3::NEG_Z * (bottom + altitude_m)),
            radius_m: narrow(bottom),
            icrf_from_fixed: Quat::IDENTITY,
            camera_altitude_m: narrow(altitude_m),
            camera_up: Vec3::Z,
            sun_direction: narrow3(sun.0),
            sun_angular_radius_rad: narrow(sun.1),
            sun_illuminance_lx: Vec3::ONE,
            occluders: Vec::new(),
            albedo: Vec3::ZERO,
            surface: Surface::Smooth,
            air: Some(air.clone()),
        };
        Snapshot {
            camera: Camera {
                view_from_icrf: Quat::from_mat3(&Mat3::from_cols(axes.x_axis, axes.y_axis, -axes.z_axis)).conjugate(),
                fov_y_rad: narrow(FOV_DEG * DEG),
                near_m: 0.2,
                size_px: [SIDE; 2],
            },
            star: Star { id: 0, centre_m: narrow3(sun.0 * 1.496e11), radius_m: narrow(1.496e11 * sun.1.sin()), intensity_cd: Vec3::ONE },
            bodies: vec![body],
            ships: Vec::new(),
            exposure: AutoOr::Ev100(0.0),
            adapt_s: None,
            force: Force::default(),
        }
    }

    /// Zenith angle of each pixel's middle and half of its diagonal, rad.
    fn pixels(&self) -> (Vec<f64>, f64) {
        let (axes, tan) = (self.axes(), (0.5 * FOV_DEG * DEG).tan());
        let at = |i: u32| (f64::from(2 * i + 1) / f64::from(SIDE) - 1.0) * tan;
        let ray = |i: u32| axes.as_dmat3() * DVec3::new(at(i % SIDE), -at(i / SIDE), 1.0);
        ((0..SIDE * SIDE).map(|i| ray(i).normalize().z.acos()).collect(), 2.0_f64.sqrt() * tan / f64::from(SIDE))
    }
}

/// How far a pixel of drawn shots jumps at most beyond what it changes in the shots before and after, as a share of its light (or of a thousandth of white,
/// where it is darker). `at` is where on their course the shots are, rising; pairs of a shot and the one before are left out by `skipped`, with a pixel.
fn jump(drawn: &[Vec<f32>], at: &[f64], skipped: &dyn Fn(usize, usize) -> bool, place: &dyn Fn(usize, usize) -> String) -> (f64, String) {
    let mut worst = (0.0, String::new());
    for i in 2..at.len().saturating_sub(1) {
        for pixel in 0..(SIDE * SIDE) as usize {
            if (i - 1..=i + 1).any(|k| skipped(k, pixel)) {
                continue;
            }
            for c in 0..3 {
                let light = |k: usize| f64::from(drawn[k][4 * pixel + c]);
                // Light may change evenly, or by an even share; steps of a course need not be even either.
                let greatest = |i: usize, k: usize| light(i).max(light(k)).max(FLOOR);
                let beyond = |share: &dyn Fn(usize) -> f64| {
                    let change = |k: usize| (light(k) - light(k - 1)).abs() / share(k);
                    let even = |k: usize| change(k) * ((at[i] - at[i - 1]) / (at[k] - at[k - 1])).max(1.0);
                    change(i) - even(i - 1).max(even(i + 1))
                };
                let jump = beyond(&|_| greatest(i, i - 1)).min(beyond(&|k| greatest(k, k - 1)));
                if jump > worst.0 {
                    let lights = [i - 2, i - 1, i, i + 1].map(|k| format!("{:.4e}", light(k)));
                    worst = (jump, format!("{}, channel {c}: {lights:?} sr⁻¹", place(i, pixel)));
                }
            }
        }
    }
    worst
}

/// [`jump`] of a climb. Left out are pixels over which the edge of the planet or of its air passes between the shots, and those next to them.
fn drawn_jump(altitudes: &[Vec<f64>], sun_zenith: f64, everywhere: bool) -> (f64, String) {
    let gpu = tests::gpu();
    let earth = planet("earth");
    let planet = Planet { name: "earth".to_owned(), medium: earth.medium, sun_rad: earth.sun_rad };
    let medium = &planet.medium;
    // Aside, so that its disc, which rises over the horizon on the way, is not in view.
    let sun = (polar(sun_zenith, 60.0), planet.sun_rad);
    // The sky's own passes alone: what follows them in a frame has no part in this.
    let mut bench = SkyBench::new(&gpu, &ShaderLibrary::checkout(), [SIDE; 2], &planet, &|| 0.0).expect("its passes compile");
    let mut with = bench.prepare(medium, &Technique::Model(Model::Physical(Physical::default()))).expect("its tables are made");
    let setting = Setting { steps: STEPS, every_pixel: everywhere, agree: None };
    let edges = |h: f64| {
        let edge = |above: f64| {
            (h >= above).then(|| std::f64::consts::PI - ((medium.bottom_radius_m + above) / (medium.bottom_radius_m + h)).asin())
        };
        [edge(0.0), edge(medium.top_altitude_m)]
    };
    let mut worst = (0.0, String::new());
    for picture in PITCHES_DEG.map(|pitch_deg| Picture { pitch_deg }) {
        let (zeniths, half) = picture.pixels();
        for run in altitudes {
            let mut drawn: Vec<Vec<f32>> = Vec::new();
            for h in run {
                let scene = picture.scene(&with.air, *h, sun);
                bench.draw(&scene, &mut with, setting, None).expect("it is drawn");
                drawn.push(bench.read().expect("it can be read"));
            }
            let skipped = |k: usize, pixel: usize| {
                let zenith = zeniths[pixel];
                [0, 1].into_iter().any(|edge| match (edges(run[k - 1])[edge], edges(run[k])[edge]) {
                    (Some(a), Some(b)) => a.min(b) < zenith + 3.0 * half && a.max(b) > zenith - 3.0 * half,
                    (None, None) => false,
                    _ => edge == 1 && (zenith - 0.5 * std::f64::consts::PI).abs() < 3.0 * half,
                })
            };
            let place = |i: usize, pixel: usize| {
                format!(
                    "sun at {sun_zenith}°, pitch {}°, {:.2} m → {:.2} m, pixel {pixel}, zenith angle {:.2}°",
                    picture.pitch_deg,
                    run[i - 1],
                    run[i],
                    zeniths[pixel] / DEG
                )
            };
            let found = jump(&drawn, run, &skipped, &place);
            if found.0 > worst.0 {
                worst = found;
            }
        }
    }
    println!("{worst:?}");
    worst
}

#[test]
fn a_drawn_climb_does_not_jump() {
    // Runs of shots out of two thousand: near the ground, through the air, over its top, away.
    let all = climb(2000, planet("earth").medium.top_altitude_m);
    let top = all.iter().position(|h| *h >= 60.0 * KM).expect("the top is on the way");
    let runs: Vec<Vec<f64>> =
        [60, 300, 800, top - 40, top - 4, top + 4, top + 80, top + 200, 1900].map(|at| all[at..at + 7].to_vec()).to_vec();
    for sun_zenith in [40.0, 95.0] {
        let worst = drawn_jump(&runs, sun_zenith, false);
        assert!(worst.0 > 1e-4 && worst.0 < BAR, "{worst:?}");
    }
}

#[test]
#[ignore = "minutes: seven pictures of two thousand shots under three suns"]
fn a_drawn_climb_of_two_thousand_shots_does_not_jump() {
    // Without those shots that lie close by another: over a step of some metres light changes by less than half floats hold, and what is even in it
    // cannot be told.
    let mut above: Vec<f64> = Vec::new();
    for h in climb(2250, planet("earth").medium.top_altitude_m).into_iter().filter(|h| *h >= 1.0) {
        if !matches!(above.as_slice(), [.., a, b] if h - b < 0.4 * (b - a)) {
            above.push(h);
        }
    }
    assert!(above.len() >= 2000, "{} shots", above.len());
    for sun_zenith in [40.0, 89.5, 95.0] {
        let everywhere = drawn_jump(std::slice::from_ref(&above), sun_zenith, true);
        let worst = drawn_jump(std::slice::from_ref(&above), sun_zenith, false);
        assert!(everywhere.0 < BAR && worst.0 < BAR, "{everywhere:?} {worst:?}");
    }
}

/// Lux of the sun in drawn transits, and the exposure at which half floats hold the sky of noon and of totality alike.
const LUX: f32 = 1e5;
/// See [`LUX`].
const EV: f32 = 3.0;

/// Chooses runs of shots, by where on their course shots are and where a transit's contacts are, outer and inner.
type Runs<'a> = &'a dyn Fn(&[f64], [f64; 2]) -> Vec<Vec<usize>>;

/// [`jump`] of a transit seen from the ground: all passes of a frame, by the places of the moon's shots. The ground, which is black, is not looked at but through its air.
fn drawn_transit(runs: Runs<'_>, shots: u32, ratio: f64, miss_m: f64) -> (f64, String) {
    let gpu = tests::gpu();
    let earth = planet("earth");
    let air = Air::from(earth.medium.clone());
    // The course of a sun straight ahead, turned aside with it: out of view.
    let (straight, aside) = ((polar(64.0, 0.0), earth.sun_rad), DQuat::from_rotation_z(60.0 * DEG));
    let sun = (aside * straight.0, straight.1);
    let mut renderer = Renderer::new(&gpu, RendererOptions { shaders: ShaderLibrary::checkout(), measure: false }).expect("it compiles");
    let image = OffscreenImage::new(&gpu, [SIDE; 2]);
    // Where f32 has the moon, across the sun's direction; closer shots than it tells apart say nothing of what is even.
    let mut course: Vec<(f64, Occluder)> = Vec::new();
    for shot in transit(&earth.medium, straight, EYE_M, ratio, miss_m, shots) {
        let moon = &shot.occluders[0];
        let centre_m = narrow3(aside * (moon.centre_m - DVec3::Z * (earth.medium.bottom_radius_m + EYE_M)));
        let at = centre_m.as_dvec3().dot(aside * DVec3::Y);
        if course.last().is_none_or(|(last, _)| at - last > 200.0) {
            course.push((at, Occluder { id: 9, centre_m, radius_m: narrow(moon.radius_m) }));
        }
    }
    let asides: Vec<f64> = course.iter().map(|c| c.0).collect();
    let at_sun = MOON_M / ratio;
    let mut worst = (0.0, String::new());
    for picture in [60.0, 8.0, 0.5, -3.0].map(|pitch_deg| Picture { pitch_deg }) {
        for run in runs(&asides, [MOON_M + at_sun, (MOON_M - at_sun).abs()]) {
            let mut drawn: Vec<Vec<f32>> = Vec::new();
            for shot in &run {
                let mut scene = picture.scene(&air, EYE_M, sun);
                scene.star.intensity_cd *= LUX * scene.star.centre_m.length_squared();
                scene.bodies[0].sun_illuminance_lx *= LUX;
                scene.bodies[0].occluders.push(course[*shot].1);
                scene.exposure = AutoOr::Ev100(EV);
                renderer.render(&gpu, &scene, Target::Image(&image), None).expect("it is drawn");
                drawn.push(renderer.read_hdr(&gpu).expect("it can be read").rgba.iter().map(|x| x / LUX).collect());
            }
            let at: Vec<f64> = run.iter().map(|shot| asides[*shot]).collect();
            let place = |i: usize, pixel: usize| {
                format!("pitch {}°, moon {:.1} km → {:.1} km aside, pixel {pixel}", picture.pitch_deg, at[i - 1] / KM, at[i] / KM)
            };
            let found = jump(&drawn, &at, &|_, _| false, &place);
            if found.0 > worst.0 {
                worst = found;
            }
        }
    }
    println!("ratio {ratio}, missed by {miss_m} m: {worst:?}");
    worst
}

/// Altitude of the eye under a drawn transit, m.
const EYE_M: f64 = 2.0;

#[test]
fn a_drawn_transit_does_not_jump() {
    // Runs of shots out of six hundred: at the four contacts, between them, and in the middle.
    let runs = |asides: &[f64], [outer, inner]: [f64; 2]| {
        let at = |y: f64| asides.partition_point(|a| *a < y);
        let run = |y: f64| (at(y).clamp(4, asides.len() - 4) - 4..).take(8).collect::<Vec<_>>();
        [-outer, -0.6 * outer, -inner, 0.0, inner, outer].map(run).to_vec()
    };
    let worst = drawn_transit(&runs, 600, sky_eclipse::RATIO, 0.0);
    assert!(worst.0 > 1e-5 && worst.0 < BAR, "{worst:?}");
}

#[test]
#[ignore = "minutes: four pictures of transits of six hundred shots"]
fn drawn_transits_of_six_hundred_shots_do_not_jump() {
    let whole = |asides: &[f64], _: [f64; 2]| vec![(0..asides.len()).collect::<Vec<_>>()];
    for (ratio, miss_m) in [(sky_eclipse::RATIO, 0.0), (sky_eclipse::RATIO, 50e3), (0.95, 0.0)] {
        let worst = drawn_transit(&whole, 600, ratio, miss_m);
        assert!(worst.0 < BAR, "{worst:?}");
    }
}
