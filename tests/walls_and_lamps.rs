//! Trees among walls and lamps, and what cuts them.

mod common;

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::{Sky, Solid, SolidShape, StandingSolid, standing_solids};
use burgeon::files::ResolvedScenario;
use burgeon::plant::{Bears, Cause, Fallen, Identity, OrganKind, OrganState, Plant, Roster, Snapshot, shed};
use burgeon::scenario::{Edit, Garden, PlacedLamp, PlacedSolid, Planting, TimedEdit, apply};
use burgeon::species::Species;
use common::by_hand::Nursery;
use common::check::{check, check_solids, check_world, grow_past_solids};
use common::measure::{count, mean_position, wood_centroid};
use common::{coarse, garden, grown, over_seeds, quick, shipped};

const SEEDS: std::ops::Range<u64> = 1..11;

/// Mean heading along x of the wood grown in some steps.
fn heading_x(shot: &Snapshot, steps: std::ops::Range<u32>) -> f32 {
    let new = (0..shot.len())
        .filter(|&i| shot.state[i].kind() == OrganKind::Internode && steps.contains(&shot.span[i].born()));
    let (sum, length) =
        new.fold((0.0, 0.0), |(s, l), i| (s + shot.pose[i].heading().x * shot.length(i), l + shot.length(i)));
    sum / length
}

#[test]
fn the_crown_leans_to_the_lamp() {
    let trees = over_seeds(SEEDS, |seed| grown(coarse(shipped("lamp")), seed, 20).snapshot());
    let lean: Vec<f32> = trees.iter().map(|shot| wood_centroid(shot, 0).x).collect();
    let heading: Vec<f32> = trees.iter().map(|shot| heading_x(shot, 10..20)).collect();
    println!("lamp at x = 4 m: wood centred at {lean:.2?} m, the crown heads {heading:.2?} that way");
    assert!(heading.iter().all(|&x| x > 0.2), "every crown grows towards the lamp: {heading:?}");
    assert!(lean.iter().all(|&x| x > 0.2), "and every tree leans to it: {lean:?}");
}

#[test]
fn what_grows_after_the_lamp_has_moved_leans_the_other_way() {
    let turned = over_seeds(SEEDS, |seed| {
        let mut garden = grown(coarse(shipped("lamp_moved")), seed, 20);
        let before = heading_x(&garden.snapshot(), 10..20);
        for _ in 20..27 {
            garden.step().unwrap();
        }
        [before, heading_x(&garden.snapshot(), 23..27)]
    });
    println!("lamp moved: mean heading along x before and after {turned:.2?}");
    for [before, after] in turned {
        assert!(before > 0.0 && after < 0.0, "before {before}, after {after}");
    }
}

#[test]
fn a_tree_whose_only_lamp_goes_out_starves() {
    for seed in 1..4 {
        let mut resolved = coarse(shipped("lamp"));
        resolved.scenario.sky = Sky { strength: 0.0, ..resolved.scenario.sky };
        resolved.scenario.edits =
            vec![TimedEdit { step: 8, edit: Edit::Switch { name: "lamp".into(), on: false } }];
        let mut garden = grown(resolved, seed, 8);
        let lit = count(&garden.snapshot(), OrganKind::Leaf);
        let mut leaves = Vec::new();
        for _ in 0..15 {
            garden.step().unwrap();
            leaves.push(count(&garden.snapshot(), OrganKind::Leaf));
        }
        let plant = garden.snapshot().plants[0].clone().unwrap();
        println!("lamp off: {lit} leaves, then {leaves:?}, store {:.3}", plant.store.stored);
        assert_eq!((plant.ledger.income, plant.ledger.growth), (0.0, 0.0));
        assert!(lit > 5, "it lived by the lamp: {lit}");
        assert_eq!(leaves.last(), Some(&0), "{leaves:?}");
    }
}

#[test]
fn an_oak_in_a_courtyard_is_in_leaf_every_year() {
    let leaves = over_seeds(1..4, |seed| {
        let mut garden = garden(quick("courtyard"), seed);
        (0..26).map(|_| garden.step().unwrap().form.leaves).collect::<Vec<_>>()
    });
    println!("courtyard: leaves by step {leaves:?}");
    for leaves in leaves {
        // A lean year after a fat one is no more than half of it.
        for (i, pair) in leaves.windows(2).enumerate().skip(5) {
            assert!(2 * pair[1] > pair[0], "step {}: {} leaves after {}", i + 2, pair[1], pair[0]);
        }
    }
}

