//! The only way an organ leaves: [`shed`] walks what goes in a loop, tips first.

use bevy::ecs::lifecycle::HookContext;
use bevy::ecs::world::DeferredWorld;
use bevy::prelude::*;

use super::{
    Allotment, Cause, EnergyLedger, Fallen, GrowthSpan, Identity, NO_PARENT, OrganShed, Plant, Roster,
    Tombstone,
};
use crate::growth::StepCount;

/// Sheds organs, given by birth number, and all they bear. Returns how many went.
///
/// Energy allotted to them is booked as lost. No recursion, so a stem of any length can be cut.
pub fn shed(world: &mut World, condemned: &[(u32, Cause)]) -> usize {
    if condemned.is_empty() {
        return 0;
    }
    let roster = world.resource::<Roster>();
    let mut fate: Vec<Option<Cause>> = vec![None; roster.len()];
    for &(birth, cause) in condemned {
        if let Some(i) = roster.index_of(birth) {
            fate[i].get_or_insert(cause);
        }
    }
    for i in 0..fate.len() {
        let parent = roster.parent[i];
        if parent != NO_PARENT && fate[i].is_none() {
            fate[i] = fate[parent as usize];
        }
    }
    bury(world, &fate)
}

/// Sheds every organ whose entity was despawned from outside, and all it bore.
pub(crate) fn shed_missing(world: &mut World) -> usize {
    let roster = world.resource::<Roster>();
    let missing: Vec<(u32, Cause)> = (0..roster.len())
        .filter(|&i| !world.entities().contains(roster.entity[i]))
        .map(|i| (roster.birth[i], Cause::Pruned))
        .collect();
    shed(world, &missing)
}

fn bury(world: &mut World, fate: &[Option<Cause>]) -> usize {
    let step = world.resource::<StepCount>().0;
    let mut gone = 0;
    for i in (0..fate.len()).rev() {
        let Some(cause) = fate[i] else { continue };
        gone += 1;
        let roster = world.resource::<Roster>();
        let (entity, plant, kind, birth) =
            (roster.entity[i], roster.plant[i], roster.kind[i], roster.birth[i]);
        let plant_entity = roster.plants[plant as usize];
        let Ok(organ) = world.get_entity(entity) else { continue };
        let tombstone = Tombstone {
            birth,
            lineage: organ.get::<Identity>().map(|id| id.lineage).unwrap_or_default(),
            plant,
            kind,
            born: organ.get::<GrowthSpan>().map_or(step, GrowthSpan::born),
            died: step,
            cause,
        };
        let held = organ.get::<Allotment>().map_or(0.0, |a| f64::from(a.0));
        if let Some(plant) = plant_entity {
            if held != 0.0
                && let Some(mut ledger) = world.get_mut::<EnergyLedger>(plant)
            {
                ledger.lost += held;
                ledger.closed -= held;
            }
            world.write_message(OrganShed { plant, tombstone });
        }
        world.resource_mut::<Fallen>().bury(tombstone);
        world.despawn(entity);
    }
    let stays: Vec<bool> = fate.iter().map(Option::is_none).collect();
    world.resource_mut::<Roster>().retain(&stays);
    gone
}

/// Sheds all organs of the plant with this index.
pub(crate) fn uproot(world: &mut World, plant: u32) {
    let roster = world.resource::<Roster>();
    let fate: Vec<Option<Cause>> =
        roster.plant.iter().map(|&p| (p == plant).then_some(Cause::Uprooted)).collect();
    bury(world, &fate);
}

/// A new plant takes its place in the order of planting.
pub(super) fn plant_added(mut world: DeferredWorld, context: HookContext) {
    if let Some(mut roster) = world.get_resource_mut::<Roster>()
        && !roster.plants.contains(&Some(context.entity))
    {
        roster.plants.push(Some(context.entity));
    }
}

/// A plant that goes, by whatever means, takes its organs along.
pub(super) fn plant_removed(mut world: DeferredWorld, context: HookContext) {
    let Some(mut roster) = world.get_resource_mut::<Roster>() else { return };
    let Some(index) = roster.plants.iter().position(|p| *p == Some(context.entity)) else { return };
    roster.plants[index] = None;
    world.commands().queue(move |world: &mut World| uproot(world, index as u32));
}

/// Plants in the order of planting.
pub fn plants(world: &World) -> Vec<(Entity, &Plant)> {
    let Some(roster) = world.get_resource::<Roster>() else { return Vec::new() };
    roster.plants.iter().flatten().filter_map(|&e| world.get::<Plant>(e).map(|p| (e, p))).collect()
}
