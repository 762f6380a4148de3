//! Textures made from the parameters of a species: bark that repeats without a seam, and one leaf with its outline.
//!
//! Rows run along the stem and from the base of a leaf (v 0) to its tip. Colours are linear RGB.

use bevy::math::ops;
use bevy::prelude::*;

use super::bark::{Bark, BarkPattern, Grain};
use super::blade;
use super::noise::{hash, periodic, smooth, unit};
use crate::species::Species;

/// Side of a tile of bark, texels.
pub const BARK_TEXELS: usize = 256;
/// Length of a leaf, texels.
const LEAF_TEXELS: usize = 256;
/// Half the width of stalk that is always there along the midrib, texels: petioles are drawn with it.
const STALK_TEXELS: f32 = 2.0;
/// Leaves of a spray as long as they are wide, and the length of each as a share of the card's.
const SPRAY_LEAVES: f32 = 26.0;
const SPRAY_LENGTH: f32 = 0.28;
/// How steep bark is in its normal texture: depth of the deepest furrow as a share of a tile.
const DEPTH: f32 = 0.03;
/// Rings of palms in a tile.
const RINGS: f32 = 4.0;

/// A picture of texels, four parts each: colour and alpha, or a normal.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Texels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Texels, row by row, each part 0..1.
    pub texels: Vec<[f32; 4]>,
}

impl Texture {
    fn new(width: usize, height: usize, texel: impl Fn(f32, f32) -> [f32; 4]) -> Self {
        let at = |k: usize, size: usize| (k as f32 + 0.5) / size as f32;
        let texels = (0..width * height).map(|k| texel(at(k % width, width), at(k / width, height)));
        Self { width, height, texels: texels.collect() }
    }

    /// Share of its texels that show, 0..1.
    pub fn covered(&self) -> f32 {
        let shown = self.texels.iter().filter(|texel| texel[3] >= 0.5).count();
        shown as f32 / self.texels.len().max(1) as f32
    }

    /// Mean colour of the texels that show, linear RGB.
    pub fn mean(&self) -> Vec3 {
        let shown = self.texels.iter().filter(|texel| texel[3] >= 0.5);
        let (sum, count) =
            shown.fold((Vec3::ZERO, 0.0), |(sum, n), t| (sum + Vec3::new(t[0], t[1], t[2]), n + 1.0));
        sum / f32::max(count, 1.0)
    }
}

/// Whether bark at a place of a tile is dark and cool or light and warm, 0..1.
pub fn crust(x: f32, y: f32) -> f32 {
    0.6 * periodic(x, y, [5, 4], 11) + 0.4 * periodic(x, y, [14, 9], 12)
}

/// Height of furrowed bark at a place of a tile, 0 in a furrow to 1 on a ridge.
pub fn furrows(x: f32, y: f32) -> f32 {
    // Long ridges, bent by slow noise, broken across now and then.
    let bend = 0.10 * (periodic(x, y, [3, 3], 1) - 0.5) + 0.03 * (periodic(x, y, [9, 7], 2) - 0.5);
    let ridge = |cells: u32, tall: u32, seed: u32| {
        let v = periodic(x + bend, y, [cells, tall], seed);
        1.0 - (2.0 * v - 1.0).abs()
    };
    let furrow = 1.0 - ridge(7, 2, 3).powi(2) * 0.85 - 0.45 * ridge(13, 4, 4).powi(3);
    let crack = 0.25 * ridge(6, 11, 5).powi(5);
    let grain = 0.22 * (periodic(x, y, [48, 24], 6) - 0.5) + 0.12 * (periodic(x, y, [96, 64], 7) - 0.5);
    (furrow - crack + grain).clamp(0.0, 1.0)
}

/// The grain of bark at a place of a tile, 0..1 around and along.
struct TileGrain(f32, f32);

impl Grain for TileGrain {
    fn crust(&self) -> f32 {
        crust(self.0, self.1)
    }

