//! Writing values into a TOML file that people wrote: comments, order and layout of what does not change stay as they are. And the patch
//! that makes one tree of another.
//!
//! Values are JSON here, as [`super::tree::Node::json`] gives them. Not here: which file ([`super::draft`]).

use serde_json::{Map, Value};
use toml_edit::{Array, ArrayOfTables, DocumentMut, InlineTable, Item, Table, TableLike};

/// What a patch file has to hold so that `base` becomes `now`; the rules of patches are at the head of [`super::tree`]. `None` where they
/// are the same.
pub fn patch(base: &Value, now: &Value) -> Option<Value> {
    match (base, now) {
        (Value::Object(old), Value::Object(new)) => tables(old, new),
        (Value::Array(old), Value::Array(new)) => lists(old, new, now),
        _ => (!same(base, now)).then(|| now.clone()),
    }
}

/// Whether two values mean the same: 3 and 3.0 do.
pub fn same(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Number(a), Value::Number(b)) => a.as_f64() == b.as_f64(),
        (Value::Array(a), Value::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b)),
        (Value::Object(a), Value::Object(b)) => a.len() == b.len() && a.iter().all(|(key, a)| b.get(key).is_some_and(|b| same(a, b))),
        _ => a == b,
    }
}

fn tables(old: &Map<String, Value>, new: &Map<String, Value>) -> Option<Value> {
    // A table whose kind changes is replaced as a whole.
    if old.get("kind").is_some_and(|kind| new.get("kind").is_some_and(|k| k != kind)) {
        return Some(Value::Object(new.clone()));
    }
    let mut out = Map::new();
    let gone: Vec<Value> = old.keys().filter(|key| !new.contains_key(*key)).map(|key| key.as_str().into()).collect();
    if !gone.is_empty() {
        out.insert("remove".to_owned(), Value::Array(gone));
    }
    for (key, value) in new {
        let change = old.get(key).map_or_else(|| Some(value.clone()), |old| patch(old, value));
        if let Some(change) = change {
            out.insert(key.clone(), change);
        }
    }
    (!out.is_empty()).then_some(Value::Object(out))
}

fn lists(old: &[Value], new: &[Value], whole: &Value) -> Option<Value> {
    if old.len() == new.len() && old.iter().zip(new).all(|(a, b)| same(a, b)) {
        return None;
    }
    let (Some(before), Some(after)) = (names(old), names(new)) else { return Some(whole.clone()) };
    let mut out = Map::new();
    let gone: Vec<Value> = before.iter().filter(|n| !after.contains(n)).map(|n| (*n).into()).collect();
    if !gone.is_empty() {
        out.insert("remove".to_owned(), Value::Array(gone));
    }
    let mut added = Vec::new();
    for (name, item) in after.iter().zip(new) {
        match before.iter().position(|n| n == name).and_then(|i| old.get(i)) {
            Some(base) => {
                if let Some(change) = patch(base, item) {
                    out.insert((*name).to_owned(), change);
                }
            }
            None => added.push(item.clone()),
        }
    }
    // What is added stands last: another order can only be had by writing the list anew.
    let kept = before.iter().filter(|n| after.contains(n));
    let in_order =
        kept.eq(after.iter().filter(|n| before.contains(n))) && after.iter().skip(after.len() - added.len()).all(|n| !before.contains(n));
    if !in_order {
        return Some(whole.clone());
    }
    if !added.is_empty() {
        out.insert("add".to_owned(), Value::Array(added));
    }
    Some(Value::Object(out))
}

/// The names of a list's items, where every item is a table with a name of its own.
fn names(list: &[Value]) -> Option<Vec<&str>> {
    let names: Vec<&str> = list.iter().map(|item| item.get("name").and_then(Value::as_str)).collect::<Option<_>>()?;
    let own = names.iter().enumerate().all(|(i, n)| !names[..i].contains(n));
    own.then_some(names)
}

/// The text of a file with these values in place of its own; keys that the values do not have are taken out.
///
/// # Errors
/// The text is not TOML.
pub fn into_text(text: &str, values: &Map<String, Value>) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|e: toml_edit::TomlError| e.to_string())?;
    // Comments of a file that holds nothing else are nobody's: they stay at its head.
    let head = if document.as_table().is_empty() { text } else { "" };
    if !head.is_empty() {
        document = DocumentMut::new();
    }
    table(document.as_table_mut(), values);
    let written = document.to_string();
    Ok(if text.is_empty() || !head.is_empty() { format!("{head}{}", written.trim_start_matches('\n')) } else { written })
}

fn table(into: &mut dyn TableLike, values: &Map<String, Value>) {
    let gone: Vec<String> = into.iter().map(|(key, _)| key.to_owned()).filter(|key| !values.contains_key(key)).collect();
    for key in gone {
        into.remove(&key);
    }
    for (key, value) in values {
        match into.get_mut(key) {
            Some(item) => change(item, value),
            None => drop(into.insert(key, new_item(value))),
        }
    }
}

