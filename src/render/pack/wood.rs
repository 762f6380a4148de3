//! Branches as rings: every axis one strip, what falls off it another.

use bevy::prelude::*;

use super::Lot;
use super::union::{NONE, Union, unit};
use crate::plant::OrganState;
use crate::render::record::{Ring, RingState, Window, flags};

/// Widening of the base of an axis, as a multiple of its first radius.
const FLARE: f32 = 1.35;
/// Radius at the tip of an axis that bears no other, as a share of its last internode's.
const TIP: f32 = 0.55;
/// Least radius at the base of an axis drawn with many and with some sides, metres.
const STOUT: [f32; 2] = [0.035, 0.009];

/// Classes of branches, stoutest first.
pub(super) const CLASSES: usize = 3;

/// The internodes of a union as axes.
pub(super) struct Axes {
    /// Index of the first internode of each axis, rising.
    pub(super) starts: Vec<u32>,
    /// For each organ, the internode that continues its axis, or [`NONE`].
    next: Vec<u32>,
    /// For each organ, whether a stem grew from it in the earlier and the later state.
    bears: [Vec<bool>; 2],
}

impl Axes {
    /// An internode continues its parent's axis when it is of the same order and farther along; of several, the
    /// first-born does.
    pub(super) fn of(union: &Union) -> Self {
        let n = union.len();
        let mut axes =
            Self { starts: Vec::new(), next: vec![NONE; n], bears: [vec![false; n], vec![false; n]] };
        for i in 0..n {
            let Some(internode) = union.internode(i) else { continue };
            let p = union.parent[i] as usize;
            let below = if p < n { union.internode(p) } else { None };
            let continues = below.is_some_and(|below| {
                axes.bears[0][p] |= !union.is_new(i);
                axes.bears[1][p] |= !union.is_dying(i);
                internode.height_in_branch > below.height_in_branch
                    && union.order(i) == union.order(p)
                    && axes.next[p] == NONE
            });
            if continues {
                axes.next[p] = i as u32;
            } else {
                axes.starts.push(i as u32);
            }
        }
        axes
    }

    /// The internodes of an axis, base to tip.
    fn walk(&self, start: u32, into: &mut Vec<usize>) {
        into.clear();
        let mut at = start;
        while at != NONE {
            into.push(at as usize);
            at = self.next[at as usize];
        }
    }
}

/// One ring of a strip in one state, before frames are carried along.
#[derive(Debug, Clone, Copy)]
struct Bare {
    center: Vec3,
    direction: Vec3,
    radius: f32,
    along: f32,
}

/// Lays the rings of all axes into the lots of their plants and classes.
pub(super) fn lay_wood(union: &Union, axes: &Axes, lots: &mut [Vec<Lot<Ring>>; CLASSES]) {
    let mut chain = Vec::new();
    for &start in &axes.starts {
        axes.walk(start, &mut chain);
        let plant = union.plant(chain[0]) as usize;
        let radius = union.internode(chain[0]).map_or(0.0, |internode| internode.radius);
        let class = STOUT.iter().position(|&least| radius >= least).unwrap_or(CLASSES - 1);
        let Some(lot) = lots[class].get_mut(plant) else { continue };
        // What falls lies beyond all that stays, since nothing outlives what bears it.
        let living = chain.iter().take_while(|&&i| !union.is_dying(i)).count();
        if living > 0 {
            strip(union, axes, &chain[..living], lot);
        }
        if living < chain.len() {
            falling(union, axes, &chain, living, lot);
        }
    }
}

/// The part of an axis that stays.
fn strip(union: &Union, axes: &Axes, chain: &[usize], lot: &mut Lot<Ring>) {
    let (mut before, mut now) = (Vec::with_capacity(chain.len() + 2), Vec::with_capacity(chain.len() + 2));
    let old = chain.iter().take_while(|&&i| !union.is_new(i)).count();
    rings(union, chain, 1, axes, &mut now);
    rings(union, &chain[..old], 0, axes, &mut before);
    // What is new begins at the tip there was, or for a new axis inside its parent.
    let origin = before.len().checked_sub(2).map(|last| (before[last], before[last + 1]));
    before.truncate(before.len().saturating_sub(1));
    for (k, ring) in now.iter().enumerate().skip(before.len()) {
        let last = k + 1 == now.len();
        before.push(match origin {
            Some((_, apex)) if last => apex,
            Some((tip, _)) => Bare { direction: ring.direction, ..tip },
            None => Bare { center: sprout(union, chain[0]), radius: 0.0, along: 0.0, ..*ring },
        });
    }
    emit(union, chain, chance(union, chain), [&before, &now], 0, lot);
}

/// The part of an axis that goes, as it was.
fn falling(union: &Union, axes: &Axes, chain: &[usize], from: usize, lot: &mut Lot<Ring>) {
    let mut all = Vec::with_capacity(chain.len() + 2);
    rings(union, chain, 0, axes, &mut all);
    let old = &all[from..];
    emit(union, &chain[from..], chance(union, chain), [old, old], flags::DYING, lot);
}

/// Where a new axis begins at the begin of the step.
fn sprout(union: &Union, first: usize) -> Vec3 {
    match union.tip_before.get(union.parent[first] as usize) {
        Some(&tip) => tip,
        None => {
            let (snapshot, i) = union.latest(first);
            snapshot.pose[i].position
        }
    }
}

