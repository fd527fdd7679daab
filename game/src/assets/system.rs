//! A system from its file: that of every body that it lists is read and checked, all faults are gathered, and only a system without any is built.

use super::atmosphere::{AirSpec, Datum, Setting, read_air};
use super::body::{BodySpec, read_body};
use super::fault::{AssetErrors, Fault, nearest};
use super::listing::{Top, read_listed, read_top, tell_orphans, tell_replaced};
use super::overlay::{Overlay, read_text};
use super::reader::{Faults, Reader, count_errors};
use super::relief::load_maps;
use super::tree::{Data, Node, parse};
use crate::world::system::{Body, System};
use engine::light::spectrum::Starlight;
use engine::orbit::BodyId;
use engine::orbit::ephemeris::{Details, Ephemeris, EphemerisError, Mass, Orbit, Path as OrbitPath};
use engine::terrain::Relief;
use engine::units::KM;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Loads `systems/<key>`; `progress` hears how much is done, 0 … 1, and of what.
pub fn load_system(overlay: &Overlay, key: &str, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<Arc<System>, AssetErrors> {
    let faults = Faults::default();
    let mut hash = blake3::Hasher::new();
    let system = read(overlay, key, &faults, &mut hash, progress);
    let found = AssetErrors { faults: faults.into_inner() };
    match system {
        Some(mut system) if !found.faults.iter().any(Fault::is_error) => {
            system.warnings = found.faults.iter().map(Fault::text).collect();
            Ok(Arc::new(system))
        }
        _ => Err(found),
    }
}

/// Reads a file with its patches into one tree; faults are written down. `what` is what is expected in it.
pub fn read_tree(overlay: &Overlay, relative: &str, what: &str, faults: &Faults) -> Option<Node> {
    let files = overlay.with_patches(relative);
    if files.is_empty() {
        let message = format!("the file is missing: expected {what}");
        faults.borrow_mut().push(Fault::file(&overlay.expected(relative), message));
    }
    let mut tree: Option<Node> = None;
    for file in files {
        let source = match read_text(&file) {
            Ok(source) => source,
            Err(fault) => {
                faults.borrow_mut().push(fault);
                return None;
            }
        };
        match (parse(&source), &mut tree) {
            (Ok(node), Some(tree)) => tree.patch(node, &mut faults.borrow_mut()),
            (Ok(node), none) => *none = Some(node),
            (Err(errors), _) => {
                faults.borrow_mut().extend(errors);
                return None;
            }
        }
    }
    tree
}

fn read(overlay: &Overlay, key: &str, faults: &Faults, hash: &mut blake3::Hasher, progress: &(dyn Fn(f32, &str) + Sync)) -> Option<System> {
    let file = format!("systems/{key}/system.toml");
    let top = read_tree(overlay, &file, "the system's name and its bodies", faults);
    if top.is_none() && overlay.with_patches(&file).is_empty() {
        let known = overlay.names("systems", None);
        if let Some(last) = faults.borrow_mut().last_mut() {
            last.help = nearest(key, known.iter().map(String::as_str));
        }
        return None;
    }
    let top = read_top(Reader::new(&top?, faults), hash);
    tell_orphans(overlay, faults);
    let mut specs: Vec<BodySpec> = Vec::new();
    let mut whole = true;
    let mut drags = BTreeMap::new();
    for (body, at) in &top.bodies {
        hash.update(body.as_bytes());
        let Some(tree) = read_listed(overlay, body, at, faults) else {
            whole = false;
            continue;
        };
        digest(&tree, &["name", "albedo"], hash);
        let first = faults.borrow().len();
        specs.push(read_body(body, Reader::new(&tree, faults)));
        tell_replaced(overlay, &format!("bodies/{body}/body.toml"), first, faults);
    }
    let starlight = specs.iter().find_map(|s| s.starlight.clone()).unwrap_or_default();
    let with_air = |spec: BodySpec| {
        let (air, drag) = read_atmosphere(overlay, &spec.key, Datum::new(spec.gm_m3_s2, spec.radius_m), &starlight, faults);
        drags.insert(spec.key.clone(), drag);
        (spec, air)
    };
    let specs: Vec<(BodySpec, AirSpec)> = specs.into_iter().map(with_air).collect();
    let order = order(&specs, &top.bodies.keys().map(String::as_str).collect::<Vec<_>>(), faults)?;
    if !whole {
        return None;
    }
    let (specs, airs): (Vec<BodySpec>, Vec<AirSpec>) = order.into_iter().map(|i| specs[i].clone()).unzip();
    if count_errors(faults) > 0 {
        return None;
    }
    // Maps are most of the work, and independent of each other.
    let done = AtomicUsize::new(0);
    let grounds: Vec<Ground> = specs
        .par_iter()
        .map(|s| {
            let ground = ground(s, overlay, &format!("bodies/{}", s.key));
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(count as f32 / specs.len() as f32, &s.name);
            ground
        })
        .collect();
    let mut reliefs = Vec::new();
    for ground in grounds {
        hash.update(ground.hash.as_bytes());
        faults.borrow_mut().extend(ground.faults);
        reliefs.push(ground.relief);
    }
    if count_errors(faults) > 0 {
        return None;
    }
    let solid = hash.finalize().to_hex().to_string();
    let hash = whole_hash(&solid, &drags);
    let system = build(key, top, specs, airs, reliefs, hash).map_err(|f| faults.borrow_mut().push(f)).ok()?;
    Some(System { solid_hash: solid, starlight, ..system })
}

/// The hash of what a flight depends on, from that of all but the air and those of the air that drags, by body.
fn whole_hash(solid: &str, drags: &BTreeMap<String, String>) -> String {
    let mut hash = blake3::Hasher::new();
    hash.update(solid.as_bytes());
    for (body, drag) in drags {
        hash.update(body.as_bytes()).update(drag.as_bytes());
    }
    hash.finalize().to_hex().to_string()
}

/// A system with its airs read anew and all else as it is: a thousandth of the work of [`load_system`], for those who turn a sky's
/// colours while they look at it.
pub fn reread_airs(overlay: &Overlay, system: &System) -> Result<Arc<System>, AssetErrors> {
    let faults = Faults::default();
    tell_orphans(overlay, &faults);
    let mut drags = BTreeMap::new();
    let mut bodies = system.bodies.clone();
    for body in &mut bodies {
        let (air, drag) = read_atmosphere(overlay, &body.key, Datum::new(body.gm_m3_s2, body.radius_m), &system.starlight, &faults);
        (body.air, body.look, body.fog) = (air.column, air.look, air.fog);
        drags.insert(body.key.clone(), drag);
    }
    let hash = whole_hash(&system.solid_hash, &drags);
    let found = AssetErrors { faults: faults.into_inner() };
    let warnings = found.faults.iter().map(Fault::text).collect();
    let new = System::new(system.key.clone(), system.name.clone(), bodies, system.ephemeris.clone(), hash);
    found.or(Arc::new(System {
        solid_hash: system.solid_hash.clone(),
        starlight: system.starlight.clone(),
        warnings,
        eclipses: system.eclipses.clone(),
        ..new
    }))
}

/// The files of a body that no system lists, checked without the bodies around it; what is hardly meant comes back.
pub fn load_body(overlay: &Overlay, key: &str) -> Result<Vec<String>, AssetErrors> {
    let faults = Faults::default();
    tell_orphans(overlay, &faults);
    if let Some(tree) = read_tree(overlay, &format!("bodies/{key}/body.toml"), "the body", &faults) {
        let unlisted = Fault::warning(&tree.at, "no system lists this body: nobody will see it");
        let help = format!("a mod adds it with systems/<system>/system.patch.toml: bodies.add = [\"{key}\"]");
        faults.borrow_mut().push(unlisted.help(Some(help)));
        let spec = read_body(key, Reader::new(&tree, &faults));
        read_atmosphere(overlay, key, Datum::new(spec.gm_m3_s2, spec.radius_m), &Starlight::default(), &faults);
        let ground = if count_errors(&faults) == 0 { ground(&spec, overlay, &format!("bodies/{key}")) } else { Ground::default() };
        faults.borrow_mut().extend(ground.faults);
    }
    let found = AssetErrors { faults: faults.into_inner() };
    let warnings = found.faults.iter().map(Fault::text).collect();
    found.or(warnings)
}

/// The air of a body alone.
pub fn load_air(overlay: &Overlay, key: &str, star: &Starlight) -> Result<AirSpec, AssetErrors> {
    let faults = Faults::default();
    let mut air = AirSpec::default();
    if let Some(tree) = read_tree(overlay, &format!("bodies/{key}/body.toml"), "the body", &faults) {
        let spec = read_body(key, Reader::new(&tree, &faults));
        air = read_atmosphere(overlay, key, Datum::new(spec.gm_m3_s2, spec.radius_m), star, &faults).0;
    }
    AssetErrors { faults: faults.into_inner() }.or(air)
}

/// The air of a body: a file of its own, without which there is none. The second value is the hash of what drags in it: the look is no
/// part of a flight.
fn read_atmosphere(overlay: &Overlay, body: &str, datum: Datum, star: &Starlight, faults: &Faults) -> (AirSpec, String) {
    let relative = format!("bodies/{body}/atmosphere.toml");
    if overlay.find(&relative).is_none() {
        return Default::default();
    }
    let Some(tree) = read_tree(overlay, &relative, "the air", faults) else { return Default::default() };
    let mut hash = blake3::Hasher::new();
    if let Some(physics) = tree.get("physics") {
        physics.value.digest(&mut hash);
    }
    let first = faults.borrow().len();
    let folder = format!("bodies/{body}");
    let air = read_air(&Reader::new(&tree, faults), datum, &Setting { overlay, folder: &folder, star });
    tell_replaced(overlay, &relative, first, faults);
    (air, hash.finalize().to_hex().to_string())
}

/// Feeds a file's values to the hash, but for what a flight does not depend on.
pub fn digest(tree: &Node, seen_only: &[&str], hash: &mut blake3::Hasher) {
    let Data::Table(entries) = &tree.data else { return };
    let entries = entries.iter().filter(|e| !seen_only.contains(&e.key.as_str())).cloned().collect();
    Node { at: tree.at.clone(), data: Data::Table(entries) }.digest(hash);
}

/// The star first, then depth first: each body by its distance from its parent, its moons behind it. `None` where the tree
/// of parents is broken, which is then written down.
fn order(specs: &[(BodySpec, AirSpec)], folders: &[&str], faults: &Faults) -> Option<Vec<usize>> {
    let before = count_errors(faults);
    let find = |key: &str| specs.iter().position(|s| s.0.key == key);
    let mut roots = Vec::new();
    for (i, (s, _)) in specs.iter().enumerate() {
        let Some((parent, at)) = &s.parent else {
            roots.push(i);
            continue;
        };
        if find(parent).is_none() && !folders.contains(&parent.as_str()) {
            let message = format!("`parent` = \"{parent}\": expected another body that this system lists");
            let others = folders.iter().copied().filter(|f| *f != s.key);
            faults.borrow_mut().push(Fault::at(at, message).help(nearest(parent, others)));
        }
        // A walk of more steps than there are bodies goes round.
        let mut at_body = Some(i);
        for _ in 0..=specs.len() {
            at_body = at_body.and_then(|b| specs[b].0.parent.as_ref()).and_then(|(p, _)| find(p));
        }
        if at_body.is_some() {
            let message = format!("`parent` = \"{parent}\": the parents of `{}` go round in a circle: expected a way to the star", s.key);
            faults.borrow_mut().push(Fault::at(at, message));
        }
    }
    // Who shines is the star; the others are at fault.
    roots.sort_by_key(|i| specs[*i].0.intensity_cd.max_element() <= 0.0);
    match roots.as_slice() {
        [_] => {}
        [] if specs.is_empty() => {}
        [] => faults.borrow_mut().push(Fault::at(&specs[0].0.at, "every body has a `parent`: expected one body without, the star")),
        [first, rest @ ..] => {
            for i in rest {
                let message = format!("no `parent`, as `{}` has none: expected only one body without, the star", specs[*first].0.key);
                faults.borrow_mut().push(Fault::at(&specs[*i].0.at, message));
            }
        }
    }
    if let [root] = roots.as_slice()
        && specs[*root].0.intensity_cd.max_element() <= 0.0
    {
        let message = "missing table [star]: expected it in the body without a `parent`";
        faults.borrow_mut().push(Fault::at(&specs[*root].0.at, message));
    }
    if count_errors(faults) > before {
        return None;
    }
    let mut order = Vec::new();
    let mut open: Vec<usize> = roots;
    while let Some(i) = open.pop() {
        order.push(i);
        let mut children: Vec<usize> =
            (0..specs.len()).filter(|c| specs[*c].0.parent.as_ref().is_some_and(|(p, _)| *p == specs[i].0.key)).collect();
        children.sort_by(|a, b| distance(&specs[*b].0, &specs[i].0).total_cmp(&distance(&specs[*a].0, &specs[i].0)));
        open.extend(children);
    }
    Some(order)
}

/// Distance from the parent, m: at the epoch, or the semi-major axis.
fn distance(body: &BodySpec, parent: &BodySpec) -> f64 {
    let place = |p: &OrbitPath| match p {
        OrbitPath::Barycentric { state, .. } => state.position.0,
        _ => DVec3::ZERO,
    };
    match &body.path {
        OrbitPath::Mean(m) => m.semi_major_m,
        OrbitPath::FromParent { state, .. } => state.position.length(),
        OrbitPath::Barycentric { state, .. } => (state.position.0 - place(&parent.path)).length(),
    }
}

/// What became of a body's `[relief]`.
#[derive(Default)]
struct Ground {
    relief: Option<Arc<Relief>>,
    hash: String,
    faults: Vec<Fault>,
}

fn ground(spec: &BodySpec, overlay: &Overlay, folder: &str) -> Ground {
    let Some((relief, _)) = &spec.relief else { return Ground::default() };
    let mut hash = blake3::Hasher::new();
    let mut faults = Vec::new();
    let maps = load_maps(relief, overlay, folder, &mut hash, &mut |f| faults.push(f));
    if !faults.is_empty() {
        return Ground { faults, ..Ground::default() };
    }
    match Relief::new(spec.radius_m, relief.clone(), maps) {
        Ok(relief) => Ground { relief: Some(Arc::new(relief)), hash: hash.finalize().to_hex().to_string(), faults },
        Err(e) => Ground { faults: vec![Fault::at(&spec.at, format!("{e}; expected a ground that can be built"))], ..Ground::default() },
    }
}

/// Where and how it is told that the bodies make no system.
fn no_ephemeris(error: &EphemerisError, specs: &[BodySpec], masses: &[(String, Mass)]) -> Fault {
    let name = |i: usize| specs.get(i).map_or_else(|| masses.get(i - specs.len()).map_or("", |m| m.0.as_str()), |s| s.name.as_str());
    let (body, message) = match error {
        EphemerisError::Same(a, b) => (
            *b,
            format!(
                "{} and {} are at the same place: expected bodies apart, since their attraction has no value there",
                name(*a),
                name(*b)
            ),
        ),
        EphemerisError::Value { body, what } => (*body, format!("{}: {what}", name(*body))),
        EphemerisError::Pace { body, given_m, kepler_m } => (
            *body,
            format!(
                "{}: `semi_major_axis_km` = {}: expected {:.1}, which `mean_longitude_deg_per_day` and the parent's `gm_km3_s2` give",
                name(*body),
                given_m / KM,
                kepler_m / KM
            ),
        ),
        other => (0, other.to_string()),
    };
    match specs.get(body).or(specs.first()) {
        Some(spec) => Fault::at(&spec.at, message),
        None => Fault::file(&PathBuf::new(), message),
    }
}

fn build(
    key: &str,
    top: Top,
    specs: Vec<BodySpec>,
    airs: Vec<AirSpec>,
    reliefs: Vec<Option<Arc<Relief>>>,
    hash: String,
) -> Result<System, Fault> {
    let ids = |key: &str| specs.iter().position(|s| s.key == key).and_then(|i| u16::try_from(i).ok()).map(BodyId);
    let parents: Vec<Option<BodyId>> = specs.iter().map(|s| s.parent.as_ref().and_then(|(p, _)| ids(p))).collect();
    let orbits: Vec<Orbit> =
        specs.iter().zip(&parents).map(|(s, p)| Orbit { parent: *p, gm_m3_s2: s.gm_m3_s2, path: s.path.clone() }).collect();
    let details = Details {
        figures: specs.iter().map(|s| s.figure.clone()).collect(),
        family_gm_m3_s2: specs.iter().map(|s| s.family_gm_m3_s2).collect(),
        masses: top.masses.iter().map(|m| m.1).collect(),
    };
    let ephemeris = Ephemeris::detailed(&orbits, &details).map_err(|e| no_ephemeris(&e, &specs, &top.masses))?;
    let soi = |i: usize| -> f64 {
        let Some(parent) = parents[i] else { return f64::INFINITY };
        let reach = ephemeris.reach(u16::try_from(i).map(BodyId).unwrap_or(BodyId(0)));
        let a = 0.5 * (reach.nearest_m + reach.farthest_m);
        // Laplace's sphere: a (m/M)^(2/5).
        a * libm::pow(specs[i].gm_m3_s2 / specs[parent.index()].gm_m3_s2, 0.4)
    };
    let soi: Vec<f64> = (0..specs.len()).map(soi).collect();
    let bodies = specs.iter().zip(&parents).zip(reliefs).zip(soi).zip(airs).map(|((((s, parent), relief), soi_radius_m), air)| Body {
        key: s.key.clone(),
        name: s.name.clone(),
        parent: *parent,
        gm_m3_s2: s.gm_m3_s2,
        radius_m: s.radius_m,
        soi_radius_m,
        spin: s.spin.clone(),
        shape: s.shape,
        figure: s.figure.clone(),
        albedo: s.albedo,
        intensity_cd: s.intensity_cd,
        air: air.column,
        look: air.look,
        fog: air.fog,
        relief,
        relief_max: s.relief.as_ref().map_or(1.0, |(_, max)| *max),
    });
    let bodies = bodies.collect();
    Ok(System::new(key.to_owned(), top.name, bodies, ephemeris, hash))
}
