//! The ephemeris: position and velocity of body B at time t. This interface is deliberately narrow: what stands behind it
//! (Kepler orbits now) may be replaced without any caller noticing.
//!
//! Bodies form a tree. The children of a body are chained as in Jacobi coordinates: each child's *system* (the child with its
//! own moons) runs on a conic about the centre of mass of its parent and of all siblings inside its orbit
//! [Wisdom & Holman 1991]. So the star swings about the barycentre, the Earth about the centre of mass that it shares with the
//! Moon, and at their epoch all states are exactly those given.
//!
//! Accuracy away from the epoch is that of unperturbed conics: see `assets/systems/sol/system.toml` for measured errors.
//! - [Wisdom & Holman 1991] "Symplectic maps for the n-body problem", AJ 102, 1528 (Jacobi coordinates, §3).

use super::elements::Elements;
use super::field::Reach;
use super::kepler::Conic;
use super::{BodyId, State};
use crate::space::{Icrf, Position, Velocity};
use crate::time::SimTime;
use core::f64::consts::FRAC_PI_2;
use glam::{DQuat, DVec3};

/// How the path of a body is given.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// A state at an epoch from the solar-system barycentre, ICRF axes: of the body itself, or of the centre of mass of the
    /// body and its moons (as planetary ephemerides give it for the outer planets). The root moves on uniformly.
    Barycentric {
        /// When.
        epoch: SimTime,
        /// m and m/s.
        state: State<Icrf>,
        /// True when the state is that of the body with its moons.
        of_system: bool,
    },
    /// A state at an epoch from the parent's centre, ICRF axes.
    FromParent {
        /// When.
        epoch: SimTime,
        /// m and m/s.
        state: State<Icrf>,
    },
    /// Mean elements of a precessing ellipse about the parent.
    Mean(MeanOrbit),
}

/// A precessing ellipse in a plane given by its pole; angles count from the plane's ascending node on the ICRF equator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanOrbit {
    /// When the angles hold.
    pub epoch: SimTime,
    /// Semi-major axis, m.
    pub semi_major_m: f64,
    /// Eccentricity, below 1.
    pub eccentricity: f64,
    /// Inclination to the plane, rad.
    pub inclination_rad: f64,
    /// Longitude of the ascending node on the plane, rad, and its rate, rad/s.
    pub node_rad: [f64; 2],
    /// Argument of periapsis, rad, and its rate, rad/s.
    pub argument_rad: [f64; 2],
    /// Mean anomaly at the epoch, rad.
    pub mean_anomaly_rad: f64,
    /// Sidereal mean motion: rate of the mean longitude (node + argument + anomaly), rad/s.
    pub mean_longitude_rate_rad_s: f64,
    /// Right ascension and declination of the plane's pole, rad.
    pub pole_ra_dec_rad: [f64; 2],
}

/// One body of the tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// What it orbits; `None` for the root.
    pub parent: Option<BodyId>,
    /// Gravitational parameter of the body alone, m³/s².
    pub gm_m3_s2: f64,
    /// Where it is.
    pub path: Path,
}

/// Why a list of orbits is no system.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EphemerisError {
    /// No body, or more than a handle can count.
    #[error("a system needs 1 to 65535 bodies, got {0}")]
    Count(usize),
    /// The first body has a parent, or another has none.
    #[error("body {0}: the first body is the root and has no parent; every other body has one")]
    Root(usize),
    /// A parent does not stand before its child.
    #[error("body {0}: its parent must stand before it in the list")]
    Order(usize),
    /// A number is not finite, or a GM is not positive, or an orbit is not closed.
    #[error("body {body}: {what}")]
    Value {
        /// Which body.
        body: usize,
        /// What is wrong.
        what: &'static str,
    },
}

/// A conic, possibly precessing.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Track {
    Uniform { position: DVec3, velocity: DVec3 },
    Conic(Conic),
    Precessing { conic: Conic, since_periapsis_s: f64, orbit: MeanOrbit, icrf_from_plane: DQuat },
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    parent: Option<usize>,
    /// Children, innermost first.
    children: Vec<usize>,
    /// Place among the parent's children.
    rank: usize,
    /// GM of this system over the GM of all up to and including it, in the parent's chain.
    share: f64,
    epoch: SimTime,
    track: Track,
    reach: Reach,
}

/// Where every body of a system is, at any time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ephemeris {
    nodes: Vec<Node>,
}

type Pair = (DVec3, DVec3);

fn add(a: Pair, b: Pair, scale: f64) -> Pair {
    (a.0 + b.0 * scale, a.1 + b.1 * scale)
}

fn about(axis: DVec3, angle: f64) -> DQuat {
    let (s, c) = libm::sincos(0.5 * angle);
    DQuat::from_xyzw(axis.x * s, axis.y * s, axis.z * s, c)
}

