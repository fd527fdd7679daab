//! Where one way of computing hands over to another, nothing may show; and no input may make what is not a number.

use super::super::batch::{Starts, propagate_many};
use super::super::conic::Scaled;
use super::super::guess;
use super::super::{Conic, propagate_raw};
use glam::DVec3;
use proptest::prelude::*;

/// A start at pericentre distance 1, μ = 1, with a given speed there.
fn fast(speed: f64) -> (DVec3, DVec3) {
    (DVec3::X, DVec3::new(0.0, 0.8 * speed, 0.6 * speed))
}

/// The two neighbouring times between `a` and `b` at which `side` changes.
fn seam(mut a: f64, mut b: f64, side: impl Fn(f64) -> bool) -> (f64, f64) {
    assert_ne!(side(a), side(b), "no seam between {a} and {b}");
    while b > a.next_up() {
        let middle = (0.5 * (a + b)).clamp(a.next_up(), b.next_down());
        if side(middle) == side(a) {
            a = middle;
        } else {
            b = middle;
        }
    }
    (a, b)
}

fn is_smooth_over(r0: DVec3, v0: DVec3, (a, b): (f64, f64)) {
    let ((p, u), (q, w)) = (propagate_raw(1.0, r0, v0, a), propagate_raw(1.0, r0, v0, b));
    let step = (q - p - u * (b - a)).length();
    // A last digit of the result, and 2⁻⁵⁸ of the terms that it is a difference of.
    assert!(step < 2.3e-16 * p.length() + 2e-17 * r0.length(), "between {a} and {b}: {:e}", step / p.length());
    // The centre pulls by 1/r² meanwhile.
    let pulled = (b - a) / p.length_squared();
    assert!((w - u).length() < 8e-16 * u.length() + 1.1 * pulled, "velocity between {a} and {b}: {:e}", (w - u).length());
}

#[test]
fn nothing_shows_where_the_guess_changes() {
    for speed in [0.3, 1.0, 1.3, 1.414, 1.5, 3.0] {
        let (r0, v0) = fast(speed);
        let orbit = Scaled::new(1.0, r0, v0).orbit;
        // These starts are scaled by no more than a power of two in time.
        is_smooth_over(r0, v0, seam(1e-9, 2.0, |t| guess::nearby(&orbit, t).1 < 0.2));
    }
}

#[test]
fn nothing_shows_where_the_functions_change() {
    // βs² at the time t, from the change of eccentric anomaly; −4, −16, 5.0625 are the seams of the series.
    for (speed, seams) in [(1.2_f64, vec![5.0625]), (1.9, vec![-4.0, -16.0]), (4.0, vec![-4.0, -16.0])] {
        let (r0, v0) = fast(speed);
        let beta = 2.0 - speed * speed;
        for x in seams {
            let s = libm::sqrt(x / beta);
            let (root, e) = (beta.abs().sqrt(), speed * speed - 1.0);
            // Pericentre start: t = s q + μe G₃ with q = 1.
            let g1 = if beta > 0.0 { libm::sin(root * s) } else { libm::sinh(root * s) } / root;
            let time = s + e * (s - g1) / beta;
            for k in -40..40 {
                let t = time * (1.0 + f64::from(k) * 3e-9);
                is_smooth_over(r0, v0, (t, t.next_up()));
            }
        }
    }
}

#[test]
fn nothing_shows_where_a_revolution_is_taken_off() {
    for speed in [0.3, 1.0, 1.3] {
        let (r0, v0) = fast(speed);
        let period = Conic::new(1.0, r0, v0).period_s();
        for turns in [0.5, 1.0, 1.5, 7.5] {
            let t = turns * period;
            is_smooth_over(r0, v0, (t.next_down(), t));
            is_smooth_over(r0, v0, (t, t.next_up()));
        }
    }
}

#[test]
fn a_parabola_lies_between_its_ellipses_and_its_hyperbolas() {
    // |v|² = 2 exactly at r = 1 cannot be had; 2μ/r with r = 2 can.
    let (r0, v0) = (DVec3::new(2.0, 0.0, 0.0), DVec3::Y);
    for t in [1e-3, 0.7, 30.0, 1e6, -5.0] {
        let (p, u) = propagate_raw(1.0, r0, v0, t);
        let mut last = 0.0;
        for k in [1.0, 1e3, 1e6, 1e9] {
            for less in [-k * f64::EPSILON, k * f64::EPSILON] {
                let (q, w) = propagate_raw(1.0, r0, v0 * (1.0 + less), t);
                let (dr, dv) = ((q - p).length() / p.length(), (w - u).length() / u.length());
                // dβ = −2 v₀² dv: at t = 1e6 the distance is 1.6e4, and x, y change by β r/μ of themselves.
                let most = 3e-16 + 3.0 * less.abs() * (1.0 + p.length());
                assert!(dr < most && dv < most, "t {t}, 1 + {less:e}: {dr:e} {dv:e} above {most:e}");
                last = dr;
            }
        }
        assert!(last > 1e-10 * t.abs().min(1.0), "the eccentricity does matter: {last:e}");
    }
}

