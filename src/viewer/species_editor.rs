//! Editing a species: every parameter of the one table, applied from now on or from the beginning.

pub mod draft;
pub mod file;
mod meter;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use bevy::prelude::*;
use bevy_egui::egui::{self, RichText};

use crate::plant::Snapshot;
use crate::scenario::Order;
use crate::species::Species;
use crate::species::parameter::{Parameter, ParameterError, Range, Value};
use crate::viewer::{Action, Ask};
use draft::{Draft, When};
use file::SpeciesFile;

/// What of a species is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Page {
    /// The table of all parameters.
    #[default]
    Parameters,
    /// What lag and ratio make of an error.
    Steering,
}

/// The editor.
#[derive(Default)]
pub struct SpeciesEditor {
    draft: Option<Draft>,
    file: Option<SpeciesFile>,
    page: Page,
    filter: String,
    only_changed: bool,
    when: When,
    /// What went wrong last.
    error: Option<String>,
    /// What went well last.
    done: Option<String>,
}

impl SpeciesEditor {
    /// Reads the watched file again if it has changed; a bad one keeps the old species and shows its error.
    pub fn watch(&mut self, now: Instant, orders: &mut Vec<Order>) {
        // A file opened before there was anything to compare it with waits.
        let (Some(file), Some(draft)) = (&mut self.file, &mut self.draft) else { return };
        match file.changed(now) {
            None => {}
            Some(Ok(species)) => {
                self.error = None;
                draft.take_over(&species);
                if let Some(order) = draft.order(self.when) {
                    self.done = Some("The file has changed and was taken over.".into());
                    orders.push(order);
                }
            }
            Some(Err(bad)) => {
                self.done = None;
                self.error = Some(bad.to_string());
            }
        }
    }

    /// Name of the species that is edited.
    pub fn name(&self) -> Option<&str> {
        self.draft.as_ref().map(Draft::name)
    }

    /// Takes over the species in a file, and again whenever an editor changes it.
    pub fn open(&mut self, path: PathBuf) {
        self.error = None;
        self.file = Some(SpeciesFile::watch(path));
    }

    /// Writes the species as it shall be.
    pub fn save(&mut self, path: &Path) {
        let Some(draft) = &self.draft else { return };
        (self.error, self.done) = match file::write(path, draft.species()) {
            Ok(()) => (None, Some(format!("{} written", path.display()))),
            Err(bad) => (Some(bad.to_string()), None),
        };
    }

