//! The root's store and the books it keeps.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Energy in the root (`LK-9`). One unit is what a full-grown leaf earns in a step in full light.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct EnergyStore {
    /// Energy stored.
    pub stored: f64,
    /// Step it germinated in, `None` while it is a seed.
    pub germinated: Option<u32>,
}

impl EnergyStore {
    /// Age of its plant in that step, in steps; 0 for a seed.
    pub fn age(&self, step: u32) -> u32 {
        step.saturating_sub(self.germinated.unwrap_or(step))
    }
}

/// One step's books of a plant: `opened + income = upkeep + growth + lost + closed` (`LK-12`).
///
/// `opened` and `closed` count the store and what lies allotted in organs.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
pub struct EnergyLedger {
    /// Store and allotments when the step began.
    pub opened: f64,
    /// Photosynthesised by leaves.
    pub income: f64,
    /// Paid to stay alive.
    pub upkeep: f64,
    /// Turned into stem, leaves and wood.
    pub growth: f64,
    /// Of `growth`, what thickened wood.
    pub wood: f64,
    /// Gone with shed organs.
    pub lost: f64,
    /// Store and allotments when the step ended.
    pub closed: f64,
    /// Upkeep that could not be paid.
    pub unpaid: f64,
}

impl EnergyLedger {
    /// How far the books are off, relative to what moved through them.
    pub fn imbalance(&self) -> f64 {
        let moved =
            self.opened.abs() + self.income + self.upkeep + self.growth + self.lost + self.closed.abs();
        let error = self.opened + self.income - self.upkeep - self.growth - self.lost - self.closed;
        if moved > 0.0 { (error / moved).abs() } else { 0.0 }
    }
}
