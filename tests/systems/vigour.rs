//! Sharing by vigour instead of by exposure (Borchert & Honda; Palubicki 2009).

use burgeon::growth::vigour;
use burgeon::species::Allocation;

use super::*;

/// Shares by vigour whole internodes of 1.4 energy each.
fn by_vigour() -> Species {
    Species {
        allocation: Allocation::ByVigour,
        node_spacing_m: 0.2,
        shoot_cost: 5.0,
        leaf_cost: 0.2,
        leaves_per_node: 2,
        short_internode: 0.1,
        vigour_short: 0.25,
        store_release: 1.0,
        apical_control: [0.0].into(),
        flush_internodes: [10.0].into(),
        ..lam_king()
    }
}

/// A trunk with a tip, and a side axis with a tip; both in full light.
fn fork(species: Species, energy: f64) -> (Nursery, Entity, Entity) {
    let mut nursery = Nursery::new(species).store(energy);
    let trunk = nursery.stem(None, 0.2);
    let main = nursery.apical_bud(Some(trunk), 1.0, 0.0);
    let branch = nursery.turned_stem(Some(trunk), 0.2, Quat::from_rotation_x(0.9));
    let side = nursery.apical_bud(Some(branch), 1.0, 0.0);
    (nursery, main, side)
}

fn got(nursery: &Nursery, organ: Entity) -> f64 {
    f64::from(nursery.get::<Allotment>(organ).0)
}

#[test]
fn share_surplus_gives_buds_whole_internodes_with_their_leaves() {
    let unit = f64::from(vigour::internode_cost(&by_vigour()));
    close(unit, 0.2 * 5.0 + 2.0 * 0.2);
    let (mut nursery, main, side) = fork(by_vigour(), 8.0 * unit);
    nursery.run(share::share_surplus);
    close(got(&nursery, main), 4.0 * unit);
    close(got(&nursery, side), 4.0 * unit);
    close(nursery.stored(), 0.0);
}

#[test]
fn gather_claims_takes_back_what_was_not_used_and_share_surplus_gives_it_out_once() {
    let all = 8.0 * f64::from(vigour::internode_cost(&by_vigour()));
    let (mut nursery, main, side) = fork(by_vigour(), 0.0);
    nursery.set(main, Allotment(all as f32));
    nursery.run(share::gather_claims);
    close(got(&nursery, main), 0.0);
    // Between two parts of a step a host prunes: what is left is asked anew, and nothing is lost.
    let birth = nursery.birth(side);
    burgeon::plant::shed(nursery.app.world_mut(), &[(birth, Cause::Pruned)]);
    nursery.run(share::share_surplus);
    close(got(&nursery, main), all);
    nursery.run(share::share_surplus);
    close(got(&nursery, main) + nursery.stored(), all);
}

#[test]
fn share_surplus_favours_the_main_axis_by_apical_control() {
    let species = Species { apical_control: [0.5].into(), ..by_vigour() };
    let unit = f64::from(vigour::internode_cost(&species));
    let (mut nursery, main, side) = fork(species, 8.0 * unit);
    nursery.run(share::share_surplus);
    close(got(&nursery, main), 6.0 * unit);
    close(got(&nursery, side), 2.0 * unit);
}

#[test]
fn share_surplus_follows_the_light() {
    let (mut nursery, main, side) = fork(by_vigour(), 0.0);
    let unit = f64::from(vigour::internode_cost(&by_vigour()));
    nursery = nursery.store(8.0 * unit);
    nursery.set(side, Exposure { light: 1.0 / 3.0, space: 1.0, sensed: true });
    nursery.run(share::share_surplus);
    close(got(&nursery, main), 6.0 * unit);
    close(got(&nursery, side), 2.0 * unit);
}

#[test]
fn share_surplus_stops_at_a_full_flush_and_keeps_what_is_over() {
    let species = Species { flush_internodes: [3.0, 2.0].into(), ..by_vigour() };
    let unit = f64::from(vigour::internode_cost(&species));
    let (mut nursery, main, side) = fork(species, 8.0 * unit);
    nursery.run(share::share_surplus);
    close(got(&nursery, main), 3.0 * unit);
    close(got(&nursery, side), 2.0 * unit);
    close(nursery.stored(), 3.0 * unit);
}

