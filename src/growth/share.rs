//! Sharing the surplus: to leaves, to buds, the rest to the root (`LK-12`).

use bevy::prelude::*;

use super::vigour::{self, Sink, SinkKind};
use super::{Mechanisms, StepCount};
use crate::chance::{self, Purpose};
use crate::plant::{
    Allotment, ApicalBud, BranchOrder, EnergyFlow, EnergyLedger, EnergyStore, Exposure, Identity, Internode,
    LateralBud, LateralBudState, Leaf, LeafState, OrganKind, Plant, Roster,
};
use crate::species::{Allocation, Species};

/// An organ that asks for energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// Its light.
    pub light: f32,
    /// What it can use.
    pub need: f32,
    /// Less than this is of no use to it.
    pub least: f32,
}

/// Serves claims in order of light, highest first, ties in the order given, until the energy is gone: winner
/// takes all. Returns what each gets, and takes it off `energy`.
pub fn by_exposure(claims: &[Claim], energy: &mut f64) -> Vec<f32> {
    let mut order: Vec<usize> = (0..claims.len()).collect();
    order.sort_by(|&a, &b| claims[b].light.total_cmp(&claims[a].light).then(a.cmp(&b)));
    let mut shares = vec![0.0; claims.len()];
    for i in order {
        let share = claims[i].need.min(*energy as f32);
        if share > 0.0 && share >= claims[i].least {
            shares[i] = share;
            *energy = (*energy - f64::from(share)).max(0.0);
        }
    }
    shares
}

/// Least part of a full shoot worth growing.
const LEAST_SHOOT: f32 = 0.1;

/// Shares each plant's surplus, and what its store releases, among its organs.
#[allow(clippy::type_complexity, clippy::too_many_arguments, reason = "a system names what it reads")]
pub fn share_surplus(
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    plants: Query<&Plant>,
    mut books: Query<(&mut EnergyStore, &mut EnergyLedger)>,
    organs: Query<(
        &Identity,
        &BranchOrder,
        &EnergyFlow,
        Option<&Exposure>,
        Option<&Leaf>,
        Option<&LateralBud>,
        Option<&ApicalBud>,
        Option<&Internode>,
    )>,
    mut allotments: Query<&mut Allotment>,
) {
    if !mechanisms.energy {
        return;
    }
    let mut mine: Vec<Vec<usize>> = vec![Vec::new(); roster.plants.len()];
    let mut reclaimed = vec![0.0_f64; roster.plants.len()];
    for i in 0..roster.len() {
        mine[roster.plant[i] as usize].push(i);
        if let Ok(mut allotment) = allotments.get_mut(roster.entity[i])
            && allotment.0 != 0.0
        {
            reclaimed[roster.plant[i] as usize] += f64::from(allotment.0);
            allotment.0 = 0.0;
        }
    }
    for (index, entity) in roster.plants.iter().enumerate() {
        let Some(entity) = *entity else { continue };
        let (Ok(plant), Ok((mut store, ledger))) = (plants.get(entity), books.get_mut(entity)) else {
            continue;
        };
        let species = &*plant.species;
        let surplus = (ledger.income - ledger.upkeep - ledger.unpaid).max(0.0).min(store.stored);
        let reserve = store.stored - surplus;
        store.stored += reclaimed[index];
        let energy = surplus + reclaimed[index] + f64::from(species.store_release) * reserve.max(0.0);
        let energy = energy.min(store.stored);
        let organ = |i: usize| organs.get(roster.entity[i]).ok();
        let shares = match species.allocation {
            Allocation::ByExposure => {
                share_by_exposure(&mine[index], energy, species, mechanisms.light, &roster, organ)
            }
            Allocation::ByVigour => {
                let age = step.0 - store.germinated.unwrap_or(step.0);
                share_by_vigour(&mine[index], energy, store.stored, age, plant, step.0, &roster, organ)
            }
        };
        for (i, share) in shares {
            if let Ok(mut allotment) = allotments.get_mut(roster.entity[i]) {
                allotment.0 = share;
                store.stored -= f64::from(share);
            }
        }
        store.stored = store.stored.max(0.0);
    }
}

type Organ<'a> = (
    &'a Identity,
    &'a BranchOrder,
    &'a EnergyFlow,
    Option<&'a Exposure>,
    Option<&'a Leaf>,
    Option<&'a LateralBud>,
    Option<&'a ApicalBud>,
    Option<&'a Internode>,
);

