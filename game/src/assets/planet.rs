//! A planet alone, for probes and benches: `F.toml` with its radius, its star at three wavelengths, and its air as in `atmosphere.toml`.
//!
//! ```toml
//! radius_km = 6360.0
//! [star]
//! wavelengths_nm = [680.0, 550.0, 440.0]        # the three channels of the air's coefficients, in this order
//! irradiance_w_m2_nm = [1.474, 1.8504, 1.91198] # above the air
//! angular_radius_deg = 0.2678
//! [atmosphere]                                  # or: atmosphere = "FILE"
//! top_altitude_m = 60000.0
//! # … all keys of atmosphere.toml
//! [[occluders]]                                # none, one or more spheres that may hide the star from the air
//! centre_m = [0.0, 0.0, 3.7e8]                  # from the planet's centre; or: direction = [x, y, z], distance_m = D
//! radius_m = 1.7374e6
//! ```
//! Not here: bodies of a system ([`super::body`]); the keys of an air ([`super::atmosphere::keys`]).

use super::atmosphere::{AirSpec, Datum, Setting, read_air};
use super::fault::{AssetErrors, Fault, Source};
use super::overlay::{Overlay, read_text};
use super::reader::{ANY, Faults, POSITIVE, Reader};
use super::tree::{Data, Entry, Node, parse};
use engine::air::Air;
use engine::air::reference::Sphere;
use engine::light::spectrum::Starlight;
use engine::scene::gpu_data::MAX_OCCLUDERS;
use engine::units::{DEG, KM, NM};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// The star as the planet sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// Wavelengths of the three channels, nm.
    pub wavelengths_nm: [f64; 3],
    /// Irradiance above the air at each, W m⁻² nm⁻¹.
    pub irradiance_w_m2_nm: [f64; 3],
    /// Angular radius, rad.
    pub angular_radius_rad: f64,
}

/// A planet alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Planet {
    /// Its star.
    pub star: Star,
    /// Its air, by the model that was asked for.
    pub air: Air,
    /// What may hide the star.
    pub occluders: Vec<Sphere>,
}

/// Reads a planet; `model` stands for what its air names. The settings of that model are those in the file's table of its name, or its own.
pub fn read_planet(path: &Path, model: Option<&str>) -> Result<Planet, AssetErrors> {
    planet_of(&read_text(path).map_err(AssetErrors::one)?, model)
}

/// The same from a text that is at hand.
pub fn planet_of(source: &Arc<Source>, model: Option<&str>) -> Result<Planet, AssetErrors> {
    let path = source.path.as_path();
    let mut top = parse(source).map_err(|faults| AssetErrors { faults })?;
    let mut elsewhere = match top.get("atmosphere").and_then(|e| e.value.text()) {
        Some(file) => Some(tree(&path.parent().unwrap_or(Path::new("")).join(file))?),
        None => None,
    };
    let channels = falling(&top);
    if let Some(air) = elsewhere.as_mut().or_else(|| inside(&mut top)) {
        model.iter().for_each(|word| put(air, "model", Data::Text((*word).to_owned())));
        // Three wavelengths are asked for: colours as the eye sees them are no part of it.
        put(air, "spectrum", Data::Text("rgb".to_owned()));
        if let Some(channels) = channels.filter(|_| air.get("wavelengths_nm").is_none()) {
            put(air, "wavelengths_nm", channels);
        }
    }
    let faults = Faults::default();
    let folder = path.parent().unwrap_or(Path::new(""));
    let planet = read(Reader::new(&top, &faults), elsewhere.as_ref(), folder, &faults);
    let found = AssetErrors { faults: faults.into_inner() };
    for warning in found.faults.iter().filter(|f| !f.is_error()) {
        tracing::warn!("{warning}");
    }
    found.or(())?;
    planet.ok_or_else(|| AssetErrors::one(Fault::file(path, "the planet has no air that is seen: expected a `model` other than \"none\"")))
}

fn tree(path: &Path) -> Result<Node, AssetErrors> {
    let source = read_text(path).map_err(AssetErrors::one)?;
    parse(&source).map_err(|faults| AssetErrors { faults })
}

fn inside(top: &mut Node) -> Option<&mut Node> {
    let Data::Table(entries) = &mut top.data else { return None };
    entries.iter_mut().find(|e| e.key == "atmosphere").map(|e| &mut e.value)
}

/// The star's wavelengths, where they fall as red, green and blue do: then an air that names none is given at them.
fn falling(top: &Node) -> Option<Data> {
    let list = &top.get("star")?.value.get("wavelengths_nm")?.value.data;
    let Data::Array(nodes) = list else { return None };
    let numbers: Vec<f64> = nodes.iter().filter_map(|n| if let Data::Number(x) = n.data { Some(x) } else { None }).collect();
    (numbers.len() == 3 && numbers.windows(2).all(|w| w[0] > w[1] + 1.0)).then(|| list.clone())
}

