//! A body's file, `body.toml`: from keys to a checked [`BodySpec`]. The schema is described at the head of [`super`].
//!
//! Not here: air ([`super::atmosphere`], a file of its own), ground ([`super::relief`]), what needs other bodies ([`super::system`]).

use super::fault::At;
use super::reader::{ANY, POSITIVE, Reader};
use super::relief::read_relief;
use engine::light::spectrum::Starlight;
use engine::orbit::State;
use engine::orbit::eclipse::Shape;
use engine::orbit::ephemeris::{MeanOrbit, Path};
use engine::orbit::gravity::figure::Figure;
use engine::orbit::rotation::{Model, Spin, Term};
use engine::space::{Icrf, Position, Velocity};
use engine::terrain::ReliefSpec;
use engine::time::SimTime;
use engine::units::{AU, DAY, DEG, KM, KM3_S2};
use glam::{DVec3, Vec3};

/// Days in a Julian year.
const YEAR_D: f64 = 365.25;
/// Julian dates that [`SimTime`] is meant for: ±100,000 years.
const JD_RANGE: core::ops::RangeInclusive<f64> = -34_073_455.0..=38_976_545.0;
/// Degrees that make sense for an angle in a file.
const TURN: core::ops::RangeInclusive<f64> = -3600.0..=3600.0;

/// What a body's file says, in SI.
#[derive(Clone, Debug)]
pub struct BodySpec {
    /// Folder name.
    pub key: String,
    /// Display name.
    pub name: String,
    /// Key of what it orbits, and where that is written; `None` for the star.
    pub parent: Option<(String, At)>,
    /// m³/s².
    pub gm_m3_s2: f64,
    /// m.
    pub radius_m: f64,
    /// Linear sRGB.
    pub albedo: Vec3,
    /// cd per linear sRGB channel; zero for all but stars.
    pub intensity_cd: Vec3,
    /// Spectrum of its light; `None` for all but stars.
    pub starlight: Option<Starlight>,
    /// Pole and meridian.
    pub spin: Spin,
    /// What throws and catches shadows.
    pub shape: Shape,
    /// How its gravity differs from a point's, with its axes.
    pub figure: Option<Figure>,
    /// GM with all its moons, also those without a folder, m³/s².
    pub family_gm_m3_s2: Option<f64>,
    /// Where it is.
    pub path: Path,
    /// Its ground and its greatest exaggeration.
    pub relief: Option<(ReliefSpec, f64)>,
    /// The file.
    pub at: At,
}

/// Narrows colours and the like.
pub fn vec3(v: [f64; 3]) -> Vec3 {
    engine::space::relative::narrow3(DVec3::from_array(v))
}

/// Reads the file; faults go to the reader.
pub fn read_body(key: &str, r: Reader<'_>) -> BodySpec {
    let name = r.text("name");
    let parent = r.maybe_text("parent").map(|p| (p, r.node.place_of("parent")));
    let gm_m3_s2 = r.number("gm_km3_s2", POSITIVE) * KM3_S2;
    let radius_m = r.number("radius_km", 0.1..=1e7) * KM;
    let albedo = vec3(r.numbers("albedo", 0.0..=1.0));
    let (intensity_cd, starlight) = r.maybe_table("star").map(read_star).unzip();
    let spin = r.table("rotation").map(read_spin).unwrap_or_default();
    let shape = r.maybe_table("shape").map_or(Shape::sphere(radius_m), |t| read_shape(t, radius_m));
    let gravity = r.maybe_table("gravity").map(|t| read_gravity(t, &spin, gm_m3_s2));
    let path = r.table("orbit").map_or_else(nowhere, read_path);
    let relief = r.maybe_table("relief").map(read_relief);
    if parent.is_some() && intensity_cd.is_some() {
        r.wrong("star", "`star`: expected only in the body without a `parent`");
    }
    let spec = BodySpec {
        key: key.to_owned(),
        name,
        parent,
        gm_m3_s2,
        radius_m,
        albedo,
        intensity_cd: intensity_cd.unwrap_or(Vec3::ZERO),
        starlight,
        family_gm_m3_s2: gravity.as_ref().and_then(|g| g.1),
        figure: gravity.map(|g| g.0),
        spin,
        shape,
        path,
        relief,
        at: r.node.at.clone(),
    };
    r.finish();
    spec
}

/// Intensity (cd per channel) and spectrum of a star: a black body's, its own, or the Sun's; its colour by that, unless it is given.
fn read_star(s: Reader<'_>) -> (Vec3, Starlight) {
    let lux = s.number("illuminance_at_1_au_lx", POSITIVE);
    let starlight = if let Some(temperature_k) = s.maybe_number("temperature_k", 500.0..=1e6) {
        Starlight::BlackBody(temperature_k)
    } else if s.has("wavelengths_nm") || s.has("irradiance") {
        let (wavelengths_nm, irradiance) = (s.series("wavelengths_nm", 1.0..=1e5), s.series("irradiance", 0.0..=1e30));
        if wavelengths_nm.len() != irradiance.len() || wavelengths_nm.windows(2).any(|w| w[1] <= w[0]) {
            s.wrong("wavelengths_nm", "[star]: expected as many `irradiance` as `wavelengths_nm`, and these rising");
        }
        Starlight::Table(wavelengths_nm.into_iter().zip(irradiance).collect())
    } else {
        Starlight::Sun
    };
    let colour = if s.has("colour") { vec3(s.numbers("colour", 0.0..=100.0)) } else { starlight.colour() };
    s.finish();
    (colour * engine::space::relative::narrow(lux * AU * AU), starlight)
}

fn nowhere() -> Path {
    Path::FromParent { epoch: SimTime::default(), state: State::default() }
}

