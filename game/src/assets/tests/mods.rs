//! What mods may do, what of a file a flight depends on, and what is hardly meant.

use super::*;

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
        ("scattering_per_m = [5.8e-6, 13.5e-6, 33.1e-6]", "scattering_per_m = [0.9, 13.5e-6, 33.1e-6]", 4, "no light comes through"),
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
    // Each alone, in place of the one layer; and the same made sound.
    let by = |layer: &str, top: &str| {
        let (head, rest) = AIR.split_once("scattering_per_m").unwrap();
        let physics = rest.split_once("[physics]").unwrap().1;
        put(dir.path(), AIR_FILE, format!("{}{layer}\n[physics]{physics}", head.replace("80000.0", top)).as_bytes());
        load_system(dir.path(), &[], "t").unwrap_or_else(|e| panic!("{}", e.text())).warnings.clone()
    };
    let gas = |p: &str, t: &str| {
        format!("name = \"g\"\ngas = {{ molecules = {{ n2 = 0.78, o2 = 0.22 }}, pressure_pa = {p}, temperature_k = {t} }}")
    };
    let haze = |depth: &str| {
        format!(
            "name = \"h\"\naerosol = {{ optical_depth = {depth}, single_scattering_albedo = 0.9 }}\n\
             profile = {{ kind = \"exponential\", scale_height_m = 1000.0 }}\nphase = {{ kind = \"isotropic\" }}"
        )
    };
    let phase =
        |angles: &str| haze("0.1").replace("kind = \"isotropic\"", &format!("kind = \"table\", angle_deg = {angles}, value = [2, 1]"));
    let molecules = |s: &str| {
        format!(
            "name = \"m\"\nscattering_per_m = {s}\nabsorption_per_m = [0, 0, 0]\n\
             profile = {{ kind = \"exponential\", scale_height_m = 8000.0 }}\nphase = {{ kind = \"rayleigh\" }}"
        )
    };
    for (odd, sound, top, line, words) in [
        // p, ρ and T of the gas that is seen against [physics]: half the pressure; the wrong temperature.
        (gas("45000.0", "280.0"), gas("90000.0", "280.0"), "100000.0", 5, "molecules per m³ are seen"),
        (gas("90000.0", "120.0"), gas("90000.0", "270.0"), "100000.0", 5, "p ≠ ρ R T / M"),
        (haze("300.0"), haze("30.0"), "80000.0", 5, "no light comes through"),
        (molecules("[33.1e-6, 13.5e-6, 5.8e-6]"), molecules("[5.8e-6, 13.5e-6, 33.1e-6]"), "100000.0", 5, "more red than blue"),
        (phase("[20, 180]"), phase("[0, 180]"), "80000.0", 7, "from 20° to 180°"),
        (phase("[0, 90]"), phase("[0, 180]"), "80000.0", 7, "from 0° to 90°"),
        (molecules("[0, 0, 0]"), molecules("[5.8e-6, 13.5e-6, 33.1e-6]"), "100000.0", 3, "drags and is not seen"),
        (gas("90000.0", "280.0"), gas("90000.0", "280.0"), "30000.0", 1, "a hard edge: `g`"),
    ] {
        let told = by(&odd, top);
        let here = |w: &String| w.contains(&format!("atmosphere.toml:{line}:")) && w.contains(words) && w.contains("help: ");
        assert!(told.iter().any(here), "{odd}\n{words}: {told:#?}");
        assert!(!told.iter().any(|w| w.contains("per kilometre")), "{told:#?}");
        if odd != sound {
            assert_eq!(by(&sound, top), [""; 0], "{sound}");
        }
    }
}

