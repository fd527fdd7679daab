//! The `[air]` table: `[air.column]` (what drags) and `[air.medium]` (what one sees), each described on its own.
//!
//! Range checks are the engine's; here its messages find their line.

use super::body::vec3;
use super::reader::{ANY, Reader};
use engine::air::density::Lapse;
use engine::air::{Column, ColumnSpec, Layer, Medium, MediumSpec, Phase, Profile, RangeError};
use engine::space::relative::narrow;

/// Air that passed its checks. `None` stands for faults.
#[derive(Clone, Debug)]
pub struct AirSpec {
    /// What drags.
    pub column: Option<Column>,
    /// What one sees.
    pub medium: Option<Medium>,
}

/// Reads the table of a body with this GM (m³/s²) and radius (m): they give the column its gravity, the medium its ground.
pub fn read_air(r: Reader<'_>, gm_m3_s2: f64, radius_m: f64) -> AirSpec {
    // A body whose radius is at fault gets no second fault for its air.
    let radius_m = if radius_m.is_finite() { radius_m } else { 6.371e6 };
    let gravity = if gm_m3_s2.is_finite() { gm_m3_s2 / (radius_m * radius_m) } else { 9.8 };
    let column = r.table("column").and_then(|t| {
        let spec = read_column(&t, radius_m, gravity);
        let built = tell(&t, Column::new(&spec));
        t.finish();
        built
    });
    let medium = r.table("medium").and_then(|t| {
        let spec = read_medium(&t);
        let built = tell(&t, spec.build(radius_m));
        t.finish();
        built
    });
    r.finish();
    AirSpec { column, medium }
}

/// Turns range errors into faults, except those that only repeat a placeholder.
fn tell<T>(r: &Reader<'_>, built: Result<T, Vec<RangeError>>) -> Option<T> {
    built
        .map_err(|errors| {
            for e in errors.iter().filter(|e| !e.found.is_nan()) {
                r.wrong(&e.field, format!("`{}` = {} is out of range: expected {}", e.field, e.found, e.expected));
            }
        })
        .ok()
}

fn read_column(r: &Reader<'_>, radius_m: f64, gravity_m_s2: f64) -> ColumnSpec {
    let kind = r.choice("kind", &["us76", "hydrostatic"]);
    let drag_top_m = r.number("drag_top_m", ANY);
    if kind == "us76" {
        return ColumnSpec::Us76 { drag_top_m };
    }
    ColumnSpec::Hydrostatic {
        drag_top_m,
        radius_m,
        gravity_m_s2,
        temperature_k: r.number("temperature_k", ANY),
        pressure_pa: r.number("pressure_pa", ANY),
        molar_mass_kg_mol: r.number("molar_mass_kg_mol", ANY),
        heat_capacity_ratio: r.number("heat_capacity_ratio", ANY),
        lapse: r
            .tables("lapse")
            .into_iter()
            .map(|t| {
                let lapse = Lapse { to_altitude_m: t.number("to_altitude_m", ANY), k_per_m: t.number("k_per_m", ANY) };
                t.finish();
                lapse
            })
            .collect(),
    }
}

fn read_medium(r: &Reader<'_>) -> MediumSpec {
    MediumSpec {
        top_altitude_m: r.number("top_altitude_m", ANY),
        ground_albedo: vec3(r.numbers("ground_albedo", ANY)),
        layers: r.tables("layers").into_iter().map(read_layer).collect(),
    }
}

fn read_layer(r: Reader<'_>) -> Layer {
    let layer = Layer {
        scattering_per_m: vec3(r.numbers("scattering_per_m", ANY)),
        absorption_per_m: vec3(r.numbers("absorption_per_m", ANY)),
        profile: r.table("profile").map_or(Profile::Exponential { scale_height_m: f32::NAN }, read_profile),
        phase: r.table("phase").map_or(Phase::Rayleigh, read_phase),
    };
    r.finish();
    layer
}

fn read_profile(r: Reader<'_>) -> Profile {
    let metres = |key| narrow(r.number(key, ANY));
    let profile = match r.choice("kind", &["exponential", "tent", "constant", "table"]) {
        "constant" => Profile::Constant { bottom_m: metres("bottom_m"), top_m: metres("top_m") },
        "table" => Profile::Table { altitude_m: list(&r, "altitude_m"), density: list(&r, "density") },
        "tent" => Profile::Tent { bottom_m: metres("bottom_m"), peak_m: metres("peak_m"), top_m: metres("top_m") },
        _ => Profile::Exponential { scale_height_m: metres("scale_height_m") },
    };
    r.finish();
    profile
}

fn list(r: &Reader<'_>, key: &'static str) -> Vec<f32> {
    r.column(key).into_iter().map(narrow).collect()
}

fn read_phase(r: Reader<'_>) -> Phase {
    let phase = match r.choice("kind", &["rayleigh", "henyey_greenstein", "cornette_shanks", "elek_rayleigh", "isotropic", "table"]) {
        "henyey_greenstein" => Phase::HenyeyGreenstein { g: narrow(r.number("g", ANY)) },
        "elek_rayleigh" => Phase::ElekRayleigh,
        "isotropic" => Phase::Isotropic,
        "table" => Phase::Table { angle_deg: list(&r, "angle_deg"), value: list(&r, "value") },
        "cornette_shanks" => Phase::CornetteShanks { g: narrow(r.number("g", ANY)) },
        _ => Phase::Rayleigh,
    };
    r.finish();
    phase
}
