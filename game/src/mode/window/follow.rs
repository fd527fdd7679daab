//! Follows the files of the system that is flown: what changed is read again, airs at once, to be seen in the very frame that hears of it,
//! all else on a thread. Not here: what the flight and the screen make of it (`app/watch.rs`), the watching ([`crate::assets::reload`]).

use super::job::{Job, Outcome};
use crate::assets::reload::Change;
use crate::assets::{AssetErrors, Assets, Reloader};
use crate::world::system::System;
use std::sync::Arc;

/// What is watched, and what came of it.
#[derive(Default)]
pub struct Follow {
    reloader: Option<Reloader>,
    reading: Option<Job<Result<Arc<System>, AssetErrors>>>,
    /// A file other than an air's is broken: all of them are read again.
    broken: bool,
    /// The files tell of other bodies than the flight has: the next flight is to read them.
    pub stale: bool,
}

impl Follow {
    /// Watches the files of a system from now on; that changes are not noticed where that is not possible is logged.
    pub fn watch(&mut self, assets: &Assets, key: &str) {
        match Reloader::watch(assets, key) {
            Ok(reloader) => self.reloader = Some(reloader),
            Err(e) => tracing::warn!("changed files will not be noticed: {e}"),
        }
    }

    /// The system that is watched.
    pub fn key(&self) -> Option<&str> {
        self.reloader.as_ref().map(Reloader::key)
    }

    /// Once a frame: `None` while there is nothing new; else the system as its files have it now, or everything that is wrong with them.
    /// `flown` is the system in force.
    pub fn hear(&mut self, assets: &Assets, flown: &System) -> Option<Result<Arc<System>, AssetErrors>> {
        let reloader = self.reloader.as_ref()?;
        let read = match self.reading.as_mut().map(Job::poll) {
            Some(Outcome::Running) => return None,
            Some(Outcome::Done(read)) => Some(read),
            Some(Outcome::Died) | None => None,
        };
        self.reading = None;
        // A file that was saved again while it was read is read again, and only then believed.
        match (reloader.changed(), read) {
            (None, read) => {
                self.broken = read.as_ref().map_or(self.broken, Result::is_err);
                read
            }
            // A few milliseconds.
            (Some(Change::Airs), None) if !self.stale && !self.broken => Some(assets.airs(flown)),
            (Some(_), _) => {
                let (assets, key) = (assets.clone(), reloader.key().to_owned());
                self.reading = Some(Job::spawn(move |progress| assets.system(&key, progress)));
                None
            }
        }
    }
}
