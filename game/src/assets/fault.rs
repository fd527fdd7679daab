//! Faults: what is wrong with an asset, where, what was expected and what may have been meant. All that is found is kept and
//! shown together; each fault is rendered with its file, line, the offending excerpt and a caret.
//!
//! Not here: finding faults ([`super::reader`] and whoever reads with it).

use miette::{Diagnostic, LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Characters of a line that an excerpt shows: what a panel of the HUD has room for.
const EXCERPT: usize = 90;
/// Faults that a screen shows in full.
const ON_SCREEN: usize = 4;

/// A text file that was read.
#[derive(Debug, PartialEq, Eq)]
pub struct Source {
    /// Where it lies.
    pub path: PathBuf,
    /// What it holds.
    pub text: String,
}

/// A stretch of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct At {
    /// The file.
    pub source: Arc<Source>,
    /// First byte.
    pub start: usize,
    /// Byte after the last.
    pub end: usize,
}

impl At {
    /// The file as a whole.
    pub fn whole(source: &Arc<Source>) -> Self {
        Self { source: source.clone(), start: 0, end: 0 }
    }

    /// Line and column of the beginning, both from 1, and the line itself.
    fn line(&self) -> (usize, usize, &str) {
        let text = &self.source.text;
        let start = (0..=self.start.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap_or(0);
        let before = &text[..start];
        let number = before.matches('\n').count() + 1;
        let begin = before.rfind('\n').map_or(0, |i| i + 1);
        let line = text[begin..].lines().next().unwrap_or("");
        (number, text[begin..start].chars().count() + 1, line)
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Severity {
    /// It cannot be used.
    #[default]
    Error,
    /// It can be used, and is hardly what was meant.
    Warning,
}

/// One fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// How bad it is.
    pub severity: Severity,
    /// The file, also where it could not be read.
    pub path: PathBuf,
    /// The place in it, where there is one.
    pub at: Option<At>,
    /// What is wrong, and what was expected.
    pub message: String,
    /// What to do, such as the nearest valid name.
    pub help: Option<String>,
}

impl Fault {
    /// A fault at a place.
    pub fn at(at: &At, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, path: at.source.path.clone(), at: Some(at.clone()), message: message.into(), help: None }
    }

    /// What is hardly meant, at a place.
    pub fn warning(at: &At, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::at(at, message) }
    }

    /// A fault of a file that could not be read.
    pub fn file(path: &Path, message: impl Into<String>) -> Self {
        Self { severity: Severity::Error, path: path.to_owned(), at: None, message: message.into(), help: None }
    }

    /// It cannot be used.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }

    /// Adds what to do.
    #[must_use]
    pub fn help(mut self, help: Option<String>) -> Self {
        self.help = help.or(self.help);
        self
    }

    /// Line, from 1; `None` where the file could not be read.
    pub fn line(&self) -> Option<usize> {
        self.at.as_ref().map(|a| a.line().0)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.at.as_ref().map(|at| at.line()).map_or_else(String::new, |(line, column, _)| format!(":{line}:{column}"));
        let severity = if self.is_error() { "" } else { "warning: " };
        write!(f, "{}{place}: {severity}{}", self.path.display(), self.message)
    }
}

impl Fault {
    /// In full: place, message, the offending excerpt with a caret, help.
    pub fn text(&self) -> String {
        let mut out = self.to_string();
        if let Some(at) = &self.at {
            let (number, column, line) = at.line();
            let width = number.to_string().len().max(3);
            // Never longer than the rest of the line: a table's span covers many.
            let room = line.chars().count().saturating_sub(column - 1).max(1);
            let span = at.source.text.get(at.start..at.end).map_or(1, |s| s.lines().next().unwrap_or("").chars().count());
            let (line, before) = around(line, column - 1);
            let caret = "^".repeat(span.clamp(1, room).min(EXCERPT.saturating_sub(before).max(1)));
            out += &format!("\n{number:>width$} | {line}\n{:>width$} | {:>before$}{caret}", "", "");
        }
        if let Some(help) = &self.help {
            out += &format!("\n    = help: {help}");
        }
        out
    }
}

