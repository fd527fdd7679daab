//! The modes: what the program does, one file each. [`run`] reads like the list of them.
//!
//! Not here: the words themselves ([`crate::cli`]), the loop that modes share ([`crate::session`]).

pub mod headless;
pub mod open;
pub mod places;
pub mod probe;
pub mod replay;
pub mod shot;
pub mod studio;

use crate::cli::{Cli, Mode, Places, Probe};
use std::process::ExitCode;

/// What may stop a mode.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum Error {
    /// A folder is missing.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Place(#[from] places::PlaceError),
    /// A save cannot be read or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Save(#[from] crate::save::SaveError),
    /// A replay cannot be read or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Log(#[from] crate::replay::LogError),
}

/// Runs the mode that the command line names, and turns what comes of it into an exit code.
pub fn run(cli: Cli) -> ExitCode {
    let mode = cli.mode.unwrap_or(Mode::Play(cli.play));
    let places = places_of(&mode);
    start_log(places.verbose);
    let outcome = places::assets(places).map_err(Error::from).map(|_| ExitCode::SUCCESS);
    outcome.unwrap_or_else(|error| {
        eprintln!("{:?}", miette::Report::new(error));
        ExitCode::FAILURE
    })
}

fn places_of(mode: &Mode) -> &Places {
    match mode {
        Mode::Play(a) => &a.places,
        Mode::Headless(a) => &a.places,
        Mode::Replay(a) => &a.places,
        Mode::Shot(a) => &a.places,
        Mode::CheckAssets(a) => &a.places,
        Mode::Probe(Probe::Air(a)) => &a.common.places,
        Mode::Probe(Probe::Height(a)) => &a.common.places,
        Mode::Probe(Probe::Ephemeris(a)) => &a.common.places,
    }
}

/// Logs go to stderr, so that stdout stays machine output.
fn start_log(verbose: u8) {
    use tracing_subscriber::EnvFilter;
    let level = ["warn", "info", "debug"].get(usize::from(verbose)).unwrap_or(&"trace");
    let quiet = format!("{level},wgpu_core=error,wgpu_hal=error,naga=error");
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(quiet));
    // A second call (tests run several modes in one process) keeps the first log.
    let _ = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).without_time().try_init();
}
