//! Light that a world throws back: what a full or a waning moon sends to its planet.

use core::f64::consts::PI;

/// Illuminance by a sphere of Lambert albedo `albedo` and radius `radius_m` from `distance_m`, over that by the star at the sphere, at phase
/// angle `phase_rad` (0: full): `⅔ A (R/d)² (sin α + (π − α) cos α)/π` [Russell 1916, "On the Albedo of the Planets and Their Satellites"].
pub fn lambert_sphere(albedo: f64, radius_m: f64, distance_m: f64, phase_rad: f64) -> f64 {
    let ratio = radius_m / distance_m.max(radius_m).max(1e-3);
    let (sin, cos) = libm::sincos(phase_rad.clamp(0.0, PI));
    2.0 / 3.0 * albedo * ratio * ratio * ((sin + (PI - phase_rad.clamp(0.0, PI)) * cos) / PI).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_sphere_is_two_thirds_of_a_disc_and_a_half_one_less_than_a_third_of_that() {
        assert!((lambert_sphere(0.3, 1.0e6, 1.0e8, 0.0) / (0.2 * 1e-4) - 1.0).abs() < 1e-12);
        assert!((lambert_sphere(0.3, 1.0e6, 1.0e8, 0.5 * PI) / lambert_sphere(0.3, 1.0e6, 1.0e8, 0.0) - 1.0 / PI).abs() < 1e-12);
        assert!(lambert_sphere(0.3, 1.0e6, 1.0e8, PI).abs() < 1e-20);
        // The full Moon (Lambert albedo 0.12) under 133,000 lx sends a few tenths of a lux.
        let lux = 1.33e5 * lambert_sphere(0.12, 1.7374e6, 3.844e8, 0.0);
        assert!((0.1..0.4).contains(&lux), "{lux} lx");
    }
}
