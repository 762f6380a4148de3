//! Signals on their way from the tip to the zone of growth.

use bevy::math::Vec2;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// Longest lifetime of a signal, sub-steps.
pub const LONGEST_LAG: u32 = 30;
const SLOTS: usize = LONGEST_LAG as usize + 1;

/// Corrections a growing bud has sent and that have not arrived yet, and what its controller remembers (`ST-5`).
///
/// A fixed ring, nothing is allocated. A correction is a lean: an angle (radians) towards a side of the stem, along
/// local x and z of the bud. It stays on its flank of the stem whichever way the tip turns meanwhile. Corrections
/// that arrive together add up (`ST-13`).
#[derive(Component, Debug, Clone, Copy, PartialEq, Default, Reflect, Serialize, Deserialize)]
#[reflect(Component)]
#[serde(try_from = "Packed", into = "Packed")]
pub struct Signals {
    /// What arrives in 0, 1, 2 ... sub-steps.
    due: [Vec2; SLOTS],
    /// Sum of the errors sensed, radians, for integral control.
    pub(super) sum: Vec2,
    /// The error sensed last, radians, for derivative control.
    pub(super) last: Vec2,
    /// The heading in which the axis left the stem, or plant, that bears it, a unit vector in that one's frame; zero
    /// where no tropism asks.
    pub outset: Vec3,
}

/// A signals' file form: slots after the last signal are left out.
#[derive(Serialize, Deserialize)]
struct Packed {
    due: Vec<Vec2>,
    sum: Vec2,
    last: Vec2,
    outset: Vec3,
}

impl From<Signals> for Packed {
    fn from(signals: Signals) -> Self {
        let Signals { due, sum, last, outset } = signals;
        let used = due.iter().rposition(|lean| *lean != Vec2::ZERO).map_or(0, |last| last + 1);
        Self { due: due[..used].to_vec(), sum, last, outset }
    }
}

impl TryFrom<Packed> for Signals {
    type Error = String;

    fn try_from(packed: Packed) -> Result<Self, String> {
        let Packed { due: some, sum, last, outset } = packed;
        let mut due = [Vec2::ZERO; SLOTS];
        match due.get_mut(..some.len()) {
            Some(slots) => slots.copy_from_slice(&some),
            None => return Err(format!("{} signals; at most {SLOTS} can be on their way", some.len())),
        }
        Ok(Self { due, sum, last, outset })
    }
}

impl Signals {
    /// Whether there is nothing in it that growth depends on.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Whether every number in it is finite.
    pub fn is_finite(&self) -> bool {
        self.due.iter().chain([&self.sum, &self.last]).all(|lean| lean.is_finite()) && self.outset.is_finite()
    }

    /// Whether no correction is on its way.
    pub fn is_silent(&self) -> bool {
        self.due.iter().all(|lean| *lean == Vec2::ZERO)
    }

    /// Turns all it holds with the frame about the stem: `twist` leads from the old frame to the new one, about Y alone.
    pub(super) fn twist(&mut self, twist: Quat) {
        // Cosine and sine of its angle.
        let (cos, sin) = (twist.w * twist.w - twist.y * twist.y, 2.0 * twist.w * twist.y);
        let turned = |lean: Vec2| Vec2::new(lean.x * cos - lean.y * sin, lean.x * sin + lean.y * cos);
        self.due = self.due.map(turned);
        (self.sum, self.last) = (turned(self.sum), turned(self.last));
    }

    /// Sends a correction that arrives after `lifetime` sub-steps, at most [`LONGEST_LAG`].
    pub fn send(&mut self, correction: Vec2, lifetime: u32) {
        self.due[lifetime.min(LONGEST_LAG) as usize] += correction;
    }

    /// Takes what arrives now; all others are one sub-step nearer.
    pub fn receive(&mut self) -> Vec2 {
        let arrived = self.due[0];
        self.due.copy_within(1.., 0);
        self.due[SLOTS - 1] = Vec2::ZERO;
        arrived
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signals_arrive_when_their_lifetime_is_over_and_add_up() {
        let mut signals = Signals::default();
        signals.send(Vec2::X, 2);
        assert_eq!(signals.receive(), Vec2::ZERO);
        signals.send(Vec2::Y, 1);
        signals.send(Vec2::X, LONGEST_LAG);
        assert_eq!(signals.receive(), Vec2::ZERO);
        assert_eq!(signals.receive(), Vec2::ONE);
        for _ in 3..=LONGEST_LAG {
            assert_eq!(signals.receive(), Vec2::ZERO);
        }
        assert_eq!(signals.receive(), Vec2::X);
        assert!(signals.is_default() && signals.is_silent());
    }

    #[test]
    fn a_twist_of_the_frame_leaves_them_where_they_are_in_the_world() {
        let mut signals = Signals::default();
        signals.send(Vec2::new(0.3, -0.1), 0);
        let twist = Quat::from_rotation_y(0.8);
        signals.twist(twist);
        let lean = signals.receive();
        let here = twist * Vec3::new(lean.x, 0.0, lean.y);
        assert!(here.distance(Vec3::new(0.3, 0.0, -0.1)) < 1e-6, "{here}");
    }

    #[test]
    fn they_are_saved_short_and_read_back() {
        let mut signals = Signals { outset: Vec3::X, ..Default::default() };
        assert!(postcard::to_stdvec(&Signals::default()).unwrap().len() < 32);
        signals.send(Vec2::new(0.1, -0.2), 7);
        let bytes = postcard::to_stdvec(&signals).unwrap();
        assert_eq!(postcard::from_bytes::<Signals>(&bytes).unwrap(), signals);
        let long =
            Packed { due: vec![Vec2::ONE; SLOTS + 1], sum: Vec2::ZERO, last: Vec2::ZERO, outset: Vec3::ZERO };
        assert!(postcard::from_bytes::<Signals>(&postcard::to_stdvec(&long).unwrap()).is_err());
    }
}
