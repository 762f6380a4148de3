//! The shipped species: their size and form at ages, over five seeds, and how they answer to what stands beside them.

#[path = "../common/mod.rs"]
mod common;
mod forms;
mod long_lives;
mod neighbours;
mod plantings;

use bevy::math::ops;
use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::SolidShape;
use burgeon::files::ResolvedScenario;
use burgeon::plant::measure::Form;
use burgeon::plant::skeleton::Skeleton;
use burgeon::plant::{OrganKind, Snapshot};
use burgeon::scenario::{Edit, PlacedSolid, Scenario, TimedEdit, apply};
use burgeon::species::{Allocation, Species};
use common::check::grow_past_solids;
use common::{coarse, garden, over_seeds, shipped};

/// A plant of a species alone in the open.
fn alone(name: &str) -> ResolvedScenario {
    Library::embedded().alone(name).unwrap()
}

/// Names of the species that share energy by vigour and live by years and seasons: the trees and shrubs.
fn trees() -> Vec<String> {
    let library = Library::embedded();
    let grows = |name: &String| {
        let species = library.species(name).unwrap();
        species.allocation == Allocation::ByVigour && species.steps_per_year <= 4
    };
    library.species_names().into_iter().filter(grows).collect()
}

#[test]
fn every_species_says_what_it_is_and_where_its_figures_come_from() {
    let library = Library::embedded();
    assert!(trees().len() >= 12);
    for name in library.species_names() {
        let species = library.species(&name).unwrap();
        assert!(species.description.len() > 20 && species.source.len() > 20, "{name}");
    }
}

#[test]
fn what_is_bare_in_winter_bears_the_leaves_of_one_summer() {
    let library = Library::embedded();
    for name in trees().into_iter().filter(|name| !library.species(name).unwrap().evergreen) {
        let tree = last(alone(&name), 1, 9);
        let leaves = || (0..tree.len()).filter(|&i| tree.state[i].kind() == OrganKind::Leaf);
        assert!(leaves().count() > 20, "{name}");
        assert!(leaves().all(|leaf| tree.span[leaf].born() == 8), "{name}: the last of nine steps is step 8");
    }
}

#[test]
fn herbs_grow_up_in_a_season() {
    let library = Library::embedded();
    for (name, height, leaves) in [("lily", 0.9..1.5, 60..150), ("horneophyton", 0.12..0.22, 60..900)] {
        let season = library.species(name).unwrap().steps_per_year;
        let plants = over_seeds(1..6, |seed| last(alone(name), seed, season));
        for plant in &plants {
            let form = Form::of(plant, None);
            assert!(height.contains(&form.height_m), "{name}: {} m high", form.height_m);
            assert!(leaves.contains(&form.leaves), "{name}: {} leaves", form.leaves);
        }
        // What has grown up grows little more.
        let old = last(alone(name), 1, 3 * season);
        assert!(old.len() < 4 * plants[0].len(), "{name}: {} organs in its third season", old.len());
        let tips = |plant: &Snapshot| Form::of(plant, None).apical_buds;
        match name {
            "lily" => assert!(plants.iter().all(|lily| tips(lily) == 1), "one stem"),
            _ => assert!(plants.iter().map(tips).sum::<u32>() > 5 * 4, "its axes fork and fork again"),
        }
    }
}

#[test]
fn limbs_that_sag_go_through_no_wall() {
    for name in ["silver_birch", "norway_spruce", "weeping_willow"] {
        over_seeds(1..3, |seed| {
            let mut resolved = alone(name);
            resolved.scenario.solids = vec![
                PlacedSolid {
                    shape: SolidShape::Box { size: Vec3::new(0.3, 3.0, 4.0) },
                    at: Vec3::new(0.7, 1.5, 0.0),
                    ..default()
                },
                PlacedSolid {
                    name: "table".into(),
                    shape: SolidShape::Box { size: Vec3::new(1.2, 0.1, 2.0) },
                    at: Vec3::new(-1.0, 1.0, 0.0),
                    ..default()
                },
            ];
            grow_past_solids(resolved, seed, 10);
        });
    }
}

