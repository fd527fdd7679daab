//! The handle: queries, and the building behind them.

use super::chunk::Chunk;
use super::level::{Checkpoint, Heard, Kind, Level, Plan};
use super::mean;
use super::moons::Outside;
use super::orbit::{Details, EphemerisError, Orbit, check};
use super::planets::Planets;
use super::tree::{Pair, Tree, add};
use crate::orbit::elements::Elements;
use crate::orbit::field::Reach;
use crate::orbit::kepler::Conic;
use crate::orbit::{BodyId, State};
use crate::space::{Icrf, Position, Velocity};
use crate::time::{Moment, SimTime, TICKS_PER_SECOND};
use crate::units::JULIAN_CENTURY;
use glam::DVec3;
use std::sync::Arc;

/// How far from the epoch a system is integrated where somebody asks, s.
const REACH_S: f64 = 10.5 * JULIAN_CENTURY;
/// A fit may be off by this part of the size of an orbit (of a light moon's: the second) …
const FIT: [f64; 2] = [1e-13, 1e-11];
/// … and by this part of the distance from the barycentre, which is a few times what an f64 of it can tell.
const FLOOR: f64 = 1e-15;
/// Shortest revolutions that a chunk of light moons spans.
const REVOLUTIONS: f64 = 32.0;
/// The tide of another body on a light moon counts above this part of the planet's pull.
const TIDE_COUNTS: f64 = 1e-10;

/// Where every body of a system is, at any time. A handle: cheap to clone, shared between threads.
#[derive(Clone, Debug, Default)]
pub struct Ephemeris {
    pub(super) system: Option<Arc<System>>,
}

/// What all handles share.
#[derive(Debug)]
pub(super) struct System {
    pub tree: Tree,
    pub levels: Vec<Level>,
    /// Level and place in it of each body's track.
    place: Vec<(usize, usize)>,
    /// Conics of the starts, for what is out of reach.
    conics: Vec<Conic>,
    /// For each body: tracks and weights whose sum is its place from the barycentre.
    whole: Vec<Vec<(usize, f64)>>,
    reach: Vec<Reach>,
    /// Hash of all that the system is made from.
    pub key: [u8; 32],
}

/// Adds `b × scale` to a list of tracks and weights.
fn merge(list: &mut Vec<(usize, f64)>, b: &[(usize, f64)], scale: f64) {
    for (track, weight) in b {
        match list.iter_mut().find(|(t, _)| t == track) {
            Some((_, w)) => *w += weight * scale,
            None => list.push((*track, weight * scale)),
        }
    }
    list.retain(|(_, w)| *w != 0.0);
}

impl System {
    fn new(orbits: &[Orbit], details: &Details, key: [u8; 32]) -> Result<Self, EphemerisError> {
        check(orbits, details)?;
        let tree = Tree::new(orbits, details)?;
        let n = orbits.len();
        let mut whole: Vec<Vec<(usize, f64)>> = Vec::with_capacity(n);
        for i in 0..n {
            let mut list = tree.steps[i].clone();
            if let Some(p) = tree.parent[i].filter(|p| *p != 0) {
                merge(&mut list, &whole[p], 1.0);
            }
            whole.push(list);
        }
        let conics = (0..n).map(|i| mean::conic(tree.family_gm[i] + tree.parent[i].map_or(0.0, |p| tree.gm[p]), tree.start[i])).collect();
        let reach = (0..n).map(|i| reach_of(&tree, i)).collect();
        let mut system = Self { place: vec![(0, 0); 2 * n], conics, whole, reach, levels: Vec::new(), key, tree };
        system.levels.push(system.planetary(details));
        for i in 0..n {
            if let Some(level) = system.light(details, i) {
                system.levels.push(level);
            }
        }
        for (l, level) in system.levels.iter().enumerate() {
            for (k, body) in level.bodies.iter().enumerate() {
                system.place[*body] = (l, k);
            }
        }
        // Tracks of one level side by side: their chunk is looked up once.
        for list in &mut system.whole {
            list.sort_by_key(|(track, _)| system.place[*track]);
        }
        Ok(system)
    }

