//! Base models of the figures: straight or plainly arched plants, and how they are drawn.

use bevy::math::{Quat, Vec3, ops};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::chance;
use crate::environment::{Capsule, LeafPatch, Scene};
use crate::plant::skeleton::Skeleton;
use crate::plant::{NO_PARENT, Pose};
use crate::shape::outline::LeafOutline;
use crate::tropism::turned_to;

/// 137.5 degrees.
const GOLDEN_ANGLE: f32 = 2.399_963_2;

/// What a segment of a model is drawn as.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// Wood.
    Stem,
    /// A strap of that half width (metres), where it is widest; a petal has the second look of the palette.
    Blade { half: f32, petal: bool },
    /// The midrib of a feather with leaflets of that length, metres.
    Frond { leaflet: f32 },
}

/// A skeleton and what its segments are.
#[derive(Debug, Clone, Default)]
pub struct Model {
    pub skeleton: Skeleton,
    /// For each segment: what it is, and which part of its axis it covers, 0 base to 1 tip.
    parts: Vec<(Part, [f32; 2])>,
}

impl Model {
    /// Adds a stem; see [`Skeleton::add_stem`].
    fn stem(&mut self, on: Option<u32>, points: &[Vec3], radii: [f32; 2], part: Part) -> Vec<u32> {
        let made = self.skeleton.add_stem(on, points, radii);
        let share = |k: usize| k as f32 / made.len() as f32;
        self.parts.extend((0..made.len()).map(|k| (part, [share(k), share(k + 1)])));
        made
    }

    /// Adds a stem from a point that begins in a direction and turns evenly towards another.
    fn arch(
        &mut self,
        on: Option<u32>,
        from: Vec3,
        ways: [Vec3; 2],
        length: f32,
        pieces: usize,
        look: Look,
    ) -> Vec<u32> {
        let mut points = vec![from];
        for k in 0..pieces {
            let share = if pieces > 1 { k as f32 / (pieces - 1) as f32 } else { 0.0 };
            let way = ways[0].lerp(ways[1], share).try_normalize().unwrap_or(ways[0]);
            points.push(points[k] + way * (length / pieces as f32));
        }
        self.stem(on, &points, look.radii, look.part)
    }

    /// Adds a sibling of this model, or its own skeleton, to a scene; petals as plant `plant + 1`.
    pub fn add_to(&self, sibling: &Skeleton, scene: &mut Scene, plant: u32) {
        let (mut base, mut done) = (0, 0.0);
        for (i, piece) in sibling.segments.iter().enumerate() {
            let Some((part, [from, to])) = self.parts.get(base).copied() else { return };
            let whole = self.skeleton.segments[base].length;
            let s = from + (to - from) * ((done + 0.5 * piece.length) / whole).min(1.0);
            done += piece.length;
            if piece.node {
                (base, done) = (base + 1, 0.0);
            }
            let (organ, along) = (i as u32, piece.pose.heading());
            let flat = along.cross(Vec3::Y).try_normalize().unwrap_or_else(|| piece.pose.rotation * Vec3::X);
            let mut leaf = |at: Vec3, midrib: Vec3, across: Vec3, outline: LeafOutline, plant: u32| {
                scene.leaves.push(LeafPatch { base: at, midrib, across, outline, organ, plant });
            };
            match part {
                Part::Blade { half, petal } => {
                    let width = half * LeafOutline::Lanceolate.half_width(s).max(0.08);
                    let midrib = along * piece.length * 1.25;
                    leaf(
                        piece.pose.position,
                        midrib,
                        flat * width,
                        LeafOutline::Needle,
                        plant + u32::from(petal),
                    );
                    continue;
                }
                Part::Frond { leaflet } => {
                    let length = leaflet * (0.35 + 0.65 * LeafOutline::Elliptic.half_width(s));
                    for side in [1.0, -1.0] {
                        let way = (flat * side + along * 0.65 - Vec3::Y * 0.5).normalize();
                        let across = way.cross(Vec3::Y).try_normalize().unwrap_or(along) * (0.045 * leaflet);
                        leaf(piece.pose.position, way * length, across, LeafOutline::Lanceolate, plant);
                    }
                }
                Part::Stem => {}
            }
            let radius = piece.radius;
            scene.capsules.push(Capsule { from: piece.pose.position, to: piece.tip(), radius, organ, plant });
        }
    }
}

