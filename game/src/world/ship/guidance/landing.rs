//! The automatic landing: phases from orbit to standing, flown on the lift nozzles with the roof along the wanted push.
//!
//! 1. *Wait* coasts to the cheapest burn ([`super::plan`]); *Burn* flies the velocity still to be gained to a ballistic arc over
//!    the spot, computed anew at each tick, so that a long burn or a change of plane needs no correction.
//! 2. *Approach* coasts until constant deceleration would stop the ship short of the spot; *Brake* flies that deceleration
//!    (`v²/2s` along the ground track, closed loop) while the height is brought to the gate by a polynomial in time-to-go
//!    [Cherry 1964, E-guidance]: `a = 6(h₁−h)/t² − (4ḣ + 2ḣ₁)/t`. Ground ahead on the track lifts the path.
//! 3. *Descend* goes down above the spot on `v = √(v₀² + 2aH)`; at the touch the engine stops: *Touchdown*.
//!
//! Air helps: what it does already is taken off the push.

use super::super::attitude::Demand;
use super::super::course::Course;
use super::super::flight::Controls;
use super::super::local::{Local, ground_m};
use super::super::warp::floor_m;
use super::super::{Rigid, Ship};
use super::plan::{lead_s, thin_above_m, ticks};
use super::{fly_along, weight};
use crate::command::Target;
use engine::orbit::{BodyId, State};
use engine::space::{Position, Velocity};
use engine::time::SimTime;
use engine::units::{G0, KM};
use glam::DVec3;

/// The ship stops this far short of the spot, m, and goes the rest while it descends.
const SHORT_M: f64 = 200.0;
/// Distance from the spot within which braking may end, m.
const NEAR_M: f64 = 3.0 * KM;
/// Speed at touchdown, m/s.
const TOUCH_M_S: f64 = 1.0;
/// Height of the gear above ground under which the gear comes down, m.
const GEAR_M: f64 = 500.0;

/// Where a landing stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Coasting to the deorbit burn.
    Wait {
        /// When the ship turns for it.
        burn: SimTime,
    },
    /// The deorbit burn (with change of plane).
    Burn,
    /// Coasting down to the braking burn.
    Approach {
        /// When the ship turns for it.
        brake: SimTime,
    },
    /// Braking towards the gate above the spot.
    Brake,
    /// Down from the gate.
    Descend,
    /// On the ground, engine off, coming to rest.
    Touchdown,
    /// Nothing is flown: the propellant does not suffice for a powered landing there.
    OutOfReach,
}

impl Phase {
    /// One line for the pilot.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Wait { .. } => "Coasting to the deorbit burn",
            Self::Burn => "Deorbit burn",
            Self::Approach { .. } => "Coasting down to the braking burn",
            Self::Brake => "Braking towards the spot",
            Self::Descend => "Descending to the spot",
            Self::Touchdown => "Touchdown",
            Self::OutOfReach => "Out of reach: too little propellant for this spot",
        }
    }
}

/// A landing programme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// The body.
    pub body: BodyId,
    /// Unit direction of the spot in the body's turning axes.
    pub spot: DVec3,
    /// Height of the ground there above the datum, m.
    pub ground_m: f64,
    /// Altitude of the gate above the datum, m: over the spot, above mountains and thick air.
    pub gate_m: f64,
    /// Flight-path angle at which the ballistic arc arrives above the spot, rad below the horizon.
    pub arrival_rad: f64,
    /// Where it stands.
    pub phase: Phase,
}

/// Deceleration along the ground track that is planned with, m/s².
pub fn braking_m_s2(ship: &Ship) -> f64 {
    (0.5 * ship.spec.main_engine.thrust_n / ship.mass_kg()).min(2.0 * G0)
}

/// The way to the spot, in ICRF axes.
struct Way {
    /// Horizontal unit vector towards the spot.
    along: DVec3,
    /// Distance over the ground, m.
    distance_m: f64,
    /// Horizontal velocity over the ground, m/s.
    level: DVec3,
    /// Its part towards the spot, m/s.
    closing: f64,
}

