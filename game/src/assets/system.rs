//! From a system's files to a [`System`]: ranges, references between bodies, maps, spheres of influence.

use super::document::{Document, Overlay};
use super::fault::{AssetErrors, did_you_mean};
use super::schema::{BodyFile, OrbitTable, RotationTable, SystemFile, TermTable};
use crate::world::system::{Air, Body, System};
use engine::air::RangeError;
use engine::air::density::Column;
use engine::orbit::ephemeris::{Ephemeris, MeanOrbit, Orbit, Path as OrbitPath};
use engine::orbit::rotation::{Spin, Term};
use engine::orbit::{BodyId, State};
use engine::space::relative::narrow3;
use engine::space::{Position, Velocity};
use engine::terrain::map::{ColourMap, CubeMap};
use engine::terrain::relief::Maps;
use engine::terrain::{Relief, spec::ReliefSpec};
use engine::time::SimTime;
use engine::units::{AU, DAY, DEG, KM, KM3_S2};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Days of a Julian year.
const YEAR: f64 = 365.25 * DAY;

struct Read {
    key: String,
    document: Document,
    file: BodyFile,
}

/// Reads a system; `progress` hears how much of it is done, 0 … 1.
pub fn load(overlay: &Overlay, key: &str, progress: &(dyn Fn(f32, &str) + Sync)) -> Result<Arc<System>, AssetErrors> {
    let folder = Path::new("systems").join(key);
    let head = Document::open(overlay, &folder.join("system.toml"))?;
    let system: SystemFile = head.parse()?;
    let mut errors = AssetErrors::default();
    let mut keys = system.bodies.clone();
    for (index, body) in keys.iter().enumerate() {
        if keys[..index].contains(body) {
            errors.push(head.fault_at(&format!("bodies[{index}]"), format!("`{body}` stands in the list twice")));
        }
    }
    // A mod adds a body by adding its folder.
    keys.extend(overlay.entries(&folder).into_iter().filter(|name| {
        !system.bodies.contains(name) && overlay.roots[1..].iter().any(|root| root.join(&folder).join(name).join("body.toml").is_file())
    }));
    let epoch = SimTime::from_jd_tdb(system.epoch_jd_tdb);
    check(&mut errors, &head, "epoch_jd_tdb", system.epoch_jd_tdb, -3.0e7, 4.0e7);
    let mut read = Vec::new();
    for body in &keys {
        let file = folder.join(body).join("body.toml");
        let opened = Document::open(overlay, &file).and_then(|document| {
            let file: BodyFile = document.parse()?;
            Ok(Read { key: body.clone(), document, file })
        });
        read.extend(errors.keep(opened));
    }
    if read.is_empty() {
        errors.push(head.fault_at("bodies", "a system needs at least a star"));
    }
    let mut errors = errors.or(()).err().unwrap_or_default();
    let parents = parents(&mut errors, &read);
    for body in &read {
        check_body(&mut errors, body);
    }
    let mut errors = errors.or(()).err().unwrap_or_default();
    if !errors.faults.is_empty() {
        return Err(errors);
    }
    let orbits: Vec<Orbit> = read.iter().zip(&parents).map(|(b, parent)| orbit(&b.file, *parent, epoch)).collect();
    let ephemeris = Ephemeris::new(orbits).map_err(|e| AssetErrors::one(head.fault_at("bodies", e.to_string())))?;
    // Maps are most of the work, and independent of each other.
    let done = std::sync::atomic::AtomicUsize::new(0);
    let grounds: Vec<Result<Option<(Arc<Relief>, String)>, AssetErrors>> = read
        .par_iter()
        .map(|b| {
            let ground = b.file.relief.as_ref().map(|spec| relief(overlay, &folder.join(&b.key), b, spec)).transpose();
            let count = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            progress(count as f32 / read.len() as f32, &b.file.name);
            ground
        })
        .collect();
    let mut hasher = blake3::Hasher::new();
    hasher.update(head.text.as_bytes());
    let mut bodies = Vec::new();
    for (index, ((b, ground), parent)) in read.iter().zip(grounds).zip(&parents).enumerate() {
        hasher.update(b.key.as_bytes()).update(b.document.text.as_bytes());
        let ground = errors.keep(ground).flatten();
        if let Some((_, hash)) = &ground {
            hasher.update(hash.as_bytes());
        }
        bodies.extend(errors.keep(body(b, index, *parent, ground.map(|g| g.0), &read, &ephemeris, epoch)));
    }
    errors.or(Arc::new(System { key: key.to_owned(), name: system.name, bodies, ephemeris, hash: hasher.finalize().to_hex().to_string() }))
}

