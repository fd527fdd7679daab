//! Centre: the Taylor coefficients of massless bodies about one massive body, each body's x, y, z and r² side by side in one vector.
//!
//! A lone massive body is pulled by nothing: it moves straight on, and each massless body's separation d from it obeys d″ = −μ d/r³ by
//! itself. With u = −μ r⁻³ in the place of r⁻³ (the recurrence of a power is linear in it) the product u·(x, y, z, r²) gives force and
//! recurrence at once. Orders are unrolled two by two, as in [`super::pairs`], which says why. Orders 2 and 3, whose rounding is what
//! limits a step, are found again in two words while the step's length is being worked out.
//!
//! - [Jorba & Zou 2005] Experimental Mathematics 14, prop. 2.1 (products and powers of series).

use super::lanes::{EMPTY, Four, Lanes, Two};
use super::step::{self, Bound, HALF, INVERSE, ROOM};
use super::{Points, Sink, Stop};
use pulp::f64x4;

/// One massless body's series.
#[derive(Clone, Debug)]
#[repr(align(32))]
struct Orbit {
    /// Coefficients of x, y, z of the separation d; the last lane is that of r²/r₀².
    d: [f64x4; ROOM],
    /// Those of 2 d/r₀², as far as they are needed.
    e: [f64x4; ROOM],
    /// Those of u.
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
        let orbit = |body| Orbit { d: [EMPTY; ROOM], e: [EMPTY; ROOM], u: [0.0; ROOM], start: [[EMPTY; 2]; 4], body, unit: 1.0 };
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
            let e = Lanes::new(s, orbit.e[0]).array()[3];
            let ratio = [(last_but_one * last_but_one).sum_of_three() * e, (last * last).sum_of_three() * e];
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

impl Orbit {
    /// Orders 0 to 5 in one word, those of r² and u to 3. False where the bodies are at one place.
    #[inline(always)]
    fn begin<S: Four>(&mut self, d0: Lanes<S>, v: Lanes<S>, gm: f64) -> bool {
        let r2 = (d0 * d0).sum_of_three();
        if r2 <= 0.0 {
            return false;
        }
        let u = d0.all(r2).inverse_three_halves().array()[0];
        self.unit = step::time_scale(u * gm);
        let inverse = 1.0 / r2;
        let d1 = v * self.unit;
        let (e0, e1) = (d0 * (2.0 * inverse), d1 * (2.0 * inverse));
        let u0 = -gm * (self.unit * self.unit) * u;
        let r1 = (e0 * d1).sum_of_three();
        let u1 = -1.5 * u0 * r1;
        let d2 = d0 * (0.5 * u0);
        let d3 = (d1 * u0 + d0 * u1) / d0.all(6.0);
        // Orders 2 and 3 of r² and u, 4 and 5 of d.
        let r2 = (e0 * d2 + e1 * d1 * 0.5).sum_of_three();
        let r3 = (e0 * d3 + e1 * d2).sum_of_three();
        let u2 = -1.5 * r2 * u0 - 1.25 * r1 * u1;
        let u3 = -(9.0 * r3 * u0 + 8.0 * r2 * u1 + 7.0 * r1 * u2) / 6.0;
        let d4 = (d2 * u0 + d1 * u1 + d0 * u2) / d0.all(12.0);
        let d5 = (d3 * u0 + d2 * u1 + d1 * u2 + d0 * u3) / d0.all(20.0);
        self.e[0] = e0.with_last(inverse).rest();
        self.e[1] = e1.rest();
        self.e[2] = (d2 * (2.0 * inverse)).rest();
        self.d[0] = d0.with_last(1.0).rest();
        self.d[1] = d1.with_last(r1).rest();
        self.d[2] = d2.with_last(r2).rest();
        self.d[3] = d3.with_last(r3).rest();
        self.d[4] = d4.rest();
        self.d[5] = d5.rest();
        self.u[..4].copy_from_slice(&[u0, u1, u2, u3]);
        true
    }

