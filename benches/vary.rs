//! A thousand siblings of a plant of 500 internodes.
//!
//! ```sh
//! cargo bench --no-default-features --bench vary
//! ```

#[path = "../tests/common/skeletons.rs"]
mod skeletons;

use burgeon::environment::workers::Workers;
use burgeon::tropism::vary::{Variation, siblings};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use skeletons::five_hundred_internodes;

fn vary(c: &mut Criterion) {
    let base = five_hundred_internodes();
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
