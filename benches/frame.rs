//! What the processor does in a frame for plants that grow and are drawn: between two steps, when a step lands, and
//! while the next one grows in parts. No graphics card: Bevy's renderer is there, without one to talk to.
//!
//! ```sh
//! cargo bench --features render --bench frame
//! ```

use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy::render::RenderPlugin;
use bevy::render::settings::{RenderCreation, WgpuSettings};
use burgeon::assets::Library;
use burgeon::growth::StepCount;
use burgeon::growth::parts::{PartOfStep, grow_in_parts};
use burgeon::plant::{Lineage, OrganState};
use burgeon::prelude::*;
use burgeon::render::{
    DrawSettings, Drawn, GrowthPace, LiveGrowthPlugin, PlantRenderPlugin, Stage, StepFraction,
};
use burgeon::scenario::{Edit, Gardener, GardenerSettings, News, Order, PlacedLamp, Timeline};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

/// An app that draws nothing but plants, and those into the void.
fn app(settings: DrawSettings) -> App {
    app_with(settings, |_| ())
}

/// The same with more in it.
fn app_with(settings: DrawSettings, more: impl FnOnce(&mut App)) -> App {
    let mut app = App::new();
    let nothing = WgpuSettings { backends: None, ..default() };
    let plugins = DefaultPlugins
        .build()
        .disable::<bevy::log::LogPlugin>()
        .set(RenderPlugin { render_creation: RenderCreation::Automatic(Box::new(nothing)), ..default() });
    #[cfg(feature = "viewer")]
    let plugins = plugins.disable::<bevy::winit::WinitPlugin>();
    app.add_plugins((plugins, PlantRenderPlugin)).insert_resource(settings);
    more(&mut app);
    app.finish();
    app.cleanup();
    app.update();
    app
}

/// A grove of `n` young oaks before and after a growth step, and what that cost the frames it grew in.
struct Grove {
    states: [Arc<Snapshot>; 2],
    /// The longest that a frame was kept, and by the snapshot at the end.
    longest: [Duration; 2],
    /// The whole step, other threads included.
    step: Duration,
}

fn grove(n: i32) -> Grove {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, BurgeonPlugins)).insert_resource(Sensing {
        leaf_face: 2,
        bud_face: 4,
        ..default()
    });
    let oak = Arc::new(Species::named("oak").expect("it is shipped"));
    for k in 0..n {
        let at = Transform::from_xyz(12.0 * (k % 4) as f32, 0.0, 12.0 * (k / 4) as f32);
        app.world_mut().spawn((Plant::new(oak.clone(), 7 + k as u64), at));
    }
    grow(app.world_mut(), 11);
    let before = Arc::new(Snapshot::take(app.world()));
    let (began, mut part) = (Instant::now(), Duration::ZERO);
    loop {
        let part_began = Instant::now();
        let came = grow_in_parts(app.world_mut(), Duration::from_millis(4));
        part = part.max(part_began.elapsed());
        match came {
            PartOfStep::Finished => break,
            PartOfStep::More => {}
            PartOfStep::Looking => std::thread::sleep(Duration::from_micros(500)),
        }
    }
    let step = began.elapsed();
    // Into the memory of one no longer shown, as in a host.
    let spare = Snapshot::clone(&before);
    let began = Instant::now();
    let half = spare.half_taken_anew(app.world());
    let (first, began) = (began.elapsed(), Instant::now());
    let now = Arc::new(half.other_half(app.world()));
    Grove { states: [before, now], longest: [part, first.max(began.elapsed())], step }
}

/// Time this thread has had of a processor; what it waited for is not in it. By the clock where the system does not tell.
fn own_time(clock: Instant) -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split_whitespace().next()?.parse().ok());
    nanoseconds.map_or_else(|| clock.elapsed(), Duration::from_nanos)
}

