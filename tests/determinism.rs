//! The same tree, bit for bit, whatever happens around it.

mod common;

use std::collections::HashMap;
use std::fmt::Write;

use bevy::prelude::*;
use burgeon::environment::workers::Workers;
use burgeon::files::ResolvedScenario;
use burgeon::plant::measure::Form;
use burgeon::plant::{Lineage, Snapshot};
use burgeon::scenario::{Edit, Garden, GardenSave, PlacedSolid};
use burgeon::species::Species;
use burgeon::species::parameter::Value;
use common::measure::median;
use common::{garden, grown, over_seeds, quick, shipped};

/// A hash of the tree after every step.
fn hashes(garden: &mut Garden, steps: u32) -> Vec<u64> {
    (0..steps)
        .map(|_| {
            garden.step().unwrap();
            garden.snapshot().hash()
        })
        .collect()
}

const CASES: [(&str, u32); 3] = [("figure_1d", 9), ("lamp", 8), ("two_oaks", 7)];

#[test]
fn the_same_tree_twice() {
    for (name, steps) in CASES {
        let once = hashes(&mut garden(quick(name), 5), steps);
        assert_eq!(once, hashes(&mut garden(quick(name), 5), steps), "{name}");
    }
}

#[test]
fn another_seed_another_tree() {
    for (name, steps) in CASES {
        let trees = over_seeds(1..6, |seed| grown(quick(name), seed, steps).snapshot().pose);
        for (k, tree) in trees.iter().enumerate() {
            assert!(!trees[k + 1..].contains(tree), "{name}: two seeds, one tree");
        }
    }
}

#[test]
fn the_same_tree_on_any_number_of_threads() {
    for (name, steps) in CASES {
        let [one, two, four] = [1, 2, 4].map(|threads| {
            let workers = Workers::new(threads).unwrap();
            hashes(&mut Garden::new(quick(name), 5, workers).unwrap(), steps)
        });
        assert_eq!(one, two, "{name}");
        assert_eq!(one, four, "{name}");
    }
}

#[derive(Component)]
struct Passerby;

#[test]
fn the_same_tree_among_other_entities_that_come_and_go() {
    for (name, steps) in CASES {
        let alone = hashes(&mut garden(quick(name), 5), steps);
        let mut garden = garden(quick(name), 5);
        let mut crowd: Vec<Entity> = Vec::new();
        let mut amid = Vec::new();
        for step in 0..steps {
            let world = garden.world_mut();
            for k in 0..50 {
                crowd.push(world.spawn((Passerby, Transform::from_xyz(k as f32, 0.0, step as f32))).id());
            }
            for gone in crowd.drain(..).step_by(2).collect::<Vec<_>>() {
                world.despawn(gone);
            }
            amid.extend(hashes(&mut garden, 1));
        }
        assert_eq!(alone, amid, "{name}");
    }
}

#[test]
fn the_same_tree_resumed_at_any_step() {
    for (name, steps) in CASES.map(|(name, steps)| (name, steps - 1)) {
        let whole = hashes(&mut garden(quick(name), 5), steps);
        let mut first = garden(quick(name), 5);
        for k in 0..steps {
            let bytes = postcard::to_stdvec(&first.save()).unwrap();
            let save: GardenSave = postcard::from_bytes(&bytes).unwrap();
            let mut resumed = Garden::resume(save, Workers::new(1).unwrap()).unwrap();
            assert_eq!(resumed.snapshot(), first.snapshot(), "{name} restored at step {k}");
            assert_eq!(hashes(&mut resumed, steps - k), whole[k as usize..], "{name} resumed at step {k}");
            first.step().unwrap();
        }
    }
}

#[test]
fn the_same_tree_resumed_after_edits() {
    let mut resolved = quick("lamp_moved");
    resolved.scenario.edits[0].step = 4;
    let whole = hashes(&mut garden(resolved.clone(), 5), 7);
    for k in [3, 4, 5] {
        let save = grown(resolved.clone(), 5, k).save();
        let mut resumed = Garden::resume(save, Workers::new(1).unwrap()).unwrap();
        assert_eq!(hashes(&mut resumed, 7 - k), whole[k as usize..], "resumed at step {k}");
    }
}

/// Scenario, seed and steps of the golden hashes.
const GOLDEN: [(&str, u64, u32); 8] = [
    ("figure_1a", 1, 6),
    ("figure_1b", 1, 5),
    ("figure_1c", 1, 9),
    ("figure_1d", 2, 9),
    ("wall", 1, 8),
    ("lamp", 1, 8),
    ("courtyard", 3, 8),
    ("two_oaks", 1, 7),
];

/// Trees as they have always grown. After a change that is meant to change them, write the file anew with
/// `BURGEON_WRITE_GOLDEN=1 cargo test --no-default-features --test determinism golden`.
#[test]
fn golden_hashes_in_debug_and_release() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden_hashes.txt");
    let mut grown_now = String::from("# scenario seed steps hash\n");
    for (name, seed, steps) in GOLDEN {
        let hash = grown(quick(name), seed, steps).snapshot().hash();
        writeln!(grown_now, "{name} {seed} {steps} {hash:016x}").unwrap();
    }
    if std::env::var_os("BURGEON_WRITE_GOLDEN").is_some() {
        std::fs::write(file, &grown_now).unwrap();
    }
    assert_eq!(std::fs::read_to_string(file).unwrap_or_default(), grown_now);
}

