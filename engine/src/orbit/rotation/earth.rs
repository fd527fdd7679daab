//! The Earth's axes: precession, nutation and the turning measured by UT1.
//!
//! ```text
//! ICRF ← bias and precession (IAU 2006, four Fukushima–Williams angles) ← nutation (largest terms of IAU 2000B) ← sidereal time
//! ```
//! Against the full IAU 2006/2000A model: 0.0025″ rms, 0.0065″ at worst over 1900–2100. Left out: polar motion (0.3″, unpredictable).
//! Beyond ±[`REACH`] centuries from J2000, where the precession polynomials end, the pole is held and only the day goes on.
//! - [Capitaine et al. 2003] "Expressions for IAU 2000 precession quantities", A&A 412, 567, as adopted by IAU 2006 [Wallace &
//!   Capitaine 2006], A&A 459, 981: the angles and GMST.
//! - [McCarthy & Luzum 2003] "An abridged model of the precession-nutation of the celestial pole", CeMDA 85, 37: IAU 2000B.
//! - [IERS 2010] Conventions, TN 36, eq. 5.15 (Earth rotation angle), table 5.2e (equation of the equinoxes).

use super::{about_x, about_z};
use crate::units::ARCSEC;
use core::f64::consts::TAU;
use glam::DQuat;

/// Centuries from J2000 within which the precession polynomials mean something.
pub const REACH: f64 = 40.0;

/// Rate of the Earth rotation angle, rad per second of UT1 (and of TDB, to 3e-8) [IERS 2010].
pub const RATE_RAD_S: f64 = TAU * 1.002_737_811_911_354_5 / 86_400.0;

/// A polynomial in Julian centuries of TT from J2000, in arcseconds, to radians.
fn arcsec(t: f64, powers: [f64; 6]) -> f64 {
    powers.iter().rev().fold(0.0, |sum, p| sum * t + p) * ARCSEC
}

/// The arguments of Delaunay `(l, l′, F, D, Ω)`: arcseconds at J2000 and per century, linear as in [McCarthy & Luzum 2003].
const DELAUNAY: [[f64; 2]; 5] = [
    [485_868.249_036, 1_717_915_923.217_8],
    [1_287_104.793_05, 129_596_581.048_1],
    [335_779.526_232, 1_739_527_262.847_8],
    [1_072_260.703_69, 1_602_961_601.209],
    [450_160.398_036, -6_962_890.543_1],
];

/// One term of nutation: multiples of the arguments; `(sin, t sin, cos)` of Δψ and `(cos, t cos, sin)` of Δε, in 0.1 µas.
type Wave = ([i8; 5], [f64; 3], [f64; 3]);

/// The terms of IAU 2000B above 0.0015″ in Δψ.
const WAVES: [Wave; 24] = [
    ([0, 0, 0, 0, 1], [-172_064_161.0, -174_666.0, 33_386.0], [92_052_331.0, 9086.0, 15_377.0]),
    ([0, 0, 2, -2, 2], [-13_170_906.0, -1675.0, -13_696.0], [5_730_336.0, -3015.0, -4587.0]),
    ([0, 0, 2, 0, 2], [-2_276_413.0, -234.0, 2796.0], [978_459.0, -485.0, 1374.0]),
    ([0, 0, 0, 0, 2], [2_074_554.0, 207.0, -698.0], [-897_492.0, 470.0, -291.0]),
    ([0, 1, 0, 0, 0], [1_475_877.0, -3633.0, 11_817.0], [73_871.0, -184.0, -1924.0]),
    ([0, 1, 2, -2, 2], [-516_821.0, 1226.0, -524.0], [224_386.0, -677.0, -174.0]),
    ([1, 0, 0, 0, 0], [711_159.0, 73.0, -872.0], [-6750.0, 0.0, 358.0]),
    ([0, 0, 2, 0, 1], [-387_298.0, -367.0, 380.0], [200_728.0, 18.0, 318.0]),
    ([1, 0, 2, 0, 2], [-301_461.0, -36.0, 816.0], [129_025.0, -63.0, 367.0]),
    ([0, -1, 2, -2, 2], [215_829.0, -494.0, 111.0], [-95_929.0, 299.0, 132.0]),
    ([0, 0, 2, -2, 1], [128_227.0, 137.0, 181.0], [-68_982.0, -9.0, 39.0]),
    ([-1, 0, 2, 0, 2], [123_457.0, 11.0, 19.0], [-53_311.0, 32.0, -4.0]),
    ([-1, 0, 0, 2, 0], [156_994.0, 10.0, -168.0], [-1235.0, 0.0, 82.0]),
    ([1, 0, 0, 0, 1], [63_110.0, 63.0, 27.0], [-33_228.0, 0.0, -9.0]),
    ([-1, 0, 0, 0, 1], [-57_976.0, -63.0, -189.0], [31_429.0, 0.0, -75.0]),
    ([-1, 0, 2, 2, 2], [-59_641.0, -11.0, 149.0], [25_543.0, -11.0, 66.0]),
    ([1, 0, 2, 0, 1], [-51_613.0, -42.0, 129.0], [26_366.0, 0.0, 78.0]),
    ([-2, 0, 2, 0, 1], [45_893.0, 50.0, 31.0], [-24_236.0, -10.0, 20.0]),
    ([0, 0, 0, 2, 0], [63_384.0, 11.0, -150.0], [-1220.0, 0.0, 29.0]),
    ([0, 0, 2, 2, 2], [-38_571.0, -1.0, 158.0], [16_452.0, -11.0, 68.0]),
    ([-2, 0, 0, 2, 0], [-47_722.0, 0.0, -18.0], [477.0, 0.0, -25.0]),
    ([2, 0, 2, 0, 2], [-31_046.0, -1.0, 131.0], [13_238.0, -11.0, 59.0]),
    ([1, 0, 2, -2, 2], [28_593.0, 0.0, -1.0], [-12_338.0, 10.0, -3.0]),
    ([2, 0, 0, 0, 0], [29_243.0, 0.0, -74.0], [-609.0, 0.0, 13.0]),
];

