//! Plants and whole scenarios that stand in an app's world as their assets say, and follow them when they change.

use std::sync::Arc;

use bevy::ecs::relationship::Relationship;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;

use super::loaders::{ScenarioLoader, SpeciesLoader};
use crate::files::ResolvedScenario;
use crate::growth::{GrowthStep, Stage};
use crate::plant::Plant;
use crate::scenario::{Planting, Scenario, crush, place};
use crate::species::Species;

/// Makes [`Species`] and [`ResolvedScenario`]s assets, and has [`SpeciesRoot`] and [`ScenarioRoot`] follow them.
///
/// Needs [`BurgeonPlugins`](crate::BurgeonPlugins) and Bevy's `AssetPlugin`. With feature `hot_reload` a file that
/// changes on disk is read again; a bad one changes nothing, and its error is logged with file, line, field, value and
/// what is allowed.
pub struct PlantAssetPlugin;

impl Plugin for PlantAssetPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Species>()
            .init_asset::<ResolvedScenario>()
            .init_asset_loader::<SpeciesLoader>()
            .init_asset_loader::<ScenarioLoader>()
            .register_type::<SpeciesRoot>()
            .register_type::<ScenarioRoot>()
            .register_type::<SetOut>()
            .register_type::<SetOutBy>()
            .register_type::<NextSpecies>()
            .register_type::<Part>()
            .add_systems(Update, (follow_species, follow_scenarios));
    }

    fn finish(&self, app: &mut App) {
        // Only now is the schedule surely there, whatever the order of plugins.
        app.add_systems(GrowthStep, change_species.before(Stage::Germinate));
    }
}

/// A plant whose species is an asset. It becomes a [`Plant`] as soon as that is loaded, and follows each change of it
/// from the next growth step on.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component)]
#[require(Transform)]
pub struct SpeciesRoot {
    /// The species.
    pub species: Handle<Species>,
    /// Seed of every random draw the plant makes.
    pub seed: u64,
}

/// What a plant's species becomes with the next growth step. What has grown stays.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component)]
pub struct NextSpecies(pub Arc<Species>);

/// A scenario that stands in the world: its plants, solids, lamps and sun, sky, ground and settings. Its edits are not
/// made; a [`Garden`](crate::scenario::Garden) does that.
///
/// When the asset changes, what is the same in both stays as it stands, what is new comes, what is gone goes with all
/// that grew there, and plants whose species changed grow on as changed. Despawning it takes along all that
/// stands; sky, ground and settings stay.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component)]
pub struct ScenarioRoot {
    /// The scenario.
    pub scenario: Handle<ResolvedScenario>,
    /// The seed of the run, to which each planting adds its own.
    pub seed: u64,
}

/// What a [`ScenarioRoot`] set into the world.
#[derive(Component, Debug, Default, Reflect)]
#[reflect(Component)]
#[relationship_target(relationship = SetOutBy, linked_spawn)]
pub struct SetOut(Vec<Entity>);

/// The [`ScenarioRoot`] that set this into the world.
#[derive(Component, Debug, Clone, Reflect)]
#[reflect(Component)]
#[relationship(relationship_target = SetOut)]
pub struct SetOutBy(pub Entity);

/// What of a scenario an entity is, to be found again when that changes.
#[derive(Component, Debug, Clone, PartialEq, Reflect)]
#[reflect(Component)]
enum Part {
    Plant(Planting),
    Solid(crate::scenario::PlacedSolid),
    Lamp(crate::scenario::PlacedLamp),
    Sun(crate::scenario::PlacedSun),
}

/// Which of these assets have come or changed.
fn changed<'a, A: Asset>(events: impl Iterator<Item = &'a AssetEvent<A>>) -> HashSet<AssetId<A>> {
    let changed = events.filter_map(|event| match event {
        AssetEvent::Added { id } | AssetEvent::Modified { id } => Some(*id),
        _ => None,
    });
    changed.collect()
}

