//! The program as a tool sees it: what bad arguments, saves and logs get, run through the real binary.
//!
//! Every case ends in a message that names what and where, an exit code that is not 0, and no panic.

use engine::time::SimTime;
use game::command::{Action, Axes, Guidance, Hold};
use game::replay::Log;
use game::replay::log::{Check, Run};
use game::save::format::{self, Header, LOG, SAVE};
use game::save::v1::{MotionV1, RestingV1, SaveV1, ShipV1};
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn syzygy(dir: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_syzygy"))
        .args(args)
        .current_dir(dir)
        .env_remove("SYZYGY_ASSETS")
        .env("SYZYGY_DATA_DIR", dir)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

/// Runs in a fresh folder that `prepare` fills, and holds the outcome against what is expected.
fn expect(prepare: fn(&Path), args: &[&str], code: i32, words: &[&str]) {
    let dir = tempfile::tempdir().unwrap();
    prepare(dir.path());
    let out = syzygy(dir.path(), args);
    // The report breaks lines at the terminal's width: compare without what breaking adds.
    let flat = |s: &str| s.chars().filter(|c| !c.is_whitespace() && !"│╰─×├▶".contains(*c)).collect::<String>();
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(code), "{said}");
    for word in words {
        assert!(flat(&said).contains(&flat(word)), "`{word}` is not in:\n{said}");
    }
    assert!(!said.contains("panicked"), "{said}");
    assert!(code == 0 || out.stdout.is_empty(), "an error must not look like an answer on stdout");
}

fn header() -> Header {
    Header { written_unix_s: 0, sequence: 1, time: SimTime::from_ticks(5), body: "earth".into(), altitude_m: 2.0 }
}

/// A ship that stands on the Earth; its numbers are sound.
fn state() -> SaveV1 {
    SaveV1 {
        game_version: "0.1.0".into(),
        system: "sol".into(),
        system_hash: "0".repeat(64),
        ship_key: "torch".into(),
        time_ticks: 50_399_999_999,
        quarters: 0,
        warp: 2,
        warp_asked: 2,
        target: None,
        warp_to_ticks: None,
        ship: ShipV1 {
            motion: MotionV1::Landed(RestingV1 {
                body: "earth".into(),
                position_m: [6_371_005.0, 0.0, 0.0],
                attitude: [0.0, 0.0, 0.0, 1.0],
            }),
            propellant_kg: 1000.0,
            throttle: 0,
            nozzle: 0.0,
            gear_down: true,
            hold: Hold::Rate,
            held: None,
            guidance: Guidance::Manual,
            landing: None,
            ground: Default::default(),
            effort: [0.0; 3],
            last_contact: None,
            nodes: Vec::new(),
            burn: None,
        },
    }
}

fn save_bytes(state: &SaveV1) -> Vec<u8> {
    format::wrap(SAVE, &header(), &rmp_serde::to_vec_named(state).unwrap()).unwrap()
}

fn log() -> Log {
    Log {
        game_version: "0.1.0".into(),
        system: "sol".into(),
        system_hash: "0".repeat(64),
        ship: "torch".into(),
        ship_hash: "0".repeat(64),
        start: rmp_serde::to_vec_named(&state()).unwrap(),
        ticks: 120,
        runs: vec![Run { ticks: 120, axes: Axes::default() }],
        actions: vec![(3, Action::Throttle(9))],
        checks: vec![Check { tick: 60, hashes: vec![0; 6] }, Check { tick: 120, hashes: vec![0; 6] }],
        names: Vec::new(),
        rows: Vec::new(),
    }
}

fn write(dir: &Path, name: &str, bytes: &[u8]) {
    fs::write(dir.join(name), bytes).unwrap();
}
fn bent(bytes: Vec<u8>, change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = bytes;
    change(&mut bytes);
    bytes
}
fn nothing(_: &Path) {}

macro_rules! cases {
    ($($name:ident: $prepare:expr, [$($arg:expr),*] => $code:literal, [$($word:expr),*];)*) => {$(
        #[test]
        fn $name() {
            expect($prepare, &[$($arg),*], $code, &[$($word),*]);
        }
    )*};
}

