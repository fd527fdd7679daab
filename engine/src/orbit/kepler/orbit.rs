//! The constants of an orbit in scaled units, worked out from its start with the digits that matter.

use super::guess::Pericentre;
use super::pair::{self, Pair, Vector};
use core::f64::consts::TAU;
use glam::DVec3;

/// An orbit in scaled units: r₀ is 1 … 4, and the larger of v₀ and √(μ/r₀) about 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orbit {
    pub(super) r0: Vector,
    pub(super) v0: Vector,
    pub(super) mu: Pair,
    /// |r₀|.
    pub(super) distance: Pair,
    pub(super) inverse_distance: f64,
    /// μ/r₀.
    pub(super) pull: Pair,
    /// η₀ = r₀·v₀.
    pub(super) eta: Pair,
    /// β = 2μ/r₀ − v₀² = μ/a: positive on an ellipse, 0 on a parabola.
    pub(super) beta: Pair,
    /// ζ₀ = μ − β r₀ = μ e cos E₀.
    pub(super) zeta: f64,
    /// √|β|, held off zero.
    pub(super) root: f64,
    /// 2πμ/β^(3/2), rounded; infinite on open orbits.
    pub(super) period: f64,
}

/// 2π to 79 bits.
const TWO_PI: Pair = Pair { hi: 6.283_185_362_815_857, lo: -5.563_627_045_666_847e-8 };

/// 3·2⁵¹: adding it rounds to a whole number.
const WHOLE: f64 = 6_755_399_441_055_744.0;

impl Orbit {
    #[inline(always)]
    pub(super) fn new(mu: f64, r0: DVec3, v0: DVec3) -> Self {
        let (r0, v0, mu) = (Vector::of(r0), Vector::of(v0), Pair::of(mu));
        let (distance, inverse_distance) = r0.dot(&r0).root();
        let eta = r0.dot(&v0);
        let pull = mu.over(distance, inverse_distance);
        let speed_squared = v0.dot(&v0);
        let (s, e) = pair::sum(2.0 * pull.hi, -speed_squared.hi);
        let beta = Pair::settled(s, e + (2.0 * pull.lo - speed_squared.lo));
        let b = beta.value();
        let (t, f) = pair::sum(speed_squared.hi, -pull.hi);
        let zeta = (t + (f + (speed_squared.lo - pull.lo))) * distance.value();
        let root = b.abs().sqrt().max(1e-90);
        let period = if b > 0.0 { TAU * mu.value() / (b * root) } else { f64::INFINITY };
        Self { r0, v0, mu, distance, inverse_distance, pull, eta, beta, zeta, root, period }
    }

    /// The period to 75 bits; without meaning on open orbits.
    #[inline(always)]
    pub(super) fn turn(&self) -> Pair {
        let (root, inverse) = self.beta.root();
        TWO_PI.times(self.mu).over(root.times(self.beta), inverse * inverse * inverse)
    }

    /// `dt` less whole revolutions, −P/2 … P/2, as a rounded number and the rest; `turn` gives the period.
    #[inline(always)]
    pub(super) fn reduced(&self, dt: f64, turn: impl FnOnce() -> Pair) -> (f64, f64) {
        if dt.abs() <= 0.5 * self.period || !self.period.is_finite() {
            return (dt, 0.0);
        }
        let turns = dt / self.period;
        if turns.abs() > 2.0e15 {
            // No digit of the phase is left.
            return (libm::remainder(dt, self.period), 0.0);
        }
        let turns = (turns + WHOLE) - WHOLE;
        let (p, e) = Pair::of(turns).product(turn());
        let (s, f) = pair::sum(dt, -p);
        pair::sum(s, f - e)
    }

    /// The orbit as seen from its pericentre.
    #[inline(always)]
    pub(super) fn pericentre(&self) -> Pericentre {
        Pericentre::new(self, self.r0.value().cross(self.v0.value()).length_squared())
    }
}
