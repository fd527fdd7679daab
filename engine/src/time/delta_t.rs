//! ΔT = TT − UT1: how late the turning Earth is.
//!
//! - 1962–2027: observed, half-yearly means without the yearly wave, which is added again; off by 5 ms rms, 18 ms at worst.
//! - before: the polynomials of Espenak & Meeus, faded into each other over a year about each joint.
//! - after: a cubic that leaves the observed values smoothly and meets their long-term parabola, value and slope, in 2150; from
//!   then on the parabola. A guess, as every future ΔT is: their own polynomials have 90 s for 2047 where this has 82 s.
//!
//! The function is continuous: a place on the ground never jumps.
//! - [Espenak & Meeus 2006] "Five Millennium Canon of Solar Eclipses", NASA TP-2006-214141, §2.8 (their correction for another
//!   secular acceleration of the Moon, under 1 s since 1680, is left out).
//! - IERS EOP 14/20 C04 (UT1 − UTC, observed; the last half year predicted by Bulletin A of November 2026).
//! - The yearly wave is the conventional UT2 − UT1 of the BIH.

use crate::units::JULIAN_CENTURY;
use core::f64::consts::TAU;

/// ΔT − (UT2 − UT1), s, mean of 30 days about 1962.0, 1962.5, … 2027.0 (Julian years from J2000.0 TT).
const OBSERVED: [f64; 131] = [
    34.013, 34.224, 34.479, 34.716, 35.037, 35.387, 35.745, 36.132, 36.551, 36.983, //
    37.439, 37.867, 38.301, 38.743, 39.208, 39.690, 40.187, 40.693, 41.177, 41.672, //
    42.236, 42.809, 43.377, 43.941, 44.490, 44.981, 45.483, 45.967, 46.464, 46.983, //
    47.524, 48.018, 48.541, 49.084, 49.593, 50.087, 50.545, 50.961, 51.384, 51.796, //
    52.173, 52.557, 52.963, 53.417, 53.791, 54.068, 54.348, 54.615, 54.877, 55.094, //
    55.328, 55.564, 55.824, 56.077, 56.304, 56.551, 56.861, 57.205, 57.572, 57.942, //
    58.315, 58.725, 59.126, 59.567, 59.990, 60.384, 60.791, 61.230, 61.632, 61.980, //
    62.300, 62.638, 62.972, 63.266, 63.472, 63.646, 63.832, 63.962, 64.097, 64.192, //
    64.305, 64.395, 64.478, 64.532, 64.579, 64.633, 64.694, 64.778, 64.851, 64.973, //
    65.151, 65.324, 65.462, 65.610, 65.783, 65.930, 66.075, 66.222, 66.329, 66.457, //
    66.608, 66.752, 66.913, 67.106, 67.286, 67.468, 67.648, 67.844, 68.109, 68.378, //
    68.599, 68.806, 68.972, 69.095, 69.225, 69.338, 69.366, 69.403, 69.365, 69.331, //
    69.299, 69.234, 69.207, 69.200, 69.181, 69.166, 69.144, 69.121, 69.115, 69.153, //
    69.311,
];
/// Year of the first and of the last observed value, and years between two.
const FIRST: f64 = 1962.0;
const LAST: f64 = 2027.0;
const STEP: f64 = 0.5;
/// Where the long-term parabola is met.
const PARABOLA_FROM: f64 = 2150.0;

/// A polynomial of Espenak & Meeus: it holds from `from`, in powers of `(y − origin)/unit`.
struct Piece {
    from: f64,
    origin: f64,
    unit: f64,
    powers: &'static [f64],
}

