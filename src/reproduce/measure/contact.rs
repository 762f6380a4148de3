//! Where stems of one plant meet although they do not grow from each other.

use bevy::platform::collections::HashSet;
use bevy::prelude::*;

use crate::environment::segment;
use crate::plant::{NO_PARENT, OrganState, Snapshot};
use crate::species::Species;

/// Pairs of internodes that run into each other although they do not meet at a node (`LK-17`).
pub fn collisions(shot: &Snapshot) -> usize {
    let stems = stems(shot);
    meetings(&stems).filter(|&(a, b)| !meet_at_node(&stems[a], &stems[b])).count()
}

/// Pairs of internodes of two axes that run through each other, by what they do it as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tangles {
    /// As twigs: each taken no thicker than it began, and farther than three node spacings apart along the wood.
    pub of_twigs: usize,
    /// As wood alone: the middle of one lies in the other, as thick as it has become, and they have not grown together
    /// from a node or a swallowed foot on.
    pub of_wood: usize,
}

impl Tangles {
    /// All of them.
    pub fn all(self) -> usize {
        self.of_twigs + self.of_wood
    }
}

/// Counts the pairs of internodes that run through each other.
pub fn tangles(shot: &Snapshot) -> Tangles {
    let axis = axes(shot);
    let most = |of: fn(&Species) -> f32| {
        shot.plants.iter().flatten().map(|plant| of(&plant.species)).fold(0.0, f32::max)
    };
    let (twig, near) = (most(|species| species.twig_radius_m), 3.0 * most(|species| species.node_spacing_m));
    let stems = stems(shot);
    let met: Vec<(usize, usize)> = meetings(&stems).collect();
    let together = grown_together(shot, &stems, &met, &axis);
    let mut tangles = Tangles::default();
    for (a, b) in met.into_iter().map(|(a, b)| (&stems[a], &stems[b])) {
        if axis[a.index as usize] == axis[b.index as usize] || meet_at_node(a, b) {
            continue;
        }
        let gap = a.gap(b);
        let as_twigs = gap < a.radius.min(twig) + b.radius.min(twig);
        if as_twigs && way_between(shot, a.index, b.index, near) > near {
            tangles.of_twigs += 1;
        } else if gap < a.radius.max(b.radius) && !together.contains(&pair(a.index, b.index)) {
            tangles.of_wood += 1;
        }
    }
    tangles
}

/// A stem segment.
struct Stem {
    from: Vec3,
    to: Vec3,
    radius: f32,
    low: Vec3,
    high: Vec3,
    index: u32,
    parent: u32,
}

impl Stem {
    fn gap(&self, other: &Self) -> f32 {
        segment::gap((self.from, self.to), (other.from, other.to))
    }

    fn holds(&self, place: Vec3) -> bool {
        segment::gap((place, place), (self.from, self.to)) < self.radius
    }
}

/// All stems, by where they begin along x.
fn stems(shot: &Snapshot) -> Vec<Stem> {
    let stem = |(i, state): (usize, &OrganState)| {
        let OrganState::Internode(wood, _) = state else { return None };
        let (from, to) = (shot.pose[i].position, shot.pose[i].tip(wood.length));
        let girth = Vec3::splat(wood.radius);
        let (low, high) = (from.min(to) - girth, from.max(to) + girth);
        Some(Stem { from, to, radius: wood.radius, low, high, index: i as u32, parent: shot.parent[i] })
    };
    let mut stems: Vec<Stem> = shot.state.iter().enumerate().filter_map(stem).collect();
    stems.sort_by(|a, b| a.low.x.total_cmp(&b.low.x));
    stems
}

/// Pairs of stems that touch.
fn meetings(stems: &[Stem]) -> impl Iterator<Item = (usize, usize)> {
    stems.iter().enumerate().flat_map(move |(k, a)| {
        let within = (k + 1..stems.len()).take_while(move |&j| stems[j].low.x <= a.high.x);
        within
            .filter(move |&j| {
                let b = &stems[j];
                let apart = a.low.cmpgt(b.high).any() || b.low.cmpgt(a.high).any();
                !apart && a.gap(b) < a.radius + b.radius
            })
            .map(move |j| (k, j))
    })
}

fn meet_at_node(a: &Stem, b: &Stem) -> bool {
    a.parent == b.parent || a.parent == b.index || b.parent == a.index
}

/// Two organs, the earlier first.
fn pair(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// Of the pairs that touch those that have grown together: they meet at a node, or one is the foot of its axis and
/// begins within the other, as where a trunk has thickened over the foot of a limb and what springs from it; or stems
/// next to them have.
fn grown_together(
    shot: &Snapshot,
    stems: &[Stem],
    met: &[(usize, usize)],
    axis: &[u32],
) -> HashSet<(u32, u32)> {
    let mut borne: Vec<Vec<u32>> = vec![Vec::new(); shot.len()];
    for stem in stems.iter().filter(|stem| stem.parent != NO_PARENT) {
        borne[stem.parent as usize].push(stem.index);
    }
    // What a stem meets at its nodes.
    let beside = |i: u32| {
        let below = shot.parent[i as usize];
        let siblings = if below == NO_PARENT { &[][..] } else { &borne[below as usize] };
        let below = (below != NO_PARENT).then_some(below);
        borne[i as usize].iter().chain(siblings).copied().chain(below).filter(move |&other| other != i)
    };
    let touching: HashSet<(u32, u32)> =
        met.iter().map(|&(a, b)| pair(stems[a].index, stems[b].index)).collect();
    let foot_in = |a: &Stem, b: &Stem| axis[a.index as usize] == a.index && b.holds(a.from);
    let from_the_start = met
        .iter()
        .map(|&(a, b)| (&stems[a], &stems[b]))
        .filter(|&(a, b)| meet_at_node(a, b) || foot_in(a, b) || foot_in(b, a));
    let mut open: Vec<(u32, u32)> = from_the_start.map(|(a, b)| pair(a.index, b.index)).collect();
    let mut together: HashSet<(u32, u32)> = open.iter().copied().collect();
    while let Some((a, b)) = open.pop() {
        for next in beside(a).map(|a| pair(a, b)).chain(beside(b).map(|b| pair(a, b))) {
            if touching.contains(&next) && together.insert(next) {
                open.push(next);
            }
        }
    }
    together
}

/// For every organ, the first stem of the axis it belongs to.
fn axes(shot: &Snapshot) -> Vec<u32> {
    let mut axis: Vec<u32> = (0..shot.len() as u32).collect();
    for i in 0..shot.len() {
        let parent = shot.parent[i];
        if parent != NO_PARENT && shot.order[parent as usize] == shot.order[i] {
            axis[i] = axis[parent as usize];
        }
    }
    axis
}

/// Length of wood between two stems, metres, through what both grow from, as far as it is no longer than `most`.
fn way_between(shot: &Snapshot, a: u32, b: u32, most: f32) -> f32 {
    let (mut a, mut b, mut way) = (a, b, 0.0);
    while a != b && way <= most {
        // Parents come first: the later-born of two is the one farther out.
        let (farther, other) = if a > b { (&mut a, b) } else { (&mut b, a) };
        *farther = match shot.parent[*farther as usize] {
            NO_PARENT => return f32::INFINITY,
            below => below,
        };
        // Neither the stems themselves nor the one both grow from: only what is between them.
        if *farther != other {
            way += shot.length(*farther as usize);
        }
    }
    way
}
