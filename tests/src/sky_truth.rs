//! Files of true radiances: `reference/sky_radiance_sample.csv`, published, and `reference/sky_truth.csv`, written from here by
//! [`engine::air::reference`] along other rays through other planets. Also the planets, `reference/planets/*.toml`.

use engine::air::reference::{Options, Ray, radiance, span};
use engine::air::{Medium, MediumSpec};
use engine::units::{DEG, KM};
use glam::DVec3;
use std::fmt::Write as _;

/// Names of the planets of `sky_truth.csv`.
pub const PLANETS: [&str; 5] = ["earth", "thick", "hazy", "dusty", "small"];
/// Rays through each of them.
pub const RAYS: u32 = 60;

/// A planet and its star.
#[derive(Clone, Debug)]
pub struct Planet {
    /// Its air.
    pub medium: Medium,
    /// Wavelengths of the three channels, nm.
    pub wavelengths_nm: [f64; 3],
    /// Solar irradiance at each, W m⁻² nm⁻¹.
    pub irradiance: DVec3,
    /// Angular radius of the sun, rad.
    pub sun_rad: f64,
}

/// Reads `reference/planets/<name>.toml`.
///
/// # Panics
/// Where it is missing or at fault.
pub fn planet(name: &str) -> Planet {
    let path = format!("{}/reference/planets/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect("the planet's file is there");
    let top: toml::Table = text.parse().expect("it is TOML");
    let numbers = |key: &str| -> [f64; 3] { top["star"][key].clone().try_into().expect("three numbers") };
    let spec: MediumSpec = top["atmosphere"].clone().try_into().expect("an atmosphere of keys that the engine knows");
    Planet {
        medium: spec.build(top["radius_km"].as_float().expect("a number") * KM).expect("a sound atmosphere"),
        wavelengths_nm: numbers("wavelengths_nm"),
        irradiance: numbers("irradiance_w_m2_nm").into(),
        sun_rad: top["star"]["angular_radius_deg"].as_float().expect("a number") * DEG,
    }
}

/// What is true of one ray, per channel.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Name of the planet.
    pub planet: String,
    /// Name of the ray.
    pub id: String,
    /// The ray; its sun is a point until the planet's is put in.
    pub ray: Ray,
    /// Transmittance.
    pub transmittance: DVec3,
    /// Radiance scattered once, W m⁻² sr⁻¹ nm⁻¹.
    pub single: DVec3,
    /// Radiance of all orders.
    pub total: DVec3,
    /// Its standard error.
    pub std_error: DVec3,
}

/// Reads a file of truths, three wavelengths a ray in the planet's order.
///
/// # Panics
/// Where a line is not as [`HEADER`] says.
pub fn read(text: &str) -> Vec<Truth> {
    let lines: Vec<&str> = text.lines().filter(|l| !l.starts_with('#')).skip(1).collect();
    let one = |rows: &[&str]| {
        let cells: Vec<Vec<&str>> = rows.iter().map(|r| r.split(',').collect()).collect();
        let x = |channel: usize, i: usize| -> f64 { cells[channel][i].parse().expect("a number") };
        let place = |i: usize| DVec3::new(x(0, i), x(0, i + 1), x(0, i + 2));
        let value = |i: usize| DVec3::new(x(0, i), x(1, i), x(2, i));
        assert!(cells.iter().all(|c| c[1] == cells[0][1]), "three wavelengths a ray");
        Truth {
            planet: cells[0][0].to_owned(),
            id: cells[0][1].to_owned(),
            ray: Ray {
                from_m: place(2) * KM,
                direction: place(5).normalize(),
                sun: place(8).normalize(),
                sun_rad: 0.0,
                occluders: Vec::new(),
            },
            transmittance: value(13),
            single: value(14),
            total: value(15),
            std_error: value(16),
        }
    };
    lines.chunks(3).map(one).collect()
}

/// Columns of both files.
pub const HEADER: &str =
    "planet,id,cam_x_km,cam_y_km,cam_z_km,view_x,view_y,view_z,sun_x,sun_y,sun_z,hits_ground,wavelength_nm,T_view,L1,L_total,stderr_total";

/// Digit `i` of the van der Corput sequence in a base, 0 ≤ x < 1.
fn radical_inverse(mut i: u32, base: u32) -> f64 {
    let (mut x, mut scale) = (0.0, 1.0);
    while i > 0 {
        scale /= f64::from(base);
        x += f64::from(i % base) * scale;
        i /= base;
    }
    x
}

