//! Leaf outlines: half the width of a blade at each point of its midrib.

use bevy::math::ops;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

/// The margin of a simple leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Reflect, Serialize, Deserialize)]
pub enum LeafOutline {
    /// An ellipse.
    #[default]
    Elliptic,
    /// Widest near the base, pointed: birch, poplar.
    Ovate,
    /// Widest beyond the middle with blunt lobes: oak.
    Lobed,
    /// Long and narrow: willow.
    Lanceolate,
    /// A needle.
    Needle,
}

impl LeafOutline {
    /// Every outline, in the order of the species table.
    pub const ALL: [LeafOutline; 5] =
        [Self::Elliptic, Self::Ovate, Self::Lobed, Self::Lanceolate, Self::Needle];

    /// Half the width at `s` along the midrib (0 base, 1 tip), as a share of the greatest half width (0..1).
    pub fn half_width(self, s: f32) -> f32 {
        let s = s.clamp(0.0, 1.0);
        let ellipse = 2.0 * (s * (1.0 - s)).sqrt();
        match self {
            Self::Elliptic => ellipse,
            Self::Ovate => (1.0 - s) * ops::powf(s, 0.45) * 2.05_f32.min(2.05),
            Self::Lobed => {
                let body = ops::powf(s, 0.8) * ops::powf(1.0 - s, 0.35) * 1.64;
                body * (0.8 + 0.2 * ops::cos(s * 28.0 - 0.6))
            }
            Self::Lanceolate => 2.0 * ops::powf(s, 0.6) * (1.0 - s) * 0.98,
            Self::Needle => {
                if s < 0.9 {
                    1.0
                } else {
                    (1.0 - s) * 10.0
                }
            }
        }
        .clamp(0.0, 1.0)
    }

    /// Share of the bounding rectangle (length x width) that the blade covers.
    pub fn fill(self) -> f32 {
        const N: u32 = 64;
        (0..N).map(|i| self.half_width((i as f32 + 0.5) / N as f32)).sum::<f32>() / N as f32
    }
}
