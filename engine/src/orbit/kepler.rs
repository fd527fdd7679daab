//! Kepler's problem: the state of a two-body orbit after a time, for every conic, in universal variables.
//!
//! One equation serves circle, ellipse, parabola, hyperbola and radial fall. With β = 2μ/r₀ − v₀², η₀ = r₀·v₀ and the
//! universal anomaly s (ds = dt/r), Kepler's equation reads `r₀G₁ + η₀G₂ + μG₃ = Δt` [Wisdom & Hernandez 2015, eq. 12];
//! its slope is r ≥ 0, so it has one root, which Halley's steps find inside a bracket that only ever shrinks.
//! Not here: perturbations (see `integrate`), orbits as numbers for people (see `elements`).
//!
//! - [Wisdom & Hernandez 2015] "Fast and accurate solution of Kepler's problem for planetary motion", MNRAS 453, 3015.
//! - [Battin 1999] "An Introduction to the Mathematics and Methods of Astrodynamics", §4.5–4.8 (universal functions).

use super::State;
use crate::space::{Frame, Position, Velocity};
use core::f64::consts::TAU;
use glam::DVec3;

/// State after `dt_s` seconds of two-body motion about a point of gravitational parameter `gm` (m³/s²).
///
/// Any finite `dt_s`; whole revolutions are taken off first. Where there is no centre to fall to (`gm ≤ 0`, or a position
/// at the origin) the motion is a straight line. A radial fall goes through the centre and comes back where it came from.
pub fn propagate<F: Frame>(gm: f64, state: &State<F>, dt_s: f64) -> State<F> {
    Conic::new(gm, state.position.0, state.velocity.0).after(dt_s)
}

/// An orbit with what does not depend on time worked out: cheaper than [`propagate`] when sampled often, and the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conic {
    gm: f64,
    r0: DVec3,
    v0: DVec3,
    /// |r₀|, m.
    distance: f64,
    /// η₀ = r₀·v₀, m²/s.
    eta: f64,
    /// β = 2μ/r₀ − v₀² = μ/a: positive on an ellipse, 0 on a parabola.
    beta: f64,
    /// ζ₀ = μ − β r₀ = μ e cos E₀.
    zeta: f64,
    /// Infinite on open orbits.
    period_s: f64,
}

/// The universal functions G₁…G₃ and G₀ at one s.
#[derive(Clone, Copy)]
pub(crate) struct Universal {
    g0: f64,
    pub(crate) g1: f64,
    g2: f64,
    pub(crate) g3: f64,
}

impl Universal {
    /// G₀ = cos √β s, G₁ = ∫G₀, G₂ = ∫G₁, G₃ = ∫G₂ [Battin 1999, §4.5]. By series where βs² is small, so that nothing cancels.
    pub(crate) fn at(beta: f64, s: f64) -> Self {
        let x = beta * s * s;
        if x.abs() < 1.0 {
            // c₂(x) = 1/2! − x/4! + …, c₃(x) = 1/3! − x/5! + …: nine terms leave 1e-19 at |x| = 1.
            let (mut c2, mut c3) = (1.0, 1.0);
            let mut k = 18.0;
            while k > 2.5 {
                c2 = 1.0 - x * c2 / (k * (k - 1.0));
                c3 = 1.0 - x * c3 / (k * (k + 1.0));
                k -= 2.0;
            }
            let (c2, c3) = (0.5 * c2, c3 / 6.0);
            Self { g0: 1.0 - x * c2, g1: s * (1.0 - x * c3), g2: s * s * c2, g3: s * s * s * c3 }
        } else if x > 0.0 {
            let root = beta.sqrt();
            let (sin, cos) = libm::sincos(0.5 * root * s);
            let g1 = 2.0 * sin * cos / root;
            Self { g0: 1.0 - 2.0 * sin * sin, g1, g2: 2.0 * sin * sin / beta, g3: (s - g1) / beta }
        } else {
            let root = (-beta).sqrt();
            // Beyond e^690 the bracket of the solver would only move the overflow about.
            let half = (0.5 * root * s).clamp(-345.0, 345.0);
            let (sinh, cosh) = (libm::sinh(half), libm::cosh(half));
            let g1 = 2.0 * sinh * cosh / root;
            Self { g0: 1.0 + 2.0 * sinh * sinh, g1, g2: -2.0 * sinh * sinh / beta, g3: (s - g1) / beta }
        }
    }
}

/// Steps after which the bracket alone has settled any f64 root.
const MAX_STEPS: u32 = 120;

impl Conic {
    /// The orbit through `r0` (m) with velocity `v0` (m/s) about the origin.
    pub fn new(gm: f64, r0: DVec3, v0: DVec3) -> Self {
        let distance = r0.length();
        let eta = r0.dot(v0);
        let beta = 2.0 * gm / distance - v0.length_squared();
        let zeta = gm - beta * distance;
        let period_s = if beta > 0.0 { TAU * gm / (beta * beta.sqrt()) } else { f64::INFINITY };
        Self { gm, r0, v0, distance, eta, beta, zeta, period_s }
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
        if dt_s == 0.0 {
            return (self.r0, self.v0);
        }
        let bends = self.gm > 0.0 && self.distance > 0.0 && self.beta.is_finite() && dt_s.is_finite();
        if !bends {
            return (self.r0 + self.v0 * dt_s, self.v0);
        }
        // The remainder is exact; a period that overflowed is as good as an open orbit.
        let dt = if self.period_s.is_finite() { libm::remainder(dt_s, self.period_s) } else { dt_s };
        let g = self.solve(dt);
        // Regularised: at the very centre r = 0, where only the velocity has no value.
        let r = self.radius(g).max(1e-30 * self.distance);
        let f_less_one = -self.gm * g.g2 / self.distance;
        let gee = self.distance * g.g1 + self.eta * g.g2;
        let f_dot = -self.gm * g.g1 / (r * self.distance);
        let gee_dot_less_one = -self.gm * g.g2 / r;
        (self.r0 + (self.r0 * f_less_one + self.v0 * gee), self.v0 + (self.r0 * f_dot + self.v0 * gee_dot_less_one))
    }

