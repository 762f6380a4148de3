//! Variation by feedback control: the rows of Streit, Federl & Sousa.

mod common;

use bevy::math::{Vec2, ops};
use bevy::prelude::*;
use burgeon::chance;
use burgeon::environment::SolidShape;
use burgeon::environment::workers::Workers;
use burgeon::growth::shoots::{Plan, Tip, extend};
use burgeon::plant::skeleton::{Skeleton, StemSegment};
use burgeon::plant::{ApicalBud, NO_PARENT};
use burgeon::scenario::PlacedSolid;
use burgeon::species::Species;
use burgeon::species::parameter::{ByOrder, Value};
use burgeon::tropism::relel::{Relel, bend};
use burgeon::tropism::root::{AuxinRoot, RootSettings};
use burgeon::tropism::stability::{critical_gain, stability};
use burgeon::tropism::vary::{Variation, siblings, vary};
use burgeon::tropism::{Control, Influence, Signals, Spread, Steering, lean, step, turned_to};
use common::check::check_solids;
use common::{grown, over_seeds, quick};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// A tip steered sub-step by sub-step.
struct Flight {
    control: Control,
    steering: Steering,
    signals: Signals,
    frame: Quat,
}

impl Flight {
    fn new(control: Control, frame: Quat) -> Self {
        Self { control, steering: Steering::default(), signals: Signals::default(), frame }
    }

    fn heading(&self) -> Vec3 {
        self.frame * Vec3::Y
    }

    fn step(&mut self, target: Vec3, influence: Influence) -> Vec3 {
        let (steering, signals) = (&mut self.steering, &mut self.signals);
        let to = step(&self.control, steering, signals, self.frame, target, influence);
        self.frame = turned_to(self.frame, to);
        to
    }
}

/// A direction in the x-y plane, `angle` from up towards x.
fn towards_x(angle: f32) -> Vec3 {
    Vec3::new(ops::sin(angle), ops::cos(angle), 0.0)
}

/// Error in that plane after each of `n` sub-steps without noise, `start` before the first.
fn errors(control: Control, start: f32, n: usize) -> Vec<f32> {
    let mut flight = Flight::new(control, Quat::IDENTITY);
    let target = towards_x(start);
    let mut seen = vec![start];
    for _ in 0..n {
        let h = flight.step(target, Influence::default());
        seen.push(ops::atan2(target.x * h.y - target.y * h.x, target.dot(h)));
    }
    seen
}

/// The recurrence of `ST-6`, no signals before the first disturbance.
fn recurrence(gain: f64, lag: usize, start: f64, n: usize) -> Vec<f64> {
    let mut e = vec![start];
    for k in 1..=n {
        let answered = k.checked_sub(1 + lag).map_or(0.0, |then| e[then]);
        e.push(e[k - 1] - gain * answered);
    }
    e
}

/// First sub-step at which the error has changed its sign, and how often it does.
fn crossings(errors: &[f32]) -> (usize, usize) {
    let turns: Vec<usize> = (1..errors.len()).filter(|&k| errors[k - 1] * errors[k] <= 0.0).collect();
    (turns.first().copied().unwrap_or(usize::MAX), turns.len())
}

fn widest(errors: &[f32]) -> f32 {
    errors.iter().fold(0.0, |w, e| w.max(e.abs()))
}

#[test]
fn st_05_a_disturbance_is_not_answered_before_it_is_sensed() {
    for (lag, answered) in [(0, 1), (3, 4)] {
        let mut flight = Flight::new(Control::new(0.25, lag).unwrap(), Quat::IDENTITY);
        let push = Influence { disturbance: lean(0.3, 0.0), ..default() };
        let off = flight.step(Vec3::Y, push).angle_between(Vec3::Y);
        assert!((off - 0.3).abs() < 1e-5, "the push itself goes through: {off}");
        for k in 1..=answered {
            let left = flight.step(Vec3::Y, Influence::default()).angle_between(Vec3::Y);
            let expected = if k < answered { 0.3 } else { 0.225 };
            assert!((left - expected).abs() < 1e-3, "lag {lag}, sub-step {k}: {left}");
        }
    }
    // An error of the sensor is answered as if it were true, in the same sub-step.
    let mut flight = Flight::new(Control::new(1.0, 0).unwrap(), Quat::IDENTITY);
    let misled = flight.step(Vec3::Y, Influence { sensing: lean(0.2, 1.0), ..default() });
    assert!((misled.angle_between(Vec3::Y) - 0.2).abs() < 1e-4);
}