/// Young oaks that grow a step in two seconds, at sixty frames a second: what frames take of the main thread, the mean
/// and the longest, in milliseconds, and what grew.
fn growing(oaks: u64) -> (f64, f64, String) {
    const FRAME: Duration = Duration::from_micros(16_667);
    let mut app = app_with(DrawSettings::default(), |app| {
        app.add_plugins((BurgeonPlugins, LiveGrowthPlugin))
            .insert_resource(GrowthPace { milliseconds_per_frame: 0.5, ..default() })
            // One core is left to the frames.
            .insert_resource(Workers::new(1).expect("a thread can be had"))
            .insert_resource(Sensing { leaf_face: 4, bud_face: 6, ..default() });
    });
    let oak = Arc::new(Species::named("oak").expect("it is shipped"));
    for k in 0..oaks {
        let at = Transform::from_xyz(5.0 * (k % 20) as f32, 0.0, 5.0 * (k / 20) as f32);
        app.world_mut().spawn((Plant::new(oak.clone(), k), at));
    }
    grow(app.world_mut(), 3);
    let (began, mut spent) = (Instant::now(), Vec::new());
    let steps = app.world().resource::<StepCount>().0;
    while began.elapsed() < Duration::from_secs(20) {
        let (frame, before) = (Instant::now(), own_time(began));
        app.update();
        spent.push((own_time(began) - before).as_secs_f64() * 1e3);
        std::thread::sleep(FRAME.saturating_sub(frame.elapsed()));
    }
    let worst = spent.iter().copied().fold(0.0, f64::max);
    let world = app.world();
    let (organs, steps) = (world.resource::<Roster>().len(), world.resource::<StepCount>().0 - steps);
    let told = format!("{organs} organs, {steps} steps in {} frames", spent.len());
    (spent.iter().sum::<f64>() / spent.len() as f64, worst, told)
}

/// A garden at dusk that plays on until it has so many buds, or a few more.
fn dusk(seed: u64, buds: usize) -> Timeline {
    let library = Library::embedded();
    let resolved = library.scenario("dusk").expect("it is shipped");
    let workers = Workers::new(2).expect("threads can be had");
    let mut timeline = Timeline::new(resolved, seed, library, workers).expect("it is sound");
    while count(&timeline.now(), |state| {
        matches!(state, OrganState::ApicalBud(..) | OrganState::LateralBud(..))
    }) < buds
    {
        timeline.advance().expect("it is far from its limits");
    }
    timeline
}

/// The largest angle by which a growing tip that two courses share heads elsewhere in one of them, degrees.
fn turn(shot: &Snapshot, course: &Snapshot) -> f32 {
    let tips = |of: &Snapshot| -> HashMap<Lineage, Vec3> {
        let tips = (0..of.len()).filter(|&i| matches!(of.state[i], OrganState::ApicalBud(..)));
        tips.map(|i| (of.lineage[i], of.pose[i].heading())).collect()
    };
    let (here, there) = (tips(shot), tips(course));
    let angles =
        here.iter().filter_map(|(tip, heading)| Some(heading.angle_between(*there.get(tip)?).to_degrees()));
    angles.fold(0.0, f32::max)
}

/// Drops a lamp beside a garden that plays, as the window does, sixty frames a second, and waits until a step is on
/// screen in which a tip heads elsewhere than without the lamp; the time that took, and the step.
fn answers(timeline: Timeline, course: &[Arc<Snapshot>]) -> (Duration, u32) {
    const FRAME: Duration = Duration::from_micros(16_667);
    let mut app = app(DrawSettings::default());
    let drawn = Drawn::still(timeline.now());
    let garden = app.world_mut().spawn(drawn.clone()).id();
    land(&mut app, garden, drawn);
    let gardener = Gardener::start(timeline, GardenerSettings { pace: Some(1.0), ..default() });
    let gardener = gardener.expect("a thread can be had");
    let lamp = PlacedLamp {
        name: "dropped".into(),
        at: Vec3::new(-1.5, 2.0, 1.0),
        strength: 300.0,
        radius: 0.2,
        ..default()
    };
    let began = Instant::now();
    let edit = Order::Edit { step: None, edit: Edit::PlaceLamp(lamp), drag: false };
    for order in [edit, Order::Play] {
        gardener.order(order).expect("it works");
    }
    loop {
        let frame = Instant::now();
        while let Some(news) = gardener.news() {
            if let News::Grown(view, _) = news {
                app.world_mut().get_mut::<Drawn>(garden).expect("it was spawned").step_to(view.shot);
            }
        }
        app.update();
        let has_landed = app.world().get::<Stage>(garden).is_some_and(Stage::is_settled);
        let now = app.world().get::<Drawn>(garden).expect("it was spawned").now.clone();
        let same = course.iter().find(|without| without.step == now.step);
        if has_landed && same.is_some_and(|without| turn(&now, without) > 1.0) {
            return (began.elapsed(), now.step);
        }
        assert!(began.elapsed() < Duration::from_secs(60), "no tip ever turned");
        std::thread::sleep(FRAME.saturating_sub(frame.elapsed()));
    }
}

fn count(shot: &Snapshot, is: impl Fn(&OrganState) -> bool) -> usize {
    shot.state.iter().filter(|state| is(state)).count()
}