fn check(errors: &mut AssetErrors, doc: &Document, key: &str, value: f64, low: f64, high: f64) {
    if !(low..=high).contains(&value) {
        errors.push(doc.fault_at(key, format!("{key} = {value}: expected a number from {low} to {high}")));
    }
}

/// The parents as handles; a parent must stand before its child, and only the first body has none.
#[allow(clippy::cast_possible_truncation)]
fn parents(errors: &mut AssetErrors, read: &[Read]) -> Vec<Option<BodyId>> {
    let position = |key: &str| read.iter().position(|b| b.key == key);
    let mut parents = Vec::new();
    for (index, body) in read.iter().enumerate() {
        let parent = match &body.file.parent {
            None if index == 0 => None,
            None => {
                errors.push(body.document.fault_at("name", "parent is missing: only the first body of the system, its star, has none"));
                None
            }
            Some(name) => match position(name) {
                Some(at) if at < index => Some(BodyId(at as u16)),
                Some(_) => {
                    let message = format!("the parent `{name}` must stand before `{}` in system.toml, and a body is not its own", body.key);
                    errors.push(body.document.fault_at("parent", message));
                    None
                }
                None => {
                    let fault = body.document.fault_at("parent", format!("there is no body `{name}` in this system"));
                    let near = did_you_mean(name, read.iter().map(|b| b.key.as_str()));
                    errors.push(match near {
                        Some(near) => fault.help(format!("did you mean `{near}`?")),
                        None => fault.help(format!("bodies are {}", read.iter().map(|b| b.key.as_str()).collect::<Vec<_>>().join(", "))),
                    });
                    None
                }
            },
        };
        parents.push(parent);
    }
    parents
}

fn check_body(errors: &mut AssetErrors, body: &Read) {
    let (doc, f) = (&body.document, &body.file);
    let mut range = |key: &str, value: f64, low: f64, high: f64| check(errors, doc, key, value, low, high);
    range("radius_km", f.radius_km, 0.1, 1.0e8);
    range("gm_km3_s2", f.gm_km3_s2, 1.0e-12, 1.0e15);
    range("relief_max", f.relief_max, 1.0, 100.0);
    for (i, a) in f.albedo.iter().enumerate() {
        range(&format!("albedo[{i}]"), *a, 0.0, 1.0);
    }
    for (key, pair) in
        [("pole_ra_deg", f.rotation.pole_ra_deg), ("pole_dec_deg", f.rotation.pole_dec_deg), ("meridian_deg", f.rotation.meridian_deg)]
    {
        for (i, value) in pair.iter().enumerate() {
            range(&format!("rotation.{key}[{i}]"), *value, -1.0e6, 1.0e6);
        }
    }
    for (i, t) in f.rotation.terms.iter().enumerate() {
        for (key, value) in [("ra_deg", t.ra_deg), ("dec_deg", t.dec_deg), ("meridian_deg", t.meridian_deg), ("phase_deg", t.phase_deg)] {
            range(&format!("rotation.terms[{i}].{key}"), value, -720.0, 720.0);
        }
        range(&format!("rotation.terms[{i}].rate_deg_per_century"), t.rate_deg_per_century, -1.0e9, 1.0e9);
    }
    for (i, lx) in f.star.iter().flat_map(|s| s.illuminance_at_1_au_lx).enumerate() {
        range(&format!("star.illuminance_at_1_au_lx[{i}]"), lx, 0.0, 1.0e9);
    }
    match &f.orbit {
        OrbitTable::Barycentric { position_km, velocity_km_s, .. } | OrbitTable::Relative { position_km, velocity_km_s } => {
            for i in 0..3 {
                range(&format!("orbit.position_km[{i}]"), position_km[i], -1.0e12, 1.0e12);
                range(&format!("orbit.velocity_km_s[{i}]"), velocity_km_s[i], -1.0e5, 1.0e5);
            }
        }
        OrbitTable::Elements { epoch_jd_tdb, semi_major_axis_km, eccentricity, mean_motion_deg_per_day, .. } => {
            range("orbit.epoch_jd_tdb", *epoch_jd_tdb, -3.0e7, 4.0e7);
            range("orbit.semi_major_axis_km", *semi_major_axis_km, 1.0, 1.0e12);
            range("orbit.eccentricity", *eccentricity, 0.0, 0.999);
            range("orbit.mean_motion_deg_per_day", *mean_motion_deg_per_day, -1.0e6, 1.0e6);
            for (key, angle) in f.orbit.angles() {
                range(&format!("orbit.{key}"), angle, -720.0, 720.0);
            }
        }
    }
    if f.star.is_none() && f.parent.is_none() {
        errors.push(doc.fault_at("name", "the star needs a [star] table with `illuminance_at_1_au_lx`"));
    }
}