    /// Period of a body's start about its parent, s; infinite where it is open.
    fn period_s(&self, body: usize) -> f64 {
        let gm = self.tree.family_gm[body] + self.tree.parent[body].map_or(0.0, |p| self.tree.gm[p]);
        Elements::from_state(gm, &wrap(self.tree.start[body])).period_s()
    }

    /// Chunk length, chunks on each side, and the halvings that the fastest track needs.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn grid(&self, bodies: &[usize], revolutions: f64) -> (i64, i64, u32) {
        let shortest = bodies.iter().filter(|b| **b != 0).map(|b| self.period_s(*b)).fold(f64::INFINITY, f64::min);
        let ticks = (revolutions * shortest * TICKS_PER_SECOND as f64).clamp(1024.0, 1e13);
        let ticks = 1_i64 << (libm::floor(libm::log2(ticks)) as u32);
        let reach = (REACH_S * TICKS_PER_SECOND as f64 / ticks as f64).clamp(1.0, 4e6).ceil() as i64;
        let segments = 3.0 * ticks as f64 / (shortest * TICKS_PER_SECOND as f64);
        let halvings = if segments > 1.0 { libm::ceil(libm::log2(segments)).min(12.0) as u32 } else { 0 };
        (ticks, reach, halvings)
    }

    /// The planetary level.
    fn planetary(&self, details: &Details) -> Level {
        let (bodies, starts) = self.tree.planetary_starts();
        let mut start = Checkpoint { q: starts.iter().map(|s| s.0).collect(), v: starts.iter().map(|s| s.1).collect() };
        start.q.extend(details.masses.iter().map(|m| m.state.position.0));
        start.v.extend(details.masses.iter().map(|m| m.state.velocity.0));
        let forces = Planets::new(&self.tree, details, &bodies, &start.q);
        let slot = |body: usize| bodies.iter().position(|b| *b == body).unwrap_or_default();
        let tracks: Vec<Vec<(usize, f64)>> = bodies
            .iter()
            .map(|&b| {
                let mut list = Vec::new();
                self.family(b, 1.0, &slot, &mut list);
                if let Some(p) = self.tree.parent[b].filter(|p| *p != 0) {
                    merge(&mut list, &[(slot(p), 1.0)], -1.0);
                }
                list
            })
            .collect();
        let size = |list: &[(usize, f64)]| list.iter().fold(DVec3::ZERO, |sum, (k, w)| sum + start.q[*k] * *w).length();
        let within_m = tracks
            .iter()
            .zip(&start.q)
            .zip(&bodies)
            // The root moves little, by the pulls of all: it is held as well as the nearest body to it.
            .map(|((list, q), b)| {
                let size = if *b == 0 {
                    start.q[..bodies.len()].iter().skip(1).map(|p| (*p - *q).length()).fold(f64::INFINITY, f64::min)
                } else {
                    size(list)
                };
                FIT[0] * if size.is_finite() { size } else { 1.0 } + FLOOR * q.length() + f64::MIN_POSITIVE
            })
            .collect();
        let (ticks, reach, halvings) = self.grid(&bodies, 1.0);
        Level::new(Plan { bodies, ticks, reach, kind: Kind::Planets { forces, tracks }, epoch: self.tree.epoch, start, within_m, halvings })
    }

    /// The centre of mass of a family of the planetary level, as weights of its members' places.
    fn family(&self, body: usize, weight: f64, slot: &impl Fn(usize) -> usize, list: &mut Vec<(usize, f64)>) {
        let mut own = weight;
        if body != 0 {
            for &c in self.tree.children[body].iter().filter(|c| self.tree.planetary[**c]) {
                let part = weight * self.tree.family_gm[c] / self.tree.family_gm[body];
                own -= part;
                self.family(c, part, slot, list);
            }
        }
        merge(list, &[(slot(body), own)], 1.0);
    }

    /// A member of the planetary level with its light moons, from the barycentre, as weights of tracks.
    fn point(&self, body: usize) -> Vec<(usize, f64)> {
        let mut list = self.whole[body].clone();
        // `whole` is the body's centre: the light moons' part is added again.
        if self.tree.has_light(body) {
            merge(&mut list, &[(self.tree.aside(body), 1.0)], 1.0);
        }
        list
    }

    /// What pulls at the surroundings of `body` from outside: who (GM), and where from the centre of mass of it and its light moons.
    fn others(&self, body: usize) -> Vec<(f64, Vec<(usize, f64)>)> {
        let t = &self.tree;
        if t.planetary[body] {
            let own = self.point(body);
            let rest = (0..t.gm.len()).filter(|i| t.planetary[*i] && *i != body);
            return rest
                .map(|i| {
                    let mut list = self.point(i);
                    merge(&mut list, &own, -1.0);
                    (t.point_gm[i], list)
                })
                .collect();
        }
        // A light moon with moons: its planet, its siblings, and what its planet feels.
        let p = t.parent[body].unwrap_or_default();
        let mut all = vec![(t.gm[p], vec![(body, -1.0)])];
        for &s in t.children[p].iter().filter(|s| **s != body && !t.planetary[**s]) {
            all.push((t.family_gm[s], vec![(s, 1.0), (body, -1.0)]));
        }
        for (gm, mut list) in self.others(p) {
            merge(&mut list, &[(t.aside(p), 1.0), (body, -1.0)], 1.0);
            all.push((gm, list));
        }
        all
    }

    /// The level of a body's light moons, where it has any.
    fn light(&self, details: &Details, body: usize) -> Option<Level> {
        let (bodies, starts) = self.tree.light_starts(body);
        if bodies.is_empty() {
            return None;
        }
        let start = Checkpoint { q: starts.iter().map(|s| s.0).collect(), v: starts.iter().map(|s| s.1).collect() };
        let places = self.start_places();
        let (mut outside, mut lists) = (Vec::new(), Vec::new());
        for (gm, list) in self.others(body) {
            // Half the distance at the start stands for the least.
            let distance = 0.5 * list.iter().fold(DVec3::ZERO, |sum, (track, w)| sum + places[*track] * *w).length();
            let strength = |q: &DVec3| {
                let ratio = q.length() / distance;
                gm / self.tree.gm[body] * ratio * ratio * ratio
            };
            let felt_by: Vec<usize> = (0..start.q.len()).filter(|i| strength(&start.q[*i]) > TIDE_COUNTS).collect();
            if !felt_by.is_empty() {
                outside.push(Outside { gm, felt_by });
                lists.push(list);
            }
        }
        let mut heard: Vec<usize> = lists.iter().flatten().map(|(track, _)| *track).collect();
        heard.sort_unstable();
        heard.dedup();
        let index = |track: usize| heard.binary_search(&track).unwrap_or_default();
        let others = lists.iter().map(|list| list.iter().map(|(track, w)| (index(*track), *w)).collect()).collect();
        let (ticks, reach, halvings) = self.grid(&bodies, REVOLUTIONS);
        let kind = Kind::Moons {
            planet_gm: self.tree.gm[body],
            gm: bodies.iter().map(|b| self.tree.family_gm[*b]).collect(),
            figure: details.figures.get(body).and_then(Clone::clone).filter(|f| !f.is_point()),
            outside,
            heard,
            others,
            shares: bodies.iter().map(|b| self.tree.share(*b)).collect(),
        };
        let mut within_m: Vec<f64> = start.q.iter().map(|q| FIT[1] * q.length() + f64::MIN_POSITIVE).collect();
        within_m.push(within_m.iter().zip(&bodies).map(|(w, b)| w * self.tree.share(*b)).sum::<f64>() + f64::MIN_POSITIVE);
        let mut bodies = bodies;
        bodies.push(self.tree.aside(body));
        Some(Level::new(Plan { bodies, ticks, reach, kind, epoch: self.tree.epoch, start, within_m, halvings }))
    }

    /// Places of all tracks at the epoch.
    fn start_places(&self) -> Vec<DVec3> {
        let mut places = vec![DVec3::ZERO; 2 * self.tree.gm.len()];
        let level = &self.levels[0];
        let start = level.start();
        for (body, track) in level.bodies.iter().zip(level.tracks_of(&start.q)) {
            places[*body] = track;
        }
        for i in 0..self.tree.gm.len() {
            let (moons, starts) = self.tree.light_starts(i);
            for (moon, s) in moons.iter().zip(starts) {
                places[*moon] = s.0;
                places[self.tree.aside(i)] += s.0 * self.tree.share(*moon);
            }
        }
        places
    }

    /// A track at ticks after the epoch and seconds beyond. Out of reach: on the conic of its start.
    fn track(&self, body: usize, ticks: i64, beyond_s: f64) -> Pair {
        let (l, k) = self.place[body];
        let level = &self.levels[l];
        match level.locate(ticks, beyond_s) {
            Some((n, x)) => {
                let (r, v) = level.view(self, n, |chunk| chunk.at(k, x));
                (r, v * (1.0 / level.chunk_s()))
            }
            None => self.conic(body, ticks as f64 / TICKS_PER_SECOND as f64 + beyond_s),
        }
    }

    /// Beyond reach: on the conic of the start, about a root that moves on uniformly.
    fn conic(&self, body: usize, t: f64) -> Pair {
        if body >= self.tree.gm.len() {
            let of = body - self.tree.gm.len();
            let light = self.tree.children[of].iter().filter(|c| !self.tree.planetary[**c]);
            return light.fold((DVec3::ZERO, DVec3::ZERO), |sum, c| add(sum, self.conic(*c, t), self.tree.share(*c)));
        }
        let root = (self.tree.start[0].0 + self.tree.start[0].1 * t, self.tree.start[0].1);
        match self.tree.parent[body] {
            None => root,
            Some(0) => {
                let (r, v) = self.conics[body].after_raw(t);
                (root.0 + r, root.1 + v)
            }
            Some(_) => self.conics[body].after_raw(t),
        }
    }

    /// Sum of weighted tracks; those of one level that stand side by side share one look at its chunk.
    fn sum(&self, list: &[(usize, f64)], ticks: i64, beyond_s: f64) -> Pair {
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for group in list.chunk_by(|a, b| self.place[a.0].0 == self.place[b.0].0) {
            let level = &self.levels[self.place[group[0].0].0];
            let Some((n, x)) = level.locate(ticks, beyond_s) else {
                sum = group.iter().fold(sum, |sum, (track, weight)| add(sum, self.track(*track, ticks, beyond_s), *weight));
                continue;
            };
            let (r, v) = level.view(self, n, |chunk| {
                group.iter().fold((DVec3::ZERO, DVec3::ZERO), |sum, (track, weight)| add(sum, chunk.at(self.place[*track].1, x), *weight))
            });
            sum = (sum.0 + r, sum.1 + v * (1.0 / level.chunk_s()));
        }
        sum
    }

    /// Tracks and weights of `a` from `b`, summed only as far up as their common ancestor.
    fn between(&self, a: usize, b: usize, mut each: impl FnMut(usize, f64)) {
        let t = &self.tree;
        // Children of the root count from the barycentre, as the root does: there both ends stop.
        let top = |i: usize| t.parent[i].is_none_or(|p| p == 0);
        let (mut x, mut y) = (a, b);
        // Parents have lower indices: the higher one moves up until they meet.
        while x != y && !(top(x) && top(y)) {
            let (up, sign) = if top(y) || (x > y && !top(x)) { (&mut x, 1.0) } else { (&mut y, -1.0) };
            for (track, weight) in &t.steps[*up] {
                each(*track, sign * weight);
            }
            *up = t.parent[*up].unwrap_or_default();
        }
        if x != y {
            for (body, sign) in [(x, 1.0), (y, -1.0)] {
                for (track, weight) in &t.steps[body] {
                    each(*track, sign * weight);
                }
            }
        }
    }
}

