//! The controller: sensor, transfer function, signals, response (`ST-5` to `ST-8`, `ST-13`).

use bevy::math::{Vec2, ops};
use bevy::prelude::*;
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

use super::out_of_range::{OutOfRange, check};
use super::signals::{LONGEST_LAG, Signals};
use crate::chance;
use crate::species::Species;

/// Errors below this are not felt, radians: rounding must not grow into a bend where control is unstable.
const THRESHOLD: f32 = 1e-6;
/// Turns below this are rounding, radians.
const ROUNDING: f32 = 2e-7;
/// Turns below this would be lost in rounding, radians: they wait until they have added up to so much.
const LEAST_TURN: f32 = 1e-6;

/// How far a growing bud has steered. Signals on their way are in [`Signals`], which comes with it.
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
#[require(Signals)]
pub struct Steering {
    /// Sub-steps steered so far.
    pub substeps: u32,
}

/// The transfer function: what correction follows from a sensed error, and when (`ST-5`, `ST-13`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Control {
    /// Share of the sensed error corrected at each sub-step (the paper's kappa).
    pub gain: f32,
    /// Of the sum of all errors, times `gain`: takes away what a steady disturbance leaves.
    pub integral: f32,
    /// Of the change of the error, times `gain`: damps.
    pub derivative: f32,
    /// Sub-steps until a correction takes effect; 0: at once.
    pub lag: u32,
}

impl Control {
    /// The target is reached at once: that of `lam_king`.
    pub const DIRECT: Self = Self { gain: 1.0, integral: 0.0, derivative: 0.0, lag: 0 };

    /// Proportional control by gain and lag.
    ///
    /// # Errors
    /// A gain that is not within 0 to 100, or a lag above [`LONGEST_LAG`].
    pub fn new(gain: f32, lag: u32) -> Result<Self, OutOfRange> {
        Self { gain, lag, ..Self::DIRECT }.checked()
    }

    /// Proportional control by compensation ratio and lag: the ratio is `1 / (gain lag)` (`ST-6`); without lag,
    /// `1 / gain`.
    ///
    /// # Errors
    /// A ratio that is not within 0.01 to 100, or a lag above [`LONGEST_LAG`].
    pub fn of_ratio(ratio: f32, lag: u32) -> Result<Self, OutOfRange> {
        check([("the compensation ratio", ratio, 0.01, 100.0, "0.01 to 100")])?;
        Self::new(1.0 / (ratio * lag.max(1) as f32), lag)
    }

    /// That of a species, whose parameters are in range.
    pub fn of(species: &Species) -> Self {
        let lag = species.steering_lag.min(LONGEST_LAG);
        Self {
            gain: 1.0 / (species.compensation_ratio.max(0.01) * lag.max(1) as f32),
            integral: species.steering_integral,
            derivative: species.steering_derivative,
            lag,
        }
    }

    /// Its compensation ratio, `1 / (gain lag)`; without lag, `1 / gain`.
    pub fn ratio(&self) -> f32 {
        1.0 / (self.gain * self.lag.max(1) as f32)
    }

    /// Checks it.
    ///
    /// # Errors
    /// The first part out of range.
    pub fn checked(self) -> Result<Self, OutOfRange> {
        check([
            ("the gain", self.gain, 0.0, 100.0, "0 to 100"),
            ("integral control", self.integral, 0.0, 1.0, "0 to 1"),
            ("derivative control", self.derivative, 0.0, 10.0, "0 to 10"),
            ("the lag", self.lag as f32, 0.0, LONGEST_LAG as f32, "0 to 30 sub-steps"),
        ])?;
        Ok(self)
    }

    /// The correction that answers an error, both leans in radians.
    fn correction(&self, error: Vec2, signals: &mut Signals, first: bool) -> Vec2 {
        let mut answer = error;
        if self.integral != 0.0 {
            // An error cannot be undone by more than half a turn: the sum is held there.
            signals.sum = (signals.sum + error).clamp_length_max(core::f32::consts::PI / self.integral);
            answer += signals.sum * self.integral;
        }
        if self.derivative != 0.0 {
            let before = if first { error } else { signals.last };
            answer += (error - before) * self.derivative;
            signals.last = error;
        }
        answer * self.gain
    }
}

/// How a random influence is spread (`ST-8`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum Spread {
    /// Normal, the given angle its standard deviation.
    #[default]
    Gaussian,
    /// Even from 0 to the given angle.
    Uniform,
}

impl Spread {
    /// A lean of random size (scale `angle`, radians) to a random side: radial about the stem. Without an angle
    /// nothing is drawn.
    pub fn draw(self, angle: f32, rng: &mut Pcg64Mcg) -> Vec2 {
        if angle == 0.0 {
            return Vec2::ZERO;
        }
        let size = match self {
            Self::Gaussian => chance::normal(rng).abs(),
            Self::Uniform => chance::unit(rng),
        };
        lean(size * angle, chance::unit(rng) * core::f32::consts::TAU)
    }
}

/// A lean by an angle towards the side of the stem at `around`, both radians: along local x at 0, z at a quarter.
pub fn lean(angle: f32, around: f32) -> Vec2 {
    let (sin, cos) = ops::sin_cos(around);
    Vec2::new(cos, sin) * angle
}

