//! A plant as a model: binary glTF 2.0 (`.glb`).
//!
//! A node a plant, at its place; below it "wood" and "leaves", each a mesh with normals, texture coordinates and
//! the material of its species. Metres, y up, as glTF has it.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

use bevy::prelude::Vec3;
use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::validation::USize64;
use gltf_json::{Asset, Index, Material, Node, Root, Scene};

use super::ExportError;
use super::error::to_file;
use crate::plant::Snapshot;
use crate::shape::{Surface, leaves::leaves, tubes::wood};
use crate::species::Species;

/// Writes all plants as one GLB.
///
/// # Errors
/// If the stream does not take it, or the model is larger than a GLB can be.
pub fn write_glb(snapshot: &Snapshot, mut writer: impl Write) -> Result<(), ExportError> {
    let mut model = Model::default();
    let mut nodes = Vec::new();
    for ((i, plant), (wood, leaves)) in
        snapshot.plants.iter().enumerate().zip(wood(snapshot).into_iter().zip(leaves(snapshot)))
    {
        let Some(plant) = plant else { continue };
        let species = &plant.species;
        let mut children = Vec::new();
        if !wood.is_empty() {
            let material = model.material(species, Part::Bark);
            children.push(model.part(
                "wood",
                &format!("{} {i} wood", species.name),
                wood,
                plant.position,
                material,
            ));
        }
        if !leaves.is_empty() {
            let material = model.material(species, Part::Leaves);
            let name = format!("{} {i} leaves", species.name);
            children.push(model.part("leaves", &name, leaves, plant.position, material));
        }
        nodes.push(model.root.push(Node {
            name: Some(format!("{} {i}", species.name)),
            translation: Some(plant.position.into()),
            children: (!children.is_empty()).then_some(children),
            ..Node::default()
        }));
    }
    // A scene without nodes is no valid glTF; a document without scenes is.
    if !nodes.is_empty() {
        let scene =
            Scene { name: Some("plants".into()), nodes, extensions: None, extras: Default::default() };
        model.root.scene = Some(model.root.push(scene));
    }
    model.root.asset =
        Asset { generator: Some(concat!("Burgeon ", env!("CARGO_PKG_VERSION")).into()), ..Asset::default() };
    model.write(&mut writer)
}

/// Writes all plants as one GLB file, replacing what is there.
///
/// # Errors
/// As [`write_glb`], with the path.
pub fn save_glb(snapshot: &Snapshot, path: &Path) -> Result<(), ExportError> {
    to_file(path, |writer| write_glb(snapshot, writer))
}

/// What a species has a material for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    Bark,
    Leaves,
}

/// A glTF document and what goes into its binary chunk, in order.
#[derive(Default)]
struct Model {
    root: Root,
    /// Surfaces, and where their plant stands: vertices are written relative to it.
    surfaces: Vec<(Surface, Vec3)>,
    bytes: u64,
}

