//! The sun, plants and the ground in the hands of a user.

use burgeon::environment::SolidShape;
use burgeon::plant::Snapshot;
use burgeon::scenario::{Fixtures, PlacedSun};
use burgeon::species::parameter::Value;
use burgeon::viewer::Snapping;
use burgeon::viewer::why::other::Other;
use burgeon::viewer::why::split::Split;

use super::*;

fn view(world: &World) -> (&Snapshot, &Fixtures) {
    let view = world.resource::<Shown>().view.as_ref().unwrap();
    (&view.shot, &view.standing)
}

fn sun(world: &World) -> Option<PlacedSun> {
    view(world).1.sun.map(|(rotation, strength)| PlacedSun::of(rotation, strength))
}

fn chosen(app: &App) -> Chosen {
    app.world().resource::<Chosen>().clone()
}

fn undoable(world: &World) -> usize {
    world.resource::<Course>().progress.undoable
}

fn plants(world: &World) -> Vec<u32> {
    let plants = view(world).0.plants.iter().enumerate();
    plants.filter(|(_, plant)| plant.is_some()).map(|(number, _)| number as u32).collect()
}

fn organs(world: &World, plant: u32) -> usize {
    view(world).0.plant.iter().filter(|of| **of == plant).count()
}

#[test]
fn the_sun_rises_moves_sets_and_all_of_it_is_undone_and_redone() {
    let mut app = session();
    // Of a full sky leaves have all the light they can use, and those of the paper heed no sun.
    act(&mut app, Action::Begin("dusk".into()));
    wait(&mut app, |world| world.resource::<Course>().scenario == "dusk" && !view(world).1.lamps.is_empty());
    grow(&mut app, 3);
    let before = hash(&app);
    act(&mut app, Action::Sun);
    wait(&mut app, |world| sun(world) == Some(PlacedSun::default()));
    assert_eq!(chosen(&app), Chosen::Sun, "what rose can be changed at once");
    let low = PlacedSun { azimuth_deg: 80.0, elevation_deg: 35.0, strength: 1.5 };
    act(&mut app, Action::Edit(Edit::Sun(Some(low))));
    wait(&mut app, |world| sun(world) == Some(low));
    grow(&mut app, 2);
    let light = |app: &App| {
        let view = app.world().resource::<Shown>().view.as_ref().unwrap();
        view.record.unwrap().form.mean_light
    };
    let (lit, sunny) = (hash(&app), light(&app));

    // It belongs to the step it was made at: without it the same steps grow in the dark.
    act(&mut app, Action::Tell(Order::Undo));
    wait(&mut app, |world| sun(world) == Some(PlacedSun::default()));
    act(&mut app, Action::Tell(Order::Undo));
    let caught_up = |world: &World| {
        let progress = &world.resource::<Course>().progress;
        progress.catching_up.is_none() && progress.present == 5
    };
    wait(&mut app, |world| sun(world).is_none() && caught_up(world));
    assert!(light(&app) < 0.5 * sunny, "{} is not much less than {sunny}", light(&app));
    act(&mut app, Action::Look(Some(3)));
    wait(&mut app, |world| view(world).0.step == 3);
    assert_eq!(hash(&app), before);
    act(&mut app, Action::Look(None));
    for _ in 0..2 {
        act(&mut app, Action::Tell(Order::Redo));
    }
    wait(&mut app, |world| sun(world) == Some(low) && caught_up(world));
    assert_eq!((hash(&app), light(&app)), (lit, sunny), "made again, it is the tree it was");

    act(&mut app, Action::Choose(Chosen::Sun));
    act(&mut app, Action::Delete);
    wait(&mut app, |world| sun(world).is_none());
    act(&mut app, Action::Tell(Order::Undo));
    wait(&mut app, |world| sun(world) == Some(low));
}

#[test]
fn a_sun_that_a_scenario_brings_is_chosen_changed_and_removed() {
    let mut app = session();
    act(&mut app, Action::Begin("beach".into()));
    wait(&mut app, |world| world.resource::<Course>().scenario == "beach" && sun(world).is_some());
    let of_beach = PlacedSun { azimuth_deg: 120.0, elevation_deg: 40.0, strength: 0.6 };
    assert_eq!(sun(app.world()), Some(of_beach));
    act(&mut app, Action::Sun);
    assert_eq!((chosen(&app), undoable(app.world())), (Chosen::Sun, 0), "no second sun rises");
    let high = PlacedSun { elevation_deg: 70.0, ..of_beach };
    act(&mut app, Action::Drag(Edit::Sun(Some(high))));
    wait(&mut app, |world| sun(world) == Some(high));
    act(&mut app, Action::Delete);
    wait(&mut app, |world| sun(world).is_none());
    assert_eq!(chosen(&app), Chosen::Nothing);
}

