//! Rotation: where a body's pole and prime meridian point [Archinal et al. 2018, IAU WGCCRE 2015 report].

use crate::space::{Fixed, Icrf, Rotation, Vector};
use crate::time::SimTime;
use crate::units::{DAY, JULIAN_CENTURY};
use core::f64::consts::FRAC_PI_2;
use glam::DQuat;

/// Pole and prime meridian of a body: right ascension and declination of the pole, and W.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spin {
    /// Right ascension of the pole at J2000, rad, and its rate, rad per Julian century.
    pub pole_ra_rad: [f64; 2],
    /// Declination of the pole at J2000, rad, and its rate, rad per Julian century.
    pub pole_dec_rad: [f64; 2],
    /// Prime meridian W at J2000, rad, and its rate, rad per day.
    pub meridian_rad: [f64; 2],
}

impl Spin {
    /// The body's axes at `t`: `R_z(α + 90°) R_x(90° − δ) R_z(W)`.
    pub fn icrf_from_fixed(&self, t: SimTime) -> Rotation<Icrf, Fixed> {
        let s = t.seconds();
        let ra = self.pole_ra_rad[0] + self.pole_ra_rad[1] * (s / JULIAN_CENTURY);
        let dec = self.pole_dec_rad[0] + self.pole_dec_rad[1] * (s / JULIAN_CENTURY);
        let w = self.meridian_rad[0] + self.meridian_rad[1] * (s / DAY);
        let about_z = |a: f64| DQuat::from_xyzw(0.0, 0.0, libm::sin(0.5 * a), libm::cos(0.5 * a));
        let about_x = |a: f64| DQuat::from_xyzw(libm::sin(0.5 * a), 0.0, 0.0, libm::cos(0.5 * a));
        Rotation::new(about_z(ra + FRAC_PI_2) * about_x(FRAC_PI_2 - dec) * about_z(w))
    }

    /// Angular velocity at `t`, in ICRF axes, rad/s.
    pub fn angular_velocity(&self, t: SimTime) -> Vector<Icrf> {
        self.icrf_from_fixed(t).vector(Vector::xyz(0.0, 0.0, self.meridian_rad[1] / DAY))
    }
}
