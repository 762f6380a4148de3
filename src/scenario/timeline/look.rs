//! Looking at a timeline: any step of it, its ghost, what was done, what an edit would do.

use std::sync::Arc;

use super::course::Course;
use super::{
    Fixtures, Garden, GardenError, Library, Snapshot, StepRecord, TimedEdit, Timeline, TimelineError,
    Tombstone, Workers, setting_of,
};
use crate::environment::StandingSolid;
use crate::scenario::{borne_by, crushed_by};

/// A step as it can be shown.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// The step.
    pub step: u32,
    /// The plants.
    pub shot: Arc<Snapshot>,
    /// What stands there, the edits of the step made.
    pub standing: Arc<Fixtures>,
    /// The step in numbers; none for step 0.
    pub record: Option<StepRecord>,
}

/// The course that growth took before it forked, to compare with.
#[derive(Debug, Clone, Copy)]
pub struct Ghost<'a>(&'a Course);

impl Ghost<'_> {
    /// Its seed.
    pub fn seed(&self) -> u64 {
        self.0.seed
    }

    /// Its last step.
    pub fn end(&self) -> u32 {
        self.0.end()
    }

    /// Its plants at a step, if they are kept.
    pub fn shot(&self, step: u32) -> Option<Arc<Snapshot>> {
        self.0.shots.get(&step).cloned()
    }

    /// A step of it in numbers.
    pub fn record(&self, step: u32) -> Option<&StepRecord> {
        self.0.record(step)
    }

    /// A step of it as it can be shown, before its edits; `None` if it is not kept.
    pub fn view(&self, step: u32) -> Option<View> {
        let (shot, setting) = self.0.start_at(step)?;
        let standing = self.0.setting(step.saturating_add(1)).unwrap_or(setting).fixtures.clone();
        Some(View { step, shot: shot.clone(), standing, record: self.record(step).copied() })
    }
}

/// A way to a step that is not kept: grows there from the last one kept, beside the timeline.
pub struct Visit {
    garden: Garden,
    to: u32,
    forks: u64,
}

impl Timeline {
    /// The last step grown: the head.
    pub fn present(&self) -> u32 {
        self.course.end()
    }

    /// The step growth is on its way back to after a fork; `None` when it is there.
    pub fn catching_up(&self) -> Option<u32> {
        (self.present() < self.target).then_some(self.target)
    }

    /// The plants at the head, all edits made so far among them.
    pub fn now(&self) -> Arc<Snapshot> {
        self.now.clone()
    }

    /// The plants at a step, before the edits of that step; `None` if it was thinned away ([`Timeline::visit`]
    /// grows there) or not grown.
    pub fn shot(&self, step: u32) -> Option<Arc<Snapshot>> {
        self.course.shots.get(&step).cloned()
    }

    /// A step in numbers, however long ago; `None` for step 0 and steps not grown.
    pub fn record(&self, step: u32) -> Option<&StepRecord> {
        self.course.record(step)
    }

    /// The hash of a step's shot.
    pub fn hash(&self, step: u32) -> Option<u64> {
        self.course.hashes.get(&step).copied()
    }

    /// Records of all steps grown, in order.
    pub fn records(&self) -> &[StepRecord] {
        self.course.records()
    }

    /// What stands at a step, the edits of that step made: what growth met on its way to the next.
    pub fn standing(&self, step: u32) -> Option<Arc<Fixtures>> {
        if step == self.present() {
            return self.trail.last().map(|(standing, _)| standing.clone());
        }
        self.course.setting(step.checked_add(1)?).map(|setting| setting.fixtures.clone())
    }

    /// A step as it can be shown, the head with its edits made. `None` if it was thinned away or not grown.
    pub fn view(&self, step: u32) -> Option<View> {
        let shot = if step == self.present() { self.now() } else { self.shot(step)? };
        Some(View { step, shot, standing: self.standing(step)?, record: self.record(step).copied() })
    }

