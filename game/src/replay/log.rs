//! A log: start state, commands by tick, and checks; in the same checked container as a save, the body in postcard.
//!
//! Axes are kept as runs (they rest most of the time), actions with their tick. Every [`CHECK_TICKS`] ticks one hash per
//! subsystem is kept, and at a few of those checks every field's bits, so that a difference can be named.

use crate::command::{Action, Axes};
use crate::save::format::{self, FormatError, Header, LOG};
use crate::save::{SaveError, slots};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Ticks between two checks.
pub const CHECK_TICKS: u64 = 60;
/// Longest flight that is believed, ticks: a hundred days of session time.
pub const LONGEST_TICKS: u64 = 100 * 86_400 * 60;

/// A recorded flight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Log {
    /// Version of the program that recorded it.
    pub game_version: String,
    /// Folder of the system.
    pub system: String,
    /// Hash of the system's assets.
    pub system_hash: String,
    /// Key of the ship.
    pub ship: String,
    /// Hash of the ship's asset.
    pub ship_hash: String,
    /// The start: the payload of a save ([`crate::save::decode`]).
    pub start: Vec<u8>,
    /// Length of the flight, session ticks.
    pub ticks: u64,
    /// Axes, as runs; together `ticks` long.
    pub runs: Vec<Run>,
    /// Actions with the tick (from 0) before which they are carried out.
    pub actions: Vec<(u64, Action)>,
    /// Hashes, by tick.
    pub checks: Vec<Check>,
    /// Names of the fields of the rows: subsystem and field.
    pub names: Vec<(String, String)>,
    /// Every field's bits at some of the checks and at the end.
    pub rows: Vec<Row>,
}

/// Axes that stay for some ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Run {
    /// How long.
    pub ticks: u64,
    /// What.
    pub axes: Axes,
}

/// The state's hashes after a number of ticks.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Check {
    /// Ticks flown.
    pub tick: u64,
    /// One hash per subsystem, in the order of [`crate::world::fields::SUBSYSTEMS`].
    pub hashes: Vec<u64>,
}

/// The state's bits after a number of ticks.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Row {
    /// Ticks flown.
    pub tick: u64,
    /// Index into the log's names, and the bits.
    pub fields: Vec<(u16, u64)>,
}

/// What may be wrong with a log.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum LogError {
    /// It cannot be read or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] SaveError),
    /// Its container is damaged or from a newer program.
    #[error("{}: {source}", path.display())]
    #[diagnostic(code(replay::format))]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong, and at which byte.
        source: FormatError,
    },
    /// Its container is sound, what it says is not.
    #[error("{}: {}", path.display(), problems.join("; "))]
    #[diagnostic(code(replay::contents))]
    Contents {
        /// The file.
        path: PathBuf,
        /// All that is wrong.
        problems: Vec<String>,
    },
    /// It was recorded with other assets.
    #[error("{}: it was recorded with another {what} (assets {recorded}, now {now})", path.display())]
    #[diagnostic(
        code(replay::assets),
        help("play it with the assets it was recorded with, or record it again; --safe-mode leaves mods out")
    )]
    Assets {
        /// The file.
        path: PathBuf,
        /// Which asset.
        what: String,
        /// Hash when it was recorded.
        recorded: String,
        /// Hash now.
        now: String,
    },
}

impl Log {
    /// The bytes of a file; `header` is what a list would show of it.
    ///
    /// # Errors
    /// [`FormatError`] when it is too large.
    pub fn to_bytes(&self, header: &Header) -> Result<Vec<u8>, FormatError> {
        let payload = postcard::to_stdvec(self).map_err(|e| payload_error(e.to_string()))?;
        format::wrap(LOG, header, &payload)
    }

