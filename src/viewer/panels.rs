//! The panels around the scene.

pub(super) mod bars;
mod garden;
mod things;

use bevy::prelude::*;
use bevy_egui::{EguiContexts, egui};

use super::act::{Action, OwnLibrary};
use super::files::{Ask, Files};
use super::keys::KEYS;
use super::sessions::{self, Recent};
use super::size::{InterfaceSize, buttons};
use super::state::{Chosen, Course, Doomed, Past, Shown, Snapping, Toasts, Tool};
use super::style;
use super::why::inspector::Inspector;
use crate::scenario::Order;

/// What the panels remember.
#[derive(Resource, Debug)]
pub(super) struct Panels {
    /// Whether the panels at the sides are open.
    pub open: bool,
    /// Whether the help is.
    pub help: bool,
    /// Whether the hint for the first time is.
    pub hint: bool,
    /// Dark or light.
    pub dark: bool,
    /// Which species is sown, by its place in the list.
    pub species: usize,
    /// The seed being typed.
    seed: String,
    dressed: Option<bool>,
}

impl Panels {
    pub fn new(open: bool, hint: bool) -> Self {
        Self { open, help: false, hint, dark: true, species: 1, seed: String::new(), dressed: None }
    }
}

/// What panels leave of the window, logical pixels.
#[derive(Resource, Debug, Default, Clone, Copy, PartialEq)]
pub(super) struct Room {
    left: f32,
    right: f32,
    top: f32,
    bottom: f32,
    /// Whether the pointer is a panel's.
    pointer_taken: bool,
}

impl Room {
    /// What the panels take at the left, right, top and bottom.
    pub fn margins(&self) -> [f32; 4] {
        [self.left, self.right, self.top, self.bottom]
    }

    /// As it is in the window's own pixels when the interface is larger by a factor.
    fn times(self, factor: f32) -> Self {
        let Self { left, right, top, bottom, pointer_taken } = self;
        let [left, right, top, bottom] = [left, right, top, bottom].map(|margin| margin * factor);
        Self { left, right, top, bottom, pointer_taken }
    }

    /// Whether the panels have been drawn yet.
    pub fn is_known(&self) -> bool {
        self.top > 0.0
    }

    /// Whether the pointer is the scene's.
    pub fn pointer_is_free(&self) -> bool {
        !self.pointer_taken
    }
}

/// What panels show.
pub(super) struct Seen<'a> {
    pub shown: &'a Shown,
    pub course: &'a Course,
    pub past: Past,
    pub chosen: &'a Chosen,
    pub tool: Tool,
    pub doomed: usize,
    pub species: &'a [String],
    pub scenarios: &'a [String],
    pub snapping: bool,
    pub frames_a_second: Option<f64>,
    /// What saves the garden.
    pub save: Action,
    /// Earlier sessions.
    pub recent: &'a Recent,
}

/// The smallest window, in width and height, that has panels at its sides, logical pixels.
const SMALLEST: f32 = 400.0;

