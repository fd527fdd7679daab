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

use super::lanes::{V, ZERO, add, add2, inverse_three_halves, load, map, mul, mul_then_add, mul2, mul21, scale, store, sub, two_sum};
use super::step::time_scale;

/// What is kept of four pairs at one order.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    d: [V; 3],
    r2: V,
    u: V,
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
    weight: V,
}

/// Empty places before the first pair, so that a term may start before it.
const LEAD: usize = 4;

/// Orders whose divisions are carried out. Above, a factor 1/k may carry its own rounding, the same in each step: it would drift below.
const EXACT: usize = 7;

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
    /// Sum of the masses of each pair; 0 where neither attracts, and where there is no pair.
    both: Vec<V>,
    /// (order + 1) rows for each four pairs.
    history: Vec<Row>,
    /// Separations, and forces, of the two newest orders: [order][component] over pairs.
    apart: [[Vec<f64>; 3]; 2],
    force: [[Vec<f64>; 3]; 2],
    /// Coefficients over bodies, one array for each order; high words.
    pub(super) x: Vec<Vec<f64>>,
    /// Low words of orders 0, 1 and 2.
    pub(super) low: [Vec<f64>; 3],
    /// 1/k.
    inverse: Vec<f64>,
    /// −k/2.
    half: Vec<f64>,
}

/// What the accelerations of the four bodies from `first` on consist of: each ring's forces by the second body of its pairs, and, with
/// the other sign, by the first, in two parts where the ring closes.
fn terms(gm: &[f64], rings: &[Ring], first: usize) -> Vec<Term> {
    let n = gm.len();
    let mut terms = Vec::new();
    for ring in rings {
        let lanes = |f: &dyn Fn(usize) -> f64| -> V { std::array::from_fn(|l| if first + l < n { f(first + l) } else { 0.0 }) };
        // As first body i of the pair (i, i + shift).
        let as_first = lanes(&|i| if i < ring.len { gm[(i + ring.shift) % n] } else { 0.0 });
        // As second body: pair (i − shift, i), or across the end (i + n − shift, i).
        let as_second = lanes(&|i| if i >= ring.shift && i - ring.shift < ring.len { -gm[i - ring.shift] } else { 0.0 });
        let across = lanes(&|i| if i < ring.shift && i + n - ring.shift < ring.len { -gm[i + n - ring.shift] } else { 0.0 });
        let from = LEAD + ring.at + first;
        for (at, weight) in [(Some(from), as_first), (from.checked_sub(ring.shift), as_second), (Some(from + n - ring.shift), across)] {
            if let (Some(at), true) = (at, weight.iter().any(|w| *w != 0.0)) {
                terms.push(Term { at, weight });
            }
        }
    }
    terms
}

/// Two bodies at one place: their numbers.
pub(super) struct Together(pub usize, pub usize);

/// What a set of series says about the step.
pub(super) struct Reach {
    /// Time unit of the series, s.
    pub unit: f64,
    /// Largest |d_k|²/|d_0|² over the pairs, for k = order − 1 and order.
    pub ratio: [f64; 2],
}

