//! Guidance: what flies the throttle in place of the pilot. Hover and vertical speed are here; the automatic landing is a
//! programme of phases, see [`Landing`]; so is a planned burn, see [`Burn`].
//!
//! All of it runs in the physical tick, from the state alone, so it is the same at every warp and in every replay.
//! Lift comes from the nozzles turned down; the roof points along the wanted push, never further than a tilt limit from
//! the zenith while hovering.

pub mod burn;
pub mod landing;
pub mod plan;

use super::attitude::{self, Demand};
use super::flight::Controls;
use super::local::Local;
use super::{Rigid, Ship, thrust};
use crate::command::{Axes, Guidance, Target};
pub use burn::Burn;
use engine::units::DEG;
use glam::DVec3;
pub use landing::{Landing, Phase};

/// Largest tilt of the roof from the zenith while hovering, rad.
const HOVER_TILT_RAD: f64 = 30.0 * DEG;
/// Cosine of the angle between roof and wanted push beyond which the engine is silent.
const READY: f64 = 0.9;

/// The controls of a tick under guidance.
pub fn controls(ship: &mut Ship, local: &Local, rigid: &Rigid, axes: Axes, target: Option<Target>) -> Controls {
    match ship.guidance {
        Guidance::Land => landing::controls(ship, local, rigid, target),
        Guidance::Node => burn::controls(ship, local, rigid),
        Guidance::VerticalSpeed { cm_s } => hover(ship, local, rigid, axes, f64::from(cm_s) * 0.01),
        Guidance::Hover | Guidance::Manual => hover(ship, local, rigid, axes, 0.0),
    }
}

/// Holds a rate of climb and brings the horizontal speed to zero; the stick still turns the heading.
fn hover(ship: &Ship, local: &Local, rigid: &Rigid, axes: Axes, climb_m_s: f64) -> Controls {
    let limit = 0.9 * ship.spec.main_engine.thrust_n / ship.mass_kg();
    let gravity = local.gravity().length();
    let level = local.v_surface - local.up * local.v_surface.dot(local.up);
    let reach = libm::tan(HOVER_TILT_RAD) * gravity.max(0.2 * limit);
    let sideways = (-level / 3.0).clamp_length_max(reach);
    let upwards = ((climb_m_s - local.vertical_m_s()) / 0.7).clamp(-gravity, limit);
    let push = sideways + local.up * upwards - weight(local);
    let lift = push.dot(local.up).max(gravity.max(0.2 * limit));
    let yaw = Axes::value(axes.yaw) * ship.spec.attitude.max_rate_deg_s.y * DEG;
    Controls { translation: thrust::translation(axes), ..fly_along(ship, local, rigid, push, sideways + local.up * lift, yaw) }
}

/// What the engine must carry for level flight at the present speed, m/s², pointing down: gravity less the centrifugal
/// acceleration of the horizontal (inertial) velocity.
pub fn weight(local: &Local) -> DVec3 {
    let level = local.v - local.up * local.v.dot(local.up);
    local.gravity() + local.up * (level.length_squared() / local.r.length().max(1.0))
}

/// Points the roof along `roof` and throttles so that the push along the roof is what `push` (m/s², ICRF axes) asks for,
/// less what the air does already. The engine is silent while the roof is far off. `yaw_rad_s` turns about the roof.
pub fn fly_along(ship: &Ship, local: &Local, rigid: &Rigid, push: DVec3, roof: DVec3, yaw_rad_s: f64) -> Controls {
    let q = rigid.icrf_from_hull.0;
    let air = super::aero::load(&ship.spec.aero, local.air.density_kg_m3, q.conjugate() * local.v_surface, DVec3::ZERO);
    let now = q * DVec3::Y;
    let wanted = roof.normalize_or(now);
    let push_n = (push * ship.mass_kg() - q * air.force).dot(now);
    let ready = now.dot(wanted) > READY && ship.nozzle > 0.95;
    let throttle = if ready { (push_n / ship.spec.main_engine.thrust_n).clamp(0.0, 1.0) } else { 0.0 };
    let reference = attitude::raise_roof(q, wanted);
    Controls { demand: Demand::Point { reference, rate: DVec3::Y * yaw_rad_s }, throttle, nozzle: 1.0, translation: DVec3::ZERO }
}
