//! **Burgeon grows trees.** Every bud, internode and leaf is an entity; each growth step the tree makes new
//! organs, settles its energy, and looks at the light and space around every bud before it grows on.
//!
//! ```text
//!            ┌──────────────────────────────────────────────────────────────────────┐
//!            ▼                                                                      │
//!   ┌─ Generate ──────────┐   ┌─ Update ─────────────┐   ┌─ Sense ───────────────┐  │
//!   │ wake lateral buds   │   │ photosynthesise      │   │ gather what is there  │  │
//!   │ extend shoots       │──▶│ pay upkeep           │──▶│ look around: light    │──┘
//!   │ form nodes, unfold  │   │ shed liabilities     │   │  and space at each bud│
//!   │ thicken wood        │   │ share the surplus    │   │ choose where to grow  │
//!   └─────────────────────┘   └──────────────────────┘   └───────────────────────┘
//!        organs                     energy                      environment
//! ```
//!
//! That is the loop of Lam & King, and the module [`growth`] shows it whole, in order. Burgeon is a Bevy plugin
//! without clock, window or GPU: the host runs a step whenever it wants one.
//!
//! ```
//! use bevy::prelude::*;
//! use burgeon::prelude::*;
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let mut app = App::new();
//!     app.add_plugins((MinimalPlugins, BurgeonPlugins));
//!     let oak = Species::named("oak")?;
//!     app.world_mut().spawn((Plant::new(oak, 7), Transform::from_xyz(0.0, 0.0, 0.0)));
//!     app.world_mut().spawn((Solid::block(Vec3::new(4.0, 2.0, 0.2)), Transform::from_xyz(0.0, 1.0, -0.5)));
//!     grow(app.world_mut(), 5);
//!     let snapshot = Snapshot::take(app.world());
//!     println!("{} organs after {} steps", snapshot.len(), snapshot.step);
//!     # assert!(snapshot.len() > 20 && snapshot.step == 5);
//!     Ok(())
//! }
//! ```
//!
//! # Where things are
//!
//! | to | see |
//! |---|---|
//! | read the growth step, add a system of your own to it | [`growth`] |
//! | grow in a game without a frame that waits | [`growth::parts`] |
//! | know what an organ carries, read a whole plant | [`plant`], [`Snapshot`](plant::Snapshot) |
//! | change a kind of plant, or make one | [`species`], [`Species::from_ron`](species::Species::from_ron) |
//! | set walls, lamps, sky and sun | [`Solid`](environment::Solid), [`Lamp`](environment::Lamp), [`Sky`](environment::Sky), [`Sun`](environment::Sun) |
//! | grow a scenario from a file, edit it, save and resume it | [`scenario`], [`files`], [`assets`] |
//! | write pictures, films, glTF models and tables | [`export`] |
//! | see the figures of the papers grown and measured | [`reproduce`] |
//!
//! # Same input, same tree
//!
//! Bit for bit: on any number of threads, in debug and release, whatever else lives in the world. Organs are
//! walked in order of birth ([`Roster`](plant::Roster)); every random draw comes from a stream seeded by the
//! plant's seed, the organ's lineage, the step and the purpose ([`chance`]); maths functions are
//! [`bevy::math::ops`] with Bevy's `libm`.
//!
//! # Features
//!
//! | feature | adds |
//! |---|---|
//! | none | the core: everything on this page |
//! | `assets` | species and scenarios as assets of a Bevy app (`assets::PlantAssetPlugin`) |
//! | `hot_reload` | `assets`, read again when their files change on disk |
//! | `render` | `assets`, and plants drawn in any Bevy app |
//! | `cli` | the command line, `burgeon` |
//! | `viewer` (default) | `render`, `cli` and the window |
//!
//! # Limits
//!
//! Organs, steps, threads, file sizes and nesting have limits, all in [`limits`].

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod assets;
pub mod chance;
pub mod environment;
pub mod export;
pub mod files;
pub mod growth;
pub mod limits;
pub mod plant;
#[cfg(feature = "render")]
pub mod render;
pub mod reproduce;
pub mod scenario;
pub mod shape;
pub mod species;
pub mod tropism;
#[cfg(feature = "viewer")]
pub mod viewer;

use bevy::app::PluginGroupBuilder;
use bevy::prelude::*;

pub use growth::grow;

/// All of Burgeon's core: plants, the growth step and the environment. Adds no clock, window or renderer.
pub struct BurgeonPlugins;

impl PluginGroup for BurgeonPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(plant::PlantPlugin)
            .add(environment::plugin::EnvironmentPlugin)
            .add(growth::GrowthPlugin)
    }
}

/// What most programs need.
pub mod prelude {
    pub use crate::BurgeonPlugins;
    pub use crate::environment::probe::Sensing;
    pub use crate::environment::workers::Workers;
    pub use crate::environment::{Ground, Lamp, Sky, SkyGradient, Solid, SolidShape, Sun};
    pub use crate::growth::generation::BudBroke;
    pub use crate::growth::{GrowthStep, Mechanisms, Stage, StepCount, grow};
    pub use crate::plant::{
        Allotment, ApicalBud, Bears, BranchOrder, Cause, EnergyFlow, EnergyLedger, EnergyStore, Exposure,
        GrowsFrom, GrowthSpan, GrowthTarget, Identity, Internode, LateralBud, LateralBudState, Leaf,
        LeafState, Node, OrganKind, OrganShed, OrganState, Plant, Pose, Roster, Snapshot,
    };
    pub use crate::scenario::{Edit, Garden, Scenario};
    pub use crate::species::Species;
}

/// The README's own code, run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
