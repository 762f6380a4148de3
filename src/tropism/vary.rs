//! Varying a finished plant: its skeleton is grown again through the controller (`ST-10` to `ST-12`).
//!
//! Each segment of the base model is the course its sibling tries to keep. Lengths, nodes and corners stay; where
//! the stems lead is what chance and control make of it: siblings know neither walls nor ground. Siblings of one seed
//! are the same bit for bit.

use bevy::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use super::controller::{Control, Influence, Spread, Steering, nutation, step, turned_to};
use super::out_of_range::{OutOfRange, check};
use super::set_point::Tropisms;
use super::signals::Signals;
use crate::chance::mix;
use crate::environment::workers::Workers;
use crate::plant::skeleton::{Skeleton, SkeletonError, StemLeaf, StemSegment};
use crate::plant::{NO_PARENT, Pose};

/// Sub-steps along the longest axis unless told otherwise.
const SUBSTEPS: f32 = 60.0;
/// Most pieces a skeleton is cut into.
pub const MOST_PIECES: usize = 1_000_000;

/// How siblings differ from their base model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variation {
    /// Transfer function and lag.
    pub control: Control,
    /// Error of the sensor, standard deviation, radians.
    pub sensing_error: f32,
    /// Random disturbance of a sub-step, radians.
    pub disturbance: f32,
    /// How the disturbance is spread.
    pub spread: Spread,
    /// Steady disturbance of a sub-step that circles about the stem, radians.
    pub nutation: f32,
    /// Length of stem over which nutation circles once, metres.
    pub nutation_length: f32,
    /// Target relative to gravity (0), to the parent stem (1), or blended (`ST-11`).
    pub relative_to_parent: f32,
    /// Turn of the whole target, about the origin, from the base model's course: a plant that sets out upright bends
    /// over to it (`ST-12`, figure 14).
    pub lean: Quat,
    /// What else draws it; `photo` weighs the base model's own course.
    pub tropisms: Tropisms,
    /// Length of a sub-step, metres; `None`: a sixtieth of the longest axis. The last of a segment is cut to fit.
    pub sub_step: Option<f32>,
}

impl Default for Variation {
    fn default() -> Self {
        // Ratio 0.8 and a lag of 8 % of the longest axis where its segments are no shorter than a sub-step: inside the
        // useful range of `ST-6`. Twigs of fewer sub-steps than the lag end before they are corrected.
        Self {
            control: Control { gain: 0.25, lag: 5, ..Control::DIRECT },
            sensing_error: 5_f32.to_radians(),
            disturbance: 2.5_f32.to_radians(),
            spread: Spread::Gaussian,
            nutation: 0.0,
            nutation_length: 1.0,
            relative_to_parent: 0.0,
            lean: Quat::IDENTITY,
            tropisms: Tropisms { photo: 1.0, gravi: 0.0, ortho: 0.0, plagio: 0.0, auto: 0.0, reach: 1.0 },
            sub_step: None,
        }
    }
}

/// Why a skeleton could not be varied.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum VaryError {
    /// It is no skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// A part of the variation is out of range.
    #[error(transparent)]
    Setting(#[from] OutOfRange),
    /// The sub-step is too short for a skeleton so long.
    #[error("{pieces} sub-steps; at most {MOST_PIECES} are taken: use longer ones")]
    TooFine {
        /// Sub-steps there would be.
        pieces: u64,
    },
}

impl Variation {
    /// Checks it.
    ///
    /// # Errors
    /// The first part out of range.
    pub fn check(&self) -> Result<(), OutOfRange> {
        self.control.checked()?;
        let sub_step = self.sub_step.unwrap_or(1.0);
        check([
            ("the sensing error", self.sensing_error, 0.0, 2.0, "0 to 2 rad"),
            ("the disturbance", self.disturbance, 0.0, 2.0, "0 to 2 rad"),
            ("the nutation", self.nutation, 0.0, 2.0, "0 to 2 rad"),
            ("the length of a nutation", self.nutation_length, 1e-3, 1e3, "0.001 to 1000 m"),
            ("phototropism", self.tropisms.photo, 0.0, 100.0, "0 to 100"),
            ("gravitropism", self.tropisms.gravi, -100.0, 100.0, "-100 to 100"),
            ("orthotropism", self.tropisms.ortho, 0.0, 100.0, "0 to 100"),
            ("plagiotropism", self.tropisms.plagio, 0.0, 100.0, "0 to 100"),
            ("autotropism", self.tropisms.auto, 0.0, 100.0, "0 to 100"),
            ("the lean's quaternion, its length", self.lean.length(), 0.999, 1.001, "1"),
            ("the share relative to the parent", self.relative_to_parent, 0.0, 1.0, "0 to 1"),
            ("the sub-step", sub_step, 1e-5, 1e4, "0.00001 to 10000 m"),
            ("the reach of orthotropism", self.tropisms.reach, 1e-3, 1e4, "0.001 to 10000 m"),
        ])
    }

