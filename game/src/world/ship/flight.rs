//! Flight: one physical tick of 1/60 s for a ship that is integrated. What the pilot or the autopilot asks becomes
//! [`Controls`], controls become loads, loads move the hull.
//!
//! Gravity is that of the coasting ship, by the same choice of terms ([`engine::orbit::field`]): the dominating body as it is
//! flattened, and, taken once in a tick at its middle, the tides of all other bodies that count and the body's 1PN term.
//! Translation is Runge–Kutta of order 4 with thrust fixed in the hull (at its attitude half-way through the tick), mass
//! falling linearly, and gravity and air evaluated at each stage.

use super::attitude::{self, Demand, Plant, Turn};
use super::local::{self, Local, pull};
use super::{Effort, Rigid, Ship, aero, guidance, thrust};
use crate::command::{Axes, Guidance, Hold, Target};
use engine::orbit::State;
use engine::orbit::gravity::relativity::schwarzschild;
use engine::orbit::gravity::tide;
use engine::space::{Centred, Position, Rotation, Vector, Velocity};
use engine::time::{Moment, TICK_S};
use engine::units::DEG;
use glam::{DQuat, DVec3};

/// What a tick is flown with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// For the attitude controller.
    pub demand: Demand,
    /// Main throttle, 0 … 1.
    pub throttle: f64,
    /// Where the nozzles should point, 0 aft … 1 down.
    pub nozzle: f64,
    /// RCS translation, hull axes, each −1 … 1.
    pub translation: DVec3,
}

/// Everything but gravity and the ground that acts in one tick, for the contact bubble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loads {
    /// Force at the start of the tick (thrust and air), hull axes, N.
    pub force: DVec3,
    /// Moment, hull axes, N·m.
    pub torque: DVec3,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moments of inertia, hull axes, kg·m².
    pub inertia_kg_m2: DVec3,
}

/// What [`step`] did besides moving the ship.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    /// The rigid body at the end of the tick, moved without ground.
    pub free: Rigid,
    /// What acted, for a caller that moves the body itself.
    pub loads: Loads,
    /// Nothing pushes and the attitude is as asked: the path may be sampled from now on.
    pub quiet: bool,
}

/// The controls that pilot and hold ask for. With the gear down, or held level, the nozzles lift; else they push forward.
fn manual(ship: &Ship, local: &Local, rigid: &Rigid, axes: Axes, target: Option<Target>) -> Controls {
    Controls {
        demand: stick(ship, local, rigid, axes, target),
        throttle: f64::from(ship.throttle) / f64::from(u16::MAX),
        nozzle: if ship.gear_down || ship.hold == Hold::SurfaceVertical { 1.0 } else { 0.0 },
        translation: thrust::translation(axes),
    }
}

/// The attitude demand of stick and hold: a deflected stick always commands a rate; released, the hold takes over again.
fn stick(ship: &Ship, local: &Local, rigid: &Rigid, axes: Axes, target: Option<Target>) -> Demand {
    let stick = DVec3::new(Axes::value(axes.pitch), Axes::value(axes.yaw), -Axes::value(axes.roll));
    if stick != DVec3::ZERO {
        return Demand::Rate(stick * ship.spec.attitude.max_rate_deg_s * DEG);
    }
    match ship.hold {
        Hold::Free => Demand::Free,
        Hold::KillRotation => Demand::Rate(DVec3::ZERO),
        Hold::Rate => ship.held.map_or(Demand::Rate(DVec3::ZERO), |reference| Demand::Point { reference, rate: DVec3::ZERO }),
        Hold::Node => ship.burn.as_ref().map_or(Demand::Rate(DVec3::ZERO), |b| b.point(rigid)),
        hold => point(hold, local, rigid, target),
    }
}

/// Points along a hold, its own turning fed forward from where it will point one tick later.
fn point(hold: Hold, local: &Local, rigid: &Rigid, target: Option<Target>) -> Demand {
    let attitude = rigid.icrf_from_hull.0;
    let Some(reference) = attitude::reference(hold, local, target, attitude) else {
        return Demand::Rate(DVec3::ZERO);
    };
    let velocity = local.v + local.gravity() * TICK_S;
    let next_state = State { position: Position::new(local.r + velocity * TICK_S), velocity: Velocity::new(velocity) };
    let next = Local::new(local.system, local.time.plus(1), local.id, &next_state);
    let rate = attitude::reference(hold, &next, target, reference)
        .map_or(DVec3::ZERO, |q| attitude::rotation_vector(reference.conjugate() * q) / TICK_S);
    Demand::Point { reference, rate }
}

/// One physical tick without ground: changes the ship's tanks, nozzles and effort, and says where the hull would be.
pub fn step(ship: &mut Ship, local: &Local, rigid: &Rigid, axes: Axes, target: Option<Target>) -> Stepped {
    guidance::burn::ensure(ship, local);
    let controls = match ship.guidance {
        Guidance::Manual => manual(ship, local, rigid, axes, target),
        _ => guidance::controls(ship, local, rigid, axes, target),
    };
    ship.nozzle = thrust::swing(&ship.spec, ship.nozzle, controls.nozzle);
    let push = thrust::push(ship, controls.throttle, controls.translation);
    let mass = ship.mass_kg();
    let inertia = ship.inertia_kg_m2();
    let hull_velocity = rigid.icrf_from_hull.0.conjugate() * local.v_surface;
    let air = aero::load(&ship.spec.aero, local.air.density_kg_m3, hull_velocity, rigid.rate.0);
    let plant = Plant {
        attitude: rigid.icrf_from_hull.0,
        rate: rigid.rate.0,
        inertia,
        torque: ship.spec.attitude.torque_n_m + DVec3::splat(air.control),
        disturbance: air.moment,
        max_rate: ship.spec.attitude.max_rate_deg_s * DEG,
    };
    let turn = attitude::turn(&plant, controls.demand);
    follow_hold(ship, axes, &turn);
    let force = push.force + air.force;
    ship.effort = Effort { throttle: push.throttle, rcs: push.rcs, felt_m_s2: force.length() / mass };
    let free = Rigid {
        body: rigid.body,
        state: translate(ship, local, rigid, &turn, push),
        icrf_from_hull: Rotation::new(turn.attitude),
        rate: Vector::new(turn.rate),
    };
    guidance::burn::spend(ship, local, turn.mid_attitude * push.force, push.flow_kg_s);
    thrust::consume(ship, push.flow_kg_s);
    let swinging = ship.nozzle != controls.nozzle;
    let quiet = turn.settled && push.flow_kg_s == 0.0 && !swinging && air.force == DVec3::ZERO && !stirred(ship, axes);
    Stepped { free, loads: Loads { force, torque: turn.torque + air.moment, mass_kg: mass, inertia_kg_m2: inertia }, quiet }
}

