//! Plants that grow and are drawn in an app's own world, frame by frame, without a graphics card.
#![cfg(feature = "render")]

use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::ecs::entity::EntityHashMap;
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::settings::{RenderCreation, WgpuSettings};
use bevy::time::TimeUpdateStrategy;
use burgeon::environment::SolidShape;
use burgeon::environment::probe::Sensing;
use burgeon::growth::parts::StepParts;
use burgeon::prelude::*;
use burgeon::render::{
    Drawn, GrowthPace, LiveGarden, LiveGrowthPlugin, PlantRenderPlugin, Stage, StepFraction,
};
use burgeon::scenario::{Edit, PlacedSolid, apply};

const FRAME: Duration = Duration::from_millis(20);

fn garden(app: &mut App) -> Entity {
    app.add_plugins(BurgeonPlugins).insert_resource(Workers::new(2).unwrap()).insert_resource(Sensing {
        leaf_face: 4,
        bud_face: 6,
        ..default()
    });
    let world = app.world_mut();
    let oak = world.spawn((Plant::new(Species::named("oak").unwrap(), 7), Transform::default())).id();
    world.spawn((Solid::block(Vec3::new(4.0, 2.0, 0.2)), Transform::from_xyz(0.0, 1.0, -0.5)));
    world.spawn((Lamp::new(100.0, 0.2), Transform::from_xyz(2.0, 2.0, 0.0)));
    oak
}

/// A garden that grows while frames of [`FRAME`] pass.
fn live(pace: GrowthPace) -> (App, Entity) {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins);
    let oak = garden(&mut app);
    app.add_plugins(LiveGrowthPlugin)
        .insert_resource(pace)
        .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
    (app, oak)
}

/// One frame, and the time in which other threads get on.
fn frame(app: &mut App) {
    app.update();
    std::thread::sleep(Duration::from_micros(500));
}

/// Lets frames pass until something holds; how many.
fn frames(app: &mut App, holds: impl Fn(&mut World) -> bool) -> usize {
    let began = Instant::now();
    for frames in 0.. {
        if holds(app.world_mut()) {
            return frames;
        }
        frame(app);
        assert!(began.elapsed() < Duration::from_secs(120), "nothing came of it");
    }
    unreachable!()
}

fn drawn(world: &mut World) -> Option<Drawn> {
    world.query_filtered::<&Drawn, With<LiveGarden>>().iter(world).next().cloned()
}

fn shown_step(world: &mut World) -> u32 {
    drawn(world).map_or(0, |drawn| drawn.now.step)
}

#[test]
fn a_plant_grown_live_is_the_plant_grown_headless() {
    let mut headless = App::new();
    headless.add_plugins(MinimalPlugins);
    garden(&mut headless);
    let expected: Vec<u64> = (0..8)
        .map(|_| {
            grow(headless.world_mut(), 1);
            Snapshot::take(headless.world()).hash()
        })
        .collect();
    for milliseconds_per_frame in [0.0, 4.0] {
        let (mut app, _) = live(GrowthPace { steps_per_second: 10.0, milliseconds_per_frame, ..default() });
        for (k, &hash) in expected.iter().enumerate() {
            frames(&mut app, |world| shown_step(world) == k as u32 + 1);
            assert_eq!(drawn(app.world_mut()).unwrap().now.hash(), hash, "step {}", k + 1);
        }
    }
}

#[test]
fn no_frame_waits_for_a_step() {
    let (mut app, _) = live(GrowthPace { steps_per_second: 1000.0, ..default() });
    // Looking around takes long: through fine faces, on one thread.
    app.insert_resource(Workers::new(1).unwrap()).insert_resource(Sensing {
        leaf_face: 48,
        bud_face: 48,
        ..default()
    });
    frames(&mut app, |world| shown_step(world) == 7);
    let (mut worst, mut looking) = (Duration::ZERO, 0);
    frames(&mut app, |world| world.resource::<StepParts>().is_under_way());
    let began = Instant::now();
    while app.world().resource::<StepParts>().is_under_way() {
        let frame_began = Instant::now();
        app.update();
        worst = worst.max(frame_began.elapsed());
        looking += 1;
        std::thread::sleep(Duration::from_millis(1));
    }
    let step = began.elapsed();
    assert!(looking > 10, "a step of {step:?} in {looking} frames");
    assert!(worst < step / 3, "a frame took {worst:?} of a step of {step:?}");
}

