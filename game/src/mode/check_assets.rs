//! `syzygy check-assets [DIR]`: reads every asset of a folder and tells everything that is wrong with it, at once.
//!
//! DIR may be an assets folder, a mod (checked as it would lie over the assets in use), a system or a body of either. What can be used and
//! is hardly meant is a warning: it goes to stderr, and the exit code stays 0. `--schema KIND` prints a JSON Schema for editors instead.

use super::{Error, places};
use crate::assets::atmosphere::keys::{self, ATMOSPHERE};
use crate::assets::{AssetErrors, Assets, schema};
use crate::cli::{CheckAssetsArgs, SchemaKind};
use std::path::{Path, PathBuf};

/// What an assets folder has, and a mod seldom has all of.
const WHOLE: [&str; 4] = ["systems", "bodies", "ships", "starts"];

/// What came of a check without faults.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sound {
    /// One line on what was found good.
    pub line: String,
    /// What can be used and is hardly meant.
    pub warnings: Vec<String>,
}

/// Checks what the command line names.
///
/// # Errors
/// A folder that is none, or all faults.
pub fn run(args: &CheckAssetsArgs) -> Result<Sound, Error> {
    let mods = places::mods(&args.places)?;
    let dir = match &args.dir {
        Some(dir) if !dir.is_dir() => return Err(places::PlaceError::NoFolder { path: dir.clone(), what: "check-assets" }.into()),
        dir => dir.as_ref().map(|d| d.canonicalize().unwrap_or_else(|_| d.clone())),
    };
    let Some((root, part)) = dir.map(|d| root_of(&d)) else {
        return Ok(check(&Assets::new(places::assets(&args.places)?, mods), &Part::All)?);
    };
    if WHOLE.iter().all(|folder| root.join(folder).is_dir()) {
        return Ok(check(&Assets::new(root, mods), &part)?);
    }
    let assets = Assets::new(places::assets(&args.places)?, mods.into_iter().chain(std::iter::once(root)).collect());
    Ok(check(&assets, &part)?)
}

/// What a folder is: a body or a system in an assets or mod folder, or such a folder itself.
#[derive(Debug, PartialEq, Eq)]
enum Part {
    Body(String),
    System(String),
    All,
}

/// Checks a part.
fn check(assets: &Assets, part: &Part) -> Result<Sound, AssetErrors> {
    let (what, warnings) = match part {
        Part::Body(key) => {
            let (systems, warnings) = assets.check_body(key)?;
            let by = if systems.is_empty() { "no system".to_owned() } else { systems.join(", ") };
            (format!("body {key}, listed by {by}"), warnings)
        }
        Part::System(key) => {
            let system = assets.system(key, &|_, _| ())?;
            (format!("system {key} with {} bodies", system.bodies.len()), system.warnings.clone())
        }
        Part::All => {
            let warnings = assets.check()?;
            let (systems, bodies, ships, starts) =
                (assets.systems().len(), assets.bodies().len(), assets.ships().len(), assets.starts().len());
            (format!("{systems} systems, {bodies} bodies, {ships} ships, {starts} starts"), warnings)
        }
    };
    let line = match warnings.len() {
        0 => format!("all sound: {what}"),
        1 => format!("sound, with a warning: {what}"),
        n => format!("sound, with {n} warnings: {what}"),
    };
    Ok(Sound { line, warnings })
}

/// The schema of a kind of file, as JSON text.
pub fn schema(kind: SchemaKind) -> String {
    let schema = match kind {
        SchemaKind::Atmosphere => {
            let rules = schema::Rules { chosen_by: "model", needed: keys::NEEDED, ways: keys::WAYS };
            schema::of_file("Syzygy: atmosphere.toml", ATMOSPHERE, rules)
        }
        SchemaKind::AtmospherePatch => schema::of_patch("Syzygy: atmosphere.patch.toml", ATMOSPHERE),
    };
    format!("{schema:#}\n")
}

/// The assets or mod folder that a folder belongs to (`ROOT/systems/<system>`, `ROOT/bodies/<body>`), and what of it it is.
fn root_of(dir: &Path) -> (PathBuf, Part) {
    let name = dir.file_name().map(|n| n.to_string_lossy().into_owned());
    let folder = dir.parent();
    let root = folder.and_then(Path::parent);
    match (root, folder.and_then(Path::file_name).and_then(|n| n.to_str()), name) {
        (Some(root), Some("systems"), Some(name)) => (root.to_owned(), Part::System(name)),
        (Some(root), Some("bodies"), Some(name)) => (root.to_owned(), Part::Body(name)),
        _ => (dir.to_owned(), Part::All),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_schemas_are_those_of_the_reader() {
        for (kind, name) in [(SchemaKind::Atmosphere, "atmosphere"), (SchemaKind::AtmospherePatch, "atmosphere.patch")] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../assets/{name}.schema.json"));
            let shipped = std::fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
            let command = format!("syzygy check-assets --schema {name} > assets/{name}.schema.json");
            assert!(shipped == schema(kind), "{} is not as the reader is: {command}", path.display());
        }
    }
}
