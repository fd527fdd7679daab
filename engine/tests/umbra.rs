//! The light in a planet's shadow: the sum over refracted rays against rays traced by their differential equation, the table against the
//! sum, and both against closed forms and what is published of the Moon in eclipse.

use engine::air::optics::{Aerosol, Amount, Gas, Load, Molecule, Refraction};
use engine::air::reference::umbra::{self, Grid, Receiver};
use engine::air::refraction::shade::Shade;
use engine::air::refraction::{Behind, ByWavelength, Limb, bend_of_exponential_rad, refractivity};
use engine::air::spectral::bands::channel_weights;
use engine::air::spectral::{Optics, SpectralLayer, SpectralMedium};
use engine::air::{Air, Layer, Medium, Phase, Profile};
use engine::light::occlusion::visible_behind_disc;
use engine::light::spectrum::{Spectrum, Starlight, wavelength_nm};
use engine::units::{AU, DEG, KM, NM};
use glam::{DVec3, Vec3};
use std::sync::Arc;

const SUN_M: f64 = 695_700.0 * KM;
/// Luminance of the linear sRGB primaries.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// Earth's air in three wavelengths, 680, 550 and 440 nm, with as little haze as over the sea.
fn earth() -> Air {
    let layer = |scattering_per_m, absorption_per_m, profile, phase| Layer { scattering_per_m, absorption_per_m, profile, phase };
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    let ozone = Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 };
    Air::from(Medium {
        bottom_radius_m: 6371.0 * KM,
        top_altitude_m: 100.0 * KM,
        ground_albedo: Vec3::splat(0.1),
        layers: vec![
            layer(Vec3::new(4.84e-6, 1.149e-5, 2.86e-5), Vec3::ZERO, exponential(8000.0), Phase::Rayleigh),
            layer(Vec3::splat(4e-6), Vec3::splat(4e-7), exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
            layer(Vec3::ZERO, Vec3::new(0.6497e-6, 1.881e-6, 0.085e-6), ozone, Phase::Rayleigh),
        ],
    })
}

#[test]
fn bending_is_that_of_an_exponential_gas() {
    let air = earth();
    let limb = Limb::new(&air).unwrap();
    let nu = refractivity(&air.gases, 0.0);
    assert!((2.7e-4..3.4e-4).contains(&nu), "{nu}");
    for g in limb.grazes.iter().filter(|g| (1e4..6e4).contains(&g.altitude_m)).step_by(10) {
        let r = air.medium.bottom_radius_m + g.altitude_m;
        let expected = bend_of_exponential_rad(refractivity(&air.gases, g.altitude_m), r, 8000.0);
        // Next terms: H/r and ν r/H.
        assert!((g.bend_rad / expected - 1.0).abs() < 0.06 + 0.5 * nu * r / 8000.0, "{}: {} {expected}", g.altitude_m, g.bend_rad);
    }
    // The refraction of a setting sun twice, 2 × 34′, for rays that touch the ground.
    let ground = limb.grazes[0];
    assert!(ground.altitude_m == 0.0 && (60.0..85.0).contains(&(ground.bend_rad / DEG * 60.0)), "{}′", ground.bend_rad / DEG * 60.0);
}

#[test]
fn traced_rays_bend_and_fade_as_much() {
    let air = earth();
    let limb = Limb::new(&air).unwrap();
    let distance_m = 3.8e8;
    for g in limb.grazes.iter().step_by(12).filter(|g| g.altitude_m < 6e4 && g.altitude_m > 100.0) {
        let angle = libm::asin(g.impact_m / distance_m);
        let ray = umbra::trace(&air, distance_m, angle, 1600).unwrap();
        let bent = angle - libm::atan2(ray.direction.y, ray.direction.x);
        assert!((bent / g.bend_rad - 1.0).abs() < 2e-3, "{}: {bent} {}", g.altitude_m, g.bend_rad);
        let off = (ray.transmittance / g.transmittance.max(DVec3::splat(1e-12)) - DVec3::ONE).abs();
        assert!(
            off.max_element() < 0.01 || g.transmittance.max_element() < 1e-4,
            "{}: {} {}",
            g.altitude_m,
            ray.transmittance,
            g.transmittance
        );
    }
}

