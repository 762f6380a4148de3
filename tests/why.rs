//! Why a bud did what it did: told from a snapshot, it is what growth really decided.

mod common;

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::cube_map::CubeFace;
use burgeon::environment::workers::Workers;
use burgeon::files::ResolvedScenario;
use burgeon::growth::explain::{Outcome, fate, rows};
use burgeon::plant::{Cause, OrganState};
use burgeon::scenario::{Edit, PlacedLamp, Planting, Timeline};
use common::{quick, steered_directly};

fn timeline(resolved: ResolvedScenario, seed: u64, steps: u32) -> Timeline {
    let workers = Workers::new(2).unwrap();
    let mut timeline = Timeline::new(resolved, seed, Library::embedded(), workers).unwrap();
    for _ in 0..steps {
        timeline.advance().unwrap();
    }
    timeline
}

/// How many buds' explanations were compared with what they really did, how many went the way told, and how many had
/// to take another than their best.
fn compare(timeline: &Timeline, step: u32, most: usize) -> (usize, usize, usize) {
    let shot = timeline.shot(step).unwrap();
    let (mut compared, mut told, mut second) = (0, 0, 0);
    let every = (shot.len() / most).max(1);
    for i in (0..shot.len()).step_by(every) {
        let Some(why) = timeline.explain(step, shot.birth[i]).unwrap() else { continue };
        let explanation = &why.explanation;
        if explanation.step == step
            && let Some(sight) = &explanation.sight
        {
            assert!(sight.agrees, "step {step} organ {}", explanation.birth);
            assert_eq!(sight.look.sensed.light, explanation.exposure.light);
            assert_eq!(sight.look.sensed.space, explanation.exposure.space);
        }
        let Some(sight) = explanation.sight.as_ref().filter(|s| s.request.search.is_some()) else { continue };
        let rank = sight.chosen.unwrap();
        let choice = sight.look.sensed.ranked[rank];
        assert_eq!(sight.look.terms[choice.index as usize].fitness(), choice.fitness);
        if let Outcome::Grew { heading, length, .. } = why.outcome {
            if shot.pose[i].position.y + length * choice.heading.y < 0.0 {
                // It chose to grow into the ground, and slid along it.
                continue;
            }
            compared += 1;
            told += usize::from(heading.distance(choice.heading) < 1e-3);
            second += usize::from(rank > 0);
            assert!(length > 0.0);
        }
    }
    (compared, told, second)
}

#[test]
fn what_is_told_is_what_the_bud_did() {
    let timeline = timeline(steered_directly(quick("open")), 3, 7);
    let (mut all, mut seconds) = (0, 0);
    for step in 1..7 {
        let (compared, told, second) = compare(&timeline, step, 200);
        assert_eq!(compared, told, "step {step}");
        all += compared;
        seconds += second;
    }
    assert!(all > 50 && seconds > 0, "{all} {seconds}");
}

#[test]
fn it_holds_beside_walls_and_lamps_and_when_a_seed_opens() {
    let mut timeline = timeline(steered_directly(quick("lamp")), 5, 4);
    let lamp = PlacedLamp { name: "late".into(), at: Vec3::new(-2.0, 1.0, 0.5), ..PlacedLamp::default() };
    timeline.edit(3, Edit::PlaceLamp(lamp)).unwrap();
    let planting = Planting { at: Vec3::new(0.8, 0.0, 0.2), ..timeline.begun().scenario.plants[0].clone() };
    timeline.edit(4, Edit::Plant(planting)).unwrap();
    while timeline.present() < 7 {
        timeline.advance().unwrap();
    }
    for step in 1..7 {
        let (compared, told, _) = compare(&timeline, step, 200);
        // A shoot may slide along a wall or the ground.
        assert!(compared > 0 && told * 10 >= compared * 9, "step {step}: {told} of {compared}");
    }
    // At step 4 a seed opens: all looked once more, and the new plant's first bud can be asked, too.
    let (shot, _) = timeline.as_they_looked(4).unwrap().unwrap();
    let newest = shot.birth[shot.len() - 1];
    let why = timeline.explain(4, newest).unwrap().unwrap();
    assert_eq!(why.explanation.plant, 1);
    assert!(matches!(why.outcome, Outcome::Grew { .. }));
}

