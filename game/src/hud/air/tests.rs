//! The panel by keyboard and by every model: every key has a widget, nothing panics, what is done is a step.

use super::*;
use crate::assets::draft::Target;
use crate::assets::overlay::Overlay;
use crate::assets::schema;
use crate::assets::tests::{AIR, AIR_FILE, assets, put};
use crate::hud::testing::{run, run_at};
use std::collections::BTreeSet;

fn editor(text: &str) -> (tempfile::TempDir, Editor) {
    let dir = assets();
    put(dir.path(), AIR_FILE, text.as_bytes());
    let overlay = Overlay::new(dir.path(), &[dir.path().join("edited")]);
    let mut editor = Editor::default();
    editor.enter(Draft::open(&overlay, "rock", Target::Mod).unwrap(), Place { radius_m: 6e6, ..Place::default() }, json!({}));
    (dir, editor)
}

fn texts(editor: &mut Editor) -> Vec<String> {
    let (mut screen, mut reply) = (Screen::Air, Reply::default());
    run(|ctx| show(ctx, editor, "Rock", &mut screen, &mut reply))
}

#[test]
fn every_model_and_every_kind_of_layer_is_shown() {
    for (model, _) in keys::MODELS {
        let described = [
            "gas = { molecules = { n2 = 1.0 }, pressure_pa = 1e5, temperature_k = 280.0 }",
            "aerosol = { optical_depth = 0.1, single_scattering_albedo = [0.9, 0.9, 0.8] }\nprofile = { kind = \"table\", altitude_m = [0, 1e4], density = [1, 0] }\nphase = { kind = \"table\", angle_deg = [0, 180], value = [2, 1] }",
            "absorber = { species = \"ozone\", column_du = 300.0 }\nprofile = { kind = \"tent\", bottom_m = 1e4, peak_m = 2e4, top_m = 3e4 }",
        ];
        let layers: String = described.iter().map(|d| format!("[[layers]]\n{d}\n")).collect();
        let text = AIR.replace("[physics]", &format!("{layers}[physics]"));
        let (_dir, mut editor) = editor(&format!("model = \"{model}\"\n{text}"));
        let shown = texts(&mut editor);
        assert!(shown.iter().any(|t| t.contains("AIR OF ROCK")), "{shown:?}");
        // What does not fit is scrolled to.
        assert!(shown.iter().any(|t| t == model) && shown.iter().any(|t| t == "Save"), "{model}: {shown:?}");
        assert!(editor.draft.as_ref().unwrap().steps().0 == 0, "showing is no step");
    }
}