/// At most [`EXCERPT`] characters of a line, among them that at `column` from 0; and how many of them stand before it.
fn around(line: &str, column: usize) -> (String, usize) {
    let characters = line.chars().count();
    if characters <= EXCERPT {
        return (line.to_owned(), column);
    }
    let first = column.saturating_sub(EXCERPT / 3).min(characters - EXCERPT);
    let cut = |at: usize, c: char| if (at == 0 && first > 0) || (at + 1 == EXCERPT && first + EXCERPT < characters) { '…' } else { c };
    (line.chars().skip(first).take(EXCERPT).enumerate().map(|(at, c)| cut(at, c)).collect(), column - first)
}

impl std::error::Error for Fault {}

impl Diagnostic for Fault {
    fn severity(&self) -> Option<miette::Severity> {
        Some(if self.is_error() { miette::Severity::Error } else { miette::Severity::Warning })
    }
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.at.as_ref().map(|at| &*at.source as &dyn SourceCode)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let at = self.at.as_ref()?;
        let label = LabeledSpan::new(Some("here".to_owned()), at.start, at.end.saturating_sub(at.start));
        Some(Box::new(std::iter::once(label)))
    }
}

impl SourceCode for Source {
    fn read_span<'a>(&'a self, span: &SourceSpan, before: usize, after: usize) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let part = self.text.read_span(span, before, after)?;
        let name = self.path.display().to_string();
        let (data, at, line, column, lines) = (part.data(), *part.span(), part.line(), part.column(), part.line_count());
        Ok(Box::new(MietteSpanContents::new_named(name, data, at, line, column, lines)))
    }
}

/// Everything that was found, of which at least one thing is an error.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error, Diagnostic)]
#[error("{} in the assets", counted(faults))]
pub struct AssetErrors {
    /// In the order in which they were found.
    #[related]
    pub faults: Vec<Fault>,
}

impl AssetErrors {
    /// Only one.
    pub fn one(fault: Fault) -> Self {
        Self { faults: vec![fault] }
    }

    /// `value` when nothing is wrong.
    pub fn or<T>(self, value: T) -> Result<T, Self> {
        if self.faults.iter().any(Fault::is_error) { Err(self) } else { Ok(value) }
    }

    /// Takes over the faults of a failed step and goes on without its value.
    pub fn keep<T>(&mut self, step: Result<T, Self>) -> Option<T> {
        step.map_err(|e| self.faults.extend(e.faults)).ok()
    }

    /// One line for each, without excerpts.
    pub fn lines(&self) -> String {
        let line = |f: &Fault| f.help.as_ref().map_or_else(|| f.to_string(), |help| format!("{f} ({help})"));
        self.faults.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// For a message on the screen: as many in full as it has room for, and how to see the others.
    pub fn on_screen(&self) -> String {
        let mut all: Vec<String> = self.faults.iter().take(ON_SCREEN).map(Fault::text).collect();
        if let Some(more) = self.faults.get(ON_SCREEN..).filter(|more| !more.is_empty()) {
            all.push(format!("and {} more: `syzygy check-assets` tells all", more.len()));
        }
        all.join("\n")
    }

    /// All of them in full, and their number.
    pub fn text(&self) -> String {
        let all: Vec<String> = self.faults.iter().map(Fault::text).collect();
        format!("{}\n\n{self}", all.join("\n\n"))
    }
}

/// How many of which kind, in words.
pub fn counted(faults: &[Fault]) -> String {
    let errors = faults.iter().filter(|f| f.is_error()).count();
    let words = |n: usize, one: &str, many: &str| if n == 1 { one.to_owned() } else { format!("{n} {many}") };
    match (errors, faults.len() - errors) {
        (errors, 0) => words(errors, "a fault", "faults"),
        (0, warnings) => words(warnings, "a warning", "warnings"),
        (errors, warnings) => format!("{} and {}", words(errors, "a fault", "faults"), words(warnings, "a warning", "warnings")),
    }
}

/// The name nearest to `wrong`, when it is near enough to have been meant.
pub fn did_you_mean<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let best = known.into_iter().map(|k| (strsim::damerau_levenshtein(wrong, k), k)).min();
    best.filter(|(distance, _)| *distance <= 2.max(wrong.chars().count() / 3)).map(|(_, name)| name)
}

/// [`did_you_mean`] as help; else all that is known, where there is anything.
pub fn nearest<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let known: Vec<&str> = known.into_iter().collect();
    match did_you_mean(written, known.iter().copied()) {
        Some(name) => Some(format!("did you mean `{name}`?")),
        None if known.is_empty() => None,
        None => Some(format!("known here: {}", known.join(", "))),
    }
}