    fn ridge(&self) -> f32 {
        furrows(self.0, self.1)
    }

    fn plate(&self) -> f32 {
        let bend = 0.06 * (periodic(self.0, self.1, [7, 5], 21) - 0.5);
        let large = periodic(self.0 + bend, self.1 + bend, [6, 3], 22);
        let small = periodic(self.0 - bend, self.1 + bend, [13, 7], 23);
        // Cracks run where the noise crosses its middle, all around each plate.
        (2.0 * (2.0 * (0.8 * large + 0.2 * small) - 1.0).abs()).min(1.0)
    }

    fn streak(&self) -> f32 {
        periodic(self.0, self.1, [4, 17], 24)
    }

    fn blotch(&self) -> f32 {
        (2.0 * periodic(self.0, self.1, [4, 4], 25) + periodic(self.0, self.1, [8, 7], 26)) / 3.0
    }

    fn ring(&self) -> f32 {
        let ring = RINGS * self.1 + 0.2 * periodic(self.0, self.1, [3, 3], 27);
        ring - ring.floor()
    }
}

/// Height of bark at a place of a tile, 0 deepest to 1.
fn height(pattern: BarkPattern, x: f32, y: f32) -> f32 {
    let grain = TileGrain(x, y);
    match pattern {
        BarkPattern::Furrowed => furrows(x, y),
        BarkPattern::Plates => 0.75 * smooth(0.12, 0.34, grain.plate()) + 0.25 * furrows(x, y),
        BarkPattern::Smooth => 0.15 * furrows(x, y),
        BarkPattern::Banded => 0.15 * furrows(x, y) + 0.15 * smooth(0.6, 0.8, grain.streak()),
        BarkPattern::Ringed => 0.5 * smooth(0.0, 0.22, (grain.ring() - 0.5).abs()) + 0.1 * furrows(x, y),
    }
}

/// Heights of a square tile that repeats.
#[derive(Debug, Clone)]
pub struct Relief {
    size: usize,
    heights: Vec<f32>,
}

impl Relief {
    /// Heights at the texels of a tile of that side; `height` takes a place 0..1 around and along.
    pub fn new(size: usize, height: impl Fn(f32, f32) -> f32) -> Self {
        let at = |k: usize| (k as f32 + 0.5) / size as f32;
        let heights = (0..size * size).map(|k| height(at(k % size), at(k / size))).collect();
        Self { size, heights }
    }

    /// Height at a texel.
    pub fn height(&self, x: usize, y: usize) -> f32 {
        self.heights[(y % self.size) * self.size + x % self.size]
    }

    /// How much higher the next texel is than the last, around and along.
    pub fn rise(&self, x: usize, y: usize) -> [f32; 2] {
        let n = self.size;
        [self.height(x + 1, y) - self.height(x + n - 1, y), self.height(x, y + 1) - self.height(x, y + n - 1)]
    }
}

/// Colour of old bark; its twigs have another, which vertex colours give: see [`bark_tint`].
///
/// `tinted` is whether it will be multiplied by them.
pub fn bark(species: &Species, tinted: bool) -> Texture {
    let bark = Bark::of(species);
    let radius = bark.old_radius.max(f32::MIN_POSITIVE);
    let mut texture = Texture::new(BARK_TEXELS, BARK_TEXELS, |x, y| {
        bark.at(radius, &TileGrain(x, y)).extend(1.0).to_array()
    });
    // Light and dark even out to the colour of the species; marks stay as dark as they are.
    let plain = Bark { mark: bark.old, ..bark };
    let shades = Texture::new(64, 64, |x, y| plain.at(radius, &TileGrain(x, y)).extend(1.0).to_array());
    let mut factor = bark.old / shades.mean().max(Vec3::splat(1e-4));
    if tinted {
        factor /= bark_tint(&bark, radius).max(Vec3::splat(1e-4));
    }
    scale(&mut texture, factor);
    texture
}