#[test]
fn st_06_without_noise_the_controller_is_the_recurrence() {
    let mut worst = 0.0_f64;
    for lag in 1..=30_usize {
        for share in [0.3, 0.6, 0.9, 0.99, 1.05] {
            let gain = share * critical_gain(lag as u32);
            let seen = errors(Control::new(gain, lag as u32).unwrap(), 0.35, 300);
            let paper = recurrence(gain.into(), lag, 0.35, 300);
            for (k, (a, b)) in seen.iter().zip(&paper).enumerate().take_while(|(_, (_, b))| b.abs() < 3.0) {
                let off = (f64::from(*a) - b).abs();
                worst = worst.max(off);
                assert!(off < 1e-5, "lag {lag}, gain {gain}, sub-step {k}: {a} for {b}");
            }
        }
    }
    println!("largest difference from the recurrence: {worst:.1e} rad");
}

#[test]
fn st_06_errors_fade_or_grow_on_the_right_side_of_the_limit() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for _ in 0..200 {
        let lag = 1 + (chance::unit(&mut rng) * 30.0) as u32;
        let off = 0.03 + 0.4 * chance::unit(&mut rng);
        let share = if chance::unit(&mut rng) < 0.5 { 1.0 - off } else { 1.0 + off };
        let control = Control::new(share * critical_gain(lag), lag).unwrap();
        let seen = errors(control, 0.02, 6000);
        let grows = widest(&seen) > 5.0 * 0.02;
        let fades = widest(&seen[seen.len() - 5 * lag as usize..]) < 0.5 * 0.02;
        let read = stability(&control).unwrap();
        assert_eq!((grows, fades), (!read.is_stable(), read.is_stable()), "lag {lag}, {share} of the limit");
        assert_eq!(read.factor < 1.0, read.is_stable());
    }
}

#[test]
fn st_06_period_and_damping_are_those_seen() {
    for (lag, ratio) in [(4, 0.72), (6, 0.9), (12, 0.8), (30, 0.65)] {
        let control = Control::of_ratio(ratio, lag).unwrap();
        let read = stability(&control).unwrap();
        let seen = errors(control, 0.01, 40 * lag as usize);
        let turns: Vec<usize> = (1..seen.len()).filter(|&k| seen[k - 1] * seen[k] < 0.0).collect();
        let period = 2.0 * (turns[turns.len() - 1] - turns[0]) as f32 / (turns.len() - 1) as f32;
        assert!((period / read.period.unwrap() - 1.0).abs() < 0.06, "lag {lag}: {period} {read:?}");
        let swing = read.period.unwrap().round() as usize;
        let late = 30 * lag as usize;
        let decay = widest(&seen[late..late + swing]) / widest(&seen[late - swing..late]);
        let told = ops::powf(read.factor, swing as f32);
        assert!((decay / told - 1.0).abs() < 0.1, "lag {lag}: {decay} {told}");
    }
}

#[test]
fn st_07_the_response_is_always_the_same_distance_from_the_tip() {
    let sub_step = 0.05;
    for pushed in [0_usize, 3, 7, 20] {
        let mut flight = Flight::new(Control::new(1.0, 2).unwrap(), Quat::IDENTITY);
        let mut sensed = None;
        for k in 0..pushed + 8 {
            let influence =
                Influence { disturbance: if k == pushed { lean(0.4, 0.7) } else { Vec2::ZERO }, ..default() };
            let before = flight.heading();
            let after = flight.step(Vec3::Y, influence);
            if k > pushed && sensed.is_none() {
                sensed = Some(k);
            }
            if k > pushed && after.angle_between(before) > 0.01 {
                let distance = (k - sensed.unwrap()) as f32 * sub_step;
                assert_eq!(distance, 2.0 * sub_step, "pushed at sub-step {pushed}");
                assert!(after.angle_between(Vec3::Y) < 1e-3, "gain 1 answers the whole error");
                break;
            }
            assert!(k < pushed + 7, "no response");
        }
    }
}

