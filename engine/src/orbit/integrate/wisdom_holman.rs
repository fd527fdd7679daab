//! Wisdom–Holman: Kepler orbits, exactly, and kicks by what disturbs them; symplectic, of fixed step, in a hierarchy of pairs.
//!
//! For systems in which everything goes around something: steps of a twentieth of the shortest period hold for ages. A moon is a pair
//! of its own with its planet: listed as one more planet it would be lost while the energy looks fine. Close encounters between what
//! is not a pair break it. Not here: forces other than those of points; Kepler's problem (`kepler`).
//! - [Wisdom & Holman 1991] "Symplectic maps for the n-body problem", AJ 102, 1528.
//! - [Wisdom, Holman & Touma 1996] "Symplectic correctors", Fields Inst. Commun. 10, 217.
//! - [Wisdom 2006] "Symplectic correctors for canonical heliocentric n-body maps", AJ 131, 2294.
//! - [Beust 2003] "Symplectic integration of hierarchical stellar systems", A&A 400, 1129.
//! - [Battin 1999] "An Introduction to the Mathematics and Methods of Astrodynamics", §8.4 (differences of nearly equal attractions).

mod corrector;
mod hierarchy;
#[cfg(test)]
mod tests;

pub use corrector::Corrector;
pub use hierarchy::Hierarchy;

use super::{Points, Work};
use crate::orbit::kepler;
use glam::DVec3;
use hierarchy::Join;
use serde::{Deserialize, Serialize};

/// Where a run stands, in its own coordinates (hierarchical, corrected, half a drift owed): what a restart with the same bits needs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    start: f64,
    steps: u64,
    /// Drift that is owed before the points are at their time.
    owed: f64,
    /// Vectors of the joins and their rates; the last is the centre of mass.
    r: Vec<DVec3>,
    v: Vec<DVec3>,
}

/// The method for one system: masses, hierarchy, step, corrector, state.
#[derive(Clone, Debug)]
pub struct WisdomHolman {
    joins: Vec<Join>,
    gm: Vec<f64>,
    dt: f64,
    stages: Vec<(f64, f64)>,
    memory: Memory,
    /// Of each node (bodies, then joins): its bodies from its centre of mass.
    around: Vec<Vec<DVec3>>,
    pulls: Vec<DVec3>,
    work: Work,
}

impl WisdomHolman {
    /// For bodies of gravitational parameters `gm` (0 for what does not attract) that go around each other as `hierarchy` says, by steps
    /// of `dt` (either sign).
    pub fn new(gm: &[f64], hierarchy: &Hierarchy, dt: f64, corrector: Corrector) -> Self {
        let joins = hierarchy::weigh(hierarchy, gm);
        let sizes = gm.iter().map(|_| 1).chain(joins.iter().map(|j| j.first.len() + j.second.len()));
        Self {
            around: sizes.map(|n| vec![DVec3::ZERO; n]).collect(),
            joins,
            gm: gm.to_vec(),
            dt,
            stages: corrector.stages(),
            memory: Memory::default(),
            pulls: vec![DVec3::ZERO; gm.len()],
            work: Work::default(),
        }
    }

    /// Begins a run at `points` (as many as bodies).
    pub fn start(&mut self, points: &Points) {
        let (mut r, mut v) = (self.gather(&points.q), self.gather(&points.v));
        r.resize(self.joins.len() + 1, DVec3::ZERO);
        v.resize(self.joins.len() + 1, DVec3::ZERO);
        self.memory = Memory { start: points.t, steps: 0, owed: 0.0, r, v };
        self.correct(true);
    }

    /// Where the run stands: to be saved for [`Self::resume`].
    pub fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Goes on where `memory` was saved.
    pub fn resume(&mut self, memory: Memory) {
        self.memory = memory;
    }

    /// What all steps so far have cost: kicks count as evaluations.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Takes `steps` steps. The drifts of neighbours are made as one.
    pub fn advance(&mut self, steps: u64) {
        for _ in 0..steps {
            self.drift(self.memory.owed + 0.5 * self.dt);
            self.kick(self.dt);
            self.memory.owed = 0.5 * self.dt;
            self.memory.steps += 1;
            self.work.steps += 1;
        }
    }

    /// The points now; the run itself is left as it is.
    pub fn points(&self) -> Points {
        let mut copy = self.clone();
        copy.drift(self.memory.owed);
        copy.correct(false);
        let t = self.memory.start + self.memory.steps as f64 * self.dt;
        Points { t, q: copy.scatter(&copy.memory.r), v: copy.scatter(&copy.memory.v) }
    }

    /// From `points` to `t_end` by equal steps, the fewest that are no longer than the step asked for.
    pub fn run(&mut self, points: &mut Points, t_end: f64) -> Work {
        let before = self.work;
        let span = t_end - points.t;
        let count = (span / self.dt).abs();
        // A count beyond 2⁵³, or none, is no run.
        if span != 0.0 && count.is_finite() && count < 9e15 {
            let count = (count * (1.0 - 1e-12)).ceil().max(1.0);
            let dt = self.dt;
            self.dt = span / count;
            self.start(points);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number of steps below 2⁵³")]
            self.advance(count as u64);
            *points = Points { t: t_end, ..self.points() };
            self.dt = dt;
        }
        Work { steps: self.work.steps - before.steps, rejected: 0, evaluations: self.work.evaluations - before.evaluations }
    }