cases! {
    // Arguments.
    an_unknown_subcommand: nothing, ["reply"] => 2, ["unrecognized subcommand 'reply'", "replay"];
    an_unknown_option: nothing, ["headless", "--tick", "5"] => 2, ["unexpected argument '--tick'", "--ticks"];
    negative_ticks: nothing, ["headless", "--ticks=-5"] => 2, ["invalid value '-5' for '--ticks <N>'"];
    endless_ticks: nothing, ["headless", "--ticks", "99999999999999"] => 2, ["'99999999999999'", "--ticks"];
    ticks_that_are_no_number: nothing, ["headless", "--ticks", "many"] => 2, ["'many'", "--ticks"];
    no_ticks_at_all: nothing, ["headless"] => 2, ["--ticks <N>"];
    a_size_of_nothing: nothing, ["shot", "--size", "0x0", "--out", "a.png"] => 2, ["'0x0'", "for example 1280x720"];
    a_size_without_height: nothing, ["shot", "--size", "640", "--out", "a.png"] => 2, ["'640'", "WIDTHxHEIGHT"];
    a_size_beyond_any_card: nothing, ["play", "--size", "90000x90000"] => 2, ["'90000x90000'", "16384"];
    a_picture_in_no_format_of_ours: nothing, ["shot", "--size", "4x4", "--out", "a.jpg"] => 2, ["'a.jpg'", ".png or .exr"];
    a_julian_date_that_is_no_number: nothing, ["shot", "--tdb", "NaN", "--size", "4x4", "--out", "a.png"] => 2, ["'NaN'", "Julian date"];
    a_julian_date_beyond_belief: nothing, ["probe", "ephemeris", "--body", "moon", "--tdb", "1e300"] => 2, ["'1e300'", "100,000 years"];
    an_infinite_altitude: nothing, ["probe", "air", "--body", "earth", "--altitude-m", "inf"] => 2, ["'inf'", "finite number"];
    a_probe_without_a_body: nothing, ["probe", "air", "--altitude-m", "0"] => 2, ["--body <B>"];
    an_unknown_backend: nothing, ["play", "--backend", "glide"] => 2, ["'glide'", "vulkan"];
    a_replay_of_nothing: nothing, ["replay"] => 2, ["<FILE>..."];
    heavy_every_zero_ticks: nothing, ["replay", "--heavy=0", "a.syzlog"] => 2, ["'0'", "--heavy"];
    assets_that_are_not_there: nothing, ["headless", "--ticks", "1", "--assets", "no/such/place"] => 1, ["no/such/place", "--assets DIR"];
    a_mod_that_is_not_there: nothing, ["headless", "--ticks", "1", "--mods", "no/such/mod"] => 1, ["no/such/mod", "expected a folder for --mods"];
    a_start_that_does_not_exist: nothing, ["headless", "--ticks", "1", "--start", "eclips"] => 1, ["eclips", "did you mean `eclipse`?"];
    a_start_file_that_is_missing: nothing, ["headless", "--ticks", "1", "--start", "gone.toml"] => 1, ["gone.toml", "cannot be read"];
    a_start_file_with_a_wrong_word: |d| write(d, "mine.toml", START.replace("\"orbit\"", "\"orbits\"").as_bytes()),
        ["headless", "--ticks", "1", "--start", "mine.toml"] => 1, ["mine.toml:9", "did you mean `orbit`?"];
    a_start_file_of_another_name: |d| write(d, "yours.toml", START.as_bytes()),
        ["headless", "--ticks", "1", "--start", "./yours.toml"] => 1, ["yours.toml:1", "expected the file's name"];
    a_camera_that_does_not_exist: nothing, ["shot", "--camera", "chaise", "--size", "4x4", "--out", "a.png"] => 1, ["chaise", "chase"];
    a_body_that_does_not_exist: nothing, ["probe", "air", "--body", "erth", "--altitude-m", "0"] => 1, ["erth", "did you mean `earth`?"];

    // Saves.
    a_save_that_is_missing: nothing, ["headless", "--ticks", "1", "--start", "gone.syzsave"] => 1, ["gone.syzsave", "cannot read it"];
    a_folder_for_a_save: |d| fs::create_dir(d.join("a.syzsave")).unwrap(), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1, ["a.syzsave", "it is a folder"];
    an_empty_save: |d| write(d, "a.syzsave", b""), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1, ["a.syzsave", "byte 0: the save ends here"];
    a_text_for_a_save: |d| write(d, "a.syzsave", b"[start]\nname = 'x'\n"), ["headless", "--ticks", "1", "--start", "./a.syzsave"] => 1,
        ["a.syzsave", "byte 0: this is not a Syzygy save", "SYZYSAVE"];
    a_log_for_a_save: |d| write(d, "a.syzsave", &log().to_bytes(&header()).unwrap()), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1,
        ["byte 0: this is not a Syzygy save", "SYZYGLOG"];
    a_save_cut_in_its_header: |d| write(d, "a.syzsave", &save_bytes(&state())[..40]), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1,
        ["a.syzsave", "byte 40: the save ends here", "cut off"];
    a_save_cut_in_its_payload: |d| write(d, "a.syzsave", &save_bytes(&state())[..150]), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1,
        ["a.syzsave", "byte 150: the save ends here"];
    a_save_with_a_flipped_bit: |d| write(d, "a.syzsave", &bent(save_bytes(&state()), |b| b[140] ^= 4)), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1,
        ["a.syzsave", "checksum", "it is damaged"];
    a_save_of_a_newer_program: |d| write(d, "a.syzsave", &bent(save_bytes(&state()), |b| b[8] = 7)), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1,
        ["a.syzsave", "format 7", "use a newer Syzygy", "untouched"];
    a_save_that_claims_the_moon: |d| write(d, "a.syzsave", &bent(save_bytes(&state()), |b| b[44..52].fill(0xff))), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1,
        ["a.syzsave", "byte 44", "it claims 18446744073709551615 bytes"];
    a_sound_container_of_nonsense: |d| write(d, "a.syzsave", &format::wrap(SAVE, &header(), b"nonsense").unwrap()), ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1,
        ["a.syzsave", "not a state of format 1"];
    a_state_with_nan: |d| write(d, "a.syzsave", &save_bytes(&SaveV1 { ship: ShipV1 { nozzle: f64::NAN, ..state().ship }, ..state() })),
        ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1, ["a.syzsave", "ship.nozzle: NaN, expected 0 to 1"];
    a_state_about_an_unknown_body: |d| {
        let motion = MotionV1::Landed(RestingV1 { body: "earht".into(), position_m: [7e6, 0.0, 0.0], attitude: [0.0, 0.0, 0.0, 1.0] });
        write(d, "a.syzsave", &save_bytes(&SaveV1 { ship: ShipV1 { motion, ..state().ship }, ..state() }));
    }, ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1, ["a.syzsave", "ship.motion.Landed.body", "did you mean `earth`?"];
    a_save_of_an_unknown_system: |d| write(d, "a.syzsave", &save_bytes(&SaveV1 { system: "soll".into(), ..state() })),
        ["headless", "--ticks", "1", "--start", "a.syzsave"] => 1, ["soll"];
    a_save_that_cannot_be_written: |d| write(d, "wall", b"a file where a folder should be"),
        ["headless", "--ticks", "1", "--save", "wall/out.syzsave"] => 1, ["wall/out.syzsave", "cannot"];

    // Replay logs.
    a_log_that_is_missing: nothing, ["replay", "gone.syzlog"] => 1, ["gone.syzlog", "cannot read it"];
    a_folder_for_a_log: |d| fs::create_dir(d.join("a.syzlog")).unwrap(), ["replay", "a.syzlog"] => 1, ["a.syzlog", "it is a folder"];
    an_empty_log: |d| write(d, "a.syzlog", b""), ["replay", "a.syzlog"] => 1, ["a.syzlog", "byte 0: the replay log ends here"];
    a_save_for_a_log: |d| write(d, "a.syzlog", &save_bytes(&state())), ["replay", "a.syzlog"] => 1, ["a.syzlog", "not a Syzygy replay log"];
    a_log_cut_off: |d| write(d, "a.syzlog", &log().to_bytes(&header()).unwrap()[..160]), ["replay", "a.syzlog"] => 1, ["a.syzlog", "byte 160: the replay log ends here"];
    a_log_with_a_flipped_bit: |d| write(d, "a.syzlog", &bent(log().to_bytes(&header()).unwrap(), |b| b[170] ^= 1)), ["replay", "a.syzlog"] => 1, ["a.syzlog", "checksum"];
    a_log_of_a_newer_program: |d| write(d, "a.syzlog", &bent(log().to_bytes(&header()).unwrap(), |b| b[9] = 1)), ["replay", "a.syzlog"] => 1, ["a.syzlog", "format 257"];
    a_log_of_nonsense: |d| write(d, "a.syzlog", &format::wrap(LOG, &header(), &[0xff; 300]).unwrap()), ["replay", "a.syzlog"] => 1, ["a.syzlog", "not a replay of format 1"];
    a_log_whose_runs_do_not_add_up: |d| write(d, "a.syzlog", &Log { ticks: 121, ..log() }.to_bytes(&header()).unwrap()), ["replay", "a.syzlog"] => 1,
        ["a.syzlog", "runs: together Some(120) ticks, expected 121"];
    a_log_with_a_broken_start: |d| write(d, "a.syzlog", &Log { start: vec![1, 2, 3], ..log() }.to_bytes(&header()).unwrap()), ["replay", "a.syzlog"] => 1,
        ["a.syzlog", "not a state of format 1"];
    a_log_of_other_assets: |d| write(d, "a.syzlog", &log().to_bytes(&header()).unwrap()), ["replay", "a.syzlog"] => 1,
        ["a.syzlog", "recorded with another system `sol`", "000000000000"];
    commands_from_a_log_that_is_broken: |d| write(d, "a.syzlog", b"SYZYGLOG"), ["headless", "--ticks", "1", "--commands", "a.syzlog"] => 1, ["a.syzlog", "cut off"];
}

