//! Small pieces that panels are made of: anchored areas, rows of label and value, bars.

use super::style;
use egui::{Align2, Color32, CornerRadius, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, Vec2};

/// An area at a corner or edge of the window.
pub fn area<R>(ctx: &egui::Context, id: &str, align: Align2, offset: [f32; 2], add: impl FnOnce(&mut Ui) -> R) -> R {
    egui::Area::new(egui::Id::unique(id)).anchor(align, offset).order(egui::Order::Middle).fade_in(false).show(ctx, add).inner
}

/// A row: label on the left, value on the right, in a fixed width, so that digits do not move what is below them.
pub fn row(ui: &mut Ui, width: f32, label: &str, value: &str, colour: Color32) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(width, 17.0), Sense::hover());
    let painter = ui.painter();
    painter.text(rect.left_center(), Align2::LEFT_CENTER, label, style::words(12.0), style::DIM);
    painter.text(rect.right_center(), Align2::RIGHT_CENTER, value, style::mono(13.0), colour);
}

/// A bar, filled to a fraction, from the bottom (tall) or from the left (wide).
pub fn bar(painter: &egui::Painter, rect: Rect, fraction: f32, colour: Color32) {
    let fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.0 };
    painter.rect_filled(rect, CornerRadius::same(2), style::ground(0.8));
    let inner = rect.shrink(1.5);
    let filled = if rect.height() > rect.width() {
        Rect::from_min_max(Pos2::new(inner.left(), inner.bottom() - inner.height() * fraction), inner.max)
    } else {
        Rect::from_min_max(inner.min, Pos2::new(inner.left() + inner.width() * fraction, inner.bottom()))
    };
    painter.rect_filled(filled, CornerRadius::same(1), colour);
    painter.rect_stroke(rect, CornerRadius::same(2), Stroke::new(1.0, style::LINE), StrokeKind::Inside);
}
