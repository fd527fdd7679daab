//! Saves: what is kept of a flight, how it is written so that it is never lost, and how it is read with distrust.
//!
//! - [`format`]: the container: header, checksum, packing; replay logs use it too
//! - [`slots`]: the folder of saves: rings, `.bak`, falling back, the list
//! - [`file`]: one file replaced as a whole or not at all
//!
//! A save is also the scenario format: a start may name one, and a replay log begins with one.

pub mod file;
pub mod format;
pub mod slots;

pub use format::{FormatError, Header};
pub use slots::{Loaded, Slots};

use std::path::PathBuf;

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
