//! What holds over a long life: nothing is left behind, in the world or in memory.

mod common;

use std::alloc::System;
use std::sync::{Mutex, MutexGuard, PoisonError};

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::growth::generation::BudBroke;
use burgeon::plant::{Fallen, OrganShed, Tombstone};
use burgeon::scenario::{Edit, Garden, apply};
use burgeon::species::Species;
use burgeon::tropism::{Control, Influence, LONGEST_LAG, Signals, Steering, step, turned_to};
use common::check::{check, check_world};
use common::{garden, pot, quick};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static MEMORY: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Memory in use by the whole process, bytes.
fn bytes() -> usize {
    let all = MEMORY.stats();
    all.bytes_allocated - all.bytes_deallocated
}

/// One test at a time: memory is the process's.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What lives long: counts over the first and the second thousand steps.
#[derive(Debug, Default, Clone, Copy)]
struct Life {
    most_leaves: u32,
    fewest_leaves: u32,
    most_organs: usize,
    most_bytes: usize,
    fell: u64,
}

/// Two thousand steps, with what happens before each; the first fifty are youth and not counted.
fn long_life(garden: &mut Garden, mut before: impl FnMut(&mut Garden, u32)) -> [Life; 2] {
    let mut halves = [Life { fewest_leaves: u32::MAX, ..default() }; 2];
    for step in 0..2_000 {
        before(garden, step);
        let form = garden.step().unwrap().form;
        let fallen = garden.world().resource::<Fallen>();
        assert!(fallen.tombstones.len() <= Fallen::LIMIT);
        // These are bounded by themselves, and long in coming to their bound.
        let remembering_the_dead = fallen.tombstones.capacity() * size_of::<Tombstone>();
        let half = &mut halves[step as usize / 1_000];
        half.fell = fallen.total;
        half.most_organs = half.most_organs.max(garden.organs());
        half.most_bytes = half.most_bytes.max(bytes() - remembering_the_dead);
        if step >= 50 {
            half.most_leaves = half.most_leaves.max(form.leaves);
            half.fewest_leaves = half.fewest_leaves.min(form.leaves);
        }
        if step % 100 == 0 {
            check(&garden.snapshot()).unwrap();
            check_world(garden.world_mut()).unwrap();
            let world = garden.world();
            assert!(world.resource::<Messages<OrganShed>>().len() < 3_000);
            assert!(world.resource::<Messages<BudBroke>>().len() < 3_000);
        }
    }
    println!("{halves:?}");
    halves
}

/// Entities of a world that is no larger than what lives in it.
fn no_entity_too_many(garden: &Garden, without: u32) {
    let entities = garden.world().entities().count_spawned();
    assert_eq!(entities, garden.organs() as u32 + without, "entities are living organs");
}

#[test]
fn a_stem_at_balance_lives_two_thousand_steps() {
    let _alone = alone();
    let species = Species {
        max_order: 0,
        apical_buds_per_node: 0,
        axis_continues: true,
        leaf_life_steps: 6,
        ..default()
    };
    let mut garden = garden(pot(Species { seed_energy: 10.0, ..species }), 3);
    let empty = garden.world().entities().count_spawned();
    let [young, old] = long_life(&mut garden, |_, _| ());
    assert!(young.fewest_leaves > 5 && old.fewest_leaves > 5, "it lives");
    assert!(old.most_leaves <= young.most_leaves, "its crown stays as it is");
    assert!(old.fell > young.fell + 1_000, "it sheds as it grows");
    // One internode a step stays.
    assert!(old.most_organs < 2_000 + 100, "organs at most {}", old.most_organs);
    assert!(old.most_bytes < young.most_bytes + 1_000 * 1_000, "bytes at most {young:?} {old:?}");
    no_entity_too_many(&garden, empty);
}

#[test]
fn generations_follow_each_other_for_two_thousand_steps_in_level_memory() {
    let _alone = alone();
    let mut resolved = quick("two_oaks");
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 2;
    let sown = resolved.scenario.plants.clone();
    let mut garden = garden(resolved, 3);
    let empty = garden.world().entities().count_spawned();
    // Every four steps the older tree makes room for a seed.
    let [young, old] = long_life(&mut garden, |garden, step| {
        if step > 0 && step % 4 == 0 {
            let world = garden.world_mut();
            let turn = step / 4;
            apply(world, &Edit::Uproot { plant: turn - 1 }).unwrap();
            apply(world, &Edit::Plant(sown[(turn as usize + 1) % 2].clone())).unwrap();
        }
    });
    assert!(young.fewest_leaves > 0 && old.fewest_leaves > 0, "there always is a tree in leaf");
    assert!(old.fell > young.fell * 3 / 2, "generations come and go");
    assert!(old.most_organs < young.most_organs * 5 / 4, "organs at most {young:?} {old:?}");
    assert!(old.most_bytes < young.most_bytes + 500 * 1_000, "bytes at most {young:?} {old:?}");
    no_entity_too_many(&garden, empty);
}

#[test]
fn a_birch_on_poor_ground_lives_two_thousand_years_at_balance() {
    let _alone = alone();
    let mut resolved = Library::embedded().alone("silver_birch").unwrap();
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 2;
    resolved.species.get_mut("silver_birch").unwrap().leaf_income *= 0.5;
    let mut garden = garden(resolved, 2);
    let empty = garden.world().entities().count_spawned();
    let [young, old] = long_life(&mut garden, |_, _| ());
    assert!(garden.records().iter().rev().take(100).any(|year| year.form.leaves > 0), "it lives");
    // Wood that it lost is grown again, more or less.
    assert!(old.most_organs < young.most_organs * 3 / 2, "organs at most {young:?} {old:?}");
    assert!(old.most_leaves < young.most_leaves * 3 / 2, "leaves at most {young:?} {old:?}");
    assert!(old.fell > young.fell + 1_000, "it sheds as it grows");
    assert!(old.most_bytes < young.most_bytes + 1_000 * 1_000, "bytes at most {young:?} {old:?}");
    no_entity_too_many(&garden, empty);
}

#[test]
fn a_sub_step_of_steering_allocates_nothing() {
    let _alone = alone();
    let control = Control { integral: 0.1, derivative: 0.5, ..Control::of_ratio(0.8, LONGEST_LAG).unwrap() };
    let (mut steering, mut signals, mut frame) = (Steering::default(), Signals::default(), Quat::IDENTITY);
    let influence = Influence { sensing: Vec2::new(0.1, 0.0), disturbance: Vec2::new(0.0, 0.05) };
    let before = MEMORY.stats().allocations;
    for _ in 0..10_000 {
        let heading = step(&control, &mut steering, &mut signals, frame, Vec3::X, influence);
        frame = turned_to(frame, heading);
    }
    // The harness may tell of another test meanwhile.
    let allocations = MEMORY.stats().allocations - before;
    assert!(allocations < 100, "{allocations} allocations");
    assert!((frame * Vec3::Y).is_normalized());
}
