//! The tree of a system: who is integrated with whom, from which start, and how a place is put together from tracks.
//!
//! The star, the planets and every moon heavy and far enough to pull its planet's neighbours differently from a point (the Moon)
//! make the *planetary level*, which is integrated about the barycentre. In it a planet with its light moons is one mass. The
//! light moons of each body are a level of their own, about the body's centre. Each body has one *track*:
//!
//! | body | its track |
//! |---|---|
//! | root | from the barycentre |
//! | child of the root | its family's centre of mass (with heavy and light moons), from the barycentre |
//! | heavy moon | its family's centre of mass, from that of its parent with the parent's light moons |
//! | light moon | the centre of mass of it and its own moons, from the parent's centre |
//!
//! So a moon's place from its planet is one polynomial, and a planet's is that of its centre of mass less what its light moons draw it
//! aside, which is a track of its own.

use super::mean;
use super::orbit::{Details, EphemerisError, Orbit, Path};
use crate::orbit::kepler::Conic;
use crate::time::SimTime;
use glam::DVec3;

/// A moon joins the planetary level where the quadrupole of the pair, (m/M)(a/d)², is more than this part of a point's gravity:
/// 1e-9 moves a planet by a few kilometres in a revolution. The Moon's is 8e-8, Callisto's 3e-10.
const HEAVY: f64 = 1e-9;
/// How far, as a part, the size that mean elements give may lie from the one that their motion gives: published sizes are rounded,
/// and siblings pull.
const PACE: f64 = 0.02;

/// Position and velocity.
pub type Pair = (DVec3, DVec3);

/// `a + b × scale`.
pub fn add(a: Pair, b: Pair, scale: f64) -> Pair {
    (a.0 + b.0 * scale, a.1 + b.1 * scale)
}

/// The tree, and where everything starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// When the system starts: the root's epoch.
    pub epoch: SimTime,
    /// Parent of each body.
    pub parent: Vec<Option<usize>>,
    /// Children of each body, in the order of the list.
    pub children: Vec<Vec<usize>>,
    /// GM of each body, m³/s².
    pub gm: Vec<f64>,
    /// GM of each body with all its moons.
    pub family_gm: Vec<f64>,
    /// True for members of the planetary level.
    pub planetary: Vec<bool>,
    /// GM of a member of the planetary level with its light moons; of a light moon with all its moons.
    pub point_gm: Vec<f64>,
    /// Start of each body's centre, from its parent's centre; of the root, from the barycentre.
    pub start: Vec<Pair>,
    /// What is summed for the centre of each body from its parent's centre: tracks and weights. Of the root and its children: from
    /// the barycentre.
    pub steps: Vec<Vec<(usize, f64)>>,
}

impl Tree {
    /// Builds the tree of a list that was checked.
    ///
    /// # Errors
    /// Two bodies at one place.
    pub fn new(orbits: &[Orbit], details: &Details) -> Result<Self, EphemerisError> {
        let n = orbits.len();
        let parent: Vec<Option<usize>> = orbits.iter().map(|o| o.parent.map(|p| p.index())).collect();
        let gm: Vec<f64> = orbits.iter().map(|o| o.gm_m3_s2).collect();
        let mut family_gm = gm.clone();
        let mut children = vec![Vec::new(); n];
        for i in (0..n).rev() {
            if let Some(family) = details.family_gm_m3_s2.get(i).copied().flatten() {
                family_gm[i] = family;
            }
            if let Some(p) = parent[i] {
                family_gm[p] += family_gm[i];
                children[p].insert(0, i);
            }
        }
        let epoch = orbits[0].path.epoch();
        let mut tree = Self {
            epoch,
            parent,
            children,
            point_gm: family_gm.clone(),
            gm,
            family_gm,
            planetary: vec![false; n],
            start: Vec::new(),
            steps: Vec::new(),
        };
        tree.paced(orbits, details)?;
        tree.start = tree.starts(orbits, details);
        tree.choose();
        tree.steps = (0..n).map(|i| tree.step(i)).collect();
        tree.apart(details)?;
        Ok(tree)
    }

