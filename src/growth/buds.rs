//! Fate of lateral buds: dormancy, breaking, death (`LK-6`, `LK-7`).

use bevy::prelude::*;

use super::birth::Newborn;
use super::generation::{BudBroke, Condemned};
use super::{Mechanisms, StepCount};
use crate::plant::{
    Allotment, ApicalBud, Attachment, BranchOrder, Cause, EnergyStore, Exposure, GrowsFrom, GrowthSpan,
    GrowthTarget, Identity, Internode, LateralBud, LateralBudState, OrganKind, Plant, Pose, Roster,
};
use crate::species::Species;
use crate::tropism::Steering;

/// What a lateral bud does in a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BudFate {
    /// Sleeps on.
    Sleep,
    /// Breaks.
    Break,
    /// Dies.
    Die,
}

/// One step of a dormant lateral bud: dormancy counts down only in enough light and energy; at its end, and
/// with energy to grow, the bud breaks; without, it waits as long as its species' patience.
pub fn tick(bud: &mut LateralBud, light: f32, energy: f32, species: &Species) -> BudFate {
    let thrives = light >= species.dormancy_light && energy >= species.dormancy_energy && energy > 0.0;
    if thrives {
        bud.starved = 0;
        if bud.dormancy == 0 {
            return BudFate::Break;
        }
        bud.dormancy -= 1;
        return BudFate::Sleep;
    }
    if light >= species.dormancy_light && bud.dormancy > 0 && species.dormancy_energy == 0.0 {
        bud.dormancy -= 1;
    }
    bud.starved += 1;
    if species.patience_steps > 0 && bud.starved > species.patience_steps {
        BudFate::Die
    } else {
        BudFate::Sleep
    }
}

/// Rule 3 (B -> B A): wakes lateral buds whose dormancy has run out.
#[allow(clippy::type_complexity, reason = "a query names its parts")]
pub fn wake_lateral_buds(
    mut commands: Commands,
    mut roster: ResMut<Roster>,
    mut condemned: ResMut<Condemned>,
    mut broke: MessageWriter<BudBroke>,
    step: Res<StepCount>,
    mechanisms: Res<Mechanisms>,
    plants: Query<(&Plant, &EnergyStore)>,
    stems: Query<(&Pose, &Internode)>,
    mut buds: Query<(
        &Identity,
        &GrowsFrom,
        &BranchOrder,
        &Attachment,
        &Pose,
        &Exposure,
        &GrowthTarget,
        &mut Allotment,
        &mut LateralBud,
    )>,
) {
    let living = roster.len();
    for i in 0..living {
        if roster.kind[i] != OrganKind::LateralBud {
            continue;
        }
        let bud_entity = roster.entity[i];
        let Ok((identity, from, order, attachment, pose, exposure, target, mut allotment, mut bud)) =
            buds.get_mut(bud_entity)
        else {
            continue;
        };
        let Ok((plant, store)) = plants.get(identity.plant) else { continue };
        if bud.state != LateralBudState::Dormant || plant.species.rests(store.age(step.0)) {
            continue;
        }
        let light = if mechanisms.light { exposure.light } else { 1.0 };
        let energy = if mechanisms.energy { allotment.0 } else { f32::MAX };
        match tick(&mut bud, light, energy, &plant.species) {
            BudFate::Sleep => {}
            BudFate::Die => {
                bud.state = LateralBudState::Dead;
                condemned.0.push((identity.birth, Cause::Starved));
            }
            BudFate::Break => {
                bud.state = LateralBudState::Growing;
                let heading = if target.heading == Vec3::ZERO { pose.heading() } else { target.heading };
                let parent = roster.parent[i];
                // The bud sits on the bark, its axis begins at the centre of the stem.
                let base = stems.get(from.0).map_or(pose.position, |(stem, wood)| stem.tip(wood.length));
                let newborn = Newborn {
                    plant: identity.plant,
                    plant_index: roster.plant[i],
                    from: from.0,
                    parent,
                    lineage: identity.lineage.child(0),
                    order: order.0,
                    attachment: attachment.0,
                    pose: Pose { position: base, rotation: pose.rotation },
                    span: GrowthSpan::step(step.0),
                };
                let target = GrowthTarget { heading, fitness: target.fitness };
                let state = (ApicalBud::default(), Steering::default(), target, *exposure, *allotment);
                let axis = newborn.bear(&mut commands, &mut roster, OrganKind::ApicalBud, state);
                allotment.0 = 0.0;
                broke.write(BudBroke { bud: bud_entity, axis });
            }
        }
    }
}
