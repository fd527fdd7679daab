//! The path ahead for the map: predicted once and kept until something changes, at once where that is quick, on a thread where it
//! is not, so that no frame waits for it.
//!
//! A kept prediction holds as long as the ship is where it says; nothing is computed for a frame in which the
//! ship only went on along its path. Not here: the prediction itself ([`engine::orbit::predict`]), its lines ([`super::lines`]).

use crate::command::Node;
use crate::world::World;
use crate::world::ship::Motion;
use crate::world::system::System;
use engine::orbit::elements::Elements;
use engine::orbit::path::Knot;
use engine::orbit::predict::{Burn, Ending, Engine, Kind, Limits, Prediction, predict};
use engine::orbit::{BodyId, State};
use engine::space::{Centred, Vector};
use engine::time::{Moment, SimTime};
use engine::units::DAY;
use std::sync::{Arc, mpsc};
use std::time::Instant;

/// Steps that are taken within the frame.
const STEPS_AT_ONCE: usize = 300;
/// Steps of the longest prediction.
const MOST_STEPS: usize = 60_000;
/// Longest span of a prediction, s.
const LONGEST_S: f64 = 40.0 * 365.25 * DAY;
/// How far the ship may be from where it was predicted, m, and the same for its speed, m/s.
const APART: (f64, f64) = (5.0, 5.0e-3);
/// Part of a prediction's span after which it is made anew, so that the path does not end before the eye.
const WORN: f64 = 0.15;

/// What a prediction is made for.
#[derive(Clone)]
struct Ask {
    system: Arc<System>,
    knot: Knot,
    /// Planned burns, and how much of the first has still to be flown once it has been begun, m/s.
    nodes: Vec<Node>,
    to_gain: Option<glam::DVec3>,
    /// Acceleration at full throttle now, m/s², exhaust velocity, m/s, and what the tanks give, m/s.
    engine: (f64, f64, f64),
    /// What light takes off the star's pull, m³/s².
    light_m3_s2: f64,
    revolutions: u32,
    target: Option<BodyId>,
}

/// A path without and with the planned burns.
#[derive(Debug)]
pub struct Course {
    /// As it is.
    pub free: Arc<Prediction>,
    /// With the burns, from the first on; none without burns.
    pub planned: Option<Prediction>,
    /// When the planned path leaves the other.
    pub parts_at: Option<Moment>,
    /// Where it begins and ends.
    span: (Moment, Moment),
    /// As far as was asked.
    whole: bool,
    /// Until when the places of the bodies are at hand by now.
    reaches: SimTime,
    /// What it took, ms.
    pub cost_ms: f64,
}

/// What was asked, without what moves on by itself.
#[derive(Clone, Debug, PartialEq)]
struct Question {
    system: usize,
    nodes: Vec<Node>,
    spent: Option<[f64; 3]>,
    revolutions: u32,
    target: Option<BodyId>,
}

/// The predictions of a map.
#[derive(Debug, Default)]
pub struct Kept {
    course: Option<(Question, Arc<Course>)>,
    running: Option<(Question, mpsc::Receiver<Course>)>,
    /// From when to when the places of the bodies have been asked for, and are at hand.
    at_hand: Option<(SimTime, SimTime)>,
    /// Courses made so far: lines follow when it changes.
    pub made: u64,
}

impl Ask {
    /// What the map asks of a World; none for a ship that rests.
    fn new(world: &World, revolutions: u32, target: Option<BodyId>) -> Option<Self> {
        if matches!(world.ship.motion, Motion::Landed(_) | Motion::Crashed(_)) {
            return None;
        }
        let rigid = world.rigid();
        let ship = &world.ship;
        let main = &ship.spec.main_engine;
        let engine = (main.thrust_n / ship.mass_kg(), main.exhaust_velocity_m_s, ship.delta_v_m_s());
        Some(Self {
            system: world.system.clone(),
            knot: Knot::new(rigid.body, world.time, &rigid.state),
            light_m3_s2: ship.light_m3_s2(&world.system),
            nodes: ship.nodes.clone(),
            to_gain: ship.burn.filter(|b| b.spent).map(|b| b.to_gain),
            engine,
            revolutions,
            target,
        })
    }

    fn question(&self) -> Question {
        Question {
            system: Arc::as_ptr(&self.system) as usize,
            nodes: self.nodes.clone(),
            spent: self.to_gain.map(|v| v.to_array()),
            revolutions: self.revolutions,
            target: self.target,
        }
    }

