//! Twin: `shaders/lib/gradient.wgsl` against `engine::air::model::gradient`, on thousands of rays from 1 m to 60,000 km, with and without
//! something drawn in the air; and the same through the probe, as the frame's own pipeline has it.

use core::f64::consts::PI;
use engine::air::model::gradient::{Light, Sight};
use engine::air::model::{ColourMap, Gradient};
use engine::air::{Air, Medium, Model};
use engine::gpu::ShaderLibrary;
use engine::render::pass::sky::gradient::{settings, upload};
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, probe};
use engine::space::relative::narrow;
use glam::{DVec3, Vec3};
use wgpu::{BindGroupEntry, BindingResource};

const R: f64 = 6.371e6;
const TOP: f64 = 1.0e5;

const SHADER: &str = "
@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>>;
@group(0) @binding(2) var shell_map: texture_2d<f32>;
@group(0) @binding(3) var ground_map: texture_2d<f32>;
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    // Three rows of a question each; the last two rows of all are the settings.
    let q = id.x * 3u;
    let last = arrayLength(&given) - 2u;
    if q >= last { return; }
    var body: Body;
    var air: Air;
    var sky: Sky;
    body.up = given[q];
    body.sun = vec4<f32>(given[q + 2u].xyz, 0.00465);
    air.shape = vec4<f32>(6371000.0, 100000.0, 0.0, 0.0);
    sky.settings[0] = given[last];
    sky.settings[1] = given[last + 1u];
    let surface = given[q + 1u].w;
    let light = gradient_light(body, air, shell_map, ground_map, sky, SkyView(given[q + 1u].xyz, surface, surface >= 1e30, 0.0));
    found[q] = vec4<f32>(light.radiance, 0.0);
    found[q + 1u] = vec4<f32>(light.transmittance, 0.0);
}";

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
fn sights(state: &mut u64, count: usize, surfaces: bool) -> Vec<(f64, Sight)> {
    let mut sights = Vec::new();
    while sights.len() < count {
        let up = direction(state);
        let altitude = libm::exp(random(state) * libm::log(6.0e7));
        let aim = direction(state) * (R + TOP * (2.0 * random(state) - 1.0)) - up * (R + altitude);
        let ray = if altitude > TOP || random(state) < 0.3 { aim.normalize() } else { direction(state) };
        let surface_m = (surfaces && sights.len() % 3 == 0).then(|| libm::exp(random(state) * libm::log(3.0e7)));
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
    for model in [Gradient::default(), painted()] {
        let sights = sights(&mut state, 4000, true);
        let mut questions: Vec<[f32; 4]> = sights
            .iter()
            .flat_map(|(altitude, s)| {
                let up = s.eye.normalize();
                [vec4(up, *altitude), vec4(s.ray, s.surface_m.unwrap_or(1e30)), vec4(s.sun, 0.0)]
            })
            .collect();
        questions.extend(&settings(&model)[..2]);
        let gpu = tests::gpu();
        let views = [&model.shell_map, &model.ground_map].map(|m| upload(&gpu, m).view);
        let more: Vec<_> =
            (2..).zip(&views).map(|(binding, view)| BindGroupEntry { binding, resource: BindingResource::TextureView(view) }).collect();
        let found = tests::ask_shader_with(&gpu, "lib/gradient.wgsl", SHADER, "ask", &questions, &more);
        let (mut worst, mut lit) = (0.0_f64, 0);
        for ((altitude, sight), found) in sights.iter().zip(found.chunks_exact(3)) {
            let found = light(found[0], found[1]);
            let off = differs(found, model.light(sight));
            worst = worst.max(off);
            // Half floats hold a texel to 5e-4; a texel more or less to the side adds to that.
            assert!(off < 2.5e-3, "{altitude} m up, {sight:?}: {found:?}, truth {:?}", model.light(sight));
            lit += i32::from(found.radiance.length() > 0.01);
        }
        println!("worst error {worst:.1e}; {lit} of {} rays are lit", sights.len());
        assert!(lit > 1000);
    }
}

#[test]
fn the_frame_s_own_pipeline_gives_it_too() {
    let mut state = 5;
    let model = painted();
    let sights = sights(&mut state, 1000, false);
    let rays: Vec<ProbeRay> = sights
        .iter()
        .map(|(altitude, s)| ProbeRay { up: vec4(s.eye.normalize(), *altitude), ray: vec4(s.ray, 0.0), sun: vec4(s.sun, 0.004_65) })
        .collect();
    let medium = Medium { bottom_radius_m: R, top_altitude_m: TOP, ground_albedo: Vec3::ZERO, layers: Vec::new() };
    let air = Air { medium, bands: None, model: Model::Gradient(model.clone()) };
    let gpu = tests::gpu();
    let found = probe(&gpu, &ShaderLibrary::checkout(), &air, &rays, &ProbeOptions::default()).expect("it can be probed");
    assert_eq!(gpu.take_error(), None);
    for ((altitude, sight), found) in sights.iter().zip(found) {
        let off = differs(light(found.radiance, found.transmittance), model.light(sight));
        assert!(off < 2.5e-3, "{altitude} m up, {sight:?}: {found:?}, truth {:?}", model.light(sight));
    }
}
