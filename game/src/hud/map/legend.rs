//! The map's legend: numbers of the orbit, how far and in which frame the path is drawn, and where the map looks.

use super::course::Course;
use super::lines::Frame;
use super::{MapView, REVOLUTIONS, path};
use crate::command::Action;
use crate::hud::panels::{area, row};
use crate::hud::{Reply, Scene, format, style};
use crate::world::eclipse::Sky;
use egui::{Align2, RichText, Ui, Vec2};
use engine::orbit::BodyId;
use engine::orbit::predict::View;

const WIDTH: f32 = 210.0;

/// The legend.
pub fn show(
    ctx: &egui::Context,
    scene: &Scene<'_>,
    view: &mut MapView,
    focus: BodyId,
    course: Option<&Course>,
    opacity: f32,
    reply: &mut Reply,
) {
    let o = &scene.readout.orbit;
    area(ctx, "map legend", Align2::LEFT_TOP, [12.0, 12.0], |ui| {
        style::panel(opacity).show(ui, |ui| {
            ui.label(RichText::new(format!("Map · {}", scene.name(focus))).font(style::words(17.0)).color(style::TEXT));
            for (label, value) in [
                ("Apoapsis", format::length(o.apoapsis_m)),
                ("Periapsis", format::length(o.periapsis_m)),
                ("Period", format::duration(o.period_s)),
                ("Inclination", format!("{}°", format::number(o.inclination_rad.to_degrees(), 2))),
                ("Eccentricity", format::number(o.eccentricity, 4)),
            ] {
                row(ui, WIDTH, label, &value, style::TEXT);
            }
            if let Some(target) = &scene.readout.target {
                row(ui, WIDTH, scene.name(target.target.body), &format::length(target.distance_m), style::DANGER);
            }
            ui.horizontal(|ui| {
                if ui.button("Ship").clicked() {
                    (view.focus, view.pan, view.metres_per_point) = (None, Vec2::ZERO, 0.0);
                }
                let parent = scene.world.system.body(focus).parent;
                if ui.add_enabled(parent.is_some(), egui::Button::new("Outward")).clicked() {
                    view.focus = parent;
                    // So far off that the path of the body that was looked at fits.
                    let sky = Sky::at(&scene.world.system, scene.world.time);
                    let reach = parent.map_or(0.0, |p| (sky.position(focus) - sky.position(p)).length());
                    view.metres_per_point = reach / f64::from(0.42 * ctx.content_rect().height().max(1.0));
                    view.pan = Vec2::ZERO;
                }
                if ui.add_enabled(scene.readout.target.is_some(), egui::Button::new("No target")).clicked() {
                    reply.actions.push(Action::Target(None));
                }
            });
            ui.add_space(4.0);
            ui.label(style::heading("Path ahead"));
            ahead(ui, view, course);
            frame(ui, scene, view);
            ui.label(style::note(
                "drag: turn · right drag: pan · wheel: zoom\nclick: target · double click: look there\nclick the path: plan a burn",
            ));
        });
    });
}

/// How far the path is drawn, and what it took.
fn ahead(ui: &mut Ui, view: &mut MapView, course: Option<&Course>) {
    ui.horizontal(|ui| {
        if style::toggle(ui, false, " − ").on_hover_text("Fewer revolutions").clicked() {
            view.revolutions = view.revolutions.saturating_sub(1);
        }
        let n = view.looks_ahead();
        ui.label(RichText::new(format!("{n} revolution{}", if n == 1 { "" } else { "s" })).font(style::words(13.0)));
        if style::toggle(ui, false, " + ").on_hover_text("More revolutions").clicked() {
            view.revolutions = (view.revolutions + 1).min(REVOLUTIONS.len() - 1);
        }
        match course {
            Some(course) => {
                ui.label(RichText::new(format!("{} ms", format::number(course.cost_ms, 1))).font(style::mono(11.0)).color(style::DIM))
            }
            None => ui.label(style::note("none")),
        };
    });
    let planned = course.is_some_and(|c| c.planned.is_some());
    ui.horizontal(|ui| {
        ui.label(RichText::new("— now").font(style::words(12.0)).color(path::FREE));
        if planned {
            ui.label(RichText::new("— with the planned burns").font(style::words(12.0)).color(path::PLANNED));
        }
    });
}

/// The frame that the path is drawn in.
fn frame(ui: &mut Ui, scene: &Scene<'_>, view: &mut MapView) {
    let name = |frame: Frame| match frame {
        Frame::Patched => "each part about its own body".to_owned(),
        Frame::Of(v) => format!("all about {}", scene.name(v.body)),
    };
    let rotating = matches!(view.frame, Frame::Of(v) if v.rotating);
    egui::ComboBox::from_id_salt("map frame").width(WIDTH).selected_text(name(view.frame)).show_ui(ui, |ui| {
        ui.selectable_value(&mut view.frame, Frame::Patched, name(Frame::Patched));
        for i in 0..scene.world.system.bodies.len() {
            let body = BodyId(u16::try_from(i).unwrap_or(0));
            let frame = Frame::Of(View { body, rotating });
            ui.selectable_value(&mut view.frame, frame, name(frame));
        }
    });
    if let Frame::Of(v) = &mut view.frame {
        ui.checkbox(&mut v.rotating, format!("turning with {}", scene.name(v.body)));
    }
}