impl Track {
    fn at(&self, dt_s: f64) -> Pair {
        match self {
            Self::Uniform { position, velocity } => (*position + *velocity * dt_s, *velocity),
            Self::Conic(conic) => conic.after_raw(dt_s),
            Self::Precessing { conic, since_periapsis_s, orbit, icrf_from_plane } => {
                let (r, v) = conic.after_raw(since_periapsis_s + dt_s);
                let node = about(DVec3::Z, orbit.node_rad[0] + orbit.node_rad[1] * dt_s);
                let tilt = about(DVec3::X, orbit.inclination_rad);
                let turn = about(DVec3::Z, orbit.argument_rad[0] + orbit.argument_rad[1] * dt_s);
                let plane_from_perifocal = node * tilt * turn;
                let r = plane_from_perifocal * r;
                let normal = node * (tilt * DVec3::Z);
                // The ellipse turns while the body runs on it.
                let drift = DVec3::Z * orbit.node_rad[1] + normal * orbit.argument_rad[1];
                let v = plane_from_perifocal * v + drift.cross(r);
                (*icrf_from_plane * r, *icrf_from_plane * v)
            }
        }
    }
}

impl Ephemeris {
    /// Builds the tree. Bodies are addressed by their place in the list; the root is first, parents stand before children.
    pub fn new(orbits: Vec<Orbit>) -> Result<Self, EphemerisError> {
        check(&orbits)?;
        let n = orbits.len();
        let mut system_gm: Vec<f64> = orbits.iter().map(|o| o.gm_m3_s2).collect();
        let mut children = vec![Vec::new(); n];
        for i in (1..n).rev() {
            if let Some(p) = orbits[i].parent {
                system_gm[p.index()] += system_gm[i];
                children[p.index()].insert(0, i);
            }
        }
        for list in &mut children {
            list.sort_by(|a: &usize, b| size(&orbits, *a).total_cmp(&size(&orbits, *b)));
        }
        let mut nodes: Vec<Node> = orbits
            .iter()
            .zip(children)
            .map(|(o, children)| Node {
                parent: o.parent.map(BodyId::index),
                children,
                rank: 0,
                share: 0.0,
                epoch: epoch_of(&o.path),
                track: Track::Uniform { position: DVec3::ZERO, velocity: DVec3::ZERO },
                reach: Reach::default(),
            })
            .collect();
        // Leaves first: a moon's conic is known before its planet's system state is needed.
        for i in (0..n).rev() {
            let mut inside = orbits[i].gm_m3_s2;
            for rank in 0..nodes[i].children.len() {
                let c = nodes[i].children[rank];
                inside += system_gm[c];
                nodes[c].rank = rank;
                nodes[c].share = system_gm[c] / inside;
            }
        }
        let mut built = Self { nodes };
        // Outwards from each parent, so that the chain inside a child is known when its relative state is taken.
        for parent in (0..n).rev() {
            let mut inside = orbits[parent].gm_m3_s2;
            for rank in 0..built.nodes[parent].children.len() {
                let c = built.nodes[parent].children[rank];
                inside += system_gm[c];
                built.nodes[c].track = built.track_of(&orbits, c, inside);
                built.nodes[c].reach = reach_of(&built.nodes[c], inside);
            }
        }
        let (Path::Barycentric { state, epoch, .. } | Path::FromParent { state, epoch }) = &orbits[0].path else {
            return Err(EphemerisError::Value { body: 0, what: "the root needs a state, not elements" });
        };
        let of_system = matches!(orbits[0].path, Path::Barycentric { of_system: true, .. });
        let swing = if of_system { (DVec3::ZERO, DVec3::ZERO) } else { built.centre_of_mass(0, *epoch) };
        built.nodes[0].track = Track::Uniform { position: state.position.0 + swing.0, velocity: state.velocity.0 + swing.1 };
        Ok(built)
    }

    /// The conic of body `c` about the centre of mass of what lies inside its orbit; `gm` is that of all of it and of itself.
    fn track_of(&self, orbits: &[Orbit], c: usize, gm: f64) -> Track {
        let parent = self.nodes[c].parent.unwrap_or_default();
        let relative = match &orbits[c].path {
            Path::Mean(orbit) => return precessing(orbit),
            Path::FromParent { state, epoch } => add((state.position.0, state.velocity.0), self.centre_of_mass(c, *epoch), 1.0),
            Path::Barycentric { state, epoch, of_system } => {
                let own = (state.position.0, state.velocity.0);
                let own = if *of_system { own } else { add(own, self.centre_of_mass(c, *epoch), 1.0) };
                add(own, self.given_state(orbits, parent, *epoch), -1.0)
            }
        };
        let inside = self.chain(parent, self.nodes[c].rank, epoch_of(&orbits[c].path));
        let (r, v) = add(relative, inside, -1.0);
        Track::Conic(Conic::new(gm, r, v))
    }

