//! Sprouting: buds from old wood, when a plant has put by more than its living buds could take.
//!
//! Cut back, broken or sheared, a plant keeps roots and stores for more crown than it has left; what its buds cannot
//! take wakes new ones on bare nodes (epicormic shoots; Meier, Saunders & Michler 2012, "Epicormic buds in trees: a
//! review of bud establishment, development and dormancy release").

use core::f32::consts::TAU;

use bevy::prelude::*;

use super::birth::Newborn;
use super::nodes::leaving;
use super::vigour::internode_cost;
use super::{Mechanisms, StepCount};
use crate::chance::{self, Purpose};
use crate::plant::{
    Allotment, BranchOrder, EnergyLedger, EnergyStore, Exposure, GrowthSpan, GrowthTarget, Identity,
    Internode, LateralBud, LateralBudState, Lineage, NO_PARENT, Node, OrganKind, Plant, Pose, Roster, pose,
};
use crate::species::Species;

/// Most new buds for an expected number: chance may not run away with it.
pub fn at_most(expected: f64) -> usize {
    if expected > 0.0 { (2.0 * expected) as usize + 8 } else { 0 }
}

/// New buds that energy left over pays the first shoots of: what is put by beyond what the living buds hold, by the
/// species' readiness.
pub fn sprouts(species: &Species, stored: f64, held: f64) -> f64 {
    let shoot = f64::from(internode_cost(species) * species.flush_internodes.get(0).max(1.0));
    (f64::from(species.sprouting) * (stored - held) / shoot).max(0.0)
}

/// Which stem segments are bare: those with a node that bear nothing alive but the axis they are part of. A spent
/// lateral bud counts as nothing. Columns by organ.
pub fn bare_nodes(parents: &[u32], orders: &[u32], living: &[Living]) -> Vec<bool> {
    let mut bare: Vec<bool> = living.iter().map(|l| *l == Living::Node).collect();
    for i in 0..parents.len() {
        let Some(parent) = (parents[i] != NO_PARENT).then_some(parents[i] as usize) else { continue };
        let same_axis = matches!(living[i], Living::Node | Living::Stem) && orders[i] == orders[parent];
        if living[i] != Living::Spent && !same_axis {
            bare[parent] = false;
        }
    }
    bare
}

/// What an organ is to [`bare_nodes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Living {
    /// A stem segment that ends in a node.
    Node,
    /// One that does not.
    Stem,
    /// A leaf, or a bud that can grow.
    Active,
    /// A lateral bud that has broken or died.
    Spent,
}

