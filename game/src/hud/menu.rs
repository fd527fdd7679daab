//! Menus: main, starts, saves, pause.

use super::panels::area;
use super::{Hud, Lists, Reply, Request, Screen, style};
use egui::{Align2, Color32, RichText, ScrollArea, Ui, Vec2};

/// What is typed in the menus, and where "back" leads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Name of the save to write.
    pub name: String,
    /// A flight is in the background: "back" leads to the pause menu.
    pub flying: bool,
}

impl Hud {
    /// The screen that "back" leads to from starts, saves and settings.
    pub fn back(&self) -> Screen {
        if self.menu.flying { Screen::Pause } else { Screen::Main }
    }

    /// Opens the calendar of eclipses, anew from the present.
    fn open_calendar(&mut self) {
        self.calendar = super::calendar::State::default();
        self.screen = Screen::Calendar;
    }
}

fn backdrop(ctx: &egui::Context, alpha: u8) {
    let painter = ctx.layer_painter(egui::LayerId::background());
    painter.rect_filled(ctx.content_rect(), 0, Color32::from_black_alpha(alpha));
}

fn choice(ui: &mut Ui, text: &str, enabled: bool) -> bool {
    let label = RichText::new(text).font(style::words(18.0));
    offered(ui.add_enabled(enabled, egui::Button::new(label).min_size(Vec2::new(260.0, 38.0)))).clicked()
}

/// Takes the focus where nothing has it: the first of a screen, so that arrows and Enter (or a pad) need no mouse to begin with.
pub fn offered(response: egui::Response) -> egui::Response {
    if response.enabled() && response.ctx.memory(|m| m.focused().is_none()) {
        response.request_focus();
    }
    response
}

/// What goes on beside the menu.
fn beside(ctx: &egui::Context, hud: &Hud) {
    if let Some(part) = hud.paths_ahead {
        let text = format!("Working out the paths of the bodies from 1900 to 2100: {:.0} %", part * 100.0);
        area(ctx, "beside", Align2::LEFT_BOTTOM, [14.0, -10.0], |ui| ui.label(style::note(text)));
    }
}

/// The main menu.
pub fn main(ctx: &egui::Context, hud: &mut Hud, lists: &Lists, reply: &mut Reply) {
    backdrop(ctx, 70);
    beside(ctx, hud);
    hud.menu.flying = false;
    area(ctx, "main", Align2::LEFT_CENTER, [72.0, 0.0], |ui| {
        ui.label(RichText::new("SYZYGY").font(style::words(58.0)).color(style::TEXT));
        ui.label(RichText::new("From orbit to the surface, under the Moon's shadow").font(style::words(15.0)).color(style::ACCENT));
        ui.add_space(26.0);
        ui.vertical(|ui| {
            if choice(ui, "Continue", lists.saves.iter().any(|s| s.damage.is_none())) {
                reply.requests.push(Request::Continue);
            }
            if choice(ui, "New flight", true) {
                hud.screen = Screen::Starts;
            }
            if choice(ui, "Eclipses", true) {
                hud.open_calendar();
            }
            if choice(ui, "Load", !lists.saves.is_empty()) {
                hud.screen = Screen::Saves;
            }
            if choice(ui, "Settings", true) {
                hud.screen = Screen::Options;
            }
            if choice(ui, "Help", true) {
                hud.help = true;
            }
            if choice(ui, "Quit", true) {
                reply.requests.push(Request::Quit);
            }
        });
    });
    area(ctx, "version", Align2::RIGHT_BOTTOM, [-14.0, -10.0], |ui| ui.label(style::note(concat!("version ", env!("CARGO_PKG_VERSION")))));
}

/// A page in the middle of the window with a heading and a way back.
pub fn page(ctx: &egui::Context, hud: &mut Hud, id: &str, title: &str, add: impl FnOnce(&mut Ui, &mut Hud)) -> bool {
    backdrop(ctx, 150);
    let height = ctx.content_rect().height() - 150.0;
    let mut left = false;
    area(ctx, id, Align2::CENTER_CENTER, [0.0, 0.0], |ui| {
        style::panel(0.94).inner_margin(20).show(ui, |ui| {
            ui.set_width(720.0_f32.min(ctx.content_rect().width() - 60.0));
            ui.label(style::title(title));
            ui.add_space(8.0);
            ScrollArea::vertical().max_height(height.max(120.0)).auto_shrink([false, true]).show(ui, |ui| add(ui, hud));
            ui.add_space(10.0);
            left = offered(ui.button("Back")).clicked();
        });
    });
    left
}

/// Choosing a start.
pub fn starts(ctx: &egui::Context, hud: &mut Hud, lists: &Lists, reply: &mut Reply) {
    let left = page(ctx, hud, "starts", "New flight", |ui, _| {
        if lists.starts.is_empty() {
            ui.label(style::note("There is no start: assets/starts is empty."));
        }
        for start in &lists.starts {
            let button =
                egui::Button::new(RichText::new(&start.name).font(style::words(16.0))).min_size(Vec2::new(ui.available_width(), 32.0));
            if offered(ui.add(button)).clicked() {
                reply.requests.push(Request::NewFlight(start.key.clone()));
            }
            ui.label(style::note(start.description.as_str()));
            ui.add_space(6.0);
        }
    });
    if left {
        hud.screen = hud.back();
    }
}

