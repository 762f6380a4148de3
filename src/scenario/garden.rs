//! A garden: a scenario growing step by step, headless.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::place::{self, RunSeed, SpeciesBook};
use super::{Edit, EditError, Scenario, apply};
use crate::BurgeonPlugins;
use crate::environment::workers::Workers;
use crate::environment::{Ground, Lamp, Scene, Sky, Solid, Sun, whole_scene};
use crate::files::ResolvedScenario;
use crate::growth::{Mechanisms, StepCount, finish::StageTimes, grow, sensing::ProbeCount};
use crate::limits::{self, GrowthLimits};
use crate::plant::measure::{StageSeconds, StepRecord};
use crate::plant::{Fallen, Roster, Snapshot, plants, restore};
use crate::species::Species;

/// A scenario with its species, growing.
pub struct Garden {
    world: World,
    scenario: Scenario,
    seed: u64,
    records: Vec<StepRecord>,
    /// Edits of the scenario already made.
    edits_made: usize,
}

/// Why a garden stopped growing; what has grown is kept.
#[derive(Debug, thiserror::Error)]
pub enum GardenError {
    /// An edit of the scenario could not be made.
    #[error("the edit at step {step} could not be made: {source}")]
    Edit {
        /// Its step.
        step: u32,
        /// Why.
        source: EditError,
    },
    /// A limit was reached.
    #[error("stopped at step {step}: {reached} {what} reach the limit of {limit}")]
    Limit {
        /// Steps grown.
        step: u32,
        /// What there is too much of.
        what: &'static str,
        /// How much there is.
        reached: usize,
        /// How much there may be.
        limit: usize,
    },
}

/// Everything a garden is, to be saved and grown on bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GardenSave {
    scenario: Scenario,
    seed: u64,
    edits_made: usize,
    species: BTreeMap<String, Arc<Species>>,
    snapshot: Snapshot,
    solids: Vec<Standing<Solid>>,
    lamps: Vec<Standing<Lamp>>,
    sun: Option<(Quat, f32)>,
    sky: Sky,
    mechanisms: Mechanisms,
    fallen: u64,
    records: Vec<StepRecord>,
}

impl Garden {
    /// Sets out a scenario with its species.
    ///
    /// # Errors
    /// The first planting, solid or lamp that cannot be placed.
    pub fn new(resolved: ResolvedScenario, seed: u64, workers: Workers) -> Result<Self, EditError> {
        let ResolvedScenario { scenario, species } = resolved;
        let species = species.into_iter().map(|(name, species)| (name, Arc::new(species))).collect();
        let mut world = bare_world(workers);
        world.insert_resource(SpeciesBook(species));
        world.insert_resource(RunSeed(seed));
        world.insert_resource(scenario.sky);
        world.insert_resource(Ground(scenario.ground.then_some(0.0)));
        world.insert_resource(scenario.mechanisms);
        world.insert_resource(scenario.sensing);
        place::set_sun(&mut world, scenario.sun);
        for solid in &scenario.solids {
            apply(&mut world, &Edit::PlaceSolid(solid.clone()))?;
        }
        for lamp in &scenario.lamps {
            apply(&mut world, &Edit::PlaceLamp(lamp.clone()))?;
        }
        for planting in &scenario.plants {
            apply(&mut world, &Edit::Plant(planting.clone()))?;
        }
        Ok(Self { world, scenario, seed, records: Vec::new(), edits_made: 0 })
    }

    /// Makes the edits due, then grows one step.
    ///
    /// # Errors
    /// An edit that cannot be made, or a limit; what has grown is kept.
    pub fn step(&mut self) -> Result<&StepRecord, GardenError> {
        let step = self.steps();
        while let Some(timed) = self.scenario.edits.get(self.edits_made).filter(|e| e.step <= step) {
            let edit = timed.edit.clone();
            self.edits_made += 1;
            apply(&mut self.world, &edit).map_err(|source| GardenError::Edit { step, source })?;
        }
        self.within_limits(step)?;
        grow(&mut self.world, 1);
        let snapshot = self.snapshot();
        let [generate, update, sense, finish] = self.world.resource::<StageTimes>().seconds;
        let stages = StageSeconds { generate, update, sense, finish };
        self.records.push(StepRecord::of(&snapshot, stages));
        Ok(&self.records[self.records.len() - 1])
    }

