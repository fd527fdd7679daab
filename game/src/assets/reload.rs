//! Hot reload: watches the folders that a system was loaded from and tells what in them changed. A broken file gives its faults and
//! nothing else: whoever asks keeps the last good system.
//!
//! Editors save in many ways: over the file, beside it and then renamed, in several writes. All count as one change once files have been
//! still for [`QUIET`], and a file that was emptied waits for what is written into it. What editors leave beside the files (backups, swap
//! files) counts as none.

use super::{AssetErrors, Assets};
use crate::world::system::System;
use notify_debouncer_full::notify::event::{CreateKind, RemoveKind};
use notify_debouncer_full::notify::{EventKind, RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, DebouncedEvent, Debouncer, RecommendedCache, new_debouncer};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// How long files must be still before they are read: longer than the pause between two writes of one save, and short against the 0.3 s
/// in which a sky is to follow its file.
pub const QUIET: Duration = Duration::from_millis(60);
/// How often that is looked at.
const LOOK: Duration = Duration::from_millis(10);
/// How long a file without a byte is taken for one that is still being written.
const EMPTY: Duration = Duration::from_millis(400);
/// Endings of what assets are made of.
const ENDINGS: [&str; 5] = ["toml", "cube", "png", "jpg", "jpeg"];

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// Only airs: files named `atmosphere…`.
    Airs,
    /// Anything else, or more.
    All,
}

/// A change that waits for files that were emptied and are not written yet.
#[derive(Default)]
struct Held {
    change: Option<Change>,
    empty: Vec<(PathBuf, Instant)>,
}

/// Watches one system.
pub struct Reloader {
    assets: Assets,
    key: String,
    changes: Receiver<DebounceEventResult>,
    held: RefCell<Held>,
    // Dropping it ends the watch.
    _watcher: Debouncer<RecommendedWatcher, RecommendedCache>,
}

impl Reloader {
    /// Watches bodies, systems and maps in the assets and in the mods; the error says why that is not possible here (the game goes on
    /// without).
    pub fn watch(assets: &Assets, key: &str) -> Result<Self, String> {
        let (tell, changes) = channel();
        let mut watcher = new_debouncer(QUIET, Some(LOOK), tell).map_err(|e| e.to_string())?;
        for (i, root) in assets.overlay.roots().iter().enumerate() {
            // A mod may get folders that it has not yet: all of it is watched. The assets hold far more than a system.
            let folders = if i == 0 { ["bodies", "systems", "maps"].map(|f| root.join(f)).to_vec() } else { vec![root.clone()] };
            for folder in folders.iter().filter(|f| f.is_dir()) {
                watcher.watch(folder, RecursiveMode::Recursive).map_err(|e| format!("{}: {e}", folder.display()))?;
            }
        }
        Ok(Self { assets: assets.clone(), key: key.to_owned(), changes, held: RefCell::default(), _watcher: watcher })
    }

    /// The system that is watched.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// What changed since the last time, if anything did.
    pub fn changed(&self) -> Option<Change> {
        let mut held = self.held.borrow_mut();
        let empty = |path: &PathBuf| path.metadata().is_ok_and(|m| m.is_file() && m.len() == 0);
        while let Ok(batch) = self.changes.try_recv() {
            let Ok(events) = batch else {
                held.change = Some(Change::All);
                continue;
            };
            for event in &events {
                let Some(change) = matters(event) else { continue };
                held.change = held.change.max(Some(change));
                for path in event.paths.iter().filter(|path| of_file(path).is_some()) {
                    let known = held.empty.iter().position(|(known, _)| known == path);
                    match (empty(path), known) {
                        (true, None) => held.empty.push((path.clone(), Instant::now())),
                        (false, Some(i)) => drop(held.empty.remove(i)),
                        _ => {}
                    }
                }
            }
        }
        held.empty.retain(|(_, since)| since.elapsed() < EMPTY);
        if held.empty.is_empty() { held.change.take() } else { None }
    }

    /// `None` while nothing changed; else the system as it is now, or everything that is wrong with it. `last` is the last good one.
    pub fn poll(&self, last: &System) -> Option<Result<Arc<System>, AssetErrors>> {
        Some(match self.changed()? {
            Change::Airs => self.assets.airs(last),
            Change::All => self.assets.system(&self.key, &|_, _| ()),
        })
    }
}

/// What an event changes, if it changes anything that is read.
fn matters(event: &DebouncedEvent) -> Option<Change> {
    // Reading a file is an event as well, on some systems.
    if event.kind.is_access() {
        return None;
    }
    let folder = matches!(event.kind, EventKind::Create(CreateKind::Folder) | EventKind::Remove(RemoveKind::Folder));
    event.paths.iter().filter_map(|path| if folder { Some(Change::All) } else { of_file(path) }).max()
}

fn of_file(path: &Path) -> Option<Change> {
    let name = path.file_name()?.to_str()?;
    let ending = Path::new(name).extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase)?;
    if name.starts_with('.') || !ENDINGS.contains(&ending.as_str()) {
        return None;
    }
    Some(if name.starts_with("atmosphere") { Change::Airs } else { Change::All })
}
