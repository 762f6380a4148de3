use std::collections::HashMap;

use half::f16;

use super::*;
use crate::plant::{OrganState, Plant, shed};
use crate::prelude::*;

fn half(word: u32, high: bool) -> f32 {
    f16::from_bits((word >> (16 * u32::from(high))) as u16).to_f32()
}

/// Centre and radius of a ring at a part of the step, as the shader mixes them.
fn ring_at(record: &Record, t: f32) -> (Vec3, f32) {
    let w = &record.0;
    let now = Vec3::from_array([0, 1, 2].map(|k| f32::from_bits(w[k])));
    let shift = Vec3::new(half(w[4], false), half(w[4], true), half(w[5], false));
    let (start, end) = ((w[5] >> 16 & 0xFF) as f32 / 255.0, (w[5] >> 24) as f32 / 255.0);
    let p = ((t - start) / (end - start)).clamp(0.0, 1.0);
    (now + shift * (1.0 - p), half(w[3], false) * (1.0 - p) + half(w[3], true) * p)
}

fn flags(record: &Record) -> u32 {
    record.0[11] >> 16
}

/// Length of a blade at a part of the step as a share of its largest.
fn scale_at(record: &Record, t: f32) -> f32 {
    let w = &record.0;
    let (start, end) = ((w[11] & 0xFF) as f32 / 255.0, (w[11] >> 8 & 0xFF) as f32 / 255.0);
    let p = ((t - start) / (end - start)).clamp(0.0, 1.0);
    half(w[3], false) * (1.0 - p) + half(w[3], true) * p
}

fn oak(steps: u32) -> Vec<Snapshot> {
    let mut app = bevy::app::App::new();
    app.add_plugins((MinimalPlugins, crate::BurgeonPlugins));
    let oak = Species::named("oak").unwrap();
    app.world_mut().spawn((Plant::new(oak, 7), Transform::from_xyz(1.0, 0.0, 2.0)));
    (0..steps)
        .map(|_| {
            grow(app.world_mut(), 1);
            Snapshot::take(app.world())
        })
        .collect()
}

/// Where rings are, by owner: all but the points that close a tube.
fn rings(packed: &Packed, t: f32) -> HashMap<u32, Vec<(Vec3, f32)>> {
    let mut all: HashMap<u32, Vec<(Vec3, f32)>> = HashMap::new();
    for record in packed.rings.iter().filter(|r| r.birth() != u32::MAX && flags(r) & 2 == 0) {
        let (center, radius) = ring_at(record, t);
        if radius > 0.0 {
            all.entry(record.birth()).or_default().push((center, radius));
        }
    }
    all
}

#[test]
fn the_end_of_a_step_is_the_begin_of_the_next() {
    let shots = oak(7);
    for three in shots.windows(3) {
        let (end, begin) = (pack(&three[0], &three[1]), pack(&three[1], &three[2]));
        let (end, begin) = (rings(&end, 1.0), rings(&begin, 0.0));
        assert!(!end.is_empty());
        for (birth, rings) in &end {
            // What is shed in the next step is drawn as falling.
            let Some(other) = begin.get(birth) else { continue };
            for (center, radius) in rings {
                let near = other.iter().any(|(c, r)| c.distance(*center) < 2e-3 && (r - radius).abs() < 1e-4);
                assert!(near, "{birth}: {center} {radius} in {other:?}");
            }
        }
    }
}

#[test]
fn leaves_open_from_nothing_and_keep_their_size_over_a_step() {
    let shots = oak(6);
    let (first, second) = (pack(&shots[3], &shots[4]), pack(&shots[4], &shots[5]));
    let living = |packed: &Packed| -> Vec<Record> {
        packed.blades.iter().copied().filter(|r| r.birth() != u32::MAX).collect()
    };
    let old: std::collections::HashSet<u32> = shots[3].birth.iter().copied().collect();
    for record in living(&first).iter().filter(|r| !old.contains(&r.birth())) {
        assert_eq!(scale_at(record, 0.0), 0.0);
        assert!(scale_at(record, 1.0) > 0.0);
    }
    let before: HashMap<u32, f32> = living(&second).iter().map(|r| (r.birth(), scale_at(r, 0.0))).collect();
    for record in living(&first) {
        if let Some(&scale) = before.get(&record.birth()) {
            assert!((scale - scale_at(&record, 1.0)).abs() < 1e-3);
        }
    }
}

