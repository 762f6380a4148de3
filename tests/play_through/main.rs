//! A session as someone at the window has it, through the gardener's orders alone.

#[path = "../common/mod.rs"]
mod common;
mod sessions;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use bevy::prelude::*;
use burgeon::assets::Library;
use burgeon::environment::SolidShape;
use burgeon::environment::workers::Workers;
use burgeon::files::{ResolvedScenario, RunFile, SaveError, write_save};
use burgeon::limits;
use burgeon::plant::{OrganKind, Snapshot};
use burgeon::scenario::{
    Edit, Garden, Gardener, GardenerError, GardenerSettings, News, Order, PlacedLamp, PlacedSolid, Progress,
    SavedRun, Scenario, Sessions, Timeline, TimelineError, View,
};
use common::{grown, quick};

const LONGEST: Duration = Duration::from_secs(120);

fn small() -> ResolvedScenario {
    let mut resolved = quick("figure_1d");
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 3;
    resolved
}

fn timeline() -> Timeline {
    Timeline::new(small(), 1, Library::embedded(), Workers::new(1).unwrap()).unwrap()
}

/// Someone at the window: gives orders and looks at what comes.
struct Person {
    gardener: Gardener,
    view: View,
    progress: Progress,
    shed: Option<usize>,
}

impl Person {
    fn sits_down(settings: GardenerSettings) -> Self {
        Self::before(timeline(), settings)
    }

    fn before(timeline: Timeline, settings: GardenerSettings) -> Self {
        let gardener = Gardener::start(timeline, settings).unwrap();
        let Some(News::Changed { view, progress, shed }) = gardener.wait(LONGEST) else { panic!() };
        Self { gardener, view, progress, shed }
    }

    fn orders(&self, order: Order) {
        let asked = Instant::now();
        self.gardener.order(order).unwrap();
        assert!(asked.elapsed() < Duration::from_millis(100), "an order never waits");
    }

    /// The next news, remembered.
    fn hears(&mut self) -> News {
        let news = self.gardener.wait(LONGEST).expect("news within two minutes");
        match &news {
            News::Grown(view, progress) => (self.view, self.progress) = (view.clone(), *progress),
            News::Changed { view, progress, shed } => {
                (self.view, self.progress, self.shed) = (view.clone(), *progress, *shed);
            }
            News::Status(progress) => self.progress = *progress,
            _ => {}
        }
        news
    }

    fn waits_for<T>(&mut self, wanted: impl Fn(News) -> Option<T>) -> T {
        loop {
            if let Some(found) = wanted(self.hears()) {
                return found;
            }
        }
    }

    fn does(&mut self, order: Order) {
        self.orders(order);
        self.waits_for(|news| match news {
            News::Changed { .. } | News::Status(_) => Some(()),
            News::Refused(why) => panic!("{why}"),
            _ => None,
        });
    }

    fn edits(&mut self, step: Option<u32>, edit: Edit) {
        self.does(Order::Edit { step, edit, drag: false });
    }

    fn steps(&mut self, steps: u32) {
        for _ in 0..steps {
            self.orders(Order::Step);
            self.waits_for(|news| matches!(news, News::Grown(..)).then_some(()));
        }
    }

    fn waits_until_caught_up(&mut self) {
        while self.progress.catching_up.is_some() {
            self.hears();
        }
    }

    fn sees(&mut self, step: u32) -> View {
        self.orders(Order::Seek(step));
        self.waits_for(|news| match news {
            News::Seen(view) => Some(view),
            News::Refused(why) => panic!("{why}"),
            _ => None,
        })
    }

    fn is_refused(&mut self, order: Order) -> GardenerError {
        self.orders(order);
        self.waits_for(|news| match news {
            News::Refused(why) => Some(why),
            News::Saved(path) => panic!("{} was written", path.display()),
            _ => None,
        })
    }

    fn saves(&mut self, order: Order) {
        self.orders(order);
        self.waits_for(|news| match news {
            News::Saved(_) => Some(()),
            News::Refused(why) => panic!("{why}"),
            _ => None,
        });
    }

    fn shares(&mut self) -> String {
        self.orders(Order::Share);
        self.waits_for(|news| match news {
            News::Code(code) => Some(code),
            _ => None,
        })
    }
}

