//! Roots of a polynomial on the unit interval: every one, in order, none jumped over.
//!
//! In Bernstein's form a polynomial has no more roots than its coefficients change sign, and none or one are exact
//! [Farouki 2012, §4.2]; where there are more changes the interval is halved. A pair of roots that lies closer together than
//! rounding (some 1e-15 of the greatest coefficient) may be found or not; anything wider is found.
//! Not here: of what ([`super::step`] for the end of a step, [`crate::orbit::predict::marks`]).
//! - [Farouki 2012] "The Bernstein polynomial basis: a centennial retrospective", Comput. Aided Geom. Des. 29, 379.

use super::series::{LEN, ORDER, Scalar, index};

/// Halvings after which what is left is one place to rounding.
const DEPTH: u32 = 52;

/// A root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Where, 0 … 1.
    pub at: f64,
    /// The polynomial grows through it.
    pub rising: bool,
}

/// The coefficients over `0 … span` rather than in units of the variable.
pub fn over(a: &Scalar, span: f64) -> Scalar {
    let mut scaled = *a;
    let mut power = 1.0;
    for c in &mut scaled {
        *c *= power;
        power *= span;
    }
    scaled
}

/// Derivative.
pub fn slope(a: &Scalar) -> Scalar {
    let mut d = [0.0; LEN];
    for k in 1..LEN {
        d[k - 1] = a[k] * index(k);
    }
    d
}

/// Horner's rule.
pub fn at(a: &Scalar, t: f64) -> f64 {
    a.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// The roots in (0, 1], in order, into `found`. A value of exactly 0 counts as positive, so that each root is a change of sign.
pub fn all(a: &Scalar, found: &mut Vec<Root>) {
    walk(a, &bernstein(a), 0.0, 1.0, DEPTH, &mut |root| {
        found.push(root);
        false
    });
}

/// The first root in (0, 1] through which the polynomial grows (or falls).
pub fn first(a: &Scalar, rising: bool) -> Option<f64> {
    if cannot_vanish(a) {
        return None;
    }
    let mut first = None;
    walk(a, &bernstein(a), 0.0, 1.0, DEPTH, &mut |root| {
        if root.rising == rising {
            first = Some(root.at);
        }
        first.is_some()
    });
    first
}

/// The cheap test that nearly always suffices: the first coefficient outweighs all others.
pub fn cannot_vanish(a: &Scalar) -> bool {
    a[0].abs() > a[1..].iter().map(|c| c.abs()).sum()
}

/// To Bernstein's basis of the same degree: `b_j = Σ C(j,i)/C(n,i) a_i`, by additions alone after the division.
fn bernstein(a: &Scalar) -> Scalar {
    let mut b = *a;
    let mut choose = 1.0;
    for (i, c) in b.iter_mut().enumerate() {
        *c /= choose;
        choose *= (index(ORDER) - index(i)) / (index(i) + 1.0);
        if i == ORDER {
            break;
        }
    }
    for from in 1..LEN {
        for i in (from..LEN).rev() {
            b[i] += b[i - 1];
        }
    }
    b
}

/// Visits the roots in [low, high] in order until `visit` says that it is enough; true then.
fn walk(a: &Scalar, b: &Scalar, low: f64, high: f64, depth: u32, visit: &mut impl FnMut(Root) -> bool) -> bool {
    let negative = |c: f64| c < 0.0;
    let changes = b.windows(2).filter(|w| negative(w[0]) != negative(w[1])).count();
    let crosses = negative(b[0]) != negative(b[ORDER]);
    if changes == 0 {
        return false;
    }
    if changes == 1 || depth == 0 {
        return crosses && visit(Root { at: refine(a, low, high, negative(b[0])), rising: negative(b[0]) });
    }
    // de Casteljau at one half: convex combinations only.
    let (mut left, mut right) = (*b, *b);
    for (n, first) in left.iter_mut().enumerate().skip(1) {
        for i in 0..LEN - n {
            right[i] = 0.5 * (right[i] + right[i + 1]);
        }
        *first = right[0];
    }
    let middle = 0.5 * (low + high);
    walk(a, &left, low, middle, depth - 1, visit) || walk(a, &right, middle, high, depth - 1, visit)
}

/// The one change of sign between two places, by bisection; the far side of it.
fn refine(a: &Scalar, mut low: f64, mut high: f64, begins_negative: bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (at(a, middle) < 0.0) == begins_negative {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_roots(roots: &[f64]) -> Scalar {
        let mut a = [0.0; LEN];
        a[0] = 1.0;
        for (n, root) in roots.iter().enumerate() {
            for k in (0..=n + 1).rev() {
                a[k] = if k > 0 { a[k - 1] } else { 0.0 } - root * a[k];
            }
        }
        a
    }

    #[test]
    fn every_root_is_found_once_and_in_order() {
        for roots in [&[0.5][..], &[0.1, 0.2, 0.9], &[0.3, 0.300_001], &[-0.5, 0.25, 2.0, 0.75], &[1e-9, 0.4], &[0.999_999_9]] {
            let mut found = Vec::new();
            all(&of_roots(roots), &mut found);
            let mut inside: Vec<f64> = roots.iter().copied().filter(|r| (0.0..=1.0).contains(r)).collect();
            inside.sort_by(f64::total_cmp);
            assert_eq!(found.len(), inside.len(), "{roots:?}: {found:?}");
            for (f, r) in found.iter().zip(&inside) {
                assert!((f.at - r).abs() < 1e-9, "{roots:?}: {found:?}");
            }
            assert!(found.windows(2).all(|w| w[0].rising != w[1].rising));
        }
    }

    #[test]
    fn a_dip_of_a_part_in_1e14_is_seen_and_a_gap_of_the_same_is_none() {
        // (t − 0.37)² ∓ 1e-14: two roots 2e-7 apart, or none.
        let mut a = [0.0; LEN];
        (a[0], a[1], a[2]) = (0.37 * 0.37 - 1e-14, -0.74, 1.0);
        assert!((first(&a, false).expect("dips") - (0.37 - 1e-7)).abs() < 2e-9);
        assert!((first(&a, true).expect("comes back") - (0.37 + 1e-7)).abs() < 2e-9);
        a[0] += 2e-14;
        assert_eq!(first(&a, false), None);
    }

    #[test]
    fn scaling_and_slope_are_those_of_polynomials() {
        let a = of_roots(&[0.2, 0.6]);
        assert!((at(&over(&a, 0.5), 0.4)).abs() < 1e-16 && (at(&slope(&a), 0.4)).abs() < 1e-16);
        assert!(cannot_vanish(&of_roots(&[3.0])) && !cannot_vanish(&a));
    }
}