/// What a test needs of a scenario: the last snapshot.
fn last(resolved: ResolvedScenario, seed: u64, steps: u32) -> Snapshot {
    common::grown(resolved, seed, steps).snapshot()
}

/// A scenario with these plants of one species.
fn planted(name: &str, places: impl IntoIterator<Item = Vec3>) -> Scenario {
    let mut scenario = alone(name).scenario;
    let first = scenario.plants[0].clone();
    scenario.plants = places
        .into_iter()
        .enumerate()
        .map(|(seed, at)| burgeon::scenario::Planting { at, seed: seed as u64, ..first.clone() })
        .collect();
    scenario
}

/// Leaves of a plant after each step.
fn leaves_by_step(resolved: ResolvedScenario, seed: u64, steps: u32) -> Vec<usize> {
    let mut garden = garden(resolved, seed);
    (0..steps).map(|_| garden.step().unwrap().form.leaves as usize).collect()
}

#[test]
fn a_poor_old_oak_thins_its_crown_and_never_drops_it() {
    let crowns = over_seeds(1..21, |seed| {
        let mut resolved = coarse(alone("oak"));
        resolved.species.get_mut("oak").unwrap().leaf_income = 2.2;
        leaves_by_step(resolved, seed, 42)
    });
    // What is left of a crown from one year to the next, the worst first.
    let mut left: Vec<f64> = crowns
        .iter()
        .flat_map(|leaves| leaves[15..].windows(2).map(|pair| pair[1] as f64 / pair[0] as f64))
        .collect();
    left.sort_by(f64::total_cmp);
    println!("of {} years the worst leave {:.2?} of a crown", left.len(), &left[..8]);
    assert!(left[0] > 1.0 / 3.0 && left[left.len() / 100] > 0.5, "{:?}", &left[..8]);
    let mut old: Vec<usize> = crowns.iter().map(|leaves| leaves[41]).collect();
    old.sort_unstable();
    assert!(old[0] > 50 && old[10] > 200, "they live and grow: {old:?} leaves");
}

#[test]
fn broadleaved_stumps_sprout() {
    for name in ["oak", "weeping_willow"] {
        let regrown = |sprouting: Option<f32>| {
            let mut resolved = coarse(alone(name));
            let species = resolved.species.get_mut(name).unwrap();
            species.sprouting = sprouting.unwrap_or(species.sprouting);
            let stump = TimedEdit { step: 14, edit: Edit::Top { plant: 0, above: 0.15 } };
            resolved.scenario.edits = vec![stump];
            over_seeds(1..5, |seed| {
                let leaves = leaves_by_step(resolved.clone(), seed, 19);
                leaves[18]
            })
        };
        let (stump, bare) = (regrown(None), regrown(Some(0.0)));
        println!("{name}: five years after the cut {stump:?} leaves, without sprouting {bare:?}");
        assert!(stump.iter().all(|leaves| *leaves > 20), "{name}: {stump:?}");
        assert!(bare.contains(&0), "{name}: no stump was without living buds, so nothing is shown: {bare:?}");
    }
}

#[test]
fn three_palms_of_the_beach_lean_to_the_water() {
    for seed in 1..5 {
        let shot = last(shipped("beach"), seed, 20);
        let leans: Vec<f32> = (0..shot.plants.len() as u32)
            .map(|plant| {
                let trunk = Skeleton::of(&shot, plant).unwrap();
                let top = trunk.segments.iter().map(|stem| stem.tip()).max_by(|a, b| a.y.total_cmp(&b.y));
                let way = top.unwrap() - trunk.segments[0].pose.position;
                ops::atan2(way.x, way.y).to_degrees()
            })
            .collect();
        assert!(leans[..3].iter().all(|&lean| lean > 18.0), "{leans:?}");
        assert!(leans[3..].iter().all(|&lean| lean.abs() < 10.0), "{leans:?}");
    }
}
