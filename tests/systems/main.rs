//! Every system of the growth step alone, on a few organs set by hand.

#[path = "../common/mod.rs"]
mod common;
mod giving_up;
mod growing_shoots;
mod vigour;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use burgeon::environment::{Solid, SolidShape};
use burgeon::growth::generation::{BudBroke, Condemned, derive_poses, germinate, open_books, shed_condemned};
use burgeon::growth::nodes::{FreshNode, FreshNodes, form_nodes, unfold_leaves};
use burgeon::growth::sensing::{Place, SensingJob, choose_growth_targets, gather_probes, render_cube_maps};
use burgeon::growth::{
    Mechanisms, Stage, StepCount, buds, energy, finish, generation, liabilities, share, shoots, sprouts, wood,
};
use burgeon::plant::{
    Allotment, ApicalBud, Attachment, BranchOrder, Cause, EnergyFlow, EnergyLedger, EnergyStore, Exposure,
    Fallen, GrowsFrom, GrowthTarget, Identity, Internode, LateralBud, LateralBudState, Leaf, LeafState,
    Lineage, Node, OrganKind, OrganShed, Plant, Pose,
};
use burgeon::species::Species;
use burgeon::species::parameter::ByOrder;
use common::by_hand::Nursery;

/// The constants of the paper, without the chance in angles.
fn lam_king() -> Species {
    Species { angle_spread_deg: 0.0, ..Species::default() }
}

#[track_caller]
fn close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-5, "{a} is not {b}");
}

#[test]
fn open_books_carries_the_books_forward_and_sheds_what_was_despawned() {
    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 1.0, 1.0);
    nursery.set(nursery.plant, EnergyLedger { closed: 3.0, income: 9.0, ..default() });
    nursery.app.world_mut().despawn(trunk);
    nursery.run(open_books);
    assert_eq!(nursery.ledger(), EnergyLedger { opened: 3.0, ..default() });
    assert!(!nursery.lives(leaf));
}

#[test]
fn germinate_puts_up_one_bud_fed_from_the_seed() {
    let species = Species { seed_energy: 12.0, extension_m: 0.2, shoot_cost: 5.0, ..lam_king() };
    let mut nursery = Nursery::new(species);
    nursery.set(nursery.plant, EnergyStore::default());
    nursery.run(germinate);
    nursery.run(germinate);
    let [bud] = nursery.all(OrganKind::ApicalBud)[..] else { panic!("one bud") };
    assert_eq!(nursery.get::<Identity>(bud).lineage, Lineage::SEED);
    assert_eq!(nursery.get::<BranchOrder>(bud).0, 0);
    close(nursery.get::<Allotment>(bud).0.into(), 1.0);
    close(nursery.stored(), 11.0);
    close(nursery.ledger().opened, 12.0);
}

#[test]
fn wake_lateral_buds_counts_dormancy_down_then_breaks_once() {
    let mut nursery = Nursery::new(Species { dormancy_light: 0.3, ..lam_king() });
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.lateral_bud(trunk, 2, 0.5, 1.0);
    let state = |nursery: &Nursery| {
        let bud = nursery.get::<LateralBud>(bud);
        (bud.state, bud.dormancy)
    };
    let mut seen = Vec::new();
    for _ in 0..5 {
        nursery.run(buds::wake_lateral_buds);
        seen.push(state(&nursery));
    }
    use LateralBudState::{Dormant, Growing};
    assert_eq!(seen, [(Dormant, 1), (Dormant, 0), (Growing, 0), (Growing, 0), (Growing, 0)]);
    let [axis] = nursery.all(OrganKind::ApicalBud)[..] else { panic!("one new axis") };
    assert_eq!(nursery.get::<BranchOrder>(axis).0, 1);
    assert_eq!(nursery.get::<GrowsFrom>(axis).0, trunk);
    assert_eq!(nursery.get::<Pose>(axis).position, Vec3::Y * 0.2);
    close(nursery.get::<Allotment>(axis).0.into(), 1.0);
    close(nursery.get::<Allotment>(bud).0.into(), 0.0);
    assert_eq!(nursery.app.world().resource::<Messages<BudBroke>>().len(), 1);
}

