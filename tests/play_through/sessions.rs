//! Sessions are saved by themselves, outlive crashes and starts, and never write over each other.

use super::*;

/// A session whose garden is saved after every step.
fn saving(sessions: &Sessions) -> GardenerSettings {
    GardenerSettings { autosave: Some((sessions.begin(), Duration::ZERO)), ..default() }
}

/// A session of five steps and an edit that is cut short; its organs.
fn crash(sessions: &Sessions) -> Snapshot {
    let mut timeline = timeline();
    for _ in 0..5 {
        timeline.advance().unwrap();
    }
    timeline.edit(5, Edit::Remove { name: "wall".into() }).unwrap();
    let mut autosave = sessions.begin();
    autosave.write(&timeline.save()).unwrap();
    // What it held is let go of, and no end is made of it: so does the system when it ends a program.
    drop(autosave);
    Snapshot::clone(&timeline.now())
}

/// What lies in the folder by now.
fn paths(sessions: &Sessions) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(sessions.folder()).into_iter().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

/// Whether the name of a file ends like this.
fn ends(path: &Path, end: &str) -> bool {
    path.to_str().unwrap().ends_with(end)
}

/// Files and what they hold, while nobody writes.
fn files(sessions: &Sessions) -> Vec<(PathBuf, Vec<u8>)> {
    let read = |path: PathBuf| {
        let held = std::fs::read(&path).unwrap();
        (path, held)
    };
    paths(sessions).into_iter().map(read).collect()
}

#[test]
fn what_a_crash_left_outlives_starts_and_is_restored_to_the_organ() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = Sessions::new(folder.path().join("state/sessions"));
    let crashed = crash(&sessions);
    let left = files(&sessions);
    // Two starts that come to nothing: no window opens.
    for _ in 0..2 {
        let gardener = Gardener::start(timeline(), saving(&sessions)).unwrap();
        let ending = gardener.ending().unwrap();
        drop(gardener);
        assert_eq!(ending.wait().unwrap(), None, "there was nothing to save");
        assert_eq!(files(&sessions), left);
    }
    // And one that opens a window, grows, and ends in order.
    let mut person = Person::sits_down(saving(&sessions));
    person.steps(2);
    let ending = person.gardener.ending().unwrap();
    drop(person);
    let ended = ending.wait().unwrap().unwrap();
    assert_eq!(SavedRun::read(&ended).unwrap().run.steps, 2);

    let kept = sessions.kept();
    let unfinished: Vec<_> = kept.iter().filter(|kept| kept.unfinished).collect();
    assert_eq!((kept.len(), unfinished.len()), (2, 1));
    assert_eq!(unfinished[0].scenario, "figure_1d");
    let file = unfinished[0].file.clone();
    let mut person = Person::sits_down(saving(&sessions));
    person.orders(Order::Load(file.clone()));
    let save = person.waits_for(|news| match news {
        News::Began { save, .. } => Some(save),
        _ => None,
    });
    assert_eq!(save, None, "the garden has no file of the user's yet");
    assert_eq!((person.view.step, &*person.view.shot, person.progress.undoable), (5, &crashed, 1));
    assert!(file.exists(), "nothing has come of it yet that could be saved");
    // Once more is grown and saved, it needs not be offered again; it is still there.
    person.steps(1);
    let deadline = Instant::now() + LONGEST;
    while file.exists() {
        assert!(Instant::now() < deadline);
    }
    assert!(sessions.kept().iter().all(|kept| !kept.unfinished));
    assert!(sessions.kept().iter().any(|kept| SavedRun::read(&kept.file).unwrap().run.steps == 5));
}

#[test]
fn two_windows_at_once_never_write_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = Sessions::new(folder.path());
    let mut people = [3, 4].map(|steps| {
        let mut person = Person::sits_down(saving(&sessions));
        person.steps(steps);
        person
    });
    let deadline = Instant::now() + LONGEST;
    while paths(&sessions).iter().filter(|path| ends(path, ".unfinished.burgeon")).count() < 2 {
        assert!(Instant::now() < deadline);
    }
    assert_eq!(sessions.kept(), [], "a session that runs is nobody else's");
    people.iter_mut().for_each(|person| person.steps(1));
    people.into_iter().for_each(|person| person.gardener.quit());
    let mut steps: Vec<u32> =
        sessions.kept().iter().map(|kept| SavedRun::read(&kept.file).unwrap().run.steps).collect();
    steps.sort_unstable();
    assert_eq!(steps, [4, 5]);
    assert!(paths(&sessions).iter().all(|path| !ends(path, ".lock")));
}

