//! Bark: what colour it has on a stem of some girth, for pictures and models. The window has the same colours and
//! patterns, from one tile of noise (`plants.wgsl`).

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::noise::smooth;
use crate::species::Species;

/// What bark is like when it is old.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Reflect, Serialize, Deserialize)]
pub enum BarkPattern {
    /// Long ridges: oak, poplar, willow.
    #[default]
    Furrowed,
    /// Even: beech, hazel, maple.
    Smooth,
    /// Plates between dark cracks: pine.
    Plates,
    /// Short level streaks, furrows at the foot of a stout trunk: birch.
    Banded,
    /// Level rings where leaves once stood: palm.
    Ringed,
}

/// Radii between which banded bark turns from smooth to furrowed, metres.
const FOOT: [f32; 2] = [0.07, 0.13];

/// Colours of the bark of a species, linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bark {
    /// On twigs.
    pub young: Vec3,
    /// On stout stems.
    pub old: Vec3,
    /// Of its streaks, cracks and rings.
    pub mark: Vec3,
    /// Radius from which it is old, metres; 0: it always is.
    pub old_radius: f32,
    /// What it is like when it is old.
    pub pattern: BarkPattern,
}

impl Bark {
    /// The bark of a species.
    pub fn of(species: &Species) -> Self {
        Self {
            young: species.bark_young_color.linear().into(),
            old: species.bark_color.linear().into(),
            mark: species.bark_mark_color.linear().into(),
            old_radius: species.bark_old_radius_m,
            pattern: species.bark_pattern,
        }
    }

    /// One colour on stems of every girth.
    pub fn plain(color: Vec3) -> Self {
        Self { young: color, old: color, mark: color, old_radius: 0.0, pattern: BarkPattern::Furrowed }
    }

    /// How old it is on a stem of that radius (metres), 0..1.
    pub fn age(&self, radius: f32) -> f32 {
        if self.old_radius <= 0.0 {
            return 1.0;
        }
        smooth(0.25, 1.0, radius / self.old_radius)
    }

    /// Its colour there, without its pattern.
    pub fn color(&self, radius: f32) -> Vec3 {
        self.young.lerp(self.old, self.age(radius))
    }

    /// Its colour at a point of a stem of that radius (metres), linear RGB: furrows, plates, streaks or rings, as the
    /// grain there has it.
    pub fn at(&self, radius: f32, grain: &impl Grain) -> Vec3 {
        let crust = grain.crust() - 0.5;
        let warm = Vec3::new(1.0 + 0.10 * crust, 1.0, 1.0 - 0.12 * crust);
        // How much of the mark shows, and how light or dark the rest is.
        let (mark, shade) = match self.pattern {
            BarkPattern::Furrowed => (0.0, 0.62 + 0.5 * smooth(0.2, 0.6, grain.ridge()) + 0.25 * crust),
            BarkPattern::Smooth => (0.0, 0.92 + 0.3 * crust),
            BarkPattern::Plates => (0.8 * (1.0 - smooth(0.12, 0.34, grain.plate())), 0.9 + 0.4 * crust),
            BarkPattern::Banded => {
                // The foot of a stout trunk is furrowed, and dark between what is left of its white.
                let foot = smooth(FOOT[0], FOOT[1], radius);
                let furrow = foot * (1.0 - smooth(0.4, 0.66, grain.ridge()));
                let blotch = smooth(0.68, 0.74, grain.blotch());
                (smooth(0.68, 0.78, grain.streak()).max(blotch).max(furrow), 0.94 + 0.2 * crust)
            }
            BarkPattern::Ringed => {
                (0.55 * (1.0 - smooth(0.0, 0.22, (grain.ring() - 0.5).abs())), 0.9 + 0.4 * crust)
            }
        };
        self.color(radius).lerp(self.mark, mark * self.age(radius)) * warm * shade
    }
}

/// What noise says of a point of bark, each 0..1: pictures ask noise in space, textures noise that repeats.
pub trait Grain {
    /// Whether its crust is dark and cool or light and warm.
    fn crust(&self) -> f32;
    /// From a furrow to the ridge beside it, along the stem.
    fn ridge(&self) -> f32;
    /// From a crack to the plate beside it.
    fn plate(&self) -> f32;
    /// High in a level streak.
    fn streak(&self) -> f32;
    /// High in a dark patch.
    fn blotch(&self) -> f32;
    /// From a ring around the stem, at 0.5, to either side.
    fn ring(&self) -> f32;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bark_ages_with_girth() {
        let bark = Bark { young: Vec3::X, old_radius: 0.1, ..Bark::plain(Vec3::Y) };
        assert_eq!(bark.color(0.01), Vec3::X);
        assert_eq!(bark.color(0.1), Vec3::Y);
        assert!(bark.age(0.05) > 0.0 && bark.age(0.05) < bark.age(0.07));
        assert_eq!(Bark::plain(Vec3::Z).color(0.001), Vec3::Z);
    }
}
