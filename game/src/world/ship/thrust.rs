//! Thrust: what main engine and RCS push with in one tick, and what it costs.
//!
//! The nozzles of the main engine swing between aft and down, so that one engine serves cruise and lift; thrust passes
//! through the centre of mass at every nozzle angle (stated simplification). RCS translation draws from the same tanks.

use super::Ship;
use super::spec::ShipSpec;
use crate::command::Axes;
use core::f64::consts::FRAC_PI_2;
use engine::time::TICK_S;
use engine::units::DEG;
use glam::DVec3;

/// What pushes in one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Push {
    /// Force in hull axes, N.
    pub force: DVec3,
    /// Mass flow, kg/s.
    pub flow_kg_s: f64,
    /// Main throttle in force, 0 … 1.
    pub throttle: f64,
    /// Strength of RCS, 0 … 1.
    pub rcs: f64,
}

/// Direction of the main engine's push in hull axes for a nozzle setting (0 forward, 1 up).
pub fn direction(nozzle: f64) -> DVec3 {
    let (s, c) = libm::sincos(nozzle * FRAC_PI_2);
    DVec3::new(0.0, s, -c)
}

/// The nozzle setting after a tick of swinging towards `wanted`.
pub fn swing(spec: &ShipSpec, nozzle: f64, wanted: f64) -> f64 {
    let step = spec.main_engine.swivel_deg_s * DEG / FRAC_PI_2 * TICK_S;
    nozzle + (wanted - nozzle).clamp(-step, step)
}

/// Translation axes as a vector in hull axes, each component in [−1, 1].
pub fn translation(axes: Axes) -> DVec3 {
    DVec3::new(Axes::value(axes.right), Axes::value(axes.up), -Axes::value(axes.forward))
}

/// The push of one tick. When the tanks run dry within the tick, the push is scaled so that the impulse is that of the
/// propellant left.
pub fn push(ship: &Ship, throttle: f64, translation: DVec3) -> Push {
    let spec = &ship.spec;
    let throttle = throttle.clamp(0.0, 1.0);
    let main_n = throttle * spec.main_engine.thrust_n;
    let rcs = translation.clamp(DVec3::NEG_ONE, DVec3::ONE) * spec.rcs.thrust_n;
    let rcs_n = rcs.x.abs() + rcs.y.abs() + rcs.z.abs();
    let flow = main_n / spec.main_engine.exhaust_velocity_m_s + rcs_n / spec.rcs.exhaust_velocity_m_s;
    if flow <= 0.0 || ship.propellant_kg <= 0.0 {
        return Push::default();
    }
    let scale = (ship.propellant_kg / (flow * TICK_S)).min(1.0);
    Push {
        force: (direction(ship.nozzle) * main_n + rcs) * scale,
        flow_kg_s: flow * scale,
        throttle: throttle * scale,
        rcs: if spec.rcs.thrust_n > 0.0 { (rcs_n / spec.rcs.thrust_n).min(1.0) * scale } else { 0.0 },
    }
}

/// Takes a tick's flow out of the tanks; they end exactly empty.
pub fn consume(ship: &mut Ship, flow_kg_s: f64) {
    let left = ship.propellant_kg - flow_kg_s * TICK_S;
    ship.propellant_kg = if left > 1e-9 { left } else { 0.0 };
}
