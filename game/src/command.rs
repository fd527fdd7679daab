//! Commands: everything that may change the World in one tick, as logical, quantised, serialisable data.
//!
//! Keyboard, gamepad, HUD clicks, a replay log and a test all end here; nothing else reaches [`crate::world::World`].
//! Axes are quantised to `i16` *before* the World sees them, so that a recorded flight is the flown one, bit for bit.

use engine::orbit::BodyId;
use engine::time::SimTime;
use serde::{Deserialize, Serialize};

/// Full deflection of an axis.
pub const AXIS_MAX: i16 = i16::MAX;

/// Held axes, each in −32767 … 32767. Signs follow the hull frame (+X right, +Y up, −Z forward).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axes {
    /// Nose up positive (rotation about +X).
    pub pitch: i16,
    /// Nose left positive (rotation about +Y).
    pub yaw: i16,
    /// Right wing down positive (rotation about −Z).
    pub roll: i16,
    /// Translation to the right by RCS.
    pub right: i16,
    /// Translation up by RCS.
    pub up: i16,
    /// Translation forward by RCS.
    pub forward: i16,
}

impl Axes {
    /// Quantises a value in [−1, 1]; NaN becomes 0, what lies outside is clamped.
    #[allow(clippy::cast_possible_truncation)]
    pub fn quantise(x: f64) -> i16 {
        if x.is_nan() { 0 } else { (x.clamp(-1.0, 1.0) * f64::from(AXIS_MAX)).round() as i16 }
    }
    /// Back to [−1, 1].
    pub fn value(axis: i16) -> f64 {
        f64::from(axis.max(-AXIS_MAX)) / f64::from(AXIS_MAX)
    }
    /// True when every axis is at rest.
    pub fn at_rest(self) -> bool {
        self == Self::default()
    }
}

/// What the attitude controller holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Hold {
    /// Rate command: axes command a turn rate; with axes at rest the rate goes to zero, and the attitude is held.
    #[default]
    Rate,
    /// No control at all: torque-free.
    Free,
    /// Bring all rotation to zero, then fall back to [`Hold::Rate`].
    KillRotation,
    /// Nose along the orbital velocity.
    Prograde,
    /// Nose against the orbital velocity.
    Retrograde,
    /// Nose along the orbit normal.
    Normal,
    /// Nose against the orbit normal.
    AntiNormal,
    /// Nose away from the body, perpendicular to the velocity, in the orbital plane.
    RadialOut,
    /// The opposite of [`Hold::RadialOut`].
    RadialIn,
    /// Nose along the velocity over the ground.
    SurfacePrograde,
    /// Nose against the velocity over the ground.
    SurfaceRetrograde,
    /// Roof to the zenith: level, heading kept; the attitude for vertical landing and hover.
    SurfaceVertical,
    /// Nose towards the target.
    Target,
    /// Nose along what remains of the next planned burn.
    Node,
}

/// What flies the throttle (and, for landing, the attitude).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Guidance {
    /// The pilot.
    #[default]
    Manual,
    /// Zero vertical and horizontal speed over the ground.
    Hover,
    /// Vertical speed held at this many centimetres per second (negative is down), horizontal speed to zero.
    VerticalSpeed {
        /// cm/s, up positive.
        cm_s: i32,
    },
    /// From orbit to standing on the target spot (or on what lies ahead where none is set).
    Land,
    /// The next planned burn: turns in time, begins half a burn early, cuts off when it is done.
    Node,
}

/// A planned burn: a change of velocity at a moment of the path ahead, in the axes of the path there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Node {
    /// The middle of the burn.
    pub at: SimTime,
    /// Along the velocity, the orbit's normal, and outward across both, mm/s.
    pub dv_mm_s: [i32; 3],
}

/// Planned burns that a ship keeps.
pub const MOST_NODES: usize = 16;

/// A place on a body, in microdegrees so that it is exact in a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spot {
    /// Planetocentric latitude, 1e-6 degrees.
    pub lat_udeg: i32,
    /// East longitude, 1e-6 degrees.
    pub lon_udeg: i32,
}

/// What the pilot points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Target {
    /// The body.
    pub body: BodyId,
    /// A spot on it, if any.
    pub spot: Option<Spot>,
}

/// Time-warp levels, in quarter ticks of simulated time per tick of the session: 1/4× … 1,000,000×. A level keeps its number:
/// saves and logs hold them.
pub const WARP_QUARTERS: [u32; 12] = [1, 2, 4, 8, 16, 40, 400, 4_000, 40_000, 200_000, 400_000, 4_000_000];
/// The level that means 1×.
pub const WARP_ONE: u8 = 2;

/// A discrete command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Action {
    /// Main throttle, 0 … 65535 of full.
    Throttle(u16),
    /// Choose an attitude hold.
    Hold(Hold),
    /// Choose who flies the throttle.
    Guidance(Guidance),
    /// Gear down or up.
    Gear(bool),
    /// Time warp: an index into [`WARP_QUARTERS`].
    Warp(u8),
    /// Set or clear the target.
    Target(Option<Target>),
    /// Fill the tanks (sandbox).
    Refuel,
    /// Keep the state in the session's quick slot.
    Quicksave,
    /// Go back to the newest quick slot of this session.
    Quickload,
    /// Plan a burn.
    AddNode(Node),
    /// Put another burn in the place of the one with this number (in order of time, from 0).
    ChangeNode(u8, Node),
    /// Give up the planned burn with this number.
    DeleteNode(u8),
    /// Run the clock as fast as it may until shortly before a moment; `None`, or a choice of warp, ends that.
    WarpTo(Option<SimTime>),
}

/// All commands of one tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Commands {
    /// Held axes.
    pub axes: Axes,
    /// Discrete commands, in order.
    pub actions: Vec<Action>,
}
