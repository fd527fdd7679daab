//! Airs that are drawn in bands: their colours on the GPU against the sum over all wavelengths, along rays and in the tables that
//! surfaces ask; and what bands fitted to single scattering do to all orders, by the reference. How good they are in single scattering is measured
//! by `engine::air::spectral::study` (`bench air --spectral`).

use engine::air::optics::{Amount, Gas, Molecule, Refraction};
use engine::air::reference::{Options, Ray as Sight, radiance};
use engine::air::spectral::bands::{Bands, Fitting, channel_weights};
use engine::air::spectral::rays::{Met, Ray, fitting};
use engine::air::spectral::{Coefficients, Optics, SpectralLayer, SpectralMedium};
use engine::air::{Air, Phase, Profile};
use engine::gpu::{ShaderLibrary, readback};
use engine::light::spectrum::difference::shown;
use engine::light::spectrum::{COUNT, Starlight, wavelength_nm};
use engine::render::pass::air_tables::AirBaker;
use engine::render::pass::sky_probe::{ProbeOptions, ProbeRay, probe};
use engine::space::relative::narrow;
use engine::units::{DEG, NM};
use glam::DVec3;

/// Dry air and ozone.
fn earth() -> SpectralMedium {
    let gas = Gas {
        refraction: Refraction::Molecules(vec![(Molecule::Air, 1.0)]),
        amount: Amount::Pressure(101_325.0),
        temperature_k: 288.15,
        molar_mass_kg_mol: None,
        scale_height_m: Some(8000.0),
    };
    let tent = Profile::Tent { bottom_m: 1e4, peak_m: 2.5e4, top_m: 4e4 };
    SpectralMedium {
        bottom_radius_m: 6.371e6,
        top_altitude_m: 1e5,
        ground_albedo: [0.1; 3],
        wavelengths_m: SpectralMedium::WAVELENGTHS_M,
        layers: vec![
            SpectralLayer { optics: Optics::Gas(gas), profile: Profile::Exponential { scale_height_m: 8000.0 }, phase: Phase::Rayleigh },
            SpectralLayer { optics: Optics::Ozone(300.0), profile: tent, phase: Phase::Rayleigh },
        ],
    }
}

fn drawn(spectral: bool) -> Air {
    let (medium, bands) = earth().draw(spectral, &Starlight::Sun).expect("it is sound");
    Air { bands, ..Air::from(medium) }
}

/// Linear sRGB per unit of the Sun's channel, by all wavelengths.
fn truth(light: impl Fn(&Coefficients) -> f64) -> DVec3 {
    let weights = channel_weights(&Starlight::Sun.spectrum());
    let at = earth().at(&(0..COUNT).map(|i| wavelength_nm(i) * NM).collect::<Vec<_>>());
    at.iter().zip(&weights).map(|(at, weight)| *weight * light(at)).sum()
}

fn rays() -> Vec<(Ray, ProbeRay, Met)> {
    let medium = earth();
    let direction = |zenith_deg: f64, azimuth_deg: f64| {
        let ((s, c), (sa, ca)) = (libm::sincos(zenith_deg * DEG), libm::sincos(azimuth_deg * DEG));
        [s * ca, s * sa, c].map(narrow)
    };
    let one = |ray: Ray| {
        let ([x, y, z], sun) = (direction(ray.view_deg, 0.0), direction(ray.sun_deg, ray.azimuth_deg));
        let asked = ProbeRay {
            up: [0.0, 0.0, 1.0, narrow(ray.altitude_m)],
            ray: [x, y, z, 0.0],
            sun: [sun[0], sun[1], sun[2], narrow(0.2666 * DEG)],
        };
        Met::trace(&medium, ray, 128).map(|met| (ray, asked, met))
    };
    fitting(&medium).into_iter().filter_map(one).collect()
}

/// Mean and worst ΔE2000 of single scattering along rays.
fn errors(air: &Air) -> (f64, f64) {
    let rays = rays();
    let asked: Vec<ProbeRay> = rays.iter().map(|r| r.1).collect();
    let options = ProbeOptions { multiple: false, steps: 96, ..ProbeOptions::default() };
    let found = probe(&tests::gpu(), &ShaderLibrary::checkout(), air, &asked, &options).expect("it can be probed");
    let colour = Starlight::Sun.spectrum().colour();
    let mut all = Vec::new();
    for ((ray, _, met), light) in rays.iter().zip(found) {
        let expected = truth(|at| met.radiance(at));
        if expected.y < 1e-6 {
            continue;
        }
        let [r, g, b, _] = light.radiance.map(f64::from);
        // Outside of sRGB there is nothing that a picture could show.
        let error = shown(expected.max(DVec3::ZERO) * colour, DVec3::new(r, g, b) * colour);
        println!("{ray:?}: {error:.3}");
        all.push(error);
    }
    assert!(all.len() > 40, "{}", all.len());
    (all.iter().sum::<f64>() / all.len() as f64, all.into_iter().fold(0.0, f64::max))
}

