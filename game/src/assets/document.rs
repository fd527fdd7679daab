//! A document: one TOML file, read with distrust, found through the overlay of mods, with a place for every key.
//!
//! Overlay: the folders of the mods lie over the assets by relative path, the last one on top. A file of the same name
//! *replaces*; `NAME.patch.toml` beside it *modifies* (only the keys given; tables merge, everything else is replaced), patches
//! in the order of the mods; a new file *adds*.

use super::fault::{AssetErrors, Fault, did_you_mean};
use serde::de::DeserializeOwned;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// Largest text file that is read, bytes.
const TEXT_MAX: u64 = 1 << 20;
/// Largest map file that is read, bytes.
const BINARY_MAX: u64 = 256 << 20;

/// Assets and the mods over them.
#[derive(Clone, Debug)]
pub struct Overlay {
    /// The assets first, then mods in their order.
    pub roots: Vec<PathBuf>,
}

impl Overlay {
    /// The file that counts: that of the last root that has it.
    pub fn find(&self, relative: &Path) -> Option<PathBuf> {
        self.roots.iter().rev().map(|root| root.join(relative)).find(|p| p.is_file())
    }

    /// The patches of a file, in order.
    pub fn patches(&self, relative: &Path) -> Vec<PathBuf> {
        let name = relative.file_stem().map(|s| format!("{}.patch.toml", s.to_string_lossy())).unwrap_or_default();
        let patch = relative.with_file_name(name);
        self.roots.iter().map(|root| root.join(&patch)).filter(|p| p.is_file()).collect()
    }

    /// Names of the entries of a folder, over all roots, sorted, once each.
    pub fn entries(&self, relative: &Path) -> Vec<String> {
        let mut names: Vec<String> = self
            .roots
            .iter()
            .filter_map(|root| fs::read_dir(root.join(relative)).ok())
            .flat_map(|dir| dir.flatten().map(|e| e.file_name().to_string_lossy().into_owned()))
            .collect();
        names.sort();
        names.dedup();
        names
    }

    /// Reads a binary file.
    pub fn binary(&self, relative: &Path) -> Result<(PathBuf, Vec<u8>), AssetErrors> {
        let path = self.find(relative).ok_or_else(|| AssetErrors::one(self.missing(relative)))?;
        let bytes = read(&path, BINARY_MAX).map_err(AssetErrors::one)?;
        Ok((path, bytes))
    }

    fn missing(&self, relative: &Path) -> Fault {
        let path = self.roots.first().map_or_else(|| relative.to_owned(), |root| root.join(relative));
        let folder = relative.parent().unwrap_or(Path::new(""));
        let name = relative.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let near = self.entries(folder);
        let fault = Fault::of_file(&path, "the file is missing");
        match did_you_mean(&name, near.iter().map(String::as_str)) {
            Some(other) => fault.help(format!("did you mean `{other}`, which is there?")),
            None => fault.help(format!("looked in {}", self.roots.iter().map(|r| r.display().to_string()).collect::<Vec<_>>().join(", "))),
        }
    }
}

fn read(path: &Path, max: u64) -> Result<Vec<u8>, Fault> {
    let cannot = |e: std::io::Error| Fault::of_file(path, format!("cannot be read: {e}"));
    let size = fs::metadata(path).map_err(cannot)?.len();
    if size > max {
        return Err(Fault::of_file(path, format!("{size} bytes are too many: at most {max} are read")));
    }
    fs::read(path).map_err(cannot)
}

/// One TOML file (with its patches merged in).
#[derive(Clone, Debug)]
pub struct Document {
    /// Where it is.
    pub path: PathBuf,
    /// Its text; that of the merged document where there are patches.
    pub text: String,
}

impl Document {
    /// Reads a file through the overlay.
    pub fn open(overlay: &Overlay, relative: &Path) -> Result<Self, AssetErrors> {
        let path = overlay.find(relative).ok_or_else(|| AssetErrors::one(overlay.missing(relative)))?;
        let mut document = Self::read(&path)?;
        for patch_path in overlay.patches(relative) {
            let patch = Self::read(&patch_path)?;
            let mut base: toml::Table = document.parse()?;
            merge(&mut base, patch.parse()?);
            let text = toml::to_string(&base).map_err(|e| AssetErrors::one(Fault::of_file(&patch_path, e.to_string())))?;
            // Faults of the merged text are the patch's to answer for.
            document = Self { path: patch_path, text };
        }
        Ok(document)
    }

