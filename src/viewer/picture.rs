//! Pictures of the window, on request and for checks.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};

use super::act::Action;
use super::scene::Growing;
use super::state::{Course, Shown, Toasts};
use crate::files::write_whole;
use crate::render::compiling::Compiling;
use crate::render::{Stage, StepFraction};

/// Takes a picture once a step is on screen, then ends the program.
#[derive(Resource, Debug, Clone)]
pub(super) struct PictureThen {
    pub file: Option<PathBuf>,
    pub step: u32,
}

/// Why the last picture before the end could not be written; outlives the app.
#[derive(Resource, Debug, Clone, Default)]
pub(super) struct PictureFailure(Arc<Mutex<Option<String>>>);

impl PictureFailure {
    /// The reason, if there is one.
    pub fn take(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn set(&self, why: String) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(why);
    }
}

/// Frames that everything has to have been ready for.
const CALM: u32 = 4;
/// Frames from the start in which textures may still be made, and shaders asked for.
const WARM: u32 = 30;
/// Frames from the start after which no shader is waited for any more.
const PATIENT: u32 = 200;

/// Ends the program when its picture is taken.
pub(super) fn picture_then_exit(
    mut commands: Commands,
    wanted: Option<Res<PictureThen>>,
    shown: Res<Shown>,
    course: Res<Course>,
    plants: Query<(&Stage, &StepFraction), With<Growing>>,
    compiling: Option<Res<Compiling>>,
    mut calm: Local<u32>,
    mut frames: Local<u32>,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(wanted) = wanted else { return };
    let reached = course.stopped || shown.view.as_ref().is_some_and(|view| view.step >= wanted.step);
    let ready = plants.iter().all(|(stage, fraction)| stage.is_settled() && fraction.0 >= 1.0);
    let compiled = compiling.is_none_or(|compiling| !compiling.is_under_way());
    *frames += 1;
    if reached && ready && !plants.is_empty() && *frames > if compiled { WARM } else { PATIENT } {
        *calm += 1;
    }
    if *calm == CALM {
        match wanted.file.clone() {
            Some(file) => {
                commands.spawn(Screenshot::primary_window()).observe(
                    move |captured: On<ScreenshotCaptured>,
                          failure: Res<PictureFailure>,
                          mut exit: MessageWriter<AppExit>| {
                        if let Err(why) = write_picture(&captured.image, &file) {
                            failure.set(why);
                        }
                        exit.write(AppExit::Success);
                    },
                );
            }
            None => {
                exit.write(AppExit::Success);
            }
        }
        *calm += 1;
    }
}

/// Saves a picture of the window.
pub(super) fn pictures(mut commands: Commands, mut actions: MessageReader<Action>) {
    for action in actions.read() {
        if let Action::Picture(file) = action {
            let file = file.clone();
            commands.spawn(Screenshot::primary_window()).observe(
                move |captured: On<ScreenshotCaptured>, mut toasts: ResMut<Toasts>| match write_picture(
                    &captured.image,
                    &file,
                ) {
                    Ok(()) => toasts.tell(format!("picture: {}", file.display())),
                    Err(why) => toasts.warn(why),
                },
            );
        }
    }
}

/// Writes a picture as PNG, whole or not at all; makes its folder. The error says what and why.
pub(super) fn write_picture(image: &Image, path: &Path) -> Result<(), String> {
    let failed = |why: String| format!("{}: {why}", path.display());
    let picture = image.clone().try_into_dynamic().map_err(|why| failed(why.to_string()))?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    let encoded = picture.to_rgb8().write_to(&mut bytes, image::ImageFormat::Png);
    encoded.map_err(|why| failed(why.to_string()))?;
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(|why| failed(why.to_string()))?;
    }
    write_whole(path, &[bytes.get_ref()]).map_err(|why| failed(why.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_goes_to_disk_or_an_error_says_why_not() {
        let folder = tempfile::tempdir().unwrap();
        let image = Image::new_fill(
            bevy::render::render_resource::Extent3d { width: 4, height: 3, depth_or_array_layers: 1 },
            bevy::render::render_resource::TextureDimension::D2,
            &[10, 20, 30, 255],
            bevy::render::render_resource::TextureFormat::Rgba8UnormSrgb,
            Default::default(),
        );
        write_picture(&image, &folder.path().join("new/a.png")).unwrap();
        std::fs::write(folder.path().join("taken"), "").unwrap();
        let why = write_picture(&image, &folder.path().join("taken/a.png")).unwrap_err();
        assert!(why.contains("taken/a.png"), "{why}");
    }
}