    /// The course before the last fork; `None` if there was none, or it went for want of room.
    pub fn ghost(&self) -> Option<Ghost<'_>> {
        self.ghost.as_ref().map(Ghost)
    }

    /// Forgets the ghost.
    pub fn drop_ghost(&mut self) {
        self.ghost = None;
    }

    /// A way to a step that was thinned away; `None` for steps not grown.
    pub fn visit(&self, step: u32) -> Option<Visit> {
        if step > self.present() {
            return None;
        }
        let garden = self.garden_at(self.course.kept_by(step))?;
        Some(Visit { garden, to: step, forks: self.forks })
    }

    /// Goes on with a visit by one step at most; gives the view when it is there. What it passes is kept where there
    /// is room.
    ///
    /// # Errors
    /// A limit.
    pub fn go_on(&mut self, visit: &mut Visit) -> Result<Option<View>, GardenError> {
        let garden = &mut visit.garden;
        let step = garden.steps();
        if step >= visit.to {
            let shot = Arc::new(garden.snapshot());
            // Those that lapse here lapsed on the way before.
            while garden.make_next_edit().is_some() {}
            let standing = Arc::new(Fixtures::take(garden.world_mut()));
            return Ok(Some(View { step, shot, standing, record: self.record(step).copied() }));
        }
        while garden.make_next_edit().is_some() {}
        let shot = Arc::new(garden.step_and_look()?);
        let setting = setting_of(garden);
        let room = self.course.bytes + shot.bytes() <= self.budget && self.course.wants(shot.step);
        if room && shot.step < self.present() && visit.forks == self.forks {
            self.course.keep(shot, setting);
        }
        Ok(None)
    }

    pub(in crate::scenario) fn library(&self) -> Library {
        self.library.clone()
    }

    pub(in crate::scenario) fn workers(&self) -> Workers {
        self.workers.clone()
    }

    /// Takes over what another may keep and take.
    pub(in crate::scenario) fn adopt_settings(&mut self, from: &Self) {
        self.set_limits(from.limits);
        self.set_budget(from.budget);
    }

    pub(in crate::scenario) fn not_grown(&self, step: u32) -> TimelineError {
        TimelineError::NotGrown { step, last: self.target.max(self.present()) }
    }

    /// Organs that fell, with step and cause: those of the course as it is, the newest 200,000.
    pub fn fallen(&self) -> &[Tombstone] {
        self.course.fallen()
    }

    /// Edits made by hand, in the order they were made.
    pub fn made(&self) -> &[TimedEdit] {
        &self.acts[..self.made]
    }

    /// How many edits can be undone and how many made again.
    pub fn undoable(&self) -> (usize, usize) {
        (self.made, self.acts.len() - self.made)
    }

    /// Edits that could not be made in this course, and why.
    pub fn lapsed(&self) -> impl Iterator<Item = (&TimedEdit, &str)> {
        self.course.plan.iter().filter_map(|(number, edit)| {
            let (_, why) = self.course.lapsed.get(number)?;
            Some((edit, why.as_str()))
        })
    }

    /// Seed of the run.
    pub fn seed(&self) -> u64 {
        self.course.seed
    }

    /// Bytes of the snapshots kept, those of the ghost included though it shares some.
    pub fn bytes(&self) -> usize {
        self.course.bytes + self.ghost.as_ref().map_or(0, |ghost| ghost.bytes)
    }

    /// Birth numbers of the organs at the head that a solid set there would crush, with all they bear.
    pub fn crush_preview(&self, solid: &StandingSolid) -> Vec<u32> {
        crushed_by(&self.now, solid)
    }

    /// Birth numbers of an organ at the head and all it bears; empty if it does not live.
    pub fn prune_preview(&self, birth: u32) -> Vec<u32> {
        borne_by(&self.now, birth)
    }
}

impl Course {
    /// Of some edits of the plan, those that have not lapsed.
    pub(super) fn sound<'a>(
        &'a self,
        edits: impl Iterator<Item = &'a (usize, TimedEdit)> + 'a,
    ) -> impl Iterator<Item = &'a TimedEdit> + 'a {
        edits.filter(|(number, _)| !self.lapsed.contains_key(number)).map(|(_, edit)| edit)
    }
}