/// The row of [`answers`]: over several oaks.
fn answering() {
    let mut took: Vec<_> = (1..=8)
        .map(|seed| {
            let timeline = dusk(seed, 1000);
            let (save, now) = (timeline.save(), timeline.now());
            let again = || {
                let workers = Workers::new(2).expect("threads can be had");
                Timeline::resume(save.clone(), Library::embedded(), workers).expect("it was saved just now")
            };
            let mut without = again();
            let course: Vec<_> = (0..6)
                .map(|_| {
                    without.advance().expect("it is far from its limits");
                    without.now()
                })
                .collect();
            let (time, step) = answers(again(), &course);
            (time, step - now.step)
        })
        .collect();
    took.sort();
    println!(
        "from dropping a lamp beside an oak of 1,000 buds to the first tip on screen that turns, two threads, {} oaks: \
         median {:.2} s, {:.2} at most; {} to {} steps after",
        took.len(),
        took[took.len() / 2].0.as_secs_f64(),
        took[took.len() - 1].0.as_secs_f64(),
        took.iter().map(|(_, steps)| steps).min().expect("there are some"),
        took.iter().map(|(_, steps)| steps).max().expect("there are some"),
    );
}

fn leaves(shot: &Snapshot) -> usize {
    count(shot, |state| matches!(state, OrganState::Leaf(_)))
}

/// Has the app draw a step and waits until it is on screen; the longest frame of that.
fn land(app: &mut App, garden: Entity, drawn: Drawn) -> Duration {
    app.world_mut().entity_mut(garden).insert(drawn);
    let mut worst = Duration::ZERO;
    for _ in 0..100_000 {
        let began = Instant::now();
        app.update();
        worst = worst.max(began.elapsed());
        if app.world().get::<Stage>(garden).is_some_and(Stage::is_settled) {
            return worst;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    panic!("the step never landed");
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64() * 1e3
}

fn frame(criterion: &mut Criterion) {
    let mut empty = app(DrawSettings::default());
    let nothing = median(
        (0..200)
            .map(|_| {
                let began = Instant::now();
                empty.update();
                began.elapsed()
            })
            .collect(),
    );
    println!("a frame without plants: {nothing:.3} ms");
    let (none, ..) = growing(0);
    let (mean, worst, told) = growing(200);
    println!(
        "200 growing oaks add {:.2} ms of the main thread to a frame on average, {worst:.1} is the longest: {told}",
        mean - none
    );
    answering();
    println!("a step in parts of 4 ms, then drawn; the worst frame of each, ms:");
    println!("leaves  organs  step    growing  snapshot  landing  landing, packed at once  between steps");
    let groves: Vec<_> = [1, 4, 9, 16].into_iter().map(grove).collect();
    for Grove { states: [before, now], longest, step } in &groves {
        let there = Drawn { before: before.clone(), now: now.clone() };
        let back = Drawn { before: now.clone(), now: before.clone() };
        let mut landing = [Vec::new(), Vec::new()];
        let mut between = Vec::new();
        for (at_once, landing) in [false, true].into_iter().zip(&mut landing) {
            let mut app = app(DrawSettings { pack_at_once: at_once, ..default() });
            let garden = app.world_mut().spawn(there.clone()).id();
            land(&mut app, garden, there.clone());
            for drawn in [&back, &there, &back, &there, &back] {
                landing.push(land(&mut app, garden, drawn.clone()));
            }
            for k in 0..200 {
                app.world_mut().entity_mut(garden).insert(StepFraction(k as f32 / 200.0));
                let began = Instant::now();
                app.update();
                between.push(began.elapsed());
            }
        }
        let [aside, at_once] = landing.map(median);
        let (leaves, organs, between) = (leaves(now), now.len(), median(between) - nothing);
        let [step, part, shot] = [*step, longest[0], longest[1]].map(|time| time.as_secs_f64() * 1e3);
        println!(
            "{leaves:6}  {organs:6}  {step:6.0}  {part:7.2}  {shot:8.2}  {aside:7.2}  {at_once:23.2}  {between:19.3}"
        );
    }

    let mut group = criterion.benchmark_group("frame");
    group.sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_secs(1));
    for Grove { states: [before, now], .. } in &groves {
        let mut app = app(DrawSettings::default());
        let drawn = Drawn { before: before.clone(), now: now.clone() };
        let garden = app.world_mut().spawn(drawn.clone()).id();
        land(&mut app, garden, drawn);
        group.bench_function(BenchmarkId::new("between steps", leaves(now)), |bencher| {
            let mut k = 0.0;
            bencher.iter(|| {
                k = (k + 0.01) % 1.0;
                app.world_mut().entity_mut(garden).insert(StepFraction(k));
                app.update();
            });
        });
    }
    group.finish();
}

criterion_group!(benches, frame);
criterion_main!(benches);
