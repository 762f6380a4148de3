//! All that a run leaves, in one call: what `burgeon grow` writes, and the window's "export everything".

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::ExportError;
use super::film::FilmError;
use super::gltf::{GlbSettings, save_glb};
use super::picture::Palette;
use super::reel::save_picture;
use super::tables::{save_organs, save_steps};
use crate::environment::Scene;
use crate::environment::workers::Workers;
use crate::files::{RunFile, write_whole};
use crate::plant::Snapshot;
use crate::plant::measure::StepRecord;

/// What a run has to leave.
#[derive(Debug, Clone)]
pub struct Harvest {
    /// The plants.
    pub snapshot: Arc<Snapshot>,
    /// All that can be seen, plants among it.
    pub scene: Scene,
    /// Every step in numbers.
    pub records: Vec<StepRecord>,
    /// How to grow it again.
    pub run: RunFile,
}

/// Why not everything was written; every file is whole, or as it was.
#[derive(Debug, thiserror::Error)]
pub enum HarvestError {
    /// A model or table.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A picture or film.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A text file or the folder.
    #[error("cannot write {}: {source}", .path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// Names of the files that [`export_all`] writes.
pub const FILES: [&str; 5] = ["run.ron", "steps.csv", "organs.csv", "tree.glb", "tree.png"];

/// Writes every one of [`FILES`] into a folder, which is made if it is not there, replacing what is there. Returns
/// their paths.
///
/// # Errors
/// The first file that cannot be written; it and those after it are as they were.
pub fn export_all(harvest: &Harvest, folder: &Path, workers: &Workers) -> Result<Vec<PathBuf>, HarvestError> {
    export_with(harvest, folder, workers, GlbSettings::default())
}

/// As [`export_all`], with a model made as asked for.
///
/// # Errors
/// As [`export_all`].
pub fn export_with(
    harvest: &Harvest,
    folder: &Path,
    workers: &Workers,
    settings: GlbSettings,
) -> Result<Vec<PathBuf>, HarvestError> {
    make_folder(folder)?;
    let paths = FILES.map(|name| folder.join(name));
    let [run, steps, organs, model, picture] = &paths;
    write_whole(run, &[harvest.run.to_ron().as_bytes()])
        .map_err(|source| HarvestError::Write { path: run.clone(), source })?;
    save_steps(&harvest.records, steps)?;
    save_organs(&harvest.snapshot, organs)?;
    save_glb(&harvest.snapshot, settings, model)?;
    save_picture(&harvest.scene, &Palette::of_snapshot(&harvest.snapshot), workers, picture)?;
    Ok(paths.into())
}

/// Makes a folder, and those it lies in.
///
/// # Errors
/// If the system does not let it.
pub fn make_folder(folder: &Path) -> Result<(), HarvestError> {
    std::fs::create_dir_all(folder)
        .map_err(|source| HarvestError::Write { path: folder.to_path_buf(), source })
}