/// To what the file holds, so that the truth is that of the ray as it is read.
fn rounded(v: DVec3) -> DVec3 {
    (v * 1e9).round() / 1e9
}

/// Ray `i` through a planet: from the ground, from within, from space to the limb and to the ground, under suns from 0 to 97°.
pub fn ray(planet: &Planet, i: u32) -> (String, Ray) {
    let [a, b, c, d] = [2, 3, 5, 7].map(|base| radical_inverse(i + 1, base));
    let (bottom, top) = (planet.medium.bottom_radius_m, planet.medium.top_altitude_m);
    let sun_zenith = match i % 4 {
        0 | 1 => 85.0 * a,
        2 => 85.0 + 7.0 * a,
        _ => 92.0 + 5.0 * a,
    } * DEG;
    let azimuth = 180.0 * b * DEG;
    let polar = |zenith: f64, azimuth: f64| DVec3::new(zenith.sin() * azimuth.cos(), zenith.sin() * azimuth.sin(), zenith.cos());
    // The sun stands at `sun_zenith` over the camera, or over the point of the limb or the ground that is looked at.
    let sun = polar(sun_zenith, azimuth);
    let (kind, from, view) = match i % 6 {
        0 => ("ground", DVec3::Z * (bottom + 2.0), polar(90.0 * c * DEG, 0.0)),
        1 => ("horizon", DVec3::Z * (bottom + 2.0), polar((80.0 + 10.0 * c) * DEG, 0.0)),
        2 => ("within", DVec3::Z * (bottom + 10.0 * KM * (top / (60.0 * KM))), polar(180.0 * c * DEG, 0.0)),
        3 | 4 => {
            // Back along the line of sight from the lowest point to a camera in space.
            let low = DVec3::Z * (bottom + top * 0.7 * c * c);
            ("limb", low - DVec3::X * (bottom * (0.4 + 2.0 * d)), DVec3::X)
        }
        _ => {
            let slant = polar((180.0 - 80.0 * c) * DEG, 0.0);
            ("down", DVec3::Z * bottom - slant * (top * 3.0 + bottom * d), slant)
        }
    };
    let id = format!("{kind}_{i}_sz{:.1}_az{:.0}", sun_zenith / DEG, azimuth / DEG);
    let ray = Ray {
        from_m: rounded(from / KM) * KM,
        direction: rounded(view).normalize(),
        sun: rounded(sun).normalize(),
        sun_rad: planet.sun_rad,
        occluders: Vec::new(),
    };
    (id, ray)
}

/// The lines of `sky_truth.csv`, header and all.
///
/// # Panics
/// Where a planet's file is missing.
pub fn write(rel_error: f64) -> String {
    let mut out = String::from("# True radiances by engine::air::reference; planets in reference/planets/. Made by\n");
    out += "# cargo test --release --workspace --test sky_truth -- --ignored writes_the_truth\n";
    out += HEADER;
    out += "\n";
    for name in PLANETS {
        let planet = planet(name);
        let rays: Vec<(String, Ray)> = (0..RAYS).map(|i| ray(&planet, i)).collect();
        let options = Options { rel_error, max_walks: 1 << 18, ..Options::default() };
        let wanted: Vec<Ray> = rays.iter().map(|r| r.1.clone()).collect();
        for ((id, ray), found) in rays.iter().zip(radiance(&planet.medium, &wanted, &options)) {
            let hits = span(&planet.medium, ray.from_m, ray.direction).is_some_and(|s| s.hits_ground);
            for channel in 0..3 {
                let sun = planet.irradiance[channel];
                let [p, v, s] = [ray.from_m / KM, ray.direction, ray.sun].map(|v| format!("{:.9},{:.9},{:.9}", v.x, v.y, v.z));
                let (wavelength, t) = (planet.wavelengths_nm[channel], found.transmittance[channel]);
                let [l1, l, e] = [found.single, found.total, found.std_error].map(|x| x[channel] * sun);
                let line = format!("{name},{id},{p},{v},{s},{},{wavelength},{t:.7e},{l1:.7e},{l:.7e},{e:.2e}", u8::from(hits));
                writeln!(out, "{line}").expect("a string takes all");
            }
        }
    }
    out
}
