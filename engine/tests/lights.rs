//! What the air lights, as it is drawn: light that it bends into its planet's shadow, moonlight in it and below it, stars that it drowns; and
//! that relief cuts it where it stands.

use core::f32::consts::PI;
use engine::air::reference::{Options, Ray, optical_depth, radiance, span};
use engine::air::refraction::{Behind, Limb};
use engine::air::{Air, Layer, Medium, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, probe};
use engine::render::pass::stars::star;
use engine::render::{FrameReport, OffscreenImage, Renderer, RendererOptions, StarCatalogue, Target};
use engine::scene::{AutoOr, Body, Camera, Force, Occluder, SecondLight, Ship, Snapshot, Star, Surface};
use engine::space::relative::{narrow, narrow3};
use engine::units::{AU, DEG, KM};
use glam::{DVec3, Mat3, Quat, Vec3};

const SUN_M: f64 = 695_700.0 * KM;
const EARTH_M: f64 = 6371.0 * KM;
const MOON_M: f64 = 1737.4 * KM;
const SUN_CD: f32 = 2.86e27;

/// Earth's air in three wavelengths.
fn earth_air() -> Air {
    let layer = |scattering_per_m, absorption_per_m, profile, phase| Layer { scattering_per_m, absorption_per_m, profile, phase };
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    let ozone = Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 };
    Air::from(Medium {
        bottom_radius_m: EARTH_M,
        top_altitude_m: 100.0 * KM,
        ground_albedo: Vec3::splat(0.1),
        layers: vec![
            layer(Vec3::new(4.84e-6, 1.149e-5, 2.86e-5), Vec3::ZERO, exponential(8000.0), Phase::Rayleigh),
            layer(Vec3::splat(4e-6), Vec3::splat(4e-7), exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
            layer(Vec3::ZERO, Vec3::new(0.6497e-6, 1.881e-6, 0.085e-6), ozone, Phase::Rayleigh),
        ],
    })
}

/// A sphere, its place and the star's and the camera's given in one frame, m.
fn body(id: u16, at: DVec3, radius_m: f64, star: DVec3, eye: DVec3) -> Body {
    let (to_star, out) = (star - at, eye - at);
    let d = to_star.length();
    Body {
        id,
        centre_m: narrow3(at - eye),
        radius_m: narrow(radius_m),
        icrf_from_fixed: Quat::IDENTITY,
        camera_altitude_m: narrow(out.length() - radius_m),
        camera_up: narrow3(out.normalize_or(DVec3::Z)),
        sun_direction: narrow3(to_star / d),
        sun_angular_radius_rad: narrow(SUN_M / d),
        sun_illuminance_lx: Vec3::splat(SUN_CD * narrow(1.0 / (d * d))),
        occluders: Vec::new(),
        albedo: Vec3::splat(0.12),
        surface: Surface::Smooth,
        air: None,
    }
}

/// A camera at `eye` that looks along `forward`.
fn scene(size_px: [u32; 2], star: DVec3, eye: DVec3, forward: DVec3, fov_deg: f64, bodies: Vec<Body>) -> Snapshot {
    let f = narrow3(forward.normalize_or(DVec3::X));
    let right = f.cross(Vec3::Z).normalize_or(Vec3::Y);
    Snapshot {
        camera: Camera {
            view_from_icrf: Quat::from_mat3(&Mat3::from_cols(right, right.cross(f), -f)).conjugate(),
            fov_y_rad: narrow(fov_deg * DEG),
            near_m: 0.1,
            size_px,
        },
        star: Star { id: 0, centre_m: narrow3(star - eye), radius_m: narrow(SUN_M), intensity_cd: Vec3::splat(SUN_CD) },
        bodies,
        ships: Vec::new(),
        exposure: AutoOr::Ev100(0.0),
        adapt_s: None,
        force: Force::default(),
    }
}

