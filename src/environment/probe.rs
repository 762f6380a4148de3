//! Probes: the points from which plants look around, and how they look.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// How a bud compares the positions it could grow to (`LK-15`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum SensingMode {
    /// A cube map at every candidate position: the paper's way, and the slow one.
    MapPerCandidate,
    /// One cube map at the bud, re-projected to every candidate position.
    #[default]
    Reprojected,
}

/// How texels of a cube map count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum TexelWeight {
    /// All alike: a plain average over pixels, as in the paper.
    #[default]
    Alike,
    /// By the solid angle each covers.
    SolidAngle,
}

/// How buds and leaves look around, a resource.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Resource)]
#[serde(default, deny_unknown_fields)]
pub struct Sensing {
    /// Texels along the side of a leaf's cube-map face.
    pub leaf_face: u32,
    /// Texels along the side of a growing bud's cube-map face.
    pub bud_face: u32,
    /// How candidate positions are compared.
    pub mode: SensingMode,
    /// How texels count in the share and space readings.
    pub weight: TexelWeight,
}

impl Default for Sensing {
    fn default() -> Self {
        Self { leaf_face: 8, bud_face: 12, mode: SensingMode::default(), weight: TexelWeight::default() }
    }
}

/// A point from which an organ looks around.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Where, world metres.
    pub position: Vec3,
    /// Birth numbers of organs it does not see: itself and the internode it sits on.
    pub blind_to: [u32; 2],
    /// Texels along a face's side.
    pub face: u32,
    /// Distance at which free space is full, metres.
    pub space_range: f32,
}
