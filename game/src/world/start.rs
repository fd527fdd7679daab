//! Starts: a World from what a start file says, in words that a person writes, or from a raw state.
//!
//! Plain data and checks; the file is read and its errors are shown by [`crate::assets`].

use super::World;
use super::ship::attitude::look;
use super::ship::local::ground_m;
use super::ship::spec::ShipSpec;
use super::ship::{Motion, Resting, Rigid, Ship};
use super::system::System;
use crate::command::{Spot, Target, WARP_ONE};
use engine::orbit::{BodyId, State};
use engine::space::{Position, Rotation, Vector, Velocity, sphere};
use engine::time::{CivilTime, SimTime};
use engine::units::DEG;
use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a start file says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartSpec {
    /// File name without its ending.
    pub key: String,
    /// Display name.
    pub name: String,
    /// One line for the menu.
    #[serde(default)]
    pub description: String,
    /// Folder of the system.
    pub system: String,
    /// Key of the ship.
    pub ship: String,
    /// UTC date, `2026-08-12T17:30:00`.
    pub utc: String,
    /// Where the ship is.
    pub place: Place,
    /// What the pilot points at from the start.
    #[serde(default)]
    pub target: Option<TargetSpec>,
}

/// Where a ship starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind", deny_unknown_fields)]
pub enum Place {
    /// On a circular orbit, above a place, flying towards a heading.
    Orbit {
        /// Key of the body.
        body: String,
        /// Altitude above the datum, m.
        altitude_m: f64,
        /// Latitude of the place below, °.
        lat_deg: f64,
        /// East longitude of the place below, °.
        lon_deg: f64,
        /// Direction of flight (inertial), ° clockwise from north.
        heading_deg: f64,
    },
    /// In the air or above the ground, with a velocity over the ground.
    Air {
        /// Key of the body.
        body: String,
        /// Altitude above the datum, m.
        altitude_m: f64,
        /// Latitude, °.
        lat_deg: f64,
        /// East longitude, °.
        lon_deg: f64,
        /// Where the nose points, ° clockwise from north.
        heading_deg: f64,
        /// Speed over the ground along the heading, m/s.
        speed_m_s: f64,
        /// Rate of climb, m/s.
        climb_m_s: f64,
    },
    /// Standing on the ground.
    Ground {
        /// Key of the body.
        body: String,
        /// Latitude, °.
        lat_deg: f64,
        /// East longitude, °.
        lon_deg: f64,
        /// Where the nose points, ° clockwise from north.
        heading_deg: f64,
    },
}

/// A target as written in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TargetSpec {
    /// Key of the body.
    pub body: String,
    /// Latitude of a spot, °.
    #[serde(default)]
    pub lat_deg: Option<f64>,
    /// East longitude of a spot, °.
    #[serde(default)]
    pub lon_deg: Option<f64>,
}

/// What is wrong with a start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StartError {
    /// A body that the system does not have.
    #[error("{key}: the system has no body `{body}`; it has {known}")]
    UnknownBody {
        /// Key in the file.
        key: &'static str,
        /// What was written.
        body: String,
        /// What there is.
        known: String,
    },
    /// A number out of range.
    #[error("{key}: {value} is out of range: expected {expected}")]
    Range {
        /// Key in the file.
        key: &'static str,
        /// What was written.
        value: f64,
        /// What was expected.
        expected: String,
    },
    /// No date.
    #[error("utc: {0}")]
    Date(String),
}

impl World {
    /// A World in which `ship` moves as it does, at `time`, at 1×.
    pub fn new(system: Arc<System>, time: SimTime, ship: Ship) -> Self {
        let mut world = Self { system, time, quarters: 0, warp: WARP_ONE, warp_asked: WARP_ONE, ship, target: None, warp_to: None };
        if matches!(world.ship.motion, Motion::Fly(_)) {
            world.enter_path();
        }
        world
    }

    /// A World with a ship of full tanks in a given state about `body`.
    pub fn flying(system: Arc<System>, time: SimTime, spec: Arc<ShipSpec>, rigid: Rigid) -> Self {
        Self::new(system, time, Ship::new(spec, Motion::Fly(rigid)))
    }

    /// A World from a start file.
    pub fn from_start(system: Arc<System>, spec: Arc<ShipSpec>, start: &StartSpec) -> Result<Self, StartError> {
        let civil = CivilTime::parse(&start.utc).map_err(StartError::Date)?;
        let time = SimTime::from_utc(civil);
        let motion = motion(&system, time, &spec, &start.place)?;
        let target = start.target.as_ref().map(|t| target(&system, t)).transpose()?;
        let mut world = Self::new(system, time, Ship::new(spec, motion));
        world.target = target;
        Ok(world)
    }
}

fn find(system: &System, key: &'static str, body: &str) -> Result<BodyId, StartError> {
    system.find(body).ok_or_else(|| StartError::UnknownBody {
        key,
        body: body.to_owned(),
        known: system.bodies.iter().map(|b| b.key.as_str()).collect::<Vec<_>>().join(", "),
    })
}

fn within(key: &'static str, value: f64, low: f64, high: f64) -> Result<f64, StartError> {
    if value.is_finite() && (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(StartError::Range { key, value, expected: format!("{low} to {high}") })
    }
}

