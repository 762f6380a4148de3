//! Wood: every axis one continuous tapering tube.
//!
//! An axis is a chain of internodes. Neighbours share the ring between them, turned by parallel transport so that
//! bark does not twist, its radius the mean of theirs. The tube of a side axis begins inside its parent.

use bevy::math::ops;
use bevy::prelude::*;

use super::{Place, Surface};
use crate::plant::{Internode, NO_PARENT, OrganState, Snapshot};

/// Fewest and most sides of a tube.
const SIDES: [u32; 2] = [3, 12];
/// Radius from which a tube has the most sides, metres.
const ROUND_RADIUS: f32 = 0.2;
/// Widening of the base of an axis, as a multiple of its first radius.
const FLARE: f32 = 1.35;
/// How much wider than its own radius a trunk stands on the ground.
const SWELLING: f32 = 0.8;
/// Height in which the swelling falls to a third, in radii.
const SWELLING_HEIGHT: f32 = 0.8;
/// Heights of the rings that round the swelling off, in radii.
const SWOLLEN_RINGS: [f32; 4] = [0.3, 0.7, 1.3, 2.2];
/// Radius at the tip of an axis that bears no other, as a share of its last internode's.
const TIP: f32 = 0.5;
/// Width of a tile of bark about which tiles are made to fit, metres.
const BARK_TILE: f32 = 0.4;
/// Least length of a tile, metres: bark on twigs is drawn out.
const LEAST_TILE: f32 = 0.1;

/// The internodes of all plants as axes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Axes {
    /// Index of the first internode of each axis, rising.
    pub starts: Vec<u32>,
    /// For each organ, the index of the internode that continues its axis, or [`NO_PARENT`].
    pub next: Vec<u32>,
    /// For each organ, whether a stem grows from it.
    pub bears: Vec<bool>,
}

impl Axes {
    /// Finds the axes of a snapshot.
    ///
    /// An internode continues its parent's axis when it is of the same order and farther along; of several, the
    /// first-born does.
    pub fn of(snapshot: &Snapshot) -> Self {
        let mut axes = Self {
            starts: Vec::new(),
            next: vec![NO_PARENT; snapshot.len()],
            bears: vec![false; snapshot.len()],
        };
        for i in 0..snapshot.len() {
            let Some(internode) = internode(snapshot, i as u32) else { continue };
            let p = snapshot.parent[i];
            let continues = internode_below(snapshot, i as u32).is_some_and(|below| {
                axes.bears[p as usize] = true;
                internode.height_in_branch > below.height_in_branch
                    && snapshot.order[i] == snapshot.order[p as usize]
                    && axes.next[p as usize] == NO_PARENT
            });
            if continues {
                axes.next[p as usize] = i as u32;
            } else {
                axes.starts.push(i as u32);
            }
        }
        axes
    }

    /// Indices of the internodes of the axis that starts with `start`, base to tip.
    pub fn walk(&self, start: u32) -> impl Iterator<Item = u32> + '_ {
        core::iter::successors(Some(start), |&i| {
            Some(self.next[i as usize]).filter(|&next| next != NO_PARENT)
        })
    }
}

fn internode(snapshot: &Snapshot, i: u32) -> Option<&Internode> {
    match snapshot.state.get(i as usize) {
        Some(OrganState::Internode(internode, _)) => Some(internode),
        _ => None,
    }
}

fn internode_below(snapshot: &Snapshot, i: u32) -> Option<&Internode> {
    internode(snapshot, snapshot.parent[i as usize])
}

/// A cross-section of a tube.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ring {
    pub(super) center: Vec3,
    pub(super) direction: Vec3,
    pub(super) radius: f32,
    /// Distance from the base of the axis, metres.
    pub(super) along: f32,
    /// What it belongs to.
    pub(super) place: Place,
}

impl Ring {
    /// The ring at a distance from the base of the axis between this one and the next.
    fn towards(&self, next: &Self, along: f32) -> Self {
        let part = (along - self.along) / (next.along - self.along);
        let from = if self.place.organ == next.place.organ { self.place.along } else { 0.0 };
        Self {
            center: self.center.lerp(next.center, part),
            direction: self.direction.lerp(next.direction, part).normalize_or(self.direction),
            radius: self.radius.lerp(next.radius, part),
            along,
            place: Place { organ: next.place.organ, along: from.lerp(next.place.along, part) },
        }
    }
}

