//! Income and upkeep (`LK-10`, `LK-11`).

use bevy::prelude::*;

use super::Mechanisms;
use super::generation::Condemned;
use crate::plant::{
    ApicalBud, Cause, EnergyFlow, EnergyLedger, EnergyStore, Exposure, GrowthSpan, Identity, Internode, Leaf,
    OrganKind, Plant, Roster,
};
use crate::species::Species;

use super::StepCount;

/// Share of full income that an amount of light earns: proportional, or saturating as `(1 + k) L / (L + k)`.
pub fn light_response(light: f32, saturation: f32) -> f32 {
    if saturation <= 0.0 {
        return light;
    }
    let k = 1.0 / saturation;
    (1.0 + k) * light / (light + k)
}

/// What a leaf photosynthesises in a step: in proportion to its size, the light on it and the time its stomata
/// are open.
pub fn leaf_income(species: &Species, size: f32, light: f32) -> f32 {
    species.leaf_income * size * light_response(light, species.light_saturation) * species.stomata_open
}

/// What a stem segment uses in a step.
pub fn wood_upkeep(species: &Species, internode: &Internode) -> f32 {
    species.wood_upkeep * core::f32::consts::PI * internode.radius * internode.radius * internode.length
}

/// Leaves photosynthesise; those at the end of their life fall afterwards.
pub fn photosynthesise(
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    mut condemned: ResMut<Condemned>,
    plants: Query<&Plant>,
    mut leaves: Query<(&Identity, &GrowthSpan, &Leaf, &Exposure, &mut EnergyFlow)>,
) {
    for i in 0..roster.len() {
        if roster.kind[i] != OrganKind::Leaf {
            continue;
        }
        let Ok((identity, span, leaf, exposure, mut flow)) = leaves.get_mut(roster.entity[i]) else {
            continue;
        };
        let Ok(plant) = plants.get(identity.plant) else { continue };
        let species = &plant.species;
        let light = if mechanisms.light { exposure.light } else { 1.0 };
        flow.income =
            if mechanisms.energy && exposure.sensed { leaf_income(species, leaf.size, light) } else { 0.0 };
        flow.upkeep = if mechanisms.energy { species.leaf_upkeep * leaf.size } else { 0.0 };
        if species.leaf_life_steps > 0 && step.0 - span.born() >= species.leaf_life_steps {
            condemned.0.push((identity.birth, Cause::Senescence));
        }
    }
}

/// Every other organ's upkeep falls due; income goes to the store and pays it as far as it can.
#[allow(clippy::type_complexity, reason = "a query names its parts")]
pub fn pay_upkeep(
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    plants: Query<&Plant>,
    mut books: Query<(&mut EnergyStore, &mut EnergyLedger)>,
    mut organs: Query<(Option<&Internode>, Has<ApicalBud>, &mut EnergyFlow)>,
) {
    if !mechanisms.energy {
        return;
    }
    let species: Vec<Option<&Species>> =
        roster.plants.iter().map(|p| p.and_then(|p| plants.get(p).ok()).map(|p| &*p.species)).collect();
    let mut income = vec![0.0_f64; roster.plants.len()];
    let mut due = vec![0.0_f64; roster.plants.len()];
    for i in 0..roster.len() {
        let plant = roster.plant[i] as usize;
        let (Some(species), Ok((internode, apical, mut flow))) =
            (species[plant], organs.get_mut(roster.entity[i]))
        else {
            continue;
        };
        if let Some(internode) = internode {
            flow.upkeep = wood_upkeep(species, internode);
        } else if apical {
            flow.upkeep = species.bud_upkeep;
        }
        income[plant] += f64::from(flow.income);
        due[plant] += f64::from(flow.upkeep);
    }
    for (plant, entity) in roster.plants.iter().enumerate() {
        let Some(Ok((mut store, mut ledger))) = entity.map(|e| books.get_mut(e)) else { continue };
        ledger.income = income[plant];
        store.stored += income[plant];
        let paid = due[plant].min(store.stored);
        store.stored -= paid;
        ledger.upkeep = paid;
        ledger.unpaid = due[plant] - paid;
    }
}
