//! The surface map: latitude and longitude of the dominating body, with relief, ground track, ship and landing spot.
//! A click or typed numbers choose the spot. The relief is sampled from the function that is drawn and collided with.

use super::panels::area;
use super::{Reply, Scene, format, style};
use crate::command::{Action, Spot, Target};
use crate::world::ship::Motion;
use crate::world::ship::course::Course;
use egui::{Align2, Color32, ColorImage, Painter, Pos2, Rect, RichText, Sense, Stroke, TextureHandle, TextureOptions, Vec2};
use engine::orbit::BodyId;
use engine::space::relative::narrow;
use engine::space::sphere;

const SIZE: [usize; 2] = [360, 180];
/// A globe goes on where the picture begins anew.
const PICTURE: TextureOptions = TextureOptions { wrap_mode: egui::TextureWrapMode::Repeat, ..TextureOptions::LINEAR };
/// Rows of the picture that are sampled in a frame: the map fills within a second and the game stays fluent.
const ROWS_A_FRAME: usize = 6;

/// The map's picture and what is typed.
#[derive(Default)]
pub struct SurfaceView {
    body: Option<BodyId>,
    heights: Vec<f64>,
    texture: Option<TextureHandle>,
    lat: String,
    lon: String,
    refused: bool,
}

impl std::fmt::Debug for SurfaceView {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SurfaceView").field("body", &self.body).field("sampled", &self.heights.len()).finish_non_exhaustive()
    }
}

/// Reads `lat` and `lon` in degrees; `None` where one is no number or out of range.
pub fn typed(lat: &str, lon: &str) -> Option<Spot> {
    let (lat, lon): (f64, f64) = (lat.trim().parse().ok()?, lon.trim().parse().ok()?);
    ((-90.0..=90.0).contains(&lat) && (-180.0..=360.0).contains(&lon)).then(|| spot(lat, lon))
}

/// A spot from degrees; the longitude is brought into −180 … 180.
#[allow(clippy::cast_possible_truncation)]
fn spot(lat_deg: f64, lon_deg: f64) -> Spot {
    let lon = libm::remainder(lon_deg, 360.0);
    Spot { lat_udeg: (lat_deg.clamp(-90.0, 90.0) * 1e6).round() as i32, lon_udeg: (lon * 1e6).round() as i32 }
}

/// The surface map's screen.
pub fn show(ctx: &egui::Context, scene: &Scene<'_>, view: &mut SurfaceView, opacity: f32, reply: &mut Reply) {
    let id = scene.readout.body;
    view.sample(ctx, scene, id);
    let screen = ctx.content_rect();
    let target = scene.world.target.filter(|t| t.body == id).and_then(|t| t.spot);
    egui::Area::new(egui::Id::unique("surface")).fixed_pos(screen.min).order(egui::Order::Background).fade_in(false).show(ctx, |ui| {
        let (whole, _) = ui.allocate_exact_size(screen.size(), Sense::hover());
        ui.painter().rect_filled(whole, 0, Color32::from_rgb(5, 7, 11));
        let width = (whole.width() - 24.0).min((whole.height() - 150.0) * 2.0).max(200.0);
        let rect = Rect::from_center_size(whole.center() + Vec2::new(0.0, 20.0), Vec2::new(width, 0.5 * width));
        let response = ui.interact(rect, ui.scope_id().with("chart"), Sense::click());
        let painter = ui.painter_at(rect);
        if let Some(texture) = &view.texture {
            let all = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(texture.id(), rect, all, Color32::WHITE);
        }
        grid(&painter, rect);
        track(&painter, rect, scene, id);
        let at = |lat: f64, lon: f64| place(rect, lat, lon);
        let (lat, lon) = scene.readout.lat_lon_rad;
        painter.circle_filled(at(lat.to_degrees(), lon.to_degrees()), 4.0, style::ACCENT);
        painter.circle_stroke(at(lat.to_degrees(), lon.to_degrees()), 8.0, Stroke::new(1.3, style::ACCENT));
        if let Some(s) = target {
            let p = at(f64::from(s.lat_udeg) * 1e-6, f64::from(s.lon_udeg) * 1e-6);
            super::ball::glyph(&painter, p, 11.0, super::ball::Glyph::Target, style::DANGER);
        }
        if let Some(p) = response.hover_pos() {
            let (lat, lon) = lat_lon(rect, p);
            let text = format::place(lat.to_radians(), lon.to_radians());
            painter.text(p + Vec2::new(12.0, -12.0), Align2::LEFT_BOTTOM, text, style::mono(12.0), style::TEXT);
            if response.clicked() {
                let chosen = spot(lat, lon);
                (view.lat, view.lon) = (format!("{lat:.4}"), format!("{lon:.4}"));
                reply.actions.push(Action::Target(Some(Target { body: id, spot: Some(chosen) })));
            }
        }
    });
    area(ctx, "surface legend", Align2::LEFT_TOP, [12.0, 12.0], |ui| {
        style::panel(opacity).show(ui, |ui| {
            ui.label(RichText::new(format!("Surface of {}", scene.name(id))).font(style::words(17.0)).color(style::TEXT));
            ui.horizontal(|ui| {
                ui.label(style::note("Lat"));
                ui.add(egui::TextEdit::singleline(&mut view.lat).desired_width(78.0).hint_text("37.739"));
                ui.label(style::note("Lon"));
                ui.add(egui::TextEdit::singleline(&mut view.lon).desired_width(78.0).hint_text("-25.668"));
                if ui.button("Set").clicked() {
                    let chosen = typed(&view.lat, &view.lon);
                    view.refused = chosen.is_none();
                    if chosen.is_some() {
                        reply.actions.push(Action::Target(Some(Target { body: id, spot: chosen })));
                    }
                }
            });
            if view.refused {
                ui.label(RichText::new("Latitude −90 … 90, longitude −180 … 360, in degrees").color(style::DANGER));
            }
            ui.label(style::note("click: landing spot"));
        });
    });
}