#[test]
fn st_08_target_and_disturbance_act_in_planes_of_their_own() {
    let wave = |k: usize, length: f32| ops::sin(k as f32 / length * core::f32::consts::TAU);
    let fly = |aimed: bool, pushed: bool| {
        let mut flight = Flight::new(Control::of_ratio(1.0, 3).unwrap(), Quat::IDENTITY);
        (0..200)
            .map(|k| {
                let target = if aimed { towards_x(0.4 * wave(k, 60.0)) } else { Vec3::Y };
                let push = if pushed { Vec2::new(0.0, 0.06 * wave(k, 11.0)) } else { Vec2::ZERO };
                flight.step(target, Influence { disturbance: push, ..default() })
            })
            .collect::<Vec<_>>()
    };
    let (target, push, both) = (fly(true, false), fly(false, true), fly(true, true));
    assert!(target.iter().all(|h| h.z.abs() < 1e-5) && push.iter().all(|h| h.x.abs() < 1e-5));
    assert!(target.iter().any(|h| h.x.abs() > 0.2) && push.iter().any(|h| h.z.abs() > 0.05));
    for k in 0..200 {
        assert!((both[k].x - target[k].x).abs() < 0.03 && (both[k].z - push[k].z).abs() < 0.03, "{k}");
    }
}

#[test]
fn st_08_draws_have_the_spread_asked_for() {
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    let mut draw = |spread: Spread| {
        let all: Vec<Vec2> = (0..4000).map(|_| spread.draw(0.2, &mut rng)).collect();
        let mean = all.iter().sum::<Vec2>() / 4000.0;
        let square = all.iter().map(|v| v.length_squared()).sum::<f32>() / 4000.0;
        (mean.length(), square.sqrt(), all.iter().fold(0.0_f32, |w, v| w.max(v.length())))
    };
    let (mean, deviation, most) = draw(Spread::Gaussian);
    assert!(mean < 0.01 && (deviation - 0.2).abs() < 0.01 && most > 0.5, "{mean} {deviation} {most}");
    let (mean, deviation, most) = draw(Spread::Uniform);
    assert!(
        mean < 0.01 && (deviation - 0.2 / 3_f32.sqrt()).abs() < 0.01 && most <= 0.2,
        "{deviation} {most}"
    );
}

#[test]
fn st_09_smaller_lag_corrects_sooner_and_swings_faster() {
    let turned = core::f32::consts::FRAC_PI_2;
    let lags = [4_u32, 5, 6, 10, 20, 30];
    let seen = lags.map(|lag| crossings(&errors(Control::of_ratio(0.72, lag).unwrap(), turned, 600)));
    println!("ST-9 lag {lags:?}: first crossing and crossings in 600 sub-steps {seen:?}");
    assert_eq!([seen[0].0, seen[1].0, seen[2].0, seen[5].0], [7, 9, 11, 52]);
    assert!(seen.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 > w[1].1), "{seen:?}");
}

#[test]
fn st_10_under_equal_and_over_compensation() {
    for lag in [4_u32, 12] {
        let limit = 1.0 / (critical_gain(lag) * lag as f32);
        let swing = 4 * lag as usize + 2;
        let growth = [0.9 * limit, limit, 1.2 * limit].map(|ratio| {
            let seen = errors(Control::of_ratio(ratio, lag).unwrap(), 0.1, 12 * swing);
            widest(&seen[11 * swing..]) / widest(&seen[2 * swing..3 * swing])
        });
        println!("ST-10 lag {lag}: the swing changes by {growth:.3?} over eight swings");
        assert!(growth[0] > 1.5 && (growth[1] - 1.0).abs() < 0.05 && growth[2] < 0.5, "{growth:?}");
    }
}