const PIECES: [Piece; 11] = [
    Piece { from: f64::NEG_INFINITY, origin: 1820.0, unit: 100.0, powers: &[-20.0, 0.0, 32.0] },
    Piece {
        from: -500.0,
        origin: 0.0,
        unit: 100.0,
        powers: &[10_583.6, -1014.41, 33.783_11, -5.952_053, -0.179_845_2, 0.022_174_192, 0.009_031_652_1],
    },
    Piece {
        from: 500.0,
        origin: 1000.0,
        unit: 100.0,
        powers: &[1574.2, -556.01, 71.234_72, 0.319_781, -0.850_346_3, -0.005_050_998, 0.008_357_207_3],
    },
    Piece { from: 1600.0, origin: 1600.0, unit: 1.0, powers: &[120.0, -0.9808, -0.015_32, 1.0 / 7129.0] },
    Piece { from: 1700.0, origin: 1700.0, unit: 1.0, powers: &[8.83, 0.1603, -0.005_928_5, 0.000_133_36, -1.0 / 1_174_000.0] },
    Piece {
        from: 1800.0,
        origin: 1800.0,
        unit: 1.0,
        powers: &[13.72, -0.332_447, 0.006_861_2, 0.004_111_6, -0.000_374_36, 0.000_012_127_2, -1.699e-7, 8.75e-10],
    },
    Piece { from: 1860.0, origin: 1860.0, unit: 1.0, powers: &[7.62, 0.5737, -0.251_754, 0.016_806_68, -0.000_447_362_4, 1.0 / 233_174.0] },
    Piece { from: 1900.0, origin: 1900.0, unit: 1.0, powers: &[-2.79, 1.494_119, -0.059_893_9, 0.006_196_6, -0.000_197] },
    Piece { from: 1920.0, origin: 1920.0, unit: 1.0, powers: &[21.20, 0.844_93, -0.076_100, 0.002_093_6] },
    Piece { from: 1941.0, origin: 1950.0, unit: 1.0, powers: &[29.07, 0.407, -1.0 / 233.0, 1.0 / 2547.0] },
    Piece { from: 1961.0, origin: 1975.0, unit: 1.0, powers: &[45.45, 1.067, -1.0 / 260.0, -1.0 / 718.0] },
];

impl Piece {
    fn at(&self, year: f64) -> f64 {
        let u = (year - self.origin) / self.unit;
        self.powers.iter().rev().fold(0.0, |sum, p| sum * u + p)
    }
}

/// From 0 to 1 over one unit about zero, with level ends.
fn fade(x: f64) -> f64 {
    let s = (x + 0.5).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}

/// The polynomials, one fading into the next.
fn historic(year: f64) -> f64 {
    // The piece that has begun to fade in last.
    let i = PIECES.iter().rposition(|p| p.from - 0.5 <= year).unwrap_or(0);
    let here = PIECES[i].at(year);
    if i == 0 {
        return here;
    }
    let w = fade(year - PIECES[i].from);
    if w < 1.0 { PIECES[i - 1].at(year) * (1.0 - w) + here * w } else { here }
}

/// Catmull & Rom's cubic through the observed values; at the ends the slope is that of the last interval.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn observed(year: f64) -> f64 {
    let x = ((year - FIRST) / STEP).clamp(0.0, (OBSERVED.len() - 1) as f64);
    let i = (x.floor() as usize).min(OBSERVED.len() - 2);
    let s = x - i as f64;
    let (b, c) = (OBSERVED[i], OBSERVED[i + 1]);
    let a = if i > 0 { OBSERVED[i - 1] } else { 2.0 * b - c };
    let d = OBSERVED.get(i + 2).copied().unwrap_or(2.0 * c - b);
    b + 0.5 * s * (c - a + s * (2.0 * a - 5.0 * b + 4.0 * c - d + s * (3.0 * (b - c) + d - a)))
}

/// The cubic between the last observation and the parabola, then the parabola.
fn future(year: f64) -> f64 {
    let parabola = &PIECES[0];
    if year >= PARABOLA_FROM {
        return parabola.at(year);
    }
    let span = PARABOLA_FROM - LAST;
    let s = (year - LAST) / span;
    let last = OBSERVED.len() - 1;
    // The slope of the last two years: a half-year's weather is no trend.
    let slope_0 = (OBSERVED[last] - OBSERVED[last - 4]) / (4.0 * STEP);
    let slope_1 = 2.0 * parabola.powers[2] * (PARABOLA_FROM - parabola.origin) / (parabola.unit * parabola.unit);
    let (from, to) = (OBSERVED[last], parabola.at(PARABOLA_FROM));
    let h = s * s * (3.0 - 2.0 * s);
    from * (1.0 - h) + to * h + span * s * (1.0 - s) * ((1.0 - s) * slope_0 - s * slope_1)
}

