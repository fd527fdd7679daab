//! Field: which terms of gravity count for a ship about its host body, by an error bound and not by a list.
//!
//! A term that is left out is an acceleration error `a`. Held along the track for a span `T`, it moves the ship by at most
//! `(3/2) a T²` (the secular along-track drift of a near-circular orbit under a constant tangential acceleration
//! [Vallado 2013, §9.7], three times the drift of a free point). So a term counts where its greatest possible size exceeds
//! `a_min = (2/3) ε / T²` for the error ε that is allowed over T. Every bound is a monotonic function of the distance from the
//! host alone, taken over all places that the bodies may be in: what counts is a pure function of that distance, the same at
//! every warp, and no body is asked for its place in order to learn that it does not matter.
//!
//! Far moons are one with their planet: a moon's GM acts from the planet's centre while what that moves the ship, a dipole that
//! turns with the moon, stays below the same bound. So a ship between the planets feels Jupiter with its moons as one body,
//! and its steps are not cut to theirs.
//!
//! Not here: the accelerations themselves ([`super::gravity`], [`super::path::recurrence`]), the path ([`super::path`]).
//!
//! - [Vallado 2013] "Fundamentals of Astrodynamics and Applications", 4th ed.
//! - [Montenbruck & Gill 2000] "Satellite Orbits", §3.2 (zonal harmonics), §3.7 (relativity).

use super::BodyId;
use crate::units::DAY;

/// Speed of light, m/s (exact).
const LIGHT_M_S: f64 = 299_792_458.0;

/// What error may be made by leaving terms out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Displacement allowed, m.
    pub position_m: f64,
    /// Over this span, s.
    pub over_s: f64,
}

impl Bound {
    /// A decimetre in thirty days: a tenth of what a coast through Earth–Moon space may be off.
    pub const COAST: Self = Self { position_m: 0.1, over_s: 30.0 * DAY };

    /// The smallest acceleration that counts, m/s².
    pub fn least_m_s2(&self) -> f64 {
        self.position_m / (1.5 * self.over_s * self.over_s)
    }
}

/// Where a child body can be, seen from its parent: the shell that its path stays in, and its greatest speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// Least distance from the parent, m.
    pub nearest_m: f64,
    /// Greatest distance from the parent, m.
    pub farthest_m: f64,
    /// Greatest speed relative to the parent, m/s.
    pub fastest_m_s: f64,
}

/// A body as a source of gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Source {
    /// What it orbits.
    pub parent: Option<BodyId>,
    /// Bounds on its place, seen from the parent.
    pub reach: Reach,
    /// Gravitational parameter, m³/s².
    pub gm_m3_s2: f64,
    /// Radius that the zonal coefficients belong to, m.
    pub reference_radius_m: f64,
    /// J₂, J₃, J₄, unnormalised.
    pub zonal: [f64; 3],
}

/// A body whose tide may count.
#[derive(Clone, Debug, PartialEq)]
pub struct Perturber {
    /// Which.
    pub body: BodyId,
    /// Its gravitational parameter, m³/s².
    pub gm_m3_s2: f64,
    /// Its tide counts from this distance (of the ship from the host) on, m.
    pub from_m: f64,
    /// Its moons that act from its centre: up to which distance of the ship, m (beyond, they count by themselves), and their
    /// GM, m³/s².
    pub moons: Vec<(f64, f64)>,
}

impl Perturber {
    /// GM of the body and of the moons that act from its centre while the ship is no farther than `highest_m`, m³/s².
    pub fn gm_with_moons(&self, highest_m: f64) -> f64 {
        self.moons.iter().filter(|m| m.0 > highest_m).fold(self.gm_m3_s2, |sum, m| sum + m.1)
    }
}

