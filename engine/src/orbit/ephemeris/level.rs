//! A level: bodies that are integrated together, outwards from the epoch, chunk by chunk.
//!
//! Time is cut into chunks of 2ⁿ ticks, counted from the epoch. Each begins at a *checkpoint* (positions and velocities) and is a pure
//! function of it: the integrator starts afresh there, so a chunk has the same bits whoever asks, in whatever order, whether
//! for the first time or again. The planetary level keeps its chunks; moons, which would fill the memory, keep checkpoints, and a few
//! chunks made from them on demand.

use super::chunk::{Chunk, Fitter};
use super::moons::{Moons, Outside, Pole};
use super::planets::Planets;
use crate::orbit::gravity::figure::Figure;
use crate::orbit::integrate::gauss_radau::GaussRadau;
use crate::orbit::integrate::{Force, Points, Step};
use crate::time::{SimTime, TICKS_PER_SECOND};
use glam::DVec3;
use std::sync::{Mutex, OnceLock, PoisonError, RwLock};

/// Chunks that a level of moons keeps.
const SLOTS: usize = 64;

/// Tolerance and settling of light moons' steps. Half the work of the planets' (1e-9, 1e-13), and after ten years no moon of the solar
/// system is further off than 0.4 m (Mimas; Phobos 0.2 m), a hundred thousandth of what their starts are known to.
const MOONS: [f64; 2] = [1e-5, 1e-11];

/// Where a level stands at the border of a chunk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Checkpoint {
    /// m.
    pub q: Vec<DVec3>,
    /// m/s.
    pub v: Vec<DVec3>,
}

/// What moves the bodies of a level. One a level: the difference in size costs nothing.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub enum Kind {
    /// The planetary level; how its tracks follow from the places of its members.
    Planets {
        /// Forces.
        forces: Planets,
        /// For each track: members and weights.
        tracks: Vec<Vec<(usize, f64)>>,
    },
    /// Light moons of one body.
    Moons {
        /// GM of the body they go round.
        planet_gm: f64,
        /// GM of each.
        gm: Vec<f64>,
        /// The figure of the body they go round.
        figure: Option<Figure>,
        /// The others whose tides count.
        outside: Vec<Outside>,
        /// Tracks that tell where those are.
        heard: Vec<usize>,
        /// For each of those: places in `heard`, and weights.
        others: Vec<Vec<(usize, f64)>>,
        /// Weight of each moon in the track that comes after theirs: what they draw the body aside.
        shares: Vec<f64>,
    },
}

/// Positions of tracks of other levels, by seconds from the epoch.
pub trait Heard: Sync {
    /// The place of a track.
    fn track(&self, body: usize, t: f64) -> DVec3;
}

/// One of the two directions of time, forward and backward.
#[derive(Debug, Default)]
struct Side {
    /// The k-th is where the k-th chunk outwards begins.
    checkpoints: RwLock<Vec<Checkpoint>>,
    growing: Mutex<()>,
}

type Slot = RwLock<Option<(i64, Chunk)>>;

/// A level.
#[derive(Debug)]
pub struct Level {
    /// Whose tracks it has.
    pub bodies: Vec<usize>,
    /// Ticks of a chunk.
    pub ticks: i64,
    /// Chunks on each side of the epoch.
    pub reach: i64,
    sides: [Side; 2],
    kind: Kind,
    epoch: SimTime,
    within_m: Vec<f64>,
    halvings: u32,
    fitter: Fitter,
    kept: Vec<OnceLock<Chunk>>,
    slots: Vec<Slot>,
}

/// What a level is made from.
pub struct Plan {
    /// Whose tracks it has.
    pub bodies: Vec<usize>,
    /// Ticks of a chunk.
    pub ticks: i64,
    /// Chunks on each side of the epoch.
    pub reach: i64,
    /// What moves them.
    pub kind: Kind,
    /// The epoch.
    pub epoch: SimTime,
    /// Where they start.
    pub start: Checkpoint,
    /// Error of the fit allowed for each track, m.
    pub within_m: Vec<f64>,
    /// Halvings of a chunk that the fastest track is expected to need.
    pub halvings: u32,
}

