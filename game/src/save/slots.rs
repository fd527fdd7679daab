//! The folder of saves: a ring of three quick ones, a ring of five automatic ones, named ones; the list; falling back.
//!
//! The newest of a ring is the one with the largest sequence number in its header; wall-clock may jump, that number may not.
//! A damaged file is never overwritten before its `.bak` has been tried, a newer program's file is never touched at all.

use super::format::{self, Header, SAVE};
use super::{SaveError, file};
use std::fs;
use std::path::{Path, PathBuf};

/// Ending of a save's file name.
pub const ENDING: &str = "syzsave";
/// Places in the quick ring.
pub const QUICK_RING: u32 = 3;
/// Places in the automatic ring.
pub const AUTO_RING: u32 = 5;

/// Turns a payload into a state, or says everything that is wrong with it.
pub type Decode<'a, T> = &'a dyn Fn(&[u8]) -> Result<T, Vec<String>>;

/// Why a save was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The player pressed the quick key.
    Quick,
    /// The program did it.
    Auto,
    /// The player gave it a name.
    Named(String),
}

/// What a save holds beside its payload, as the writer knows it; the folder adds date and sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Simulated time.
    pub time: engine::time::SimTime,
    /// Key of the dominating body.
    pub body: String,
    /// Altitude above the datum, m.
    pub altitude_m: f64,
}

/// A line of the list.
#[derive(Debug)]
pub struct Entry {
    /// The file.
    pub path: PathBuf,
    /// Why it was made, by its name.
    pub kind: Kind,
    /// Its header, or why it cannot be loaded.
    pub header: Result<Header, SaveError>,
}

/// A save that was read.
#[derive(Debug)]
pub struct Loaded<T> {
    /// What it holds.
    pub state: T,
    /// Its header.
    pub header: Header,
    /// The file it came from in the end.
    pub from: PathBuf,
    /// What the player must be told: which files could not be read and what was taken instead. Empty when all went well.
    pub notes: Vec<String>,
}

/// A folder of saves.
#[derive(Clone, Debug)]
pub struct Slots {
    dir: PathBuf,
}

impl Slots {
    /// The folder; made on the first write.
    pub fn new(dir: impl Into<PathBuf>) -> Self {
        let dir: PathBuf = dir.into();
        // The parent of a bare file name is empty; what is meant is here.
        Self { dir: if dir.as_os_str().is_empty() { PathBuf::from(".") } else { dir } }
    }

    /// Where it is.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Writes a save, and gives back where.
    ///
    /// # Errors
    /// [`SaveError`]; what was there before is then intact.
    pub fn write(&self, kind: &Kind, label: &Label, payload: &[u8]) -> Result<PathBuf, SaveError> {
        let path = match kind {
            Kind::Quick => self.place_in_ring("quick", QUICK_RING)?,
            Kind::Auto => self.place_in_ring("auto", AUTO_RING)?,
            Kind::Named(name) => self.dir.join(format!("{}.{ENDING}", file_stem(name))),
        };
        self.write_to(&path, label, payload)?;
        Ok(path)
    }

    /// Writes a save to a file of the caller's choice.
    ///
    /// # Errors
    /// As [`Slots::write`]; also when the file there was written by a newer program.
    pub fn write_to(&self, path: &Path, label: &Label, payload: &[u8]) -> Result<(), SaveError> {
        if let Err(e) = read_container(path)
            && e.is_newer()
        {
            return Err(e);
        }
        let header = Header {
            written_unix_s: now_unix_s(),
            sequence: self.next_sequence(),
            time: label.time,
            body: label.body.clone(),
            altitude_m: label.altitude_m,
        };
        let at = |source| SaveError::Format { path: path.to_owned(), source };
        let bytes = format::wrap(SAVE, &header, payload).map_err(at)?;
        // The self-check of the contents; `file::replace` does that of the disk.
        let (back_header, back) = format::unwrap(SAVE, &bytes).map_err(at)?;
        if back != payload || back_header != header {
            return Err(SaveError::SelfCheck { path: path.to_owned(), what: "the packed bytes differ from the state".into() });
        }
        file::replace(path, &bytes, &|old| format::unwrap(SAVE, old).is_ok())
    }

