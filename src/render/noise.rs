//! Images that repeat, with their smaller copies, for the textures made here.

use bevy::asset::RenderAssetUsages;
use bevy::image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor};
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};

/// A square image that repeats, of four parts in 0..1, with its smaller copies; `size` is a power of two.
pub(super) fn tile(
    size: usize,
    texels: Vec<[f32; 4]>,
    encode: fn(f32) -> f32,
    format: TextureFormat,
) -> Image {
    let levels = halves(size, texels);
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let bytes = levels.iter().flatten();
    let bytes =
        bytes.flat_map(|[r, g, b, a]| [byte(encode(*r)), byte(encode(*g)), byte(encode(*b)), byte(*a)]);
    let extent = Extent3d { width: size as u32, height: size as u32, depth_or_array_layers: 1 };
    let mut image = Image::new_uninit(extent, TextureDimension::D2, format, RenderAssetUsages::RENDER_WORLD);
    image.data = Some(bytes.collect());
    image.texture_descriptor.mip_level_count = levels.len() as u32;
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        anisotropy_clamp: 8,
        ..default()
    });
    image
}

/// An image and its halves down to one texel.
fn halves(size: usize, texels: Vec<[f32; 4]>) -> Vec<Vec<[f32; 4]>> {
    let mut levels = vec![texels];
    let mut size = size;
    while size > 1 {
        let last = &levels[levels.len() - 1];
        let half = size / 2;
        let mut next = Vec::with_capacity(half * half);
        for y in 0..half {
            for x in 0..half {
                let of = |dx: usize, dy: usize| last[(2 * y + dy) * size + 2 * x + dx];
                let four = [of(0, 0), of(1, 0), of(0, 1), of(1, 1)];
                next.push(std::array::from_fn(|k| four.iter().map(|t| t[k]).sum::<f32>() * 0.25));
            }
        }
        levels.push(next);
        size = half;
    }
    levels
}