/// A step that was made, for sampling: what it spans and the integrator after it.
struct Made {
    early: f64,
    late: f64,
    method: GaussRadau,
}

impl Level {
    /// A level at its epoch; nothing is integrated yet.
    pub fn new(plan: Plan) -> Self {
        let keeps = matches!(plan.kind, Kind::Planets { .. });
        let side = || Side { checkpoints: RwLock::new(vec![plan.start.clone()]), growing: Mutex::default() };
        let sides = [side(), side()];
        Self {
            bodies: plan.bodies,
            ticks: plan.ticks,
            reach: plan.reach,
            sides,
            kind: plan.kind,
            epoch: plan.epoch,
            within_m: plan.within_m,
            halvings: plan.halvings,
            fitter: Fitter::default(),
            kept: (0..if keeps { 2 * plan.reach } else { 0 }).map(|_| OnceLock::new()).collect(),
            slots: (0..if keeps { 0 } else { SLOTS }).map(|_| RwLock::new(None)).collect(),
        }
    }

    /// True where chunks are kept.
    pub fn keeps(&self) -> bool {
        !self.kept.is_empty()
    }

    /// Seconds of a chunk.
    pub fn chunk_s(&self) -> f64 {
        self.ticks as f64 / TICKS_PER_SECOND as f64
    }

    /// The chunk of an instant and the place in it, 0 … 1, for ticks after the epoch and seconds beyond; `None` out of reach.
    pub fn locate(&self, ticks: i64, beyond_s: f64) -> Option<(i64, f64)> {
        let n = ticks.div_euclid(self.ticks);
        let x = (ticks.rem_euclid(self.ticks) as f64 + beyond_s * TICKS_PER_SECOND as f64) / self.ticks as f64;
        (-self.reach..self.reach).contains(&n).then_some((n, x))
    }

    fn slot_of(&self, n: i64) -> Option<&OnceLock<Chunk>> {
        usize::try_from(n + self.reach).ok().and_then(|i| self.kept.get(i))
    }

    /// A kept chunk, where it is there already.
    pub fn kept(&self, n: i64) -> Option<&Chunk> {
        self.slot_of(n).and_then(OnceLock::get)
    }

    /// Checkpoints of a side, the epoch's among them.
    pub fn grown(&self, side: usize) -> usize {
        self.sides[side].checkpoints.read().unwrap_or_else(PoisonError::into_inner).len()
    }

    /// Takes over what a cache held of a side: checkpoints from the epoch outwards, and the chunks between them where they are kept.
    pub fn adopt(&self, side: usize, checkpoints: Vec<Checkpoint>, chunks: Vec<Chunk>) {
        let _growing = self.sides[side].growing.lock().unwrap_or_else(PoisonError::into_inner);
        if checkpoints.len() <= self.grown(side) {
            return;
        }
        for (k, chunk) in (0_i64..).zip(chunks) {
            self.keep(if side == 0 { k } else { -1 - k }, chunk);
        }
        *self.sides[side].checkpoints.write().unwrap_or_else(PoisonError::into_inner) = checkpoints;
    }

    fn keep(&self, n: i64, chunk: Chunk) {
        if let Some(slot) = self.slot_of(n) {
            // One that is there already has the same bits.
            let _ = slot.set(chunk);
        }
    }

