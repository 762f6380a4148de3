//! The auxin root: a surface that grows by the auxin in it, in two and three dimensions (`ST-4`).
//!
//! Nothing here says that the root bends. Auxin reaches the tip, more of it on the side of gravity; it flows back
//! along the surface and slows growth where it is; flanks of different lengths make wedges; wedges put together make
//! a bend, which ends when the tip is aligned. Two columns of surface are the root in a plane, three or more a solid
//! one.

use bevy::math::{Vec2, ops};
use bevy::prelude::*;

use super::out_of_range::{OutOfRange, check};
use crate::plant::Pose;

/// What a root is like. Lengths are in millimetres, times in hours; angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RootSettings {
    /// Columns of surface: 2 in a plane, 3 and more about a solid root.
    pub columns: usize,
    /// Length at the start.
    pub length: f32,
    /// Radius at the base at the start; the tip of a solid root is thinner.
    pub radius: f32,
    /// Radius at the tip over that at the base: 1 a cylinder, less a cone.
    pub taper: f32,
    /// Longest segment; longer ones are split in two.
    pub longest_segment: f32,
    /// Distance of the middle of the growth zone from the tip.
    pub zone: f32,
    /// Half width of the growth zone.
    pub zone_width: f32,
    /// Rate of elongation in the middle of the zone without auxin, an hour.
    pub growth: f32,
    /// Speed of auxin along the surface, away from the tip.
    pub transport: f32,
    /// How much auxin of concentration 1 slows growth: by 1 / (1 + this).
    pub inhibition: f32,
    /// How unevenly the tip splits its auxin when it lies level: 0 evenly, 1 all to one side.
    pub bias: f32,
    /// Share of its auxin the surface loses, an hour.
    pub decay: f32,
}

impl Default for RootSettings {
    fn default() -> Self {
        Self {
            columns: 2,
            length: 10.0,
            radius: 0.5,
            taper: 1.0,
            longest_segment: 0.5,
            zone: 2.0,
            zone_width: 0.9,
            growth: 0.35,
            transport: 8.0,
            inhibition: 3.0,
            bias: 0.8,
            decay: 0.2,
        }
    }
}

/// A slice of the root, base to tip.
#[derive(Debug, Clone, PartialEq)]
pub struct RootSegment {
    /// Radius, millimetres.
    pub radius: f32,
    /// Length of each column of its surface, millimetres.
    pub lengths: Vec<f32>,
    /// Concentration of auxin on each, 1 being what the tip supplies on average.
    pub auxin: Vec<f32>,
}

impl RootSegment {
    /// Mean length, millimetres.
    pub fn length(&self) -> f32 {
        self.lengths.iter().sum::<f32>() / self.lengths.len() as f32
    }
}

/// A growing root.
#[derive(Debug, Clone, PartialEq)]
pub struct AuxinRoot {
    settings: RootSettings,
    /// Turn of its fixed base; the root sets out along its +Y.
    base: Quat,
    /// Its slices, base to tip.
    pub segments: Vec<RootSegment>,
}

impl AuxinRoot {
    /// A young root with a fixed base that sets out along `base * Y`. Gravity is world -Y; a root in a plane bends in
    /// the plane of its base's x and y.
    ///
    /// # Errors
    /// The first setting out of range.
    pub fn new(settings: RootSettings, base: Quat) -> Result<Self, OutOfRange> {
        let RootSettings { columns, length, radius, taper, longest_segment, .. } = settings;
        check([
            ("the number of columns", columns as f32, 2.0, 64.0, "2 to 64"),
            ("the length", length, 0.1, 1000.0, "0.1 to 1000 mm"),
            ("the radius", radius, 0.01, 100.0, "0.01 to 100 mm"),
            ("the taper", taper, 0.05, 1.0, "0.05 to 1"),
            (
                "the longest segment",
                longest_segment,
                length / 1000.0,
                length,
                "a thousandth of the length to it",
            ),
            ("the zone", settings.zone, 0.0, 1000.0, "0 to 1000 mm"),
            ("the zone's width", settings.zone_width, 0.01, 1000.0, "0.01 to 1000 mm"),
            ("the rate of growth", settings.growth, 0.0, 10.0, "0 to 10 an hour"),
            ("the speed of transport", settings.transport, 0.0, 1000.0, "0 to 1000 mm an hour"),
            ("the inhibition", settings.inhibition, 0.0, 1000.0, "0 to 1000"),
            ("the bias", settings.bias, 0.0, 1.0, "0 to 1"),
            ("the decay", settings.decay, 0.0, 100.0, "0 to 100 an hour"),
        ])?;
        let slices = (length / longest_segment * 1.5).ceil().max(2.0) as usize;
        let segments = (0..slices)
            .map(|i| {
                let share = (i as f32 + 0.5) / slices as f32;
                RootSegment {
                    radius: radius * (1.0 - (1.0 - taper) * share),
                    lengths: vec![length / slices as f32; columns],
                    auxin: vec![0.0; columns],
                }
            })
            .collect();
        Ok(Self { settings, base: base.normalize(), segments })
    }

