//! Twin: `shaders/lib/thickness.wgsl` against `engine::air::model::thickness`, on thousands of rays from 1 m to 60,000 km; and beside the
//! depth buffers that the paper takes its widths from: what those lose must not be lost here.
//!
//! Not here: the f64 formulas' own trials, which stand beside them.

use engine::air::model::shell::Chord;
use engine::air::model::thickness::{ShadowCone, ShadowShape, Widths};
use engine::space::relative::narrow;
use engine::units::AU;
use glam::DVec3;

const R: f64 = 6.371e6;
const TOP: f64 = 1.0e5;
const SUN: f64 = 6.957e8;
/// `vec4`s of a question.
const PARTS: usize = 6;

const SHADER: &str = "
@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>>;
@compute @workgroup_size(64)
fn ask(@builtin(global_invocation_id) id: vec3<u32>) {
    let q = id.x * 6u;
    if q >= arrayLength(&given) { return; }
    var body: Body;
    var air: Air;
    body.up = given[q];
    body.sun = given[q + 2u];
    body.occluders[0] = given[q + 4u];
    body.ids.y = i32(given[q + 5u].z);
    air.shape = vec4<f32>(given[q + 5u].xy, 0.0, 0.0);
    let surface = given[q + 1u].w;
    let view = SkyView(given[q + 1u].xyz, surface, surface >= 1e30, 0.0);
    let path = air_path(air, body.up.xyz, body.up.w, view.ray);
    let end = sky_end(air, path, view);
    var widths = vec2<f32>(0.0);
    if end > 0.0 { widths = thickness_widths(body, air, given[q + 3u], path, view.ray, end, given[q + 5u].w > 0.5); }
    found[q] = vec4<f32>(widths, path.start, end);
}";

/// What is asked: positions from the planet's centre, m.
#[derive(Clone, Copy)]
struct Question {
    up: DVec3,
    altitude: f64,
    ray: DVec3,
    surface: Option<f64>,
    sun: DVec3,
    moon: Option<(DVec3, f64)>,
    shape: ShadowShape,
}

impl Question {
    fn eye(&self) -> DVec3 {
        self.up * (R + self.altitude)
    }

    fn truth(&self) -> Widths {
        let Some(chord) = Chord::new(self.eye(), self.ray, R, TOP) else { return Widths::default() };
        let mut shadows = vec![ShadowCone::new(DVec3::ZERO, R, self.sun, SUN, self.shape)];
        shadows.extend(self.moon.map(|(centre, radius)| ShadowCone::new(centre, radius, self.sun, SUN, self.shape)));
        Widths::between(self.eye(), self.ray, chord.start_m, chord.end_m(self.surface), &shadows)
    }

    /// By how much the widths change with the last digits of what is asked, m.
    fn known(&self) -> f64 {
        let truth = self.truth();
        let mut most = 0.0_f64;
        let side = self.up.any_orthonormal_vector();
        for axis in [side, self.up, self.up.cross(side)] {
            for by in [-1.5e-7, 1.5e-7] {
                let near = |v: DVec3| (v + axis * by).normalize();
                let moved = [
                    Self { up: near(self.up), ..*self },
                    Self { ray: near(self.ray), ..*self },
                    Self { altitude: self.altitude * (1.0 + by), ..*self },
                    Self { sun: near(self.sun.normalize()) * self.sun.length(), ..*self },
                    Self { moon: self.moon.map(|(m, r)| (near(m.normalize()) * m.length(), r)), ..*self },
                ];
                for widths in moved.map(|m| m.truth()) {
                    most = most.max((widths.lit_m - truth.lit_m).abs()).max((widths.shadowed_m - truth.shadowed_m).abs());
                }
            }
        }
        4.0 * most + 1e-6 * (truth.lit_m + truth.shadowed_m) + 1.0
    }
}

/// As the shader finds them.
fn found(questions: &[Question]) -> Vec<Widths> {
    let vec4 = |v: DVec3, w: f64| [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)];
    let parts: Vec<[f32; 4]> = questions
        .iter()
        .flat_map(|q| {
            let (moon, radius) = q.moon.unwrap_or_default();
            [
                vec4(q.up, q.altitude),
                vec4(q.ray, q.surface.unwrap_or(1e30)),
                vec4(q.sun.normalize(), libm::asin(SUN / q.sun.length())),
                vec4(q.sun - q.eye(), SUN),
                vec4(moon - q.eye(), radius),
                [narrow(R), narrow(TOP), if q.moon.is_some() { 1.0 } else { 0.0 }, if q.shape == ShadowShape::Cone { 1.0 } else { 0.0 }],
            ]
        })
        .collect();
    let answers = tests::ask_shader("lib/thickness.wgsl", SHADER, "ask", &parts);
    answers.chunks(PARTS).map(|a| Widths { lit_m: f64::from(a[0][0]), shadowed_m: f64::from(a[0][1]) }).collect()
}

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

