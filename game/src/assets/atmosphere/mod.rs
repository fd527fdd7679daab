//! A body's air, `atmosphere.toml`: what one sees at the top, what drags in `[physics]`, each described on its own.
//!
//! The keys are data ([`keys`]); a file that holds to them is built into the engine's types here and by [`layers`], whose range checks'
//! messages find their line. An air that can be built and is hardly meant is told by [`plausible`].

pub mod fog;
pub mod keys;
pub mod layers;
pub mod optics;
pub mod plausible;

use super::fault::{Fault, nearest};
use super::fields;
use super::overlay::{DATA_MAX, Overlay, read_bytes};
use super::reader::{ANY, Reader};
use super::tree::{Data, Node};
use crate::world::system::Fog;
use engine::air::density::Lapse;
use engine::air::model::{ColourMap, Gradient};
use engine::air::refraction::ByWavelength;
use engine::air::spectral::SpectralMedium;
use engine::air::{Air, Column, ColumnSpec, Model, RangeError};
use engine::light::spectrum::Starlight;
use engine::units::NM;
use optics::Channels;
use std::path::Path;
use std::sync::Arc;

/// Air as its file describes it.
#[derive(Clone, Debug, Default)]
pub struct AirSpec {
    /// What drags, if anything does.
    pub column: Option<Column>,
    /// What one sees, if anything.
    pub look: Option<Air>,
    /// What `look` was drawn from.
    pub by_wavelength: Option<SpectralMedium>,
    /// Banks of fog and nebulae.
    pub fog: Vec<Fog>,
}

/// What a body lends to its air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Datum {
    /// Radius of the datum, m.
    pub radius_m: f64,
    /// Gravity there, m/s².
    pub gravity_m_s2: f64,
}

impl Datum {
    /// Of a body with this GM (m³/s²) and radius (m). One whose numbers are at fault gets no second fault for its air: they count as
    /// Earth's.
    pub fn new(gm_m3_s2: f64, radius_m: f64) -> Self {
        let radius_m = if radius_m.is_finite() { radius_m } else { 6.371e6 };
        let gravity_m_s2 = if gm_m3_s2.is_finite() { gm_m3_s2 / (radius_m * radius_m) } else { 9.8 };
        Self { radius_m, gravity_m_s2 }
    }
}

/// What an air is seen by, and where the files lie that it names.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// Where the files are found that it names.
    pub overlay: &'a Overlay,
    /// In which folder, by its relative path.
    pub folder: &'a str,
    /// The light under which its colours are found.
    pub star: &'a Starlight,
}

/// Reads the file: faults and warnings go to the reader.
pub fn read_air(r: &Reader<'_>, datum: Datum, setting: &Setting<'_>) -> AirSpec {
    let before = r.errors();
    fields::check(r.again(), keys::ATMOSPHERE);
    if r.errors() > before {
        return AirSpec::default();
    }
    let column = r.maybe_table("physics").and_then(|t| tell(&t, "", Column::new(&column_of(&t, datum))));
    let (look, by_wavelength) = look_of(r, datum, setting).unzip();
    if let Some(look) = look.as_ref().filter(|_| r.errors() == before) {
        plausible::suspicions(r.node, look, column.as_ref(), datum.gravity_m_s2).into_iter().for_each(|s| r.fault(s));
    }
    AirSpec { column, look, by_wavelength, fog: fog::read(r, datum) }
}

/// Turns range errors into faults; `table` is where their fields are, with a point behind it.
fn tell<T>(r: &Reader<'_>, table: &str, built: Result<T, Vec<RangeError>>) -> Option<T> {
    built
        .map_err(|errors| {
            for e in errors.iter().filter(|e| !e.found.is_nan()) {
                let field = format!("{table}{}", e.field);
                r.wrong(&field, format!("`{field}` = {} is out of range: expected {}", e.found, e.expected));
            }
        })
        .ok()
}

/// `[physics]`, which holds to its keys.
fn column_of(r: &Reader<'_>, datum: Datum) -> ColumnSpec {
    let number = |key| r.number(key, ANY);
    let drag_top_m = number("drag_top_m");
    if r.node.get("kind").and_then(|e| e.value.text()) == Some("us76") {
        return ColumnSpec::Us76 { drag_top_m };
    }
    let lapse = |t: Reader<'_>| Lapse { to_altitude_m: t.number("to_altitude_m", ANY), k_per_m: t.number("k_per_m", ANY) };
    ColumnSpec::Hydrostatic {
        drag_top_m,
        radius_m: datum.radius_m,
        gravity_m_s2: datum.gravity_m_s2,
        temperature_k: number("temperature_k"),
        pressure_pa: number("pressure_pa"),
        molar_mass_kg_mol: number("molar_mass_kg_mol"),
        heat_capacity_ratio: number("heat_capacity_ratio"),
        lapse: r.tables("lapse").into_iter().map(lapse).collect(),
    }
}