#[test]
fn no_branch_passes_through_a_solid_in_any_scenario() {
    for name in Library::embedded().scenario_names() {
        let mut resolved = coarse(shipped(&name));
        if resolved.scenario.solids.is_empty() {
            continue;
        }
        // Solids so near to a seedling that it cannot but grow against them, and buds that do not look out for room.
        for solid in &mut resolved.scenario.solids {
            solid.at += to_the_nearest_plant(solid, &resolved.scenario.plants);
        }
        for species in resolved.species.values_mut() {
            species.weight_space = 0.0;
        }
        let touching = over_seeds(0..100, |seed| {
            let mut garden = grown(resolved.clone(), seed, 6);
            let shot = garden.snapshot();
            if let Err(e) = check_solids(garden.world_mut(), &shot) {
                panic!("{name}, seed {seed}: {e}");
            }
            let mut solids = garden.world_mut().query::<(&Solid, &Transform)>();
            let solids = standing_solids(solids.iter(garden.world()));
            let near = |at: Vec3| solids.iter().any(|solid| distance_to(solid, at) < 0.01);
            (0..shot.len())
                .filter(|&i| {
                    shot.state[i].kind() == OrganKind::Internode && near(shot.pose[i].tip(shot.length(i)))
                })
                .count()
        });
        let trees = touching.iter().filter(|&&stems| stems > 0).count();
        println!("{name}: {trees} of 100 trees touch a solid, with {} stems", touching.iter().sum::<usize>());
        assert!(trees > 20, "{name}: only {trees} of 100 trees touch a solid");
    }
}

#[test]
fn no_branch_passes_through_a_solid_of_a_shipped_scenario_in_all_its_steps() {
    for (name, seeds) in [("figure_1d", 1..9), ("wall", 1..2), ("dusk", 1..2), ("courtyard", 1..2)] {
        let mut resolved = shipped(name);
        resolved.scenario.sensing.leaf_face = 3;
        resolved.scenario.sensing.bud_face = 4;
        let steps = resolved.scenario.steps;
        over_seeds(seeds, |seed| grow_past_solids(resolved.clone(), seed, steps));
    }
}

/// The way, level, that brings a solid to within a tenth of a metre of the plant nearest to it.
fn to_the_nearest_plant(solid: &PlacedSolid, plants: &[Planting]) -> Vec3 {
    let rotation = Quat::from_rotation_y(solid.turn_deg.to_radians());
    let moved =
        |way: Vec3| StandingSolid { shape: solid.shape, position: solid.at + way, rotation, color: [0.5; 3] };
    let gap = |way: Vec3, plant: &Planting| distance_to(&moved(way), plant.at + Vec3::Y * 0.1);
    let nearest =
        plants.iter().min_by(|a, b| gap(Vec3::ZERO, a).total_cmp(&gap(Vec3::ZERO, b))).expect("plants");
    let towards = (nearest.at - solid.at).with_y(0.0).normalize();
    (0..1000).map(|cm| towards * 0.01 * cm as f32).find(|way| gap(*way, nearest) <= 0.1).expect("a way there")
}

/// How far a point is from the surface of a solid, metres; 0 inside.
fn distance_to(solid: &StandingSolid, at: Vec3) -> f32 {
    let at = solid.rotation.inverse() * (at - solid.position);
    match solid.shape {
        SolidShape::Box { size } => (at.abs() - 0.5 * size).max(Vec3::ZERO).length(),
        SolidShape::Ball { radius } => (at.length() - radius).max(0.0),
        SolidShape::Cylinder { radius, height } => {
            let (out, up) = (at.with_y(0.0).length() - radius, at.y.abs() - 0.5 * height);
            Vec2::new(out.max(0.0), up.max(0.0)).length()
        }
    }
}

fn block(name: &str, at: Vec3, size: Vec3) -> PlacedSolid {
    PlacedSolid { name: name.into(), shape: SolidShape::Box { size }, at, ..default() }
}

/// A lam_king tree some steps old, and a block that would stand in the middle of a branch.
fn tree_and_block() -> (Garden, PlacedSolid, Snapshot) {
    let mut garden = grown(quick("figure_1c"), 3, 9);
    let shot = garden.snapshot();
    let branch = (0..shot.len())
        .find(|&i| shot.state[i].kind() == OrganKind::Internode && shot.order[i] == 2)
        .unwrap();
    garden.world_mut().resource_mut::<Fallen>().tombstones.clear();
    let middle = shot.pose[branch].tip(0.5 * shot.length(branch));
    (garden, block("block", middle, Vec3::splat(0.1)), shot)
}

