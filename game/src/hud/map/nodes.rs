//! Planned burns on the map: where they stand, and the handles that change them.
//!
//! Six handles along the path's axes: drag one outward for more, or turn the wheel over it; drag the middle along the path for
//! another time. Not here: the panel with the numbers ([`super::editor`]).

use super::course::Course;
use super::lines::{Lines, Spot};
use super::path::{self, PLANNED, Track};
use super::{Chart, MapView, editor, format, style};
use crate::command::Node;
use crate::hud::Reply;
use crate::hud::ball::{Glyph, glyph};
use crate::world::ship::nodes::axes;
use egui::{Color32, CursorIcon, Id, Pos2, Rect, Sense, Stroke, Ui, Vec2};
use engine::space::relative::narrow;
use engine::time::Moment;
use glam::DVec3;

/// How far the handles stand from the middle, points.
const ARM: f32 = 54.0;
/// Points that a handle is dragged for one step.
const POINTS_PER_STEP: f64 = 6.0;
/// The handles: axis, sign, glyph, colour.
const HANDLES: [(usize, f64, Glyph, Color32); 6] = [
    (0, 1.0, Glyph::Prograde, Color32::from_rgb(180, 230, 90)),
    (0, -1.0, Glyph::Retrograde, Color32::from_rgb(180, 230, 90)),
    (1, 1.0, Glyph::Normal, Color32::from_rgb(206, 130, 255)),
    (1, -1.0, Glyph::Normal, Color32::from_rgb(150, 96, 186)),
    (2, 1.0, Glyph::Radial, Color32::from_rgb(96, 196, 255)),
    (2, -1.0, Glyph::Radial, Color32::from_rgb(70, 142, 186)),
];

/// Where a burn stands, and where its axes point, on the screen.
struct Stand {
    at: Pos2,
    axes: [Vec2; 3],
}

fn stand(chart: &Chart<'_, '_>, view: &MapView, course: &Course, lines: &Lines, node: &Node) -> Option<Stand> {
    let at = Moment::from(node.at);
    let (host, state) = course.state(at)?;
    let planned = course.parts_at.is_some_and(|p| at.since(p) >= 0.0);
    let ship_host = chart.world.ship.body();
    let put = |from_host: DVec3| {
        let (anchor, p) = lines.locate(&chart.world.system, view.frame, ship_host, Spot { host, at, from_host, planned });
        chart.place(&anchor, p)
    };
    let middle = put(state.position.0);
    // A kilometre along each axis shows where it points in whatever frame.
    let screen = axes(&state).map(|axis| {
        let d = (put(state.position.0 + axis * 1e3) - middle).normalize_or(DVec3::ZERO);
        Vec2::new(narrow(d.dot(chart.projection.right)), -narrow(d.dot(chart.projection.up)))
    });
    middle.is_finite().then(|| Stand { at: chart.projection.at(middle), axes: screen })
}

/// Draws the burns and hears their handles; true while one of them has the pointer.
#[allow(clippy::too_many_arguments)]
pub fn show(
    ui: &mut Ui,
    chart: &Chart<'_, '_>,
    view: &mut MapView,
    course: &Course,
    lines: &Lines,
    tracks: &[Track],
    taken: &mut Vec<Rect>,
    reply: &mut Reply,
) -> bool {
    let mut busy = false;
    for (i, node) in chart.world.ship.nodes.iter().enumerate() {
        let node = view.edit.shown(i, *node);
        let Some(stand) = stand(chart, view, course, lines, &node) else { continue };
        if !chart.rect.contains(stand.at) {
            continue;
        }
        let chosen = view.chosen == Some(i);
        if chosen {
            busy |= handles(ui, chart, view, (i, node), &stand, reply);
        }
        let response = ui.interact(Rect::from_center_size(stand.at, Vec2::splat(18.0)), Id::unique(("node", i)), Sense::click_and_drag());
        let colour = if chosen || response.hovered() { Color32::WHITE } else { PLANNED };
        chart.painter.circle_filled(stand.at, 6.5, Color32::from_rgb(5, 7, 11));
        chart.painter.circle_stroke(stand.at, 6.5, Stroke::new(2.0, colour));
        chart.painter.circle_filled(stand.at, 2.2, colour);
        let left = format::duration(node.at.since(chart.world.time));
        let size = format::speed(node.size_m_s());
        if !chosen {
            path::label(chart, stand.at, &format!("Burn {} {size}\nin {left}", i + 1), PLANNED, taken);
        }
        taken.push(Rect::from_center_size(stand.at, Vec2::splat(if chosen { 2.0 * ARM } else { 16.0 })));
        if response.clicked() {
            view.chosen = if chosen { None } else { Some(i) };
        }
        if response.hovered() || response.dragged() {
            busy = true;
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
            path::tip(
                chart,
                stand.at + Vec2::new(20.0, 0.0),
                &format!("Burn {}: {size}, in {left}\ndrag: another time · click: {}", i + 1, if chosen { "done" } else { "change" }),
            );
        }
        if let Some(p) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            view.chosen = Some(i);
            let (from, to) = editor::room(chart.world, i);
            let found = tracks.iter().filter(|t| t.planned == (i > 0)).filter_map(|t| t.nearest(p, from.into(), to.into()));
            if let Some((_, at, _)) = found.min_by(|a, b| a.0.total_cmp(&b.0)) {
                editor::change(chart.world, view, i, Node { at: at.next_tick(), ..node }, reply);
            }
        }
    }
    busy
}

