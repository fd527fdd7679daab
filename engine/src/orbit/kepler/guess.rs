//! First guesses for the universal anomaly, good to a few per cent: two steps of the solver then reach rounding.
//!
//! Their quality costs steps, never the answer; so short series serve for arcs and logarithms.
//!
//! - [Markley 1995] "Kepler equation solver", Celest. Mech. Dyn. Astron. 63, 101: a Padé approximant of the sine turns
//!   Kepler's equation into a cubic. Written here in σ = E/√β, where the same cubic holds for every conic.
//! - [Danby 1988] "Fundamentals of Celestial Mechanics", §6.9 (the logarithm on a hyperbola).

use super::orbit::Orbit;
use super::real::Real;
use core::f64::consts::{FRAC_PI_2, LN_2, PI, SQRT_2, TAU};

/// The orbit as seen from its pericentre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pericentre<T = f64> {
    /// μe.
    mu_e: T,
    /// Pericentre distance.
    q: T,
    /// 1/(1 + e).
    flatness: T,
    /// s and time since pericentre at the start.
    sigma: T,
    time: T,
}

/// atan x for |x| ≤ 1, within 2e-6 (a minimax polynomial).
#[inline(always)]
fn short_atan<T: Real>(x: T) -> T {
    let y = x * x;
    x * (y * (y * (y * (y * (y * -0.011_721_20 + 0.052_653_32) - 0.116_432_87) + 0.193_543_46) - 0.332_623_47) + 0.999_977_26)
}

/// ln x for normal x > 0, within 2e-6.
#[inline(always)]
fn short_log<T: Real>(x: T) -> T {
    const MANTISSA: u64 = (1 << 52) - 1;
    const ONE: u64 = 1023 << 52;
    const SHIFT: f64 = 4_503_599_627_370_496.0;
    let m = x.map(|x| f64::from_bits((x.to_bits() & MANTISSA) | ONE));
    // The exponent as a number, by way of the low bits of 2⁵² + k.
    let k = x.map(|x| f64::from_bits((x.to_bits() >> 52) | SHIFT.to_bits())) - (SHIFT + 1023.0);
    let z = (m - SQRT_2) / (m + SQRT_2);
    let zz = z * z;
    (k + 0.5) * LN_2 + z * (zz * (zz * (zz * (2.0 / 7.0) + 2.0 / 5.0) + 2.0 / 3.0) + 2.0)
}

/// ∛x for normal x > 0, within 3e-5.
#[inline(always)]
fn short_cbrt<T: Real>(x: T) -> T {
    // A third of the bits is a third of the exponent, and a line for the mantissa; one step of Halley's.
    let y = x.map(|x| f64::from_bits((x.to_bits() / 3).wrapping_add(0x2A9F_7893_0000_0000)));
    let cube = y * y * y;
    y * (cube + x * 2.0) / (cube * 2.0 + x)
}

/// ln(w + √(w² + 1)) for w ≥ 0.
#[inline(always)]
fn short_asinh<T: Real>(w: T) -> T {
    let w = w.min(w.all(1e150));
    short_log(w + (w * w + 1.0).sqrt())
}

/// s after a time `dt` in which the orbit bends little, from the series of t(s) turned round; and how much it bends.
#[inline(always)]
pub(super) fn nearby<T: Real>(o: &Orbit<T>, dt: T) -> (T, T) {
    let y = dt * o.inverse_distance;
    let a = o.eta.value() * o.inverse_distance * y;
    let b = o.zeta.value() * o.inverse_distance * (y * y);
    let c = o.beta.value() * (y * y);
    (y * (y.all(1.0) - (a - (a * a - b * (1.0 / 3.0))) * 0.5), a.abs().max(b.abs()).max(c.abs() * 0.3))
}

impl<T: Real> Pericentre<T> {
    /// Of an orbit with the squared angular momentum `moment`.
    #[inline(always)]
    pub(super) fn new(o: &Orbit<T>, moment: T) -> Self {
        let (mu, beta, eta, root) = (o.mu.value(), o.beta.value(), o.eta.value(), o.root);
        let zero = mu.all(0.0);
        let mu_e = (mu * mu - beta * moment).max(zero).sqrt();
        let flat = mu.all(1.0) / (mu + mu_e);
        let across = eta * root;
        let open = beta.below(zero);
        let arc = if beta.every(open) {
            Self::open_arc(o, across, mu_e)
        } else {
            let arc = Self::closed_arc(o, across);
            if beta.any(open) { T::pick(open, Self::open_arc(o, across, mu_e), arc) } else { arc }
        };
        let sigma = arc / root;
        let q = moment * flat;
        let x = (arc * arc).signed(beta);
        let series = sigma
            * (q + mu_e
                * (sigma * sigma)
                * (zero.all(1.0 / 6.0) - x * (zero.all(1.0 / 120.0) - x * (zero.all(1.0 / 5040.0) - x * (1.0 / 362_880.0)))));
        let time = T::pick(x.abs().below(zero.all(0.25)), series, (mu * sigma - eta) / beta);
        Self { mu_e, q, flatness: mu * flat, sigma, time }
    }

