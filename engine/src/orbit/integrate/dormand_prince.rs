//! Embedded Runge–Kutta pairs: explicit, adaptive, with dense output; the loop is here, the tables are in `tables`.
//!
//! For forces of any form at middling tolerances; below 1e-13 `gauss_radau` and Taylor's method do better. The pair is applied to y″ = f(t, y, y′) in
//! Nyström's form: positions of the stages straight from accelerations (ā = a·a), which is the same solution with fewer roundings
//! and half the sums where the force needs no velocities. Not here: fixed steps at the tick (`runge_kutta`).
//! - [Prince & Dormand 1981] "High order embedded Runge–Kutta formulae", J. Comp. Appl. Math. 7, 67.
//! - [Dormand & Prince 1980] "A family of embedded Runge–Kutta formulae", J. Comp. Appl. Math. 6, 19.
//! - [Hairer, Nørsett & Wanner 1993] "Solving Ordinary Differential Equations I", §II.4 (step size), II.6 (dense output by bootstrapping).

mod dense;
mod tables;
#[cfg(test)]
mod tests;

pub use tables::{DORMAND_PRINCE_5, DORMAND_PRINCE_8};

use super::runge_kutta::Table;
use super::sums::{Carry, carry};
use super::{Force, Points, Step, Work};
use dense::Dense;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A step aims at this part of the size that the error estimate allows.
const SAFETY: f64 = 0.9;
/// Bounds of the change from step to step.
const SHRINK: f64 = 0.2;
const GROW: f64 = 5.0;
/// A step below this part of the time reached (or to be reached) cannot help: two points are at one place.
const SHORTEST: f64 = 1e-28;

/// A method and a second, lower-order set of weights whose difference from the first estimates the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The method itself.
    pub table: Table,
    /// Weights of the estimate.
    pub low: &'static [f64],
    /// Its order.
    pub low_order: u32,
}

/// What a path needs, beside its [`Points`], to go on with the same bits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    low: Carry,
    /// The step that the control asks for next, signed; 0 before the first.
    natural: f64,
}

/// The integrator: a pair, a tolerance, memory and buffers.
#[derive(Clone, Debug)]
pub struct Embedded {
    pair: Pair,
    tolerance: f64,
    /// ā = a·a, and the weights of positions b̄ = b·a and of their error.
    bend: Vec<Vec<f64>>,
    end: Vec<f64>,
    end_error: Vec<f64>,
    memory: Memory,
    /// Accelerations of the stages, flat.
    stages: Vec<Vec<f64>>,
    /// True when the first stage is that of the points as the last step left them.
    fresh: bool,
    dense: Option<Dense>,
    q: Vec<DVec3>,
    v: Vec<DVec3>,
    a: Vec<DVec3>,
    sum: Vec<f64>,
    dq: Vec<f64>,
    dv: Vec<f64>,
    work: Work,
}

impl Embedded {
    /// For `n` points. `tolerance` bounds the estimated error of a step relative to each point's distance from the origin (and
    /// how far it goes in a step), and so for velocities; what is not a positive number counts as 1e-12, and less than 1e-15 (where the
    /// estimate is rounding) as that. `dense` asks for dense output, at three more evaluations a step.
    pub fn new(pair: Pair, n: usize, tolerance: f64, dense: bool) -> Self {
        let a = pair.table.a;
        let weigh = |weights: &[f64]| -> Vec<f64> {
            (0..a.len()).map(|j| (j + 1..a.len()).map(|i| weights.get(i).unwrap_or(&0.0) * a[i].get(j).unwrap_or(&0.0)).sum()).collect()
        };
        let end = weigh(pair.table.b);
        let end_error = end.iter().zip(weigh(pair.low)).map(|(b, low)| b - low).collect();
        let mut new = Self {
            pair,
            tolerance: if tolerance > 0.0 && tolerance.is_finite() { tolerance.max(1e-15) } else { 1e-12 },
            bend: a.iter().map(|row| weigh(row)).collect(),
            end,
            end_error,
            memory: Memory::default(),
            stages: vec![Vec::new(); a.len()],
            fresh: false,
            dense: dense.then(Dense::default),
            q: Vec::new(),
            v: Vec::new(),
            a: Vec::new(),
            sum: Vec::new(),
            dq: Vec::new(),
            dv: Vec::new(),
            work: Work::default(),
        };
        new.fit(n);
        new
    }

