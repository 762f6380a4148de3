//! Any edits: what is left grows the same tree, reads back, and leaves the world whole.

use super::*;

#[test]
fn what_is_left_grows_the_same_tree() {
    let mut resolved = small();
    resolved.species.get_mut("lam_king").unwrap().leaf_income = 2.5;
    resolved.species.get_mut("lam_king").unwrap().branching_angle_deg = [50.0, 45.5].into();
    let mut timeline = Timeline::new(resolved, 7, Library::embedded(), workers()).unwrap();
    grow_to(&mut timeline, 5);
    timeline.edit(3, Edit::PlaceLamp(PlacedLamp { name: "l".into(), ..default() })).unwrap();
    catch_up(&mut timeline);
    timeline.edit(5, Edit::Sun(Some(PlacedSun::default()))).unwrap();
    timeline.advance().unwrap();
    let tree = timeline.shot(6).unwrap();

    // run.ron, with hashes.
    let run = RunFile::from_ron(&timeline.run_file().to_ron(), "run.ron").unwrap();
    assert_eq!((run.seed, run.steps, run.hashes.get(6)), (7, 6, Some(tree.hash())));
    assert_eq!(grown(run.resolved(), run.seed, 6).snapshot(), *tree);

    // A scenario, which names species only: what differs from the library is set by edits.
    let text = timeline.scenario().to_ron();
    let read = Library::embedded().read(&text, "left.ron", None).unwrap();
    assert_eq!(read.scenario.steps, 6);
    let again = grown(read, 7, 6).snapshot();
    assert_eq!((again.pose.clone(), again.flow), (tree.pose.clone(), tree.flow.clone()));

    // A save, with all that can be undone.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tree.save");
    timeline.drop_ghost();
    timeline.undo().unwrap();
    timeline.drop_ghost();
    timeline.redo().unwrap();
    timeline.save().write(&path).unwrap();
    let mut again = Timeline::resume(SavedRun::read(&path).unwrap(), Library::embedded(), workers()).unwrap();
    assert_eq!((again.now(), again.present(), again.catching_up()), (timeline.now(), 5, Some(6)));
    assert_eq!((again.made(), again.scenario()), (timeline.made(), timeline.scenario()));
    catch_up(&mut again);
    assert_eq!(again.shot(6).unwrap(), tree);
    let mut visit = again.visit(4).unwrap();
    while again.go_on(&mut visit).unwrap().is_none() {}
    assert_eq!(again.shot(3), timeline.shot(3));
    again.undo().unwrap();
    again.undo().unwrap();
    catch_up(&mut again);
    assert_as_afresh(&again);
    // An older save without a history.
    let mut plain = timeline.save();
    plain.history = None;
    let again = Timeline::resume(plain, Library::embedded(), workers()).unwrap();
    assert_eq!((again.now(), again.undoable()), (timeline.now(), (0, 0)));
}