/// The look. What each model cannot do without is asked for here.
fn look_of(r: &Reader<'_>, datum: Datum, setting: &Setting<'_>) -> Option<(Air, SpectralMedium)> {
    let before = r.errors();
    let word = r.node.get("model").and_then(|e| e.value.text()).unwrap_or("physical");
    fields::demand(r, keys::ATMOSPHERE, keys::needed(word));
    if word == "none" || r.errors() > before {
        return None;
    }
    let top_altitude_m = r.number("top_altitude_m", ANY);
    let ground_albedo = if r.has("ground_albedo") { r.numbers("ground_albedo", ANY) } else { [0.0; 3] };
    let wavelengths_m = r.has("wavelengths_nm").then(|| r.numbers("wavelengths_nm", ANY).map(|nm| nm * NM));
    let wavelengths_m = wavelengths_m.unwrap_or(SpectralMedium::WAVELENGTHS_M);
    let layers = layers::read(r, datum, Channels { wavelengths_m });
    let model = model_of(r, word, setting);
    let by_wavelength = SpectralMedium { bottom_radius_m: datum.radius_m, top_altitude_m, ground_albedo, wavelengths_m, layers };
    let spectral = word == "physical" && r.node.get("spectrum").and_then(|e| e.value.text()) == Some("spectral");
    let drawn = tell(r, "", by_wavelength.draw(spectral, setting.star));
    if r.errors() > before {
        return None;
    }
    let (medium, bands) = drawn?;
    let gases = by_wavelength.refractive();
    let light = ByWavelength::new(&by_wavelength, &setting.star.spectrum());
    Some((Air { medium, bands, gases, by_wavelength: Some(Arc::new(light)), model: model? }, by_wavelength))
}

/// The model that a word names, with the settings in the table of that name.
fn model_of(r: &Reader<'_>, word: &str, setting: &Setting<'_>) -> Option<Model> {
    let table = r.node.get(word).map(|e| &e.value).filter(|n| matches!(n.data, Data::Table(_)));
    let mut settings = table.map_or_else(|| serde_json::json!({}), Node::json);
    settings["model"] = word.into();
    if let Some(settings) = settings.as_object_mut() {
        // Names of files: the pictures take their places below.
        settings.retain(|key, _| !keys::MAPS.contains(&key.as_str()));
    }
    match serde_json::from_value::<Model>(settings) {
        Ok(mut model) => {
            if let Model::Gradient(gradient) = &mut model {
                painted(table, gradient, setting, r)?;
            }
            let errors = errors_of(&model);
            tell(r, &format!("{word}."), if errors.is_empty() { Ok(model) } else { Err(errors) })
        }
        Err(e) => {
            r.wrong(word, format!("[{word}]: {e}: expected the settings of the model"));
            None
        }
    }
}

/// What of a model's settings is out of range, by the keys of its own table.
fn errors_of(model: &Model) -> Vec<RangeError> {
    match model {
        Model::Physical(_) => Vec::new(),
        Model::Thickness(m) => m.validate(),
        Model::LimbTable(m) => m.validate(),
        Model::ViewTable(m) => m.validate(),
        Model::Gradient(m) => m.validate(),
    }
}

/// The pictures that the table `[gradient]` names; what it leaves out is the model's own.
fn painted(table: Option<&Node>, gradient: &mut Gradient, setting: &Setting<'_>, r: &Reader<'_>) -> Option<()> {
    let mut whole = Some(());
    for (key, map) in keys::MAPS.into_iter().zip([&mut gradient.shell_map, &mut gradient.ground_map]) {
        let Some(entry) = table.and_then(|t| t.get(key)) else { continue };
        let name = entry.value.text().unwrap_or_default();
        let plain = !name.contains(['/', '\\', ':']);
        let beside = |name: &str| setting.overlay.find(Path::new(setting.folder).join(name));
        let fault = match Some(name).filter(|_| plain).and_then(beside) {
            None => {
                let known: Vec<String> =
                    setting.overlay.names(setting.folder, Some(".png")).iter().map(|stem| format!("{stem}.png")).collect();
                Fault::at(&entry.value.at, format!("`gradient.{key}` = \"{name}\": expected a PNG that lies beside this file"))
                    .help(Some("in a mod it may also lie beside the file that a patch changes, in the assets".to_owned()))
                    .help(nearest(name, known.iter().map(String::as_str)))
            }
            Some(path) => match read_bytes(&path, DATA_MAX).and_then(|bytes| painting(&bytes).map_err(|what| Fault::file(&path, what))) {
                Ok(painted) => {
                    *map = painted;
                    continue;
                }
                Err(fault) => fault,
            },
        };
        r.fault(fault);
        whole = None;
    }
    whole
}

/// Decodes an 8-bit PNG with or without alpha.
fn painting(bytes: &[u8]) -> Result<ColourMap, String> {
    let expected = "expected an RGB or RGBA picture, PNG with 8 bits a channel";
    let bad = |e: png::DecodingError| format!("not a PNG that can be read: {e}; {expected}");
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().map_err(bad)?;
    let size = reader.output_buffer_size().filter(|n| *n <= 1 << 20).ok_or_else(|| format!("the picture is too large: {expected}"))?;
    let mut pixels = vec![0; size];
    let info = reader.next_frame(&mut pixels).map_err(bad)?;
    let rgba = match (info.color_type, info.bit_depth) {
        (png::ColorType::Rgba, png::BitDepth::Eight) => pixels,
        (png::ColorType::Rgb, png::BitDepth::Eight) => pixels.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect(),
        other => return Err(format!("the picture is {other:?}: {expected}")),
    };
    Ok(ColourMap { size: [info.width, info.height], rgba })
}
