//! The look: dark translucent panels, hairlines, one accent (the colour of the corona), digits that do not jump.

use egui::{Color32, CornerRadius, FontFamily, FontId, Frame, Margin, RichText, Stroke, TextStyle, Ui, Vec2};

/// The one accent.
pub const ACCENT: Color32 = Color32::from_rgb(255, 190, 92);
/// Text that matters.
pub const TEXT: Color32 = Color32::from_rgb(232, 236, 240);
/// Text that explains.
pub const DIM: Color32 = Color32::from_rgb(140, 150, 162);
/// Danger.
pub const DANGER: Color32 = Color32::from_rgb(255, 92, 76);
/// Something that is as it should be.
pub const GOOD: Color32 = Color32::from_rgb(122, 214, 170);
/// Hairlines.
pub const LINE: Color32 = Color32::from_rgb(58, 66, 76);

/// The panels' ground at an opacity of 0 … 1.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub fn ground(opacity: f32) -> Color32 {
    Color32::from_rgba_unmultiplied(8, 11, 16, (opacity.clamp(0.0, 1.0) * 255.0) as u8)
}

/// A panel.
pub fn panel(opacity: f32) -> Frame {
    Frame::new()
        .fill(ground(opacity))
        .stroke(Stroke::new(1.0, Color32::from_rgba_unmultiplied(255, 255, 255, 20)))
        .corner_radius(CornerRadius::same(6))
        .inner_margin(Margin::symmetric(12, 10))
}

/// Digits.
pub fn mono(size: f32) -> FontId {
    FontId::new(size, FontFamily::Monospace)
}

/// Words.
pub fn words(size: f32) -> FontId {
    FontId::new(size, FontFamily::Proportional)
}

/// A heading of a page.
pub fn title(text: &str) -> RichText {
    RichText::new(text).font(words(26.0)).color(TEXT)
}

/// A small heading within a panel.
pub fn heading(text: &str) -> RichText {
    RichText::new(text.to_uppercase()).font(words(11.0)).color(ACCENT)
}

/// An explanation.
pub fn note(text: impl Into<String>) -> RichText {
    RichText::new(text).font(words(13.0)).color(DIM)
}

/// A button that stands out while `on`.
pub fn toggle(ui: &mut Ui, on: bool, text: &str) -> egui::Response {
    let label = RichText::new(text).font(words(12.0)).color(if on { Color32::BLACK } else { TEXT });
    ui.add(egui::Button::new(label).fill(if on { ACCENT } else { Color32::from_rgb(27, 32, 39) }))
}

/// Sets fonts' sizes, colours and spacing of a context; the default fonts are built in.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Heading, words(22.0)),
            (TextStyle::Body, words(14.5)),
            (TextStyle::Button, words(14.5)),
            (TextStyle::Monospace, mono(13.5)),
            (TextStyle::Small, words(11.5)),
        ]
        .into();
        style.spacing.item_spacing = Vec2::new(8.0, 5.0);
        style.spacing.button_padding = Vec2::new(9.0, 4.0);
        style.spacing.slider_width = 190.0;
        style.interaction.selectable_labels = false;
        let v = &mut style.visuals;
        v.override_text_color = None;
        v.panel_fill = Color32::from_rgb(8, 11, 16);
        v.window_fill = Color32::from_rgb(12, 15, 20);
        v.extreme_bg_color = Color32::from_rgb(4, 6, 9);
        v.faint_bg_color = Color32::from_rgb(18, 22, 28);
        v.selection.bg_fill = Color32::from_rgb(122, 84, 28);
        v.selection.stroke = Stroke::new(1.0, ACCENT);
        v.hyperlink_color = ACCENT;
        v.slider_trailing_fill = true;
        let w = &mut v.widgets;
        for (state, fill, line, text) in [
            (&mut w.noninteractive, Color32::from_rgb(12, 15, 20), LINE, TEXT),
            (&mut w.inactive, Color32::from_rgb(27, 32, 39), Color32::from_rgb(44, 51, 60), TEXT),
            // Not the accent: that is on what the keyboard stands on.
            (&mut w.hovered, Color32::from_rgb(40, 47, 56), Color32::from_rgb(112, 100, 76), Color32::WHITE),
            (&mut w.active, Color32::from_rgb(56, 64, 74), ACCENT, Color32::WHITE),
            (&mut w.open, Color32::from_rgb(33, 39, 47), LINE, TEXT),
        ] {
            state.bg_fill = fill;
            state.weak_bg_fill = fill;
            state.bg_stroke = Stroke::new(1.0, line);
            state.fg_stroke = Stroke::new(1.0, text);
            state.corner_radius = CornerRadius::same(4);
        }
    });
}
