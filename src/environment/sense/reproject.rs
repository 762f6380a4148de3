//! One cube map at a bud, re-projected to the places it could grow to.
//!
//! A texel of direction d (unit) and solid angle w that saw something at distance t is a patch at X = t d. Seen
//! from a candidate at offset v the patch lies along X' = X - v at distance t' = |X'|. Its solid angle scales
//! with 1 / t'², and if it is flat with normal n also with the cosine of its slant:
//!
//! w' = w (t / t')² (|n . X'| / t') / (|n . d|)
//!
//! Near patches would exceed what fits around a point, so each is taken for a disc that faces the candidate:
//! of area A at distance t' it fills w' = 2 pi (1 - 1 / sqrt(1 + A / (pi t'²))), which is A / t'² when small,
//! with A chosen to give w at t' = t. From this
//!
//! - light' = open sky - sum over patches of w' x (radiance along X'),
//! - space' = 1 - sum over patches of w' x (1 - depth' / range), depth' the planar depth of X',
//!
//! sums relative to the sphere; where texels count alike, solid angles are weighted by the number of texels
//! they cover there, 1 / (24 cos³) a steradian with the cosine to the nearest face's axis. At v = 0 both are
//! the map's own readings.
//!
//! The infinite ground needs no patches: from any height it fills the same directions, at a depth
//! proportional to the height. Things far beyond the reach stay where they are. What the bud does not see is
//! not there: that, and patches that come to lie behind each other, is what the fast way gives away.

use std::f32::consts::{PI, TAU};

use bevy::math::Vec3;

use super::search::Reading;
use crate::environment::cube_map::CubeMap;
use crate::environment::probe::TexelWeight;
use crate::environment::scene::Sky;
use crate::environment::trace::{Seen, Tracer};
use crate::species::LightReading;

/// Things this many times the reach away stay where they are.
const FAR: f32 = 32.0;
/// Most that a patch may grow by turning its face to a candidate.
const SLANT: f32 = 4.0;

/// Something the bud saw near by.
#[derive(Debug, Clone, Copy)]
struct Patch {
    /// Seen from the bud, metres.
    at: Vec3,
    /// Area of its disc over pi, square metres.
    size: f32,
    /// Normal if it is flat, over the cosine of its slant seen from the bud; zero if it is round.
    normal: Vec3,
    /// Whether it hides light; a burning lamp may not.
    hides: bool,
}

/// A texel that saw the ground.
#[derive(Debug, Clone, Copy)]
struct Floor {
    weight: f32,
    /// Planar depth for each metre of height.
    slope: f32,
}

/// How the weight of solid angles is reckoned.
#[derive(Debug, Clone, Copy)]
enum Density {
    Texels,
    Sphere,
}

impl Density {
    /// Weight of a steradian along `x`, of length `t` and planar depth `depth`.
    fn at(self, t: f32, depth: f32) -> f32 {
        match self {
            Self::Texels => {
                let slant = t / depth;
                slant * slant * slant / 24.0
            }
            Self::Sphere => 1.0 / (4.0 * PI),
        }
    }
}

pub(super) struct Reprojection {
    patches: Vec<Patch>,
    floor: Vec<Floor>,
    height: f32,
    sky: Option<Sky>,
    light_density: Density,
    space_density: Density,
    range: f32,
    /// Light if all patches were away.
    light: f32,
    /// Space if all patches and the floor were away.
    space: f32,
}

impl Reprojection {
    pub(super) fn new(
        tracer: &Tracer,
        map: &CubeMap,
        reading: LightReading,
        weight: TexelWeight,
        sky: &Sky,
        reach: f32,
        range: f32,
    ) -> Self {
        let space_density = match weight {
            TexelWeight::Alike => Density::Texels,
            TexelWeight::SolidAngle => Density::Sphere,
        };
        let (sky, light_density, light_weight) = match reading {
            LightReading::Share => (None, space_density, weight),
            LightReading::Radiance => (Some(*sky), Density::Sphere, TexelWeight::SolidAngle),
        };
        let mut this = Self {
            patches: Vec::new(),
            floor: Vec::new(),
            height: map.position().y - tracer.scene().ground.unwrap_or(0.0),
            sky,
            light_density,
            space_density,
            range,
            light: 0.0,
            space: 0.0,
        };
        for (texel, ray, i) in map.texels() {
            let length = ray.length();
            let depth = texel.depth;
            let t = depth * length;
            let bright = if sky.is_some() { texel.seen == Seen::Sky } else { texel.bright };
            let light = this.radiance(ray / length) * map.rays().weight(i, light_weight);
            let share = map.rays().weight(i, weight);
            if texel.seen == Seen::Ground {
                this.floor.push(Floor { weight: share, slope: 1.0 / ray.y.abs().max(1e-6) });
                this.space += share;
            } else if texel.seen == Seen::Sky || t > FAR * reach {
                this.light += if bright { light } else { 0.0 };
                this.space += share * (depth / range).min(1.0);
            } else {
                let solid_angle = share / space_density.at(length, 1.0);
                let facing = 1.0 - solid_angle.min(6.0) / TAU;
                let at = ray * depth;
                let normal = tracer
                    .flat_normal(texel.seen, map.position() + at)
                    .map_or(Vec3::ZERO, |n| n / (n.dot(ray).abs() / length).max(1e-3));
                let size = t * t * (1.0 / (facing * facing) - 1.0);
                this.patches.push(Patch { at, size, normal, hides: !bright });
                this.light += light;
                this.space += share;
            }
        }
        this
    }

