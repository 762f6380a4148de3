//! Dense stands, gaps and losses: what neighbours make of a tree, asserted over seeds for three species.

use burgeon::plant::measure::Form;

use super::*;
use crate::common::measure::{mean_position, median};

/// Species, and the steps in which each shows it.
const THREE: [(&str, u32); 3] = [("oak", 11), ("silver_birch", 13), ("beech", 12)];

#[test]
fn in_a_dense_stand_a_tree_is_taller_and_narrower_and_bare_below() {
    for (name, steps) in [("oak", 15), ("silver_birch", 17), ("beech", 17)] {
        // The one in the middle comes first, six stand around it.
        let ring =
            (0..6).map(|k| Quat::from_rotation_y(k as f32 * core::f32::consts::FRAC_PI_3) * Vec3::X * 1.2);
        let places = core::iter::once(Vec3::ZERO).chain(ring);
        let stand = coarse(Library::embedded().resolve(planted(name, places)).unwrap());
        let forms = over_seeds(1..8, |seed| {
            let open = Form::of(&last(coarse(alone(name)), seed, steps), Some(0));
            let dense = Form::of(&last(stand.clone(), seed, steps), Some(0));
            (open, dense)
        });
        let of = |form: fn(&Form) -> f32| {
            let (open, dense) = forms.iter().map(|(a, b)| (f64::from(form(a)), f64::from(form(b)))).unzip();
            (median(open), median(dense))
        };
        let height = of(|form| form.height_m);
        let width = of(|form| form.crown_width_m);
        let base = of(|form| form.live_crown_base_m);
        println!("{name}, open and dense, m: height {height:.2?}, width {width:.2?}, crown base {base:.2?}");
        assert!(height.1 > 1.01 * height.0, "{name}: height, m, {height:?}");
        assert!(width.1 < 0.85 * width.0, "{name}: width, m, {width:?}");
        assert!(base.1 > 2.0 * base.0, "{name}: crown base, m, {base:?}");
    }
}

#[test]
fn beside_a_wall_a_crown_leans_into_the_open() {
    // Wide ones: a birch as young as that hardly reaches the wall.
    for (name, steps) in [("oak", 13), ("beech", 18), ("hazel", 12)] {
        let middle = |resolved: ResolvedScenario, seed: u64| {
            let shot = last(resolved, seed, steps);
            let is_leaf = |i: usize| shot.state[i].kind() == burgeon::plant::OrganKind::Leaf;
            f64::from(mean_position(&shot, is_leaf).x)
        };
        let leans = over_seeds(1..9, |seed| {
            let mut resolved = alone(name);
            let open = middle(resolved.clone(), seed);
            resolved.scenario.solids = vec![PlacedSolid {
                shape: SolidShape::Box { size: Vec3::new(0.4, 8.0, 12.0) },
                at: Vec3::new(-0.9, 4.0, 0.0),
                ..default()
            }];
            middle(resolved, seed) - open
        });
        println!("{name}: with the wall the crown's middle is {leans:.2?} m farther out");
        assert!(median(leans.clone()) > 0.05, "{name}: {leans:?}");
        assert!(leans.iter().filter(|lean| **lean > 0.0).count() >= 7, "{name}: {leans:?}");
    }
}

#[test]
fn after_losing_half_its_crown_a_tree_refills_the_gap() {
    const YEARS: u32 = 5;
    for (name, steps) in THREE {
        let regrown = over_seeds(1..4, |seed| {
            let mut garden = garden(coarse(alone(name)), seed);
            for _ in 0..steps {
                garden.step().unwrap();
            }
            let side = |shot: &Snapshot| {
                let leaf = |i: usize| shot.state[i].kind() == burgeon::plant::OrganKind::Leaf;
                (0..shot.len()).filter(|&i| leaf(i) && shot.pose[i].position.x > 0.1).count() as f64
            };
            let before = side(&garden.snapshot());
            prune_side(&mut garden);
            let cut = side(&garden.snapshot());
            for _ in 0..YEARS {
                garden.step().unwrap();
            }
            (cut / before, side(&garden.snapshot()) / before)
        });
        println!("{name}: of the half lost, left and {YEARS} years later {regrown:.2?}");
        let after = median(regrown.iter().map(|(_, after)| *after).collect());
        assert!(after > 0.6, "{name}: {after}");
        assert!(regrown.iter().all(|(cut, after)| *after > 2.0 * cut), "{name}: {regrown:?}");
    }
}

/// Cuts every limb that begins on the side, at its base, and leaves the trunk.
fn prune_side(garden: &mut burgeon::scenario::Garden) {
    loop {
        let shot = garden.snapshot();
        let limb = (0..shot.len()).find(|&i| {
            let parent = shot.parent[i];
            shot.state[i].kind() == burgeon::plant::OrganKind::Internode
                && parent != burgeon::plant::NO_PARENT
                && shot.order[i] > shot.order[parent as usize]
                && shot.pose[i].tip(shot.length(i)).x > 0.1
        });
        let Some(limb) = limb else { return };
        apply(garden.world_mut(), &Edit::Prune { plant: 0, lineage: shot.lineage[limb].0 }).unwrap();
    }
}
