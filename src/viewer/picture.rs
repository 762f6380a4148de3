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
use crate::render::evidence::Evidence;
use crate::render::{OutdoorCamera, Stage, StepFraction};

/// Takes a picture once a step is on screen, then ends the program.
#[derive(Resource, Debug, Clone)]
pub(super) struct PictureThen {
    pub file: Option<PathBuf>,
    pub step: u32,
    /// Whether it counts as a failure if the picture shows no plants.
    pub must_show_plants: bool,
}

/// What is wrong with the last picture before the end; outlives the app.
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
    cameras: Query<&Transform, With<OutdoorCamera>>,
    compiling: Option<Res<Compiling>>,
    mut calm: Local<u32>,
    mut frames: Local<u32>,
    mut from: Local<Option<Transform>>,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(wanted) = wanted else { return };
    let reached = course.stopped || shown.view.as_ref().is_some_and(|view| view.step >= wanted.step);
    let ready = plants.iter().all(|(stage, fraction)| stage.is_settled() && fraction.0 >= 1.0);
    let compiled = compiling.is_none_or(|compiling| !compiling.is_under_way());
    let eye = cameras.iter().next().copied();
    let still = core::mem::replace(&mut *from, eye).zip(eye).is_some_and(|(last, now)| stands(&last, &now));
    *frames += 1;
    let long_enough = *frames > if compiled && still { WARM } else { PATIENT };
    if reached && ready && !plants.is_empty() && long_enough {
        *calm += 1;
    }
    if *calm == CALM {
        match wanted.file.clone() {
            Some(file) => {
                let must_show_plants = wanted.must_show_plants;
                commands.spawn(Screenshot::primary_window()).observe(
                    move |captured: On<ScreenshotCaptured>,
                          failure: Res<PictureFailure>,
                          mut commands: Commands,
                          mut exit: MessageWriter<AppExit>| {
                        match write_picture(&captured.image, &file) {
                            Err(why) => failure.set(format!("the picture could not be written: {why}")),
                            Ok(()) if must_show_plants => {
                                commands.insert_resource(Evidence::of(captured.image.clone()));
                                return;
                            }
                            Ok(()) => {}
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

/// Whether a camera has moved by less than a picture shows.
fn stands(last: &Transform, now: &Transform) -> bool {
    last.translation.distance(now.translation) < 1e-3 && last.rotation.dot(now.rotation).abs() > 1.0 - 2e-7
}

/// Ends the program once it is known whether its picture shows plants.
pub(super) fn look_at_picture_then_exit(
    evidence: Option<Res<Evidence>>,
    wanted: Option<Res<PictureThen>>,
    failure: Option<Res<PictureFailure>>,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(shows) = evidence.and_then(|evidence| evidence.shows()) else { return };
    if let (false, Some(failure), Some(file)) =
        (shows, failure, wanted.and_then(|wanted| wanted.file.clone()))
    {
        failure.set(format!("no plant is to be seen in {}", file.display()));
    }
    exit.write(AppExit::Success);
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
