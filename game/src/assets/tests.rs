//! Malformed assets, one test a case: each must end in a message with the file, the line and what was expected. Also what mods may do.
//! The real solar system is measured in [`sol`] and [`moons`].

mod moons;
mod optics;
mod sol;

use super::*;
use std::fs;
use std::path::{Path, PathBuf};

const SUN: &str = r#"name = "Sun"
gm_km3_s2 = 1.3e11
radius_km = 696000.0
albedo = [1.0, 1.0, 1.0]
[star]
illuminance_at_1_au_lx = 1.28e5
colour = [1.0, 1.0, 1.0]
[rotation]
pole_ra_deg = 286.0
pole_ra_deg_per_century = 0.0
pole_dec_deg = 63.0
pole_dec_deg_per_century = 0.0
meridian_deg = 84.0
meridian_deg_per_day = 14.0
[orbit]
kind = "barycentric"
epoch_jd_tdb = 2461265.25
position_km = [0.0, 0.0, 0.0]
velocity_km_s = [0.0, 0.0, 0.0]
with_moons = false
"#;

const ROCK: &str = r#"name = "Rock"
parent = "sun"
gm_km3_s2 = 4.0e5
radius_km = 6000.0
albedo = [0.3, 0.3, 0.3]
[rotation]
pole_ra_deg = 0.0
pole_ra_deg_per_century = 0.0
pole_dec_deg = 80.0
pole_dec_deg_per_century = 0.0
meridian_deg = 10.0
meridian_deg_per_day = 300.0
meridian_terms = [[1.0, 2.0, 3.0]]
[orbit]
kind = "barycentric"
epoch_jd_tdb = 2461265.25
position_km = [1.0e8, 1.0e8, 0.0]
velocity_km_s = [-20.0, 20.0, 0.0]
with_moons = true
[relief]
relief_max = 4.0
ground = "rock"
water = false
[relief.noise]
wavelength_m = 50000.0
amplitude_m = 500.0
plain_amplitude_m = 50.0
gain = 0.5
ridged = 0.2
seed = 7
"#;

pub(crate) const AIR: &str = r#"top_altitude_m = 80000.0
ground_albedo = [0.1, 0.1, 0.1]
[[layers]]
scattering_per_m = [5.8e-6, 13.5e-6, 33.1e-6]
absorption_per_m = [0.0, 0.0, 0.0]
profile = { kind = "exponential", scale_height_m = 8000.0 }
phase = { kind = "cornette_shanks", g = 0.8 }
[physics]
kind = "hydrostatic"
drag_top_m = 100000.0
temperature_k = 280.0
pressure_pa = 90000.0
molar_mass_kg_mol = 0.029
heat_capacity_ratio = 1.4
lapse = [{ to_altitude_m = 10000.0, k_per_m = -0.0065 }]
"#;

const MOON: &str = r#"name = "Moon"
parent = "rock"
gm_km3_s2 = 100.0
radius_km = 500.0
albedo = [0.1, 0.1, 0.1]
[rotation]
pole_ra_deg = 0.0
pole_ra_deg_per_century = 0.0
pole_dec_deg = 80.0
pole_dec_deg_per_century = 0.0
meridian_deg = 10.0
meridian_deg_per_day = 30.0
[orbit]
kind = "mean"
epoch_jd_tdb = 2451545.0
semi_major_axis_km = 221700.0
eccentricity = 0.02
inclination_deg = 1.0
node_deg = 10.0
node_deg_per_year = -2.0
argument_deg = 20.0
argument_deg_per_year = 4.0
mean_anomaly_deg = 30.0
mean_longitude_deg_per_day = 30.0
plane_pole_ra_deg = 0.0
plane_pole_dec_deg = 80.0
"#;

const START: &str = r#"key = "here"
name = "Here"
description = "A start."
system = "t"
ship = "torch"
utc = "2026-08-12T17:30:00"
[place]
kind = "orbit"
body = "rock"
altitude_m = 400000.0
lat_deg = 10.0
lon_deg = 20.0
heading_deg = 90.0
"#;

const TORCH: &str = include_str!("../../../assets/ships/torch.toml");

/// A small, valid assets folder.
pub(crate) fn assets() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (path, text) in [
        (SYSTEM_FILE, "name = \"T\"\nbodies = [\"moon\", \"rock\", \"sun\"]\n"),
        (SUN_FILE, SUN),
        (ROCK_FILE, ROCK),
        (AIR_FILE, AIR),
        (MOON_FILE, MOON),
        ("starts/here.toml", START),
        ("ships/torch.toml", TORCH),
    ] {
        put(dir.path(), path, text.as_bytes());
    }
    dir
}