impl SurfaceView {
    /// The picture of a body as far as it is made; some more rows of the relief are sampled in each frame.
    pub fn picture(&mut self, ctx: &egui::Context, scene: &Scene<'_>, id: BodyId) -> Option<egui::TextureId> {
        self.sample(ctx, scene, id);
        self.texture.as_ref().map(TextureHandle::id)
    }

    /// Samples some more rows of the relief and remakes the picture.
    fn sample(&mut self, ctx: &egui::Context, scene: &Scene<'_>, id: BodyId) {
        if self.body != Some(id) {
            *self = Self { body: Some(id), ..Self::default() };
        }
        let done = self.heights.len() / SIZE[0];
        if done >= SIZE[1] {
            return;
        }
        let body = scene.world.system.body(id);
        for y in done..(done + ROWS_A_FRAME).min(SIZE[1]) {
            for x in 0..SIZE[0] {
                let lat = 90.0 - 180.0 * (y as f64 + 0.5) / SIZE[1] as f64;
                let lon = 360.0 * (x as f64 + 0.5) / SIZE[0] as f64 - 180.0;
                let d = sphere::direction_of_lat_lon(lat.to_radians(), lon.to_radians());
                self.heights.push(body.relief.as_ref().map_or(0.0, |r| r.height_m(d)));
            }
        }
        let albedo = [body.albedo.x, body.albedo.y, body.albedo.z];
        let sea = body.air.is_some() && self.heights.iter().any(|h| *h < 0.0);
        let mut pixels = vec![Color32::from_rgb(10, 13, 18); SIZE[0] * SIZE[1]];
        for (i, pixel) in pixels.iter_mut().enumerate().take(self.heights.len()) {
            let west = if i % SIZE[0] == 0 { self.heights[i] } else { self.heights[i - 1] };
            *pixel = colour(self.heights[i], self.heights[i] - west, albedo, sea);
        }
        let image = ColorImage::new(SIZE, pixels);
        match &mut self.texture {
            Some(texture) => texture.set(image, PICTURE),
            None => self.texture = Some(ctx.load_texture("surface", image, PICTURE)),
        }
        ctx.request_repaint();
    }
}

/// Colour of a height: seas by depth, land by height, shaded by its slope to the west.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn colour(height_m: f64, rise_m: f64, albedo: [f32; 3], sea: bool) -> Color32 {
    let shade = narrow((1.0 + rise_m / 1_500.0).clamp(0.6, 1.4));
    let mix = |a: [f32; 3], b: [f32; 3], t: f32| [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t);
    let rgb = if sea && height_m < 0.0 {
        mix([34.0, 66.0, 96.0], [9.0, 20.0, 40.0], narrow((-height_m / 6_000.0).clamp(0.0, 1.0)))
    } else if sea {
        let t = narrow((height_m / 4_500.0).clamp(0.0, 1.0));
        mix(mix([70.0, 92.0, 62.0], [140.0, 118.0, 84.0], (t * 2.0).min(1.0)), [236.0, 236.0, 240.0], (t * 2.0 - 1.0).max(0.0))
    } else {
        let t = narrow((0.5 + height_m / 12_000.0).clamp(0.0, 1.0));
        albedo.map(|a| (a.max(0.02).sqrt() * 200.0 + 30.0) * (0.6 + 0.6 * t))
    };
    let [r, g, b] = rgb.map(|c| (c * if sea && height_m < 0.0 { 1.0 } else { shade }).clamp(0.0, 255.0) as u8);
    Color32::from_rgb(r, g, b)
}

