//! What leaves a timeline is what leaves the command line.

mod common;

use std::time::Duration;

use burgeon::assets::Library;
use burgeon::environment::workers::Workers;
use burgeon::export::harvest::{FILES, Harvest, export_all};
use burgeon::files::{RunFile, StepHashes};
use burgeon::scenario::{Gardener, GardenerSettings, News, Order, Timeline};
use common::{garden, quick};

fn timeline(steps: u32) -> Timeline {
    let workers = Workers::new(2).unwrap();
    let mut timeline = Timeline::new(quick("lamp_moved"), 1, Library::embedded(), workers).unwrap();
    for _ in 0..steps {
        timeline.advance().unwrap();
    }
    timeline
}

#[test]
fn exports_of_a_step_are_those_of_a_garden_grown_to_it() {
    let workers = Workers::new(2).unwrap();
    let mut grown = garden(quick("lamp_moved"), 1);
    let mut run = RunFile::new(&quick("lamp_moved"), 1, 0, StepHashes::default());
    for step in 1..=4 {
        grown.step().unwrap();
        run.hashes.push(step, grown.snapshot().hash());
        run.steps = step;
    }
    let alone = Harvest {
        snapshot: grown.snapshot().into(),
        scene: grown.scene(),
        records: grown.records().to_vec(),
        run,
    };
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    export_all(&alone, &a, &workers).unwrap();
    let harvest = timeline(6).harvest(4).unwrap().unwrap();
    export_all(&harvest, &b, &workers).unwrap();
    for name in FILES.iter().filter(|name| **name != "steps.csv") {
        let (a, b) = (std::fs::read(a.join(name)).unwrap(), std::fs::read(b.join(name)).unwrap());
        assert!(a == b, "{name}");
    }
    // Seconds differ, nothing else.
    let forms = |records: &[burgeon::plant::measure::StepRecord]| -> Vec<_> {
        records.iter().map(|record| (record.step, record.form, record.income)).collect()
    };
    assert_eq!(forms(&alone.records), forms(&harvest.records));
    let mut thinned = timeline(6);
    thinned.set_budget(1);
    assert_eq!(thinned.harvest(4).unwrap().unwrap().snapshot, harvest.snapshot);
    assert!(thinned.harvest(9).unwrap().is_none());
}

fn hear(gardener: &Gardener, mut wanted: impl FnMut(&News) -> bool) -> News {
    for _ in 0..2000 {
        match gardener.wait(Duration::from_secs(60)) {
            Some(news) if wanted(&news) => return news,
            Some(_) => {}
            None => break,
        }
    }
    panic!("no such news");
}

#[test]
fn a_gardener_explains_draws_and_exports() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let timeline = timeline(4);
    let birth = timeline.shot(3).unwrap().birth[0];
    let gardener = Gardener::start(timeline, GardenerSettings::default()).unwrap();
    gardener.order(Order::Explain { step: 3, birth }).unwrap();
    let news = hear(&gardener, |news| matches!(news, News::Explained(_)));
    let News::Explained(told) = news else { unreachable!() };
    assert_eq!((told.birth, told.why.unwrap().explanation.birth), (birth, birth));
    gardener.order(Order::Records).unwrap();
    hear(&gardener, |news| matches!(news, News::Records(records) if records.len() == 4));
    gardener.order(Order::Fallen).unwrap();
    hear(&gardener, |news| matches!(news, News::Fallen(_)));
    gardener.order(Order::Export { step: 3, folder: at.join("all") }).unwrap();
    hear(&gardener, |news| matches!(news, News::Saved(_)));
    assert!(FILES.iter().all(|name| at.join("all").join(name).exists()));
    gardener.order(Order::Film(at.join("film.gif"))).unwrap();
    hear(&gardener, |news| matches!(news, News::Saved(_)));
    gardener.order(Order::Pictures(at.join("steps"))).unwrap();
    hear(&gardener, |news| matches!(news, News::Saved(_)));
    assert!(at.join("film.gif").exists() && at.join("steps/step_0004.png").exists());
    // A folder that cannot be made: an error, and the gardener works on.
    std::fs::write(at.join("taken"), "a file").unwrap();
    gardener.order(Order::Export { step: 3, folder: at.join("taken") }).unwrap();
    let refused = hear(&gardener, |news| matches!(news, News::Refused(_)));
    let News::Refused(why) = refused else { unreachable!() };
    assert!(why.to_string().contains("taken"), "{why}");
    assert_eq!(std::fs::read_to_string(at.join("taken")).unwrap(), "a file");
    gardener.order(Order::Film(at.join("taken/film.gif"))).unwrap();
    hear(&gardener, |news| matches!(news, News::Refused(_)));
    gardener.order(Order::Step).unwrap();
    hear(&gardener, |news| matches!(news, News::Grown(view, _) if view.step == 5));
    gardener.quit();
}