/// UT2 − UT1, s: the yearly wave in the Earth's rotation.
fn season(year: f64) -> f64 {
    let (s, c) = libm::sincos(TAU * year);
    0.022 * s - 0.012 * c - 0.006 * (2.0 * s * c) + 0.007 * (c * c - s * s)
}

/// ΔT = TT − UT1 in seconds, at `tt_s` seconds of TT (or TDB: no difference) since J2000.0.
pub fn delta_t_s(tt_s: f64) -> f64 {
    // Beyond ±1 Myr nobody asks; the parabola stays finite.
    let year = (2000.0 + 100.0 * (tt_s / JULIAN_CENTURY)).clamp(-1e6, 1e6);
    let mean = if year < FIRST - 1.0 {
        historic(year)
    } else if year < FIRST {
        let w = fade(year - (FIRST - 0.5));
        historic(year) * (1.0 - w) + observed(year) * w
    } else if year <= LAST {
        observed(year)
    } else {
        future(year)
    };
    mean + season(year)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::DAY;

    fn at(year: f64) -> f64 {
        delta_t_s((year - 2000.0) * 365.25 * DAY)
    }

    #[test]
    fn published_values() {
        // [Espenak & Meeus 2006, table 2.1, 2.2] for the past; IERS / Astronomical Almanac K8–K9 for 0 h on January 1 since 1962.
        let table = [
            (-500.0, 17_190.0, 30.0),
            (0.0, 10_580.0, 10.0),
            (1000.0, 1570.0, 5.0),
            (1500.0, 200.0, 5.0),
            (1600.0, 120.0, 2.0),
            (1700.0, 9.0, 1.0),
            (1800.0, 13.7, 0.2),
            (1850.0, 7.1, 0.2),
            (1900.0, -2.79, 0.1),
            (1950.0, 29.07, 0.1),
            (1962.0, 33.99, 0.03),
            (1972.0, 42.23, 0.03),
            (1980.0, 50.54, 0.03),
            (1990.0, 56.86, 0.03),
            (2000.0, 63.83, 0.03),
            (2010.0, 66.07, 0.03),
            (2020.0, 69.36, 0.03),
            (2026.0, 69.11, 0.03),
            // The canon's long-term parabola.
            (2200.0, 442.1, 0.1),
        ];
        for (year, published, tolerance) in table {
            assert!((at(year) - published).abs() < tolerance, "{year}: {} for {published}", at(year));
        }
    }

    #[test]
    fn no_step_anywhere() {
        // A tenth of a year never moves ΔT by more than its steepest slope allows: 16 s a year in antiquity, 3 s since 1650.
        let mut year = -700.0;
        while year < 2300.0 {
            let steepest = if year < 1650.0 { 2.0 } else { 0.4 };
            assert!((at(year + 0.1) - at(year)).abs() < steepest, "{year}: {}", at(year + 0.1) - at(year));
            year += 0.1;
        }
        for joint in [-500.0, 1700.0, 1800.0, 1900.0, 1941.0, 1961.0, 1962.0, 2027.0, 2150.0] {
            for edge in [-0.5, 0.0, 0.5] {
                assert!((at(joint + edge + 1e-6) - at(joint + edge - 1e-6)).abs() < 1e-4, "{joint}");
            }
        }
    }

    #[test]
    fn the_future_bends_up_without_a_dip() {
        assert!((60.0..75.0).contains(&at(2030.0)), "{}", at(2030.0));
        assert!((70.0..92.0).contains(&at(2047.0)), "{}", at(2047.0));
        assert!((150.0..220.0).contains(&at(2100.0)), "{}", at(2100.0));
        assert!((2028..2300).all(|y| at(f64::from(y + 1)) > at(f64::from(y))));
        assert!(delta_t_s(f64::MAX).is_finite() && delta_t_s(-1e300).is_finite());
    }
}
