//! `syzygy bench air`: what air costs to draw, and how wrong it is.
//!
//! [`front`]: error against time of every model and of two published baselines; [`spectral`]: the colours of every air against all wavelengths; [`elek`]: the test flight of the thesis that `view_table` comes from.

pub mod elek;
pub mod front;
pub mod front_plot;
pub mod spectral;

use super::{Error, orbit_rows};
use crate::cli::BenchAirArgs;
use crate::mode::stage::Stage;

/// Runs the part that was asked for.
///
/// # Errors
/// Assets that do not load, no GPU, a file that cannot be written.
pub fn run(args: &BenchAirArgs) -> Result<(), Error> {
    if args.elek {
        return elek::run(args);
    }
    if !args.spectral {
        return front::run(args);
    }
    let rows = spectral::rows(&Stage::set(&args.places)?.assets, &args.body)?;
    Ok(orbit_rows::write(&rows, args.json.as_deref())?)
}
