//! Occlusion: which fraction of the sun's disc is free behind the discs of other bodies.
//!
//! The disc is uniform (limb darkening is left out: at half cover it would change the light by about 2 %). Angles, not
//! cosines: separations come from `2·asin(½|a−b|)`, which keeps its digits where `acos(a·b)` loses half of them
//! [Kahan 2006, "How Futile are Mindless Assessments of Roundoff", §12]. `shaders/lib/occlusion.wgsl` is the same in f32; `tests/` compares them.
//!
//! # The lens
//! Two circles of radii α (sun) and ρ (occluder) whose centres stand s apart share the lens `α²·seg(A) + ρ²·seg(B)`,
//! `seg(x) = x − ½ sin 2x`, where A and B are the angles of the triangle (α, ρ, s) at the two centres. By half angles
//! `tan²(A/2) = e₁e₂/(e₀e₃)`, `tan²(B/2) = e₁e₃/(e₀e₂)` with `e₀ = s+α+ρ`, `e₁ = α+ρ−s`, `e₂ = s+ρ−α`, `e₃ = s+α−ρ`: differences of inputs
//! only, so that nothing is lost near a tangency, where the textbook's `acos` is flat.
//!
//! Circles on the sphere are not plane circles: one of angular radius ρ curves like a plane circle of radius tan ρ. So ρ is
//! replaced by tan ρ with the gap `g = s − ρ` from its limb to the sun's centre kept. Where `tan ρ > 4096 α` the limb is straight.

use core::f64::consts::PI;
use glam::DVec3;

/// Beyond this ratio of radii a limb is straight (the fraction changes by under 6e-5).
const STRAIGHT: f64 = 4096.0;

/// A disc in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Unit vector towards its centre.
    pub direction: DVec3,
    /// Angular radius, rad.
    pub radius_rad: f64,
}

impl Disc {
    /// The disc of a sphere whose centre lies at `offset` metres from the eye.
    pub fn of_sphere(offset: DVec3, radius_m: f64) -> Self {
        let distance_m = offset.length();
        Self { direction: offset.normalize_or(DVec3::Z), radius_rad: super::sun::angular_radius_rad(radius_m, distance_m) }
    }
}

/// Angle between two unit vectors, rad: exact to rounding at all angles up to a right angle, and good to 1e-8 beyond.
pub fn separation_rad(a: DVec3, b: DVec3) -> f64 {
    2.0 * libm::asin((0.5 * (a - b).length()).min(1.0))
}

/// `x − ½ sin 2x`, by its series where the difference would cancel.
fn segment(x: f64) -> f64 {
    if x < 0.3 {
        let y = x * x;
        x * y * (2.0 / 3.0 - y * (2.0 / 15.0 - y * (4.0 / 315.0 - y * (2.0 / 2835.0))))
    } else {
        x - 0.5 * libm::sin(2.0 * x)
    }
}

/// Visible fraction of the sun's disc behind one disc, 0 … 1.
///
/// `sun_rad` and `occluder_rad` are angular radii, `separation_rad` the angle between the centres. Exactly 1 when the discs do not
/// meet, exactly 0 when the sun is covered, `1 − (tan ρ/α)²` when the occluder stands wholly before it.
pub fn visible_behind_disc(sun_rad: f64, occluder_rad: f64, separation_rad: f64) -> f64 {
    let gap = separation_rad - occluder_rad;
    if gap >= sun_rad {
        return 1.0;
    }
    if gap <= -sun_rad {
        return 0.0;
    }
    let rho = if occluder_rad < 1.57 { libm::tan(occluder_rad) } else { f64::INFINITY };
    if rho > STRAIGHT * sun_rad {
        return visible_above_limb(sun_rad, gap);
    }
    let e2 = 2.0 * rho + gap - sun_rad;
    if e2 <= 0.0 {
        return 1.0 - (rho / sun_rad) * (rho / sun_rad);
    }
    let (e0, e1, e3) = (2.0 * rho + gap + sun_rad, sun_rad - gap, sun_rad + gap);
    let a = 2.0 * libm::atan((e1 * e2 / (e0 * e3)).sqrt());
    let b = 2.0 * libm::atan((e1 * e3 / (e0 * e2)).sqrt());
    let ratio = rho / sun_rad;
    (1.0 - (segment(a) + ratio * ratio * segment(b)) / PI).clamp(0.0, 1.0)
}

