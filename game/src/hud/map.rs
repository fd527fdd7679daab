//! The orbit map: the path ahead, bodies and their orbits, apsides, the point of impact. Drawn orthographically in f64 from
//! the focus, so that it is as steady at a moon as at the edge of the system. Click a body: target; double click: focus.

use super::conic::Conic;
use super::panels::{area, row};
use super::{Reply, Scene, format, style};
use crate::command::{Action, Target};
use crate::world::World;
use crate::world::eclipse::Sky;
use crate::world::readout::Situation;
use egui::{Align2, Color32, Mesh, Painter, Pos2, Rect, RichText, Sense, Shape, Stroke, Vec2};
use engine::orbit::{BodyId, State};
use engine::space::relative::narrow;
use engine::space::{Position, Velocity, sphere};
use glam::DVec3;

/// Where the map looks.
#[derive(Clone, Debug, PartialEq)]
pub struct MapView {
    yaw: f64,
    pitch: f64,
    metres_per_point: f64,
    focus: Option<BodyId>,
    pan: Vec2,
}

impl Default for MapView {
    fn default() -> Self {
        Self { yaw: 0.6, pitch: 0.9, metres_per_point: 0.0, focus: None, pan: Vec2::ZERO }
    }
}

/// The map's projection: positions from the focus, m, to the screen; depth towards the viewer.
struct Projection {
    centre: Pos2,
    scale: f64,
    right: DVec3,
    up: DVec3,
    towards: DVec3,
}

impl Projection {
    fn at(&self, p: DVec3) -> Pos2 {
        // Far beyond the window a point only needs to lie on the right side of it.
        let clamp = |x: f64| narrow((x / self.scale).clamp(-1.0e5, 1.0e5));
        self.centre + Vec2::new(clamp(p.dot(self.right)), -clamp(p.dot(self.up)))
    }
    fn points(&self, metres: f64) -> f32 {
        narrow((metres / self.scale).min(1.0e5))
    }
    /// True when `p` lies behind the disc of a sphere.
    fn behind(&self, p: DVec3, centre: DVec3, radius: f64) -> bool {
        let d = p - centre;
        let across = d - self.towards * d.dot(self.towards);
        d.dot(self.towards) < 0.0 && across.length() < radius
    }
}

/// The map's screen.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, view: &mut MapView, opacity: f32, reply: &mut Reply) {
    let world = scene.world;
    let rigid = world.rigid();
    let focus = view.focus.filter(|f| f.index() < world.system.bodies.len()).unwrap_or(rigid.body);
    let sky = Sky::at(&world.system, world.time);
    let offset = |b: BodyId| (sky.position(b) - sky.position(focus)).0;

    let screen = ctx.content_rect();
    egui::Area::new(egui::Id::unique("map")).fixed_pos(screen.min).order(egui::Order::Background).fade_in(false).show(ctx, |ui| {
        let (rect, response) = ui.allocate_exact_size(screen.size(), Sense::click_and_drag());
        steer(ui, view, &response, rect, world, focus);
        let projection = view.projection(rect);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0, Color32::from_rgb(5, 7, 11));
        let mut hits = Vec::new();
        for (i, body) in world.system.bodies.iter().enumerate() {
            let id = BodyId(u16::try_from(i).unwrap_or(0));
            if let Some(parent) = body.parent {
                orbit_of(&painter, &projection, world, &sky, id, parent, offset(parent));
            }
            hits.push((id, draw_body(&painter, &projection, world, &sky, id, offset(id), scene.name(id), rect)));
        }
        let host = offset(rigid.body);
        if !matches!(scene.readout.situation, Situation::Landed | Situation::Crashed) {
            path(&painter, &projection, world, &rigid.state, rigid.body, host);
        }
        let ship = projection.at(host + rigid.state.position.0);
        painter.circle_filled(ship, 4.0, style::ACCENT);
        painter.circle_stroke(ship, 7.5, Stroke::new(1.2, style::ACCENT));
        if let Some(p) = response.interact_pointer_pos() {
            let near = hits.iter().filter(|(_, (at, r))| at.distance(p) < r.max(12.0)).min_by(|a, b| a.1.1.total_cmp(&b.1.1));
            if let Some((id, _)) = near {
                if response.double_clicked() {
                    view.focus = Some(*id);
                    view.pan = Vec2::ZERO;
                    view.metres_per_point = 0.0;
                } else if response.clicked() {
                    reply.actions.push(Action::Target(Some(Target { body: *id, spot: None })));
                }
            }
        }
    });
    legend(ctx, scene, view, focus, opacity, reply);
}

