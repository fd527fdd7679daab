//! The HUD: panels, menus, maps. Each is a function of what the World told ([`Scene`]) and answers with what was clicked:
//! [`Action`]s, which go into the tick's commands and are recorded with it, and [`Request`]s, which change no bit of the
//! World (menus, files, cameras).
//!
//! Read [`Hud::show`] for what stands on which screen. Not here: windows and textures ([`crate::mode`]), the bindings
//! themselves ([`crate::input`]).

pub mod air;
pub mod ball;
pub mod calendar;
pub mod conic;
pub mod controls;
pub mod crash;
pub mod flight;
pub mod format;
pub mod help;
pub mod loading;
pub mod map;
pub mod markers;
pub mod menu;
pub mod options;
pub mod panels;
pub mod photo;
pub mod style;
pub mod surface;

#[cfg(test)]
pub mod testing;

use crate::command::Action;
use crate::input::Input;
use crate::settings::Settings;
use crate::world::World;
use crate::world::eclipse::almanac::Event;
use crate::world::eclipse::visit::Seat;
use crate::world::readout::Readout;
use engine::orbit::BodyId;
use engine::scene::Snapshot;
use engine::time::SimTime;
use std::path::PathBuf;

/// Which screen is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Screen {
    /// The main menu.
    #[default]
    Main,
    /// Choosing a start.
    Starts,
    /// Choosing a save.
    Saves,
    /// The calendar of eclipses.
    Calendar,
    /// Settings.
    Options,
    /// Flying.
    Flight,
    /// The pause menu.
    Pause,
    /// The orbit map.
    Map,
    /// The surface map.
    Surface,
    /// Photo mode.
    Photo,
    /// The editor of airs.
    Air,
    /// After a crash.
    Crash,
}

impl Screen {
    /// True while the World goes on.
    pub const fn runs(self) -> bool {
        matches!(self, Self::Flight | Self::Map | Self::Surface)
    }
}

/// Something asked for that is no command of the World.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Begin a new flight at this start.
    NewFlight(String),
    /// Look for the eclipses on a body from a time on.
    Eclipses(BodyId, SimTime),
    /// Begin a new flight at the place and minute of an eclipse.
    Visit(Event, Seat),
    /// Load this save.
    Load(PathBuf),
    /// Load the newest save.
    Continue,
    /// Keep the flight under a name.
    SaveAs(String),
    /// Write the automatic save and go to the main menu.
    Leave,
    /// Close the program.
    Quit,
    /// The settings were changed: put them in force.
    Apply,
    /// The settings screen was left: keep them.
    Keep,
    /// Save a picture.
    Picture,
    /// Edit the air of the body that the ship is at.
    EditAir,
    /// Write the edited air into its file.
    SaveAir,
    /// The next camera.
    NextCamera,
    /// Quick save.
    Quicksave,
    /// Quick load.
    Quickload,
}

/// A start that can be chosen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StartEntry {
    /// Key.
    pub key: String,
    /// Name.
    pub name: String,
    /// One line.
    pub description: String,
}

/// A save that can be chosen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SaveEntry {
    /// File.
    pub path: PathBuf,
    /// Name or kind.
    pub title: String,
    /// Date, body, altitude.
    pub detail: String,
    /// Why it cannot be loaded.
    pub damage: Option<String>,
}

/// What a frame of the HUD is made of.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// What the World tells.
    pub readout: &'a Readout,
    /// The World, for maps and names.
    pub world: &'a World,
    /// The picture behind the HUD.
    pub snapshot: Option<&'a Snapshot>,
}

impl Scene<'_> {
    /// Display name of a body.
    pub fn name(&self, body: BodyId) -> &str {
        self.name_of(body.0)
    }
    fn name_of(&self, index: u16) -> &str {
        self.world.system.bodies.get(usize::from(index)).map_or("?", |b| b.name.as_str())
    }
}

/// What the menus know.
#[derive(Clone, Debug, Default)]
pub struct Lists {
    /// Starts.
    pub starts: Vec<StartEntry>,
    /// Saves, newest first.
    pub saves: Vec<SaveEntry>,
}

/// What was clicked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reply {
    /// Commands for the next tick.
    pub actions: Vec<Action>,
    /// Everything else.
    pub requests: Vec<Request>,
}

