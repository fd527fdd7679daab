//! The tree of a TOML file in which every key and value knows its place, also after patches from other files were laid over it.
//!
//! Not here: what the keys mean ([`super::reader`]).

use super::fault::{At, Fault, Source};
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// Where it is written.
    pub at: At,
    /// What it is.
    pub data: Data,
}

/// What a value is.
#[derive(Clone, Debug)]
pub enum Data {
    /// A string.
    Text(String),
    /// A number; TOML's integers and floats are one here.
    Number(f64),
    /// true or false.
    Bool(bool),
    /// A list.
    Array(Vec<Node>),
    /// A table, in the order of the file.
    Table(Vec<Entry>),
    /// A date, which no asset uses.
    Date,
}

/// A key of a table.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Where the key is written.
    pub key_at: At,
    /// Its value.
    pub value: Node,
}

impl Data {
    /// In words, for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "a string",
            Self::Number(_) => "a number",
            Self::Bool(_) => "true or false",
            Self::Array(_) => "a list",
            Self::Table(_) => "a table",
            Self::Date => "a date",
        }
    }
}

/// Parses a file; every syntax error that the parser can tell apart is a fault.
pub fn parse(source: &Arc<Source>) -> Result<Node, Vec<Fault>> {
    let (table, errors) = DeTable::parse_recoverable(&source.text);
    if errors.is_empty() {
        let at = At::whole(source);
        return Ok(Node { at, data: convert_table(source, table.get_ref()) });
    }
    Err(errors
        .iter()
        .map(|e| {
            let span = e.span().unwrap_or(0..0);
            Fault::at(
                &At { source: source.clone(), start: span.start, end: span.end },
                format!("not TOML: {}; expected `key = value` and [table] lines, each key once", e.message()),
            )
        })
        .collect())
}

fn convert(source: &Arc<Source>, value: &Spanned<DeValue<'_>>) -> Node {
    let span = value.span();
    let number = |text: &str| text.replace('_', "").parse().unwrap_or(f64::NAN);
    let data = match value.get_ref() {
        DeValue::String(s) => Data::Text(s.to_string()),
        DeValue::Integer(i) if i.radix() == 10 => Data::Number(number(i.as_str())),
        DeValue::Integer(i) => {
            // Hexadecimal and the like: 2⁵³ is as far as a number here can be exact.
            let digits = i.as_str().replace('_', "");
            Data::Number(i64::from_str_radix(&digits, i.radix()).map_or(f64::NAN, |n| n as f64))
        }
        DeValue::Float(x) => Data::Number(number(x.as_str())),
        DeValue::Boolean(b) => Data::Bool(*b),
        DeValue::Datetime(_) => Data::Date,
        DeValue::Array(list) => Data::Array(list.iter().map(|v| convert(source, v)).collect()),
        DeValue::Table(table) => convert_table(source, table),
    };
    Node { at: At { source: source.clone(), start: span.start, end: span.end }, data }
}

fn convert_table(source: &Arc<Source>, table: &DeTable<'_>) -> Data {
    let mut entries: Vec<Entry> = table
        .iter()
        .map(|(key, value)| {
            let span = key.span();
            let key_at = At { source: source.clone(), start: span.start, end: span.end };
            Entry { key: key.get_ref().to_string(), key_at, value: convert(source, value) }
        })
        .collect();
    entries.sort_by_key(|e| e.key_at.start);
    Data::Table(entries)
}

impl Node {
    /// Lays a patch over this tree: tables merge key by key, everything else is replaced.
    pub fn patch(&mut self, patch: Self) {
        match (&mut self.data, patch.data) {
            (Data::Table(mine), Data::Table(theirs)) => {
                for entry in theirs {
                    match mine.iter_mut().find(|e| e.key == entry.key) {
                        Some(old) if matches!((&old.value.data, &entry.value.data), (Data::Table(_), Data::Table(_))) => {
                            old.value.patch(entry.value);
                        }
                        Some(old) => *old = entry,
                        None => mine.push(entry),
                    }
                }
            }
            (_, data) => *self = Self { at: patch.at, data },
        }
    }

    /// The entry of a key, where this is a table that has it.
    pub fn get(&self, key: &str) -> Option<&Entry> {
        let Data::Table(entries) = &self.data else { return None };
        entries.iter().find(|e| e.key == key)
    }

    /// The place of `a.b[2].c`, or of the last part of that way that exists.
    pub fn place_of(&self, path: &str) -> At {
        let mut node = self;
        let mut at = &self.at;
        for part in path.split(['.', '[', ']']).filter(|p| !p.is_empty()) {
            let next = match (&node.data, part.parse::<usize>()) {
                (Data::Array(list), Ok(i)) => list.get(i),
                _ => node.get(part).map(|e| {
                    at = &e.key_at;
                    &e.value
                }),
            };
            let Some(next) = next else { break };
            node = next;
            if !matches!(node.data, Data::Table(_)) {
                at = &node.at;
            }
        }
        at.clone()
    }
}
