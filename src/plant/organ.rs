//! The organs: what each kind of entity carries (`LK-2`).

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// The kinds of organ (`LK-2`; seed and root are the [`Plant`](super::Plant) itself, a node sits on its internode).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Reflect, Serialize, Deserialize)]
pub enum OrganKind {
    /// One straight segment of stem.
    Internode,
    /// The growing tip of an axis.
    ApicalBud,
    /// A bud at the side of a stem.
    LateralBud,
    /// A leaf, or the spray or tuft of leaves it stands for.
    Leaf,
}

/// One straight segment of stem (`LK-3`); several may lie between two nodes.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Internode {
    /// Length, metres.
    pub length: f32,
    /// Radius, metres. Never shrinks.
    pub radius: f32,
    /// Length grown since the last node below, this segment included, metres (the paper's local height).
    pub height_since_node: f32,
    /// Length from the base of its axis to its tip, metres (the paper's accumulated height).
    pub height_in_branch: f32,
    /// `radius` to the power of the species' pipe exponent: what it adds to the stem below.
    pub pipe: f32,
    /// Steps in a row in which the axis that begins here earned too little for its wood.
    pub poor_steps: u32,
    /// Angle by which load has bent it and wood has set, radians.
    pub sag: f32,
}

/// Marks an internode that ends in a node.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Node {
    /// Which node of its axis it is, from 0.
    pub ordinal: u32,
}

/// The growing tip of an axis (`LK-3`).
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct ApicalBud {
    /// Angle about the stem of the next organ to form, radians.
    pub phyllotaxis: f32,
    /// Length grown since the last node, metres.
    pub height_since_node: f32,
    /// Length of its axis so far, metres.
    pub height_in_branch: f32,
    /// Nodes formed on its axis.
    pub nodes: u32,
    /// Steps in a row without energy to grow.
    pub starved: u32,
}

/// What a lateral bud is doing (`LK-6`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum LateralBudState {
    /// Waiting for its dormancy to run out.
    #[default]
    Dormant,
    /// Has broken: its axis grows, the bud itself is spent (`LK-7`).
    Growing,
    /// Will never break.
    Dead,
}

/// A bud at the side of a stem (`LK-6`).
#[derive(Component, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct LateralBud {
    /// Dormant, growing or dead.
    pub state: LateralBudState,
    /// Dormancy left, steps. Counts down only in enough light and energy.
    pub dormancy: u32,
    /// Steps in a row without enough light or energy.
    pub starved: u32,
    /// Where it sits in the growth unit that formed it: 0 at its base, 1 at its tip.
    pub rank: f32,
    /// Demand by the side of its stem it sits on, 0 and more; 1 unless its species is epitonic.
    pub favour: f32,
}

impl Default for LateralBud {
    fn default() -> Self {
        Self { state: LateralBudState::Dormant, dormancy: 0, starved: 0, rank: 0.0, favour: 1.0 }
    }
}

/// What a leaf is doing (`LK-8`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum LeafState {
    /// Still unfolding.
    #[default]
    Growing,
    /// Full grown.
    Terminated,
}

/// A leaf (`LK-8`).
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Leaf {
    /// Area as a share of the species' largest leaf, 0..1.
    pub size: f32,
    /// Growing or terminated.
    pub state: LeafState,
}

/// Light and space found at an organ when the environment was last sensed (`LK-13`).
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Exposure {
    /// Light, 0 (dark) to 1 (saturated).
    pub light: f32,
    /// Space, 0 (crowded) to 1 (nothing within the species' range).
    pub space: f32,
    /// False until sensed once; the values are then those of the bud it came from.
    pub sensed: bool,
}

/// Energy set aside for this organ's growth in the next step.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Allotment(pub f32);

/// What an organ earned and used in the last step.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct EnergyFlow {
    /// Photosynthesised.
    pub income: f32,
    /// Paid for staying alive.
    pub upkeep: f32,
}

/// Where a bud will grow to, as found by the last sensing (`LK-15`).
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct GrowthTarget {
    /// Unit vector in world space; zero while the bud has not looked for one.
    pub heading: Vec3,
    /// Fitness of the chosen position.
    pub fitness: f32,
}

/// Order of the axis an organ belongs to: trunk 0, child = parent + 1. For a bud, of the axis it makes.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct BranchOrder(pub u32);

/// Turn of an organ relative to the internode (or plant) it grows from; its heading is local +Y.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Attachment(pub Quat);

/// Where an organ is in the world, derived once a step from the attachments below it.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Pose {
    /// Its base, metres.
    pub position: Vec3,
    /// Its turn; the heading is `rotation * Y`.
    pub rotation: Quat,
}

impl Pose {
    /// Unit vector the organ points along.
    pub fn heading(&self) -> Vec3 {
        self.rotation * Vec3::Y
    }

    /// The point `length` metres along the heading.
    pub fn tip(&self, length: f32) -> Vec3 {
        self.position + self.heading() * length
    }
}