/// A moon in the Earth's shadow, `aside_m` from its axis, seen from the side of the Earth.
fn eclipsed(size_px: [u32; 2], aside_m: f64) -> (Snapshot, DVec3) {
    let (star, moon) = (DVec3::X * AU, DVec3::new(-3.844e8, aside_m, 0.0));
    let eye = moon + DVec3::new(2.0e7, 0.0, 0.0);
    let mut bodies = [body(2, moon, MOON_M, star, eye), body(1, DVec3::ZERO, EARTH_M, star, eye)];
    bodies[1].air = Some(earth_air());
    bodies[0].occluders = vec![Occluder { id: 1, centre_m: narrow3(-eye), radius_m: narrow(EARTH_M) }];
    (scene(size_px, star, eye, DVec3::NEG_X, 14.0, bodies.to_vec()), moon + DVec3::X * MOON_M)
}

struct Stage {
    gpu: Gpu,
    renderer: Renderer,
    image: OffscreenImage,
}

impl Stage {
    fn new(size_px: [u32; 2]) -> Self {
        let gpu = Gpu::headless(BackendChoice::Auto).unwrap_or_else(|e| panic!("these tests draw: {e}"));
        let options = RendererOptions { shaders: ShaderLibrary::checkout(), ..RendererOptions::default() };
        let renderer = Renderer::new(&gpu, options).unwrap_or_else(|e| panic!("{e}"));
        let image = OffscreenImage::new(&gpu, size_px);
        Self { gpu, renderer, image }
    }

    fn draw(&mut self, scene: &Snapshot) -> (Vec<[f32; 3]>, FrameReport) {
        let report = self.renderer.render(&self.gpu, scene, Target::Image(&self.image), None).unwrap_or_else(|e| panic!("{e}"));
        let hdr = self.renderer.read_hdr(&self.gpu).unwrap_or_else(|e| panic!("{e}")).rgba;
        assert!(hdr.iter().all(|v| v.is_finite()));
        (hdr.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect(), report)
    }
}

fn reason<'a>(report: &'a FrameReport, pass: &str) -> (bool, &'a str) {
    report.pass(pass).map_or((false, "the report does not have it"), |p| (p.ran, p.reason.as_str()))
}

