//! The universal functions G₀…G₃ of an orbit: sines and cosines of an ellipse, powers on a parabola, hyperbolic beyond.
//!
//! Not here: the equation that they stand in (`conic`).
//!
//! - [Battin 1999] "An Introduction to the Mathematics and Methods of Astrodynamics", §4.5–4.8 (universal functions).
//! - [Cody & Waite 1980] "Software Manual for the Elementary Functions", ch. 6 (the exponential).
//! - [Stumpff 1959] "Himmelsmechanik I", §41 (the series c₂, c₃ and their doubling).

use super::pair::{Pair, ordered_sum};
use super::real::Real;

/// The universal functions at one s: G₀ = cos √β s, G₁ = ∫G₀, G₂ = ∫G₁, G₃ = ∫G₂ [Battin 1999, §4.5].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Universal<T = f64> {
    pub(crate) g0: T,
    pub(crate) g1: T,
    pub(crate) g2: T,
    pub(crate) g3: T,
}

/// x = βs² up to which the series serve alone (cos and cosh then stay of one size), and four times that with one doubling:
/// enough for the 4.43 rad that half a revolution can take.
const PLAIN: f64 = 5.0625;
const PLAIN_BELOW: f64 = -4.0;
const FARTHEST: f64 = 4.0 * PLAIN_BELOW;

fn is_plain(x: f64) -> bool {
    (PLAIN_BELOW..=PLAIN).contains(&x)
}

/// 1/(2k + 2)! and 1/(2k + 3)!, k = 0 …: twelve leave 1e-18 at |x| = 5.1.
const C2: [f64; 12] = inverse_factorials(2);
const C3: [f64; 12] = inverse_factorials(3);

const fn inverse_factorials(first: usize) -> [f64; 12] {
    let mut table = [0.0; 12];
    let (mut k, mut product, mut n) = (0, 1.0_f64, 1);
    while k < 12 {
        while n <= first + 2 * k {
            // Exact to 22!, and rounding beyond that is of terms below 1e-17.
            product *= n as f64;
            n += 1;
        }
        table[k] = 1.0 / product;
        k += 1;
    }
    table
}

/// What 1/3! lacks as f64, and 1/4!, 1/5! in two words.
const C3_LO: f64 = 9.251_858_538_542_97e-18;
const C2_SECOND: Pair = Pair { hi: 0.041666666977107525, lo: -3.104408582051595e-10 };
const C3_SECOND: Pair = Pair { hi: 0.008333333302289248, lo: 3.104408582051595e-11 };

/// Σ (−x)ᵏ c[k], even and odd powers apart, so that the processor runs both at once.
fn alternating(c: &[f64; 12], x: f64, xx: f64) -> f64 {
    let even = c[2] + xx * (c[4] + xx * (c[6] + xx * (c[8] + xx * c[10])));
    let odd = c[1] + xx * (c[3] + xx * (c[5] + xx * (c[7] + xx * (c[9] + xx * c[11]))));
    c[0] - x * (odd - x * even)
}

impl Universal {
    /// At any β and s, overflow held off (|√−β s| is taken as 700 at most).
    pub(crate) fn at(beta: f64, s: f64) -> Self {
        let x = beta * s * s;
        if (FARTHEST..=4.0 * PLAIN).contains(&x) {
            Self::near(beta, s)
        } else if x > 0.0 {
            Self::turning(beta, s)
        } else {
            Self::far(beta, s)
        }
    }

    /// By series, for −16 ≤ βs² ≤ 20.25: at s, or at s/2 and doubled, where nothing cancels for √β s < 2π.
    fn near(beta: f64, s: f64) -> Self {
        let whole = beta * s * s;
        let plain = is_plain(whole);
        let h = if plain { s } else { 0.5 * s };
        let x = if plain { whole } else { 0.25 * whole };
        let (xx, hh) = (x * x, h * h);
        let c2 = alternating(&C2, x, xx);
        let c3 = alternating(&C3, x, xx);
        let (g0, g1, g2, g3) = (1.0 - x * c2, h - h * (x * c3), hh * c2, hh * (h * c3));
        // [Stumpff 1959, §41] G₃(2h) = 2(G₃ + G₁G₂), G₂(2h) = 2G₁², G₁(2h) = 2G₀G₁.
        let twice = 2.0 * g1 * g1;
        let (d0, d1, d2, d3) = (1.0 - beta * twice, 2.0 * g0 * g1, twice, 2.0 * (g3 + g1 * g2));
        Self {
            g0: if plain { g0 } else { d0 },
            g1: if plain { g1 } else { d1 },
            g2: if plain { g2 } else { d2 },
            g3: if plain { g3 } else { d3 },
        }
    }

    /// By sines of the half angle: an ellipse, more than half a turn away.
    fn turning(beta: f64, s: f64) -> Self {
        let root = beta.sqrt();
        let (sin, cos) = libm::sincos(0.5 * root * s);
        let g1 = 2.0 * sin * cos / root;
        Self { g0: 1.0 - 2.0 * sin * sin, g1, g2: 2.0 * sin * sin / beta, g3: (s - g1) / beta }
    }

