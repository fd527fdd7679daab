//! The player: gives a log's commands back tick by tick, and compares the World with what was recorded.
//!
//! A hash that differs names tick and subsystem. The field is named where the log keeps every field's bits: at that
//! tick, or at the next such tick after it (the flight goes on until there).

use super::log::{Log, Row};
use crate::command::{Axes, Commands};
use crate::world::World;
use crate::world::fields::SUBSYSTEMS;
use std::collections::BTreeMap;
use std::fmt;

/// Where a run parted from its record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Divergence {
    /// First check at which a hash differs, ticks flown.
    pub tick: u64,
    /// The first subsystem that differs there.
    pub subsystem: &'static str,
    /// Its hash in the log and now.
    pub hashes: (u64, u64),
    /// The first field that differs, if one could be named.
    pub field: Option<FieldDifference>,
}

/// A field that differs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldDifference {
    /// Where the bits were compared, ticks flown.
    pub tick: u64,
    /// Subsystem and field.
    pub name: (String, String),
    /// Recorded bits; `None` when the field was not there.
    pub recorded: Option<u64>,
    /// Bits now; `None` when the field is not there.
    pub now: Option<u64>,
}

impl fmt::Display for Divergence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tick, subsystem, hashes: (recorded, now), field } = self;
        write!(f, "diverged at tick {tick} in `{subsystem}`: hash recorded {recorded:#018x}, now {now:#018x}")?;
        let bits = |b: &Option<u64>| b.map_or_else(|| "absent".to_owned(), |b| format!("{b:#018x} ({:e})", f64::from_bits(b)));
        match field {
            Some(d) => {
                let (subsystem, name) = &d.name;
                write!(f, "; field `{subsystem}.{name}` at tick {}: recorded {}, now {}", d.tick, bits(&d.recorded), bits(&d.now))
            }
            None => write!(f, "; the log keeps no bits at or after that tick that differ"),
        }
    }
}

/// Plays a log.
#[derive(Clone, Debug)]
pub struct Player {
    log: Log,
    tick: u64,
    run: (usize, u64),
    action: usize,
    check: usize,
    row: usize,
    diverged: Option<Divergence>,
}

impl Player {
    /// From the beginning.
    pub fn new(log: Log) -> Self {
        Self { log, tick: 0, run: (0, 0), action: 0, check: 0, row: 0, diverged: None }
    }

    /// The log.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// Ticks played.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// The commands of the next tick; `None` at the end.
    pub fn next_commands(&mut self) -> Option<Commands> {
        if self.tick >= self.log.ticks {
            return None;
        }
        while self.log.runs.get(self.run.0).is_some_and(|r| self.run.1 >= r.ticks) {
            self.run = (self.run.0 + 1, 0);
        }
        let axes = self.log.runs.get(self.run.0).map_or(Axes::default(), |r| r.axes);
        self.run.1 += 1;
        let mut actions = Vec::new();
        while let Some((_, action)) = self.log.actions.get(self.action).filter(|(at, _)| *at == self.tick) {
            actions.push(*action);
            self.action += 1;
        }
        self.tick += 1;
        Some(Commands { axes, actions })
    }

    /// Compares the World after the tick whose commands were given last. `Some` once a difference is found and, if the
    /// log can, its field is named; the run should end then.
    pub fn compare(&mut self, world: &World) -> Option<Divergence> {
        if let Some(check) = self.log.checks.get(self.check).filter(|c| c.tick == self.tick) {
            self.check += 1;
            if self.diverged.is_none() {
                let now = world.state_hash();
                let parted = now.iter().zip(&check.hashes).position(|((_, now), recorded)| now != recorded);
                self.diverged = parted.map(|i| Divergence {
                    tick: self.tick,
                    subsystem: SUBSYSTEMS[i],
                    hashes: (check.hashes[i], now[i].1),
                    field: None,
                });
            }
        }
        let row = self.log.rows.get(self.row).filter(|r| r.tick == self.tick);
        self.row += usize::from(row.is_some());
        let found = self.diverged.as_mut()?;
        if let Some(row) = row {
            found.field = difference(&self.log, row, world, found.subsystem);
        }
        let over = self.tick >= self.log.ticks || found.field.is_some();
        over.then(|| found.clone())
    }
}

/// The first field that differs: in `first` if there is one, else in any subsystem. A name may occur several times (one
/// per leg of the gear): the n-th is compared with the n-th.
fn difference(log: &Log, row: &Row, world: &World, first: &str) -> Option<FieldDifference> {
    let names = |n: u16| log.names.get(usize::from(n)).map(|(s, f)| (s.as_str(), f.as_str()));
    let recorded = numbered(row.fields.iter().filter_map(|(n, bits)| names(*n).map(|name| (name, *bits))));
    let now = numbered(world.fields().into_iter().map(|(s, f, bits)| ((s, f), bits)));
    let bits = |all: &Numbered<'_>, key| all.get(key).map(|(_, bits)| *bits);
    let differ = recorded.keys().chain(now.keys()).filter(|key| bits(&recorded, *key) != bits(&now, *key));
    let best = differ.min_by_key(|key| (key.0.0 != first, order(&recorded, &now, key)))?;
    let name = |(s, f): (&str, &str)| (s.to_owned(), f.to_owned());
    Some(FieldDifference { tick: row.tick, name: name(best.0), recorded: bits(&recorded, best), now: bits(&now, best) })
}