/// Puts a value into the table of an air, in place of what is there.
fn put(air: &mut Node, key: &str, data: Data) {
    let at = air.at.clone();
    let Data::Table(entries) = &mut air.data else { return };
    entries.retain(|e| e.key != key);
    let value = Node { at: at.clone(), data };
    entries.push(Entry { key: key.to_owned(), key_at: at, value });
}

/// The air at the star's wavelengths: three numbers of a file that names no wavelengths are those of the star, in its order.
fn at_star(spec: AirSpec, star: &Star, named: bool, r: &Reader<'_>) -> Option<Air> {
    let (mut air, by_wavelength) = (spec.look?, spec.by_wavelength?);
    // Rays are asked by wavelength, not by colour.
    air.bands = None;
    if !by_wavelength.is_channels() || named {
        if !named {
            r.wrong(
                "star.wavelengths_nm",
                "`star.wavelengths_nm`: expected falling wavelengths, as red, green and blue, for an air of physical inputs",
            );
        }
        air.medium = by_wavelength.medium_at(star.wavelengths_nm.map(|nm| nm * NM));
        air.medium.layers.iter_mut().for_each(|l| l.phase = l.phase.normalised());
    }
    Some(air)
}

fn read(r: Reader<'_>, elsewhere: Option<&Node>, folder: &Path, faults: &Faults) -> Option<Planet> {
    let radius_m = r.number("radius_km", POSITIVE) * KM;
    let star = r.table("star").map(|t| {
        let wavelengths_nm: [f64; 3] = t.numbers("wavelengths_nm", 1.0..=1e6);
        let [a, b, c] = wavelengths_nm;
        if a == b || b == c || c == a {
            t.wrong("wavelengths_nm", "`star.wavelengths_nm`: expected three different wavelengths");
        }
        let star = Star {
            wavelengths_nm,
            irradiance_w_m2_nm: t.numbers("irradiance_w_m2_nm", 0.0..=1e9),
            angular_radius_rad: t.number("angular_radius_deg", f64::MIN_POSITIVE..=89.0) * DEG,
        };
        t.finish();
        star
    });
    // Nothing is dragged here: gravity only serves the plausibility of `[physics]`, and stands for Earth's.
    let gm_m3_s2 = 9.8 * radius_m * radius_m;
    let datum = Datum::new(gm_m3_s2, radius_m);
    let star_light = Starlight::default();
    let overlay = Overlay::new(folder, &[]);
    let setting = Setting { overlay: &overlay, folder: "", star: &star_light };
    let (spec, named) = match elsewhere {
        Some(node) => {
            r.text("atmosphere");
            (read_air(&Reader::new(node, faults), datum, &setting), node.get("wavelengths_nm").is_some())
        }
        None => r.table("atmosphere").map(|t| (read_air(&t, datum, &setting), t.has("wavelengths_nm"))).unwrap_or_default(),
    };
    let occluders = occluders(&r, radius_m);
    let star = star?;
    let air = at_star(spec, &star, named, &r);
    r.finish();
    Some(Planet { star, air: air?, occluders })
}

