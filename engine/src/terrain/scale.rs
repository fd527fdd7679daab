//! Relief read from afar: displacement is multiplied by a factor that grows with the camera's distance, after R. Josth,
//! "Real Time Atmosphere Rendering for the Space Simulators" ("mountain scale depends on the camera distance").
//!
//! The factor is one number per body and frame, a function of the camera's altitude: so it neither bends the ground nor
//! opens cracks between tiles. It is 1, exactly, below 1 % of the body's radius, where a pilot compares ground and altimeter; the
//! shaders read it as a finished number (`relief_scale` of a tile batch). Collisions never see it.

/// Altitude, in body radii, up to which relief is true.
pub const TRUE_BELOW: f64 = 0.01;
/// Altitude, in body radii, from which relief is scaled fully.
pub const FULL_ABOVE: f64 = 2.0;

/// Factor on displacement for a camera at `altitude_m` above a datum of `radius_m`: 1 … `relief_max`.
pub fn relief_scale(altitude_m: f64, radius_m: f64, relief_max: f64) -> f64 {
    let x = altitude_m / radius_m.max(1.0);
    if x <= TRUE_BELOW || relief_max <= 1.0 {
        return 1.0;
    }
    let t = (libm::log2(x / TRUE_BELOW) / libm::log2(FULL_ABOVE / TRUE_BELOW)).clamp(0.0, 1.0);
    1.0 + (relief_max - 1.0) * t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn true_near_the_ground_full_from_afar_and_never_a_jump() {
        assert_eq!(relief_scale(60_000.0, 6.371e6, 8.0), 1.0);
        assert_eq!(relief_scale(1e9, 6.371e6, 8.0), 8.0);
        assert_eq!(relief_scale(1e9, 6.371e6, 1.0), 1.0);
        let mut last = 1.0;
        for i in 0..2000 {
            let s = relief_scale(60_000.0 * libm::exp(f64::from(i) * 0.003), 6.371e6, 8.0);
            assert!(s >= last && s - last < 0.03, "{s} after {last}");
            last = s;
        }
        assert_eq!(last, 8.0);
    }
}
