//! Measures of grown plants that the papers' claims are put to.

mod contact;

use bevy::prelude::*;

pub use contact::{Tangles, collisions, tangles};

use crate::environment::obstacles::touches;
use crate::environment::{SolidShape, StandingSolid};
use crate::plant::{NO_PARENT, OrganKind, OrganState, Snapshot};

/// The mean; 0 of nothing.
pub fn mean(values: &[f64]) -> f64 {
    if values.is_empty() { 0.0 } else { values.iter().sum::<f64>() / values.len() as f64 }
}

/// Standard deviation over mean; 0 of nothing.
pub fn spread(values: &[f64]) -> f64 {
    let middle = mean(values);
    let variance = mean(&values.iter().map(|v| (v - middle) * (v - middle)).collect::<Vec<_>>());
    if middle > 0.0 { variance.sqrt() / middle } else { 0.0 }
}

/// Spearman's rank correlation, -1 to 1, ties sharing their mean rank; 0 if either side is all alike.
pub fn rank_correlation(pairs: &[(f32, f32)]) -> f64 {
    let x = ranks(pairs.iter().map(|p| p.0));
    let y = ranks(pairs.iter().map(|p| p.1));
    let middle = (pairs.len() as f64 + 1.0) / 2.0;
    let product =
        |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum() };
    let scale = product(&x, &x) * product(&y, &y);
    if scale > 0.0 { product(&x, &y) / scale.sqrt() } else { 0.0 }
}

fn ranks(values: impl Iterator<Item = f32>) -> Vec<f64> {
    let mut sorted: Vec<(f32, usize)> = values.enumerate().map(|(i, v)| (v, i)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut ranks = vec![0.0; sorted.len()];
    let mut below = 0;
    for tied in sorted.chunk_by(|a, b| a.0 == b.0) {
        for &(_, i) in tied {
            ranks[i] = below as f64 + (tied.len() as f64 + 1.0) / 2.0;
        }
        below += tied.len();
    }
    ranks
}

/// Where each apical bud of one step stood (height, metres) and by how much it grew in the next (metres), in order of
/// birth: 0 for one that did not grow.
pub fn growth(before: &Snapshot, after: &Snapshot) -> Vec<(f32, f32)> {
    let is_new = |i: usize| after.birth[i] >= before.next_birth;
    let is_wood = |i: usize| after.state[i].kind() == OrganKind::Internode;
    let mut shoots: Vec<(f32, f32)> = Vec::new();
    // For every organ, the shoot of this step it is part of.
    let mut part_of = vec![usize::MAX; after.len()];
    for i in 0..after.len() {
        let parent = (after.parent[i] != NO_PARENT).then_some(after.parent[i] as usize);
        if is_new(i) && is_wood(i) {
            let goes_on = parent.filter(|&p| is_new(p) && after.order[p] == after.order[i]);
            part_of[i] = goes_on.map_or(shoots.len(), |p| part_of[p]);
            if goes_on.is_none() {
                shoots.push((after.pose[i].position.y, 0.0));
            }
            shoots[part_of[i]].1 += after.length(i);
        } else if !is_new(i) && after.state[i].kind() == OrganKind::ApicalBud {
            shoots.push((after.pose[i].position.y, 0.0));
        }
    }
    shoots
}

/// How the height of buds goes with what they grow, over the steps of a life.
#[derive(Debug, Default, Clone, Copy)]
pub struct Favour {
    sum: f64,
    buds: f64,
}

impl Favour {
    /// Adds the buds of a step, from [`growth`].
    pub fn add(&mut self, grown: &[(f32, f32)]) {
        self.sum += rank_correlation(grown) * grown.len() as f64;
        self.buds += grown.len() as f64;
    }

    /// The mean rank correlation of a step, each step by the number of its buds: 0 of none.
    pub fn mean(self) -> f64 {
        if self.buds > 0.0 { self.sum / self.buds } else { 0.0 }
    }
}

/// Mean distance of the leaves from the nearest of the solids, metres; 0 without leaves or solids.
pub fn crown_to_wall(shot: &Snapshot, solids: &[StandingSolid]) -> f64 {
    let leaves = (0..shot.len()).filter(|&i| shot.state[i].kind() == OrganKind::Leaf);
    let distances: Vec<f64> = leaves
        .filter_map(|i| solids.iter().map(|s| outside(s, shot.pose[i].position)).reduce(f32::min))
        .map(f64::from)
        .collect();
    mean(&distances)
}

/// Distance of a point from a solid, metres; 0 inside.
fn outside(solid: &StandingSolid, point: Vec3) -> f32 {
    let at = (solid.rotation.inverse() * (point - solid.position)).abs();
    match solid.shape {
        SolidShape::Box { size } => (at - size * 0.5).max(Vec3::ZERO).length(),
        SolidShape::Ball { radius } => (at.length() - radius).max(0.0),
        SolidShape::Cylinder { radius, height } => {
            let side = (Vec2::new(at.x, at.z).length() - radius).max(0.0);
            Vec2::new(side, (at.y - height * 0.5).max(0.0)).length()
        }
    }
}

/// Internodes whose axis passes through a solid.
pub fn passing_through(shot: &Snapshot, solids: &[StandingSolid]) -> usize {
    let through = |i: &usize| match &shot.state[*i] {
        OrganState::Internode(wood, _) => {
            let (from, to) = (shot.pose[*i].position, shot.pose[*i].tip(wood.length));
            solids.iter().any(|solid| touches(solid, from, to, 0.0))
        }
        _ => false,
    };
    (0..shot.len()).filter(through).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_share_ties_and_correlate() {
        assert_eq!(rank_correlation(&[(1.0, 10.0), (2.0, 20.0), (3.0, 500.0)]), 1.0);
        assert_eq!(rank_correlation(&[(1.0, 3.0), (2.0, 2.0), (3.0, 1.0)]), -1.0);
        assert_eq!(rank_correlation(&[(1.0, 7.0), (2.0, 7.0), (3.0, 7.0)]), 0.0);
        // By hand: ranks 1 2.5 2.5 4 against 1 2 3 4.
        let tied = rank_correlation(&[(1.0, 1.0), (2.0, 2.0), (2.0, 3.0), (4.0, 4.0)]);
        assert!((tied - 4.5 / (4.5_f64 * 5.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn spread_is_deviation_over_mean() {
        assert_eq!(spread(&[2.0, 2.0]), 0.0);
        assert_eq!(spread(&[1.0, 3.0]), 0.5);
    }
}
