//! A plant as a model: binary glTF 2.0 (`.glb`).
//!
//! A node a plant, at its place; below it "wood" and "leaves", each a mesh with normals, texture coordinates, vertex
//! colours and the material of its species, whose textures are in the file: bark with its relief, and a leaf with its
//! outline in alpha. Metres, y up, as glTF has it. Wood has normals of its own, leaves are shaded as one soft crown.
//!
//! There are two sets of vertex colours: tints, by which twigs differ from the trunk and one leaf from the next, and
//! weights for wind ([`Paint::winds`]). glTF has viewers multiply the base colour by the first set, `COLOR_0`, and leaves
//! the second, `COLOR_1`, to the application, so tints come first. Game engines that read one set only find the wind if
//! [`GlbSettings::wind_first`] changes them over.

mod materials;
mod model;

use std::io::Write;
use std::path::Path;

use gltf_json::Node;

use super::ExportError;
use super::error::to_file;
use crate::plant::Snapshot;
use crate::shape::paint::Paint;
use crate::shape::{Surface, leaves::leaves, tubes::wood};
use materials::Part;
use model::{Colors, Model};

/// How a model is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GlbSettings {
    /// Whether weights for wind are the first set of vertex colours and tints the second. Viewers then show the weights
    /// as colours; textures have the mean colour of the species by themselves.
    pub wind_first: bool,
}

/// Writes all plants as one GLB.
///
/// # Errors
/// If the stream does not take it, or the model is larger than a GLB can be.
pub fn write_glb(snapshot: &Snapshot, settings: GlbSettings, writer: impl Write) -> Result<(), ExportError> {
    let parts = wood(snapshot).into_iter().zip(leaves(snapshot));
    write_parts(snapshot, parts, "", settings, writer)
}

/// Writes all plants as one GLB file, replacing what is there.
///
/// # Errors
/// As [`write_glb`], with the path.
pub fn save_glb(snapshot: &Snapshot, settings: GlbSettings, path: &Path) -> Result<(), ExportError> {
    to_file(path, |writer| write_glb(snapshot, settings, writer))
}

/// Writes the wood and leaves of each plant; `level` goes behind the names of nodes and meshes.
fn write_parts(
    snapshot: &Snapshot,
    parts: impl Iterator<Item = (Surface, Surface)>,
    level: &str,
    settings: GlbSettings,
    mut writer: impl Write,
) -> Result<(), ExportError> {
    let mut model = Model::default();
    let mut nodes = Vec::new();
    let paint = Paint::of(snapshot);
    for ((i, plant), (wood, leaves)) in snapshot.plants.iter().enumerate().zip(parts) {
        let Some(plant) = plant else { continue };
        let species = &plant.species;
        let mut children = Vec::new();
        for (surface, part, name) in [(wood, Part::Bark, "wood"), (leaves, Part::Leaves, "leaves")] {
            if surface.is_empty() {
                continue;
            }
            let material = model.material(species, part, !settings.wind_first)?;
            let (tints, winds) = (paint.tints(&surface), paint.winds(&surface));
            let colors: &Colors = if settings.wind_first { &[&winds, &tints] } else { &[&tints, &winds] };
            let primitive = model.primitive(&surface, plant.position, colors, material)?;
            let mesh = model.mesh(format!("{} {i} {name}{level}", species.name), vec![primitive]);
            children.push(model.root.push(Node {
                name: Some(name.into()),
                mesh: Some(mesh),
                ..Node::default()
            }));
        }
        nodes.push(model.root.push(Node {
            name: Some(format!("{} {i}{level}", species.name)),
            translation: Some(plant.position.into()),
            children: (!children.is_empty()).then_some(children),
            ..Node::default()
        }));
    }
    model.scene(nodes);
    model.write(&mut writer)
}
