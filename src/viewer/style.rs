//! How panels look.

use bevy_egui::egui::{self, Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Visuals};

/// Leaf green: what can be done, what is chosen.
pub(super) const LEAF: Color32 = Color32::from_rgb(0x9c, 0xc8, 0x6a);
/// Amber: light.
pub(super) const AMBER: Color32 = Color32::from_rgb(0xf0, 0xb4, 0x52);
/// Sky blue: space.
pub(super) const SKY: Color32 = Color32::from_rgb(0x6c, 0xb4, 0xe8);
/// Rust: what goes, what did not work.
pub(super) const RUST: Color32 = Color32::from_rgb(0xe0, 0x70, 0x58);

/// A colour as it can be read on the panels: on light ones darker, and fuller so that colours stay apart.
pub(super) fn ink(ui: &egui::Ui, color: Color32) -> Color32 {
    if ui.visuals().dark_mode {
        return color;
    }
    let parts = [color.r(), color.g(), color.b()].map(f32::from);
    let grey = 0.5 * parts.into_iter().fold(255.0, f32::min);
    let [r, g, b] = parts.map(|part| (0.72 * (part - grey)) as u8);
    Color32::from_rgb(r, g, b)
}

/// Dresses a context, dark or light.
pub(super) fn dress(context: &egui::Context, dark: bool) {
    let mut visuals = if dark { Visuals::dark() } else { Visuals::light() };
    let (panel, line, field) = if dark {
        (
            // Opaque: a lamp behind a panel must not shine through its words.
            Color32::from_rgb(22, 25, 24),
            Color32::from_gray(52),
            Color32::from_rgb(14, 16, 15),
        )
    } else {
        (Color32::from_rgb(246, 245, 240), Color32::from_gray(208), Color32::WHITE)
    };
    // Words that only name a thing are quieter than what they name, and still read at arm's length.
    let (text, weak) = if dark { (214, 156) } else { (38, 98) };
    visuals.widgets.noninteractive.fg_stroke.color = Color32::from_gray(text);
    visuals.weak_text_color = Some(Color32::from_gray(weak));
    // What cannot be done now is still to be read.
    visuals.widgets.inactive.fg_stroke.color = Color32::from_gray(if dark { 200 } else { 30 });
    visuals.disabled_alpha = 0.66;
    visuals.panel_fill = panel;
    visuals.window_fill = panel;
    visuals.extreme_bg_color = field;
    visuals.window_stroke = Stroke::new(1.0, line);
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, line);
    visuals.selection.bg_fill =
        if dark { Color32::from_rgb(58, 84, 44) } else { Color32::from_rgb(190, 218, 160) };
    visuals.selection.stroke = Stroke::new(1.0, if dark { LEAF } else { Color32::from_rgb(40, 70, 20) });
    for widget in [
        &mut visuals.widgets.noninteractive,
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = CornerRadius::same(5);
    }
    visuals.window_corner_radius = CornerRadius::same(9);
    context.set_visuals(visuals);
    context.global_style_mut(|style| {
        style.spacing.item_spacing = egui::vec2(8.0, 6.0);
        style.spacing.button_padding = egui::vec2(8.0, 4.0);
        style.spacing.window_margin = Margin::same(12);
        let font = |size| FontId::new(size, FontFamily::Proportional);
        style.text_styles = [
            (TextStyle::Small, font(11.0)),
            (TextStyle::Body, font(13.5)),
            (TextStyle::Button, font(13.5)),
            (TextStyle::Heading, font(16.0)),
            (TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace)),
        ]
        .into();
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two colours as the Web Content Accessibility Guidelines reckon it, 1 to 21.
    fn contrast(a: Color32, b: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b, _] = egui::Rgba::from(color).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn what_cannot_be_done_now_can_be_read() {
        for dark in [true, false] {
            let context = egui::Context::default();
            dress(&context, dark);
            let visuals = context.global_style().visuals.clone();
            let widget = visuals.widgets.inactive;
            let faded = |color: Color32, on: Color32| on.blend(color.gamma_multiply(visuals.disabled_alpha));
            let button = faded(widget.weak_bg_fill, visuals.panel_fill);
            let words = faded(widget.fg_stroke.color, button);
            assert!(contrast(words, button) > 4.0, "dark {dark}: {}", contrast(words, button));
        }
    }
}
