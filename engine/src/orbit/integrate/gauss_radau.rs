//! Gauss–Radau of order 15 (IAS15): the acceleration over a step as a polynomial through eight nodes, found by iteration,
//! with a step that follows the shortest time scale of the motion and sums that keep what rounding drops.
//!
//! For forces of any form, velocities included, and for close encounters. Per step and body, with h in units of the step,
//! a(h) = a₀ + b₀h + … + b₆h⁷; positions are its double integral; the b of one step predict those of the next.
//! Not here: the nodes and tables (`coefficients`), other families (see [`super`]).
//! - [Everhart 1985] "An efficient integrator that uses Gauss–Radau spacings", IAU Coll. 83, 185.
//! - [Rein & Spiegel 2015] "IAS15: a fast, adaptive, high-order integrator", MNRAS 446, 1424.
//! - [Pham, Rein & Spiegel 2024] "A new timestep criterion for N-body simulations", OJAp 7, 1.

mod coefficients;
#[cfg(test)]
mod tests;

use super::sums::{Carry, carry, two_product, two_sum};
use super::{Force, Points, Step, Work};
use coefficients::{APART, FROM_NEWTON, NODES, SHIFT, TERMS, TO_NEWTON};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Iterations after which a step that has not settled is taken as it is; its size then tells the control to shrink.
const MAX_ITERATIONS: u32 = 12;
/// Sweeps end where b₆ moves by less than this part of the acceleration. 4.3e-3 of that is felt: below 1e-13 it is noise.
const SETTLED: f64 = 1e-13;
/// A step may be this many times longer than the last; one that should have been this many times shorter is rejected.
const MAX_CHANGE: f64 = 4.0;
/// Beyond this ratio of steps the last polynomial says nothing about the next.
const MAX_PREDICTED: f64 = 20.0;
/// A step below this part of the time reached (or to be reached) cannot help: two points are at one place.
const SHORTEST: f64 = 1e-28;

/// What a path needs, beside its [`Points`], to go on with the same bits: save it with them. Arrays are flat (x, y, z of each point).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// What rounding has dropped so far.
    low: Carry,
    /// The step that the control asks for next; 0 before the first. Signed.
    natural: f64,
    /// The last step made, signed; 0 before the first. From here on: that step, for prediction and dense output.
    done: f64,
    t0: f64,
    q0: Vec<f64>,
    v0: Vec<f64>,
    q0_low: Vec<f64>,
    v0_low: Vec<f64>,
    a0: Vec<f64>,
    b: [Vec<f64>; TERMS],
    /// What b was predicted to be, where it was.
    e: [Vec<f64>; TERMS],
    predicted: bool,
}

/// The integrator: tolerance, memory and buffers. One for each set of points; [`GaussRadau::forget`] when those jump.
#[derive(Clone, Debug)]
pub struct GaussRadau {
    /// (5040 ε)^{1/7}: the step in time scales of the motion.
    scales: f64,
    /// By how much of its size b₆ may still move where the sweeps end.
    settled: f64,
    memory: Memory,
    b: [Vec<f64>; TERMS],
    e: [Vec<f64>; TERMS],
    g: [Vec<f64>; TERMS],
    a0: Vec<f64>,
    a: Vec<DVec3>,
    q: Vec<DVec3>,
    v: Vec<DVec3>,
    work: Work,
}

impl GaussRadau {
    /// Tolerance that gives rounding-level paths [Pham, Rein & Spiegel 2024, §3].
    pub const TOLERANCE: f64 = 1e-9;

    /// For `n` points; `tolerance` is ε, the relative size of what the polynomial leaves out (1e-9 is at the floor of f64; above
    /// about 1e-3 the steps are too long for the iteration). What is not a positive number counts as [`Self::TOLERANCE`].
    pub fn new(n: usize, tolerance: f64) -> Self {
        let tolerance = if tolerance > 0.0 && tolerance.is_finite() { tolerance } else { Self::TOLERANCE };
        let mut new = Self {
            scales: libm::pow(5040.0 * tolerance, 1.0 / 7.0),
            settled: SETTLED,
            memory: Memory::default(),
            b: Default::default(),
            e: Default::default(),
            g: Default::default(),
            a0: Vec::new(),
            a: Vec::new(),
            q: Vec::new(),
            v: Vec::new(),
            work: Work::default(),
        };
        new.fit(n);
        new
    }

