//! Hot reload: watches the folders that a system was loaded from and tells what in them changed. A broken file gives its faults and
//! nothing else: whoever asks keeps the last good system.
//!
//! Editors save in many ways: over the file, beside it and then renamed, in several writes. All count as one change once files have been
//! still for [`QUIET`]; what editors leave beside the files (backups, swap files) counts as none.

use super::{AssetErrors, Assets};
use crate::world::system::System;
use notify_debouncer_full::notify::event::{CreateKind, RemoveKind};
use notify_debouncer_full::notify::{EventKind, RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, DebouncedEvent, Debouncer, RecommendedCache, new_debouncer};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// How long files must be still before they are read: longer than the pause between two writes of one save, and short against the 0.3 s
/// in which a sky is to follow its file.
pub const QUIET: Duration = Duration::from_millis(60);
/// How often that is looked at.
const LOOK: Duration = Duration::from_millis(10);
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

/// Watches one system.
pub struct Reloader {
    assets: Assets,
    key: String,
    changes: Receiver<DebounceEventResult>,
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
        Ok(Self { assets: assets.clone(), key: key.to_owned(), changes, _watcher: watcher })
    }

    /// The system that is watched.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// What changed since the last time, if anything did.
    pub fn changed(&self) -> Option<Change> {
        let mut changed = None;
        while let Ok(batch) = self.changes.try_recv() {
            changed = changed.max(match batch {
                Ok(events) => events.iter().filter_map(matters).max(),
                Err(_) => Some(Change::All),
            });
        }
        changed
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