pub(crate) fn put(root: &Path, path: &str, bytes: &[u8]) -> PathBuf {
    let file = root.join(path);
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(&file, bytes).unwrap();
    file
}

fn load_system(root: &Path, mods: &[PathBuf], key: &str) -> Result<Arc<System>, AssetErrors> {
    Assets::new(root.to_owned(), mods.to_vec()).system(key, &|_, _| ())
}

/// Loads what `file` belongs to.
fn load(root: &Path, file: &str) -> Result<(), AssetErrors> {
    let assets = Assets::new(root.to_owned(), Vec::new());
    match file.split('/').next() {
        Some("ships") => assets.ship("torch").map(drop),
        Some("starts") => assets.start("here").map(drop),
        _ => load_system(root, &[], "t").map(drop),
    }
}

#[test]
fn the_small_assets_are_good() {
    let dir = assets();
    for file in ["systems", "ships", "starts"] {
        load(dir.path(), file).unwrap_or_else(|e| panic!("{}", e.text()));
    }
    let system = load_system(dir.path(), &[], "t").unwrap();
    assert_eq!(system.bodies.iter().map(|b| b.key.as_str()).collect::<Vec<_>>(), ["sun", "rock", "moon"]);
}

/// Replaces `from` by `to` in a file; the message must name the file, the line, and hold every word.
fn malformed(file: &str, from: &str, to: &str, line: usize, words: &[&str]) {
    let dir = assets();
    let path = dir.path().join(file);
    let good = fs::read_to_string(&path).unwrap();
    assert!(good.contains(from), "`{from}` is not in {file}");
    fs::write(&path, good.replacen(from, to, 1)).unwrap();
    let errors = load(dir.path(), file).expect_err("it must be refused");
    let message = errors.text();
    let place = format!("{}:{line}:", path.display());
    assert!(message.contains(&place), "expected {place} in\n{message}");
    assert!(message.contains(&format!("{line} | ")) && message.contains('^'), "expected an excerpt with a caret in\n{message}");
    assert!(message.contains("expected"), "expected what was expected in\n{message}");
    for word in words {
        assert!(message.contains(word), "expected `{word}` in\n{message}");
    }
    assert!(!message.contains("NaN") || to.contains("nan"), "a placeholder shows in\n{message}");
}

const SUN_FILE: &str = "bodies/sun/body.toml";
const ROCK_FILE: &str = "bodies/rock/body.toml";
const SYSTEM_FILE: &str = "systems/t/system.toml";
pub(crate) const AIR_FILE: &str = "bodies/rock/atmosphere.toml";
const MOON_FILE: &str = "bodies/moon/body.toml";
const START_FILE: &str = "starts/here.toml";
const SHIP_FILE: &str = "ships/torch.toml";

macro_rules! malformed {
    ($($name:ident: $file:ident, $from:literal => $to:literal, line $line:literal, $words:expr;)*) => {$(
        #[test]
        fn $name() {
            malformed($file, $from, $to, $line, &$words);
        }
    )*};
}