#[test]
fn without_air_that_bends_it_is_the_disc_behind_a_disc() {
    let mut air = earth();
    air.gases.clear();
    air.medium.layers.iter_mut().for_each(|l| {
        l.scattering_per_m = glam::Vec3::ZERO;
        l.absorption_per_m = glam::Vec3::ZERO;
    });
    let limb = Limb::new(&air).unwrap();
    for distance_m in [1e7, 3.8e8, 3e9] {
        let behind = Behind { star_distance_m: AU, star_radius_m: SUN_M, distance_m };
        let (sun, earth) = (behind.sun_rad(), libm::asin(limb.radius_m / distance_m));
        for k in 0..40 {
            let s = (earth + sun) * 1.05 * f64::from(k) / 39.0;
            let expected = visible_behind_disc(sun, earth, s);
            assert!((limb.light(&behind, s) - DVec3::splat(expected)).abs().max_element() < 2e-4, "{distance_m}, {s}: {expected}");
        }
    }
}

#[test]
fn the_shadow_is_as_traced() {
    let air = earth();
    let limb = Limb::new(&air).unwrap();
    let grid = Grid { rings: 1200, sectors: 1600, steps: 160 };
    for distance_m in [1.0e7, 3.844e8, 2.0e9] {
        let behind = Behind { star_distance_m: AU, star_radius_m: SUN_M, distance_m };
        let (sun, earth) = (behind.sun_rad(), libm::asin(limb.radius_m / distance_m));
        let mut worst = 0.0_f64;
        for k in 0..6 {
            let separation_rad = (earth - 1.2 * DEG).max(0.0) * (1.0 - f64::from(k) / 5.0) + (earth + 0.8 * sun) * f64::from(k) / 5.0;
            let receiver = Receiver { distance_m, separation_rad, star_distance_m: AU, star_radius_m: SUN_M };
            let (truth, found) = (umbra::light(&air, &receiver, &grid), limb.light(&behind, separation_rad));
            println!("{distance_m:.3e} m, {:.3}°: {:?}, traced {:?}", separation_rad / DEG, shown(found), shown(truth));
            for c in 0..3 {
                worst = worst.max((found[c] - truth[c]).abs() / (truth[c] + 1e-6));
            }
        }
        println!("{distance_m:.3e} m: worst {worst:.4}");
        assert!(worst < 0.02, "{distance_m}: {worst}");
    }
}

#[test]
fn the_table_keeps_the_sum() {
    let limb = Limb::new(&earth()).unwrap();
    let shade = Shade::new(limb.clone(), SUN_M, AU);
    assert!(shade.fits(SUN_M, AU * 1.0002) && !shade.fits(SUN_M, AU * 1.01));
    for distance_m in [6.9e6, 4.2e7, 3.63e8, 3.844e8, 1.2e9] {
        let behind = Behind { star_distance_m: AU, star_radius_m: SUN_M, distance_m };
        let earth = libm::asin(limb.radius_m / distance_m);
        let start = std::time::Instant::now();
        let made: std::collections::BTreeMap<usize, _> = shade.rows(distance_m, distance_m).map(|r| (r, shade.row(r))).collect();
        println!("{:.1} ms a row", start.elapsed().as_secs_f64() * 1e3 / made.len() as f64);
        let (mut worst, mut at) = (0.0_f64, 0.0);
        for k in 0..200 {
            let gap = (earth.min(1.5 * DEG) + 0.4 * DEG) * f64::from(k) / 199.0 - earth.min(1.5 * DEG);
            let truth = limb.light(&behind, (earth + gap).max(0.0));
            let found = shade.read(&|r| made[&r], distance_m, gap);
            let error = ((found - truth).abs() / (truth + 1e-6)).max_element();
            if error > worst {
                (worst, at) = (error, gap);
            }
        }
        println!("{distance_m:.3e} m: worst {worst:.4} at {:.3}° from the limb", at / DEG);
        // At the ends the worst lies where a ship in low orbit still has 1e-6 of the light, and near the tip of the umbra.
        assert!(worst < if (1e7..1e9).contains(&distance_m) { 0.02 } else { 0.07 }, "{distance_m}: {worst}");
    }
}

