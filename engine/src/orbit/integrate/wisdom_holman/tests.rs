//! Wisdom–Holman: exact on one pair, orders with and without correctors, the Moon, the way back, energy, restart.

use super::*;
use crate::orbit::integrate::Force;
use crate::orbit::integrate::gauss_radau::GaussRadau;

/// All attract all: the truth to compare with is another method's, of order 15.
struct Masses(Vec<f64>);

impl Force for Masses {
    const USES_VELOCITY: bool = false;
    fn accelerations(&self, _: f64, q: &[DVec3], _: &[DVec3], a: &mut [DVec3]) {
        a.fill(DVec3::ZERO);
        for i in 0..q.len() {
            for j in 0..i {
                let d = q[j] - q[i];
                let cube = 1.0 / (d.length_squared() * d.length());
                a[i] += d * (self.0[j] * cube);
                a[j] -= d * (self.0[i] * cube);
            }
        }
    }
}

fn truth(gm: &[f64], start: &Points, t_end: f64) -> Points {
    let mut points = start.clone();
    GaussRadau::new(gm.len(), 1e-9).run(&Masses(gm.to_vec()), &mut points, t_end);
    points
}

fn energy(gm: &[f64], p: &Points) -> f64 {
    let mut sum = 0.0;
    for i in 0..gm.len() {
        sum += 0.5 * gm[i] * p.v[i].length_squared();
        for j in 0..i {
            sum -= gm[i] * gm[j] / (p.q[i] - p.q[j]).length();
        }
    }
    sum
}

fn worst(a: &Points, b: &Points) -> f64 {
    a.q.iter().zip(&b.q).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
}

/// A star and two planets of mass `m` on nearly circular orbits of radius 1 and 1.8 (periods 2π and 15).
fn planets(m: f64) -> (Vec<f64>, Points) {
    let q = vec![DVec3::ZERO, DVec3::X, DVec3::new(-1.2, 1.34, 0.1)];
    let v = vec![DVec3::ZERO, DVec3::new(0.02, 1.03, 0.0), DVec3::new(-0.55, -0.49, 0.02)];
    (vec![1.0, m, m], Points { t: 0.0, q, v })
}

/// Star, planet and moon: the moon's period is 1/13 of the planet's.
fn moon() -> (Vec<f64>, Points) {
    let q = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.00257, 0.0, 1e-4)];
    let v = vec![DVec3::ZERO, DVec3::Y, DVec3::new(0.0, 1.0 + 0.0342, 0.0)];
    (vec![1.0, 3.0e-6, 3.7e-8], Points { t: 0.0, q, v })
}

fn run(gm: &[f64], tree: &Hierarchy, start: &Points, dt: f64, corrector: Corrector, t_end: f64) -> Points {
    let mut points = start.clone();
    WisdomHolman::new(gm, tree, dt, corrector).run(&mut points, t_end);
    assert_eq!(points.t, t_end);
    points
}

#[test]
fn one_pair_is_kepler_s_at_any_step() {
    let gm = [0.7, 0.3];
    let start = Points { t: 5.0, q: vec![DVec3::Y, DVec3::X], v: vec![DVec3::Z, DVec3::new(0.1, 0.4, 0.3)] };
    let end = run(&gm, &Hierarchy::chain(2), &start, 1.7, Corrector::Fifth, 50.0);
    let (r, _) = kepler::Conic::new(1.0, start.q[1] - start.q[0], start.v[1] - start.v[0]).after_raw(45.0);
    let centre = start.q[0] * 0.7 + start.q[1] * 0.3 + (start.v[0] * 0.7 + start.v[1] * 0.3) * 45.0;
    assert!((end.q[1] - end.q[0] - r).length() < 1e-12 && (end.q[0] * 0.7 + end.q[1] * 0.3 - centre).length() < 1e-12);
}

