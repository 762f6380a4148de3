//! Opens the window.

use std::panic::{self, AssertUnwindSafe};
use std::path::PathBuf;
use std::time::Duration;

use bevy::app::AppExit;
use bevy::gizmos::transform_gizmo::TransformGizmoPlugin;
use bevy::prelude::*;
use bevy::render::error_handler::{RenderErrorHandler, RenderErrorPolicy};
use bevy::render::settings::WgpuSettings;
use bevy::tasks::block_on;
use bevy::window::{ExitCondition, PresentMode, WindowResolution};
use bevy_egui::{EguiPlugin, EguiPrimaryContextPass};
use bevy_panorbit_camera::{PanOrbitCameraPlugin, PanOrbitCameraSystemSet};

use super::act::OwnLibrary;
use super::camera::{self, Framing};
use super::files::{self, Files};
use super::panels::{self, Panels, Room};
use super::picture::{self, PictureFailure, PictureThen};
use super::sessions::Recent;
use super::state::{Course, Shown, Toasts};
use super::why::inspector::InspectorPlugin;
use super::{InterfaceSize, ViewerLogic, keys, pointer, scene};
use crate::assets::Library;
use crate::environment::workers::Workers;
use crate::files::{ResolvedScenario, SaveError};
use crate::limits::GrowthLimits;
use crate::render::compiling::Compiling;
use crate::render::evidence;
use crate::render::{PlantRenderPlugin, SceneryPlugin};
use crate::scenario::{Ending, Gardener, GardenerSettings, Sessions, Timeline, TimelineError};

/// What the window opens on.
#[derive(Debug)]
pub struct WatchSettings {
    /// What grows.
    pub resolved: ResolvedScenario,
    /// Seed of every random draw.
    pub seed: u64,
    /// Species and scenarios to choose from.
    pub library: Library,
    /// Threads that sense.
    pub workers: Workers,
    /// What a garden may take.
    pub limits: GrowthLimits,
    /// Steps a second; `None`: as many as can be.
    pub pace: Option<f32>,
    /// Size of the window, logical pixels.
    pub size: (u32, u32),
    /// Whether the panels are open.
    pub panels: bool,
    /// Where a picture of the window goes before it closes; what is there is replaced.
    pub screenshot: Option<PathBuf>,
    /// The step growth stops at, and after which the window closes.
    pub exit_after: Option<u32>,
    /// Whether a picture that shows no plants is an error.
    pub must_show_plants: bool,
}

/// Why there is no window, or what went wrong as it closed.
#[derive(Debug, thiserror::Error)]
pub enum WatchError {
    /// Nowhere to open one.
    #[error("there is no display to open a window on; `burgeon grow` grows without one")]
    NoDisplay,
    /// Nothing to draw it with.
    #[error(
        "there is no graphics adapter that can draw; install a Vulkan driver (mesa-vulkan-drivers draws in software)"
    )]
    NoAdapter,
    /// The graphics device was lost.
    #[error("the graphics device was lost{0}")]
    Lost(Grown),
    /// What has grown last could not be saved.
    #[error("what has grown could not be saved: {0}")]
    Unsaved(SaveError),
    /// The picture asked for could not be written, or does not show what it was to show.
    #[error("{0}")]
    Picture(String),
    /// The scenario cannot begin.
    #[error(transparent)]
    Timeline(#[from] TimelineError),
    /// The system gives no thread.
    #[error("no thread to grow on: {0}")]
    Thread(#[from] std::io::Error),
}

/// What became of the garden when its window was lost.
#[derive(Debug)]
pub enum Grown {
    /// It is in this file.
    Saved(PathBuf),
    /// There was nothing to save, or nobody's session.
    Nothing,
    /// It could not be saved.
    Unsaved(SaveError),
}

impl core::fmt::Display for Grown {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Saved(file) => write!(f, "; what has grown is in {}", file.display()),
            Self::Nothing => Ok(()),
            Self::Unsaved(why) => write!(f, "; what has grown could not be saved: {why}"),
        }
    }
}

/// Exit code of the app after its device was lost.
const LOST: u8 = 6;
/// Time between autosaves at least.
const AUTOSAVE: Duration = Duration::from_secs(20);

