//! The schema of a system's files: `assets/systems/<system>/system.toml` and `<body>/body.toml`, every key with its unit.
//!
//! `[relief]`, `[air.column]` and `[air.medium]` are the engine's own words (`terrain::spec`, `air::density`, `air::medium`).
//! Here is what the words are; what they come to is in [`super::system`].

use engine::air::density::ColumnSpec;
use engine::air::medium::MediumSpec;
use engine::terrain::spec::ReliefSpec;
use serde::Deserialize;

/// `system.toml`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SystemFile {
    /// Display name.
    pub name: String,
    /// TDB Julian date of the states in the bodies' files.
    pub epoch_jd_tdb: f64,
    /// Folders, the star first, a parent before its moons.
    pub bodies: Vec<String>,
}

/// `body.toml`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyFile {
    /// Display name.
    pub name: String,
    /// Folder of the body that it orbits; none for the star.
    pub parent: Option<String>,
    /// Radius of the datum sphere, km.
    pub radius_km: f64,
    /// Gravitational parameter of the body alone, km³/s².
    pub gm_km3_s2: f64,
    /// Mean albedo, linear sRGB.
    pub albedo: [f64; 3],
    /// Largest factor on relief from afar; 1 never exaggerates.
    pub relief_max: f64,
    /// Where it is.
    pub orbit: OrbitTable,
    /// How it turns.
    pub rotation: RotationTable,
    /// Its light, for a star.
    pub star: Option<StarTable>,
    /// Its ground.
    pub relief: Option<ReliefSpec>,
    /// Its air.
    pub air: Option<AirTable>,
}

/// `[orbit]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum OrbitTable {
    /// A state from the barycentre at the system's epoch.
    Barycentric {
        /// km, ICRF axes.
        position_km: [f64; 3],
        /// km/s, ICRF axes.
        velocity_km_s: [f64; 3],
        /// True when it is that of the planet together with its moons.
        with_moons: bool,
    },
    /// A state from the parent's centre at the system's epoch.
    Relative {
        /// km, ICRF axes.
        position_km: [f64; 3],
        /// km/s, ICRF axes.
        velocity_km_s: [f64; 3],
    },
    /// Mean elements about the parent.
    Elements {
        /// When they hold.
        epoch_jd_tdb: f64,
        /// Pole of the reference plane.
        pole_ra_deg: f64,
        /// Pole of the reference plane.
        pole_dec_deg: f64,
        /// km.
        semi_major_axis_km: f64,
        /// 0 … 1.
        eccentricity: f64,
        /// To the reference plane.
        inclination_deg: f64,
        /// Of the ascending node, from the plane's node on the ICRF equator.
        node_deg: f64,
        /// Argument, from the node.
        periapsis_deg: f64,
        /// At the epoch.
        mean_anomaly_deg: f64,
        /// Sidereal.
        mean_motion_deg_per_day: f64,
        /// Precession of the node.
        #[serde(default)]
        node_rate_deg_per_year: f64,
        /// Precession of the argument of periapsis.
        #[serde(default)]
        periapsis_rate_deg_per_year: f64,
    },
}

/// `[rotation]`: value at J2000 and rate, the pole's per Julian century, the meridian's per day.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotationTable {
    /// Right ascension of the pole.
    pub pole_ra_deg: [f64; 2],
    /// Declination of the pole.
    pub pole_dec_deg: [f64; 2],
    /// Prime meridian W.
    pub meridian_deg: [f64; 2],
    /// Periodic terms.
    #[serde(default)]
    pub terms: Vec<TermTable>,
}

/// One periodic term.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TermTable {
    /// Amplitude on the pole's right ascension (sine).
    pub ra_deg: f64,
    /// Amplitude on the pole's declination (cosine).
    pub dec_deg: f64,
    /// Amplitude on the meridian (sine).
    pub meridian_deg: f64,
    /// Angle at J2000.
    pub phase_deg: f64,
    /// Rate of the angle.
    pub rate_deg_per_century: f64,
}

/// `[star]`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StarTable {
    /// Illuminance at one astronomical unit, lx per linear sRGB channel.
    pub illuminance_at_1_au_lx: [f64; 3],
}

/// `[air]`: what drags and what one sees, apart.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AirTable {
    /// Temperature, pressure, density.
    pub column: ColumnSpec,
    /// Optical layers.
    pub medium: MediumSpec,
}