    /// The planned burns with the engine as it will be: the ship is lighter after each. What the tanks do not give is drawn as an
    /// impulse.
    fn burns(&self) -> Vec<Burn> {
        let (mut acceleration, exhaust, mut left_m_s) = self.engine;
        let begun = usize::from(self.to_gain.is_some());
        let later = self.nodes.iter().skip(begun);
        let burn = later.map(|node| {
            let parts = node.parts_m_s();
            left_m_s -= parts.length();
            let engine = (left_m_s > 0.0).then_some(Engine { acceleration_m_s2: acceleration, exhaust_m_s: exhaust });
            acceleration *= libm::exp((parts.length() / exhaust).min(20.0));
            Burn { at: node.at.into(), prograde_m_s: parts.x, normal_m_s: parts.y, radial_m_s: parts.z, engine }
        });
        burn.filter(|b| b.delta_v_m_s() > 0.0).collect()
    }

    /// As far as the places of the bodies are known at all.
    fn latest(&self) -> SimTime {
        let ephemeris = &self.system.ephemeris;
        if ephemeris.is_empty() { SimTime::from_ticks(i64::MAX) } else { ephemeris.limits().1 }
    }

    /// The tick to which so many revolutions reach from a state: about its host where the path comes back there, else about what
    /// the host goes about.
    fn until(&self, host: BodyId, state: &State<Centred>, at: Moment) -> SimTime {
        let body = self.system.body(host);
        let own = Elements::from_state(body.gm_m3_s2, state);
        let stays = own.is_bound() && own.apoapsis_m() < body.soi_radius_m;
        let period_s = if stays {
            own.period_s()
        } else if let Some(parent) = body.parent {
            let s = self.system.ephemeris.relative(host, parent, at.tick);
            Elements::from_state(self.system.body(parent).gm_m3_s2, &s).period_s()
        } else {
            LONGEST_S
        };
        let span_s = (period_s * f64::from(self.revolutions)).clamp(60.0, LONGEST_S);
        at.plus_s(span_s).next_tick().min(self.latest())
    }

    /// Follows the path a span further, so that the places of the bodies are at hand when it is predicted again; until when.
    fn reach_on(&self, course: &Course) -> SimTime {
        let ends = course.span.1;
        let (Some((host, state)), Ending::Until) = (course.free.state(ends), course.free.ending) else { return course.reaches };
        let until = ends.plus_s(ends.since(course.span.0)).tick.min(self.latest());
        let limits = Limits { steps: MOST_STEPS, light_m3_s2: self.light_m3_s2, ..Limits::until(until) };
        let on = predict(&self.system.gravity, &self.system.ephemeris, Knot::new(host, ends, &state), &[], &limits);
        course.reaches.max(on.end().tick)
    }

    /// Predicts, with at most so many steps a path and not beyond a tick. `free` is the path without burns where that is known
    /// already.
    fn answer(&self, steps: usize, horizon: SimTime, free: Option<Arc<Prediction>>) -> Course {
        let begun = Instant::now();
        let places = &self.system.ephemeris;
        let limits =
            |until: SimTime| Limits { steps, target: self.target, light_m3_s2: self.light_m3_s2, ..Limits::until(until.min(horizon)) };
        let mut whole = true;
        let mut note = |path: &Prediction, until: SimTime| {
            whole &= path.ending != Ending::Steps && (path.ending == Ending::Impact || until <= horizon)
        };
        let until = self.until(self.knot.host, &self.knot.state(), self.knot.at);
        let free = free.unwrap_or_else(|| Arc::new(predict(&self.system.gravity, places, self.knot, &[], &limits(until))));
        note(&free, until);
        let burns = self.burns();
        let (mut planned, mut parts_at) = (None, None);
        let first = burns.iter().map(|b| b.ignition()).min_by(|a, b| a.since(*b).total_cmp(&0.0));
        if let (None, Some(to_gain)) = (first, self.to_gain) {
            let knot = self.knot.kicked(to_gain);
            let until = self.until(knot.host, &knot.state(), knot.at);
            let path = predict(&self.system.gravity, places, knot, &[], &limits(until));
            note(&path, until);
            planned = Some(path);
            parts_at = Some(self.knot.at);
        } else if let Some(first) = first {
            // From the step in which the first burn begins, or from where the other path ends.
            let knot = match self.to_gain {
                Some(to_gain) => self.knot.kicked(to_gain),
                None => free.steps.iter().rev().map(|s| s.knot).find(|k| k.at.since(first) <= 0.0).unwrap_or(self.knot),
            };
            parts_at = Some(if self.to_gain.is_some() { self.knot.at } else { first });
            // As far as the last burn, to learn how long a revolution is after it.
            let last = burns.iter().fold(knot.at, |t, b| {
                let end = b.ignition().plus_s(b.duration_s() + 1.0);
                if end.since(t) > 0.0 { end } else { t }
            });
            let to_last = predict(&self.system.gravity, places, knot, &burns, &limits(last.next_tick()));
            let after = to_last.state(to_last.end());
            let until = after.map_or(until, |(host, state)| self.until(host, &state, to_last.end())).max(until);
            let path = predict(&self.system.gravity, places, knot, &burns, &limits(until));
            note(&path, until);
            planned = Some(path);
        }
        let begin = free.steps.first().map_or(self.knot.at, |s| s.knot.at);
        let span = (begin, if free.end().since(begin) > 0.0 { free.end() } else { begin });
        let reaches = free.end().tick.max(planned.as_ref().map_or(begin.tick, |p| p.end().tick));
        Course { free, planned, parts_at, span, whole, reaches, cost_ms: begun.elapsed().as_secs_f64() * 1e3 }
    }
}

