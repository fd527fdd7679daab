//! Attitude: directions to hold, and the controller that turns the hull there by torque.
//!
//! The controller knows inertia and disturbance exactly (it is part of the simulated ship), so its inner loop asks for
//! the torque that reaches the wanted rate within the tick, cut to what wheels, thrusters and control surfaces give.
//! The outer loop approaches an attitude along `ω = min(k·e, √(2α(e − α/2k²)))`: at seven tenths of the
//! available deceleration, therefore without overshoot. A rate that is reached is reached exactly: no limit cycle remains.

use super::local::Local;
use crate::command::{Hold, Target};
use crate::world::system::System;
use engine::orbit::BodyId;
use engine::space::sphere;
use engine::time::{SimTime, TICK_S};
use engine::units::DEG;
use glam::{DMat3, DQuat, DVec3};

/// Gain of the linear part of the approach, 1/s.
const GAIN_PER_S: f64 = 4.0;
/// Attitude error under which the hull counts as settled, rad.
const SETTLED_RAD: f64 = 1.0e-3;
/// Rate error under which the hull counts as settled, rad/s.
const SETTLED_RAD_S: f64 = 1.0e-3;

/// What the controller is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Nothing: torque-free.
    Free,
    /// A turn rate, hull axes, rad/s.
    Rate(DVec3),
    /// An attitude that itself turns at a rate (hull axes of that attitude, rad/s).
    Point {
        /// ICRF from hull.
        reference: DQuat,
        /// Its rate.
        rate: DVec3,
    },
}

/// One hull at one instant, as the controller sees it.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    /// ICRF from hull.
    pub attitude: DQuat,
    /// Hull axes, rad/s.
    pub rate: DVec3,
    /// Moments of inertia, kg·m².
    pub inertia: DVec3,
    /// Torque limits, N·m.
    pub torque: DVec3,
    /// Moment by other causes (air), N·m.
    pub disturbance: DVec3,
    /// Largest rate for an approach, rad/s.
    pub max_rate: DVec3,
}

/// The outcome of a tick of control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Control torque, hull axes, N·m.
    pub torque: DVec3,
    /// Rate at the end of the tick.
    pub rate: DVec3,
    /// Attitude at the end of the tick.
    pub attitude: DQuat,
    /// Attitude half-way, for forces fixed in the hull.
    pub mid_attitude: DQuat,
    /// True when demand and hull agree within the dead band.
    pub settled: bool,
}

/// Turns the hull for one tick.
pub fn turn(plant: &Plant, demand: Demand) -> Turn {
    let Plant { attitude, rate, inertia, torque: limit, disturbance, .. } = *plant;
    // Euler's equation: I ω̇ = τ − ω × Iω.
    let free = |w: DVec3| (disturbance - w.cross(inertia * w)) / inertia;
    let (wanted, settled) = match demand {
        Demand::Free => {
            let mid = rate + free(rate) * (0.5 * TICK_S);
            let next = rate + free(mid) * TICK_S;
            return finish(plant, DVec3::ZERO, next, true);
        }
        Demand::Rate(wanted) => (wanted, (rate - wanted).length() < SETTLED_RAD_S),
        Demand::Point { reference, rate: reference_rate } => {
            let error = rotation_vector(attitude.conjugate() * reference);
            let carried = exp(error) * reference_rate;
            (carried + approach(plant, error), error.length() < SETTLED_RAD && (rate - carried).length() < SETTLED_RAD_S)
        }
    };
    let asked = (wanted - rate) / TICK_S * inertia - (disturbance - rate.cross(inertia * rate));
    let torque = asked.clamp(-limit, limit);
    // A rate within reach is reached exactly, bit for bit.
    let next = rate + ((torque - asked) / inertia) * TICK_S + (wanted - rate);
    let exact = DVec3::select(torque.cmpeq(asked), wanted, next);
    finish(plant, torque, exact, settled)
}

fn finish(plant: &Plant, torque: DVec3, rate: DVec3, settled: bool) -> Turn {
    let mean = (plant.rate + rate) * 0.5;
    Turn {
        torque,
        rate,
        attitude: advance(plant.attitude, mean, TICK_S),
        mid_attitude: advance(plant.attitude, (plant.rate + mean) * 0.5, 0.5 * TICK_S),
        settled,
    }
}