    /// The same with sweeps that end where b₆ is about to move by less than `settled` of the acceleration (else 1e-13, where noise
    /// begins): with a tolerance far above the floor of f64 nothing is lost by 1e-11.
    pub fn settling(mut self, settled: f64) -> Self {
        self.settled = settled;
        self
    }

    /// What must be saved beside the points for a restart with the same bits.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Goes on where `memory` was saved (with the points of that moment).
    pub fn resume(&mut self, memory: Memory) {
        self.memory = memory;
    }

    /// Starts afresh: for points that jumped, or a force that changed (an engine lit or cut).
    pub fn forget(&mut self) {
        self.memory = Memory::default();
    }

    /// Steps to `t_end`. Where a step cannot be made the points stay at a time before it: compare `points.t`.
    pub fn run<F: Force>(&mut self, force: &F, points: &mut Points, t_end: f64) -> Work {
        let before = self.work;
        while self.step(force, points, t_end) == Step::Made {}
        Work {
            steps: self.work.steps - before.steps,
            rejected: self.work.rejected - before.rejected,
            evaluations: self.work.evaluations - before.evaluations,
        }
    }

    /// What all steps so far have cost.
    pub fn work(&self) -> Work {
        self.work
    }

    /// One step of natural size towards `t_end` (later or earlier than now), cut so that it never passes it.
    pub fn step<F: Force>(&mut self, force: &F, points: &mut Points, t_end: f64) -> Step {
        let n = points.q.len();
        if points.v.len() != n || self.memory.low.q.len() != 3 * n || self.a.len() != n {
            self.fit(n);
            points.v.resize(n, DVec3::ZERO);
        }
        let left = self.memory.low.left(points, t_end);
        if left == 0.0 {
            return Step::Arrived;
        }
        let shortest = SHORTEST * points.t.abs().max(t_end.abs());
        force.accelerations(points.t, &points.q, &points.v, &mut self.a);
        self.work.evaluations += 1;
        self.a0.copy_from_slice(flat(&self.a));
        let mut natural = if self.memory.natural != 0.0 { self.memory.natural.copysign(left) } else { self.first_guess(points, left) };
        loop {
            let dt = if natural.abs() < left.abs() { natural } else { left };
            if !dt.is_finite() || dt.abs() <= shortest {
                return Step::Stalled;
            }
            let predicted = self.predict(dt);
            self.iterate(force, points, dt);
            let wanted = self.wanted(dt);
            // A ratio that is no number comes from a polynomial that is none: much too long a step.
            let ratio = wanted / dt;
            if ratio.is_nan() || ratio < 1.0 / MAX_CHANGE || !self.keeps_finite(points, dt) {
                self.work.rejected += 1;
                natural = if ratio > 0.0 && ratio < 1.0 { wanted } else { dt / (4.0 * MAX_CHANGE) };
                continue;
            }
            let longest = MAX_CHANGE * dt.abs().max(natural.abs());
            self.memory.natural = wanted.abs().min(longest).min(f64::MAX).copysign(dt);
            self.memory.predicted = predicted;
            self.commit(points, dt);
            self.work.steps += 1;
            return Step::Made;
        }
    }

    /// Positions and velocities at `t`, inside the last step (beyond it the polynomial goes on, ever less true). At the
    /// default tolerance within 1e-14 of the orbit's size (velocities 1e-12). Slices are of the points' length; nothing is written before the first step.
    pub fn dense(&self, t: f64, q: &mut [DVec3], v: &mut [DVec3]) {
        let m = &self.memory;
        if m.done == 0.0 || m.q0.len() != 3 * q.len() || q.len() != v.len() {
            return;
        }
        let h = (t - m.t0) / m.done;
        let place = Weights::at(h, m.done);
        place.positions(&m.q0, &m.q0_low, &m.v0, &m.a0, &m.b, q);
        place.velocities(&m.v0, &m.v0_low, &m.a0, &m.b, v);
    }