#[test]
fn an_organ_has_a_history_and_a_fate() {
    let timeline = timeline(quick("open"), 1, 8);
    let shot = timeline.shot(8).unwrap();
    let trunk = (0..shot.len()).find(|&i| matches!(shot.state[i], OrganState::Internode(..))).unwrap();
    let why = timeline.explain(8, shot.birth[trunk]).unwrap().unwrap();
    assert!(why.history.windows(2).all(|w| w[0].step < w[1].step && w[0].radius <= w[1].radius));
    assert_eq!(why.history.last().unwrap().step, 8);
    assert!(why.explanation.bears.organs > 20 && why.explanation.sight.is_none());
    let sentences = why.explanation.sentences(why.outcome).join("\n");
    assert!(sentences.contains("bears") && sentences.contains("energy"), "{sentences}");

    let bud = (0..shot.len())
        .find(|&i| matches!(shot.state[i], OrganState::ApicalBud(..)) && shot.allotment[i] > 0.0)
        .unwrap();
    let why = timeline.explain(8, shot.birth[bud]).unwrap().unwrap();
    let sight = why.explanation.sight.as_ref().unwrap();
    let size = sight.look.map.size();
    for face in CubeFace::ALL {
        let rows = rows(&sight.look.map, face);
        assert!(rows.len() == size && rows.iter().all(|row| row.chars().count() == size));
    }
    assert!(why.explanation.sentences(why.outcome).join("\n").contains("compared"));

    let grave = timeline.fallen().iter().next().unwrap();
    assert_eq!(timeline.tombstone(grave.birth), Some(grave));
    assert!(fate(grave).contains(&format!("Organ {}, a", grave.birth)));
    let branched = burgeon::plant::Tombstone { cause: Cause::Branched, ..*grave };
    assert!(fate(&branched).contains("turned into the buds of its node"));
    assert!(timeline.explain(8, grave.birth).unwrap().is_none());
    let alive = timeline.explain(grave.died, grave.birth).unwrap();
    // It grew as it branched.
    assert!(alive.is_none_or(|why| why.outcome != Outcome::Unknown));
}

#[test]
fn a_step_that_is_not_kept_is_grown_again() {
    let mut timeline = timeline(quick("open"), 2, 7);
    let birth = timeline.shot(5).unwrap().birth[3];
    let before = timeline.explain(5, birth).unwrap().unwrap();
    timeline.set_budget(1);
    assert!(timeline.shot(5).is_none());
    let after = timeline.explain(5, birth).unwrap().unwrap();
    assert_eq!(before.explanation.exposure, after.explanation.exposure);
    assert_eq!(
        before.explanation.sight.map(|s| s.look.sensed),
        after.explanation.sight.map(|s| s.look.sensed)
    );
    assert!(timeline.explain(9, birth).unwrap().is_none());
}

#[test]
fn species_edits_go_on_or_regrow_and_can_be_undone() {
    let set = |values: &[(&str, &str)]| Edit::SetAll {
        species: "lam_king".into(),
        values: values.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect(),
    };
    let mut timeline = timeline(quick("figure_1d"), 4, 5);
    let name = timeline.begun().scenario.plants[0].species.clone();
    assert_eq!(name, "lam_king");
    let hash = timeline.hash(5);
    let edit = set(&[("branching_angle_deg", "25"), ("leaves_per_node", "2")]);

    // Go on: what has grown stays.
    timeline.edit(5, edit.clone()).unwrap();
    assert_eq!(timeline.hash(5), hash);
    timeline.advance().unwrap();
    let went_on = timeline.hash(6);

    // Regrow: from the beginning, as if the species had always been so.
    timeline.undo().unwrap();
    timeline.edit(0, edit.clone()).unwrap();
    while timeline.present() < 6 {
        timeline.advance().unwrap();
    }
    let mut other = quick("figure_1d");
    let species = other.species.get_mut("lam_king").unwrap();
    species.branching_angle_deg = [25.0].into();
    species.leaves_per_node = 2;
    let always = self::timeline(other, 4, 6);
    assert_eq!(timeline.hash(6), always.hash(6));
    assert_ne!(timeline.hash(6), went_on);

    // It travels by run.ron, save and code.
    let run = timeline.run_file();
    let text = run.to_ron();
    let again = burgeon::files::RunFile::from_ron(&text, "run.ron").unwrap();
    let regrown = self::timeline(again.resolved(), again.seed, 6);
    assert_eq!(regrown.hash(6), timeline.hash(6));
    let code = timeline.code().unwrap();
    let shared = burgeon::files::SharedTree::from_code(&code).unwrap();
    let mut shared = Timeline::from_shared(shared, Library::embedded(), Workers::new(1).unwrap()).unwrap();
    while shared.catching_up().is_some() {
        shared.advance().unwrap();
    }
    assert_eq!(shared.hash(6), timeline.hash(6));
    let resumed = Timeline::resume(timeline.save(), Library::embedded(), Workers::new(1).unwrap()).unwrap();
    assert_eq!(resumed.hash(6), timeline.hash(6));

    timeline.undo().unwrap();
    while timeline.present() < 5 {
        timeline.advance().unwrap();
    }
    assert_eq!(timeline.hash(5), hash);

    // All or nothing, with the field named.
    let bad = timeline.edit(5, set(&[("leaves_per_node", "2"), ("branching_angle_deg", "999")]));
    assert!(bad.unwrap_err().to_string().contains("999"));
    // A later edit of the same parameters takes the place of an earlier one while dragging.
    timeline.amend(5, set(&[("leaves_per_node", "2")])).unwrap();
    timeline.amend(5, set(&[("leaves_per_node", "1")])).unwrap();
    assert_eq!(timeline.made().len(), 1);
}
