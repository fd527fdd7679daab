//! The attitude ball: the sky seen along the nose, with horizon, pitch ladder, headings and direction markers.
//!
//! A direction `d` in hull axes stands at `(d.x, d.y)` of the unit disc while it lies ahead (`d.z < 0`): what is to the
//! right of the nose is to the right on the ball, and pitching up makes the horizon sink.

use super::style;
use crate::world::readout::Markers;
use egui::{Align2, Color32, Mesh, Painter, Pos2, Shape, Stroke, Vec2};
use engine::space::relative::narrow;
use engine::units::DEG;
use glam::DVec3;

/// How a marker is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Glyph {
    /// Circle with wings: along a velocity.
    Prograde,
    /// Circle with a cross: against it.
    Retrograde,
    /// Triangle.
    Normal,
    /// Circle with a dot.
    Radial,
    /// Diamond.
    Target,
    /// Circle with three spokes: along a planned burn.
    Node,
}

/// Draws a marker's glyph.
pub fn glyph(painter: &Painter, at: Pos2, r: f32, kind: Glyph, colour: Color32) {
    let line = Stroke::new(1.6, colour);
    let seg = |a: Vec2, b: Vec2| _ = painter.line_segment([at + a * r, at + b * r], line);
    match kind {
        Glyph::Prograde => {
            painter.circle_stroke(at, r * 0.55, line);
            seg(Vec2::new(-1.2, 0.0), Vec2::new(-0.55, 0.0));
            seg(Vec2::new(0.55, 0.0), Vec2::new(1.2, 0.0));
            seg(Vec2::new(0.0, -0.55), Vec2::new(0.0, -1.2));
        }
        Glyph::Retrograde => {
            painter.circle_stroke(at, r * 0.55, line);
            seg(Vec2::new(-0.4, -0.4), Vec2::new(0.4, 0.4));
            seg(Vec2::new(-0.4, 0.4), Vec2::new(0.4, -0.4));
        }
        Glyph::Normal => {
            let p = [Vec2::new(0.0, -0.85), Vec2::new(0.75, 0.5), Vec2::new(-0.75, 0.5)].map(|v| at + v * r);
            painter.add(Shape::closed_line(p.to_vec(), line));
        }
        Glyph::Radial => {
            painter.circle_stroke(at, r * 0.6, line);
            painter.circle_filled(at, r * 0.18, colour);
        }
        Glyph::Target => {
            let p = [Vec2::new(0.0, -0.9), Vec2::new(0.9, 0.0), Vec2::new(0.0, 0.9), Vec2::new(-0.9, 0.0)].map(|v| at + v * r);
            painter.add(Shape::closed_line(p.to_vec(), line));
        }
        Glyph::Node => {
            painter.circle_stroke(at, r * 0.45, line);
            for (x, y) in [(0.0, -1.0), (0.87, 0.5), (-0.87, 0.5)] {
                seg(Vec2::new(x, y) * 0.45, Vec2::new(x, y) * 1.2);
            }
        }
    }
}

/// The horizon's frame in hull axes: up, north, east. The hull's own axes where the readout has none.
fn frame(markers: &Markers) -> (DVec3, DVec3, DVec3) {
    let finite = |v: DVec3| if v.is_finite() { v } else { DVec3::ZERO };
    let up = finite(markers.zenith).normalize_or(DVec3::Y);
    let north = finite(markers.north);
    let north = (north - up * north.dot(up)).normalize_or(up.any_orthonormal_vector());
    (up, north, north.cross(up))
}

