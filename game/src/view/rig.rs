//! The rig: where the camera hangs. The World does not know of it; moving it changes no bit of the simulation.

use super::place::Place;
use crate::world::eclipse::Sky;
use crate::world::system::System;
use engine::orbit::BodyId;
use engine::scene::AutoOr;
use engine::space::{Centred, Fixed, Hull, Icrf, Position, Rotation, Vector, View, sphere};
use engine::units::DEG;
use glam::{DMat3, DVec3};

/// Lowest height of the eye above the ground, m.
const EYE_CLEARANCE_M: f64 = 1.6;

/// How the camera hangs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraMode {
    /// In the cockpit, looking with the hull.
    Cockpit,
    /// Behind the ship; up is the local vertical.
    Chase,
    /// A camera of its own, at rest over the ground of the dominating body.
    Free,
    /// Far above a body, for the orbit map.
    Map,
    /// Standing at a given place (the `--camera` argument).
    Place(Place),
}

/// The camera's settings, changed by the player at any time.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// How it hangs.
    pub mode: CameraMode,
    /// Look to the left of the mode's own direction, rad.
    pub yaw_rad: f64,
    /// Look up from the mode's own direction, rad, within ±90°.
    pub pitch_rad: f64,
    /// Distance from the ship's centre in [`CameraMode::Chase`], m.
    pub chase_m: f64,
    /// Distance from the centre of the focus in [`CameraMode::Map`], in radii of the focus.
    pub map_radii: f64,
    /// The body in the middle of the map; the dominating one if none is set.
    pub focus: Option<BodyId>,
    /// Where the free camera is, body-fixed; set from the present eye when the mode is entered.
    pub free: Option<Position<Fixed>>,
    /// Vertical field of view, rad.
    pub fov_y_rad: f64,
    /// Exposure.
    pub exposure: AutoOr,
}

impl Default for Rig {
    fn default() -> Self {
        Self {
            mode: CameraMode::Chase,
            yaw_rad: 0.0,
            pitch_rad: -12.0 * DEG,
            chase_m: 70.0,
            map_radii: 4.0,
            focus: None,
            free: None,
            fov_y_rad: 55.0 * DEG,
            exposure: AutoOr::Auto { compensation_ev: 0.0 },
        }
    }
}

/// What the rig needs to know of the ship and its world.
#[derive(Clone, Copy, Debug)]
pub struct Mount<'a> {
    /// The system.
    pub system: &'a System,
    /// Where every body is now.
    pub sky: &'a Sky,
    /// The dominating body.
    pub host: BodyId,
    /// The ship's centre of mass.
    pub ship: Position<Centred>,
    /// The ship's attitude.
    pub icrf_from_hull: Rotation<Icrf, Hull>,
}

impl Mount<'_> {
    /// The axes of a body now.
    pub fn axes(&self, body: BodyId) -> Rotation<Icrf, Fixed> {
        self.sky.axes(self.system, body)
    }
    /// Unit vector from a body's centre to the star.
    pub fn to_star(&self, body: BodyId) -> DVec3 {
        (self.sky.position(BodyId(0)) - self.sky.position(body)).0.normalize_or(DVec3::X)
    }
}

/// The camera, placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The body whose centre `position` is measured from.
    pub host: BodyId,
    /// Position from the host's centre, inertial axes.
    pub position: Position<Centred>,
    /// Attitude.
    pub view_from_icrf: Rotation<View, Icrf>,
}

impl Rig {
    /// Places the camera.
    pub fn eye(&self, mount: &Mount<'_>) -> Eye {
        match self.mode {
            CameraMode::Cockpit => self.cockpit(mount),
            CameraMode::Chase => self.chase(mount),
            CameraMode::Free => self.free(mount),
            CameraMode::Map => self.map(mount),
            CameraMode::Place(place) => place.eye(mount),
        }
    }

    /// Turns the look by mouse or stick; the pitch stops at ±89°, so that up stays defined.
    pub fn look(&mut self, left_rad: f64, up_rad: f64) {
        self.yaw_rad = libm::remainder(self.yaw_rad + left_rad, core::f64::consts::TAU);
        self.pitch_rad = (self.pitch_rad + up_rad).clamp(-89.0 * DEG, 89.0 * DEG);
    }

    /// Nearer (factor below 1) or farther.
    pub fn zoom(&mut self, factor: f64) {
        match self.mode {
            CameraMode::Map => self.map_radii = (self.map_radii * factor).clamp(1.05, 1.0e6),
            _ => self.chase_m = (self.chase_m * factor).clamp(18.0, 5.0e4),
        }
    }

    /// Moves the free camera by an offset in view axes, m; starts from `eye` when it has no place yet.
    pub fn fly(&mut self, mount: &Mount<'_>, eye: &Eye, offset: Vector<View>) {
        let moved = eye.position + Vector::new(eye.view_from_icrf.inverse().vector(offset).0);
        self.free = Some(Position::new(mount.axes(mount.host).inverse().raw(moved.0)));
    }

    fn cockpit(&self, mount: &Mount<'_>) -> Eye {
        let seat = DVec3::new(0.0, 1.4, -8.2);
        let position = mount.ship + Vector::new(mount.icrf_from_hull.raw(seat));
        let forward = mount.icrf_from_hull.raw(turned(self.yaw_rad, self.pitch_rad));
        Eye { host: mount.host, position, view_from_icrf: looking(forward, mount.icrf_from_hull.raw(DVec3::Y)) }
    }

