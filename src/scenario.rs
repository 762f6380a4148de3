//! What stands where: plants, walls, lamps, sky, ground, and the edits of a run.

mod autosave;
mod edit;
mod fixtures;
mod garden;
mod gardener;
pub(crate) mod place;
mod preview;
mod saved;
mod timeline;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use crate::environment::probe::Sensing;
use crate::environment::{Shore, Sky, SolidShape};
use crate::growth::Mechanisms;
use crate::species::parameter::Color;

pub use autosave::{Autosave, KeptSession, Sessions};
pub use edit::{Edit, EditError, EditOutcome, TimedEdit, apply, crush};
pub use fixtures::{Fixture, FixtureError, Fixtures};
pub use garden::{Garden, GardenError, GardenSave, GardenSaveError};
pub use gardener::{
    Ending, Explained, Gardener, GardenerError, GardenerSettings, Gone, News, Order, Progress,
};
pub use place::{RunSeed, SpeciesBook};
pub use preview::{borne_by, crushed_by, is_covered};
pub use saved::{History, SavedRun};
pub use timeline::{Ghost, Moment, Timeline, TimelineError, View, Visit, Why};

/// A plant in its place.
#[derive(Debug, Clone, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Planting {
    /// Name of its species.
    pub species: String,
    /// Where its seed lies, metres.
    pub at: Vec3,
    /// Turn about the vertical, degrees.
    pub turn_deg: f32,
    /// Lean of its seedling, degrees, towards +z before it is turned.
    pub tilt_deg: f32,
    /// Added to the seed of the run.
    pub seed: u64,
}

impl Default for Planting {
    fn default() -> Self {
        Self { species: "lam_king".into(), at: Vec3::ZERO, turn_deg: 0.0, tilt_deg: 0.0, seed: 0 }
    }
}

/// A solid in its place.
#[derive(Debug, Clone, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlacedSolid {
    /// Name by which edits find it.
    pub name: String,
    /// Its form.
    pub shape: SolidShape,
    /// Its centre, metres.
    pub at: Vec3,
    /// Turn about the vertical, degrees.
    pub turn_deg: f32,
    /// Colour in pictures.
    pub color: Color,
}

impl Default for PlacedSolid {
    fn default() -> Self {
        Self {
            name: "wall".into(),
            shape: SolidShape::Box { size: Vec3::new(4.0, 2.0, 0.2) },
            at: Vec3::new(0.0, 1.0, -1.0),
            turn_deg: 0.0,
            color: Color::hex(0xB4_9C_84),
        }
    }
}

/// A lamp in its place.
#[derive(Debug, Clone, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlacedLamp {
    /// Name by which edits find it.
    pub name: String,
    /// Its centre, metres.
    pub at: Vec3,
    /// Radiance of its surface, as a multiple of a full sky's.
    pub strength: f32,
    /// Radius, metres.
    pub radius: f32,
    /// Whether it burns.
    pub on: bool,
    /// Colour in pictures.
    pub color: Color,
}

impl Default for PlacedLamp {
    fn default() -> Self {
        Self {
            name: "lamp".into(),
            at: Vec3::new(2.0, 2.0, 0.0),
            strength: 100.0,
            radius: 0.2,
            on: true,
            color: Color::hex(0xFF_D0_90),
        }
    }
}

/// Where the sun stands.
#[derive(Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlacedSun {
    /// Degrees above the horizon.
    pub elevation_deg: f32,
    /// Degrees from +z (south) towards +x (east).
    pub azimuth_deg: f32,
    /// Light it gives a point it reaches; 1 alone saturates an exposure.
    pub strength: f32,
}

impl Default for PlacedSun {
    fn default() -> Self {
        Self { elevation_deg: 50.0, azimuth_deg: 30.0, strength: 0.5 }
    }
}

/// A scenario: what stands where at the start, and what is changed at which step.
#[derive(Debug, Clone, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// Version of the file format.
    pub version: u32,
    /// Its name.
    pub name: String,
    /// What it shows, for people.
    pub description: String,
    /// Steps that show it well.
    pub steps: u32,
    /// Plants.
    pub plants: Vec<Planting>,
    /// Walls and the like.
    pub solids: Vec<PlacedSolid>,
    /// Lamps.
    pub lamps: Vec<PlacedLamp>,
    /// The sky.
    pub sky: Sky,
    /// The sun, if it is up.
    pub sun: Option<PlacedSun>,
    /// Whether there is an infinite ground at height 0.
    pub ground: bool,
    /// Where a sea begins, if there is one: in pictures the ground is a beach.
    pub shore: Option<Shore>,
    /// Which parts of the model run (figure 1 a to d).
    pub mechanisms: Mechanisms,
    /// How buds and leaves look around.
    pub sensing: Sensing,
    /// Edits by step.
    pub edits: Vec<TimedEdit>,
}

impl Scenario {
    /// The name of one that has none; one from a file goes by the file's.
    pub const UNNAMED: &'static str = "unnamed";
}

impl Default for Scenario {
    fn default() -> Self {
        Self {
            version: 1,
            name: Self::UNNAMED.into(),
            description: String::new(),
            steps: 20,
            plants: vec![Planting::default()],
            solids: Vec::new(),
            lamps: Vec::new(),
            sky: Sky::default(),
            sun: None,
            ground: true,
            shore: None,
            mechanisms: Mechanisms::default(),
            sensing: Sensing::default(),
            edits: Vec::new(),
        }
    }
}
