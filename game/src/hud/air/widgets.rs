//! Widgets of the editor of airs: made of the same [`fields`](crate::assets::fields) by which the file is read, so that every key of the
//! file has one. Values are JSON, as in a draft. Channels are named by letters, not by colours alone.

use crate::assets::draft;
use crate::assets::fields::{Field, Kind, Span, Variant, Ways};
use crate::hud::style;
use egui::{ComboBox, DragValue, RichText, Slider, Ui};
use serde_json::{Map, Value, json};

/// Width of the keys.
const KEYS: f32 = 168.0;

/// What a frame of the editor did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// Something changed.
    pub changed: bool,
    /// It changes on: a slider or a value is held.
    pub held: bool,
}

impl Done {
    fn hear(&mut self, response: &egui::Response) {
        self.changed |= response.changed();
        self.held |= response.dragged() || response.is_pointer_button_down_on();
    }

    fn click(&mut self) {
        self.changed = true;
    }

    /// Both.
    pub fn and(&mut self, other: Self) {
        self.changed |= other.changed;
        self.held |= other.held;
    }
}

/// All fields of the table at a path of the file, but for those in `but`; of a table that can be filled in several ways, those of the way
/// that is taken, and a choice of it. `defaults` are the values that hold where a key is left out, as far as they are known.
pub fn table(ui: &mut Ui, path: &str, fields: &'static [Field], values: &mut Map<String, Value>, defaults: &Value, but: &[&str]) -> Done {
    let mut done = Done::default();
    let mut hidden: Vec<&str> = but.to_vec();
    if let Some(ways) = draft::ways(path) {
        done.and(way(ui, path, ways, fields, values));
        hidden.extend(ways.apart.iter().copied().filter(|key| !values.contains_key(*key)));
    }
    for field in fields.iter().filter(|f| !hidden.contains(&f.key)) {
        let default = defaults.get(field.key).cloned().unwrap_or(Value::Null);
        done.and(entry(ui, &below(path, field.key), field, values, &default));
    }
    done
}

