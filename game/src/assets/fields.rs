//! Fields: a file's keys as one table of data. The reader checks by it, the JSON Schema is written from it and the editor in the game
//! makes its sliders of it, so that what a field may be is said once.
//!
//! Not here: what the fields are ([`super::atmosphere`]), nor what they come to.

use super::reader::Reader;
use super::tree::{Data, Node};

/// A key of a table.
#[derive(Debug)]
pub struct Field {
    /// The key; it ends in its unit.
    pub key: &'static str,
    /// It must be there.
    pub must: bool,
    /// What it may be.
    pub kind: Kind,
    /// What it means, in one line.
    pub doc: &'static str,
}

/// What a value may be.
#[derive(Debug)]
pub enum Kind {
    /// A number.
    Number(Span),
    /// A whole number.
    Whole(Span),
    /// Three numbers: red, green, blue.
    Rgb(Span),
    /// One number for all three channels, or three.
    OneOrRgb(Span),
    /// Numbers, two or more.
    Numbers(Span),
    /// true or false.
    Flag,
    /// Words.
    Text,
    /// The name of a file beside this one.
    File,
    /// One of a few words; each with its meaning.
    Choice(&'static [(&'static str, &'static str)]),
    /// A table.
    Table(&'static [Field]),
    /// A table whose `kind` says which further keys it has.
    Variants(&'static [Variant]),
    /// A list of tables.
    Tables(&'static [Field]),
    /// A table from any of these names to a number.
    Shares(&'static [&'static str]),
}

/// One `kind` of a table.
#[derive(Debug)]
pub struct Variant {
    /// The word.
    pub word: &'static str,
    /// Its keys beside `kind`.
    pub fields: &'static [Field],
    /// What it means, in one line.
    pub doc: &'static str,
}

/// Ways to fill a table: one of several sets of keys has to be there, and none of the keys that belong to the other ways alone.
#[derive(Debug)]
pub struct Ways {
    /// The keys by which one way is told from another.
    pub apart: &'static [&'static str],
    /// What each way needs.
    pub each: &'static [&'static [&'static str]],
}

/// A range of numbers, and how a slider runs through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Least.
    pub min: f64,
    /// Greatest.
    pub max: f64,
    /// A slider runs by factors, not by differences.
    pub log: bool,
}

impl Span {
    /// A slider of equal differences.
    pub const fn linear(min: f64, max: f64) -> Self {
        Self { min, max, log: false }
    }

    /// A slider of equal factors.
    pub const fn log(min: f64, max: f64) -> Self {
        Self { min, max, log: true }
    }
}

/// A key that must be there.
pub const fn must(key: &'static str, kind: Kind, doc: &'static str) -> Field {
    Field { key, must: true, kind, doc }
}

/// A key that may be left out.
pub const fn may(key: &'static str, kind: Kind, doc: &'static str) -> Field {
    Field { key, must: false, kind, doc }
}

/// The field of a key.
pub fn find<'a>(fields: &'a [Field], key: &str) -> Option<&'a Field> {
    fields.iter().find(|f| f.key == key)
}

/// Asks for keys that these fields leave to the reader to demand; what is missing is written down with what it should be.
pub fn demand(r: &Reader<'_>, fields: &'static [Field], keys: &[&'static str]) {
    keys.iter().filter(|key| !r.has(key)).filter_map(|key| find(fields, key)).for_each(|field| value(r, field));
}

/// Checks a table against its fields; everything that is wrong is written down.
pub fn check(r: Reader<'_>, fields: &'static [Field]) {
    for field in fields {
        read(&r, field);
    }
    r.finish();
}

fn read(r: &Reader<'_>, field: &'static Field) {
    if r.has(field.key) || field.must {
        value(r, field);
    }
}

/// A value that is there, or must be.
fn value(r: &Reader<'_>, field: &'static Field) {
    let key = field.key;
    match &field.kind {
        Kind::Number(span) => drop(r.number(key, span.min..=span.max)),
        Kind::Whole(span) => drop(r.whole_in(key, span.min..=span.max)),
        Kind::Rgb(span) => drop(r.numbers::<3>(key, span.min..=span.max)),
        Kind::OneOrRgb(span) => match r.node.get(key).map(|e| &e.value.data) {
            Some(Data::Array(_)) => drop(r.numbers::<3>(key, span.min..=span.max)),
            _ => drop(r.number(key, span.min..=span.max)),
        },
        Kind::Numbers(span) => drop(r.series(key, span.min..=span.max)),
        Kind::Flag => drop(r.flag(key)),
        Kind::Text | Kind::File => drop(r.text(key)),
        Kind::Choice(words) => drop(r.choice(key, &words.iter().map(|w| w.0).collect::<Vec<_>>())),
        Kind::Table(fields) => {
            if let Some(inside) = r.table(key) {
                check(inside, fields);
            }
        }
        Kind::Variants(variants) => {
            let Some(inside) = r.table(key) else { return };
            let word = inside.choice("kind", &variants.iter().map(|v| v.word).collect::<Vec<_>>());
            let known = inside.node.get("kind").and_then(|e| e.value.text()) == Some(word);
            match variants.iter().find(|v| v.word == word) {
                // Of an unknown kind no key is known either.
                Some(variant) if known => check(inside, variant.fields),
                _ => {}
            }
        }
        Kind::Tables(fields) => {
            r.needed(key, &format!("a list of tables [[{key}]], or `{key} = []` for none"));
            r.tables(key).into_iter().for_each(|inside| check(inside, fields));
        }
        Kind::Shares(names) => {
            let Some(inside) = r.table(key) else { return };
            for name in *names {
                inside.maybe_number(name, 0.0..=1e9);
            }
            inside.finish();
        }
    }
}

impl Node {
    /// The value as JSON, for serde; numbers are f64.
    pub fn json(&self) -> serde_json::Value {
        use serde_json::Value;
        match &self.data {
            Data::Text(s) => Value::String(s.clone()),
            // What has no fraction is whole: serde takes 64.0 for no u32.
            #[allow(clippy::cast_possible_truncation)]
            Data::Number(x) if x.fract() == 0.0 && x.abs() < 1e15 => Value::from(*x as i64),
            Data::Number(x) => Value::from(*x),
            Data::Bool(b) => Value::Bool(*b),
            Data::Date => Value::Null,
            Data::Array(list) => Value::Array(list.iter().map(Self::json).collect()),
            Data::Table(entries) => Value::Object(entries.iter().map(|e| (e.key.clone(), e.value.json())).collect()),
        }
    }
}