#[test]
fn st_13_integral_control_takes_away_what_a_steady_push_leaves_and_derivative_control_damps() {
    let pushed = |integral: f32| {
        let mut flight =
            Flight::new(Control { gain: 0.1, integral, derivative: 0.0, lag: 3 }, Quat::IDENTITY);
        let push = Influence { disturbance: Vec2::new(0.02, 0.0), ..default() };
        (0..800).map(|_| flight.step(Vec3::Y, push).angle_between(Vec3::Y)).last().unwrap()
    };
    // Proportional control stops where the answer equals the push: at push / gain.
    assert!((pushed(0.0) - 0.2).abs() < 1e-3, "{}", pushed(0.0));
    assert!(pushed(0.02) < 1e-3, "{}", pushed(0.02));

    let swings = |derivative: f32| {
        let control = Control { gain: 0.16, integral: 0.0, derivative, lag: 6 };
        widest(&errors(control, 0.3, 140)[100..])
    };
    assert!(swings(2.0) < 0.5 * swings(0.0), "{} {}", swings(2.0), swings(0.0));
}

#[test]
fn headings_stay_unit_and_targets_straight_behind_do_not_stick() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let mut flight = Flight::new(Control::of_ratio(0.6, 7).unwrap(), Quat::IDENTITY);
    for k in 0..100_000 {
        let target = if k / 500 % 2 == 0 { Vec3::Y } else { Vec3::NEG_Y };
        let [sensing, disturbance] = [0.3, 0.2].map(|sd| Spread::Gaussian.draw(sd, &mut rng));
        let to = flight.step(target, Influence { sensing, disturbance });
        assert!((to.length() - 1.0).abs() < 1e-6 && (flight.frame.length() - 1.0).abs() < 1e-5, "{k}");
    }
    for lag in [0, 1, 5, 30] {
        let control = Control::of_ratio(1.5, lag).unwrap();
        let mut flight = Flight::new(control, Quat::from_rotation_x(0.4));
        let target = -flight.heading();
        let end = (0..40 * (lag + 1)).map(|_| flight.step(target, Influence::default())).last().unwrap();
        assert!(end.angle_between(target) < 0.05, "lag {lag}: {}", end.angle_between(target));
    }
}

