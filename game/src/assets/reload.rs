//! Hot reload: watches the folders that a system was loaded from and loads it again when something in them changed. A broken file
//! gives its faults and nothing else: whoever polls keeps the last good system.

use super::{AssetErrors, Assets};
use crate::world::system::System;
use notify_debouncer_full::notify::{RecommendedWatcher, RecursiveMode};
use notify_debouncer_full::{DebounceEventResult, Debouncer, RecommendedCache, new_debouncer};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// How long files must be still before they are read: editors write in several steps.
const QUIET: Duration = Duration::from_millis(250);

/// Watches one system.
pub struct Reloader {
    assets: Assets,
    key: String,
    changes: Receiver<DebounceEventResult>,
    // Dropping it ends the watch.
    _watcher: Debouncer<RecommendedWatcher, RecommendedCache>,
}

impl Reloader {
    /// Watches the system's folder and the bodies in the assets and in the mods; the error says why that is not possible here (the game goes on without).
    pub fn watch(assets: &Assets, key: &str) -> Result<Self, String> {
        let (tell, changes) = channel();
        let mut watcher = new_debouncer(QUIET, None, tell).map_err(|e| e.to_string())?;
        for root in assets.overlay.roots() {
            // A mod that does not have the folder yet may get it: then all of the mod is watched.
            let bodies = root.join("bodies");
            let folders = if bodies.is_dir() { vec![bodies, root.join("systems"), root.join("maps")] } else { vec![root.clone()] };
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

    /// True once after files changed, for those who read on a thread of their own.
    pub fn changed(&self) -> bool {
        let mut changed = false;
        while let Ok(batch) = self.changes.try_recv() {
            changed |= match batch {
                // Reading a file is an event as well, on some systems.
                Ok(events) => events.iter().any(|e| !e.kind.is_access()),
                Err(_) => true,
            };
        }
        changed
    }

    /// `None` while nothing changed; else the system as it is now, or everything that is wrong with it.
    pub fn poll(&self) -> Option<Result<Arc<System>, AssetErrors>> {
        self.changed().then(|| self.assets.system(&self.key, &|_, _| ()))
    }
}
