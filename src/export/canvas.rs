//! Pictures put together: captions, frames, pictures side by side.

use font8x8::UnicodeFonts;
use image::{Rgb, RgbImage, imageops};

/// Height of a line of text at scale 1, pixels.
const LINE: u32 = 10;

/// The eight rows of a character, lowest bit leftmost; a small box if the font lacks it.
fn glyph(c: char) -> [u8; 8] {
    font8x8::BASIC_FONTS
        .get(c)
        .or_else(|| font8x8::LATIN_FONTS.get(c))
        .or_else(|| font8x8::GREEK_FONTS.get(c))
        .unwrap_or([0, 0x3C, 0x24, 0x24, 0x24, 0x3C, 0, 0])
}

/// First column and width in columns of a character: the font is proportional.
fn extent(rows: &[u8; 8]) -> (u32, u32) {
    match rows.iter().fold(0, |all, row| all | row) {
        0 => (0, 3),
        ink => (ink.trailing_zeros(), 8 - ink.trailing_zeros() - ink.leading_zeros()),
    }
}

/// Width and height of a text in pixels, its lines split at `\n`. A `scale` of 0 counts as 1.
pub fn text_size(text: &str, scale: u32) -> (u32, u32) {
    let scale = scale.max(1);
    let width = |line: &str| line.chars().map(|c| extent(&glyph(c)).1 + 1).sum::<u32>().saturating_sub(1);
    let lines = text.lines().count() as u32;
    (text.lines().map(width).max().unwrap_or(0) * scale, (lines * LINE).saturating_sub(2) * scale)
}

/// Blends a colour over a pixel; outside the picture nothing happens.
fn blend(image: &mut RgbImage, x: i64, y: i64, color: [u8; 3], share: f32) {
    let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
    if let Some(pixel) = image.get_pixel_mut_checked(x, y) {
        for (old, new) in pixel.0.iter_mut().zip(color) {
            *old = (*old as f32 + (new as f32 - *old as f32) * share + 0.5) as u8;
        }
    }
}

/// Calls `dot` for each inked pixel of a text whose top left corner is at (0, 0).
fn ink(text: &str, scale: u32, mut dot: impl FnMut(i64, i64)) {
    let scale = scale.max(1);
    for (row, line) in text.lines().enumerate() {
        let mut left = 0;
        for c in line.chars() {
            let rows = glyph(c);
            let (first, width) = extent(&rows);
            let lit = |x: u32, y: u32| rows[y as usize] >> x & 1 == 1;
            for (y, x) in (0..8 * scale).flat_map(|y| (0..width * scale).map(move |x| (y, x))) {
                if lit(first + x / scale, y / scale) {
                    dot(i64::from(left * scale + x), i64::from(row as u32 * LINE * scale + y));
                }
            }
            left += width + 1;
        }
    }
}

/// Writes text with its top left corner at `x`, `y` over a soft shadow. What falls outside is cut off.
pub fn write_text(image: &mut RgbImage, x: i64, y: i64, text: &str, scale: u32, color: [u8; 3]) {
    let dark = if color.iter().map(|c| *c as u32).sum::<u32>() > 300 { [0; 3] } else { [255; 3] };
    let reach = i64::from(scale.max(1));
    for (dx, dy, share) in [(reach, reach, 0.35), (0, reach, 0.25), (reach, 0, 0.25)] {
        ink(text, scale, |px, py| blend(image, x + px + dx, y + py + dy, dark, share));
    }
    ink(text, scale, |px, py| blend(image, x + px, y + py, color, 1.0));
}

/// Lays a dark, half-clear band along the bottom of a picture and writes a caption on it.
///
/// The caption may have several lines; one too wide for `scale` is written smaller.
pub fn caption(image: &mut RgbImage, text: &str, scale: u32) {
    let fits = |scale: &u32| text_size(text, *scale).0 + 8 * scale <= image.width();
    let scale = (1..=scale.max(1)).rev().find(fits).unwrap_or(1);
    let (_, height) = text_size(text, scale);
    let band = height + 8 * scale;
    let top = i64::from(image.height()) - i64::from(band);
    for y in top..i64::from(image.height()) {
        for x in 0..i64::from(image.width()) {
            blend(image, x, y, [16, 20, 22], 0.62);
        }
    }
    write_text(image, i64::from(4 * scale), top + i64::from(4 * scale), text, scale, [240, 240, 232]);
}

