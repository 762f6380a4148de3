//! How shoots steer: the feedback controller (`ST-5`).

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// State of the controller that steers a growing bud: corrections on their way, oldest first.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct Steering {
    /// Sub-steps steered so far.
    pub substeps: u32,
}

/// How a species steers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// Share of the sensed error corrected at each sub-step.
    pub gain: f32,
    /// Sub-steps until a correction takes effect.
    pub lag: u32,
}

/// One sub-step: the heading after steering from `heading` towards `target` (unit vectors).
///
/// With gain 1 and lag 0, as now for every species, the heading reaches its target at once.
pub fn step(_control: &Control, steering: &mut Steering, heading: Vec3, target: Vec3) -> Vec3 {
    steering.substeps += 1;
    let _ = heading;
    target
}