#[test]
fn new_edits_read_back_and_are_checked() {
    let edits = [
        Edit::Pose {
            name: "wall".into(),
            to: Vec3::new(1.0, 2.0, 3.0),
            rotation_deg: Vec3::new(10.0, -20.0, 30.0),
            scale: Vec3::new(1.0, 2.0, 0.5),
        },
        Edit::Duplicate { name: "wall".into(), copy: "twin".into(), to: Vec3::new(4.0, 1.0, 0.0) },
        Edit::PlaceLamp(PlacedLamp { name: "l".into(), ..default() }),
        Edit::Shine { name: "l".into(), strength: 40.0, radius: 0.1 },
    ];
    let mut scenario = small().scenario;
    scenario.edits = edits.into_iter().map(|edit| TimedEdit { step: 1, edit }).collect();
    assert_eq!(Scenario::from_ron(&scenario.to_ron(), "edits.ron").unwrap(), scenario);

    let mut garden = grown(small(), 1, 1);
    for edit in &scenario.edits {
        apply(garden.world_mut(), &edit.edit).unwrap();
    }
    let standing = burgeon::scenario::Fixtures::take(garden.world_mut());
    let wall = standing.solids.iter().find(|s| s.name == "wall").unwrap();
    let twin = standing.solids.iter().find(|s| s.name == "twin").unwrap();
    assert_eq!((wall.position, twin.position), (Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 1.0, 0.0)));
    assert_eq!((wall.thing, wall.rotation, wall.scale), (twin.thing, twin.rotation, twin.scale));
    let SolidShape::Box { size } = wall.standing().shape else { panic!() };
    assert!(size.abs_diff_eq(Vec3::new(0.2, 6.0, 2.5), 1e-6));
    let expected =
        Quat::from_euler(EulerRot::YXZ, -20_f32.to_radians(), 10_f32.to_radians(), 30_f32.to_radians());
    assert_eq!(wall.rotation, expected);
    assert_eq!((standing.lamps[0].thing.strength, standing.lamps[0].thing.radius), (40.0, 0.1));
    // What a gizmo leaves comes back as it was set.
    let Edit::Pose { rotation_deg, scale, .. } = Edit::posing("wall", &wall.transform()) else { panic!() };
    assert!(rotation_deg.abs_diff_eq(Vec3::new(10.0, -20.0, 30.0), 1e-3) && scale == wall.scale);

    let wrong = |edit: &str| {
        let text = format!("(solids: [(name: \"a\")],\nedits: [(step: 1, edit: {edit})])");
        match Scenario::from_ron(&text, "edits.ron") {
            Err(FileError::Invalid { field, at, .. }) if at.line == Some(2) => field,
            other => panic!("{other:?}"),
        }
    };
    let pose = |name: &str, turn: f32, scale: f32| {
        format!("Pose(name: \"{name}\", to: (0, 1, 0), rotation_deg: ({turn}, 0, 0), scale: (1, {scale}, 1))")
    };
    assert_eq!(wrong(&pose("b", 0.0, 1.0)), "edits[0].edit.name");
    assert_eq!(wrong(&pose("a", 999.0, 1.0)), "edits[0].edit.rotation_deg");
    assert_eq!(wrong(&pose("a", 0.0, 0.0)), "edits[0].edit.scale");
    assert_eq!(wrong("Duplicate(name: \"a\", copy: \"a\", to: (0, 0, 0))"), "edits[0].edit.copy");
    assert_eq!(wrong("Shine(name: \"a\", strength: 1, radius: 1)"), "edits[0].edit.name");
}

#[test]
fn nothing_is_sown_in_a_wall_or_deep_underground() {
    let mut garden = grown(small(), 1, 1);
    let wall = garden.scenario().solids[0].at;
    let sown = |at| Edit::Plant(Planting { species: "lam_king".into(), at, ..default() });
    for at in [wall, Vec3::new(3.0, -1.0, 3.0)] {
        let refused = apply(garden.world_mut(), &sown(at));
        assert!(matches!(refused, Err(EditError::Invalid { field: "at", .. })), "{at}: {refused:?}");
    }
    assert_eq!(garden.snapshot().plants.len(), 1);
    apply(garden.world_mut(), &sown(Vec3::new(3.0, 0.0, 3.0))).unwrap();
}

/// What someone might do next.
#[derive(Debug, Clone)]
enum Act {
    Advance(u32),
    Edit { back: u32, edit: Edit, drag: bool },
    Prune { back: u32, which: prop::sample::Index },
    Undo,
    Redo,
}

fn place() -> impl Strategy<Value = Vec3> {
    (-0.6_f32..0.6, 0.1_f32..1.2, -0.6_f32..0.6).prop_map(Vec3::from)
}

fn edits() -> impl Strategy<Value = Edit> {
    let name = || prop_oneof![Just("wall".to_string()), Just("b".to_string()), Just("l".to_string())];
    prop_oneof![
        3 => place().prop_map(|at| Edit::PlaceSolid(block("b", at))),
        2 => (name(), place()).prop_map(|(name, to)| Edit::Move { name, to, turn_deg: 15.0 }),
        1 => (name(), place()).prop_map(|(name, to)| Edit::Pose {
            name, to, rotation_deg: to * 20.0, scale: Vec3::splat(0.7),
        }),
        2 => name().prop_map(|name| Edit::Remove { name }),
        1 => place().prop_map(|at| Edit::PlaceLamp(PlacedLamp { name: "l".into(), at, ..default() })),
        1 => (0.3_f32..1.0).prop_map(|above| Edit::Top { plant: 0, above }),
        1 => (0.2_f32..2.0).prop_map(|strength| Edit::Sky(Sky { strength, ..default() })),
        1 => (1.0_f32..4.0).prop_map(|income| Edit::Set {
            species: "lam_king".into(), parameter: "leaf_income".into(), value: income.to_string(),
        }),
        1 => place().prop_map(|at| Edit::Plant(Planting { at: at.with_y(0.0), seed: 3, ..default() })),
        1 => Just(Edit::Uproot { plant: 1 }),
    ]
}

