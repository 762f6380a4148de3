//! A garden: a scenario growing step by step, headless.

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::place::{self, RunSeed, SpeciesBook};
use super::{Edit, EditError, EditOutcome, FixtureError, Fixtures, Scenario, TimedEdit, apply};
use crate::BurgeonPlugins;
use crate::environment::workers::Workers;
use crate::environment::{Ground, Scene, whole_scene};
use crate::files::{ResolvedScenario, ScenarioError};
use crate::growth::sensing::gather_probes;
use crate::growth::{StepCount, finish::StageTimes, grow};
use crate::limits::{GrowthLimits, LimitReached, limit_reached};
use crate::plant::measure::{StageSeconds, StepRecord};
use crate::plant::{Fallen, Roster, Snapshot, SnapshotError, plants, restore};
use crate::species::Species;
use crate::species::parameter::ParameterError;

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
    #[error(transparent)]
    Limit(#[from] LimitReached),
}

/// Everything a garden is, to be saved and grown on bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GardenSave {
    pub(super) scenario: Scenario,
    pub(super) seed: u64,
    pub(super) edits_made: usize,
    pub(super) species: BTreeMap<String, Arc<Species>>,
    pub(super) snapshot: Snapshot,
    pub(super) fixtures: Fixtures,
    pub(super) fallen: u64,
    pub(super) records: Vec<StepRecord>,
}

/// Why a save cannot be grown on, though its checksum is right.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GardenSaveError {
    /// Its scenario is not sound.
    #[error("its scenario: {0}")]
    Scenario(#[from] ScenarioError),
    /// Its plants are not.
    #[error("its plants: {0}")]
    Snapshot(#[from] SnapshotError),
    /// What stands there cannot.
    #[error("what stands there: {0}")]
    Fixture(#[from] FixtureError),
    /// A species has a parameter out of range.
    #[error("its species {name:?}: {source}")]
    Species {
        /// The species.
        name: String,
        /// Which parameter.
        source: ParameterError,
    },
    /// It claims to have made more edits than its scenario has by its step.
    #[error("{made} edits are said to be made; by step {step} there are {due}")]
    Edits {
        /// Edits said to be made.
        made: usize,
        /// The step.
        step: u32,
        /// Edits of the scenario that are due by then.
        due: usize,
    },
    /// Its run and its garden tell of different trees.
    #[error("its run and its garden differ in {0}")]
    Differ(&'static str),
}

impl GardenSave {
    /// Checks that it is a state a garden can grow on from.
    ///
    /// # Errors
    /// The first thing that is not so.
    pub fn check(&self) -> Result<(), GardenSaveError> {
        self.scenario.validate()?;
        let step = self.snapshot.step;
        let due = self.scenario.edits.iter().take_while(|e| e.step <= step).count();
        if self.edits_made > due {
            return Err(GardenSaveError::Edits { made: self.edits_made, step, due });
        }
        for (name, species) in &self.species {
            species.validate().map_err(|source| GardenSaveError::Species { name: name.clone(), source })?;
        }
        self.fixtures.check()?;
        Ok(self.snapshot.check()?)
    }

    /// Steps grown.
    pub fn steps(&self) -> u32 {
        self.snapshot.step
    }

    /// Its plants.
    pub fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }
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
        place::set_conditions(&mut world, &scenario);
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
        self.step_and_look()?;
        Ok(&self.records[self.records.len() - 1])
    }

    /// As [`Garden::step`]; gives the plants at its end.
    pub(super) fn step_and_look(&mut self) -> Result<Snapshot, GardenError> {
        while let Some(made) = self.make_next_edit() {
            made?;
        }
        if let Some(reached) = limit_reached(&self.world) {
            return Err(reached.into());
        }
        grow(&mut self.world, 1);
        // What an app does in every frame; else what was removed would be remembered for ever.
        self.world.clear_trackers();
        let snapshot = self.snapshot();
        let [generate, update, sense, finish] = self.world.resource::<StageTimes>().seconds;
        let stages = StageSeconds { generate, update, sense, finish };
        self.records.push(StepRecord::of(&snapshot, stages));
        Ok(snapshot)
    }

    /// Makes the next edit that is due, if there is one.
    pub(super) fn make_next_edit(&mut self) -> Option<Result<EditOutcome, GardenError>> {
        let step = self.steps();
        let due = self.scenario.edits.get(self.edits_made).filter(|e| e.step <= step)?;
        self.edits_made += 1;
        Some(apply(&mut self.world, &due.edit).map_err(|source| GardenError::Edit { step, source }))
    }

    /// Edits of the scenario already made.
    pub(super) fn edits_made(&self) -> usize {
        self.edits_made
    }

    /// Replaces the edits; of the new ones, `made` are taken to be made.
    pub(super) fn set_edits(&mut self, edits: Vec<TimedEdit>, made: usize) {
        self.scenario.edits = edits;
        self.edits_made = made;
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
        let fixtures = Fixtures::take(world);
        GardenSave {
            scenario: self.scenario.clone(),
            seed: self.seed,
            edits_made: self.edits_made,
            species: world.resource::<SpeciesBook>().0.clone(),
            snapshot: Snapshot::take(world),
            fixtures,
            fallen: world.resource::<Fallen>().total,
            records: self.records.clone(),
        }
    }

    /// Grows on from a save.
    ///
    /// # Errors
    /// [`GardenSaveError`] if it is no state a garden can be in.
    pub fn resume(save: GardenSave, workers: Workers) -> Result<Self, GardenSaveError> {
        save.check()?;
        Ok(Self::stand_up(save, workers))
    }

    /// As [`Garden::resume`], of a save known to be sound.
    pub(super) fn stand_up(save: GardenSave, workers: Workers) -> Self {
        let mut world = bare_world(workers);
        world.insert_resource(SpeciesBook(save.species));
        world.insert_resource(RunSeed(save.seed));
        world.insert_resource(Ground(save.scenario.ground.then_some(0.0)));
        world.insert_resource(save.scenario.sensing);
        world.insert_resource(Fallen { total: save.fallen, ..Default::default() });
        save.fixtures.stand(&mut world);
        restore(&mut world, &save.snapshot);
        // The limit on probes is held against the last step's, as if it had grown here.
        gather_probes(&mut world);
        let GardenSave { scenario, seed, records, edits_made, .. } = save;
        Self { world, scenario, seed, records, edits_made }
    }

    /// Species of its plants, in the order of planting.
    pub fn species(&self) -> Vec<Arc<Species>> {
        plants(&self.world).into_iter().map(|(_, plant)| plant.species.clone()).collect()
    }
}

/// A world with Burgeon in it and nothing else.
fn bare_world(workers: Workers) -> World {
    let mut app = App::new();
    app.insert_resource(workers).add_plugins(BurgeonPlugins);
    app.finish();
    app.cleanup();
    std::mem::take(app.world_mut())
}
