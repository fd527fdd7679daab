//! Error by regime: 780 cases of `tests/reference/kepler_cases.csv` with states from 50-digit solutions and each case's floor,
//! the change that a part in 2⁵³ of any input makes. The regimes are those on which REBOUND's solver was measured; the file was
//! written by `tests/peers/kepler.py`, which measures as many more as asked.

use super::super::batch::{Starts, propagate_many};
use super::super::{Conic, propagate_raw};
use glam::DVec3;

const TABLE: &str = include_str!("../../../../../tests/reference/kepler_cases.csv");

struct Case {
    regime: &'static str,
    gm: f64,
    r: DVec3,
    v: DVec3,
    dt: f64,
    r_after: DVec3,
    v_after: DVec3,
    floor: [f64; 2],
}

fn cases() -> Vec<Case> {
    TABLE
        .lines()
        .skip(1)
        .map(|line| {
            let (regime, numbers) = line.split_once(',').unwrap();
            let n: Vec<f64> = numbers.split(',').map(|c| c.parse().unwrap()).collect();
            let vector = |k: usize| DVec3::new(n[k], n[k + 1], n[k + 2]);
            let (r_after, v_after) = (vector(8), vector(11));
            Case { regime, gm: n[0], r: vector(1), v: vector(4), dt: n[7], r_after, v_after, floor: [n[14], n[15]] }
        })
        .collect()
}

fn off(a: DVec3, b: DVec3) -> f64 {
    (a - b).length() / b.length()
}

#[test]
fn errors_are_within_four_times_what_a_last_digit_does() {
    let cases = cases();
    assert_eq!(cases.len(), 780);
    let mut medians = std::collections::BTreeMap::<&str, Vec<f64>>::new();
    for c in &cases {
        let (r, v) = propagate_raw(c.gm, c.r, c.v, c.dt);
        // The states in the table are rounded themselves: half a digit of each component.
        let ratio = [off(r, c.r_after) / c.floor[0], off(v, c.v_after) / c.floor[1]];
        assert!(ratio[0] < 2.0 && ratio[1] < 4.0, "{}: {ratio:?} floors", c.regime);
        medians.entry(c.regime).or_default().push(ratio[0]);
    }
    assert_eq!(medians.len(), 13);
    for (regime, mut ratios) in medians {
        ratios.sort_by(f64::total_cmp);
        let median = ratios[ratios.len() / 2];
        assert!(median < 0.8, "{regime}: median {median}");
    }
}

#[test]
fn a_batch_and_a_kept_conic_give_the_bits_of_one_at_a_time() {
    let cases = cases();
    let column = |f: fn(&Case) -> f64| cases.iter().map(f).collect::<Vec<f64>>();
    let (gm, dt) = (column(|c| c.gm), column(|c| c.dt));
    let (x, y, z) = (column(|c| c.r.x), column(|c| c.r.y), column(|c| c.r.z));
    let (u, v, w) = (column(|c| c.v.x), column(|c| c.v.y), column(|c| c.v.z));
    // A length that is no whole number of blocks, and starts that the batch must set apart.
    let n = cases.len() - 7;
    for odd in [None, Some(0.0), Some(f64::NAN), Some(-1.0), Some(1e300), Some(f64::INFINITY)] {
        let mut gm = gm.clone();
        if let Some(odd) = odd {
            gm.iter_mut().step_by(3).for_each(|g| *g = odd);
        }
        let mut out = vec![(DVec3::ZERO, DVec3::ZERO); n];
        propagate_many(&Starts { gm: &gm, r: [&x, &y, &z], v: [&u, &v, &w], dt_s: &dt }, &mut out);
        for (k, (c, out)) in cases.iter().zip(&out).enumerate() {
            let one = propagate_raw(gm[k], c.r, c.v, c.dt);
            let bits = |(r, v): (DVec3, DVec3)| [r.to_array(), v.to_array()].map(|a| a.map(f64::to_bits));
            assert_eq!(bits(*out), bits(one), "{} with gm {}", c.regime, gm[k]);
            assert_eq!(bits(Conic::new(gm[k], c.r, c.v).after_raw(c.dt)), bits(one), "{}", c.regime);
        }
    }
}

#[test]
fn there_and_back_is_as_near_as_the_last_digits_allow() {
    // A return to a pericentre of 1e-12 is another matter: there a last digit of the state on the way is all.
    for c in cases().iter().filter(|c| !c.regime.starts_with("start at pericentre")) {
        let (r, v) = propagate_raw(c.gm, c.r, c.v, c.dt);
        let back = propagate_raw(c.gm, r, v, -c.dt);
        // What the rounding of the state on the way, half a digit of each vector in each direction, may do to the way back.
        let mut floor = [2.3e-16, 2.3e-16];
        for k in 0..6 {
            let (mut p, mut q) = (r, v);
            if k < 3 {
                p[k] += f64::EPSILON * r.length();
            } else {
                q[k - 3] += f64::EPSILON * v.length();
            }
            let other = propagate_raw(c.gm, p, q, -c.dt);
            floor = [floor[0] + 0.5 * off(other.0, back.0), floor[1] + 0.5 * off(other.1, back.1)];
        }
        let ratio = [off(back.0, c.r) / floor[0], off(back.1, c.v) / floor[1]];
        assert!(ratio[0] < 8.0 && ratio[1] < 8.0, "{}: {ratio:?} of what may be", c.regime);
    }
}
