//! A system from its folder: every body's file is read and checked, all faults are gathered, and only a system without any is built.

use super::body::{BodySpec, read_body};
use super::fault::{AssetErrors, Fault, nearest};
use super::overlay::{Overlay, read_text};
use super::reader::{Faults, POSITIVE, Reader};
use super::relief::load_maps;
use super::tree::{Node, parse};
use crate::world::system::{Air, Body, System};
use engine::orbit::BodyId;
use engine::orbit::State;
use engine::orbit::ephemeris::{Details, Ephemeris, EphemerisError, Mass, Orbit, Path as OrbitPath};
use engine::space::{Position, Velocity};
use engine::terrain::Relief;
use engine::units::{KM, KM3_S2};
use glam::DVec3;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bodies that a system may have.
const BODIES_MAX: usize = 4096;

/// Loads `systems/<key>`; `progress` hears how much is done, 0 … 1, and of what.
pub fn load_system(overlay: &Overlay, key: &str, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<Arc<System>, AssetErrors> {
    let faults = Faults::default();
    let mut hash = blake3::Hasher::new();
    let system = read(overlay, key, &faults, &mut hash, progress);
    let faults = faults.into_inner();
    match system {
        Some(system) if faults.is_empty() => Ok(Arc::new(system)),
        _ => Err(AssetErrors { faults }),
    }
}

/// Reads a file with its patches into one tree; faults are written down.
pub fn read_tree(overlay: &Overlay, relative: &str, what: &str, faults: &Faults, hash: &mut blake3::Hasher) -> Option<Node> {
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
        // Line ends are no difference: a checkout on Windows flies the same replays.
        hash.update(source.text.replace("\r\n", "\n").as_bytes());
        match (parse(&source), &mut tree) {
            (Ok(node), Some(tree)) => tree.patch(node),
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
    let folder = format!("systems/{key}");
    let fault = |f: Fault| faults.borrow_mut().push(f);
    let top = read_tree(overlay, &format!("{folder}/system.toml"), "the system's name", faults, hash);
    if top.is_none() && overlay.with_patches(&format!("{folder}/system.toml")).is_empty() {
        let known = overlay.names("systems", None);
        if let Some(last) = faults.borrow_mut().last_mut() {
            last.help = nearest(key, known.iter().map(String::as_str));
        }
        return None;
    }
    let top = top.as_ref().map(|node| {
        let r = Reader::new(node, faults);
        let name = r.text("name");
        r.maybe_text("description");
        let masses: Vec<(String, Mass)> = r.tables("masses").into_iter().map(read_mass).collect();
        r.finish();
        (name, masses)
    });
    let mut specs = Vec::new();
    let keys = overlay.names(&folder, None);
    if keys.is_empty() || keys.len() > BODIES_MAX {
        let message = format!("expected 1 to {BODIES_MAX} folders with a body.toml, found {}", keys.len());
        fault(Fault::file(&overlay.expected(&folder), message));
    }
    let mut whole = true;
    for body in &keys {
        hash.update(body.as_bytes());
        match read_tree(overlay, &format!("{folder}/{body}/body.toml"), "a file for the body of this folder", faults, hash) {
            Some(node) => specs.push(read_body(body, Reader::new(&node, faults))),
            None => whole = false,
        }
    }
    let order = order(&specs, &keys.iter().map(String::as_str).collect::<Vec<_>>(), faults)?;
    if !whole {
        return None;
    }
    let specs: Vec<BodySpec> = order.into_iter().map(|i| specs[i].clone()).collect();
    if !faults.borrow().is_empty() {
        return None;
    }
    // Maps are most of the work, and independent of each other.
    let done = AtomicUsize::new(0);
    let grounds: Vec<Ground> = specs
        .par_iter()
        .map(|s| {
            let ground = ground(s, overlay, &format!("{folder}/{}", s.key));
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
    if !faults.borrow().is_empty() {
        return None;
    }
    let hash = hash.finalize().to_hex().to_string();
    let (name, masses) = top?;
    build(key, name, specs, masses, reliefs, hash).map_err(|f| faults.borrow_mut().push(f)).ok()
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

/// The star first, then depth first: each body by its distance from its parent, its moons behind it. `None` where the tree
/// of parents is broken, which is then written down.
fn order(specs: &[BodySpec], folders: &[&str], faults: &Faults) -> Option<Vec<usize>> {
    let before = faults.borrow().len();
    let find = |key: &str| specs.iter().position(|s| s.key == key);
    let mut roots = Vec::new();
    for (i, s) in specs.iter().enumerate() {
        let Some((parent, at)) = &s.parent else {
            roots.push(i);
            continue;
        };
        if find(parent).is_none() && !folders.contains(&parent.as_str()) {
            let message = format!("`parent` = \"{parent}\": expected the folder of another body of this system");
            let others = folders.iter().copied().filter(|f| *f != s.key);
            faults.borrow_mut().push(Fault::at(at, message).help(nearest(parent, others)));
        }
        // A walk of more steps than there are bodies goes round.
        let mut at_body = Some(i);
        for _ in 0..=specs.len() {
            at_body = at_body.and_then(|b| specs[b].parent.as_ref()).and_then(|(p, _)| find(p));
        }
        if at_body.is_some() {
            let message = format!("`parent` = \"{parent}\": the parents of `{}` go round in a circle: expected a way to the star", s.key);
            faults.borrow_mut().push(Fault::at(at, message));
        }
    }
    // Who shines is the star; the others are at fault.
    roots.sort_by_key(|i| specs[*i].intensity_cd.max_element() <= 0.0);
    match roots.as_slice() {
        [_] => {}
        [] if specs.is_empty() => {}
        [] => faults.borrow_mut().push(Fault::at(&specs[0].at, "every body has a `parent`: expected one body without, the star")),
        [first, rest @ ..] => {
            for i in rest {
                let message = format!("no `parent`, as `{}` has none: expected only one body without, the star", specs[*first].key);
                faults.borrow_mut().push(Fault::at(&specs[*i].at, message));
            }
        }
    }
    if let [root] = roots.as_slice()
        && specs[*root].intensity_cd.max_element() <= 0.0
    {
        let message = "missing table [star]: expected it in the body without a `parent`";
        faults.borrow_mut().push(Fault::at(&specs[*root].at, message));
    }
    if faults.borrow().len() > before {
        return None;
    }
    let mut order = Vec::new();
    let mut open: Vec<usize> = roots;
    while let Some(i) = open.pop() {
        order.push(i);
        let mut children: Vec<usize> =
            (0..specs.len()).filter(|c| specs[*c].parent.as_ref().is_some_and(|(p, _)| *p == specs[i].key)).collect();
        children.sort_by(|a, b| distance(&specs[*b], &specs[i]).total_cmp(&distance(&specs[*a], &specs[i])));
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
    name: String,
    specs: Vec<BodySpec>,
    masses: Vec<(String, Mass)>,
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
        masses: masses.iter().map(|m| m.1).collect(),
    };
    let ephemeris = Ephemeris::detailed(&orbits, &details).map_err(|e| no_ephemeris(&e, &specs, &masses))?;
    let soi = |i: usize| -> f64 {
        let Some(parent) = parents[i] else { return f64::INFINITY };
        let reach = ephemeris.reach(u16::try_from(i).map(BodyId).unwrap_or(BodyId(0)));
        let a = 0.5 * (reach.nearest_m + reach.farthest_m);
        // Laplace's sphere: a (m/M)^(2/5).
        a * libm::pow(specs[i].gm_m3_s2 / specs[parent.index()].gm_m3_s2, 0.4)
    };
    let soi: Vec<f64> = (0..specs.len()).map(soi).collect();
    let bodies = specs.iter().zip(&parents).zip(reliefs).zip(soi).map(|(((s, parent), relief), soi_radius_m)| Body {
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
        air: s.air.clone().and_then(|a| Some(Air { column: a.column?, look: a.medium?.into() })),
        relief,
        relief_max: s.relief.as_ref().map_or(1.0, |(_, max)| *max),
    });
    let bodies = bodies.collect();
    Ok(System::new(key.to_owned(), name, bodies, ephemeris, hash))
}
