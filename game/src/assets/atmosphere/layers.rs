//! The layers of an air: coefficients as written, or made of physical inputs.

use super::Datum;
use super::optics::{self, Channels, KINDS};
use crate::assets::fault::Fault;
use crate::assets::reader::{ANY, Reader};
use engine::air::spectral::{Optics, SpectralLayer};
use engine::air::{Phase, Profile};
use serde::de::DeserializeOwned;

/// Names that a patch of the list means otherwise.
const RESERVED: [&str; 2] = ["add", "remove"];

/// Reads the list; what is left out and needed is written down.
pub fn read(r: &Reader<'_>, datum: Datum, channels: Channels) -> Vec<SpectralLayer> {
    let tables = r.tables("layers");
    check_names(&tables);
    tables.iter().filter_map(|t| layer(t, datum, channels)).collect()
}

/// Items of a list are called by their names in patches: each name is there once.
pub fn check_names(items: &[Reader<'_>]) {
    let mut names: Vec<String> = Vec::new();
    for t in items {
        let Some(name) = t.maybe_text("name") else { continue };
        let place = t.node.place_of("name");
        if names.contains(&name) {
            t.fault(Fault::at(&place, format!("`name` = \"{name}\": another one is named so: expected each name once")));
        } else if RESERVED.contains(&name.as_str()) {
            t.fault(Fault::at(&place, format!("`name` = \"{name}\": patches of the list use this word: expected another name")));
        }
        names.push(name);
    }
}

fn layer(t: &Reader<'_>, datum: Datum, channels: Channels) -> Option<SpectralLayer> {
    if KINDS.into_iter().any(|kind| t.has(kind)) {
        return optics::read(t, datum, channels);
    }
    let optics = Optics::Channels(t.numbers("scattering_per_m", ANY), t.numbers("absorption_per_m", ANY));
    let profile = typed::<Profile>(t, "profile", "a table with the `kind` of profile");
    let phase = typed::<Phase>(t, "phase", "a table with the `kind` of phase function");
    Some(SpectralLayer { optics, profile: profile?, phase: phase? })
}

/// A table that holds to its keys, as the engine's type of it.
pub fn typed<T: DeserializeOwned>(t: &Reader<'_>, key: &'static str, expected: &str) -> Option<T> {
    let node = t.needed(key, expected)?;
    match serde_json::from_value(node.json()) {
        Ok(value) => Some(value),
        Err(e) => {
            t.wrong(key, format!("`{key}`: {e}: expected {expected}"));
            None
        }
    }
}
