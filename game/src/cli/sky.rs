//! The arguments of `probe sky`.

use super::{Backend, Places, positive};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `probe sky`.
#[derive(Clone, Debug, Default, Args)]
pub struct ProbeSkyArgs {
    /// The planet: TOML with radius_km, [star] (wavelengths_nm, irradiance_w_m2_nm, three each, and angular_radius_deg) and
    /// [atmosphere] (the keys of an atmosphere.toml, or atmosphere = "FILE"; its three channels are the star's wavelengths); for an
    /// eclipse also [[occluders]], each with radius_m and centre_m = [x, y, z] from the planet's centre (or direction = [x, y, z] and distance_m)
    #[arg(long, value_name = "F.toml")]
    pub planet: PathBuf,
    /// Rays: CSV with the columns cam_x_km, cam_y_km, cam_z_km (from the planet's centre), view_x … view_z, sun_x … sun_z (unit
    /// vectors) and wavelength_nm (one of the star's); others are carried through
    #[arg(long, value_name = "F.csv")]
    pub rays: PathBuf,
    /// reference (f64 quadrature and Monte Carlo; also writes the standard error, `stderr`), or a model that draws: physical,
    /// thickness, limb_table, view_table, gradient
    #[arg(long, value_name = "M", value_parser = MODELS)]
    pub model: String,
    /// Standard error at which the reference is content, relative to the radiance
    #[arg(long, value_name = "X", default_value_t = 0.001, value_parser = positive)]
    pub rel_error: f64,
    /// Seed of the reference's draws
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Graphics interface of the models
    #[arg(long, value_enum, value_name = "NAME")]
    pub backend: Option<Backend>,
    /// Write here instead of stdout
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    /// Folders.
    pub places: Places,
}

/// What may answer.
const MODELS: [&str; 6] = ["reference", "physical", "thickness", "limb_table", "view_table", "gradient"];
