//! What the window knows.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use bevy::prelude::*;

use crate::plant::measure::StepRecord;
use crate::render::Overlay;
use crate::scenario::{Progress, View};

/// What is on screen.
#[derive(Resource, Debug, Default)]
pub struct Shown {
    /// The step on screen; `None` until the gardener has told of one.
    pub view: Option<View>,
    /// The last step grown.
    pub head: Option<View>,
    /// Whether growth, not the past, is on screen.
    pub live: bool,
    /// A step of the old course, drawn as a ghost.
    pub ghost: Option<View>,
    /// Whether the old course is drawn, if there is one.
    pub with_ghost: bool,
    /// What organs are coloured by.
    pub overlay: Option<Overlay>,
    /// Counts what came on screen: systems that draw look at it.
    pub arrival: u64,
    /// Whether the last to come on screen grew out of the one before, or stands for itself.
    pub grew: bool,
}

/// How far growth is, and its steps in numbers.
#[derive(Resource, Debug, Default)]
pub struct Course {
    /// As the gardener told last.
    pub progress: Progress,
    /// Steps in numbers, in order; those of a course left behind go.
    pub records: Vec<StepRecord>,
    /// Name of the scenario.
    pub scenario: String,
    /// The save the garden came from, if it did.
    pub save: Option<PathBuf>,
    /// Counts the gardens that took the place of another.
    pub began: u64,
    /// Whether growth has stopped at a limit or an edit that cannot be made.
    pub stopped: bool,
}

/// The step of the past that is looked at; `None`: growth is watched.
#[derive(Resource, Debug, Default, Clone, Copy, PartialEq, Eq)]
pub struct Past(pub Option<u32>);

/// What is chosen.
#[derive(Resource, Debug, Default, Clone, PartialEq)]
pub enum Chosen {
    /// Nothing.
    #[default]
    Nothing,
    /// An organ, by birth number.
    Organ(u32),
    /// A solid or lamp, by name.
    Thing(String),
    /// A plant, by its number in the order of planting.
    Plant(u32),
    /// The sun.
    Sun,
}

/// A thing that can be set into a garden.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A wall.
    Wall,
    /// A ball.
    Ball,
    /// A pillar.
    Pillar,
    /// A lamp.
    Lamp,
    /// A plant, of the species at this place in the list.
    Plant(usize),
}

/// What the pointer does.
#[derive(Resource, Debug, Default, Clone, Copy, PartialEq, Eq)]
pub enum Tool {
    /// Chooses, and moves what is chosen.
    #[default]
    Choose,
    /// Cuts branches.
    Prune,
    /// Sets things.
    Place(Kind),
    /// Sows a plant, by its number, again elsewhere.
    Resow(u32),
}

/// Whether things are set down on the ground when they are let go of near it.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq)]
pub struct Snapping(pub bool);

impl Default for Snapping {
    fn default() -> Self {
        Self(true)
    }
}

/// Where the camera looks from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewFrom {
    /// South.
    Front,
    /// East.
    Side,
    /// Above.
    Top,
}

/// Organs that the next click or the thing being dragged would shed, by birth number.
#[derive(Resource, Debug, Default)]
pub struct Doomed(pub Vec<u32>);

/// Short messages, newest last.
#[derive(Resource, Debug, Default)]
pub struct Toasts(Vec<Toast>);

/// A short message.
#[derive(Debug, Clone)]
pub struct Toast {
    /// What it says.
    pub text: String,
    /// Whether something did not work.
    pub bad: bool,
    since: Instant,
}

impl Toasts {
    /// How long a message stays; one that something did not work stays twice as long.
    const STAYS: Duration = Duration::from_secs(5);

    /// Tells something.
    pub fn tell(&mut self, text: impl Into<String>) {
        self.push(text.into(), false);
    }

    /// Tells that something did not work, and why.
    pub fn warn(&mut self, text: impl ToString) {
        self.push(text.to_string(), true);
    }

    fn push(&mut self, text: String, bad: bool) {
        self.0.retain(|toast| toast.text != text);
        self.0.push(Toast { text, bad, since: Instant::now() });
        if self.0.len() > 6 {
            self.0.remove(0);
        }
    }

    /// Those that are still to be read.
    pub fn current(&mut self) -> &[Toast] {
        self.0.retain(|toast| toast.since.elapsed() < Self::STAYS * if toast.bad { 2 } else { 1 });
        &self.0
    }
}