    /// Barycentric state of a body as its path gives it (only needed at the epoch).
    fn given_state(&self, orbits: &[Orbit], body: usize, t: SimTime) -> Pair {
        match &orbits[body].path {
            Path::Barycentric { state, of_system, .. } => {
                let own = (state.position.0, state.velocity.0);
                if *of_system { add(own, self.centre_of_mass(body, t), -1.0) } else { own }
            }
            Path::FromParent { state, .. } => {
                let own = (state.position.0, state.velocity.0);
                self.nodes[body].parent.map_or(own, |p| add(own, self.given_state(orbits, p, t), 1.0))
            }
            Path::Mean(_) => {
                let own = self.nodes[body].track.at(t.since(self.nodes[body].epoch));
                self.nodes[body].parent.map_or(own, |p| add(own, self.given_state(orbits, p, t), 1.0))
            }
        }
    }

    /// Centre of mass of a body and its first `count` children, from the body.
    fn chain(&self, body: usize, count: usize, t: SimTime) -> Pair {
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for c in self.nodes[body].children.iter().take(count) {
            sum = add(sum, self.step(*c, t), self.nodes[*c].share);
        }
        sum
    }

    fn centre_of_mass(&self, body: usize, t: SimTime) -> Pair {
        self.chain(body, self.nodes[body].children.len(), t)
    }

    /// A body's system from the centre of mass of what lies inside its orbit.
    fn step(&self, body: usize, t: SimTime) -> Pair {
        self.nodes[body].track.at(t.since(self.nodes[body].epoch))
    }

