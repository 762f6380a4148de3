//! Pictures of the window, on request and for checks.

use std::path::PathBuf;

use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};

use super::act::Action;
use super::scene::Growing;
use super::state::{Past, Shown};
use crate::render::{Stage, StepFraction};

/// Takes a picture once a step is on screen, then ends the program.
#[derive(Resource, Debug, Clone)]
pub(super) struct PictureThen {
    pub file: Option<PathBuf>,
    pub step: u32,
}

/// Frames that everything has to have been ready for.
const CALM: u32 = 4;
/// Frames from the start until shaders are surely compiled.
const WARM: u32 = 60;

/// Ends the program when its picture is taken.
pub(super) fn picture_then_exit(
    mut commands: Commands,
    wanted: Option<Res<PictureThen>>,
    shown: Res<Shown>,
    plants: Query<(&Stage, &StepFraction), With<Growing>>,
    mut calm: Local<u32>,
    mut frames: Local<u32>,
    mut actions: MessageWriter<Action>,
    mut exit: MessageWriter<AppExit>,
) {
    let Some(wanted) = wanted else { return };
    let reached = shown.view.as_ref().is_some_and(|view| view.step >= wanted.step);
    if reached && *calm == 0 {
        actions.write(Action::Play(false));
    }
    let ready = plants.iter().all(|(stage, fraction)| stage.is_settled() && fraction.0 >= 1.0);
    *frames += 1;
    if reached && ready && !plants.is_empty() && *frames > WARM {
        *calm += 1;
    }
    if *calm == CALM {
        match &wanted.file {
            Some(file) => {
                commands.spawn(Screenshot::primary_window()).observe(save_to_disk(file.clone())).observe(
                    |_: On<ScreenshotCaptured>, mut exit: MessageWriter<AppExit>| {
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
pub(super) fn pictures(
    mut commands: Commands,
    mut actions: MessageReader<Action>,
    past: Res<Past>,
    mut toasts: ResMut<super::state::Toasts>,
) {
    for action in actions.read() {
        if let Action::Picture(file) = action {
            toasts.tell(format!("picture: {}", file.display()));
            commands.spawn(Screenshot::primary_window()).observe(save_to_disk(file.clone()));
        }
    }
    let _ = past;
}