#[test]
fn an_eclipsed_moon_is_lit_through_the_planet_s_air() {
    let mut stage = Stage::new([33, 33]);
    let limb = Limb::new(&earth_air()).expect("it has layers");
    let mut worst = 0.0_f64;
    for aside_m in [0.0, 1.5e6, 3.0e6, 4.2e6, 4.6e6, 5.0e6, 7.0e6] {
        let (scene, point) = eclipsed([33, 33], aside_m);
        let (pixels, report) = stage.draw(&scene);
        assert!(aside_m > 0.0 || reason(&report, "refracted").0, "{:?}", reason(&report, "refracted"));
        let to_earth = -point;
        let separation_rad = (DVec3::X * AU - point).angle_between(to_earth);
        let behind = Behind { star_distance_m: AU, star_radius_m: SUN_M, distance_m: to_earth.length() };
        let expected = limb.light(&behind, separation_rad) * f64::from(0.12 / PI * scene.bodies[0].sun_illuminance_lx.x);
        let found = DVec3::from_array(pixels[16 * 33 + 16].map(f64::from));
        println!("{:.0} km aside: {:.3?} cd/m², expected {:.3?}", aside_m / KM, found.to_array(), expected.to_array());
        worst = worst.max(((found - expected).abs() / (expected + 5e-3)).max_element());
    }
    println!("worst: {worst:.4}");
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn only_shadows_of_airs_that_reach_something_are_kept() {
    let mut stage = Stage::new([33, 33]);
    let (mut scene, _) = eclipsed([33, 33], 0.0);
    assert!(reason(&stage.draw(&scene).1, "refracted").0);
    let (first, report) = stage.draw(&scene);
    assert!(reason(&report, "refracted").1.contains("as they were"), "{:?}", reason(&report, "refracted"));
    scene.force.all = true;
    assert!(stage.draw(&scene).0 == first, "a forced frame is another");
    scene.force.all = false;
    // Without its air the planet's shadow is black, and no table is asked.
    let earth = scene.bodies.remove(1);
    let (dark, report) = stage.draw(&scene);
    assert!(!reason(&report, "refracted").0 && reason(&report, "refracted").1.contains("no shadow"), "{:?}", reason(&report, "refracted"));
    assert!(dark[16 * 33 + 16] == [0.0; 3] && first[16 * 33 + 16][0] > 0.1, "{:?}", dark[16 * 33 + 16]);
    // The same where it stands aside.
    scene.bodies.push(earth);
    scene.bodies[0].occluders.clear();
    assert!(!reason(&stage.draw(&scene).1, "refracted").0);
}

#[test]
fn a_ship_behind_its_planet_glows_red_before_it_is_dark() {
    let mut stage = Stage::new([48, 48]);
    let star = DVec3::X * AU;
    let mut last = f32::INFINITY;
    for (degrees, least) in [(100.0, 1e2), (110.3, 1e-1), (111.0, 1e-2), (118.0, 0.0)] {
        let (s, c) = libm::sincos(degrees * DEG);
        let ship = DVec3::new(c, s, 0.0) * (EARTH_M + 400.0 * KM);
        let eye = ship + DVec3::X * 40.0;
        let mut earth = body(1, DVec3::ZERO, EARTH_M, star, eye);
        earth.air = Some(earth_air());
        let mut scene = scene([48, 48], star, eye, DVec3::NEG_X, 40.0, vec![earth]);
        scene.ships.push(Ship {
            centre_m: narrow3(ship - eye),
            icrf_from_hull: Quat::from_rotation_y(PI * 0.5),
            throttle: 0.0,
            gear: 0.0,
            heat: 0.0,
            host: Some(0),
            height_above_ground_m: 4e5,
            hidden: false,
        });
        let (pixels, _) = stage.draw(&scene);
        let brightest = pixels.iter().copied().fold([0.0_f32; 3], |a, b| if b[0] > a[0] { b } else { a });
        println!("{degrees}°: {brightest:?} cd/m²");
        assert!(brightest[0] >= least && brightest[0] < last, "{degrees}: {brightest:?}");
        assert!(!(110.0..112.0).contains(&degrees) || brightest[0] > 1.5 * brightest[2], "{degrees}: {brightest:?}");
        last = brightest[0];
    }
}

#[test]
fn moonlight_in_the_air_is_daylight_of_another_sun() {
    let gpu = Gpu::headless(BackendChoice::Auto).unwrap_or_else(|e| panic!("{e}"));
    let air = earth_air();
    let moon = Vec3::new(0.5, 0.3, 0.8).normalize_or(Vec3::Z);
    let below = Vec3::new(0.3, 0.0, -0.95).normalize_or(Vec3::NEG_Z);
    let ray = |elevation: f32, azimuth: f32, sun: Vec3, rad: f32| ProbeRay {
        up: [0.0, 0.0, 1.0, 100.0],
        ray: [elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin(), 0.0],
        sun: [sun.x, sun.y, sun.z, rad],
    };
    let sights: Vec<(f32, f32)> = (0..60).map(|i| (0.05 + 0.025 * i as f32, 0.7 * i as f32)).collect();
    let rays = |sun, rad| sights.iter().map(|(e, a)| ray(*e, *a, sun, rad)).collect::<Vec<_>>();
    let shaders = ShaderLibrary::checkout();
    let ask = |rays: &[ProbeRay], options: &ProbeOptions| probe(&gpu, &shaders, &air, rays, options).unwrap_or_else(|e| panic!("{e}"));
    let alone = ask(&rays(moon, 0.0045), &ProbeOptions::default());
    let second = SecondLight { from: 1, direction: moon, angular_radius_rad: 0.0045, illuminance_lx: Vec3::ONE, share: 1.0 };
    let lit = ask(&rays(below, 0.0046), &ProbeOptions { second: Some(second), ..ProbeOptions::default() });
    let night = ask(&rays(below, 0.0046), &ProbeOptions::default());
    let mut worst = 0.0_f32;
    for ((a, b), n) in alone.iter().zip(&lit).zip(&night) {
        for c in 0..3 {
            assert!(a.radiance[c] > 1e-4, "{a:?}");
            worst = worst.max(((b.radiance[c] - n.radiance[c]) / a.radiance[c] - 1.0).abs());
        }
    }
    println!("worst: {worst:.2e}");
    assert!(worst < 1e-4, "{worst}");
}

#[test]
fn a_full_moon_lights_the_night_and_no_day() {
    let mut stage = Stage::new([48, 32]);
    let star = DVec3::X * AU;
    // On the ground, the sun so far below the horizon, a moon 40° above it on the other side.
    let at = |depression_deg: f64, moon: bool| {
        let (s, c) = libm::sincos(depression_deg * DEG);
        let up = DVec3::new(-s, 0.0, c);
        let eye = up * (EARTH_M + 2.0);
        let (side, high) = libm::sincos(50.0 * DEG);
        let level = DVec3::new(-c, 0.0, -s);
        let mut earth = body(1, DVec3::ZERO, EARTH_M, star, eye);
        earth.air = Some(earth_air());
        let mut bodies = vec![earth];
        if moon {
            bodies.push(body(2, (up * high + level * side) * 3.844e8, MOON_M, star, eye));
        }
        let mut scene = scene([48, 32], star, eye, DVec3::Y + up * 0.2, 60.0, bodies);
        scene.exposure = AutoOr::Ev100(narrow(12.0 - 2.0 * depression_deg.clamp(0.0, 8.0)));
        scene
    };
    for (depression, runs) in [(-30.0, false), (1.0, false), (7.0, true), (25.0, true)] {
        let (dark, _) = stage.draw(&at(depression, false));
        let (lit, report) = stage.draw(&at(depression, true));
        println!("{depression}°: sky {:?} → {:?} cd/m², {:?}", dark[5 * 48 + 24], lit[5 * 48 + 24], reason(&report, "second_light"));
        assert!(reason(&report, "second_light").0 == runs);
        if runs {
            // Sky and ground.
            assert!(lit[5 * 48 + 24][2] > dark[5 * 48 + 24][2] && lit[30 * 48 + 24][1] > dark[30 * 48 + 24][1]);
        } else {
            assert!(lit == dark, "moonlight at {depression}°");
            let mut scene = at(depression, true);
            scene.force.all = true;
            let mut without = at(depression, false);
            without.force.all = true;
            let (a, b) = (stage.draw(&scene).0, stage.draw(&without).0);
            assert!(a == b, "forced moonlight at {depression}°");
        }
        if depression > 20.0 {
            // Under a full moon: a sky of some 1e-3 cd/m², a ground under a few tenths of a lux.
            let (sky, ground) = (lit[5 * 48 + 24][1], lit[30 * 48 + 24][1]);
            assert!((2e-4..5e-3).contains(&sky) && (1e-3..2e-2).contains(&ground), "{sky}, {ground}");
        }
    }
}

/// Light of the air between an eye and a surface, by the reference: that of the whole ray less that from the surface on.
fn air_before(medium: &Medium, eye: DVec3, direction: DVec3, surface_m: f64, sun: DVec3) -> DVec3 {
    let ray = |from_m| Ray { from_m, direction, sun, sun_rad: SUN_M / AU, occluders: Vec::new() };
    let options = Options { rel_error: 3e-3, max_walks: 1 << 16, ..Options::default() };
    let found = radiance(medium, &[ray(eye), ray(eye + direction * surface_m)], &options);
    let near = span(medium, eye, direction).map_or(0.0, |s| s.near_m);
    let depth = optical_depth(medium, eye, direction, (near, surface_m), 1e-6);
    found[0].total - found[1].total * DVec3::new(libm::exp(-depth.x), libm::exp(-depth.y), libm::exp(-depth.z))
}

#[test]
fn relief_cuts_the_air_where_it_stands() {
    let mut stage = Stage::new([65, 65]);
    let air = earth_air();
    let star = DVec3::new(0.6, -0.5, 0.6).normalize_or(DVec3::X) * AU;
    // A black mountain: a ball upon the datum. From within the air, from where a pixel is finer than the air, and from where it is not.
    for (eye, foot_deg, ball_m, fov_deg) in
        [(DVec3::Z * (EARTH_M + 2.0e3), 0.45, 6.0e3, 10.0), (DVec3::Z * 2.0e7, 71.0, 6.0e4, 0.5), (DVec3::Z * 2.0e7, 71.43, 6.0e4, 1.2)]
    {
        let (s, c) = libm::sincos(foot_deg * DEG);
        let ball = DVec3::new(s, 0.0, c) * EARTH_M;
        let mut earth = body(1, DVec3::ZERO, EARTH_M, star, eye);
        earth.air = Some(air.clone());
        let mut mountain = body(9, ball, ball_m, star, eye);
        mountain.albedo = Vec3::ZERO;
        // Looking over its flank, well above the datum.
        let forward = (ball + ball.normalize_or(DVec3::Z) * (0.5 * ball_m) - eye).normalize_or(DVec3::X);
        let mut scene = scene([65, 65], star, eye, forward, fov_deg, vec![mountain, earth]);
        scene.exposure = AutoOr::Ev100(12.0);
        scene.force.all = true;
        let (pixels, _) = stage.draw(&scene);
        let found = DVec3::from_array(pixels[32 * 65 + 32].map(f64::from)) / f64::from(scene.bodies[1].sun_illuminance_lx.x);
        // The near side of the ball along the ray.
        let along = (ball - eye).dot(forward);
        let miss = (ball - eye - forward * along).length();
        let surface_m = along - (ball_m * ball_m - miss * miss).sqrt();
        let altitude = (eye + forward * surface_m).length() - EARTH_M;
        let expected = air_before(&air.medium, eye, forward, surface_m, star.normalize_or(DVec3::X));
        let whole = air_before(&air.medium, eye, forward, 2.0 * eye.length(), star.normalize_or(DVec3::X));
        println!(
            "{:.0} km away, {altitude:.0} m up: {:.4?}, reference {:.4?}, without it {:.4?}",
            surface_m / KM,
            found.to_array(),
            expected.to_array(),
            whole.to_array()
        );
        assert!((whole - expected).max_element() > 0.05 * expected.max_element(), "the mountain hides nothing");
        let off = ((found - expected).abs() / expected).max_element();
        println!("off by {off:.4}");
        assert!(off < 0.03, "{off}");
    }
}

#[test]
fn stars_drown_in_the_day_and_the_brightest_return_in_totality() {
    let mut stage = Stage::new([160, 90]);
    let eye = DVec3::Z * (EARTH_M + 100.0);
    // Sirius, Venus, a star of the first magnitude and one of the fourth, a few degrees apart over the northern horizon.
    let stars: Vec<_> = [(-1.46, 0.0), (-4.2, 0.1), (1.0, 0.2), (4.0, 0.3)]
        .map(|(v, y): (f32, f32)| star(Vec3::new(1.0, y - 0.15, 0.45).normalize_or(Vec3::X), v, 0.3))
        .to_vec();
    let mut changed = |elevation_deg: f64, eclipse: bool| {
        let (s, c) = libm::sincos(elevation_deg * DEG);
        let star = DVec3::new(-c, 0.0, s) * AU;
        let mut earth = body(1, DVec3::ZERO, EARTH_M, star, eye);
        earth.air = Some(earth_air());
        if eclipse {
            let centre_m = narrow3(star.normalize_or(DVec3::X) * 3.6e8);
            earth.occluders = vec![Occluder { id: 2, centre_m, radius_m: narrow(1.04 * MOON_M) }];
        }
        let mut scene = scene([160, 90], star, eye, DVec3::new(1.0, 0.0, 0.45), 30.0, vec![earth]);
        scene.exposure = AutoOr::Auto { compensation_ev: 0.0 };
        let mut taken = |points: Vec<_>| {
            stage.renderer.set_stars(&stage.gpu, StarCatalogue { points });
            stage.draw(&scene);
            stage.image.read_rgba8(&stage.gpu).unwrap_or_else(|e| panic!("{e}"))
        };
        let without = taken(Vec::new());
        let by: Vec<u8> =
            stars.iter().map(|star| taken(vec![*star]).iter().zip(&without).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)).collect();
        println!("sun at {elevation_deg}°, eclipsed {eclipse}: bytes changed by Sirius, Venus, first and fourth magnitude: {by:?}");
        by
    };
    // By day nothing, but for a trace of Venus; in totality Venus and Sirius; by night all.
    for elevation in [50.0, 10.0] {
        let by = changed(elevation, false);
        assert!(by[0] <= 1 && by[1] <= 3 && by[2] <= 1 && by[3] == 0, "{by:?}");
    }
    let by = changed(30.0, true);
    assert!(by[1] > 30 && by[0] > 3 && by[3] <= 1, "{by:?}");
    let by = changed(-25.0, false);
    assert!(by.iter().all(|b| *b > 10), "{by:?}");
}

