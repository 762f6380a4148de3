//! The window's own commands, played without a window.
#![cfg(feature = "viewer")]

#[path = "viewer/things.rs"]
mod things;

use std::path::Path;
use std::time::{Duration, Instant};

use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput};
use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::settings::WgpuSettings;
use bevy::render::sync_world::SyncWorldPlugin;
use bevy::window::{FileDragAndDrop, WindowResized, WindowResolution};
use burgeon::assets::Library;
use burgeon::environment::workers::Workers;
use burgeon::render::OutdoorCamera;
use burgeon::scenario::{Edit, Gardener, GardenerSettings, Order, Sessions, Timeline};
use burgeon::viewer::{
    Action, Ask, Chosen, Course, Files, Kind, Past, Recent, Shown, Toasts, Tool, ViewFrom, ViewerLogic,
    ViewerWindow,
};

/// A small garden.
fn gardener(settings: GardenerSettings) -> Gardener {
    let library = Library::embedded();
    let mut resolved = library.scenario("figure_1d").unwrap();
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 4;
    let timeline = Timeline::new(resolved, 1, library, Workers::new(1).unwrap()).unwrap();
    Gardener::start(timeline, settings).unwrap()
}

/// A small garden in the hands of a user, and a world without a window.
fn session() -> App {
    session_of(GardenerSettings::default())
}

fn session_of(settings: GardenerSettings) -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, ViewerLogic)).insert_resource(gardener(settings));
    wait(&mut app, |world| world.resource::<Shown>().view.is_some());
    app
}

/// The whole window, panels and camera and all, but neither a display nor a graphics card.
fn window(width: u32, height: u32, folder: &Path) -> App {
    let mut app = App::new();
    let nothing = WgpuSettings { backends: None, ..default() };
    let window = Window { resolution: WindowResolution::new(width, height), ..default() };
    app.add_plugins(
        DefaultPlugins
            .build()
            .disable::<bevy::winit::WinitPlugin>()
            .disable::<bevy::log::LogPlugin>()
            .set(RenderPlugin { render_creation: nothing.into(), ..default() })
            .set(WindowPlugin { primary_window: Some(window), ..default() }),
    );
    // Without a graphics card nothing else adds it, and things that go ask for it.
    app.add_plugins(SyncWorldPlugin);
    app.add_plugins(ViewerWindow {
        library: Library::embedded(),
        scenario: "figure_1d".into(),
        panels: true,
        hint: true,
        folder: folder.into(),
    })
    .insert_resource(gardener(GardenerSettings::default()));
    app.finish();
    app.cleanup();
    wait(&mut app, |world| world.resource::<Shown>().view.is_some());
    app
}

/// The camera, once it has come to rest.
fn at_rest(app: &mut App) -> Transform {
    let began = Instant::now();
    let (mut last, mut still) = (camera(app), 0);
    while still < 50 {
        app.update();
        let now = camera(app);
        still = if now == last { still + 1 } else { 0 };
        last = now;
        assert!(began.elapsed() < Duration::from_secs(60), "the camera moves on and on");
    }
    last
}

fn camera(app: &mut App) -> Transform {
    let world = app.world_mut();
    *world.query_filtered::<&Transform, With<OutdoorCamera>>().single(world).unwrap()
}

fn resize(app: &mut App, width: f32, height: f32) {
    let world = app.world_mut();
    let (window, mut of) = world.query::<(Entity, &mut Window)>().single_mut(world).unwrap();
    of.resolution.set(width, height);
    world.write_message(WindowResized { window, width, height });
}

/// Presses some keys together and lets them go.
fn press(app: &mut App, keys: &[(KeyCode, Key)]) {
    let world = app.world_mut();
    let window = world.query_filtered::<Entity, With<Window>>().single(world).unwrap();
    for state in [ButtonState::Pressed, ButtonState::Released] {
        for (key_code, logical_key) in keys.iter().cloned() {
            let (text, repeat) = (None, false);
            let input = KeyboardInput { key_code, logical_key, state, text, repeat, window };
            app.world_mut().write_message(input);
        }
        app.update();
    }
}