#[test]
fn six_bands_have_the_colours_of_all_wavelengths() {
    let (mean, worst) = errors(&drawn(true));
    println!("spectral: mean {mean:.3}, worst {worst:.3}");
    assert!(mean < 0.3 && worst < 1.5, "{mean} {worst}");
    let (rgb, worst) = errors(&drawn(false));
    println!("rgb: mean {rgb:.3}, worst {worst:.3}");
    assert!(rgb < 2.0 && worst < 6.0 && rgb > 5.0 * mean, "three bands {rgb} {worst}, six {mean}");
}

/// Radiance in all orders of every channel of the medium at these wavelengths, along the eight rays.
fn all_orders(air: &SpectralMedium, wavelengths_nm: [f64; 3], rays: &[Sight]) -> Vec<DVec3> {
    let options = Options { rel_error: 2e-3, max_walks: 1 << 17, ..Options::default() };
    let mut medium = air.medium_at(wavelengths_nm.map(|nm| nm * NM));
    medium.layers.iter_mut().for_each(|l| l.phase = l.phase.normalised());
    radiance(&medium, rays, &options).into_iter().map(|e| e.total).collect()
}

#[test]
#[ignore = "minutes of the reference"]
fn bands_fitted_to_single_scattering_serve_all_orders() {
    let star = Starlight::Sun.spectrum();
    let rays: Vec<Sight> = [(0.0, 30.0), (60.0, 30.0), (88.0, 60.0), (0.0, 80.0), (85.0, 80.0), (70.0, 88.0), (85.0, 90.0), (80.0, 93.0)]
        .map(|(view_deg, sun_deg): (f64, f64)| {
            let direction = |deg: f64, azimuth: f64| {
                let (s, c) = libm::sincos(deg * DEG);
                DVec3::new(s * azimuth, s * (1.0 - azimuth * azimuth).sqrt(), c)
            };
            let from_m = DVec3::new(0.0, 0.0, 6.371e6 + 50.0);
            Sight {
                from_m,
                direction: direction(view_deg, 1.0),
                sun: direction(sun_deg, 0.5),
                sun_rad: 0.2666 * DEG,
                occluders: Vec::new(),
            }
        })
        .to_vec();
    let shares = channel_weights(&star);
    for (name, bars, pressure) in [("earth", [2.0, 0.6], 1.0), ("eightfold", [6.0, 4.0], 8.0)] {
        let mut air = earth();
        if let Optics::Gas(gas) = &mut air.layers[0].optics {
            gas.amount = Amount::Pressure(101_325.0 * pressure);
        }
        // Every seventh wavelength has the shares of those around it.
        let mut truth = vec![DVec3::ZERO; rays.len()];
        for triple in (3..COUNT).step_by(7).collect::<Vec<_>>().chunks(3) {
            let at = [0, 1, 2].map(|i| triple.get(i).copied().unwrap_or(triple[0]));
            let found = all_orders(&air, at.map(wavelength_nm), &rays);
            for (c, i) in triple.iter().enumerate() {
                let share: DVec3 = shares[i - 3..COUNT.min(i + 4)].iter().sum();
                truth.iter_mut().zip(&found).for_each(|(sum, light)| *sum += share * light[c]);
            }
        }
        let mean = |bands: &Bands| {
            let by: Vec<Vec<DVec3>> = bands.list.iter().map(|b| all_orders(&air, b.wavelengths_nm, &rays)).collect();
            let colour = star.colour();
            let errors = truth.iter().enumerate().map(|(i, truth)| shown(*truth * colour, bands.mix(|k, _| by[k][i]) * colour));
            errors.sum::<f64>() / rays.len() as f64
        };
        let fitting = Fitting::new(&air, &star);
        let found = [fitting.three(), fitting.six()].map(|b| mean(&b));
        println!("{name}: three bands {:.2}, six {:.2}", found[0], found[1]);
        assert!(found[0] < bars[0] && found[1] < bars[1], "{name}: {found:?}");
    }
}

#[test]
fn surfaces_see_the_sun_through_all_wavelengths() {
    let gpu = tests::gpu();
    let mut baker = AirBaker::new(&gpu, &ShaderLibrary::checkout()).expect("it compiles");
    baker.bake_alone(&gpu, &drawn(true));
    let table = readback::texture_f32(&gpu, &baker.textures()[0].texture, 0).expect("it can be read");
    // The first row is the ground; its first texel looks straight up, its last one along the horizon.
    for (texel, view_deg, allowed) in [(0, 0.0, 2e-3), (127, 90.0, 4e-3)] {
        let ray = Ray { altitude_m: 0.0, view_deg, sun_deg: 0.0, azimuth_deg: 0.0 };
        let met = Met::trace(&earth(), ray, 512).expect("there is air");
        let expected = truth(|at| met.transmittance(at)).max(DVec3::ZERO);
        for c in 0..3 {
            let found = (1.0 - f64::from(table[texel * 4 + c])).powi(4);
            assert!((found - expected[c]).abs() < allowed, "{view_deg}°, channel {c}: {found}, expected {}", expected[c]);
        }
    }
    // By day the sky's light is blue, brighter than nothing, and less than the sun's.
    let sky = readback::texture_f32(&gpu, &baker.textures()[1].texture, 0).expect("it can be read");
    let noon: [f32; 3] = core::array::from_fn(|c| sky[31 * 4 + c].powi(4));
    assert!(noon[2] > noon[0] && noon[0] > 0.01 && noon[2] < 0.6, "{noon:?}");
}
