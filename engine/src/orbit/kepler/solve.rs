//! The root of Kepler's equation in the universal anomaly, and the state there.
//!
//! - [Battin 1999] "An Introduction to the Mathematics and Methods of Astrodynamics", §4.5 (the functions at a sum).
//! - [Danby 1987] "The solution of Kepler's equation, III", Celest. Mech. 40, 303 (steps of high order).

use super::guess::{self, Pericentre};
use super::orbit::Orbit;
use super::pair::{self, Pair};
use super::real::Real;
use super::universal::{Exact, Universal};

/// A step whose every term is below this is taken inside the functions themselves: what is left is of its cube.
const SMALL: f64 = 1e-9;
/// Below this the next step will be small: its error goes as the fifth power.
const CLOSE: f64 = 0.01;
/// Above this the series of the step is not trusted.
const LARGE: f64 = 0.1;
/// Steps after which the bracket alone has settled any root.
const MOST_STEPS: u32 = 200;

/// One step of the solver.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<T = f64> {
    /// The change of s.
    d: T,
    /// The square of the step as a part of the length over which the orbit changes: says how fast the series converges.
    square: T,
    /// Time too much.
    miss: T,
    radius: T,
    /// dr/ds and d²r/ds².
    bend: T,
    third: T,
}

impl<T: Real> Step<T> {
    /// The series t(s) turned round, to the fourth power of the miss; t⁗ = −βt″.
    #[inline(always)]
    fn new(radius: T, miss: T, bend: T, third: T, beta: T) -> Self {
        let inverse = miss.all(1.0) / radius;
        let u = -miss * inverse;
        let (half, uu) = (inverse * u, u * u);
        let a = bend * half * 0.5;
        let b = third * inverse * uu * (1.0 / 6.0);
        let buu = beta * uu;
        // δ = u(1 − a + 2a² − b + 5ab − 5a³ − c), c = −βu²a/12.
        let aa = a * a;
        let tail = (a - (aa + aa - b)) - a * ((b - aa) * 5.0 + buu * (1.0 / 12.0));
        let (d, square) = (u - u * tail, aa.max(b.abs()).max(buu.abs()));
        // At the very centre r = 0, and there is nowhere to go; nor is there by a series that does not converge.
        let sound = d.both(square.below(d.all(1.0)), d.abs().at_most(d.all(1e150)));
        Self { d: T::pick(sound, d, d.all(0.0)), square, miss, radius, bend, third }
    }

    /// Whether a single step was enough.
    #[inline(always)]
    pub(super) fn is_close(&self) -> T::Mask {
        self.square.below(self.square.all(CLOSE))
    }
}

impl<T: Real> Orbit<T> {
    /// The step to the root near the place where the functions are `g` and the time is too much by `miss`.
    #[inline(always)]
    fn step(&self, g: &Universal<T>, miss: T) -> Step<T> {
        // t′ = r, t″ = r′ = ηG₀ + ζG₁, t‴ = r″ = ζG₀ − βηG₁.
        let (eta, beta, zeta) = (self.eta.value(), self.beta.value(), self.zeta.value());
        let radius = self.distance.value() + (eta * g.g1 + zeta * g.g2);
        Step::new(radius, miss, eta * g.g0 + zeta * g.g1, zeta * g.g0 - beta * (eta * g.g1), beta)
    }

    /// A first guess at s after a time `dt` of at most half a revolution.
    #[inline(always)]
    pub(super) fn guess(&self, dt: T, pericentre: impl FnOnce() -> Pericentre<T>) -> T {
        let (near, bend) = guess::nearby(self, dt);
        let little = bend.below(bend.all(0.2));
        if dt.every(little) { near } else { T::pick(little, near, pericentre().around(self, dt)) }
    }

