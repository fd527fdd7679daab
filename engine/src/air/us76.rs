//! The numbers of the US Standard Atmosphere, 1976 [USSA 1976: NOAA, NASA, USAF, "U.S. Standard Atmosphere, 1976"].
//!
//! Below 86 km: seven layers (table 4). Above: kinetic temperature by the four segments of eqs. 25, 27, 29, 31; pressure and
//! density from table I, interpolated by a cubic in the logarithm whose slope is hydrostatic for pressure.

use super::density::Lapse;
use crate::units::KM;

/// r₀, m.
pub const RADIUS_M: f64 = 6356.766 * KM;
/// g₀, m/s².
pub const GRAVITY_M_S2: f64 = 9.806_65;
/// R*/M₀ with the model's own R* = 8314.32 J/(kmol K) and M₀ = 28.9644 kg/kmol, J/(kg K).
pub const GAS_CONSTANT: f64 = 8314.32 / 28.9644;
/// Temperature at the datum, K.
pub const TEMPERATURE_K: f64 = 288.15;
/// Pressure at the datum, Pa.
pub const PRESSURE_PA: f64 = 101_325.0;
/// Where the layers end and the table begins, m (geometric).
pub const UPPER_BASE_M: f64 = 86.0 * KM;
/// Where the model ends, m (geometric).
pub const TOP_M: f64 = 1000.0 * KM;

/// Table 4: molecular-scale temperature against geopotential altitude.
pub const LAPSE: [Lapse; 7] = [
    Lapse { to_altitude_m: 11.0 * KM, k_per_m: -6.5e-3 },
    Lapse { to_altitude_m: 20.0 * KM, k_per_m: 0.0 },
    Lapse { to_altitude_m: 32.0 * KM, k_per_m: 1.0e-3 },
    Lapse { to_altitude_m: 47.0 * KM, k_per_m: 2.8e-3 },
    Lapse { to_altitude_m: 51.0 * KM, k_per_m: 0.0 },
    Lapse { to_altitude_m: 71.0 * KM, k_per_m: -2.8e-3 },
    Lapse { to_altitude_m: 84.852 * KM, k_per_m: -2.0e-3 },
];

/// Table I: geometric altitude in km, pressure in Pa, density in kg/m³. The first row is replaced by the layers' own end.
const TABLE: [[f64; 3]; 19] = [
    [86.0, 0.373_38, 6.958e-6],
    [90.0, 0.183_59, 3.416e-6],
    [95.0, 0.075_966, 1.393e-6],
    [100.0, 0.032_011, 5.604e-7],
    [110.0, 0.007_104_2, 9.708e-8],
    [120.0, 0.002_538_1, 2.222e-8],
    [130.0, 0.001_250_5, 8.152e-9],
    [140.0, 7.2028e-4, 3.831e-9],
    [150.0, 4.5422e-4, 2.076e-9],
    [160.0, 3.0395e-4, 1.233e-9],
    [180.0, 1.5271e-4, 5.194e-10],
    [200.0, 8.4736e-5, 2.541e-10],
    [300.0, 8.7704e-6, 1.916e-11],
    [400.0, 1.4518e-6, 2.803e-12],
    [500.0, 3.0236e-7, 5.215e-13],
    [600.0, 8.213e-8, 1.137e-13],
    [700.0, 3.1908e-8, 3.07e-14],
    [800.0, 1.7036e-8, 1.136e-14],
    [1000.0, 7.5138e-9, 3.561e-15],
];

/// M/M₀ below 86 km: 1 to 80 km, then falling to 0.999579 (table 8, here a parabola within 5e-5 of it).
pub fn molar_mass_ratio(altitude_m: f64) -> f64 {
    let x = ((altitude_m - 80.0 * KM) / (6.0 * KM)).clamp(0.0, 1.0);
    1.0 - 4.21e-4 * x * x
}

/// Kinetic temperature above 86 km, K.
fn temperature_k(altitude_m: f64) -> f64 {
    let z = altitude_m / KM;
    if z <= 91.0 {
        186.8673
    } else if z <= 110.0 {
        let x = (z - 91.0) / 19.9429;
        263.1905 - 76.3232 * (1.0 - x * x).max(0.0).sqrt()
    } else if z <= 120.0 {
        240.0 + 12.0 * (z - 110.0)
    } else {
        let r0 = RADIUS_M / KM;
        1000.0 - 640.0 * libm::exp(-0.01875 * (z - 120.0) * (r0 + 120.0) / (r0 + z))
    }
}

/// A row of the upper table, ready for interpolation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    altitude_m: f64,
    ln_p: f64,
    ln_p_slope: f64,
    ln_rho: f64,
    ln_rho_slope: f64,
}

/// Pressure and density from 86 km to 1,000 km.
#[derive(Clone, Debug, PartialEq)]
pub struct Upper {
    rows: Vec<Row>,
}

impl Upper {
    /// Joins the table to the pressure (Pa) and density (kg/m³) of the layers at 86 km.
    pub fn new(pressure_pa: f64, density_kg_m3: f64) -> Self {
        let mut table = TABLE;
        table[0] = [86.0, pressure_pa, density_kg_m3];
        let ln = |i: usize| libm::log(table[i][2]);
        let slope = |i: usize, j: usize| (ln(j) - ln(i)) / ((table[j][0] - table[i][0]) * KM);
        let rows = (0..table.len())
            .map(|i| {
                let [km, p, rho] = table[i];
                let g = GRAVITY_M_S2 * (RADIUS_M / (RADIUS_M + km * KM)) * (RADIUS_M / (RADIUS_M + km * KM));
                let ln_rho_slope = if i == 0 {
                    slope(0, 1)
                } else if i + 1 == table.len() {
                    slope(i - 1, i)
                } else {
                    // The parabola through three neighbours.
                    let (a, b) = (table[i][0] - table[i - 1][0], table[i + 1][0] - table[i][0]);
                    (slope(i - 1, i) * b + slope(i, i + 1) * a) / (a + b)
                };
                Row { altitude_m: km * KM, ln_p: libm::log(p), ln_p_slope: -rho * g / p, ln_rho: ln(i), ln_rho_slope }
            })
            .collect();
        Self { rows }
    }

    /// Temperature (K), pressure (Pa) and density (kg/m³) at a geometric altitude, held at the table's ends.
    pub fn at(&self, altitude_m: f64) -> (f64, f64, f64) {
        let z = altitude_m.clamp(UPPER_BASE_M, TOP_M);
        let pair = self.rows.windows(2).find(|w| z <= w[1].altitude_m);
        let Some([a, b]) = pair else { return (temperature_k(z), 0.0, 0.0) };
        let width = b.altitude_m - a.altitude_m;
        let x = (z - a.altitude_m) / width;
        let hermite = |y0: f64, m0: f64, y1: f64, m1: f64| {
            let (x2, x3) = (x * x, x * x * x);
            (2.0 * x3 - 3.0 * x2 + 1.0) * y0 + (x3 - 2.0 * x2 + x) * width * m0 + (3.0 * x2 - 2.0 * x3) * y1 + (x3 - x2) * width * m1
        };
        let p = libm::exp(hermite(a.ln_p, a.ln_p_slope, b.ln_p, b.ln_p_slope));
        let rho = libm::exp(hermite(a.ln_rho, a.ln_rho_slope, b.ln_rho, b.ln_rho_slope));
        (temperature_k(z), p, rho)
    }
}
