//! Rows of the orbit bench: one run each, ours, other programs' of the same machine, and the anchors that came with the cases.

use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// What other integrators reached on the cases elsewhere (tests/reference/README of the data: two 2.5 GHz cores).
const ANCHORS: &str = include_str!("../../../../tests/reference/orbit_anchors.csv");

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The case, `NAME@T` where it ends at an earlier reference time.
    pub case: String,
    /// The integrator.
    pub method: String,
    /// Its setting.
    pub options: String,
    /// Process CPU time of the run alone, s, the least of several.
    pub cpu_s: f64,
    /// Evaluations of the force on all bodies; none where the method makes none that compare.
    pub force_evals: Option<f64>,
    /// Steps.
    pub steps: f64,
    /// Largest distance of a body from its reference at the end, in the case's unit; none where that is no number.
    pub position_error: Option<f64>,
    /// Relative error of energy at the end.
    pub energy_error: Option<f64>,
}

/// Why rows cannot be read or written.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum RowsError {
    /// A file cannot be read or written.
    #[error("{}: {doing}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What could not be done.
        doing: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// No JSON, or not of the form.
    #[error("{}:{}:{}: {source}", path.display(), source.line(), source.column())]
    #[diagnostic(help(
        "expected a list of rows as tests/peers writes them: [{{\"case\", \"method\", \"options\", \"cpu_s\", \"force_evals\", \"steps\", \"position_error\", \"energy_error\"}}, …]"
    ))]
    Form {
        /// The file.
        path: PathBuf,
        /// What is wrong and where.
        source: serde_json::Error,
    },
    /// A picture cannot be drawn.
    #[error("{}: cannot be drawn: {message}", path.display())]
    Plot {
        /// The picture.
        path: PathBuf,
        /// What went wrong.
        message: String,
    },
}

/// Rows of other programs from a file of JSON.
///
/// # Errors
/// Where that cannot be read or is not of the form.
pub fn peers(path: &Path) -> Result<Vec<Row>, RowsError> {
    let file = |source| RowsError::File { path: path.to_owned(), doing: "cannot be read", source };
    let text = std::fs::read_to_string(path).map_err(file)?;
    serde_json::from_str(&text).map_err(|source| RowsError::Form { path: path.to_owned(), source })
}

/// The anchors of a case: IAS15 and heyoka at any setting.
pub fn anchors(case: &str) -> Vec<Row> {
    let mut lines = ANCHORS.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let column = |name: &str| header.iter().position(|h| *h == name).unwrap_or(usize::MAX);
    let at = ["case", "integrator", "options", "cpu_s", "force_evals", "steps", "worst_pos_err", "rel_energy_err_final"].map(column);
    lines
        .filter_map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let text = |k: usize| cells.get(at[k]).copied().unwrap_or_default();
            let number = |k: usize| text(k).parse::<f64>().ok().filter(|x| x.is_finite());
            Some(Row {
                case: text(0).to_owned(),
                method: text(1).to_owned(),
                options: text(2).to_owned(),
                cpu_s: number(3)?,
                force_evals: number(4),
                steps: number(5).unwrap_or(0.0),
                position_error: number(6),
                energy_error: number(7),
            })
        })
        .filter(|row| row.case == case && (row.method == "ias15" || row.method.starts_with("heyoka")))
        .collect()
}

/// Writes `value` as JSON into a file, or to stdout where there is none.
///
/// # Errors
/// Where that cannot be written.
pub fn write(value: &impl Serialize, path: Option<&Path>) -> Result<(), RowsError> {
    let named = path.unwrap_or(Path::new("stdout"));
    let failed = |source: io::Error| RowsError::File { path: named.to_owned(), doing: "cannot be written", source };
    let mut text = serde_json::to_string_pretty(value).map_err(|e| failed(e.into()))?;
    text.push('\n');
    match path {
        Some(path) => std::fs::write(path, text).map_err(failed),
        None => io::Write::write_all(&mut io::stdout().lock(), text.as_bytes()).map_err(failed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_of_a_case_are_found() {
        let rows = anchors("LEO_1000orb");
        assert!(rows.iter().any(|r| r.method == "ias15" && r.options == "eps=1e-09" && r.force_evals == Some(785_345.0)));
        assert!(rows.iter().any(|r| r.method.starts_with("heyoka") && r.force_evals.is_none()));
        assert!(anchors("nothing").is_empty());
    }

    #[test]
    fn peers_that_are_none_are_refused_with_their_place() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("p.json");
        std::fs::write(&path, "[\n {\"case\": 3}]").unwrap();
        let message = peers(&path).unwrap_err().to_string();
        assert!(message.contains("p.json:2:"), "{message}");
    }
}
