//! Organs as the graphics card reads them: both states of each, four words of four.

use bevy::prelude::*;
use bytemuck::{Pod, Zeroable};
use half::f16;

/// One ring of a branch or one blade of a leaf in both states: sixteen words, laid out as `plants.wgsl` unpacks them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
#[repr(transparent)]
pub struct Record(pub [u32; 16]);

/// Bits of a record's flags. In a ring's, bits 8 to 15 hold the number of its axis.
pub mod flags {
    /// No surface leads from the ring before to this one.
    pub const BASE: u32 = 1;
    /// The organ is in the earlier state only: it falls.
    pub const DYING: u32 = 2;
}

/// A part of the step, 0..1: something happens from `start` to `end`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Begin.
    pub start: f32,
    /// End, not before `start`.
    pub end: f32,
}

impl Window {
    /// The whole step.
    pub const STEP: Self = Self { start: 0.0, end: 1.0 };

    fn bits(self) -> u32 {
        let start = unorm8(self.start).min(254);
        start | unorm8(self.end).max(start + 1) << 8
    }
}

/// What can be shown of an organ in false colours, each 0..1: light, space, energy, radius.
pub type Values = [f32; 4];

/// A cross-section of a branch in one state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingState {
    /// Its centre, metres.
    pub center: Vec3,
    /// Turn that takes +Y to the branch's direction and +X to where its texture begins.
    pub frame: Quat,
    /// Radius, metres.
    pub radius: f32,
    /// Distance from the base of its axis, metres.
    pub along: f32,
}

/// A ring in both states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// At the begin of the step.
    pub before: RingState,
    /// At its end.
    pub now: RingState,
    /// When it goes from one to the other.
    pub window: Window,
    /// Bits of [`flags`].
    pub flags: u32,
    /// A number of its axis' own, 0..1.
    pub chance: f32,
    /// Whose it is.
    pub owner: Owner,
}

/// A blade in both states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BladePair {
    /// Where it is attached at the begin of the step, metres.
    pub before: Vec3,
    /// Where it is attached at its end.
    pub now: Vec3,
    /// Length as a share of its largest, at the begin and the end.
    pub scale: [f32; 2],
    /// When it moves.
    pub window: Window,
    /// When it grows.
    pub unfolding: Window,
    /// From where it is attached to the begin of the blade, at full size, metres.
    pub petiole: Vec3,
    /// From base to tip at full size, metres.
    pub midrib: Vec3,
    /// From midrib to margin at full size, metres.
    pub across: Vec3,
    /// A number of its own, 0..1.
    pub chance: f32,
    /// Bits of [`flags`].
    pub flags: u32,
    /// Whose it is.
    pub owner: Owner,
}

/// The organ a record belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Owner {
    /// Birth number.
    pub birth: u32,
    /// Index of its plant.
    pub plant: u32,
    /// Order of its axis.
    pub order: u32,
    /// Age, 0..1 on the scale of [`Overlay::Age`](super::Overlay::Age).
    pub age: f32,
    /// Values at the begin and the end of the step.
    pub values: [Values; 2],
}

impl Record {
    /// A record that draws nothing and leads to nothing.
    pub const PAD: Self = Self([0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, flags::BASE << 16, u32::MAX, 0, 0, 0]);

    /// A ring.
    pub fn ring(ring: &Ring) -> Self {
        let Ring { before, now, window, flags, chance, owner } = ring;
        let flags = flags | unorm8(*chance) << 8;
        let shift = before.center - now.center;
        let [a0, a1] = turn(before.frame);
        // The shorter way between the two.
        let [b0, b1] = turn(if before.frame.dot(now.frame) < 0.0 { -now.frame } else { now.frame });
        Self([
            now.center.x.to_bits(),
            now.center.y.to_bits(),
            now.center.z.to_bits(),
            halves(before.radius, now.radius),
            halves(shift.x, shift.y),
            halves(shift.z, 0.0) & 0xFFFF | window.bits() << 16,
            a0,
            a1,
            b0,
            b1,
            now.along.to_bits(),
            halves(before.along - now.along, 0.0) & 0xFFFF | flags << 16,
            owner.birth,
            owner.bits(),
            values(owner.values[0]),
            values(owner.values[1]),
        ])
    }

    /// A blade.
    pub fn blade(blade: &BladePair) -> Self {
        let shift = blade.before - blade.now;
        let BladePair { petiole, midrib, across, owner, .. } = blade;
        Self([
            blade.now.x.to_bits(),
            blade.now.y.to_bits(),
            blade.now.z.to_bits(),
            halves(blade.scale[0], blade.scale[1]),
            halves(shift.x, shift.y),
            halves(shift.z, 0.0) & 0xFFFF | blade.window.bits() << 16,
            halves(petiole.x, petiole.y),
            halves(petiole.z, midrib.x),
            halves(midrib.y, midrib.z),
            halves(across.x, across.y),
            halves(across.z, blade.chance),
            blade.unfolding.bits() | blade.flags << 16,
            owner.birth,
            owner.bits(),
            values(owner.values[0]),
            values(owner.values[1]),
        ])
    }

