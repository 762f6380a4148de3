//! Shoots of a growing plant under the controller.

use super::*;

/// A shoot of ten metres, a segment a decimetre.
fn shoot(species: &Species, turn: Quat, target: Vec3, seed: u64) -> Vec<Vec3> {
    let mut tip = Tip {
        position: Vec3::ZERO,
        rotation: turn,
        bearer: Quat::IDENTITY,
        bud: ApicalBud::default(),
        steering: Steering::default(),
        signals: Signals::default(),
    };
    let [mut sensing, mut wander] = [1, 2].map(|k| Pcg64Mcg::seed_from_u64(seed * 2 + k));
    let plan = Plan { length: 10.0, closes: false, nodes: u32::MAX };
    let obstacles = Obstacles { solids: &[], wood: &StandingWood::default(), floor: None };
    let segments = extend(&mut tip, plan, target, 0, species, obstacles, |along| {
        Influence::of(species, along, &mut sensing, &mut wander)
    });
    segments.iter().map(|s| s.position + s.rotation * Vec3::Y * s.internode.length).collect()
}

fn wavering() -> Species {
    Species {
        steering_lag: 5,
        compensation_ratio: 0.8,
        sensing_error_deg: 4.0,
        wander_deg: 3.0,
        nutation_deg: 1.0,
        internode_m: 0.1,
        ..Species::default()
    }
}

#[test]
fn turning_the_world_turns_the_shoot() {
    let species = wavering();
    for (seed, turn) in
        [(1, Quat::from_rotation_z(2.0)), (2, Quat::from_euler(EulerRot::XYZ, 0.4, -2.9, 1.3))]
    {
        let here = shoot(&species, Quat::IDENTITY, towards_x(0.3), seed);
        let there = shoot(&species, turn, turn * towards_x(0.3), seed);
        let off = here.iter().zip(&there).map(|(a, b)| (turn * *a).distance(*b)).fold(0.0, f32::max);
        assert!(here.len() >= 100 && off < 1e-4, "{off}");
    }
    // What draws a shoot up or level turns with the world about the vertical.
    let drawn = Species {
        gravitropism: ByOrder::all(0.4),
        orthotropism: ByOrder::all(0.6),
        orthotropism_m: 4.0,
        plagiotropism: ByOrder::all(0.7),
        autotropism: ByOrder::all(0.5),
        ..wavering()
    };
    let aslant = Quat::from_rotation_z(-0.9);
    for (seed, angle) in [(3, 0.7), (4, -2.5)] {
        let turn = Quat::from_rotation_y(angle);
        let here = shoot(&drawn, aslant, aslant * towards_x(0.3), seed);
        let there = shoot(&drawn, turn * aslant, turn * aslant * towards_x(0.3), seed);
        let off = here.iter().zip(&there).map(|(a, b)| (turn * *a).distance(*b)).fold(0.0, f32::max);
        assert!(here.len() >= 100 && off < 1e-4, "{off}");
        let light_alone = shoot(&wavering(), aslant, aslant * towards_x(0.3), seed);
        assert!(light_alone[99].distance(here[99]) > 1.0, "they do draw it");
    }
}

#[test]
fn a_straight_target_without_noise_gives_a_straight_shoot() {
    for (lag, ratio) in [(0, 1.0), (4, 0.72), (10, 0.3), (30, 5.0)] {
        let species = Species { steering_lag: lag, compensation_ratio: ratio, ..wavering() };
        let species = Species { sensing_error_deg: 0.0, wander_deg: 0.0, nutation_deg: 0.0, ..species };
        let turn = Quat::from_rotation_z(-0.6);
        let end = shoot(&species, turn, turn * Vec3::Y, 1);
        let off = end.iter().map(|p| p.cross(turn * Vec3::Y).length()).fold(0.0, f32::max);
        assert!(off < 1e-4, "lag {lag}: {off} m off the line");
    }
}

#[test]
fn st_12_shoots_bend_outward_then_upward_and_hang_where_gravity_draws_them() {
    let straight = Species { wander_deg: 0.0, sensing_error_deg: 0.0, nutation_deg: 0.0, ..wavering() };
    let bends = Species {
        phototropism: ByOrder::all(0.2),
        autotropism: ByOrder::all(1.0),
        orthotropism: ByOrder::all(8.0),
        orthotropism_m: 8.0,
        ..straight.clone()
    };
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    let way = shoot(&bends, level, Vec3::X, 1);
    let (begin, end) = ((way[5] - way[0]).normalize(), (way[99] - way[94]).normalize());
    assert!(begin.x > 0.95 && end.y > 0.95, "{begin} {end}");
    let hangs = Species { gravitropism: ByOrder::all(-3.0), ..straight };
    let way = shoot(&hangs, level, Vec3::X, 1);
    assert!((way[99] - way[94]).normalize().y < -0.8);
}

#[test]
fn at_the_extremes_of_every_range_no_branch_passes_through_a_wall() {
    let names = [
        "steering_lag",
        "compensation_ratio",
        "steering_integral",
        "steering_derivative",
        "sensing_error_deg",
        "wander_deg",
        "nutation_deg",
        "nutation_m",
        "phototropism",
        "gravitropism",
        "orthotropism",
        "orthotropism_m",
        "plagiotropism",
        "autotropism",
    ];
    let mut figure = quick("figure_1d");
    figure.scenario.sensing.leaf_face = 2;
    figure.scenario.sensing.bud_face = 4;
    let solid = |shape, at| PlacedSolid { name: format!("at {at}"), shape, at, ..default() };
    figure.scenario.solids.push(solid(SolidShape::Ball { radius: 0.3 }, Vec3::new(0.2, 0.9, 0.45)));
    let organs = over_seeds(0..100, |seed| {
        // Every third is an oak, whose shoots also go round wood.
        let (name, mut resolved) =
            if seed % 3 == 2 { ("oak", quick("wall")) } else { ("lam_king", figure.clone()) };
        let species = resolved.species.get_mut(name).unwrap();
        species.internode_m = 0.07;
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        for name in names {
            let range = Species::parameters().iter().find(|p| p.name == name).unwrap().range;
            let top = chance::unit(&mut rng) < 0.5;
            let value = match range {
                burgeon::species::parameter::Range::Real { min, max } => {
                    Value::Real(if top { max } else { min })
                }
                burgeon::species::parameter::Range::Whole { min, max } => {
                    Value::Whole(if top { max } else { min })
                }
                burgeon::species::parameter::Range::Any => panic!("{name} has no range"),
            };
            species.set(name, &value).unwrap();
        }
        let mut garden = garden(resolved, seed);
        let mut organs = 0;
        for step in 1..=8 {
            garden.step().unwrap();
            let shot = garden.snapshot();
            assert!(shot.pose.iter().all(|p| p.position.is_finite() && p.rotation.is_normalized()));
            if let Err(e) = check_solids(garden.world_mut(), &shot) {
                panic!("seed {seed}, step {step}: {e}");
            }
            organs = shot.len();
        }
        organs
    });
    // A seedling drawn to the ground with all its might stays in it.
    let grew = organs.iter().filter(|n| **n > 20).count();
    println!("{grew} of 100 grew; organs {organs:?}");
    assert!(grew > 40, "{organs:?}");
}