/// Radii and part of a stem.
#[derive(Clone, Copy)]
struct Look {
    radii: [f32; 2],
    part: Part,
}

/// A direction by azimuth and elevation, radians.
fn aim(azimuth: f32, elevation: f32) -> Vec3 {
    let ((sin, cos), (up, flat)) = (ops::sin_cos(azimuth), ops::sin_cos(elevation));
    Vec3::new(cos * flat, up, sin * flat)
}

fn degrees(angle: f32) -> f32 {
    angle.to_radians()
}

/// A metre of lily: arched leaves in a spiral, four flowers.
pub fn lily() -> Model {
    let mut model = Model::default();
    let points: Vec<Vec3> = (0..=20).map(|k| Vec3::Y * (0.05 * k as f32)).collect();
    let stem = model.stem(None, &points, [0.007, 0.004], Part::Stem);
    for k in 2..18 {
        let (side, share) = (GOLDEN_ANGLE * k as f32, k as f32 / 18.0);
        let ways = [aim(side, degrees(55.0)), aim(side, degrees(-25.0))];
        let look = Look { radii: [0.001; 2], part: Part::Blade { half: 0.013, petal: false } };
        model.arch(Some(stem[k]), points[k + 1], ways, 0.24 - 0.1 * share, 8, look);
    }
    for k in 0..4 {
        let side = 0.4 + core::f32::consts::FRAC_PI_2 * k as f32;
        let way = aim(side, degrees(35.0));
        let look = Look { radii: [0.003, 0.002], part: Part::Stem };
        let pedicel = model.arch(Some(stem[19]), points[20], [aim(side, degrees(60.0)), way], 0.13, 6, look);
        let tip = model.skeleton.segments[pedicel[5] as usize].tip();
        let (u, v) = way.any_orthonormal_pair();
        for tepal in 0..6 {
            let (sin, cos) = ops::sin_cos(core::f32::consts::TAU * tepal as f32 / 6.0);
            let out = u * cos + v * sin;
            let ways = [(way + out * 0.5).normalize(), (out - way * 0.3).normalize()];
            let look = Look { radii: [0.001; 2], part: Part::Blade { half: 0.017, petal: true } };
            model.arch(Some(pedicel[5]), tip, ways, 0.1, 5, look);
        }
    }
    model
}

/// Horneophyton: leafless stems that fork evenly, a sporangium at every end.
pub fn horneophyton() -> Model {
    let mut model = Model::default();
    for k in 0..5 {
        let side = GOLDEN_ANGLE * k as f32;
        let from = aim(side, 0.0) * 0.022 * (k as f32).sqrt();
        let way = (Vec3::Y + aim(side, 0.0) * 0.16 * (k as f32).sqrt()).normalize();
        fork(&mut model, None, from, way, aim(side + 1.0, 0.0), 0);
    }
    model
}

fn fork(model: &mut Model, on: Option<u32>, from: Vec3, way: Vec3, across: Vec3, depth: usize) {
    const LENGTHS: [f32; 4] = [0.055, 0.045, 0.036, 0.026];
    let last = depth + 1 == LENGTHS.len();
    let radius = 0.0021 * (1.0 - 0.13 * depth as f32);
    let points: Vec<Vec3> = (0..=8).map(|k| from + way * (LENGTHS[depth] * k as f32 / 8.0)).collect();
    let made = model.stem(on, &points, [radius; 2], Part::Stem);
    if last {
        for index in &made[6..] {
            model.skeleton.segments[*index as usize].radius = 0.0026;
        }
        return;
    }
    let side = (across - way * across.dot(way)).normalize();
    for turn in [1.0, -1.0] {
        let (sin, cos) = ops::sin_cos(degrees(23.0 + 4.0 * turn));
        let to = way * cos + side * (sin * turn);
        // The next fork lies across this one, as they do.
        fork(model, Some(made[7]), points[8], to, to.cross(side).normalize() + side * 0.25, depth + 1);
    }
}

