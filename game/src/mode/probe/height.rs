//! `syzygy probe height`: the height of the ground at points of a CSV file.

use engine::space::sphere;
use engine::terrain::Relief;
use engine::units::DEG;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why there are no heights.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum HeightError {
    /// The points cannot be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line is no point.
    #[error("{}:{line}: `{text}`: {expected}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What stands there.
        text: String,
        /// What should.
        expected: &'static str,
    },
    /// The body has no ground.
    #[error("{0} has no ground: it has no [relief] table")]
    NoGround(String),
    /// The answer cannot be written.
    #[error(transparent)]
    Write(#[from] io::Error),
}

/// Reads points: a header with the columns `lat_deg` and `lon_deg` (others are passed over), then a point a line.
pub fn points(path: &Path) -> Result<Vec<(f64, f64)>, HeightError> {
    let text = std::fs::read_to_string(path).map_err(|source| HeightError::Read { path: path.to_owned(), source })?;
    let fault = |line: usize, text: &str, expected| HeightError::Line { path: path.to_owned(), line, text: text.to_owned(), expected };
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty());
    let header = lines.next().map_or("", |(_, l)| l);
    let column = |name: &str| header.split(',').position(|c| c.trim() == name);
    let (Some(lat), Some(lon)) = (column("lat_deg"), column("lon_deg")) else {
        return Err(fault(1, header, "expected a header with the columns lat_deg and lon_deg"));
    };
    lines
        .map(|(index, line)| {
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            let number = |at: usize, limit: f64| cells.get(at).and_then(|c| c.parse::<f64>().ok()).filter(|x| x.abs() <= limit);
            match (number(lat, 90.0), number(lon, 360.0)) {
                (Some(a), Some(b)) => Ok((a, b)),
                (None, _) => Err(fault(index + 1, line, "expected lat_deg to be a number from -90 to 90")),
                (_, None) => Err(fault(index + 1, line, "expected lon_deg to be a number from -360 to 360")),
            }
        })
        .collect()
}

/// Writes `lat_deg,lon_deg,height_m`, a line a point; the sea floor is negative.
pub fn write(relief: &Relief, points: &[(f64, f64)], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "lat_deg,lon_deg,height_m")?;
    for (lat, lon) in points {
        let height = relief.height_m(sphere::direction_of_lat_lon(lat * DEG, lon * DEG));
        writeln!(out, "{lat},{lon},{height:.4}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_read_and_bad_lines_named() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("p.csv");
        std::fs::write(&path, "name,lat_deg,lon_deg\na,45.5,-7\n\nb,-90,180\n").unwrap();
        assert_eq!(points(&path).unwrap(), vec![(45.5, -7.0), (-90.0, 180.0)]);
        std::fs::write(&path, "lat_deg,lon_deg\n1,2\nNaN,3\n").unwrap();
        let message = points(&path).unwrap_err().to_string();
        assert!(message.contains("p.csv:3") && message.contains("lat_deg"), "{message}");
        std::fs::write(&path, "x,y\n1,2\n").unwrap();
        assert!(points(&path).unwrap_err().to_string().contains("header"));
    }
}
