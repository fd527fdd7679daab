//! Taylor: an adaptive Taylor method of high order for point masses, the one that the solar system is integrated with.
//!
//! Each step expands the solution to order 15 … 31 by recurrences written for this force, takes the length for which the last terms
//! vanish, and keeps the polynomial as dense output. The state is kept in two words, and what of a step is large is summed in two
//! words, so that rounding grows no faster than that of the accelerations' later orders.
//! - [`lanes`]: four numbers at a time, one word or two.
//! - [`centre`]: the coefficients of massless bodies about one massive one. [`pairs`]: of n bodies. [`step`]: length and sum of a step.
//!
//! Not here: forces beyond point masses, and crowds of massless bodies (each pair of bodies costs, a pair of massless ones too).
//! - [Jorba & Zou 2005] "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
//!   Experimental Mathematics 14.
//! - [Biscani & Izzo 2021] "Revisiting high-order Taylor methods for astrodynamics and celestial mechanics", MNRAS 504.

mod centre;
mod lanes;
mod pairs;
mod step;
#[cfg(test)]
mod tests;

use super::{Points, Work};
use centre::Centre;
use glam::DVec3;
use lanes::{Four, Lanes, OnFour, Two};
use pairs::Pairs;
use step::Bound;
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

/// Where the coefficients come from.
#[derive(Clone, Debug)]
enum Kernel {
    Centre(Centre),
    Pairs(Box<Pairs>),
}

/// The method, its buffers, and the polynomial of its last step.
#[derive(Clone, Debug)]
pub struct Taylor {
    /// What the state's f64 words leave out: of the time, the positions, the velocities. Saved with the points, and put back before
    /// going on, it makes a restart the same bits; zero ([`Taylor::reset`]) for points from elsewhere.
    pub low: Points,
    kernel: Kernel,
    order: usize,
    bound: Bound,
    /// Start (two words) and length of the last step.
    start: (f64, f64),
    span: f64,
    /// The state at the step's end, before it is known to be finite.
    next: Vec<[DVec3; 4]>,
}

impl Taylor {
    /// For bodies with gravitational parameters `gm` (0: massless), with each step's last terms below `tolerance` of the separation of
    /// each pair of bodies. The order is −½ ln tolerance [Jorba & Zou 2005, §3.2] about one massive body: a higher one would be cheaper
    /// still, but its longer steps give more weight to the rounding of orders that are kept in one word. Among several it is
    /// −0.6 ln tolerance. A tolerance of 1e-18 leaves rounding as the larger error.
    #[must_use]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // clamped
    pub fn new(gm: &[f64], tolerance: f64) -> Self {
        let share = if alone(gm) { -0.5 } else { -0.6 };
        let order = libm::log(tolerance.clamp(1e-30, 1e-3)) * share;
        Self::with_order(gm, tolerance, order.clamp(7.0, 31.0) as usize)
    }

