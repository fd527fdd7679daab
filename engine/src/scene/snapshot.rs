//! The snapshot: what a frame is drawn from. Offsets are metres from the camera in ICRF axes, in f32; whatever needs f64
//! (altitude, up vector, tile corners) was computed in f64 by the caller and is stored as a finished number.
//!
//! Not here: how a snapshot is made from a World (`game::view::snapshot`), nor anything of wgpu.

use super::Camera;
use crate::air::Air;
use crate::terrain::TileSet;
use glam::{Quat, Vec3};

/// A setting that is either found by the renderer or fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AutoOr {
    /// From the picture's histogram, offset by this many stops.
    Auto {
        /// Exposure compensation, in stops.
        compensation_ev: f32,
    },
    /// Fixed exposure value at ISO 100.
    Ev100(f32),
}

/// The system's star, as a light and as a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Index of the star among the system's bodies.
    pub id: u16,
    /// Camera-relative centre, m.
    pub centre_m: Vec3,
    /// Radius, m.
    pub radius_m: f32,
    /// Luminous intensity, cd, per linear sRGB channel: illuminance at distance d is `intensity / d²`.
    pub intensity_cd: Vec3,
}

/// A sphere that may hide the star from a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Occluder {
    /// Index of the body.
    pub id: u16,
    /// Camera-relative centre, m.
    pub centre_m: Vec3,
    /// Radius, m.
    pub radius_m: f32,
}

/// What a body looks like without its air.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// A smooth sphere, for what is too small on screen for relief, or has none.
    Smooth,
    /// Terrain tiles chosen for this camera.
    Tiles(TileSet),
    /// None at all: a bank of fog or a nebula, of which only the shell of its air is seen.
    Nothing,
}

/// A planet or moon.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Index among the system's bodies; the key of its textures.
    pub id: u16,
    /// Camera-relative centre, m.
    pub centre_m: Vec3,
    /// Radius of the datum sphere, m.
    pub radius_m: f32,
    /// Rotates body-fixed axes to ICRF.
    pub icrf_from_fixed: Quat,
    /// Camera altitude above the datum, m (from f64; `|centre| − radius` in f32 would lose it).
    pub camera_altitude_m: f32,
    /// Unit vector from the body's centre to the camera, ICRF.
    pub camera_up: Vec3,
    /// Unit vector from the body's centre to the star, ICRF.
    pub sun_direction: Vec3,
    /// Angular radius of the star seen from the body, rad.
    pub sun_angular_radius_rad: f32,
    /// Illuminance by the star above the air, lx per linear sRGB channel.
    pub sun_illuminance_lx: Vec3,
    /// Bodies that may hide the star from any part of this one (this one itself left out).
    pub occluders: Vec<Occluder>,
    /// Mean surface albedo, linear sRGB.
    pub albedo: Vec3,
    /// The solid (or cloud-top) surface.
    pub surface: Surface,
    /// Its air, if it has any. The key of the tables is `id`; they are remade when this value changes.
    pub air: Option<Air>,
}

/// A ship.
#[derive(Clone, Debug, PartialEq)]
pub struct Ship {
    /// Camera-relative centre of mass, m.
    pub centre_m: Vec3,
    /// Rotates hull axes to ICRF.
    pub icrf_from_hull: Quat,
    /// Main engine flame, 0 … 1.
    pub throttle: f32,
    /// Gear extension, 0 … 1.
    pub gear: f32,
    /// Glow of entry heating, 0 … 1.
    pub heat: f32,
    /// Which body in [`Snapshot::bodies`] (by position in the list) lights and shades it: the dominating one.
    pub host: Option<usize>,
    /// Height of the centre of mass above the ground, m, for the shadow; large when far.
    pub height_above_ground_m: f32,
    /// True when the hull itself is not drawn (cockpit view).
    pub hidden: bool,
}

/// Passes to run although the scene does not need them: the picture must not change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Force {
    /// Run every pass.
    pub all: bool,
}

/// Everything that a frame is drawn from.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The camera; the origin of all offsets.
    pub camera: Camera,
    /// The light.
    pub star: Star,
    /// Planets and moons, nearest first; those that are points of light may come last.
    pub bodies: Vec<Body>,
    /// Ships, nearest first.
    pub ships: Vec<Ship>,
    /// Exposure.
    pub exposure: AutoOr,
    /// Seconds since the last frame by the viewer's clock, for exposure adaptation; `None` adapts at once (stills).
    pub adapt_s: Option<f32>,
    /// Forced passes.
    pub force: Force,
}
