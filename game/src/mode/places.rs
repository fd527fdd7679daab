//! Where things are: the assets folder, and the folder that the player may write in.
//!
//! Nothing is ever written beside the program unless it runs from a checkout, so that no rights are needed.

use crate::cli::Places;
use std::path::{Path, PathBuf};

/// A folder that cannot be found.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PlaceError {
    /// No assets.
    #[error("the assets folder was not found; looked for `systems` in:\n{}", looked.iter().map(|p| format!("  {}", p.display())).collect::<Vec<_>>().join("\n"))]
    #[diagnostic(code(places::assets), help("name it with --assets DIR, or set SYZYGY_ASSETS"))]
    Assets {
        /// Where it was looked for.
        looked: Vec<PathBuf>,
    },
    /// A folder that was named is none.
    #[error("{}: expected a folder for {what}, found {}", path.display(), if path.exists() { "a file" } else { "nothing" })]
    #[diagnostic(code(places::folder))]
    NoFolder {
        /// What was named.
        path: PathBuf,
        /// What for.
        what: &'static str,
    },
}

/// The assets folder: `--assets`, else `$SYZYGY_ASSETS`, else beside the program, else in the checkout it was built in.
///
/// # Errors
/// [`PlaceError::Assets`], saying where it was looked for; one that was named is taken or refused, never passed over.
pub fn assets(places: &Places) -> Result<PathBuf, PlaceError> {
    let named = places.assets.clone().or_else(|| std::env::var_os("SYZYGY_ASSETS").filter(|v| !v.is_empty()).map(PathBuf::from));
    let looked = named.map_or_else(usual_assets, |dir| vec![dir]);
    looked.iter().find(|dir| dir.join("systems").is_dir()).cloned().ok_or(PlaceError::Assets { looked })
}

fn usual_assets() -> Vec<PathBuf> {
    let mut looked = Vec::new();
    if let Some(beside) = std::env::current_exe().ok().as_deref().and_then(Path::parent) {
        looked.push(beside.join("assets"));
        looked.push(beside.join("../share/syzygy/assets"));
    }
    looked.extend(checkout().map(|c| c.join("assets")));
    looked.extend(std::env::current_dir().ok().map(|d| d.join("assets")));
    looked
}

/// The name of the mod that the editor in the game writes where no other is named.
pub const EDITED: &str = "edited";

/// The mods to overlay, the last on top; none in safe mode. First the folders in `mods/` of the data folder, by name, the editor's own
/// (`edited`, there or not yet) last of them; then those that the command line names, as it names them, each checked to be a folder.
///
/// # Errors
/// [`PlaceError::NoFolder`].
pub fn mods(places: &Places) -> Result<Vec<PathBuf>, PlaceError> {
    if places.safe_mode {
        return Ok(Vec::new());
    }
    if let Some(path) = places.mods.iter().find(|m| !m.is_dir()) {
        return Err(PlaceError::NoFolder { path: path.clone(), what: "--mods" });
    }
    let folder = data_dir(places).join("mods");
    let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
    let mut mods: Vec<PathBuf> = entries.map(|e| e.path()).filter(|p| p.is_dir() && !p.ends_with(EDITED)).collect();
    mods.sort();
    mods.push(folder.join(EDITED));
    mods.extend(places.mods.iter().cloned());
    Ok(mods)
}

/// The folder for saves and settings: `--data-dir`, else `$SYZYGY_DATA_DIR`, else `saves/` of the checkout the program was
/// built in, else the user's data folder.
pub fn data_dir(places: &Places) -> PathBuf {
    let named = places.data_dir.clone().or_else(|| std::env::var_os("SYZYGY_DATA_DIR").filter(|v| !v.is_empty()).map(PathBuf::from));
    named
        .or_else(|| checkout().map(|c| c.join("saves")).filter(|d| d.is_dir()))
        .or_else(|| directories::ProjectDirs::from("", "", "syzygy").map(|d| d.data_dir().to_owned()))
        .unwrap_or_else(|| PathBuf::from("saves"))
}

/// The folder for what can be made again: beside the saves where their folder was named, else the user's cache folder.
pub fn cache_dir(places: &Places) -> Option<PathBuf> {
    let named = places.data_dir.is_some() || std::env::var_os("SYZYGY_DATA_DIR").is_some_and(|v| !v.is_empty());
    if named {
        return Some(data_dir(places).join("cache"));
    }
    directories::ProjectDirs::from("", "", "syzygy").map(|d| d.cache_dir().to_owned())
}

/// The checkout that this program was built in, where it still stands.
fn checkout() -> Option<PathBuf> {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().filter(|root| root.join("game/Cargo.toml").is_file()).map(Path::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_named_assets_folder_is_not_passed_over() {
        let dir = tempfile::tempdir().unwrap();
        let places = Places { assets: Some(dir.path().to_owned()), ..Places::default() };
        let e = assets(&places).unwrap_err().to_string();
        assert!(e.contains(&dir.path().display().to_string()) && e.contains("systems"), "{e}");
        std::fs::create_dir(dir.path().join("systems")).unwrap();
        assert_eq!(assets(&places).unwrap(), dir.path());
    }

    #[test]
    fn a_named_folder_of_saves_holds_the_cache_too() {
        let places = Places { data_dir: Some("here".into()), ..Places::default() };
        assert_eq!(cache_dir(&places).unwrap(), Path::new("here").join("cache"));
    }

    #[test]
    fn safe_mode_leaves_mods_out_and_a_missing_mod_is_named() {
        let mut places = Places { mods: vec!["no/such/mod".into()], ..Places::default() };
        assert!(mods(&places).unwrap_err().to_string().contains("no/such/mod"));
        places.mods.clear();
        let data = tempfile::tempdir().unwrap();
        for name in ["b", "edited", "a"] {
            std::fs::create_dir_all(data.path().join("mods").join(name)).unwrap();
        }
        places.data_dir = Some(data.path().to_owned());
        places.mods = vec![data.path().to_owned()];
        let found = mods(&places).unwrap();
        let expected = ["mods/a", "mods/b", "mods/edited", ""].map(|m| data.path().join(m));
        assert_eq!(found, expected);
        places.safe_mode = true;
        assert!(mods(&places).unwrap().is_empty());
    }
}
