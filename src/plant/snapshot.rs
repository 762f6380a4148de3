//! The one currency for everything that reads a plant: a [`Snapshot`].

use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Allotment, ApicalBud, Attachment, BranchOrder, EnergyFlow, EnergyLedger, EnergyStore, Exposure,
    GrowthSpan, GrowthTarget, Identity, Internode, LateralBud, Leaf, Lineage, NO_PARENT, Node, OrganKind,
    Plant, Pose, Roster,
};
use crate::species::Species;
use crate::tropism::Steering;

/// What an organ is and the state only its kind has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum OrganState {
    /// A stem segment, and the node it ends in if it does.
    Internode(Internode, Option<Node>),
    /// A growing tip.
    ApicalBud(ApicalBud, Steering, Option<GrowthTarget>),
    /// A side bud.
    LateralBud(LateralBud),
    /// A leaf.
    Leaf(Leaf),
}

impl OrganState {
    /// Its kind.
    pub fn kind(&self) -> OrganKind {
        match self {
            Self::Internode(..) => OrganKind::Internode,
            Self::ApicalBud(..) => OrganKind::ApicalBud,
            Self::LateralBud(_) => OrganKind::LateralBud,
            Self::Leaf(_) => OrganKind::Leaf,
        }
    }
}

/// A plant, as a snapshot holds it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlantRecord {
    /// Its species.
    pub species: Arc<Species>,
    /// Its seed.
    pub seed: u64,
    /// Where it stands.
    pub position: Vec3,
    /// Its turn.
    pub rotation: Quat,
    /// Its store.
    pub store: EnergyStore,
    /// Its books of the last step.
    pub ledger: EnergyLedger,
    /// Step it was sown in.
    pub sown: u32,
}

/// All plants of a world at the end of a step: structure of arrays in birth order, parents first.
///
/// Index `i` of every column is the same organ.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Steps grown.
    pub step: u32,
    /// Plants in the order of planting; gone ones leave `None`.
    pub plants: Vec<Option<PlantRecord>>,
    /// Birth number, strictly rising.
    pub birth: Vec<u32>,
    /// Index of the organ it grows from, or [`NO_PARENT`].
    pub parent: Vec<u32>,
    /// Index of its plant.
    pub plant: Vec<u32>,
    /// Its place in the family.
    pub lineage: Vec<Lineage>,
    /// When it grew.
    pub span: Vec<GrowthSpan>,
    /// Order of its axis.
    pub order: Vec<u32>,
    /// Turn relative to its parent.
    pub attachment: Vec<Quat>,
    /// Where it is in the world.
    pub pose: Vec<Pose>,
    /// Light and space.
    pub exposure: Vec<Exposure>,
    /// Energy set aside for it.
    pub allotment: Vec<f32>,
    /// What it earned and used in the last step.
    pub flow: Vec<EnergyFlow>,
    /// What only its kind has.
    pub state: Vec<OrganState>,
}

impl Snapshot {
    /// Organs in it.
    pub fn len(&self) -> usize {
        self.birth.len()
    }

    /// Whether nothing lives.
    pub fn is_empty(&self) -> bool {
        self.birth.is_empty()
    }

    /// Takes a snapshot of a world.
    pub fn take(world: &World) -> Self {
        let _ = world;
        Self::default()
    }
}
