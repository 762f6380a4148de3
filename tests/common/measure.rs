//! Measures of grown plants.

use bevy::prelude::*;
use burgeon::plant::{OrganKind, Snapshot};

/// Mean of the middles of all stem segments of a plant.
pub fn wood_centroid(shot: &Snapshot, plant: u32) -> Vec3 {
    mean_position(shot, |i| shot.plant[i] == plant && shot.state[i].kind() == OrganKind::Internode)
}

/// Mean place of all leaves.
pub fn crown_centroid(shot: &Snapshot) -> Vec3 {
    mean_position(shot, |i| shot.state[i].kind() == OrganKind::Leaf)
}

/// Mean place (middle for stems) of chosen organs.
pub fn mean_position(shot: &Snapshot, chosen: impl Fn(usize) -> bool) -> Vec3 {
    let chosen: Vec<usize> = (0..shot.len()).filter(|&i| chosen(i)).collect();
    let sum: Vec3 = chosen.iter().map(|&i| shot.pose[i].tip(0.5 * shot.length(i))).sum();
    sum / chosen.len().max(1) as f32
}

/// How many organs of a kind live.
pub fn count(shot: &Snapshot, kind: OrganKind) -> usize {
    shot.state.iter().filter(|s| s.kind() == kind).count()
}

/// The median of some numbers.
pub fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