    /// Length of a sub-step for a skeleton, metres.
    fn sub_step(&self, skeleton: &Skeleton) -> f32 {
        self.sub_step.unwrap_or_else(|| {
            let mut axis = vec![0.0_f32; skeleton.segments.len()];
            let goes_on = goes_on(skeleton);
            for (i, stem) in skeleton.segments.iter().enumerate() {
                axis[i] = stem.length + if goes_on[i] { axis[stem.parent as usize] } else { 0.0 };
            }
            (axis.iter().fold(0.0, |a: f32, b| a.max(*b)) / SUBSTEPS).max(1e-5)
        })
    }
}

/// Of each segment, whether it goes on with the axis of the one it grows from. Where a stem forks into several of its
/// own order, each is an axis of its own, as in growth.
fn goes_on(skeleton: &Skeleton) -> Vec<bool> {
    let all = &skeleton.segments;
    let same_order =
        |stem: &StemSegment| all.get(stem.parent as usize).is_some_and(|p| p.order == stem.order);
    let mut heirs = vec![0_u32; all.len()];
    for stem in all.iter().filter(|stem| same_order(stem)) {
        heirs[stem.parent as usize] += 1;
    }
    all.iter().map(|stem| same_order(stem) && heirs[stem.parent as usize] == 1).collect()
}

/// A growing end of a sibling.
#[derive(Debug, Clone, Copy)]
struct End {
    /// Index of its last piece in the sibling.
    piece: u32,
    tip: Vec3,
    frame: Quat,
    steering: Steering,
    signals: Signals,
    /// Heading in which the axis left its parent.
    outset: Vec3,
    /// Turn from the base model to the sibling where the axis leaves its parent; of the first axis, the lean.
    carried: Quat,
    /// Length of the axis so far, metres.
    along: f32,
}

/// One sibling of a skeleton (CREATEVARIEDSKEL, `ST-10`): as many nodes, each segment as long.
///
/// Its segments are pieces of the base model's, a sub-step each.
///
/// # Errors
/// A skeleton that is none, or a variation out of range.
pub fn vary(base: &Skeleton, variation: &Variation, seed: u64) -> Result<Skeleton, VaryError> {
    let sub_step = prepare(base, variation)?;
    Ok(grow(base, variation, sub_step, seed))
}

/// Siblings by number, `first` and on, in parallel: number `n` of a seed is always the same.
///
/// # Errors
/// As [`vary`].
pub fn siblings(
    base: &Skeleton,
    variation: &Variation,
    seed: u64,
    count: usize,
    workers: &Workers,
) -> Result<Vec<Skeleton>, VaryError> {
    let sub_step = prepare(base, variation)?;
    Ok(workers.map(count, |n| grow(base, variation, sub_step, mix(seed ^ mix(n as u64 + 1)))))
}

/// Checks everything and gives the sub-step, metres.
fn prepare(base: &Skeleton, variation: &Variation) -> Result<f32, VaryError> {
    variation.check()?;
    base.check()?;
    let sub_step = variation.sub_step(base);
    let pieces = base.segments.iter().map(|s| (f64::from(s.length / sub_step)).ceil().max(1.0)).sum::<f64>();
    if pieces > MOST_PIECES as f64 {
        return Err(VaryError::TooFine { pieces: pieces as u64 });
    }
    Ok(sub_step)
}

