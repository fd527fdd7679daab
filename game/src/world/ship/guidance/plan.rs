//! Planning a landing: which spot, over which gate, and by which ballistic arc from orbit.
//!
//! # The arc
//! From `r₁` (now) to `r₂` (above the spot when the ship arrives) through the angle θ, arriving at the flight-path angle −φ. Seen
//! backwards it is the ballistic range problem: with `Q = v₂² r₂/μ`,
//! `Q = (1 − cos θ) / (cos²φ (r₂/r₁ − cos(θ+φ)/cos φ))` [Bate, Mueller & White 1971, §6.2]. The flight time moves the spot (the
//! body turns), so both are iterated; four rounds settle to metres.
//!
//! That arc is a conic. Flown under the forces that there are (a flattened body bends it by tens of kilometres), it misses; so
//! the arc that is flown aims beside the spot by what the one before it missed by, taken from the path ahead ([`Course`]).

use super::super::attitude::spot_direction;
use super::super::course::Course;
use super::super::local::{Local, ground_m};
use super::super::warp::floor_m;
use super::landing::{Landing, Phase};
use crate::command::Target;
use crate::world::ship::Ship;
use crate::world::system::Body;
use core::f64::consts::{PI, TAU};
use engine::orbit::{State, kepler};
use engine::space::{Centred, Position, Velocity, sphere};
use engine::time::{SimTime, TICK_S};
use engine::units::{DAY, DEG, HOUR, KM};
use glam::DVec3;

/// Flight-path angles at which an arc may arrive above the spot, ° below the horizon; the first that reaches it is taken.
const ARRIVALS_DEG: [f64; 3] = [1.0, 4.0, 12.0];
/// What the descent costs besides the speed of arrival, as a fraction of it.
const DESCENT_RESERVE: f64 = 0.15;
/// Instants per revolution at which a burn is tried.
const TRIES_PER_REVOLUTION: f64 = 120.0;
/// Price of waiting: this fraction of the delta-v left, per second.
const PRICE_OF_WAITING: f64 = 4.0e-6;
/// Below this speed over the ground the way to a spot is a hop, m/s.
const HOP_M_S: f64 = 600.0;
/// Air this thin does not disturb the arc, kg/m³.
const THIN_KG_M3: f64 = 1.0e-5;
/// Air this thin does not hinder braking at speed, kg/m³.
const GATE_KG_M3: f64 = 0.03;

/// A ballistic arc to the spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// The velocity to have now, inertial, m/s.
    pub velocity: DVec3,
    /// Flight time, s.
    pub flight_s: f64,
}

/// Whole ticks in `seconds`.
#[allow(clippy::cast_possible_truncation)]
pub fn ticks(seconds: f64) -> i64 {
    (seconds.clamp(-1e9, 1e9) / TICK_S).round() as i64
}

impl Landing {
    /// Makes a programme for a ship in `local`; begins with the deorbit burn from an orbit, with braking otherwise.
    pub fn plan(ship: &Ship, local: &Local, target: Option<Target>) -> Self {
        let spot = match target.filter(|t| t.body == local.id).and_then(|t| t.spot) {
            Some(spot) => flat_site(local.body, spot_direction(spot)),
            None => flat_site(local.body, site_ahead(ship, local)),
        };
        let ground = ground_m(local.body, spot);
        let mut gate_m = gate_m(local.body, spot);
        if local.altitude_m <= floor_m(local.body) && local.v_surface.length() < HOP_M_S {
            // A short hop need not climb above the air.
            let here = local.direction_fixed();
            let angle = libm::atan2(here.cross(spot).length(), here.dot(spot));
            gate_m = gate_m.min(mountains_m(local.body, spot).max(local.altitude_m) + 0.3 * angle * local.body.radius_m);
        }
        let mut landing = Self { body: local.id, spot, ground_m: ground, gate_m, arrival_rad: 0.0, phase: Phase::Brake };
        if local.altitude_m <= floor_m(local.body) {
            return landing;
        }
        for arrival_deg in ARRIVALS_DEG {
            landing.arrival_rad = arrival_deg * DEG;
            if let Some((cost, burn)) = landing.best_burn(ship, local) {
                // Arrival is at about the circular speed of the surface, or more from high up.
                let arrival = (local.body.gm_m3_s2 * (2.0 / local.body.radius_m - 1.0 / local.r.length().max(local.body.radius_m))).sqrt();
                let enough = cost + (1.0 + DESCENT_RESERVE) * arrival < ship.delta_v_m_s();
                let burn = burn.plus(-ticks(lead_s(ship))).max(local.time.plus(1));
                landing.phase = if enough { Phase::Wait { burn } } else { Phase::OutOfReach };
                break;
            }
        }
        landing
    }

    /// Altitude at which the ballistic arc passes over the spot, m.
    fn pass_m(&self, body: &Body) -> f64 {
        thin_above_m(body, THIN_KG_M3).max(self.gate_m + (8.0 * KM).min(0.2 * body.radius_m))
    }

