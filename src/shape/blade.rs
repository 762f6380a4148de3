//! Leaf blades: how one leaf's colour differs from the next and its midrib, for pictures and models; side veins, for
//! models. `plants.wgsl` has its own like them.

use bevy::prelude::*;

use super::noise::smooth;

/// How much lighter the midrib is than the blade, as a share of its colour.
pub const RIB: f32 = 0.35;
/// How much lighter side veins are.
const VEIN: f32 = 0.12;
/// Side veins from base to tip.
const VEINS: f32 = 7.0;

/// How much of the midrib is at a place across the blade (-1..1 from margin to margin where it is widest), 0..1.
pub fn rib(side: f32) -> f32 {
    1.0 - smooth(0.03, 0.10, side.abs())
}

/// How light a blade is across (-1..1) and along it (0 base, 1 tip), about 1: veins leave the midrib at an angle.
pub fn light(side: f32, along: f32) -> f32 {
    let place = (along - 0.45 * side.abs()) * VEINS;
    let place = place - place.floor();
    let vein = 1.0 - smooth(0.06, 0.16, place.min(1.0 - place));
    1.0 + RIB * rib(side) + VEIN * vein - 0.06
}

/// Colour of one leaf over that of its species, from two numbers in -0.5..0.5; 1 on average.
pub fn variation(a: f32, b: f32) -> Vec3 {
    (1.0 + 0.34 * a) * Vec3::new(1.0 + 0.30 * b, 1.0, 1.0 - 0.25 * b)
}

/// The most [`variation`] comes to.
pub const BRIGHTEST: Vec3 = Vec3::new(1.17 * 1.15, 1.17, 1.17 * 1.125);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_vary_about_their_species() {
        let all =
            || (0..=20).flat_map(|a| (0..=20).map(move |b| (a as f32 / 20.0 - 0.5, b as f32 / 20.0 - 0.5)));
        let mean = all().map(|(a, b)| variation(a, b)).sum::<Vec3>() / 441.0;
        assert!((mean - Vec3::ONE).abs().max_element() < 1e-5, "{mean}");
        let most = all().map(|(a, b)| variation(a, b)).reduce(Vec3::max).unwrap();
        assert!((most - BRIGHTEST).abs().max_element() < 1e-5, "{most}");
    }

    #[test]
    fn a_blade_is_lightest_on_its_midrib() {
        assert!(light(0.0, 0.5) > light(0.3, 0.5) && rib(0.0) == 1.0 && rib(-0.5) == 0.0);
        assert_eq!(light(0.4, 0.3), light(-0.4, 0.3));
    }
}