malformed! {
    unknown_key_at_the_top: ROCK_FILE, "radius_km" => "radus_km", line 4, ["unknown key `radus_km`", "did you mean `radius_km`?"];
    unknown_key_in_a_table: AIR_FILE, "temperature_k = 280.0" => "temperature_k = 280.0\ntemprature_c = 7.0", line 12, ["[physics]", "temprature_c"];
    unknown_table: ROCK_FILE, "[relief.noise]" => "[relief.nose]", line 24, ["unknown key `nose`", "did you mean `noise`?"];
    missing_key: ROCK_FILE, "gm_km3_s2 = 4.0e5\n" => "", line 1, ["missing key `gm_km3_s2`", "above 0"];
    missing_key_in_a_table: ROCK_FILE, "pole_dec_deg = 80.0\n" => "", line 6, ["missing key `pole_dec_deg` in [rotation]"];
    missing_table: MOON_FILE, "[rotation]" => "[rotatoin]", line 6, ["missing key `rotation`", "did you mean `rotation`?"];
    nan_is_refused: ROCK_FILE, "radius_km = 6000.0" => "radius_km = nan", line 4, ["out of range"];
    infinity_is_refused: ROCK_FILE, "gm_km3_s2 = 4.0e5" => "gm_km3_s2 = inf", line 3, ["`gm_km3_s2` = inf"];
    negative_gm: MOON_FILE, "gm_km3_s2 = 100.0" => "gm_km3_s2 = -100.0", line 3, ["-100", "above 0"];
    a_size_that_its_motion_does_not_have: MOON_FILE, "semi_major_axis_km = 221700.0" => "semi_major_axis_km = 200000.0", line 1,
        ["Moon: `semi_major_axis_km` = 200000", "expected 221683", "mean_longitude_deg_per_day"];
    zero_radius: MOON_FILE, "radius_km = 500.0" => "radius_km = 0", line 4, ["from 0.1"];
    text_for_a_number: MOON_FILE, "radius_km = 500.0" => "radius_km = \"500 km\"", line 4, ["found a string"];
    number_for_text: MOON_FILE, "name = \"Moon\"" => "name = 5", line 1, ["expected a string, found a number"];
    empty_name: MOON_FILE, "name = \"Moon\"" => "name = \"\"", line 1, ["not empty"];
    albedo_above_one: MOON_FILE, "albedo = [0.1, 0.1, 0.1]" => "albedo = [0.1, 1.1, 0.1]", line 5, ["albedo[1]", "from 0 to 1"];
    albedo_of_two: MOON_FILE, "albedo = [0.1, 0.1, 0.1]" => "albedo = [0.1, 0.1]", line 5, ["list of 3 numbers", "found 2"];
    unknown_parent: MOON_FILE, "parent = \"rock\"" => "parent = \"rok\"", line 2, ["did you mean `rock`?"];
    own_parent: MOON_FILE, "parent = \"rock\"" => "parent = \"moon\"", line 2, ["circle"];
    parents_in_a_circle: ROCK_FILE, "parent = \"sun\"" => "parent = \"moon\"", line 2, ["circle"];
    two_stars: ROCK_FILE, "parent = \"sun\"\n" => "", line 1, ["only one body without"];
    no_star: SUN_FILE, "name = \"Sun\"" => "name = \"Sun\"\nparent = \"rock\"", line 2, ["circle"];
    star_without_light: SUN_FILE, "[star]\nilluminance_at_1_au_lx = 1.28e5\ncolour = [1.0, 1.0, 1.0]\n" => "", line 1, ["missing table [star]"];
    unknown_rotation: ROCK_FILE, "[rotation]\n" => "[rotation]\nmodel = \"erth\"\n", line 7, ["one of \"iau\", \"earth\"", "did you mean `earth`?"];
    the_earths_rotation_and_a_pole: ROCK_FILE, "[rotation]\n" => "[rotation]\nmodel = \"earth\"\n", line 8, ["unknown key `pole_ra_deg`"];
    flat_as_a_coin: ROCK_FILE, "[rotation]\n" => "[shape]\nflattening = 0.7\n[rotation]\n", line 7, ["from 0 to 0.5"];
    half_a_limb: ROCK_FILE, "[rotation]\n" => "[shape]\nlimb_radius_km = [6000.0]\n[rotation]\n", line 7, ["list of 2 numbers"];
    light_in_a_planet: ROCK_FILE, "[rotation]" => "[star]\nilluminance_at_1_au_lx = 1.0\ncolour = [1.0, 1.0, 1.0]\n[rotation]", line 6, ["only in the body without a `parent`"];
    key_given_twice: ROCK_FILE, "radius_km = 6000.0" => "radius_km = 6000.0\nradius_km = 6001.0", line 5, ["not TOML", "duplicate key"];
    broken_syntax: ROCK_FILE, "albedo = [0.3" => "albedo = 0.3", line 5, ["not TOML"];
    unknown_orbit_kind: MOON_FILE, "kind = \"mean\"" => "kind = \"means\"", line 14, ["one of \"barycentric\"", "did you mean `mean`?"];
    open_mean_orbit: MOON_FILE, "eccentricity = 0.02" => "eccentricity = 1.0", line 17, ["from 0 to 0.999"];
    far_away_epoch: MOON_FILE, "epoch_jd_tdb = 2451545.0" => "epoch_jd_tdb = 1e30", line 15, ["epoch_jd_tdb"];
    flag_as_text: ROCK_FILE, "with_moons = true" => "with_moons = \"yes\"", line 19, ["true or false, found a string"];
    date_for_a_number: ROCK_FILE, "meridian_deg = 10.0" => "meridian_deg = 2026-08-12", line 11, ["found a date"];
    ragged_terms: ROCK_FILE, "meridian_terms = [[1.0, 2.0, 3.0]]" => "meridian_terms = [[1.0, 2.0]]", line 13, ["lists of 3 numbers"];
    unknown_physics: AIR_FILE, "kind = \"hydrostatic\"" => "kind = \"us67\"", line 9, ["did you mean `us76`?"];
    impossible_air: AIR_FILE, "heat_capacity_ratio = 1.4" => "heat_capacity_ratio = 14.0", line 14, ["heat_capacity_ratio", "from 1 to 1.7"];
    lapse_below_zero_kelvin: AIR_FILE, "to_altitude_m = 10000.0" => "to_altitude_m = 90000.0", line 15, ["lapse[0]", "from 1 to"];
    phase_out_of_range: AIR_FILE, "g = 0.8" => "g = 1.8", line 7, ["layers[0].phase.g", "0.99"];
    unknown_profile: AIR_FILE, "kind = \"exponential\"" => "kind = \"exponetial\"", line 6, ["did you mean `exponential`?"];
    no_layers: AIR_FILE, "[[layers]]" => "[[layer]]", line 3, ["did you mean `layers`?"];
    unknown_table_of_air: AIR_FILE, "[physics]" => "[phyiscs]", line 8, ["unknown key `phyiscs`", "did you mean `physics`?"];
    relief_max_below_one: ROCK_FILE, "relief_max = 4.0" => "relief_max = 0.5", line 21, ["from 1 to 1000"];
    noise_out_of_range: ROCK_FILE, "gain = 0.5" => "gain = 0.9", line 28, ["relief.noise.gain"];
    seed_with_a_fraction: ROCK_FILE, "seed = 7" => "seed = 7.5", line 30, ["whole number"];
    unknown_ground: ROCK_FILE, "ground = \"rock\"" => "ground = \"rocks\"", line 22, ["did you mean `rock`?"];
    start_under_another_name: START_FILE, "key = \"here\"" => "key = \"there\"", line 1, ["the file's name, \"here\""];
    start_without_ship: START_FILE, "ship = \"torch\"\n" => "", line 1, ["missing key `ship`"];
    start_on_no_date: START_FILE, "2026-08-12T17:30:00" => "2026-02-30", line 6, ["not a date of the calendar"];
    start_beyond_the_pole: START_FILE, "lat_deg = 10.0" => "lat_deg = 100.0", line 11, ["from -90 to 90"];
    start_of_unknown_kind: START_FILE, "kind = \"orbit\"" => "kind = \"orbti\"", line 8, ["did you mean `orbit`?"];
    start_in_the_ground: START_FILE, "altitude_m = 400000.0" => "altitude_m = -400000.0", line 10, ["from 0"];
    start_with_half_a_spot: START_FILE, "[place]" => "[target]\nbody = \"rock\"\nlat_deg = 1.0\n[place]", line 7, ["`lat_deg` and `lon_deg` together"];
    ship_with_unknown_key: SHIP_FILE, "thrust_n = 1.2e6" => "thrust_kn = 1200.0", line 14, ["thrust_kn", "did you mean `thrust_n`?"];
    ship_without_mass: SHIP_FILE, "dry_kg = 19000.0\n" => "", line 7, ["missing field `dry_kg`"];
    ship_of_negative_mass: SHIP_FILE, "dry_kg = 19000.0" => "dry_kg = -1.0", line 8, ["mass.dry_kg", "more than zero"];
    ship_with_text_for_a_number: SHIP_FILE, "dry_kg = 19000.0" => "dry_kg = \"heavy\"", line 8, ["[mass]", "expected f64"];
    ship_under_another_name: SHIP_FILE, "key = \"torch\"" => "key = \"lantern\"", line 3, ["the file's name, \"torch\""];
}

