//! A log as text: for a person who wants to know what was flown.

use super::log::Log;
use crate::world::fields::SUBSYSTEMS;
use engine::time::SimTime;

/// The log, line by line: its start, what changed at which tick, the last check.
pub fn text(log: &Log) -> String {
    let mut out = String::new();
    let mut line = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    line(format!(
        "recorded by Syzygy {}, system {} ({:.12}), ship {} ({:.12})",
        log.game_version, log.system, log.system_hash, log.ship, log.ship_hash
    ));
    if let Ok(start) = crate::save::decode(&log.start) {
        line(format!("start: {}, {:?}", SimTime::from_ticks(start.time_ticks).utc(), start.ship.motion));
    }
    line(format!("{} ticks ({:.1} s), {} checks, {} rows of bits", log.ticks, log.ticks as f64 / 60.0, log.checks.len(), log.rows.len()));
    let mut events: Vec<(u64, String)> = log.actions.iter().map(|(tick, action)| (*tick, format!("{action:?}"))).collect();
    let mut tick = 0;
    for run in &log.runs {
        if tick > 0 || !run.axes.at_rest() {
            let a = run.axes;
            let axes = format!("axes pitch {} yaw {} roll {} right {} up {} forward {}", a.pitch, a.yaw, a.roll, a.right, a.up, a.forward);
            events.push((tick, axes));
        }
        tick += run.ticks;
    }
    events.sort_by_key(|(tick, _)| *tick);
    for (tick, what) in events {
        line(format!("{tick:>9}  {what}"));
    }
    if let Some(last) = log.checks.last() {
        let hashes: Vec<String> = SUBSYSTEMS.iter().zip(&last.hashes).map(|(s, h)| format!("{s} {h:016x}")).collect();
        line(format!("{:>9}  end: {}", last.tick, hashes.join(", ")));
    }
    out
}
