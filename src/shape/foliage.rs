//! Foliage: the blades a leaf organ stands for, in the world.
//!
//! A leaf organ of a few blades is a short leafy shoot, or a compound leaf: its blades leave a stalk along the
//! organ's heading in one of a few forms. Each lies flat, turned about its midrib until it faces the sky, as leaves
//! do.

use bevy::math::ops;
use bevy::prelude::*;
use smallvec::SmallVec;

use serde::{Deserialize, Serialize};

use super::outline::LeafOutline;
use crate::chance::{mix, share};
use crate::environment::LeafPatch;
use crate::environment::direct_light::GOLDEN_ANGLE;
use crate::plant::{Lineage, Pose};
use crate::species::Species;

/// Length of a petiole as a share of its blade's.
const PETIOLE: f32 = 0.15;
/// Stalk between two blades of an organ as a share of a blade's length.
const STALK: f32 = 0.1;
/// Longest stalk as a share of a blade's length.
const LONGEST_STALK: f32 = 1.5;
/// Angle between stalk and blade at the base and the end of the stalk, radians.
const SPREAD: [f32; 2] = [1.31, 0.35];
/// How much of its slope a broad blade keeps when it turns level.
const SLOPE_KEPT: f32 = 0.5;
/// Largest random part of a blade's direction, along each axis.
const JITTER: f32 = 0.15;
/// How the blades of a leaf organ stand on the stalk they share.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum FoliageForm {
    /// At the golden angle about the stalk, spread wide at its base and close to it at its end: a twig's end.
    #[default]
    Tuft,
    /// Left and right of it in one level plane: a beech twig.
    Spray,
    /// All round and all along, slanting forward: a needled shoot.
    Needles,
    /// Left and right, close together, shorter towards the end of a stalk that arches: a palm's leaf.
    Frond,
}

impl FoliageForm {
    /// How many of the largest blades the blades of an organ cover together.
    pub fn blades(self, blades: u32) -> f32 {
        (0..blades.max(1)).map(|i| station(self, i, blades.max(1)).size.powi(2)).sum()
    }
}

/// One flat blade in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blade {
    /// Where its petiole leaves the stalk, metres.
    pub stalk: Vec3,
    /// Where the blade begins, metres.
    pub base: Vec3,
    /// From base to tip, metres.
    pub midrib: Vec3,
    /// From the midrib to the margin where the blade is widest, metres; level wherever the midrib is not upright.
    pub across: Vec3,
}

impl Blade {
    /// Unit normal of its upper side.
    pub fn normal(&self) -> Vec3 {
        self.across.cross(self.midrib).try_normalize().unwrap_or(Vec3::Y)
    }

    /// The blade as a scene holds it.
    pub fn patch(&self, outline: LeafOutline, organ: u32, plant: u32) -> LeafPatch {
        LeafPatch { base: self.base, midrib: self.midrib, across: self.across, outline, organ, plant }
    }
}

/// How one blade stands on the stalk, before chance.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Station {
    /// Direction of the blade in the organ's frame, stalk along +Y.
    direction: Vec3,
    /// Distance along the stalk, as a share of its length.
    along: f32,
    /// Length as a share of the longest blade's.
    size: f32,
}

/// How a species arranges the blades of its leaf organs: made once a plant, asked once a leaf.
#[derive(Debug, Clone, PartialEq)]
pub struct Foliage {
    /// Outline of each blade.
    pub outline: LeafOutline,
    form: FoliageForm,
    length: f32,
    half_width: f32,
    stalk: f32,
    petiole: f32,
    slope_kept: f32,
    hang: f32,
    stations: SmallVec<[Station; 8]>,
}

impl Foliage {
    /// The foliage of a species.
    pub fn of(species: &Species) -> Self {
        let form = species.foliage;
        let blades = species.leaf_cluster.max(1);
        let shortest = species.leaf_length_m * (STALK * (blades - 1) as f32).min(LONGEST_STALK);
        let needles = form == FoliageForm::Needles || species.leaf_outline == LeafOutline::Needle;
        Self {
            outline: species.leaf_outline,
            form,
            length: species.leaf_length_m,
            half_width: 0.5 * species.leaf_width_m,
            stalk: if species.foliage_length_m > 0.0 { species.foliage_length_m } else { shortest },
            petiole: if form == FoliageForm::Tuft { PETIOLE } else { 0.0 },
            slope_kept: if needles { 1.0 } else { SLOPE_KEPT },
            hang: species.leaf_hang,
            stations: (0..blades).map(|i| station(form, i, blades)).collect(),
        }
    }

