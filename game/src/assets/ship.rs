//! A ship from `ships/<key>.toml`. Each table is read on its own, so that one fault does not hide those of the others; ranges are
//! [`ShipSpec::faults`]'s.

use super::fault::{AssetErrors, At, Fault, nearest};
use super::overlay::{Overlay, named, read_text};
use super::reader::{Faults, Reader};
use super::tree::{Data, Node, parse};
use crate::world::ship::spec::ShipSpec;
use serde::de::DeserializeOwned;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

/// Loads `ships/<key>.toml`, that of the last mod that has it.
pub fn load_ship(overlay: &Overlay, key: &str) -> Result<Arc<ShipSpec>, AssetErrors> {
    let path = named(overlay, "ships", key)?;
    let source = read_text(&path).map_err(AssetErrors::one)?;
    let node = parse(&source).map_err(|faults| AssetErrors { faults })?;
    let faults = Faults::default();
    let table = DeTable::parse(&source.text).map_err(|e| AssetErrors::one(Fault::at(&node.at, e.to_string())))?;
    let spec = read(&node, table.get_ref(), key, &faults);
    let mut found = faults.into_inner();
    if let Some(spec) = spec.filter(|_| found.is_empty()) {
        found.extend(spec.faults().into_iter().map(|(key, what)| Fault::at(&node.place_of(key), format!("`{key}`: {what}"))));
        if found.is_empty() {
            return Ok(Arc::new(spec));
        }
    }
    Err(AssetErrors { faults: found })
}

fn read(node: &Node, table: &DeTable<'_>, key: &str, faults: &Faults) -> Option<ShipSpec> {
    let r = Reader::new(node, faults);
    let written = r.text("key");
    if !written.is_empty() && written != key {
        r.wrong("key", format!("`key` = \"{written}\": expected the file's name, \"{key}\""));
    }
    let (name, description) = (r.text("name"), r.text("description"));
    let mut parts = Parts { r: &r, table, faults };
    let mass = parts.part("mass");
    let main_engine = parts.part("main_engine");
    let rcs = parts.part("rcs");
    let attitude = parts.part("attitude");
    let aero = parts.part("aero");
    let hull = parts.part("hull");
    let gear = parts.part("gear");
    let limits = parts.part("limits");
    let sunlight = r.maybe_table("sunlight").and_then(|_| parts.part("sunlight"));
    r.finish();
    Some(ShipSpec {
        key: written,
        name,
        description,
        mass: mass?,
        main_engine: main_engine?,
        rcs: rcs?,
        attitude: attitude?,
        aero: aero?,
        hull: hull?,
        gear: gear?,
        limits: limits?,
        sunlight,
    })
}

struct Parts<'a> {
    r: &'a Reader<'a>,
    table: &'a DeTable<'a>,
    faults: &'a Faults,
}

impl Parts<'_> {
    /// One table through serde, with the fault that it found.
    fn part<T: DeserializeOwned>(&mut self, key: &'static str) -> Option<T> {
        let inside = self.r.table(key)?;
        let value: Spanned<DeValue<'_>> = self.table.get(key)?.clone();
        let error = match T::deserialize(ValueDeserializer::from(value)) {
            Ok(part) => return Some(part),
            Err(error) => error,
        };
        let words = error.message().to_owned();
        let named: Vec<&str> = words.split('`').skip(1).step_by(2).collect();
        let unknown = words.starts_with("unknown field");
        let (at, help) = match (unknown, named.split_first()) {
            (true, Some((field, known))) => (inside.node.place_of(field), nearest(field, known.iter().copied())),
            _ => {
                let source = &inside.node.at.source;
                let span = error.span().filter(|s| !s.is_empty());
                (span.map_or(inside.node.at.clone(), |s| At { source: source.clone(), start: s.start, end: s.end }), None)
            }
        };
        // serde ends with the list of known names, which the help says better.
        let words = if unknown { words.split(", expected").next().unwrap_or("") } else { &words };
        let message = match &inside.node.data {
            Data::Table(_) if unknown => format!("{words} in [{key}]: expected a key of the schema"),
            _ if words.contains("expected") => format!("[{key}]: {words}"),
            _ => format!("[{key}]: {words}: expected it here"),
        };
        self.faults.borrow_mut().push(Fault::at(&at, message).help(help));
        None
    }
}