#[test]
fn the_sun_s_disc_is_reddened_darker_at_its_limb_and_cut_by_the_horizon() {
    let mut stage = Stage::new([96, 96]);
    let air = earth_air();
    let eye = DVec3::Z * (EARTH_M + 2.0);
    let mut taken = |elevation_deg: f64| {
        let (s, c) = libm::sincos(elevation_deg * DEG);
        let star = DVec3::new(c, 0.0, s) * AU;
        let mut earth = body(1, DVec3::ZERO, EARTH_M, star, eye);
        earth.air = Some(air.clone());
        let mut scene = scene([96, 96], star, eye, DVec3::new(c, 0.0, s), 0.8, vec![earth]);
        scene.exposure = AutoOr::Ev100(20.0);
        stage.draw(&scene).0
    };
    let at = |pixels: &[[f32; 3]], x: usize, y: usize| DVec3::from_array(pixels[y * 96 + x].map(f64::from));
    let mean = f64::from(SUN_CD) / core::f64::consts::PI / (SUN_M * SUN_M);
    for elevation in [4.0, 0.6] {
        let pixels = taken(elevation);
        let forward = DVec3::new(libm::cos(elevation * DEG), 0.0, libm::sin(elevation * DEG));
        let far = span(&air.medium, eye, forward).map_or(0.0, |s| s.far_m);
        let depth = optical_depth(&air.medium, eye, forward, (0.0, far), 1e-6);
        let through = DVec3::new(libm::exp(-depth.x), libm::exp(-depth.y), libm::exp(-depth.z));
        // I(1) over the mean of the disc is 1 / (1 − u/3) [Allen's Astrophysical Quantities, table 14.17].
        let centre = through * mean / (DVec3::ONE - DVec3::new(0.52, 0.60, 0.72) / 3.0);
        let (found, limb) = (at(&pixels, 48, 48), at(&pixels, 48 - 28, 48));
        println!("{elevation}°: {:.3?}, expected {:.3?}; limb {:.3?}", found.to_array(), centre.to_array(), limb.to_array());
        // Blue is mostly the sky's own light by then.
        let off = ((found - centre).abs() / centre).max_element();
        assert!(off < 0.03, "{off}");
        // 0.94 of the radius from the centre: μ = 0.34.
        let darker = limb / found;
        assert!(darker.x > darker.y && darker.y > darker.z && (0.55..0.75).contains(&darker.x), "{darker}");
        assert!(found.x > found.y && found.y > found.z);
    }
    // The centre on the horizon: above it the disc, below it the ground.
    let pixels = taken(-0.045);
    let (above, below) = (at(&pixels, 48, 40), at(&pixels, 48, 56));
    println!("on the horizon: {above:.3?} above, {below:.3?} below");
    assert!(above.x > 1e3 * below.x && above.x > 1e6);
}
