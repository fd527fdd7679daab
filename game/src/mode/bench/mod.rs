//! `syzygy bench`: run time against error, measured and drawn.
//!
//! Each bench prints its rows as JSON on stdout (or into `--json`), one object a run, so that tools compare them with others'.
//! Not here: the numbers that probes give ([`super::probe`]), the tests that hold them.

pub mod air;
pub mod ephemeris;
pub mod kepler;
pub mod orbit;
pub mod orbit_case;
pub mod orbit_method;
pub mod orbit_plot;
pub mod orbit_rows;
pub mod orbit_stress;
pub mod ships;

use super::Error;
use crate::cli::Bench;

/// Runs a bench.
pub fn run(bench: &Bench) -> Result<(), Error> {
    match bench {
        Bench::Air(args) => air::run(args),
        Bench::Orbit(args) => orbit::run(args),
        Bench::Ships(args) => ships::run(args),
        Bench::Ephemeris(args) => ephemeris::run(args),
        Bench::Kepler(args) => Ok(orbit_rows::write(&kepler::rows(), args.json.as_deref())?),
    }
}
