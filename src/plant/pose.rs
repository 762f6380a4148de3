//! Where organs are in the world, derived from the turn of each relative to what it grows from.

use bevy::prelude::*;

use super::{NO_PARENT, Pose};

/// What the pose of an organ follows from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    /// Index of the internode it grows from, or [`NO_PARENT`].
    pub parent: u32,
    /// Turn relative to it.
    pub attachment: Quat,
    /// Length, metres; 0 for buds and leaves.
    pub length: f32,
    /// Distance of its base from the axis of the stem it sits on, metres: 0 for stems and apical buds.
    pub offset: f32,
}

/// Poses of all organs, base to tip in one pass. `root(i)` is the pose of the plant of organ `i`.
pub fn derive(links: &[Link], root: impl Fn(usize) -> Pose) -> Vec<Pose> {
    let mut poses: Vec<Pose> = Vec::with_capacity(links.len());
    for (i, link) in links.iter().enumerate() {
        let (position, below) = if link.parent == NO_PARENT {
            let root = root(i);
            (root.position, root.rotation)
        } else {
            let p = link.parent as usize;
            (poses[p].tip(links[p].length), poses[p].rotation)
        };
        poses.push(attach(position, below, link.attachment, link.offset));
    }
    poses
}

/// Pose of an organ attached at `tip` of a stem turned `below`, its base `offset` metres off the stem's axis.
pub fn attach(tip: Vec3, below: Quat, attachment: Quat, offset: f32) -> Pose {
    let rotation = (below * attachment).normalize();
    let mut position = tip;
    if offset > 0.0 {
        let stem = below * Vec3::Y;
        let heading = rotation * Vec3::Y;
        position += (heading - stem * heading.dot(stem)).normalize_or_zero() * offset;
    }
    Pose { position, rotation }
}
