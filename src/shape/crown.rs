//! Crowns: where the middle of a plant's leaves is, and normals rounded about it for soft shading.

use bevy::prelude::*;

use crate::plant::{OrganState, Snapshot};

/// How far leaf normals turn from the blade's own to the crown's, as in `plants.wgsl`.
const ROUND: f32 = 0.55;

/// The leaves of a plant as one round body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Crown {
    /// Mean place of its leaves, metres.
    pub middle: Vec3,
    /// How far leaves are from it on average, metres; 0 without leaves.
    pub spread: f32,
}

impl Crown {
    /// The crown of each plant, by its index in [`Snapshot::plants`].
    pub fn of(snapshot: &Snapshot) -> Vec<Self> {
        let mut crowns = vec![Self::default(); snapshot.plants.len()];
        let mut counts = vec![0.0_f32; snapshot.plants.len()];
        let leaves = || {
            snapshot.state.iter().enumerate().filter_map(|(i, state)| match state {
                OrganState::Leaf(_) => Some((snapshot.plant[i] as usize, snapshot.pose[i].position)),
                _ => None,
            })
        };
        for (plant, position) in leaves() {
            if let (Some(crown), Some(count)) = (crowns.get_mut(plant), counts.get_mut(plant)) {
                crown.middle += position;
                *count += 1.0;
            }
        }
        for (crown, count) in crowns.iter_mut().zip(&counts) {
            crown.middle /= count.max(1.0);
        }
        for (plant, position) in leaves() {
            if let (Some(crown), Some(count)) = (crowns.get_mut(plant), counts.get(plant)) {
                crown.spread += position.distance(crown.middle) / count.max(1.0);
            }
        }
        crowns
    }

    /// Unit vector outward from the crown at a place, a little up.
    pub fn outward(&self, at: Vec3) -> Vec3 {
        let out = (at - self.middle) * Vec3::new(1.0, 1.25, 1.0);
        (out + Vec3::Y * (0.35 * self.spread + 0.01)).normalize_or(Vec3::Y)
    }

    /// The normal of a blade (unit vector) at a place, turned towards outward.
    pub fn round(&self, at: Vec3, normal: Vec3) -> Vec3 {
        normal.lerp(self.outward(at), ROUND).try_normalize().unwrap_or(normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_turn_outward_and_stay_unit() {
        let crown = Crown { middle: Vec3::Y * 3.0, spread: 1.0 };
        for at in [Vec3::new(2.0, 3.0, 0.0), Vec3::new(-1.0, 4.0, 1.0), Vec3::Y * 3.0, Vec3::ZERO] {
            let normal = crown.round(at, Vec3::Y);
            assert!((normal.length() - 1.0).abs() < 1e-6);
            assert!(normal.dot(crown.outward(at)) >= Vec3::Y.dot(crown.outward(at)) - 1e-6);
        }
        assert!(crown.round(Vec3::new(2.0, 3.0, 0.0), Vec3::Y).x > 0.5);
    }
}
