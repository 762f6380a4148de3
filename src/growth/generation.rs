//! What opens and closes the generation of organs: books, seeds, shedding, poses.

use core::f32::consts::TAU;

use bevy::prelude::*;

use super::{Mechanisms, StepCount};
use crate::chance::{self, Purpose};
use crate::environment::workers::Workers;
use crate::plant::{
    Allotment, ApicalBud, Attachment, BranchOrder, Cause, EnergyFlow, EnergyLedger, EnergyStore, Exposure,
    GrowsFrom, GrowthSpan, GrowthTarget, Identity, Internode, Lineage, NO_PARENT, OrganKind, OrganShed,
    Plant, Pose, Roster, plant_transform, pose, shed, shed_missing,
};
use crate::tropism::Steering;

/// A lateral bud broke: its axis begins to grow (`LK-7`).
#[derive(Message, Debug, Clone, Copy, Reflect)]
pub struct BudBroke {
    /// The lateral bud.
    pub bud: Entity,
    /// The apical bud of the new axis.
    pub axis: Entity,
}

/// Organs to be shed, with what they bear, at the end of the stage, by birth number.
#[derive(Resource, Debug, Default, Reflect)]
#[reflect(Resource, Default)]
pub struct Condemned(pub Vec<(u32, Cause)>);

/// Sheds what the stage condemned.
pub fn shed_condemned(world: &mut World) {
    let condemned = std::mem::take(&mut world.resource_mut::<Condemned>().0);
    shed(world, &condemned);
}

/// Begins the step: sheds what was despawned from outside, carries the books forward, and drops the messages of
/// the step before last (a host without a frame loop has nobody else to do it).
pub fn open_books(world: &mut World) {
    world.resource_mut::<Messages<OrganShed>>().update();
    world.resource_mut::<Messages<BudBroke>>().update();
    shed_missing(world);
    let plants: Vec<Entity> = world.resource::<Roster>().plants.iter().flatten().copied().collect();
    for plant in plants {
        if let Some(mut ledger) = world.get_mut::<EnergyLedger>(plant) {
            *ledger = EnergyLedger { opened: ledger.closed, ..Default::default() };
        }
    }
    world.resource_mut::<super::StageTimes>().start();
}

/// Whether a seed opened in this step.
pub fn any_germinated(step: Res<StepCount>, stores: Query<&EnergyStore>) -> bool {
    stores.iter().any(|s| s.germinated == Some(step.0))
}

/// Opens new seeds (`LK-9`): each puts up its first bud, fed from the seed.
pub fn germinate(world: &mut World) {
    let step = world.resource::<StepCount>().0;
    let energy = world.resource::<Mechanisms>().energy;
    let plants: Vec<Option<Entity>> = world.resource::<Roster>().plants.clone();
    for (index, plant) in plants.into_iter().enumerate() {
        let Some(plant) = plant else { continue };
        let Some(seed) = world.get::<Plant>(plant).cloned() else { continue };
        if world.get::<EnergyStore>(plant).is_none_or(|s| s.germinated.is_some()) {
            continue;
        }
        let species = &seed.species;
        let fed = first_shoot_cost(species).min(species.seed_energy);
        if let Some(mut store) = world.get_mut::<EnergyStore>(plant) {
            store.germinated = Some(step);
            store.stored = if energy { f64::from(species.seed_energy) - f64::from(fed) } else { 0.0 };
        }
        if let Some(mut ledger) = world.get_mut::<EnergyLedger>(plant)
            && energy
        {
            ledger.opened = f64::from(species.seed_energy);
        }
        let transform = plant_transform(world, plant);
        let pose = Pose { position: transform.translation, rotation: transform.rotation };
        let entity = world
            .spawn((
                GrowsFrom(plant),
                GrowthSpan::step(step),
                BranchOrder(0),
                Attachment(Quat::IDENTITY),
                pose,
                EnergyFlow::default(),
                // Which way round a seedling grows is chance.
                ApicalBud {
                    phyllotaxis: TAU
                        * chance::unit(&mut chance::stream(seed.seed, Lineage::SEED, 0, Purpose::Divergence)),
                    ..Default::default()
                },
                Steering::default(),
                GrowthTarget { heading: pose.heading(), fitness: 0.0 },
                Exposure { light: 1.0, space: 1.0, sensed: false },
                Allotment(if energy { fed } else { 0.0 }),
            ))
            .id();
        let birth =
            world.resource_mut::<Roster>().bear(entity, NO_PARENT, index as u32, OrganKind::ApicalBud);
        world.entity_mut(entity).insert(Identity { plant, birth, lineage: Lineage::SEED });
    }
}

pub(super) fn first_shoot_cost(species: &crate::species::Species) -> f32 {
    match species.allocation {
        crate::species::Allocation::ByExposure => species.extension_m * species.shoot_cost,
        crate::species::Allocation::ByVigour => {
            super::vigour::internode_cost(species) * species.seedling_internodes.max(1.0).floor()
        }
    }
}

/// Derives the pose of every organ from the turns of those below it.
pub fn derive_poses(
    roster: Res<Roster>,
    transforms: Query<(Option<&Transform>, Option<&ChildOf>)>,
    mut organs: Query<(&Attachment, Option<&Internode>, &mut Pose)>,
) {
    let stands = |plant: Entity| {
        let at = pose::standing(plant, |it| transforms.get(it).ok());
        Pose { position: at.translation, rotation: at.rotation }
    };
    let roots: Vec<Pose> = roster.plants.iter().map(|plant| plant.map(stands).unwrap_or_default()).collect();
    let mut stems: Vec<pose::Stem> = Vec::with_capacity(roster.len());
    for i in 0..roster.len() {
        let sits_on_bark = matches!(roster.kind[i], OrganKind::Leaf | OrganKind::LateralBud);
        let below = match roster.parent[i] {
            NO_PARENT => pose::Stem { pose: roots[roster.plant[i] as usize], ..Default::default() },
            parent => stems[parent as usize],
        };
        let Ok((attachment, internode, mut pose)) = organs.get_mut(roster.entity[i]) else {
            stems.push(below);
            continue;
        };
        *pose = below.bear(attachment.0, sits_on_bark);
        let (length, radius) = internode.map_or((0.0, 0.0), |wood| (wood.length, wood.radius));
        stems.push(pose::Stem { pose: *pose, length, radius });
    }
}

/// The environment plugin's worker threads, made if the host made none.
pub(crate) fn ensure_workers(world: &mut World) {
    if !world.contains_resource::<Workers>() {
        world.init_resource::<Workers>();
    }
}
