//! The controls page: what is bound to what, rebinding, conflicts, dead zones, curves, inversion.

use super::style;
use crate::input::bindings::{AxisBinding, Bindings, Source};
use crate::input::controls::{Analogue, Control, Group};
use crate::input::pads::AxisCapture;
use crate::input::{Focus, Input};
use crate::settings::Settings;
use egui::{RichText, Slider, Ui};

/// What is being bound.
#[derive(Clone, Debug, PartialEq)]
pub enum Waiting {
    /// A key or button for a control.
    Press(Control),
    /// A stick or trigger for an analogue control, with where every axis rested when the wait began.
    Axis(Analogue, AxisCapture),
}

/// The page.
pub fn show(ui: &mut Ui, settings: &mut Settings, input: &mut Input, waiting: &mut Option<Waiting>) {
    catch(&mut settings.controls, input, waiting);
    ui.label(style::note("Click + and press a key, a mouse side button or a pad button. Esc leaves it as it is."));
    for group in Group::ALL {
        ui.add_space(6.0);
        ui.label(style::heading(group.label()));
        for control in Control::ALL.iter().filter(|c| c.group() == group) {
            button_row(ui, *control, &mut settings.controls, input, waiting);
        }
    }
    ui.add_space(10.0);
    ui.label(style::heading("Sticks and triggers"));
    let pads = input.pads.names().join(", ");
    ui.label(style::note(if pads.is_empty() { "No gamepad is connected.".to_owned() } else { format!("Connected: {pads}") }));
    for analogue in Analogue::ALL {
        axis_rows(ui, analogue, &mut settings.controls, input, waiting);
    }
    for name in input.pads.names() {
        ui.horizontal(|ui| {
            ui.label(format!("Dead zone of {name}"));
            let dead = settings.controls.device_dead_zone.entry(name.to_owned()).or_insert(0.0);
            ui.add(Slider::new(dead, 0.0..=0.6));
        });
    }
    ui.add_space(8.0);
    if ui.button("All controls as they were delivered").clicked() {
        settings.controls = Bindings::default();
    }
    input.bindings = settings.controls.clone();
}

/// Takes what was pressed or moved while waiting.
fn catch(bindings: &mut Bindings, input: &mut Input, waiting: &mut Option<Waiting>) {
    let caught = input.take_caught();
    let escape = Source::parse("key:Escape").ok();
    let done = match waiting {
        None => return,
        Some(Waiting::Press(control)) => match caught {
            None => false,
            // Escape is bound only to what it is bound to by default, or no menu could be left.
            Some(source) if Some(source) == escape && *control != Control::Pause => true,
            Some(source) => {
                bindings.bind(*control, source);
                true
            }
        },
        Some(Waiting::Axis(analogue, capture)) => match input.pads.captured(capture) {
            Some(axis) => {
                bindings.axes.entry(*analogue).or_default().push(AxisBinding::new(axis, false));
                true
            }
            None => caught.is_some(),
        },
    };
    if done {
        *waiting = None;
        input.set_focus(Focus::Menu);
    }
}

fn button_row(ui: &mut Ui, control: Control, bindings: &mut Bindings, input: &mut Input, waiting: &mut Option<Waiting>) {
    ui.horizontal(|ui| {
        ui.add_sized([210.0, 20.0], egui::Label::new(control.label()).halign(egui::Align::LEFT));
        for source in bindings.sources(control).to_vec() {
            let others = bindings.conflicts(control, source);
            let colour = if others.is_empty() { style::TEXT } else { style::DANGER };
            let response = ui.button(RichText::new(format!("{} ×", source.label())).font(style::words(12.5)).color(colour));
            let names: Vec<&str> = others.iter().map(|c| c.label()).collect();
            let hint = if names.is_empty() { "Click: take away".to_owned() } else { format!("Also works: {}", names.join(", ")) };
            if response.on_hover_text(hint).clicked() {
                bindings.unbind(control, source);
            }
        }
        if *waiting == Some(Waiting::Press(control)) {
            ui.label(RichText::new("press …").color(style::ACCENT));
        } else if ui.small_button("+").clicked() {
            *waiting = Some(Waiting::Press(control));
            input.set_focus(Focus::Text);
        }
    });
}

fn axis_rows(ui: &mut Ui, analogue: Analogue, bindings: &mut Bindings, input: &mut Input, waiting: &mut Option<Waiting>) {
    ui.horizontal(|ui| {
        ui.add_sized([210.0, 20.0], egui::Label::new(analogue.label()).halign(egui::Align::LEFT));
        if matches!(waiting, Some(Waiting::Axis(a, _)) if *a == analogue) {
            ui.label(RichText::new("move a stick or trigger …").color(style::ACCENT));
        } else if ui.small_button("+").clicked() {
            *waiting = Some(Waiting::Axis(analogue, input.pads.begin_capture()));
            input.set_focus(Focus::Text);
        }
        ui.label(style::note(format!("{:+.2}", input.deflection(analogue))));
    });
    let Some(list) = bindings.axes.get_mut(&analogue) else { return };
    let mut gone = None;
    for (i, axis) in list.iter_mut().enumerate() {
        ui.horizontal(|ui| {
            ui.spacing_mut().slider_width = 80.0;
            ui.add_space(16.0);
            ui.label(RichText::new(axis.axis.label()).font(style::words(12.5)));
            ui.checkbox(&mut axis.invert, "invert");
            ui.add(Slider::new(&mut axis.dead_zone, 0.0..=0.6).text("dead zone").fixed_decimals(2));
            ui.add(Slider::new(&mut axis.curve, 0.0..=1.0).text("curve").fixed_decimals(2));
            if ui.small_button("×").clicked() {
                gone = Some(i);
            }
        });
    }
    if let Some(i) = gone {
        list.remove(i);
    }
}
