//! Pressure of sunlight on a sphere (a "cannonball"): the simplest model that has the right size and direction.
//!
//! - [Montenbruck & Gill 2000] "Satellite Orbits", eq. 3.75.

use crate::units::{AU, SPEED_OF_LIGHT};
use glam::DVec3;

/// Total irradiance of the Sun at 1 AU, W/m² (IAU 2015 Resolution B3, nominal: 3.828e26 W over 4π AU²).
pub const SUN_AT_1_AU_W_M2: f64 = 1361.166;

/// Acceleration away from the star, m/s²: `C_R (A/m) (S/c) (AU/r)²`. `from_star` is the place seen from the star, m; `area_to_mass_m2_kg` the
/// cross section over the mass; `reflectivity` C_R is 1 for black, 2 for a mirror; `irradiance_at_1_au_w_m2` the star's; `lit` the
/// part of its disc that is seen, 0 … 1.
pub fn cannonball(from_star: DVec3, area_to_mass_m2_kg: f64, reflectivity: f64, irradiance_at_1_au_w_m2: f64, lit: f64) -> DVec3 {
    let r2 = from_star.length_squared();
    if r2 <= 0.0 {
        return DVec3::ZERO;
    }
    let pressure = irradiance_at_1_au_w_m2 / SPEED_OF_LIGHT * (AU * AU / r2);
    from_star * (lit * reflectivity * area_to_mass_m2_kg * pressure / r2.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_one_au_a_square_metre_a_kilogram_is_pushed_by_4_56_micronewtons() {
        // Montenbruck & Gill: P = 4.56e-6 N/m² at 1 AU.
        let a = cannonball(DVec3::Y * AU, 1.0, 1.0, SUN_AT_1_AU_W_M2, 1.0);
        assert!((a.y - 4.54e-6).abs() < 0.03e-6 && a.x == 0.0, "{a}");
        let far = cannonball(DVec3::Y * (2.0 * AU), 1.0, 1.5, SUN_AT_1_AU_W_M2, 0.5);
        assert!((far.y / a.y - 0.1875).abs() < 1e-12);
        assert_eq!(cannonball(DVec3::ZERO, 1.0, 1.0, SUN_AT_1_AU_W_M2, 1.0), DVec3::ZERO);
    }
}
