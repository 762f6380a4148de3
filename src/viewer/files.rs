//! Opening and saving by a dialog inside the window: it is there wherever the window is, whatever the desktop.

use std::path::{Path, PathBuf};

use bevy::prelude::*;
use bevy::window::FileDragAndDrop;
use bevy_egui::egui;
use egui_file_dialog::{DialogState, FileDialog, OpeningMode};

use super::act::Action;
use super::leave::{free, plain};
use super::panels::Panels;
use super::state::{Course, Toasts};
use super::why::inspector::{Answers, Tab};
use crate::assets::FileKind;
use crate::files::{is_save, read_text};
use crate::scenario::Order;

/// What a file is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ask {
    /// Open a garden, a scenario, a run or a species.
    Open,
    /// Save the garden with its past.
    Garden,
    /// Save the scenario, edits in it.
    Scenario,
    /// Save the species that is edited, as it shall be.
    Species,
    /// Choose the folder that pictures and exports go to.
    Folder,
}

impl Ask {
    /// The head of the dialog.
    fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a garden, scenario, run or species",
            Self::Garden => "Save the garden with its past",
            Self::Scenario => "Save the scenario with your edits",
            Self::Species => "Save the species",
            Self::Folder => "A folder for pictures and exports",
        }
    }

    /// The ending of its files.
    fn extension(self) -> &'static str {
        match self {
            Self::Garden => "burgeon",
            _ => "ron",
        }
    }
}

/// The dialog, and the files of the session.
#[derive(Resource, Debug)]
pub struct Files {
    dialog: FileDialog,
    asked: Option<Ask>,
    /// Where the dialog opens.
    folder: PathBuf,
    /// The file the garden was saved to or came from.
    garden: Option<PathBuf>,
    /// Which garden `garden` belongs to ([`Course::began`]).
    began: u64,
}

impl Files {
    /// Files of a session that begins in a folder.
    pub fn new(folder: PathBuf) -> Self {
        let mut dialog = FileDialog::new()
            .opening_mode(OpeningMode::AlwaysInitialDir)
            .default_size([640.0, 400.0])
            .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
            .as_modal(true);
        // Its own icons, emoji, are not in every font.
        let config = dialog.config_mut();
        config.default_file_icon = String::new();
        config.default_folder_icon = "🗀".into();
        Self { dialog, asked: None, folder, garden: None, began: 0 }
    }

    /// Whether the dialog is open: keys and pointer are its then.
    pub fn is_open(&self) -> bool {
        matches!(self.dialog.state(), DialogState::Open)
    }

    /// What saves the garden: to the file it has, or to one that is asked for.
    pub fn save(&self) -> Action {
        match &self.garden {
            Some(path) => Action::Tell(Order::Save(path.clone())),
            None => Action::Ask(Ask::Garden),
        }
    }

    /// Asks for a path. `name` is that of what is saved, without an ending.
    fn ask(&mut self, ask: Ask, name: &str) {
        let config = self.dialog.config_mut();
        config.initial_directory.clone_from(&self.folder);
        config.title = Some(ask.title().into());
        config.file_filters.clear();
        self.asked = Some(ask);
        match ask {
            Ask::Open => {
                let ours = |path: &Path| {
                    path.extension().is_some_and(|ending| ending == "ron" || ending == "burgeon")
                };
                *config = std::mem::take(config)
                    .add_file_filter("Burgeon's files", egui_file_dialog::Filter::new(ours));
                config.default_file_filter = Some("Burgeon's files".into());
                self.dialog.pick_file();
            }
            Ask::Folder => self.dialog.pick_directory(),
            _ => {
                let proposed = free(&self.folder, &plain(name), ask.extension());
                let name = proposed.file_name().unwrap_or_default();
                config.default_file_name = name.to_string_lossy().into_owned();
                config.default_file_filter = None;
                self.dialog.save_file();
            }
        }
    }

    /// Draws the dialog, if it is open; what was asked and the path once one has been chosen.
    pub(super) fn show(&mut self, context: &egui::Context) -> Option<(Ask, PathBuf)> {
        self.dialog.update(context);
        let path = self.dialog.take_picked()?;
        Some((self.asked.take()?, path))
    }