#[test]
fn all_faults_of_all_files_are_told_at_once() {
    let dir = assets();
    put(dir.path(), ROCK_FILE, ROCK.replace("radius_km = 6000.0", "radius_km = -1.0").replace("gain = 0.5", "gain = nan").as_bytes());
    put(dir.path(), MOON_FILE, MOON.replace("eccentricity", "ecentricity").as_bytes());
    let errors = load_system(dir.path(), &[], "t").unwrap_err();
    let message = errors.text();
    for place in ["rock/body.toml:4:", "rock/body.toml:28:", "moon/body.toml:17:", "moon/body.toml:13:"] {
        assert!(message.replace('\\', "/").contains(place), "{place} in\n{message}");
    }
    assert_eq!(errors.faults.len(), 4, "{message}");
}

#[test]
fn a_file_that_is_not_utf8_is_named_with_its_line() {
    let dir = assets();
    let file = put(dir.path(), MOON_FILE, b"name = \"Moon\"\nparent = \"\xff\xfe\"\n");
    let message = load_system(dir.path(), &[], "t").unwrap_err().text();
    assert!(
        message.contains(&file.display().to_string()) && message.contains("line 2") && message.contains("expected a UTF-8"),
        "{message}"
    );
}

#[test]
fn a_file_that_is_too_large_is_not_read_whole() {
    let dir = assets();
    let file = put(dir.path(), MOON_FILE, &vec![b'#'; (1 << 20) + 1]);
    let message = load_system(dir.path(), &[], "t").unwrap_err().text();
    assert!(message.contains(&file.display().to_string()) && message.contains("too large"), "{message}");
}

