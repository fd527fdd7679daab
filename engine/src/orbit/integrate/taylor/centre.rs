//! Centre: the Taylor coefficients of massless bodies about one massive body, each body's x, y, z and r² side by side in one vector.
//!
//! A lone massive body is pulled by nothing: it moves straight on, and each massless body's separation d from it obeys d″ = −μ d/r³ by
//! itself. With u = −μ r⁻³ in the place of r⁻³ (the recurrence of a power is linear in it) the product u·(x, y, z, r²) gives force and
//! recurrence at once. Orders are unrolled two by two, as in [`super::pairs`], which says why. Orders 2 and 3, whose rounding is what
//! limits a step, are found again in two words while the step's length is being worked out.
//!
//! - [Jorba & Zou 2005] Experimental Mathematics 14, prop. 2.1 (products and powers of series).

use super::lanes::{EMPTY, Four, Lanes, Two};
use super::step::{self, Bound, EXACT, HALF, INVERSE, ROOM};
use super::{Points, Sink, Stop};
use pulp::f64x4;

/// One massless body's series.
#[derive(Clone, Debug)]
#[repr(align(32))]
struct Orbit {
    /// Coefficients of x, y, z of the separation; the last lane is that of r².
    d: [f64x4; ROOM],
    u: [f64; ROOM],
    /// Position and velocity at the start, from the origin, and orders 2 and 3: two words each.
    start: [[f64x4; 2]; 4],
    body: usize,
    /// Time unit of the series, s.
    unit: f64,
}

/// Massless bodies about one massive body.
#[derive(Clone, Debug)]
pub(super) struct Centre {
    body: usize,
    gm: f64,
    order: usize,
    start: [[f64x4; 2]; 2],
    orbits: Vec<Orbit>,
}

/// Weights of a power's recurrence, in the lane of r² only.
const WEIGHTS: [f64x4; 4 * ROOM] = {
    let mut weights = [EMPTY; 4 * ROOM];
    let mut k = 0;
    while k < weights.len() {
        weights[k] = f64x4(1.0, 1.0, 1.0, HALF[k]);
        k += 1;
    }
    weights
};

impl Centre {
    /// For the one body of `gm` that is not 0.
    pub(super) fn new(gm: &[f64], order: usize) -> Self {
        let body = gm.iter().position(|m| *m > 0.0).unwrap_or(0);
        let orbit = |body| Orbit { d: [EMPTY; ROOM], u: [0.0; ROOM], start: [[EMPTY; 2]; 4], body, unit: 1.0 };
        Self {
            body,
            gm: gm.get(body).copied().unwrap_or(0.0),
            order,
            start: [[EMPTY; 2]; 2],
            orbits: (0..gm.len()).filter(|b| *b != body).map(orbit).collect(),
        }
    }

    /// Build the series; returns the length of the natural step, s.
    #[inline(always)]
    pub(super) fn build<S: Four>(&mut self, s: S, points: &Points, low: &Points, bound: &Bound) -> Result<f64, Stop> {
        let centre = state(s, points, low, self.body);
        self.start = [centre[0].rest(), centre[1].rest()];
        let mut length = f64::INFINITY;
        for orbit in &mut self.orbits {
            let start = state(s, points, low, orbit.body);
            let apart = [start[0].minus(centre[0]), start[1].minus(centre[1])];
            if !orbit.begin(apart[0].high, apart[1].high, self.gm) {
                return Err(Stop::Together(orbit.body.min(self.body), orbit.body.max(self.body)));
            }
            orbit.sweeps(s, self.order);
            let (last_but_one, last) = (Lanes::new(s, orbit.d[self.order - 1]), Lanes::new(s, orbit.d[self.order]));
            let r2 = orbit.d[0].3;
            let ratio = [(last_but_one * last_but_one).sum_of_three() / r2, (last * last).sum_of_three() / r2];
            length = length.min(bound.length(ratio) * orbit.unit);
            orbit.refine(start, apart, self.gm);
        }
        Ok(length)
    }

    /// Position and rate of each body after `h` seconds of the series, put into `to`.
    #[inline(always)]
    pub(super) fn advance<S: Four>(&self, s: S, h: f64, to: &mut impl Sink) {
        let (q, v) = (two(s, self.start[0]), two(s, self.start[1]));
        to.put(self.body, q + v * Lanes::splat(s, h), v);
        for orbit in &self.orbits {
            let [x, v, c2, c3] = orbit.start;
            let start = [two(s, x), two(s, v), two(s, c2), two(s, c3)];
            let (x, v) = step::advance(start, self.order, h / orbit.unit, |k| Lanes::new(s, orbit.d[k]));
            to.put(orbit.body, x, v.scaled(1.0 / orbit.unit));
        }
    }
}

#[inline(always)]
fn two<S: Four>(s: S, [high, low]: [f64x4; 2]) -> Two<S> {
    Two::new(s, high, low)
}

/// Position and velocity of one body.
#[inline(always)]
fn state<S: Four>(s: S, points: &Points, low: &Points, body: usize) -> [Two<S>; 2] {
    [Two::from_vectors(s, points.q[body], low.q[body]), Two::from_vectors(s, points.v[body], low.v[body])]
}