/// The same plant with each branch turned at its base to any side by up to an angle (radians), and straight.
pub fn random_angles(base: &Skeleton, most: f32, seed: u64) -> Skeleton {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut turns: Vec<Quat> = Vec::new();
    let mut varied = Skeleton::default();
    for stem in &base.segments {
        let below = base.segments.get(stem.parent as usize);
        let carried = turns.get(stem.parent as usize).copied().unwrap_or(Quat::IDENTITY);
        let turn = if below.is_none_or(|below| below.order != stem.order) {
            let frame = carried * stem.pose.rotation;
            let (angle, around) =
                (most * chance::unit(&mut rng), core::f32::consts::TAU * chance::unit(&mut rng));
            let ((sin, cos), (s, c)) = (ops::sin_cos(angle), ops::sin_cos(around));
            turned_to(frame, frame * Vec3::new(c * sin, cos, s * sin)) * stem.pose.rotation.inverse()
        } else {
            carried
        };
        let position = match below {
            None => stem.pose.position,
            Some(below) => {
                let tip = varied.segments[stem.parent as usize].tip();
                tip + carried * (stem.pose.position - below.tip())
            }
        };
        turns.push(turn.normalize());
        let rotation = (turn * stem.pose.rotation).normalize();
        varied
            .segments
            .push(crate::plant::skeleton::StemSegment { pose: Pose { position, rotation }, ..*stem });
    }
    debug_assert!(varied.segments.iter().all(|s| s.parent == NO_PARENT || s.length > 0.0));
    varied
}

/// A trunk with straight branches, as many and where chance says.
pub fn outward(seed: u64) -> Model {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut model = Model::default();
    let points: Vec<Vec3> = (0..=32).map(|k| Vec3::Y * (0.05 * k as f32)).collect();
    let trunk = model.stem(None, &points, [0.03, 0.012], Part::Stem);
    let count = 9 + (chance::unit(&mut rng) * 5.0) as usize;
    for n in 0..count {
        let place = 7 + ((n as f32 + chance::unit(&mut rng)) / count as f32 * 24.0) as usize;
        let side = GOLDEN_ANGLE * n as f32 + chance::unit(&mut rng) - 0.5;
        let length = 1.05 - 0.5 * place as f32 / 31.0;
        let way = aim(side, degrees(12.0));
        let look = Look { radii: [0.013, 0.005], part: Part::Stem };
        let branch = model.arch(Some(trunk[place]), points[place + 1], [way, way], length, 20, look);
        for (k, index) in branch.iter().enumerate().filter(|(k, _)| k % 3 == 2) {
            let leaf = (way + Quat::from_rotation_y(2.0 * k as f32) * Vec3::X * 0.8).normalize();
            model.arch(
                Some(*index),
                model.skeleton.segments[*index as usize].tip(),
                [leaf, leaf - Vec3::Y * 0.4],
                0.13,
                3,
                Look { radii: [0.001; 2], part: Part::Blade { half: 0.028, petal: false } },
            );
        }
    }
    model
}

/// A coconut palm: six metres of bare stem, two dozen fronds.
pub fn palm() -> Model {
    let mut model = Model::default();
    let points: Vec<Vec3> = (0..=60).map(|k| Vec3::Y * (0.1 * k as f32)).collect();
    let stem = model.stem(None, &points, [0.15, 0.1], Part::Stem);
    for k in 0..24 {
        let (side, age) = (GOLDEN_ANGLE * k as f32, k as f32 / 23.0);
        let rise = 82.0 - 92.0 * age;
        let ways = [aim(side, degrees(rise)), aim(side, degrees((rise - 75.0).max(-88.0)))];
        let look = Look { radii: [0.028, 0.008], part: Part::Frond { leaflet: 0.62 } };
        model.arch(Some(stem[59]), points[60], ways, 2.2 + 0.5 * age, 26, look);
    }
    model
}
