//! Cube maps: six square faces seen from a point.
//!
//! A texel holds the depth and what was seen. Light, share and space are readings of one map (`LK-13`):
//!
//! - [`share`](CubeMap::share): the share of texels that show sky or a burning lamp, the paper's light.
//! - [`space`](CubeMap::space): the mean depth, planar like a z-buffer's, up to a range and divided by it.
//! - [`sky_light`](CubeMap::sky_light): radiance x solid angle over that of a full open sky.
//! - [`light`](CubeMap::light): sky light, with lamps and sun by their own shadow rays, at most 1.

use std::collections::BTreeMap;
use std::f32::consts::PI;
use std::sync::{Arc, PoisonError, RwLock};

use bevy::math::{Vec3, ops};
use bevy::prelude::Reflect;
use serde::{Deserialize, Serialize};

use super::direct_light::{LightRays, direct_light};
use super::probe::{Probe, TexelWeight};
use super::scene::{Sky, SkyGradient};
use super::trace::{FaceRays, Frame, Seen, Texel, Tracer};
use crate::limits;

/// One of the six faces, named after the way it looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
pub enum CubeFace {
    /// Along +x.
    East,
    /// Along -x.
    West,
    /// Along +y.
    Up,
    /// Along -y.
    Down,
    /// Along +z.
    South,
    /// Along -z.
    North,
}

impl CubeFace {
    /// Every face, in the order of a map.
    pub const ALL: [CubeFace; 6] = [Self::East, Self::West, Self::Up, Self::Down, Self::South, Self::North];

    /// Unit vector the face looks along.
    pub fn direction(self) -> Vec3 {
        let (axis, sign) = self.frame().forward;
        Vec3::AXES[axis] * sign
    }

    /// Seen from inside: up is up on the four sides; up and down fold onto the north face.
    fn frame(self) -> Frame {
        let (x, y, z) = (0, 1, 2);
        let (right, up, forward) = match self {
            Self::East => ((z, 1.0), (y, 1.0), (x, 1.0)),
            Self::West => ((z, -1.0), (y, 1.0), (x, -1.0)),
            Self::Up => ((x, 1.0), (z, 1.0), (y, 1.0)),
            Self::Down => ((x, 1.0), (z, -1.0), (y, -1.0)),
            Self::South => ((x, -1.0), (y, 1.0), (z, 1.0)),
            Self::North => ((x, 1.0), (y, 1.0), (z, -1.0)),
        };
        Frame { right, up, forward }
    }
}

/// Rays and weights of all maps of a face size.
#[derive(Debug)]
pub(super) struct MapRays {
    pub(super) faces: [FaceRays; 6],
    /// Of each texel of a face; those of six faces sum to 4 pi.
    pub(super) solid_angles: Vec<f32>,
}

impl MapRays {
    /// Rays of maps with faces of `size` x `size` texels; made once a size.
    pub(super) fn of_size(size: u32) -> Arc<Self> {
        static MADE: RwLock<BTreeMap<u32, Arc<MapRays>>> = RwLock::new(BTreeMap::new());
        let size = size.clamp(1, limits::FACE);
        let made = MADE.read().unwrap_or_else(PoisonError::into_inner).get(&size).cloned();
        made.unwrap_or_else(|| {
            let rays = Arc::new(Self::new(size));
            MADE.write().unwrap_or_else(PoisonError::into_inner).entry(size).or_insert(rays).clone()
        })
    }

    fn new(size: u32) -> Self {
        let n = size as usize;
        let edge = |i: usize| 2.0 * i as f32 / n as f32 - 1.0;
        // Solid angle of the rectangle from the middle of the face to (x, y).
        let corner = |x: f32, y: f32| ops::atan2(x * y, (x * x + y * y + 1.0).sqrt());
        let mut solid_angles: Vec<f32> = (0..n * n)
            .map(|i| {
                let (x, y) = (i % n, i / n);
                let (x0, x1, y0, y1) = (edge(x), edge(x + 1), edge(y), edge(y + 1));
                corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
            })
            .collect();
        let scale = 4.0 * PI / 6.0 / solid_angles.iter().sum::<f32>();
        solid_angles.iter_mut().for_each(|angle| *angle *= scale);
        Self { faces: CubeFace::ALL.map(|face| FaceRays::new(face.frame(), n)), solid_angles }
    }

    /// Weight of texel `i` of a face; those of six faces sum to 1.
    pub(super) fn weight(&self, i: usize, weight: TexelWeight) -> f32 {
        match weight {
            TexelWeight::Alike => 1.0 / (6 * self.solid_angles.len()) as f32,
            TexelWeight::SolidAngle => self.solid_angles[i] / (4.0 * PI),
        }
    }
}

/// What one face reads.
#[derive(Debug, Clone, Copy, PartialEq, Reflect, Serialize, Deserialize)]
pub struct FaceReading {
    /// Which face.
    pub face: CubeFace,
    /// Share of its texels that show sky or a burning lamp, 0..1.
    pub share: f32,
    /// Sky light on it over that of a face full of open sky.
    pub light: f32,
    /// Mean depth up to the range, metres.
    pub depth: f32,
    /// Mean depth up to the range over the range, 0..1.
    pub space: f32,
}

/// Six faces seen from a point.
#[derive(Debug, Clone)]
pub struct CubeMap {
    position: Vec3,
    rays: Arc<MapRays>,
    /// Face by face, row by row from the top.
    texels: Vec<Texel>,
}

