//! Kepler's problem against closed forms and 30-digit anchors; by regime against 50-digit solutions in [`regimes`], where
//! paths of the code meet in [`seams`].

mod regimes;
mod seams;

use super::*;
use crate::space::Centred;

type S = State<Centred>;

fn state(r: [f64; 3], v: [f64; 3]) -> S {
    S { position: Position::new(r.into()), velocity: Velocity::new(v.into()) }
}

fn energy(gm: f64, s: &S) -> f64 {
    0.5 * s.velocity.0.length_squared() - gm / s.position.length()
}

#[test]
fn a_400_km_orbit_keeps_its_energy_for_100_revolutions() {
    let gm = 3.986_004_355_07e14;
    let r = 6.778e6;
    let speed = libm::sqrt(gm / r);
    let start = state([r, 0.0, 0.0], [12.0, speed * libm::cos(0.9), speed * libm::sin(0.9)]);
    let e0 = energy(gm, &start);
    let period = Conic::new(gm, start.position.0, start.velocity.0).period_s();
    let worst = (0..=4000).map(|i| (energy(gm, &propagate(gm, &start, period * f64::from(i) / 40.0)) / e0 - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < 3e-15, "relative energy error {worst:e}");
}

#[test]
fn a_circle_is_a_circle() {
    let s = state([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for k in -200..200 {
        let t = 0.37 * f64::from(k);
        let p = propagate(1.0, &s, t).position.0;
        let miss = (p - DVec3::new(libm::cos(t), libm::sin(t), 0.0)).length();
        assert!(miss < 2e-15 * (1.0 + t.abs()), "t = {t}: {miss:e}");
    }
}

#[test]
fn a_parabola_follows_barkers_equation() {
    // q = 2, μ = 1, so that v = 1 is exact: t = √(2q³)(w + w³/3) = 4(w + w³/3), x = q(1 − w²), y = 2qw.
    let s = state([2.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for w in [-300.0, -3.0, -0.1, 1e-9, 0.5, 2.0, 50.0, 1e4] {
        let t = 4.0 * (w + w * w * w / 3.0);
        let p = propagate(1.0, &s, t).position.0;
        let exact = DVec3::new(2.0 * (1.0 - w * w), 4.0 * w, 0.0);
        assert!((p - exact).length() < 3e-15 * exact.length(), "w = {w}: {p} for {exact}");
    }
}

#[test]
fn a_hyperbola_follows_its_equation_far_out() {
    // a = −1, μ = 1: t = e sinh F − F, x = e − cosh F, y = √(e²−1) sinh F.
    for e in [1.01, 1.5, 10.0] {
        let s = state([e - 1.0, 0.0, 0.0], [0.0, libm::sqrt((e + 1.0) / (e - 1.0)), 0.0]);
        for f in [-18.0, -5.0, -0.3, 1e-6, 0.7, 3.0, 12.0, 20.0] {
            let t = e * libm::sinh(f) - f;
            let exact = DVec3::new(e - libm::cosh(f), libm::sqrt(e * e - 1.0) * libm::sinh(f), 0.0);
            let p = propagate(1.0, &s, t).position.0;
            assert!((p - exact).length() < 3e-13 * exact.length(), "e = {e}, F = {f}: {:e}", (p - exact).length() / exact.length());
        }
    }
}

#[test]
fn an_ellipse_follows_keplers_equation_at_any_eccentricity() {
    for e in [0.01, 0.3, 0.9, 0.999, 1.0 - 1e-6] {
        for e0 in [-3.0_f64, -1.0, 0.2, 3.1] {
            let b = libm::sqrt((1.0 - e) * (1.0 + e));
            let at = |x: f64| {
                let r = 1.0 - e * libm::cos(x);
                let p = [libm::cos(x) - e, b * libm::sin(x), 0.0];
                (state(p, [-libm::sin(x) / r, b * libm::cos(x) / r, 0.0]), x - e * libm::sin(x))
            };
            let (s, m0) = at(e0);
            for e1 in [-6.0, -2.0, 0.5, 3.0, 8.0] {
                let (exact, m1) = at(e1);
                let miss = (propagate(1.0, &s, m1 - m0).position - exact.position).length();
                // The last digit of a position at radius r is worth 1/r² of energy: a slim ellipse magnifies it.
                let (r0, r1) = (s.position.length(), exact.position.length());
                let floor = 3e-14 * (1.0 + 1.0 / (r0 * r0 * libm::sqrt(r1)));
                assert!(miss < floor, "e = {e}, E {e0} → {e1}: {miss:e}");
            }
        }
    }
}

#[test]
fn there_and_back_and_in_two_strides() {
    let mut seed = 12_345_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(seed >> 33).unwrap()) / f64::from(1_u32 << 31)
    };
    for _ in 0..3000 {
        let s = state([1.0 + random(), random() - 0.5, random() - 0.5], [2.0 * random() - 1.0, 0.3 + 1.2 * random(), random() - 0.5]);
        let dt = libm::exp(10.0 * random() - 5.0) * if random() < 0.5 { -1.0 } else { 1.0 };
        let there = propagate(1.0, &s, dt);
        assert!(there.position.is_finite() && there.velocity.is_finite());
        let back = propagate(1.0, &there, -dt);
        let scale = 1.0 + dt.abs();
        assert!((back.position - s.position).length() < 3e-11 * scale, "{s:?} over {dt}: {:e}", (back.position - s.position).length());
        let two = propagate(1.0, &propagate(1.0, &s, 0.4 * dt), 0.6 * dt);
        assert!((two.position - there.position).length() < 3e-11 * scale * (1.0 + there.velocity.length()), "{s:?} over {dt}");
        let h = s.position.0.cross(s.velocity.0);
        assert!((there.position.0.cross(there.velocity.0) - h).length() < 1e-11 * scale, "angular momentum");
    }
}

#[test]
fn anchors_at_e_0_99_and_0_999() {
    // KEP0.99 and KEP0.999 of `reference/orbit_cases.json`: 30-digit states after a non-whole number of revolutions.
    for (position, velocity, t, x, y) in ANCHORS {
        let p = propagate(1.0, &state(position, velocity), t).position.0;
        let miss = libm::hypot(p.x - x, p.y - y);
        assert!(miss < 2e-9, "t = {t}: {miss:e}");
    }
}

#[test]
fn radial_paths_fall_through_the_centre_and_return() {
    // Free fall from rest at 1: x = (1 + cos E)/2, t = (E + sin E)/√8.
    let s = state([1.0, 0.0, 0.0], [0.0; 3]);
    for e in [0.1, 1.0, 3.0] {
        let t = (e + libm::sin(e)) / libm::sqrt(8.0);
        let x = propagate(1.0, &s, t).position.0.x;
        assert!((x - 0.5 * (1.0 + libm::cos(e))).abs() < 1e-14, "E = {e}: {x}");
    }
    let away = state([1.0, 0.0, 0.0], [5.0, 0.0, 0.0]);
    for dt in [1e-9, 1.0, 1e6, -0.05, -1e3] {
        let out = propagate(1.0, &away, dt);
        assert!(out.position.is_finite() && out.velocity.is_finite(), "{dt}: {out:?}");
        if dt > 0.0 {
            assert!((energy(1.0, &out) / 11.5 - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn zero_time_and_no_gravity() {
    let s = state([1.0, 2.0, 3.0], [-0.1, 0.2, 0.3]);
    assert_eq!(propagate(1.0, &s, 0.0), s);
    assert!((propagate(0.0, &s, 10.0).position.0 - DVec3::new(0.0, 4.0, 6.0)).length() < 1e-15);
}

/// `(position, velocity, t, x, y)`, μ = 1.
const ANCHORS: [([f64; 3], [f64; 3], f64, f64, f64); 4] = [
    ([-1.99, 0.0, 0.0], [0.0, -0.07088812050083362, 0.0], 8.168140899333462, -1.5012727369854117, -0.12123590123996847),
    ([-1.99, 0.0, 0.0], [0.0, -0.07088812050083362, 0.0], 6285.07026277174, -1.5012727369855627, -0.1212359012399558),
    ([-1.999, 0.0, 0.0], [0.0, -0.02236627204212923, 0.0], 8.168140899333462, -1.514659694379715, -0.03830738915803121),
    ([-1.999, 0.0, 0.0], [0.0, -0.02236627204212923, 0.0], 6285.07026277174, -1.5146596943801589, -0.038307389158019269),
];

#[test]
fn a_low_orbit_after_a_thousand_revolutions() {
    // LEO_1000orb of `reference/orbit_cases.json`.
    let s = state([6_771_358.863, 0.0, 0.0], [0.0, 4768.073_542_876_604, 6_015.811_628_476_833]);
    let p = propagate(398_600_435_507_000.0, &s, 5_555_290.402_386_342).position.0;
    let exact = DVec3::new(-2_107_465.698_380_959, 4_002_920.903_169_394, 5_050_429.256_305_334);
    assert!((p - exact).length() < 2e-5, "{:e} m", (p - exact).length());
}
