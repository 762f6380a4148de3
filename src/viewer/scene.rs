//! The picture: plants between two steps, and what stands around them.

use std::collections::HashMap;

use bevy::gizmos::transform_gizmo::{TransformGizmoFocus, TransformGizmoState};
use bevy::prelude::*;

use super::state::{Chosen, Course, Doomed, Shown};
use crate::environment::{Lamp, Solid, Sun};
use crate::render::{Drawn, Ghost, Look, Marks, StepFraction};
use crate::scenario::Fixtures;

/// The plants on screen.
#[derive(Component)]
pub(super) struct Growing;

/// The plants of the old course.
#[derive(Component)]
pub(super) struct OldCourse;

/// A solid or lamp on screen, by the name it has in the garden.
#[derive(Component)]
pub(super) struct Thing(pub String);

/// The sun on screen.
#[derive(Component)]
pub(super) struct TheSun;

/// Seconds a change takes that no beat times.
const CHANGE: f32 = 0.6;

/// Shows what has come on screen, and moves plants on between two steps.
pub(super) fn show_plants(
    mut commands: Commands,
    time: Res<Time<Real>>,
    shown: Res<Shown>,
    course: Res<Course>,
    mut drawn: Query<(&mut Drawn, &mut StepFraction, &mut Look), (With<Growing>, Without<OldCourse>)>,
    mut old: Query<(Entity, &mut Drawn), With<OldCourse>>,
    mut seen: Local<u64>,
    mut passed: Local<f32>,
) {
    let Some(view) = &shown.view else { return };
    let Ok((mut drawn, mut fraction, mut look)) = drawn.single_mut() else {
        commands.spawn((Growing, Drawn::still(view.shot.clone())));
        *seen = shown.arrival;
        return;
    };
    if *seen != shown.arrival {
        *seen = shown.arrival;
        if shown.grew {
            drawn.step_to(view.shot.clone());
            *passed = 0.0;
        } else {
            *drawn = Drawn::still(view.shot.clone());
            *passed = f32::INFINITY;
        }
    }
    let beat = course.progress.pace.filter(|_| course.progress.playing).map_or(CHANGE, |pace| 1.0 / pace);
    let (frame, beat) = (time.delta_secs(), beat.clamp(0.05, 4.0));
    *passed += frame;
    // So few frames are no movement: each shows the end of a step, not one in a hard winter.
    let few = frame * 4.0 > beat;
    fraction.set_if_neq(StepFraction(if few { 1.0 } else { (*passed / beat).min(1.0) }));
    let wanted = Look { overlay: shown.overlay, ghost: None };
    look.set_if_neq(wanted);
    match (&shown.ghost, old.single_mut()) {
        (Some(ghost), Ok((_, mut drawn))) => {
            if !std::sync::Arc::ptr_eq(&drawn.now, &ghost.shot) {
                *drawn = Drawn::still(ghost.shot.clone());
            }
        }
        (Some(ghost), Err(_)) => {
            let look = Look { overlay: None, ghost: Some(Ghost::default()) };
            commands.spawn((OldCourse, Drawn::still(ghost.shot.clone()), look));
        }
        (None, Ok((entity, _))) => commands.entity(entity).despawn(),
        (None, Err(_)) => {}
    }
}

/// Lights up what is chosen and what would go.
pub(super) fn mark(
    chosen: Res<Chosen>,
    doomed: Res<Doomed>,
    shown: Res<Shown>,
    mut marks: Query<&mut Marks, With<Growing>>,
) {
    if !(chosen.is_changed() || doomed.is_changed() || shown.is_changed()) {
        return;
    }
    let Ok(mut marks) = marks.single_mut() else { return };
    let chosen = match *chosen {
        Chosen::Organ(birth) => vec![birth],
        _ => Vec::new(),
    };
    marks.set_if_neq(Marks { hovered: Vec::new(), chosen, doomed: doomed.0.clone() });
}

/// Has on screen what stands in the garden: things keep their entities as long as they stand.
pub(super) fn show_things(
    mut commands: Commands,
    shown: Res<Shown>,
    gizmo: Res<TransformGizmoState>,
    mut things: Query<
        (Entity, &Thing, &mut Transform, Option<&mut Solid>, Option<&mut Lamp>),
        Without<TheSun>,
    >,
    suns: Query<Entity, With<TheSun>>,
    mut last: Local<Option<std::sync::Arc<Fixtures>>>,
) {
    let Some(view) = &shown.view else { return };
    if gizmo.active || last.as_ref().is_some_and(|last| std::sync::Arc::ptr_eq(last, &view.standing)) {
        return;
    }
    let standing = view.standing.clone();
    *last = Some(standing.clone());
    let mut here: HashMap<String, Entity> = HashMap::new();
    for (entity, thing, mut transform, solid, lamp) in &mut things {
        let as_solid = standing.solids.iter().find(|fixture| fixture.name == thing.0);
        let as_lamp = standing.lamps.iter().find(|fixture| fixture.name == thing.0);
        match (as_solid, as_lamp, solid, lamp) {
            (Some(fixture), _, Some(mut solid), _) => {
                transform.set_if_neq(fixture.transform());
                solid.set_if_neq(fixture.thing);
            }
            (_, Some(fixture), _, Some(mut lamp)) => {
                transform.set_if_neq(fixture.transform());
                lamp.set_if_neq(fixture.thing);
            }
            _ => {
                commands.entity(entity).despawn();
                continue;
            }
        }
        here.insert(thing.0.clone(), entity);
    }
    for fixture in standing.solids.iter().filter(|fixture| !here.contains_key(&fixture.name)) {
        commands.spawn((Thing(fixture.name.clone()), fixture.thing, fixture.transform()));
    }
    for fixture in standing.lamps.iter().filter(|fixture| !here.contains_key(&fixture.name)) {
        commands.spawn((Thing(fixture.name.clone()), fixture.thing, fixture.transform()));
    }
    suns.iter().for_each(|sun| commands.entity(sun).despawn());
    if let Some((rotation, strength)) = standing.sun {
        commands.spawn((TheSun, Sun { strength }, Transform::from_rotation(rotation)));
    }
    commands.insert_resource(standing.sky);
}

/// Keeps the gizmo on the thing that is chosen.
pub(super) fn focus_gizmo(
    mut commands: Commands,
    chosen: Res<Chosen>,
    things: Query<(Entity, &Thing, Has<TransformGizmoFocus>)>,
) {
    for (entity, thing, focused) in &things {
        let wanted = matches!(&*chosen, Chosen::Thing(name) if *name == thing.0);
        if wanted && !focused {
            commands.entity(entity).insert(TransformGizmoFocus);
        } else if !wanted && focused {
            commands.entity(entity).remove::<TransformGizmoFocus>();
        }
    }
}
