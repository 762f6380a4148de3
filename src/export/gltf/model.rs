//! A glTF document as it is put together: accessors, meshes and the binary chunk.

use std::collections::BTreeMap;
use std::io::Write;

use bevy::prelude::Vec3;
use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::validation::USize64;
use gltf_json::{Asset, Index, Material, Node, Root, Scene};

use super::materials::Made;
use crate::export::ExportError;
use crate::shape::Surface;
use crate::shape::tangents::tangents;

/// Sets of vertex colours, parts 0..1, first `COLOR_0`.
pub(super) type Colors<'a> = [&'a [[f32; 3]]];

/// A glTF document and its binary chunk.
#[derive(Default)]
pub(super) struct Model {
    pub(super) root: Root,
    pub(super) bytes: Vec<u8>,
    pub(super) made: Vec<Made>,
}

impl Model {
    /// Adds a surface as a primitive, its vertices relative to `origin`.
    pub(super) fn primitive(
        &mut self,
        surface: &Surface,
        origin: Vec3,
        colors: &Colors,
        material: Index<Material>,
    ) -> Result<Primitive, ExportError> {
        let vertices = surface.positions.len();
        let short = vertices <= usize::from(u16::MAX);
        let needs = vertices * (48 + 4 * colors.len()) + surface.indices.len() * if short { 2 } else { 4 };
        self.has_room(needs)?;

        let positions = surface.positions.iter().map(|&p| (Vec3::from(p) - origin).to_array());
        let positions = self.floats(positions, Type::Vec3, Some(Target::ArrayBuffer));
        if let Some((low, high)) = surface.bounds() {
            // Subtraction is monotonic, so these are the bounds of what is written.
            let accessor = &mut self.root.accessors[positions.value()];
            accessor.min = Some((low - origin).to_array().to_vec().into());
            accessor.max = Some((high - origin).to_array().to_vec().into());
        }
        let array = Some(Target::ArrayBuffer);
        let normals = self.floats(surface.normals.iter().copied(), Type::Vec3, array);
        let uvs = self.floats(surface.uvs.iter().copied(), Type::Vec2, array);
        let relief = self.root.get(material).is_some_and(|material| material.normal_texture.is_some());
        let mut attributes = BTreeMap::from([
            (Valid(Semantic::Positions), positions),
            (Valid(Semantic::Normals), normals),
            (Valid(Semantic::TexCoords(0)), uvs),
        ]);
        if relief {
            let tangents = tangents(surface);
            let tangents = self.floats(tangents.into_iter(), Type::Vec4, array);
            attributes.insert(Valid(Semantic::Tangents), tangents);
        }
        for (set, colors) in (0..).zip(colors) {
            let byte = |part: f32| (part.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
            let bytes = colors.iter().flat_map(|[r, g, b]| [byte(*r), byte(*g), byte(*b), 255]);
            let accessor = self.accessor(bytes, vertices, ComponentType::U8, Type::Vec4, array);
            self.root.accessors[accessor.value()].normalized = true;
            attributes.insert(Valid(Semantic::Colors(set)), accessor);
        }
        let (count, target) = (surface.indices.len(), Some(Target::ElementArrayBuffer));
        let indices = if short {
            let bytes = surface.indices.iter().flat_map(|i| (*i as u16).to_le_bytes());
            self.accessor(bytes, count, ComponentType::U16, Type::Scalar, target)
        } else {
            let bytes = surface.indices.iter().flat_map(|i| i.to_le_bytes());
            self.accessor(bytes, count, ComponentType::U32, Type::Scalar, target)
        };
        Ok(Primitive {
            attributes,
            indices: Some(indices),
            material: Some(material),
            mode: Valid(Mode::Triangles),
            targets: None,
            extensions: None,
            extras: Default::default(),
        })
    }

    /// Adds a mesh.
    pub(super) fn mesh(&mut self, name: String, primitives: Vec<Primitive>) -> Index<Mesh> {
        self.root.push(Mesh {
            name: Some(name),
            primitives,
            weights: None,
            extensions: None,
            extras: Default::default(),
        })
    }

    /// Adds numbers to the binary chunk.
    pub(super) fn floats<const N: usize>(
        &mut self,
        values: impl ExactSizeIterator<Item = [f32; N]>,
        type_: Type,
        target: Option<Target>,
    ) -> Index<Accessor> {
        let count = values.len();
        let bytes = values.flat_map(|value| value.map(f32::to_le_bytes)).flatten();
        self.accessor(bytes, count, ComponentType::F32, type_, target)
    }

    fn accessor(
        &mut self,
        bytes: impl Iterator<Item = u8>,
        count: usize,
        component: ComponentType,
        type_: Type,
        target: Option<Target>,
    ) -> Index<Accessor> {
        let view = self.view(bytes, target);
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

    /// Adds bytes to the binary chunk, and room up to the next four: accessors must be aligned.
    pub(super) fn view(&mut self, bytes: impl Iterator<Item = u8>, target: Option<Target>) -> Index<View> {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - offset;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root.push(View {
            buffer: Index::new(0),
            byte_length: length.into(),
            byte_offset: Some(offset.into()),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Default::default(),
        })
    }

    fn has_room(&self, more: usize) -> Result<(), ExportError> {
        let bytes = (self.bytes.len() + more) as u64;
        if bytes > u64::from(u32::MAX) { Err(ExportError::TooLarge { path: None, bytes }) } else { Ok(()) }
    }

    /// Shows these nodes.
    pub(super) fn scene(&mut self, nodes: Vec<Index<Node>>) {
        // A scene without nodes is no valid glTF; a document without scenes is.
        if !nodes.is_empty() {
            let scene =
                Scene { name: Some("plants".into()), nodes, extensions: None, extras: Default::default() };
            self.root.scene = Some(self.root.push(scene));
        }
    }

    /// Writes the document and its binary chunk.
    pub(super) fn write(mut self, writer: &mut impl Write) -> Result<(), ExportError> {
        self.root.asset = Asset {
            generator: Some(concat!("Burgeon ", env!("CARGO_PKG_VERSION")).into()),
            ..Asset::default()
        };
        if !self.bytes.is_empty() {
            self.root.buffers.push(Buffer {
                byte_length: USize64(self.bytes.len() as u64),
                name: None,
                uri: None,
                extensions: None,
                extras: Default::default(),
            });
        }
        let mut json = serde_json::to_vec(&self.root)?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let binary = if self.bytes.is_empty() { 0 } else { 8 + self.bytes.len() as u64 };
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
        if !self.bytes.is_empty() {
            writer.write_all(&(self.bytes.len() as u32).to_le_bytes())?;
            writer.write_all(b"BIN\0")?;
            writer.write_all(&self.bytes)?;
        }
        Ok(())
    }
}