impl Course {
    /// Nothing is left to a thread.
    pub fn is_whole(&self) -> bool {
        self.whole
    }

    /// The planned path where there is one, else the other.
    pub fn last(&self) -> &Prediction {
        self.planned.as_ref().unwrap_or(&self.free)
    }

    /// The body and the state about it at a moment of the path with all burns; none beyond it.
    pub fn state(&self, at: Moment) -> Option<(BodyId, State<Centred>)> {
        let planned = self.planned.as_ref().filter(|_| self.parts_at.is_some_and(|p| at.since(p) >= 0.0));
        planned.and_then(|p| p.state(at)).or_else(|| self.free.state(at))
    }

    /// The next moment after `now` at which something happens on the path with all burns.
    pub fn next(&self, now: SimTime, is: impl Fn(Kind) -> bool) -> Option<Moment> {
        let ahead = |p: &Prediction| p.marks.iter().find(|m| is(m.kind) && m.at.since(now.into()) > 0.0).map(|m| m.at);
        ahead(self.last()).or_else(|| ahead(&self.free))
    }

    /// True where the ship of a World is where the path says, and enough of it is left.
    fn holds(&self, world: &World) -> bool {
        let now = Moment::from(world.time);
        let rigid = world.rigid();
        let worn = now.since(self.span.0) > WORN * self.span.1.since(self.span.0);
        let there = self.free.state(now).is_some_and(|(host, s)| {
            let apart: Vector<Centred> = s.position - rigid.state.position;
            host == rigid.body
                && apart.0.length() < APART.0 + 1e-9 * rigid.state.position.length()
                && (s.velocity - rigid.state.velocity).0.length() < APART.1
        });
        there && !worn
    }
}

impl Kept {
    /// The course of a World's ship, as far as it is known now. `ctx` is told when a thread has more.
    pub fn course(&mut self, ctx: &egui::Context, world: &World, revolutions: u32, target: Option<BodyId>) -> Option<Arc<Course>> {
        let Some(ask) = Ask::new(world, revolutions, target) else {
            self.course = None;
            return None;
        };
        let question = ask.question();
        self.hear();
        let fresh = self.course.as_ref().is_some_and(|(q, c)| *q == question && c.holds(world));
        if !fresh {
            // A burn that is edited leaves the path as it is without it.
            let same = |q: &Question| Question { nodes: question.nodes.clone(), spent: question.spent, ..q.clone() } == question;
            let known = self.course.as_ref().filter(|(q, c)| same(q) && c.whole && c.holds(world)).map(|(_, c)| c.free.clone());
            self.make(ctx, ask, question, known);
        }
        self.course.as_ref().map(|(_, c)| c.clone())
    }

    /// Takes over what a thread has made.
    fn hear(&mut self) {
        match self.running.as_ref().map(|(_, r)| r.try_recv()) {
            Some(Ok(course)) => {
                if let Some((question, _)) = self.running.take() {
                    self.keep(question, course);
                }
            }
            Some(Err(mpsc::TryRecvError::Disconnected)) => self.running = None,
            Some(Err(mpsc::TryRecvError::Empty)) | None => {}
        }
    }

    fn keep(&mut self, question: Question, course: Course) {
        tracing::debug!("path ahead: {:.1} ms, {} steps", course.cost_ms, course.free.steps.len());
        let begin = course.span.0.tick;
        let (from, to) = self.at_hand.filter(|(from, to)| *from <= begin && begin <= *to).unwrap_or((begin, begin));
        self.at_hand = Some((from, to.max(course.reaches)));
        self.course = Some((question, Arc::new(course)));
        self.made += 1;
    }

