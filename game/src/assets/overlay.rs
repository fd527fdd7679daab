//! The overlay: the assets folder with mods laid over it, addressed by relative path. A later mod wins; a file `x.patch.toml` in a
//! mod changes single keys of `x.toml` below it. Also the only place that reads asset files: size, encoding and absence are checked here.

use super::fault::{AssetErrors, Fault, Source, nearest};
use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest text file, bytes.
pub const TEXT_MAX: u64 = 1 << 20;
/// Largest map or picture, bytes.
pub const DATA_MAX: u64 = 1 << 28;

/// Folders inside each other in which a mod's files are looked for.
const DEEPEST: usize = 6;
/// Files of a body.
pub const OF_BODY: [&str; 4] = ["body.toml", "body.patch.toml", "atmosphere.toml", "atmosphere.patch.toml"];
/// Files of a system.
pub const OF_SYSTEM: [&str; 2] = ["system.toml", "system.patch.toml"];

/// Whether a loader reads a TOML file at this relative path.
fn is_read(relative: &Path) -> bool {
    let parts: Vec<&str> = relative.iter().filter_map(|part| part.to_str()).collect();
    match parts.as_slice() {
        ["bodies", _, file] => OF_BODY.contains(file),
        ["systems", _, file] => OF_SYSTEM.contains(file),
        ["ships" | "starts", file] => !file.ends_with(".patch.toml"),
        _ => false,
    }
}

/// Roots in order: the assets, then the mods.
#[derive(Clone, Debug)]
pub struct Overlay {
    roots: Vec<PathBuf>,
}

impl Overlay {
    /// Lays `mods` over `assets`, the last on top.
    pub fn new(assets: &Path, mods: &[PathBuf]) -> Self {
        Self { roots: std::iter::once(assets.to_owned()).chain(mods.iter().cloned()).collect() }
    }

    /// The roots, the assets first.
    pub fn roots(&self) -> &[PathBuf] {
        &self.roots
    }

    /// The file in force at a relative path.
    pub fn find(&self, relative: impl AsRef<Path>) -> Option<PathBuf> {
        self.roots.iter().rev().map(|r| r.join(relative.as_ref())).find(|p| p.is_file())
    }

    /// Where the file of the assets themselves would lie, for messages.
    pub fn expected(&self, relative: &str) -> PathBuf {
        self.roots.first().map_or_else(|| PathBuf::from(relative), |r| r.join(relative))
    }

    /// The file in force and the patches that lie above it, in order.
    pub fn with_patches(&self, relative: &str) -> Vec<PathBuf> {
        let patch = relative.strip_suffix(".toml").map(|stem| format!("{stem}.patch.toml"));
        let base = self.roots.iter().rposition(|r| r.join(relative).is_file());
        let Some(base) = base else { return Vec::new() };
        let mut files = vec![self.roots[base].join(relative)];
        if let Some(patch) = patch {
            files.extend(self.roots[base..].iter().map(|r| r.join(&patch)).filter(|p| p.is_file()));
        }
        files
    }

    /// Patches that lie above no file: there is nothing there that they could change.
    pub fn orphans(&self, relative: &str) -> Vec<PathBuf> {
        let Some(stem) = relative.strip_suffix(".toml") else { return Vec::new() };
        let base = self.roots.iter().position(|r| r.join(relative).is_file()).unwrap_or(self.roots.len());
        self.roots[..base].iter().map(|r| r.join(format!("{stem}.patch.toml"))).filter(|p| p.is_file()).collect()
    }

    /// Files in the mods that no loader reads, by their relative paths: TOML under another name or in another folder than the assets have.
    pub fn strays(&self) -> Vec<(PathBuf, PathBuf)> {
        let mut found = Vec::new();
        for root in self.roots.iter().skip(1) {
            let mut open = vec![PathBuf::new()];
            while let Some(folder) = open.pop() {
                for entry in fs::read_dir(root.join(&folder)).into_iter().flatten().flatten() {
                    let (path, relative) = (entry.path(), folder.join(entry.file_name()));
                    let hidden = entry.file_name().to_string_lossy().starts_with('.');
                    if path.is_dir() && !hidden && relative.components().count() < DEEPEST {
                        open.push(relative);
                    } else if path.is_file() && !hidden && path.extension().is_some_and(|e| e == "toml") && !is_read(&relative) {
                        found.push((path, relative));
                    }
                }
            }
        }
        found.sort();
        found
    }

    /// Names in a folder over all roots, sorted: of folders, or of files with an ending (without it; patches left out).
    pub fn names(&self, relative: &str, ending: Option<&str>) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        for root in &self.roots {
            let Ok(entries) = fs::read_dir(root.join(relative)) else { continue };
            for entry in entries.flatten() {
                let Ok(name) = entry.file_name().into_string() else { continue };
                let is_dir = entry.path().is_dir();
                match ending {
                    None if is_dir => drop(names.insert(name)),
                    Some(ending) if !is_dir && !name.ends_with(".patch.toml") => {
                        if let Some(stem) = name.strip_suffix(ending) {
                            names.insert(stem.to_owned());
                        }
                    }
                    _ => {}
                }
            }
        }
        names
    }
}

/// The file `<folder>/<key>.toml` in force; else a fault with the nearest name.
pub fn named(overlay: &Overlay, folder: &str, key: &str) -> Result<PathBuf, AssetErrors> {
    let relative = format!("{folder}/{key}.toml");
    overlay.find(&relative).ok_or_else(|| {
        let known = overlay.names(folder, Some(".toml"));
        let fault = Fault::file(&overlay.expected(&relative), format!("there is no `{key}` in {folder}: expected its file here"));
        AssetErrors::one(fault.help(nearest(key, known.iter().map(String::as_str))))
    })
}

/// Reads a file of at most `max` bytes.
pub fn read_bytes(path: &Path, max: u64) -> Result<Vec<u8>, Fault> {
    let cannot = |e: std::io::Error| Fault::file(path, format!("cannot be read: {e}; expected a readable file"));
    let file = fs::File::open(path).map_err(cannot)?;
    let mut bytes = Vec::new();
    file.take(max + 1).read_to_end(&mut bytes).map_err(cannot)?;
    if bytes.len() as u64 > max {
        return Err(Fault::file(path, format!("the file is too large: expected at most {} KiB", max >> 10)));
    }
    Ok(bytes)
}

/// Reads a UTF-8 text file.
pub fn read_text(path: &Path) -> Result<Arc<Source>, Fault> {
    let bytes = read_bytes(path, TEXT_MAX)?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let offset = e.utf8_error().valid_up_to();
        let line = e.as_bytes()[..offset].iter().filter(|b| **b == b'\n').count() + 1;
        Fault::file(path, format!("line {line}: byte {offset} is not UTF-8: expected a UTF-8 text file"))
            .help(Some("save the file as UTF-8 in your editor".to_owned()))
    })?;
    let lone = text.match_indices('\r').map(|(i, _)| i).find(|i| text.as_bytes().get(i + 1) != Some(&b'\n'));
    if let Some(at) = lone {
        let line = text[..at].matches('\n').count() + 1;
        return Err(Fault::file(path, format!("line {line}: it ends in a carriage return alone: expected line ends LF or CR LF"))
            .help(Some("choose the line ends of Unix or Windows in your editor".to_owned())));
    }
    Ok(Arc::new(Source { path: path.to_owned(), text }))
}
