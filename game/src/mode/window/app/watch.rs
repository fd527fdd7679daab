//! Hot reload in the window: a system whose files change is read again on a thread and taken over by the flight; a broken file
//! leaves the last good one in force and stands on the screen until it is mended. Not here: the watching ([`crate::assets::reload`]).

use super::App;
use crate::assets::reload::Change;
use crate::assets::{AssetErrors, Reloader};
use crate::mode::window::ahead::Ahead;
use crate::mode::window::job::{Job, Outcome};
use crate::world::system::System;
use std::sync::Arc;

/// What is watched, and what came of it.
#[derive(Default)]
pub struct Watch {
    reloader: Option<Reloader>,
    reading: Option<Job<Result<Arc<System>, AssetErrors>>>,
    /// A file other than an air's is broken: all of them are read again.
    broken: bool,
    /// The files tell of other bodies than the flight has: the next flight is to read them.
    pub stale: bool,
}

impl App {
    /// Works out the paths of the flight's bodies beside it; what was begun for other ones ends.
    fn look_ahead(&mut self) {
        let Some(flight) = &self.flight else { return };
        let system = &flight.session.world.system;
        self.ahead = Some(Ahead::start(&system.ephemeris, &system.key, self.opening.cache.as_deref()));
    }

    /// Watches the system of the flight.
    pub(super) fn watch_system(&mut self) {
        self.look_ahead();
        let Some(flight) = &self.flight else { return };
        let key = flight.session.world.system.key.as_str();
        if !self.watch.stale && self.watch.reloader.as_ref().is_some_and(|r| r.key() == key) {
            return;
        }
        self.watch = Watch::default();
        self.hud.fault = None;
        match Reloader::watch(&self.opening.assets, key) {
            Ok(reloader) => self.watch.reloader = Some(reloader),
            Err(e) => tracing::warn!("changed files will not be noticed: {e}"),
        }
    }

    /// Watches folders that are new, too, and takes over what is in them already.
    pub(super) fn watch_anew(&mut self) {
        let Some(flight) = &self.flight else { return };
        let system = flight.session.world.system.clone();
        match Reloader::watch(&self.opening.assets, &system.key) {
            Ok(reloader) => self.watch.reloader = Some(reloader),
            Err(e) => tracing::warn!("changed files will not be noticed: {e}"),
        }
        let read = self.opening.assets.airs(&system);
        self.take_over(read);
    }

    /// Takes over what changed.
    pub(super) fn hear_watch(&mut self) {
        let Some(reloader) = &self.watch.reloader else { return };
        let read = match self.watch.reading.as_mut().map(Job::poll) {
            Some(Outcome::Running) => return,
            Some(Outcome::Done(read)) => Some(read),
            Some(Outcome::Died) | None => None,
        };
        self.watch.reading = None;
        // A file that was saved again while it was read is read again, and only then believed.
        let Some(flight) = &self.flight else { return };
        let read = match (reloader.changed(), read) {
            (None, None) => return,
            (None, Some(read)) => {
                self.watch.broken = read.is_err();
                read
            }
            // A few milliseconds: read at once, to be seen in this frame.
            (Some(Change::Airs), None) if !self.watch.stale && !self.watch.broken => self.opening.assets.airs(&flight.session.world.system),
            (Some(_), _) => {
                let (assets, key) = (self.opening.assets.clone(), reloader.key().to_owned());
                self.watch.reading = Some(Job::spawn(move |progress| assets.system(&key, progress)));
                return;
            }
        };
        self.take_over(read);
    }

    fn take_over(&mut self, read: Result<Arc<System>, AssetErrors>) {
        let Some(flight) = &mut self.flight else { return };
        match read {
            Ok(system) => {
                self.hud.fault = None;
                let seen_only = system.hash == flight.session.world.system.hash;
                if !seen_only {
                    system.ephemeris.take_over(&flight.session.world.system.ephemeris);
                }
                self.watch.stale = !flight.session.adopt(&system);
                flight.readout = flight.session.world.readout();
                self.hud.notice(if self.watch.stale {
                    format!("{}: other bodies than before; the next flight takes them over", system.name)
                } else {
                    format!("{}: changed files taken over", system.name)
                });
                self.hud.warn(&system.warnings);
                self.trial = None;
                self.hud.air.changed = true;
                if !seen_only {
                    self.look_ahead();
                }
            }
            Err(errors) => self.hud.fault = Some(errors.lines()),
        }
    }
}
