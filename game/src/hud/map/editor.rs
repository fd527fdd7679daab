//! The panel and the keys of planned burns: the list, the numbers of the one that is chosen, and what is done with it.
//!
//! What is changed here is asked for as an [`Action`], so that it replays; until the World has heard it, the changed burn is shown
//! ([`Edit::shown`]). Keys: Insert plans one, Delete gives it up, `[` `]` choose, arrows choose a number and change it, as + and −
//! do; Shift is finer.

use super::course::Course;
use super::path::PLANNED;
use super::{MapView, format, style};
use crate::command::{Action, Guidance, Hold, MOST_NODES, Node};
use crate::hud::panels::{area, row};
use crate::hud::{Reply, Scene};
use crate::world::World;
use crate::world::ship::guidance::plan::lead_s;
use egui::{Align2, Key, RichText, Ui};
use engine::orbit::predict::Kind;
use engine::time::{Moment, SimTime, TICKS_PER_SECOND};
use engine::units::{DAY, HOUR, MINUTE};
use glam::DVec3;

/// What the three parts of a burn are called.
pub const NAMES: [&str; 3] = ["Prograde", "Normal", "Radial"];
/// Steps of the numbers: m/s, and seconds.
const STEPS: [(f64, f64); 6] = [(0.01, 0.1), (0.1, 1.0), (1.0, 10.0), (10.0, MINUTE), (100.0, 10.0 * MINUTE), (1_000.0, 6.0 * HOUR)];
/// Frames after which a change that the World did not take is forgotten.
const PATIENCE: u8 = 40;
const WIDTH: f32 = 236.0;

/// The editor's own state.
#[derive(Clone, Copy, Debug)]
pub struct Edit {
    /// Index into the steps.
    step: usize,
    /// The number that the keys change: 0, 1, 2 the parts, 3 the time.
    field: usize,
    /// What was asked for and is not yet in force.
    asked: Option<(usize, Node, u8)>,
    /// A burn was planned that the World has not heard of: frames to wait for it.
    awaited: u8,
}

impl Default for Edit {
    fn default() -> Self {
        Self { step: 2, field: 0, asked: None, awaited: 0 }
    }
}

impl Edit {
    /// Step of a part, m/s.
    pub fn step_m_s(&self) -> f64 {
        STEPS[self.step.min(STEPS.len() - 1)].0
    }
    /// Step of the time, s.
    fn step_s(&self) -> f64 {
        STEPS[self.step.min(STEPS.len() - 1)].1
    }
    /// A burn with what was asked for and is not yet in force.
    pub fn shown(&self, i: usize, node: Node) -> Node {
        self.asked.filter(|a| a.0 == i).map_or(node, |a| a.1)
    }
    /// The chosen burn, if there is one, or will be as soon as the World has heard of it.
    pub fn keeps(&mut self, chosen: Option<usize>, count: usize) -> Option<usize> {
        let there = chosen.is_some_and(|c| c < count);
        self.awaited = if there || chosen.is_none() { 0 } else { self.awaited.saturating_sub(1) };
        chosen.filter(|_| there || self.awaited > 0)
    }
    /// Forgets what is in force by now.
    fn settle(&mut self, world: &World) {
        self.asked = self.asked.and_then(|(i, node, left)| {
            let done = world.ship.nodes.get(i).is_none_or(|n| *n == node) || left == 0;
            (!done).then(|| (i, node, left - 1))
        });
    }
}

/// A speed to the centimetre where it is small.
pub fn speed(m_s: f64) -> String {
    if m_s.abs() < 99.995 { format!("{} m/s", format::number(m_s, 2)) } else { format::speed(m_s) }
}

/// Between which ticks a burn may be moved: after now and the one before it, before the next.
pub fn room(world: &World, i: usize) -> (SimTime, SimTime) {
    let nodes = &world.ship.nodes;
    let after = i.checked_sub(1).and_then(|b| nodes.get(b)).map_or(world.time, |n| n.at.max(world.time));
    let before = nodes.get(i + 1).map_or(world.time.plus(i64::from(u32::MAX) * TICKS_PER_SECOND), |n| n.at);
    (after.plus(TICKS_PER_SECOND), before.plus(-TICKS_PER_SECOND))
}

