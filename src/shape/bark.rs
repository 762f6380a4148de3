//! Bark: what colour it has on a stem of some girth, the same for pictures, models and the window.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

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
    /// Short level streaks: birch.
    Banded,
    /// Level rings where leaves once stood: palm.
    Ringed,
}

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
        let t = ((radius / self.old_radius - 0.25) / 0.75).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }

    /// Its colour there, without its pattern.
    pub fn color(&self, radius: f32) -> Vec3 {
        self.young.lerp(self.old, self.age(radius))
    }
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
