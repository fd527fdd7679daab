//! The star as a light: illuminance and angular size at a distance.

use glam::Vec3;

/// Illuminance, lx per channel, on a surface that faces a source of `intensity_cd` at `distance_m` (inverse square).
/// Zero where the distance is not positive.
pub fn illuminance_lx(intensity_cd: Vec3, distance_m: f64) -> Vec3 {
    if distance_m > 0.0 { intensity_cd * crate::space::relative::narrow(1.0 / (distance_m * distance_m)) } else { Vec3::ZERO }
}

/// Angular radius, rad, of a sphere seen from `distance_m` to its centre; a right angle from its surface inwards.
pub fn angular_radius_rad(radius_m: f64, distance_m: f64) -> f64 {
    if distance_m > radius_m { libm::asin(radius_m / distance_m) } else { core::f64::consts::FRAC_PI_2 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{AU, DEG, KM};

    #[test]
    fn the_sun_from_the_earth() {
        // 1.28e5 lx at 1 AU needs 1.28e5 · AU² cd.
        let intensity = Vec3::splat(crate::space::relative::narrow(1.28e5 * AU * AU));
        assert!((illuminance_lx(intensity, AU).x / 1.28e5 - 1.0).abs() < 1e-6);
        assert!((illuminance_lx(intensity, 2.0 * AU).x / 0.32e5 - 1.0).abs() < 1e-6);
        // IAU 2015 nominal solar radius 695,700 km: 959.23″.
        assert!((angular_radius_rad(695_700.0 * KM, AU) / DEG - 0.266_45).abs() < 1e-5);
        assert_eq!(illuminance_lx(intensity, 0.0), Vec3::ZERO);
    }
}