#[test]
fn new_shoots_begin_where_the_old_ended() {
    let shots = oak(5);
    let packed = pack(&shots[3], &shots[4]);
    let old: std::collections::HashSet<u32> = shots[3].birth.iter().copied().collect();
    let mut tips: Vec<Vec3> = (0..shots[3].len())
        .filter(|&i| matches!(shots[3].state[i], OrganState::Internode(..)))
        .map(|i| shots[3].pose[i].tip(shots[3].length(i)))
        .collect();
    tips.push(Vec3::new(1.0, 0.0, 2.0));
    for record in packed.rings.iter().filter(|r| r.birth() != u32::MAX && !old.contains(&r.birth())) {
        let (center, _) = ring_at(record, 0.0);
        let nearest = tips.iter().map(|tip| tip.distance(center)).fold(f32::INFINITY, f32::min);
        // Apexes stand off by their radius.
        assert!(nearest < 0.01, "{center} {nearest}");
    }
}

#[test]
fn what_is_cut_falls_and_what_stays_is_closed() {
    let mut app = bevy::app::App::new();
    app.add_plugins((MinimalPlugins, crate::BurgeonPlugins));
    app.world_mut().spawn(Plant::new(Species::named("oak").unwrap(), 3));
    grow(app.world_mut(), 5);
    let before = Snapshot::take(app.world());
    let middle = before
        .state
        .iter()
        .enumerate()
        .filter(|(_, s)| matches!(s, OrganState::Internode(..)))
        .nth(3)
        .map(|(i, _)| i)
        .unwrap();
    shed(app.world_mut(), &[(before.birth[middle], Cause::Pruned)]);
    let now = Snapshot::take(app.world());
    let packed = pack(&before, &now);
    let dying: Vec<_> = packed.rings.iter().filter(|r| flags(r) & 2 != 0).collect();
    assert!(!dying.is_empty());
    let alive: std::collections::HashSet<u32> = now.birth.iter().copied().collect();
    assert!(dying.iter().skip(1).any(|r| r.birth() == before.birth[middle]));
    assert!(dying.iter().all(|r| !alive.contains(&r.birth())));
}

#[test]
fn chunks_hold_every_record_once() {
    let shots = oak(8);
    let packed = pack(&shots[6], &shots[7]);
    let mut seen = (vec![0; packed.rings.len()], vec![0; packed.blades.len()]);
    for chunk in &packed.chunks {
        let seen = if matches!(chunk.class, Class::Blades(_)) { &mut seen.1 } else { &mut seen.0 };
        let end = chunk.first + CAPACITIES[chunk.capacity as usize];
        for count in &mut seen[chunk.first as usize..end as usize] {
            *count += 1;
        }
        assert!(chunk.min.cmple(chunk.max).all());
    }
    assert!(seen.1.iter().all(|&n| n == 1));
    assert!(seen.0[..seen.0.len() - 1].iter().all(|&n| n == 1));
}

#[test]
fn nothing_packs_to_nothing() {
    let packed = pack(&Snapshot::default(), &Snapshot::default());
    assert!(packed.chunks.is_empty() && packed.blades.is_empty());
    assert_eq!(packed.rings.len(), 1);
}

#[test]
fn the_colour_of_the_barks_marks_comes_along() {
    assert_eq!(five_bits(Vec3::ZERO), 0.0);
    assert_eq!(five_bits(Vec3::ONE), 32767.0);
    // As the shader reads it.
    let read = |bits: f32| [10, 5, 0].map(|shift| ((bits as u32 >> shift) & 31) as f32 / 31.0).map(|r| r * r);
    for color in [Vec3::new(0.2, 0.7, 0.01), Vec3::new(0.9, 0.03, 0.4), Vec3::splat(2.0)] {
        let back = Vec3::from_array(read(five_bits(color)));
        assert!(back.distance(color.min(Vec3::ONE)) < 0.06, "{color} {back}");
    }
}
