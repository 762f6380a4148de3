//! Straight segments in space: how near two of them come to each other.

use bevy::math::Vec3;

/// Where two segments, each from one end to the other, come nearest: the place on the first and that on the second.
pub fn nearest((a, a_end): (Vec3, Vec3), (b, b_end): (Vec3, Vec3)) -> (Vec3, Vec3) {
    let (along_a, along_b, between) = (a_end - a, b_end - b, a - b);
    let (aa, bb, ab) = (along_a.length_squared(), along_b.length_squared(), along_a.dot(along_b));
    let (a_between, b_between) = (along_a.dot(between), along_b.dot(between));
    let share = |over: f32, under: f32| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    let at_a = share(ab * b_between - bb * a_between, aa * bb - ab * ab);
    let at_b = share(ab * at_a + b_between, bb);
    let at_a = share(ab * at_b - a_between, aa);
    (a + along_a * at_a, b + along_b * at_b)
}

/// Least distance between two segments, metres.
pub fn gap(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> f32 {
    let (on_a, on_b) = nearest(a, b);
    on_a.distance(on_b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_between_segments() {
        let x = (Vec3::ZERO, Vec3::X);
        assert_eq!(gap(x, (Vec3::Y, Vec3::Y + Vec3::X)), 1.0);
        assert_eq!(gap(x, (Vec3::new(0.5, 2.0, -1.0), Vec3::new(0.5, 2.0, 1.0))), 2.0);
        assert_eq!(gap(x, (Vec3::new(3.0, 0.0, 0.0), Vec3::new(4.0, 0.0, 0.0))), 2.0);
        assert_eq!(gap(x, (Vec3::new(0.5, -1.0, 0.0), Vec3::new(0.5, 1.0, 0.0))), 0.0);
    }
}
