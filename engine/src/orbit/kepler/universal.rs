//! The universal functions G₀…G₃ of an orbit: sines and cosines of an ellipse, powers on a parabola, hyperbolic beyond.
//!
//! Not here: the equation that they stand in (`conic`).
//!
//! - [Battin 1999] "An Introduction to the Mathematics and Methods of Astrodynamics", §4.5–4.8 (universal functions).
//! - [Stumpff 1959] "Himmelsmechanik I", §41 (the series c₂, c₃ and their doubling).

/// The universal functions at one s: G₀ = cos √β s, G₁ = ∫G₀, G₂ = ∫G₁, G₃ = ∫G₂ [Battin 1999, §4.5].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Universal {
    pub(crate) g0: f64,
    pub(crate) g1: f64,
    pub(crate) g2: f64,
    pub(crate) g3: f64,
}

/// |βs²| up to which the series serve alone, and with one doubling.
pub(super) const PLAIN: f64 = 5.0625;
pub(super) const DOUBLED: f64 = 4.0 * PLAIN;

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

/// Σ (−x)ᵏ c[k], even and odd powers apart, so that the processor runs both at once.
#[inline(always)]
fn alternating(c: &[f64; 12], x: f64, xx: f64) -> f64 {
    let even = c[2] + xx * (c[4] + xx * (c[6] + xx * (c[8] + xx * c[10])));
    let odd = c[1] + xx * (c[3] + xx * (c[5] + xx * (c[7] + xx * (c[9] + xx * c[11]))));
    c[0] - x * (odd - x * even)
}

impl Universal {
    /// At any β and s, overflow held off (|√−β s| is taken as 700 at most).
    pub(crate) fn at(beta: f64, s: f64) -> Self {
        let x = beta * s * s;
        if x.abs() <= DOUBLED {
            Self::near(beta, s)
        } else if x > 0.0 {
            Self::turning(beta, s)
        } else {
            Self::far(beta, s)
        }
    }

    /// By series, for |βs²| ≤ [`DOUBLED`]: at s, or at s/2 and doubled, where nothing cancels for √β s < 2π.
    #[inline(always)]
    pub(super) fn near(beta: f64, s: f64) -> Self {
        let whole = beta * s * s;
        let plain = whole.abs() <= PLAIN;
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
    #[inline(always)]
    pub(super) fn far(beta: f64, s: f64) -> Self {
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

/// eˣ for 0 ≤ x ≤ 700, within 1 ulp: x = k ln 2 + r, and the Taylor series of eʳ [Cody & Waite 1980].
#[inline(always)]
pub(super) fn exponential(x: f64) -> f64 {
    // Adding 3·2⁵¹ rounds to a whole number, which then stands in the low bits.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    const LN2_HI: f64 = 6.931_471_803_691_238e-1;
    const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;
    let shifted = x * core::f64::consts::LOG2_E + SHIFT;
    let k = shifted - SHIFT;
    let r = (x - k * LN2_HI) - k * LN2_LO;
    let rr = r * r;
    let even = C2[0] + rr * (C2[1] + rr * (C2[2] + rr * (C2[3] + rr * (C2[4] + rr * C2[5]))));
    let odd = C3[0] + rr * (C3[1] + rr * (C3[2] + rr * (C3[3] + rr * (C3[4] + rr * C3[5]))));
    let e = 1.0 + (r + rr * (even + r * odd));
    e * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}
