//! The readout: plain numbers about the ship, for the HUD, the sound and tests. Nothing here is kept or saved.
//!
//! What is told is here; how it is found is in [`super::observe`].

use super::eclipse::almanac::Event;
use crate::command::{Guidance, Hold, Target};
use engine::orbit::BodyId;
use engine::time::SimTime;
use glam::{DQuat, DVec3};

/// How the ship moves at present; it decides which subsystems run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Situation {
    /// No force but gravity: the path is sampled, not integrated.
    Coasting,
    /// Thrust or air: integrated at 60 Hz.
    Flying,
    /// Near the ground: the contact bubble exists.
    Contact,
    /// At rest on the ground.
    Landed,
    /// Broken on impact.
    Crashed,
}

/// Things the pilot should be told, worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Warning {
    /// The hull broke.
    Crashed,
    /// Ground ahead within seconds at an unsafe speed.
    PullUp,
    /// Heat flux beyond what the hull bears.
    Heat,
    /// Dynamic pressure beyond what the hull bears.
    Overpressure,
    /// Acceleration beyond what the crew bears.
    OverG,
    /// Gear is up near the ground.
    GearUp,
    /// Propellant under 5 %.
    Propellant,
    /// Warp was lowered by itself (ground, air or a sphere of influence is near).
    WarpLowered,
}

/// Osculating orbit about the dominating body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OrbitReadout {
    /// Altitude of apoapsis above the datum, m; infinite on an escape path.
    pub apoapsis_m: f64,
    /// Altitude of periapsis above the datum, m (negative: the path meets the ground).
    pub periapsis_m: f64,
    /// Period, s; infinite on an escape path.
    pub period_s: f64,
    /// Eccentricity.
    pub eccentricity: f64,
    /// Inclination to the body's equator, rad.
    pub inclination_rad: f64,
    /// Seconds to the next apoapsis (infinite if none).
    pub to_apoapsis_s: f64,
    /// Seconds to the next periapsis (negative when past it on an escape path).
    pub to_periapsis_s: f64,
}

/// Unit directions worth a marker, in hull axes (+X right, +Y up, −Z forward). Zero where undefined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Markers {
    /// Along the orbital velocity.
    pub prograde: DVec3,
    /// Along the velocity over the ground.
    pub surface_prograde: DVec3,
    /// Along the orbit normal.
    pub normal: DVec3,
    /// Radial out.
    pub radial_out: DVec3,
    /// The local zenith.
    pub zenith: DVec3,
    /// Local north in the horizontal plane.
    pub north: DVec3,
    /// Towards the target; zero if none.
    pub target: DVec3,
    /// Along the next planned burn; zero until something asks for it.
    pub node: DVec3,
    /// Towards the star.
    pub sun: DVec3,
}

/// Where the target is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetReadout {
    /// What it is.
    pub target: Target,
    /// Straight distance, m.
    pub distance_m: f64,
    /// Rate of change of that distance, m/s (negative: closing).
    pub closing_m_s: f64,
    /// Distance over the ground to the spot, m, when it is on the dominating body.
    pub ground_distance_m: Option<f64>,
}

/// The eclipse in force or next to come on the dominating body, within some days.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EclipseReadout {
    /// Whose shadow falls on whom, and how.
    pub event: Event,
    /// Seconds until the penumbra first touches the body (negative: it does).
    pub to_first_s: f64,
    /// Seconds until it is greatest.
    pub to_greatest_s: f64,
    /// Seconds until the penumbra leaves.
    pub to_last_s: f64,
}

/// The next planned burn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeReadout {
    /// Planned burns in all.
    pub count: usize,
    /// Seconds to the node (negative: it has passed).
    pub to_node_s: f64,
    /// Seconds to the start of the burn.
    pub to_burn_s: f64,
    /// How long the main engine burns for what is left, s.
    pub burn_s: f64,
    /// Size of the burn as planned, m/s.
    pub dv_m_s: f64,
    /// What is left of it, m/s.
    pub left_m_s: f64,
}

/// Everything the HUD shows and the sound follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Readout {
    /// Simulated time.
    pub time: SimTime,
    /// Index into [`crate::command::WARP_QUARTERS`] in force, and the one asked for.
    pub warp: u8,
    /// The level that the pilot asked for (may be above `warp` while the world holds it down).
    pub warp_asked: u8,
    /// The dominating body.
    pub body: BodyId,
    /// How the ship moves.
    pub situation: Situation,
    /// Altitude above the datum (sea level), m.
    pub altitude_m: f64,
    /// Height of the ground below, above the datum, m (sea floor counts as 0 where there is water).
    pub ground_m: f64,
    /// Planetocentric latitude and east longitude, rad.
    pub lat_lon_rad: (f64, f64),
    /// Speed relative to the body's centre, inertial, m/s.
    pub orbital_speed_m_s: f64,
    /// Speed over the (turning) ground, m/s.
    pub surface_speed_m_s: f64,
    /// Rate of climb, m/s.
    pub vertical_speed_m_s: f64,
    /// The osculating orbit.
    pub orbit: OrbitReadout,
    /// Heading (clockwise from north), pitch and roll against the horizon, rad.
    pub heading_pitch_roll_rad: [f64; 3],
    /// Turn rate in hull axes, rad/s.
    pub angular_rate_rad_s: DVec3,
    /// Attitude.
    pub icrf_from_hull: DQuat,
    /// Directions for markers.
    pub markers: Markers,
    /// Air: density kg/m³, pressure Pa, dynamic pressure Pa, Mach number (0 without air).
    pub density_kg_m3: f64,
    /// Static pressure, Pa.
    pub pressure_pa: f64,
    /// ½ρv², Pa.
    pub dynamic_pressure_pa: f64,
    /// Speed over the local speed of sound.
    pub mach: f64,
    /// Stagnation-point convective heat flux (Sutton–Graves), W/m².
    pub heat_flux_w_m2: f64,
    /// Felt acceleration (all but gravity), in g₀.
    pub load_g: f64,
    /// Main throttle in force, 0 … 1.
    pub throttle: f64,
    /// Strength of RCS firing, 0 … 1.
    pub rcs: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Propellant left and capacity, kg.
    pub propellant_kg: (f64, f64),
    /// Delta-v left, m/s.
    pub delta_v_m_s: f64,
    /// Gear down?
    pub gear_down: bool,
    /// Attitude hold in force.
    pub hold: Hold,
    /// Throttle guidance in force.
    pub guidance: Guidance,
    /// One line on what the autopilot does now; empty when it does nothing.
    pub guidance_phase: &'static str,
    /// The target, if any.
    pub target: Option<TargetReadout>,
    /// The next planned burn, if any.
    pub node: Option<NodeReadout>,
    /// Fraction of the sun's disc that is free at the ship, 0 … 1.
    pub sun_visible: f64,
    /// The body that hides the sun, if one does.
    pub eclipsed_by: Option<BodyId>,
    /// The eclipse in force or next to come here.
    pub eclipse: Option<EclipseReadout>,
    /// Warnings in force, worst first.
    pub warnings: Vec<Warning>,
    /// Speed of the last touchdown or impact along the ground's normal, m/s, and ticks since; none before the first.
    pub last_contact: Option<(f64, i64)>,
}