#[test]
fn help_and_version_are_no_errors() {
    let dir = tempfile::tempdir().unwrap();
    for args in [&["--help"][..], &["--version"], &["headless", "--help"], &["probe", "air", "--help"]] {
        let out = syzygy(dir.path(), args);
        assert_eq!((out.status.code(), out.stderr.len()), (Some(0), 0), "{args:?}");
        assert!(!out.stdout.is_empty());
    }
}

#[test]
fn a_damaged_save_falls_back_to_its_bak_and_says_so() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), "a.syzsave", &bent(save_bytes(&state()), |b| b[130] ^= 1));
    write(dir.path(), "a.syzsave.bak", &save_bytes(&state()));
    let out = syzygy(dir.path(), &["headless", "--start", "a.syzsave", "--ticks", "1", "--save", "b.syzsave"]);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{said}");
    assert!(said.contains("checksum") && said.contains("a.syzsave.bak"), "{said}");
    assert!(dir.path().join("b.syzsave").is_file());
}

/// A start as a player writes one for himself.
const START: &str = r#"key = "mine"
name = "Mine"
description = "Over the Andes."
system = "sol"
ship = "torch"
utc = "2026-08-12T12:00:00"

[place]
kind = "orbit"
body = "earth"
altitude_m = 400000.0
lat_deg = -20.0
lon_deg = -67.0
heading_deg = 51.6
"#;