    /// Lets `look` see chunk `n`, which is made where it is not there.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn view<R>(&self, heard: &dyn Heard, n: i64, look: impl FnOnce(&Chunk) -> R) -> R {
        if self.keeps() {
            if self.kept(n).is_none() {
                self.grow(heard, n);
            }
            return match self.kept(n) {
                Some(chunk) => look(chunk),
                None => look(&Chunk::default()),
            };
        }
        let slot = &self.slots[n.rem_euclid(SLOTS as i64) as usize];
        {
            let seen = slot.read().unwrap_or_else(PoisonError::into_inner);
            if let Some((_, chunk)) = seen.as_ref().filter(|(number, _)| *number == n) {
                return look(chunk);
            }
        }
        self.grow(heard, n);
        let chunk = self.make(heard, n);
        let mut seen = slot.write().unwrap_or_else(PoisonError::into_inner);
        look(&seen.insert((n, chunk)).1)
    }

    /// The side of a chunk, and its number outwards from the epoch.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fn outwards(n: i64) -> (usize, usize) {
        if n >= 0 { (0, n as usize) } else { (1, (-1 - n) as usize) }
    }

    /// Integrates outwards until chunk `n` can be made (a kept one: is there).
    pub fn grow(&self, heard: &dyn Heard, n: i64) {
        let (side, number) = Self::outwards(n);
        let wanted = if self.keeps() { number + 2 } else { number + 1 };
        let side_ = &self.sides[side];
        let _growing = side_.growing.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            let (count, last) = {
                let list = side_.checkpoints.read().unwrap_or_else(PoisonError::into_inner);
                (list.len(), list.last().cloned().unwrap_or_default())
            };
            if count >= wanted {
                return;
            }
            let n = if side == 0 { count as i64 - 1 } else { -(count as i64) };
            let mut steps = self.keeps().then(Vec::new);
            let next = self.integrate(heard, n, &last, steps.as_mut());
            if let Some(steps) = steps {
                self.keep(n, self.fit(n, &last, steps));
            }
            side_.checkpoints.write().unwrap_or_else(PoisonError::into_inner).push(next);
        }
    }

    /// Makes a chunk from its checkpoint.
    fn make(&self, heard: &dyn Heard, n: i64) -> Chunk {
        let (side, number) = Self::outwards(n);
        let from = self.sides[side].checkpoints.read().unwrap_or_else(PoisonError::into_inner).get(number).cloned().unwrap_or_default();
        let mut steps = Vec::new();
        self.integrate(heard, n, &from, Some(&mut steps));
        self.fit(n, &from, steps)
    }

    /// Seconds after the epoch at which chunk `n` begins and ends.
    fn span(&self, n: i64) -> (f64, f64) {
        let at = |n: i64| (n * self.ticks) as f64 / TICKS_PER_SECOND as f64;
        (at(n), at(n + 1))
    }

    /// Integrates over chunk `n`, outwards, and writes down the steps where asked.
    fn integrate(&self, heard: &dyn Heard, n: i64, from: &Checkpoint, steps: Option<&mut Vec<Made>>) -> Checkpoint {
        let (early, late) = self.span(n);
        let (start, end) = if n >= 0 { (early, late) } else { (late, early) };
        let mut points = Points { t: start, q: from.q.clone(), v: from.v.clone() };
        match &self.kind {
            Kind::Planets { forces, .. } => {
                run(&forces.run(), GaussRadau::new(from.q.len(), GaussRadau::TOLERANCE), &mut points, end, steps)
            }
            Kind::Moons { planet_gm, gm, figure, outside, heard: tracks, others, .. } => {
                let others = self.others(heard, (early, late), tracks, others);
                let forces = Moons {
                    planet_gm: *planet_gm,
                    pole: Pole::between(figure.as_ref(), self.epoch, early, late),
                    gm,
                    figure: figure.as_ref(),
                    outside,
                    others: &others,
                    span_s: (early, late),
                };
                run(&forces, GaussRadau::new(from.q.len(), MOONS[0]).settling(MOONS[1]), &mut points, end, steps);
            }
        }
        Checkpoint { q: points.q, v: points.v }
    }

    /// Where the others are over a stretch of time, good to a part of their distance that does not count in their tides.
    fn others(&self, heard: &dyn Heard, (early, late): (f64, f64), tracks: &[usize], others: &[Vec<(usize, f64)>]) -> Chunk {
        const WITHIN: f64 = 1e-9;
        let mut places = Vec::with_capacity(tracks.len());
        let mut sample = |x: f64, out: &mut [DVec3]| {
            places.clear();
            places.extend(tracks.iter().map(|b| heard.track(*b, early + x * (late - early))));
            for (out, list) in out.iter_mut().zip(others) {
                *out = list.iter().fold(DVec3::ZERO, |sum, (k, w)| sum + places[*k] * *w);
            }
        };
        let mut middle = vec![DVec3::ZERO; others.len()];
        sample(0.5, &mut middle);
        let within: Vec<f64> = middle.iter().map(|place| WITHIN * place.length() + f64::MIN_POSITIVE).collect();
        self.fitter.fit(&within, 0, sample)
    }

    /// Fits the tracks over chunk `n` to the steps made.
    fn fit(&self, n: i64, from: &Checkpoint, mut steps: Vec<Made>) -> Chunk {
        let (early, late) = self.span(n);
        if n < 0 {
            steps.reverse();
        }
        let count = from.q.len();
        let (mut q, mut v) = (from.q.clone(), vec![DVec3::ZERO; count]);
        let mut at = 0;
        let mut last = f64::INFINITY;
        let sample = |x: f64, out: &mut [DVec3]| {
            let t = early + x * (late - early);
            if x < last {
                at = 0;
            }
            last = x;
            while at + 1 < steps.len() && t > steps[at].late {
                at += 1;
            }
            if let Some(step) = steps.get(at) {
                // Where no step could be made the last place is held.
                step.method.dense(t.clamp(step.early, step.late), &mut q, &mut v);
            }
            match &self.kind {
                Kind::Planets { tracks, .. } => {
                    for (out, list) in out.iter_mut().zip(tracks) {
                        *out = list.iter().fold(DVec3::ZERO, |sum, (k, w)| sum + q[*k] * *w);
                    }
                }
                Kind::Moons { shares, .. } => {
                    let (moons, aside) = out.split_at_mut(q.len());
                    moons.copy_from_slice(&q);
                    aside.fill(q.iter().zip(shares).fold(DVec3::ZERO, |sum, (q, share)| sum + *q * *share));
                }
            }
        };
        self.fitter.fit(&self.within_m, self.halvings, sample)
    }
}