/// The wood of every plant, by its index in [`Snapshot::plants`]; a gone plant's is empty.
///
/// Texture coordinates: tiles of bark, u a whole number of them around, v from the base of the axis; tiles are as long
/// as they are wide at its base.
pub fn wood(snapshot: &Snapshot) -> Vec<Surface> {
    let axes = Axes::of(snapshot);
    let mut surfaces = vec![Surface::default(); snapshot.plants.len()];
    let mut rings = Vec::new();
    for &start in &axes.starts {
        let plant = snapshot.plant[start as usize] as usize;
        let Some(surface) = surfaces.get_mut(plant).filter(|_| snapshot.plants[plant].is_some()) else {
            continue;
        };
        lay_rings(snapshot, &axes, start, &mut rings);
        let round = rings.first().map_or(SIDES[0], |base| sides(base.radius));
        skin(surface, &rings, round);
    }
    surfaces
}

/// One ring at the base of the axis and one at the tip of each of its internodes.
pub(super) fn lay_rings(snapshot: &Snapshot, axes: &Axes, start: u32, rings: &mut Vec<Ring>) {
    rings.clear();
    let mut along = 0.0;
    let mut last = start;
    for i in axes.walk(start) {
        let Some(internode) = internode(snapshot, i) else { break };
        let pose = &snapshot.pose[i as usize];
        let heading = pose.heading().try_normalize().unwrap_or(Vec3::Y);
        let radius = internode.radius;
        match rings.last_mut() {
            None => {
                let below = internode_below(snapshot, i);
                rings.push(Ring {
                    center: pose.position,
                    direction: heading,
                    radius: below.map_or(radius, |below| (FLARE * radius).min(below.radius.max(radius))),
                    along,
                    place: Place { organ: i, along: 0.0 },
                });
            }
            Some(joint) => {
                joint.direction = (joint.direction + heading).try_normalize().unwrap_or(heading);
                joint.radius = 0.5 * (joint.radius + radius);
            }
        }
        along += internode.length;
        last = i;
        let center = pose.tip(internode.length);
        rings.push(Ring { center, direction: heading, radius, along, place: Place { organ: i, along: 1.0 } });
    }
    if let Some(tip) = rings.last_mut().filter(|_| !axes.bears[last as usize]) {
        tip.radius *= TIP;
    }
    if internode_below(snapshot, start).is_none() {
        swell(rings);
    }
}

/// Gives an upright trunk the swollen base on which trees stand, flat on the ground however it leans.
fn swell(rings: &mut Vec<Ring>) {
    let upright = |base: &Ring| base.direction.y > 0.7 && base.radius > 0.0;
    let Some(base) = rings.first().copied().filter(upright) else { return };
    for height in SWOLLEN_RINGS.map(|height| height * base.radius) {
        let Some(next) = rings.iter().position(|ring| ring.along >= height) else { break };
        let (lower, upper) = (rings[next.max(1) - 1], rings[next]);
        // Not where a ring is anyway.
        if (height - lower.along).min(upper.along - height) > 0.1 * base.radius {
            rings.insert(next, lower.towards(&upper, height));
        }
    }
    for ring in rings {
        let foot = ops::exp(-ring.along / (SWELLING_HEIGHT * base.radius));
        ring.radius *= 1.0 + SWELLING * foot;
        // Flat rings reach twice as high, so that those of a slanting trunk do not run through each other.
        ring.direction = ring.direction.lerp(Vec3::Y, foot.sqrt()).normalize_or(Vec3::Y);
    }
}

/// Sides of a tube of this radius.
pub(super) fn sides(radius: f32) -> u32 {
    let [least, most] = SIDES;
    let wanted = (radius / ROUND_RADIUS).max(0.0).sqrt() * most as f32;
    (wanted.ceil() as u32).clamp(least, most)
}

/// Triangles of a tube.
pub(super) fn tube_triangles(rings: usize, sides: u32) -> usize {
    sides as usize * (2 * rings.saturating_sub(1) + 1)
}

