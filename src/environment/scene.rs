//! The scene: what can be seen or bumped into, as plain data.

use bevy::math::ops;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use crate::shape::outline::LeafOutline;

/// A piece of wood: the points within `radius` of the segment `from`..`to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    /// Base of the internode, world metres.
    pub from: Vec3,
    /// Tip of the internode, world metres.
    pub to: Vec3,
    /// Radius, metres.
    pub radius: f32,
    /// Birth number of the internode.
    pub organ: u32,
    /// Index of the plant it belongs to in [`Snapshot::plants`](crate::plant::Snapshot).
    pub plant: u32,
}

/// A flat leaf: a midrib, a half width and an outline between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeafPatch {
    /// Where the blade begins, world metres.
    pub base: Vec3,
    /// From base to tip of the blade, metres.
    pub midrib: Vec3,
    /// From the midrib to the margin where the blade is widest, metres; perpendicular to `midrib`.
    pub across: Vec3,
    /// Shape of the margin.
    pub outline: LeafOutline,
    /// Birth number of the leaf.
    pub organ: u32,
    /// Index of the plant it belongs to in [`Snapshot::plants`](crate::plant::Snapshot).
    pub plant: u32,
}

/// The form of a solid, about its own centre, axes along its own x, y, z.
#[derive(Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
pub enum SolidShape {
    /// A box by its full size in metres.
    Box {
        /// Extent along x, y, z, metres.
        size: Vec3,
    },
    /// A ball.
    Ball {
        /// Radius, metres.
        radius: f32,
    },
    /// An upright cylinder (axis along y).
    Cylinder {
        /// Radius, metres.
        radius: f32,
        /// Full height, metres.
        height: f32,
    },
}

/// A wall, a ball or a pillar: it hides light and growth never passes through it.
///
/// Stands at the entity's [`Transform`]; scale is applied to the shape's sizes.
#[derive(Component, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
#[require(Transform)]
pub struct Solid {
    /// Its form.
    pub shape: SolidShape,
    /// Colour in pictures, linear RGB 0..1.
    pub color: [f32; 3],
}

impl Solid {
    /// Colour of a solid that was given none: pale masonry.
    pub const COLOR: [f32; 3] = [0.456, 0.332, 0.231];

    /// A solid of a shape, in pale masonry.
    pub fn new(shape: SolidShape) -> Self {
        Self { shape, color: Self::COLOR }
    }

    /// A box by its full size, metres.
    pub fn block(size: Vec3) -> Self {
        Self::new(SolidShape::Box { size })
    }

    /// A ball by its radius, metres.
    pub fn ball(radius: f32) -> Self {
        Self::new(SolidShape::Ball { radius })
    }

    /// An upright cylinder by its radius and full height, metres.
    pub fn cylinder(radius: f32, height: f32) -> Self {
        Self::new(SolidShape::Cylinder { radius, height })
    }
}

/// A solid in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandingSolid {
    /// Its form.
    pub shape: SolidShape,
    /// Its centre, world metres.
    pub position: Vec3,
    /// Its turn.
    pub rotation: Quat,
    /// Colour in pictures, linear RGB 0..1.
    pub color: [f32; 3],
}

/// A lamp: a glowing ball at the entity's [`Transform`].
#[derive(Component, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
#[require(Transform)]
pub struct Lamp {
    /// Radiance of its surface, as a multiple of a full sky's (1).
    pub strength: f32,
    /// Radius of the ball, metres.
    pub radius: f32,
    /// Whether it burns.
    pub on: bool,
    /// Colour in pictures, linear RGB 0..1.
    pub color: [f32; 3],
}

impl Lamp {
    /// Colour of a lamp that was given none: warm white.
    pub const COLOR: [f32; 3] = [1.0, 0.631, 0.279];

    /// A warm lamp that burns, by the radiance of its surface (1 is a full sky's) and its radius in metres.
    pub fn new(strength: f32, radius: f32) -> Self {
        Self { strength, radius, on: true, color: Self::COLOR }
    }
}

/// A lamp in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StandingLamp {
    /// Its strength, size and colour.
    pub lamp: Lamp,
    /// Its centre, world metres.
    pub position: Vec3,
}

/// How the sky's radiance falls off from zenith to horizon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum SkyGradient {
    /// The same in every direction.
    #[default]
    Uniform,
    /// `(1 + 2 sin h) / 2` over elevation h: three times brighter overhead than at the horizon, with the
    /// same light on a point as the uniform sky of that strength. Below the horizon it is mirrored.
    Overcast,
}

