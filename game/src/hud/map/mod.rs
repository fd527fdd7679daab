//! The orbit map: bodies and their orbits, the ship's path ahead under all forces, planned burns and what follows from them.
//!
//! - [`projection`]: from metres to the screen
//! - [`bodies`]: discs, names, orbits
//! - [`course`]: the prediction, kept while nothing changes; [`lines`]: the same as lines in the chosen frame
//! - [`path`]: how the path and what happens on it are drawn; [`nodes`]: planned burns and their handles
//! - [`editor`]: the panel and the keys of planned burns; [`legend`]: numbers, frame and buttons
//!
//! Click a body: target; double click: look there. Click the path: plan a burn.

pub mod bodies;
pub mod course;
pub mod editor;
pub mod legend;
pub mod lines;
pub mod nodes;
pub mod path;
pub mod projection;

use super::{Reply, Scene, format, style};
use crate::command::{Action, Target};
use crate::world::World;
use crate::world::eclipse::Sky;
use course::{Course, Kept};
use egui::{Color32, Painter, Rect, Sense, Stroke, Vec2};
use engine::orbit::BodyId;
use engine::orbit::predict::View;
use engine::space::relative::narrow;
use engine::time::Moment;
use glam::{DQuat, DVec3};
use lines::{Anchor, Frame, Lines};
use projection::Projection;
use std::sync::Arc;

/// Numbers of revolutions that can be looked ahead.
pub const REVOLUTIONS: [u32; 8] = [1, 2, 3, 5, 10, 20, 50, 100];

/// Where the map looks, and what it keeps between frames.
#[derive(Debug)]
pub struct MapView {
    yaw: f64,
    pitch: f64,
    metres_per_point: f64,
    focus: Option<BodyId>,
    pan: Vec2,
    /// The frame that the path is drawn in.
    pub frame: Frame,
    /// Index into [`REVOLUTIONS`].
    pub revolutions: usize,
    /// The planned burn that is being edited.
    pub chosen: Option<usize>,
    /// The editor's own state.
    pub edit: editor::Edit,
    kept: Kept,
    lines: Option<(u64, Frame, BodyId, Arc<Lines>)>,
}

impl Default for MapView {
    fn default() -> Self {
        Self {
            yaw: 0.6,
            pitch: 0.9,
            metres_per_point: 0.0,
            focus: None,
            pan: Vec2::ZERO,
            frame: Frame::Patched,
            revolutions: 1,
            chosen: None,
            edit: editor::Edit::default(),
            kept: Kept::default(),
            lines: None,
        }
    }
}

/// What is drawn on in a frame of the screen.
pub struct Chart<'a, 'b> {
    /// The truth.
    pub world: &'a World,
    /// What the World told.
    pub scene: &'a Scene<'b>,
    /// Where the bodies are now.
    pub sky: &'a Sky,
    /// From metres to the screen.
    pub projection: Projection,
    /// Paints.
    pub painter: &'a Painter,
    /// The map's rectangle.
    pub rect: Rect,
    /// The body in the middle.
    pub focus: BodyId,
    /// The turning axes of the frame's body now.
    pub turn: DQuat,
}

impl Chart<'_, '_> {
    /// A body, from the focus, m.
    pub fn offset(&self, body: BodyId) -> DVec3 {
        (self.sky.position(body) - self.sky.position(self.focus)).0
    }
    /// A point of a line, from the focus, m.
    pub fn place(&self, anchor: &Anchor, p: DVec3) -> DVec3 {
        self.offset(anchor.body) + anchor.base + if anchor.turning { self.turn * p } else { p }
    }
}