    /// Does what was asked for with the path that was chosen.
    pub(super) fn chosen(
        &mut self,
        ask: Ask,
        path: PathBuf,
        answers: &mut Answers,
        toasts: &mut Toasts,
    ) -> Option<Action> {
        if let Some(parent) = path.parent() {
            self.folder = parent.to_path_buf();
        }
        let path = match ask {
            Ask::Open => return self.open(path, answers),
            Ask::Folder => {
                self.folder.clone_from(&path);
                answers.leave.set_folder(&path);
                return None;
            }
            _ => match ended(path, ask.extension()) {
                Ok(path) => path,
                Err(why) => {
                    toasts.warn(why);
                    return None;
                }
            },
        };
        match ask {
            Ask::Scenario => Some(Action::Tell(Order::SaveScenario(path))),
            Ask::Species => {
                answers.species.save(&path);
                None
            }
            _ => {
                self.garden = Some(path.clone());
                Some(Action::Tell(Order::Save(path)))
            }
        }
    }

    /// Opens a file, whatever it is. A species is taken over by the editor, which goes on watching it.
    fn open(&mut self, path: PathBuf, answers: &mut Answers) -> Option<Action> {
        // A save is no text. What cannot be read is refused, with its reason, by whoever takes it up.
        let is_species = !is_save(&path)
            && read_text(&path).is_ok_and(|text| FileKind::of(&text, &path) == FileKind::Species);
        if is_species {
            answers.tab = Tab::Species;
            answers.species.open(path);
            return None;
        }
        Some(Action::Tell(Order::Load(path)))
    }
}

/// A path with this ending, put behind what it has. One without it that is there was chosen to be replaced; one that
/// is only there with it was not, and is refused.
fn ended(path: PathBuf, extension: &str) -> Result<PathBuf, String> {
    if path.extension().is_some_and(|own| own == extension) || path.exists() {
        return Ok(path);
    }
    let mut name = path.into_os_string();
    name.push(format!(".{extension}"));
    let path = PathBuf::from(name);
    match path.exists() {
        true => Err(format!("{} is there already; choose it to replace it", path.display())),
        false => Ok(path),
    }
}

/// Opens the dialog for whoever asks.
pub(super) fn ask(
    mut asks: MessageReader<Action>,
    mut files: ResMut<Files>,
    answers: Res<Answers>,
    course: Res<Course>,
) {
    let files = files.bypass_change_detection();
    if files.began != course.began {
        files.began = course.began;
        files.garden.clone_from(&course.save);
    }
    for action in asks.read() {
        match action {
            Action::Ask(Ask::Species) => files.ask(Ask::Species, answers.species.name().unwrap_or("species")),
            Action::Ask(ask) => files.ask(*ask, &course.scenario),
            _ => {}
        }
    }
}

/// Opens files dropped on the window.
pub(super) fn dropped(
    mut drops: MessageReader<FileDragAndDrop>,
    mut files: ResMut<Files>,
    mut answers: ResMut<Answers>,
    mut panels: ResMut<Panels>,
    mut actions: MessageWriter<Action>,
) {
    for drop in drops.read() {
        if let FileDragAndDrop::DroppedFile { path_buf, .. } = drop {
            let action = files.open(path_buf.clone(), &mut answers);
            panels.open |= action.is_none();
            actions.write_batch(action);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_gets_the_ending_of_its_kind_and_replaces_nothing_unasked() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        assert_eq!(ended(at("oak"), "burgeon").unwrap(), at("oak.burgeon"));
        assert_eq!(ended(at("oak v1.2"), "burgeon").unwrap(), at("oak v1.2.burgeon"));
        assert_eq!(ended(at("oak.burgeon"), "burgeon").unwrap(), at("oak.burgeon"));
        std::fs::write(at("oak.burgeon"), "").unwrap();
        assert!(ended(at("oak"), "burgeon").unwrap_err().contains("choose it"));
        std::fs::write(at("garden"), "").unwrap();
        assert_eq!(ended(at("garden"), "burgeon").unwrap(), at("garden"), "chosen as it is");
    }
}
