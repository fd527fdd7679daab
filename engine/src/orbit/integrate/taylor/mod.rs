//! Taylor: an adaptive Taylor method of high order for point masses, the one that the solar system is integrated with.
//!
//! Each step expands the solution to order 15 … 31 by recurrences written for this force, takes the length for which the last terms
//! vanish, and keeps the polynomial as dense output. The state is kept in two words, and what of a step is large is summed in two
//! words, so that rounding grows no faster than that of the accelerations' later orders.
//! - [`lanes`]: four numbers at a time, one word or two.
//! - [`pairs`]: the coefficients of n bodies. [`step`]: length and sum of a step.
//!
//! Not here: forces beyond point masses, and crowds of massless bodies (each pair of bodies costs, a pair of massless ones too).
//! - [Jorba & Zou 2005] "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
//!   Experimental Mathematics 14.
//! - [Biscani & Izzo 2021] "Revisiting high-order Taylor methods for astrodynamics and celestial mechanics", MNRAS 504.

mod lanes;
mod pairs;
mod step;
#[cfg(test)]
mod tests;

use super::{Points, Work};
use glam::DVec3;
use pairs::Pairs;
use thiserror::Error;

/// Why a step could not be taken. The points are as they were before it.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Stop {
    /// Two bodies at the same place: their attraction has no value.
    #[error("bodies {0} and {1} are at the same place: their attraction has no value; move one of them apart")]
    Together(usize, usize),
    /// The step fell below what the clock resolves: bodies are falling into each other.
    #[error("bodies fall into each other: the step fell below what the clock resolves; stop at an earlier event")]
    Stuck,
    /// A state that is no number, or too large for one.
    #[error("a position or velocity is not a finite number; check the state that was given")]
    NotFinite,
    /// As many positions, velocities and gravitational parameters are needed.
    #[error("{given} points were given for a method made for {wanted}; make one for this many")]
    Count {
        /// How many were given.
        given: usize,
        /// For how many the method was made.
        wanted: usize,
    },
}

/// The method, its buffers, and the polynomial of its last step.
#[derive(Clone, Debug)]
pub struct Taylor {
    /// What the state's f64 words leave out: of the time, the positions, the velocities. Saved with the points, and put back before
    /// going on, it makes a restart the same bits; zero ([`Taylor::reset`]) for points from elsewhere.
    pub low: Points,
    pairs: Pairs,
    order: usize,
    log_tolerance: f64,
    /// Start (two words), unit and length of the last step.
    start: (f64, f64),
    unit: f64,
    span: f64,
}

impl Taylor {
    /// For bodies with gravitational parameters `gm` (0: massless), with each step's last terms below `tolerance` of the separation of
    /// each pair of bodies, at the order that costs least there: that for which a step is 1/e² of the radius of convergence
    /// [Jorba & Zou 2005, §3.2].
    #[must_use]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // clamped
    pub fn new(gm: &[f64], tolerance: f64) -> Self {
        let tolerance = tolerance.clamp(1e-30, 1e-3);
        let order = (libm::log(tolerance) * -0.5).clamp(7.0, 33.0) as usize / 2 * 2 + 1;
        Self::with_order(gm, tolerance, order)
    }

    /// The same with a given order (made odd, 7 … 41).
    #[must_use]
    pub fn with_order(gm: &[f64], tolerance: f64, order: usize) -> Self {
        let (order, n) = (order.clamp(7, 41) | 1, gm.len());
        let zero = vec![DVec3::ZERO; n];
        Self {
            low: Points { t: 0.0, q: zero.clone(), v: zero },
            pairs: Pairs::new(gm, order),
            order,
            log_tolerance: libm::log2(tolerance),
            start: (0.0, 0.0),
            unit: 1.0,
            span: 0.0,
        }
    }

    /// Order of the series.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// Forget the low words: for points that come from elsewhere.
    pub fn reset(&mut self) {
        self.low.t = 0.0;
        self.low.q.fill(DVec3::ZERO);
        self.low.v.fill(DVec3::ZERO);
    }

