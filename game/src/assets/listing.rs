//! What a system lists, `system.toml`: its name, its bodies, the masses that are no body. And which bodies there are at all.
//!
//! Not here: what the bodies' own files say ([`super::body`], [`super::atmosphere`]), and the system that they make ([`super::system`]).

use super::fault::{At, Fault, Severity, nearest};
use super::overlay::{OF_BODY, OF_SYSTEM, Overlay};
use super::reader::{Faults, POSITIVE, Reader};
use super::system::{digest, read_tree};
use super::tree::{Data, Node};
use engine::orbit::State;
use engine::orbit::ephemeris::Mass;
use engine::space::{Position, Velocity};
use engine::units::{KM, KM3_S2};
use glam::DVec3;
use std::collections::BTreeMap;

/// Bodies that a system may have.
const BODIES_MAX: usize = 4096;

/// What `system.toml` says.
pub struct Top {
    /// Display name.
    pub name: String,
    /// Keys of the bodies, and where each is listed. Sorted: their order in the file makes no difference.
    pub bodies: BTreeMap<String, At>,
    /// What pulls and is no body, by name.
    pub masses: Vec<(String, Mass)>,
}

/// Reads the file; what a flight depends on goes to `hash`.
pub fn read_top(r: Reader<'_>, hash: &mut blake3::Hasher) -> Top {
    let name = r.text("name");
    r.maybe_text("description");
    let mut bodies = BTreeMap::new();
    for (key, at) in r.texts("bodies") {
        if !key.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-') {
            r.fault(Fault::at(&at, format!("`bodies`: \"{key}\": expected the name of a folder in `bodies`")));
        } else if bodies.insert(key.clone(), at.clone()).is_some() {
            r.fault(Fault::at(&at, format!("`bodies`: \"{key}\" is listed twice: expected each body once")));
        }
    }
    if bodies.len() > BODIES_MAX {
        r.wrong("bodies", format!("`bodies`: {} of them: expected 1 to {BODIES_MAX}", bodies.len()));
    }
    digest(r.node, &["name", "description", "bodies"], hash);
    let masses: Vec<(String, Mass)> = r.tables("masses").into_iter().map(read_mass).collect();
    r.finish();
    Top { name, bodies, masses }
}

fn read_mass(r: Reader<'_>) -> (String, Mass) {
    let name = r.text("name");
    let gm_m3_s2 = r.number("gm_km3_s2", POSITIVE) * KM3_S2;
    let vector = |key, range| DVec3::from_array(r.numbers::<3>(key, range)) * KM;
    let state = State {
        position: Position::new(vector("position_km", -1e12..=1e12)),
        velocity: Velocity::new(vector("velocity_km_s", -3e5..=3e5)),
    };
    r.finish();
    (name, Mass { gm_m3_s2, state })
}

/// The tree of a body that a system lists; where there is no such body, that is told at the list.
pub fn read_listed(overlay: &Overlay, body: &str, at: &At, faults: &Faults) -> Option<Node> {
    let relative = format!("bodies/{body}/body.toml");
    if overlay.find(&relative).is_none() {
        let known = bodies(overlay);
        let message = format!("`bodies`: there is no body \"{body}\": expected its file {}", overlay.expected(&relative).display());
        faults.borrow_mut().push(Fault::at(at, message).help(nearest(body, known.iter().map(String::as_str))));
        return None;
    }
    read_tree(overlay, &relative, "the body", faults)
}

/// The bodies that there are.
pub fn bodies(overlay: &Overlay) -> Vec<String> {
    let exists = |name: &String| overlay.find(format!("bodies/{name}/body.toml")).is_some();
    overlay.names("bodies", None).into_iter().filter(exists).collect()
}

/// Whether a system lists a body; `false` too where its file cannot be read.
pub fn lists(overlay: &Overlay, system: &str, body: &str) -> bool {
    let tree = read_tree(overlay, &format!("systems/{system}/system.toml"), "", &Faults::default());
    let Some(Data::Array(list)) = tree.as_ref().and_then(|t| t.get("bodies")).map(|e| &e.value.data) else { return false };
    list.iter().any(|item| item.text() == Some(body))
}

/// Files of mods that nobody reads: a misspelt name would else be a mod that does nothing.
fn tell_strays(overlay: &Overlay, faults: &Faults) {
    for (path, relative) in overlay.strays() {
        let parts: Vec<&str> = relative.iter().filter_map(|part| part.to_str()).collect();
        let help = match parts.as_slice() {
            ["bodies", _, file] => nearest(file, OF_BODY),
            ["systems", _, file] => nearest(file, OF_SYSTEM),
            ["ships" | "starts", ..] => Some("expected one file for each, without a patch".to_owned()),
            [folder, ..] if parts.len() > 1 => nearest(folder, ["bodies", "systems", "ships", "starts"]),
            _ => Some("a mod has the folders of the assets: bodies/<body>/, systems/<system>/, ships/, starts/".to_owned()),
        };
        let warning = Fault { severity: Severity::Warning, ..Fault::file(&path, "nothing reads a file of this name in this place") };
        faults.borrow_mut().push(warning.help(help));
    }
}

/// A file of a mod that replaces one and lacks keys was perhaps meant to change only some: told with the faults from `first` on.
pub fn tell_replaced(overlay: &Overlay, relative: &str, first: usize, faults: &Faults) {
    let Some(path) = overlay.find(relative) else { return };
    let below = overlay.roots().iter().map(|r| r.join(relative)).find(|p| p.is_file() && *p != path);
    let (Some(below), Some(stem)) = (below, relative.strip_suffix(".toml").and_then(|s| s.rsplit('/').next())) else { return };
    let missing = |f: &&mut Fault| f.path == path && f.help.is_none() && f.message.starts_with("missing key");
    if let Some(fault) = faults.borrow_mut().iter_mut().skip(first).find(missing) {
        let below = below.display();
        fault.help = Some(format!("this file replaces all of {below}; what changes only some of its keys is called `{stem}.patch.toml`"));
    }
}

/// Patches of what is not there, also in folders that no system lists, and files that nobody reads.
pub fn tell_orphans(overlay: &Overlay, faults: &Faults) {
    tell_strays(overlay, faults);
    let known = bodies(overlay);
    for body in overlay.names("bodies", None) {
        for file in ["body.toml", "atmosphere.toml"] {
            let relative = format!("bodies/{body}/{file}");
            let there = overlay.find(&relative);
            for patch in overlay.orphans(&relative) {
                let fault = match &there {
                    Some(above) => Fault::file(&patch, format!("it changes nothing: {} lies above it and replaces all", above.display()))
                        .help(Some(
                            "expected a patch in the same mod or in a later one: mods lie in the order in which they are named".to_owned(),
                        )),
                    None => Fault::file(
                        &patch,
                        format!("there is no `{relative}` that it could change: expected one in the assets or in a mod"),
                    )
                    .help(nearest(&body, known.iter().map(String::as_str))),
                };
                faults.borrow_mut().push(fault);
            }
        }
    }
}
