//! The camera: keeps the plants in the picture until a user takes it.

use bevy::camera::Hdr;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gizmos::transform_gizmo::{TransformGizmoCamera, TransformGizmoFocus, TransformGizmoState};
use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll};
use bevy::prelude::*;
use bevy_egui::{EguiGlobalSettings, PrimaryEguiContext};
use bevy_panorbit_camera::{PanOrbitCamera, TrackpadBehavior};

use super::act::Action;
use super::framing::{Free, fit, sight, yaw};
use super::panels::Room;
use super::state::{Course, Shown, ViewFrom};
use super::why::split::Split;
use crate::render::OutdoorCamera;

/// Whether the camera keeps the plants in the picture.
#[derive(Resource, Debug)]
pub(super) struct Framing {
    follows: bool,
    /// Which garden has been looked at from its best side ([`Course::began`]).
    seen: Option<u64>,
}

impl Default for Framing {
    fn default() -> Self {
        Self { follows: true, seen: None }
    }
}

/// Opening of the camera, radians from bottom to top.
pub(super) const FOV: f32 = 0.7;
/// How far the camera looks down on a garden at first, radians.
pub(super) const PITCH: f32 = 0.16;

pub(super) fn spawn_camera(mut commands: Commands, mut egui: ResMut<EguiGlobalSettings>) {
    egui.auto_create_primary_context = false;
    commands.spawn((
        OutdoorCamera,
        PrimaryEguiContext,
        TransformGizmoCamera,
        Msaa::Off,
        bevy::anti_alias::fxaa::Fxaa::default(),
        Projection::Perspective(PerspectiveProjection { fov: FOV, far: 2000.0, ..default() }),
        Transform::from_xyz(0.0, 2.0, 8.0),
        PanOrbitCamera {
            focus: Vec3::Y,
            target_focus: Vec3::Y,
            radius: Some(8.0),
            target_radius: 8.0,
            pitch: Some(PITCH),
            target_pitch: PITCH,
            pitch_lower_limit: Some(-0.05),
            pitch_upper_limit: Some(1.55),
            zoom_lower_limit: 0.3,
            zoom_upper_limit: Some(120.0),
            orbit_smoothness: 0.5,
            zoom_smoothness: 0.6,
            trackpad_behavior: TrackpadBehavior::blender_default(),
            ..default()
        },
    ));
}

/// Has the camera that lays the gizmo over the scene draw into the same picture, and only while there is a gizmo.
pub(super) fn join_overlays(
    mut commands: Commands,
    focus: Query<(), With<TransformGizmoFocus>>,
    mut overlays: Query<(Entity, &mut Camera, Has<Hdr>), (With<Camera3d>, Without<OutdoorCamera>)>,
) {
    for (entity, mut camera, joined) in &mut overlays {
        if !joined {
            camera.clear_color = ClearColorConfig::None;
            commands.entity(entity).insert((Hdr, Msaa::Off, Tonemapping::None));
        }
        let wanted = !focus.is_empty();
        if camera.is_active != wanted {
            camera.is_active = wanted;
        }
    }
}

/// Lets the camera have the pointer only where nobody else wants it, and lets go of the plants once it was moved.
pub(super) fn gate(
    room: Res<Room>,
    gizmo: Res<TransformGizmoState>,
    buttons: Res<ButtonInput<MouseButton>>,
    moved: Res<AccumulatedMouseMotion>,
    scrolled: Res<AccumulatedMouseScroll>,
    mut framing: ResMut<Framing>,
    mut cameras: Query<&mut PanOrbitCamera>,
) {
    let free = room.pointer_is_free() && !gizmo.active && gizmo.hovered_axis.is_none();
    for mut camera in &mut cameras {
        // What was begun on the scene goes on over a panel.
        let held = camera.enabled && buttons.any_pressed([MouseButton::Left, MouseButton::Right]);
        let enabled = (free || held) && !gizmo.active;
        if camera.enabled != enabled {
            camera.enabled = enabled;
        }
        let dragged = held && moved.delta.length() > 1.5;
        if enabled && (dragged || scrolled.delta.length() > 0.0) {
            framing.follows = false;
        }
    }
}

/// Brings the plants and what is near them into the part of the window that no panel covers.
pub(super) fn frame(
    mut actions: MessageReader<Action>,
    shown: Res<Shown>,
    course: Res<Course>,
    room: Res<Room>,
    split: Res<Split>,
    windows: Query<&Window>,
    mut framing: ResMut<Framing>,
    mut cameras: Query<&mut PanOrbitCamera>,
) {
    let Ok(mut camera) = cameras.single_mut() else { return };
    for action in actions.read() {
        match action {
            Action::Frame => framing.follows = true,
            Action::From(from) => {
                (camera.target_yaw, camera.target_pitch) = match from {
                    ViewFrom::Front => (0.0, 0.05),
                    ViewFrom::Side => (0.5 * core::f32::consts::PI, 0.05),
                    ViewFrom::Top => (0.0, 1.55),
                };
                framing.follows = true;
            }
            action if action.begins_anew() => framing.follows = true,
            _ => {}
        }
    }
    let (Some(view), Ok(window)) = (&shown.view, windows.single()) else { return };
    if !room.is_known() {
        return;
    }
    let anew = framing.seen.replace(course.began) != Some(course.began);
    if !framing.follows {
        return;
    }
    if anew {
        let yaw = yaw(&view.shot, &view.standing, PITCH);
        (camera.yaw, camera.target_yaw) = (Some(yaw), yaw);
        (camera.pitch, camera.target_pitch) = (Some(PITCH), PITCH);
    }
    let free = Free::of(Vec2::new(window.width(), window.height()), room.margins(), FOV);
    let mut boxes = sight(&view.shot, &view.standing);
    // Both halves are seen alike, so each has to show what the other does.
    boxes.extend(split.view().iter().flat_map(|twin| sight(&twin.shot, &twin.standing)));
    let (focus, radius) = fit(&boxes, camera.target_yaw, camera.target_pitch, free);
    (camera.target_focus, camera.target_radius) = (focus, radius);
    if anew {
        (camera.focus, camera.radius) = (focus, Some(radius));
    }
    camera.force_update = true;
}
