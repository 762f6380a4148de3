//! Repeatable randomness for pictures: hashes and smooth value noise, the same on every machine and thread.

use bevy::prelude::*;

pub(super) use crate::shape::noise::{hash, smooth, unit};

/// Mixes a second number into a hash.
pub(super) fn mix(h: u32, x: u32) -> u32 {
    hash(h ^ x.wrapping_mul(0x9E37_79B9).rotate_left(7))
}

/// The fractional part, in 0..1 also for negative numbers.
pub(super) fn fract(x: f32) -> f32 {
    x - x.floor()
}

/// Smooth noise in 0..1 with a feature size of about one unit.
pub(super) fn value(p: Vec3) -> f32 {
    let cell = p.floor();
    let f = p - cell;
    let s = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let corner = |dx: i32, dy: i32, dz: i32| {
        let h = hash((cell.x as i32).wrapping_add(dx) as u32);
        let h = mix(h, (cell.y as i32).wrapping_add(dy) as u32);
        unit(mix(h, (cell.z as i32).wrapping_add(dz) as u32))
    };
    let edge = |dy, dz| corner(0, dy, dz) + (corner(1, dy, dz) - corner(0, dy, dz)) * s.x;
    let face = |dz| edge(0, dz) + (edge(1, dz) - edge(0, dz)) * s.y;
    face(0) + (face(1) - face(0)) * s.z
}

/// Noise of several octaves in 0..1, each twice as fine and half as strong as the last.
pub(super) fn rough(p: Vec3, octaves: u32) -> f32 {
    let (mut sum, mut weight, mut scale) = (0.0, 0.0, 1.0);
    for octave in 0..octaves {
        let strength = 1.0 / scale;
        sum += strength * value(p * scale + Vec3::splat(octave as f32 * 17.3));
        weight += strength;
        scale *= 2.0;
    }
    sum / weight
}
