//! Pictures without a window, and a picture of a window's first frames: for films, tests and servers.

use std::path::PathBuf;
use std::time::Duration;

use bevy::asset::RenderAssetUsages;
use bevy::camera::RenderTarget;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured, save_to_disk};
use bevy::time::TimeUpdateStrategy;
use bevy::window::{ExitCondition, WindowPlugin};

use super::compiling::Compiling;
use super::evidence::{self, Evidence};

/// Frames a picture may take to arrive.
const PATIENCE: u32 = 200;

/// An app with Bevy's default plugins that draws without a window, every frame a thirtieth of a second.
///
/// It panics where there is no adapter at all, not even in software.
pub fn offscreen_app() -> App {
    let plugins = DefaultPlugins
        .build()
        .set(WindowPlugin { primary_window: None, exit_condition: ExitCondition::DontExit, ..default() })
        .set(RenderPlugin { synchronous_pipeline_compilation: true, ..default() })
        .disable::<PipelinedRenderingPlugin>();
    #[cfg(feature = "viewer")]
    let plugins = plugins.disable::<bevy::winit::WinitPlugin>();
    let mut app = App::new();
    app.add_plugins(plugins)
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 30.0)))
        .init_resource::<LastPicture>();
    app
}

/// An image for a camera to draw into, pixels; give it to the camera as its [`RenderTarget`].
pub fn offscreen_target(
    images: &mut Assets<Image>,
    width: u32,
    height: u32,
) -> (Handle<Image>, RenderTarget) {
    let mut image =
        Image::new_target_texture(width.max(1), height.max(1), TextureFormat::Rgba8UnormSrgb, None);
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    image.asset_usage = RenderAssetUsages::default();
    let handle = images.add(image);
    (handle.clone(), RenderTarget::Image(handle.into()))
}

/// The last picture that arrived.
#[derive(Resource, Default)]
struct LastPicture(Option<Image>);

/// Updates an [`offscreen_app`] until a picture of its target has arrived; `None` if none does.
pub fn take_picture(app: &mut App, target: &Handle<Image>) -> Option<Image> {
    app.world_mut().resource_mut::<LastPicture>().0 = None;
    app.world_mut().spawn(Screenshot::image(target.clone())).observe(
        |captured: On<ScreenshotCaptured>, mut last: ResMut<LastPicture>| {
            last.0 = Some(captured.event().image.clone());
        },
    );
    for _ in 0..PATIENCE {
        app.update();
        if let Some(picture) = app.world_mut().resource_mut::<LastPicture>().0.take() {
            return Some(picture);
        }
    }
    None
}

/// Takes a picture of the primary window after some frames, once no shader is being compiled, then ends the app: how
/// examples are tried. A picture that shows no plants is an error.
pub struct PictureAndExit {
    /// Where the PNG goes.
    pub file: PathBuf,
    /// Frames to wait.
    pub frames: u32,
}

impl PictureAndExit {
    /// From `--screenshot FILE` and `--frames N` (300 if not given) among the program's arguments; `None` without
    /// a file.
    pub fn from_arguments() -> Option<Self> {
        let arguments: Vec<String> = std::env::args().collect();
        let value = |name: &str| {
            let at = arguments.iter().position(|a| a == name)?;
            arguments.get(at + 1).cloned()
        };
        let frames = value("--frames").and_then(|n| n.parse().ok()).unwrap_or(300);
        Some(Self { file: value("--screenshot")?.into(), frames })
    }
}

#[derive(Resource)]
struct Countdown {
    file: PathBuf,
    frames: u32,
    /// Frames that shaders may still take.
    patience: u32,
    taken: bool,
}

impl Plugin for PictureAndExit {
    fn build(&self, app: &mut App) {
        Compiling::watch(app);
        let (file, frames) = (self.file.clone(), self.frames);
        app.insert_resource(Countdown { file, frames, patience: PATIENCE, taken: false })
            .add_systems(Update, (count_down, evidence::gather, end).chain());
    }
}

fn count_down(mut commands: Commands, mut countdown: ResMut<Countdown>, compiling: Res<Compiling>) {
    /// Frames in which what is compiled comes on screen.
    const AFTER: u32 = 5;
    countdown.frames = countdown.frames.saturating_sub(1);
    if compiling.is_under_way() && countdown.patience > 0 {
        countdown.patience -= 1;
        countdown.frames = countdown.frames.max(AFTER);
    }
    if countdown.frames == 0 && !countdown.taken {
        countdown.taken = true;
        commands.spawn(Screenshot::primary_window()).observe(save_to_disk(countdown.file.clone())).observe(
            |captured: On<ScreenshotCaptured>, mut commands: Commands| {
                commands.insert_resource(Evidence::of(captured.image.clone()));
            },
        );
    }
}

/// Ends the app once it is known what its picture shows.
fn end(evidence: Option<Res<Evidence>>, mut exit: MessageWriter<AppExit>) {
    match evidence.and_then(|evidence| evidence.shows()) {
        Some(true) => {
            exit.write(AppExit::Success);
        }
        Some(false) => {
            error!("no plant is to be seen in the picture");
            exit.write(AppExit::error());
        }
        None => {}
    }
}
