//! What makes a crown look like that tree: each mechanism alone, and how it is switched off.

mod common;

use bevy::prelude::*;
use burgeon::growth::nodes::{drooped, favour, fork, leaving, planated, whorl};
use burgeon::growth::sensing::{SensingJob, choose_growth_targets, gather_probes, render_cube_maps};
use burgeon::growth::shoots::{Plan, floor, plan};
use burgeon::growth::{forecast, sag, share, vigour};
use burgeon::plant::{
    Allotment, Attachment, Exposure, Internode, LateralBud, OrganKind, Pose, measure::Form,
};
use burgeon::species::{Allocation, Species};
use common::by_hand::Nursery;
use common::{grown, quick};

fn plain() -> Species {
    Species { angle_spread_deg: 0.0, ..Species::default() }
}

#[test]
fn whorls_ring_the_end_of_a_growth_unit() {
    let species = Species { whorl_buds: [5.0, 3.0].into(), branching_angle_deg: [80.0].into(), ..plain() };
    let ring: Vec<Vec3> = whorl(&species, 0.3, 0).map(|bud| bud.attachment * Vec3::Y).collect();
    assert_eq!(ring.len(), 5);
    for (bud, next) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        assert!((bud.angle_between(Vec3::Y).to_degrees() - 80.0).abs() < 1e-3);
        assert!((bud.xz().angle_to(next.xz()).abs().to_degrees() - 72.0).abs() < 1e-3, "evenly spread");
    }
    assert_eq!(whorl(&species, 0.0, 1).count(), 3);
    assert_eq!(
        whorl(&Species { max_order: 1, ..species }, 0.0, 1).count(),
        0,
        "the last order bears no buds"
    );
    assert_eq!(whorl(&plain(), 0.0, 0).count(), 0, "off");
}

#[test]
fn as_many_shoots_follow_a_dead_terminal_bud_as_the_species_says() {
    for shoots in [1, 2, 3] {
        let species = Species { fork_shoots: shoots, fork_angle_deg: 30.0, ..plain() };
        let ways: Vec<Vec3> = fork(&species, 1.0).map(|shoot| shoot.attachment * Vec3::Y).collect();
        assert_eq!(ways.len(), shoots as usize);
        assert!(ways.iter().all(|way| (way.angle_between(Vec3::Y).to_degrees() - 30.0).abs() < 1e-3));
    }
}

#[test]
fn planation_turns_buds_of_level_axes_into_the_level_plane() {
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    for azimuth in [0.2_f32, 1.1, 2.9, -1.4] {
        let bud = leaving(azimuth, 0.9);
        let flat = level * planated(level, bud, 1.0) * Vec3::Y;
        assert!(flat.y.abs() < 1e-4, "in the plane: {flat}");
        assert!((flat.angle_between(Vec3::X) - 0.9).abs() < 1e-4, "as far from its stem as before");
        assert_eq!(planated(Quat::IDENTITY, bud, 1.0), bud, "an upright axis has no plane");
        assert_eq!(planated(level, bud, 0.0), bud, "off");
        let half = (level * planated(level, bud, 0.5) * Vec3::Y).y.abs();
        assert!(half <= (level * bud * Vec3::Y).y.abs() + 1e-5);
    }
}

#[test]
fn epitony_favours_the_upper_side_of_level_axes() {
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    let side =
        |world: Vec3| Quat::from_rotation_arc(Vec3::Y, (level.inverse() * world + Vec3::Y).normalize());
    assert!((favour(level, side(Vec3::Y), 0.5) - 1.5).abs() < 1e-3);
    assert!((favour(level, side(Vec3::NEG_Y), 0.5) - 0.5).abs() < 1e-3);
    assert!((favour(level, side(Vec3::Z), 0.5) - 1.0).abs() < 1e-3);
    assert!((favour(Quat::IDENTITY, leaving(0.7, 0.9), 0.5) - 1.0).abs() < 1e-3, "upright");
    assert_eq!(favour(level, side(Vec3::Y), 0.0), 1.0, "off");
}

