//! The arguments of `bench`.

use super::Places;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `bench air`.
#[derive(Clone, Debug, Args)]
pub struct BenchAirArgs {
    /// Judge the colours instead: ΔE2000 against all wavelengths
    #[arg(long)]
    pub spectral: bool,
    /// Fly Elek's test flight instead, with the model `view_table`: five tests, a pitch from straight down to straight up
    #[arg(long, conflicts_with = "spectral")]
    pub elek: bool,
    /// The flight at his sizes: pictures of 800×600 and 2560×2048, tables of 256³ and 128³, a frame for every second
    #[arg(long, requires = "elek")]
    pub full: bool,
    /// Draw error against time, a picture for each light and one for all, into this folder
    #[arg(long, value_name = "DIR", conflicts_with_all = ["spectral", "elek"])]
    pub plot: Option<PathBuf>,
    /// Only these planets of tests/reference/planets: earth, thick, dusty
    #[arg(long, value_name = "NAME", value_parser = ["earth", "thick", "dusty"], default_value = "earth")]
    pub planet: Vec<String>,
    /// Pictures of 160×90 times this, odd: 3 makes 480×270, 7 makes 1120×630
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(3..=15))]
    pub scale: u32,
    /// Rounds, of which the fastest counts
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,
    /// Ask the reference anew (minutes) and write what it says here, instead of reading tests/reference/sky_front.csv
    #[arg(long, value_name = "F.csv", conflicts_with_all = ["spectral", "elek"])]
    pub truth: Option<PathBuf>,
    /// Write the rows here instead of stdout
    #[arg(long, value_name = "F.json")]
    pub json: Option<PathBuf>,
    /// Only the colours of these bodies, folders of assets/bodies; all where none is named
    #[arg(long, value_name = "NAME", requires = "spectral")]
    pub body: Vec<String>,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `bench orbit`.
#[derive(Clone, Debug, Args)]
pub struct BenchOrbitArgs {
    /// Write the rows here instead of stdout
    #[arg(long, value_name = "F.json")]
    pub json: Option<PathBuf>,
    /// Draw error against CPU time and evaluations, a picture a case, into this folder
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
    /// Rows of other programs, measured on this machine (tests/peers), to draw beside
    #[arg(long, value_name = "F.json")]
    pub peers: Option<PathBuf>,
    /// Only these cases; several may be named, `NAME@T` ends at a reference time
    #[arg(long, value_name = "NAME")]
    pub case: Vec<String>,
    /// Only these integrators
    #[arg(long, value_name = "M")]
    pub method: Vec<String>,
    /// Evaluations of the force after which a method of fixed step is not refined further
    #[arg(long, value_name = "N", default_value_t = 2_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub most: u64,
    /// Stress the integrators instead: long spans, spikes of the step, scales, near collisions
    #[arg(long)]
    pub stress: bool,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `bench ephemeris`.
#[derive(Clone, Debug, Args)]
pub struct BenchEphemerisArgs {
    /// Write the rows here instead of stdout
    #[arg(long, value_name = "F.json")]
    pub json: Option<PathBuf>,
    /// The system, a folder of assets/systems
    #[arg(long, value_name = "NAME", default_value = "sol")]
    pub system: String,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `bench kepler`.
#[derive(Clone, Debug, Args)]
pub struct BenchKeplerArgs {
    /// Write the rows here instead of stdout
    #[arg(long, value_name = "F.json")]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// Arguments of `bench ships`.
#[derive(Clone, Debug, Args)]
pub struct BenchShipsArgs {
    /// Write the rows here instead of stdout
    #[arg(long, value_name = "F.json")]
    pub json: Option<PathBuf>,
    /// The system, a folder of assets/systems
    #[arg(long, value_name = "NAME", default_value = "sol")]
    pub system: String,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}