/// The state of the HUD itself: which screen, which page, where the map looks.
#[derive(Debug, Default)]
pub struct Hud {
    /// The screen shown.
    pub screen: Screen,
    /// The help overlay lies over it.
    pub help: bool,
    /// The player hid the HUD.
    pub hidden: bool,
    /// Flight panels.
    pub flight: flight::State,
    /// Orbit map.
    pub map: map::MapView,
    /// Surface map.
    pub surface: surface::SurfaceView,
    /// Photo mode.
    pub photo: photo::Photo,
    /// Editor of airs.
    pub air: air::Editor,
    /// Crash screen.
    pub crash: crash::Review,
    /// Settings screen.
    pub options: options::State,
    /// Calendar of eclipses.
    pub calendar: calendar::State,
    /// Menus.
    pub menu: menu::State,
    /// Small notices, each with the seconds that it still stays.
    pub notices: Vec<(String, f32)>,
    /// How much of the bodies' paths has been worked out, 0 … 1, while that goes on.
    pub paths_ahead: Option<f32>,
    /// What is wrong with changed files, shown until they are mended.
    pub fault: Option<String>,
    /// A message that waits for a click.
    pub message: Option<String>,
}

impl Hud {
    /// Shows a small notice for some seconds.
    pub fn notice(&mut self, text: impl Into<String>) {
        let text = text.into();
        tracing::info!("{text}");
        self.notices.retain(|(t, _)| *t != text);
        self.notices.push((text, 6.0));
        if self.notices.len() > 5 {
            self.notices.remove(0);
        }
    }

    /// Says once that files hold what can be used and is hardly meant; the log has it in full.
    pub fn warn(&mut self, warnings: &[String]) {
        for warning in warnings {
            tracing::warn!("{warning}");
        }
        if let Some(first) = warnings.first().and_then(|w| w.lines().next()) {
            let more = if warnings.len() > 1 { format!(" (and {} more)", warnings.len() - 1) } else { String::new() };
            self.notice(format!("{first}{more}"));
        }
    }

    /// One frame. `scene` is there while a flight is.
    pub fn show(
        &mut self,
        ctx: &egui::Context,
        scene: Option<&Scene<'_>>,
        lists: &Lists,
        settings: &mut Settings,
        input: &mut Input,
    ) -> Reply {
        let mut reply = Reply::default();
        let opacity = settings.hud.panel_opacity;
        match (self.screen, scene) {
            (Screen::Main, _) => menu::main(ctx, self, lists, &mut reply),
            (Screen::Starts, _) => menu::starts(ctx, self, lists, &mut reply),
            (Screen::Saves, _) => menu::saves(ctx, self, lists, &mut reply),
            (Screen::Options, _) => options::show(ctx, self, settings, input, &mut reply),
            (_, None) => self.screen = Screen::Main,
            (Screen::Flight, Some(scene)) if !self.hidden => {
                flight::show(ctx, scene, &mut self.flight, settings, &mut reply);
            }
            (Screen::Flight, Some(_)) => {}
            (Screen::Pause, Some(_)) => menu::pause(ctx, self, &mut reply),
            (Screen::Map, Some(scene)) => {
                map::show(ctx, scene, &mut self.map, opacity, &mut reply);
                flight::clock(ctx, scene, opacity, &mut reply);
            }
            (Screen::Surface, Some(scene)) => {
                surface::show(ctx, scene, &mut self.surface, opacity, &mut reply);
                flight::clock(ctx, scene, opacity, &mut reply);
            }
            (Screen::Calendar, Some(scene)) => calendar::show(ctx, scene, self, &mut reply),
            (Screen::Photo, Some(scene)) => photo::show(ctx, scene, &mut self.photo, &mut reply),
            (Screen::Air, Some(scene)) => {
                let body = scene.world.system.find(self.air.draft.as_ref().map_or("", |d| d.body.as_str()));
                let name = body.map_or("", |b| scene.name(b));
                air::show(ctx, &mut self.air, name, &mut self.screen, &mut reply);
            }
            (Screen::Crash, Some(scene)) => crash::show(ctx, scene, self, &mut reply),
        }
        if self.help {
            help::show(ctx, &input.bindings, opacity, &mut self.help);
        }
        self.show_notices(ctx);
        reply
    }

