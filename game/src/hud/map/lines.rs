//! A course as lines and flags for one frame: patched (each part about the body that dominates there) or all in the frame of
//! one body, at rest or turning with it. Made when the course or the frame changes, projected in each frame of the screen.

use super::course::Course;
use crate::world::system::System;
use engine::orbit::BodyId;
use engine::orbit::predict::{Mark, Prediction, View, view::Point};
use engine::time::Moment;
use glam::DVec3;

/// How much the direction of motion may turn between two points, rad.
const BEND_RAD: f64 = 0.04;

/// The frame that a path is drawn in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    /// Each part about the body that dominates there.
    #[default]
    Patched,
    /// All about one body.
    Of(View),
}

/// Where the points of a line are counted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// A body, as it stands now.
    pub body: BodyId,
    /// From there, ICRF axes, m.
    pub base: DVec3,
    /// Points are in the body's turning axes.
    pub turning: bool,
}

/// A part of a path.
#[derive(Clone, Debug)]
pub struct Line {
    /// The body that dominates.
    pub host: BodyId,
    /// True where the host's disc stands at the anchor, and may hide the line.
    pub about_host: bool,
    /// Counted from.
    pub anchor: Anchor,
    /// The points.
    pub points: Vec<Point>,
    /// With the planned burns.
    pub planned: bool,
}

/// Something that happens on a path.
#[derive(Clone, Copy, Debug)]
pub struct Flag {
    /// What.
    pub mark: Mark,
    /// Counted from.
    pub anchor: Anchor,
    /// Where.
    pub position: DVec3,
    /// On the path with the planned burns.
    pub planned: bool,
}

/// All of it.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    /// Parts of paths.
    pub lines: Vec<Line>,
    /// What happens on them.
    pub flags: Vec<Flag>,
}

impl Lines {
    /// The lines of a course. `host` is the body that dominates now.
    pub fn new(system: &System, course: &Course, frame: Frame, host: BodyId) -> Self {
        let mut all = Self::default();
        all.add(system, &course.free, frame, host, None);
        if let Some(planned) = &course.planned {
            all.add(system, planned, frame, host, course.parts_at);
        }
        all
    }

    fn add(&mut self, system: &System, path: &Prediction, frame: Frame, host: BodyId, from: Option<Moment>) {
        let places = &system.ephemeris;
        let planned = from.is_some();
        let ahead = |at: Moment| from.is_none_or(|f| at.since(f) > -1e-3);
        let hosts: Vec<BodyId> = path.steps.iter().fold(Vec::new(), |mut list, s| {
            if !list.contains(&s.knot.host) {
                list.push(s.knot.host);
            }
            list
        });
        let views: Vec<(View, Option<BodyId>)> = match frame {
            Frame::Of(view) => vec![(view, None)],
            Frame::Patched => hosts.iter().map(|h| (View { body: *h, rotating: false }, Some(*h))).collect(),
        };
        for (view, only) in views {
            for piece in path.polylines(&system.gravity, places, view, BEND_RAD) {
                if only.is_some_and(|h| h != piece.host) {
                    continue;
                }
                let anchor = match (only, piece.points.first()) {
                    (Some(_), Some(first)) => patched(system, host, piece.host, first.at),
                    _ => Anchor { body: view.body, base: DVec3::ZERO, turning: view.rotating },
                };
                let points: Vec<Point> = piece.points.into_iter().filter(|p| ahead(p.at)).collect();
                if points.len() > 1 {
                    self.lines.push(Line { host: piece.host, about_host: piece.host == view.body, anchor, points, planned });
                }
            }
        }
        for mark in path.marks.iter().filter(|m| ahead(m.at)) {
            let spot = Spot { host: mark.host, at: mark.at, from_host: mark.state.position.0, planned };
            let (anchor, position) = self.locate(system, frame, host, spot);
            self.flags.push(Flag { mark: *mark, anchor, position, planned });
        }
    }

    /// Where a place on the path is drawn.
    pub fn locate(&self, system: &System, frame: Frame, ship_host: BodyId, spot: Spot) -> (Anchor, DVec3) {
        match frame {
            Frame::Of(view) => {
                let anchor = Anchor { body: view.body, base: DVec3::ZERO, turning: view.rotating };
                (anchor, view.place(&system.gravity, &system.ephemeris, spot.host, spot.at, spot.from_host))
            }
            Frame::Patched => {
                // Of the part that it lies on.
                let line = self.lines.iter().rev().find(|l| {
                    let span = l.points.first().zip(l.points.last());
                    l.planned == spot.planned
                        && l.host == spot.host
                        && span.is_some_and(|(a, b)| spot.at.since(a.at) >= -1e-3 && spot.at.since(b.at) <= 1e-3)
                });
                (line.map_or_else(|| patched(system, ship_host, spot.host, spot.at), |l| l.anchor), spot.from_host)
            }
        }
    }
}

/// A place on a path.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The body that dominates there.
    pub host: BodyId,
    /// When.
    pub at: Moment,
    /// From that body's centre, ICRF axes, m.
    pub from_host: DVec3,
    /// On the path with the planned burns.
    pub planned: bool,
}

/// Where a part about `body` is drawn: about the body as it stands now where the ship is, or the body that it goes about;
/// elsewhere about the place where the ship will meet it, seen from what it goes about.
fn patched(system: &System, ship_host: BodyId, body: BodyId, at: Moment) -> Anchor {
    let mut base = DVec3::ZERO;
    let mut anchor = body;
    loop {
        let mut up = Some(ship_host);
        while up.is_some_and(|u| u != anchor) {
            up = up.and_then(|u| system.body(u).parent);
        }
        match system.body(anchor).parent.filter(|_| up.is_none()) {
            Some(parent) => {
                base += system.ephemeris.relative_at(anchor, parent, at).position.0;
                anchor = parent;
            }
            None => return Anchor { body: anchor, base, turning: false },
        }
    }
}
