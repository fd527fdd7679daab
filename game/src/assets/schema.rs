//! JSON Schemas for editors of TOML: written from the same [`fields`](super::fields) by which files are read. `syzygy check-assets --schema
//! atmosphere` prints one; the shipped copies are `assets/*.schema.json`, kept true by a test.

use super::fields::{Field, Kind, Span};
use serde_json::{Map, Value, json};

/// Which edition of JSON Schema.
const DRAFT: &str = "http://json-schema.org/draft-07/schema#";

/// The schema of a whole file of these fields.
pub fn of_file(title: &str, fields: &[Field]) -> Value {
    let mut schema = table(fields, false);
    named(&mut schema, title);
    schema
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
