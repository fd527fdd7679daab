//! JSON Schemas for editors of TOML: written from the same [`fields`](super::fields) by which files are read. `syzygy check-assets --schema
//! atmosphere` prints one; the shipped copies are `assets/*.schema.json`, kept true by a test.

use super::fields::{Field, Kind, Span, Ways};
use serde_json::{Map, Value, json};

/// Which edition of JSON Schema.
const DRAFT: &str = "http://json-schema.org/draft-07/schema#";

/// What fields alone do not say of a kind of file.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// The key whose word says which others are needed; the first word is that of a file without the key.
    pub chosen_by: &'static str,
    /// What each word needs.
    pub needed: &'static [(&'static str, &'static [&'static str])],
    /// Tables that can be filled in several ways, by their path.
    pub ways: &'static [(&'static str, Ways)],
}

/// The schema of a whole file of these fields.
pub fn of_file(title: &str, fields: &[Field], rules: Rules) -> Value {
    let mut schema = table(fields, false);
    named(&mut schema, title);
    for (path, ways) in rules.ways {
        let Some(inside) = path.split('.').try_fold(&mut schema, |at, key| inside(at, key)) else { continue };
        inside["oneOf"] = each_way(ways);
    }
    let key = rules.chosen_by;
    let first = rules.needed.first().map_or("", |n| n.0);
    let each = rules.needed.iter().map(|(word, needed)| {
        let mut chosen = json!({ "properties": { key: { "const": word } } });
        if *word != first {
            chosen["required"] = json!([key]);
        }
        json!({ "if": chosen, "then": { "required": needed } })
    });
    schema["allOf"] = each.collect();
    schema
}

/// The schema of a key's table, or of the tables in its list.
fn inside<'a>(schema: &'a mut Value, key: &str) -> Option<&'a mut Value> {
    let inside = schema.get_mut("properties")?.get_mut(key)?;
    if inside.get("items").is_some() { inside.get_mut("items") } else { Some(inside) }
}

fn each_way(ways: &Ways) -> Value {
    let way = |needed: &&[&str]| {
        let others: Map<String, Value> =
            ways.apart.iter().filter(|key| !needed.contains(*key)).map(|key| ((*key).to_owned(), false.into())).collect();
        json!({ "required": needed, "properties": others })
    };
    ways.each.iter().map(way).collect()
}

/// The schema of a patch of such a file: no key is needed, and lists may be changed by the names in them.
pub fn of_patch(title: &str, fields: &[Field]) -> Value {
    let mut schema = table(fields, true);
    named(&mut schema, title);
    schema
}

fn named(schema: &mut Value, title: &str) {
    schema["$schema"] = DRAFT.into();
    schema["title"] = title.into();
}

fn table(fields: &[Field], patch: bool) -> Value {
    let properties: Map<String, Value> = fields.iter().map(|f| (f.key.to_owned(), field(f, patch))).collect();
    let mut schema = json!({ "type": "object", "properties": properties, "additionalProperties": false });
    if patch {
        schema["properties"]["remove"] = json!({ "type": "array", "items": { "type": "string" }, "description": "keys to take out" });
    }
    let needed: Vec<&str> = fields.iter().filter(|f| f.must && !patch).map(|f| f.key).collect();
    if !needed.is_empty() {
        schema["required"] = json!(needed);
    }
    schema
}

fn number(span: &Span) -> Value {
    json!({ "type": "number", "minimum": span.min, "maximum": span.max })
}

fn triple(span: &Span) -> Value {
    json!({ "type": "array", "items": number(span), "minItems": 3, "maxItems": 3 })
}

fn field(field: &Field, patch: bool) -> Value {
    let mut schema = match &field.kind {
        Kind::Number(span) => number(span),
        Kind::Whole(span) => json!({ "type": "integer", "minimum": span.min, "maximum": span.max }),
        Kind::Rgb(span) => triple(span),
        Kind::OneOrRgb(span) => json!({ "anyOf": [number(span), triple(span)] }),
        Kind::Numbers(span) => json!({ "type": "array", "items": number(span), "minItems": 2 }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Text | Kind::File => json!({ "type": "string", "minLength": 1 }),
        Kind::Choice(words) => {
            let each: Vec<Value> = words.iter().map(|(word, doc)| json!({ "const": word, "description": doc })).collect();
            json!({ "oneOf": each })
        }
        Kind::Table(fields) => table(fields, patch),
        Kind::Variants(variants) => {
            let mut each: Vec<Value> = Vec::new();
            for variant in *variants {
                let mut one = table(variant.fields, patch);
                one["properties"]["kind"] = json!({ "const": variant.word });
                one["description"] = variant.doc.into();
                if !patch {
                    let mut needed = vec![json!("kind")];
                    needed.extend(variant.fields.iter().filter(|f| f.must).map(|f| json!(f.key)));
                    one["required"] = Value::Array(needed);
                }
                each.push(one);
            }
            json!({ if patch { "anyOf" } else { "oneOf" }: each })
        }
        Kind::Tables(fields) => {
            let whole = json!({ "type": "array", "items": table(fields, false) });
            if patch && fields.iter().any(|f| f.key == "name") {
                let names = json!({ "type": "array", "items": { "type": "string" } });
                let changes = json!({
                    "type": "object",
                    "properties": { "add": whole, "remove": names },
                    "additionalProperties": table(fields, true),
                });
                json!({ "anyOf": [whole, changes] })
            } else {
                whole
            }
        }
        Kind::Shares(names) => {
            let each: Map<String, Value> = names.iter().map(|n| ((*n).to_owned(), json!({ "type": "number", "minimum": 0 }))).collect();
            json!({ "type": "object", "properties": each, "additionalProperties": false, "minProperties": 1 })
        }
    };
    schema["description"] = field.doc.into();
    schema
}