/// A place's direction in the body's axes, and the `(east, up, north)` there.
fn direction(lat_deg: f64, lon_deg: f64) -> Result<DVec3, StartError> {
    let lat = within("place.lat_deg", lat_deg, -90.0, 90.0)?;
    let lon = within("place.lon_deg", lon_deg, -360.0, 360.0)?;
    Ok(sphere::direction_of_lat_lon(lat * DEG, lon * DEG))
}

/// The horizontal unit vector of a heading at `up`, in the same axes.
fn along(up: DVec3, heading_deg: f64) -> Result<DVec3, StartError> {
    let heading = within("place.heading_deg", heading_deg, -360.0, 360.0)? * DEG;
    let (east, _, north) = sphere::east_up_north(up);
    Ok(north * libm::cos(heading) + east * libm::sin(heading))
}

fn motion(system: &System, time: SimTime, spec: &ShipSpec, place: &Place) -> Result<Motion, StartError> {
    match place {
        Place::Orbit { body, altitude_m, lat_deg, lon_deg, heading_deg } => {
            let id = find(system, "place.body", body)?;
            let b = system.body(id);
            let altitude = within("place.altitude_m", *altitude_m, 0.0, b.soi_radius_m.min(1e13))?;
            let icrf_from_fixed = b.spin.icrf_from_fixed(time);
            let up = direction(*lat_deg, *lon_deg)?;
            let ahead = icrf_from_fixed.raw(along(up, *heading_deg)?);
            let r = icrf_from_fixed.raw(up) * (b.radius_m + altitude);
            let v = ahead * (b.gm_m3_s2 / r.length()).sqrt();
            Ok(Motion::Fly(rigid(id, r, v, look(ahead, r))))
        }
        Place::Air { body, altitude_m, lat_deg, lon_deg, heading_deg, speed_m_s, climb_m_s } => {
            let id = find(system, "place.body", body)?;
            let b = system.body(id);
            let up = direction(*lat_deg, *lon_deg)?;
            let ground = ground_m(b, up);
            let altitude = within("place.altitude_m", *altitude_m, ground, b.soi_radius_m.min(1e13))?;
            let speed = within("place.speed_m_s", *speed_m_s, -1e5, 1e5)?;
            let climb = within("place.climb_m_s", *climb_m_s, -1e5, 1e5)?;
            let icrf_from_fixed = b.spin.icrf_from_fixed(time);
            let ahead = icrf_from_fixed.raw(along(up, *heading_deg)?);
            let zenith = icrf_from_fixed.raw(up);
            let r = zenith * (b.radius_m + altitude);
            let v = b.spin.angular_velocity(time).0.cross(r) + ahead * speed + zenith * climb;
            Ok(Motion::Fly(rigid(id, r, v, look(ahead, r))))
        }
        Place::Ground { body, lat_deg, lon_deg, heading_deg } => {
            let id = find(system, "place.body", body)?;
            let up = direction(*lat_deg, *lon_deg)?;
            Ok(Motion::Landed(standing(system, id, spec, up, along(up, *heading_deg)?)))
        }
    }
}

fn rigid(body: BodyId, r: DVec3, v: DVec3, attitude: DQuat) -> Rigid {
    Rigid {
        body,
        state: State { position: Position::new(r), velocity: Velocity::new(v) },
        icrf_from_hull: Rotation::new(attitude),
        rate: Vector::ZERO,
    }
}

/// A ship that stands at `up` (unit, body-fixed axes) with its gear on the ground, square to the slope under its feet.
pub fn standing(system: &System, id: BodyId, spec: &ShipSpec, up: DVec3, ahead: DVec3) -> Resting {
    let body = system.body(id);
    let (east, _, north) = sphere::east_up_north(up);
    let span = 0.5 * spec.hull.size_m.z;
    let at = |d: DVec3| {
        let p = up + d / body.radius_m;
        let unit = p / p.length();
        unit * (body.radius_m + ground_m(body, unit))
    };
    let normal = (at(east * span) - at(east * -span)).cross(at(north * span) - at(north * -span)).normalize_or(up);
    let right = ahead.cross(normal).normalize_or(east);
    let attitude = DQuat::from_mat3(&DMat3::from_cols(right, normal, right.cross(normal))).normalize();
    Resting {
        body: id,
        position: Position::new(at(DVec3::ZERO) + normal * spec.standing_height_m()),
        fixed_from_hull: Rotation::new(attitude),
    }
}

#[allow(clippy::cast_possible_truncation)]
fn target(system: &System, t: &TargetSpec) -> Result<Target, StartError> {
    let body = find(system, "target.body", &t.body)?;
    let spot = match (t.lat_deg, t.lon_deg) {
        (Some(lat), Some(lon)) => Some(Spot {
            lat_udeg: (within("target.lat_deg", lat, -90.0, 90.0)? * 1e6).round() as i32,
            lon_udeg: (within("target.lon_deg", lon, -360.0, 360.0)? * 1e6).round() as i32,
        }),
        (None, None) => None,
        (lat, _) => {
            let key = if lat.is_some() { "target.lon_deg" } else { "target.lat_deg" };
            return Err(StartError::Range { key, value: f64::NAN, expected: "latitude and longitude together".to_owned() });
        }
    };
    Ok(Target { body, spot })
}