#[test]
fn wake_lateral_buds_lets_a_bud_in_the_dark_sleep_and_die_out_of_patience() {
    let mut nursery = Nursery::new(Species { dormancy_light: 0.3, patience_steps: 2, ..lam_king() });
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.lateral_bud(trunk, 1, 0.2, 1.0);
    for _ in 0..2 {
        nursery.run(buds::wake_lateral_buds);
    }
    assert_eq!(nursery.get::<LateralBud>(bud).dormancy, 1);
    assert!(nursery.condemned().is_empty());
    nursery.run(buds::wake_lateral_buds);
    assert_eq!(nursery.get::<LateralBud>(bud).state, LateralBudState::Dead);
    assert_eq!(nursery.condemned(), [(nursery.birth(bud), Cause::Starved)]);
}

fn fresh_node(nursery: &mut Nursery, stem: Entity, bud: Entity) {
    let birth = nursery.birth(stem);
    let node = FreshNode {
        internode: stem,
        birth,
        bud,
        node: Node { ordinal: 0 },
        phyllotaxis: 0.0,
        rank: 1.0,
        ends_unit: true,
        short: false,
    };
    nursery.app.world_mut().resource_mut::<FreshNodes>().0.push(node);
}

#[test]
fn form_nodes_bears_three_leaves_and_three_buds_and_ends_the_old_one() {
    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.apical_bud(Some(trunk), 0.8, 0.0);
    fresh_node(&mut nursery, trunk, bud);
    nursery.run(form_nodes);
    assert_eq!(nursery.condemned(), [(nursery.birth(bud), Cause::Branched)]);
    let leaves = nursery.all(OrganKind::Leaf);
    assert_eq!(leaves.len(), 3);
    let angle = |e| nursery.get::<Pose>(e).heading().angle_between(Vec3::Y).to_degrees();
    for leaf in leaves {
        assert_eq!(nursery.get::<Leaf>(leaf).size, 0.0);
        assert_eq!(nursery.get::<BranchOrder>(leaf).0, 0);
        assert_eq!(*nursery.get::<Exposure>(leaf), Exposure { light: 0.8, space: 1.0, sensed: false });
        assert!((angle(leaf) - 60.0).abs() < 1e-3);
    }
    let young: Vec<Entity> = nursery.all(OrganKind::ApicalBud).into_iter().filter(|&b| b != bud).collect();
    assert_eq!(young.len(), 3);
    for bud in young {
        assert_eq!(nursery.get::<BranchOrder>(bud).0, 1);
        assert!((angle(bud) - 50.0).abs() < 1e-3);
    }
}

#[test]
fn form_nodes_bears_a_lateral_bud_in_each_axil_of_an_axis_that_goes_on() {
    let species = Species {
        lateral_buds_per_node: 2,
        leaves_per_node: 2,
        apical_buds_per_node: 0,
        axis_continues: true,
        dormancy_steps: 4,
        ..lam_king()
    };
    let mut nursery = Nursery::new(species);
    let trunk = nursery.stem(None, 0.2);
    let bud = nursery.apical_bud(Some(trunk), 1.0, 0.0);
    fresh_node(&mut nursery, trunk, bud);
    nursery.run(form_nodes);
    assert!(nursery.condemned().is_empty(), "the bud goes on");
    let (leaves, laterals) = (nursery.all(OrganKind::Leaf), nursery.all(OrganKind::LateralBud));
    assert_eq!((leaves.len(), laterals.len()), (2, 2));
    for (&leaf, &bud) in leaves.iter().zip(&laterals) {
        let side = |e| nursery.get::<Pose>(e).heading().xz().normalize();
        assert!(side(leaf).distance(side(bud)) < 1e-4, "in the axil of its leaf");
        assert_eq!(nursery.get::<LateralBud>(bud).dormancy, 4);
        assert_eq!(nursery.get::<BranchOrder>(bud).0, 1);
    }
}

