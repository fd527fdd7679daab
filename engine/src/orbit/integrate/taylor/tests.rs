//! Taylor against closed forms and reference states, and what it owes: order, reversal, restart, scale, refusal.

use super::*;
use crate::orbit::{State, kepler};
use crate::space::{Centred, Position, Velocity};

const TIGHT: f64 = 1e-18;

fn points(bodies: &[[f64; 6]]) -> Points {
    let at = |b: &[f64; 6], k: usize| DVec3::new(b[k], b[k + 1], b[k + 2]);
    Points { t: 0.0, q: bodies.iter().map(|b| at(b, 0)).collect(), v: bodies.iter().map(|b| at(b, 3)).collect() }
}

/// A massless body at the apocentre of an orbit of semi-major axis 1 about μ = 1.
fn ellipse(e: f64) -> Points {
    points(&[[0.0; 6], [1.0 + e, 0.0, 0.0, 0.0, ((1.0 - e) / (1.0 + e)).sqrt(), 0.0]])
}

/// Burrau's three bodies of 3, 4 and 5, at rest at the corners of a right triangle.
fn pythagoras() -> (Points, [f64; 3]) {
    let at = |x, y| [x, y, 0.0, 0.0, 0.0, 0.0];
    (points(&[at(1.0, 3.0), at(-2.0, -1.0), at(1.0, -1.0)]), [3.0, 4.0, 5.0])
}

/// A star of 1, planets of 1e-3 and 1e-5, and a massless body, none in one plane.
fn planets() -> (Points, [f64; 4]) {
    let p = points(&[[0.0; 6], [1.0, 0.0, 0.1, 0.0, 1.0, 0.0], [0.0, 1.9, 0.0, -0.7, 0.0, 0.1], [-0.6, 0.0, 0.0, 0.1, -1.2, 0.05]]);
    (p, [1.0, 1e-3, 1e-5, 0.0])
}

fn kepler(start: &Points, mu: f64, t: f64) -> DVec3 {
    let state = State::<Centred> { position: Position::new(start.q[1]), velocity: Velocity::new(start.v[1]) };
    kepler::propagate(mu, &state, t).position.0
}

fn energy(p: &Points, gm: &[f64]) -> f64 {
    let mut sum = 0.0;
    for i in 0..gm.len() {
        sum += 0.5 * gm[i] * p.v[i].length_squared();
        sum -= (0..i).map(|j| gm[i] * gm[j] / (p.q[i] - p.q[j]).length()).sum::<f64>();
    }
    sum
}

#[test]
fn the_error_falls_with_the_tolerance_until_rounding_is_left() {
    let start = ellipse(0.5);
    let truth = kepler(&start, 1.0, 8.0);
    let mut last = f64::INFINITY;
    for (tolerance, most) in [(1e-6, 1e-4), (1e-9, 1e-7), (1e-12, 1e-10), (1e-15, 1e-13), (1e-18, 5e-15)] {
        let mut p = start.clone();
        Taylor::new(&[1.0, 0.0], tolerance).run(&mut p, 8.0).unwrap();
        let error = (p.q[1] - truth).length();
        assert!(error < most && error < last, "{tolerance}: {error}");
        last = error.max(3e-15);
    }
}

#[test]
fn one_step_converges_at_its_order() {
    // At tolerance τ a step is h ∝ τ^(1/N), and its error, the first term that is left out, ∝ h^(N+1) = τ^(1 + 1/N).
    let (start, gm) = pythagoras();
    for order in [7, 9, 11] {
        let error = |span: f64| {
            let (mut p, mut fine) = (start.clone(), start.clone());
            let mut one = Taylor::with_order(&gm, 1e-3, order);
            assert!(one.step(&mut p, span).unwrap(), "{span} is more than a step");
            Taylor::with_order(&gm, 1e-24, 27).run(&mut fine, span).unwrap();
            (p.q[0] - fine.q[0]).length()
        };
        let slope = libm::log2(error(0.4) / error(0.2));
        // The start is at rest, so the path is even in time: the first term left out is of order N + 1, which is even.
        assert!((slope - (order as f64 + 1.0)).abs() < 0.6, "order {order}: {slope}");
    }
}

#[test]
fn three_bodies_keep_their_reference_through_close_encounters() {
    // Double-double Taylor of order 42 from the same start at t = 10, tests/reference/orbit_cases.json.
    let truth = [
        DVec3::new(0.778_480_410_138_085_5, 0.141_392_300_290_086_17, 0.0),
        DVec3::new(-2.025_092_477_978_186_2, 0.097_219_384_146_058_4, 0.0),
    ];
    let (mut p, gm) = pythagoras();
    let work = Taylor::new(&gm, TIGHT).run(&mut p, 10.0).unwrap();
    for (q, truth) in p.q.iter().zip(truth) {
        assert!((*q - truth).length() < 1e-12, "{}", *q - truth);
    }
    assert!(work.steps < 500 && work.evaluations == work.steps, "{work:?}");
}

