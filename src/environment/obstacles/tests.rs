use bevy::math::Quat;
use proptest::prelude::*;

use super::*;

fn solid(shape: SolidShape, position: Vec3, rotation: Quat) -> StandingSolid {
    StandingSolid { shape, position, rotation, color: [0.5; 3] }
}

fn wall() -> StandingSolid {
    solid(SolidShape::Box { size: Vec3::new(1.0, 10.0, 10.0) }, Vec3::X * 1.5, Quat::IDENTITY)
}

/// Distance of a capsule's axis from a solid, by many points.
fn distance(solid: &StandingSolid, from: Vec3, to: Vec3) -> f32 {
    let body = Body::solid(solid, Vec3::ZERO).unwrap();
    let local = |p: Vec3| body.inward(p - solid.position);
    (0..=200).map(|i| body.distance(local(from.lerp(to, i as f32 / 200.0)))).fold(f32::INFINITY, f32::min)
}

#[test]
fn free_growth_goes_straight() {
    let want = Advance { direction: Vec3::NEG_X, length: 5.0 };
    assert_eq!(advance(&[wall()], &[], Some(-0.1), Vec3::ZERO, want.direction, want.length, 0.05), want);
}

#[test]
fn growth_slides_along_a_wall_with_the_least_turn() {
    let direction = Vec3::new(0.8, 0.6, 0.0);
    let got = advance(&[wall()], &[], None, Vec3::ZERO, direction, 2.0, 0.05);
    assert_eq!(got.length, 2.0);
    let end = got.direction * got.length;
    assert!((end.x - 0.95).abs() < 1e-3 && end.y > 1.7, "{end}");
    // From the wall it goes on along the wall.
    let next = advance(&[wall()], &[], None, end, direction, 2.0, 0.05);
    assert!(next.length == 2.0 && next.direction.y > 0.999, "{next:?}");
}

#[test]
fn growth_straight_at_a_wall_stops_short() {
    let got = advance(&[wall()], &[], None, Vec3::X * 0.8, Vec3::X, 2.0, 0.05);
    assert_eq!(got.direction, Vec3::X);
    assert!((got.length - 0.15).abs() < 1e-3, "{got:?}");
}

#[test]
fn growth_in_a_corner_follows_its_edge() {
    let other = solid(SolidShape::Box { size: Vec3::new(10.0, 10.0, 1.0) }, Vec3::Z * 1.5, Quat::IDENTITY);
    let from = Vec3::new(0.9, 0.0, 0.9);
    let direction = Vec3::new(0.5, 0.7, 0.5).normalize();
    let got = advance(&[wall(), other], &[], None, from, direction, 1.0, 0.05);
    assert!(got.length > 0.9 && got.direction.y > 0.9, "{got:?}");
}

#[test]
fn a_seed_on_the_ground_grows_up_and_along_but_not_down() {
    let grow = |direction| advance(&[], &[], Some(0.0), Vec3::ZERO, direction, 1.0, 0.02);
    assert_eq!(grow(Vec3::Y), Advance { direction: Vec3::Y, length: 1.0 });
    assert_eq!(grow(Vec3::X), Advance { direction: Vec3::X, length: 1.0 });
    assert_eq!(grow(Vec3::NEG_Y).length, 0.0);
    let slope = grow(Vec3::new(0.8, -0.6, 0.0));
    assert!(slope.length > 0.99 && slope.direction.y > -1e-5, "{slope:?}");
}

#[test]
fn nothing_grows_inside_a_solid_or_underground() {
    let inside = advance(&[wall()], &[], None, Vec3::X * 1.2, Vec3::NEG_X, 1.0, 0.01);
    assert_eq!(inside.length, 0.0);
    assert_eq!(advance(&[], &[], Some(0.0), Vec3::Y * -0.5, Vec3::Y, 1.0, 0.01).length, 0.0);
    for bad in [f32::NAN, f32::INFINITY] {
        assert_eq!(advance(&[wall()], &[], Some(0.0), Vec3::splat(bad), Vec3::Y, 1.0, 0.01).length, 0.0);
        assert_eq!(advance(&[wall()], &[], None, Vec3::ZERO, Vec3::Y * bad, 1.0, 0.01).length, 0.0);
        assert_eq!(advance(&[wall()], &[], None, Vec3::ZERO, Vec3::Y, bad, 0.01).length, 0.0);
    }
}

