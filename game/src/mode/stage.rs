//! The stage: assets found, and a session begun from whatever `--start` names, a log begins with or a save holds.

use super::{Error, open, places};
use crate::assets::Assets;
use crate::cli::Places;
use crate::save::SaveV1;
use crate::session::Session;
use crate::world::World;
use crate::world::system::System;
use indicatif::{ProgressBar, ProgressStyle};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Assets, and the systems that were read from them.
pub struct Stage {
    /// Where assets come from.
    pub assets: Assets,
    systems: Mutex<BTreeMap<String, Arc<System>>>,
}

impl Stage {
    /// Finds the assets that the command line names.
    pub fn set(from: &Places) -> Result<Self, Error> {
        let assets = Assets::new(places::assets(from)?, places::mods(from)?);
        Ok(Self { assets, systems: Mutex::new(BTreeMap::new()) })
    }

    /// A system, read once; progress goes to the terminal.
    pub fn system(&self, key: &str) -> Result<Arc<System>, Error> {
        let mut systems = self.systems.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(system) = systems.get(key) {
            return Ok(system.clone());
        }
        let bar = ProgressBar::new(100);
        bar.set_style(ProgressStyle::with_template("{bar:40} reading {msg}").unwrap_or_else(|_| ProgressStyle::default_bar()));
        let read = self.assets.system(key, &|share, name| {
            bar.set_message(name.to_owned());
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            bar.set_position((share * 100.0) as u64);
        });
        bar.finish_and_clear();
        let system = read?;
        systems.insert(key.to_owned(), system.clone());
        Ok(system)
    }

    /// A session from a start's name or a save's file.
    pub fn session(&self, start: &str) -> Result<Session, Error> {
        let world = match open::start(start)? {
            open::Start::Named(name) => {
                let spec = self.assets.start(&name)?;
                let (system, ship) = (self.system(&spec.system)?, self.assets.ship(&spec.ship)?);
                self.assets.world(&name, &spec, system, ship)?
            }
            open::Start::Save(loaded) => {
                for note in &loaded.notes {
                    eprintln!("syzygy: {note}");
                }
                self.restore(&loaded.state).map_err(|problems| match problems {
                    Restored::Error(e) => e,
                    Restored::Problems(problems) => crate::save::SaveError::State { path: loaded.from.clone(), problems }.into(),
                })?
            }
        };
        Ok(Session::new(world))
    }

    /// A World from a save's state.
    pub fn world(&self, state: &SaveV1) -> Result<World, Error> {
        self.restore(state).map_err(|problems| match problems {
            Restored::Error(e) => e,
            Restored::Problems(problems) => {
                crate::save::SaveError::State { path: std::path::PathBuf::from("the state that the log begins with"), problems }.into()
            }
        })
    }

    fn restore(&self, state: &SaveV1) -> Result<World, Restored> {
        let system = self.system(&state.system).map_err(Restored::Error)?;
        let ship = self.assets.ship(&state.ship_key).map_err(|e| Restored::Error(e.into()))?;
        state.restore(&system, &ship).map_err(Restored::Problems)
    }
}

enum Restored {
    Error(Error),
    Problems(Vec<String>),
}