    /// Take one natural step towards `t_end`, never past it. True when it is reached.
    pub fn step(&mut self, points: &mut Points, t_end: f64) -> Result<bool, Stop> {
        pulp::Arch::new().dispatch(One { method: self, points, t_end })
    }

    /// Go to `t_end`.
    pub fn run(&mut self, points: &mut Points, t_end: f64) -> Result<Work, Stop> {
        let (arch, mut work) = (pulp::Arch::new(), Work::default());
        while points.t != t_end {
            arch.dispatch(One { method: self, points, t_end })?;
            work.steps += 1;
            work.evaluations += 1;
        }
        Ok(work)
    }

    #[inline(always)]
    fn step_inner(&mut self, points: &mut Points, t_end: f64) -> Result<bool, Stop> {
        let n = self.low.q.len();
        if points.q.len() != n || points.v.len() != n {
            return Err(Stop::Count { given: points.q.len(), wanted: n });
        }
        let remaining = (t_end - points.t) - self.low.t;
        if remaining == 0.0 {
            return Ok(true);
        }
        self.read(points);
        let reach = self.pairs.build().map_err(|t| Stop::Together(t.0, t.1))?;
        let mut h = step::length(reach.ratio, self.order, self.log_tolerance) * reach.unit;
        let last = !(h < remaining.abs());
        h = if last { remaining } else { h.copysign(remaining) };
        if !(h.abs() > points.t.abs() * 1e-30 && h.is_finite()) {
            return Err(if h.is_finite() { Stop::Stuck } else { Stop::NotFinite });
        }
        (self.start, self.unit, self.span) = ((points.t, self.low.t), reach.unit, h);
        self.write(points)?;
        if last {
            (points.t, self.low.t) = (t_end, 0.0);
        } else {
            let (t, e) = lanes::two_sum([points.t; 4], [h; 4]);
            let (t, e) = lanes::quick_two_sum(t, lanes::add(e, [self.low.t; 4]));
            (points.t, self.low.t) = (t[0], e[0]);
        }
        Ok(last)
    }

    /// The state into the series' orders 0 and 1.
    #[inline(always)]
    fn read(&mut self, points: &Points) {
        for i in 0..points.q.len() {
            let from = [&points.q[i], &points.v[i], &self.low.q[i], &self.low.v[i]].map(DVec3::to_array);
            for c in 0..3 {
                let at = self.pairs.index(c, i);
                self.pairs.x[0][at] = from[0][c];
                self.pairs.x[1][at] = from[1][c];
                self.pairs.low[0][at] = from[2][c];
                self.pairs.low[1][at] = from[3][c];
            }
        }
    }

    /// The state at the end of the step.
    #[inline(always)]
    fn write(&mut self, points: &mut Points) -> Result<(), Stop> {
        let (n, h, back) = (points.q.len(), self.span / self.unit, 1.0 / self.unit);
        let mut sound = true;
        for c in 0..3 {
            for first in (0..n).step_by(4) {
                let at = self.pairs.index(c, first);
                let two = |k: usize| (lanes::load(&self.pairs.x[k], at), lanes::load(&self.pairs.low[k], at));
                let (q, v) = step::advance(two(0), two(1), two(2), self.order, h, |k| lanes::load(&self.pairs.x[k], at));
                for l in 0..4.min(n - first) {
                    sound &= q.0[l].is_finite() && v.0[l].is_finite();
                    points.q[first + l][c] = q.0[l];
                    points.v[first + l][c] = v.0[l] * back;
                    self.low.q[first + l][c] = q.1[l];
                    self.low.v[first + l][c] = v.1[l] * back;
                }
            }
        }
        if sound { Ok(()) } else { Err(Stop::NotFinite) }
    }
}

/// One step, in the form that is compiled for each kind of machine.
struct One<'a> {
    method: &'a mut Taylor,
    points: &'a mut Points,
    t_end: f64,
}

impl pulp::NullaryFnOnce for One<'_> {
    type Output = Result<bool, Stop>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        self.method.step_inner(self.points, self.t_end)
    }
}
