//! Opening: from what `--start` names, or what a save or a log says, to a World with its assets.
//!
//! A start is a save when it names a file that is there, or looks like a path; else it is a start's `.toml` file, or the name of
//! a start in the assets.

use crate::save::slots::{ENDING, Loaded};
use crate::save::{self, SaveError, SaveV1, Slots};
use std::path::Path;

/// What `--start` turned out to be.
#[derive(Debug)]
pub enum Start {
    /// A start of the assets by name, or the path of its `.toml` file.
    Named(String),
    /// A save.
    Save(Box<Loaded<SaveV1>>),
}

/// Reads what `--start` names, so far as no assets are needed. A damaged save falls back as the game does.
///
/// # Errors
/// [`SaveError`], naming the file.
pub fn start(text: &str) -> Result<Start, SaveError> {
    let path = Path::new(text);
    let looks_like_one = path.extension().is_some_and(|e| e == ENDING) || text.contains(['/', '\\']);
    let written = path.extension().is_some_and(|e| e == "toml");
    if written || (!path.is_file() && !looks_like_one) {
        return Ok(Start::Named(text.to_owned()));
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    Ok(Start::Save(Box::new(Slots::new(folder).load(path, &save::decode)?)))
}