impl Heard for System {
    #[allow(clippy::cast_possible_truncation)]
    fn track(&self, body: usize, t: f64) -> DVec3 {
        let (l, k) = self.place[body];
        let level = &self.levels[l];
        let whole = (t * TICKS_PER_SECOND as f64).floor();
        match level.locate(whole as i64, t - whole / TICKS_PER_SECOND as f64) {
            Some((n, x)) => level.view(self, n, |chunk: &Chunk| chunk.position(k, x)),
            None => self.conic(body, t).0,
        }
    }
}

impl Ephemeris {
    /// Builds a system of point masses. Bodies are addressed by their place in the list; the root is first, parents stand before
    /// children. Nothing is integrated yet.
    ///
    /// # Errors
    /// What is wrong with the list.
    pub fn new(orbits: Vec<Orbit>) -> Result<Self, EphemerisError> {
        Self::detailed(&orbits, &Details::default())
    }

    /// The same of bodies with figures, in company of masses that are not listed.
    ///
    /// # Errors
    /// What is wrong with the list.
    pub fn detailed(orbits: &[Orbit], details: &Details) -> Result<Self, EphemerisError> {
        let key = super::cache::key(orbits, details);
        Ok(Self { system: Some(Arc::new(System::new(orbits, details, key)?)) })
    }

