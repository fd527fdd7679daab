//! The front: every technique at several settings, its error against the reference and its time, in one run.
//!
//! Errors are of the pictures themselves, read back at the pixels whose rays the reference knows: relative, in every channel, rays under
//! [`LEAST`] left out. Times are the least of several rounds; in a round every technique draws every view once, so that what slows the
//! machine down meets all alike. They are given in ms and as shares of the yardstick: `physical` as the game draws it.

use super::truth::Truth;
use super::view::{GRID, Light, VIEWS, View};
use super::{Clock, Planet, Setting, SkyBench, Technique};
use crate::air::Model;
use crate::air::model::{Gradient, LimbTable, Physical, Thickness, ViewTable};
use crate::gpu::{Gpu, ShaderLibrary};
use crate::light::exposure::{BINS, LUMINANCE, bin_of_luminance, ev100_of_histogram, exposure_of_ev100};
use crate::render::RenderError;
use crate::render::pass::baseline_bruneton::Sizes;
use crate::render::pass::sky::STEPS;
use glam::Vec3;
use serde::Serialize;

/// Radiance under which a ray judges nobody, sr⁻¹ per unit of the sun's irradiance.
pub const LEAST: f64 = 1e-7;
/// Illuminance by the sun above the air that a view is exposed for, lx.
const SUN_LX: f32 = 1.28e5;
/// What the reference is less sure of than this, relative, judges nobody.
const UNSURE: f64 = 0.01;

/// A technique at a setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Entrant {
    /// The technique's name, and whether it is of the game.
    pub family: &'static str,
    /// Its setting, in words.
    pub label: String,
    /// What is compiled; alike techniques are compiled once.
    pub technique: Technique,
    /// How it draws.
    pub setting: Setting,
    /// Its light is in no unit: it is multiplied by the factor that fits the planet best.
    pub fitted: bool,
}

/// What one entrant did in one view.
#[derive(Clone, Debug, Serialize)]
pub struct ViewRow {
    /// Name of the view.
    pub view: &'static str,
    /// The group that it counts for.
    pub light: &'static str,
    /// Time on the GPU, ms.
    pub ms: f64,
    /// Over the yardstick's in the same view.
    pub time: f64,
    /// Root of the mean square of the relative errors.
    pub rms: f64,
    /// The worst of them.
    pub worst: f64,
}

/// What an entrant did in several views: of one light, or in all.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Summary {
    /// Time of all its views, ms.
    pub ms: f64,
    /// Over the yardstick's.
    pub time: f64,
    /// Root of the mean square of the relative errors of all rays.
    pub rms: f64,
    /// The worst of them.
    pub worst: f64,
    /// Errors that were counted: three a ray.
    pub count: usize,
}

/// What an entrant did.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The planet.
    pub planet: String,
    /// The technique.
    pub model: &'static str,
    /// Its setting.
    pub setting: String,
    /// Pixels of the pictures.
    pub size_px: [u32; 2],
    /// Time of the tables that hang on the medium, ms.
    pub rebuild_ms: f64,
    /// The factor on its light.
    pub factor: f64,
    /// In all views.
    pub all: Summary,
    /// By light, in the order of [`Light::ALL`].
    pub by_light: Vec<Summary>,
    /// View by view.
    pub views: Vec<ViewRow>,
    /// No other entrant errs less in less time, over all views.
    pub on_front: bool,
}

/// How much is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Pixels of the pictures over those of [`GRID`], odd.
    pub scale: u32,
    /// Rounds.
    pub rounds: u32,
}

/// The yardstick: as the game draws.
pub fn yardstick() -> Entrant {
    Entrant {
        family: "physical",
        label: format!("{STEPS} points"),
        technique: Technique::Model(Model::Physical(Physical::default())),
        setting: Setting { steps: STEPS, every_pixel: false, agree: None },
        fitted: false,
    }
}