#[test]
fn acrotony_mesotony_and_basitony_favour_tip_middle_and_base() {
    let at = |favoured_rank: f32, rank: f32| {
        vigour::acrotony(&Species { favoured_rank, acrotony_base: 0.1, acrotony_power: 2.0, ..plain() }, rank)
    };
    for (favoured, order) in [(1.0, [0.0, 0.5, 1.0]), (0.0, [1.0, 0.5, 0.0]), (0.5, [0.0, 0.25, 0.5])] {
        let [least, more, most] = order.map(|rank| at(favoured, rank));
        assert!(least < more && more < most && (most - 1.0).abs() < 1e-6, "{favoured}");
        assert!((least - 0.1).abs() < 1e-6);
    }
    assert_eq!(vigour::acrotony(&plain(), 0.0), 1.0, "off");
}

#[test]
fn growth_fades_towards_the_height_where_water_no_longer_rises() {
    let species = Species { height_limit_m: 10.0, height_limit_power: 2.0, ..plain() };
    let [low, middle, top, above] = [0.0, 5.0, 10.0, 30.0].map(|h| vigour::height_factor(&species, h));
    assert_eq!((low, middle, top, above), (1.0, 0.75, 0.0, 0.0));
    assert_eq!(vigour::height_factor(&plain(), 1.0e4), 1.0, "off");
}

#[test]
fn set_points_and_flushes_change_with_age() {
    let species = Species {
        set_point_deg: [0.0, 40.0].into(),
        set_point_old_deg: [0.0, 80.0].into(),
        flush_internodes: [6.0].into(),
        flush_old: [2.0].into(),
        ageing_steps: 10,
        ..plain()
    };
    let at = |age| {
        (species.set_point(1, species.maturity(age)).to_degrees(), species.flush(0, species.maturity(age)))
    };
    for (age, (angle, flush)) in [(0, (40.0, 6.0)), (5, (60.0, 4.0)), (10, (80.0, 2.0)), (99, (80.0, 2.0))] {
        let (a, f) = at(age);
        assert!((a - angle).abs() < 1e-3 && (f - flush).abs() < 1e-4, "{age}: {a} {f}");
    }
    assert_eq!(plain().maturity(1_000), 0.0, "off");
}

#[test]
fn leaves_droop_a_little_each_step_and_never_fold_under() {
    let mut leaf = leaving(0.4, 0.3);
    let angle = |leaf: Quat| (leaf * Vec3::Y).angle_between(Vec3::Y);
    for step in 1..=20 {
        leaf = drooped(leaf, 0.2);
        let expected = (0.3 + 0.2 * step as f32).min(150.0_f32.to_radians());
        assert!((angle(leaf) - expected).abs() < 1e-3, "{step}");
    }
    assert_eq!(drooped(leaf, 0.0), leaf, "off");
}

#[test]
fn side_axes_stop_above_the_ground() {
    let species = Species { ground_clearance_m: 0.6, ..plain() };
    assert_eq!(floor(&species, Some(0.0), 1, 3.0), Some(0.6));
    assert_eq!(floor(&species, Some(0.0), 1, 0.4), Some(0.2), "a low one keeps half its height");
    assert_eq!(floor(&species, Some(0.0), 0, 3.0), Some(0.0), "a trunk rises from it");
    assert_eq!(floor(&plain(), Some(0.0), 1, 3.0), Some(0.0), "off");
    assert_eq!(floor(&species, None, 1, 3.0), None);
}

