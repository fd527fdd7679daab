//! The landing gear: each leg is a spring and a damper along its axis, and a foot that sticks to the ground until it must slide.
//!
//! A foot remembers the point of the ground that it stands on ([`LegState`]) and is drawn back to it by a tangential spring
//! (Coulomb friction with an elastic presliding zone: the bristle model of Dahl [P. Dahl 1968] in its linear form), so that a ship
//! on a slope rests and does not creep. Beyond `μN` the foot slides and drags its point along.
//! Not here: contact of the hull ([`super::hull`]).

use super::body::BodyState;
use super::ground::Patch;
use crate::space::{Fixed, Position};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A leg, in hull axes, fully extended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Leg {
    /// Where it is held, m from the centre of mass.
    pub hip_m: DVec3,
    /// Its foot when unloaded, m from the centre of mass.
    pub foot_m: DVec3,
    /// Travel, m; beyond it the leg stands on its stop.
    pub stroke_m: f64,
    /// Spring, N/m.
    pub stiffness_n_m: f64,
    /// Damper, N s/m.
    pub damping_n_s_m: f64,
    /// Coefficient of friction of the foot.
    pub friction: f64,
}

/// What of a ship can touch, and what it bears.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chassis {
    /// Half the size of the box around the hull, m, and its middle from the centre of mass, hull axes.
    pub half_size_m: DVec3,
    /// Middle of that box, m from the centre of mass.
    pub middle_m: DVec3,
    /// Coefficient of friction of the hull.
    pub friction: f64,
    /// The legs.
    pub legs: Vec<Leg>,
    /// Fastest touchdown that the gear bears, m/s along the ground's normal.
    pub gear_limit_m_s: f64,
    /// Fastest slide at touchdown that the gear bears, m/s along the ground.
    pub slide_limit_m_s: f64,
    /// Fastest knock that the hull bears, m/s along the ground's normal.
    pub hull_limit_m_s: f64,
}

impl Chassis {
    /// Radius of the sphere about the centre of mass that holds hull and legs, m.
    pub fn reach_m(&self) -> f64 {
        let hull = (self.middle_m.abs() + self.half_size_m).length();
        self.legs.iter().fold(hull, |r, leg| r.max(leg.foot_m.length()))
    }
    /// The corners of the hull's box and, with the gear down, the feet: m from the centre of mass, hull axes.
    pub fn extremes(&self, gear_down: bool) -> Vec<DVec3> {
        let h = self.half_size_m;
        let mut out = Vec::with_capacity(8 + self.legs.len());
        for k in 0_u8..8 {
            let sign = |bit: u8| if k >> bit & 1 == 1 { 1.0 } else { -1.0 };
            out.push(self.middle_m + DVec3::new(sign(0) * h.x, sign(1) * h.y, sign(2) * h.z));
        }
        if gear_down {
            out.extend(self.legs.iter().map(|leg| leg.foot_m));
        }
        out
    }
}

/// What a leg remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LegState {
    /// The point of the ground that the foot holds to (Fixed axes, m); none in the air.
    pub hold_m: Option<DVec3>,
    /// Compression, m (for drawing the leg and for the readout).
    pub compression_m: f64,
}

/// What the legs do to the ship at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LegForces {
    /// Sum of forces, N, Fixed axes.
    pub force_n: DVec3,
    /// Torque about the centre of mass, N m, Fixed axes.
    pub torque_n_m: DVec3,
    /// Feet on the ground.
    pub feet: usize,
    /// Worst new touch: speed along the normal, and along the ground, m/s.
    pub touch_m_s: Option<(f64, f64)>,
}

/// Evaluates all legs for one substep of `dt_s`, updating what they remember. `mass_kg` bounds the dampers for stability.
pub(super) fn act(legs: &[Leg], memory: &mut [LegState], state: &BodyState, patch: &Patch, mass_kg: f64, dt_s: f64) -> LegForces {
    let mut sum = LegForces::default();
    for (leg, m) in legs.iter().zip(memory.iter_mut()) {
        one(leg, m, state, patch, mass_kg, dt_s, &mut sum);
    }
    sum
}

fn one(leg: &Leg, m: &mut LegState, state: &BodyState, patch: &Patch, mass_kg: f64, dt_s: f64, sum: &mut LegForces) {
    let q = state.fixed_from_hull.0;
    let hip = q * leg.hip_m;
    let reach = q * leg.foot_m - hip;
    let length = reach.length();
    let axis = reach / length.max(1e-6);
    let hip_at: Position<Fixed> = Position::new(state.position.0 + hip);
    let Some(hit) = patch.cast(hip_at, axis, length) else {
        *m = LegState::default();
        return;
    };
    let lever = hip + axis * hit.distance_m;
    let foot = state.position.0 + lever;
    let n = hit.normal;
    let v = state.velocity_at(lever);
    let v_normal = v.dot(n);
    let slide = v - n * v_normal;
    let compression = length - hit.distance_m;
    // A leg that leans on the ground at a grazing angle must not be amplified without bound.
    let rate = -v_normal / (-axis.dot(n)).max(0.3);
    // The stop is bounded: legs that were let out into the ground lift the ship, they do not fling it.
    let stop = (compression - leg.stroke_m).clamp(0.0, 0.5 * leg.stroke_m);
    // Explicit dampers are stable for c·h below the mass they move; a foot off-centre moves about a quarter of it.
    let damping = leg.damping_n_s_m.min(0.2 * mass_kg / dt_s);
    let normal_n = (leg.stiffness_n_m * (compression.min(1.5 * leg.stroke_m) + 4.0 * stop) + damping * rate).max(0.0);

    if m.hold_m.is_none() {
        let touch = (-v_normal, slide.length());
        sum.touch_m_s = Some(sum.touch_m_s.map_or(touch, |t| (t.0.max(touch.0), t.1.max(touch.1))));
    }
    let grip_n_m = 2.0 * leg.stiffness_n_m;
    let grip_damping = (1.4 * leg.damping_n_s_m).min(0.2 * mass_kg / dt_s);
    let hold = m.hold_m.unwrap_or(foot);
    let away = foot - hold;
    let stretch = away - n * away.dot(n);
    let wanted = -stretch * grip_n_m - slide * grip_damping;
    let most = leg.friction * normal_n;
    let (grip, hold) = if wanted.length() <= most {
        (wanted, hold)
    } else {
        let grip = wanted.normalize_or(DVec3::ZERO) * most;
        (grip, foot + grip / grip_n_m.max(1.0))
    };
    *m = LegState { hold_m: Some(hold), compression_m: compression };
    let force = n * normal_n + grip;
    sum.force_n += force;
    sum.torque_n_m += lever.cross(force);
    sum.feet += 1;
}
