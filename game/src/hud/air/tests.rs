//! The panel by keyboard and by every model: every key has a widget, nothing panics, what is done is a step.

use super::*;
use crate::assets::draft::Target;
use crate::assets::overlay::Overlay;
use crate::assets::tests::{AIR, AIR_FILE, assets, put};
use crate::hud::testing::run;

fn editor(text: &str) -> (tempfile::TempDir, Editor) {
    let dir = assets();
    put(dir.path(), AIR_FILE, text.as_bytes());
    let overlay = Overlay::new(dir.path(), &[dir.path().join("edited")]);
    let mut editor = Editor::default();
    editor.enter(Draft::open(&overlay, "rock", Target::Mod).unwrap(), 6e6, json!({}));
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
        add(&mut values, "haze");
    }
    let names: Vec<&str> = values["layers"].as_array().unwrap().iter().map(|l| l["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["haze", "haze_2", "haze_3"]);
    let (_dir, mut editor) = editor(AIR);
    editor.draft.as_mut().unwrap().step(json!({}), false);
    assert!(texts(&mut editor).iter().any(|t| t.contains("has no air")));
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