/// What the texture of bark is multiplied with on a stem of that radius (metres), 0..1: twigs are of another colour.
pub fn bark_tint(bark: &Bark, radius: f32) -> Vec3 {
    bark.color(radius) / bark.young.max(bark.old).max(Vec3::splat(1e-4))
}

/// Normals of bark, parts 0..1 for -1..1 as glTF has them: x around the stem, y against the rows, z outward.
pub fn bark_normals(species: &Species) -> Texture {
    let relief = Relief::new(BARK_TEXELS, |x, y| height(species.bark_pattern, x, y));
    let steep = DEPTH * BARK_TEXELS as f32 * 0.5;
    let texels = (0..BARK_TEXELS * BARK_TEXELS).map(|k| {
        let [x, y] = relief.rise(k % BARK_TEXELS, k / BARK_TEXELS);
        let normal = Vec3::new(-x * steep, y * steep, 1.0).normalize();
        (0.5 * normal + 0.5).extend(1.0).to_array()
    });
    Texture { width: BARK_TEXELS, height: BARK_TEXELS, texels: texels.collect() }
}

/// A leaf of a species, its outline in alpha: u across at its greatest width, v from base to tip.
///
/// A narrow stalk along the midrib is always there. `tinted` is whether it will be multiplied by [`leaf_tint`].
pub fn leaf(species: &Species, tinted: bool) -> Texture {
    let slender = species.leaf_width_m / species.leaf_length_m.max(f32::MIN_POSITIVE);
    let wanted = (LEAF_TEXELS as f32 * slender).clamp(32.0, LEAF_TEXELS as f32);
    let width = (wanted as usize).next_power_of_two();
    let outline = species.leaf_outline;
    let color = Vec3::from(species.leaf_color.linear());
    let mut texture = Texture::new(width, LEAF_TEXELS, |u, v| {
        let side = 2.0 * u - 1.0;
        let mottle = 0.94 + 0.12 * periodic(u, v, [9, 14], 31);
        let inside = side.abs() <= outline.half_width(v) || side.abs() * width as f32 <= 2.0 * STALK_TEXELS;
        // Outside it goes on in its colour, so that no dark rim shows where texels mix.
        (color * blade::light(side, v) * mottle).extend(if inside { 1.0 } else { 0.0 }).to_array()
    });
    let mut factor = color / texture.mean().max(Vec3::splat(1e-4));
    if tinted {
        factor *= blade::BRIGHTEST;
    }
    scale(&mut texture, factor);
    texture
}

/// Many leaves of a species on a square, for cards that stand for a lot of them; v from the twig outward.
///
/// `tinted` is whether it will be multiplied by [`leaf_tint`].
pub fn spray(species: &Species, tinted: bool) -> Texture {
    let one = leaf(species, tinted);
    let slender = (species.leaf_width_m / species.leaf_length_m.max(f32::MIN_POSITIVE)).clamp(0.05, 1.5);
    // Slender leaves are laid closer.
    let count = (SPRAY_LEAVES / slender.sqrt()) as u32;
    let mut texture = Texture::new(LEAF_TEXELS, LEAF_TEXELS, |_, _| [0.0; 4]);
    for k in 0..count {
        let chance = |seed: u32| unit(hash(hash(k ^ 0x5EED) ^ seed));
        // Along a twig from the middle of the base upward, fanning out; all of it stays on the card.
        let along = 0.08 + 0.84 * (k as f32 + 0.5) / count as f32;
        let turn = (if k % 2 == 0 { 1.0 } else { -1.0 }) * (0.25 + 1.1 * chance(1));
        let (sin, cos) = ops::sin_cos(turn);
        let ahead = Vec2::new(sin, cos);
        let middle = Vec2::new(
            0.5 + 0.34 * (2.0 * chance(2) - 1.0),
            along.clamp(0.5 * SPRAY_LENGTH, 1.0 - 0.5 * SPRAY_LENGTH),
        );
        let shade = 0.82 + 0.36 * chance(3);
        for (i, texel) in texture.texels.iter_mut().enumerate() {
            let at = Vec2::new((i % LEAF_TEXELS) as f32, (i / LEAF_TEXELS) as f32) + 0.5;
            let off = (at / LEAF_TEXELS as f32 - middle) / SPRAY_LENGTH;
            let (v, side) = (off.dot(ahead) + 0.5, off.perp_dot(ahead) / slender + 0.5);
            if !(0.0..1.0).contains(&v) || !(0.0..1.0).contains(&side) {
                continue;
            }
            let (x, y) = ((side * one.width as f32) as usize, (v * one.height as f32) as usize);
            let [r, g, b, a] = one.texels[y * one.width + x];
            if a > 0.5 {
                *texel = [r * shade, g * shade, b * shade, 1.0];
            }
        }
    }
    let wanted = one.mean();
    let factor = wanted / texture.mean().max(Vec3::splat(1e-4));
    scale(&mut texture, factor);
    for texel in texture.texels.iter_mut().filter(|texel| texel[3] == 0.0) {
        *texel = wanted.extend(0.0).to_array();
    }
    texture
}

