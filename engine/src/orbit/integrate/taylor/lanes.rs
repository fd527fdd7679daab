//! Lanes: four numbers at a time, one word or two. Plain arrays that the compiler turns into vector instructions, so that a machine with
//! vectors and one without compute the same bits: no fused multiply-add, no reciprocal estimates, one fixed order of additions.
//!
//! A two-word number is an unevaluated sum of a value and a much smaller one: about 32 digits, for the few operations whose rounding
//! would otherwise be the largest error of a step.
//!
//! Not here: what the numbers mean ([`super::pairs`], [`super::centre`]).
//! - [Dekker 1971] "A floating-point technique for extending the available precision", Numerische Mathematik 18.
//! - [Knuth 1997] "The Art of Computer Programming", vol. 2, §4.2.2, theorem B (the error of a sum).

/// Four lanes.
pub(super) type V = [f64; 4];

/// Four lanes of two words each: high, low.
pub(super) type W = (V, V);

pub(super) const ZERO: V = [0.0; 4];

#[inline(always)]
pub(super) fn map(a: V, f: impl Fn(f64) -> f64) -> V {
    [f(a[0]), f(a[1]), f(a[2]), f(a[3])]
}

#[inline(always)]
fn zip(a: V, b: V, f: impl Fn(f64, f64) -> f64) -> V {
    [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])]
}

#[inline(always)]
pub(super) fn add(a: V, b: V) -> V {
    zip(a, b, |a, b| a + b)
}

#[inline(always)]
pub(super) fn sub(a: V, b: V) -> V {
    zip(a, b, |a, b| a - b)
}

#[inline(always)]
pub(super) fn mul(a: V, b: V) -> V {
    zip(a, b, |a, b| a * b)
}

#[inline(always)]
pub(super) fn scale(a: V, b: f64) -> V {
    map(a, |a| a * b)
}

/// a·b + c, each operation rounded.
#[inline(always)]
pub(super) fn mul_then_add(a: V, b: V, c: V) -> V {
    add(mul(a, b), c)
}

#[inline(always)]
pub(super) fn load(from: &[f64], at: usize) -> V {
    match from.get(at..at + 4) {
        Some(&[a, b, c, d]) => [a, b, c, d],
        _ => ZERO,
    }
}

#[inline(always)]
pub(super) fn store(v: V, to: &mut [f64], at: usize) {
    if let Some(to) = to.get_mut(at..at + 4) {
        to.copy_from_slice(&v);
    }
}

/// The upper 26 bits of the significand: what is left out fits 27, so that products of the parts are exact [Dekker 1971].
#[inline(always)]
fn upper(a: V) -> V {
    map(a, |a| f64::from_bits(a.to_bits() & 0xffff_ffff_f800_0000))
}

/// Sum and its exact rounding error [Knuth 1997].
#[inline(always)]
pub(super) fn two_sum(a: V, b: V) -> W {
    let s = add(a, b);
    let t = sub(s, a);
    (s, add(sub(a, sub(s, t)), sub(b, t)))
}

/// The same where |a| ≥ |b| in every lane.
#[inline(always)]
pub(super) fn quick_two_sum(a: V, b: V) -> W {
    let s = add(a, b);
    (s, sub(b, sub(s, a)))
}

/// Product and its rounding error.
#[inline(always)]
pub(super) fn two_product(a: V, b: V) -> W {
    let p = mul(a, b);
    let (ah, bh) = (upper(a), upper(b));
    let (al, bl) = (sub(a, ah), sub(b, bh));
    let e = add(sub(mul(ah, bh), p), add(mul(ah, bl), mul(al, bh)));
    (p, add(e, mul(al, bl)))
}

#[inline(always)]
pub(super) fn add2(a: W, b: W) -> W {
    let (s, e) = two_sum(a.0, b.0);
    quick_two_sum(s, add(e, add(a.1, b.1)))
}

#[inline(always)]
pub(super) fn sub2(a: W, b: W) -> W {
    add2(a, (map(b.0, |x| -x), map(b.1, |x| -x)))
}

#[inline(always)]
pub(super) fn mul2(a: W, b: W) -> W {
    let (p, e) = two_product(a.0, b.0);
    quick_two_sum(p, add(e, add(mul(a.0, b.1), mul(a.1, b.0))))
}

/// Two words times one.
#[inline(always)]
pub(super) fn mul21(a: W, b: V) -> W {
    let (p, e) = two_product(a.0, b);
    quick_two_sum(p, add(e, mul(a.1, b)))
}

/// a^(−3/2) in two words: the rounded value, then one Newton step on y²a³ = 1 with the residual in two words.
#[inline(always)]
pub(super) fn inverse_three_halves(a: W) -> W {
    let y = map(a.0, |a| 1.0 / (a * a.sqrt()));
    // y²a³ grows and shrinks by parts, so that no product leaves the range of f64: (y a)² a.
    let ya = mul21(a, y);
    let one = mul2(mul2(ya, ya), a);
    let residual = sub(map(one.0, |x| 1.0 - x), one.1);
    quick_two_sum(y, mul(scale(y, 0.5), residual))
}
