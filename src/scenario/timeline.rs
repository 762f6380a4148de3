//! A garden with its past: every step can be seen again, every edit undone, and growth forked anywhere.
//!
//! ```
//! # use burgeon::assets::Library;
//! # use burgeon::environment::workers::Workers;
//! # use burgeon::scenario::{Edit, Timeline};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let library = Library::embedded();
//! let mut timeline = Timeline::new(library.scenario("figure_1d")?, 1, library, Workers::new(1)?)?;
//! for _ in 0..4 {
//!     timeline.advance()?;
//! }
//! timeline.edit(2, Edit::Remove { name: "wall".into() })?; // forks: the tree with the wall stays as a ghost
//! while timeline.catching_up().is_some() {
//!     timeline.advance()?;
//! }
//! timeline.undo(); // and is the tree again
//! assert_eq!(timeline.present(), 4);
//! # Ok(())
//! # }
//! ```
//!
//! An edit belongs to its step. At the head it is made at once, at an earlier step growth is cut back to there and
//! regrows towards the present as the host calls [`Timeline::advance`]. A later edit that has lost its ground (the
//! branch it cut never grew) lapses: it is left out, named by [`Timeline::lapsed`], and made again when it can be.
//! The shot of step n is the state before the edits of step n, as a [`Garden`] grown n steps has it;
//! [`Timeline::now`] is the head with its edits made.

mod course;
mod leave;
mod look;
mod reap;
mod why;

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;

use super::{
    Edit, EditError, EditOutcome, Fixtures, Garden, GardenError, GardenSave, GardenSaveError, SavedRun,
    Scenario, SpeciesBook, TimedEdit,
};
use crate::assets::Library;
use crate::environment::workers::Workers;
use crate::files::{FileError, ResolvedScenario, ScenarioError};
use crate::limits::{self, GrowthLimits};
use crate::plant::measure::StepRecord;
use crate::plant::{Fallen, Lineage, Snapshot, Tombstone};
use crate::species::Species;

use course::{Course, Setting};
pub use look::{Ghost, View, Visit};
pub use why::{Moment, Why};

