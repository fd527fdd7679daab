//! The column: temperature, pressure and density of air against altitude; what drags.
//!
//! Two kinds: the US Standard Atmosphere 1976 ([`us76`](super::us76) holds its numbers), and a hydrostatic column for any
//! other body, built of the same layer equations: in geopotential altitude `H = r₀h/(r₀+h)` temperature is piecewise linear, and
//! `dp/dH = −ρg₀` integrates to a power of T, or to an exponential where T is constant [USSA 1976, eqs. 33a, 33b].
//!
//! Not here: what light does in this air ([`super::medium`]). The two are described apart.

use super::{RangeError, us76};
use crate::units::KM;
use serde::{Deserialize, Serialize};

/// Universal gas constant, J/(mol K) (CODATA 2018, exact).
const GAS_CONSTANT: f64 = 8.314_462_618;

/// Air at one altitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Kinetic temperature, K.
    pub temperature_k: f64,
    /// Pressure, Pa.
    pub pressure_pa: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Speed of sound, m/s: √(γp/ρ). Zero in a vacuum.
    pub speed_of_sound_m_s: f64,
}

/// A stretch of constant lapse rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lapse {
    /// Geopotential altitude where the stretch ends, m; it begins where the one before ends (the first: at the datum).
    pub to_altitude_m: f64,
    /// Change of temperature with altitude, K/m (negative: colder above).
    pub k_per_m: f64,
}

/// A column as a file describes it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ColumnSpec {
    /// The US Standard Atmosphere 1976, to 1,000 km.
    Us76 {
        /// Altitude above which drag is neglected, m.
        drag_top_m: f64,
    },
    /// Hydrostatic equilibrium of an ideal gas.
    Hydrostatic {
        /// Altitude above which drag is neglected, m.
        drag_top_m: f64,
        /// Radius of the datum, m.
        radius_m: f64,
        /// Gravity at the datum, m/s².
        gravity_m_s2: f64,
        /// Temperature at the datum, K.
        temperature_k: f64,
        /// Pressure at the datum, Pa.
        pressure_pa: f64,
        /// Mean molar mass, kg/mol.
        molar_mass_kg_mol: f64,
        /// Ratio of heat capacities γ.
        heat_capacity_ratio: f64,
        /// Stretches of constant lapse rate from the datum upwards; above the last, temperature is constant.
        #[serde(default)]
        lapse: Vec<Lapse>,
    },
}

/// One stretch of the layer equations.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layer {
    /// Geopotential altitude of its base, m.
    base_m: f64,
    /// (Molecular-scale) temperature at its base, K.
    temperature_k: f64,
    /// Lapse rate, K/m.
    lapse_k_per_m: f64,
    /// Pressure at its base, Pa.
    pressure_pa: f64,
}

/// Temperature, pressure and density against geometric altitude.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Altitude above which drag is neglected, m: from here up [`Column::at`] gives a vacuum.
    pub top_m: f64,
    /// r₀ of the geopotential altitude, m.
    radius_m: f64,
    /// Gravity at the datum, m/s².
    gravity_m_s2: f64,
    /// Specific gas constant R/M, J/(kg K).
    gas_constant: f64,
    /// γ.
    heat_capacity_ratio: f64,
    /// From the datum up; empty in a vacuum.
    layers: Vec<Layer>,
    /// What replaces the layers at altitude.
    upper: Option<us76::Upper>,
}

impl Column {
    /// Builds a column from its description. All values out of range are reported together.
    pub fn new(spec: &ColumnSpec) -> Result<Self, Vec<RangeError>> {
        match spec {
            ColumnSpec::Us76 { drag_top_m } => {
                let mut errors = Vec::new();
                RangeError::check(&mut errors, "drag_top_m", *drag_top_m, 1.0, 1000.0 * KM);
                if errors.is_empty() { Ok(Self::us76(*drag_top_m)) } else { Err(errors) }
            }
            ColumnSpec::Hydrostatic { .. } => Self::hydrostatic(spec),
        }
    }

