//! Shoots that extend: towards their target, short of solids, round wood.

use super::*;

#[test]
fn extend_shoots_turns_energy_into_stem_below_the_bud() {
    let species = Species { internode_m: 0.1, node_spacing_m: 0.2, ..lam_king() };
    let mut nursery = Nursery::new(species);
    let bud = nursery.apical_bud(None, 1.0, 1.0);
    nursery.run(shoots::extend_shoots);
    let stems = nursery.all(OrganKind::Internode);
    assert_eq!(stems.len(), 2, "0.2 m are two segments of 0.1 m");
    assert!(nursery.app.world().get::<Node>(stems[0]).is_none());
    assert!(nursery.app.world().get::<Node>(stems[1]).is_some());
    let heights = stems.iter().map(|&s| nursery.get::<Internode>(s).height_in_branch);
    assert_eq!(heights.collect::<Vec<_>>(), [0.1, 0.2]);
    assert_eq!(nursery.get::<GrowsFrom>(stems[0]).0, nursery.plant);
    assert_eq!(nursery.get::<GrowsFrom>(stems[1]).0, stems[0]);
    assert_eq!(nursery.get::<GrowsFrom>(bud).0, stems[1]);
    assert_eq!(nursery.get::<Pose>(bud).position, Vec3::Y * 0.2);
    assert!(nursery.birth(bud) > nursery.birth(stems[1]), "the bud is born anew beyond its stem");
    close(nursery.get::<Allotment>(bud).0.into(), 0.0);
    close(nursery.ledger().growth, 1.0);
    assert_eq!(nursery.app.world().resource::<FreshNodes>().0.len(), 1);
}

#[test]
fn extend_shoots_follows_the_target_and_stops_at_solids() {
    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 0.2);
    let wall = Solid { shape: SolidShape::Box { size: Vec3::splat(2.0) }, color: [0.5; 3] };
    nursery.app.world_mut().spawn((wall, Transform::from_xyz(0.0, 1.3, 0.0)));
    let bud = nursery.apical_bud(Some(trunk), 1.0, 1.0);
    nursery.set(bud, GrowthTarget { heading: Vec3::Y, fitness: 1.0 });
    nursery.run(shoots::extend_shoots);
    let tip = nursery.get::<Pose>(bud).position.y;
    assert!((0.25..0.3).contains(&tip), "the ceiling is at 0.3, the tip at {tip}");

    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.apical_bud(Some(trunk), 1.0, 0.5);
    nursery.set(bud, GrowthTarget { heading: Vec3::X, fitness: 1.0 });
    nursery.run(shoots::extend_shoots);
    assert!(nursery.get::<Pose>(bud).position.distance(Vec3::new(0.1, 0.2, 0.0)) < 1e-5);
}

#[test]
fn gather_wood_lets_shoots_grow_round_what_stands_in_their_way() {
    for avoids_wood in [true, false] {
        let species = Species { avoids_wood, ..lam_king() };
        let mut nursery = Nursery::new(species);
        let trunk = nursery.stem(None, 0.2);
        // A bar across, a tenth of a metre above the tip.
        let post = nursery.turned_stem(None, 0.3, Quat::from_rotation_x(-0.3));
        let turn = Quat::from_rotation_x(0.3) * Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
        let bar = nursery.turned_stem(Some(post), 0.2, turn);
        nursery.set(
            bar,
            Pose { position: Vec3::new(-0.1, 0.3, 0.002), rotation: nursery.get::<Pose>(bar).rotation },
        );
        let bud = nursery.apical_bud(Some(trunk), 1.0, 1.0);
        nursery.set(bud, GrowthTarget { heading: Vec3::Y, fitness: 1.0 });
        nursery.run(shoots::gather_wood);
        nursery.run(shoots::extend_shoots);
        let tip = nursery.get::<Pose>(bud).position;
        let aside = Vec2::new(tip.x, tip.z).length();
        assert!(tip.y > 0.39, "it passes the bar: {tip}");
        assert_eq!(aside > 0.01, avoids_wood, "beside it, if it minds: {tip}");
    }
}

/// Heading of what a side axis grows after its trunk has leant over by an angle, radians.
fn side_axis_on_a_trunk_that_leans(by: f32, set_out: bool, drawn: Species) -> Vec3 {
    let mut nursery = Nursery::new(Species { internode_m: 0.1, node_spacing_m: 0.1, ..drawn });
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.apical_bud(Some(trunk), 1.0, 0.5);
    nursery.set(bud, Attachment(Quat::from_rotation_z(-0.9)));
    nursery.run(derive_poses);
    let grow = |nursery: &mut Nursery| {
        let heading = nursery.get::<Pose>(bud).heading();
        nursery.set(bud, GrowthTarget { heading, fitness: 1.0 });
        nursery.set(bud, Allotment(0.5));
        nursery.run(shoots::extend_shoots);
    };
    for _ in 0..if set_out { 3 } else { 0 } {
        grow(&mut nursery);
    }
    nursery.set(trunk, Attachment(Quat::from_rotation_x(by)));
    nursery.run(derive_poses);
    grow(&mut nursery);
    nursery.get::<Pose>(bud).heading()
}

#[test]
fn st_11_a_target_relative_to_the_parent_turns_with_a_parent_that_leans_over() {
    let relative = Species { phototropism: ByOrder::all(0.0), autotropism: ByOrder::all(1.0), ..lam_king() };
    let outset = Quat::from_rotation_z(-0.9) * Vec3::Y;
    for (by, set_out) in [(0.0, false), (0.7, false), (0.0, true), (0.7, true), (-1.2, true)] {
        let heading = side_axis_on_a_trunk_that_leans(by, set_out, relative.clone());
        assert!(heading.distance(Quat::from_rotation_x(by) * outset) < 1e-4, "{by} {set_out}: {heading}");
    }
    // A target relative to gravity stays.
    let upright = Species { gravitropism: ByOrder::all(1.0), autotropism: ByOrder::all(0.0), ..relative };
    assert!(side_axis_on_a_trunk_that_leans(0.7, true, upright).distance(Vec3::Y) < 1e-4);
}

#[test]
fn extend_shoots_leaves_a_bud_without_energy_waiting() {
    let mut nursery = Nursery::new(lam_king());
    let bud = nursery.apical_bud(None, 1.0, 0.0);
    nursery.run(shoots::extend_shoots);
    assert!(nursery.all(OrganKind::Internode).is_empty());
    assert_eq!(nursery.get::<ApicalBud>(bud).starved, 1);
}