/// Asks for a change of a burn.
pub fn change(world: &World, view: &mut MapView, i: usize, node: Node, reply: &mut Reply) {
    let (from, to) = room(world, i);
    let node = Node { at: if from <= to { node.at.clamp(from, to) } else { from }, ..node };
    let number = u8::try_from(i).unwrap_or(u8::MAX);
    // One a frame: what was asked before is contained in it.
    reply.actions.retain(|a| !matches!(a, Action::ChangeNode(n, _) if *n == number));
    reply.actions.push(Action::ChangeNode(number, node));
    view.edit.asked = Some((i, node, PATIENCE));
}

/// Plans a burn of nothing at a moment, and chooses it.
pub fn add(world: &World, view: &mut MapView, at: SimTime, reply: &mut Reply) {
    if world.ship.nodes.len() >= MOST_NODES || at <= world.time.plus(1) {
        return;
    }
    reply.actions.push(Action::AddNode(Node { at, dv_mm_s: [0; 3] }));
    view.chosen = Some(world.ship.nodes.partition_point(|n| n.at <= at));
    (view.edit.asked, view.edit.awaited) = (None, PATIENCE);
    view.edit.field = 0;
}

/// When a burn is planned that no place was clicked for: at the next apoapsis or periapsis, else in ten minutes.
fn somewhere(world: &World, course: &Course, is: impl Fn(Kind) -> bool) -> SimTime {
    let earliest = world.time.plus(30 * TICKS_PER_SECOND);
    let found = course.next(world.time, is).map(Moment::next_tick).filter(|t| *t > earliest);
    found.unwrap_or_else(|| world.time.plus(600 * TICKS_PER_SECOND))
}

/// The panel.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, view: &mut MapView, course: &Course, opacity: f32, reply: &mut Reply) {
    let world = scene.world;
    view.edit.settle(world);
    keys(ctx, world, view, course, reply);
    area(ctx, "map burns", Align2::RIGHT_TOP, [-12.0, 12.0], |ui| {
        style::panel(opacity).show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.label(style::heading("Planned burns"));
            list(ui, world, view);
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 4.0;
                ui.label(style::note("Plan at"));
                if style::toggle(ui, false, "periapsis").clicked() {
                    add(world, view, somewhere(world, course, |k| k == Kind::Periapsis), reply);
                }
                if style::toggle(ui, false, "apoapsis").clicked() {
                    add(world, view, somewhere(world, course, |k| k == Kind::Apoapsis), reply);
                }
                if style::toggle(ui, false, "AN / DN").on_hover_text("The next crossing of the equator").clicked() {
                    add(world, view, somewhere(world, course, |k| matches!(k, Kind::AscendingNode | Kind::DescendingNode)), reply);
                }
            });
            if let Some(i) = view.chosen.filter(|c| *c < world.ship.nodes.len()) {
                ui.separator();
                chosen(ui, scene, view, i, reply);
            } else if world.ship.nodes.is_empty() {
                ui.label(style::note("Click the path, or press Insert."));
            }
        });
    });
}

fn list(ui: &mut Ui, world: &World, view: &mut MapView) {
    for (i, node) in world.ship.nodes.iter().enumerate() {
        let node = view.edit.shown(i, *node);
        let text = format!("{}   in {}   {}", i + 1, format::duration(node.at.since(world.time)), speed(node.size_m_s()));
        let on = view.chosen == Some(i);
        let text = RichText::new(text).font(style::mono(12.5)).color(if on { style::TEXT } else { PLANNED });
        if ui.selectable_label(on, text).clicked() {
            view.chosen = if on { None } else { Some(i) };
        }
    }
}