impl Pairs {
    /// Room for the bodies whose gravitational parameters are `gm`, up to `order` (odd, at least 5).
    #[allow(clippy::cast_precision_loss)] // orders are small
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
        let pairs = at.div_ceil(4) * 4;
        both.resize(pairs, 0.0);
        let over_pairs = || std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; pairs + LEAD + 8]));
        Self {
            n,
            order,
            stride,
            terms: (0..n).step_by(4).map(|first| terms(gm, &rings, first)).collect(),
            rings,
            both: both.chunks_exact(4).map(|b| load(b, 0)).collect(),
            history: vec![Row::default(); pairs / 4 * (order + 1)],
            apart: over_pairs(),
            force: over_pairs(),
            x: vec![vec![0.0; 3 * stride]; order + 1],
            low: std::array::from_fn(|_| vec![0.0; 3 * stride]),
            inverse: (0..=order).map(|k| 1.0 / k.max(1) as f64).collect(),
            half: (0..4 * order).map(|k| k as f64 * -0.5).collect(),
        }
    }

    /// Where component `c` of body `i` lies in the arrays over bodies; `i` may be up to twice the number of bodies.
    #[inline(always)]
    pub(super) fn index(&self, c: usize, i: usize) -> usize {
        c * self.stride + i
    }

    /// Fill orders 2 … from orders 0 and 1 (high and low words, bodies 0 … n−1; order 1 per second).
    #[inline(always)]
    pub(super) fn build(&mut self) -> Result<Reach, Together> {
        for c in 0..3 {
            for i in 0..self.n {
                let (from, to) = (self.index(c, i), self.index(c, i + self.n));
                self.x[0][to] = self.x[0][from];
                self.x[1][to] = self.x[1][from];
                self.low[0][to] = self.low[0][from];
            }
        }
        let fastest = self.first()?;
        let unit = time_scale(fastest);
        self.x[1].iter_mut().for_each(|v| *v *= unit);
        self.low[1].iter_mut().for_each(|v| *v *= unit);
        self.second_coefficient(unit);
        self.next(unit);
        let square = unit * unit;
        let mut k = 2;
        while k + 3 <= self.order {
            self.gather(k);
            self.sweep(k);
            self.lift(k, 0, square);
            self.lift(k + 1, 1, square);
            k += 2;
        }
        self.gather(self.order - 1);
        Ok(Reach { unit, ratio: self.ratio() })
    }

    /// Order 0 in two words: separations, forces and accelerations. Returns the largest (m + m′)/r³.
    #[inline(always)]
    fn first(&mut self) -> Result<f64, Together> {
        for c in 0..3 {
            let (x, low) = (&self.x[0][c * self.stride..], &self.low[0][c * self.stride..]);
            let [high, rest] = &mut self.apart;
            for ring in &self.rings {
                for i in (0..ring.len).step_by(4) {
                    let b = (load(x, i + ring.shift), load(low, i + ring.shift));
                    let (s, e) = two_sum(b.0, map(load(x, i), |a| -a));
                    let (s, e) = two_sum(s, add(e, sub(b.1, load(low, i))));
                    store(s, &mut high[c], LEAD + ring.at + i);
                    store(e, &mut rest[c], LEAD + ring.at + i);
                }
            }
        }
        let (mut fastest, mut nearest) = (ZERO, [f64::INFINITY; 4]);
        for (p, both) in self.both.iter().enumerate() {
            let mask = map(*both, |m| if m > 0.0 { 1.0 } else { 0.0 });
            let part = |of: &[Vec<f64>; 3]| -> [V; 3] { std::array::from_fn(|c| mul(load(&of[c], LEAD + 4 * p), mask)) };
            let (d, e) = (part(&self.apart[0]), part(&self.apart[1]));
            let square = |c: usize| mul2((d[c], e[c]), (d[c], e[c]));
            let r2 = add2(add2(square(0), square(1)), square(2));
            nearest = pick(nearest, select(mask, r2.0, nearest), f64::min);
            let r2 = (add(r2.0, map(mask, |m| 1.0 - m)), r2.1);
            let u = inverse_three_halves(r2);
            fastest = pick(fastest, mul(*both, u.0), f64::max);
            let row = &mut self.history[p * (self.order + 1)];
            *row = Row { d, r2: r2.0, u: u.0 };
            for c in 0..3 {
                let f = mul2(u, (d[c], e[c]));
                store(f.0, &mut self.force[0][c], LEAD + 4 * p);
                store(f.1, &mut self.force[1][c], LEAD + 4 * p);
            }
        }
        if nearest.iter().any(|r2| *r2 <= 0.0) {
            return Err(self.together());
        }
        Ok(pick_all(fastest, f64::max))
    }

    /// x₂ = a₀/2 in two words.
    #[inline(always)]
    fn second_coefficient(&mut self, unit: f64) {
        let half = 0.5 * unit * unit;
        for c in 0..3 {
            let (force, rest) = (&self.force[0][c], &self.force[1][c]);
            for (i, terms) in self.terms.iter().enumerate() {
                let mut a = (ZERO, ZERO);
                for term in terms {
                    a = add2(a, mul21((load(force, term.at), load(rest, term.at)), term.weight));
                }
                let at = c * self.stride + 4 * i;
                store(scale(a.0, half), &mut self.x[2], at);
                store(scale(a.1, half), &mut self.low[2], at);
            }
            self.double(2, c);
        }
    }

    /// Order 1, by the plain rules.
    #[inline(always)]
    fn next(&mut self, unit: f64) {
        self.gather(0);
        for p in 0..self.both.len() {
            let d1 = self.separation(p, 1);
            let rows = &mut self.history[p * (self.order + 1)..(p + 1) * (self.order + 1)];
            let zero = rows[0];
            let r2 = scale(dot(&zero.d, &d1), 2.0);
            let u = scale(mul(zero.u, over(r2, zero.r2)), -1.5);
            rows[1] = Row { d: d1, r2, u };
            for c in 0..3 {
                store(mul_then_add(zero.u, d1[c], mul(u, zero.d[c])), &mut self.force[0][c], LEAD + 4 * p);
            }
        }
        self.lift(1, 0, unit * unit);
    }

    /// Separations of orders `k` and `k` + 1 from the bodies' coefficients.
    #[inline(always)]
    fn gather(&mut self, k: usize) {
        for (order, apart) in self.apart.iter_mut().enumerate() {
            for (c, apart) in apart.iter_mut().enumerate() {
                let x = &self.x[k + order][c * self.stride..(c + 1) * self.stride];
                for ring in &self.rings {
                    for i in (0..ring.len).step_by(4) {
                        store(sub(load(x, i + ring.shift), load(x, i)), apart, LEAD + ring.at + i);
                    }
                }
            }
        }
    }

    /// Newest separations of four pairs; 0 where there is no pair that counts.
    #[inline(always)]
    fn separation(&self, p: usize, order: usize) -> [V; 3] {
        let both = self.both[p];
        let d = std::array::from_fn(|c| load(&self.apart[order][c], LEAD + 4 * p));
        if both.iter().all(|m| *m > 0.0) { d } else { d.map(|d| map2(d, both, |d, m| if m > 0.0 { d } else { 0.0 })) }
    }

    /// Forces of orders `k` (even) and `k` + 1 from all separations up to there.
    #[inline(always)]
    #[allow(clippy::cast_precision_loss)] // orders are small
    fn sweep(&mut self, k: usize) {
        let (slow, slower, index) = (self.inverse[k], self.inverse[k + 1], k as f64);
        for p in 0..self.both.len() {
            let (d0, d1) = (self.separation(p, 0), self.separation(p, 1));
            let rows = &mut self.history[p * (self.order + 1)..][..=k + 1];
            rows[k].d = d0;
            rows[k + 1].d = d1;
            // r² of both orders: mixed terms once, then doubled.
            let (mut s0, mut s1) = ([ZERO; 3], [ZERO; 3]);
            let mut newer = d1;
            for (a, b) in rows[..k / 2].iter().zip(rows[k / 2 + 1..=k].iter().rev()) {
                for c in 0..3 {
                    s0[c] = mul_then_add(a.d[c], b.d[c], s0[c]);
                    s1[c] = mul_then_add(a.d[c], newer[c], s1[c]);
                }
                newer = b.d;
            }
            let middle = rows[k / 2].d;
            let even = add(scale(add(add(s0[0], s0[1]), s0[2]), 2.0), dot(&middle, &middle));
            let odd = scale(add(add(add(s1[0], s1[1]), s1[2]), dot(&middle, &newer)), 2.0);
            rows[k].r2 = even;
            rows[k + 1].r2 = odd;
            // u and u d of both orders, all terms that use no u of these orders.
            let (mut t0, mut t1, mut f0, mut f1) = (ZERO, ZERO, [ZERO; 3], [ZERO; 3]);
            let mut newer = rows[k + 1];
            let weights = self.half[2 * k + 1..=3 * k].iter().zip(&self.half[2 * k + 4..=3 * k + 3]).rev();
            for ((a, b), (w0, w1)) in rows[..k].iter().zip(rows[1..=k].iter().rev()).zip(weights) {
                t0 = add(t0, scale(mul(a.u, b.r2), *w0));
                t1 = add(t1, scale(mul(a.u, newer.r2), *w1));
                for c in 0..3 {
                    f0[c] = mul_then_add(a.u, b.d[c], f0[c]);
                    f1[c] = mul_then_add(a.u, newer.d[c], f1[c]);
                }
                newer = *b;
            }
            let r2 = rows[0].r2;
            let inverse = map(r2, |r2| 1.0 / r2);
            let exact = k <= EXACT;
            let u0 = if exact { over(t0, scale(r2, index)) } else { mul(t0, scale(inverse, slow)) };
            let t1 = add(t1, scale(mul(u0, rows[1].r2), self.half[2 * k + 3]));
            let u1 = if exact { over(t1, scale(r2, index + 1.0)) } else { mul(t1, scale(inverse, slower)) };
            rows[k].u = u0;
            rows[k + 1].u = u1;
            for c in 0..3 {
                store(mul_then_add(u0, rows[0].d[c], f0[c]), &mut self.force[0][c], LEAD + 4 * p);
                let f = mul_then_add(u0, rows[1].d[c], f1[c]);
                store(mul_then_add(u1, rows[0].d[c], f), &mut self.force[1][c], LEAD + 4 * p);
            }
        }
    }

    /// x_{k+2} = a_k/((k+1)(k+2)), a_k from the forces of the newest orders' first or second.
    #[inline(always)]
    #[allow(clippy::cast_precision_loss)] // orders are small
    fn lift(&mut self, k: usize, newest: usize, square: f64) {
        let divisor = ((k + 1) * (k + 2)) as f64;
        let factor = square * (self.inverse[k + 1] * self.inverse[k + 2]);
        let x = &mut self.x[k + 2];
        for (c, force) in self.force[newest].iter().enumerate() {
            for (i, terms) in self.terms.iter().enumerate() {
                let mut a = ZERO;
                for term in terms {
                    a = mul_then_add(load(force, term.at), term.weight, a);
                }
                let a = if k + 2 <= EXACT { map(scale(a, square), |a| a / divisor) } else { scale(a, factor) };
                store(a, x, c * self.stride + 4 * i);
            }
        }
        for c in 0..3 {
            self.double(k + 2, c);
        }
    }

    /// The second copy of the bodies behind the first; from the last on, because the first copy's padding lies in the second.
    #[inline(always)]
    fn double(&mut self, k: usize, c: usize) {
        let x = &mut self.x[k][c * self.stride..(c + 1) * self.stride];
        for i in (0..self.n).step_by(4).rev() {
            store(load(x, i), x, i + self.n);
        }
    }

    #[inline(always)]
    fn ratio(&self) -> [f64; 2] {
        let mut ratio = [ZERO; 2];
        for p in 0..self.both.len() {
            let r2 = self.history[p * (self.order + 1)].r2;
            for (order, ratio) in ratio.iter_mut().enumerate() {
                let d = self.separation(p, order);
                *ratio = pick(*ratio, over(dot(&d, &d), r2), f64::max);
            }
        }
        ratio.map(|r| pick_all(r, f64::max))
    }

    /// Which two bodies are at one place.
    fn together(&self) -> Together {
        for ring in &self.rings {
            for i in 0..ring.len {
                let pair = ring.at + i;
                if self.both[pair / 4][pair % 4] > 0.0 && self.apart[0].iter().all(|d| d[LEAD + pair] == 0.0) {
                    let other = (i + ring.shift) % self.n;
                    return Together(i.min(other), i.max(other));
                }
            }
        }
        Together(0, 0)
    }
}

#[inline(always)]
fn map2(a: V, b: V, f: impl Fn(f64, f64) -> f64) -> V {
    [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])]
}

#[inline(always)]
fn over(a: V, b: V) -> V {
    map2(a, b, |a, b| a / b)
}

#[inline(always)]
fn dot(a: &[V; 3], b: &[V; 3]) -> V {
    add(add(mul(a[0], b[0]), mul(a[1], b[1])), mul(a[2], b[2]))
}

#[inline(always)]
fn select(mask: V, yes: V, no: V) -> V {
    std::array::from_fn(|l| if mask[l] > 0.0 { yes[l] } else { no[l] })
}

#[inline(always)]
fn pick(a: V, b: V, f: impl Fn(f64, f64) -> f64) -> V {
    map2(a, b, f)
}

#[inline(always)]
fn pick_all(a: V, f: impl Fn(f64, f64) -> f64) -> f64 {
    f(f(a[0], a[2]), f(a[1], a[3]))
}
