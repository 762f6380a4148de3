//! Why things are as they are: explanations of organs, and what they were over time.

use std::sync::Arc;

use image::RgbImage;

use super::{Fixtures, Garden, GardenError, Snapshot, Timeline, Tombstone};
use crate::environment::Scene;
use crate::environment::trace::Tracer;
use crate::export::picture::{CubeMapView, Palette, cube_map_picture};
use crate::growth::explain::{Explanation, Outcome, Surroundings, explain_in, whole};
use crate::growth::{generation, look_around};
use crate::plant::{Lineage, OrganState};

/// What an organ was at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Moment {
    /// The step.
    pub step: u32,
    /// Light it found, 0..1.
    pub light: f32,
    /// Space it found, 0..1.
    pub space: f32,
    /// Energy set aside for its growth.
    pub energy: f32,
    /// What it earned in the step.
    pub income: f32,
    /// What it used in the step.
    pub upkeep: f32,
    /// Radius, metres; 0 but for stems.
    pub radius: f32,
}

/// All there is to say of an organ.
#[derive(Debug, Clone)]
pub struct Why {
    /// What it is, saw and chose.
    pub explanation: Explanation,
    /// What became of it in the next step.
    pub outcome: Outcome,
    /// What it was at the steps that are kept, in order.
    pub history: Vec<Moment>,
    /// All it could see.
    pub scene: Arc<Scene>,
}

impl Why {
    /// What it saw, drawn: six faces unfolded, in the colours of the plants of a snapshot. `None` if it did not look.
    pub fn picture(&self, plants: &Snapshot) -> Option<RgbImage> {
        let sight = self.explanation.sight.as_ref()?;
        let view = CubeMapView { range: sight.request.probe.space_range, ..CubeMapView::default() };
        let palette = Palette::of_snapshot(plants);
        Some(cube_map_picture(&sight.look.map, &Tracer::build(&self.scene), &palette, view))
    }
}

impl Timeline {
    /// Explains the organ with a birth number at the end of a step. `None` if it did not live then.
    ///
    /// What is told is what the bud goes by as it grows on: where a seed opens, all look around once more, and what
    /// they found then counts.
    ///
    /// # Errors
    /// A limit, met on the way to a step that was thinned away.
    pub fn explain(&self, step: u32, birth: u32) -> Result<Option<Why>, GardenError> {
        let Some((shot, around)) = self.as_they_looked(step)? else { return Ok(None) };
        let scene = whole(&around, &shot);
        let Some(explanation) = explain_in(&shot, &around, &Tracer::build(&scene), birth) else {
            return Ok(None);
        };
        let next = self.shot(step.saturating_add(1));
        let outcome = next.map_or(Outcome::Unknown, |next| explanation.outcome(&next, self.fallen()));
        let history = self.history(explanation.plant, explanation.lineage);
        Ok(Some(Why { explanation, outcome, history, scene: Arc::new(scene) }))
    }

    /// The plants at the end of a step and what they had around them when they last looked, before they grow on.
    /// `None` for a step not grown.
    ///
    /// # Errors
    /// A limit, met on the way to a step that was thinned away.
    pub fn as_they_looked(&self, step: u32) -> Result<Option<(Arc<Snapshot>, Surroundings)>, GardenError> {
        let around = |fixtures: &Fixtures| Surroundings {
            scene: fixtures.scene(self.base.scenario.ground.then_some(0.0)),
            mechanisms: fixtures.mechanisms,
            sensing: self.base.scenario.sensing,
        };
        let opens = self.opens_seed(step);
        if !opens && let Some((shot, setting)) = self.course.start_at(step) {
            return Ok(Some((shot.clone(), around(&setting.fixtures))));
        }
        let Some(mut garden) = self.grown_again(step)? else { return Ok(None) };
        if opens {
            while garden.make_next_edit().is_some() {}
            open_seeds(&mut garden);
        }
        let fixtures = Fixtures::take(garden.world_mut());
        Ok(Some((Arc::new(garden.snapshot()), around(&fixtures))))
    }

    /// A garden grown to a step from the last one kept, before the edits of that step. `None` for a step not grown.
    pub(super) fn grown_again(&self, step: u32) -> Result<Option<Garden>, GardenError> {
        if step > self.present() {
            return Ok(None);
        }
        let Some(mut garden) = self.garden_at(self.course.kept_by(step)) else { return Ok(None) };
        while garden.steps() < step {
            while garden.make_next_edit().is_some() {}
            garden.step_and_look()?;
        }
        Ok(Some(garden))
    }

    /// Whether a seed opens in the step after a step.
    fn opens_seed(&self, step: u32) -> bool {
        let opened = |shot: &Snapshot, germinated| {
            shot.plants.iter().flatten().any(|plant| plant.store.germinated == germinated)
        };
        if step == self.present() {
            return opened(&self.now, None);
        }
        match self.course.shots.range(step.saturating_add(1)..).next() {
            Some((_, after)) => opened(after, Some(step)),
            None => false,
        }
    }

    /// What an organ was at every step that is kept, in order.
    pub fn history(&self, plant: u32, lineage: Lineage) -> Vec<Moment> {
        let moment = |shot: &Arc<Snapshot>| {
            let i = (0..shot.len()).find(|&i| shot.lineage[i] == lineage && shot.plant[i] == plant)?;
            Some(Moment {
                step: shot.step,
                light: shot.exposure[i].light,
                space: shot.exposure[i].space,
                energy: shot.allotment[i],
                income: shot.flow[i].income,
                upkeep: shot.flow[i].upkeep,
                radius: match &shot.state[i] {
                    OrganState::Internode(wood, _) => wood.radius,
                    _ => 0.0,
                },
            })
        };
        self.course.shots.values().filter_map(moment).collect()
    }

    /// What is left of the organ with a birth number, if it has gone.
    pub fn tombstone(&self, birth: u32) -> Option<&Tombstone> {
        self.fallen().iter().rev().find(|tombstone| tombstone.birth == birth)
    }
}

/// Has the seeds open, and all look around, as a step begins.
fn open_seeds(garden: &mut Garden) {
    let world = garden.world_mut();
    generation::open_books(world);
    generation::germinate(world);
    look_around(world);
}