fn with_control(code: KeyCode, letter: &str) -> [(KeyCode, Key); 2] {
    [(KeyCode::ControlLeft, Key::Control), (code, Key::Character(letter.into()))]
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
    let wall = app.world().resource::<Shown>().view.as_ref().unwrap().standing.solids[0].name.clone();
    *app.world_mut().resource_mut::<Chosen>() = Chosen::Thing(wall.clone());
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
    assert_eq!(*app.world().resource::<Chosen>(), Chosen::Thing(wall), "what was chosen still is");
    grow(&mut app, 1);
}

#[test]
fn a_window_of_no_size_goes_on_and_comes_back() {
    // Where it looks in the end is where a window looks that never was so small.
    let whole = [1280.0, 720.0];
    let [small, never] = [[[0.0, 0.0], [1280.0, 0.0], [0.0, 720.0], [1.0, 1.0]], [whole; 4]].map(|sizes| {
        let folder = tempfile::tempdir().unwrap();
        let mut app = window(1280, 720, folder.path());
        for [width, height] in sizes {
            resize(&mut app, width, height);
            // All that has to do with the size of the window.
            act(&mut app, Action::Frame);
            act(&mut app, Action::From(ViewFrom::Top));
            act(&mut app, Action::Place(Kind::Lamp, Vec3::new(1.0, 0.0, 1.0)));
            act(&mut app, Action::Ask(Ask::Open));
            grow(&mut app, 1);
            for _ in 0..10 {
                app.update();
            }
            assert!(camera(&mut app).is_finite(), "{width} x {height}");
        }
        assert_eq!(app.world().resource::<Course>().progress.present, 4);
        resize(&mut app, whole[0], whole[1]);
        act(&mut app, Action::From(ViewFrom::Front));
        at_rest(&mut app)
    });
    assert!(small.translation.distance(never.translation) < 0.01, "{small:?}, not {never:?}");
}

#[test]
fn another_garden_is_looked_at_from_its_best_side_and_goes_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = window(1280, 720, folder.path());
    for _ in 0..5 {
        app.update();
    }
    act(&mut app, Action::Begin("wall".into()));
    wait(&mut app, |world| world.resource::<Course>().scenario == "wall");
    for _ in 0..5 {
        app.update();
    }
    // The wall runs along z and stands at the left: the tree leans to the right.
    let right = camera(&mut app).right();
    assert!(right.x > 0.85, "{right:?}");
    let file = folder.path().join("mine.ron");
    std::fs::write(&file, "(plants: [(species: \"oak\")])").unwrap();
    let window = app.world_mut().query_filtered::<Entity, With<Window>>().single(app.world()).unwrap();
    app.world_mut().write_message(FileDragAndDrop::DroppedFile { window, path_buf: file });
    wait(&mut app, |world| world.resource::<Course>().scenario == "mine");
}

#[test]
fn what_cannot_be_written_is_told_and_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file.txt"), "kept").unwrap();
    // No folder can lie in a file, whoever asks.
    let nowhere = folder.path().join("file.txt/x");
    let autosave = Some((Sessions::new(nowhere.join("sessions")).begin(), Duration::from_millis(1)));
    let mut app = session_of(GardenerSettings { autosave, ..default() });
    act(&mut app, Action::Tell(Order::Step));
    wait(&mut app, |world| world.resource::<Course>().progress.present == 1);
    let began = Instant::now();
    while !toasts(&mut app).iter().any(|text| text.contains("sessions")) {
        app.update();
        assert!(began.elapsed() < Duration::from_secs(20), "{:?}", toasts(&mut app));
    }
    grow(&mut app, 2);
    let before = hash(&app);
    for order in [
        Order::Save(nowhere.join("garden.burgeon")),
        Order::SaveScenario(nowhere.join("scenario.ron")),
        Order::SaveRun(nowhere.join("run.ron")),
        Order::Export { step: 2, folder: nowhere.clone() },
        Order::Film(nowhere.join("growth.gif")),
        Order::Pictures(nowhere.join("pictures")),
    ] {
        *app.world_mut().resource_mut::<Toasts>() = Toasts::default();
        act(&mut app, Action::Tell(order.clone()));
        let began = Instant::now();
        while !toasts(&mut app).iter().any(|text| text.contains("file.txt") && !text.contains("sessions")) {
            app.update();
            assert!(began.elapsed() < Duration::from_secs(60), "{order:?} says nothing");
        }
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("file.txt")).unwrap(), "kept");
    assert_eq!(hash(&app), before);
    grow(&mut app, 1);
    // Elsewhere it can be saved as it is.
    let file = folder.path().join("garden.burgeon");
    act(&mut app, Action::Tell(Order::Save(file.clone())));
    wait(&mut app, |_| file.exists());
}

