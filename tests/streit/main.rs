//! Variation by feedback control: the rows of Streit, Federl & Sousa.

#[path = "../common/mod.rs"]
mod common;
mod roots;
mod shoots;
mod siblings;

use bevy::math::{Vec2, ops};
use bevy::prelude::*;
use burgeon::chance;
use burgeon::environment::SolidShape;
use burgeon::environment::standing_wood::StandingWood;
use burgeon::environment::workers::Workers;
use burgeon::growth::shoots::{Obstacles, Plan, Tip, extend};
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
use common::{garden, grown, over_seeds, quick};
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
        for share in [0.001, 0.01, 0.1, 0.3, 0.6, 0.9, 0.95, 0.99, 1.05] {
            let gain = share * critical_gain(lag as u32);
            for start in [0.001, 0.02, 0.35] {
                let seen = errors(Control::new(gain, lag as u32).unwrap(), start, 1000);
                let paper = recurrence(gain.into(), lag, start.into(), 1000);
                // What grows carries its rounding along: it counts by how far it has grown.
                let mut grown = 1.0_f64;
                for (k, (a, b)) in seen.iter().zip(&paper).enumerate().take_while(|(_, (_, b))| b.abs() < 3.0)
                {
                    grown = grown.max(b.abs() / f64::from(start));
                    let off = (f64::from(*a) - b).abs() / grown;
                    worst = worst.max(off);
                    assert!(off < 1e-5, "lag {lag}, gain {gain}, start {start}, sub-step {k}: {a} for {b}");
                }
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
        let off = 0.005 + 0.4 * chance::unit(&mut rng);
        let share = if chance::unit(&mut rng) < 0.5 { 1.0 - off } else { 1.0 + off };
        let control = Control::new(share * critical_gain(lag), lag).unwrap();
        // The nearer the limit, the slower.
        let seen = errors(control, 0.02, (1000.0 / off) as usize + 6000);
        let grows = widest(&seen) > 5.0 * 0.02;
        let fades = widest(&seen[seen.len() - 5 * lag as usize..]) < 0.5 * 0.02;
        let read = stability(&control).unwrap();
        assert_eq!((grows, fades), (!read.stable, read.stable), "lag {lag}, {share} of the limit");
        assert_eq!(read.factor < 1.0, read.stable);
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
fn st_09_figure_10_under_equal_and_over_compensation() {
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