#[test]
fn a_start_file_begins_a_flight() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), "mine.toml", START.as_bytes());
    let out = syzygy(dir.path(), &["headless", "--ticks", "1", "--start", "mine.toml", "--save", "b.syzsave"]);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(dir.path().join("b.syzsave").is_file());
}

#[test]
fn a_flight_is_recorded_saved_replayed_and_dumped() {
    let dir = tempfile::tempdir().unwrap();
    let out = syzygy(dir.path(), &["headless", "--ticks", "130", "--record", "f.syzlog", "--save", "f.syzsave"]);
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let out = syzygy(dir.path(), &["replay", "f.syzlog", "--heavy=7"]);
    let line: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!((line["same"].as_bool(), line["ticks"].as_u64()), (Some(true), Some(130)), "{line}");
    let out = syzygy(dir.path(), &["replay", "--dump", "f.syzlog"]);
    assert!(String::from_utf8_lossy(&out.stdout).contains("130 ticks"));
    // One changed hash: exit code 3, the tick and the subsystem named.
    let path = dir.path().join("f.syzlog");
    let mut log = Log::read(&path).unwrap();
    log.checks[1].hashes[0] ^= 1;
    log.write(&path, &header()).unwrap();
    let out = syzygy(dir.path(), &["replay", "f.syzlog"]);
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(3), "{said}");
    assert!(said.contains("diverged at tick 120 in `time`"), "{said}");
}

/// A file of one case: two bodies, with what stands between the brackets of the second.
fn case_file(dir: &Path, second: &str) {
    let text = format!("{{\n \"bodies\": [\n  [\"Sun\", 1.0, 0, 0, 0, 0, 0, 0],\n  [{second}]\n ],\n \"T\": 6.283185307179586\n}}\n");
    fs::write(dir.join("case.json"), text).unwrap();
}