    fn within(&self, body: BodyId) -> Option<&System> {
        self.system.as_deref().filter(|s| body.index() < s.tree.gm.len())
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.system.as_ref().map_or(0, |s| s.tree.gm.len())
    }

    /// True for the default value, which has no body.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// From when to when bodies are integrated, where somebody asks. Before and after they move on the conics of their starts.
    pub fn limits(&self) -> (SimTime, SimTime) {
        let Some(s) = &self.system else { return (SimTime::default(), SimTime::default()) };
        let least = s.levels.iter().map(|l| l.ticks * l.reach).min().unwrap_or_default();
        (s.tree.epoch.plus(-least), s.tree.epoch.plus(least))
    }

    /// Barycentric state of `body` at `t`, ICRF axes, m and m/s. A handle of another system gives the origin.
    pub fn state(&self, body: BodyId, t: SimTime) -> State<Icrf> {
        let Some(s) = self.within(body) else { return State::default() };
        wrap(s.sum(&s.whole[body.index()], t.ticks.saturating_sub(s.tree.epoch.ticks), 0.0))
    }

    /// State of `body` from the centre of `center`, ICRF axes: cheaper than a difference of two [`Ephemeris::state`]s, and
    /// with all its digits, since only what lies between the two is summed.
    pub fn relative(&self, body: BodyId, center: BodyId, t: SimTime) -> State<Icrf> {
        self.relative_at(body, center, t.into())
    }

