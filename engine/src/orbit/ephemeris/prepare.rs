//! Building ahead: the whole span, on threads of its own, while others ask already. Not here: files ([`super::cache`]).

use super::handle::{Ephemeris, System};
use crate::time::SimTime;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Chunks between two looks at whether to go on.
const SLICE: i64 = 8;

/// One side of one level, up to a chunk.
struct Task {
    level: usize,
    /// The last chunk wanted: 0 … forward, −1 … backward.
    last: i64,
    /// Cost of a chunk, in units of its own.
    cost: f64,
}

impl Ephemeris {
    /// True where everything from `from` to `to` has been integrated.
    pub fn is_prepared(&self, from: SimTime, to: SimTime) -> bool {
        self.system.as_deref().is_none_or(|system| tasks(system, from, to).iter().all(|task| done(system, task)))
    }

    /// Integrates everything from `from` to `to`, the planets first, on all processors but one, which is left to the picture; `progress`
    /// hears how much is done, 0 … 1. False where `cancel` was set before the end. Whoever asks meanwhile gets the same bits as without it.
    pub fn prepare(&self, from: SimTime, to: SimTime, progress: &(dyn Fn(f64) + Sync), cancel: &AtomicBool) -> bool {
        let Some(system) = self.system.as_deref() else { return true };
        let tasks = tasks(system, from, to);
        let total: f64 = tasks.iter().map(|t| t.cost * outwards(t.last) as f64).sum();
        let (next, done) = (AtomicUsize::new(0), Mutex::new(0.0));
        let tell = |cost: f64| {
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            *done += cost / total;
            progress(f64::min(*done, 1.0));
        };
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get().saturating_sub(1).max(1)).min(tasks.len());
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    while let Some(task) = tasks.get(next.fetch_add(1, Ordering::Relaxed)) {
                        run(system, task, cancel, &tell);
                    }
                });
            }
        });
        !cancel.load(Ordering::Relaxed)
    }
}

/// True where all of a task is done.
fn done(system: &System, task: &Task) -> bool {
    let level = &system.levels[task.level];
    let wanted = outwards(task.last) + i64::from(level.keeps());
    i64::try_from(level.grown(usize::from(task.last < 0))).is_ok_and(|grown| grown >= wanted)
}

/// How many chunks outwards a chunk is.
fn outwards(n: i64) -> i64 {
    if n >= 0 { n + 1 } else { -n }
}

fn tasks(system: &System, from: SimTime, to: SimTime) -> Vec<Task> {
    let mut list = Vec::new();
    for (index, level) in system.levels.iter().enumerate() {
        let n = level.bodies.len() as f64;
        // The shortest revolution sets the steps: a chunk of the planetary level has one of them, of moons thirty-two.
        let cost = if level.keeps() { 4.0 * n * n } else { 16.0 * (5.0 + n * n) };
        let chunk =
            |t: SimTime| t.ticks.saturating_sub(system.tree.epoch.ticks).div_euclid(level.ticks).clamp(-level.reach, level.reach - 1);
        let (first, last) = (chunk(from), chunk(to));
        list.extend((last >= 0).then_some(Task { level: index, last, cost }));
        list.extend((first < 0).then_some(Task { level: index, last: first, cost }));
    }
    list
}

fn run(system: &System, task: &Task, cancel: &AtomicBool, done: &dyn Fn(f64)) {
    let count = outwards(task.last);
    let mut at = 0;
    while at < count && !cancel.load(Ordering::Relaxed) {
        let slice = SLICE.min(count - at);
        at += slice;
        system.levels[task.level].grow(system, if task.last >= 0 { at - 1 } else { -at });
        done(task.cost * slice as f64);
    }
}