/// Draws the panels.
pub(super) fn draw(
    mut contexts: EguiContexts,
    shown: Res<Shown>,
    course: Res<Course>,
    past: Res<Past>,
    chosen: Res<Chosen>,
    tool: Res<Tool>,
    doomed: Res<Doomed>,
    library: Res<OwnLibrary>,
    mut panels: ResMut<Panels>,
    mut room: ResMut<Room>,
    mut toasts: ResMut<Toasts>,
    mut actions: MessageWriter<Action>,
    mut inspector: Inspector,
    mut files: ResMut<Files>,
    (snapping, mut size, recent): (Res<Snapping>, ResMut<InterfaceSize>, Res<Recent>),
) -> Result {
    let context = contexts.ctx_mut()?.clone();
    if let Err(why) = size.bypass_change_detection().follow(&context) {
        toasts.warn(why);
    }
    if panels.dressed != Some(panels.dark) {
        style::dress(&context, panels.dark);
        panels.dressed = Some(panels.dark);
    }
    let (species, scenarios) = (library.0.species_names(), library.0.scenario_names());
    let seen = Seen {
        shown: &shown,
        course: &course,
        past: *past,
        chosen: &chosen,
        tool: *tool,
        doomed: doomed.0.len(),
        species: &species,
        scenarios: &scenarios,
        snapping: snapping.0,
        frames_a_second: inspector.frames_a_second(),
        save: files.save(),
        recent: &recent,
    };
    let mut act = |action: Action| {
        actions.write(action);
    };
    let mut root = egui::Ui::new(
        context.clone(),
        "panels".into(),
        egui::UiBuilder::new().layer_id(egui::LayerId::background()).max_rect(context.viewport_rect()),
    );
    let mut left = Room::default();
    let bar =
        egui::Frame::side_top_panel(&context.global_style()).inner_margin(egui::Margin::symmetric(12, 7));
    left.top = egui::Panel::top("bar")
        .frame(bar)
        .show(&mut root, |ui| bars::top(ui, &seen, &mut panels, &mut act))
        .response
        .rect
        .height();
    left.bottom = egui::Panel::bottom("time")
        .frame(bar)
        .show(&mut root, |ui| bars::timeline(ui, &seen, &mut act))
        .response
        .rect
        .height();
    // A window smaller than its side panels would squeeze them for good.
    if panels.open && context.viewport_rect().size().min_elem() > SMALLEST {
        let side = bar.inner_margin(egui::Margin::same(12));
        left.left = egui::Panel::left("garden")
            .frame(side)
            .default_size(244.0)
            .resizable(true)
            .show(&mut root, |ui| {
                egui::ScrollArea::vertical()
                    .show(ui, |ui| garden::garden(ui, &seen, &mut panels, &mut toasts, &mut act));
            })
            .response
            .rect
            .width();
        left.right = egui::Panel::right("why")
            .frame(side)
            .default_size(320.0)
            .resizable(true)
            .show(&mut root, |ui| {
                inspector.show(ui, &shown, &course);
            })
            .response
            .rect
            .width();
    }
    // A twin takes the right half of what is free, and is drawn over all that floats there.
    let twin = inspector.make_room(&context, left.left, left.right, left.top, left.bottom);
    left.right += twin;
    // Who has opened one needs no first hint, and there is little room for it.
    panels.hint &= twin == 0.0;
    overlay(&context, &seen, &mut panels, &mut toasts, left, &mut act);
    if let Some((ask, path)) = files.bypass_change_detection().show(&context) {
        let action = inspector.chosen(&mut files, ask, path, &mut toasts);
        // A species is opened beside the scene.
        panels.open |= ask == Ask::Open && action.is_none();
        action.map(&mut act);
    }
    let whole = context.viewport_rect();
    let free = egui::Rect::from_min_max(
        whole.min + egui::vec2(left.left, left.top),
        whole.max - egui::vec2(left.right, left.bottom),
    );
    left.pointer_taken = context.egui_is_using_pointer()
        || files.is_open()
        || context.pointer_latest_pos().is_some_and(|at| {
            let floats = context.layer_id_at(at).is_some_and(|layer| layer.order != egui::Order::Background);
            floats || !free.contains(at)
        });
    room.set_if_neq(left.times(context.zoom_factor()));
    Ok(())
}

