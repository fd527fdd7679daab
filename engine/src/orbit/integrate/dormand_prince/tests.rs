//! Pairs against what their weights owe and against closed forms: order, estimate, dense output, both directions, restart.

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

/// A charge in a field along z that grows with the time: x″ = x′ × z·t. Its velocity turns by t²/2.
struct Magnet;

impl Force for Magnet {
    const USES_VELOCITY: bool = true;
    fn accelerations(&self, t: f64, _: &[DVec3], v: &[DVec3], a: &mut [DVec3]) {
        for (a, v) in a.iter_mut().zip(v) {
            *a = v.cross(DVec3::Z * t);
        }
    }
}

fn orbit(e: f64) -> Points {
    Points { t: 0.0, q: vec![DVec3::new(1.0 - e, 0.0, 0.0)], v: vec![DVec3::new(0.0, ((1.0 + e) / (1.0 - e)).sqrt(), 0.0)] }
}

/// n equal steps.
fn fixed<F: Force>(pair: Pair, force: &F, start: &Points, n: u32, t_end: f64) -> (Embedded, Points) {
    let (mut points, mut method) = (start.clone(), Embedded::new(pair, 1, 1e30, true));
    for i in 1..=n {
        method.memory.natural = t_end;
        method.step(force, &mut points, t_end * f64::from(i) / f64::from(n));
    }
    assert_eq!((points.t, method.work().steps), (t_end, u64::from(n)));
    (method, points)
}

#[test]
fn weights_meet_the_conditions_of_their_order() {
    for pair in [DORMAND_PRINCE_5, DORMAND_PRINCE_8] {
        let Table { name, a, b, c, order } = pair.table;
        assert!(a.len() == b.len() && b.len() == c.len() && pair.low.len() == b.len(), "{name}");
        for (row, c) in a.iter().zip(c) {
            assert!((row.iter().sum::<f64>() - c).abs() < 2e-14, "{name}: a row does not add up to {c}");
        }
        let power = |x: f64, k: u32| libm::pow(x, f64::from(k));
        for (weights, order) in [(b, order), (pair.low, pair.low_order)] {
            for k in 0..order {
                // Bushy trees: Σ b cᵏ = 1/(k+1) …
                let sum: f64 = weights.iter().zip(c).map(|(b, c)| b * power(*c, k)).sum();
                assert!((sum * f64::from(k + 1) - 1.0).abs() < 1e-13, "{name}: degree {k}");
                // … and the trees with one branch more: Σ b cᵏ Σ a cᵐ = 1/((m+1)(k+m+2)), k + m + 2 ≤ order.
                for m in 0..order.saturating_sub(k + 1) {
                    let sum: f64 = (0..b.len())
                        .map(|i| weights[i] * power(c[i], k) * a[i].iter().zip(c).map(|(a, c)| a * power(*c, m)).sum::<f64>())
                        .sum();
                    assert!((sum * f64::from((m + 1) * (k + m + 2)) - 1.0).abs() < 1e-12, "{name}: {k} {m} {sum}");
                }
            }
        }
    }
}

#[test]
fn each_pair_converges_at_its_order_with_and_without_velocities() {
    // One step from a place without symmetry: its error goes with the order plus one. (That of a revolution changes sign.)
    let mut start = orbit(0.3);
    (start.q[0], start.v[0]) = Conic::new(1.0, start.q[0], start.v[0]).after_raw(1.0);
    for (pair, dt, m) in [(DORMAND_PRINCE_5, 0.1, 40), (DORMAND_PRINCE_8, 0.4, 10)] {
        let error = |dt: f64| {
            let (r, v) = Conic::new(1.0, start.q[0], start.v[0]).after_raw(dt);
            let points = fixed(pair, &Centre, &start, 1, dt).1;
            (points.q[0] - r).length() + (points.v[0] - v).length()
        };
        let order = libm::log2(error(dt) / error(0.5 * dt)) - 1.0;
        assert!((order - f64::from(pair.table.order)).abs() < 0.5, "{}: measured {order}", pair.table.name);

        let start = Points { t: 0.0, q: vec![DVec3::ZERO], v: vec![DVec3::X] };
        let truth = DVec3::new(libm::cos(8.0), -libm::sin(8.0), 0.0);
        let error = |n| (fixed(pair, &Magnet, &start, n, 4.0).1.v[0] - truth).length();
        let order = libm::log2(error(m) / error(2 * m));
        assert!((order - f64::from(pair.table.order)).abs() < 0.7, "{}: measured {order} with velocities", pair.table.name);
    }
}