#[test]
fn correctors_raise_the_order_of_what_is_linear_in_the_disturbance() {
    let (gm, start) = planets(1e-6);
    let tree = Hierarchy::chain(3);
    let end = truth(&gm, &start, 30.0);
    let error = |corrector, dt| worst(&run(&gm, &tree, &start, dt, corrector, 30.0), &end);
    for (corrector, order) in [(Corrector::None, 2.0), (Corrector::Third, 4.0)] {
        let slope = libm::log2(error(corrector, 0.3) / error(corrector, 0.15));
        assert!((slope - order).abs() < 0.3, "{corrector:?}: {slope}");
    }
    // The fifth's slope drowns in rounding; what it leaves at a twentieth of the period does not.
    let [none, third, fifth] = [Corrector::None, Corrector::Third, Corrector::Fifth].map(|c| error(c, 0.3));
    assert!(third < 0.01 * none && fifth < 0.05 * third && fifth > 1e-13, "{none:e} {third:e} {fifth:e}");
    // At planetary masses of 1e-3 what is quadratic in them stays, of order 2: a tenth of the uncorrected.
    let (gm, start) = planets(1e-3);
    let end = truth(&gm, &start, 30.0);
    let errors = Corrector::ALL.map(|c| worst(&run(&gm, &tree, &start, 0.2, c, 30.0), &end));
    assert!(errors[2] < 0.15 * errors[0] && errors[5] < 0.15 * errors[0], "{errors:?}");
}

#[test]
fn a_moon_needs_a_pair_of_its_own() {
    let (gm, start) = moon();
    let end = truth(&gm, &start, 20.0);
    let tree = Hierarchy::from_parents(&[None, Some(0), Some(1)]).unwrap();
    assert_eq!(tree, Hierarchy::by_period(&gm, &start.q, &start.v));
    // A twentieth of the month.
    let own = worst(&run(&gm, &tree, &start, 0.024, Corrector::Fifth, 20.0), &end);
    let listed = worst(&run(&gm, &Hierarchy::chain(3), &start, 0.024, Corrector::Fifth, 20.0), &end);
    // The moon's orbit has radius 2.6e-3.
    assert!(own < 1e-6 && listed > 1e-4, "own pair {own:e}, listed {listed:e}");
}

#[test]
fn the_way_back_is_the_way_there() {
    let (gm, start) = moon();
    let tree = Hierarchy::by_period(&gm, &start.q, &start.v);
    for corrector in [Corrector::None, Corrector::Seventeenth] {
        let there = run(&gm, &tree, &start, 0.02, corrector, 10.0);
        let back = run(&gm, &tree, &there, 0.02, corrector, 0.0);
        assert!(worst(&back, &start) < 1e-11, "{corrector:?}: {:e}", worst(&back, &start));
    }
}

#[test]
fn energy_stays_where_it_is() {
    let (gm, start) = planets(1e-3);
    let before = energy(&gm, &start);
    for corrector in [Corrector::None, Corrector::Seventh] {
        let mut method = WisdomHolman::new(&gm, &Hierarchy::chain(3), 0.31, corrector);
        method.start(&start);
        let mut halves = [0.0_f64; 2];
        for k in 0..400 {
            method.advance(17);
            let half = usize::from(k >= 200);
            halves[half] = halves[half].max((energy(&gm, &method.points()) / before - 1.0).abs());
        }
        // 300 revolutions: a drift would double it.
        assert!(halves[0] > 1e-9 && halves[1] < 1.3 * halves[0], "{corrector:?}: {halves:?}");
    }
}

#[test]
fn a_restart_from_what_was_saved_is_bit_equal_and_looking_changes_nothing() {
    let (gm, start) = moon();
    let tree = Hierarchy::by_period(&gm, &start.q, &start.v);
    let fresh = || WisdomHolman::new(&gm, &tree, 0.02, Corrector::Eleventh);
    let mut whole = fresh();
    whole.start(&start);
    whole.advance(300);
    let mut first = fresh();
    first.start(&start);
    first.advance(120);
    assert!((first.points().t - 2.4).abs() < 1e-14);
    let mut second = fresh();
    second.resume(first.memory().clone());
    second.advance(180);
    assert_eq!((whole.points(), whole.memory()), (second.points(), second.memory()));
}

#[test]
fn no_body_and_one_body_are_systems_too() {
    let mut none = Points::default();
    WisdomHolman::new(&[], &Hierarchy::chain(0), 0.1, Corrector::Third).run(&mut none, 1.0);
    assert_eq!(none.t, 1.0);
    let mut one = Points { t: 0.0, q: vec![DVec3::X], v: vec![DVec3::Y] };
    WisdomHolman::new(&[1.0], &Hierarchy::chain(1), 0.1, Corrector::Third).run(&mut one, 1.0);
    assert!((one.q[0] - DVec3::X - DVec3::Y).length() < 1e-15);
}