impl OrbitTable {
    fn angles(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Elements { pole_ra_deg, pole_dec_deg, inclination_deg, node_deg, periapsis_deg, mean_anomaly_deg, .. } => vec![
                ("pole_ra_deg", *pole_ra_deg),
                ("pole_dec_deg", *pole_dec_deg),
                ("inclination_deg", *inclination_deg),
                ("node_deg", *node_deg),
                ("periapsis_deg", *periapsis_deg),
                ("mean_anomaly_deg", *mean_anomaly_deg),
            ],
            _ => Vec::new(),
        }
    }
}

fn orbit(file: &BodyFile, parent: Option<BodyId>, epoch: SimTime) -> Orbit {
    let path = match &file.orbit {
        OrbitTable::Barycentric { position_km, velocity_km_s, with_moons } => OrbitPath::Barycentric {
            epoch,
            state: State {
                position: Position::new(DVec3::from(*position_km) * KM),
                velocity: Velocity::new(DVec3::from(*velocity_km_s) * KM),
            },
            of_system: *with_moons,
        },
        OrbitTable::Relative { position_km, velocity_km_s } => OrbitPath::FromParent {
            epoch,
            state: State {
                position: Position::new(DVec3::from(*position_km) * KM),
                velocity: Velocity::new(DVec3::from(*velocity_km_s) * KM),
            },
        },
        OrbitTable::Elements {
            epoch_jd_tdb,
            pole_ra_deg,
            pole_dec_deg,
            semi_major_axis_km,
            eccentricity,
            inclination_deg,
            node_deg,
            periapsis_deg,
            mean_anomaly_deg,
            mean_motion_deg_per_day,
            node_rate_deg_per_year,
            periapsis_rate_deg_per_year,
        } => OrbitPath::Mean(MeanOrbit {
            epoch: SimTime::from_jd_tdb(*epoch_jd_tdb),
            semi_major_m: semi_major_axis_km * KM,
            eccentricity: *eccentricity,
            inclination_rad: inclination_deg * DEG,
            node_rad: [node_deg * DEG, node_rate_deg_per_year * DEG / YEAR],
            argument_rad: [periapsis_deg * DEG, periapsis_rate_deg_per_year * DEG / YEAR],
            mean_anomaly_rad: mean_anomaly_deg * DEG,
            mean_longitude_rate_rad_s: mean_motion_deg_per_day * DEG / DAY,
            pole_ra_dec_rad: [pole_ra_deg * DEG, pole_dec_deg * DEG],
        }),
    };
    Orbit { parent, gm_m3_s2: file.gm_km3_s2 * KM3_S2, path }
}

fn spin(table: &RotationTable) -> Spin {
    let pair = |p: [f64; 2]| [p[0] * DEG, p[1] * DEG];
    let terms = |amplitude: fn(&TermTable) -> f64| {
        table
            .terms
            .iter()
            .filter(|t| amplitude(t) != 0.0)
            .map(|t| Term {
                amplitude_rad: amplitude(t) * DEG,
                phase_rad: t.phase_deg * DEG,
                rate_rad_per_century: t.rate_deg_per_century * DEG,
            })
            .collect()
    };
    Spin {
        pole_ra_rad: pair(table.pole_ra_deg),
        pole_dec_rad: pair(table.pole_dec_deg),
        meridian_rad: pair(table.meridian_deg),
        pole_ra_terms: terms(|t| t.ra_deg),
        pole_dec_terms: terms(|t| t.dec_deg),
        meridian_terms: terms(|t| t.meridian_deg),
        ..Spin::default()
    }
}