    fn make(&mut self, ctx: &egui::Context, ask: Ask, question: Question, free: Option<Arc<Prediction>>) {
        let now = ask.knot.at.tick;
        if let Some((_, horizon)) = self.at_hand.filter(|(from, to)| *from <= now && now < *to) {
            let course = ask.answer(STEPS_AT_ONCE, horizon, free.clone());
            let whole = course.whole;
            self.keep(question.clone(), course);
            if whole {
                return;
            }
        }
        // One at a time: what changed meanwhile is asked for when it is done.
        if self.running.is_none() {
            let (tell, told) = mpsc::channel();
            let ctx = ctx.clone();
            self.running = Some((question, told));
            std::thread::spawn(move || {
                // Nobody may be listening any more.
                let mut course = ask.answer(MOST_STEPS, SimTime::from_ticks(i64::MAX), free);
                course.reaches = ask.reach_on(&course);
                _ = tell.send(course);
                ctx.request_repaint();
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Action, Commands, Guidance};
    use crate::save::fixture;
    use engine::time::TICKS_PER_SECOND;
    use glam::DVec3;

    fn flying() -> World {
        let mut rigid = fixture::rigid();
        rigid.rate = Vector::ZERO;
        fixture::world(Motion::Fly(rigid))
    }

    fn act(world: &mut World, action: Action) {
        world.tick(&Commands { actions: vec![action], ..Commands::default() });
    }

    /// The whole course, once the thread has it.
    fn ask(kept: &mut Kept, world: &World, revolutions: u32) -> Arc<Course> {
        let ctx = egui::Context::default();
        for _ in 0..20_000 {
            if let Some(course) = kept.course(&ctx, world, revolutions, None).filter(|c| c.whole && c.holds(world)) {
                return course;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        panic!("no course");
    }

    #[test]
    fn what_the_map_shows_is_what_the_autopilot_flies() {
        let mut world = flying();
        let at = world.time.plus(1_500 * TICKS_PER_SECOND);
        act(&mut world, Action::AddNode(Node::new(at, DVec3::new(300.0, -150.0, 40.0))));
        act(&mut world, Action::Guidance(Guidance::Node));
        let course = ask(&mut Kept::default(), &world, 2);
        assert!(course.parts_at.is_some_and(|p| p.since(at.into()) < 0.0));
        for _ in 0..60 * 60 * 50 {
            world.tick(&Commands::default());
        }
        assert!(world.ship.nodes.is_empty());
        let (_, shown) = course.state(world.time.into()).unwrap();
        let flown = world.rigid().state;
        // Half a revolution later: the burn itself lasted for seconds and was trimmed to 0.1 mm/s.
        assert!((shown.position - flown.position).length() < 200.0, "{}", (shown.position - flown.position).length());
        assert!((shown.velocity - flown.velocity).0.length() < 0.3);
    }

    #[test]
    fn nothing_is_computed_while_nothing_changes() {
        let (mut world, mut kept) = (flying(), Kept::default());
        let first = ask(&mut kept, &world, 3);
        for _ in 0..600 {
            world.tick(&Commands::default());
            ask(&mut kept, &world, 3);
        }
        assert!(Arc::ptr_eq(&first, &ask(&mut kept, &world, 3)));
        // A burn is shown in the very frame in which it is planned, and leaves the path without it as it is.
        let made = kept.made;
        let node = Node::new(world.time.plus(90_000), DVec3::X);
        act(&mut world, Action::AddNode(node));
        let edited = kept.course(&egui::Context::default(), &world, 3, None).unwrap();
        assert!(edited.planned.is_some() && edited.whole && kept.made == made + 1);
        assert!(Arc::ptr_eq(&edited.free, &first.free));
        assert!(ask(&mut kept, &world, 1).span.1.since(first.span.1) < -3_600.0);
    }

    #[test]
    fn a_ship_that_stands_has_no_path() {
        let world = fixture::world(Motion::Landed(fixture::resting()));
        assert!(Kept::default().course(&egui::Context::default(), &world, 5, None).is_none());
    }

    #[test]
    fn a_path_that_is_long_comes_from_a_thread() {
        let (world, mut kept) = (flying(), Kept::default());
        ask(&mut kept, &world, 1);
        let first = kept.course(&egui::Context::default(), &world, 100, None).unwrap();
        assert!(!first.whole, "the frame does not wait for all of it");
        let course = ask(&mut kept, &world, 100);
        assert!(course.free.marks.iter().filter(|m| m.kind == Kind::Periapsis).count() >= 99);
    }
}
