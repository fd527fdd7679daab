//! Step: one natural step of a coasting path. The polynomial that it consists of is the path: whoever wants to know where
//! the ship is samples it, and nobody's asking changes it.
//!
//! A step follows from its [`Knot`] alone: which terms count (by the range of distances that it stays in), how long it is, and
//! how it ends. Its state is kept to two words and its first term h v is added to two words. In what follows from the forces no
//! rounded constant (1/6, t³) multiplies what is nearly the same in each step: such errors add up instead of averaging out
//! (a thousand revolutions in a low orbit: 8 mm with them, 0.2 mm without). Steps end at whole ticks where they are long enough.
//! Not here: the coefficients ([`super::recurrence`]), following a path ([`super::Path`]).
//! - [Jorba & Zou 2005] "A software package for the numerical integration of ODEs by means of high-order Taylor methods",
//!   Experimental Mathematics 14, 99, §3.2 (step from the last two terms).

use super::knot::Knot;
use super::model::{LEAVE, Model, Places};
use super::recurrence::{self, Forces, Third, Thrust};
use super::roots;
use super::series::{LEN, ORDER, Scalar, Vector, index, value};
use super::twofold::Twofold;
use crate::orbit::field::Field;
use crate::orbit::integrate::series::norm_squared as square;
use crate::orbit::{BodyId, State};
use crate::space::Centred;
use crate::time::{Moment, SimTime, TICK_S};
use glam::DVec3;

/// Size of the last two terms, of the distance from the host.
const TOLERANCE: f64 = 8.7e-19;
/// Longest step in its own unit of time.
const LONGEST: f64 = 8.0;
/// r² stays within this part of its start over a step, …
const SWING: f64 = 0.75;
/// … so r stays between these multiples of its start.
const RANGE: (f64, f64) = (0.5, 1.323);
/// Terms from this one on are summed to one word.
const EXACT: usize = 6;
/// Steps of at least so many ticks end on one.
const WHOLE_TICKS: f64 = 8.0;

/// How a step ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The path goes on with the next step.
    Natural,
    /// The path comes under the height to which it is followed.
    Low,
    /// It leaves its host's sphere of influence: it goes on about the host's parent.
    Leave,
    /// It enters that of a child: it goes on about that.
    Enter(BodyId),
}

/// What the ship adds to its path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setting {
    /// What light takes off the star's pull on the ship, m³/s²: C_R A/m × irradiance × distance² / c.
    pub light_m3_s2: f64,
    /// Thrust at the start of the step.
    pub thrust: Option<Thrust>,
    /// The path is followed down to the datum, not to the height from which on a ship is flown.
    pub to_ground: bool,
}

/// The squared distance from another body over a part of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Where the part begins, in steps.
    pub from: f64,
    /// Where it ends, in steps.
    pub to: f64,
    /// The polynomial over the part (0 … 1), m².
    pub squared: Scalar,
}

/// One step.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Where it begins.
    pub knot: Knot,
    /// Where it ends.
    pub until: Moment,
    /// How.
    pub end: End,
    /// Unit of time of the polynomials, s: a power of two.
    unit_s: f64,
    /// Position in powers of time.
    x: Vector,
    /// Its square.
    r_squared: Scalar,
}

/// The power of two at or below a time, s.
fn unit_below(s: f64) -> f64 {
    libm::ldexp(1.0, libm::ilogb(s.clamp(1e-12, 1e12)))
}

impl Step {
    /// The step that begins at `knot`.
    pub fn new(model: &Model, places: &dyn Places, knot: Knot, setting: &Setting) -> Self {
        let (r, v) = (knot.position.high, knot.velocity.high);
        let distance = r.length();
        let field = model.field(knot.host);
        let gm = field.map_or(0.0, |f| f.source.gm_m3_s2);
        let fall_s = (distance * distance * distance / gm).sqrt();
        let burn_s = setting.thrust.map_or(f64::INFINITY, |t| 1.0 / t.growth_per_s.abs());
        let unit_s = unit_below(fall_s.min(distance / v.length()).min(burn_s));
        let mut x = [DVec3::ZERO; LEN];
        (x[0], x[1]) = (r, v * unit_s);
        let mut r_squared = [0.0; LEN];
        let (mut forces, bodies, valid_s) = match field {
            Some(field) => forces(model, places, field, &knot, unit_s, setting.light_m3_s2),
            None => (Forces::default(), Vec::new(), f64::INFINITY),
        };
        forces.thrust = setting.thrust;
        recurrence::coefficients(&mut forces, unit_s, &mut x, &mut r_squared);
        if !x.iter().all(|c| c.is_finite()) {
            // The very centre: nothing can be said but that it goes on.
            x[2..].fill(DVec3::ZERO);
            for (k, s) in r_squared.iter_mut().enumerate() {
                *s = square(&x, k);
            }
        }
        // Of a/(1 − growth t) the last term is then below 1e-22 of the first, however far out the ship is.
        let span = natural(&x, &r_squared).min(valid_s.min(0.1 * burn_s) / unit_s);
        let until = ending(knot.at, span * unit_s);
        let mut step = Self { knot, until, end: End::Natural, unit_s, x, r_squared };
        if let Some(body) = model.body(knot.host) {
            step.look(model, places, if setting.to_ground { body.radius_m } else { body.low_m }, &forces.thirds, &bodies);
        }
        step
    }