fn steer(ui: &egui::Ui, view: &mut MapView, response: &egui::Response, rect: Rect, world: &World, focus: BodyId) {
    if view.metres_per_point <= 0.0 {
        let reach = if focus == world.ship.body() { world.rigid().state.position.length() } else { 0.0 };
        let reach = reach.max(world.system.body(focus).radius_m) * 1.25;
        view.metres_per_point = reach / f64::from(0.42 * rect.height().max(1.0));
    }
    if response.dragged_by(egui::PointerButton::Primary) {
        let d = response.drag_delta();
        view.yaw -= f64::from(d.x) * 0.006;
        view.pitch = (view.pitch + f64::from(d.y) * 0.006).clamp(-1.57, 1.57);
    } else if response.dragged() {
        view.pan += response.drag_delta();
    }
    let scroll = ui.input(|i| i.smooth_scroll_delta.y);
    if response.hovered() && scroll != 0.0 {
        let factor = libm::exp(-f64::from(scroll) * 0.003);
        view.metres_per_point = (view.metres_per_point * factor).clamp(10.0, 3.0e10);
        view.pan *= narrow(1.0 / factor);
    }
}

impl MapView {
    /// Nearer (below 1) or farther.
    pub fn zoom(&mut self, factor: f64) {
        self.metres_per_point = (self.metres_per_point * factor).clamp(10.0, 3.0e10);
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

/// The osculating orbit of a body about its parent, where it is large enough to be seen.
fn orbit_of(painter: &Painter, projection: &Projection, world: &World, sky: &Sky, id: BodyId, parent: BodyId, centre: DVec3) {
    let (me, of) = (sky.states[id.index()], sky.states[parent.index()]);
    let r = (me.position - of.position).0;
    let size = projection.points(r.length());
    if !(6.0..40_000.0).contains(&size) {
        return;
    }
    let gm = world.system.body(parent).gm_m3_s2 + world.system.body(id).gm_m3_s2;
    let state = State { position: Position::new(r), velocity: Velocity::new((me.velocity - of.velocity).0) };
    let Some(conic) = Conic::new(gm, &state).filter(|c| c.e < 1.0) else { return };
    let fade = ((size - 6.0) / 40.0).clamp(0.15, 1.0);
    let colour = Color32::from_rgb(70, 92, 116).gamma_multiply(fade);
    let points = conic.ahead_of_now(160, 0.0).into_iter().map(|a| projection.at(centre + conic.point(a))).collect();
    painter.add(Shape::line(points, Stroke::new(1.0, colour)));
}

/// A body: a lit disc and its name. Returns where it stands and how large it is.
#[allow(clippy::too_many_arguments)]
fn draw_body(
    painter: &Painter,
    projection: &Projection,
    world: &World,
    sky: &Sky,
    id: BodyId,
    centre: DVec3,
    name: &str,
    rect: Rect,
) -> (Pos2, f32) {
    let body = world.system.body(id);
    let at = projection.at(centre);
    let radius = projection.points(body.radius_m);
    if !rect.expand(radius).contains(at) {
        return (at, 0.0);
    }
    let tint = |x: f32| Color32::from_rgb(level(body.albedo.x, x), level(body.albedo.y, x), level(body.albedo.z, x));
    if body.intensity_cd.x > 0.0 {
        painter.circle_filled(at, radius.max(4.0), Color32::from_rgb(255, 236, 190));
    } else if radius > 5.0 {
        let sun = (sky.position(BodyId(0)) - sky.position(id)).0.normalize_or(DVec3::X);
        let light = DVec3::new(sun.dot(projection.right), sun.dot(projection.up), sun.dot(projection.towards));
        painter.add(Shape::mesh(lit_disc(at, radius, light, &tint)));
        graticule(painter, projection, world, sky, id, centre, body.radius_m);
    } else {
        painter.circle_filled(at, radius.max(2.2), tint(1.6));
    }
    // Moons' names only where their orbit is wide enough for them.
    let apart = body.parent.map_or(1e3, |p| projection.points((sky.position(id) - sky.position(p)).0.length()));
    if apart > 26.0 {
        let chosen = world.target.is_some_and(|t| t.body == id);
        let colour = if chosen { style::DANGER } else { style::DIM };
        painter.text(at + Vec2::new(radius.min(200.0) + 6.0, -8.0), Align2::LEFT_CENTER, name, style::words(12.0), colour);
        if chosen {
            super::ball::glyph(painter, at, 9.0, super::ball::Glyph::Target, style::DANGER);
        }
    }
    (at, radius)
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn level(albedo: f32, lit: f32) -> u8 {
    ((albedo.max(0.0) * lit).sqrt().min(1.0) * 235.0 + 8.0) as u8
}

fn lit_disc(at: Pos2, radius: f32, light: DVec3, tint: &impl Fn(f32) -> Color32) -> Mesh {
    const AROUND: u32 = 72;
    const RINGS: u32 = 32;
    let mut mesh = Mesh::default();
    for ring in 0..=RINGS {
        let rho = libm::sin(core::f64::consts::FRAC_PI_2 * f64::from(ring) / f64::from(RINGS));
        for k in 0..AROUND {
            let (s, c) = libm::sincos(core::f64::consts::TAU * f64::from(k) / f64::from(AROUND));
            let n = DVec3::new(rho * c, rho * s, (1.0 - rho * rho).max(0.0).sqrt());
            let lit = narrow(n.dot(light).max(0.0)) * 1.6 + 0.02;
            mesh.colored_vertex(at + Vec2::new(narrow(n.x), -narrow(n.y)) * radius, tint(lit));
        }
    }
    for ring in 0..RINGS {
        for k in 0..AROUND {
            let (a, b) = (ring * AROUND + k, ring * AROUND + (k + 1) % AROUND);
            mesh.add_triangle(a, b, a + AROUND);
            mesh.add_triangle(b, a + AROUND, b + AROUND);
        }
    }
    mesh
}

/// The equator and four meridians of a large disc, so that its turning is seen.
fn graticule(painter: &Painter, projection: &Projection, world: &World, sky: &Sky, id: BodyId, centre: DVec3, radius: f64) {
    if projection.points(radius) < 40.0 {
        return;
    }
    let axes = sky.axes(&world.system, id);
    let line = |points: Vec<DVec3>, alpha: u8| {
        let mut run = Vec::new();
        for p in points {
            if p.dot(projection.towards) > 0.0 {
                run.push(projection.at(centre + p * radius));
            } else if run.len() > 1 {
                painter.add(Shape::line(std::mem::take(&mut run), Stroke::new(0.8, Color32::from_white_alpha(alpha))));
            } else {
                run.clear();
            }
        }
        if run.len() > 1 {
            painter.add(Shape::line(run, Stroke::new(0.8, Color32::from_white_alpha(alpha))));
        }
    };
    let step = core::f64::consts::TAU / 72.0;
    line((0..=72).map(|i| axes.raw(sphere::direction_of_lat_lon(0.0, f64::from(i) * step))).collect(), 46);
    for k in 0..6 {
        let lon = f64::from(k) * core::f64::consts::PI / 6.0 * 2.0;
        line((-18..=18).map(|i| axes.raw(sphere::direction_of_lat_lon(f64::from(i) * step, lon))).collect(), if k == 0 { 60 } else { 26 });
    }
}

/// The ship's path: apsides, impact, and the part behind the ground left out.
fn path(painter: &Painter, projection: &Projection, world: &World, state: &State<engine::space::Centred>, host: BodyId, centre: DVec3) {
    let body = world.system.body(host);
    let Some(conic) = Conic::new(body.gm_m3_s2, state) else { return };
    let far = if body.soi_radius_m.is_finite() { body.soi_radius_m } else { 1.0e14 };
    let impact = conic.meets(body.radius_m);
    let mut run: Vec<Pos2> = Vec::new();
    for anomaly in conic.ahead_of_now(400, far) {
        let p = conic.point(anomaly);
        let shown = p.is_finite() && p.length() < far * 1.001 && impact.is_none_or(|i| anomaly <= i);
        if shown && !projection.behind(p, DVec3::ZERO, body.radius_m) {
            run.push(projection.at(centre + p));
        } else if run.len() > 1 {
            painter.add(Shape::line(std::mem::take(&mut run), Stroke::new(1.8, style::ACCENT)));
        } else {
            run.clear();
        }
    }
    if run.len() > 1 {
        painter.add(Shape::line(run, Stroke::new(1.8, style::ACCENT)));
    }
    let mark = |anomaly: f64, text: String, colour: Color32| {
        let p = conic.point(anomaly);
        if p.is_finite() && !projection.behind(p, DVec3::ZERO, body.radius_m) {
            let at = projection.at(centre + p);
            painter.circle_filled(at, 3.0, colour);
            painter.text(at + Vec2::new(7.0, 8.0), Align2::LEFT_TOP, text, style::mono(11.0), colour);
        }
    };
    let (rp, ra) = conic.apsides();
    let next = |anomaly: f64| if anomaly < conic.anomaly { anomaly + core::f64::consts::TAU } else { anomaly };
    let told = |name: &str, r: f64, anomaly: f64| {
        format!("{name} {}\n{}", format::length(r - body.radius_m), format::duration(conic.time_to(next(anomaly))))
    };
    if conic.e > 1e-4 {
        if rp > body.radius_m && (conic.e < 1.0 || conic.anomaly < 0.0) {
            mark(0.0, told("Pe", rp, 0.0), Color32::from_rgb(140, 190, 255));
        }
        if ra < far {
            mark(core::f64::consts::PI, told("Ap", ra, core::f64::consts::PI - 1e-9), Color32::from_rgb(140, 190, 255));
        }
    }
    if let Some(at) = impact {
        let seconds = conic.time_to(at);
        let later = world.time.plus(engine::time::SimTime::from_jd_tdb(engine::time::J2000_JD + seconds / 86_400.0).ticks);
        let fixed = body.spin.icrf_from_fixed(later).inverse().raw(conic.point(at));
        let (lat, lon) = sphere::lat_lon_of(fixed);
        mark(at, format!("Impact in {}\n{}", format::duration(seconds), format::place(lat, lon)), style::DANGER);
    }
}

fn legend(ctx: &egui::Context, scene: &Scene<'_>, view: &mut MapView, focus: BodyId, opacity: f32, reply: &mut Reply) {
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
                row(ui, 180.0, label, &value, style::TEXT);
            }
            if let Some(target) = &scene.readout.target {
                row(ui, 180.0, scene.name(target.target.body), &format::length(target.distance_m), style::DANGER);
            }
            ui.horizontal(|ui| {
                if ui.button("Ship").clicked() {
                    *view = MapView { yaw: view.yaw, pitch: view.pitch, ..MapView::default() };
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
            ui.label(style::note("drag: turn · right drag: pan · wheel: zoom\nclick: target · double click: look there"));
        });
    });
}