fn branch(shot: &Snapshot) -> usize {
    (0..shot.len()).find(|&i| shot.state[i].kind() == OrganKind::Internode && shot.order[i] == 1).unwrap()
}

fn block(at: Vec3) -> Edit {
    let shape = SolidShape::Box { size: Vec3::splat(0.15) };
    Edit::PlaceSolid(PlacedSolid { name: "block".into(), shape, at, ..default() })
}

fn moved(name: &str, to: Vec3) -> Edit {
    Edit::Move { name: name.into(), to, turn_deg: 0.0 }
}

#[test]
fn place_move_crush_prune_undo_redo_scrub_fork_save_load() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut person = Person::sits_down(GardenerSettings::default());
    assert_eq!((person.view.step, person.view.shot.is_empty()), (0, true));

    // Watch, and place a lamp.
    person.steps(4);
    person.edits(None, Edit::PlaceLamp(PlacedLamp { name: "lamp".into(), ..default() }));
    assert_eq!(person.view.standing.lamps.len(), 1);
    person.steps(1);
    // Move it.
    person.edits(None, moved("lamp", Vec3::new(-2.0, 1.0, 0.0)));
    assert_eq!(person.view.standing.lamps[0].position.x, -2.0);

    // Crush a branch: it is gone at once. Undo brings it back.
    let whole = person.view.shot.clone();
    let i = branch(&whole);
    person.edits(None, block(whole.pose[i].tip(0.5 * whole.length(i))));
    let crushed = person.shed.unwrap();
    assert!(crushed > 0 && person.view.shot.len() == whole.len() - crushed);
    person.does(Order::Undo);
    assert_eq!((&person.view.shot, person.view.standing.solids.len()), (&whole, 1));
    person.does(Order::Redo);
    assert_eq!(person.view.shot.len(), whole.len() - crushed);
    person.does(Order::Undo);

    // Prune a branch, and grow on.
    let cut = Edit::Prune { plant: whole.plant[i], lineage: whole.lineage[i].0 };
    person.edits(None, cut);
    assert!(person.shed.unwrap() > 1 && person.progress.redoable == 0);
    person.steps(2);
    let course = person.view.shot.clone();

    // Scrub through all of it and back.
    for step in (0..=7).rev() {
        let view = person.sees(step);
        assert_eq!((view.step, view.shot.step), (step, step));
    }
    assert_eq!(person.sees(5).standing.lamps[0].position.x, -2.0);
    assert_eq!(person.sees(4).standing.lamps[0].position.x, 2.0);

    // Fork in the past: it regrows to the present, the old course stays to compare with.
    person.edits(Some(2), Edit::Remove { name: "wall".into() });
    assert_eq!((person.view.step, person.progress.catching_up), (2, Some(7)));
    person.waits_until_caught_up();
    assert_eq!((person.view.step, person.progress.ghost), (7, Some(7)));
    assert_ne!(person.view.shot, course);
    person.orders(Order::SeekGhost(7));
    let ghost = person.waits_for(|news| match news {
        News::GhostSeen(7, view) => Some(view.unwrap()),
        _ => None,
    });
    assert_eq!((ghost.shot, ghost.standing.solids.len()), (course.clone(), 1));

    // Save, share, and leave with files that grow the same.
    let last = person.view.shot.clone();
    person.saves(Order::Save(at("tree.save")));
    person.saves(Order::SaveScenario(at("tree.ron")));
    person.saves(Order::SaveRun(at("run.ron")));
    let code = person.shares();
    let run = RunFile::from_ron(&std::fs::read_to_string(at("run.ron")).unwrap(), "run.ron").unwrap();
    assert_eq!(run.hashes.get(7), Some(last.hash()));
    assert_eq!(grown(run.resolved(), run.seed, 7).snapshot(), *last);
    let text = std::fs::read_to_string(at("tree.ron")).unwrap();
    let read = Library::embedded().read(&text, "tree.ron", None).unwrap();
    assert_eq!(grown(read, 1, 7).snapshot(), *last);

    // Undo the fork.
    person.does(Order::Undo);
    person.waits_until_caught_up();
    assert_eq!(person.view.shot, course);

    // Load each of them.
    for order in [Order::Load(at("tree.save")), Order::Load(at("run.ron")), Order::LoadCode(code)] {
        person.does(Order::Seed(3));
        person.does(order);
        person.waits_until_caught_up();
        assert_eq!((person.progress.seed, &person.view.shot), (1, &last));
    }
    person.does(Order::Load(at("tree.save")));
    assert_eq!((person.progress.undoable, person.view.step), (4, 7));
    person.does(Order::Load(at("tree.ron")));
    assert_eq!((person.progress.undoable, person.view.step), (0, 0));
    person.steps(7);
    assert_eq!(person.view.shot, last);
    person.gardener.quit();
}