    fn radius(&self, g: Universal) -> f64 {
        self.distance + self.eta * g.g1 + self.zeta * g.g2
    }

    /// Solves Kepler's equation for the universal anomaly and returns the functions there.
    fn solve(&self, dt: f64) -> Universal {
        let (mut low, mut high) = self.bracket(dt);
        let mut s = self.guess(dt);
        if !(s > low && s < high) {
            s = 0.5 * (low + high);
        }
        let mut g = Universal::at(self.beta, s);
        for _ in 0..MAX_STEPS {
            let r = self.radius(g);
            let miss = self.distance * g.g1 + self.eta * g.g2 + self.gm * g.g3 - dt;
            if miss > 0.0 {
                high = s;
            } else if miss < 0.0 {
                low = s;
            } else {
                break;
            }
            // Halley: f′ = r, f″ = dr/ds = η₀G₀ + ζ₀G₁.
            let slope_change = self.eta * g.g0 + self.zeta * g.g1;
            let denominator = 2.0 * r * r - miss * slope_change;
            let mut step = if denominator > 0.0 { -2.0 * miss * r / denominator } else { -miss / r };
            let inside = s + step > low && s + step < high;
            if !inside || !step.is_finite() {
                // A step too small to leave s, or into the edge of the bracket by rounding, is the end as well.
                if (high - low) <= 4.0 * f64::EPSILON * s.abs() || step.abs() <= f64::EPSILON * s.abs() {
                    break;
                }
                step = 0.5 * (low + high) - s;
            }
            s += step;
            g = Universal::at(self.beta, s);
            // Halley's error goes as the cube of the step: below 1e-7 of both scales the next one would be rounding.
            let scale = 1e-7 * s.abs().min(r / slope_change.abs().max(f64::MIN_POSITIVE));
            if inside && step.abs() <= scale {
                break;
            }
        }
        g
    }

    /// An interval that holds the root, ends included.
    fn bracket(&self, dt: f64) -> (f64, f64) {
        let far = if self.beta > 0.0 {
            // |E₁ − E₀| < 2π within half a period.
            TAU / self.beta.sqrt()
        } else {
            // r grows without bound: double until the time is passed.
            let mut s = (dt / self.distance).abs().max(f64::MIN_POSITIVE);
            for _ in 0..2100 {
                let g = Universal::at(self.beta, s.copysign(dt));
                let t = self.distance * g.g1 + self.eta * g.g2 + self.gm * g.g3;
                if t.abs() >= dt.abs() || !t.is_finite() {
                    break;
                }
                s *= 2.0;
            }
            s
        };
        if dt > 0.0 { (0.0, far) } else { (-far, 0.0) }
    }

    /// A first guess: its quality costs steps, never the answer.
    fn guess(&self, dt: f64) -> f64 {
        let direct = dt / self.distance;
        let bend = (self.eta * direct / self.distance).abs().max(self.zeta.abs() * direct * direct / self.distance);
        if bend < 0.2 {
            // s = Δt/r₀ − η₀Δt²/2r₀³ + … by reversion of the series.
            let a = self.eta / self.distance;
            let b = self.zeta / self.distance;
            return direct * (1.0 - 0.5 * direct * (a - direct * (a * a - b / 3.0)));
        }
        if self.zeta > 0.0 {
            // Barker's cubic ζs³/6 + ηs²/2 + r₀s = Δt: exact on a parabola, good near any pericentre.
            let shift = self.eta / self.zeta;
            let p = 2.0 * self.distance / self.zeta - shift * shift;
            let q = shift * (shift * shift - 3.0 * self.distance / self.zeta) - 3.0 * dt / self.zeta;
            let d = q * q + p * p * p;
            if d >= 0.0 {
                let big = libm::cbrt(q.abs() + d.sqrt());
                let y = if big > 0.0 { (p / big - big).copysign(1.0) * (p / big - big).abs() * q.signum() } else { 0.0 };
                let s = y - shift;
                if s.is_finite() && (self.beta * s * s).abs() < 2.0 && s * dt > 0.0 {
                    return s;
                }
            }
        }
        if self.beta > 0.0 {
            // First order in e: ΔE ≈ ΔM + e cos E₀ sin ΔM − e sin E₀ (1 − cos ΔM).
            let root = self.beta.sqrt();
            let mean = TAU * (dt / self.period_s);
            let (sin, cos) = libm::sincos(mean);
            let (ec, es) = (self.zeta / self.gm, self.eta * root / self.gm);
            return (mean + ec * sin - es * (1.0 - cos)) / root;
        }
        // Far out on a hyperbola exp(√−β s) carries the time.
        let root = (-self.beta).sqrt();
        let swell = 2.0 * dt.abs() * root * (-self.beta) / ((self.gm - self.beta * self.distance) + self.eta * root.copysign(dt));
        (libm::log(swell.max(1.0)) / root.max(f64::MIN_POSITIVE)).copysign(dt)
    }
}

#[cfg(test)]
mod tests;
