//! One file, replaced as a whole or not at all: temporary file beside it, self-check, sync, `.bak`, rename, sync of the folder.
//!
//! At every moment of [`replace`] the name stands for either the old bytes or the new ones; a crash, a full disk or a
//! refused permission leaves the old. `fault` lets tests fail any step.

use super::SaveError;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Steps of [`replace`], in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Make the temporary file.
    Create,
    /// Write the bytes.
    Write,
    /// Read them back.
    ReadBack,
    /// Flush to the disk.
    Sync,
    /// Keep the old file as `.bak`.
    KeepOld,
    /// Give the new file its name.
    Rename,
    /// Flush the folder.
    SyncFolder,
}

impl Step {
    fn action(self) -> &'static str {
        match self {
            Self::Create => "make a temporary file beside it",
            Self::Write => "write it (is the disk full?)",
            Self::ReadBack => "read it back",
            Self::Sync => "flush it to the disk",
            Self::KeepOld => "keep the old one as .bak",
            Self::Rename => "put it in place",
            Self::SyncFolder => "flush its folder to the disk",
        }
    }
}

/// The file's name with `.bak` behind it.
pub fn bak_of(path: &Path) -> PathBuf {
    with_ending(path, ".bak")
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name: OsString = path.file_name().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

/// Replaces `path` by `bytes`. The old file is kept as `.bak` when `keep_old` says that it is worth keeping (a damaged one
/// must not push a good `.bak` out).
///
/// # Errors
/// [`SaveError::Io`] or [`SaveError::SelfCheck`]; the old file is then intact.
pub fn replace(path: &Path, bytes: &[u8], keep_old: &dyn Fn(&[u8]) -> bool) -> Result<(), SaveError> {
    replace_with_faults(path, bytes, keep_old, &mut |_| Ok(()))
}

pub(super) fn replace_with_faults(
    path: &Path,
    bytes: &[u8],
    keep_old: &dyn Fn(&[u8]) -> bool,
    fault: &mut dyn FnMut(Step) -> io::Result<()>,
) -> Result<(), SaveError> {
    let io = |step: Step, source: io::Error| SaveError::Io { path: path.to_owned(), action: step.action(), source };
    let folder = match path.parent() {
        Some(p) if !p.as_os_str().is_empty() => p,
        _ => Path::new("."),
    };
    if path.is_dir() {
        return Err(SaveError::Io {
            path: path.to_owned(),
            action: "write it",
            source: io::Error::other("it is a folder, expected a file name"),
        });
    }
    let mut step = |s: Step| fault(s).map_err(|e| io(s, e));
    step(Step::Create)?;
    fs::create_dir_all(folder).map_err(|e| io(Step::Create, e))?;
    // Removed by its drop unless it reaches its name.
    let mut new = tempfile::Builder::new().prefix(".writing-").tempfile_in(folder).map_err(|e| io(Step::Create, e))?;
    step(Step::Write)?;
    new.write_all(bytes).and_then(|()| new.flush()).map_err(|e| io(Step::Write, e))?;
    step(Step::ReadBack)?;
    let back = fs::read(new.path()).map_err(|e| io(Step::ReadBack, e))?;
    if back != bytes {
        let at = back.iter().zip(bytes).position(|(a, b)| a != b).unwrap_or(back.len().min(bytes.len()));
        return Err(SaveError::SelfCheck { path: path.to_owned(), what: format!("the first difference is at byte {at}") });
    }
    step(Step::Sync)?;
    new.as_file().sync_all().map_err(|e| io(Step::Sync, e))?;
    step(Step::KeepOld)?;
    match fs::read(path) {
        Ok(old) if keep_old(&old) => keep(path, folder, &old).map_err(|e| io(Step::KeepOld, e))?,
        Ok(_) => {}
        Err(e) if e.kind() == io::ErrorKind::NotFound => {}
        Err(e) => return Err(io(Step::KeepOld, e)),
    }
    step(Step::Rename)?;
    new.persist(path).map_err(|e| io(Step::Rename, e.error))?;
    step(Step::SyncFolder)?;
    sync_folder(folder).map_err(|e| io(Step::SyncFolder, e))
}

fn keep(path: &Path, folder: &Path, old: &[u8]) -> io::Result<()> {
    let mut bak = tempfile::Builder::new().prefix(".keeping-").tempfile_in(folder)?;
    bak.write_all(old)?;
    bak.as_file().sync_all()?;
    bak.persist(bak_of(path)).map(drop).map_err(|e| e.error)
}

/// A rename is only safe once the folder itself is on the disk; Windows has no such call and does it by itself.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: [Step; 7] = [Step::Create, Step::Write, Step::ReadBack, Step::Sync, Step::KeepOld, Step::Rename, Step::SyncFolder];

    fn names(dir: &Path) -> Vec<String> {
        let mut n: Vec<String> = fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        n.sort();
        n
    }

    #[test]
    fn the_old_one_becomes_bak_unless_it_is_worthless() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.syzsave");
        replace(&path, b"one", &|_| true).unwrap();
        assert_eq!(names(dir.path()), ["a.syzsave"]);
        replace(&path, b"two", &|_| true).unwrap();
        assert_eq!(fs::read(bak_of(&path)).unwrap(), b"one");
        replace(&path, b"three", &|old| old != b"two").unwrap();
        assert_eq!((fs::read(&path).unwrap(), fs::read(bak_of(&path)).unwrap()), (b"three".to_vec(), b"one".to_vec()));
    }

    #[test]
    fn whatever_step_fails_the_name_stands_for_old_or_new_and_nothing_is_left_lying() {
        for failing in STEPS {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("a.syzsave");
            replace(&path, b"old", &|_| true).unwrap();
            let full = |s: Step| if s == failing { Err(io::Error::from(io::ErrorKind::StorageFull)) } else { Ok(()) };
            let error = replace_with_faults(&path, b"new", &|_| true, &mut { full }).unwrap_err().to_string();
            assert!(error.contains("a.syzsave") && error.contains(failing.action()), "{error}");
            let expected: &[u8] = if failing == Step::SyncFolder { b"new" } else { b"old" };
            assert_eq!(fs::read(&path).unwrap(), expected, "{failing:?}");
            assert!(names(dir.path()).iter().all(|n| n.starts_with("a.syzsave")), "{failing:?}: {:?}", names(dir.path()));
        }
    }

    #[test]
    fn a_folder_is_not_overwritten() {
        let dir = tempfile::tempdir().unwrap();
        let e = replace(dir.path(), b"x", &|_| true).unwrap_err().to_string();
        assert!(e.contains("it is a folder"), "{e}");
    }
}
