//! Leaves as blades, and the crowns they make.

use bevy::prelude::*;

use super::Lot;
use super::union::{Union, unit};
use crate::chance::mix;
use crate::plant::{Leaf, OrganState, Snapshot};
use crate::render::record::{BladePair, Window, flags};
use crate::shape::crown::Crown;
use crate::shape::foliage::Foliage;

/// The part of the step in which a new leaf opens, from when its node stands.
const OPENING: f32 = 0.55;

/// Lays the blades of all leaves into the lots of their plants.
pub(super) fn lay_blades(union: &Union, foliage: &[Option<Foliage>], lots: &mut [Lot<BladePair>]) {
    for i in 0..union.len() {
        let OrganState::Leaf(leaf) = union.state(i) else { continue };
        let plant = union.plant(i) as usize;
        let (Some(Some(foliage)), Some(lot)) = (foliage.get(plant), lots.get_mut(plant)) else { continue };
        let (latest, at) = union.latest(i);
        let (earliest, from) = union.earliest(i);
        let scale = |leaf: &Leaf| leaf.size.max(0.0).sqrt();
        let now = scale(leaf);
        let mut before = match &earliest.state[from] {
            OrganState::Leaf(leaf) => scale(leaf),
            _ => now,
        };
        let (mut attached, mut unfolding) = (earliest.pose[from].position, Window::STEP);
        let mut window = union.window[i];
        if union.is_new(i) {
            before = 0.0;
            if let Some(&tip) = union.tip_before.get(union.parent[i] as usize) {
                attached = tip;
                window = union.window[union.parent[i] as usize];
            }
            let start = (1.0 - OPENING)
                * 0.5
                * (window.end * if union.is_new(union.parent[i] as usize) { 1.0 } else { 0.4 })
                + 0.1 * unit(union.lineage(i));
            unfolding = Window { start, end: start + OPENING };
        }
        if before.max(now) <= 0.0 {
            continue;
        }
        let flags = if union.is_dying(i) { flags::DYING } else { 0 };
        let owner = union.owner(i);
        let lineage = latest.lineage[at];
        let pose = &latest.pose[at];
        for (k, blade) in foliage.blades(pose, 1.0, lineage).enumerate() {
            let chance = (mix(lineage.0 ^ (0xB1ADE + k as u64)) >> 40) as f32 / (1u64 << 24) as f32;
            let pair = BladePair {
                before: attached,
                now: pose.position,
                scale: [before, now],
                window,
                unfolding,
                petiole: blade.base - pose.position,
                midrib: blade.midrib,
                across: blade.across,
                chance,
                flags,
                owner,
            };
            let reach = (pair.petiole.length() + pair.midrib.length()) * 1.2;
            lot.add(pair, [pair.before, pair.now], reach);
        }
    }
}

/// The middle of each plant's crown and how far its leaves are from it on average, metres.
pub(super) fn crowns(snapshot: &Snapshot) -> Vec<[f32; 4]> {
    Crown::of(snapshot).iter().map(|crown| crown.middle.extend(crown.spread).to_array()).collect()
}