/// Visible fraction of the sun's disc above a straight limb, 0 … 1; `elevation_rad` is the angle from the limb up to the sun's centre.
pub fn visible_above_limb(sun_rad: f64, elevation_rad: f64) -> f64 {
    let x = (elevation_rad / sun_rad).clamp(-1.0, 1.0);
    // The covered segment subtends 2a with cos a = x; the half angle keeps its digits at both ends.
    let a = 2.0 * libm::atan2((1.0 - x).sqrt(), (1.0 + x).sqrt());
    (1.0 - segment(a) / PI).clamp(0.0, 1.0)
}

/// Mean of [`visible_above_limb`] while the elevation goes evenly from one value to another.
pub fn visible_between(sun_rad: f64, from_rad: f64, to_rad: f64) -> f64 {
    let (a, b) = (from_rad / sun_rad, to_rad / sun_rad);
    if a.min(b) >= 1.0 {
        return 1.0;
    }
    if a.max(b) <= -1.0 {
        return 0.0;
    }
    if (b - a).abs() < 1e-4 {
        return visible_above_limb(sun_rad, 0.5 * (from_rad + to_rad));
    }
    ((visible_integral(b) - visible_integral(a)) / (b - a)).clamp(0.0, 1.0)
}

/// Antiderivative of the visible fraction by the elevation in units of the sun's radius.
fn visible_integral(x: f64) -> f64 {
    let c = x.clamp(-1.0, 1.0);
    let root = (1.0 - c * c).sqrt();
    (x - 1.0).max(0.0) + 0.5 * c + (c * libm::asin(c) + root - root * root * root / 3.0) / PI
}