    /// The arc from the ship to the spot, as it will be flown: two rounds leave a few metres of tens of kilometres.
    pub fn true_shot(&self, local: &Local, normal: DVec3) -> Option<Shot> {
        let mut aside = DVec3::ZERO;
        let mut shot = self.shot(local.body, local.time, local.r, normal, aside)?;
        for _ in 0..2 {
            let state = State::<Centred> { position: Position::new(local.r), velocity: Velocity::new(shot.velocity) };
            let arrival = local.time.plus(ticks(shot.flight_s));
            // An arc that does not get there tells nothing about what it misses by.
            let Some(there) = Course::new(local.system, local.time, local.id, &state).at(arrival) else { break };
            let conic = kepler::propagate(local.body.gm_m3_s2, &state, arrival.since(local.time));
            aside = -(there.position - conic.position).0;
            let Some(better) = self.shot(local.body, local.time, local.r, normal, aside) else { break };
            shot = better;
        }
        Some(shot)
    }

    /// The conic from `r` (with orbit normal `normal`) to a point `aside` (m, ICRF axes) of the spot, if there is one.
    pub fn shot(&self, body: &Body, time: SimTime, r: DVec3, normal: DVec3, aside: DVec3) -> Option<Shot> {
        let gm = body.gm_m3_s2;
        let (r1, height) = (r.length(), body.radius_m + self.pass_m(body));
        let from = r / r1;
        let mut flight_s = 0.0;
        let mut velocity = DVec3::ZERO;
        for _ in 0..5 {
            let aim = body.spin.icrf_from_fixed(time.plus(ticks(flight_s))).raw(self.spot) * height + aside;
            let r2 = aim.length();
            let to = aim / r2;
            let cross = from.cross(to);
            let n = (if cross.dot(normal) < 0.0 { -cross } else { cross }).normalize_or(normal.normalize_or(DVec3::Z));
            let mut theta = libm::atan2(cross.length(), from.dot(to));
            if cross.dot(normal) < 0.0 {
                theta = TAU - theta;
            }
            if !(20.0 * DEG..=340.0 * DEG).contains(&theta) {
                return None;
            }
            let (sin_t, cos_t) = libm::sincos(theta);
            let (sin_f, cos_f) = libm::sincos(self.arrival_rad);
            let denominator = cos_f * cos_f * (r2 / r1 - libm::cos(theta + self.arrival_rad) / cos_f);
            let q = (1.0 - cos_t) / denominator;
            if denominator <= 0.0 || !q.is_finite() {
                return None;
            }
            let p = r2 * q * cos_f * cos_f;
            let root = (gm / p).sqrt();
            // e cos ν and e sin ν at arrival, then at departure.
            let (ec2, es2) = (p / r2 - 1.0, -(q * gm / r2).sqrt() * sin_f / root);
            let (ec1, es1) = (ec2 * cos_t + es2 * sin_t, es2 * cos_t - ec2 * sin_t);
            let e = libm::hypot(ec1, es1);
            if e >= 0.99 {
                return None;
            }
            // Descending at arrival; it must not have passed periapsis on the way.
            let nu2 = libm::atan2(es2, ec2).rem_euclid(TAU);
            if nu2 < theta {
                return None;
            }
            velocity = from * (root * es1) + n.cross(from) * (root * p / r1);
            let a = p / (1.0 - e * e);
            let mean = |ec: f64, es: f64| {
                let anomaly = libm::atan2((1.0 - e * e).sqrt() * es, e * e + ec);
                anomaly - e * libm::sin(anomaly)
            };
            flight_s = (mean(ec2, es2) - mean(ec1, es1)).rem_euclid(TAU) * (a * a * a / gm).sqrt();
        }
        Some(Shot { velocity, flight_s })
    }

    /// The delta-v (m/s) and the instant of the change to an arc that is cheapest, waiting counted; none where no arc reaches
    /// the spot.
    fn best_burn(&self, ship: &Ship, local: &Local) -> Option<(f64, SimTime)> {
        let gm = local.body.gm_m3_s2;
        let state = State::<Centred> { position: Position::new(local.r), velocity: Velocity::new(local.v) };
        let mut course = Course::new(local.system, local.time, local.id, &state);
        let a = 1.0 / (2.0 / local.r.length() - local.v.length_squared() / gm);
        let closed = a > 0.0 && a.is_finite();
        let period = if closed { TAU * (a * a * a / gm).sqrt() } else { 2.0 * HOUR };
        let horizon = if closed { (16.0 * period).min(2.0 * DAY).max(1.2 * period) } else { period };
        let floor = local.body.radius_m + floor_m(local.body);
        let price = PRICE_OF_WAITING * ship.delta_v_m_s();
        let step = period / TRIES_PER_REVOLUTION;
        let mut best: Option<(f64, f64, SimTime)> = None;
        let mut wait = lead_s(ship) + 5.0;
        while wait < horizon {
            let at = local.time.plus(ticks(wait));
            let Some(s) = course.at(at) else { break };
            if s.position.0.length() < floor {
                break;
            }
            if let Some(shot) = self.shot(local.body, at, s.position.0, s.position.0.cross(s.velocity.0), DVec3::ZERO) {
                let change = (shot.velocity - s.velocity.0).length();
                let cost = change + price * (wait + shot.flight_s);
                if best.is_none_or(|b| cost < b.0) {
                    best = Some((cost, change, at));
                }
            }
            // Nothing that comes later can be cheaper.
            if best.is_some_and(|b| price * wait > b.0) {
                break;
            }
            wait += step;
        }
        best.map(|b| (b.1, b.2))
    }
}