    /// The panel, of the species of the plants shown.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        plants: &Snapshot,
        orders: &mut Vec<Order>,
        actions: &mut Vec<Action>,
    ) {
        let mut kinds: Vec<Arc<Species>> = Vec::new();
        for plant in plants.plants.iter().flatten() {
            if !kinds.iter().any(|kind| kind.name == plant.species.name) {
                kinds.push(plant.species.clone());
            }
        }
        let Some(first) = kinds.first() else {
            ui.label(RichText::new("No plant stands here.").weak());
            return;
        };
        let wanted = self.draft.as_ref().map_or(first.name.clone(), |draft| draft.name().to_string());
        let now = kinds.iter().find(|kind| kind.name == wanted).unwrap_or(first);
        match &mut self.draft {
            Some(draft) if draft.name() == now.name => draft.follow(now),
            draft => *draft = Some(Draft::of(now)),
        }
        ui.horizontal(|ui| {
            self.choose(ui, &kinds);
            ui.selectable_value(&mut self.page, Page::Parameters, "Parameters");
            ui.selectable_value(&mut self.page, Page::Steering, "Steering")
                .on_hover_text("What lag and compensation ratio make of an error");
        });
        let Some(draft) = &mut self.draft else { return };
        if self.page == Page::Parameters {
            if !draft.now().description.is_empty() {
                ui.label(RichText::new(&draft.now().description).small().weak());
            }
            ui.horizontal(|ui| {
                ui.add(egui::TextEdit::singleline(&mut self.filter).hint_text("Find").desired_width(120.0));
                ui.checkbox(&mut self.only_changed, "changed only");
            });
        }
        let height = (ui.available_height() - 130.0).max(140.0);
        // Wide rows are moved aside rather than widening the panel for good.
        let aside = self.page == Page::Parameters;
        let scroll = egui::ScrollArea::new([aside, true]).max_height(height).auto_shrink([false, true]);
        let set = scroll.show(ui, |ui| match self.page {
            Page::Parameters => rows(ui, draft, &self.filter, self.only_changed),
            Page::Steering => meter::show(ui, draft),
        });
        if let Some(set) = set.inner {
            self.error = set.err().map(|why| why.to_string());
        }
        ui.separator();
        self.apply(ui, orders);
        self.files(ui, actions);
        if let Some(error) = &self.error {
            ui.colored_label(ui.visuals().error_fg_color, error);
        } else if let Some(done) = &self.done {
            ui.label(RichText::new(done).weak());
        }
    }

    /// Which species is edited.
    fn choose(&mut self, ui: &mut egui::Ui, kinds: &[Arc<Species>]) {
        let name = self.draft.as_ref().map_or(String::new(), |draft| draft.name().to_string());
        egui::ComboBox::from_id_salt("species").selected_text(&name).show_ui(ui, |ui| {
            for kind in kinds {
                if ui.selectable_label(kind.name == name, &kind.name).clicked() && kind.name != name {
                    self.draft = Some(Draft::of(kind));
                }
            }
        });
    }

    fn apply(&mut self, ui: &mut egui::Ui, orders: &mut Vec<Order>) {
        let Some(draft) = &mut self.draft else { return };
        let changes = draft.changes().len();
        ui.horizontal_wrapped(|ui| {
            ui.radio_value(&mut self.when, When::GoOn, "go on").on_hover_text(When::GoOn.help());
            ui.radio_value(&mut self.when, When::Regrow, "regrow").on_hover_text(When::Regrow.help());
            let text = match changes {
                0 => "Apply".to_string(),
                1 => "Apply 1 change".to_string(),
                n => format!("Apply {n} changes"),
            };
            if ui.add_enabled(changes > 0, egui::Button::new(text)).clicked() {
                self.done = None;
                self.error = None;
                orders.extend(draft.order(self.when));
            }
            if ui.add_enabled(changes > 0, egui::Button::new("Discard")).clicked() {
                draft.discard();
            }
        });
    }

    fn files(&mut self, ui: &mut egui::Ui, actions: &mut Vec<Action>) {
        ui.horizontal(|ui| {
            if ui
                .button("Open …")
                .on_hover_text("Takes over a species file, and again whenever an editor changes it.")
                .clicked()
            {
                actions.push(Action::Ask(Ask::Open));
            }
            if ui.button("Save …").on_hover_text("Writes the species as it is here.").clicked() {
                actions.push(Action::Ask(Ask::Species));
            }
        });
        if let Some(file) = &self.file {
            let path = file.path().display().to_string();
            ui.horizontal(|ui| {
                ui.label(RichText::new(format!("watching {path}")).small().weak());
                if ui.small_button("stop").clicked() {
                    self.file = None;
                }
            });
        }
    }
}

