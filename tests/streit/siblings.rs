//! Siblings of a finished plant.

use super::*;
use common::skeletons::five_hundred_internodes;

#[test]
fn siblings_keep_the_species_and_no_two_are_alike() {
    let base = five_hundred_internodes();
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
fn over_the_useful_range_siblings_keep_their_height() {
    let base = five_hundred_internodes();
    let workers = Workers::new(2).unwrap();
    // Lags of 4 % to 30 % of sixty sub-steps, ratios from just above the edge (`ST-6`).
    for lag in [3, 5, 10, 18] {
        for ratio in [0.8, 1.0, 1.2] {
            let control = Control::of_ratio(ratio, lag).unwrap();
            let variation = Variation { control, ..Variation::default() };
            let all = siblings(&base, &variation, 3, 50, &workers).unwrap();
            let heights = all.iter().map(|one| one.height() / base.height());
            let [low, high] = heights.fold([9.0_f32, 0.0_f32], |[l, h], it| [l.min(it), h.max(it)]);
            println!(
                "lag {lag}, ratio {ratio}: heights of 50 siblings {low:.3} to {high:.3} of the base model's"
            );
            assert!(low > 0.9 && high < 1.06, "lag {lag}, ratio {ratio}: {low} {high}");
        }
    }
}

#[test]
fn however_finely_it_is_cut_the_length_stays() {
    let mut line = Skeleton::default();
    line.add_stem(None, &[Vec3::ZERO, Vec3::Y * 10.0], [0.1, 0.1]);
    for sub_step in [1e-1, 1e-3, 1e-4, 1.1e-5] {
        let still = Variation { sensing_error: 0.0, disturbance: 0.0, ..Variation::default() };
        let fine = vary(&line, &Variation { sub_step: Some(sub_step), ..still }, 1).unwrap();
        assert!((fine.total_length() - 10.0).abs() < 1e-4, "{sub_step}: {} m", fine.total_length());
        assert!(fine.check().is_ok() && fine.nodes() == 1);
    }
}

/// Root mean square and widest angle between the pieces of siblings and of the course they keep, degrees.
fn straying(base: &Skeleton) -> [f32; 2] {
    let still =
        Variation { sensing_error: 0.0, disturbance: 0.0, control: Control::DIRECT, ..Variation::default() };
    let course = vary(base, &still, 1).unwrap();
    let all = siblings(base, &Variation::default(), 1, 40, &Workers::new(2).unwrap()).unwrap();
    let headings =
        |skeleton: &Skeleton| skeleton.segments.iter().map(|s| s.pose.heading()).collect::<Vec<_>>();
    let (kept, mut squares, mut widest, mut pieces) = (headings(&course), 0.0, 0.0_f32, 0.0);
    for one in &all {
        for (a, b) in headings(one).iter().zip(&kept) {
            let angle = a.angle_between(*b).to_degrees();
            (squares, widest, pieces) = (squares + angle * angle, widest.max(angle), pieces + 1.0);
        }
    }
    [(squares / pieces).sqrt(), widest]
}

#[test]
fn siblings_of_grown_plants_that_fork_and_turn_about_their_stems_keep_their_course() {
    for (name, steps) in [("horneophyton", 12), ("oak", 9)] {
        let resolved = burgeon::assets::Library::embedded().alone(name).unwrap();
        let base = Skeleton::of(&grown(resolved, 1, steps).snapshot(), 0).unwrap();
        let [rms, widest] = straying(&base);
        println!("{name}: {} segments, {rms:.1} degrees off, at most {widest:.0}", base.segments.len());
        assert!(rms < 12.0 && widest < 60.0, "{name}: {rms} {widest}");
    }
}

#[test]
fn how_the_frames_of_a_base_model_roll_about_its_stem_changes_nothing() {
    let mut plain = Skeleton::default();
    plain.add_stem(None, &(0..=60).map(|k| Vec3::Y * (0.1 * k as f32)).collect::<Vec<_>>(), [0.1, 0.1]);
    let mut rolled = plain.clone();
    for (k, stem) in rolled.segments.iter_mut().enumerate().skip(1) {
        stem.pose.rotation *= Quat::from_rotation_y(2.5 * k as f32);
    }
    // A push that knows no frame: at the base alone, so that both are astray alike.
    let pushed = |skeleton: &Skeleton| {
        let lean = Quat::from_rotation_z(-0.5);
        let still = Variation { sensing_error: 0.0, disturbance: 0.0, lean, ..Variation::default() };
        vary(skeleton, &still, 1).unwrap()
    };
    let (plain, rolled) = (pushed(&plain), pushed(&rolled));
    let off = plain.segments.iter().zip(&rolled.segments).map(|(a, b)| a.tip().distance(b.tip()));
    let off = off.fold(0.0, f32::max);
    assert!(off < 1e-4, "{off} m apart");
    assert!(plain.segments[59].tip().x > 1.0, "they do lean over");
}

#[test]
fn a_lean_bends_the_plant_over_to_its_side() {
    let trunk = {
        let mut one = Skeleton::default();
        one.add_stem(None, &[Vec3::ZERO, Vec3::Y * 6.0], [0.15, 0.1]);
        one
    };
    for (seed, lean_deg) in [(1, 30.0_f32), (2, -20.0), (3, 0.0)] {
        let lean = Quat::from_rotation_z(-lean_deg.to_radians());
        let one = vary(&trunk, &Variation { lean, ..Variation::default() }, seed).unwrap();
        let (base, top) = (&one.segments[0], one.segments.last().unwrap().tip());
        assert!(base.pose.heading().y > 0.98, "it sets out upright: {}", base.pose.heading());
        let leans = bevy::math::ops::atan2(top.x, top.y).to_degrees();
        assert!((leans - lean_deg).abs() < 8.0, "{leans} for {lean_deg}");
    }
    let slack = Variation { lean: Quat::from_xyzw(0.0, 0.0, 0.0, 0.4), ..Variation::default() };
    assert!(vary(&trunk, &slack, 1).unwrap_err().to_string().contains("lean"));
}

#[test]
fn st_11_without_noise_a_sibling_is_its_base_model_and_corners_stay() {
    let still = Variation { sensing_error: 0.0, disturbance: 0.0, ..Variation::default() };
    let base = five_hundred_internodes();
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
    let base = five_hundred_internodes();
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
    let base = five_hundred_internodes();
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
    let mut flat = five_hundred_internodes();
    flat.segments[3].length = 0.0;
    assert!(told(&flat, &fine).contains("segment 3 is 0 m long"));
    let mut wild = five_hundred_internodes();
    wild.segments[3].length = f32::NAN;
    assert!(vary(&wild, &fine, 1).is_err());
    let mut looped = five_hundred_internodes();
    looped.segments[3].parent = 3;
    assert!(told(&looped, &fine).contains("does not come before"));
    let mut lost = five_hundred_internodes();
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
        assert!(vary(&five_hundred_internodes(), &bad, 1).is_err(), "{bad:?}");
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