fn assert_crushed(mut garden: Garden, before: &Snapshot, shed: usize) {
    let after = garden.snapshot();
    assert!(shed > 0 && after.len() == before.len() - shed && !after.is_empty());
    check(&after).unwrap();
    check_world(garden.world_mut()).unwrap();
    check_solids(garden.world_mut(), &after).unwrap();
    let fallen = &garden.world().resource::<Fallen>().tombstones;
    assert_eq!(fallen.len(), shed);
    assert!(fallen.iter().all(|t| t.cause == Cause::Crushed));
    garden.step().unwrap();
    check(&garden.snapshot()).unwrap();
}

#[test]
fn a_wall_set_on_living_wood_sheds_what_lies_inside_and_beyond() {
    let (mut garden, block, before) = tree_and_block();
    let outcome = apply(garden.world_mut(), &Edit::PlaceSolid(block)).unwrap();
    assert_crushed(garden, &before, outcome.shed);
}

#[test]
fn a_wall_moved_onto_living_wood_sheds_it_too() {
    let (mut garden, mut block, before) = tree_and_block();
    let to = std::mem::replace(&mut block.at, Vec3::new(50.0, 1.0, 0.0));
    assert_eq!(apply(garden.world_mut(), &Edit::PlaceSolid(block)).unwrap().shed, 0);
    let moved = Edit::Move { name: "block".into(), to, turn_deg: 30.0 };
    let outcome = apply(garden.world_mut(), &moved).unwrap();
    assert_crushed(garden, &before, outcome.shed);
}

#[test]
fn pruning_takes_a_branch_and_all_it_bears() {
    let mut garden = grown(quick("figure_1c"), 3, 9);
    let before = garden.snapshot();
    let cut = (0..before.len())
        .find(|&i| before.state[i].kind() == OrganKind::Internode && before.order[i] == 1)
        .unwrap();
    let mut goes = vec![false; before.len()];
    goes[cut] = true;
    for i in cut + 1..before.len() {
        goes[i] = before.parent[i] != burgeon::plant::NO_PARENT && goes[before.parent[i] as usize];
    }
    let stay: Vec<u32> = (0..before.len()).filter(|&i| !goes[i]).map(|i| before.birth[i]).collect();
    let edit = Edit::Prune { plant: 0, lineage: before.lineage[cut].0 };
    let outcome = apply(garden.world_mut(), &edit).unwrap();
    let after = garden.snapshot();
    assert!(outcome.shed > 1);
    assert_eq!(after.birth, stay);
    check(&after).unwrap();
    assert!(apply(garden.world_mut(), &edit).is_err(), "it is gone");
    for _ in 0..3 {
        garden.step().unwrap();
        check(&garden.snapshot()).unwrap();
    }
}

#[test]
fn topping_cuts_all_that_begins_above_a_height() {
    let mut garden = grown(quick("figure_1c"), 3, 8);
    assert!(apply(garden.world_mut(), &Edit::Top { plant: 0, above: 0.3 }).unwrap().shed > 0);
    let after = garden.snapshot();
    assert!(!after.is_empty() && after.pose.iter().all(|p| p.position.y < 0.3));
    check(&after).unwrap();
}

#[test]
fn shears_leave_nothing_outside_their_block_whichever_corners_name_it() {
    let (from, to) = (Vec3::new(0.25, -0.1, 0.3), Vec3::new(-0.3, 0.9, -0.25));
    let left = |from: Vec3, to: Vec3| {
        let mut garden = grown(quick("figure_1c"), 3, 9);
        assert!(apply(garden.world_mut(), &Edit::Shear { from, to }).unwrap().shed > 0);
        let after = garden.snapshot();
        check(&after).unwrap();
        after
    };
    let after = left(from, to);
    let inside = |p: Vec3| p.cmpge(from.min(to)).all() && p.cmple(from.max(to)).all();
    assert!(!after.is_empty());
    assert!((0..after.len()).all(|i| inside(after.pose[i].tip(after.length(i)))));
    assert_eq!(after, left(to, from));
}

/// Runs on a thread with a small stack, where deep recursion would overflow.
fn on_a_small_stack(task: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(512 << 10).spawn(task).unwrap().join().unwrap();
}

const LONG: usize = 20_000;

