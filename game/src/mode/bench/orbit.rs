//! `syzygy bench orbit`: every integrator on every case of the reference data, error against CPU time and evaluations.
//!
//! CPU time is the process's, of the run alone, the least of several. Methods are measured one after the other on one core.
//! Not here: cases (`orbit_case`), methods (`orbit_method`), pictures (`orbit_plot`), what breaks integrators (`orbit_stress`).

use super::orbit_case::{self, Case};
use super::orbit_method::{self, Method, Setting};
use super::orbit_rows::{self, Row};
use super::{orbit_plot, orbit_stress};
use crate::cli::BenchOrbitArgs;
use crate::mode::Error;
use cpu_time::ProcessTime;
use indicatif::{ProgressBar, ProgressStyle};

/// A run is repeated until this much time has gone, s, …
const LONG_ENOUGH_S: f64 = 0.3;
/// … but no more often than this.
const MOST_REPEATS: u32 = 7;

/// Measures and writes what was asked for.
///
/// # Errors
/// Unknown cases and methods, files that cannot be read or written.
pub fn run(args: &BenchOrbitArgs) -> Result<(), Error> {
    if args.stress {
        return Ok(orbit_rows::write(&orbit_stress::run(), args.json.as_deref())?);
    }
    let names: Vec<String> = if args.case.is_empty() { orbit_case::known().map(str::to_owned).to_vec() } else { args.case.clone() };
    let cases = names.iter().map(|name| orbit_case::reference(name)).collect::<Result<Vec<_>, _>>()?;
    let methods = if args.method.is_empty() {
        orbit_method::all()
    } else {
        args.method.iter().map(|m| Method::find(m)).collect::<Result<Vec<_>, _>>()?
    };
    let peers = args.peers.as_deref().map(orbit_rows::peers).transpose()?.unwrap_or_default();
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new((cases.len() * methods.len()) as u64).with_style(style);
    let mut rows = Vec::new();
    for case in &cases {
        let mut own = Vec::new();
        for method in &methods {
            bar.set_message(format!("{} {}", case.name, method.name()));
            if suits(method, case) {
                own.extend(settings(method, case, args.most).into_iter().map(|setting| measure(case, *method, setting)));
            }
            bar.inc(1);
        }
        if let Some(folder) = &args.plot {
            // Our own rows may lie among them, as measured in the same run.
            let theirs: Vec<Row> = peers.iter().filter(|r| r.case == case.name && Method::find(&r.method).is_err()).cloned().collect();
            orbit_plot::draw(folder, case, &own, &theirs, &orbit_rows::anchors(&case.name))?;
        }
        rows.extend(own);
    }
    bar.finish_and_clear();
    Ok(orbit_rows::write(&rows, args.json.as_deref())?)
}

/// Wisdom–Holman is for systems in which everything goes around something and never meets: not for three equal masses, nor for a
/// ship that passes close to the second primary.
fn suits(method: &Method, case: &Case) -> bool {
    let meets = ["ARENSTORF", "PYTHAG", "FIG8"].iter().any(|name| case.name.starts_with(name));
    !(matches!(method, Method::WisdomHolman(_)) && meets)
}

/// What a method is tried with: tolerances, or steps that are each half the one before until a run takes `most` evaluations.
fn settings(method: &Method, case: &Case, most: u64) -> Vec<Setting> {
    let decades = |from: i32, to: i32| (from..=to).map(|k| Setting::Tolerance(libm::exp10(-f64::from(k)))).collect();
    match method {
        Method::GaussRadau => decades(4, 10),
        // Order 5 takes ten times the steps for two digits and a half: beyond eleven it is a bench of patience.
        Method::DormandPrince(pair) if pair.table.order < 8 => decades(5, 11),
        Method::DormandPrince(_) => decades(6, 15),
        Method::Taylor => decades(8, 20),
        Method::Composition(_) | Method::WisdomHolman(_) => {
            let span = (case.t_end - case.start.t).abs();
            let period = case.period.unwrap_or(span);
            let stages = method.stages() as f64;
            // Evaluations in a period: from what barely resolves it.
            let first = if matches!(method, Method::WisdomHolman(_)) { 12.0 } else { 30.0_f64.max(2.0 * stages) };
            let mut steps = (span / period * first / stages).max(1.0);
            let mut all = Vec::new();
            while steps * stages <= most as f64 {
                all.push(Setting::Step(span / steps.round()));
                steps *= 2.0;
            }
            all
        }
    }
}

/// One row: the least CPU time of several runs.
fn measure(case: &Case, method: Method, setting: Setting) -> Row {
    let (mut least, mut spent) = (f64::INFINITY, 0.0);
    let mut points = case.start.clone();
    let mut work = Default::default();
    for _ in 0..MOST_REPEATS {
        points.clone_from(&case.start);
        let start = ProcessTime::now();
        work = method.run(&case.gm, &mut points, setting, case.t_end);
        let took = start.elapsed().as_secs_f64();
        least = least.min(took);
        spent += took;
        if spent > LONG_ENOUGH_S {
            break;
        }
    }
    let finite = |x: f64| x.is_finite().then_some(x);
    let before = case.energy(&case.start);
    let reached = points.t == case.t_end;
    Row {
        case: case.name.clone(),
        method: method.name(),
        options: match setting {
            Setting::Tolerance(x) => format!("tol={x:e}"),
            Setting::Step(x) => format!("dt={x}"),
        },
        cpu_s: least,
        force_evals: method.counts_forces().then_some(work.evaluations as f64),
        steps: work.steps as f64,
        position_error: finite(case.position_error(&points)).filter(|_| reached),
        energy_error: finite((case.energy(&points) - before) / before).filter(|_| reached),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_settings_for_every_case_that_suits_it() {
        for name in orbit_case::known() {
            let case = orbit_case::reference(name).unwrap();
            for method in orbit_method::all().into_iter().filter(|m| suits(m, &case)) {
                assert!(settings(&method, &case, 2_000_000).len() >= 3, "{name} {}", method.name());
            }
        }
    }

    #[test]
    fn a_row_says_what_a_run_reached() {
        let case = orbit_case::reference("ARENSTORF_1T").unwrap();
        let row = measure(&case, Method::GaussRadau, Setting::Tolerance(1e-9));
        assert!(row.position_error.unwrap() < 4e-13 && row.cpu_s < 1.0 && row.force_evals.unwrap() > 1000.0, "{row:?}");
    }
}