    fn us76(drag_top_m: f64) -> Self {
        let mut column = Self {
            top_m: drag_top_m,
            radius_m: us76::RADIUS_M,
            gravity_m_s2: us76::GRAVITY_M_S2,
            gas_constant: us76::GAS_CONSTANT,
            heat_capacity_ratio: 1.4,
            layers: Vec::new(),
            upper: None,
        };
        column.stack(us76::TEMPERATURE_K, us76::PRESSURE_PA, &us76::LAPSE);
        let join = column.layered(us76::UPPER_BASE_M);
        column.upper = Some(us76::Upper::new(join.pressure_pa, join.density_kg_m3));
        column
    }

    fn hydrostatic(spec: &ColumnSpec) -> Result<Self, Vec<RangeError>> {
        let ColumnSpec::Hydrostatic {
            drag_top_m,
            radius_m,
            gravity_m_s2,
            temperature_k,
            pressure_pa,
            molar_mass_kg_mol,
            heat_capacity_ratio,
            lapse,
        } = spec
        else {
            return Ok(Self::default());
        };
        let mut errors = Vec::new();
        RangeError::check(&mut errors, "drag_top_m", *drag_top_m, 1.0, 1.0e8);
        RangeError::check(&mut errors, "radius_m", *radius_m, 1.0e3, 1.0e9);
        RangeError::check(&mut errors, "gravity_m_s2", *gravity_m_s2, 1.0e-4, 1.0e4);
        RangeError::check(&mut errors, "temperature_k", *temperature_k, 1.0, 1.0e4);
        RangeError::check(&mut errors, "pressure_pa", *pressure_pa, 1.0e-9, 1.0e9);
        RangeError::check(&mut errors, "molar_mass_kg_mol", *molar_mass_kg_mol, 1.0e-3, 0.5);
        RangeError::check(&mut errors, "heat_capacity_ratio", *heat_capacity_ratio, 1.0, 1.7);
        let (mut base, mut t) = (0.0, *temperature_k);
        for (i, stretch) in lapse.iter().enumerate() {
            RangeError::check(&mut errors, &format!("lapse[{i}].to_altitude_m"), stretch.to_altitude_m, base, 1.0e7);
            RangeError::check(&mut errors, &format!("lapse[{i}].k_per_m"), stretch.k_per_m, -0.1, 0.1);
            t += stretch.k_per_m * (stretch.to_altitude_m - base);
            RangeError::check(&mut errors, &format!("lapse[{i}]: temperature_k at its end"), t, 1.0, 1.0e5);
            base = stretch.to_altitude_m;
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        let mut column = Self {
            top_m: *drag_top_m,
            radius_m: *radius_m,
            gravity_m_s2: *gravity_m_s2,
            gas_constant: GAS_CONSTANT / molar_mass_kg_mol,
            heat_capacity_ratio: *heat_capacity_ratio,
            layers: Vec::new(),
            upper: None,
        };
        column.stack(*temperature_k, *pressure_pa, lapse);
        Ok(column)
    }

    /// Stacks layers from the datum; the last is isothermal without end.
    fn stack(&mut self, temperature_k: f64, pressure_pa: f64, lapse: &[Lapse]) {
        let mut layer = Layer { base_m: 0.0, temperature_k, lapse_k_per_m: 0.0, pressure_pa };
        for stretch in lapse {
            layer.lapse_k_per_m = stretch.k_per_m;
            self.layers.push(layer);
            let (t, p) = self.within(layer, stretch.to_altitude_m);
            layer = Layer { base_m: stretch.to_altitude_m, temperature_k: t, lapse_k_per_m: 0.0, pressure_pa: p };
        }
        self.layers.push(layer);
    }

    /// Temperature and pressure at geopotential altitude `h_m` by the equation of one layer.
    fn within(&self, layer: Layer, h_m: f64) -> (f64, f64) {
        let dh = h_m - layer.base_m;
        let k = self.gravity_m_s2 / self.gas_constant;
        let t = layer.temperature_k + layer.lapse_k_per_m * dh;
        let p = if layer.lapse_k_per_m == 0.0 {
            // Bounded: far below the datum of a giant the gas stays a gas only in the formula.
            libm::exp((-k * dh / layer.temperature_k).min(60.0))
        } else {
            libm::pow(layer.temperature_k / t, k / layer.lapse_k_per_m)
        };
        (t, layer.pressure_pa * p)
    }

    /// The layer equations at a geometric altitude.
    fn layered(&self, altitude_m: f64) -> Sample {
        // Below −r₀/50 nothing changes any more; so the formulas stay finite whatever is asked.
        let z = altitude_m.max(-0.02 * self.radius_m);
        let h = self.radius_m * z / (self.radius_m + z);
        let Some(&first) = self.layers.first() else { return Sample::default() };
        let mut layer = self.layers.iter().rev().find(|l| h >= l.base_m).copied().unwrap_or(first);
        if h < first.base_m && first.lapse_k_per_m > 0.0 {
            layer.lapse_k_per_m = 0.0; // an inversion at the ground is not carried on downwards
        }
        let (t, p) = self.within(layer, h);
        self.sample(t, p, p / (self.gas_constant * t))
    }

    fn sample(&self, temperature_k: f64, pressure_pa: f64, density_kg_m3: f64) -> Sample {
        if density_kg_m3 <= 0.0 {
            return Sample { temperature_k, ..Sample::default() };
        }
        let speed_of_sound_m_s = (self.heat_capacity_ratio * pressure_pa / density_kg_m3).sqrt();
        Sample { temperature_k, pressure_pa, density_kg_m3, speed_of_sound_m_s }
    }

    /// Air at a geometric altitude above the datum, as drag feels it: all zero at and above [`Column::top_m`].
    pub fn at(&self, altitude_m: f64) -> Sample {
        if altitude_m < self.top_m { self.model(altitude_m) } else { Sample::default() }
    }

    /// Air at a geometric altitude as the model gives it, whatever [`Column::top_m`] is. US76 ends at 1,000 km.
    /// Below the datum the lowest layer goes on; a NaN altitude gives NaN.
    pub fn model(&self, altitude_m: f64) -> Sample {
        match &self.upper {
            Some(_) if altitude_m > us76::TOP_M => Sample::default(),
            Some(upper) if altitude_m > us76::UPPER_BASE_M => {
                let (t, p, rho) = upper.at(altitude_m);
                self.sample(t, p, rho)
            }
            Some(_) => {
                let mut s = self.layered(altitude_m);
                s.temperature_k *= us76::molar_mass_ratio(altitude_m);
                s
            }
            None => self.layered(altitude_m),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn earth() -> Column {
        Column::new(&ColumnSpec::Us76 { drag_top_m: 200.0 * KM }).unwrap()
    }

    fn mars() -> ColumnSpec {
        ColumnSpec::Hydrostatic {
            drag_top_m: 150.0 * KM,
            radius_m: 3389.5 * KM,
            gravity_m_s2: 3.73,
            temperature_k: 215.0,
            pressure_pa: 636.0,
            molar_mass_kg_mol: 0.043_34,
            heat_capacity_ratio: 1.29,
            lapse: vec![Lapse { to_altitude_m: 40.0 * KM, k_per_m: -0.0015 }],
        }
    }

    /// Rows of `us76.csv`, below 86 km by the layer equations: km, K, Pa, kg/m³.
    const BELOW_86: [[f64; 4]; 8] = [
        [0.0, 288.15, 101_325.0, 1.224_999_16],
        [5.003_936, 255.65, 54_019.912_1, 0.736_115_355],
        [11.0, 216.773_51, 22_699.960_7, 0.364_801_564],
        [25.0, 221.552_06, 2_549.222_99, 0.040_083_886_7],
        [47.0, 269.684_13, 115.851_114, 0.001_496_520_33],
        [60.0, 247.020_88, 21.958_666_1, 0.000_309_677_808],
        [71.801_971, 214.65, 3.956_420_43, 6.421_098_67e-5],
        [85.0, 188.893_17, 0.445_680_763, 8.219_500_5e-6],
    ];

    /// Rows of `us76.csv` from USSA 1976 table I, and 250 km from the same table: km, K, Pa, kg/m³.
    const ABOVE_86: [[f64; 4]; 8] = [
        [90.0, 186.87, 0.183_59, 3.416e-6],
        [100.0, 195.08, 0.032_011, 5.604e-7],
        [110.0, 240.0, 0.007_104_2, 9.708e-8],
        [120.0, 360.0, 0.002_538_1, 2.222e-8],
        [150.0, 634.39, 0.000_454_22, 2.076e-9],
        [250.0, 941.33, 2.4767e-5, 6.073e-11],
        [400.0, 995.83, 1.4518e-6, 2.803e-12],
        [1000.0, 1000.0, 7.5138e-9, 3.561e-15],
    ];

    fn worst(rows: &[[f64; 4]]) -> f64 {
        let column = earth();
        let mut worst = 0.0_f64;
        for [km, t, p, rho] in rows {
            let s = column.model(km * KM);
            for (a, b) in [(s.temperature_k, *t), (s.pressure_pa, *p), (s.density_kg_m3, *rho)] {
                worst = worst.max((a / b - 1.0).abs());
            }
        }
        worst
    }

    #[test]
    fn follows_the_us_standard_atmosphere() {
        let (low, high) = (worst(&BELOW_86), worst(&ABOVE_86));
        assert!(low < 1e-3, "below 86 km: {low}");
        assert!(high < 0.02, "above 86 km: {high}");
        assert!((earth().at(0.0).speed_of_sound_m_s - 340.294).abs() < 0.01);
    }

    #[test]
    fn is_continuous_and_falls_everywhere() {
        for column in [earth(), Column::new(&mars()).unwrap()] {
            let mut last = column.model(-5000.0);
            for i in -49..9990 {
                let s = column.model(f64::from(i) * 100.0 + 0.5);
                let ratio = s.density_kg_m3 / last.density_kg_m3;
                assert!((0.97..1.0).contains(&ratio), "density jumps at {i} × 100 m: {ratio}");
                assert!((s.temperature_k - last.temperature_k).abs() < 2.5);
                last = s;
            }
        }
        let (a, b) = (earth().model(86.0 * KM), earth().model(86.0 * KM + 0.01));
        assert!((b.density_kg_m3 / a.density_kg_m3 - 1.0).abs() < 1e-5);
        assert!((b.temperature_k - a.temperature_k).abs() < 0.01);
    }

    #[test]
    fn hydrostatic_balance_holds() {
        // dp/dz = −ρg, by central differences of 20 m.
        for (column, g0, r) in [(Column::new(&mars()).unwrap(), 3.73, 3389.5 * KM), (earth(), 9.806_65, 6356.766 * KM)] {
            for z in [1.0 * KM, 12.5 * KM, 39.0 * KM, 70.0 * KM] {
                let slope = (column.model(z + 10.0).pressure_pa - column.model(z - 10.0).pressure_pa) / 20.0;
                let g = g0 * (r / (r + z)) * (r / (r + z));
                assert!((slope / (-column.model(z).density_kg_m3 * g) - 1.0).abs() < 1e-4, "at {z} m");
            }
        }
    }

    #[test]
    fn ends_sensibly() {
        let column = earth();
        assert_eq!(column.at(column.top_m), Sample::default());
        assert_eq!(column.model(f64::INFINITY), Sample::default());
        let dead_sea = column.at(-430.0);
        assert!((dead_sea.pressure_pa / 106_600.0 - 1.0).abs() < 2e-3, "{}", dead_sea.pressure_pa);
        for column in [column, Column::new(&mars()).unwrap()] {
            let deep = column.at(-1.0e9);
            assert!(deep.pressure_pa.is_finite() && deep.density_kg_m3.is_finite() && deep.density_kg_m3 > 0.0);
        }
        assert_eq!(Column::default().at(0.0), Sample::default());
    }

    #[test]
    fn reports_all_bad_values_at_once() {
        let bad = ColumnSpec::Hydrostatic {
            drag_top_m: f64::NAN,
            radius_m: -1.0,
            gravity_m_s2: 3.7,
            temperature_k: 210.0,
            pressure_pa: f64::INFINITY,
            molar_mass_kg_mol: 0.044,
            heat_capacity_ratio: 1.3,
            lapse: vec![Lapse { to_altitude_m: 80.0 * KM, k_per_m: -0.01 }],
        };
        let fields: Vec<_> = Column::new(&bad).unwrap_err().into_iter().map(|e| e.field).collect();
        assert_eq!(fields, ["drag_top_m", "radius_m", "pressure_pa", "lapse[0]: temperature_k at its end"]);
    }
}