    /// Makes every buffer that of `n` points.
    fn fit(&mut self, n: usize) {
        let m = 3 * n;
        self.memory.low.fit(n);
        self.a0.resize(m, 0.0);
        for k in 0..TERMS {
            for list in [&mut self.b[k], &mut self.e[k], &mut self.g[k]] {
                list.resize(m, 0.0);
            }
        }
        self.a.resize(n, DVec3::ZERO);
        self.q.resize(n, DVec3::ZERO);
        self.v.resize(n, DVec3::ZERO);
    }

    /// A first step: a hundredth of the shortest v/a, which the control then mends at MAX_CHANGE a step.
    fn first_guess(&self, points: &Points, left: f64) -> f64 {
        let mut shortest = 1e-2 * left.abs();
        for (v, a) in points.v.iter().zip(&self.a) {
            let scale = 0.01 * v.length() / a.length();
            if scale.is_normal() {
                shortest = shortest.min(scale);
            }
        }
        shortest.max(1e-12 * left.abs()).copysign(left)
    }

    /// Fills b, e and g for a step of `dt` from the last step's polynomial [Everhart 1985, eq. 13]; false where that says nothing.
    #[allow(clippy::needless_range_loop, reason = "k is a row of five tables and a power")]
    fn predict(&mut self, dt: f64) -> bool {
        let m = &self.memory;
        let ratio = dt / m.done;
        let useful = m.done != 0.0 && ratio.abs() <= MAX_PREDICTED && m.b[0].len() == self.b[0].len();
        if !useful {
            for list in self.b.iter_mut().chain(&mut self.e).chain(&mut self.g) {
                list.fill(0.0);
            }
            return false;
        }
        let mut power = 1.0;
        for k in 0..TERMS {
            power *= ratio;
            for i in 0..self.b[k].len() {
                let mut sum = 0.0;
                for j in (k..TERMS).rev() {
                    sum += SHIFT[j][k] * m.b[j][i];
                }
                let e = power * sum;
                self.e[k][i] = e;
                // The last prediction's miss is the best guess of this one's.
                self.b[k][i] = if m.predicted { e + (m.b[k][i] - m.e[k][i]) } else { e };
            }
        }
        for k in 0..TERMS {
            for i in 0..self.g[k].len() {
                let mut sum = 0.0;
                for j in (k..TERMS).rev() {
                    sum += TO_NEWTON[j][k] * self.b[j][i];
                }
                self.g[k][i] = sum;
            }
        }
        true
    }

    /// Finds the polynomial of a step of `dt`: sweeps over the nodes until b₆ stands still [Rein & Spiegel 2015, §2.2].
    fn iterate<F: Force>(&mut self, force: &F, points: &Points, dt: f64) {
        let mut last = f64::INFINITY;
        for sweep in 0..MAX_ITERATIONS {
            let (mut change, mut size) = (0.0_f64, 0.0_f64);
            for (node, h) in NODES.iter().enumerate().skip(1) {
                let place = Weights::at(*h, dt);
                let (q0, v0) = (flat(&points.q), flat(&points.v));
                place.positions(q0, &self.memory.low.q, v0, &self.a0, &self.b, &mut self.q);
                if F::USES_VELOCITY {
                    place.velocities(v0, &self.memory.low.v, &self.a0, &self.b, &mut self.v);
                }
                force.accelerations(points.t + h * dt, &self.q, &self.v, &mut self.a);
                let (moved, largest) = self.absorb(node);
                (change, size) = (moved, largest);
            }
            self.work.evaluations += TERMS as u64;
            let error = if size > 0.0 { change / size } else { 0.0 };
            // The sweeps converge geometrically, the later ones up to ten times slower than the first; from noise on they shrink no
            // longer.
            let next = if sweep > 0 { 10.0 * error * (error / last) } else { error };
            if next.is_nan() || next <= self.settled || sweep > 1 && error >= last {
                break;
            }
            last = error;
        }
    }

