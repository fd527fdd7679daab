//! `syzygy probe air`: temperature, pressure and density of a body's air at given altitudes, as JSON.

use engine::air::Column;
use serde::Serialize;
use std::io::{self, Write};

/// One altitude's answer; the keys are a contract of the command line.
#[derive(Serialize)]
struct Row {
    altitude_m: f64,
    temperature_k: f64,
    pressure_pa: f64,
    density_kg_m3: f64,
}

/// Writes `[{altitude_m, temperature_k, pressure_pa, density_kg_m3}]`, in the order of `altitudes_m`. The model is asked
/// up to its own end, not only where drag is counted. Errors: those of the writer.
pub fn write(column: &Column, altitudes_m: &[f64], out: &mut dyn Write) -> io::Result<()> {
    let rows: Vec<Row> = altitudes_m
        .iter()
        .map(|&altitude_m| {
            let s = column.model(altitude_m);
            Row { altitude_m, temperature_k: s.temperature_k, pressure_pa: s.pressure_pa, density_kg_m3: s.density_kg_m3 }
        })
        .collect();
    serde_json::to_writer_pretty(&mut *out, &rows)?;
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::air::ColumnSpec;

    #[test]
    fn speaks_the_contract() {
        let column = Column::new(&ColumnSpec::Us76 { drag_top_m: 2.0e5 }).unwrap();
        let mut out = Vec::new();
        write(&column, &[0.0, 4.0e5], &mut out).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&out).unwrap();
        assert_eq!(json[0]["pressure_pa"], 101_325.0);
        assert_eq!(json[0]["temperature_k"], 288.15);
        let rho = json[1]["density_kg_m3"].as_f64().unwrap();
        assert!((rho / 2.803e-12 - 1.0).abs() < 0.01, "{rho}: the drag limit must not cut the answer");
    }
}