/// Adds the surface through the rings with that many sides, 3 to 12, closed at its tip.
pub(super) fn skin(surface: &mut Surface, rings: &[Ring], sides: u32) {
    let (Some(&base), Some(&tip)) = (rings.first(), rings.last()) else { return };
    let around = core::f32::consts::TAU * base.radius;
    let tiles = (around / BARK_TILE).round().max(1.0);
    let tile = (around / tiles).max(LEAST_TILE);
    let mut turns = [(0.0, 1.0); SIDES[1] as usize + 1];
    // The last is the first again, exactly, so that the seam closes.
    for k in 1..sides {
        turns[k as usize] = ops::sin_cos(core::f32::consts::TAU * k as f32 / sides as f32);
    }
    let turns = &turns[..=sides as usize];

    let mut frame = base.direction.any_orthonormal_vector();
    let mut below = base.direction;
    let mut previous = None;
    for (j, ring) in rings.iter().enumerate() {
        frame = transport(frame, below, ring.direction);
        below = ring.direction;
        let side = ring.direction.cross(frame);
        let (before, after) = (&rings[j.saturating_sub(1)], &rings[(j + 1).min(rings.len() - 1)]);
        let run = after.along - before.along;
        let slope = if run > 0.0 { (before.radius - after.radius) / run } else { 0.0 };
        let first = surface.positions.len() as u32;
        for (k, &(sin, cos)) in turns.iter().enumerate() {
            let out = frame * cos + side * sin;
            let normal = (out + ring.direction * slope).try_normalize().unwrap_or(out);
            let u = tiles * k as f32 / sides as f32;
            surface.vertex(ring.center + out * ring.radius, normal, [u, ring.along / tile], ring.place);
        }
        if let Some(lower) = previous {
            for k in 0..sides {
                let (a, b, c, d) = (lower + k, lower + k + 1, first + k, first + k + 1);
                surface.triangle(a, b, c);
                surface.triangle(b, d, c);
            }
        }
        previous = Some(first);
    }
    let apex = tip.center + tip.direction * tip.radius;
    let apex = surface.vertex(apex, tip.direction, [0.5 * tiles, (tip.along + tip.radius) / tile], tip.place);
    for k in 0..sides {
        let first = apex - sides - 1;
        surface.triangle(first + k, first + k + 1, apex);
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

    fn ring(center: Vec3, direction: Vec3, radius: f32, along: f32) -> Ring {
        Ring { center, direction, radius, along, place: Place::default() }
    }

    #[test]
    fn transport_keeps_a_unit_perpendicular_and_does_not_twist() {
        let mut direction = Vec3::Y;
        let mut frame = Vec3::X;
        for k in 1..=90 {
            let to = Quat::from_rotation_x((k as f32).to_radians()) * Vec3::Y;
            frame = transport(frame, direction, to);
            direction = to;
            assert!(frame.dot(direction).abs() < 1e-5 && (frame.length() - 1.0).abs() < 1e-5);
        }
        assert!((frame - Vec3::X).length() < 1e-4, "{frame}");
        let flipped = transport(Vec3::X, Vec3::Y, Vec3::NEG_Y);
        assert!((flipped.length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_tube_is_closed_at_its_tip_and_faces_outward() {
        let mut surface = Surface::default();
        skin(
            &mut surface,
            &[
                ring(Vec3::ZERO, Vec3::Y, 0.2, 0.0),
                ring(Vec3::Y, Vec3::Y, 0.15, 1.0),
                ring(Vec3::Y * 2.0, Vec3::Y, 0.1, 2.0),
            ],
            12,
        );
        assert_eq!(surface.positions.len(), 3 * 13 + 1);
        assert_eq!(surface.triangles(), tube_triangles(3, 12));
        for t in surface.indices.chunks(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from(surface.positions[i as usize]));
            let middle = (a + b + c) / 3.0;
            assert!((b - a).cross(c - a).dot(middle - Vec3::Y * (middle.y - 0.1)) > 0.0);
        }
    }

    #[test]
    fn a_trunk_stands_on_a_swollen_base_and_a_root_does_not() {
        let mut rings = vec![
            ring(Vec3::ZERO, Vec3::Y, 0.2, 0.0),
            ring(Vec3::Y * 0.2, Vec3::Y, 0.2, 0.2),
            ring(Vec3::Y, Vec3::Y, 0.2, 1.0),
            ring(Vec3::Y * 2.0, Vec3::Y, 0.2, 2.0),
        ];
        let mut root: Vec<_> =
            rings.iter().map(|r| ring(-r.center, -r.direction, r.radius, r.along)).collect();
        swell(&mut rings);
        assert!(rings.len() > 6, "{rings:?}");
        assert!(rings.is_sorted_by(|a, b| a.along < b.along && a.radius > b.radius), "{rings:?}");
        assert!((rings[0].radius - 0.36).abs() < 1e-6);
        assert!(rings[rings.len() - 1].radius < 0.2001, "the stem above is as it was");
        let leaning = Vec3::new(0.6, 0.8, 0.0);
        let mut rings: Vec<_> =
            [0.0, 0.2, 1.0, 3.0].map(|along| ring(leaning * along, leaning, 0.2, along)).into();
        swell(&mut rings);
        assert_eq!(rings[0].direction, Vec3::Y, "no side of it rises out of the ground");
        assert!(rings.is_sorted_by(|a, b| a.direction.y > b.direction.y), "{rings:?}");
        assert!((rings[rings.len() - 1].direction - leaning).length() < 1e-3);
        // Rings of the foot do not run through each other.
        let lows = |r: &Ring| r.center.y - r.radius * r.direction.x;
        assert!(rings.is_sorted_by(|a, b| lows(a) < lows(b)), "{rings:?}");
        swell(&mut root);
        assert!(root.len() == 4 && root.iter().all(|r| r.radius == 0.2));
    }

    #[test]
    fn thick_wood_is_rounder_than_twigs() {
        assert_eq!((sides(0.0), sides(0.006), sides(0.05), sides(1.0)), (3, 3, 6, 12));
    }
}
