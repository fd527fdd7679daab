//! Planned burns: what a node means on the path that it lies on, how long it burns, and how the list of them is changed.
//!
//! Not here: how one is flown ([`super::guidance::burn`]), the path that follows from it (drawn by [`crate::hud`]).

use super::Ship;
use super::guidance::plan::ticks;
use crate::command::{Action, MOST_NODES, Node};
use engine::orbit::State;
use engine::space::Frame;
use engine::time::SimTime;
use glam::DVec3;

/// m/s in a mm/s.
const MM_S: f64 = 1.0e-3;

impl Node {
    /// A burn of so much, m/s along (velocity, normal, outward); each part is cut to ±2,147 km/s.
    #[allow(clippy::cast_possible_truncation)]
    pub fn new(at: SimTime, dv_m_s: DVec3) -> Self {
        Self { at, dv_mm_s: dv_m_s.to_array().map(|x| (x / MM_S).round() as i32) }
    }

    /// Change of velocity along (velocity, normal, outward), m/s.
    pub fn parts_m_s(&self) -> DVec3 {
        DVec3::from_array(self.dv_mm_s.map(f64::from)) * MM_S
    }

    /// Size of the change of velocity, m/s.
    pub fn size_m_s(&self) -> f64 {
        self.parts_m_s().length()
    }

    /// The change of velocity of a burn on a path that is in this state there, in the state's axes, m/s.
    pub fn dv<F: Frame>(&self, state: &State<F>) -> DVec3 {
        let [prograde, normal, radial] = axes(state);
        let parts = self.parts_m_s();
        prograde * parts.x + normal * parts.y + radial * parts.z
    }
}

/// Unit vectors along the velocity, along the normal of the orbit, and outward across both.
pub fn axes<F: Frame>(state: &State<F>) -> [DVec3; 3] {
    let prograde = state.velocity.0.normalize_or(DVec3::X);
    let across = prograde.any_orthonormal_vector();
    let normal = state.position.0.cross(state.velocity.0).normalize_or(across);
    [prograde, normal, prograde.cross(normal)]
}

impl Ship {
    /// How long the main engine takes for a change of velocity, s [Tsiolkovsky 1903]: `m v_e/F (1 − e^(−Δv/v_e))`.
    pub fn burn_s(&self, dv_m_s: f64) -> f64 {
        let engine = &self.spec.main_engine;
        -libm::expm1(-dv_m_s / engine.exhaust_velocity_m_s) * self.mass_kg() * engine.exhaust_velocity_m_s / engine.thrust_n
    }

    /// When a burn begins: the node is its middle in time.
    pub fn burn_start(&self, node: &Node) -> SimTime {
        node.at.plus(-ticks(0.5 * self.burn_s(node.size_m_s())))
    }

    /// When the autopilot, coasting, has next to do something.
    pub fn planned_wake(&self) -> Option<SimTime> {
        match self.guidance {
            crate::command::Guidance::Node => self.burn.as_ref().and_then(super::guidance::Burn::wake),
            _ => self.landing.as_ref().and_then(super::guidance::Landing::wake),
        }
    }

    /// Carries out a change of the list. What cannot be (a number that there is not, a moment that has passed, one node too
    /// many) changes nothing.
    pub fn edit_nodes(&mut self, action: Action, now: SimTime) {
        match action {
            Action::AddNode(node) if node.at > now && self.nodes.len() < MOST_NODES => self.nodes.push(node),
            Action::ChangeNode(i, node) if node.at > now => match self.nodes.get_mut(usize::from(i)) {
                Some(kept) => *kept = node,
                None => return,
            },
            Action::DeleteNode(i) if usize::from(i) < self.nodes.len() => {
                self.nodes.remove(usize::from(i));
            }
            _ => return,
        }
        self.nodes.sort_by_key(|n| n.at);
        self.burn = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::space::{Centred, Position, Velocity};

    #[test]
    fn the_axes_are_those_of_the_path() {
        let state = State::<Centred> { position: Position::xyz(7e6, 0.0, 0.0), velocity: Velocity::xyz(1e3, 7e3, 0.0) };
        let [prograde, normal, radial] = axes(&state);
        assert!((normal - DVec3::Z).length() < 1e-15);
        assert!((prograde.cross(normal) - radial).length() < 1e-15 && radial.x > 0.98, "outward: {radial}");
        let node = Node::new(SimTime::from_ticks(0), DVec3::new(0.0, -12.345, 0.0));
        assert_eq!(node.dv_mm_s, [0, -12_345, 0]);
        assert!((node.dv(&state) - DVec3::Z * -12.345).length() < 1e-12);
        // A fall straight down has axes too.
        assert!(axes(&State::<Centred>::default()).iter().all(|a| (a.length() - 1.0).abs() < 1e-12));
    }
}
