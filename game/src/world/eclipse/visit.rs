//! Visiting an eclipse: a start at its place, a few minutes before it is greatest.
//!
//! The ground and the drawn shadow belong to the datum sphere, not to the ellipsoid of a canon: the place is where the axis meets
//! that sphere, so that who stands there stands in the dark. Not here: the calendar ([`super::almanac`]).

use super::almanac::{Event, cast, title, with_paths};
use crate::world::start::{Place, StartSpec, TargetSpec};
use crate::world::system::System;
use engine::orbit::eclipse::{Shape, solar};
use engine::space::sphere;
use engine::time::CivilTime;
use engine::units::DEG;
use glam::DVec3;

/// How long before the greatest moment a visit begins, s.
pub const BEFORE_S: f64 = 240.0;
/// Altitude of a visit from orbit, of the body's radius.
const HEIGHT: f64 = 0.066;

/// From where an eclipse is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seat {
    /// On the ground.
    Ground,
    /// From a low orbit that passes over the place at the greatest moment.
    Orbit,
}

/// True where one can stand on the receiver.
pub fn has_ground(system: &System, event: &Event) -> bool {
    system.bodies.get(event.on.index()).is_some_and(|b| b.relief.is_some())
}

/// Direction of the place on the receiver, in its axes: under the axis of the shadow; nearest to it where it misses; for a body within
/// a greater one's shadow, where that one stands in the zenith.
fn place(system: &System, event: &Event) -> Option<DVec3> {
    let greatest = event.eclipse.greatest;
    let body = system.body(event.on);
    with_paths(system, event, |cast, paths| {
        let mut smooth = *cast;
        smooth.receiver.shape = Shape::sphere(body.radius_m);
        if cast.is_solar() {
            let place = solar::centre(&smooth, paths, greatest).unwrap_or(event.eclipse.place);
            return sphere::direction_of_lat_lon(place.lat_rad, place.lon_rad);
        }
        let towards = paths(event.by, greatest).position - paths(event.on, greatest).position;
        body.spin.icrf_from_fixed_at(greatest).inverse().raw(towards.0).normalize_or(DVec3::X)
    })
}

/// The start of a visit, in words as a file has them; `None` where the event is not of this system.
pub fn start(system: &System, event: &Event, ship: &str, seat: Seat) -> Option<StartSpec> {
    cast(system, event.on, event.by)?;
    let up = place(system, event)?;
    let body = system.body(event.on);
    let begin = event.eclipse.greatest.plus_s(-BEFORE_S).tick;
    let degrees = |d: DVec3| {
        let (lat, lon) = sphere::lat_lon_of(d);
        (lat / DEG, lon / DEG)
    };
    let (spot_lat, spot_lon) = degrees(up);
    let key = body.key.clone();
    let place = match seat {
        Seat::Ground => {
            // The nose towards the star: what is come for stands ahead.
            let to_star = with_paths(system, event, |cast, paths| {
                let star = paths(cast.star.id, begin.into()).position - paths(event.on, begin.into()).position;
                body.spin.icrf_from_fixed(begin).inverse().raw(star.0)
            })?;
            let (east, _, north) = sphere::east_up_north(up);
            let heading_deg = libm::atan2(to_star.dot(east), to_star.dot(north)) / DEG;
            Place::Ground { body: key.clone(), lat_deg: spot_lat, lon_deg: spot_lon, heading_deg }
        }
        Seat::Orbit => {
            let altitude_m = (HEIGHT * body.radius_m).max(1.3 * body.air.as_ref().map_or(0.0, |a| a.top_m));
            let r = body.radius_m + altitude_m;
            // Back along an eastward circle by what is flown until then, over ground that turns the same way.
            let rate = (body.gm_m3_s2 / (r * r * r)).sqrt();
            let (east, _, _) = sphere::east_up_north(up);
            let (s, c) = libm::sincos(rate * BEFORE_S);
            let (from, ahead) = (up * c - east * s, east * c + up * s);
            let (east_there, _, north_there) = sphere::east_up_north(from);
            let (lat_deg, lon_deg) = degrees(from);
            // The ground below will have turned on by then.
            let lon_deg = libm::remainder(lon_deg + body.spin.rate_rad_s() * BEFORE_S / DEG, 360.0);
            let heading_deg = libm::atan2(ahead.dot(east_there), ahead.dot(north_there)) / DEG;
            Place::Orbit { body: key.clone(), altitude_m, lat_deg, lon_deg, heading_deg }
        }
    };
    Some(StartSpec {
        key: format!("eclipse-of-{}-by-{}", body.key, system.body(event.by).key),
        name: title(system, event),
        description: String::new(),
        system: system.key.clone(),
        ship: ship.to_owned(),
        utc: iso(begin.utc()),
        place,
        // What is looked at: the caster.
        target: Some(TargetSpec { body: system.body(event.by).key.clone(), lat_deg: None, lon_deg: None }),
    })
}

/// `2026-08-12T17:30:00.5`.
pub fn iso(t: CivilTime) -> String {
    format!("{:04}-{:02}-{:02}T{:02}:{:02}:{:06.3}", t.year, t.month, t.day, t.hour, t.minute, t.second)
}
