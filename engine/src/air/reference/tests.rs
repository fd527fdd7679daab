//! The reference against closed forms and published rays. The whole of the published sample is in `tests/tests/sky_truth.rs`.

use super::*;
use crate::air::medium::tests::earth;
use crate::units::{DEG, KM};

/// Solar irradiance at 680, 550 and 440 nm, W m⁻² nm⁻¹.
const IRRADIANCE: DVec3 = DVec3::new(1.474, 1.8504, 1.91198);

fn ray(from_m: DVec3, direction: DVec3, sun: DVec3) -> Ray {
    Ray { from_m, direction, sun, sun_rad: 0.2678 * DEG, occluders: Vec::new() }
}

/// Height of the camera (km), view, sun, then T and L1 at three wavelengths.
type Row = (f64, [f64; 3], [f64; 3], [f64; 3], [f64; 3]);

/// Rows of `sky_radiance_sample.csv`.
const ROWS: [Row; 3] = [
    (
        0.1,
        [0.866_025_403_784_438_6, 0.0, 0.5],
        [0.5, 0.0, 0.866_025_403_784_438_7],
        [0.886_601_14, 0.756_619_03, 0.586_775_85],
        [0.015_479_477, 0.036_416_87, 0.070_990_082],
    ),
    (
        0.1,
        [0.866_025_403_784_438_6, 0.0, 0.5],
        [0.997_564_050_259_824_2, 0.0, -0.069_756_473_744_125_33],
        [0.886_601_14, 0.756_619_03, 0.586_775_85],
        [0.000_528_036_91, 0.000_389_629_22, 0.000_681_041_91],
    ),
    (
        400.0,
        [0.941_124_260_355_029_6, 0.0, -0.338_060_832_648_797_77],
        [-0.941_124_260_355_029_6, 0.0, 0.338_060_832_648_797_77],
        [0.050_954_8, 0.001_067_551_4, 3.747_163_7e-7],
        [0.068_065_208, 0.062_202_033, 0.111_635_37],
    ),
];

#[test]
fn agrees_with_the_published_rays() {
    for (i, (height_km, view, sun, t, l1)) in ROWS.into_iter().enumerate() {
        let ray = ray(DVec3::Z * (6360.0 + height_km) * KM, view.into(), sun.into());
        let out = &radiance(&earth(), &[ray], &Options { max_walks: 0, ..Options::default() })[0];
        let single = out.single * IRRADIANCE;
        for channel in 0..3 {
            let (dt, dl) = (out.transmittance[channel] - t[channel], single[channel] / l1[channel] - 1.0);
            assert!(dt.abs() < 2e-5, "row {i}, channel {channel}: T off by {dt}");
            assert!(dl.abs() < 1e-4, "row {i}, channel {channel}: L1 off by {dl}");
        }
    }
}

#[test]
fn the_sky_overhead_has_its_closed_form() {
    // Straight up, optical depth is Σ β H (1 − e^(−top/H)) + ½ tent · width.
    let t = transmittance_to_top(&earth(), 6.36e6, 1.0);
    let blue = 33.1e-6 * 8000.0 * (1.0 - libm::exp(-7.5)) + 4.44e-6 * 1200.0 + 0.085e-6 * 15_000.0;
    assert!((t.z - libm::exp(-blue)).abs() < 1e-7);
}

#[test]
fn rays_that_miss_bring_nothing() {
    let out = radiance(&earth(), &[ray(DVec3::Z * 7.0e6, DVec3::Z, DVec3::Z)], &Options::default())[0];
    assert_eq!((out.total, out.transmittance), (DVec3::ZERO, DVec3::ONE));
    assert!(span(&earth(), DVec3::Z * 7.0e6, DVec3::NEG_Z).unwrap().hits_ground);
}
