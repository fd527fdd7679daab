//! An orbit scaled to about 1, and the state on it after a time.

use super::guess::{Pericentre, Shape};
use super::pair::{self, Pair, TWO_PI};
use super::universal::Universal;
use super::super::State;
use crate::space::{Frame, Position, Velocity};
use glam::DVec3;

/// An orbit with what does not depend on time worked out: cheaper than [`super::propagate`] when sampled often, and the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    gm: f64,
    start: (DVec3, DVec3),
    period_s: f64,
    bends: bool,
    scale: Scale,
    pub(super) orbit: Orbit,
    pericentre: Pericentre,
}

/// Powers of two by which lengths, speeds and times are divided: exact, so that only what over- or underflows changes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    length: i32,
    speed: i32,
}

/// An orbit in scaled units: r₀ is 1 … 4, and the larger of v₀ and √(μ/r₀) about 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orbit {
    pub(super) r0: DVec3,
    pub(super) v0: DVec3,
    pub(super) mu: f64,
    /// |r₀|.
    pub(super) distance: Pair,
    pub(super) inverse_distance: f64,
    /// η₀ = r₀·v₀.
    pub(super) eta: Pair,
    /// β = 2μ/r₀ − v₀² = μ/a: positive on an ellipse, 0 on a parabola.
    pub(super) beta: Pair,
    /// ζ₀ = μ − β r₀ = μ e cos E₀.
    pub(super) zeta: f64,
    /// Infinite on open orbits.
    pub(super) period: Pair,
}