#[test]
fn unfold_leaves_grows_them_by_their_energy_up_to_full_size() {
    let mut nursery = Nursery::new(Species { leaf_cost: 0.5, ..lam_king() });
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 0.0, 1.0);
    nursery.set(leaf, Allotment(0.2));
    nursery.run(unfold_leaves);
    close(nursery.get::<Leaf>(leaf).size.into(), 0.4);
    close(nursery.ledger().growth, 0.2);
    nursery.set(leaf, Allotment(9.0));
    nursery.run(unfold_leaves);
    assert_eq!(*nursery.get::<Leaf>(leaf), Leaf { size: 1.0, state: LeafState::Terminated });
    close(nursery.ledger().growth, 0.5);
    close(nursery.get::<Allotment>(leaf).0.into(), 8.7);
}

#[test]
fn thicken_wood_gives_a_stem_the_pipes_of_all_it_bears() {
    let species = Species { pipe_exponent: 2.0, twig_radius_m: 0.003, ..lam_king() };
    let mut nursery = Nursery::new(species.clone());
    let trunk = nursery.stem(None, 0.2);
    for side in [0.5, -0.5, 1.0, -1.0] {
        nursery.turned_stem(Some(trunk), 0.2, Quat::from_rotation_x(side));
    }
    nursery.run(wood::thicken_wood);
    close(nursery.get::<Internode>(trunk).radius.into(), 0.006);

    // With half the energy for it, half the wood.
    let volume = f64::from(core::f32::consts::PI * (0.006 * 0.006 - 0.003 * 0.003) * 0.2);
    let mut poor = Nursery::new(Species { wood_cost: 1e5, ..species }).store(0.5e5 * volume);
    let trunk = poor.stem(None, 0.2);
    for side in [0.5, -0.5, 1.0, -1.0] {
        poor.turned_stem(Some(trunk), 0.2, Quat::from_rotation_x(side));
    }
    poor.run(wood::thicken_wood);
    close(poor.get::<Internode>(trunk).radius.into(), (0.5_f64 * (36e-6 + 9e-6)).sqrt());
    close(poor.stored(), 0.0);
    assert!(poor.ledger().wood > 0.0 && poor.ledger().wood == poor.ledger().growth);
}

#[test]
fn shed_condemned_takes_an_organ_and_all_it_bears_tips_first() {
    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 0.2);
    let branch = nursery.turned_stem(Some(trunk), 0.2, Quat::from_rotation_x(0.9));
    let leaf = nursery.leaf(branch, 1.0, 1.0);
    let other = nursery.leaf(trunk, 1.0, 1.0);
    nursery.set(leaf, Allotment(0.25));
    let births = [nursery.birth(leaf), nursery.birth(branch)];
    nursery.app.world_mut().resource_mut::<Condemned>().0.push((births[1], Cause::SelfPruned));
    nursery.run(shed_condemned);
    assert!(nursery.lives(trunk) && nursery.lives(other) && !nursery.lives(branch) && !nursery.lives(leaf));
    let fallen: Vec<_> =
        nursery.app.world().resource::<Fallen>().tombstones.iter().map(|t| (t.birth, t.cause)).collect();
    assert_eq!(fallen, births.map(|b| (b, Cause::SelfPruned)));
    assert_eq!(nursery.app.world().resource::<Messages<OrganShed>>().len(), 2);
    close(nursery.ledger().lost, 0.25);
}