    /// Reads a log from a file's bytes and checks that it hangs together.
    ///
    /// # Errors
    /// The container's fault, or all that is wrong with what it says.
    pub fn from_bytes(bytes: &[u8]) -> Result<Result<Self, Vec<String>>, FormatError> {
        let (_, payload) = format::unwrap(LOG, bytes)?;
        let (log, rest) = match postcard::take_from_bytes::<Self>(&payload) {
            Ok(taken) => taken,
            Err(e) => return Ok(Err(vec![format!("the payload is not a replay of format {}: {e}", LOG.version)])),
        };
        let mut problems = log.problems();
        if !rest.is_empty() {
            problems.push(format!("{} bytes follow the replay's end", rest.len()));
        }
        Ok(if problems.is_empty() { Ok(log) } else { Err(problems) })
    }

    /// Reads a log from a file.
    ///
    /// # Errors
    /// [`LogError`], naming the file and what is wrong.
    pub fn read(path: &Path) -> Result<Self, LogError> {
        let bytes = slots::read_bounded(path)?;
        Self::from_bytes(&bytes)
            .map_err(|source| LogError::Format { path: path.to_owned(), source })?
            .map_err(|problems| LogError::Contents { path: path.to_owned(), problems })
    }

    /// Writes the log to a file, as a whole or not at all.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn write(&self, path: &Path, header: &Header) -> Result<(), LogError> {
        let bytes = self.to_bytes(header).map_err(|source| LogError::Format { path: path.to_owned(), source })?;
        Ok(crate::save::file::replace(path, &bytes, &|_| false)?)
    }

    /// Refuses a log that was recorded with other assets than the World's.
    ///
    /// # Errors
    /// [`LogError::Assets`].
    pub fn check_assets(&self, path: &Path, world: &crate::world::World) -> Result<(), LogError> {
        let ship_hash = recorder_hash(world);
        let pairs = [
            (format!("system `{}`", self.system), &self.system_hash, &world.system.hash),
            (format!("ship `{}`", self.ship), &self.ship_hash, &ship_hash),
        ];
        for (what, recorded, now) in pairs {
            if recorded != now {
                let (recorded, now) = (short(recorded), short(now));
                return Err(LogError::Assets { path: path.to_owned(), what, recorded, now });
            }
        }
        Ok(())
    }

    fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        if self.ticks > LONGEST_TICKS {
            problems.push(format!("ticks: {}, expected at most {LONGEST_TICKS}", self.ticks));
        }
        let together = self.runs.iter().try_fold(0_u64, |sum, r| sum.checked_add(r.ticks));
        if together != Some(self.ticks) {
            problems.push(format!("runs: together {together:?} ticks, expected {}", self.ticks));
        }
        let mut tick = 0;
        for (i, (at, _)) in self.actions.iter().enumerate() {
            if *at < tick || *at >= self.ticks {
                problems.push(format!("actions[{i}]: tick {at}, expected {tick} to {}", self.ticks.saturating_sub(1)));
            }
            tick = tick.max(*at);
        }
        let subsystems = crate::world::fields::SUBSYSTEMS.len();
        let mut tick = 0;
        for (i, check) in self.checks.iter().enumerate() {
            if check.tick <= tick || check.tick > self.ticks || check.hashes.len() != subsystems {
                let found = check.hashes.len();
                problems.push(format!("checks[{i}]: tick {} with {found} hashes, expected a later tick with {subsystems}", check.tick));
            }
            tick = check.tick;
        }
        if self.ticks > 0 && self.checks.last().map(|c| c.tick) != Some(self.ticks) {
            problems.push("checks: none at the last tick, the flight would end unchecked".into());
        }
        for (i, row) in self.rows.iter().enumerate() {
            if row.tick > self.ticks || row.fields.iter().any(|(n, _)| usize::from(*n) >= self.names.len()) {
                problems.push(format!("rows[{i}]: tick {} or a field's name is out of range", row.tick));
            }
        }
        problems.truncate(12);
        problems
    }
}