    /// All saves of the folder, the newest first, the damaged ones with their reason at the end.
    pub fn list(&self) -> Vec<Entry> {
        let mut entries: Vec<Entry> = self
            .files()
            .into_iter()
            .map(|path| {
                let header = read_container(&path).map(|(h, _)| h);
                Entry { kind: kind_of(&path), path, header }
            })
            .collect();
        let rank = |e: &Entry| (e.header.as_ref().map(|h| h.sequence).ok(), e.path.clone());
        entries.sort_by_key(|e| std::cmp::Reverse(rank(e)));
        entries
    }

    /// Reads a save by its path; where it is damaged, its `.bak`; where that is too, the newest automatic one that is sound.
    /// `decode` turns a payload into the state and says what is wrong with it.
    ///
    /// # Errors
    /// [`SaveError`]: the file is missing, or from a newer program, or nothing to fall back on is left.
    pub fn load<T>(&self, path: &Path, decode: Decode<'_, T>) -> Result<Loaded<T>, SaveError> {
        let first = match read(path, decode) {
            Ok((header, state)) => return Ok(Loaded { state, header, from: path.to_owned(), notes: Vec::new() }),
            Err(e) if e.is_newer() => return Err(e),
            Err(e) if matches!(&e, SaveError::Io { .. }) && !file::bak_of(path).is_file() => return Err(e),
            Err(e) => e,
        };
        let mut tried = vec![first.to_string()];
        let mut others = vec![file::bak_of(path)];
        others.extend(self.list().into_iter().filter(|e| e.kind == Kind::Auto && e.header.is_ok() && e.path != path).map(|e| e.path));
        for other in others {
            match read(&other, decode) {
                Ok((header, state)) => {
                    let mut notes = tried;
                    notes.push(format!("loaded {} instead, of {}", other.display(), header.time.utc()));
                    return Ok(Loaded { state, header, from: other, notes });
                }
                Err(SaveError::Io { .. }) if !other.exists() => {}
                Err(e) => tried.push(e.to_string()),
            }
        }
        if tried.len() == 1 { Err(first) } else { Err(SaveError::NothingLeft { path: path.to_owned(), tried }) }
    }

    /// Loads the newest save of a ring or of the whole folder (`None`): what *continue* and the quick-load key take.
    ///
    /// # Errors
    /// As [`Slots::load`]; [`SaveError::NothingLeft`] when there is none.
    pub fn load_newest<T>(&self, kind: Option<&Kind>, decode: Decode<'_, T>) -> Result<Loaded<T>, SaveError> {
        let entries: Vec<Entry> = self.list().into_iter().filter(|e| kind.is_none_or(|k| *k == e.kind)).collect();
        let mut tried: Vec<String> = entries.iter().filter_map(|e| e.header.as_ref().err().map(ToString::to_string)).collect();
        for entry in entries.iter().filter(|e| e.header.is_ok()) {
            match self.load(&entry.path, decode) {
                Ok(mut loaded) => {
                    loaded.notes.splice(0..0, tried);
                    return Ok(loaded);
                }
                Err(e) => tried.push(e.to_string()),
            }
        }
        if tried.is_empty() {
            tried.push("there is no save yet".into());
        }
        Err(SaveError::NothingLeft { path: self.dir.clone(), tried })
    }

    fn files(&self) -> Vec<PathBuf> {
        let Ok(entries) = fs::read_dir(&self.dir) else { return Vec::new() };
        let mut files: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == ENDING)).collect();
        files.sort();
        files
    }

    fn next_sequence(&self) -> u64 {
        self.list().iter().filter_map(|e| e.header.as_ref().ok()).map(|h| h.sequence).max().unwrap_or(0).saturating_add(1)
    }

    /// An empty place, else a damaged one, else the oldest; never one of a newer program.
    fn place_in_ring(&self, name: &str, places: u32) -> Result<PathBuf, SaveError> {
        let mut best: Option<(u64, PathBuf)> = None;
        let mut newer = None;
        for i in 1..=places {
            let path = self.dir.join(format!("{name}-{i}.{ENDING}"));
            let age = match read_container(&path) {
                Ok((h, _)) => h.sequence.saturating_add(2),
                Err(e) if e.is_newer() => {
                    newer = Some(e);
                    continue;
                }
                Err(SaveError::Io { .. }) if !path.exists() => 0,
                Err(_) => 1,
            };
            if best.as_ref().is_none_or(|(b, _)| age < *b) {
                best = Some((age, path));
            }
        }
        match (best, newer) {
            (Some((_, path)), _) => Ok(path),
            (None, Some(e)) => Err(e),
            (None, None) => Ok(self.dir.join(format!("{name}-1.{ENDING}"))),
        }
    }
}

