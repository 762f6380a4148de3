//! What the pointer does in the scene: chooses, cuts, sets, drags.

use bevy::gizmos::transform_gizmo::TransformGizmoState;
use bevy::prelude::*;
use bevy_panorbit_camera::PanOrbitCamera;

use super::act::Action;
use super::ground::settled;
use super::panels::Room;
use super::pick::{hit_ball, pick_organ, pick_solid};
use super::scene::Thing;
use super::state::{Chosen, Doomed, Shown, Snapping, Tool};
use crate::environment::{Ground, Lamp, Solid, SolidShape, StandingSolid};
use crate::render::SeenThrough;
use crate::scenario::{borne_by, crushed_by};

/// Pixels the pointer may move between press and release of a click.
const CLICK: f32 = 5.0;

/// Follows the pointer.
pub(super) fn point(
    windows: Query<&Window>,
    cameras: Query<(&Camera, &GlobalTransform), With<PanOrbitCamera>>,
    room: Res<Room>,
    gizmo: Res<TransformGizmoState>,
    buttons: Res<ButtonInput<MouseButton>>,
    keys: Res<ButtonInput<KeyCode>>,
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
            let whole = keys.any_pressed([KeyCode::ShiftLeft, KeyCode::ShiftRight]);
            let plant = |birth| view.shot.index_of(birth).map(|i| view.shot.plant[i]);
            let organ_or_plant = |birth| match plant(birth) {
                Some(plant) if whole => Chosen::Plant(plant),
                _ => Chosen::Organ(birth),
            };
            let chosen = match (nearest_thing(), organ) {
                (Some((name, near)), Some((birth, far))) => {
                    if near < far {
                        Chosen::Thing(name)
                    } else {
                        organ_or_plant(birth)
                    }
                }
                (Some((name, _)), None) => Chosen::Thing(name),
                (None, Some((birth, _))) => organ_or_plant(birth),
                (None, None) => Chosen::Nothing,
            };
            actions.write(Action::Choose(chosen));
        }
        Tool::Place(kind) if clicked => {
            actions.write_batch(on_ground(ray).map(|at| Action::Place(kind, at)));
        }
        Tool::Resow(plant) if clicked => {
            actions.write_batch(on_ground(ray).map(|at| Action::Resow(plant, at)));
        }
        _ => {}
    }
    *last = Some(cursor);
}

/// Where a ray meets the ground, as far as one would find again what is set there.
fn on_ground(ray: Ray3d) -> Option<Vec3> {
    let down = -ray.direction.y;
    let at = (down > 1e-3).then(|| ray.get_point(ray.origin.y / down))?;
    (at.length() < 200.0).then_some(at)
}

/// Whether things are set down on the ground now.
fn snaps(snapping: Snapping, keys: &ButtonInput<KeyCode>) -> bool {
    use KeyCode::{AltLeft, AltRight, ControlLeft, ControlRight};
    snapping.0 && !keys.any_pressed([AltLeft, AltRight, ControlLeft, ControlRight])
}

/// Shows what the gizmo holds as it would stand if it were let go of now.
pub(super) fn settle(
    gizmo: Res<TransformGizmoState>,
    snapping: Res<Snapping>,
    keys: Res<ButtonInput<KeyCode>>,
    ground: Res<Ground>,
    mut things: Query<(&mut Transform, Option<&Solid>, Option<&Lamp>), With<Thing>>,
) {
    let (Some(entity), Some(ground)) = (gizmo.entity.filter(|_| gizmo.active), ground.0) else { return };
    let Ok((mut place, solid, lamp)) = things.get_mut(entity) else { return };
    let lamp = lamp.map(|lamp| SolidShape::Ball { radius: lamp.radius });
    let Some(shape) = solid.map(|solid| solid.shape).or(lamp).filter(|_| snaps(*snapping, &keys)) else {
        return;
    };
    let y = settled(shape, &place, ground);
    if place.translation.y != y {
        place.translation.y = y;
    }
}

/// What the gizmo holds: shows what would be shed while it moves, and makes the edit when it is let go.
pub(super) fn drag(
    mut commands: Commands,
    gizmo: Res<TransformGizmoState>,
    shown: Res<Shown>,
    things: Query<(&Thing, &Transform, Option<&Solid>)>,
    snapping: Res<Snapping>,
    keys: Res<ButtonInput<KeyCode>>,
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
            // What it would crush is inside it.
            commands.entity(entity).try_insert(SeenThrough(!doomed.0.is_empty()));
        }
    } else if let Some((entity, place)) = held.take() {
        doomed.0.clear();
        let Ok((thing, ..)) = things.get(entity) else { return };
        commands.entity(entity).try_insert(SeenThrough(false));
        if place == gizmo.start_transform {
            return;
        }
        let snap = snaps(*snapping, &keys);
        actions.write(Action::Drop { name: thing.0.clone(), place, snap });
    }
}
