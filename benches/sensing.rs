//! How long sensing takes: building the tracer, cube maps against crowns of several sizes, and a whole step.

use std::hint::black_box;

use bevy::math::{Quat, Vec3, ops};
use burgeon::environment::cube_map::CubeMap;
use burgeon::environment::probe::{Probe, Sensing, SensingMode};
use burgeon::environment::sense::{SenseRequest, sense};
use burgeon::environment::trace::Tracer;
use burgeon::environment::workers::Workers;
use burgeon::environment::{Capsule, LeafPatch, Scene, SolidShape, StandingSolid};
use burgeon::shape::outline::LeafOutline;
use burgeon::species::LightReading;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};

/// Numbers -1..1 that look random.
struct Noise(u32);

impl Noise {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let x = (self.0 ^ (self.0 >> 15)).wrapping_mul(2_246_822_519);
        ((x ^ (x >> 13)) >> 8) as f32 / (1 << 23) as f32 - 1.0
    }

    fn in_ball(&mut self) -> Vec3 {
        loop {
            let point = Vec3::new(self.next(), self.next(), self.next());
            if (1e-3..=1.0).contains(&point.length()) {
                return point;
            }
        }
    }
}

/// A crown of `leaves` leaves, each on a twig of `twigs` internodes that leads inward, beside a wall. The
/// crown's size keeps the density of leaves that of a tree 5 m wide with 3,000.
fn crown(leaves: usize, twigs: usize) -> Scene {
    let mut noise = Noise(1);
    let size = 2.5 * ops::cbrt(leaves as f32 / 3000.0);
    let middle = Vec3::Y * (size + 1.0);
    let mut scene = Scene { ground: Some(0.0), ..Scene::default() };
    for i in 0..leaves {
        let base = middle + noise.in_ball() * size;
        let midrib = noise.in_ball().normalize() * 0.1;
        let across = midrib.any_orthogonal_vector().normalize() * 0.03;
        let organ = (i * (twigs + 1)) as u32;
        scene.leaves.push(LeafPatch { base, midrib, across, outline: LeafOutline::Lobed, organ, plant: 0 });
        let mut from = base;
        for k in 0..twigs {
            let inward = (middle - Vec3::Y * size - from).normalize() + noise.in_ball() * 0.7;
            let to = from + inward * 0.08;
            let radius = 0.002 + 0.001 * k as f32;
            scene.capsules.push(Capsule { from, to, radius, organ: organ + 1 + k as u32, plant: 0 });
            from = to;
        }
    }
    let size = Vec3::new(0.3, 4.0, 8.0);
    scene.solids.push(StandingSolid {
        shape: SolidShape::Box { size },
        position: Vec3::new(3.5, 2.0, 0.0),
        rotation: Quat::IDENTITY,
        color: [0.5; 3],
    });
    scene
}

fn leaf_requests(scene: &Scene) -> Vec<SenseRequest> {
    let request = |leaf: &LeafPatch| {
        let blind_to = [leaf.organ, leaf.organ + 1];
        SenseRequest::leaf(leaf.base + leaf.midrib * 0.5, blind_to, 8, 1.0, LightReading::Radiance)
    };
    scene.leaves.iter().map(request).collect()
}

fn bud_requests(scene: &Scene, count: usize) -> Vec<SenseRequest> {
    let step = (scene.leaves.len() / count).max(1);
    let request = |leaf: &LeafPatch| {
        let probe =
            Probe { position: leaf.base, blind_to: [leaf.organ, leaf.organ + 1], face: 12, space_range: 1.0 };
        let rotation = Quat::from_rotation_arc(Vec3::Y, leaf.midrib.normalize());
        let mut request = SenseRequest::bud(probe, rotation, 0.6, 0.3);
        request.reading = LightReading::Radiance;
        if let Some(search) = &mut request.search {
            search.candidates = 25;
        }
        request
    };
    scene.leaves.iter().step_by(step).take(count).map(request).collect()
}

fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tracer");
    for occluders in [2_000, 20_000, 200_000] {
        let scene = crown(occluders / 4, 3);
        group.sample_size(10);
        group.bench_with_input(BenchmarkId::new("build", occluders), &scene, |b, scene| {
            b.iter(|| black_box(Tracer::build(scene)));
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("cube maps");
    for occluders in [2_000, 20_000, 200_000] {
        let scene = crown(occluders / 4, 3);
        let tracer = Tracer::build(&scene);
        let requests: Vec<_> =
            leaf_requests(&scene).into_iter().step_by(occluders / 2_000).take(500).collect();
        group.sample_size(10).throughput(Throughput::Elements(requests.len() as u64));
        for face in [8, 12] {
            group.bench_function(BenchmarkId::new(format!("face {face}"), occluders), |b| {
                b.iter(|| {
                    let look = |request: &SenseRequest| {
                        let Probe { position, ref blind_to, .. } = request.probe;
                        CubeMap::render(&tracer, position, face, blind_to).share(Default::default())
                    };
                    requests.iter().map(look).sum::<f32>()
                });
            });
        }
    }
    group.finish();

    let mut group = criterion.benchmark_group("3000 leaves and 500 buds");
    group.sample_size(10);
    for twigs in [3, 9] {
        let scene = crown(3000, twigs);
        let leaves = leaf_requests(&scene);
        let buds = bud_requests(&scene, 500);
        let all = [leaves.clone(), buds.clone()].concat();
        let occluders = scene.leaves.len() + scene.capsules.len();
        for threads in [1, 2] {
            let Ok(workers) = Workers::new(threads) else { continue };
            let id = |part| BenchmarkId::new(part, format!("{occluders} occluders, {threads} threads"));
            for (part, requests) in [("leaves", &leaves), ("buds", &buds), ("all", &all)] {
                group.bench_function(id(part), |b| {
                    b.iter(|| sense(&Tracer::build(&scene), requests, &Sensing::default(), &workers));
                });
            }
        }
    }
    let scene = crown(3000, 3);
    let requests = bud_requests(&scene, 20);
    let sensing = Sensing { mode: SensingMode::MapPerCandidate, ..Sensing::default() };
    group.bench_function("20 buds, a map for each of 25 candidates", |b| {
        b.iter(|| sense(&Tracer::build(&scene), &requests, &sensing, &Workers::default()));
    });
    group.finish();
}

criterion_group!(sensing, benches);
criterion_main!(sensing);