#[test]
fn a_radial_path_through_the_centre_comes_back() {
    // From rest at 1: the fall takes π/√8, and the way out is the way in.
    let (r0, v0) = (DVec3::X, DVec3::ZERO);
    let fall = core::f64::consts::PI / libm::sqrt(8.0);
    for part in [0.02, 0.4, 0.9] {
        let ((a, u), (b, w)) = (propagate_raw(1.0, r0, v0, fall * (1.0 - part)), propagate_raw(1.0, r0, v0, fall * (1.0 + part)));
        assert!((a - b).length() < 4e-15 / a.length(), "{part}: {a} {b}");
        assert!((u + w).length() < 4e-15 * u.length() / (a.length() * a.length()), "{part}: {u} {w}");
    }
    let (r, v) = propagate_raw(1.0, r0, v0, fall);
    assert!(r.length() < 1e-9 && v.is_finite(), "{r} {v}");
    // A hyperbola: in at speed 3 from 2, out again.
    let (r, v) = propagate_raw(1.0, DVec3::X * 2.0, DVec3::X * -3.0, 1e4);
    assert!(r.x > 2.8e4 && v.x > 2.8 && v.x < 3.0, "{r} {v}");
}

#[test]
fn more_revolutions_than_digits_stay_on_the_orbit() {
    let (r0, v0) = fast(1.2);
    for dt in [1e15, 1e17, 1e30, 1e200, 1e308] {
        let (r, v) = propagate_raw(1.0, r0, v0, dt);
        let energy = 0.5 * v.length_squared() - 1.0 / r.length();
        assert!((energy - (0.5 * 1.44 - 1.0)).abs() < 1e-15, "{dt}: {energy}");
    }
}

#[test]
fn odd_inputs_make_no_nan() {
    let odd = [0.0, -0.0, 1.0, -1.0, 1e-320, 1e-300, 1e-30, 1e30, 1e150, -1e200, 1e300];
    for gm in [-1.0, 0.0, 1e-320, 1e-20, 1.0, 1e20, 1e300] {
        for x in odd {
            for v in odd {
                for dt in [0.0, 1e-300, 1.0, -1e9, 1e18, 1e300] {
                    for w in [0.0, 0.3 * v] {
                        let (r, u) = propagate_raw(gm, DVec3::new(x, 0.5 * x, 0.0), DVec3::new(v, 0.0, w), dt);
                        assert!(!r.is_nan() && !u.is_nan(), "gm {gm:e} x {x:e} v {v:e} {w:e} dt {dt:e}: {r} {u}");
                    }
                }
            }
        }
    }
}

/// A number of any size up to 10^`span`, or zero.
fn any_number(span: f64) -> impl Strategy<Value = f64> {
    prop_oneof![
        1 => Just(0.0),
        19 => (-span..span, any::<bool>()).prop_map(|(e, minus)| libm::exp10(e) * if minus { -1.0 } else { 1.0 }),
    ]
}

fn any_case() -> impl Strategy<Value = [f64; 8]> {
    prop_oneof![Just(2.0), Just(20.0), Just(80.0), Just(300.0)].prop_flat_map(|span| core::array::from_fn::<_, 8, _>(|_| any_number(span)))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_start_makes_nan_and_a_batch_agrees(c in any_case()) {
        let one = propagate_raw(c[0].abs(), DVec3::new(c[1], c[2], c[3]), DVec3::new(c[4], c[5], c[6]), c[7]);
        prop_assert!(!one.0.is_nan() && !one.1.is_nan(), "{c:?}: {one:?}");
        let mut out = [(DVec3::ZERO, DVec3::ZERO)];
        let column = |k: usize| core::slice::from_ref(&c[k]);
        let gm = [c[0].abs()];
        propagate_many(
            &Starts { gm: &gm, r: [column(1), column(2), column(3)], v: [column(4), column(5), column(6)], dt_s: column(7) },
            &mut out,
        );
        prop_assert_eq!(out[0], one);
    }
}
