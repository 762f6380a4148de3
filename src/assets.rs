//! The species and scenarios that ship with Burgeon, embedded in the program, and folders that replace them.
//!
//! With feature `assets` they are also assets of a Bevy app: `PlantAssetPlugin`.

#[cfg(feature = "assets")]
mod loaders;
#[cfg(feature = "assets")]
mod planted;

#[cfg(feature = "assets")]
pub use loaders::{ScenarioLoader, SpeciesLoader};
#[cfg(feature = "assets")]
pub use planted::{NextSpecies, PlantAssetPlugin, ScenarioRoot, SetOut, SetOutBy, SpeciesRoot};

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::files::{FileError, Place, ResolvedScenario, RunFile, inside, place_in, read_text, top_fields};
use crate::scenario::Scenario;
use crate::species::Species;

macro_rules! embedded {
    ($folder:literal: $($name:literal),+ $(,)?) => {
        &[$(($name, include_str!(concat!("../assets/", $folder, "/", $name, ".ron")))),+]
    };
}

/// Shipped species: name and text.
const SPECIES: &[(&str, &str)] = embedded!("species":
    "lam_king", "oak", "silver_birch", "norway_spruce", "scots_pine", "lombardy_poplar", "weeping_willow",
    "japanese_maple", "umbrella_acacia", "beech", "apple", "hazel", "palm", "candelabra", "lily", "horneophyton",
);

/// Shipped scenarios: name and text.
const SCENARIOS: &[(&str, &str)] = embedded!("scenarios":
    "open", "wall", "lamp", "dusk", "lamp_moved", "courtyard", "two_oaks",
    "grove", "hedge", "avenue", "beach",
    "figure_1a", "figure_1b", "figure_1c", "figure_1d",
);

/// Where species and scenarios come from: those embedded, and before them a folder's
/// `species/NAME.ron` and `scenarios/NAME.ron`, if one is given.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Library {
    folder: Option<PathBuf>,
}

/// What an argument `SCENARIO|run.ron` names.
#[derive(Debug, Clone, PartialEq)]
pub enum Opened {
    /// A scenario with its species.
    Scenario(Box<ResolvedScenario>),
    /// A run to grow again.
    Run(Box<RunFile>),
}

/// The kinds of file people write or a run leaves behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    /// A species.
    Species,
    /// A scenario.
    Scenario,
    /// A `run.ron`.
    Run,
}

impl FileKind {
    /// What a text is, by the fields it has; a folder's name (`species`, `scenarios`) settles a tie.
    pub fn of(text: &str, path: &Path) -> Self {
        let fields = top_fields(text);
        let has = |name: &str| fields.iter().any(|f| f == name);
        if has("scenario") || has("hashes") {
            return Self::Run;
        }
        let species = Species::parameters().iter().filter(|p| has(p.name)).count();
        let scenario = Scenario::parameters()
            .iter()
            .filter_map(|p| p.name.split(['.', '[']).next())
            .filter(|n| !matches!(*n, "version" | "name" | "description"))
            .collect::<BTreeSet<_>>()
            .into_iter()
            .filter(|n| has(n))
            .count();
        let folder = path.parent().and_then(Path::file_name).unwrap_or_default();
        match species.cmp(&scenario) {
            core::cmp::Ordering::Greater => Self::Species,
            core::cmp::Ordering::Less => Self::Scenario,
            core::cmp::Ordering::Equal if folder == "species" => Self::Species,
            core::cmp::Ordering::Equal => Self::Scenario,
        }
    }
}

impl Library {
    /// What is embedded, alone.
    pub fn embedded() -> Self {
        Self::default()
    }

    /// A folder before what is embedded.
    ///
    /// # Errors
    /// If there is no such folder.
    pub fn with_folder(folder: impl Into<PathBuf>) -> Result<Self, FileError> {
        let folder = folder.into();
        if folder.is_dir() {
            Ok(Self { folder: Some(folder) })
        } else {
            Err(FileError::NotFound { file: folder.display().to_string() })
        }
    }

    /// Names of all species.
    pub fn species_names(&self) -> Vec<String> {
        self.names("species", SPECIES)
    }

    /// Names of all scenarios.
    pub fn scenario_names(&self) -> Vec<String> {
        self.names("scenarios", SCENARIOS)
    }

