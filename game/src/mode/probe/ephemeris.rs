//! `syzygy probe ephemeris`: position and velocity of a body, ICRF axes, as JSON.

use engine::orbit::BodyId;
use engine::orbit::ephemeris::Ephemeris;
use engine::time::SimTime;
use serde::Serialize;
use std::io::{self, Write};

/// One date's answer; the keys are a contract of the command line.
#[derive(Serialize)]
struct Row {
    jd_tdb: f64,
    position_m: [f64; 3],
    velocity_m_s: [f64; 3],
}

/// Writes `[{jd_tdb, position_m, velocity_m_s}]`, from the barycentre unless there is a `center`. Dates are taken to the
/// nearest tick (1/60 s), and moved on along the velocity from there.
pub fn write(ephemeris: &Ephemeris, body: BodyId, center: Option<BodyId>, dates: &[f64], out: &mut dyn Write) -> io::Result<()> {
    let rows: Vec<Row> = dates
        .iter()
        .map(|&jd_tdb| {
            let t = SimTime::from_jd_tdb(jd_tdb);
            let state = center.map_or_else(|| ephemeris.state(body, t), |c| ephemeris.relative(body, c, t));
            let beyond_s = (jd_tdb - t.jd_tdb()) * engine::units::DAY;
            Row {
                jd_tdb,
                position_m: (state.position + state.velocity.over(beyond_s)).0.to_array(),
                velocity_m_s: state.velocity.0.to_array(),
            }
        })
        .collect();
    serde_json::to_writer_pretty(&mut *out, &rows)?;
    writeln!(out)
}