/// Seconds that the ship needs to turn to any attitude, with a reserve.
pub fn lead_s(ship: &Ship) -> f64 {
    let rate = ship.spec.attitude.max_rate_deg_s.min_element() * DEG;
    let alpha = (ship.spec.attitude.torque_n_m / ship.inertia_kg_m2()).min_element();
    PI / rate + 2.0 * rate / alpha + 6.0
}

/// Lowest altitude above which the air is thinner than `density`, m; 0 without air.
pub fn thin_above_m(body: &Body, density: f64) -> f64 {
    let Some(air) = &body.air else { return 0.0 };
    let (mut low, mut high) = (0.0, air.top_m);
    if air.at(0.0).density_kg_m3 < density {
        return 0.0;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if air.at(middle).density_kg_m3 < density {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// Altitude of the gate: above the mountains around the spot and above air that hinders braking.
fn gate_m(body: &Body, spot: DVec3) -> f64 {
    thin_above_m(body, GATE_KG_M3).max(mountains_m(body, spot))
}

/// Altitude above all ground within 32 km of a spot, with a margin.
fn mountains_m(body: &Body, spot: DVec3) -> f64 {
    let (east, _, north) = sphere::east_up_north(spot);
    let mut highest = ground_m(body, spot);
    for ring in 1..=8 {
        for spoke in 0..12 {
            let (s, c) = libm::sincos(f64::from(spoke) * (TAU / 12.0));
            let reach = (f64::from(ring) * 4.0 * KM / body.radius_m).min(1.0);
            highest = highest.max(ground_m(body, (spot + (east * s + north * c) * reach).normalize_or(spot)));
        }
    }
    highest + (1.5 * KM).min(0.1 * body.radius_m + 200.0)
}

/// Tangent of the steepest slope under a ship at `up`.
fn slope(body: &Body, up: DVec3) -> f64 {
    const SPAN_M: f64 = 8.0;
    let (east, _, north) = sphere::east_up_north(up);
    let at = |d: DVec3| ground_m(body, (up + d * (SPAN_M / body.radius_m)).normalize_or(up));
    libm::hypot(at(east) - at(-east), at(north) - at(-north)) / (2.0 * SPAN_M)
}

/// The flattest place within half a kilometre of a spot; the spot itself when it is flat enough.
fn flat_site(body: &Body, spot: DVec3) -> DVec3 {
    const GOOD_SLOPE: f64 = 0.05;
    let (east, _, north) = sphere::east_up_north(spot);
    let mut best = (slope(body, spot), spot);
    if body.relief.is_none() || best.0 <= GOOD_SLOPE {
        return spot;
    }
    for ring in 1..=6 {
        for spoke in 0..12 {
            let (s, c) = libm::sincos(f64::from(spoke) * (TAU / 12.0));
            let there = (spot + (east * s + north * c) * (f64::from(ring) * 80.0 / body.radius_m)).normalize_or(spot);
            let steep = slope(body, there);
            if steep < best.0 {
                best = (steep, there);
            }
        }
        if best.0 <= GOOD_SLOPE {
            break;
        }
    }
    best.1
}

/// Where to land when no spot is set: the first dry and fairly level place ahead on the ground track; from low and slow
/// flight, what lies within the stopping distance.
fn site_ahead(ship: &Ship, local: &Local) -> DVec3 {
    let body = local.body;
    let radius = local.r.length();
    let normal = local.r.cross(local.v);
    let ahead = normal.cross(local.r).normalize_or(DVec3::X);
    let circular = (body.gm_m3_s2 / radius).sqrt();
    let fixed = |angle: f64, after_s: f64| {
        let (s, c) = libm::sincos(angle);
        body.spin.icrf_from_fixed(local.time.plus(ticks(after_s))).inverse().raw(local.up * c + ahead * s)
    };
    let level = local.v_surface - local.up * local.v_surface.dot(local.up);
    if level.length() < 0.3 * circular {
        let stop_m = level.length_squared() / (2.0 * super::landing::braking_m_s2(ship));
        let (s, c) = libm::sincos(stop_m / radius);
        return local.icrf_from_fixed.inverse().raw(local.up * c + level.normalize_or(ahead) * s);
    }
    let rate = local.v.length() / radius;
    for step in 0_u32..120 {
        let angle = (60.0 + 2.0 * f64::from(step)) * DEG;
        let there = fixed(angle, angle / rate);
        let wet = body.relief.as_ref().is_some_and(|r| r.has_water && r.height_m(there) < 0.0);
        if !wet && slope(body, there) < 0.15 {
            return there;
        }
    }
    fixed(0.5 * PI, 0.5 * PI / rate)
}
