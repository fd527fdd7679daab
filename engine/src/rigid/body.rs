//! A rigid body seen from a turning world: its state in the body-fixed frame, and the way to and from inertial axes.
//!
//! Coasting and powered flight use [`Centred`] states; contact uses [`Fixed`] ones, in which the ground is at rest.
//! Not here: how a state moves ([`super::bubble`]).

use crate::space::{Centred, Fixed, Hull, Position, Rotation, Vector, Velocity};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// Pose and motion relative to the turning ground, all in [`Fixed`] axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Centre of mass, m from the body's centre.
    pub position: Position<Fixed>,
    /// Attitude.
    pub fixed_from_hull: Rotation<Fixed, Hull>,
    /// Velocity over the ground, m/s.
    pub velocity: Velocity<Fixed>,
    /// Angular velocity relative to the ground, rad/s.
    pub angular: Vector<Fixed>,
}

impl BodyState {
    /// Velocity over the ground of a point of the hull at `lever` (Fixed axes, m from the centre of mass).
    pub fn velocity_at(&self, lever: DVec3) -> DVec3 {
        self.velocity.0 + self.angular.0.cross(lever)
    }
    /// True when every number is finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite() && self.angular.is_finite() && self.fixed_from_hull.0.is_finite()
    }
}

/// Mass and principal moments of inertia, in hull axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProps {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Principal moments about the hull's axes, kg m².
    pub inertia_kg_m2: DVec3,
}

/// What acts on the ship besides gravity, inertia and the ground; constant over a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loads {
    /// Force that turns with the hull (thrust, air), N, hull axes.
    pub force_n: Vector<Hull>,
    /// Torque, N m, hull axes.
    pub torque_n_m: Vector<Hull>,
}

/// A uniformly turning frame: the angular velocity of the ground in its own axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RotatingFrame {
    /// Angular velocity, rad/s, in [`Fixed`] axes.
    pub omega_rad_s: DVec3,
}

impl RotatingFrame {
    /// Centrifugal and Coriolis acceleration, m/s²: `−ω×(ω×r) − 2ω×v` [Goldstein, Classical Mechanics, 3rd ed., eq. 4.91].
    pub fn fictitious(&self, r: DVec3, v: DVec3) -> DVec3 {
        let w = self.omega_rad_s;
        -w.cross(w.cross(r)) - 2.0 * w.cross(v)
    }

    /// From inertial axes to the turning frame. `icrf_from_fixed` gives the axes now; `angular` is inertial, rad/s.
    pub fn from_centred(
        &self,
        icrf_from_fixed: DQuat,
        position: Position<Centred>,
        velocity: Velocity<Centred>,
        icrf_from_hull: DQuat,
        angular: DVec3,
    ) -> BodyState {
        let to = icrf_from_fixed.conjugate();
        let r = to * position.0;
        BodyState {
            position: Position::new(r),
            fixed_from_hull: Rotation::new((to * icrf_from_hull).normalize()),
            velocity: Velocity::new(to * velocity.0 - self.omega_rad_s.cross(r)),
            angular: Vector::new(to * angular - self.omega_rad_s),
        }
    }

    /// Back to inertial axes: position, velocity, attitude and angular velocity (rad/s).
    pub fn to_centred(&self, icrf_from_fixed: DQuat, s: &BodyState) -> (Position<Centred>, Velocity<Centred>, DQuat, DVec3) {
        let r = s.position.0;
        (
            Position::new(icrf_from_fixed * r),
            Velocity::new(icrf_from_fixed * (s.velocity.0 + self.omega_rad_s.cross(r))),
            (icrf_from_fixed * s.fixed_from_hull.0).normalize(),
            icrf_from_fixed * (s.angular.0 + self.omega_rad_s),
        )
    }
}

/// The rotation by the vector `rad` (axis times angle).
pub(super) fn turn(rad: DVec3) -> DQuat {
    let angle = rad.length();
    if angle < 1e-12 {
        return DQuat::from_xyzw(0.5 * rad.x, 0.5 * rad.y, 0.5 * rad.z, 1.0).normalize();
    }
    let v = rad * (libm::sin(0.5 * angle) / angle);
    DQuat::from_xyzw(v.x, v.y, v.z, libm::cos(0.5 * angle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_at_rest_on_the_equator_moves_at_465_m_s_in_inertial_axes() {
        let frame = RotatingFrame { omega_rad_s: DVec3::new(0.0, 0.0, 7.292_115e-5) };
        let rest = BodyState {
            position: Position::xyz(6_378_137.0, 0.0, 0.0),
            fixed_from_hull: Rotation::IDENTITY,
            velocity: Velocity::ZERO,
            angular: Vector::ZERO,
        };
        let axes = DQuat::from_rotation_x(0.4) * DQuat::from_rotation_z(1.0);
        let (p, v, q, w) = frame.to_centred(axes, &rest);
        assert!((v.length() - 465.101).abs() < 1e-3, "{}", v.length());
        let back = frame.from_centred(axes, p, v, q, w);
        assert!((back.position.0 - rest.position.0).length() < 4e-9);
        assert!(back.velocity.length() < 1e-12 && back.angular.length() < 1e-19);
    }
}