/// A shoot of ten metres, a segment a decimetre.
fn shoot(species: &Species, turn: Quat, target: Vec3, seed: u64) -> Vec<Vec3> {
    let mut tip = Tip {
        position: Vec3::ZERO,
        rotation: turn,
        bud: ApicalBud::default(),
        steering: Steering::default(),
        signals: Signals::default(),
    };
    let [mut sensing, mut wander] = [1, 2].map(|k| Pcg64Mcg::seed_from_u64(seed * 2 + k));
    let plan = Plan { length: 10.0, closes: false, nodes: u32::MAX };
    let segments = extend(&mut tip, plan, target, 0, species, &[], None, |along| {
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
    let mut resolved = quick("figure_1d");
    resolved.scenario.sensing.leaf_face = 2;
    resolved.scenario.sensing.bud_face = 4;
    let solid = |shape, at| PlacedSolid { name: format!("at {at}"), shape, at, ..default() };
    resolved.scenario.solids.push(solid(SolidShape::Ball { radius: 0.3 }, Vec3::new(0.2, 0.9, 0.45)));
    let organs = over_seeds(0..100, |seed| {
        let mut resolved = resolved.clone();
        let species = resolved.species.get_mut("lam_king").unwrap();
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
        let mut garden = grown(resolved, seed, 8);
        let shot = garden.snapshot();
        assert!(shot.pose.iter().all(|p| p.position.is_finite() && p.rotation.is_normalized()));
        if let Err(e) = check_solids(garden.world_mut(), &shot) {
            panic!("seed {seed}: {e}");
        }
        shot.len()
    });
    // A seedling drawn to the ground with all its might stays in it.
    let grew = organs.iter().filter(|n| **n > 20).count();
    println!("{grew} of 100 grew; organs {organs:?}");
    assert!(grew > 40, "{organs:?}");
}

/// A trunk of a hundred segments with an arched side branch at every fifth: 500 internodes.
fn plant() -> Skeleton {
    let mut plant = Skeleton::default();
    let up = |k: usize| Vec3::new(0.0, 0.05 * k as f32, 0.0);
    let trunk = plant.add_stem(None, &(0..=100).map(up).collect::<Vec<_>>(), [0.04, 0.01]);
    for k in (0..100).step_by(5) {
        let side = Quat::from_rotation_y(2.4 * k as f32) * Vec3::X;
        let arch = |j: usize| up(k + 1) + (side + Vec3::Y * (0.4 - 0.02 * j as f32)) * 0.05 * j as f32;
        let branch = plant.add_stem(Some(trunk[k]), &(0..=20).map(arch).collect::<Vec<_>>(), [0.01, 0.004]);
        plant.add_leaf(branch[19], side, 1.0);
    }
    plant
}

#[test]
fn siblings_keep_the_species_and_no_two_are_alike() {
    let base = plant();
    assert_eq!(base.segments.len(), 500);
    let workers = Workers::new(2).unwrap();
    let all = siblings(&base, &Variation::default(), 7, 100, &workers).unwrap();
    let mut heights = Vec::new();
    for one in &all {
        one.check().unwrap();
        assert_eq!((one.nodes(), one.leaves.len()), (base.nodes(), base.leaves.len()));
        assert!((one.total_length() / base.total_length() - 1.0).abs() < 1e-5);
        heights.push(one.height() / base.height());
    }
    let [low, high] =
        [heights.iter().copied().fold(9.0, f32::min), heights.iter().copied().fold(0.0, f32::max)];
    println!("heights of 100 siblings: {low:.3} to {high:.3} of the base model's");
    assert!(low > 0.85 && high < 1.05, "{low} {high}");
    let ends: Vec<Vec<Vec3>> =
        all.iter().map(|s| s.segments.iter().map(StemSegment::tip).collect()).collect();
    for (k, one) in ends.iter().enumerate() {
        for (l, other) in ends.iter().enumerate().skip(k + 1) {
            let apart = one.iter().zip(other).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert!(apart > 1e-3, "{k} and {l}: {apart}");
        }
    }
    // The same siblings again, on any number of threads, and one by one.
    assert_eq!(all, siblings(&base, &Variation::default(), 7, 100, &Workers::new(1).unwrap()).unwrap());
}

#[test]
fn st_11_without_noise_a_sibling_is_its_base_model_and_corners_stay() {
    let still = Variation { sensing_error: 0.0, disturbance: 0.0, ..Variation::default() };
    let base = plant();
    let straight = Variation { control: Control::DIRECT, ..still };
    for (variation, apart) in [(straight, 1e-4), (still, 0.25)] {
        let same = vary(&base, &variation, 1).unwrap();
        let ends: Vec<Vec3> = same.segments.iter().filter(|s| s.node).map(StemSegment::tip).collect();
        let off = ends.iter().zip(&base.segments).map(|(a, b)| a.distance(b.tip())).fold(0.0, f32::max);
        assert!(off < apart, "{off}");
    }
    // A corner of the base model is one of the sibling, by the same angle.
    let mut elbow = Skeleton::default();
    elbow.add_stem(None, &[Vec3::ZERO, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)], [0.02, 0.01]);
    let bent = vary(&elbow, &Variation { sub_step: Some(0.05), ..Variation::default() }, 3).unwrap();
    let corner = bent.segments.iter().position(|s| s.node).unwrap();
    let [before, after] = [corner, corner + 1].map(|k| bent.segments[k].pose.heading());
    let angle = before.angle_between(after).to_degrees();
    assert!((angle - 90.0).abs() < 20.0, "{angle}");
}

#[test]
fn st_11_a_branch_begins_where_its_parent_ends_and_keeps_to_gravity_or_to_the_parent() {
    let base = plant();
    let pushed = Variation { disturbance: 0.08, ..Variation::default() };
    for share in [0.0, 1.0] {
        let one = vary(&base, &Variation { relative_to_parent: share, ..pushed }, 5).unwrap();
        for stem in one.segments.iter().filter(|s| s.parent != NO_PARENT) {
            let apart = one.segments[stem.parent as usize].tip().distance(stem.pose.position);
            assert!(apart < 1e-5, "{apart}");
        }
    }
    // Branches that keep to gravity stray less from their own course than those that keep to a parent astray.
    let astray = |share: f32| {
        let variation = Variation { relative_to_parent: share, disturbance: 0.15, ..Variation::default() };
        let mut off = 0.0;
        for seed in 0..20 {
            let one = vary(&base, &variation, seed).unwrap();
            let ends: Vec<&StemSegment> = one.segments.iter().filter(|s| s.node).collect();
            let strays = ends.iter().zip(&base.segments).skip(100);
            off += strays.map(|(a, b)| a.pose.heading().angle_between(b.pose.heading())).sum::<f32>();
        }
        off
    };
    assert!(astray(1.0) > 1.05 * astray(0.0), "{} {}", astray(1.0), astray(0.0));
}

#[test]
fn turning_a_skeleton_turns_its_siblings() {
    let base = plant();
    let turn = Transform::from_rotation(Quat::from_euler(EulerRot::YXZ, 1.0, 2.5, -0.4));
    let (here, there) = (base.moved(turn), vary(&base, &Variation::default(), 4).unwrap().moved(turn));
    let here = vary(&here, &Variation::default(), 4).unwrap();
    let off = here.segments.iter().zip(&there.segments).map(|(a, b)| a.tip().distance(b.tip()));
    let off = off.fold(0.0, f32::max);
    assert!(off < 1e-4 * base.height().max(1.0), "{off}");
}

#[test]
fn what_cannot_be_varied_is_a_typed_error() {
    let fine = Variation::default();
    let told =
        |skeleton: &Skeleton, variation: &Variation| vary(skeleton, variation, 1).unwrap_err().to_string();
    assert_eq!(told(&Skeleton::default(), &fine), "the skeleton has no segments");
    let mut flat = plant();
    flat.segments[3].length = 0.0;
    assert!(told(&flat, &fine).contains("segment 3 is 0 m long"));
    let mut wild = plant();
    wild.segments[3].length = f32::NAN;
    assert!(vary(&wild, &fine, 1).is_err());
    let mut looped = plant();
    looped.segments[3].parent = 3;
    assert!(told(&looped, &fine).contains("does not come before"));
    let mut lost = plant();
    lost.leaves[0].on = 5000;
    assert!(told(&lost, &fine).contains("leaf 0"));
    for bad in [
        Variation { control: Control { gain: -1.0, ..fine.control }, ..fine },
        Variation { control: Control { lag: 31, ..fine.control }, ..fine },
        Variation { sensing_error: f32::NAN, ..fine },
        Variation { disturbance: 9.0, ..fine },
        Variation { relative_to_parent: 1.5, ..fine },
        Variation { sub_step: Some(0.0), ..fine },
        Variation { sub_step: Some(1e-5), ..fine },
    ] {
        assert!(vary(&plant(), &bad, 1).is_err(), "{bad:?}");
    }
}

#[test]
fn a_grown_plant_is_varied_and_steering_is_saved() {
    let mut garden = grown(quick("two_oaks"), 2, 4);
    assert!(!garden.snapshot().signals.is_empty(), "oaks answer late");
    let save = garden.save();
    let again = burgeon::scenario::Garden::resume(save, Workers::new(1).unwrap()).unwrap();
    assert_eq!(again.snapshot(), garden.snapshot());
    let base = Skeleton::of(&garden.snapshot(), 1).unwrap();
    let one = vary(&base, &Variation::default(), 1).unwrap();
    assert_eq!((one.nodes(), one.leaves.len()), (base.segments.len(), base.leaves.len()));
    assert!(Skeleton::of(&garden.snapshot(), 2).is_err());
}

#[test]
fn st_02_the_tip_angles_of_figure_3a() {
    let flank = |most| Relel { most, centre: 3.0, spread: 1.0 };
    for (time, derived, printed) in [(0.126, 18.07, 18.1), (0.380, 54.50, 54.5), (0.633, 90.79, 90.8)] {
        let angle = bend(flank(2.0), flank(1.0), time, 12.0, 1.0, 2000).tip_angle.to_degrees();
        println!("ST-2 t = {time}: {angle:.3} degrees, the paper {printed}");
        assert!((angle - derived).abs() < 0.05 && (angle - printed).abs() < 0.05, "{angle}");
    }
    // Proportional to the difference of the rates, and to nothing else.
    let angle = |upper, lower| bend(flank(upper), flank(lower), 0.1, 12.0, 1.0, 500).tip_angle;
    assert!((angle(3.0, 1.0) - 2.0 * angle(2.0, 1.0)).abs() < 1e-4 && angle(1.5, 1.5) == 0.0);
}

#[test]
fn st_03_different_zones_make_a_kink() {
    let upper = Relel { most: 3.0, centre: 3.0, spread: 0.7 };
    let lower = Relel { most: 1.0, centre: 5.0, spread: 1.0 };
    let root = bend(upper, lower, 0.5, 12.0, 1.0, 1200);
    let at = |distance: f32| root.bends[((12.0 - distance) * 100.0) as usize];
    assert!(at(3.0) > 0.0 && at(5.5) < 0.0, "it bends one way at the one zone, the other way at the other");
    let plain = bend(Relel { most: 2.0, ..upper }, Relel { most: 1.0, ..upper }, 0.5, 12.0, 1.0, 1200);
    assert!(plain.bends.iter().all(|bend| *bend >= 0.0));
}

#[test]
fn st_04_a_level_root_bends_until_it_is_aligned_and_a_hanging_one_grows_straight() {
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    for columns in [2, 12] {
        let settings = RootSettings { columns, ..RootSettings::default() };
        let mut root = AuxinRoot::new(settings, level).unwrap();
        let angles: Vec<f32> = (0..60)
            .map(|_| {
                root.grow(1.0);
                root.tip_angle().to_degrees()
            })
            .collect();
        println!(
            "ST-4, {columns} columns: tip to gravity by hour {angles:.1?}, {:.1} mm long",
            root.length()
        );
        assert!(angles[0] > 60.0 && angles[59] < 5.0, "{angles:?}");
        assert!(root.assemble().iter().all(|p| p.position.z.abs() < 0.01 * root.length()));
        let mut hanging = AuxinRoot::new(settings, Quat::from_rotation_z(core::f32::consts::PI)).unwrap();
        hanging.grow(30.0);
        assert!(hanging.tip_angle() < 1e-3 && hanging.length() > 12.0, "{}", hanging.length());
    }
}

#[test]
fn st_04_zone_transport_and_inhibition_change_the_shape() {
    let level = Quat::from_rotation_z(-core::f32::consts::FRAC_PI_2);
    let hours_to_45 = |settings: RootSettings| {
        let mut root = AuxinRoot::new(settings, level).unwrap();
        (1..400).find(|_| {
            root.grow(0.25);
            root.tip_angle() < 45_f32.to_radians()
        })
    };
    let plain = RootSettings::default();
    let weak = hours_to_45(RootSettings { inhibition: 0.5, ..plain });
    let slow = hours_to_45(RootSettings { transport: 0.5, ..plain });
    let usual = hours_to_45(plain).unwrap();
    println!("ST-4: quarter hours to 45 degrees {usual}, weak inhibition {weak:?}, slow transport {slow:?}");
    assert!(weak.is_none_or(|t| t > usual) && slow.is_none_or(|t| t > usual));
    // Without inhibition, or with an even split, nothing bends.
    for even in [RootSettings { inhibition: 0.0, ..plain }, RootSettings { bias: 0.0, ..plain }] {
        let mut root = AuxinRoot::new(even, level).unwrap();
        root.grow(10.0);
        assert!((root.tip_angle() - core::f32::consts::FRAC_PI_2).abs() < 1e-3);
    }
    assert!(AuxinRoot::new(RootSettings { columns: 1, ..plain }, level).is_err());
    assert!(AuxinRoot::new(RootSettings { length: f32::NAN, ..plain }, level).is_err());
}

#[test]
fn st_04_a_solid_root_turned_about_the_vertical_is_the_same_root_turned() {
    let settings = RootSettings { columns: 16, taper: 0.5, ..RootSettings::default() };
    let level = Quat::from_rotation_z(-1.2);
    let turn = Quat::from_rotation_y(1.3);
    let [mut here, mut there] = [level, turn * level].map(|base| AuxinRoot::new(settings, base).unwrap());
    here.grow(12.0);
    there.grow(12.0);
    for (a, b) in here.assemble().iter().zip(there.assemble()) {
        assert!((turn * a.position).distance(b.position) < 1e-3);
    }
}
