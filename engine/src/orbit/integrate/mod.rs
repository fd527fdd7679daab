//! Integrate: numerical solution of `y″ = f(t, y, y′)`, one file a family of methods.
//!
//! A method is a record of coefficients and one loop. An adaptive one owns its buffers, takes its natural steps, and answers
//! for any time inside the last step (dense output): whoever looks at a path samples it and never changes it.
//! - [`runge_kutta`]: fixed tables, for powered flight at the tick.
//! - [`gauss_radau`]: order 15, adaptive, with velocities: the all-rounder for close encounters and odd forces.
//! - [`dormand_prince`]: explicit pairs of orders 5 and 8, adaptive.
//! - [`composition`]: symplectic, of fixed step, orders 2 to 8.
//! - [`wisdom_holman`]: Kepler orbits and kicks, moons in a hierarchy of their own, correctors.
//! - [`sums`]: additions and products that keep what rounding drops.
//! - [`series`]: arithmetic of power series, the parts of every Taylor method.
//! - [`taylor`]: adaptive, of high order, for point masses.
//!
//! Not here: what attracts whom ([`super::gravity`]), closed forms ([`super::kepler`]).

pub mod composition;
pub mod dormand_prince;
pub mod gauss_radau;
pub mod runge_kutta;
pub mod series;
pub mod sums;
pub mod taylor;
pub mod wisdom_holman;

use glam::DVec3;

/// Equations of motion `y″ = f(t, y, y′)` of n points. Units are the problem's own (SI in the game).
pub trait Force {
    /// True when [`Force::accelerations`] reads the velocities.
    const USES_VELOCITY: bool;

    /// Accelerations at `t` (from the problem's epoch) of points at `q` that move with `v`, into `a`; all of one length.
    fn accelerations(&self, t: f64, q: &[DVec3], v: &[DVec3], a: &mut [DVec3]);
}

/// n points at one time: what every method starts from and ends with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Time from the problem's epoch.
    pub t: f64,
    /// Positions.
    pub q: Vec<DVec3>,
    /// Velocities.
    pub v: Vec<DVec3>,
}

/// What a run cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps that were kept.
    pub steps: u64,
    /// Steps that were tried again, shorter.
    pub rejected: u64,
    /// Evaluations of the force on all points.
    pub evaluations: u64,
}

/// What became of one call for a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A step was made.
    Made,
    /// Nothing was left to do: the points are at the end already.
    Arrived,
    /// No step can be made from here: a singularity (two points at one place), or numbers that are not finite. The points are
    /// as they were.
    Stalled,
}
