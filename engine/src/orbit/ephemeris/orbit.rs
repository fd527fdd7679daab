//! What a system is built from: bodies, how the path of each is given, and what is wrong with a list that is no system.

use crate::orbit::gravity::figure::Figure;
use crate::orbit::{BodyId, State};
use crate::space::Icrf;
use crate::time::SimTime;

/// How the path of a body is given: where it starts. From there on gravity decides.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// A state at an epoch from the solar-system barycentre, ICRF axes: of the body itself, or of the centre of mass of the
    /// body and its moons (as planetary ephemerides give it for the outer planets).
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

impl Path {
    /// When the path is given.
    pub fn epoch(&self) -> SimTime {
        match self {
            Self::Barycentric { epoch, .. } | Self::FromParent { epoch, .. } => *epoch,
            Self::Mean(orbit) => orbit.epoch,
        }
    }
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

/// What makes a system more than points that are listed. Lists may be empty or shorter than that of the bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Details {
    /// Figures of the bodies.
    pub figures: Vec<Option<Figure>>,
    /// GM of a body with all its moons, also those that are not listed, m³/s²; else the sum of those that are.
    pub family_gm_m3_s2: Vec<Option<f64>>,
    /// Masses that attract and are no bodies of the system: asteroids.
    pub masses: Vec<Mass>,
}

/// A mass that goes round the root unseen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    /// Gravitational parameter, m³/s².
    pub gm_m3_s2: f64,
    /// State from the barycentre at the root's epoch.
    pub state: State<Icrf>,
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
    /// Two bodies stand at one place, where their attraction has no value.
    #[error("bodies {0} and {1} are at the same place: their attraction has no value there")]
    Same(usize, usize),
    /// Mean elements whose size and motion belong to different masses.
    #[error("body {body}: its mean motion belongs to a semi-major axis of {kepler_m:e} m, not {given_m:e} m")]
    Pace {
        /// Which body.
        body: usize,
        /// The semi-major axis as given.
        given_m: f64,
        /// The one that the mean motion and the parent's gravity give.
        kepler_m: f64,
    },
}

/// Checks what can be checked body by body. Masses count on from the bodies.
///
/// # Errors
/// The first thing that is wrong.
pub fn check(orbits: &[Orbit], details: &Details) -> Result<(), EphemerisError> {
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
            Path::Barycentric { state, epoch, .. } => {
                if !(state.position.is_finite() && state.velocity.is_finite()) {
                    return bad("position and velocity must be finite");
                }
                let with_parent = |p: BodyId| match &orbits[p.index()].path {
                    Path::Barycentric { epoch: of_parent, .. } => epoch == of_parent,
                    Path::FromParent { epoch: of_parent, .. } => p.index() == 0 && epoch == of_parent,
                    Path::Mean(_) => false,
                };
                if !o.parent.is_none_or(with_parent) {
                    return bad("a state from the barycentre needs a parent that is given from there too, at the same epoch");
                }
            }
            Path::FromParent { state, .. } => {
                if !(state.position.is_finite() && state.velocity.is_finite()) {
                    return bad("position and velocity must be finite");
                }
            }
            Path::Mean(_) if i == 0 => return bad("the root needs a state, not elements"),
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
    for (i, family) in details.family_gm_m3_s2.iter().enumerate().take(orbits.len()) {
        if !family.is_none_or(|gm| gm.is_finite() && gm >= orbits[i].gm_m3_s2) {
            return Err(EphemerisError::Value { body: i, what: "GM with moons must be finite and not below that without" });
        }
    }
    for (k, m) in details.masses.iter().enumerate() {
        if !(m.gm_m3_s2.is_finite() && m.gm_m3_s2 > 0.0 && m.state.position.is_finite() && m.state.velocity.is_finite()) {
            return Err(EphemerisError::Value { body: orbits.len() + k, what: "GM must be above 0, and GM, position and velocity finite" });
        }
    }
    Ok(())
}