    /// Takes the accelerations at a node into g and b; returns how far the node's b moved and the largest acceleration.
    fn absorb(&mut self, node: usize) -> (f64, f64) {
        let apart = &APART[node];
        let weights = &FROM_NEWTON[node - 1];
        let (mut moved, mut largest) = (0.0_f64, 0.0_f64);
        for (i, a) in flat(&self.a).iter().enumerate() {
            // By division, as in `bend_over`: a rounded reciprocal makes the energy of 1000 orbits drift by 1e-14.
            let mut g = (a - self.a0[i]) / NODES[node];
            for (lower, apart) in self.g.iter().zip(&apart[1..node]) {
                g = (g - lower[i]) * apart;
            }
            let change = g - self.g[node - 1][i];
            self.g[node - 1][i] = g;
            for (b, weight) in self.b.iter_mut().zip(weights).take(node) {
                b[i] += weight * change;
            }
            moved = moved.max(change.abs());
            largest = largest.max(a.abs());
        }
        (moved, largest)
    }

    /// The step that the tolerance allows where this one ends: the shortest time scale of any point, from its acceleration, jerk and
    /// snap [Pham, Rein & Spiegel 2024, eq. 16]. Where an acceleration passes through zero that scale would vanish with it though
    /// nothing fast happens: there the same expression one derivative up rules. Infinite where nothing bends.
    fn wanted(&self, dt: f64) -> f64 {
        let mut shortest = f64::INFINITY;
        for i in (0..self.a0.len()).step_by(3) {
            let mut y = [0.0; 4];
            for c in i..i + 3 {
                let mut x = [0.0; 4];
                let mut k = TERMS as f64;
                for b in self.b.iter().rev() {
                    x[0] += b[c];
                    x[1] += k * b[c];
                    x[2] += k * (k - 1.0) * b[c];
                    x[3] += k * (k - 1.0) * (k - 2.0) * b[c];
                    k -= 1.0;
                }
                x[0] += self.a0[c];
                for (y, x) in y.iter_mut().zip(x) {
                    *y += x * x;
                }
            }
            let scale2 = |low: usize| 2.0 * y[low] / (y[low + 1] + (y[low] * y[low + 2]).sqrt());
            // max passes over the NaN of a point that feels nothing; one that no number describes is seen by `keeps_finite`.
            let longer = scale2(0).max(scale2(1));
            shortest = shortest.min(longer);
        }
        shortest.sqrt() * dt * self.scales
    }

    /// True when the step ends at numbers.
    fn keeps_finite(&self, points: &Points, dt: f64) -> bool {
        let mut sum = 0.0;
        for b in &self.b {
            sum += b.iter().sum::<f64>();
        }
        let reach: f64 = points.q.iter().zip(&points.v).map(|(q, v)| (*q + *v * dt).length_squared()).sum();
        (sum * dt * dt).is_finite() && reach.is_finite()
    }

    /// Makes the step: adds it to points and memory.
    fn commit(&mut self, points: &mut Points, dt: f64) {
        let m = &mut self.memory;
        m.t0 = points.t;
        m.done = dt;
        for (to, from) in m.b.iter_mut().zip(&self.b).chain(m.e.iter_mut().zip(&self.e)) {
            to.clone_from(from);
        }
        m.a0.clone_from(&self.a0);
        m.q0.clear();
        m.q0.extend_from_slice(flat(&points.q));
        m.v0.clear();
        m.v0.extend_from_slice(flat(&points.v));
        m.q0_low.clone_from(&m.low.q);
        m.v0_low.clone_from(&m.low.v);
        for (i, q) in flat_mut(&mut points.q).iter_mut().enumerate() {
            // The long part, v₀·dt, is kept to the last bit; what bends it is added to what that drops.
            let (straight, rest) = two_product(m.v0[i], dt);
            let bend = dt * (dt * bend_over(i, m.a0[i], &m.b)) + (m.low.v[i] * dt + rest);
            let (sum, dropped) = two_sum(*q, straight);
            (*q, m.low.q[i]) = two_sum(sum, dropped + (bend + m.low.q[i]));
        }
        for (i, v) in flat_mut(&mut points.v).iter_mut().enumerate() {
            carry(v, &mut m.low.v[i], dt * gain_over(i, m.a0[i], &m.b));
        }
        m.low.pass(points, dt);
    }
}

