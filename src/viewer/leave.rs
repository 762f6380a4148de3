//! Leaving with something: picture, pictures, film, run, code, and every export of the command line.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use bevy_egui::egui::{self, RichText};

use super::act::Action;
use super::files::Ask;
use super::picture::write_picture;
use super::why::inspector::Answers;
use crate::scenario::{News, Order};

/// What was written or went wrong last.
#[derive(Debug, Clone, PartialEq)]
enum Note {
    Working(String),
    Done(String),
    Failed(String),
}

/// The panel.
pub struct Leave {
    /// The folder as it is typed.
    folder: String,
    /// The share code, of this tree or typed in.
    code: String,
    note: Option<Note>,
    /// Things that are being written.
    waiting: Vec<PathBuf>,
    /// A picture of the window is wanted.
    shot: Option<PathBuf>,
}

impl Default for Leave {
    fn default() -> Self {
        Self { folder: "out".into(), code: String::new(), note: None, waiting: Vec::new(), shot: None }
    }
}

impl Leave {
    /// Takes in what the gardener tells.
    pub fn hear(&mut self, news: &News) {
        match news {
            News::Code(code) => {
                self.code.clone_from(code);
                self.note = Some(Note::Done("The code grows this tree again, anywhere.".into()));
            }
            News::Saved(path) if self.waiting.contains(path) => {
                self.waiting.retain(|waiting| waiting != path);
                self.note = Some(Note::Done(format!("{} written", path.display())));
            }
            News::Refused(why) => {
                self.waiting.clear();
                self.note = Some(Note::Failed(why.to_string()));
            }
            _ => {}
        }
    }

    /// Has everything go to a folder.
    pub fn set_folder(&mut self, folder: &Path) {
        self.folder = folder.display().to_string();
    }

    /// The panel; `name` is the scenario's and `step` the one shown.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        name: &str,
        step: u32,
        orders: &mut Vec<Order>,
        actions: &mut Vec<Action>,
    ) {
        ui.horizontal(|ui| {
            ui.label("Folder");
            ui.add(egui::TextEdit::singleline(&mut self.folder).desired_width(180.0));
            if ui.button("…").on_hover_text("Choose a folder").clicked() {
                actions.push(Action::Ask(Ask::Folder));
            }
        });
        let folder = PathBuf::from(self.folder.trim());
        let stem = format!("{}_{step:04}", plain(name));
        egui::Grid::new("leave").num_columns(2).spacing([10.0, 5.0]).show(ui, |ui| {
            let row = |ui: &mut egui::Ui, button: &str, help: &str| {
                let clicked = ui.button(button).clicked();
                ui.label(RichText::new(help).small().weak());
                ui.end_row();
                clicked
            };
            if row(ui, "Screenshot", "the window as it is, PNG") {
                self.shot = Some(free(&folder, &stem, "png"));
            }
            if row(ui, "Everything", "picture, model, tables, run.ron of this step") {
                let to = free(&folder, &stem, "");
                self.wait(&to, "exporting");
                orders.push(Order::Export { step, folder: to });
            }
            if row(ui, "Film", "every step that is kept, GIF") {
                let to = free(&folder, &format!("{}_growth", plain(name)), "gif");
                self.wait(&to, "drawing the film");
                orders.extend(make(&folder, &mut self.note).then_some(Order::Film(to)));
            }
            if row(ui, "Pictures", "the same as a sequence, PNG") {
                let to = free(&folder, &format!("{}_steps", plain(name)), "");
                self.wait(&to, "drawing the pictures");
                orders.push(Order::Pictures(to));
            }
            if row(ui, "Scenario", "with your edits in it, RON") {
                actions.push(Action::Ask(Ask::Scenario));
            }
            if row(ui, "run.ron", "grows the same tree again, bit for bit") {
                let to = free(&folder, "run", "ron");
                self.wait(&to, "writing");
                orders.extend(make(&folder, &mut self.note).then_some(Order::SaveRun(to)));
            }
        });
        ui.separator();
        ui.label(RichText::new("Share code").strong());
        ui.add(egui::TextEdit::multiline(&mut self.code).desired_rows(2).desired_width(f32::INFINITY));
        ui.horizontal(|ui| {
            if ui.button("Of this tree").clicked() {
                orders.push(Order::Share);
            }
            if ui.add_enabled(!self.code.is_empty(), egui::Button::new("Copy")).clicked() {
                ui.ctx().copy_text(self.code.clone());
            }
            let typed = !self.code.trim().is_empty();
            if ui
                .add_enabled(typed, egui::Button::new("Grow it"))
                .on_hover_text("Begins the tree of the code above.")
                .clicked()
            {
                orders.push(Order::LoadCode(self.code.trim().into()));
            }
        });
        match &self.note {
            Some(Note::Failed(why)) => {
                ui.colored_label(ui.visuals().error_fg_color, why);
            }
            Some(Note::Done(what)) => {
                ui.label(what);
            }
            Some(Note::Working(what)) => {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label(what);
                });
            }
            None => {}
        }
    }

    fn wait(&mut self, path: &Path, what: &str) {
        self.waiting.push(path.to_path_buf());
        self.note = Some(Note::Working(format!("{what}: {}", path.display())));
    }
}

