//! What the pointer does in the scene: chooses, cuts, sets, drags.

use bevy::gizmos::transform_gizmo::TransformGizmoState;
use bevy::prelude::*;
use bevy_panorbit_camera::PanOrbitCamera;

use super::act::Action;
use super::panels::Room;
use super::pick::{hit_ball, pick_organ, pick_solid};
use super::scene::Thing;
use super::state::{Chosen, Doomed, Shown, Tool};
use crate::environment::{Lamp, Solid, StandingSolid};
use crate::scenario::{Edit, borne_by, crushed_by};

/// Pixels the pointer may move between press and release of a click.
const CLICK: f32 = 5.0;

/// Follows the pointer.
pub(super) fn point(
    windows: Query<&Window>,
    cameras: Query<(&Camera, &GlobalTransform), With<PanOrbitCamera>>,
    room: Res<Room>,
    gizmo: Res<TransformGizmoState>,
    buttons: Res<ButtonInput<MouseButton>>,
    tool: Res<Tool>,
    shown: Res<Shown>,
    things: Query<(&Thing, &Transform, Option<&Solid>, Option<&Lamp>)>,
    mut doomed: ResMut<Doomed>,
    mut pressed: Local<Option<Vec2>>,
    mut last: Local<Option<Vec2>>,
    mut actions: MessageWriter<Action>,
) {
    let (Ok(window), Ok((camera, eye)), Some(view)) = (windows.single(), cameras.single(), &shown.view)
    else {
        return;
    };
    let Some(cursor) = window.cursor_position() else { return };
    if gizmo.active || gizmo.hovered_axis.is_some() || !room.pointer_is_free() {
        *pressed = None;
        return;
    }
    let Ok(ray) = camera.viewport_to_world(eye, cursor) else { return };
    if buttons.just_pressed(MouseButton::Left) {
        *pressed = Some(cursor);
    }
    let clicked = buttons.just_released(MouseButton::Left)
        && pressed.take().is_some_and(|from| from.distance(cursor) < CLICK);
    let nearest_thing = || {
        let hits = things.iter().filter_map(|(thing, place, solid, lamp)| {
            let from = ray.origin - place.translation;
            let hit = match (solid, lamp) {
                (Some(solid), _) => pick_solid(solid.shape, place, ray),
                (_, Some(lamp)) => hit_ball(from, *ray.direction, lamp.radius.max(0.15)),
                _ => None,
            };
            hit.map(|distance| (thing.0.clone(), distance))
        });
        hits.min_by(|a, b| a.1.total_cmp(&b.1))
    };
    match *tool {
        Tool::Prune => {
            if *last != Some(cursor) && !buttons.pressed(MouseButton::Left) {
                doomed.0 = pick_organ(&view.shot, ray)
                    .map(|(birth, _)| borne_by(&view.shot, birth))
                    .unwrap_or_default();
            }
            if clicked && let Some((birth, _)) = pick_organ(&view.shot, ray) {
                actions.write(Action::Prune(birth));
                doomed.0.clear();
            }
        }
        Tool::Choose if clicked => {
            let organ = pick_organ(&view.shot, ray);
            let chosen = match (nearest_thing(), organ) {
                (Some((name, near)), Some((birth, far))) => {
                    if near < far {
                        Chosen::Thing(name)
                    } else {
                        Chosen::Organ(birth)
                    }
                }
                (Some((name, _)), None) => Chosen::Thing(name),
                (None, Some((birth, _))) => Chosen::Organ(birth),
                (None, None) => Chosen::Nothing,
            };
            actions.write(Action::Choose(chosen));
        }
        Tool::Place(kind) if clicked => {
            let down = -ray.direction.y;
            if down > 1e-3 {
                let at = ray.get_point(ray.origin.y / down);
                // Metres away from everything nobody would find it again.
                if at.length() < 200.0 {
                    actions.write(Action::Place(kind, at));
                }
            }
        }
        _ => {}
    }
    *last = Some(cursor);
}

/// What the gizmo holds: shows what would be shed while it moves, and makes the edit when it is let go.
pub(super) fn drag(
    gizmo: Res<TransformGizmoState>,
    shown: Res<Shown>,
    things: Query<(&Thing, &Transform, Option<&Solid>)>,
    mut doomed: ResMut<Doomed>,
    mut held: Local<Option<(Entity, Transform)>>,
    mut actions: MessageWriter<Action>,
) {
    let Some(view) = &shown.view else { return };
    if gizmo.active {
        let Some(entity) = gizmo.entity else { return };
        let Ok((_, place, solid)) = things.get(entity) else { return };
        if held.is_some_and(|(_, last)| last == *place) {
            return;
        }
        *held = Some((entity, *place));
        if let Some(solid) = solid {
            let standing = StandingSolid {
                shape: solid.shape.scaled(place.scale),
                position: place.translation,
                rotation: place.rotation,
                color: solid.color,
            };
            doomed.0 = crushed_by(&view.shot, &standing);
        }
    } else if let Some((entity, place)) = held.take() {
        doomed.0.clear();
        let Ok((thing, _, solid)) = things.get(entity) else { return };
        if place == gizmo.start_transform {
            return;
        }
        let mut to = place.translation;
        if let Some(solid) = solid {
            to.y = to.y.max(snapped(solid, &place));
        }
        let (y, x, z) = place.rotation.to_euler(EulerRot::YXZ);
        let rotation_deg = Vec3::new(x, y, z).map(f32::to_degrees);
        let scale = place.scale.clamp(Vec3::splat(0.01), Vec3::splat(100.0));
        actions.write(Action::Edit(Edit::Pose { name: thing.0.clone(), to, rotation_deg, scale }));
    }
}

/// Height at which a solid stands on the ground, if it is nearly there.
fn snapped(solid: &Solid, place: &Transform) -> f32 {
    let half = solid.shape.scaled(place.scale).half_size().y;
    if (place.translation.y - half).abs() < 0.15 { half } else { f32::NEG_INFINITY }
}