impl Landing {
    /// True while the programme has nothing to do before a planned tick.
    pub fn coasts(&self) -> bool {
        self.wake().is_some() || self.phase == Phase::OutOfReach
    }
    /// The tick that it waits for, if it waits.
    pub fn wake(&self) -> Option<SimTime> {
        match self.phase {
            Phase::Wait { burn } => Some(burn),
            Phase::Approach { brake } => Some(brake),
            _ => None,
        }
    }

    fn way(&self, local: &Local) -> Way {
        let spot = local.icrf_from_fixed.raw(self.spot);
        let level = local.v_surface - local.up * local.v_surface.dot(local.up);
        let flat = spot - local.up * spot.dot(local.up);
        let angle = libm::atan2(flat.length(), spot.dot(local.up));
        let along = flat.normalize_or(level.normalize_or(DVec3::ZERO));
        Way { along, distance_m: angle * (local.body.radius_m + self.ground_m), level, closing: level.dot(along) }
    }

    /// When constant deceleration must begin on a coasting path from here, less the time to turn.
    fn braking_time(&self, ship: &Ship, local: &Local) -> SimTime {
        let state = State { position: Position::new(local.r), velocity: Velocity::new(local.v) };
        let mut course = Course::new(local.system, local.time, local.id, &state);
        let planned = braking_m_s2(ship);
        let mut after_s = 0.0;
        let lead = lead_s(ship);
        while after_s < 2e5 {
            let time = local.time.plus(ticks(after_s));
            let Some(state) = course.at(time) else { break };
            let there = Local::new(local.system, time, local.id, &state);
            let way = self.way(&there);
            let needed = way.closing * way.closing / (2.0 * (way.distance_m - SHORT_M).max(1.0));
            if (way.closing > 0.0 && needed > planned) || there.altitude_m < self.gate_m {
                break;
            }
            // A small part of the time that remains at this speed.
            after_s += (0.02 * way.distance_m / way.level.length().max(1.0)).clamp(1.0, 60.0);
        }
        local.time.plus(ticks((after_s - lead).max(0.0)))
    }
}

/// The controls of a tick.
pub fn controls(ship: &mut Ship, local: &Local, rigid: &Rigid, target: Option<Target>) -> Controls {
    let mut landing = match ship.landing {
        Some(landing) if landing.body == local.id => landing,
        _ => Landing::plan(ship, local, target),
    };
    let controls = match landing.phase {
        Phase::Wait { burn } if local.time < burn => idle(),
        Phase::Wait { .. } | Phase::Burn => landing.burn(ship, local, rigid),
        Phase::Approach { brake } if local.time < brake => landing.approach(ship, local, rigid),
        Phase::Approach { .. } | Phase::Brake => landing.brake(ship, local, rigid),
        Phase::Descend => landing.descend(ship, local, rigid),
        Phase::Touchdown | Phase::OutOfReach => idle(),
    };
    ship.landing = Some(landing);
    controls
}

/// No push, no turning; the nozzles ready for lift.
fn idle() -> Controls {
    Controls { demand: Demand::Rate(DVec3::ZERO), throttle: 0.0, nozzle: 1.0, translation: DVec3::ZERO }
}

impl Landing {
    fn burn(&mut self, ship: &Ship, local: &Local, rigid: &Rigid) -> Controls {
        self.phase = Phase::Burn;
        let shot = self.true_shot(local, local.r.cross(local.v));
        let to_gain = shot.map_or(DVec3::ZERO, |s| s.velocity - local.v);
        let roof = rigid.icrf_from_hull.0 * DVec3::Y;
        let near = to_gain.length() < 3.0;
        if to_gain.length() < 0.1 || (near && to_gain.dot(roof) < 0.1) {
            self.phase = Phase::Approach { brake: self.braking_time(ship, local) };
            return idle();
        }
        let limit = ship.spec.main_engine.thrust_n / ship.mass_kg();
        let push = to_gain.clamp_length_max(limit);
        // The last metres per second are taken out at the attitude that the burn ended with.
        let direction = if near && to_gain.normalize().dot(roof) > 0.5 { roof } else { push };
        fly_along(ship, local, rigid, push, direction, 0.0)
    }

    /// Waits for the braking burn where the path cannot be sampled: in the air, with the belly to it.
    fn approach(&mut self, ship: &Ship, local: &Local, rigid: &Rigid) -> Controls {
        if local.altitude_m >= floor_m(local.body) {
            return idle();
        }
        Controls { throttle: 0.0, ..fly_along(ship, local, rigid, DVec3::ZERO, -local.v_surface, 0.0) }
    }

