//! The camera, and how it finds its place.

use bevy::math::ops;
use bevy::prelude::*;

use crate::environment::{Scene, SolidShape};

/// Half the vertical angle of view, as a tangent: a long lens, so that stems stay straight.
const TAN_HALF_VIEW: f32 = 0.23;
/// Part of the picture's height the plants fill.
const PLANT_HEIGHT: f32 = 0.82;
/// Part of the picture's width the plants fill at most.
const PLANT_WIDTH: f32 = 0.88;
/// Part of the picture all else that is framed fills at most.
const THINGS: f32 = 0.95;

/// An upright box, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Span {
    min: Vec3,
    max: Vec3,
}

impl Span {
    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
    fn center(self) -> Vec3 {
        (self.min + self.max) * 0.5
    }
    fn size(self) -> Vec3 {
        self.max - self.min
    }
    fn grown(self, by: Vec3) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }
    /// The common part, if there is one.
    fn common(self, other: Self) -> Option<Self> {
        let both = Self { min: self.min.max(other.min), max: self.max.min(other.max) };
        both.min.cmple(both.max).all().then_some(both)
    }
    fn corners(self) -> impl Iterator<Item = Vec3> {
        (0..8).map(move |i| {
            let pick = |bit: u32, low, high| if i & bit == 0 { low } else { high };
            Vec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            )
        })
    }
    /// Points on a rounded body inside the box: crowns have no corners.
    fn rounded(self) -> impl Iterator<Item = Vec3> {
        const D: f32 = core::f32::consts::FRAC_1_SQRT_2;
        const RING: [(f32, f32); 8] =
            [(1.0, 0.0), (D, D), (0.0, 1.0), (-D, D), (-1.0, 0.0), (-D, -D), (0.0, -1.0), (D, -D)];
        const LEVELS: [(f32, f32); 4] = [(0.0, 0.1), (0.35, 1.0), (0.75, 1.0), (1.0, 0.5)];
        LEVELS.into_iter().flat_map(move |(level, width)| {
            RING.into_iter().map(move |(x, z)| {
                let half = self.size() * 0.5;
                let c = self.center();
                let y = self.min.y + self.size().y * level;
                Vec3::new(c.x + half.x * x * width, y, c.z + half.z * z * width)
            })
        })
    }
}

/// Where the plants, solids and lamps of one or more scenes stand: what a camera frames.
///
/// For a film, [`union`](Self::union) the bounds of all its frames, so that it does not jump.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bounds {
    plants: Option<Span>,
    solids: Vec<Span>,
    lamps: Vec<Span>,
}

impl Bounds {
    /// The bounds of a scene.
    pub fn of(scene: &Scene) -> Self {
        let mut bounds = Self::default();
        // What has sunk into the ground is not to be seen.
        let floor = scene.ground.unwrap_or(f32::NEG_INFINITY);
        let mut add = |p: Vec3, r: f32| {
            let p = p.with_y(p.y.max(floor));
            let span = Span { min: p - Vec3::splat(r), max: p + Vec3::splat(r) };
            bounds.plants = Some(bounds.plants.map_or(span, |all| all.union(span)));
        };
        for wood in &scene.capsules {
            add(wood.from, wood.radius);
            add(wood.to, wood.radius);
        }
        for leaf in &scene.leaves {
            add(leaf.base, 0.0);
            add(leaf.base + leaf.midrib, 0.0);
        }
        for solid in &scene.solids {
            let half = match solid.shape {
                SolidShape::Box { size } => size * 0.5,
                SolidShape::Ball { radius } => Vec3::splat(radius),
                SolidShape::Cylinder { radius, height } => Vec3::new(radius, height * 0.5, radius),
            };
            let turn = Mat3::from_quat(solid.rotation);
            let reach = turn.x_axis.abs() * half.x + turn.y_axis.abs() * half.y + turn.z_axis.abs() * half.z;
            bounds.solids.push(Span { min: solid.position - reach, max: solid.position + reach });
        }
        for lamp in &scene.lamps {
            let reach = Vec3::splat(lamp.lamp.radius * 1.5);
            bounds.lamps.push(Span { min: lamp.position - reach, max: lamp.position + reach });
        }
        bounds
    }

    /// Bounds that hold both.
    pub fn union(mut self, other: &Self) -> Self {
        self.plants = match (self.plants, other.plants) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        for (mine, theirs) in [(&mut self.solids, &other.solids), (&mut self.lamps, &other.lamps)] {
            for span in theirs {
                if !mine.contains(span) {
                    mine.push(*span);
                }
            }
        }
        self
    }

