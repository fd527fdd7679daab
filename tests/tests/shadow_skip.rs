//! Samples of other worlds' shadows are taken on rays that a shadow can reach alone: on all others every sample would have found the whole sun.

use glam::{DVec3, Vec3};
use tests::ask_shader;

const ASK: &str = r"
@group(0) @binding(0) var<storage, read> questions: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> answers: array<vec4<f32>>;

// Four rows each: the ray's start and length, its direction and how far scattered light comes, the occluder, the star. Of the answer the first row
// counts: 1 where shadows are sampled; the least of all samples, at the point and around it.
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    let at = 4u * id.x;
    if at >= arrayLength(&questions) {
        return;
    }
    let start = questions[at];
    let ray = questions[at + 1u];
    var body: Body;
    body.ids.y = 1;
    body.occluders[0] = questions[at + 2u];
    let star = questions[at + 3u];
    let shade = air_shade(body, star, start.xyz, ray.xyz, start.w, ray.w);
    let radii = ray.w * vec4<f32>(0.2, 0.4, 0.7, 1.0);
    var least = vec2<f32>(1.0);
    for (var i = 0u; i <= 200u; i++) {
        let here = start.xyz + ray.xyz * (start.w * f32(i) / 200.0);
        least.x = min(least.x, eclipse_visible(body, star, here));
        // Around it, across the shadow, where it is nearest.
        let axis = normalize(star.xyz - here);
        let first = normalize(cross(axis, vec3<f32>(axis.y, axis.z, -axis.x)));
        for (var k = 0u; k < 32u; k++) {
            let turn = f32(k) * 0.785398;
            let aside = first * cos(turn) + cross(axis, first) * sin(turn);
            least.y = min(least.y, eclipse_visible(body, star, here + aside * (ray.w * f32(1u + k / 8u) * 0.25)));
        }
    }
    answers[at] = vec4<f32>(f32(min(shade.count, 1u)), least, 0.0);
}
";

fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

fn direction(state: &mut u64) -> DVec3 {
    let z = 2.0 * random(state) - 1.0;
    let (s, c) = (core::f64::consts::TAU * random(state)).sin_cos();
    DVec3::new((1.0 - z * z).sqrt() * c, (1.0 - z * z).sqrt() * s, z)
}

#[allow(clippy::cast_possible_truncation)]
fn row(v: DVec3, w: f64) -> [f32; 4] {
    let v: Vec3 = v.as_vec3();
    [v.x, v.y, v.z, w as f32]
}

#[test]
fn rays_without_shadow_samples_see_the_whole_sun() {
    let mut state = 11;
    let mut questions = Vec::new();
    for _ in 0..20_000 {
        // A world of any size before a sun of any size, its shadow's axis within a few radii of the ray.
        let sun = direction(&mut state);
        let star_m = 10.0_f64.powf(10.0 + 2.0 * random(&mut state));
        let star_radius = star_m * 10.0_f64.powf(-3.5 + 2.0 * random(&mut state));
        let away = 10.0_f64.powf(7.0 + 2.0 * random(&mut state));
        let radius = away * 10.0_f64.powf(-3.5 + 3.0 * random(&mut state));
        let aside = direction(&mut state).cross(sun).normalize_or(DVec3::X);
        let wide = radius + away * (star_radius / star_m);
        let occluder = sun * away + aside * (wide * 3.0 * random(&mut state));
        let start = direction(&mut state) * 10.0_f64.powf(2.0 + 4.0 * random(&mut state));
        let length = 10.0_f64.powf(4.0 + 2.5 * random(&mut state));
        let depth = 10.0_f64.powf(3.0 + 3.0 * random(&mut state));
        questions.extend([row(start, length), row(direction(&mut state), depth), row(occluder, radius), row(sun * star_m, star_radius)]);
    }
    let answers = ask_shader("lib/air_march.wgsl", ASK, "ask", &questions);
    let (mut skipped, mut shaded) = (0, 0);
    for (answer, question) in answers.chunks_exact(4).map(|rows| rows[0]).zip(questions.chunks_exact(4)) {
        if answer[0] < 0.5 {
            skipped += 1;
            assert!(answer[1] == 1.0 && answer[2] == 1.0, "{answer:?} for {question:?}");
        } else if answer[1] < 1.0 {
            shaded += 1;
        }
    }
    println!("{skipped} rays skipped, {shaded} shaded");
    assert!(skipped > 2000 && shaded > 2000, "{skipped} skipped, {shaded} shaded");
}
