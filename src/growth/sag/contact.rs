//! Contact: an axis that bends onto another rests on it.
//!
//! Without it the twigs of a limb that sags would come to lie in those of the limb below, a little more each year. Only
//! where axes would lie is looked at, each as thin as when it was new: not the way there, nor wood that has thickened.

use bevy::prelude::*;

use super::Bend;
use crate::environment::segment;
use crate::environment::stem_grid::StemGrid;
use crate::plant::NO_PARENT;

/// Holding some back changes where others go; after a few rounds the rest is let be.
const ROUNDS: u32 = 4;

/// A stem as it would lie.
#[derive(Debug, Clone, Copy, Default)]
struct Lying {
    rotation: Quat,
    from: Vec3,
    to: Vec3,
}

/// Where all stems would lie, were they bent; those without a bend stay at the origin.
fn lie(parents: &[u32], bends: &[Option<Bend>]) -> Vec<Lying> {
    let mut lying = vec![Lying::default(); bends.len()];
    for (i, bend) in bends.iter().enumerate() {
        let Some(bend) = bend else { continue };
        let (below, from) = match parents[i] {
            NO_PARENT => (bend.below(), bend.from()),
            parent => (lying[parent as usize].rotation, lying[parent as usize].to),
        };
        let rotation = (below * bend.bent()).normalize();
        lying[i] = Lying { rotation, from, to: from + rotation * Vec3::Y * bend.length };
    }
    lying
}

/// Of every stem the first of its axis.
fn axes(parents: &[u32], bends: &[Option<Bend>]) -> Vec<u32> {
    let mut axis: Vec<u32> = (0..bends.len() as u32).collect();
    for (i, &parent) in parents.iter().enumerate().filter(|(_, parent)| **parent != NO_PARENT) {
        if let (Some(stem), Some(below)) = (&bends[i], &bends[parent as usize])
            && stem.order == below.order
        {
            axis[i] = axis[parent as usize];
        }
    }
    axis
}

/// Holds still the axes whose bending would bring them to lie in another that they do not touch yet; what bears them
/// may bend on.
pub fn rest(parents: &[u32], bends: &mut [Option<Bend>]) {
    let moves = |bend: &Bend| bend.turn != Vec3::ZERO;
    if !bends.iter().flatten().any(|bend| moves(bend) && bend.keeps_off.is_some()) {
        return;
    }
    let axis = axes(parents, bends);
    let cell = bends.iter().flatten().map(|bend| bend.length).fold(0.05, f32::max);
    for _ in 0..ROUNDS {
        let lying = lie(parents, bends);
        let mut grid = StemGrid::<(usize, f32)>::new(cell);
        let mut held = vec![false; bends.len()];
        for (i, stem) in bends.iter().enumerate() {
            let Some(stem) = stem else { continue };
            let Some(radius) = stem.keeps_off else { continue };
            let here = lying[i];
            let girth = Vec3::splat(radius);
            for &(j, thin) in grid.near(here.from.min(here.to) - girth, here.from.max(here.to) + girth) {
                let meet_at_node = parents[i] == parents[j] || parents[i] == j as u32;
                let Some(other) = bends[j].as_ref().filter(|_| axis[i] != axis[j] && !meet_at_node) else {
                    continue;
                };
                let near = radius + thin;
                let there = lying[j];
                if segment::gap((here.from, here.to), (there.from, there.to)) < near
                    && segment::gap((stem.from(), stem.to()), (other.from(), other.to())) >= near
                {
                    held[axis[i] as usize] = true;
                    held[axis[j] as usize] = true;
                }
            }
            grid.add((i, radius), here.from, here.to, radius);
        }
        if !held.contains(&true) {
            return;
        }
        for (bend, &axis) in bends.iter_mut().zip(&axis) {
            if let Some(bend) = bend.as_mut().filter(|_| held[axis as usize]) {
                bend.turn = Vec3::ZERO;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use core::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::plant::Pose;

    /// Two level twigs on a trunk, one over the other; the upper one bends by `turn` at its base.
    fn twigs(turn: f32, keeps_off: Option<f32>) -> (Vec<u32>, Vec<Option<Bend>>) {
        let trunk = |from: f32| Bend {
            pose: Pose { position: Vec3::Y * from, rotation: Quat::IDENTITY },
            length: 0.1,
            radius: 0.05,
            keeps_off,
            ..default()
        };
        let level = Quat::from_rotation_z(-FRAC_PI_2);
        let twig = |height: f32, turn: f32| Bend {
            turn: Vec3::NEG_Z * turn,
            pose: Pose { position: Vec3::Y * height, rotation: level },
            attachment: level,
            length: 1.0,
            radius: 0.004,
            order: 1,
            keeps_off,
        };
        let bends = [trunk(0.0), trunk(0.1), twig(0.1, 0.0), twig(0.2, turn)].map(Some).to_vec();
        (vec![NO_PARENT, 0, 0, 1], bends)
    }

    /// By how much the upper twig bends after all, with the lower one turned aside by `aside`.
    fn bent(turn: f32, aside: f32, keeps_off: Option<f32>) -> f32 {
        let (parents, mut bends) = twigs(turn, keeps_off);
        let lower = bends[2].as_mut().unwrap();
        lower.attachment = Quat::from_rotation_y(aside) * lower.attachment;
        lower.pose.rotation = lower.attachment;
        rest(&parents, &mut bends);
        bends[3].unwrap().turn.length()
    }

    #[test]
    fn a_twig_that_bends_onto_another_rests_on_it() {
        // A metre long and a tenth of a metre above the other: its end comes down to it at 0.1 rad.
        let (parents, bends) = twigs(0.3, None);
        assert!((lie(&parents, &bends)[3].to.y - (0.2 - bevy::math::ops::sin(0.3))).abs() < 1e-5);
        assert_eq!(bent(0.09, 0.0, Some(0.004)), 0.09, "it does not come down to it");
        assert_eq!(bent(0.3, 0.0, Some(0.004)), 0.0, "it would pass through it");
        assert_eq!(bent(0.3, 0.2, Some(0.004)), 0.3, "it passes beside it");
        assert_eq!(bent(0.3, 0.0, None), 0.3, "off");
    }

    #[test]
    fn twigs_that_touch_already_may_part() {
        assert_eq!(bent(-0.2, 0.0, Some(0.06)), 0.2);
        assert_eq!(bent(0.2, 0.0, Some(0.06)), 0.2, "nor are they held in each other's way");
    }
}
