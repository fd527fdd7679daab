//! `syzygy probe`: one number or table at a time, for tests and tools outside.

pub mod air;
pub mod eclipses;
pub mod ephemeris;
pub mod height;
pub mod kepler;
pub mod propagate;
pub mod sky;

use super::Error;
use super::bench::orbit_case;
use super::bench::orbit_method::Method;
use super::stage::Stage;
use crate::assets::fault::did_you_mean;
use crate::cli::{Probe, ProbeCommon};
use crate::world::system::System;
use engine::orbit::BodyId;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

/// Answers a probe.
pub fn run(probe: &Probe) -> Result<(), Error> {
    match probe {
        Probe::Air(args) => {
            let system = system(&args.common)?;
            let body = system.body(find(&system, &args.body)?);
            let Some(air) = &body.air else { return Err(Error::NoAir(args.body.clone())) };
            answer(args.common.out.as_deref(), |out| air::write(air, &args.altitude_m, out))
        }
        Probe::Height(args) => {
            let points = height::points(&args.points)?;
            let system = system(&args.common)?;
            let body = system.body(find(&system, &args.body)?);
            let Some(relief) = &body.relief else { return Err(height::HeightError::NoGround(args.body.clone()).into()) };
            answer(args.common.out.as_deref(), |out| height::write(relief, &points, out))
        }
        Probe::Kepler(args) => {
            let cases = kepler::cases(&args.cases)?;
            answer(args.out.as_deref(), |out| kepler::write(&cases, out))
        }
        Probe::Ephemeris(args) => {
            let system = system(&args.common)?;
            let body = find(&system, &args.body)?;
            let center = args.center.as_deref().map(|c| find(&system, c)).transpose()?;
            answer(args.common.out.as_deref(), |out| ephemeris::write(&system.ephemeris, body, center, &args.tdb, out))
        }
        Probe::Propagate(args) => {
            let method = Method::find(&args.method)?;
            let setting = method.setting(args.tol, args.dt)?;
            let case = orbit_case::read(&args.case, args.name.as_deref(), args.t)?;
            answer(args.common.out.as_deref(), |out| propagate::write(&case, method, setting, out))
        }
        Probe::Sky(args) => {
            let (rays, found) = sky::answer(args)?;
            answer(args.out.as_deref(), |out| sky::write(&rays, &found, out))
        }
        Probe::Eclipses(args) => {
            let system = system(&args.common)?;
            let (on, by) = (find(&system, &args.on)?, find(&system, &args.by)?);
            answer(args.common.out.as_deref(), |out| eclipses::write(&system, on, by, args, out))
        }
    }
}

fn system(common: &ProbeCommon) -> Result<Arc<System>, Error> {
    Stage::set(&common.places)?.system(&common.system)
}

fn find(system: &System, key: &str) -> Result<BodyId, Error> {
    system.find(key).ok_or_else(|| {
        let known: Vec<&str> = system.bodies.iter().map(|b| b.key.as_str()).collect();
        let near = did_you_mean(key, known.iter().copied()).map(|n| format!("did you mean `{n}`? "));
        Error::NoBody { body: key.to_owned(), help: format!("{}bodies are {}", near.unwrap_or_default(), known.join(", ")) }
    })
}

fn answer(out: Option<&Path>, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    let Some(path) = out else { return Ok(write(&mut io::stdout().lock())?) };
    let failed = |source| Error::Out { path: path.to_owned(), source };
    let mut file = File::create(path).map_err(failed)?;
    write(&mut file).map_err(failed)
}
