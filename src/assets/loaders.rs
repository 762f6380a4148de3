//! Species and scenarios read by an app's asset server.

use std::collections::BTreeMap;

use bevy::asset::io::Reader;
use bevy::asset::{Asset, AssetLoader, AssetPath, LoadContext, UntypedAssetId, VisitAssetDependencies};
use bevy::reflect::TypePath;

use super::{Library, is_path};
use crate::files::{FileError, ResolvedScenario, leads_down, text_of};
use crate::limits;
use crate::scenario::Scenario;
use crate::species::Species;
use crate::species::parameter::shorten;

// Nothing in them is a handle: what a scenario names is part of it.
impl Asset for Species {}
impl VisitAssetDependencies for Species {
    fn visit_dependencies(&self, _: &mut impl FnMut(UntypedAssetId)) {}
}
impl Asset for ResolvedScenario {}
impl VisitAssetDependencies for ResolvedScenario {
    fn visit_dependencies(&self, _: &mut impl FnMut(UntypedAssetId)) {}
}

/// Reads `species/oak.ron` as a [`Species`]: `asset_server.load::<Species>("species/oak.ron")`.
#[derive(Debug, Default, TypePath)]
pub struct SpeciesLoader;

impl AssetLoader for SpeciesLoader {
    type Asset = Species;
    type Settings = ();
    type Error = FileError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<Species, FileError> {
        let file = context.path().to_string();
        Species::from_ron(&text(reader, &file).await?, &file)
    }

    fn extensions(&self) -> &[&str] {
        &["species.ron", "ron"]
    }
}

/// Reads a scenario with every species it names: the shipped ones, and files beside it, which are watched with
/// it. `asset_server.load::<ResolvedScenario>("scenarios/yard.ron")`.
#[derive(Debug, Default, TypePath)]
pub struct ScenarioLoader;

impl AssetLoader for ScenarioLoader {
    type Asset = ResolvedScenario;
    type Settings = ();
    type Error = FileError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<ResolvedScenario, FileError> {
        let path = context.path().clone_owned();
        let file = path.to_string();
        let text = text(reader, &file).await?;
        let scenario = Scenario::in_file_order(&text, &file)?;
        // Only this can wait for files: all of them first, with what is wrong with each.
        let mut read = BTreeMap::new();
        for (name, _) in scenario.species_named() {
            if is_path(name) && leads_down(name) && !read.contains_key(name) {
                read.insert(name.to_string(), beside(&path, name, context).await);
            }
        }
        let mut resolved = Library::embedded().with_species(scenario, &text, &file, |name, at| match read
            .remove(name)
        {
            Some(found) => found.map(Some),
            None if is_path(name) => Err(FileError::OutsideFolder { at: at.clone(), path: shorten(name) }),
            None => Ok(None),
        })?;
        resolved.scenario.name_after(path.path());
        Ok(resolved)
    }

    fn extensions(&self) -> &[&str] {
        &["scenario.ron", "ron"]
    }
}

/// The species in a file beside another.
async fn beside(
    path: &AssetPath<'_>,
    name: &str,
    context: &mut LoadContext<'_>,
) -> Result<Species, FileError> {
    let folder = path.path().parent().unwrap_or_else(|| std::path::Path::new(""));
    let beside = AssetPath::from_path_buf(folder.join(name)).with_source(path.source().clone_owned());
    let file = beside.to_string();
    let bytes = context
        .read_asset_bytes(beside)
        .await
        .map_err(|why| FileError::Io { file: file.clone(), reason: format!("cannot be read: {why}") })?;
    Species::from_ron(&text_of(bytes, file.clone())?, &file)
}

/// All of a file as text.
async fn text(reader: &mut dyn Reader, file: &str) -> Result<String, FileError> {
    use bevy::tasks::futures_lite::AsyncReadExt;
    let mut bytes = Vec::new();
    let mut reader = reader.take(limits::FILE_BYTES + 1);
    let read = reader.read_to_end(&mut bytes).await;
    read.map_err(|why| FileError::Io { file: file.into(), reason: format!("cannot be read: {why}") })?;
    text_of(bytes, file.into())
}
