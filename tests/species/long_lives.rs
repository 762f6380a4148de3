//! Two hundred years of every species.

use std::ops::Range;

use super::*;
use crate::common::check::{check, check_world};

/// Years a plant lives here.
const YEARS: u32 = 200;

/// Leaves beyond which a plant is cut to three quarters of its height and width, so that two centuries take seconds.
const ROOM: u32 = 250;

/// The light of an open sky, and of one that neighbours close in part.
const SKIES: [f32; 2] = [1.0, 0.6];

/// What they are called.
const UNDER: [&str; 2] = ["in the open", "in shade"];

/// The second sky on poor ground, where no plant lives by much less than it has in the open.
const POOR_SHADE: f32 = 0.8;

/// Income on poor ground as a share of a species' own: for those that bear no cutting, and for the willow, whose
/// curtain hangs within any block.
fn poor_ground(name: &str) -> Option<f32> {
    match name {
        "norway_spruce" => Some(0.16),
        "scots_pine" => Some(0.4),
        "silver_birch" => Some(0.6),
        "japanese_maple" => Some(0.33),
        "candelabra" => Some(0.5),
        "weeping_willow" => Some(0.46),
        _ => None,
    }
}

/// Leaves after each step of a plant that is kept small; what must hold holds after each of them.
fn kept_small(name: &str, sky: usize) -> Vec<u32> {
    let mut resolved = alone(name);
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 2;
    let poor = poor_ground(name);
    let shade = if poor.is_some() { POOR_SHADE } else { SKIES[1] };
    resolved.scenario.sky.strength = [SKIES[0], shade][sky];
    resolved.species.get_mut(name).unwrap().leaf_income *= poor.unwrap_or(1.0);
    let steps = YEARS * resolved.species[name].steps_per_year;
    let mut garden = garden(resolved, 1);
    (0..steps)
        .map(|step| {
            let form = garden.step().unwrap().form;
            let holds = check(&garden.snapshot()).and_then(|()| check_world(garden.world_mut()));
            holds.unwrap_or_else(|why| panic!("{name}, {}, step {step}: {why}", UNDER[sky]));
            if poor.is_none() && form.leaves > ROOM {
                let half = 0.375 * form.crown_width_m;
                let (from, to) = (Vec3::new(-half, -1.0, -half), Vec3::new(half, 0.75 * form.height_m, half));
                apply(garden.world_mut(), &Edit::Shear { from, to }).unwrap();
            }
            form.leaves
        })
        .collect()
}

#[test]
fn every_species_lives_two_hundred_years_in_the_open_and_in_shade() {
    // In the order of what takes longest, more or less, so that no thread waits for the last.
    let lives: Vec<(String, usize)> =
        [0, 1].into_iter().flat_map(|sky| trees().into_iter().map(move |name| (name, sky))).collect();
    let all: Range<u64> = 0..lives.len() as u64;
    let leaves = over_seeds(all, |i| kept_small(&lives[i as usize].0, lives[i as usize].1));
    let mut dead = Vec::new();
    for ((name, sky), life) in lives.iter().zip(&leaves) {
        let at = [20, 50, 100, 150, YEARS].map(|year| life[life.len() * year as usize / YEARS as usize - 1]);
        println!("{name}, {}: {at:?} leaves at 20, 50, 100, 150 and 200 years", UNDER[*sky]);
        // A stump may be without leaves until it has sprouted.
        if life.windows(10).any(|years| years.iter().all(|leaves| *leaves == 0)) {
            dead.push((name, UNDER[*sky], at));
        }
    }
    assert!(dead.is_empty(), "{dead:?}");
}
