//! A finished plant as bare stems: what [`vary`](crate::tropism::vary::vary) takes and gives, wherever it came from.

use bevy::prelude::*;
use smallvec::SmallVec;

use super::{Lineage, NO_PARENT, OrganState, Pose, Snapshot};
use crate::environment::{Capsule, Scene};
use crate::shape::foliage::Foliage;
use crate::species::Species;
use crate::tropism::turned_to;

/// One straight piece of stem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StemSegment {
    /// Index of the segment it grows from, earlier in the list, or [`NO_PARENT`].
    pub parent: u32,
    /// Its base and turn; it points along local +Y.
    pub pose: Pose,
    /// Length, metres, above 0.
    pub length: f32,
    /// Radius, metres.
    pub radius: f32,
    /// Order of its axis. A segment of its parent's order goes on as the same axis, unless the stem forks into several of it.
    pub order: u32,
    /// Whether a segment of the base model ends here; pieces it is cut into before that have none.
    pub node: bool,
}

impl StemSegment {
    /// Where it ends, metres.
    pub fn tip(&self) -> Vec3 {
        self.pose.tip(self.length)
    }
}

/// A leaf of a skeleton: goes where its stem goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StemLeaf {
    /// Index of the segment that bears it.
    pub on: u32,
    /// Its base and turn.
    pub pose: Pose,
    /// Area as a share of the species' largest, 0..1.
    pub size: f32,
    /// What decides its look.
    pub lineage: Lineage,
}

/// The stems and leaves of one plant, parents before what they bear.
///
/// Fill it from any source: [`Skeleton::of`] takes a grown plant, [`Skeleton::add_stem`] a line of points.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Skeleton {
    /// The stems.
    pub segments: Vec<StemSegment>,
    /// The leaves.
    pub leaves: Vec<StemLeaf>,
}

/// Why something is no skeleton.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SkeletonError {
    /// There is nothing in it.
    #[error("the skeleton has no segments")]
    Empty,
    /// A segment has no length.
    #[error("segment {segment} is {length} m long; every segment needs a length above 0")]
    Length {
        /// The segment, by index.
        segment: usize,
        /// Its length, metres.
        length: f32,
    },
    /// A segment or leaf grows from nothing, or from what comes later.
    #[error("{what} {index} grows from segment {parent}, which does not come before it")]
    Parent {
        /// `segment` or `leaf`.
        what: &'static str,
        /// Its index.
        index: usize,
        /// What it is said to grow from.
        parent: u32,
    },
    /// A number is not finite, or a turn is none.
    #[error("{what} {index} has a place, turn or size that is not finite")]
    NotFinite {
        /// `segment` or `leaf`.
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// There is no such plant in the snapshot, or it has no stem.
    #[error("there is no plant {0} with a stem")]
    NoPlant(u32),
}

impl Skeleton {
    /// The skeleton of a grown plant, by its index in [`Snapshot::plants`]; every internode is a segment.
    ///
    /// # Errors
    /// If the plant is not there or has no stem.
    pub fn of(snapshot: &Snapshot, plant: u32) -> Result<Self, SkeletonError> {
        let mut skeleton = Self::default();
        let mut index = vec![NO_PARENT; snapshot.len()];
        let new = |index: &[u32], old: u32| index.get(old as usize).copied().unwrap_or(NO_PARENT);
        for i in (0..snapshot.len()).filter(|&i| snapshot.plant[i] == plant) {
            let (parent, pose) = (new(&index, snapshot.parent[i]), snapshot.pose[i]);
            match &snapshot.state[i] {
                OrganState::Internode(wood, _) => {
                    index[i] = skeleton.segments.len() as u32;
                    skeleton.segments.push(StemSegment {
                        parent,
                        pose,
                        length: wood.length,
                        radius: wood.radius,
                        order: snapshot.order[i],
                        node: true,
                    });
                }
                OrganState::Leaf(leaf) if parent != NO_PARENT => {
                    let lineage = snapshot.lineage[i];
                    skeleton.leaves.push(StemLeaf { on: parent, pose, size: leaf.size, lineage });
                }
                _ => {}
            }
        }
        match skeleton.segments.is_empty() {
            true => Err(SkeletonError::NoPlant(plant)),
            false => Ok(skeleton),
        }
    }

