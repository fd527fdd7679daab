//! `syzygy probe sky`: spectral radiance along the rays of a CSV file, by the f64 reference or by any model that draws.
//!
//! A model's radiance comes from its own tables and its shader's function ([`engine::render::pass::sky_probe`]); the reference's from
//! [`engine::air::reference`]. Rows that name the same ray at different wavelengths are one ray.

use crate::assets::AssetErrors;
use crate::assets::planet::{Planet, Star, read_planet};
use crate::cli::{Backend, ProbeSkyArgs};
use engine::air::reference::{Options, Ray, Sphere, radiance_noting};
use engine::gpu::{Gpu, GpuError, ShaderLibrary};
use engine::render::RenderError;
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, probe};
use engine::scene::Occluder;
use engine::space::relative::{narrow, narrow3};
use engine::units::KM;
use glam::DVec3;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Columns that a file of rays must have, in any order; others are carried through.
pub const COLUMNS: [&str; 10] =
    ["cam_x_km", "cam_y_km", "cam_z_km", "view_x", "view_y", "view_z", "sun_x", "sun_y", "sun_z", "wavelength_nm"];

/// The name of the f64 integrator among the models.
pub const REFERENCE: &str = "reference";

/// Why there are no radiances.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum SkyError {
    /// The rays cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line is no ray.
    #[error("{}:{line}: `{text}`: {expected}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What stands there.
        text: String,
        /// What should.
        expected: String,
    },
    /// The planet is at fault.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Planet(#[from] AssetErrors),
    /// No device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The device failed.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A way of seeing, whatever the wavelength: eye (m), directions.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sight {
    from_m: DVec3,
    view: DVec3,
    sun: DVec3,
}

/// A line of the file: its text, which sight it names, and which of the star's wavelengths.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    text: String,
    sight: usize,
    channel: usize,
}

/// Rays to answer for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rays {
    header: String,
    sights: Vec<Sight>,
    rows: Vec<Row>,
}

/// Radiance and its standard error per row, W m⁻² sr⁻¹ nm⁻¹.
type Found = Vec<(f64, Option<f64>)>;

/// Reads rays: a header with the [`COLUMNS`] in any order, then a row each; lines that begin with `#` are passed over.
pub fn rays(path: &Path, star: &Star) -> Result<Rays, SkyError> {
    let text = std::fs::read_to_string(path).map_err(|source| SkyError::Read { path: path.to_owned(), source })?;
    let fault = |line: usize, text: &str, expected: String| SkyError::Line { path: path.to_owned(), line, text: text.to_owned(), expected };
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    let (first, header) = lines.next().unwrap_or_default();
    let mut places = [0; COLUMNS.len()];
    for (place, name) in places.iter_mut().zip(COLUMNS) {
        *place = header.split(',').position(|c| c.trim() == name).ok_or_else(|| {
            fault(first + 1, header, format!("expected a header with the columns {}; `{name}` is missing", COLUMNS.join(",")))
        })?;
    }
    let mut out = Rays { header: header.trim_end().to_owned(), ..Rays::default() };
    for (index, line) in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let mut v = [0.0; COLUMNS.len()];
        for ((x, place), name) in v.iter_mut().zip(places).zip(COLUMNS) {
            let number = cells.get(place).and_then(|c| c.parse::<f64>().ok()).filter(|x| x.is_finite());
            *x = number.ok_or_else(|| fault(index + 1, line, format!("expected `{name}` to be a finite number")))?;
        }
        let [x, y, z, view_x, view_y, view_z, sun_x, sun_y, sun_z, wavelength_nm] = v;
        let unit = |v: DVec3, name: &str| {
            let wrong = || fault(index + 1, line, format!("expected `{name}_x`, `{name}_y`, `{name}_z` to be a unit vector"));
            if (v.length() - 1.0).abs() < 1e-3 { Ok(v.normalize_or(DVec3::Z)) } else { Err(wrong()) }
        };
        let sight = Sight {
            from_m: DVec3::new(x, y, z) * KM,
            view: unit(DVec3::new(view_x, view_y, view_z), "view")?,
            sun: unit(DVec3::new(sun_x, sun_y, sun_z), "sun")?,
        };
        let channel = star.wavelengths_nm.iter().position(|w| (w - wavelength_nm).abs() < 1e-6).ok_or_else(|| {
            let [a, b, c] = star.wavelengths_nm;
            fault(index + 1, line, format!("expected `wavelength_nm` to be one of the planet's `star.wavelengths_nm`: {a}, {b} or {c}"))
        })?;
        // The wavelengths of one ray mostly follow each other.
        let known = out.sights.iter().rposition(|s| *s == sight);
        let sight = known.unwrap_or_else(|| {
            out.sights.push(sight);
            out.sights.len() - 1
        });
        out.rows.push(Row { text: line.trim_end().to_owned(), sight, channel });
    }
    Ok(out)
}

/// Radiance of every row.
pub fn answer(args: &ProbeSkyArgs) -> Result<(Rays, Found), SkyError> {
    let reference = args.model == REFERENCE;
    let planet = read_planet(&args.planet, Some(if reference { "physical" } else { &args.model }))?;
    let rays = rays(&args.rays, &planet.star)?;
    let found = if reference { by_reference(&planet, &rays, args) } else { by_model(&planet, &rays, args.backend)? };
    Ok((rays, found))
}