#[test]
fn what_is_listed_and_not_there_is_named() {
    let dir = assets();
    put(dir.path(), SYSTEM_FILE, b"name = \"T\"\nbodies = [\"sun\", \"rokc\", \"moon\"]\n");
    let message = load_system(dir.path(), &[], "t").unwrap_err().text();
    assert!(
        message.contains("system.toml:2:18") && message.contains("no body \"rokc\"") && message.contains("did you mean `rock`?"),
        "{message}"
    );
    let message = load_system(dir.path(), &[], "tt").unwrap_err().text();
    assert!(message.contains("did you mean `t`?"), "{message}");
    let message = Assets::new(dir.path().to_owned(), Vec::new()).ship("toch").unwrap_err().text();
    assert!(message.contains("did you mean `torch`?"), "{message}");
    let message = Assets::new(dir.path().to_owned(), Vec::new()).start("her").unwrap_err().text();
    assert!(message.contains("did you mean `here`?"), "{message}");
}

#[test]
fn a_start_that_names_what_is_not_there_is_told_at_its_line() {
    for (field, wrong, near) in [("ship", "troch", "torch"), ("system", "tt", "t")] {
        let dir = assets();
        let line = START.lines().position(|l| l.starts_with(&format!("{field} = "))).unwrap();
        let text: Vec<String> =
            START.lines().enumerate().map(|(i, l)| if i == line { format!("{field} = \"{wrong}\"") } else { l.to_owned() }).collect();
        let file = put(dir.path(), START_FILE, text.join("\n").as_bytes());
        let assets = Assets::new(dir.path().to_owned(), Vec::new());
        let place = format!("{}:{}:", file.display(), line + 1);
        for message in [assets.check().unwrap_err().text(), assets.begin("here", &|_, _| ()).map(drop).unwrap_err().text()] {
            assert!(message.contains(&place) && message.contains(&format!("did you mean `{near}`?")), "{place} {message}");
        }
    }
}

#[test]
fn a_map_that_is_missing_or_no_map_is_named() {
    let dir = assets();
    put(dir.path(), ROCK_FILE, ROCK.replace("water = false", "water = false\nmap = \"rock.cube\"").as_bytes());
    let message = load_system(dir.path(), &[], "t").unwrap_err().text();
    assert!(message.contains("rock.cube") && message.contains("missing"), "{message}");
    let file = put(dir.path(), "maps/rock.cube", b"no map at all");
    let message = load_system(dir.path(), &[], "t").unwrap_err().text();
    assert!(message.contains(&file.display().to_string()) && message.contains("expected a .cube file"), "{message}");
    // A name must not lead out of the assets.
    put(dir.path(), ROCK_FILE, ROCK.replace("water = false", "water = false\nmap = \"../../../secret.cube\"").as_bytes());
    assert!(load_system(dir.path(), &[], "t").is_err());
}

