//! What the paper asks of light and space, by row.

use std::f32::consts::PI;

use bevy::math::{Quat, Vec3};
use burgeon::environment::cube_map::{CubeFace, CubeMap};
use burgeon::environment::direct_light::{LightRays, ball_solid_angle, direct_light};
use burgeon::environment::probe::{Probe, Sensing, SensingMode, TexelWeight};
use burgeon::environment::sense::{Search, SenseRequest, fitness_given_away, sense};
use burgeon::environment::trace::{Seen, Tracer};
use burgeon::environment::workers::Workers;
use burgeon::environment::{
    Capsule, Lamp, LeafPatch, Scene, Sky, SkyGradient, SolidShape, StandingLamp, StandingSolid, SunLight,
};
use burgeon::shape::outline::LeafOutline;
use burgeon::species::LightReading;

const FACE: u32 = 32;
const WEIGHTS: [TexelWeight; 2] = [TexelWeight::Alike, TexelWeight::SolidAngle];

fn look(scene: &Scene, position: Vec3) -> CubeMap {
    CubeMap::render(&Tracer::build(scene), position, FACE, &[])
}

fn close(a: f32, b: f32, tolerance: f32) {
    assert!((a - b).abs() <= tolerance, "{a} is not {b}");
}

fn block(size: Vec3, position: Vec3) -> StandingSolid {
    StandingSolid { shape: SolidShape::Box { size }, position, rotation: Quat::IDENTITY, color: [0.5; 3] }
}

/// A wall without end whose surface stands at x = `x`, to the east.
fn endless_wall(x: f32) -> StandingSolid {
    block(Vec3::new(1.0, 1e5, 1e5), Vec3::X * (x + 0.5))
}

fn lamp(position: Vec3, strength: f32, radius: f32) -> StandingLamp {
    StandingLamp { lamp: Lamp { strength, radius, on: true, color: [1.0; 3] }, position }
}

fn night() -> Sky {
    Sky { strength: 0.0, gradient: SkyGradient::Uniform }
}

fn probe(position: Vec3, face: u32) -> Probe {
    Probe { position, blind_to: [u32::MAX - 1; 2], face, space_range: 1.0 }
}

/// A crown of leaves and twigs: a few hundred occluders within a metre of the origin.
fn crown(leaves: u32) -> Scene {
    let mut scene = Scene { ground: Some(-1.0), ..Scene::default() };
    let point = |i: u32, salt: u32| {
        let noise = |k: u32| {
            let x = (i * 3 + k + salt * 7919).wrapping_mul(2_654_435_761);
            let x = (x ^ (x >> 15)).wrapping_mul(2_246_822_519);
            ((x ^ (x >> 13)) >> 8) as f32 / (1 << 24) as f32 * 2.0 - 1.0
        };
        Vec3::new(noise(0), noise(1), noise(2))
    };
    for i in 0..leaves {
        let base = point(i, 1);
        let midrib = point(i, 2).normalize() * 0.12;
        let across = midrib.any_orthogonal_vector() * 0.5;
        let outline = LeafOutline::ALL[i as usize % 5];
        scene.leaves.push(LeafPatch { base, midrib, across, outline, organ: 2 * i, plant: 0 });
        let (from, to) = (base, base - base * 0.2);
        scene.capsules.push(Capsule { from, to, radius: 0.008, organ: 2 * i + 1, plant: 0 });
    }
    scene
}

fn buds(scene: &Scene, reading: LightReading) -> Vec<SenseRequest> {
    scene
        .leaves
        .iter()
        .step_by(7)
        .map(|leaf| {
            let rotation = Quat::from_rotation_arc(Vec3::Y, leaf.base.normalize());
            let probe = Probe { blind_to: [leaf.organ, leaf.organ + 1], ..probe(leaf.base, 12) };
            SenseRequest { reading, ..SenseRequest::bud(probe, rotation, 0.7, 0.2) }
        })
        .collect()
}

#[test]
fn lk_13_faces_cover_every_direction_once() {
    for face in CubeFace::ALL {
        let scene = Scene { solids: vec![block(Vec3::ONE, face.direction() * 2.0)], ..Scene::default() };
        let map = look(&scene, Vec3::ZERO);
        for other in CubeFace::ALL {
            let seen = map.face(other).iter().any(|texel| texel.seen == Seen::Solid(0));
            assert_eq!(seen, other == face);
        }
    }
}