/// What counts about one host, by distance from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The host.
    pub host: BodyId,
    /// The host as a source.
    pub source: Source,
    /// Bodies whose tides may count, the strongest first.
    pub perturbers: Vec<Perturber>,
    /// J₂, J₃, J₄ count up to these distances, m.
    pub zonal_within_m: [f64; 3],
    /// The host's 1PN term counts up to this distance, m.
    pub relativity_within_m: f64,
}

/// The terms in force at one distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    /// How many of [`Field::perturbers`], from the first on.
    pub perturbers: usize,
    /// How many of J₂, J₃, J₄.
    pub zonal: usize,
    /// The host's 1PN term.
    pub relativity: bool,
}

impl Field {
    /// What counts about `host` under `bound`. `sources` lists the system's bodies in its order.
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(sources: &[Source], host: BodyId, bound: Bound) -> Self {
        let least = bound.least_m_s2();
        let source = sources.get(host.index()).copied().unwrap_or_default();
        let ids = (0..sources.len()).map(|i| BodyId(i as u16)).filter(|&body| body != host);
        let counts = |body: BodyId| tide_counts_from(sources[body.index()].gm_m3_s2, nearest_m(sources, body, host), least);
        let mut perturbers = Vec::new();
        let mut moons = Vec::new();
        for body in ids {
            let gm_m3_s2 = sources[body.index()].gm_m3_s2;
            let mut from_m = counts(body);
            let planet = sources[body.index()].parent.filter(|&p| !is_within(sources, host, p) && counts(p) <= from_m);
            if let Some(planet) = planet {
                from_m = from_m.max(apart_from(&sources[body.index()], nearest_m(sources, planet, host), bound));
                moons.push((planet, (from_m, gm_m3_s2)));
            }
            if from_m.is_finite() {
                perturbers.push(Perturber { body, gm_m3_s2, from_m, moons: Vec::new() });
            }
        }
        for (planet, moon) in moons {
            if let Some(p) = perturbers.iter_mut().find(|p| p.body == planet) {
                p.moons.push(moon);
            }
        }
        perturbers.sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
        let zonal_within_m = core::array::from_fn(|k| zonal_counts_within(&source, k, least));
        Self { host, source, perturbers, zonal_within_m, relativity_within_m: relativity_counts_within(source.gm_m3_s2, least) }
    }

    /// The terms that count while the ship is between `lowest_m` and `highest_m` from the host.
    pub fn terms(&self, lowest_m: f64, highest_m: f64) -> Terms {
        Terms {
            perturbers: self.perturbers.partition_point(|p| p.from_m <= highest_m),
            // A higher degree may outweigh a lower one (a sphere with a J₄ alone): all up to the last that counts.
            zonal: self.zonal_within_m.iter().rposition(|&r| r >= lowest_m).map_or(0, |k| k + 1),
            relativity: lowest_m <= self.relativity_within_m,
        }
    }
}

/// True where `body` is `of` or moves about it.
fn is_within(sources: &[Source], mut body: BodyId, of: BodyId) -> bool {
    while body != of {
        match sources.get(body.index()).and_then(|s| s.parent) {
            Some(parent) => body = parent,
            None => return false,
        }
    }
    true
}

/// Distance of the ship from its host from which on a moon may not act from the centre of its planet, which never comes nearer
/// than `nearest_m` to the host. With the moon at most a from the planet, turning at ω or faster, and d from the ship, the
/// dipole 2 GM a/d³ leaves at most a velocity of that over ω; the mean place of an ellipse, 3/2 e a off, and the quadrupole
/// 3 GM a²/d⁴ do not turn.
fn apart_from(moon: &Source, nearest_m: f64, bound: Bound) -> f64 {
    let least = bound.least_m_s2();
    let Reach { nearest_m: low, farthest_m: a, fastest_m_s } = moon.reach;
    if least <= 0.0 || a <= 0.0 {
        return 0.0;
    }
    let slowest_rad_s = low * fastest_m_s / (a * a);
    let eccentricity = (a - low) / (a + low);
    let dipole = 2.0 * moon.gm_m3_s2 * a * bound.over_s / (slowest_rad_s.max(f64::MIN_POSITIVE) * bound.position_m);
    let mean = 3.0 * moon.gm_m3_s2 * eccentricity * a / least;
    let quadrupole = (3.0 * moon.gm_m3_s2 * a * a / least).sqrt().sqrt();
    (nearest_m - libm::cbrt(dipole.max(mean)).max(quadrupole)).max(0.0)
}

