use bevy::math::Quat;

use super::*;
use crate::environment::scene::{Capsule, Lamp, LeafPatch, SolidShape, StandingLamp, StandingSolid};
use crate::shape::outline::LeafOutline;

fn rod(from: Vec3, to: Vec3, radius: f32, organ: u32) -> Capsule {
    Capsule { from, to, radius, organ, plant: 0 }
}

fn leaf(base: Vec3, midrib: Vec3, across: Vec3, organ: u32) -> LeafPatch {
    LeafPatch { base, midrib, across, outline: LeafOutline::Elliptic, organ, plant: 0 }
}

fn solid(shape: SolidShape, position: Vec3, rotation: Quat) -> StandingSolid {
    StandingSolid { shape, position, rotation, color: [0.5; 3] }
}

fn lamp(position: Vec3, radius: f32, on: bool) -> StandingLamp {
    StandingLamp { lamp: Lamp { strength: 1.0, radius, on, color: [1.0; 3] }, position }
}

/// Numbers 0..1 that look random.
fn noise(seed: &mut u32) -> f32 {
    *seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    (*seed >> 8) as f32 / (1 << 24) as f32
}

fn jumble(count: usize) -> Scene {
    let mut seed = 7;
    let mut point = |scale: f32| {
        Vec3::new(noise(&mut seed) - 0.5, noise(&mut seed) - 0.5, noise(&mut seed) - 0.5) * scale
    };
    let mut scene = Scene { ground: Some(-2.0), ..Scene::default() };
    for i in 0..count as u32 {
        let at = point(4.0);
        scene.capsules.push(rod(at, at + point(0.6), 0.01 + 0.02 * (i % 3) as f32, 2 * i));
        let midrib = point(0.4);
        let across = midrib.any_orthogonal_vector() * 0.4;
        scene.leaves.push(leaf(point(4.0), midrib, across, 2 * i + 1));
    }
    let turn = Quat::from_xyzw(0.1, 0.5, -0.3, 0.8).normalize();
    scene.solids = vec![
        solid(SolidShape::Box { size: Vec3::new(0.5, 1.0, 0.2) }, Vec3::new(1.0, 0.5, -1.0), turn),
        solid(SolidShape::Ball { radius: 0.4 }, Vec3::new(-1.0, 0.5, 1.0), turn),
        solid(SolidShape::Cylinder { radius: 0.3, height: 1.2 }, Vec3::new(-1.2, 0.0, -1.0), turn),
    ];
    scene.lamps = vec![lamp(Vec3::new(0.5, 1.5, 0.5), 0.2, true), lamp(Vec3::new(1.5, 0.0, 1.5), 0.2, false)];
    scene
}

/// Every occluder tested in turn.
fn in_turn(scene: &Scene, origin: Vec3, d: Vec3, blind: &[u32]) -> (f32, Seen) {
    let tracer = Tracer { scene, nodes: Vec::new(), items: Vec::new() };
    let ground = tracer.ground(origin, d).map(|t| (t, (UNBORN, 9, 0), Seen::Ground));
    gather(scene)
        .iter()
        .filter(|item| !item.is_unseen_from(origin, blind))
        .filter_map(|item| Some((item.distance(origin, d, d.length_squared())?, item.rank(), item.seen)))
        .chain(ground)
        .min_by(|a, b| (a.0, a.1).partial_cmp(&(b.0, b.1)).unwrap())
        .map_or((f32::INFINITY, Seen::Sky), |(t, _, seen)| (t, seen))
}

