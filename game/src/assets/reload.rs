//! Hot reload: a system's files are watched while one flies; a broken file keeps the last good system.

use super::{AssetErrors, Assets};
use crate::world::system::System;
use notify_debouncer_full::notify::{RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, Debouncer, RecommendedCache, new_debouncer};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// How long a file must be quiet before it is read, ms.
const QUIET_MS: u64 = 120;

/// Watches the files of one system.
pub struct Reloader {
    assets: Assets,
    key: String,
    changes: Receiver<DebounceEventResult>,
    // Dropping it ends the watch.
    _watch: Debouncer<RecommendedWatcher, RecommendedCache>,
}

impl Reloader {
    /// Begins to watch; the error says why that is not possible here (the game goes on without).
    pub fn watch(assets: &Assets, key: &str) -> Result<Self, String> {
        let (sender, changes) = channel();
        let mut watch = new_debouncer(Duration::from_millis(QUIET_MS), None, sender).map_err(|e| e.to_string())?;
        for root in &assets.overlay.roots {
            let folder = root.join(Path::new("systems").join(key));
            if folder.is_dir() {
                watch.watch(&folder, RecursiveMode::Recursive).map_err(|e| format!("{}: {e}", folder.display()))?;
            }
        }
        Ok(Self { assets: assets.clone(), key: key.to_owned(), changes, _watch: watch })
    }

    /// The system anew when a file has changed since the last call; the faults when it no longer reads.
    pub fn poll(&self) -> Option<Result<Arc<System>, AssetErrors>> {
        let touched = |event: DebounceEventResult| event.is_ok_and(|events| events.iter().any(|e| !e.kind.is_access()));
        let changed = self.changes.try_iter().map(touched).fold(false, |a, b| a || b);
        changed.then(|| self.assets.system(&self.key, &|_, _| ()))
    }
}