/// The ground with its maps, and a hash of what collisions depend on.
fn relief(overlay: &Overlay, folder: &Path, body: &Read, spec: &ReliefSpec) -> Result<(Arc<Relief>, String), AssetErrors> {
    let mut errors = AssetErrors::default();
    let mut hasher = blake3::Hasher::new();
    let mut cube = |errors: &mut AssetErrors, name: &Option<String>| -> Option<Arc<CubeMap>> {
        let (path, bytes) = errors.keep(overlay.binary(&folder.join(name.as_ref()?)))?;
        hasher.update(&bytes);
        let map = CubeMap::read(&bytes).map_err(|e| AssetErrors::one(super::fault::Fault::of_file(&path, e.to_string())));
        errors.keep(map).map(Arc::new)
    };
    let height = cube(&mut errors, &spec.map);
    let coast = cube(&mut errors, &spec.coast);
    let colour = spec.colour.as_ref().and_then(|name| errors.keep(overlay.binary(&folder.join(name)).and_then(colour)));
    let maps = Maps { height, coast, colour: colour.map(Arc::new) };
    let built = Relief::new(body.file.radius_km * KM, spec.clone(), maps).map_err(|e| AssetErrors {
        faults: e
            .to_string()
            .lines()
            .map(|line| body.document.fault_at(line.split([' ', ':', '=']).next().unwrap_or("relief"), line))
            .collect(),
    });
    // A map that could not be read is one fault, not two.
    let ground = if errors.faults.is_empty() { errors.keep(built) } else { None };
    match ground {
        Some(ground) => Ok((Arc::new(ground), hasher.finalize().to_hex().to_string())),
        None => Err(errors),
    }
}

fn colour((path, bytes): (PathBuf, Vec<u8>)) -> Result<ColourMap, AssetErrors> {
    let fault = |message: String| AssetErrors::one(super::fault::Fault::of_file(&path, message));
    let mut decoder = jpeg_decoder::Decoder::new(bytes.as_slice());
    let rgb = decoder.decode().map_err(|e| fault(format!("not a JPEG picture that can be read: {e}")))?;
    let info = decoder.info().ok_or_else(|| fault("the JPEG picture has no header".to_owned()))?;
    if info.pixel_format != jpeg_decoder::PixelFormat::RGB24 {
        return Err(fault(format!("the picture is {:?}: expected 8-bit RGB", info.pixel_format)));
    }
    Ok(ColourMap { width: u32::from(info.width), height: u32::from(info.height), rgb })
}

fn body(
    b: &Read,
    index: usize,
    parent: Option<BodyId>,
    relief: Option<Arc<Relief>>,
    all: &[Read],
    ephemeris: &Ephemeris,
    epoch: SimTime,
) -> Result<Body, AssetErrors> {
    let f = &b.file;
    let radius_m = f.radius_km * KM;
    let ranges = |table: &'static str, errors: Vec<RangeError>| AssetErrors {
        faults: errors.into_iter().map(|e| b.document.fault_at(&format!("{table}.{}", e.field), format!("{table}.{e}"))).collect(),
    };
    let mut errors = AssetErrors::default();
    let air = f.air.as_ref().and_then(|air| {
        let column = errors.keep(Column::new(&air.column).map_err(|e| ranges("air.column", e)));
        let medium = errors.keep(air.medium.build(radius_m).map_err(|e| ranges("air.medium", e)));
        Some(Air { column: column?, medium: medium? })
    });
    let gm = f.gm_km3_s2 * KM3_S2;
    // Laplace: r = a (m/M)^(2/5), a the present distance from the parent.
    #[allow(clippy::cast_possible_truncation)]
    let soi_radius_m = parent.map_or(f64::INFINITY, |p| {
        let distance = ephemeris.relative(BodyId(index as u16), p, epoch).position.length();
        distance * libm::pow(f.gm_km3_s2 / all[p.index()].file.gm_km3_s2, 0.4)
    });
    let intensity = f.star.as_ref().map_or(DVec3::ZERO, |s| DVec3::from(s.illuminance_at_1_au_lx) * (AU * AU));
    errors.or(Body {
        key: b.key.clone(),
        name: f.name.clone(),
        parent,
        gm_m3_s2: gm,
        radius_m,
        soi_radius_m,
        spin: spin(&f.rotation),
        albedo: narrow3(DVec3::from(f.albedo)),
        intensity_cd: if f.star.is_some() { narrow3(intensity) } else { Vec3::ZERO },
        air,
        relief,
        relief_max: f.relief_max,
    })
}
