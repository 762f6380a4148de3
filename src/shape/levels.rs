//! Levels of detail: the shape of a snapshot within a number of triangles.
//!
//! Wood leaves out rings on straight stretches, then sides, then twigs, all by one tolerance in metres, the least that
//! fits. Leaves turn into flat cards with the leaf in their texture, and these into fewer and larger ones, each for its
//! neighbours in space, with their area; many at once become cards of a whole spray. Height and width are kept: the
//! outermost cards touch the box of all leaves, and limbs that hold the outermost wood stay, as long as a few hundred
//! triangles let them.

mod cards;
mod limbs;

use bevy::prelude::*;

use super::Surface;
use super::crown::Crown;
use super::leaves::leaves;
use super::tubes::wood;
use crate::plant::Snapshot;

/// Share of the triangles that wood gets, if leaves want the rest.
const WOOD_SHARE: f32 = 0.4;

/// What one plant is drawn with.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Shape {
    /// Its wood.
    pub wood: Surface,
    /// Its leaves.
    pub leaves: Surface,
    /// Whether `leaves` are cards for [`spray`](super::texture::spray), else leaves.
    pub sprays: bool,
}

impl Shape {
    /// Each plant in all detail, by its index in [`Snapshot::plants`]; a gone plant's is empty.
    pub fn full(snapshot: &Snapshot) -> Vec<Self> {
        let parts = wood(snapshot).into_iter().zip(leaves(snapshot));
        parts.map(|(wood, leaves)| Self { wood, leaves, sprays: false }).collect()
    }

    /// Triangles in it.
    pub fn triangles(&self) -> usize {
        self.wood.triangles() + self.leaves.triangles()
    }

    /// Least and greatest corner, `None` if there is nothing to see.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        match (self.wood.bounds(), self.leaves.bounds()) {
            (Some((a, b)), Some((c, d))) => Some((a.min(c), b.max(d))),
            (some, none) => some.or(none),
        }
    }
}

/// Each plant, by its index in [`Snapshot::plants`], all together with at most so many triangles; all detail if that
/// fits.
pub fn within(snapshot: &Snapshot, triangles: usize) -> Vec<Shape> {
    let full = Shape::full(snapshot);
    let all: usize = full.iter().map(Shape::triangles).sum();
    if all <= triangles {
        return full;
    }
    let (limbs, crowns) = (limbs::of(snapshot), Crown::of(snapshot));
    let mut known = cards::Sprays::default();
    let mut shapes = Vec::with_capacity(full.len());
    for (plant, full) in full.into_iter().enumerate() {
        // Whole numbers of more bits than any count of triangles: shares never add up to more than there are.
        let share = (triangles as u128 * full.triangles() as u128 / all as u128) as usize;
        let for_wood = full.wood.triangles().min((share as f32 * WOOD_SHARE) as usize);
        let for_leaves = share - for_wood;
        let (leaves, sprays) =
            cards::within(snapshot, plant as u32, crowns[plant], &full.leaves, for_leaves, &mut known);
        let room = share - leaves.triangles();
        let wood = if full.wood.triangles() <= room {
            full.wood
        } else {
            limbs::within(&limbs[plant], full.leaves.bounds(), room)
        };
        shapes.push(Shape { wood, leaves, sprays });
    }
    shapes
}
