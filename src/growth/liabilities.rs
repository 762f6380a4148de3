//! What a plant gives up: liabilities in a shortage (`LK-11`) and side axes that earn too little for their wood.

use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;

use super::generation::Condemned;
use super::{Mechanisms, StepCount};
use crate::plant::{
    ApicalBud, BranchOrder, Cause, EnergyFlow, EnergyLedger, Exposure, GrowthSpan, Internode, NO_PARENT,
    OrganKind, Plant, Roster,
};

/// An organ as the judges see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Account {
    /// Index of the organ it grows from, or [`NO_PARENT`].
    pub parent: u32,
    /// Its kind.
    pub kind: OrganKind,
    /// Whether a side axis begins here.
    pub begins_axis: bool,
    /// Earned in this step.
    pub income: f32,
    /// Due in this step.
    pub upkeep: f32,
    /// False for a leaf that has not looked around yet.
    pub sensed: bool,
}

/// What a branch earns and costs with all it bears.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Branch {
    /// Income of all leaves borne.
    pub income: f64,
    /// Upkeep of all organs borne.
    pub upkeep: f64,
    /// Organs borne, itself included.
    pub organs: u32,
    /// Internodes borne, itself included.
    pub internodes: u32,
    /// Leaves that have not looked around yet.
    pub unsensed: u32,
}

/// Sums every organ with all it bears, tips to base in one pass.
pub fn branches(accounts: &[Account]) -> Vec<Branch> {
    let mut sums = vec![Branch::default(); accounts.len()];
    for i in (0..accounts.len()).rev() {
        let account = &accounts[i];
        let here = &mut sums[i];
        here.income += f64::from(account.income);
        here.upkeep += f64::from(account.upkeep);
        here.organs += 1;
        here.internodes += u32::from(account.kind == OrganKind::Internode);
        here.unsensed += u32::from(account.kind == OrganKind::Leaf && !account.sensed);
        let here = *here;
        if account.parent != NO_PARENT {
            let below = &mut sums[account.parent as usize];
            below.income += here.income;
            below.upkeep += here.upkeep;
            below.organs += here.organs;
            below.internodes += here.internodes;
            below.unsensed += here.unsensed;
        }
    }
    sums
}

/// An organ and all it grows from, down to the base of its plant.
fn down_from(accounts: &[Account], organ: usize) -> impl Iterator<Item = usize> {
    core::iter::successors(Some(organ), |&at| match accounts[at].parent {
        NO_PARENT => None,
        parent => Some(parent as usize),
    })
}

/// The liabilities of one plant to shed so that `deficit` is met: lowest income per upkeep first, ties by birth,
/// leaves or whole branches, at most `most` organs. `mine` are the plant's organs, rising.
pub fn to_shed(accounts: &[Account], sums: &[Branch], mine: &[usize], deficit: f64, most: u32) -> Vec<usize> {
    let mut candidates: Vec<(f64, usize)> = mine
        .iter()
        .copied()
        .filter(|&i| accounts[i].kind == OrganKind::Leaf || accounts[i].begins_axis)
        .filter(|&i| sums[i].unsensed == 0 && sums[i].upkeep > 0.0 && sums[i].income < sums[i].upkeep)
        .map(|i| (sums[i].income / sums[i].upkeep, i))
        .collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut gone = HashSet::new();
    let mut shed = Vec::new();
    let (mut freed, mut count) = (0.0, 0);
    for (_, i) in candidates {
        if freed >= deficit {
            break;
        }
        if down_from(accounts, i).any(|at| gone.contains(&at)) || count + sums[i].organs > most {
            continue;
        }
        gone.insert(i);
        shed.push(i);
        freed += sums[i].upkeep - sums[i].income;
        count += sums[i].organs;
    }
    shed
}

/// Most of its income that a plant gives up with poor side axes in one step: when all its crown is poor it thins,
/// the poorest first, and what stays has more light.
pub const MOST_GIVEN_UP: f64 = 0.25;