#[test]
fn bend_stems_bows_a_loaded_limb_and_keeps_the_bow() {
    let species = Species { stiffness_gpa: [1.0].into(), twig_radius_m: 0.004, ..plain() };
    let mut nursery = Nursery::new(species.clone());
    let trunk = nursery.stem(None, 3.0);
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    let mut limb = nursery.turned_stem(Some(trunk), 0.3, level);
    let first = limb;
    for _ in 0..4 {
        limb = nursery.stem(Some(limb), 0.3);
    }
    let before = nursery.get::<Attachment>(first).0;
    nursery.run(sag::bend_stems);
    let bent = nursery.get::<Internode>(first).sag;
    assert!(bent > 0.01, "1.5 m of a thin limb bends at its base: {bent}");
    assert!((nursery.get::<Attachment>(first).0.angle_between(before) - bent).abs() < 1e-3);
    let leant = nursery.get::<Internode>(trunk).sag;
    assert!(leant > 0.0, "what weighs on one side bends the trunk too: {leant}");
    // Ten times as stout it would bend less than it has: what has set stays.
    let stout = Internode { radius: 0.04, ..*nursery.get::<Internode>(first) };
    nursery.set(first, stout);
    let kept = nursery.get::<Attachment>(first).0;
    nursery.run(sag::bend_stems);
    assert_eq!(nursery.get::<Attachment>(first).0, kept);

    let mut rigid = Nursery::new(plain());
    let trunk = rigid.stem(None, 3.0);
    let limb = rigid.turned_stem(Some(trunk), 2.0, level);
    rigid.run(sag::bend_stems);
    assert_eq!(rigid.get::<Internode>(limb).sag, 0.0, "off");
}

#[test]
fn bend_stems_presses_nothing_into_the_ground_or_a_wall() {
    use burgeon::environment::{Solid, SolidShape};
    for wall in [false, true] {
        let height = if wall { 3.0 } else { 0.05 };
        let species = Species { stiffness_gpa: [0.05].into(), twig_radius_m: 0.004, ..plain() };
        let mut nursery = Nursery::new(species);
        let trunk = nursery.stem(None, height);
        let limb =
            nursery.turned_stem(Some(trunk), 1.0, Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2));
        if wall {
            let slab = Solid { shape: SolidShape::Box { size: Vec3::new(4.0, 0.1, 4.0) }, color: [0.5; 3] };
            nursery.app.world_mut().spawn((slab, Transform::from_xyz(0.0, height - 0.08, 0.0)));
        }
        for _ in 0..10 {
            nursery.run(sag::bend_stems);
            nursery.run(burgeon::growth::generation::derive_poses);
        }
        let end = nursery.get::<Pose>(limb).tip(1.0);
        let least = if wall { height - 0.03 } else { 0.0 };
        assert!(end.y > least, "wall {wall}: the end is at {end}");
    }
}

#[test]
fn leaves_of_one_cell_share_a_look_around() {
    let count = |light_cell_m: f32| {
        let mut nursery = Nursery::new(Species { light_cell_m, ..plain() });
        let trunk = nursery.stem(None, 1.0);
        for _ in 0..6 {
            nursery.leaf(trunk, 1.0, 1.0);
        }
        nursery.run(gather_probes);
        let job = nursery.app.world().resource::<SensingJob>();
        assert_eq!(job.lookers.len(), 6, "all of them learn what is seen");
        job.requests.len()
    };
    assert_eq!(count(0.0), 6, "off");
    assert_eq!(count(1.0), 1);
}

#[test]
fn who_shares_a_look_hides_neither_itself_nor_its_bud() {
    let grown = |cell: f32| {
        let species = Species { light_cell_m: cell, leaf_length_m: 0.1, leaf_width_m: 0.1, ..plain() };
        let mut nursery = Nursery::new(species);
        let stems = [0.1, 0.06].map(|length| nursery.stem(None, length));
        let [low, high] = stems.map(|stem| nursery.leaf(stem, 1.0, 0.0));
        let bud = nursery.lateral_bud(stems[1], 1, 0.0, 0.0);
        let flat = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
        for (leaf, height) in [(low, 0.1), (high, 0.16)] {
            nursery.set(leaf, Pose { position: Vec3::Y * height, rotation: flat });
        }
        nursery.set(bud, Pose { position: Vec3::Y * 0.16, rotation: Quat::IDENTITY });
        nursery.run(gather_probes);
        let looks = nursery.app.world().resource::<SensingJob>().requests.len();
        nursery.run(render_cube_maps);
        nursery.run(choose_growth_targets);
        (looks, [low, high, bud].map(|organ| nursery.get::<Exposure>(organ).light))
    };
    let ((alone, [_, bright, _]), (shared, [dim, high, bud])) = (grown(0.0), grown(1.0));
    assert_eq!((alone, shared), (2, 1));
    assert!(dim < 0.9 * bright, "the lower leaf lies in shade: {dim}, {bright}");
    assert!((high - bright).abs() < 0.02, "nothing stands above the upper one: {high}, alone {bright}");
    assert_eq!(bud, high, "a bud asleep takes what its leaf sees");
}

