//! The growth step: what happens, in order, each time a plant grows by one step.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Which parts of the model run (figure 1 a to d of Lam & King), a resource.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Reflect, Serialize, Deserialize)]
#[reflect(Resource)]
#[serde(default, deny_unknown_fields)]
pub struct Mechanisms {
    /// Buds grow towards light, leaves earn by it; off: everything counts as fully lit.
    pub light: bool,
    /// Buds grow towards space; off: everything counts as free.
    pub space: bool,
    /// Growth needs energy; off: every bud and leaf has all it can use, nothing is paid or shed.
    pub energy: bool,
}

impl Default for Mechanisms {
    fn default() -> Self {
        Self { light: true, space: true, energy: true }
    }
}