/// Radius of an internode in the earlier (0) or later (1) state, metres.
fn radius_in(union: &Union, i: usize, state: usize) -> f32 {
    let (snapshot, at) = if state == 0 { union.earliest(i) } else { union.latest(i) };
    match &snapshot.state[at] {
        OrganState::Internode(internode, _) => internode.radius,
        _ => f32::INFINITY,
    }
}

/// The rings of a chain in the earlier (0) or later (1) state: one at its base, one at the tip of each internode,
/// and a point that closes it.
fn rings(union: &Union, chain: &[usize], state: usize, axes: &Axes, into: &mut Vec<Bare>) {
    into.clear();
    let mut along = 0.0;
    let mut bears = false;
    for &i in chain {
        let (snapshot, at) = if state == 0 { union.earliest(i) } else { union.latest(i) };
        let pose = &snapshot.pose[at];
        let (length, radius) = (snapshot.length(at), radius_in(union, i, state));
        let heading = pose.heading();
        match into.last_mut() {
            None => {
                // A side axis begins no wider than what bears it.
                let p = union.parent[i] as usize;
                let widest = if p < union.len() { radius_in(union, p, state) } else { f32::INFINITY };
                let radius = (FLARE * radius).min(widest).max(radius.min(widest));
                into.push(Bare { center: pose.position, direction: heading, radius, along });
            }
            Some(joint) => {
                joint.direction = (joint.direction + heading).try_normalize().unwrap_or(heading);
                joint.radius = 0.5 * (joint.radius + radius);
            }
        }
        along += length;
        into.push(Bare { center: pose.tip(length), direction: heading, radius, along });
        bears = axes.bears[state][i];
    }
    if let Some(tip) = into.last_mut() {
        if !bears {
            tip.radius *= TIP;
        }
        let apex = Bare {
            center: tip.center + tip.direction * tip.radius,
            radius: 0.0,
            along: tip.along + tip.radius,
            ..*tip
        };
        into.push(apex);
    }
}

/// The number of an axis, which stays as it grows: the greater, the sooner it is left out at a distance; a stem last.
fn chance(union: &Union, chain: &[usize]) -> f32 {
    if union.order(chain[0]) == 0 { 0.0 } else { unit(union.lineage(chain[0])) }
}

/// Adds a strip: `before` and `now` hold a base, a ring an internode of `chain`, and an apex.
fn emit(
    union: &Union,
    chain: &[usize],
    chance: f32,
    [before, now]: [&[Bare]; 2],
    extra: u32,
    lot: &mut Lot<Ring>,
) {
    let (mut old, mut new) = (Carrier::default(), Carrier::default());
    for (k, (before, now)) in before.iter().zip(now).enumerate() {
        let organ = chain[k.saturating_sub(1).min(chain.len() - 1)];
        let window = if k == 0 && extra & flags::DYING == 0 {
            // The base rides on what bears it.
            union.window.get(union.parent[organ] as usize).copied().unwrap_or(Window::STEP)
        } else {
            union.window[organ]
        };
        let ring = Ring {
            before: old.carry(before),
            now: new.carry(now),
            window,
            flags: extra | if k == 0 { flags::BASE } else { 0 },
            chance,
            owner: union.owner(organ),
        };
        lot.add(ring, [before.center, now.center], before.radius.max(now.radius));
    }
}

/// Carries a frame along a branch without twist.
#[derive(Debug, Default)]
struct Carrier {
    last: Option<(Vec3, Vec3)>,
}

impl Carrier {
    fn carry(&mut self, ring: &Bare) -> RingState {
        let direction = ring.direction;
        let start = match self.last {
            None => direction.any_orthonormal_vector(),
            Some((frame, below)) => transport(frame, below, direction),
        };
        self.last = Some((start, direction));
        let frame = Quat::from_mat3(&Mat3::from_cols(start, direction, start.cross(direction)));
        RingState { center: ring.center, frame, radius: ring.radius, along: ring.along }
    }
}

/// `frame`, perpendicular to `from`, turned by the least rotation that takes `from` to `to` (unit vectors).
fn transport(frame: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let nearness = 1.0 + from.dot(to);
    let turned = if nearness > 1e-4 { frame - (from + to) * (frame.dot(to) / nearness) } else { frame };
    (turned - to * turned.dot(to)).try_normalize().unwrap_or_else(|| to.any_orthonormal_vector())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_carried_around_a_bend_does_not_twist() {
        let mut carrier = Carrier::default();
        let ring = |k: i32| {
            let turn = Quat::from_rotation_z((k as f32 * 3.0).to_radians());
            Bare { center: Vec3::ZERO, direction: turn * Vec3::Y, radius: 1.0, along: 0.0 }
        };
        let first = carrier.carry(&ring(0)).frame;
        let mut last = first;
        for k in 1..=30 {
            let state = carrier.carry(&ring(k));
            assert!((state.frame * Vec3::Y - ring(k).direction).length() < 1e-4);
            assert!(last.angle_between(state.frame) < 0.06);
            last = state.frame;
        }
        let least = Quat::from_rotation_z(90_f32.to_radians()) * first;
        assert!(last.angle_between(least) < 1e-2);
    }
}