/// The handles of the chosen burn; true while one has the pointer.
fn handles(ui: &Ui, chart: &Chart<'_, '_>, view: &mut MapView, (i, node): (usize, Node), stand: &Stand, reply: &mut Reply) -> bool {
    let mut busy = false;
    let mut more = DVec3::ZERO;
    let shift = ui.input(|s| s.modifiers.shift);
    let step = view.edit.step_m_s() * if shift { 0.1 } else { 1.0 };
    for (k, (axis, sign, kind, colour)) in HANDLES.into_iter().enumerate() {
        let along = stand.axes[axis] * narrow(sign);
        // An axis that points at the viewer still has a handle beside the middle.
        let arm = along * ARM + along.normalized() * if along.length() < 0.35 { 16.0 } else { 0.0 };
        let arm = if arm.length() < 14.0 { Vec2::angled(1.05 * narrow(f64::from(u8::try_from(k).unwrap_or(0)))) * 20.0 } else { arm };
        let at = stand.at + arm;
        let response = ui.interact(Rect::from_center_size(at, Vec2::splat(22.0)), Id::unique(("handle", k)), Sense::drag());
        let on = response.hovered() || response.dragged();
        chart
            .painter
            .line_segment([stand.at + arm.normalized() * 8.0, at - arm.normalized() * 9.0], Stroke::new(1.2, colour.gamma_multiply(0.7)));
        chart.painter.circle_filled(at, 9.5, Color32::from_rgb(10, 13, 18));
        glyph(chart.painter, at, if on { 10.0 } else { 8.0 }, kind, if on { Color32::WHITE } else { colour });
        let unit = DVec3::AXES[axis] * sign;
        if response.dragged() {
            more += unit * (f64::from(response.drag_delta().dot(arm.normalized())) / POINTS_PER_STEP * step);
        }
        if on {
            busy = true;
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
            more += unit * (notches(ui) * step);
            let value = node.parts_m_s().to_array()[axis];
            let name = editor::NAMES[axis];
            let text = format!(
                "{name} {}\ndrag or wheel: {} a step{}",
                editor::speed(value),
                editor::speed(step),
                if shift { "" } else { " · Shift: finer" }
            );
            path::tip(chart, at + arm.normalized() * 6.0, &text);
        }
    }
    if more != DVec3::ZERO {
        editor::change(chart.world, view, i, Node::new(node.at, node.parts_m_s() + more), reply);
    }
    if busy {
        chart.painter.circle_stroke(stand.at, ARM + 14.0, Stroke::new(1.0, style::LINE));
    }
    busy
}

/// Notches that the wheel was turned in this frame.
fn notches(ui: &Ui) -> f64 {
    ui.input(|i| {
        let turned = i.events.iter().filter_map(|e| match e {
            // Shift turns a wheel sideways on some systems.
            egui::Event::MouseWheel { delta, unit, .. } => {
                Some(f64::from(delta.x + delta.y) / if *unit == egui::MouseWheelUnit::Point { 50.0 } else { 1.0 })
            }
            _ => None,
        });
        turned.sum()
    })
}