/// Reads and decodes one file, without falling back.
///
/// # Errors
/// [`SaveError`], naming the file.
pub fn read<T>(path: &Path, decode: Decode<'_, T>) -> Result<(Header, T), SaveError> {
    let (header, payload) = read_container(path)?;
    let state = decode(&payload).map_err(|problems| SaveError::State { path: path.to_owned(), problems })?;
    Ok((header, state))
}

fn read_container(path: &Path) -> Result<(Header, Vec<u8>), SaveError> {
    let bytes = read_bounded(path)?;
    format::unwrap(SAVE, &bytes).map_err(|source| SaveError::Format { path: path.to_owned(), source })
}

/// A file's bytes; one that is larger than any of ours can be is refused unread.
///
/// # Errors
/// [`SaveError::Io`].
pub fn read_bounded(path: &Path) -> Result<Vec<u8>, SaveError> {
    let io = |source| SaveError::Io { path: path.to_owned(), action: "read it", source };
    let length = fs::metadata(path).map_err(io)?;
    if length.is_dir() {
        return Err(io(std::io::Error::other("it is a folder, expected a file")));
    }
    if length.len() > 2 * format::LARGEST_PAYLOAD {
        return Err(io(std::io::Error::other(format!(
            "it has {} bytes, none of ours has more than {}",
            length.len(),
            2 * format::LARGEST_PAYLOAD
        ))));
    }
    fs::read(path).map_err(io)
}

/// Letters, digits, `-`, `_` and spaces of a player's name for a save; so that no name leaves the folder or falls into a ring.
fn file_stem(name: &str) -> String {
    let clean: String = name.trim().chars().map(|c| if c.is_alphanumeric() || "-_ ".contains(c) { c } else { '_' }).take(64).collect();
    if clean.is_empty() || in_ring(&clean, "quick") || in_ring(&clean, "auto") { format!("save {clean}") } else { clean }
}

fn in_ring(stem: &str, ring: &str) -> bool {
    stem.strip_prefix(ring).and_then(|s| s.strip_prefix('-')).is_some_and(|n| n.parse::<u32>().is_ok())
}

fn kind_of(path: &Path) -> Kind {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if in_ring(&stem, "quick") {
        Kind::Quick
    } else if in_ring(&stem, "auto") {
        Kind::Auto
    } else {
        Kind::Named(stem.into_owned())
    }
}

