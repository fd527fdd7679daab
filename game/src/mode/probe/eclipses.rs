//! `syzygy probe eclipses`: the eclipses on one body by another, as JSON.
//!
//! Conventions are those of NASA's canons ([`engine::orbit::eclipse`]): lunar eclipses are timed as seen from the caster, and their
//! place is the one there that has the receiver in the zenith.

use crate::cli::ProbeEclipsesArgs;
use crate::world::eclipse::almanac;
use crate::world::eclipse::visit::iso;
use crate::world::system::System;
use engine::light::occlusion::visible_behind_disc;
use engine::orbit::BodyId;
use engine::orbit::eclipse::local::Observer;
use engine::orbit::eclipse::{Cast, Eclipse, Paths, Place, Span, solar};
use engine::time::Moment;
use engine::units::DEG;
use serde::Serialize;
use std::io::{self, Write};

/// One eclipse; the first six keys are a contract of the command line.
#[derive(Serialize)]
struct Row {
    jd_tt_greatest: f64,
    kind: &'static str,
    gamma: f64,
    magnitude: f64,
    lat_deg: f64,
    lon_deg: f64,
    utc: String,
    penumbral_magnitude: f64,
    central: bool,
    star_altitude_deg: f64,
    duration_s: f64,
    contacts_jd_tt: Contacts,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    central_line: Vec<Point>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    places: Vec<Option<Seen>>,
}

/// First and last: of the penumbra, of the umbra, of what lies within (solar: the central line; lunar: totality).
#[derive(Serialize)]
struct Contacts {
    penumbra: [f64; 2],
    umbra: Option<[f64; 2]>,
    core: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct Point {
    jd_tt: f64,
    lat_deg: f64,
    lon_deg: f64,
}

/// What one place sees; `visible` where the star is up at the deepest moment.
#[derive(Serialize)]
struct Seen {
    lat_deg: f64,
    lon_deg: f64,
    kind: &'static str,
    visible: bool,
    jd_tt_greatest: f64,
    utc: String,
    magnitude: f64,
    obscuration: f64,
    star_altitude_deg: f64,
    partial_jd_tt: [f64; 2],
    inner_jd_tt: Option<[f64; 2]>,
    duration_s: f64,
}

fn span(s: Span, late_s: f64) -> [f64; 2] {
    s.map(|t| t.plus_s(late_s).jd_tt())
}

fn seen(cast: &Cast<'_>, paths: &Paths<'_>, eclipse: &Eclipse, (lat, lon): (f64, f64)) -> Option<Seen> {
    let observer = Observer { place: Place { lat_rad: lat * DEG, lon_rad: lon * DEG }, height_m: 0.0 };
    let local = observer.seen(cast, paths, eclipse)?;
    let [star, caster, apart] = local.discs_rad;
    Some(Seen {
        lat_deg: lat,
        lon_deg: lon,
        kind: local.kind.word(),
        visible: local.star_altitude_rad > 0.0,
        jd_tt_greatest: local.greatest.jd_tt(),
        utc: iso(local.greatest.tick.utc()),
        magnitude: local.magnitude,
        obscuration: 1.0 - visible_behind_disc(star, caster, apart),
        star_altitude_deg: local.star_altitude_rad / DEG,
        partial_jd_tt: span(local.partial, 0.0),
        inner_jd_tt: local.inner.map(|s| span(s, 0.0)),
        duration_s: local.inner.map_or(0.0, |[a, b]| b.since(a)),
    })
}

fn row(cast: &Cast<'_>, paths: &Paths<'_>, e: &Eclipse, args: &ProbeEclipsesArgs) -> Row {
    let greatest = e.canonical(cast);
    let late_s = greatest.since(e.greatest);
    let point = |(t, place): (Moment, Place)| Point { jd_tt: t.jd_tt(), lat_deg: place.lat_rad / DEG, lon_deg: place.lon_rad / DEG };
    Row {
        jd_tt_greatest: greatest.jd_tt(),
        kind: e.kind.word(),
        gamma: e.gamma,
        magnitude: e.magnitude,
        lat_deg: e.place.lat_rad / DEG,
        lon_deg: e.place.lon_rad / DEG,
        utc: iso(greatest.tick.utc()),
        penumbral_magnitude: e.penumbral_magnitude,
        central: e.central,
        star_altitude_deg: e.star_altitude_rad / DEG,
        duration_s: e.duration_s,
        contacts_jd_tt: Contacts {
            penumbra: span(e.penumbra, late_s),
            umbra: e.umbra.map(|s| span(s, late_s)),
            core: e.core.map(|s| span(s, late_s)),
        },
        central_line: solar::central_line(cast, paths, e, usize::from(args.line)).into_iter().map(point).collect(),
        places: if cast.is_solar() { args.at.iter().map(|at| seen(cast, paths, e, *at)).collect() } else { Vec::new() },
    }
}

/// Writes `[{jd_tt_greatest, kind, gamma, magnitude, lat_deg, lon_deg, …}]`, earliest first.
///
/// # Errors
/// Those of the writer.
pub fn write(system: &System, on: BodyId, by: BodyId, args: &ProbeEclipsesArgs, out: &mut dyn Write) -> io::Result<()> {
    let mut rows = Vec::new();
    let [from, to] = [args.from, args.to].map(Moment::from_jd_tt);
    almanac::find(system, on, by, from, to, &mut |eclipse| {
        rows.extend(almanac::with_paths(system, &almanac::Event { on, by, eclipse }, |cast, paths| row(cast, paths, &eclipse, args)));
        true
    });
    serde_json::to_writer_pretty(&mut *out, &rows)?;
    writeln!(out)
}
