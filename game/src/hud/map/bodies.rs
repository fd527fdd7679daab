//! The bodies on the map: lit discs with their graticule, names, and the orbits that they are on now.

use super::super::conic::Conic;
use super::super::{ball, style};
use super::projection::Projection;
use crate::world::World;
use crate::world::eclipse::Sky;
use egui::{Align2, Color32, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2};
use engine::orbit::{BodyId, State};
use engine::space::relative::narrow;
use engine::space::{Position, Velocity, sphere};
use glam::DVec3;

/// The osculating orbit of a body about its parent, where it is large enough to be seen.
pub fn orbit_of(painter: &Painter, projection: &Projection, world: &World, sky: &Sky, id: BodyId, parent: BodyId, centre: DVec3) {
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
pub fn draw_body(
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
            ball::glyph(painter, at, 9.0, ball::Glyph::Target, style::DANGER);
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
