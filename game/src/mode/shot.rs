//! `syzygy shot`: one picture of a start, a moment and a camera.

use super::studio::{Studio, StudioError, write_passes};
use crate::cli::ShotArgs;
use crate::session::Session;
use crate::view::Rig;
use crate::view::place::PlaceError;
use crate::world::ship::contact;
use engine::render::PassReport;
use engine::scene::{AutoOr, Force};
use thiserror::Error;

/// Why there is no picture.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum ShotError {
    /// The camera is none.
    #[error(transparent)]
    Camera(#[from] PlaceError),
    /// It was not drawn or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Studio(#[from] StudioError),
}

/// What the World's own heavy subsystem did, in the list of passes: contact is skipped far from ground.
fn rapier(session: &Session) -> PassReport {
    let (ran, why) = contact::subsystem(&session.world.ship);
    PassReport { name: "rapier".to_owned(), ran, reason: why.to_owned(), gpu_ms: None }
}

/// Draws the picture and writes what was asked for.
pub fn run(args: &ShotArgs, mut session: Session) -> Result<(), ShotError> {
    let mut rig = Rig::parse(&args.camera, &session.world.system)?;
    rig.exposure = AutoOr::Auto { compensation_ev: args.compensation.clamp(-20.0, 20.0) };
    if let Some(time) = args.time() {
        // The ship keeps its place about its body; the sky moves to the moment.
        session.world.move_clock(time);
    }
    let mut studio = Studio::open(args.backend, args.size, Force { all: args.force_passes })?;
    let mut report = studio.draw(&session.world, &rig)?;
    report.passes.push(rapier(&session));
    studio.write(&args.out)?;
    if let Some(path) = &args.passes {
        write_passes(path, &report)?;
    }
    Ok(())
}
