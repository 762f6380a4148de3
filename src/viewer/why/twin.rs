//! One seed under two settings: a second garden that differs in one edit and keeps step with the first.

use std::io;

use super::other::Other;
use crate::assets::Library;
use crate::environment::workers::Workers;
use crate::files::SharedTree;
use crate::scenario::{
    Gardener, GardenerSettings, Gone, News, Order, Progress, Timeline, TimelineError, View,
};
use crate::species::parameter::ParameterError;

/// Why there is no second garden.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// It cannot begin.
    #[error(transparent)]
    Timeline(#[from] TimelineError),
    /// A value the species does not allow.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The system gives no thread.
    #[error("no thread to grow on: {0}")]
    Thread(#[from] io::Error),
}

/// The second garden.
#[derive(Debug)]
pub struct Twin {
    gardener: Gardener,
    progress: Progress,
    view: Option<View>,
    /// The step it has been told to grow to.
    ordered: u32,
    /// The step it has been asked to show.
    sought: Option<u32>,
}

impl Twin {
    /// Begins it: all as in a copy of the first but one thing, that from the seed on.
    ///
    /// # Errors
    /// [`TwinError`].
    pub fn begin(mut copy: SharedTree, other: &Other, library: Library) -> Result<Self, TwinError> {
        other.apply(&mut copy)?;
        let ordered = copy.steps;
        let timeline = Timeline::from_shared(copy, library, Workers::default())?;
        let gardener = Gardener::start(timeline, GardenerSettings::default())?;
        Ok(Self { gardener, progress: Progress::default(), view: None, ordered, sought: None })
    }

    /// Keeps step: grows as far as the first has, and shows the step that is shown there.
    ///
    /// # Errors
    /// [`Gone`] if its gardener has ended.
    pub fn follow(&mut self, shown: u32, present: u32) -> Result<(), Gone> {
        while let Some(news) = self.gardener.news() {
            match news {
                News::Grown(view, progress) | News::Changed { view, progress, .. } => {
                    self.progress = progress;
                    self.view = Some(view);
                    self.sought = None;
                }
                News::Seen(view) => self.view = Some(view),
                News::Status(progress) => self.progress = progress,
                _ => {}
            }
        }
        // One step at a time: it stops where the first does.
        let idle = self.progress.catching_up.is_none() && self.progress.present >= self.ordered;
        if idle && self.progress.present < present {
            self.ordered = self.progress.present + 1;
            self.gardener.order(Order::Step)?;
        }
        let there = self.view.as_ref().map(|view| view.step);
        if shown <= self.progress.present && there != Some(shown) && self.sought != Some(shown) {
            self.sought = Some(shown);
            self.gardener.order(Order::Seek(shown))?;
        }
        Ok(())
    }

    /// What it shows: the step of the first, or the last it has come to.
    pub fn view(&self) -> Option<&View> {
        self.view.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::growth::Mechanisms;
    use crate::viewer::why::other::Part;

    #[test]
    fn a_twin_keeps_step_under_another_setting() {
        let library = Library::embedded();
        let workers = Workers::new(1).unwrap();
        let resolved = library.scenario("figure_1d").unwrap();
        let mut first = Timeline::new(resolved, 2, library.clone(), workers.clone()).unwrap();
        for _ in 0..4 {
            first.advance().unwrap();
        }
        let dark = Mechanisms { light: false, ..Mechanisms::default() };
        let other = Other::Part(Part::Light, false);
        let mut twin = Twin::begin(first.shared(), &other, library.clone()).unwrap();
        let mut wait = |step: u32, present: u32| {
            let began = Instant::now();
            while twin.view().is_none_or(|view| view.step != step || twin.progress.present < present) {
                twin.follow(step, present).unwrap();
                std::thread::sleep(Duration::from_millis(5));
                assert!(began.elapsed() < Duration::from_secs(60), "step {step}");
            }
            twin.view().cloned().unwrap()
        };
        let fourth = wait(4, 4);
        assert_eq!(wait(6, 6).step, 6);
        assert_eq!(wait(4, 6).shot, fourth.shot);
        // The same as a garden that was always so.
        let mut resolved = library.scenario("figure_1d").unwrap();
        resolved.scenario.mechanisms = dark;
        let mut always = Timeline::new(resolved, 2, library, workers).unwrap();
        for _ in 0..4 {
            always.advance().unwrap();
        }
        assert_eq!(always.now().hash(), fourth.shot.hash());
        assert_ne!(first.now().hash(), fourth.shot.hash());
    }
}
