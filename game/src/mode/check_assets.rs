//! `syzygy check-assets [DIR]`: reads every asset of a folder and tells everything that is wrong with it, at once.
//!
//! DIR may be an assets folder, a mod (checked as it would lie over the assets in use), a system or a body.

use super::{Error, places};
use crate::assets::{AssetErrors, Assets};
use crate::cli::CheckAssetsArgs;
use std::path::{Path, PathBuf};

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
    let Some((root, system)) = dir.map(|d| root_of(&d)) else {
        return Ok(check(&Assets::new(places::assets(&args.places)?, mods), None)?);
    };
    let own = Assets::new(root.clone(), Vec::new());
    let complete = !own.systems().is_empty() && system.as_ref().is_none_or(|s| own.systems().contains(s));
    let assets =
        if complete { own } else { Assets::new(places::assets(&args.places)?, mods.into_iter().chain(std::iter::once(root)).collect()) };
    Ok(check(&assets, system.as_deref())?)
}

/// Checks one system, or everything.
pub fn check(assets: &Assets, system: Option<&str>) -> Result<String, AssetErrors> {
    if let Some(key) = system {
        let system = assets.system(key, &|_, _| ())?;
        return Ok(format!("all sound: system {key} with {} bodies", system.bodies.len()));
    }
    assets.check()?;
    let (systems, ships, starts) = (assets.systems().len(), assets.ships().len(), assets.starts().len());
    Ok(format!("all sound: {systems} systems, {ships} ships, {starts} starts"))
}

/// The assets or mod folder that a folder belongs to, and the system when it is one or a body of one:
/// `ROOT/systems/<system>[/<body>]`.
fn root_of(dir: &Path) -> (PathBuf, Option<String>) {
    let is_body = dir.join("body.toml").is_file() || dir.join("body.patch.toml").is_file();
    let folder = if is_body { dir.parent().unwrap_or(dir) } else { dir };
    let systems = folder.parent().filter(|p| p.file_name().is_some_and(|n| n == "systems"));
    match (systems.and_then(Path::parent), folder.file_name()) {
        (Some(root), Some(name)) => (root.to_owned(), Some(name.to_string_lossy().into_owned())),
        _ => (dir.to_owned(), None),
    }
}
