//! Income and upkeep (`LK-10`, `LK-11`).

use bevy::prelude::*;

use super::Mechanisms;
use super::generation::Condemned;
use crate::plant::{
    ApicalBud, Cause, EnergyFlow, EnergyLedger, EnergyStore, Exposure, GrowthSpan, Identity, Internode, Leaf,
    NO_PARENT, OrganKind, Plant, Roster,
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

/// Leaves photosynthesise. Those at the end of their life fall afterwards and hand what they earned to their stem, in
/// whose name it counts when the surplus is shared.
///
/// A leaf that has not looked around yet has the light of its bud. One that lives a single summer must earn by it:
/// earned a step later alone, what one year's leaves gather would feed those of the year after next, and shoots of odd
/// and of even years would live apart.
pub fn photosynthesise(
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    mut condemned: ResMut<Condemned>,
    plants: Query<&Plant>,
    leaves: Query<(&Identity, &GrowthSpan, &Leaf, &Exposure)>,
    mut flows: Query<&mut EnergyFlow>,
) {
    for i in 0..roster.len() {
        let Some(plant) = roster.plants[roster.plant[i] as usize].and_then(|plant| plants.get(plant).ok())
        else {
            continue;
        };
        let (species, entity) = (&*plant.species, roster.entity[i]);
        let Ok(mut flow) = flows.get_mut(entity) else { continue };
        if roster.kind[i] == OrganKind::Internode {
            flow.income = 0.0;
        }
        let Ok((identity, span, leaf, exposure)) = leaves.get(entity) else { continue };
        let light = if mechanisms.light { exposure.light } else { 1.0 };
        let earns = mechanisms.energy && (exposure.sensed || species.leaf_earns_at_once);
        let income = if earns { leaf_income(species, leaf.size, light) } else { 0.0 };
        flow.upkeep = if mechanisms.energy { species.leaf_upkeep * leaf.size } else { 0.0 };
        flow.income = income;
        if species.leaf_life_steps == 0 || step.0 - span.born() < species.leaf_life_steps {
            continue;
        }
        condemned.0.push((identity.birth, Cause::Senescence));
        let stem = roster.parent[i];
        if stem != NO_PARENT
            && let Ok([mut leaf, mut stem]) = flows.get_many_mut([entity, roster.entity[stem as usize]])
        {
            leaf.income = 0.0;
            stem.income += income;
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