/// All that enter, the yardstick first.
pub fn entrants() -> Vec<Entrant> {
    let physical = |steps, agree: Option<f32>| Entrant {
        label: match agree {
            Some(a) if a > 0.0 => format!("{steps} points, agreeing to {a}"),
            Some(_) => format!("{steps} points, every pixel"),
            None => format!("{steps} points"),
        },
        setting: Setting { steps, every_pixel: agree == Some(0.0), agree },
        ..yardstick()
    };
    let one = |family, label: &str, technique, steps, every_pixel| Entrant {
        family,
        label: label.to_owned(),
        technique,
        setting: Setting { steps, every_pixel, agree: None },
        fitted: false,
    };
    let mut all = vec![yardstick()];
    all.extend([4, 8, 24, 48].map(|n| physical(n, None)));
    all.extend([(4, 0.3), (4, 0.03), (4, 0.01), (12, 0.03), (12, 0.001)].map(|(n, a)| physical(n, Some(a))));
    all.extend([4, 8, 12, 24, 48].map(|n| physical(n, Some(0.0))));
    for (steps, march) in [(4, false), (8, false), (14, false), (30, false), (60, false), (8, true), (16, true), (32, true), (64, true)] {
        let label = format!("{steps} steps, {}", if march { "marched" } else { "tables" });
        all.push(one("Hillaire 2020", &label, Technique::Hillaire, steps, march));
    }
    for texels in [[16, 64, 16, 8], [32, 128, 32, 8]] {
        let label = texels.map(|n| n.to_string()).join("×");
        all.push(one("Bruneton 2008", &label, Technique::Bruneton(Sizes { texels, ..Sizes::default() }), 0, false));
    }
    for (height_size, view_size, sun_size, samples) in [(8, 32, 16, 15), (16, 64, 32, 25), (32, 128, 64, 50), (64, 256, 128, 100)] {
        let model = ViewTable { height_size, view_size, sun_size, samples, ..ViewTable::default() };
        let label = format!("{height_size}×{view_size}×{sun_size}, {samples} samples");
        all.push(one("view_table", &label, Technique::Model(Model::ViewTable(model)), STEPS, false));
    }
    let fitted = |family, label: &str, model| Entrant { fitted: true, ..one(family, label, Technique::Model(model), STEPS, false) };
    for size in [64, 256] {
        all.push(fitted("limb_table", &format!("{size}²"), Model::LimbTable(LimbTable { size, ..LimbTable::default() })));
    }
    all.push(fitted("thickness", "", Model::Thickness(Thickness::default())));
    all.push(fitted("gradient", "", Model::Gradient(Gradient::default())));
    all
}

/// What a caller wants to know on the way.
pub struct Watch<'a> {
    /// Told what is being done.
    pub note: &'a dyn Fn(&str),
    /// Shown each picture once: radiances, sr⁻¹, RGBA row by row.
    pub picture: &'a dyn Fn(&Entrant, &View, &[f32]),
    /// The time of this process, where a processor stands in for a GPU.
    pub clock: Clock<'a>,
}

/// Measures `entrants` on a planet; the first is the yardstick.
///
/// # Errors
/// A shader that does not compile, a device that fails.
pub fn run(
    gpu: &Gpu,
    shaders: &ShaderLibrary,
    planet: &Planet,
    truths: &[Truth],
    entrants: &[Entrant],
    effort: Effort,
    watch: &Watch<'_>,
) -> Result<Vec<Row>, RenderError> {
    let size_px = GRID.map(|n| n * effort.scale);
    let mut bench = SkyBench::new(gpu, shaders, size_px, planet, watch.clock)?;
    let mut techniques: Vec<&Technique> = Vec::new();
    let mut prepared = Vec::new();
    let mut of = Vec::new();
    for entrant in entrants {
        let at = techniques.iter().position(|t| **t == entrant.technique);
        of.push(at.unwrap_or(techniques.len()));
        if at.is_none() {
            (watch.note)(&format!("{}: tables of {} {}", planet.name, entrant.family, entrant.label));
            techniques.push(&entrant.technique);
            prepared.push(bench.prepare(&planet.medium, &entrant.technique)?);
        }
    }
    let mut ms = vec![[f64::INFINITY; VIEWS.len()]; entrants.len()];
    let mut white = [None; VIEWS.len()];
    let mut light = vec![[const { Vec::new() }; VIEWS.len()]; entrants.len()];
    for round in 0..=effort.rounds {
        (watch.note)(&format!("{}: round {round} of {}", planet.name, effort.rounds));
        for (v, view) in VIEWS.iter().enumerate() {
            for (e, entrant) in entrants.iter().enumerate() {
                let Some(with) = prepared.get_mut(of[e]) else { continue };
                let scene = view.scene(&with.air, planet.sun_rad, size_px);
                let took = bench.draw(&scene, with, entrant.setting, white[v])?;
                // The first round compiles, and is the one that is judged.
                if round == 0 {
                    let mut picture = bench.read()?;
                    if e == 0 {
                        white[v] = Some(exposed_to_white(&picture));
                        bench.draw(&scene, with, entrant.setting, white[v])?;
                        picture = bench.read()?;
                    }
                    (watch.picture)(entrant, view, &picture);
                    light[e][v] = judged(&picture, effort.scale, planet, view, truths);
                } else {
                    ms[e][v] = ms[e][v].min(took);
                }
            }
        }
    }
    let tables_ms = bench.tables_ms;
    let rebuild = |e: usize| match &entrants[e].technique {
        Technique::Model(Model::Physical(_)) => tables_ms,
        _ => prepared[of[e]].own_ms,
    };
    let mut rows: Vec<Row> =
        (0..entrants.len()).map(|e| row(planet, &entrants[e], size_px, rebuild(e), &ms[e], &ms[0], &light[e])).collect();
    let places: Vec<(f64, f64)> = rows.iter().map(|r| (r.all.ms, r.all.rms)).collect();
    for (row, at) in rows.iter_mut().zip(&places) {
        row.on_front = !places.iter().any(|p| (p.0 < at.0 && p.1 <= at.1) || (p.0 <= at.0 && p.1 < at.1));
    }
    Ok(rows)
}