    /// [`Ephemeris::relative`] between ticks.
    pub fn relative_at(&self, body: BodyId, center: BodyId, t: Moment) -> State<Icrf> {
        let (Some(s), Some(_)) = (self.within(body), self.within(center)) else { return State::default() };
        let ticks = t.tick.ticks.saturating_sub(s.tree.epoch.ticks);
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        s.between(body.index(), center.index(), |track, weight| {
            let (r, v) = s.track(track, ticks, t.beyond_s);
            sum = (sum.0 + r * weight, sum.1 + v * weight);
        });
        wrap(sum)
    }

    /// Taylor coefficients x⁽ᵏ⁾/k!, m/sᵏ, of the position of `body` from `center` about `t`, into `out`. Returns for how many seconds
    /// from `t` on that polynomial is the ephemeris itself (to the end of the piece; above 0).
    pub fn series(&self, body: BodyId, center: BodyId, t: Moment, out: &mut [DVec3]) -> f64 {
        out.fill(DVec3::ZERO);
        let (Some(s), Some(_)) = (self.within(body), self.within(center)) else { return f64::INFINITY };
        let ticks = t.tick.ticks.saturating_sub(s.tree.epoch.ticks);
        let mut ahead = f64::INFINITY;
        s.between(body.index(), center.index(), |track, weight| ahead = ahead.min(s.series(track, ticks, t.beyond_s, weight, out)));
        ahead
    }

