//! Barlow's root: flanks that elongate at different rates bend it (`ST-1` to `ST-3`).

use bevy::math::{Vec2, ops};

/// Relative elemental rate of elongation along a flank: M exp(-(x - mu)^2 / (2 sigma^2)) at x from the tip (`ST-1`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relel {
    /// Greatest rate (M), per unit of time.
    pub most: f32,
    /// Distance from the tip at which it is reached (mu), in the root's unit of length.
    pub centre: f32,
    /// Distance from there at which it has fallen to 0.607 of it (sigma).
    pub spread: f32,
}

impl Relel {
    /// The rate at a distance from the tip.
    pub fn at(&self, distance: f32) -> f32 {
        let off = (distance - self.centre) / self.spread.max(1e-6);
        self.most * ops::exp(-0.5 * off * off)
    }
}

/// A root whose flanks have grown for a while.
#[derive(Debug, Clone, PartialEq)]
pub struct BentRoot {
    /// Angle of the tip to the straight root, radians; above 0 the upper flank is the longer.
    pub tip_angle: f32,
    /// Points of the upper flank, base to tip.
    pub upper: Vec<Vec2>,
    /// Points of the lower flank, base to tip.
    pub lower: Vec<Vec2>,
    /// Curvature of each element, base to tip, radians an element.
    pub bends: Vec<f32>,
}

/// Grows both flanks of a straight root for a time and puts it together from its base, which lies along +x (`ST-1`).
///
/// The root has the given length and diameter and is cut into so many elements (at least one); its upper flank is
/// above. An element's angle is the difference of its flanks over the diameter.
pub fn bend(upper: Relel, lower: Relel, time: f32, length: f32, diameter: f32, elements: usize) -> BentRoot {
    let elements = elements.max(1);
    let width = length / elements as f32;
    let half = 0.5 * diameter.max(1e-6);
    let mut root = BentRoot {
        tip_angle: 0.0,
        upper: vec![Vec2::new(0.0, half)],
        lower: vec![Vec2::new(0.0, -half)],
        bends: Vec::with_capacity(elements),
    };
    let (mut centre, mut angle) = (Vec2::ZERO, 0.0_f32);
    for element in 0..elements {
        let distance = length - (element as f32 + 0.5) * width;
        let [long, short] = [upper, lower].map(|flank| width * (1.0 + flank.at(distance) * time));
        let turn = (long - short) / (2.0 * half);
        let (sin, cos) = ops::sin_cos(angle - 0.5 * turn);
        centre += Vec2::new(cos, sin) * 0.5 * (long + short);
        angle -= turn;
        let (sin, cos) = ops::sin_cos(angle);
        let across = Vec2::new(-sin, cos) * half;
        root.upper.push(centre + across);
        root.lower.push(centre - across);
        root.bends.push(turn);
    }
    root.tip_angle = -angle;
    root
}