/// Opens the window and returns when it is closed. What has grown is saved then, and now and then before.
///
/// # Errors
/// [`WatchError`]; no window was open, its device was lost, or what has grown could not be saved.
pub fn watch(settings: WatchSettings) -> Result<(), WatchError> {
    if !has_display() {
        return Err(WatchError::NoDisplay);
    }
    if !has_adapter() {
        return Err(WatchError::NoAdapter);
    }
    let own = state_folder();
    let scenario = settings.resolved.scenario.name.clone();
    let mut timeline =
        Timeline::new(settings.resolved, settings.seed, settings.library.clone(), settings.workers)?;
    timeline.set_limits(settings.limits);
    // A window that closes by itself is nobody's session.
    let session = settings.exit_after.is_none();
    let sessions = session.then(|| Sessions::new(own.join("sessions")));
    let unkept = sessions.as_ref().and_then(|sessions| {
        let folder = sessions.folder();
        let why = std::fs::create_dir_all(folder).err()?;
        Some(format!("nothing can be saved by itself: {}: {why}", folder.display()))
    });
    let begin = GardenerSettings {
        playing: settings.exit_after != Some(0),
        pace: settings.pace,
        until: settings.exit_after,
        autosave: sessions.as_ref().map(|sessions| (sessions.begin(), AUTOSAVE)),
    };
    let gardener = Gardener::start(timeline, begin)?;
    let ending = gardener.ending();
    let failure: PictureFailure = default();
    let hint = session && first_time(&own);
    let folder = std::env::current_dir().unwrap_or_default();

    let opened = panic::catch_unwind(AssertUnwindSafe(|| {
        let mut app = App::new();
        let window = Window {
            title: "Burgeon".into(),
            name: Some("burgeon".into()),
            resolution: WindowResolution::new(settings.size.0, settings.size.1),
            present_mode: PresentMode::AutoVsync,
            ..default()
        };
        app.add_plugins(DefaultPlugins.set(WindowPlugin {
            primary_window: Some(window),
            exit_condition: ExitCondition::OnPrimaryClosed,
            ..default()
        }));
        let library = settings.library.clone();
        app.add_plugins(ViewerWindow { library, scenario, panels: settings.panels, hint, folder })
            .insert_resource(RenderErrorHandler(lost))
            .insert_resource(if session { InterfaceSize::kept_in(&own) } else { default() })
            .insert_resource(gardener);
        if let Some(sessions) = sessions {
            app.insert_resource(Recent::new(sessions));
        }
        if let Some(unkept) = unkept {
            app.world_mut().resource_mut::<Toasts>().warn(unkept);
        }
        if let Some(step) = settings.exit_after {
            Compiling::watch(&mut app);
            let must_show_plants = settings.must_show_plants;
            app.insert_resource(PictureThen { file: settings.screenshot.clone(), step, must_show_plants })
                .insert_resource(failure.clone());
        }
        app.run()
    }));
    // The app has taken the gardener along; its last save must not be cut short.
    let saved = ending.map_or(Ok(None), Ending::wait);
    match opened {
        Ok(AppExit::Error(code)) if code.get() == LOST => Err(WatchError::Lost(match saved {
            Ok(Some(file)) => Grown::Saved(file),
            Ok(None) => Grown::Nothing,
            Err(why) => Grown::Unsaved(why),
        })),
        Ok(_) => {
            saved.map_err(WatchError::Unsaved)?;
            failure.take().map_or(Ok(()), |why| Err(WatchError::Picture(why)))
        }
        Err(panic) => {
            let why = panic.downcast_ref::<String>().map(String::as_str);
            let why = why.or(panic.downcast_ref::<&str>().copied()).unwrap_or_default();
            if why.contains("GPU") || why.contains("adapter") {
                return Err(WatchError::NoAdapter);
            }
            if why.contains("EventLoop") || why.contains("event loop") {
                return Err(WatchError::NoDisplay);
            }
            panic::resume_unwind(panic)
        }
    }
}

/// All of the window but the window itself: what is drawn in it and how it answers. The host adds Bevy's default
/// plugins before it and inserts the [`Gardener`].
#[derive(Debug, Clone)]
pub struct ViewerWindow {
    /// Species and scenarios to choose from.
    pub library: Library,
    /// Name of the scenario that grows.
    pub scenario: String,
    /// Whether the panels at the sides are open.
    pub panels: bool,
    /// Whether the hint for the first time is shown.
    pub hint: bool,
    /// Where files are opened and saved at first.
    pub folder: PathBuf,
}

