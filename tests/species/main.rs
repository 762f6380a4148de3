//! The shipped species: their size and form at ages, over five seeds, and how they answer to what stands beside them.

#[path = "../common/mod.rs"]
mod common;
mod forms;
mod neighbours;

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::SolidShape;
use burgeon::files::ResolvedScenario;
use burgeon::plant::Snapshot;
use burgeon::scenario::{PlacedSolid, Scenario};
use burgeon::species::Allocation;
use common::check::check_solids;
use common::{garden, over_seeds};

/// A plant of a species alone in the open.
fn alone(name: &str) -> ResolvedScenario {
    Library::embedded().alone(name).unwrap()
}

/// Names of the species that share energy by vigour: the trees and shrubs.
fn trees() -> Vec<String> {
    let library = Library::embedded();
    let grows = |name: &String| library.species(name).unwrap().allocation == Allocation::ByVigour;
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
            let mut garden = garden(resolved, seed);
            for step in 0..10 {
                garden.step().unwrap();
                let shot = garden.snapshot();
                check_solids(garden.world_mut(), &shot)
                    .unwrap_or_else(|why| panic!("{name}, seed {seed}, step {step}: {why}"));
            }
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
