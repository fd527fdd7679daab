//! Markers in the 3-D view: where the ship goes, the target, the names of bodies. Projected through the picture's camera.

use super::ball::{Glyph, glyph, marks};
use super::{Scene, format, style};
use egui::{Align2, Color32, Painter, Pos2, Rect, Stroke};
use engine::scene::Camera;
use engine::space::relative::{narrow, narrow3};
use glam::Vec3;

/// Where a direction in ICRF axes stands on the screen; `None` behind the camera. `screen` is the picture's rectangle.
pub fn project(camera: &Camera, screen: Rect, direction: Vec3) -> Option<Pos2> {
    let v = camera.view_from_icrf * direction.normalize_or_zero();
    if v.is_nan() || v.z > -0.02 {
        return None;
    }
    let f = 1.0 / (0.5 * camera.fov_y_rad).tan();
    let x = f / camera.aspect() * v.x / -v.z;
    let y = f * v.y / -v.z;
    Some(Pos2::new(screen.center().x + 0.5 * x * screen.width(), screen.center().y - 0.5 * y * screen.height()))
}

/// Draws the markers.
pub fn draw(painter: &Painter, screen: Rect, scene: &Scene<'_>) {
    let Some(snapshot) = scene.snapshot else { return };
    let camera = &snapshot.camera;
    let inside = screen.shrink(8.0);
    let q = scene.readout.icrf_from_hull;
    for (direction, kind, colour) in marks(&scene.readout.markers) {
        let shown = matches!(kind, Glyph::Prograde | Glyph::Retrograde | Glyph::Target | Glyph::Node);
        if !shown || direction == glam::DVec3::ZERO || !direction.is_finite() {
            continue;
        }
        if let Some(at) = project(camera, screen, narrow3(q * direction)).filter(|p| inside.contains(*p)) {
            glyph(painter, at, 11.0, kind, colour.gamma_multiply(0.85));
            if kind == Glyph::Target
                && let Some(target) = &scene.readout.target
            {
                let name = scene.name(target.target.body);
                let text = format!("{name}  {}", format::length(target.ground_distance_m.unwrap_or(target.distance_m)));
                painter.text(at + egui::vec2(14.0, 0.0), Align2::LEFT_CENTER, text, style::mono(11.5), colour);
            }
        }
    }
    // Bodies too small to be seen as discs get a ring and their name; the host is under the ship and needs none.
    let names = snapshot.bodies.iter().map(|b| (b.id, b.centre_m, b.radius_m));
    let star = std::iter::once((snapshot.star.id, snapshot.star.centre_m, snapshot.star.radius_m));
    let mut taken: Vec<Pos2> = Vec::new();
    for (id, centre, radius) in names.chain(star) {
        let distance = centre.length();
        let angle = (radius / distance.max(radius)).asin();
        if id == scene.readout.body.0 || angle > 0.12 {
            continue;
        }
        let Some(at) = project(camera, screen, centre).filter(|p| inside.contains(*p)) else { continue };
        if hidden(snapshot, id, centre) || taken.iter().any(|p| p.distance(at) < 22.0) {
            continue;
        }
        taken.push(at);
        let ring = (angle / camera.pixel_rad() * screen.height() / narrow(f64::from(camera.size_px[1].max(1)))).max(3.0) + 3.0;
        let colour = Color32::from_rgba_unmultiplied(200, 210, 220, 110);
        painter.circle_stroke(at, ring, Stroke::new(1.0, colour));
        painter.text(at + egui::vec2(ring + 4.0, 0.0), Align2::LEFT_CENTER, scene.name_of(id), style::words(11.0), colour);
    }
}

/// True when a body stands behind another one.
fn hidden(snapshot: &engine::scene::Snapshot, id: u16, centre: Vec3) -> bool {
    let distance = centre.length();
    let direction = centre.normalize_or_zero();
    snapshot.bodies.iter().any(|b| {
        let along = b.centre_m.dot(direction);
        b.id != id && along > 0.0 && along < distance && (b.centre_m - direction * along).length() < b.radius_m
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn the_view_axis_is_the_middle_and_up_is_up() {
        let camera = Camera { view_from_icrf: Quat::IDENTITY, fov_y_rad: 1.0, near_m: 0.1, size_px: [200, 100] };
        let screen = Rect::from_min_max(Pos2::new(0.0, 0.0), Pos2::new(200.0, 100.0));
        assert_eq!(project(&camera, screen, Vec3::NEG_Z), Some(Pos2::new(100.0, 50.0)));
        assert_eq!(project(&camera, screen, Vec3::Z), None);
        // The upper edge of a field of view of 1 rad is half a radian up.
        let edge = project(&camera, screen, Vec3::new(0.0, 0.5_f32.sin(), -(0.5_f32.cos()))).unwrap();
        assert!(edge.y.abs() < 1e-3 && (edge.x - 100.0).abs() < 1e-3);
    }
}
