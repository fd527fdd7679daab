//! After a crash: how fast, the last seconds again, and where to go on from.

use super::panels::{area, row};
use super::{Hud, Reply, Request, Scene, Screen, format, menu, style};
use egui::{Align2, RichText, Slider};

/// How far back the view looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Review {
    /// Seconds before the impact that are shown; 0 is now.
    pub back_s: f64,
    /// The last seconds run by themselves.
    pub playing: bool,
}

/// Longest look back, s (what the recorder keeps).
pub const LONGEST_S: f64 = 20.0;

/// The screen.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, hud: &mut Hud, reply: &mut Reply) {
    let review = &mut hud.crash;
    if review.playing {
        review.back_s -= f64::from(ctx.input(|i| i.stable_dt).min(0.1));
        ctx.request_repaint();
        if review.back_s <= 0.0 {
            *review = Review::default();
        }
    }
    let mut leave = None;
    area(ctx, "crash", Align2::CENTER_BOTTOM, [0.0, -30.0], |ui| {
        style::panel(0.86).inner_margin(18).show(ui, |ui| {
            ui.set_width(430.0);
            ui.label(RichText::new("The ship is lost").font(style::words(24.0)).color(style::DANGER));
            let r = scene.readout;
            let limit = scene.world.ship.spec.limits.gear_impact_m_s;
            if let Some((speed, _)) = r.last_contact {
                row(ui, 430.0, "Impact", &format::speed(speed), style::TEXT);
            }
            row(ui, 430.0, "The gear bears", &format::speed(limit), style::TEXT);
            row(ui, 430.0, "Place", &format::place(r.lat_lon_rad.0, r.lat_lon_rad.1), style::TEXT);
            ui.horizontal(|ui| {
                if menu::offered(ui.button("The last seconds")).clicked() {
                    *review = Review { back_s: LONGEST_S, playing: true };
                }
                if ui.add(Slider::new(&mut review.back_s, 0.0..=LONGEST_S).text("s before")).changed() {
                    review.playing = false;
                }
            });
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                if ui.button("Quick load").clicked() {
                    reply.requests.push(Request::Quickload);
                }
                if ui.button("Newest save").clicked() {
                    reply.requests.push(Request::Continue);
                }
                if ui.button("Load …").clicked() {
                    leave = Some(Screen::Saves);
                }
                if ui.button("New flight").clicked() {
                    leave = Some(Screen::Starts);
                }
                if ui.button("Main menu").clicked() {
                    reply.requests.push(Request::Leave);
                }
            });
        });
    });
    if let Some(screen) = leave {
        hud.screen = screen;
    }
}