fn by_reference(planet: &Planet, rays: &Rays, args: &ProbeSkyArgs) -> Found {
    let sun_rad = planet.star.angular_radius_rad;
    let ray = |s: &Sight| Ray { from_m: s.from_m, direction: s.view, sun: s.sun, sun_rad, occluders: planet.occluders.clone() };
    let wanted: Vec<Ray> = rays.sights.iter().map(ray).collect();
    let options = Options { rel_error: args.rel_error, seed: args.seed, ..Options::default() };
    let bar = indicatif::ProgressBar::new(wanted.len() as u64);
    let found = radiance_noting(&planet.air.medium, &wanted, &options, &|| bar.inc(1));
    bar.finish_and_clear();
    let row = |r: &Row| {
        let irradiance = planet.star.irradiance_w_m2_nm[r.channel];
        let estimate = &found[r.sight];
        (estimate.total[r.channel] * irradiance, Some(estimate.std_error[r.channel] * irradiance))
    };
    rays.rows.iter().map(row).collect()
}

fn by_model(planet: &Planet, rays: &Rays, backend: Option<Backend>) -> Result<Found, SkyError> {
    let gpu = Gpu::headless(backend.map_or(engine::gpu::BackendChoice::Auto, Backend::choice))?;
    let vec4 = |v: DVec3, w: f64| [narrow(v.x), narrow(v.y), narrow(v.z), narrow(w)];
    let ray = |s: &Sight| ProbeRay {
        up: vec4(s.from_m.normalize_or(DVec3::Z), s.from_m.length() - planet.air.medium.bottom_radius_m),
        ray: vec4(s.view, 0.0),
        sun: vec4(s.sun, planet.star.angular_radius_rad),
    };
    let wanted: Vec<ProbeRay> = rays.sights.iter().map(ray).collect();
    let occluder = |o: &Sphere| Occluder { id: 1, centre_m: narrow3(o.centre_m), radius_m: narrow(o.radius_m) };
    let options = ProbeOptions { occluders: planet.occluders.iter().map(occluder).collect(), ..ProbeOptions::default() };
    let found = probe(&gpu, &ShaderLibrary::default(), &planet.air, &wanted, &options)?;
    if let Some(what) = gpu.take_error() {
        return Err(RenderError::Refused(what).into());
    }
    let row = |r: &Row| (f64::from(found[r.sight].radiance[r.channel]) * planet.star.irradiance_w_m2_nm[r.channel], None);
    Ok(rays.rows.iter().map(row).collect())
}

/// Writes the rows as they were, each with `L`, and with `stderr` where it is known.
pub fn write(rays: &Rays, found: &Found, out: &mut dyn Write) -> io::Result<()> {
    let mut out = io::BufWriter::new(out);
    let with_error = found.iter().any(|f| f.1.is_some());
    writeln!(out, "{},L{}", rays.header, if with_error { ",stderr" } else { "" })?;
    for (row, (radiance, error)) in rays.rows.iter().zip(found) {
        write!(out, "{},{radiance:.8e}", row.text)?;
        match error {
            Some(error) => writeln!(out, ",{error:.3e}")?,
            None => writeln!(out)?,
        }
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "planet,id,cam_x_km,cam_y_km,cam_z_km,view_x,view_y,view_z,sun_x,sun_y,sun_z,hits_ground,wavelength_nm";
    const PLANET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/reference/planets/earth.toml");

    fn args(dir: &Path, text: &str) -> ProbeSkyArgs {
        let path = dir.join("rays.csv");
        std::fs::write(&path, text).unwrap();
        ProbeSkyArgs { planet: PLANET.into(), rays: path, model: REFERENCE.into(), rel_error: 0.02, ..ProbeSkyArgs::default() }
    }

    #[test]
    fn rows_come_back_with_their_radiance() {
        let dir = tempfile::tempdir().unwrap();
        let ray = "earth,a,0,0,6360.1,0.8660254037844386,0,0.5,0.5,0,0.8660254037844387,0";
        let (rays, found) = answer(&args(dir.path(), &format!("{HEAD}\n{ray},440\n\n{ray},680\n"))).unwrap();
        assert_eq!(rays.sights.len(), 1);
        let mut out = Vec::new();
        write(&rays, &found, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], format!("{HEAD},L,stderr"));
        for (line, wavelength, truth) in [(lines[1], "440", 0.103_879_15), (lines[2], "680", 0.018_182_539)] {
            let rest = line.strip_prefix(&format!("{ray},{wavelength},")).unwrap();
            let (l, e): (f64, f64) = rest.split_once(',').map(|(l, e)| (l.parse().unwrap(), e.parse().unwrap())).unwrap();
            assert!((l - truth).abs() < 3.0 * e + 0.003 * truth && e < 0.021 * l, "{line}");
        }
    }

    #[test]
    fn bad_rays_are_named() {
        let dir = tempfile::tempdir().unwrap();
        let says = |text: String| answer(&args(dir.path(), &text)).unwrap_err().to_string();
        let message = says(HEAD.replace("sun_y", "sun_why"));
        assert!(message.contains("rays.csv:1") && message.contains("`sun_y` is missing"), "{message}");
        let message = says(format!("{HEAD}\nearth,a,0,0,6360.1,1,0,0,0,0,1,0,681\n"));
        assert!(message.contains("rays.csv:2") && message.contains("680, 550 or 440"), "{message}");
        let message = says(format!("{HEAD}\nearth,a,0,0,6360.1,2,0,0,0,0,1,0,680\n"));
        assert!(message.contains("`view_x`") && message.contains("unit vector"), "{message}");
        let message = says(format!("{HEAD}\nearth,a,0,0,up,1,0,0,0,0,1,0,680\n"));
        assert!(message.contains("`cam_z_km`"), "{message}");
    }
}
