//! The camera: keeps the plants in the picture until a user takes it.

use bevy::camera::Hdr;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::gizmos::transform_gizmo::{TransformGizmoCamera, TransformGizmoFocus, TransformGizmoState};
use bevy::input::mouse::{AccumulatedMouseMotion, AccumulatedMouseScroll};
use bevy::prelude::*;
use bevy_egui::{EguiGlobalSettings, PrimaryEguiContext};
use bevy_panorbit_camera::{PanOrbitCamera, TrackpadBehavior};

use super::act::Action;
use super::panels::Room;
use super::state::{Shown, ViewFrom};
use crate::plant::Snapshot;
use crate::render::OutdoorCamera;

/// Whether the camera keeps the plants in the picture.
#[derive(Resource, Debug)]
pub(super) struct Framing {
    follows: bool,
    /// Jump there, do not glide.
    at_once: bool,
}

impl Default for Framing {
    fn default() -> Self {
        Self { follows: true, at_once: true }
    }
}

/// Opening of the camera, radians from bottom to top.
const FOV: f32 = 0.7;

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
            yaw: Some(0.45),
            target_yaw: 0.45,
            pitch: Some(0.16),
            target_pitch: 0.16,
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

/// Box around the plants of a snapshot; a seed's is a metre high.
fn bounds(shot: &Snapshot) -> (Vec3, Vec3) {
    let mut low = Vec3::new(-0.4, 0.0, -0.4);
    let mut high = Vec3::new(0.4, 1.0, 0.4);
    if let Some(first) = shot.plants.iter().flatten().next() {
        low += first.position;
        high += first.position;
    }
    for plant in shot.plants.iter().flatten() {
        (low, high) = (low.min(plant.position), high.max(plant.position));
    }
    for pose in &shot.pose {
        (low, high) = (low.min(pose.position), high.max(pose.position));
    }
    (low, high)
}

/// Brings the plants into the part of the window that no panel covers.
pub(super) fn frame(
    mut actions: MessageReader<Action>,
    shown: Res<Shown>,
    room: Res<Room>,
    windows: Query<&Window>,
    mut framing: ResMut<Framing>,
    mut cameras: Query<(&mut PanOrbitCamera, &Transform)>,
) {
    let Ok((mut camera, at)) = cameras.single_mut() else { return };
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
    if !framing.follows {
        return;
    }
    let (low, high) = bounds(&view.shot);
    let whole = Vec2::new(window.width().max(1.0), window.height().max(1.0));
    let free = (whole - room.beside()).max(0.3 * whole);
    let tan = bevy::math::ops::tan(0.5 * FOV);
    let size = high - low;
    let tall = 0.5 * size.y * 1.35 / (tan * free.y / whole.y);
    let wide = 0.5 * size.x.max(size.z) * 1.2 / (tan * free.x / whole.y);
    let radius = tall.max(wide).max(2.2) + 0.5 * size.x.max(size.z);
    // The middle of the free part is not the middle of the window.
    let metres = 2.0 * tan * radius / whole.y;
    let shift = room.off_centre() * metres;
    let focus = 0.5 * (low + high) + Vec3::Y * 0.08 * size.y - at.right() * shift.x + Vec3::Y * shift.y;
    camera.target_focus = focus;
    camera.target_radius = radius;
    if framing.at_once {
        framing.at_once = false;
        (camera.focus, camera.radius) = (focus, Some(radius));
    }
    camera.force_update = true;
}
