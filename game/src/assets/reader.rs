//! The reader: takes keys out of a table one by one, checks kind and range, and writes down everything that is wrong instead of
//! stopping at the first. What was never asked for is unknown. After a fault a placeholder (NaN, an empty string) goes on, which
//! nobody sees: a load with faults gives no result.

use super::fault::{At, Fault, did_you_mean, nearest};
use super::tree::{Data, Node};
use std::cell::RefCell;
use std::ops::RangeInclusive;

/// Where faults are gathered.
pub type Faults = RefCell<Vec<Fault>>;

/// Any finite number.
pub const ANY: RangeInclusive<f64> = f64::MIN..=f64::MAX;
/// More than zero.
pub const POSITIVE: RangeInclusive<f64> = f64::MIN_POSITIVE..=f64::MAX;

/// A table being read.
pub struct Reader<'a> {
    /// The table.
    pub node: &'a Node,
    /// Its name in messages: `air.column`; empty at the top.
    name: String,
    faults: &'a Faults,
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> Reader<'a> {
    /// Reads the top of a file.
    pub fn new(node: &'a Node, faults: &'a Faults) -> Self {
        Self { node, name: String::new(), faults, asked: RefCell::default() }
    }

    /// The same table, to be read once more.
    pub fn again(&self) -> Self {
        Self { node: self.node, name: self.name.clone(), faults: self.faults, asked: RefCell::default() }
    }

    /// Whether a key is there; it counts as asked for.
    pub fn has(&self, key: &'static str) -> bool {
        self.find(key).is_some()
    }

    /// Errors written down so far, of this file and others.
    pub fn errors(&self) -> usize {
        count_errors(self.faults)
    }

    /// Writes a fault down.
    pub fn fault(&self, fault: Fault) {
        self.faults.borrow_mut().push(fault);
    }

    /// Writes down a fault of a key, at its place.
    pub fn wrong(&self, path: &str, message: impl Into<String>) {
        self.fault(Fault::at(&self.node.place_of(path), message));
    }

    fn full(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    fn find(&self, key: &'static str) -> Option<&'a Node> {
        if !self.asked.borrow().contains(&key) {
            self.asked.borrow_mut().push(key);
        }
        self.node.get(key).map(|e| &e.value)
    }

    /// A value that must be there.
    pub fn needed(&self, key: &'static str, expected: &str) -> Option<&'a Node> {
        let found = self.find(key);
        if found.is_none() {
            let table = if self.name.is_empty() { "at the top of the file".to_owned() } else { format!("in [{}]", self.name) };
            self.fault(Fault::at(&self.node.at, format!("missing key `{key}` {table}: expected {expected}")));
        }
        found
    }

    fn mismatch(&self, key: &str, node: &Node, expected: &str) {
        let found = node.data.kind();
        self.fault(Fault::at(&node.at, format!("`{}`: expected {expected}, found {found}", self.full(key))));
    }

    fn checked(&self, key: &str, node: &Node, range: &RangeInclusive<f64>) -> f64 {
        let Data::Number(x) = node.data else {
            self.mismatch(key, node, &words(range));
            return f64::NAN;
        };
        if !x.is_finite() || !range.contains(&x) {
            let message = format!("`{}` = {x} is out of range: expected {}", self.full(key), words(range));
            self.fault(Fault::at(&node.at, message));
            return f64::NAN;
        }
        x
    }

    /// A number that must be there.
    pub fn number(&self, key: &'static str, range: RangeInclusive<f64>) -> f64 {
        self.needed(key, &words(&range)).map_or(f64::NAN, |n| self.checked(key, n, &range))
    }

    /// A number that may be left out.
    pub fn maybe_number(&self, key: &'static str, range: RangeInclusive<f64>) -> Option<f64> {
        self.find(key).map(|n| self.checked(key, n, &range))
    }

    /// A whole number that fits `u32`.
    pub fn whole(&self, key: &'static str) -> u32 {
        self.whole_in(key, 0.0..=f64::from(u32::MAX))
    }

    /// A whole number of a range within `u32`.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    pub fn whole_in(&self, key: &'static str, range: RangeInclusive<f64>) -> u32 {
        let x = self.number(key, range);
        if x.fract() != 0.0 && x.is_finite() {
            self.wrong(key, format!("`{}` = {x}: expected a whole number", self.full(key)));
        }
        x as u32
    }

    /// `N` numbers in a list.
    pub fn numbers<const N: usize>(&self, key: &'static str, range: RangeInclusive<f64>) -> [f64; N] {
        let expected = format!("a list of {N} numbers, each {}", words(&range));
        self.needed(key, &expected).map_or([f64::NAN; N], |n| self.list(key, n, &range, &expected))
    }

    fn list<const N: usize>(&self, key: &str, node: &Node, range: &RangeInclusive<f64>, expected: &str) -> [f64; N] {
        let mut out = [f64::NAN; N];
        match &node.data {
            Data::Array(list) if list.len() == N => {
                for (i, (slot, item)) in out.iter_mut().zip(list).enumerate() {
                    *slot = self.checked(&format!("{key}[{i}]"), item, range);
                }
            }
            Data::Array(list) => {
                let message = format!("`{}`: expected {expected}, found {} of them", self.full(key), list.len());
                self.fault(Fault::at(&node.at, message));
            }
            _ => self.mismatch(key, node, expected),
        }
        out
    }

    /// Two numbers or more in a list.
    pub fn series(&self, key: &'static str, range: RangeInclusive<f64>) -> Vec<f64> {
        let expected = format!("a list of two or more numbers, each {}", words(&range));
        match self.needed(key, &expected) {
            Some(Node { data: Data::Array(list), .. }) if list.len() > 1 => {
                list.iter().enumerate().map(|(i, item)| self.checked(&format!("{key}[{i}]"), item, &range)).collect()
            }
            Some(node) => {
                self.mismatch(key, node, &expected);
                Vec::new()
            }
            None => Vec::new(),
        }
    }

    /// A list of lists of `N` numbers; empty where the key is left out.
    pub fn rows<const N: usize>(&self, key: &'static str) -> Vec<[f64; N]> {
        let expected = format!("a list of lists of {N} numbers");
        match self.find(key) {
            None => Vec::new(),
            Some(Node { data: Data::Array(list), .. }) => list.iter().map(|row| self.list(key, row, &ANY, &expected)).collect(),
            Some(node) => {
                self.mismatch(key, node, &expected);
                Vec::new()
            }
        }
    }

    /// A string that must be there and not be empty.
    pub fn text(&self, key: &'static str) -> String {
        let Some(node) = self.needed(key, "a string") else { return String::new() };
        self.string(key, node)
    }

    /// A string that may be left out.
    pub fn maybe_text(&self, key: &'static str) -> Option<String> {
        self.find(key).map(|node| self.string(key, node))
    }

    /// A list of strings, at least one, each with its place.
    pub fn texts(&self, key: &'static str) -> Vec<(String, At)> {
        let expected = "a list of strings, at least one";
        match self.needed(key, expected) {
            Some(Node { data: Data::Array(list), .. }) if !list.is_empty() => {
                list.iter().enumerate().map(|(i, item)| (self.string(&format!("{key}[{i}]"), item), item.at.clone())).collect()
            }
            Some(node) => {
                self.mismatch(key, node, expected);
                Vec::new()
            }
            None => Vec::new(),
        }
    }

    fn string(&self, key: &str, node: &Node) -> String {
        match &node.data {
            Data::Text(s) if !s.trim().is_empty() => s.clone(),
            Data::Text(_) => {
                self.fault(Fault::at(&node.at, format!("`{}`: expected a string that is not empty", self.full(key))));
                String::new()
            }
            _ => {
                self.mismatch(key, node, "a string");
                String::new()
            }
        }
    }

    /// One of a few words; on a fault the first.
    pub fn choice(&self, key: &'static str, words: &[&'static str]) -> &'static str {
        let expected = format!("one of {}", words.iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(", "));
        let fallback = words.first().copied().unwrap_or("");
        let Some(node) = self.needed(key, &expected) else { return fallback };
        let Data::Text(s) = &node.data else {
            self.mismatch(key, node, &expected);
            return fallback;
        };
        words.iter().find(|w| *w == s).copied().unwrap_or_else(|| {
            let message = format!("`{}` = \"{s}\": expected {expected}", self.full(key));
            self.fault(Fault::at(&node.at, message).help(nearest(s, words.iter().copied())));
            fallback
        })
    }

    /// true or false, which must be there.
    pub fn flag(&self, key: &'static str) -> bool {
        let Some(node) = self.needed(key, "true or false") else { return false };
        let Data::Bool(b) = node.data else {
            self.mismatch(key, node, "true or false");
            return false;
        };
        b
    }

    /// A table that may be left out.
    pub fn maybe_table(&self, key: &'static str) -> Option<Reader<'a>> {
        let node = self.find(key)?;
        if !matches!(node.data, Data::Table(_)) {
            self.mismatch(key, node, "a table");
            return None;
        }
        Some(self.inside(node, key.to_owned()))
    }

    /// A table that must be there.
    pub fn table(&self, key: &'static str) -> Option<Reader<'a>> {
        let name = self.full(key);
        self.needed(key, &format!("a table [{name}]"))?;
        self.maybe_table(key)
    }

    /// A list of tables; empty where it is left out.
    pub fn tables(&self, key: &'static str) -> Vec<Reader<'a>> {
        match self.find(key) {
            None => Vec::new(),
            Some(Node { data: Data::Array(list), .. }) => {
                let mut out = Vec::new();
                for (i, item) in list.iter().enumerate() {
                    if matches!(item.data, Data::Table(_)) {
                        out.push(self.inside(item, format!("{key}[{i}]")));
                    } else {
                        self.mismatch(&format!("{key}[{i}]"), item, "a table");
                    }
                }
                out
            }
            Some(node) => {
                let found = node.data.kind();
                let fault = Fault::at(&node.at, format!("`{}`: expected a list of tables, found {found}", self.full(key)));
                let help = matches!(node.data, Data::Table(_)).then(|| {
                    format!("each one begins with [[{0}]]; [{0}.NAME] changes one of that name, in a file *.patch.toml", self.full(key))
                });
                self.fault(fault.help(help));
                Vec::new()
            }
        }
    }

    fn inside(&self, node: &'a Node, key: String) -> Reader<'a> {
        Reader { node, name: self.full(&key), faults: self.faults, asked: RefCell::default() }
    }

    /// Ends the reading: a key that nobody asked for is unknown.
    pub fn finish(self) {
        let Data::Table(entries) = &self.node.data else { return };
        let asked = self.asked.borrow();
        for entry in entries.iter().filter(|e| !asked.contains(&e.key.as_str())) {
            let place = if self.name.is_empty() { String::new() } else { format!(" in [{}]", self.name) };
            let fault = Fault::at(&entry.key_at, format!("unknown key `{}`{place}: expected a key of the schema", entry.key));
            let free = asked.iter().copied().filter(|k| self.node.get(k).is_none());
            let near = did_you_mean(&entry.key, free).map(|name| format!("did you mean `{name}`?"));
            let help = near.or_else(|| nearest(&entry.key, asked.iter().copied()));
            self.fault(fault.help(help));
        }
    }
}

/// Errors among what was written down.
pub fn count_errors(faults: &Faults) -> usize {
    faults.borrow().iter().filter(|f| f.is_error()).count()
}

fn words(range: &RangeInclusive<f64>) -> String {
    match (*range.start(), *range.end()) {
        (f64::MIN, f64::MAX) => "a finite number".to_owned(),
        (low, f64::MAX) if low == f64::MIN_POSITIVE => "a finite number above 0".to_owned(),
        (low, f64::MAX) => format!("a finite number from {low}"),
        (low, high) => format!("a number from {low} to {high}"),
    }
}
