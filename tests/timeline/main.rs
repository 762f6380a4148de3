//! A garden with its past: what a timeline promises.

mod codes;
#[path = "../common/mod.rs"]
mod common;
mod edits;

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::workers::Workers;
use burgeon::environment::{Sky, SolidShape};
use burgeon::files::{FileError, ResolvedScenario, RunFile, ShareError, SharedTree};
use burgeon::limits;
use burgeon::plant::{Cause, OrganKind, Snapshot};
use burgeon::scenario::{
    Edit, EditError, Garden, PlacedLamp, PlacedSolid, PlacedSun, Planting, SavedRun, Scenario, TimedEdit,
    Timeline, TimelineError, apply,
};
use common::check::{check, check_world};
use common::{grown, quick};
use proptest::prelude::*;

fn workers() -> Workers {
    Workers::new(1).unwrap()
}

/// A small lam_king tree beside a wall, looking around through the smallest faces.
fn small() -> ResolvedScenario {
    let mut resolved = quick("figure_1d");
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 3;
    resolved
}

fn timeline(steps: u32) -> Timeline {
    let mut timeline = Timeline::new(small(), 1, Library::embedded(), workers()).unwrap();
    grow_to(&mut timeline, steps);
    timeline
}

fn grow_to(timeline: &mut Timeline, step: u32) {
    while timeline.present() < step {
        timeline.advance().unwrap();
    }
}

fn catch_up(timeline: &mut Timeline) {
    while timeline.catching_up().is_some() {
        timeline.advance().unwrap();
    }
}

fn block(name: &str, at: Vec3) -> PlacedSolid {
    PlacedSolid { name: name.into(), shape: SolidShape::Box { size: Vec3::splat(0.15) }, at, ..default() }
}

/// The middle of some branch.
fn on_a_branch(shot: &Snapshot) -> Vec3 {
    let i = (0..shot.len())
        .find(|&i| shot.state[i].kind() == OrganKind::Internode && shot.order[i] == 1)
        .unwrap();
    shot.pose[i].tip(0.5 * shot.length(i))
}

/// Hashes by step of a garden grown afresh with the edits that were made and did not lapse.
fn afresh(timeline: &Timeline, steps: u32) -> Vec<u64> {
    let mut resolved = timeline.begun().clone();
    let mut edits: Vec<TimedEdit> = resolved.scenario.edits.iter().chain(timeline.made()).cloned().collect();
    // Of two alike, such as cuts of one branch, the first is made and the second lapses.
    for (lapsed, _) in timeline.lapsed() {
        edits.remove(edits.iter().rposition(|edit| edit == lapsed).unwrap());
    }
    resolved.scenario.edits = edits;
    resolved.scenario.order_edits();
    let mut garden = Garden::new(resolved, timeline.seed(), workers()).unwrap();
    let mut hashes = vec![garden.snapshot().hash()];
    for _ in 0..steps {
        garden.step().unwrap();
        hashes.push(garden.snapshot().hash());
    }
    hashes
}

fn assert_as_afresh(timeline: &Timeline) {
    let hashes = afresh(timeline, timeline.present());
    for (step, hash) in (0..).zip(hashes) {
        if let Some(shot) = timeline.shot(step) {
            assert_eq!(shot.hash(), hash, "step {step}");
        }
        assert_eq!(timeline.hash(step), (step > 0).then_some(hash), "step {step}");
    }
}

#[test]
fn every_step_can_be_seen_again() {
    let timeline = timeline(5);
    let mut garden = Garden::new(small(), 1, workers()).unwrap();
    for step in 0..=5 {
        assert_eq!(*timeline.shot(step).unwrap(), garden.snapshot());
        let view = timeline.view(step).unwrap();
        assert_eq!((view.step, view.standing.solids.len()), (step, 1));
        assert_eq!(view.record.map(|r| r.step), (step > 0).then_some(step));
        garden.step().unwrap();
    }
    assert!(timeline.shot(6).is_none() && timeline.view(6).is_none() && timeline.visit(6).is_none());
}