    /// Blades of a leaf organ.
    pub fn blades_per_leaf(&self) -> usize {
        self.stations.len()
    }

    /// The blades of a leaf whose area is the share `size` of the largest (0..1).
    ///
    /// Chance comes from the lineage alone: a leaf keeps its look while it grows, whatever stands around it.
    pub fn blades(&self, pose: &Pose, size: f32, lineage: Lineage) -> impl Iterator<Item = Blade> + '_ {
        let scale = size.max(0.0).sqrt();
        let (length, half_width) = (self.length * scale, self.half_width * scale);
        let Pose { position, rotation } = *pose;
        let heading = rotation * Vec3::Y;
        let frame = match self.form {
            FoliageForm::Tuft | FoliageForm::Needles => {
                let phase = share(mix(lineage.0)) * core::f32::consts::TAU;
                rotation * Quat::from_xyzw(0.0, ops::sin(0.5 * phase), 0.0, ops::cos(0.5 * phase))
            }
            FoliageForm::Spray | FoliageForm::Frond => level_frame(rotation),
        };
        let mut stalk = position;
        let mut reached = 0.0;
        self.stations.iter().enumerate().map(move |(i, station)| {
            // The stalk sinks towards its end.
            let way = (heading + Vec3::NEG_Y * (self.hang * 1.6 * station.along)).normalize_or(heading);
            stalk += way * ((station.along - reached) * self.stalk * scale);
            reached = station.along;
            let turned = match self.form {
                FoliageForm::Frond => Quat::from_rotation_arc(heading, way),
                _ => Quat::IDENTITY,
            };
            let mut direction =
                turned * (frame * station.direction) + jitter(mix(lineage.0 ^ (i as u64 + 1)));
            direction.y *= self.slope_kept;
            let direction = direction.normalize_or(heading).lerp(Vec3::NEG_Y, self.hang);
            let direction = direction.try_normalize().unwrap_or(heading);
            let across = direction
                .cross(Vec3::Y)
                .try_normalize()
                .or_else(|| direction.cross(rotation * Vec3::Z).try_normalize())
                .unwrap_or_else(|| direction.any_orthonormal_vector());
            Blade {
                stalk,
                base: stalk + direction * (self.petiole * length),
                midrib: direction * (length * station.size),
                across: across * (half_width * station.size),
            }
        })
    }
}

/// A turn that takes +Y to the organ's heading and +X to the level.
fn level_frame(rotation: Quat) -> Quat {
    let heading = rotation * Vec3::Y;
    let side = heading.cross(Vec3::Y).try_normalize().unwrap_or(rotation * Vec3::X);
    Quat::from_mat3(&Mat3::from_cols(side, heading, side.cross(heading)))
}

/// How the `i`-th of some blades stands.
fn station(form: FoliageForm, i: u32, blades: u32) -> Station {
    if blades == 1 {
        return Station { direction: Vec3::Y, along: 0.0, size: 1.0 };
    }
    let along = i as f32 / (blades - 1) as f32;
    let leaving = |angle: f32, azimuth: f32| {
        let ((sin, cos), (turn_sin, turn_cos)) = (ops::sin_cos(angle), ops::sin_cos(azimuth));
        Vec3::new(sin * turn_cos, cos, sin * turn_sin)
    };
    let side = if i.is_multiple_of(2) { 0.0 } else { core::f32::consts::PI };
    let spread = |from: f32, to: f32| from + (to - from) * along;
    match form {
        FoliageForm::Tuft => Station {
            direction: leaving(spread(SPREAD[0], SPREAD[1]), GOLDEN_ANGLE * i as f32),
            along,
            size: 1.0,
        },
        FoliageForm::Spray => Station { direction: leaving(spread(1.05, 0.6), side), along, size: 1.0 },
        FoliageForm::Needles => {
            Station { direction: leaving(spread(1.0, 0.45), GOLDEN_ANGLE * i as f32), along, size: 1.0 }
        }
        FoliageForm::Frond => {
            // A bare foot, then leaflets that shorten towards the end.
            let along = 0.18 + 0.82 * along;
            let direction = leaving(spread(1.25, 0.5), side);
            Station { direction, along, size: (1.0 - 0.75 * (2.0 * along - 1.0).powi(2)).max(0.2) }
        }
    }
}

