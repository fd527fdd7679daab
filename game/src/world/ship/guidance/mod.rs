//! Guidance: what flies the throttle in place of the pilot. Hover and vertical speed are here; the automatic landing is a
//! programme of phases, see [`Landing`].
//!
//! All of it runs in the physical tick, from the state alone, so it is the same at every warp and in every replay.
//! Lift comes from the nozzles turned down; the roof points along the wanted push, never further than a tilt limit from
//! the zenith near the ground.

pub mod landing;

use super::attitude::{self, Demand};
use super::flight::Controls;
use super::local::Local;
use super::{Rigid, Ship, thrust};
use crate::command::{Axes, Guidance, Target};
use engine::units::DEG;
use glam::DVec3;
pub use landing::{Landing, Phase};

/// Largest tilt of the roof from the zenith while hovering, rad.
const HOVER_TILT_RAD: f64 = 30.0 * DEG;

/// The controls of a tick under guidance.
pub fn controls(ship: &mut Ship, local: &Local, rigid: &Rigid, axes: Axes, target: Option<Target>) -> Controls {
    match ship.guidance {
        Guidance::Land => landing::controls(ship, local, rigid, target),
        Guidance::VerticalSpeed { cm_s } => hover(ship, local, rigid, axes, f64::from(cm_s) * 0.01),
        Guidance::Hover | Guidance::Manual => hover(ship, local, rigid, axes, 0.0),
    }
}

/// Holds a rate of climb and brings the horizontal speed to zero; the stick still turns the heading.
fn hover(ship: &Ship, local: &Local, rigid: &Rigid, axes: Axes, climb_m_s: f64) -> Controls {
    let limit = 0.9 * ship.spec.main_engine.thrust_n / ship.mass_kg();
    let level = local.v_surface - local.up * local.v_surface.dot(local.up);
    let sideways = (-level / 2.0).clamp_length_max(0.4 * limit);
    let upwards = ((climb_m_s - local.vertical_m_s()) / 0.7).clamp(-0.5 * limit, limit);
    let push = sideways + local.up * upwards - weight(local);
    let yaw = Axes::value(axes.yaw) * ship.spec.attitude.max_rate_deg_s.y * DEG;
    Controls { translation: thrust::translation(axes), ..fly_along(ship, local, rigid, push, HOVER_TILT_RAD, yaw) }
}

/// Acceleration that gravity and the curve of the path ask the engine to carry, m/s², pointing down: gravity less the
/// centrifugal acceleration of the velocity over the turning ground's inertial motion.
pub fn weight(local: &Local) -> DVec3 {
    let level = local.v - local.up * local.v.dot(local.up);
    let radius = local.r.length().max(1.0);
    local.gravity() + local.up * (level.length_squared() / radius)
}

/// Points the roof along `push` (m/s², ICRF axes), within `tilt` of the zenith, and throttles by what of it lies along the
/// roof now. `yaw_rad_s` turns about the roof.
pub fn fly_along(ship: &Ship, local: &Local, rigid: &Rigid, push: DVec3, tilt: f64, yaw_rad_s: f64) -> Controls {
    let air =
        super::aero::load(&ship.spec.aero, local.air.density_kg_m3, rigid.icrf_from_hull.0.conjugate() * local.v_surface, DVec3::ZERO);
    // What the air does already need not be thrust.
    let push = push - rigid.icrf_from_hull.0 * air.force / ship.mass_kg();
    let roof = within(local.up, push, tilt);
    let now = rigid.icrf_from_hull.0 * DVec3::Y;
    let along = push.dot(now);
    let agreement = now.dot(roof);
    let throttle = if agreement > 0.5 && ship.nozzle > 0.9 { along * ship.mass_kg() / ship.spec.main_engine.thrust_n } else { 0.0 };
    let reference = attitude::raise_roof(rigid.icrf_from_hull.0, roof);
    let demand = Demand::Point { reference, rate: DVec3::Y * yaw_rad_s };
    Controls { demand, throttle: throttle.clamp(0.0, 1.0), nozzle: 1.0, translation: DVec3::ZERO }
}

/// The direction of `push`, bent towards `up` until it lies within `tilt` of it.
pub fn within(up: DVec3, push: DVec3, tilt: f64) -> DVec3 {
    let level = push - up * push.dot(up);
    let (height, width) = (push.dot(up), level.length());
    if width < 1e-9 || libm::atan2(width, height) <= tilt {
        return if tilt < core::f64::consts::PI && height <= 0.0 && width < 1e-9 { up } else { push.normalize_or(up) };
    }
    let (s, c) = libm::sincos(tilt);
    up * c + level * (s / width)
}