fn read_shape(r: Reader<'_>, radius_m: f64) -> Shape {
    let radii = 0.1..=1e7;
    let equatorial_m = r.maybe_number("equatorial_radius_km", radii.clone()).map_or(radius_m, |x| x * KM);
    let limb_m = r.node.get("limb_radius_km").map_or([equatorial_m; 2], |_| r.numbers::<2>("limb_radius_km", radii).map(|x| x * KM));
    let shape = Shape {
        equatorial_m,
        flattening: r.maybe_number("flattening", 0.0..=0.5).unwrap_or(0.0),
        limb_m,
        shadow: r.maybe_number("shadow_enlargement", 1.0..=1.1).unwrap_or(1.0),
    };
    r.finish();
    shape
}

fn read_spin(r: Reader<'_>) -> Spin {
    let terms = |rows: Vec<[f64; 3]>| -> Vec<Term> {
        let term = |[a, p, w]: [f64; 3]| Term { amplitude_rad: a * DEG, phase_rad: p * DEG, rate_rad_per_century: w * DEG };
        rows.into_iter().map(term).collect()
    };
    // The Earth's turning is observed: the model has its own numbers, and one left beside it would be read by nobody.
    if r.maybe_text("model").is_some() {
        let model = r.choice("model", &["iau", "earth"]);
        if model == "earth" {
            r.finish();
            return Spin::earth();
        }
    }
    let spin = Spin {
        model: Model::Iau,
        pole_ra_rad: [r.number("pole_ra_deg", TURN) * DEG, r.number("pole_ra_deg_per_century", TURN) * DEG],
        pole_dec_rad: [r.number("pole_dec_deg", -90.0..=90.0) * DEG, r.number("pole_dec_deg_per_century", TURN) * DEG],
        meridian_rad: [r.number("meridian_deg", TURN) * DEG, r.number("meridian_deg_per_day", -1e6..=1e6) * DEG],
        meridian_quadratic_rad: r.maybe_number("meridian_deg_per_century2", -1e6..=1e6).map_or(0.0, |x| x * DEG),
        pole_ra_terms: terms(r.rows("pole_ra_terms")),
        pole_dec_terms: terms(r.rows("pole_dec_terms")),
        meridian_terms: terms(r.rows("meridian_terms")),
    };
    r.finish();
    spin
}

/// The figure, and GM with all moons.
fn read_gravity(r: Reader<'_>, spin: &Spin, gm_m3_s2: f64) -> (Figure, Option<f64>) {
    // No body held together by its own gravity is flatter than J₂ = 1/2, a rod seen from its end.
    const HARMONIC: core::ops::RangeInclusive<f64> = -0.5..=0.5;
    let family = r.maybe_number("gm_with_moons_km3_s2", POSITIVE).map(|x| x * KM3_S2);
    if family.is_some_and(|f| f < gm_m3_s2) {
        r.wrong("gm_with_moons_km3_s2", "`gravity.gm_with_moons_km3_s2`: expected no less than `gm_km3_s2`");
    }
    let figure = Figure {
        radius_m: r.number("reference_radius_km", POSITIVE) * KM,
        zonal: [r.number("j2", HARMONIC), r.number("j3", HARMONIC), r.number("j4", HARMONIC)],
        c22: r.maybe_number("c22", HARMONIC).unwrap_or(0.0),
        tide: [r.maybe_number("tide_k2", 0.0..=1.5).unwrap_or(0.0), r.maybe_number("tide_lag_s", -1e5..=1e5).unwrap_or(0.0)],
        spin: spin.clone(),
    };
    r.finish();
    (figure, family)
}

fn read_path(r: Reader<'_>) -> Path {
    let kind = r.choice("kind", &["barycentric", "from_parent", "mean"]);
    let jd = r.number("epoch_jd_tdb", JD_RANGE);
    let epoch = if jd.is_finite() { SimTime::from_jd_tdb(jd) } else { SimTime::default() };
    let path = match kind {
        "mean" => Path::Mean(read_mean(&r, epoch)),
        kind => {
            let position = r.numbers::<3>("position_km", -1e12..=1e12);
            let velocity = r.numbers::<3>("velocity_km_s", -3e5..=3e5);
            let state = State::<Icrf> {
                position: Position::new(DVec3::from_array(position) * KM),
                velocity: Velocity::new(DVec3::from_array(velocity) * KM),
            };
            if kind == "barycentric" {
                Path::Barycentric { epoch, state, of_system: r.flag("with_moons") }
            } else {
                Path::FromParent { epoch, state }
            }
        }
    };
    r.finish();
    path
}

fn read_mean(r: &Reader<'_>, epoch: SimTime) -> MeanOrbit {
    let deg = |key, range| r.number(key, range) * DEG;
    let yearly = |key| r.number(key, -1e5..=1e5) * DEG / (YEAR_D * DAY);
    MeanOrbit {
        epoch,
        semi_major_m: r.number("semi_major_axis_km", POSITIVE) * KM,
        eccentricity: r.number("eccentricity", 0.0..=0.999),
        inclination_rad: deg("inclination_deg", 0.0..=180.0),
        node_rad: [deg("node_deg", TURN), yearly("node_deg_per_year")],
        argument_rad: [deg("argument_deg", TURN), yearly("argument_deg_per_year")],
        mean_anomaly_rad: deg("mean_anomaly_deg", TURN),
        mean_longitude_rate_rad_s: r.number("mean_longitude_deg_per_day", ANY) * DEG / DAY,
        pole_ra_dec_rad: [deg("plane_pole_ra_deg", TURN), deg("plane_pole_dec_deg", -90.0..=90.0)],
    }
}