/// Makes a folder; what hinders that is noted.
fn make(folder: &Path, note: &mut Option<Note>) -> bool {
    match std::fs::create_dir_all(folder) {
        Ok(()) => true,
        Err(why) => {
            *note = Some(Note::Failed(format!("cannot make {}: {why}", folder.display())));
            false
        }
    }
}

/// A name without what a file name may not have.
pub(super) fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect()
}

/// The first path of that name in a folder at which nothing is: what is there is never replaced.
pub(super) fn free(folder: &Path, stem: &str, extension: &str) -> PathBuf {
    let dot = if extension.is_empty() { "" } else { "." };
    let named = |i: u32| match i {
        1 => folder.join(format!("{stem}{dot}{extension}")),
        i => folder.join(format!("{stem}_{i}{dot}{extension}")),
    };
    (1..10_000).map(named).find(|path| !path.exists()).unwrap_or_else(|| named(10_000))
}

/// Takes the picture of the window that was asked for.
pub fn take_screenshot(mut commands: Commands, mut answers: ResMut<Answers>) {
    // Asked first, so that the panel does not count as changed every frame.
    if answers.leave.shot.is_none() {
        return;
    }
    let Some(path) = answers.leave.shot.take() else { return };
    commands.spawn(Screenshot::primary_window()).observe(
        move |captured: On<ScreenshotCaptured>, mut answers: ResMut<Answers>| {
            answers.leave.note = Some(match write_picture(&captured.image, &path) {
                Ok(()) => Note::Done(format!("{} written", path.display())),
                Err(why) => Note::Failed(format!("cannot write {why}")),
            });
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_is_there_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        assert_eq!(free(at, "a_0001", "png"), at.join("a_0001.png"));
        std::fs::write(at.join("a_0001.png"), "").unwrap();
        assert_eq!(free(at, "a_0001", "png"), at.join("a_0001_2.png"));
        std::fs::create_dir(at.join("a_0001")).unwrap();
        assert_eq!(free(at, "a_0001", ""), at.join("a_0001_2"));
        assert_eq!(plain("two oaks/é"), "two_oaks_é");
    }

    #[test]
    fn a_refusal_is_shown_and_what_is_written_is_told() {
        let mut leave = Leave::default();
        leave.wait(Path::new("out/x"), "exporting");
        leave.hear(&News::Saved("other".into()));
        assert!(matches!(leave.note, Some(Note::Working(_))));
        leave.hear(&News::Saved("out/x".into()));
        assert_eq!(leave.note, Some(Note::Done("out/x written".into())));
        let why = crate::scenario::GardenerError::Nothing("undo");
        leave.hear(&News::Refused(why));
        assert!(matches!(&leave.note, Some(Note::Failed(why)) if why.contains("undo")));
    }
}