    /// Light (without lamps and sun, unless texels are counted) and space at an offset from the bud.
    pub(super) fn at(&self, offset: Vec3) -> Reading {
        let (mut hidden, mut filled) = (0.0_f32, 0.0_f32);
        for patch in &self.patches {
            let x = patch.at - offset;
            let tt = x.length_squared().max(1e-12);
            let t = tt.sqrt();
            let depth = x.abs().max_element().max(1e-7);
            let slant =
                if patch.normal == Vec3::ZERO { 1.0 } else { (patch.normal.dot(x).abs() / t).min(SLANT) };
            let solid_angle = TAU * (1.0 - 1.0 / (1.0 + patch.size * slant / tt).sqrt());
            if patch.hides {
                hidden += solid_angle * self.light_density.at(t, depth) * self.radiance(x / t);
            }
            if depth < self.range {
                filled += solid_angle * self.space_density.at(t, depth) * (1.0 - depth / self.range);
            }
        }
        let height = (self.height + offset.y).max(0.0);
        for floor in &self.floor {
            filled += floor.weight * (1.0 - height * floor.slope / self.range).max(0.0);
        }
        Reading { light: (self.light - hidden).clamp(0.0, 1.0), space: (self.space - filled).clamp(0.0, 1.0) }
    }

    fn radiance(&self, d: Vec3) -> f32 {
        self.sky.as_ref().map_or(1.0, |sky| sky.radiance(d))
    }
}

#[cfg(test)]
mod tests {
    use bevy::math::Quat;

    use super::*;
    use crate::environment::scene::{Capsule, Scene, SkyGradient, SolidShape, StandingSolid};

    const WEIGHTS: [TexelWeight; 2] = [TexelWeight::Alike, TexelWeight::SolidAngle];

    /// Largest difference from maps rendered at the offsets, light and space.
    fn errors(scene: &Scene, offsets: &[Vec3]) -> (f32, f32) {
        let tracer = Tracer::build(scene);
        let map = CubeMap::render(&tracer, Vec3::ZERO, 16, &[]);
        let (mut light, mut space) = (0.0_f32, 0.0_f32);
        for weight in WEIGHTS {
            for reading in [LightReading::Share, LightReading::Radiance] {
                let fast = Reprojection::new(&tracer, &map, reading, weight, &scene.sky, 0.2, 1.0);
                for &offset in offsets {
                    let there = CubeMap::render(&tracer, offset, 32, &[]);
                    let real = match reading {
                        LightReading::Share => there.share(weight),
                        LightReading::Radiance => there.sky_light(&scene.sky),
                    };
                    let got = fast.at(offset);
                    light = light.max((got.light - real).abs());
                    space = space.max((got.space - there.space(1.0, weight)).abs());
                }
            }
        }
        (light, space)
    }

    fn offsets() -> Vec<Vec3> {
        [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(-0.6, 0.0, 0.8)].map(|d| d * 0.2).to_vec()
    }

    fn overcast() -> Sky {
        Sky { strength: 1.0, gradient: SkyGradient::Overcast }
    }

    #[test]
    fn lk_15_over_open_ground_both_ways_agree() {
        let scene = Scene { ground: Some(-0.3), sky: overcast(), ..Scene::default() };
        let (light, space) = errors(&scene, &offsets());
        assert!(light < 0.01 && space < 0.01, "{light} {space}");
    }

    #[test]
    fn lk_15_beside_a_wall_both_ways_agree() {
        let wall = StandingSolid {
            shape: SolidShape::Box { size: Vec3::new(0.1, 20.0, 20.0) },
            position: Vec3::X * 0.55,
            rotation: Quat::IDENTITY,
            color: [0.5; 3],
        };
        let scene = Scene { solids: vec![wall], sky: overcast(), ..Scene::default() };
        let (light, space) = errors(&scene, &offsets());
        assert!(light < 0.04 && space < 0.04, "{light} {space}");
    }

    #[test]
    fn lk_15_under_a_branch_both_ways_agree() {
        let branch = Capsule {
            from: Vec3::new(0.1, 0.6, -3.0),
            to: Vec3::new(0.1, 0.6, 3.0),
            radius: 0.08,
            organ: 1,
            plant: 0,
        };
        let scene = Scene { capsules: vec![branch], sky: overcast(), ..Scene::default() };
        let (light, space) = errors(&scene, &offsets());
        assert!(light < 0.04 && space < 0.04, "{light} {space}");
    }
}
