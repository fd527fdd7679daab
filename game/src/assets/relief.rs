//! The `[relief]` table, and the map files that it names: found beside the body's file or in `maps/`, read once, checked.

use super::fault::Fault;
use super::overlay::{DATA_MAX, Overlay, read_bytes};
use super::reader::{ANY, Reader};
use engine::terrain::spec::{CraterSpec, NoiseSpec, ProvinceSpec};
use engine::terrain::{ColourMap, CubeMap, Ground, Maps, ReliefSpec};
use std::path::Path;
use std::sync::Arc;

/// Texels that a colour map may have.
const TEXELS_MAX: usize = 1 << 26;

/// Reads the table; the second value is `relief_max`.
pub fn read_relief(r: Reader<'_>) -> (ReliefSpec, f64) {
    let relief_max = r.number("relief_max", 1.0..=1000.0);
    let ground = match r.choice("ground", &["rock", "regolith", "living", "ice"]) {
        "regolith" => Ground::Regolith,
        "living" => Ground::Living,
        "ice" => Ground::Ice,
        _ => Ground::Rock,
    };
    let noise = r.maybe_table("noise").map(|t| {
        let spec = NoiseSpec {
            wavelength_m: t.number("wavelength_m", ANY),
            amplitude_m: t.number("amplitude_m", ANY),
            plain_amplitude_m: t.number("plain_amplitude_m", ANY),
            gain: t.number("gain", ANY),
            ridged: t.number("ridged", ANY),
            seed: t.whole("seed"),
        };
        t.finish();
        spec
    });
    let craters = r.maybe_table("craters").map(|t| {
        let spec = CraterSpec {
            largest_radius_m: t.number("largest_radius_m", ANY),
            smallest_radius_m: t.number("smallest_radius_m", ANY),
            density: t.number("density", ANY),
            depth_ratio: t.number("depth_ratio", ANY),
            complex_radius_m: t.number("complex_radius_m", ANY),
            seed: t.whole("seed"),
        };
        t.finish();
        spec
    });
    let provinces = r.maybe_table("provinces").map(|t| {
        let spec = ProvinceSpec {
            wavelength_m: t.number("wavelength_m", ANY),
            depth_m: t.number("depth_m", ANY),
            share: t.number("share", ANY),
            albedo_ratio: t.number("albedo_ratio", ANY),
            seed: t.whole("seed"),
        };
        t.finish();
        spec
    });
    let spec = ReliefSpec {
        ground,
        water: r.flag("water"),
        map: r.maybe_text("map"),
        coast: r.maybe_text("coast"),
        colour: r.maybe_text("colour"),
        night: r.maybe_text("night"),
        noise,
        craters,
        provinces,
    };
    if let Err(e) = spec.check() {
        // One line for each key: `relief.noise.gain = 3: expected 0 … 0.7`. What only repeats a placeholder is left out.
        for line in e.to_string().lines().filter(|l| !l.contains("NaN")) {
            let way = line.split([' ', ':']).next().unwrap_or("").trim_start_matches("relief.");
            r.wrong(way, line);
        }
    }
    r.finish();
    (spec, relief_max)
}

/// Reads the files that a spec names. `folder` is the body's, relative to the assets. Each file's bytes go to `hash`, in order.
pub fn load_maps(spec: &ReliefSpec, overlay: &Overlay, folder: &str, hash: &mut blake3::Hasher, fault: &mut dyn FnMut(Fault)) -> Maps {
    let mut bytes_of = |key: &'static str, name: &Option<String>| -> Option<(std::path::PathBuf, Vec<u8>)> {
        let name = name.as_ref()?;
        let path = [format!("{folder}/{name}"), format!("maps/{name}")].iter().filter_map(|p| inside(p)).find_map(|p| overlay.find(p));
        let Some(path) = path else {
            let wanted = overlay.expected(&format!("{folder}/{name}"));
            let message = format!("the file named by `relief.{key}` = \"{name}\" is missing: expected it here or in the folder `maps`");
            fault(Fault::file(&wanted, message));
            return None;
        };
        match read_bytes(&path, DATA_MAX) {
            Ok(bytes) => Some((path, bytes)),
            Err(e) => {
                fault(e);
                None
            }
        }
    };
    let height = bytes_of("map", &spec.map);
    let coast = bytes_of("coast", &spec.coast);
    let colour = bytes_of("colour", &spec.colour);
    let night = bytes_of("night", &spec.night);
    let mut cube = |file: Option<(std::path::PathBuf, Vec<u8>)>| -> Option<Arc<CubeMap>> {
        let (path, bytes) = file?;
        hash.update(&bytes);
        CubeMap::read(&bytes).map(Arc::new).map_err(|e| fault(Fault::file(&path, format!("{e}; expected a .cube file")))).ok()
    };
    let height = cube(height);
    let coast = cube(coast);
    // Colour is seen, never collided with: it stays out of the hash.
    let mut seen = |file: Option<(std::path::PathBuf, Vec<u8>)>| {
        let (path, bytes) = file?;
        picture(&path, &bytes).map(Arc::new).map_err(|what| fault(Fault::file(&path, what))).ok()
    };
    let (colour, night) = (seen(colour), seen(night));
    Maps { height, coast, colour, night }
}

/// A relative path with its `..` taken out; `None` where it leads out of the assets.
fn inside(path: &str) -> Option<String> {
    let mut parts = Vec::new();
    for part in path.split(['/', '\\']) {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()?),
            part => parts.push(part),
        }
    }
    Some(parts.join("/")).filter(|p| !p.contains(':'))
}

/// Decodes a JPEG or 8-bit RGB(A) PNG.
fn picture(path: &Path, bytes: &[u8]) -> Result<ColourMap, String> {
    let expected = "expected an RGB picture, JPEG or PNG, twice as wide as high";
    let name = path.to_string_lossy().to_ascii_lowercase();
    let (width, height, rgb) = if name.ends_with(".jpg") || name.ends_with(".jpeg") {
        let mut decoder = jpeg_decoder::Decoder::new(bytes);
        let pixels = decoder.decode().map_err(|e| format!("not a JPEG that can be read: {e}; {expected}"))?;
        let info = decoder.info().ok_or_else(|| expected.to_owned())?;
        if info.pixel_format != jpeg_decoder::PixelFormat::RGB24 {
            return Err(format!("the picture is {:?}: {expected}", info.pixel_format));
        }
        (u32::from(info.width), u32::from(info.height), pixels)
    } else {
        let bad = |e: png::DecodingError| format!("not a PNG that can be read: {e}; {expected}");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().map_err(bad)?;
        let size =
            reader.output_buffer_size().filter(|n| *n <= 4 * TEXELS_MAX).ok_or_else(|| format!("the picture is too large: {expected}"))?;
        let mut pixels = vec![0; size];
        let info = reader.next_frame(&mut pixels).map_err(bad)?;
        let step = match (info.color_type, info.bit_depth) {
            (png::ColorType::Rgb, png::BitDepth::Eight) => 3,
            (png::ColorType::Rgba, png::BitDepth::Eight) => 4,
            other => return Err(format!("the picture is {other:?}: {expected}, 8 bits a channel")),
        };
        (info.width, info.height, pixels.chunks_exact(step).flat_map(|p| [p[0], p[1], p[2]]).collect())
    };
    if width != 2 * height || rgb.len() != 3 * width as usize * height as usize {
        return Err(format!("the picture is {width} × {height}: {expected}"));
    }
    Ok(ColourMap { width, height, rgb })
}
