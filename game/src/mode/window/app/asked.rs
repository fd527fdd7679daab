//! What was asked for: controls of the view and the game, and the requests of menus. Commands of the ship do not pass here.

use super::{App, volumes};
use crate::command::Action;
use crate::hud::{Request, Screen, calendar};
use crate::input::controls::Control;
use crate::mode::open::Start;
use crate::mode::window::flight;
use crate::mode::window::job::{Job, Outcome};
use crate::save::slots::Kind;
use crate::world::World;
use crate::world::eclipse::almanac::{self, Event};
use crate::world::eclipse::visit::{self, Seat};
use crate::world::readout::Situation;
use engine::orbit::BodyId;
use engine::time::SimTime;
use std::path::PathBuf;

impl App {
    pub(super) fn load(&mut self, path: Option<PathBuf>) {
        let read = match path {
            Some(path) => flight::read(&self.slots, &path),
            None => self.slots.load_newest(None, &crate::save::decode).map_err(|e| e.to_string()),
        };
        match read {
            Ok(loaded) => {
                self.auto_save();
                self.straight_in = true;
                self.begin(Start::Save(Box::new(loaded)));
            }
            Err(e) => self.hud.message = Some(e),
        }
    }

    pub(super) fn quickload(&mut self) {
        match self.slots.load_newest(Some(&Kind::Quick), &crate::save::decode) {
            Ok(loaded) => {
                self.straight_in = true;
                self.begin(Start::Save(Box::new(loaded)));
            }
            Err(_) => self.hud.notice("There is no quick save yet"),
        }
    }

    /// A control of the view or the game.
    pub(super) fn control(&mut self, control: Control) {
        use Control as C;
        let screen = self.hud.screen;
        let flip = |to: Screen| if screen == to { Screen::Flight } else { to };
        match control {
            C::Pause if self.hud.help => self.hud.help = false,
            C::Pause if self.hud.message.is_some() => self.hud.message = None,
            C::Pause => match screen {
                Screen::Flight => self.hud.screen = Screen::Pause,
                Screen::Main | Screen::Crash => {}
                Screen::Starts | Screen::Calendar | Screen::Saves | Screen::Options => {
                    self.hud.screen = self.hud.back();
                    self.keep();
                }
                _ => self.hud.screen = Screen::Flight,
            },
            C::Help => self.hud.help = !self.hud.help,
            C::Map if screen.runs() => self.hud.screen = flip(Screen::Map),
            C::SurfaceMap if screen.runs() => self.hud.screen = flip(Screen::Surface),
            C::Photo if matches!(screen, Screen::Flight | Screen::Pause) => {
                self.hud.photo.enter();
                self.hud.screen = Screen::Photo;
            }
            C::Photo if screen == Screen::Photo => self.hud.screen = Screen::Flight,
            C::EditAir if matches!(screen, Screen::Flight | Screen::Pause | Screen::Photo) => self.edit_air(),
            C::EditAir if screen == Screen::Air => self.hud.screen = Screen::Flight,
            C::HideHud if screen == Screen::Air => self.hud.air.hidden = !self.hud.air.hidden,
            C::HideHud if screen == Screen::Photo => self.hud.photo.panel = !self.hud.photo.panel,
            C::HideHud => self.hud.hidden = !self.hud.hidden,
            C::Camera => self.request(Request::NextCamera),
            C::SavePicture => self.request(Request::Picture),
            C::Quicksave => self.request(Request::Quicksave),
            C::Quickload => self.request(Request::Quickload),
            _ => {}
        }
    }