fn place(rect: Rect, lat_deg: f64, lon_deg: f64) -> Pos2 {
    let x = narrow(libm::remainder(lon_deg, 360.0) / 360.0 + 0.5);
    let y = narrow(0.5 - lat_deg / 180.0);
    rect.min + Vec2::new(x * rect.width(), y * rect.height())
}

fn lat_lon(rect: Rect, p: Pos2) -> (f64, f64) {
    let x = f64::from((p.x - rect.left()) / rect.width());
    let y = f64::from((p.y - rect.top()) / rect.height());
    (90.0 - 180.0 * y.clamp(0.0, 1.0), 360.0 * x.clamp(0.0, 1.0) - 180.0)
}

fn grid(painter: &Painter, rect: Rect) {
    let line = |a: Pos2, b: Pos2, alpha: u8| _ = painter.line_segment([a, b], Stroke::new(0.8, Color32::from_white_alpha(alpha)));
    for lat in (-60..=60).step_by(30) {
        let y = place(rect, f64::from(lat), 0.0).y;
        line(Pos2::new(rect.left(), y), Pos2::new(rect.right(), y), if lat == 0 { 60 } else { 24 });
    }
    for lon in (-150..=150).step_by(30) {
        let x = place(rect, 0.0, f64::from(lon)).x;
        line(Pos2::new(x, rect.top()), Pos2::new(x, rect.bottom()), if lon == 0 { 60 } else { 24 });
    }
}

/// Where the ship will be above the ground in the next revolution and a half.
fn track(painter: &Painter, rect: Rect, scene: &Scene<'_>, id: BodyId) {
    let Motion::Coast(coast) = &scene.world.ship.motion else { return };
    let period = scene.readout.orbit.period_s;
    let seconds = if period.is_finite() { (1.5 * period).min(10.0 * 86_400.0) } else { 7_200.0 };
    let body = scene.world.system.body(id);
    let mut course = Course::of(&scene.world.system, *coast.path.knot(), scene.world.ship.light_m3_s2(&scene.world.system));
    let mut last: Option<Pos2> = None;
    for i in 0..=300_u32 {
        let t = scene.world.time.plus(ticks(seconds * f64::from(i) / 300.0));
        let Some(state) = course.at(t) else { break };
        let r = state.position.0;
        if r.length() < body.radius_m {
            break;
        }
        let (lat, lon) = sphere::lat_lon_of(body.spin.icrf_from_fixed(t).inverse().raw(r));
        let p = place(rect, lat.to_degrees(), lon.to_degrees());
        if let Some(from) = last.filter(|l| (l.x - p.x).abs() < 0.5 * rect.width()) {
            painter.line_segment([from, p], Stroke::new(1.3, style::ACCENT.gamma_multiply(0.75)));
        }
        last = Some(p);
    }
}

#[allow(clippy::cast_possible_truncation)]
fn ticks(seconds: f64) -> i64 {
    (seconds * engine::time::TICKS_PER_SECOND as f64) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_spots_are_checked_and_wrapped() {
        assert_eq!(typed("37.5", " -25.25 "), Some(Spot { lat_udeg: 37_500_000, lon_udeg: -25_250_000 }));
        assert_eq!(typed("0", "359"), Some(Spot { lat_udeg: 0, lon_udeg: -1_000_000 }));
        for (lat, lon) in [("91", "0"), ("0", "361"), ("nan", "0"), ("", ""), ("north", "1"), ("inf", "0")] {
            assert_eq!(typed(lat, lon), None, "{lat} {lon}");
        }
    }

    #[test]
    fn the_chart_and_its_inverse_agree() {
        let rect = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(720.0, 360.0));
        for (lat, lon) in [(0.0, 0.0), (45.0, -120.0), (-80.0, 179.0)] {
            let (a, b) = lat_lon(rect, place(rect, lat, lon));
            assert!((a - lat).abs() < 1e-3 && (b - lon).abs() < 1e-3, "{lat} {lon} {a} {b}");
        }
        assert!(place(rect, 90.0, 0.0).y <= rect.top() + 1e-3, "north is up");
    }
}