/// Hash of the ship's asset that a World flies, hex.
pub fn recorder_hash(world: &crate::world::World) -> String {
    let spec = &*world.ship.spec;
    serde_json::to_vec(spec).map(|bytes| blake3::hash(&bytes).to_hex().to_string()).unwrap_or_default()
}

fn short(hash: &str) -> String {
    hash.chars().take(12).collect()
}

fn payload_error(what: String) -> FormatError {
    FormatError::Payload { name: LOG.name, offset: 0, what }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Commands;
    use crate::replay::{Recorder, recorder};
    use crate::save::fixture;

    fn log() -> (Log, Header) {
        let world = fixture::worlds().swap_remove(0);
        let mut recorder = Recorder::new(&world);
        for tick in 0..150 {
            let actions = if tick == 7 { vec![Action::Quicksave, Action::Warp(3)] } else { vec![] };
            recorder.tick(&Commands { axes: Axes { roll: tick / 20, ..Axes::default() }, actions }, &world);
        }
        (recorder.finish(&world), recorder::header(&world))
    }

    fn said_of(change: impl Fn(&mut Log)) -> String {
        let (mut log, header) = log();
        change(&mut log);
        Log::from_bytes(&log.to_bytes(&header).unwrap()).unwrap().unwrap_err().join("; ")
    }

    macro_rules! refuses {
        ($($name:ident: $change:expr => $word:literal;)*) => {$(
            #[test]
            fn $name() {
                let said = said_of($change);
                assert!(said.contains($word), "{said}");
            }
        )*};
    }
    refuses! {
        refuses_runs_that_do_not_add_up: |l: &mut Log| l.runs[0].ticks += 1 => "runs: together Some(151) ticks, expected 150";
        refuses_runs_that_overflow: |l: &mut Log| l.runs[0].ticks = u64::MAX => "runs: together None";
        refuses_an_endless_flight: |l: &mut Log| l.ticks = u64::MAX => "ticks: 18446744073709551615";
        refuses_actions_after_the_end: |l: &mut Log| l.actions[1].0 = 150 => "actions[1]: tick 150";
        refuses_actions_out_of_order: |l: &mut Log| l.actions[1].0 = 3 => "actions[1]: tick 3, expected 7";
        refuses_a_check_without_hashes: |l: &mut Log| l.checks[0].hashes.clear() => "checks[0]: tick 60 with 0 hashes";
        refuses_an_end_without_a_check: |l: &mut Log| drop(l.checks.pop()) => "none at the last tick";
        refuses_fields_without_a_name: |l: &mut Log| l.names.clear() => "rows[0]";
    }

    #[test]
    fn other_assets_are_named() {
        let (mut log, _) = log();
        let world = fixture::worlds().swap_remove(0);
        assert!(log.check_assets(Path::new("a.syzlog"), &world).is_ok());
        log.ship_hash = "0".repeat(64);
        let said = log.check_assets(Path::new("a.syzlog"), &world).unwrap_err().to_string();
        assert!(said.contains("a.syzlog") && said.contains("ship `torch`") && said.contains("000000000000"), "{said}");
    }

    #[test]
    fn bent_payloads_never_panic() {
        let (log, header) = log();
        let payload = postcard::to_stdvec(&log).unwrap();
        let mut x = 88_172_645_463_325_252_u64;
        let mut next = move || {
            x ^= x << 13;
            x ^= x >> 7;
            x ^= x << 17;
            usize::try_from(x >> 33).unwrap()
        };
        let mut refused = 0;
        for _ in 0..1500 {
            let mut bent = payload.clone();
            for _ in 0..1 + next() % 3 {
                let at = next() % bent.len();
                match next() % 3 {
                    0 => bent[at] ^= 1 << (next() % 8),
                    1 => bent[at] = 0xff,
                    _ => bent.truncate(at.max(1)),
                }
            }
            let bytes = format::wrap(LOG, &header, &bent).unwrap();
            refused += usize::from(Log::from_bytes(&bytes).unwrap().is_err());
        }
        assert!(refused > 300, "{refused}");
    }
}
