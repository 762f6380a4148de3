//! The look of a beach and the sea before it, by how far out at sea a place is: metres, below 0 on land. Linear RGB,
//! for pictures and the window alike.

use bevy::prelude::*;

use super::noise::smooth;

/// Dry sand.
pub(crate) const SAND: Vec3 = Vec3::new(0.62, 0.49, 0.31);
const WET_SAND: Vec3 = Vec3::new(0.27, 0.20, 0.12);
const SHALLOW: Vec3 = Vec3::new(0.10, 0.27, 0.26);
const DEEP: Vec3 = Vec3::new(0.010, 0.060, 0.095);
/// Foam.
pub(crate) const FOAM: Vec3 = Vec3::new(0.80, 0.84, 0.85);

/// Sand: the sea wets it as far as waves come.
pub(crate) fn sand(out: f32) -> Vec3 {
    SAND.lerp(WET_SAND, smooth(-1.6, -0.4, out))
}

/// How much of the land is sand rather than meadow, 0..1.
pub(crate) fn sandy(out: f32) -> f32 {
    smooth(-42.0, -30.0, out)
}

/// Water, the darker the deeper.
pub(crate) fn water(out: f32) -> Vec3 {
    SHALLOW.lerp(DEEP, smooth(0.0, 14.0, out))
}

/// How much of the sand below is hidden by water, 0..1.
pub(crate) fn depth(out: f32) -> f32 {
    0.45 * smooth(0.0, 0.3, out) + 0.55 * smooth(0.3, 6.0, out)
}

/// How much foam lies there, 0..1: along the shore, and where the next wave breaks.
pub(crate) fn foam(out: f32) -> f32 {
    let line = |at: f32, wide: f32| (1.0 - ((out - at) / wide).abs()).max(0.0);
    (line(0.10, 0.22) + 0.7 * line(1.9, 0.3)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_the_meadow_over_dry_and_wet_sand_into_the_deep() {
        assert_eq!((sandy(-50.0), sandy(-20.0)), (0.0, 1.0));
        assert_eq!(sand(-5.0), SAND);
        assert!(sand(-0.5).element_sum() < 0.6 * SAND.element_sum(), "wet sand is dark");
        assert_eq!((depth(-0.1), depth(10.0)), (0.0, 1.0));
        assert!((0..40).all(|k| water(k as f32).element_sum() >= water(k as f32 + 1.0).element_sum()));
        assert!(foam(0.1) > 0.9 && foam(-1.0) == 0.0 && foam(30.0) == 0.0);
    }
}
