//! Model: the bodies of a system as a coasting ship meets them: gravity, spheres of influence, ground and air.
//!
//! Built once for a system and shared by all paths. Not here: where the bodies are ([`Places`] says what is asked of an
//! ephemeris), how a path moves ([`super::step`]).

use crate::orbit::field::{Bound, Field, Source};
use crate::orbit::rotation::Spin;
use crate::orbit::{BodyId, State};
use crate::space::Icrf;
use crate::time::Moment;
use glam::DVec3;

/// What a path asks of an ephemeris. Answers are the same for the same question, whoever asks first.
pub trait Places: Sync {
    /// State of `body` from the centre of `center`, ICRF axes, m and m/s.
    fn relative_at(&self, body: BodyId, center: BodyId, at: Moment) -> State<Icrf>;

    /// Taylor coefficients about `at` of the position of `body` from `center` into `out`, m/s^k. Returns for how many seconds
    /// from then on (above 0) they are the ephemeris.
    fn series(&self, body: BodyId, center: BodyId, at: Moment, out: &mut [DVec3]) -> f64;
}

/// A body as a ship meets it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// Its gravity.
    pub source: Source,
    /// Its pole (and prime meridian).
    pub spin: Spin,
    /// Radius of the sphere of influence, m; infinite for the star.
    pub soi_m: f64,
    /// Distance from the centre under which a path is not followed (it ends there, going down), m.
    pub low_m: f64,
    /// Radius of the datum, m.
    pub radius_m: f64,
    /// Radius of the top of the air, m; 0 without air.
    pub air_top_m: f64,
}

/// A sphere of influence is left a hundredth farther out than it is entered, so that rounding sends no ship to and fro.
pub const LEAVE: f64 = 1.01;

/// A system's bodies, and what counts about each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    bodies: Vec<Body>,
    fields: Vec<Field>,
    children: Vec<Vec<BodyId>>,
}

impl Model {
    /// The bodies in the system's order, and the error that leaving terms out may make.
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(bodies: Vec<Body>, bound: Bound) -> Self {
        let sources: Vec<Source> = bodies.iter().map(|b| b.source).collect();
        let ids = || (0..bodies.len()).map(|i| BodyId(i as u16));
        let fields = ids().map(|id| Field::new(&sources, id, bound)).collect();
        let children = ids().map(|host| ids().filter(|c| bodies[c.index()].source.parent == Some(host)).collect()).collect();
        Self { bodies, fields, children }
    }

    /// The same bodies under another bound.
    pub fn bounded(&self, bound: Bound) -> Self {
        Self::new(self.bodies.clone(), bound)
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// True without bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// A body; none for a handle of another system.
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.bodies.get(id.index())
    }

    /// What counts about a host.
    pub fn field(&self, host: BodyId) -> Option<&Field> {
        self.fields.get(host.index())
    }

    /// Bodies that move about `host`.
    pub fn children(&self, host: BodyId) -> &[BodyId] {
        self.children.get(host.index()).map_or(&[], Vec::as_slice)
    }

    /// Unit vector of a body's pole at `at`, ICRF axes, and its rate, 1/s: good to 1e-11 rad over a step of hours (what the
    /// fastest term of nutation bends in it).
    pub fn pole(&self, id: BodyId, at: Moment) -> [DVec3; 2] {
        const APART_TICKS: i64 = 65_536;
        let Some(body) = self.body(id) else { return [DVec3::Z, DVec3::ZERO] };
        let pole = body.spin.icrf_from_fixed(at.tick).raw(DVec3::Z);
        let later = at.tick.plus(APART_TICKS);
        [pole, (body.spin.icrf_from_fixed(later).raw(DVec3::Z) - pole) / later.since(at.tick)]
    }
}