/// Cosine and sine of a sum of two angles.
fn turn(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0 * b.0 - a.1 * b.1, a.1 * b.0 + a.0 * b.1)
}

/// Nutation in longitude and in obliquity, and sin Ω, sin 2Ω (for the equation of the equinoxes); radians. `t`: centuries of TT.
fn nutation(t: f64) -> ([f64; 2], [f64; 2]) {
    // Five sines and cosines; the multiples (−2 … 2) and their sums by the addition theorem.
    let unit: [[(f64, f64); 5]; 5] = DELAUNAY.map(|[at, rate]| {
        let (s, c) = libm::sincos(libm::remainder((at + rate * t) * ARCSEC, TAU));
        let double = turn((c, s), (c, s));
        [(double.0, -double.1), (c, -s), (1.0, 0.0), (c, s), double]
    });
    let mut sum = [0.0; 2];
    for (multiples, psi, eps) in &WAVES {
        let mut angle = (1.0, 0.0);
        for (argument, multiple) in unit.iter().zip(multiples) {
            if *multiple != 0 {
                angle = turn(angle, argument[usize::from((multiple + 2).unsigned_abs())]);
            }
        }
        let (c, s) = angle;
        sum[0] += (psi[0] + psi[1] * t) * s + psi[2] * c;
        sum[1] += (eps[0] + eps[1] * t) * c + eps[2] * s;
    }
    let scale = 1e-7 * ARCSEC;
    (sum.map(|x| x * scale), [unit[4][3].1, unit[4][4].1])
}