/// Which of a plant's poor side axes go in this step: the poorest first, ties by birth, as long as all that goes earns
/// no more than [`MOST_GIVEN_UP`] of `income`. An axis on one that goes is not named, and counts once.
pub fn given_up(accounts: &[Account], sums: &[Branch], mut poor: Vec<usize>, income: f64) -> Vec<usize> {
    let each = |i: usize| sums[i].income / f64::from(sums[i].internodes.max(1));
    poor.sort_by(|&a, &b| each(a).total_cmp(&each(b)).then(a.cmp(&b)));
    let mut left = MOST_GIVEN_UP * income;
    let mut gone = HashSet::new();
    // Of what limbs earn, what has gone with axes on them.
    let mut lost: HashMap<usize, f64> = HashMap::new();
    poor.retain(|&i| {
        let earns = sums[i].income - lost.get(&i).copied().unwrap_or_default();
        if earns > left || down_from(accounts, i).any(|at| gone.contains(&at)) {
            return false;
        }
        left -= earns;
        gone.insert(i);
        down_from(accounts, i).for_each(|at| *lost.entry(at).or_default() += earns);
        true
    });
    poor
}

/// Condemns liabilities while upkeep is unpaid, side axes that have been poor for too long, and buds out of
/// patience.
#[allow(clippy::type_complexity, clippy::too_many_arguments, reason = "a system names what it reads")]
pub fn shed_liabilities(
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    roster: Res<Roster>,
    mut condemned: ResMut<Condemned>,
    plants: Query<(&Plant, &EnergyLedger)>,
    organs: Query<(&EnergyFlow, &BranchOrder, Option<&Exposure>)>,
    buds: Query<&ApicalBud>,
    mut stems: Query<(&GrowthSpan, &mut Internode)>,
) {
    if !mechanisms.energy {
        return;
    }
    let mut accounts: Vec<Account> = Vec::with_capacity(roster.len());
    let mut orders: Vec<u32> = Vec::with_capacity(roster.len());
    for i in 0..roster.len() {
        let (parent, kind) = (roster.parent[i], roster.kind[i]);
        let (flow, order, exposure) = match organs.get(roster.entity[i]) {
            Ok((flow, order, exposure)) => (*flow, order.0, exposure),
            Err(_) => (EnergyFlow::default(), 0, None),
        };
        // The shoots of a fork go on as their parent's axis and are no side axes.
        let begins_axis =
            kind == OrganKind::Internode && parent != NO_PARENT && order > orders[parent as usize];
        let sensed = exposure.is_none_or(|exposure| exposure.sensed);
        orders.push(order);
        accounts.push(Account {
            parent,
            kind,
            begins_axis,
            income: flow.income,
            upkeep: flow.upkeep,
            sensed,
        });
    }
    let sums = branches(&accounts);
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); roster.plants.len()];
    for (i, &plant) in roster.plant.iter().enumerate() {
        members[plant as usize].push(i);
    }
    for (plant, entity) in roster.plants.iter().enumerate() {
        let Some(Ok((Plant { species, .. }, ledger))) = entity.map(|e| plants.get(e)) else { continue };
        let mine = &members[plant];
        if ledger.unpaid > 0.0 {
            let most = (species.shed_share * mine.len() as f32).ceil() as u32;
            for i in to_shed(&accounts, &sums, mine, ledger.unpaid, most) {
                condemned.0.push((roster.birth[i], Cause::Liability));
            }
        }
        if species.prune_patience > 0 {
            let mut out_of_patience = Vec::new();
            for &i in mine.iter().filter(|&&i| accounts[i].begins_axis) {
                let Ok((span, mut base)) = stems.get_mut(roster.entity[i]) else { continue };
                let young = step.0 - span.born() < 2;
                let poor = sums[i].income < f64::from(species.prune_income) * f64::from(sums[i].internodes);
                base.poor_steps = if poor && !young { base.poor_steps + 1 } else { 0 };
                if base.poor_steps > species.prune_patience {
                    out_of_patience.push(i);
                }
            }
            for i in given_up(&accounts, &sums, out_of_patience, ledger.income) {
                condemned.0.push((roster.birth[i], Cause::SelfPruned));
            }
        }
        if species.patience_steps > 0 {
            for &i in mine.iter().filter(|&&i| roster.kind[i] == OrganKind::ApicalBud) {
                if buds.get(roster.entity[i]).is_ok_and(|bud| bud.starved > species.patience_steps) {
                    condemned.0.push((roster.birth[i], Cause::Starved));
                }
            }
        }
    }
}
