//! What things begin with that are added to an air by hand: numbers of Earth's, so that one sees at once what was added.

use super::super::atmosphere::keys;
use super::super::fields::Ways;
use engine::units::DEG;
use glam::DVec3;
use serde_json::{Map, Value, json};

/// What an air begins with that a body is given: a thin one of air and haze, whose numbers are Earth's.
pub fn first_air(radius_m: f64) -> Value {
    json!({
        "model": "physical",
        "top_altitude_m": (radius_m * 0.1).clamp(1e3, 1e5).round(),
        "ground_albedo": [0.1, 0.1, 0.1],
        "layers": [layer("gas"), layer("haze")],
    })
}

/// Puts what a model cannot do without beside what is there.
pub fn fill(values: &mut Map<String, Value>, model: &str, radius_m: f64) {
    let first = first_air(radius_m);
    for key in keys::needed(model) {
        if !values.contains_key(*key) {
            values.insert((*key).to_owned(), first[*key].clone());
        }
    }
}

/// A layer to begin with, of a name in [`LAYERS`].
pub fn layer(kind: &str) -> Value {
    let (scattering, absorption, profile, phase) = match kind {
        "gas" => (
            [5.8e-6, 13.56e-6, 33.1e-6],
            [0.0; 3],
            json!({ "kind": "exponential", "scale_height_m": 8000.0 }),
            json!({ "kind": "rayleigh" }),
        ),
        "absorber" => {
            let tent = json!({ "kind": "tent", "bottom_m": 10_000.0, "peak_m": 25_000.0, "top_m": 40_000.0 });
            ([0.0; 3], [1.6e-6, 1.8e-6, 1.2e-7], tent, json!({ "kind": "isotropic" }))
        }
        "fog" => (
            [1e-3; 3],
            [0.0; 3],
            json!({ "kind": "constant", "bottom_m": 0.0, "top_m": 300.0 }),
            json!({ "kind": "henyey_greenstein", "g": 0.8 }),
        ),
        _ => (
            [4e-6; 3],
            [4.4e-7; 3],
            json!({ "kind": "exponential", "scale_height_m": 1200.0 }),
            json!({ "kind": "cornette_shanks", "g": 0.8 }),
        ),
    };
    json!({ "name": kind, "scattering_per_m": scattering, "absorption_per_m": absorption, "profile": profile, "phase": phase })
}

/// Layers that can be added.
pub const LAYERS: [&str; 4] = ["gas", "haze", "absorber", "fog"];

