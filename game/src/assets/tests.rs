//! Malformed assets, one test a case: each must end in a message with the file, the line and what was expected. Also what mods may do.
//! The real solar system is measured in [`sol`] and [`moons`].

mod mods;
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