/// A row for every parameter that is wanted; what came of setting one, an error if the value is not allowed.
fn rows(
    ui: &mut egui::Ui,
    draft: &mut Draft,
    filter: &str,
    only_changed: bool,
) -> Option<Result<(), ParameterError>> {
    let mut set = None;
    let filter = filter.trim().to_lowercase();
    egui::Grid::new("parameters").num_columns(3).striped(true).spacing([8.0, 3.0]).show(ui, |ui| {
        for row in Species::parameters() {
            // A unit at the end of the name stands behind the value.
            let stem = row.name.strip_suffix(&format!("_{}", row.unit)).unwrap_or(row.name);
            let words = stem.replace('_', " ");
            let found =
                filter.is_empty() || words.contains(&filter) || row.help.to_lowercase().contains(&filter);
            let changed = draft.is_changed(row.name);
            if !found || (only_changed && !changed) {
                continue;
            }
            let Some(value) = draft.species().get(row.name) else { continue };
            let name = RichText::new(words);
            let label = ui.label(if changed { name.strong() } else { name });
            label.on_hover_ui(|ui| help(ui, row));
            let mut new = value.clone();
            // From the top: a list may be of several rows.
            ui.horizontal_top(|ui| {
                editor(ui, row, &mut new);
                if !row.unit.is_empty() {
                    ui.label(RichText::new(row.unit).small().weak());
                }
            });
            if new != value {
                set = Some(draft.set(row.name, &new));
            }
            if changed {
                if ui.small_button("↺").on_hover_text("As it is now").clicked() {
                    draft.reset(row.name);
                }
            } else {
                ui.label("");
            }
            ui.end_row();
        }
    });
    set
}

/// What a parameter is, its unit, range and default.
fn help(ui: &mut egui::Ui, row: &Parameter) {
    ui.set_max_width(320.0);
    ui.label(row.help);
    let unit = if row.unit.is_empty() { String::new() } else { format!(" {}", row.unit) };
    ui.label(RichText::new(format!("{}: {}{unit}", row.name, row.allowed())).weak());
    ui.label(RichText::new(format!("by default {}{unit}", row.default)).weak());
}

/// Numbers of a list side by side.
const LIST_ROW: usize = 3;

/// The widget for a value.
pub(super) fn editor(ui: &mut egui::Ui, row: &Parameter, value: &mut Value) {
    let (low, high) = match row.range {
        Range::Real { min, max } => (min, max),
        Range::Whole { min, max } => (f64::from(min), f64::from(max)),
        Range::Any => (f64::from(f32::MIN), f64::from(f32::MAX)),
    };
    let number = |ui: &mut egui::Ui, x: &mut f64| {
        let speed = (x.abs() * 0.01).max((high - low).min(1.0) * 0.002);
        ui.add(egui::DragValue::new(x).range(low..=high).speed(speed).max_decimals(5))
    };
    match value {
        Value::Real(x) => {
            number(ui, x);
        }
        Value::Whole(n) => {
            ui.add(egui::DragValue::new(n).range(low..=high).speed(0.1));
        }
        Value::Flag(on) => {
            ui.checkbox(on, "");
        }
        Value::Choice(name) => {
            egui::ComboBox::from_id_salt(row.name).selected_text(name.clone()).show_ui(ui, |ui| {
                for choice in row.choices {
                    ui.selectable_value(name, (*choice).to_string(), *choice);
                }
            });
        }
        Value::List(parts) if row.name.ends_with("_color") && parts.len() == 3 => {
            let mut rgb = [0, 1, 2].map(|i| (parts[i] * 255.0).round() as u8);
            if egui::color_picker::color_edit_button_srgb(ui, &mut rgb).changed() {
                *parts = rgb.map(|part| f64::from(part) / 255.0).to_vec();
            }
        }
        Value::List(xs) => {
            ui.vertical(|ui| {
                for row in xs.chunks_mut(LIST_ROW) {
                    ui.horizontal(|ui| {
                        row.iter_mut().for_each(|x| {
                            number(ui, x);
                        });
                    });
                }
            });
            if xs.len() < crate::limits::ORDERS
                && ui.small_button("+").on_hover_text("A value for one more branch order").clicked()
            {
                xs.push(xs.last().copied().unwrap_or(low));
            }
            let least = usize::from(!matches!(&row.default, Value::List(none) if none.is_empty()));
            if xs.len() > least && ui.small_button("−").clicked() {
                xs.pop();
            }
        }
    }
}
