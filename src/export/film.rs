//! Films: animated GIFs that stay small, and pictures saved as PNG.

mod quantize;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use gif::{DisposalMethod, Encoder, Frame, Repeat};
use image::RgbImage;

use crate::files::write_whole;
use quantize::Quantizer;

/// Why a film or picture could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// There is nothing to show.
    #[error("a film needs at least one frame")]
    NoFrames,
    /// A frame has another size than the first, or none, or more than a GIF can hold (65,535 a side).
    #[error("frame {frame} is {width} x {height}; all frames need one size, 1 to 65535 a side")]
    Size {
        /// Which frame, from 0.
        frame: usize,
        /// Its width, pixels.
        width: u32,
        /// Its height, pixels.
        height: u32,
    },
    /// The film could not be encoded.
    #[error("could not encode the film: {0}")]
    Gif(#[from] gif::EncodingError),
    /// The picture could not be encoded.
    #[error("could not encode the picture: {0}")]
    Png(#[from] image::ImageError),
    /// The file could not be written.
    #[error("could not write {path}: {source}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: io::Error,
    },
}

/// How a film is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FilmSettings {
    /// How long a frame is shown, milliseconds; GIF knows steps of ten.
    pub frame_ms: u32,
    /// How long the last frame is shown before the film begins again, milliseconds.
    pub hold_last_ms: u32,
    /// Most colours, 2 to 255; fewer make a smaller file.
    pub max_colors: usize,
    /// A pixel keeps its colour until it is off by more than this (0..255): grain does not flicker.
    pub tolerance: u8,
}

impl Default for FilmSettings {
    fn default() -> Self {
        Self { frame_ms: 120, hold_last_ms: 2000, max_colors: 96, tolerance: 10 }
    }
}

/// Writes an animated GIF that repeats for ever, all frames in one palette, each storing only what changed.
///
/// # Errors
/// [`FilmError`] if there are no frames, their sizes differ, or writing fails.
pub fn write_gif<W: Write>(writer: W, frames: &[RgbImage], settings: FilmSettings) -> Result<(), FilmError> {
    let (width, height) = frames.first().ok_or(FilmError::NoFrames)?.dimensions();
    for (frame, image) in frames.iter().enumerate() {
        let (w, h) = image.dimensions();
        let fits = (1..=u32::from(u16::MAX)).contains(&w) && (1..=u32::from(u16::MAX)).contains(&h);
        if (w, h) != (width, height) || !fits {
            return Err(FilmError::Size { frame, width: w, height: h });
        }
    }

    let mut colors = Quantizer::of(frames, settings.max_colors.clamp(2, 255));
    let clear = colors.palette().len() as u8;
    let mut table = colors.palette().concat();
    table.extend([0; 3]);
    let mut encoder = Encoder::new(writer, width as u16, height as u16, &table)?;
    encoder.set_repeat(Repeat::Infinite)?;

    let mut shown: Vec<u8> = Vec::new();
    for (i, image) in frames.iter().enumerate() {
        let mut changes = vec![clear; (width * height) as usize];
        // Columns and rows that hold a change: left, right, top, bottom.
        let mut edge = [width, 0, height, 0];
        for (at, pixel) in image.pixels().enumerate() {
            let color = match shown.get(at) {
                Some(old) if colors.is_near(*old, pixel.0, settings.tolerance) => continue,
                old => {
                    let new = colors.nearest(dithered(pixel.0, at as u32 % width, at as u32 / width));
                    if old == Some(&new) {
                        continue;
                    }
                    new
                }
            };
            changes[at] = color;
            let (x, y) = (at as u32 % width, at as u32 / width);
            edge = [edge[0].min(x), edge[1].max(x), edge[2].min(y), edge[3].max(y)];
        }
        if i == 0 {
            shown.clone_from(&changes);
        } else {
            for (old, new) in shown.iter_mut().zip(&changes).filter(|(_, new)| **new != clear) {
                *old = *new;
            }
        }
        if edge[0] > edge[1] {
            edge = [0; 4];
        }
        let [left, right, top, bottom] = edge.map(|e| e as usize);
        let rows = changes.chunks(width as usize).skip(top).take(bottom - top + 1);
        let last = i + 1 == frames.len();
        let shown_ms = if last { settings.hold_last_ms.max(settings.frame_ms) } else { settings.frame_ms };
        encoder.write_frame(&Frame {
            delay: u16::try_from(shown_ms / 10).unwrap_or(u16::MAX).max(1),
            dispose: DisposalMethod::Keep,
            transparent: Some(clear),
            left: left as u16,
            top: top as u16,
            width: (right - left + 1) as u16,
            height: (bottom - top + 1) as u16,
            buffer: rows.flat_map(|row| &row[left..=right]).copied().collect(),
            ..Frame::default()
        })?;
    }
    Ok(())
}