#[test]
fn plants_are_sown_beside_each_other_sown_elsewhere_and_uprooted() {
    let mut app = session();
    grow(&mut app, 4);
    let (before, whole) = (hash(&app), organs(app.world(), 0));
    act(&mut app, Action::Choose(Chosen::Plant(0)));
    act(&mut app, Action::Duplicate);
    wait(&mut app, |world| plants(world) == [0, 1]);
    assert_eq!(chosen(&app), Chosen::Plant(1));
    let (shot, standing) = view(app.world());
    let [first, second] = [0, 1].map(|number| shot.plants[number].clone().unwrap());
    assert_eq!(first.species.name, second.species.name);
    assert_ne!(first.seed, second.seed, "another seed, another tree");
    assert!((0.7..5.0).contains(&first.position.distance(second.position)), "beside it");
    let wall = standing.solids[0].standing();
    assert!(!burgeon::scenario::is_covered(&wall, second.position, 0.3), "not in the wall");
    grow(&mut app, 3);
    assert!(organs(app.world(), 1) > 0, "it grows");

    // Away with it, and back.
    let (both, grown) = (hash(&app), organs(app.world(), 1));
    act(&mut app, Action::Delete);
    wait(&mut app, |world| plants(world) == [0]);
    assert!(
        toasts(&mut app).iter().any(|text| text.starts_with(&grown.to_string())),
        "{:?}",
        toasts(&mut app)
    );
    act(&mut app, Action::Tell(Order::Undo));
    wait(&mut app, |world| plants(world) == [0, 1]);
    assert_eq!(hash(&app), both);

    // The first, sown elsewhere: its seed, its turn, another place.
    let there = Vec3::new(-2.0, 0.0, 2.0);
    act(&mut app, Action::Take(Tool::Resow(0)));
    act(&mut app, Action::Resow(0, there));
    wait(&mut app, |world| plants(world) == [1, 2]);
    assert_eq!((chosen(&app), *app.world().resource::<Tool>()), (Chosen::Plant(2), Tool::Choose));
    let again = view(app.world()).0.plants[2].clone().unwrap();
    assert_eq!((again.seed, again.position), (first.seed, there));
    for _ in 0..3 {
        act(&mut app, Action::Tell(Order::Undo));
    }
    wait(&mut app, |world| plants(world) == [0] && organs(world, 0) > whole);
    act(&mut app, Action::Look(Some(4)));
    wait(&mut app, |world| view(world).0.step == 4);
    assert_eq!(hash(&app), before);
}

#[test]
fn a_plant_sown_by_the_tool_is_chosen_and_can_go_at_once() {
    let mut app = session();
    grow(&mut app, 2);
    act(&mut app, Action::Place(Kind::Plant(0), Vec3::new(-2.0, 0.0, 0.0)));
    wait(&mut app, |world| plants(world) == [0, 1]);
    assert_eq!(chosen(&app), Chosen::Plant(1));
    act(&mut app, Action::Delete);
    wait(&mut app, |world| plants(world) == [0]);
    // What is gone cannot go again, nor be copied.
    let made = undoable(app.world());
    for action in [Action::Delete, Action::Duplicate, Action::Resow(1, Vec3::ZERO)] {
        act(&mut app, Action::Choose(Chosen::Plant(1)));
        act(&mut app, action);
    }
    grow(&mut app, 1);
    assert_eq!((undoable(app.world()), plants(app.world())), (made, vec![0]));
}

