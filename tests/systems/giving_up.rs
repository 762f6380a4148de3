//! What plants give up: poor side axes, buds out of patience, terminal buds.

use super::*;

/// A trunk, and a side axis of two internodes with one leaf that earns `income` a step; the whole plant earns 100.
fn trunk_with_branch(species: Species, income: f32) -> (Nursery, Entity) {
    let mut nursery = Nursery::new(species);
    let trunk = nursery.stem(None, 0.2);
    let base = nursery.turned_stem(Some(trunk), 0.2, Quat::from_rotation_x(0.9));
    let end = nursery.stem(Some(base), 0.2);
    let leaf = nursery.leaf(end, 1.0, 1.0);
    nursery.set(leaf, EnergyFlow { income, upkeep: 0.0 });
    nursery.app.insert_resource(StepCount(5));
    nursery.set(nursery.plant, EnergyLedger { income: 100.0, ..default() });
    (nursery, base)
}

#[test]
fn shed_liabilities_gives_up_a_side_axis_that_is_poor_for_longer_than_its_patience() {
    let species = Species { prune_income: 0.5, prune_patience: 2, ..lam_king() };
    let (mut nursery, base) = trunk_with_branch(species, 0.9);
    for poor in 1..=2 {
        nursery.run(liabilities::shed_liabilities);
        assert_eq!(nursery.get::<Internode>(base).poor_steps, poor);
        assert!(nursery.condemned().is_empty());
    }
    nursery.run(liabilities::shed_liabilities);
    let base = nursery.birth(base);
    assert_eq!(nursery.condemned(), [(base, Cause::SelfPruned)], "0.9 for two internodes is below 2 x 0.5");
}

#[test]
fn shed_liabilities_forgives_a_side_axis_that_recovers_and_spares_the_young() {
    let species = Species { prune_income: 0.5, prune_patience: 2, ..lam_king() };
    let (mut nursery, base) = trunk_with_branch(species.clone(), 0.9);
    nursery.run(liabilities::shed_liabilities);
    let [leaf] = nursery.all(OrganKind::Leaf)[..] else { panic!("one leaf") };
    nursery.set(leaf, EnergyFlow { income: 1.1, upkeep: 0.0 });
    nursery.run(liabilities::shed_liabilities);
    assert_eq!(nursery.get::<Internode>(base).poor_steps, 0, "counted anew");

    let (mut nursery, base) = trunk_with_branch(species, 0.0);
    nursery.app.insert_resource(StepCount(1));
    nursery.run(liabilities::shed_liabilities);
    assert_eq!(nursery.get::<Internode>(base).poor_steps, 0, "its leaves have not had a year yet");

    let (mut nursery, _) = trunk_with_branch(Species { prune_patience: 0, ..lam_king() }, 0.0);
    for _ in 0..20 {
        nursery.run(liabilities::shed_liabilities);
    }
    assert!(nursery.condemned().is_empty(), "without patience in its species nothing is ever given up");
}

#[test]
fn shed_liabilities_condemns_apical_buds_out_of_patience() {
    let mut nursery = Nursery::new(Species { patience_steps: 2, ..lam_king() });
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.apical_bud(Some(trunk), 1.0, 0.0);
    for _ in 0..2 {
        nursery.run(shoots::extend_shoots);
        nursery.run(liabilities::shed_liabilities);
        assert!(nursery.condemned().is_empty());
    }
    nursery.run(shoots::extend_shoots);
    nursery.run(liabilities::shed_liabilities);
    assert_eq!(nursery.condemned(), [(nursery.birth(bud), Cause::Starved)]);
}

#[test]
fn form_nodes_forks_where_a_terminal_bud_dies() {
    let species = Species {
        terminal_death: [1.0].into(),
        fork_angle_deg: 30.0,
        apical_buds_per_node: 0,
        axis_continues: true,
        ..lam_king()
    };
    let mut nursery = Nursery::new(species);
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.apical_bud(Some(trunk), 1.0, 2.0);
    nursery.set(bud, ApicalBud { nodes: 2, ..default() });
    fresh_node(&mut nursery, trunk, bud);
    nursery.run(form_nodes);
    assert_eq!(nursery.condemned(), [(nursery.birth(bud), Cause::Aborted)]);
    close(nursery.stored(), 2.0);
    let forks: Vec<Entity> = nursery.all(OrganKind::ApicalBud).into_iter().filter(|&b| b != bud).collect();
    let headings: Vec<Vec3> = forks.iter().map(|&fork| nursery.get::<Pose>(fork).heading()).collect();
    assert_eq!(forks.len(), 2);
    assert!((headings[0].angle_between(headings[1]).to_degrees() - 60.0).abs() < 1e-3, "on both sides");
    assert!(forks.iter().all(|&fork| nursery.get::<BranchOrder>(fork).0 == 0), "they go on as its axis");
}