#[test]
fn a_file_that_nobody_reads_is_told_with_the_name_that_it_should_have() {
    let dir = assets();
    for (file, help) in [
        ("bodies/rock/atmosphere.pacth.toml", "did you mean `atmosphere.patch.toml`?"),
        ("body/rock/atmosphere.patch.toml", "known here: bodies, systems, ships, starts"),
        ("systems/t/systm.patch.toml", "did you mean `system.patch.toml`?"),
        ("atmosphere.patch.toml", "bodies/<body>/"),
        ("ships/torch.patch.toml", "without a patch"),
    ] {
        let one = tempfile::tempdir().unwrap();
        let path = put(one.path(), file, b"top_altitude_m = 1e5\n");
        let assets = Assets::new(dir.path().to_owned(), vec![one.path().to_owned()]);
        let system = assets.system("t", &|_, _| ()).unwrap_or_else(|e| panic!("{}", e.text()));
        let airs = assets.airs(&system).unwrap();
        for warnings in [&system.warnings, &airs.warnings, &assets.check().unwrap()] {
            let [told] = warnings.as_slice() else { panic!("{file}: {warnings:#?}") };
            assert!(told.contains(&path.display().to_string()) && told.contains("nothing reads") && told.contains(help), "{told}");
        }
    }
}

#[test]
fn the_slips_of_a_first_patch_are_told_where_they_were_made() {
    let dir = assets();
    let one = tempfile::tempdir().unwrap();
    let named = AIR.replace("[[layers]]\n", "[[layers]]\nname = \"gas\"\n");
    put(dir.path(), AIR_FILE, named.as_bytes());
    let told = |file: &str, text: &[u8]| {
        let path = put(one.path(), file, text);
        let told = load_system(dir.path(), &[one.path().to_owned()], "t").expect_err(&String::from_utf8_lossy(text)).text();
        fs::remove_file(&path).unwrap();
        assert!(told.contains(&path.display().to_string()), "the fault is in the patch:\n{told}");
        told
    };
    let patch = "bodies/rock/atmosphere.patch.toml";
    for (text, words) in [
        ("[layers.gas.profile]\nkind = \"tent\"\nbottom_m = 0\n", vec![":1:", "missing key `peak_m`"]),
        ("[layers.gas]\naerosol = { optical_depth = 0.1, single_scattering_albedo = 0.9 }\n", vec![":2:1", "described twice", "remove"]),
        ("[layers.add]\nname = \"x\"\n", vec![":1:", "`add`: expected a list of tables", "[[….add]]"]),
        (
            "[[fog]]\nname = \"a\"\nlatitude_deg = 1\nlongitude_deg = 1\naltitude_m = 1\nradius_m = 9\n[[fog]]\nname = \"a\"\nlatitude_deg = 1\nlongitude_deg = 1\naltitude_m = 1\nradius_m = 9\n",
            vec![":8:8", "another one is named so"],
        ),
        ("top_altitude_m = 9e4\r# old line ends\r", vec!["line 1", "carriage return", "Unix or Windows"]),
        ("[layers.\"Дым\"]\nscattering_per_m = [1, 1, 1]\n", vec!["Дым", "known here: gas"]),
    ] {
        let message = told(patch, text.as_bytes());
        for word in words {
            assert!(message.contains(word), "`{word}` in\n{message}");
        }
    }
    // What was meant as a patch and replaces all.
    let message = told(AIR_FILE, b"top_altitude_m = 9e4\n");
    assert!(message.contains("`atmosphere.patch.toml`") && message.contains("missing key `layers`"), "{message}");
    let message = told(ROCK_FILE, b"radius_km = 6001.0\n");
    assert!(message.contains("`body.patch.toml`"), "{message}");
    let message = told(AIR_FILE, b"top_altitude_m = 9e4\nground_albedo = [0, 0, 0]\n[layers.gas]\nname = \"x\"\n");
    assert!(message.contains("[[layers]]") && message.contains("*.patch.toml"), "{message}");
    let message = told(AIR_FILE, b"");
    assert!(message.contains("missing key `top_altitude_m`") && message.contains(":1:1"), "{message}");
    // A mark of the byte order and line ends of Windows are no fault.
    put(one.path(), patch, "\u{feff}top_altitude_m = 90000.0\r\n[layers.gas.profile]\r\nscale_height_m = 7000.0\r\n".as_bytes());
    let system = load_system(dir.path(), &[one.path().to_owned()], "t").unwrap_or_else(|e| panic!("{}", e.text()));
    assert_eq!(system.body(system.find("rock").unwrap()).look.as_ref().unwrap().medium.top_altitude_m, 9e4);
}

