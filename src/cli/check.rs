//! `burgeon check`: whether files are sound.

use std::path::{Path, PathBuf};

use burgeon::assets::FileKind;
use burgeon::files::{RunFile, SkeletonFile, is_save, is_skeleton, read_mtg, read_plant_text};
use burgeon::plant::skeleton::Skeleton;
use burgeon::scenario::SavedRun;
use burgeon::species::Species;
use clap::Args;

use super::Failure;
use super::input::library;
use super::output::say;

/// Check files, one line each.
#[derive(Args, Debug)]
pub struct Check {
    /// Species, scenarios, run.ron files, saves, skeleton files and MTGs.
    #[arg(required = true)]
    files: Vec<PathBuf>,

    /// A folder whose species win over those built in.
    #[arg(long, value_name = "DIR")]
    assets: Option<PathBuf>,
}

impl Check {
    /// Runs the command.
    pub fn run(&self) -> Result<(), Failure> {
        let library = library(&self.assets)?;
        let mut bad = 0;
        for path in &self.files {
            match check(path, &library) {
                Ok(what) => say(format_args!("{}: {what}", path.display())),
                Err(failure) => {
                    bad += 1;
                    say(failure);
                }
            }
        }
        if bad == 0 { Ok(()) } else { Err(Failure::BadFiles { bad, all: self.files.len() }) }
    }
}

/// What a good file is, in a few words.
fn check(path: &Path, library: &burgeon::assets::Library) -> Result<String, Failure> {
    if is_save(path) {
        let save = SavedRun::read(path)?;
        return Ok(format!(
            "a save of {} at step {}, seed {}",
            save.run.scenario.name, save.run.steps, save.run.seed
        ));
    }
    if path.extension().is_some_and(|extension| extension == "mtg") {
        let plants = read_mtg(path)?;
        for plant in &plants {
            plant.check()?;
        }
        let nodes: usize = plants.iter().map(Skeleton::nodes).sum();
        return Ok(format!("an MTG of {} plants with {nodes} nodes", plants.len()));
    }
    let text = read_plant_text(path)?;
    let file = path.display().to_string();
    if is_skeleton(&text) {
        let (read, skeleton) = SkeletonFile::from_ron(&text, &file)?;
        library.species(&read.species)?;
        return Ok(format!("skeleton {} with {} nodes", read.name, skeleton.nodes()));
    }
    Ok(match FileKind::of(&text, path) {
        FileKind::Species => format!("species {}", Species::from_ron(&text, &file)?.name),
        FileKind::Scenario => {
            let mut resolved = library.read(&text, &file, path.parent())?;
            resolved.scenario.name_after(path);
            let species: Vec<_> = resolved.species.keys().map(String::as_str).collect();
            format!("scenario {} with {}", resolved.scenario.name, species.join(", "))
        }
        FileKind::Run => {
            let run = RunFile::from_ron(&text, &file)?;
            format!("a run of {}, {} steps, seed {}", run.scenario.name, run.steps, run.seed)
        }
    })
}