#[test]
fn dense_output_is_of_order_seven() {
    let start = orbit(0.3);
    let conic = Conic::new(1.0, start.q[0], start.v[0]);
    let (mut q, mut v) = ([DVec3::ZERO], [DVec3::ZERO]);
    // The error inside a step of the same exact start, so that only the polynomial's shows: order + 1.
    let mut local = |dt: f64| {
        let (mut points, mut method) = (start.clone(), Embedded::new(DORMAND_PRINCE_8, 1, 1e30, true));
        method.memory.natural = dt;
        method.step(&Centre, &mut points, dt);
        let mut worst = (0.0_f64, 0.0_f64);
        for k in 0..=24 {
            let t = dt * f64::from(k) / 24.0;
            assert!(method.dense(t, &mut q, &mut v));
            let (r, speed) = conic.after_raw(t);
            worst = (worst.0.max((q[0] - r).length()), worst.1.max((v[0] - speed).length()));
        }
        worst
    };
    let (long, short) = (local(0.4), local(0.2));
    let orders = (libm::log2(long.0 / short.0), libm::log2(long.1 / short.1));
    assert!(orders.0 > 7.5 && orders.1 > 6.5, "{orders:?} {long:?}");
    assert!(long.0 < 1.5e-6, "{long:?}");
    // Both ends are those of the step.
    let (method, points) = fixed(DORMAND_PRINCE_8, &Centre, &start, 10, 3.0);
    assert!(method.dense(3.0, &mut q, &mut v) && (q[0] - points.q[0]).length() < 1e-15 && (v[0] - points.v[0]).length() < 1e-15);
    assert!(!Embedded::new(DORMAND_PRINCE_8, 1, 1e-9, true).dense(0.0, &mut q, &mut v));
}

#[test]
fn the_error_follows_the_tolerance_and_the_way_back_leads_back() {
    let start = orbit(0.6);
    let truth = Conic::new(1.0, start.q[0], start.v[0]).after_raw(50.0).0;
    for (pair, tolerance, bound) in [(DORMAND_PRINCE_5, 1e-9, 1e-5), (DORMAND_PRINCE_8, 1e-10, 1e-7), (DORMAND_PRINCE_8, 1e-14, 3e-11)] {
        let (mut points, mut method) = (start.clone(), Embedded::new(pair, 1, tolerance, false));
        let work = method.run(&Centre, &mut points, 50.0);
        let error = (points.q[0] - truth).length();
        assert!(points.t == 50.0 && error < bound && error > bound * 1e-3, "{} {tolerance:e}: {error:e} {work:?}", pair.table.name);
        assert_eq!(work.evaluations, work.steps * pair.table.b.len() as u64 + work.rejected * (pair.table.b.len() as u64 - 1));
        method.run(&Centre, &mut points, 0.0);
        let miss = (points.q[0] - start.q[0]).length();
        assert!(points.t == 0.0 && miss < 2.0 * bound, "{} {tolerance:e}: back with {miss:e}", pair.table.name);
    }
}

#[test]
fn a_restart_from_what_was_saved_is_bit_equal() {
    for dense in [false, true] {
        let (mut points, mut method) = (orbit(0.7), Embedded::new(DORMAND_PRINCE_8, 1, 1e-11, dense));
        for _ in 0..7 {
            method.step(&Centre, &mut points, 50.0);
        }
        let (mut again, mut other) = (points.clone(), Embedded::new(DORMAND_PRINCE_8, 1, 1e-11, dense));
        other.resume(method.memory().clone());
        method.run(&Centre, &mut points, 50.0);
        other.run(&Centre, &mut again, 50.0);
        assert_eq!((points, method.memory()), (again, other.memory()));
    }
}

#[test]
fn a_singular_start_stalls_and_no_number_is_not_one() {
    let mut points = Points { t: 0.0, q: vec![DVec3::ZERO], v: vec![DVec3::ZERO] };
    let same = points.clone();
    assert_eq!(Embedded::new(DORMAND_PRINCE_8, 1, 1e-9, true).step(&Centre, &mut points, 1.0), Step::Stalled);
    assert_eq!(points, same);
    let mut fall = Points { t: 0.0, q: vec![DVec3::X], v: vec![DVec3::ZERO] };
    Embedded::new(DORMAND_PRINCE_8, 1, 1e-9, false).run(&Centre, &mut fall, 10.0);
    assert!(fall.q[0].is_finite() && fall.v[0].is_finite(), "{fall:?}");
}