#[test]
fn the_pace_is_kept_and_nothing_is_made_up_for() {
    let (mut app, _) = live(GrowthPace { steps_per_second: 5.0, ..default() });
    frames(&mut app, |world| shown_step(world) == 2);
    // Five steps a second are ten frames a step, and the picture moves with each.
    const WATCHED: usize = 5;
    for k in 0..3 {
        let next = shown_step(app.world_mut()) + 1;
        let mut last = -1.0;
        let taken = frames(&mut app, |world| shown_step(world) == next) + if k > 0 { WATCHED } else { 0 };
        assert!((9..=40).contains(&taken), "{taken} frames");
        for _ in 0..WATCHED {
            let fraction = app.world_mut().query::<&StepFraction>().single(app.world()).unwrap().0;
            assert!(fraction > last && fraction < 1.0);
            last = fraction;
            frame(&mut app);
        }
    }
    app.world_mut().resource_mut::<GrowthPace>().paused = true;
    let step = shown_step(app.world_mut());
    for _ in 0..100 {
        frame(&mut app);
    }
    assert_eq!(shown_step(app.world_mut()), step);
    let grown = app.world().resource::<StepCount>().0;
    assert!(grown <= step + 1, "it grew on while it stood still");
    // A second in one frame is one step, not five.
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(1)));
    app.world_mut().resource_mut::<GrowthPace>().paused = false;
    frames(&mut app, |world| shown_step(world) > step);
    assert_eq!(shown_step(app.world_mut()), step + 1);
}

#[test]
fn a_step_the_host_grows_itself_comes_after_the_one_under_way() {
    let (mut app, _) = live(GrowthPace { steps_per_second: 100.0, ..default() });
    frames(&mut app, |world| world.resource::<StepParts>().is_under_way() && shown_step(world) >= 3);
    let before = app.world().resource::<StepCount>().0;
    grow(app.world_mut(), 2);
    assert_eq!(app.world().resource::<StepCount>().0, before + 3);
    frames(&mut app, |world| shown_step(world) >= before + 4);
    let shot = drawn(app.world_mut()).unwrap().now;
    shot.check().unwrap();
}

#[test]
fn at_a_limit_growth_stands_still_and_keeps_what_has_grown() {
    let (mut app, _) = live(GrowthPace { steps_per_second: 100.0, ..default() });
    app.insert_resource(burgeon::limits::GrowthLimits { steps: 3, ..default() });
    frames(&mut app, |world| shown_step(world) == 3);
    for _ in 0..50 {
        frame(&mut app);
    }
    assert_eq!(app.world().resource::<StepCount>().0, 3);
    app.insert_resource(burgeon::limits::GrowthLimits::default());
    frames(&mut app, |world| shown_step(world) == 5);
}

/// The same with everything that draws, and no graphics card to draw with.
fn live_and_drawn() -> (App, Entity) {
    let mut app = App::new();
    let nothing = WgpuSettings { backends: None, ..default() };
    let plugins = DefaultPlugins
        .build()
        .disable::<bevy::log::LogPlugin>()
        .set(RenderPlugin { render_creation: RenderCreation::Automatic(Box::new(nothing)), ..default() });
    #[cfg(feature = "viewer")]
    let plugins = plugins.disable::<bevy::winit::WinitPlugin>();
    app.add_plugins(plugins);
    let oak = garden(&mut app);
    app.add_plugins((PlantRenderPlugin, LiveGrowthPlugin))
        .insert_resource(GrowthPace { steps_per_second: 10.0, ..default() })
        .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
    app.finish();
    app.cleanup();
    (app, oak)
}

fn drawn_meshes(world: &mut World) -> Vec<Entity> {
    world.query_filtered::<Entity, With<Mesh3d>>().iter(world).collect()
}

fn meshes(world: &mut World) -> usize {
    drawn_meshes(world).len()
}

#[test]
fn what_is_drawn_stays_for_some_frames_beside_what_takes_its_place() {
    let (mut app, oak) = live_and_drawn();
    frames(&mut app, |world| shown_step(world) >= 9);
    let grown = drawn(app.world_mut()).unwrap().now;
    app.world_mut().despawn(oak);
    frames(&mut app, |world| meshes(world) == 0);

    let mut young = App::new();
    young.add_plugins(MinimalPlugins);
    garden(&mut young);
    grow(young.world_mut(), 3);
    let young = Snapshot::take(young.world());
    let set_out = app.world_mut().spawn(Drawn::still(young)).id();
    let settled = move |world: &mut World| world.get::<Stage>(set_out).is_some_and(Stage::is_settled);
    frames(&mut app, settled);
    let old = drawn_meshes(app.world_mut());
    app.world_mut().entity_mut(set_out).insert(Drawn::still(grown));
    // So much larger that it is drawn from other buffers: nothing goes before the new has been there for a while.
    let is_old = move |world: &mut World| old.iter().filter(|mesh| world.entities().contains(**mesh)).count();
    let before = is_old(app.world_mut());
    frames(&mut app, |world| meshes(world) > before);
    assert_eq!(is_old(app.world_mut()), before);
    let beside = frames(&mut app, |world| is_old(world) < before);
    assert!((5..20).contains(&beside), "{beside} frames");
    assert_eq!(is_old(app.world_mut()), 0);
    frames(&mut app, settled);
}

