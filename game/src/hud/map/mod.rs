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

use super::surface::SurfaceView;
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
    globe: SurfaceView,
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
            globe: SurfaceView::default(),
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
    view.chosen = view.edit.keeps(view.chosen, world.ship.nodes.len());

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
        let globe = world.system.body(focus).relief.is_some() && chart.projection.points(world.system.body(focus).radius_m) > bodies::GLOBE;
        let picture = if globe { view.globe.picture(ctx, scene, focus) } else { None };
        let mut hits = Vec::new();
        for (i, body) in world.system.bodies.iter().enumerate() {
            let id = BodyId(u16::try_from(i).unwrap_or(0));
            if let Some(parent) = body.parent {
                bodies::orbit_of(&painter, &chart.projection, world, &sky, id, parent, chart.offset(parent));
            }
            hits.push((id, bodies::draw_body(&chart, id, picture.filter(|_| id == focus))));
        }
        let mut busy = false;
        let mut on_path = None;
        if let (Some(course), Some(lines)) = (&course, &lines) {
            let tracks = path::draw(&chart, lines);
            let mut taken = Vec::new();
            busy = nodes::show(ui, &chart, view, course, lines, &tracks, &mut taken, reply);
            let pointer = response.hover_pos().filter(|_| !busy && !response.dragged());
            let flagged = path::flags(&chart, lines, pointer, &mut taken);
            on_path = pointer.filter(|_| !flagged).and_then(|p| path::near(&tracks, p, Moment::from(world.time), course.parts_at));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Guidance, Hold, Node};
    use crate::hud::testing::{extremes, readout, run, run_at, world};
    use engine::time::TICKS_PER_SECOND;

    /// A low orbit with two planned burns.
    fn planned() -> World {
        let mut world = world();
        let at = |s: i64| world.time.plus(s * TICKS_PER_SECOND);
        let nodes = [Node::new(at(1_000), DVec3::new(120.0, 0.0, -3.0)), Node::new(at(4_000), DVec3::new(0.0, 60.0, 0.0))];
        world.ship.nodes = nodes.to_vec();
        world
    }

    /// Waits for the thread that predicts.
    fn settle(world: &World, view: &mut MapView) {
        let ctx = egui::Context::default();
        for _ in 0..20_000 {
            if view.course(&ctx, world).is_some_and(|c| c.is_whole()) {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        panic!("no course");
    }

    fn texts(world: &World, view: &mut MapView, readout: &crate::world::readout::Readout) -> Vec<String> {
        settle(world, view);
        run(|ctx| show(ctx, &Scene { readout, world, snapshot: None }, view, 0.9, &mut Reply::default()))
    }

    #[test]
    fn the_path_its_flags_and_the_burns_are_told_in_every_frame() {
        let mut world = planned();
        world.target = Some(Target { body: BodyId(0), spot: None });
        let views =
            [Frame::Patched, Frame::Of(View { body: BodyId(1), rotating: true }), Frame::Of(View { body: BodyId(0), rotating: false })];
        for frame in views {
            let mut view = MapView { frame, chosen: Some(0), revolutions: 4, ..MapView::default() };
            let all = texts(&world, &mut view, &readout()).join("|");
            for word in ["10 revolutions", "with the planned burns", "Fly it", "Warp there", "Prograde", "120.0 m/s", "60.00 m/s", "16:"] {
                assert!(all.contains(word), "{frame:?}: `{word}` is not in {all}");
            }
            if frame == Frame::Patched {
                for flag in ["AN\nin", "DN\nin", "Ap ", "Burn 2"] {
                    assert!(all.contains(flag), "`{flag}` is not in {all}");
                }
            }
        }
        // A frame about a body that there is not falls back.
        let mut view = MapView { frame: Frame::Of(View { body: BodyId(77), rotating: true }), ..MapView::default() };
        texts(&world, &mut view, &readout());
        assert_eq!(view.frame, Frame::Patched);
    }

    #[test]
    fn no_readout_and_no_burn_breaks_the_map() {
        let mut world = planned();
        world.ship.nodes[1].dv_mm_s = [i32::MAX, i32::MIN, i32::MAX];
        world.ship.guidance = Guidance::Node;
        world.ship.hold = Hold::Node;
        for shown in extremes() {
            for chosen in [None, Some(0), Some(1), Some(9)] {
                let mut view = MapView { chosen, ..MapView::default() };
                for text in texts(&world, &mut view, &shown) {
                    assert!(
                        !text.split_whitespace().any(|w| matches!(w.to_ascii_lowercase().as_str(), "nan" | "inf" | "-inf" | "-nan")),
                        "{text}"
                    );
                }
            }
        }
        for (size, scale) in [((1280.0, 720.0), 1.0), ((640.0, 400.0), 2.0), ((2560.0, 1440.0), 1.5)] {
            let mut view = MapView { chosen: Some(0), ..MapView::default() };
            settle(&world, &mut view);
            let scene = Scene { readout: &readout(), world: &world, snapshot: None };
            run_at(size, scale, |ctx| show(ctx, &scene, &mut view, 0.9, &mut Reply::default()));
        }
    }

    #[test]
    fn a_burn_is_planned_moved_and_given_up_by_keys() {
        let mut world = planned();
        world.ship.nodes.truncate(1);
        let mut view = MapView::default();
        let ctx = egui::Context::default();
        style::apply(&ctx);
        let press = |view: &mut MapView, key: egui::Key| {
            settle(&world, view);
            let mut reply = Reply::default();
            let event = egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: egui::Modifiers::NONE };
            let screen_rect = Some(Rect::from_min_size(egui::Pos2::ZERO, Vec2::new(1280.0, 720.0)));
            // The first frame of a panel is laid out twice.
            for events in [Vec::new(), vec![event]] {
                reply = Reply::default();
                let input = egui::RawInput { screen_rect, events, ..Default::default() };
                let output = ctx.run_ui(input, |ui| {
                    show(ui.ctx(), &Scene { readout: &readout(), world: &world, snapshot: None }, view, 0.9, &mut reply);
                });
                output.drop_without_applying_deltas();
            }
            reply.actions
        };
        assert!(matches!(press(&mut view, egui::Key::Insert)[..], [Action::AddNode(Node { dv_mm_s: [0, 0, 0], .. })]));
        view.chosen = None;
        press(&mut view, egui::Key::CloseBracket);
        assert_eq!(view.chosen, Some(0));
        let more = press(&mut view, egui::Key::ArrowRight);
        assert!(matches!(more[..], [Action::ChangeNode(0, Node { dv_mm_s: [121_000, 0, -3_000], .. })]), "{more:?}");
        // What was asked for and is not yet in force is built upon.
        let more = press(&mut view, egui::Key::Plus);
        assert!(matches!(more[..], [Action::ChangeNode(0, Node { dv_mm_s: [122_000, 0, -3_000], .. })]), "{more:?}");
        press(&mut view, egui::Key::ArrowUp);
        assert!(matches!(press(&mut view, egui::Key::Minus)[..], [Action::ChangeNode(0, Node { dv_mm_s: [122_000, 0, -3_000], .. })]));
        assert_eq!(press(&mut view, egui::Key::Delete), [Action::DeleteNode(0)]);
        assert!(!view.editing());
    }
}