/// Opens buds on bare nodes of plants with energy left over.
#[allow(clippy::type_complexity, clippy::too_many_arguments, reason = "a system names what it reads")]
pub fn sprout(
    mut commands: Commands,
    mut roster: ResMut<Roster>,
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    plants: Query<(&Plant, &EnergyStore, &EnergyLedger)>,
    organs: Query<(&BranchOrder, Has<Node>, Option<&LateralBud>)>,
    stems: Query<(&Identity, &Pose, &Internode)>,
) {
    if !mechanisms.energy {
        return;
    }
    // Plants with energy left over, and how many buds it opens.
    let ready: Vec<Option<(&Plant, f64)>> = roster
        .plants
        .iter()
        .map(|plant| {
            let (plant, store, ledger) = plants.get((*plant)?).ok()?;
            if plant.species.rests(store.age(step.0)) {
                return None;
            }
            let expected = sprouts(&plant.species, store.stored, ledger.opened - store.stored);
            (expected > 0.0).then_some((plant, expected))
        })
        .collect();
    if ready.iter().all(Option::is_none) {
        return;
    }
    let living = roster.len();
    let mut orders = vec![0_u32; living];
    let mut state = vec![Living::Active; living];
    for i in 0..living {
        let Ok((order, node, bud)) = organs.get(roster.entity[i]) else { continue };
        orders[i] = order.0;
        state[i] = match roster.kind[i] {
            OrganKind::Internode if node => Living::Node,
            OrganKind::Internode => Living::Stem,
            OrganKind::LateralBud if bud.is_some_and(|bud| bud.state != LateralBudState::Dormant) => {
                Living::Spent
            }
            _ => Living::Active,
        };
    }
    let mut bare = bare_nodes(&roster.parent, &orders, &state);
    let mut nodes = vec![0_u32; roster.plants.len()];
    for i in 0..living {
        let plant = roster.plant[i] as usize;
        bare[i] &= ready[plant].is_some_and(|(plant, _)| orders[i] < plant.species.max_order);
        nodes[plant] += u32::from(bare[i]);
    }
    let mut left: Vec<usize> =
        ready.iter().map(|plant| plant.map_or(0, |(_, expected)| at_most(expected))).collect();
    for i in (0..living).filter(|&i| bare[i]) {
        let mine = roster.plant[i] as usize;
        let Some((plant, expected)) = ready[mine] else { continue };
        let Ok((identity, place, wood)) = stems.get(roster.entity[i]) else { continue };
        let mut rng = chance::stream(plant.seed, identity.lineage, step.0, Purpose::Sprouting);
        // As likely on each bare node, so that no node's draw depends on another's.
        let likely = expected / f64::from(nodes[mine]);
        if left[mine] == 0 || f64::from(chance::unit(&mut rng)) >= likely {
            continue;
        }
        left[mine] -= 1;
        let species = &plant.species;
        let attachment = leaving(TAU * chance::unit(&mut rng), species.branching_angle(orders[i]));
        let stem = pose::Stem { pose: *place, length: wood.length, radius: wood.radius };
        let newborn = Newborn {
            plant: identity.plant,
            plant_index: mine as u32,
            from: roster.entity[i],
            parent: i as u32,
            lineage: sprout_lineage(identity.lineage, step.0),
            order: orders[i] + 1,
            attachment,
            pose: stem.bear(attachment, true),
            span: GrowthSpan::step(step.0),
        };
        let bud = LateralBud { rank: species.favoured_rank, ..default() };
        let unseen = Exposure { light: 1.0, space: 1.0, sensed: false };
        let state = (bud, GrowthTarget::default(), unseen, Allotment(0.0));
        newborn.bear(&mut commands, &mut roster, OrganKind::LateralBud, state);
    }
}

/// Lineage of a bud that opens on a stem segment's bare node.
fn sprout_lineage(stem: Lineage, step: u32) -> Lineage {
    stem.child(3_000_000_000_u32.wrapping_add(step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_living_buds_cannot_take_wakes_new_ones() {
        let species = Species { sprouting: 0.5, ..Species::default() };
        assert_eq!(sprouts(&species, 10.0, 10.0), 0.0);
        assert_eq!(sprouts(&species, 5.0, 10.0), 0.0);
        let shoot = f64::from(internode_cost(&species)) * 4.0;
        assert!((sprouts(&species, 10.0 + 6.0 * shoot, 10.0) - 3.0).abs() < 1e-6);
        assert_eq!(sprouts(&Species { sprouting: 0.0, ..species }, 1e6, 0.0), 0.0, "conifers do not");
    }

    #[test]
    fn a_node_is_bare_without_leaf_bud_and_side_axis() {
        use Living::{Active, Node, Spent, Stem};
        let organs = [
            (NO_PARENT, 0, Node), // bears the stem and a spent bud: bare
            (0, 0, Node),         // bears a leaf
            (0, 1, Spent),
            (1, 0, Active),
            (1, 0, Node), // bears a side axis
            (4, 1, Stem),
            (4, 0, Stem), // no node
            (6, 0, Node), // its end was cut: bare
        ];
        let parents = organs.map(|o| o.0);
        let bare = bare_nodes(&parents, &organs.map(|o| o.1), &organs.map(|o| o.2));
        assert_eq!(bare, [true, false, false, false, false, false, false, true]);
    }
}
