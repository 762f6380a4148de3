//! Skeletons to vary, for tests and benchmarks.

use bevy::prelude::*;
use burgeon::plant::skeleton::Skeleton;

/// A trunk of a hundred segments with an arched side branch at every fifth: 500 internodes.
pub fn five_hundred_internodes() -> Skeleton {
    let mut plant = Skeleton::default();
    let up = |k: usize| Vec3::new(0.0, 0.05 * k as f32, 0.0);
    let trunk = plant.add_stem(None, &(0..=100).map(up).collect::<Vec<_>>(), [0.04, 0.01]);
    for k in (0..100).step_by(5) {
        let side = Quat::from_rotation_y(2.4 * k as f32) * Vec3::X;
        let arch = |j: usize| up(k + 1) + (side + Vec3::Y * (0.4 - 0.02 * j as f32)) * 0.05 * j as f32;
        let branch = plant.add_stem(Some(trunk[k]), &(0..=20).map(arch).collect::<Vec<_>>(), [0.01, 0.004]);
        plant.add_leaf(branch[19], side, 1.0);
    }
    plant
}