    fn brake(&mut self, ship: &mut Ship, local: &Local, rigid: &Rigid) -> Controls {
        self.phase = Phase::Brake;
        let way = self.way(local);
        let pull = sideways_m_s2(ship, local, self.gate_m);
        if way.level.length() < (pull * SHORT_M).sqrt().clamp(3.0, 50.0) && way.distance_m < NEAR_M {
            self.phase = Phase::Descend;
            return self.descend(ship, local, rigid);
        }
        let limit = ship.spec.main_engine.thrust_n / ship.mass_kg();
        let planned = braking_m_s2(ship);
        let gravity = local.gravity().length();
        let remaining = (way.distance_m - SHORT_M).max(1.0);
        let allowed = (2.0 * planned * remaining).sqrt();
        let climb = local.vertical_m_s();
        let below_gate = self.gate_m - local.altitude_m;
        let orbital = way.closing > 0.95 * allowed;
        let (ahead, mut upward) = if orbital {
            let time_to_go = (2.0 * remaining / way.closing).max(12.0);
            let upward = 6.0 * below_gate / (time_to_go * time_to_go) - 4.0 * climb / time_to_go;
            (-(way.closing * way.closing / (2.0 * remaining)).min(0.9 * limit), upward)
        } else {
            // Too slow to get there: first up to the height of the gate, then on.
            let hop = self.hop_speed(ship, local, way.distance_m).min(allowed) * ((below_gate - 1000.0) / -700.0).clamp(0.0, 1.0);
            let wanted = if way.closing > hop { way.closing.min(allowed) } else { hop };
            let climb_wanted = (below_gate / 8.0).clamp(-150.0, 150.0);
            (((wanted - way.closing) / 3.0).clamp(-planned, planned), (climb_wanted - climb) / 2.0)
        };
        upward = upward.max(self.over_ground_ahead(local, &way, upward)).max(over_thick_air(ship, local, planned));
        upward = upward.clamp(-(2.0 * gravity).max(0.5), 0.8 * limit);
        let across = way.level - way.along * way.closing;
        let settle_s = (0.25 * way.distance_m / way.level.length().max(1.0)).clamp(3.0, 60.0);
        let sideways = (-across / settle_s).clamp_length_max(0.3 * limit);
        let push = way.along * ahead + sideways + local.up * upward - weight(local);
        let direction = if push.length() > (0.05 * limit).min(0.3 * gravity) { push } else { local.up * gravity - local.v_surface * 0.01 };
        fly_along(ship, local, rigid, push, direction, 0.0)
    }

    /// Speed at which to cross to a spot that the present path does not reach, m/s.
    fn hop_speed(&self, ship: &Ship, local: &Local, distance_m: f64) -> f64 {
        let gravity = local.gravity().length();
        let circular = (gravity * local.r.length()).sqrt();
        let aero = &ship.spec.aero;
        let density = local.body.air.as_ref().map_or(0.0, |a| a.at(self.gate_m).density_kg_m3);
        // Drag belly first is to stay under a third of the weight.
        let drag_limit = if density > 0.0 {
            (0.6 * ship.mass_kg() * gravity / (density * aero.reference_area_m2 * aero.belly_drag)).sqrt()
        } else {
            f64::INFINITY
        };
        (gravity * distance_m).sqrt().min(0.5 * circular).min(drag_limit).max(5.0)
    }

    /// The least upward acceleration that clears the ground ahead on the track, m/s²; very negative where nothing is near.
    fn over_ground_ahead(&self, local: &Local, way: &Way, upward: f64) -> f64 {
        let mut needed = f64::NEG_INFINITY;
        if local.altitude_m > 30.0 * KM {
            return needed;
        }
        let speed = way.level.length();
        let heading = way.level.normalize_or(way.along);
        for after_s in [1.0, 2.5, 5.0, 10.0, 20.0, 40.0] {
            let reach = (speed * after_s).min(way.distance_m.max(100.0));
            let (s, c) = libm::sincos(reach / local.r.length());
            let there = local.icrf_from_fixed.inverse().raw(local.up * c + heading * s);
            let clearance = (0.3 * (self.gate_m - self.ground_m)).min(400.0);
            let lowest = ground_m(local.body, there) + clearance;
            let predicted = local.altitude_m + (local.vertical_m_s() + 0.5 * upward * after_s) * after_s;
            if predicted < lowest {
                needed = needed.max(2.0 * (lowest - local.altitude_m - local.vertical_m_s() * after_s) / (after_s * after_s));
            }
        }
        needed
    }

