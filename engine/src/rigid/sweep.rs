//! Does a path cross the ground? Marches a chord against the height function itself: no mesh, so no speed tunnels through it.
//!
//! The step is the clearance over `1 + slope`, never under [`STEP_MIN_M`]: terrain that rises faster than [`SLOPE_MAX`] over less
//! than that could be missed, and no relief here is that steep. A crossing is then bisected to a micrometre.

use super::ground::Surface;
use glam::DVec3;

/// Steepest slope (rise over run) that the march allows for.
pub const SLOPE_MAX: f64 = 4.0;
/// Shortest step of the march, m.
pub const STEP_MIN_M: f64 = 0.25;

/// The fraction 0 … 1 of the chord `from → to` (Fixed axes, m) at which it first lies on or below the surface; none if it stays above.
pub fn first_hit(surface: &dyn Surface, from: DVec3, to: DVec3) -> Option<f64> {
    let length = (to - from).length();
    if !length.is_finite() {
        return Some(0.0);
    }
    let at = |s: f64| if length > 0.0 { from + (to - from) * (s / length) } else { from };
    let mut clear_to = 0.0;
    let mut s = 0.0;
    loop {
        let clearance = surface.clearance_m(at(s));
        if clearance.is_nan() || clearance <= 0.0 {
            return Some(if s > 0.0 { bisect(surface, &at, clear_to, s) / length } else { 0.0 });
        }
        if s >= length {
            return None;
        }
        clear_to = s;
        s = (s + (clearance / (1.0 + SLOPE_MAX)).max(STEP_MIN_M)).min(length);
    }
}

/// Narrows `[above, below]` to a micrometre and gives its upper end, which is still on the free side.
fn bisect(surface: &dyn Surface, at: &dyn Fn(f64) -> DVec3, mut above: f64, mut below: f64) -> f64 {
    while below - above > 1e-6 {
        let middle = 0.5 * (above + below);
        if middle <= above || middle >= below {
            break;
        }
        if surface.clearance_m(at(middle)) > 0.0 {
            above = middle;
        } else {
            below = middle;
        }
    }
    above
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::space::sphere;

    /// Analytic grounds for tests: a sphere with a wave on it, or a plane tilted by a given slope.
    pub(crate) struct Hills {
        pub radius_m: f64,
        pub amplitude_m: f64,
        pub wave_rad: f64,
        pub slope: f64,
        pub about: DVec3,
    }
    impl Hills {
        pub(crate) fn earth() -> Self {
            Self { radius_m: 6.371e6, amplitude_m: 30.0, wave_rad: 3e-5, slope: 0.0, about: DVec3::X }
        }
        pub(crate) fn slope(degrees: f64, about: DVec3) -> Self {
            let slope = libm::tan(degrees.to_radians());
            Self { radius_m: 6.371e6, amplitude_m: 0.0, wave_rad: 1.0, slope, about }
        }
    }
    impl Surface for Hills {
        fn radius_m(&self) -> f64 {
            self.radius_m
        }
        fn surface_m(&self, d: DVec3) -> f64 {
            let (_, _, north) = sphere::east_up_north(self.about);
            let wave = self.amplitude_m * libm::sin(d.x / self.wave_rad) * libm::cos((d.y + 0.7 * d.z) / self.wave_rad);
            wave + self.slope * self.radius_m * (d - self.about).dot(north)
        }
    }

    #[test]
    fn no_angle_and_no_speed_tunnels() {
        let hills = Hills::earth();
        let up = sphere::direction_of_lat_lon(0.3, 1.1);
        let (east, _, _) = sphere::east_up_north(up);
        for speed in [10.0, 300.0, 3_000.0, 12_000.0] {
            for below in [0.2_f64, 2.0, 10.0, 45.0, 90.0_f64] {
                let along = east * libm::cos(below.to_radians()) - up * libm::sin(below.to_radians());
                let mut p = up * (hills.radius_m + 31.0);
                let mut found = None;
                for _ in 0..200_000 {
                    let next = p + along * (speed / 60.0);
                    if let Some(f) = first_hit(&hills, p, next) {
                        found = Some(p + (next - p) * f);
                        break;
                    }
                    p = next;
                }
                let hit = found.unwrap_or_else(|| panic!("{speed} m/s at {below}° never met the ground"));
                let gap = hills.clearance_m(hit);
                assert!((0.0..2e-6).contains(&gap), "{speed} m/s at {below}°: gap {gap}");
                // Nothing before the hit was below ground, seen every 5 cm.
                let start = up * (hills.radius_m + 31.0);
                let n = ((hit - start).length() / 0.05).min(20_000.0);
                let mut k = 0.0;
                while k < n {
                    assert!(hills.clearance_m(hit + (start - hit) * (k * 0.05 / (hit - start).length())) > -1e-6);
                    k += 1.0;
                }
            }
        }
    }

    #[test]
    fn starts_below_ground_at_once_and_nan_is_a_hit() {
        let hills = Hills::earth();
        assert_eq!(first_hit(&hills, DVec3::X * 6.37e6, DVec3::X * 6.5e6), Some(0.0));
        assert_eq!(first_hit(&hills, DVec3::X * 6.5e6, DVec3::splat(f64::NAN)), Some(0.0));
        assert_eq!(first_hit(&hills, DVec3::X * 6.5e6, DVec3::X * 6.4e6), None);
    }
}