/// Choosing a save; damaged ones are shown with their reason.
pub fn saves(ctx: &egui::Context, hud: &mut Hud, lists: &Lists, reply: &mut Reply) {
    let left = page(ctx, hud, "saves", "Load", |ui, _| {
        if lists.saves.is_empty() {
            ui.label(style::note("There is no save yet."));
        }
        for save in &lists.saves {
            let button =
                egui::Button::new(RichText::new(&save.title).font(style::words(15.0))).min_size(Vec2::new(ui.available_width(), 28.0));
            // A damaged one can be asked for, too: its backup or the newest automatic one is loaded then, and said.
            if offered(ui.add(button)).clicked() {
                reply.requests.push(Request::Load(save.path.clone()));
            }
            ui.label(style::note(save.detail.as_str()));
            if let Some(why) = &save.damage {
                ui.label(RichText::new(format!("Damaged: {why}")).font(style::words(12.5)).color(style::DANGER));
            }
            ui.add_space(5.0);
        }
    });
    if left {
        hud.screen = hud.back();
    }
}

/// The pause menu.
pub fn pause(ctx: &egui::Context, hud: &mut Hud, reply: &mut Reply) {
    backdrop(ctx, 120);
    beside(ctx, hud);
    hud.menu.flying = true;
    area(ctx, "pause", Align2::CENTER_CENTER, [0.0, 0.0], |ui| {
        style::panel(0.9).inner_margin(22).show(ui, |ui| {
            ui.label(style::title("Paused"));
            ui.add_space(8.0);
            if choice(ui, "Go on", true) {
                hud.screen = Screen::Flight;
            }
            ui.horizontal(|ui| {
                let field = ui.add(egui::TextEdit::singleline(&mut hud.menu.name).desired_width(170.0).hint_text("name of the save"));
                // It would keep the arrows up and down, and a walk through the menu would end in it.
                let filter = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
                ui.memory_mut(|m| m.set_focus_lock_filter(field.id, filter));
                let named = !hud.menu.name.trim().is_empty();
                if ui.add_enabled(named, egui::Button::new("Save")).clicked() {
                    reply.requests.push(Request::SaveAs(hud.menu.name.trim().to_owned()));
                }
            });
            if choice(ui, "Load", true) {
                hud.screen = Screen::Saves;
            }
            if choice(ui, "Quick load", true) {
                reply.requests.push(Request::Quickload);
            }
            if choice(ui, "New flight", true) {
                hud.screen = Screen::Starts;
            }
            if choice(ui, "Eclipses", true) {
                hud.open_calendar();
            }
            if choice(ui, "Photo mode", true) {
                hud.photo.enter();
                hud.screen = Screen::Photo;
            }
            if choice(ui, "Edit the air", true) {
                reply.requests.push(Request::EditAir);
            }
            if choice(ui, "Settings", true) {
                hud.screen = Screen::Options;
            }
            if choice(ui, "Help", true) {
                hud.help = true;
            }
            if choice(ui, "Main menu", true) {
                reply.requests.push(Request::Leave);
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shows a menu for some frames, a key pressed in each; what was asked for in the end.
    fn keys(hud: &mut Hud, pressed: &[egui::Key]) -> Reply {
        let (ctx, lists, mut reply) = (egui::Context::default(), Lists::default(), Reply::default());
        // Two frames to lay the menu out and to take the focus, one more for what the last key did.
        for key in [None; 3].into_iter().chain(pressed.iter().copied().map(Some)).chain([None]) {
            let event =
                key.map(|key| egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: egui::Modifiers::NONE });
            let screen_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1280.0, 720.0)));
            let input = egui::RawInput { screen_rect, events: event.into_iter().collect(), ..Default::default() };
            let output = ctx.run_ui(input, |ui| match hud.screen {
                Screen::Pause => pause(ui.ctx(), hud, &mut reply),
                _ => main(ui.ctx(), hud, &lists, &mut reply),
            });
            output.drop_without_applying_deltas();
        }
        reply
    }

    #[test]
    fn a_menu_is_walked_with_arrows_and_enter_from_its_first_choice() {
        use egui::Key::{ArrowDown, Enter};
        let mut hud = Hud::default();
        keys(&mut hud, &[Enter]);
        assert_eq!(hud.screen, Screen::Starts, "without a save the first choice is a new flight");
        let mut hud = Hud::default();
        keys(&mut hud, &[ArrowDown, Enter]);
        assert_eq!(hud.screen, Screen::Calendar);
        let mut hud = Hud::default();
        keys(&mut hud, &[ArrowDown, ArrowDown, Enter]);
        assert_eq!(hud.screen, Screen::Options);
        let reply = keys(&mut Hud::default(), &[ArrowDown, ArrowDown, ArrowDown, ArrowDown, Enter]);
        assert_eq!(reply.requests, [Request::Quit]);
        // Past the name of a save, too.
        let mut hud = Hud { screen: Screen::Pause, ..Hud::default() };
        let reply = keys(&mut hud, &[ArrowDown, ArrowDown, ArrowDown, Enter]);
        assert_eq!(reply.requests, [Request::Quickload]);
    }
}