#[test]
fn what_is_let_go_of_near_the_ground_stands_on_it() {
    let mut app = session();
    grow(&mut app, 1);
    act(&mut app, Action::Place(Kind::Wall, Vec3::new(-3.0, 0.0, 0.0)));
    wait(&mut app, |world| view(world).1.solids.len() == 2);
    let Chosen::Thing(name) = chosen(&app) else { panic!("what was set is chosen") };
    let height =
        |world: &World| view(world).1.solids.iter().find(|solid| solid.name == name).unwrap().position.y;
    let SolidShape::Box { size } =
        view(app.world()).1.solids.iter().find(|solid| solid.name == name).unwrap().thing.shape
    else {
        panic!("a wall is a box")
    };
    let lying = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
    let before = undoable(app.world());
    let falls = [
        (0.5 * size.y + 0.11, Quat::IDENTITY, true, 0.5 * size.y),
        (0.5 * size.y - 0.57, Quat::IDENTITY, true, 0.5 * size.y),
        (0.5 * size.y, lying, true, 0.5 * size.y),
        (0.3, lying, true, 0.5 * size.z),
        (0.5 * size.y - 0.57, Quat::IDENTITY, false, 0.5 * size.y - 0.57),
    ];
    for (made, (y, rotation, snap, stands)) in falls.into_iter().enumerate() {
        let place = Transform::from_xyz(-3.0, y, 0.0).with_rotation(rotation);
        act(&mut app, Action::Drop { name: name.clone(), place, snap });
        wait(&mut app, |world| undoable(world) == before + made + 1);
        assert!((height(app.world()) - stands).abs() < 1e-5, "{y}: {}", height(app.world()));
    }
    // A lamp is a ball.
    act(&mut app, Action::Place(Kind::Lamp, Vec3::new(-3.0, 0.0, 2.0)));
    wait(&mut app, |world| view(world).1.lamps.len() == 1);
    let lamp = view(app.world()).1.lamps[0].clone();
    let place = lamp.transform().with_translation(Vec3::new(-3.0, -1.0, 2.0));
    act(&mut app, Action::Drop { name: lamp.name.clone(), place, snap: true });
    wait(&mut app, |world| view(world).1.lamps[0].position.y == lamp.thing.radius);
}

#[test]
fn keys_reach_the_sun_the_ground_and_the_chosen_plant() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = window(1280, 720, folder.path());
    let key = |code, letter: &str| [(code, Key::Character(letter.into()))];
    press(&mut app, &key(KeyCode::KeyO, "o"));
    wait(&mut app, |world| sun(world).is_some());
    assert_eq!(chosen(&app), Chosen::Sun);
    press(&mut app, &key(KeyCode::KeyM, "m"));
    assert!(!app.world().resource::<Snapping>().0);
    press(&mut app, &key(KeyCode::KeyM, "m"));
    assert!(app.world().resource::<Snapping>().0);
    act(&mut app, Action::Choose(Chosen::Plant(0)));
    press(&mut app, &key(KeyCode::KeyE, "e"));
    assert_eq!(*app.world().resource::<Tool>(), Tool::Resow(0));
    press(&mut app, &[(KeyCode::Delete, Key::Delete)]);
    wait(&mut app, |world| plants(world).is_empty());
    act(&mut app, Action::Choose(Chosen::Sun));
    press(&mut app, &[(KeyCode::Delete, Key::Delete)]);
    wait(&mut app, |world| sun(world).is_none());
}

#[test]
fn a_second_garden_differs_in_one_thing_and_follows_what_is_edited() {
    let folder = tempfile::tempdir().unwrap();
    let mut app = window(1280, 720, folder.path());
    grow(&mut app, 3);
    let set = |app: &mut App, other: Option<Other>| {
        if let Some(order) = app.world_mut().resource_mut::<Split>().set(other) {
            act(app, Action::Tell(order));
        }
    };
    let twin = |world: &World| world.resource::<Split>().view().cloned();
    let at_step = |step: u32| move |world: &World| twin(world).is_some_and(|view| view.step == step);
    set(&mut app, Some(Other::WithoutSolids));
    wait(&mut app, at_step(3));
    assert!(twin(app.world()).unwrap().standing.solids.is_empty());
    assert_eq!(things(app.world()), 1, "the first has its wall");
    grow(&mut app, 1);
    wait(&mut app, at_step(4));

    // A lamp set in the first soon shines in both.
    act(&mut app, Action::Place(Kind::Lamp, Vec3::new(2.0, 0.0, 1.0)));
    wait(&mut app, |world| twin(world).is_some_and(|view| view.standing.lamps.len() == 1 && view.step == 4));
    assert!(twin(app.world()).unwrap().standing.solids.is_empty());

    let species = view(app.world()).0.plants[0].as_ref().unwrap().species.clone();
    let cost = 0.5 * species.leaf_cost;
    let (parameter, value) = ("leaf_cost", Value::Real(cost.into()));
    set(&mut app, Some(Other::Parameter { species: species.name.clone(), parameter, value }));
    wait(&mut app, at_step(4));
    let there = twin(app.world()).unwrap().shot.plants[0].as_ref().unwrap().species.leaf_cost;
    assert!((there - cost).abs() < 1e-6 && cost > 0.0);
    assert!(app.world().resource::<Split>().title().unwrap().contains("leaf cost"));
    set(&mut app, None);
    app.update();
    assert!(!app.world().resource::<Split>().is_open());
    act(&mut app, Action::Begin("open".into()));
    wait(&mut app, |world| world.resource::<Course>().scenario == "open");
}
