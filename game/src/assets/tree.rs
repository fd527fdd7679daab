//! The tree of a TOML file in which every key and value knows its place, also after patches from other files were laid over it.
//!
//! A patch holds only what it changes. Tables merge key by key, but for one whose `kind` changes: the keys of the old kind go with it.
//! A value or a list replaces what was there; `remove = ["scale_m"]` in a table takes keys out. A *table* laid over a *list* changes items
//! of the list: `[layers.dust]` patches the item whose `name` is `dust`, `remove = ["ozone"]` takes items out, `add = [...]` appends.
//!
//! Not here: what the keys mean ([`super::reader`]).

use super::fault::{At, Fault, Source, nearest};
use super::write::patch;
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

/// Takes keys out of a table.
fn take_out(table: &mut Vec<Entry>, keys: &[Node], faults: &mut Vec<Fault>) {
    for key in keys {
        let name = key.text().unwrap_or_default();
        match table.iter().position(|e| e.key == name) {
            Some(i) => drop(table.remove(i)),
            None => {
                let fault = Fault::at(&key.at, format!("`remove`: the table has no key `{name}`: expected the name of one"));
                faults.push(fault.help(nearest(name, table.iter().map(|e| e.key.as_str()))));
            }
        }
    }
}

/// Lays a table over a list: `add`, `remove`, and items by their names.
fn change(list: &mut Vec<Node>, changes: Vec<Entry>, faults: &mut Vec<Fault>) {
    let unknown = |list: &[Node], at: &At, name: &str| {
        let fault = Fault::at(at, format!("the list has no item named `{name}`: expected the name of one, or `add` or `remove`"));
        fault.help(nearest(name, list.iter().filter_map(Node::name)))
    };
    for Entry { key, key_at, value } in changes {
        match (key.as_str(), value.data) {
            ("add", Data::Array(new)) => list.extend(new),
            ("remove", Data::Array(names)) => {
                for name in &names {
                    let found = name.text().and_then(|n| list.iter().position(|item| item.name() == Some(n)));
                    match (found, name.text()) {
                        (Some(i), _) => drop(list.remove(i)),
                        (None, Some(text)) => faults.push(unknown(list, &name.at, text)),
                        (None, None) => faults.push(Fault::at(&name.at, "`remove`: expected names of items")),
                    }
                }
            }
            ("add", _) => faults.push(
                Fault::at(&value.at, "`add`: expected a list of tables")
                    .help(Some("each one begins with [[….add]], in double brackets".to_owned())),
            ),
            ("remove", _) => faults.push(Fault::at(&value.at, "`remove`: expected a list of names")),
            (name, data) => match list.iter_mut().find(|item| item.name() == Some(name)) {
                Some(item) if matches!(data, Data::Table(_)) => item.patch(Node { at: value.at, data }, faults),
                Some(_) => faults.push(Fault::at(&value.at, format!("`{name}`: expected a table with the keys to change"))),
                None => faults.push(unknown(list, &key_at, name)),
            },
        }
    }
}

/// A list laid over one that has an item of the same name: it stands for all of the other, where a change of that item was likely meant.
fn whole(old: &Node, new: &Entry) -> Option<Fault> {
    let (Data::Array(items), Data::Array(list)) = (&old.data, &new.value.data) else { return None };
    let known = |name: &str| items.iter().any(|item| item.name() == Some(name));
    let name = list.iter().filter_map(Node::name).find(|name| known(name)).filter(|_| items.len() > list.len())?;
    // Where no patch by names could say it, nothing else was meant.
    if !matches!(patch(&old.json(), &new.value.json()), Some(serde_json::Value::Object(_))) {
        return None;
    }
    let key = &new.key;
    let message = format!("this list takes the place of all {} of `{key}`, though `{name}` is one of them", items.len());
    let help = format!("in a patch [{key}.{name}] changes that one and [[{key}.add]] adds another");
    Some(Fault::warning(&new.key_at, message).help(Some(help)))
}

impl Node {
    /// Lays a patch over this tree (the rules are at the head); faults are what a list does not have.
    pub fn patch(&mut self, patch: Self, faults: &mut Vec<Fault>) {
        match (&mut self.data, patch.data) {
            (Data::Table(mine), Data::Table(theirs)) => {
                let kind = |list: &[Entry]| list.iter().find(|e| e.key == "kind").and_then(|e| e.value.text().map(str::to_owned));
                if kind(&theirs).is_some_and(|new| kind(mine).is_some_and(|old| old != new)) {
                    *mine = theirs;
                    self.at = patch.at;
                    return;
                }
                for entry in theirs {
                    if let ("remove", Data::Array(keys)) = (entry.key.as_str(), &entry.value.data) {
                        take_out(mine, keys, faults);
                        continue;
                    }
                    match mine.iter_mut().find(|e| e.key == entry.key) {
                        Some(old) if matches!((&old.value.data, &entry.value.data), (Data::Table(_) | Data::Array(_), Data::Table(_))) => {
                            old.value.patch(entry.value, faults);
                        }
                        Some(old) => {
                            faults.extend(whole(&old.value, &entry));
                            *old = entry;
                        }
                        None => mine.push(entry),
                    }
                }
            }
            (Data::Array(list), Data::Table(changes)) => change(list, changes, faults),
            (_, data) => *self = Self { at: patch.at, data },
        }
    }

    /// What a list's item is called: itself where it is a string, else its `name`.
    fn name(&self) -> Option<&str> {
        match &self.data {
            Data::Text(s) => Some(s),
            _ => self.get("name").and_then(|e| e.value.text()),
        }
    }

    /// The string, where this is one.
    pub fn text(&self) -> Option<&str> {
        if let Data::Text(s) = &self.data { Some(s) } else { None }
    }

    /// Feeds the values to a hash: comments, the order of keys and the way in which a number is written make no difference.
    pub fn digest(&self, hash: &mut blake3::Hasher) {
        let text = |hash: &mut blake3::Hasher, kind: &[u8], s: &str| {
            hash.update(kind).update(&(s.len() as u64).to_le_bytes()).update(s.as_bytes());
        };
        let put = |hash: &mut blake3::Hasher, bytes: &[u8]| {
            hash.update(bytes);
        };
        match &self.data {
            Data::Text(s) => text(hash, b"s", s),
            // −0 is 0.
            Data::Number(x) => text(hash, b"n", &format!("{:016x}", (x + 0.0).to_bits())),
            Data::Bool(b) => put(hash, if *b { b"y" } else { b"f" }),
            Data::Date => put(hash, b"d"),
            Data::Array(list) => {
                hash.update(b"a").update(&(list.len() as u64).to_le_bytes());
                list.iter().for_each(|item| item.digest(hash));
            }
            Data::Table(entries) => {
                hash.update(b"t").update(&(entries.len() as u64).to_le_bytes());
                let mut entries: Vec<&Entry> = entries.iter().collect();
                entries.sort_by(|a, b| a.key.cmp(&b.key));
                for entry in entries {
                    text(hash, b"k", &entry.key);
                    entry.value.digest(hash);
                }
            }
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
