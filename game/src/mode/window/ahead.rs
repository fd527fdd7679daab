//! The paths of the bodies ahead of the player: read from the user's cache folder, integrated on from there beside the flight, and written
//! back. The flight never waits for it: what it asks for is integrated at once, with the same bits.

use super::job::{Job, Outcome};
use engine::orbit::ephemeris::Ephemeris;
use engine::space::relative::narrow;
use engine::time::SimTime;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// From 1900-01-01 to 2101-01-01, Julian dates.
const SPAN: [f64; 2] = [2_415_020.5, 2_488_069.5];

/// The work in progress; dropped, it ends.
pub struct Ahead {
    job: Job<()>,
    cancel: Arc<AtomicBool>,
}

impl Ahead {
    /// Starts for one system; `folder` is that of caches, `None` where there is none.
    pub fn start(ephemeris: &Ephemeris, system: &str, folder: Option<&Path>) -> Self {
        let cancel = Arc::new(AtomicBool::new(false));
        let (ephemeris, stop) = (ephemeris.clone(), cancel.clone());
        let file = folder.map(|dir| dir.join(format!("{system}.paths")));
        let job = Job::spawn(move |progress| work(&ephemeris, file.as_deref(), SPAN.map(SimTime::from_jd_tdb), &stop, progress));
        Self { job, cancel }
    }

    /// How far it is, 0 … 1; `None` when it is done.
    pub fn poll(&mut self) -> Option<f32> {
        matches!(self.job.poll(), Outcome::Running).then_some(self.job.fraction)
    }
}

impl Drop for Ahead {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Relaxed);
    }
}

fn work(ephemeris: &Ephemeris, file: Option<&Path>, [from, to]: [SimTime; 2], cancel: &AtomicBool, progress: &(dyn Fn(f32, &str) + Sync)) {
    if let Some(Ok(bytes)) = file.map(std::fs::read)
        && let Err(why) = ephemeris.from_bytes(&bytes)
    {
        tracing::info!("the cached paths are integrated anew: {why}");
    }
    if ephemeris.is_prepared(from, to) || !ephemeris.prepare(from, to, &|part| progress(narrow(part), "Paths of the bodies"), cancel) {
        return;
    }
    if let Some(file) = file
        && let Err(e) = write(file, &ephemeris.to_bytes())
    {
        tracing::warn!("{}: the paths cannot be kept for the next time: {e}", file.display());
    }
}

/// Writes beside the file first, so that one that is there is whole.
fn write(file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let dir: PathBuf = file.parent().map_or_else(PathBuf::new, Path::to_owned);
    std::fs::create_dir_all(&dir)?;
    let mut new = tempfile::NamedTempFile::new_in(&dir)?;
    new.write_all(bytes)?;
    new.persist(file)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::orbit::ephemeris::{Orbit, Path as OrbitPath};
    use engine::orbit::{BodyId, State};
    use engine::space::{Position, Velocity};

    fn two() -> Ephemeris {
        let path = |x: f64, v: f64| OrbitPath::FromParent {
            epoch: SimTime::default(),
            state: State { position: Position::xyz(x, 0.0, 0.0), velocity: Velocity::xyz(0.0, v, 0.0) },
        };
        let orbit = |parent, gm_m3_s2, path| Orbit { parent, gm_m3_s2, path };
        Ephemeris::new(vec![orbit(None, 1e20, path(0.0, 0.0)), orbit(Some(BodyId(0)), 1e14, path(1e11, 3.2e4))]).unwrap()
    }

    #[test]
    fn the_cache_is_written_read_and_mended() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("caches/two.paths");
        let span = [-100, 300].map(|days: i64| SimTime::from_ticks(days * 86_400 * 60));
        let go = AtomicBool::new(false);
        let first = two();
        work(&first, Some(&file), span, &go, &|_, _| ());
        let kept = std::fs::read(&file).unwrap();
        assert_eq!(kept, first.to_bytes());
        // The second time nothing is integrated.
        let heard = std::sync::atomic::AtomicUsize::new(0);
        let count = |_: f32, _: &str| {
            heard.fetch_add(1, Ordering::Relaxed);
        };
        let second = two();
        work(&second, Some(&file), span, &go, &count);
        assert!(second.is_prepared(span[0], span[1]) && heard.load(Ordering::Relaxed) == 0);
        // A broken one is replaced.
        std::fs::write(&file, &kept[..kept.len() / 2]).unwrap();
        work(&two(), Some(&file), span, &go, &count);
        assert!(heard.load(Ordering::Relaxed) > 0);
        assert_eq!(std::fs::read(&file).unwrap(), kept);
        // Where nothing can be written it is not fatal.
        work(&two(), Some(&file.join("no")), span, &go, &count);
    }

    #[test]
    fn dropping_it_ends_it() {
        let ahead = Ahead::start(&two(), "two", None);
        let stop = ahead.cancel.clone();
        drop(ahead);
        assert!(stop.load(Ordering::Relaxed));
    }
}
