//! Path: where a coasting ship goes under every force that counts, as a chain of polynomials in time.
//!
//! Read [`knot`] (a place to go on from), [`step`] (one natural step and how it ends), [`recurrence`] (its coefficients),
//! [`model`] (what a system is to a ship), [`roots`] (how nothing is jumped over), [`swarm`] (thousands at once), [`full`] (the
//! yardstick). A [`Path`] holds the step that says where the ship is now; it is sampled, never stepped by whoever looks, so a
//! sample depends on the knot and the tick alone: not on warp, frame rate, or how often it was looked at.
//!
//! The state is written about the body that dominates (at 30 AU from the Sun an ulp is a millimetre), and rewritten, at the
//! moment of crossing, about the next one. Not here: the path ahead with burns ([`super::predict`]).

pub mod full;
pub mod knot;
pub mod model;
mod places;
pub mod recurrence;
pub mod roots;
pub mod series;
pub mod step;
pub mod swarm;
pub mod twofold;

pub use knot::Knot;
pub use model::{Body, Model, Places};
pub use step::{End, Setting, Step};

use super::{BodyId, State};
use crate::space::Centred;
use crate::time::{Moment, SimTime};

/// Something that a path came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// When.
    pub at: Moment,
    /// What.
    pub end: End,
    /// About which body the path was then.
    pub host: BodyId,
}

/// A coasting ship's path.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    step: Box<Step>,
    setting: Setting,
}

impl Path {
    /// The path from `knot` on.
    pub fn new(model: &Model, places: &dyn Places, knot: Knot) -> Self {
        Self::with(model, places, knot, Setting::default())
    }

    /// The same for a ship that light pushes, or one that is followed to the ground. Thrust is for single steps only.
    pub fn with(model: &Model, places: &dyn Places, knot: Knot, setting: Setting) -> Self {
        let setting = Setting { thrust: None, ..setting };
        Self { step: Box::new(Step::new(model, places, knot, &setting)), setting }
    }

    /// Where the present step begins: the path goes on from here with the same bits.
    pub fn knot(&self) -> &Knot {
        &self.step.knot
    }

    /// The present step.
    pub fn step(&self) -> &Step {
        &self.step
    }

    /// The body that it is about now.
    pub fn host(&self) -> BodyId {
        self.step.knot.host
    }

    /// The state at a tick of the present step (see [`Path::advance`]), m and m/s from the host's centre.
    pub fn sample(&self, t: SimTime) -> State<Centred> {
        self.step.sample(t)
    }

    /// Goes on to the next step, and says what was met at its beginning, if it was not only the end of a polynomial. A path
    /// that has come to its least height stays there.
    pub fn next(&mut self, model: &Model, places: &dyn Places) -> Option<Event> {
        let event = Event { at: self.step.until, end: self.step.end, host: self.host() };
        if event.end != End::Low {
            *self.step = Step::new(model, places, self.step.next(model, places), &self.setting);
        }
        (event.end != End::Natural).then_some(event)
    }

    /// Goes on until a step covers `until`, or to the first event on the way that the pilot should know of: a change of host
    /// (the path goes on about the new one), or the least height (it ends there).
    pub fn advance(&mut self, model: &Model, places: &dyn Places, until: SimTime) -> Option<Event> {
        while Moment::from(until).since(self.step.until) >= 0.0 {
            let event = self.next(model, places);
            if event.is_some() {
                return event;
            }
        }
        None
    }
}

#[cfg(test)]
mod tests;