#[test]
fn mods_add_replace_and_modify() {
    let dir = assets();
    let base = load_system(dir.path(), &[], "t").unwrap();
    let one = tempfile::tempdir().unwrap();
    let moonlet =
        MOON.replace("Moon", "Moonlet").replace("221700.0", "90000.0").replace("deg_per_day = 30.0\nplane", "deg_per_day = 115.97\nplane");
    put(one.path(), "bodies/moonlet/body.toml", moonlet.as_bytes());
    put(one.path(), "bodies/rock/body.patch.toml", b"radius_km = 7000.0\n[relief.noise]\nseed = 8\n");
    put(one.path(), "systems/t/system.patch.toml", b"bodies.add = [\"moonlet\"]\n");
    let two = tempfile::tempdir().unwrap();
    put(two.path(), "bodies/moon/body.toml", MOON.replace("radius_km = 500.0", "radius_km = 600.0").as_bytes());
    let mods = [one.path().to_owned(), two.path().to_owned()];
    let modded = load_system(dir.path(), &mods, "t").unwrap();
    let radius = |key: &str| modded.find(key).map(|id| modded.body(id).radius_m);
    assert_eq!((radius("rock"), radius("moon"), radius("moonlet")), (Some(7.0e6), Some(6.0e5), Some(5.0e5)));
    assert_eq!(modded.find("moonlet").unwrap().0, 2, "nearer than the moon: before it");
    assert!(modded.body(modded.find("rock").unwrap()).air.is_some(), "what the patch leaves out stays");
    assert_ne!(base.hash, modded.hash);
    let patch = put(one.path(), "bodies/rock/body.patch.toml", b"\n\nradius_km = -7.0\n");
    let message = load_system(dir.path(), &mods, "t").unwrap_err().text();
    assert!(message.contains(&format!("{}:3:", patch.display())), "the fault is in the patch:\n{message}");
}

#[test]
fn the_hash_follows_what_a_flight_depends_on() {
    let dir = assets();
    let hash = || load_system(dir.path(), &[], "t").unwrap_or_else(|e| panic!("{}", e.text())).hash.clone();
    let before = hash();
    // Line ends, comments, how numbers are written, colours and what the air looks like are no difference.
    put(dir.path(), MOON_FILE, MOON.replace('\n', "\r\n").as_bytes());
    put(dir.path(), ROCK_FILE, ROCK.replace("albedo = [0.3, 0.3", "# grey\nalbedo = [0.2, 0.3").replace("6000.0", "6e3").as_bytes());
    put(dir.path(), AIR_FILE, AIR.replace("5.8e-6", "9.9e-6").replace("g = 0.8", "g = 0.7").as_bytes());
    put(dir.path(), SYSTEM_FILE, b"name = \"U\"\nbodies = [\"sun\", \"moon\", \"rock\"]\n");
    assert_eq!(before, hash());
    put(dir.path(), AIR_FILE, AIR.replace("pressure_pa = 90000.0", "pressure_pa = 90001.0").as_bytes());
    let drags = hash();
    assert_ne!(before, drags);
    put(dir.path(), MOON_FILE, MOON.replace("radius_km = 500.0", "radius_km = 500.5").as_bytes());
    assert_ne!(drags, hash());
}

#[test]
fn banks_of_fog_are_placed_and_their_faults_told() {
    let dir = assets();
    let put_fog = |text: &str| put(dir.path(), AIR_FILE, format!("{AIR}{text}").as_bytes());
    let bank = "[[fog]]\nlatitude_deg = 90.0\nlongitude_deg = 0.0\naltitude_m = 1000.0\nradius_m = 500.0\n";
    put_fog(&format!("{bank}thickness = {{ opacity = 2.0, shadow = \"cylinder\" }}\n{bank}"));
    let system = load_system(dir.path(), &[], "t").unwrap();
    let fog = &system.body(system.find("rock").unwrap()).fog;
    assert_eq!(fog.len(), 2);
    assert!((fog[0].centre_m - 6.001e6 * glam::DVec3::Z).length() < 1e-3, "{}", fog[0].centre_m);
    assert_eq!(fog[0].air.medium.top_altitude_m, 500.0);
    let engine::air::Model::Thickness(look) = &fog[0].air.model else { panic!("{:?}", fog[0].air.model) };
    assert_eq!((look.opacity, look.shadow), (2.0, engine::air::model::thickness::ShadowShape::Cylinder));
    assert_eq!(fog[1].air.model, engine::air::Model::Thickness(engine::air::model::Thickness::default()));
    put_fog(&bank.replace("radius_m = 500.0", "radius_m = -5.0\nradus_m = 1.0\nthickness = { opacity = -1.0 }"));
    let told = load_system(dir.path(), &[], "t").unwrap_err().text();
    for part in ["radius_m", "radus_m", "opacity"] {
        assert!(told.contains(part), "{part} in: {told}");
    }
}

