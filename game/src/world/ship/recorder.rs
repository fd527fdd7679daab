//! The flight recorder: the last twenty seconds of poses, so that a landing or a crash can be looked at again.
//!
//! It only remembers; nothing in the World reads it, so it is no part of the state hash. A view replays it by [`Recorder::at`].

use engine::orbit::BodyId;
use engine::space::{Fixed, Hull, Position, Rotation};
use engine::time::SimTime;
use std::collections::VecDeque;

/// Ticks between two records: 20 Hz.
const EVERY_TICKS: i64 = 3;
/// Records kept: 20 s.
const KEPT: usize = 400;

/// Where the ship was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// When.
    pub time: SimTime,
    /// About which body.
    pub body: BodyId,
    /// Centre of mass in the body's turning axes.
    pub position: Position<Fixed>,
    /// Attitude in the body's turning axes.
    pub fixed_from_hull: Rotation<Fixed, Hull>,
}

/// The last seconds of flight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorder {
    poses: VecDeque<Pose>,
}

impl Recorder {
    /// Takes a pose; keeps it when its turn has come, or always where `last` says that nothing follows.
    pub fn take(&mut self, pose: Pose, last: bool) {
        let gone_back = self.poses.back().is_some_and(|p| p.time > pose.time || p.body != pose.body);
        if gone_back {
            self.poses.clear();
        }
        let due = self.poses.back().is_none_or(|p| pose.time.ticks - p.time.ticks >= EVERY_TICKS);
        if !due && !last {
            return;
        }
        let oldest = pose.time.ticks - EVERY_TICKS * i64::try_from(KEPT).unwrap_or(0);
        while self.poses.len() >= KEPT || self.poses.front().is_some_and(|p| p.time.ticks < oldest) {
            self.poses.pop_front();
        }
        self.poses.push_back(pose);
    }

    /// The poses, oldest first.
    pub fn poses(&self) -> impl ExactSizeIterator<Item = &Pose> {
        self.poses.iter()
    }

    /// The pose `back_s` seconds before the newest one, between records; the oldest where it reaches further back.
    pub fn at(&self, back_s: f64) -> Option<Pose> {
        let newest = self.poses.back()?;
        let ago = |p: &Pose| newest.time.since(p.time);
        let after = self.poses.iter().rposition(|p| ago(p) >= back_s);
        let Some(i) = after else { return self.poses.front().copied() };
        let a = self.poses.get(i)?;
        let Some(b) = self.poses.get(i + 1) else { return Some(*a) };
        let span = ago(a) - ago(b);
        let f = if span > 0.0 { ((ago(a) - back_s) / span).clamp(0.0, 1.0) } else { 0.0 };
        let (qa, qb) = (a.fixed_from_hull.0, b.fixed_from_hull.0);
        let qb = if qa.dot(qb) < 0.0 { -qb } else { qb };
        Some(Pose {
            position: a.position + (b.position - a.position) * f,
            fixed_from_hull: Rotation::new((qa * (1.0 - f) + qb * f).normalize()),
            ..*a
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(ticks: i64) -> Pose {
        Pose {
            time: SimTime::from_ticks(ticks),
            body: BodyId(3),
            position: Position::xyz(ticks as f64, 0.0, 0.0),
            fixed_from_hull: Rotation::IDENTITY,
        }
    }

    #[test]
    fn keeps_twenty_seconds_and_gives_any_instant_of_them() {
        let mut r = Recorder::default();
        for t in 0..5_000 {
            r.take(pose(t), false);
        }
        r.take(pose(5_000), true);
        let span = r.poses().last().unwrap().time.since(r.poses().next().unwrap().time);
        assert!((19.0..=20.05).contains(&span), "{span}");
        for back in [0.0, 0.01, 1.0, 7.321, 19.0] {
            let x = r.at(back).unwrap().position.0.x;
            assert!((x - (5_000.0 - back * 60.0)).abs() < 1e-6, "{back}: {x}");
        }
        assert_eq!(r.at(1e9).unwrap(), *r.poses().next().unwrap());
    }

    #[test]
    fn going_back_in_time_begins_anew() {
        let mut r = Recorder::default();
        r.take(pose(100), false);
        r.take(pose(200), false);
        r.take(pose(50), false);
        assert_eq!(r.poses().len(), 1);
        assert_eq!(Recorder::default().at(1.0), None);
    }
}
