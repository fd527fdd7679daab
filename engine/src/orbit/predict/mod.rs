//! Predict: the path ahead under the same forces and the planned burns, with everything on it that a map shows.
//!
//! [`predict`] follows a ship from a knot through its [`Burn`]s; the [`Prediction`] answers where it is at any moment, gives
//! polylines in the frame of any body ([`view`]), and lists what happens ([`marks`]): apsides, nodes, closest approaches, air,
//! impact, changes of host. Without burns its steps are those that will be flown, bit for bit; a burn cuts the step it falls in.
//! Air is not felt: behind an entry the path is what it were without.
//!
//! Not here: drawing, and the editing of burns.
//! - [Vallado 2013] "Fundamentals of Astrodynamics and Applications", §6.3 (burns along, normal to and across the path).

pub mod marks;
pub mod view;

pub use marks::{Kind, Mark};
pub use view::View;

use super::path::recurrence::Thrust;
use super::path::{End, Knot, Model, Places, Setting, Step};
use super::{BodyId, State};
use crate::space::Centred;
use crate::time::{Moment, SimTime};
use glam::DVec3;
use marks::Watch;

/// A planned change of velocity: along the path, along the orbit's normal, and outwards across both, m/s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Burn {
    /// When: the middle of the burn in time.
    pub at: Moment,
    /// Along the velocity, m/s.
    pub prograde_m_s: f64,
    /// Along r × v, m/s.
    pub normal_m_s: f64,
    /// Along v × (r × v): away from the body, across the path, m/s.
    pub radial_m_s: f64,
    /// What burns; none for an impulse.
    pub engine: Option<Engine>,
}

/// An engine that keeps its thrust while the ship grows lighter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Engine {
    /// Acceleration at ignition, m/s².
    pub acceleration_m_s2: f64,
    /// Exhaust velocity, m/s.
    pub exhaust_m_s: f64,
}

impl Burn {
    /// Its delta-v, m/s.
    pub fn delta_v_m_s(&self) -> f64 {
        DVec3::new(self.prograde_m_s, self.normal_m_s, self.radial_m_s).length()
    }

    /// The change of velocity in ICRF axes for a ship in `state`, m/s.
    pub fn vector(&self, state: &State<Centred>) -> DVec3 {
        let [along, normal, outwards] = axes(state);
        along * self.prograde_m_s + normal * self.normal_m_s + outwards * self.radial_m_s
    }

    /// How long it takes, s: `(c/a)(1 − e^{−Δv/c})`; 0 for an impulse.
    pub fn duration_s(&self) -> f64 {
        let Some(Engine { acceleration_m_s2: a, exhaust_m_s: c }) =
            self.engine.filter(|e| e.acceleration_m_s2 > 0.0 && e.exhaust_m_s > 0.0)
        else {
            return 0.0;
        };
        -libm::expm1(-self.delta_v_m_s() / c) * c / a
    }

    /// When it begins.
    pub fn ignition(&self) -> Moment {
        self.at.plus_s(-0.5 * self.duration_s())
    }
}

/// Unit vectors along the path, along the orbit's normal, and outwards across both, ICRF axes; zero where there is none.
pub fn axes(state: &State<Centred>) -> [DVec3; 3] {
    let (r, v) = (state.position.0, state.velocity.0);
    let normal = r.cross(v);
    [v, normal, v.cross(normal)].map(|d| d.normalize_or(DVec3::ZERO))
}

/// How far to look, and for what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Not beyond this tick.
    pub until: SimTime,
    /// Not beyond so many periapses about one body (0: as many as come).
    pub periapses: u32,
    /// Not more than so many steps.
    pub steps: usize,
    /// Whose closest approaches are marked.
    pub target: Option<BodyId>,
    /// Normal of the plane whose crossings are nodes, ICRF axes; none for the host's equator.
    pub plane: Option<DVec3>,
    /// What light takes off the star's pull on the ship, m³/s²: see [`Setting`].
    pub light_m3_s2: f64,
}

impl Limits {
    /// Up to `until`, without a target, nodes on the equator.
    pub fn until(until: SimTime) -> Self {
        Self { until, periapses: 0, steps: 20_000, target: None, plane: None, light_m3_s2: 0.0 }
    }
}

/// Why a prediction ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The tick that it was asked for.
    Until,
    /// The number of periapses.
    Periapses,
    /// The number of steps.
    Steps,
    /// The ground.
    Impact,
}

/// A path ahead.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Its steps, in order, without gaps; about which body, each says itself.
    pub steps: Vec<Step>,
    /// What happens on it, in order.
    pub marks: Vec<Mark>,
    /// Why it ends where it ends.
    pub ending: Ending,
}

impl Prediction {
    /// The last moment that it knows of.
    pub fn end(&self) -> Moment {
        self.steps.last().map_or(Moment::default(), |s| s.until)
    }