#[test]
fn widths_are_the_same_on_thousands_of_rays() {
    let mut state = 7;
    let mut questions = Vec::new();
    for i in 0..6000 {
        let up = direction(&mut state);
        let altitude = libm::exp(random(&mut state) * libm::log(6.0e7));
        // From above the air half of the rays are aimed at its shell; the terminator, where shadows end, is tried often.
        let aim = direction(&mut state) * (R + TOP * random(&mut state)) - up * (R + altitude);
        let ray = if altitude > TOP || i % 4 == 0 { aim.normalize() } else { direction(&mut state) };
        let side = up.any_orthonormal_vector();
        let low = 0.3 * (random(&mut state) - 0.5);
        let toward = if i % 3 == 0 { direction(&mut state) } else { (side + up * low).normalize() };
        let distance = [0.3, 1.0, 30.0][i % 3] * AU;
        let moon = (i % 2 == 0).then(|| {
            let by = direction(&mut state) * (R * 1.2 * random(&mut state));
            (toward * 3.7e8 + by, 1.7374e6)
        });
        let surface = (i % 5 == 0).then(|| libm::exp(random(&mut state) * libm::log(2.0e7)));
        let shape = if i % 7 == 0 { ShadowShape::Cylinder } else { ShadowShape::Cone };
        questions.push(Question { up, altitude, ray, surface, sun: toward * distance, moon, shape });
    }
    let (mut worst, mut both, mut errors) = (0.0_f64, 0, Vec::new());
    for (q, widths) in questions.iter().zip(found(&questions)) {
        let truth = q.truth();
        let error = (widths.lit_m - truth.lit_m).abs().max((widths.shadowed_m - truth.shadowed_m).abs());
        let share = error / q.known();
        assert!(share < 1.0, "{} m up, ray {}, sun {}: {widths:?}, truth {truth:?}", q.altitude, q.ray, q.sun.normalize());
        worst = worst.max(share);
        errors.push(error);
        both += i32::from(truth.lit_m > 1.0 && truth.shadowed_m > 1.0);
    }
    errors.sort_by(f64::total_cmp);
    let at = |share: f64| errors[(errors.len() as f64 * share) as usize];
    println!(
        "worst {worst:.2} of what f32 knows; errors: median {:.2} m, 99 % under {:.1} m; {both} rays cross a shadow's edge",
        at(0.5),
        at(0.99)
    );
    assert!(both > 600, "{both}");
    assert!(at(0.5) < 1.0 && at(0.99) < 200.0);
}

/// The paper's depth buffers along the view's axis: 24 bits, `z = a + b / distance`, linearised as it says, widths by its shader.
struct Buffers {
    near: f64,
    far: f64,
    /// Whether the shadow's front is moved to the near plane where that would cut it off (the paper's remedy).
    capped: bool,
}

impl Buffers {
    fn terms(&self) -> (f64, f64) {
        (self.far / (self.far - self.near), self.far * self.near / (self.near - self.far))
    }
    /// What a buffer holds for a surface at this distance: its clear value where the planes cut it off.
    fn stored(&self, distance: f64) -> f64 {
        if distance < self.near || distance > self.far {
            return 1.0;
        }
        let (a, b) = self.terms();
        let levels = f64::from((1 << 24) - 1);
        ((a + b / distance) * levels).round() / levels
    }
    fn linear(&self, stored: f64) -> f64 {
        let (a, b) = self.terms();
        b / (stored - a)
    }
    /// Widths from the distances of the air's front and back (or the ground) and of the shadow's.
    fn widths(&self, air: (f64, f64), shadow: Option<(f64, f64)>) -> Widths {
        let (front, back) = (self.stored(air.0), self.stored(air.1));
        let shadow = shadow.map(|(from, to)| if self.capped { (from.max(self.near), to) } else { (from, to) });
        let clip = |s: f64| s.max(front).min(back);
        let (from, to) = shadow.map_or((1.0, 1.0), |(from, to)| (self.stored(from), self.stored(to)));
        let [back_m, to_m, from_m, front_m] = [back, clip(to), clip(from), front].map(|s| self.linear(s));
        Widths { lit_m: back_m - to_m + from_m - front_m, shadowed_m: to_m - from_m }
    }
}