    /// Where a column lies about the root, as a unit vector along local x and z.
    fn side(&self, column: usize) -> Vec2 {
        let (sin, cos) = ops::sin_cos(core::f32::consts::TAU * column as f32 / self.settings.columns as f32);
        Vec2::new(cos, sin)
    }

    /// The lean of a slice: the turn that makes its columns of one length a wedge, by least squares.
    fn lean(&self, segment: &RootSegment) -> Vec2 {
        let mut sum = Vec2::ZERO;
        let mut squares = Vec2::splat(1e-12);
        for (column, length) in segment.lengths.iter().enumerate() {
            let side = self.side(column);
            sum += side * *length;
            squares += side * side;
        }
        // Towards the short side; in a plane nothing leans out of it.
        let lean = -sum / (segment.radius * squares);
        if self.settings.columns == 2 { Vec2::new(lean.x, 0.0) } else { lean }
    }

    /// The root put together from its base: the middle of each slice's lower face and its turn, then the tip.
    pub fn assemble(&self) -> Vec<Pose> {
        let mut pose = Pose { position: Vec3::ZERO, rotation: self.base };
        let mut poses = vec![pose];
        for segment in &self.segments {
            let lean = self.lean(segment);
            let angle = lean.length();
            let turn = |share: f32| {
                if angle < 1e-7 {
                    return Quat::IDENTITY;
                }
                let axis = Vec3::new(lean.y, 0.0, -lean.x) / angle;
                let (sin, cos) = ops::sin_cos(0.5 * share * angle);
                Quat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
            };
            let chord = pose.rotation * turn(0.5) * Vec3::Y;
            pose = Pose {
                position: pose.position + chord * segment.length(),
                rotation: (pose.rotation * turn(1.0)).normalize(),
            };
            poses.push(pose);
        }
        poses
    }

    /// Turns its pot: what has grown turns along, gravity does not.
    pub fn turn(&mut self, by: Quat) {
        self.base = (by * self.base).normalize();
    }

    /// The heading of its tip, a unit vector.
    pub fn tip_heading(&self) -> Vec3 {
        self.assemble().last().map_or(Vec3::Y, Pose::heading)
    }

    /// Angle between its tip and gravity, radians.
    pub fn tip_angle(&self) -> f32 {
        let heading = self.tip_heading();
        ops::atan2(heading.cross(Vec3::NEG_Y).length(), heading.dot(Vec3::NEG_Y))
    }

    /// Length along its middle, millimetres.
    pub fn length(&self) -> f32 {
        self.segments.iter().map(RootSegment::length).sum()
    }

    /// Grows for a time, hours: transport, growth, division, in steps so short that auxin passes no slice unseen.
    pub fn grow(&mut self, hours: f32) {
        let shortest = 0.4 * self.settings.longest_segment;
        let step = (0.8 * shortest / self.settings.transport.max(1e-3)).min(0.05);
        let steps = (hours / step).ceil().clamp(0.0, 1e6) as u32;
        for _ in 0..steps {
            self.step(hours / steps as f32);
        }
    }

    fn step(&mut self, dt: f32) {
        self.transport(dt);
        self.elongate(dt);
        self.divide();
    }

    /// The tip supplies auxin, more on the side of gravity; the surface passes it on, away from the tip.
    fn transport(&mut self, dt: f32) {
        let Some(tip) = self.assemble().last().copied() else { return };
        let down = tip.rotation.inverse() * Vec3::NEG_Y;
        let mut from: Vec<f32> = (0..self.settings.columns)
            .map(|column| 1.0 + self.settings.bias * self.side(column).dot(Vec2::new(down.x, down.z)))
            .collect();
        let kept = 1.0 - (self.settings.decay * dt).min(1.0);
        for segment in self.segments.iter_mut().rev() {
            for (column, supply) in from.iter_mut().enumerate() {
                let share = (self.settings.transport * dt / segment.lengths[column]).min(1.0);
                let held = segment.auxin[column];
                segment.auxin[column] = (held + (*supply - held) * share) * kept;
                *supply = held;
            }
        }
    }

    /// Every column grows by where it is in the zone and by the auxin on it.
    fn elongate(&mut self, dt: f32) {
        let RootSettings { zone, zone_width, growth, inhibition, .. } = self.settings;
        let mut distance = 0.0;
        for segment in self.segments.iter_mut().rev() {
            let length = segment.length();
            let off = (distance + 0.5 * length - zone) / zone_width;
            let rate = growth * ops::exp(-0.5 * off * off);
            for (side, auxin) in segment.lengths.iter_mut().zip(&segment.auxin) {
                *side *= 1.0 + rate * dt / (1.0 + inhibition * auxin.max(0.0));
            }
            distance += length;
        }
    }

    fn divide(&mut self) {
        let longest = self.settings.longest_segment;
        if self.segments.iter().all(|segment| segment.length() <= longest) {
            return;
        }
        self.segments = core::mem::take(&mut self.segments)
            .into_iter()
            .flat_map(|mut segment| {
                let parts = if segment.length() > longest { 2 } else { 1 };
                segment.lengths.iter_mut().for_each(|length| *length /= parts as f32);
                core::iter::repeat_n(segment, parts)
            })
            .collect();
    }
}