#[test]
fn lk_13_the_horizon_lies_half_way_up_and_the_lamp_where_it_hangs() {
    let scene = Scene {
        ground: Some(0.0),
        lamps: vec![lamp(Vec3::new(1.0, 3.0, -6.0), 1.0, 0.4)],
        ..Scene::default()
    };
    let map = look(&scene, Vec3::Y);
    let north = map.face(CubeFace::North);
    let n = map.size();
    assert!(north[..n * n / 2].iter().all(|texel| texel.seen != Seen::Ground));
    assert!(north[n * n / 2..].iter().all(|texel| texel.seen == Seen::Ground));
    let lamp = north.iter().position(|texel| texel.seen == Seen::Lamp(0)).unwrap();
    let (column, row) = (lamp % n, lamp / n);
    assert!(column > n / 2 && row < n / 2, "{column} {row}");
}

#[test]
fn lk_14_no_geometry_is_all_light() {
    let scene = Scene::default();
    let map = look(&scene, Vec3::new(3.0, 4.0, -5.0));
    for weight in WEIGHTS {
        assert_eq!(map.share(weight), 1.0);
        assert_eq!(map.space(1.0, weight), 1.0);
    }
    close(map.sky_light(&Sky::default()), 1.0, 1e-4);
    close(map.sky_light(&Sky { gradient: SkyGradient::Overcast, ..Sky::default() }), 1.0, 0.01);
}

#[test]
fn lk_14_infinite_ground_halves_the_light() {
    let scene = Scene { ground: Some(0.0), ..Scene::default() };
    for height in [0.0, 0.01, 1.0, 50.0] {
        let map = look(&scene, Vec3::Y * height);
        for weight in WEIGHTS {
            close(map.share(weight), 0.5, 0.005);
        }
        close(map.sky_light(&Sky::default()), 0.5, 0.005);
    }
}

#[test]
fn lk_14_ground_touching_an_infinite_wall_quarters_the_light() {
    let scene = Scene { ground: Some(0.0), solids: vec![endless_wall(1.0)], ..Scene::default() };
    let map = look(&scene, Vec3::Y * 0.5);
    for weight in WEIGHTS {
        close(map.share(weight), 0.25, 0.0025);
    }
    close(map.sky_light(&Sky::default()), 0.25, 0.0025);
}

#[test]
fn lk_14_a_face_looking_straight_at_a_wall_reads_its_distance_over_the_range() {
    for distance in [0.1, 0.5, 1.9] {
        let scene = Scene { solids: vec![endless_wall(distance)], ..Scene::default() };
        let map = look(&scene, Vec3::ZERO);
        for weight in WEIGHTS {
            let east = map.faces(&Sky::default(), 2.0, weight)[0];
            close(east.space, distance / 2.0, 0.01 * distance / 2.0);
            close(east.depth, distance, 0.01 * distance);
            assert_eq!((east.share, east.light), (0.0, 0.0));
        }
    }
}

#[test]
fn lk_13_depth_is_clamped_to_the_range() {
    let scene = Scene { solids: vec![endless_wall(5.0)], ..Scene::default() };
    assert_eq!(look(&scene, Vec3::ZERO).space(2.0, TexelWeight::Alike), 1.0);
}

#[test]
fn lk_13_a_lamp_gives_its_strength_by_its_solid_angle() {
    let workers = Workers::default();
    for (distance, radius) in [(3.0, 0.1), (1.0, 0.5), (20.0, 0.05)] {
        let expected = 2.0 * ball_solid_angle(radius, distance) / (4.0 * PI);
        for texel in 0..8 {
            // Moved across a texel of an 8 x 8 face, the lamp stays as bright.
            let direction = Vec3::new(0.3 + texel as f32 / 28.0, 0.4, -1.0).normalize();
            let scene = Scene {
                sky: night(),
                lamps: vec![lamp(direction * distance, 2.0, radius)],
                ..Scene::default()
            };
            let request = SenseRequest::leaf(Vec3::ZERO, [u32::MAX - 1; 2], 8, 1.0, LightReading::Radiance);
            let light = sense(&Tracer::build(&scene), &[request], &Sensing::default(), &workers)[0].light;
            close(light, expected.min(1.0), 0.03 * expected);
        }
    }
}

#[test]
fn lk_13_the_solid_angle_of_a_ball() {
    close(ball_solid_angle(1.0, 1.000_001), 2.0 * PI, 0.02);
    close(ball_solid_angle(0.001, 100.0), PI * 1e-10, 1e-15);
    assert_eq!(ball_solid_angle(1.0, 0.5), 4.0 * PI);
}

