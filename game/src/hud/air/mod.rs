//! The editor of airs: sliders for every key of a body's `atmosphere.toml`, live in the picture behind it, and the file written when one
//! asks for it.
//!
//! The World stands still meanwhile, and what is drawn is a copy of it with the draft's air ([`System::with_look`]): nothing of the editor
//! is a command, and no flight depends on it before a file is saved and read. `[physics]` therefore acts from then on only. Not here:
//! the draft and its file ([`crate::assets::draft`]), one widget per kind of value ([`widgets`]).
//!
//! [`System::with_look`]: crate::world::system::System::with_look

pub mod widgets;

use super::panels::area;
use super::{Reply, Request, Screen, style};
use crate::assets::atmosphere::keys;
use crate::assets::draft::{self, Draft, Place};
use crate::assets::fields::{self, Field, Kind};
use egui::{Align2, CollapsingHeader, RichText, ScrollArea, Slider, Ui};
use serde_json::{Map, Value, json};
use widgets::Done;

/// Width of the panel, points.
pub const WIDTH: f32 = 500.0;

/// State of the editor.
#[derive(Debug, Default)]
pub struct Editor {
    /// What is edited.
    pub draft: Option<Draft>,
    /// The clock of the picture, moved by so many hours.
    pub hours: f64,
    /// The panel is shown.
    pub hidden: bool,
    /// What is wrong with the draft; the picture then shows the last good one.
    pub wrong: Option<String>,
    /// What of it is hardly meant.
    pub warnings: Vec<String>,
    /// The draft changed: whoever draws builds its air anew.
    pub changed: bool,
    /// Settings that a model has where the file leaves them out, as JSON.
    pub defaults: Value,
    /// Where the ship is: what is added is added there.
    pub place: Place,
    /// Everything is to be unfolded, or folded, in the next frame.
    pub fold: Option<bool>,
}

impl Editor {
    /// Begins with a draft.
    pub fn enter(&mut self, draft: Draft, place: Place, defaults: Value) {
        *self = Self { draft: Some(draft), changed: true, place, defaults, ..Self::default() };
    }
}

/// The panel.
pub fn show(ctx: &egui::Context, editor: &mut Editor, body: &str, screen: &mut Screen, reply: &mut Reply) {
    if editor.hidden {
        return;
    }
    let (undo, redo, save) = ctx.input_mut(|i| {
        use egui::{Key, Modifiers};
        let redo = i.consume_key(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z) | i.consume_key(Modifiers::COMMAND, Key::Y);
        (i.consume_key(Modifiers::COMMAND, Key::Z), redo, i.consume_key(Modifiers::COMMAND, Key::S))
    });
    area(ctx, "air", Align2::RIGHT_TOP, [-10.0, 10.0], |ui| {
        style::panel(0.9).show(ui, |ui| {
            ui.set_width(WIDTH.min(ctx.content_rect().width() - 40.0));
            ui.horizontal(|ui| {
                ui.label(style::heading(&format!("Air of {body}")));
                if ui.button("Close").clicked() {
                    *screen = Screen::Flight;
                }
                for (word, open) in [("Unfold", true), ("Fold", false)] {
                    if ui.button(word).on_hover_text("all layers, banks of fog and tables").clicked() {
                        editor.fold = Some(open);
                    }
                }
            });
            ui.horizontal(|ui| {
                ui.label("clock, h");
                ui.add(Slider::new(&mut editor.hours, -12.0..=12.0).step_by(0.02))
                    .on_hover_text("moves the sun in the picture, not in the flight");
            });
            let Some(draft) = &mut editor.draft else {
                ui.label(style::note("There is no air to edit here."));
                return;
            };
            let stepped = buttons(ui, draft, [undo, redo, save], reply);
            let height = ctx.content_rect().height() - 210.0;
            let mut now = draft.now.clone();
            let done = ScrollArea::vertical()
                .max_height(height.max(120.0))
                .min_scrolled_height(height.max(120.0))
                .auto_shrink([false, true])
                .show(ui, |ui| {
                    ui.spacing_mut().slider_width = 150.0;
                    contents(ui, &mut now, &editor.defaults, editor.place, editor.fold.take())
                });
            if done.inner.changed || !done.inner.held {
                draft.step(now, done.inner.held);
            }
            editor.changed |= done.inner.changed | stepped;
            told(ui, editor);
        });
    });
}

/// Save, undo and the like; true where the draft changed.
fn buttons(ui: &mut Ui, draft: &mut Draft, [undo, redo, save]: [bool; 3], reply: &mut Reply) -> bool {
    let mut changed = false;
    let (back, forward) = draft.steps();
    ui.horizontal(|ui| {
        let can_save = !draft.is_saved();
        if ui.add_enabled(can_save, egui::Button::new("Save")).on_hover_text("Ctrl+S").clicked() || (save && can_save) {
            reply.requests.push(Request::SaveAir);
        }
        if ui.add_enabled(back > 0, egui::Button::new("Undo")).on_hover_text("Ctrl+Z").clicked() || undo {
            changed |= draft.undo();
        }
        if ui.add_enabled(forward > 0, egui::Button::new("Redo")).on_hover_text("Ctrl+Shift+Z").clicked() || redo {
            changed |= draft.redo();
        }
        if ui.add_enabled(can_save, egui::Button::new("As saved")).clicked() {
            draft.revert();
            changed = true;
        }
        if draft.has_base() && ui.button("As it came").on_hover_text("without this patch: saved, the file goes").clicked() {
            draft.reset();
            changed = true;
        }
    });
    ui.label(style::note(format!("{}{}", if draft.is_saved() { "" } else { "not saved: " }, draft.path.display())));
    changed
}

