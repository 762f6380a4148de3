//! Materials of species, with their textures as PNG inside the model.

use std::sync::Arc;

use gltf_json::image::MimeType;
use gltf_json::material::{
    AlphaCutoff, AlphaMode, NormalTexture, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor,
};
use gltf_json::texture::{Info, MagFilter, MinFilter, Sampler, Texture as GltfTexture, WrappingMode};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Image, Index, Material};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::model::Model;
use crate::export::ExportError;
use crate::shape::noise::srgb;
use crate::shape::texture::{self, Texture};
use crate::species::Species;

/// What a species has a material for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Bark,
    Leaves,
    /// Leaves as cards of many.
    Sprays,
}

/// A material made already, and what for.
pub(super) struct Made {
    species: Arc<Species>,
    part: Part,
    material: Index<Material>,
}

impl Model {
    /// The material of a part of a species, made when first asked for.
    pub(super) fn material(
        &mut self,
        species: &Arc<Species>,
        part: Part,
        tinted: bool,
    ) -> Result<Index<Material>, ExportError> {
        let same = |made: &&Made| {
            made.part == part && (Arc::ptr_eq(&made.species, species) || made.species == *species)
        };
        if let Some(made) = self.made.iter().find(same) {
            return Ok(made.material);
        }
        let name = &species.name;
        let material = match part {
            Part::Bark => {
                let color = self.texture(format!("{name} bark"), &texture::bark(species, tinted), srgb)?;
                let normals = texture::bark_normals(species);
                let normals = self.texture(format!("{name} bark normals"), &normals, |part| part)?;
                Material {
                    normal_texture: Some(NormalTexture {
                        index: normals,
                        scale: 1.0,
                        tex_coord: 0,
                        extensions: None,
                        extras: Default::default(),
                    }),
                    ..material(format!("{name} bark"), color, 0.9)
                }
            }
            Part::Leaves | Part::Sprays => {
                let (what, texture) = match part {
                    Part::Sprays => ("spray", texture::spray(species, tinted)),
                    _ => ("leaf", texture::leaf(species, tinted)),
                };
                let color = self.texture(format!("{name} {what}"), &texture, srgb)?;
                let leaves = if part == Part::Sprays { "sprays" } else { "leaves" };
                Material {
                    alpha_mode: Valid(AlphaMode::Mask),
                    alpha_cutoff: Some(AlphaCutoff(0.5)),
                    double_sided: true,
                    ..material(format!("{name} {leaves}"), color, 0.6)
                }
            }
        };
        let material = self.root.push(material);
        self.made.push(Made { species: species.clone(), part, material });
        Ok(material)
    }

    /// Adds a texture as PNG, `encode` for its colours; with alpha if any of it is clear, which then does not repeat.
    fn texture(
        &mut self,
        name: String,
        texture: &Texture,
        encode: fn(f32) -> f32,
    ) -> Result<Index<GltfTexture>, ExportError> {
        let clear = texture.texels.iter().any(|texel| texel[3] < 1.0);
        let png = png(texture, clear, encode)?;
        let view = self.view(png.into_iter(), None);
        let source = self.root.push(Image {
            buffer_view: Some(view),
            mime_type: Some(MimeType("image/png".into())),
            name: Some(name.clone()),
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        let wrap = if clear { WrappingMode::ClampToEdge } else { WrappingMode::Repeat };
        let sampler = self.root.push(Sampler {
            mag_filter: Some(Valid(MagFilter::Linear)),
            min_filter: Some(Valid(MinFilter::LinearMipmapLinear)),
            wrap_s: Valid(wrap),
            wrap_t: Valid(wrap),
            ..Sampler::default()
        });
        Ok(self.root.push(GltfTexture {
            name: Some(name),
            sampler: Some(sampler),
            source,
            extensions: None,
            extras: Default::default(),
        }))
    }
}

fn material(name: String, color: Index<GltfTexture>, roughness: f32) -> Material {
    Material {
        name: Some(name),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([1.0; 4]),
            base_color_texture: Some(Info {
                index: color,
                tex_coord: 0,
                extensions: None,
                extras: Default::default(),
            }),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(roughness),
            ..PbrMetallicRoughness::default()
        },
        ..Material::default()
    }
}

fn png(texture: &Texture, alpha: bool, encode: fn(f32) -> f32) -> Result<Vec<u8>, ExportError> {
    let byte = |part: f32| (part.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let parts = if alpha { 4 } else { 3 };
    let mut bytes = Vec::with_capacity(texture.texels.len() * parts);
    for [r, g, b, a] in &texture.texels {
        bytes.extend([encode(*r), encode(*g), encode(*b)].map(byte));
        if alpha {
            bytes.push(byte(*a));
        }
    }
    let mut png = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive);
    let kind = if alpha { ExtendedColorType::Rgba8 } else { ExtendedColorType::Rgb8 };
    encoder
        .write_image(&bytes, texture.width as u32, texture.height as u32, kind)
        .map_err(std::io::Error::other)?;
    Ok(png)
}
