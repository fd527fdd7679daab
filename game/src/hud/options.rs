//! The settings screen: picture, sound, HUD; controls have a page of their own ([`super::controls`]).

use super::{Hud, Reply, Request, controls, menu, style};
use crate::input::{Focus, Input};
use crate::settings::Settings;
use egui::{Slider, Ui};

/// Pages of the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Page {
    /// Picture.
    #[default]
    Video,
    /// Volumes.
    Sound,
    /// Keys, buttons, sticks.
    Controls,
}

/// State of the screen.
#[derive(Debug, Default)]
pub struct State {
    /// The page shown.
    pub page: Page,
    /// What is being bound.
    pub waiting: Option<controls::Waiting>,
}

/// The settings screen.
pub fn show(ctx: &egui::Context, hud: &mut Hud, settings: &mut Settings, input: &mut Input, reply: &mut Reply) {
    let before = settings.clone();
    let left = menu::page(ctx, hud, "options", "Settings", |ui, hud| {
        ui.horizontal(|ui| {
            for (page, name) in [(Page::Video, "Picture"), (Page::Sound, "Sound"), (Page::Controls, "Controls")] {
                if menu::offered(style::toggle(ui, hud.options.page == page, name)).clicked() {
                    hud.options.page = page;
                    hud.options.waiting = None;
                    input.set_focus(Focus::Menu);
                }
            }
        });
        ui.add_space(8.0);
        match hud.options.page {
            Page::Video => video(ui, settings),
            Page::Sound => sound(ui, settings),
            Page::Controls => controls::show(ui, settings, input, &mut hud.options.waiting),
        }
    });
    if *settings != before {
        reply.requests.push(Request::Apply);
    }
    if left {
        hud.options.waiting = None;
        hud.screen = hud.back();
        reply.requests.push(Request::Keep);
    }
}

fn video(ui: &mut Ui, settings: &mut Settings) {
    let v = &mut settings.video;
    egui::Grid::new("video").num_columns(2).spacing([24.0, 8.0]).show(ui, |ui| {
        ui.label("Resolution of the picture");
        ui.add(Slider::new(&mut v.render_scale, 0.25..=1.0).step_by(0.05).custom_formatter(|x, _| format!("{:.0} %", x * 100.0)));
        ui.end_row();
        ui.label("Field of view (vertical)");
        ui.add(Slider::new(&mut v.fov_deg, 20.0..=110.0).step_by(1.0).suffix("°"));
        ui.end_row();
        ui.label("Exposure compensation");
        ui.add(Slider::new(&mut v.exposure_ev, -5.0..=5.0).step_by(0.1).suffix(" EV"));
        ui.end_row();
        ui.label("Points on a ray through air");
        ui.add(Slider::new(&mut v.sky_points, 4..=96).step_by(4.0));
        ui.end_row();
        ui.label("Error of skies between rays");
        ui.add(Slider::new(&mut v.sky_error, 0.0003..=0.3).logarithmic(true).custom_formatter(|x, _| format!("{:.2} %", x * 100.0)));
        ui.end_row();
        ui.label("Size of text and panels");
        ui.add(Slider::new(&mut v.ui_scale, 0.5..=2.5).step_by(0.05).update_while_editing(false));
        ui.end_row();
        ui.label("Opacity of panels");
        ui.add(Slider::new(&mut settings.hud.panel_opacity, 0.0..=1.0));
        ui.end_row();
        ui.label("Markers in the view");
        ui.checkbox(&mut settings.hud.markers, "");
        ui.end_row();
        ui.label("Wait for the display (vsync)");
        ui.checkbox(&mut v.vsync, "");
        ui.end_row();
        ui.label("Whole screen");
        ui.checkbox(&mut v.fullscreen, "");
        ui.end_row();
    });
}

fn sound(ui: &mut Ui, settings: &mut Settings) {
    let s = &mut settings.sound;
    egui::Grid::new("sound").num_columns(2).spacing([24.0, 8.0]).show(ui, |ui| {
        for (name, volume) in
            [("Everything", &mut s.master), ("Engine and thrusters", &mut s.engine), ("Wind", &mut s.wind), ("Warnings", &mut s.warning)]
        {
            ui.label(name);
            ui.add(Slider::new(volume, 0.0..=1.0).custom_formatter(|x, _| format!("{:.0} %", x * 100.0)));
            ui.end_row();
        }
    });
}