#[test]
fn the_umbra_of_the_earth_is_red_with_a_blue_rim() {
    let limb = Limb::new(&earth()).unwrap();
    let behind = Behind { star_distance_m: AU, star_radius_m: SUN_M, distance_m: 3.844e8 };
    let umbra = libm::asin(limb.radius_m / behind.distance_m) - behind.sun_rad();
    let at = |share: f64| limb.light(&behind, share * umbra);
    for share in [0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0, 1.1] {
        let l = at(share);
        let density = -libm::log10(l.dot(LUMINANCE));
        println!("{share}: {:?}, density {density:.2}", shown(l));
    }
    // The edge that one sees, where brightness changes fastest for its size, stands outside of the geometric one: craters enter the umbra as if
    // the Earth were larger by 1/85 [Danjon 1951] … 1/50 [Chauvenet] of the Moon's parallax, 57′.
    let brightness = |x: f64| libm::log(at(x).dot(LUMINANCE));
    let steps: Vec<f64> = (0..400).map(|i| 0.9 + 5e-4 * f64::from(i)).collect();
    let edge = steps.into_iter().max_by(|a, b| {
        let slope = |x: f64| brightness(x + 5e-4) - brightness(x - 5e-4);
        slope(*a).total_cmp(&slope(*b))
    });
    let wider_rad = (edge.unwrap_or(0.0) - 1.0) * umbra;
    println!("the edge stands {:.2}′ outside: 1/{:.0} of the parallax", wider_rad / DEG * 60.0, 57.0 / (wider_rad / DEG * 60.0));
    assert!((0.4..1.4).contains(&(wider_rad / DEG * 60.0)), "{edge:?}");
    assert!(at(0.0).x > 5.0 * at(0.0).y && at(0.0).y > at(0.0).z);
    assert!(at(0.0).y < at(0.5).y && at(0.5).y < at(0.95).y);
}

/// For people.
fn shown(v: DVec3) -> [String; 3] {
    v.to_array().map(|x| format!("{x:.3e}"))
}

/// The air of `assets/bodies/earth`, by wavelength.
fn earth_by_wavelength() -> SpectralMedium {
    let gas = Gas {
        refraction: Refraction::Molecules(vec![(Molecule::Air, 1.0)]),
        amount: Amount::Pressure(101_325.0),
        temperature_k: 288.15,
        molar_mass_kg_mol: None,
        scale_height_m: Some(8000.0),
    };
    let haze = Aerosol { load: Load::OpticalDepth(0.0053), angstrom_exponent: 0.0, single_scattering_albedo: vec![(550e-9, 0.9)] };
    let exponential = |scale_height_m| Profile::Exponential { scale_height_m };
    let ozone = Profile::Tent { bottom_m: 1.0e4, peak_m: 2.5e4, top_m: 4.0e4 };
    let layer = |optics, profile, phase| SpectralLayer { optics, profile, phase };
    SpectralMedium {
        bottom_radius_m: 6371.0 * KM,
        top_altitude_m: 100.0 * KM,
        ground_albedo: [0.1; 3],
        wavelengths_m: SpectralMedium::WAVELENGTHS_M,
        layers: vec![
            layer(Optics::Gas(gas), exponential(8000.0), Phase::Rayleigh),
            layer(Optics::Aerosol(haze), exponential(1200.0), Phase::CornetteShanks { g: 0.8 }),
            layer(Optics::Ozone(300.0), ozone, Phase::Rayleigh),
        ],
    }
}

