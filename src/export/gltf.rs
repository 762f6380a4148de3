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

mod film;
mod materials;
mod model;

use std::io::Write;
use std::path::Path;

use gltf_json::Node;

use super::ExportError;
use super::error::to_file;
use crate::plant::Snapshot;
use crate::shape::levels::{self, Shape};
use crate::shape::paint::Paint;
pub use film::{GrowthFilm, MOST_TRIANGLES};
use materials::Part;
use model::{Colors, Model};

/// How a model is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GlbSettings {
    /// Whether weights for wind are the first set of vertex colours and tints the second. Viewers then show the weights
    /// as colours; textures have the mean colour of the species by themselves.
    pub wind_first: bool,
    /// The level of detail; all detail without one.
    pub level: Option<Level>,
}

/// A level of detail.
///
/// Each is a file of its own, as every engine takes them: several in one file would lie upon each other in a viewer.
/// Plants' nodes and meshes end in `_LOD` and the number, by which importers tell what belongs together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    /// Its number, 0 the finest.
    pub number: u32,
    /// Triangles of all plants together, at most.
    pub triangles: usize,
}

impl Level {
    /// Three levels of one skeleton: with so many triangles at most, with a quarter and with a sixteenth of them.
    pub fn three(triangles: usize) -> [Self; 3] {
        [0, 1, 2].map(|number| Self { number, triangles: triangles >> (2 * number) })
    }
}

/// Writes all plants as one GLB.
///
/// # Errors
/// If the stream does not take it, or the model is larger than a GLB can be.
pub fn write_glb(snapshot: &Snapshot, settings: GlbSettings, writer: impl Write) -> Result<(), ExportError> {
    let shapes = match settings.level {
        Some(level) => levels::within(snapshot, level.triangles),
        None => Shape::full(snapshot),
    };
    let suffix = settings.level.map_or_else(String::new, |level| format!("_LOD{}", level.number));
    write_shapes(snapshot, shapes, &suffix, settings, writer)
}

/// Writes all plants as one GLB file, replacing what is there.
///
/// # Errors
/// As [`write_glb`], with the path.
pub fn save_glb(snapshot: &Snapshot, settings: GlbSettings, path: &Path) -> Result<(), ExportError> {
    to_file(path, |writer| write_glb(snapshot, settings, writer))
}

/// Writes the shape of each plant; `suffix` goes behind the names of plants' nodes and of meshes.
fn write_shapes(
    snapshot: &Snapshot,
    shapes: Vec<Shape>,
    suffix: &str,
    settings: GlbSettings,
    mut writer: impl Write,
) -> Result<(), ExportError> {
    let mut model = Model::default();
    let mut nodes = Vec::new();
    let paint = Paint::of(snapshot);
    for ((i, plant), shape) in snapshot.plants.iter().enumerate().zip(shapes) {
        let Some(plant) = plant else { continue };
        let species = &plant.species;
        let mut children = Vec::new();
        let leaves = if shape.sprays { Part::Sprays } else { Part::Leaves };
        for (surface, part, name) in [(shape.wood, Part::Bark, "wood"), (shape.leaves, leaves, "leaves")] {
            if surface.is_empty() {
                continue;
            }
            let material = model.material(species, part, !settings.wind_first)?;
            let (tints, winds) = (paint.tints(&surface), paint.winds(&surface));
            let colors: &Colors = if settings.wind_first { &[&winds, &tints] } else { &[&tints, &winds] };
            let primitive = model.primitive(&surface, plant.position, colors, material)?;
            let mesh = model.mesh(format!("{} {i} {name}{suffix}", species.name), vec![primitive]);
            children.push(model.root.push(Node {
                name: Some(name.into()),
                mesh: Some(mesh),
                ..Node::default()
            }));
        }
        nodes.push(model.root.push(Node {
            name: Some(format!("{} {i}{suffix}", species.name)),
            translation: Some(plant.position.into()),
            children: (!children.is_empty()).then_some(children),
            ..Node::default()
        }));
    }
    model.scene(nodes);
    model.write(&mut writer)
}
