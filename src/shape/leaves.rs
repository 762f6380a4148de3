//! Leaf surfaces: each blade a strip of triangles along its midrib, with its petiole, and the stalk they share.

use bevy::prelude::*;

use super::crown::Crown;
use super::foliage::{Blade, Foliage};
use super::outline::LeafOutline;
use super::{Place, Surface};
use crate::plant::{OrganState, Snapshot};

/// Half the width of petioles and stalks, as a share of a blade's length.
const STALK_HALF_WIDTH: f32 = 0.012;

/// The leaves of every plant, by its index in [`Snapshot::plants`]; a gone plant's is empty.
///
/// Normals are the blades' own, turned outward from the [`Crown`] so that a crown is shaded as one soft body.
pub fn leaves(snapshot: &Snapshot) -> Vec<Surface> {
    let foliage: Vec<Option<Foliage>> =
        snapshot.plants.iter().map(|plant| plant.as_ref().map(|p| Foliage::of(&p.species))).collect();
    let mut surfaces = vec![Surface::default(); snapshot.plants.len()];
    for (i, state) in snapshot.state.iter().enumerate() {
        let OrganState::Leaf(leaf) = state else { continue };
        let plant = snapshot.plant[i] as usize;
        let Some(Some(foliage)) = foliage.get(plant) else { continue };
        if leaf.size > 0.0 {
            let surface = &mut surfaces[plant];
            let mut from = snapshot.pose[i].position;
            for blade in foliage.blades(&snapshot.pose[i], leaf.size, snapshot.lineage[i]) {
                leaf_mesh(surface, foliage.outline, &blade, i as u32);
                if foliage.blades_per_leaf() > 1 && blade.stalk != from {
                    stalk(surface, from, &blade, i as u32);
                    from = blade.stalk;
                }
            }
        }
    }
    round_normals(&mut surfaces, &Crown::of(snapshot));
    surfaces
}

/// Turns the normals of the leaves of every plant outward from its crown.
pub(crate) fn round_normals(surfaces: &mut [Surface], crowns: &[Crown]) {
    for (surface, crown) in surfaces.iter_mut().zip(crowns) {
        for (normal, position) in surface.normals.iter_mut().zip(&surface.positions) {
            *normal = crown.round((*position).into(), (*normal).into()).into();
        }
    }
}

/// Adds one blade and its petiole: u across the blade (0.5 on the midrib), v from base (0) to tip (1).
///
/// The front faces the sky; the back is for the material to show.
pub fn leaf_mesh(surface: &mut Surface, outline: LeafOutline, blade: &Blade, organ: u32) {
    let place = |along: f32| Place { organ, along };
    let normal = blade.normal();
    let sideways = blade.across.normalize_or_zero() * (STALK_HALF_WIDTH * blade.midrib.length());
    let foot = surface.vertex(blade.stalk, normal, [0.5, 0.0], place(0.0));
    let mut left = surface.vertex(blade.base + sideways, normal, [0.5, 0.0], place(0.0));
    let mut right = surface.vertex(blade.base - sideways, normal, [0.5, 0.0], place(0.0));
    surface.triangle(foot, left, right);
    for &s in &outline.stations()[1..] {
        let on_midrib = blade.base + blade.midrib * s;
        let width = outline.half_width(s);
        if width == 0.0 {
            let tip = surface.vertex(on_midrib, normal, [0.5, s], place(s));
            surface.triangle(left, tip, right);
            return;
        }
        let half = 0.5 * width;
        let next_left = surface.vertex(on_midrib + blade.across * width, normal, [0.5 + half, s], place(s));
        let next_right = surface.vertex(on_midrib - blade.across * width, normal, [0.5 - half, s], place(s));
        surface.triangle(left, next_left, right);
        surface.triangle(right, next_left, next_right);
        (left, right) = (next_left, next_right);
    }
}

/// Adds a piece of stalk, to where the next petiole leaves it.
fn stalk(surface: &mut Surface, from: Vec3, next: &Blade, organ: u32) {
    let place = Place { organ, along: 0.0 };
    let sideways = next.across.normalize_or_zero() * (STALK_HALF_WIDTH * next.midrib.length());
    let along = next.stalk - from;
    let normal = sideways.cross(along).try_normalize().unwrap_or(Vec3::Y);
    let left = surface.vertex(from + sideways, normal, [0.5, 0.0], place);
    let tip = surface.vertex(next.stalk, normal, [0.5, 0.0], place);
    let right = surface.vertex(from - sideways, normal, [0.5, 0.0], place);
    surface.triangle(left, tip, right);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blade() -> Blade {
        Blade { stalk: Vec3::Z * 0.2, base: Vec3::ZERO, midrib: Vec3::NEG_Z * 2.0, across: Vec3::X }
    }

    #[test]
    fn a_leaf_mesh_has_the_area_of_its_outline_and_faces_up() {
        for outline in LeafOutline::ALL {
            let mut surface = Surface::default();
            leaf_mesh(&mut surface, outline, &blade(), 0);
            let mut area = 0.0;
            for t in surface.indices.chunks(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from(surface.positions[i as usize]));
                let twice = (b - a).cross(c - a);
                assert!(twice.y > 0.0, "{outline:?}");
                area += 0.5 * twice.y;
            }
            let expected = 4.0 * outline.fill();
            assert!((area / expected - 1.0).abs() < 0.1, "{outline:?} {area} {expected}");
            assert!((6..=14).contains(&surface.triangles()), "{outline:?} {}", surface.triangles());
        }
    }

    #[test]
    fn texture_coordinates_follow_the_blade() {
        let mut surface = Surface::default();
        leaf_mesh(&mut surface, LeafOutline::Ovate, &blade(), 0);
        for (p, uv) in surface.positions.iter().zip(&surface.uvs).skip(3) {
            assert!((p[0] - (uv[0] * 2.0 - 1.0)).abs() < 1e-6);
            assert!((-p[2] - 2.0 * uv[1]).abs() < 1e-6);
        }
    }
}
