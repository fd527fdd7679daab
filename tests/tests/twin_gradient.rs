//! Twin: `shaders/lib/gradient.wgsl` against `engine::air::model::gradient`, on thousands of rays from 1 m to 60,000 km, with and without
//! something drawn in the air, through the painter and the pipeline layout of the frame.

use core::f64::consts::PI;
use engine::air::model::gradient::{Light, Sight};
use engine::air::model::{ColourMap, Gradient};
use engine::air::{Air, Medium, Model};
use engine::gpu::ShaderLibrary;
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, probe};
use engine::space::relative::narrow;
use glam::{DVec3, Vec3};

const R: f64 = 6.371e6;
const TOP: f64 = 1.0e5;

/// Numbers from 0 to 1 without pattern [Knuth 1997, TAOCP 2, table 3.3.4-1, line 26].
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}
fn direction(state: &mut u64) -> DVec3 {
    let z = 2.0 * random(state) - 1.0;
    let angle = core::f64::consts::TAU * random(state);
    let across = (1.0 - z * z).sqrt();
    DVec3::new(across * libm::cos(angle), across * libm::sin(angle), z)
}

/// Rays that meet the air, none of them within 100 m of grazing the ground: there a digit decides what it meets.
fn sights(state: &mut u64, count: usize) -> Vec<(f64, Sight)> {
    let mut sights = Vec::new();
    while sights.len() < count {
        let up = direction(state);
        let altitude = libm::exp(random(state) * libm::log(6.0e7));
        let aim = direction(state) * (R + TOP * (2.0 * random(state) - 1.0)) - up * (R + altitude);
        let ray = if altitude > TOP || random(state) < 0.3 { aim.normalize() } else { direction(state) };
        let surface_m = (sights.len() % 3 == 0).then(|| libm::exp(random(state) * libm::log(3.0e7)));
        let sight = Sight { eye: up * (R + altitude), ray, sun: direction(state), bottom_m: R, top_m: TOP, surface_m };
        let miss = sight.eye.cross(ray).length() - R;
        if miss.abs() > 100.0 && (miss - TOP).abs() > 100.0 {
            sights.push((altitude, sight));
        }
    }
    sights
}

/// A gradient whose maps change from texel to texel, every setting away from its default.
fn painted() -> Gradient {
    let mut state = 3;
    let mut map = |w: u32, h: u32| ColourMap { size: [w, h], rgba: (0..4 * w * h).map(|_| (random(&mut state) * 256.0) as u8).collect() };
    let (shell_map, ground_map) = (map(9, 5), map(32, 2));
    let some = Gradient { stretch: 0.4, fade_stretch: 0.3, visibility_m: 2.0e4, transparency: 0.6, ..Gradient::default() };
    Gradient { brightness: 0.8, opacity: 0.7, shell_map, ground_map, ..some }
}

fn differs(found: Light, truth: Option<Light>) -> f64 {
    let truth = truth.unwrap_or(Light { radiance: DVec3::ZERO, transmittance: DVec3::ONE });
    (found.radiance * PI - truth.radiance * PI).abs().max_element().max((found.transmittance - truth.transmittance).abs().max_element())
}

fn vec4(v: DVec3, w: f64) -> [f32; 4] {
    [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)]
}

fn light(radiance: [f32; 4], transmittance: [f32; 4]) -> Light {
    let three = |v: [f32; 4]| DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2]));
    Light { radiance: three(radiance), transmittance: three(transmittance) }
}

#[test]
fn light_is_the_same_on_thousands_of_rays() {
    let mut state = 11;
    let gpu = tests::gpu();
    for model in [Gradient::default(), painted()] {
        let sights = sights(&mut state, 4000);
        let rays: Vec<ProbeRay> = sights
            .iter()
            .map(|(altitude, s)| ProbeRay {
                up: vec4(s.eye.normalize(), *altitude),
                ray: vec4(s.ray, s.surface_m.unwrap_or(0.0)),
                sun: vec4(s.sun, 0.004_65),
            })
            .collect();
        let medium = Medium { bottom_radius_m: R, top_altitude_m: TOP, ground_albedo: Vec3::ZERO, layers: Vec::new() };
        let air = Air { model: Model::Gradient(model.clone()), ..Air::from(medium) };
        let found = probe(&gpu, &ShaderLibrary::checkout(), &air, &rays, &ProbeOptions::default()).expect("it can be probed");
        assert_eq!(gpu.take_error(), None);
        let (mut worst, mut lit) = (0.0_f64, 0);
        for ((altitude, sight), found) in sights.iter().zip(found) {
            let found = light(found.radiance, found.transmittance);
            let off = differs(found, model.light(sight));
            worst = worst.max(off);
            // Half floats hold a texel to 5e-4.
            assert!(off < 1e-3, "{altitude} m up, {sight:?}: {found:?}, truth {:?}", model.light(sight));
            lit += i32::from(found.radiance.length() > 0.01);
        }
        println!("worst error {worst:.1e}; {lit} of {} rays are lit", sights.len());
        assert!(lit > 1000);
    }
}
