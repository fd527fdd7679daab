//! `syzygy replay`: plays recorded flights and compares every state hash; one JSON line per flight on stdout.
//!
//! Not here: how a log is read ([`crate::replay::log`]) and compared ([`crate::replay::player`]).

use crate::cli::ReplayArgs;
use crate::mode::Error;
use crate::replay::{Divergence, Log, LogError, Player, dump};
use crate::save::{self, SaveV1};
use crate::session::Session;
use crate::world::World;
use crate::world::readout::Readout;
use engine::units::DEG;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::path::Path;
use std::process::ExitCode;

/// Exit code when a flight was not the recorded one.
pub const DIVERGED: u8 = 3;
/// Ticks between two looks at the progress bar.
const PROGRESS_TICKS: u64 = 600;

/// Gives a World its assets: from what a save says to the World, or why not.
pub type Opener<'a> = &'a mut dyn FnMut(&SaveV1) -> Result<World, Error>;

/// How a flight went.
pub struct Played {
    /// The World at its end.
    pub world: World,
    /// Ticks flown.
    pub ticks: u64,
    /// Where it parted from the record, if it did.
    pub diverged: Option<Divergence>,
}

/// Plays or dumps all files. One that cannot be played is reported, and the others are played all the same.
pub fn run(args: &ReplayArgs, open: Opener<'_>) -> ExitCode {
    let (mut broken, mut diverged) = (false, false);
    for path in &args.files {
        let outcome = if args.dump { show(path) } else { one(path, args.heavy, open) };
        match outcome {
            Ok(same) => diverged |= !same,
            Err(error) => {
                broken = true;
                eprintln!("{:?}", miette::Report::new(error));
            }
        }
    }
    match (diverged, broken) {
        (true, _) => ExitCode::from(DIVERGED),
        (false, true) => ExitCode::FAILURE,
        (false, false) => ExitCode::SUCCESS,
    }
}

fn show(path: &Path) -> Result<bool, Error> {
    print!("{}", dump::text(&Log::read(path)?));
    Ok(true)
}

fn one(path: &Path, heavy: Option<u32>, open: Opener<'_>) -> Result<bool, Error> {
    let log = Log::read(path)?;
    let bar = ProgressBar::new(log.ticks);
    let style = ProgressStyle::with_template("{elapsed_precise} {bar:40} {pos}/{len} ticks, {eta} to go");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let begun = std::time::Instant::now();
    let played = play(path, log, heavy, open, &mut |tick| {
        if tick % PROGRESS_TICKS == 0 {
            bar.set_position(tick);
        }
    })?;
    bar.finish_and_clear();
    let wall_s = begun.elapsed().as_secs_f64();
    if let Some(d) = &played.diverged {
        eprintln!("{}: {d}", path.display());
    }
    println!("{}", summary(path, &played, wall_s));
    Ok(played.diverged.is_none())
}

/// Plays one log to its end, or to where it parts from the record. `heavy`: save and load in memory every so many ticks.
///
/// # Errors
/// [`Error`] when the log's start cannot be opened with the assets at hand, or does not survive saving and loading.
pub fn play(path: &Path, log: Log, heavy: Option<u32>, open: Opener<'_>, progress: &mut dyn FnMut(u64)) -> Result<Played, Error> {
    let contents = |problems| LogError::Contents { path: path.to_owned(), problems };
    let start = save::decode(&log.start).map_err(contents)?;
    let world = open(&start)?;
    log.check_assets(path, &world)?;
    let mut session = Session::new(world);
    let mut player = Player::new(log);
    while let Some(commands) = player.next_commands() {
        session.tick(&commands);
        if heavy.is_some_and(|k| player.tick().is_multiple_of(u64::from(k))) {
            session.world = save::round_trip(&session.world).map_err(contents)?;
        }
        if let Some(found) = player.compare(&session.world) {
            return Ok(Played { ticks: player.tick(), world: session.world, diverged: Some(found) });
        }
        progress(player.tick());
    }
    Ok(Played { ticks: player.tick(), world: session.world, diverged: None })
}

/// How a flight ended, as one line of JSON.
fn summary(path: &Path, played: &Played, wall_s: f64) -> serde_json::Value {
    let r: Readout = played.world.readout();
    let tilt_deg = r.markers.zenith.y.clamp(-1.0, 1.0);
    json!({
        "file": path.display().to_string(),
        "same": played.diverged.is_none(),
        "ticks": played.ticks,
        "wall_s": wall_s,
        "times_real_time": played.ticks as f64 / 60.0 / wall_s.max(1e-9),
        "end": {
            "utc": r.time.utc().to_string(),
            "body": played.world.system.body(r.body).key,
            "situation": format!("{:?}", r.situation),
            "altitude_m": r.altitude_m,
            "lat_deg": r.lat_lon_rad.0 / DEG,
            "lon_deg": r.lat_lon_rad.1 / DEG,
            "surface_speed_m_s": r.surface_speed_m_s,
            "tilt_deg": libm::acos(tilt_deg) / DEG,
            "touchdown_m_s": r.last_contact.map(|c| c.0),
            "periapsis_m": r.orbit.periapsis_m,
            "apoapsis_m": r.orbit.apoapsis_m,
            "to_target_m": r.target.and_then(|t| t.ground_distance_m),
        },
    })
}