#[test]
fn an_edit_at_the_head_is_made_at_once_and_undone_at_once() {
    let mut timeline = timeline(5);
    let before = timeline.now();
    let shed = timeline.edit(5, Edit::PlaceSolid(block("b", on_a_branch(&before)))).unwrap().unwrap().shed;
    assert!(shed > 0);
    assert_eq!(timeline.now().len(), before.len() - shed);
    assert_eq!(timeline.shot(5).unwrap(), before, "the step itself was before its edits");
    assert_eq!(timeline.standing(5).unwrap().solids.len(), 2);
    assert_eq!((timeline.catching_up(), timeline.ghost().is_some()), (None, false), "nothing to regrow");
    assert_eq!(timeline.fallen().iter().filter(|t| t.cause == Cause::Crushed).count(), shed);

    assert!(timeline.undo().is_some());
    assert_eq!(timeline.now(), before);
    assert_eq!(timeline.standing(5).unwrap().solids.len(), 1);
    assert!(timeline.fallen().iter().all(|t| t.cause != Cause::Crushed));
    timeline.redo().unwrap();
    assert_eq!(timeline.now().len(), before.len() - shed);
    timeline.advance().unwrap();
    assert_as_afresh(&timeline);
}

#[test]
fn an_edit_at_an_earlier_step_forks_and_the_old_course_stays_as_a_ghost() {
    let mut timeline = timeline(6);
    let old = timeline.shot(6).unwrap();
    timeline.edit(2, Edit::Remove { name: "wall".into() }).unwrap();
    assert_eq!((timeline.present(), timeline.catching_up()), (2, Some(6)));
    assert_eq!(timeline.standing(2).unwrap().solids.len(), 0);
    assert_eq!(timeline.standing(1).unwrap().solids.len(), 1, "before that it stood there");
    catch_up(&mut timeline);
    assert_eq!(timeline.present(), 6);
    assert_as_afresh(&timeline);
    assert_ne!(timeline.shot(6).unwrap(), old, "without the wall another tree");
    let ghost = timeline.ghost().unwrap();
    assert_eq!((ghost.end(), ghost.shot(6).unwrap(), ghost.record(6).unwrap().step), (6, old.clone(), 6));

    // That course is known: undoing needs no growing.
    timeline.undo().unwrap();
    assert_eq!((timeline.present(), timeline.catching_up()), (6, None));
    assert_eq!(timeline.shot(6).unwrap(), old);
    assert_as_afresh(&timeline);
}

#[test]
fn the_ghost_is_the_course_before_the_drag_not_half_of_it() {
    let mut timeline = timeline(6);
    let old = timeline.shot(6).unwrap();
    let moved = |x: f32| Edit::Move { name: "wall".into(), to: Vec3::new(x, 1.5, 0.0), turn_deg: 0.0 };
    timeline.edit(3, moved(0.6)).unwrap();
    for k in 1..20 {
        timeline.amend(3, moved(0.6 + 0.05 * k as f32)).unwrap();
        if k % 7 == 0 {
            timeline.advance().unwrap();
        }
    }
    assert_eq!(timeline.undoable(), (1, 0), "a drag is one edit");
    catch_up(&mut timeline);
    assert_as_afresh(&timeline);
    assert_eq!(timeline.ghost().unwrap().shot(6).unwrap(), old);
    assert_eq!(timeline.made()[0].edit, moved(0.6 + 0.05 * 19.0));
    // What is not the same thing again is an edit of its own.
    timeline.amend(6, moved(1.0)).unwrap();
    timeline.amend(6, Edit::Sun(None)).unwrap();
    assert_eq!(timeline.undoable(), (3, 0));
}

#[test]
fn a_drag_over_living_wood_crushes_only_where_it_ends() {
    let mut timeline = timeline(5);
    let whole = timeline.now();
    timeline.edit(5, Edit::PlaceSolid(block("b", Vec3::new(9.0, 1.0, 0.0)))).unwrap();
    let to = |at: Vec3| Edit::Move { name: "b".into(), to: at, turn_deg: 0.0 };
    timeline.edit(5, to(Vec3::new(8.0, 1.0, 0.0))).unwrap();
    assert!(timeline.amend(5, to(on_a_branch(&whole))).unwrap().unwrap().shed > 0);
    assert_eq!(timeline.amend(5, to(Vec3::new(7.0, 1.0, 0.0))).unwrap().unwrap().shed, 0);
    assert_eq!(timeline.now(), whole, "it was only passed over");
}