#[test]
fn form_nodes_spares_a_seedling_and_the_middle_of_a_growth_unit() {
    let species =
        Species { terminal_death: [1.0].into(), apical_buds_per_node: 0, axis_continues: true, ..lam_king() };
    for (nodes, ends_unit) in [(1, true), (2, false)] {
        let mut nursery = Nursery::new(species.clone());
        let trunk = nursery.stem(None, 0.2);
        let bud = nursery.apical_bud(Some(trunk), 1.0, 2.0);
        nursery.set(bud, ApicalBud { nodes, ..default() });
        fresh_node(&mut nursery, trunk, bud);
        nursery.app.world_mut().resource_mut::<FreshNodes>().0[0].ends_unit = ends_unit;
        nursery.run(form_nodes);
        assert!(nursery.condemned().is_empty());
        assert_eq!(nursery.all(OrganKind::ApicalBud), [bud]);
    }
}

#[test]
fn a_plant_gives_up_a_quarter_of_its_income_a_step_with_its_poor_axes_and_no_more() {
    let species = Species { prune_income: 5.0, prune_patience: 1, ..lam_king() };
    let mut nursery = Nursery::new(species);
    let trunk = nursery.stem(None, 0.2);
    let bases = [2.0, 1.0, 4.0, 3.0].map(|income| {
        let base = nursery.turned_stem(Some(trunk), 0.2, Quat::from_rotation_x(0.9));
        let leaf = nursery.leaf(base, 1.0, 1.0);
        nursery.set(leaf, EnergyFlow { income, upkeep: 0.0 });
        base
    });
    nursery.app.insert_resource(StepCount(5));
    nursery.set(nursery.plant, EnergyLedger { income: 20.0, ..default() });
    nursery.run(liabilities::shed_liabilities);
    nursery.run(liabilities::shed_liabilities);
    let gone: Vec<u32> = nursery.condemned().iter().map(|(birth, _)| *birth).collect();
    assert_eq!(
        gone,
        [nursery.birth(bases[1]), nursery.birth(bases[0])],
        "the poorest, as far as they earn 5 of 20"
    );
}

#[test]
fn an_axis_on_a_limb_that_is_given_up_counts_once() {
    use liabilities::{Account, branches, given_up};
    let stem = |parent, begins_axis, income| Account {
        parent,
        kind: OrganKind::Internode,
        begins_axis,
        income,
        upkeep: 0.0,
        sensed: true,
    };
    // A trunk with a limb that bears the poorest axis of all, and another limb.
    let trunk = burgeon::plant::NO_PARENT;
    let accounts = [stem(trunk, false, 14.0), stem(0, true, 2.0), stem(1, true, 1.0), stem(0, true, 2.5)];
    let sums = branches(&accounts);
    // A quarter of 20: 1 for the axis, 2 more for its limb, but no 2.5 for the other.
    assert_eq!(given_up(&accounts, &sums, vec![1, 2, 3], 20.0), [2, 1]);
    // Of 24 all of them.
    assert_eq!(given_up(&accounts, &sums, vec![1, 2, 3], 24.0), [2, 1, 3]);
    // With a limb goes what it bears.
    let accounts = [stem(trunk, false, 14.0), stem(0, true, 0.0), stem(1, true, 1.0)];
    assert_eq!(given_up(&accounts, &branches(&accounts), vec![1, 2], 20.0), [1]);
}

/// A cut-back trunk of bare nodes with energy in store: how many buds open on it.
fn sprouted(species: Species, stored: f64) -> Vec<u32> {
    let mut nursery = Nursery::new(species).store(stored);
    nursery.set(nursery.plant, EnergyLedger { opened: stored, ..default() });
    let mut below = None;
    for _ in 0..50 {
        below = Some(nursery.stem(below, 0.2));
    }
    nursery.run(sprouts::sprout);
    nursery.run(generation::derive_poses);
    nursery.all(OrganKind::LateralBud).iter().map(|bud| nursery.get::<BranchOrder>(*bud).0).collect()
}

#[test]
fn sprout_opens_buds_on_bare_wood_by_what_is_put_by() {
    let species = Species { sprouting: 0.5, ..lam_king() };
    let shoot =
        f64::from(burgeon::growth::vigour::internode_cost(&species) * species.flush_internodes.get(0));
    let buds = sprouted(species.clone(), 20.0 * shoot);
    assert!((4..=28).contains(&buds.len()), "about ten of {} open", buds.len());
    assert!(buds.iter().all(|order| *order == 1), "they begin side axes");
    assert_eq!(buds, sprouted(species.clone(), 20.0 * shoot), "the same ones each time");
    assert!(sprouted(species.clone(), 0.0).is_empty());
    assert!(sprouted(Species { sprouting: 0.0, ..species }, 20.0 * shoot).is_empty());
}

#[test]
fn sprout_leaves_a_plant_alone_whose_buds_hold_what_it_has() {
    let mut nursery = Nursery::new(Species { sprouting: 1.0, ..lam_king() }).store(50.0);
    let trunk = nursery.stem(None, 0.2);
    let trunk = nursery.stem(Some(trunk), 0.2);
    nursery.apical_bud(Some(trunk), 1.0, 50.0);
    nursery.set(nursery.plant, EnergyLedger { opened: 100.0, ..default() });
    nursery.run(sprouts::sprout);
    assert!(nursery.all(OrganKind::LateralBud).is_empty());
}