#[test]
fn sessions_cut_short_are_offered_until_taken_up_or_dismissed() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = Sessions::new(folder.path());
    let mut left = Vec::new();
    for steps in [2, 3] {
        let library = Library::embedded();
        let resolved = library.scenario("open").unwrap();
        let mut timeline = Timeline::new(resolved, 1, library, Workers::new(1).unwrap()).unwrap();
        for _ in 0..steps {
            timeline.advance().unwrap();
        }
        let mut autosave = sessions.begin();
        autosave.write(&timeline.save()).unwrap();
        left.push((steps, autosave.file().unwrap().to_path_buf()));
    }
    let mut app = session();
    app.insert_resource(Recent::new(sessions.clone()));
    let offered = |app: &App| app.world().resource::<Recent>().offered().map(|kept| kept.file.clone());
    let first = offered(&app).unwrap();
    let steps = left.iter().find(|(_, file)| *file == first).unwrap().0;
    act(&mut app, Action::Tell(Order::Load(first.clone())));
    wait(&mut app, |world| world.resource::<Course>().scenario == "open");
    assert_eq!(app.world().resource::<Course>().progress.present, steps);
    let second = offered(&app).unwrap();
    assert_ne!(first, second);
    act(&mut app, Action::Dismiss(second.clone()));
    assert_eq!(offered(&app), None);
    assert_eq!(toasts(&mut app), Vec::<String>::new());
    // Dismissed is not lost, and not offered the next time.
    let next = Recent::new(sessions);
    assert_eq!(next.list().len(), 2);
    assert_eq!(next.offered().map(|kept| kept.file.clone()), Some(first), "nothing has come of it yet");
}

#[test]
fn the_panels_fit_windows_of_any_width() {
    let folder = tempfile::tempdir().unwrap();
    let tops = [1280, 860, 720].map(|width| {
        let mut app = window(width, 720, folder.path());
        (0..5).for_each(|_| app.update());
        let world = app.world_mut();
        let mut contexts = world.query::<&mut bevy_egui::EguiContext>();
        let context = contexts.iter_mut(world).next().unwrap().get_mut().clone();
        let bar = bevy_egui::egui::containers::panel::PanelState::load(&context, "bar".into()).unwrap();
        assert!(bar.outer_rect.width() <= width as f32, "{width}: {:?}", bar.outer_rect);
        bar.outer_rect.height()
    });
    assert!(tops[2] > 1.5 * tops[0], "a narrow window has its bar in two rows: {tops:?}");
}

#[test]
fn save_and_open_ask_for_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = window(1280, 720, folder.path());
    grow(&mut app, 2);
    let kept = hash(&app);
    let is_open = |app: &App| app.world().resource::<Files>().is_open();
    press(&mut app, &with_control(KeyCode::KeyS, "s"));
    assert!(is_open(&app));
    for _ in 0..5 {
        app.update();
    }
    // Keys are the dialog's now: enter takes the name it proposes.
    press(&mut app, &[(KeyCode::ArrowRight, Key::ArrowRight)]);
    press(&mut app, &[(KeyCode::Enter, Key::Enter)]);
    let file = folder.path().join("figure_1d.burgeon");
    wait(&mut app, |_| file.exists());
    assert!(!is_open(&app));
    assert_eq!(
        app.world().resource::<Course>().progress.present,
        2,
        "a key for the dialog did something else"
    );

    // The file is known now.
    std::fs::remove_file(&file).unwrap();
    press(&mut app, &with_control(KeyCode::KeyS, "s"));
    assert!(!is_open(&app));
    wait(&mut app, |_| file.exists());

    act(&mut app, Action::Begin("open".into()));
    wait(&mut app, |world| world.resource::<Course>().scenario == "open");
    press(&mut app, &with_control(KeyCode::KeyS, "s"));
    assert!(is_open(&app), "another garden does not take the file of the one before");
    press(&mut app, &[(KeyCode::Escape, Key::Escape)]);
    act(&mut app, Action::Tell(Order::Load(file)));
    wait(&mut app, |world| world.resource::<Course>().scenario == "figure_1d");
    assert_eq!(hash(&app), kept);
}
