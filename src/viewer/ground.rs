//! Things stand on the ground: neither above it nor sunk in it by a little.

use bevy::prelude::*;

use crate::environment::SolidShape;

/// How far above the ground a thing is let go of and still set down on it, metres.
pub const NEAR: f32 = 0.25;

/// How far the lowest point of a shape, turned, lies below its centre, metres.
pub fn depth(shape: SolidShape, rotation: Quat) -> f32 {
    let turn = Mat3::from_quat(rotation);
    match shape {
        SolidShape::Box { size } => {
            let half = 0.5 * size;
            turn.x_axis.y.abs() * half.x + turn.y_axis.y.abs() * half.y + turn.z_axis.y.abs() * half.z
        }
        SolidShape::Ball { radius } => radius,
        SolidShape::Cylinder { radius, height } => {
            let up = turn.y_axis.y.clamp(-1.0, 1.0);
            0.5 * height * up.abs() + radius * (1.0 - up * up).sqrt()
        }
    }
}

/// The height, metres, of the centre of a thing let go of at a place, over ground at a height: standing on the ground
/// if its lowest point is at most [`NEAR`] above it or anywhere below it, else as it was. The place's scale counts.
pub fn settled(shape: SolidShape, place: &Transform, ground: f32) -> f32 {
    let standing = ground + depth(shape.scaled(place.scale), place.rotation);
    if place.translation.y - standing <= NEAR { standing } else { place.translation.y }
}

#[cfg(test)]
mod tests {
    use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, SQRT_2};

    use super::*;

    const BOX: SolidShape = SolidShape::Box { size: Vec3::new(3.0, 2.0, 0.3) };
    const BALL: SolidShape = SolidShape::Ball { radius: 0.6 };
    const PILLAR: SolidShape = SolidShape::Cylinder { radius: 0.3, height: 2.4 };

    /// Every shape, upright and turned, with the height of its centre when it stands.
    fn standing() -> [(SolidShape, Quat, f32); 9] {
        let about_z = Quat::from_rotation_z;
        [
            (BOX, Quat::IDENTITY, 1.0),
            (BOX, Quat::from_rotation_y(0.7), 1.0),
            (BOX, about_z(FRAC_PI_2), 1.5),
            (BOX, about_z(FRAC_PI_4), 2.5 / SQRT_2),
            (BOX, Quat::from_rotation_x(FRAC_PI_2), 0.15),
            (BALL, about_z(0.3), 0.6),
            (PILLAR, Quat::from_rotation_y(1.0), 1.2),
            (PILLAR, Quat::from_rotation_x(FRAC_PI_2), 0.3),
            (PILLAR, about_z(FRAC_PI_4), 1.5 / SQRT_2),
        ]
    }

    #[test]
    fn what_is_near_the_ground_or_in_it_stands_on_it_whatever_its_shape_and_turn() {
        for (shape, rotation, high) in standing() {
            let at = |y: f32| Transform::from_xyz(4.0, y, 1.0).with_rotation(rotation);
            for off in [0.0, 0.11, 0.249, -0.01, -0.57, -30.0] {
                let y = settled(shape, &at(2.0 + high + off), 2.0);
                assert!((y - 2.0 - high).abs() < 1e-5, "{shape:?} {rotation:?} off by {off}: {y}");
            }
            for off in [0.26, 1.0] {
                assert_eq!(settled(shape, &at(high + off), 0.0), high + off, "{shape:?} hangs in the air");
            }
        }
    }

    #[test]
    fn no_corner_is_below_ground() {
        // The corners themselves say how low a turned box reaches.
        for k in 0..40 {
            let rotation = Quat::from_euler(EulerRot::YXZ, 0.7 * k as f32, 0.31 * k as f32, 0.17 * k as f32);
            let half = Vec3::new(1.5, 1.0, 0.15);
            let corners = (0..8).map(|i| {
                let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
                (rotation * (half * Vec3::new(sign(0), sign(1), sign(2)))).y
            });
            let lowest = corners.fold(f32::INFINITY, f32::min);
            assert!((depth(BOX, rotation) + lowest).abs() < 1e-4, "{k}");
            // So do the rims of a pillar.
            let rim = (0..720).map(|i| {
                let (sin, cos) = bevy::math::ops::sin_cos(i as f32 * core::f32::consts::TAU / 360.0);
                let end = if i < 360 { 1.2 } else { -1.2 };
                (rotation * Vec3::new(0.3 * cos, end, 0.3 * sin)).y
            });
            assert!((depth(PILLAR, rotation) + rim.fold(f32::INFINITY, f32::min)).abs() < 1e-3, "{k}");
        }
    }

    #[test]
    fn scale_counts() {
        let place = Transform::from_xyz(0.0, 3.1, 0.0).with_scale(Vec3::new(1.0, 3.0, 1.0));
        assert!((settled(BOX, &place, 0.0) - 3.0).abs() < 1e-6);
    }
}