    /// Birth number of the organ, `u32::MAX` for none.
    pub fn birth(&self) -> u32 {
        self.0[12]
    }
}

impl Owner {
    fn bits(&self) -> u32 {
        self.plant & 0xFFFF | self.order.min(255) << 16 | unorm8(self.age) << 24
    }
}

fn halves(a: f32, b: f32) -> u32 {
    u32::from(f16::from_f32(a).to_bits()) | u32::from(f16::from_f32(b).to_bits()) << 16
}

fn turn(q: Quat) -> [u32; 2] {
    let part = |x: f32| ((x.clamp(-1.0, 1.0) * 32767.0).round() as i16) as u16 as u32;
    [part(q.x) | part(q.y) << 16, part(q.z) | part(q.w) << 16]
}

fn unorm8(x: f32) -> u32 {
    (x.clamp(0.0, 1.0) * 255.0).round() as u32
}

fn values(values: Values) -> u32 {
    unorm8(values[0]) | unorm8(values[1]) << 8 | unorm8(values[2]) << 16 | unorm8(values[3]) << 24
}

/// What all organs of a plant share, as `plants.wgsl` reads it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct PlantEntry {
    /// Where it stands, metres; the colour of its bark's marks, five bits a channel.
    pub base: [f32; 4],
    /// Middle of its crown at the begin of the step, and how far leaves are from it, metres.
    pub crown_before: [f32; 4],
    /// The same at the end of the step.
    pub crown_now: [f32; 4],
    /// Colour of old bark, linear; the number of its pattern.
    pub bark: [f32; 4],
    /// Colour of the bark of twigs, linear; radius from which bark is old, metres.
    pub twig: [f32; 4],
    /// Colour of leaves, linear; length of the largest blade, metres.
    pub leaf: [f32; 4],
    /// Points of a blade's margin: place on the midrib and half width, both 0..1; two points a row.
    pub margin: [[f32; 4]; 4],
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(x: f32) -> RingState {
        RingState { center: Vec3::splat(x), frame: Quat::IDENTITY, radius: 0.1 * x, along: x }
    }

    #[test]
    fn a_record_is_sixteen_words_and_a_plant_ten_rows() {
        assert_eq!(size_of::<Record>(), 64);
        assert_eq!(size_of::<PlantEntry>(), 10 * 16);
    }

    #[test]
    fn the_later_state_is_kept_whole_and_the_earlier_to_a_millimetre() {
        let ring = Ring {
            before: state(1.5),
            now: state(2.0),
            window: Window { start: 0.0, end: 0.5 },
            flags: flags::DYING,
            chance: 1.0,
            owner: Owner { birth: 9, plant: 3, order: 2, age: 1.0, values: [[0.0; 4], [1.0; 4]] },
        };
        let words = Record::ring(&ring).0;
        assert_eq!(f32::from_bits(words[0]), 2.0);
        assert_eq!(f32::from_bits(words[10]), 2.0);
        let half = |word: u32, high: bool| f16::from_bits((word >> (16 * u32::from(high))) as u16).to_f32();
        assert!((half(words[4], false) + 0.5).abs() < 1e-3);
        assert!((half(words[3], false) - 0.15).abs() < 1e-4 && (half(words[3], true) - 0.2).abs() < 2e-4);
        assert_eq!((words[5] >> 16 & 0xFF, words[5] >> 24), (0, 128));
        assert_eq!(words[11] >> 16, flags::DYING | 0xFF00);
        assert_eq!((words[12], words[13] & 0xFFFF, words[13] >> 16 & 0xFF, words[13] >> 24), (9, 3, 2, 255));
        assert_eq!((words[14], words[15]), (0, u32::MAX));
    }

    #[test]
    fn a_window_is_never_empty() {
        for window in [Window { start: 0.5, end: 0.5 }, Window { start: 0.9999, end: 1.0 }] {
            let bits = window.bits();
            assert!(bits >> 8 > bits & 0xFF);
        }
    }

    #[test]
    fn frames_turn_the_shorter_way() {
        let mut ring = Ring {
            before: state(1.0),
            now: state(1.0),
            window: Window::STEP,
            flags: 0,
            chance: 0.0,
            owner: Owner::default(),
        };
        let one_way = Record::ring(&ring);
        ring.now.frame = -ring.now.frame;
        assert_eq!(Record::ring(&ring), one_way);
    }
}
