//! Contact of the hull with the ground, by rapier: a world of one box and one mesh, made for one substep and dropped after it.
//!
//! The world's origin is the ship itself, so that what `f32` must hold is small: positions of the substep are exact to
//! nanometres, and the f64 state takes from rapier only what the contact *added* to free motion. rapier's warm start is not
//! used; a world that forgets is a world that a save cannot miss. Not here: the legs ([`super::gear`]).

use super::body::{BodyState, MassProps};
use super::gear::Chassis;
use super::ground::Patch;
use crate::space::relative::{narrow, narrow3, rotation};
use glam::{DQuat, DVec3};
use rapier3d::dynamics::{MassProperties, RigidBodyBuilder};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::math::{Pose, Vector as V};
use rapier3d::pipeline::PhysicsWorld;

/// What touching the ground with the hull did in one substep, in Fixed axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knock {
    /// Change of velocity, m/s.
    pub dv: DVec3,
    /// Change of angular velocity, rad/s.
    pub dw: DVec3,
    /// Push out of the ground beyond `v·dt`, m.
    pub push: DVec3,
    /// Attitude after the substep relative to before (Fixed axes), rapier's own.
    pub turned: DQuat,
    /// Closing speed of the fastest touching point before the contact, along the normal, m/s.
    pub speed_m_s: f64,
}

/// One substep of rapier from `state` (its velocity already holds all other forces); none when the hull touches nothing.
pub(super) fn knock(patch: &Patch, chassis: &Chassis, mass: &MassProps, state: &BodyState, dt_s: f64) -> Option<Knock> {
    let to = patch.fixed_from_anchor.inverse();
    let mut world = PhysicsWorld { gravity: V::ZERO, ..PhysicsWorld::default() };
    let p = &mut world.integration_parameters;
    p.dt = narrow(dt_s);
    p.num_solver_iterations = 8;
    p.normalized_max_linear_velocity = f32::MAX;
    p.max_ccd_substeps = 0;

    let ground_at = Pose::from_parts(narrow3(to.raw((patch.origin - state.position).0)), glam::Quat::IDENTITY);
    let ground = ColliderBuilder::new(patch.coarse.clone()).density(0.0).position(ground_at).friction(narrow(chassis.friction));
    world.insert_collider(ground, None);
    let inertia = narrow3(mass.inertia_kg_m2.max(DVec3::splat(1.0)));
    let attitude = rotation(to * state.fixed_from_hull);
    let (v0, w0) = (narrow3(to.raw(state.velocity.0)), narrow3(to.raw(state.angular.0)));
    let body = RigidBodyBuilder::dynamic()
        .pose(Pose::from_parts(V::ZERO, attitude))
        .linvel(v0)
        .angvel(w0)
        .additional_mass_properties(MassProperties::new(V::ZERO, narrow(mass.mass_kg), inertia))
        .gyroscopic_forces_enabled(false)
        .can_sleep(false);
    let half = narrow3(chassis.half_size_m.max(DVec3::splat(0.1)));
    let hull = ColliderBuilder::cuboid(half.x, half.y, half.z)
        .translation(narrow3(chassis.middle_m))
        .density(0.0)
        .friction(narrow(chassis.friction));
    let (body, _) = world.insert(body, hull);
    world.step();

    let mut speed: Option<f64> = None;
    for pair in world.narrow_phase.contact_pairs() {
        if pair.total_impulse_magnitude() <= 0.0 {
            continue;
        }
        let ground_first = world.colliders.get(pair.collider1).is_some_and(|c| c.parent().is_none());
        for m in pair.manifolds() {
            let up = if ground_first { m.data.normal } else { -m.data.normal };
            for point in &m.points {
                let local = if ground_first { point.local_p2 } else { point.local_p1 };
                let lever = attitude * (narrow3(chassis.middle_m) + local);
                let closing = f64::from(-(v0 + w0.cross(lever)).dot(up));
                if f64::from(point.dist) < closing.max(0.0) * dt_s + 0.01 {
                    speed = Some(speed.map_or(closing, |s: f64| s.max(closing)));
                }
            }
        }
    }
    let speed_m_s = speed?.max(0.0);
    let after = world.bodies.get(body)?;
    let (v1, w1) = (after.linvel(), after.angvel());
    let back = |v: V| patch.fixed_from_anchor.raw(v.as_dvec3());
    let turned = (after.rotation().as_dquat() * attitude.as_dquat().conjugate()).normalize();
    let axes = patch.fixed_from_anchor.0;
    Some(Knock {
        dv: back(v1 - v0),
        dw: back(w1 - w0),
        push: back(after.translation()) - back(v1) * dt_s,
        turned: axes * turned * axes.conjugate(),
        speed_m_s,
    })
}
