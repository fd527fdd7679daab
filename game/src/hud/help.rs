//! The help overlay: the bindings in force, by group.

use super::panels::area;
use super::style;
use crate::input::bindings::Bindings;
use crate::input::controls::{Analogue, Control, Group};
use egui::{Align2, RichText, Ui};

/// The overlay.
pub fn show(ctx: &egui::Context, bindings: &Bindings, opacity: f32, open: &mut bool) {
    let columns: [&[Group]; 3] =
        [&[Group::Attitude, Group::Translation, Group::Engine], &[Group::Holds, Group::Guidance], &[Group::Time, Group::View, Group::Game]];
    area(ctx, "help", Align2::CENTER_CENTER, [0.0, -20.0], |ui| {
        style::panel(opacity.max(0.92)).inner_margin(18).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(style::title("Controls in force"));
                if ui.button("Close").clicked() {
                    *open = false;
                }
            });
            ui.horizontal_top(|ui| {
                for (i, groups) in columns.into_iter().enumerate() {
                    ui.vertical(|ui| {
                        ui.set_width(300.0);
                        for group in groups {
                            ui.add_space(5.0);
                            ui.label(style::heading(group.label()));
                            for control in Control::ALL.iter().filter(|c| c.group() == *group) {
                                line(ui, &bindings.text(*control), control.label());
                            }
                        }
                        if i == 1 {
                            sticks(ui, bindings);
                        }
                    });
                }
            });
            ui.label(style::note(
                "Mouse: drag turns the view, the wheel moves the camera. Everything can be rebound under Settings > Controls.",
            ));
        });
    });
}

fn sticks(ui: &mut Ui, bindings: &Bindings) {
    ui.add_space(5.0);
    ui.label(style::heading("Sticks and triggers"));
    for analogue in Analogue::ALL {
        let names: Vec<&str> = bindings.axes.get(&analogue).into_iter().flatten().map(|a| a.axis.label()).collect();
        if !names.is_empty() {
            line(ui, &names.join(", "), analogue.label());
        }
    }
}

fn line(ui: &mut Ui, keys: &str, what: &str) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.add_sized([150.0, 15.0], egui::Label::new(RichText::new(keys).font(style::mono(11.5)).color(style::ACCENT)).truncate());
        ui.label(RichText::new(what).font(style::words(12.5)));
    });
}
