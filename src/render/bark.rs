//! Bark: one tile of furrowed bark, made here, the same for all plants; each tints it.

use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;

use super::noise::{periodic, tile};

/// The tile's side, texels.
const SIZE: usize = 256;

/// The bark tile: normal x and y, height, shade.
#[derive(Resource)]
pub struct BarkImage(pub Handle<Image>);

impl FromWorld for BarkImage {
    fn from_world(world: &mut World) -> Self {
        let mut images = world.resource_mut::<Assets<Image>>();
        Self(images.add(bark_image()))
    }
}

/// Height of bark at a texel, 0 in a furrow to 1 on a ridge.
fn height(x: f32, y: f32) -> f32 {
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

fn bark_image() -> Image {
    let at = |k: usize| (k as f32 + 0.5) / SIZE as f32;
    let heights: Vec<f32> = (0..SIZE * SIZE).map(|k| height(at(k % SIZE), at(k / SIZE))).collect();
    let of = |x: usize, y: usize| heights[(y % SIZE) * SIZE + x % SIZE];
    let mut texels = Vec::with_capacity(SIZE * SIZE);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let slope_x = of(x + SIZE - 1, y) - of(x + 1, y);
            let slope_y = of(x, y + SIZE - 1) - of(x, y + 1);
            let shade = 0.6 * periodic(at(x), at(y), [5, 4], 11) + 0.4 * periodic(at(x), at(y), [14, 9], 12);
            texels
                .push([0.5 - 1.6 * slope_x, 0.5 - 1.6 * slope_y, of(x, y), shade].map(|v| v.clamp(0.0, 1.0)));
        }
    }
    tile(SIZE, texels, |v| v, TextureFormat::Rgba8Unorm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bark_repeats_without_a_seam() {
        for k in 0..20 {
            let y = k as f32 / 20.0;
            assert!((height(0.0, y) - height(1.0, y)).abs() < 1e-3);
            assert!((height(y, 0.0) - height(y, 1.0)).abs() < 1e-3);
        }
    }

    #[test]
    fn bark_has_all_its_mips() {
        let image = bark_image();
        assert_eq!(image.texture_descriptor.mip_level_count, 9);
        let texels: usize = (0..9).map(|level| (SIZE >> level) * (SIZE >> level)).sum();
        assert_eq!(image.data.map(|data| data.len()), Some(4 * texels));
    }
}
