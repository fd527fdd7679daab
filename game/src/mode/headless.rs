//! `syzygy headless`: the session without a window: commands from a log (or none), a save at the end, a film strip.

use super::studio::{Studio, StudioError};
use crate::cli::HeadlessArgs;
use crate::command::Commands;
use crate::picture::{self, PictureError};
use crate::session::Session;
use crate::view::Rig;
use crate::world::World;
use engine::scene::Force;
use indicatif::{ProgressBar, ProgressStyle};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Pictures in a film strip.
const FRAMES: u64 = 8;
/// Ticks between two looks at the progress bar.
const PROGRESS_TICKS: u64 = 600;

/// Why a headless run ended early.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum HeadlessError {
    /// No picture.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Studio(#[from] StudioError),
    /// The strip was not written.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The film's folder cannot be made.
    #[error("{path}: the folder for the film cannot be made: {source}")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Runs `args.ticks` ticks; `commands` gives those of each tick, `after` hears of each tick done. Returns the session at its end.
pub fn run(
    args: &HeadlessArgs,
    mut session: Session,
    commands: &mut dyn FnMut(u64) -> Commands,
    after: &mut dyn FnMut(&Commands, &World),
) -> Result<Session, HeadlessError> {
    let mut film = args.film.as_deref().map(|dir| Film::begin(dir, args)).transpose()?;
    let bar = ProgressBar::new(args.ticks);
    let style = ProgressStyle::with_template("{elapsed_precise} {bar:40} {pos}/{len} ticks, {eta} to go");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let between = (args.ticks / (FRAMES - 1)).max(1);
    for tick in 0..args.ticks {
        if let Some(film) = film.as_mut().filter(|_| tick % between == 0) {
            film.take(&session)?;
        }
        let now = commands(tick);
        session.tick(&now);
        after(&now, &session.world);
        if tick % PROGRESS_TICKS == 0 {
            bar.set_position(tick);
        }
    }
    bar.finish_and_clear();
    if let Some(mut film) = film {
        film.take(&session)?;
        film.finish()?;
    }
    Ok(session)
}

struct Film {
    dir: PathBuf,
    studio: Studio,
    size: (u32, u32),
    frames: Vec<Vec<u8>>,
}

impl Film {
    fn begin(dir: &Path, args: &HeadlessArgs) -> Result<Self, HeadlessError> {
        std::fs::create_dir_all(dir).map_err(|source| HeadlessError::Folder { path: dir.to_owned(), source })?;
        let studio = Studio::open(args.backend, args.size, Force::default())?;
        Ok(Self { dir: dir.to_owned(), studio, size: args.size, frames: Vec::new() })
    }

    fn take(&mut self, session: &Session) -> Result<(), HeadlessError> {
        self.studio.draw(&session.world, &Rig::default())?;
        self.studio.write(&self.dir.join(format!("{:02}.png", self.frames.len())))?;
        self.frames.push(self.studio.pixels()?);
        Ok(())
    }

    fn finish(self) -> Result<(), HeadlessError> {
        let (width, height, strip) = picture::film_strip(self.size.0, self.size.1, &self.frames);
        picture::write_png(&self.dir.join("strip.png"), width, height, &strip)?;
        Ok(())
    }
}