#[test]
fn the_clock_never_changes_the_tree() {
    let alone: Vec<u64> = {
        let mut garden = Garden::new(small(), 1, Workers::new(1).unwrap()).unwrap();
        (0..6)
            .map(|_| {
                garden.step().unwrap();
                garden.snapshot().hash()
            })
            .collect()
    };
    for pace in [0.0, 40.0, f32::INFINITY, 7.5] {
        let mut person = Person::sits_down(GardenerSettings::default());
        person.does(Order::Pace(pace));
        let began = Instant::now();
        person.orders(Order::Play);
        while person.view.step < 6 {
            person.hears();
        }
        if pace == 7.5 {
            assert!(began.elapsed() > Duration::from_millis(600), "six steps at 7.5 a second");
        }
        person.orders(Order::Pause);
        person.waits_for(|news| matches!(news, News::Status(Progress { playing: false, .. })).then_some(()));
        for step in 1..=6 {
            assert_eq!(person.sees(step).shot.hash(), alone[step as usize - 1], "pace {pace}, step {step}");
        }
    }
}

#[test]
fn an_edit_while_it_plays_shows_within_a_step_and_is_answered_without_waiting_for_a_beat() {
    let mut person = Person::sits_down(GardenerSettings::default());
    person.steps(5);
    // A step in a quarter of an hour: without the edit nothing would come for long.
    person.does(Order::Pace(0.001));
    person.does(Order::Play);
    person.waits_for(|news| matches!(news, News::Grown(..)).then_some(()));
    let asked = Instant::now();
    person.edits(None, moved("wall", Vec3::new(1.5, 1.5, 0.0)));
    // Buds see the wall where it stands now at the end of the next step, answer in the one after, and shoots of a single
    // internode turn in the third or fourth.
    for step in [7, 8, 9, 10] {
        person.waits_for(|news| matches!(news, News::Grown(..)).then_some(()));
        assert!(asked.elapsed() < Duration::from_secs(20), "{:?}", asked.elapsed());
        assert_eq!(person.view.step, step);
    }
    assert!(person.gardener.wait(Duration::from_millis(300)).is_none(), "and then growth keeps its pace");
}

#[test]
fn a_drag_of_hundreds_of_events_is_one_edit_and_ends_where_it_ended() {
    let mut person = Person::sits_down(GardenerSettings::default());
    person.steps(5);
    let to = |k: u32| moved("wall", Vec3::new(0.5 + 0.002 * k as f32, 1.5, 0.0));
    person.orders(Order::Edit { step: Some(2), edit: to(0), drag: false });
    for k in 1..=300 {
        person.orders(Order::Edit { step: Some(2), edit: to(k), drag: true });
    }
    person.orders(Order::Pause);
    person.waits_for(|news| matches!(news, News::Status(_)).then_some(()));
    person.waits_until_caught_up();
    assert_eq!((person.progress.undoable, person.view.step), (1, 5));
    let mut resolved = small();
    resolved.scenario.edits = vec![burgeon::scenario::TimedEdit { step: 2, edit: to(300) }];
    assert_eq!(grown(resolved, 1, 5).snapshot(), *person.view.shot);
    // Scrubbing fast shows the last at least.
    for step in [0, 1, 2, 3, 4] {
        person.orders(Order::Seek(step));
    }
    person.waits_for(|news| matches!(news, News::Seen(View { step: 4, .. })).then_some(()));
}