/// The rate at which to close an attitude error (rotation vector, hull axes).
fn approach(plant: &Plant, error: DVec3) -> DVec3 {
    let angle = error.length();
    if angle < 1e-12 {
        return DVec3::ZERO;
    }
    let axis = error / angle;
    let share = axis.abs().max(DVec3::splat(1e-6));
    let alpha = 0.7 * (plant.torque / plant.inertia / share).min_element();
    let linear = alpha / (GAIN_PER_S * GAIN_PER_S);
    let speed = if angle < linear { GAIN_PER_S * angle } else { (2.0 * alpha * (angle - 0.5 * linear)).sqrt() };
    axis * speed.min((plant.max_rate / share).min_element())
}

/// The quaternion of a rotation vector (rad).
pub fn exp(v: DVec3) -> DQuat {
    let angle = v.length();
    // Below this, sin(x/2)/x = 1/2 to the last bit.
    let k = if angle < 1e-9 { 0.5 } else { libm::sin(0.5 * angle) / angle };
    DQuat::from_xyzw(v.x * k, v.y * k, v.z * k, libm::cos(0.5 * angle))
}

/// The rotation vector of a unit quaternion, the short way (rad).
pub fn rotation_vector(q: DQuat) -> DVec3 {
    let q = if q.w < 0.0 { -q } else { q };
    let v = DVec3::new(q.x, q.y, q.z);
    let s = v.length();
    if s < 1e-12 { v * 2.0 } else { v * (2.0 * libm::atan2(s, q.w) / s) }
}

/// An attitude after turning at a constant rate (hull axes, rad/s).
pub fn advance(attitude: DQuat, rate: DVec3, dt_s: f64) -> DQuat {
    if rate == DVec3::ZERO { attitude } else { (attitude * exp(rate * dt_s)).normalize() }
}

/// The attitude (ICRF from hull) with the nose along `nose` and the roof as near to `roof` as that allows.
pub fn look(nose: DVec3, roof: DVec3) -> DQuat {
    let back = -nose.normalize_or(DVec3::NEG_Z);
    let spare = if back.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let right = roof.cross(back).normalize_or(spare.cross(back).normalize_or(DVec3::X));
    DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back)).normalize()
}

/// The attitude with the roof along `roof`, reached from `attitude` by the smallest turn.
pub fn raise_roof(attitude: DQuat, roof: DVec3) -> DQuat {
    (arc(attitude * DVec3::Y, roof, attitude * DVec3::X) * attitude).normalize()
}

/// The smallest rotation that takes unit vector `from` to `to`; about `spare` where they oppose.
pub fn arc(from: DVec3, to: DVec3, spare: DVec3) -> DQuat {
    let to = to.normalize_or(from);
    let cross = from.cross(to);
    let (s, c) = (cross.length(), from.dot(to));
    if s < 1e-9 {
        return if c > 0.0 { DQuat::IDENTITY } else { DQuat::from_xyzw(spare.x, spare.y, spare.z, 0.0) };
    }
    exp(cross * (libm::atan2(s, c) / s))
}

/// The attitude that a hold asks for; `None` for those that follow the stick, or where the direction is undefined.
/// [`Hold::SurfaceVertical`] gives nose along the ground track here; its heading is free, see [`reference`].
pub fn hold_frame(hold: Hold, local: &Local, target: Option<Target>) -> Option<DQuat> {
    let along = |nose: DVec3| (nose.length_squared() > 1e-12).then(|| look(nose, local.up));
    let normal = local.r.cross(local.v);
    let radial = local.v.cross(normal);
    let flat = |nose: DVec3| (normal.length_squared() > 1e-6).then(|| look(nose, local.v));
    match hold {
        // The burn's direction stands still: see `guidance::burn`.
        Hold::Rate | Hold::Free | Hold::KillRotation | Hold::Node => None,
        Hold::Prograde => along(local.v),
        Hold::Retrograde => along(-local.v),
        Hold::Normal => along(normal),
        Hold::AntiNormal => along(-normal),
        Hold::RadialOut => flat(radial),
        Hold::RadialIn => flat(-radial),
        Hold::SurfacePrograde => along(local.v_surface),
        Hold::SurfaceRetrograde => along(-local.v_surface),
        Hold::SurfaceVertical => {
            let level = local.v - local.up * local.v.dot(local.up);
            let (_, _, north) = sphere::east_up_north(local.direction_fixed());
            Some(look(level.normalize_or(local.icrf_from_fixed.raw(north)), local.up))
        }
        Hold::Target => target.and_then(|t| along(target_offset(local.system, local, local.time, t))),
    }
}

