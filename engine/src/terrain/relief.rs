//! Relief: the ground of one body, as a function of direction. The same function is drawn (`shaders/lib/height.wgsl`), and
//! its twins are compared in `tests/`.

use glam::DVec3;

/// The ground of one body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Relief {
    /// Radius of the datum sphere, m.
    pub radius_m: f64,
    /// True when everything below the datum is under water.
    pub has_water: bool,
}

impl Relief {
    /// Height of the ground above the datum, m, in full detail; `direction` is a unit vector in body-fixed axes. Sea floor is negative.
    pub fn height_m(&self, direction: DVec3) -> f64 {
        let _ = direction;
        0.0
    }
    /// Height of what one stands or splashes on: the ground, or the water's surface (0) above it.
    pub fn surface_m(&self, direction: DVec3) -> f64 {
        let h = self.height_m(direction);
        if self.has_water { h.max(0.0) } else { h }
    }
}
