//! `syzygy probe kepler`: two-body states after a time, for the starts of a CSV file. Any consistent units.

use engine::orbit::kepler::batch::{Starts, propagate_many};
use glam::DVec3;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The columns of a file of cases; others are passed over.
pub const COLUMNS: [&str; 8] = ["gm", "x", "y", "z", "vx", "vy", "vz", "dt"];

/// Why there are no states.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum KeplerError {
    /// The cases cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line is no case.
    #[error("{}:{line}: `{text}`: {expected}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What stands there.
        text: String,
        /// What should.
        expected: String,
    },
}

/// Cases, a column each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cases([Vec<f64>; 8]);

/// Reads cases: a header with the [`COLUMNS`] in any order, then a case a line.
pub fn cases(path: &Path) -> Result<Cases, KeplerError> {
    let text = std::fs::read_to_string(path).map_err(|source| KeplerError::Read { path: path.to_owned(), source })?;
    let fault =
        |line: usize, text: &str, expected: String| KeplerError::Line { path: path.to_owned(), line, text: text.to_owned(), expected };
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty());
    let (first, header) = lines.next().unwrap_or_default();
    let mut places = [0; 8];
    for (place, name) in places.iter_mut().zip(COLUMNS) {
        *place = header.split(',').position(|c| c.trim() == name).ok_or_else(|| {
            fault(first + 1, header, format!("expected a header with the columns {}; `{name}` is missing", COLUMNS.join(",")))
        })?;
    }
    let mut cases = Cases::default();
    for (index, line) in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        for ((column, place), name) in cases.0.iter_mut().zip(places).zip(COLUMNS) {
            let number = cells.get(place).and_then(|c| c.parse::<f64>().ok()).filter(|x| x.is_finite());
            column.push(number.ok_or_else(|| fault(index + 1, line, format!("expected `{name}` to be a finite number")))?);
        }
    }
    Ok(cases)
}

/// Writes `x,y,z,vx,vy,vz` after `dt`, a line a case, to 17 digits.
pub fn write(cases: &Cases, out: &mut dyn Write) -> io::Result<()> {
    let [gm, x, y, z, vx, vy, vz, dt_s] = &cases.0;
    let mut states = vec![(DVec3::ZERO, DVec3::ZERO); gm.len()];
    propagate_many(&Starts { gm, r: [x, y, z], v: [vx, vy, vz], dt_s }, &mut states);
    let mut out = io::BufWriter::new(out);
    writeln!(out, "x,y,z,vx,vy,vz")?;
    for (r, v) in states {
        writeln!(out, "{:.16e},{:.16e},{:.16e},{:.16e},{:.16e},{:.16e}", r.x, r.y, r.z, v.x, v.y, v.z)?;
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> (tempfile::TempDir, PathBuf) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("c.csv");
        std::fs::write(&path, text).unwrap();
        (dir, path)
    }

    #[test]
    fn a_quarter_of_a_circle_and_a_straight_line() {
        let (_dir, path) = file("dt,gm,x,y,z,vx,vy,vz,note\n1.5707963267948966,1,1,0,0,0,1,0,a\n\n2,0,1,2,3,1,0,-1,b\n");
        let mut out = Vec::new();
        write(&cases(&path).unwrap(), &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let rows: Vec<Vec<f64>> = text.lines().skip(1).map(|l| l.split(',').map(|c| c.parse().unwrap()).collect()).collect();
        assert_eq!(text.lines().next(), Some("x,y,z,vx,vy,vz"));
        let off = rows[0].iter().zip([0.0, 1.0, 0.0, -1.0, 0.0, 0.0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-15, "{text}");
        assert_eq!(rows[1], [3.0, 2.0, 1.0, 1.0, 0.0, -1.0]);
        assert!(text.lines().nth(2).unwrap().starts_with("3.0000000000000000e0,"), "{text}");
    }

    #[test]
    fn bad_lines_are_named() {
        let says = |text: &str| {
            let (_dir, path) = file(text);
            cases(&path).unwrap_err().to_string()
        };
        let head = "gm,x,y,z,vx,vy,vz,dt\n";
        let message = says(&format!("{head}1,1,0,0,0,1,0,1\n1,1,0,0,0,east,0,1\n"));
        assert!(message.contains("c.csv:3") && message.contains("`vy`"), "{message}");
        let message = says(&format!("{head}1,1,0,0,0,1,0\n"));
        assert!(message.contains("c.csv:2") && message.contains("`dt`"), "{message}");
        assert!(says(&format!("{head}1,1,0,0,0,1,0,inf\n")).contains("finite"));
        let message = says("gm,x,y,z,vx,vy,vz\n1,1,0,0,0,1,0\n");
        assert!(message.contains("c.csv:1") && message.contains("`dt` is missing"), "{message}");
        assert!(says("").contains("header"));
    }
}
