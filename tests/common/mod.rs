//! What the tests share: gardens, organs set by hand, invariants and measures.

#![allow(dead_code, reason = "each test file uses a part of it")]

pub mod by_hand;
pub mod check;
pub mod measure;
pub mod skeletons;

use std::ops::Range;

use burgeon::assets::Library;
use burgeon::environment::workers::Workers;
use burgeon::files::ResolvedScenario;
use burgeon::scenario::{Garden, Scenario};
use burgeon::species::Species;

/// A shipped scenario as it is.
pub fn shipped(name: &str) -> ResolvedScenario {
    Library::embedded().scenario(name).unwrap()
}

/// A shipped scenario that looks around through small faces, to be quick.
pub fn quick(name: &str) -> ResolvedScenario {
    let mut resolved = shipped(name);
    resolved.scenario.sensing.leaf_face = 4;
    resolved.scenario.sensing.bud_face = 6;
    resolved
}

/// Looks around through the smallest faces, which takes little time.
pub fn coarse(mut resolved: ResolvedScenario) -> ResolvedScenario {
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 4;
    resolved
}

/// One small plant in the open, looking around through the smallest faces.
pub fn pot(species: Species) -> ResolvedScenario {
    let mut resolved = quick("figure_1c");
    resolved.scenario = Scenario { sensing: resolved.scenario.sensing, ..Scenario::default() };
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 2;
    resolved.species = [("lam_king".to_string(), species)].into();
    resolved
}

/// The same with shoots that go just where they chose to, at once.
pub fn steered_directly(mut resolved: ResolvedScenario) -> ResolvedScenario {
    for species in resolved.species.values_mut() {
        species.steering_lag = 0;
        species.compensation_ratio = 1.0;
        species.sensing_error_deg = 0.0;
        species.wander_deg = 0.0;
    }
    resolved
}

/// A scenario set out, on the calling thread alone.
pub fn garden(resolved: ResolvedScenario, seed: u64) -> Garden {
    Garden::new(resolved, seed, Workers::new(1).unwrap()).unwrap()
}

/// A scenario grown by a number of steps.
pub fn grown(resolved: ResolvedScenario, seed: u64, steps: u32) -> Garden {
    let mut garden = garden(resolved, seed);
    for _ in 0..steps {
        garden.step().unwrap();
    }
    garden
}

/// Does a task for every seed, in parallel; results in the order of seeds.
pub fn over_seeds<T: Send>(seeds: Range<u64>, task: impl Fn(u64) -> T + Sync) -> Vec<T> {
    let first = seeds.start;
    Workers::default().map(seeds.count(), |i| task(first + i as u64))
}
