//! Leaf outlines: half the width of a blade at each point of its midrib.

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
    /// Pointed at both ends, widest before the middle: Lombardy poplar.
    Rhombic,
    /// Round with a short point: hazel.
    Heart,
    /// Deep pointed lobes: Japanese maple.
    Palmate,
}

/// Margin of the palmate outline, straight between these points (place along the midrib, half width).
const PALMATE: [(f32, f32); 8] =
    [(0.0, 0.0), (0.1, 0.62), (0.22, 0.28), (0.45, 1.0), (0.55, 0.3), (0.72, 0.45), (0.8, 0.18), (1.0, 0.0)];
/// Where the rhombic and the heart-shaped outline are widest.
const RHOMBIC_WIDEST: f32 = 0.35;
const HEART_WIDEST: f32 = 0.35;

/// Lobes from base to tip of a lobed blade; the half is the terminal one, which straddles the tip.
const LOBES: f32 = 4.5;
/// How far the sinuses between lobes cut in, as a share of the half width there.
const SINUS: f32 = 0.45;

impl LeafOutline {
    /// Every outline, in the order of the species table.
    pub const ALL: [LeafOutline; 8] = [
        Self::Elliptic,
        Self::Ovate,
        Self::Lobed,
        Self::Lanceolate,
        Self::Needle,
        Self::Rhombic,
        Self::Heart,
        Self::Palmate,
    ];

    /// Half the width at `s` along the midrib (0 base, 1 tip), as a share of the greatest half width (0..1).
    ///
    /// Continuous, 0 at both ends; square roots and products only, since every ray that meets a leaf asks.
    pub fn half_width(self, s: f32) -> f32 {
        let s = s.clamp(0.0, 1.0);
        let rest = 1.0 - s;
        let width = match self {
            Self::Elliptic => 2.0 * (s * rest).sqrt(),
            Self::Ovate => 2.598_076 * s.sqrt() * rest,
            Self::Lobed => {
                let along = LOBES * s;
                let within = along - along.floor();
                let lobe = 1.0 - SINUS * (1.0 - 4.0 * within * (1.0 - within));
                2.692_2 * s * rest.sqrt() * lobe
            }
            Self::Lanceolate => 5.379_144 * s * rest * rest.sqrt(),
            Self::Needle => (20.0 * s).min(8.0 * rest).min(1.0),
            Self::Rhombic => (s / RHOMBIC_WIDEST).min(rest / (1.0 - RHOMBIC_WIDEST)),
            Self::Heart if s < HEART_WIDEST => {
                let from_widest = 1.0 - s / HEART_WIDEST;
                (1.0 - from_widest * from_widest).max(0.0).sqrt()
            }
            Self::Heart => {
                let beyond = (s - HEART_WIDEST) / (1.0 - HEART_WIDEST);
                (1.0 - beyond) * (1.0 + 0.9 * beyond)
            }
            Self::Palmate => {
                let between = PALMATE.windows(2).find(|ends| s <= ends[1].0);
                between.map_or(0.0, |ends| {
                    let [(s0, w0), (s1, w1)] = [ends[0], ends[1]];
                    w0 + (w1 - w0) * (s - s0) / (s1 - s0)
                })
            }
        };
        width.min(1.0)
    }

    /// Share of the bounding rectangle (length x width) that the blade covers: the mean of
    /// [`half_width`](Self::half_width).
    pub fn fill(self) -> f32 {
        match self {
            Self::Elliptic => core::f32::consts::FRAC_PI_4,
            Self::Ovate => 0.692_82,
            Self::Lobed => 0.609_1,
            Self::Lanceolate => 0.614_76,
            Self::Needle => 0.9125,
            Self::Rhombic => 0.5,
            // A quarter of an ellipse, and a parabola.
            Self::Heart => 0.697_39,
            Self::Palmate => 0.404_15,
        }
    }

    /// Points of the midrib, 0 base to 1 tip, at which a mesh follows the margin: few, and where it turns.
    ///
    /// The first is the base; the last is the tip, or short of it where the blade ends blunt.
    pub fn stations(self) -> &'static [f32] {
        match self {
            Self::Elliptic => &[0.0, 0.1, 0.35, 0.65, 0.9, 1.0],
            Self::Ovate => &[0.0, 0.05, 0.18, 0.38, 0.65, 1.0],
            // Lobe tops and the sinuses between them.
            Self::Lobed => &[0.0, 0.35, 0.444_444, 0.57, 0.666_667, 0.79, 0.97],
            Self::Lanceolate => &[0.0, 0.15, 0.35, 0.55, 0.8, 1.0],
            Self::Needle => &[0.0, 0.05, 0.875, 1.0],
            Self::Rhombic => &[0.0, 0.15, 0.35, 0.65, 1.0],
            Self::Heart => &[0.0, 0.04, 0.14, 0.35, 0.6, 0.85, 1.0],
            Self::Palmate => &[0.0, 0.1, 0.22, 0.45, 0.55, 0.72, 0.8, 1.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: u32 = 20_000;

    fn widths(outline: LeafOutline) -> impl Iterator<Item = f32> {
        (0..=N).map(move |i| outline.half_width(i as f32 / N as f32))
    }

    #[test]
    fn outlines_close_at_both_ends_and_reach_full_width() {
        for outline in LeafOutline::ALL {
            assert_eq!((outline.half_width(0.0), outline.half_width(1.0)), (0.0, 0.0), "{outline:?}");
            let widest = widths(outline).fold(0.0, f32::max);
            assert!((0.999..=1.0).contains(&widest), "{outline:?} {widest}");
        }
    }

    #[test]
    fn outlines_are_continuous() {
        for outline in LeafOutline::ALL {
            let all: Vec<f32> = widths(outline).collect();
            let jump = all.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f32::max);
            // Round ends rise as a square root, under 3 sqrt(1 / N) at once.
            assert!(jump < 3.0 * (1.0 / N as f32).sqrt(), "{outline:?} {jump}");
        }
    }

    #[test]
    fn fill_is_the_mean_half_width() {
        for outline in LeafOutline::ALL {
            let mean = widths(outline).map(f64::from).sum::<f64>() / f64::from(N);
            assert!((mean - f64::from(outline.fill())).abs() < 5e-4, "{outline:?} {mean}");
        }
    }

    #[test]
    fn an_oak_leaf_has_four_lobes_a_side_and_a_terminal_one() {
        let all: Vec<f32> = widths(LeafOutline::Lobed).collect();
        let sinuses = all.windows(3).filter(|w| w[1] < w[0] && w[1] < w[2]).count();
        assert_eq!(sinuses, 4);
    }
}
