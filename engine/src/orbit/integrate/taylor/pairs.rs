//! Pairs: the Taylor coefficients of n bodies that attract each other, all pairs at once, four to a vector.
//!
//! Per pair, with d the separation: r² = d·d, u = (r²)^(−3/2), f = u d; per body a = Σ ± m f, and two orders on, x gains a/((k+1)(k+2)).
//! Because the equation is of second order, x_k and x_{k+1} are both known before a_k: two orders are built in one sweep, which halves
//! the loads and the waiting. Pairs lie in rings (body i with body i + s), so that gathering and scattering are shifted vector loads.
//! Order 0 is done in two words: its rounding is what limits a step; the later orders enter with ever smaller weight.
//!
//! Time is counted in a power of two of the system's shortest time scale, so that no coefficient leaves the range of f64: that scales
//! every number exactly and changes no bit of the result.
//!
//! Not here: how long a step is and how it is summed up ([`super::step`]).
//! - [Jorba & Zou 2005] Experimental Mathematics 14, prop. 2.1 (products and powers of series).

use super::lanes::{EMPTY, Four, Lanes, Two};
use super::step::{self, Bound, EXACT, HALF, INVERSE};
use super::{Points, Sink, Stop};
use glam::DVec3;
use pulp::f64x4;

/// What is kept of four pairs at one order.
#[derive(Clone, Copy, Debug)]
struct Row {
    d: [f64x4; 3],
    r2: f64x4,
    u: f64x4,
}

/// Body i with body i + `shift`, for i below `len`; `at` is its first pair.
#[derive(Clone, Copy, Debug)]
struct Ring {
    shift: usize,
    len: usize,
    at: usize,
}

/// What four pairs from place `at` on give to four bodies.
#[derive(Clone, Copy, Debug)]
struct Term {
    at: usize,
    weight: f64x4,
}

/// Empty places before the first pair, so that a term may start before it.
const LEAD: usize = 4;

/// Series of n bodies. Arrays over bodies are one component after another, each `stride` long and holding the bodies twice, so that
/// body i + s is found without a modulo.
#[derive(Clone, Debug)]
pub(super) struct Pairs {
    n: usize,
    order: usize,
    stride: usize,
    rings: Vec<Ring>,
    /// For each four bodies, what their accelerations consist of.
    terms: Vec<Vec<Term>>,
    /// Of three bodies, the mass of the next and, negative, of the one before: they fit one vector, and turning it replaces shifted
    /// loads, which would wait for the writes that they span.
    three: Option<[f64x4; 2]>,
    /// Sum of the masses of each pair; 0 where neither attracts, and where there is no pair.
    both: Vec<f64x4>,
    /// 1 where a pair counts, else 0.
    mask: Vec<f64x4>,
    /// (order + 1) rows for each four pairs.
    history: Vec<Row>,
    /// Separations, and forces, of the two newest orders: [order][component] over pairs.
    apart: [[Vec<f64>; 3]; 2],
    force: [[Vec<f64>; 3]; 2],
    /// Coefficients over bodies, one array for each order; high words.
    x: Vec<Vec<f64>>,
    /// Low words of orders 0, 1 and 2.
    low: [Vec<f64>; 3],
    /// Time unit of the series, s.
    unit: f64,
}

/// What the accelerations of the four bodies from `first` on consist of: each ring's forces by the second body of its pairs, and, with
/// the other sign, by the first, in two parts where the ring closes.
fn terms(gm: &[f64], rings: &[Ring], first: usize) -> Vec<Term> {
    let n = gm.len();
    let mut terms = Vec::new();
    for ring in rings {
        let lane = |i: usize, f: &dyn Fn(usize) -> f64| if i < n { f(i) } else { 0.0 };
        let lanes = |f: &dyn Fn(usize) -> f64| f64x4(lane(first, f), lane(first + 1, f), lane(first + 2, f), lane(first + 3, f));
        // As first body i of the pair (i, i + shift).
        let as_first = lanes(&|i| if i < ring.len { gm[(i + ring.shift) % n] } else { 0.0 });
        // As second body: pair (i − shift, i), or across the end (i + n − shift, i).
        let as_second = lanes(&|i| if i >= ring.shift && i - ring.shift < ring.len { -gm[i - ring.shift] } else { 0.0 });
        let across = lanes(&|i| if i < ring.shift && i + n - ring.shift < ring.len { -gm[i + n - ring.shift] } else { 0.0 });
        let from = LEAD + ring.at + first;
        for (at, weight) in [(Some(from), as_first), (from.checked_sub(ring.shift), as_second), (Some(from + n - ring.shift), across)] {
            if let (Some(at), true) = (at, weight != EMPTY) {
                terms.push(Term { at, weight });
            }
        }
    }
    terms
}