/// The power of two at or below |x|, −1023 for what is smaller than a normal number.
#[inline(always)]
fn exponent(x: f64) -> i32 {
    // Eleven bits: it fits.
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// 2ᵏ, −1022 ≤ k ≤ 1023.
#[inline(always)]
fn power_of_two(k: i32) -> f64 {
    f64::from_bits((i64::from(k + 1023) << 52) as u64)
}

/// 2ᵏ in three factors, for any k that two states can need.
#[inline(always)]
fn factors(k: i32) -> [f64; 3] {
    let a = k.clamp(-1000, 1000);
    let b = (k - a).clamp(-1000, 1000);
    [power_of_two(a), power_of_two(b), power_of_two((k - a - b).clamp(-1000, 1000))]
}

#[inline(always)]
fn scaled(x: f64, k: i32) -> f64 {
    if k.abs() <= 1000 {
        return x * power_of_two(k);
    }
    let [a, b, c] = factors(k);
    x * a * b * c
}

#[inline(always)]
fn scaled_vector(x: DVec3, k: i32) -> DVec3 {
    if k.abs() <= 1000 {
        return x * power_of_two(k);
    }
    let [a, b, c] = factors(k);
    x * a * b * c
}

impl Orbit {
    #[inline(always)]
    pub(super) fn new(mu: f64, r0: DVec3, v0: DVec3) -> Self {
        let (distance, inverse_distance) = pair::dot(r0, r0).root();
        let eta = pair::dot(r0, v0);
        let twice = Pair { hi: 2.0 * mu, lo: 0.0 };
        let speed_squared = pair::dot(v0, v0);
        let beta = twice.over(distance, inverse_distance).minus(speed_squared);
        let zeta = mu - beta.hi * distance.hi;
        let period = if beta.hi > 0.0 {
            let (root, inverse) = beta.root();
            TWO_PI.scaled(mu).over(root.times(beta), inverse * inverse * inverse)
        } else {
            Pair { hi: f64::INFINITY, lo: 0.0 }
        };
        Self { r0, v0, mu, distance, inverse_distance, eta, beta, zeta, period }
    }

    #[inline(always)]
    pub(super) fn shape(&self) -> Shape {
        Shape {
            mu: self.mu,
            distance: self.distance.hi,
            inverse_distance: self.inverse_distance,
            eta: self.eta.hi,
            beta: self.beta.hi,
            zeta: self.zeta,
            period: self.period.hi,
            moment: self.r0.cross(self.v0).length_squared(),
        }
    }

    /// `dt` less whole revolutions: −P/2 … P/2.
    #[inline(always)]
    pub(super) fn reduced(&self, dt: f64) -> Pair {
        // Beyond 2⁵² revolutions the phase has no digit left; take the remainder of the rounded period.
        let whole = Pair { hi: dt, lo: 0.0 };
        if dt.abs() <= 0.5 * self.period.hi || !(self.period.hi < f64::INFINITY) {
            return whole;
        }
        let turns = libm::rint(dt / self.period.hi);
        if turns.abs() > 4.0e15 {
            return Pair { hi: libm::remainder(dt, self.period.hi), lo: 0.0 };
        }
        whole.minus(self.period.scaled(turns))
    }

    #[inline(always)]
    pub(super) fn radius(&self, g: &Universal) -> f64 {
        self.distance.hi + (self.eta.hi * g.g1 + self.zeta * g.g2)
    }

    /// Position and velocity where the universal functions are `g`.
    #[inline(always)]
    pub(super) fn state(&self, g: &Universal) -> (DVec3, DVec3) {
        // Regularised: at the very centre r = 0, where only the velocity has no value.
        let r = self.radius(g).max(1e-30 * self.distance.hi);
        let f_less_one = -self.mu * g.g2 * self.inverse_distance;
        let gee = self.distance.hi * g.g1 + self.eta.hi * g.g2;
        let inverse = 1.0 / r;
        let f_dot = -self.mu * g.g1 * (inverse * self.inverse_distance);
        let gee_dot_less_one = -self.mu * g.g2 * inverse;
        (self.r0 + (self.r0 * f_less_one + self.v0 * gee), self.v0 + (self.r0 * f_dot + self.v0 * gee_dot_less_one))
    }
}

impl Conic {
    /// The orbit through `r0` (m) with velocity `v0` (m/s) about the origin.
    pub fn new(gm: f64, r0: DVec3, v0: DVec3) -> Self {
        let largest = r0.abs().max_element();
        let bends = gm > 0.0 && largest > 0.0 && r0.is_finite() && v0.is_finite() && gm.is_finite();
        let length = exponent(largest);
        let speed = exponent(v0.abs().max_element()).max((exponent(gm) - length) >> 1);
        let scale = Scale { length, speed };
        let orbit = Orbit::new(scaled(gm, -length - 2 * speed), scaled_vector(r0, -length), scaled_vector(v0, -speed));
        let period_s = if orbit.beta.hi > 0.0 { scaled(orbit.period.hi, length - speed) } else { f64::INFINITY };
        let pericentre = orbit.shape().pericentre();
        Self { gm, start: (r0, v0), period_s, bends, scale, orbit, pericentre }
    }

    /// Period, s; infinite on open orbits.
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Gravitational parameter, m³/s².
    pub fn gm(&self) -> f64 {
        self.gm
    }

    /// The state `dt_s` seconds later (or earlier).
    pub fn after<F: Frame>(&self, dt_s: f64) -> State<F> {
        let (r, v) = self.after_raw(dt_s);
        State { position: Position::new(r), velocity: Velocity::new(v) }
    }

    /// As [`Conic::after`], for callers that keep their own frame.
    pub fn after_raw(&self, dt_s: f64) -> (DVec3, DVec3) {
        let (r0, v0) = self.start;
        if dt_s == 0.0 {
            return (r0, v0);
        }
        if !(self.bends && dt_s.is_finite()) {
            return (r0 + v0 * dt_s, v0);
        }
        let Scale { length, speed } = self.scale;
        let dt = scaled(dt_s, speed - length).clamp(-1e300, 1e300);
        let dt = self.orbit.reduced(dt);
        let g = self.orbit.solve(&self.pericentre, dt);
        let (r, v) = self.orbit.state(&g);
        (scaled_vector(r, length), scaled_vector(v, speed))
    }
}