/// What chance gave each organ: its turn on its stem, which nothing but draws and the environment decide.
fn turns(shot: &Snapshot, far: impl Fn(Vec3) -> bool) -> HashMap<Lineage, [u32; 4]> {
    (0..shot.len())
        .filter(|&i| far(shot.pose[i].position))
        .map(|i| (shot.lineage[i], shot.attachment[i].to_array().map(f32::to_bits)))
        .collect()
}

#[test]
fn a_wall_on_one_side_leaves_the_draws_of_the_other_side_as_they_were() {
    // Blind to light and space, so that nothing but chance and contact decide; the wall stops one side.
    let mut resolved = quick("lamp");
    resolved.scenario.mechanisms.light = false;
    resolved.scenario.mechanisms.space = false;
    resolved.scenario.mechanisms.energy = false;
    let species = resolved.species.get_mut("oak").unwrap();
    species.max_order = 2;
    let steps = 5;
    let free = grown(resolved.clone(), 4, steps).snapshot();
    let mut walled = garden(resolved, 4);
    let wall = PlacedSolid {
        shape: burgeon::environment::SolidShape::Box { size: Vec3::new(0.2, 6.0, 6.0) },
        at: Vec3::new(0.45, 3.0, 0.0),
        ..default()
    };
    burgeon::scenario::apply(walled.world_mut(), &Edit::PlaceSolid(wall)).unwrap();
    for _ in 0..steps {
        walled.step().unwrap();
    }
    let walled = walled.snapshot();
    assert!(walled.len() != free.len() || walled.pose != free.pose, "the wall is felt");
    let far = |p: Vec3| p.x < 0.0;
    // Limbs that end at the wall move others a little, some of them across the middle.
    let (free, walled) = (turns(&free, far), turns(&walled, |_| true));
    let both = free.iter().filter(|(lineage, _)| walled.contains_key(lineage)).count();
    let same = free.iter().filter(|(lineage, turn)| walled.get(lineage) == Some(turn)).count();
    println!(
        "wall: {} organs on the other side, {both} of them still there, {same} as they were",
        free.len()
    );
    assert!(free.len() > 50 && both * 100 >= free.len() * 95, "{both} of {}", free.len());
    assert_eq!(same, both, "every draw is as it was");
}

/// Height, crown width and leaves.
fn size(resolved: &ResolvedScenario, seed: u64, steps: u32) -> [f64; 3] {
    let form = Form::of(&grown(resolved.clone(), seed, steps).snapshot(), None);
    [form.height_m.into(), form.crown_width_m.into(), form.leaves.into()]
}

#[test]
fn no_butterfly_effect() {
    let lengths = ["node_spacing_m", "extension_m", "internode_m"];
    let habit = ["branching_angle_deg", "leaf_income", "phyllotaxis_deg", "apical_control"];
    let cases = [
        ("figure_1c", "lam_king", 9, [&lengths[..], &["branching_angle_deg", "leaf_income"]].concat()),
        (
            "open",
            "oak",
            8,
            vec![
                "branching_angle_deg",
                "leaf_income",
                "shoot_cost",
                "weight_heading",
                "node_spacing_m",
                "apical_control",
                "phyllotaxis_deg",
            ],
        ),
        ("wall", "oak", 14, habit.to_vec()),
        ("courtyard", "oak", 16, habit.to_vec()),
    ];
    let mut broken = Vec::new();
    for (scenario, species, steps, parameters) in cases {
        // As shipped: what smaller faces see is coarser, and what is near a threshold falls on either side of it.
        let resolved = shipped(scenario);
        let plain = over_seeds(0..20, |seed| size(&resolved, seed, steps));
        for (name, by) in parameters.into_iter().flat_map(|name| [(name, 1.01), (name, 0.99)]) {
            let mut changed = resolved.clone();
            nudge(changed.species.get_mut(species).unwrap(), name, by);
            let nudged = over_seeds(0..20, |seed| size(&changed, seed, steps));
            let change = [0, 1, 2]
                .map(|k| median(plain.iter().zip(&nudged).map(|(a, b)| (b[k] / a[k] - 1.0).abs()).collect()));
            println!("butterfly {species} {name} x {by}: height, width, leaves change by {change:.3?}");
            if change.iter().any(|&c| c >= 0.1) {
                broken.push(format!("{species} {name} x {by}: {change:.3?}"));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}

/// Multiplies a parameter, or every number of one by order.
fn nudge(species: &mut Species, name: &str, by: f64) {
    let nudged = match species.get(name) {
        Some(Value::Real(value)) => Value::Real(value * by),
        Some(Value::List(values)) => Value::List(values.iter().map(|value| value * by).collect()),
        other => panic!("{name} is {other:?}"),
    };
    species.set(name, &nudged).unwrap();
}

#[test]
fn looking_at_a_garden_changes_nothing() {
    let mut watched = garden(shipped("two_oaks"), 2);
    let mut seen = Vec::new();
    for _ in 0..5 {
        watched.scene();
        watched.save();
        seen.extend(hashes(&mut watched, 1));
    }
    assert_eq!(seen, hashes(&mut garden(shipped("two_oaks"), 2), 5));
}
