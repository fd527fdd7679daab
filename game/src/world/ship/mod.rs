//! The ship: how it answers a stick. Everything here is plain data that a save mirrors field by field.
//!
//! Read [`flight`] for the order of one physical tick, then [`thrust`], [`aero`], [`attitude`] (what acts), [`guidance`]
//! (what flies it), [`warp`] (how far a coasting ship may be taken at once) and [`spec`] (what the asset file says).

pub mod aero;
pub mod attitude;
pub mod contact;
pub mod course;
pub mod flight;
pub mod guidance;
pub mod local;
pub mod nodes;
pub mod recorder;
pub mod spec;
pub mod thrust;
pub mod warp;

use super::system::System;
use crate::command::{Guidance, Hold, Node};
use engine::orbit::path::Path;
use engine::orbit::{BodyId, State};
use engine::space::{Centred, Fixed, Hull, Icrf, Position, Rotation, Vector};
use engine::time::SimTime;
use glam::{DQuat, DVec3};
use guidance::{Burn, Landing};
use spec::ShipSpec;
use std::sync::Arc;
use warp::Ahead;

/// A ship.
#[derive(Clone, Debug)]
pub struct Ship {
    /// What it is; shared, never changed by a tick.
    pub spec: Arc<ShipSpec>,
    /// How it moves at present.
    pub motion: Motion,
    /// Propellant left, kg.
    pub propellant_kg: f64,
    /// The pilot's throttle lever, 0 … 65535.
    pub throttle: u16,
    /// Where the nozzles point: 0 aft (pushes forward) … 1 down (lifts).
    pub nozzle: f64,
    /// Gear down?
    pub gear_down: bool,
    /// What the attitude controller holds.
    pub hold: Hold,
    /// The attitude (ICRF from hull) that [`Hold::Rate`] keeps once the rate has come to zero.
    pub held: Option<DQuat>,
    /// Who flies the throttle.
    pub guidance: Guidance,
    /// The landing programme, while [`Guidance::Land`] flies.
    pub landing: Option<Landing>,
    /// Planned burns, in order of time.
    pub nodes: Vec<Node>,
    /// The first of them as it is flown, once that is asked for.
    pub burn: Option<Burn>,
    /// What the engines did in the last physical tick.
    pub effort: Effort,
    /// Speed of the last touchdown or impact along the ground's normal, m/s, and when.
    pub last_contact: Option<(f64, SimTime)>,
    /// What it keeps about the ground near it.
    pub ground: contact::Ground,
}

/// What the engines did in a physical tick, for readout and sound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Main throttle in force, 0 … 1.
    pub throttle: f64,
    /// Strength of RCS firing, 0 … 1.
    pub rcs: f64,
    /// Felt acceleration (all but gravity), m/s².
    pub felt_m_s2: f64,
}

/// How the ship moves. The variant decides which subsystems run at all.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// No force but gravity: its path is sampled at each tick, never stepped by one.
    Coast(Coast),
    /// Thrust, air or turning: integrated at 60 Hz.
    Fly(Rigid),
    /// Near the ground: integrated at 60 Hz together with the contact bubble ([`flight::step`] gives the loads).
    Contact(Rigid),
    /// At rest on the ground, fixed in the body's turning axes.
    Landed(Resting),
    /// Broken, at rest where it lies.
    Crashed(Resting),
}

/// A rigid body's state about the dominating body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    /// The dominating body.
    pub body: BodyId,
    /// Position and velocity of the centre of mass.
    pub state: State<Centred>,
    /// Attitude.
    pub icrf_from_hull: Rotation<Icrf, Hull>,
    /// Angular velocity in hull axes, rad/s.
    pub rate: Vector<Hull>,
}

/// A coasting ship: path and attitude as functions of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Coast {
    /// The path; its present step says where the ship is now.
    pub path: Path,
    /// The attitude.
    pub attitude: CoastAttitude,
    /// Since when.
    pub since: SimTime,
    /// What the path comes to, as far as it has been followed ahead.
    pub ahead: Ahead,
}

impl Coast {
    /// A ship that coasts on `path` from now on.
    pub fn new(path: Path, attitude: CoastAttitude, since: SimTime) -> Self {
        Self { path, attitude, since, ahead: Ahead::default() }
    }
}

/// Attitude of a coasting ship, a pure function of the sampled state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoastAttitude {
    /// Turning at a constant rate since coasting began (inertial coupling is left out while coasting).
    Inertial {
        /// ICRF from hull then.
        icrf_from_hull: DQuat,
        /// Angular velocity in hull axes, rad/s.
        rate: DVec3,
    },
    /// Held to a direction of flight.
    Held {
        /// Which.
        hold: Hold,
        /// What the controller was off by when coasting began: `icrf_from_hull = reference · offset`.
        offset: DQuat,
    },
}

/// A ship at rest on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resting {
    /// The body.
    pub body: BodyId,
    /// Centre of mass in the body's turning axes.
    pub position: Position<Fixed>,
    /// Attitude in the body's turning axes.
    pub fixed_from_hull: Rotation<Fixed, Hull>,
}

impl Ship {
    /// A ship with full tanks, gear up, coasting or standing as `motion` says.
    pub fn new(spec: Arc<ShipSpec>, motion: Motion) -> Self {
        Self {
            propellant_kg: spec.mass.propellant_kg,
            gear_down: matches!(motion, Motion::Landed(_) | Motion::Crashed(_)),
            spec,
            motion,
            throttle: 0,
            nozzle: 0.0,
            hold: Hold::Rate,
            held: None,
            guidance: Guidance::Manual,
            landing: None,
            nodes: Vec::new(),
            burn: None,
            effort: Effort::default(),
            last_contact: None,
            ground: contact::Ground::default(),
        }
    }
    /// Mass now, kg.
    pub fn mass_kg(&self) -> f64 {
        self.spec.mass.dry_kg + self.propellant_kg
    }
    /// What the star's light takes off its pull on the ship now, m³/s².
    pub fn light_m3_s2(&self, system: &System) -> f64 {
        self.spec.light_m3_s2(self.mass_kg(), system)
    }
    /// Moments of inertia now, hull axes, kg·m².
    pub fn inertia_kg_m2(&self) -> DVec3 {
        self.spec.mass.inertia_kg_m2 * (self.mass_kg() / self.spec.full_mass_kg())
    }
    /// Delta-v left in the main engine, m/s [Tsiolkovsky 1903].
    pub fn delta_v_m_s(&self) -> f64 {
        self.spec.main_engine.exhaust_velocity_m_s * libm::log(self.mass_kg() / self.spec.mass.dry_kg)
    }
    /// The dominating body.
    pub fn body(&self) -> BodyId {
        match &self.motion {
            Motion::Coast(c) => c.path.host(),
            Motion::Fly(r) | Motion::Contact(r) => r.body,
            Motion::Landed(r) | Motion::Crashed(r) => r.body,
        }
    }
}
