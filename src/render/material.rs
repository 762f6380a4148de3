//! The material of plants and the meshes of their chunks: vertices are numbers, all else is in buffers.

use std::collections::HashMap;

use bevy::asset::{RenderAssetUsages, uuid_handle};
use bevy::mesh::{Indices, MeshVertexAttribute, MeshVertexBufferLayoutRef, PrimitiveTopology, VertexFormat};
use bevy::pbr::{ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, RenderPipelineDescriptor, SpecializedMeshPipelineError};
use bevy::render::storage::ShaderBuffer;
use bevy::shader::{Shader, ShaderRef};

use super::pack::{CAPACITIES, Class};

/// The material of branches and leaves.
pub type PlantMaterial = ExtendedMaterial<StandardMaterial, PlantExtension>;

/// The shader of all plants.
const SHADER: Handle<Shader> = uuid_handle!("6e0f2c54-61f4-4f0a-9f0e-2f4f43c1b0a7");

/// Unit, side and end of a vertex in one word, as `plants.wgsl` unpacks them.
const PACKED: MeshVertexAttribute = MeshVertexAttribute::new("Packed", 0x0B1A_DE50, VertexFormat::Uint32);

/// Steps around a ring: a whole number for every count of sides.
const AROUND: u32 = 240;

/// What the shader of plants reads besides the standard material.
#[derive(Asset, AsBindGroup, TypePath, Debug, Clone)]
#[bind_group_data(PlantKey)]
pub struct PlantExtension {
    /// Records of rings or blades.
    #[storage(100, read_only, visibility(vertex))]
    pub records: Handle<ShaderBuffer>,
    /// What organs of a plant share.
    #[storage(101, read_only, visibility(vertex))]
    pub plants: Handle<ShaderBuffer>,
    /// The clock: time, wind, what is shown.
    #[storage(102, read_only, visibility(vertex, fragment))]
    pub clock: Handle<ShaderBuffer>,
    /// Two bits a record: its mark.
    #[storage(103, read_only, visibility(vertex))]
    pub marks: Handle<ShaderBuffer>,
    /// Bark.
    #[texture(104)]
    #[sampler(105)]
    pub bark: Handle<Image>,
    /// Whether blades are drawn, else branches.
    pub leaf: bool,
}

/// What tells the pipelines of plants apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(C)]
pub struct PlantKey {
    leaf: bool,
}

impl From<&PlantExtension> for PlantKey {
    fn from(extension: &PlantExtension) -> Self {
        Self { leaf: extension.leaf }
    }
}

impl MaterialExtension for PlantExtension {
    fn vertex_shader() -> ShaderRef {
        SHADER.into()
    }

    fn fragment_shader() -> ShaderRef {
        SHADER.into()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        SHADER.into()
    }

    fn deferred_vertex_shader() -> ShaderRef {
        SHADER.into()
    }

    fn specialize(
        _: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        descriptor.vertex.buffers = vec![layout.0.get_layout(&[PACKED.at_shader_location(0)])?];
        // The vertex stage makes these itself; the mesh has none.
        let mut defs = vec!["VERTEX_UVS", "VERTEX_UVS_A", "VERTEX_UVS_B", "VERTEX_COLORS", "VERTEX_NORMALS"];
        if key.bind_group_data.leaf {
            defs.push("LEAF");
        }
        for def in defs {
            descriptor.vertex.shader_defs.push(def.into());
            if let Some(fragment) = &mut descriptor.fragment {
                fragment.shader_defs.push(def.into());
            }
        }
        Ok(())
    }
}

/// Enters the shader.
pub(super) fn load_shader(app: &mut App) {
    let shader = Shader::from_wgsl(include_str!("plants.wgsl"), "burgeon/render/plants.wgsl");
    if let Some(mut shaders) = app.world_mut().get_resource_mut::<Assets<Shader>>() {
        // Inserting under a fixed id fails only for generational ids.
        let _ = shaders.insert(SHADER.id(), shader);
    }
}