#[test]
fn a_thousand_revolutions_keep_twelve_digits() {
    let start = ellipse(0.3);
    let mut p = start.clone();
    Taylor::new(&[1.0, 0.0], TIGHT).run(&mut p, 6285.0).unwrap();
    let error = (p.q[1] - kepler(&start, 1.0, 6285.0)).length();
    assert!(error < 3e-11, "{error}");
}

#[test]
fn both_kernels_agree() {
    // A second massive body too light to matter: all pairs in place of one centre.
    let start = points(&[[0.0; 6], [1.9, 0.0, 0.0, 0.0, 0.2, 0.1], [50.0, 0.0, 0.0, 0.0, 0.0, 0.0]]);
    let (mut a, mut b) = (start.clone(), start);
    Taylor::new(&[1.0, 0.0, 0.0], TIGHT).run(&mut a, 30.0).unwrap();
    Taylor::new(&[1.0, 0.0, 1e-40], TIGHT).run(&mut b, 30.0).unwrap();
    assert!((a.q[1] - b.q[1]).length() < 1e-12 && (a.q[2] - b.q[2]).length() < 1e-12, "{} {}", a.q[1] - b.q[1], a.q[2] - b.q[2]);
}

#[test]
fn it_runs_back_to_where_it_came_from() {
    let (start, gm) = planets();
    let (mut p, mut taylor) = (start.clone(), Taylor::new(&gm, TIGHT));
    taylor.run(&mut p, 100.0).unwrap();
    assert!((p.q[1] - start.q[1]).length() > 0.1);
    taylor.run(&mut p, 0.0).unwrap();
    for (a, b) in p.q.iter().zip(&start.q) {
        assert!((*a - *b).length() < 2e-13, "{}", *a - *b);
    }
}

#[test]
fn energy_does_not_drift() {
    let (start, gm) = planets();
    let mut p = start.clone();
    let mut taylor = Taylor::new(&gm, TIGHT);
    for end in [100.0, 1000.0, 3000.0] {
        taylor.run(&mut p, end).unwrap();
        let off = (energy(&p, &gm) / energy(&start, &gm) - 1.0).abs();
        assert!(off < 2e-15, "{end}: {off}");
    }
}

#[test]
fn a_restart_from_a_saved_state_is_the_same_bits() {
    for (start, gm) in [(planets().0, planets().1.to_vec()), (ellipse(0.9), vec![1.0, 0.0])] {
        let (mut whole, mut taylor) = (start.clone(), Taylor::new(&gm, TIGHT));
        for _ in 0..5 {
            taylor.step(&mut whole, 50.0).unwrap();
        }
        let (mut saved, low) = (whole.clone(), taylor.low.clone());
        taylor.run(&mut whole, 50.0).unwrap();
        let mut again = Taylor::new(&gm, TIGHT);
        again.low = low;
        again.run(&mut saved, 50.0).unwrap();
        assert_eq!((&whole, &taylor.low), (&saved, &again.low));
    }
}

#[test]
fn vectors_and_plain_numbers_give_the_same_bits() {
    for (start, gm) in [(planets().0, planets().1.to_vec()), (ellipse(0.9), vec![1.0, 0.0])] {
        let (mut a, mut b) = (start.clone(), start);
        let (mut fast, mut plain) = (Taylor::new(&gm, TIGHT), Taylor::new(&gm, TIGHT));
        for _ in 0..20 {
            fast.step(&mut a, 50.0).unwrap();
            lanes::plainly(One { method: &mut plain, points: &mut b, t_end: 50.0 }).unwrap();
        }
        assert_eq!((a, fast.low), (b, plain.low));
    }
}

#[test]
fn the_polynomial_is_right_between_the_steps() {
    let start = ellipse(0.6);
    let (mut p, mut taylor) = (start.clone(), Taylor::new(&[1.0, 0.0], TIGHT));
    for _ in 0..12 {
        taylor.step(&mut p, 100.0).unwrap();
        let (from, to) = taylor.last_step();
        assert_eq!(to, p.t);
        for i in 0..=8 {
            let t = from + (to - from) * f64::from(i) / 8.0;
            let (q, v) = taylor.dense(1, t);
            assert!((q - kepler(&start, 1.0, t)).length() < 4e-15, "{t}");
            // The rate is that of the position.
            let d = 1e-4 * (to - from);
            let slope = (taylor.dense(1, t + d).0 - taylor.dense(1, t - d).0) / (2.0 * d);
            assert!((slope - v).length() < 1e-6 * v.length());
        }
        // At the step's end the polynomial is the state, to what a rounded time leaves.
        let (mut q, mut v) = ([DVec3::ZERO; 2], [DVec3::ZERO; 2]);
        taylor.dense_into(to, &mut q, &mut v);
        assert!((q[1] - p.q[1]).length() < 2e-14 && (v[1] - p.v[1]).length() < 2e-14);
    }
}