impl CubeMap {
    /// Looks around from `position`, with faces of `size` x `size` texels (1 to [`limits::FACE`]), not seeing
    /// the organs it is `blind` to.
    pub fn render(tracer: &Tracer, position: Vec3, size: u32, blind: &[u32]) -> Self {
        let rays = MapRays::of_size(size);
        let mut texels = Vec::with_capacity(6 * rays.solid_angles.len());
        for face in &rays.faces {
            tracer.face(face, position, blind, &mut texels);
        }
        Self { position, rays, texels }
    }

    /// Looks around from a probe.
    pub fn at(tracer: &Tracer, probe: &Probe) -> Self {
        Self::render(tracer, probe.position, probe.face, &probe.blind_to)
    }

    /// The same map without some organs, showing what stands behind them; `None` if none of them is in it. `blind`
    /// names these and those it was blind to before.
    pub fn without(&self, tracer: &Tracer, organs: &[u32], blind: &[u32]) -> Option<Self> {
        let shows = |texel: &Texel| tracer.birth(texel.seen).is_some_and(|birth| organs.contains(&birth));
        let first = self.texels.iter().position(shows)?;
        let n = self.rays.solid_angles.len();
        let mut map = self.clone();
        for (k, texel) in map.texels.iter_mut().enumerate().skip(first).filter(|(_, texel)| shows(texel)) {
            let direction = self.rays.faces[k / n].directions[k % n];
            let hit = tracer.closest(self.position, direction, f32::INFINITY, blind);
            *texel = Texel { depth: hit.t, seen: hit.seen, bright: tracer.is_light(hit.seen) };
        }
        Some(map)
    }

    /// Where it was seen from, world metres.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// Texels along the side of a face.
    pub fn size(&self) -> usize {
        self.rays.faces[0].size
    }

    /// Texels of a face, row by row from the top.
    pub fn face(&self, face: CubeFace) -> &[Texel] {
        let n = self.rays.solid_angles.len();
        &self.texels[face as usize * n..][..n]
    }

    /// Every texel with its direction (of planar length 1) and its index within the face.
    pub(super) fn texels(&self) -> impl Iterator<Item = (&Texel, Vec3, usize)> {
        let n = self.rays.solid_angles.len();
        self.texels.iter().enumerate().map(move |(k, texel)| {
            let (face, i) = (k / n, k % n);
            (texel, self.rays.faces[face].directions[i], i)
        })
    }

    pub(super) fn rays(&self) -> &MapRays {
        &self.rays
    }

    /// Share of the texels that show sky or a burning lamp, 0..1.
    pub fn share(&self, weight: TexelWeight) -> f32 {
        self.mean(&self.texels, weight, |texel| if texel.bright { 1.0 } else { 0.0 })
    }

    /// Mean planar depth up to `range` metres, divided by it, 0..1.
    pub fn space(&self, range: f32, weight: TexelWeight) -> f32 {
        self.mean(&self.texels, weight, |texel| (texel.depth / range).min(1.0))
    }

    /// Radiance x solid angle of the visible sky over that of a full open sky of strength 1.
    pub fn sky_light(&self, sky: &Sky) -> f32 {
        let n = self.rays.solid_angles.len();
        let faces = self.texels.chunks(n).zip(&self.rays.faces);
        faces.map(|(texels, rays)| self.face_flux(texels, rays, sky)).sum::<f32>() / (4.0 * PI)
    }

    /// Sky light, lamps and sun, at most 1.
    pub fn light(&self, tracer: &Tracer, blind: &[u32]) -> f32 {
        (self.sky_light(&tracer.scene().sky) + direct_light(tracer, self.position, blind, LightRays::FINE))
            .clamp(0.0, 1.0)
    }

    /// What each face reads, space up to `range` metres.
    pub fn faces(&self, sky: &Sky, range: f32, weight: TexelWeight) -> [FaceReading; 6] {
        CubeFace::ALL.map(|face| {
            let texels = self.face(face);
            let space = self.mean(texels, weight, |texel| (texel.depth / range).min(1.0));
            FaceReading {
                face,
                share: self.mean(texels, weight, |texel| if texel.bright { 1.0 } else { 0.0 }),
                light: self.face_flux(texels, &self.rays.faces[face as usize], sky) / (4.0 * PI / 6.0),
                depth: space * range,
                space,
            }
        })
    }

    fn face_flux(&self, texels: &[Texel], rays: &FaceRays, sky: &Sky) -> f32 {
        let visible = texels.iter().enumerate().filter(|(_, texel)| texel.seen == Seen::Sky);
        let solid_angles = &self.rays.solid_angles;
        match sky.gradient {
            SkyGradient::Uniform => sky.strength * visible.map(|(i, _)| solid_angles[i]).sum::<f32>(),
            SkyGradient::Overcast => visible
                .map(|(i, _)| {
                    let d = rays.directions[i] / rays.squares[i].sqrt();
                    sky.radiance(d) * solid_angles[i]
                })
                .sum(),
        }
    }

    fn mean(&self, texels: &[Texel], weight: TexelWeight, value: impl Fn(&Texel) -> f32) -> f32 {
        match weight {
            TexelWeight::Alike => texels.iter().map(value).sum::<f32>() / texels.len() as f32,
            TexelWeight::SolidAngle => {
                let solid_angles = &self.rays.solid_angles;
                let n = solid_angles.len();
                let sum: f32 = texels.iter().enumerate().map(|(k, t)| value(t) * solid_angles[k % n]).sum();
                (sum / (4.0 * PI / 6.0 * (texels.len() / n) as f32)).min(1.0)
            }
        }
    }
}
