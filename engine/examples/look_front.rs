//! The front of error against time in one run, as text: `cargo run --release -p engine --example look_front -- TRUTH.csv [SCALE] [ROUNDS] [DIR] [WORD…]`.
//! A file of truth that is not there is written first; pictures go into DIR unless it is `-`; with words, only techniques whose name or setting has one of them enter.
//!
//! Not here: plots, other planets (`syzygy bench air` has them).

use engine::air::reference::Options;
use engine::air::{Layer, Medium, Phase, Profile};
use engine::gpu::{BackendChoice, Gpu, ShaderLibrary};
use engine::render::sky_bench::Planet;
use engine::render::sky_bench::front::{Effort, Entrant, Watch, entrants, run};
use engine::render::sky_bench::truth::{HEADER, compute, lines, read};
use engine::render::sky_bench::view::{GRID, VIEWS, View};
use engine::units::{DEG, KM};
use glam::Vec3;
use std::error::Error;

/// `tests/reference/planets/earth.toml`.
fn earth() -> Planet {
    let layer = |scattering_per_m, absorption_per_m, profile, phase| Layer { scattering_per_m, absorption_per_m, profile, phase };
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    let ozone = Profile::Tent { bottom_m: 1e4, peak_m: 2.5e4, top_m: 4e4 };
    let medium = Medium {
        bottom_radius_m: 6360.0 * KM,
        top_altitude_m: 60.0 * KM,
        ground_albedo: Vec3::splat(0.1),
        layers: vec![
            layer(Vec3::new(5.80234e-6, 1.35578e-5, 3.31e-5), Vec3::ZERO, exponential(8000.0), Phase::Rayleigh),
            layer(Vec3::splat(3.996e-6), Vec3::splat(4.44e-7), exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
            layer(Vec3::ZERO, Vec3::new(6.497e-7, 1.881e-6, 8.5e-8), ozone, Phase::Rayleigh),
        ],
    };
    Planet { name: "earth".to_owned(), medium, sun_rad: 0.2678 * DEG }
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let path = args.first().ok_or("the file of truth is missing")?;
    let planet = earth();
    if !std::path::Path::new(path).exists() {
        let options = Options { max_walks: 1 << 18, ..Options::default() };
        let truths = compute(&planet, 24, &options, &|| eprint!("."));
        std::fs::write(path, format!("{HEADER}\n{}", lines(&truths)))?;
    }
    let truths = read(&std::fs::read_to_string(path)?)?;
    let gpu = Gpu::headless(BackendChoice::Auto)?;
    let number = |i: usize, or: u32| args.get(i).map_or(Ok(or), |s| s.parse());
    let effort = Effort { scale: number(1, 3)?, rounds: number(2, 3)? };
    let dir = args.get(3).filter(|d| *d != "-").map(std::path::PathBuf::from);
    let words = args.get(4..).unwrap_or_default();
    let mut wanted = entrants();
    let mut first = true;
    wanted.retain(|e| std::mem::take(&mut first) || words.is_empty() || words.iter().any(|w| e.family.contains(w) || e.label.contains(w)));
    let picture = |entrant: &Entrant, view: &View, rgba: &[f32]| {
        let Some(dir) = &dir else { return };
        let name = format!("{}_{}_{}.png", view.name, entrant.family, entrant.label).replace([' ', ','], "_");
        if let Err(e) = write_png(&dir.join(name), effort.scale, rgba) {
            eprintln!("{e}");
        }
    };
    let watch =
        Watch { note: &|what| eprintln!("{what}"), picture: &picture, clock: &|| cpu_time::ProcessTime::now().as_duration().as_secs_f64() };
    let rows = run(&gpu, &ShaderLibrary::checkout(), &planet, &truths, &wanted, effort, &watch)?;
    println!("{:45} {:>9} {:>8} {:>6} {:>7} {:>7}", VIEWS.map(|v| v.name).join(" "), "rebuild", "ms", "time", "rms %", "worst %");
    for row in rows {
        let star = if row.on_front { "*" } else { " " };
        let all = row.all;
        println!(
            "{star} {:14} {:28} {:9.1} {:8.1} {:6.2} {:7.2} {:7.1}",
            row.model,
            row.setting,
            row.rebuild_ms,
            all.ms,
            all.time,
            100.0 * all.rms,
            100.0 * all.worst
        );
        for (what, of) in [("ms", 0), ("time", 1), ("rms %", 2), ("worst %", 3)] {
            let cells = row.views.iter().map(|v| [v.ms, v.time, 100.0 * v.rms, 100.0 * v.worst][of]);
            println!("    {what:8}{}", cells.map(|x| format!("{x:9.2}")).collect::<String>());
        }
    }
    Ok(())
}

/// Exposed so that the mean is a middling grey, by x / (1 + x).
fn write_png(path: &std::path::Path, scale: u32, rgba: &[f32]) -> Result<(), Box<dyn Error>> {
    let mean = rgba.chunks_exact(4).map(|p| p[1]).sum::<f32>() / (rgba.len() / 4).max(1) as f32;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a colour")]
    let byte = |x: f32| {
        let y = x / mean.max(1e-12);
        ((y / (1.0 + y)).max(0.0).powf(1.0 / 2.2) * 255.0) as u8
    };
    let bytes: Vec<u8> = rgba.chunks_exact(4).flat_map(|p| [byte(p[0]), byte(p[1]), byte(p[2])]).collect();
    let file = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mut encoder = png::Encoder::new(file, GRID[0] * scale, GRID[1] * scale);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(())
}