    /// Applies the corrector, or takes it back.
    fn correct(&mut self, forward: bool) {
        // The product is Z(−a_k, −b_k) … Z(−a₁, −b₁) Z(a₁, b₁) … Z(a_k, b_k); Z(−a, b) undoes Z(a, b).
        let stages = std::mem::take(&mut self.stages);
        let all = stages.iter().rev().map(|(a, b)| (-a, -b)).chain(stages.iter().copied());
        let list: Vec<(f64, f64)> = if forward { all.collect() } else { all.rev().map(|(a, b)| (-a, b)).collect() };
        for (a, b) in list {
            let (a, b) = (a * self.dt, b * self.dt);
            self.drift(a);
            self.kick(-b);
            self.drift(-2.0 * a);
            self.kick(b);
            self.drift(a);
        }
        self.stages = stages;
    }

    /// Every pair along its Kepler orbit, the centre of mass straight on.
    fn drift(&mut self, dt: f64) {
        if dt == 0.0 {
            return;
        }
        for (join, (r, v)) in self.joins.iter().zip(self.memory.r.iter_mut().zip(&mut self.memory.v)) {
            (*r, *v) = kepler::propagate_raw(join.gm, *r, *v, dt);
        }
        if let (Some(r), Some(v)) = (self.memory.r.last_mut(), self.memory.v.last()) {
            *r += *v * dt;
        }
    }

    /// What disturbs the pairs, for `dt`. A pair is moved by what differs between the pulls of its two sides' bodies and that of their
    /// centres (f(q), so that nothing cancels), and by the tides of all that is beyond it.
    fn kick(&mut self, dt: f64) {
        self.work.evaluations += 1;
        self.pulls.fill(DVec3::ZERO);
        self.place();
        for (k, join) in self.joins.iter().enumerate().rev() {
            let r = self.memory.r[k];
            let mean = |side: &[(usize, f64)], pulls: &[DVec3]| side.iter().map(|(i, part)| pulls[*i] * *part).sum::<DVec3>();
            let mut change = mean(&join.second, &self.pulls) - mean(&join.first, &self.pulls);
            let (lone_first, lone_second) = (join.first.len() == 1, join.second.len() == 1);
            let r2 = r.length_squared();
            if !(lone_first && lone_second) && r2 > 0.0 {
                let (around_first, around_second) = (&self.around[join.nodes.0], &self.around[join.nodes.1]);
                for ((i, part_i), from) in join.first.iter().zip(around_first) {
                    for ((j, part_j), to) in join.second.iter().zip(around_second) {
                        let beyond = *to - *from;
                        let d = r + beyond;
                        let d2 = d.length_squared();
                        if d2 > 0.0 {
                            let cube = 1.0 / (d2 * d2.sqrt());
                            // d² = r²(1 + q); r/r³ − d/d³ = (f r − beyond)/d³ [Battin 1999, §8.4].
                            let q = beyond.dot(beyond + 2.0 * r) / r2;
                            let one = 1.0 + q;
                            let f = q * (3.0 + 3.0 * q + q * q) / (1.0 + one * one.max(0.0).sqrt());
                            change += (r * f - beyond) * (cube * join.gm * part_i * part_j);
                            if !lone_first {
                                self.pulls[*i] += d * (cube * self.gm[*j]);
                            }
                            if !lone_second {
                                self.pulls[*j] -= d * (cube * self.gm[*i]);
                            }
                        }
                    }
                }
            }
            self.memory.v[k] += change * dt;
        }
    }

    /// Fills `around` from the vectors of the joins, inner ones first.
    fn place(&mut self) {
        for (k, join) in self.joins.iter().enumerate() {
            let (before, here) = self.around.split_at_mut(self.gm.len() + k);
            let (first, second) = (&before[join.nodes.0], &before[join.nodes.1]);
            let r = self.memory.r[k];
            let places = first.iter().map(|o| *o - r * join.share).chain(second.iter().map(|o| *o + r * (1.0 - join.share)));
            for (to, place) in here[0].iter_mut().zip(places) {
                *to = place;
            }
        }
    }

    /// From bodies to joins, and last the centre of mass.
    fn gather(&self, bodies: &[DVec3]) -> Vec<DVec3> {
        let mut nodes = bodies.to_vec();
        let mut vectors = Vec::with_capacity(self.joins.len() + 1);
        for join in &self.joins {
            let (a, b) = (nodes.get(join.nodes.0).copied().unwrap_or_default(), nodes.get(join.nodes.1).copied().unwrap_or_default());
            vectors.push(b - a);
            nodes.push(a + (b - a) * join.share);
        }
        vectors.push(nodes.last().copied().unwrap_or_default());
        vectors
    }

    /// From joins to bodies.
    fn scatter(&self, vectors: &[DVec3]) -> Vec<DVec3> {
        let bodies = self.gm.len();
        let mut nodes = vec![DVec3::ZERO; bodies + self.joins.len()];
        if let (Some(root), Some(centre)) = (nodes.last_mut(), vectors.last()) {
            *root = *centre;
        }
        for (k, join) in self.joins.iter().enumerate().rev() {
            let (centre, r) = (nodes[bodies + k], vectors[k]);
            nodes[join.nodes.0] = centre - r * join.share;
            nodes[join.nodes.1] = centre + r * (1.0 - join.share);
        }
        nodes.truncate(bodies);
        nodes
    }
}