impl Pairs {
    /// Room for the bodies whose gravitational parameters are `gm`, up to `order` (odd, at least 7).
    pub(super) fn new(gm: &[f64], order: usize) -> Self {
        let n = gm.len();
        let stride = (2 * n + 8) / 4 * 4;
        let (mut rings, mut both, mut at) = (Vec::new(), Vec::new(), 0);
        for shift in 1..=n / 2 {
            let len = if 2 * shift == n { shift } else { n };
            rings.push(Ring { shift, len, at });
            both.extend((0..len).map(|i| gm[i] + gm[(i + shift) % n]));
            at += len;
        }
        both.resize(at.div_ceil(4) * 4, 0.0);
        let fours = |f: fn(f64) -> f64| both.chunks_exact(4).map(|b| f64x4(f(b[0]), f(b[1]), f(b[2]), f(b[3]))).collect();
        let over_pairs = || std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; both.len() + LEAD + 8]));
        Self {
            n,
            order,
            stride,
            terms: (0..n).step_by(4).map(|first| terms(gm, &rings, first)).collect(),
            rings,
            three: if let [a, b, c] = *gm { Some([f64x4(b, c, a, 0.0), f64x4(-c, -a, -b, 0.0)]) } else { None },
            mask: fours(|m| if m > 0.0 { 1.0 } else { 0.0 }),
            both: fours(|m| m),
            history: vec![Row { d: [EMPTY; 3], r2: EMPTY, u: EMPTY }; both.len() / 4 * (order + 1)],
            apart: over_pairs(),
            force: over_pairs(),
            x: vec![vec![0.0; 3 * stride]; order + 1],
            low: std::array::from_fn(|_| vec![0.0; 3 * stride]),
            unit: 1.0,
        }
    }

    /// Build the series; returns the length of the natural step, s.
    #[inline(always)]
    pub(super) fn build<S: Four>(&mut self, s: S, points: &Points, low: &Points, bound: &Bound) -> Result<f64, Stop> {
        for i in 0..self.n {
            let from = [&points.q[i], &points.v[i], &low.q[i], &low.v[i]].map(DVec3::to_array);
            let [q, v, q_low, v_low] = from;
            for (c, (((q, v), q_low), v_low)) in q.into_iter().zip(v).zip(q_low).zip(v_low).enumerate() {
                let at = c * self.stride + i;
                (self.x[0][at], self.x[0][at + self.n]) = (q, q);
                (self.x[1][at], self.x[1][at + self.n]) = (v, v);
                (self.low[0][at], self.low[0][at + self.n]) = (q_low, q_low);
                self.low[1][at] = v_low;
            }
        }
        let unit = step::time_scale(self.first(s)?);
        self.unit = unit;
        self.x[1].iter_mut().for_each(|v| *v *= unit);
        self.low[1].iter_mut().for_each(|v| *v *= unit);
        let square = unit * unit;
        self.second_coefficient(s, square);
        self.next(s);
        self.lift(s, 1, 0, square);
        let mut k = 2;
        while k + 3 <= self.order {
            self.gather(s, k);
            self.sweep(s, k);
            self.lift(s, k, 0, square);
            self.lift(s, k + 1, 1, square);
            k += 2;
        }
        self.gather(s, self.order - 1);
        Ok(bound.length(self.ratio(s)) * unit)
    }

    /// Position and rate of each body after `h` seconds of the series, put into `to`.
    #[inline(always)]
    pub(super) fn advance<S: Four>(&self, s: S, h: f64, to: &mut impl Sink) {
        let (h, back) = (h / self.unit, 1.0 / self.unit);
        for first in (0..self.n).step_by(4) {
            let mut parts = [[[0.0; 4]; 4]; 3];
            for (c, part) in parts.iter_mut().enumerate() {
                let at = c * self.stride + first;
                let (x, low) = (&self.x, &self.low);
                let third = Two { high: Lanes::load(s, &x[3], at), low: Lanes::zero(s) };
                let start = [Two::load(s, &x[0], &low[0], at), Two::load(s, &x[1], &low[1], at), Two::load(s, &x[2], &low[2], at), third];
                let (q, v) = step::advance(start, self.order, h, |k| Lanes::load(s, &x[k], at));
                let v = v.scaled(back);
                *part = [q.high.array(), q.low.array(), v.high.array(), v.low.array()];
            }
            for l in 0..4.min(self.n - first) {
                let (q, v) =
                    (Two::new(s, across(&parts, 0, l), across(&parts, 1, l)), Two::new(s, across(&parts, 2, l), across(&parts, 3, l)));
                to.put(first + l, q, v);
            }
        }
    }

    /// Order 0 in two words: separations and forces. Returns the largest (m + m′)/r³.
    #[inline(always)]
    fn first<S: Four>(&mut self, s: S) -> Result<f64, Stop> {
        for c in 0..3 {
            let (x, low) = (&self.x[0][c * self.stride..], &self.low[0][c * self.stride..]);
            let [high, rest] = &mut self.apart;
            for ring in &self.rings {
                for i in (0..ring.len).step_by(4) {
                    let (a, b) = (Two::load(s, x, low, i), Two::load(s, x, low, i + ring.shift));
                    let d = b.minus(a);
                    d.high.store(&mut high[c], LEAD + ring.at + i);
                    d.low.store(&mut rest[c], LEAD + ring.at + i);
                }
            }
        }
        let mut fastest = Lanes::zero(s);
        let mut nearest = Lanes::splat(s, f64::INFINITY);
        for p in 0..self.both.len() {
            let (both, mask) = (Lanes::new(s, self.both[p]), Lanes::new(s, self.mask[p]));
            let at = LEAD + 4 * p;
            let mut d = [Two { high: mask, low: mask }; 3];
            for (c, d) in d.iter_mut().enumerate() {
                let apart = Two::load(s, &self.apart[0][c], &self.apart[1][c], at);
                *d = Two { high: apart.high * mask, low: apart.low * mask };
            }
            let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            // A lane without a pair has d = 0: let r² be 1 there.
            let r2 = Two { high: r2.high + (mask.all(1.0) - mask), low: r2.low };
            nearest = nearest.smaller(r2.high);
            let u = r2.inverse_three_halves(r2.high.inverse_three_halves());
            fastest = fastest.larger(both * u.high);
            self.history[p * (self.order + 1)] = Row { d: rest([d[0].high, d[1].high, d[2].high]), r2: r2.high.rest(), u: u.high.rest() };
            for (c, d) in d.into_iter().enumerate() {
                let f = u * d;
                f.high.store(&mut self.force[0][c], at);
                f.low.store(&mut self.force[1][c], at);
            }
        }
        if nearest.array().iter().any(|r2| *r2 <= 0.0) { Err(self.together()) } else { Ok(fastest.largest()) }
    }

    /// x₂ = a₀/2 in two words.
    #[inline(always)]
    fn second_coefficient<S: Four>(&mut self, s: S, square: f64) {
        for c in 0..3 {
            for (i, terms) in self.terms.iter().enumerate() {
                let mut a = Two { high: Lanes::zero(s), low: Lanes::zero(s) };
                for term in terms {
                    a = a + Two::load(s, &self.force[0][c], &self.force[1][c], term.at) * Lanes::new(s, term.weight);
                }
                let a = a.scaled(0.5 * square);
                a.high.store(&mut self.x[2], c * self.stride + 4 * i);
                a.low.store(&mut self.low[2], c * self.stride + 4 * i);
            }
            double(s, &mut self.x[2][c * self.stride..], self.n);
        }
    }

    /// Order 1, by the plain rules.
    #[inline(always)]
    fn next<S: Four>(&mut self, s: S) {
        self.gather(s, 0);
        for p in 0..self.both.len() {
            let d1 = self.separation(s, p, 1);
            let rows = &mut self.history[p * (self.order + 1)..(p + 1) * (self.order + 1)];
            let d0 = lanes(s, rows[0].d);
            let (u0, r2_0) = (Lanes::new(s, rows[0].u), Lanes::new(s, rows[0].r2));
            let r2 = (d0[0] * d1[0] + d0[1] * d1[1] + d0[2] * d1[2]) * 2.0;
            let u = u0 * (r2 / r2_0) * -1.5;
            rows[1] = Row { d: rest(d1), r2: r2.rest(), u: u.rest() };
            for c in 0..3 {
                (u0 * d1[c] + u * d0[c]).store(&mut self.force[0][c], LEAD + 4 * p);
            }
        }
    }

    /// Separations of orders `k` and `k` + 1 from the bodies' coefficients.
    #[inline(always)]
    fn gather<S: Four>(&mut self, s: S, k: usize) {
        for (order, apart) in self.apart.iter_mut().enumerate() {
            for (c, apart) in apart.iter_mut().enumerate() {
                let x = &self.x[k + order][c * self.stride..(c + 1) * self.stride];
                if self.three.is_some() {
                    let x = Lanes::load(s, x, 0);
                    (x.next_of_three() - x).store(apart, LEAD);
                    continue;
                }
                for ring in &self.rings {
                    for i in (0..ring.len).step_by(4) {
                        let d = Lanes::load(s, x, i + ring.shift) - Lanes::load(s, x, i);
                        d.store(apart, LEAD + ring.at + i);
                    }
                }
            }
        }
    }

    /// Newest separations of four pairs; 0 where there is no pair that counts.
    #[inline(always)]
    fn separation<S: Four>(&self, s: S, p: usize, order: usize) -> [Lanes<S>; 3] {
        let (apart, mask, at) = (&self.apart[order], Lanes::new(s, self.mask[p]), LEAD + 4 * p);
        [Lanes::load(s, &apart[0], at) * mask, Lanes::load(s, &apart[1], at) * mask, Lanes::load(s, &apart[2], at) * mask]
    }

    /// Forces of orders `k` (even) and `k` + 1 from all separations up to there.
    #[inline(always)]
    fn sweep<S: Four>(&mut self, s: S, k: usize) {
        for p in 0..self.both.len() {
            let (d0, d1) = (self.separation(s, p, 0), self.separation(s, p, 1));
            let rows = &mut self.history[p * (self.order + 1)..][..=k + 1];
            rows[k].d = rest(d0);
            rows[k + 1].d = rest(d1);
            // r² of both orders: mixed terms once, then doubled.
            let (mut s0, mut s1) = ([Lanes::zero(s); 3], [Lanes::zero(s); 3]);
            let mut newer = d1;
            for (a, b) in rows[..k / 2].iter().zip(rows[k / 2 + 1..=k].iter().rev()) {
                for c in 0..3 {
                    let (a, b) = (Lanes::new(s, a.d[c]), Lanes::new(s, b.d[c]));
                    s0[c] = s0[c] + a * b;
                    s1[c] = s1[c] + a * newer[c];
                    newer[c] = b;
                }
            }
            let m = lanes(s, rows[k / 2].d);
            let even = (s0[0] + s0[1] + s0[2]) * 2.0 + (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
            let odd = (s1[0] + s1[1] + s1[2] + (m[0] * newer[0] + m[1] * newer[1] + m[2] * newer[2])) * 2.0;
            rows[k].r2 = even.rest();
            rows[k + 1].r2 = odd.rest();
            // u and u d of both orders, all terms that use no u of these orders.
            let (mut t0, mut t1) = (Lanes::zero(s), Lanes::zero(s));
            let (mut f0, mut f1) = ([Lanes::zero(s); 3], [Lanes::zero(s); 3]);
            let (mut newer, mut newer_r2) = (d1, odd);
            let weights = HALF[2 * k + 1..=3 * k].iter().zip(&HALF[2 * k + 4..=3 * k + 3]).rev();
            for ((a, b), (w0, w1)) in rows[..k].iter().zip(rows[1..=k].iter().rev()).zip(weights) {
                let (u, r2) = (Lanes::new(s, a.u), Lanes::new(s, b.r2));
                t0 = t0 + u * r2 * *w0;
                t1 = t1 + u * newer_r2 * *w1;
                newer_r2 = r2;
                for c in 0..3 {
                    let d = Lanes::new(s, b.d[c]);
                    f0[c] = f0[c] + u * d;
                    f1[c] = f1[c] + u * newer[c];
                    newer[c] = d;
                }
            }
            let (r2, r2_1) = (Lanes::new(s, rows[0].r2), Lanes::new(s, rows[1].r2));
            let inverse = r2.all(1.0) / r2;
            let u0 = over(t0, r2, inverse, k);
            let u1 = over(t1 + u0 * r2_1 * HALF[2 * k + 3], r2, inverse, k + 1);
            rows[k].u = u0.rest();
            rows[k + 1].u = u1.rest();
            for c in 0..3 {
                let (d0, d1) = (Lanes::new(s, rows[0].d[c]), Lanes::new(s, rows[1].d[c]));
                (f0[c] + u0 * d0).store(&mut self.force[0][c], LEAD + 4 * p);
                (f1[c] + u0 * d1 + u1 * d0).store(&mut self.force[1][c], LEAD + 4 * p);
            }
        }
    }

    /// x_{k+2} = a_k/((k+1)(k+2)), a_k from the forces of the newest orders' first or second.
    #[inline(always)]
    #[allow(clippy::cast_precision_loss)] // orders are small
    fn lift<S: Four>(&mut self, s: S, k: usize, newest: usize, square: f64) {
        let divisor = ((k + 1) * (k + 2)) as f64;
        let factor = square * (INVERSE[k + 1] * INVERSE[k + 2]);
        for (c, force) in self.force[newest].iter().enumerate() {
            let x = &mut self.x[k + 2][c * self.stride..(c + 1) * self.stride];
            if let Some([next, last]) = self.three {
                let f = Lanes::load(s, force, LEAD);
                let a = f * Lanes::new(s, next) + f.last_of_three() * Lanes::new(s, last);
                let a = if k + 2 <= EXACT { a * square / a.all(divisor) } else { a * factor };
                a.store(x, 0);
                continue;
            }
            for (i, terms) in self.terms.iter().enumerate() {
                let mut a = Lanes::zero(s);
                for term in terms {
                    a = a + Lanes::load(s, force, term.at) * Lanes::new(s, term.weight);
                }
                let a = if k + 2 <= EXACT { a * square / a.all(divisor) } else { a * factor };
                a.store(x, 4 * i);
            }
            double(s, x, self.n);
        }
    }

    /// Largest |d_k|²/|d_0|² over the pairs, for the last two orders k.
    #[inline(always)]
    fn ratio<S: Four>(&self, s: S) -> [f64; 2] {
        let mut ratio = [Lanes::zero(s); 2];
        for p in 0..self.both.len() {
            let r2 = Lanes::new(s, self.history[p * (self.order + 1)].r2);
            for (order, ratio) in ratio.iter_mut().enumerate() {
                let d = self.separation(s, p, order);
                *ratio = ratio.larger((d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / r2);
            }
        }
        [ratio[0].largest(), ratio[1].largest()]
    }

    /// Which two bodies are at one place.
    fn together(&self) -> Stop {
        for ring in &self.rings {
            for i in 0..ring.len {
                let (pair, other) = (ring.at + i, (i + ring.shift) % self.n);
                let mask = self.mask[pair / 4];
                let counts = [mask.0, mask.1, mask.2, mask.3][pair % 4] > 0.0;
                if counts && self.apart[0].iter().all(|d| d[LEAD + pair] == 0.0) {
                    return Stop::Together(i.min(other), i.max(other));
                }
            }
        }
        Stop::NotFinite
    }
}

/// The second copy of `n` bodies behind the first; from the last on, because the first copy's padding lies in the second.
#[inline(always)]
fn double<S: Four>(s: S, x: &mut [f64], n: usize) {
    for i in (0..n).step_by(4).rev() {
        Lanes::load(s, x, i).store(x, i + n);
    }
}

/// t/(r² k); above [`EXACT`] by reciprocals.
#[inline(always)]
#[allow(clippy::cast_precision_loss)] // orders are small
fn over<S: Four>(t: Lanes<S>, r2: Lanes<S>, inverse: Lanes<S>, k: usize) -> Lanes<S> {
    if k <= EXACT { t / (r2 * k as f64) } else { t * (inverse * INVERSE[k]) }
}

#[inline(always)]
fn lanes<S: Four>(s: S, v: [f64x4; 3]) -> [Lanes<S>; 3] {
    [Lanes::new(s, v[0]), Lanes::new(s, v[1]), Lanes::new(s, v[2])]
}

#[inline(always)]
fn rest<S: Four>(v: [Lanes<S>; 3]) -> [f64x4; 3] {
    [v[0].rest(), v[1].rest(), v[2].rest()]
}

/// x, y and z of body `l` out of components over bodies.
#[inline(always)]
fn across(parts: &[[[f64; 4]; 4]; 3], word: usize, l: usize) -> f64x4 {
    f64x4(parts[0][word][l], parts[1][word][l], parts[2][word][l], 0.0)
}
