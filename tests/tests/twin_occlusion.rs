//! Twin: `shaders/lib/occlusion.wgsl` against `engine::light::occlusion`, on thousands of discs, contacts included.

use engine::light::occlusion::{visible_above_limb, visible_behind_disc};

const SUN: f64 = 0.004_65;

/// Asks the shader: `(kind, sun, a, b)` gives `visible_behind_disc(sun, a, b)` for kind 0, `visible_above_limb(sun, a)` for 1,
/// `visible_between(sun, a, b)` for 2.
const SHADER: &str = "
@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>>;
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&given) { return; }
    let q = given[id.x];
    var answer = visible_behind_disc(q.y, q.z, q.w);
    if q.x > 0.5 { answer = visible_above_limb(q.y, q.z); }
    if q.x > 1.5 { answer = visible_between(q.y, q.z, q.w); }
    if q.x > 2.5 {
        // A sphere at distance 1 whose radius is sin z, its centre w from the sun.
        let limb = limb_of_sphere(vec3<f32>(0.0, 0.0, 1.0), 1.0e8 * vec3<f32>(sin(q.w), 0.0, cos(q.w)), 1.0e8 * sin(q.z));
        answer = visible_behind_limb(q.y, limb.x, limb.y);
    }
    found[id.x] = vec4<f32>(answer);
}";

fn ask(questions: &[[f32; 4]]) -> Vec<f32> {
    tests::ask_shader("lib/occlusion.wgsl", SHADER, "ask", questions).into_iter().map(|v| v[0]).collect()
}

#[test]
fn discs_behind_discs() {
    let mut questions = Vec::new();
    for ratio in [0.1, 0.5, 0.9, 0.99, 1.0, 1.01, 1.05, 1.5, 4.0, 40.0, 150.0, 250.0] {
        let rho = ratio * SUN;
        for k in 0..400 {
            let s = (rho + SUN) * 1.02 * f64::from(k) / 399.0;
            questions.push([0.0, SUN as f32, rho as f32, s as f32]);
        }
        for s in [rho + SUN, (rho - SUN).abs(), rho] {
            for nudge in [-1e-6, -1e-8, 0.0, 1e-8, 1e-6] {
                questions.push([0.0, SUN as f32, rho as f32, (s + nudge).max(0.0) as f32]);
            }
        }
    }
    let mut worst = 0.0_f64;
    for (q, found) in questions.iter().zip(ask(&questions)) {
        let truth = visible_behind_disc(q[1].into(), q[2].into(), q[3].into());
        assert!((0.0..=1.0).contains(&found), "{q:?}: {found}");
        // A sun's radius at separation s is known in f32 to s · 6e-8.
        let known = 1e-5 + f64::from(q[3]) * 1e-7 / SUN;
        let error = (f64::from(found) - truth).abs() / known;
        worst = worst.max(error);
        assert!(error < 1.0, "{q:?}: {found}, truth {truth}");
    }
    println!("worst error: {worst:.3} of what f32 knows, over {} discs", questions.len());
}

#[test]
fn ends_are_exact() {
    let sun = SUN as f32;
    let inner = 0.5 * sun;
    let found = ask(&[
        [0.0, sun, sun, 0.0],              // covered to the rim
        [0.0, sun, 1.04 * sun, 0.0],       // total, centred
        [0.0, sun, 1.04 * sun, 3.0 * sun], // apart
        [1.0, sun, sun, 0.0],              // on a limb
        [1.0, sun, -sun, 0.0],
        [0.0, sun, 1e-12, 0.0], // next to nothing before it
    ]);
    assert_eq!(found, [0.0, 0.0, 1.0, 1.0, 0.0, 1.0]);
    let ring = ask(&[[0.0, sun, inner, 0.0]])[0];
    assert!((ring - 0.75).abs() < 1e-5, "annular, centred: {ring}");
}

#[test]
fn limbs_and_their_means() {
    let mut questions = Vec::new();
    for i in -120..=120 {
        let e = f64::from(i) / 100.0 * SUN;
        questions.push([1.0, SUN as f32, e as f32, 0.0]);
        for width in [0.001, 0.1, 1.0, 5.0, 300.0] {
            questions.push([2.0, SUN as f32, e as f32, (e + width * SUN) as f32]);
        }
    }
    for (q, found) in questions.iter().zip(ask(&questions)) {
        let (sun, a, b) = (f64::from(q[1]), f64::from(q[2]), f64::from(q[3]));
        let truth = if q[0] < 1.5 {
            visible_above_limb(sun, a)
        } else {
            let n = 4000;
            (0..n).map(|k| visible_above_limb(sun, a + (b - a) * (f64::from(k) + 0.5) / f64::from(n))).sum::<f64>() / f64::from(n)
        };
        assert!((f64::from(found) - truth).abs() < 1e-4, "{q:?}: {found}, truth {truth}");
    }
}

#[test]
fn spheres_great_and_small() {
    // From a moon's disc to a planet that fills half the sky: the limb is found without an angle near a right one.
    let mut questions = Vec::new();
    for rho in [0.0047, 0.05, 0.0999, 0.1001, 0.5, 1.2, 1.5, 1.56] {
        for k in -20..=20 {
            questions.push([3.0, SUN as f32, rho as f32, (rho + f64::from(k) / 18.0 * SUN).abs() as f32]);
        }
    }
    for (q, found) in questions.iter().zip(ask(&questions)) {
        let truth = visible_behind_disc(q[1].into(), q[2].into(), q[3].into());
        // The sine of ρ in f32 leaves ρ itself this uncertain.
        let known = 1e-4 + 1e-7 / (f64::from(q[2].cos()) * SUN);
        assert!((f64::from(found) - truth).abs() < known, "{q:?}: {found}, truth {truth}");
    }
}
