//! Gauss–Radau against closed forms: order, energy, both directions, restart, dense output, velocity-dependent forces.

use super::*;
use crate::orbit::kepler::Conic;

/// A fixed centre of gravitational parameter 1.
struct Centre;

impl Force for Centre {
    const USES_VELOCITY: bool = false;
    fn accelerations(&self, _: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        for (a, q) in a.iter_mut().zip(q) {
            let r2 = q.length_squared();
            *a = *q * (-1.0 / (r2 * r2.sqrt()));
        }
    }
}

/// An orbit of semi-major axis 1 from its apocentre.
fn orbit(e: f64) -> Points {
    let speed = ((1.0 - e) / (1.0 + e)).sqrt();
    Points { t: 0.0, q: vec![DVec3::new(-1.0 - e, 0.0, 0.0)], v: vec![DVec3::new(0.0, -speed, 0.0)] }
}

fn truth(start: &Points, t: f64) -> DVec3 {
    Conic::new(1.0, start.q[0], start.v[0]).after_raw(t).0
}

/// Steps of equal size, asked for one by one, so that the order shows.
fn fixed(n: u32, t_end: f64) -> (GaussRadau, Points) {
    let mut points = orbit(0.5);
    let mut method = GaussRadau::new(1, 1e30);
    for i in 1..=n {
        method.memory.natural = t_end;
        method.step(&Centre, &mut points, t_end * f64::from(i) / f64::from(n));
    }
    assert_eq!((points.t, method.work().steps), (t_end, u64::from(n)));
    (method, points)
}

#[test]
fn the_order_is_fifteen() {
    let error = |n: u32| (fixed(n, 4.0).1.q[0] - truth(&orbit(0.5), 4.0)).length();
    let order = libm::log2(error(8) / error(16));
    assert!((14.0..17.0).contains(&order), "measured {order}");
}

#[test]
fn dense_output_is_of_order_nine_or_more_and_near_the_floor_by_default() {
    let start = orbit(0.5);
    let (mut q, mut v) = ([DVec3::ZERO], [DVec3::ZERO]);
    let mut error = |n: u32| {
        let (method, points) = fixed(n, 2.0);
        let step = 2.0 / f64::from(n);
        let mut worst = 0.0_f64;
        for k in 0..=20 {
            let t = points.t - step * f64::from(k) / 20.0;
            method.dense(t, &mut q, &mut v);
            worst = worst.max((q[0] - truth(&start, t)).length());
        }
        worst
    };
    let order = libm::log2(error(3) / error(6));
    assert!((8.0..12.0).contains(&order), "measured {order}");

    let mut points = orbit(0.5);
    let mut method = GaussRadau::new(1, GaussRadau::TOLERANCE);
    let (mut worst, mut worst_v) = (0.0_f64, 0.0_f64);
    while method.step(&Centre, &mut points, 6.0) == Step::Made {
        for k in 0..=4 {
            let t = points.t - method.memory().done * f64::from(k) / 4.0;
            method.dense(t, &mut q, &mut v);
            let (r, speed) = Conic::new(1.0, start.q[0], start.v[0]).after_raw(t);
            worst = worst.max((q[0] - r).length());
            worst_v = worst_v.max((v[0] - speed).length());
        }
    }
    assert!(worst < 1e-14 && worst_v < 1e-12, "{worst:e} {worst_v:e}");
}

#[test]
fn a_hundred_orbits_keep_energy_and_come_back() {
    for e in [0.001, 0.9] {
        let start = orbit(e);
        let energy = |p: &Points| 0.5 * p.v[0].length_squared() - 1.0 / p.q[0].length();
        let (mut points, mut method) = (start.clone(), GaussRadau::new(1, 1e-9));
        let span = 100.0 * core::f64::consts::TAU;
        method.run(&Centre, &mut points, span);
        assert_eq!(points.t, span);
        let drift = (energy(&points) / energy(&start) - 1.0).abs();
        assert!(drift < 2e-14, "e = {e}: {drift:e}");
        // Back again with another method's steps: the way is not the same, the place is.
        GaussRadau::new(1, 1e-8).run(&Centre, &mut points, 0.0);
        let miss = (points.q[0] - start.q[0]).length();
        assert!(points.t == 0.0 && miss < 3e-12 / (1.0 - e), "e = {e}: {miss:e}");
    }
}