#[test]
fn derive_poses_turns_and_moves_all_that_a_stem_bears() {
    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 0.2);
    let branch = nursery.turned_stem(Some(trunk), 0.3, Quat::from_rotation_x(core::f32::consts::FRAC_PI_2));
    let leaf = nursery.leaf(branch, 1.0, 1.0);
    let bud = nursery.apical_bud(Some(branch), 1.0, 0.0);
    nursery.set(nursery.plant, Transform::from_xyz(5.0, 1.0, 0.0));
    nursery.run(derive_poses);
    assert!(nursery.get::<Pose>(branch).position.distance(Vec3::new(5.0, 1.2, 0.0)) < 1e-6);
    let tip = Vec3::new(5.0, 1.2, 0.3);
    assert!(nursery.get::<Pose>(bud).position.distance(tip) < 1e-6);
    assert!(nursery.get::<Pose>(bud).heading().distance(Vec3::Z) < 1e-6);
    assert!(nursery.get::<Pose>(leaf).position.distance(tip) < 0.007, "a leaf sits on the bark");
}

#[test]
fn photosynthesise_earns_by_size_light_and_open_stomata() {
    let species = Species { stomata_open: 0.5, leaf_income: 2.0, leaf_upkeep: 0.15, ..lam_king() };
    let mut nursery = Nursery::new(species);
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 0.5, 0.8);
    let blind = nursery.leaf(trunk, 1.0, 1.0);
    nursery.set(blind, Exposure { light: 1.0, space: 1.0, sensed: false });
    nursery.run(energy::photosynthesise);
    close(nursery.get::<EnergyFlow>(leaf).income.into(), 0.4);
    close(nursery.get::<EnergyFlow>(leaf).upkeep.into(), 0.075);
    assert_eq!(nursery.get::<EnergyFlow>(blind).income, 0.0, "it has not looked around yet");
}

#[test]
fn photosynthesise_has_leaves_of_one_summer_earn_at_once_by_the_light_of_their_bud() {
    let species = Species { leaf_earns_at_once: true, leaf_income: 2.0, stomata_open: 1.0, ..lam_king() };
    let mut nursery = Nursery::new(species);
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 1.0, 1.0);
    nursery.set(leaf, Exposure { light: 0.6, space: 1.0, sensed: false });
    nursery.run(energy::photosynthesise);
    close(nursery.get::<EnergyFlow>(leaf).income.into(), 1.2);
}

#[test]
fn photosynthesise_lets_old_leaves_fall() {
    let mut nursery = Nursery::new(Species { leaf_life_steps: 3, ..lam_king() });
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 1.0, 1.0);
    nursery.app.insert_resource(StepCount(2));
    nursery.run(energy::photosynthesise);
    assert!(nursery.condemned().is_empty());
    nursery.app.insert_resource(StepCount(3));
    nursery.run(energy::photosynthesise);
    assert_eq!(nursery.condemned(), [(nursery.birth(leaf), Cause::Senescence)]);
}

#[test]
fn photosynthesise_hands_what_a_falling_leaf_earned_to_its_stem() {
    let species = Species { leaf_life_steps: 1, leaf_income: 2.0, stomata_open: 1.0, ..lam_king() };
    let mut nursery = Nursery::new(species);
    let trunk = nursery.stem(None, 0.2);
    let leaves = [0.8, 0.5].map(|light| nursery.leaf(trunk, 1.0, light));
    nursery.app.insert_resource(StepCount(1));
    nursery.run(energy::photosynthesise);
    assert!(leaves.iter().all(|&leaf| nursery.get::<EnergyFlow>(leaf).income == 0.0));
    close(nursery.get::<EnergyFlow>(trunk).income.into(), 1.6 + 1.0);
    for leaf in leaves {
        nursery.app.world_mut().despawn(leaf);
    }
    nursery.run(energy::photosynthesise);
    assert_eq!(nursery.get::<EnergyFlow>(trunk).income, 0.0, "and only once");
}

