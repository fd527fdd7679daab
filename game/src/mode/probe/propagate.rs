//! `syzygy probe propagate`: a case of orbital motion by any method; the end, the energy's error and the cost as JSON.

use super::super::bench::orbit_case::Case;
use super::super::bench::orbit_method::{Method, Setting};
use engine::orbit::integrate::Points;
use serde::Serialize;
use std::io::{self, Write};
use std::time::Instant;

#[derive(Serialize)]
struct State<'a> {
    name: &'a str,
    position: [f64; 3],
    velocity: [f64; 3],
}

#[derive(Serialize)]
struct Answer<'a> {
    case: &'a str,
    method: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dt: Option<f64>,
    t: f64,
    /// False where a collision stopped the run before the case's end.
    complete: bool,
    final_states: Vec<State<'a>>,
    relative_energy_error: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    position_error: Option<f64>,
    evaluations: u64,
    steps: u64,
    rejected: u64,
    wall_s: f64,
}

/// Runs the case and writes the answer; units are the case's.
pub fn write(case: &Case, method: Method, setting: Setting, out: &mut dyn Write) -> io::Result<()> {
    let mut points: Points = case.start.clone();
    let start = Instant::now();
    let work = method.run(&case.gm, &mut points, setting, case.t_end);
    let wall_s = start.elapsed().as_secs_f64();
    let before = case.energy(&case.start);
    let finite = |x: f64| x.is_finite().then_some(x);
    let state = |i: usize| State { name: &case.bodies[i], position: points.q[i].to_array(), velocity: points.v[i].to_array() };
    let (tolerance, dt) = match setting {
        Setting::Tolerance(x) => (Some(x), None),
        Setting::Step(x) => (None, Some(x)),
    };
    let answer = Answer {
        case: &case.name,
        method: method.name(),
        tolerance,
        dt,
        t: points.t,
        complete: points.t == case.t_end,
        final_states: (0..case.gm.len()).map(state).collect(),
        relative_energy_error: finite((case.energy(&points) - before) / before),
        position_error: finite(case.position_error(&points)),
        evaluations: work.evaluations,
        steps: work.steps,
        rejected: work.rejected,
        wall_s,
    };
    serde_json::to_writer_pretty(&mut *out, &answer)?;
    writeln!(out)
}
