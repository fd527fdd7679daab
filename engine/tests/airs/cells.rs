//! What pixels of an air hold that are drawn from cells, on a limb, and in a medium of sharp edges: pictures against those that were forced, finer ones and single rays.

use super::*;
use engine::render::pass::sky::STEPS;
use engine::render::pass::sky::physical::AGREE;
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, Prober};

#[test]
fn from_space_too_a_march_at_half_rate_is_within_its_bound() {
    let mut stage = Stage::new();
    for (name, distance_m, aside) in [("limb", 6.8e6, 0.9), ("disc", 2.5e7, 0.1), ("small disc", 1.5e8, 0.0_f64)] {
        let planet = body(1, DVec3::new(aside, 0.0, -(1.0 - aside * aside).sqrt()) * distance_m, 6.4e6, Surface::Smooth, earthly(6.4e6));
        let mut scene = scene(vec![planet]);
        let plain = stage.take(&scene);
        scene.force.all = true;
        let forced = stage.take(&scene);
        let ms = [&plain, &forced].map(|t| t.report.pass("sky").and_then(|p| p.gpu_ms).unwrap_or_default());
        let errors = plain.hdr.iter().zip(&forced.hdr).map(|(a, b)| f64::from((a - b).abs() / b.max(20.0)));
        let (sum, worst) = errors.fold((0.0, 0.0_f64), |(sum, worst), e| (sum + e * e, worst.max(e)));
        let rms = (sum / plain.hdr.len() as f64).sqrt();
        println!("{name}: {rms:.1e} rms, {worst:.1e} at worst; {:.1} ms, forced {:.1} ms", ms[0], ms[1]);
        assert!(rms < 2e-3 && worst < 0.03, "{name}: {rms} rms, {worst} at worst");
        // Where no error is borne between rays, there are as many of them as in the forced frame.
        scene.force.all = false;
        stage.renderer.set_sky(STEPS, 0.0);
        let exact = stage.take(&scene).hdr;
        stage.renderer.set_sky(STEPS, 0.3);
        let coarse = stage.take(&scene).hdr;
        stage.renderer.set_sky(STEPS, AGREE);
        let far = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.max(20.0)).fold(0.0, f32::max);
        assert!(far(&exact, &forced.hdr) < 1e-3 && far(&coarse, &forced.hdr) >= far(&plain.hdr, &forced.hdr), "{name}");
    }
}

#[test]
fn pixels_of_a_limb_hold_the_mean_over_their_area() {
    const FINER: u32 = 10;
    let mut stages = [1, FINER].map(|n| Stage::of(SIZE.map(|px| n * px)));
    for distance_m in [7.2e6, 1.2e7, 2.4e7, 1.4e8] {
        let aside = DVec3::new(6.2e6_f64.min(0.4 * distance_m), 0.0, 0.0);
        let centre = aside - DVec3::Z * libm::sqrt(distance_m * distance_m - aside.length_squared());
        let black = Body { albedo: Vec3::ZERO, ..body(1, centre, 6.4e6, Surface::Smooth, earthly(6.4e6)) };
        let mut scene = scene(vec![black]);
        let [drawn, fine] = stages.each_mut().map(|stage| {
            scene.camera.size_px = stage.size;
            stage.take(&scene).hdr
        });
        let (finer, mut means) = (FINER as usize, vec![0.0; drawn.len()]);
        for (i, light) in fine.iter().enumerate() {
            let (pixel, wide) = (i / 4, finer * SIZE[0] as usize);
            let into = pixel / wide / finer * SIZE[0] as usize + pixel % wide / finer;
            means[4 * into + i % 4] += f64::from(*light) / f64::from(FINER * FINER);
        }
        let pairs = || drawn.iter().map(|d| f64::from(*d)).zip(&means).enumerate().filter(|(i, _)| i % 4 < 3).map(|(_, pair)| pair);
        let brightest = means.iter().fold(0.0_f64, |a, m| a.max(*m));
        let worst = pairs().map(|(d, mean)| (d - mean).abs() / brightest).fold(0.0, f64::max);
        let sum = pairs().map(|p| p.0).sum::<f64>() / pairs().map(|p| p.1).sum::<f64>() - 1.0;
        println!("{distance_m} m: worst {worst:.4} of the brightest, sum {sum:+.4}");
        // The last is a disc of six pixels, whose edges are not straight.
        assert!(worst < 0.08 && sum.abs() < if distance_m < 1e8 { 0.003 } else { 0.04 }, "{distance_m} m: {worst}, {sum}");
    }
}