    /// States of all bodies at `t`, in their order, into `out` (its memory is used again): each track is evaluated once.
    pub fn states_into(&self, t: SimTime, out: &mut Vec<State<Icrf>>) {
        out.clear();
        let Some(s) = &self.system else { return };
        let ticks = t.ticks.saturating_sub(s.tree.epoch.ticks);
        let known = |i: usize| i < s.tree.gm.len() || s.tree.has_light(i - s.tree.gm.len());
        // Tracks first, then bodies from them, then the tracks go: a list of their own would be asked of the allocator every time.
        let tracks = 2 * s.tree.gm.len();
        out.extend((0..tracks).map(|i| if known(i) { wrap(s.track(i, ticks, 0.0)) } else { State::default() }));
        for list in &s.whole {
            let sum = list.iter().fold((DVec3::ZERO, DVec3::ZERO), |sum, (k, w)| add(sum, (out[*k].position.0, out[*k].velocity.0), *w));
            out.push(wrap(sum));
        }
        out.drain(..tracks);
    }

    /// Bounds on where a body can be, seen from its parent.
    pub fn reach(&self, body: BodyId) -> Reach {
        self.within(body).map_or(Reach::default(), |s| s.reach[body.index()])
    }
}

impl System {
    /// Adds a track's Taylor coefficients about a moment; how many seconds they hold.
    fn series(&self, body: usize, ticks: i64, beyond_s: f64, weight: f64, out: &mut [DVec3]) -> f64 {
        let (l, k) = self.place[body];
        let level = &self.levels[l];
        let Some((n, x)) = level.locate(ticks, beyond_s) else {
            // Out of reach: the conic's tangent, for a second.
            let (r, v) = self.track(body, ticks, beyond_s);
            for (slot, c) in out.iter_mut().zip([r, v]) {
                *slot += c * weight;
            }
            return 1.0;
        };
        let mut own = [DVec3::ZERO; super::chunk::TERMS];
        let ahead = level.view(self, n, |chunk| chunk.series(k, x, weight, &mut own));
        let rate = 1.0 / level.chunk_s();
        let mut power = 1.0;
        for (slot, c) in out.iter_mut().zip(own) {
            *slot += c * power;
            power *= rate;
        }
        ahead * level.chunk_s()
    }
}

fn wrap((r, v): Pair) -> State<Icrf> {
    State { position: Position::new(r), velocity: Velocity::new(v) }
}

/// The shell of a body's conic at the epoch, with a margin for what the others do to it: 1 %, and half of √(the strength of the
/// strongest tide), which is what the Sun does to the Moon's eccentricity (evection).
fn reach_of(tree: &Tree, body: usize) -> Reach {
    let Some(p) = tree.parent[body] else { return Reach::default() };
    let gm = tree.family_gm[body] + tree.gm[p];
    let elements = Elements::from_state(gm, &wrap(tree.start[body]));
    let strength = tree.parent[p].map_or(0.0, |grand| {
        let ratio = tree.start[body].0.length() / tree.start[p].0.length();
        tree.gm[grand] / gm * ratio * ratio * ratio
    });
    let margin = (0.01 + 0.5 * strength.sqrt()).min(0.5);
    Reach {
        nearest_m: (1.0 - margin) * elements.periapsis_m,
        farthest_m: (1.0 + margin) * elements.apoapsis_m(),
        fastest_m_s: (1.0 + margin) * elements.fastest_m_s(),
    }
}
