//! Species and scenarios as assets of a running app, and files that change under it.
#![cfg(feature = "assets")]

use std::path::Path;
use std::time::{Duration, Instant};

use bevy::asset::AssetLoadFailedEvent;
use bevy::prelude::*;
use burgeon::assets::{NextSpecies, PlantAssetPlugin, ScenarioRoot, SpeciesRoot};
use burgeon::files::{FileError, ResolvedScenario};
use burgeon::prelude::*;

fn app(folder: &Path) -> App {
    let mut app = App::new();
    let assets = AssetPlugin { file_path: folder.display().to_string(), ..default() };
    app.add_plugins((MinimalPlugins, assets, BurgeonPlugins, PlantAssetPlugin))
        .insert_resource(Workers::new(1).unwrap())
        .insert_resource(burgeon::environment::probe::Sensing { leaf_face: 2, bud_face: 4, ..default() });
    app.finish();
    app.cleanup();
    app
}

/// Lets frames pass until something holds.
fn wait(app: &mut App, what: &str, holds: impl Fn(&mut World) -> bool) {
    let began = Instant::now();
    while !holds(app.world_mut()) {
        app.update();
        assert!(began.elapsed() < Duration::from_secs(30), "{what} never came");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn write(folder: &Path, file: &str, text: &str) {
    let file = folder.join(file);
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    std::fs::write(file, text).unwrap();
}

/// Says that a file has changed; with feature `hot_reload` the app sees so itself.
fn changed(app: &App, file: &'static str) {
    if cfg!(not(feature = "hot_reload")) {
        app.world().resource::<AssetServer>().reload(file);
    }
}

fn candidates(world: &World, plant: Entity) -> u32 {
    world.get::<Plant>(plant).unwrap().species.candidates
}

#[test]
fn a_plant_follows_its_species_file_from_the_next_step_on() {
    let folder = tempfile::tempdir().unwrap();
    const FILE: &str = "species/mine.ron";
    write(folder.path(), FILE, "(\n    version: 1,\n    name: \"mine\",\n    candidates: 9,\n)");
    let mut app = app(folder.path());
    let species = app.world().resource::<AssetServer>().load::<Species>(FILE);
    let plant = app.world_mut().spawn(SpeciesRoot { species: species.clone(), seed: 3 }).id();
    let twin = app.world_mut().spawn(SpeciesRoot { species: species.clone(), seed: 4 }).id();
    wait(&mut app, "the plant", |world| world.get::<Plant>(plant).is_some());
    assert_eq!((candidates(app.world(), plant), app.world().get::<Plant>(plant).unwrap().seed), (9, 3));
    grow(app.world_mut(), 2);
    let organs = app.world().resource::<Roster>().len();
    assert!(organs > 2);

    write(folder.path(), FILE, "(\n    version: 1,\n    name: \"mine\",\n    candidates: 5,\n)");
    changed(&app, FILE);
    wait(&mut app, "the change", |world| world.get::<NextSpecies>(plant).is_some());
    assert_eq!(candidates(app.world(), plant), 9, "not before the next step");
    assert_eq!(app.world().resource::<Roster>().len(), organs, "what has grown stays");
    grow(app.world_mut(), 1);
    assert_eq!((candidates(app.world(), plant), candidates(app.world(), twin)), (5, 5));
    assert!(app.world().get::<NextSpecies>(plant).is_none());
    let [one, other] = [plant, twin].map(|plant| app.world().get::<Plant>(plant).unwrap().species.clone());
    assert!(std::sync::Arc::ptr_eq(&one, &other), "plants of one kind share it");

    // A bad one: the old stays, and the error tells where and what.
    #[derive(Resource, Default)]
    struct Errors(Vec<String>);
    app.init_resource::<Errors>().add_systems(
        Update,
        |mut failed: MessageReader<AssetLoadFailedEvent<Species>>, mut errors: ResMut<Errors>| {
            errors.0.extend(failed.read().map(|event| event.error.to_string()));
        },
    );
    write(folder.path(), FILE, "(\n    version: 1,\n    name: \"mine\",\n    candidates: 1000,\n)");
    changed(&app, FILE);
    wait(&mut app, "the error", |world| !world.resource::<Errors>().0.is_empty());
    let error = app.world().resource::<Errors>().0[0].clone();
    assert!(error.contains("mine.ron:4") && error.contains("1000") && error.contains("256"), "{error}");
    grow(app.world_mut(), 1);
    assert_eq!(candidates(app.world(), plant), 5);
    assert_eq!(app.world().resource::<Assets<Species>>().get(&species).unwrap().candidates, 5);

    // And when it is mended, growth goes on with that.
    write(folder.path(), FILE, "(\n    version: 1,\n    name: \"mine\",\n    candidates: 7,\n)");
    changed(&app, FILE);
    wait(&mut app, "the mended file", |world| world.get::<NextSpecies>(plant).is_some());
    grow(app.world_mut(), 1);
    assert_eq!(candidates(app.world(), plant), 7);
}

const SCENARIO: &str = "scenarios/yard.ron";

fn yard(wall_at: f32, second: &str) -> String {
    format!(
        "(version: 1, name: \"yard\", ground: true,
    plants: [(species: \"mine.ron\", at: (0.0, 0.0, 0.0)), {second}],
    solids: [(name: \"wall\", at: ({wall_at:?}, 1.0, -1.0))],
    lamps: [(name: \"lamp\", at: (2.0, 2.0, 0.0))],
)"
    )
}

fn standing(world: &mut World) -> (usize, Vec<f32>, usize) {
    let plants = world.query::<&Plant>().iter(world).count();
    let walls = world.query::<(&Solid, &Transform)>().iter(world).map(|(_, at)| at.translation.x).collect();
    (plants, walls, world.query::<&Lamp>().iter(world).count())
}

#[test]
fn a_scenario_stands_in_the_world_and_follows_its_files() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scenarios/mine.ron", "(version: 1, name: \"mine\", candidates: 9)");
    write(folder.path(), SCENARIO, &yard(0.0, "(species: \"oak\", at: (5.0, 0.0, 0.0))"));
    let mut app = app(folder.path());
    let scenario = app.world().resource::<AssetServer>().load::<ResolvedScenario>(SCENARIO);
    let root = app.world_mut().spawn(ScenarioRoot { scenario, seed: 1 }).id();
    wait(&mut app, "the yard", |world| standing(world).0 == 2);
    assert_eq!(standing(app.world_mut()), (2, vec![0.0], 1));
    grow(app.world_mut(), 3);
    let first = app.world().resource::<Roster>().plants[0].unwrap();
    let of_first =
        |world: &mut World| world.query::<&Identity>().iter(world).filter(|i| i.plant == first).count();
    let grown = of_first(app.world_mut());
    assert!(grown > 2);
    let lamp = app.world_mut().query_filtered::<Entity, With<Lamp>>().single(app.world()).unwrap();

    // The wall moves, the oak is gone, a birch comes; the first plant, its species changed, grows on.
    write(folder.path(), "scenarios/mine.ron", "(version: 1, name: \"mine\", candidates: 5)");
    write(folder.path(), SCENARIO, &yard(3.0, "(species: \"silver_birch\", at: (-5.0, 0.0, 0.0))"));
    changed(&app, SCENARIO);
    wait(&mut app, "the other yard", |world| standing(world).1 == [3.0]);
    wait(&mut app, "the other species", |world| world.get::<NextSpecies>(first).is_some());
    assert_eq!(standing(app.world_mut()), (2, vec![3.0], 1));
    assert_eq!(of_first(app.world_mut()), grown);
    assert!(app.world().get_entity(lamp).is_ok(), "what is the same stays as it stands");
    assert!(
        app.world().resource::<Roster>().plant.iter().all(|&plant| plant == 0),
        "the oak went with its organs"
    );
    grow(app.world_mut(), 1);
    assert_eq!(candidates(app.world(), first), 5);

    app.world_mut().despawn(root);
    assert_eq!(standing(app.world_mut()), (0, vec![], 0));
    assert!(app.world().resource::<Roster>().is_empty());
}

#[test]
fn a_bad_scenario_is_refused_whole_with_its_line() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scenarios/outside.ron", "(\n  plants: [\n    (species: \"../mine.ron\"),\n  ],\n)");
    write(folder.path(), "scenarios/unknown.ron", "(\n  plants: [\n    (species: \"aok\"),\n  ],\n)");
    write(folder.path(), "scenarios/missing.ron", "(\n  plants: [\n    (species: \"none.ron\"),\n  ],\n)");
    let mut app = app(folder.path());
    for (file, wanted) in [
        ("scenarios/outside.ron", "outside.ron:3:15: `../mine.ron` leads out of the folder"),
        ("scenarios/unknown.ron", "did you mean `oak`"),
        ("scenarios/missing.ron", "scenarios/none.ron: cannot be read"),
    ] {
        let scenario = app.world().resource::<AssetServer>().load::<ResolvedScenario>(file);
        app.world_mut().spawn(ScenarioRoot { scenario: scenario.clone(), seed: 1 });
        let state = |world: &World| world.resource::<AssetServer>().load_state(&scenario);
        wait(&mut app, file, |world| state(world).is_failed());
        let bevy::asset::LoadState::Failed(error) = state(app.world()) else { unreachable!() };
        let error = error.to_string();
        assert!(error.contains(wanted), "{error}");
        assert_eq!(standing(app.world_mut()), (0, vec![], 0));
    }
    // The same words as from the command line.
    let error = Species::from_ron("(candidates: 0)", "x.ron").unwrap_err();
    assert!(matches!(error, FileError::Invalid { .. }));
}