    /// The body and the state about it at a moment of the prediction; none outside it.
    pub fn state(&self, at: Moment) -> Option<(BodyId, State<Centred>)> {
        let i = self.steps.partition_point(|s| s.until.since(at) <= 0.0);
        let last = || self.steps.last().filter(|s| s.until == at);
        let step = self.steps.get(i).or_else(last).filter(|s| at.since(s.knot.at) >= 0.0)?;
        Some((step.knot.host, step.sample(at)))
    }

    /// The first mark of a kind.
    pub fn first(&self, is: impl Fn(Kind) -> bool) -> Option<&Mark> {
        self.marks.iter().find(|m| is(m.kind))
    }
}

/// A prediction in the making.
struct Course<'a> {
    model: &'a Model,
    places: &'a dyn Places,
    limits: &'a Limits,
    watch: Watch,
    steps: Vec<Step>,
    knot: Knot,
}

/// The path from `start` on, with `burns` in any order (one whose middle has passed is left out; one that should be burning is
/// begun at once).
pub fn predict(model: &Model, places: &dyn Places, start: Knot, burns: &[Burn], limits: &Limits) -> Prediction {
    let mut order: Vec<usize> = (0..burns.len()).filter(|&i| burns[i].at.since(start.at) >= 0.0).collect();
    order.sort_by(|&a, &b| burns[a].at.since(burns[b].at).total_cmp(&0.0));
    let mut course = Course { model, places, limits, watch: Watch::default(), steps: Vec::new(), knot: start };
    let mut ending = None;
    for i in order {
        ending = course.coast(burns[i].ignition());
        if ending.is_none() {
            ending = course.burn(i, &burns[i]);
        }
        if ending.is_some() {
            break;
        }
    }
    let ending = ending.or_else(|| course.coast(limits.until.into())).unwrap_or(Ending::Until);
    Prediction { steps: course.steps, marks: course.watch.marks, ending }
}

impl Course<'_> {
    fn setting(&self, thrust: Option<Thrust>) -> Setting {
        Setting { light_m3_s2: self.limits.light_m3_s2, thrust, to_ground: true }
    }

    /// Adds a step; says why it is the last, if it is.
    fn take(&mut self, step: Step) -> Option<Ending> {
        self.watch.look(self.model, self.places, self.limits, &step);
        self.knot = step.next(self.model, self.places);
        let end = step.end;
        self.steps.push(step);
        if end == End::Low {
            Some(Ending::Impact)
        } else if self.knot.at.since(self.limits.until.into()) >= 0.0 {
            Some(Ending::Until)
        } else if self.limits.periapses > 0 && self.watch.periapses >= self.limits.periapses {
            Some(Ending::Periapses)
        } else {
            (self.steps.len() >= self.limits.steps).then_some(Ending::Steps)
        }
    }

    fn coast(&mut self, to: Moment) -> Option<Ending> {
        let until = Moment::from(self.limits.until);
        let to = if to.since(until) > 0.0 { until } else { to };
        while self.knot.at.since(to) < 0.0 {
            let step = Step::new(self.model, self.places, self.knot, &self.setting(None)).cut(to);
            let ending = self.take(step);
            if ending.is_some() {
                return ending;
            }
        }
        (to == until).then_some(Ending::Until)
    }

    /// Burns in the direction that the burn means at its middle, on the path without it.
    fn burn(&mut self, which: usize, burn: &Burn) -> Option<Ending> {
        let total = burn.delta_v_m_s();
        if total == 0.0 {
            return None;
        }
        let state = self.state_at(burn.at);
        let dv = burn.vector(&state);
        self.watch.burn(Kind::BurnBegins(which), &self.knot);
        let (begun, duration_s) = (self.knot.at, burn.duration_s());
        match burn.engine.filter(|_| duration_s > 0.0) {
            None => self.knot = self.knot.kicked(dv),
            Some(engine) => {
                let flow_per_s = engine.acceleration_m_s2 / engine.exhaust_m_s;
                let end = begun.plus_s(duration_s);
                while self.knot.at.since(end) < 0.0 {
                    let lighter = 1.0 - flow_per_s * self.knot.at.since(begun);
                    let thrust =
                        Thrust { acceleration: dv * (engine.acceleration_m_s2 / (total * lighter)), growth_per_s: flow_per_s / lighter };
                    let step = Step::new(self.model, self.places, self.knot, &self.setting(Some(thrust))).cut(end);
                    let ending = self.take(step);
                    if ending.is_some() {
                        return ending;
                    }
                }
            }
        }
        self.watch.burn(Kind::BurnEnds(which), &self.knot);
        None
    }

    /// The state at a moment ahead of the present knot, coasting.
    fn state_at(&self, at: Moment) -> State<Centred> {
        let mut knot = self.knot;
        for _ in 0..self.limits.steps {
            let step = Step::new(self.model, self.places, knot, &self.setting(None));
            if at.since(step.until) <= 0.0 || step.end == End::Low {
                return step.sample(at);
            }
            knot = step.next(self.model, self.places);
        }
        knot.state()
    }
}

#[cfg(test)]
mod tests;
