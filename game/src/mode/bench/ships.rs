//! `syzygy bench ships`: what choosing the terms of gravity by an error bound costs in error and saves in time.
//!
//! Ships in several places of the system coast for thirty days under every term, and under those that count for several
//! bounds. The error is the distance from the first at the end; `method_error_m` is how far Gauss–Radau, under the plain sum of
//! every term about one body, ends from it: what is the method's and not the choice's. CPU time is the least of several runs.
//! Beside them ten thousand pieces of debris, a day long, on one thread and on all.

use super::orbit_rows;
use crate::cli::BenchShipsArgs;
use crate::mode::Error;
use crate::mode::stage::Stage;
use crate::world::system::System;
use cpu_time::ProcessTime;
use engine::orbit::field::Bound;
use engine::orbit::integrate::Points;
use engine::orbit::integrate::gauss_radau::GaussRadau;
use engine::orbit::path::full::Full;
use engine::orbit::path::{End, Knot, Model, Path, swarm};
use engine::orbit::{BodyId, State};
use engine::space::{Centred, Position, Velocity};
use engine::time::SimTime;
use engine::units::{AU, DAY, DEG, KM};
use glam::DVec3;
use serde::Serialize;
use std::time::Instant;

/// Periapsis distance, eccentricity and inclination about a body of the system.
const SHIPS: [(&str, &str, f64, f64, f64); 8] = [
    ("low orbit of the Earth", "earth", 6_778.0 * KM, 0.001, 51.6 * DEG),
    ("half-day orbit of the Earth", "earth", 26_560.0 * KM, 0.01, 55.0 * DEG),
    ("past the Moon", "earth", 30_000.0 * KM, 0.85, 20.0 * DEG),
    ("low orbit of the Moon", "moon", 1_850.0 * KM, 0.01, 80.0 * DEG),
    ("orbit of Mars", "mars", 4_000.0 * KM, 0.3, 30.0 * DEG),
    ("among Jupiter's moons", "jupiter", 5.0e5 * KM, 0.1, 2.0 * DEG),
    ("between Earth and Mars", "sun", 1.2 * AU, 0.1, 1.0 * DEG),
    ("at 30 AU", "sun", 30.0 * AU, 0.05, 5.0 * DEG),
];

/// Displacements that are allowed over thirty days, m.
const BOUNDS_M: [f64; 4] = [1000.0, 10.0, 0.1, 0.001];

/// One ship under one bound.
#[derive(Clone, Debug, Serialize)]
struct Row {
    ship: &'static str,
    /// Allowed over 30 days, m; 0: every term counts.
    bound_m: f64,
    /// From the path under every term, m.
    error_m: f64,
    /// Of the path under every term from Gauss–Radau's; none where a ship changes its body or is low.
    method_error_m: Option<f64>,
    steps: u32,
    /// Third bodies a step, in the mean.
    thirds: f64,
    cpu_s: f64,
}

/// Debris about the Earth.
#[derive(Clone, Debug, Serialize)]
struct Swarm {
    particles: usize,
    days: f64,
    /// That came down to the height from which on a ship is flown.
    decayed: usize,
    threads: usize,
    wall_s: f64,
    wall_on_one_thread_s: f64,
    /// Whether both runs gave the same bits.
    same_bits: bool,
}

/// What is written.
#[derive(Clone, Debug, Serialize)]
struct Report {
    terms: Vec<Row>,
    swarm: Option<Swarm>,
}

/// Measures and writes.
///
/// # Errors
/// A system that does not load, a file that cannot be written.
pub fn run(args: &BenchShipsArgs) -> Result<(), Error> {
    let system = Stage::set(&args.places)?.system(&args.system)?;
    let mut rows = Vec::new();
    for ship in SHIPS {
        if let Some(host) = system.find(ship.1) {
            rows.extend(measure(&system, host, ship));
        }
    }
    let swarm = system.find("earth").map(|host| debris(&system, host));
    Ok(orbit_rows::write(&Report { terms: rows, swarm }, args.json.as_deref())?)
}

