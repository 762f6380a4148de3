//! Leaving with something: a scenario, a run, a save.

use super::{
    BTreeMap, Edit, Garden, GardenSave, Library, ResolvedScenario, SavedRun, Scenario, Snapshot, TimedEdit,
    Timeline, TimelineError, Workers, setting_of,
};
use crate::files::{RunFile, ShareError, SharedTree, StepHashes};
use crate::scenario::History;
use std::sync::Arc;

impl Timeline {
    /// The scenario as it began, with its species: no edit made by hand is in it.
    pub fn begun(&self) -> &ResolvedScenario {
        &self.base
    }

    /// The scenario with all edits, those that lapsed left out.
    fn edited(&self) -> Scenario {
        let mut scenario = Scenario {
            edits: self.course.sound(self.course.plan.iter()).cloned().collect(),
            ..self.base.scenario.clone()
        };
        scenario.leave_out_unsound_edits();
        scenario
    }

    /// The scenario with all edits that could be made, and as many steps as have grown. Parameters of species that
    /// differ from the library's are set by edits, so that the text grows the same tree anywhere; a species that the
    /// library does not have stays a name.
    pub fn scenario(&self) -> Scenario {
        let mut scenario = self.edited();
        scenario.steps = self.target.max(self.present());
        for (name, species) in &self.base.species {
            let Ok(shipped) = self.library.species(name) else { continue };
            let first = scenario.edits.iter().position(|e| sows(&e.edit, name));
            let (at, step) = match first {
                _ if scenario.plants.iter().any(|p| p.species == *name) => (0, 0),
                Some(i) => (i + 1, scenario.edits[i].step),
                None => continue,
            };
            let set = species.differing(&shipped).map(|(parameter, value)| TimedEdit {
                step,
                edit: Edit::Set { species: name.clone(), parameter: parameter.into(), value },
            });
            scenario.edits.splice(at..at, set.collect::<Vec<_>>());
        }
        scenario
    }

    /// All that is needed to grow the same tree again, with hashes to tell whether it is.
    pub fn run_file(&self) -> RunFile {
        let mut hashes = StepHashes::default();
        for (step, hash) in self.course.hashes.iter().filter(|(step, _)| **step > 0) {
            hashes.push(*step, *hash);
        }
        let resolved = ResolvedScenario { scenario: self.edited(), species: self.base.species.clone() };
        RunFile::new(&resolved, self.seed(), self.present(), hashes)
    }

    /// A code that grows it again.
    ///
    /// # Errors
    /// [`ShareError::TooLong`].
    pub fn code(&self) -> Result<String, ShareError> {
        self.shared().code()
    }

    /// All that is needed to grow it again: the scenario it began with, its seed, the edits that stand and the steps
    /// grown.
    pub fn shared(&self) -> SharedTree {
        let own = self.base.scenario.edits.len();
        let mut resolved = self.base.clone();
        let mut edits = Vec::new();
        // One of the scenario's own edits that lapsed would stop whoever grows it again.
        let kept = |number: &usize| !self.course.lapsed.contains_key(number);
        let by_number = |range: core::ops::Range<usize>| range.filter(kept);
        resolved.scenario.edits = by_number(0..own).map(|n| self.base.scenario.edits[n].clone()).collect();
        edits.extend(by_number(own..own + self.made).map(|n| self.acts[n - own].clone()));
        let named = self.edited();
        let named: Vec<&str> = named.species_named().into_iter().map(|(name, _)| name).collect();
        resolved.species.retain(|name, _| named.contains(&name.as_str()));
        SharedTree { resolved, edits, seed: self.seed(), steps: self.present() }
    }

    /// Begins the tree of a share code; it is on its way to the steps the code tells.
    ///
    /// # Errors
    /// What cannot be placed.
    pub fn from_shared(
        shared: SharedTree,
        library: Library,
        workers: Workers,
    ) -> Result<Self, TimelineError> {
        let mut timeline = Self::new(shared.resolved, shared.seed, library, workers)?;
        timeline.made = shared.edits.len();
        timeline.acts = shared.edits;
        timeline.target = shared.steps;
        timeline.regrow_from(0);
        Ok(timeline)
    }

    /// Everything it is but the shots of earlier steps, which can be grown again.
    pub fn save(&self) -> SavedRun {
        let run = self.run_file();
        let head = self.present();
        let made = run.scenario.edits.iter().take_while(|edit| edit.step < head).count();
        let (shot, setting) = match self.course.start_at(head) {
            Some((shot, setting)) => (Snapshot::clone(shot), setting.clone()),
            // The head is always kept.
            None => unreachable!("a course has a shot and a setting at its end"),
        };
        let garden = GardenSave {
            scenario: run.scenario.clone(),
            seed: run.seed,
            edits_made: made,
            species: BTreeMap::clone(&setting.species),
            snapshot: shot,
            fixtures: super::Fixtures::clone(&setting.fixtures),
            fallen: setting.fallen,
            records: self.records().to_vec(),
        };
        let history = History {
            scenario: self.base.scenario.clone(),
            edits: self.acts.clone(),
            made: self.made,
            target: self.target,
        };
        SavedRun { run, garden, history: Some(history) }
    }

    /// Takes up a save: it stands where it stood, with all that can be undone; earlier steps are grown again when
    /// they are visited.
    ///
    /// # Errors
    /// A save that is no garden that can grow on.
    pub fn resume(saved: SavedRun, library: Library, workers: Workers) -> Result<Self, TimelineError> {
        saved.check()?;
        let SavedRun { run, garden: save, history } = saved;
        let history = history.unwrap_or(History {
            scenario: run.scenario.clone(),
            edits: Vec::new(),
            made: 0,
            target: save.steps(),
        });
        let resolved = ResolvedScenario { scenario: history.scenario, species: run.species };
        let mut timeline = Self::new(resolved, run.seed, library, workers)?;
        timeline.acts = history.edits;
        timeline.made = history.made;
        let plan = timeline.plan();
        // Step 0 stands as it was before any edit.
        timeline.course.cut_back(0);
        timeline.course.plan = plan;
        let head = save.steps();
        if head > 0 {
            let mut left = run.scenario.edits.iter().peekable();
            for (number, edit) in &timeline.course.plan {
                if left.next_if_eq(&edit).is_none() && edit.step < head {
                    let why = "it could not be made when it was due".to_string();
                    timeline.course.lapsed.insert(*number, (edit.step, why));
                }
            }
            let mut standing = Garden::stand_up(save.clone(), timeline.workers.clone());
            timeline.course.keep(Arc::new(save.snapshot), setting_of(&mut standing));
            timeline.course.take_books(save.records, run.hashes.iter());
        }
        timeline.target = history.target.max(head);
        timeline.stand_at_head();
        Ok(timeline)
    }
}

fn sows(edit: &Edit, name: &str) -> bool {
    matches!(edit, Edit::Plant(planting) if planting.species == name)
}
