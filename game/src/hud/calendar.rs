//! The calendar of coming eclipses, from which a player goes to the place and minute of one.
//!
//! The search runs beside the window ([`Request::Eclipses`]); what it finds is put into [`State`]. A visit ([`Request::Visit`]) is a
//! new flight, as if a start file had named it. Not here: finding ([`crate::world::eclipse::almanac`]), the start itself
//! ([`crate::world::eclipse::visit`]).

use super::menu::page;
use super::{Hud, Reply, Request, Scene, format, style};
use crate::world::eclipse::almanac::{self, Event};
use crate::world::eclipse::visit::{self, Seat};
use crate::world::system::System;
use egui::{Align, Layout, RichText, Ui};
use engine::orbit::BodyId;
use engine::time::SimTime;

/// What the calendar shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// The body whose eclipses are listed, and from when on.
    pub asked: Option<(BodyId, SimTime)>,
    /// What was found; `None` while it is looked for.
    pub found: Option<Vec<Event>>,
    /// How much is done, 0 … 1.
    pub progress: f32,
}

/// A body where there is something to list: the flight's own if it has eclipses, else the first that has.
fn first_choice(system: &System, here: BodyId) -> Option<BodyId> {
    let all = almanac::receivers(system);
    all.iter().copied().find(|b| *b == here).or_else(|| all.first().copied())
}

fn ask(state: &mut State, on: BodyId, from: SimTime, reply: &mut Reply) {
    *state = State { asked: Some((on, from)), found: None, progress: 0.0 };
    reply.requests.push(Request::Eclipses(on, from));
}

/// The page.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, hud: &mut Hud, reply: &mut Reply) {
    let (system, now) = (&scene.world.system, scene.readout.time);
    if hud.calendar.asked.is_none()
        && let Some(on) = first_choice(system, scene.readout.body)
    {
        ask(&mut hud.calendar, on, now, reply);
    }
    let left = page(ctx, hud, "calendar", "Coming eclipses", |ui, hud| {
        let state = &mut hud.calendar;
        let Some((on, from)) = state.asked else {
            ui.label(style::note("In this system no body's shadow can fall on another."));
            return;
        };
        ui.horizontal_wrapped(|ui| {
            ui.label(style::note("on"));
            for body in almanac::receivers(system) {
                if ui.selectable_label(body == on, scene.name(body)).clicked() && body != on {
                    ask(state, body, now, reply);
                }
            }
        });
        ui.add_space(8.0);
        let Some(found) = state.found.clone() else {
            ui.add(egui::ProgressBar::new(state.progress).text("looking ahead"));
            return;
        };
        if found.is_empty() {
            ui.label(style::note(format!("None for {:.0} years from {}.", YEARS, from.utc())));
        }
        for event in &found {
            row(ui, scene, event, reply);
        }
        ui.horizontal(|ui| {
            if let Some(last) = found.last()
                && ui.button("Later").clicked()
            {
                ask(state, on, last.eclipse.greatest.next_tick(), reply);
            }
            if from != now && ui.button("From now").clicked() {
                ask(state, on, now, reply);
            }
        });
    });
    if left {
        hud.screen = hud.back();
    }
}

/// How far ahead is looked, years, and how many are listed.
pub const YEARS: f64 = 20.0;
/// Rows of a page.
pub const ROWS: usize = 40;

/// `2026-08-12 17:45:56 UTC   Total eclipse: Moon before Sun   65.2° N 25.2° W · 2:18   [On the ground] [From orbit]`.
fn row(ui: &mut Ui, scene: &Scene<'_>, event: &Event, reply: &mut Reply) {
    let system = &scene.world.system;
    let e = &event.eclipse;
    ui.horizontal(|ui| {
        ui.vertical(|ui| {
            ui.label(RichText::new(format!("{}   {}", e.greatest.tick.utc(), almanac::title(system, event))).font(style::words(14.0)));
            ui.label(style::note(detail(system, event)));
        });
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("From orbit").clicked() {
                reply.requests.push(Request::Visit(*event, Seat::Orbit));
            }
            if visit::has_ground(system, event) && ui.button("On the ground").clicked() {
                reply.requests.push(Request::Visit(*event, Seat::Ground));
            }
        });
    });
    ui.add_space(4.0);
}

fn detail(system: &System, event: &Event) -> String {
    let e = &event.eclipse;
    let solar = almanac::cast(system, event.on, event.by).is_some_and(|c| c.is_solar());
    let lasts = if e.duration_s > 0.0 { format!(" · {} long", format::duration(e.duration_s)) } else { String::new() };
    let magnitude = format::number(if e.magnitude > 0.0 { e.magnitude } else { e.penumbral_magnitude }, 3);
    if solar {
        format!("greatest at {} · magnitude {magnitude}{lasts}", format::place(e.place.lat_rad, e.place.lon_rad))
    } else {
        format!("magnitude {magnitude}{lasts}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{readout, run, world};
    use super::super::{Hud, Lists, Screen};
    use super::*;
    use crate::input::Input;
    use crate::settings::Settings;
    use engine::orbit::eclipse::{Eclipse, Kind, Place};
    use engine::time::Moment;

    fn event(on: BodyId, by: BodyId) -> Event {
        let t = Moment::from(SimTime::from_jd_tdb(2_461_265.241));
        let eclipse = Eclipse {
            kind: Kind::Total,
            greatest: t,
            light_s: 1.2,
            gamma: 0.9,
            magnitude: 1.0386,
            penumbral_magnitude: 1.0386,
            central: true,
            place: Place { lat_rad: 1.138, lon_rad: -0.44 },
            star_altitude_rad: 0.45,
            penumbra: [t.plus_s(-7e3), t.plus_s(7e3)],
            umbra: None,
            core: None,
            duration_s: 138.0,
        };
        Event { on, by, eclipse }
    }

    #[test]
    fn the_page_asks_once_and_lists_what_was_found() {
        let (world, shown) = (world(), readout());
        let mut hud = Hud { screen: Screen::Calendar, ..Hud::default() };
        let mut input = Input::new(crate::input::bindings::Bindings::default());
        let mut frame = |hud: &mut Hud| {
            let mut requests = Vec::new();
            let texts = run(|ctx| {
                let scene = Scene { readout: &shown, world: &world, snapshot: None };
                requests.extend(hud.show(ctx, Some(&scene), &Lists::default(), &mut Settings::default(), &mut input).requests);
            });
            (texts, requests)
        };
        // The fixture's star and rock: no third body, nothing to ask for.
        let (texts, requests) = frame(&mut hud);
        assert!(requests.is_empty() && texts.iter().any(|t| t.contains("no body's shadow")), "{texts:?}");
        hud.calendar = State { asked: Some((BodyId(1), shown.time)), found: Some(vec![event(BodyId(1), BodyId(1))]), progress: 1.0 };
        let (texts, _) = frame(&mut hud);
        assert!(texts.iter().any(|t| t.contains("2026-08-12 17:45")) && texts.iter().any(|t| t.contains("2:18 long")), "{texts:?}");
        assert!(texts.iter().any(|t| t.contains("From orbit")));
    }
}