    /// Position and velocity at the root near `s`, for a time `dt` in two words; right where the step [`Step::is_close`].
    #[inline(always)]
    pub(super) fn finish(&self, s: T, dt: (T, T)) -> (Step<T>, [T; 3], [T; 3]) {
        let s = pair::shortened(s);
        let exact = Exact::at(self.beta, s);
        // r₀G₁ + η₀G₂ + μG₃ − Δt, the sum of the first two also being g, the share of the velocity in the new position.
        let (gee, gee_lo) = pair::combined(self.distance, exact.g1, self.eta, exact.g2);
        let (c, c_lo) = self.mu.product(exact.g3);
        let (t, t_lo) = pair::sum(c, -dt.0);
        let (miss, miss_lo) = pair::sum(gee, t);
        let g = exact.rounded();
        let step = self.step(&g, miss + (miss_lo + ((t_lo + gee_lo) + (c_lo - dt.1))));
        // From s on the orbit is one through r, r′ and μ again, and all goes on with the functions at d [Battin 1999, §4.5].
        let (beta, distance, eta, mu) = (self.beta.value(), self.distance.value(), self.eta.value(), self.mu.value());
        let on = Universal::short(beta, step.d);
        let again = Step::new(
            step.radius + (step.bend * on.g1 + step.third * on.g2),
            step.miss + (step.radius * on.g1 + (step.bend * on.g2 + mu * on.g3)),
            step.bend * on.g0 + step.third * on.g1,
            step.third * on.g0 - beta * (step.bend * on.g1),
            beta,
        );
        let on = on.moved(beta, again.d);
        let slope = distance * g.g0 + eta * g.g1;
        let gee = Pair::settled(gee, gee_lo + (slope * on.g1 + (eta * g.g0 - beta * (distance * g.g1)) * on.g2));
        let g1 = Pair::settled(exact.g1.hi, exact.g1.lo + (g.g0 * on.g1 - beta * (g.g1 * on.g2)));
        let g2 = Pair::settled(exact.g2.hi, exact.g2.lo + (g.g1 * on.g1 + g.g0 * on.g2));
        let f_less_one = self.pull.times(g2).scaled(-1.0);
        let r = [self.moved(0, f_less_one, gee), self.moved(1, f_less_one, gee), self.moved(2, f_less_one, gee)];
        // Regularised: at the very centre r = 0, where only the velocity has no value.
        let (more, more_lo) = pair::combined(self.eta, g1, self.zeta, g2);
        let (radius, radius_lo) = pair::sum(self.distance.hi, more);
        let radius = Pair::settled(radius, radius_lo + (more_lo + self.distance.lo));
        let least = Pair { hi: s.all(1e-30), lo: s.all(0.0) };
        let radius = Pair::pick(least.hi.below(radius.value()), radius, least);
        let inverse = s.all(1.0) / radius.value();
        let (a, b) = (self.pull.times(g1), self.mu.times(g2));
        (step, r, [self.turned(0, a, b, radius, inverse), self.turned(1, a, b, radius, inverse), self.turned(2, a, b, radius, inverse)])
    }

    /// A component of r₀ + (f − 1) r₀ + g v₀.
    #[inline(always)]
    fn moved(&self, k: usize, f_less_one: Pair<T>, gee: Pair<T>) -> T {
        let (way, way_lo) = pair::combined(self.r0.0[k], f_less_one, self.v0.0[k], gee);
        let (end, end_lo) = pair::sum(way, self.r0.0[k].value());
        end + (end_lo + way_lo)
    }

    /// A component of v₀ − (a r₀ + b v₀)/r.
    #[inline(always)]
    fn turned(&self, k: usize, a: Pair<T>, b: Pair<T>, radius: Pair<T>, inverse: T) -> T {
        let (way, way_lo) = pair::combined(self.r0.0[k], a, self.v0.0[k], b);
        let way = Pair::settled(way, way_lo).over(radius, inverse);
        let (end, end_lo) = pair::sum(self.v0.0[k].value(), -way.hi);
        end + (end_lo - way.lo)
    }
}

impl Orbit {
    /// Position and velocity after a time `dt` (in two words) of at most half a revolution.
    #[inline(always)]
    pub(super) fn after(&self, dt: (f64, f64), pericentre: impl FnOnce() -> Pericentre) -> ([f64; 3], [f64; 3]) {
        let s = self.guess(dt.0, pericentre);
        let (step, r, v) = self.finish(s, dt);
        if step.is_close() { (r, v) } else { self.slowly(s, step, dt) }
    }

    /// Where one step is not enough.
    #[cold]
    fn slowly(&self, mut s: f64, mut step: Step, dt: (f64, f64)) -> ([f64; 3], [f64; 3]) {
        for _ in 0..4 {
            if step.square >= LARGE || step.square.is_nan() {
                break;
            }
            s += step.d;
            let (next, r, v) = self.finish(s, dt);
            if next.is_close() {
                return (r, v);
            }
            step = next;
        }
        let (_, r, v) = self.finish(self.search(s, dt.0), dt);
        (r, v)
    }

    /// The step from `s` in plain arithmetic.
    fn rough(&self, s: f64, dt: f64) -> Step {
        let g = Universal::at(self.beta.value(), s);
        let miss = (self.distance.value() * g.g1 + self.eta.value() * g.g2) + (self.mu.value() * g.g3 - dt);
        self.step(&g, miss)
    }

    /// The root where the quick way failed: Halley's steps inside a bracket that only ever shrinks.
    fn search(&self, start: f64, dt: f64) -> f64 {
        let (mut low, mut high) = self.bracket(dt);
        let mut s = if start > low && start < high { start } else { 0.5 * (low + high) };
        for _ in 0..MOST_STEPS {
            let step = self.rough(s, dt);
            if step.miss > 0.0 {
                high = s;
            } else if step.miss < 0.0 {
                low = s;
            } else {
                break;
            }
            let halley = -2.0 * step.miss * step.radius / (2.0 * step.radius * step.radius - step.miss * step.bend);
            let next = s + if step.square < LARGE { step.d } else { halley };
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if next == s || step.square < SMALL {
                break;
            }
            s = next;
        }
        s
    }

    /// An interval that holds the root, ends included.
    fn bracket(&self, dt: f64) -> (f64, f64) {
        let beta = self.beta.value();
        let far = if beta > 0.0 {
            // |E₁ − E₀| < 2π within half a period.
            core::f64::consts::TAU / beta.sqrt()
        } else {
            // r grows without bound: double until the time is passed.
            let mut s = (dt / self.distance.value()).abs().min(1.0 / (-beta).sqrt()).max(f64::MIN_POSITIVE);
            for _ in 0..2100 {
                let t = self.rough(s.copysign(dt), 0.0).miss;
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
