//! Whether a picture shows its plants: it is taken once more without them, and must look otherwise.

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};

use super::{Drawn, offscreen};

/// The least share of the middle of a picture that plants take.
const LEAST: f32 = 0.01;
/// The least difference of a channel, 0 to 255: what dithering and compression never come to.
const APART: u8 = 24;
/// Frames after which what was hidden is on screen no more.
const FRAMES: u32 = 6;

/// Has the window's picture taken once more without plants; the clock of the world stands still meanwhile.
#[derive(Resource)]
pub(crate) struct Evidence {
    with_plants: Image,
    frames: u32,
    shows: Option<bool>,
}

impl Evidence {
    /// Begins with the picture that is to show plants.
    pub fn of(with_plants: Image) -> Self {
        Self { with_plants, frames: 0, shows: None }
    }

    /// Whether it does; `None` until that is known.
    pub fn shows(&self) -> Option<bool> {
        self.shows
    }
}

/// Goes on with it.
pub(crate) fn gather(
    mut commands: Commands,
    evidence: Option<ResMut<Evidence>>,
    clock: Option<ResMut<Time<Virtual>>>,
    mut plants: Query<&mut Visibility, With<Drawn>>,
) {
    let Some(mut evidence) = evidence else { return };
    evidence.frames += 1;
    match evidence.frames {
        1 => {
            plants.iter_mut().for_each(|mut visibility| *visibility = Visibility::Hidden);
            clock.into_iter().for_each(|mut clock| clock.pause());
        }
        FRAMES => {
            commands.spawn(Screenshot::primary_window()).observe(
                |captured: On<ScreenshotCaptured>, mut evidence: ResMut<Evidence>| {
                    evidence.shows = Some(differ(&evidence.with_plants, &captured.image));
                },
            );
        }
        _ => {}
    }
}

/// Whether a picture of an [`offscreen_app`](super::offscreen_app) shows plants: takes it once more without them.
pub fn shows_plants(app: &mut App, target: &Handle<Image>, picture: &Image) -> bool {
    let show = |app: &mut App, shown: Visibility| {
        let world = app.world_mut();
        world.query_filtered::<&mut Visibility, With<Drawn>>().iter_mut(world).for_each(|mut v| *v = shown);
    };
    show(app, Visibility::Hidden);
    (0..FRAMES).for_each(|_| app.update());
    let without = offscreen::take_picture(app, target);
    show(app, Visibility::Inherited);
    without.is_some_and(|without| differ(picture, &without))
}

/// Whether two pictures of one size differ in their middle by more than a little.
fn differ(a: &Image, b: &Image) -> bool {
    let pixels = |image: &Image| image.clone().try_into_dynamic().ok().map(|image| image.to_rgb8());
    pixels(a).zip(pixels(b)).is_some_and(|(a, b)| share_apart(&a, &b) >= LEAST)
}

/// The share of the middle half of two pictures, in width and height, that looks otherwise, 0 to 1; 1 if they differ in
/// size.
fn share_apart(a: &image::RgbImage, b: &image::RgbImage) -> f32 {
    if a.dimensions() != b.dimensions() {
        return 1.0;
    }
    let (width, height) = a.dimensions();
    let middle = |x: u32, y: u32| {
        (width / 4..width - width / 4).contains(&x) && (height / 4..height - height / 4).contains(&y)
    };
    let (mut all, mut apart) = (0_u32, 0_u32);
    for ((x, y, a), b) in a.enumerate_pixels().zip(b.pixels()) {
        if middle(x, y) {
            all += 1;
            apart += u32::from(a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > APART));
        }
    }
    apart as f32 / all.max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::asset::RenderAssetUsages;
    use image::{Rgb, RgbImage};

    fn with_block(size: u32, at: [u32; 2], side: u32) -> RgbImage {
        RgbImage::from_fn(size, size, |x, y| {
            let within = (at[0]..at[0] + side).contains(&x) && (at[1]..at[1] + side).contains(&y);
            // A ground that is nowhere quite the same.
            Rgb(if within { [200; 3] } else { [90 + (x % 20) as u8, 80 + (y % 20) as u8, 70] })
        })
    }

    #[test]
    fn only_what_stands_in_the_middle_is_seen() {
        let empty = with_block(100, [0, 0], 0);
        assert_eq!(share_apart(&empty, &empty), 0.0);
        assert_eq!(share_apart(&empty, &with_block(100, [40, 40], 10)), 100.0 / 2500.0);
        assert_eq!(share_apart(&empty, &with_block(100, [0, 0], 20)), 0.0, "a panel at the side");
        let mut grain = empty.clone();
        grain.pixels_mut().for_each(|pixel| pixel.0[0] += APART);
        assert_eq!(share_apart(&empty, &grain), 0.0, "grain is no plant");
    }

    #[test]
    fn a_picture_without_its_plant_does_not_pass_as_one_with_it() {
        let image =
            |picture: RgbImage| Image::from_dynamic(picture.into(), true, RenderAssetUsages::default());
        let empty = image(with_block(100, [0, 0], 0));
        assert!(!differ(&empty, &empty));
        assert!(!differ(&empty, &image(with_block(100, [50, 50], 4))));
        assert!(differ(&empty, &image(with_block(100, [50, 50], 6))));
    }
}