/// The disturbance by nutation: a lean of `angle` (radians) that circles about the stem once every `length` of the
/// `along` metres that it has grown.
pub fn nutation(angle: f32, length: f32, along: f32) -> Vec2 {
    match angle == 0.0 {
        true => Vec2::ZERO,
        false => lean(angle, along / length * core::f32::consts::TAU),
    }
}

/// What acts on one sub-step besides the target: leans in radians (`ST-8`).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Influence {
    /// Error with which the tip senses its own heading: the controller answers it as if it were true.
    pub sensing: Vec2,
    /// Disturbance from outside: not answered until it is sensed in the next sub-step.
    pub disturbance: Vec2,
}

impl Influence {
    /// What acts on a shoot of a species whose axis is `along` metres long, drawn from one stream each for sensing
    /// and wandering.
    pub fn of(species: &Species, along: f32, sensing: &mut Pcg64Mcg, wander: &mut Pcg64Mcg) -> Self {
        let mut disturbance = species.wander_spread.draw(species.wander_deg.to_radians(), wander);
        disturbance += nutation(species.nutation_deg.to_radians(), species.nutation_m, along);
        Self { sensing: Spread::Gaussian.draw(species.sensing_error_deg.to_radians(), sensing), disturbance }
    }
}

/// One sub-step of steering (`ST-5`): the heading that follows, a unit vector.
///
/// `frame` is the turn of the tip (its heading is local +Y), `target` the set point, a unit vector in the same world.
/// A target straight behind is turned to as well: the tip leans to its own x side.
pub fn step(
    control: &Control,
    steering: &mut Steering,
    signals: &mut Signals,
    frame: Quat,
    target: Vec3,
    influence: Influence,
) -> Vec3 {
    let first = steering.substeps == 0;
    steering.substeps = steering.substeps.saturating_add(1);
    if *control == Control::DIRECT && influence == Influence::default() && signals.is_silent() {
        return target;
    }
    let goal = frame.inverse() * target;
    let sensed = leaned(influence.sensing);
    let correction = control.correction(error(sensed, goal), signals, first);
    signals.send(correction, control.lag);
    let mut response = signals.receive() + influence.disturbance;
    if response.length_squared() < LEAST_TURN * LEAST_TURN {
        signals.send(response, 0);
        response = Vec2::ZERO;
    }
    (frame * leaned(response)).try_normalize().unwrap_or(target)
}

/// The frame of a tip after it has turned to a heading, a unit vector, without rolling.
///
/// Unlike [`Quat::from_rotation_arc`] it keeps turns far below a thousandth of a radian.
pub fn turned_to(frame: Quat, heading: Vec3) -> Quat {
    let before = frame * Vec3::Y;
    let (cross, dot) = (before.cross(heading), before.dot(heading));
    if dot > 0.0 && cross.length_squared() < ROUNDING * ROUNDING {
        return frame.normalize();
    }
    let turn = match dot > -0.999_999 {
        true => Quat::from_xyzw(cross.x, cross.y, cross.z, 1.0 + dot).normalize(),
        false => {
            // Half a turn, towards the tip's own x side.
            let axis = frame * Vec3::NEG_Z;
            Quat::from_xyzw(axis.x, axis.y, axis.z, 0.0)
        }
    };
    (turn * frame).normalize()
}

/// The local heading of a tip that leans from +Y.
fn leaned(lean: Vec2) -> Vec3 {
    let angle = lean.length();
    if angle < ROUNDING {
        return Vec3::Y;
    }
    let (sin, cos) = ops::sin_cos(angle);
    let side = lean / angle;
    Vec3::new(side.x * sin, cos, side.y * sin)
}

/// The lean that turns `sensed` to `goal`, both in the frame of the tip.
fn error(sensed: Vec3, goal: Vec3) -> Vec2 {
    let cross = sensed.cross(goal);
    let angle = ops::atan2(cross.length(), sensed.dot(goal));
    if angle.is_nan() || angle < THRESHOLD {
        return Vec2::ZERO;
    }
    // Straight behind, any axis across the stem will do; in the tip's frame it turns with the plant.
    let axis = match cross.try_normalize() {
        Some(axis) if core::f32::consts::PI - angle > 1e-4 => axis,
        _ => (Vec3::NEG_Z - sensed * sensed.dot(Vec3::NEG_Z)).try_normalize().unwrap_or(Vec3::X),
    };
    // Turning about `axis` leans +Y to `axis x Y`; what is left of it along the stem is a roll.
    Vec2::new(-axis.z, axis.x) * angle
}

/// Whether shoots of a species may end another way than the one light and space chose, with nothing in their way.
pub fn wavers(species: &Species) -> bool {
    let disturbed = species.wander_deg > 0.0 || species.sensing_error_deg > 0.0 || species.nutation_deg > 0.0;
    let drawn = [&species.gravitropism, &species.orthotropism, &species.plagiotropism, &species.autotropism];
    disturbed
        || Control::of(species) != Control::DIRECT
        || drawn.iter().any(|by| by.0.iter().any(|w| *w != 0.0))
        || species.phototropism.0.contains(&0.0)
}
