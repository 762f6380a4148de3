//! Surfaces: the colour of a point of bark, leaf, wall or ground, before any light falls on it.

use bevy::math::ops;
use bevy::prelude::*;

use super::camera::Camera;
use super::look::Palette;
use super::noise::{fract, hash, mix, rough, smooth, unit, value};
use super::shore;
use super::wood::SeenWood;
use crate::environment::trace::{Hit, Seen};
use crate::environment::{LeafPatch, SolidShape, StandingSolid};
use crate::shape::bark::{Bark, Grain};
use crate::shape::blade;

/// What surfaces need to know of the camera.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Right of the picture, unit vector.
    pub(super) right: Vec3,
    /// How much shorter grain on the ground is across the view than along it.
    pub(super) slope: f32,
    /// Width of a pixel one metre from the eye, metres.
    pub(super) pixel: f32,
}

impl View {
    pub(super) fn of(camera: &Camera, height: u32) -> Self {
        let foreground = camera.ray(0.0, -0.7, 1.0);
        Self {
            right: camera.right,
            slope: (-2.6 * foreground.y).clamp(0.15, 1.0),
            pixel: 2.0 * camera.tan_half_view / height.max(1) as f32,
        }
    }
}

/// How light leaves a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    /// Share of light thrown back, linear RGB.
    pub(super) color: Vec3,
    /// Share of light let through from behind, linear RGB.
    pub(super) through: Vec3,
    /// Which way it faces for shading, turned to the viewer.
    pub(super) normal: Vec3,
    /// Sheen at grazing view.
    pub(super) sheen: f32,
}

impl Surface {
    fn matt(color: Vec3, normal: Vec3) -> Self {
        Self { color, through: Vec3::ZERO, normal, sheen: 0.0 }
    }

    /// The surface met by a ray of direction `d` at `point`.
    pub(super) fn at(
        wood: &SeenWood,
        palette: &Palette,
        hit: &Hit,
        point: Vec3,
        d: Vec3,
        view: &View,
    ) -> Self {
        let scene = &wood.scene;
        let footprint = hit.t * view.pixel;
        match hit.seen {
            Seen::Wood(i) => {
                let plant = scene.capsules[i as usize].plant;
                bark(&palette.plant(plant).bark, point, wood.radius(i), hit.normal)
            }
            Seen::Leaf(i) => {
                let patch = &scene.leaves[i as usize];
                leaf(palette.plant(patch.plant).leaf, patch, point, d, hit.normal)
            }
            Seen::Solid(i) => wall(&scene.solids[i as usize], point, hit.normal, footprint),
            Seen::Lamp(_) => Self::matt(Vec3::new(0.55, 0.53, 0.48), hit.normal),
            Seen::Ground | Seen::Sky => {
                let meadow = meadow(palette, point, view, footprint);
                let color = scene.shore.map_or(meadow, |sea| shore::color(&sea, point, footprint, meadow));
                Self::matt(color, hit.normal)
            }
        }
    }
}

/// Bark of a stem of that radius at a point in the world.
fn bark(bark: &Bark, point: Vec3, radius: f32, normal: Vec3) -> Surface {
    Surface::matt(bark.at(radius, &SolidGrain { point, radius }), normal)
}

/// The grain of bark as noise in space.
struct SolidGrain {
    point: Vec3,
    radius: f32,
}

impl SolidGrain {
    /// Furrows a metre: as far apart as the stem is stout, within what bark does.
    fn furrows(&self) -> f32 {
        1.0 / (self.radius * 0.35).clamp(0.006, 0.05)
    }
}

impl Grain for SolidGrain {
    fn crust(&self) -> f32 {
        rough(self.point * (self.furrows() * 0.35) + Vec3::splat(9.1), 2)
    }

    fn ridge(&self) -> f32 {
        let grain = self.furrows();
        value(self.point * Vec3::new(grain, grain * 0.18, grain))
    }

    fn plate(&self) -> f32 {
        let grain = self.furrows();
        value(self.point * Vec3::new(grain, grain * 0.45, grain))
    }

    fn streak(&self) -> f32 {
        value(self.point * Vec3::new(9.0, 42.0, 9.0) + Vec3::splat(3.7))
    }

    fn blotch(&self) -> f32 {
        rough(self.point * Vec3::new(10.0, 8.0, 10.0), 2)
    }

    fn ring(&self) -> f32 {
        fract(self.point.y / 0.09 + 0.2 * value(self.point * 6.0))
    }
}