    fn show_notices(&mut self, ctx: &egui::Context) {
        let dt = ctx.input(|i| i.unstable_dt).min(2.0);
        for (_, left) in &mut self.notices {
            *left -= dt;
        }
        self.notices.retain(|(_, left)| *left > 0.0);
        // Beside the editor's panel, which is read at the same time.
        let beside = self.screen == Screen::Air && !self.air.hidden;
        if !self.notices.is_empty() {
            let (corner, offset) =
                if beside { (egui::Align2::LEFT_BOTTOM, [10.0, -10.0]) } else { (egui::Align2::CENTER_BOTTOM, [0.0, -250.0]) };
            panels::area(ctx, "notices", corner, offset, |ui| {
                for (text, left) in &self.notices {
                    let fade = left.clamp(0.0, 1.0);
                    style::panel(0.75 * fade).show(ui, |ui| ui.label(egui::RichText::new(text).color(style::TEXT.gamma_multiply(fade))));
                }
            });
        }
        if let Some(text) = &self.fault {
            let (corner, offset) = if beside { (egui::Align2::LEFT_TOP, [10.0, 10.0]) } else { (egui::Align2::CENTER_TOP, [0.0, 104.0]) };
            let room = if beside { ctx.content_rect().width() - air::WIDTH - 70.0 } else { 760.0 };
            panels::area(ctx, "fault", corner, offset, |ui| {
                style::panel(0.92).show(ui, |ui| {
                    ui.set_max_width(room.clamp(240.0, 760.0));
                    ui.label(egui::RichText::new("A changed file is broken; the last good one stays in force").color(style::DANGER));
                    ui.label(egui::RichText::new(text).font(style::mono(12.0)));
                });
            });
        }
        let Some(text) = self.message.clone() else { return };
        let modal = egui::Modal::new(egui::Id::unique("message")).frame(style::panel(0.97)).show(ctx, |ui| {
            ui.set_max_width(620.0);
            ui.label(style::title("Syzygy"));
            ui.add_space(6.0);
            ui.label(egui::RichText::new(text).font(style::mono(13.0)));
            ui.add_space(10.0);
            menu::offered(ui.button("Close")).clicked()
        });
        if modal.inner || modal.should_close() {
            self.message = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::{extremes, readout, run, world};
    use super::*;

    #[test]
    fn no_screen_panics_on_any_readout_and_none_shows_nan() {
        let world = world();
        let mut input = Input::new(crate::input::bindings::Bindings::default());
        let mut settings = Settings::default();
        let lists = Lists {
            starts: vec![StartEntry { key: "a".into(), name: "A".into(), description: "b".into() }],
            saves: vec![
                SaveEntry { title: "Quick".into(), ..SaveEntry::default() },
                SaveEntry { damage: Some("the checksum differs".into()), ..SaveEntry::default() },
            ],
        };
        let screens = [
            Screen::Main,
            Screen::Starts,
            Screen::Calendar,
            Screen::Saves,
            Screen::Options,
            Screen::Flight,
            Screen::Pause,
            Screen::Map,
            Screen::Surface,
            Screen::Photo,
            Screen::Air,
            Screen::Crash,
        ];
        for shown in std::iter::once(readout()).chain(extremes()) {
            for screen in screens {
                let mut hud = Hud { screen, help: screen == Screen::Flight, ..Hud::default() };
                hud.notice("a notice");
                hud.fault = Some("body.toml:3: not TOML".to_owned());
                let texts = run(|ctx| {
                    let scene = Scene { readout: &shown, world: &world, snapshot: None };
                    hud.show(ctx, Some(&scene), &lists, &mut settings, &mut input);
                });
                for text in &texts {
                    let odd = text.split_whitespace().any(|w| matches!(w.to_ascii_lowercase().as_str(), "nan" | "inf" | "-inf" | "-nan"));
                    assert!(!odd, "{screen:?}: {text}");
                }
                assert!(!texts.is_empty(), "{screen:?} shows something");
            }
        }
    }

    #[test]
    fn without_a_flight_every_flight_screen_falls_back_to_the_menu() {
        let mut input = Input::new(crate::input::bindings::Bindings::default());
        let mut hud = Hud { screen: Screen::Map, ..Hud::default() };
        run(|ctx| _ = hud.show(ctx, None, &Lists::default(), &mut Settings::default(), &mut input));
        assert_eq!(hud.screen, Screen::Main);
    }
}