/// A shell that broke up in low orbit: ten thousand pieces thrown every way at up to 200 m/s.
fn debris(system: &System, host: BodyId) -> Swarm {
    const PARTICLES: u32 = 10_000;
    let epoch = SimTime::from_jd_tdb(2_461_284.5);
    let until = epoch.plus(60 * 86_400);
    let radius = 7_000.0 * KM;
    let speed = (system.body(host).gm_m3_s2 / radius).sqrt();
    let piece = |i: u32| {
        // A Fibonacci spiral of directions; speeds by the golden ratio's other multiples.
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(PARTICLES);
        let (s, c) = libm::sincos(2.399_963_229_728_653 * f64::from(i));
        let kick = 200.0 * libm::fmod(f64::from(i) * 0.754_877_666_246_693, 1.0);
        let ring = (1.0 - z * z).sqrt();
        let velocity = DVec3::new(0.0, speed * 0.8, speed * 0.6) + DVec3::new(ring * c, ring * s, z) * kick;
        Knot::new(host, epoch, &State { position: Position::xyz(radius, 0.0, 0.0), velocity: Velocity::new(velocity) })
    };
    let pieces: Vec<Knot> = (0..PARTICLES).map(piece).collect();
    let run = || {
        let begun = Instant::now();
        (swarm::propagate(&system.gravity, &system.ephemeris, &pieces, until, 100_000), begun.elapsed().as_secs_f64())
    };
    let (all, wall_s) = run();
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_or_else(|_| run(), |pool| pool.install(run));
    Swarm {
        particles: pieces.len(),
        days: until.since(epoch) / DAY,
        decayed: all.iter().filter(|(_, end)| *end == End::Low).count(),
        threads: rayon::current_num_threads(),
        wall_s,
        wall_on_one_thread_s: one.1,
        same_bits: all == one.0,
    }
}

/// Where a coast led, in how many steps, with how many third bodies in all, in how much time.
struct Flown {
    place: DVec3,
    steps: u32,
    thirds: usize,
    low: bool,
    cpu_s: f64,
}

fn fly(system: &System, model: &Model, start: Knot, until: SimTime) -> Flown {
    let mut best: Option<Flown> = None;
    for _ in 0..5 {
        let begun = ProcessTime::now();
        let mut path = Path::new(model, &system.ephemeris, start);
        let (mut steps, mut thirds, mut low) = (1, 0, false);
        while !path.step().covers(until) && !low {
            low = path.next(model, &system.ephemeris).is_some_and(|e| e.end == End::Low);
            steps += 1;
            let r = path.knot().position.high.length();
            thirds += model.field(path.host()).map_or(0, |f| f.terms(r, r).perturbers);
        }
        let cpu_s = begun.elapsed().as_secs_f64();
        let from_start = system.ephemeris.relative(path.host(), start.host, until).position.0;
        if best.as_ref().is_none_or(|b| cpu_s < b.cpu_s) {
            best = Some(Flown { place: path.sample(until).position.0 + from_start, steps, thirds, low, cpu_s });
        }
    }
    best.unwrap_or(Flown { place: DVec3::ZERO, steps: 0, thirds: 0, low: true, cpu_s: 0.0 })
}

fn measure(system: &System, host: BodyId, ship: (&'static str, &str, f64, f64, f64)) -> Vec<Row> {
    let (name, _, q, e, inclination) = ship;
    let (s, c) = libm::sincos(inclination);
    let speed = (system.body(host).gm_m3_s2 * (1.0 + e) / q).sqrt();
    let state = State::<Centred> { position: Position::xyz(q, 0.0, 0.0), velocity: Velocity::xyz(0.0, speed * c, speed * s) };
    // 2026-09-01.
    let epoch = SimTime::from_jd_tdb(2_461_284.5);
    let until = epoch.plus(60 * 86_400 * 30);
    let start = Knot::new(host, epoch, &state);
    let everything = system.gravity.bounded(Bound { position_m: 0.0, over_s: 30.0 * DAY });
    let full = fly(system, &everything, start, until);
    let plain = Full { model: &everything, places: &system.ephemeris, host, epoch: epoch.into() };
    let mut points = Points { t: 0.0, q: vec![state.position.0], v: vec![state.velocity.0] };
    GaussRadau::new(1, GaussRadau::TOLERANCE).run(&plain, &mut points, 30.0 * DAY);
    let method_error_m = Some((points.q[0] - full.place).length()).filter(|x| x.is_finite() && !full.low);
    let row = |bound_m: f64, f: &Flown| Row {
        ship: name,
        bound_m,
        error_m: (f.place - full.place).length(),
        method_error_m,
        steps: f.steps,
        thirds: f.thirds as f64 / f64::from(f.steps.max(1)),
        cpu_s: f.cpu_s,
    };
    let mut rows = vec![row(0.0, &full)];
    for bound_m in BOUNDS_M {
        let model = system.gravity.bounded(Bound { position_m: bound_m, over_s: 30.0 * DAY });
        rows.push(row(bound_m, &fly(system, &model, start, until)));
    }
    rows
}