#[test]
fn share_surplus_makes_short_shoots_of_little_and_nothing_of_less() {
    let unit = f64::from(vigour::internode_cost(&by_vigour()));
    let short = f64::from(vigour::short_shoot_cost(&by_vigour()));
    let (mut nursery, main, side) = fork(by_vigour(), 1.2 * unit);
    nursery.run(share::share_surplus);
    close(got(&nursery, main), short);
    close(got(&nursery, side), short);

    // Too little for two short shoots, enough for one: the main axis has it.
    let (mut nursery, main, side) = fork(by_vigour(), 0.4 * unit);
    nursery.run(share::share_surplus);
    let fed = [main, side].map(|bud| got(&nursery, bud) > 0.0);
    assert_eq!(fed.iter().filter(|fed| **fed).count(), 1, "{fed:?}");
}

#[test]
fn share_surplus_takes_back_what_was_not_used() {
    let unit = f64::from(vigour::internode_cost(&by_vigour()));
    let (mut nursery, main, side) = fork(by_vigour(), 0.0);
    nursery.set(side, Allotment((4.0 * unit) as f32));
    nursery.run(share::share_surplus);
    close(got(&nursery, main) + got(&nursery, side) + nursery.stored(), 4.0 * unit);
    close(got(&nursery, main), 2.0 * unit);
}

#[test]
fn a_plant_that_rests_grows_nothing_and_puts_by_what_it_earns() {
    let calendar = |flush_steps| Species { steps_per_year: 4, flush_steps, flushes: 1, ..by_vigour() };
    assert!((0..9).all(|age| !calendar(0).rests(age)), "off");
    let ages: Vec<u32> = (0..9).filter(|age| !calendar(1).rests(*age)).collect();
    assert_eq!(ages, [0, 4, 8]);
    let twice = Species { steps_per_year: 12, flush_steps: 2, flushes: 2, ..by_vigour() };
    let ages: Vec<u32> = (0..12).filter(|age| !twice.rests(*age)).collect();
    assert_eq!(ages, [0, 1, 6, 7]);

    for allocation in [Allocation::ByVigour, Allocation::ByExposure] {
        let species = Species { allocation, ..calendar(1) };
        let (mut nursery, main, side) = fork(species, 100.0);
        nursery.app.world_mut().resource_mut::<StepCount>().0 = 1;
        nursery.run(share::share_surplus);
        assert_eq!(
            (got(&nursery, main), got(&nursery, side), nursery.stored()),
            (0.0, 0.0, 100.0),
            "it puts by"
        );
        // Whatever it still has at hand it does not use.
        nursery.set(main, Allotment(5.0));
        nursery.run(shoots::extend_shoots);
        assert_eq!(nursery.all(OrganKind::Internode).len(), 2);
        assert_eq!(nursery.get::<ApicalBud>(main).starved, 0, "resting is no want");
        nursery.app.world_mut().resource_mut::<StepCount>().0 = 3;
        nursery.run(share::share_surplus);
        assert!(got(&nursery, main) > 0.0, "for the flush in the next step");
        nursery.app.world_mut().resource_mut::<StepCount>().0 = 4;
        nursery.run(shoots::extend_shoots);
        assert!(nursery.all(OrganKind::Internode).len() > 2);
    }
}

#[test]
fn apical_control_changes_with_age_down_to_its_least() {
    let species = Species {
        apical_control: [0.5].into(),
        apical_control_ageing: -0.1,
        apical_control_least: 0.2,
        store_release: 0.5,
        ..by_vigour()
    };
    let unit = f64::from(vigour::internode_cost(&species));
    let share_at = |age: u32, species: &Species| {
        let (mut nursery, main, side) = fork(species.clone(), 20.0 * unit);
        nursery.app.world_mut().resource_mut::<StepCount>().0 = age;
        nursery.run(share::share_surplus);
        (got(&nursery, main) / unit, got(&nursery, side) / unit)
    };
    // (1 + c) / 2 of ten internodes, which chance makes whole.
    for (age, main) in [(0, 7.5), (1, 7.0), (2, 6.5), (3, 6.0), (30, 6.0)] {
        let (leader, lateral) = share_at(age, &species);
        assert!(
            (leader - main).abs() < 0.51 && (lateral - (10.0 - main)).abs() < 0.51,
            "{age}: {leader} {lateral}"
        );
    }
    let ever = Species { apical_control_ageing: 0.0, ..species };
    assert!((share_at(30, &ever).0 - 7.5).abs() < 0.51, "off");
}

#[test]
fn wood_share_is_kept_from_the_shoots() {
    let unit = f64::from(vigour::internode_cost(&by_vigour()));
    for (wood_share, shoots) in [(0.0, 8.0), (0.25, 6.0), (0.5, 4.0)] {
        let (mut nursery, main, side) = fork(Species { wood_share, ..by_vigour() }, 8.0 * unit);
        nursery.run(share::share_surplus);
        close(got(&nursery, main) + got(&nursery, side), shoots * unit);
        close(nursery.stored(), (8.0 - shoots) * unit);
    }
}
