//! The bar above: growth, tools, files. The bar below: time.

use bevy_egui::egui::{self, Ui};

use super::{Panels, Seen};
use crate::scenario::{Order, Progress};
use crate::viewer::act::Action;
use crate::viewer::files::Ask;
use crate::viewer::sessions;
use crate::viewer::state::{Chosen, Kind, Past, Shown, Tool};
use crate::viewer::style;

/// The least width of the bar above that has room for what is not needed, logical pixels.
const WIDE: f32 = 1000.0;

/// The bar above: what concerns the window at the right, all else at the left, in as many rows as it takes.
pub(super) fn top(ui: &mut Ui, seen: &Seen, panels: &mut Panels, act: &mut impl FnMut(Action)) {
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    let from_right = egui::Layout::right_to_left(egui::Align::Min);
    ui.allocate_ui_with_layout(size, from_right, |ui| {
        let is_wide = ui.available_width() >= WIDE;
        if ui.button("?").on_hover_text("Every key").clicked() {
            panels.help = !panels.help;
        }
        if ui
            .button(if panels.dark { "Light" } else { "Dark" })
            .on_hover_text("Light or dark panels")
            .clicked()
        {
            panels.dark = !panels.dark;
        }
        if ui.button(if panels.open { "Fold" } else { "Panels" }).on_hover_text("Panels (H)").clicked() {
            panels.open = !panels.open;
        }
        if let Some(rate) = seen.frames_a_second.filter(|_| is_wide) {
            // As high as a button, so that it stands in one line with them.
            let words = egui::RichText::new(format!("{} frames/s", frame_rate(rate))).weak();
            let height = ui.text_style_height(&egui::TextStyle::Button) + 2.0 * ui.spacing().button_padding.y;
            let label = egui::Button::new(words).frame(false).min_size(egui::vec2(0.0, height));
            ui.add(label.sense(egui::Sense::hover()));
        }
        let from_left = egui::Layout::left_to_right(egui::Align::Min).with_main_wrap(true);
        ui.with_layout(from_left, |ui| commands(ui, seen, panels, act));
    });
}

/// Tools, what was done, files.
fn commands(ui: &mut Ui, seen: &Seen, panels: &Panels, act: &mut impl FnMut(Action)) {
    let mut tool = |ui: &mut Ui, name: &str, tip: &str, which: Tool| {
        if ui.selectable_label(seen.tool == which, name).on_hover_text(tip).clicked() {
            act(Action::Take(which));
        }
    };
    tool(ui, "Choose", "Choose and move things; ask organs why (V)", Tool::Choose);
    tool(ui, "Prune", "Cut a branch and all it bears (C)", Tool::Prune);
    ui.separator();
    tool(ui, "Wall", "Set a wall (W)", Tool::Place(Kind::Wall));
    tool(ui, "Ball", "Set a ball (B)", Tool::Place(Kind::Ball));
    tool(ui, "Pillar", "Set a pillar (P)", Tool::Place(Kind::Pillar));
    tool(ui, "Lamp", "Set a lamp (L)", Tool::Place(Kind::Lamp));
    tool(
        ui,
        "Tree",
        "Sow a tree of the species chosen at the left (T)",
        Tool::Place(Kind::Plant(panels.species)),
    );
    let sun = ui.selectable_label(*seen.chosen == Chosen::Sun, "Sun");
    if sun.on_hover_text("Choose the sun, or have one rise (O)").clicked() {
        act(Action::Sun);
    }
    ui.separator();
    let progress = &seen.course.progress;
    let mut button = |ui: &mut Ui, on: bool, name: &str, tip: &str, action: Action| {
        if ui.add_enabled(on, egui::Button::new(name)).on_hover_text(tip).clicked() {
            act(action);
        }
    };
    button(ui, progress.undoable > 0, "Undo", "Take back the last edit (Ctrl+Z)", Action::Tell(Order::Undo));
    button(ui, progress.redoable > 0, "Redo", "Make it again (Ctrl+Shift+Z)", Action::Tell(Order::Redo));
    ui.separator();
    button(
        ui,
        true,
        "Open",
        "A garden, scenario, run or species (Ctrl+O); or drop its file on the window",
        Action::Ask(Ask::Open),
    );
    button(ui, true, "Save", "The whole garden with its past (Ctrl+S)", seen.save.clone());
    if seen.recent.is_kept() {
        let menu = ui.menu_button("Recent", |ui| recent(ui, seen, act));
        menu.response.on_hover_text("Earlier sessions, saved by themselves");
    }
}

/// Earlier sessions, to be taken up again.
fn recent(ui: &mut Ui, seen: &Seen, act: &mut impl FnMut(Action)) {
    let (list, now) = (seen.recent.list(), std::time::SystemTime::now());
    if list.is_empty() {
        ui.weak("no earlier session");
    }
    for kept in list {
        let cut_short = if kept.unfinished { ", cut short" } else { "" };
        if ui.button(format!("{}{cut_short}", sessions::words(&kept, now))).clicked() {
            act(Action::Tell(Order::Load(kept.file)));
        }
    }
}

