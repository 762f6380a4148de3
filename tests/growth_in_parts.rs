//! A step grown in parts is the step grown whole, whatever the parts.

use std::time::{Duration, Instant};

use bevy::prelude::*;
use burgeon::environment::probe::Sensing;
use burgeon::growth::finish::StageTimes;
use burgeon::growth::parts::{PartOfStep, StepParts, finish_step, grow_in_parts};
use burgeon::prelude::*;

/// An oak between a wall and a lamp.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins))
        .insert_resource(Workers::new(2).unwrap())
        .insert_resource(Sensing { leaf_face: 4, bud_face: 6, ..default() });
    let oak = Species::named("oak").unwrap();
    let world = app.world_mut();
    world.spawn((Plant::new(oak, 7), Transform::from_xyz(0.5, 0.0, 0.0)));
    world.spawn((Solid::block(Vec3::new(4.0, 2.0, 0.2)), Transform::from_xyz(0.0, 1.0, -0.5)));
    world.spawn((Lamp::new(100.0, 0.2), Transform::from_xyz(2.0, 2.0, 0.0)));
    app
}

/// Grows one step in parts; how often this thread was needed, and whether others looked around.
fn step(world: &mut World, budget: Duration) -> (usize, bool) {
    let (mut parts, mut looked) = (0, false);
    let began = Instant::now();
    loop {
        assert!(began.elapsed() < Duration::from_secs(120), "a step that never ends");
        match grow_in_parts(world, budget) {
            PartOfStep::Finished => return (parts + 1, looked),
            PartOfStep::More => parts += 1,
            PartOfStep::Looking => {
                looked = true;
                assert!(world.resource::<StepParts>().is_under_way());
                std::thread::sleep(Duration::from_micros(200));
            }
        }
    }
}

#[test]
fn the_same_tree_in_parts_of_any_size() {
    const STEPS: u32 = 9;
    let mut whole = app();
    let expected: Vec<u64> = (0..STEPS)
        .map(|_| {
            grow(whole.world_mut(), 1);
            Snapshot::take(whole.world()).hash()
        })
        .collect();
    for budget in [Duration::ZERO, Duration::from_micros(300), Duration::from_secs(60)] {
        let mut app = app();
        for (k, &hash) in expected.iter().enumerate() {
            let (parts, looked) = step(app.world_mut(), budget);
            assert!(looked, "nobody looked around on another thread");
            if budget.is_zero() {
                assert!(parts > 15, "a part for each system, not {parts}");
            }
            assert_eq!(app.world().resource::<StepCount>().0, k as u32 + 1);
            assert_eq!(Snapshot::take(app.world()).hash(), hash, "{budget:?}, step {}", k + 1);
        }
        assert!(app.world().resource::<StageTimes>().seconds.iter().all(|&s| s > 0.0));
    }
}

/// What ran, in order.
#[derive(Resource, Default, Debug, PartialEq, Clone)]
struct Log(Vec<String>);

#[derive(Component)]
struct Mark;

fn log(what: &'static str) -> impl Fn(ResMut<Log>, Query<&Mark>) {
    move |mut log, marks| {
        let seen = format!("{what}, {} marked", marks.iter().len());
        log.0.push(seen);
    }
}

fn with_systems_of_the_host() -> App {
    let mut app = app();
    let mark = |mut commands: Commands, roster: Res<Roster>| {
        if let Some(&first) = roster.entity.first() {
            commands.entity(first).insert(Mark);
        }
    };
    app.init_resource::<Log>().add_systems(
        GrowthStep,
        (
            log("before all").before(Stage::Germinate),
            log("generate").in_set(Stage::Generate),
            log("first half").after(Stage::Generate).before(Stage::Update),
            (mark, log("marked")).chain().after(Stage::Update).before(Stage::Sense),
            log("sensed").after(Stage::Sense).before(Stage::Finish),
            log("every other").after(Stage::Finish).run_if(|step: Res<StepCount>| step.0.is_multiple_of(2)),
        ),
    );
    app
}

#[test]
fn systems_of_the_host_run_once_a_step_and_in_order() {
    let mut whole = with_systems_of_the_host();
    grow(whole.world_mut(), 6);
    let expected = whole.world().resource::<Log>();
    assert_eq!(expected.0.len(), 6 * 5 + 3);
    for budget in [Duration::ZERO, Duration::from_secs(60)] {
        let mut app = with_systems_of_the_host();
        for _ in 0..6 {
            step(app.world_mut(), budget);
        }
        assert_eq!(app.world().resource::<Log>(), expected);
        assert_eq!(Snapshot::take(app.world()).hash(), Snapshot::take(whole.world()).hash());
    }
}

#[test]
fn a_step_under_way_is_finished_before_others_begin() {
    let mut whole = app();
    grow(whole.world_mut(), 4);
    // However far it is.
    for parts in [1, 3, 9, 14] {
        let mut app = app();
        grow(app.world_mut(), 2);
        for _ in 0..parts {
            grow_in_parts(app.world_mut(), Duration::ZERO);
        }
        assert!(app.world().resource::<StepParts>().is_under_way());
        if parts == 3 {
            finish_step(app.world_mut());
            assert_eq!(app.world().resource::<StepCount>().0, 3);
        }
        grow(app.world_mut(), 1);
        assert_eq!(Snapshot::take(app.world()).step, 4);
        assert_eq!(Snapshot::take(app.world()).hash(), Snapshot::take(whole.world()).hash());
        assert!(!app.world().resource::<StepParts>().is_under_way());
    }
}

#[test]
fn what_the_host_takes_away_between_two_parts_is_gone() {
    // At every part of a step another plant goes, or a branch of the one that stays.
    for at in 0..40 {
        let mut app = app();
        let world = app.world_mut();
        let hazel = Species::named("hazel").unwrap();
        let other = world.spawn((Plant::new(hazel, 3), Transform::from_xyz(-2.0, 0.0, 0.0))).id();
        grow(world, 3);
        let mut gone = false;
        for part in 0.. {
            if part == at {
                world.despawn(other);
                let roster = world.resource::<Roster>();
                assert!(roster.plant.iter().all(|&plant| plant == 0), "the organs went with their plant");
                let tip = roster.entity[roster.len() / 2];
                world.despawn(tip);
                gone = true;
            }
            if grow_in_parts(world, Duration::ZERO) == PartOfStep::Finished {
                break;
            }
            std::thread::sleep(Duration::from_micros(100));
        }
        grow(world, 1);
        let shot = Snapshot::take(world);
        shot.check().unwrap();
        assert!(!gone || shot.plant.iter().all(|&plant| plant == 0), "part {at}");
    }
}