#[test]
fn pay_upkeep_takes_income_in_and_upkeep_out_of_the_store() {
    let species = Species { bud_upkeep: 0.05, ..lam_king() };
    let mut nursery = Nursery::new(species).store(0.1);
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 1.0, 1.0);
    nursery.apical_bud(Some(trunk), 1.0, 0.0);
    nursery.set(leaf, EnergyFlow { income: 1.0, upkeep: 0.15 });
    nursery.run(energy::pay_upkeep);
    close(nursery.stored(), 0.9);
    let books = nursery.ledger();
    close(books.income, 1.0);
    close(books.upkeep, 0.2);
    close(books.unpaid, 0.0);

    nursery.set(leaf, EnergyFlow { income: 0.0, upkeep: 2.0 });
    nursery.run(energy::pay_upkeep);
    close(nursery.stored(), 0.0);
    close(nursery.ledger().unpaid, 2.05 - 0.9);
}

#[test]
fn shed_liabilities_condemns_only_in_a_shortage() {
    let mut nursery = Nursery::new(Species { shed_share: 1.0, ..lam_king() });
    let trunk = nursery.stem(None, 0.2);
    let good = nursery.leaf(trunk, 1.0, 1.0);
    let poor = nursery.leaf(trunk, 1.0, 0.1);
    nursery.set(good, EnergyFlow { income: 1.0, upkeep: 0.15 });
    nursery.set(poor, EnergyFlow { income: 0.1, upkeep: 0.15 });
    nursery.run(liabilities::shed_liabilities);
    assert!(nursery.condemned().is_empty(), "nothing is owed");
    nursery.set(nursery.plant, EnergyLedger { unpaid: 1.0, ..default() });
    nursery.run(liabilities::shed_liabilities);
    assert_eq!(nursery.condemned(), [(nursery.birth(poor), Cause::Liability)]);
}

#[test]
fn share_surplus_feeds_leaves_then_the_best_lit_buds_and_keeps_the_rest() {
    let species =
        Species { leaf_cost: 0.5, extension_m: 0.2, shoot_cost: 5.0, store_release: 1.0, ..lam_king() };
    let mut nursery = Nursery::new(species).store(1.8);
    let trunk = nursery.stem(None, 0.2);
    let dim = nursery.apical_bud(Some(trunk), 0.4, 0.0);
    let bright = nursery.apical_bud(Some(trunk), 0.9, 0.0);
    let leaf = nursery.leaf(trunk, 0.2, 0.1);
    let grown = nursery.leaf(trunk, 1.0, 1.0);
    nursery.run(share::share_surplus);
    let got = |e| f64::from(nursery.get::<Allotment>(e).0);
    close(got(leaf), 0.4);
    close(got(grown), 0.0);
    close(got(bright), 1.0);
    close(got(dim), 0.4);
    close(nursery.stored(), 0.0);

    // Of a store, only the species' share is released.
    let mut nursery = Nursery::new(Species { store_release: 0.25, ..lam_king() }).store(2.0);
    let bud = nursery.apical_bud(None, 1.0, 0.0);
    nursery.run(share::share_surplus);
    close(nursery.get::<Allotment>(bud).0.into(), 0.5);
    close(nursery.stored(), 1.5);
}

#[test]
fn gather_probes_asks_for_every_bud_and_leaf_and_only_fed_buds_search() {
    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 1.0, 1.0);
    let fed = nursery.apical_bud(Some(trunk), 1.0, 1.0);
    let unfed = nursery.apical_bud(Some(trunk), 1.0, 0.0);
    nursery.run(gather_probes);
    let job = nursery.app.world().resource::<SensingJob>();
    let readers = [(leaf, 0), (fed, 1), (unfed, 0)].map(|(e, request)| (e, Place { request, guest: None }));
    assert_eq!(job.lookers, readers, "an unfed bud reads what its leaf finds");
    let searches: Vec<bool> = job.requests.iter().map(|r| r.search.is_some()).collect();
    assert_eq!(searches, [false, true]);
    assert_eq!((job.scene.capsules.len(), job.scene.leaves.len()), (1, 1));
    let births = [nursery.birth(fed), nursery.birth(trunk)];
    assert_eq!(job.requests[1].probe.blind_to, births, "a bud sees neither itself nor its stem");
}