    /// By the exponential: a hyperbola, where G₃ no longer cancels.
    fn far(beta: f64, s: f64) -> Self {
        let root = (-beta).sqrt();
        let inverse = 1.0 / root;
        let grown = 0.5 * exponential((root * s.abs()).min(700.0));
        let shrunk = 0.25 / grown;
        let cosh = grown + shrunk;
        let g1 = ((grown - shrunk) * inverse).copysign(s);
        let square = inverse * inverse;
        Self { g0: cosh, g1, g2: (cosh - 1.0) * square, g3: (g1 - s) * square }
    }
}

impl<T: Real> Universal<T> {
    /// By short series, for |βs²| ≤ 0.01.
    #[inline(always)]
    pub(super) fn short(beta: T, s: T) -> Self {
        let ss = s * s;
        let x = beta * ss;
        let c2 = s.all(0.5) - x * (s.all(1.0 / 24.0) - x * (s.all(1.0 / 720.0) - x * (1.0 / 40_320.0)));
        let c3 = s.all(1.0 / 6.0) - x * (s.all(1.0 / 120.0) - x * (s.all(1.0 / 5040.0) - x * (1.0 / 362_880.0)));
        Self { g0: s.all(1.0) - x * c2, g1: s - s * (x * c3), g2: ss * c2, g3: ss * (s * c3) }
    }

    /// The functions a tiny `d` further on.
    #[inline(always)]
    pub(super) fn moved(&self, beta: T, d: T) -> Self {
        let half = d * 0.5;
        Self {
            g0: self.g0 - beta * (d * (self.g1 + half * self.g0)),
            g1: self.g1 + d * (self.g0 - half * (beta * self.g1)),
            g2: self.g2 + d * (self.g1 + half * self.g0),
            g3: self.g3 + d * (self.g2 + half * self.g1),
        }
    }
}

/// The universal functions to about 58 bits: for the last step, where an orbit's geometry would multiply their rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact<T = f64> {
    pub(super) g0: T,
    pub(super) g1: Pair<T>,
    pub(super) g2: Pair<T>,
    pub(super) g3: Pair<T>,
}

/// Σ (−x)ᵏ c[k]: the first two terms exactly, the others, which are small, plainly.
#[inline(always)]
fn exact_series<T: Real>(c: &[f64; 12], first_lo: f64, second: Pair, x: Pair<T>) -> Pair<T> {
    let whole = x.value();
    let xx = whole * whole;
    let even = xx * (xx * (xx * (xx * c[10] + c[8]) + c[6]) + c[4]) + c[2];
    let odd = xx * (xx * (xx * (xx * c[11] + c[9]) + c[7]) + c[5]) + c[3];
    let (p, e) = x.product(Pair::all(whole, second));
    let (t, f) = ordered_sum(whole.all(c[0]), -p);
    let (u, g) = ordered_sum(t, xx * (even - whole * odd));
    Pair::new(u, ((f + g) + first_lo) - e)
}

impl<T: Real> Exact<T> {
    /// At any β and s, but for √β s beyond 4.5; `s` has no more than 26 bits.
    #[inline(always)]
    pub(super) fn at(beta: Pair<T>, s: T) -> Self {
        let x = beta.value() * (s * s);
        let near = s.all(FARTHEST).at_most(x);
        if s.every(near) {
            return Self::near(beta, s, x);
        }
        let far = Self::far(beta, s);
        if !s.any(near) {
            return far;
        }
        Self::pick(near, Self::near(beta, s, x), far)
    }

    #[inline(always)]
    fn pick(mask: T::Mask, a: Self, b: Self) -> Self {
        Self {
            g0: T::pick(mask, a.g0, b.g0),
            g1: Pair::pick(mask, a.g1, b.g1),
            g2: Pair::pick(mask, a.g2, b.g2),
            g3: Pair::pick(mask, a.g3, b.g3),
        }
    }

    /// As [`Universal::near`].
    #[inline(always)]
    fn near(beta: Pair<T>, s: T, x: T) -> Self {
        let plain = s.both(s.all(PLAIN_BELOW).at_most(x), x.at_most(s.all(PLAIN)));
        let h = T::pick(plain, s, s * 0.5);
        let hh = Pair::of(h * h);
        let x = beta.times(hh);
        let (c2, c3) = (exact_series(&C2, 0.0, C2_SECOND, x), exact_series(&C3, C3_LO, C3_SECOND, x));
        let g2 = hh.times(c2);
        let w = hh.times(c3);
        let g3 = Pair::new(h * w.hi, h * w.lo);
        // G₁ = s − βG₃, G₀ = 1 − βG₂.
        let (t, f) = beta.product_from(h, g3);
        let g1 = Pair::new(t, f);
        let (t, f) = beta.product_from(s.all(1.0), g2);
        let single = Self { g0: t + f, g1, g2, g3 };
        if s.every(plain) {
            return single;
        }
        let square = g1.times(g1).scaled(2.0);
        let double = Self {
            g0: s.all(1.0) - beta.value() * square.value(),
            g1: Pair::settled(t, f).times(g1).scaled(2.0),
            g2: square,
            g3: g3.plus(g1.times(g2)).scaled(2.0),
        };
        Self::pick(plain, single, double)
    }

