//! The window's own commands, played without a window.
#![cfg(feature = "viewer")]

use std::time::{Duration, Instant};

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::workers::Workers;
use burgeon::scenario::{Edit, Gardener, GardenerSettings, Order, Timeline};
use burgeon::viewer::{Action, Chosen, Course, Kind, Past, Shown, Toasts, Tool, ViewerLogic};

/// A small garden in the hands of a user, and a world without a window.
fn session() -> App {
    let library = Library::embedded();
    let mut resolved = library.scenario("figure_1d").unwrap();
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 4;
    let timeline = Timeline::new(resolved, 1, library, Workers::new(1).unwrap()).unwrap();
    let gardener = Gardener::start(timeline, GardenerSettings::default()).unwrap();
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ViewerLogic)).insert_resource(gardener);
    wait(&mut app, |world| world.resource::<Shown>().view.is_some());
    app
}

/// Lets time pass until something holds.
fn wait(app: &mut App, holds: impl Fn(&World) -> bool) {
    let began = Instant::now();
    while !holds(app.world()) {
        app.update();
        assert!(began.elapsed() < Duration::from_secs(60), "nothing came of it: {:?}", toasts(app));
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn toasts(app: &mut App) -> Vec<String> {
    app.world_mut().resource_mut::<Toasts>().current().iter().map(|toast| toast.text.clone()).collect()
}

fn act(app: &mut App, action: Action) {
    app.world_mut().write_message(action);
    app.update();
}

fn grow(app: &mut App, steps: u32) {
    for _ in 0..steps {
        let next = app.world().resource::<Course>().progress.present + 1;
        act(app, Action::Tell(Order::Step));
        wait(app, |world| world.resource::<Course>().progress.present == next);
    }
}

fn hash(app: &App) -> u64 {
    app.world().resource::<Shown>().view.as_ref().unwrap().shot.hash()
}

fn things(world: &World) -> usize {
    let standing = &world.resource::<Shown>().view.as_ref().unwrap().standing;
    standing.solids.len() + standing.lamps.len()
}

#[test]
fn place_move_crush_prune_undo_redo_scrub_fork_save_load() {
    let mut app = session();
    grow(&mut app, 4);
    let (before, stood) = (hash(&app), things(app.world()));

    act(&mut app, Action::Take(Tool::Place(Kind::Lamp)));
    act(&mut app, Action::Place(Kind::Lamp, Vec3::new(2.0, 0.0, 1.0)));
    wait(&mut app, |world| things(world) == stood + 1);
    let Chosen::Thing(lamp) = app.world().resource::<Chosen>().clone() else {
        panic!("what was set is chosen");
    };
    assert_eq!(*app.world().resource::<Tool>(), Tool::Choose, "and the pointer can move it at once");

    let to = Vec3::new(1.0, 2.0, 0.0);
    act(
        &mut app,
        Action::Edit(Edit::Pose { name: lamp.clone(), to, rotation_deg: Vec3::ZERO, scale: Vec3::ONE }),
    );
    wait(&mut app, |world| {
        let standing = &world.resource::<Shown>().view.as_ref().unwrap().standing;
        standing.lamps.iter().any(|l| l.name == lamp && l.position == to)
    });

    let organs = app.world().resource::<Course>().progress.organs;
    act(&mut app, Action::Place(Kind::Ball, Vec3::ZERO));
    wait(&mut app, |world| world.resource::<Course>().progress.organs < organs);
    act(&mut app, Action::Tell(Order::Undo));
    wait(&mut app, |world| world.resource::<Course>().progress.organs == organs);

    let last = *app.world().resource::<Shown>().view.as_ref().unwrap().shot.birth.last().unwrap();
    act(&mut app, Action::Prune(last));
    wait(&mut app, |world| world.resource::<Course>().progress.organs < organs);
    act(&mut app, Action::Tell(Order::Undo));
    act(&mut app, Action::Tell(Order::Undo));
    act(&mut app, Action::Tell(Order::Undo));
    wait(&mut app, |world| things(world) == stood);
    assert_eq!(hash(&app), before, "undone, it is the tree it was");
    act(&mut app, Action::Tell(Order::Redo));
    wait(&mut app, |world| things(world) == stood + 1);

    grow(&mut app, 2);
    act(&mut app, Action::Look(Some(3)));
    wait(&mut app, |world| world.resource::<Shown>().view.as_ref().unwrap().step == 3);
    assert_eq!(app.world().resource::<Past>().0, Some(3));
    act(&mut app, Action::Ghost(true));
    act(&mut app, Action::Place(Kind::Wall, Vec3::new(-1.0, 0.0, 0.0)));
    wait(&mut app, |world| {
        let progress = &world.resource::<Course>().progress;
        progress.catching_up.is_none() && progress.present == 6 && world.resource::<Shown>().ghost.is_some()
    });
    assert_eq!(app.world().resource::<Past>().0, None, "the picture follows growth again");

    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("garden.burgeon");
    let kept = hash(&app);
    act(&mut app, Action::Tell(Order::Save(file.clone())));
    wait(&mut app, |_| file.exists());
    act(&mut app, Action::Begin("figure_1a".into()));
    wait(&mut app, |world| world.resource::<Course>().progress.present == 0);
    act(&mut app, Action::Tell(Order::Load(file)));
    wait(&mut app, |world| world.resource::<Course>().progress.present == 6);
    assert_eq!(hash(&app), kept);
}

#[test]
fn what_does_not_work_is_told_and_changes_nothing() {
    let mut app = session();
    grow(&mut app, 2);
    let before = hash(&app);
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.ron");
    std::fs::write(&bad, "(version: 1, name: 7").unwrap();
    for action in [
        Action::Tell(Order::Load(bad)),
        Action::Tell(Order::Load(folder.path().join("none.burgeon"))),
        Action::Tell(Order::LoadCode("no code at all".into())),
        Action::Begin("no such scenario".into()),
        Action::Tell(Order::Save(folder.path().join("no/such/folder/x.burgeon"))),
        Action::Tell(Order::Undo),
    ] {
        act(&mut app, action.clone());
        let began = Instant::now();
        while toasts(&mut app).is_empty() {
            app.update();
            assert!(began.elapsed() < Duration::from_secs(20), "{action:?} says nothing");
        }
        *app.world_mut().resource_mut::<Toasts>() = Toasts::default();
    }
    assert_eq!(hash(&app), before);
    grow(&mut app, 1);
}