#[test]
fn scale_makes_no_difference() {
    // Lengths by s, GM by s³: the same motion. A power of two changes no bit but the exponent; others change rounding only.
    let (start, gm) = planets();
    let mut plain = start.clone();
    Taylor::new(&gm, TIGHT).run(&mut plain, 40.0).unwrap();
    for s in [1e-6, 1e6, 1e11, f64::from(1 << 20)] {
        let by = |p: &Points| Points { t: 0.0, q: p.q.iter().map(|q| *q * s).collect(), v: p.v.iter().map(|v| *v * s).collect() };
        let mut scaled = by(&start);
        Taylor::new(&gm.map(|m| m * s * s * s), TIGHT).run(&mut scaled, 40.0).unwrap();
        for (a, b) in scaled.q.iter().zip(&plain.q) {
            assert!((*a / s - *b).length() < 5e-13, "{s}: {}", *a / s - *b);
        }
    }
}

#[test]
fn a_lone_massive_body_moves_straight_on_and_carries_its_satellite() {
    let mut moving = ellipse(0.4);
    let still = moving.clone();
    let drift = DVec3::new(0.3, -0.2, 0.1);
    moving.v.iter_mut().for_each(|v| *v += drift);
    Taylor::new(&[1.0, 0.0], TIGHT).run(&mut moving, 20.0).unwrap();
    assert!((moving.q[0] - drift * 20.0).length() < 2e-15);
    assert!((moving.q[1] - moving.q[0] - kepler(&still, 1.0, 20.0)).length() < 3e-14);
}

#[test]
fn bodies_at_one_place_are_refused_and_nothing_is_changed() {
    for (gm, pair) in
        [(vec![1.0, 0.0], (0, 1)), (vec![1.0, 0.5, 0.2], (0, 1)), (vec![0.0, 1.0, 1.0], (1, 2)), (vec![1.0, 2.0, 0.0], (0, 2))]
    {
        let mut p = points(&vec![[1.0, 2.0, 3.0, 0.0, 0.0, 0.0]; gm.len()]);
        for (i, q) in p.q.iter_mut().enumerate() {
            if i != pair.0 && i != pair.1 {
                q.x += 5.0;
            }
        }
        let before = p.clone();
        assert_eq!(Taylor::new(&gm, TIGHT).step(&mut p, 1.0), Err(Stop::Together(pair.0, pair.1)));
        assert_eq!(p, before);
    }
    // Massless bodies do not attract: they may share a place.
    let mut p = points(&[[0.0; 6], [1.0, 0.0, 0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0, 1.0, 0.0], [0.0, 9.0, 0.0, 0.0, 0.0, 0.0]]);
    Taylor::new(&[1.0, 0.0, 0.0, 1e-6], TIGHT).run(&mut p, 5.0).unwrap();
    assert_eq!(p.q[1], p.q[2]);
    assert!(p.q[1].is_finite());
}

#[test]
fn a_fall_into_the_centre_ends_in_an_error_and_no_state_is_nan() {
    for gm in [vec![1.0, 0.0], vec![1.0, 1.0]] {
        let mut p = points(&[[0.0; 6], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]);
        let stop = Taylor::new(&gm, TIGHT).run(&mut p, 10.0);
        assert!(stop.is_err(), "{stop:?}");
        assert!(p.q.iter().chain(&p.v).all(|x| x.is_finite()) && p.t < 1.2);
    }
    let mut bad = ellipse(0.1);
    bad.v[1].y = f64::NAN;
    assert!(Taylor::new(&[1.0, 0.0], TIGHT).step(&mut bad, 1.0).is_err());
    assert_eq!(Taylor::new(&[1.0], TIGHT).step(&mut bad, 1.0), Err(Stop::Count { given: 2, wanted: 1 }));
    let (mut p, gm) = planets();
    p.q[2].z = f64::INFINITY;
    assert!(Taylor::new(&gm, TIGHT).step(&mut p, 1.0).is_err());
}

#[test]
fn a_nearly_radial_orbit_passes_its_pericentre() {
    // 1 − e = 1e-9: a hundred revolutions, each past 1e-9 of the axis.
    let mut p = ellipse(1.0 - 1e-9);
    let energy = |p: &Points| 0.5 * p.v[1].length_squared() - 1.0 / p.q[1].length();
    let before = energy(&p);
    Taylor::new(&[1.0, 0.0], TIGHT).run(&mut p, 100.0 * std::f64::consts::TAU).unwrap();
    assert!((energy(&p) / before - 1.0).abs() < 1e-6, "{}", energy(&p) / before - 1.0);
}