#[test]
fn a_patch_changes_a_list_by_the_names_in_it() {
    let dir = assets();
    let named = AIR.replace("[[layers]]\n", "[[layers]]\nname = \"gas\"\n");
    put(dir.path(), AIR_FILE, named.as_bytes());
    let one = tempfile::tempdir().unwrap();
    let mods = [one.path().to_owned()];
    let look = |patch: &str| {
        put(one.path(), "bodies/rock/atmosphere.patch.toml", patch.as_bytes());
        load_system(dir.path(), &mods, "t")
            .map(|s| s.body(s.find("rock").unwrap()).look.clone().unwrap().medium.layers)
            .map_err(|e| e.text())
    };
    let blue = look("[layers.gas]\nscattering_per_m = [1e-6, 2e-6, 9e-6]\n").unwrap();
    assert_eq!((blue.len(), blue[0].scattering_per_m), (1, glam::Vec3::new(1e-6, 2e-6, 9e-6)));
    let fog = "[[layers.add]]\nname = \"fog\"\nscattering_per_m = [1e-4, 1e-4, 1e-4]\nabsorption_per_m = [0, 0, 0]\n\
        profile = { kind = \"exponential\", scale_height_m = 200 }\nphase = { kind = \"rayleigh\" }\n";
    assert_eq!(look(fog).unwrap().len(), 2);
    assert_eq!(look(&format!("layers.remove = [\"gas\"]\n{fog}")).unwrap().len(), 1);
    let wrong = look("[layers.gsa]\nscattering_per_m = [1e-6, 2e-6, 9e-6]\n").unwrap_err();
    assert!(
        wrong.contains("atmosphere.patch.toml:1:9") && wrong.contains("no item named `gsa`") && wrong.contains("did you mean `gas`?"),
        "{wrong}"
    );
    let wrong = look("layers.remove = [\"sag\"]\n").unwrap_err();
    assert!(wrong.contains("atmosphere.patch.toml:1:18") && wrong.contains("no item named `sag`"), "{wrong}");
}

#[test]
fn a_patch_of_what_is_not_there_is_named_itself() {
    let dir = assets();
    let one = tempfile::tempdir().unwrap();
    let patch = put(one.path(), "bodies/rokc/atmosphere.patch.toml", b"top_altitude_m = 1e5\n");
    let wrong = |mods: &[PathBuf]| load_system(dir.path(), mods, "t").unwrap_err().text();
    let message = wrong(&[one.path().to_owned()]);
    assert!(message.contains(&patch.display().to_string()) && message.contains("did you mean `rock`?"), "{message}");
    assert!(!message.contains("the file is missing"), "{message}");
    // An airless body has no atmosphere that could be changed.
    fs::remove_dir_all(one.path().join("bodies")).unwrap();
    let patch = put(one.path(), "bodies/moon/atmosphere.patch.toml", b"top_altitude_m = 1e5\n");
    let message = wrong(&[one.path().to_owned()]);
    assert!(message.contains(&patch.display().to_string()) && message.contains("there is no `bodies/moon/atmosphere.toml`"), "{message}");
    // A later mod that brings the file replaces all that lies under it.
    let two = tempfile::tempdir().unwrap();
    put(two.path(), "bodies/moon/atmosphere.toml", AIR.as_bytes());
    let message = wrong(&[one.path().to_owned(), two.path().to_owned()]);
    assert!(message.contains(&patch.display().to_string()) && message.contains("changes nothing"), "{message}");
    load_system(dir.path(), &[two.path().to_owned(), one.path().to_owned()], "t").unwrap_or_else(|e| panic!("{}", e.text()));
}

