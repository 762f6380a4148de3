//! The heading a shoot steers to: what light and space chose, blended with the tropisms of its species.

use bevy::prelude::*;

use crate::species::Species;

/// Weights of what draws a shoot, of one branch order (`ST-11`, `ST-12`).
///
/// The set point is their weighted mean direction. With phototropism alone it is the heading that light and space
/// chose, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tropisms {
    /// Towards the heading that light and space chose.
    pub photo: f32,
    /// Away from gravity; below 0, towards it.
    pub gravi: f32,
    /// Upright, from nothing at the base of the axis to this at `reach`: outward first, then upward.
    pub ortho: f32,
    /// Level, on the side to which the axis set out.
    pub plagio: f32,
    /// Towards the heading in which the axis left its parent stem: a target relative to the parent, not to gravity.
    pub auto: f32,
    /// Length of axis over which `ortho` rises, metres.
    pub reach: f32,
}

impl Tropisms {
    /// Those of a species for axes of an order.
    pub fn of(species: &Species, order: u32) -> Self {
        Self {
            photo: species.phototropism.at(order).unwrap_or(1.0),
            gravi: species.gravitropism.get(order),
            ortho: species.orthotropism.get(order),
            plagio: species.plagiotropism.get(order),
            auto: species.autotropism.get(order),
            reach: species.orthotropism_m,
        }
    }

    /// Whether the set point is what light and space chose, and nothing else.
    pub fn only_light(&self) -> bool {
        self.photo > 0.0 && self.gravi == 0.0 && self.ortho == 0.0 && self.plagio == 0.0 && self.auto == 0.0
    }

    /// The set point, a unit vector, of an axis that left its parent along `outset` and is `along` metres long.
    ///
    /// `chosen`, `heading`, `outset` and `up` are unit vectors in the same frame; where nothing draws, or all draws
    /// cancel, it is `heading`, that of the tip.
    pub fn set_point(&self, chosen: Vec3, heading: Vec3, outset: Vec3, up: Vec3, along: f32) -> Vec3 {
        if self.only_light() {
            return chosen;
        }
        let rise = (along / self.reach.max(1e-6)).clamp(0.0, 1.0);
        let level = (outset - up * outset.dot(up)).normalize_or_zero();
        let drawn = chosen * self.photo
            + up * (self.gravi + self.ortho * rise * rise * (3.0 - 2.0 * rise))
            + level * self.plagio
            + outset * self.auto;
        drawn.try_normalize().unwrap_or(heading)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIGHT: Tropisms =
        Tropisms { photo: 1.0, gravi: 0.0, ortho: 0.0, plagio: 0.0, auto: 0.0, reach: 1.0 };

    #[test]
    fn light_alone_changes_no_bit() {
        let chosen = Vec3::new(0.1, 0.7, 0.3);
        assert_eq!(LIGHT.set_point(chosen, Vec3::Z, Vec3::X, Vec3::Y, 3.0), chosen);
        let torn = Tropisms { photo: 1.0, gravi: -1.0, ..LIGHT };
        assert_eq!(torn.set_point(Vec3::Y, Vec3::Z, Vec3::X, Vec3::Y, 3.0), Vec3::Z);
    }

    #[test]
    fn turning_all_directions_turns_the_set_point() {
        let all = Tropisms { photo: 0.5, gravi: -0.3, ortho: 2.0, plagio: 0.7, auto: 0.9, reach: 2.0 };
        let (chosen, outset) = (Vec3::new(0.6, 0.64, 0.48), Vec3::new(0.8, 0.36, -0.48));
        for turn in [Quat::from_rotation_z(2.0), Quat::from_euler(EulerRot::XYZ, 0.4, -2.9, 1.3)] {
            let here = turn * all.set_point(chosen, Vec3::Z, outset, Vec3::Y, 1.3);
            let there = all.set_point(turn * chosen, turn * Vec3::Z, turn * outset, turn * Vec3::Y, 1.3);
            assert!(here.distance(there) < 1e-6, "{here} {there}");
        }
    }

    #[test]
    fn st_12_outward_at_the_base_upward_at_the_end() {
        let bends = Tropisms { photo: 0.0, ortho: 4.0, auto: 1.0, ..LIGHT };
        let rises: Vec<f32> =
            (0..=10).map(|i| bends.set_point(Vec3::Z, Vec3::Z, Vec3::X, Vec3::Y, i as f32 * 0.1).y).collect();
        assert_eq!(rises[0], 0.0);
        assert!(rises.windows(2).all(|w| w[1] > w[0]) && rises[10] > 0.95, "{rises:?}");
    }

    #[test]
    fn each_draws_its_own_way() {
        let out = Vec3::new(0.6, 0.8, 0.0);
        let none = Tropisms { photo: 0.0, ..LIGHT };
        assert_eq!(Tropisms { gravi: -2.0, ..none }.set_point(out, out, out, Vec3::Y, 0.0), -Vec3::Y);
        assert_eq!(Tropisms { plagio: 2.0, ..none }.set_point(out, out, out, Vec3::Y, 0.0), Vec3::X);
        let auto = Tropisms { auto: 2.0, ..none }.set_point(Vec3::Y, Vec3::Z, out, Vec3::Y, 0.0);
        assert!((auto - out).length() < 1e-6);
        assert_eq!(
            none.set_point(Vec3::Y, Vec3::Z, out, Vec3::Y, 0.0),
            Vec3::Z,
            "drawn nowhere it goes straight on"
        );
    }
}