/// The radiance that the game's meter would make white, sr⁻¹, under a sun as bright as ours.
fn exposed_to_white(picture: &[f32]) -> f32 {
    let mut bins = vec![0; BINS];
    for p in picture.chunks_exact(4) {
        bins[bin_of_luminance(LUMINANCE.dot(Vec3::new(p[0], p[1], p[2])) * SUN_LX)] += 1;
    }
    1.0 / (exposure_of_ev100(ev100_of_histogram(&bins)) * SUN_LX)
}

/// Drawn over true, for every ray and channel that judges.
fn judged(picture: &[f32], scale: u32, planet: &Planet, view: &View, truths: &[Truth]) -> Vec<f64> {
    let width = GRID[0] * scale;
    let of_view = truths.iter().filter(|t| t.planet == planet.name && t.view == view.name);
    of_view
        .flat_map(|t| {
            let [x, y] = t.pixel.map(|n| n * scale + scale / 2);
            (0..3).filter_map(move |c| {
                let sure = t.radiance[c] >= LEAST && t.std_error[c] < UNSURE * t.radiance[c];
                let drawn = f64::from(*picture.get(4 * (y * width + x) as usize + c)?);
                sure.then(|| drawn / t.radiance[c])
            })
        })
        .collect()
}

fn row(planet: &Planet, entrant: &Entrant, size_px: [u32; 2], rebuild_ms: f64, ms: &[f64], yard: &[f64], light: &[Vec<f64>]) -> Row {
    let all: Vec<f64> = light.iter().flatten().copied().collect();
    let factor = if entrant.fitted { fit(&all) } else { 1.0 };
    let summary = |wanted: &dyn Fn(&View) -> bool| {
        let which: Vec<usize> = (0..VIEWS.len()).filter(|v| wanted(&VIEWS[*v])).collect();
        let total = |of: &[f64]| which.iter().map(|v| of[*v]).sum::<f64>();
        let errors: Vec<f64> = which.iter().flat_map(|v| &light[*v]).map(|x| factor * x - 1.0).collect();
        let [rms, worst] = measure(&errors);
        Summary { ms: total(ms), time: total(ms) / total(yard), rms, worst, count: errors.len() }
    };
    let views = VIEWS.iter().enumerate().map(|(v, view)| {
        let [rms, worst] = measure(&light[v].iter().map(|x| factor * x - 1.0).collect::<Vec<_>>());
        ViewRow { view: view.name, light: view.light.name(), ms: ms[v], time: ms[v] / yard[v], rms, worst }
    });
    Row {
        planet: planet.name.clone(),
        model: entrant.family,
        setting: entrant.label.clone(),
        size_px,
        rebuild_ms,
        factor,
        all: summary(&|_| true),
        by_light: Light::ALL.iter().map(|l| summary(&|v| v.light == *l)).collect(),
        views: views.collect(),
        on_front: false,
    }
}

/// The factor with which the relative errors have the least mean square. Darkness errs by 1 at most: where a model spreads over more than
/// the rays' own range it comes out next to black.
fn fit(drawn_over_true: &[f64]) -> f64 {
    drawn_over_true.iter().sum::<f64>() / drawn_over_true.iter().map(|x| x * x).sum::<f64>().max(1e-300)
}

/// Root mean square and worst.
fn measure(errors: &[f64]) -> [f64; 2] {
    let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len().max(1) as f64;
    [libm::sqrt(mean), errors.iter().fold(0.0, |a, e| a.max(e.abs()))]
}