fn below(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// What a key begins with.
fn begin(path: &str, field: &Field) -> Value {
    draft::first(path).unwrap_or_else(|| initial(&field.kind))
}

/// A choice among the ways to fill a table. What the new way needs and is not there begins with values of its own.
fn way(ui: &mut Ui, path: &str, ways: &'static Ways, fields: &'static [Field], values: &mut Map<String, Value>) -> Done {
    let mut done = Done::default();
    let label = |way: &&[&str]| way.iter().filter(|key| ways.apart.contains(*key)).copied().collect::<Vec<_>>().join(" + ");
    // The way of which most is there and nothing is missing.
    let there = |way: &&&[&str]| way.iter().filter(|key| ways.apart.contains(*key)).all(|key| values.contains_key(*key));
    let taken = ways.each.iter().find(there);
    let mut chosen = None;
    ui.horizontal(|ui| {
        ui.label(style::note("given by"));
        ComboBox::from_id_salt((path, "way")).width(300.0).selected_text(taken.map_or_else(|| "?".to_owned(), label)).show_ui(ui, |ui| {
            for way in ways.each {
                if ui.selectable_label(taken.is_some_and(|t| t == way), label(way)).clicked() && taken.is_none_or(|t| t != way) {
                    chosen = Some(way);
                }
            }
        });
    });
    if let Some(way) = chosen {
        values.retain(|key, _| way.contains(&key.as_str()) || !ways.apart.contains(&key.as_str()));
        for field in fields.iter().filter(|f| way.contains(&f.key)) {
            values.entry(field.key).or_insert_with(|| begin(&below(path, field.key), field));
        }
        done.click();
    }
    done
}

fn entry(ui: &mut Ui, path: &str, field: &'static Field, values: &mut Map<String, Value>, default: &Value) -> Done {
    let mut done = Done::default();
    let nested = matches!(field.kind, Kind::Table(_) | Kind::Variants(_) | Kind::Tables(_) | Kind::Shares(_));
    if !values.contains_key(field.key) {
        // Of a table the values in force are no value to begin with: it would hold all keys.
        let default = if nested { &Value::Null } else { default };
        ui.horizontal(|ui| {
            key(ui, field);
            let hint = if default.is_null() { "left out".to_owned() } else { format!("left out: {}", short(default)) };
            if ui.button("Set").on_hover_text(field.doc).clicked() {
                values.insert(field.key.to_owned(), if default.is_null() { begin(path, field) } else { default.clone() });
                done.click();
            }
            ui.label(style::note(hint));
        });
        return done;
    }
    let mut leave_out = false;
    let Some(value) = values.get_mut(field.key) else { return done };
    if nested {
        ui.horizontal(|ui| {
            key(ui, field);
            leave_out = !field.must && ui.small_button("Leave out").clicked();
        });
        ui.indent(field.key, |ui| done.and(widget(ui, path, field, value, default)));
    } else {
        ui.horizontal(|ui| {
            key(ui, field);
            done.and(widget(ui, path, field, value, default));
            leave_out = !field.must && ui.small_button("×").on_hover_text("leave out").clicked();
        });
    }
    if leave_out {
        values.remove(field.key);
        done.click();
    }
    done
}

fn key(ui: &mut Ui, field: &Field) {
    let text = RichText::new(field.key).font(style::mono(12.0));
    let left = egui::Layout::left_to_right(egui::Align::Center);
    ui.allocate_ui_with_layout(egui::Vec2::new(KEYS, 18.0), left, |ui| {
        ui.set_min_width(KEYS);
        ui.add(egui::Label::new(text).truncate()).on_hover_text(field.doc);
    });
}

/// The widget of a value that is there. A value of another kind than it should have begins anew.
fn widget(ui: &mut Ui, path: &str, field: &'static Field, value: &mut Value, default: &Value) -> Done {
    let mut done = Done::default();
    match &field.kind {
        Kind::Number(span) => done.and(number(ui, span, value, "")),
        Kind::Whole(span) => {
            let mut x = value.as_f64().unwrap_or(span.min);
            let response = ui.add(Slider::new(&mut x, span.min..=span.max).integer().logarithmic(span.log));
            done.hear(&response);
            if response.changed() {
                *value = whole(x);
            }
        }
        Kind::Rgb(span) => done.and(channels(ui, span, value)),
        Kind::OneOrRgb(span) => {
            let mut three = value.is_array();
            if ui.checkbox(&mut three, "by channel").changed() {
                *value =
                    if three { json!([value.clone(), value.clone(), value.clone()]) } else { value.get(0).cloned().unwrap_or(Value::Null) };
                done.click();
            }
            done.and(if three { channels(ui, span, value) } else { number(ui, span, value, "") });
        }
        Kind::Numbers(span) => done.and(series(ui, span, value)),
        Kind::Flag => {
            let mut on = value.as_bool().unwrap_or(false);
            let response = ui.checkbox(&mut on, "");
            done.hear(&response);
            *value = on.into();
        }
        Kind::Text | Kind::File => {
            let mut text = value.as_str().unwrap_or_default().to_owned();
            let response = ui.add(egui::TextEdit::singleline(&mut text).desired_width(150.0));
            done.hear(&response);
            // A name while it is typed is one step.
            done.held |= response.has_focus();
            if response.changed() && !text.is_empty() {
                *value = text.into();
            }
        }
        Kind::Choice(words) => done.and(choice(ui, field.key, words, value)),
        Kind::Table(fields) => done.and(inside(ui, path, fields, value, default)),
        Kind::Variants(variants) => done.and(variant(ui, path, variants, value)),
        Kind::Tables(fields) => done.and(list(ui, path, fields, value)),
        Kind::Shares(names) => {
            if !value.is_object() {
                *value = json!({});
            }
            let Some(shares) = value.as_object_mut() else { return done };
            for name in *names {
                let mut share = shares.get(*name).and_then(Value::as_f64).unwrap_or(0.0);
                ui.horizontal(|ui| {
                    ui.add_sized([44.0, 18.0], egui::Label::new(RichText::new(*name).font(style::mono(12.0))));
                    let response = ui.add(Slider::new(&mut share, 0.0..=1.0));
                    done.hear(&response);
                    if response.changed() {
                        if share > 0.0 {
                            shares.insert((*name).to_owned(), share.into());
                        } else {
                            shares.remove(*name);
                        }
                    }
                });
            }
        }
    }
    done
}

/// A table inside; what is none begins anew as one.
fn inside(ui: &mut Ui, path: &str, fields: &'static [Field], value: &mut Value, defaults: &Value) -> Done {
    if !value.is_object() {
        *value = json!({});
    }
    value.as_object_mut().map_or_else(Done::default, |values| table(ui, path, fields, values, defaults, &[]))
}

#[allow(clippy::cast_possible_truncation)]
fn whole(x: f64) -> Value {
    Value::from(x.round() as i64)
}

fn number(ui: &mut Ui, span: &Span, value: &mut Value, name: &str) -> Done {
    let mut done = Done::default();
    let mut x = value.as_f64().unwrap_or(span.min);
    let mut slider =
        Slider::new(&mut x, span.min..=span.max).text(name).custom_formatter(|x, _| digits(x)).custom_parser(|s| s.trim().parse().ok());
    if span.log {
        slider = slider.logarithmic(true).smallest_positive(1e-9);
    }
    let response = ui.add(slider);
    done.hear(&response);
    if response.changed() {
        *value = x.into();
    }
    done
}

/// Three sliders, and a swatch of the three beside each other's largest.
fn channels(ui: &mut Ui, span: &Span, value: &mut Value) -> Done {
    let mut done = Done::default();
    if value.as_array().is_none_or(|a| a.len() != 3) {
        *value = json!([span.min, span.min, span.min]);
    }
    ui.vertical(|ui| {
        for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
            if let Some(channel) = value.get_mut(i) {
                done.and(number(ui, span, channel, name));
            }
        }
    });
    let rgb: Vec<f64> = (0..3).map(|i| value.get(i).and_then(Value::as_f64).unwrap_or(0.0).max(0.0)).collect();
    let most = rgb.iter().copied().fold(1e-30, f64::max);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let byte = |x: f64| (255.0 * libm::pow(x / most, 1.0 / 2.2)).round() as u8;
    let (rect, _) = ui.allocate_exact_size(egui::Vec2::new(16.0, 46.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 2.0, egui::Color32::from_rgb(byte(rgb[0]), byte(rgb[1]), byte(rgb[2])));
    done
}

/// The numbers of a table, one behind the other.
fn series(ui: &mut Ui, span: &Span, value: &mut Value) -> Done {
    let mut done = Done::default();
    if !value.is_array() {
        *value = json!([span.min, span.max]);
    }
    ui.vertical(|ui| {
        ui.set_max_width(300.0);
        ui.horizontal_wrapped(|ui| {
            for item in value.as_array_mut().into_iter().flatten() {
                let mut x = item.as_f64().unwrap_or(span.min);
                let speed = (0.01 * x.abs()).max(1e-9);
                let drag = DragValue::new(&mut x).range(span.min..=span.max).speed(speed);
                let response = ui.add(drag.custom_formatter(|x, _| digits(x)).custom_parser(|s| s.trim().parse().ok()));
                done.hear(&response);
                if response.changed() {
                    *item = x.into();
                }
            }
        });
        ui.horizontal(|ui| {
            let Some(all) = value.as_array_mut() else { return };
            if ui.small_button("One more").clicked() {
                all.push(all.last().cloned().unwrap_or_else(|| span.min.into()));
                done.click();
            }
            if ui.add_enabled(all.len() > 2, egui::Button::new("One less").small()).clicked() {
                all.pop();
                done.click();
            }
        });
    });
    done
}

/// A combo box of words, each explained.
pub fn choice(ui: &mut Ui, id: &str, words: &[(&'static str, &'static str)], value: &mut Value) -> Done {
    let mut done = Done::default();
    let now = value.as_str().unwrap_or_default().to_owned();
    ComboBox::from_id_salt(id).selected_text(now.as_str()).show_ui(ui, |ui| {
        for (word, doc) in words {
            if ui.selectable_label(*word == now, *word).on_hover_text(*doc).clicked() && *word != now {
                *value = (*word).into();
                done.click();
            }
        }
    });
    done
}

/// The `kind` of a table, and the keys that it then has. Keys that both kinds have are kept.
fn variant(ui: &mut Ui, path: &str, variants: &'static [Variant], value: &mut Value) -> Done {
    let mut done = Done::default();
    let words: Vec<(&'static str, &'static str)> = variants.iter().map(|v| (v.word, v.doc)).collect();
    let mut kind = value.get("kind").cloned().unwrap_or(Value::Null);
    done.and(choice(ui, path, &words, &mut kind));
    let Some(variant) = variants.iter().find(|v| kind.as_str() == Some(v.word)) else { return done };
    if done.changed {
        let before = value.as_object().cloned().unwrap_or_default();
        let mut now = Map::new();
        now.insert("kind".to_owned(), kind);
        for field in variant.fields {
            match before.get(field.key) {
                Some(kept) => drop(now.insert(field.key.to_owned(), kept.clone())),
                None if field.must => drop(now.insert(field.key.to_owned(), begin(&below(path, field.key), field))),
                None => {}
            }
        }
        *value = Value::Object(now);
    }
    done.and(inside(ui, path, variant.fields, value, &Value::Null));
    done
}

/// A list of small tables: stretches of lapse.
fn list(ui: &mut Ui, path: &str, fields: &'static [Field], value: &mut Value) -> Done {
    let mut done = Done::default();
    if !value.is_array() {
        *value = json!([]);
    }
    let Some(items) = value.as_array_mut() else { return done };
    let mut gone = None;
    for (i, item) in items.iter_mut().enumerate() {
        ui.push_id(i, |ui| {
            done.and(inside(ui, path, fields, item, &Value::Null));
            if ui.small_button("Take out").clicked() {
                gone = Some(i);
            }
        });
    }
    if let Some(i) = gone {
        items.remove(i);
        done.click();
    }
    if ui.small_button("Add").clicked() {
        let first: Map<String, Value> = fields.iter().map(|f| (f.key.to_owned(), initial(&f.kind))).collect();
        items.push(Value::Object(first));
        done.click();
    }
    done
}

/// What a value begins with.
pub fn initial(kind: &Kind) -> Value {
    let middle = |span: &Span| {
        if span.log { (span.min.max(1e-9) * span.max).sqrt() } else { 0.5 * (span.min + span.max) }
    };
    match kind {
        Kind::Number(span) | Kind::OneOrRgb(span) => middle(span).into(),
        Kind::Whole(span) => whole(middle(span)),
        Kind::Rgb(span) => json!([span.min, span.min, span.min]),
        Kind::Numbers(span) => json!([span.min, span.max]),
        Kind::Flag => false.into(),
        Kind::Text => "name".into(),
        Kind::File => "atmosphere_map.png".into(),
        Kind::Choice(words) => words.first().map_or(Value::Null, |w| w.0.into()),
        Kind::Table(fields) => Value::Object(fields.iter().filter(|f| f.must).map(|f| (f.key.to_owned(), initial(&f.kind))).collect()),
        Kind::Variants(variants) => variants.first().map_or(Value::Null, |v| {
            let mut first: Map<String, Value> = v.fields.iter().filter(|f| f.must).map(|f| (f.key.to_owned(), initial(&f.kind))).collect();
            first.insert("kind".to_owned(), v.word.into());
            Value::Object(first)
        }),
        Kind::Tables(_) => json!([]),
        Kind::Shares(names) => names.first().map_or_else(|| json!({}), |n| json!({ *n: 1.0 })),
    }
}

/// A number as people write it.
pub fn digits(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        let text = format!("{x:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{x:.3e}")
    }
}

fn short(value: &Value) -> String {
    match value {
        Value::Number(x) => digits(x.as_f64().unwrap_or(0.0)),
        Value::Array(list) => format!("[{}]", list.iter().map(short).collect::<Vec<_>>().join(", ")),
        Value::String(s) => s.clone(),
        other => other.to_string(),
    }
}