#[test]
fn render_cube_maps_and_choose_growth_targets_find_half_the_sky_over_open_ground() {
    let mut nursery = Nursery::new(lam_king());
    let trunk = nursery.stem(None, 2.0);
    let bud = nursery.apical_bud(Some(trunk), 0.0, 1.0);
    nursery.run(gather_probes);
    nursery.run(render_cube_maps);
    assert_eq!(nursery.app.world().resource::<SensingJob>().found.len(), 1);
    nursery.run(choose_growth_targets);
    let seen = *nursery.get::<Exposure>(bud);
    assert!(seen.sensed && (seen.light - 0.5).abs() < 0.01, "{seen:?}");
    assert_eq!(seen.space, 1.0, "the ground is out of range");
    assert!(nursery.get::<GrowthTarget>(bud).heading.distance(Vec3::Y) < 1e-6, "in the open, straight on");
}

#[test]
fn choose_growth_targets_counts_all_as_lit_when_nothing_is_modelled() {
    let mut nursery = Nursery::new(lam_king());
    nursery.app.insert_resource(Mechanisms { light: false, space: false, energy: false });
    let bud = nursery.apical_bud(None, 0.0, 0.0);
    nursery.run(gather_probes);
    nursery.run(render_cube_maps);
    nursery.run(choose_growth_targets);
    assert_eq!(*nursery.get::<Exposure>(bud), Exposure { light: 1.0, space: 1.0, sensed: true });
}

#[test]
fn close_books_counts_store_and_allotments() {
    let mut nursery = Nursery::new(lam_king()).store(2.0);
    let trunk = nursery.stem(None, 0.2);
    nursery.apical_bud(Some(trunk), 1.0, 0.75);
    nursery.run(finish::close_books);
    close(nursery.ledger().closed, 2.75);
}

#[test]
fn count_step_counts() {
    let mut nursery = Nursery::new(lam_king());
    nursery.run(finish::count_step);
    assert_eq!(*nursery.app.world().resource::<StepCount>(), StepCount(1));
}

#[test]
fn time_stage_books_the_time_since_the_last_one_to_its_stage() {
    let mut nursery = Nursery::new(lam_king());
    nursery.run(open_books);
    std::thread::sleep(std::time::Duration::from_millis(3));
    nursery.run(finish::time_stage::<{ Stage::Update as usize }>);
    let seconds = nursery.app.world().resource::<finish::StageTimes>().seconds;
    assert!(seconds[Stage::Update as usize - 1] >= 0.003, "{seconds:?}");
    assert_eq!(seconds.iter().filter(|s| **s > 0.0).count(), 1);
}

#[test]
fn any_germinated_tells_of_a_seed_that_opened_in_this_step_alone() {
    let mut nursery = Nursery::new(lam_king());
    let asks =
        |nursery: &mut Nursery| nursery.app.world_mut().run_system_once(generation::any_germinated).unwrap();
    assert!(asks(&mut nursery), "the nursery's plant opened at step 0");
    nursery.app.insert_resource(StepCount(1));
    assert!(!asks(&mut nursery));
    nursery.set(nursery.plant, EnergyStore::default());
    assert!(!asks(&mut nursery), "it has yet to open");
}

#[test]
fn organs_of_two_plants_keep_their_own_books() {
    let mut nursery = Nursery::new(lam_king()).store(1.0);
    let other = EnergyStore { stored: 5.0, germinated: Some(0) };
    let other = nursery.app.world_mut().spawn((Plant::new(lam_king(), 8), other)).id();
    let trunk = nursery.stem(None, 0.2);
    let leaf = nursery.leaf(trunk, 1.0, 1.0);
    nursery.set(leaf, EnergyFlow { income: 1.0, upkeep: 0.0 });
    nursery.run(energy::pay_upkeep);
    close(nursery.stored(), 2.0);
    close(nursery.get::<EnergyStore>(other).stored, 5.0);
}