#[test]
fn layers_are_added_under_names_that_are_free_and_a_bare_body_is_offered_an_air() {
    let mut values = Map::new();
    for _ in 0..3 {
        add(&mut values, "layers", "haze", |kind, name| named(draft::layer(kind), name));
    }
    let names: Vec<&str> = values["layers"].as_array().unwrap().iter().map(|l| l["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["haze", "haze_2", "haze_3"]);
    let (_dir, mut editor) = editor(AIR);
    editor.draft.as_mut().unwrap().step(json!({}), false);
    assert!(texts(&mut editor).iter().any(|t| t.contains("has no air")));
}

/// Samples of a schema that together have every key: one for each way and each variant, lists of one item for each sample of an item.
fn samples(schema: &Value) -> Vec<Value> {
    if let Some(word) = schema.get("const") {
        return vec![word.clone()];
    }
    let of_each = |key: &str| -> Vec<Value> {
        schema.get(key).and_then(Value::as_array).map(|each| each.iter().flat_map(samples).collect()).unwrap_or_default()
    };
    match schema.get("type").and_then(Value::as_str) {
        Some("object") => {
            let ways = schema.get("oneOf").and_then(Value::as_array).cloned().unwrap_or_else(|| vec![json!({})]);
            ways.iter().flat_map(|way| objects(schema, way)).collect()
        }
        Some("array") => {
            let items = samples(&schema["items"]);
            let least = schema.get("minItems").and_then(Value::as_u64).unwrap_or(0) as usize;
            vec![Value::Array(items.iter().cycle().take(least.max(items.len())).cloned().collect())]
        }
        Some("number" | "integer") => vec![schema["maximum"].clone()],
        Some("string") => vec![json!("word")],
        Some("boolean") => vec![json!(true)],
        _ => [of_each("oneOf"), of_each("anyOf")].concat(),
    }
}

/// Tables of all keys that a way leaves: as many as the key with the most samples has.
fn objects(schema: &Value, way: &Value) -> Vec<Value> {
    let keys = schema["properties"].as_object().unwrap();
    let open = keys.iter().filter(|(key, _)| way["properties"].get(*key) != Some(&Value::Bool(false)));
    let each: Vec<(&String, Vec<Value>)> = open.map(|(key, inside)| (key, samples(inside))).collect();
    let most = each.iter().map(|(_, all)| all.len()).max().unwrap_or(1);
    (0..most).map(|i| Value::Object(each.iter().map(|(key, all)| ((*key).clone(), all[i % all.len()].clone())).collect())).collect()
}

/// The keys of a schema, or of a value.
fn keys_of(value: &Value, schema: bool, keys: &mut Vec<String>) {
    match value {
        Value::Object(inside) => {
            for (key, inside) in inside {
                // In a schema keys stand in `properties`, but for those that a way forbids.
                match (schema, key.as_str()) {
                    (true, "properties") => keys
                        .extend(inside.as_object().unwrap().iter().filter(|(_, v)| v.get("description").is_some()).map(|(k, _)| k.clone())),
                    (true, _) => {}
                    (false, _) => keys.push(key.clone()),
                }
                keys_of(inside, schema, keys);
            }
        }
        Value::Array(list) => list.iter().for_each(|item| keys_of(item, schema, keys)),
        _ => {}
    }
}

#[test]
fn every_key_of_the_schema_has_a_widget() {
    let rules = schema::Rules { chosen_by: "model", needed: keys::NEEDED, ways: keys::WAYS };
    let schema = schema::of_file("", keys::ATMOSPHERE, rules);
    let mut all = Vec::new();
    keys_of(&schema, true, &mut all);
    let all: BTreeSet<String> = all.into_iter().filter(|key| key != "physical").collect();
    assert!(all.len() > 70, "{all:?}");
    let mut seen = BTreeSet::new();
    for sample in samples(&schema) {
        // Of the models' settings those of the model that is taken are there to be turned.
        for (model, _) in keys::MODELS {
            let mut now = sample.clone();
            let values = now.as_object_mut().unwrap();
            values.retain(|key, _| key == model || keys::MODELS.iter().all(|(other, _)| key != other));
            values.insert("model".to_owned(), (*model).into());
            if values.get("physical").is_some() {
                values.remove("physical");
            }
            let shown = run_at((1280.0, 100_000.0), 1.0, |ctx| {
                ctx.global_style_mut(|style| style.animation_time = 0.0);
                egui::Area::new(egui::Id::unique("all")).show(ctx, |ui| {
                    ui.set_width(500.0);
                    contents(ui, &mut now, &json!({}), Place::default(), Some(true));
                });
            });
            let mut written = Vec::new();
            keys_of(&now, false, &mut written);
            for key in BTreeSet::from_iter(&written) {
                let times = |list: &[String]| list.iter().filter(|k| *k == key || k.trim_matches(['[', ']']) == key.as_str()).count();
                if key != "kind" && key != "layers" && key != "fog" && key != "physics" {
                    assert!(times(&shown) >= times(&written), "`{key}` of {model}: {} of {}", times(&shown), times(&written));
                }
            }
            seen.extend(written);
        }
    }
    let never: Vec<&String> = all.difference(&seen).collect();
    assert!(never.is_empty(), "no sample has {never:?}");
}

#[test]
fn what_begins_by_hand_is_taken_by_the_reader() {
    let star = engine::light::spectrum::Starlight::default();
    let (dir, mut editor) = editor(AIR);
    let overlay = Overlay::new(dir.path(), &[dir.path().join("edited")]);
    let datum = crate::assets::atmosphere::Datum::new(4e14, 6e6);
    let mut sound = |what: &str, now: Value| {
        let draft = editor.draft.as_mut().unwrap();
        draft.step(now, false);
        draft.build(&overlay, datum, &star).unwrap_or_else(|e| panic!("{what}: {e}"))
    };
    // Every way to describe a layer, begun from each of the layers that can be added.
    for kind in draft::LAYERS {
        for way in keys::DESCRIBED.each {
            let mut layer = draft::layer(kind);
            let values = layer.as_object_mut().unwrap();
            values.retain(|key, _| way.contains(&key.as_str()) || !keys::DESCRIBED.apart.contains(&key.as_str()));
            for key in *way {
                values.entry(*key).or_insert_with(|| draft::first(&format!("layers.{key}")).unwrap());
            }
            let mut now = draft::first_air(6e6);
            now["layers"] = json!([layer]);
            sound(&format!("{kind} by {way:?}"), now);
        }
    }
    // Every model, chosen for an air that another one draws with the least that it needs.
    for (model, _) in keys::MODELS {
        let mut values = json!({ "model": "gradient" }).as_object().cloned().unwrap();
        draft::fill(&mut values, model, 6e6);
        values.insert("model".to_owned(), (*model).into());
        sound(model, Value::Object(values));
    }
}

#[test]
fn fog_is_added_ahead_of_the_ship_and_drawn_before_it_is_saved() {
    let dir = assets();
    let assets = crate::assets::Assets::new(dir.path().to_owned(), vec![dir.path().join("edited")]);
    let system = assets.system("t", &|_, _| ()).unwrap();
    let rock = system.find("rock").unwrap();
    let mut draft = Draft::open(&assets.overlay, "rock", Target::Mod).unwrap();
    let (lat_lon_rad, radius_m) = ((0.5, 3.1), system.body(rock).radius_m);
    let place = Place { lat_lon_rad, heading_rad: 1.0, altitude_m: 2_500.0, ground_m: 500.0, radius_m };
    let mut now = draft.now.clone();
    add(now.as_object_mut().unwrap(), "fog", "bank of fog", |_, name| draft::bank(place, name));
    draft.step(now, false);
    let body = system.body(rock);
    let datum = crate::assets::atmosphere::Datum::new(body.gm_m3_s2, body.radius_m);
    let (air, _) = draft.build(&assets.overlay, datum, &system.starlight).unwrap();
    let drawn = system.with_look(rock, air.look, air.fog);
    let [bank] = drawn.body(rock).fog.as_slice() else { panic!("one bank") };
    assert!(!draft.is_saved() && system.body(rock).fog.is_empty());
    assert_eq!(bank.air.medium.top_altitude_m, 2_000.0);
    let under = engine::space::sphere::direction_of_lat_lon(lat_lon_rad.0, lat_lon_rad.1) * (radius_m + 500.0);
    let (way, up) = (bank.centre_m - under, under.normalize());
    let north = (glam::DVec3::Z - up * up.z).normalize();
    let heading = libm::atan2(way.dot(north.cross(up)), way.dot(north));
    assert!((way.length() - 6_000.0).abs() < 10.0 && (heading - 1.0).abs() < 1e-2, "{} m, {heading}", way.length());
}

#[test]
fn every_initial_value_is_one_that_the_reader_takes() {
    fn walk(fields: &'static [Field]) {
        for field in fields {
            let value = widgets::initial(&field.kind);
            assert!(!value.is_null(), "{}", field.key);
            if let Kind::Table(inside) | Kind::Tables(inside) = &field.kind {
                walk(inside);
            }
        }
    }
    walk(keys::ATMOSPHERE);
}