    /// E₀ = atan2(μe sin E₀, μe cos E₀).
    #[inline(always)]
    fn closed_arc(o: &Orbit<T>, across: T) -> T {
        let size = o.zeta.value().abs();
        let steep = size.below(across.abs());
        let over = T::pick(steep, o.zeta.value(), across);
        let under = T::pick(steep, across, size.max(size.all(1e-290)));
        let arc = short_atan(over / under);
        let quarter = size.all(FRAC_PI_2).signed(across);
        let flat = T::pick(o.zeta.value().below(size.all(0.0)), quarter * 2.0 - arc, arc);
        T::pick(steep, quarter - arc, flat)
    }

    /// F₀ = asinh(μe sinh F₀/μe).
    #[inline(always)]
    fn open_arc(o: &Orbit<T>, across: T, mu_e: T) -> T {
        let w = (across / mu_e).abs();
        let z = across / o.zeta.value();
        let y = z * z;
        let series = z * (y * (y * (y * (y * (y * (1.0 / 11.0) + 1.0 / 9.0) + 1.0 / 7.0) + 1.0 / 5.0) + 1.0 / 3.0) + 1.0);
        T::pick(w.below(w.all(0.5)), series, short_asinh(w).signed(across))
    }

    /// s after a time `dt` on any part of the orbit.
    #[inline(always)]
    pub(super) fn around(&self, o: &Orbit<T>, dt: T) -> T {
        let (beta, root) = (o.beta.value(), o.root);
        let t = self.time + dt;
        // z = N/e = sinh F − F/e.
        let z = (root * root * root * t / self.mu_e).abs();
        let swung = t.both(beta.below(t.all(0.0)), t.all(2.0).below(z));
        if t.every(swung) {
            return self.swung(o, t, z);
        }
        let cubic = self.cubic(o, t);
        if t.any(swung) { T::pick(swung, self.swung(o, t, z), cubic) } else { cubic }
    }

    /// [Danby 1988, §6.9], and once round the fixed point F = asinh((N + F)/e).
    #[inline(always)]
    fn swung(&self, o: &Orbit<T>, t: T, z: T) -> T {
        let rough = short_log((z * 2.0 + 1.8).min(z.all(1e300)));
        short_asinh(z + rough * (o.mu.value() / self.mu_e)).signed(t) / o.root - self.sigma
    }

    /// [Markley 1995, eqs 11–15], multiplied through by μ.
    #[inline(always)]
    fn cubic(&self, o: &Orbit<T>, t: T) -> T {
        let beta = o.beta.value();
        let zero = t.all(0.0);
        let closed = zero.below(beta);
        let beyond = (o.period * 0.5).below(t.abs());
        let turns = T::pick(beyond, (t.all(TAU) / o.root).signed(t), zero);
        let t = t - T::pick(beyond, o.period.signed(t), zero);
        // [Markley 1995, eq. 20], with M/π as a part of half a period; on open orbits a mean of what suits them.
        let part = (t * 2.0 / o.period).abs();
        let alpha = ((t.all(1.6 * PI * PI) - part * (1.6 * PI * PI)) * self.flatness + 3.0 * PI * PI) * (1.0 / (PI * PI - 6.0));
        let alpha = T::pick(closed, alpha, t.all(10.6));
        let d = self.q * beta * 3.0 + alpha * self.mu_e;
        let b = beta * t;
        let q = alpha * self.q * d * 2.0 - b * b;
        let r = b * b * b + alpha * d * t * (d - self.q * beta) * 3.0;
        let w = short_cbrt(r.abs() + (q * q * q + r * r).max(zero).sqrt());
        let w = w * w;
        let z = r * w * 2.0 / (w * w + w * q + q * q);
        (z + b) / d + turns - self.sigma
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_functions_are_as_near_as_they_say() {
        for k in -400..=400 {
            let x = f64::from(k) / 400.0;
            assert!((short_atan(x) - libm::atan(x)).abs() < 2e-6, "atan {x}");
            let wide = libm::exp(500.0 * x);
            assert!((short_log(wide) - libm::log(wide)).abs() < 2e-6, "log {wide}");
            assert!((short_cbrt(wide) / libm::cbrt(wide) - 1.0).abs() < 3e-5, "cbrt {wide}");
            assert!((short_asinh(wide) - libm::asinh(wide)).abs() < 2e-6 || wide > 1e150, "asinh {wide}");
        }
    }
}