/// A picture with a strip of paper above it that bears a title.
pub fn titled(image: &RgbImage, title: &str, scale: u32) -> RgbImage {
    let scale = scale.max(1);
    let strip = text_size(title, scale).1 + 8 * scale;
    let mut whole = RgbImage::from_pixel(image.width(), image.height() + strip, Rgb(PAPER));
    imageops::replace(&mut whole, image, 0, i64::from(strip));
    let margin = i64::from(4 * scale);
    ink(title, scale, |x, y| blend(&mut whole, margin + x, margin + y, INK, 1.0));
    whole
}

/// Background of sheets of pictures.
pub const PAPER: [u8; 3] = [246, 244, 238];
/// Writing on [`PAPER`].
pub const INK: [u8; 3] = [46, 48, 44];

/// A picture in an even border of that colour, pixels wide.
pub fn framed(image: &RgbImage, border: u32, color: [u8; 3]) -> RgbImage {
    let mut whole = RgbImage::from_pixel(image.width() + 2 * border, image.height() + 2 * border, Rgb(color));
    imageops::replace(&mut whole, image, i64::from(border), i64::from(border));
    whole
}

/// Pictures in one row with a gap of paper between them, pixels wide.
pub fn side_by_side(images: &[RgbImage], gap: u32) -> RgbImage {
    grid(images, images.len(), gap)
}

/// Pictures in rows of `columns` with gaps of paper between them, pixels wide; each is centred in its cell.
///
/// No pictures make a picture of no size.
pub fn grid(images: &[RgbImage], columns: usize, gap: u32) -> RgbImage {
    let columns = columns.clamp(1, images.len().max(1));
    let rows = images.len().div_ceil(columns);
    let width = |c: usize| images.iter().skip(c).step_by(columns).map(|i| i.width()).max().unwrap_or(0);
    let height =
        |r: usize| images.iter().skip(r * columns).take(columns).map(|i| i.height()).max().unwrap_or(0);
    let widths: Vec<u32> = (0..columns).map(width).collect();
    let heights: Vec<u32> = (0..rows).map(height).collect();
    let span = |parts: &[u32]| parts.iter().sum::<u32>() + gap * (parts.len() as u32).saturating_sub(1);
    let mut sheet = RgbImage::from_pixel(span(&widths), span(&heights), Rgb(PAPER));
    for (i, image) in images.iter().enumerate() {
        let (row, column) = (i / columns, i % columns);
        let left = widths[..column].iter().map(|w| w + gap).sum::<u32>();
        let top = heights[..row].iter().map(|h| h + gap).sum::<u32>();
        let x = left + (widths[column] - image.width()) / 2;
        let y = top + (heights[row] - image.height()) / 2;
        imageops::replace(&mut sheet, image, i64::from(x), i64::from(y));
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caption_draws_bright_letters_on_a_dark_band_and_leaves_the_rest() {
        let mut image = RgbImage::from_pixel(120, 60, Rgb([120; 3]));
        caption(&mut image, "step 7", 1);
        assert!(image.pixels().filter(|p| p.0[0] > 220).count() > 40);
        assert!(image.get_pixel(119, 59).0[0] < 80);
        assert_eq!(image.get_pixel(60, 10).0, [120; 3]);
    }

    #[test]
    fn a_caption_too_wide_is_written_smaller_and_text_outside_is_cut_off() {
        let mut image = RgbImage::from_pixel(60, 40, Rgb([120; 3]));
        caption(&mut image, "a long caption that cannot fit", 4);
        write_text(&mut image, -5, -5, "x", 2, [255; 3]);
        write_text(&mut image, 58, 38, "x", 2, [255; 3]);
        assert_eq!(image.dimensions(), (60, 40));
    }

    #[test]
    fn a_grid_has_room_for_its_pictures_and_gaps() {
        let images = [(10, 8), (6, 4), (10, 8)].map(|(w, h)| RgbImage::from_pixel(w, h, Rgb([9; 3])));
        let sheet = grid(&images, 2, 3);
        assert_eq!(sheet.dimensions(), (19, 19));
        assert_eq!(sheet.get_pixel(0, 0).0, [9; 3]);
        assert_eq!(sheet.get_pixel(11, 0).0, PAPER);
        assert_eq!(sheet.get_pixel(13, 2).0, [9; 3]);
        assert_eq!(side_by_side(&images, 1).dimensions(), (28, 8));
        assert_eq!(grid(&[], 3, 4).dimensions(), (0, 0));
    }
}