/// For the list only: nothing of the World depends on it.
fn now_unix_s() -> i64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_secs()).unwrap_or(i64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::time::SimTime;

    fn label(ticks: i64) -> Label {
        Label { time: SimTime::from_ticks(ticks), body: "earth".into(), altitude_m: 4.0e5 }
    }
    fn text(payload: &[u8]) -> Result<String, Vec<String>> {
        String::from_utf8(payload.to_vec()).map_err(|e| vec![e.to_string()])
    }
    fn damage(path: &Path) {
        let mut bytes = fs::read(path).unwrap();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        fs::write(path, bytes).unwrap();
    }

    #[test]
    fn the_ring_turns_and_the_newest_is_found() {
        let dir = tempfile::tempdir().unwrap();
        let slots = Slots::new(dir.path().join("made/on/demand"));
        for i in 0..7 {
            slots.write(&Kind::Quick, &label(i), format!("state {i}").as_bytes()).unwrap();
        }
        let quick = slots.list();
        assert_eq!(quick.len(), 3);
        assert_eq!(quick.iter().map(|e| e.header.as_ref().unwrap().time.ticks).collect::<Vec<_>>(), [6, 5, 4]);
        let loaded = slots.load_newest(Some(&Kind::Quick), &text).unwrap();
        assert_eq!((loaded.state.as_str(), loaded.notes.len()), ("state 6", 0));
    }

    #[test]
    fn damage_falls_back_to_bak_then_to_the_newest_automatic_one_and_says_so() {
        let dir = tempfile::tempdir().unwrap();
        let slots = Slots::new(dir.path());
        slots.write(&Kind::Auto, &label(1), b"auto 1").unwrap();
        let newest_auto = slots.write(&Kind::Auto, &label(2), b"auto 2").unwrap();
        let named = Kind::Named("my flight".into());
        slots.write(&named, &label(3), b"first").unwrap();
        let path = slots.write(&named, &label(4), b"second").unwrap();
        damage(&path);
        let loaded = slots.load(&path, &text).unwrap();
        assert_eq!((loaded.state.as_str(), &loaded.from), ("first", &file::bak_of(&path)));
        assert!(loaded.notes[0].contains("checksum") && loaded.notes[1].contains(".bak"), "{:?}", loaded.notes);
        damage(&file::bak_of(&path));
        let loaded = slots.load(&path, &text).unwrap();
        assert_eq!((loaded.state.as_str(), &loaded.from, loaded.notes.len()), ("auto 2", &newest_auto, 3));
        for entry in slots.list().iter().filter(|e| e.kind == Kind::Auto) {
            damage(&entry.path);
        }
        assert!(matches!(slots.load(&path, &text), Err(SaveError::NothingLeft { tried, .. }) if tried.len() == 2));
        assert!(matches!(slots.load_newest(None, &text), Err(SaveError::NothingLeft { tried, .. }) if tried.len() == 3));
        assert_eq!(slots.list().iter().filter(|e| e.header.is_err()).count(), 3);
    }

    #[test]
    fn a_damaged_file_does_not_push_a_good_bak_out() {
        let dir = tempfile::tempdir().unwrap();
        let slots = Slots::new(dir.path());
        let kind = Kind::Named("a".into());
        slots.write(&kind, &label(1), b"one").unwrap();
        let path = slots.write(&kind, &label(2), b"two").unwrap();
        damage(&path);
        slots.write(&kind, &label(3), b"three").unwrap();
        assert_eq!(read(&file::bak_of(&path), &text).unwrap().1, "one");
    }

    #[test]
    fn a_newer_program_s_file_is_neither_loaded_nor_overwritten() {
        let dir = tempfile::tempdir().unwrap();
        let slots = Slots::new(dir.path());
        let kind = Kind::Named("a".into());
        slots.write(&Kind::Auto, &label(0), b"auto").unwrap();
        let path = slots.write(&kind, &label(1), b"one").unwrap();
        let mut bytes = fs::read(&path).unwrap();
        bytes[8] = 99;
        fs::write(&path, &bytes).unwrap();
        assert!(slots.load(&path, &text).unwrap_err().is_newer());
        assert!(slots.write(&kind, &label(2), b"two").unwrap_err().is_newer());
        assert_eq!(fs::read(&path).unwrap(), bytes);
        // A ring goes round such a file.
        fs::rename(&path, dir.path().join("quick-1.syzsave")).unwrap();
        let quick = slots.write(&Kind::Quick, &label(3), b"quick").unwrap();
        assert!(quick.ends_with("quick-2.syzsave"), "{}", quick.display());
    }

    #[test]
    fn a_state_that_is_refused_counts_as_damage() {
        let dir = tempfile::tempdir().unwrap();
        let slots = Slots::new(dir.path());
        slots.write(&Kind::Auto, &label(1), b"fine").unwrap();
        let path = slots.write(&Kind::Named("a".into()), &label(1), &[0xff, 0xfe]).unwrap();
        assert_eq!(slots.load(&path, &text).unwrap().state, "fine");
    }

    #[test]
    fn a_missing_file_is_an_error_of_its_own() {
        let dir = tempfile::tempdir().unwrap();
        let slots = Slots::new(dir.path());
        slots.write(&Kind::Auto, &label(1), b"fine").unwrap();
        assert!(matches!(slots.load(&dir.path().join("gone.syzsave"), &text), Err(SaveError::Io { .. })));
    }

    #[test]
    fn no_name_leaves_the_folder_or_falls_into_a_ring() {
        for (name, stem) in [("../../etc/x", "______etc_x"), ("auto-1", "save auto-1"), ("  ", "save "), ("Mondflug 3", "Mondflug 3")] {
            assert_eq!(file_stem(name), stem);
        }
    }
}