    /// Finds what ends the step before its natural end.
    fn look(&mut self, model: &Model, places: &dyn Places, low_m: f64, thirds: &[Third], bodies: &[BodyId]) {
        let Some(host) = model.body(self.knot.host) else { return };
        let span = self.units();
        let r2 = self.radius_squared();
        let mut first = (f64::INFINITY, End::Natural);
        let mut meet = |at: Option<f64>, end: End| {
            if let Some(at) = at.filter(|t| *t < first.0) {
                first = (at, end);
            }
        };
        // A ship that climbs out from under it is on its way.
        meet(crossing(&r2, low_m * low_m, false).filter(|t| *t > 0.0 || r2[1] <= 0.0), End::Low);
        if host.soi_m.is_finite() && host.source.parent.is_some() {
            let edge = LEAVE * host.soi_m;
            meet(crossing(&r2, edge * edge, true), End::Leave);
        }
        let here = r2[0].max(0.0).sqrt();
        for &id in model.children(self.knot.host) {
            let Some(child) = model.body(id) else { continue };
            let reach = child.source.reach;
            if here * RANGE.1 < reach.nearest_m - child.soi_m || here * RANGE.0 > reach.farthest_m + child.soi_m {
                continue;
            }
            let edge = child.soi_m * child.soi_m;
            let at = match bodies.iter().position(|b| *b == id) {
                Some(i) => crossing(&roots::over(thirds[i].distance_squared(), span), edge, false),
                None => self.gaps(places, id).find_map(|g| crossing(&g.squared, edge, false).map(|t| g.from + t * (g.to - g.from))),
            };
            meet(at, End::Enter(id));
        }
        if first.1 != End::Natural {
            self.until = self.knot.at.plus_s(first.0 * span * self.unit_s);
            self.end = first.1;
        }
    }

    /// The squared distance from a body over the step, in as many parts as the ephemeris has pieces in it.
    pub fn gaps<'a>(&'a self, places: &'a dyn Places, body: BodyId) -> impl Iterator<Item = Gap> + 'a {
        let span_s = self.span_s();
        let mut from_s = 0.0;
        core::iter::from_fn(move || {
            if from_s >= span_s {
                return None;
            }
            let mut p = [DVec3::ZERO; LEN];
            let valid_s = places.series(body, self.knot.host, self.knot.at.plus_s(from_s), &mut p);
            let to_s = (from_s + valid_s.max(1e-3)).min(span_s);
            rescale(&mut p, self.unit_s);
            let x = shifted(&self.x, from_s / self.unit_s);
            for (p, x) in p.iter_mut().zip(&x) {
                *p -= *x;
            }
            let squared = roots::over(&core::array::from_fn(|k| square(&p, k)), (to_s - from_s) / self.unit_s);
            let gap = Gap { from: from_s / span_s, to: to_s / span_s, squared };
            from_s = to_s;
            Some(gap)
        })
    }

    /// The same step with its end at `at`, if that comes earlier.
    pub fn cut(mut self, at: Moment) -> Self {
        if at.since(self.until) < 0.0 {
            self.until = at;
            self.end = End::Natural;
        }
        self
    }

    /// r² from the host as a polynomial over the step (0 … 1).
    pub fn radius_squared(&self) -> Scalar {
        roots::over(&self.r_squared, self.units())
    }

    /// The component of the position along a direction as a polynomial over the step (0 … 1).
    pub fn along(&self, direction: DVec3) -> Scalar {
        roots::over(&core::array::from_fn(|k| self.x[k].dot(direction)), self.units())
    }

    /// Length in its own units.
    fn units(&self) -> f64 {
        self.span_s() / self.unit_s
    }

    /// Length, s.
    pub fn span_s(&self) -> f64 {
        self.until.since(self.knot.at)
    }

    /// The moment at a fraction of the step.
    pub fn moment(&self, fraction: f64) -> Moment {
        self.knot.at.plus_s(fraction * self.span_s())
    }

    /// True where the step says where the ship is at `t`: its end belongs to the next.
    pub fn covers(&self, t: SimTime) -> bool {
        let t = Moment::from(t);
        t.since(self.knot.at) >= 0.0 && t.since(self.until) < 0.0
    }

    /// The state at a moment of the step.
    pub fn sample(&self, at: impl Into<Moment>) -> State<Centred> {
        self.knot_at(at.into()).state()
    }