    /// A species by name.
    ///
    /// # Errors
    /// If there is none of that name, or a folder's file is bad.
    pub fn species(&self, name: &str) -> Result<Species, FileError> {
        match self.text("species", SPECIES, name)? {
            Some(found) => Species::from_ron(&found.text, &found.file),
            None => {
                let at = Place::file("species");
                Err(FileError::no_such_species(at, name, self.species_names()))
            }
        }
    }

    /// A scenario by name, with its species.
    ///
    /// # Errors
    /// If there is none of that name, or a folder's file or a species in it is bad.
    pub fn scenario(&self, name: &str) -> Result<ResolvedScenario, FileError> {
        match self.text("scenarios", SCENARIOS, name)? {
            Some(found) => {
                let mut resolved = self.read(&found.text, &found.file, found.folder.as_deref())?;
                resolved.scenario.name_after(Path::new(&found.file));
                Ok(resolved)
            }
            None => {
                let at = Place::file("scenario");
                Err(FileError::no_such_scenario(at, name, self.scenario_names()))
            }
        }
    }

    /// One plant of a species in the field of the scenario `open`.
    ///
    /// # Errors
    /// As [`Library::species`] and [`Library::scenario`].
    pub fn alone(&self, species: &str) -> Result<ResolvedScenario, FileError> {
        let mut scenario = self.scenario("open")?.scenario;
        scenario.name = species.into();
        scenario.description = format!("One {species} alone in an open field.");
        scenario.plants.iter_mut().for_each(|plant| plant.species = species.into());
        self.resolve(scenario)
    }

    /// A scenario from the text of a file, with its species: those of the library, or files in `folder`.
    ///
    /// # Errors
    /// If it or a species is bad, or a path leads out of the folder.
    pub fn read(&self, text: &str, file: &str, folder: Option<&Path>) -> Result<ResolvedScenario, FileError> {
        let scenario = Scenario::in_file_order(text, file)?;
        self.with_species(scenario, text, file, |name, at| match folder {
            Some(folder) if is_path(name) => {
                let path = inside(folder, name, at)?;
                Species::from_ron(&read_text(&path)?, &path.display().to_string()).map(Some)
            }
            _ => Ok(None),
        })
    }

    /// A scenario, its edits still in the order of its file, with the species it names: those that `beside` has, or
    /// else the library's.
    fn with_species(
        &self,
        mut scenario: Scenario,
        text: &str,
        file: &str,
        mut beside: impl FnMut(&str, &Place) -> Result<Option<Species>, FileError>,
    ) -> Result<ResolvedScenario, FileError> {
        let mut species = BTreeMap::new();
        for (name, path) in scenario.species_named() {
            if species.contains_key(name) {
                continue;
            }
            let at = place_in(text, file, &path);
            let found = match beside(name, &at)? {
                Some(found) => found,
                None => self.species(name).map_err(|why| why.moved_to(at))?,
            };
            // Here it goes by the name plants and edits give it.
            species.insert(name.to_string(), Species { name: name.to_string(), ..found });
        }
        scenario.order_edits();
        Ok(ResolvedScenario { scenario, species })
    }

    /// A scenario with its species from the library.
    ///
    /// # Errors
    /// If the scenario is not valid or names a species that does not exist.
    pub fn resolve(&self, mut scenario: Scenario) -> Result<ResolvedScenario, FileError> {
        scenario.validate().map_err(|e| e.in_file("scenario"))?;
        scenario.order_edits();
        let mut species = BTreeMap::new();
        for (name, _) in scenario.species_named() {
            if !species.contains_key(name) {
                let found = Species { name: name.to_string(), ..self.species(name)? };
                species.insert(name.to_string(), found);
            }
        }
        Ok(ResolvedScenario { scenario, species })
    }

    /// What an argument names: a scenario by name, or a file that holds a scenario or a run.
    ///
    /// # Errors
    /// If there is no such scenario or file, or it is bad.
    pub fn open(&self, argument: &str) -> Result<Opened, FileError> {
        if !is_path(argument) {
            return self.scenario(argument).map(|s| Opened::Scenario(Box::new(s)));
        }
        let path = Path::new(argument);
        let text = read_text(path)?;
        match FileKind::of(&text, path) {
            FileKind::Run => RunFile::from_ron(&text, argument).map(|run| Opened::Run(Box::new(run))),
            FileKind::Species | FileKind::Scenario => {
                let mut resolved = self.read(&text, argument, path.parent())?;
                resolved.scenario.name_after(path);
                Ok(Opened::Scenario(Box::new(resolved)))
            }
        }
    }

