//! Saves: what is kept of a flight, how it is written so that it is never lost, and how it is read with distrust.
//!
//! - [`v1`]: what is kept; [`restore`]: the way back to a World, distrusting each number
//! - [`format`]: the container: header, checksum, packing; replay logs use it too
//! - [`slots`]: the folder of saves: rings, `.bak`, falling back, the list
//! - [`file`]: one file replaced as a whole or not at all
//!
//! A save is also the scenario format: a start may name one, and a replay log begins with one.

pub mod file;
pub mod format;
pub mod restore;
pub mod slots;
pub mod v1;

pub use format::{FormatError, Header};
pub use slots::{Loaded, Slots};
pub use v1::SaveV1;

use crate::world::World;
use std::path::PathBuf;

/// A World as the payload of a save.
pub fn encode(world: &World) -> Vec<u8> {
    // The only failure of this serializer is a writer's, and a Vec has none.
    rmp_serde::to_vec_named(&SaveV1::from(world)).unwrap_or_default()
}

/// Reads a payload; what it says is not yet checked against a system ([`SaveV1::restore`]).
///
/// # Errors
/// Where the payload is not of this format, and what was expected there.
pub fn decode(payload: &[u8]) -> Result<SaveV1, Vec<String>> {
    rmp_serde::from_slice(payload).map_err(|e| vec![format!("the payload is not a state of format 1: {e}")])
}

/// What the list of saves shows of a World.
pub fn label(world: &World) -> slots::Label {
    let rigid = world.rigid();
    let body = world.system.body(rigid.body);
    slots::Label { time: world.time, body: body.key.clone(), altitude_m: rigid.state.position.length() - body.radius_m }
}

/// A World saved and loaded in memory: what a file would give back.
///
/// # Errors
/// What [`SaveV1::restore`] finds wrong.
pub fn round_trip(world: &World) -> Result<World, Vec<String>> {
    decode(&encode(world))?.restore(&world.system, &world.ship.spec)
}

/// ` (did you mean …?)` for a name that is not among those known; empty when none is near.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let best = known.map(|k| (strsim::damerau_levenshtein(name, k), k)).min();
    best.filter(|(d, k)| *d <= 2.max(k.len() / 3)).map_or_else(String::new, |(_, k)| format!("; did you mean `{k}`?"))
}

/// What may go wrong with a save.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SaveError {
    /// The file cannot be read or written.
    #[error("{}: cannot {action}: {source}", path.display())]
    #[diagnostic(code(save::io), help("the file that was there before, if any, is intact"))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// Why it failed.
        source: std::io::Error,
    },
    /// The container is damaged or from a newer program.
    #[error("{}: {source}", path.display())]
    #[diagnostic(code(save::format))]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong, and at which byte.
        source: FormatError,
    },
    /// The container is sound, what it says is not.
    #[error("{}: {}", path.display(), problems.join("; "))]
    #[diagnostic(code(save::state))]
    State {
        /// The file.
        path: PathBuf,
        /// Every field at fault, with what was expected.
        problems: Vec<String>,
    },
    /// What was written does not read back.
    #[error("{}: the save did not read back as it was written: {what}; nothing was replaced", path.display())]
    #[diagnostic(code(save::self_check), help("the disk or its driver is at fault: save to another disk"))]
    SelfCheck {
        /// The file.
        path: PathBuf,
        /// The difference.
        what: String,
    },
    /// Neither the file nor anything to fall back on can be read.
    #[error("{}: it cannot be read, and nothing to fall back on can: {}", path.display(), tried.join("; "))]
    #[diagnostic(code(save::nothing_left))]
    NothingLeft {
        /// The file asked for.
        path: PathBuf,
        /// What was tried, each with its reason.
        tried: Vec<String>,
    },
}

impl SaveError {
    /// True when the file was written by a newer program.
    pub fn is_newer(&self) -> bool {
        matches!(self, Self::Format { source, .. } if source.is_newer())
    }
}