    fn chase(&self, mount: &Mount<'_>) -> Eye {
        let up = mount.ship.0.normalize_or(DVec3::Z);
        let ahead = heading(mount.icrf_from_hull, up);
        let left = up.cross(ahead);
        let (sy, cy) = libm::sincos(self.yaw_rad);
        let (sp, cp) = libm::sincos(self.pitch_rad);
        let forward = (ahead * cy + left * sy) * cp + up * sp;
        let wanted = mount.ship - Vector::new(forward * self.chase_m);
        let position = above_ground(mount, wanted);
        // Where the ground pushed the camera up, it keeps looking at the ship.
        let forward = (mount.ship - position).0.normalize_or(forward);
        Eye { host: mount.host, position, view_from_icrf: looking(forward, up) }
    }

    fn free(&self, mount: &Mount<'_>) -> Eye {
        let Some(place) = self.free else { return self.chase(mount) };
        let position = above_ground(mount, Position::new(mount.axes(mount.host).raw(place.0)));
        let fixed_up = mount.axes(mount.host).inverse().raw(position.0).normalize_or(DVec3::Z);
        let (east, up, north) = sphere::east_up_north(fixed_up);
        let (sy, cy) = libm::sincos(self.yaw_rad);
        let (sp, cp) = libm::sincos(self.pitch_rad);
        let forward = (north * cy - east * sy) * cp + up * sp;
        let raw = |v| mount.axes(mount.host).raw(v);
        Eye { host: mount.host, position, view_from_icrf: looking(raw(forward), raw(up)) }
    }

    fn map(&self, mount: &Mount<'_>) -> Eye {
        let focus = self.focus.unwrap_or(mount.host);
        let radius = mount.system.body(focus).radius_m;
        let (sy, cy) = libm::sincos(self.yaw_rad);
        let (sp, cp) = libm::sincos(self.pitch_rad);
        let forward = DVec3::new(cp * cy, cp * sy, sp);
        Eye { host: focus, position: Position::new(-forward * radius * self.map_radii), view_from_icrf: looking(forward, DVec3::Z) }
    }
}

/// A direction in hull axes, `yaw` to the left of the nose and `pitch` up.
fn turned(yaw: f64, pitch: f64) -> DVec3 {
    let (sy, cy) = libm::sincos(yaw);
    let (sp, cp) = libm::sincos(pitch);
    DVec3::new(-sy * cp, sp, -cy * cp)
}

/// The ship's heading in the horizontal plane, continuous while it pitches through the vertical: nose and roof are mixed, so
/// that a ship on its tail keeps the heading that it had when it pulled up.
fn heading(icrf_from_hull: Rotation<Icrf, Hull>, up: DVec3) -> DVec3 {
    let flat = |v: DVec3| v - up * v.dot(up);
    let nose = icrf_from_hull.raw(DVec3::NEG_Z);
    let roof = icrf_from_hull.raw(DVec3::Y);
    let level = flat(nose);
    let mixed = level - flat(roof) * (nose.dot(up).signum() * (1.0 - level.length()));
    mixed.normalize_or(flat(DVec3::X).normalize_or(flat(DVec3::Y).normalize_or(DVec3::Y)))
}

/// A view along `forward` with `up` as nearly up as it can be.
pub fn looking(forward: DVec3, up: DVec3) -> Rotation<View, Icrf> {
    let forward = forward.normalize_or(DVec3::X);
    let right = forward.cross(up).normalize_or(forward.any_orthonormal_vector());
    Rotation::<Icrf, View>::from_columns(DMat3::from_cols(right, right.cross(forward), -forward)).inverse()
}

/// Lifts a point that lies under the ground of the host.
pub fn above_ground(mount: &Mount<'_>, wanted: Position<Centred>) -> Position<Centred> {
    let body = mount.system.body(mount.host);
    let up = wanted.0.normalize_or(DVec3::Z);
    let ground = body.relief.as_ref().map_or(0.0, |r| r.surface_m(mount.axes(mount.host).inverse().raw(up)));
    let lowest = body.radius_m + ground + EYE_CLEARANCE_M;
    if wanted.length() < lowest { Position::new(up * lowest) } else { wanted }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn looking_is_right_handed_and_forward_is_minus_z() {
        let view_from_icrf = looking(DVec3::new(1.0, 2.0, -0.5), DVec3::Z);
        let forward = view_from_icrf.raw(DVec3::new(1.0, 2.0, -0.5).normalize());
        assert!((forward - DVec3::NEG_Z).length() < 1e-12);
        assert!(view_from_icrf.raw(DVec3::Z).y > 0.5);
        assert!(looking(DVec3::Z, DVec3::Z).0.is_finite(), "straight up is a view, too");
    }

    #[test]
    fn heading_survives_pitching_through_the_vertical() {
        let up = DVec3::Z;
        let level = DMat3::from_cols(DVec3::NEG_Y, DVec3::Z, DVec3::NEG_X);
        for degrees in [-90, -60, -10, 0, 30, 89, 90] {
            // Nose along +X, roof to +Z, then pitched about the right wing.
            let pitch = DQuat::from_axis_angle(DVec3::NEG_Y, f64::from(degrees) * DEG);
            let hull = Rotation::new(pitch * DQuat::from_mat3(&level));
            assert!((heading(hull, up) - DVec3::X).length() < 1e-9, "{degrees}");
        }
    }
}