    fn within_limits(&self, step: u32) -> Result<(), GardenError> {
        let most = *self.world.resource::<GrowthLimits>();
        let probes = self.world.resource::<ProbeCount>().0;
        let taken = [
            ("organs", self.organs(), most.organs),
            ("probes in one step", probes, most.probes),
            ("steps", step as usize, most.steps),
            ("bytes of memory", self.organs() * limits::ORGAN_BYTES, most.memory),
        ];
        match taken.into_iter().find(|(_, reached, limit)| reached >= limit) {
            Some((what, reached, limit)) => Err(GardenError::Limit { step, what, reached, limit }),
            None => Ok(()),
        }
    }

    /// Sets what it may take.
    pub fn set_limits(&mut self, limits: GrowthLimits) {
        self.world.insert_resource(limits);
    }

    /// Steps grown.
    pub fn steps(&self) -> u32 {
        self.world.resource::<StepCount>().0
    }

    /// Organs alive.
    pub fn organs(&self) -> usize {
        self.world.resource::<Roster>().len()
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The seed of the run.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// A record for each step grown.
    pub fn records(&self) -> &[StepRecord] {
        &self.records
    }

    /// The plants as they stand.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot::take(&self.world)
    }

    /// Everything that can be seen.
    pub fn scene(&mut self) -> Scene {
        whole_scene(&mut self.world)
    }

    /// The world it grows in.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The world it grows in, to be looked at or changed by the same means as in a game.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Everything it is.
    pub fn save(&mut self) -> GardenSave {
        let world = &mut self.world;
        let solids = named_things::<Solid>(world);
        let lamps = named_things::<Lamp>(world);
        let mut suns = world.query::<(&Sun, &Transform)>();
        let sun = suns.iter(world).map(|(sun, transform)| (transform.rotation, sun.strength)).next();
        GardenSave {
            scenario: self.scenario.clone(),
            seed: self.seed,
            edits_made: self.edits_made,
            species: world.resource::<SpeciesBook>().0.clone(),
            snapshot: Snapshot::take(world),
            solids,
            lamps,
            sun,
            sky: *world.resource::<Sky>(),
            mechanisms: *world.resource::<Mechanisms>(),
            fallen: world.resource::<Fallen>().total,
            records: self.records.clone(),
        }
    }

    /// Grows on from a save.
    pub fn resume(save: GardenSave, workers: Workers) -> Self {
        let mut world = bare_world(workers);
        world.insert_resource(SpeciesBook(save.species));
        world.insert_resource(RunSeed(save.seed));
        world.insert_resource(save.sky);
        world.insert_resource(Ground(save.scenario.ground.then_some(0.0)));
        world.insert_resource(save.mechanisms);
        world.insert_resource(save.scenario.sensing);
        world.insert_resource(Fallen { total: save.fallen, ..Default::default() });
        for solid in save.solids {
            world.spawn(solid.stand());
        }
        for lamp in save.lamps {
            world.spawn(lamp.stand());
        }
        if let Some((rotation, strength)) = save.sun {
            world.spawn((Sun { strength }, Transform::from_rotation(rotation)));
        }
        restore(&mut world, &save.snapshot);
        Self {
            world,
            scenario: save.scenario,
            seed: save.seed,
            records: save.records,
            edits_made: save.edits_made,
        }
    }

    /// Species of its plants, in the order of planting.
    pub fn species(&self) -> Vec<Arc<Species>> {
        plants(&self.world).into_iter().map(|(_, plant)| plant.species.clone()).collect()
    }
}

/// A solid or lamp with its name and exact place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Standing<T> {
    name: String,
    thing: T,
    position: Vec3,
    rotation: Quat,
    scale: Vec3,
}

impl<T: Component> Standing<T> {
    fn stand(self) -> impl Bundle {
        let transform = Transform { translation: self.position, rotation: self.rotation, scale: self.scale };
        (Name::new(self.name), self.thing, transform)
    }
}

fn named_things<T: Component + Copy>(world: &mut World) -> Vec<Standing<T>> {
    let mut things = world.query::<(&Name, &T, &Transform)>();
    let mut standing: Vec<Standing<T>> = things
        .iter(world)
        .map(|(name, thing, transform)| Standing {
            name: name.to_string(),
            thing: *thing,
            position: transform.translation,
            rotation: transform.rotation,
            scale: transform.scale,
        })
        .collect();
    standing.sort_by(|a, b| a.name.cmp(&b.name));
    standing
}

/// A world with Burgeon in it and nothing else.
fn bare_world(workers: Workers) -> World {
    let mut app = App::new();
    app.insert_resource(workers).add_plugins(BurgeonPlugins);
    app.finish();
    app.cleanup();
    std::mem::take(app.world_mut())
}