    /// Reads one file.
    pub fn read(path: &Path) -> Result<Self, AssetErrors> {
        let bytes = read(path, TEXT_MAX).map_err(AssetErrors::one)?;
        let text = String::from_utf8(bytes).map_err(|e| {
            let at = e.utf8_error().valid_up_to();
            AssetErrors::one(Fault::of_file(path, format!("not UTF-8 text: byte {at} is none of it")))
        })?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// The document as a typed value; unknown and missing keys, wrong types and bad syntax are faults with their place.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, AssetErrors> {
        let (_, syntax) = DeTable::parse_recoverable(&self.text);
        if !syntax.is_empty() {
            return Err(AssetErrors { faults: syntax.iter().map(|e| self.fault(e.span(), e.message())).collect() });
        }
        toml::from_str(&self.text).map_err(|e| AssetErrors::one(self.typed_fault(&e)))
    }

    /// A fault at the value of a key, `rotation.pole_ra_deg[1]`; at its table, or the file, where the key is not there.
    pub fn fault_at(&self, key: &str, message: impl Into<String>) -> Fault {
        self.fault(self.span(key), message)
    }

    /// A fault at a span.
    pub fn fault(&self, span: Option<Range<usize>>, message: impl Into<String>) -> Fault {
        Fault::at(&self.path, &self.text, span, message)
    }

    fn typed_fault(&self, e: &toml::de::Error) -> Fault {
        let fault = self.fault(e.span(), e.message().trim());
        // serde says: unknown field `x`, expected one of `a`, `b`.
        let mut quoted = e.message().split('`').skip(1).step_by(2);
        match (e.message().starts_with("unknown"), quoted.next()) {
            (true, Some(wrong)) => match did_you_mean(wrong, quoted) {
                Some(near) => fault.help(format!("did you mean `{near}`?")),
                None => fault.help("take the key away, or see the shipped files for the keys there are"),
            },
            _ => fault,
        }
    }

    /// Where the value of a key stands in the text.
    fn span(&self, key: &str) -> Option<Range<usize>> {
        let root = DeTable::parse(&self.text).ok()?;
        let mut here: Option<Range<usize>> = None;
        let mut value: Option<&DeValue<'_>> = None;
        for step in key.split(['.', '[']).map(|s| s.trim_end_matches(']')).filter(|s| !s.is_empty()) {
            let next = match (value, step.parse::<usize>()) {
                (None, _) => root.get_ref().get(step),
                (Some(v), Ok(index)) => v.get(index),
                (Some(v), Err(_)) => v.get(step),
            };
            let Some(next) = next else { break };
            here = Some(next.span());
            value = Some(next.get_ref());
        }
        here
    }
}

/// Tables merge, everything else is replaced.
fn merge(base: &mut toml::Table, patch: toml::Table) {
    for (key, value) in patch {
        match (base.get_mut(&key), value) {
            (Some(toml::Value::Table(below)), toml::Value::Table(over)) => merge(below, over),
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_found_in_the_text() {
        let text = "a = 1\n[t]\nb = [1.0, 2.0]\n[[t.layers]]\nc = { d = 7 }\n".to_owned();
        let doc = Document { path: "x.toml".into(), text };
        let line = |key: &str| doc.fault_at(key, "").line;
        assert_eq!(line("a"), Some((1, 5)));
        assert_eq!(line("t.b[1]"), Some((3, 11)));
        assert_eq!(line("t.layers[0].c.d"), Some((5, 11)));
        assert_eq!(line("nowhere"), None);
    }

    #[test]
    fn patches_change_only_the_keys_given() {
        let dir = tempfile::tempdir().unwrap();
        let (base, modded) = (dir.path().join("base"), dir.path().join("mod"));
        fs::create_dir_all(&base).unwrap();
        fs::create_dir_all(&modded).unwrap();
        fs::write(base.join("body.toml"), "a = 1\n[t]\nb = 2\nc = 3\n").unwrap();
        fs::write(modded.join("body.patch.toml"), "[t]\nb = 9\n").unwrap();
        let overlay = Overlay { roots: vec![base, modded] };
        let table: toml::Table = Document::open(&overlay, Path::new("body.toml")).unwrap().parse().unwrap();
        assert_eq!(table.to_string(), "a = 1\n\n[t]\nb = 9\nc = 3\n");
    }
}
