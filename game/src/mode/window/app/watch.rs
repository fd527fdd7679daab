//! Hot reload in the window: a system whose files change is read again on a thread and taken over by the flight; a broken file
//! leaves the last good one in force and stands on the screen until it is mended. Not here: the watching ([`crate::assets::reload`]).

use super::App;
use crate::assets::AssetErrors;
use crate::mode::window::ahead::Ahead;
use crate::mode::window::follow::Follow;
use crate::world::system::System;
use std::sync::Arc;

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
        if !self.watch.stale && self.watch.key() == Some(key) {
            return;
        }
        self.watch = Follow::default();
        self.hud.fault = None;
        self.watch.watch(&self.opening.assets, key);
    }

    /// Watches folders that are new, too, and takes over what is in them already.
    pub(super) fn watch_anew(&mut self) {
        let Some(flight) = &self.flight else { return };
        let system = flight.session.world.system.clone();
        self.watch.watch(&self.opening.assets, &system.key);
        let read = self.opening.assets.airs(&system);
        self.take_over(read);
    }

    /// Takes over what changed.
    pub(super) fn hear_watch(&mut self) {
        let Some(flight) = &self.flight else { return };
        if let Some(read) = self.watch.hear(&self.opening.assets, &flight.session.world.system) {
            self.take_over(read);
        }
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
                self.follow_air();
                if !seen_only {
                    self.look_ahead();
                }
            }
            Err(errors) => self.hud.fault = Some(errors.on_screen()),
        }
    }
}
