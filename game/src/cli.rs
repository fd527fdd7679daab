//! The command line: a contract that tests and tools outside this repository call.
//!
//! Every argument is checked here as far as it can be without opening a file; what it names is opened by the mode
//! ([`crate::mode`]). Exit codes: 0 done, 1 an error, 2 wrong usage or no GPU, 3 a replay diverged.

mod bench;
mod eclipses;
mod places;
mod sky;

pub use bench::{BenchAirArgs, BenchEphemerisArgs, BenchKeplerArgs, BenchOrbitArgs, BenchShipsArgs};
pub use eclipses::ProbeEclipsesArgs;
pub use sky::ProbeSkyArgs;

use clap::{Args, CommandFactory, Parser, Subcommand};
use engine::time::SimTime;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// The start of a new flight where none is named.
pub const DEFAULT_START: &str = "eclipse";

/// A space simulator at real scale: fly from orbit to the surface of any world, and stand under the Moon's shadow.
#[derive(Debug, Parser)]
#[command(name = "syzygy", version, subcommand_negates_reqs = true)]
#[command(after_help = "Examples:\n  syzygy                          open the game\n  syzygy play --start eclipse     \
    fly the eclipse of 2026-08-12\n  syzygy replay tests/replays/*.syzlog\n\nExit codes: 0 done, 1 error, 2 usage or no GPU, 3 a replay diverged")]
pub struct Cli {
    /// What to do; `play` when left out.
    #[command(subcommand)]
    pub mode: Option<Mode>,
    /// Arguments of `play`, when no subcommand is named.
    #[command(flatten)]
    pub play: PlayArgs,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Mode {
    /// Open the window and play
    #[command(after_help = "Example:\n  syzygy play --start leo --size 1920x1080")]
    Play(PlayArgs),
    /// Run the same session without a window
    #[command(after_help = "Example:\n  syzygy headless --start eclipse --ticks 3600 --save out.syzsave --film saves/film")]
    Headless(HeadlessArgs),
    /// Play recorded flights and compare every state hash
    #[command(
        after_help = "Example:\n  syzygy replay --heavy tests/replays/*.syzlog\n\nExit codes: 0 the same, 1 cannot be played, 3 diverged"
    )]
    Replay(ReplayArgs),
    /// Draw one picture (PNG as seen, EXR as scene-linear radiance before exposure)
    #[command(after_help = "Example:\n  syzygy shot --start eclipse --camera chase --size 1280x720 --out shot.png --passes passes.json")]
    Shot(ShotArgs),
    /// Validate a system, body or mod folder and list every error
    #[command(
        after_help = "Examples:\n  syzygy check-assets mods/my-moon\n  syzygy check-assets --schema atmosphere > atmosphere.schema.json"
    )]
    CheckAssets(CheckAssetsArgs),
    /// Ask the simulation for numbers, as JSON or CSV
    #[command(subcommand, after_help = "Example:\n  syzygy probe air --body earth --altitude-m 0 11000 50000")]
    Probe(Probe),
    /// Measure run time against error
    #[command(subcommand, after_help = "Example:\n  syzygy bench orbit --case LEO_1000orb --plot plots")]
    Bench(Bench),
}

/// Where things are; the same for every mode.
#[derive(Clone, Debug, Default, Args)]
pub struct Places {
    /// The assets folder (else $SYZYGY_ASSETS, beside the program, or in the checkout)
    #[arg(long, value_name = "DIR", help_heading = "Places")]
    pub assets: Option<PathBuf>,
    /// Overlay a mod folder; may be given several times, the last one wins
    #[arg(long, value_name = "DIR", help_heading = "Places")]
    pub mods: Vec<PathBuf>,
    /// Keep saves and settings here (else $SYZYGY_DATA_DIR, saves/ in a checkout, or the user's data folder)
    #[arg(long, value_name = "DIR", help_heading = "Places")]
    pub data_dir: Option<PathBuf>,
    /// Ignore mods and the player's settings
    #[arg(long, help_heading = "Places")]
    pub safe_mode: bool,
    /// Log more to stderr (-v info, -vv debug); $RUST_LOG overrides
    #[arg(short, long, action = clap::ArgAction::Count, help_heading = "Places")]
    pub verbose: u8,
}

/// Arguments of `play`.
#[derive(Clone, Debug, Default, Args)]
pub struct PlayArgs {
    /// Skip the menu: a start by name, or a save file
    #[arg(long, value_name = "NAME|FILE")]
    pub start: Option<String>,
    /// Graphics interface
    #[arg(long, value_enum, value_name = "NAME")]
    pub backend: Option<Backend>,
    /// Size of the window, pixels
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<(u32, u32)>,
    /// Let the editor of airs write into the game's own assets (in a checkout), not into a mod
    #[arg(long)]
    pub edit_assets: bool,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Graphics interfaces that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Backend {
    /// Vulkan
    Vulkan,
    /// Metal (macOS)
    Metal,
    /// Direct3D 12 (Windows)
    Dx12,
    /// OpenGL (ES) 3
    Gl,
}

impl Backend {
    /// In the engine's words.
    pub const fn choice(self) -> engine::gpu::BackendChoice {
        use engine::gpu::BackendChoice;
        match self {
            Self::Vulkan => BackendChoice::Vulkan,
            Self::Metal => BackendChoice::Metal,
            Self::Dx12 => BackendChoice::Dx12,
            Self::Gl => BackendChoice::Gl,
        }
    }
}

/// Arguments of `headless`.
#[derive(Clone, Debug, Args)]
pub struct HeadlessArgs {
    /// A start by name, or a save file
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_START)]
    pub start: String,
    /// Ticks of 1/60 s to run
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(0..=1_000_000_000))]
    pub ticks: u64,
    /// Take the commands from a recorded flight
    #[arg(long, value_name = "LOG")]
    pub commands: Option<PathBuf>,
    /// Write the state at the end
    #[arg(long, value_name = "OUT")]
    pub save: Option<PathBuf>,
    /// Record the flight as a replay log
    #[arg(long, value_name = "LOG")]
    pub record: Option<PathBuf>,
    /// Write a film strip into this folder
    #[arg(long, value_name = "DIR")]
    pub film: Option<PathBuf>,
    /// Graphics interface for the film
    #[arg(long, value_enum, value_name = "NAME")]
    pub backend: Option<Backend>,
    /// Size of a picture of the film, pixels
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "640x360")]
    pub size: (u32, u32),
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `replay`.
#[derive(Clone, Debug, Args)]
pub struct ReplayArgs {
    /// Recorded flights
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Save and load the whole state in memory every K ticks
    #[arg(long, value_name = "K", num_args = 0..=1, require_equals = true, default_missing_value = "97",
        value_parser = clap::value_parser!(u32).range(1..))]
    pub heavy: Option<u32>,
    /// Print what the logs hold, as text, and play nothing
    #[arg(long)]
    pub dump: bool,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `shot`.
#[derive(Clone, Debug, Args)]
pub struct ShotArgs {
    /// A start by name, or a save file
    #[arg(long, value_name = "NAME|FILE", default_value = DEFAULT_START)]
    pub start: String,
    /// The moment, a Julian date of TDB (else the start's)
    #[arg(long, value_name = "JD", value_parser = julian_date, allow_hyphen_values = true)]
    pub tdb: Option<f64>,
    /// The camera: `chase[:YAW,PITCH[,DISTANCE_M]]`, `cockpit[:YAW,PITCH]`, `map:BODY,YAW,PITCH,RADII` or
    /// `at:BODY,LAT,LON,HEIGHT_M,HEADING,PITCH[,FOV]` (degrees; the heading may be `sun`, `sun+30`)
    #[arg(long, value_name = "CAMERA", default_value = "chase")]
    pub camera: String,
    /// Stops by which the picture is exposed brighter than the meter would
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub compensation: f32,
    /// Size of the picture, pixels
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: (u32, u32),
    /// The picture: .png as seen, or .exr as scene-linear radiance before exposure
    #[arg(long, value_name = "F.png|F.exr", value_parser = picture)]
    pub out: PathBuf,
    /// Write what was drawn, what was skipped and why
    #[arg(long, value_name = "F.json")]
    pub passes: Option<PathBuf>,
    /// Draw every pass, also those that the scene does not need
    #[arg(long)]
    pub force_passes: bool,
    /// Graphics interface
    #[arg(long, value_enum, value_name = "NAME")]
    pub backend: Option<Backend>,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `check-assets`.
#[derive(Clone, Debug, Args)]
pub struct CheckAssetsArgs {
    /// The folder to check (else the assets in use)
    #[arg(value_name = "DIR")]
    pub dir: Option<PathBuf>,
    /// Print the JSON Schema of a kind of file, for editors of TOML, and check nothing
    #[arg(long, value_enum, value_name = "KIND")]
    pub schema: Option<SchemaKind>,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Kinds of files that have a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SchemaKind {
    /// atmosphere.toml
    #[value(name = "atmosphere")]
    Atmosphere,
    /// atmosphere.patch.toml
    #[value(name = "atmosphere.patch")]
    AtmospherePatch,
}

/// What can be asked for.
#[derive(Debug, Subcommand)]
pub enum Probe {
    /// Temperature, pressure and density of a body's air
    #[command(after_help = "Example:\n  syzygy probe air --body earth --altitude-m 0 11000 50000")]
    Air(ProbeAirArgs),
    /// Height of the ground at points of a CSV file (columns lat_deg, lon_deg)
    #[command(after_help = "Example:\n  syzygy probe height --body earth --points points.csv")]
    Height(ProbeHeightArgs),
    /// Two-body states after a time, for the starts of a CSV file (columns gm,x,y,z,vx,vy,vz,dt; any consistent units)
    #[command(after_help = "Example:\n  syzygy probe kepler --cases tests/reference/kepler_cases.csv")]
    Kepler(ProbeKeplerArgs),
    /// Position and velocity of a body, ICRF axes
    #[command(after_help = "Example:\n  syzygy probe ephemeris --body moon --center earth --tdb 2461265.241041667")]
    Ephemeris(ProbeEphemerisArgs),
    /// A case of orbital motion by any integrator: where it ends, the energy's error, the cost
    #[command(after_help = "Example:\n  syzygy probe propagate --case orbit_cases.json --name LEO_1000orb --method taylor")]
    Propagate(ProbePropagateArgs),
    /// Eclipses on a body by another: when, what kind, where, and what one place sees
    #[command(after_help = "Example:\n  syzygy probe eclipses --on earth --by moon --from 2461000 --to 2461500 --at 43.37,-8.40\n  \
        syzygy probe eclipses --on moon --by earth --from 2461000 --to 2462000")]
    Eclipses(ProbeEclipsesArgs),
    /// Spectral radiance along the rays of a CSV file: the same rows with L, W m⁻² sr⁻¹ nm⁻¹ (no ground, no sun's disc)
    #[command(after_help = "Example:\n  syzygy probe sky --planet earth.toml --rays rays.csv --model physical --out sky.csv")]
    Sky(Box<ProbeSkyArgs>),
}

/// What can be measured.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Every integrator on every case of the reference data: error against CPU time and evaluations
    #[command(after_help = "Example:\n  syzygy bench orbit --case LEO_1000orb --method gauss_radau --json leo.json --plot plots")]
    Orbit(BenchOrbitArgs),
    /// What each model of air costs to draw and how wrong it is; how far colours are from those of all wavelengths; Elek's test flight
    #[command(
        after_help = "Examples:\n  syzygy bench air --plot plots --json front.json\n  syzygy bench air --spectral --json colours.json\n  syzygy bench air --elek --json elek.json"
    )]
    Air(BenchAirArgs),
    /// What choosing the terms of gravity by an error bound costs in error and saves in time
    #[command(after_help = "Example:\n  syzygy bench ships --json ships.json")]
    Ships(BenchShipsArgs),
    /// Nanoseconds for a solve of Kepler's problem, by regime: one at a time, on a known orbit, in batches
    #[command(after_help = "Example:\n  syzygy bench kepler --json kepler.json")]
    Kepler(BenchKeplerArgs),
    /// What the places of the bodies cost: a question, the first year, 1900 to 2100
    #[command(after_help = "Example:\n  syzygy bench ephemeris --json ephemeris.json")]
    Ephemeris(BenchEphemerisArgs),
}

/// Arguments that all probes share.
#[derive(Clone, Debug, Args)]
pub struct ProbeCommon {
    /// The system, a folder of assets/systems
    #[arg(long, value_name = "NAME", default_value = "sol")]
    pub system: String,
    /// Write here instead of stdout
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `probe air`.
#[derive(Clone, Debug, Args)]
pub struct ProbeAirArgs {
    /// The body, by its folder's name
    #[arg(long, value_name = "B")]
    pub body: String,
    /// Geometric altitudes above the datum, m
    #[arg(long, value_name = "A", num_args = 1.., required = true, allow_negative_numbers = true, value_parser = finite)]
    pub altitude_m: Vec<f64>,
    #[command(flatten)]
    /// What all probes share.
    pub common: ProbeCommon,
}

/// Arguments of `probe height`.
#[derive(Clone, Debug, Args)]
pub struct ProbeHeightArgs {
    /// The body, by its folder's name
    #[arg(long, value_name = "B")]
    pub body: String,
    /// Points: CSV with the columns lat_deg and lon_deg
    #[arg(long, value_name = "F.csv")]
    pub points: PathBuf,
    #[command(flatten)]
    /// What all probes share.
    pub common: ProbeCommon,
}

/// Arguments of `probe kepler`.
#[derive(Clone, Debug, Args)]
pub struct ProbeKeplerArgs {
    /// Starts: CSV with the columns gm, x, y, z, vx, vy, vz and dt (others are passed over)
    #[arg(long, value_name = "F.csv")]
    pub cases: PathBuf,
    /// Write here instead of stdout
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `probe ephemeris`.
#[derive(Clone, Debug, Args)]
pub struct ProbeEphemerisArgs {
    /// The body, by its folder's name
    #[arg(long, value_name = "B")]
    pub body: String,
    /// The body to measure from (else the solar-system barycentre)
    #[arg(long, value_name = "C")]
    pub center: Option<String>,
    /// Julian dates of TDB
    #[arg(long, value_name = "JD", num_args = 1.., required = true, allow_negative_numbers = true, value_parser = julian_date)]
    pub tdb: Vec<f64>,
    #[command(flatten)]
    /// What all probes share.
    pub common: ProbeCommon,
}

/// Arguments of `probe propagate`.
#[derive(Clone, Debug, Args)]
pub struct ProbePropagateArgs {
    /// The case, or several by name: JSON of the form of tests/reference/orbit_cases.json
    #[arg(long, value_name = "F.json")]
    pub case: PathBuf,
    /// Which of several cases; `NAME@T` ends at the reference time T
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// When it ends, in the case's unit of time (else as the file says)
    #[arg(long, value_name = "T", value_parser = finite, allow_hyphen_values = true)]
    pub t: Option<f64>,
    /// The integrator
    #[arg(long, value_name = "M")]
    pub method: String,
    /// Tolerance of an adaptive method (else its own)
    #[arg(long, value_name = "T", value_parser = positive, allow_hyphen_values = true, conflicts_with = "dt")]
    pub tol: Option<f64>,
    /// Step of a method of fixed step, in the case's unit of time
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub dt: Option<f64>,
    #[command(flatten)]
    /// What all probes share.
    pub common: ProbeCommon,
}

/// Parses the command line. On `--help` and on wrong usage the text is printed and the exit code given back.
///
/// # Errors
/// The exit code: 0 after help or version, 2 after wrong usage.
pub fn parse(args: impl IntoIterator<Item = OsString>) -> Result<Cli, ExitCode> {
    Cli::try_parse_from(args).and_then(led).map_err(|e| {
        // Nothing is left to tell where the terminal is gone.
        let _ = e.print();
        if e.use_stderr() { ExitCode::from(2) } else { ExitCode::SUCCESS }
    })
}

/// With what was written before the subcommand: folders are the subcommand's own, anything else is told where it belongs.
fn led(mut cli: Cli) -> Result<Cli, clap::Error> {
    if let Some(mode) = &mut cli.mode {
        let play = std::mem::take(&mut cli.play);
        if let Some(option) = play.beside_places() {
            let message = format!("`{option}` before a command is of no use to it: write it behind, as in `syzygy COMMAND {option} …`\n");
            return Err(Cli::command().error(clap::error::ErrorKind::ArgumentConflict, message));
        }
        mode.places_mut().lead(play.places);
    }
    Ok(cli)
}

/// `1280x720` → (1280, 720).
fn size(text: &str) -> Result<(u32, u32), String> {
    const LARGEST: u32 = 16_384;
    let expected = || format!("expected WIDTHxHEIGHT in pixels, each 1 to {LARGEST}, for example 1280x720");
    let (w, h) = text.split_once(['x', 'X', '×']).ok_or_else(expected)?;
    let side = |s: &str| s.parse::<u32>().ok().filter(|v| (1..=LARGEST).contains(v)).ok_or_else(expected);
    Ok((side(w)?, side(h)?))
}

/// A Julian date whose calendar year lies within ±100,000.
fn julian_date(text: &str) -> Result<f64, String> {
    const REACH_DAYS: f64 = 100_000.0 * 365.25;
    let jd: f64 = text.parse().map_err(|_| "expected a Julian date of TDB, for example 2461265.241041667".to_owned())?;
    if !jd.is_finite() || (jd - engine::time::J2000_JD).abs() > REACH_DAYS {
        return Err("expected a Julian date of TDB within 100,000 years of J2000 (2451545.0)".to_owned());
    }
    Ok(jd)
}

/// A finite number.
fn finite(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

/// A finite number above 0.
fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|x| *x > 0.0).ok_or_else(|| "expected a number above 0, for example 1e-9".to_owned())
}

/// A path that ends in `.png` or `.exr`.
fn picture(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("png" | "exr") => Ok(path),
        _ => Err("expected a file name that ends in .png or .exr".to_owned()),
    }
}

impl ShotArgs {
    /// The moment asked for.
    pub fn time(&self) -> Option<SimTime> {
        self.tdb.map(SimTime::from_jd_tdb)
    }
}

#[cfg(test)]
mod tests;