#[test]
fn steps_that_were_thinned_away_are_seen_all_the_same() {
    let mut person = Person::sits_down(GardenerSettings::default());
    person.orders(Order::Budget(60_000));
    person.steps(12);
    assert!(person.progress.bytes <= 60_000);
    let hashes: Vec<u64> = (0..12).map(|step| person.sees(step).shot.hash()).collect();
    for step in 0..12 {
        assert_eq!(grown(small(), 1, step).snapshot().hash(), hashes[step as usize], "step {step}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_and_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let taken = folder.path().join("taken");
    std::fs::create_dir(&taken).unwrap();
    let mut person = Person::sits_down(GardenerSettings::default());
    person.steps(3);
    let before = person.view.clone();
    type Kind = fn(&GardenerError) -> bool;
    let io: Kind = |e| matches!(e, GardenerError::Save(SaveError::Io { .. }));
    let write: Kind = |e| matches!(e, GardenerError::Write { .. });
    let bad = folder.path().join("bad.ron");
    std::fs::write(&bad, "(plants: [(species: \"elm\")])").unwrap();
    let cases: [(Order, Kind); 13] = [
        (Order::Save(taken.clone()), io),
        (Order::Save(taken.join("none/tree.save")), io),
        (Order::SaveScenario(taken.clone()), write),
        (Order::SaveRun(taken.clone()), write),
        (Order::Load(taken.clone()), |e| matches!(e, GardenerError::File(_))),
        (Order::Load(folder.path().join("none.save")), |e| matches!(e, GardenerError::File(_))),
        (Order::Load(bad), |e| matches!(e, GardenerError::File(_))),
        (Order::LoadCode("no code".into()), |e| matches!(e, GardenerError::Share(_))),
        (Order::Undo, |e| matches!(e, GardenerError::Nothing("undo"))),
        (Order::Redo, |e| matches!(e, GardenerError::Nothing("redo"))),
        (Order::Seek(9), |e| {
            matches!(e, GardenerError::Timeline(TimelineError::NotGrown { step: 9, last: 3 }))
        }),
        (Order::Edit { step: None, edit: Edit::Remove { name: "lamp".into() }, drag: true }, |e| {
            matches!(e, GardenerError::Timeline(TimelineError::Invalid(_)))
        }),
        (
            Order::Begin(
                Box::new(ResolvedScenario {
                    scenario: Scenario { version: 9, ..default() },
                    species: default(),
                }),
                1,
            ),
            |e| matches!(e, GardenerError::Timeline(TimelineError::Invalid(_))),
        ),
    ];
    for (order, kind) in cases {
        let why = person.is_refused(order.clone());
        assert!(kind(&why), "{order:?}: {why:?}");
        assert!(!why.to_string().is_empty());
        assert_eq!(person.sees(3), before, "{order:?}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    assert_eq!(std::fs::read_dir(&taken).unwrap().count(), 0);
    // And it still grows and saves.
    person.steps(1);
    person.saves(Order::Save(folder.path().join("tree.save")));
}

#[test]
fn growth_that_stops_at_a_limit_keeps_what_has_grown() {
    let mut timeline = timeline();
    timeline.set_limits(limits::GrowthLimits { steps: 3, ..default() });
    let mut person = Person::before(timeline, GardenerSettings { playing: true, ..default() });
    person.waits_for(|news| matches!(news, News::Stopped(_)).then_some(()));
    person.waits_for(|news| matches!(news, News::Status(Progress { playing: false, .. })).then_some(()));
    assert_eq!(person.sees(3).shot.step, 3);
    // Also after going back: the limit stays, and so does the way forward.
    person.edits(Some(1), Edit::Remove { name: "wall".into() });
    person.waits_until_caught_up();
    assert_eq!(person.view.step, 3);
}

#[test]
fn a_gardener_that_ended_says_so() {
    let person = Person::sits_down(GardenerSettings::default());
    person.orders(Order::Quit);
    while person.gardener.wait(LONGEST).is_some() {}
    while !person.gardener.has_ended() {
        std::thread::yield_now();
    }
    assert!(person.gardener.order(Order::Play).is_err());
    assert!(person.gardener.news().is_none());
    fn anywhere<T: Send + Sync + 'static>(_: &T) {}
    anywhere(&person.gardener);
}