/// What a key begins with, by its path in the file; `None` where the middle of its range will do.
pub fn first(path: &str) -> Option<Value> {
    Some(match path {
        "spectrum" => json!("spectral"),
        "wavelengths_nm" => json!([680.0, 550.0, 440.0]),
        "top_altitude_m" => json!(100_000.0),
        "ground_albedo" => json!([0.1, 0.1, 0.1]),
        "physics" => json!({
            "kind": "hydrostatic", "drag_top_m": 150_000.0, "temperature_k": 288.0, "pressure_pa": 101_325.0,
            "molar_mass_kg_mol": 0.029, "heat_capacity_ratio": 1.4,
        }),
        "physics.drag_top_m" => json!(150_000.0),
        "physics.temperature_k" | "layers.gas.temperature_k" => json!(288.0),
        "physics.pressure_pa" | "layers.gas.pressure_pa" => json!(101_325.0),
        "physics.molar_mass_kg_mol" | "layers.gas.molar_mass_kg_mol" => json!(0.029),
        "physics.heat_capacity_ratio" => json!(1.4),
        "physics.lapse" => json!([{ "to_altitude_m": 11_000.0, "k_per_m": -0.0065 }]),
        "layers.scattering_per_m" => layer("gas")["scattering_per_m"].clone(),
        "layers.absorption_per_m" => layer("gas")["absorption_per_m"].clone(),
        "layers.profile" => layer("gas")["profile"].clone(),
        "layers.profile.scale_height_m" | "layers.gas.scale_height_m" => json!(8000.0),
        "layers.profile.bottom_m" => json!(0.0),
        "layers.profile.peak_m" => json!(5_000.0),
        "layers.profile.top_m" => json!(10_000.0),
        "layers.profile.altitude_m" => json!([0.0, 10_000.0]),
        "layers.profile.density" => json!([1.0, 0.0]),
        "layers.phase" => layer("gas")["phase"].clone(),
        "layers.phase.g" => json!(0.8),
        "layers.phase.value" => json!([1.0, 1.0]),
        "layers.gas" => json!({ "molecules": { "air": 1.0 }, "pressure_pa": 101_325.0, "temperature_k": 288.0 }),
        "layers.gas.molecules" => json!({ "air": 1.0 }),
        "layers.gas.refractive_index" => json!(1.000_278),
        "layers.gas.depolarisation" | "layers.aerosol.angstrom_exponent" => json!(0.0),
        "layers.gas.molecular_density_per_m3" => json!(2.55e25),
        "layers.aerosol" => json!({ "optical_depth": 0.1, "single_scattering_albedo": 0.95 }),
        "layers.aerosol.optical_depth" => json!(0.1),
        "layers.aerosol.particle_density_per_m3" => json!(1e8),
        "layers.aerosol.particle_radius_m" => json!(1e-6),
        "layers.aerosol.efficiency" => json!(2.0),
        "layers.aerosol.single_scattering_albedo" => json!(0.95),
        "layers.absorber" => json!({ "species": "ozone", "column_du": 300.0 }),
        "layers.absorber.column_du" => json!(300.0),
        "layers.table" => json!({
            "wavelengths_nm": [440.0, 550.0, 680.0], "scattering_per_m": [33.1e-6, 13.56e-6, 5.8e-6], "absorption_per_m": [0.0, 0.0, 0.0],
        }),
        "fog.thickness" => json!({ "opacity": 3.0 }),
        _ => return None,
    })
}

/// The ways to fill the table at a path, where there are several.
pub fn ways(path: &str) -> Option<&'static Ways> {
    keys::WAYS.iter().find(|(at, _)| *at == path).map(|(_, ways)| ways)
}

/// Where a ship is, as far as a bank of fog before it needs that.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place {
    /// Latitude and longitude, rad.
    pub lat_lon_rad: (f64, f64),
    /// Heading, rad.
    pub heading_rad: f64,
    /// Altitude above the datum, m.
    pub altitude_m: f64,
    /// Height of the ground above the datum, m.
    pub ground_m: f64,
    /// Radius of the datum, m.
    pub radius_m: f64,
}

/// A bank of fog on the ground ahead of a ship, as large as it is high, so that it is in the picture.
pub fn bank(place: Place, name: &str) -> Value {
    let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
    let radius_m = finite(place.altitude_m - place.ground_m).max(300.0).min(0.2 * place.radius_m.max(1e4));
    let ahead = 3.0 * radius_m / place.radius_m.max(1e4);
    let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = (libm::sincos(finite(place.lat_lon_rad.0)), libm::sincos(finite(place.lat_lon_rad.1)));
    let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
    let (north, east) = (DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat), DVec3::new(-sin_lon, cos_lon, 0.0));
    let (sin_heading, cos_heading) = libm::sincos(finite(place.heading_rad));
    let (sin_ahead, cos_ahead) = libm::sincos(ahead);
    let there = up * cos_ahead + (north * cos_heading + east * sin_heading) * sin_ahead;
    let deg = |rad: f64| (rad / DEG * 1e5).round() / 1e5;
    json!({
        "name": name,
        "latitude_deg": deg(libm::asin(there.z.clamp(-1.0, 1.0))),
        "longitude_deg": deg(libm::atan2(there.y, there.x)),
        "altitude_m": finite(place.ground_m).round(),
        "radius_m": radius_m.round(),
        "thickness": first("fog.thickness"),
    })
}