#[test]
fn gases_bend_as_they_are_described() {
    // Dry air at 15 °C and one atmosphere, 550 nm [Peck & Reeder 1972]: from its molecules, and from what it scatters.
    let mut medium = earth_by_wavelength();
    let of = |medium: &SpectralMedium| medium.refractive().iter().map(|g| g.refractivity).collect::<Vec<_>>();
    let by_molecules = of(&medium);
    medium.layers[0].optics = Optics::Channels([4.84e-6, 1.149e-5, 2.86e-5], [0.0; 3]);
    let by_scattering = of(&medium);
    for found in [by_molecules, by_scattering] {
        assert!(found.len() == 1 && (found[0] / 2.778e-4 - 1.0).abs() < 1e-3, "{found:?}");
    }
}

#[test]
fn its_colour_is_that_of_all_wavelengths() {
    let medium = earth_by_wavelength();
    let sun = Spectrum::sun();
    let air = |medium, bands| Air { bands, gases: earth_by_wavelength().refractive(), ..Air::from(medium) };
    let limb = |air: &Air| Limb::new(air).unwrap();
    let (rgb, bands) = medium.draw(true, &Starlight::default()).unwrap();
    let (three, six) = (limb(&air(rgb.clone(), None)), limb(&air(rgb.clone(), bands)));
    let light = ByWavelength::new(&medium, &sun);
    let start = std::time::Instant::now();
    let drawn = limb(&Air { by_wavelength: Some(Arc::new(light)), ..air(rgb, None) });
    println!("{:.1} ms a limb", start.elapsed().as_secs_f64() * 1e3);
    // Three wavelengths at a time.
    let weights = channel_weights(&sun);
    let all: Vec<(Limb, [DVec3; 3])> = (0..weights.len() / 3)
        .map(|i| {
            let at = [3 * i, 3 * i + 1, 3 * i + 2];
            (limb(&air(medium.medium_at(at.map(|k| wavelength_nm(k) * NM)), None)), at.map(|k| weights[k]))
        })
        .collect();
    let behind = Behind { star_distance_m: AU, star_radius_m: SUN_M, distance_m: 3.844e8 };
    let umbra = libm::asin(6371.0 * KM / behind.distance_m) - behind.sun_rad();
    let mut worst = [0.0_f64; 3];
    for share in [0.0, 0.4, 0.7, 0.9, 0.97, 1.05, 1.2] {
        let truth: DVec3 = all
            .iter()
            .map(|(limb, w)| {
                let l = limb.light(&behind, share * umbra);
                w[0] * l.x + w[1] * l.y + w[2] * l.z
            })
            .sum();
        let found = [&three, &six, &drawn].map(|limb| limb.light(&behind, share * umbra));
        println!("{share}: all {:?}, three {:?}, six {:?}", shown(truth), shown(found[0]), shown(found[1]));
        // Of the luminance; blue that is out of gamut is held at nothing.
        let luminance = truth.dot(LUMINANCE);
        let off = found.map(|found| ((found - truth.max(DVec3::ZERO)) * LUMINANCE).abs().element_sum() / luminance);
        worst.iter_mut().zip(off).for_each(|(worst, off)| *worst = worst.max(off));
        if share == 0.0 {
            // 10.2 magnitudes below the full Moon: between the eclipses that observers call bright and those that they call dark.
            assert!((3.8..4.4).contains(&-libm::log10(luminance)), "{luminance}");
        }
        if share == 0.97 {
            assert!(truth.z > truth.y && truth.y > truth.x && found[2].z > found[2].x, "no blue rim: {truth}");
        }
    }
    println!("worst: three wavelengths {:.3}, six {:.4}, as it is drawn {:.1e}", worst[0], worst[1], worst[2]);
    assert!(worst[0] < 0.2 && worst[1] < 0.01 && worst[2] < 1e-4, "{worst:?}");
}