/// Takes note of what the stick did to the hold: a rate killed, an attitude to keep from now on.
fn follow_hold(ship: &mut Ship, axes: Axes, turn: &Turn) {
    let stick = axes.pitch != 0 || axes.yaw != 0 || axes.roll != 0;
    if ship.hold == Hold::KillRotation && turn.settled && !stick {
        ship.hold = Hold::Rate;
        ship.held = Some(turn.attitude);
    } else if ship.hold != Hold::Rate || stick || ship.guidance != Guidance::Manual {
        ship.held = None;
    } else if ship.held.is_none() && turn.rate == DVec3::ZERO {
        ship.held = Some(turn.attitude);
    }
}

/// Moves the centre of mass through one tick.
fn translate(ship: &Ship, local: &Local, rigid: &Rigid, turn: &Turn, push: thrust::Push) -> State<Centred> {
    let (mass, pole) = (ship.mass_kg(), local.icrf_from_fixed.raw(DVec3::Z));
    let far = far(local);
    let hull: DQuat = turn.mid_attitude;
    let thrust_force = hull * push.force;
    let column = local.body.air.as_ref();
    let acceleration = |t: f64, r: DVec3, v: DVec3| {
        let mut force = thrust_force;
        if let Some(column) = column {
            let density = column.at(r.length() - local.body.radius_m).density_kg_m3;
            if density > 0.0 {
                let flow = hull.conjugate() * (v - local.spin.cross(r));
                force += hull * aero::load(&ship.spec.aero, density, flow, turn.rate).force;
            }
        }
        pull(local.body, pole, r) + far + force / (mass - push.flow_kg_s * t)
    };
    let (r0, v0, h) = (rigid.state.position.0, rigid.state.velocity.0, TICK_S);
    let a1 = acceleration(0.0, r0, v0);
    let (r2, v2) = (r0 + v0 * (0.5 * h), v0 + a1 * (0.5 * h));
    let a2 = acceleration(0.5 * h, r2, v2);
    let (r3, v3) = (r0 + v2 * (0.5 * h), v0 + a2 * (0.5 * h));
    let a3 = acceleration(0.5 * h, r3, v3);
    let (r4, v4) = (r0 + v3 * h, v0 + a3 * h);
    let a4 = acceleration(h, r4, v4);
    State {
        position: Position::new(r0 + (v0 + (v2 + v3) * 2.0 + v4) * (h / 6.0)),
        velocity: Velocity::new(v0 + (a1 + (a2 + a3) * 2.0 + a4) * (h / 6.0)),
    }
}

/// What pulls on the ship besides the dominating body's Newtonian gravity, m/s², half-way through the tick: over a tick it
/// changes by 1e-5 of itself at most.
fn far(local: &Local) -> DVec3 {
    let Some(field) = local.system.gravity.field(local.id) else { return DVec3::ZERO };
    let middle = Moment { tick: local.time, beyond_s: 0.5 * TICK_S };
    let here = Position::<Centred>::new(local.r + local.v * (0.5 * TICK_S));
    let distance = local.r.length();
    let terms = field.terms(distance, distance);
    let mut sum = DVec3::ZERO;
    if terms.relativity {
        sum += schwarzschild(local.body.gm_m3_s2, here, Velocity::new(local.v)).0;
    }
    for p in &field.perturbers[..terms.perturbers] {
        let place = local.system.ephemeris.relative_at(p.body, local.id, middle).position.0;
        sum += tide(p.gm_with_moons(distance), Position::new(place), here).0;
    }
    sum
}

/// True when a ship that is sampled or rests must be integrated from now on: something pushes or turns it.
pub fn stirred(ship: &Ship, axes: Axes) -> bool {
    let fuelled = ship.propellant_kg > 0.0;
    let translating = axes.right != 0 || axes.up != 0 || axes.forward != 0;
    let turning = axes.pitch != 0 || axes.yaw != 0 || axes.roll != 0;
    match ship.guidance {
        Guidance::Manual => ((ship.throttle > 0 || translating) && fuelled) || turning,
        Guidance::Hover | Guidance::VerticalSpeed { .. } => true,
        Guidance::Land => !ship.landing.as_ref().is_some_and(guidance::Landing::coasts),
        Guidance::Node => ship.burn.as_ref().is_none_or(|b| b.wake().is_none()),
    }
}

/// Height of the ground below the ship above the datum, m; the datum itself where the ground cannot be near.
pub fn surface_below_m(local: &Local) -> f64 {
    if local.altitude_m > super::warp::floor_m(local.body).max(20_000.0) {
        0.0
    } else {
        local::ground_m(local.body, local.direction_fixed())
    }
}
