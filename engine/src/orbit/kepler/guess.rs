//! First guesses for the universal anomaly, good to a few per cent: two steps of the solver then reach rounding.
//!
//! Their quality costs steps, never the answer; so short series serve for arcs and logarithms.
//!
//! - [Markley 1995] "Kepler equation solver", Celest. Mech. Dyn. Astron. 63, 101: a Padé approximant of the sine turns
//!   Kepler's equation into a cubic. Written here in σ = E/√β, where the same cubic holds for every conic.
//! - [Danby 1988] "Fundamentals of Celestial Mechanics", §6.9 (the logarithm on a hyperbola).

use core::f64::consts::{FRAC_PI_2, LN_2, PI, SQRT_2};

/// What the guess needs to know of an orbit, scaled to about 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) mu: f64,
    pub(super) distance: f64,
    pub(super) inverse_distance: f64,
    pub(super) eta: f64,
    pub(super) beta: f64,
    pub(super) zeta: f64,
    /// Infinite on open orbits.
    pub(super) period: f64,
    /// h², the square of angular momentum.
    pub(super) moment: f64,
}

/// The orbit as seen from its pericentre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pericentre {
    /// μe.
    mu_e: f64,
    /// Pericentre distance.
    q: f64,
    /// 1/(1 + e).
    flatness: f64,
    /// √|β|, held off zero.
    root: f64,
    /// s and time since pericentre at the start.
    sigma: f64,
    time: f64,
}

/// atan x for |x| ≤ 1, within 2e-6.
#[inline(always)]
fn short_atan(x: f64) -> f64 {
    let y = x * x;
    x * (0.999_977_26 + y * (-0.332_623_47 + y * (0.193_543_46 + y * (-0.116_432_87 + y * (0.052_653_32 - y * 0.011_721_20)))))
}

/// ln x for normal x > 0, within 2e-6.
#[inline(always)]
fn short_log(x: f64) -> f64 {
    const MANTISSA: u64 = (1 << 52) - 1;
    const ONE: u64 = 1023 << 52;
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    let bits = x.to_bits();
    let m = f64::from_bits((bits & MANTISSA) | ONE);
    // The exponent as a number, by way of the low bits of 2⁵² + k.
    let k = f64::from_bits((bits >> 52) | SHIFT.to_bits()) - (SHIFT + 1023.0);
    let z = (m - SQRT_2) / (m + SQRT_2);
    let zz = z * z;
    (k + 0.5) * LN_2 + z * (2.0 + zz * (2.0 / 3.0 + zz * (2.0 / 5.0 + zz * (2.0 / 7.0))))
}

/// ∛x for normal x > 0, within 1e-5.
#[inline(always)]
fn short_cbrt(x: f64) -> f64 {
    // A third of the bits is a third of the exponent, and a line for the mantissa; one step of Halley's.
    let y = f64::from_bits((f64::from_bits(x.to_bits()).to_bits() / 3).wrapping_add(0x2A9F_7893_0000_0000));
    let cube = y * y * y;
    y * (cube + 2.0 * x) / (2.0 * cube + x)
}

impl Shape {
    /// s after a time `dt` in which the orbit bends little, from the series of t(s) turned round; and how much it bends.
    #[inline(always)]
    pub(super) fn nearby(&self, dt: f64) -> (f64, f64) {
        let y = dt * self.inverse_distance;
        let a = self.eta * self.inverse_distance * y;
        let b = self.zeta * self.inverse_distance * (y * y);
        let bend = a.abs().max(b.abs()).max((0.3 * self.beta * y * y).abs());
        (y * (1.0 - 0.5 * (a - (a * a - b * (1.0 / 3.0)))), bend)
    }

    pub(super) fn pericentre(&self) -> Pericentre {
        let mu_e = (self.mu * self.mu - self.beta * self.moment).max(0.0).sqrt();
        let flat = 1.0 / (self.mu + mu_e);
        let root = self.beta.abs().sqrt().max(1e-90);
        let across = self.eta * root;
        let steep = across.abs() > self.zeta.abs();
        let arc = if self.beta >= 0.0 {
            let z = if steep { self.zeta / across } else { across / self.zeta.abs().max(1e-290) };
            let arc = short_atan(z);
            let quarter = FRAC_PI_2.copysign(across);
            if steep {
                quarter - arc
            } else if self.zeta < 0.0 {
                2.0 * quarter - arc
            } else {
                arc
            }
        } else {
            let w = (across / mu_e).abs().min(1e290);
            if w < 0.5 {
                let z = across / self.zeta;
                let y = z * z;
                z * (1.0 + y * (1.0 / 3.0 + y * (1.0 / 5.0 + y * (1.0 / 7.0 + y * (1.0 / 9.0 + y * (1.0 / 11.0))))))
            } else {
                short_log(w + (w.min(1e150) * w.min(1e150) + 1.0).sqrt()).copysign(across)
            }
        };
        let sigma = arc / root;
        let q = self.moment * flat;
        let x = arc.abs().copysign(self.beta) * arc.abs();
        let time = if x.abs() < 0.25 {
            sigma * (q + mu_e * (sigma * sigma) * (1.0 / 6.0 - x * (1.0 / 120.0 - x * (1.0 / 5040.0))))
        } else {
            (self.mu * sigma - self.eta) / self.beta
        };
        Pericentre { mu_e, q, flatness: self.mu * flat, root, sigma, time }
    }

    /// s after a time `dt` on any part of the orbit.
    pub(super) fn around(&self, p: &Pericentre, dt: f64) -> f64 {
        let mut t = p.time + dt;
        let mut turns = 0.0;
        let mut alpha = 10.6;
        if self.beta > 0.0 {
            if t.abs() > 0.5 * self.period {
                turns = (2.0 * PI / p.root).copysign(t);
                t -= self.period.copysign(t);
            }
            // [Markley 1995, eq. 20], with M/π as a part of half a period.
            let part = (2.0 * t / self.period).abs();
            const SQUARE: f64 = PI * PI;
            alpha = (3.0 * SQUARE + 1.6 * SQUARE * (1.0 - part) * p.flatness) * (1.0 / (SQUARE - 6.0));
        } else {
            // z = N/e = sinh F − F/e.
            let z = (p.root * p.root * p.root * t / p.mu_e).abs().min(1e290);
            if z > 2.0 {
                // [Danby 1988, §6.9], and once round the fixed point F = asinh((N + F)/e).
                let w = z + short_log(2.0 * z + 1.8) * (self.mu / p.mu_e);
                let w = w.min(1e290);
                let f = short_log(w + (w.min(1e150) * w.min(1e150) + 1.0).sqrt());
                return f.copysign(t) / p.root - p.sigma;
            }
        }
        // [Markley 1995, eqs 11–15], multiplied through by μ.
        let d = 3.0 * p.q * self.beta + alpha * p.mu_e;
        let b = self.beta * t;
        let q = 2.0 * alpha * p.q * d - b * b;
        let r = b * b * b + 3.0 * alpha * d * t * (d - p.q * self.beta);
        let w = short_cbrt(r.abs() + (q * q * q + r * r).max(0.0).sqrt());
        let w = w * w;
        let z = 2.0 * r * w / (w * w + w * q + q * q);
        (z + b) / d + turns - p.sigma
    }
}