fn share_by_exposure<'a>(
    mine: &[usize],
    mut energy: f64,
    species: &Species,
    light_matters: bool,
    roster: &Roster,
    organ: impl Fn(usize) -> Option<Organ<'a>>,
) -> Vec<(usize, f32)> {
    let mut shares = Vec::new();
    for kind in [OrganKind::Leaf, OrganKind::ApicalBud] {
        let (claimants, claims): (Vec<usize>, Vec<Claim>) = mine
            .iter()
            .filter(|&&i| roster.kind[i] == kind)
            .filter_map(|&i| {
                let (_, _, _, exposure, leaf, ..) = organ(i)?;
                let light = if light_matters { exposure.map_or(0.0, |e| e.light) } else { 1.0 };
                let claim = match leaf {
                    Some(leaf) if leaf.state == LeafState::Growing => {
                        let need = (1.0 - leaf.size).min(species.leaf_growth) * species.leaf_cost;
                        Claim { light, need, least: 0.0 }
                    }
                    Some(_) => return None,
                    None => {
                        let need = species.extension_m * species.shoot_cost;
                        Claim { light, need, least: need * LEAST_SHOOT }
                    }
                };
                Some((i, claim))
            })
            .unzip();
        shares.extend(
            claimants.into_iter().zip(by_exposure(&claims, &mut energy)).filter(|(_, share)| *share > 0.0),
        );
    }
    shares
}

#[allow(clippy::too_many_arguments, reason = "what the vigour of a plant depends on")]
fn share_by_vigour<'a>(
    mine: &[usize],
    energy: f64,
    stored: f64,
    age: u32,
    plant: &Plant,
    step: u32,
    roster: &Roster,
    organ: impl Fn(usize) -> Option<Organ<'a>>,
) -> Vec<(usize, f32)> {
    let species = &*plant.species;
    let position = |i: usize| mine.binary_search(&i).map_or(u32::MAX, |p| p as u32);
    let sinks: Vec<Sink> = mine
        .iter()
        .map(|&i| {
            let parent = match roster.parent[i] {
                crate::plant::NO_PARENT => crate::plant::NO_PARENT,
                p => position(p as usize),
            };
            let Some((_, order, flow, exposure, leaf, lateral, apical, _)) = organ(i) else {
                return Sink { parent, order: 0, kind: SinkKind::Spent, demand: 0.0 };
            };
            let light = exposure.map_or(0.0, |e| e.light);
            let (kind, demand) = if leaf.is_some() {
                (SinkKind::Spent, flow.income / species.leaf_income.max(f32::MIN_POSITIVE))
            } else if let Some(bud) = lateral {
                match bud.state {
                    LateralBudState::Dormant => (SinkKind::Bud, light * vigour::acrotony(species, bud.rank)),
                    _ => (SinkKind::Spent, 0.0),
                }
            } else if apical.is_some() {
                (SinkKind::Bud, light)
            } else {
                (SinkKind::Stem, 0.0)
            };
            Sink { parent, order: order.0, kind, demand }
        })
        .collect();
    let unit = f64::from(vigour::internode_cost(species));
    let mut budget = energy * f64::from(1.0 - species.wood_share) / unit;
    if age < species.seedling_steps {
        budget = budget.max(f64::from(species.seedling_vigour)).min(stored / unit);
    }
    let control = |order: u32| {
        let young = species.apical_control.get(order);
        let least = species.apical_control_least.min(young);
        (young + species.apical_control_ageing * age as f32).clamp(least, 1.0)
    };
    let vigours = vigour::settle(sinks.clone(), budget as f32, species.vigour_short, control);
    let mut wishes: Vec<(usize, f32, f32)> = Vec::new();
    for (k, sink) in sinks.iter().enumerate() {
        if sink.kind != SinkKind::Bud {
            continue;
        }
        let Some((identity, ..)) = organ(mine[k]) else { continue };
        let mut rng = chance::stream(plant.seed, identity.lineage, step, Purpose::Rounding);
        let cost = vigour::shoot_cost(species, vigours[k], sink.order, chance::unit(&mut rng));
        if cost > 0.0 {
            wishes.push((mine[k], vigours[k], cost));
        }
    }
    // Chance may round the sum above what there is: the most vigorous are served first.
    wishes.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let mut left = stored;
    wishes.retain(|&(_, _, cost)| {
        let served = f64::from(cost) <= left;
        if served {
            left -= f64::from(cost);
        }
        served
    });
    wishes.into_iter().map(|(i, _, cost)| (i, cost)).collect()
}