/// The bar below.
pub(super) fn timeline(ui: &mut Ui, seen: &Seen, act: &mut impl FnMut(Action)) {
    let progress = &seen.course.progress;
    ui.horizontal(|ui| {
        let name = if progress.playing { "⏸" } else { "▶" };
        if ui.button(egui::RichText::new(name).size(17.0)).on_hover_text("Grow, or stop (Space)").clicked() {
            act(Action::Tell(if progress.playing { Order::Pause } else { Order::Play }));
        }
        if ui.button("Step").on_hover_text("Grow one step (.)").clicked() {
            act(Action::Tell(Order::Step));
        }
        if ui.button("Restart").on_hover_text("Back to the seed; edits stay").clicked() {
            act(Action::Tell(Order::Restart));
        }
        let mut pace = progress.pace.unwrap_or(8.0);
        ui.spacing_mut().slider_width = 70.0;
        let slider = egui::Slider::new(&mut pace, 0.1..=8.0).logarithmic(true).show_value(false);
        if ui.add(slider).on_hover_text("Steps a second").changed() {
            act(Action::Tell(Order::Pace(if pace >= 7.9 { 0.0 } else { pace })));
        }
        match progress.pace {
            Some(pace) => ui.label(format!("{pace:.1}/s")),
            None => ui.label("fastest"),
        };
        ui.separator();
        let mut step = seen.past.0.unwrap_or(progress.present);
        let text = match progress.catching_up {
            Some(to) => format!("step {} of {to}, catching up", progress.present),
            None if seen.past.0.is_some() => format!("step {step} of {}", progress.present),
            None => format!("step {step}"),
        };
        let room = ui.available_width() - 330.0;
        ui.spacing_mut().slider_width = room.max(80.0);
        let slider = egui::Slider::new(&mut step, 0..=progress.present.max(1)).show_value(false);
        if ui.add(slider).on_hover_text("Any earlier step; an edit there grows anew from there").changed() {
            act(Action::Look(Some(step)));
        }
        ui.label(text);
        if seen.past.0.is_some() && ui.button("Back to growth").clicked() {
            act(Action::Look(None));
        }
        if progress.ghost.is_some() {
            let mut on = seen.shown.with_ghost;
            if ui.checkbox(&mut on, "old course").on_hover_text("Show how it grew before the edit").changed()
            {
                act(Action::Ghost(on));
            }
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let number = organs_on_screen(seen.shown, progress, seen.past);
            ui.colored_label(style::ink(ui, style::LEAF), organs(number));
        });
    });
}

/// How many organs the step on screen has, growth's or the past one that is looked at.
fn organs_on_screen(shown: &Shown, progress: &Progress, past: Past) -> usize {
    let past = shown.view.as_ref().filter(|_| past.0.is_some());
    past.map_or(progress.organs, |view| view.shot.len())
}

/// So many organs.
pub(in crate::viewer) fn organs(number: usize) -> String {
    match number {
        1 => "1 organ".to_owned(),
        _ => format!("{} organs", thousands(number)),
    }
}

/// Frames a second, to the tenth where there are few.
pub(in crate::viewer) fn frame_rate(rate: f64) -> String {
    format!("{rate:.0$}", usize::from(rate < 9.95))
}

/// A number with its thousands apart, on one line wherever it stands.
pub(in crate::viewer) fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use bevy::prelude::default;

    use super::*;
    use crate::scenario::{Fixtures, View};

    #[test]
    fn a_number_stays_on_one_line() {
        assert_eq!(organs(2913), "2\u{a0}913 organs");
        assert_eq!(organs(1), "1 organ");
        assert_eq!(thousands(1_234_567), "1\u{a0}234\u{a0}567");
    }

    #[test]
    fn the_organs_counted_are_those_of_the_step_on_screen() {
        let standing = Fixtures {
            solids: Vec::new(),
            lamps: Vec::new(),
            sun: None,
            shore: None,
            sky: default(),
            mechanisms: default(),
        };
        let view = View { step: 11, shot: default(), standing: standing.into(), record: None };
        let shown = Shown { view: Some(view), ..default() };
        let progress = Progress { present: 13, organs: 538, ..default() };
        assert_eq!(organs_on_screen(&shown, &progress, Past(None)), 538);
        assert_eq!(organs_on_screen(&shown, &progress, Past(Some(11))), 0, "a view without organs");
    }

    #[test]
    fn few_frames_are_told_to_the_tenth() {
        let told = [0.6, 1.0, 9.94, 9.96, 59.7].map(frame_rate);
        assert_eq!(told, ["0.6", "1.0", "9.9", "10", "60"]);
    }
}
