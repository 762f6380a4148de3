//! A growth step by stage on groves of about 1,000, 4,000 and 16,000 leaves, on one thread and on two.
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
use burgeon::plant::{NO_PARENT, PlantRecord, restore};
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

/// An oak as soon as it carries a thousand leaves.
fn oak() -> Snapshot {
    let mut world = world(0);
    let oak = Species::named("oak").unwrap_or_default();
    world.spawn((Plant::new(oak, 1), Transform::default()));
    loop {
        grow(&mut world, 1);
        let tree = Snapshot::take(&world);
        if Form::of(&tree, None).leaves >= 1_000 || tree.step > 40 {
            return tree;
        }
    }
}

/// Copies of a tree in rows of four, a few metres apart: crowns that meet, at the leaves and buds of a forest.
fn grove(tree: &Snapshot, copies: u32) -> Snapshot {
    let mut grove = Snapshot { step: tree.step, ..Snapshot::default() };
    for copy in 0..copies {
        let offset = grove.len() as u32;
        let moved = Vec3::new((copy % 4) as f32, 0.0, (copy / 4) as f32) * 4.0;
        let shift = |i: u32| if i == NO_PARENT { NO_PARENT } else { i + offset };
        grove.plants.extend(
            tree.plants
                .iter()
                .cloned()
                .map(|plant| plant.map(|plant| PlantRecord { position: plant.position + moved, ..plant })),
        );
        grove.birth.extend(tree.birth.iter().map(|b| b + grove.next_birth));
        grove.next_birth += tree.next_birth;
        grove.parent.extend(tree.parent.iter().map(|p| shift(*p)));
        grove.plant.extend(tree.plant.iter().map(|_| copy));
        grove.lineage.extend(&tree.lineage);
        grove.span.extend(&tree.span);
        grove.order.extend(&tree.order);
        grove.attachment.extend(&tree.attachment);
        grove.pose.extend(tree.pose.iter().map(|p| Pose { position: p.position + moved, ..*p }));
        grove.exposure.extend(&tree.exposure);
        grove.allotment.extend(&tree.allotment);
        grove.flow.extend(&tree.flow);
        grove.state.extend(&tree.state);
    }
    grove
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
    println!(
        "leaves  buds looking  organs  threads  generate  update  sense   finish  ns an organ but sensing"
    );
    let mut whole = Vec::new();
    for (_, shot) in shots {
        let form = Form::of(shot, None);
        for threads in [1, 2] {
            let (seconds, organs) = stages(shot, threads, if shot.len() > 50_000 { 1 } else { 3 });
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
    let tree = oak();
    let shots: Vec<(u32, Snapshot)> = [1, 4, 16].map(|n| (n * 1_000, grove(&tree, n))).into();
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