#[test]
fn nothing_is_lost_in_the_boxes() {
    let scene = jumble(60);
    let tracer = Tracer::build(&scene);
    let mut seed = 99;
    let mut unit = || noise(&mut seed) - 0.5;
    for _ in 0..3000 {
        let origin = Vec3::new(unit(), unit(), unit()) * 5.0;
        let d = Vec3::new(unit(), unit(), unit());
        let hit = tracer.closest(origin, d, f32::INFINITY, &[3]);
        assert_eq!((hit.t, hit.seen), in_turn(&scene, origin, d, &[3]));
        let hidden = hit.seen != Seen::Sky;
        if !matches!(hit.seen, Seen::Lamp(_)) {
            assert_eq!(tracer.occluded(origin, d, f32::INFINITY, &[3]), hidden);
        }
        assert!(hit.seen == Seen::Sky || hit.normal.dot(d) <= 0.0);
    }
}

#[test]
fn lk_13_of_equal_depths_the_lowest_birth_is_seen() {
    let twins = [9, 4, 7].map(|organ| leaf(Vec3::Z, Vec3::X, Vec3::Y * 0.5, organ));
    for turn in 0..3 {
        let mut leaves = twins.to_vec();
        leaves.rotate_left(turn);
        let scene = Scene { leaves, ..Scene::default() };
        let tracer = Tracer::build(&scene);
        let hit = tracer.closest(Vec3::X * 0.5, Vec3::Z, f32::INFINITY, &[]);
        assert_eq!(tracer.birth(hit.seen), Some(4));
        assert_eq!(hit.t, 1.0);
    }
}

#[test]
fn an_organ_never_hides_itself_nor_its_own_bud() {
    // A bud on the tip of internode 1, in the rounded joint of internode 2, under leaf 3.
    let scene = Scene {
        capsules: vec![rod(Vec3::ZERO, Vec3::Y, 0.1, 1), rod(Vec3::Y, Vec3::new(0.0, 1.5, 0.5), 0.1, 2)],
        leaves: vec![leaf(Vec3::new(-0.5, 1.2, 0.0), Vec3::X, Vec3::Z * 0.4, 3)],
        ..Scene::default()
    };
    let tracer = Tracer::build(&scene);
    let see = |d, blind: &[u32]| tracer.birth(tracer.closest(Vec3::Y, d, f32::INFINITY, blind).seen);
    assert_eq!(see(Vec3::Y, &[1]), Some(3));
    assert_eq!(see(Vec3::Y, &[1, 3]), None);
    assert_eq!(see(Vec3::NEG_Y, &[]), None);
    assert_eq!(see(Vec3::new(0.0, 1.0, 1.0), &[3]), None);
    assert!(tracer.occluded(Vec3::Y, Vec3::Y, 1.0, &[]));
    assert!(!tracer.occluded(Vec3::Y, Vec3::Y, 1.0, &[3]));
    assert!(!tracer.occluded(Vec3::Y, Vec3::Y, 0.1, &[]));
}

#[test]
fn inside_a_solid_and_underground_it_is_dark() {
    for shape in [
        SolidShape::Box { size: Vec3::ONE },
        SolidShape::Ball { radius: 0.5 },
        SolidShape::Cylinder { radius: 0.5, height: 1.0 },
    ] {
        let scene = Scene {
            solids: vec![solid(shape, Vec3::ZERO, Quat::IDENTITY)],
            ground: Some(-5.0),
            ..Scene::default()
        };
        let tracer = Tracer::build(&scene);
        for d in [Vec3::X, Vec3::Y, Vec3::new(-0.3, -0.2, 0.9)] {
            let hit = tracer.closest(Vec3::splat(0.1), d, 100.0, &[]);
            assert_eq!((hit.t, hit.seen), (0.0, Seen::Solid(0)));
            let hit = tracer.closest(Vec3::new(3.0, -6.0, 0.0), d, 100.0, &[]);
            assert_eq!((hit.t, hit.seen), (0.0, Seen::Ground));
        }
        assert!(tracer.is_buried(Vec3::ZERO) && tracer.is_buried(Vec3::Y * -6.0));
        assert!(!tracer.is_buried(Vec3::Y));
    }
}