/// A stem of many internodes, one on another, with a leaf at its tip.
fn long_stem() -> Nursery {
    use burgeon::plant::{
        Attachment, BranchOrder, EnergyFlow, GrowsFrom, GrowthSpan, Internode, Lineage, NO_PARENT, Pose,
    };
    let mut nursery = Nursery::new(Species::default());
    let plant = nursery.plant;
    let world = nursery.app.world_mut();
    let mut below = (plant, NO_PARENT);
    for k in 0..LONG as u32 {
        let wood =
            Internode { length: 0.01, radius: 0.01, height_in_branch: 0.01 * (k + 1) as f32, ..default() };
        let pose = Pose { position: Vec3::Y * 0.01 * k as f32, rotation: Quat::IDENTITY };
        let entity = world
            .spawn((
                Identity { plant, birth: k, lineage: Lineage::SEED.child(k) },
                (GrowsFrom(below.0), GrowthSpan::step(0), BranchOrder(0), Attachment(Quat::IDENTITY)),
                (pose, EnergyFlow::default(), wood),
            ))
            .id();
        world.resource_mut::<Roster>().bear(entity, below.1, 0, OrganKind::Internode);
        below = (entity, k);
    }
    nursery
}

fn organs(nursery: &mut Nursery) -> (usize, usize) {
    let world = nursery.app.world_mut();
    (world.query::<&Identity>().iter(world).count(), world.resource::<Roster>().len())
}

#[test]
fn a_stem_of_twenty_thousand_internodes_is_cut_at_its_base() {
    on_a_small_stack(|| {
        let mut nursery = long_stem();
        assert_eq!(organs(&mut nursery), (LONG, LONG));
        assert_eq!(shed(nursery.app.world_mut(), &[(1, Cause::Pruned)]), LONG - 1);
        assert_eq!(organs(&mut nursery), (1, 1));
    });
}

#[test]
fn despawning_the_plant_of_a_long_stem_removes_it_all() {
    on_a_small_stack(|| {
        let mut nursery = long_stem();
        let plant = nursery.plant;
        nursery.app.world_mut().despawn(plant);
        assert_eq!(organs(&mut nursery), (0, 0));
    });
}

#[test]
fn despawning_the_base_of_a_long_stem_sheds_the_rest_in_the_next_step() {
    on_a_small_stack(|| {
        let mut nursery = long_stem();
        let base = nursery.all(OrganKind::Internode)[0];
        nursery.app.world_mut().despawn(base);
        burgeon::grow(nursery.app.world_mut(), 1);
        assert_eq!(organs(&mut nursery), (0, 0));
    });
}

/// A plain app with one tree a few steps old.
fn app_with_tree() -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, burgeon::BurgeonPlugins));
    let plant = app.world_mut().spawn((Plant::new(Species::default(), 1), Transform::default())).id();
    burgeon::grow(app.world_mut(), 4);
    (app, plant)
}

#[test]
fn a_plant_removed_by_any_means_takes_its_organs_along() {
    type Means = fn(&mut World, Entity);
    let means: [(&str, Means); 4] = [
        ("despawned", |world, plant| {
            world.despawn(plant);
        }),
        ("despawned by a command", |world, plant| {
            world.commands().entity(plant).despawn();
            world.flush();
        }),
        ("its component removed", |world, plant| {
            world.entity_mut(plant).remove::<Plant>();
            world.flush();
        }),
        ("its parent despawned", |world, plant| {
            let pot = world.spawn(Transform::default()).add_child(plant).id();
            world.despawn(pot);
        }),
    ];
    for (name, remove) in means {
        let (mut app, plant) = app_with_tree();
        let world = app.world_mut();
        assert!(world.query::<&Identity>().iter(world).count() > 10);
        remove(world, plant);
        assert_eq!(world.query::<&Identity>().iter(world).count(), 0, "{name}");
        assert!(world.resource::<Roster>().is_empty(), "{name}");
        let uprooted = world.resource::<Fallen>().tombstones.iter();
        assert!(uprooted.filter(|t| t.cause == Cause::Uprooted).count() > 10, "{name}");
        burgeon::grow(world, 1);
    }
}

#[test]
fn an_organ_despawned_from_outside_takes_what_it_bore_along() {
    let (mut app, _) = app_with_tree();
    let world = app.world_mut();
    let shot = Snapshot::take(world);
    let branch = (0..shot.len())
        .find(|&i| matches!(shot.state[i], OrganState::Internode(..)) && shot.order[i] == 1)
        .unwrap();
    let entity = world.resource::<Roster>().entity[branch];
    let borne: Vec<Entity> = world.get::<Bears>(entity).unwrap().iter().collect();
    assert!(!borne.is_empty());
    world.despawn(entity);
    burgeon::grow(world, 1);
    assert!(borne.iter().all(|&e| world.get_entity(e).is_err()));
    check_world(world).unwrap();
    check(&Snapshot::take(world)).unwrap();
}

