//! The loading screen: what is being done, and how far it is. Also what is shown when it fails.

use super::style;
use egui::{Align2, Color32, Pos2, Rect, Stroke, Vec2};

/// Draws the screen: `fraction` 0 … 1 and one line.
pub fn show(ctx: &egui::Context, fraction: f32, what: &str) {
    let painter = ctx.layer_painter(egui::LayerId::background());
    let screen = ctx.content_rect();
    painter.rect_filled(screen, 0, Color32::from_rgb(4, 5, 8));
    let c = screen.center();
    // Three bodies in line: the smaller slides over the larger as the work goes on, until it is a total eclipse.
    let fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.0 };
    let sun = Pos2::new(c.x, c.y - 70.0);
    for i in 0..10_u8 {
        let r = 46.0 + f32::from(i) * f32::from(i) * 0.55;
        painter.circle_stroke(sun, r, Stroke::new(2.0, style::ACCENT.gamma_multiply(0.10 - 0.009 * f32::from(i))));
    }
    painter.circle_filled(sun, 46.0, style::ACCENT);
    painter.circle_filled(sun + Vec2::new((1.0 - fraction) * 118.0, 0.0), 46.5, Color32::from_rgb(4, 5, 8));
    painter.text(c + Vec2::new(0.0, 34.0), Align2::CENTER_CENTER, "SYZYGY", style::words(40.0), style::TEXT);
    let bar = Rect::from_center_size(c + Vec2::new(0.0, 82.0), Vec2::new(360.0, 5.0));
    super::panels::bar(&painter, bar, fraction, style::ACCENT);
    painter.text(c + Vec2::new(0.0, 104.0), Align2::CENTER_CENTER, what, style::words(13.0), style::DIM);
}