impl Model {
    /// The material of a part of a species, made when first asked for.
    fn material(&mut self, species: &Species, part: Part) -> Index<Material> {
        let (what, color, roughness) = match part {
            Part::Bark => ("bark", species.bark_color, 0.9),
            Part::Leaves => ("leaves", species.leaf_color, 0.6),
        };
        let [r, g, b] = color.linear();
        let name = Some(format!("{} {what}", species.name));
        let base = [r, g, b, 1.0];
        let same = |m: &Material| m.name == name && m.pbr_metallic_roughness.base_color_factor.0 == base;
        if let Some(i) = self.root.materials.iter().position(same) {
            return Index::new(i as u32);
        }
        self.root.push(Material {
            name,
            double_sided: part == Part::Leaves,
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor(base),
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(roughness),
                ..PbrMetallicRoughness::default()
            },
            ..Material::default()
        })
    }

    /// Adds a surface as a mesh under a node of its own.
    fn part(
        &mut self,
        node: &str,
        mesh: &str,
        surface: Surface,
        origin: Vec3,
        material: Index<Material>,
    ) -> Index<Node> {
        let vertices = surface.positions.len();
        let positions = self.accessor(vertices, Type::Vec3, Target::ArrayBuffer);
        if let Some((low, high)) = surface.bounds() {
            // Subtraction is monotonic, so these are the bounds of what is written.
            let accessor = &mut self.root.accessors[positions.value()];
            accessor.min = Some((low - origin).to_array().to_vec().into());
            accessor.max = Some((high - origin).to_array().to_vec().into());
        }
        let normals = self.accessor(vertices, Type::Vec3, Target::ArrayBuffer);
        let uvs = self.accessor(vertices, Type::Vec2, Target::ArrayBuffer);
        let indices = self.accessor(surface.indices.len(), Type::Scalar, Target::ElementArrayBuffer);
        self.surfaces.push((surface, origin));
        let primitive = Primitive {
            attributes: BTreeMap::from([
                (Valid(Semantic::Positions), positions),
                (Valid(Semantic::Normals), normals),
                (Valid(Semantic::TexCoords(0)), uvs),
            ]),
            indices: Some(indices),
            material: Some(material),
            mode: Valid(Mode::Triangles),
            targets: None,
            extensions: None,
            extras: Default::default(),
        };
        let mesh = self.root.push(Mesh {
            name: Some(mesh.into()),
            primitives: vec![primitive],
            weights: None,
            extensions: None,
            extras: Default::default(),
        });
        self.root.push(Node { name: Some(node.into()), mesh: Some(mesh), ..Node::default() })
    }

    /// Reserves the next bytes of the binary chunk: 4-byte components, so everything is aligned.
    fn accessor(&mut self, count: usize, type_: Type, target: Target) -> Index<Accessor> {
        let components = type_.multiplicity() as u64;
        let bytes = count as u64 * components * 4;
        let view = self.root.push(View {
            buffer: Index::new(0),
            byte_length: bytes.into(),
            byte_offset: Some(self.bytes.into()),
            byte_stride: None,
            name: None,
            target: Some(Valid(target)),
            extensions: None,
            extras: Default::default(),
        });
        self.bytes += bytes;
        let component =
            if target == Target::ElementArrayBuffer { ComponentType::U32 } else { ComponentType::F32 };
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: count.into(),
            component_type: Valid(GenericComponentType(component)),
            type_: Valid(type_),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: Default::default(),
        })
    }

    fn write(mut self, writer: &mut impl Write) -> Result<(), ExportError> {
        if self.bytes > 0 {
            self.root.buffers.push(Buffer {
                byte_length: USize64(self.bytes),
                name: None,
                uri: None,
                extensions: None,
                extras: Default::default(),
            });
        }
        let mut json = serde_json::to_vec(&self.root)?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let binary = if self.bytes > 0 { 8 + self.bytes } else { 0 };
        let total = 12 + 8 + json.len() as u64 + binary;
        let Ok(length) = u32::try_from(total) else {
            return Err(ExportError::TooLarge { path: None, bytes: total });
        };
        writer.write_all(b"glTF")?;
        for word in [2, length, json.len() as u32] {
            writer.write_all(&word.to_le_bytes())?;
        }
        writer.write_all(b"JSON")?;
        writer.write_all(&json)?;
        if self.bytes > 0 {
            writer.write_all(&(self.bytes as u32).to_le_bytes())?;
            writer.write_all(b"BIN\0")?;
        }
        for (surface, origin) in &self.surfaces {
            for &position in &surface.positions {
                floats(writer, (Vec3::from(position) - origin).to_array())?;
            }
            for &normal in &surface.normals {
                floats(writer, normal)?;
            }
            for &uv in &surface.uvs {
                floats(writer, uv)?;
            }
            for index in &surface.indices {
                writer.write_all(&index.to_le_bytes())?;
            }
        }
        Ok(())
    }
}

fn floats<const N: usize>(writer: &mut impl Write, parts: [f32; N]) -> std::io::Result<()> {
    parts.iter().try_for_each(|part| writer.write_all(&part.to_le_bytes()))
}
