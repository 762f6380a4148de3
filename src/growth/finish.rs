//! The end of a step: books closed, step counted, measures taken.

use std::time::Instant;

use bevy::prelude::*;

use super::StepCount;
use crate::plant::{Allotment, EnergyLedger, EnergyStore, OrganKind, Roster};

/// Seconds each stage of the last step took. Growth never reads it.
#[derive(Resource, Debug, Default, Clone)]
pub struct StageTimes {
    /// Generate, update, sense, finish; germination counts as generation.
    pub seconds: [f64; 4],
    last: Option<Instant>,
}

impl StageTimes {
    pub(crate) fn start(&mut self) {
        self.seconds = [0.0; 4];
        self.last = Some(Instant::now());
    }

    fn lap(&mut self, stage: usize) {
        let now = Instant::now();
        if let Some(last) = self.last.replace(now) {
            self.seconds[stage] += (now - last).as_secs_f64();
        }
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