#[test]
fn an_edit_that_lost_its_ground_lapses_and_comes_back() {
    let mut timeline = timeline(6);
    let shot = timeline.now();
    let cut = (0..shot.len()).rev().find(|&i| shot.state[i].kind() == OrganKind::Internode).unwrap();
    timeline.edit(6, Edit::Prune { plant: 0, lineage: shot.lineage[cut].0 }).unwrap();
    timeline
        .edit(6, Edit::Move { name: "wall".into(), to: Vec3::new(2.0, 1.5, 0.0), turn_deg: 0.0 })
        .unwrap();
    // Cut low, the branch never grows; and the wall is gone.
    timeline.edit(2, Edit::Top { plant: 0, above: 0.0 }).unwrap();
    timeline.edit(3, Edit::Remove { name: "wall".into() }).unwrap();
    catch_up(&mut timeline);
    assert_eq!(timeline.lapsed().count(), 2);
    assert!(timeline.lapsed().any(|(_, why)| why.contains("lineage")));
    timeline.scenario().validate().unwrap();
    assert_eq!(timeline.scenario().edits.len(), 2);
    assert_as_afresh(&timeline);
    timeline.undo().unwrap();
    timeline.undo().unwrap();
    catch_up(&mut timeline);
    assert_eq!(timeline.lapsed().count(), 0);
    timeline.advance().unwrap();
    assert_as_afresh(&timeline);
}

#[test]
fn what_cannot_be_done_is_told_and_changes_nothing() {
    let mut timeline = timeline(3);
    let before = (timeline.now(), timeline.standing(3), timeline.scenario());
    let invalid = |e: &TimelineError| matches!(e, TimelineError::Invalid(_));
    let wall = block("wall", Vec3::ZERO);
    let far = block("far", Vec3::splat(f32::NAN));
    let cases: [(u32, Edit, fn(&TimelineError) -> bool); 9] = [
        (4, Edit::Sun(None), |e| matches!(e, TimelineError::NotGrown { step: 4, last: 3 })),
        (3, Edit::PlaceSolid(wall), invalid),
        (3, Edit::PlaceSolid(far), invalid),
        (1, Edit::Remove { name: "lamp".into() }, invalid),
        (3, Edit::Uproot { plant: 1 }, invalid),
        (3, Edit::Duplicate { name: "wall".into(), copy: "wall".into(), to: Vec3::ZERO }, invalid),
        (3, Edit::Sky(Sky { strength: -1.0, ..default() }), invalid),
        (3, Edit::Prune { plant: 0, lineage: 1 }, |e| {
            matches!(e, TimelineError::Edit(EditError::NoSuchOrgan { .. }))
        }),
        (3, Edit::Plant(Planting { species: "elm".into(), ..default() }), |e| {
            matches!(e, TimelineError::Species(FileError::NoSuchSpecies { .. }))
        }),
    ];
    for (step, edit, expected) in cases {
        let error = timeline.edit(step, edit.clone()).unwrap_err();
        assert!(expected(&error), "{edit:?}: {error:?}");
        assert_eq!((timeline.now(), timeline.standing(3), timeline.scenario()), before);
        assert_eq!(timeline.undoable(), (0, 0));
    }
    let error = timeline.edit(3, Edit::PlaceLamp(PlacedLamp { radius: -1.0, ..default() })).unwrap_err();
    assert_eq!(error.to_string(), "`radius` is -1; allowed: 0.001 to 100");
    assert!(timeline.undo().is_none() && timeline.redo().is_none());
}

#[test]
fn other_seeds_and_restarts_keep_the_edits() {
    let mut timeline = timeline(5);
    let first = timeline.now();
    timeline.edit(3, Edit::Remove { name: "wall".into() }).unwrap();
    catch_up(&mut timeline);
    let free = timeline.now();
    timeline.restart();
    assert_eq!((timeline.present(), timeline.catching_up()), (0, None));
    assert_eq!(timeline.ghost().unwrap().end(), 5);
    timeline.restart();
    assert_eq!(timeline.present(), 0);
    grow_to(&mut timeline, 5);
    assert_eq!(timeline.now(), free);
    timeline.reseed(2).unwrap();
    assert_eq!((timeline.present(), timeline.seed()), (0, 2));
    grow_to(&mut timeline, 5);
    assert_as_afresh(&timeline);
    assert_ne!(timeline.now(), free);
    assert_eq!(timeline.ghost().unwrap().seed(), 1);
    timeline.undo().unwrap();
    timeline.reseed(1).unwrap();
    grow_to(&mut timeline, 5);
    assert_eq!(timeline.now(), first);
}