    /// Centre of mass of a family, from the body's centre, for given places of the children's centres from it.
    fn family_offset(&self, body: usize, centre: &[Pair]) -> Pair {
        self.children[body].iter().fold((DVec3::ZERO, DVec3::ZERO), |sum, &c| {
            let of_child = add(centre[c], self.family_offset(c, centre), 1.0);
            add(sum, of_child, self.family_gm[c] / self.family_gm[body])
        })
    }

    /// Refuses mean elements whose size and motion do not belong together.
    fn paced(&self, orbits: &[Orbit], details: &Details) -> Result<(), EphemerisError> {
        for (body, orbit) in orbits.iter().enumerate() {
            let (Path::Mean(mean), Some(p)) = (&orbit.path, self.parent[body]) else { continue };
            let figure = details.figures.get(p).and_then(Option::as_ref);
            let kepler_m = mean::semi_major_m(mean, self.gm[body] + self.gm[p], figure);
            let off = (kepler_m / mean.semi_major_m - 1.0).abs();
            if off.is_nan() || off > PACE {
                return Err(EphemerisError::Pace { body, given_m: mean.semi_major_m, kepler_m });
            }
        }
        Ok(())
    }

    /// Where each body's centre starts, from its parent's.
    fn starts(&self, orbits: &[Orbit], details: &Details) -> Vec<Pair> {
        let n = orbits.len();
        let zero = (DVec3::ZERO, DVec3::ZERO);
        let absolute = |i: usize| i == 0 || matches!(orbits[i].path, Path::Barycentric { .. });
        let mut start = vec![zero; n];
        // Leaves first: the moons' places are known when a planet's is taken from that of the family.
        for i in (0..n).rev() {
            let p = self.parent[i];
            let both = self.gm[i] + p.map_or(0.0, |p| self.gm[p]);
            start[i] = match &orbits[i].path {
                Path::FromParent { state, epoch } => {
                    let own = (state.position.0, state.velocity.0);
                    if p.is_none() || *epoch == self.epoch {
                        own
                    } else {
                        Conic::new(both, own.0, own.1).after_raw(self.epoch.since(*epoch))
                    }
                }
                Path::Mean(orbit) => {
                    let figure = p.and_then(|p| details.figures.get(p)).and_then(Option::as_ref);
                    mean::state(orbit, both, figure, self.epoch)
                }
                Path::Barycentric { state, of_system: false, .. } => (state.position.0, state.velocity.0),
                Path::Barycentric { state, of_system: true, .. } => {
                    // The family's place is (1 − Σw) × the centre's + Σ w × that of each child given from the barycentre, with the
                    // others' offsets from the centre.
                    let (mut own, mut left) = ((state.position.0, state.velocity.0), 1.0);
                    for &c in &self.children[i] {
                        let weight = self.family_gm[c] / self.family_gm[i];
                        own = add(own, add(start[c], self.family_offset(c, &start), 1.0), -weight);
                        left -= if absolute(c) { weight } else { 0.0 };
                    }
                    (own.0 / left, own.1 / left)
                }
            };
            for &c in self.children[i].iter().filter(|c| absolute(**c)) {
                start[c] = add(start[c], start[i], -1.0);
            }
        }
        start
    }

    /// Who belongs to the planetary level.
    fn choose(&mut self) {
        self.planetary[0] = true;
        for i in 1..self.gm.len() {
            let Some(p) = self.parent[i] else { continue };
            self.planetary[i] = match self.parent[p] {
                None => true,
                Some(_) if self.planetary[p] => {
                    let ratio = self.start[i].0.length() / self.start[p].0.length();
                    self.family_gm[i] / self.family_gm[p] * ratio * ratio > HEAVY
                }
                Some(_) => false,
            };
        }
        for i in 0..self.gm.len() {
            if self.planetary[i] {
                let heavy: f64 = self.children[i].iter().filter(|c| self.planetary[**c]).map(|c| self.family_gm[*c]).sum();
                self.point_gm[i] = self.family_gm[i] - heavy;
            }
        }
    }