/// Draws the ball.
pub fn draw(painter: &Painter, centre: Pos2, radius: f32, markers: &Markers) {
    let (up, north, east) = frame(markers);
    let at = |d: DVec3| centre + Vec2::new(narrow(d.x), -narrow(d.y)) * radius;
    painter.circle_filled(centre, radius + 5.0, style::ground(0.72));
    painter.add(Shape::mesh(ground_and_sky(up, &at)));

    let direction = |heading: f64, pitch: f64| {
        let (sh, ch) = libm::sincos(heading);
        let (sp, cp) = libm::sincos(pitch);
        (north * ch + east * sh) * cp + up * sp
    };
    let faint = Color32::from_white_alpha(70);
    for pitch in [-60.0_f64, -30.0, 30.0, 60.0] {
        curve(painter, &at, (0..=72).map(|i| direction(f64::from(i) * 5.0 * DEG, pitch * DEG)), Stroke::new(1.0, faint));
    }
    for heading in (0..360).step_by(45) {
        let h = f64::from(heading) * DEG;
        curve(painter, &at, (-15..=15).map(|i| direction(h, f64::from(i) * 5.0 * DEG)), Stroke::new(1.0, Color32::from_white_alpha(40)));
    }
    curve(painter, &at, (0..=120).map(|i| direction(f64::from(i) * 3.0 * DEG, 0.0)), Stroke::new(2.0, Color32::from_white_alpha(210)));
    let text = |d: DVec3, s: &str, size: f32, colour: Color32| {
        if d.z < -0.25 {
            _ = painter.text(at(d), Align2::CENTER_CENTER, s, style::mono(size), colour);
        }
    };
    for (i, name) in ["N", "NE", "E", "SE", "S", "SW", "W", "NW"].into_iter().enumerate() {
        let h = 45.0 * f64::from(u32::try_from(i).unwrap_or(0)) * DEG;
        text(direction(h, 5.0 * DEG), name, 10.0, if name == "N" { style::ACCENT } else { style::TEXT });
        for pitch in [-60, -30, 30, 60] {
            if name.len() == 1 {
                text(direction(h + 8.0 * DEG, f64::from(pitch) * DEG), &pitch.to_string(), 8.5, Color32::from_white_alpha(150));
            }
        }
    }
    for (d, kind, colour) in marks(markers) {
        let d = if d.is_finite() { d.normalize_or_zero() } else { DVec3::ZERO };
        if d.z < -0.02 {
            glyph(painter, at(d), 8.0, kind, colour);
        }
    }
    painter.circle_stroke(centre, radius, Stroke::new(1.5, Color32::from_white_alpha(120)));
    // The nose.
    let own = Stroke::new(2.2, style::ACCENT);
    for (a, b) in [((-0.42, 0.0), (-0.16, 0.0)), ((0.16, 0.0), (0.42, 0.0)), ((-0.16, 0.0), (0.0, 0.1)), ((0.0, 0.1), (0.16, 0.0))] {
        painter.line_segment([centre + Vec2::new(a.0, a.1) * radius, centre + Vec2::new(b.0, b.1) * radius], own);
    }
}

/// The directions that are marked, on the ball and in the view.
pub fn marks(m: &Markers) -> [(DVec3, Glyph, Color32); 9] {
    let velocity = Color32::from_rgb(180, 230, 90);
    let normal = Color32::from_rgb(206, 130, 255);
    let radial = Color32::from_rgb(96, 196, 255);
    [
        (m.radial_out, Glyph::Radial, radial),
        (-m.radial_out, Glyph::Radial, radial.gamma_multiply(0.6)),
        (m.normal, Glyph::Normal, normal),
        (-m.normal, Glyph::Normal, normal.gamma_multiply(0.6)),
        (-m.prograde, Glyph::Retrograde, velocity),
        (m.surface_prograde, Glyph::Prograde, Color32::from_rgb(255, 255, 255)),
        (m.prograde, Glyph::Prograde, velocity),
        (m.target, Glyph::Target, style::DANGER),
        (m.node, Glyph::Node, Color32::from_rgb(92, 150, 255)),
    ]
}

