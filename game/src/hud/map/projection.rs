//! The map's projection: orthographic, in f64 from the focus, so that it is as steady at a moon as at the edge of the system.

use egui::{Pos2, Vec2};
use engine::space::relative::narrow;
use glam::DVec3;

/// The map's projection: positions from the focus, m, to the screen; depth towards the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Where the focus stands.
    pub centre: Pos2,
    /// Metres in a point of the screen.
    pub scale: f64,
    /// Unit vector to the right of the screen.
    pub right: DVec3,
    /// Upwards.
    pub up: DVec3,
    /// Towards the viewer.
    pub towards: DVec3,
}

impl Projection {
    /// Where a position stands on the screen.
    pub fn at(&self, p: DVec3) -> Pos2 {
        // Far beyond the window a point only needs to lie on the right side of it.
        let clamp = |x: f64| narrow((x / self.scale).clamp(-1.0e5, 1.0e5));
        self.centre + Vec2::new(clamp(p.dot(self.right)), -clamp(p.dot(self.up)))
    }
    /// A length in points of the screen.
    pub fn points(&self, metres: f64) -> f32 {
        narrow((metres / self.scale).min(1.0e5))
    }
    /// True when `p` lies behind the disc of a sphere.
    pub fn behind(&self, p: DVec3, centre: DVec3, radius: f64) -> bool {
        let d = p - centre;
        let across = d - self.towards * d.dot(self.towards);
        d.dot(self.towards) < 0.0 && across.length() < radius
    }
}
