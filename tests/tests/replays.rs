//! The recorded flights in `tests/replays/`: each replays bit for bit, also saved and loaded on the way, and ends as it should.
//!
//! After a change to the World that is meant to change flights: `cargo test -p tests --test replays -- --ignored record` flies and
//! records them again. After one to asset files that changes none: `… -- --ignored restamp` proves that they fly as before, bit for
//! bit, and has them name the assets of today.

use game::cli::Places;
use game::mode::replay::{Played, play};
use game::mode::stage::Stage;
use game::replay::{Log, recorder};
use game::world::World;
use game::world::readout::{Readout, Situation};
use std::path::{Path, PathBuf};
use tests::flights::{FLIGHTS, Pilot};

/// Largest file of a recorded flight, bytes.
const LARGEST: u64 = 200 << 10;

fn path_of(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("replays/{name}.syzlog"))
}

fn stage() -> Stage {
    Stage::set(&Places { safe_mode: true, ..Places::default() }).unwrap_or_else(|e| panic!("{e}"))
}

/// Plays a flight, plain and heavy; both must be the recorded one. The last World, for judging.
fn flown(name: &str) -> World {
    let path = path_of(name);
    let length = std::fs::metadata(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display())).len();
    assert!(length < LARGEST, "{name}: {length} bytes");
    let stage = stage();
    let one = |heavy: Option<u32>| -> Played {
        let log = Log::read(&path).unwrap_or_else(|e| panic!("{e}"));
        let played = play(&path, log, heavy, &mut |save| stage.world(save), &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
        assert!(played.diverged.is_none(), "{name} (heavy: {heavy:?}): {}", played.diverged.unwrap());
        played
    };
    let heavy = one(Some(997));
    let plain = one(None);
    assert_eq!(plain.world.fields(), heavy.world.fields(), "{name}");
    plain.world
}

/// Stands upright and still, within 5 km of the spot, after a gentle touchdown.
fn judge_landing(r: &Readout) {
    assert_eq!(r.situation, Situation::Landed);
    // The cosine of the tilt: 0.966 is 15°.
    let upright = r.markers.zenith.y;
    assert!(upright > 0.966, "tilt {upright}");
    assert!(r.surface_speed_m_s < 1e-6 && r.throttle == 0.0, "{} m/s, throttle {}", r.surface_speed_m_s, r.throttle);
    let off = r.target.and_then(|t| t.ground_distance_m).expect("the spot is on this body");
    assert!(off < 5_000.0, "{off} m from the spot");
    let (touchdown, _) = r.last_contact.expect("it touched down");
    assert!(touchdown < 3.0, "touchdown at {touchdown} m/s");
    println!("upright {upright:.5}, {off:.1} m from the spot, touchdown at {touchdown:.2} m/s");
}

#[test]
fn orbit_to_surface() {
    judge_landing(&flown("orbit_to_surface").readout());
}

#[test]
fn landed_on_moon() {
    judge_landing(&flown("landed_on_moon").readout());
}

#[test]
fn takeoff_to_orbit() {
    let r = flown("takeoff_to_orbit").readout();
    assert_eq!(r.situation, Situation::Coasting);
    assert!(r.orbit.periapsis_m > 140e3 && r.orbit.eccentricity < 0.05, "{:?}", r.orbit);
}

#[test]
fn save_load_midflight() {
    let world = flown("save_load_midflight");
    let log = Log::read(&path_of("save_load_midflight")).unwrap();
    let loads = log.actions.iter().filter(|(_, a)| *a == game::command::Action::Quickload).count();
    assert_eq!(loads, 2);
    assert!(world.readout().density_kg_m3 > 0.0, "it ends in the air");
}

#[test]
fn gamepad_flight() {
    flown("gamepad_flight");
    let log = Log::read(&path_of("gamepad_flight")).unwrap();
    assert!(log.runs.iter().any(|r| r.axes.pitch != 0) && log.runs.iter().any(|r| r.axes.roll != 0), "the sticks moved");
    assert!(log.actions.iter().any(|(_, a)| matches!(a, game::command::Action::Gear(_))), "a button was pressed");
}

#[test]
#[ignore = "flies and records the reference flights again"]
fn record() {
    let stage = stage();
    let only = std::env::var("SYZYGY_FLIGHT").ok();
    for flight in FLIGHTS.iter().filter(|f| only.as_deref().is_none_or(|o| o == f.name)) {
        let start = (flight.start)();
        let system = stage.system(&start.system).unwrap_or_else(|e| panic!("{e}"));
        let ship = stage.assets.ship(&start.ship).unwrap_or_else(|e| panic!("{e}"));
        let world = World::from_start(system, ship, &start).unwrap_or_else(|e| panic!("{}: {e}", flight.name));
        let header = recorder::header(&world);
        let mut pilot = Pilot::new(world);
        (flight.fly)(&mut pilot);
        let (log, _) = pilot.finish();
        let path = path_of(flight.name);
        log.write(&path, &header).unwrap_or_else(|e| panic!("{e}"));
        println!("{}: {} ticks, {} bytes", flight.name, log.ticks, std::fs::metadata(&path).map_or(0, |m| m.len()));
    }
}

#[test]
#[ignore = "puts the hashes of the present assets into recorded flights that fly as before"]
fn restamp() {
    let stage = stage();
    for flight in FLIGHTS {
        let path = path_of(flight.name);
        let mut log = Log::read(&path).unwrap_or_else(|e| panic!("{e}"));
        let state = game::save::decode(&log.start).unwrap_or_else(|e| panic!("{e:?}"));
        let world = stage.world(&state).unwrap_or_else(|e| panic!("{e}"));
        log.system_hash.clone_from(&world.system.hash);
        let played = play(&path, log.clone(), None, &mut |save| stage.world(save), &mut |_| {}).unwrap_or_else(|e| panic!("{e}"));
        assert!(played.diverged.is_none(), "{} is another flight now: {}", flight.name, played.diverged.unwrap());
        log.write(&path, &recorder::header(&world)).unwrap_or_else(|e| panic!("{e}"));
    }
}