/// What floats over the scene: the tool's word, hints, messages, help.
fn overlay(
    context: &egui::Context,
    seen: &Seen,
    panels: &mut Panels,
    toasts: &mut Toasts,
    room: Room,
    act: &mut impl FnMut(Action),
) {
    // Gives the height of what it draws.
    let note = |id: &str, at: egui::Align2, by: egui::Vec2, add: &mut dyn FnMut(&mut egui::Ui)| {
        let area = egui::Area::new(egui::Id::new(id)).anchor(at, by).order(egui::Order::Foreground);
        let shown = area.show(context, |ui| {
            egui::Frame::window(&context.global_style()).inner_margin(egui::Margin::symmetric(12, 8)).show(
                ui,
                |ui| {
                    // Words stand in the middle beside buttons.
                    ui.spacing_mut().interact_size.y = 24.0;
                    add(ui);
                },
            );
        });
        shown.response.rect.height()
    };
    let mut top = egui::vec2(0.5 * (room.left - room.right), room.top + 10.0);
    let word = match seen.tool {
        Tool::Prune if seen.doomed > 0 => Some(format!("click cuts {}", bars::organs(seen.doomed))),
        Tool::Prune => Some("point at a branch to cut it".into()),
        Tool::Place(_) => Some("click on the ground to set it".into()),
        Tool::Resow(_) => Some("click on the ground to sow it there".into()),
        Tool::Choose if seen.doomed > 0 => Some(format!("would shed {}", bars::organs(seen.doomed))),
        Tool::Choose => None,
    };
    if let Some(word) = word {
        top.y += 8.0
            + note("tool", egui::Align2::CENTER_TOP, top, &mut |ui| {
                let color = if seen.doomed > 0 { style::RUST } else { style::LEAF };
                ui.colored_label(style::ink(ui, color), &word);
            });
    }
    // What floats leaves the panels uncovered, down to where no word would fit between them.
    let free = (context.viewport_rect().width() - room.left - room.right - 56.0).max(150.0);
    if let Some(kept) = seen.recent.offered() {
        note("offer", egui::Align2::CENTER_TOP, top, &mut |ui| {
            ui.set_max_width(free);
            ui.horizontal_wrapped(|ui| {
                let what = sessions::words(kept, std::time::SystemTime::now());
                ui.label(format!("A session was cut short: {what}."));
                if ui.button("Restore").on_hover_text("Go on where it was saved last").clicked() {
                    act(Action::Tell(Order::Load(kept.file.clone())));
                }
                if ui.button("Dismiss").on_hover_text("It stays under Recent").clicked() {
                    act(Action::Dismiss(kept.file.clone()));
                }
            });
        });
    }
    // Messages stand above the hint.
    let mut above = room.bottom + 14.0;
    if panels.hint {
        let by = egui::vec2(0.5 * (room.left - room.right), -above);
        above += 8.0
            + note("hint", egui::Align2::CENTER_BOTTOM, by, &mut |ui| {
                ui.set_max_width(free);
                ui.label("Drag to look around; the wheel brings the tree nearer.");
                ui.label("Press W or L and click on the ground: a wall, a lamp. The tree answers.");
                ui.horizontal_wrapped(|ui| {
                    ui.label("Click a bud to ask it why.  ?  shows every key.");
                    if ui.button("Good").clicked() {
                        panels.hint = false;
                    }
                });
            });
    }
    let current = toasts.current();
    if !current.is_empty() {
        let by = egui::vec2(-room.right - 14.0, -above);
        note("toasts", egui::Align2::RIGHT_BOTTOM, by, &mut |ui| {
            ui.set_max_width(free.min(380.0));
            for toast in current {
                let color = if toast.bad { style::ink(ui, style::RUST) } else { ui.visuals().text_color() };
                ui.colored_label(color, &toast.text);
            }
        });
    }
    if panels.help {
        let mut open = true;
        egui::Window::new("Keys")
            .open(&mut open)
            .collapsible(false)
            .resizable(false)
            .default_pos([320.0, 70.0])
            .show(context, |ui| {
                egui::Grid::new("keys").num_columns(2).spacing([24.0, 5.0]).show(ui, |ui| {
                    for (key, does) in KEYS {
                        ui.colored_label(style::ink(ui, style::LEAF), *key);
                        ui.label(*does);
                        ui.end_row();
                    }
                });
                ui.separator();
                buttons(ui);
            });
        panels.help = open;
    }
}