#[test]
fn a_watched_folder_reloads_and_a_broken_file_is_told() {
    let dir = assets();
    let assets = Assets::new(dir.path().to_owned(), Vec::new());
    let reloader = Reloader::watch(&assets, "t").unwrap();
    let first = assets.system("t", &|_, _| ()).unwrap();
    let wait = |what: &str| {
        for _ in 0..1000 {
            if let Some(outcome) = reloader.poll(&first) {
                return outcome;
            }
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        panic!("nothing came: {what}");
    };
    put(dir.path(), MOON_FILE, MOON.replace("radius_km = 500.0", "radius_km = 501.0").as_bytes());
    let system = wait("a changed file").unwrap();
    assert_eq!(system.body(system.find("moon").unwrap()).radius_m, 5.01e5);
    put(dir.path(), MOON_FILE, b"radius_km = ");
    assert!(wait("a broken file").unwrap_err().text().contains("not TOML"));
}

#[test]
fn a_saved_sky_is_there_within_three_tenths_of_a_second() {
    use std::time::{Duration, Instant};
    let dir = assets();
    let file = put(dir.path(), AIR_FILE, AIR.as_bytes());
    let assets = Assets::new(dir.path().to_owned(), Vec::new());
    let first = assets.system("t", &|_, _| ()).unwrap();
    let reloader = Reloader::watch(&assets, "t").unwrap();
    let blue = |system: &System| system.body(system.find("rock").unwrap()).look.as_ref().unwrap().medium.layers[0].scattering_per_m.z;
    // As editors save: over the file, in two writes, through a file beside it and a rename.
    let mut best = Duration::MAX;
    for (i, way) in [0, 1, 2].into_iter().cycle().take(6).enumerate() {
        let value = 1e-5 + 1e-6 * i as f32;
        let text = AIR.replace("33.1e-6", &format!("{value:e}"));
        let began = Instant::now();
        match way {
            0 => fs::write(&file, &text).unwrap(),
            1 => {
                fs::write(&file, &text[..text.len() / 2]).unwrap();
                std::thread::sleep(Duration::from_millis(5));
                fs::write(&file, &text).unwrap();
            }
            _ => {
                let beside = file.with_file_name(".atmosphere.toml.swp");
                fs::write(&beside, &text).unwrap();
                fs::rename(&beside, &file).unwrap();
            }
        }
        loop {
            match reloader.poll(&first) {
                Some(Ok(system)) if blue(&system) == value => break,
                Some(Err(e)) => panic!("{}", e.text()),
                _ => assert!(began.elapsed() < Duration::from_secs(20), "way {way}: nothing came"),
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        best = best.min(began.elapsed());
    }
    println!("saved to read: {best:?}");
    assert!(best < Duration::from_millis(300), "{best:?}");
    // What an editor leaves beside it changes nothing; a file that is taken away does.
    put(dir.path(), "bodies/rock/atmosphere.toml~", b"x");
    put(dir.path(), "bodies/rock/.atmosphere.toml.swx", b"x");
    std::thread::sleep(Duration::from_millis(250));
    assert_eq!(reloader.changed(), None);
    fs::remove_file(&file).unwrap();
    let gone = (0..2000).find_map(|_| {
        std::thread::sleep(Duration::from_millis(5));
        reloader.poll(&first)
    });
    let system = gone.unwrap().unwrap();
    assert!(system.body(system.find("rock").unwrap()).look.is_none());
}

#[test]
fn an_air_that_is_hardly_meant_is_told_and_taken() {
    let dir = assets();
    let warned = |from: &str, to: &str| {
        assert!(AIR.contains(from), "{from}");
        put(dir.path(), AIR_FILE, AIR.replace(from, to).as_bytes());
        load_system(dir.path(), &[], "t").unwrap_or_else(|e| panic!("{}", e.text())).warnings.clone()
    };
    assert_eq!(warned("g = 0.8", "g = 0.8"), [""; 0]);
    for (from, to, line, words) in [
        ("[5.8e-6, 13.5e-6, 33.1e-6]", "[5.8e-3, 13.5e-3, 33.1e-3]", 4, "look like values per kilometre"),
        ("top_altitude_m = 80000.0", "top_altitude_m = 20000.0", 1, "a hard edge"),
        ("scattering_per_m = [5.8e-6, 13.5e-6, 33.1e-6]", "scattering_per_m = [0.9, 13.5e-6, 33.1e-6]", 3, "no light comes through"),
    ] {
        let warnings = warned(from, to);
        let told = |w: &String| {
            w.contains(&format!("atmosphere.toml:{line}:")) && w.contains("warning: ") && w.contains(words) && w.contains("help: ")
        };
        assert!(warnings.iter().any(told), "{to}: {warnings:#?}");
    }
    let rayleigh = |h: &str| {
        put(
            dir.path(),
            AIR_FILE,
            AIR.replace("kind = \"cornette_shanks\", g = 0.8", "kind = \"rayleigh\"").replace("8000.0", h).as_bytes(),
        );
        load_system(dir.path(), &[], "t").unwrap().warnings.clone()
    };
    assert_eq!(rayleigh("8000.0"), [""; 0]);
    let told = rayleigh("4000.0");
    assert!(told.len() == 1 && told[0].contains("p ≠ ρ R T / M") && told[0].contains("atmosphere.toml:6:"), "{told:#?}");
}
