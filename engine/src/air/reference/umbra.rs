//! Truth for a planet's shadow: rays traced back from a receiver through bending air, and those counted that come from the sun.
//!
//! Nothing is shared with [`super::super::refraction`] but the profiles: a ray follows `d/ds (n dr/ds) = ∇n` in its plane by Runge and
//! Kutta's fourth order, optical depth with it; the sky around the planet is cut into rings and sectors, each of which is on the sun's disc or not.

use crate::air::{Air, Medium};
use glam::{DVec2, DVec3};

/// What is asked: a place in the shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// From the planet's centre, m; above the air.
    pub distance_m: f64,
    /// Angle between the star's centre and the planet's, rad.
    pub separation_rad: f64,
    /// From the planet's centre to the star's, m.
    pub star_distance_m: f64,
    /// Radius of the star, m.
    pub star_radius_m: f64,
}

/// How finely it is answered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Rings of sight about the planet's centre, from the ground's limb to the top of the air.
    pub rings: u32,
    /// Sectors of each.
    pub sectors: u32,
    /// Steps of a ray through the air.
    pub steps: u32,
}

impl Default for Grid {
    /// Good to 0.3 %.
    fn default() -> Self {
        Self { rings: 3000, sectors: 3000, steps: 400 }
    }
}

/// A ray that has been followed: how it leaves, and what was left of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traced {
    /// Where it leaves the air, m, in its plane: x from the receiver towards the planet's centre.
    pub at_m: DVec2,
    /// Unit vector.
    pub direction: DVec2,
    /// Transmittance, linear sRGB under the star's own light.
    pub transmittance: DVec3,
}

/// Follows a ray that leaves the receiver at `angle_rad` from the planet's centre; `None` where it meets the ground.
pub fn trace(air: &Air, distance_m: f64, angle_rad: f64, steps: u32) -> Option<Traced> {
    let medium = &air.medium;
    let (bottom, top) = (medium.bottom_radius_m, medium.bottom_radius_m + medium.top_altitude_m);
    let media: Vec<&Medium> = air.bands.as_ref().map_or_else(|| vec![medium], |b| b.list.iter().map(|band| &band.medium).collect());
    let index = |h: f64| 1.0 + air.gases.iter().map(|g| g.refractivity * g.profile.density(h)).sum::<f64>();
    let (sin, cos) = libm::sincos(angle_rad);
    let direction = DVec2::new(cos, sin);
    let from = DVec2::new(-distance_m, 0.0);
    let miss = distance_m * sin;
    if miss >= top {
        return Some(Traced { at_m: from, direction, transmittance: DVec3::ONE });
    }
    let mut at = from + direction * (distance_m * cos - (top * top - miss * miss).sqrt());
    // The optical direction n dr/ds, and d(n dr/ds)/ds = ∇n, of central differences.
    let mut moving = direction * index(top - bottom);
    let gradient = |p: DVec2| {
        let (r, step) = (p.length(), 0.5);
        p / r * ((index(r - bottom + step) - index(r - bottom - step)) / (2.0 * step))
    };
    let mut depths = vec![DVec3::ZERO; media.len()];
    let length = 2.0 * ((top - miss) * (top + miss)).max(1.0).sqrt();
    let step = length / f64::from(steps);
    for _ in 0..8 * steps {
        let rate = |p: DVec2, m: DVec2| (m / index(p.length() - bottom), gradient(p));
        let (v1, g1) = rate(at, moving);
        let (v2, g2) = rate(at + v1 * (0.5 * step), moving + g1 * (0.5 * step));
        let (v3, g3) = rate(at + v2 * (0.5 * step), moving + g2 * (0.5 * step));
        let (v4, g4) = rate(at + v3 * step, moving + g3 * step);
        let middle = at + v2 * (0.5 * step);
        let next = at + (v1 + 2.0 * v2 + 2.0 * v3 + v4) * (step / 6.0);
        for (depth, medium) in depths.iter_mut().zip(&media) {
            let [a, b, c] = [at, middle, next].map(|p| medium.extinction(p.length() - bottom));
            *depth += (a + 4.0 * b + c) * (step / 6.0);
        }
        at = next;
        moving += (g1 + 2.0 * g2 + 2.0 * g3 + g4) * (step / 6.0);
        if at.length() < bottom {
            return None;
        }
        if at.length() > top && at.dot(moving) > 0.0 {
            let through = |d: &DVec3| DVec3::new(libm::exp(-d.x), libm::exp(-d.y), libm::exp(-d.z));
            let transmittance = match &air.bands {
                Some(bands) => bands.mix(|k, _| through(&depths[k])),
                None => through(&depths[0]),
            };
            return Some(Traced { at_m: at, direction: moving.normalize_or(direction), transmittance });
        }
    }
    None
}