#[test]
fn two_trees_together_are_both_smaller_than_alone() {
    let steps = 12;
    let mut resolved = coarse(shipped("two_oaks"));
    for (plant, x) in resolved.scenario.plants.iter_mut().zip([-0.4, 0.4]) {
        plant.at = Vec3::X * x;
    }
    let alone = |k: usize| -> ResolvedScenario {
        let plants: Vec<Planting> = vec![resolved.scenario.plants[k].clone()];
        let mut one = resolved.clone();
        one.scenario.plants = plants;
        one
    };
    let income = |shot: &Snapshot, plant: usize| shot.plants[plant].as_ref().unwrap().ledger.income;
    let mut smaller = 0;
    for seed in 1..6 {
        let together = grown(resolved.clone(), seed, steps).snapshot();
        let both = [income(&together, 0), income(&together, 1)];
        let free = [0, 1].map(|k| income(&grown(alone(k), seed, steps).snapshot(), 0));
        println!("two oaks: income together {both:.0?}, alone {free:.0?}");
        smaller += u32::from(both[0] < free[0]) + u32::from(both[1] < free[1]);
        assert!(both[0] + both[1] < free[0] + free[1]);
    }
    assert!(smaller >= 9, "{smaller} of 10 trees are smaller than alone");
}

#[test]
fn a_tree_beside_a_wall_grows_away_from_it() {
    let away = over_seeds(SEEDS, |seed| {
        let with = grown(quick("figure_1d"), seed, 8).snapshot();
        let without = grown(quick("figure_1c"), seed, 8).snapshot();
        let wood = |shot: &Snapshot| mean_position(shot, |i| shot.state[i].kind() == OrganKind::Internode).x;
        wood(&without) - wood(&with)
    });
    assert!(away.iter().all(|&x| x > 0.0), "{away:?}");
}

#[test]
fn edits_that_name_nothing_change_nothing() {
    let mut garden = grown(quick("lamp"), 1, 3);
    let before = garden.snapshot();
    let edits = [
        Edit::Switch { name: "sun".into(), on: false },
        Edit::Move { name: "wall".into(), to: Vec3::ZERO, turn_deg: 0.0 },
        Edit::Remove { name: "wall".into() },
        Edit::Prune { plant: 0, lineage: 1 },
        Edit::Top { plant: 9, above: 0.0 },
        Edit::Uproot { plant: 1 },
        Edit::PlaceSolid(block("lamp", Vec3::ZERO, Vec3::ONE)),
        Edit::PlaceSolid(block("far", Vec3::splat(f32::NAN), Vec3::ONE)),
    ];
    for edit in edits {
        assert!(apply(garden.world_mut(), &edit).is_err(), "{edit:?}");
        assert_eq!(garden.snapshot(), before);
    }
}

#[test]
fn what_is_moved_elsewhere_sheds_nothing_of_a_tree_that_leans_on_a_wall() {
    let mut resolved = quick("figure_1d");
    let wall = PlacedSolid {
        shape: SolidShape::Box { size: Vec3::new(0.2, 4.0, 6.0) },
        at: Vec3::new(-0.16, 2.0, 0.0),
        ..default()
    };
    resolved.scenario.solids = vec![wall];
    resolved.scenario.lamps =
        vec![PlacedLamp { name: "far".into(), at: Vec3::new(6.0, 3.0, 0.0), ..default() }];
    resolved.species.get_mut("lam_king").unwrap().twig_radius_m = 0.02;
    let mut garden = grown(resolved, 2, 9);
    let touching = |shot: &burgeon::plant::Snapshot| {
        (0..shot.len())
            .filter(|&i| match &shot.state[i] {
                OrganState::Internode(wood, _) => shot.pose[i].position.x - wood.radius < -0.06,
                _ => false,
            })
            .count()
    };
    assert!(touching(&garden.snapshot()) > 0, "its bark presses on the wall");
    let before = garden.organs();
    let world = garden.world_mut();
    let moved = Edit::Move { name: "far".into(), to: Vec3::new(6.0, 3.1, 0.0), turn_deg: 0.0 };
    assert_eq!(apply(world, &moved).unwrap().shed, 0);
    let copied = Edit::Duplicate { name: "far".into(), copy: "near".into(), to: Vec3::new(3.0, 3.0, 0.0) };
    assert_eq!(apply(world, &copied).unwrap().shed, 0);
    let ball = PlacedSolid {
        name: "ball".into(),
        shape: SolidShape::Ball { radius: 0.2 },
        at: Vec3::X * 9.0,
        ..default()
    };
    assert_eq!(apply(world, &Edit::PlaceSolid(ball)).unwrap().shed, 0);
    assert_eq!(garden.organs(), before);
}