/// `seed` with all else checked.
fn grow(base: &Skeleton, variation: &Variation, sub_step: f32, seed: u64) -> Skeleton {
    let mut sibling = Skeleton { segments: Vec::with_capacity(base.segments.len()), ..Skeleton::default() };
    let mut ends: Vec<End> = Vec::with_capacity(base.segments.len());
    let goes_on = goes_on(base);
    for (i, stem) in base.segments.iter().enumerate() {
        let mut end = begin(base, stem, goes_on[i], variation.lean, &ends);
        let course = stem.pose.heading();
        let carried = end.carried * course;
        let chosen = (variation.lean * course)
            .lerp(carried, variation.relative_to_parent)
            .try_normalize()
            .unwrap_or(carried);
        // A stream a segment: cutting another segment finer changes nothing here.
        let mut rng = Pcg64Mcg::seed_from_u64(mix(seed ^ mix(i as u64)));
        // The last sub-segment is cut to fit; one too short to see is joined to it.
        let pieces = (f64::from(stem.length) / f64::from(sub_step) - 1e-3).ceil().max(1.0) as u32;
        // Cut by number: what is left over would add up its roundings.
        let cut = |k: u32| f64::from(k) * f64::from(sub_step);
        for k in 1..=pieces {
            let last = k == pieces;
            let length = if last { f64::from(stem.length) - cut(k - 1) } else { cut(k) - cut(k - 1) } as f32;
            let heading = end.frame * Vec3::Y;
            let target = variation.tropisms.set_point(chosen, heading, end.outset, Vec3::Y, end.along);
            let influence = Influence {
                sensing: Spread::Gaussian.draw(variation.sensing_error, &mut rng),
                disturbance: variation.spread.draw(variation.disturbance, &mut rng)
                    + nutation(variation.nutation, variation.nutation_length, end.along),
            };
            let (steering, signals) = (&mut end.steering, &mut end.signals);
            let heading = step(&variation.control, steering, signals, end.frame, target, influence);
            end.frame = turned_to(end.frame, heading);
            let piece = StemSegment {
                parent: end.piece,
                pose: Pose { position: end.tip, rotation: end.frame },
                length,
                radius: stem.radius,
                order: stem.order,
                node: last && stem.node,
            };
            end.piece = sibling.segments.len() as u32;
            end.tip = piece.tip();
            end.along += length;
            sibling.segments.push(piece);
        }
        ends.push(end);
    }
    sibling.leaves.extend(base.leaves.iter().map(|leaf| {
        let (stem, end) = (&base.segments[leaf.on as usize], &ends[leaf.on as usize]);
        let turn = (end.frame * stem.pose.rotation.inverse()).normalize();
        let pose = Pose {
            position: end.tip + turn * (leaf.pose.position - stem.tip()),
            rotation: (turn * leaf.pose.rotation).normalize(),
        };
        StemLeaf { on: end.piece, pose, ..*leaf }
    }));
    sibling
}

/// Where a segment begins: at its parent's varied end, with the corner of the base model (`ST-11`).
fn begin(base: &Skeleton, stem: &StemSegment, goes_on: bool, lean: Quat, ends: &[End]) -> End {
    let Some(below) = base.segments.get(stem.parent as usize) else {
        return End {
            piece: NO_PARENT,
            tip: stem.pose.position,
            frame: stem.pose.rotation,
            steering: Steering::default(),
            signals: Signals::default(),
            outset: stem.pose.heading(),
            carried: lean,
            along: 0.0,
        };
    };
    let end = &ends[stem.parent as usize];
    let turn = (end.frame * below.pose.rotation.inverse()).normalize();
    let frame = (turn * stem.pose.rotation).normalize();
    let tip = end.tip + turn * (stem.pose.position - below.tip());
    if goes_on {
        // Corrections stay on their flank of the stem, however the base model's frames roll about it.
        let mut signals = end.signals;
        let unrolled = turned_to(end.frame, frame * Vec3::Y);
        signals.twist((unrolled.inverse() * frame).normalize());
        return End { tip, frame, signals, ..*end };
    }
    End {
        tip,
        frame,
        steering: Steering::default(),
        signals: Signals::default(),
        outset: frame * Vec3::Y,
        carried: turn,
        along: 0.0,
        ..*end
    }
}
