//! Faults: what is wrong with an asset file, where, what was expected and what to do. All of them together, never the first only.

use miette::{Diagnostic, NamedSource, SourceSpan};
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// One thing that is wrong.
#[derive(Clone, Debug, Error, Diagnostic)]
#[error("{}{}: {message}", file.display(), line.map(|(l, c)| format!(":{l}:{c}")).unwrap_or_default())]
pub struct Fault {
    /// The file.
    pub file: PathBuf,
    /// Line and column, from 1, where known.
    pub line: Option<(usize, usize)>,
    /// What is wrong, and what was expected.
    pub message: String,
    /// What to do.
    #[help]
    pub help: Option<String>,
    /// The file's text, for the excerpt.
    #[source_code]
    source_code: NamedSource<String>,
    #[label("here")]
    span: Option<SourceSpan>,
}

impl Fault {
    /// A fault of a whole file.
    pub fn of_file(file: &Path, message: impl Into<String>) -> Self {
        Self {
            file: file.to_owned(),
            line: None,
            message: message.into(),
            help: None,
            source_code: NamedSource::new(file.display().to_string(), String::new()),
            span: None,
        }
    }

    /// A fault at a place of a file's text.
    pub fn at(file: &Path, text: &str, span: Option<Range<usize>>, message: impl Into<String>) -> Self {
        let span = span.map(|s| s.start.min(text.len())..s.end.min(text.len()));
        let line = span.as_ref().map(|s| {
            let before = text.get(..s.start).unwrap_or_default();
            (before.matches('\n').count() + 1, before.chars().rev().take_while(|c| *c != '\n').count() + 1)
        });
        Self {
            file: file.to_owned(),
            line,
            message: message.into(),
            help: None,
            source_code: NamedSource::new(file.display().to_string(), text.to_owned()),
            span: span.map(|s| (s.start, s.end.saturating_sub(s.start)).into()),
        }
    }

    /// The same fault with advice.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// Everything that is wrong.
#[derive(Clone, Debug, Default, Error, Diagnostic)]
#[error("{} in the assets", if faults.len() == 1 { "a fault".to_owned() } else { format!("{} faults", faults.len()) })]
pub struct AssetErrors {
    /// In the order of the files.
    #[related]
    pub faults: Vec<Fault>,
}

impl AssetErrors {
    /// Only one thing.
    pub fn one(fault: Fault) -> Self {
        Self { faults: vec![fault] }
    }

    /// `value` when nothing is wrong.
    pub fn or<T>(self, value: T) -> Result<T, Self> {
        if self.faults.is_empty() { Ok(value) } else { Err(self) }
    }

    /// Takes over the faults of a failed step and goes on without its value.
    pub fn keep<T>(&mut self, step: Result<T, Self>) -> Option<T> {
        step.map_err(|e| self.faults.extend(e.faults)).ok()
    }

    /// Adds a fault.
    pub fn push(&mut self, fault: Fault) {
        self.faults.push(fault);
    }

    /// One line for each, without excerpts: for a message on the screen.
    pub fn lines(&self) -> impl fmt::Display + '_ {
        struct Lines<'a>(&'a [Fault]);
        impl fmt::Display for Lines<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                for fault in self.0 {
                    writeln!(f, "{fault}")?;
                    if let Some(help) = &fault.help {
                        writeln!(f, "  {help}")?;
                    }
                }
                Ok(())
            }
        }
        Lines(&self.faults)
    }
}

/// The name nearest to `wrong`, when it is near enough to have been meant.
pub fn did_you_mean<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|name| (strsim::normalized_damerau_levenshtein(wrong, name), name))
        .filter(|(likeness, _)| *likeness >= 0.5)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_names_file_line_and_column() {
        let text = "a = 1\nbb = nope\n";
        let fault = Fault::at(Path::new("x/body.toml"), text, Some(11..15), "expected a number");
        assert_eq!(fault.to_string(), "x/body.toml:2:6: expected a number");
        let errors = AssetErrors::one(fault.help("write one"));
        assert!(errors.lines().to_string().contains("write one"));
    }

    #[test]
    fn near_names_are_offered_and_far_ones_are_not() {
        assert_eq!(did_you_mean("radus_km", ["radius_km", "albedo"]), Some("radius_km"));
        assert_eq!(did_you_mean("zzz", ["radius_km", "albedo"]), None);
    }
}