/// The part of a curve that lies ahead.
fn curve(painter: &Painter, at: &impl Fn(DVec3) -> Pos2, points: impl Iterator<Item = DVec3>, stroke: Stroke) {
    let mut run = Vec::new();
    for d in points {
        if d.z < -0.01 {
            run.push(at(d));
        } else if run.len() > 1 {
            painter.add(Shape::line(std::mem::take(&mut run), stroke));
        } else {
            run.clear();
        }
    }
    if run.len() > 1 {
        painter.add(Shape::line(run, stroke));
    }
}

/// Both halves as strips between the visible half of the horizon (a half ellipse) and the rim: both are half circles about
/// the same axis, so that corresponding points never cross, whatever the attitude.
fn ground_and_sky(up: DVec3, at: &impl Fn(DVec3) -> Pos2) -> Mesh {
    const ALONG: u32 = 48;
    const ACROSS: u32 = 8;
    let axis = up.cross(DVec3::Z).normalize_or(DVec3::X);
    let ahead = up.cross(axis);
    let ahead = if ahead.z > 0.0 { -ahead } else { ahead };
    let rim_up = DVec3::Z.cross(axis);
    let rim_up = if rim_up.dot(up) < 0.0 { -rim_up } else { rim_up };
    let mut mesh = Mesh::default();
    for (sign, near, far) in [
        (1.0, Color32::from_rgb(108, 152, 190), Color32::from_rgb(22, 52, 98)),
        (-1.0, Color32::from_rgb(140, 104, 66), Color32::from_rgb(52, 34, 22)),
    ] {
        let rim = rim_up * sign;
        let base = u32::try_from(mesh.vertices.len()).unwrap_or(0);
        for i in 0..=ALONG {
            let (s, c) = libm::sincos(core::f64::consts::PI * f64::from(i) / f64::from(ALONG));
            for j in 0..=ACROSS {
                let t = f64::from(j) / f64::from(ACROSS);
                // On the sphere from the horizon to the rim.
                let across = (ahead * (1.0 - t) + rim * t).normalize_or(rim);
                let d = axis * c + across * s;
                let elevation = (d.dot(up) * sign).clamp(0.0, 1.0);
                mesh.colored_vertex(at(d), near.lerp_to_gamma(far, narrow(elevation.sqrt())));
            }
        }
        let row = ACROSS + 1;
        for i in 0..ALONG {
            for j in 0..ACROSS {
                let a = base + i * row + j;
                mesh.add_triangle(a, a + 1, a + row);
                mesh.add_triangle(a + 1, a + row, a + row + 1);
            }
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mesh_covers_the_disc_once_and_the_horizon_parts_it() {
        for up in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z, DVec3::new(0.5, -0.3, 0.8).normalize(), DVec3::X] {
            let at = |d: DVec3| Pos2::new(narrow(d.x), -narrow(d.y));
            let mesh = ground_and_sky(up, &at);
            let mut area = 0.0;
            for t in mesh.indices.chunks_exact(3) {
                let p = [0, 1, 2].map(|k| mesh.vertices[t[k] as usize].pos);
                area += ((p[1] - p[0]).x * (p[2] - p[0]).y - (p[1] - p[0]).y * (p[2] - p[0]).x).abs() * 0.5;
            }
            assert!((area - core::f32::consts::PI).abs() < 0.02, "{up:?}: {area}");
        }
    }

    #[test]
    fn level_flight_has_the_sky_on_top() {
        let at = |d: DVec3| Pos2::new(narrow(d.x), -narrow(d.y));
        let mesh = ground_and_sky(DVec3::Y, &at);
        let top = mesh.vertices.iter().min_by(|a, b| a.pos.y.total_cmp(&b.pos.y)).unwrap();
        assert!(top.color.b() > top.color.r(), "blue is up");
    }

    #[test]
    fn east_is_right_of_north_when_looking_north_upright() {
        let markers = Markers { zenith: DVec3::Y, north: DVec3::NEG_Z, ..Markers::default() };
        let (up, north, east) = frame(&markers);
        assert_eq!((up, north), (DVec3::Y, DVec3::NEG_Z));
        assert!((east - DVec3::X).length() < 1e-12);
    }
}
