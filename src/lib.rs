//! Burgeon grows trees: every bud, internode and leaf is an entity.

pub mod assets;
pub mod chance;
pub mod environment;
pub mod export;
pub mod files;
pub mod growth;
pub mod limits;
pub mod plant;
pub mod scenario;
pub mod shape;
pub mod species;
pub mod tropism;

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
    pub use crate::environment::{Lamp, Sky, Solid, SolidShape, Sun};
    pub use crate::growth::{GrowthStep, Mechanisms, Stage, StepCount, grow};
    pub use crate::plant::{
        Allotment, ApicalBud, Bears, BranchOrder, Exposure, GrowsFrom, Identity, Internode, LateralBud, Leaf,
        Node, Plant, Pose, Roster, Snapshot,
    };
    pub use crate::scenario::{Edit, Scenario};
    pub use crate::species::Species;
}