    fn descend(&mut self, ship: &mut Ship, local: &Local, rigid: &Rigid) -> Controls {
        let way = self.way(local);
        let touched = ship.ground.contact.touching;
        let height = local.altitude_m - super::super::flight::surface_below_m(local) - ship.spec.standing_height_m();
        if touched || height < 0.02 {
            self.phase = Phase::Touchdown;
            return idle();
        }
        if way.distance_m > 2.0 * NEAR_M {
            self.phase = Phase::Brake;
        }
        if height < GEAR_M {
            ship.gear_down = true;
        }
        let limit = ship.spec.main_engine.thrust_n / ship.mass_kg();
        let gravity = local.gravity().length();
        let spare = (0.4 * (limit - gravity)).clamp(0.2, 4.0);
        // Down on the curve of constant deceleration, but not before the spot is nearly below.
        let aside = way.distance_m > 30.0 + 0.15 * height && height > 15.0;
        let curve = (TOUCH_M_S * TOUCH_M_S + 2.0 * spare * (height - 2.0).max(0.0)).sqrt();
        let fastest = 300.0_f64.min(0.3 * (gravity * local.r.length()).sqrt());
        let (sink, ahead_of_curve) = if aside { (0.0, 0.0) } else { (curve.min(fastest), if curve < fastest { spare } else { 0.0 }) };
        let climb = local.vertical_m_s();
        let braking = if climb < -0.5 * sink && height > 2.0 { ahead_of_curve * (climb / -sink.max(0.1)).min(1.0) } else { 0.0 };
        let upward = (braking + (-sink - climb) / 0.6).clamp(-gravity, limit);
        // Sideways: towards the spot, slower as it comes near.
        let pull = sideways_m_s2(ship, local, height);
        let pace = (pull * way.distance_m).sqrt().min(0.12 * way.distance_m).min(60.0).min(0.12 * (height - 5.0).max(0.0));
        let sideways = ((way.along * pace - way.level) / 3.0).clamp_length_max(if height < 15.0 { 0.4 * pull } else { pull });
        let push = sideways + local.up * upward - weight(local);
        let lift = push.dot(local.up).max(0.7 * gravity);
        fly_along(ship, local, rigid, push, sideways + local.up * lift, 0.0)
    }
}

/// How hard a descending ship is pulled sideways at a height above ground, m/s²: tilting more where there is room.
fn sideways_m_s2(ship: &Ship, local: &Local, height_m: f64) -> f64 {
    let limit = ship.spec.main_engine.thrust_n / ship.mass_kg();
    let gravity = local.gravity().length();
    let room = if height_m > 100.0 { (0.05 * limit).min(gravity) } else { 0.0 };
    (0.35 * gravity).max(room).min(0.3 * limit).max(0.02)
}

/// The least upward acceleration that keeps a fast ship above air that would brake it harder than planned, m/s²; very
/// negative where there is none. The floor sinks as the speed falls: with the scale height D, by 2·D·a/v per second.
fn over_thick_air(ship: &Ship, local: &Local, planned: f64) -> f64 {
    const PACE_PER_S: f64 = 0.08;
    let aero = &ship.spec.aero;
    let speed = local.v_surface.length().max(1.0);
    let bearable = 1.4 * ship.mass_kg() * planned / (speed * speed * aero.reference_area_m2 * (aero.cd0 + aero.belly_drag));
    let floor = thin_above_m(local.body, bearable);
    if floor <= 0.0 || speed < 300.0 {
        return f64::NEG_INFINITY;
    }
    let scale = (thin_above_m(local.body, 0.5 * bearable) - floor) / core::f64::consts::LN_2;
    let sink = -2.0 * scale * planned / speed;
    PACE_PER_S * PACE_PER_S * (floor - local.altitude_m) + 2.0 * PACE_PER_S * (sink - local.vertical_m_s())
}