fn jitter(bits: u64) -> Vec3 {
    let part = |shift: u32| ((bits >> shift) & 0xFFFF) as f32 / 32_768.0 - 1.0;
    Vec3::new(part(0), part(16), part(32)) * JITTER
}

#[cfg(test)]
mod tests {
    use super::*;

    fn oak() -> Species {
        Species { leaf_cluster: 12, leaf_outline: LeafOutline::Lobed, ..Species::default() }
    }

    fn blades(species: &Species, rotation: Quat, size: f32, lineage: u64) -> Vec<Blade> {
        let pose = Pose { position: Vec3::new(1.0, 2.0, 3.0), rotation };
        Foliage::of(species).blades(&pose, size, Lineage(lineage)).collect()
    }

    const FORMS: [FoliageForm; 4] =
        [FoliageForm::Tuft, FoliageForm::Spray, FoliageForm::Needles, FoliageForm::Frond];

    #[test]
    fn blades_together_have_the_area_of_the_leaf() {
        for (foliage, leaf_cluster) in FORMS.into_iter().flat_map(|form| [(form, 1), (form, 12)]) {
            let species = Species { foliage, leaf_cluster, ..oak() };
            for size in [0.0, 0.3, 1.0] {
                let blades = blades(&species, Quat::IDENTITY, size, 7);
                assert_eq!(blades.len(), leaf_cluster as usize);
                let area: f32 = blades
                    .iter()
                    .map(|b| b.midrib.length() * 2.0 * b.across.length() * species.leaf_outline.fill())
                    .sum();
                assert!((area - size * species.leaf_area()).abs() < 1e-5, "{foliage:?} {size} {area}");
            }
        }
    }

    #[test]
    fn sprays_and_fronds_lie_in_two_rows_and_needles_stand_all_round() {
        // A stalk along +X.
        let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
        for foliage in FORMS {
            let all = blades(&Species { foliage, foliage_length_m: 0.3, ..oak() }, level, 1.0, 3);
            let ways: Vec<Vec3> = all.iter().map(|blade| blade.midrib.normalize()).collect();
            let ranked = ways.windows(2).all(|pair| pair[0].z * pair[1].z < 0.0);
            let steepest = ways.iter().map(|way| way.y.abs()).fold(0.0, f32::max);
            let reach = all.iter().map(|blade| blade.stalk.x - 1.0).fold(0.0, f32::max);
            assert!((reach - 0.3).abs() < 1e-5, "{foliage:?}: blades along the stalk to its end, {reach} m");
            match foliage {
                FoliageForm::Spray | FoliageForm::Frond => {
                    assert!(ranked && steepest < 0.3, "{foliage:?}: {ways:?}");
                }
                FoliageForm::Needles => {
                    assert!(!ranked && steepest > 0.5, "{ways:?}");
                    assert!(ways.iter().all(|way| way.x > 0.0), "slanting forward: {ways:?}");
                }
                FoliageForm::Tuft => assert!(!ranked && steepest > 0.2, "{ways:?}"),
            }
        }
    }

    #[test]
    fn blades_lie_flat_under_the_sky() {
        for (turn, lineage) in [(0.0, 1), (1.0, 2), (2.5, 3), (core::f32::consts::PI, 4)] {
            for blade in blades(&oak(), Quat::from_rotation_z(turn), 1.0, lineage) {
                assert!(blade.normal().y >= 0.0);
                assert!(blade.midrib.dot(blade.across).abs() < 1e-6);
            }
        }
        let level = blades(&Species::default(), Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2), 1.0, 5);
        assert_eq!(level.len(), 1);
        assert!(level[0].normal().y > 0.95);
    }

    #[test]
    fn a_leaf_keeps_its_look_as_it_grows_and_differs_from_its_neighbour() {
        let small = blades(&oak(), Quat::IDENTITY, 0.25, 9);
        let large = blades(&oak(), Quat::IDENTITY, 1.0, 9);
        for (s, l) in small.iter().zip(&large) {
            assert!((s.midrib * 2.0 - l.midrib).length() < 1e-6);
        }
        assert_ne!(large, blades(&oak(), Quat::IDENTITY, 1.0, 10));
    }

    #[test]
    fn blades_fan_to_all_sides() {
        let all = blades(&oak(), Quat::IDENTITY, 1.0, 3);
        let mean = all.iter().map(|b| b.midrib.normalize()).sum::<Vec3>() / all.len() as f32;
        assert!(mean.with_y(0.0).length() < 0.2, "{mean}");
    }
}