/// A leaf: folded a little at the midrib, paler along it, no two quite alike.
fn leaf(color: Vec3, patch: &LeafPatch, point: Vec3, d: Vec3, normal: Vec3) -> Surface {
    let h = hash(patch.organ ^ patch.plant.wrapping_mul(0x0100_0193));
    let (a, b) = (unit(h) - 0.5, unit(mix(h, 1)) - 0.5);
    // Real leaves are greyer than their names: wax and dust.
    let color = color.lerp(Vec3::splat(color.element_sum() / 3.0), 0.10) * 1.12;
    let own = color * blade::variation(a, b);

    let off = point - patch.base;
    let side = off.dot(patch.across) / patch.across.length_squared().max(1e-12);
    let rib = blade::rib(side);
    let fold = patch.across.normalize_or_zero() * (0.28 * side.signum() * (1.0 - rib));
    let folded = normal + if normal.dot(patch.midrib.cross(patch.across)) > 0.0 { -fold } else { fold };
    let mut folded = folded.normalize_or(normal);
    if folded.dot(d) > 0.0 {
        folded = normal;
    }
    let color = own * (1.0 + blade::RIB * rib);
    Surface { color, through: own * Vec3::new(0.95, 0.80, 0.35) * 0.75, normal: folded, sheen: 0.05 }
}

/// A wall: plaster or, on boxes, faint courses of masonry.
fn wall(solid: &StandingSolid, point: Vec3, normal: Vec3, footprint: f32) -> Surface {
    let base = Vec3::from(solid.color);
    let turn = solid.rotation.inverse();
    let at = turn * (point - solid.position);
    let facing = (turn * normal).abs();
    let plaster = rough(at * 2.3 + Vec3::splat(4.0), 3) - 0.5;
    let mut shade = 1.0 + 0.24 * plaster;
    if matches!(solid.shape, SolidShape::Box { .. }) {
        let (across, up) = if facing.y > 0.7 {
            (at.x, at.z)
        } else if facing.x > facing.z {
            (at.z, at.y)
        } else {
            (at.x, at.y)
        };
        const COURSE: f32 = 0.20;
        const STONE: f32 = 0.44;
        const JOINT: f32 = 0.014;
        let course = (up / COURSE).floor();
        let along = across / STONE + 0.5 * fract(course * 0.5) * 2.0;
        let stone = mix(hash(course as i32 as u32), along.floor() as i32 as u32);
        let to_joint = |x: f32, size: f32| (0.5 - (fract(x) - 0.5).abs()) * size;
        let near = to_joint(up / COURSE, COURSE).min(to_joint(along, STONE));
        let joint = 1.0 - smooth(JOINT * 0.5, JOINT * 0.5 + footprint.max(0.006), near);
        let fine = smooth(0.5, 3.0, COURSE / footprint.max(1e-6));
        shade *= 1.0 + fine * (0.16 * (unit(stone) - 0.5) - 0.20 * joint);
    }
    Surface::matt((base * shade).clamp(Vec3::ZERO, Vec3::splat(0.95)), normal)
}

/// A meadow: grass and bare patches, finer grain the nearer it is.
///
/// Grain is drawn out along the view, which perspective shortens: tufts stand rather than lie.
fn meadow(palette: &Palette, point: Vec3, view: &View, footprint: f32) -> Vec3 {
    let keep = |size: f32| smooth(0.8, 4.0, size / footprint.max(1e-6));
    let flat = Vec3::new(point.x, 0.0, point.z);
    let across = view.right.dot(flat);
    let along = view.right.cross(Vec3::Y).dot(flat) * view.slope;
    let grain = |size: f32, seed: f32| {
        let keep = keep(size);
        if keep > 0.0 { (value(Vec3::new(across / size, seed, along / size)) - 0.5) * keep } else { 0.0 }
    };
    let patch = rough(flat * 0.35, 3);
    let tuft = grain(0.30, 3.5) + 0.9 * grain(0.11, 7.5);
    let blade = grain(0.045, 11.5) + 0.8 * grain(0.02, 15.5);
    let bare = smooth(0.52, 0.78, patch + 0.12 * tuft);
    let color = palette.grass.lerp(palette.earth, bare * 0.7);
    let dry = 1.0 + 0.18 * (value(flat * 0.9 + Vec3::splat(31.0)) - 0.5);
    color * Vec3::new(dry, 1.0, 1.0) * (1.0 + 0.26 * tuft + 0.34 * blade)
}

/// A direction about `normal`, likelier the nearer to it, from two numbers in 0..1.
pub(super) fn around(normal: Vec3, u: f32, v: f32) -> Vec3 {
    let (x, z) = normal.any_orthonormal_pair();
    let r = u.sqrt();
    let turn = v * core::f32::consts::TAU;
    x * (r * ops::cos(turn)) + z * (r * ops::sin(turn)) + normal * (1.0 - u).max(0.0).sqrt()
}
