//! That a patch makes of one tree the other, whatever was changed, and that a file keeps what people wrote into it.

use super::*;
use crate::assets::fault::Source;
use crate::assets::tree::{Node, parse};
use proptest::option;
use proptest::prelude::*;
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;

fn node(text: &str) -> Node {
    let source = Arc::new(Source { path: PathBuf::from("a.toml"), text: text.to_owned() });
    parse(&source).unwrap_or_else(|faults| panic!("{faults:?}\n{text}"))
}

fn object(value: &Value) -> &Map<String, Value> {
    value.as_object().unwrap()
}

/// Writes the patch from `base` to `now` into `text`, lays it over, and gives the text.
fn patched(base: &Value, now: &Value, text: &str) -> String {
    let patch = patch(base, now).unwrap_or_else(|| json!({}));
    let text = into_text(text, object(&patch)).unwrap();
    let mut tree = node(&into_text("", object(base)).unwrap());
    let mut faults = Vec::new();
    tree.patch(node(&text), &mut faults);
    assert!(faults.is_empty(), "{faults:?}\n{text}");
    assert!(same(&tree.json(), now), "{}\nexpected {now}\npatch\n{text}", tree.json());
    text
}

fn mars() -> Value {
    json!({
        "top_altitude_m": 120_000.0,
        "layers": [
            { "name": "gas", "scattering_per_m": [8e-8, 1.9e-7, 4.7e-7], "phase": { "kind": "rayleigh" } },
            { "name": "dust", "scattering_per_m": [2.6e-5, 2.4e-5, 2.1e-5], "phase": { "kind": "cornette_shanks", "g": 0.65 } },
        ],
        "physics": { "kind": "us76", "drag_top_m": 1e5 },
    })
}

#[test]
fn bluer_dust_is_a_patch_of_two_lines() {
    let mut now = mars();
    now["layers"][1]["scattering_per_m"] = json!([1e-5, 2e-5, 4e-5]);
    assert_eq!(patched(&mars(), &now, ""), "[layers.dust]\nscattering_per_m = [1e-5, 2e-5, 4e-5]\n");
    assert_eq!(patch(&mars(), &mars()), None);
}

#[test]
fn a_changed_kind_an_added_layer_a_removed_one_and_a_removed_key() {
    let mut now = mars();
    now["layers"][1]["phase"] = json!({ "kind": "henyey_greenstein", "g": 0.7 });
    now["layers"].as_array_mut().unwrap().push(json!({ "name": "fog", "scattering_per_m": [1e-4, 1e-4, 1e-4] }));
    patched(&mars(), &now, "");
    now["layers"].as_array_mut().unwrap().remove(0);
    let text = patched(&mars(), &now, "");
    assert!(text.contains("remove = [\"gas\"]") && text.contains("[[layers.add]]"), "{text}");
    now.as_object_mut().unwrap().remove("physics");
    assert!(patched(&mars(), &now, "").contains("remove = [\"physics\"]"));
    // Another order is another list.
    now["layers"].as_array_mut().unwrap().reverse();
    assert!(patched(&mars(), &now, "").contains("[[layers]]"));
}

#[test]
fn comments_and_layout_stay() {
    let written =
        "# My Mars.\ntop_altitude_m = 9e4 # low\n\n# Bluer.\n[layers.dust]\nscattering_per_m = [\n  1e-5, 2e-5, 3e-5, # by eye\n]\n";
    let mut now = mars();
    now["top_altitude_m"] = json!(90_000.0);
    now["layers"][1]["scattering_per_m"] = json!([1e-5, 2e-5, 3e-5]);
    assert_eq!(patched(&mars(), &now, written), written, "what is the same is not touched");
    now["top_altitude_m"] = json!(95_000.0);
    let text = patched(&mars(), &now, written);
    assert_eq!(text, written.replace("9e4", "95000.0"));
    now["layers"][1] = mars()["layers"][1].clone();
    let text = patched(&mars(), &now, written);
    assert!(text.contains("# low") && !text.contains("layers"), "{text}");
}

#[test]
fn a_file_s_own_layers_keep_their_comments_by_name() {
    let file =
        "top_altitude_m = 1e5\n\n# Molecules.\n[[layers]]\nname = \"gas\" # CO2\nx = 1\n\n# Grains.\n[[layers]]\nname = \"dust\"\nx = 2\n";
    let now = json!({ "top_altitude_m": 1e5, "layers": [{ "name": "dust", "x": 3 }] });
    let text = into_text(file, object(&now)).unwrap();
    assert_eq!(text, "top_altitude_m = 1e5\n\n# Grains.\n[[layers]]\nname = \"dust\"\nx = 3\n");
}

/// Trees of the kinds of values that assets have.
fn tree() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        any::<bool>().prop_map(Value::from),
        (-1e9..1e9_f64).prop_map(Value::from),
        "[a-c]{1,3}".prop_map(Value::from),
        prop::collection::vec(0.0..1.0_f64, 1..4).prop_map(Value::from),
    ];
    let table = prop::collection::btree_map("[a-d]", leaf.clone(), 0..4).prop_map(|m| Value::Object(m.into_iter().collect()));
    let item =
        (prop::sample::select(vec!["p", "q", "r", "s"]), prop::collection::btree_map("[a-c]", leaf.clone(), 1..3)).prop_map(|(n, m)| {
            let mut m: Map<String, Value> = m.into_iter().collect();
            m.insert("name".to_owned(), n.into());
            Value::Object(m)
        });
    let list = prop::collection::vec(item, 1..4).prop_map(Value::Array);
    // A key has values of one kind, as in every file.
    (option::of(leaf.clone()), option::of(leaf), option::of(table), option::of(list)).prop_map(|(e, f, g, h)| {
        let all = [("e", e), ("f", f), ("g", g), ("h", h)];
        Value::Object(all.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?))).collect())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn any_tree_becomes_any_other(base in tree(), now in tree(), last in tree()) {
        let text = patched(&base, &now, "");
        // A second edit of the same file says all that is different, too.
        patched(&base, &last, &text);
    }
}