/// Visible fraction of the sun's disc behind several discs, 0 … 1: the product of the single fractions. This is exact when
/// at most one of them stands before the sun, and lies between the two true extremes (apart, or one behind the other) when two do.
pub fn visible(sun: Disc, occluders: &[Disc]) -> f64 {
    occluders.iter().map(|o| visible_behind_disc(sun.radius_rad, o.radius_rad, separation_rad(sun.direction, o.direction))).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{AU, DEG, KM};

    const SUN: f64 = 0.2666 * DEG;

    /// Free area by slicing the disc into thin chords, each cut by the occluder's chord. Plane circles.
    fn sliced(sun: f64, occluder: f64, separation: f64) -> f64 {
        let n = 200_000;
        let mut covered = 0.0;
        for i in 0..n {
            let y = sun * ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0);
            let half = (sun * sun - y * y).max(0.0).sqrt();
            let other = (occluder * occluder - y * y).max(0.0).sqrt();
            covered += (half.min(separation + other) - (-half).max(separation - other)).max(0.0);
        }
        1.0 - covered * (2.0 * sun / f64::from(n)) / (PI * sun * sun)
    }

    #[test]
    fn the_mean_between_two_elevations_is_the_integral() {
        for (a, b) in [(-3.0, 2.0), (-0.9, -0.2), (0.3, 0.300_01), (0.5, 9.0), (1.0, -1.0)] {
            let n = 20_000;
            let at = |i: i32| visible_above_limb(SUN, SUN * (a + (b - a) * (f64::from(i) + 0.5) / f64::from(n)));
            let truth = (0..n).map(at).sum::<f64>() / f64::from(n);
            assert!((visible_between(SUN, SUN * a, SUN * b) - truth).abs() < 1e-6, "{a}, {b}");
        }
        assert_eq!((visible_between(SUN, SUN, 9.0), visible_between(SUN, -9.0, -SUN)), (1.0, 0.0));
    }

    #[test]
    fn the_lens_is_the_area() {
        let mut worst = 0.0_f64;
        for ratio in [0.2, 0.95, 1.0, 1.04, 3.0, 30.0] {
            for k in 1..24 {
                let rho = ratio * SUN;
                let s = (rho - SUN).abs() + (SUN.min(rho) * 2.0) * f64::from(k) / 24.0;
                // The planar reference knows no tan ρ: take it out of the way.
                let exact = sliced(SUN, rho, s);
                let flat = libm::atan(rho);
                worst = worst.max((visible_behind_disc(SUN, flat, flat + (s - rho)) - exact).abs());
            }
        }
        assert!(worst < 1e-6, "{worst}");
    }

    #[test]
    fn contacts_are_exact_and_continuous() {
        let moon = 1.04 * SUN;
        assert_eq!(visible_behind_disc(SUN, moon, SUN + moon), 1.0);
        assert_eq!(visible_behind_disc(SUN, moon, 0.04 * SUN - 1e-9), 0.0);
        assert_eq!(visible_behind_disc(SUN, moon, 0.0), 0.0);
        assert_eq!(visible_behind_disc(SUN, SUN, 0.0), 0.0);
        let small = 0.9 * SUN;
        let annular = 1.0 - (libm::tan(small) / SUN) * (libm::tan(small) / SUN);
        assert_eq!(visible_behind_disc(SUN, small, 0.0), annular);
        // Just inside each tangency the fraction must leave its end value by next to nothing.
        for (occluder, s, end) in [(moon, SUN + moon - 1e-12, 1.0), (moon, 0.04 * SUN + 1e-12, 0.0), (small, 0.1 * SUN + 1e-12, annular)] {
            assert!((visible_behind_disc(SUN, occluder, s) - end).abs() < 1e-7, "{s}");
        }
    }

    #[test]
    fn a_great_limb_is_straight() {
        // From a low orbit the Earth is a disc of 70°: its limb must act like a straight one, through the switch and beyond.
        for rho in [70.0 * DEG, 86.9 * DEG, 86.95 * DEG, 89.99 * DEG] {
            for x in [-0.9, -0.3, 0.0, 0.5, 0.99] {
                let curved = visible_behind_disc(SUN, rho, rho + x * SUN);
                assert!((curved - visible_above_limb(SUN, x * SUN)).abs() < 1e-3, "{rho} {x}");
            }
        }
        assert_eq!(visible_above_limb(SUN, 0.0), 0.5);
        assert_eq!((visible_above_limb(SUN, SUN), visible_above_limb(SUN, -SUN)), (1.0, 0.0));
    }

    #[test]
    fn the_moon_covers_the_sun_in_the_umbra_only() {
        // Mean distances: the umbra of the Moon ends about 374,000 km behind it.
        let sun = DVec3::new(AU, 0.0, 0.0);
        let moon_at = |d_km: f64| Disc::of_sphere(DVec3::new(d_km * KM, 0.0, 0.0), 1737.4 * KM);
        let disc = Disc::of_sphere(sun, 695_700.0 * KM);
        assert_eq!(visible(disc, &[moon_at(360_000.0)]), 0.0);
        let ring = visible(disc, &[moon_at(400_000.0)]);
        assert!(ring > 0.1 && ring < 0.15, "{ring}");
        assert_eq!(visible(disc, &[]), 1.0);
        let aside = Disc::of_sphere(DVec3::new(360_000.0 * KM, 3000.0 * KM, 0.0), 1737.4 * KM);
        assert!((0.0..1.0).contains(&visible(disc, &[aside])));
    }

    #[test]
    fn small_separations_keep_their_digits() {
        for angle in [1e-9, 1e-6, 1e-3, 0.5] {
            let b = DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
            assert!((separation_rad(DVec3::X, b) / angle - 1.0).abs() < 1e-7, "{angle}");
        }
    }
}