/// Integrates to `end`. Points that cannot go on (two at one place) go straight from there.
fn run<F: Force>(force: &F, mut method: GaussRadau, points: &mut Points, end: f64, mut steps: Option<&mut Vec<Made>>) {
    loop {
        let before = points.t;
        match method.step(force, points, end) {
            Step::Made => {
                if let Some(steps) = &mut steps {
                    steps.push(Made { early: before.min(points.t), late: before.max(points.t), method: method.clone() });
                }
            }
            Step::Arrived => return,
            Step::Stalled => {
                let left = end - points.t;
                for (q, v) in points.q.iter_mut().zip(&points.v) {
                    *q += *v * left;
                }
                points.t = end;
                return;
            }
        }
    }
}

impl Level {
    /// The checkpoints of a side, from the epoch outwards.
    pub fn checkpoints(&self, side: usize) -> Vec<Checkpoint> {
        self.sides[side].checkpoints.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Where the level starts.
    pub fn start(&self) -> Checkpoint {
        self.sides[0].checkpoints.read().unwrap_or_else(PoisonError::into_inner).first().cloned().unwrap_or_default()
    }

    /// Places of the tracks from those of the members.
    pub fn tracks_of(&self, q: &[DVec3]) -> Vec<DVec3> {
        match &self.kind {
            Kind::Planets { tracks, .. } => {
                tracks.iter().map(|list| list.iter().fold(DVec3::ZERO, |sum, (k, w)| sum + q[*k] * *w)).collect()
            }
            Kind::Moons { .. } => q.to_vec(),
        }
    }
}
