//! The recorder: told each tick's commands and the World after it, it makes a [`Log`].

use super::log::{CHECK_TICKS, Check, Log, Row, Run, recorder_hash};
use crate::command::Commands;
use crate::save::{self, Header};
use crate::world::World;
use std::collections::BTreeMap;

/// Rows of bits that a log keeps besides its last; more are thinned out, so that a long flight's log stays small.
const MOST_ROWS: usize = 64;

/// Records a flight.
#[derive(Clone, Debug)]
pub struct Recorder {
    log: Log,
    name_of: BTreeMap<(&'static str, &'static str), u16>,
    /// Checks between two rows.
    row_stride: u64,
}

impl Recorder {
    /// Begins with the World as it is now.
    pub fn new(start: &World) -> Self {
        let log = Log {
            game_version: env!("CARGO_PKG_VERSION").to_owned(),
            system: start.system.key.clone(),
            system_hash: start.system.hash.clone(),
            ship: start.ship.spec.key.clone(),
            ship_hash: recorder_hash(start),
            start: save::encode(start),
            ticks: 0,
            runs: Vec::new(),
            actions: Vec::new(),
            checks: Vec::new(),
            names: Vec::new(),
            rows: Vec::new(),
        };
        Self { log, name_of: BTreeMap::new(), row_stride: 1 }
    }

    /// Ticks recorded so far.
    pub fn ticks(&self) -> u64 {
        self.log.ticks
    }

    /// Takes one tick: its commands, and the World after them.
    pub fn tick(&mut self, commands: &Commands, after: &World) {
        let tick = self.log.ticks;
        match self.log.runs.last_mut() {
            Some(run) if run.axes == commands.axes => run.ticks += 1,
            _ => self.log.runs.push(Run { ticks: 1, axes: commands.axes }),
        }
        self.log.actions.extend(commands.actions.iter().map(|a| (tick, *a)));
        self.log.ticks = tick + 1;
        if self.log.ticks.is_multiple_of(CHECK_TICKS) {
            self.check(after);
        }
    }

    /// Ends the record with the World as it is now.
    pub fn finish(mut self, end: &World) -> Log {
        if self.log.checks.last().map(|c| c.tick) != Some(self.log.ticks) && self.log.ticks > 0 {
            self.check(end);
        }
        if self.log.rows.last().map(|r| r.tick) != Some(self.log.ticks) && self.log.ticks > 0 {
            self.row(end);
        }
        self.log
    }

    fn check(&mut self, world: &World) {
        let hashes = world.state_hash().iter().map(|(_, hash)| *hash).collect();
        self.log.checks.push(Check { tick: self.log.ticks, hashes });
        if (self.log.checks.len() as u64).is_multiple_of(self.row_stride) {
            self.row(world);
        }
        if self.log.rows.len() > MOST_ROWS {
            self.row_stride *= 2;
            let spacing = self.row_stride * CHECK_TICKS;
            self.log.rows.retain(|r| r.tick.is_multiple_of(spacing));
        }
    }

    fn row(&mut self, world: &World) {
        let mut fields = Vec::new();
        for (subsystem, field, bits) in world.fields() {
            let next = u16::try_from(self.log.names.len()).unwrap_or(u16::MAX);
            let names = &mut self.log.names;
            let index = *self.name_of.entry((subsystem, field)).or_insert_with(|| {
                names.push((subsystem.to_owned(), field.to_owned()));
                next
            });
            fields.push((index, bits));
        }
        self.log.rows.push(Row { tick: self.log.ticks, fields });
    }
}

/// The header of a log that begins with this World.
pub fn header(start: &World) -> Header {
    let label = save::label(start);
    // No date: the same flight must give the same file.
    Header { written_unix_s: 0, sequence: 0, time: label.time, body: label.body, altitude_m: label.altitude_m }
}
