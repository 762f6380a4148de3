//! Noise for bark and leaves: hashes and smooth noise that repeats, the same on every machine.

use bevy::math::ops;

/// A well mixed hash of a number.
pub(crate) fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

/// A hash as a number in 0..1.
pub(crate) fn unit(h: u32) -> f32 {
    (h >> 8) as f32 / 16_777_216.0
}

/// From 0 at `a` to 1 at `b`, smoothly.
pub(crate) fn smooth(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Smooth noise in 0..1 that repeats in x and y with period 1 and has this many cells in each.
pub(crate) fn periodic(x: f32, y: f32, cells: [u32; 2], seed: u32) -> f32 {
    let split = |v: f32, cells: u32| {
        let v = (v - v.floor()) * cells as f32;
        let cell = v.floor();
        let f = v - cell;
        (cell as u32 % cells, (cell as u32 + 1) % cells, f * f * (3.0 - 2.0 * f))
    };
    let (x0, x1, sx) = split(x, cells[0]);
    let (y0, y1, sy) = split(y, cells[1]);
    let at = |x: u32, y: u32| unit(hash(hash(hash(seed) ^ x) ^ y.wrapping_mul(0x9E37_79B9)));
    let row = |y: u32| at(x0, y) + (at(x1, y) - at(x0, y)) * sx;
    row(y0) + (row(y1) - row(y0)) * sy
}

/// Linear to sRGB.
pub(crate) fn srgb(linear: f32) -> f32 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * ops::powf(c, 1.0 / 2.4) - 0.055 }
}