/// A lower bound on the distance of two bodies, m, from the shells that their paths stay in.
pub fn nearest_m(sources: &[Source], a: BodyId, b: BodyId) -> f64 {
    let chain = |mut id: BodyId| {
        let mut list = vec![id];
        while let Some(parent) = sources.get(id.index()).and_then(|s| s.parent) {
            id = parent;
            list.push(id);
        }
        list
    };
    let (of_a, of_b) = (chain(a), chain(b));
    // Least and greatest distance from the lowest common ancestor: the last link below it, give or take those above.
    let shell = |own: &[BodyId], other: &[BodyId]| {
        own.iter().take_while(|id| !other.contains(id)).fold((0.0_f64, 0.0_f64), |(_, far), id| {
            let reach = sources[id.index()].reach;
            ((reach.nearest_m - far).max(0.0), far + reach.farthest_m)
        })
    };
    let ((near_a, far_a), (near_b, far_b)) = (shell(&of_a, &of_b), shell(&of_b, &of_a));
    (near_a - far_b).max(near_b - far_a).max(0.0)
}

/// Distance from the host from which on the tide of a body never nearer than `nearest_m` may exceed `least`.
/// |tide| ≤ GM (1/(d − r)² − 1/d²), which grows with r; it counts at once where the ship may come to the body.
fn tide_counts_from(gm: f64, nearest_m: f64, least: f64) -> f64 {
    if gm <= 0.0 || least <= 0.0 {
        return if gm > 0.0 { 0.0 } else { f64::INFINITY };
    }
    let d = nearest_m.max(0.0);
    if d == 0.0 {
        return 0.0;
    }
    // GM/(d−r)² = least + GM/d²  ⇒  r = d − d/√(1 + least d²/GM), written without the cancellation.
    let x = least * d * d / gm;
    let root = (1.0 + x).sqrt();
    d * x / (root * (1.0 + root))
}

/// Distance up to which J_{k+2} may exceed `least`: |a| ≤ ½(n+1)(n+2) GM |Jₙ| Rⁿ / r^{n+2}: |Pₙ| ≤ 1 bounds the
/// radial part by n + 1, |Pₙ′| ≤ n(n+1)/2 the part along the meridian, and the sum of both is at most their number together.
fn zonal_counts_within(source: &Source, k: usize, least: f64) -> f64 {
    let n = k as f64 + 2.0;
    let size = 0.5 * (n + 1.0) * (n + 2.0) * source.gm_m3_s2 * source.zonal[k].abs() * libm::pow(source.reference_radius_m, n);
    if size <= 0.0 { 0.0 } else { libm::pow(size / least, 1.0 / (n + 2.0)) }
}

