//! Who an organ is, what it grew from, and what became of those that went.

use std::collections::VecDeque;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use super::OrganKind;

/// An organ's place in its family: the parent's lineage hashed with the child's ordinal.
///
/// It depends on nothing but descent, so a wall on one side of a tree changes no draw on the other.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Reflect, Serialize, Deserialize,
)]
pub struct Lineage(pub u64);

impl Lineage {
    /// The lineage of a plant's first bud.
    pub const SEED: Lineage = Lineage(0x9e37_79b9_7f4a_7c15);

    /// The lineage of this organ's `ordinal`-th child.
    pub fn child(self, ordinal: u32) -> Lineage {
        Lineage(crate::chance::mix(self.0 ^ crate::chance::mix(u64::from(ordinal).wrapping_add(1))))
    }
}

/// Who an organ is. Every organ has one.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Reflect)]
#[reflect(Component)]
pub struct Identity {
    /// The plant it belongs to.
    pub plant: Entity,
    /// Number of its birth among all organs of the world. An apical bud that grows is born anew beyond its
    /// new internodes, as rule 1 (A -> I A) writes a new A: parents always have lower numbers than children.
    pub birth: u32,
    /// Its place in the family.
    pub lineage: Lineage,
}

/// The time over which an organ came to its present place and length, in growth steps: what a host draws
/// between two steps follows it, growth never reads it.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct GrowthSpan {
    /// Begin; the integer part is the step it was born in.
    pub start: f32,
    /// End.
    pub end: f32,
}

impl GrowthSpan {
    /// The whole of one step.
    pub fn step(step: u32) -> Self {
        Self { start: step as f32, end: step as f32 + 1.0 }
    }

    /// The step it was born in.
    pub fn born(&self) -> u32 {
        self.start as u32
    }
}

/// The internode (or plant) this organ grows from.
///
/// Not [`ChildOf`]: topology is no scene graph. No `linked_spawn`: despawning a long stem recursively
/// overflows the stack, so [`shed`](super::shed) walks it in a loop.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq, Reflect)]
#[reflect(Component)]
#[relationship(relationship_target = Bears)]
pub struct GrowsFrom(pub Entity);

/// The organs that grow from this internode or plant.
#[derive(Component, Debug, Default, Reflect)]
#[reflect(Component)]
#[relationship_target(relationship = GrowsFrom)]
pub struct Bears(SmallVec<[Entity; 4]>);

/// Why an organ went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
pub enum Cause {
    /// It cost more than it earned in a shortage (`LK-11`).
    Liability,
    /// Its branch earned too little for its wood for too long.
    SelfPruned,
    /// A bud without energy or light for longer than its species' patience.
    Starved,
    /// A leaf at the end of its life.
    Senescence,
    /// An apical bud that turned into the buds of its node (`LK-5`).
    Branched,
    /// A terminal bud that died so that laterals take over (sympodial growth).
    Aborted,
    /// Cut.
    Pruned,
    /// A solid was set on it.
    Crushed,
    /// Its plant was removed.
    Uprooted,
}

/// What is left of an organ that went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Reflect, Serialize, Deserialize)]
pub struct Tombstone {
    /// Birth number.
    pub birth: u32,
    /// Its place in the family.
    pub lineage: Lineage,
    /// Index of its plant in the order of planting.
    pub plant: u32,
    /// Its kind.
    pub kind: OrganKind,
    /// Step it was born in.
    pub born: u32,
    /// Step it went in.
    pub died: u32,
    /// Why.
    pub cause: Cause,
}

/// Tombstones, oldest first; the newest [`Fallen::LIMIT`] are kept.
#[derive(Resource, Debug, Clone, Default, Reflect, Serialize, Deserialize)]
#[reflect(Resource)]
pub struct Fallen {
    /// Oldest first.
    pub tombstones: VecDeque<Tombstone>,
    /// How many ever went, kept or not.
    pub total: u64,
}

impl Fallen {
    /// How many tombstones are kept, so that a tree at balance does not grow in memory.
    pub const LIMIT: usize = 200_000;

    pub(crate) fn bury(&mut self, tombstone: Tombstone) {
        if self.tombstones.len() == Self::LIMIT {
            self.tombstones.pop_front();
        }
        self.tombstones.push_back(tombstone);
        self.total += 1;
    }
}

/// An organ went. Written once an organ, tips first.
#[derive(Message, Debug, Clone, Copy, Reflect)]
pub struct OrganShed {
    /// The plant it belonged to.
    pub plant: Entity,
    /// What is left of it.
    pub tombstone: Tombstone,
}
