//! A triangle mesh as plain data.

use bevy::prelude::*;

/// Which part of the plant a vertex belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Place {
    /// Index of its organ in the snapshot.
    pub organ: u32,
    /// How far along it, 0 at its base to 1 at its tip.
    pub along: f32,
}

/// Triangles with normals and texture coordinates, front faces counter-clockwise.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Vertices, world metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit normal of each vertex.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates of each vertex.
    pub uvs: Vec<[f32; 2]>,
    /// What each vertex belongs to.
    pub places: Vec<Place>,
    /// Three vertices a triangle.
    pub indices: Vec<u32>,
}

impl Surface {
    /// Whether there is nothing to see.
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Triangles in it.
    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }

    /// Least and greatest corner, `None` without vertices.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut all = self.positions.iter().map(|&p| Vec3::from(p));
        let first = all.next()?;
        Some(all.fold((first, first), |(low, high), p| (low.min(p), high.max(p))))
    }

    /// Adds a vertex and returns its index.
    pub(super) fn vertex(&mut self, position: Vec3, normal: Vec3, uv: [f32; 2], place: Place) -> u32 {
        // `limits::ORGANS` and at most 64 blades of 15 vertices an organ keep this below 2^32.
        let index = self.positions.len() as u32;
        self.positions.push(position.into());
        self.normals.push(normal.into());
        self.uvs.push(uv);
        self.places.push(place);
        index
    }

    pub(super) fn triangle(&mut self, a: u32, b: u32, c: u32) {
        self.indices.extend([a, b, c]);
    }
}