    /// What must be saved beside the points for a restart with the same bits.
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Goes on where `memory` was saved, with the points of that moment. Dense output is there again after the next step.
    pub fn resume(&mut self, memory: Memory) {
        self.memory = memory;
        self.fresh = false;
    }

    /// Starts afresh: for points that jumped, or a force that changed.
    pub fn forget(&mut self) {
        self.resume(Memory::default());
    }

    /// What all steps so far have cost.
    pub fn work(&self) -> Work {
        self.work
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

    /// Positions and velocities at `t` inside the last step, of order 7 in the step (positions, velocity-free forces); false, and nothing
    /// written, where dense output was not asked for or no step was made.
    pub fn dense(&self, t: f64, q: &mut [DVec3], v: &mut [DVec3]) -> bool {
        self.dense.as_ref().is_some_and(|d| d.at(t, q, v))
    }

    /// One step of natural size towards `t_end` (later or earlier than now), cut so that it never passes it.
    pub fn step<F: Force>(&mut self, force: &F, points: &mut Points, t_end: f64) -> Step {
        let n = points.q.len();
        if self.a.len() != n || points.v.len() != n || self.memory.low.q.len() != 3 * n {
            self.fit(n);
            points.v.resize(n, DVec3::ZERO);
        }
        let left = self.memory.low.left(points, t_end);
        if left == 0.0 {
            return Step::Arrived;
        }
        if !self.fresh {
            self.evaluate(force, points.t, 0, points, true);
            self.fresh = true;
        }
        let shortest = SHORTEST * points.t.abs().max(t_end.abs());
        let mut natural = if self.memory.natural != 0.0 { self.memory.natural.copysign(left) } else { self.first_guess(points, left) };
        loop {
            let dt = if natural.abs() < left.abs() { natural } else { left };
            if !dt.is_finite() || dt.abs() <= shortest {
                return Step::Stalled;
            }
            for stage in 1..self.stages.len() {
                self.place(F::USES_VELOCITY, points, stage, dt);
                self.evaluate(force, points.t + self.pair.table.c[stage] * dt, stage, points, false);
            }
            let error = self.error(points, dt);
            let change = SAFETY * libm::pow(error / self.tolerance, -1.0 / f64::from(self.pair.low_order + 1));
            if error <= self.tolerance {
                // A step cut short by the end says nothing against the natural one.
                let next = (dt.abs() * change.clamp(SHRINK, GROW)).max(if dt == left { natural.abs().min(dt.abs() * change) } else { 0.0 });
                self.memory.natural = next.min(f64::MAX).copysign(dt);
                self.commit(force, points, dt);
                return Step::Made;
            }
            self.work.rejected += 1;
            // An error that is no number shrinks the step as much as may be.
            natural = dt * if change > SHRINK { change.min(SAFETY) } else { SHRINK };
        }
    }

    fn fit(&mut self, n: usize) {
        self.memory.low.fit(n);
        self.fresh = false;
        for list in self.stages.iter_mut().chain([&mut self.sum, &mut self.dq, &mut self.dv]) {
            list.resize(3 * n, 0.0);
        }
        for list in [&mut self.q, &mut self.v, &mut self.a] {
            list.resize(n, DVec3::ZERO);
        }
    }

    /// A hundredth of the shortest v/a: the control mends it at once.
    fn first_guess(&self, points: &Points, left: f64) -> f64 {
        let mut shortest = 1e-2 * left.abs();
        for (v, a) in points.v.iter().zip(self.stages[0].chunks_exact(3)) {
            let scale = 0.01 * v.length() / DVec3::from_slice(a).length();
            if scale.is_normal() {
                shortest = shortest.min(scale);
            }
        }
        shortest.max(1e-12 * left.abs()).copysign(left)
    }

    /// The accelerations of a stage: of the points themselves, or of the buffers that [`Self::place`] filled.
    fn evaluate<F: Force>(&mut self, force: &F, t: f64, stage: usize, points: &Points, own: bool) {
        let (q, v) = if own { (&points.q, &points.v) } else { (&self.q, &self.v) };
        force.accelerations(t, q, v, &mut self.a);
        self.work.evaluations += 1;
        self.stages[stage].copy_from_slice(bytemuck::cast_slice(&self.a));
    }

    /// Where a stage is taken: q₀ + c·dt·v₀ + dt²·Σ ā A, v₀ + dt·Σ a A.
    fn place(&mut self, velocities: bool, points: &Points, stage: usize, dt: f64) {
        let time = self.pair.table.c[stage] * dt;
        weighted(&mut self.sum, &self.bend[stage], &self.stages);
        let q: &mut [f64] = bytemuck::cast_slice_mut(&mut self.q);
        let (q0, v0): (&[f64], &[f64]) = (bytemuck::cast_slice(&points.q), bytemuck::cast_slice(&points.v));
        let low = &self.memory.low;
        for (i, (q, sum)) in q.iter_mut().zip(&self.sum).enumerate() {
            *q = q0[i] + (time * v0[i] + (dt * (dt * sum) + low.q[i]));
        }
        if velocities {
            weighted(&mut self.sum, self.pair.table.a[stage], &self.stages);
            for (i, (v, sum)) in bytemuck::cast_slice_mut::<_, f64>(&mut self.v).iter_mut().zip(&self.sum).enumerate() {
                *v = v0[i] + (dt * sum + low.v[i]);
            }
        }
    }

    /// The largest relative error of any point; leaves the step's changes in `dq` and `dv`.
    fn error(&mut self, points: &Points, dt: f64) -> f64 {
        let difference: Vec<f64> = self.pair.table.b.iter().zip(self.pair.low).map(|(b, low)| b - low).collect();
        weighted(&mut self.dq, &self.end_error, &self.stages);
        weighted(&mut self.dv, &difference, &self.stages);
        let mut worst = 0.0_f64;
        for (i, (q, v)) in points.q.iter().zip(&points.v).enumerate() {
            let at = |list: &[f64]| DVec3::from_slice(&list[3 * i..3 * i + 3]);
            let (eq, ev) = (at(&self.dq).length() * dt * dt, at(&self.dv).length() * dt.abs());
            let (q_scale, v_scale) = (q.length() + v.length() * dt.abs(), v.length() + at(&self.stages[0]).length() * dt.abs());
            for (error, scale) in [(eq, q_scale), (ev, v_scale)] {
                let ratio = if error == 0.0 { 0.0 } else { error / scale };
                // A NaN must win: it stands for an error without bound.
                worst = if ratio > worst || ratio.is_nan() { ratio } else { worst };
                if worst.is_nan() {
                    return worst;
                }
            }
        }
        weighted(&mut self.dq, &self.end, &self.stages);
        weighted(&mut self.dv, self.pair.table.b, &self.stages);
        worst
    }

    /// Makes the step.
    fn commit<F: Force>(&mut self, force: &F, points: &mut Points, dt: f64) {
        if let Some(d) = &mut self.dense {
            d.start(points, dt, &self.stages[0]);
        }
        let Carry { q: q_low, v: v_low, .. } = &mut self.memory.low;
        let v0: &[f64] = bytemuck::cast_slice(&points.v);
        for (i, q) in bytemuck::cast_slice_mut::<_, f64>(&mut points.q).iter_mut().enumerate() {
            carry(q, &mut q_low[i], dt * v0[i] + (dt * (dt * self.dq[i]) + dt * v_low[i]));
        }
        for (i, v) in bytemuck::cast_slice_mut::<_, f64>(&mut points.v).iter_mut().enumerate() {
            carry(v, &mut v_low[i], dt * self.dv[i]);
        }
        self.memory.low.pass(points, dt);
        self.work.steps += 1;
        self.fresh = false;
        if self.dense.is_some() {
            self.evaluate(force, points.t, 0, points, true);
            self.fresh = true;
        }
        if let Some(d) = &mut self.dense {
            self.work.evaluations += d.finish(force, points, &self.stages[0]);
        }
    }
}

/// `sum` = Σ weights·stages, coordinate by coordinate.
fn weighted(sum: &mut [f64], weights: &[f64], stages: &[Vec<f64>]) {
    sum.fill(0.0);
    for (weight, stage) in weights.iter().zip(stages).filter(|(weight, _)| **weight != 0.0) {
        for (sum, a) in sum.iter_mut().zip(stage) {
            *sum += weight * a;
        }
    }
}