/// The numbers of the chosen burn, and what can be done with it.
fn chosen(ui: &mut Ui, scene: &Scene<'_>, view: &mut MapView, i: usize, reply: &mut Reply) {
    let world = scene.world;
    let Some(node) = world.ship.nodes.get(i).map(|n| view.edit.shown(i, *n)) else { return };
    let shift = ui.input(|s| s.modifiers.shift);
    let finer = if shift { 0.1 } else { 1.0 };
    let mut parts = node.parts_m_s().to_array();
    let mut later_s = 0.0;
    for (k, name) in NAMES.into_iter().enumerate() {
        let step = view.edit.step_m_s() * finer;
        number(ui, view.edit.field == k, name, |ui, sign| {
            if sign == 0.0 {
                let value = egui::DragValue::new(&mut parts[k]).speed(0.2 * step).max_decimals(3).range(-2.0e6..=2.0e6).suffix(" m/s");
                if ui.add_sized([96.0, 22.0], value).has_focus() {
                    view.edit.field = k;
                }
            } else {
                parts[k] += sign * step;
                view.edit.field = k;
            }
        });
    }
    number(ui, view.edit.field == 3, "Time", |ui, sign| {
        if sign == 0.0 {
            let text = format!("in {}", format::duration(node.at.since(world.time)));
            let label = egui::Label::new(RichText::new(text).font(style::mono(12.5)));
            ui.add_sized([96.0, 22.0], label).on_hover_text(node.at.utc().to_string());
        } else {
            later_s += sign * view.edit.step_s() * finer;
            view.edit.field = 3;
        }
    });
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.label(style::note("Step"));
        if style::toggle(ui, false, " − ").clicked() {
            view.edit.step = view.edit.step.saturating_sub(1);
        }
        let text = format!("{} m/s · {}", view.edit.step_m_s(), duration(view.edit.step_s()));
        ui.label(RichText::new(text).font(style::words(12.5)));
        if style::toggle(ui, false, " + ").clicked() {
            view.edit.step = (view.edit.step + 1).min(STEPS.len() - 1);
        }
    });
    let changed = Node { at: Moment::from(node.at).plus_s(later_s).tick, ..Node::new(node.at, DVec3::from_array(parts)) };
    if changed != node {
        change(world, view, i, changed, reply);
    }
    let ship = &world.ship;
    let burn_s = ship.burn_s(node.size_m_s());
    row(ui, WIDTH, "Delta-v", &speed(node.size_m_s()), if node.size_m_s() > ship.delta_v_m_s() { style::DANGER } else { style::TEXT });
    row(ui, WIDTH, "Burn", &format!("{} s", format::number(burn_s, 1)), style::TEXT);
    row(ui, WIDTH, "Starts in", &format::duration(ship.burn_start(&node).since(world.time)), style::TEXT);
    if let Some(told) = scene.readout.node.filter(|n| i == 0 && n.left_m_s < n.dv_m_s) {
        row(ui, WIDTH, "Left", &speed(told.left_m_s), style::GOOD);
    }
    buttons(ui, scene, view, i, &node, reply);
}

fn buttons(ui: &mut Ui, scene: &Scene<'_>, view: &mut MapView, i: usize, node: &Node, reply: &mut Reply) {
    let (world, r) = (scene.world, scene.readout);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let first = i == 0;
        ui.add_enabled_ui(first, |ui| {
            if style::toggle(ui, r.guidance == Guidance::Node, "Fly it").on_hover_text("The autopilot turns, burns and cuts off").clicked()
            {
                reply.actions.push(Action::Guidance(if r.guidance == Guidance::Node { Guidance::Manual } else { Guidance::Node }));
            }
            if style::toggle(ui, r.hold == Hold::Node, "Point").on_hover_text("Hold the nose along the burn").clicked() {
                reply.actions.push(Action::Hold(if r.hold == Hold::Node { Hold::Rate } else { Hold::Node }));
            }
        });
        if style::toggle(ui, world.warp_to.is_some(), "Warp there").on_hover_text("Runs the clock until a minute before the burn").clicked()
        {
            reply.actions.push(Action::WarpTo(if world.warp_to.is_some() { None } else { Some(before(world, node)) }));
        }
        if style::toggle(ui, false, "Delete").clicked() {
            remove(view, i, reply);
        }
    });
    if !r.guidance_phase.is_empty() && r.guidance == Guidance::Node {
        ui.label(RichText::new(r.guidance_phase).font(style::words(12.0)).color(style::GOOD));
    }
}

