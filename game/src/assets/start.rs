//! A start from `starts/<key>.toml`: where and when a flight begins, as plain data ([`StartSpec`]).
//!
//! Not here: whether the named body exists ([`crate::world::start`] asks the system).

use super::fault::AssetErrors;
use super::overlay::{Overlay, named, read_text};
use super::reader::{ANY, Faults, Reader};
use super::tree::{Node, parse};
use crate::world::start::{Place, StartSpec, TargetSpec};
use engine::time::CivilTime;
use std::path::{Path, PathBuf};

/// Loads `starts/<key>.toml`, that of the last mod that has it; or the file itself, where `key` is the path of a `.toml`.
pub fn load_start(overlay: &Overlay, key: &str) -> Result<StartSpec, AssetErrors> {
    let path = file_of(overlay, key)?;
    let stem = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    read_start(&path, &stem)
}

/// The file of a start, for messages about what its words come to.
pub fn start_tree(overlay: &Overlay, key: &str) -> Result<Node, AssetErrors> {
    let source = read_text(&file_of(overlay, key)?).map_err(AssetErrors::one)?;
    parse(&source).map_err(|faults| AssetErrors { faults })
}

fn file_of(overlay: &Overlay, key: &str) -> Result<PathBuf, AssetErrors> {
    if key.ends_with(".toml") { Ok(PathBuf::from(key)) } else { named(overlay, "starts", key) }
}

fn read_start(path: &Path, key: &str) -> Result<StartSpec, AssetErrors> {
    let source = read_text(path).map_err(AssetErrors::one)?;
    let node = parse(&source).map_err(|faults| AssetErrors { faults })?;
    let faults = Faults::default();
    let spec = read(key, Reader::new(&node, &faults));
    let found = faults.into_inner();
    AssetErrors { faults: found }.or(spec)
}

fn read(key: &str, r: Reader<'_>) -> StartSpec {
    let written = r.text("key");
    if !written.is_empty() && written != key {
        r.wrong("key", format!("`key` = \"{written}\": expected the file's name, \"{key}\""));
    }
    let utc = r.text("utc");
    if let Err(what) = CivilTime::parse(&utc)
        && !utc.is_empty()
    {
        r.wrong("utc", format!("`utc`: {what}"));
    }
    let spec = StartSpec {
        key: written,
        name: r.text("name"),
        description: r.text("description"),
        system: r.text("system"),
        ship: r.text("ship"),
        utc,
        place: r.table("place").map_or_else(nowhere, read_place),
        target: r.maybe_table("target").map(read_target),
    };
    r.finish();
    spec
}

fn nowhere() -> Place {
    Place::Ground { body: String::new(), lat_deg: 0.0, lon_deg: 0.0, heading_deg: 0.0 }
}

fn read_place(r: Reader<'_>) -> Place {
    let kind = r.choice("kind", &["orbit", "air", "ground"]);
    let body = r.text("body");
    let lat_deg = r.number("lat_deg", -90.0..=90.0);
    let lon_deg = r.number("lon_deg", -360.0..=360.0);
    let heading_deg = r.number("heading_deg", -360.0..=360.0);
    let place = match kind {
        "orbit" => Place::Orbit { body, altitude_m: r.number("altitude_m", 0.0..=1e13), lat_deg, lon_deg, heading_deg },
        "air" => Place::Air {
            body,
            altitude_m: r.number("altitude_m", -2e4..=1e13),
            lat_deg,
            lon_deg,
            heading_deg,
            speed_m_s: r.number("speed_m_s", -1e5..=1e5),
            climb_m_s: r.number("climb_m_s", -1e5..=1e5),
        },
        _ => Place::Ground { body, lat_deg, lon_deg, heading_deg },
    };
    r.finish();
    place
}

fn read_target(r: Reader<'_>) -> TargetSpec {
    let target =
        TargetSpec { body: r.text("body"), lat_deg: r.maybe_number("lat_deg", -90.0..=90.0), lon_deg: r.maybe_number("lon_deg", ANY) };
    if target.lat_deg.is_some() != target.lon_deg.is_some() {
        r.wrong("", "[target]: expected `lat_deg` and `lon_deg` together, or neither");
    }
    r.finish();
    target
}
