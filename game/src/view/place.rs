//! A place to look from: the `--camera` argument of `syzygy shot`.
//!
//! | written | the camera |
//! |---|---|
//! | `chase[:YAW,PITCH[,DISTANCE_M]]` | behind the ship; degrees to the left and up |
//! | `cockpit[:YAW,PITCH]` | in the cockpit |
//! | `at:BODY,LAT,LON,HEIGHT_M,HEADING,PITCH[,FOV]` | over a place of a body; degrees; heading clockwise from north |
//! | `map:BODY,YAW,PITCH,RADII` | far from a body's centre, in radii |
//!
//! A heading may be `sun`, `sun+30`, `sun-90`: measured from the azimuth of the star. Height is above the ground (or water).

use super::rig::{CameraMode, Eye, Mount, Rig, looking};
use crate::world::system::System;
use engine::orbit::BodyId;
use engine::space::{Position, sphere};
use engine::units::DEG;
use glam::DVec3;
use thiserror::Error;

/// Where a heading is measured from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadingFrom {
    /// Clockwise from north.
    North,
    /// Clockwise from the azimuth of the star.
    Sun,
}

/// Over a place of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The body.
    pub body: BodyId,
    /// Planetocentric latitude, rad.
    pub lat_rad: f64,
    /// East longitude, rad.
    pub lon_rad: f64,
    /// Height above the ground or water, m.
    pub height_m: f64,
    /// Heading, rad, clockwise.
    pub heading_rad: f64,
    /// What the heading is measured from.
    pub heading_from: HeadingFrom,
    /// Look up, rad.
    pub pitch_rad: f64,
}

/// Why a `--camera` argument was refused.
#[derive(Debug, Error, PartialEq)]
pub enum PlaceError {
    /// The form is unknown.
    #[error(
        "--camera `{0}`: expected `chase[:YAW,PITCH[,DISTANCE_M]]`, `cockpit[:YAW,PITCH]`, `at:BODY,LAT,LON,HEIGHT_M,HEADING,PITCH[,FOV]` or `map:BODY,YAW,PITCH,RADII`"
    )]
    Form(String),
    /// A number does not parse or is out of range.
    #[error("--camera `{argument}`: {field} is `{value}`; expected {expected}")]
    Number {
        /// The whole argument.
        argument: String,
        /// Which field.
        field: &'static str,
        /// What stood there.
        value: String,
        /// What should stand there.
        expected: &'static str,
    },
    /// No such body.
    #[error("--camera `{argument}`: there is no body `{body}`; bodies are {known}")]
    Body {
        /// The whole argument.
        argument: String,
        /// What stood there.
        body: String,
        /// The keys of the system.
        known: String,
    },
}