fn told(ui: &mut Ui, editor: &Editor) {
    if let Some(wrong) = &editor.wrong {
        ui.label(RichText::new("This cannot be drawn; the picture shows the last that could").color(style::DANGER));
        ui.label(RichText::new(wrong).font(style::mono(12.0)));
    }
    for warning in editor.warnings.iter().take(3) {
        ui.label(RichText::new(format!("Hardly meant: {warning}")).font(style::words(12.5)).color(style::ACCENT));
    }
}

/// All of the file. `fold` opens all that can be folded, or closes it.
fn contents(ui: &mut Ui, now: &mut Value, defaults: &Value, place: Place, fold: Option<bool>) -> Done {
    let mut done = Done::default();
    let Some(values) = now.as_object_mut() else { return done };
    if values.is_empty() {
        ui.label(style::note("This body has no air."));
        if ui.button("Give it an air").clicked() {
            *now = draft::first_air(place.radius_m);
            done.changed = true;
        }
        return done;
    }
    let mut model = values.get("model").cloned().unwrap_or_else(|| json!("physical"));
    ui.horizontal(|ui| {
        ui.label("model");
        let chosen = widgets::choice(ui, "model", keys::MODELS, &mut model);
        if chosen.changed {
            values.insert("model".to_owned(), model.clone());
            draft::fill(values, model.as_str().unwrap_or_default(), place.radius_m);
        }
        done.and(chosen);
    });
    let word = model.as_str().unwrap_or_default().to_owned();
    if let Some(Field { kind: Kind::Table(fields), .. }) = fields::find(keys::ATMOSPHERE, &word)
        && !fields.is_empty()
    {
        CollapsingHeader::new(format!("[{word}]")).default_open(true).open(fold).show(ui, |ui| {
            let mut settings = values.get(&word).and_then(Value::as_object).cloned().unwrap_or_default();
            let changed = widgets::table(ui, &word, fields, &mut settings, &defaults[&word], &[]);
            if changed.changed {
                if settings.is_empty() {
                    values.remove(&word);
                } else {
                    values.insert(word.clone(), Value::Object(settings));
                }
            }
            done.and(changed);
        });
    }
    let models: Vec<&str> = keys::MODELS.iter().map(|m| m.0).chain(["model", "layers", "fog", "physics"]).collect();
    done.and(widgets::table(ui, "", keys::ATMOSPHERE, values, &Value::Null, &models));
    done.and(items(ui, values, &LAYERS, defaults, fold, |kind, name| named(draft::layer(kind), name)));
    done.and(items(ui, values, &BANKS, defaults, fold, |_, name| draft::bank(place, name)));
    CollapsingHeader::new("[physics]: what drags, once saved").open(fold).show(ui, |ui| {
        let others: Vec<&str> = keys::ATMOSPHERE.iter().map(|f| f.key).filter(|k| *k != "physics").collect();
        done.and(widgets::table(ui, "", keys::ATMOSPHERE, values, &Value::Null, &others));
    });
    done
}

/// A list whose items are folded, and what can be added to it.
struct List {
    key: &'static str,
    fields: &'static [Field],
    /// What an item without a name is called.
    word: &'static str,
    add: &'static str,
    kinds: &'static [&'static str],
}

const LAYERS: List = List { key: "layers", fields: keys::LAYER, word: "layer", add: "Add a layer:", kinds: &draft::LAYERS };
const BANKS: List = List { key: "fog", fields: keys::FOG, word: "bank of fog", add: "Add ahead of the ship:", kinds: &["bank of fog"] };

/// The items of a list, each to be folded, and ways to add and to remove one.
fn items(
    ui: &mut Ui,
    values: &mut Map<String, Value>,
    list: &List,
    defaults: &Value,
    fold: Option<bool>,
    new: impl Fn(&str, &str) -> Value,
) -> Done {
    let mut done = Done::default();
    let mut gone = None;
    for (i, item) in values.get_mut(list.key).and_then(Value::as_array_mut).into_iter().flatten().enumerate() {
        let Some(item) = item.as_object_mut() else { continue };
        let name = item.get("name").and_then(Value::as_str).map_or_else(|| format!("{} {i}", list.word), str::to_owned);
        CollapsingHeader::new(name).id_salt((list.key, i)).open(fold).show(ui, |ui| {
            done.and(widgets::table(ui, list.key, list.fields, item, defaults, &[]));
            if ui.button("Remove").on_hover_text(format!("this {}", list.word)).clicked() {
                gone = Some(i);
            }
        });
    }
    if let (Some(i), Some(all)) = (gone, values.get_mut(list.key).and_then(Value::as_array_mut)) {
        all.remove(i);
        if all.is_empty() && list.key == BANKS.key {
            values.remove(list.key);
        }
        done.changed = true;
    }
    ui.horizontal(|ui| {
        ui.label(list.add);
        for kind in list.kinds {
            if ui.button(*kind).clicked() {
                add(values, list.key, kind, &new);
                done.changed = true;
            }
        }
    });
    done
}

/// Appends an item under a name that is free.
fn add(values: &mut Map<String, Value>, key: &str, kind: &str, new: impl Fn(&str, &str) -> Value) {
    let list = values.entry(key).or_insert_with(|| json!([]));
    let Some(list) = list.as_array_mut() else { return };
    let taken = |name: &str| list.iter().any(|l| l.get("name").and_then(Value::as_str) == Some(name));
    let word = kind.replace(' ', "_");
    let name = (1..).map(|n| if n == 1 { word.clone() } else { format!("{word}_{n}") }).find(|n| !taken(n)).unwrap_or(word);
    list.push(new(kind, &name));
}

fn named(mut item: Value, name: &str) -> Value {
    item["name"] = name.into();
    item
}

#[cfg(test)]
mod tests;