#[test]
fn whoever_turns_to_another_garden_finds_the_first_again() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = Sessions::new(folder.path());
    let mut person = Person::sits_down(GardenerSettings {
        // It is not due before the garden is left.
        autosave: Some((sessions.begin(), Duration::from_secs(3600))),
        ..default()
    });
    person.steps(3);
    person.does(Order::Begin(Box::new(small()), 2));
    let kept = sessions.kept();
    assert_eq!(kept.len(), 1);
    assert_eq!(SavedRun::read(&kept[0].file).unwrap().run.steps, 3);
    // Nothing has come of the other: there is nothing to save.
    person.gardener.quit();
    assert_eq!(sessions.kept(), kept);
}

#[test]
fn of_sessions_that_ended_the_newest_are_kept_and_of_those_cut_short_all() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = Sessions::new(folder.path());
    let save = timeline().save();
    let strange = ["letter.txt", "my own.burgeon", "oak-1.burgeon"];
    strange.iter().for_each(|name| std::fs::write(folder.path().join(name), "kept").unwrap());
    for _ in 0..3 {
        sessions.begin().write(&save).unwrap();
    }
    for _ in 0..limits::SESSIONS + 2 {
        let mut autosave = sessions.begin();
        autosave.write(&save).unwrap();
        autosave.finish().unwrap();
    }
    let count = || {
        let kept = sessions.kept();
        let unfinished = kept.iter().filter(|kept| kept.unfinished).count();
        (unfinished, kept.len() - unfinished)
    };
    assert_eq!(count(), (3, limits::SESSIONS));
    let dismissed = sessions.kept().into_iter().find(|kept| kept.unfinished).unwrap();
    sessions.settle(&dismissed.file).unwrap();
    assert_eq!(count(), (2, limits::SESSIONS));
    for name in strange {
        assert_eq!(std::fs::read_to_string(folder.path().join(name)).unwrap(), "kept");
    }
}

#[test]
fn a_damaged_save_is_refused_and_never_destroyed() {
    let folder = tempfile::tempdir().unwrap();
    let sessions = Sessions::new(folder.path());
    crash(&sessions);
    let file = sessions.kept()[0].file.clone();
    std::fs::write(&file, "damaged").unwrap();
    let mut person = Person::sits_down(saving(&sessions));
    let why = person.is_refused(Order::Load(file.clone()));
    assert!(matches!(why, GardenerError::File(_) | GardenerError::Save(_)), "{why}");
    person.steps(1);
    person.gardener.quit();
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "damaged");
    assert!(sessions.kept().iter().any(|kept| kept.file == file && kept.unfinished));
    // A save that is whole but of nothing that can grow is damaged, too.
    let mut unsound = timeline().save();
    unsound.run.steps = 99;
    write_save(&file, &unsound).unwrap();
    assert!(matches!(SavedRun::read(&file), Err(SaveError::Unsound { .. })));
}

#[test]
fn what_cannot_be_saved_is_told_growth_goes_on_and_the_end_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken");
    std::fs::write(&taken, "me").unwrap();
    let mut person = Person::sits_down(saving(&Sessions::new(&taken)));
    person.orders(Order::Step);
    let why = person.waits_for(|news| match news {
        News::Refused(why) => Some(why),
        _ => None,
    });
    assert!(matches!(why, GardenerError::Save(SaveError::Io { .. })), "{why}");
    person.steps(2);
    assert_eq!(person.view.step, 3);
    let ending = person.gardener.ending().unwrap();
    person.gardener.quit();
    let why = ending.wait().unwrap_err();
    assert!(why.to_string().contains("taken"), "{why}");
    assert_eq!(std::fs::read_to_string(&taken).unwrap(), "me");
}