/// What the texture of a leaf is multiplied with, 0..1, from two numbers in -0.5..0.5: no two leaves are alike.
pub fn leaf_tint(a: f32, b: f32) -> Vec3 {
    blade::variation(a, b) / blade::BRIGHTEST
}

fn scale(texture: &mut Texture, factor: Vec3) {
    for texel in &mut texture.texels {
        for (part, factor) in texel.iter_mut().zip(factor.to_array()) {
            *part = (*part * factor).clamp(0.0, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATTERNS: [BarkPattern; 5] = [
        BarkPattern::Furrowed,
        BarkPattern::Smooth,
        BarkPattern::Plates,
        BarkPattern::Banded,
        BarkPattern::Ringed,
    ];

    #[test]
    fn bark_repeats_without_a_seam() {
        for pattern in PATTERNS {
            for k in 0..20 {
                let y = k as f32 / 20.0;
                assert!((height(pattern, 0.0, y) - height(pattern, 1.0, y)).abs() < 2e-3, "{pattern:?}");
                assert!((height(pattern, y, 0.0) - height(pattern, y, 1.0)).abs() < 2e-3, "{pattern:?}");
            }
        }
    }

    #[test]
    fn bark_is_of_the_colour_of_its_species() {
        for bark_pattern in PATTERNS {
            let species = Species { bark_pattern, ..Species::default() };
            let Bark { old, mark, .. } = Bark::of(&species);
            let mean = bark(&species, false).mean();
            // Marks are darker, and cover less than half.
            let share = ((old - mean) / (old - mark)).max_element();
            assert!((-0.02..0.5).contains(&share), "{bark_pattern:?} {share}");
            if matches!(bark_pattern, BarkPattern::Furrowed | BarkPattern::Smooth) {
                assert!(share < 0.02, "{bark_pattern:?} {share}");
            }
        }
    }

    #[test]
    fn tint_times_texture_is_the_colour_of_twig_and_trunk() {
        let mut species = Species { bark_old_radius_m: 0.1, ..Species::default() };
        species.bark_young_color.0 = [0.9, 0.3, 0.2];
        let here = Bark::of(&species);
        let mean = bark(&species, true).mean();
        for (radius, color) in [(0.001, here.young), (0.2, here.old)] {
            let tint = bark_tint(&here, radius);
            assert!(tint.min_element() >= 0.0 && tint.max_element() <= 1.0);
            assert!((mean * tint / color - 1.0).abs().max_element() < 0.03, "{radius}");
        }
        let color = Vec3::from(species.leaf_color.linear());
        let tinted = leaf(&species, true).mean() * leaf_tint(0.0, 0.0);
        assert!((tinted / color - 1.0).abs().max_element() < 0.02);
    }
}