    /// The same with a given order (made odd, 7 … 31).
    #[must_use]
    pub fn with_order(gm: &[f64], tolerance: f64, order: usize) -> Self {
        let (order, zero) = (order.clamp(7, 31) | 1, vec![DVec3::ZERO; gm.len()]);
        Self {
            low: Points { t: 0.0, q: zero.clone(), v: zero },
            kernel: if alone(gm) { Kernel::Centre(Centre::new(gm, order)) } else { Kernel::Pairs(Box::new(Pairs::new(gm, order))) },
            order,
            bound: Bound::new(order, tolerance.clamp(1e-30, 1e-3)),
            start: (0.0, 0.0),
            span: 0.0,
            next: vec![[DVec3::ZERO; 4]; gm.len()],
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
        lanes::dispatch(One { method: self, points, t_end })
    }

    /// Go to `t_end`.
    pub fn run(&mut self, points: &mut Points, t_end: f64) -> Result<Work, Stop> {
        let mut work = Work::default();
        while points.t != t_end || self.low.t != 0.0 {
            lanes::dispatch(One { method: self, points, t_end })?;
            work.steps += 1;
            work.evaluations += 1;
        }
        Ok(work)
    }

    /// Where all bodies were, and how they moved, at `t` within the last step, into `q` and `v`: the polynomial itself. Outside of the
    /// step it still has a value, which soon is wrong.
    pub fn dense_into(&self, t: f64, q: &mut [DVec3], v: &mut [DVec3]) {
        lanes::dispatch(At { method: self, t, to: Seen { first: 0, q, v } });
    }

    /// The same for one body.
    #[must_use]
    pub fn dense(&self, body: usize, t: f64) -> (DVec3, DVec3) {
        let (mut q, mut v) = ([DVec3::ZERO], [DVec3::ZERO]);
        lanes::dispatch(At { method: self, t, to: Seen { first: body, q: &mut q, v: &mut v } });
        (q[0], v[0])
    }

    /// The last step: its start and its end.
    #[must_use]
    pub fn last_step(&self) -> (f64, f64) {
        (self.start.0, self.start.0 + (self.start.1 + self.span))
    }

    #[inline(always)]
    fn advance<S: Four>(&self, s: S, h: f64, to: &mut impl Sink) {
        match &self.kernel {
            Kernel::Centre(k) => k.advance(s, h, to),
            Kernel::Pairs(k) => k.advance(s, h, to),
        }
    }

    #[inline(always)]
    fn step_on<S: Four>(&mut self, s: S, points: &mut Points, t_end: f64) -> Result<bool, Stop> {
        let n = self.low.q.len();
        if points.q.len() != n || points.v.len() != n {
            return Err(Stop::Count { given: points.q.len().min(points.v.len()), wanted: n });
        }
        let remaining = (t_end - points.t) - self.low.t;
        if remaining == 0.0 {
            (points.t, self.low.t) = (t_end, 0.0);
            return Ok(true);
        }
        let natural = match &mut self.kernel {
            Kernel::Centre(k) => k.build(s, points, &self.low, &self.bound)?,
            Kernel::Pairs(k) => k.build(s, points, &self.low, &self.bound)?,
        };
        if natural.is_nan() || !remaining.is_finite() {
            return Err(Stop::NotFinite);
        }
        let last = natural >= remaining.abs();
        if !last && natural <= points.t.abs() * 1e-28 + f64::MIN_POSITIVE {
            return Err(Stop::Stuck);
        }
        let h = if last { remaining } else { natural.copysign(remaining) };
        self.write(s, h, points)?;
        (self.start, self.span) = ((points.t, self.low.t), h);
        if last {
            (points.t, self.low.t) = (t_end, 0.0);
        } else {
            let t = Lanes::splat(s, points.t).plus(Lanes::splat(s, h));
            let t = t.high.plus_smaller(t.low + Lanes::splat(s, self.low.t));
            (points.t, self.low.t) = (t.high.array()[0], t.low.array()[0]);
        }
        Ok(last)
    }

    /// The state after `h`; nothing is changed unless all of it is finite.
    #[inline(always)]
    fn write<S: Four>(&mut self, s: S, h: f64, points: &mut Points) -> Result<(), Stop> {
        let mut next = Next { sound: 0.0, states: &mut self.next };
        match &self.kernel {
            Kernel::Centre(k) => k.advance(s, h, &mut next),
            Kernel::Pairs(k) => k.advance(s, h, &mut next),
        }
        if next.sound != 0.0 {
            return Err(Stop::NotFinite);
        }
        for (b, [q, q_low, v, v_low]) in self.next.iter().enumerate() {
            (points.q[b], self.low.q[b], points.v[b], self.low.v[b]) = (*q, *q_low, *v, *v_low);
        }
        Ok(())
    }
}

/// True where one body attracts all others.
fn alone(gm: &[f64]) -> bool {
    gm.iter().filter(|m| **m > 0.0).count() == 1
}

/// Where a kernel puts a body's position and velocity.
trait Sink {
    fn put<S: Four>(&mut self, body: usize, q: Two<S>, v: Two<S>);
}

/// The whole state, both words; `sound` is 0 as long as all is finite.
struct Next<'a> {
    sound: f64,
    states: &'a mut [[DVec3; 4]],
}

impl Sink for Next<'_> {
    #[inline(always)]
    fn put<S: Four>(&mut self, body: usize, q: Two<S>, v: Two<S>) {
        // Infinite, or no number, times 0 is no number.
        self.sound += ((q.high + v.high) * 0.0).sum_of_three();
        if let Some(state) = self.states.get_mut(body) {
            *state = [q.high.vector(), q.low.vector(), v.high.vector(), v.low.vector()];
        }
    }
}

/// Positions and velocities of the bodies from `first` on, as many as there are places.
struct Seen<'a> {
    first: usize,
    q: &'a mut [DVec3],
    v: &'a mut [DVec3],
}

impl Sink for Seen<'_> {
    #[inline(always)]
    fn put<S: Four>(&mut self, body: usize, q: Two<S>, v: Two<S>) {
        let at = body.wrapping_sub(self.first);
        if let (Some(to), Some(rate)) = (self.q.get_mut(at), self.v.get_mut(at)) {
            (*to, *rate) = (q.high.vector(), v.high.vector());
        }
    }
}

/// One step, in the form that is compiled for each kind of machine.
struct One<'a> {
    method: &'a mut Taylor,
    points: &'a mut Points,
    t_end: f64,
}

impl OnFour for One<'_> {
    type Output = Result<bool, Stop>;

    #[inline(always)]
    fn go<S: Four>(self, s: S) -> Self::Output {
        self.method.step_on(s, self.points, self.t_end)
    }
}

/// The last step's polynomial at one time, the same way.
struct At<'a> {
    method: &'a Taylor,
    t: f64,
    to: Seen<'a>,
}

impl OnFour for At<'_> {
    type Output = ();

    #[inline(always)]
    fn go<S: Four>(mut self, s: S) {
        self.method.advance(s, (self.t - self.method.start.0) - self.method.start.1, &mut self.to);
    }
}