    /// Orders 6 … `order`, two at a time.
    #[inline(always)]
    fn sweeps<S: Four>(&mut self, s: S, order: usize) {
        macro_rules! each {
            ($($k:literal)*) => { $( if $k + 3 <= order { self.sweep::<S, $k>(s); } )* };
        }
        each!(4 6 8 10 12 14 16 18 20 22 24 26 28);
    }

    /// Orders `K` + 2 and `K` + 3 from those below, by r² and u of orders `K` (even) and `K` + 1.
    ///
    /// With m = k − j, `u_k = −Σ (1 + m/2k) (r²/r₀²)_m u_j`. What hangs on the newest orders comes last: each sweep waits for the one
    /// before it, and this is the way through.
    #[inline(always)]
    #[allow(clippy::cast_precision_loss)] // orders are small
    fn sweep<S: Four, const K: usize>(&mut self, s: S) {
        let (u, inverse) = (&self.u, self.e[0].3);
        macro_rules! d {
            ($k:expr) => {
                Lanes::new(s, self.d[$k])
            };
        }
        macro_rules! e {
            ($k:expr) => {
                Lanes::new(s, self.e[$k])
            };
        }
        // Of order k, the weight of (r²)_m.
        macro_rules! weight {
            ($k:expr, $m:expr) => {
                -((2 * $k + $m) as f64) / ((2 * $k) as f64)
            };
        }
        // Terms of all but the newest orders: force in lanes x, y, z, and in the last the sum for u, times k.
        macro_rules! old {
            ($order:expr, $j:expr) => {
                d!($order - $j) * u[$j] * Lanes::new(s, WEIGHTS[3 * $order - $j])
            };
        }
        let (mut f, mut g, mut f_odd, mut g_odd) = (old!(K, 2), old!(K + 1, 2), Lanes::zero(s), Lanes::zero(s));
        for j in (3..K - 2).step_by(2) {
            f_odd = f_odd + old!(K, j);
            g_odd = g_odd + old!(K + 1, j);
            f = f + old!(K, j + 1);
            g = g + old!(K + 1, j + 1);
        }
        let (f, g) = (f + f_odd, g + g_odd);
        let (r1, r2, r_last) = (self.d[1].3, self.d[2].3, self.d[K - 1].3);
        let t = f.array()[3] * INVERSE[K] + weight!(K, K - 1) * u[1] * r_last + weight!(K, 1) * r1 * u[K - 1];
        let t_next = g.array()[3] * INVERSE[K + 1] + weight!(K + 1, 2) * r2 * u[K - 1];
        let (mut even, mut odd) = (e!(K / 2) * d!(K / 2) * 0.5, e!(K / 2) * d!(K / 2 + 1));
        for j in (1..K / 2).rev() {
            even = even + e!(j) * d!(K - j);
            odd = odd + e!(j) * d!(K + 1 - j);
        }
        let (lift, lift_next) = (INVERSE[K + 1] * INVERSE[K + 2], INVERSE[K + 2] * INVERSE[K + 3]);
        let f = (f + d!(1) * u[K - 1] + d!(K - 1) * u[1]) * lift + d!(K) * (u[0] * lift);
        let g = (g + d!(2) * u[K - 1] + d!(K) * u[1]) * lift_next + d!(K + 1) * (u[0] * lift_next);
        // The newest.
        let even = (even + e!(0) * d!(K)).sum_of_three();
        let odd = (odd + e!(0) * d!(K + 1)).sum_of_three();
        let u_even = t + weight!(K, K) * u[0] * even;
        let u_odd = t_next + weight!(K + 1, K) * u[1] * even + weight!(K + 1, K + 1) * u[0] * odd + weight!(K + 1, 1) * r1 * u_even;
        let next = f + d!(0) * lift * u_even;
        let next_but_one = g + d!(1) * lift_next * u_even + d!(0) * lift_next * u_odd;
        self.d[K] = d!(K).with_last(even).rest();
        self.d[K + 1] = d!(K + 1).with_last(odd).rest();
        self.e[K / 2 + 1] = (d!(K / 2 + 1) * (2.0 * inverse)).rest();
        self.u[K] = u_even;
        self.u[K + 1] = u_odd;
        self.d[K + 2] = next.rest();
        self.d[K + 3] = next_but_one.rest();
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