/// Plants whose species has come or changed take it up.
fn follow_species(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<Species>>,
    assets: Res<Assets<Species>>,
    plants: Query<(Entity, Ref<SpeciesRoot>, Option<&Plant>)>,
) {
    let changed = changed(events.read());
    // Plants of one kind share it.
    let mut shared: HashMap<AssetId<Species>, Arc<Species>> = HashMap::new();
    for (entity, root, plant) in &plants {
        let id = root.species.id();
        if plant.is_some() && !changed.contains(&id) && !root.is_changed() {
            continue;
        }
        let Some(species) = assets.get(id) else { continue };
        let species = shared.entry(id).or_insert_with(|| Arc::new(species.clone())).clone();
        let mut entity = commands.entity(entity);
        match plant {
            None => entity.insert(Plant { species, seed: root.seed }),
            Some(plant) if plant.species == species => entity.remove::<NextSpecies>(),
            Some(_) => entity.insert(NextSpecies(species)),
        };
    }
}

/// Species that changed since the last step are taken up.
fn change_species(mut commands: Commands, mut plants: Query<(Entity, &mut Plant, &NextSpecies)>) {
    for (entity, mut plant, next) in &mut plants {
        plant.species = next.0.clone();
        commands.entity(entity).remove::<NextSpecies>();
    }
}

/// Scenarios that have come or changed are set out.
fn follow_scenarios(
    world: &mut World,
    roots: &mut QueryState<(Entity, Ref<ScenarioRoot>)>,
    mut reader: Local<bevy::ecs::message::MessageCursor<AssetEvent<ResolvedScenario>>>,
) {
    let changed = changed(reader.read(world.resource::<Messages<AssetEvent<ResolvedScenario>>>()));
    let due: Vec<(Entity, ScenarioRoot)> = roots
        .iter(world)
        .filter(|(_, root)| root.is_changed() || changed.contains(&root.scenario.id()))
        .map(|(entity, root)| (entity, ScenarioRoot::clone(&root)))
        .collect();
    for (entity, root) in due {
        let Some(resolved) = world.resource::<Assets<ResolvedScenario>>().get(&root.scenario) else {
            continue;
        };
        let resolved = resolved.clone();
        set_out(world, entity, &resolved, root.seed);
    }
}

/// Makes the world what a scenario says, with as little change as can be.
fn set_out(world: &mut World, root: Entity, resolved: &ResolvedScenario, seed: u64) {
    let scenario = &resolved.scenario;
    place::set_conditions(world, scenario);
    let mut wanted = parts(scenario);
    let species: HashMap<&str, Arc<Species>> =
        resolved.species.iter().map(|(name, species)| (name.as_str(), Arc::new(species.clone()))).collect();

    let standing: Vec<Entity> = world.get::<SetOut>(root).map(|set| set.0.clone()).unwrap_or_default();
    for entity in standing {
        let there = world.get::<Part>(entity).and_then(|part| wanted.iter().position(|other| other == part));
        let Some(there) = there else {
            world.despawn(entity);
            continue;
        };
        if let Part::Plant(planting) = wanted.swap_remove(there)
            && let Some(species) = species.get(planting.species.as_str())
        {
            let is_same = world.get::<Plant>(entity).is_some_and(|plant| plant.species == *species);
            let mut plant = world.entity_mut(entity);
            if is_same {
                plant.remove::<NextSpecies>();
            } else {
                plant.insert(NextSpecies(species.clone()));
            }
        }
    }
    // What is left is new, in the order of the file.
    for part in parts(scenario) {
        let Some(new) = wanted.iter().position(|other| *other == part) else { continue };
        wanted.swap_remove(new);
        let entity = match &part {
            Part::Plant(planting) => match species.get(planting.species.as_str()) {
                Some(species) => place::sow(world, planting, species.clone(), seed),
                None => continue,
            },
            Part::Solid(solid) => place::set_solid(world, solid),
            Part::Lamp(lamp) => place::set_lamp(world, lamp),
            Part::Sun(sun) => place::raise_sun(world, sun),
        };
        let is_solid = matches!(part, Part::Solid(_));
        world.entity_mut(entity).insert((part, <SetOutBy as Relationship>::from(root)));
        if is_solid {
            crush(world, entity);
        }
    }
}

/// What stands in a scenario.
fn parts(scenario: &Scenario) -> Vec<Part> {
    let mut parts: Vec<Part> = scenario.solids.iter().cloned().map(Part::Solid).collect();
    parts.extend(scenario.lamps.iter().cloned().map(Part::Lamp));
    parts.extend(scenario.sun.map(Part::Sun));
    parts.extend(scenario.plants.iter().cloned().map(Part::Plant));
    parts
}
