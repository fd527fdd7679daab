//! `syzygy check-assets [DIR]`: reads every asset of a folder and tells everything that is wrong with it, at once.
//!
//! DIR may be an assets folder, a mod (checked as it would lie over the assets in use), a system or a body of either.

use super::{Error, places};
use crate::assets::{AssetErrors, Assets};
use crate::cli::CheckAssetsArgs;
use std::path::{Path, PathBuf};

/// What an assets folder has, and a mod seldom has all of.
const WHOLE: [&str; 4] = ["systems", "bodies", "ships", "starts"];

/// Checks what the command line names; one line on what was found good.
///
/// # Errors
/// A folder that is none, or all faults.
pub fn run(args: &CheckAssetsArgs) -> Result<String, Error> {
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
fn check(assets: &Assets, part: &Part) -> Result<String, AssetErrors> {
    match part {
        Part::Body(key) => {
            let systems = assets.check_body(key)?;
            Ok(format!("all sound: body {key}, listed by {}", if systems.is_empty() { "no system".to_owned() } else { systems.join(", ") }))
        }
        Part::System(key) => {
            let system = assets.system(key, &|_, _| ())?;
            Ok(format!("all sound: system {key} with {} bodies", system.bodies.len()))
        }
        Part::All => {
            assets.check()?;
            let (systems, bodies, ships, starts) =
                (assets.systems().len(), assets.bodies().len(), assets.ships().len(), assets.starts().len());
            Ok(format!("all sound: {systems} systems, {bodies} bodies, {ships} ships, {starts} starts"))
        }
    }
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