/// The sky, a resource: light from every direction nothing stands in.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Resource)]
#[serde(default, deny_unknown_fields)]
pub struct Sky {
    /// Mean radiance of the hemisphere; 1 is full daylight.
    pub strength: f32,
    /// How it is spread.
    pub gradient: SkyGradient,
}

impl Default for Sky {
    fn default() -> Self {
        Self { strength: 1.0, gradient: SkyGradient::Uniform }
    }
}

impl Sky {
    /// Radiance seen in direction `d` (unit vector).
    pub fn radiance(&self, d: Vec3) -> f32 {
        match self.gradient {
            SkyGradient::Uniform => self.strength,
            SkyGradient::Overcast => self.strength * (0.5 + d.y.abs()),
        }
    }
}

/// The sun, shining along the entity's local -z: it stands at `rotation * +Z`.
#[derive(Component, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
#[require(Transform)]
pub struct Sun {
    /// Light it gives a point it reaches; 1 alone saturates an exposure.
    pub strength: f32,
}

/// The sun in its place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunLight {
    /// Unit vector towards the sun.
    pub direction: Vec3,
    /// Light it gives a point it reaches.
    pub strength: f32,
}

/// A sea: the ground is a beach that ends in water along a straight shore. It is only drawn; nothing that grows minds
/// it. A resource of worlds that have one.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Resource)]
#[serde(default, deny_unknown_fields)]
pub struct Shore {
    /// Where the sea lies, degrees from +z (south) towards +x (east).
    pub azimuth_deg: f32,
    /// How far from the middle it begins, metres.
    pub distance_m: f32,
}

impl Default for Shore {
    fn default() -> Self {
        Self { azimuth_deg: 0.0, distance_m: 10.0 }
    }
}

impl Shore {
    /// Out to sea: a level unit vector.
    pub fn outward(&self) -> Vec3 {
        let (sin, cos) = ops::sin_cos(self.azimuth_deg.to_radians());
        Vec3::new(sin, 0.0, cos)
    }

    /// How far out at sea a point is, metres; below 0 on land.
    pub fn out_at(&self, point: Vec3) -> f32 {
        point.dot(self.outward()) - self.distance_m
    }
}

/// Everything a probe or a growing shoot can meet, as plain data.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// Wood.
    pub capsules: Vec<Capsule>,
    /// Leaves.
    pub leaves: Vec<LeafPatch>,
    /// Walls and the like.
    pub solids: Vec<StandingSolid>,
    /// Lamps, burning or not.
    pub lamps: Vec<StandingLamp>,
    /// The sky.
    pub sky: Sky,
    /// The sun, if it is up.
    pub sun: Option<SunLight>,
    /// Height of the infinite ground, metres, if there is one.
    pub ground: Option<f32>,
    /// Where a sea begins, if there is one; pictures show it.
    pub shore: Option<Shore>,
}

impl SolidShape {
    /// The shape at a [`Transform`]'s scale; balls and cylinders take the largest of what would make them oval.
    pub fn scaled(self, scale: Vec3) -> Self {
        let scale = scale.abs();
        match self {
            Self::Box { size } => Self::Box { size: size * scale },
            Self::Ball { radius } => Self::Ball { radius: radius * scale.max_element() },
            Self::Cylinder { radius, height } => {
                Self::Cylinder { radius: radius * scale.x.max(scale.z), height: height * scale.y }
            }
        }
    }

    /// Half the box around it, along its own axes, metres.
    pub fn half_size(&self) -> Vec3 {
        match *self {
            Self::Box { size } => 0.5 * size.abs(),
            Self::Ball { radius } => Vec3::splat(radius.abs()),
            Self::Cylinder { radius, height } => Vec3::new(radius, 0.5 * height, radius).abs(),
        }
    }

    /// Radius of a ball about its centre that holds all of it, metres.
    pub fn bound(&self) -> f32 {
        match *self {
            Self::Box { size } => 0.5 * size.length(),
            Self::Ball { radius } => radius.abs(),
            Self::Cylinder { radius, height } => radius.abs() + 0.5 * height.abs(),
        }
    }

    /// Its kind and sizes as bits, to sort by.
    pub(super) fn bits(&self) -> [u32; 4] {
        match *self {
            Self::Box { size } => [0, size.x.to_bits(), size.y.to_bits(), size.z.to_bits()],
            Self::Ball { radius } => [1, radius.to_bits(), 0, 0],
            Self::Cylinder { radius, height } => [2, radius.to_bits(), height.to_bits(), 0],
        }
    }
}