/// Where a hurry to a burn ends: before the ship has to turn for it.
#[allow(clippy::cast_possible_truncation)]
fn before(world: &World, node: &Node) -> SimTime {
    let lead = (lead_s(&world.ship) + 10.0).max(MINUTE);
    world.ship.burn_start(node).plus(-(lead as i64) * TICKS_PER_SECOND)
}

fn remove(view: &mut MapView, i: usize, reply: &mut Reply) {
    reply.actions.push(Action::DeleteNode(u8::try_from(i).unwrap_or(u8::MAX)));
    (view.chosen, view.edit.asked) = (None, None);
}

fn duration(s: f64) -> String {
    match s {
        _ if s < MINUTE => format!("{s} s"),
        _ if s < HOUR => format!("{} min", s / MINUTE),
        _ if s < DAY => format!("{} h", s / HOUR),
        _ => format!("{} d", s / DAY),
    }
}

/// A row: name, less, value, more. `act` is called with −1 or 1 when one was pressed, and with 0 to show the value.
fn number(ui: &mut Ui, on: bool, name: &str, mut act: impl FnMut(&mut Ui, f64)) {
    ui.allocate_ui_with_layout(egui::vec2(WIDTH, 24.0), egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let colour = if on { style::ACCENT } else { style::DIM };
        ui.add_sized([62.0, 22.0], egui::Label::new(RichText::new(name).font(style::words(12.5)).color(colour)));
        let small = |ui: &mut Ui, text: &str| ui.add_sized([26.0, 22.0], egui::Button::new(RichText::new(text).font(style::words(13.0))));
        if small(ui, "−").clicked() {
            act(ui, -1.0);
        }
        act(ui, 0.0);
        if small(ui, "+").clicked() {
            act(ui, 1.0);
        }
    });
}

/// The keys; only where no field has the keyboard.
fn keys(ctx: &egui::Context, world: &World, view: &mut MapView, course: &Course, reply: &mut Reply) {
    if ctx.memory(|m| m.focused().is_some()) {
        return;
    }
    let pressed = |key: Key| ctx.input(|i| i.key_pressed(key));
    let count = world.ship.nodes.len();
    if pressed(Key::Insert) {
        add(world, view, somewhere(world, course, |k| k == Kind::Apoapsis), reply);
    }
    if count > 0 && pressed(Key::CloseBracket) {
        view.chosen = Some(view.chosen.map_or(0, |c| (c + 1) % count));
    }
    if count > 0 && pressed(Key::OpenBracket) {
        view.chosen = Some(view.chosen.map_or(count - 1, |c| (c + count - 1) % count));
    }
    let Some((i, node)) = view.chosen.and_then(|i| Some((i, view.edit.shown(i, *world.ship.nodes.get(i)?)))) else { return };
    if pressed(Key::Delete) {
        return remove(view, i, reply);
    }
    if pressed(Key::ArrowDown) {
        view.edit.field = (view.edit.field + 1) % 4;
    }
    if pressed(Key::ArrowUp) {
        view.edit.field = (view.edit.field + 3) % 4;
    }
    let more = pressed(Key::ArrowRight) || pressed(Key::Plus) || pressed(Key::Equals);
    let less = pressed(Key::ArrowLeft) || pressed(Key::Minus);
    if more != less {
        let sign = if more { 1.0 } else { -1.0 } * if ctx.input(|s| s.modifiers.shift) { 0.1 } else { 1.0 };
        let changed = match view.edit.field {
            k @ 0..=2 => Node::new(node.at, node.parts_m_s() + DVec3::AXES[k] * (sign * view.edit.step_m_s())),
            _ => Node { at: Moment::from(node.at).plus_s(sign * view.edit.step_s()).tick, ..node },
        };
        change(world, view, i, changed, reply);
    }
}