/// The map's screen.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, view: &mut MapView, opacity: f32, reply: &mut Reply) {
    let world = scene.world;
    let rigid = world.rigid();
    let known = |b: BodyId| b.index() < world.system.bodies.len();
    let focus = view.focus.filter(|f| known(*f)).unwrap_or(rigid.body);
    if matches!(view.frame, Frame::Of(v) if !known(v.body)) {
        view.frame = Frame::Patched;
    }
    let sky = Sky::at(&world.system, world.time);
    let course = view.course(ctx, world);
    let lines = course.as_ref().map(|c| view.lines(world, c, rigid.body));
    view.chosen = view.chosen.filter(|c| *c < world.ship.nodes.len());

    let screen = ctx.content_rect();
    egui::Area::new(egui::Id::unique("map")).fixed_pos(screen.min).order(egui::Order::Background).fade_in(false).show(ctx, |ui| {
        let (rect, response) = ui.allocate_exact_size(screen.size(), Sense::click_and_drag());
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0, Color32::from_rgb(5, 7, 11));
        view.measure(world, focus, rect);
        let turn = match view.frame {
            Frame::Of(View { body, rotating: true }) => sky.axes(&world.system, body).0,
            _ => DQuat::IDENTITY,
        };
        let chart = Chart { world, scene, sky: &sky, projection: view.projection(rect), painter: &painter, rect, focus, turn };
        let mut hits = Vec::new();
        for (i, body) in world.system.bodies.iter().enumerate() {
            let id = BodyId(u16::try_from(i).unwrap_or(0));
            if let Some(parent) = body.parent {
                bodies::orbit_of(&painter, &chart.projection, world, &sky, id, parent, chart.offset(parent));
            }
            hits.push((id, bodies::draw_body(&painter, &chart.projection, world, &sky, id, chart.offset(id), scene.name(id), rect)));
        }
        let mut busy = false;
        let mut on_path = None;
        if let (Some(course), Some(lines)) = (&course, &lines) {
            let tracks = path::draw(&chart, lines);
            let mut taken = Vec::new();
            busy = nodes::show(ui, &chart, view, course, lines, &tracks, &mut taken, reply);
            let pointer = response.hover_pos().filter(|_| !busy && !response.dragged());
            let flagged = path::flags(&chart, lines, pointer, &mut taken);
            on_path = pointer.filter(|_| !flagged).and_then(|p| path::near(&tracks, p, Moment::from(world.time)));
        }
        let ship = chart.projection.at(chart.offset(rigid.body) + rigid.state.position.0);
        painter.circle_filled(ship, 4.0, style::ACCENT);
        painter.circle_stroke(ship, 7.5, Stroke::new(1.2, style::ACCENT));
        let over = response.hover_pos().and_then(|p| {
            let near = hits.iter().filter(|(_, (at, r))| at.distance(p) < r.max(12.0));
            near.min_by(|a, b| a.1.1.total_cmp(&b.1.1)).map(|(id, _)| *id)
        });
        if let (Some((at, spot)), false) = (on_path, response.double_clicked()) {
            painter.circle_stroke(spot, 5.0, Stroke::new(1.5, Color32::WHITE));
            let text = format!("in {}\nclick: plan a burn here", format::duration(at.since(world.time.into())));
            path::tip(&chart, spot, &text);
            if response.clicked() {
                editor::add(world, view, at.next_tick(), reply);
            }
        } else if let Some(id) = over {
            if response.double_clicked() {
                view.focus = Some(id);
                view.pan = Vec2::ZERO;
                view.metres_per_point = 0.0;
            } else if response.clicked() {
                reply.actions.push(Action::Target(Some(Target { body: id, spot: None })));
            }
        } else if response.clicked() {
            view.chosen = None;
        }
        if !busy {
            view.steer(ui, &response);
        }
    });
    legend::show(ctx, scene, view, focus, course.as_deref(), opacity, reply);
    if let Some(course) = &course {
        editor::show(ctx, scene, view, course, opacity, reply);
    }
}

impl MapView {
    /// Nearer (below 1) or farther.
    pub fn zoom(&mut self, factor: f64) {
        self.metres_per_point = (self.metres_per_point * factor).clamp(10.0, 3.0e10);
    }

    /// True while a planned burn is being edited: the keys are the editor's, not the ship's.
    pub fn editing(&self) -> bool {
        self.chosen.is_some()
    }

    /// How many revolutions the path is drawn ahead.
    pub fn looks_ahead(&self) -> u32 {
        REVOLUTIONS.get(self.revolutions).copied().unwrap_or(1)
    }

    /// The prediction for this frame.
    fn course(&mut self, ctx: &egui::Context, world: &World) -> Option<Arc<Course>> {
        let target = world.target.map(|t| t.body);
        let revolutions = self.looks_ahead();
        self.kept.course(ctx, world, revolutions, target)
    }

    /// Its lines in the chosen frame.
    fn lines(&mut self, world: &World, course: &Course, host: BodyId) -> Arc<Lines> {
        match &self.lines {
            Some((made, frame, of, lines)) if (*made, *frame, *of) == (self.kept.made, self.frame, host) => lines.clone(),
            _ => {
                let lines = Arc::new(Lines::new(&world.system, course, self.frame, host));
                self.lines = Some((self.kept.made, self.frame, host, lines.clone()));
                lines
            }
        }
    }

    /// Chooses a scale where there is none: what the focus is about fits.
    fn measure(&mut self, world: &World, focus: BodyId, rect: Rect) {
        if self.metres_per_point <= 0.0 {
            let reach = if focus == world.ship.body() { world.rigid().state.position.length() } else { 0.0 };
            let reach = reach.max(world.system.body(focus).radius_m) * 1.25;
            self.metres_per_point = reach / f64::from(0.42 * rect.height().max(1.0));
        }
    }

    fn steer(&mut self, ui: &egui::Ui, response: &egui::Response) {
        if response.dragged_by(egui::PointerButton::Primary) {
            let d = response.drag_delta();
            self.yaw -= f64::from(d.x) * 0.006;
            self.pitch = (self.pitch + f64::from(d.y) * 0.006).clamp(-1.57, 1.57);
        } else if response.dragged() {
            self.pan += response.drag_delta();
        }
        let scroll = ui.input(|i| i.smooth_scroll_delta.y);
        if response.hovered() && scroll != 0.0 {
            let factor = libm::exp(-f64::from(scroll) * 0.003);
            self.zoom(factor);
            self.pan *= narrow(1.0 / factor);
        }
    }

    fn projection(&self, rect: Rect) -> Projection {
        let (sy, cy) = libm::sincos(self.yaw);
        let (sp, cp) = libm::sincos(self.pitch);
        // Looking down from the north at pitch π/2.
        let towards = DVec3::new(cp * sy, -cp * cy, sp);
        let right = DVec3::new(cy, sy, 0.0);
        Projection { centre: rect.center() + self.pan, scale: self.metres_per_point, right, up: towards.cross(right), towards }
    }
}