    /// What is to be seen: the plants' box, and points of all else that is near enough to matter.
    fn subject(&self) -> (Span, Vec<Vec3>) {
        let Some(plants) = self.plants else {
            let all = self.solids.iter().chain(&self.lamps).copied().reduce(Span::union);
            return (
                all.unwrap_or(Span { min: Vec3::new(-0.5, 0.0, -0.5), max: Vec3::new(0.5, 1.0, 0.5) }),
                Vec::new(),
            );
        };
        let size = plants.size().max_element().max(0.1);
        let near = plants.grown(Vec3::new(0.45, 0.1, 0.45) * size);
        let far = plants.grown(Vec3::splat(1.5 * size));
        let solids = self.solids.iter().filter_map(|span| span.common(near));
        let lamps = self.lamps.iter().filter(|span| span.common(far).is_some()).copied();
        (plants, solids.chain(lamps).flat_map(Span::corners).collect())
    }
}

/// A camera with a plain perspective lens, level in its width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where it stands, world metres.
    pub eye: Vec3,
    /// Where it looks, unit vector.
    pub forward: Vec3,
    /// Right of the picture, unit vector.
    pub right: Vec3,
    /// Top of the picture, unit vector.
    pub up: Vec3,
    /// Tangent of half the vertical angle of view.
    pub tan_half_view: f32,
}

impl Camera {
    /// A camera at `eye` that looks at `target`, with a vertical angle of view of about 26 degrees.
    ///
    /// Looking straight up or down, the top of the picture points to -z.
    pub fn looking(eye: Vec3, target: Vec3) -> Self {
        let forward = (target - eye).try_normalize().unwrap_or(Vec3::NEG_Z);
        let right = forward.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
        Self { eye, forward, right, up: right.cross(forward), tan_half_view: TAN_HALF_VIEW }
    }

    /// A camera that frames the plants of `bounds` and the solids and lamps near them.
    ///
    /// It stands in direction `azimuth_deg` (from +z towards +x, as a sun's) and `elevation_deg` above the
    /// plants' foot; about 5 shows a low horizon. `aspect` is the picture's width over its height. Plants fill
    /// about four fifths of the height unless width or neighbours ask for more room.
    pub fn framing(bounds: &Bounds, azimuth_deg: f32, elevation_deg: f32, aspect: f32) -> Self {
        let (plants, things) = bounds.subject();
        let aspect = aspect.max(0.01);
        let azimuth = azimuth_deg.to_radians();
        let elevation = elevation_deg.clamp(-80.0, 89.0).to_radians();
        let flat = ops::cos(elevation);
        let back = Vec3::new(ops::sin(azimuth) * flat, ops::sin(elevation), ops::cos(azimuth) * flat);
        let mut target = plants.center();
        let mut distance = plants.size().length().max(0.1) * 0.5 / TAN_HALF_VIEW;
        let mut camera = Self::looking(target + back * distance, target);
        // Each round centres the subject and scales the distance; perspective makes it settle, not land.
        for _ in 0..12 {
            let foot = Vec3::new(target.x, plants.min.y, target.z);
            camera = Self::looking(foot + back * distance, target);
            let on_film = |p: Vec3| {
                let d = p - camera.eye;
                let depth = d.dot(camera.forward).max(distance * 0.05);
                Vec2::new(d.dot(camera.right) / aspect, d.dot(camera.up)) / (depth * TAN_HALF_VIEW)
            };
            let mut low = Vec2::splat(f32::INFINITY);
            let mut high = Vec2::splat(f32::NEG_INFINITY);
            for (p, room) in plants
                .rounded()
                .map(|p| (p, Vec2::new(PLANT_WIDTH, PLANT_HEIGHT)))
                .chain(things.iter().map(|p| (*p, Vec2::splat(THINGS))))
            {
                let at = on_film(p) / room;
                low = low.min(at);
                high = high.max(at);
            }
            // Room to spare goes to the sky rather than to the ground.
            let spare = (1.0 - (high.y - low.y) * 0.5).max(0.0);
            let middle = (low + high) * 0.5 + Vec2::new(0.0, 0.3 * spare);
            let shift = distance * TAN_HALF_VIEW;
            target += camera.right * (middle.x * aspect * PLANT_WIDTH * shift)
                + Vec3::Y * (middle.y * PLANT_HEIGHT * shift);
            distance *= ((high - low) * 0.5).max_element().clamp(0.2, 5.0);
        }
        camera
    }

    /// Direction of the ray through a point of the picture: `x` from -1 (left) to 1, `y` from -1 (bottom) to 1,
    /// for a picture of that aspect. A unit vector.
    pub fn ray(&self, x: f32, y: f32, aspect: f32) -> Vec3 {
        let t = self.tan_half_view;
        (self.forward + self.right * (x * t * aspect) + self.up * (y * t)).normalize()
    }

    /// Where a point of the world is seen: x from -1 (left) to 1, y from -1 (bottom) to 1 within a picture of
    /// that aspect, beyond it outside; `None` behind the camera.
    pub fn project(&self, point: Vec3, aspect: f32) -> Option<Vec2> {
        let d = point - self.eye;
        let depth = d.dot(self.forward);
        let at = Vec2::new(d.dot(self.right) / aspect, d.dot(self.up)) / (depth * self.tan_half_view);
        (depth > 0.0 && at.is_finite()).then_some(at)
    }
}
