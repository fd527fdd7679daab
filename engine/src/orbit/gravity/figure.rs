//! The figure of a body: what makes its gravity differ from a point's, and how it points.

use super::zonal::{sectorial, zonal};
use crate::orbit::rotation::Spin;
use crate::space::{Fixed, Icrf, Position, Vector};
use crate::time::SimTime;
use crate::units::DAY;
use glam::DVec3;

/// Zonal coefficients, the ellipse of the equator, and the axes that they belong to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Radius that the coefficients belong to, m.
    pub radius_m: f64,
    /// J₂, J₃, J₄, unnormalised.
    pub zonal: [f64; 3],
    /// C₂₂, unnormalised, in axes through the prime meridian.
    pub c22: f64,
    /// Degree-2 Love number k₂ and the lag of the bulge that is raised, s; no tidal response at 0.
    pub tide: [f64; 2],
    /// Where the axes point.
    pub spin: Spin,
}

/// Unit vectors of a body's axes: prime meridian, 90° east of it, pole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Axes {
    /// Towards the prime meridian at the equator.
    pub x: DVec3,
    /// 90° east of it.
    pub y: DVec3,
    /// The pole.
    pub z: DVec3,
}

impl Figure {
    /// True where it attracts like a point.
    pub fn is_point(&self) -> bool {
        self.radius_m <= 0.0 || (self.zonal == [0.0; 3] && self.c22 == 0.0 && self.tide[0] == 0.0)
    }

    /// The axes at `t`, in ICRF.
    pub fn axes(&self, t: SimTime) -> Axes {
        let turn = self.spin.icrf_from_fixed(t);
        let axis = |v: DVec3| turn.vector(Vector::<Fixed>::new(v)).0;
        Axes { x: axis(DVec3::X), y: axis(DVec3::Y), z: axis(DVec3::Z) }
    }

    /// Rate of its turn about the pole, rad/s.
    pub fn turn_rad_s(&self) -> f64 {
        self.spin.meridian_rad[1] / DAY
    }

    /// What the figure adds to a point's gravity at `at` from the body's centre, m/s².
    pub fn acceleration(&self, gm: f64, axes: &Axes, at: DVec3) -> DVec3 {
        let at = Position::<Icrf>::new(at);
        let flat = zonal(gm, self.zonal, self.radius_m, axes.z, at).0;
        if self.c22 == 0.0 { flat } else { flat + sectorial(gm, self.c22, self.radius_m, axes.x, axes.y, at).0 }
    }
}
