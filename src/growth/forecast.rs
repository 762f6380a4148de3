//! How many organs the next step may bear, so that a limit is met before it and not in its midst.

use bevy::prelude::*;

use super::shoots::{full_energy, plan};
use super::sprouts::{at_most, sprouts};
use super::{Mechanisms, generation::first_shoot_cost};
use crate::plant::{
    Allotment, BranchOrder, EnergyLedger, EnergyStore, LateralBud, LateralBudState, OrganKind, Plant, Roster,
};
use crate::species::Species;

/// Organs a bud of that order may bear in a step with an amount of energy: at least as many as it does.
pub fn borne_by_bud(species: &Species, order: u32, energy: f32) -> usize {
    let plan = plan(species, energy);
    let nodes = ((plan.length / species.node_spacing_m).ceil() as u32).saturating_add(1).min(plan.nodes);
    // The last segment before each node is cut to fit.
    let whole = (plan.length / species.internode_m).ceil() as u32;
    let segments =
        if species.internode_m < species.node_spacing_m { whole.saturating_add(nodes) } else { nodes };
    let at_each = species.leaves_per_node + species.lateral_buds_per_node + species.apical_buds_per_node;
    let whorl = if plan.closes { 0 } else { species.whorl_buds.get(order).round() as u32 };
    let fork = if species.terminal_death.get(order) > 0.0 { species.fork_shoots } else { 0 };
    let at_end = whorl + fork;
    (nodes as usize).saturating_mul(at_each as usize).saturating_add(segments as usize + at_end as usize)
}

/// Organs the next step may bear, all plants together: at least as many as it does.
pub fn next_step(world: &World) -> usize {
    let (Some(roster), Some(mechanisms)) =
        (world.get_resource::<Roster>(), world.get_resource::<Mechanisms>())
    else {
        return 0;
    };
    let species: Vec<Option<&Species>> = roster
        .plants
        .iter()
        .map(|plant| plant.and_then(|plant| world.get::<Plant>(plant)).map(|plant| &*plant.species))
        .collect();
    let mut most = 0_usize;
    for i in 0..roster.len() {
        let Some(species) = species[roster.plant[i] as usize] else { continue };
        let entity = roster.entity[i];
        let awake = match roster.kind[i] {
            OrganKind::ApicalBud => true,
            OrganKind::LateralBud => {
                world.get::<LateralBud>(entity).is_some_and(|bud| bud.state == LateralBudState::Dormant)
            }
            _ => false,
        };
        if !awake {
            continue;
        }
        let order = world.get::<BranchOrder>(entity).map_or(0, |order| order.0);
        let energy = match mechanisms.energy {
            true => world.get::<Allotment>(entity).map_or(0.0, |allotment| allotment.0),
            false => full_energy(species, order),
        };
        if energy > 0.0 {
            most = most.saturating_add(1).saturating_add(borne_by_bud(species, order, energy));
        }
    }
    for (plant, species) in roster.plants.iter().zip(&species) {
        let store = plant.and_then(|plant| world.get::<EnergyStore>(plant));
        if let (Some(species), Some(EnergyStore { germinated: None, .. })) = (species, store) {
            let energy = if mechanisms.energy { first_shoot_cost(species) } else { full_energy(species, 0) };
            most = most.saturating_add(1).saturating_add(borne_by_bud(species, 0, energy));
        } else if let (Some(species), Some(store), true) = (species, store, mechanisms.energy) {
            let closed =
                plant.and_then(|plant| world.get::<EnergyLedger>(plant)).map_or(0.0, |ledger| ledger.closed);
            most = most.saturating_add(at_most(sprouts(species, store.stored, closed - store.stored)));
        }
    }
    most
}