#[test]
fn a_thin_plate_is_not_jumped_over() {
    let plate = solid(SolidShape::Box { size: Vec3::new(1e-4, 50.0, 50.0) }, Vec3::X * 3.0, Quat::IDENTITY);
    let got = advance(&[plate], &[], None, Vec3::ZERO, Vec3::X, 100.0, 1e-3);
    assert!((got.length - 3.0).abs() < 2e-3, "{got:?}");
    assert!(touches(&plate, Vec3::ZERO, Vec3::X * 100.0, 0.0));
    assert!(!touches(&plate, Vec3::ZERO, Vec3::X * 2.9, 0.01));
}

#[test]
fn touching_is_told_from_passing_by() {
    let ball = solid(SolidShape::Ball { radius: 1.0 }, Vec3::ZERO, Quat::IDENTITY);
    let past =
        |gap: f32| touches(&ball, Vec3::new(-5.0, 1.0 + gap, 0.0), Vec3::new(5.0, 1.0 + gap, 0.0), 0.1);
    assert!(past(0.099) && past(0.1) && !past(0.101));
    assert!(touches(&ball, Vec3::ZERO, Vec3::ZERO, 0.0));
}

fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-size..size).prop_map(Vec3::from_array)
}

fn any_solid() -> impl Strategy<Value = StandingSolid> {
    let size = || 0.02_f32..1.5;
    let shape = prop_oneof![
        (size(), size(), size()).prop_map(|(x, y, z)| SolidShape::Box { size: Vec3::new(x, y, z) }),
        size().prop_map(|radius| SolidShape::Ball { radius: radius * 0.5 }),
        (size(), size()).prop_map(|(radius, height)| SolidShape::Cylinder { radius: radius * 0.5, height }),
    ];
    (shape, vector(1.5), vector(1.0), -1.0_f32..1.0).prop_map(|(shape, position, axis, w)| {
        let rotation = Quat::from_xyzw(axis.x, axis.y, axis.z, w);
        let rotation = if rotation.length() > 1e-3 { rotation.normalize() } else { Quat::IDENTITY };
        solid(shape, position, rotation)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn growth_never_meets_a_solid_nor_the_ground(
        solids in prop::collection::vec(any_solid(), 1..6),
        from in vector(2.0),
        direction in vector(1.0),
        length in 0.01_f32..2.0,
        radius in 0.0_f32..0.1,
        near in prop::option::of(0.0_f32..1.0),
    ) {
        prop_assume!(direction.length() > 1e-2);
        let direction = direction.normalize();
        // Half of the starts are moved close to a surface, as after growing along it.
        let from = near.map_or(from, |aim| {
            let heading = (solids[0].position - from + Vec3::splat(aim * 0.3)).normalize_or(Vec3::Y);
            from + heading * advance(&solids, &[], None, from, heading, 4.0, radius).length
        });
        let ground = Some(-1.0);
        let got = advance(&solids, &[], ground, from, direction, length, radius);
        prop_assert!((got.direction.length() - 1.0).abs() < 1e-4);
        prop_assert!(got.length >= 0.0 && got.length <= length);
        prop_assert!(got.direction.dot(direction) > 0.17);
        let to = from + got.direction * got.length;
        for solid in &solids {
            let start = distance(solid, from, from);
            if start < 0.0 {
                prop_assert_eq!(got.length, 0.0);
            } else if got.length > 0.0 {
                let kept = distance(solid, from, to);
                prop_assert!(kept >= radius.min(start) - 1e-5, "{} of {}", kept, radius.min(start));
            }
            if distance(solid, from, to) <= radius {
                prop_assert!(touches(solid, from, to, radius));
            }
        }
        if got.length > 0.0 {
            prop_assert!(to.y >= -1.0 + radius.min(from.y + 1.0) - 1e-5);
        }
    }
}