/// From an altitude `from_midnight_deg` away from the midnight point, looking `below_deg` under the horizontal.
fn night(altitude: f64, from_midnight_deg: f64, below_deg: f64) -> Question {
    let turn = |deg: f64, a: DVec3, b: DVec3| a * libm::cos(deg.to_radians()) + b * libm::sin(deg.to_radians());
    let up = turn(from_midnight_deg, DVec3::NEG_X, DVec3::Y);
    let level = turn(from_midnight_deg, DVec3::Y, DVec3::X);
    let ray = turn(below_deg, level, -up);
    Question { up, altitude, ray, surface: None, sun: DVec3::X * AU, moon: None, shape: ShadowShape::Cone }
}

fn buffered(q: &Question, buffers: &Buffers) -> Widths {
    let chord = Chord::new(q.eye(), q.ray, R, TOP).expect("these rays meet the air");
    let shadow = ShadowCone::new(DVec3::ZERO, R, q.sun, SUN, q.shape).along(q.eye(), q.ray);
    buffers.widths((chord.start_m.max(buffers.near), chord.end_m(None)), shadow)
}

#[test]
fn a_camera_within_the_shadow_loses_nothing_to_the_near_plane() {
    // 400 km over midnight and beyond: the shadow's front lies behind the camera, where the near plane has cut it off. Every ray's air
    // in shadow then counts as lit. The paper moves that front to the near plane; intersections need no remedy.
    let questions: Vec<Question> =
        (0..60).flat_map(|i| (0..4).map(move |k| night(4.0e5, f64::from(k) * 20.0, 17.5 + 0.06 * f64::from(i)))).collect();
    let (bare, remedied) = (Buffers { near: 100.0, far: 1.0e7, capped: false }, Buffers { near: 100.0, far: 1.0e7, capped: true });
    let mut worst = [0.0_f64; 3];
    for (q, ours) in questions.iter().zip(found(&questions)) {
        let truth = q.truth();
        assert!(truth.shadowed_m > 1.0e4, "{truth:?}");
        let off = |w: Widths| (w.shadowed_m - truth.shadowed_m).abs();
        assert!(buffered(q, &bare).shadowed_m <= 0.0, "the fault is gone from its own emulation");
        worst = [worst[0].max(off(buffered(q, &bare))), worst[1].max(off(buffered(q, &remedied))), worst[2].max(off(ours))];
    }
    let [bare, remedied, ours] = worst;
    println!("shadowed width, worst error: cut by the near plane {bare:.0} m, with the paper's remedy {remedied:.0} m, here {ours:.1} m");
    assert!(bare > 5.0e5 && ours < 0.01 * remedied && ours < 100.0);
}

#[test]
fn widths_have_no_steps_beside_a_tiny_near_plane() {
    // Just over the front of the air, near plane 1 m: at 1,000 km and more a 24-bit buffer knows distances to some 60 km. Rays sweep
    // from below the limb to above it; true widths change smoothly, and so do ours.
    let questions: Vec<Question> = (0..400).map(|i| night(1.001e5, 95.0, 6.0 + 0.01 * f64::from(i))).collect();
    let buffers = Buffers { near: 1.0, far: 1.0e7, capped: true };
    let ours = found(&questions);
    let all = |w: &Widths| w.lit_m + w.shadowed_m;
    let truths: Vec<f64> = questions.iter().map(|q| all(&q.truth())).collect();
    let his: Vec<f64> = questions.iter().map(|q| all(&buffered(q, &buffers))).collect();
    let ours: Vec<f64> = ours.iter().map(all).collect();
    // Errors, and steps between neighbouring rays beyond what the truth changes by.
    let worst = |found: &[f64]| {
        let off: Vec<f64> = found.iter().zip(&truths).map(|(a, b)| a - b).collect();
        let step = off.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        (off.into_iter().map(f64::abs).fold(0.0, f64::max), step)
    };
    let (his, ours) = (worst(&his), worst(&ours));
    println!("width of air: 24-bit buffer {:.0} m off with steps of {:.0} m, here {:.1} m and {:.1} m", his.0, his.1, ours.0, ours.1);
    assert!(his.0 > 5.0e4 && his.1 > 5.0e4, "the fault is gone from its own emulation: {his:?}");
    assert!(ours.0 < 50.0 && ours.1 < 50.0, "{ours:?}");
}