/// The attitude that the controller steers to: [`hold_frame`], with the present heading kept for the vertical hold.
pub fn reference(hold: Hold, local: &Local, target: Option<Target>, attitude: DQuat) -> Option<DQuat> {
    if hold == Hold::SurfaceVertical { Some(raise_roof(attitude, local.up)) } else { hold_frame(hold, local, target) }
}

/// Vector from the ship to its target, ICRF axes, m.
pub fn target_offset(system: &System, local: &Local, time: SimTime, target: Target) -> DVec3 {
    let centre = offset_of_body(system, local.id, target.body, time);
    let spot = target.spot.map_or(DVec3::ZERO, |spot| {
        let body = system.body(target.body);
        let fixed = spot_direction(spot);
        body.spin.icrf_from_fixed(time).raw(fixed * (body.radius_m + super::local::ground_m(body, fixed)))
    });
    centre + spot - local.r
}

/// Position of `body` from the centre of `host`, ICRF axes, m.
pub fn offset_of_body(system: &System, host: BodyId, body: BodyId, time: SimTime) -> DVec3 {
    system.ephemeris.relative(body, host, time).position.0
}

/// Unit direction of a spot in the body's turning axes.
pub fn spot_direction(spot: crate::command::Spot) -> DVec3 {
    sphere::direction_of_lat_lon(f64::from(spot.lat_udeg) * 1e-6 * DEG, f64::from(spot.lon_udeg) * 1e-6 * DEG)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settle(mut plant: Plant, demand: Demand) -> (Plant, f64, Vec<f64>) {
        let mut angles = Vec::new();
        for tick in 0..3600 {
            let t = turn(&plant, demand);
            (plant.attitude, plant.rate) = (t.attitude, t.rate);
            if let Demand::Point { reference, .. } = demand {
                angles.push(rotation_vector(plant.attitude.conjugate() * reference).length());
            }
            if t.settled {
                return (plant, f64::from(tick) * TICK_S, angles);
            }
        }
        panic!("did not settle");
    }

    fn plant() -> Plant {
        Plant {
            attitude: DQuat::IDENTITY,
            rate: DVec3::ZERO,
            inertia: DVec3::new(4e5, 5e5, 1e5),
            torque: DVec3::new(3e5, 3e5, 1e5),
            disturbance: DVec3::ZERO,
            max_rate: DVec3::splat(0.5),
        }
    }

    #[test]
    fn pointing_settles_without_overshoot() {
        for axis in [DVec3::X, DVec3::new(0.6, -0.48, 0.64)] {
            let reference = exp(axis * 2.5);
            let (_, seconds, angles) = settle(plant(), Demand::Point { reference, rate: DVec3::ZERO });
            assert!(seconds < 12.0, "{seconds} s");
            assert!(angles.windows(2).all(|w| w[1] <= w[0] + 1e-9), "the error only shrinks");
        }
    }

    #[test]
    fn a_rate_that_is_killed_is_exactly_zero() {
        let tumbling = Plant { rate: DVec3::new(0.3, -0.7, 1.1), ..plant() };
        let (mut p, _, _) = settle(tumbling, Demand::Rate(DVec3::ZERO));
        for _ in 0..2 {
            p.rate = turn(&p, Demand::Rate(DVec3::ZERO)).rate;
        }
        assert_eq!(p.rate, DVec3::ZERO);
    }

    #[test]
    fn free_rotation_keeps_energy_and_momentum() {
        let mut p = Plant { rate: DVec3::new(0.05, 0.3, 0.1), ..plant() };
        let energy = |p: &Plant| 0.5 * p.rate.dot(p.inertia * p.rate);
        let momentum = |p: &Plant| p.attitude * (p.inertia * p.rate);
        let (e0, l0) = (energy(&p), momentum(&p));
        for _ in 0..3600 {
            let t = turn(&p, Demand::Free);
            (p.attitude, p.rate) = (t.attitude, t.rate);
        }
        assert!((energy(&p) / e0 - 1.0).abs() < 1e-5);
        assert!((momentum(&p) - l0).length() / l0.length() < 1e-3);
    }

    #[test]
    fn look_puts_nose_and_roof_where_asked() {
        let q = look(DVec3::new(1.0, 2.0, 2.0), DVec3::Z);
        assert!((q * DVec3::NEG_Z - DVec3::new(1.0, 2.0, 2.0) / 3.0).length() < 1e-15 * 4.0);
        assert!((q * DVec3::Y).z > 0.7 && (q * DVec3::X).z.abs() < 1e-15 * 4.0);
        let raised = raise_roof(q, DVec3::Z);
        assert!((raised * DVec3::Y - DVec3::Z).length() < 1e-14);
    }
}