    fn names(&self, folder: &str, embedded: &[(&str, &str)]) -> Vec<String> {
        let mut names: Vec<String> = embedded.iter().map(|(name, _)| (*name).into()).collect();
        let own = self.folder.as_ref().and_then(|f| std::fs::read_dir(f.join(folder)).ok());
        let mut more: BTreeSet<String> = BTreeSet::new();
        for entry in own.into_iter().flatten().flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|e| e == "ron")
                && let Some(name) = path.file_stem().and_then(|s| s.to_str())
                && !names.iter().any(|n| n == name)
            {
                more.insert(name.into());
            }
        }
        names.extend(more);
        names
    }

    fn text(
        &self,
        folder: &str,
        embedded: &[(&str, &'static str)],
        name: &str,
    ) -> Result<Option<Found>, FileError> {
        if let Some(own) = self.folder.as_ref().map(|f| f.join(folder))
            && is_plain(name)
        {
            let path = own.join(format!("{name}.ron"));
            if path.exists() {
                let file = path.display().to_string();
                return Ok(Some(Found { text: read_text(&path)?.into(), file, folder: Some(own) }));
            }
        }
        let found = embedded.iter().find(|(n, _)| *n == name);
        Ok(found.map(|(name, text)| Found {
            text: Cow::Borrowed(text),
            file: format!("{name}.ron"),
            folder: None,
        }))
    }
}

/// What stands behind a name.
struct Found {
    text: Cow<'static, str>,
    file: String,
    /// Where it lies, if in a folder.
    folder: Option<PathBuf>,
}

/// Whether a name of a species or scenario is a path to a file.
pub(crate) fn is_path(name: &str) -> bool {
    name.contains(['/', '\\']) || name.ends_with(".ron")
}

/// Whether a name can be a file's in a folder.
fn is_plain(name: &str) -> bool {
    let separates = |c: char| matches!(c, '/' | '\\' | ':' | '\0');
    !name.is_empty() && name.len() <= 80 && !name.starts_with('.') && !name.contains(separates)
}

impl Species {
    /// A shipped species, such as `oak`.
    ///
    /// # Errors
    /// If there is none of that name.
    pub fn named(name: &str) -> Result<Self, FileError> {
        Library::embedded().species(name)
    }
}

impl Scenario {
    /// Names one without a name after its file.
    pub fn name_after(&mut self, path: &Path) {
        if self.name == Self::UNNAMED
            && let Some(stem) = path.file_stem().and_then(|stem| stem.to_str())
        {
            self.name = stem.into();
        }
    }

    /// A shipped scenario, such as `wall`.
    ///
    /// # Errors
    /// If there is none of that name.
    pub fn named(name: &str) -> Result<Self, FileError> {
        Library::embedded().scenario(name).map(|resolved| resolved.scenario)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_file_is_sound_and_writes_back_as_itself() {
        let library = Library::embedded();
        for name in library.species_names() {
            let species = Species::named(&name).unwrap();
            assert_eq!(species.name, name);
            assert_eq!(Species::from_ron(&species.to_ron(), "again").unwrap(), species);
        }
        for name in library.scenario_names() {
            let resolved = library.scenario(&name).unwrap();
            assert_eq!(resolved.scenario.name, name);
            assert_eq!(Scenario::from_ron(&resolved.scenario.to_ron(), "again").unwrap(), resolved.scenario);
            assert!(!resolved.scenario.description.is_empty());
        }
    }

    #[test]
    fn lam_king_is_the_table_of_defaults() {
        let species = Species::named("lam_king").unwrap();
        let (description, source) = (species.description.clone(), species.source.clone());
        assert_eq!(species, Species { description, source, ..Species::default() });
    }

    #[test]
    fn a_folder_wins_over_what_is_embedded() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("species")).unwrap();
        std::fs::write(folder.path().join("species/oak.ron"), "(name: \"mine\")").unwrap();
        std::fs::write(folder.path().join("species/elm.ron"), "(name: \"elm\")").unwrap();
        let library = Library::with_folder(folder.path()).unwrap();
        assert_eq!(library.species("oak").unwrap().name, "mine");
        assert_eq!(library.species("lam_king").unwrap().name, "lam_king");
        let embedded = SPECIES.iter().map(|(name, _)| *name);
        assert_eq!(library.species_names(), embedded.chain(["elm"]).collect::<Vec<_>>());
        assert!(matches!(library.species("../species/oak"), Err(FileError::NoSuchSpecies { .. })));
    }
}