#[test]
fn a_long_line_is_cut_around_its_fault_and_a_screen_shows_few_in_full() {
    let dir = assets();
    let long = format!("top_altitude_m = \"high\" # {}\nthin = 1\nrare = 2\nlow = 3\nblue = 4\n", "x".repeat(300));
    put(dir.path(), AIR_FILE, AIR.replace("top_altitude_m = 80000.0\n", &long).as_bytes());
    let errors = load_system(dir.path(), &[], "t").unwrap_err();
    let text = errors.text();
    assert!(text.contains("1 | top_altitude_m = \"high\" # x") && text.contains("x…\n    |                  ^^^^^^"), "{text}");
    let screen = errors.on_screen();
    assert!(screen.lines().all(|l| !l.contains(" | ") || l.chars().count() < 100), "{screen}");
    assert!(screen.contains("1 | top_altitude_m") && screen.contains("and 1 more: `syzygy check-assets`"), "{screen}");
    // A fault at the far end of a line is in the excerpt, too.
    let values = (0..60).map(|i| i.to_string()).collect::<Vec<_>>().join(", ");
    let bad = AIR.replace(
        "phase = { kind = \"cornette_shanks\", g = 0.8 }",
        &format!("phase = {{ kind = \"table\", angle_deg = [0, 180], value = [{values}, -7] }}"),
    );
    put(dir.path(), AIR_FILE, bad.as_bytes());
    let text = load_system(dir.path(), &[], "t").unwrap_err().text();
    let lines: Vec<&str> = text.lines().collect();
    let at = lines.iter().position(|l| l.contains("-7] }")).unwrap();
    assert!(lines[at].contains("| …"), "{text}");
    let caret = lines[at + 1].find('^').unwrap();
    assert_eq!(lines[at].chars().skip(caret).take(2).collect::<String>(), "-7", "{text}");
}

