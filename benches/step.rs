//! A growth step by stage on trees of about 1,000, 4,000 and 16,000 leaves, on one thread and on two.
//!
//! ```sh
//! cargo bench --no-default-features --bench step
//! ```
//!
//! Before criterion's own figures a table is printed: seconds a stage, nanoseconds an organ in all stages but
//! sensing, and the power of the number of leaves that a step's time grows with.

use std::time::{Duration, Instant};

use bevy::prelude::*;
use burgeon::growth::finish::StageTimes;
use burgeon::plant::measure::Form;
use burgeon::plant::restore;
use burgeon::prelude::*;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

/// A world with Burgeon in it and a number of threads.
fn world(threads: usize) -> World {
    let mut app = App::new();
    let workers = Workers::new(threads).unwrap_or_default();
    app.insert_resource(workers).add_plugins(BurgeonPlugins);
    app.finish();
    std::mem::take(app.world_mut())
}

/// Three oaks, too far apart to shade each other, each grown until together they carry `leaves` leaves.
fn grown(leaves: u32) -> Snapshot {
    let mut world = world(0);
    let oak = Species::named("oak").unwrap_or_default();
    // Half a grove grows fast; more trees rather than older ones keep the ratio of leaves to buds.
    for i in 0..leaves.div_ceil(1_000) {
        let at = Transform::from_xyz(30.0 * i as f32, 0.0, 0.0);
        world.spawn((Plant::new(oak.clone(), u64::from(i) + 1), at));
    }
    loop {
        let before = Snapshot::take(&world);
        grow(&mut world, 1);
        let after = Snapshot::take(&world);
        if Form::of(&after, None).leaves >= leaves || after.step > 40 {
            return before;
        }
    }
}

/// Seconds of one step by stage from a snapshot, the median of `rounds`, and the organs at its end.
fn stages(shot: &Snapshot, threads: usize, rounds: usize) -> ([f64; 4], usize) {
    let mut organs = 0;
    let mut runs: Vec<[f64; 4]> = (0..rounds)
        .map(|_| {
            let mut world = world(threads);
            restore(&mut world, shot);
            grow(&mut world, 1);
            organs = world.resource::<Roster>().len();
            world.resource::<StageTimes>().seconds
        })
        .collect();
    runs.sort_by(|a, b| a.iter().sum::<f64>().total_cmp(&b.iter().sum::<f64>()));
    (runs[runs.len() / 2], organs)
}

fn table(shots: &[(u32, Snapshot)]) {
    println!("leaves  buds looking  organs  threads  generate  update  sense   finish  ns an organ but sensing");
    let mut whole = Vec::new();
    for (_, shot) in shots {
        let form = Form::of(shot, None);
        for threads in [1, 2] {
            let (seconds, organs) = stages(shot, threads, 3);
            let [generate, update, sense, finish] = seconds;
            let rest = (generate + update + finish) * 1e9 / organs as f64;
            println!(
                "{:6}  {:12}  {organs:6}  {threads:7}  {generate:8.4}  {update:6.4}  {sense:6.3}  {finish:6.4}  {rest:6.0}",
                form.leaves,
                form.apical_buds + form.lateral_buds,
            );
            whole.push((f64::from(form.leaves), threads, seconds.iter().sum::<f64>()));
        }
    }
    let one: Vec<_> = whole.iter().filter(|w| w.1 == 1).collect();
    let two: Vec<_> = whole.iter().filter(|w| w.1 == 2).collect();
    for (a, b) in one.iter().zip(&two) {
        println!("{:6} leaves: two threads are {:.2} times one", a.0, a.2 / b.2);
    }
    for pair in one.windows(2) {
        let power = bevy::math::ops::ln((pair[1].2 / pair[0].2) as f32)
            / bevy::math::ops::ln((pair[1].0 / pair[0].0) as f32);
        println!("from {} to {} leaves: cost grows with leaves^{power:.2}", pair[0].0, pair[1].0);
    }
}

fn step(criterion: &mut Criterion) {
    let shots: Vec<(u32, Snapshot)> = [1_000, 4_000, 16_000].map(|n| (n, grown(n))).into();
    table(&shots);
    let mut group = criterion.benchmark_group("step");
    group.sample_size(10).measurement_time(Duration::from_secs(5)).warm_up_time(Duration::from_secs(1));
    for (leaves, shot) in &shots {
        group.bench_with_input(BenchmarkId::from_parameter(leaves), shot, |bencher, shot| {
            bencher.iter_custom(|rounds| {
                (0..rounds)
                    .map(|_| {
                        let mut world = world(0);
                        restore(&mut world, shot);
                        let start = Instant::now();
                        grow(&mut world, 1);
                        start.elapsed()
                    })
                    .sum()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, step);
criterion_main!(benches);