impl Rig {
    /// Reads a `--camera` argument.
    pub fn parse(argument: &str, system: &System) -> Result<Self, PlaceError> {
        let form = || PlaceError::Form(argument.to_owned());
        let (kind, rest) = argument.split_once(':').unwrap_or((argument, ""));
        let fields: Vec<&str> = if rest.is_empty() { Vec::new() } else { rest.split(',').map(str::trim).collect() };
        let number = |index: usize, field: &'static str, low: f64, high: f64, expected: &'static str| {
            let value = fields.get(index).copied().unwrap_or_default();
            match value.parse::<f64>() {
                Ok(x) if x >= low && x <= high => Ok(x),
                _ => Err(PlaceError::Number { argument: argument.to_owned(), field, value: value.to_owned(), expected }),
            }
        };
        let body = |index: usize| {
            let key = fields.get(index).copied().unwrap_or_default();
            system.find(key).ok_or_else(|| PlaceError::Body {
                argument: argument.to_owned(),
                body: key.to_owned(),
                known: system.bodies.iter().map(|b| b.key.as_str()).collect::<Vec<_>>().join(", "),
            })
        };
        let mut rig = Self::default();
        let angles = |rig: &mut Self, from: usize| -> Result<(), PlaceError> {
            rig.yaw_rad = number(from, "YAW", -360.0, 360.0, "degrees, −360 … 360")? * DEG;
            rig.pitch_rad = number(from + 1, "PITCH", -89.9, 89.9, "degrees, −89.9 … 89.9")? * DEG;
            Ok(())
        };
        match (kind, fields.len()) {
            ("chase" | "cockpit", 0) => {}
            ("chase" | "cockpit", 2) => angles(&mut rig, 0)?,
            ("chase", 3) => {
                angles(&mut rig, 0)?;
                rig.chase_m = number(2, "DISTANCE_M", 1.0, 1.0e9, "metres, 1 … 1e9")?;
            }
            ("map", 4) => {
                rig.focus = Some(body(0)?);
                angles(&mut rig, 1)?;
                rig.map_radii = number(3, "RADII", 1.0001, 1.0e9, "radii, above 1")?;
            }
            ("at", 6 | 7) => {
                let (heading_from, degrees) = match fields[4].strip_prefix("sun") {
                    Some("") => (HeadingFrom::Sun, "0"),
                    Some(offset) => (HeadingFrom::Sun, offset),
                    None => (HeadingFrom::North, fields[4]),
                };
                let heading: f64 = degrees.parse().ok().filter(|x: &f64| x.abs() <= 360.0).ok_or_else(|| PlaceError::Number {
                    argument: argument.to_owned(),
                    field: "HEADING",
                    value: fields[4].to_owned(),
                    expected: "degrees, −360 … 360, or `sun`, `sun+30`, `sun-90`",
                })?;
                rig.mode = CameraMode::Place(Place {
                    body: body(0)?,
                    lat_rad: number(1, "LAT", -90.0, 90.0, "degrees, −90 … 90")? * DEG,
                    lon_rad: number(2, "LON", -360.0, 360.0, "degrees, −360 … 360")? * DEG,
                    height_m: number(3, "HEIGHT_M", 0.1, 1.0e13, "metres, 0.1 … 1e13")?,
                    heading_rad: heading * DEG,
                    heading_from,
                    pitch_rad: number(5, "PITCH", -90.0, 90.0, "degrees, −90 … 90")? * DEG,
                });
                if fields.len() == 7 {
                    rig.fov_y_rad = number(6, "FOV", 0.01, 150.0, "degrees, 0.01 … 150")? * DEG;
                }
                return Ok(rig);
            }
            _ => return Err(form()),
        }
        rig.mode = match kind {
            "chase" => CameraMode::Chase,
            "cockpit" => CameraMode::Cockpit,
            _ => CameraMode::Map,
        };
        if rig.mode == CameraMode::Cockpit && fields.is_empty() {
            rig.pitch_rad = 0.0;
        }
        Ok(rig)
    }
}

impl Place {
    /// The eye at this place.
    pub fn eye(&self, mount: &Mount<'_>) -> Eye {
        let body = mount.system.body(self.body);
        let axes = mount.axes(self.body);
        let (east, up, north) = sphere::east_up_north(sphere::direction_of_lat_lon(self.lat_rad, self.lon_rad));
        let ground = body.relief.as_ref().map_or(0.0, |r| r.surface_m(up));
        let position = Position::new(axes.raw(up) * (body.radius_m + ground + self.height_m));
        let from = match self.heading_from {
            HeadingFrom::North => 0.0,
            HeadingFrom::Sun => {
                let sun = axes.inverse().raw(mount.to_star(self.body));
                libm::atan2(sun.dot(east), sun.dot(north))
            }
        };
        let (sh, ch) = libm::sincos(from + self.heading_rad);
        let (sp, cp) = libm::sincos(self.pitch_rad);
        let level: DVec3 = north * ch + east * sh;
        let forward = level * cp + up * sp;
        let roof = up * cp - level * sp;
        Eye { host: self.body, position, view_from_icrf: looking(axes.raw(forward), axes.raw(roof)) }
    }
}