#[test]
fn an_emptied_file_waits_for_what_is_written_and_saves_that_follow_each_other_end_in_the_last() {
    use std::time::{Duration, Instant};
    let dir = assets();
    let file = put(dir.path(), AIR_FILE, AIR.as_bytes());
    let assets = Assets::new(dir.path().to_owned(), Vec::new());
    let first = assets.system("t", &|_, _| ()).unwrap();
    let reloader = Reloader::watch(&assets, "t").unwrap();
    let blue = |system: &System| system.body(system.find("rock").unwrap()).look.as_ref().unwrap().medium.layers[0].scattering_per_m.z;
    // All that is heard until nothing has come for half a second.
    let heard = || {
        let (mut all, mut last) = (Vec::new(), Instant::now());
        while last.elapsed() < Duration::from_millis(700) {
            if let Some(read) = reloader.poll(&first) {
                all.push(read.map(|s| blue(&s)).map_err(|e| e.text()));
                last = Instant::now();
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        all
    };
    fs::write(&file, "").unwrap();
    std::thread::sleep(Duration::from_millis(150));
    assert_eq!(reloader.changed(), None, "an empty file is not believed at once");
    fs::write(&file, AIR.replace("33.1e-6", "4e-5")).unwrap();
    let told = heard();
    assert!(!told.is_empty() && told.iter().all(|read| *read == Ok(4e-5)), "and never told: {told:?}");
    for value in ["5e-5", "6e-5", "7e-5"] {
        fs::write(&file, AIR.replace("33.1e-6", value)).unwrap();
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(heard().last(), Some(&Ok(7e-5)));
    // Touched, with nothing changed: the same air.
    fs::File::options().append(true).open(&file).unwrap().set_modified(std::time::SystemTime::now()).unwrap();
    assert!(heard().iter().all(|read| *read == Ok(7e-5)));
    // One that stays empty is told after a while.
    fs::write(&file, "").unwrap();
    let told = heard();
    assert!(told.last().is_some_and(|read| read.as_ref().is_err_and(|e| e.contains("missing key"))), "{told:?}");
}

#[test]
fn the_settings_of_every_model_are_keys_of_its_table() {
    use crate::assets::atmosphere::keys::ATMOSPHERE;
    use crate::assets::fields::Kind;
    use engine::air::Model;
    use engine::air::model::{Gradient, LimbTable, Physical, Thickness, ViewTable};
    for model in [
        Model::Physical(Physical::default()),
        Model::Thickness(Thickness::default()),
        Model::LimbTable(LimbTable::default()),
        Model::ViewTable(ViewTable::default()),
        Model::Gradient(Gradient::default()),
    ] {
        let value = serde_json::to_value(&model).unwrap();
        let word = value["model"].as_str().unwrap();
        let Some(Kind::Table(fields)) = ATMOSPHERE.iter().find(|f| f.key == word).map(|f| &f.kind) else { panic!("{word} has no table") };
        let mut keys: Vec<&str> = fields.iter().map(|f| f.key).collect();
        let mut settings: Vec<&str> = value.as_object().unwrap().keys().map(String::as_str).filter(|k| *k != "model").collect();
        keys.sort_unstable();
        settings.sort_unstable();
        assert_eq!(keys, settings, "{word}");
    }
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
    let most = crate::assets::atmosphere::fog::MOST;
    put_fog(&bank.repeat(most));
    let warnings = || load_system(dir.path(), &[], "t").unwrap().warnings.clone();
    assert!(!warnings().iter().any(|w| w.contains("banks of fog")), "{:?}", warnings());
    put_fog(&bank.repeat(most + 3));
    let told = |w: &String| w.contains("33 banks of fog: a picture holds 32") && w.contains("30 at most");
    assert!(warnings().iter().any(told), "{:?}", warnings());
    put_fog(&bank.replace("radius_m = 500.0", "radius_m = -5.0\nradus_m = 1.0\nthickness = { opacity = -1.0 }"));
    let told = load_system(dir.path(), &[], "t").unwrap_err().text();
    for part in ["radius_m", "radus_m", "opacity"] {
        assert!(told.contains(part), "{part} in: {told}");
    }
}

#[test]
fn a_painted_picture_that_is_not_there_is_told_with_the_nearest_that_is() {
    let dir = assets();
    let painted = |name: &str| format!("model = \"gradient\"\ntop_altitude_m = 9e4\n[gradient]\nshell_map = \"{name}\"\n");
    put(dir.path(), AIR_FILE, painted("evening.png").as_bytes());
    let told = || load_system(dir.path(), &[], "t").unwrap_err().text();
    assert!(told().contains("atmosphere.toml:4:") && told().contains("in a mod it may also lie"), "{}", told());
    // Those of a mod count as well as those of the assets.
    let one = tempfile::tempdir().unwrap();
    put(one.path(), "bodies/rock/evenings.png", b"");
    let told = load_system(dir.path(), &[one.path().to_owned()], "t").unwrap_err().text();
    assert!(told.contains("atmosphere.toml:4:") && told.contains("did you mean `evenings.png`?"), "{told}");
}

#[test]
fn a_list_that_takes_the_place_of_another_by_mistake_is_told() {
    let dir = assets();
    let one = tempfile::tempdir().unwrap();
    let (head, rest) = AIR.split_once("[[layers]]\n").unwrap();
    let (layer, physics) = rest.split_once("[physics]").unwrap();
    let named = |name: &str| format!("[[layers]]\nname = \"{name}\"\n{layer}");
    put(dir.path(), AIR_FILE, format!("{head}{}{}[physics]{physics}", named("gas"), named("dust")).as_bytes());
    let warnings = |text: String| {
        put(one.path(), "bodies/rock/atmosphere.patch.toml", text.as_bytes());
        load_system(dir.path(), &[one.path().to_owned()], "t").unwrap_or_else(|e| panic!("{}", e.text())).warnings.clone()
    };
    let told = |w: &String| w.contains("takes the place of all 2 of `layers`") && w.contains("[layers.gas] changes that one");
    assert!(warnings(named("gas")).iter().any(told), "{:?}", warnings(named("gas")));
    for meant in [named("other"), named("gas") + &named("dust"), "[layers.gas.profile]\nscale_height_m = 7000.0\n".to_owned()] {
        assert!(!warnings(meant.clone()).iter().any(told), "{meant}");
    }
}
