//! The constants of an orbit in scaled units, worked out from its start with the digits that matter.

use super::guess::Pericentre;
use super::pair::{self, Pair, Vector};
use super::real::Real;
use core::f64::consts::TAU;

/// An orbit in scaled units: r₀ is 1 … 4, and the larger of v₀ and √(μ/r₀) about 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Orbit<T = f64> {
    pub(super) r0: Vector<T>,
    pub(super) v0: Vector<T>,
    pub(super) mu: Pair<T>,
    /// |r₀|.
    pub(super) distance: Pair<T>,
    pub(super) inverse_distance: T,
    /// μ/r₀.
    pub(super) pull: Pair<T>,
    /// η₀ = r₀·v₀.
    pub(super) eta: Pair<T>,
    /// β = 2μ/r₀ − v₀² = μ/a: positive on an ellipse, 0 on a parabola.
    pub(super) beta: Pair<T>,
    /// ζ₀ = μ − β r₀ = μ e cos E₀.
    pub(super) zeta: Pair<T>,
    /// √|β|, held off zero.
    pub(super) root: T,
    /// 2πμ/β^(3/2), rounded; infinite on open orbits.
    pub(super) period: T,
}

/// 2π to 79 bits.
const TWO_PI: Pair = Pair { hi: 6.283_185_362_815_857, lo: -5.563_627_045_666_847e-8 };

/// 3·2⁵¹: adding it rounds to a whole number.
const WHOLE: f64 = 6_755_399_441_055_744.0;

impl<T: Real> Orbit<T> {
    #[inline(always)]
    pub(super) fn new(mu: T, r0: [T; 3], v0: [T; 3]) -> Self {
        let (r0, v0, mu) = (Vector::of(r0), Vector::of(v0), Pair::of(mu));
        let (distance, inverse_distance) = r0.dot(&r0).root();
        let eta = r0.dot(&v0);
        let pull = mu.over(distance, inverse_distance);
        let speed_squared = v0.dot(&v0);
        let (s, e) = pair::sum(pull.hi * 2.0, -speed_squared.hi);
        let beta = Pair::settled(s, e + (pull.lo * 2.0 - speed_squared.lo));
        let (t, f) = pair::sum(speed_squared.hi, -pull.hi);
        let zeta = Pair::settled(t, f + (speed_squared.lo - pull.lo)).times(distance);
        let b = beta.value();
        let root = b.abs().sqrt().max(b.all(1e-90));
        let period = T::pick(b.all(0.0).below(b), mu.value() * TAU / (b * root), b.all(f64::INFINITY));
        Self { r0, v0, mu, distance, inverse_distance, pull, eta, beta, zeta, root, period }
    }

    /// The period to 75 bits; without meaning on open orbits.
    #[inline(always)]
    pub(super) fn turn(&self) -> Pair<T> {
        let (root, inverse) = self.beta.root();
        Pair::all(inverse, TWO_PI).times(self.mu).over(root.times(self.beta), inverse * inverse * inverse)
    }

    /// `dt` less whole revolutions, −P/2 … P/2, as a rounded number and the rest; `turn` gives the period.
    /// Not for more than 2e15 revolutions.
    #[inline(always)]
    pub(super) fn reduced(&self, dt: T, turn: impl FnOnce() -> Pair<T>) -> (T, T) {
        let within = dt.either(dt.abs().at_most(self.period * 0.5), dt.all(f64::INFINITY).at_most(self.period));
        if dt.every(within) {
            return (dt, dt.all(0.0));
        }
        let turns = dt / self.period;
        let (p, e) = Pair::of((turns + WHOLE) - WHOLE).product(turn());
        let (s, f) = pair::sum(dt, -p);
        let (s, f) = pair::sum(s, f - e);
        (T::pick(within, dt, s), T::pick(within, dt.all(0.0), f))
    }

    /// The orbit as seen from its pericentre.
    #[inline(always)]
    pub(super) fn pericentre(&self) -> Pericentre<T> {
        let ([x, y, z], [u, v, w]) = (self.r0.value(), self.v0.value());
        let (a, b, c) = (y * w - z * v, z * u - x * w, x * v - y * u);
        Pericentre::new(self, a * a + b * b + c * c)
    }
}