    /// As [`Universal::far`]. The exponential is taken as it comes, which moves all by less than a digit of s; only G₃ sees s
    /// itself, and there s is small beside G₁.
    #[inline(always)]
    fn far(beta: Pair<T>, s: T) -> Self {
        let b = beta.scaled(-1.0);
        let (root, inverse) = b.root();
        let grown = exponential((root.value() * s.abs()).min(s.all(700.0))) * 0.5;
        let shrunk = s.all(0.25) / grown;
        let square = inverse * inverse;
        let (cosh, cosh_lo) = ordered_sum(grown, shrunk);
        let (sinh, sinh_lo) = ordered_sum(grown, -shrunk);
        let side = s.all(1.0).signed(s);
        let g1 = Pair::new(side * sinh, side * sinh_lo).over(root, inverse);
        let (up, up_lo) = ordered_sum(cosh, s.all(-1.0));
        Self { g0: cosh, g1, g2: Pair::new(up, up_lo + cosh_lo).over(b, square), g3: g1.plus(Pair::of(-s)).over(b, square) }
    }

    /// Rounded.
    #[inline(always)]
    pub(super) fn rounded(&self) -> Universal<T> {
        Universal { g0: self.g0, g1: self.g1.value(), g2: self.g2.value(), g3: self.g3.value() }
    }
}

/// eˣ for 0 ≤ x ≤ 700, within 1 ulp: x = k ln 2 + r, and the Taylor series of eʳ [Cody & Waite 1980].
#[inline(always)]
fn exponential<T: Real>(x: T) -> T {
    // Adding 3·2⁵¹ rounds to a whole number, which then stands in the low bits.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    const LN2_HI: f64 = 6.931_471_803_691_238e-1;
    const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;
    let shifted = x * core::f64::consts::LOG2_E + SHIFT;
    let k = shifted - SHIFT;
    let r = (x - k * LN2_HI) - k * LN2_LO;
    let rr = r * r;
    let even = rr * (rr * (rr * (rr * (rr * C2[5] + C2[4]) + C2[3]) + C2[2]) + C2[1]) + C2[0];
    let odd = rr * (rr * (rr * (rr * (rr * C3[5] + C3[4]) + C3[3]) + C3[2]) + C3[1]) + C3[0];
    let e = (r + rr * (even + r * odd)) + 1.0;
    e * shifted.map(|k| f64::from_bits(k.to_bits().wrapping_add(1023) << 52))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_within_a_digit() {
        for k in 0..=7000 {
            let x = 0.1 * f64::from(k);
            let exact = libm::exp(x);
            assert!((exponential(x) - exact).abs() <= 2.3e-16 * exact, "{x}");
        }
    }

    #[test]
    fn the_functions_are_those_of_the_circle_and_the_hyperbola() {
        for k in 1..=44 {
            let s = 0.1 * f64::from(k);
            let (circle, hyperbola) = (Universal::at(1.0, s), Universal::at(-1.0, s));
            for (got, exact) in [
                (circle.g0, libm::cos(s)),
                (circle.g1, libm::sin(s)),
                (circle.g2, 2.0 * libm::sin(0.5 * s) * libm::sin(0.5 * s)),
                (hyperbola.g0, libm::cosh(s)),
                (hyperbola.g1, libm::sinh(s)),
                (hyperbola.g2, 2.0 * libm::sinh(0.5 * s) * libm::sinh(0.5 * s)),
            ] {
                assert!((got - exact).abs() < 1e-15 * exact.abs().max(1.0), "s = {s}: {got} for {exact}");
            }
            // On a parabola they are powers.
            let parabola = Universal::at(0.0, s);
            assert!(parabola.g0 == 1.0 && parabola.g1 == s && (parabola.g3 - s * s * s / 6.0).abs() < 3e-16 * s * s * s);
        }
    }

    #[test]
    fn the_exact_ones_agree_and_satisfy_their_identities_beyond_an_f64() {
        for x in [-900.0, -30.0, -15.0, -3.0, -1e-3, 1e-9, 0.5, 5.0, 12.0, 20.0] {
            for s in [0.625, -1.5] {
                let beta = Pair::of(x / (s * s));
                let (exact, plain) = (Exact::at(beta, s), Universal::at(beta.value(), s));
                let rounded = exact.rounded();
                for (a, b) in [(rounded.g1, plain.g1), (rounded.g2, plain.g2), (rounded.g3, plain.g3)] {
                    assert!((a - b).abs() < 2e-15 * b.abs().max(1e-3), "x = {x}: {a} {b}");
                }
                // βG₂² = 2G₂ − G₁², to 2⁻⁵⁵ of its terms.
                let (g1, g2) = (exact.g1, exact.g2);
                let left = g1.times(g1).plus(beta.times(g2).times(g2)).plus(g2.scaled(-2.0));
                let size = g1.value() * g1.value() + 2.0 * g2.value().abs();
                assert!(left.value().abs() < 2.7e-17 * size, "x = {x}, s = {s}: {:e}", left.value() / size);
            }
        }
    }
}
