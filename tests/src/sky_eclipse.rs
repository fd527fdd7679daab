//! Eclipsed air, and what is true of it: `reference/sky_eclipse.csv`, written from here by [`engine::air::reference`] with a moon before
//! the sun as on 2026-08-12: seen 1.0386 times as large, its shadow 65 km in radius across.

use crate::continuity::{moon_at, polar};
use crate::sky_truth::planet;
use engine::air::reference::{Options, Ray, Sphere, radiance};
use engine::units::KM;
use glam::DVec3;
use std::fmt::Write as _;

/// The moon's radius over the sun's, as they are seen.
pub const RATIO: f64 = 1.0386;
/// Where the point below the eye stands: by how much the shadow's axis misses it, m.
pub const PLACES: [(&str, f64); 6] =
    [("centre", 0.0), ("inside", 40e3), ("edge", 63e3), ("out", 80e3), ("half", 1700e3), ("first", 3000e3)];
/// Columns of the file.
pub const HEADER: &str = "class,cam_x_km,cam_y_km,cam_z_km,view_x,view_y,view_z,sun_x,sun_y,sun_z,moon_x_km,moon_y_km,moon_z_km,L1_r,L1_g,L1_b,L_r,L_g,L_b,stderr_r,stderr_g,stderr_b";

/// A ray of the file; radiances per unit of solar irradiance, sr⁻¹.
#[derive(Clone, Debug)]
pub struct Eclipsed {
    /// Where the eye is and how deep in the shadow: `ground centre`.
    pub class: String,
    /// The ray, its moon with it.
    pub ray: Ray,
    /// Radiance scattered once.
    pub single: DVec3,
    /// Radiance of all orders, and its standard error.
    pub total: (DVec3, DVec3),
}

/// Rays from the ground, from 10 km and from 400 km at every place, under three suns.
pub fn rays() -> Vec<(String, Ray)> {
    let planet = planet("earth");
    let bottom = planet.medium.bottom_radius_m;
    let mut out = Vec::new();
    for sun_zenith in [40.0, 64.0, 80.0] {
        let sun = (polar(sun_zenith, 0.0), planet.sun_rad);
        for (place, miss) in PLACES {
            let mut put = |eye: &str, altitude_m: f64, zenith: f64, azimuth: f64| {
                let ray = Ray {
                    from_m: DVec3::Z * (bottom + altitude_m),
                    direction: polar(zenith, azimuth),
                    sun: sun.0,
                    sun_rad: sun.1,
                    occluders: vec![moon_at(bottom, sun, RATIO, DVec3::Y * miss)],
                };
                out.push((format!("{eye} {place}"), ray));
            };
            for (zenith, azimuth) in [(0.0, 0.0), (45.0, 90.0), (70.0, 180.0), (85.0, 20.0), (88.0, 180.0), (89.5, 90.0)] {
                put("ground", 2.0, zenith, azimuth);
            }
            for (zenith, azimuth) in [(0.0, 0.0), (45.0, 90.0), (80.0, 180.0)] {
                put("10 km", 10.0 * KM, zenith, azimuth);
            }
            for (zenith, azimuth) in [(180.0, 0.0), (140.0, 90.0), (120.0, 180.0)] {
                put("400 km", 400.0 * KM, zenith, azimuth);
            }
        }
    }
    out
}

/// The file, header and all.
///
/// # Panics
/// Where the planet's file is missing.
pub fn write(rel_error: f64) -> String {
    let mut out = String::from(
        "# Radiances of eclipsed air over the planet `earth` by engine::air::reference, per unit of solar irradiance. Made by\n",
    );
    out += "# cargo test --release --workspace --test sky_continuity -- --ignored writes_the_eclipse\n";
    out += HEADER;
    out += "\n";
    let all = rays();
    let wanted: Vec<Ray> = all.iter().map(|r| r.1.clone()).collect();
    let options = Options { rel_error, max_walks: 1 << 18, ..Options::default() };
    for ((class, ray), found) in all.iter().zip(radiance(&planet("earth").medium, &wanted, &options)) {
        let moon_m = ray.occluders.first().map_or(DVec3::ZERO, |o| o.centre_m);
        let places = [ray.from_m / KM, ray.direction, ray.sun, moon_m / KM].map(|v| format!("{:.10},{:.10},{:.10}", v.x, v.y, v.z));
        let lights = [found.single, found.total, found.std_error].map(|v| format!("{:.5e},{:.5e},{:.5e}", v.x, v.y, v.z));
        writeln!(out, "{class},{},{}", places.join(","), lights.join(",")).expect("a string takes all");
    }
    out
}

/// Reads the file.
///
/// # Panics
/// Where a line is not as [`HEADER`] says.
pub fn read(text: &str) -> Vec<Eclipsed> {
    let sun_rad = planet("earth").sun_rad;
    let line = |line: &str| {
        let (class, rest) = line.split_once(',').expect("a class");
        let x: Vec<f64> = rest.split(',').map(|x| x.parse().expect("a number")).collect();
        let v = |i: usize| DVec3::new(x[3 * i], x[3 * i + 1], x[3 * i + 2]);
        let occluders = vec![Sphere { centre_m: v(3) * KM, radius_m: crate::continuity::MOON_M }];
        let ray = Ray { from_m: v(0) * KM, direction: v(1).normalize(), sun: v(2).normalize(), sun_rad, occluders };
        Eclipsed { class: class.to_owned(), ray, single: v(4), total: (v(5), v(6)) }
    };
    text.lines().filter(|l| !l.starts_with('#')).skip(1).map(line).collect()
}