    pub(super) fn request(&mut self, request: Request) {
        match request {
            Request::NewFlight(key) => {
                self.auto_save();
                self.straight_in = true;
                self.begin(Start::Named(key));
            }
            Request::Eclipses(on, from) => self.look_for_eclipses(on, from),
            Request::Visit(event, seat) => self.visit(&event, seat),
            Request::Load(path) => self.load(Some(path)),
            Request::Continue => self.load(None),
            Request::SaveAs(name) => {
                if let Some(flight) = &self.flight {
                    let text = flight.save(&self.slots, &Kind::Named(name));
                    self.hud.notice(text);
                    self.lists = flight::lists(&self.opening.assets, &self.slots);
                }
            }
            Request::Leave => {
                self.auto_save();
                self.hud.screen = Screen::Main;
                self.lists = flight::lists(&self.opening.assets, &self.slots);
            }
            Request::Quit => {
                self.keep();
                self.quitting = true;
            }
            Request::Apply => self.apply(),
            Request::Keep => self.keep(),
            Request::Picture => {
                let text = self.save_picture().unwrap_or_else(|e| format!("No picture was saved: {e}"));
                self.hud.notice(text);
            }
            Request::EditAir => self.edit_air(),
            Request::SaveAir => self.save_air(),
            Request::NextCamera => {
                if let Some(flight) = &mut self.flight {
                    let name = flight.next_camera();
                    self.hud.notice(name);
                }
            }
            Request::Quicksave => self.clicked.push(Action::Quicksave),
            Request::Quickload if self.hud.screen.runs() => self.clicked.push(Action::Quickload),
            Request::Quickload => {
                // The World stands still: let one tick take the session's own slot back, as if it had been pressed in flight.
                self.hud.screen = Screen::Flight;
                self.clicked.push(Action::Quickload);
            }
        }
    }

    fn look_for_eclipses(&mut self, on: BodyId, from: SimTime) {
        let Some(flight) = &self.flight else { return };
        let system = flight.session.world.system.clone();
        let days = calendar::YEARS * 365.25;
        self.eclipses = Some(Job::spawn(move |progress| {
            almanac::coming(&system, on, from, days, calendar::ROWS, &|fraction| progress(fraction, "eclipses"))
        }));
    }

    /// Hears from the search for eclipses; a later question has put away an earlier one.
    pub(super) fn hear_eclipses(&mut self) {
        let Some(job) = &mut self.eclipses else { return };
        let found = match job.poll() {
            Outcome::Running => {
                self.hud.calendar.progress = job.fraction;
                return;
            }
            Outcome::Done(found) => found,
            Outcome::Died => Vec::new(),
        };
        self.eclipses = None;
        self.hud.calendar.found = Some(found);
    }

    /// A new flight, in the same ship, at the place and minute of an eclipse.
    fn visit(&mut self, event: &Event, seat: Seat) {
        let Some(flight) = &self.flight else { return };
        let (system, ship) = (flight.session.world.system.clone(), flight.session.world.ship.spec.clone());
        let Some(start) = visit::start(&system, event, &ship.key, seat) else { return };
        self.auto_save();
        self.straight_in = true;
        self.world = Some(Job::spawn(move |_| match World::from_start(system, ship, &start) {
            Ok(world) => Ok((world, Vec::new())),
            Err(e) => Err(e.to_string()),
        }));
    }

    pub(super) fn apply(&mut self) {
        if let Some(canvas) = &mut self.canvas {
            canvas.apply(&self.settings.video);
        }
        self.input.bindings = self.settings.controls.clone();
        if let Some(sound) = &mut self.sound {
            sound.set_volumes(&volumes(&self.settings));
        }
    }

    pub(super) fn keep(&mut self) {
        if let Err(e) = self.settings.save(&self.opening.data) {
            self.hud.notice(e.to_string());
            eprintln!("warning: {e}");
        }
    }

    pub(super) fn auto_save(&mut self) {
        // The flight behind the main menu and its pages is a picture, not a flight; and nobody wants to go on with a wreck.
        let flying = match self.hud.screen {
            Screen::Main => false,
            Screen::Starts | Screen::Calendar | Screen::Saves | Screen::Options => self.hud.menu.flying,
            _ => true,
        };
        if let Some(flight) = self.flight.as_ref().filter(|f| flying && f.readout.situation != Situation::Crashed) {
            let text = flight.save(&self.slots, &Kind::Auto);
            if text.starts_with("Not") {
                eprintln!("warning: {text}");
            }
            self.hud.notice(text);
        }
    }
}