fn acts() -> impl Strategy<Value = Act> {
    prop_oneof![
        3 => (1_u32..3).prop_map(Act::Advance),
        5 => (0_u32..5, edits(), any::<bool>()).prop_map(|(back, edit, drag)| Act::Edit { back, edit, drag }),
        2 => (0_u32..4, any::<prop::sample::Index>()).prop_map(|(back, which)| Act::Prune { back, which }),
        3 => Just(Act::Undo),
        2 => Just(Act::Redo),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Whatever is done in whatever order: every step is that of a garden grown afresh with the edits that stand.
    #[test]
    fn history_does_not_matter(acts in prop::collection::vec(acts(), 1..14), tight in any::<bool>()) {
        let mut timeline = timeline(4);
        if tight {
            timeline.set_budget(30_000);
        }
        for act in acts {
            match act {
                Act::Advance(steps) => {
                    for _ in 0..steps {
                        if timeline.present() < 6 {
                            timeline.advance().unwrap();
                        }
                    }
                }
                Act::Edit { back, edit, drag } => {
                    let step = timeline.present().saturating_sub(back);
                    let _ = if drag { timeline.amend(step, edit) } else { timeline.edit(step, edit) };
                }
                Act::Prune { back, which } => {
                    let step = timeline.present().saturating_sub(back);
                    if let Some(shot) = timeline.shot(step).filter(|shot| shot.len() > 1) {
                        let i = which.index(shot.len());
                        let _ = timeline.edit(step, Edit::Prune { plant: shot.plant[i], lineage: shot.lineage[i].0 });
                    }
                }
                Act::Undo => {
                    timeline.undo();
                }
                Act::Redo => {
                    timeline.redo();
                }
            }
        }
        catch_up(&mut timeline);
        assert_as_afresh(&timeline);
        prop_assert_eq!(check(&timeline.now()), Ok(()));
        let saved = timeline.save();
        prop_assert_eq!(saved.check().map_err(|e| e.to_string()), Ok(()));
        // And one step on, which shows that the edits at the head were made.
        timeline.advance().unwrap();
        let mut resumed = Timeline::resume(saved, Library::embedded(), workers()).unwrap();
        resumed.advance().unwrap();
        assert_as_afresh(&timeline);
        let head = timeline.present();
        prop_assert_eq!(resumed.hash(head), timeline.hash(head));
        prop_assert_eq!(resumed.lapsed().count(), timeline.lapsed().count());
        while timeline.undo().is_some() {}
        catch_up(&mut timeline);
        assert_as_afresh(&timeline);
    }
}

#[test]
fn the_world_behind_it_stays_whole() {
    let mut timeline = timeline(5);
    timeline.edit(2, Edit::Top { plant: 0, above: 0.1 }).unwrap();
    catch_up(&mut timeline);
    let mut garden = Garden::resume(timeline.save().garden, workers()).unwrap();
    check_world(garden.world_mut()).unwrap();
    assert_eq!(garden.snapshot(), *timeline.shot(5).unwrap());
}

#[test]
fn a_branch_cut_twice_at_one_step_is_cut_once() {
    let mut timeline = timeline(4);
    let cut = |timeline: &Timeline| {
        let shot = timeline.shot(3).unwrap();
        let i = shot.len() / 2;
        Edit::Prune { plant: shot.plant[i], lineage: shot.lineage[i].0 }
    };
    let first = cut(&timeline);
    timeline.edit(3, first.clone()).unwrap();
    catch_up(&mut timeline);
    let cut_once = (*timeline.shot(4).unwrap()).clone();
    timeline.edit(3, first).unwrap();
    catch_up(&mut timeline);
    assert_eq!(*timeline.shot(4).unwrap(), cut_once);
    assert_as_afresh(&timeline);
}
