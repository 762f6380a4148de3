//! Beach and sea in pictures: wet sand, foam, water that mirrors the sky.

use bevy::math::ops;
use bevy::prelude::*;

use super::noise::{rough, smooth, value};
use crate::environment::Shore;
use crate::shape::shore;

/// How far out at sea a place is, metres, along a waterline that is not straight.
fn out_at(sea: &Shore, point: Vec3) -> f32 {
    let level = Vec3::new(point.x, 0.0, point.z);
    sea.out_at(point) + 1.6 * (rough(level * 0.16, 2) - 0.5) + 0.5 * (value(level * 0.9) - 0.5)
}

/// The colour of beach or sea bed seen through water; `meadow` is that of the land behind.
pub(super) fn color(sea: &Shore, point: Vec3, footprint: f32, meadow: Vec3) -> Vec3 {
    let out = out_at(sea, point);
    let keep = |size: f32| smooth(0.8, 4.0, size / footprint.max(1e-6));
    let level = Vec3::new(point.x, 0.0, point.z);
    let grain = 0.18 * (value(level * 0.8) - 0.5)
        + 0.16 * keep(0.12) * (value(level * 8.0) - 0.5)
        + 0.14 * keep(0.015) * (value(level * 70.0) - 0.5);
    let ragged = out + 5.0 * (rough(level * 0.4, 3) - 0.5);
    let land = meadow.lerp(shore::sand(out) * (1.0 + grain), shore::sandy(ragged));
    let froth = shore::foam(out + 0.35 * (value(level * 2.3) - 0.5)) * smooth(0.25, 0.6, value(level * 5.0));
    land.lerp(shore::water(out), shore::depth(out)).lerp(shore::FOAM, froth)
}

/// Where light goes that the sea mirrors from direction `d` at a point, and its share; `None` on land.
pub(super) fn mirror(sea: &Shore, point: Vec3, d: Vec3, footprint: f32) -> Option<(Vec3, f32)> {
    let out = out_at(sea, point);
    if out <= 0.0 {
        return None;
    }
    let slope = |along: Vec3| {
        let wave = |size: f32, height: f32| {
            let fine = smooth(0.3, 2.0, size / footprint.max(1e-6));
            let at = Vec3::new(point.x, 0.0, point.z) / size;
            height * fine * (value(at + along * 0.25) - value(at - along * 0.25))
        };
        wave(1.1, 0.10) + wave(0.28, 0.07)
    };
    // Beyond what is seen singly, waves still turn the mirror a little upwards.
    let normal = Vec3::new(-slope(Vec3::X), 1.0, -slope(Vec3::Z)).normalize();
    let facing = normal.dot(-d).clamp(0.04, 1.0);
    let mut back = d + normal * 2.0 * facing;
    back.y = back.y.abs().max(0.02);
    let share = 0.02 + 0.98 * ops::powf(1.0 - facing, 5.0);
    Some((back.normalize(), 0.85 * share * smooth(0.0, 0.4, out)))
}