    /// Adds a stem along points (metres), from segment `on` or the ground; radii taper from first to second.
    /// Gives the indices of its segments. Points that coincide make a segment that [`Skeleton::check`] refuses.
    pub fn add_stem(&mut self, on: Option<u32>, points: &[Vec3], radii: [f32; 2]) -> Vec<u32> {
        let below = on.and_then(|on| self.segments.get(on as usize).copied());
        let order = below.map_or(0, |below| below.order + 1);
        let mut parent = on.unwrap_or(NO_PARENT);
        let mut frame = below.map_or(Quat::IDENTITY, |below| below.pose.rotation);
        let mut made = Vec::new();
        let last = points.len().saturating_sub(2).max(1) as f32;
        for (k, ends) in points.windows(2).enumerate() {
            let way = ends[1] - ends[0];
            frame = turned_to(frame, way.try_normalize().unwrap_or(frame * Vec3::Y));
            let index = self.segments.len() as u32;
            self.segments.push(StemSegment {
                parent,
                pose: Pose { position: ends[0], rotation: frame },
                length: way.length(),
                radius: radii[0] + (radii[1] - radii[0]) * k as f32 / last,
                order,
                node: true,
            });
            parent = index;
            made.push(index);
        }
        made
    }

    /// Adds a leaf at the tip of a segment, along a heading (a unit vector).
    pub fn add_leaf(&mut self, on: u32, heading: Vec3, size: f32) {
        let Some(stem) = self.segments.get(on as usize) else { return };
        let pose = Pose { position: stem.tip(), rotation: turned_to(stem.pose.rotation, heading) };
        let lineage = Lineage::SEED.child(self.leaves.len() as u32);
        self.leaves.push(StemLeaf { on, pose, size, lineage });
    }

    /// Checks that it can be re-grown.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn check(&self) -> Result<(), SkeletonError> {
        if self.segments.is_empty() {
            return Err(SkeletonError::Empty);
        }
        for (segment, stem) in self.segments.iter().enumerate() {
            let (index, parent) = (segment, stem.parent);
            if parent != NO_PARENT && parent as usize >= segment {
                return Err(SkeletonError::Parent { what: "segment", index, parent });
            }
            if !(is_pose(&stem.pose) && stem.radius.is_finite()) {
                return Err(SkeletonError::NotFinite { what: "segment", index });
            }
            if !(stem.length > 0.0 && stem.length < f32::INFINITY) {
                return Err(SkeletonError::Length { segment, length: stem.length });
            }
        }
        for (index, leaf) in self.leaves.iter().enumerate() {
            if leaf.on as usize >= self.segments.len() {
                return Err(SkeletonError::Parent { what: "leaf", index, parent: leaf.on });
            }
            if !(is_pose(&leaf.pose) && leaf.size.is_finite()) {
                return Err(SkeletonError::NotFinite { what: "leaf", index });
            }
        }
        Ok(())
    }

    /// Segments of the base model.
    pub fn nodes(&self) -> usize {
        self.segments.iter().filter(|s| s.node).count()
    }

    /// Length of all stems together, metres.
    pub fn total_length(&self) -> f64 {
        self.segments.iter().map(|s| f64::from(s.length)).sum()
    }

    /// Highest point of a stem above the lowest base, metres.
    pub fn height(&self) -> f32 {
        let low = self.segments.iter().map(|s| s.pose.position.y).fold(f32::INFINITY, f32::min);
        self.segments.iter().map(|s| s.pose.position.y.max(s.tip().y) - low).fold(0.0, f32::max)
    }

    /// Moves and turns it.
    pub fn moved(&self, by: Transform) -> Self {
        let moved = |pose: &Pose| Pose {
            position: by.rotation * pose.position + by.translation,
            rotation: by.rotation * pose.rotation,
        };
        let segments = self.segments.iter().map(|s| StemSegment { pose: moved(&s.pose), ..*s }).collect();
        let leaves = self.leaves.iter().map(|l| StemLeaf { pose: moved(&l.pose), ..*l }).collect();
        Self { segments, leaves }
    }

    /// Adds its wood and leaves to a scene as a plant of a species.
    pub fn add_to(&self, scene: &mut Scene, species: &Species, plant: u32) {
        let wood = self.segments.iter().enumerate().map(|(i, stem)| Capsule {
            from: stem.pose.position,
            to: stem.tip(),
            radius: stem.radius,
            organ: i as u32,
            plant,
        });
        scene.capsules.extend(wood);
        let foliage = Foliage::of(species);
        let organ = self.segments.len() as u32;
        for (i, leaf) in self.leaves.iter().enumerate().filter(|(_, leaf)| leaf.size > 0.0) {
            let blades: SmallVec<[_; 8]> = foliage.blades(&leaf.pose, leaf.size, leaf.lineage).collect();
            scene
                .leaves
                .extend(blades.iter().map(|blade| blade.patch(foliage.outline, organ + i as u32, plant)));
        }
    }
}

fn is_pose(pose: &Pose) -> bool {
    pose.position.is_finite() && pose.rotation.is_finite() && (pose.rotation.length() - 1.0).abs() < 1e-2
}
