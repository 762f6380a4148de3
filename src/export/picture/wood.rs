//! Wood as the eye sees it: trunks stand on a swollen base, and twigs thinner than a pixel are drawn a pixel wide
//! and let through what they do not cover.
//!
//! A few samples a pixel meet such a twig here and miss it there, so that it breaks up into dots. Widened, it is met
//! all along; its colour counts by the share of the width that is its own. Nothing of this is sensed by plants.

use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use smallvec::SmallVec;

use super::camera::Camera;
use super::noise::{hash, mix, unit};
use crate::environment::trace::{Hit, Seen, Tracer};
use crate::environment::{Capsule, Scene};

/// How many roots swell the base of a trunk.
const ROOTS: u32 = 6;
/// How many twigs behind each other let a ray through; the next hides what is behind it.
const DEEP: usize = 6;
/// How many pieces of fine wood a ray passes at most.
const PIECES: usize = 16;

/// Wood of a scene as the eye sees it.
pub(super) struct SeenWood {
    /// The scene with widened wood, and what swells the bases of trunks behind its own.
    pub(super) scene: Scene,
    /// Radius of each piece of wood before it was widened, metres, as the scene's capsules.
    radii: Vec<f32>,
}

/// What a ray meets: a thing, and the share of what is seen there that is its colour.
pub(super) type Layers = SmallVec<[(Hit, f32); DEEP + 1]>;

impl SeenWood {
    /// Wood as a camera sees it; a pixel is `pixel` wide a metre from the eye.
    pub(super) fn of(scene: &Scene, camera: &Camera, pixel: f32) -> Self {
        let mut scene = scene.clone();
        let bases: Vec<Capsule> = trunk_bases(&scene).copied().collect();
        scene.capsules.extend(bases.iter().flat_map(buttresses));
        let radii = scene.capsules.iter().map(|wood| wood.radius).collect();
        for wood in &mut scene.capsules {
            let distance = camera.forward.dot(wood.from.midpoint(wood.to) - camera.eye).max(0.0);
            wood.radius = wood.radius.max(0.5 * pixel * distance);
        }
        Self { scene, radii }
    }

    /// Radius of a piece of wood before it was widened, metres.
    pub(super) fn radius(&self, wood: u32) -> f32 {
        self.radii[wood as usize]
    }

    /// Share of its width that is a piece of wood's own, 0..1.
    fn own(&self, wood: u32) -> f32 {
        self.radius(wood) / self.scene.capsules[wood as usize].radius
    }

    /// What a ray meets, nearest first: fine wood in front, then what hides the rest. Shares add up to one.
    ///
    /// `eyes` sees the scene of this wood.
    pub(super) fn layers(&self, eyes: &Tracer, eye: Vec3, d: Vec3) -> Layers {
        let mut layers = Layers::new();
        let mut met = SmallVec::<[u32; PIECES]>::new();
        let mut left = 1.0;
        // Where the last twig was met, and how much of its width is covered.
        let (mut at, mut covered) = (f32::NEG_INFINITY, 0.0);
        loop {
            let hit = eyes.closest(eye, d, f32::INFINITY, &met);
            let fine = match hit.seen {
                Seen::Wood(i) if layers.len() < DEEP && met.len() < PIECES => Some(i),
                _ => None,
            };
            let Some(i) = fine.filter(|i| self.own(*i) < 1.0) else {
                layers.push((hit, left));
                return layers;
            };
            let wood = &self.scene.capsules[i as usize];
            met.push(wood.organ);
            if hit.t - at > 4.0 * wood.radius {
                covered = 0.0;
            }
            // The next piece of the same twig covers only what it is thicker.
            let added = ((self.own(i) - covered) / (1.0 - covered)).max(0.0);
            (at, covered) = (hit.t, covered.max(self.own(i)));
            if added > 0.0 {
                layers.push((hit, left * added));
                left *= 1.0 - added;
            }
        }
    }
}

/// The lowest wood of every plant that stands upright on the ground.
fn trunk_bases(scene: &Scene) -> impl Iterator<Item = &Capsule> {
    let mut plants = HashSet::new();
    scene.capsules.iter().filter(move |wood| {
        // Wood stands in the order of birth, that of several plants mixed.
        let is_first = plants.insert(wood.plant);
        let rises = (wood.to - wood.from).try_normalize().is_some_and(|up| up.y > 0.7);
        let stands = scene.ground.is_some_and(|ground| (wood.from.y - ground).abs() < wood.radius);
        is_first && rises && stands
    })
}

/// What runs from a trunk out into the ground, as strong roots do.
fn buttresses(trunk: &Capsule) -> impl Iterator<Item = Capsule> + use<> {
    let Capsule { from: base, radius, organ, .. } = *trunk;
    let trunk = *trunk;
    let own = hash(organ);
    (0..ROOTS).map(move |k| {
        let [turn, reach, rise] = [0, 1, 2].map(|what| unit(mix(own, 3 * k + what)) - 0.5);
        let out =
            Quat::from_rotation_y(core::f32::consts::TAU * (k as f32 + 0.6 * turn) / ROOTS as f32) * Vec3::X;
        Capsule {
            from: base + (out * 0.3 + Vec3::Y * (1.8 + 0.9 * rise)) * radius,
            to: base + (out * (1.6 + 0.5 * reach) - Vec3::Y * 0.3) * radius,
            radius: 0.5 * radius,
            ..trunk
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wood(plant: u32, organ: u32, from: Vec3, to: Vec3) -> Capsule {
        Capsule { from, to, radius: 0.1, organ, plant }
    }

    #[test]
    fn every_trunk_on_the_ground_has_one_swollen_base() {
        let scene = Scene {
            capsules: vec![
                wood(0, 0, Vec3::ZERO, Vec3::Y * 0.05),
                wood(1, 1, Vec3::X, Vec3::X + Vec3::Y),
                wood(0, 2, Vec3::Y * 0.05, Vec3::Y),
                // Lies, and hangs in the air.
                wood(2, 3, Vec3::Z, Vec3::Z * 2.0),
                wood(3, 4, Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 4.0, 0.0)),
            ],
            ground: Some(0.0),
            ..Scene::default()
        };
        let camera = Camera::looking(Vec3::new(0.0, 1.0, 6.0), Vec3::Y);
        let seen = SeenWood::of(&scene, &camera, 1e-4);
        let added = &seen.scene.capsules[scene.capsules.len()..];
        let of = |plant| added.iter().filter(|wood| wood.plant == plant).count() as u32;
        assert_eq!([0, 1, 2, 3].map(of), [ROOTS, ROOTS, 0, 0]);
        assert!(added.iter().all(|wood| wood.from.y > 0.1 && wood.to.y < 0.0), "{added:?}");
    }
}
