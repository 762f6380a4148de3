//! Leaves as fewer and larger cards of the same area.

use std::sync::Arc;

use bevy::math::ops;
use bevy::prelude::*;

use crate::chance::{mix, share};
use crate::plant::{OrganState, Snapshot};
use crate::shape::crown::Crown;
use crate::shape::foliage::{Blade, Foliage};
use crate::shape::leaves::round_normals;
use crate::shape::texture::spray;
use crate::shape::{Place, Surface};
use crate::species::Species;

/// Leaves a card must stand for on average before cards are sprays.
const SPRAY_FROM: usize = 4;
/// Most a spray turns about its length, radians: leaves lie level, and a crown of level cards is thin from the side.
const TURN: f32 = 1.0;

/// How much of a spray its leaves cover, by species: it takes a picture of one to tell.
#[derive(Default)]
pub(super) struct Sprays(Vec<(Arc<Species>, f32)>);

impl Sprays {
    fn covered(&mut self, species: &Arc<Species>) -> f32 {
        if let Some((_, covered)) = self.0.iter().find(|(other, _)| Arc::ptr_eq(other, species)) {
            return *covered;
        }
        let covered = spray(species, false).covered().max(0.05);
        self.0.push((species.clone(), covered));
        covered
    }
}

/// Leaves of a plant with at most so many triangles, and whether they are sprays.
pub(super) fn within(
    snapshot: &Snapshot,
    plant: u32,
    crown: Crown,
    full: &Surface,
    triangles: usize,
    known: &mut Sprays,
) -> (Surface, bool) {
    if full.triangles() <= triangles {
        return (full.clone(), false);
    }
    let Some(Some(record)) = snapshot.plants.get(plant as usize) else { return Default::default() };
    let mut blades = blades(snapshot, plant, &Foliage::of(&record.species));
    let (Some((low, high)), cards) = (full.bounds(), blades.len().min(triangles / 2)) else {
        return Default::default();
    };
    if cards == 0 {
        return Default::default();
    }
    let sprays = blades.len() >= SPRAY_FROM * cards;
    let size = (high - low).max_element().max(f32::MIN_POSITIVE);
    blades.sort_by_cached_key(|(blade, organ)| (morton((middle(blade) - low) / size), *organ));
    let fill = record.species.leaf_outline.fill();
    let covered = if sprays { known.covered(&record.species) } else { fill };
    let group = |k: usize| &blades[k * blades.len() / cards..(k + 1) * blades.len() / cards];
    let mut cards: Vec<(Blade, u32)> =
        (0..cards).map(|k| card(group(k), sprays.then_some(fill / covered), snapshot)).collect();
    if blades.len() > cards.len() {
        reach(&mut cards, low, high);
    }
    let mut surface = Surface::default();
    for (card, organ) in &cards {
        lay(&mut surface, card, *organ);
    }
    round_normals(core::slice::from_mut(&mut surface), &[crown]);
    (surface, sprays)
}

/// The blades of a plant and the leaf organs they belong to.
fn blades(snapshot: &Snapshot, plant: u32, foliage: &Foliage) -> Vec<(Blade, u32)> {
    let mut blades = Vec::new();
    for (i, state) in snapshot.state.iter().enumerate().filter(|(i, _)| snapshot.plant[*i] == plant) {
        let OrganState::Leaf(leaf) = state else { continue };
        if leaf.size > 0.0 {
            let of_leaf = foliage.blades(&snapshot.pose[i], leaf.size, snapshot.lineage[i]);
            blades.extend(of_leaf.map(|blade| (blade, i as u32)));
        }
    }
    blades
}

fn middle(blade: &Blade) -> Vec3 {
    blade.base + 0.5 * blade.midrib
}