#[test]
fn a_case_of_motion_is_propagated_and_its_cost_told() {
    let dir = tempfile::tempdir().unwrap();
    case_file(dir.path(), "\"P\", 0, 1, 0, 0, 0, 1, 0");
    for (method, setting) in
        [("gauss_radau", "--tol=1e-9"), ("Dormand-Prince8", "--tol=1e-12"), ("kahan_li8_17", "--dt=0.05"), ("wisdom_holman", "--dt=1")]
    {
        let out = syzygy(dir.path(), &["probe", "propagate", "--case", "case.json", "--method", method, setting]);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.success(), "{method}: {said}");
        let answer: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
        // Once around a circle: back at the start.
        let place = answer["final_states"][1]["position"].as_array().unwrap();
        let miss = (place[0].as_f64().unwrap() - 1.0).abs() + place[1].as_f64().unwrap().abs();
        assert!(miss < 1e-9 && answer["relative_energy_error"].as_f64().unwrap().abs() < 1e-9, "{method}: {answer}");
        assert!(
            answer["evaluations"].as_u64().unwrap() > 0
                && answer["steps"].as_u64().unwrap() > 0
                && answer["wall_s"].as_f64().unwrap() > 0.0
        );
    }
}

#[test]
fn cases_and_methods_that_are_none_are_refused_by_name_and_place() {
    const GOOD: fn(&Path) = |d| case_file(d, "\"P\", 0, 1, 0, 0, 0, 1, 0");
    let propagate = |prepare: fn(&Path), more: &[&str], code: i32, words: &[&str]| {
        expect(prepare, &[&["probe", "propagate", "--case", "case.json"], more].concat(), code, words);
    };
    propagate(GOOD, &["--method", "gaus_radau"], 1, &["no method `gaus_radau`", "did you mean `gauss_radau`"]);
    propagate(GOOD, &["--method", "gauss_radau", "--tol=-1e-9"], 2, &["--tol", "above 0"]);
    propagate(GOOD, &["--method", "gauss_radau", "--tol", "NaN"], 2, &["--tol", "above 0"]);
    propagate(GOOD, &["--method", "gauss_radau", "--dt", "1"], 1, &["gauss_radau takes a tolerance"]);
    propagate(GOOD, &["--method", "leapfrog"], 1, &["leapfrog takes a step", "--dt"]);
    propagate(|_| {}, &["--method", "leapfrog", "--dt", "1"], 1, &["case.json", "cannot be read"]);
    propagate(|d| case_file(d, "\"P\", 0, NaN, 0, 0, 0, 1, 0"), &["--method", "gauss_radau"], 1, &["case.json:4:", "expected a case"]);
    propagate(|d| case_file(d, "\"P\", 0, 1e999, 0, 0, 0, 1, 0"), &["--method", "gauss_radau"], 1, &["case.json:4:", "out of range"]);
    propagate(|d| case_file(d, "\"P\", 0, 1, 0"), &["--method", "gauss_radau"], 1, &["case.json:4:"]);
    propagate(
        |d| case_file(d, "\"P\", -1, 1, 0, 0, 0, 1, 0"),
        &["--method", "gauss_radau"],
        1,
        &["case.json", "bodies[1] `P`", "gm is -1"],
    );
    propagate(
        |d| case_file(d, "\"P\", 0, 0, 0, 0, 0, 1, 0"),
        &["--method", "gauss_radau"],
        1,
        &["bodies[1] `P`", "same place as [0] `Sun`"],
    );
    propagate(|d| fs::write(d.join("case.json"), "{\"bodies\": [").unwrap(), &["--method", "gauss_radau"], 1, &["case.json:1:", "EOF"]);
    propagate(|d| fs::write(d.join("case.json"), "{\"bodies\": []}").unwrap(), &["--method", "gauss_radau"], 1, &["bodies", "is empty"]);
    expect(|_| {}, &["bench", "orbit", "--case", "LEO"], 1, &["no case `LEO`", "LEO_1000orb"]);
    expect(|_| {}, &["bench", "orbit", "--method", "taylr"], 1, &["no method `taylr`", "did you mean `taylor`"]);
    expect(
        |d| fs::write(d.join("p.json"), "[{}]").unwrap(),
        &["bench", "orbit", "--peers", "p.json", "--case", "FIG8_100T"],
        1,
        &["p.json:1:"],
    );
}