impl Plugin for ViewerWindow {
    fn build(&self, app: &mut App) {
        app.add_plugins((EguiPlugin::default(), PanOrbitCameraPlugin, TransformGizmoPlugin))
            .add_plugins((PlantRenderPlugin, SceneryPlugin, ViewerLogic, InspectorPlugin))
            .insert_resource(OwnLibrary(self.library.clone()))
            .insert_resource(Panels::new(self.panels, self.hint))
            .insert_resource(Files::new(self.folder.clone()))
            .init_resource::<Framing>()
            .init_resource::<InterfaceSize>()
            .init_resource::<Room>()
            .add_systems(PreStartup, camera::spawn_camera)
            .add_systems(EguiPrimaryContextPass, panels::draw)
            .add_systems(
                PreUpdate,
                (keys::keys, files::dropped, pointer::point).after(bevy::input::InputSystems),
            )
            .add_systems(
                Update,
                (
                    scene::show_things,
                    scene::show_plants,
                    scene::mark,
                    scene::focus_gizmo,
                    pointer::drag,
                    camera::join_overlays,
                    camera::frame,
                    files::ask,
                    picture::pictures,
                    picture::picture_then_exit,
                    evidence::gather,
                    picture::look_at_picture_then_exit,
                )
                    .chain()
                    .after(super::follow::follow),
            )
            .add_systems(
                PostUpdate,
                (
                    camera::gate.before(PanOrbitCameraSystemSet),
                    // After the gizmo has moved what it holds, and before anybody looks where that is.
                    pointer::settle
                        .in_set(TransformSystems::Propagate)
                        .before(bevy::transform::systems::mark_dirty_trees),
                ),
            );
        app.world_mut().resource_mut::<Course>().scenario.clone_from(&self.scenario);
        app.world_mut().resource_mut::<Shown>().live = true;
    }
}

/// What to do when the graphics device fails: stop drawing, end, and have the garden saved on the way.
fn lost(
    error: &bevy::render::error_handler::RenderError,
    world: &mut World,
    _: &mut World,
) -> RenderErrorPolicy {
    error!("the graphics device failed: {}", error.description);
    world.write_message(AppExit::from_code(LOST));
    RenderErrorPolicy::StopRendering
}

/// Whether there is an adapter: the renderer would panic without one, after a good deal of talk.
fn has_adapter() -> bool {
    let settings = WgpuSettings::default();
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: settings.backends.unwrap_or_default(),
        flags: settings.instance_flags,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())).is_ok()
}

/// Where what the window keeps for itself is.
fn state_folder() -> PathBuf {
    let set = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let home = std::env::home_dir().unwrap_or_default();
    if cfg!(windows) {
        set("LOCALAPPDATA").unwrap_or(home).join("Burgeon")
    } else if cfg!(target_os = "macos") {
        home.join("Library/Application Support/Burgeon")
    } else {
        set("XDG_STATE_HOME").unwrap_or_else(|| home.join(".local/state")).join("burgeon")
    }
}

/// Whether the window has never been open before; the next time it has.
fn first_time(folder: &std::path::Path) -> bool {
    let mark = folder.join("hint-seen");
    !mark.exists() && std::fs::write(mark, "").is_ok()
}

/// Whether there is a display: a window library would panic without one.
fn has_display() -> bool {
    if !cfg!(all(unix, not(target_os = "macos"))) {
        return true;
    }
    wayland().is_some() || x11().is_some()
}

#[cfg(unix)]
fn connects(path: impl AsRef<std::path::Path>) -> Option<()> {
    std::os::unix::net::UnixStream::connect(path).ok().map(drop)
}

#[cfg(not(unix))]
fn connects(_: impl AsRef<std::path::Path>) -> Option<()> {
    None
}

fn wayland() -> Option<()> {
    let name = PathBuf::from(std::env::var_os("WAYLAND_DISPLAY").filter(|name| !name.is_empty())?);
    if name.is_absolute() {
        return connects(name);
    }
    connects(PathBuf::from(std::env::var_os("XDG_RUNTIME_DIR")?).join(name))
}

fn x11() -> Option<()> {
    let display = std::env::var("DISPLAY").ok().filter(|display| !display.is_empty())?;
    let (host, number) = display.rsplit_once(':')?;
    let number = number.split('.').next()?;
    if host.is_empty() || host == "unix" {
        let path = format!("/tmp/.X11-unix/X{number}");
        #[cfg(target_os = "linux")]
        if connects_abstract(&path).is_some() {
            return Some(());
        }
        return connects(path);
    }
    // Over a network: what answers there is found out by opening it.
    Some(())
}

#[cfg(target_os = "linux")]
fn connects_abstract(name: &str) -> Option<()> {
    use std::os::linux::net::SocketAddrExt;
    let address = std::os::unix::net::SocketAddr::from_abstract_name(name).ok()?;
    std::os::unix::net::UnixStream::connect_addr(&address).ok().map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_window_tells_what_became_of_the_garden() {
        let told = |grown| WatchError::Lost(grown).to_string();
        assert_eq!(told(Grown::Nothing), "the graphics device was lost");
        let saved = told(Grown::Saved("dusk-1-1.burgeon".into()));
        assert!(saved.ends_with("what has grown is in dusk-1-1.burgeon"), "{saved}");
        let source = std::io::Error::other("the disk is full");
        let unsaved = told(Grown::Unsaved(SaveError::Io { file: "dusk-1-1.burgeon".into(), source }));
        assert!(unsaved.ends_with("could not be saved: dusk-1-1.burgeon: the disk is full"), "{unsaved}");
    }
}