/// Distance up to which the Schwarzschild term may exceed `least`: |a| ≤ (GM/c²r²)(4GM/r + 5v²) with v² ≤ 2GM/r on a bound
/// path: 14 (GM)²/(c² r³).
fn relativity_counts_within(gm: f64, least: f64) -> f64 {
    libm::cbrt(14.0 * gm * gm / (LIGHT_M_S * LIGHT_M_S * least))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{AU, KM};

    fn source(parent: Option<u16>, gm: f64, near: f64, far: f64) -> Source {
        let reach = Reach { nearest_m: near, farthest_m: far, fastest_m_s: 0.0 };
        Source { parent: parent.map(BodyId), reach, gm_m3_s2: gm, ..Source::default() }
    }

    /// Sun, Earth, Moon, Jupiter, a moon of Jupiter's, Neptune.
    fn sol() -> Vec<Source> {
        let mut list = vec![
            source(None, 1.327_124_4e20, 0.0, 0.0),
            source(Some(0), 3.986_004e14, 0.983 * AU, 1.017 * AU),
            source(Some(1), 4.902_8e12, 3.56e8, 4.07e8),
            source(Some(0), 1.267_127e17, 4.95 * AU, 5.46 * AU),
            source(Some(3), 9.887e12, 1.069e9, 1.071e9),
            source(Some(0), 6.836_5e15, 29.8 * AU, 30.4 * AU),
        ];
        list[1].zonal = [1.082_626e-3, -2.532e-6, -1.619e-6];
        list[1].reference_radius_m = 6_378.136_3 * KM;
        list
    }

    #[test]
    fn the_nearest_two_bodies_come_is_bounded_from_below() {
        let list = sol();
        let near = |a, b| nearest_m(&list, BodyId(a), BodyId(b));
        assert_eq!(near(2, 1), 3.56e8);
        assert_eq!(near(1, 2), 3.56e8, "the same both ways");
        assert!((near(3, 1) / AU - (4.95 - 1.017)).abs() < 1e-9);
        assert!((near(4, 2) - ((4.95 * AU - 1.071e9) - (1.017 * AU + 4.07e8))).abs() < 1.0);
        assert!((near(0, 2) - (0.983 * AU - 4.07e8)).abs() < 1.0);
    }

    #[test]
    fn a_low_orbit_of_the_earth_feels_moon_and_sun_but_not_neptune() {
        let field = Field::new(&sol(), BodyId(1), Bound::COAST);
        let terms = field.terms(6_778.0 * KM, 6_779.0 * KM);
        let bodies: Vec<u16> = field.perturbers[..terms.perturbers].iter().map(|p| p.body.0).collect();
        assert_eq!(bodies, [2, 0, 3], "Moon, Sun, Jupiter");
        assert_eq!((terms.zonal, terms.relativity), (3, true));
        let far = field.terms(8.0e8, 8.1e8);
        assert!(far.zonal < 3 && far.perturbers >= 3, "{far:?}");
    }

    #[test]
    fn what_is_left_out_stays_below_the_bound_and_not_far_below() {
        // At the very distance from which a tide counts, its greatest size is the least that counts.
        let (gm, d, least) = (1.267e17, 3.9 * AU, 1e-15);
        let r = tide_counts_from(gm, d, least);
        let tide = gm * (r * (2.0 * d - r)) / ((d - r) * (d - r) * d * d);
        assert!((tide / least - 1.0).abs() < 1e-9, "{tide}");
        assert_eq!(tide_counts_from(gm, 0.0, least), 0.0, "a body that may be met always counts");
        assert_eq!(tide_counts_from(0.0, d, least), f64::INFINITY, "a body without mass never does");
        // J₂ of the Earth: at the distance found the bound is met within the slack of the inequality.
        let earth = sol()[1];
        let r = zonal_counts_within(&earth, 0, least);
        let at_pole = 3.0 * earth.gm_m3_s2 * earth.zonal[0] * earth.reference_radius_m * earth.reference_radius_m / (r * r * r * r);
        assert!((0.45..=1.0).contains(&(at_pole / least)), "{}", at_pole / least);
        let r = relativity_counts_within(earth.gm_m3_s2, least);
        let circular = 3.0 * earth.gm_m3_s2 * earth.gm_m3_s2 / (LIGHT_M_S * LIGHT_M_S * r * r * r);
        assert!((0.2..=1.0).contains(&(circular / least)), "{}", circular / least);
    }

    #[test]
    fn no_error_allowed_means_that_everything_counts() {
        let field = Field::new(&sol(), BodyId(1), Bound { position_m: 0.0, over_s: 1.0 });
        let terms = field.terms(1e7, 1e7);
        assert_eq!((terms.perturbers, terms.zonal, terms.relativity), (5, 3, true));
    }
}
