//! The column: temperature, pressure and density of air against altitude; what drags.

/// Air at one altitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Kinetic temperature, K.
    pub temperature_k: f64,
    /// Pressure, Pa.
    pub pressure_pa: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Speed of sound, m/s.
    pub speed_of_sound_m_s: f64,
}

/// Temperature, pressure and density against geometric altitude.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Altitude above which drag is not computed, m.
    pub top_m: f64,
}

impl Column {
    /// Air at a geometric altitude above the datum; all zero at and above `top_m`.
    pub fn at(&self, altitude_m: f64) -> Sample {
        let _ = altitude_m;
        Sample::default()
    }
}