    /// The track of what the light moons of a body draw it aside: tracks of this kind count on from the bodies.
    pub fn aside(&self, body: usize) -> usize {
        self.gm.len() + body
    }

    /// Light moons' part in the place of the body with them, from its centre.
    fn inner(&self, body: usize, weight: f64, out: &mut Vec<(usize, f64)>) {
        if self.has_light(body) {
            out.push((self.aside(body), weight));
        }
    }

    /// True where a body has light moons.
    pub fn has_light(&self, body: usize) -> bool {
        self.children[body].iter().any(|c| !self.planetary[*c])
    }

    /// Weight of a light moon (with its own moons) in the place of its planet with all light ones.
    pub fn share(&self, moon: usize) -> f64 {
        self.parent[moon].map_or(0.0, |p| self.family_gm[moon] / self.point_gm[p])
    }

    /// Heavy moons' part in the place of the family, from the body with its light moons.
    fn outer(&self, body: usize, weight: f64, out: &mut Vec<(usize, f64)>) {
        for &c in self.children[body].iter().filter(|c| self.planetary[**c] && body != 0) {
            out.push((c, weight * self.family_gm[c] / self.family_gm[body]));
        }
    }

    fn step(&self, body: usize) -> Vec<(usize, f64)> {
        let mut list = vec![(body, 1.0)];
        if self.planetary[body] {
            self.outer(body, -1.0, &mut list);
        }
        self.inner(body, -1.0, &mut list);
        if self.planetary[body]
            && let Some(p) = self.parent[body]
            && p != 0
        {
            self.inner(p, 1.0, &mut list);
        }
        list
    }

    /// Barycentric starts of the members of the planetary level (with their light moons), in the order of the list.
    pub fn planetary_starts(&self) -> (Vec<usize>, Vec<Pair>) {
        let zero = (DVec3::ZERO, DVec3::ZERO);
        let mut centre = vec![zero; self.gm.len()];
        for i in 0..self.gm.len() {
            centre[i] = self.parent[i].map_or(self.start[i], |p| add(self.start[i], centre[p], 1.0));
        }
        let members: Vec<usize> = (0..self.gm.len()).filter(|i| self.planetary[*i]).collect();
        let places = members.iter().map(|&i| {
            self.children[i].iter().filter(|c| !self.planetary[**c]).fold(centre[i], |sum, &c| {
                let of_child = add(self.start[c], self.family_offset(c, &self.start), 1.0);
                add(sum, of_child, self.family_gm[c] / self.point_gm[i])
            })
        });
        let places = places.collect();
        (members, places)
    }

    /// Starts of the tracks of the light moons of a body, in the order of its children.
    pub fn light_starts(&self, body: usize) -> (Vec<usize>, Vec<Pair>) {
        let moons: Vec<usize> = self.children[body].iter().copied().filter(|c| !self.planetary[*c]).collect();
        let starts = moons.iter().map(|&c| add(self.start[c], self.family_offset(c, &self.start), 1.0)).collect();
        (moons, starts)
    }

    /// Refuses two bodies at one place.
    fn apart(&self, details: &Details) -> Result<(), EphemerisError> {
        let (mut members, mut places) = self.planetary_starts();
        members.extend((0..details.masses.len()).map(|k| self.gm.len() + k));
        places.extend(details.masses.iter().map(|m| (m.state.position.0, m.state.velocity.0)));
        let same = |who: &[usize], list: &[Pair], centre: Option<usize>| {
            for (i, a) in list.iter().enumerate() {
                if let Some(c) = centre
                    && a.0 == DVec3::ZERO
                {
                    return Err(EphemerisError::Same(c, who[i]));
                }
                for (j, b) in list.iter().enumerate().take(i) {
                    if a.0 == b.0 {
                        return Err(EphemerisError::Same(who[j], who[i]));
                    }
                }
            }
            Ok(())
        };
        same(&members, &places, None)?;
        for i in 0..self.gm.len() {
            let (moons, starts) = self.light_starts(i);
            same(&moons, &starts, Some(i))?;
        }
        Ok(())
    }
}
