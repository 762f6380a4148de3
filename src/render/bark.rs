//! Bark: one tile of furrowed bark, made here, the same for all plants; each tints it.

use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;

use super::noise::tile;
use crate::shape::texture::{Relief, crust, furrows};

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

fn bark_image() -> Image {
    let at = |k: usize| (k as f32 + 0.5) / SIZE as f32;
    let relief = Relief::new(SIZE, furrows);
    let mut texels = Vec::with_capacity(SIZE * SIZE);
    for y in 0..SIZE {
        for x in 0..SIZE {
            let [rise_x, rise_y] = relief.rise(x, y);
            let texel = [0.5 + 1.6 * rise_x, 0.5 + 1.6 * rise_y, relief.height(x, y), crust(at(x), at(y))];
            texels.push(texel.map(|v| v.clamp(0.0, 1.0)));
        }
    }
    tile(SIZE, texels, |v| v, TextureFormat::Rgba8Unorm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bark_has_all_its_mips() {
        let image = bark_image();
        assert_eq!(image.texture_descriptor.mip_level_count, 9);
        let texels: usize = (0..9).map(|level| (SIZE >> level) * (SIZE >> level)).sum();
        assert_eq!(image.data.map(|data| data.len()), Some(4 * texels));
    }
}
