//! The root of Kepler's equation in the universal anomaly.

use super::conic::Orbit;
use super::guess::Pericentre;
use super::pair::{self, Pair};
use super::universal::Universal;

/// A step whose every term is below this is taken inside the functions themselves: what is left is of its cube.
const SMALL: f64 = 1e-9;
/// Above this the series of the step is not trusted.
const LARGE: f64 = 0.1;
/// Steps after which the bracket alone has settled any root.
const MOST_STEPS: u32 = 200;

/// One step of the solver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) s: f64,
    /// The square of the step as a part of the length over which the orbit changes: says how fast the series converges.
    pub(super) square: f64,
    pub(super) miss: f64,
    pub(super) radius: f64,
    pub(super) bend: f64,
}

impl Orbit {
    /// How far Kepler's equation is from fulfilled, r₀G₁ + η₀G₂ + μG₃ − Δt, its products and sums exact.
    #[inline(always)]
    pub(super) fn miss(&self, g: &Universal, dt: Pair) -> f64 {
        let (a, b, c) = (pair::product(self.distance.hi, g.g1), pair::product(self.eta.hi, g.g2), pair::product(self.mu, g.g3));
        let s = pair::sum(a.hi, b.hi);
        let t = pair::sum(c.hi, -dt.hi);
        let u = pair::sum(s.hi, t.hi);
        let small = (self.distance.lo * g.g1 + self.eta.lo * g.g2) - dt.lo;
        u.hi + ((u.lo + (s.lo + t.lo)) + ((a.lo + b.lo) + (c.lo + small)))
    }

    /// The step to the root as the series t(s) turned round, to the fourth power of the miss.
    #[inline(always)]
    pub(super) fn step(&self, g: &Universal, dt: Pair) -> Step {
        let miss = self.miss(g, dt);
        let radius = self.radius(g);
        let inverse = 1.0 / radius;
        // t′ = r, t″ = r′ = ηG₀ + ζG₁, t‴ = ζG₀ − βηG₁, t⁗ = −βt″.
        let (eta, beta) = (self.eta.hi, self.beta.hi);
        let bend = eta * g.g0 + self.zeta * g.g1;
        let third = self.zeta * g.g0 - beta * (eta * g.g1);
        let u = -miss * inverse;
        let a = 0.5 * bend * inverse * u;
        let b = third * inverse * (u * u) * (1.0 / 6.0);
        let c = -beta * (u * u) * (a * (1.0 / 12.0));
        // δ = u(1 − a + 2a² − b + 5ab − 5a³ − c).
        let tail = a - (2.0 * a * a - b) - (a * (5.0 * (b - a * a)) - c);
        let square = (a * a).max(b.abs()).max((beta * (u * u)).abs());
        Step { s: u * (1.0 - tail), square, miss, radius, bend }
    }

    /// The functions a small `d` further on.
    #[inline(always)]
    pub(super) fn moved(&self, g: &Universal, d: f64) -> Universal {
        let (beta, half, third) = (self.beta.hi, 0.5 * d, d * (1.0 / 3.0));
        // Gₙ′ = Gₙ₋₁ and G₀′ = −βG₁.
        let (down1, down0) = (-beta * g.g0, -beta * g.g1);
        let taylor = |slope: f64, second: f64, third_slope: f64| d * (slope + half * (second + third * third_slope));
        Universal {
            g0: g.g0 + taylor(down0, down1, -beta * down0),
            g1: g.g1 + taylor(g.g0, down0, down1),
            g2: g.g2 + taylor(g.g1, g.g0, down0),
            g3: g.g3 + taylor(g.g2, g.g1, g.g0),
        }
    }

    /// The universal functions after a time `dt` of at most half a revolution.
    pub(super) fn solve(&self, pericentre: &Pericentre, dt: Pair) -> Universal {
        let shape = self.shape();
        let (near, bend) = shape.nearby(dt.hi);
        let mut s = if bend < 0.2 { near } else { shape.around(pericentre, dt.hi) };
        for _ in 0..4 {
            let g = Universal::at(self.beta.hi, s);
            let step = self.step(&g, dt);
            if step.square < SMALL {
                return self.moved(&g, step.s);
            }
            if !(step.square < LARGE) {
                break;
            }
            s += step.s;
        }
        self.search(s, dt)
    }

    /// As [`Orbit::solve`] where the quick way failed: Halley's steps inside a bracket that only ever shrinks.
    #[cold]
    fn search(&self, start: f64, dt: Pair) -> Universal {
        let (mut low, mut high) = self.bracket(dt.hi);
        let mut s = if start > low && start < high { start } else { 0.5 * (low + high) };
        let mut g = Universal::at(self.beta.hi, s);
        for _ in 0..MOST_STEPS {
            let step = self.step(&g, dt);
            if step.square < SMALL {
                return self.moved(&g, step.s);
            }
            if step.miss > 0.0 {
                high = s;
            } else if step.miss < 0.0 {
                low = s;
            } else {
                break;
            }
            let halley = -2.0 * step.miss * step.radius / (2.0 * step.radius * step.radius - step.miss * step.bend);
            let d = if step.square < LARGE { step.s } else { halley };
            let next = s + d;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if next == s {
                break;
            }
            s = next;
            g = Universal::at(self.beta.hi, s);
        }
        g
    }

    /// An interval that holds the root, ends included.
    fn bracket(&self, dt: f64) -> (f64, f64) {
        let beta = self.beta.hi;
        let far = if beta > 0.0 {
            // |E₁ − E₀| < 2π within half a period.
            core::f64::consts::TAU / beta.sqrt()
        } else {
            // r grows without bound: double until the time is passed.
            let mut s = (dt / self.distance.hi).abs().max(f64::MIN_POSITIVE);
            for _ in 0..2100 {
                let t = self.miss(&Universal::at(beta, s.copysign(dt)), Pair::default());
                if t.abs() >= dt.abs() || !t.is_finite() {
                    break;
                }
                s *= 2.0;
            }
            s
        };
        if dt > 0.0 { (0.0, far) } else { (-far, 0.0) }
    }
}