#[test]
fn burning_lamps_are_seen_but_hide_nothing() {
    for on in [true, false] {
        let scene = Scene { lamps: vec![lamp(Vec3::Y * 3.0, 0.5, on)], ..Scene::default() };
        let tracer = Tracer::build(&scene);
        let hit = tracer.closest(Vec3::ZERO, Vec3::Y, f32::INFINITY, &[]);
        assert_eq!((hit.t, hit.seen), (2.5, Seen::Lamp(0)));
        assert_eq!(tracer.is_light(hit.seen), on);
        assert_eq!(tracer.occluded(Vec3::ZERO, Vec3::Y, 10.0, &[]), !on);
    }
}

#[test]
fn thin_wood_far_away_is_met() {
    let scene = Scene { capsules: vec![rod(Vec3::NEG_X, Vec3::X, 0.001, 0)], ..Scene::default() };
    let tracer = Tracer::build(&scene);
    let origin = Vec3::new(30.0, 40.0, 20.0);
    let hit = tracer.closest(origin, (Vec3::X * 0.3 - origin).normalize(), f32::INFINITY, &[]);
    assert_eq!(hit.seen, Seen::Wood(0));
    let past = Vec3::new(0.3, 0.01, 0.0) - origin;
    assert_eq!(tracer.closest(origin, past.normalize(), f32::INFINITY, &[]).seen, Seen::Sky);
}

#[test]
fn occluders_without_extent_or_not_finite_are_left_out() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0];
    let mut scene = jumble(1);
    scene.ground = None;
    for x in bad {
        scene.capsules.push(rod(Vec3::splat(x), Vec3::Y, x, 5));
        scene.capsules.push(rod(Vec3::ZERO, Vec3::ZERO, x, 5));
        scene.leaves.push(leaf(Vec3::ZERO, Vec3::splat(x), Vec3::X, 6));
        scene.leaves.push(leaf(Vec3::splat(x), Vec3::Y, Vec3::ZERO, 6));
        scene.lamps.push(lamp(Vec3::splat(x), x, true));
        scene.solids.push(solid(SolidShape::Ball { radius: x }, Vec3::ZERO, Quat::IDENTITY));
        scene.solids.push(solid(SolidShape::Box { size: Vec3::splat(x) }, Vec3::ZERO, Quat::IDENTITY));
    }
    assert_eq!(gather(&scene).len(), gather(&jumble(1)).len());
    let tracer = Tracer::build(&scene);
    for x in bad {
        let hit = tracer.closest(Vec3::splat(x), Vec3::splat(x), x, &[]);
        assert_eq!(hit, Hit::SKY);
        assert!(!tracer.occluded(Vec3::splat(x), Vec3::splat(x), x, &[]));
    }
    let empty = Scene::default();
    assert_eq!(Tracer::build(&empty).closest(Vec3::ZERO, Vec3::X, f32::INFINITY, &[]), Hit::SKY);
    // A piece of no length is a ball.
    let dot = Scene { capsules: vec![rod(Vec3::X, Vec3::X, 0.25, 0)], ..Scene::default() };
    assert_eq!(Tracer::build(&dot).closest(Vec3::ZERO, Vec3::X, f32::INFINITY, &[]).t, 0.75);
}

#[test]
fn a_face_at_once_sees_what_single_rays_see() {
    let scene = jumble(80);
    let tracer = Tracer::build(&scene);
    let frame = Frame { right: (2, -1.0), up: (1, 1.0), forward: (0, -1.0) };
    let mut texels = Vec::new();
    for size in [1, 3, 8, 13] {
        let rays = FaceRays::new(frame, size);
        for origin in [Vec3::ZERO, Vec3::new(1.0, 0.5, -1.0), Vec3::new(2.5, 0.1, 0.3), Vec3::Y * -3.0] {
            texels.clear();
            tracer.face(&rays, origin, &[2, 5], &mut texels);
            for (texel, &d) in texels.iter().zip(&rays.directions) {
                let hit = tracer.closest(origin, d, f32::INFINITY, &[2, 5]);
                assert_eq!((texel.depth, texel.seen), (hit.t, hit.seen));
            }
        }
    }
}
