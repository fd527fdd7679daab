//! The bodies on the map: lit discs with their graticule, names, and the orbits that they are on now.

use super::super::conic::Conic;
use super::super::{ball, style};
use super::Chart;
use super::projection::Projection;
use crate::world::World;
use crate::world::eclipse::Sky;
use core::f64::consts::{FRAC_PI_2, PI, TAU};
use egui::epaint::Vertex;
use egui::{Align2, Color32, Mesh, Painter, Pos2, Rgba, Shape, Stroke, TextureId, Vec2};
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
    let points = conic.around(160).into_iter().map(|a| projection.at(centre + conic.point(a))).collect();
    painter.add(Shape::line(points, Stroke::new(1.0, colour)));
}

/// Radius of a disc from which on it is drawn as a globe with its ground, points.
pub const GLOBE: f32 = 30.0;

/// A body: a lit disc (with a picture of its ground, if one is given) and its name. Returns where it stands and how large it is.
pub fn draw_body(chart: &Chart<'_, '_>, id: BodyId, picture: Option<TextureId>) -> (Pos2, f32) {
    let Chart { world, sky, painter, projection, .. } = chart;
    let (body, centre) = (world.system.body(id), chart.offset(id));
    let at = projection.at(centre);
    let radius = projection.points(body.radius_m);
    if !chart.rect.expand(radius).contains(at) {
        return (at, 0.0);
    }
    let tint = |x: f32| Color32::from_rgb(level(body.albedo.x, x), level(body.albedo.y, x), level(body.albedo.z, x));
    if body.intensity_cd.x > 0.0 {
        painter.circle_filled(at, radius.max(4.0), Color32::from_rgb(255, 236, 190));
    } else if radius > 5.0 {
        let sun = (sky.position(BodyId(0)) - sky.position(id)).0.normalize_or(DVec3::X);
        let light = DVec3::new(sun.dot(projection.right), sun.dot(projection.up), sun.dot(projection.towards));
        let mesh = match picture {
            Some(picture) => globe(at, radius, light, picture, projection, &|d| sky.axes(&world.system, id).inverse().raw(d)),
            None => lit_disc(at, radius, light, &tint),
        };
        painter.add(Shape::mesh(mesh));
        graticule(painter, projection, world, sky, id, centre, body.radius_m);
    } else {
        painter.circle_filled(at, radius.max(2.2), tint(1.6));
    }
    // Moons' names only where their orbit is wide enough for them.
    let apart = body.parent.map_or(1e3, |p| projection.points((sky.position(id) - sky.position(p)).0.length()));
    if apart > 26.0 {
        let chosen = world.target.is_some_and(|t| t.body == id);
        let colour = if chosen { style::DANGER } else { style::DIM };
        painter.text(at + Vec2::new(radius.min(200.0) + 6.0, -8.0), Align2::LEFT_CENTER, &body.name, style::words(12.0), colour);
        if chosen {
            ball::glyph(painter, at, 9.0, ball::Glyph::Target, style::DANGER);
        }
    }
    (at, radius)
}

/// A globe: the picture of its ground (longitude −180° … 180° from left to right) under the star's light.
fn globe(at: Pos2, radius: f32, light: DVec3, picture: TextureId, p: &Projection, fixed_from_icrf: &impl Fn(DVec3) -> DVec3) -> Mesh {
    const AROUND: u32 = 72;
    const RINGS: u32 = 32;
    let [right, up, towards] = [p.right, p.up, p.towards].map(fixed_from_icrf);
    let corner = |ring: u32, k: u32| {
        let rho = libm::sin(FRAC_PI_2 * f64::from(ring) / f64::from(RINGS));
        let (s, c) = libm::sincos(TAU * f64::from(k) / f64::from(AROUND));
        let n = DVec3::new(rho * c, rho * s, (1.0 - rho * rho).max(0.0).sqrt());
        let (lat, lon) = sphere::lat_lon_of(right * n.x + up * n.y + towards * n.z);
        // A soft terminator, and a night in which the ground can still be made out.
        let lit = narrow(0.3 + 0.8 * (n.dot(light) * 1.6 + 0.12).clamp(0.0, 1.0));
        let place = at + Vec2::new(narrow(n.x), -narrow(n.y)) * radius;
        (place, Pos2::new(narrow(lon / TAU + 0.5), narrow(0.5 - lat / PI)), Rgba::from_gray(lit.min(1.0) * lit.min(1.0)).into())
    };
    let mut mesh = Mesh::with_texture(picture);
    for ring in 0..RINGS {
        for k in 0..AROUND {
            let corners = [corner(ring, k), corner(ring, k + 1), corner(ring + 1, k), corner(ring + 1, k + 1)];
            let first = u32::try_from(mesh.vertices.len()).unwrap_or(0);
            let from = corners[3].1.x;
            for (pos, uv, color) in corners {
                // Across the date line the picture goes on to the right or to the left.
                let uv = Pos2::new(uv.x - (uv.x - from).round(), uv.y);
                mesh.vertices.push(Vertex { pos, uv, color });
            }
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 2, first + 3);
        }
    }
    mesh
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
        let rho = libm::sin(FRAC_PI_2 * f64::from(ring) / f64::from(RINGS));
        for k in 0..AROUND {
            let (s, c) = libm::sincos(TAU * f64::from(k) / f64::from(AROUND));
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
    let step = TAU / 72.0;
    line((0..=72).map(|i| axes.raw(sphere::direction_of_lat_lon(0.0, f64::from(i) * step))).collect(), 46);
    for k in 0..6 {
        let lon = f64::from(k) * PI / 6.0 * 2.0;
        line((-18..=18).map(|i| axes.raw(sphere::direction_of_lat_lon(f64::from(i) * step, lon))).collect(), if k == 0 { 60 } else { 26 });
    }
}