/// Where a point of the unit cube is on a line that visits neighbours together (Z order).
fn morton(at: Vec3) -> u32 {
    let spread = |x: f32| {
        let mut bits = (x.clamp(0.0, 1.0) * 1023.0) as u32;
        for (shift, mask) in [(16, 0x0300_00FF), (8, 0x0300_F00F), (4, 0x030C_30C3), (2, 0x0924_9249)] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    spread(at.x) << 2 | spread(at.y) << 1 | spread(at.z)
}

/// One card for a group of blades, and the organ it stands for. `spray`: area of a leaf over that of the card it is on.
fn card(group: &[(Blade, u32)], spray: Option<f32>, snapshot: &Snapshot) -> (Blade, u32) {
    let (first, organ) = group[group.len() / 2];
    if group.len() == 1 && spray.is_none() {
        return (first, organ);
    }
    let (mut area, mut center, mut way, mut normal) = (0.0, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    for (blade, _) in group {
        let own = blade.midrib.length() * blade.across.length();
        area += own;
        center += middle(blade) * own;
        way += blade.midrib * own;
        normal += blade.normal() * own;
    }
    center /= area.max(f32::MIN_POSITIVE);
    let way = way.try_normalize().unwrap_or_else(|| first.midrib.normalize_or(Vec3::Y));
    let normal = (normal - way * normal.dot(way)).try_normalize();
    let mut normal = normal.unwrap_or_else(|| way.any_orthonormal_vector());
    // Length and half width.
    let (length, half) = match spray {
        Some(fill) => {
            let length = (2.0 * area * fill).sqrt();
            let chance = share(mix(snapshot.lineage[organ as usize].0 ^ 0xCA2D));
            let turn = TURN * (2.0 * chance - 1.0);
            let (sin, cos) = ops::sin_cos(turn);
            normal = normal * cos + way.cross(normal) * sin;
            (length, 0.5 * length)
        }
        None => {
            let slender = first.across.length() / first.midrib.length().max(f32::MIN_POSITIVE);
            let length = (area / slender.max(f32::MIN_POSITIVE)).sqrt();
            (length, length * slender)
        }
    };
    let midrib = way * length;
    let base = center - 0.5 * midrib;
    (Blade { stalk: base, base, midrib, across: way.cross(normal) * half }, organ)
}

/// Least and greatest corner of a card.
fn corners(card: &Blade) -> (Vec3, Vec3) {
    let (middle, half) = (middle(card), 0.5 * card.midrib.abs() + card.across.abs());
    (middle - half, middle + half)
}

/// Moves cards into the box of all leaves, and the outermost ones to its sides.
fn reach(cards: &mut [(Blade, u32)], low: Vec3, high: Vec3) {
    let shift = |card: &mut Blade, by: Vec3| {
        card.base += by;
        card.stalk += by;
    };
    for (card, _) in &mut *cards {
        let (least, most) = corners(card);
        let inward = (low - least).max(Vec3::ZERO) - (most - high).max(Vec3::ZERO);
        shift(card, inward);
    }
    for axis in 0..3 {
        for (side, sign) in [(low, -1.0), (high, 1.0)] {
            let end = |card: &Blade| {
                let (least, most) = corners(card);
                if sign > 0.0 { most[axis] } else { -least[axis] }
            };
            let outermost = cards.iter_mut().max_by(|a, b| end(&a.0).total_cmp(&end(&b.0)));
            let Some((card, _)) = outermost else { return };
            let mut by = Vec3::ZERO;
            by[axis] = side[axis] - sign * end(card);
            shift(card, by);
        }
    }
}

/// Adds a card: two triangles with the whole texture.
fn lay(surface: &mut Surface, card: &Blade, organ: u32) {
    let normal = card.normal();
    let mut corner = |across: f32, along: f32| {
        let at = card.base + card.midrib * along + card.across * across;
        surface.vertex(at, normal, [0.5 + 0.5 * across, along], Place { organ, along })
    };
    let (left, right) = (corner(1.0, 0.0), corner(-1.0, 0.0));
    let (far_left, far_right) = (corner(1.0, 1.0), corner(-1.0, 1.0));
    surface.triangle(left, far_left, right);
    surface.triangle(right, far_left, far_right);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_line_are_neighbours_in_space() {
        assert!(morton(Vec3::ZERO) < morton(Vec3::splat(0.01)));
        assert!(morton(Vec3::splat(0.49)) < morton(Vec3::splat(0.51)));
        assert_eq!(morton(Vec3::ONE), (1 << 30) - 1);
        assert_eq!(morton(Vec3::splat(2.0)), morton(Vec3::ONE));
    }
}