#[test]
fn lk_13_a_hidden_lamp_gives_nothing_and_a_half_hidden_one_half() {
    let mut scene = Scene { sky: night(), lamps: vec![lamp(Vec3::Z * 3.0, 5.0, 0.3)], ..Scene::default() };
    let light = |scene: &Scene| direct_light(&Tracer::build(scene), Vec3::ZERO, &[], LightRays::FINE);
    let free = light(&scene);
    scene.solids = vec![block(Vec3::new(2.0, 2.0, 0.1), Vec3::Z)];
    assert_eq!(light(&scene), 0.0);
    scene.solids[0].position.x = 1.0;
    close(light(&scene), free / 2.0, 0.1 * free);
    scene.solids.clear();
    scene.lamps[0].lamp.on = false;
    assert_eq!(light(&scene), 0.0);
    scene.lamps[0].lamp.on = true;
    scene.lamps[0].position = Vec3::Z * 0.2;
    assert_eq!(light(&scene), 5.0);
}

#[test]
fn lk_13_a_lamp_that_is_off_is_only_an_obstacle() {
    let mut scene = Scene { lamps: vec![lamp(Vec3::Z * 1.0, 5.0, 0.5)], ..Scene::default() };
    assert_eq!(look(&scene, Vec3::ZERO).share(TexelWeight::Alike), 1.0);
    assert!(look(&scene, Vec3::ZERO).space(2.0, TexelWeight::Alike) < 1.0);
    scene.lamps[0].lamp.on = false;
    let map = look(&scene, Vec3::ZERO);
    close(map.share(TexelWeight::SolidAngle), 1.0 - ball_solid_angle(0.5, 1.0) / (4.0 * PI), 0.002);
    let tracer = Tracer::build(&scene);
    close(map.light(&tracer, &[]), map.share(TexelWeight::SolidAngle), 1e-3);
}

#[test]
fn lk_13_the_sun_gives_its_strength_where_it_is_seen_and_exposure_saturates() {
    let mut scene = Scene {
        sky: night(),
        sun: Some(SunLight { direction: Vec3::new(0.6, 0.8, 0.0), strength: 0.7 }),
        solids: vec![block(Vec3::new(0.1, 2.0, 2.0), Vec3::X)],
        ..Scene::default()
    };
    let light = |scene: &Scene, at: Vec3| look(scene, at).light(&Tracer::build(scene), &[]);
    assert_eq!(light(&scene, Vec3::X * 2.0), 0.7);
    assert_eq!(light(&scene, Vec3::Y * -1.0), 0.0);
    scene.sky = Sky::default();
    assert_eq!(light(&scene, Vec3::X * 2.0), 1.0);
}

#[test]
fn lk_13_an_organ_never_hides_itself_nor_its_own_bud() {
    let scene = Scene {
        capsules: vec![
            Capsule { from: Vec3::ZERO, to: Vec3::Y, radius: 0.05, organ: 1, plant: 0 },
            // The next internode is another organ, but its rounded end encloses the bud.
            Capsule { from: Vec3::Y, to: Vec3::Y * 1.01, radius: 0.05, organ: 2, plant: 0 },
        ],
        leaves: vec![LeafPatch {
            base: Vec3::new(-0.05, 1.04, 0.0),
            midrib: Vec3::X * 0.1,
            across: Vec3::Z * 0.05,
            outline: LeafOutline::Needle,
            organ: 3,
            plant: 0,
        }],
        ..Scene::default()
    };
    let tracer = Tracer::build(&scene);
    let share = |blind| CubeMap::render(&tracer, Vec3::Y, 8, blind).share(TexelWeight::Alike);
    assert_eq!(share(&[1, 3]), 1.0);
    assert!(share(&[1]) < 0.95);
}

#[test]
fn lk_15_in_the_open_a_bud_grows_straight_on() {
    let scene = Scene::default();
    let tracer = Tracer::build(&scene);
    let rotation = Quat::from_rotation_z(1.0);
    for mode in [SensingMode::MapPerCandidate, SensingMode::Reprojected] {
        for reading in [LightReading::Share, LightReading::Radiance] {
            let request =
                SenseRequest { reading, ..SenseRequest::bud(probe(Vec3::ZERO, 12), rotation, 0.7, 0.2) };
            let sensing = Sensing { mode, ..Sensing::default() };
            let choice = sense(&tracer, &[request], &sensing, &Workers::default())[0].choice.unwrap();
            assert_eq!(choice.index, 0);
            assert!(choice.heading.distance(rotation * Vec3::Y) < 1e-6);
        }
    }
}