/// Fields by name and occurrence, with their place in the list and their bits.
type Numbered<'a> = BTreeMap<((&'a str, &'a str), usize), (usize, u64)>;

fn numbered<'a>(fields: impl Iterator<Item = ((&'a str, &'a str), u64)>) -> Numbered<'a> {
    let mut seen = BTreeMap::new();
    let mut all = BTreeMap::new();
    for (place, (name, bits)) in fields.enumerate() {
        let count = seen.entry(name).or_insert(0_usize);
        all.insert((name, *count), (place, bits));
        *count += 1;
    }
    all
}

fn order(recorded: &Numbered<'_>, now: &Numbered<'_>, key: &((&str, &str), usize)) -> usize {
    recorded.get(key).or_else(|| now.get(key)).map_or(usize::MAX, |(place, _)| *place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Action, Hold};
    use crate::replay::Recorder;
    use crate::save::{self, fixture};
    use crate::session::Session;

    /// A flight of 500 ticks with sticks, actions, a quick save and a quick load.
    fn flown() -> Log {
        let mut session = Session::new(fixture::worlds().swap_remove(1));
        session.record();
        for tick in 0..500_u64 {
            let pitch = if (100..130).contains(&tick) { 12_000 } else { 0 };
            let actions = match tick {
                5 => vec![Action::Throttle(50_000), Action::Hold(Hold::Prograde)],
                150 => vec![Action::Quicksave],
                300 => vec![Action::Quickload],
                _ => vec![],
            };
            session.tick(&Commands { axes: Axes { pitch, ..Axes::default() }, actions });
        }
        session.recorded().unwrap()
    }

    fn play(log: Log, bend: impl Fn(u64, &mut Session)) -> Option<Divergence> {
        let world = fixture::worlds().swap_remove(1);
        let start = save::decode(&log.start).unwrap().restore(&world.system, &world.ship.spec).unwrap();
        let mut session = Session::new(start);
        let mut player = Player::new(log);
        while let Some(commands) = player.next_commands() {
            session.tick(&commands);
            bend(player.tick(), &mut session);
            if let Some(d) = player.compare(&session.world) {
                return Some(d);
            }
        }
        None
    }

    #[test]
    fn a_flight_replays_bit_for_bit_and_through_its_file() {
        let log = flown();
        assert_eq!((log.ticks, log.actions.len(), log.runs.len(), log.checks.len()), (500, 4, 3, 9));
        let bytes = log.to_bytes(&crate::replay::recorder::header(&fixture::worlds()[1])).unwrap();
        let back = Log::from_bytes(&bytes).unwrap().unwrap();
        assert_eq!(back, log);
        assert_eq!(play(back, |_, _| {}), None);
    }

    #[test]
    fn saving_and_loading_at_every_third_tick_changes_no_bit() {
        let heavy = |tick: u64, session: &mut Session| {
            if tick.is_multiple_of(3) {
                session.world = save::round_trip(&session.world).unwrap();
            }
        };
        assert_eq!(play(flown(), heavy), None);
    }

    #[test]
    fn one_changed_bit_is_named_with_tick_subsystem_field_and_both_patterns() {
        let bend = |tick: u64, session: &mut Session| {
            if tick == 130 {
                session.world.ship.propellant_kg = f64::from_bits(session.world.ship.propellant_kg.to_bits() ^ 1);
            }
        };
        let d = play(flown(), bend).unwrap();
        let field = d.field.clone().unwrap();
        assert_eq!(d.tick, 180);
        assert!(field.recorded.is_some() && field.recorded != field.now);
        let text = d.to_string();
        assert!(text.contains("tick 180") && text.contains(&format!("{:#018x}", field.recorded.unwrap())), "{text}");
    }

    #[test]
    fn a_longer_flight_keeps_few_rows_and_all_hashes() {
        let world = fixture::worlds().swap_remove(4);
        let mut recorder = Recorder::new(&world);
        for _ in 0..60 * 400 {
            recorder.tick(&Commands::default(), &world);
        }
        let log = recorder.finish(&world);
        assert_eq!((log.checks.len(), log.runs.len()), (400, 1));
        assert!((30..=66).contains(&log.rows.len()), "{}", log.rows.len());
        assert_eq!(log.rows.last().unwrap().tick, log.ticks);
    }
}
