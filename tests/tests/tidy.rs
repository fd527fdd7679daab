//! The house rules, as a test: who may use whom, how long a file may be, what a file opens with.
//!
//! Not here: that shaders compile and that structs mirror WGSL (`shaders.rs`), that twins agree (`twin_*.rs`).

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests/ has a parent").to_path_buf()
}

fn files(dir: &str, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![root().join(dir)];
    while let Some(dir) = open.pop() {
        for entry in fs::read_dir(&dir).unwrap_or_else(|e| panic!("{}: {e}", dir.display())).flatten() {
            let path = entry.path();
            if path.is_dir() {
                open.push(path);
            } else if path.to_string_lossy().ends_with(ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn short(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Source lines without comments and without the in-file tests, which may reach further.
fn code(path: &Path) -> String {
    let all = text(path);
    let cut = all.find("#[cfg(test)]").unwrap_or(all.len());
    all[..cut].lines().filter(|l| !l.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

fn report(rule: &str, offences: &[String]) {
    assert!(offences.is_empty(), "{rule}:\n  {}", offences.join("\n  "));
}

#[test]
fn the_top_level_is_the_plan_s() {
    let allowed: BTreeSet<&str> =
        ["Cargo.toml", "Cargo.lock", "LICENSE", "README.md", "engine", "game", "shaders", "assets", "saves", "tests", "target"].into();
    let odd: Vec<String> = fs::read_dir(root())
        .expect("the checkout can be read")
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| !name.starts_with('.') && !name.starts_with("target") && !allowed.contains(name.as_str()))
        .collect();
    report("an entry at the top level that the plan does not have", &odd);
}

#[test]
fn arrows_between_the_engine_s_rooms_point_down() {
    // A room may use the rooms of lower levels, and its equals where named.
    const LEVELS: [(&str, u8); 12] = [
        ("units", 0),
        ("time", 0),
        ("space", 0),
        ("orbit", 1),
        ("terrain", 1),
        ("air", 1),
        ("light", 1),
        ("rigid", 1),
        ("scene", 2),
        ("gpu", 2),
        ("render", 3),
        ("lib", 4),
    ];
    let level = |room: &str| LEVELS.iter().find(|(r, _)| *r == room).map(|(_, l)| *l);
    // Equals that may see each other: collisions ask the ground, light in air asks for the sun's disc; nothing else.
    const EQUALS: [(&str, &str); 4] = [("rigid", "terrain"), ("air", "light"), ("time", "units"), ("space", "units")];
    let mut offences = Vec::new();
    for path in files("engine/src", ".rs") {
        let name = short(&path);
        let room = name.trim_start_matches("engine/src/").split(['/', '.']).next().unwrap_or_default().to_owned();
        let here = level(&room).unwrap_or_else(|| panic!("{name}: a room that the plan does not have"));
        for (number, line) in code(&path).lines().enumerate() {
            for part in line.split("crate::").skip(1) {
                let used: String = part.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let Some(there) = level(&used) else { continue };
                let fine = used == room || there < here || here == 4 || EQUALS.contains(&(room.as_str(), used.as_str()));
                if !fine {
                    offences.push(format!("{name}:{}: {room} (level {here}) uses {used} (level {there})", number + 1));
                }
            }
            if here <= 1 && line.contains("wgpu::") || room == "scene" && line.contains("wgpu::") {
                offences.push(format!("{name}: names wgpu below the GPU's level"));
            }
        }
    }
    report("an arrow that points up", &offences);
}

#[test]
fn the_engine_knows_no_window_no_sound_and_no_save() {
    let mut offences = Vec::new();
    for path in files("engine/src", ".rs") {
        let code = code(&path);
        for crate_name in ["winit", "egui", "kira", "gilrs", "clap", "rmp_serde", "game"] {
            if code.contains(&format!("{crate_name}::")) {
                offences.push(format!("{}: names {crate_name}", short(&path)));
            }
        }
    }
    report("the engine reaches out of its crate", &offences);
}

#[test]
fn files_are_short_and_open_with_a_head() {
    let mut offences = Vec::new();
    for dir in ["engine/src", "game/src"] {
        for path in files(dir, ".rs") {
            let text = text(&path);
            let lines = text.lines().count();
            if lines > 500 {
                offences.push(format!("{}: {lines} lines (500 at most)", short(&path)));
            }
            if !text.starts_with("//!") {
                offences.push(format!("{}: does not open with what it is for (//!)", short(&path)));
            }
        }
    }
    for path in files("shaders", ".wgsl") {
        let text = text(&path);
        let lines = text.lines().count();
        if lines > 250 {
            offences.push(format!("{}: {lines} lines (250 at most)", short(&path)));
        }
        if !text.starts_with("//") {
            offences.push(format!("{}: does not open with what it is for", short(&path)));
        }
    }
    report("a file that is a drawer, or nameless", &offences);
}

#[test]
fn shader_libraries_have_no_bindings() {
    let offences: Vec<String> = files("shaders/lib", ".wgsl")
        .iter()
        .filter(|p| text(p).lines().any(|l| !l.trim_start().starts_with("//") && (l.contains("@binding") || l.contains("@group"))))
        .map(|p| short(p))
        .collect();
    report("a binding in shaders/lib", &offences);
}

#[test]
fn every_pass_has_its_shader_and_every_shader_its_pass() {
    let passes: BTreeSet<String> = files("engine/src/render/pass", ".rs").iter().map(|p| stem(p)).filter(|s| s != "mod").collect();
    let offences: Vec<String> = files("shaders/pass", ".wgsl")
        .iter()
        .filter(|p| {
            !passes.iter().any(|pass| stem(p) == *pass || stem(p).starts_with(&format!("{pass}_"))) && !by_family(&stem(p), &passes)
        })
        .map(|p| short(p))
        .collect();
    report("a shader that no pass of the same name draws with", &offences);
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// `air_transmittance.wgsl` belongs to `air_tables.rs`: the same family name before the first underscore.
fn by_family(shader: &str, passes: &BTreeSet<String>) -> bool {
    let family = shader.split('_').next().unwrap_or_default();
    passes.iter().any(|p| p.split('_').next() == Some(family))
}

#[test]
fn nothing_is_left_open() {
    let marks = ["todo!(", "unimplemented!(", concat!("TO", "DO"), concat!("FIX", "ME"), concat!("HA", "CK")];
    let mut offences = Vec::new();
    for (dir, ending) in [("engine/src", ".rs"), ("game/src", ".rs"), ("shaders", ".wgsl"), ("tests/tests", ".rs")] {
        for path in files(dir, ending) {
            if path.ends_with("tidy.rs") {
                continue;
            }
            for (number, line) in text(&path).lines().enumerate() {
                if marks.iter().any(|m| line.contains(m)) {
                    offences.push(format!("{}:{}: {}", short(&path), number + 1, line.trim()));
                }
            }
        }
    }
    report("left open", &offences);
}

#[test]
fn main_is_short() {
    let lines = text(&root().join("game/src/main.rs")).lines().count();
    assert!(lines < 40, "game/src/main.rs has {lines} lines: parse, mode, exit code, under 40");
}
