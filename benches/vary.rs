//! A thousand siblings of a plant of 500 internodes.
//!
//! ```sh
//! cargo bench --no-default-features --bench vary
//! ```

use bevy::prelude::*;
use burgeon::environment::workers::Workers;
use burgeon::plant::skeleton::Skeleton;
use burgeon::tropism::vary::{Variation, siblings};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

/// A trunk of a hundred internodes with an arched side branch at every fifth.
fn plant() -> Skeleton {
    let mut plant = Skeleton::default();
    let up = |k: usize| Vec3::new(0.0, 0.05 * k as f32, 0.0);
    let trunk = plant.add_stem(None, &(0..=100).map(up).collect::<Vec<_>>(), [0.04, 0.01]);
    for k in (0..100).step_by(5) {
        let side = Quat::from_rotation_y(2.4 * k as f32) * Vec3::X;
        let arch = |j: usize| up(k + 1) + (side + Vec3::Y * (0.4 - 0.02 * j as f32)) * 0.05 * j as f32;
        plant.add_stem(Some(trunk[k]), &(0..=20).map(arch).collect::<Vec<_>>(), [0.01, 0.004]);
    }
    plant
}

fn vary(c: &mut Criterion) {
    let base = plant();
    let mut group = c.benchmark_group("1000 siblings of 500 internodes");
    group.sample_size(10);
    for threads in [1, 2] {
        let workers = Workers::new(threads).unwrap_or_default();
        group.bench_function(BenchmarkId::from_parameter(format!("{threads} threads")), |b| {
            b.iter(|| siblings(&base, &Variation::default(), 1, 1000, &workers).map(|all| all.len()));
        });
    }
    group.finish();
}

criterion_group!(benches, vary);
criterion_main!(benches);
