//! Layers by what they are made of, and the light of other stars.

use super::*;
use engine::air::{Air, Phase, Profile};

/// The look of the rock with these lines for its air, or the faults.
fn look(star: &str, top: &str, layers: &str) -> Result<Air, String> {
    let dir = assets();
    put(dir.path(), "bodies/sun/body.toml", SUN.replace("colour = [1.0, 1.0, 1.0]\n", star).as_bytes());
    let air = format!("{top}top_altitude_m = 100000.0\nground_albedo = [0.1, 0.1, 0.1]\n{layers}");
    put(dir.path(), AIR_FILE, air.as_bytes());
    let system = load_system(dir.path(), &[], "t").map_err(|e| e.text())?;
    Ok(system.body(system.find("rock").unwrap()).look.clone().unwrap())
}

const GAS: &str =
    "[[layers]]\ngas = { molecules = { air = 1.0 }, pressure_pa = 101325.0, temperature_k = 288.15, scale_height_m = 8000.0 }\n";
const SPECTRAL: &str = "spectrum = \"spectral\"\n";

#[test]
fn a_gas_is_read_and_needs_no_profile_and_no_phase() {
    let air = look("", "", GAS).unwrap();
    let layer = &air.medium.layers[0];
    assert_eq!((&layer.profile, &layer.phase), (&Profile::Exponential { scale_height_m: 8000.0 }, &Phase::Rayleigh));
    // Between 1.149e-5 at 550 nm [Bucholtz 1995] and what 560 and 530 nm have.
    assert!((1.06e-5..1.34e-5).contains(&layer.scattering_per_m.y) && air.bands.is_some_and(|b| b.list.len() == 1), "{layer:?}");
    // Left to the temperature and the body's own gravity, 4e14 / 6e6² = 11.1 m/s²: R T / (M g).
    let hydrostatic = look("", "", &GAS.replace(", scale_height_m = 8000.0", "")).unwrap();
    let Profile::Exponential { scale_height_m } = hydrostatic.medium.layers[0].profile else { panic!("no exponential") };
    assert!((scale_height_m - 8.314_463 * 288.15 / (0.028_964_7 * 11.111_1)).abs() < 2.0, "{scale_height_m}");
}

#[test]
fn bands_are_made_where_they_are_asked_for_and_follow_the_star() {
    let sun = look("", SPECTRAL, GAS).unwrap();
    let bands = sun.bands.clone().unwrap();
    // Scattering goes as the wavelength to the power of −4, and a little more.
    let [_, band] = bands.list.as_slice() else { panic!("two of three bands each") };
    let ([red, _, blue], s) = (band.wavelengths_nm, band.medium.layers[0].scattering_per_m);
    assert!((f64::from(s.z / s.x) / libm::pow(red / blue, 4.0) - 1.0).abs() < 0.06, "{s} {:?}", band.wavelengths_nm);
    let dwarf = look("temperature_k = 3000.0\n", SPECTRAL, GAS).unwrap();
    assert_ne!(band.to_rgb, dwarf.bands.unwrap().list[1].to_rgb);
}

#[test]
fn all_kinds_of_layer_are_read_together() {
    let all = "\
        [[layers]]\naerosol = { optical_depth = 0.3, angstrom_exponent = 1.3, single_scattering_albedo = [0.97, 0.93, 0.8] }\n\
        profile = { kind = \"exponential\", scale_height_m = 1000.0 }\nphase = { kind = \"cornette_shanks\", g = 0.7 }\n\
        [[layers]]\naerosol = { particle_density_per_m3 = 1e8, particle_radius_m = 1e-6, single_scattering_albedo = 1.0 }\n\
        profile = { kind = \"constant\", bottom_m = 0.0, top_m = 300.0 }\nphase = { kind = \"isotropic\" }\n\
        [[layers]]\nabsorber = { species = \"ozone\", column_du = 300.0 }\n\
        profile = { kind = \"tent\", bottom_m = 1e4, peak_m = 2.5e4, top_m = 4e4 }\n\
        [[layers]]\ntable = { wavelengths_nm = [400.0, 700.0], scattering_per_m = [2e-6, 1e-6], absorption_per_m = [0.0, 1e-6] }\n\
        profile = { kind = \"exponential\", scale_height_m = 5000.0 }\nphase = { kind = \"isotropic\" }\n";
    let air = look("", "", all).unwrap();
    let [haze, fog, ozone, table] = air.medium.layers.as_slice() else { panic!("four layers") };
    assert!(haze.absorption_per_m.z > haze.absorption_per_m.x && haze.scattering_per_m.z > 2e-4);
    assert!((fog.scattering_per_m.y / (2.0e-4 * std::f32::consts::PI) - 1.0).abs() < 1e-4);
    assert!(ozone.scattering_per_m == glam::Vec3::ZERO && ozone.absorption_per_m.x > 3.0 * ozone.absorption_per_m.z);
    assert!((table.scattering_per_m + table.absorption_per_m - 2e-6).abs().max_element() < 1e-9);
}

#[test]
fn layers_at_fault_are_told_at_their_line() {
    let cases = [
        (GAS.replace("pressure_pa = 101325.0", "pressure_pa = -1.0"), ":4:", "pressure_pa"),
        (GAS.replace("pressure_pa = 101325.0, ", ""), ":4:", "neither is given"),
        (GAS.replace("temperature_k = 288.15, ", ""), ":4:", "temperature_k"),
        (GAS.replace("air = 1.0", "aer = 1.0"), ":4:", "did you mean `air`?"),
        (format!("{GAS}scattering_per_m = [0.0, 0.0, 0.0]\n"), ":4:", "described twice"),
        (
            "[[layers]]\ntable = { wavelengths_nm = [400.0, 700.0], scattering_per_m = [1e-6, 1e-6, 1e-6], absorption_per_m = [0.0, 0.0] }\n"
                .to_owned(),
            ":4:",
            "as many of each",
        ),
    ];
    for (layers, line, words) in cases {
        let told = look("", "", &layers).unwrap_err();
        assert!(told.contains("atmosphere.toml") && told.contains(line) && told.contains(words), "{layers}\n{told}");
    }
    let told = look("", "wavelengths_nm = [440.0, 550.0, 680.0]\n", GAS).unwrap_err();
    assert!(told.contains("wavelengths_nm[0]"), "{told}");
    let told = look("temperature_k = 3.0\n", "", GAS).unwrap_err();
    assert!(told.contains("temperature_k"), "{told}");
}
