//! `syzygy bench air`: error against time, in one run: the model `physical` at several settings, the four models of the seeds, and two
//! published baselines that nothing else draws with: Hillaire 2020 and Bruneton & Neyret 2008.
//!
//! Same pictures, same rays, same run: [`engine::render::sky_bench`] draws and judges. Here: which planets, the file of what the reference says of
//! their rays, the table on stderr. Pictures: [`super::front_plot`].

use super::front_plot;
use crate::assets::fault::Source;
use crate::assets::planet::planet_of;
use crate::cli::BenchAirArgs;
use crate::mode::Error;
use crate::mode::bench::orbit_rows::{self, RowsError};
use crate::mode::shot::ShotError;
use crate::mode::studio::StudioError;
use cpu_time::ProcessTime;
use engine::air::reference::Options;
use engine::gpu::{BackendChoice, Gpu};
use engine::render::RendererOptions;
use engine::render::sky_bench::Planet;
use engine::render::sky_bench::front::{Effort, Row, Watch, entrants, run as measure};
use engine::render::sky_bench::truth::{HEADER, Truth, compute, lines, read};
use engine::render::sky_bench::view::{Light, VIEWS};
use std::path::Path;
use std::sync::Arc;

/// What the reference says of the rays.
const TRUTH: &str = include_str!("../../../../../tests/reference/sky_front.csv");
/// Rays of a view.
const RAYS: usize = 24;

const PLANETS: [(&str, &str); 3] = [
    ("earth", include_str!("../../../../../tests/reference/planets/earth.toml")),
    ("thick", include_str!("../../../../../tests/reference/planets/thick.toml")),
    ("dusty", include_str!("../../../../../tests/reference/planets/dusty.toml")),
];

/// Measures, prints a table, writes rows and pictures.
///
/// # Errors
/// No GPU, a device that fails, a file that cannot be written.
pub fn run(args: &BenchAirArgs) -> Result<(), Error> {
    let planets = args.planet.iter().map(|name| planet(name)).collect::<Result<Vec<_>, _>>()?;
    let truths = match &args.truth {
        Some(path) => ask(&planets, path)?,
        None => read(TRUTH).map_err(|message| RowsError::Plot { path: "tests/reference/sky_front.csv".into(), message })?,
    };
    let gpu = Gpu::headless(BackendChoice::Auto).map_err(|e| failed(e.into()))?;
    let bar = indicatif::ProgressBar::new_spinner();
    let watch = Watch {
        note: &|what| bar.set_message(what.to_owned()),
        picture: &|_, _, _| (),
        clock: &|| ProcessTime::now().as_duration().as_secs_f64(),
    };
    // Pictures are made of odd multiples of the grid.
    let effort = Effort { scale: args.scale | 1, rounds: args.rounds };
    let mut rows = Vec::new();
    for planet in &planets {
        bar.tick();
        let found = measure(&gpu, &RendererOptions::default().shaders, planet, &truths, &entrants(), effort, &watch)
            .map_err(|e| failed(e.into()))?;
        bar.suspend(|| eprint!("{}", table(&found)));
        if let Some(folder) = &args.plot {
            front_plot::draw(folder, &planet.name, &found)?;
        }
        rows.extend(found);
    }
    bar.finish_and_clear();
    Ok(orbit_rows::write(&rows, args.json.as_deref())?)
}

fn failed(e: StudioError) -> Error {
    Error::from(ShotError::from(e))
}

/// A planet of the reference data, by its name.
fn planet(name: &str) -> Result<Planet, Error> {
    let text = PLANETS.iter().find(|(n, _)| *n == name).map_or("", |(_, text)| *text).to_owned();
    let source = Arc::new(Source { path: format!("tests/reference/planets/{name}.toml").into(), text });
    let found = planet_of(&source, None)?;
    Ok(Planet { name: name.to_owned(), medium: found.air.medium, sun_rad: found.star.angular_radius_rad })
}

/// Asks the reference for the rays of every view, and writes the file.
fn ask(planets: &[Planet], path: &Path) -> Result<Vec<Truth>, RowsError> {
    let bar = indicatif::ProgressBar::new((planets.len() * VIEWS.len() * RAYS) as u64);
    let options = Options { max_walks: 1 << 18, ..Options::default() };
    let truths: Vec<Truth> = planets.iter().flat_map(|p| compute(p, RAYS, &options, &|| bar.inc(1))).collect();
    bar.finish_and_clear();
    let names: Vec<&str> = planets.iter().map(|p| p.name.as_str()).collect();
    let head = format!(
        "# Radiance along rays of the pictures of `syzygy bench air`, by engine::air::reference to 0.1 %, or 2^18 walks. Made by\n\
         # syzygy bench air --planet {} --truth tests/reference/sky_front.csv\n{HEADER}\n",
        names.join(" --planet ")
    );
    let written = std::fs::write(path, head + &lines(&truths));
    written.map_err(|source| RowsError::File { path: path.to_owned(), doing: "cannot be written", source })?;
    Ok(truths)
}

/// The rows in columns: time over the yardstick's and error, in all and by light.
fn table(rows: &[Row]) -> String {
    use std::fmt::Write as _;
    let Some(first) = rows.first() else { return String::new() };
    let lights = Light::ALL.map(|l| format!("{:>24}", l.name())).concat();
    let mut out = format!(
        "{}, pictures of {}×{}; time over that of `{} {}`; error rms / worst, %; *: no other is better in both\n{:46}{:>10}{:>24}{lights}\n",
        first.planet, first.size_px[0], first.size_px[1], first.model, first.setting, "", "rebuild", "all"
    );
    for row in rows {
        let star = if row.on_front { "*" } else { " " };
        let cell =
            |s: &engine::render::sky_bench::front::Summary| format!("{:>8.3} {:>7.2}/{:>7.1}", s.time, 100.0 * s.rms, 100.0 * s.worst);
        let cells: String = std::iter::once(&row.all).chain(&row.by_light).map(cell).collect();
        let _ = writeln!(out, "{star} {:14} {:28} {:>7.1} ms{cells}", row.model, row.setting, row.rebuild_ms);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_is_of_the_rays_that_the_views_judge() {
        let truths = read(TRUTH).unwrap();
        for planet in ["earth"].map(|name| planet(name).unwrap()) {
            for view in VIEWS {
                let pixels: Vec<_> = truths.iter().filter(|t| t.planet == planet.name && t.view == view.name).map(|t| t.pixel).collect();
                assert_eq!(pixels, view.judged(&planet.medium, RAYS), "{} {}", planet.name, view.name);
            }
        }
    }
}
