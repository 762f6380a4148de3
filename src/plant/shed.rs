//! The only way an organ leaves.

use bevy::ecs::lifecycle::HookContext;
use bevy::ecs::world::DeferredWorld;
use bevy::prelude::*;

use super::Cause;

/// A plant entity went, by whatever means.
#[derive(Message, Debug, Clone, Copy)]
pub struct PlantGone(pub Entity);

/// Sheds organs and all they bear.
pub fn shed(_world: &mut World, _roots: &[(usize, Cause)]) -> usize {
    0
}

/// Removes a plant and all it bears.
pub fn remove_plant(_world: &mut World, _plant: Entity) {}

pub(super) fn plant_removed(_world: DeferredWorld, _context: HookContext) {}