/// Light of the star at the receiver, over that of the free disc, linear sRGB.
pub fn light(air: &Air, receiver: &Receiver, grid: &Grid) -> DVec3 {
    let medium = &air.medium;
    let (bottom, top) = (medium.bottom_radius_m, medium.bottom_radius_m + medium.top_altitude_m);
    let d = receiver.distance_m;
    let [low, high] = [bottom, top].map(|r| libm::asin(r / d));
    // The star's centre, from the planet's.
    let reach = {
        // At the given angle from the direction to the planet's centre, and at the star's distance from that centre.
        let (sin, cos) = libm::sincos(receiver.separation_rad);
        let away = d * cos + ((receiver.star_distance_m - d * sin) * (receiver.star_distance_m + d * sin)).sqrt();
        DVec3::new(away * cos - d, away * sin, 0.0)
    };
    let sun_rad = libm::asin(receiver.star_radius_m / (reach + DVec3::X * d).length());
    let step = (high - low) / f64::from(grid.rings);
    // Around a disc so wide that its air bends nothing across, only the sectors near the star can meet it.
    let turn = if 20.0 * sun_rad < libm::sin(low) { 3.0 * sun_rad / libm::sin(low) } else { core::f64::consts::PI };
    let mut sum = DVec3::ZERO;
    for i in 0..grid.rings {
        let angle = low + (f64::from(i) + 0.5) * step;
        let Some(ray) = trace(air, d, angle, grid.steps) else { continue };
        let share = sector_share(&ray, reach, receiver.star_radius_m, turn, grid.sectors);
        sum += ray.transmittance * (share * (libm::cos(angle - 0.5 * step) - libm::cos(angle + 0.5 * step)));
    }
    // Past the air, straight: the part of the disc outside of the circle of its top, by chords of the disc.
    let free = beyond(high, sun_rad, receiver.separation_rad, grid.sectors);
    sum / (1.0 - libm::cos(sun_rad)) + DVec3::splat(free)
}

/// Share of a ring from whose rays the star is met; they turn from it by no more than `turn` (half the ring is looked at).
fn sector_share(ray: &Traced, star: DVec3, star_radius_m: f64, turn: f64, sectors: u32) -> f64 {
    let mut met = 0_u32;
    for k in 0..sectors {
        let (sin, cos) = libm::sincos(turn * (f64::from(k) + 0.5) / f64::from(sectors));
        let turned = |v: DVec2| DVec3::new(v.x, v.y * cos, v.y * sin);
        let (at, direction) = (turned(ray.at_m), turned(ray.direction));
        let to = star - at;
        met += u32::from((to - direction * to.dot(direction)).length_squared() < star_radius_m * star_radius_m);
    }
    f64::from(met) / f64::from(sectors) * turn / core::f64::consts::PI
}

/// Share of the sun's disc outside of a circle, counted on a grid of the disc.
fn beyond(circle_rad: f64, sun_rad: f64, separation_rad: f64, cells: u32) -> f64 {
    let (mut out, mut all) = (0_u32, 0_u32);
    let n = cells.min(1000);
    for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
        let [x, y] = [i, k].map(|i| ((f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0) * sun_rad);
        if x * x + y * y < sun_rad * sun_rad {
            all += 1;
            // Spherical: x towards the planet's centre.
            let (s, c) = libm::sincos(separation_rad - x);
            out += u32::from(c * libm::cos(y) < libm::cos(circle_rad) && s.is_finite());
        }
    }
    f64::from(out) / f64::from(all.max(1))
}