/// Weights of v₀, a₀ and b in the displacement and the gain of velocity at h of a step of `dt`.
struct Weights {
    time: f64,
    half: f64,
    bend: [f64; TERMS],
    gain: [f64; TERMS],
}

impl Weights {
    /// ∫∫ hᵏ⁺¹ = hᵏ⁺³/((k+2)(k+3)), ∫ hᵏ⁺¹ = hᵏ⁺²/(k+2).
    fn at(h: f64, dt: f64) -> Self {
        let time = h * dt;
        let (mut bend, mut gain) = ([0.0; TERMS], [0.0; TERMS]);
        let mut power = time;
        let mut order = 2.0;
        for (bend, gain) in bend.iter_mut().zip(&mut gain) {
            power *= h;
            *gain = power / order;
            *bend = power * time / (order * (order + 1.0));
            order += 1.0;
        }
        Self { time, half: 0.5 * time * time, bend, gain }
    }

    /// How far acceleration bends coordinate i of the path off the straight line. Small terms first.
    #[inline]
    fn bend(&self, i: usize, a0: f64, b: &[Vec<f64>; TERMS]) -> f64 {
        let w = &self.bend;
        let late = (w[6] * b[6][i] + w[5] * b[5][i]) + w[4] * b[4][i];
        let early = ((late + w[3] * b[3][i]) + w[2] * b[2][i]) + w[1] * b[1][i];
        (early + w[0] * b[0][i]) + self.half * a0
    }

    /// How much velocity coordinate i gains.
    #[inline]
    fn gain(&self, i: usize, a0: f64, b: &[Vec<f64>; TERMS]) -> f64 {
        let w = &self.gain;
        let late = (w[6] * b[6][i] + w[5] * b[5][i]) + w[4] * b[4][i];
        let early = ((late + w[3] * b[3][i]) + w[2] * b[2][i]) + w[1] * b[1][i];
        (early + w[0] * b[0][i]) + self.time * a0
    }

    /// Positions from a start and a polynomial.
    fn positions(&self, q0: &[f64], q_low: &[f64], v0: &[f64], a0: &[f64], b: &[Vec<f64>; TERMS], q: &mut [DVec3]) {
        for (i, q) in flat_mut(q).iter_mut().enumerate() {
            *q = q0[i] + (self.time * v0[i] + (self.bend(i, a0[i], b) + q_low[i]));
        }
    }

    /// Velocities from a start and a polynomial.
    fn velocities(&self, v0: &[f64], v_low: &[f64], a0: &[f64], b: &[Vec<f64>; TERMS], v: &mut [DVec3]) {
        for (i, v) in flat_mut(v).iter_mut().enumerate() {
            *v = v0[i] + (self.gain(i, a0[i], b) + v_low[i]);
        }
    }
}

/// ∫₀¹∫ a dh dh of coordinate i. By division, whose rounding is as often up as down: a rounded weight errs the same way at every
/// step, and energy would drift with t instead of √t [Rein & Spiegel 2015, §3.2].
fn bend_over(i: usize, a0: f64, b: &[Vec<f64>; TERMS]) -> f64 {
    let late = (b[6][i] / 72.0 + b[5][i] / 56.0) + b[4][i] / 42.0;
    let early = ((late + b[3][i] / 30.0) + b[2][i] / 20.0) + b[1][i] / 12.0;
    (early + b[0][i] / 6.0) + a0 / 2.0
}

/// ∫₀¹ a dh of coordinate i, by division as in [`bend_over`].
fn gain_over(i: usize, a0: f64, b: &[Vec<f64>; TERMS]) -> f64 {
    let late = (b[6][i] / 8.0 + b[5][i] / 7.0) + b[4][i] / 6.0;
    let early = ((late + b[3][i] / 5.0) + b[2][i] / 4.0) + b[1][i] / 3.0;
    (early + b[0][i] / 2.0) + a0
}

fn flat(list: &[DVec3]) -> &[f64] {
    bytemuck::cast_slice(list)
}

fn flat_mut(list: &mut [DVec3]) -> &mut [f64] {
    bytemuck::cast_slice_mut(list)
}
