//! Marks: what happens on a path ahead, each at the root of its function.
//!
//! On every step the functions are polynomials, and all their roots are found ([`super::super::path::roots`]). The sign with
//! which a step ends is carried to the next, so that a root at the seam is found once. Not here: the path ([`super`]).

use super::Limits;
use crate::orbit::path::series::Scalar;
use crate::orbit::path::{End, Knot, Model, Places, Step, roots};
use crate::orbit::{BodyId, State};
use crate::space::Centred;
use crate::time::Moment;

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Nearest to the host.
    Periapsis,
    /// Farthest from it.
    Apoapsis,
    /// Northwards through the plane.
    AscendingNode,
    /// Southwards through the plane.
    DescendingNode,
    /// Nearest to the target.
    Closest {
        /// How near, m.
        distance_m: f64,
    },
    /// Into the host's air.
    AirEntry,
    /// Out of it.
    AirExit,
    /// On the host's datum.
    Impact,
    /// Out of the host's sphere of influence, into its parent's.
    Leave,
    /// Into the sphere of influence of a child.
    Enter(BodyId),
    /// Which of the burns begins.
    BurnBegins(usize),
    /// Which of the burns ends.
    BurnEnds(usize),
}

/// Something on a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// What.
    pub kind: Kind,
    /// When.
    pub at: Moment,
    /// About which body (before a change).
    pub host: BodyId,
    /// State about it then.
    pub state: State<Centred>,
}

/// The side of zero on which a function was last.
type Side = Option<bool>;

/// What has been seen so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Watch {
    pub marks: Vec<Mark>,
    /// Periapses about the present host.
    pub periapses: u32,
    climb: Side,
    height: Side,
    air: Side,
    nearing: Side,
}

/// The roots of a function over (a part of) a step, in parts of it.
fn roots_of(a: &Scalar, side: &mut Side) -> Vec<roots::Root> {
    let mut found = Vec::new();
    let negative = a[0] < 0.0;
    if side.is_some_and(|s| s != negative) {
        found.push(roots::Root { at: 0.0, rising: !negative });
    }
    if !roots::cannot_vanish(a) {
        roots::all(a, &mut found);
    }
    *side = Some(found.last().map_or(negative, |r| !r.rising));
    found
}

impl Watch {
    /// Notes a burn's beginning or end: what grew may fall behind it.
    pub fn burn(&mut self, kind: Kind, knot: &Knot) {
        self.marks.push(Mark { kind, at: knot.at, host: knot.host, state: knot.state() });
        (self.climb, self.nearing) = (None, None);
    }

    /// Looks a step through.
    pub fn look(&mut self, model: &Model, places: &dyn Places, limits: &Limits, step: &Step) {
        let host = step.knot.host;
        let mut found: Vec<(f64, Kind)> = Vec::new();
        let r2 = step.radius_squared();
        for root in roots_of(&roots::slope(&r2), &mut self.climb) {
            self.periapses += u32::from(root.rising);
            found.push((root.at, if root.rising { Kind::Periapsis } else { Kind::Apoapsis }));
        }
        let normal = limits.plane.unwrap_or_else(|| model.pole(host, step.knot.at)[0]);
        for root in roots_of(&step.along(normal), &mut self.height) {
            found.push((root.at, if root.rising { Kind::AscendingNode } else { Kind::DescendingNode }));
        }
        if let Some(body) = model.body(host).filter(|b| b.air_top_m > 0.0) {
            let mut above = r2;
            above[0] -= body.air_top_m * body.air_top_m;
            for root in roots_of(&above, &mut self.air) {
                found.push((root.at, if root.rising { Kind::AirExit } else { Kind::AirEntry }));
            }
        }
        if let Some(target) = limits.target.filter(|t| *t != host && t.index() < model.len()) {
            for gap in step.gaps(places, target) {
                for root in roots_of(&roots::slope(&gap.squared), &mut self.nearing).iter().filter(|r| r.rising) {
                    let distance_m = roots::at(&gap.squared, root.at).max(0.0).sqrt();
                    found.push((gap.from + root.at * (gap.to - gap.from), Kind::Closest { distance_m }));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (at, kind) in found {
            let at = step.moment(at);
            self.marks.push(Mark { kind, at, host, state: step.sample(at) });
        }
        let kind = match step.end {
            End::Natural => return,
            End::Low => Kind::Impact,
            End::Leave => Kind::Leave,
            End::Enter(body) => Kind::Enter(body),
        };
        self.marks.push(Mark { kind, at: step.until, host, state: step.sample(step.until) });
        *self = Self { marks: core::mem::take(&mut self.marks), ..Self::default() };
    }
}