/// How much of a chunk is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Detail {
    /// Everything.
    Near,
    /// Fewer sides, a quarter of the blades with fewer points.
    Far,
}

/// The meshes of chunks, made as they are asked for.
#[derive(Resource, Default)]
pub struct ChunkMeshes(HashMap<(Class, u8, Detail), Handle<Mesh>>);

impl ChunkMeshes {
    /// The mesh of a class and capacity at a level of detail.
    pub fn get(
        &mut self,
        meshes: &mut Assets<Mesh>,
        class: Class,
        capacity: u8,
        detail: Detail,
    ) -> Handle<Mesh> {
        let made = self.0.entry((class, capacity, detail)).or_insert_with(|| {
            let units = CAPACITIES[capacity as usize % CAPACITIES.len()];
            let (vertices, indices) = match (class, detail) {
                (Class::Blades(points), Detail::Near) => blades(units, 1, points),
                (Class::Blades(points), Detail::Far) => blades(units, 4, points),
                (Class::Limbs, Detail::Near) => tubes(units, 12),
                (Class::Limbs, Detail::Far) | (Class::Branches, Detail::Near) => tubes(units, 6),
                (Class::Branches, Detail::Far) => tubes(units, 4),
                (Class::Twigs, Detail::Near) => tubes(units, 4),
                (Class::Twigs, Detail::Far) => tubes(units, 3),
            };
            meshes.add(
                Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::RENDER_WORLD)
                    .with_inserted_attribute(PACKED, vertices)
                    .with_inserted_indices(Indices::U32(indices)),
            )
        });
        made.clone()
    }
}

fn packed(unit: u32, side: u32, end: u32) -> u32 {
    unit | side << 16 | end << 24
}

/// Tube segments: between the rings of each unit and the next.
fn tubes(units: u32, sides: u32) -> (Vec<u32>, Vec<u32>) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for unit in 0..units {
        let first = vertices.len() as u32;
        for end in 0..2 {
            vertices.extend((0..=sides).map(|side| packed(unit, side * AROUND / sides, end)));
        }
        for k in 0..sides {
            let (a, c) = (first + k, first + sides + 1 + k);
            indices.extend([a, a + 1, c, a + 1, c + 1, c]);
        }
    }
    (vertices, indices)
}

/// Blades: a petiole and a strip of `points` pairs along the midrib, hollow in the middle; every `stride`-th unit.
fn blades(units: u32, stride: u32, points: u8) -> (Vec<u32>, Vec<u32>) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    let points = u32::from(points);
    for unit in (0..units).step_by(stride as usize) {
        let foot = vertices.len() as u32;
        vertices.push(packed(unit, 1, 0));
        // Far away the midrib need not be hollow: two vertices a point.
        let across: &[u32] = if stride == 1 { &[0, 1, 2] } else { &[0, 2] };
        let n = across.len() as u32;
        for point in 1..=points {
            vertices.extend(across.iter().map(|&side| packed(unit, side, point)));
        }
        for k in 0..n - 1 {
            indices.extend([foot, foot + 2 + k, foot + 1 + k]);
        }
        for point in 0..points - 1 {
            for k in 0..n - 1 {
                let a = foot + 1 + point * n + k;
                indices.extend([a, a + 1, a + n, a + 1, a + n + 1, a + n]);
            }
        }
    }
    (vertices, indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_close_and_use_every_vertex() {
        for (vertices, indices) in [tubes(16, 6), tubes(16, 4), blades(16, 1, 7), blades(16, 4, 4)] {
            let mut used = vec![false; vertices.len()];
            for &i in &indices {
                used[i as usize] = true;
            }
            assert!(used.iter().all(|&u| u));
            // A triangle belongs to one unit, so that a unit vanishes whole.
            for t in indices.chunks(3) {
                assert!(t.iter().all(|&i| vertices[i as usize] & 0xFFFF == vertices[t[0] as usize] & 0xFFFF));
            }
        }
        assert_eq!(tubes(1, 5).0[5] >> 16 & 0xFF, AROUND);
    }
}
