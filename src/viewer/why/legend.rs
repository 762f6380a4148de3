//! What false colours mean, and the switches of the model's parts.

use bevy::prelude::*;
use bevy_egui::egui::{self, RichText};

use crate::growth::Mechanisms;
use crate::render::Overlay;
use crate::scenario::{Edit, Order};

/// The name of an overlay, and what its low end, middle and high end stand for.
pub fn words(overlay: Overlay) -> (&'static str, [&'static str; 3]) {
    match overlay {
        Overlay::Light => ("Light", ["0", "0.5", "1"]),
        Overlay::Space => ("Space", ["0", "0.5", "1"]),
        Overlay::Energy => ("Energy", ["none", "a quarter", "most"]),
        Overlay::Radius => ("Radius", ["1 mm", "32 mm", "1 m"]),
        Overlay::Age => ("Age", ["0", "7", "64 steps"]),
        Overlay::Order => ("Order", ["0", "3", "7"]),
    }
}

fn color32(color: LinearRgba) -> egui::Color32 {
    let [r, g, b, _] = Srgba::from(color).to_u8_array();
    egui::Color32::from_rgb(r, g, b)
}

/// Draws the scale of an overlay's colours.
pub fn show(ui: &mut egui::Ui, overlay: Overlay) {
    let (name, marks) = words(overlay);
    ui.label(RichText::new(name).strong());
    let width = ui.available_width().min(260.0);
    let (strip, _) = ui.allocate_exact_size(egui::vec2(width, 12.0), egui::Sense::hover());
    const PIECES: usize = 48;
    for k in 0..PIECES {
        let at = |k: usize| strip.left() + strip.width() * k as f32 / PIECES as f32;
        let piece = egui::Rect::from_x_y_ranges(at(k)..=at(k + 1) + 0.5, strip.y_range());
        let value = (k as f32 + 0.5) / PIECES as f32;
        ui.painter().rect_filled(piece, 0.0, color32(Overlay::color(value)));
    }
    let (line, _) = ui.allocate_exact_size(egui::vec2(width, 14.0), egui::Sense::hover());
    let aligns = [egui::Align2::LEFT_TOP, egui::Align2::CENTER_TOP, egui::Align2::RIGHT_TOP];
    let places = [line.left_top(), line.center_top(), line.right_top()];
    let color = ui.visuals().weak_text_color();
    for ((mark, align), at) in marks.iter().zip(aligns).zip(places) {
        ui.painter().text(at, align, mark, egui::FontId::proportional(11.0), color);
    }
}

/// Choice of an overlay, or none, with its scale.
pub fn choose(ui: &mut egui::Ui, overlay: &mut Option<Overlay>) {
    ui.horizontal_wrapped(|ui| {
        ui.selectable_value(overlay, None, "Natural");
        for each in Overlay::ALL {
            ui.selectable_value(overlay, Some(each), words(each).0);
        }
    });
    if let Some(overlay) = *overlay {
        show(ui, overlay);
    }
}

/// The switches for light, space and energy (figure 1 a to d of Lam & King).
///
/// A change counts from the head on, or with `regrow` from the beginning.
pub fn switches(ui: &mut egui::Ui, now: Mechanisms, regrow: &mut bool, orders: &mut Vec<Order>) {
    let mut next = now;
    ui.horizontal(|ui| {
        ui.checkbox(&mut next.light, "Light").on_hover_text(
            "Buds grow towards light, leaves earn by it. Off: everything counts as fully lit.",
        );
        ui.checkbox(&mut next.space, "Space")
            .on_hover_text("Buds grow towards free space. Off: everything counts as free.");
        ui.checkbox(&mut next.energy, "Energy").on_hover_text(
            "Growth needs energy. Off: every bud and leaf has all it can use, nothing is paid or shed.",
        );
    });
    ui.checkbox(regrow, "regrow from the beginning")
        .on_hover_text("Off: what has grown stays, and grows on.");
    if next != now {
        let step = if *regrow { Some(0) } else { None };
        orders.push(Order::Edit { step, edit: Edit::Mechanisms(next), drag: false });
    }
}