#[test]
fn energy_wanders_as_the_root_of_time_and_does_not_drift() {
    // 16 orbits, 100 revolutions each: 2000 steps of a few 1e-17. A bias shows as a mean beyond its own scatter.
    let drifts: Vec<f64> = (0..16)
        .map(|k| {
            let size = 1.0 + 0.013 * f64::from(k);
            let mut points = orbit(0.05);
            (points.q[0], points.v[0]) = (points.q[0] * size, points.v[0] / size.sqrt() + DVec3::Z * 0.2);
            let energy = |p: &Points| 0.5 * p.v[0].length_squared() - 1.0 / p.q[0].length();
            let before = energy(&points);
            GaussRadau::new(1, 1e-9).run(&Centre, &mut points, 628.0);
            energy(&points) / before - 1.0
        })
        .collect();
    let mean = drifts.iter().sum::<f64>() / 16.0;
    let scatter = (drifts.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / 15.0).sqrt();
    assert!(mean.abs() < 4.0 * scatter / 4.0 && scatter < 2e-15, "mean {mean:e}, scatter {scatter:e}");
}

#[test]
fn a_restart_from_what_was_saved_is_bit_equal() {
    let (mut points, mut method) = (orbit(0.7), GaussRadau::new(1, 1e-8));
    for _ in 0..7 {
        method.step(&Centre, &mut points, 50.0);
    }
    let (mut again, mut other) = (points.clone(), GaussRadau::new(1, 1e-8));
    other.resume(method.memory().clone());
    method.run(&Centre, &mut points, 50.0);
    other.run(&Centre, &mut again, 50.0);
    assert_eq!((points, method.memory()), (again, other.memory()));
}

#[test]
fn forces_may_depend_on_velocity_and_time() {
    /// A harmonic oscillator with friction and a push: x″ = −x − 2γx′ + t.
    struct Damped;
    impl Force for Damped {
        const USES_VELOCITY: bool = true;
        fn accelerations(&self, t: f64, q: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
            a[0] = -q[0] - v[0] * 0.2 + DVec3::X * t;
        }
    }
    let mut points = Points { t: 0.0, q: vec![DVec3::ZERO], v: vec![DVec3::ZERO] };
    GaussRadau::new(1, 1e-9).run(&Damped, &mut points, 10.0);
    // x = t − 2γ + e^{−γt}(2γ cos ωt + (2γ² − 1)/ω sin ωt), γ = 0.1, ω² = 1 − γ².
    let omega = 0.99_f64.sqrt();
    let (sin, cos) = libm::sincos(10.0 * omega);
    let x = 10.0 - 0.2 + libm::exp(-1.0) * (0.2 * cos + (0.02 - 1.0) / omega * sin);
    assert!((points.q[0].x - x).abs() < 2e-14, "{} {x}", points.q[0].x);
}

#[test]
fn what_cannot_go_on_stops_and_says_so() {
    /// Two points that pull each other, at one place.
    struct Pair;
    impl Force for Pair {
        const USES_VELOCITY: bool = false;
        fn accelerations(&self, _: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
            let d = q[1] - q[0];
            let pull = d / (d.length_squared() * d.length());
            (a[0], a[1]) = (pull, -pull);
        }
    }
    let same = Points { t: 0.0, q: vec![DVec3::X; 2], v: vec![DVec3::ZERO; 2] };
    let mut points = same.clone();
    assert_eq!(GaussRadau::new(2, 1e-9).step(&Pair, &mut points, 1.0), Step::Stalled);
    assert_eq!(points, same);
    // A fall onto each other ends before the crash, at numbers.
    let mut points = Points { t: 0.0, q: vec![DVec3::X, -DVec3::X], v: vec![DVec3::ZERO; 2] };
    let mut method = GaussRadau::new(2, 1e-9);
    method.run(&Pair, &mut points, 10.0);
    assert!(points.q.iter().chain(&points.v).all(|x| x.is_finite()), "{points:?}");
    assert!(points.q[0].x < 1e-9 && (points.t / 2.221_441_469_079_183 - 1.0).abs() < 1e-12);
    // No force, no time left, no end: a straight line, nothing, and nothing.
    let mut points = Points { t: 0.0, q: vec![DVec3::ZERO], v: vec![DVec3::X] };
    /// Nothing pulls.
    struct Free;
    impl Force for Free {
        const USES_VELOCITY: bool = false;
        fn accelerations(&self, _: f64, _: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
            a.fill(DVec3::ZERO);
        }
    }
    let mut method = GaussRadau::new(1, 1e-9);
    method.run(&Free, &mut points, 1e9);
    assert_eq!((points.t, points.q[0]), (1e9, DVec3::X * 1e9));
    assert_eq!(method.step(&Free, &mut points, 1e9), Step::Arrived);
    assert_eq!(method.step(&Free, &mut points, f64::NAN), Step::Stalled);
}
