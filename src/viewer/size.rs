//! How large the interface is: Ctrl and +, - and 0 as in browsers, remembered from one session to the next.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy_egui::egui;

/// How much larger than usual words and panels are. The keys are egui's own; this follows them and remembers.
#[derive(Resource, Debug, Default)]
pub struct InterfaceSize {
    /// As wanted or as it is; `None` until one has been chosen.
    factor: Option<f32>,
    /// Where it is remembered.
    file: Option<PathBuf>,
    /// Whether the context has it.
    set: bool,
}

/// The least and the most.
const LEAST: f32 = 0.5;
const MOST: f32 = 3.0;
/// A window so high, points at the usual size, is a large screen seen from as far as a small one.
const HIGH: f32 = 1700.0;
/// What fits such a window.
const LARGE: f32 = 1.5;

impl InterfaceSize {
    /// As it is remembered in a folder; what is unreadable there counts as nothing.
    pub fn kept_in(folder: &Path) -> Self {
        let file = folder.join("interface-size");
        let kept = std::fs::read_to_string(&file).ok().and_then(|text| text.trim().parse::<f32>().ok());
        let factor = kept.filter(|factor| (LEAST..=MOST).contains(factor));
        Self { factor, file: Some(file), set: false }
    }

    /// Keeps a context and this in line; called before each drawing.
    ///
    /// # Errors
    /// That it could not be remembered, and why.
    pub(super) fn follow(&mut self, context: &egui::Context) -> Result<(), String> {
        if !self.set {
            self.set = true;
            let large = context.viewport_rect().height() >= HIGH;
            let fits = if large { LARGE } else { 1.0 };
            context.set_zoom_factor(*self.factor.get_or_insert(fits));
            return Ok(());
        }
        let now = context.zoom_factor();
        let allowed = now.clamp(LEAST, MOST);
        if allowed != now {
            context.set_zoom_factor(allowed);
        }
        // What was asked for comes with the next drawing.
        if self.factor == Some(allowed) {
            return Ok(());
        }
        self.factor = Some(allowed);
        let Some(file) = &self.file else { return Ok(()) };
        std::fs::write(file, allowed.to_string())
            .map_err(|why| format!("the size of the interface is not remembered: {}: {why}", file.display()))
    }
}

/// Buttons that do what the keys do.
pub(super) fn buttons(ui: &mut egui::Ui) {
    ui.horizontal(|ui| {
        let now = ui.ctx().zoom_factor();
        ui.label(format!("size of the interface {:.0} %", 100.0 * now));
        for (name, tip, factor) in [
            ("−", "Smaller (Ctrl -)", now - 0.1),
            ("+", "Larger (Ctrl +)", now + 0.1),
            ("100 %", "Ctrl 0", 1.0),
        ] {
            if ui.button(name).on_hover_text(tip).clicked() {
                ui.ctx().set_zoom_factor((factor * 10.0).round() / 10.0);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws nothing, twice: what is set comes with the next pass.
    fn pass(size: &mut InterfaceSize, context: &egui::Context, height: f32) {
        for _ in 0..2 {
            let rect = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1000.0, height));
            let input = egui::RawInput { screen_rect: Some(rect), ..Default::default() };
            context.begin_pass(input);
            size.follow(context).unwrap();
            // Nobody draws it.
            context.end_pass().textures_delta.clear();
        }
    }

    #[test]
    fn a_size_is_remembered_and_kept_within_reason() {
        let folder = tempfile::tempdir().unwrap();
        let context = egui::Context::default();
        let mut size = InterfaceSize::kept_in(folder.path());
        pass(&mut size, &context, 720.0);
        assert_eq!(context.zoom_factor(), 1.0);
        for (asked, is) in [(1.3, 1.3), (0.1, LEAST), (5.0, MOST)] {
            context.set_zoom_factor(asked);
            pass(&mut size, &context, 720.0);
            pass(&mut size, &context, 720.0);
            assert_eq!(context.zoom_factor(), is);
            let next = egui::Context::default();
            pass(&mut InterfaceSize::kept_in(folder.path()), &next, 720.0);
            assert_eq!(next.zoom_factor(), is, "the next session has it");
        }
        std::fs::write(folder.path().join("interface-size"), "very large").unwrap();
        let next = egui::Context::default();
        pass(&mut InterfaceSize::kept_in(folder.path()), &next, 2160.0);
        assert_eq!(next.zoom_factor(), LARGE, "a large screen begins large");
    }
}