fn change(item: &mut Item, value: &Value) {
    match value {
        Value::Object(values) => match item.as_table_like_mut() {
            Some(inside) => table(inside, values),
            None => *item = new_item(value),
        },
        Value::Array(list) if item.is_array_of_tables() => {
            let Item::ArrayOfTables(tables) = item else { return };
            list_of_tables(tables, list);
        }
        _ => {
            let old = item.as_value();
            if old.is_some_and(|old| json(old).is_some_and(|old| same(&old, value))) {
                return;
            }
            let decor = old.map(|v| v.decor().clone());
            *item = new_item(value);
            if let (Some(new), Some(decor)) = (item.as_value_mut(), decor) {
                *new.decor_mut() = decor;
            }
        }
    }
}

/// Items keep their comments by name, or by place where they have none.
fn list_of_tables(tables: &mut ArrayOfTables, list: &[Value]) {
    let old: Vec<Table> = tables.iter().cloned().collect();
    let name = |t: &Table| t.get("name").and_then(Item::as_str).map(str::to_owned);
    let mut place = old.iter().filter_map(Table::position).min();
    tables.clear();
    for (i, item) in list.iter().enumerate() {
        let Some(values) = item.as_object() else { continue };
        let wanted = item.get("name").and_then(Value::as_str);
        let kept = match wanted {
            Some(wanted) => old.iter().find(|t| name(t).as_deref() == Some(wanted)),
            None => old.get(i).filter(|t| name(t).is_none()),
        };
        let mut kept = kept.cloned().unwrap_or_default();
        table(&mut kept, values);
        // In the file they stand in the order of the list: where the first one stood, one behind the other.
        forget_places(&mut kept);
        kept.set_position(place.take());
        tables.push(kept);
    }
}

/// Lets a table and those in it stand behind what is before them in the tree.
fn forget_places(table: &mut Table) {
    table.set_position(None);
    for (_, item) in table.iter_mut() {
        match item {
            Item::Table(inside) => forget_places(inside),
            Item::ArrayOfTables(list) => list.iter_mut().for_each(forget_places),
            _ => {}
        }
    }
}

fn new_item(value: &Value) -> Item {
    match value {
        Value::Object(values) if !is_small(values) => {
            let mut new = Table::new();
            // `[layers.dust]` needs no line `[layers]` above it.
            new.set_implicit(values.values().all(|v| v.is_object() || is_tables(v)) && !values.is_empty());
            for (key, value) in values {
                new.insert(key, new_item(value));
            }
            Item::Table(new)
        }
        Value::Array(list) if is_tables(value) => {
            let mut tables = ArrayOfTables::new();
            for values in list.iter().filter_map(Value::as_object) {
                let mut new = Table::new();
                for (key, value) in values {
                    new.insert(key, new_item(value));
                }
                tables.push(new);
            }
            Item::ArrayOfTables(tables)
        }
        _ => new_value(value).map_or(Item::None, Item::Value),
    }
}

/// A table of few plain values stands on one line: profiles and phase functions.
fn is_small(values: &Map<String, Value>) -> bool {
    values.contains_key("kind") && !values.contains_key("drag_top_m")
}

fn is_tables(value: &Value) -> bool {
    value.as_array().is_some_and(|list| !list.is_empty() && list.iter().all(Value::is_object))
}

fn new_value(value: &Value) -> Option<toml_edit::Value> {
    Some(match value {
        Value::Null => return None,
        Value::Bool(b) => (*b).into(),
        Value::String(s) => s.as_str().into(),
        Value::Number(x) => match x.as_i64() {
            Some(whole) => whole.into(),
            None => float(x.as_f64()?),
        },
        Value::Array(list) => toml_edit::Value::Array(list.iter().filter_map(new_value).collect::<Array>()),
        Value::Object(values) => {
            let mut new = InlineTable::new();
            for (key, value) in values {
                if let Some(value) = new_value(value) {
                    new.insert(key, value);
                }
            }
            toml_edit::Value::InlineTable(new)
        }
    })
}

/// A number as people write it: 5.8e-6, not 0.0000058.
fn float(x: f64) -> toml_edit::Value {
    let text = if x != 0.0 && !(1e-3..1e6).contains(&x.abs()) { format!("{x:e}") } else { format!("{x:?}") };
    text.parse().unwrap_or_else(|_| x.into())
}

fn json(value: &toml_edit::Value) -> Option<Value> {
    Some(match value {
        toml_edit::Value::String(s) => Value::String(s.value().clone()),
        toml_edit::Value::Integer(i) => Value::from(*i.value()),
        toml_edit::Value::Float(x) => Value::from(*x.value()),
        toml_edit::Value::Boolean(b) => Value::Bool(*b.value()),
        toml_edit::Value::Datetime(_) => return None,
        toml_edit::Value::Array(list) => Value::Array(list.iter().map(json).collect::<Option<_>>()?),
        toml_edit::Value::InlineTable(t) => Value::Object(t.iter().map(|(k, v)| Some((k.to_owned(), json(v)?))).collect::<Option<_>>()?),
    })
}

#[cfg(test)]
mod tests;