#[test]
fn share_surplus_heeds_favour_and_height() {
    let species = Species {
        allocation: Allocation::ByVigour,
        store_release: 1.0,
        apical_control: [0.0].into(),
        flush_internodes: [50.0].into(),
        height_limit_m: 10.0,
        height_limit_power: 1.0,
        ..plain()
    };
    let unit = vigour::internode_cost(&species);
    let mut nursery = Nursery::new(species).store(f64::from(30.0 * unit));
    let low = nursery.stem(None, 2.0);
    let [plain_bud, favoured] = [1.0, 2.0].map(|favour| {
        let bud = nursery.lateral_bud(low, 0, 1.0, 0.0);
        nursery.set(bud, LateralBud { favour, ..default() });
        bud
    });
    let high = nursery.stem(Some(low), 7.999);
    let top = nursery.apical_bud(Some(high), 1.0, 0.0);
    nursery.run(share::share_surplus);
    let got = |bud| nursery.get::<Allotment>(bud).0 / unit;
    assert!((got(favoured) / got(plain_bud) - 2.0).abs() < 0.2, "{} {}", got(favoured), got(plain_bud));
    assert!(got(top) < 0.3, "nothing rises there: {}", got(top));
}

#[test]
fn a_forecast_is_never_too_small() {
    for (scenario, steps) in [("figure_1c", 7), ("open", 9), ("wall", 8)] {
        let mut garden = common::garden(quick(scenario), 3);
        for step in 0..steps {
            let (before, most) = (garden.organs(), forecast::next_step(garden.world()));
            garden.step().unwrap();
            let shot = garden.snapshot();
            let born = shot.span.iter().filter(|span| span.born() == step).count();
            assert!(born <= most, "{scenario} step {step}: {born} born of {before}, {most} foreseen");
        }
    }
}

#[test]
fn a_shoot_of_many_segments_gives_each_a_lineage_of_its_own() {
    let species = Species {
        axis_continues: true,
        internode_m: 0.001,
        node_spacing_m: 10.0,
        extension_m: 10.0,
        seed_energy: 1.0e6,
        apical_buds_per_node: 0,
        leaves_per_node: 0,
        ..plain()
    };
    assert!(matches!(plan(&species, 50.0), Plan { nodes: u32::MAX, .. }));
    let mut scenario = quick("figure_1a");
    scenario.species.insert("lam_king".into(), species);
    let shot = grown(scenario, 1, 1).snapshot();
    let mut lineages: Vec<u64> = shot.lineage.iter().map(|lineage| lineage.0).collect();
    lineages.sort_unstable();
    let organs = lineages.len();
    lineages.dedup();
    assert!(organs > 5_000, "{organs}");
    assert_eq!(lineages.len(), organs);
    assert_eq!(
        Form::of(&shot, None).internodes as usize,
        shot.state.iter().filter(|s| s.kind() == OrganKind::Internode).count()
    );
}

#[test]
fn income_saturates_with_light_and_full_light_earns_the_same() {
    use burgeon::growth::energy::light_response;
    assert_eq!(
        [0.0, 0.3, 1.0].map(|light| light_response(light, 0.0)),
        [0.0, 0.3, 1.0],
        "off: in proportion"
    );
    for saturation in [0.5, 2.0, 10.0] {
        let at = |light| light_response(light, saturation);
        assert!(at(0.0) == 0.0 && (at(1.0) - 1.0).abs() < 1e-6);
        assert!(
            at(0.2) > 0.2 && at(0.2) < at(0.4) && at(0.4) - at(0.2) < at(0.2),
            "{saturation}: it bends over"
        );
    }
    // (1 + k) L / (L + k) with k = 1/2: half of the light earns 0.75.
    assert!((light_response(0.5, 2.0) - 0.75).abs() < 1e-6);
}
