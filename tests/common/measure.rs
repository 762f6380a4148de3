//! Measures of grown plants.

use bevy::prelude::*;
use burgeon::plant::{NO_PARENT, OrganKind, OrganState, Snapshot};

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

/// Spearman's rank correlation, ties sharing their mean rank; 0 if either side is all the same.
pub fn rank_correlation(pairs: &[(f32, f32)]) -> f64 {
    let x = ranks(&pairs.iter().map(|p| p.0).collect::<Vec<_>>());
    let y = ranks(&pairs.iter().map(|p| p.1).collect::<Vec<_>>());
    let mean = (pairs.len() as f64 + 1.0) / 2.0;
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(&y) {
        xy += (x - mean) * (y - mean);
        xx += (x - mean) * (x - mean);
        yy += (y - mean) * (y - mean);
    }
    if xx * yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }
}

fn ranks(values: &[f32]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    while from < order.len() {
        let tied = order[from..].iter().take_while(|&&i| values[i] == values[order[from]]).count();
        for &i in &order[from..from + tied] {
            ranks[i] = from as f64 + (tied as f64 + 1.0) / 2.0;
        }
        from += tied;
    }
    ranks
}

/// Pairs of stem segments of different axes that run into each other and share no node.
pub fn collisions(shot: &Snapshot) -> usize {
    collisions_of(shot, f32::MAX)
}

/// [`collisions`] of stems taken no thicker than a radius.
pub fn collisions_of(shot: &Snapshot, most: f32) -> usize {
    struct Stem {
        index: usize,
        low: Vec3,
        high: Vec3,
        radius: f32,
    }
    let mut stems: Vec<Stem> = (0..shot.len())
        .filter_map(|index| {
            let OrganState::Internode(wood, _) = &shot.state[index] else { return None };
            let (a, b) = (shot.pose[index].position, shot.pose[index].tip(wood.length));
            let girth = Vec3::splat(wood.radius);
            Some(Stem { index, low: a.min(b) - girth, high: a.max(b) + girth, radius: wood.radius.min(most) })
        })
        .collect();
    stems.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    let axis = axes(shot);
    let segment = |s: &Stem| (shot.pose[s.index].position, shot.pose[s.index].tip(shot.length(s.index)));
    let mut pairs = 0;
    for (k, a) in stems.iter().enumerate() {
        for b in stems[k + 1..].iter().take_while(|b| b.low.x <= a.high.x) {
            let apart = a.low.cmpgt(b.high).any() || b.low.cmpgt(a.high).any();
            if apart || axis[a.index] == axis[b.index] || adjacent(shot, a.index, b.index) {
                continue;
            }
            pairs += usize::from(distance(segment(a), segment(b)) < a.radius + b.radius);
        }
    }
    pairs
}

/// Whether two stem segments share a node.
fn adjacent(shot: &Snapshot, a: usize, b: usize) -> bool {
    shot.parent[a] == shot.parent[b] || shot.parent[a] as usize == b || shot.parent[b] as usize == a
}

/// For every organ, the first stem of the axis it belongs to.
pub fn axes(shot: &Snapshot) -> Vec<usize> {
    let mut axis: Vec<usize> = (0..shot.len()).collect();
    for i in 0..shot.len() {
        let p = shot.parent[i];
        if p != NO_PARENT && shot.order[p as usize] == shot.order[i] {
            axis[i] = axis[p as usize];
        }
    }
    axis
}

/// Least distance between two segments.
pub fn distance((p, p1): (Vec3, Vec3), (q, q1): (Vec3, Vec3)) -> f32 {
    let (d, e, r) = (p1 - p, q1 - q, p - q);
    let (dd, ee, de, dr, er) = (d.dot(d), e.dot(e), d.dot(e), d.dot(r), e.dot(r));
    let apart = dd * ee - de * de;
    let mut s = if apart > 1e-12 { ((de * er - dr * ee) / apart).clamp(0.0, 1.0) } else { 0.0 };
    let t = ((de * s + er) / ee).clamp(0.0, 1.0);
    s = ((de * t - dr) / dd).clamp(0.0, 1.0);
    (p + d * s).distance(q + e * t)
}