    /// A body from its parent's centre.
    fn about_parent(&self, body: usize, t: SimTime) -> Pair {
        let node = &self.nodes[body];
        let inside = node.parent.map_or((DVec3::ZERO, DVec3::ZERO), |p| self.chain(p, node.rank, t));
        let system = add(self.step(body, t), inside, 1.0);
        add(system, self.centre_of_mass(body, t), -1.0)
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// True for the default value, which has no body.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Barycentric state of `body` at `t`, ICRF axes, m and m/s. A handle of another system gives the origin.
    pub fn state(&self, body: BodyId, t: SimTime) -> State<Icrf> {
        if body.index() >= self.nodes.len() {
            return State::default();
        }
        wrap(self.up(body.index(), t, None))
    }

    /// State of `body` from the centre of `center`, ICRF axes: cheaper than a difference of two [`Ephemeris::state`]s, and
    /// with all its digits, since only what lies between the two is summed.
    pub fn relative(&self, body: BodyId, center: BodyId, t: SimTime) -> State<Icrf> {
        let (a, b) = (body.index(), center.index());
        if a >= self.nodes.len() || b >= self.nodes.len() || a == b {
            return State::default();
        }
        let common = self.common(a, b);
        wrap(add(self.up(a, t, Some(common)), self.up(b, t, Some(common)), -1.0))
    }

    /// States of all bodies at `t`, in their order, into `out` (its memory is used again): each conic is solved once.
    pub fn states_into(&self, t: SimTime, out: &mut Vec<State<Icrf>>) {
        out.clear();
        let steps: Vec<Pair> = (0..self.nodes.len()).map(|i| self.step(i, t)).collect();
        let centre = |i: usize, count: usize| {
            let list = self.nodes[i].children.iter().take(count);
            list.fold((DVec3::ZERO, DVec3::ZERO), |sum, c| add(sum, steps[*c], self.nodes[*c].share))
        };
        for (i, node) in self.nodes.iter().enumerate() {
            let own = add(steps[i], centre(i, node.children.len()), -1.0);
            let full = match node.parent {
                None => own,
                // Parents stand before children.
                Some(p) => {
                    let inside = centre(p, node.rank);
                    let base: Pair = out.get(p).map_or((DVec3::ZERO, DVec3::ZERO), |s: &State<Icrf>| (s.position.0, s.velocity.0));
                    add(add(own, inside, 1.0), base, 1.0)
                }
            };
            out.push(wrap(full));
        }
    }

    /// Bounds on where a body can be, seen from its parent.
    pub fn reach(&self, body: BodyId) -> Reach {
        self.nodes.get(body.index()).map_or(Reach::default(), |n| n.reach)
    }

    /// Sum of the steps from `body` up to an ancestor (or to the barycentre).
    fn up(&self, body: usize, t: SimTime, stop: Option<usize>) -> Pair {
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        let mut at = body;
        while Some(at) != stop {
            sum = add(sum, self.about_parent(at, t), 1.0);
            match self.nodes[at].parent {
                Some(p) => at = p,
                None => break,
            }
        }
        sum
    }

    /// Lowest common ancestor.
    fn common(&self, a: usize, b: usize) -> usize {
        let (mut a, mut b) = (a, b);
        // Parents have lower indices: move the higher one up until they meet.
        while a != b {
            if a > b {
                a = self.nodes[a].parent.unwrap_or_default();
            } else {
                b = self.nodes[b].parent.unwrap_or_default();
            }
        }
        a
    }
}

fn wrap((r, v): Pair) -> State<Icrf> {
    State { position: Position::new(r), velocity: Velocity::new(v) }
}

fn epoch_of(path: &Path) -> SimTime {
    match path {
        Path::Barycentric { epoch, .. } | Path::FromParent { epoch, .. } => *epoch,
        Path::Mean(orbit) => orbit.epoch,
    }
}

/// A size to order siblings by: semi-major axis, or distance at the epoch.
fn size(orbits: &[Orbit], i: usize) -> f64 {
    let from = |body: usize| match &orbits[body].path {
        Path::Barycentric { state, .. } => state.position.0,
        _ => DVec3::ZERO,
    };
    match &orbits[i].path {
        Path::Mean(orbit) => orbit.semi_major_m,
        Path::FromParent { state, .. } => state.position.length(),
        Path::Barycentric { state, .. } => (state.position.0 - orbits[i].parent.map_or(DVec3::ZERO, |p| from(p.index()))).length(),
    }
}

fn precessing(orbit: &MeanOrbit) -> Track {
    let anomalistic = orbit.mean_longitude_rate_rad_s - orbit.node_rad[1] - orbit.argument_rad[1];
    let a = orbit.semi_major_m;
    // The GM that gives this anomalistic motion at this size: mean elements carry J₂ and their siblings in it.
    let gm = anomalistic * anomalistic * a * a * a;
    let start = Elements {
        gm_m3_s2: gm,
        periapsis_m: a * (1.0 - orbit.eccentricity),
        eccentricity: orbit.eccentricity,
        inverse_semi_major_per_m: 1.0 / a,
        ..Elements::default()
    };
    let at = start.to_state::<Icrf>();
    let [ra, dec] = orbit.pole_ra_dec_rad;
    Track::Precessing {
        conic: Conic::new(gm, at.position.0, at.velocity.0),
        since_periapsis_s: orbit.mean_anomaly_rad / anomalistic,
        orbit: *orbit,
        icrf_from_plane: about(DVec3::Z, ra + FRAC_PI_2) * about(DVec3::X, FRAC_PI_2 - dec),
    }
}

/// The shell of a conic with a margin of 1 % for what its chain and its moons shift.
fn reach_of(node: &Node, gm: f64) -> Reach {
    let (r, v) = node.track.at(0.0);
    let gm = if let Track::Precessing { conic, .. } = &node.track { conic.gm() } else { gm };
    let elements = Elements::from_state(gm, &wrap((r, v)));
    Reach { nearest_m: 0.99 * elements.periapsis_m, farthest_m: 1.01 * elements.apoapsis_m(), fastest_m_s: 1.01 * elements.fastest_m_s() }
}

fn check(orbits: &[Orbit]) -> Result<(), EphemerisError> {
    if orbits.is_empty() || orbits.len() > usize::from(u16::MAX) {
        return Err(EphemerisError::Count(orbits.len()));
    }
    for (i, o) in orbits.iter().enumerate() {
        let bad = |what| Err(EphemerisError::Value { body: i, what });
        match o.parent {
            None if i > 0 => return Err(EphemerisError::Root(i)),
            Some(_) if i == 0 => return Err(EphemerisError::Root(i)),
            Some(p) if p.index() >= i => return Err(EphemerisError::Order(i)),
            _ => {}
        }
        if !(o.gm_m3_s2.is_finite() && o.gm_m3_s2 > 0.0) {
            return bad("GM must be finite and above 0");
        }
        match &o.path {
            Path::Barycentric { state, .. } | Path::FromParent { state, .. } => {
                if !(state.position.is_finite() && state.velocity.is_finite()) {
                    return bad("position and velocity must be finite");
                }
            }
            Path::Mean(m) => {
                let numbers = [m.inclination_rad, m.mean_anomaly_rad, m.mean_longitude_rate_rad_s];
                let pairs = [m.node_rad, m.argument_rad, m.pole_ra_dec_rad];
                if !(numbers.iter().chain(pairs.iter().flatten()).all(|x| x.is_finite())) {
                    return bad("elements must be finite");
                }
                if !(m.semi_major_m.is_finite() && m.semi_major_m > 0.0 && (0.0..1.0).contains(&m.eccentricity)) {
                    return bad("mean elements need a semi-major axis above 0 and an eccentricity from 0 to below 1");
                }
                if m.mean_longitude_rate_rad_s - m.node_rad[1] - m.argument_rad[1] == 0.0 {
                    return bad("the mean anomaly must move");
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