/// Why a timeline did not do what was asked; it is as it was.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TimelineError {
    /// The edit cannot be made where the plants or what stands there are concerned.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// A value of the edit is out of range, or it names what does not stand there at its step.
    #[error(transparent)]
    Invalid(#[from] ScenarioError),
    /// Growth never came to that step.
    #[error("step {step} has not been grown; the last is {last}")]
    NotGrown {
        /// The step asked for.
        step: u32,
        /// The last there is.
        last: u32,
    },
    /// A species cannot be had.
    #[error(transparent)]
    Species(#[from] FileError),
    /// A save is no garden that can grow on.
    #[error(transparent)]
    Save(#[from] GardenSaveError),
}

/// A scenario, a seed and edits, growing, with all it was on the way.
pub struct Timeline {
    library: Library,
    /// The scenario as it began, without edits made by hand.
    base: ResolvedScenario,
    /// Edits made by hand, in the order they were made; those after `made` are undone.
    acts: Vec<TimedEdit>,
    made: usize,
    course: Course,
    ghost: Option<Course>,
    /// Stands at the end of the course, its edits made.
    garden: Garden,
    now: Arc<Snapshot>,
    /// Edits at the head that changed more than what stands there.
    touches: usize,
    /// What stood there after each of the edits made at the head, and the touches so far.
    trail: Vec<(Arc<Fixtures>, usize)>,
    /// The step growth is on its way to.
    target: u32,
    budget: usize,
    limits: GrowthLimits,
    /// How often the course has changed: a visit begun before is of another.
    forks: u64,
    workers: Workers,
}

impl Timeline {
    /// Begins a scenario; species that edits sow come from the library.
    ///
    /// # Errors
    /// A scenario that is not sound, or the first thing in it that cannot be placed.
    pub fn new(
        mut resolved: ResolvedScenario,
        seed: u64,
        library: Library,
        workers: Workers,
    ) -> Result<Self, TimelineError> {
        resolved.scenario.validate()?;
        resolved.scenario.order_edits();
        let mut garden = Garden::new(resolved.clone(), seed, workers.clone())?;
        let plan = resolved.scenario.edits.iter().cloned().enumerate().collect();
        let setting = setting_of(&mut garden);
        let trail = vec![(setting.fixtures.clone(), 0)];
        let course = Course::begin(seed, plan, garden.snapshot(), setting);
        let now = course.shots.values().next_back().cloned().unwrap_or_default();
        let mut timeline = Self {
            library,
            base: resolved,
            acts: Vec::new(),
            made: 0,
            course,
            ghost: None,
            garden,
            now,
            touches: 0,
            trail,
            target: 0,
            budget: limits::HISTORY_BYTES,
            limits: GrowthLimits::default(),
            forks: 0,
            workers,
        };
        timeline.make_due();
        Ok(timeline)
    }

    /// Sets how many bytes of snapshots are kept, [`limits::HISTORY_BYTES`] at first. Beyond it the ghost goes, then
    /// every other shot; any step can still be reached, by growing again from the last one kept.
    pub fn set_budget(&mut self, bytes: usize) {
        self.budget = bytes;
        self.thin();
    }

    /// Sets what growth may take.
    pub fn set_limits(&mut self, limits: GrowthLimits) {
        self.limits = limits;
        self.garden.set_limits(limits);
    }

    /// Grows one step; the edits of the step it comes to are made at once.
    ///
    /// # Errors
    /// A limit; what has grown is kept.
    pub fn advance(&mut self) -> Result<StepRecord, GardenError> {
        let shot = match self.garden.step_and_look() {
            Ok(shot) => Arc::new(shot),
            Err(stopped) => {
                self.target = self.present();
                return Err(stopped);
            }
        };
        let record = self.garden.records().last().copied().unwrap_or_default();
        self.bury();
        let setting = setting_of(&mut self.garden);
        self.arrive(shot.clone(), setting.fixtures.clone());
        self.course.push(shot, setting, record);
        self.target = self.target.max(self.present());
        self.make_due();
        self.thin();
        Ok(record)
    }

    /// Makes an edit at a step. The outcome is `None` if growth has yet to come to that step again.
    ///
    /// Edits that were undone can then no longer be made again.
    ///
    /// # Errors
    /// [`TimelineError`]; nothing is changed then.
    pub fn edit(&mut self, step: u32, edit: Edit) -> Result<Option<EditOutcome>, TimelineError> {
        self.check(step, &edit, self.made)?;
        self.acts.truncate(self.made);
        self.acts.push(TimedEdit { step, edit });
        self.made += 1;
        Ok(self.regrow_from(step))
    }

    /// Makes an edit in the place of the last one, if that was the same with other values at the same step, so that a
    /// drag is one edit; else as [`Timeline::edit`].
    ///
    /// # Errors
    /// [`TimelineError`]; nothing is changed then.
    pub fn amend(&mut self, step: u32, edit: Edit) -> Result<Option<EditOutcome>, TimelineError> {
        let last = self.acts[..self.made].last();
        if !last.is_some_and(|last| last.step == step && edit.replaces(&last.edit)) {
            return self.edit(step, edit);
        }
        self.check(step, &edit, self.made - 1)?;
        self.acts.truncate(self.made - 1);
        self.acts.push(TimedEdit { step, edit });
        Ok(self.regrow_from(step))
    }

    /// Takes back the edit made last, and regrows from its step. `None` if there is none.
    pub fn undo(&mut self) -> Option<TimedEdit> {
        self.made = self.made.checked_sub(1)?;
        let undone = self.acts[self.made].clone();
        self.regrow_from(undone.step);
        Some(undone)
    }

    /// Makes the edit undone last again, and regrows from its step. `None` if there is none.
    pub fn redo(&mut self) -> Option<TimedEdit> {
        let again = self.acts.get(self.made)?.clone();
        self.made += 1;
        self.regrow_from(again.step);
        Some(again)
    }

    /// Goes back to step 0; edits stay and are made when growth comes to their steps.
    pub fn restart(&mut self) {
        self.target = self.present();
        self.regrow_from(0);
        self.target = 0;
    }

    /// Goes back to step 0 under another seed.
    ///
    /// # Errors
    /// Never for a scenario that has begun once.
    pub fn reseed(&mut self, seed: u64) -> Result<(), TimelineError> {
        let mut garden = Garden::new(self.base.clone(), seed, self.workers.clone())?;
        let setting = setting_of(&mut garden);
        let course = Course::begin(seed, self.plan(), garden.snapshot(), setting);
        let old = std::mem::replace(&mut self.course, course);
        self.forks += 1;
        self.haunt(old);
        self.target = 0;
        self.stand_at_head();
        Ok(())
    }

    /// All edits in the order they are made: those of the scenario and those by hand, by step, each with its number.
    fn plan(&self) -> Vec<(usize, TimedEdit)> {
        let all = self.base.scenario.edits.iter().chain(&self.acts[..self.made]);
        let mut plan: Vec<(usize, TimedEdit)> = all.cloned().enumerate().collect();
        plan.sort_by_key(|(_, edit)| edit.step);
        plan
    }

    /// Checks an edit that would follow the first `made` edits by hand, and gets the species it needs.
    fn check(&mut self, step: u32, edit: &Edit, made: usize) -> Result<(), TimelineError> {
        if step > self.target.max(self.present()) {
            return Err(self.not_grown(step));
        }
        let before = self.base.scenario.edits.len() + made;
        let earlier = self.course.plan.iter().filter(|(n, e)| e.step <= step && *n < before);
        let timed = TimedEdit { step, edit: edit.clone() };
        self.base.scenario.check_edit(self.course.sound(earlier), &timed).map_err(|mut wrong| {
            // Its number among the edits means nothing to whoever made it.
            if let Some((_, field)) = wrong.field.split_once("].edit.") {
                wrong.field = field.into();
            }
            wrong
        })?;
        if let Edit::Prune { plant, lineage } = edit {
            let shot = if step == self.present() { Some(&self.now) } else { self.course.shots.get(&step) };
            let missing = |shot: &Arc<Snapshot>| {
                !(0..shot.len()).any(|i| shot.plant[i] == *plant && shot.lineage[i] == Lineage(*lineage))
            };
            if shot.is_some_and(missing) {
                return Err(EditError::NoSuchOrgan { plant: *plant, lineage: *lineage }.into());
            }
        }
        if let Edit::Plant(planting) = edit
            && !self.base.species.contains_key(&planting.species)
        {
            let name = planting.species.clone();
            let species = Species { name: name.clone(), ..self.library.species(&name)? };
            self.know(name, species);
        }
        Ok(())
    }

    /// Makes a species known, now and wherever growth is taken up again.
    fn know(&mut self, name: String, species: Species) {
        let book = &mut self.garden.world_mut().resource_mut::<SpeciesBook>().0;
        book.entry(name.clone()).or_insert_with(|| Arc::new(species.clone()));
        self.base.species.insert(name, species);
    }

    /// Takes over the edits as they are now, of which those from a step on are new. The outcome is that of the edit
    /// made last, if growth has come to it.
    fn regrow_from(&mut self, step: u32) -> Option<EditOutcome> {
        let plan = self.plan();
        let head = self.present();
        self.target = self.target.max(head);
        if step > head {
            // Growth will come to it.
            self.course.plan = plan;
            self.lay_out();
            return None;
        }
        self.forks += 1;
        let is_this =
            |ghost: &Course| ghost.seed == self.course.seed && ghost.plan == plan && self.course.plan != plan;
        if self.ghost.as_ref().is_some_and(is_this) {
            // Undone or redone: that course has been grown before.
            if let Some(ghost) = &mut self.ghost {
                std::mem::swap(ghost, &mut self.course);
            }
            self.course.cut_back(self.course.kept_by(self.target));
            self.stand_at_head()
        } else {
            let from = self.course.kept_by(step);
            if from < head {
                let old = self.course.clone();
                self.course.cut_back(from);
                // What was only half grown again is not worth comparing with.
                if head == self.target {
                    self.haunt(old);
                }
            }
            let alike = self.course.plan.iter().zip(&plan).take_while(|(old, new)| old == new).count();
            self.course.plan = plan;
            if from == head && self.step_back_to(alike) {
                self.make_due()
            } else {
                self.course.cut_back(from);
                self.stand_at_head()
            }
        }
    }

    /// Takes back the edits made at the head but for the first `made` of the plan, if all they changed is what
    /// stands there.
    fn step_back_to(&mut self, made: usize) -> bool {
        let head = self.present();
        let made = made.min(self.garden.edits_made());
        let index = made.checked_sub(self.made_before(head));
        let Some((standing, touches)) = index.and_then(|i| self.trail.get(i)).cloned() else { return false };
        if touches != self.touches {
            return false;
        }
        if made < self.garden.edits_made() {
            standing.stand(self.garden.world_mut());
            self.trail.truncate(self.trail.len() - (self.garden.edits_made() - made));
            let left: Vec<usize> = self.course.plan[..made].iter().map(|(number, _)| *number).collect();
            self.course.lapsed.retain(|number, (at, _)| *at < head || left.contains(number));
        }
        self.garden.set_edits(self.edits(), made);
        true
    }

    /// Stands at a head none of whose edits is made.
    fn arrive(&mut self, shot: Arc<Snapshot>, standing: Arc<Fixtures>) {
        self.now = shot;
        self.touches = 0;
        self.trail = vec![(standing, 0)];
    }

    /// Tells the garden of a plan that differs only in what is yet to be made.
    fn lay_out(&mut self) {
        let made = self.garden.edits_made();
        self.garden.set_edits(self.edits(), made);
    }

    fn edits(&self) -> Vec<TimedEdit> {
        self.course.plan.iter().map(|(_, edit)| edit.clone()).collect()
    }

    /// Edits of the plan that are made before growth comes to a step.
    fn made_before(&self, step: u32) -> usize {
        self.course.plan.iter().take_while(|(_, edit)| edit.step < step).count()
    }

    /// Sets the garden up anew at the end of the course, and makes the edits due there.
    fn stand_at_head(&mut self) -> Option<EditOutcome> {
        let head = self.present();
        if let Some(garden) = self.garden_at(head) {
            self.garden = garden;
        }
        if let Some((shot, setting)) = self.course.start_at(head) {
            self.arrive(shot.clone(), setting.fixtures.clone());
        }
        self.course.lapsed.retain(|_, (at, _)| *at < head);
        self.make_due()
    }

    /// A garden as it was at a step that is kept, before the edits of that step.
    fn garden_at(&self, step: u32) -> Option<Garden> {
        let (shot, setting) = self.course.start_at(step)?;
        let mut species = BTreeMap::clone(&setting.species);
        for (name, known) in &self.base.species {
            species.entry(name.clone()).or_insert_with(|| Arc::new(known.clone()));
        }
        let save = GardenSave {
            scenario: Scenario { edits: self.edits(), ..self.base.scenario.clone() },
            seed: self.course.seed,
            edits_made: self.made_before(step),
            species,
            snapshot: Snapshot::clone(shot),
            fixtures: Fixtures::clone(&setting.fixtures),
            fallen: setting.fallen,
            records: Vec::new(),
        };
        let mut garden = Garden::stand_up(save, self.workers.clone());
        garden.set_limits(self.limits);
        Some(garden)
    }

    /// Makes all edits due at the head. The outcome is that of the edit made by hand last, if it was among them.
    fn make_due(&mut self) -> Option<EditOutcome> {
        let newest = (self.base.scenario.edits.len() + self.made).checked_sub(1);
        let head = self.present();
        let mut outcome = None;
        let before = self.touches;
        while let Some(made) = self.garden.make_next_edit() {
            let Some((number, timed)) = self.course.plan.get(self.garden.edits_made() - 1) else { break };
            match made {
                Ok(done) => {
                    let touches = done.shed > 0
                        || matches!(
                            timed.edit,
                            Edit::Plant(_) | Edit::Uproot { .. } | Edit::Set { .. } | Edit::SetAll { .. }
                        );
                    self.touches += usize::from(touches);
                    if Some(*number) == newest {
                        outcome = Some(done);
                    }
                }
                Err(why) => {
                    self.course.lapsed.insert(*number, (head, why.to_string()));
                }
            }
            self.trail.push((Arc::new(Fixtures::take(self.garden.world_mut())), self.touches));
        }
        if self.touches > before {
            self.bury();
            self.now = Arc::new(self.garden.snapshot());
        }
        outcome
    }

    /// Books what fell since it was last asked.
    fn bury(&mut self) {
        let Some(mut fallen) = self.garden.world_mut().get_resource_mut::<Fallen>() else { return };
        let gone = std::mem::take(&mut fallen.tombstones);
        self.course.bury(gone.into_iter());
    }

    fn haunt(&mut self, old: Course) {
        self.ghost = (old.end() > 0).then_some(old);
    }

    fn thin(&mut self) {
        let ghost = self.ghost.as_ref().map_or(0, |ghost| ghost.bytes);
        if self.course.bytes + ghost > self.budget {
            self.ghost = None;
        }
        self.course.thin(self.budget);
    }
}

/// What stands in a garden.
fn setting_of(garden: &mut Garden) -> Setting {
    let world = garden.world_mut();
    Setting {
        fixtures: Arc::new(Fixtures::take(world)),
        species: Arc::new(world.resource::<SpeciesBook>().0.clone()),
        fallen: world.resource::<Fallen>().total,
    }
}
