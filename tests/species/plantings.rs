//! The plantings that are shipped: a hedge, an avenue, a grove.

use burgeon::plant::OrganKind;

use super::*;

/// Where the leaves of each plant are, metres.
fn leaves(shot: &Snapshot) -> Vec<Vec<Vec3>> {
    let mut leaves = vec![Vec::new(); shot.plants.len()];
    for i in (0..shot.len()).filter(|&i| shot.state[i].kind() == OrganKind::Leaf) {
        leaves[shot.plant[i] as usize].push(shot.pose[i].position);
    }
    leaves
}

#[test]
fn a_hedge_cut_every_winter_keeps_its_block_and_is_in_leaf_to_the_foot() {
    let resolved = shipped("hedge");
    let Some(Edit::Shear { from, to }) = resolved.scenario.edits.last().map(|timed| timed.edit.clone())
    else {
        panic!("the last edit is a cut")
    };
    let oak = &resolved.species["oak"];
    let summer = oak.flush_internodes.get(0) * oak.node_spacing_m;
    let shot = last(resolved.clone(), 1, resolved.scenario.steps);
    for i in (0..shot.len()).filter(|&i| shot.state[i].kind() == OrganKind::Internode) {
        let tip = shot.pose[i].tip(shot.length(i));
        let near = tip.clamp(from, to).distance(tip);
        assert!(near < 1.1 * summer, "a stem {near} m beyond the block: more than a summer's shoot");
    }
    let plants = leaves(&shot);
    assert!(plants.iter().all(|leaves| !leaves.is_empty()), "every oak lives");
    let all: Vec<Vec3> = plants.into_iter().flatten().collect();
    let low = all.iter().filter(|at| at.y < to.y / 3.0).count() as f32 / all.len() as f32;
    println!("{} leaves, {low:.2} of them in the lowest third", all.len());
    assert!(low > 0.15, "{low}");
}

#[test]
fn oaks_of_an_avenue_lean_from_the_house_and_stay_behind_those_across_the_road() {
    for seed in 1..4 {
        let resolved = coarse(shipped("avenue"));
        let places: Vec<Vec3> = resolved.scenario.plants.iter().map(|plant| plant.at).collect();
        let house = resolved.scenario.solids[0].at.x;
        let plants = leaves(&last(resolved, seed, 17));
        let lean = |k: usize| {
            let middle = plants[k].iter().map(|at| at.x).sum::<f32>() / plants[k].len() as f32;
            (middle - places[k].x) * -house.signum()
        };
        let beside: Vec<usize> =
            (0..places.len()).filter(|&k| (places[k].x - house).abs() < house.abs()).collect();
        let across: Vec<usize> = (0..places.len()).filter(|k| !beside.contains(k)).collect();
        let of = |row: &[usize]| row.iter().map(|&k| plants[k].len()).sum::<usize>();
        let leans: Vec<f32> = beside.iter().map(|&k| lean(k)).collect();
        println!("seed {seed}: lean {leans:.2?} m, leaves {} beside, {} across", of(&beside), of(&across));
        assert_eq!((beside.len(), across.len()), (3, 3));
        assert!(leans.iter().sum::<f32>() > 0.5, "{leans:?}");
        assert!(of(&beside) < of(&across));
    }
}

#[test]
fn five_species_of_a_grove_live_side_by_side_with_fewer_leaves_than_alone() {
    let grove = coarse(shipped("grove"));
    let alone = |k: usize| {
        let mut one = grove.clone();
        one.scenario.plants = vec![one.scenario.plants[k].clone()];
        leaves(&last(one, 1, 18))[0].len()
    };
    let together: Vec<usize> = leaves(&last(grove.clone(), 1, 18)).iter().map(Vec::len).collect();
    let alone: Vec<usize> = (0..together.len()).map(alone).collect();
    println!("leaves together {together:?}, alone {alone:?}");
    assert!(together.len() == 5 && together.iter().all(|leaves| *leaves > 100), "{together:?}");
    let fewer = together.iter().zip(&alone).filter(|(together, alone)| together < alone).count();
    assert!(fewer >= 4, "{together:?} {alone:?}");
    assert!(together.iter().sum::<usize>() * 10 < alone.iter().sum::<usize>() * 9, "{together:?} {alone:?}");
}