/// Air with a cloud that begins and ends at once, 2 and 4 km above the datum.
fn clouded(radius_m: f64) -> Air {
    let mut medium = earthly(radius_m).medium;
    medium.layers.push(Layer {
        scattering_per_m: Vec3::splat(5e-4),
        absorption_per_m: Vec3::ZERO,
        profile: Profile::Constant { bottom_m: 2.0e3, top_m: 4.0e3 },
        phase: Phase::HenyeyGreenstein { g: 0.7 },
    });
    medium.into()
}

#[test]
fn a_cloud_of_sharp_edges_has_no_contour_lines() {
    // Pixel by pixel a frame that was forced is what a finer march says that ends its stretches at the edges; one that was not is the forced one, within its bound.
    const R: f64 = 6.4e6;
    let mut stage = Stage::new();
    let air = clouded(R);
    let prober = Prober::new(&stage.gpu, &ShaderLibrary::checkout(), &air).expect("its tables are made");
    for (name, centre) in [
        ("below", DVec3::NEG_Y * (R + 1.0e3)),
        ("above", DVec3::NEG_Y * (R + 9.0e3)),
        ("limb", DVec3::new(0.9, 0.0, -0.19_f64.sqrt()) * 6.8e6),
        ("disc", DVec3::new(0.1, 0.0, -0.99_f64.sqrt()) * 2.5e7),
    ] {
        let planet = Body { albedo: Vec3::ZERO, ..body(1, centre, R, Surface::Smooth, air.clone()) };
        let up = planet.camera_up.extend(planet.camera_altitude_m).to_array();
        let sun = planet.sun_direction.extend(planet.sun_angular_radius_rad).to_array();
        let mut scene = scene(vec![planet]);
        let plain = stage.take(&scene);
        scene.force.all = true;
        let forced = stage.take(&scene);
        let pixels: Vec<DVec3> = (0..SIZE[0] * SIZE[1]).map(|i| direction((i % SIZE[0]) as usize, (i / SIZE[0]) as usize)).collect();
        let rays: Vec<ProbeRay> = pixels.iter().map(|d| ProbeRay { up, ray: narrow3(*d).extend(0.0).to_array(), sun }).collect();
        let truth = prober.ask(&stage.gpu, &rays, &ProbeOptions { steps: 96, ..ProbeOptions::default() }).expect("it marches");
        // Where the edge of the ball or of its air crosses a pixel, it has a share of either side.
        let pixel = 2.0 * tan_half() / f64::from(SIZE[1]);
        let distance = centre.length();
        let beside_edge = |d: &DVec3| {
            let angle = libm::acos(d.dot(centre) / distance);
            [R, R + 6.0e4].into_iter().any(|r| distance >= r && (angle - libm::asin(r / distance)).abs() < 1.5 * pixel)
        };
        let errors = |hdr: &[f32], of: &dyn Fn(usize) -> f64| {
            let (mut sum, mut count, mut worst) = (0.0, 0, 0.0_f64);
            for (i, value) in hdr.iter().enumerate().filter(|(i, _)| i % 4 < 3 && !beside_edge(&pixels[i / 4])) {
                let e = (f64::from(*value) - of(i)) / of(i).max(20.0);
                (sum, count, worst) = (sum + e * e, count + 1, worst.max(e.abs()));
            }
            ((sum / f64::from(count)).sqrt(), worst)
        };
        let drawn = errors(&plain.hdr, &|i| f64::from(forced.hdr[i]));
        let marched = errors(&forced.hdr, &|i| f64::from(truth[i / 4].radiance[i % 4] * LUX));
        println!("{name}: drawn {:.1e} rms, {:.1e} at worst; marched {:.1e} rms, {:.1e} at worst", drawn.0, drawn.1, marched.0, marched.1);
        assert!(drawn.0 < 1.5e-3 && drawn.1 < 0.015, "{name}: {drawn:?}");
        // Twelve points on a stretch make that little of it; stretches that do not end at the edges, 2 to 5 % rms in rings.
        assert!((1e-4..3e-3).contains(&marched.0) && marched.1 < 0.05, "{name}: {marched:?}");
    }
}