/// A colour pushed a little up or down by its place, so that few colours show a clear sky without bands. The same
/// place is always pushed the same way: nothing flickers.
fn dithered(color: [u8; 3], x: u32, y: u32) -> [u8; 3] {
    /// Half a push, of 255.
    const REACH: i16 = 5;
    // Bits of x and x ^ y in turn, the coarse ones last: Bayer's order of an 8 x 8 square.
    let order = (0..3).fold(0, |order, bit| {
        let (x, y) = (x >> bit & 1, y >> bit & 1);
        order << 2 | (x ^ y) << 1 | y
    });
    let push = (order as i16 * 2 - 63) * REACH / 63;
    color.map(|c| (i16::from(c) + push).clamp(0, 255) as u8)
}

/// Saves a film as [`write_gif`] writes it; a file already there is replaced only when all went well.
///
/// # Errors
/// As [`write_gif`], and [`FilmError::Io`] if the file cannot be written.
pub fn save_gif(path: &Path, frames: &[RgbImage], settings: FilmSettings) -> Result<(), FilmError> {
    let mut bytes = Vec::new();
    write_gif(&mut bytes, frames, settings)?;
    replace_file(path, &bytes)
}

/// Saves a picture as PNG; a file already there is replaced only when all went well.
///
/// # Errors
/// [`FilmError::Png`] if it cannot be encoded, [`FilmError::Io`] if the file cannot be written.
pub fn save_png(path: &Path, image: &RgbImage) -> Result<(), FilmError> {
    let mut bytes = io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png)?;
    replace_file(path, bytes.get_ref())
}

fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), FilmError> {
    write_whole(path, &[bytes]).map_err(|source| FilmError::Io { path: path.into(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn frames() -> Vec<RgbImage> {
        (0..5)
            .map(|i| {
                RgbImage::from_fn(40, 30, |x, y| {
                    let on = (x / 4 == i + 2) && y > 10;
                    Rgb(if on { [220, 40, 30] } else { [x as u8 * 3, 120, y as u8 * 4] })
                })
            })
            .collect()
    }

    fn read_back(bytes: &[u8]) -> (gif::Decoder<&[u8]>, Vec<Frame<'static>>) {
        let mut decoder = gif::DecodeOptions::new().read_info(bytes).unwrap();
        let mut all = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            all.push(frame.clone());
        }
        (decoder, all)
    }

    #[test]
    fn a_film_reads_back_with_its_frames_size_and_times() {
        let mut bytes = Vec::new();
        let settings = FilmSettings { frame_ms: 80, hold_last_ms: 1500, ..Default::default() };
        write_gif(&mut bytes, &frames(), settings).unwrap();
        let (decoder, read) = read_back(&bytes);
        assert_eq!((decoder.width(), decoder.height()), (40, 30));
        assert_eq!(decoder.repeat(), Repeat::Infinite);
        assert_eq!(read.iter().map(|f| f.delay).collect::<Vec<_>>(), [8, 8, 8, 8, 150]);
        assert_eq!((read[0].width, read[0].height), (40, 30));
        assert_eq!((read[1].left, read[1].top, read[1].width, read[1].height), (8, 11, 8, 19));
    }

    #[test]
    fn what_a_film_shows_is_near_what_was_drawn() {
        let mut bytes = Vec::new();
        let drawn = frames();
        write_gif(&mut bytes, &drawn, FilmSettings::default()).unwrap();
        let (decoder, read) = read_back(&bytes);
        let palette = decoder.global_palette().unwrap();
        let mut screen = vec![0_u8; 40 * 30];
        for (frame, image) in read.iter().zip(&drawn) {
            for (i, &index) in frame.buffer.iter().enumerate() {
                if Some(index) != frame.transparent {
                    let (x, y) = (i % frame.width as usize, i / frame.width as usize);
                    screen[(y + frame.top as usize) * 40 + x + frame.left as usize] = index;
                }
            }
            for (&index, pixel) in screen.iter().zip(image.pixels()) {
                let color = &palette[index as usize * 3..][..3];
                let off = color.iter().zip(pixel.0).map(|(a, b)| a.abs_diff(b)).max().unwrap();
                assert!(off < 30, "{color:?} for {pixel:?}");
            }
        }
    }

    #[test]
    fn a_still_film_costs_little() {
        let one = frames().swap_remove(0);
        let (mut still, mut single) = (Vec::new(), Vec::new());
        write_gif(&mut still, &vec![one.clone(); 10], FilmSettings::default()).unwrap();
        write_gif(&mut single, &[one], FilmSettings::default()).unwrap();
        assert!(still.len() < single.len() + 10 * 30);
        assert_eq!(read_back(&still).1.len(), 10);
    }

    #[test]
    fn frames_that_do_not_fit_are_refused() {
        let odd = [RgbImage::new(4, 4), RgbImage::new(4, 5)];
        let settings = FilmSettings::default();
        assert!(matches!(write_gif(Vec::new(), &[], settings), Err(FilmError::NoFrames)));
        assert!(matches!(write_gif(Vec::new(), &odd, settings), Err(FilmError::Size { frame: 1, .. })));
    }
}
