//! `syzygy bench ephemeris`: what the places of the bodies cost: a question, the first year, the whole span from 1900 to 2100.
//!
//! Errors against DE440 are measured by `tests/peers/de440.py`. Not here: the work itself ([`engine::orbit::ephemeris`]).

use super::orbit_rows;
use crate::cli::BenchEphemerisArgs;
use crate::mode::Error;
use crate::mode::stage::Stage;
use crate::world::system::System;
use cpu_time::ProcessTime;
use engine::orbit::BodyId;
use engine::time::SimTime;
use engine::units::DAY;
use serde::Serialize;
use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// From 1900-01-01 to 2101-01-01, and the epoch between them, Julian dates.
const SPAN: [f64; 2] = [2_415_020.5, 2_488_069.5];
/// The day that questions are about.
const DAY_JD: f64 = 2_461_265.0;
const QUESTIONS: i64 = 20_000;
const ROUNDS: usize = 5;

/// What one thing cost.
#[derive(Clone, Debug, Serialize)]
struct Row {
    what: String,
    /// Nanoseconds for one question; none for work that is done once.
    ns: Option<f64>,
    wall_s: Option<f64>,
    cpu_s: Option<f64>,
}

/// Measures and writes.
///
/// # Errors
/// A system that does not load, a file that cannot be written.
pub fn run(args: &BenchEphemerisArgs) -> Result<(), Error> {
    let system = Stage::set(&args.places)?.system(&args.system)?;
    let day = SimTime::from_jd_tdb(DAY_JD);
    let year = [day.plus(-seconds(0.5 * 365.25)), day.plus(seconds(0.5 * 365.25))];
    let mut rows = vec![build(&system, "one year about 2026-08-12", year), build(&system, "1900 to 2100", SPAN.map(SimTime::from_jd_tdb))];
    for (i, body) in system.bodies.iter().enumerate() {
        let id = BodyId(u16::try_from(i).unwrap_or(0));
        let ask = |t: SimTime| {
            black_box(system.ephemeris.state(id, t));
        };
        rows.push(Row { what: format!("state of {}", body.key), ns: Some(least_ns(day, ask)), wall_s: None, cpu_s: None });
    }
    let mut states = Vec::new();
    let each = least_ns(day, |t| system.ephemeris.states_into(t, &mut states)) / system.bodies.len() as f64;
    rows.push(Row { what: "a body of states_into".to_owned(), ns: Some(each), wall_s: None, cpu_s: None });
    Ok(orbit_rows::write(&rows, args.json.as_deref())?)
}

/// Ticks in some days.
#[allow(clippy::cast_possible_truncation)]
fn seconds(days: f64) -> i64 {
    (days * DAY * engine::time::TICKS_PER_SECOND as f64) as i64
}

fn build(system: &System, what: &str, [from, to]: [SimTime; 2]) -> Row {
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    system.ephemeris.prepare(from, to, &|_| (), &AtomicBool::new(false));
    let (wall_s, cpu_s) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
    Row { what: what.to_owned(), ns: None, wall_s: Some(wall_s), cpu_s: Some(cpu_s) }
}

/// Nanoseconds for a question, at moments spread over a day; the least of several rounds.
fn least_ns(day: SimTime, mut ask: impl FnMut(SimTime)) -> f64 {
    let step = seconds(1.0) / QUESTIONS;
    (0..ROUNDS)
        .map(|_| {
            let begun = ProcessTime::now();
            (0..QUESTIONS).for_each(|k| ask(day.plus(k * step)));
            begun.elapsed().as_secs_f64() * 1e9 / QUESTIONS as f64
        })
        .fold(f64::INFINITY, f64::min)
}
