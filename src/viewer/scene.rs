//! The picture: plants between two steps, and what stands around them.

use std::collections::HashMap;

use bevy::gizmos::transform_gizmo::{TransformGizmoFocus, TransformGizmoState};
use bevy::prelude::*;

use super::state::{Chosen, Course, Doomed, Shown};
use crate::environment::{Lamp, Shore, Solid, Sun};
use crate::plant::{OrganKind, Snapshot};
use crate::render::{Drawn, Ghost, Look, Marks, StepFraction};
use crate::scenario::{Fixtures, View};
use crate::shape::noise::smooth;

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
/// Part of a step up to which it is hardly begun to be shown.
const BEGUN: f32 = 0.4;

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
    let (frame, beat) = (time.delta_secs(), beat(&course));
    if *seen != shown.arrival {
        *seen = shown.arrival;
        let moves = !std::sync::Arc::ptr_eq(&drawn.before, &drawn.now);
        if shown.grew && moves && *passed < BEGUN * beat {
            // Two steps in quick succession, as after an edit, are shown as one: the first is not cut short.
            drawn.now = view.shot.clone();
        } else if shown.grew {
            drawn.step_to(view.shot.clone());
            *passed = 0.0;
        } else {
            *drawn = Drawn::still(view.shot.clone());
            *passed = f32::INFINITY;
        }
    }
    *passed += frame;
    fraction.set_if_neq(between(*passed, frame, beat));
    let wanted = Look { overlay: shown.overlay, ghost: None, fill: fill(view) };
    look.set_if_neq(wanted);
    match (&shown.ghost, old.single_mut()) {
        (Some(ghost), Ok((_, mut drawn))) => {
            if !std::sync::Arc::ptr_eq(&drawn.now, &ghost.shot) {
                *drawn = Drawn::still(ghost.shot.clone());
            }
        }
        (Some(ghost), Err(_)) => {
            let look = Look { ghost: Some(Ghost::default()), ..default() };
            commands.spawn((OldCourse, Drawn::still(ghost.shot.clone()), look));
        }
        (None, Ok((entity, _))) => commands.entity(entity).despawn(),
        (None, Err(_)) => {}
    }
}

/// Seconds a step takes on screen.
pub(super) fn beat(course: &Course) -> f32 {
    let beat = course.progress.pace.filter(|_| course.progress.playing).map_or(CHANGE, |pace| 1.0 / pace);
    beat.clamp(0.05, 4.0)
}

/// How far between two steps plants are drawn, some seconds after the later one came, in a frame of some seconds, when
/// a step takes a beat.
pub(super) fn between(passed: f32, frame: f32, beat: f32) -> StepFraction {
    // So few frames are no movement: each shows the end of a step, not one in a hard winter.
    let few = frame * 4.0 > beat;
    StepFraction(if few { 1.0 } else { (passed / beat).min(1.0) })
}

/// How much light of its own a garden's plants are drawn with: small ones in dim light would be dark on dark.
pub(super) fn fill(view: &View) -> f32 {
    const SMALL: [f32; 2] = [2.0, 5.0];
    const DIM: [f32; 2] = [0.3, 0.7];
    let high = view.shot.pose.iter().map(|pose| pose.position.y).fold(0.0, f32::max);
    let standing = &view.standing;
    let light = standing.sky.strength + standing.sun.map_or(0.0, |(_, strength)| strength);
    (1.0 - smooth(SMALL[0], SMALL[1], high)) * (1.0 - smooth(DIM[0], DIM[1], light))
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
        Chosen::Plant(plant) => shown.view.as_ref().map_or_else(Vec::new, |view| wood_of(&view.shot, plant)),
        _ => Vec::new(),
    };
    marks.set_if_neq(Marks { hovered: Vec::new(), chosen, doomed: doomed.0.clone() });
}

/// Birth numbers of a plant's wood: enough to tell it from others, and its leaves stay green.
fn wood_of(shot: &Snapshot, plant: u32) -> Vec<u32> {
    let own = (0..shot.len()).filter(|&i| shot.plant[i] == plant);
    own.filter(|&i| shot.state[i].kind() == OrganKind::Internode).map(|i| shot.birth[i]).collect()
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
    match standing.shore {
        Some(shore) => commands.insert_resource(shore),
        None => commands.remove_resource::<Shore>(),
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assets::Library;
    use crate::environment::workers::Workers;
    use crate::scenario::Timeline;

    #[test]
    fn small_plants_are_lifted_out_of_the_dusk_alone() {
        let at = |scenario: &str, steps: u32| {
            let library = Library::embedded();
            let resolved = library.scenario(scenario).unwrap();
            let mut timeline = Timeline::new(resolved, 1, library, Workers::new(1).unwrap()).unwrap();
            for _ in 0..steps {
                timeline.advance().unwrap();
            }
            fill(&timeline.view(steps).unwrap())
        };
        assert_eq!([at("dusk", 0), at("dusk", 2)], [1.0, 1.0]);
        assert!(at("dusk", 14) < 0.5);
        assert_eq!(at("wall", 2), 0.0, "by day nothing is dark");
    }
}