/// t/(r² k); above [`EXACT`] by reciprocals.
#[inline(always)]
#[allow(clippy::cast_precision_loss)] // orders are small
fn over(t: f64, r2: f64, k: usize) -> f64 {
    if k <= EXACT { t / (r2 * k as f64) } else { t * (1.0 / r2 * INVERSE[k]) }
}

/// f/((k−1) k); above [`EXACT`] by reciprocals.
#[inline(always)]
#[allow(clippy::cast_precision_loss)] // orders are small
fn lift<S: Four>(f: Lanes<S>, k: usize) -> Lanes<S> {
    if k <= EXACT { f / f.all(((k - 1) * k) as f64) } else { f * (INVERSE[k - 1] * INVERSE[k]) }
}

impl Orbit {
    /// Orders 0 to 3 in one word. False where the bodies are at one place.
    #[inline(always)]
    fn begin<S: Four>(&mut self, d0: Lanes<S>, v: Lanes<S>, gm: f64) -> bool {
        let r2 = (d0 * d0).sum_of_three();
        if r2 <= 0.0 {
            return false;
        }
        let u = d0.all(r2).inverse_three_halves().array()[0];
        self.unit = step::time_scale(u * gm);
        let d1 = v * self.unit;
        let u0 = -gm * (self.unit * self.unit) * u;
        let r2_1 = 2.0 * (d0 * d1).sum_of_three();
        let u1 = -1.5 * u0 * r2_1 / r2;
        self.d[0] = d0.with_last(r2).rest();
        self.d[1] = d1.with_last(r2_1).rest();
        self.d[2] = (d0 * (0.5 * u0)).rest();
        self.d[3] = ((d1 * u0 + d0 * u1) / d0.all(6.0)).rest();
        self.u[0] = u0;
        self.u[1] = u1;
        true
    }

    /// Orders 4 … `order`, two at a time.
    #[inline(always)]
    fn sweeps<S: Four>(&mut self, s: S, order: usize) {
        macro_rules! each {
            ($($k:literal)*) => { $( if $k + 3 <= order { self.sweep::<S, $k>(s); } )* };
        }
        each!(2 4 6 8 10 12 14 16 18 20 22 24 26 28);
    }

    /// Orders `K` + 2 and `K` + 3 from those below, by r² and u of orders `K` (even) and `K` + 1.
    #[inline(always)]
    fn sweep<S: Four, const K: usize>(&mut self, s: S) {
        let d = |k: usize| Lanes::new(s, self.d[k]);
        let mut even = d(0) * d(K);
        let mut odd = d(0) * d(K + 1);
        for j in 1..K / 2 {
            even = even + d(j) * d(K - j);
            odd = odd + d(j) * d(K + 1 - j);
        }
        let middle = d(K / 2);
        let even = (even * 2.0 + middle * middle).sum_of_three();
        let odd = ((odd + middle * d(K / 2 + 1)) * 2.0).sum_of_three();
        let (newest, next) = (d(K).with_last(even), d(K + 1).with_last(odd));
        // Σ u_j (d, r²)_{k−j}; the last lane with the weights of a power's recurrence, −(3k − j)/2. Oldest terms first: the newest are
        // the ones to wait for.
        let weight = |at: usize| Lanes::new(s, WEIGHTS[at]);
        let u = &self.u;
        let mut f = [Lanes::zero(s); 2];
        let mut g = [Lanes::zero(s); 2];
        for j in 2..K {
            f[j % 2] = f[j % 2] + d(K - j) * u[j] * weight(3 * K - j);
            g[j % 2] = g[j % 2] + d(K + 1 - j) * u[j] * weight(3 * K + 3 - j);
        }
        let f = f[0] + f[1] + d(K - 1) * u[1] * weight(3 * K - 1) + newest * u[0] * weight(3 * K);
        let g = g[0] + g[1] + newest * u[1] * weight(3 * K + 2) + next * u[0] * weight(3 * K + 3);
        let r2 = self.d[0].3;
        let u_even = over(f.array()[3], r2, K);
        let f = f + d(0) * u_even;
        let g = g + d(1) * u_even * weight(2 * K + 3);
        let u_odd = over(g.array()[3], r2, K + 1);
        let g = g + d(0) * u_odd;
        let (lifted, lifted_next) = (lift(f, K + 2), lift(g, K + 3));
        self.d[K] = newest.rest();
        self.d[K + 1] = next.rest();
        self.u[K] = u_even;
        self.u[K + 1] = u_odd;
        self.d[K + 2] = lifted.rest();
        self.d[K + 3] = lifted_next.rest();
    }

    /// Orders 2 and 3 in two words: x₂ = u d/2 and x₃ = u (d′ − 3 (d·d′/r²) d)/6.
    #[inline(always)]
    fn refine<S: Four>(&mut self, start: [Two<S>; 2], apart: [Two<S>; 2], gm: f64) {
        let [d, v] = [apart[0], apart[1].scaled(self.unit)];
        let r2 = (d * d).sum_of_three();
        let square = self.unit * self.unit;
        let u = r2.inverse_three_halves(r2.high.inverse_three_halves()) * d.high.all(-gm * square);
        let three = (d * v).sum_of_three().over(r2) * d.high.all(3.0);
        let bend = (v - three * d) * u;
        let six = d.high.all(6.0);
        let third = bend.over(Two { high: six, low: d.high.all(0.0) });
        self.start = [start[0].rest(), start[1].scaled(self.unit).rest(), (u * d).scaled(0.5).rest(), third.rest()];
    }
}
