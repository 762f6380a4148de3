//! A run in the middle, as a file: how it began, what it is, and what can be undone.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{GardenSave, GardenSaveError, Scenario, TimedEdit};
use crate::files::{RunFile, SaveError, read_save, write_save};
use crate::limits;

/// A garden in the middle of a run: what a save file holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SavedRun {
    /// How it began and what it was at each step.
    pub run: RunFile,
    /// What it is.
    pub garden: GardenSave,
    /// What was done to it by hand, if it can be undone.
    pub history: Option<History>,
}

/// Edits made by hand, in the order they were made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// The scenario before any of them.
    pub scenario: Scenario,
    /// All of them, those undone last.
    pub edits: Vec<TimedEdit>,
    /// How many are made; the rest are undone and can be made again.
    pub made: usize,
    /// The step growth was on its way to.
    pub target: u32,
}

impl SavedRun {
    /// A run that keeps no history.
    pub fn new(run: RunFile, garden: GardenSave) -> Self {
        Self { run, garden, history: None }
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// If it is too large or cannot be written; the old file is untouched then.
    pub fn write(&self, path: &Path) -> Result<(), SaveError> {
        write_save(path, self)
    }

    /// Reads it back and checks it.
    ///
    /// # Errors
    /// As [`read_save`], and [`SaveError::Unsound`] if no garden can be in such a state.
    pub fn read(path: &Path) -> Result<Self, SaveError> {
        let saved: Self = read_save(path)?;
        match saved.check() {
            Ok(()) => Ok(saved),
            Err(source) => Err(SaveError::Unsound { file: path.display().to_string(), source }),
        }
    }

    /// Checks that it is a state a garden can be in.
    ///
    /// # Errors
    /// The first thing that is not so.
    pub fn check(&self) -> Result<(), GardenSaveError> {
        let run = &self.run;
        run.scenario.validate()?;
        for (name, species) in &run.species {
            species.validate().map_err(|source| GardenSaveError::Species { name: name.clone(), source })?;
        }
        self.garden.check()?;
        if run.steps != self.garden.steps() {
            return Err(GardenSaveError::Differ("steps"));
        }
        let Some(history) = &self.history else { return Ok(()) };
        history.scenario.validate()?;
        if history.made > history.edits.len() || history.edits.len() > limits::EDITS {
            return Err(GardenSaveError::Differ("edits"));
        }
        if history.target > limits::STEPS || history.edits.iter().any(|e| e.step > limits::STEPS) {
            return Err(GardenSaveError::Differ("steps"));
        }
        Ok(())
    }
}