    /// A knot inside the step.
    pub fn knot_at(&self, at: Moment) -> Knot {
        let dt = at.since(self.knot.at);
        if dt == 0.0 {
            return self.knot;
        }
        let t = dt / self.unit_s;
        // The great terms to two words, one by one; the rest is small enough for one.
        let mut slope = DVec3::ZERO;
        for k in (EXACT..LEN).rev() {
            slope = slope * t + self.x[k] * index(k);
        }
        let mut position = Twofold::from(value(&self.x, EXACT, t));
        let mut velocity = Twofold::from(slope);
        for k in (2..EXACT).rev() {
            let x = Twofold::from(self.x[k]);
            position = position.times(t).plus(x);
            velocity = velocity.times(t).plus(x.times(index(k)));
        }
        let slow = 1.0 / self.unit_s;
        Knot {
            host: self.knot.host,
            at,
            position: self.knot.position.plus(self.knot.velocity.times(dt)).plus(position.times(t).times(t)),
            velocity: self.knot.velocity.plus(velocity.times(t).times(slow)),
        }
    }

    /// Where the next step begins: about another body where the host changes there.
    pub fn next(&self, model: &Model, places: &dyn Places) -> Knot {
        let knot = self.knot_at(self.until);
        let new = match self.end {
            End::Leave => model.body(self.knot.host).and_then(|b| b.source.parent),
            End::Enter(child) => Some(child),
            End::Natural | End::Low => None,
        };
        new.map_or(knot, |new| {
            let s = places.relative_at(self.knot.host, new, knot.at);
            knot.about(new, (s.position.0, s.velocity.0))
        })
    }
}

/// What acts over a step: the terms, the bodies of its thirds, and for how long their polynomials hold, s.
fn forces(model: &Model, places: &dyn Places, field: &Field, knot: &Knot, unit_s: f64, light_m3_s2: f64) -> (Forces, Vec<BodyId>, f64) {
    let distance = knot.position.high.length();
    let terms = field.terms(RANGE.0 * distance, RANGE.1 * distance);
    let star = BodyId(0);
    let radius = field.source.reference_radius_m;
    let mut scale = field.source.gm_m3_s2 * radius;
    let zonal = core::array::from_fn(|k| {
        scale *= radius;
        if k < terms.zonal { scale * field.source.zonal[k] } else { 0.0 }
    });
    let mut valid_s = f64::INFINITY;
    let mut thirds = Vec::with_capacity(terms.perturbers);
    let mut bodies = Vec::with_capacity(terms.perturbers);
    for p in &field.perturbers[..terms.perturbers] {
        let mut position = [DVec3::ZERO; LEN];
        valid_s = valid_s.min(places.series(p.body, knot.host, knot.at, &mut position));
        if position[0] == DVec3::ZERO {
            // An ephemeris that does not know the body.
            continue;
        }
        rescale(&mut position, unit_s);
        let gm = p.gm_with_moons(RANGE.1 * distance);
        let taken = if p.body == star { light_m3_s2 } else { 0.0 };
        thirds.push(Third::new(gm - taken, gm, position));
        bodies.push(p.body);
    }
    let taken = if knot.host == star { light_m3_s2 } else { 0.0 };
    let pole = if terms.zonal > 0 { model.pole(knot.host, knot.at) } else { [DVec3::ZERO; 2] };
    let gm = field.source.gm_m3_s2 - taken;
    (Forces { gm, zonal, pole, relativity: terms.relativity, thirds, thrust: None }, bodies, valid_s)
}

/// The polynomial in the time since `t` (Taylor's shift by synthetic division).
fn shifted(x: &Vector, t: f64) -> Vector {
    let mut s = *x;
    if t != 0.0 {
        for from in 0..ORDER {
            for k in (from..ORDER).rev() {
                let higher = s[k + 1];
                s[k] += higher * t;
            }
        }
    }
    s
}

/// From powers of seconds to powers of the unit.
fn rescale(p: &mut Vector, unit_s: f64) {
    let mut power = 1.0;
    for c in p {
        *c *= power;
        power *= unit_s;
    }
}

/// Length of the natural step in its unit: the last two terms are below the tolerance [Jorba & Zou 2005, eq. 3-8], and r keeps
/// within the range for which the terms were chosen.
fn natural(x: &Vector, r_squared: &Scalar) -> f64 {
    let size = TOLERANCE * x[0].length();
    let within = |k: usize| {
        let last = x[k].length();
        if last > 0.0 { libm::pow(size / last, 1.0 / index(k)) } else { LONGEST }
    };
    let mut span = within(ORDER).min(within(ORDER - 1)).clamp(0.0, LONGEST);
    let swing = |span: f64| r_squared[1..].iter().rev().fold(0.0, |sum, c| (sum + c.abs()) * span);
    for _ in 0..64 {
        if swing(span) <= SWING * r_squared[0] {
            break;
        }
        span *= 0.85;
    }
    span
}

/// The end of a step of about `span_s`: on a tick where it is long enough.
fn ending(at: Moment, span_s: f64) -> Moment {
    let end = at.plus_s(span_s.clamp(1e-9, 1e12));
    if span_s >= WHOLE_TICKS * TICK_S { end.tick.into() } else { end }
}

/// The first place of the step at which a squared distance grows (or falls) through a value; its start where it lies beyond
/// already.
fn crossing(squared: &Scalar, edge: f64, outwards: bool) -> Option<f64> {
    let mut a = *squared;
    a[0] -= edge;
    let beyond = if outwards { a[0] > 0.0 } else { a[0] < 0.0 };
    if beyond { Some(0.0) } else { roots::first(&a, outwards) }
}
