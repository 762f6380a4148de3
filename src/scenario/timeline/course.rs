//! One course of growth: what it was at every step.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::plant::measure::StepRecord;
use crate::plant::{Fallen, Snapshot, Tombstone};
use crate::scenario::{Fixtures, TimedEdit};
use crate::species::Species;

/// What stands there and what the species are, before the edits of a step.
#[derive(Debug, Clone)]
pub(super) struct Setting {
    pub fixtures: Arc<Fixtures>,
    pub species: Arc<BTreeMap<String, Arc<Species>>>,
    /// Organs that ever went.
    pub fallen: u64,
}

impl Setting {
    /// Shares with another what is the same in both.
    fn sharing(mut self, with: Option<&Self>) -> Self {
        if let Some(with) = with {
            if self.fixtures == with.fixtures {
                self.fixtures = with.fixtures.clone();
            }
            if self.species == with.species {
                self.species = with.species.clone();
            }
        }
        self
    }
}

/// Growth under one seed and one list of edits, from step 0 as far as it has come.
///
/// Every step's shot is the state before the edits of that step, so it is what a garden grown afresh shows.
#[derive(Debug, Clone)]
pub(super) struct Course {
    pub seed: u64,
    /// Edits in the order they are made, each with its number.
    pub plan: Vec<(usize, TimedEdit)>,
    /// Why edits could not be made, by their number.
    pub lapsed: BTreeMap<usize, (u32, String)>,
    pub shots: BTreeMap<u32, Arc<Snapshot>>,
    settings: BTreeMap<u32, Setting>,
    records: Vec<StepRecord>,
    pub hashes: BTreeMap<u32, u64>,
    fallen: Vec<Tombstone>,
    /// Bytes of the shots.
    pub bytes: usize,
    /// Steps between shots that are kept.
    spacing: u32,
}

impl Course {
    /// A course at its beginning.
    pub fn begin(seed: u64, plan: Vec<(usize, TimedEdit)>, shot: Snapshot, setting: Setting) -> Self {
        let mut course = Self {
            seed,
            plan,
            lapsed: BTreeMap::new(),
            shots: BTreeMap::new(),
            settings: BTreeMap::new(),
            records: Vec::new(),
            hashes: BTreeMap::new(),
            fallen: Vec::new(),
            bytes: 0,
            spacing: 1,
        };
        course.keep(Arc::new(shot), setting);
        course
    }

    /// The last step.
    pub fn end(&self) -> u32 {
        self.shots.last_key_value().map_or(0, |(step, _)| *step)
    }

    /// The last step of which there is a shot, up to a step.
    pub fn kept_by(&self, step: u32) -> u32 {
        self.shots.range(..=step).next_back().map_or(0, |(step, _)| *step)
    }

    /// The shot and setting growth can go on from at a step that is kept.
    pub fn start_at(&self, step: u32) -> Option<(&Arc<Snapshot>, &Setting)> {
        Some((self.shots.get(&step)?, self.settings.get(&step)?))
    }

    pub fn setting(&self, step: u32) -> Option<&Setting> {
        self.settings.get(&step)
    }

    pub fn record(&self, step: u32) -> Option<&StepRecord> {
        self.records.get(step.checked_sub(1)? as usize)
    }

    pub fn records(&self) -> &[StepRecord] {
        &self.records
    }

    /// Takes over the records and hashes of a run that has come to its end.
    pub fn take_books(&mut self, records: Vec<StepRecord>, hashes: impl Iterator<Item = (u32, u64)>) {
        self.records = records;
        self.hashes.extend(hashes);
    }

    /// Adds the next step.
    pub fn push(&mut self, shot: Arc<Snapshot>, setting: Setting, record: StepRecord) {
        let before = self.end();
        self.records.push(record);
        self.hashes.insert(shot.step, shot.hash());
        self.keep(shot, setting);
        if !before.is_multiple_of(self.spacing) {
            self.drop_shot(before);
        }
    }

    /// Adds a shot of a step that has been grown again, or the end of a course that was loaded.
    pub fn keep(&mut self, shot: Arc<Snapshot>, setting: Setting) {
        let before = self.settings.range(..shot.step).next_back().map(|(_, setting)| setting);
        self.settings.insert(shot.step, setting.sharing(before));
        self.bytes += shot.bytes();
        if let Some(old) = self.shots.insert(shot.step, shot) {
            self.bytes -= old.bytes();
        }
    }

    /// Whether the shot of a step would be kept rather than thinned away.
    pub fn wants(&self, step: u32) -> bool {
        step.is_multiple_of(self.spacing)
    }

    /// Drops every other shot until they fit; the first and the last stay.
    pub fn thin(&mut self, budget: usize) {
        while self.bytes > budget && self.shots.len() > 2 {
            self.spacing = self.spacing.saturating_mul(2);
            let end = self.end();
            let spacing = self.spacing;
            let gone: Vec<u32> =
                self.shots.keys().copied().filter(|s| *s != end && !s.is_multiple_of(spacing)).collect();
            gone.into_iter().for_each(|step| self.drop_shot(step));
        }
    }

    fn drop_shot(&mut self, step: u32) {
        if let Some(old) = self.shots.remove(&step) {
            self.bytes -= old.bytes();
        }
    }

    /// Forgets everything after a step that is kept.
    pub fn cut_back(&mut self, step: u32) {
        let gone = self.shots.split_off(&(step + 1));
        self.bytes -= gone.values().map(|shot| shot.bytes()).sum::<usize>();
        self.settings.split_off(&(step + 1));
        self.hashes.split_off(&(step + 1));
        self.records.truncate(step as usize);
        self.fallen.retain(|tombstone| tombstone.died < step);
        self.lapsed.retain(|_, (at, _)| *at < step);
    }

    /// Adds what fell lately; the oldest are forgotten as a garden forgets them.
    pub fn bury(&mut self, tombstones: impl Iterator<Item = Tombstone>) {
        self.fallen.extend(tombstones);
        let over = self.fallen.len().saturating_sub(Fallen::LIMIT);
        self.fallen.drain(..over);
    }

    pub fn fallen(&self) -> &[Tombstone] {
        &self.fallen
    }
}
