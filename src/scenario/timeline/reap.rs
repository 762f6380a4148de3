//! What a timeline leaves: every export of any of its steps, and its film.

use std::sync::Arc;

use super::{Fixtures, GardenError, Snapshot, Timeline};
use crate::environment::{Scene, add_plants};
use crate::export::harvest::Harvest;
use crate::export::picture::Palette;
use crate::export::reel::Reel;
use crate::files::StepHashes;

impl Timeline {
    /// All that a step leaves; of the head, its edits made. `None` for a step not grown.
    ///
    /// # Errors
    /// A limit, met on the way to a step that was thinned away.
    pub fn harvest(&self, step: u32) -> Result<Option<Harvest>, GardenError> {
        let (snapshot, standing) = match self.view(step) {
            Some(view) => (view.shot, view.standing),
            None => match self.grown_again(step)? {
                Some(mut garden) => {
                    let shot = Arc::new(garden.snapshot());
                    while garden.make_next_edit().is_some() {}
                    (shot, Arc::new(Fixtures::take(garden.world_mut())))
                }
                None => return Ok(None),
            },
        };
        let mut run = self.run_file();
        run.steps = step;
        let mut hashes = StepHashes::default();
        run.hashes.iter().take_while(|(at, _)| *at <= step).for_each(|(at, hash)| hashes.push(at, hash));
        run.hashes = hashes;
        let grown = self.records().len().min(step as usize);
        let scene = self.scene(&snapshot, &standing);
        Ok(Some(Harvest { snapshot, scene, records: self.records()[..grown].to_vec(), run }))
    }

    /// The film of all steps that are kept, with the colours of its plants.
    pub fn reel(&self) -> (Reel, Palette) {
        let mut reel = Reel::default();
        let head = self.present();
        for (&step, shot) in &self.course.shots {
            let Some(setting) = self.course.setting(step) else { continue };
            if step == head {
                let standing = self.standing(step).unwrap_or_else(|| setting.fixtures.clone());
                reel.end(step, self.scene(&self.now, &standing));
            } else if reel.wants(step) {
                reel.add(step, self.scene(shot, &setting.fixtures));
            }
        }
        (reel, Palette::of_snapshot(&self.now))
    }

    fn scene(&self, shot: &Snapshot, standing: &Fixtures) -> Scene {
        let mut scene = standing.scene(self.base.scenario.ground.then_some(0.0));
        add_plants(&mut scene, shot);
        scene
    }
}