#[test]
fn steps_beyond_the_budget_are_thinned_and_reached_by_growing() {
    let mut full = timeline(12);
    let whole: Vec<_> = (0..=12).map(|step| full.view(step).unwrap()).collect();
    let budget = full.bytes() / 3;
    let mut timeline = Timeline::new(small(), 1, Library::embedded(), workers()).unwrap();
    timeline.set_budget(budget);
    grow_to(&mut timeline, 12);
    assert!(timeline.bytes() <= budget);
    let missing: Vec<u32> = (0..=12).filter(|&step| timeline.shot(step).is_none()).collect();
    assert!(missing.len() > 3 && !missing.contains(&0) && !missing.contains(&12), "{missing:?}");
    for step in missing {
        assert_eq!(timeline.record(step).map(|r| r.form), full.record(step).map(|r| r.form));
        let mut visit = timeline.visit(step).unwrap();
        let view = loop {
            if let Some(view) = timeline.go_on(&mut visit).unwrap() {
                break view;
            }
        };
        assert_eq!((view.step, &view.shot), (step, &whole[step as usize].shot));
        assert_eq!(view.standing, whole[step as usize].standing);
    }
    assert!(timeline.bytes() <= budget);
    // A fork between two that are kept.
    for timeline in [&mut timeline, &mut full] {
        timeline.edit(5, Edit::Remove { name: "wall".into() }).unwrap();
        catch_up(timeline);
        assert_as_afresh(timeline);
    }
    assert_eq!(timeline.now(), full.now());
}

#[test]
fn previews_count_what_an_edit_sheds() {
    let mut timeline = timeline(6);
    let shot = timeline.now();
    let wall = block("b", on_a_branch(&shot));
    let standing = burgeon::environment::StandingSolid {
        shape: wall.shape,
        position: wall.at,
        rotation: Quat::IDENTITY,
        color: [0.0; 3],
    };
    let crushed = timeline.crush_preview(&standing);
    let cut = (0..shot.len()).find(|&i| shot.order[i] == 1).unwrap();
    let borne = timeline.prune_preview(shot.birth[cut]);
    assert_eq!(timeline.now(), shot, "nothing has changed");
    let shed = timeline.edit(6, Edit::PlaceSolid(wall)).unwrap().unwrap().shed;
    assert!(shed > 0 && crushed.len() == shed);
    let left = timeline.now();
    assert!(crushed.iter().all(|&birth| left.index_of(birth).is_none()));
    timeline.undo().unwrap();
    let prune = Edit::Prune { plant: 0, lineage: shot.lineage[cut].0 };
    assert_eq!(timeline.edit(6, prune).unwrap().unwrap().shed, borne.len());
    assert!(borne.len() > 1 && timeline.prune_preview(shot.birth[cut]).is_empty());
}

#[test]
fn plants_of_other_species_come_from_the_library() {
    let mut timeline = timeline(3);
    let oak = Planting { species: "oak".into(), at: Vec3::new(-2.0, 0.0, 0.0), ..default() };
    timeline.edit(1, Edit::Plant(oak)).unwrap();
    let set = Edit::Set { species: "oak".into(), parameter: "leaf_income".into(), value: "3".into() };
    timeline.edit(2, set).unwrap();
    catch_up(&mut timeline);
    assert_eq!(timeline.now().plants.len(), 2);
    timeline.undo().unwrap();
    timeline.undo().unwrap();
    timeline.redo().unwrap();
    timeline.redo().unwrap();
    catch_up(&mut timeline);
    let run = RunFile::from_ron(&timeline.run_file().to_ron(), "run.ron").unwrap();
    let again = grown(run.resolved(), run.seed, run.steps);
    assert_eq!(again.snapshot(), *timeline.shot(3).unwrap());
}

#[test]
fn four_thousand_undo_steps() {
    let mut timeline = timeline(2);
    let first = (timeline.now(), timeline.standing(2));
    for k in 0..4000 {
        let to = Vec3::new(2.0 + 0.001 * k as f32, 1.5, 0.0);
        timeline.edit(2, Edit::Move { name: "wall".into(), to, turn_deg: 0.0 }).unwrap();
    }
    let last = (timeline.now(), timeline.standing(2));
    assert_eq!(timeline.undoable(), (4000, 0));
    while timeline.undo().is_some() {}
    assert_eq!((timeline.now(), timeline.standing(2)), first);
    assert_eq!(timeline.undoable(), (0, 4000));
    while timeline.redo().is_some() {}
    assert_eq!((timeline.now(), timeline.standing(2)), last);
    timeline.scenario().validate().unwrap();
}
