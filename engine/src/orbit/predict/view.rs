//! Views: a predicted path as polylines in the frame of any body, at rest in the stars or turning with it.
//!
//! Not here: pixels, and what is drawn how.

use super::Prediction;
use crate::orbit::BodyId;
use crate::orbit::path::{Model, Places};
use crate::time::Moment;
use glam::DVec3;

/// The frame that a path is seen in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct View {
    /// The body at the origin.
    pub body: BodyId,
    /// True: the axes turn with it (+Z its pole, +X its prime meridian). False: ICRF axes.
    pub rotating: bool,
}

/// A point of a polyline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// When the ship is there.
    pub at: Moment,
    /// From the view's body, in the view's axes, m.
    pub position: DVec3,
}

/// A part of the path about one body.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The body that dominates.
    pub host: BodyId,
    /// At least two points.
    pub points: Vec<Point>,
}

impl View {
    /// A position from `host`'s centre (ICRF axes) at a moment, as this view sees it, m.
    pub fn place(&self, model: &Model, places: &dyn Places, host: BodyId, at: Moment, from_host: DVec3) -> DVec3 {
        let p = if host == self.body { from_host } else { from_host + places.relative_at(host, self.body, at).position.0 };
        match model.body(self.body) {
            Some(body) if self.rotating => body.spin.icrf_from_fixed(at.tick).inverse().raw(p),
            _ => p,
        }
    }
}

impl Prediction {
    /// The path as polylines, a new one where the host changes. `bend_rad` is how far the direction of motion about the host may
    /// turn between two points (0.05: a circle of 126); a step gives at most 64.
    pub fn polylines(&self, model: &Model, places: &dyn Places, view: View, bend_rad: f64) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = Vec::new();
        for step in &self.steps {
            let host = step.knot.host;
            let point = |at: Moment| Point { at, position: view.place(model, places, host, at, step.sample(at).position.0) };
            if pieces.last().is_none_or(|p| p.host != host) {
                pieces.push(Piece { host, points: vec![point(step.knot.at)] });
            }
            // From velocity to velocity, by way of the middle: a step turns by less than half a circle in each half.
            let heading = |at: f64| step.sample(step.moment(at)).velocity.0;
            let turn = |a: DVec3, b: DVec3| libm::atan2(a.cross(b).length(), a.dot(b));
            let (a, b, c) = (heading(0.0), heading(0.5), heading(1.0));
            let mut parts = 1.0_f64;
            while parts < 64.0 && parts * bend_rad < turn(a, b) + turn(b, c) {
                parts += 1.0;
            }
            let mut i = 1.0;
            while i <= parts {
                if let Some(piece) = pieces.last_mut() {
                    piece.points.push(point(step.moment(i / parts)));
                }
                i += 1.0;
            }
        }
        pieces
    }
}
