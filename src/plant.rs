//! What a plant is: organs as entities, who grew from whom, the energy they share, and the
//! [`Snapshot`] everything else reads.

mod check;
mod energy;
mod identity;
pub mod measure;
mod organ;
pub mod pose;
mod roster;
mod shed;
pub mod skeleton;
mod snapshot;
pub mod strahler;

pub use check::SnapshotError;
pub use energy::{EnergyLedger, EnergyStore};
pub use identity::{Bears, Cause, Fallen, GrowsFrom, GrowthSpan, Identity, Lineage, OrganShed, Tombstone};
pub use organ::{
    Allotment, ApicalBud, Attachment, BranchOrder, EnergyFlow, Exposure, GrowthTarget, Internode, LateralBud,
    LateralBudState, Leaf, LeafState, Node, OrganKind, Pose,
};
pub use roster::{NO_PARENT, Roster};
pub(crate) use shed::shed_missing;
pub use shed::{plants, shed};
pub(crate) use snapshot::plant_transform;
pub use snapshot::{OrganState, PlantRecord, Snapshot, restore};

use std::sync::Arc;

use bevy::prelude::*;

use crate::species::Species;

/// A plant: its seed and its root (`LK-9`). Spawn one and it germinates in the next growth step.
///
/// Stands under any [`Transform`]; despawning it by any means removes all it bears.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component)]
#[require(Transform, EnergyStore, EnergyLedger)]
#[component(on_add = shed::plant_added, on_remove = shed::plant_removed)]
pub struct Plant {
    /// The kind of plant it is.
    pub species: Arc<Species>,
    /// Seed of every random draw it makes.
    pub seed: u64,
}

impl Plant {
    /// A plant of a species, as a seed.
    pub fn new(species: impl Into<Arc<Species>>, seed: u64) -> Self {
        Self { species: species.into(), seed }
    }
}

/// The resources and messages plants need, and their types for reflection.
pub struct PlantPlugin;

impl Plugin for PlantPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Roster>()
            .init_resource::<Fallen>()
            .init_resource::<Messages<OrganShed>>()
            .register_type::<Plant>()
            .register_type::<Species>()
            .register_type::<Roster>()
            .register_type::<Fallen>()
            .register_type::<Messages<OrganShed>>()
            .register_type::<EnergyStore>()
            .register_type::<EnergyLedger>()
            .register_type::<Identity>()
            .register_type::<GrowsFrom>()
            .register_type::<Bears>()
            .register_type::<GrowthSpan>()
            .register_type::<Internode>()
            .register_type::<Node>()
            .register_type::<ApicalBud>()
            .register_type::<LateralBud>()
            .register_type::<Leaf>()
            .register_type::<Exposure>()
            .register_type::<Allotment>()
            .register_type::<EnergyFlow>()
            .register_type::<GrowthTarget>()
            .register_type::<crate::tropism::Steering>()
            .register_type::<crate::tropism::Signals>()
            .register_type::<BranchOrder>()
            .register_type::<Attachment>()
            .register_type::<Pose>();
        // A snapshot asks for all of them, also in a world where some kind of organ has never been born.
        let world = app.world_mut();
        world.register_component::<Identity>();
        world.register_component::<GrowthSpan>();
        world.register_component::<BranchOrder>();
        world.register_component::<Attachment>();
        world.register_component::<Pose>();
        world.register_component::<EnergyFlow>();
        world.register_component::<Internode>();
        world.register_component::<Node>();
        world.register_component::<ApicalBud>();
        world.register_component::<crate::tropism::Steering>();
        world.register_component::<crate::tropism::Signals>();
        world.register_component::<GrowthTarget>();
        world.register_component::<LateralBud>();
        world.register_component::<Leaf>();
        world.register_component::<Exposure>();
        world.register_component::<Allotment>();
    }
}