#[test]
fn a_mesh_on_screen_never_becomes_another() {
    // It would be drawn for a frame with the material or the records of the one it was.
    #[derive(Resource, Default)]
    struct Seen(EntityHashMap<Handle<Mesh>>);
    fn watch(meshes: Query<(Entity, &Mesh3d)>, mut seen: ResMut<Seen>) {
        for (entity, mesh) in &meshes {
            assert_eq!(seen.0.entry(entity).or_insert(mesh.0.clone()), &mesh.0);
        }
    }
    let (mut app, _) = live_and_drawn();
    app.init_resource::<Seen>().add_systems(Last, watch);
    frames(&mut app, |world| shown_step(world) >= 10);
    let grown = drawn(app.world_mut()).unwrap();
    app.world_mut().resource_mut::<GrowthPace>().paused = true;
    let garden = app.world_mut().query_filtered::<Entity, With<LiveGarden>>().single(app.world()).unwrap();
    // Back and forth between the steps, as along a timeline.
    for shot in [&grown.before, &grown.now, &grown.before] {
        app.world_mut().entity_mut(garden).insert(Drawn::still(shot.clone()));
        (0..10).for_each(|_| frame(&mut app));
    }
    let Seen(seen) = app.world_mut().remove_resource().unwrap();
    assert!(seen.len() > meshes(app.world_mut()), "no mesh ever went");
}

#[test]
fn of_a_plant_that_is_crushed_whole_no_mesh_is_left_though_growth_stands_still() {
    let mut garden = App::new();
    garden.add_plugins(MinimalPlugins);
    self::garden(&mut garden);
    grow(garden.world_mut(), 7);
    let grown = Arc::new(Snapshot::take(garden.world()));
    let press =
        PlacedSolid { name: "press".into(), shape: SolidShape::Box { size: Vec3::splat(50.0) }, ..default() };
    let outcome = apply(garden.world_mut(), &Edit::PlaceSolid(press)).unwrap();
    let crushed = Arc::new(Snapshot::take(garden.world()));
    assert_eq!((outcome.shed, crushed.len()), (grown.len(), 0));

    for frame_seconds in [0.02, 0.4] {
        let (mut app, _) = live_and_drawn();
        app.world_mut().resource_mut::<GrowthPace>().paused = true;
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(frame_seconds)));
        let shown = app.world_mut().spawn(Drawn::still(grown.clone())).id();
        let settled = move |world: &mut World| world.get::<Stage>(shown).is_some_and(Stage::is_settled);
        frames(&mut app, settled);
        let of_it = move |world: &mut World| {
            world.query_filtered::<&ChildOf, With<Mesh3d>>().iter(world).filter(|of| of.0 == shown).count()
        };
        assert!(of_it(app.world_mut()) > 0);
        let falls = Drawn { before: grown.clone(), now: crushed.clone() };
        app.world_mut().entity_mut(shown).insert((falls, StepFraction(0.5)));
        frame(&mut app);
        frames(&mut app, settled);
        assert!(of_it(app.world_mut()) > 0, "it falls before it is gone");
        app.world_mut().entity_mut(shown).insert(StepFraction(1.0));
        frames(&mut app, move |world| of_it(world) == 0);
        // Back again, as along a timeline.
        app.world_mut().entity_mut(shown).insert(StepFraction(0.5));
        frames(&mut app, move |world| of_it(world) > 0);
    }
}

#[test]
fn a_frame_that_is_slow_anyway_shows_what_is_there() {
    let (mut app, _) = live_and_drawn();
    frames(&mut app, |world| shown_step(world) >= 10);
    let grown = drawn(app.world_mut()).unwrap().now;
    assert!(grown.len() > 1500, "{} organs are packed at once in any case", grown.len());
    app.world_mut().resource_mut::<GrowthPace>().paused = true;
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs(1)));
    let other = app.world_mut().spawn(Drawn::still(grown)).id();
    for _ in 0..2 {
        app.update();
    }
    assert!(app.world().get::<Stage>(other).is_some_and(Stage::is_settled));
}

#[test]
fn a_plant_that_is_despawned_takes_its_organs_and_meshes_along() {
    let (mut app, oak) = live_and_drawn();
    let hazel = Plant::new(Species::named("hazel").unwrap(), 2);
    let hazel = app.world_mut().spawn((hazel, Transform::from_xyz(3.0, 0.0, 0.0))).id();
    frames(&mut app, |world| shown_step(world) >= 5 && meshes(world) > 0);
    let both = meshes(app.world_mut());

    app.world_mut().despawn(oak);
    let world = app.world_mut();
    assert!(!world.resource::<Roster>().is_empty());
    let mut organs = world.query::<&Identity>();
    assert!(organs.iter(world).all(|organ| organ.plant == hazel), "an organ without a plant");
    // It is out of the picture with the next frame that can draw without it, not with the next step.
    app.world_mut().resource_mut::<GrowthPace>().paused = true;
    frames(&mut app, |world| meshes(world) < both);
    let shot = drawn(app.world_mut()).unwrap();
    assert!(shot.now.plants[0].is_none() && shot.now.plant.iter().all(|&plant| plant == 1));
    shot.now.check().unwrap();
    shot.before.check().unwrap();

    app.world_mut().resource_mut::<GrowthPace>().paused = false;
    let step = shown_step(app.world_mut());
    frames(&mut app, |world| shown_step(world) == step + 2);
    app.world_mut().despawn(hazel);
    frames(&mut app, |world| meshes(world) == 0);
    let world = app.world_mut();
    assert!(world.resource::<Roster>().is_empty());
    assert_eq!(world.query::<&Identity>().iter(world).count(), 0);
}
