//! The end of a step: books closed, step counted, measures taken.

use std::time::{Duration, Instant};

use bevy::prelude::*;

use super::StepCount;
use crate::plant::{Allotment, EnergyLedger, EnergyStore, OrganKind, Roster};

/// Seconds each stage of the last step took. Growth never reads it.
///
/// Of a step grown in parts, what other threads took counts, and what the host did between the parts does not.
#[derive(Resource, Debug, Default, Clone, Reflect)]
#[reflect(Resource, Default)]
pub struct StageTimes {
    /// Generate, update, sense, finish; germination counts as generation.
    pub seconds: [f64; 4],
    /// The stage that runs.
    #[reflect(ignore)]
    stage: usize,
    /// Since when; `None` while the host does something else.
    #[reflect(ignore)]
    last: Option<Instant>,
}

impl StageTimes {
    pub(crate) fn start(&mut self) {
        *self = Self { last: Some(Instant::now()), ..default() };
    }

    fn lap(&mut self, stage: usize) {
        self.stage = stage;
        self.pause();
        self.stage = stage + 1;
        self.go_on();
    }

    /// The step is left off.
    pub(super) fn pause(&mut self) {
        if let Some(last) = self.last.take() {
            self.add(last.elapsed());
        }
    }

    /// It goes on.
    pub(super) fn go_on(&mut self) {
        self.last = Some(Instant::now());
    }

    /// Other threads took this long for the stage that runs.
    pub(super) fn add(&mut self, took: Duration) {
        self.seconds[self.stage.min(3)] += took.as_secs_f64();
    }
}

/// Books the time since the last stage's end to stage number `STAGE`.
pub fn time_stage<const STAGE: usize>(mut times: ResMut<StageTimes>) {
    times.lap(STAGE - 1);
}

/// Books what is left: store and allotments.
pub fn close_books(
    roster: Res<Roster>,
    allotments: Query<&Allotment>,
    mut books: Query<(&EnergyStore, &mut EnergyLedger)>,
) {
    let mut held = vec![0.0_f64; roster.plants.len()];
    for i in (0..roster.len()).filter(|&i| roster.kind[i] != OrganKind::Internode) {
        if let Ok(allotment) = allotments.get(roster.entity[i]) {
            held[roster.plant[i] as usize] += f64::from(allotment.0);
        }
    }
    for (plant, entity) in roster.plants.iter().enumerate() {
        if let Some(Ok((store, mut ledger))) = entity.map(|e| books.get_mut(e)) {
            ledger.closed = store.stored + held[plant];
        }
    }
}

/// Counts the step.
pub fn count_step(mut step: ResMut<StepCount>, mut times: ResMut<StageTimes>) {
    step.0 += 1;
    times.lap(3);
}
