//! A cube map unfolded: what an organ sees, drawn.

use bevy::prelude::*;
use image::{Rgb, RgbImage, imageops};

use super::daylight::{Daylight, encode};
use super::look::Palette;
use crate::environment::cube_map::{CubeFace, CubeMap};
use crate::environment::probe::TexelWeight;
use crate::environment::trace::{Seen, Tracer};
use crate::export::canvas::{INK, PAPER, text_size, write_text};

/// How a cube map is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CubeMapView {
    /// Distance at which free space is full, metres.
    pub range: f32,
    /// How texels count in the readings.
    pub weight: TexelWeight,
    /// Width of a face at least, pixels; texels are squares of whole pixels.
    pub face_width: u32,
}

impl Default for CubeMapView {
    fn default() -> Self {
        Self { range: 1.0, weight: TexelWeight::default(), face_width: 144 }
    }
}

/// Gap between faces, pixels.
const GAP: u32 = 4;

/// Column and row of a face in the cross, and its name; `Up` and `Down` fold onto `North`.
fn place(face: CubeFace) -> (u32, u32, &'static str) {
    match face {
        CubeFace::Up => (1, 0, "up"),
        CubeFace::West => (0, 1, "west -x"),
        CubeFace::North => (1, 1, "north -z"),
        CubeFace::East => (2, 1, "east +x"),
        CubeFace::South => (3, 1, "south +z"),
        CubeFace::Down => (1, 2, "down"),
    }
}

/// Draws the six faces of a cube map as a cross, each texel in the colour of what it saw and darker the nearer
/// that is, with the readings of each face and of the whole.
pub fn cube_map_picture(map: &CubeMap, tracer: &Tracer, palette: &Palette, view: CubeMapView) -> RgbImage {
    let scene = tracer.scene();
    let size = map.size().max(1) as u32;
    let texel = view.face_width.div_ceil(size).clamp(1, 4096 / size.min(4096));
    let side = size * texel;
    let daylight = Daylight::of(scene, palette.grass, Vec3::NEG_Z, Vec3::X);
    let at = |cells: u32| GAP + cells * (side + GAP);
    let mut sheet = RgbImage::from_pixel(at(4), at(3), Rgb(PAPER));

    for reading in map.faces(&scene.sky, view.range, view.weight) {
        let (column, row, name) = place(reading.face);
        let texels = map.face(reading.face);
        let mut image = RgbImage::from_fn(side, side, |x, y| {
            let (i, j) = (x / texel, y / texel);
            let Some(texel) = texels.get((j * size + i) as usize) else { return Rgb(PAPER) };
            let across = (2.0 * i as f32 + 1.0) / size as f32 - 1.0;
            let up = 1.0 - (2.0 * j as f32 + 1.0) / size as f32;
            let height = match reading.face {
                CubeFace::Up => 1.0,
                CubeFace::Down => -1.0,
                _ => up,
            };
            let toward = Vec3::new(across, height, 1.0).normalize();
            Rgb(encode(color(
                tracer,
                palette,
                &daylight,
                texel.seen,
                texel.depth / view.range.max(1e-6),
                toward,
            )))
        });
        let scale = if side >= 240 { 2 } else { 1 };
        let numbers = format!("light {:.2}\nspace {:.2}", reading.light.abs(), reading.space);
        let low = i64::from(side) - i64::from(text_size(&numbers, scale).1) - 4;
        write_text(&mut image, 4, 4, name, scale, [255; 3]);
        write_text(&mut image, 4, low, &numbers, scale, [255; 3]);
        imageops::replace(&mut sheet, &image, i64::from(at(column)), i64::from(at(row)));
    }

    let whole = format!(
        "share {:.3}\nspace {:.3}\nsky light {:.3}",
        map.share(view.weight),
        map.space(view.range, view.weight),
        map.sky_light(&scene.sky).abs()
    );
    let scale = if text_size(&whole, 2).0 + 16 < 2 * side { 2 } else { 1 };
    write_on_paper(&mut sheet, at(2) + 8, at(0) + 8, &whole, scale);
    let p = map.position();
    let here = format!("at {:.2}, {:.2}, {:.2} m\nface {size} x {size}", p.x, p.y, p.z);
    write_on_paper(&mut sheet, at(2) + 8, at(2) + 8, &here, 1);
    sheet
}

fn write_on_paper(sheet: &mut RgbImage, x: u32, y: u32, text: &str, scale: u32) {
    write_text(sheet, i64::from(x), i64::from(y), text, scale, INK);
}

/// Colour of what a texel saw, linear RGB 0..1; `depth` in ranges of space.
fn color(
    tracer: &Tracer,
    palette: &Palette,
    daylight: &Daylight,
    seen: Seen,
    depth: f32,
    toward: Vec3,
) -> Vec3 {
    let scene = tracer.scene();
    let thing = match seen {
        Seen::Sky => return daylight.develop(daylight.backdrop(toward)),
        Seen::Lamp(i) => {
            let lamp = scene.lamps[i as usize].lamp;
            if lamp.on {
                return Vec3::from(lamp.color).lerp(Vec3::ONE, 0.4);
            }
            Vec3::splat(0.4)
        }
        Seen::Ground => palette.grass,
        Seen::Solid(i) => Vec3::from(scene.solids[i as usize].color),
        Seen::Wood(i) => {
            let wood = &scene.capsules[i as usize];
            palette.plant(wood.plant).bark.color(wood.radius)
        }
        Seen::Leaf(i) => palette.plant(scene.leaves[i as usize].plant).leaf * 1.4,
    };
    // Half the way to full brightness at half the range.
    let open = depth / (depth + 0.5);
    thing * (0.25 + 0.85 * open)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::Scene;

    #[test]
    fn open_ground_is_sky_above_and_grass_below() {
        let scene = Scene { ground: Some(0.0), ..Scene::default() };
        let tracer = Tracer::build(&scene);
        let map = CubeMap::render(&tracer, Vec3::new(0.0, 1.0, 0.0), 8, &[]);
        let view = CubeMapView { face_width: 80, ..CubeMapView::default() };
        let image = cube_map_picture(&map, &tracer, &Palette::default(), view);
        assert_eq!(image.dimensions(), (4 * 84 + 4, 3 * 84 + 4));
        let up = image.get_pixel(84 + 4 + 40, 4 + 40).0;
        let down = image.get_pixel(84 + 4 + 40, 2 * 84 + 4 + 40).0;
        assert!(up[2] > up[0] && down[1] > down[2], "{up:?} {down:?}");
    }
}
