//! First guesses for the universal anomaly, good to a few per cent: two steps of the solver then reach rounding.
//!
//! Their quality costs steps, never the answer; so short series serve for arcs and logarithms.
//!
//! - [Markley 1995] "Kepler equation solver", Celest. Mech. Dyn. Astron. 63, 101: a Padé approximant of the sine turns
//!   Kepler's equation into a cubic. Written here in σ = E/√β, where the same cubic holds for every conic.
//! - [Danby 1988] "Fundamentals of Celestial Mechanics", §6.9 (the logarithm on a hyperbola).

use super::orbit::Orbit;
use core::f64::consts::{FRAC_PI_2, LN_2, PI, SQRT_2, TAU};

/// The orbit as seen from its pericentre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pericentre {
    /// μe.
    mu_e: f64,
    /// Pericentre distance.
    q: f64,
    /// 1/(1 + e).
    flatness: f64,
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
    let y = f64::from_bits((x.to_bits() / 3).wrapping_add(0x2A9F_7893_0000_0000));
    let cube = y * y * y;
    y * (cube + 2.0 * x) / (2.0 * cube + x)
}

/// ln(w + √(w² + 1)) for w ≥ 0.
#[inline(always)]
fn short_asinh(w: f64) -> f64 {
    let w = w.min(1e150);
    short_log(w + (w * w + 1.0).sqrt())
}

/// s after a time `dt` in which the orbit bends little, from the series of t(s) turned round; and how much it bends.
#[inline(always)]
pub(super) fn nearby(o: &Orbit, dt: f64) -> (f64, f64) {
    let y = dt * o.inverse_distance;
    let a = o.eta.value() * o.inverse_distance * y;
    let b = o.zeta * o.inverse_distance * (y * y);
    let c = o.beta.value() * (y * y);
    (y * (1.0 - 0.5 * (a - (a * a - b * (1.0 / 3.0)))), a.abs().max(b.abs()).max(0.3 * c.abs()))
}

impl Pericentre {
    /// Of an orbit with the squared angular momentum `moment`.
    #[inline(always)]
    pub(super) fn new(o: &Orbit, moment: f64) -> Self {
        let (mu, beta, eta, root) = (o.mu.value(), o.beta.value(), o.eta.value(), o.root);
        let mu_e = (mu * mu - beta * moment).max(0.0).sqrt();
        let flat = 1.0 / (mu + mu_e);
        let across = eta * root;
        let arc = if beta >= 0.0 {
            let steep = across.abs() > o.zeta.abs();
            let (over, under) = if steep { (o.zeta, across) } else { (across, o.zeta.abs().max(1e-290)) };
            let arc = short_atan(over / under);
            let quarter = FRAC_PI_2.copysign(across);
            if steep {
                quarter - arc
            } else if o.zeta < 0.0 {
                2.0 * quarter - arc
            } else {
                arc
            }
        } else {
            let w = (across / mu_e).abs();
            if w < 0.5 {
                let z = across / o.zeta;
                let y = z * z;
                z * (1.0 + y * (1.0 / 3.0 + y * (1.0 / 5.0 + y * (1.0 / 7.0 + y * (1.0 / 9.0 + y * (1.0 / 11.0))))))
            } else {
                short_asinh(w).copysign(across)
            }
        };
        let sigma = arc / root;
        let q = moment * flat;
        let x = (arc * arc).copysign(beta);
        let time = if x.abs() < 0.25 {
            sigma * (q + mu_e * (sigma * sigma) * (1.0 / 6.0 - x * (1.0 / 120.0 - x * (1.0 / 5040.0))))
        } else {
            (mu * sigma - eta) / beta
        };
        Self { mu_e, q, flatness: mu * flat, sigma, time }
    }

    /// s after a time `dt` on any part of the orbit.
    #[inline(always)]
    pub(super) fn around(&self, o: &Orbit, dt: f64) -> f64 {
        let (beta, root) = (o.beta.value(), o.root);
        let mut t = self.time + dt;
        let mut turns = 0.0;
        let mut alpha = 10.6;
        if beta > 0.0 {
            let beyond = t.abs() > 0.5 * o.period;
            turns = if beyond { (TAU / root).copysign(t) } else { 0.0 };
            t -= if beyond { o.period.copysign(t) } else { 0.0 };
            // [Markley 1995, eq. 20], with M/π as a part of half a period.
            let part = (2.0 * t / o.period).abs();
            alpha = (3.0 * PI * PI + 1.6 * PI * PI * (1.0 - part) * self.flatness) * (1.0 / (PI * PI - 6.0));
        } else {
            // z = N/e = sinh F − F/e.
            let z = (root * root * root * t / self.mu_e).abs();
            if z > 2.0 {
                // [Danby 1988, §6.9], and once round the fixed point F = asinh((N + F)/e).
                let f = short_asinh(z + short_log((2.0 * z + 1.8).min(1e300)) * (o.mu.value() / self.mu_e));
                return f.copysign(t) / root - self.sigma;
            }
        }
        // [Markley 1995, eqs 11–15], multiplied through by μ.
        let d = 3.0 * self.q * beta + alpha * self.mu_e;
        let b = beta * t;
        let q = 2.0 * alpha * self.q * d - b * b;
        let r = b * b * b + 3.0 * alpha * d * t * (d - self.q * beta);
        let w = short_cbrt(r.abs() + (q * q * q + r * r).max(0.0).sqrt());
        let w = w * w;
        let z = 2.0 * r * w / (w * w + w * q + q * q);
        (z + b) / d + turns - self.sigma
    }
}
