//! How an organ is born: one place that keeps entity, roster and identity together.

use bevy::prelude::*;

use crate::plant::{
    Attachment, BranchOrder, EnergyFlow, GrowsFrom, GrowthSpan, Identity, Lineage, OrganKind, Pose, Roster,
};

/// What every newborn organ has, whatever its kind.
pub(super) struct Newborn {
    /// The plant it belongs to.
    pub plant: Entity,
    /// Index of that plant.
    pub plant_index: u32,
    /// The organ (or plant) it grows from.
    pub from: Entity,
    /// Index of that organ in the roster.
    pub parent: u32,
    /// Its place in the family.
    pub lineage: Lineage,
    /// Order of its axis.
    pub order: u32,
    /// Turn relative to its parent.
    pub attachment: Quat,
    /// Where it is.
    pub pose: Pose,
    /// When it grows.
    pub span: GrowthSpan,
}

impl Newborn {
    /// Spawns it with the state of its kind and enters it in the roster.
    pub fn bear(
        self,
        commands: &mut Commands,
        roster: &mut Roster,
        kind: OrganKind,
        state: impl Bundle,
    ) -> Entity {
        let entity = commands
            .spawn((
                Identity { plant: self.plant, birth: roster.next_birth, lineage: self.lineage },
                GrowsFrom(self.from),
                self.span,
                BranchOrder(self.order),
                Attachment(self.attachment),
                self.pose,
                EnergyFlow::default(),
                state,
            ))
            .id();
        roster.bear(entity, self.parent, self.plant_index, kind);
        entity
    }
}