/// The spheres of `[[occluders]]`, each by its centre or by direction and distance, outside of the planet.
fn occluders(r: &Reader<'_>, planet_m: f64) -> Vec<Sphere> {
    let one = |t: Reader<'_>| {
        let radius_m = t.number("radius_m", POSITIVE);
        let by = if t.has("direction") { "direction" } else { "centre_m" };
        let v = DVec3::from(t.numbers(by, ANY));
        let centre_m = if by == "direction" { v.normalize_or_zero() * t.number("distance_m", POSITIVE) } else { v };
        // A placeholder after a fault is NaN, and says no more.
        if v == DVec3::ZERO || centre_m.length() <= planet_m + radius_m {
            let from = centre_m.length();
            t.wrong(
                by,
                format!(
                    "`occluders.{by}`: expected a sphere outside of the planet, at more than {} m from its centre, not {from}",
                    planet_m + radius_m
                ),
            );
        }
        t.finish();
        Sphere { centre_m, radius_m }
    };
    let all: Vec<Sphere> = r.tables("occluders").into_iter().map(one).collect();
    if all.len() > MAX_OCCLUDERS {
        r.wrong("occluders", format!("`occluders`: expected at most {MAX_OCCLUDERS}, not {}", all.len()));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::air::Model;

    const EARTH: &str = include_str!("../../../tests/reference/planets/earth.toml");

    fn planet(text: &str, model: Option<&str>) -> Result<Planet, AssetErrors> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("p.toml");
        std::fs::write(&path, text).unwrap();
        read_planet(&path, model)
    }

    #[test]
    fn a_planet_is_read() {
        let earth = planet(EARTH, None).unwrap();
        assert_eq!(earth.air.medium.bottom_radius_m, 6.36e6);
        assert_eq!(earth.air.medium.layers.len(), 3);
        assert_eq!(earth.star.wavelengths_nm, [680.0, 550.0, 440.0]);
        assert!((earth.star.angular_radius_rad / DEG - 0.2678).abs() < 1e-12);
    }

    #[test]
    fn the_air_may_lie_in_a_file_of_its_own_and_be_drawn_otherwise() {
        let dir = tempfile::tempdir().unwrap();
        let (head, air) = EARTH.split_once("[atmosphere]").unwrap();
        let air = format!("model = \"none\"\n{}", air.replace("[[atmosphere.layers]]", "[[layers]]"));
        std::fs::write(dir.path().join("air.toml"), air).unwrap();
        let path = dir.path().join("p.toml");
        let (first, rest) = head.split_once("[star]").unwrap();
        std::fs::write(&path, format!("{first}atmosphere = \"air.toml\"\n[star]{rest}")).unwrap();
        assert!(read_planet(&path, None).unwrap_err().text().contains("other than"));
        let planet = read_planet(&path, Some("physical")).unwrap();
        assert!(matches!(planet.air.model, Model::Physical(_)));
        assert_eq!(planet.air.medium, super::tests::planet(EARTH, None).unwrap().air.medium);
    }

    #[test]
    fn the_air_is_taken_at_the_stars_wavelengths() {
        let scattering = |text: &str| planet(text, None).unwrap().air.medium.layers[0].scattering_per_m;
        // Three numbers are the star's channels, in whatever order it has them.
        let turned = EARTH.replace("[680.0, 550.0, 440.0]", "[440.0, 550.0, 680.0]");
        assert_eq!(scattering(&turned), scattering(EARTH));
        // An air given at other wavelengths is carried to the star's: by a power law, λ⁻⁴.
        let named = EARTH
            .replace("top_altitude_m", "wavelengths_nm = [680.0, 550.0, 440.0]\ntop_altitude_m")
            .replace("[680.0, 550.0, 440.0]\nirr", "[600.0, 550.0, 500.0]\nirr");
        let red = f64::from(scattering(&named).x);
        assert!((red / (1.24062e-6 / 0.6_f64.powi(4)) - 1.0).abs() < 1e-4, "{red}");
        // Physical inputs are reckoned at the star's wavelengths, and need them to fall.
        let (head, rest) = EARTH.split_once("scattering_per_m").unwrap();
        let after = rest.split_once("# Aerosol.").unwrap().1;
        let gas = "gas = { molecules = { air = 1.0 }, pressure_pa = 101325.0, temperature_k = 288.15, scale_height_m = 8000.0 }";
        let gas = format!("{head}{gas}\n{after}");
        for channel in 0..3 {
            // The published planet's molecules scatter a sixth more than air does at 15 °C (Bucholtz 1995).
            let ratio = scattering(&gas)[channel] / scattering(EARTH)[channel];
            assert!((ratio - 0.86).abs() < 0.03, "{ratio}");
        }
        let turned = gas.replace("[680.0, 550.0, 440.0]", "[440.0, 550.0, 680.0]");
        assert!(planet(&turned, None).unwrap_err().text().contains("falling"));
    }

    #[test]
    fn occluders_are_read_by_centre_or_by_direction() {
        assert!(planet(EARTH, None).unwrap().occluders.is_empty());
        let moons = "[[occluders]]\ncentre_m = [0.0, 3e8, 4e8]\nradius_m = 1.7e6\n[[occluders]]\ndirection = [0.0, 0.6, 0.8]\ndistance_m = 5e8\nradius_m = 1.7e6";
        let both = planet(&format!("{EARTH}\n{moons}"), None).unwrap().occluders;
        assert_eq!(both.len(), 2);
        assert!(both[0].centre_m.distance(both[1].centre_m) < 1e-3 && both[0].radius_m == 1.7e6, "{both:?}");
        let says = |moon: &str| planet(&format!("{EARTH}\n[[occluders]]\n{moon}"), None).unwrap_err().text();
        let text = says("centre_m = [0.0, 0.0, 6.4e6]\nradius_m = 1.7e6");
        assert!(text.contains(&format!("p.toml:{}", EARTH.lines().count() + 3)) && text.contains("outside of the planet"), "{text}");
        let text = says("direction = [0.0, 0.0, 1.0]\nradius_m = 1.7e6");
        assert!(text.contains("`distance_m`"), "{text}");
        let text = says("centre_m = [0.0, 0.0, 4e8]\nradius = 1.7e6");
        assert!(text.contains("`radius_m`") && text.contains("radius"), "{text}");
    }

    #[test]
    fn faults_are_told_with_their_lines() {
        let wrong = |from: &str, to: &str| {
            assert!(EARTH.contains(from));
            planet(&EARTH.replacen(from, to, 1), None).unwrap_err().text()
        };
        let text = wrong("radius_km = 6360.0", "radius = 6360.0");
        assert!(text.contains("missing key `radius_km`") && text.contains("p.toml"), "{text}");
        let text = wrong("680.0, 550.0", "680.0, 680.0");
        assert!(text.contains("three different wavelengths"), "{text}");
        let text = wrong("g = 0.8", "g = 1.8");
        assert!(text.contains("1.8"), "{text}");
    }
}