#[test]
fn lk_15_a_bud_turns_from_a_wall_and_to_a_lamp() {
    let wall = Scene { solids: vec![endless_wall(0.3)], ground: Some(-1.0), ..Scene::default() };
    let dusk = Sky { strength: 0.1, ..Sky::default() };
    let lit = Scene { sky: dusk, lamps: vec![lamp(Vec3::X * -0.8, 5.0, 0.2)], ..Scene::default() };
    for mode in [SensingMode::MapPerCandidate, SensingMode::Reprojected] {
        for scene in [&wall, &lit] {
            let request = SenseRequest {
                reading: LightReading::Radiance,
                ..SenseRequest::bud(probe(Vec3::ZERO, 12), Quat::IDENTITY, 0.7, 0.2)
            };
            let sensing = Sensing { mode, ..Sensing::default() };
            let sensed = sense(&Tracer::build(scene), &[request], &sensing, &Workers::default());
            assert!(sensed[0].choice.unwrap().heading.x < -0.2, "{mode:?} {sensed:?}");
        }
    }
}

#[test]
fn lk_15_underground_and_behind_solids_is_nowhere_to_grow() {
    // Boxed in but for the north: below is ground, and a wall thinner than the reach stands to the east.
    let scene = Scene {
        ground: Some(-0.1),
        solids: vec![block(Vec3::new(0.02, 4.0, 4.0), Vec3::X * 0.1)],
        ..Scene::default()
    };
    let tracer = Tracer::build(&scene);
    for mode in [SensingMode::MapPerCandidate, SensingMode::Reprojected] {
        for heading in [Vec3::X, Vec3::NEG_Y] {
            let rotation = Quat::from_rotation_arc(Vec3::Y, heading);
            let mut request = SenseRequest::bud(probe(Vec3::ZERO, 12), rotation, 2.0, 0.3);
            if let Some(search) = &mut request.search {
                search.candidates = 60;
            }
            let sensing = Sensing { mode, ..Sensing::default() };
            let choice = sense(&tracer, &[request], &sensing, &Workers::default())[0].choice.unwrap();
            let end = choice.heading * 0.3;
            assert!(end.x < 0.09 && end.y > -0.1, "{mode:?} {end}");
            assert!(choice.light > 0.0 && choice.space > 0.0);
        }
    }
}

#[test]
fn lk_15_other_wood_is_nowhere_to_grow() {
    let stem = Capsule {
        from: Vec3::new(0.0, 0.2, -1.0),
        to: Vec3::new(0.0, 0.2, 1.0),
        radius: 0.1,
        organ: 9,
        plant: 0,
    };
    let scene = Scene { capsules: vec![stem], ..Scene::default() };
    for mode in [SensingMode::MapPerCandidate, SensingMode::Reprojected] {
        let request = SenseRequest::bud(probe(Vec3::ZERO, 12), Quat::IDENTITY, 0.9, 0.2);
        let sensing = Sensing { mode, ..Sensing::default() };
        let choice =
            sense(&Tracer::build(&scene), &[request], &sensing, &Workers::default())[0].choice.unwrap();
        assert!((choice.heading * 0.2).with_z(0.0).distance(Vec3::Y * 0.2) > 0.1, "{mode:?} {choice:?}");
    }
}

#[test]
fn lk_15_the_fast_way_gives_little_fitness_away() {
    let scene = crown(400);
    let tracer = Tracer::build(&scene);
    for reading in [LightReading::Share, LightReading::Radiance] {
        for weight in WEIGHTS {
            let mut requests = buds(&scene, reading);
            for request in &mut requests {
                request.search = request.search.map(|search| Search { rescale: false, ..search });
            }
            let sensing = Sensing { weight, ..Sensing::default() };
            let given = fitness_given_away(&tracer, &requests, &sensing, &Workers::default());
            assert!(given.mean_loss < 0.25 * given.mean_spread, "{given:?}");
        }
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let mut scene = crown(300);
    scene.lamps = vec![lamp(Vec3::new(2.0, 1.0, 0.0), 3.0, 0.2)];
    scene.sun = Some(SunLight { direction: Vec3::new(0.0, 0.8, 0.6), strength: 0.2 });
    let tracer = Tracer::build(&scene);
    let requests = buds(&scene, LightReading::Radiance);
    let one = sense(&tracer, &requests, &Sensing::default(), &Workers::new(1).unwrap());
    for threads in [2, 4] {
        assert_eq!(one, sense(&tracer, &requests, &Sensing::default(), &Workers::new(threads).unwrap()));
    }
    assert!(
        one.iter().all(|sensed| (0.0..=1.0).contains(&sensed.light) && (0.0..=1.0).contains(&sensed.space))
    );
}