/// The Earth's axes: body-fixed vectors into ICRF. `t`: Julian centuries of TT since J2000; `ut1`: whole days of UT1 since J2000 and
/// the fraction of a day.
pub fn icrf_from_fixed(t: f64, ut1: (f64, f64)) -> DQuat {
    let t = t.clamp(-REACH, REACH);
    let gamma = arcsec(t, [-0.052_928, 10.556_378, 0.493_204_4, -0.000_312_38, -0.000_002_788, 0.000_000_026]);
    let phi = arcsec(t, [84_381.412_819, -46.811_016, 0.051_126_8, 0.000_532_89, -0.000_000_44, -0.000_000_017_6]);
    let psi = arcsec(t, [-0.041_775, 5_038.481_484, 1.558_417_5, -0.000_185_22, -0.000_026_452, -0.000_000_014_8]);
    let epsilon = arcsec(t, [84_381.406, -46.836_769, -0.000_183_1, 0.002_003_4, -0.000_000_576, -0.000_000_043_4]);
    let ([delta_psi, delta_epsilon], [sin_node, sin_two_nodes]) = nutation(t);
    let (days, fraction) = ut1;
    // The angle turns once a day and 0.0027 times more: whole turns never enter the sum.
    let era = TAU * libm::fmod(0.779_057_273_264 + fraction + 0.002_737_811_911_354_5 * (days + fraction), 1.0);
    let mean = arcsec(t, [0.014_506, 4_612.156_534, 1.391_581_7, -0.000_000_44, -0.000_029_956, -0.000_000_036_8]);
    let equinoxes = delta_psi * libm::cos(epsilon) + (0.002_640_96 * sin_node + 0.000_063_52 * sin_two_nodes) * ARCSEC;
    about_z(gamma) * about_x(phi) * about_z(-(psi + delta_psi)) * about_x(-(epsilon + delta_epsilon)) * about_z(era + mean + equinoxes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    /// Celestial-to-terrestrial matrices (rows) of the full model without polar motion: ERFA 2.0.1, `pnm06a` and `gst06a`.
    /// `(days of TT, days of UT1 before them in s, matrix)`.
    const FULL: [(f64, f64, [[f64; 3]; 3]); 4] = [
        (
            -36_524.5,
            -2.0,
            [
                [-1.988_968_864_313_208_6e-1, 9.800_187_517_363_968_5e-1, -1.809_644_429_431_203_9e-3],
                [-9.799_725_775_713_290_5e-1, -1.989_050_831_673_865_9e-1, -9.513_942_315_388_735_2e-3],
                [-9.683_789_347_758_761_0e-3, -1.188_915_882_207_042_3e-4, 9.999_531_039_447_091_5e-1],
            ],
        ),
        (
            0.3,
            64.0,
            [
                [8.789_094_873_237_389_7e-1, 4.769_885_865_771_248_4e-1, 3.697_943_923_034_689_0e-5],
                [-4.769_885_872_543_382_9e-1, 8.789_094_876_545_570_1e-1, 1.182_854_447_105_384_9e-5],
                [-2.685_949_927_918_436_7e-5, -2.803_499_043_285_695_4e-5, 9.999_999_992_463_033_4e-1],
            ],
        ),
        (
            9720.241_041_667,
            69.2,
            [
                [-6.777_017_142_257_452_1e-1, -7.353_347_459_316_741_4e-1, 1.788_284_397_604_711_3e-3],
                [7.353_323_068_452_304_3e-1, -6.777_040_729_166_975_4e-1, -1.894_217_989_395_079_4e-3],
                [2.604_811_923_761_133_0e-3, 3.126_851_285_578_657_9e-5, 9.999_966_069_828_046_8e-1],
            ],
        ),
        (
            36_525.0,
            200.0,
            [
                [1.583_885_314_725_441_4e-1, -9.873_755_583_784_982_2e-1, -1.606_180_164_325_937_4e-3],
                [9.873_290_135_525_311_3e-1, 1.583_966_609_075_762_6e-1, -9.587_325_524_687_337_7e-3],
                [9.720_704_468_139_797_9e-3, -6.730_586_662_695_436_9e-5, 9.999_527_505_710_275_0e-1],
            ],
        ),
    ];

    #[test]
    fn the_axes_are_those_of_the_full_model() {
        let mut worst = 0.0_f64;
        for (days, delta_t, rows) in FULL {
            let ut1 = days - delta_t / 86_400.0;
            let q = icrf_from_fixed(days / 36_525.0, (ut1.floor(), ut1 - ut1.floor()));
            for (axis, row) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(rows) {
                worst = worst.max((q * axis - DVec3::from_array(row)).length() / ARCSEC);
            }
        }
        // Two-sided: a model that got better would be a different one.
        assert!((0.001..0.007).contains(&worst), "{worst}″");
    }

    #[test]
    fn sidereal_time_of_the_textbook() {
        // [Meeus 1998, example 12.a]: 1987 April 10, 0 h UT1: mean sidereal time 13 h 10 m 46.3668 s (IAU 1982, 2 ms from IAU 2006);
        // apparent: 46.1351 s.
        let days = 2_446_895.5 - 2_451_545.0_f64;
        let q = icrf_from_fixed((days + 55.6 / 86_400.0) / 36_525.0, (days.floor(), 0.5));
        // The prime meridian's hour angle is counted from the true equinox of date: undo precession and nutation by their own definition.
        let t = days / 36_525.0;
        let ([dpsi, deps], _) = nutation(t);
        assert!((dpsi / ARCSEC + 3.788).abs() < 0.02 && (deps / ARCSEC - 9.443).abs() < 0.02, "Meeus, example 22.a");
        let apparent = (13.0 + 10.0 / 60.0 + 46.1351 / 3600.0) / 24.0 * TAU;
        let true_axes = q * about_z(-apparent);
        // What is left must be near the identity but for precession: its x axis lies on the equator of date and on the ecliptic.
        let equinox = true_axes * DVec3::X;
        let pole = true_axes * DVec3::Z;
        let ecliptic = {
            let e = 84_381.406 * ARCSEC;
            DVec3::new(0.0, -libm::sin(e), libm::cos(e))
        };
        let node = pole.cross(ecliptic) * (1.0 / libm::sin(84_381.406 * ARCSEC));
        assert!((equinox - node * (1.0 / node.length())).length() < 10.0 * ARCSEC, "{equinox} {node}");
    }

    #[test]
    fn ages_away_the_axes_are_still_axes() {
        for t in [-1e12, -1000.0, 40.0, 41.0, 1e12] {
            let q = icrf_from_fixed(t, (t * 36_525.0, 0.25));
            assert!((q.length() - 1.0).abs() < 1e-12, "{t}: {q}");
        }
    }
}
