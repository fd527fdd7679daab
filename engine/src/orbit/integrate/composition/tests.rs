//! Compositions: order of every scheme, the conditions that its weights owe, the way back, energy, restart.

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

fn orbit(e: f64) -> Points {
    Points { t: 0.0, q: vec![DVec3::new(1.0 - e, 0.0, 0.0)], v: vec![DVec3::new(0.0, ((1.0 + e) / (1.0 - e)).sqrt(), 0.0)] }
}

fn energy(p: &Points) -> f64 {
    0.5 * p.v[0].length_squared() - 1.0 / p.q[0].length()
}

fn run(scheme: Scheme, start: &Points, dt: f64, t_end: f64) -> Points {
    let mut points = start.clone();
    Composition::new(scheme, 1, dt, true).run(&Centre, &mut points, t_end);
    assert_eq!(points.t, t_end);
    points
}

#[test]
fn each_scheme_converges_at_its_order() {
    let start = orbit(0.2);
    let truth = Conic::new(1.0, start.q[0], start.v[0]).after_raw(6.0).0;
    for scheme in SCHEMES {
        let error = |n: f64| (run(scheme, &start, 6.0 / n, 6.0).q[0] - truth).length();
        // Where steps are short enough for the order and long enough to stay above rounding.
        let n = if scheme.order < 6 { 256.0 } else { 32.0 };
        let order = libm::log2(error(n) / error(2.0 * n));
        assert!((order - f64::from(scheme.order)).abs() < 0.1, "{}: measured {order}", scheme.name);
    }
}

#[test]
fn weights_are_palindromes_of_sum_one() {
    for s in SCHEMES {
        assert_eq!(s.kicks.len(), s.drifts.len() + 1, "{}", s.name);
        for list in [s.kicks, s.drifts] {
            assert!((list.iter().sum::<f64>() - 1.0).abs() < 4e-15, "{}", s.name);
            assert!(list.iter().eq(list.iter().rev()), "{}", s.name);
        }
    }
    // What leapfrogs of sizes w owe for order p: Σwᵏ = 0 for odd k < p [Yoshida 1990, eq. 3.9]. A slip in the twelfth digit shows.
    for s in SCHEMES.into_iter().filter(|s| s.order > 2 && s.name != "blanes_moan6") {
        for k in (3..s.order).step_by(2) {
            let sum: f64 = s.drifts.iter().map(|w| libm::pow(*w, f64::from(k))).sum();
            assert!(sum.abs() < 5e-12, "{}: Σw^{k} = {sum:e}", s.name);
        }
    }
}

#[test]
fn the_way_back_is_the_way_there() {
    let start = orbit(0.5);
    for scheme in SCHEMES {
        let mut points = run(scheme, &start, 0.02, 20.0);
        let there = (points.q[0] - start.q[0]).length();
        Composition::new(scheme, 1, 0.02, true).run(&Centre, &mut points, 0.0);
        let miss = (points.q[0] - start.q[0]).length();
        assert!(there > 0.5 && miss < 2e-12, "{}: {miss:e}", scheme.name);
    }
}

#[test]
fn energy_stays_where_it_is_for_a_thousand_revolutions() {
    let start = orbit(0.1);
    // A drift would double it. No whole number of steps in a revolution: all phases are seen.
    for (scheme, steps) in [(LEAPFROG, 60.37), (SUZUKI4, 20.37), (BLANES_MOAN6, 10.37), (KAHAN_LI8_17, 10.37)] {
        let (mut points, mut method) = (start.clone(), Composition::new(scheme, 1, core::f64::consts::TAU / steps, false));
        let mut worst = [0.0_f64; 2];
        for century in 1..=40 {
            let end = 157.0 * f64::from(century);
            while method.step(&Centre, &mut points, end) == Step::Made {
                let half = usize::from(century > 20);
                worst[half] = worst[half].max((energy(&points) / energy(&start) - 1.0).abs());
            }
        }
        let [early, late] = worst;
        assert!(early > 1e-9 && late < 1.25 * early, "{}: {early:e} then {late:e}", scheme.name);
    }
}

#[test]
fn compensated_sums_leave_a_smaller_walk() {
    // 16 orbits: the scatter of energy after 200 revolutions, where the scheme's own error is below rounding.
    let scatter = |compensated: bool| {
        let sum: f64 = (0..16)
            .map(|k| {
                let mut points = orbit(0.01 + 1e-3 * f64::from(k));
                let before = energy(&points);
                let mut method = Composition::new(KAHAN_LI8_17, 1, 0.07, compensated);
                method.run(&Centre, &mut points, 0.07 * 18_000.0);
                (energy(&points) / before - 1.0) * (energy(&points) / before - 1.0)
            })
            .sum();
        (sum / 16.0).sqrt()
    };
    let (plain, carried) = (scatter(false), scatter(true));
    assert!(carried < 0.6 * plain && plain < 1e-12, "{plain:e} {carried:e}");
}

#[test]
fn a_restart_from_what_was_saved_is_bit_equal() {
    for compensated in [false, true] {
        let (mut points, mut method) = (orbit(0.3), Composition::new(BLANES_MOAN6, 1, 0.1, compensated));
        method.run(&Centre, &mut points, 3.0);
        let (mut again, mut other) = (points.clone(), Composition::new(BLANES_MOAN6, 1, 0.1, compensated));
        other.resume(method.memory().clone());
        method.run(&Centre, &mut points, 10.0);
        other.run(&Centre, &mut again, 10.0);
        assert_eq!((points, method.memory()), (again, other.memory()));
    }
}
